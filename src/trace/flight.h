/* flight.h - how far a path goes through media before it is scattered, what is left of light on its way, and what media
 * give off along it; private to src/trace.
 *
 * A medium that is the same everywhere takes the short way: the hero's scattering is sampled, absorption is a weight,
 * and a straight ray's transmittance has a closed form (flight_even, flight_depth). Media that vary, shine or mix are
 * flown through piece by piece (flight_uneven, flight_transmit): see flight.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FLIGHT_H
#define MEN_FLIGHT_H

#include "trace/path_parts.h"

/* A flight from one event to the next, through any number of silent crossings. What is sampled never ends a path. */
typedef struct FreeFlight {
    /* of the rate of collisions, over the way, that is left; INFINITY where nothing scatters; below 0 before it is drawn, in the
     * first medium that asks for it */
    float budget;
    Lanes scattered, absorbed; /* optical depths used up so far, of every lane, that beta and ratio do not have yet */
    Lanes coefficient;         /* of every lane, of the medium where the path was scattered, at that place */
    uint32_t key, n_drawn;     /* of the flight's own random numbers */
} FreeFlight;

/* A stretch of a flight, for looking for the light that is scattered on it. */
typedef struct FlightStretch {
    const FreeFlight *flight;
    uint32_t medium; /* that owns the places there */
    bool uneven;     /* as flight_is_uneven says */
    uint32_t number; /* of the stretches of this flight */
} FlightStretch;

/* Draws how far. */
void flight_draw(Path *path, FreeFlight *flight);
static inline void flight_begin(Path *path, FreeFlight *flight)
{
    const World *world = path->tracer->world;
    flight->budget = UNLIKELY(world->scatters || world->media.vary) && !path->straight ? -1 : INFINITY;
    flight->scattered = flight->absorbed = flight->coefficient = lanes_all(0);
    flight->key = flight->n_drawn = 0;
}
/* What a crystal absorbs along the path's ray, if it absorbs so much of ordinary light. */
Lanes flight_pleochroic(const Path *path, const SceneMedium *medium, Lanes ordinary);
/* What a medium absorbs of the path's wavelengths; zero where it does not. */
static inline Lanes flight_absorption(Path *path, uint32_t medium)
{
    const World *world = path->tracer->world;
    const SceneMedium *m = &world->scene->media[medium];
    if (!m->absorbs || world->no_absorption) return lanes_all(0);
    PathMedia *kept = &path->media;
    uint32_t i = medium % PATH_MEDIA;
    if (kept->absorption_of[i] != medium + 1) {
        kept->absorption[i] = spectrum_at(&m->absorption, path->wavelengths.nm);
        kept->absorption_of[i] = medium + 1;
    }
    return LIKELY(!m->pleochroic) ? kept->absorption[i] : flight_pleochroic(path, m, kept->absorption[i]);
}
/* Held finite, so that a wavelength at which nothing happens stays so out to infinity. */
static inline float flight_length(double length)
{
    return length < 1e30 ? (float)length : 1e30f;
}
/* What flight_even does with scattering. */
double flight_scatter_even(FreeFlight *flight, const SceneMedium *medium, double length, Lanes wavelength_nm);
/* Up to `length` through an even medium; returns how far it came: less where it is scattered. */
static inline double flight_even(Path *path, FreeFlight *flight, uint32_t medium, double length)
{
    const SceneMedium *m = &path->tracer->world->scene->media[medium];
    if (!(length > 0)) return length;
    if (m->scatters && UNLIKELY(path->straight)) {
        if (path->for_light)
            flight->absorbed =
                lanes_add(flight->absorbed,
                          lanes_scale(spectrum_at(&m->scattering, path->wavelengths.nm), flight_length(length)));
    } else if (m->scatters) {
        if (flight->budget < 0) flight_draw(path, flight);
        length = flight_scatter_even(flight, m, length, path->wavelengths.nm);
    }
    if (m->absorbs)
        flight->absorbed =
            lanes_add(flight->absorbed, lanes_scale(flight_absorption(path, medium), flight_length(length)));
    return length;
}
/* The same from t = from along the path's ray, through what fills the place where tracer->list holds; *medium becomes
 * what scatters it. What shines on the way is added to the path's radiance. */
double flight_uneven(Path *path, FreeFlight *flight, double from, double length, uint32_t *medium);
/* Whether the way through where a list holds has to be flown as flight_uneven does. */
static inline bool flight_is_uneven(const World *world, const NestList *list, uint32_t medium)
{
    if (LIKELY(!world->media.vary)) return false;
    const NestOrder *order = &world->compiled->order;
    if (world->media.varies[medium]) return true;
    uint32_t i = 0;
    const uint32_t *items = nest_list_items(list);
    while (i < list->n && items[i] >= order->n_hulls) i++;
    return i < list->n && nest_mixes(order, items[i]);
}

/* Optical depth, for what is lost of a straight ray, of a stretch of an even medium. */
Lanes flight_depth(Path *path, uint32_t medium, double length);
/* What is left of a straight ray from t to `to`, through what fills the place where the list holds: an estimate. *n_drawn
 * counts the ray's own random numbers. *scattered (may be NULL): the optical depth of scattering that the least densities
 * come to. Afterwards tracer->parts are at `to`, if anything is left. */
Lanes flight_transmit(Path *path, const Ray *ray, const NestList *list, double t, double to, uint32_t *n_drawn,
                      Lanes *scattered);
/* Goes through the hulls whose media add to one that owns a place; *i: 0 before the first. */
bool flight_next_mixing(const World *world, const NestList *list, uint32_t medium, uint32_t *i, uint32_t *hull);
/* The density of one of them at a t of its present piece. */
static inline float flight_part_density(const FlightPart *part, double t)
{
    return part->walks ? volume_walk_value(&part->walk, t) : 1;
}
/* Adds light, as basic radiance, with what beta and ratio have yet to be given of the flight. */
void flight_add_light(Path *path, const FreeFlight *flight, Lanes basic, uint32_t group);

static inline Lanes flight_attenuation(Lanes depth)
{
    return lanes_zero(depth) ? lanes_all(1) : lanes_exp(lanes_sub(lanes_all(0), depth));
}

/* By how much the lanes are scattered more, or less, than the hero. */
static inline Lanes flight_lane_factor(const FreeFlight *flight)
{
    return flight_attenuation(lanes_sub(flight->scattered, lanes_all(lanes_get(flight->scattered, 0))));
}

/* What flight_end does with scattering. */
void flight_weigh(Path *path, const FreeFlight *flight, bool even);
/* What the flight has made of the path; `even`: it ended where an even medium scatters. */
static inline void flight_end(Path *path, const FreeFlight *flight, bool even)
{
    path->beta = lanes_mul(path->beta, flight_attenuation(flight->absorbed));
    if (UNLIKELY(path->tracer->world->scatters)) flight_weigh(path, flight, even);
}

#endif
