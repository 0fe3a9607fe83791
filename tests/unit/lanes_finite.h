/* lanes_finite.h - what every result for several wavelengths has to be.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_LANES_FINITE_H
#define MEN_TEST_LANES_FINITE_H

#include <math.h>

#include "base/lanes.h"

static inline bool lanes_finite(Lanes a)
{
    return isfinite(a.v[0]) && isfinite(a.v[1]) && isfinite(a.v[2]) && isfinite(a.v[3]);
}

#endif
