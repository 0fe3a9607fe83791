/* pattern_areas.h - what part of a footprint has which value; private to src/optics/pattern*.c.
 * What has hard edges is averaged over a box of the footprint's width by integrals, along each axis by itself. Extents
 * that the numbers cannot tell apart count as none.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PATTERN_AREAS_H
#define MEN_PATTERN_AREAS_H

#include <math.h>

#include "optics/pattern.h"

static inline double clamp_unit(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}
static inline double fraction(double x)
{
    return x - floor(x);
}
static inline double smooth_step(double t)
{
    t = clamp_unit(t);
    return t * t * (3 - 2 * t);
}

/* The extent of a footprint along an axis: a surface at a right angle to it has none. */
static inline double width_along(const PatternPlace *place, Vec3 axis)
{
    double cosine = vec3_dot(place->normal, axis);
    return place->footprint * sqrt(double_max(0, 1 - cosine * cosine));
}

static inline bool is_extended(double width, double x)
{
    return width > 1e-6 * (1 + fabs(x)) && isfinite(width);
}

static inline void one_part(PatternParts *parts, double value)
{
    parts->n = 1;
    parts->value[0] = value;
    parts->part[0] = 1;
}

static inline void add_part(PatternParts *parts, double value, double part)
{
    if (!(part > 0)) return;
    parts->value[parts->n] = value;
    parts->part[parts->n++] = part;
}

/* `part` of 1, and 0 for the rest */
static inline void two_parts(PatternParts *parts, double part)
{
    add_part(parts, 1, clamp_unit(part));
    add_part(parts, 0, 1 - clamp_unit(part));
}

/* The integral, from 0 on, of what rises from 0 to 1 over a length. */
static inline double rise_integral(double x, double length)
{
    if (!(x > 0)) return 0;
    double t = length > 0 ? fmin(x / length, 1) : 1;
    return length * t * t * t * (1 - 0.5 * t) + fmax(x - length, 0);
}

void pattern_checker(const PatternPlace *place, PatternParts *parts);
void pattern_brick(const Pattern *pattern, const PatternPlace *place, PatternParts *parts);
void pattern_hexagon(const PatternPlace *place, PatternParts *parts);

#endif
