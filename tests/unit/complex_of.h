/* complex_of.h - a complex number of its parts; not every compiler has C11's CMPLX.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_COMPLEX_OF_H
#define MEN_TEST_COMPLEX_OF_H

#include <complex.h>

static inline double complex complex_of(double real, double imaginary)
{
    return real + imaginary * (double complex)_Complex_I;
}

#endif
