/* face.h - triangles that cover a polygon of a mesh file.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FACE_H
#define MEN_FACE_H

#include "base/vec3.h"
#include "mesh/exact.h"

enum { FACE_MOST_CORNERS = 1024 }; /* that are cut otherwise than as a fan */

/* A polygon, filled in by the caller, and what is made of it. Some kilobytes: not for the stack of a small thread. */
typedef struct FaceCut {
    uint32_t n; /* 3 to FACE_MOST_CORNERS */
    Vec3f corners[FACE_MOST_CORNERS];
    uint32_t triangles[FACE_MOST_CORNERS][3]; /* n - 2, of numbers of corners */
    Point2 at[FACE_MOST_CORNERS];
    uint32_t before[FACE_MOST_CORNERS], behind[FACE_MOST_CORNERS]; /* those that are left, in a ring */
    bool no_ear[FACE_MOST_CORNERS];
} FaceCut;

/* A fan from the first corner where that covers the polygon, as it does whatever is convex; else cut along lines that stay within
 * it. Each edge of the polygon is one of a triangle in any case. */
void face_cut(FaceCut *cut);

#endif
