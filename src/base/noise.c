/* noise.c - noise on a lattice.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/noise.h"

#include <math.h>
#include <string.h>

#include "base/hash.h"

/* "noise" in ASCII */
static const uint64_t value_start = 0x6e6f697365U;

static double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

enum { MOST_VALUES = 64 }; /* 4 along each of three axes */

/* A cell of the lattice; coordinates that it has not got are 0. */
typedef struct Cell {
    uint64_t at[3], n;
} Cell;

/* The 4^n values about a cell, x slowest: number 16 i + 4 j + k is at cell + (i, j, k) - 1. The hash of a point is made of
 * its coordinates one after the other, so that points that agree in the first ones share their part of it. */
static void values_about(const Cell *cell, double *values)
{
    uint64_t hashes[MOST_VALUES];
    unsigned n_values = 1;
    hashes[0] = value_start;
    for (unsigned i = 0; i < cell->n; i++, n_values *= 4)
        for (unsigned k = n_values; k-- > 0;) {
            uint64_t before = hashes[k];
            for (unsigned j = 0; j < 4; j++) hashes[4 * k + j] = hash_u64(before ^ (cell->at[i] - 1 + j));
        }
    for (unsigned k = 0; k < n_values; k++) values[k] = 2 * hash_to_unit(hashes[k]) - 1;
}

/* Cells that a thread asked for lately: places that are asked for one after the other mostly lie in the same few, by as many
 * octaves of noise as there are. */
enum { CELLS_KEPT = 256 };
typedef struct KeptCell {
    Cell cell;
    _Alignas(32) double values[MOST_VALUES];
} KeptCell;

static const double *values_of(const Cell *cell)
{
    static _Thread_local KeptCell kept[CELLS_KEPT];
    KeptCell *place = &kept[(cell->at[0] + 7 * cell->at[1] + 49 * cell->at[2]) % CELLS_KEPT];
    const uint64_t *a = place->cell.at, *b = cell->at; /* n is 0 as places begin */
    if (place->cell.n != cell->n || a[0] != b[0] || a[1] != b[1] || a[2] != b[2]) {
        place->cell = *cell;
        values_about(cell, place->values);
    }
    return place->values;
}

/* What the values at 0 and 1, and at -1 and 2, count for at t in 0..1: see noise.h. */
typedef struct Weights {
    double near[2], far[2];
} Weights;

static Weights weigh(double t)
{
    const double to[2] = {t, 1 - t}, from[2] = {1 - t, t};
    Weights weights;
    for (int k = 0; k < 2; k++) {
        double cube = to[k] * to[k] * to[k];
        weights.near[k] = from[k] * (1 + to[k] + cube * (3 * to[k] - 4.5));
        weights.far[k] = (to[k] * from[k]) * (from[k] * from[k]) * (-0.5 - to[k]);
    }
    return weights;
}

/* Along the slowest axis: of 4 n values n. */
static inline void reduce(const double *restrict values, unsigned n, const Weights *w, double *restrict reduced)
{
    for (unsigned k = 0; k < n; k++)
        reduced[k] = (w->far[0] * values[k] + w->far[1] * values[3 * n + k]) +
                     (w->near[0] * values[n + k] + w->near[1] * values[2 * n + k]);
}

/* So that nothing is beyond -1..1, and there is no crease where it would be. */
static double drawn_in(double value)
{
    const double straight = 0.8, room = 0.2;
    if (fabs(value) <= straight) return value;
    double beyond = (fabs(value) - straight) / room;
    return copysign(straight + room * (beyond / sqrt(1 + beyond * beyond)), value);
}

double noise_value(const double *point, unsigned n)
{
    Cell cell = {.n = n};
    Weights weights[3];
    double plane[16], line[4], value;
    for (unsigned i = 0; i < n; i++) {
        int64_t whole = (int64_t)point[i];
        whole -= (double)whole > point[i];
        cell.at[i] = (uint64_t)whole;
        weights[i] = weigh(point[i] - (double)whole);
    }
    const double *values = values_of(&cell);
    if (n == 3) {
        reduce(values, 16, &weights[0], plane);
        values = plane;
    }
    if (n >= 2) {
        reduce(values, 4, &weights[n - 2], line);
        values = line;
    }
    reduce(values, 1, &weights[n - 1], &value);
    return drawn_in(value);
}

/* ---- bounds ---- */

enum {
    CONTROLS = 6,        /* of a quintic */
    MOST_CONTROLS = 216, /* of one along each of three axes */
    MOST_CELLS = 4       /* more than these take as long as the points that they may spare */
};

/* How the controls of a quintic, what Bernstein's polynomials are times, are made of the values at -1, 0, 1 and 2. */
typedef double Controls[CONTROLS][4];
static const Controls whole_weights = {{0, 1, 0, 0},       {-.1, 1, .1, 0}, {-.15, .9, .25, 0},
                                       {0, .25, .9, -.15}, {0, .1, 1, -.1}, {0, 0, 1, 0}};

static void cut_between(const double a[4], const double b[4], double t, double *cut)
{
    for (unsigned m = 0; m < 4; m++) cut[m] = mix(a[m], b[m], t);
}

/* The same for its part from `low` to `high` of 0..1 (de Casteljau). */
static void weigh_part(double low, double high, Controls part)
{
    double first = high > 0 ? low / high : 0;
    memcpy(part, whole_weights, sizeof whole_weights);
    for (unsigned i = 1; i < CONTROLS && high < 1; i++)
        for (unsigned k = CONTROLS; k-- > i;) cut_between(part[k - 1], part[k], high, part[k]);
    for (unsigned i = 1; i < CONTROLS && first > 0; i++)
        for (unsigned k = 0; k + i < CONTROLS; k++) cut_between(part[k], part[k + 1], first, part[k]);
}

/* Along the slowest axis: of 4 n values 6 n controls. */
static void spread(const double *restrict values, unsigned n, const double *restrict weights, double *restrict controls)
{
    for (unsigned i = 0; i < CONTROLS; i++, weights += 4, controls += n)
        for (unsigned k = 0; k < n; k++)
            controls[k] = (weights[0] * values[k] + weights[1] * values[n + k]) +
                          (weights[2] * values[2 * n + k] + weights[3] * values[3 * n + k]);
}

/* The slowest axis becomes the fastest. */
static void turn(const double *restrict controls, unsigned n, double *restrict turned)
{
    for (unsigned k = 0; k < n; k++)
        for (unsigned i = 0; i < CONTROLS; i++) turned[CONTROLS * k + i] = controls[n * i + k];
}

/* A polynomial is between the least and the largest of its controls. */
static void add_extremes(const double *controls, unsigned n, double *least, double *most)
{
    double lows[CONTROLS], highs[CONTROLS]; /* of every sixth, to be found side by side */
    for (unsigned i = 0; i < CONTROLS; i++) {
        lows[i] = *least;
        highs[i] = *most;
    }
    for (unsigned k = 0; k + CONTROLS <= n; k += CONTROLS)
        for (unsigned i = 0; i < CONTROLS; i++) {
            lows[i] = controls[k + i] < lows[i] ? controls[k + i] : lows[i];
            highs[i] = controls[k + i] > highs[i] ? controls[k + i] : highs[i];
        }
    for (unsigned i = 0; i < CONTROLS; i++) {
        *least = fmin(*least, lows[i]);
        *most = fmax(*most, highs[i]);
    }
}

/* The part of a box that is in a cell, before it is drawn in. */
static void add_cell(const Cell *cell, const double *low, const double *high, double *least, double *most)
{
    double controls[MOST_CONTROLS], turned[MOST_CONTROLS];
    const double *values = values_of(cell);
    unsigned n = 1U << 2 * cell->n;
    for (unsigned i = 0; i < cell->n; i++, n = n / 4 * CONTROLS) {
        Controls weights;
        double whole = (double)(int64_t)cell->at[i], first = low[i] - whole, last = high[i] - whole;
        weigh_part(first > 0 ? first : 0, last < 1 ? last : 1, weights);
        if (i > 0) turn(controls, n / CONTROLS, turned);
        spread(i > 0 ? turned : values, n / 4, weights[0], controls);
    }
    add_extremes(controls, n, least, most);
}

bool noise_bounds(const double *low, const double *high, unsigned n, double *least, double *most)
{
    double first[3], n_cells = 1, counts[3];
    for (unsigned i = 0; i < n; i++) {
        first[i] = floor(low[i]);
        counts[i] = fmax(ceil(high[i]) - first[i], 1);
        n_cells *= counts[i];
    }
    if (n_cells > MOST_CELLS) return false;
    *least = HUGE_VAL;
    *most = -HUGE_VAL;
    for (unsigned k = 0; k < (unsigned)n_cells; k++) {
        Cell cell = {.n = n};
        for (unsigned i = 0, left = k; i < n; left /= (unsigned)counts[i++])
            cell.at[i] = (uint64_t)((int64_t)first[i] + left % (unsigned)counts[i]);
        add_cell(&cell, low, high, least, most);
    }
    *least = drawn_in(*least);
    *most = drawn_in(*most);
    return true;
}

/* ---- gradient noise ---- */

static double fade(double t)
{
    return t * t * t * (t * (t * 6 - 15) + 10);
}

/* The lattice cell that a point is in. */
typedef struct GradientCell {
    uint64_t hashes[8]; /* of the corners; x changes first */
    double t[3];        /* where in the cell, 0..1 */
    double weight[3];
} GradientCell;

static void cell_at(Vec3 p, uint64_t seed, GradientCell *cell)
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

static double mixed(const GradientCell *cell, unsigned shift)
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
    GradientCell cell;
    cell_at(p, seed, &cell);
    return mixed(&cell, 0);
}

Vec3 noise_gradient3(Vec3 p, uint64_t seed)
{
    GradientCell cell;
    cell_at(p, seed, &cell);
    return vec3(mixed(&cell, 0), mixed(&cell, 16), mixed(&cell, 32));
}
