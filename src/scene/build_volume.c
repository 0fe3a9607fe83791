/* build_volume.c - volumes: grids from files, and functions of the scene that are made into grids.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/memory.h"
#include "diag/limits.h"
#include "optics/nanovdb.h"
#include "scene/build_parts.h"

/* ---- grids of functions ---- */

/* The values of a function at the corners of cells, all at once: a grid's bricks share those at their sides. */
typedef struct Corners {
    const float *values;
    Box3 box;
    int32_t n[3];
} Corners;

static Status fill_from_corners(void *context, const int32_t first[3], float values[VOLUME_BRICK_VALUES], bool *uniform,
                                Error *error)
{
    const Corners *corners = context;
    (void)uniform;
    (void)error;
    for (int32_t k = 0; k < VOLUME_EDGE; k++)
        for (int32_t j = 0; j < VOLUME_EDGE; j++)
            for (int32_t i = 0; i < VOLUME_EDGE; i++) {
                const int32_t offset[3] = {i, j, k};
                int32_t at[3];
                for (int axis = 0; axis < 3; axis++) { /* beyond the grid its last values go on */
                    at[axis] = first[axis] + offset[axis];
                    if (at[axis] > corners->n[axis] - 1) at[axis] = corners->n[axis] - 1;
                }
                *values++ =
                    corners->values[((size_t)at[2] * (size_t)corners->n[1] + (size_t)at[1]) * (size_t)corners->n[0] +
                                    (size_t)at[0]];
            }
    return STATUS_OK;
}

static bool check_value(Builder *b, const EvalProp *function, const char *what, Vec3 p, double value)
{
    if (value >= 0 && value <= (double)FLT_MAX / 16) return true;
    Diagnostic *report =
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, function->span,
                    "this %s is %g at <%g, %g, %g>, and must be 0 or more", what, value, p.x, p.y, p.z);
    if (value < 0) diag_hint(b->diag, report, "max(0, ...) cuts off what is below");
    return false;
}

static Vec3 corner_at(const void *context, uint32_t i, uint32_t j, uint32_t k)
{
    const Corners *corners = context;
    Vec3 size = vec3_sub(corners->box.max, corners->box.min);
    return vec3(corners->box.min.x + size.x * i / (corners->n[0] - 1),
                corners->box.min.y + size.y * j / (corners->n[1] - 1),
                corners->box.min.z + size.z * k / (corners->n[2] - 1));
}

/* Asks the function at all corners; false after reporting. */
static bool ask_corners(Builder *b, const EvalProp *function, const char *what, const Corners *corners, float *values)
{
    const SceneField field = build_field(b, function->as.function);
    FieldLayer layer = {corners, corner_at, {(uint32_t)corners->n[0], (uint32_t)corners->n[1]}, 0, NULL};
    size_t n = (size_t)layer.n[0] * layer.n[1];
    double *asked = ARENA_ARRAY(b->eval_options.arena, double, n);
    for (; layer.k < (uint32_t)corners->n[2]; layer.k++) {
        if (!build_field_layer(&field, &layer, asked)) return false;
        for (size_t i = 0; i < n; i++) {
            Vec3 p = corner_at(corners, (uint32_t)(i % layer.n[0]), (uint32_t)(i / layer.n[0]), layer.k);
            if (!check_value(b, function, what, p, asked[i])) return false;
            *values++ = (float)asked[i];
        }
    }
    return true;
}

/* How many corners along each axis; false after reporting. */
static bool count_corners(Builder *b, const EvalNode *node, Box3 box, int32_t n[3])
{
    Vec3 size = vec3_sub(box.max, box.min);
    const double sizes[3] = {size.x, size.y, size.z};
    double longest = vec3_max_abs(size), cells = eval_number(node, "cells"), total = 1;
    if (!(size.x > 0 && size.y > 0 && size.z > 0)) {
        diag_report(b->diag, D_DEGENERATE_SHAPE, build_span(node, "to"), "the box of this volume measures %g x %g x %g",
                    size.x, size.y, size.z);
        return false;
    }
    for (int axis = 0; axis < 3; axis++) {
        n[axis] = (int32_t)fmax(ceil(cells * sizes[axis] / longest - 1e-9), 1) + 1;
        total *= n[axis];
    }
    if (total <= LIMIT_VOLUME_VALUES) return true;
    Diagnostic *report = diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "cells"),
                                     "%g cells make a grid of %.3g values; the limit is %.3g", cells, total,
                                     (double)LIMIT_VOLUME_VALUES);
    limit_hint(b->diag, report, OVER_VOLUME_VALUES);
    return false;
}

static size_t most_bytes(void)
{
    double most = LIMIT_VOLUME_MB * 1e6;
    if (memory_of_machine() > 0) most = fmin(most, 0.75 * memory_of_machine());
    return (size_t)fmin(most, (double)SIZE_MAX / 4);
}

static Volume *volume_of_function(Builder *b, const EvalNode *node, const EvalProp *function, const char *what)
{
    Box3 box = box3_add_point(box3_add_point(box3_empty(), eval_vector(node, "from")), eval_vector(node, "to"));
    Corners corners = {.box = box};
    if (!build_check_reach(b, node->span, "a volume", box) || !count_corners(b, node, box, corners.n)) return NULL;
    size_t n = (size_t)corners.n[0] * (size_t)corners.n[1] * (size_t)corners.n[2];
    float *values = ARENA_ARRAY(b->eval_options.arena, float, n); /* gone when the scene is built */
    if (!ask_corners(b, function, what, &corners, values)) return NULL;
    corners.values = values;
    Volume *volume;
    Error error;
    Status status =
        volume_new(corners.n, fill_from_corners, &corners, 0, most_bytes(), "the grid of a function", &volume, &error);
    if (!build_succeeded(b, status, &error, function->span)) return NULL;
    Vec3 size = vec3_sub(box.max, box.min);
    Affine *map = &volume->to_lattice;
    map->m[0][0] = (corners.n[0] - 1) / size.x;
    map->m[1][1] = (corners.n[1] - 1) / size.y;
    map->m[2][2] = (corners.n[2] - 1) / size.z;
    map->t = vec3_scale(affine_vector(map, box.min), -1);
    return volume;
}

/* ---- grids of files ---- */

static Volume *volume_of_file(Builder *b, const EvalNode *node, const EvalProp *file)
{
    const EvalProp *grid = eval_prop(node, "grid");
    const char *path = eval_find_file(&b->eval_options, b->diag, file->span, file->as.text);
    if (!path) return NULL;
    build_note_file(b, path);
    Volume *volume;
    Error error;
    Status status = nanovdb_read(path, grid ? grid->as.text : NULL, most_bytes(), &volume, &error);
    if (status == STATUS_OK) return volume;
    Diagnostic *report = diag_report(b->diag, D_VOLUME_INVALID, grid ? grid->span : file->span, "%s", error.text);
    if (status == STATUS_NOMEM) limit_hint(b->diag, report, OVER_VOLUME_MB);
    return NULL;
}

/* ---- at later moments ---- */

/* Of all that the values of a volume come from. */
static uint64_t content_of(Builder *b, const EvalNode *node)
{
    enum { PLACES = 2000 };
    const EvalProp *file = eval_prop(node, "file"), *function = eval_prop(node, "function");
    const EvalProp *grid = eval_prop(node, "grid");
    double scale = eval_number(node, "scale");
    uint64_t h = hash_bytes(&scale, sizeof scale, 0);
    if (file) h = hash_bytes(file->as.text, strlen(file->as.text), h);
    if (grid) h = hash_bytes(grid->as.text, strlen(grid->as.text), h);
    if (!function) return h;
    const Vec3 ends[2] = {eval_vector(node, "from"), eval_vector(node, "to")};
    const double cells = eval_number(node, "cells");
    h = hash_bytes(ends, sizeof ends, hash_bytes(&cells, sizeof cells, h));
    const SceneField field = build_field(b, function->as.function);
    if (field.program) return hash_u64(h ^ program_hash(field.program));
    for (uint64_t i = 0; i < PLACES; i++) { /* what only the evaluation can do is told by what it gives */
        double at[3], value = 0;
        for (uint64_t axis = 0; axis < 3; axis++) at[axis] = hash_to_unit(hash_u64(3 * i + axis));
        Vec3 size = vec3_sub(ends[1], ends[0]);
        Vec3 p = vec3_add(ends[0], vec3(size.x * at[0], size.y * at[1], size.z * at[2]));
        if (!build_field_value(&field, p, &value)) break; /* reported */
        h = hash_bytes(&value, sizeof value, h);
    }
    return h;
}

/* While the shutter is open only its place is asked for, and whether it is another one: grids cost time and memory. */
static Volume *stand_in(void)
{
    Volume *volume = calloc(1, sizeof *volume);
    if (volume) volume->to_lattice = affine_identity();
    return volume;
}

/* ---- nodes ---- */

static void check_node(Builder *b, const EvalNode *node)
{
    static const char *const of_function[] = {"from", "to", "cells"};
    const EvalProp *file = eval_prop(node, "file"), *function = eval_prop(node, "function");
    build_exclude(b, node, "file", "function");
    if (!file) build_needs(b, node, "grid", "without a 'file'");
    for (size_t i = 0; file && !function && i < COUNT_OF(of_function); i++)
        build_needs(b, node, of_function[i], "on a grid from a file: transforms place it");
    if (file || function) return;
    Diagnostic *report =
        diag_report(b->diag, D_MISSING_PROPERTY, node->span, "this volume has neither a file nor a function");
    diag_hint(b->diag, report, "volume { file = \"smoke.nvdb\" } or volume { function = f }, with def f(p) = ...");
}

static Volume *make_volume(Builder *b, const EvalNode *node, const char *what)
{
    const EvalProp *file = eval_prop(node, "file"), *function = eval_prop(node, "function");
    size_t n_errors = b->diag->n_errors;
    check_node(b, node);
    if (b->diag->n_errors != n_errors || !build_check_transform(b, node, &node->transform)) return NULL;
    Volume *volume = file ? volume_of_file(b, node, file) : volume_of_function(b, node, function, what);
    if (!volume) return NULL;
    Affine to_own;
    double scale = eval_number(node, "scale");
    affine_invert(&node->transform, &to_own); /* it is not flat */
    volume->to_lattice = affine_compose(&volume->to_lattice, &to_own);
    if ((double)volume->largest * scale > (double)FLT_MAX / 16) {
        diag_report(b->diag, D_VALUE_OUT_OF_RANGE, build_span(node, "scale"), "%g times this volume's %g is too large",
                    scale, (double)volume->largest);
        scale = 0;
    }
    volume_scale(volume, (float)scale);
    if (!(volume->largest > 0)) diag_report(b->diag, D_EMPTY_VOLUME, node->span, "this %s is 0 everywhere", what);
    return volume;
}

const Volume *build_volume(Builder *b, const EvalNode *node, const char *property)
{
    const EvalProp *prop = eval_prop(node, property);
    bool later = build_is_later(b);
    if (!prop || b->only_shapes) return NULL;
    Scene *scene = b->scene;
    bool found;
    const EvalNode *volume_node = prop->as.node;
    uint32_t *row = build_row_of(b, &b->volumes, volume_node, SCENE_NONE, &found);
    if (found) return *row == SCENE_NONE ? NULL : scene->volumes[*row];
    uint32_t capacity = b->volumes_capacity;
    scene->volumes =
        room_for_one(b->arena, scene->volumes, scene->n_volumes, &b->volumes_capacity, sizeof *scene->volumes);
    scene->volume_places =
        room_for_one(b->arena, scene->volume_places, scene->n_volumes, &capacity, sizeof *scene->volume_places);
    Volume *volume = later ? stand_in() : make_volume(b, volume_node, property);
    if (!volume) {
        if (later) arena_fail(b->arena);
        return NULL;
    }
    *row = scene->n_volumes;
    scene->volume_places[*row] =
        (SceneVolumePlace){.to_frame = volume_node->transform,
                           .motion = SCENE_NONE,
                           .content = content_of(b, volume_node),
                           .span = volume_node->span,
                           .from_file = eval_prop(volume_node, "file") != NULL,
                           .has_box = eval_prop(volume_node, "from") && eval_prop(volume_node, "to")};
    scene->volumes[scene->n_volumes++] = volume;
    return volume;
}

void build_note_frame(Builder *b, uint32_t object)
{
    Scene *scene = b->scene;
    const SceneMedium *medium = &scene->media[scene->objects[object].medium];
    if (!medium->density && !medium->temperature) return;
    scene->frames = room_for_one(b->arena, scene->frames, scene->n_frames, &b->frames_capacity, sizeof *scene->frames);
    scene->frames[scene->n_frames++] = (SceneFrame){object, SCENE_NONE, b->node_to_world};
}
