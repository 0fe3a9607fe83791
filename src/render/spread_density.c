/* spread_density.c - see spread_density.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread_density.h"

#include <math.h>
#include <stdlib.h>

/* So many samples are no chance: one square in a thousand of an even scatter would be half as dense. */
enum { ENOUGH = 16 };
/* The power of two of the faintest kind. */
enum { DARKEST = -DENSITY_KINDS / 2 };

static size_t corner(const Densities *densities, uint32_t x, uint32_t y)
{
    return (size_t)y * (densities->width + 1) + x;
}

bool density_init(Densities *densities, uint32_t width, uint32_t height, const double *shares)
{
    *densities = (Densities){.width = width, .height = height};
    double *sums = densities->shares = calloc((size_t)(width + 1) * (height + 1), sizeof *sums);
    if (!sums) return false;
    for (uint32_t y = 0; y < height; y++) {
        double row = 0;
        for (uint32_t x = 0; x < width; x++) {
            row += shares[(size_t)y * width + x];
            sums[corner(densities, x + 1, y + 1)] = sums[corner(densities, x + 1, y)] + row;
        }
    }
    return true;
}

void density_clear(Densities *densities)
{
    free(densities->shares);
    for (int i = 0; i < DENSITY_KINDS; i++) {
        free(densities->kinds[i].counts);
        free(densities->kinds[i].around);
    }
    *densities = (Densities){0};
}

int density_kind(float least)
{
    int kind = least > 0 ? ilogbf(least) - DARKEST : 0;
    return kind <= DENSITY_ANY ? DENSITY_ANY + 1 : kind < DENSITY_KINDS ? kind : DENSITY_KINDS - 1;
}

static uint32_t count_within(const Densities *densities, const uint32_t *counts, CellSquare square)
{
    return counts[corner(densities, square.x1, square.y1)] - counts[corner(densities, square.x0, square.y1)] -
           counts[corner(densities, square.x1, square.y0)] + counts[corner(densities, square.x0, square.y0)];
}

static double shares_within(const Densities *densities, CellSquare square)
{
    const double *sums = densities->shares;
    double shares = sums[corner(densities, square.x1, square.y1)] - sums[corner(densities, square.x0, square.y1)] -
                    sums[corner(densities, square.x1, square.y0)] + sums[corner(densities, square.x0, square.y0)];
    return shares > 1e-9 * sums[corner(densities, densities->width, densities->height)] ? shares : 0; /* by rounding */
}

double density_within(const Densities *densities, int kind, CellSquare square)
{
    double shares = shares_within(densities, square);
    return shares > 0 ? count_within(densities, densities->kinds[kind].counts, square) / shares : 0;
}

static CellSquare square_at(const Densities *densities, uint32_t x, uint32_t y, uint32_t reach)
{
    return (CellSquare){x > reach ? x - reach : 0, y > reach ? y - reach : 0,
                        x + reach + 1 < densities->width ? x + reach + 1 : densities->width,
                        y + reach + 1 < densities->height ? y + reach + 1 : densities->height};
}

typedef struct Finding {
    Densities *densities;
    int kind;
} Finding;

static float density_around(const Densities *densities, int kind, uint32_t x, uint32_t y)
{
    const uint32_t *counts = densities->kinds[kind].counts;
    uint32_t low = 0, high = densities->width > densities->height ? densities->width : densities->height;
    if (count_within(densities, counts, square_at(densities, x, y, high)) < ENOUGH) return HUGE_VALF;
    while (low < high) { /* the least square that has enough */
        uint32_t middle = (low + high) / 2;
        if (count_within(densities, counts, square_at(densities, x, y, middle)) < ENOUGH)
            low = middle + 1;
        else
            high = middle;
    }
    CellSquare square = square_at(densities, x, y, low);
    double count = count_within(densities, counts, square), shares = shares_within(densities, square);
    if (low > 0) { /* its border may have many more than it takes: as if they lay there by and by */
        CellSquare inner = square_at(densities, x, y, low - 1);
        double within = count_within(densities, counts, inner), of_inner = shares_within(densities, inner);
        shares = of_inner + (shares - of_inner) * (ENOUGH - within) / (count - within);
        count = ENOUGH;
    }
    return shares > 0 ? (float)(count / shares) : HUGE_VALF;
}

static void find_row(void *context, uint32_t row, unsigned worker)
{
    const Finding *finding = context;
    const Densities *densities = finding->densities;
    float *around = densities->kinds[finding->kind].around + (size_t)row * densities->width;
    (void)worker;
    for (uint32_t x = 0; x < densities->width; x++) around[x] = density_around(densities, finding->kind, x, row);
}

bool density_find(Densities *densities, int kind, DensityCount count, const void *context, Pool *pool)
{
    DensityOfKind *of = &densities->kinds[kind];
    const uint32_t width = densities->width, height = densities->height;
    if (of->around) return true;
    of->counts = calloc((size_t)(width + 1) * (height + 1), sizeof *of->counts);
    of->around = malloc((size_t)width * height * sizeof *of->around);
    if (!of->counts || !of->around) return false;
    const float least = kind == DENSITY_ANY ? 0 : ldexpf(1, kind + DARKEST);
    for (uint32_t y = 0; y < height; y++) {
        uint32_t row = 0;
        for (uint32_t x = 0; x < width; x++) {
            row += count(context, (size_t)y * width + x, least);
            of->counts[corner(densities, x + 1, y + 1)] = of->counts[corner(densities, x + 1, y)] + row;
        }
    }
    Finding finding = {densities, kind};
    pool_run(pool, height, find_row, &finding);
    return true;
}
