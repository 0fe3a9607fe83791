/* layers.c - the layers of a mesh as meshes of their own.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "mesh/mesh.h"

void mesh_parts_clear(MeshParts *parts)
{
    free(parts->layer);
    parts->layer = NULL;
}

/* The triangles of each layer stand together in order. moved_to: of each vertex, UINT32_MAX, before and after. */
static Status take_layer(const Mesh *mesh, const uint32_t *order, uint32_t n, uint32_t *moved_to, Mesh **taken,
                         Error *error)
{
    uint32_t n_vertices = 0;
    for (uint32_t i = 0; i < 3 * n; i++) {
        uint32_t *place = &moved_to[mesh->triangles[order[i / 3]][i % 3]];
        if (*place == UINT32_MAX) *place = n_vertices++;
    }
    Status status = mesh_new(n_vertices, n, mesh->normals != NULL, mesh->uvs != NULL, taken, error);
    for (uint32_t i = 0; status == STATUS_OK && i < 3 * n; i++) {
        uint32_t vertex = mesh->triangles[order[i / 3]][i % 3], place = moved_to[vertex];
        (*taken)->triangles[i / 3][i % 3] = place;
        (*taken)->positions[place] = mesh->positions[vertex];
        if (mesh->normals) (*taken)->normals[place] = mesh->normals[vertex];
        if (mesh->uvs) memcpy(&(*taken)->uvs[2 * (size_t)place], &mesh->uvs[2 * (size_t)vertex], 2 * sizeof(float));
    }
    for (uint32_t i = 0; i < 3 * n; i++) moved_to[mesh->triangles[order[i / 3]][i % 3]] = UINT32_MAX;
    return status;
}

Status mesh_take_layers(const Mesh *mesh, const MeshParts *parts, Mesh **taken, Error *error)
{
    uint32_t n = mesh->n_triangles;
    size_t *first = calloc(parts->n_layers + (size_t)2, sizeof *first), *next = first ? first + 1 : NULL;
    uint32_t *order = malloc((n + (size_t)1) * sizeof *order);
    uint32_t *moved_to = malloc((mesh->n_vertices + (size_t)1) * sizeof *moved_to);
    Status status =
        first && order && moved_to ? STATUS_OK : fail_memory(error, n * sizeof *order, "the parts of a mesh");
    if (status == STATUS_OK) { /* see list_edges of topology.c */
        for (uint32_t i = 0; i < mesh->n_vertices; i++) moved_to[i] = UINT32_MAX;
        for (uint32_t i = 0; i < n; i++) next[parts->layer[i] + 1]++;
        for (uint32_t k = 1; k <= parts->n_layers; k++) next[k] += next[k - 1];
        for (uint32_t i = 0; i < n; i++) order[next[parts->layer[i]]++] = i;
    }
    for (uint32_t k = 0; status == STATUS_OK && k < parts->n_layers; k++)
        status = take_layer(mesh, order + first[k], (uint32_t)(first[k + 1] - first[k]), moved_to, &taken[k], error);
    free(first);
    free(order);
    free(moved_to);
    return status;
}
