/* quads.h - triangles in pairs, for searches that take two at once.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_QUADS_H
#define MEN_QUADS_H

#include "mesh/mesh.h"

/* A quad is four vertices a, b, c, d and stands for two triangles on either side of b and d: a b d and c d b, the even and
 * the odd one. Where c and d are one vertex, the odd one is nothing. */
typedef uint32_t MeshQuad[4];

static inline bool mesh_quad_is_single(const MeshQuad quad)
{
    return quad[2] == quad[3];
}

/* Which of a quad's vertices is corner i (0 .. 2) of triangle `half` (0 or 1). */
static inline uint32_t mesh_quad_corner(uint32_t half, uint32_t i)
{
    return i < 2 ? 2 * half + i : 3 - 2 * half;
}

/* The corners of triangle `half` of a quad, counter-clockwise as in the mesh. */
static inline void mesh_quad_triangle(const MeshQuad quad, uint32_t half, uint32_t corners[3])
{
    for (uint32_t i = 0; i < 3; i++) corners[i] = quad[mesh_quad_corner(half, i)];
}

/* Turns both triangles round, as a map that mirrors does. */
static inline void mesh_quad_turn(MeshQuad quad)
{
    uint32_t b = quad[1];
    quad[1] = quad[3];
    quad[3] = b;
}

/* All triangles of a mesh, each once, as *n quads, which are malloc'd and in the order of the triangles that come first.
 * Two are paired that share an edge, by its vertices' numbers, in opposite directions, and that fit: the longest edge of
 * both, if it can be, and a box around both that has no more area than the boxes of the two. STATUS_NOMEM, also of
 * more than 2^30 triangles. */
ATTR_NODISCARD Status mesh_pair_triangles(const Mesh *mesh, MeshQuad **quads, uint32_t *n, Error *error);

#endif
