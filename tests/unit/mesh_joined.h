/* mesh_joined.h - meshes of several parts, for tests.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_MESH_JOINED_H
#define MEN_TEST_MESH_JOINED_H

#include "mesh/mesh.h"

/* One mesh of two; frees them. */
static inline Mesh *joined(Mesh *a, Mesh *b)
{
    Mesh *mesh = NULL;
    assert_int_equal(
        mesh_new(a->n_vertices + b->n_vertices, a->n_triangles + b->n_triangles, false, false, &mesh, NULL), STATUS_OK);
    memcpy(mesh->positions, a->positions, a->n_vertices * sizeof *a->positions);
    memcpy(mesh->positions + a->n_vertices, b->positions, b->n_vertices * sizeof *b->positions);
    memcpy(mesh->triangles, a->triangles, a->n_triangles * sizeof *a->triangles);
    for (uint32_t i = 0; i < b->n_triangles; i++)
        for (int k = 0; k < 3; k++) mesh->triangles[a->n_triangles + i][k] = b->triangles[i][k] + a->n_vertices;
    mesh_free(a);
    mesh_free(b);
    return mesh;
}

#endif
