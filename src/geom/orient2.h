/* orient2.h - on which side of a line a point is, without rounding.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ORIENT2_H
#define MEN_ORIENT2_H

typedef struct Point2 {
    double x, y;
} Point2;

/* The sign (-1, 0, 1) of the area of the triangle a b c: 1 when c is to the left of the line from a to b. Exact for
 * coordinates whose products neither overflow nor underflow (J. R. Shewchuk, "Adaptive Precision Floating-Point
 * Arithmetic and Fast Robust Geometric Predicates", 1997). */
int orient2(Point2 a, Point2 b, Point2 c);

#endif
