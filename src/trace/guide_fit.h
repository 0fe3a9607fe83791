/* guide_fit.h - lobes that describe from where the photons of a small region come; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_FIT_H
#define MEN_GUIDE_FIT_H

#include "trace/photon.h"

/* Directions about a mean that depends linearly on the place. Directions near the axis are points of a plane by Lambert's
 * azimuthal projection, which keeps areas, so that densities per area are densities per steradian. */
typedef struct GuideLobe {
    float cumulative; /* share of the cell's light, of this lobe and those before */
    float weight;
    Vec3f axis, x, y;              /* a right-handed frame */
    Vec3f slope_x, slope_y;        /* of the mean in the plane, by the place */
    float mean_x, mean_y;          /* at the cell's origin */
    float scale_x, shear, scale_y; /* Cholesky factor of the spread about the mean */
    float cos_reach;               /* of the angle beyond which there is nothing */
    float density;                 /* at the mean */
} GuideLobe;

enum { GUIDE_CELL_LOBES = 48 };

/* Fits up to GUIDE_CELL_LOBES lobes to n >= 1 photons, places being relative to origin. Returns how many. */
uint32_t guide_fit(const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes);

/* A direction of a lobe at a place, and the density of that. v: uniform in [0, 1)^2. */
Vec3f guide_lobe_sample(const GuideLobe *lobe, Vec3f offset, const float v[2]);
float guide_lobe_pdf(const GuideLobe *lobe, Vec3f offset, Vec3f direction);

#endif
