/* motion.c - what moves while the shutter is open, found by building the scene at several times.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/face.h"
#include "scene/motion_parts.h"

/* ---- which object is which ---- */

typedef struct Places {
    uint32_t *slots; /* 1 + the number of an object; 0: free */
    size_t mask;
} Places;

static Status places_init(Places *places, const Scene *scene, Error *error)
{
    size_t size = 64;
    while (size < 2 * (size_t)scene->n_objects) size *= 2;
    places->mask = size - 1;
    places->slots = calloc(size, sizeof *places->slots);
    if (!places->slots) return fail_memory(error, size * sizeof *places->slots, "what moves");
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        size_t at = (size_t)scene->objects[i].identity & places->mask;
        while (places->slots[at]) at = (at + 1) & places->mask;
        places->slots[at] = i + 1;
    }
    return STATUS_OK;
}

/* The object of the scene that is the given one at another time; NULL when it is not there. *changes: it is there, but
 * has turned into a combination, or from one into a single body. */
static const SceneObject *find_object(const Places *places, const Scene *scene, const SceneObject *object,
                                      bool *changes)
{
    *changes = false;
    size_t at = (size_t)object->identity & places->mask;
    for (uint32_t i; (i = places->slots[at]) != 0; at = (at + 1) & places->mask) {
        const SceneObject *found = &scene->objects[i - 1];
        if (found->identity != object->identity) continue;
        if ((found->shape == SCENE_NONE) == (object->shape == SCENE_NONE)) return found;
        *changes = true;
    }
    return NULL;
}

/* ---- the scene at another time ---- */

static bool same_map(const Affine *a, const Affine *b)
{
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (a->m[row][column] != b->m[row][column]) return false;
    return a->t.x == b->t.x && a->t.y == b->t.y && a->t.z == b->t.z;
}

void motion_of_map(Finder *f, uint32_t *motion, const Affine *first, const Affine *then)
{
    Scene *scene = f->scene;
    if (*motion == SCENE_NONE) {
        if (same_map(first, then)) return;
        size_t bytes = f->n_keys * sizeof *scene->motions;
        if (!array_reserve(&scene->motions, &f->motions_capacity, scene->n_motions + 1U, bytes)) {
            fail_memory(f->error, (scene->n_motions + 1U) * bytes, "what moves");
            arena_fail(&scene->arena);
        }
        *motion = scene->n_motions++;
        for (uint32_t k = 0; k < f->n_keys; k++) scene->motions[(size_t)*motion * f->n_keys + k] = *first;
    }
    /* what is not there any more later on stays where it was last */
    for (uint32_t k = f->key; k < f->n_keys; k++) scene->motions[(size_t)*motion * f->n_keys + k] = *then;
}

/* Cells of a height field, and polygons, stay cut as they were at first, whatever has become of them. */
static void keep_diagonals(const Mesh *mesh, Mesh *then)
{
    mesh_keep_cuts(mesh, then);
    if (mesh->grid_columns == 0 || mesh->grid_columns != then->grid_columns || mesh->n_vertices != then->n_vertices ||
        mesh->n_triangles != then->n_triangles)
        return;
    memcpy(then->triangles, mesh->triangles, mesh->n_triangles * sizeof *mesh->triangles);
}

/* An object whose shape is another one by now. A mesh is taken over from the last key. */
static void change_shape(Finder *f, const SceneObject *object, uint32_t then)
{
    SceneShape *shape = &f->scene->shapes[object->shape], *other = &f->other->shapes[then];
    bool last = f->key + 1 == f->n_keys, meshes = shape->mesh && other->mesh;
    if (f->shape_reported[object->shape] || f->shape_then[object->shape] == then) return;
    f->shape_then[object->shape] = then;
    if (shape->mesh_end || (meshes && !last)) return;
    if (scene_shape_hash(shape) == scene_shape_hash(other)) return;
    if (meshes) keep_diagonals(shape->mesh, other->mesh);
    if (meshes && mesh_same_triangles(shape->mesh, other->mesh)) {
        shape->mesh_end = other->mesh;
        other->mesh = NULL;
        return;
    }
    f->shape_reported[object->shape] = true;
    Diagnostic *report =
        diag_report(f->diag, D_SHAPE_CHANGES, object->span,
                    "the shape of %s changes while the shutter is open, and stays as it is at first", object->name);
    diag_hint(f->diag, report,
              "what can be blurred are places, turns and sizes, and meshes whose triangles stay the same");
}

/* The same mesh, whose parts overlap at one time only. The report is dropped when there was the same one before. */
static void report_new_parts(Finder *f, const SceneObject *object)
{
    Diagnostic *report =
        diag_report(f->diag, D_SHAPE_CHANGES, object->span,
                    "parts of %s come to overlap, or cease to, while the shutter is open: it stays as it is at first",
                    object->name);
    diag_hint(f->diag, report, "make each part an object of its own");
}

static void report_projection(Finder *f, const SceneCamera *camera)
{
    if (f->projection_reported) return;
    f->projection_reported = true;
    diag_report(f->diag, D_SHAPE_CHANGES, camera->span,
                "the projection of %s changes while the shutter is open, and stays as it is at first", camera->name);
}

static const char *const only_places = "what can be blurred are places, turns and sizes of objects, lights, cameras, "
                                       "textures and volumes, and numbers and colours of textures; not a volume's own";

/* where NULL: nowhere in the text */
void motion_report(Finder *f, const Span *where, const char *what, const char *name)
{
    static const char text[] = "%s%s changes while the shutter is open, and stays as it is at first";
    Diagnostic *report = where ? diag_report(f->diag, D_VALUE_CHANGES, *where, text, what, name)
                               : diag_report_nowhere(f->diag, D_VALUE_CHANGES, text, what, name);
    diag_hint(f->diag, report, "%s", only_places);
}

static void move_cameras(Finder *f)
{
    Scene *scene = f->scene;
    const Scene *other = f->other;
    const uint32_t key = f->key;
    for (uint32_t i = 0; i < scene->n_cameras; i++) {
        SceneCamera *camera = &scene->cameras[i], *keys = scene->camera_keys + (size_t)i * f->n_keys;
        for (uint32_t k = 0; k < other->n_cameras; k++) {
            const SceneCamera *then = &other->cameras[k];
            if (then->identity != camera->identity) continue;
            if (then->projection != camera->projection) {
                report_projection(f, camera);
                continue;
            }
            if (then->lens_radius != camera->lens_radius)
                motion_report(f, &camera->span, "the aperture of ", camera->name);
            else if (then->iris.blades != camera->iris.blades || then->iris.rotation != camera->iris.rotation ||
                     then->iris.roundness != camera->iris.roundness)
                motion_report(f, &camera->span, "the iris of ", camera->name);
            for (uint32_t later = key; later < f->n_keys; later++) {
                keys[later].from = then->from;
                keys[later].right = then->right;
                keys[later].up = then->up;
                keys[later].forward = then->forward;
                keys[later].half_width = then->half_width;
                memcpy(keys[later].shift, then->shift, sizeof then->shift);
                memcpy(keys[later].focus, then->focus, sizeof then->focus);
            }
            if (memcmp(&then->from, &camera->from, sizeof camera->from) != 0 ||
                memcmp(&then->forward, &camera->forward, sizeof camera->forward) != 0 ||
                memcmp(&then->up, &camera->up, sizeof camera->up) != 0 || then->half_width != camera->half_width ||
                memcmp(then->shift, camera->shift, sizeof then->shift) != 0 ||
                memcmp(then->focus, camera->focus, sizeof then->focus) != 0)
                camera->keys = keys;
        }
    }
}

static void move_object(Finder *f, SceneObject *object, const SceneObject *then)
{
    if (object->light != SCENE_NONE && then->light != SCENE_NONE)
        motion_of_lamp(f, object->light, then->light, &object->motion, &object->to_world);
    else
        motion_of_map(f, &object->motion, &object->to_world, &then->to_world);
    motion_of_texture_frame(f, object, then);
    change_shape(f, object, then->shape);
}

static void compare_with(Finder *f, const Places *places)
{
    uint32_t *const rows[] = {f->shape_then, f->medium_then, f->surface_then, f->texture_then};
    const uint32_t n[] = {f->scene->n_shapes, f->scene->n_media, f->scene->n_surfaces, f->scene->n_textures};
    for (size_t i = 0; i < COUNT_OF(rows); i++)
        for (uint32_t k = 0; k < n[i]; k++) rows[i][k] = SCENE_NONE;
    motion_of_values(f);
    move_cameras(f);
    motion_of_points(f);
    for (uint32_t i = 0; i < f->scene->n_objects; i++) {
        SceneObject *object = &f->scene->objects[i];
        bool changes;
        const SceneObject *then = find_object(places, f->other, object, &changes);
        if (!then && changes) report_new_parts(f, object);
        if (!then) continue;
        motion_of_matter(f, i, (uint32_t)(then - f->other->objects));
        if (object->shape != SCENE_NONE) move_object(f, object, then);
    }
}

void scene_report_later(Diag *diag, const Diag *then, const char *otherwise, double later, double clock)
{
    static const char format[] = "%.3g of a frame later, while the shutter is open: %s";
    const Diagnostic *first = then->first;
    while (first && first->severity != DIAG_ERROR) first = first->next;
    uint32_t source = first && first->has_span ? first->span.source : UINT32_MAX;
    const SourceSet *now = diag->sources;
    bool placed = source < now->n && source < then->sources->n &&
                  now->sources[source].length == then->sources->sources[source].length;
    const char *text = first ? first->text : otherwise;
    Diagnostic *report = placed ? diag_report(diag, D_SHUTTER_MISTAKE, first->span, format, later, text)
                                : diag_report_nowhere(diag, D_SHUTTER_MISTAKE, format, later, text);
    if (clock > 1) diag_hint(diag, report, "the clock is %.4g then; min(clock, 1) goes no further than 1", clock);
}

/* Builds the scene `later` frames after it was, and compares. Its mistakes are those of another clock: the first is
 * told. */
static Status look_later(Finder *f, double later)
{
    SourceSet sources = {.arena = &f->other_arena};
    Diag diag;
    SceneOptions at = *f->options;
    at.moment.later += later;
    diag_init(&diag, &f->other_arena, &sources);
    SceneInstant instant;
    Status status = build_at_moment(f->text, &at, &diag, &f->other, NULL, &instant, f->error);
    if (status == STATUS_OK) {
        Places places;
        TRY(places_init(&places, f->other, f->error));
        f->places = places.slots;
        compare_with(f, &places);
    } else if (status == STATUS_SCENE) {
        scene_report_later(f->diag, &diag, f->error->text, later, instant.clock);
        fail(f->error, STATUS_SCENE, "the scene has errors");
    }
    return status;
}

static void forget_later(Finder *f)
{
    scene_free(f->other);
    arena_clear(&f->other_arena);
    free(f->places);
    f->other = NULL;
    f->places = NULL;
}

/* The part of the way to the given later meshes that is gone while the shutter is open. */
static void blend_meshes(Scene *scene)
{
    float part = (float)scene->shutter;
    for (uint32_t i = 0; i < scene->n_shapes; i++) {
        const Mesh *mesh = scene->shapes[i].mesh;
        Mesh *end = scene->shapes[i].mesh_end;
        if (!end) continue;
        for (uint32_t k = 0; k < mesh->n_vertices; k++) {
            end->positions[k] =
                vec3f_add(vec3f_scale(mesh->positions[k], 1 - part), vec3f_scale(end->positions[k], part));
            if (mesh->normals && end->normals)
                end->normals[k] =
                    vec3f_add(vec3f_scale(mesh->normals[k], 1 - part), vec3f_scale(end->normals[k], part));
        }
    }
}

static void finder_init(Finder *f)
{
    Scene *scene = f->scene;
    Arena *arena = &scene->arena;
    size_t n_cameras = scene->n_cameras;
    f->shape_reported = ARENA_ARRAY(arena, bool, scene->n_shapes + 1U);
    f->shape_then = ARENA_ARRAY(arena, uint32_t, scene->n_shapes + 1U);
    f->medium_then = ARENA_ARRAY(arena, uint32_t, scene->n_media + 1U);
    f->surface_then = ARENA_ARRAY(arena, uint32_t, scene->n_surfaces + 1U);
    f->texture_then = ARENA_ARRAY(arena, uint32_t, scene->n_textures + 1U);
    f->texture_users = ARENA_ARRAY(arena, TextureUser, scene->n_textures + 1U);
    f->hung = ARENA_ARRAY(arena, uint8_t, scene->n_lights + 1U);
    for (uint32_t i = 0; i < scene->n_lights; i++) f->hung[i] = scene->lights[i].hangs ? HUNG_BEFORE | HUNG_SO_FAR : 0;
    f->texture_stays = ARENA_ARRAY(arena, bool, scene->n_textures + 1U);
    f->texture_frames_capacity = scene->n_texture_frames;
    scene->camera_keys = malloc((n_cameras * f->n_keys + 1) * sizeof *scene->camera_keys);
    if (!scene->camera_keys) arena_fail(arena);
    for (size_t i = 0; i < n_cameras; i++)
        for (uint32_t k = 0; k < f->n_keys; k++) scene->camera_keys[i * f->n_keys + k] = scene->cameras[i];
}

static void task_in_scene(void *context)
{
    Finder *f = context;
    finder_init(f);
    for (f->key = 1; f->key < f->n_keys && f->status == STATUS_OK; f->key++) {
        f->status = look_later(f, f->scene->shutter * f->key / (f->n_keys - 1));
        forget_later(f);
    }
    if (f->status != STATUS_OK) return;
    Scene *scene = f->scene;
    bool moves = motion_finish_textures(f) || scene->n_motions > 0;
    for (uint32_t i = 0; i < scene->n_shapes; i++) moves = moves || scene->shapes[i].mesh_end;
    for (uint32_t i = 0; i < scene->n_cameras; i++) moves = moves || scene->cameras[i].keys;
    if (!moves) return;
    scene->n_keys = f->n_keys;
    scene->hash = scene_hash_with_motion(scene);
}

Status scene_find_motion(const SceneText *text, const SceneOptions *options, const SceneInstant *instant, Diag *diag,
                         Scene *scene, Error *error)
{
    uint32_t n_keys = scene->n_keys; /* so far what the camera asks for */
    scene->n_keys = 0;
    if (!(scene->shutter > 0)) {
        for (uint32_t i = 0; i < scene->n_shapes; i++) {
            mesh_free(scene->shapes[i].mesh_end);
            scene->shapes[i].mesh_end = NULL;
        }
        return STATUS_OK;
    }
    blend_meshes(scene);
    SceneOptions at = *options;
    SceneText again = *text;
    if (!again.text && strcmp(again.path, "-") == 0 && diag->sources->n) { /* standard input is read already */
        const Source *source = &diag->sources->sources[0];
        again = (SceneText){source->name, source->text, source->length};
    }
    at.moment.animation = &instant->animation;
    Finder f = {.scene = scene, .diag = diag, .error = error, .text = &again, .options = &at, .n_keys = n_keys};
    arena_init(&f.other_arena);
    bool done = arena_guard(&scene->arena, task_in_scene, &f);
    forget_later(&f);
    return done ? f.status : fail(error, STATUS_NOMEM, "out of memory while looking for what moves");
}
