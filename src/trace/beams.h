/* beams.h - lamps of which looks that go straight choose nothing from places that they light by a bent way.
 *
 * Outside of a spot's cone there is nothing to be chosen of it, nor below the horizon of a surface. But through a pane that is
 * tilted, or into still water, light comes to such places; a point is never found by chance, and what is flat and shines into a
 * narrow cone hardly ever. Of a ball another part is seen by a bent way than straight: a crescent, some hundredths of all, would be
 * found by chance alone, and what is at its rim straight, and in its midst by the bent way, would count without limit. Looks through
 * flat faces (slab_lamp.h) try one of these, too: of beams they count where no straight look would have chosen the place that they
 * find, of balls everywhere, weighed against straight ones.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BEAMS_H
#define MEN_BEAMS_H

#include "trace/beam_ways.h"

/* Sets world->beams, lamps without size and those that are flat and shine into a cone, which may come straight to a slab, pencils of
 * light that may come to a prism, and world->balls. World's lights and slabs are to be known. STATUS_NOMEM. */
ATTR_NODISCARD Status beams_find(World *world, Error *error);
/* Whether an emitter is one of these. */
bool beams_have(const World *world, uint32_t emitter);
/* What a look is sent to. */
typedef struct BeamPlace {
    Vec3 place;
    double area;        /* all that such places are chosen from; 0 of what has no size */
    const BeamWay *way; /* NULL, or one by whose route light comes from there, as the look is to go */
} BeamPlace;

/* One of them, of which there are some, or EMITTER_NONE: none this time; and a place on it, to be looked at from a place. Where
 * that is within the way of a narrow beam (beam_ways.h), that one mostly, and where its light comes from. in_air: the place is on
 * no surface. digits: 32 of a number in [0, 1), u: in [0, 1). */
uint32_t beams_sample(const World *world, Vec3 from, bool in_air, double time, uint32_t digits, const float u[2],
                      BeamPlace *chosen);
/* The density of that per area of the lamp, the choice included; of what has no size, of the choice alone. Of looks that go
 * straight; */
double beams_density(const World *world, Vec3 from, bool in_air, uint32_t emitter, Vec3 place, double time);
/* and of those by the route of a way, which holds the place. */
double beams_density_by_route(const World *world, Vec3 from, bool in_air, const BeamWay *way, Vec3 place, double time);
/* The way that holds a place, to which light of a lamp comes by these steps (see slab_step), where looks go by its route; NULL:
 * there is none. */
const BeamWay *beams_find_route(const World *world, Vec3 from, bool in_air, uint32_t emitter, uint64_t steps);

#endif
