/* slab_look.c - see slab_look.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_look.h"

#include "optics/fresnel.h"
#include "trace/shade_bsdf.h"

/* A look's flights have numbers beyond those of all paths and probes. */
enum { FIRST_BOUNCE = 1 << 25 };

bool slab_is_as_outside(const Path *path, uint32_t medium)
{
    const World *world = path->tracer->world;
    const Lanes nm = path->wavelengths.nm;
    return medium == WORLD_MEDIUM || lanes_equal(medium_ior(world, medium, nm), medium_ior(world, WORLD_MEDIUM, nm));
}

void slab_meet_face(Path *path, const Event *event, uint64_t face, bool mirrored, float rarity)
{
    const float parallel = 1 - 1e-6f;
    SlabWay *way = &path->slab_way;
    if (!path_is_in_slabs(path)) {
        *way = (SlabWay){.medium = event->medium,
                         .outside = slab_is_as_outside(path, event->medium),
                         .to_and_fro = true,
                         .first_face = ray_point(&path->ray, event->hit.t),
                         .direction = path->ray.direction,
                         .scatter_pdf = path->scatter_pdf,
                         .rarity = rarity,
                         .bent = path->probing.bent};
    }
    way->n_faces++;
    way->steps = slab_step(way->steps, face, mirrored);
    if (mirrored && !way->n_mirrored++) way->mirror = event->hit.normal;
    if (mirrored) way->to_and_fro &= fabsf(vec3f_dot(way->mirror, event->hit.normal)) > parallel;
    bool goes_on = way->n_faces <= SLAB_FACES && way->n_mirrored <= SLAB_MIRRORED;
    way->bounce = goes_on ? path->bounce + 1 : SLAB_NOWHERE;
}

/* ---- looks ---- */

void slab_begin_look(const Path *path, Tracer *looker, int index_lane, Path *look)
{
    *look = *path;
    look->tracer = looker;
    look->straight = look->for_light = true;
    look->looks = false;
    look->index_lane = index_lane;
    memset(look->media.ior_of, 0, sizeof look->media.ior_of);
    look->fork = NULL;
    look->bounce += FIRST_BOUNCE;
    look->beta = look->ratio = lanes_all(1);
}

bool slab_start_ray(Path *path, const LookPlace *from, Vec3f direction, Ray *ray)
{
    Tracer *tracer = path->tracer;
    if (from->event) {
        bool through = vec3f_dot(direction, from->place->geometric) < 0;
        path_start_ray(path, from->event, from->place, through, direction, ray);
    } else {
        ray_begin(ray, from->place->position, direction);
        ray->time = path->ray.time;
    }
    bool known = path_cross_towards(tracer, ray, &tracer->looker->list);
    tracer->out_of_memory |= !known;
    return known;
}

bool slab_start_look(Path *path, const LookPlace *from, int index_lane, Vec3f direction, Path *look)
{
    Ray ray;
    bool started = slab_start_ray(path, from, direction, &ray);
    slab_begin_look(path, path->tracer->looker, index_lane, look);
    look->ray = ray;
    return started;
}

bool slab_look_at_face(Path *look, const Event *event, SlabFace *face)
{
    face->place = path_place(look, event);
    face->number = slab_face_at(look->tracer->world, &event->hit, &face->place);
    const NestCrossing *crossing = &event->crossing;
    if (!face->number || world_refracts_doubly(look->tracer->world, crossing->medium_from, crossing->medium_to))
        return false;
    face->passes = fresnel_refract(look->ray.direction, face->place.normal, path_ior(look, crossing->medium_from),
                                   path_ior(look, crossing->medium_to), &face->reflectance, &face->refracted);
    return true;
}

bool slab_cross_pane(Path *look, Event *event)
{
    Tracer *tracer = look->tracer;
    if (!path_is_pane(tracer->world, event->hit.object, event->n_cluster)) return false;
    SurfacePlace place = path_place(look, event);
    look->beta = lanes_mul(look->beta, path_pass_panes(look, &look->ray, tracer->hits.items, event->n_cluster,
                                                       nest_medium(&tracer->list)));
    if (path_passes_into_boundary(look, event) || !path_cross_into_next(tracer, event)) return false;
    path_leave(look, event, &place, true, look->ray.direction);
    return true;
}
