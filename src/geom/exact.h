/* exact.h - on which side of a plane or a line a point is, without rounding.
 * For points with float coordinates. A double with a bound on its error decides almost always; what it cannot decide is
 * summed up exactly. J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
 * Predicates", Discrete & Computational Geometry 18 (1997); coordinates of 24 bits make it much shorter.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EXACT_H
#define MEN_EXACT_H

#include "base/vec3.h"

/* 1: d is on the side of the plane abc from which a, b, c are counter-clockwise; -1: on the other; 0: in the plane.
 * All coordinates must be finite. */
int exact_side_of_plane(Vec3f a, Vec3f b, Vec3f c, Vec3f d);
/* 1: a, b, c are counter-clockwise in the plane of two coordinates; -1: clockwise; 0: on a line. */
int exact_turn(const float a[2], const float b[2], const float c[2]);

#endif
