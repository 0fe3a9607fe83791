/* upsample_table.h - the table behind upsample_coefficients, made at build time by upsample_gen.c.
 * A colour is placed by its largest channel, that channel's value z, and the two others, in cyclic
 * order, relative to it: three blocks of a cube of knots, as in [JH19] section 4. For src/optics only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_UPSAMPLE_TABLE_H
#define MEN_UPSAMPLE_TABLE_H

/* With cubic interpolation 24 knots leave an error of at most 0.002 in linear RGB, 0.0002 root mean
 * square (measured; upsample_test.c prints both). Linear interpolation needs 33, so 2.6 times the
 * memory, and then has 0.002 and 0.0006. */
enum { UPSAMPLE_KNOTS = 24, UPSAMPLE_FACTORS = 3 };

/* For each largest channel: [knot of z][knot of the second other][knot of the first other][factor], and one number more, so that
 * four can be loaded from where the last three are. */
enum { UPSAMPLE_FLOATS = UPSAMPLE_KNOTS * UPSAMPLE_KNOTS * UPSAMPLE_KNOTS * UPSAMPLE_FACTORS };
extern const float upsample_table[3][UPSAMPLE_FLOATS + 1];

/* Values of z nearer to 0 or 1 are raised or lowered to this; the coefficients diverge there. */
#define UPSAMPLE_MARGIN 1e-4

/* Coefficients change fastest towards the ends, so the knots crowd there: smoothstep once for the
 * ratios, and twice, as in [JH19], for z. */
static inline double upsample_smoothstep(double t)
{
    return t * t * (3 - 2 * t);
}

static inline double upsample_z_of_knot(int knot)
{
    double t = (double)knot / (UPSAMPLE_KNOTS - 1);
    return UPSAMPLE_MARGIN + (1 - 2 * UPSAMPLE_MARGIN) * upsample_smoothstep(upsample_smoothstep(t));
}
static inline double upsample_ratio_of_knot(int knot)
{
    return upsample_smoothstep((double)knot / (UPSAMPLE_KNOTS - 1));
}

#endif
