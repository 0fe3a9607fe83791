/* report_meshes.c - meshes that enclose some of their inside twice.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "check/report.h"

static void add_place(Buf *places, const SceneObject *object, Vec3f place)
{
    Vec3 p = affine_point(&object->to_world, vec3_from_f(place));
    buf_format(places, "%s<%g, %g, %g>", places->length ? ", " : "", p.x, p.y, p.z);
}

static void note_places(Diag *diag, Diagnostic *report, const SceneObject *object, Buf *places)
{
    diag_note(diag, report, object->span, "near %s", buf_text(places));
    buf_clear(places);
}

static void warn_of_crossings(const SceneObject *object, const MeshCrossings *found, Diag *diag)
{
    Diagnostic *report = diag_report(
        diag, D_MESH_CROSSES_ITSELF, object->span, "the mesh of %s crosses itself: %s%llu pair%s of its triangles %s",
        object->name, found->gave_up ? "at least " : "", (unsigned long long)found->n, found->n == 1 ? "" : "s",
        found->n == 1 ? "passes through each other" : "pass through each other");
    Buf places = {0};
    for (uint32_t i = 0; i < found->n_places; i++) add_place(&places, object, found->first[i].place);
    note_places(diag, report, object, &places);
    diag_hint(diag, report, "make its parts one mesh without inner walls, or several objects: these may overlap");
}

static void warn_of_nested(const SceneObject *object, const MeshNested *nested, Diag *diag)
{
    Diagnostic *report = diag_report(diag, D_MESH_CROSSES_ITSELF, object->span,
                                     "%u part%s of the mesh of %s %s within another and %s outward",
                                     (unsigned)nested->n, nested->n == 1 ? "" : "s", object->name,
                                     nested->n == 1 ? "lies" : "lie", nested->n == 1 ? "faces" : "face");
    Buf places = {0};
    add_place(&places, object, nested->place);
    note_places(diag, report, object, &places);
    diag_hint(diag, report, "turn a part inward to make a cavity of it, or make it an object of its own");
}

/* Objects that share a mesh get one report, at the first of them. */
Status report_mesh_crossings(const CompiledScene *compiled, Pool *pool, Diag *diag, Error *error)
{
    const Scene *scene = compiled->scene;
    bool *done = calloc(scene->n_shapes + 1U, sizeof *done);
    if (!done) return fail_memory(error, scene->n_shapes, "the report of meshes");
    Status status = STATUS_OK;
    for (uint32_t i = 0; i < scene->n_objects && status == STATUS_OK; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->shape == SCENE_NONE || done[object->shape]) continue;
        const Mesh *mesh = scene->shapes[object->shape].mesh;
        bool encloses = object->medium != SCENE_NONE || object->part_of != SCENE_NONE;
        if (!mesh || !encloses) continue;
        done[object->shape] = true;
        MeshCrossings crossings = {0};
        MeshNested nested = {0};
        status = mesh_find_crossings(mesh, pool, &crossings, error);
        if (status == STATUS_OK && crossings.n == 0) status = mesh_find_nested(mesh, &nested, error);
        if (crossings.n) warn_of_crossings(object, &crossings, diag);
        if (nested.n) warn_of_nested(object, &nested, diag);
    }
    free(done);
    return status;
}
