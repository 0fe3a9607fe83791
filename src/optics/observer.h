/* observer.h - the tables behind color.c: the CIE 1931 observer, D65, Rec.709's matrix and the
 * distribution of a path's wavelengths. For src/optics and tests only; others use color.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OBSERVER_H
#define MEN_OBSERVER_H

#include "optics/spectrum.h"

enum {
    OBSERVER_WHITE_SAMPLES = 48, /* 360 to 830 nm in steps of 10 */
    OBSERVER_WAVELENGTH_CELLS = 256,
    OBSERVER_NODES = 2 * (SPECTRUM_SAMPLES - 1) /* of the quadrature below */
};

/* CIE 1931 2-degree colour-matching functions x, y, z (ISO/CIE 11664-1) from 360 nm in steps of 5 nm;
 * the fourth column and the last row are padding, so that a row is one vector and the row behind
 * 830 nm can be read. */
extern const float observer_xyz[SPECTRUM_SAMPLES + 1][4];

/* Illuminant D65 (ISO/CIE 11664-2) from 360 nm in steps of 10 nm, relative to 100 at 560 nm; linear
 * in between, as the standard says. One value of padding. */
extern const float observer_d65[OBSERVER_WHITE_SAMPLES + 1];

/* D65 times this is white_at: its luminance is that of the constant 1. */
#define OBSERVER_WHITE_SCALE 0.010112458344619178

/* Linear Rec.709 from the integral of spectrum times observer_xyz over nm. Derived from Rec.709's
 * primaries and from the white that the tables above integrate to (x 0.31274, y 0.32904; the nominal
 * values are 0.3127, 0.3290), which so becomes exactly (1, 1, 1). */
extern const double observer_rgb_from_xyz[3][3];

/* Wavelength against u in equal steps: the inverse of the distribution of wavelengths; see color.c. */
extern const float observer_wavelengths[OBSERVER_WAVELENGTH_CELLS + 1];

/* Where between two rows of a table in steps of step_nm a wavelength lies. Whatever it is, the row and
 * the one behind it are in the table. */
static inline int observer_row(float wavelength_nm, float step_nm, float *fraction)
{
    float limit = (SPECTRUM_MAX_NM - SPECTRUM_MIN_NM) / step_nm;
    float position = (wavelength_nm - SPECTRUM_MIN_NM) * (1 / step_nm);
    /* comparisons, because fmaxf is a call with gcc; NaN gives 0 */
    position = position > 0 ? position : 0;
    position = position < limit ? position : limit;
    int row = (int)position;
    *fraction = position - (float)row;
    return row;
}

/* The same for four wavelengths; returns the fractions. */
static inline Lanes observer_rows(Lanes wavelength_nm, float step_nm, int32_t row[LANES])
{
    Lanes position = lanes_scale(lanes_sub(wavelength_nm, lanes_all(SPECTRUM_MIN_NM)), 1 / step_nm);
    return lanes_split(lanes_clamp(position, 0, (SPECTRUM_MAX_NM - SPECTRUM_MIN_NM) / step_nm), row);
}
/* What a table has between the rows and those behind them. This form, and not a + f (b - a), is exact at both ends. */
static inline Lanes observer_between(const float *table, const int32_t row[LANES], Lanes fraction)
{
    Lanes here = lanes(table[row[0]], table[row[1]], table[row[2]], table[row[3]]);
    Lanes next = lanes(table[row[0] + 1], table[row[1] + 1], table[row[2] + 1], table[row[3] + 1]);
    return lanes_add(lanes_mul(lanes_rest(fraction), here), lanes_mul(fraction, next));
}

/* The wavelength of a node of the quadrature that is used wherever a colour is integrated exactly: two
 * Gauss points in each 5 nm, each of weight 2.5 nm. It is exact where the spectrum is at most linear in
 * each interval, so for white; a smooth spectrum leaves an error of the order of 1e-8. */
static inline double observer_node(int node)
{
    const double offset = 0.5 / 1.7320508075688772;
    double centre = (node >> 1) + 0.5;
    return (double)SPECTRUM_MIN_NM + SPECTRUM_STEP_NM * (centre + ((node & 1) ? offset : -offset));
}
#define OBSERVER_NODE_WEIGHT (0.5 * SPECTRUM_STEP_NM)

/* What radiance 1 at a node adds to linear Rec.709, the node's weight included. */
void observer_node_rgb(int node, double rgb[3]);

#endif
