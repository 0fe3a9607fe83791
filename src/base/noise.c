/* noise.c - noise on a lattice.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/noise.h"

#include <stdbool.h>

#include "base/hash.h"

/* "noise" in ASCII */
static const uint64_t value_start = 0x6e6f697365U;

/* The values at the corners of a cell: corner k is at cell + its bits. The hash of a corner is made of its coordinates
 * one after the other, so that corners that agree in the first ones share their part of it. */
static void corner_values(const double *cell, unsigned n, double *values)
{
    uint64_t hashes[8] = {value_start};
    for (unsigned i = 0; i < n; i++)
        for (unsigned k = 1U << i; k-- > 0;) {
            uint64_t at = (uint64_t)(int64_t)cell[i], before = hashes[k];
            hashes[k] = hash_u64(before ^ at);
            hashes[k + (1U << i)] = hash_u64(before ^ (at + 1));
        }
    for (unsigned k = 0; k < 1U << n; k++) values[k] = 2 * hash_to_unit(hashes[k]) - 1;
}

static double fade(double t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/* Cells in space that a thread asked for lately: places that are asked for one after the other mostly lie in the same few, by as
 * many octaves of noise as there are. */
enum { CELLS_KEPT = 256 };
typedef struct KeptCell {
    double cell[3], values[8];
} KeptCell;

static const double *values_in_space(const double *cell)
{
    static _Thread_local KeptCell kept[CELLS_KEPT];
    uint64_t x = (uint64_t)(int64_t)cell[0], y = (uint64_t)(int64_t)cell[1], z = (uint64_t)(int64_t)cell[2];
    KeptCell *place = &kept[(x + 7 * y + 49 * z) % CELLS_KEPT];
    bool is_kept = place->cell[0] == cell[0] && place->cell[1] == cell[1] && place->cell[2] == cell[2];
    if (!is_kept || place->values[0] == 0) { /* as places begin, or by a rare chance */
        for (int i = 0; i < 3; i++) place->cell[i] = cell[i];
        corner_values(cell, 3, place->values);
    }
    return place->values;
}

/* floor(), of coordinates */
static double whole_below(double x)
{
    double whole = (double)(int64_t)x;
    return whole > x ? whole - 1 : whole;
}

double noise_value(const double *point, unsigned n)
{
    double cell[3], weight[3], values[8];
    for (unsigned i = 0; i < n; i++) {
        cell[i] = whole_below(point[i]);
        weight[i] = fade(point[i] - cell[i]);
    }
    const double *corners = values;
    if (n == 3)
        corners = values_in_space(cell);
    else
        corner_values(cell, n, values);
    for (unsigned i = 0, left = 1U << n; i < n; i++) {
        left /= 2;
        for (unsigned k = 0; k < left; k++)
            values[k] = corners[2 * k] + (corners[2 * k + 1] - corners[2 * k]) * weight[i];
        corners = values;
    }
    return values[0];
}

/* The lattice cell that a point is in. */
typedef struct Cell {
    uint64_t hashes[8]; /* of the corners; x changes first */
    double t[3];        /* where in the cell, 0..1 */
    double weight[3];
} Cell;

static void cell_at(Vec3 p, uint64_t seed, Cell *cell)
{
    const double point[3] = {p.x, p.y, p.z};
    uint64_t at[3], start = hash_u64(seed);
    for (int i = 0; i < 3; i++) {
        double low = floor(point[i]);
        at[i] = (uint64_t)(int64_t)low;
        cell->t[i] = point[i] - low;
        cell->weight[i] = fade(cell->t[i]);
    }
    for (unsigned x = 0; x < 2; x++) {
        uint64_t along_x = hash_u64(start ^ (at[0] + x));
        for (unsigned y = 0; y < 2; y++) {
            uint64_t along_y = hash_u64(along_x ^ (at[1] + y));
            for (unsigned z = 0; z < 2; z++) cell->hashes[x + 2 * y + 4 * z] = hash_u64(along_y ^ (at[2] + z));
        }
    }
}

/* By h % 12; a table, as signs that are as good as random are costly to branch on. */
static const double gradients[12][3] = {{0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1}, {1, 0, 1},  {-1, 0, 1},
                                        {1, 0, -1}, {-1, 0, -1}, {1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}};

static double gradient_dot(uint64_t h, double x, double y, double z)
{
    const double *gradient = gradients[h % 12];
    return gradient[0] * x + gradient[1] * y + gradient[2] * z;
}

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

static double mixed(const Cell *cell, unsigned shift)
{
    double value[8];
    for (unsigned k = 0; k < 8; k++)
        value[k] = gradient_dot(cell->hashes[k] >> shift, cell->t[0] - (k & 1), cell->t[1] - (k >> 1 & 1),
                                cell->t[2] - (k >> 2));
    for (unsigned k = 0; k < 4; k++) value[k] = mix(value[2 * k], value[2 * k + 1], cell->weight[0]);
    for (unsigned k = 0; k < 2; k++) value[k] = mix(value[2 * k], value[2 * k + 1], cell->weight[1]);
    return mix(value[0], value[1], cell->weight[2]);
}

double noise_gradient(Vec3 p, uint64_t seed)
{
    Cell cell;
    cell_at(p, seed, &cell);
    return mixed(&cell, 0);
}

Vec3 noise_gradient3(Vec3 p, uint64_t seed)
{
    Cell cell;
    cell_at(p, seed, &cell);
    return vec3(mixed(&cell, 0), mixed(&cell, 16), mixed(&cell, 32));
}
