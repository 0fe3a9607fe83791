/* spread.c - which samples stand alone, and where they go.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread.h"

#include <math.h>
#include <stdlib.h>

#include "render/around.h"

/* Measured on the examples, by the error against pictures of many samples, by dots that are left (bench fireflies), and by
 * eye: what is spread too near makes discs of the same brightness; too little, dots. */

/* Samples are alike down to this part of the brightest. */
#define ALIKE 0.4f
/* A pixel that has so many that are alike has found what it shows; of few samples a part of them is enough. */
enum { FEW = 8, FEW_PART = 4 };
/* What a sample adds to its pixel, over what is there without, that is not to be seen yet. */
#define STANDS_OUT 0.2
/* Pixels around, for what is usual there. */
enum { AROUND = 2 };
/* Comparable samples that hold a neighbourhood up: next to a sample few, which are parts of one small bright thing; farther
 * away many, else their discs would be seen. */
enum { NEAR = 2, NEAR_ENOUGH = 20, FAR_ENOUGH = 256, FARTHEST = 209 };
/* What samples add to what is usual, spread, that is not seen; and what is a haze that is better than a dot. */
#define UNSEEN 0.1
#define FAINT 0.25
/* Of what a usual pixel gets, the part that a black one does. */
#define TO_BLACK (1 / 6.0)

/* Of an area of the film: by its rows. */
typedef struct Maps {
    const Film *film;
    const BrightFilm *bright;
    const uint32_t *area;
    uint32_t width, height;
    float *plain;     /* light of each pixel, see bright_light, without the samples that have few like them there, */
    float *reference; /* and what is usual there: the most of that, the brightest pixel next to it, the mean around */
    SpreadPixel *pixels;
} Maps;

static size_t place_in(const uint32_t area[4], uint32_t x, uint32_t y)
{
    return (size_t)(y - area[1]) * (area[2] - area[0]) + (x - area[0]);
}

static const BrightPixel *bright_at(const Maps *maps, uint32_t x, uint32_t y)
{
    return &maps->bright->pixels[(size_t)y * maps->bright->width + x];
}

/* A sample on its way. */
typedef struct Lone {
    uint32_t x, y, thing;
    double light, rgb[3]; /* as parts of its pixel's mean */
    double reference;     /* see Maps */
    float least;          /* of comparable samples */
    double crowding;      /* see find_crowding */
} Lone;

/* Which of a pixel's things one is; BRIGHT_THINGS: none. */
static uint32_t find_thing(const BrightPixel *pixel, uint32_t thing)
{
    uint32_t i = 0;
    while (i < BRIGHT_THINGS && !(pixel->counts[i] && pixel->things[i] == thing)) i++;
    return i;
}

/* The pixel's samples of its seen-th thing that are as bright, as far as they are kept. */
static uint32_t count_comparable(const BrightPixel *pixel, uint32_t seen, float least)
{
    uint32_t n = 0;
    if (seen == BRIGHT_THINGS) return 0;
    for (int i = 0; i < BRIGHT_KEPT && bright_light(pixel->rgb[i]) >= least; i++) n += bright_seen(pixel, i) == seen;
    return n;
}

static uint32_t few_of(uint32_t n_samples)
{
    return n_samples / FEW_PART < FEW ? n_samples / FEW_PART : FEW;
}

static bool has_few_alike(const BrightPixel *pixel, int i, uint32_t n_samples)
{
    float light = bright_light(pixel->rgb[i]);
    uint32_t seen = bright_seen(pixel, i);
    return light > 0 && seen < BRIGHT_THINGS && count_comparable(pixel, seen, light * ALIKE) < few_of(n_samples);
}

/* Whether no sample of a pixel has few alike, by a quick look: false where a close one is needed. */
static bool is_plain(const BrightPixel *pixel, uint32_t n_samples)
{
    uint32_t few = few_of(n_samples);
    return few == 0 || (!pixel->counts[1] && pixel->counts[0] >= few &&
                        bright_light(pixel->rgb[few - 1]) >= bright_light(pixel->rgb[0]) * ALIKE);
}

/* What a pixel's mean is without the samples that have few like them, or with them. */
static double light_of(const FilmPixel *pixel, const BrightPixel *without)
{
    double rgb[3];
    for (int c = 0; c < 3; c++) rgb[c] = (double)pixel->rgb[c] * FILM_UNIT;
    for (int i = 0; without && !is_plain(without, pixel->n) && i < BRIGHT_KEPT; i++)
        if (has_few_alike(without, i, pixel->n))
            for (int c = 0; c < 3; c++) rgb[c] -= (double)without->rgb[i][c];
    return pixel->n ? (fabs(rgb[0]) + fabs(rgb[1]) + fabs(rgb[2])) / (3.0 * pixel->n) : 0;
}

/* x, y: within the area. */
static float most_beside(const Maps *maps, uint32_t x, uint32_t y)
{
    float most = 0;
    for (uint32_t v = y ? y - 1 : 0; v <= y + 1 && v < maps->height; v++)
        for (uint32_t u = x ? x - 1 : 0; u <= x + 1 && u < maps->width; u++)
            most = fmaxf(most, maps->plain[(size_t)v * maps->width + u]);
    return most;
}

static void map_plain(Maps *maps, float *scratch)
{
    const uint32_t *area = maps->area;
    size_t n = 0;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++)
            maps->plain[n++] = (float)light_of(film_pixel(maps->film, x, y), bright_at(maps, x, y));
    mean_around(maps->plain, maps->width, maps->height, AROUND, scratch, maps->reference);
    for (uint32_t y = 0; y < maps->height; y++)
        for (uint32_t x = 0; x < maps->width; x++) {
            float *reference = &maps->reference[(size_t)y * maps->width + x];
            *reference = fmaxf(*reference, most_beside(maps, x, y));
        }
}

/* How much of a sample a pixel gets, in relation to others: nothing beyond the radius. */
static double weight_at(const Maps *maps, const Lone *lone, uint32_t x, uint32_t y, int radius)
{
    const BrightPixel *bright = bright_at(maps, x, y);
    uint32_t seen = find_thing(bright, lone->thing);
    if (seen == BRIGHT_THINGS) return 0;
    double dx = (double)x - lone->x, dy = (double)y - lone->y, reach = radius + 0.5;
    double near = 1 - (dx * dx + dy * dy) / (reach * reach);
    double share = bright->counts[seen] / (double)film_pixel(maps->film, x, y)->n;
    double usual = lone->reference, plain = (double)maps->plain[place_in(maps->area, x, y)];
    double light = usual > 0 ? fmin(TO_BLACK + (1 - TO_BLACK) * plain / usual, 1) : 1;
    double crowd = lone->crowding > 0 ? 1 + lone->crowding * count_comparable(bright, seen, lone->least) : 1;
    return near > 0 ? near * share * light * crowd : 0;
}

/* The part of the square around a sample that is within the area: from x0, y0 up to but without x1, y1. */
static void square_around(const uint32_t area[4], const Lone *lone, int radius, uint32_t square[4])
{
    uint32_t r = (uint32_t)radius;
    square[0] = lone->x > area[0] + r ? lone->x - r : area[0];
    square[1] = lone->y > area[1] + r ? lone->y - r : area[1];
    square[2] = lone->x + r < area[2] ? lone->x + r + 1 : area[2];
    square[3] = lone->y + r < area[3] ? lone->y + r + 1 : area[3];
}

/* What pixels get together; plain: what these have on average without it. */
static double sum_weights(const Maps *maps, const Lone *lone, int radius, double *plain)
{
    uint32_t square[4];
    double sum = 0, light = 0;
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++)
        for (uint32_t x = square[0]; x < square[2]; x++) {
            double weight = weight_at(maps, lone, x, y, radius);
            sum += weight;
            light += weight * (double)maps->plain[place_in(maps->area, x, y)];
        }
    *plain = light / sum;
    return sum;
}

/* Comparable samples up to that far away, and not nearer than the other. */
static uint32_t count_between(const Maps *maps, const Lone *lone, int nearest, int radius)
{
    uint32_t square[4], n = 0;
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++)
        for (uint32_t x = square[0]; x < square[2]; x++) {
            if (abs((int)x - (int)lone->x) < nearest && abs((int)y - (int)lone->y) < nearest) continue;
            const BrightPixel *bright = bright_at(maps, x, y);
            n += count_comparable(bright, find_thing(bright, lone->thing), lone->least);
        }
    return n;
}

/* How far a sample is spread. One that would be more than faint wherever it goes, alone, is less of a blemish where it is: 0. */
static int find_radius(const Maps *maps, const Lone *lone)
{
    uint32_t found = count_between(maps, lone, 0, 0);
    int radius = 0;
    double alone = 0; /* what the sample adds where it is spread the farthest */
    for (int next = 1; next <= FARTHEST; next += 1 + next / 2) {
        found += count_between(maps, lone, radius + 1, next);
        radius = next;
        if (found >= (uint32_t)(radius <= NEAR ? radius * NEAR_ENOUGH : FAR_ENOUGH)) return radius;
        double plain, sum = sum_weights(maps, lone, radius, &plain);
        double most =
            lone->light * weight_at(maps, lone, lone->x, lone->y, radius) / (sum * fmin(lone->reference, plain));
        if (found * most <= UNSEEN) return radius;
        alone = most;
    }
    return alone > FAINT ? 0 : radius;
}

/* By how much what pixels have of comparable samples differs beyond chance: the variance of the rates behind these counts, over
 * their squared mean. Each pixel's rate is then to be taken for what the mean says as 1 sample and its own as this many times
 * as many, the mean of a gamma distribution given the counts: a thin line or a point stays as sharp as it was found, and
 * what is scattered evenly becomes even. Farther away other things than chance make counts differ. */
static double find_crowding(const Maps *maps, const Lone *lone, int radius)
{
    uint32_t square[4];
    double n = 0, sum = 0, squares = 0;
    if (radius > NEAR) return 0;
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++)
        for (uint32_t x = square[0]; x < square[2]; x++) {
            const BrightPixel *bright = bright_at(maps, x, y);
            uint32_t seen = find_thing(bright, lone->thing);
            if (seen == BRIGHT_THINGS) continue;
            double found = count_comparable(bright, seen, lone->least);
            n++;
            sum += found;
            squares += found * found;
        }
    double mean = sum / n, beyond_chance = squares / n - mean * mean - mean;
    return fmax(beyond_chance, 0) / (mean * mean);
}

static double square_of_luminance(const double rgb[3])
{
    double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    return luminance * luminance;
}

static void spread_sample(const Maps *maps, const Lone *lone, int radius)
{
    double plain, sum = sum_weights(maps, lone, radius, &plain), squared = square_of_luminance(lone->rgb);
    uint32_t square[4];
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++)
        for (uint32_t x = square[0]; x < square[2]; x++) {
            SpreadPixel *to = &maps->pixels[place_in(maps->area, x, y)];
            double part = weight_at(maps, lone, x, y, radius) / sum;
            for (int c = 0; c < 3; c++) to->rgb[c] += part * lone->rgb[c];
            to->given += part * part * squared;
        }
    SpreadPixel *from = &maps->pixels[place_in(maps->area, lone->x, lone->y)];
    for (int c = 0; c < 3; c++) from->rgb[c] -= lone->rgb[c];
    double mean, standard_error;
    film_luminance(film_pixel(maps->film, lone->x, lone->y), &mean, &standard_error);
    if (standard_error > 0) from->taken += squared / (standard_error * standard_error);
}

static Lone lone_at(const Maps *maps, uint32_t x, uint32_t y, int i)
{
    const BrightPixel *pixel = bright_at(maps, x, y);
    double n = film_pixel(maps->film, x, y)->n;
    float light = bright_light(pixel->rgb[i]);
    Lone lone = {.x = x,
                 .y = y,
                 .thing = pixel->things[bright_seen(pixel, i)],
                 .light = (double)light / n,
                 .reference = (double)maps->reference[place_in(maps->area, x, y)],
                 .least = light * ALIKE};
    for (int c = 0; c < 3; c++) lone.rgb[c] = (double)pixel->rgb[i][c] / n;
    return lone;
}

static void share_out(Spread *spread, const Maps *maps, uint32_t x, uint32_t y)
{
    const BrightPixel *bright = bright_at(maps, x, y);
    uint32_t n = film_pixel(maps->film, x, y)->n;
    if (n < SPREAD_LEAST_SAMPLES || is_plain(bright, n)) return;
    double much = STANDS_OUT * n * (double)maps->reference[place_in(maps->area, x, y)];
    for (int i = 0; i < BRIGHT_KEPT && (double)bright_light(bright->rgb[i]) > much; i++) {
        if (!has_few_alike(bright, i, n)) continue;
        Lone lone = lone_at(maps, x, y, i);
        int radius = find_radius(maps, &lone);
        if (radius == 0) continue;
        lone.crowding = find_crowding(maps, &lone, radius);
        spread_sample(maps, &lone, radius);
        spread->samples++;
        spread->light += lone.light;
    }
}

Status spread_init(Spread *spread, const Film *film, const BrightFilm *bright, const uint32_t area[4], Error *error)
{
    *spread = (Spread){.area = {area[0], area[1], area[2], area[3]}};
    uint32_t width = area[2] - area[0], height = area[3] - area[1];
    size_t n = (size_t)width * height;
    spread->pixels = calloc(n, sizeof *spread->pixels);
    float *floats = calloc(n, 3 * sizeof *floats);
    if (!spread->pixels || !floats) {
        free(floats);
        spread_clear(spread);
        return fail_memory(error, n * (sizeof *spread->pixels + 3 * sizeof *floats), "single bright samples");
    }
    Maps maps = {film, bright, area, width, height, floats, floats + n, spread->pixels};
    map_plain(&maps, floats + 2 * n);
    double light = 0;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++) {
            const FilmPixel *pixel = film_pixel(film, x, y);
            light += light_of(pixel, NULL);
            share_out(spread, &maps, x, y);
        }
    spread->light = light > 0 ? spread->light / light : 0;
    free(floats);
    return STATUS_OK;
}

void spread_clear(Spread *spread)
{
    free(spread->pixels);
    *spread = (Spread){0};
}

void spread_apply(const Spread *spread, Image *image)
{
    const uint32_t *area = spread->area;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++) {
            const SpreadPixel *from = spread_pixel(spread, x, y);
            float *pixel = image->pixels + ((size_t)y * image->width + x) * image->n_channels;
            for (int c = 0; c < 3; c++)
                if (from->rgb[c] != 0) pixel[c] = (float)((double)pixel[c] + from->rgb[c]);
        }
}
