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
    float budget; /* of the rate of collisions, over the way, that is left; INFINITY where nothing scatters */
    Lanes scattered, absorbed; /* optical depths used up so far, of every lane, that beta and ratio do not have yet */
    Lanes coefficient;         /* of every lane, of an even medium where the path was scattered */
    uint32_t key, n_drawn;     /* of the flight's own random numbers */
} FreeFlight;

FreeFlight flight_begin(Path *path);
/* Up to `length` through an even medium; returns how far it came: less where it is scattered. */
double flight_even(FreeFlight *flight, const World *world, uint32_t medium, double length, Lanes wavelength_nm);
/* The same from t = from along the path's ray, through what fills the place where tracer->list holds; *medium becomes
 * what scatters it. What shines on the way is added to the path's radiance. */
double flight_uneven(Path *path, FreeFlight *flight, double from, double length, uint32_t *medium);
/* What the flight has made of the path; `even`: it ended where an even medium scatters. */
void flight_end(Path *path, const FreeFlight *flight, bool even);

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
Lanes flight_depth(const World *world, uint32_t medium, double length, Lanes wavelength_nm);
/* What is left of a straight ray from t to `to`, through what fills the place where the list holds: an estimate. *n_drawn
 * counts the ray's own random numbers. */
Lanes flight_transmit(const Path *path, const Ray *ray, const NestList *list, double t, double to, uint32_t *n_drawn);

static inline Lanes flight_attenuation(Lanes depth)
{
    return lanes_zero(depth) ? lanes_all(1) : lanes_exp(lanes_sub(lanes_all(0), depth));
}

#endif
