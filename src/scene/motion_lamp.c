/* motion_lamp.c - lamps that turn while the shutter is open.
 *
 * A lamp's frame is level, so that it goes round by half a turn when its axis passes the vertical, where any frame is level:
 * between two such keys it would be squeezed to nothing. So of the frames in which it looks the same the one is taken that is
 * next to the one before; and where it hangs straight, of all.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "scene/motion_parts.h"

static Vec3 column(const Affine *map, int i)
{
    return vec3(map->m[0][i], map->m[1][i], map->m[2][i]);
}

/* With the axes x and y, which are unit vectors at a right angle. */
static Affine frame_of(Vec3 x, Vec3 y, Vec3 place)
{
    Vec3 z = vec3_cross(x, y);
    return (Affine){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}, place};
}

/* Whether a lamp looks the same however it is turned about its axis. Of a profile only type C's horizontal angles go about that: with
 * one of another type's it is the same to the right and to the left, but not above. */
static bool is_round(const SceneLight *light)
{
    const LightProfile *profile = light->profile;
    if (profile) return profile->type == PROFILE_C && profile->n_horizontal == 1;
    return light->kind == LIGHT_DISC || light->kind == LIGHT_SPHERE || light->kind == LIGHT_POINT;
}

/* Whether it looks the same half a turn about its axis further. */
static bool is_even(const SceneLight *light)
{
    const LightProfile *profile = light->profile;
    if (!profile) return light->kind == LIGHT_RECT;
    if (profile->type == PROFILE_C) return profile->horizontal[profile->n_horizontal - 1] <= 90;
    return profile->horizontal[0] >= 0 && profile->vertical[0] >= 0;
}

/* The x axis of a frame when its y axis has been turned to another direction, and the frame no more than that; of length 0
 * where that is the opposite one. */
static Vec3 turned_along(const Affine *frame, Vec3 y)
{
    Vec3 x = column(frame, 0), old = column(frame, 1), axis = vec3_cross(old, y);
    double opposite = 1 + vec3_dot(old, y);
    if (!(opposite > 1e-9)) return vec3(0, 0, 0);
    Vec3 once = vec3_cross(axis, x), twice = vec3_cross(axis, once);
    x = vec3_along(vec3_add(x, once), 1 / opposite, twice);
    return vec3_normalize(vec3_along(x, -vec3_dot(x, y), y)); /* of rounding */
}

static Affine least_turned(Finder *f, uint32_t number, bool hangs, const Affine *before, const Affine *then)
{
    const double hardly = 0.9;
    const SceneLight *light = &f->scene->lights[number];
    bool hung = f->hung[number] & HUNG_BEFORE;
    Vec3 x = column(then, 0), y = column(then, 1), same = turned_along(before, y);
    double kept = vec3_dot(same, x);
    if (vec3_length(same) < 0.5 || kept > hardly) return *then;
    if (is_round(light) || (hangs && !hung)) return frame_of(same, y, then->t);
    if (is_even(light) && kept < 0) return frame_of(vec3_scale(x, -1), y, then->t);
    if (light->kind == LIGHT_POINT && kept < -hardly) { /* a profile goes round all at once */
        motion_report(f, &light->span, "the turn about its own axis of ", light->name);
        return frame_of(vec3_scale(x, -1), y, then->t);
    }
    return *then;
}

/* A lamp that hung straight so far, and begins to turn: it has hung as it turns. */
static void turn_those_before(Finder *f, Affine *keys)
{
    const Affine *then = &keys[f->key];
    Affine last = keys[f->key - 1];
    Vec3 x = turned_along(then, column(&last, 1));
    double cosine = vec3_dot(x, column(&last, 0)), sine = vec3_dot(x, column(&last, 2));
    if (vec3_length(x) < 0.5) return;
    for (uint32_t k = 0; k < f->key; k++) {
        Vec3 own = vec3_along(vec3_scale(column(&keys[k], 0), cosine), sine, column(&keys[k], 2));
        keys[k] = frame_of(own, column(&keys[k], 1), keys[k].t);
    }
}

void motion_of_lamp(Finder *f, uint32_t number, uint32_t then, uint32_t *motion, const Affine *first)
{
    const SceneLight *other = &f->other->lights[then];
    const Affine *to_world =
        other->object == SCENE_NONE ? &other->to_world : &f->other->objects[other->object].to_world;
    const Affine *before = *motion == SCENE_NONE ? first : &f->scene->motions[(size_t)*motion * f->n_keys + f->key - 1];
    bool begins = (f->hung[number] & HUNG_SO_FAR) && !other->hangs;
    Affine to = begins ? *to_world : least_turned(f, number, other->hangs, before, to_world);
    motion_of_map(f, motion, first, &to);
    if (begins && *motion != SCENE_NONE) turn_those_before(f, f->scene->motions + (size_t)*motion * f->n_keys);
    f->hung[number] = !other->hangs ? 0 : f->hung[number] & HUNG_SO_FAR ? HUNG_BEFORE | HUNG_SO_FAR : HUNG_BEFORE;
}

void motion_of_points(Finder *f)
{
    const Scene *other = f->other;
    for (uint32_t i = 0; i < f->scene->n_lights; i++) { /* there are few */
        SceneLight *light = &f->scene->lights[i];
        if (light->kind != LIGHT_POINT) continue;
        for (uint32_t k = 0; k < other->n_lights; k++) {
            /* mostly at the same number */
            uint32_t then = (i + k) % other->n_lights;
            if (other->lights[then].kind != LIGHT_POINT || other->lights[then].identity != light->identity) continue;
            motion_of_lamp(f, i, then, &light->motion, &light->to_world);
            break;
        }
    }
}
