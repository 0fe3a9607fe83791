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

static uint32_t first_along(uint32_t i, uint32_t radius)
{
    return i > radius ? i - radius : 0;
}
static uint32_t last_along(uint32_t i, uint32_t n, uint32_t radius)
{
    return n - 1 - i > radius ? i + radius : n - 1;
}

typedef struct Around {
    const float *map;
    uint32_t width, height, radius;
    float *beside, *mean;
} Around;

static void look_along_row(void *context, uint32_t y, unsigned worker)
{
    const Around *a = context;
    (void)worker;
    size_t row = (size_t)y * a->width;
    sum_beside(a->map + row, a->width, a->radius, a->beside + row);
}

static void look_across_rows(void *context, uint32_t y, unsigned worker)
{
    const Around *a = context;
    (void)worker;
    uint32_t width = a->width, top = first_along(y, a->radius), bottom = last_along(y, a->height, a->radius);
    float *sum = a->mean + (size_t)y * width;
    memcpy(sum, a->beside + (size_t)y * width, width * sizeof *sum);
    for (size_t k = top; k <= bottom; k++) {
        if (k == y) continue;
        add_row(sum, a->beside + k * width, width);
        add_row(sum, a->map + k * width, width);
    }
    for (uint32_t x = 0; x < width; x++) {
        uint32_t n = (last_along(x, width, a->radius) - first_along(x, a->radius) + 1) * (bottom - top + 1) - 1;
        sum[x] = n ? sum[x] / (float)n : a->map[(size_t)y * width + x];
    }
}

void mean_around(const float *map, uint32_t width, uint32_t height, uint32_t radius, float *scratch, float *mean,
                 Pool *pool)
{
    Around around = {map, width, height, radius, scratch, mean};
    pool_run(pool, height, look_along_row, &around);
    pool_run(pool, height, look_across_rows, &around);
}
