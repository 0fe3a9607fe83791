/* fuzz_mesh.h - what the fuzzers of mesh files share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FUZZ_MESH_H
#define MEN_FUZZ_MESH_H

#include <math.h>

#include "fuzz.h"
#include "mesh/mesh_file.h"

typedef Status MeshLoader(const char *path, MeshSource *source, Mesh **mesh, Error *error);

/* What comes out of a reader is a mesh that all else can rely on. */
static inline int fuzz_mesh(MeshLoader *load, const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    MeshSource source = {0};
    Mesh *mesh = NULL;
    Error error = {0};
    Status status = load(path, &source, &mesh, &error);
    unlink(path);
    FUZZ_HOLDS(status == STATUS_OK ? mesh != NULL : mesh == NULL && error.text[0]);
    if (mesh) {
        for (size_t i = 0; i < (size_t)mesh->n_triangles * 3; i++)
            FUZZ_HOLDS(mesh->triangles[i / 3][i % 3] < mesh->n_vertices);
        for (size_t i = 0; i < mesh->n_vertices; i++)
            FUZZ_HOLDS(isfinite(mesh->positions[i].x) && isfinite(mesh->positions[i].y) &&
                       isfinite(mesh->positions[i].z));
    }
    mesh_free(mesh);
    mesh_source_clear(&source);
    return 0;
}

#endif
