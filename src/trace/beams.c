/* beams.c - see beams.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/beams.h"

#include <stdlib.h>

#include "base/angle.h"
#include "optics/sampling.h"

/* Whether a lamp's cone may come to a ball: by the cone whose tip is so far behind the lamp that it holds all of its cones. */
static bool comes_to_ball(const SceneLight *light, Vec3 middle, double radius)
{
    const double cosine = light->cos_none, sine = sqrt(1 - cosine * cosine);
    Vec3 axis = vec3_normalize(affine_vector(&light->to_world, vec3(0, 1, 0)));
    double size = light_is_flat(light) ? hypot(light->half_width, light->half_height) : 0;
    Vec3 to = vec3_along(vec3_sub(middle, light->to_world.t), size * cosine / sine, axis);
    double distance = vec3_length(to);
    if (!(cosine > 0) || !(sine > 0) || distance <= radius) return true;
    double between = acos(fmin(fmax(vec3_dot(to, axis) / distance, -1), 1));
    return between <= acos(cosine) + asin(radius / distance) + 1e-6;
}

static bool comes_to_slab(const World *world, const SceneLight *light)
{
    bool comes = world->scene->n_keys > 0; /* it may move */
    for (uint32_t i = 0; i < world->slabs.n_boxes && !comes; i++) {
        Box3 box = world->slabs.boxes[i];
        comes = comes_to_ball(light, box3_centre(box), 0.5 * vec3_length(vec3_sub(box.max, box.min)));
    }
    return comes;
}

Status beams_find(World *world, Error *error)
{
    const EmitterSet *set = &world->emitters;
    world->n_beams = world->n_balls = 0;
    if (!world->slabs.n_boxes || !set->n) return STATUS_OK;
    world->beams = malloc(2 * set->n * sizeof *world->beams);
    world->beam_looks = malloc(set->n * sizeof *world->beam_looks);
    if (!world->beams || !world->beam_looks) return fail_memory(error, set->n * sizeof *world->beams, "lights");
    world->balls = world->beams + set->n;
    for (uint32_t i = 0; i < set->n; i++) world->beam_looks[i] = 1;
    for (uint32_t i = 0; i < set->n; i++) {
        if (set->emitters[i].kind != EMITTER_LIGHT) continue;
        const SceneLight *light = &world->scene->lights[set->emitters[i].of];
        if (light->kind == LIGHT_SPHERE)
            world->balls[world->n_balls++] = i;
        else if ((light->kind == LIGHT_POINT || light_is_focused(light)) && comes_to_slab(world, light))
            world->beams[world->n_beams++] = i;
    }
    return STATUS_OK;
}

/* Which one of n that are in order; n: none. */
static uint32_t find_among(const uint32_t *emitters, uint32_t n, uint32_t emitter)
{
    uint32_t low = 0, high = n;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (emitters[middle] < emitter)
            low = middle + 1;
        else
            high = middle;
    }
    return low < n && emitters[low] == emitter ? low : n;
}

bool beams_have(const World *world, uint32_t emitter)
{
    return find_among(world->beams, world->n_beams, emitter) < world->n_beams ||
           find_among(world->balls, world->n_balls, emitter) < world->n_balls;
}

/* ---- balls ---- */

/* How often one is looked at, where there are some. */
#define AT_BALLS 0.25
/* The sine of how far light is turned at most that comes to a ball by faces, where looks are to find it; and what they find besides of
 * what is seen straight, at its rim. */
#define TURNED 0.8
#define RIM 0.2

/* The zone of a ball about the rim of what is seen of it from there. */
typedef struct Zone {
    Vec3 centre, towards; /* unit */
    double radius, begin; /* the cosine to that direction; TURNED + RIM less is its end */
} Zone;

static Zone zone_of(const World *world, Vec3 from, double time, uint32_t emitter)
{
    const float any[2] = {0.5f, 0.5f};
    double none;
    Zone zone = {.centre = light_even_place(world, emitter, time, any, &none),
                 .radius = light_of_emitter(world, emitter)->half_width};
    Vec3 to = vec3_sub(from, zone.centre);
    double distance = vec3_length(to);
    zone.towards = vec3_scale(to, 1 / distance);
    zone.begin = fmin(zone.radius / distance + RIM, 1);
    return zone;
}

static double zone_area(const Zone *zone)
{
    return 2 * MEN_PI * zone->radius * zone->radius * (TURNED + RIM);
}

static Vec3 zone_sample(const Zone *zone, const float u[2])
{
    Vec3f x, y;
    double cosine = zone->begin - (TURNED + RIM) * (double)u[0], sine = sqrt(1 - cosine * cosine),
           turn = 2 * MEN_PI * (double)u[1];
    sampling_basis(vec3f_from(zone->towards), &x, &y);
    Vec3 normal = vec3_along(vec3_scale(zone->towards, cosine), sine * cos(turn), vec3_from_f(x));
    normal = vec3_normalize(vec3_along(normal, sine * sin(turn), vec3_from_f(y)));
    return vec3_along(zone->centre, zone->radius, normal);
}

static double zone_density(const Zone *zone, Vec3 place)
{
    double cosine = vec3_dot(vec3_sub(place, zone->centre), zone->towards) / zone->radius;
    return cosine <= zone->begin && cosine >= zone->begin - (TURNED + RIM) ? 1 / zone_area(zone) : 0;
}

/* ---- one of all ---- */

/* How often one of the ways that hold a place is looked along, where there are some. */
#define ALONG_WAYS 0.75

static uint32_t ways_that_hold(const World *world, Vec3 from)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < world->n_beam_ways; i++) n += beam_way_holds(&world->beam_ways[i], from);
    return n;
}

/* Number `which` of these. */
static const BeamWay *way_that_holds(const World *world, Vec3 from, uint32_t which)
{
    const BeamWay *way = world->beam_ways;
    while (!beam_way_holds(way, from) || which-- > 0) way++;
    return way;
}

/* How dense the places are that a look along a way chooses. */
static double density_along(const World *world, const BeamWay *way, Vec3 from, Vec3 place, double area)
{
    if (!(area > 0)) return 1;
    double middle[2], reach = beam_way_source(way, from, middle);
    if (!(reach > 0)) return 1 / area;
    double at[2];
    beam_lamp_place(&light_of_emitter(world, way->emitter)->to_world, place, at);
    return hypot(at[0] - middle[0], at[1] - middle[1]) <= reach ? 1 / (MEN_PI * reach * reach) : 0;
}

/* A place of one of the beams, by a number in [0, 1). */
static uint32_t sample_beam(const World *world, Vec3 from, double time, double choice, const float u[2],
                            BeamPlace *chosen)
{
    uint32_t n_ways = ways_that_hold(world, from);
    double along = n_ways ? ALONG_WAYS : 0;
    if (choice >= along) {
        double which = (choice - along) / (1 - along) * world->n_beams;
        uint32_t beam = (uint32_t)which;
        if (which - beam >= (double)world->beam_looks[beam]) return EMITTER_NONE;
        chosen->place = light_even_place(world, world->beams[beam], time, u, &chosen->area);
        return world->beams[beam];
    }
    const BeamWay *way = way_that_holds(world, from, (uint32_t)(choice / along * n_ways));
    if (way->route.mirrored) chosen->mirrored = way;
    chosen->place = light_even_place(world, way->emitter, time, u, &chosen->area);
    double middle[2], reach = beam_way_source(way, from, middle);
    if (!(chosen->area > 0) || !(reach > 0)) return way->emitter;
    const Affine *to_world = &light_of_emitter(world, way->emitter)->to_world;
    float x, z;
    sampling_disc(u[0], u[1], &x, &z);
    chosen->place = affine_point(to_world, vec3(middle[0] + reach * (double)x, 0, middle[1] + reach * (double)z));
    return way->emitter;
}

/* How often looks are at beams, and not at balls. */
static double part_of_beams(const World *world)
{
    return world->n_balls ? 1 - AT_BALLS : 1;
}

uint32_t beams_sample(const World *world, Vec3 from, double time, uint32_t digits, const float u[2], BeamPlace *chosen)
{
    chosen->mirrored = NULL;
    double choice = (double)digits * 0x1p-32, at_balls = 1 - part_of_beams(world);
    if (choice < at_balls) {
        uint32_t emitter = world->balls[(uint32_t)(choice / at_balls * world->n_balls)];
        Zone zone = zone_of(world, from, time, emitter);
        chosen->area = zone_area(&zone);
        chosen->place = zone_sample(&zone, u);
        return emitter;
    }
    if (!world->n_beams) return EMITTER_NONE;
    return sample_beam(world, from, time, (choice - at_balls) / (1 - at_balls), u, chosen);
}

double beams_density(const World *world, Vec3 from, uint32_t emitter, Vec3 place, double time)
{
    if (light_of_emitter(world, emitter)->kind == LIGHT_SPHERE) {
        Zone zone = zone_of(world, from, time, emitter);
        return AT_BALLS * zone_density(&zone, place) / world->n_balls;
    }
    double area = light_even_area(world, emitter, time), sum = 0;
    uint32_t n_ways = ways_that_hold(world, from);
    for (uint32_t i = 0; i < world->n_beam_ways && n_ways; i++) {
        const BeamWay *way = &world->beam_ways[i];
        if (way->emitter == emitter && !way->route.mirrored && beam_way_holds(way, from))
            sum += density_along(world, way, from, place, area) / n_ways;
    }
    double looks = (double)world->beam_looks[find_among(world->beams, world->n_beams, emitter)];
    double along = n_ways ? ALONG_WAYS : 0, even = looks / ((area > 0 ? area : 1) * world->n_beams);
    return part_of_beams(world) * (along * sum + (1 - along) * even);
}

double beams_density_mirrored(const World *world, Vec3 from, const BeamWay *way, Vec3 place, double time)
{
    double area = light_even_area(world, way->emitter, time);
    return part_of_beams(world) * ALONG_WAYS / ways_that_hold(world, from) *
           density_along(world, way, from, place, area);
}

const BeamWay *beams_find_mirrored(const World *world, Vec3 from, uint32_t emitter, uint64_t steps)
{
    for (uint32_t i = 0; i < world->n_beam_ways; i++) {
        const BeamWay *way = &world->beam_ways[i];
        if (way->route.mirrored && way->emitter == emitter && way->route.steps == steps && beam_way_holds(way, from))
            return way;
    }
    return NULL;
}
