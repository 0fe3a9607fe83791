/* outline.h - what a turned profile becomes before it is a solid: a closed outline in the half plane (r, y) of straight
 * edges and arcs, walked counter-clockwise (r to the right, y up), the solid on the left. An arc stands in the outline
 * as a run of short edges, for the search for crossings, and becomes one piece in the end, exactly round. Private to
 * lathe.c and curve.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OUTLINE_H
#define MEN_OUTLINE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "shape/piece.h"

enum { OUTLINE_MAX_EDGES = 200000 };

/* A direction in the half plane. */
typedef struct Dir2 {
    double r, y;
} Dir2;

/* An arc of the outline that goes up or down all along. */
typedef struct Arc {
    Dir2 centre;
    bool outer; /* farther from the axis than its centre */
} Arc;

/* A point of the outline, after rounding. normal_in is the shading normal of the edge that ends here,
 * normal_out of the one that starts here; `given` says that an arc prescribes it. */
typedef struct OutlinePoint {
    double r, y;
    Dir2 normal_in, normal_out;
    bool given_in, given_out;
    uint32_t source;
    uint32_t arc; /* that the edge from here is a part of; 0: it is straight */
    bool closes;  /* the edge from here is of what joins the profile's last point to its first */
} OutlinePoint;

typedef struct Outline {
    OutlinePoint *points;
    size_t n, capacity;
    Arc *arcs; /* number 0 is none */
    size_t n_arcs, arcs_capacity;
} Outline;

static inline Dir2 dir2_between(double r0, double y0, double r1, double y1)
{
    double length = hypot(r1 - r0, y1 - y0);
    return (Dir2){(r1 - r0) / length, (y1 - y0) / length};
}

/* With the solid on the left, outside is on the right. */
static inline Dir2 dir2_outward(Dir2 along)
{
    return (Dir2){along.y, -along.r};
}

/* The angle from a to b, in (-pi, pi], positive to the left. */
static inline double dir2_turn(Dir2 a, Dir2 b)
{
    return atan2(a.r * b.y - a.y * b.r, a.r * b.r + a.y * b.y);
}

void outline_clear(Outline *outline); /* frees */
/* NULL when memory ends. */
OutlinePoint *outline_add_point(Outline *outline, double r, double y, uint32_t source);
/* An arc from `start` on about a centre, without its last point. Its outward normals go from the angle `from` by
 * `turned` (positive to the left); side is the radius, negative where the solid is outside of the circle. */
ATTR_NODISCARD bool outline_add_arc(Outline *outline, Dir2 start, Dir2 centre, double side, double from, double turned,
                                    uint32_t source);
/* Gives an outline point both normals. */
void outline_give_normal(OutlinePoint *point, Dir2 normal);
/* Checks for crossings, sets the normals that no arc has given, and makes the pieces. smooth_all: as solid_make_lathe.
 */
ATTR_NODISCARD Status outline_finish(Outline *outline, bool smooth_all, Solid **solid, Error *error);

#endif
