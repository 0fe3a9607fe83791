/* bright.h - the brightest samples of each pixel, kept apart, and what a pixel's samples see first.
 * A pixel whose light came with one sample of many may be right in the mean, but not by itself; spread.h says what is done
 * about it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BRIGHT_H
#define MEN_BRIGHT_H

#include <math.h>

#include "render/film.h"

enum { BRIGHT_KEPT = 8, BRIGHT_THINGS = 3 };
/* What is never apart: nothing at all, and lights, which are seen as they are. */
#define BRIGHT_NOTHING UINT32_MAX
typedef struct BrightPixel {
    float rgb[BRIGHT_KEPT][3];                             /* the brightest first; black: none */
    uint32_t things[BRIGHT_THINGS], counts[BRIGHT_THINGS]; /* the first things that any sample saw, and how many did */
    float least;                                           /* light of the last one of those */
    uint32_t seen; /* two bits for each of the samples, from the lowest: which thing it saw; BRIGHT_THINGS: another */
} BrightPixel;

/* How bright a sample is taken to be: as dots of all colours are seen. Samples of few wavelengths have negative parts. */
static inline float bright_light(const float rgb[3])
{
    return (fabsf(rgb[0]) + fabsf(rgb[1]) + fabsf(rgb[2])) * (1.0f / 3);
}

static inline uint32_t bright_seen(const BrightPixel *pixel, int i)
{
    return pixel->seen >> 2 * i & 3;
}

typedef struct BrightFilm {
    uint32_t width, height;
    BrightPixel *pixels; /* NULL: nothing is kept */
} BrightFilm;

ATTR_NODISCARD Status bright_film_init(BrightFilm *film, uint32_t width, uint32_t height, Error *error);
void bright_film_clear(BrightFilm *film);
void bright_film_forget(BrightFilm *film); /* all samples */
/* One sample. thing: any number of what it saw first, or BRIGHT_NOTHING. A pixel belongs to one thread at a time. */
void bright_film_add(BrightFilm *film, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing);

#endif
