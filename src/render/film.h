/* film.h - what the samples of a picture add up to.
 * Sums are integers: every sample is rounded to a multiple of 2^-30 before it is added, so that the sum does not depend on
 * the order, and slices of a render made apart add up to the same bits as the whole.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FILM_H
#define MEN_FILM_H

#include "base/buf.h"
#include "base/pool.h"
#include "image/image.h"

#define FILM_UNIT 0x1p-30
/* A channel of one sample is held at this, and the sum of all at twice as much: the mean of 2^16 samples is then still 2^16. */
#define FILM_LARGEST 0x1p31

enum { FILM_LADDER = 4, FILM_MOST_SAMPLES = 1 << 24 };

typedef struct FilmPixel {
    int64_t rgb[3];
    int64_t squares; /* of the luminance, in units of 2^-12, each held at 2^49; with squares_rest */
    int64_t luminance;
    /* Of luminance, what is of the samples before number 2^k, counted from 0 in the whole render: for the largest 2^k below the
     * number that comes next, then for 2^(k-1), ... */
    int64_t before[FILM_LADDER + 1];
    int64_t first_rgb[3]; /* of rgb, what before[0] is of luminance */
    /* of each sample up to 1, and where chance finds more of what is behind panes than there is, below 0 */
    int64_t alpha;
    uint32_t n;
    uint32_t squares_rest; /* in units of 2^-44 */
    uint64_t rays;         /* that the samples took: what they cost */
} FilmPixel;

/* What a pixel's samples found of shadow catchers, see trace/catcher.h and caught.h: sums as FilmPixel's, which has all of
 * that light, too, and for which catchers cover what is behind them. */
typedef struct FilmCaught {
    int64_t lit[3], bare[3], part;
} FilmCaught;

/* Of the pixels that are rendered: where they are but a part of a frame, places are counted from the first of them. */
typedef struct Film {
    uint32_t width, height;
    uint32_t first_sample; /* of each pixel: 0, but for slices of a render */
    FilmPixel *pixels;
    FilmCaught *caught; /* NULL: nothing in the scene catches shadows */
} Film;

static inline const FilmPixel *film_pixel(const Film *film, uint32_t x, uint32_t y)
{
    return &film->pixels[(size_t)y * film->width + x];
}

/* Black, without samples. STATUS_NOMEM. */
ATTR_NODISCARD Status film_init(Film *film, uint32_t width, uint32_t height, Error *error);
/* Makes room for what is caught. STATUS_NOMEM. */
ATTR_NODISCARD Status film_catch(Film *film, Error *error);
void film_clear(Film *film);
/* Takes all samples away from the pixels of a row. */
void film_forget_row(Film *film, uint32_t y);
/* How many samples pixels have: the least, the most, and all together. */
void film_count_samples(const Film *film, uint32_t *least, uint32_t *most, uint64_t *sum);
/* One sample, of a pixel in their order. Returns whether the sample, or the sum, was brighter than the film can hold (it is then
 * held at its limit). */
bool film_add(Film *film, uint32_t x, uint32_t y, const float rgb[3], float alpha);
/* The same of what the sample caught, if its film has room for that. */
void film_add_caught(Film *film, uint32_t x, uint32_t y, const float lit[3], const float bare[3], float part);
static inline void film_add_rays(Film *film, uint32_t x, uint32_t y, uint64_t rays)
{
    film->pixels[(size_t)y * film->width + x].rays += rays;
}
/* Mean luminance of a pixel and its standard error as if its samples were independent, an upper bound; error < 0 with fewer
 * than 2. */
void film_luminance(const FilmPixel *pixel, double *mean, double *standard_error);
/* How much of what is behind the picture a pixel covers: 0 .. 1. */
float film_alpha(const FilmPixel *pixel);
/* What the means of a pixel's first samples and of its others, two pictures of one thing, say of the error: |difference|,
 * scaled so that over the square root of the number of samples it stands for the absolute error of a mean over them, if they
 * were independent; see evenness.h. It is right in the mean over pixels, not for one; < 0 with fewer than 2 samples. */
double film_spread(const FilmPixel *pixel);
/* How many of n samples, n > 1, are its first part: the largest power of two below n. */
uint32_t film_first_part(uint32_t n);
/* Roots of |differences| of the means of the first 2^k samples and of the next 2^k, for the largest 2^k of which there are
 * both, and for smaller ones; 0 with too few samples. */
void film_ladder(const FilmPixel *pixel, float ladder[FILM_LADDER]);
/* Rows of films as bytes. What was loaded is checked: false where it cannot be of samples. */
void film_save_row(const Film *film, uint32_t y, Buf *out);
bool film_load_row(Film *film, uint32_t y, BufReader *in);
/* Adds the samples that come right behind a pixel's own, as if they had been added one by one. from: the number of the first of
 * them in the whole render; they are one or more. */
void film_join(FilmPixel *pixel, const FilmPixel *next, uint32_t from);
void film_join_caught(FilmCaught *caught, const FilmCaught *next);
/* The means of a pixel's first samples and of its others, two pictures of one thing: of R, G, B and the luminance the square of
 * the difference, scaled so that it stands for the squared error of the mean of all, in the mean over pixels. 0 where there are
 * no two: with fewer than 2 samples, and in a slice without a number that is a power of two. */
void film_squared_errors(const Film *film, uint32_t x, uint32_t y, float squared[4]);
struct Spread;
/* Channels R G B A and noise.Y, the standard error of the luminance, as even as the samples are; of a film that does not begin
 * with the first sample as if they were independent, an upper bound. spread: NULL, or where single
 * bright samples go. pool: NULL, or who shares the work; the same bits for any number of threads. */
ATTR_NODISCARD Status film_resolve(const Film *film, const struct Spread *spread, Pool *pool, Image *image,
                                   Error *error);

#endif
