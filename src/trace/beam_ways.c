/* beam_ways.c - see beam_ways.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/beam_ways.h"

#include <stdlib.h>

#include "optics/fresnel.h"
#include "optics/sampling.h"
#include "trace/airlight.h"
#include "trace/slab_faces.h"
#include "trace/slab_look.h"

/* Lamps whose cones are wider, as the cosine of half of that, light so much that flights find it. */
#define NARROW 0.966
/* Those whose cones are not wider are pencils of light, if all of one comes to the same face. Its ways hold nearly all of its
 * light behind that, and looks from elsewhere, which find next to nothing, are sent but so often: of two lasers in a tank of milk
 * they took more than half of the time. */
#define PENCIL 0.9998
#define SELDOM 0.125f
/* Of its light, less is not followed. */
#define FAINT 0.01f
/* Rays of each lamp; each is followed through all faces, and again and again, mirrored at the first of them, or the next, ...;
 * events of each, and straight parts and routes of all. */
enum { RAYS = 32, MIRRORED_AT_MOST = 4, MOST_EVENTS = 64, MOST_PARTS = 1024, MOST_ROUTES = 48 };
/* The rays' random numbers: no pixel of a picture has this coordinate. */
enum { RAY_PIXEL = 0x6265616d };
/* As how much wider a beam is taken than those rays are. */
#define WIDER 1.1
/* Of its own radii, how far beside a beam places are looked at. */
#define BESIDE 3.0
/* Stretches of paths that media have scattered more often are not looked at. */
enum { MOST_SCATTERED = 1 };

/* ---- ways ---- */

/* A straight part of a ray's way. route: the number of its faces before; place: where it left the lamp, as a BeamWay has it. */
typedef struct Part {
    uint32_t route;
    Vec3 from, to;
    double place[2];
    float left; /* of its light */
} Part;

/* All of a lamp's. */
typedef struct Parts {
    Part items[MOST_PARTS], by_route[MOST_PARTS];
    BeamRoute routes[MOST_ROUTES];
    uint32_t n, n_routes;
    float nm[RAYS]; /* wavelengths of the rays */
} Parts;

/* How far a ray is followed that does not end: beams get wider, and one piece of a way is to tell of all of it. */
static double far_away(const World *world, Vec3 from)
{
    const Slabs *slabs = &world->slabs;
    double far = 0;
    for (uint32_t i = 0; i < slabs->n_boxes + slabs->n_basins; i++) {
        Box3 box = i < slabs->n_boxes ? slabs->boxes[i] : slabs->basins[i - slabs->n_boxes];
        far = fmax(far, vec3_length(vec3_sub(box.max, box.min)) + vec3_length(vec3_sub(box.max, from)));
    }
    return far;
}

/* False: there is no room. */
static bool add_part(Parts *parts, const BeamRoute *route, Vec3 from, Vec3 to, const double place[2], float left)
{
    uint32_t i = 0;
    while (i < parts->n_routes && parts->routes[i].steps != route->steps) i++;
    if (parts->n == MOST_PARTS || i == MOST_ROUTES) return false;
    if (i == parts->n_routes) parts->routes[parts->n_routes++] = *route;
    parts->items[parts->n++] = (Part){i, from, to, {place[0], place[1]}, left};
    return true;
}

/* A face that the path is at becomes the next one of the route. */
static void add_face(BeamRoute *route, const Event *event, const SlabFace *face, bool mirrored)
{
    Vec3 normal = vec3_normalize(vec3_from_f(face->place.geometric));
    route->faces[route->n++] = (BeamFace){.normal = normal,
                                          .offset = vec3_dot(normal, face->place.position),
                                          .number = face->number,
                                          .medium_before = event->crossing.medium_from,
                                          .medium_behind = event->crossing.medium_to,
                                          .mirrored = mirrored};
    route->mirrored |= mirrored;
    route->steps = slab_step(route->steps, face->number, mirrored);
}

/* The parts behind the first face, or the one, number mirrored_at from 1 on, that mirrors; 0: none does. place: where the ray
 * left the lamp. */
static void follow(Path *path, const double place[2], uint32_t mirrored_at, Parts *parts)
{
    const World *world = path->tracer->world;
    BeamRoute route = {.n = 0};
    float left = 1;
    for (; path->bounce < MOST_EVENTS; path->bounce++) {
        Event event;
        SlabFace face;
        Vec3 from = path->ray.origin;
        path_next_event(path, &event);
        if (event.kind == EVENT_LOST || event.kind == EVENT_GIVE_UP) return;
        double t = event.kind == EVENT_ESCAPE ? far_away(world, from) : event.hit.t;
        if (route.n > 0 && route.mirrored == (mirrored_at > 0) &&
            !add_part(parts, &route, from, ray_point(&path->ray, t), place, left))
            return;
        if (event.kind == EVENT_OPAQUE) {
            if (!slab_cross_pane(path, &event)) return;
            continue;
        }
        if (event.kind != EVENT_BOUNDARY || route.n == BEAM_FACES || !slab_look_at_face(path, &event, &face)) return;
        const bool mirrored = route.n + 1 == mirrored_at;
        if (!mirrored && !face.passes) return;
        float reflected = lanes_get(face.reflectance, 0);
        left *= mirrored ? reflected : 1 - reflected;
        if (left < FAINT) return;
        add_face(&route, &event, &face, mirrored);
        path_leave(path, &event, &face.place, !mirrored,
                   mirrored ? reflect_direction(path->ray.direction, face.place.normal) : face.refracted);
    }
}

/* Across a direction, or on a lamp. */
static void across(Vec3 off, Vec3 x, Vec3 y, double at[2])
{
    at[0] = vec3_dot(off, x);
    at[1] = vec3_dot(off, y);
}

void beam_lamp_place(const Affine *to_world, Vec3 place, double at[2])
{
    across(vec3_sub(place, to_world->t), affine_vector(to_world, vec3(1, 0, 0)), affine_vector(to_world, vec3(0, 0, 1)),
           at);
}

/* One of a lamp's rays; false: it has none. */
static bool leave_lamp(Path *path, uint32_t emitter, double at[2])
{
    Tracer *tracer = path->tracer;
    const World *world = tracer->world;
    const SceneLight *light = light_of_emitter(world, emitter);
    float u[2], v[2];
    Vec3 place;
    Vec3f direction;
    sampler_2d(&path->sampler, sampler_dimension(0, DIM_LIGHT), u);
    sampler_2d(&path->sampler, sampler_dimension(0, DIM_SCATTER), v);
    const double time = world->moves ? (double)sampler_1d(&path->sampler, DIM_TIME) : 0;
    light_send(world, emitter, time, u, v, &place, &direction);
    beam_lamp_place(&light->to_world, place, at);
    double off = 1e-4 * fmax(light->half_width, light->half_height); /* its surface */
    Vec3 in_front = vec3_rounded(vec3_along(place, off, vec3_from_f(direction)));
    ray_begin(&path->ray, in_front, direction);
    path->ray.time = time;
    return compiled_interior(world->compiled, vec3f_from(in_front), time, &tracer->shadow_hits, &tracer->list, NULL) ==
           STATUS_OK;
}

/* How far beside the way the parts are at one of its ends, and, *along, how far they reach there. */
static double radius_at(const BeamWay *way, const Part *parts, uint32_t n, bool end, double *along)
{
    double radius = 0;
    for (const Part *part = parts; part < parts + n; part++) {
        Vec3 off = vec3_sub(end ? part->to : part->from, way->from);
        double at = vec3_dot(off, way->along);
        radius = fmax(radius, vec3_length(vec3_along(off, -at, way->along)));
        *along = end ? fmax(*along, at) : fmin(*along, at);
    }
    return WIDER * radius;
}

/* Sums of what is of one way. */
typedef struct Sums {
    double n, p[2], c[2], pp[3],
        cp[2][2]; /* of places across the way, of those on the lamp, and of products: pp[0][0], [0][1], [1][1] */
} Sums;

static void across_way(const BeamWay *way, Vec3 place, double at[2])
{
    across(vec3_sub(place, way->from), vec3_from_f(way->side[0]), vec3_from_f(way->side[1]), at);
}

static void add_up(const BeamWay *way, const Part *part, Sums *sums)
{
    const double *c = part->place;
    for (int end = 0; end < 2; end++) {
        double p[2];
        across_way(way, end ? part->to : part->from, p);
        sums->n++;
        sums->pp[0] += p[0] * p[0], sums->pp[1] += p[0] * p[1], sums->pp[2] += p[1] * p[1];
        for (int i = 0; i < 2; i++) {
            sums->p[i] += p[i], sums->c[i] += c[i];
            for (int k = 0; k < 2; k++) sums->cp[i][k] += c[i] * p[k];
        }
    }
}

/* By least squares over the rays. */
static void fit_source(const Part *parts, uint32_t n, BeamWay *way)
{
    Sums sums = {0};
    for (const Part *part = parts; part < parts + n; part++) add_up(way, part, &sums);
    const double more = 1 / sums.n;
    for (int i = 0; i < 2; i++) way->across_mean[i] = sums.p[i] * more, way->place_mean[i] = sums.c[i] * more;
    const double *p = way->across_mean, *c = way->place_mean;
    double xx = sums.pp[0] * more - p[0] * p[0], xy = sums.pp[1] * more - p[0] * p[1],
           yy = sums.pp[2] * more - p[1] * p[1], ridge = 1e-9 * (xx + yy);
    double determinant = (xx + ridge) * (yy + ridge) - xy * xy;
    if (!(determinant > 0)) return;
    for (int i = 0; i < 2; i++) {
        double x = sums.cp[i][0] * more - c[i] * p[0], y = sums.cp[i][1] * more - c[i] * p[1];
        way->slope[i][0] = (x * (yy + ridge) - y * xy) / determinant;
        way->slope[i][1] = (y * (xx + ridge) - x * xy) / determinant;
    }
    for (const Part *part = parts; part < parts + n; part++) {
        for (int end = 0; end < 2; end++) {
            double middle[2], reach[2];
            beam_way_source(way, end ? part->to : part->from, middle, reach);
            for (int i = 0; i < 2; i++)
                way->reach[end][i] = fmax(way->reach[end][i], WIDER * fabs(part->place[i] - middle[i]));
        }
    }
}

/* What n >= 1 parts make that have come by one route; false: nothing that has a length. fits: lamps do not move. */
static bool way_of(const Part *parts, uint32_t n, bool fits, BeamWay *way)
{
    Vec3 from = vec3(0, 0, 0), to = vec3(0, 0, 0);
    double begin = 0, end = 0;
    way->power = 0;
    for (const Part *part = parts; part < parts + n; part++) {
        from = vec3_add(from, part->from);
        to = vec3_add(to, part->to);
        way->power += part->left / RAYS;
    }
    way->from = vec3_scale(from, 1 / (double)n);
    Vec3 along = vec3_sub(vec3_scale(to, 1 / (double)n), way->from);
    if (!(vec3_length(along) > 0)) return false;
    way->along = vec3_normalize(along);
    sampling_basis(vec3f_from(way->along), &way->side[0], &way->side[1]);
    for (int i = 0; i < 2; i++) way->radius[i] = radius_at(way, parts, n, i == 1, i == 1 ? &end : &begin);
    way->from = vec3_along(way->from, begin, way->along);
    way->length = end - begin;
    double least = 1e-6 * way->length;
    for (int i = 0; i < 2; i++) way->radius[i] = fmax(way->radius[i], least);
    if (fits) fit_source(parts, n, way);
    return way->length > 0;
}

/* Wavelengths that stand for what a lamp shines, each for as much; the ends of what is seen do not count. */
static void choose_wavelengths(const SceneLight *light, float nm[RAYS])
{
    enum { FROM = 390, TO = 720 };
    float sums[TO - FROM], all = 0;
    for (int i = 0; i < TO - FROM; i++)
        sums[i] = all += lanes_get(spectrum_at(&light->radiance, lanes_all((float)(FROM + i))), 0);
    for (int i = 0, at = 0; i < RAYS; i++) {
        while (at < TO - FROM - 1 && sums[at] <= ((float)i + 0.5f) / RAYS * all) at++;
        nm[i] = (float)(FROM + at);
    }
}

/* Ray number i of a lamp, followed as follow() says. */
static void follow_ray(Tracer *tracer, uint32_t emitter, uint32_t i, uint32_t mirrored_at, Parts *parts)
{
    Path path;
    double place[2];
    path_init(&path, tracer, sampler_make(0, RAY_PIXEL, emitter, i));
    path.wavelengths = (WavelengthSample){.nm = lanes_all(parts->nm[i])};
    path.straight = path.for_light = true;
    if (leave_lamp(&path, emitter, place)) follow(&path, place, mirrored_at, parts);
}

/* Those of one route, into parts->by_route; returns how many. */
static uint32_t parts_by_route(Parts *parts, uint32_t route)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < parts->n; i++)
        if (parts->items[i].route == route) parts->by_route[n++] = parts->items[i];
    return n;
}

/* Whether all rays have come to the same face first, and gone through. */
static bool enter_by_one(const Parts *parts)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < parts->n; i++)
        n += parts->items[i].route == 0 && !parts->routes[0].mirrored && parts->routes[0].n == 1;
    return n == RAYS;
}

/* Whether looks from a way that go straight to its lamp come to its faces. */
static bool is_found_straight(Tracer *tracer, const BeamWay *beam)
{
    static const double along[] = {0.02, 0.5, 0.98}; /* of its length */
    const Vec3 lamp = light_of_emitter(tracer->world, beam->emitter)->to_world.t;
    for (size_t i = 0; i < COUNT_OF(along); i++) {
        Path path, look;
        FaceWay way;
        path_init(&path, tracer, sampler_make(0, RAY_PIXEL, beam->emitter, 0));
        path.ray.time = 0;
        const Vec3 place = vec3_rounded(vec3_along(beam->from, along[i] * beam->length, beam->along));
        const Vec3 to = vec3_sub(lamp, place);
        const double distance = vec3_length(to);
        if (!slab_start_beside(&path, tracer, place, vec3f_from(vec3_scale(to, 1 / distance)), &look)) return true;
        look.ray.t_max = distance;
        if (!slab_find_faces(&look, true, &way) || slab_steps_of(&way) != beam->route.steps) return false;
    }
    return true;
}

static bool disperses(const World *world, const BeamRoute *route)
{
    bool any = false;
    for (uint32_t i = 0; i < route->n; i++) any |= world_medium_disperses(world, route->faces[i].medium_behind);
    return any;
}

/* Adds the ways of a lamp. */
static void add_ways(World *world, Tracer *tracer, uint32_t emitter, Parts *parts)
{
    parts->n = parts->n_routes = 0;
    choose_wavelengths(light_of_emitter(world, emitter), parts->nm);
    for (uint32_t at = 0; at <= MIRRORED_AT_MOST; at++)
        for (uint32_t i = 0; i < RAYS && !tracer->out_of_memory; i++) follow_ray(tracer, emitter, i, at, parts);
    for (uint32_t i = 0; i < parts->n_routes && world->n_beam_ways < BEAM_WAYS_MOST; i++) {
        BeamWay way = {.emitter = emitter, .route = parts->routes[i]};
        uint32_t n = parts_by_route(parts, i);
        if (!way_of(parts->by_route, n, !world->moves, &way)) continue;
        way.by_route = way.route.mirrored || (!world->moves && !is_found_straight(tracer, &way));
        way.fans_out = way.by_route && !way.route.mirrored && disperses(world, &way.route);
        world->beam_ways[world->n_beam_ways++] = way;
    }
}

Status beam_ways_find(World *world, Error *error)
{
    if (!world->n_beams) return STATUS_OK;
    world->beam_ways = calloc(BEAM_WAYS_MOST, sizeof *world->beam_ways);
    Parts *parts = malloc(sizeof *parts);
    if (!world->beam_ways || !parts) {
        free(parts);
        return fail_memory(error, BEAM_WAYS_MOST * sizeof *world->beam_ways, "beams of light");
    }
    Tracer tracer;
    tracer_init(&tracer, world);
    for (uint32_t i = 0; i < world->n_beams; i++) {
        const double cosine = light_of_emitter(world, world->beams[i])->cos_none;
        if (!(cosine >= NARROW)) continue;
        add_ways(world, &tracer, world->beams[i], parts);
        if (cosine >= PENCIL && !world->moves && enter_by_one(parts) && world->beam_looks[i] > 0)
            world->beam_looks[i] = SELDOM;
    }
    world->mean_beam_looks = 0;
    for (uint32_t i = 0; i < world->n_beams; i++)
        world->mean_beam_looks += world->beam_looks[i] / (float)world->n_beams;
    bool out_of_memory = tracer.out_of_memory;
    tracer_clear(&tracer);
    free(parts);
    return out_of_memory ? fail(error, STATUS_NOMEM, "out of memory for beams of light") : STATUS_OK;
}

/* ---- places within a way ---- */

/* Of two numbers at the ends of a way, what it is at a length from its beginning. */
static double between(const BeamWay *way, double begin, double end, double at)
{
    return begin + fmin(fmax(at / way->length, 0), 1) * (end - begin);
}

bool beam_way_holds(const BeamWay *way, Vec3 place)
{
    Vec3 off = vec3_sub(place, way->from);
    double at = vec3_dot(off, way->along), radius = between(way, way->radius[0], way->radius[1], at);
    if (at < -radius || at > way->length + radius) return false;
    off = vec3_along(off, -at, way->along);
    return vec3_dot(off, off) <= radius * radius;
}

void beam_way_source(const BeamWay *way, Vec3 place, double middle[2], double reach[2])
{
    double p[2], at = vec3_dot(vec3_sub(place, way->from), way->along);
    across_way(way, place, p);
    for (int i = 0; i < 2; i++) {
        middle[i] = way->place_mean[i] + way->slope[i][0] * (p[0] - way->across_mean[0]) +
                    way->slope[i][1] * (p[1] - way->across_mean[1]);
        reach[i] = between(way, way->reach[0][i], way->reach[1][i], at);
    }
}

/* ---- places on a stretch ---- */

/* Where a stretch passes a way: places within the beam mostly, each as often, and the others, or all where it goes beside, by an
 * angle under which something as far from the stretch's foot as the axis, and the radius more, would see them. */
typedef struct Passing {
    double foot, begin, end; /* the others, from the foot */
    double within;           /* as far as this from the foot it is within the beam; 0: it is not */
    double distance, angle;
    float weight; /* 1: it goes through the beam; less: beside it */
} Passing;

/* How often places within the beam are chosen. */
#define WITHIN 0.85

/* Where it is beside the way's ends; false: nowhere. */
static bool cut_to_way(const BeamWay *beam, double turn, double at, double *begin, double *end)
{
    const double level = 1e-12, first = -beam->radius[0] - at, last = beam->length + beam->radius[1] - at;
    if (fabs(turn) < level) return first <= 0 && last >= 0;
    *begin = fmax(*begin, fmin(first / turn, last / turn));
    *end = fmin(*end, fmax(first / turn, last / turn));
    return *begin < *end;
}

/* False: it does not pass near. */
static bool pass_by(const BeamWay *beam, const Airway *way, Passing *passing)
{
    if (beam->fans_out) return false;
    const Vec3 direction = vec3_from_f(way->direction), from = vec3_sub(way->origin, beam->from);
    double turn = vec3_dot(direction, beam->along), at = vec3_dot(from, beam->along);
    double begin = way->begin, end = way->end;
    if (!cut_to_way(beam, turn, at, &begin, &end)) return false;
    Vec3 across = vec3_along(direction, -turn, beam->along), beside = vec3_along(from, -at, beam->along);
    double square = fmax(vec3_dot(across, across), 1e-12), foot = -vec3_dot(beside, across) / square;
    double nearest = fmin(fmax(foot, begin), end);
    double radius = between(beam, beam->radius[0], beam->radius[1], at + nearest * turn), radius2 = radius * radius;
    Vec3 off = vec3_along(beside, nearest, across), off_foot = vec3_along(beside, foot, across);
    double distance2 = vec3_dot(off, off), foot2 = vec3_dot(off_foot, off_foot);
    if (distance2 > BESIDE * BESIDE * radius2) return false;
    *passing = (Passing){.foot = foot, .begin = begin - foot, .end = end - foot, .weight = 1};
    passing->distance = sqrt((foot2 + radius2) / square);
    passing->angle = sampling_angle(passing->distance, passing->begin, passing->end);
    if (distance2 < radius2)
        passing->within = sqrt((radius2 - foot2) / square);
    else
        passing->weight = (float)(radius2 / distance2);
    return passing->angle > 0;
}

/* The part of those places that is on the stretch, from *begin on; 0 or less: none. */
static double within_from(const Passing *passing, double *begin)
{
    *begin = fmax(-passing->within, passing->begin);
    return passing->within > 0 ? fmin(passing->within, passing->end) - *begin : 0;
}

static double passing_sample(const Passing *passing, double u)
{
    double begin, length = within_from(passing, &begin), within = length > 0 ? WITHIN : 0;
    if (u < within) return passing->foot + begin + u / within * length;
    u = (u - within) / (1 - within);
    return passing->foot + sampling_equiangular(u, passing->distance, passing->begin, passing->end, passing->angle);
}

static float passing_density(const Passing *passing, double t)
{
    double off = t - passing->foot, begin, length = within_from(passing, &begin);
    if (off < passing->begin || off > passing->end) return 0;
    double pdf = sampling_equiangular_pdf(off, passing->distance, passing->begin, passing->end, passing->angle);
    if (length > 0) pdf = (1 - WITHIN) * pdf + (off >= begin && off <= begin + length ? WITHIN / length : 0);
    return (float)pdf;
}

/* b(t): of all ways, as often as the stretch passes any. */
static float place_density(const World *world, const Airway *way, double t)
{
    float sum = 0, all = 0;
    for (uint32_t i = 0; i < world->n_beam_ways; i++) {
        Passing passing;
        if (!pass_by(&world->beam_ways[i], way, &passing)) continue;
        all += passing.weight;
        sum += passing.weight * passing_density(&passing, t);
    }
    return all > 1 ? sum / all : sum;
}

/* A place, by numbers in [0, 1); false: none, as often as the stretch passes all ways by. */
static bool choose_place(const Path *path, float u, float v, double *t)
{
    const World *world = path->tracer->world;
    Passing chosen = {.weight = 0};
    float all = 0, rest = v;
    for (uint32_t i = 0; i < world->n_beam_ways; i++) {
        Passing passing;
        if (!pass_by(&world->beam_ways[i], &path->way, &passing)) continue;
        all += passing.weight;
        float part = passing.weight / all;
        if (rest < part) {
            chosen = passing;
            rest /= part;
        } else {
            rest = (rest - part) / (1 - part);
        }
    }
    if (!(u < float_min(all, 1))) return false;
    *t = airlight_off_ends(path, passing_sample(&chosen, (double)float_min(rest, 0x1.fffffep-1f)));
    return true;
}

/* ---- looks ---- */

/* What is scattered there of the light that looks find by faces, of each look. density: of the place, of all that find it. */
static void gather(Path *path, const AirPlace *place, double t, float density, LightLooks *looks,
                   Lanes scattered[MOST_LIGHT_LOOKS])
{
    const Airway *way = &path->way;
    const SurfacePlace there = {.position = ray_point(&path->ray, t), .apart = true};
    const LookPlace from = {NULL, &there, path_lights(path, false), vec3f(0, 0, 0)};
    const Lanes left = lanes_mul(place->coefficient, place->left);
    path_look_at_light(path, &from, looks);
    for (uint32_t i = 0; i < looks->n; i++) {
        const LightSample *light = &looks->lights[i];
        scattered[i] = lanes_all(0);
        if (!(light->pdf_w > 0) || !light->arrives) continue; /* what comes straight is looked for by airlight.c */
        Lanes pdf = phase_evaluate(place->phase, path->ray.direction, light->direction, path->wavelengths.nm);
        float by_chance =
            light->delta ? 0 : airlight_turn_density(way, place->phase, place->coefficient, place->depth, pdf);
        float weight = sampling_balance(light->pdf_w, by_chance) / (light->pdf_w * density);
        scattered[i] = lanes_mul(lanes_mul(lanes_scale(pdf, weight), *light->arrives), left);
    }
}

void beam_ways_look(Path *path, const FlightStretch *stretch)
{
    enum { LOOKS = 1 << 22 }; /* its random numbers are not those of the path's own events, probes and other looks */
    Tracer *tracer = path->tracer;
    Airway *way = &path->way;
    if (path->n_scattered > MOST_SCATTERED || tracer->world->trial.flights_alone) return;
    const uint32_t number = airlight_stretch(path, stretch->number), bounce = path->bounce;
    float u[2];
    double which = (double)sampler_3d(&path->sampler, airlight_dimension(number, AIRLIGHT_BEAMS), u) * 0x1p-32, t;
    AirPlace place;
    way->beam = way->carried;
    if (!choose_place(path, u[0] / way->beam, u[1], &t) || !airlight_place(path, stretch, t, &which, &place)) return;
    float looked = way->beam * place_density(tracer->world, way, t) / (float)way->n_media;
    float density = looked + airlight_flight_density(way, place.coefficient, place.depth);
    if (!(looked > 0)) return;
    if (!path_turn_aside(tracer, &t)) {
        tracer->out_of_memory = true;
        return;
    }
    path->bounce = LOOKS + number;
    LightLooks looks;
    Lanes scattered[MOST_LIGHT_LOOKS];
    gather(path, &place, t, density, &looks, scattered);
    path->bounce = bounce;
    path_turn_back(tracer);
    for (uint32_t i = 0; i < looks.n; i++)
        if (!lanes_zero(scattered[i]))
            flight_add_light(path, stretch->flight, scattered[i], light_sample_group(tracer->world, &looks.lights[i]));
}

float beam_ways_rival(const Path *path)
{
    const Airway *way = &path->from;
    if (!(way->rarity > 0) || !(way->beam > 0)) return 0;
    return way->rarity * way->beam * place_density(path->tracer->world, way, way->t) / (float)way->n_media;
}
