/* evenness.c - slopes of neighbourhoods, and the variance of sums of unequal pieces.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/evenness.h"

#include <math.h>
#include <stdlib.h>

#include "render/around.h"

/* How far neighbours are asked, in pixels: four blocks of the sampler, each of whose pixels' errors go together. What is asked
 * for varies less over a picture than it differs by chance from block to block. */
enum { FAR = 16 };
/* The slopes that are believed: of smooth functions, of independent samples, and the slowest. */
#define STEEPEST (-1.5)
#define BY_CHANCE (-0.5)
#define SLOWEST (-0.15)
/* How mean errors grow with the factor of the differences beyond that of chance. Rare events of equal brightness have nearly 1
 * for the most of the range, and 3.4 for all of it; scenes have pixels of all kinds. Measured in the same way. */
#define RARE 1.5

/* What of the alternation is foretold. Measured on examples from smooth to caustics. */
#define COMES_BACK 0.5f

/* Of the mean of n samples, and of the difference that film_spread takes: where differences fall by r, in units of D of
 * pieces as large as the first part. */
typedef struct Variances {
    double mean, difference;
} Variances;

/* D_k falls by r with each k, times `other` where k is not of the kind of the first part's pieces. */
static Variances variances(double r, double other, uint32_t n)
{
    uint32_t n_first = film_first_part(n), n_rest = n - n_first;
    double d = 1, rest = 0, done = 0, kinds[2] = {1, other};
    int kind = 0;
    for (uint32_t size = n_first; size > 1; size /= 2, kind = !kind) d /= r;
    /* The rest consists of ever smaller pieces. Each is in the half beside the one before it, so that their covariance is
     * that of these halves, V - D / 2. */
    for (uint32_t size = 1; size <= n_rest; size *= 2, d *= r, kind = !kind) {
        if (!(n_rest & size)) continue;
        double variance = d * (kinds[kind] + r * kinds[!kind]) / (4 * (1 - r * r));
        rest = (size * (size * variance + 2 * done * (variance - d * kinds[kind] / 2)) + done * done * rest) /
               ((size + done) * (size + done));
        done += size;
    }
    double first = (1 + r * other) / (4 * (1 - r * r)), covariance = first - 0.5;
    double a = n_first / (double)n, b = n_rest / (double)n;
    return (Variances){a * a * first + b * b * rest + 2 * a * b * covariance, first + rest - 2 * covariance};
}

double evenness_factor(double slope, double excess, uint32_t n)
{
    if (!(slope < BY_CHANCE)) return 1;
    Variances by_law = variances(exp2(2 * fmax(slope, STEEPEST)), exp2(-2 * excess), n);
    Variances independent = variances(exp2(2 * BY_CHANCE), 1, n);
    return sqrt(by_law.mean / by_law.difference / (independent.mean / independent.difference));
}

static size_t place_of(const Evenness *evenness, uint32_t x, uint32_t y)
{
    return (size_t)y * evenness->width + x;
}

double evenness_of_square(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n)
{
    size_t i = place_of(evenness, x, y);
    return evenness_factor((double)evenness->slope[i], (double)evenness->excess[i], n);
}

double evenness_of_error(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n)
{
    double slope = (double)evenness->slope[place_of(evenness, x, y)];
    if (slope < BY_CHANCE) return evenness_of_square(evenness, x, y, n);
    return 1 + RARE * (exp2(fmin(slope, SLOWEST)) - exp2(BY_CHANCE));
}

typedef struct Ladders {
    Evenness *evenness;
    const Film *film;
    uint32_t width;
    float *rungs[FILM_LADDER]; /* of each pixel's ladder, */
    int rung;                  /* and the one that counts now: */
    float *mean;               /* of the pixels around */
} Ladders;

static void climb_row(void *context, uint32_t row, unsigned worker)
{
    const Ladders *ladders = context;
    (void)worker;
    for (uint32_t x = 0; x < ladders->width; x++) {
        float ladder[FILM_LADDER];
        film_ladder(film_pixel(ladders->film, x, row), ladder);
        for (int rung = 0; rung < FILM_LADDER; rung++)
            ladders->rungs[rung][(size_t)row * ladders->width + x] = ladder[rung];
    }
}

/* Adds what one rung has to do with the slope and the excess of a line through the logarithms of all that alternates, in so
 * far as that comes back. */
static void add_rung_to_row(void *context, uint32_t row, unsigned worker)
{
    static const float straight[FILM_LADDER] = {0.3f, 0.1f, -0.1f, -0.3f},
                       alternating[FILM_LADDER] = {0.25f, 0.25f, -0.25f, -0.25f},
                       excess[FILM_LADDER] = {0.125f, -0.375f, 0.375f, -0.125f};
    const Ladders *ladders = context;
    (void)worker;
    int rung = ladders->rung;
    const float of_line = straight[rung] + COMES_BACK * (alternating[rung] - straight[rung]),
                of_excess = 2 * COMES_BACK * excess[rung];
    size_t from = (size_t)row * ladders->width;
    for (size_t i = from; i < from + ladders->width; i++) {
        float logarithm = 2 * log2f(ladders->mean[i]); /* of squares of mean roots */
        ladders->evenness->slope[i] += of_line * logarithm;
        ladders->evenness->excess[i] += of_excess * logarithm;
    }
}

Status evenness_init(Evenness *evenness, const Film *film, Pool *pool, Error *error)
{
    const uint32_t width = film->width, height = film->height;
    *evenness = (Evenness){.width = width};
    size_t n = (size_t)width * height;
    float *maps = malloc((FILM_LADDER + 2) * n * sizeof *maps), *scratch = maps + FILM_LADDER * n;
    evenness->slope = calloc(n, sizeof *evenness->slope);
    evenness->excess = calloc(n, sizeof *evenness->excess);
    if (!maps || !evenness->slope || !evenness->excess) {
        free(maps);
        evenness_clear(evenness);
        return fail_memory(error, (FILM_LADDER + 4) * n * sizeof *maps, "the noise of the picture");
    }
    Ladders ladders = {.evenness = evenness, .film = film, .width = width, .mean = scratch + n};
    for (int rung = 0; rung < FILM_LADDER; rung++) ladders.rungs[rung] = maps + (size_t)rung * n;
    pool_run(pool, height, climb_row, &ladders);
    for (int rung = 0; rung < FILM_LADDER; rung++) {
        ladders.rung = rung;
        mean_around(ladders.rungs[rung], width, height, FAR, scratch, ladders.mean, pool);
        pool_run(pool, height, add_rung_to_row, &ladders);
    }
    free(maps);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(evenness->slope[i]) || !isfinite(evenness->excess[i])) { /* nothing differs around, or too few */
            evenness->slope[i] = (float)BY_CHANCE;
            evenness->excess[i] = 0;
        }
    return STATUS_OK;
}

void evenness_clear(Evenness *evenness)
{
    free(evenness->slope);
    free(evenness->excess);
    *evenness = (Evenness){0};
}
