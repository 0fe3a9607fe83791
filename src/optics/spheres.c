/* spheres.c - see spheres.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/spheres.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "optics/large_sphere.h"
#include "optics/mie.h"

double spheres_water_index(double wavelength_nm)
{
    static const double b[] = {.5684027565, .1726177391, .02086189578, .1130748688};
    static const double c[] = {.005101829712, .01821153936, .02620722293, 10.69792721};
    double w2 = wavelength_nm * wavelength_nm * 1e-6, sum = 1;
    for (size_t i = 0; i < COUNT_OF(b); i++) sum += b[i] * w2 / (w2 - c[i]);
    return sqrt(sum);
}

/* ---- sizes ---- */

/* Spheres of about one size, and how much of all shadows is theirs. */
typedef struct Bin {
    double x, spread, weight;
    size_t first, n_terms; /* of its series; n_terms 0: it is a large one */
} Bin;

/* From bin to bin what a sphere mirrors and what comes back from its far side, a way of 4 m x apart, get out of step by this much: by
 * less than a wave, so that in the mean they cancel out. */
#define MIE_STEP 5.0
/* Sizes of which there are e^-6 of the most frequent are left out. */
#define RARE (-6.0)
enum { FEWEST_BINS = 48, MOST_BINS = 1024 };

/* The logarithm of how much of all shadows spheres have of t times the mean diameter, but for a constant. */
static double log_share(double t, double variance)
{
    return (1 / variance - 1) * log(t) - t / variance;
}

static void find_range(double variance, double range[2])
{
    double top = 1 - variance, most = log_share(top, variance);
    range[0] = top;
    range[1] = top;
    while (range[0] > 1e-3 && log_share(range[0], variance) > most + RARE) range[0] *= 0.99;
    while (log_share(range[1], variance) > most + RARE) range[1] *= 1.01;
}

/* *n_terms: of all bins' series. */
static uint32_t make_bins(const Spheres *spheres, uint32_t wave, Bin bins[MOST_BINS], size_t *n_terms)
{
    double variance = spheres->width * spheres->width, range[2];
    double x_of_mean = MEN_PI * spheres->diameter_um * 1000 * spheres->around[wave] / phase_table_nm(wave);
    uint32_t n = 0;
    find_range(variance, range);
    *n_terms = 0;
    for (double t = range[0]; t < range[1] && n < MOST_BINS; n++) {
        double step = (range[1] - range[0]) / FEWEST_BINS;
        if (t * x_of_mean < SPHERES_BORDER)
            step = fmin(step, MIE_STEP / (4 * fmin(fmax(spheres->index[wave], 1), 1.6) * x_of_mean));
        double middle = t + 0.5 * step, x = middle * x_of_mean;
        bins[n] = (Bin){.x = x, .spread = step / middle, .first = *n_terms};
        bins[n].weight = step * exp(log_share(middle, variance) - log_share(1 - variance, variance));
        if (x < SPHERES_BORDER) bins[n].n_terms = mie_terms(x);
        *n_terms += bins[n].n_terms;
        t += step;
    }
    return n;
}

/* ---- angles ---- */

/* Nodes are as close as rings, bows and the glory need; angles in radians from straight on. A list without room counts them. */
static uint32_t make_angles(const Spheres *spheres, double *angles)
{
    double x = MEN_PI * spheres->diameter_um * 2; /* in the middle of the spectrum */
    double ring = MEN_PI / x, bow = 0.25 * pow(x, -2.0 / 3), most = fmin(fmax(bow, 0.1 * MEN_DEGREE), 0.5 * MEN_DEGREE);
    uint32_t n = 0;
    for (double angle = 0; angle < MEN_PI - 0.035 * MEN_DEGREE; n++) { /* closer to 1 floats are too coarse */
        if (angles) angles[n] = angle;
        double ahead = fmax(0.03 * angle, 0.05 * ring), behind = fmax(0.03 * (MEN_PI - angle), 0.1 * ring);
        angle += fmin(fmin(ahead, fmax(behind, 0.05 * MEN_DEGREE)), most);
    }
    if (angles) angles[n] = MEN_PI;
    return n + 1;
}

/* ---- waves ---- */

typedef struct Scratch {
    MieNumber *numbers; /* a, b, and what they are made by */
    MieTerm *terms;     /* of all bins */
    MieAngles *angles;
} Scratch;

typedef struct SpheresTask {
    const Spheres *spheres;
    PhaseTable *table;
    const double *angles;
    const LargeAiry *airy;
    Scratch *scratches; /* of each worker */
} SpheresTask;

static size_t most_terms(void)
{
    return mie_terms(SPHERES_BORDER);
}

static size_t most_numbers(void)
{
    return mie_scratch(SPHERES_BORDER, (MieNumber){SPHERES_MOST_INDEX, 0});
}

static void scratch_clear(Scratch *scratch)
{
    free(scratch->numbers);
    free(scratch->terms);
    free(scratch->angles);
}

static bool scratch_init(Scratch *scratch, size_t n_terms)
{
    scratch->numbers = calloc(2 * most_terms() + most_numbers(), sizeof *scratch->numbers);
    scratch->terms = calloc(n_terms + 1, sizeof *scratch->terms);
    scratch->angles = aligned_alloc(_Alignof(MieAngles), most_terms() * sizeof *scratch->angles);
    return scratch->numbers && scratch->terms && scratch->angles;
}

static void make_series(const Scratch *scratch, const Bin *bin, double index)
{
    MieNumber *a = scratch->numbers, *b = a + most_terms(), *rest = b + most_terms();
    mie_coefficients(bin->x, (MieNumber){index, 0}, rest, a, b);
    mie_make_terms(a, b, bin->n_terms, scratch->terms + bin->first);
}

/* What small spheres scatter into MIE_ANGLES directions from node i on. */
static void add_small(const SpheresTask *task, const Scratch *scratch, const Bin *bins, uint32_t n_bins, uint32_t i,
                      double sums[MIE_ANGLES])
{
    double cosines[MIE_ANGLES];
    size_t n = 0;
    for (uint32_t k = 0; k < n_bins; k++)
        if (bins[k].n_terms > n) n = bins[k].n_terms;
    if (n == 0) return;
    for (uint32_t k = 0; k < MIE_ANGLES; k++)
        cosines[k] = cos(task->angles[i + k < task->table->n_nodes ? i + k : task->table->n_nodes - 1]);
    mie_angles(cosines, n, scratch->angles);
    for (uint32_t k = 0; k < n_bins; k++) {
        if (bins[k].n_terms == 0) continue;
        Lanes intensity[2];
        double scale = bins[k].weight / (bins[k].x * bins[k].x);
        mie_intensities(scratch->terms + bins[k].first, bins[k].n_terms, scratch->angles, intensity);
        for (int j = 0; j < MIE_ANGLES; j++) sums[j] += scale * (double)lanes_get(intensity[j / LANES], j % LANES);
    }
}

/* What is diffracted around large drops goes on within the breadth of the sun, half of all that they scatter. It would be found by
 * chance alone, as a bright spot wherever a path happens to be scattered towards the sun. So it counts as not scattered, more and
 * more from where its first dark ring is of a radius of 0.36 degrees to 0.18. */
static double diffracted_part(double x)
{
    const double all = 600, none = 1200;
    return fmin(fmax((none - x) / (none - all), 0), 1);
}

static double large_at(const SpheresTask *task, const Bin *bins, uint32_t n_bins, double index, double angle)
{
    LargeRays rays;
    double sum = 0;
    large_rays(index, angle, &rays);
    for (uint32_t k = 0; k < n_bins; k++) {
        if (bins[k].n_terms > 0) continue;
        sum += bins[k].weight *
               (double)large_intensity(task->airy, &rays, bins[k].x, bins[k].spread, angle, diffracted_part(bins[k].x));
    }
    return sum;
}

static void task_of_wave(void *context, uint32_t wave, unsigned worker)
{
    const SpheresTask *task = context;
    const Scratch *scratch = &task->scratches[worker];
    PhaseTable *table = task->table;
    Bin bins[MOST_BINS];
    size_t n_terms;
    uint32_t n_bins = make_bins(task->spheres, wave, bins, &n_terms);
    double index = task->spheres->index[wave];
    bool any_large = false;
    for (uint32_t k = 0; k < n_bins; k++) {
        if (bins[k].n_terms > 0)
            make_series(scratch, &bins[k], index);
        else
            any_large = true;
    }
    for (uint32_t i = 0; i < table->n_nodes; i += MIE_ANGLES) {
        double sums[MIE_ANGLES] = {0};
        add_small(task, scratch, bins, n_bins, i, sums);
        for (uint32_t k = 0; k < MIE_ANGLES && i + k < table->n_nodes; k++) {
            if (any_large) sums[k] += large_at(task, bins, n_bins, index, task->angles[i + k]);
            table->values[(size_t)(i + k) * table->n_waves + wave] = (float)sums[k];
        }
    }
}

/* ---- the table ---- */

static void set_recipe(Arena *arena, const Spheres *spheres, PhaseTable *table)
{
    Spheres *copy = ARENA_NEW(arena, Spheres);
    *copy = *spheres;
    table->recipe = copy;
    table->recipe_size = sizeof *copy;
}

PhaseTable *spheres_stand_in(Arena *arena, const Spheres *spheres)
{
    PhaseTable *table = phase_table_new(arena, 2, 1);
    table->nodes[1] = 1;
    for (int i = 0; i < 2; i++) table->values[i] = 1;
    phase_table_finish(table);
    set_recipe(arena, spheres, table);
    return table;
}

static bool run(SpheresTask *task, Pool *pool)
{
    unsigned n_workers = pool_threads(pool);
    size_t most = 0;
    bool fine = true;
    for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
        Bin bins[MOST_BINS];
        size_t n_terms;
        (void)make_bins(task->spheres, k, bins, &n_terms);
        if (n_terms > most) most = n_terms;
    }
    LargeAiry *airy = malloc(sizeof *airy);
    task->airy = airy;
    task->scratches = calloc(n_workers, sizeof *task->scratches);
    fine = airy && task->scratches;
    for (unsigned i = 0; fine && i < n_workers; i++) fine = scratch_init(&task->scratches[i], most);
    if (fine) {
        large_airy(airy);
        pool_run(pool, PHASE_TABLE_WAVES, task_of_wave, task);
    }
    for (unsigned i = 0; task->scratches && i < n_workers; i++) scratch_clear(&task->scratches[i]);
    free(task->scratches);
    free(airy);
    return fine;
}

PhaseTable *spheres_table(Arena *arena, const Spheres *spheres, Pool *pool)
{
    uint32_t n = make_angles(spheres, NULL);
    double *angles = ARENA_ARRAY(arena, double, n);
    PhaseTable *table = phase_table_new(arena, n, PHASE_TABLE_WAVES);
    make_angles(spheres, angles);
    for (uint32_t i = 0; i < n; i++) {
        double sine = sin(0.5 * angles[i]);
        table->nodes[i] = (float)(sine * sine);
    }
    table->nodes[n - 1] = 1;
    set_recipe(arena, spheres, table);
    SpheresTask task = {.spheres = spheres, .table = table, .angles = angles};
    if (!run(&task, pool)) return NULL;
    phase_table_finish(table);
    return table;
}
