/* polygon_sweep.h - the sweep behind polygon.c; private to src/shape/polygon*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_POLYGON_SWEEP_H
#define MEN_POLYGON_SWEEP_H

#include "shape/polygon.h"

/* An edge between two different places; winding: how often it is walked from `low` to `high`, the other way counted
 * negative. low comes before high in the sweep's order: by y, then by x. */
typedef struct SweepEdge {
    uint32_t low, high;
    int32_t winding;
    bool inside_left, inside_right; /* of the way up; set by the sweep */
} SweepEdge;

typedef struct SweepInput {
    const Point2 *points; /* all different */
    size_t n_points;
    SweepEdge *edges; /* that meet only at common ends, no two with the same ends */
    size_t n_edges;
    FillRule rule;
} SweepInput;

/* Comes before in the sweep. */
static inline bool sweep_before(Point2 a, Point2 b)
{
    return a.y < b.y || (a.y == b.y && a.x < b.x);
}

/* Finds out where the inside is; with triangles (may be NULL), covers it by them. */
ATTR_NODISCARD Status polygon_sweep(const SweepInput *input, uint32_t (**triangles)[3], size_t *n_triangles,
                                    Error *error);

#endif
