/* grower.h - a mesh in the making, whose size is not known before.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GROWER_H
#define MEN_GROWER_H

#include "mesh/mesh.h"

/* Begun zeroed. A failure is remembered and told by grower_finish, so that makers need not ask at every vertex. */
typedef struct Grower {
    Vec3f *positions, *normals;
    uint32_t (*triangles)[3];
    size_t n_vertices, n_triangles, positions_capacity, normals_capacity, triangles_capacity;
    bool out_of_memory, too_large;
} Grower;

enum { GROWER_MAX_TRIANGLES = 400000000 };

/* Rounds to float; the normal need not have unit length, but some. */
uint32_t grower_vertex(Grower *grower, Vec3 position, Vec3 normal);
/* A triangle with two corners in one place is left out: its edges cancel, so that the rest stays closed. */
void grower_triangle(Grower *grower, uint32_t a, uint32_t b, uint32_t c);
/* a b c d in order around. */
void grower_quad(Grower *grower, uint32_t a, uint32_t b, uint32_t c, uint32_t d);
/* Hands the arrays over, equal vertices merged. STATUS_SCENE when there were too many triangles (what: "the prism"),
 * or none. The grower is empty afterwards. */
ATTR_NODISCARD Status grower_finish(Grower *grower, const char *what, Mesh **mesh, Error *error);
void grower_clear(Grower *grower);

#endif
