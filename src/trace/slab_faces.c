/* slab_faces.c - see slab_faces.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_faces.h"

#include "optics/fresnel.h"

/* ---- the faces ---- */

/* Puts a boundary that the ray comes to among the faces of a way; false: it is none. */
static bool add_face(Path *look, const Ray *ray, const Hit *hit, Lanes eta_i, Lanes eta_t, FaceWay *way)
{
    const World *world = look->tracer->world;
    SurfacePlace place = path_place_of(world, ray, hit);
    uint64_t number = slab_face_at(world, hit, &place);
    if (!number || way->n == SLAB_FACES) return false;
    Vec3 normal = vec3_normalize(vec3_from_f(place.geometric));
    way->faces[way->n] = (FlatFace){.normal = normal,
                                    .offset = vec3_dot(normal, place.position),
                                    .eta = (double)lanes_get(eta_i, 0) / (double)lanes_get(eta_t, 0)};
    way->numbers[way->n++] = number;
    way->disperses |= !lanes_uniform(eta_i) || !lanes_uniform(eta_t);
    return true;
}

/* All surfaces at one place; false: no look goes through them. */
static bool cross_straight(Path *look, const Ray *ray, const Hit *hits, size_t n, FaceWay *way)
{
    Tracer *tracer = look->tracer;
    const World *world = tracer->world;
    NestCrossing crossing;
    const uint32_t level = tracer->list.point.top.level;
    if (n > 1 && nest_list_copy(&tracer->next, &tracer->list) != STATUS_OK) tracer->out_of_memory = true;
    if (!path_cross(tracer, &tracer->list, hits, n, &crossing)) tracer->out_of_memory = true;
    way->blocked |= crossing.opaque;
    if (tracer->out_of_memory || crossing.n_faults || crossing.opaque) return false;
    if (UNLIKELY(world->has_paint) && path_painted_hit(world, hits, n, level, tracer->list.point.top.level))
        return false;
    if (crossing.medium_from == crossing.medium_to) return true; /* panes are crossed likewise */
    if (UNLIKELY(world_refracts_doubly(world, crossing.medium_from, crossing.medium_to))) return false;
    Lanes eta_i = path_ior(look, crossing.medium_from), eta_t = path_ior(look, crossing.medium_to);
    if (lanes_equal(eta_i, eta_t)) return true;
    return add_face(look, ray, path_boundary_hit(tracer, &tracer->next, hits, n, &crossing), eta_i, eta_t, way);
}

static bool has_slab(const World *world, const Hit *hits, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (world->slabs.of_object[hits[i].object] != SCENE_NONE) return true;
    return false;
}

bool slab_find_faces(Path *look, bool past, FaceWay *way)
{
    Tracer *tracer = look->tracer;
    const HitList *all = &tracer->shadow_hits;
    way->n = 0;
    way->leaving = vec3(0, 0, 0);
    way->disperses = false;
    way->past = past;
    tracer->counters.rays++;
    way->blocked = !rtc_all(tracer->world->compiled->rtc, &look->ray, !past, &tracer->shadow_hits);
    for (size_t i = 0, n; i < all->n && !way->blocked; i += n) {
        n = rtc_cluster(all->items + i, all->n - i);
        if (past && !has_slab(tracer->world, all->items + i, n)) continue;
        if (!cross_straight(look, &look->ray, all->items + i, n, way)) return false;
    }
    return !way->blocked;
}

uint64_t slab_steps_of(const FaceWay *way)
{
    uint64_t steps = 0;
    for (uint32_t i = 0; i < way->n; i++) steps = slab_step(steps, way->numbers[i], way->faces[i].mirrored);
    return steps;
}

Vec3 slab_right_beside(Vec3 from, Vec3 towards)
{
    const double part = 0.01;
    return vec3_along(from, part, vec3_sub(towards, from));
}

/* ---- looks ---- */

bool slab_start_beside(const Path *path, Tracer *looker, Vec3 beside, Vec3f direction, Path *look)
{
    slab_begin_look(path, looker, path->index_lane, look);
    ray_begin(&look->ray, vec3_rounded(beside), direction);
    look->ray.time = path->ray.time;
    bool known = compiled_interior(looker->world->compiled, vec3f_from(look->ray.origin), look->ray.time,
                                   &looker->shadow_hits, &looker->list, NULL) == STATUS_OK;
    looker->out_of_memory |= !known;
    return known;
}

bool slab_look_goes_on(Path *look, Event *event)
{
    path_next_event(look, event);
    if (event->kind == EVENT_LOST) look->tracer->out_of_memory = true;
    return event->kind == EVENT_OPAQUE || event->kind == EVENT_BOUNDARY;
}

bool slab_follow_faces(Path *look, const FaceWay *way)
{
    const uint32_t most = look->tracer->world->max_bounces;
    for (uint32_t i = 0; i < way->n; look->bounce++) {
        Event event;
        SlabFace face;
        if (!slab_look_goes_on(look, &event) || look->n_counted++ >= most) return false;
        if (event.kind == EVENT_OPAQUE) {
            if (!slab_cross_pane(look, &event)) return false;
            continue;
        }
        if (!slab_look_at_face(look, &event, &face) || face.number != way->numbers[i]) return false;
        bool mirrored = way->faces[i++].mirrored;
        if (!mirrored && !face.passes) return false;
        look->beta = lanes_mul(look->beta, mirrored ? face.reflectance : lanes_rest(face.reflectance));
        path_leave(look, &event, &face.place, !mirrored,
                   mirrored ? reflect_direction(look->ray.direction, face.place.normal) : face.refracted);
    }
    return !lanes_zero(look->beta);
}
