/* around.h - means over the neighbours of each pixel of a map.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AROUND_H
#define MEN_AROUND_H

#include "base/pool.h"

/* The mean of the square of `radius` around each pixel, without the pixel itself; what is beyond the border is none. A map
 * without neighbours is its own mean. scratch and mean: of the map's size, neither of them the map. pool: NULL, or who shares
 * the work; the same bits for any number of threads. */
void mean_around(const float *map, uint32_t width, uint32_t height, uint32_t radius, float *scratch, float *mean,
                 Pool *pool);

#endif
