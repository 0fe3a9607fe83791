/* face.h - triangles that cover a polygon of a mesh file.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FACE_H
#define MEN_FACE_H

#include "mesh/exact.h"
#include "mesh/mesh.h"

enum { FACE_MOST_CORNERS = 1024 }; /* that are cut otherwise than as a fan */

/* A polygon, filled in by the caller, and what is made of it. Some kilobytes: not for the stack of a small thread. */
typedef struct FaceCut {
    uint32_t n; /* 3 to FACE_MOST_CORNERS */
    Vec3f corners[FACE_MOST_CORNERS];
    uint32_t triangles[FACE_MOST_CORNERS][3]; /* n - 2, of numbers of corners */
    Point2 at[FACE_MOST_CORNERS];
    uint32_t before[FACE_MOST_CORNERS], behind[FACE_MOST_CORNERS]; /* those that are left, in a ring */
    bool no_ear[FACE_MOST_CORNERS];
    uint32_t ring[FACE_MOST_CORNERS]; /* the corners' vertices */
} FaceCut;

/* A fan from the first corner where that covers the polygon, as it does whatever is convex; else cut along lines that stay within
 * it. Each edge of the polygon is one of a triangle in any case. Whether it is no fan. */
bool face_cut(FaceCut *cut);

/* The fan of n triangles from number `first` on, 1 to FACE_MOST_CORNERS - 2, becomes what covers its polygon. */
ATTR_NODISCARD Status mesh_cut_face(Mesh *mesh, size_t first, size_t n, FaceCut *cut, Error *error);
/* Polygons stay cut as they were at first, though they have changed their shape. */
void mesh_keep_cuts(const Mesh *mesh, Mesh *then);

#endif
