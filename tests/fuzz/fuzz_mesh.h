/* fuzz_mesh.h - what the fuzzers of mesh files share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FUZZ_MESH_H
#define MEN_FUZZ_MESH_H

#include <math.h>

#include "fuzz.h"
#include "import/import.h"
#include "lang/format.h"
#include "mesh/mesh_file.h"

typedef Status MeshLoader(const char *path, MeshSource *source, Mesh **mesh, Error *error);

/* What a scene's text goes through. */
typedef struct FuzzScene {
    FuzzText text;
    Buf out;
    Status status;
    Error error;
} FuzzScene;

static inline void fuzz_lay_out(void *context)
{
    FuzzScene *scene = context;
    scene->status =
        format_text("scene", scene->text.text, scene->text.length, &scene->text.diag, &scene->out, &scene->error);
}

/* Of any mesh that could be read comes a scene in the language, or one message. */
static inline void fuzz_import(const char *path, const MeshSource *source, const Mesh *mesh)
{
    Import import;
    Error error = {0};
    ImportOptions options = {.path = path, .file = "model", .folder = "", .real_folder = "/nowhere/", .stem = "scene"};
    Status status = import_scene(&options, source, mesh, &import, &error);
    FUZZ_HOLDS(status == STATUS_OK || error.text[0]);
    if (status == STATUS_OK) {
        FuzzScene scene = {.out = {0}};
        fuzz_text_open(&scene.text, (const uint8_t *)buf_text(&import.text), import.text.length);
        if (arena_guard(&scene.text.arena, fuzz_lay_out, &scene)) FUZZ_HOLDS(scene.status == STATUS_OK);
        buf_clear(&scene.out);
        fuzz_text_close(&scene.text);
    }
    import_clear(&import);
}

/* What comes out of a reader is a mesh that all else can rely on. */
static inline int fuzz_mesh(MeshLoader *load, const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    MeshSource source = {.whole = true};
    Mesh *mesh = NULL;
    Error error = {0};
    Status status = load(path, &source, &mesh, &error);
    FUZZ_HOLDS(status == STATUS_OK ? mesh != NULL : mesh == NULL && error.text[0]);
    if (mesh) {
        for (size_t i = 0; i < (size_t)mesh->n_triangles * 3; i++)
            FUZZ_HOLDS(mesh->triangles[i / 3][i % 3] < mesh->n_vertices);
        for (size_t i = 0; i < mesh->n_vertices; i++)
            FUZZ_HOLDS(isfinite(mesh->positions[i].x) && isfinite(mesh->positions[i].y) &&
                       isfinite(mesh->positions[i].z));
        fuzz_import(path, &source, mesh);
    }
    unlink(path);
    mesh_free(mesh);
    mesh_source_clear(&source);
    return 0;
}

#endif
