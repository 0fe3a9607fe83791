/* flat_way.h - ways of light by flat faces, one after another: through them, or mirrored.
 *
 * A ray by given faces is known in closed form, and so is how far its end moves as its start is turned (ray differentials: H.
 * Igehy, "Tracing Ray Differentials", SIGGRAPH 1999, 3.1; of flat faces alone, whose normals are the same everywhere). So the ray
 * that leads from one point to another is found by Newton's method.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FLAT_WAY_H
#define MEN_FLAT_WAY_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vec3.h"

/* The points p of normal . p = offset. */
typedef struct FlatFace {
    Vec3 normal; /* unit, to either side */
    double offset;
    double eta;    /* refractive index in front of it over that behind; of no use where it mirrors */
    bool mirrored; /* else it is gone through */
} FlatFace;

/* A ray behind the last face. */
typedef struct FlatRay {
    Vec3 origin, direction; /* on that face; unit */
    Vec3 origin_turned[2],
        direction_turned[2]; /* by how much both change as the start is turned, by radians about two axes */
} FlatRay;

/* The ray that starts at a point in a direction (unit); false: it is reflected totally, or comes to a face from behind. */
bool flat_way_follow(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 direction, FlatRay *ray);
/* The area, across the ray at a point on it, that a steradian of directions at its start leads to. */
double flat_ray_spread(const FlatRay *ray, Vec3 to);
/* The direction in which a ray leads by the faces from one point to another, to 1e-8 of how far these are; false: none was found.
 * leaving: the unit direction behind the last face, roughly, where faces turn rays so far that one that starts straight ahead
 * misses them; or NULL. */
bool flat_way_find(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 to, const Vec3 *leaving, Vec3 *direction,
                   FlatRay *ray);

/* The direction with which a ray starts that leaves by the faces in a given one (unit), and how many steradians there come of one at
 * its start; false: none leaves so. Where the faces are does not matter. */
bool flat_way_leaving(const FlatFace *faces, uint32_t n, Vec3 leaving, Vec3 *direction, double *spread);

#endif
