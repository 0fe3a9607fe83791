/* build_mesh.c - meshes: from files and in place, and what must be mended before they can hold a medium.
 *
 * A mesh is inspected once per shape, in its own frame. Faces without extent and faces that occur twice are dropped,
 * faces that disagree about the outside are turned; each is a warning. Whether the mesh is closed is decided after
 * that, and is an error only for objects with an interior, or for a mesh that states that it is closed.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/file.h"
#include "mesh/face.h"
#include "mesh/mesh_file.h"
#include "scene/build_parts.h"

static bool same_point(Vec3f a, Vec3f b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

/* Triangles with two corners in one place. Those with three corners on a line stay: they have no area either, but
 * their edges can be what closes the mesh. */
static uint32_t drop_collapsed(Mesh *mesh, Vec3f *first)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        Vec3f a = mesh->positions[mesh->triangles[i][0]], b = mesh->positions[mesh->triangles[i][1]],
              c = mesh->positions[mesh->triangles[i][2]];
        if (same_point(a, b) || same_point(b, c) || same_point(c, a)) {
            if (kept == i) *first = a;
            continue;
        }
        memmove(mesh->triangles[kept++], mesh->triangles[i], sizeof mesh->triangles[i]);
    }
    uint32_t dropped = mesh->n_triangles - kept;
    mesh->n_triangles = kept;
    return dropped;
}

typedef struct SortedTriangle {
    Vec3f corners[3]; /* from the least on, in the triangle's own sense */
    uint32_t triangle;
} SortedTriangle;

static int compare_points(Vec3f a, Vec3f b)
{
    if (a.x != b.x) return a.x < b.x ? -1 : 1;
    if (a.y != b.y) return a.y < b.y ? -1 : 1;
    if (a.z != b.z) return a.z < b.z ? -1 : 1;
    return 0;
}

static int compare_corners(const SortedTriangle *a, const SortedTriangle *b)
{
    for (int i = 0; i < 3; i++) {
        int order = compare_points(a->corners[i], b->corners[i]);
        if (order) return order;
    }
    return 0;
}

static int compare_triangles(const void *left, const void *right)
{
    const SortedTriangle *a = left, *b = right;
    int order = compare_corners(a, b);
    return order ? order : a->triangle < b->triangle ? -1 : a->triangle > b->triangle;
}

/* Keeps the first of triangles that are equal in place and sense. */
static Status drop_duplicates(Mesh *mesh, uint32_t *dropped, Vec3f *first, Error *error)
{
    uint32_t n = mesh->n_triangles;
    *dropped = 0;
    SortedTriangle *sorted = malloc((n ? n : 1) * sizeof *sorted);
    if (!sorted) return fail_memory(error, n * sizeof *sorted, "a mesh");
    for (uint32_t i = 0; i < n; i++) {
        const uint32_t *t = mesh->triangles[i];
        int least = 0;
        for (int k = 1; k < 3; k++)
            if (compare_points(mesh->positions[t[k]], mesh->positions[t[least]]) < 0) least = k;
        sorted[i].triangle = i;
        for (int k = 0; k < 3; k++) sorted[i].corners[k] = mesh->positions[t[(least + k) % 3]];
    }
    qsort(sorted, n, sizeof *sorted, compare_triangles);
    uint32_t lowest = UINT32_MAX;
    for (uint32_t i = 1; i < n; i++)
        if (compare_corners(&sorted[i], &sorted[i - 1]) == 0) {
            uint32_t *t = mesh->triangles[sorted[i].triangle];
            if (sorted[i].triangle < lowest) {
                lowest = sorted[i].triangle;
                *first = sorted[i].corners[0];
            }
            t[0] = t[1] = t[2] = UINT32_MAX;
        }
    free(sorted);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++)
        if (mesh->triangles[i][0] != UINT32_MAX)
            memmove(mesh->triangles[kept++], mesh->triangles[i], sizeof mesh->triangles[i]);
    *dropped = n - kept;
    mesh->n_triangles = kept;
    return STATUS_OK;
}

/* Faces that were dropped: how many, why, and where the first was, in the mesh's own coordinates. */
static void report_dropped(Builder *b, const EvalNode *node, uint32_t n, const char *one, const char *several,
                           Vec3f first)
{
    if (!n) return;
    const char *name = node->name ? node->name : "the mesh";
    Diagnostic *report = diag_report(b->diag, D_MESH_MENDED, node->span, "%u of the triangles of %s %s", (unsigned)n,
                                     name, n == 1 ? one : several);
    diag_note(b->diag, report, node->span, "%s at <%g, %g, %g>", n == 1 ? "it is" : "the first is", (double)first.x,
              (double)first.y, (double)first.z);
}

/* Closes what is open by the last bits, or by as little as the node allows. */
static Status join(Builder *b, const EvalNode *node, uint32_t shape, MeshReport *report, Error *error)
{
    SceneShape *row = &b->scene->shapes[shape];
    const EvalProp *weld = eval_prop(node, "weld");
    double to_scene = b->facts[shape].to_scene;
    MeshJoin found;
    if (!report->n_open_edges || !report->finite) return STATUS_OK;
    TRY(mesh_join(row->mesh, row->mesh_end, weld ? weld->as.number / to_scene : -1, b->options->pool, &found, error));
    if (!found.n_joined) return STATUS_OK;
    if (!weld) row->join = found;
    if (!row->mesh_end) TRY(mesh_weld(row->mesh, b->options->pool, error));
    return mesh_inspect(row->mesh, b->options->pool, report, error);
}

/* Drops what is of no use; the report is of what is left. */
static Status clean(Builder *b, const EvalNode *node, uint32_t shape, MeshReport *report, Error *error)
{
    Mesh *mesh = b->scene->shapes[shape].mesh;
    TRY(mesh_inspect(mesh, b->options->pool, report, error));
    TRY(join(b, node, shape, report, error));
    Vec3f first_collapsed = {0, 0, 0}, first_duplicate = {0, 0, 0};
    uint32_t collapsed = report->n_degenerate ? drop_collapsed(mesh, &first_collapsed) : 0, duplicates = 0;
    if (report->n_duplicate) TRY(drop_duplicates(mesh, &duplicates, &first_duplicate, error));
    report_dropped(b, node, collapsed, "has no extent and is dropped", "have no extent and are dropped",
                   first_collapsed);
    report_dropped(b, node, duplicates, "occurs twice; one is dropped", "occur twice; one of each is dropped",
                   first_duplicate);
    return collapsed || duplicates ? mesh_inspect(mesh, b->options->pool, report, error) : STATUS_OK;
}

/* Turns triangles that face the wrong way. */
static Status turn(Builder *b, const EvalNode *node, uint32_t shape, MeshReport *report, Error *error)
{
    Mesh *mesh = b->scene->shapes[shape].mesh;
    bool inside_out = report->closed && report->inside_out, *mended = &b->facts[shape].turned;
    if (report->consistent && !inside_out) return STATUS_OK;
    TRY(mesh_orient(mesh, b->options->pool, mended, error));
    if (!*mended) return STATUS_OK; /* open_mesh or the like will follow where it matters */
    if (inside_out)
        diag_report(b->diag, D_MESH_MENDED, node->span, "the mesh was inside out; all of its triangles are turned");
    else
        diag_report(b->diag, D_MESH_MENDED, node->span,
                    "neighbouring triangles of the mesh disagreed about which side is out; some are turned");
    return mesh_inspect(mesh, b->options->pool, report, error);
}

bool build_finish_mesh(Builder *b, const EvalNode *node, uint32_t shape)
{
    Mesh *mesh = b->scene->shapes[shape].mesh;
    ShapeFacts *facts = &b->facts[shape];
    Error error;
    MeshReport report;
    Status status = clean(b, node, shape, &report, &error);
    if (status == STATUS_OK) status = turn(b, node, shape, &report, &error);
    if (!build_succeeded(b, status, &error, node->span)) return false;
    facts->bounds = report.bounds;
    facts->volume = report.volume;
    facts->closed = report.closed;
    facts->consistent = report.consistent;
    facts->finite = report.finite;
    facts->many_parts = report.n_components > 1 || report.n_non_manifold_edges > 0;
    facts->n_open_edges = report.n_open_edges;
    for (size_t i = 0; i < COUNT_OF(facts->open); i++) {
        facts->open[i].a = report.open[i].a;
        facts->open[i].b = report.open[i].b;
        facts->non_manifold[i].a = report.non_manifold[i].a;
        facts->non_manifold[i].b = report.non_manifold[i].b;
    }
    facts->n_non_manifold = report.n_non_manifold_edges;
    if (mesh->n_triangles) return true;
    diag_report(b->diag, D_MESH_INVALID, node->span, "the mesh has no triangles");
    return false;
}

static void note_edge(Builder *b, Diagnostic *report, Span span, const char *what, Vec3f p, Vec3f q)
{
    diag_note(b->diag, report, span, "%s from <%g, %g, %g> to <%g, %g, %g>", what, (double)p.x, (double)p.y,
              (double)p.z, (double)q.x, (double)q.y, (double)q.z);
}

/* The unit that suits a length. */
static double unit_for(double length_m, const char **name)
{
    static const char *const names[] = {"m", "mm", "um", "nm"};
    double unit_m = 1;
    size_t i = 0;
    for (; i + 1 < COUNT_OF(names) && length_m < unit_m; i++) unit_m /= 1000;
    *name = names[i];
    return unit_m;
}

/* Not less than a number and not more than another, of as few digits as may be. */
static double short_number(double least, double most)
{
    for (int digits = 1; digits < 6; digits++) {
        double step = pow(10, floor(log10(least)) + 1 - digits), rounded = ceil(least / step) * step;
        if (rounded <= most) return rounded;
    }
    return most;
}

/* Which `weld` would close it. */
static void hint_at_join(Builder *b, Diagnostic *report, uint32_t shape)
{
    const double largest = 0.02; /* of the mesh's size */
    const ShapeFacts *facts = &b->facts[shape];
    Mesh *mesh = b->scene->shapes[shape].mesh;
    MeshJoin found;
    double most;
    Error error;
    if (!mesh || !facts->finite ||
        mesh_find_join(mesh, largest, b->options->pool, &found, &most, &error) != STATUS_OK || !found.n_joined)
        return;
    const char *name;
    double scale = facts->to_scene * b->result.unit_m, to_unit = scale / unit_for(found.farthest * scale, &name);
    /* poles may be 1e-16 apart, which is no length that one would write */
    double least = double_max(found.farthest, most * 1e-3);
    diag_hint(b->diag, report, "vertices on these edges lie %.3g %s apart or less: weld = %.6g%s closes it",
              found.farthest * to_unit, name, short_number(least * to_unit, most * to_unit), name);
}

void build_report_open(Builder *b, Span span, const char *name, uint32_t shape)
{
    ShapeFacts *facts = &b->facts[shape];
    if (facts->reported_open) return; /* one report for all that share the mesh */
    facts->reported_open = true;
    if (facts->n_non_manifold && (!facts->consistent || facts->n_open_edges <= facts->n_non_manifold)) {
        Diagnostic *report = diag_report(
            b->diag, D_NON_MANIFOLD_MESH, span,
            "%s encloses nothing: %u of its edges have more than two faces, with no sense of inside and outside", name,
            (unsigned)facts->n_non_manifold);
        for (uint32_t i = 0; i < facts->n_non_manifold && i < COUNT_OF(facts->non_manifold); i++)
            note_edge(b, report, span, "edge of several faces", facts->non_manifold[i].a, facts->non_manifold[i].b);
        return;
    }
    if (!facts->consistent) {
        Diagnostic *report = diag_report(
            b->diag, D_MESH_ORIENTATION, span,
            "%s encloses nothing: its faces cannot be turned so that neighbours agree about the outside", name);
        diag_hint(b->diag, report,
                  "what has one side, as Klein's bottle, can be a sheet, instead of its interior: surface = surface { "
                  "thin = true  ior = 1.5  transmission = 1 }");
        return;
    }
    Diagnostic *report =
        diag_report(b->diag, D_OPEN_MESH, span, "%s is open and encloses nothing: %u edge%s a face on one side only",
                    name, (unsigned)facts->n_open_edges, facts->n_open_edges == 1 ? " has" : "s have");
    for (uint32_t i = 0; i < facts->n_open_edges && i < COUNT_OF(facts->open); i++)
        note_edge(b, report, span, "open edge", facts->open[i].a, facts->open[i].b);
    hint_at_join(b, report, shape);
}

/* ---- the node ---- */

/* The names of what a file says of its materials. On the stack: an arena that is full jumps over what would free it. */
typedef struct MaterialNames {
    char text[400];
    size_t n;
} MaterialNames;

/* Those that it says something of. */
static void name_materials(const MeshSource *source, MaterialNames *names)
{
    enum { MOST_NAMED = 4, LONGEST = 60 };
    size_t length = 0, n = 0, named = 0;
    for (size_t i = 0; i < source->n_materials; i++) n += material_says_something(&source->materials[i]);
    names->n = n;
    names->text[0] = 0;
    for (size_t i = 0; i < source->n_materials && named < MOST_NAMED; i++) {
        if (!material_says_something(&source->materials[i])) continue;
        const char *name = source->materials[i].name, *before = named == 0 ? "" : named + 1 == n ? " and " : ", ";
        named++;
        const char *quote = *name ? "'" : "";
        length += (size_t)snprintf(names->text + length, sizeof names->text - length, "%s%s%.*s%s", before, quote,
                                   LONGEST, *name ? name : "one without a name", quote);
    }
    if (n > MOST_NAMED) snprintf(names->text + length, sizeof names->text - length, " and %zu more", n - MOST_NAMED);
}

static void note_materials(Builder *b, const EvalProp *file, const MaterialNames *names, const EvalProp *part,
                           uint32_t shape)
{
    SceneShape *row = &b->scene->shapes[shape];
    if (!names->n) return;
    Arena *arena = &b->scene->arena;
    SceneMaterials *materials = ARENA_ARRAY(arena, SceneMaterials, 1);
    *materials = (SceneMaterials){.file = arena_copy_text(arena, file->as.text, strlen(file->as.text)),
                                  .names = arena_copy_text(arena, names->text, strlen(names->text)),
                                  .n = part ? 1 : (uint32_t)names->n}; /* who takes a part knows of the others */
    row->materials = materials;
}

static bool load_file(Builder *b, const EvalProp *file, const char *path, const EvalProp *part, bool smooth,
                      uint32_t shape, Mesh **mesh)
{
    Error error;
    MeshSource source = {
        .asked = part ? part->as.list.texts : NULL, .n_asked = part ? part->as.list.n : 0, .kept = &b->kept_mesh};
    if (source.n_asked > MESH_MOST_ASKED) {
        diag_report(b->diag, D_LIMIT, part->span, "more than %d parts are asked for at once", MESH_MOST_ASKED);
        return false;
    }
    Status status = mesh_load(path, &source, mesh, &error);
    b->facts[shape].file_unit_m = source.unit_m;
    MaterialNames materials;
    name_materials(&source, &materials);
    mesh_source_clear(&source);
    if (status == STATUS_OK && !smooth) {
        free((*mesh)->normals);
        (*mesh)->normals = NULL;
    }
    if (status == STATUS_OK) status = mesh_weld(*mesh, b->options->pool, &error);
    if (status == STATUS_OK) note_materials(b, file, &materials, part, shape);
    if (status == STATUS_INPUT || status == STATUS_SCENE) {
        diag_report(b->diag, file_exists(path) ? D_MESH_INVALID : D_FILE_UNREADABLE, file->span, "%s", error.text);
        return false;
    }
    return build_succeeded(b, status, &error, file->span);
}

static bool fill_in_place(Builder *b, const EvalProp *positions, const EvalProp *triangles, uint32_t shape)
{
    Error error;
    size_t n_vertices = positions->as.list.n, n_triangles = triangles->as.list.n;
    if (n_vertices >= UINT32_MAX || n_triangles >= UINT32_MAX) {
        diag_report(b->diag, D_LIMIT, positions->span, "a mesh of %zu vertices and %zu triangles is too large",
                    n_vertices, n_triangles);
        return false;
    }
    Mesh **mesh = &b->scene->shapes[shape].mesh;
    Status status = mesh_new((uint32_t)n_vertices, (uint32_t)n_triangles, false, false, mesh, &error);
    if (!build_succeeded(b, status, &error, positions->span)) return false;
    for (size_t i = 0; i < n_vertices; i++) {
        const double *p = &positions->as.list.numbers[3 * i];
        if (!build_check_reach(b, positions->span, "a vertex", box3_add_point(box3_empty(), vec3(p[0], p[1], p[2]))))
            return false;
        (*mesh)->positions[i] = vec3f_from(vec3(p[0], p[1], p[2]));
    }
    for (size_t i = 0; i < 3 * n_triangles; i++) {
        double index = triangles->as.list.numbers[i];
        if (!(index >= 0 && index < (double)n_vertices && index == floor(index))) {
            diag_report(b->diag, D_BAD_INDEX, triangles->span,
                        "triangle %zu names vertex %g, and there are the vertices 0 to %zu", i / 3, index,
                        n_vertices - 1);
            return false;
        }
        (*mesh)->triangles[i / 3][i % 3] = (uint32_t)index;
    }
    return true;
}

/* The same triangles a frame later. What was mended of the mesh is true of it, too. */
static bool load_next(Builder *b, const EvalProp *next, const EvalProp *part, bool smooth, uint32_t shape)
{
    SceneShape *row = &b->scene->shapes[shape];
    const char *path = eval_find_file(&b->eval_options, b->diag, next->span, next->as.text);
    if (!path) return false;
    build_note_file(b, path);
    if (!load_file(b, next, path, part, smooth, shape, &row->mesh_end)) return false;
    mesh_keep_cuts(row->mesh, row->mesh_end);
    if (mesh_same_triangles(row->mesh, row->mesh_end)) return true;
    Diagnostic *report =
        diag_report(b->diag, D_MESH_INVALID, next->span,
                    "'%s' has %u vertices and %u triangles, and is not the mesh of %u and %u a frame later",
                    next->as.text, (unsigned)row->mesh_end->n_vertices, (unsigned)row->mesh_end->n_triangles,
                    (unsigned)row->mesh->n_vertices, (unsigned)row->mesh->n_triangles);
    diag_hint(b->diag, report, "the triangles must be the same, in the same order; only places and normals may differ");
    return false;
}

/* How long the file's unit is in scene units. */
static double file_scale(const Builder *b, const EvalNode *node, uint32_t shape)
{
    const EvalProp *unit = eval_prop(node, "unit");
    double file_unit_m = b->facts[shape].file_unit_m;
    return unit ? unit->as.number : file_unit_m > 0 ? file_unit_m / b->result.unit_m : 1;
}

/* Those of the file that point to the inner side of the mesh as it was mended. */
static bool turn_normals(Builder *b, const EvalNode *node, uint32_t shape)
{
    SceneShape *row = &b->scene->shapes[shape];
    Error error;
    uint32_t n_turned, n_at_end;
    Status status = mesh_turn_normals(row->mesh, &n_turned, &error);
    if (status == STATUS_OK && row->mesh_end) status = mesh_turn_normals(row->mesh_end, &n_at_end, &error);
    if (!build_succeeded(b, status, &error, node->span)) return false;
    if (n_turned > row->mesh->n_vertices / 2 && !b->facts[shape].turned)
        diag_report(b->diag, D_MESH_MENDED, node->span,
                    "the normals of the mesh pointed to the inner side of its triangles; they are turned");
    return true;
}

/* Normals that are made of the mesh as it was mended. */
static bool make_normals(Builder *b, const EvalNode *node, uint32_t shape)
{
    const EvalProp *crease = eval_prop(node, "crease");
    SceneShape *row = &b->scene->shapes[shape];
    Error error;
    if (!crease) return true;
    Status status =
        mesh_make_normals(row->mesh, row->mesh_end, crease->as.number * MEN_DEGREE, b->options->pool, &error);
    return build_succeeded(b, status, &error, node->span);
}

static bool load_files(Builder *b, const EvalNode *node, const EvalProp *file, const char *path, const EvalProp *part,
                       uint32_t shape)
{
    const EvalProp *next = eval_prop(node, "next_file");
    bool smooth = eval_truth(node, "smooth") && !eval_prop(node, "crease");
    SceneShape *row = &b->scene->shapes[shape];
    if (!load_file(b, file, path, part, smooth, shape, &row->mesh)) return false;
    if (next && !load_next(b, next, part, smooth, shape)) return false;
    b->facts[shape].to_scene = file_scale(b, node, shape);
    if (!build_finish_mesh(b, node, shape)) return false;
    row = &b->scene->shapes[shape];
    if (next) {
        row->mesh_end->n_triangles = row->mesh->n_triangles; /* some may have been dropped */
        memcpy(row->mesh_end->triangles, row->mesh->triangles, row->mesh->n_triangles * sizeof *row->mesh->triangles);
    }
    return turn_normals(b, node, shape) && make_normals(b, node, shape);
}

/* The shape that a file holds; false after reporting. */
static bool shape_of_file(Builder *b, const EvalNode *node, const EvalProp *file, uint32_t *shape)
{
    bool smooth = eval_truth(node, "smooth"), found;
    const char *path = eval_find_file(&b->eval_options, b->diag, file->span, file->as.text);
    if (!path) return false;
    build_note_file(b, path);
    const EvalProp *part = eval_prop(node, "part"), *next = eval_prop(node, "next_file"),
                   *weld = eval_prop(node, "weld"), *unit = eval_prop(node, "unit"),
                   *crease = eval_prop(node, "crease");
    const char *key =
        arena_format(b->arena, "mesh %d %s%s%s", smooth, path, next ? "\nnext " : "", next ? next->as.text : "");
    for (size_t i = 0; part && i < part->as.list.n; i++)
        key = arena_format(b->arena, "%s\npart %s", key, part->as.list.texts[i]);
    if (weld) /* a length of the scene, in the file's unit */
        key = arena_format(b->arena, "%s\nweld %a %a", key, weld->as.number, unit ? unit->as.number : 0);
    if (crease) key = arena_format(b->arena, "%s\ncrease %a", key, crease->as.number);
    *shape = build_shape_of(b, key, strlen(key), &found);
    return found || load_files(b, node, file, path, part, *shape);
}

/* The shape of a mesh node: one for each file and each list in the text, however often it is placed. */
static bool mesh_shape(Builder *b, const EvalNode *node, uint32_t *shape)
{
    const EvalProp *file = eval_prop(node, "file"), *positions = eval_prop(node, "positions"),
                   *triangles = eval_prop(node, "triangles");
    const EvalNode *origin = node;
    while (origin->prototype) origin = origin->prototype;
    bool found;
    if (file) { /* instances need not look for it again */
        uint32_t *known = build_row_of(b, &b->mesh_files, origin, SCENE_NONE, &found);
        if (*known == SCENE_NONE) {
            if (!shape_of_file(b, node, file, shape)) return false;
            *known = *shape;
        }
        *shape = *known;
    } else {
        const char *key = arena_format(b->arena, "mesh %p", (const void *)origin);
        *shape = build_shape_of(b, key, strlen(key), &found);
        b->facts[*shape].to_scene = 1;
        if (!found)
            return fill_in_place(b, positions, triangles, *shape) && build_finish_mesh(b, node, *shape) &&
                   make_normals(b, node, *shape);
    }
    /* a shape that failed before has been reported before */
    return b->scene->shapes[*shape].mesh && b->scene->shapes[*shape].mesh->n_triangles;
}

/* From the file's axes and unit to the scene's. */
static Affine file_to_scene(const Builder *b, const EvalNode *node, uint32_t shape)
{
    double s = file_scale(b, node, shape);
    if (strcmp(eval_word(node, "up"), "z") == 0) return (Affine){{{s, 0, 0}, {0, 0, s}, {0, -s, 0}}, {0, 0, 0}};
    return (Affine){{{s, 0, 0}, {0, s, 0}, {0, 0, s}}, {0, 0, 0}};
}

void build_mesh(Builder *b, const EvalNode *node, const Affine *to_world)
{
    const EvalProp *file = eval_prop(node, "file"), *positions = eval_prop(node, "positions"),
                   *triangles = eval_prop(node, "triangles");
    if (!build_exclude(b, node, "file", "positions") || !build_exclude(b, node, "file", "triangles")) return;
    if (!file && (!positions || !triangles)) {
        Diagnostic *report = diag_report(b->diag, D_MISSING_PROPERTY, node->span, "this mesh has no %s",
                                         positions   ? "'triangles'"
                                         : triangles ? "'positions'"
                                                     : "'file'");
        diag_hint(b->diag, report, "give a file, or positions and triangles");
        return;
    }
    static const char *const of_files[] = {"smooth", "part", "unit", "up", "next_file"};
    for (size_t i = 0; !file && i < COUNT_OF(of_files); i++) build_needs(b, node, of_files[i], "without a file");
    uint32_t shape;
    if (!mesh_shape(b, node, &shape)) return;
    if (eval_truth(node, "closed") && !b->facts[shape].closed)
        build_report_open(b, node->span, node->name ? node->name : "the mesh", shape);
    if (!file) {
        build_object(b, node, shape, to_world);
        return;
    }
    Affine place = file_to_scene(b, node, shape);
    place = affine_compose(to_world, &place);
    build_object(b, node, shape, &place);
}
