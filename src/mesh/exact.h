/* exact.h - on which side of a plane or a line a point is, without rounding.
 * A double with a bound on its error decides almost always; what it cannot decide is summed up exactly. J. R. Shewchuk,
 * "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete & Computational Geometry
 * 18 (1997). In space, coordinates of 24 bits make it much shorter.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EXACT_H
#define MEN_EXACT_H

#include "base/vec3.h"

/* 1: d is on the side of the plane abc from which a, b, c are counter-clockwise; -1: on the other; 0: in the plane.
 * For finite coordinates. */
int exact_side_of_plane(Vec3f a, Vec3f b, Vec3f c, Vec3f d);

typedef struct Point2 {
    double x, y;
} Point2;
/* 1: a, b, c are counter-clockwise, so that c is to the left of the line from a to b; -1: clockwise; 0: on a line. For
 * all finite coordinates whose products neither overflow nor underflow; those of floats do not. */
int exact_turn(Point2 a, Point2 b, Point2 c);

/* Whether a line along x through p passes through the triangle abc: 1 where it faces +x, -1 where it faces away, 0 where the
 * line is beside it. *at_edge, otherwise left as it is, is set where that cannot be said: at an edge or a corner, or where the
 * triangle is seen from its side. */
int exact_pierce_along_x(Vec3f a, Vec3f b, Vec3f c, Vec3f p, bool *at_edge);

#endif
