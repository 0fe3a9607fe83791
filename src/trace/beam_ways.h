/* beam_ways.h - where narrow beams of light go behind flat faces, so that media which they are seen in are looked at there;
 * private to src/trace.
 *
 * A laser's beam in a tank of cloudy water is a thin line of light: flights (flight.h) are scattered within it hardly ever, looks
 * for lights along the path's way (airlight.h) go straight and end at the glass, and looks through flat faces (slab_lamp.h) find
 * the lamp only from places within the beam. So before the picture some rays of each narrow lamp (beams.h) are followed through
 * all flat faces: each stretch that they go there is one way. Of a stretch of a path that passes near ways a place is chosen by
 * its distance to one of them, and light is looked for there through the faces, as if the path had been scattered there.
 *
 * The same looks are sent where a flight was scattered. With pf(t) the density of flights' places and q b(t) that of these, what
 * either finds counts by its density over pf(t) + q b(t) ([Veach97] 9.2.2, the balance heuristic); so whatever the ways are,
 * right or not, the picture converges to the same.
 *
 * Looks from a place within a way go straight towards the lamp, and come to its faces so (slab_lamp.h). Where the way is mirrored,
 * or turned so far that its faces are not in that line, as behind a prism, they go by the faces that the rays have met.
 *
 * What is mirrored once is a way, too, where that is not too faint. What comes through what is curved is left to photons
 * (shaft.h), and lamps of wide cones to flights.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BEAM_WAYS_H
#define MEN_BEAM_WAYS_H

#include "trace/flight.h"

/* Of more ways the first ones are kept; what others light is found by flights alone. */
enum { BEAM_WAYS_MOST = 128 };

/* A flat face that a beam has come to, and what it did there. */
typedef struct BeamFace {
    Vec3 normal; /* unit; its points p are those of normal . p = offset */
    double offset;
    uint64_t number;                       /* see slabs_face */
    uint32_t medium_before, medium_behind; /* as the beam came */
    bool mirrored;
} BeamFace;

/* Of more faces a beam is not followed. */
enum { BEAM_FACES = 8 };

/* By which faces a beam went, from the lamp on. */
typedef struct BeamRoute {
    BeamFace faces[BEAM_FACES];
    uint32_t n;
    bool mirrored;  /* at one of them */
    uint64_t steps; /* a hash of them: see slab_step */
} BeamRoute;

/* A part of a beam, straight and round. */
typedef struct BeamWay {
    BeamRoute route;
    uint32_t emitter; /* whose it is */
    bool
        by_route; /* looks from it go by its route: it is mirrored, or turned so far that its faces are not in the straight line */
    Vec3 from;     /* on its axis, where it begins */
    Vec3 along;    /* unit */
    Vec3f side[2]; /* and across it */
    double length; /* > 0 */
    bool
        fans_out; /* it is not mirrored, and each wavelength goes another way: photons find it in air, and more than looks do */
    float power;      /* > 0, of the lamp's, what goes there */
    double radius[2]; /* > 0, at its beginning and its end */
    /* From which places of a flat lamp light comes to a place of the way: those up to so far along either axis of the lamp, at
     * the way's beginning and its end, from one that depends on how the place lies across the way, place_mean + slope * (across -
     * across_mean). 0: from anywhere. Places of lamps are told along their x and z axes, in world units. */
    double reach[2][2], place_mean[2], across_mean[2], slope[2][2];
} BeamWay;

/* Sets world->beam_ways. All else of the world is known. STATUS_NOMEM. */
ATTR_NODISCARD Status beam_ways_find(World *world, Error *error);
/* A lamp's place along its x and z axes, as ways have it. */
void beam_lamp_place(const Affine *to_world, Vec3 place, double at[2]);
/* Whether a place is within a way. */
bool beam_way_holds(const BeamWay *way, Vec3 place);
/* The middle of where light comes from to a place there, and how far around that along either axis; 0: from anywhere on the lamp. */
void beam_way_source(const BeamWay *way, Vec3 place, double middle[2], double reach[2]);
/* A look on the stretch, which is path->way, of which all but its shares is set. Keeps in path->way what weights need. */
void beam_ways_look(Path *path, const FlightStretch *stretch);
/* q b(t) / pf(t) where the path was scattered last; 0 where it was not on such a stretch. */
float beam_ways_rival(const Path *path);

#endif
