/* evenness.h - how the error of a pixel follows from the differences among its samples, which are spread evenly.
 *
 * The mean of evenly spread samples is better than that of independent ones. How much, no two halves of them say: what the
 * halves of a net differ by is just what their mean is rid of. But the pieces of 1, 2, 4, ... samples of a sequence form a
 * ladder: with V_k the variance of the mean of 2^k samples, and D_k the mean square of the difference of two such means that
 * follow each other,
 *     V_(k+1) = V_k - D_k / 4,   so that   V_k = (D_k + D_(k+1) + D_(k+2) + ...) / 4,
 * exactly. The first D are seen; the others are foretold: they fall on as they fell. D_k ~ r^k has r = 1/2 for independent
 * samples, and down to 1/8 for smooth functions of few dimensions. They alternate where two dimensions count together: pieces
 * of 4^k samples are spread evenly over squares, those of twice as many are not. Of what the last D is above or below the line
 * through its neighbours, half is foretold to come back at every other one: different scenes have none to all of it.
 *
 * Of one pixel all this is mere noise; it is asked of its neighbours, by the roots of |differences|, which a firefly sways
 * less, and not of itself (see adapt.h). Where differences fall slower than by chance, few samples bring most of the light.
 * Then the error of those that lack them counts, too: a mean error is up to twice what the halves say.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EVENNESS_H
#define MEN_EVENNESS_H

#include "base/pool.h"
#include "render/film.h"

typedef struct Evenness {
    uint32_t width;
    /* For each pixel of the film, by rows: base-2 logarithm of the factor by which |differences| around it change with twice
     * as many samples; of independent ones -1/2. */
    float *slope;
    float *excess; /* logarithm of the factor of the last |difference| over those before and behind, which alternate */
} Evenness;

/* pool: NULL, or who shares the work. STATUS_NOMEM. */
ATTR_NODISCARD Status evenness_init(Evenness *evenness, const Film *film, Pool *pool, Error *error);
void evenness_clear(Evenness *evenness);
/* What film_spread is to be multiplied by, of n samples, n > 1: for mean errors, and for mean squares, whose root it is, and
 * which few bright samples do not make too small. */
double evenness_of_error(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n);
double evenness_of_square(const Evenness *evenness, uint32_t x, uint32_t y, uint32_t n);
/* The same of a slope, up to -1/2, and an excess alone. */
double evenness_factor(double slope, double excess, uint32_t n);

#endif
