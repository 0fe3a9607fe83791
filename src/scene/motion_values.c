/* motion_values.c - what changes while the shutter is open without being a place: where it can be blurred, as the places of
 * volumes can, it is a motion, and else it is told.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "scene/motion_parts.h"

/* ---- media ---- */

static void move_volume(Finder *f, const SceneMedium *medium, const char *what, uint32_t row, uint32_t row_then)
{
    if (row == SCENE_NONE && row_then == SCENE_NONE) return;
    SceneVolumePlace *place = row == SCENE_NONE ? NULL : &f->scene->volume_places[row];
    const SceneVolumePlace *then = row_then == SCENE_NONE ? NULL : &f->other->volume_places[row_then];
    if (!place || !then || place->content != then->content) motion_report(f, &medium->span, what, medium->name);
    if (place && then) motion_of_map(f, &place->motion, &place->to_frame, &then->to_frame);
}

/* Whichever way a crystal lies: while the shutter is open its axis is as at the beginning. */
static uint64_t still_hash(SceneMedium medium)
{
    medium.optic_axis = vec3(0, 1, 0);
    return scene_medium_hash(&medium);
}

static void compare_media(Finder *f, uint32_t row, uint32_t row_then)
{
    SceneMedium a = f->scene->media[row], b = f->other->media[row_then];
    move_volume(f, &a, "the density of ", scene_volume_row(f->scene, a.density), scene_volume_row(f->other, b.density));
    move_volume(f, &a, "the temperature of ", scene_volume_row(f->scene, a.temperature),
                scene_volume_row(f->other, b.temperature));
    a.density = b.density = a.temperature = b.temperature = NULL; /* theirs is compared */
    if (still_hash(a) != still_hash(b) || a.reference_k != b.reference_k || a.priority != b.priority)
        motion_report(f, &a.span, "medium ", a.name);
}

static void match_media(Finder *f, const SceneObject *object, uint32_t row, uint32_t row_then)
{
    uint32_t known = f->medium_then[row];
    if (known == row_then) return;
    if (known != SCENE_NONE) { /* of all that it fills it becomes another one here */
        if (still_hash(f->other->media[known]) != still_hash(f->other->media[row_then]))
            motion_report(f, &object->span, "the medium of ", object->name);
        return;
    }
    f->medium_then[row] = row_then;
    compare_media(f, row, row_then);
}

/* The frame of an object; NULL: it has none. */
static SceneFrame *find_frame(Scene *scene, uint32_t object)
{
    uint32_t low = 0, high = scene->n_frames;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (scene->frames[middle].object < object)
            low = middle + 1;
        else
            high = middle;
    }
    return low < scene->n_frames && scene->frames[low].object == object ? &scene->frames[low] : NULL;
}

void motion_of_matter(Finder *f, uint32_t object, uint32_t then)
{
    const SceneObject *a = &f->scene->objects[object], *b = &f->other->objects[then];
    if ((a->medium == SCENE_NONE) != (b->medium == SCENE_NONE) ||
        (a->surface == SCENE_NONE) != (b->surface == SCENE_NONE)) {
        motion_report(f, &a->span, "what is the matter of ", a->name);
        return;
    }
    if (a->surface != SCENE_NONE) motion_of_surface(f, a, a->surface, b->surface);
    if (a->medium == SCENE_NONE) return;
    match_media(f, a, a->medium, b->medium);
    if (a->priority != b->priority) motion_report(f, &a->span, "the priority of ", a->name);
    SceneFrame *frame = find_frame(f->scene, object);
    const SceneFrame *frame_then = find_frame(f->other, then);
    if (frame && frame_then) motion_of_map(f, &frame->motion, &frame->to_world, &frame_then->to_world);
}

/* ---- lights, the environment ---- */

static void compare_lights(Finder *f)
{
    for (uint32_t i = 0; i < f->scene->n_lights; i++) {
        const SceneLight *light = &f->scene->lights[i];
        for (uint32_t k = 0; k < f->other->n_lights; k++) {
            /* mostly at the same number */
            const SceneLight *then = &f->other->lights[(i + k) % f->other->n_lights];
            if (then->identity != light->identity) continue;
            if (then->kind != light->kind || scene_light_hash(light) != scene_light_hash(then))
                motion_report(f, &light->span, "what shines of ", light->name ? light->name : "this light");
            break;
        }
    }
}

void motion_of_values(Finder *f)
{
    match_media(f, NULL, 0, 0);
    compare_lights(f);
    if (f->scene->part_hashes[SCENE_PART_ENVIRONMENT] != f->other->part_hashes[SCENE_PART_ENVIRONMENT])
        motion_report(f, NULL, "the environment", "");
}
