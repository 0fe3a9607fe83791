/* evenness.c - slopes of neighbourhoods, and the variance of sums of unequal pieces.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/evenness.h"

#include <math.h>
#include <stdlib.h>

#include "render/around.h"

/* How far neighbours are asked, in pixels: two blocks of the sampler, whose errors go together. */
enum { FAR = 8 };
/* The slopes that are believed: of smooth functions, of independent samples, and the slowest. */
#define STEEPEST (-1.5)
#define BY_CHANCE (-0.5)
#define SLOWEST (-0.15)
/* Between a power law, 1, and the mixture of extremes, 0. Measured on examples from smooth to caustics. */
#define POWER_LAW 0.8
/* How mean errors grow with the factor of the differences beyond that of chance. Rare events of equal brightness have nearly 1
 * for the most of the range, and 3.4 for all of it; scenes have pixels of all kinds. Measured as above. */
#define RARE 1.5

/* Of the mean of n samples, and of the difference that film_spread takes: where differences fall by r, in units of D of
 * pieces as large as the first part. */
typedef struct Variances {
    double mean, difference;
} Variances;

static Variances variances(double r, uint32_t n)
{
    uint32_t n_first = film_first_part(n), n_rest = n - n_first;
    double d = 1, rest = 0, done = 0;
    for (uint32_t size = n_first; size > 1; size /= 2) d /= r;
    /* The rest consists of ever smaller pieces. Each is in the half beside the one before it, so that their covariance is
     * that of these halves, V - D / 2. */
    for (uint32_t size = 1; size <= n_rest; size *= 2, d *= r) {
        if (!(n_rest & size)) continue;
        double variance = d / (4 * (1 - r)), all = size + done;
        rest = (size * (size * variance + 2 * done * (variance - d / 2)) + done * done * rest) / (all * all);
        done = all;
    }
    double first = 1 / (4 * (1 - r)), covariance = first - 0.5, a = n_first / (double)n, b = n_rest / (double)n;
    return (Variances){a * a * first + b * b * rest + 2 * a * b * covariance, first + rest - 2 * covariance};
}

double evenness_factor(double slope, uint32_t n)
{
    const double fastest = exp2(2 * STEEPEST), slowest = exp2(2 * BY_CHANCE);
    if (!(slope < BY_CHANCE)) return 1;
    double r = exp2(2 * fmax(slope, STEEPEST)), slow = (r - fastest) / (slowest - fastest);
    Variances by_law = variances(r, n), b = variances(slowest, n);
    double factor = by_law.mean / by_law.difference, independent = b.mean / b.difference;
    uint32_t n_first = film_first_part(n);
    if (n - n_first >= n_first / 2 && (n & (n_first / 2 - 1)) == 0) { /* not of pieces far smaller than the ladder's */
        Variances a = variances(fastest, n);
        /* the shares of the two are those of two octaves before */
        double share_a = (1 - slow) * fastest * fastest, share_b = slow * slowest * slowest;
        double mixed = (share_a * a.mean + share_b * b.mean) / (share_a * a.difference + share_b * b.difference);
        factor = pow(factor, POWER_LAW) * pow(mixed, 1 - POWER_LAW);
    }
    return sqrt(factor / independent);
}

static double slope_at(const Evenness *evenness, uint32_t x, uint32_t y)
{
    const uint32_t *area = evenness->area;
    return (double)evenness->slope[(size_t)(y - area[1]) * (area[2] - area[0]) + (x - area[0])];
}

double evenness_of_error(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n)
{
    double slope = slope_at(evenness, x, y);
    if (slope < BY_CHANCE) return evenness_factor(slope, n);
    return 1 + RARE * (exp2(fmin(slope, SLOWEST)) - exp2(BY_CHANCE));
}

double evenness_of_square(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n)
{
    return evenness_factor(slope_at(evenness, x, y), n);
}

/* Adds what one rung of the pixels' ladders has to do with the slope of a straight line through the logarithms of all. */
static void add_rung(Evenness *evenness, const Film *film, int rung, float *map, float *scratch, float *mean)
{
    static const float of_line[FILM_LADDER] = {0.3f, 0.1f, -0.1f, -0.3f};
    const uint32_t *area = evenness->area, width = area[2] - area[0], height = area[3] - area[1];
    size_t n = 0;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++) {
            float ladder[FILM_LADDER];
            film_ladder(film_pixel(film, x, y), ladder);
            map[n++] = ladder[rung];
        }
    mean_around(map, width, height, FAR, scratch, mean);
    for (size_t i = 0; i < n; i++)
        evenness->slope[i] += 2 * of_line[rung] * log2f(mean[i]); /* of squares of mean roots */
}

Status evenness_init(Evenness *evenness, const Film *film, const uint32_t area[4], Error *error)
{
    *evenness = (Evenness){.area = {area[0], area[1], area[2], area[3]}};
    size_t n = (size_t)(area[2] - area[0]) * (area[3] - area[1]);
    float *maps = malloc(3 * n * sizeof *maps);
    evenness->slope = calloc(n, sizeof *evenness->slope);
    if (!maps || !evenness->slope) {
        free(maps);
        evenness_clear(evenness);
        return fail_memory(error, 4 * n * sizeof *maps, "the noise of the picture");
    }
    for (int rung = 0; rung < FILM_LADDER; rung++) add_rung(evenness, film, rung, maps, maps + n, maps + 2 * n);
    free(maps);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(evenness->slope[i]))
            evenness->slope[i] = (float)BY_CHANCE; /* nothing differs around, or too few */
    return STATUS_OK;
}

void evenness_clear(Evenness *evenness)
{
    free(evenness->slope);
    *evenness = (Evenness){0};
}
