/* sweep_parts.h - the path of a sweep in steps; private to src/shape/sweep*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SWEEP_PARTS_H
#define MEN_SWEEP_PARTS_H

#include "base/pool.h"
#include "shape/meshed.h"

typedef struct Station {
    Vec3 at, tangent;    /* of the path; at a corner of a straight path, of the bisector */
    Vec3 before, after;  /* directions of the path on both sides; equal unless at a corner */
    Vec3 u, v;           /* the outline's axes, across `after` */
    Vec3 bend;           /* change of the tangent per length */
    double scale, slope; /* slope: change of the scale per length */
    double along, turn;  /* length of the path so far; the frame's extra turn in radians */
    size_t source;       /* the point of the path at or before it */
    bool turns_back;     /* a corner that is too sharp for a mitre */
} Station;

/* sweep_union.c: all that is within a radius of the path and between the planes of two neighbouring stations, as one solid: also where
 * the path bends more than the radius, or comes near itself. Joints are those of the sweep, mitres; a ball where a corner is too
 * sharp for one. reached: how far its surface is from the triangles. STATUS_SCENE. */
ATTR_NODISCARD Status sweep_make_union(const SweepShape *shape, const Station *stations, size_t n_stations, Pool *pool,
                                       Mesh **mesh, double *reached, Error *error);

#endif
