/* emitter_place.c - see emitter_place.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/emitter_place.h"

static const Piece *piece_of(const Scene *scene, const Emitter *emitter)
{
    return &scene->shapes[scene->objects[emitter->of].shape].solid->pieces[emitter->part];
}

static Affine to_world_at(const Scene *scene, const Emitter *emitter, double time)
{
    const SceneObject *object = &scene->objects[emitter->of];
    const Affine *keys = scene_keys(scene, object);
    return keys ? affine_between(keys, scene->n_keys, time) : object->to_world;
}

static Vec3 place_on_triangle(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2],
                              Hit *hit)
{
    Vec3 corner[3];
    rtc_triangle(compiled->rtc, emitter->of, emitter->part, time, corner);
    Vec3 a = vec3_sub(corner[1], corner[0]), b = vec3_sub(corner[2], corner[0]);
    double root = sqrt(u[0]);
    if (hit) {
        Vec3 across = vec3_cross(a, b);
        hit->u = (float)(root * (1 - u[1]));
        hit->v = (float)(root * u[1]);
        hit->normal = vec3f_from(vec3_scale(across, 1 / fmax(vec3_length(across), 1e-300)));
    }
    return vec3_along(vec3_along(corner[0], root * (1 - u[1]), a), root * u[1], b);
}

Vec3 emitter_place(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2], Hit *hit)
{
    if (hit) {
        hit->object = emitter->of;
        hit->primitive = emitter->part;
    }
    if (emitter->kind == EMITTER_TRIANGLE) return place_on_triangle(compiled, emitter, time, u, hit);
    Affine to_world = to_world_at(compiled->scene, emitter, time);
    Vec3 normal, local = piece_sample(piece_of(compiled->scene, emitter), u[0], u[1], &normal);
    if (hit) {
        Vec3 across = affine_area(&to_world, normal);
        double sign = affine_determinant(&to_world) < 0 ? -1 : 1;
        hit->u = hit->v = 0;
        hit->normal = vec3f_from(vec3_scale(across, sign / vec3_length(across)));
    }
    return affine_point(&to_world, local);
}

double emitter_place_in_turn(const Scene *scene, uint32_t i, double u[2])
{
    /* 1 / 1.2207..., its powers */
    const double steps[3] = {0.81917251339616444, 0.67104360670378923, 0.54970047790197031};
    double at[3];
    for (int k = 0; k < 3; k++) {
        double x = 0.5 + steps[k] * i;
        at[k] = x - floor(x);
    }
    u[0] = at[0], u[1] = at[1];
    return scene->n_keys ? at[2] : 0;
}

void emitter_place_of_hit(const CompiledScene *compiled, const Emitter *emitter, const Ray *ray, const Hit *hit,
                          double u[2])
{
    if (emitter->kind == EMITTER_TRIANGLE) {
        double root = (double)hit->u + (double)hit->v;
        u[0] = root * root;
        u[1] = root > 0 ? (double)hit->v / root : 0;
        return;
    }
    RtcCoordinates at;
    rtc_coordinates(compiled->rtc, ray, hit, false, &at);
    piece_find(piece_of(compiled->scene, emitter), at.local, u);
}
