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

static bool comes_to_one(const SceneLight *light, const Box3 *boxes, uint32_t n)
{
    bool comes = false;
    for (uint32_t i = 0; i < n && !comes; i++)
        comes = comes_to_ball(light, box3_centre(boxes[i]), 0.5 * vec3_length(vec3_sub(boxes[i].max, boxes[i].min)));
    return comes;
}

/* The cosine of half of the cone of lamps whose ways tell all that can be told of them behind prisms. */
#define KNOWN_BY_WAYS 0.999

/* How often a lamp is looked at of the times when it is chosen, before anything is known of its ways; less than 0: it is no beam.
 * Of prisms, looks that go straight know nothing; of narrow lamps, ways do. */
static float looks_of(const World *world, const SceneLight *light)
{
    if (light->kind != LIGHT_POINT && !light_is_focused(light)) return -1;
    const bool may_move = world->scene->n_keys > 0;
    if (world->slabs.n_boxes && (may_move || comes_to_one(light, world->slabs.boxes, world->slabs.n_boxes))) return 1;
    bool comes = !may_move && light->cos_none >= KNOWN_BY_WAYS &&
                 comes_to_one(light, world->slabs.basins, world->slabs.n_basins);
    return comes ? 0 : -1;
}

Status beams_find(World *world, Error *error)
{
    const EmitterSet *set = &world->emitters;
    world->n_beams = world->n_balls = 0;
    if (world->slabs.n_boxes + world->slabs.n_basins == 0 || !set->n) return STATUS_OK;
    world->beams = malloc(2 * set->n * sizeof *world->beams);
    world->beam_looks = malloc(set->n * sizeof *world->beam_looks);
    if (!world->beams || !world->beam_looks) return fail_memory(error, set->n * sizeof *world->beams, "lights");
    world->balls = world->beams + set->n;
    for (uint32_t i = 0; i < set->n; i++) {
        if (set->emitters[i].kind != EMITTER_LIGHT) continue;
        const SceneLight *light = &world->scene->lights[set->emitters[i].of];
        float looks = looks_of(world, light);
        if (light->kind == LIGHT_SPHERE && world->slabs.n_boxes) world->balls[world->n_balls++] = i;
        if (looks < 0) continue;
        world->beam_looks[world->n_beams] = looks;
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
/* The sine of how far light is turned at most that comes to a ball by faces, where looks are to find it; and what they find
 * besides of what is seen straight, at its rim. */
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

/* How often looks are at any beam, where there are ways that hold the place; beams that are known by their ways need none. */
#define BESIDE_WAYS 0.25

/* Whether a way holds a place from which looks may go along it. */
static bool is_around(const BeamWay *way, Vec3 from, bool in_air)
{
    return !(in_air && way->fans_out) && beam_way_holds(way, from);
}

/* Ways around a place are looked along by the light that goes there: the sum of that. */
static double power_around(const World *world, Vec3 from, bool in_air)
{
    double power = 0;
    for (uint32_t i = 0; i < world->n_beam_ways; i++)
        if (is_around(&world->beam_ways[i], from, in_air)) power += (double)world->beam_ways[i].power;
    return power;
}

/* The one of these by a number from 0 up to, but without, that sum. */
static const BeamWay *way_around(const World *world, Vec3 from, bool in_air, double number)
{
    const BeamWay *last = NULL;
    for (uint32_t i = 0; i < world->n_beam_ways && number >= 0; i++) {
        if (!is_around(&world->beam_ways[i], from, in_air)) continue;
        last = &world->beam_ways[i];
        number -= (double)last->power;
    }
    return last;
}

/* How often looks are along one of them. */
static double part_along(const World *world, double power)
{
    return power > 0 ? 1 - BESIDE_WAYS * (double)world->mean_beam_looks : 0;
}

/* How often a look is at a beam, wherever, of those that begin with it. */
static double part_beside(const World *world, uint32_t beam, double power)
{
    return (power > 0 ? BESIDE_WAYS : 1) * (double)world->beam_looks[beam];
}

/* The part of a flat lamp, along its axes, from which light comes along a way to a place. */
typedef struct Window {
    double low[2], high[2];
} Window;
/* How often a look along a way is at the whole lamp: what the rays by which the way is known have missed. */
#define AT_WHOLE 0.05

/* False: it is no smaller than the lamp, or not known. */
static bool find_window(const World *world, const BeamWay *way, Vec3 from, double area, Window *window)
{
    const SceneLight *light = light_of_emitter(world, way->emitter);
    const double half[2] = {light->half_width, light->kind == LIGHT_DISC ? light->half_width : light->half_height};
    double middle[2], reach[2], size = 1;
    beam_way_source(way, from, middle, reach);
    for (int i = 0; i < 2; i++) {
        window->low[i] = fmax(middle[i] - reach[i], -half[i]);
        window->high[i] = fmin(middle[i] + reach[i], half[i]);
        size *= fmax(window->high[i] - window->low[i], 0);
    }
    return size > 0 && size < area;
}

/* How dense the places are that a look along a way chooses. */
static double density_along(const World *world, const BeamWay *way, Vec3 from, Vec3 place, double area)
{
    Window window;
    if (!(area > 0)) return 1;
    if (!find_window(world, way, from, area, &window)) return 1 / area;
    double at[2], density = 1 - AT_WHOLE;
    beam_lamp_place(&light_of_emitter(world, way->emitter)->to_world, place, at);
    for (int i = 0; i < 2; i++) {
        bool within = at[i] >= window.low[i] && at[i] <= window.high[i];
        density = within ? density / (window.high[i] - window.low[i]) : 0;
    }
    return density + AT_WHOLE / area;
}

/* One of these. */
static void sample_along(const World *world, const BeamWay *way, Vec3 from, double time, const float u[2],
                         BeamPlace *chosen)
{
    Window window;
    chosen->area = light_even_area(world, way->emitter, time);
    const bool known = chosen->area > 0 && find_window(world, way, from, chosen->area, &window);
    if (!known || u[0] < (float)AT_WHOLE) {
        const float whole[2] = {known ? u[0] / (float)AT_WHOLE : u[0], u[1]};
        chosen->place = light_even_place(world, way->emitter, time, whole, &chosen->area);
        return;
    }
    const double part[2] = {((double)u[0] - AT_WHOLE) / (1 - AT_WHOLE), (double)u[1]};
    double at[2];
    for (int i = 0; i < 2; i++) at[i] = window.low[i] + part[i] * (window.high[i] - window.low[i]);
    chosen->place = affine_point(&light_of_emitter(world, way->emitter)->to_world, vec3(at[0], 0, at[1]));
}

/* A place of one of the beams, by a number in [0, 1); EMITTER_NONE: none this time. */
static uint32_t sample_beam(const World *world, Vec3 from, bool in_air, double time, double choice, const float u[2],
                            BeamPlace *chosen)
{
    const double power = power_around(world, from, in_air), which = choice * world->n_beams;
    const uint32_t beam = (uint32_t)which;
    const double rest = which - beam, beside = part_beside(world, beam, power);
    if (rest < beside) {
        chosen->place = light_even_place(world, world->beams[beam], time, u, &chosen->area);
        return world->beams[beam];
    }
    if (!(power > 0)) return EMITTER_NONE;
    const BeamWay *way = way_around(world, from, in_air, (rest - beside) / (1 - beside) * power);
    if (way->by_route) chosen->way = way;
    sample_along(world, way, from, time, u, chosen);
    return way->emitter;
}

/* How often looks are at beams, and not at balls. */
static double part_of_beams(const World *world)
{
    return world->n_balls ? 1 - AT_BALLS : 1;
}

uint32_t beams_sample(const World *world, Vec3 from, bool in_air, double time, uint32_t digits, const float u[2],
                      BeamPlace *chosen)
{
    chosen->way = NULL;
    double choice = (double)digits * 0x1p-32, at_balls = 1 - part_of_beams(world);
    if (choice < at_balls) {
        uint32_t emitter = world->balls[(uint32_t)(choice / at_balls * world->n_balls)];
        Zone zone = zone_of(world, from, time, emitter);
        chosen->area = zone_area(&zone);
        chosen->place = zone_sample(&zone, u);
        return emitter;
    }
    if (!world->n_beams) return EMITTER_NONE;
    return sample_beam(world, from, in_air, time, (choice - at_balls) / (1 - at_balls), u, chosen);
}

double beams_density(const World *world, Vec3 from, bool in_air, uint32_t emitter, Vec3 place, double time)
{
    if (light_of_emitter(world, emitter)->kind == LIGHT_SPHERE) {
        Zone zone = zone_of(world, from, time, emitter);
        return AT_BALLS * zone_density(&zone, place) / world->n_balls;
    }
    double area = light_even_area(world, emitter, time), sum = 0;
    const double power = power_around(world, from, in_air);
    for (uint32_t i = 0; i < world->n_beam_ways && power > 0; i++) {
        const BeamWay *way = &world->beam_ways[i];
        if (way->emitter == emitter && !way->by_route && is_around(way, from, in_air))
            sum += (double)way->power / power * density_along(world, way, from, place, area);
    }
    uint32_t beam = find_among(world->beams, world->n_beams, emitter);
    double even = part_beside(world, beam, power) / ((area > 0 ? area : 1) * world->n_beams);
    return part_of_beams(world) * (part_along(world, power) * sum + even);
}

double beams_density_by_route(const World *world, Vec3 from, bool in_air, const BeamWay *way, Vec3 place, double time)
{
    double power = power_around(world, from, in_air), area = light_even_area(world, way->emitter, time);
    return part_of_beams(world) * part_along(world, power) * (double)way->power / power *
           density_along(world, way, from, place, area);
}

const BeamWay *beams_find_route(const World *world, Vec3 from, bool in_air, uint32_t emitter, uint64_t steps)
{
    for (uint32_t i = 0; i < world->n_beam_ways; i++) {
        const BeamWay *way = &world->beam_ways[i];
        if (way->by_route && way->emitter == emitter && way->route.steps == steps && is_around(way, from, in_air))
            return way;
    }
    return NULL;
}
