/* slab_look.c - see slab_look.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/slab_look.h"

#include "optics/fresnel.h"
#include "trace/shade_bsdf.h"

/* A look's flights have numbers beyond those of all paths and probes. */
enum { FIRST_BOUNCE = 1 << 25 };

/* Whether the index of a medium is that of what is outside; elsewhere what leaves in the direction of its start is a light's one
 * direction of all, and would count by what it fills of the sky there. */
static bool is_as_outside(const Path *path, uint32_t medium)
{
    const World *world = path->tracer->world;
    const Lanes nm = path->wavelengths.nm;
    return medium == WORLD_MEDIUM || lanes_equal(medium_ior(world, medium, nm), medium_ior(world, WORLD_MEDIUM, nm));
}

void slab_meet_face(Path *path, const Event *event, bool mirrored, float rarity)
{
    SlabWay *way = &path->slab_way;
    if (!path_is_in_slabs(path)) {
        if (!is_as_outside(path, event->crossing.medium_from)) return;
        way->direction = path->ray.direction;
        way->scatter_pdf = path->scatter_pdf;
        way->rarity = rarity;
        way->bent = path->probing.bent;
        way->n_faces = way->n_mirrored = 0;
    }
    way->n_faces++;
    way->n_mirrored += mirrored;
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

/* ---- looks ---- */

/* Where a look meets a face. */
typedef struct Face {
    SurfacePlace place;
    Lanes reflectance;
    Vec3f refracted;
    bool passes;
} Face;

static bool meet_face(Path *look, const Event *event, Face *face)
{
    face->place = path_place(look, event);
    if (!slab_is_face(look->tracer->world, event, &face->place)) return false;
    face->passes = fresnel_refract(look->ray.direction, face->place.normal, path_ior(look, event->crossing.medium_from),
                                   path_ior(look, event->crossing.medium_to), &face->reflectance, &face->refracted);
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
static Lanes follow_mirrored(const Look *look, const Event *event, const Face *face)
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

/* A thin pane, or a hole in a sheet; false: it is none. */
static bool cross_pane(Path *look, Event *event)
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

/* What arrives of light from infinity, by this look and all that it parts into. */
static Lanes follow(Look *look)
{
    Path *path = &look->path;
    Lanes arrives = lanes_all(0);
    for (; !lanes_zero(path->beta); path->bounce++) {
        Event event;
        Face face;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST) path->tracer->out_of_memory = true;
        if (event.kind == EVENT_ESCAPE)
            return is_same_direction(path->ray.direction, look->wanted) ? lanes_add(arrives, path->beta) : arrives;
        if (event.kind == EVENT_SCATTER || path->n_counted++ >= path->tracer->world->max_bounces) break;
        if (event.kind == EVENT_OPAQUE) {
            if (!cross_pane(path, &event)) break;
            continue;
        }
        if (event.kind != EVENT_BOUNDARY || ++look->n_faces > SLAB_FACES || !meet_face(path, &event, &face)) break;
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
    if (!slabs_are_on_way(&tracer->world->slabs, ray->origin, ray->direction)) return false;
    Tracer *looker = tracer_lend(tracer);
    if (!looker) return false;
    if (!path_cross_towards(tracer, ray, &looker->list)) {
        tracer->out_of_memory = true;
        return false;
    }
    if (!is_as_outside(path, nest_medium(&looker->list))) return false;
    Look look = {.path = *path, .wanted = ray->direction};
    look.path.tracer = looker;
    look.path.ray = *ray;
    look.path.ray.t_max = HUGE_VAL;
    look.path.straight = look.path.for_light = true;
    look.path.looks = false;
    look.path.index_lane = -1; /* each wavelength has its own, whichever the path takes for all: see sample.c */
    memset(look.path.media.ior_of, 0, sizeof look.path.media.ior_of);
    look.path.fork = NULL;
    look.path.bounce += FIRST_BOUNCE;
    look.path.beta = look.path.ratio = lanes_all(1);
    *transmittance = follow(&look);
    tracer_take_back(tracer);
    return !lanes_zero(*transmittance);
}
