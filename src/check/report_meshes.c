/* report_meshes.c - meshes that cross themselves, those whose parts overlap, and materials of their files.
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
    if (found->n == 0) {
        Diagnostic *unsure = diag_report(diag, D_MESH_CROSSES_ITSELF, object->span,
                                         "the mesh of %s may cross itself: too many of its triangles are close to each "
                                         "other for all of them to be looked at",
                                         object->name);
        diag_hint(diag, unsure, "look at it in a picture: it may have finer folds than are meant");
        return;
    }
    Diagnostic *report = diag_report(
        diag, D_MESH_CROSSES_ITSELF, object->span, "the mesh of %s crosses itself: %s%llu pair%s of its triangles %s",
        object->name, found->gave_up ? "at least " : "", (unsigned long long)found->n, found->n == 1 ? "" : "s",
        found->n == 1 ? "passes through each other" : "pass through each other");
    Buf places = {0};
    for (uint32_t i = 0; i < found->n_places; i++) add_place(&places, object, found->first[i].place);
    note_places(diag, report, object, &places);
    diag_hint(diag, report, "make several objects of it, or several parts: these may overlap");
}

/* Parts of the object's mesh that share some of their inside: one body, which is right, and may be news. */
static void remark_overlap(const SceneObject *object, const MeshParts *parts, Diag *diag)
{
    Diagnostic *report;
    if (parts->gave_up)
        report = diag_report(diag, D_MESH_PARTS_OVERLAP, object->span,
                             "more parts of the mesh of %s overlap than can be told apart", object->name);
    else if (parts->n_overlapping == parts->n_bodies)
        report = diag_report(diag, D_MESH_PARTS_OVERLAP, object->span,
                             "the %u parts of the mesh of %s overlap: they are one body", (unsigned)parts->n_bodies,
                             object->name);
    else
        report = diag_report(diag, D_MESH_PARTS_OVERLAP, object->span,
                             "%u of the %u parts of the mesh of %s overlap: where they do, they are one body",
                             (unsigned)parts->n_overlapping, (unsigned)parts->n_bodies, object->name);
    Buf places = {0};
    add_place(&places, object, parts->place);
    note_places(diag, report, object, &places);
}

static void remark_joined(const Scene *scene, const SceneObject *object, const MeshJoin *join, Diag *diag)
{
    Buf apart = {0};
    const double(*m)[3] = object->to_world.m;
    double scale = vec3_length(vec3(m[0][0], m[1][0], m[2][0]));
    report_add_length(&apart, scene, join->farthest * scale);
    diag_report(diag, D_MESH_JOINED, object->span,
                "the mesh of %s was open by %s or less: %u of its vertices %s joined to others", object->name,
                buf_text(&apart), (unsigned)join->n_joined, join->n_joined == 1 ? "is" : "are");
    buf_clear(&apart);
}

static void warn_of_nested(const SceneObject *object, const MeshParts *parts, Diag *diag)
{
    Diagnostic *report = diag_report(diag, D_MESH_PART_WITHIN, object->span,
                                     "%u part%s of the mesh of %s %s within another and %s nothing",
                                     (unsigned)parts->n_within, parts->n_within == 1 ? "" : "s", object->name,
                                     parts->n_within == 1 ? "lies" : "lie", parts->n_within == 1 ? "adds" : "add");
    Buf places = {0};
    add_place(&places, object, parts->within_place);
    note_places(diag, report, object, &places);
    diag_hint(diag, report, "turn a part inward to make a cavity of it, or make it an object of another medium");
}

static void add_crossings(MeshCrossings *sum, const MeshCrossings *more)
{
    for (uint32_t i = 0; i < more->n_places && sum->n_places < COUNT_OF(sum->first); i++)
        sum->first[sum->n_places++] = more->first[i];
    sum->n += more->n;
    sum->gave_up = sum->gave_up || more->gave_up;
}

/* One object's mesh, or all layers of it: `first` and those behind it that belong to the same mesh. */
static Status report_mesh(const Scene *scene, const SceneObject *object, uint32_t first, Pool *pool, Diag *diag,
                          Error *error)
{
    uint32_t whole = scene->shapes[first].layer_of;
    uint32_t n = whole == SCENE_NONE ? 1 : scene->shapes[whole].parts.n_layers;
    MeshCrossings all = {0};
    for (uint32_t i = 0; i < n; i++) {
        MeshCrossings crossings;
        TRY(mesh_find_crossings(scene->shapes[first + i].mesh, pool, &crossings, error));
        add_crossings(&all, &crossings);
    }
    if (all.n || all.gave_up) warn_of_crossings(object, &all, diag);
    if (whole == SCENE_NONE) return STATUS_OK;
    const MeshParts *parts = &scene->shapes[whole].parts;
    if (parts->n_within < parts->n_overlapping - 1 || parts->gave_up) remark_overlap(object, parts, diag);
    return STATUS_OK;
}

/* Whether an object with an inside is the first of those that share its mesh; the shape that is the whole mesh then. */
static bool is_first_of_mesh(const Scene *scene, const SceneObject *object, bool *done, uint32_t *whole)
{
    if (object->shape == SCENE_NONE) return false;
    uint32_t layer_of = scene->shapes[object->shape].layer_of;
    *whole = layer_of == SCENE_NONE ? object->shape : layer_of;
    bool encloses = object->medium != SCENE_NONE || object->part_of != SCENE_NONE;
    if (!scene->shapes[object->shape].mesh || !encloses || done[*whole]) return false;
    return done[*whole] = true;
}

void report_nested_parts(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    bool *done = calloc(scene->n_shapes + 1U, sizeof *done);
    uint32_t whole;
    for (uint32_t i = 0; done && i < scene->n_objects; i++)
        if (is_first_of_mesh(scene, &scene->objects[i], done, &whole) && scene->shapes[whole].parts.n_within)
            warn_of_nested(&scene->objects[i], &scene->shapes[whole].parts, diag);
    free(done);
}

void report_mesh_materials(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    bool *done = calloc(scene->n_shapes + 1U, sizeof *done);
    for (uint32_t i = 0; done && i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->shape == SCENE_NONE) continue;
        uint32_t layer_of = scene->shapes[object->shape].layer_of,
                 at = layer_of == SCENE_NONE ? object->shape : layer_of;
        const SceneMaterials *materials = scene->shapes[at].materials;
        if (!materials || materials->n < 2 || done[at]) continue;
        done[at] = true;
        Diagnostic *report = diag_report(diag, D_MESH_MATERIALS, object->span,
                                         "all of %s is of one material; what '%s' says of %s is not taken",
                                         object->name, materials->file, materials->names);
        diag_hint(diag, report,
                  "where they matter, make a mesh of each part = \"...\", with its own surface or interior; 'meniscus "
                  "import %s' writes a scene of all",
                  materials->file);
    }
    free(done);
}

/* Objects that share a mesh get one report, at the first of them. */
Status report_mesh_crossings(const CompiledScene *compiled, Pool *pool, Diag *diag, Error *error)
{
    const Scene *scene = compiled->scene;
    bool *done = calloc(scene->n_shapes + 1U, sizeof *done);
    if (!done) return fail_memory(error, scene->n_shapes, "the report of meshes");
    Status status = STATUS_OK;
    uint32_t whole;
    for (uint32_t i = 0; i < scene->n_objects && status == STATUS_OK; i++) {
        const SceneObject *object = &scene->objects[i];
        if (!is_first_of_mesh(scene, object, done, &whole)) continue;
        if (scene->shapes[whole].join.n_joined) remark_joined(scene, object, &scene->shapes[whole].join, diag);
        status = report_mesh(scene, object, object->shape, pool, diag, error);
    }
    free(done);
    return status;
}
