/* guide_fit.h - lobes that describe from where the photons of a small region come; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_FIT_H
#define MEN_GUIDE_FIT_H

#include "trace/photon.h"

/* Directions about a mean that depends linearly on the place. Directions near the axis are points of a plane by Lambert's
 * azimuthal projection, which keeps areas, so that densities per area are densities per steradian. The lobe is the wider, and
 * counts the less, the further away its place is. */
typedef struct GuideLobe {
    float cumulative;       /* share of the cell's light, of this lobe's way and those before */
    float weight;           /* of its way */
    uint32_t n_way;         /* how many lobes the way has, from its first on */
    float bend;             /* how wrong it is for places away from its own: angle by the square of the distance */
    Vec3f place;            /* where it was found, from the cell's origin; the nearest lobe of a way knows best */
    Vec3f axis, x, y;       /* a right-handed frame */
    Vec3f slope_x, slope_y; /* of the mean in the plane, by the place */
    float mean_x, mean_y;   /* at the cell's origin */
    float xx, xy, yy;       /* spread about the mean, at its place */
} GuideLobe;

enum { GUIDE_CELL_KNOWN = 32, GUIDE_CELL_LOBES = GUIDE_CELL_KNOWN + 1 };

/* Makes lobes of n_known <= GUIDE_CELL_KNOWN photons that have been looked around at, and one around all n >= 1 photons
 * of a cell, after whose flux the ways that light takes are weighted. `known` is put into another order. Places are relative to
 * origin. Returns how many. */
uint32_t guide_fit(Photon *known, uint32_t n_known, const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes);

/* A direction of a cell's lobes at a place, and the density of that. u: uniform in [0, 1); v: in [0, 1)^2. */
Vec3f guide_sample_lobes(const GuideLobe *lobes, uint32_t n, Vec3f offset, float u, const float v[2]);
float guide_lobes_pdf(const GuideLobe *lobes, uint32_t n, Vec3f offset, Vec3f direction);

#endif
