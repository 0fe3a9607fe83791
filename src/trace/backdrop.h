/* backdrop.h - how bright it is where no lamp stands, seen from a scene's clear surfaces.
 *
 * Where one of a boundary's two ways leads to a lamp, how often it is to be chosen depends on what the other one brings ([Veach97]
 * 2.4.2: in proportion to the root of the mean square). Before a black cloth that is a hundredth of the mean brightness all
 * around, before a white wall more than that; and what goes into thick glass may be bent towards a lamp after all. So a few of the
 * camera's paths are followed, and tell what they found behind the first surface neither of whose ways led to a lamp.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BACKDROP_H
#define MEN_BACKDROP_H

#include "trace/path_parts.h"

/* What a tracer's paths tell. */
typedef struct Backdrop {
    bool noted;            /* the present path has come to such a surface, */
    Lanes before, carried; /* with so much light, and carrying so much of what comes */
    double unit, squares;  /* luminance; and the sum, in squares of that unit, of what so many found */
    uint32_t n;
} Backdrop;

/* A path that may end at a lamp or not is at a surface; and has ended. The second path of a sample does not count. */
void backdrop_note(Backdrop *backdrop, const Path *path, const float brightness[2]);
void backdrop_end(Backdrop *backdrop, const Path *path);

/* The root of the mean square, as a part of the mean luminance around what is clear: 1 where it is more, or not known; not less
 * than a sixteenth. The world is complete but for a guide, and its beacons were found without this. STATUS_NOMEM. */
ATTR_NODISCARD Status backdrop_find(const World *world, double *brightness, Error *error);

#endif
