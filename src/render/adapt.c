/* adapt.c - errors of neighbourhoods, and what follows from them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/adapt.h"

#include <math.h>
#include <stdlib.h>

/* Luminances below this, a tenth of white, count as this where errors are set in relation to them. */
#define DARK 0.1
/* How far neighbours are asked: those close to the pixel, so that what is thin is seen, and more around it, so that what is
 * rare is. The worse of the two answers counts. */
enum { NEXT = 1, NEAR = 2, WIDE = 4 };

static double relative(double error, double luminance)
{
    return error / sqrt(luminance * luminance + DARK * DARK);
}

static double pixel_luminance(const Film *film, uint32_t x, uint32_t y)
{
    const FilmPixel *pixel = film_pixel(film, x, y);
    return pixel->n ? (double)pixel->luminance * FILM_UNIT / pixel->n : 0;
}

/* Of the pixels around one, not of itself: a firefly would else be small in relation to the light that it brings. */
static double luminance_around(const Film *film, const uint32_t crop[4], uint32_t x, uint32_t y)
{
    double sum = 0, weights = 0;
    for (uint32_t v = y > crop[1] ? y - 1 : y; v <= y + 1 && v < crop[3]; v++)
        for (uint32_t u = x > crop[0] ? x - 1 : x; u <= x + 1 && u < crop[2]; u++) {
            double weight = u == x && v == y ? 0 : u == x || v == y ? 2 : 1;
            sum += weight * pixel_luminance(film, u, v);
            weights += weight;
        }
    return weights > 0 ? sum / weights : pixel_luminance(film, x, y);
}

double adapt_noise(const Film *film, const uint32_t crop[4])
{
    double sum = 0;
    uint64_t n = 0;
    for (uint32_t y = crop[1]; y < crop[3]; y++)
        for (uint32_t x = crop[0]; x < crop[2]; x++, n++) {
            const FilmPixel *pixel = film_pixel(film, x, y);
            double spread = film_spread(pixel);
            if (spread < 0) return -1;
            sum += relative(spread / sqrt(pixel->n), luminance_around(film, crop, x, y));
        }
    return n ? sum / (double)n : -1;
}

Status adapt_init(Adapt *adapt, const uint32_t crop[4], Error *error)
{
    *adapt = (Adapt){.crop = {crop[0], crop[1], crop[2], crop[3]}};
    size_t n = (size_t)(crop[2] - crop[0]) * (crop[3] - crop[1]);
    float **maps[] = {&adapt->spread, &adapt->luminance, &adapt->near_spread, &adapt->wide_spread,
                      &adapt->near_luminance};
    adapt->wanted = calloc(n, sizeof *adapt->wanted);
    bool ready = adapt->wanted != NULL;
    for (size_t i = 0; i < COUNT_OF(maps); i++) ready = (*maps[i] = calloc(n, sizeof(float))) != NULL && ready;
    if (ready) return STATUS_OK;
    adapt_clear(adapt);
    return fail_memory(error, n * (sizeof *adapt->wanted + COUNT_OF(maps) * sizeof(float)), "the noise of the picture");
}

void adapt_clear(Adapt *adapt)
{
    free(adapt->wanted);
    free(adapt->spread);
    free(adapt->luminance);
    free(adapt->near_spread);
    free(adapt->wide_spread);
    free(adapt->near_luminance);
    *adapt = (Adapt){0};
}

/* The mean around each pixel, without itself, weighted by a tent of that radius; pixels beyond the border are none. */
static void mean_around(const float *map, uint32_t width, uint32_t height, int radius, float *mean)
{
    int w = (int)width, h = (int)height;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            float sum = 0, weights = 0;
            for (int v = -radius; v <= radius; v++) {
                if (y + v < 0 || y + v >= h) continue;
                const float *row = map + (size_t)(y + v) * width;
                for (int u = -radius; u <= radius; u++) {
                    if (x + u < 0 || x + u >= w || (u == 0 && v == 0)) continue;
                    float weight = (float)((radius + 1 - abs(u)) * (radius + 1 - abs(v)));
                    sum += weight * row[x + u];
                    weights += weight;
                }
            }
            mean[(size_t)y * width + (size_t)x] = weights > 0 ? sum / weights : map[(size_t)y * width + (size_t)x];
        }
}

/* The next of 2^k, 3 * 2^k from n on that is not below `least`. */
static uint32_t next_step(uint32_t n, double least)
{
    while (n < least) n = n & (n - 1) ? n / 3 * 4 : n > 1 ? n / 2 * 3 : 2;
    return n;
}

AdaptPlan adapt_plan(Adapt *adapt, const Film *film, double noise, uint32_t most)
{
    AdaptPlan plan = {0};
    uint32_t width = adapt->crop[2] - adapt->crop[0], height = adapt->crop[3] - adapt->crop[1];
    size_t i = 0;
    for (uint32_t y = adapt->crop[1]; y < adapt->crop[3]; y++)
        for (uint32_t x = adapt->crop[0]; x < adapt->crop[2]; x++, i++) {
            adapt->spread[i] = (float)film_spread(film_pixel(film, x, y));
            adapt->luminance[i] = (float)pixel_luminance(film, x, y);
        }
    mean_around(adapt->spread, width, height, NEAR, adapt->near_spread);
    mean_around(adapt->spread, width, height, WIDE, adapt->wide_spread);
    mean_around(adapt->luminance, width, height, NEXT, adapt->near_luminance);
    i = 0;
    for (uint32_t y = adapt->crop[1]; y < adapt->crop[3]; y++)
        for (uint32_t x = adapt->crop[0]; x < adapt->crop[2]; x++, i++) {
            uint32_t n = film_pixel(film, x, y)->n;
            double spread = fmax((double)adapt->near_spread[i], (double)adapt->wide_spread[i]);
            double enough = pow(relative(spread, (double)adapt->near_luminance[i]) / noise, 2);
            adapt->wanted[i] = n;
            plan.unmet += n >= most && enough > n;
            if (n >= most) continue;
            plan.at_most += most - n;
            if (enough <= n) continue;
            uint32_t step = next_step(n, fmin(enough, 2.0 * n));
            adapt->wanted[i] = step < most ? step : most;
            plan.left += (uint64_t)(fmin(enough, most) - n);
            if (adapt->wanted[i] - n > plan.next) plan.next = adapt->wanted[i] - n;
        }
    return plan;
}
