/* spread.h - samples that stand alone, shared out over what is around them.
 *
 * Where one path in thousands finds a bright light, say the glint of a lamp in a facet, the pixels that have it are far too
 * bright, and all others a little too dark: the picture is right in the mean, and not to be looked at. Such a sample tells
 * what a neighbourhood has together, as large as it takes to find it some times. So it is given to that neighbourhood: the
 * light of the picture stays the same, and none is thrown away or made dimmer, as clamping would.
 *
 * - A sample stands alone when it adds much to its pixel, compared with what is there and around without such samples, and
 *   its pixel has few comparable ones. A bright thing that is well sampled has many: it stays as it is, to the bit.
 * - It goes to the smallest neighbourhood that holds enough comparable samples, or in which all of these are not seen any
 *   more: next to it few are enough, farther away many, else each neighbourhood would be seen as a disc. One that would be seen
 *   wherever it goes, and has hardly any like it there, makes less of a blemish where it is, and stays.
 * - Where comparable samples lie closer together than farther away, and are so bright that a disc over both would be seen, as in
 *   the spot of a lens or a rainbow on a dark wall, they go to what is found among them, or stay.
 * - Where comparable samples of near pixels differ in number beyond chance, those with more of them get more: lines and points
 *   stay as sharp as they were found. Far away, over a large thing, places get less around which fewer are than chance would have,
 *   and nothing where no light at all comes to, as behind a wall in haze (spread_density.h).
 * - It goes to pixels that show the same thing first, by how much of them does; not over the thing's edge. Parts of an
 *   object with other surfaces are things of their own, right behind its clear face, too. Behind clear things so are what
 *   stands there of another object, by its medium, as bubbles in a block; a medium that scatters; and what such a sample
 *   shows that found its light on the way. Pixels get by what is reflected there, in each channel, as far as
 *   more than a few samples around say it, so that a texture stays whatever it is lit by; and those that have less light than their surroundings get less, so that shadows keep their
 *   contrast, and where comparable samples lie in what is bright alone, just by what light is there; where all have some of
 *   such samples, what they usually have counts, too. What an edge would cut off is folded at it, so that there is no dark
 *   frame along edges.
 *
 * With more samples each adds less, and has more beside it, so that less is shared out, and in the end nothing: the picture
 * converges to what it would without. The neighbourhood is that of a nearest-neighbour density estimate [LQ65]. Energy is
 * kept so by [RW94], which judges whole pixels; samples are told apart by how many others are like them in [DWR10] and
 * [ZHD18], which make those that stand alone dimmer.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPREAD_H
#define MEN_SPREAD_H

#include "base/pool.h"
#include "render/bright.h"

/* Pixels with fewer keep all of theirs, but get what others give. */
enum { SPREAD_LEAST_SAMPLES = 8 };

typedef struct SpreadPixel {
    double rgb[3]; /* to be added to the mean */
    /* Of the square of the mean's standard error: the part that went, and what came. */
    double taken, given;
} SpreadPixel;

typedef struct Spread {
    uint32_t width, height;
    SpreadPixel *pixels; /* of the film, by rows */
    uint64_t samples;    /* that stood alone and were shared out */
    double light;        /* the part of the picture's light that they bring, */
    double one_colored;  /* and of that, what came by one colour of many, as dispersion leaves it */
} Spread;

static inline const SpreadPixel *spread_pixel(const Spread *spread, uint32_t x, uint32_t y)
{
    return &spread->pixels[(size_t)y * spread->width + x];
}

/* A function of the two films alone, which are of one size, with the same bits for any number of threads. pool: NULL is fine.
 * STATUS_NOMEM. */
ATTR_NODISCARD Status spread_init(Spread *spread, const Film *film, const BrightFilm *bright, Pool *pool, Error *error);
void spread_clear(Spread *spread);
/* Moves the light, in the first three channels, R, G and B, of an image of the film's size. */
void spread_apply(const Spread *spread, Image *image);

#endif
