/* metal.h - measured indices of common metals.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_METAL_H
#define MEN_METAL_H

#include <stdbool.h>
#include <stddef.h>

#include "optics/spectrum.h"

/* Real and imaginary part of a metal's index relative to vacuum; false when no metal has the name. n_table, k_table:
 * SPECTRUM_SAMPLES floats each, of the caller's, that the spectra refer to. */
bool metal_index(const char *name, Spectrum *n, Spectrum *k, float *n_table, float *k_table);

#endif
