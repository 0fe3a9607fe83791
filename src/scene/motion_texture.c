/* motion_texture.c - textures that change while the shutter is open: their places and numbers are looked up between keys, and
 * what is not a number is told to stay.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <string.h>

#include "lang/schema_find.h"
#include "scene/motion_parts.h"

/* ---- what there is to see ---- */

static bool same_choices(const Texture *a, const Texture *b)
{
    const Pattern *p = &a->pattern, *q = &b->pattern;
    bool octaves = a->turbulence_octaves == b->turbulence_octaves || (a->turbulence == 0 && b->turbulence == 0);
    return a->kind == b->kind && a->in_world == b->in_world && a->is_value == b->is_value && a->shines == b->shines &&
           a->projection == b->projection && a->wrap == b->wrap && octaves && a->seed == b->seed &&
           a->source == b->source && a->n_stops == b->n_stops && p->kind == q->kind && p->shape == q->shape &&
           p->wave == q->wave && p->style == q->style && p->octaves == q->octaves && p->value == q->value;
}

static bool same_numbers(const Pattern *p, const Pattern *q)
{
    const double first[] = {p->size.x, p->size.y,     p->size.z, p->mortar, p->bevel,  p->bond, p->frequency,
                            p->phase,  p->lacunarity, p->gain,   p->grain,  p->radius, p->blur};
    const double second[] = {q->size.x, q->size.y,     q->size.z, q->mortar, q->bevel,  q->bond, q->frequency,
                             q->phase,  q->lacunarity, q->gain,   q->grain,  q->radius, q->blur};
    for (size_t i = 0; i < COUNT_OF(first); i++)
        if (first[i] != second[i]) return false;
    return true;
}

/* As far apart as rounding makes equal places. */
static bool nearly_same_map(const Affine *a, const Affine *b)
{
    const double slack = 1e-12;
    double largest = 0, apart = vec3_max_abs(vec3_sub(a->t, b->t));
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            largest = fmax(largest, fabs(a->m[row][column]));
            if (fabs(a->m[row][column] - b->m[row][column]) > slack * (1 + largest)) return false;
        }
    return apart <= slack * (1 + largest + vec3_max_abs(a->t));
}

static bool same_texture(const Texture *a, const Texture *b)
{
    if (a->placed != b->placed || a->vary != b->vary || a->turns != b->turns || a->turbulence != b->turbulence ||
        (a->placed && !nearly_same_map(&a->to_pattern, &b->to_pattern)))
        return false;
    if (a->kind == TEXTURE_CONSTANT && !spectrum_same(&a->value, &b->value)) return false;
    if (a->kind == TEXTURE_PATTERN && !same_numbers(&a->pattern, &b->pattern)) return false;
    if (a->kind == TEXTURE_FORMULA && program_hash(a->program) != program_hash(b->program)) return false;
    for (uint32_t i = 0; i < a->n_stops; i++)
        if (a->stops[i].at != b->stops[i].at || !spectrum_same(&a->stops[i].value, &b->stops[i].value)) return false;
    return true;
}

/* ---- keys ---- */

/* The other moment's memory goes: what a key needs of it is copied. */
static void *keep(Finder *f, const void *items, size_t n, size_t size)
{
    void *copy = arena_array(&f->scene->arena, n + 1, size);
    if (n) memcpy(copy, items, n * size);
    return copy;
}

static void keep_spectrum(Finder *f, Spectrum *spectrum)
{
    if (spectrum->kind == SPECTRUM_TABLE)
        spectrum->table = keep(f, spectrum->table, SPECTRUM_SAMPLES, sizeof *spectrum->table);
}

/* What a texture is at one key: it takes its values from others of the first moment. */
static Texture key_of(Finder *f, const Texture *first, const Texture *then)
{
    Texture key = *then;
    key.keys = NULL;
    key.low = first->low;
    key.high = first->high;
    key.blend = first->blend;
    key.image = first->image;
    if (!then->placed || !affine_invert(&then->to_pattern, &key.to_pattern)) key.to_pattern = affine_identity();
    if (then == first) return key;
    keep_spectrum(f, &key.value);
    if (then->n_stops) {
        TextureStop *stops = keep(f, then->stops, then->n_stops, sizeof *stops);
        for (uint32_t i = 0; i < then->n_stops; i++) keep_spectrum(f, &stops[i].value);
        key.stops = stops;
    }
    if (then->program) {
        Program *program = keep(f, then->program, 1, sizeof *program);
        program->steps = keep(f, program->steps, program->n_steps, sizeof *program->steps);
        program->constants = keep(f, program->constants, program->n_constants, sizeof *program->constants);
        key.program = program;
    }
    return key;
}

static void add_key(Finder *f, Texture *texture, const Texture *then)
{
    Texture *keys = texture->keys;
    if (!keys) {
        if (same_texture(texture, then)) return;
        keys = ARENA_ARRAY(&f->scene->arena, Texture, f->n_keys);
        for (uint32_t k = 0; k < f->n_keys; k++) keys[k] = key_of(f, texture, texture);
        texture->keys = keys;
        texture->n_keys = f->n_keys;
    }
    keys[f->key] = key_of(f, texture, then);
    for (uint32_t k = f->key + 1; k < f->n_keys; k++) keys[k] = keys[f->key];
}

static void report_texture(Finder *f, uint32_t row, TextureUser user)
{
    if (f->texture_stays[row]) return;
    f->texture_stays[row] = true;
    f->scene->textures[row].keys = NULL;
    Diagnostic *report = diag_report(
        f->diag, D_VALUE_CHANGES, user.object->span,
        "'%s' of %s: its texture becomes another one while the shutter is open, and stays as it is at first",
        user.property, user.object->name);
    diag_hint(
        f->diag, report,
        "what can be blurred of a texture are its place, its numbers and colours, and the constants of a function: "
        "not its kind, picture, seed or how many stops or octaves it has");
}

/* Of a texture and those that it takes its values from. */
static void follow(Finder *f, uint32_t row, uint32_t row_then, TextureUser user)
{
    if (row == TEXTURE_NONE || row_then == TEXTURE_NONE || f->texture_then[row] == row_then) return;
    Texture *texture = &f->scene->textures[row];
    const Texture *then = &f->other->textures[row_then];
    bool known = f->texture_then[row] != SCENE_NONE;
    if (f->texture_stays[row]) return;
    if (!same_choices(texture, then) || !texture->program != !then->program ||
        (known && !same_texture(&f->other->textures[f->texture_then[row]], then))) {
        report_texture(f, row, user);
        return;
    }
    if (known) return;
    f->texture_then[row] = row_then;
    f->texture_users[row] = user;
    if (texture->kind != TEXTURE_CONSTANT) {
        follow(f, texture->low, then->low, user);
        follow(f, texture->high, then->high, user);
        follow(f, texture->blend, then->blend, user);
    }
    add_key(f, texture, then);
}

/* ---- surfaces ---- */

static void report_property(Finder *f, const SceneObject *object, const char *property)
{
    const PropType *type = schema_prop(schema_node(scene_schema(), "surface"), property);
    Diagnostic *report = diag_report(f->diag, D_VALUE_CHANGES, object->span,
                                     "'%s' of %s changes while the shutter is open, and stays as it is at first",
                                     property, object->name);
    if (type && (type->flags & PROP_TEXTURE))
        diag_hint(f->diag, report, "what a texture says is blurred: %s = gradient { from = x  to = x }", property);
}

static void follow_all(Finder *f, const SceneObject *object, SceneSurface *surface, const SceneSurface *then)
{
    for (uint32_t i = 0; i < surface->n_textures; i++) {
        const char *property = surface->textures[i].property;
        const SurfaceTexture *other = build_texture_of(then, property);
        if (other) follow(f, surface->textures[i].texture, other->texture, (TextureUser){object, property});
    }
    follow(f, surface->bump, then->bump, (TextureUser){object, "bump"});
    follow(f, surface->normal_map, then->normal_map, (TextureUser){object, "normal_map"});
    follow(f, surface->emission_texture, then->emission_texture, (TextureUser){object, "emission"});
}

void motion_of_surface(Finder *f, const SceneObject *object, uint32_t row, uint32_t row_then)
{
    SceneSurface *surface = &f->scene->surfaces[row];
    const SceneSurface *then = &f->other->surfaces[row_then];
    if (f->surface_then[row] == row_then) return;
    f->surface_then[row] = row_then;
    unsigned n = 0;
    for (const char *property; (property = build_next_change(surface, then, &n)) != NULL;)
        report_property(f, object, property);
    if (surface->mixed && then->mixed)
        for (int i = 0; i < 2; i++) motion_of_surface(f, object, surface->mix[i], then->mix[i]);
    follow_all(f, object, surface, then);
    build_widen_surface(surface, then);
}

void motion_of_texture_frame(Finder *f, SceneObject *object, const SceneObject *then)
{
    Scene *scene = f->scene;
    if (object->texture_frame == SCENE_NONE || then->texture_frame == SCENE_NONE) return;
    SceneTextureFrame *frame = &scene->texture_frames[object->texture_frame];
    const SceneShape *shape = &scene->shapes[object->shape];
    const SceneTextureFrame *other = &f->other->texture_frames[then->texture_frame];
    if (shape->mesh && !shape->mesh->uvs && scene->surfaces[object->surface].textures_use_uv &&
        memcmp(&frame->box, &other->box, sizeof frame->box) != 0)
        motion_report(f, &object->span, "the box that stands for texture coordinates of ", object->name);
    if (frame->motion == SCENE_NONE) {
        if (nearly_same_map(&frame->from_shape, &other->from_shape)) return;
        /* others may share it, and move otherwise */
        scene->texture_frames = room_for_one(&scene->arena, scene->texture_frames, scene->n_texture_frames,
                                             &f->texture_frames_capacity, sizeof *scene->texture_frames);
        scene->texture_frames[scene->n_texture_frames] = scene->texture_frames[object->texture_frame];
        object->texture_frame = scene->n_texture_frames++;
        frame = &scene->texture_frames[object->texture_frame];
    }
    motion_of_map(f, &frame->motion, &frame->from_shape, &other->from_shape);
}

/* ---- in the end ---- */

/* The programs of all keys with their constants in the same registers; false where they are too different. */
static bool align_programs(Finder *f, Texture *keys)
{
    const Program **programs = ARENA_ARRAY(&f->scene->arena, const Program *, f->n_keys), *const * aligned;
    if (!keys[0].program) return true;
    for (uint32_t k = 0; k < f->n_keys; k++) programs[k] = keys[k].program;
    if (!program_align(programs, f->n_keys, &f->scene->arena, &aligned)) return false;
    for (uint32_t k = 0; k < f->n_keys; k++) keys[k].program = aligned[k];
    return true;
}

bool motion_finish_textures(Finder *f)
{
    bool any = false;
    for (uint32_t row = 0; row < f->scene->n_textures; row++) {
        Texture *keys = f->scene->textures[row].keys;
        bool placed = false;
        if (!keys) continue;
        if (!align_programs(f, keys)) {
            report_texture(f, row, f->texture_users[row]);
            continue;
        }
        for (uint32_t k = 0; k < f->n_keys; k++) placed = placed || keys[k].placed;
        for (uint32_t k = 0; k < f->n_keys; k++) keys[k].placed = placed;
        any = true;
    }
    return any;
}
