/* bright.c - sorts the few brightest samples of a pixel as they come.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/bright.h"

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

ATTR_COLD static void keep(BrightPixel *pixel, const float rgb[3], uint32_t seen)
{
    float held[3], light; /* as the film holds it */
    for (int c = 0; c < 3; c++) held[c] = fminf(fmaxf(rgb[c], -(float)FILM_LARGEST), (float)FILM_LARGEST);
    light = bright_light(held);
    int at = BRIGHT_KEPT - 1;
    for (; at > 0 && bright_light(pixel->rgb[at - 1]) < light; at--)
        memcpy(pixel->rgb[at], pixel->rgb[at - 1], sizeof held);
    memcpy(pixel->rgb[at], held, sizeof held);
    pixel->least = bright_light(pixel->rgb[BRIGHT_KEPT - 1]);
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
    if (UNLIKELY(bright_light(rgb) > pixel->least)) keep(pixel, rgb, seen);
}
