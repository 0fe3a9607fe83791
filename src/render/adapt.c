/* adapt.c - errors of neighbourhoods, and what follows from them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/adapt.h"

#include <math.h>
#include <stdlib.h>

#include "render/around.h"
#include "render/evenness.h"

/* How far neighbours are asked, in pixels: for the luminance; those close by, so that what is thin is seen; more around, so
 * that what is rare is, of which two answers the worse counts; and how the error of a mean compares with the deviation of
 * its samples, which are spread evenly and may be anything but normal. */
enum { NEXT = 1, NEAR = 2, WIDE = 4, FAR = 8 };
/* Where the mean number of samples is given: what a sample costs besides its rays, in rays; a pixel gets no less than this part of
 * the mean, for what its neighbours have not met yet; and plans look ahead to so many times the samples that there are, of which
 * a pixel gets no more than those that it has before it is asked again. What is given where less than this part of all samples
 * is left for that is given at once. */
#define COST_OF_PATH 1
enum { LEAST_PART = 4, AHEAD = 4, GROWTH = 2, LAST_PART = 32 };
/* Errors of mean squares fall as n^-p, p = 1 for independent samples, and up to 2 for such as are evenly spread, so that the
 * numbers for which they are least, of a given cost of all, are in proportion to (square / cost)^(1 / (1 + p)). What is known of
 * errors is in doubt besides, and the truth nearer to what is usual: a lower power is better. Measured on ten examples, with 32
 * samples, by the error at equal times; powers from 0.7 to 1 differ by 2 in a hundred. */
#define POWER_OF_ERROR 0.8
#define POWER_OF_COST 0.5

/* dark: see adapt_dark */
static double relative(double error, double luminance, double dark)
{
    return error / sqrt(luminance * luminance + dark * dark);
}

static double pixel_luminance(const Film *film, uint32_t x, uint32_t y)
{
    const FilmPixel *pixel = film_pixel(film, x, y);
    return pixel->n ? (double)pixel->luminance * FILM_UNIT / pixel->n : 0;
}

double adapt_dark(const Brightness *brightness, Exposure exposure)
{
    return 0.1 * brightness_white(brightness, exposure);
}

/* Of the picture that these pixels are so far. */
static double dark_of(const Film *film, Exposure exposure)
{
    Brightness brightness = {0};
    for (uint32_t y = 0; exposure.automatic && y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            if (film_alpha(film_pixel(film, x, y)) > 0) brightness_note(&brightness, pixel_luminance(film, x, y));
    return adapt_dark(&brightness, exposure);
}

/* Of the pixels around one, not of itself: a firefly would else be small in relation to the light that it brings. */
static double luminance_around(const Film *film, uint32_t x, uint32_t y)
{
    double sum = 0, weights = 0;
    for (uint32_t v = y > 0 ? y - 1 : y; v <= y + 1 && v < film->height; v++)
        for (uint32_t u = x > 0 ? x - 1 : x; u <= x + 1 && u < film->width; u++) {
            double weight = u == x && v == y ? 0 : u == x || v == y ? 2 : 1;
            sum += weight * pixel_luminance(film, u, v);
            weights += weight;
        }
    return weights > 0 ? sum / weights : pixel_luminance(film, x, y);
}

/* The error of a pixel's mean, as if it had one sample: of two or more. */
static double pixel_error(const Film *film, const Evenness *evenness, uint32_t x, uint32_t y)
{
    const FilmPixel *pixel = film_pixel(film, x, y);
    return film_spread(pixel) * evenness_of_error(evenness, x, y, pixel->n);
}

/* What is left of a pixel's error when samples that stood alone have gone, and what came with others'. These are not all
 * where they belong: as measured (bench stated), about half of what they took of the error is left as blur. */
static double error_after(double error, const Spread *spread, uint32_t x, uint32_t y)
{
    const double normal = 0.6366; /* the square of the mean deviation over the variance */
    const SpreadPixel *moved = spread_pixel(spread, x, y);
    double without_blur = sqrt(error * error * fmax(1 - moved->taken, 0) + normal * moved->given);
    return fmax(without_blur, 0.5 * (error + without_blur));
}

/* Whether all pixels have two samples or more. */
static bool has_pairs(const Film *film)
{
    uint32_t least, most;
    uint64_t sum;
    film_count_samples(film, &least, &most, &sum);
    return least >= 2;
}

typedef struct Judgement {
    const Film *film;
    const Spread *spread; /* NULL: none */
    const Evenness *evenness;
    double dark;
    double *sums; /* of the noise, of each row */
} Judgement;

static void judge_row(void *context, uint32_t y, unsigned worker)
{
    const Judgement *j = context;
    (void)worker;
    double sum = 0;
    for (uint32_t x = 0; x < j->film->width; x++) {
        double error = pixel_error(j->film, j->evenness, x, y) / sqrt(film_pixel(j->film, x, y)->n);
        if (j->spread) error = error_after(error, j->spread, x, y);
        sum += relative(error, luminance_around(j->film, x, y), j->dark);
    }
    j->sums[y] = sum;
}

double adapt_noise(const Film *film, const Spread *spread, Exposure exposure, Pool *pool)
{
    Evenness evenness;
    Error unused; /* the picture is not to suffer */
    const uint32_t height = film->height;
    if (film->first_sample || !has_pairs(film)) return -1;
    double *sums = malloc((height + 1U) * sizeof *sums), sum = 0;
    if (!sums || evenness_init(&evenness, film, pool, &unused) != STATUS_OK) {
        free(sums);
        return -1;
    }
    Judgement judgement = {film, spread, &evenness, dark_of(film, exposure), sums};
    pool_run(pool, height, judge_row, &judgement);
    for (uint32_t row = 0; row < height; row++) sum += sums[row];
    evenness_clear(&evenness);
    free(sums);
    uint64_t n = (uint64_t)height * film->width;
    return n ? sum / (double)n : -1;
}

Status adapt_init(Adapt *adapt, const Film *film, Exposure exposure, Error *error)
{
    *adapt = (Adapt){.exposure = exposure};
    size_t n = (size_t)film->width * film->height;
    adapt->wanted = calloc(n, sizeof *adapt->wanted);
    bool ready = adapt->wanted != NULL;
    for (size_t i = 0; i < COUNT_OF(adapt->maps); i++)
        ready = (adapt->maps[i] = calloc(n, sizeof(float))) != NULL && ready;
    if (ready) return STATUS_OK;
    adapt_clear(adapt);
    return fail_memory(error, n * (sizeof *adapt->wanted + COUNT_OF(adapt->maps) * sizeof(float)),
                       "the noise of the picture");
}

void adapt_clear(Adapt *adapt)
{
    free(adapt->wanted);
    for (size_t i = 0; i < COUNT_OF(adapt->maps); i++) free(adapt->maps[i]);
    *adapt = (Adapt){0};
}

/* The first of 2, 3, 4, 6, 8, 12, ... that is below neither. */
static uint32_t next_step(uint32_t n, double least)
{
    uint32_t step = 2;
    while (step < n || step < least) step = step & (step - 1) ? step / 3 * 4 : step / 2 * 3;
    return step;
}

typedef struct Reading {
    const Adapt *adapt;
    const Film *film;
    const Evenness *evenness;
} Reading;

static void read_row(void *context, uint32_t y, unsigned worker)
{
    const Reading *reading = context;
    (void)worker;
    float *const *maps = reading->adapt->maps;
    size_t i = (size_t)y * reading->film->width;
    for (uint32_t x = 0; x < reading->film->width; x++, i++) {
        const FilmPixel *pixel = film_pixel(reading->film, x, y);
        double mean, of_samples;
        film_luminance(pixel, &mean, &of_samples);
        maps[ADAPT_FAR_ERROR][i] = (float)mean; /* the luminance, for now */
        maps[ADAPT_DEVIATION][i] = (float)(of_samples * sqrt(pixel->n));
        maps[ADAPT_ERROR][i] = (float)pixel_error(reading->film, reading->evenness, x, y);
    }
}

/* What every pixel's neighbours say of it: those close by, and more around where wide is not 0. */
static Status make_maps(Adapt *adapt, const Film *film, uint32_t near, uint32_t wide, Pool *pool, Error *error)
{
    Evenness evenness;
    TRY(evenness_init(&evenness, film, pool, error));
    const uint32_t width = film->width, height = film->height;
    size_t n = (size_t)width * height;
    float **maps = adapt->maps, *scratch = maps[ADAPT_SCRATCH];
    Reading reading = {adapt, film, &evenness};
    pool_run(pool, height, read_row, &reading);
    evenness_clear(&evenness);
    mean_around(maps[ADAPT_FAR_ERROR], width, height, NEXT, scratch, maps[ADAPT_LUMINANCE], pool);
    mean_around(maps[ADAPT_ERROR], width, height, FAR, scratch, maps[ADAPT_FAR_ERROR], pool);
    mean_around(maps[ADAPT_DEVIATION], width, height, FAR, scratch, maps[ADAPT_ERROR], pool);
    for (size_t i = 0; i < n; i++) {
        float deviation = maps[ADAPT_ERROR][i];
        maps[ADAPT_FAR_ERROR][i] = deviation > 0 ? maps[ADAPT_FAR_ERROR][i] / deviation : 0;
    }
    mean_around(maps[ADAPT_DEVIATION], width, height, near, scratch, maps[ADAPT_NEAR], pool);
    mean_around(maps[ADAPT_DEVIATION], width, height, wide ? wide : near, scratch, maps[ADAPT_ERROR], pool);
    for (size_t i = 0; i < n; i++)
        maps[ADAPT_ERROR][i] =
            fmaxf(maps[ADAPT_NEAR][i], maps[ADAPT_ERROR][i]) * fmaxf(maps[ADAPT_FAR_ERROR][i], 0); /* of rounded sums */
    return STATUS_OK;
}

Status adapt_plan(Adapt *adapt, const Film *film, double noise, uint32_t most, Pool *pool, AdaptPlan *result,
                  Error *error)
{
    AdaptPlan plan = {0};
    TRY(make_maps(adapt, film, NEAR, WIDE, pool, error));
    const double dark = dark_of(film, adapt->exposure);
    size_t i = 0;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++, i++) {
            uint32_t n = film_pixel(film, x, y)->n;
            double one = (double)adapt->maps[ADAPT_ERROR][i], luminance = (double)adapt->maps[ADAPT_LUMINANCE][i];
            double enough = pow(relative(one, luminance, dark) / noise, 2);
            adapt->wanted[i] = n;
            plan.unmet += n >= most && enough > n;
            if (n >= most) continue;
            plan.at_most += most - n;
            if (enough <= n) continue;
            uint32_t step = next_step(n, fmin(enough, 2.0 * n));
            adapt->wanted[i] = step < most ? step : most;
            uint32_t last = next_step(n, fmin(enough, most));
            plan.left += (last < most ? last : most) - n;
            if (adapt->wanted[i] - n > plan.next) plan.next = adapt->wanted[i] - n;
        }
    *result = plan;
    return STATUS_OK;
}

/* Of a pixel that has n samples, and gets `least` or more, when its need is scaled so. */
static double share_of(double n, double need, double scale, double least)
{
    return fmin(fmax(fmax(n, least), scale * need), FILM_MOST_SAMPLES);
}

/* The scale by which all shares come to the mean, or as near below it as they do. */
static double find_scale(const float *have, const float *need, size_t pixels, double mean, double least)
{
    double needs = 0, all = mean * (double)pixels;
    for (size_t i = 0; i < pixels; i++) needs += (double)need[i];
    double low = 0, high = needs > 0 ? all / needs : 0;
    for (int round = 0; round < 48; round++) {
        double scale = 0.5 * (low + high), sum = 0;
        for (size_t i = 0; i < pixels; i++) sum += share_of((double)have[i], (double)need[i], scale, least);
        *(sum < all ? &low : &high) = scale;
    }
    return low;
}

/* The last of 2, 3, 4, 6, ... up to what is not less. */
static uint32_t step_below(double samples)
{
    uint32_t upper = next_step(2, samples);
    return upper <= samples ? upper : upper & (upper - 1) ? upper / 3 * 2 : upper / 4 * 3;
}

/* A number of samples that fills strata, next to `samples` on either side, so that the mean over pixels is kept. */
static uint32_t step_near(uint32_t n, double samples, uint32_t x, uint32_t y)
{
    if (samples <= n) return n;
    uint32_t upper = next_step(2, samples), lower = step_below(samples);
    if (lower < n) lower = n;
    double even =
        x * 0.7548776662466927 + y * 0.5698402909980533; /* the R2 sequence: its values are even in any region */
    return lower + (even - floor(even)) * (upper - lower) < samples ? upper : lower;
}

/* What numbers of samples are to be in proportion to. */
static void find_need(Adapt *adapt, const Film *film, Pool *pool)
{
    const uint32_t width = film->width, height = film->height;
    float **maps = adapt->maps, *cost = maps[ADAPT_FAR_ERROR];
    const double dark = dark_of(film, adapt->exposure);
    size_t i = 0;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++, i++) {
            const FilmPixel *pixel = film_pixel(film, x, y);
            maps[ADAPT_DEVIATION][i] = (float)((double)pixel->rays / pixel->n);
        }
    mean_around(maps[ADAPT_DEVIATION], width, height, NEXT, maps[ADAPT_SCRATCH], cost, pool);
    for (size_t j = 0; j < i; j++) {
        double error = relative((double)maps[ADAPT_ERROR][j], (double)maps[ADAPT_LUMINANCE][j], dark);
        maps[ADAPT_NEAR][j] =
            (float)(pow(error, POWER_OF_ERROR) / pow(fmax((double)cost[j], 0) + COST_OF_PATH, POWER_OF_COST));
    }
}

/* What pixels want of their shares; returns how many samples these are. now: all of them, else whole steps, and of what is more
 * than the least no more than GROWTH times what they have. */
static double want_shares(Adapt *adapt, const Film *film, double scale, double least, bool now)
{
    const float *have = adapt->maps[ADAPT_DEVIATION], *need = adapt->maps[ADAPT_NEAR];
    const size_t pixels = (size_t)film->width * film->height;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t n = (uint32_t)have[i];
        double share = share_of(n, (double)need[i], scale, least);
        uint32_t part = step_below(fmin(share, fmax(GROWTH * (double)n, least)));
        if (now) part = step_near(n, share, (uint32_t)(i % film->width), (uint32_t)(i / film->width));
        adapt->wanted[i] = part > n ? part : n;
        sum += adapt->wanted[i] - n;
    }
    return sum;
}

Status adapt_share(Adapt *adapt, const Film *film, uint32_t samples, Pool *pool, AdaptPlan *plan, Error *error)
{
    *plan = (AdaptPlan){0};
    TRY(make_maps(adapt, film, NEXT, 0, pool, error));
    find_need(adapt, film, pool);
    float *have = adapt->maps[ADAPT_DEVIATION];
    const size_t pixels = (size_t)film->width * film->height;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        have[i] = (float)film->pixels[i].n;
        adapt->wanted[i] = (uint32_t)have[i];
        sum += (double)have[i];
    }
    double all = (double)samples * (double)pixels, ahead = fmin(AHEAD * sum, all) / (double)pixels;
    double least =
        next_step(2, 0.95 * fmin(GROWTH * sum, all) / (double)pixels / LEAST_PART); /* 24 is a quarter of 100 */
    if (sum > 0.99 * all) return STATUS_OK;
    double scale = find_scale(have, adapt->maps[ADAPT_NEAR], pixels, ahead, least);
    if (want_shares(adapt, film, scale, least, false) < ahead * (double)pixels / LAST_PART)
        (void)want_shares(adapt, film, scale, least, true);
    for (size_t i = 0; i < pixels; i++) {
        uint32_t more = adapt->wanted[i] - (uint32_t)have[i];
        if (more > plan->next) plan->next = more;
    }
    plan->left = plan->next ? (uint64_t)(all - sum) : 0;
    return STATUS_OK;
}
