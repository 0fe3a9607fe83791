/* polygon.h - areas in a plane that are bounded by closed loops: crossings, what is inside, triangles.
 * All decisions are exact (mesh/exact.h), so that no outline, however thin, makes an open or folded result.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_POLYGON_H
#define MEN_POLYGON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "mesh/exact.h"

/* A corner of a loop, with the directions in which the curve comes to it and goes on (unit; where these are not
 * opposite sides of a sharp corner they are equal). source: the number of the point that it was made from. */
typedef struct OutlinePoint2 {
    Point2 at, arrive, leave;
    uint32_t source;
} OutlinePoint2;

/* Loops one behind the other: loop i ends before point loop_ends[i]. Owns its arrays; begun zeroed. */
typedef struct Outline2 {
    OutlinePoint2 *points;
    size_t n_points, points_capacity;
    size_t *loop_ends;
    size_t n_loops, loops_capacity;
} Outline2;

void outline2_clear(Outline2 *outline);
/* false when memory ends */
ATTR_NODISCARD bool outline2_add_point(Outline2 *outline, const OutlinePoint2 *point);
ATTR_NODISCARD bool outline2_end_loop(Outline2 *outline);

typedef enum FillRule { FILL_EVEN_ODD, FILL_NONZERO } FillRule;

/* Two edges that meet elsewhere than at common ends, by the points that they begin at. */
typedef struct Crossing2 {
    bool found;
    Point2 at;
    size_t one, other;
} Crossing2;

enum { POLYGON_MAX_POINTS = 2000000 };

/* The first crossing found, if any. STATUS_SCENE when that takes too long to say. */
ATTR_NODISCARD Status polygon_find_crossing(const Outline2 *outline, Crossing2 *crossing, Error *error);

/* Replaces the loops by those that bound the inside, each with the inside on its left, without edges of length 0.
 * With FILL_EVEN_ODD the edges must not cross (polygon_find_crossing); with FILL_NONZERO overlapping loops are
 * united: edges are split where they cross, and new corners are rounded to a 2^-40th of the outline's size. An empty
 * result is no error. */
ATTR_NODISCARD Status polygon_clean(Outline2 *outline, FillRule rule, Error *error);

/* Triangles that cover the inside of loops that do not cross and have the inside on their left (polygon_clean).
 * Each edge belongs to one triangle, counter-clockwise; corners are numbers of points. *triangles is malloc'd. */
ATTR_NODISCARD Status polygon_triangulate(const Outline2 *outline, uint32_t (**triangles)[3], size_t *n_triangles,
                                          Error *error);

#endif
