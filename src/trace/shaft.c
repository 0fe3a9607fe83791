/* shaft.c - see shaft.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/shaft.h"

#include "optics/sampling.h"
#include "trace/airlight.h"

/* Stretches of paths that media have scattered more often are not looked at: there are many of them, of little light each. */
#define MOST_SCATTERED 1
/* Nor are those through which less than this part of all flights comes: flights are scattered often enough there. */
#define LEAST_ALONE 0.05f

/* The stretch within a guide's cell that was chosen so far, and what the cells have to scatter on all of it. */
typedef struct Shaft {
    const GuideCell *cell;
    double begin, end;
    double all; /* of all cells so far */
    double u;   /* uniform in [0, 1): what the choice has left of its number */
} Shaft;

static void consider(void *context, const GuideCell *cell, double begin, double end)
{
    Shaft *shaft = context;
    double amount = (double)cell->scattered * (end - begin);
    if (!(amount > 0)) return;
    shaft->all += amount;
    double part = amount / shaft->all;
    if (shaft->u < part) {
        shaft->cell = cell;
        shaft->begin = begin;
        shaft->end = end;
        shaft->u /= part;
    } else {
        shaft->u = (shaft->u - part) / (1 - part);
    }
}

static uint32_t dimension(const Path *path, uint32_t number, uint32_t which)
{
    return DIM_SHAFTS + 2 * airlight_stretch(path, number) + which;
}

/* What is at the place in front of the path: the coefficient of what scatters it, and what comes to there of what the path carries.
 * Of several media one is chosen, each as often. False: nothing scatters there. */
typedef struct ShaftPlace {
    const Phase *phase;
    Lanes coefficient, depth, left; /* depth: as in airlight.h, of what flights are sure to be scattered by */
    uint32_t n_media;
} ShaftPlace;

static bool look_at_place(Path *path, uint32_t medium, bool uneven, double t, float which, ShaftPlace *place)
{
    Tracer *tracer = path->tracer;
    const Airway *way = &path->way;
    if (!uneven) {
        const SceneMedium *m = &tracer->world->scene->media[medium];
        place->phase = &m->phase;
        place->n_media = 1;
        place->coefficient = spectrum_at(&m->scattering, path->wavelengths.nm);
        place->depth = lanes_scale(place->coefficient, flight_length(t - way->begin));
        place->left = flight_attenuation(flight_depth(path, medium, t - way->begin));
        return true;
    }
    uint32_t n_drawn = 1U << 31; /* numbers of its own */
    place->left = flight_transmit(path, &path->ray, &tracer->list, way->begin, t, &n_drawn, &place->depth);
    place->n_media = (uint32_t)tracer->parts.n;
    if (lanes_zero(place->left) || !place->n_media) return false;
    uint32_t i = (uint32_t)(which * (float)place->n_media);
    const FlightPart *part = &tracer->parts.items[i < place->n_media ? i : place->n_media - 1];
    place->phase = &part->medium->phase;
    place->coefficient = lanes_scale(part->scattering, flight_part_density(part, t));
    return !lanes_zero(place->coefficient);
}

/* The path becomes as if it had been scattered at the place, a probe is sent, and it becomes what it was. */
static void send_from(Path *path, const FreeFlight *flight, const ShaftPlace *place, GuideAt *guide, double t,
                      Vec3f direction, uint32_t number)
{
    enum { LOOKS = 1 << 21 }; /* its random numbers are not those of the path's own events and probes */
    const Lanes beta = path->beta, ratio = path->ratio;
    const uint32_t bounce = path->bounce;
    float density = airlight_flight_density(&path->way, place->coefficient, place->depth);
    if (!(density > 0)) return;
    Lanes arrived = lanes_mul(place->left, flight_attenuation(flight->absorbed));
    path->beta = lanes_mul(path->beta, lanes_mul(flight_lane_factor(flight), arrived));
    path->beta = lanes_mul(path->beta, lanes_scale(place->coefficient, 1 / density));
    path->ratio = path->way.ratio;
    path->bounce = LOOKS + airlight_stretch(path, number);
    guide->share += path->way.shaft * guide->cell->scattered / (density * (float)place->n_media) * guide->cell->share;
    float pdf = phase_evaluate(place->phase, vec3f_dot(path->ray.direction, direction));
    path_send_probe(path, guide, NULL, false, ray_point(&path->ray, t), direction, lanes_all(pdf), pdf);
    path->beta = beta;
    path->ratio = ratio;
    path->bounce = bounce;
}

void shaft_look(Path *path, const FreeFlight *flight, uint32_t medium, bool uneven, uint32_t number)
{
    Tracer *tracer = path->tracer;
    Airway *way = &path->way;
    const Guide *guide = tracer->world->guide;
    if (!guide || path->probing.is_probe || path->n_scattered > MOST_SCATTERED || way->alone < LEAST_ALONE) return;
    float u[2], v[2];
    Shaft shaft = {.u = (double)sampler_3d(&path->sampler, dimension(path, number, 0), u) * 0x1p-32};
    guide_walk(guide, way->origin, vec3_from_f(way->direction), way->begin, way->end, consider, &shaft);
    if (!(shaft.all > 0)) return;
    float part = way->carried * way->alone / (float)(1 + path->n_scattered);
    way->shaft = part / (float)shaft.all;
    if (!(way->shaft > 0) || !isfinite(way->shaft)) {
        way->shaft = 0;
        return;
    }
    double t = airlight_off_ends(path, shaft.begin + (double)u[0] * (shaft.end - shaft.begin));
    GuideAt at = guide_find(guide, ray_point(&path->ray, t));
    if (at.cell != shaft.cell) return;
    if (UNLIKELY(tracer->ledger) && at.share > 0 && !path->again) guide_note(tracer->ledger, &at, GUIDE_VISIT, part, 0);
    float often = at.share * part;
    if (u[1] >= often) return;
    u[1] /= often;
    ShaftPlace place;
    sampler_2d(&path->sampler, dimension(path, number, 1), v);
    if (!look_at_place(path, medium, uneven, t, u[1], &place)) return;
    if (place.n_media > 1) u[1] = u[1] * (float)place.n_media - floorf(u[1] * (float)place.n_media);
    Vec3f direction = guide_sample(&at, float_min(u[1], 0x1.fffffep-1f), v);
    at.share *= path_probe_part(path, way, true); /* of the probes of a flight that is scattered there */
    if (!path_turn_aside(tracer, &t)) {
        tracer->out_of_memory = true;
        return;
    }
    send_from(path, flight, &place, &at, t, direction, number);
    path_turn_back(tracer);
}

float shaft_rival(const Path *path, const GuideAt *guide)
{
    const Airway *way = &path->from;
    if (!(way->rarity > 0) || !(way->shaft > 0) || !guide->cell) return 0;
    return way->rarity * way->shaft * guide->cell->scattered * guide->cell->share / (float)way->n_media;
}
