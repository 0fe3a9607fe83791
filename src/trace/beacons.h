/* beacons.h - what stands out in a scene by its light: lamps, and the bright parts of an environment.
 *
 * At a smooth boundary a path is reflected or refracted. Chosen as often as the boundary reflects, a lamp that is mirrored
 * by four parts in a hundred is met by four paths in a hundred, each of them twenty-five times too bright. Where one of
 * the two ways leads to a lamp, that way is better chosen in proportion to the light that it brings ([Veach97] 2.4.2).
 * What lies behind further boundaries is not known; but walls of glass are mostly as thick on one side as on the other,
 * and through such a wall light goes on in the direction in which it came.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BEACONS_H
#define MEN_BEACONS_H

#include "base/lanes.h"
#include "scene/compile.h"

/* Four lamps that are flat, or round; brightness in multiples of the backdrop, 1: none. Those that are infinitely far are as
 * round ones at distance 1 from wherever a path is. */
typedef struct FlatBeacons {
    Lanes ball[3], ball_radius;  /* around each: most lines miss it; radius 0: no lamp */
    Lanes normal[3], height;     /* of the plane: a place on it, times the normal */
    Lanes side[2][3], middle[2]; /* coordinates on the lamp, -1 .. 1 */
    Lanes is_disc, brightness;
} FlatBeacons;
typedef struct RoundBeacons {
    Lanes centre[3], is_near, radius2, brightness;
} RoundBeacons;

enum { BEACON_GROUPS = 4, BEACON_MAP = 32 };

/* The lamps that give most light to the middle of the scene's clear objects: 4 BEACON_GROUPS flat ones, and as many round
 * ones. Left out, and found as often as boundaries reflect: others, lamps that move, objects whose surface shines. */
typedef struct Beacons {
    bool any;
    double mean,
        backdrop; /* luminance around what is clear; and, as a part of that, where no lamp stands: see backdrop.h */
    uint32_t n_flat, n_round; /* groups */
    FlatBeacons flat[BEACON_GROUPS];
    RoundBeacons round[BEACON_GROUPS];
    bool has_map;
    float map[BEACON_MAP][BEACON_MAP]; /* of an environment that is not even: brightness, by octahedral directions */
} Beacons;

/* Lights and environment of a scene that has been compiled. backdrop: > 0; 1 where it is not known. */
void beacons_find(const CompiledScene *compiled, double backdrop, Beacons *beacons);

/* How much brighter it is from a place in the direction along + up (unit), and along - up, than where no lamp stands: at least
 * 1. Whatever stands in between. */
void beacons_look(const Beacons *beacons, Vec3f place, Vec3f along, Vec3f up, float brightness[2]);

#endif
