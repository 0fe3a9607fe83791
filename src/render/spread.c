/* spread.c - which samples stand alone, and where they go.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread.h"

#include <math.h>
#include <stdlib.h>

#include "render/around.h"

#ifndef TUNE
#define TUNE static const
#endif
TUNE double t_alike = 4;      /* samples are comparable down to this part */
TUNE double t_stands_out = 0.25; /* v/n over reference */
TUNE double t_enough = 32;     /* comparable samples wanted */
TUNE double t_unseen = 0.05;  /* peak addition over reference that ends growth */
TUNE double t_floor = 0.3; /* of base weight */
TUNE double t_slope = 4;
TUNE double t_own = 8, t_cap = 1;
TUNE int t_farthest = 48;
TUNE int t_refradius = 2;

/* Of an area of the film: by its rows. */
typedef struct Maps {
    const Film *film;
    const BrightFilm *bright;
    const uint32_t *area;
    uint32_t width, height;
    float *plain;     /* light, as BrightSample has it, of each pixel without the samples that have few like them there, */
    float *reference; /* and what it is compared with: that, or the mean of it around where that is more */
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
    double light, rgb[3];     /* as parts of its pixel's mean */
    double reference;         /* see Maps */
    float least;              /* of comparable samples */
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
    for (int i = 0; i < BRIGHT_KEPT && pixel->samples[i].light >= least; i++) n += bright_seen(pixel, i) == seen;
    return n;
}

static bool has_few_alike(const BrightPixel *pixel, int i, uint32_t n_samples)
{
    float light = pixel->samples[i].light;
    uint32_t seen = bright_seen(pixel, i);
    if (!(light > 0) || seen == BRIGHT_THINGS) return false;
    double few = fmin(n_samples / 4, t_own);
    return count_comparable(pixel, seen, light / (float)t_alike) < few;
}

/* The sum of a pixel's samples. */
static double light_of(const FilmPixel *pixel)
{
    return ((double)pixel->rgb[0] + (double)pixel->rgb[1] + (double)pixel->rgb[2]) * (FILM_UNIT / 3);
}

static void map_plain(Maps *maps, float *scratch)
{
    const uint32_t *area = maps->area;
    size_t at = 0;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++, at++) {
            const FilmPixel *pixel = film_pixel(maps->film, x, y);
            const BrightPixel *bright = bright_at(maps, x, y);
            double sum = light_of(pixel);
            for (int i = 0; i < BRIGHT_KEPT; i++)
                if (has_few_alike(bright, i, pixel->n)) sum -= (double)bright->samples[i].light;
            maps->plain[at] = pixel->n ? (float)fmax(sum / pixel->n, 0) : 0;
        }
    mean_around(maps->plain, maps->width, maps->height, (uint32_t)t_refradius, scratch, maps->reference);
    for (size_t i = 0; i < at; i++) maps->reference[i] = fmaxf(maps->reference[i], maps->plain[i]);
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
    double light = usual > 0 ? fmin((plain + t_floor * usual) / ((1 + t_floor) * usual), t_cap) : 1;
    return near > 0 ? near * share * light : 0;
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

static double sum_weights(const Maps *maps, const Lone *lone, int radius)
{
    uint32_t square[4];
    double sum = 0;
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++)
        for (uint32_t x = square[0]; x < square[2]; x++) sum += weight_at(maps, lone, x, y, radius);
    return sum;
}

/* Comparable samples in the ring of pixels that far away. */
static uint32_t count_in_ring(const Maps *maps, const Lone *lone, int radius)
{
    uint32_t square[4], n = 0;
    square_around(maps->area, lone, radius, square);
    for (uint32_t y = square[1]; y < square[3]; y++) {
        bool whole_row = y + (uint32_t)radius == lone->y || y == lone->y + (uint32_t)radius;
        for (uint32_t x = square[0]; x < square[2]; x++) {
            if (!whole_row && x + (uint32_t)radius != lone->x && x != lone->x + (uint32_t)radius) continue;
            const BrightPixel *bright = bright_at(maps, x, y);
            n += count_comparable(bright, find_thing(bright, lone->thing), lone->least);
        }
    }
    return n;
}

/* How far a sample is spread. */
static int find_radius(const Maps *maps, const Lone *lone)
{
    double unseen = t_unseen * lone->reference;
    uint32_t found = count_in_ring(maps, lone, 0);
    int radius = 0;
    while (radius < t_farthest && (radius == 0 || found < fmin(t_slope * radius * radius, t_enough))) {
        found += count_in_ring(maps, lone, ++radius);
        double most = lone->light * weight_at(maps, lone, lone->x, lone->y, radius) * found;
        if (most <= unseen * sum_weights(maps, lone, radius)) break;
    }
    return radius;
}

static double square_of_luminance(const double rgb[3])
{
    double luminance = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
    return luminance * luminance;
}

static void spread_sample(const Maps *maps, const Lone *lone)
{
    int radius = find_radius(maps, lone);
    double sum = sum_weights(maps, lone, radius), squared = square_of_luminance(lone->rgb);
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
    from->taken += squared;
}

static Lone lone_at(const Maps *maps, uint32_t x, uint32_t y, int i)
{
    const BrightPixel *pixel = bright_at(maps, x, y);
    const BrightSample *sample = &pixel->samples[i];
    double n = film_pixel(maps->film, x, y)->n;
    Lone lone = {.x = x,
                 .y = y,
                 .thing = pixel->things[bright_seen(pixel, i)],
                 .light = (double)sample->light / n,
                 .reference = (double)maps->reference[place_in(maps->area, x, y)],
                 .least = sample->light / (float)t_alike};
    bright_rgb(sample, lone.rgb);
    for (int c = 0; c < 3; c++) lone.rgb[c] /= n;
    return lone;
}

static void spread_pixel(Spread *spread, const Maps *maps, uint32_t x, uint32_t y)
{
    const BrightPixel *bright = bright_at(maps, x, y);
    uint32_t n = film_pixel(maps->film, x, y)->n;
    if (n < SPREAD_LEAST_SAMPLES) return;
    double much = t_stands_out * n * (double)maps->reference[place_in(maps->area, x, y)];
    for (int i = 0; i < BRIGHT_KEPT && (double)bright->samples[i].light > much; i++) {
        if (!has_few_alike(bright, i, n)) continue;
        Lone lone = lone_at(maps, x, y, i);
        spread_sample(maps, &lone);
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
            if (!pixel->n) continue;
            light += light_of(pixel) / pixel->n;
            spread_pixel(spread, &maps, x, y);
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
    enum { NOISE = 4 };
    const uint32_t *area = spread->area;
    for (uint32_t y = area[1]; y < area[3]; y++)
        for (uint32_t x = area[0]; x < area[2]; x++) {
            const SpreadPixel *from = &spread->pixels[place_in(area, x, y)];
            if (from->taken == 0 && from->given == 0) continue;
            float *pixel = image->pixels + ((size_t)y * image->width + x) * image->n_channels;
            for (int c = 0; c < 3; c++) pixel[c] = (float)((double)pixel[c] + from->rgb[c]);
            if (image->n_channels <= NOISE) continue;
            double squared = (double)pixel[NOISE] * (double)pixel[NOISE];
            pixel[NOISE] = (float)sqrt(fmax(squared - from->taken, 0) + from->given);
        }
}
