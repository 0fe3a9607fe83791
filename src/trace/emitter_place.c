/* emitter_place.c - see emitter_place.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/emitter_place.h"

Vec3 emitter_place_on_triangle(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2],
                               Vec3 *across)
{
    Vec3 corner[3];
    rtc_triangle(compiled->rtc, emitter->of, emitter->part, time, corner);
    Vec3 a = vec3_sub(corner[1], corner[0]), b = vec3_sub(corner[2], corner[0]);
    double root = sqrt(u[0]);
    *across = vec3_cross(a, b);
    return vec3_along(vec3_along(corner[0], root * (1 - u[1]), a), root * u[1], b);
}

/* across may be NULL. */
static Vec3 place_on_piece(const Scene *scene, const Emitter *emitter, double time, const double u[2], Vec3 *across)
{
    Affine room;
    const Affine *to_world = scene_object_place(scene, &scene->objects[emitter->of], time, &room);
    Vec3 normal, local = piece_sample(emitter_piece(scene, emitter), u[0], u[1], &normal);
    if (across) *across = vec3_scale(affine_area(to_world, normal), affine_determinant(to_world) < 0 ? -1 : 1);
    return affine_point(to_world, local);
}

Vec3 emitter_place(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2], Hit *hit)
{
    bool triangle = emitter->kind == EMITTER_TRIANGLE;
    Vec3 across = {0}, place = triangle ? emitter_place_on_triangle(compiled, emitter, time, u, &across)
                                        : place_on_piece(compiled->scene, emitter, time, u, hit ? &across : NULL);
    if (hit) {
        double root = triangle ? sqrt(u[0]) : 0;
        hit->object = emitter->of;
        hit->primitive = emitter->part;
        hit->u = (float)(root * (1 - u[1]));
        hit->v = (float)(root * u[1]);
        hit->normal = vec3f_from(vec3_scale(across, 1 / fmax(vec3_length(across), 1e-300)));
    }
    return place;
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
    piece_find(emitter_piece(compiled->scene, emitter), at.local, u);
}
