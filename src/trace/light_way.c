/* light_way.c - where one ray of light goes.
 *
 * It is followed as a path is, by the same steps. Where it parts, the strongest part is followed first; the others later, from the start
 * again: what a way does up to where it parts, the one that it parts from has noted. So no list and no ray is kept.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_way.h"

#include <stdlib.h>

#include "base/array.h"
#include "optics/fresnel.h"
#include "optics/sampling.h"
#include "trace/crystal_cross.h"
#include "trace/shade_bsdf.h"
#include "trace/texture_shade.h"

typedef struct Follower {
    const Ray *ray;
    float nm, least;
    NestList start; /* around the ray's start */
    Tracer tracer;
    Path path;
    LightWays *ways;
} Follower;

/* One way on from a surface. */
typedef struct WayOn {
    bool passes;
    Vec3f direction;
    float part, angle; /* of the light that comes; to the normal */
    CrystalWave wave;
} WayOn;

/* What is met, and the ways on, the brightest first: back, and on, or up to two of either kind. */
typedef struct Meeting {
    LightStep step;
    Vec3f back, on;
    SurfacePlace place;
    WayOn ways[CRYSTAL_WAYS];
    uint32_t n_ways;
} Meeting;

const LightStep *light_ways_step(const LightWays *ways, uint32_t way, uint32_t k)
{
    while (k < ways->ways[way].depth) way = ways->ways[way].from;
    return &ways->steps[ways->ways[way].first + k - ways->ways[way].depth];
}

/* Of light that comes along -view about the normal (z), what a surface sends back and lets through: sums over as many of its
 * directions, evenly chosen. */
static void divide(const Bsdf *bsdf, float cosine, float *mirrored, float *transmitted)
{
    enum { SIDE = 64, ALL = SIDE * SIDE };
    const Vec3f view = vec3f(sqrtf(float_max(1 - cosine * cosine, 0)), 0, cosine);
    double sums[2] = {0, 0};
    for (uint32_t i = 0; i < ALL; i++) {
        const float u[2] = {((float)(i % SIDE) + 0.5f) / SIDE, ((float)reverse_bits(i) * 0x1p-32f)};
        BsdfSample sample;
        if (bsdf_sample(bsdf, view, ((float)i + 0.5f) / ALL, u, &sample))
            sums[sample.transmitted] += (double)lanes_get(sample.weight, 0);
    }
    *mirrored = (float)(sums[0] / ALL);
    *transmitted = (float)(sums[1] / ALL);
}

/* Of a direction that comes from the normal's side. */
static float angle_to(Vec3f direction, Vec3f normal)
{
    return (float)vec3_angle(vec3_from_f(vec3f_negate(direction)), vec3_from_f(normal));
}

/* Both ways on at a boundary about a normal; false: a direction is on the wrong side of the surface as it is. */
static bool turn_at_boundary(const Path *path, Lanes eta_i, Lanes eta_t, Vec3f normal, Meeting *met)
{
    LightStep *step = &met->step;
    Lanes reflectance;
    Vec3f direction = path->ray.direction;
    bool passes = fresnel_refract(direction, normal, eta_i, eta_t, &reflectance, &met->on);
    met->back = reflect_direction(direction, normal);
    step->angle = angle_to(direction, normal);
    step->on = passes ? angle_to(met->on, normal) : 0;
    step->mirrored = passes ? lanes_get(reflectance, 0) : 1;
    step->transmitted = 1 - step->mirrored;
    return vec3f_dot(met->back, met->place.geometric) > 0 && (!passes || vec3f_dot(met->on, met->place.geometric) < 0);
}

/* Of several as bright as each other the first one first. */
static void add_way_on(Meeting *met, WayOn way)
{
    uint32_t i = met->n_ways++;
    for (; i > 0 && met->ways[i - 1].part < way.part; i--) met->ways[i] = met->ways[i - 1];
    met->ways[i] = way;
}

/* Those of a surface that divides light in two. */
static void add_two_ways(const Path *path, const Event *event, Meeting *met)
{
    const LightStep *step = &met->step;
    if (step->transmitted > 0)
        add_way_on(met, (WayOn){.passes = true,
                                .direction = met->on,
                                .part = step->transmitted,
                                .angle = step->on,
                                .wave = event_keeps_medium(event) ? path->wave : CRYSTAL_UNPOLARIZED});
    if (step->mirrored > 0 || step->transmitted == 0)
        add_way_on(met, (WayOn){.direction = met->back, .part = step->mirrored});
}

/* A ray that begins within a crystal is an ordinary one. */
static void meet_crystal(Path *path, const Event *event, Meeting *met)
{
    LightStep *step = &met->step;
    CrystalWay ways[CRYSTAL_WAYS];
    bool bends_alike;
    if (path->wave == CRYSTAL_UNPOLARIZED) path->wave = CRYSTAL_ORDINARY;
    const uint32_t n = path_crystal_ways(path, event, &met->place, ways, &bends_alike);
    step->angle = angle_to(path->ray.direction, met->place.normal);
    for (uint32_t i = 0; i < n; i++) {
        const Vec3f direction = vec3f_from(ways[i].direction);
        *(ways[i].through ? &step->transmitted : &step->mirrored) += (float)ways[i].part;
        add_way_on(met, (WayOn){.passes = ways[i].through,
                                .direction = direction,
                                .part = (float)ways[i].part,
                                .angle = angle_to(direction, met->place.normal),
                                .wave = ways[i].wave});
    }
}

static void meet_boundary(Path *path, const Event *event, Meeting *met)
{
    const World *world = path->tracer->world;
    Lanes eta_i = path_ior(path, event->crossing.medium_from), eta_t = path_ior(path, event->crossing.medium_to);
    uint32_t number = world->looks[event->hit.object].surface;
    const SceneSurface *surface = number == SCENE_NONE ? NULL : path_surface(path, event, number);
    BsdfSpec room;
    const BsdfSpec *spec = path_boundary_at(path, event, surface, &met->place, &room);
    met->step.to = event->crossing.medium_to;
    if (!spec && world_refracts_doubly(world, event->crossing.medium_from, event->crossing.medium_to)) {
        meet_crystal(path, event, met);
        return;
    }
    if (!turn_at_boundary(path, eta_i, eta_t, met->place.normal, met))
        turn_at_boundary(path, eta_i, eta_t, met->place.geometric, met);
    if (!spec) return;
    const bool total = met->step.transmitted == 0;
    Bsdf bsdf;
    path_bsdf_of_boundary(path, event, surface, spec, eta_i, eta_t, &bsdf);
    divide(&bsdf, cosf(met->step.angle), &met->step.mirrored, &met->step.transmitted);
    met->step.scatters = !bsdf.specular_only;
    if (!total) return; /* what rough facets let through has no middle */
    met->step.transmitted = 0;
}

/* A thin sheet, a mirror, or what ends the way. */
static void meet_opaque(Path *path, const Event *event, Meeting *met)
{
    const World *world = path->tracer->world;
    const ObjectLook *look = &world->looks[event->hit.object];
    LightStep *step = &met->step;
    step->turn = LIGHT_ENDS;
    if (look->light != SCENE_NONE || look->surface == SCENE_NONE) return;
    const SceneSurface *surface = path_surface(path, event, look->surface);
    if (!surface->finished) return;
    BsdfSpec room;
    const BsdfSpec *spec = path_spec_at(path, event, surface, &met->place, &room);
    Bsdf bsdf;
    path_bsdf_of_finished(path, surface, spec, &bsdf);
    Vec3f direction = path->ray.direction;
    float cosine = -vec3f_dot(direction, met->place.normal);
    if (!(cosine > 0) || (!surface->thin && !bsdf.specular_only)) return;
    step->turn = LIGHT_PASSES;
    step->angle = step->on = angle_to(direction, met->place.normal);
    step->to = step->medium;
    met->on = direction;
    met->back = reflect_direction(direction, met->place.normal);
    if (!(vec3f_dot(met->back, met->place.geometric) > 0)) met->back = path_mirror(&met->place, direction);
    divide(&bsdf, cosine, &step->mirrored, &step->transmitted);
    step->scatters = !bsdf.specular_only;
    if (step->mirrored + step->transmitted == 0) step->turn = LIGHT_ENDS;
}

static float index_of(Path *path, uint32_t medium)
{
    bool bends_alike = true;
    const CrystalSide side = path_crystal_side(path, medium, &bends_alike);
    return (float)crystal_ray_index(&side, path->wave, vec3_from_f(path->ray.direction));
}

/* The path has come to an event. */
static Meeting meet(Path *path, const Event *event)
{
    const World *world = path->tracer->world;
    const bool surface = event->kind == EVENT_BOUNDARY || event->kind == EVENT_OPAQUE;
    Meeting met = {.step = {.turn = event->kind == EVENT_ESCAPE ? LIGHT_LEAVES : LIGHT_DROPPED,
                            .length = surface ? event->hit.t : HUGE_VAL,
                            .place = surface ? ray_point(&path->ray, event->hit.t) : path->ray.origin,
                            .direction = path->ray.direction,
                            .medium = event->medium,
                            .to = SCENE_NONE,
                            .object = surface ? scene_whole(world->scene, event->hit.object) : SCENE_NONE,
                            .index = index_of(path, event->medium),
                            .carried = lanes_get(path->beta, 0)}};
    if (!surface) return met;
    met.place = path_place(path, event);
    met.step.turn = LIGHT_PASSES;
    if (event->kind == EVENT_BOUNDARY)
        meet_boundary(path, event, &met);
    else
        meet_opaque(path, event, &met);
    if (met.step.turn == LIGHT_PASSES && !met.n_ways) add_two_ways(path, event, &met);
    return met;
}

/* Which of the ways on a way takes at its step k. */
static uint32_t rank_of(const LightWays *ways, uint32_t way, uint32_t k)
{
    const LightWay *own = &ways->ways[way];
    return k < own->depth ? light_ways_step(ways, way, k)->rank : k == own->depth ? own->rank : 0;
}

static void take(Meeting *met, uint32_t rank)
{
    LightStep *step = &met->step;
    const WayOn *way = &met->ways[rank];
    /* a metal lets nothing through either, but keeps some */
    const LightTurn mirrored = step->transmitted > 0 || step->mirrored < .9999f ? LIGHT_MIRRORED : LIGHT_TOTAL;
    step->turn = way->passes ? LIGHT_PASSES : mirrored;
    step->direction = way->direction;
    if (way->passes) step->on = way->angle;
    step->part = way->part;
    step->rank = rank;
    step->wave = way->wave;
}

/* Sends the path on; false: memory ends. */
static bool go_on(Path *path, Event *event, const Meeting *met, bool *sheet)
{
    Tracer *tracer = path->tracer;
    const LightStep *step = &met->step;
    const bool passes = step->turn == LIGHT_PASSES;
    path->beta = lanes_scale(path->beta, step->part);
    path->bounce++;
    *sheet = passes && event->kind == EVENT_OPAQUE && path_passes_into_boundary(path, event);
    if (*sheet) return true;
    if (passes && event->kind == EVENT_OPAQUE && !path_cross_into_next(tracer, event)) return false;
    path_leave(path, event, &met->place, passes, step->direction);
    path->wave = step->wave;
    return !tracer->out_of_memory;
}

static bool add_step(LightWays *ways, uint32_t way, const LightStep *step)
{
    if (!ARRAY_ROOM(ways->steps, ways->steps_capacity, ways->n_steps)) return false;
    ways->steps[ways->n_steps++] = *step;
    ways->ways[way].n++;
    return true;
}

static bool add_way(LightWays *ways, uint32_t from, uint32_t depth, uint32_t rank)
{
    if (ways->n_ways == LIGHT_WAYS) {
        ways->cut = true;
        return true;
    }
    if (!ARRAY_ROOM(ways->ways, ways->ways_capacity, ways->n_ways)) return false;
    ways->ways[ways->n_ways++] = (LightWay){.from = from, .depth = depth, .rank = rank};
    return true;
}

/* Notes the step k of a way, and the other ways that part there; false: memory ends. */
static bool note(Follower *f, uint32_t way, uint32_t k, Meeting *met)
{
    LightWays *ways = f->ways;
    const LightStep *step = &met->step;
    LightWay *own = &ways->ways[way];
    const uint32_t depth = own->depth, n = step->turn == LIGHT_PASSES ? met->n_ways : 0; /* else it does not go on */
    if (n) take(met, rank_of(ways, way, k));
    if (isfinite(step->length)) own->optical += step->length * (double)step->index;
    if (k < depth) return true;
    if (k == depth) own->first = (uint32_t)ways->n_steps;
    if (!add_step(ways, way, step)) return false;
    if (k == depth && own->from != SCENE_NONE) return true; /* these part from the one that it parts from */
    for (uint32_t rank = 1; rank < n && step->carried * met->ways[rank].part >= f->least; rank++)
        if (!add_way(ways, way, k, rank)) return false;
    return true;
}

static void begin(Follower *f)
{
    Path *path = &f->path;
    path_init(path, &f->tracer, sampler_make(0, 0, 0, 0));
    path->wavelengths = (WavelengthSample){.nm = lanes_all(f->nm)};
    path->ray = *f->ray;
    path->straight = path->for_light = true;
}

/* false: memory ends */
static bool follow(Follower *f, uint32_t way)
{
    Path *path = &f->path;
    Event event;
    bool sheet = false;
    begin(f);
    if (nest_list_copy(&f->tracer.list, &f->start) != STATUS_OK) return false;
    for (uint32_t k = 0;; k++) {
        if (!sheet) path_next_event(path, &event);
        if (f->tracer.out_of_memory) return false;
        Meeting met = meet(path, &event);
        if (sheet) met.step.length = 0;
        if (k == LIGHT_STEPS && met.step.turn == LIGHT_PASSES) met.step.turn = LIGHT_DROPPED;
        if (!note(f, way, k, &met)) return false;
        if (met.step.turn > LIGHT_TOTAL) return true;
        if (!go_on(path, &event, &met, &sheet)) return false;
    }
}

static Status find_start(Follower *f, Error *error)
{
    uint32_t on = SCENE_NONE;
    const CompiledScene *compiled = f->tracer.world->compiled;
    if (compiled_interior(compiled, vec3f_from(f->ray->origin), f->ray->time, &f->tracer.hits, &f->start, &on) !=
        STATUS_OK)
        return fail_memory(error, 0, "the way of a ray");
    if (on == SCENE_NONE) return STATUS_OK;
    return fail(error, STATUS_USAGE,
                "a ray cannot start on a surface, and this is one of '%s': move it off, to one side",
                compiled->scene->objects[on].name);
}

Status light_ways_find(const World *world, const Ray *ray, float nm, float least, LightWays *ways, Error *error)
{
    *ways = (LightWays){0};
    Follower *f = memory_apart(1, sizeof *f);
    if (!f) return fail_memory(error, sizeof *f, "the way of a ray");
    f->ray = ray;
    f->nm = nm;
    f->least = least;
    f->ways = ways;
    nest_list_init(&f->start);
    tracer_init(&f->tracer, world);
    Status status = find_start(f, error);
    if (status == STATUS_OK) ways->start = nest_medium(&f->start);
    bool fine = status != STATUS_OK || add_way(ways, SCENE_NONE, 0, 0);
    for (uint32_t i = 0; fine && i < ways->n_ways; i++) fine = follow(f, i);
    if (!fine) status = fail_memory(error, 0, "the ways of a ray");
    nest_list_clear(&f->start);
    tracer_clear(&f->tracer);
    free(f);
    return status;
}

void light_ways_clear(LightWays *ways)
{
    free(ways->steps);
    free(ways->ways);
    *ways = (LightWays){0};
}
