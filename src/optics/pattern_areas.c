/* pattern_areas.c - patterns with hard edges: checkers, bricks, hexagons.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/pattern_areas.h"

#include <stdlib.h>

static double triangle(double x) /* the integral of 1 and -1 in turn */
{
    double t = 2 * fraction(0.5 * x);
    return double_min(t, 2 - t); /* not a branch, which would be foretold half of the time */
}

static double turns(double x, double width)
{
    if (!is_extended(width, x)) return fraction(0.5 * x) < 0.5 ? 1 : -1;
    return (triangle(x + 0.5 * width) - triangle(x - 0.5 * width)) / width;
}

void pattern_checker(const PatternPlace *place, PatternParts *parts)
{
    double product = turns(place->p.x, width_along(place, vec3(1, 0, 0))) *
                     turns(place->p.y, width_along(place, vec3(0, 1, 0))) *
                     turns(place->p.z, width_along(place, vec3(0, 0, 1)));
    two_parts(parts, 0.5 - 0.5 * product);
}

/* How far into a brick along one axis, from 0 at the mortar's edge; the mortar lies half on either side of whole numbers
 * of `size`. */
static double depth_in_brick(double x, double size, double mortar)
{
    double in_cell = size * fraction(x / size);
    return fmin(in_cell, size - in_cell) - 0.5 * mortar;
}

/* The same along a whole row of bricks. */
static double row_integral(double x, double size, double mortar, double bevel)
{
    double in_cell = size * fraction(x / size), half = rise_integral(0.5 * (size - mortar), bevel);
    double here = in_cell < 0.5 * size ? rise_integral(in_cell - 0.5 * mortar, bevel)
                                       : 2 * half - rise_integral(size - in_cell - 0.5 * mortar, bevel);
    return 2 * half * floor(x / size) + here;
}

/* How much brick there is along one axis, over a width. */
static double row_cover(const Pattern *pattern, double x, double width, double size)
{
    double mortar = pattern->mortar, bevel = pattern->bevel;
    if (!is_extended(width, x)) {
        double depth = depth_in_brick(x, size, mortar);
        return depth > 0 ? depth < bevel ? smooth_step(depth / bevel) : 1 : 0;
    }
    double from = row_integral(x - 0.5 * width, size, mortar, bevel),
           to = row_integral(x + 0.5 * width, size, mortar, bevel);
    return clamp_unit((to - from) / width);
}

/* A joint that runs along the surface is not seen as one: the surface is the bricks' face. */
static bool crosses(double normal)
{
    return fabs(normal) < 0.9;
}

/* Along x and y together, as each course is shifted against the one below. */
static double courses_cover(const Pattern *pattern, const PatternPlace *place)
{
    enum { MOST_COURSES = 8 };
    Vec3 p = place->p, size = pattern->size;
    double across = width_along(place, vec3(1, 0, 0)), up = width_along(place, vec3(0, 1, 0));
    if (!is_extended(up, p.y)) up = 0;
    bool joints_x = crosses(place->normal.x), joints_y = crosses(place->normal.y);
    double first = floor((p.y - 0.5 * up) / size.y), last = floor((p.y + 0.5 * up) / size.y);
    if (last - first >= MOST_COURSES) {
        double rows = joints_y ? row_cover(pattern, p.y, up, size.y) : 1;
        return rows * (joints_x ? row_cover(pattern, 0.5 * size.x, size.x, size.x) : 1);
    }
    double sum = 0;
    for (double course = first; course <= last; course++) {
        double low = fmax(p.y - 0.5 * up, course * size.y), high = fmin(p.y + 0.5 * up, (course + 1) * size.y);
        double part = up > 0 ? (high - low) / up : 1;
        if (!(part > 0)) continue;
        double row = joints_y ? row_cover(pattern, up > 0 ? 0.5 * (low + high) : p.y, high - low, size.y) : 1;
        double shift = pattern->bond * course * size.x;
        sum += part * row * (joints_x ? row_cover(pattern, p.x - shift, across, size.x) : 1);
    }
    return sum;
}

/* At a point: corners of bevels are mitred, which a product along the axes is not. */
static double brick_point(const Pattern *pattern, const PatternPlace *place)
{
    Vec3 p = place->p, size = pattern->size;
    double course = floor(p.y / size.y), shift = pattern->bond * course * size.x;
    double depth = HUGE_VAL;
    if (crosses(place->normal.y)) depth = fmin(depth, depth_in_brick(p.y, size.y, pattern->mortar));
    if (crosses(place->normal.x)) depth = fmin(depth, depth_in_brick(p.x - shift, size.x, pattern->mortar));
    if (crosses(place->normal.z)) depth = fmin(depth, depth_in_brick(p.z, size.z, pattern->mortar));
    if (!(depth > 0)) return 0;
    return depth < pattern->bevel ? smooth_step(depth / pattern->bevel) : 1;
}

void pattern_brick(const Pattern *pattern, const PatternPlace *place, PatternParts *parts)
{
    double cover = 0, blend = 1;
    if (pattern->bevel > 0) blend = clamp_unit(place->footprint / pattern->bevel);
    if (place->footprint > 0 && blend > 0) {
        cover = courses_cover(pattern, place);
        if (crosses(place->normal.z))
            cover *= row_cover(pattern, place->p.z, width_along(place, vec3(0, 0, 1)), pattern->size.z);
    } else {
        blend = 0;
    }
    if (blend < 1) cover = blend * cover + (1 - blend) * brick_point(pattern, place);
    if (pattern->bevel > 0)
        one_part(parts, clamp_unit(cover));
    else
        two_parts(parts, cover);
}

/* Hexagons in axial coordinates (q, r), rounded to the nearest; neighbours differ in (q - r) modulo 3. */
static void nearest_hexagon(Vec3 p, double *whole_q, double *whole_r)
{
    double q = 2.0 / 3 * p.x, r = p.z / sqrt(3.0) - p.x / 3, s = -q - r;
    double whole_s = floor(s + 0.5);
    *whole_q = floor(q + 0.5);
    *whole_r = floor(r + 0.5);
    double off_q = fabs(*whole_q - q), off_r = fabs(*whole_r - r), off_s = fabs(whole_s - s);
    if (off_q > off_r && off_q > off_s)
        *whole_q = -*whole_r - whole_s;
    else if (off_r > off_s)
        *whole_r = -*whole_q - whole_s;
}

static int hexagon_colour(double q, double r)
{
    int colour = (int)fmod(q - r, 3);
    return colour < 0 ? colour + 3 : colour;
}

/* How much of a width about x is within half a strip's width of 0. */
static double strip_cover(double x, double half, double width)
{
    double overlap = fmin(x + 0.5 * width, half) - fmax(x - 0.5 * width, -half);
    return width > 1e-9 ? clamp_unit(overlap / width) : fabs(x) < half ? 1 : 0;
}

/* Each hexagon is what three strips have in common. */
static double hexagon_cover(const PatternPlace *place, double q, double r)
{
    const double half = 0.86602540378443865;
    const Vec3 axes[3] = {{0, 0, 1}, {half, 0, 0.5}, {half, 0, -0.5}};
    Vec3 apart = vec3(place->p.x - 1.5 * q, 0, place->p.z - 2 * half * (r + 0.5 * q));
    double cover = 1;
    for (int i = 0; i < 3; i++) cover *= strip_cover(vec3_dot(apart, axes[i]), half, width_along(place, axes[i]));
    return cover;
}

void pattern_hexagon(const PatternPlace *place, PatternParts *parts)
{
    double q, r, covers[3] = {0, 0, 0}, sum = 0;
    nearest_hexagon(place->p, &q, &r);
    int here = hexagon_colour(q, r);
    if (!(place->footprint > 1e-9) || hexagon_cover(place, q, r) >= 1) {
        one_part(parts, here / 2.0);
        return;
    }
    for (int i = -2; i <= 2; i++)
        for (int k = -2; k <= 2; k++) {
            if (abs(i + k) > 2) continue;
            double cover = hexagon_cover(place, q + i, r + k);
            covers[((here + i - k) % 3 + 3) % 3] += cover;
            sum += cover;
        }
    /* a footprint as wide as several of them has as much of each colour */
    double even = clamp_unit(place->footprint / 1.5 - 1);
    if (!(sum > 0)) even = 1;
    for (int i = 0; i < 3; i++) add_part(parts, i / 2.0, even / 3 + (sum > 0 ? (1 - even) * covers[i] / sum : 0));
}
