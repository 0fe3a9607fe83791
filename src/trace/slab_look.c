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
        *way = (SlabWay){.outside = slab_is_as_outside(path, event->crossing.medium_from),
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

/* To what rounding makes of directions at a dozen faces, some of them met at grazing angles. */
static bool is_same_direction(Vec3f a, Vec3f b)
{
    const float apart = 1e-4f;
    Vec3f between = vec3f_sub(a, b);
    return vec3f_dot(between, between) < apart * apart;
}

bool slab_keeps_direction(const Path *path, Vec3 from, Vec3f direction)
{
    return path->slab_way.outside && is_same_direction(path->ray.direction, path->slab_way.direction) &&
           slabs_are_on_way(&path->tracer->world->slabs, from, direction, HUGE_VAL);
}

void slab_leave_scene(Path *path)
{
    const SlabWay *way = &path->slab_way;
    if (!slab_keeps_direction(path, path->scatter_point, way->direction)) return;
    path->ray.direction = way->direction;
    path->scatter_pdf = way->scatter_pdf;
    path->from.rarity = way->rarity;
    path->probing.bent = way->bent;
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

bool slab_look_at_face(Path *look, const Event *event, SlabFace *face)
{
    face->place = path_place(look, event);
    face->number = slab_face_at(look->tracer->world, &event->hit, &face->place);
    if (!face->number) return false;
    face->passes = fresnel_refract(look->ray.direction, face->place.normal, path_ior(look, event->crossing.medium_from),
                                   path_ior(look, event->crossing.medium_to), &face->reflectance, &face->refracted);
    return true;
}

bool slab_cross_pane(Path *look, Event *event)
{
    Tracer *tracer = look->tracer;
    if (!scene_is_pane(tracer->world->scene, event->hit.object)) return false;
    SurfacePlace place = path_place(look, event);
    look->beta = lanes_mul(look->beta, path_pass_panes(look, &look->ray, tracer->hits.items, event->n_cluster,
                                                       nest_medium(&tracer->list)));
    if (!path_cross_into_next(tracer, event)) return false;
    path_leave(look, event, &place, true, look->ray.direction);
    return true;
}

/* A look, and those that it parts into. */
typedef struct Look {
    Path path;
    Vec3f wanted; /* in which they are to leave the scene */
    uint32_t n_faces, n_mirrored;
} Look;

static Lanes follow(Look *look);

/* What comes by being mirrored at a face: as often as it reflects, by a look of its own. */
static Lanes follow_mirrored(const Look *look, const Event *event, const SlabFace *face)
{
    const Path *path = &look->path;
    float chosen = lanes_mean(face->reflectance);
    if (look->n_mirrored == SLAB_MIRRORED ||
        sampler_1d(&path->sampler, sampler_dimension(path->bounce, DIM_LOBE)) >= chosen)
        return lanes_all(0);
    Tracer *tracer = path->tracer, *looker = tracer_lend(tracer);
    Look mirrored = *look;
    Event there = *event;
    if (!looker) return lanes_all(0);
    if (nest_list_copy(&looker->list, &tracer->list) != STATUS_OK ||
        !hit_list_copy(&looker->hits, tracer->hits.items, event->n_cluster)) {
        tracer->out_of_memory = true;
        return lanes_all(0);
    }
    mirrored.n_mirrored++;
    mirrored.path.tracer = looker;
    mirrored.path.beta = lanes_mul(path->beta, lanes_scale(face->reflectance, 1 / chosen));
    mirrored.path.bounce++;
    path_leave(&mirrored.path, &there, &face->place, false, reflect_direction(path->ray.direction, face->place.normal));
    Lanes arrives = follow(&mirrored);
    tracer_take_back(tracer);
    return arrives;
}

/* What arrives of light from infinity, by this look and all that it parts into. */
static Lanes follow(Look *look)
{
    Path *path = &look->path;
    Lanes arrives = lanes_all(0);
    for (; !lanes_zero(path->beta); path->bounce++) {
        Event event;
        SlabFace face;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST) path->tracer->out_of_memory = true;
        if (event.kind == EVENT_ESCAPE)
            return is_same_direction(path->ray.direction, look->wanted) ? lanes_add(arrives, path->beta) : arrives;
        if (event.kind == EVENT_SCATTER || path->n_counted++ >= path->tracer->world->max_bounces) break;
        if (event.kind == EVENT_OPAQUE) {
            if (!slab_cross_pane(path, &event)) break;
            continue;
        }
        if (event.kind != EVENT_BOUNDARY || ++look->n_faces > SLAB_FACES || !slab_look_at_face(path, &event, &face))
            break;
        arrives = lanes_add(arrives, follow_mirrored(look, &event, &face));
        if (!face.passes) break;
        path->beta = lanes_mul(path->beta, lanes_rest(face.reflectance));
        path_leave(path, &event, &face.place, true, face.refracted);
    }
    return arrives;
}

bool slab_shadow(Path *path, const Ray *ray, Lanes *transmittance)
{
    Tracer *tracer = path->tracer;
    if (!slabs_are_on_way(&tracer->world->slabs, ray->origin, ray->direction, HUGE_VAL)) return false;
    Tracer *looker = tracer_lend(tracer);
    if (!looker) return false;
    if (!path_cross_towards(tracer, ray, &looker->list)) {
        tracer->out_of_memory = true;
        return false;
    }
    if (!slab_is_as_outside(path, nest_medium(&looker->list))) return false;
    Look look = {.wanted = ray->direction};
    slab_begin_look(path, looker, -1, &look.path); /* each wavelength has its own, whichever the path takes for all */
    look.path.ray = *ray;
    look.path.ray.t_max = HUGE_VAL;
    *transmittance = follow(&look);
    tracer_take_back(tracer);
    return !lanes_zero(*transmittance);
}
