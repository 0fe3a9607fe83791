/* bright.c - sorts the few brightest samples of a pixel as they come.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/bright.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

Status bright_film_init(BrightFilm *film, uint32_t width, uint32_t height, Error *error)
{
    *film = (BrightFilm){width, height, calloc((size_t)width * height, sizeof(BrightPixel))};
    if (film->pixels) return STATUS_OK;
    return fail_memory(error, (size_t)width * height * sizeof(BrightPixel), "the brightest samples");
}

void bright_film_clear(BrightFilm *film)
{
    free(film->pixels);
    *film = (BrightFilm){0};
}

void bright_film_forget(BrightFilm *film)
{
    if (film->pixels) memset(film->pixels, 0, (size_t)film->width * film->height * sizeof *film->pixels);
}

static int16_t ratio(double part, double light)
{
    double units = part / light / BRIGHT_UNIT;
    return (int16_t)fmin(fmax(units, INT16_MIN), INT16_MAX); /* towards 0 */
}

ATTR_COLD static void keep(BrightPixel *pixel, const float rgb[3], uint32_t seen)
{
    double held[3], light = 0; /* as the film holds it */
    for (int c = 0; c < 3; c++) light += held[c] = fmin(fmax((double)rgb[c], -FILM_LARGEST), FILM_LARGEST);
    /* what red and blue lose, rounded towards 0, is not to make green more than it was */
    float less = (float)(light / 3 * (1 - 0.7 * BRIGHT_UNIT));
    int at = BRIGHT_KEPT - 1;
    for (; at > 0 && pixel->samples[at - 1].light < less; at--) pixel->samples[at] = pixel->samples[at - 1];
    pixel->samples[at] = (BrightSample){less, ratio(held[0], (double)less), ratio(held[2], (double)less)};
    uint32_t below = (1U << 2 * at) - 1;
    pixel->seen = (pixel->seen & below) | seen << 2 * at | (pixel->seen & ~below) << 2;
}

void bright_film_add(BrightFilm *film, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing)
{
    if (thing == BRIGHT_NOTHING) return;
    BrightPixel *pixel = &film->pixels[(size_t)y * film->width + x];
    uint32_t seen = 0;
    while (seen < BRIGHT_THINGS && pixel->counts[seen] && pixel->things[seen] != thing) seen++;
    if (seen < BRIGHT_THINGS) {
        pixel->things[seen] = thing;
        pixel->counts[seen]++;
    }
    float light = (rgb[0] + rgb[1] + rgb[2]) * (1.0f / 3);
    if (light > pixel->samples[BRIGHT_KEPT - 1].light) keep(pixel, rgb, seen);
}
