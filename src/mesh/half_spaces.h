/* half_spaces.h - what half spaces have in common, as a closed mesh.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_HALF_SPACES_H
#define MEN_HALF_SPACES_H

#include "mesh/mesh.h"

/* Where dot(normal, p) <= distance. */
typedef struct HalfSpace {
    Vec3 normal; /* unit */
    double distance;
} HalfSpace;

/* More are not looked at: the work grows with their square. */
enum { HALF_SPACES_MOST = 1024 };

/* By an affine map that is not singular. */
HalfSpace half_space_moved(const Affine *map, HalfSpace space);
/* The convex body that they have in common, with flat faces and no more vertices than it has corners, about *centre, which is the
 * mesh's origin. *mesh is NULL where it is empty, without end, next to flat, or such that rounding keeps it from being closed and
 * convex. STATUS_NOMEM. */
ATTR_NODISCARD Status half_spaces_mesh(const HalfSpace *spaces, uint32_t n, Mesh **mesh, Vec3 *centre, Error *error);
/* The box around it, an empty one where nothing is left. False where it is without end, and where memory ends. */
bool half_spaces_box(const HalfSpace *spaces, uint32_t n, Box3 *box);

#endif
