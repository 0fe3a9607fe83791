/* slab_look.c - see slab_look.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_look.h"

#include "optics/fresnel.h"
#include "trace/shade_bsdf.h"

/* A look's flights have numbers beyond those of all paths and probes. */
enum { FIRST_BOUNCE = 1 << 25 };

void slab_go_through(Path *path, float rarity)
{
    SlabWay *way = &path->slab_way;
    if (way->bounce != path->bounce) {
        way->direction = path->ray.direction;
        way->scatter_pdf = path->scatter_pdf;
        way->rarity = rarity;
        way->bent = path->probing.bent;
        way->n_faces = 0;
    }
    way->bounce = ++way->n_faces <= SLAB_FACES ? path->bounce + 1 : SLAB_NOWHERE;
}

/* To what rounding makes of directions at a dozen faces, some of them met at grazing angles. */
static bool is_same_direction(Vec3f a, Vec3f b)
{
    const float apart = 1e-4f;
    Vec3f between = vec3f_sub(a, b);
    return vec3f_dot(between, between) < apart * apart;
}

bool slab_keeps_direction(const Path *path)
{
    return is_same_direction(path->ray.direction, path->slab_way.direction);
}

void slab_leave_scene(Path *path)
{
    const SlabWay *way = &path->slab_way;
    if (!slab_keeps_direction(path)) return;
    path->ray.direction = way->direction;
    path->scatter_pdf = way->scatter_pdf;
    path->from.rarity = way->rarity;
    path->probing.bent = way->bent;
}

/* The reflectance of a face for each wavelength by its own index, whichever the path takes. */
static Lanes reflectance_of(const Path *look, const Event *event, const SurfacePlace *place)
{
    const World *world = look->tracer->world;
    const Lanes nm = look->wavelengths.nm;
    return fresnel_dielectric_lanes(-vec3f_dot(look->ray.direction, place->normal),
                                    medium_ior(world, event->crossing.medium_from, nm),
                                    medium_ior(world, event->crossing.medium_to, nm));
}

static bool cross_face(Path *look, Event *event)
{
    SurfacePlace place = path_place(look, event);
    Lanes reflectance;
    Vec3f direction;
    if (!slab_is_face(look->tracer->world, event, &place) ||
        !fresnel_refract(look->ray.direction, place.normal, path_ior(look, event->crossing.medium_from),
                         path_ior(look, event->crossing.medium_to), &reflectance, &direction))
        return false;
    look->beta = lanes_mul(look->beta, lanes_rest(reflectance_of(look, event, &place)));
    path_leave(look, event, &place, true, direction);
    return true;
}

static bool cross_pane(Path *look, Event *event)
{
    Tracer *tracer = look->tracer;
    if (!scene_is_pane(tracer->world->scene, event->hit.object)) return false;
    SurfacePlace place = path_place(look, event);
    look->beta = lanes_mul(look->beta, path_pass_panes(look, &look->ray, tracer->hits.items, event->n_cluster,
                                                       nest_medium(&tracer->list)));
    if (!path_cross_into_next(tracer, event)) {
        tracer->out_of_memory = true;
        return false;
    }
    path_leave(look, event, &place, true, look->ray.direction);
    return true;
}

/* Follows it to where it leaves the scene; false: it does not. */
static bool follow(Path *look)
{
    for (uint32_t faces = 0;; look->bounce++) {
        Event event;
        path_next_event(look, &event);
        if (event.kind == EVENT_LOST) look->tracer->out_of_memory = true;
        if (event.kind == EVENT_ESCAPE) return true;
        if (event.kind != EVENT_BOUNDARY && event.kind != EVENT_OPAQUE) return false;
        bool face = event.kind == EVENT_BOUNDARY;
        faces += face;
        if (faces > SLAB_FACES || !(face ? cross_face(look, &event) : cross_pane(look, &event)) ||
            lanes_zero(look->beta))
            return false;
    }
}

bool slab_shadow(Path *path, const Ray *ray, Lanes *transmittance)
{
    Tracer *tracer = path->tracer;
    if (!slabs_are_on_way(&tracer->world->slabs, ray->origin, ray->direction)) return false;
    Tracer *looker = tracer_for_looks(tracer);
    if (!looker || !path_cross_towards(tracer, ray, &looker->list)) {
        tracer->out_of_memory = true;
        return false;
    }
    Path look = *path;
    look.tracer = looker;
    look.ray = *ray;
    look.ray.t_max = HUGE_VAL;
    look.straight = true;
    look.looks = false;
    look.fork = NULL;
    look.bounce += FIRST_BOUNCE;
    look.beta = look.ratio = lanes_all(1);
    looker->counters = tracer->counters;
    bool leaves = follow(&look) && is_same_direction(look.ray.direction, ray->direction);
    tracer->counters = looker->counters;
    tracer->out_of_memory |= looker->out_of_memory;
    *transmittance = look.beta;
    return leaves;
}
