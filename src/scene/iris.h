/* iris.h - the shape of an opening between blades, of which what is out of focus takes its own.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCENE_IRIS_H
#define MEN_SCENE_IRIS_H

#include "base/arena.h"
#include "scene/scene.h"

/* The corners of an iris of at least 3 blades, whose edges are arcs: roundness 0: straight, up to 1: all are parts of one circle.
 * rotation: in radians, counter-clockwise where x points to the right; 0: a corner stands upright. Arcs are made of chords that
 * are within a 10,000th of its radius. Its area is that of the disc of radius 1, and each side makes a triangle of the same area
 * with the middle, as sampling_polygon wants it: x and y of n corners. */
const float *iris_corners(Arena *arena, uint32_t blades, double rotation, double roundness, uint32_t *n);
/* How far the farthest of them is from the middle. */
double iris_reach(const float *corners, uint32_t n);

#endif
