/* ball_side.h - whether a ball keeps away from the surface of a solid or a mesh, and on which side of it the ball is then.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BALL_SIDE_H
#define MEN_BALL_SIDE_H

#include "mesh/box_tree.h"
#include "mesh/mesh.h"
#include "shape/piece.h"

/* The profile of a solid of very many pieces, as a tree: what it takes to ask only those that matter. */
typedef struct ProfileTree {
    HalfBox *nodes;    /* a heap: children of i are 2 i and 2 i + 1; leaves from n_leaves on */
    uint32_t n_leaves; /* a power of two; 0: no tree, all pieces are asked */
} ProfileTree;

/* Leaves a solid of few pieces without one. */
ATTR_NODISCARD Status profile_tree_make(const Solid *solid, ProfileTree *tree, Error *error);
void profile_tree_clear(ProfileTree *tree);

typedef enum BallSide {
    BALL_NEAR, /* the surface may come into the ball */
    BALL_INSIDE,
    BALL_OUTSIDE
} BallSide;

/* In the solid's own frame. BALL_NEAR is said more often than it is true: of tori and arcs the whole circle counts.
 * Always so for what is not closed. */
BallSide solid_ball_side(const Solid *solid, const ProfileTree *tree, Vec3 centre, double radius);

/* How far a point is from a piece at least, in its frame; of spheres, bands and planes just that far. */
double piece_distance(const Piece *piece, Vec3 p);

/* ---- meshes (ball_side_mesh.c) ---- */

/* From the origin to a triangle, squared. */
double squared_to_triangle(const Vec3 corner[3]);

/* A tree of the triangles' boxes. What was made is to be cleared also after a failure. */
ATTR_NODISCARD Status mesh_box_tree(const Mesh *mesh, BoxTree *tree, Error *error);
/* The same for a closed mesh whose triangles look outward, in its own frame. A radius below the rounding of the centre in
 * float is too small. */
BallSide mesh_ball_side(const Mesh *mesh, const BoxTree *tree, Vec3 centre, double radius);

#endif
