/* around.c - sums along rows, and then of rows. Nothing is taken off again: beside a value that is a million times as large as those
 * around it, and for that value itself, what was left would be rounding, and might be below 0.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/around.h"

#include <stddef.h>
#include <string.h>

static void add_row(float *restrict sum, const float *restrict row, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) sum[i] += row[i];
}

/* What is beside each value of a row, up to `radius` away. */
static void sum_beside(const float *row, uint32_t n, uint32_t radius, float *sum)
{
    memset(sum, 0, n * sizeof *sum);
    for (uint32_t d = 1; d <= radius && d < n; d++) {
        add_row(sum + d, row, n - d);
        add_row(sum, row + d, n - d);
    }
}

static uint32_t first_along(uint32_t i, uint32_t radius) { return i > radius ? i - radius : 0; }
static uint32_t last_along(uint32_t i, uint32_t n, uint32_t radius) { return n - 1 - i > radius ? i + radius : n - 1; }

void mean_around(const float *map, uint32_t width, uint32_t height, uint32_t radius, float *scratch, float *mean)
{
    for (size_t y = 0; y < height; y++) sum_beside(map + y * width, width, radius, scratch + y * width);
    for (uint32_t y = 0; y < height; y++) {
        uint32_t top = first_along(y, radius), bottom = last_along(y, height, radius);
        float *sum = mean + (size_t)y * width;
        memcpy(sum, scratch + (size_t)y * width, width * sizeof *sum);
        for (size_t k = top; k <= bottom; k++) {
            if (k == y) continue;
            add_row(sum, scratch + k * width, width);
            add_row(sum, map + k * width, width);
        }
        for (uint32_t x = 0; x < width; x++) {
            uint32_t n = (last_along(x, width, radius) - first_along(x, radius) + 1) * (bottom - top + 1) - 1;
            sum[x] = n ? sum[x] / (float)n : map[(size_t)y * width + x];
        }
    }
}
