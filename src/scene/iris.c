/* iris.c - the corners of an iris.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/iris.h"

#include <math.h>

#include "base/angle.h"

/* How far chords may be from an arc, of the radius. */
#define CHORD_TOLERANCE 1e-4

/* The edge of one blade about the x axis, where the corners are at distance 1: an arc about <-behind, 0>. */
typedef struct BladeEdge {
    double behind, radius;
    double half; /* of the arc, as an angle */
} BladeEdge;

/* Where the arc has been gone along up to an angle from x. */
typedef struct EdgePoint {
    double angle, x, y;
} EdgePoint;

static EdgePoint edge_at(const BladeEdge *edge, double angle)
{
    return (EdgePoint){angle, edge->radius * cos(angle) - edge->behind, edge->radius * sin(angle)};
}

/* The next point with which the middle and this one make a triangle of that area:
 * x0 r sin(angle) - y0 (r cos(angle) - behind) = 2 area. */
static EdgePoint edge_next(const BladeEdge *edge, const EdgePoint *from, double area)
{
    double sine = (2 * area - from->y * edge->behind) / (edge->radius * hypot(from->x, from->y));
    return edge_at(edge, asin(fmin(fmax(sine, -1), 1)) + atan2(from->y, from->x));
}

/* The area by which n equal triangles reach from end to end. */
static double equal_area(const BladeEdge *edge, uint32_t n)
{
    const EdgePoint first = edge_at(edge, -edge->half);
    double low = 0, high = MEN_PI / n; /* a sector of the circle through the corners is more */
    for (int step = 0; step < 100; step++) {
        double area = 0.5 * (low + high);
        EdgePoint at = first;
        for (uint32_t i = 0; i < n && at.angle < edge->half; i++) {
            EdgePoint next = edge_next(edge, &at, area);
            if (!(next.angle > at.angle)) break;
            at = next;
        }
        *(at.angle < edge->half ? &low : &high) = area;
    }
    return 0.5 * (low + high);
}

const float *iris_corners(Arena *arena, uint32_t blades, double rotation, double roundness, uint32_t *n)
{
    double half = MEN_PI / blades, across = sin(half), bulge = roundness * (1 - cos(half));
    uint32_t chords = (uint32_t)fmax(ceil(sqrt(bulge / CHORD_TOLERANCE)), 1);
    BladeEdge edge = {0};
    double area = 0.5 * sin(2 * half);
    if (chords > 1) {
        edge.radius = (across * across + bulge * bulge) / (2 * bulge);
        edge.behind = edge.radius - cos(half) - bulge;
        edge.half = asin(fmin(across / edge.radius, 1));
        area = equal_area(&edge, chords);
    }
    *n = blades * chords;
    float *corners = ARENA_ARRAY(arena, float, 2 * *n);
    double size = sqrt(MEN_PI / (*n * area));
    EdgePoint at = {-edge.half, cos(half), -across};
    for (uint32_t k = 0; k < chords; k++) {
        for (uint32_t blade = 0; blade < blades; blade++) {
            double turn = rotation + (2 * blade + 1) * half + 0.5 * MEN_PI, c = cos(turn), s = sin(turn);
            float *corner = corners + 2 * (blade * chords + k);
            corner[0] = (float)(size * (c * at.x - s * at.y));
            corner[1] = (float)(size * (s * at.x + c * at.y));
        }
        if (k + 1 < chords) at = edge_next(&edge, &at, area);
    }
    return corners;
}

double iris_reach(const float *corners, uint32_t n)
{
    double reach = 0;
    for (uint32_t i = 0; i < n; i++) reach = fmax(reach, hypot((double)corners[2 * i], (double)corners[2 * i + 1]));
    return reach;
}
