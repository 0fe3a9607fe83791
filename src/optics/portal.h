/* portal.h - choosing directions through a rectangular opening by how bright an environment is behind it.
 * After B. Bitterli, J. Novak, W. Jarosz, "Portal-Masked Environment Map Sampling", Computer Graphics Forum 34(4) (2015),
 * [BNJ15]: the half of space behind the opening is kept by two angles about the opening's edges, in which the opening is
 * a rectangle from wherever it is seen, so that a table of sums has the light that comes through it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PORTAL_H
#define MEN_PORTAL_H

#include "optics/texture.h"

/* The light of one half of space, for all openings that are turned the same way. */
typedef struct PortalMap PortalMap;

/* to_environment: turns directions of the opening's frame into the environment's; in the frame x and z are along the
 * opening's edges and y is towards the side that light comes to. Some 10 ms to 500 ms, and 0.8 MB. */
ATTR_NODISCARD Status portal_map_new(const Environment *environment, const Affine *to_environment, PortalMap **map,
                                     Error *error);
void portal_map_free(PortalMap *map); /* NULL is fine */

/* An opening as it is seen from a place. */
typedef struct PortalView {
    double low[2], high[2]; /* in texels of the map */
    double power;           /* luminance times solid angle of what is behind it */
} PortalView;

/* from: in the opening's frame, whose origin is the middle of the opening. false from behind, in its plane, and where
 * nothing is behind it that shines. */
bool portal_look(const PortalMap *map, double half_width, double half_height, Vec3 from, PortalView *view);
/* A direction (unit, in the opening's frame) in proportion to luminance, as far as the map has it; *density: luminance
 * by the map, which over view->power is the density per steradian. u, v: uniform in [0, 1). */
Vec3 portal_sample(const PortalMap *map, const PortalView *view, float u, float v, double *density);
/* That luminance for any unit direction of the frame; 0 beside the opening. */
double portal_density(const PortalMap *map, const PortalView *view, Vec3 direction);

#endif
