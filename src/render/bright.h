/* bright.h - the brightest samples of each pixel, kept apart, and what a pixel's samples see first.
 * A pixel whose light came with one sample of many may be right in the mean, but not by itself; spread.h says what is done
 * about it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BRIGHT_H
#define MEN_BRIGHT_H

#include <math.h>

#include "render/film.h"
#include "render/tally.h"
#include "trace/path.h"

enum { BRIGHT_KEPT = 8, BRIGHT_THINGS = 4, BRIGHT_SEEN_BITS = 4 };
/* What is never apart: nothing at all, and lights, which are seen as they are. */
#define BRIGHT_NOTHING UINT32_MAX
/* Of a reflectance of 1. */
#define BRIGHT_REFLECTED 256.0f
typedef struct BrightPixel {
    float rgb[BRIGHT_KEPT][3];                             /* the brightest first; black: none */
    uint32_t things[BRIGHT_THINGS], counts[BRIGHT_THINGS]; /* the first things that any sample saw, and how many did */
    float least;                                           /* light of the last one of those */
    uint32_t
        seen; /* BRIGHT_SEEN_BITS for each of the samples, from the lowest: which thing it saw; BRIGHT_THINGS: another */
    uint32_t n_reflected;                /* how many samples say something of the reflectance */
    int64_t reflected, reflected_rgb[3]; /* in sum, by BRIGHT_REFLECTED: its mean, and its colour */
} BrightPixel;

/* How bright a sample is taken to be: as dots of all colours are seen. Samples of few wavelengths have negative parts. */
static inline float bright_light(const float rgb[3])
{
    return (fabsf(rgb[0]) + fabsf(rgb[1]) + fabsf(rgb[2])) * (1.0f / 3);
}

/* Of the i-th of these, from what BrightPixel.seen has. */
static inline uint32_t bright_seen_of(uint32_t seen, int i)
{
    return seen >> BRIGHT_SEEN_BITS * i & ((1U << BRIGHT_SEEN_BITS) - 1);
}

static inline uint32_t bright_seen(const BrightPixel *pixel, int i)
{
    return bright_seen_of(pixel->seen, i);
}

/* What else has to be known of the samples of a pixel that others come before. */
typedef struct BrightSlice {
    Tally things;               /* all that samples saw first */
    uint32_t kept[BRIGHT_KEPT]; /* what the brightest saw */
} BrightSlice;

typedef struct BrightFilm {
    uint32_t width, height;
    BrightPixel *pixels; /* NULL: nothing is kept */
    BrightSlice *slices; /* for each pixel of a film that does not begin with the first sample; else NULL */
    bool out_of_memory;
} BrightFilm;

ATTR_NODISCARD Status bright_film_init(BrightFilm *film, bool slice, uint32_t width, uint32_t height, Error *error);
void bright_film_clear(BrightFilm *film);
void bright_film_forget_row(BrightFilm *film, uint32_t y); /* as film_forget_row */
/* One sample. thing: any number of what it saw first, or BRIGHT_NOTHING. reflected: the part of the light that it says is reflected
 * there, in the mean of a pixel's samples; its mean < 0: it says nothing. A pixel belongs to one thread at a time. */
void bright_film_add(BrightFilm *film, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing,
                     const Reflected *reflected);
/* The colour of what is reflected in a pixel: in each channel over the mean, with a quarter of a sample that says grey, as few may
 * have seen few wavelengths. */
static inline void bright_tint(const BrightPixel *pixel, float tint[3])
{
    double grey = pixel->n_reflected ? 0.25 * (double)pixel->reflected / pixel->n_reflected : 0;
    for (int c = 0; c < 3; c++)
        tint[c] = grey > 0 ? (float)(((double)pixel->reflected_rgb[c] + grey) / ((double)pixel->reflected + grey)) : 1;
}

/* Rows as bytes, and joining two, as film_save_row and its like have it; also of films without pixels. next: of a film that
 * does not begin with the first sample. false from joining when memory ends. */
void bright_film_save_row(const BrightFilm *film, uint32_t y, Buf *out);
bool bright_film_load_row(BrightFilm *film, uint32_t y, BufReader *in);
bool bright_film_join_row(BrightFilm *film, uint32_t y, const BrightFilm *next, uint32_t next_y);

#endif
