/* around.c - sums that slide along rows, and then along columns.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/around.h"

#include <stddef.h>

/* Sums over the n values, `stride` apart, from `radius` before each to `radius` behind it; those beyond the ends are none. */
static void sum_along(const float *from, uint32_t n, size_t stride, uint32_t radius, float *to)
{
    double sum = 0;
    for (uint32_t i = 0; i < radius && i < n; i++) sum += (double)from[i * stride];
    for (uint32_t i = 0; i < n; i++) {
        if (i + radius < n) sum += (double)from[(i + radius) * stride];
        to[i * stride] = (float)sum;
        if (i >= radius) sum -= (double)from[(i - radius) * stride];
    }
}

static uint32_t count_along(uint32_t i, uint32_t n, uint32_t radius)
{
    uint32_t first = i > radius ? i - radius : 0, last = i + radius < n ? i + radius : n - 1;
    return last - first + 1;
}

void mean_around(const float *map, uint32_t width, uint32_t height, uint32_t radius, float *scratch, float *mean)
{
    for (uint32_t y = 0; y < height; y++)
        sum_along(map + (size_t)y * width, width, 1, radius, scratch + (size_t)y * width);
    for (uint32_t x = 0; x < width; x++) sum_along(scratch + x, height, width, radius, mean + x);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            size_t i = (size_t)y * width + x;
            uint32_t n = count_along(x, width, radius) * count_along(y, height, radius) - 1;
            mean[i] = n ? (mean[i] - map[i]) / (float)n : map[i];
        }
}
