/* components.h - many spectra as mixtures of a few: their principal components.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMPONENTS_H
#define MEN_COMPONENTS_H

#include <stddef.h>

#include "optics/texture.h"

/* Of 16 bands so many are enough for a sky: what they leave over is 3e-7 to 1e-4 of the brightest band (root of the mean
 * square, from a high sun to one 8 degrees below the horizon), and 6e-4 at the worst place. */
enum { COMPONENTS = 8 };

typedef struct Components {
    double of[COMPONENTS][ENVIRONMENT_BANDS]; /* of unit length, at right angles to each other */
} Components;

/* Those of n spectra, each over its luminance (float; what has none does not count), that leave the least mean square over. */
void components_find(const float *spectra, const float *luminance, size_t n, Components *components);
/* How much of each is in each spectrum over its luminance: n * COMPONENTS numbers. */
void components_split(const Components *components, const float *spectra, const float *luminance, size_t n,
                      float *mixtures);

#endif
