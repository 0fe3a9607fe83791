/* tube.c - where a line meets a circle that is turned about the y axis.
 *
 * No polynomial is made. Along the line, f = (r - c)^2 + y^2 - a^2 is how far (squared) a point is from the circle that
 * the tube is about, less the tube's own radius; it is negative inside. In double it can be had everywhere to within
 * the rounding of the coordinates, which the coefficients of the quartic cannot give. And its shape is known: r is a
 * hyperbola, r'' = K^2 / r^3 with the moment K of the line about the axis, so that f'' = 2 (d.d - c K^2 / r^3) has at
 * most two zeros. They stand symmetrically about the point nearest to the axis: f is convex, then concave, then convex.
 * (For the outer half, with 0 for a negative r - c, f is convex throughout.) So:
 *   - the line is cut at those two points, and the signs of f there are taken once;
 *   - in a convex stretch between two positive ends the least value is sought, and in a concave one between two
 *     negative ends the greatest; tangents at both sides bound it, which ends most searches at once;
 *   - between successive places of different sign there is one crossing, found by Newton's method within brackets.
 * Crossings are thus in order and go in and out by turns, by construction; a tangent crosses twice or not at all.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/tube.h"

#include <math.h>

enum {
    MAX_STEPS = 100,
    DEPTH = 4 /* in noise: what counts as a dip */
};
#define STEEP 0x1p-6        /* a cosine at which a start is clearly that */
#define START_NOISE 0x1p-44 /* how far from a start its crossing may be, of the tube's size */

/* The line as seen from the tube's centre; u = t - base is 0 at the point nearest to it. */
typedef struct TubeLine {
    const Tube *tube;
    double base;
    Vec3 org, dir;          /* org: the point at u = 0 */
    double length;          /* dir.dir, */
    double inverse;         /* and one over it */
    double speed;           /* and its root */
    double moment;          /* squared, of dir about the axis */
    double radius, squared; /* of the tube, and its square */
    double first, last;     /* the span, in t */
    double t_min, t_max;    /* what is asked for */
    PieceStart start;       /* whether it starts on the surface */
    double noise;           /* of f, by rounding */
    double least_slope;     /* of f: with less, its noise shows in the place of a crossing */
} TubeLine;

/* A place on the line. `inside` is what counts; f may differ from it by rounding at the ends of a span. */
typedef struct Stop {
    double u, f, slope;
    double near; /* 1 / its distance from the axis */
    bool inside;
} Stop;

static inline Stop stop_at(const TubeLine *line, double u)
{
    double x = line->org.x + u * line->dir.x;
    double y = line->org.y + u * line->dir.y;
    double z = line->org.z + u * line->dir.z;
    double r = sqrt(x * x + z * z);
    double away = r - line->tube->centre_r;
    if (line->tube->part == TUBE_OUTER) away = double_max(away, 0);
    if (line->tube->part == TUBE_INNER) away = double_min(away, 0);
    double near = 1 / r, outward = r > 0 ? (x * line->dir.x + z * line->dir.z) * near : 0;
    double f = away * away + (y * y - line->squared);
    bool beyond =
        line->tube->part != TUBE_WHOLE && away == 0; /* what f knows only to rounding, at the top and the bottom */
    return (Stop){u, f, 2 * (away * outward + y * line->dir.y), near, f < 0 || beyond};
}

static inline double time_of(const TubeLine *line, double u)
{
    return double_min(double_max(line->base + u, line->first), line->last);
}

/* Where the parabola that has f and slope of `at` and f of `other` meets 0 between them: the signs differ. */
static double parabola_root(const Stop *at, const Stop *other)
{
    double h = other->u - at->u;
    double bend = ((other->f - at->f) / h - at->slope) / h;
    double discriminant = at->slope * at->slope - 4 * bend * at->f;
    double root = discriminant > 0 ? sqrt(discriminant) : 0;
    double divisor = at->slope + ((at->f < 0) == (h > 0) ? root : -root);
    return at->u - 2 * at->f / divisor;
}

/* One step from a place towards f = 0. f bends by 2 (d.d - c K^2 / r^3), and that changes by at most 6 c |d|^3 / r^2. */
typedef struct Step {
    double u;
    double left; /* the most that f can be there */
} Step;

static inline Step step_from(const TubeLine *line, const Stop *stop)
{
    double inverse = 1 / stop->slope, step = stop->f * inverse;
    double c = line->tube->centre_r, near = stop->near;
    double bend = line->length - c * line->moment * (near * near * near);
    double further = step * (1 + bend * inverse * step); /* Chebyshev's method */
    double third = fabs(c) * near * near * line->length * line->speed;
    double cube = fabs(step * step * step);
    return (Step){stop->u - further, 8 * cube * (2 * bend * bend * fabs(inverse) + third)};
}

/* The crossing between a and b, a.u < b.u, of which one is inside, in a convex or concave stretch; guess may be
 * anything. Where f slopes the wrong way for this crossing, the crossing is on the side where it does not. So a sign at
 * the end of a span that contradicts that of f there, by rounding, leads to the right crossing all the same. */
static double crossing_between(const TubeLine *line, const Stop *a, const Stop *b, bool concave, double guess)
{
    double low = a->u, high = b->u;
    double u = guess > low && guess < high ? guess : 0.5 * (low + high);
    for (int i = 0; i < MAX_STEPS; i++) {
        Stop stop = stop_at(line, u);
        bool slopes = a->inside ? stop.slope > 0 : stop.slope < 0;
        if (slopes ? stop.inside == a->inside : a->inside != concave)
            low = u;
        else
            high = u;
        double next = HUGE_VAL;
        if (slopes) {
            Step step = step_from(line, &stop);
            bool settled =
                step.left <= line->noise || fabs(stop.f) <= line->noise || fabs(step.u - u) <= 0x1p-52 * fabs(u);
            if (settled && fabs(stop.slope) >= line->least_slope) return double_min(double_max(step.u, low), high);
            next = step.u;
        }
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == u || next == low || next == high) return next;
        u = next;
    }
    return u;
}

/* Whether the crossing between a and b is the one that brought the line to its start: known already, and nothing to search for. */
static bool is_start(const TubeLine *line, const Stop *a, const Stop *b)
{
    double u = -line->base;
    if (line->start != (b->inside ? PIECE_START_INSIDE : PIECE_START_OUTSIDE) || !(u > a->u && u < b->u)) return false;
    Stop stop = stop_at(line, u);
    double slope = b->inside ? -stop.slope : stop.slope;
    return slope >= 2 * STEEP * line->radius * line->speed &&
           fabs(stop.f) * line->speed <= START_NOISE * slope * (fabs(line->tube->centre_r) + line->radius);
}

static void add_crossing(const TubeLine *line, const Stop *a, const Stop *b, const Stop *inner, bool concave,
                         TubeCrossings *out)
{
    if (time_of(line, b->u) <= line->t_min || time_of(line, a->u) > line->t_max || out->n == TUBE_MAX_CROSSINGS) return;
    if (is_start(line, a, b)) return;
    const Stop *other = inner == a ? b : a;
    double t = time_of(line, crossing_between(line, a, b, concave, parabola_root(inner, other)));
    if (!(t > line->t_min && t <= line->t_max)) return;
    /* two in the same place: the line only touches there */
    if (out->n && t <= out->t[out->n - 1]) {
        out->n--;
        return;
    }
    if (out->n == 0) out->first_enters = !a->inside;
    out->t[out->n++] = t;
}

/* In a convex stretch with both ends outside, a place that is inside by more than noise (or, concave, the other way
 * round). */
static bool find_dip(const TubeLine *line, const Stop *left, const Stop *right, Stop *dip)
{
    double sign = left->inside ? -1 : 1;
    Stop a = *left, b = *right;
    double width = b.u - a.u, depth = DEPTH * line->noise;
    for (int i = 0; i < MAX_STEPS; i++) {
        double slope_a = sign * a.slope, slope_b = sign * b.slope;
        if (!(slope_a < 0 && slope_b > 0)) return false;
        double h = b.u - a.u;
        double meet = (sign * (a.f - b.f) + slope_b * h) / (slope_b - slope_a); /* of both tangents, from a */
        if (sign * a.f + slope_a * meet >= -depth) return false;
        double u = a.u - slope_a * h / (slope_b - slope_a);
        if (i >= 4 && h > 0.5 * width) u = a.u + 0.5 * h;
        if (i % 2) width = h;
        if (!(u > a.u && u < b.u)) return false;
        *dip = stop_at(line, u);
        if (sign * dip->f < -depth) return true;
        if (sign * dip->slope < 0)
            a = *dip;
        else
            b = *dip;
    }
    return false;
}

/* For an outer part: where the line is nearest to the axis, if that is nearer than the tube's circle, which counts as
 * inside, and between a and b. */
static bool passes_middle(const TubeLine *line, const Stop *a, const Stop *b, Stop *nearest)
{
    double c = line->tube->centre_r;
    double level = line->dir.x * line->dir.x + line->dir.z * line->dir.z;
    double u = -(line->org.x * line->dir.x + line->org.z * line->dir.z) / level;
    if (line->tube->part != TUBE_OUTER || !(c > 0) || !(line->moment < c * c * level) || !(u > a->u && u < b->u))
        return false;
    *nearest = stop_at(line, u);
    return nearest->inside;
}

static void cross_stretch(const TubeLine *line, const Stop *a, const Stop *b, bool concave, TubeCrossings *out)
{
    Stop dip;
    if (a->inside != b->inside) {
        add_crossing(line, a, b, a->inside ? a : b, concave, out);
    } else if (a->inside == concave && find_dip(line, a, b, &dip)) {
        add_crossing(line, a, &dip, &dip, concave, out);
        add_crossing(line, &dip, b, &dip, concave, out);
    }
}

/* Half the length of the concave stretch about the point nearest to the axis, and that point; false: convex
 * throughout. Near the axis r bends so sharply that the bend is widened to what rounding can resolve. */
static bool concave_stretch(const TubeLine *line, double *middle, double *half)
{
    double c = line->tube->centre_r;
    if (line->tube->part == TUBE_OUTER || !(c > 0)) return false;
    double level = line->dir.x * line->dir.x + line->dir.z * line->dir.z;
    double nearest = line->moment / level; /* the squared distance from the axis */
    /* c K^2 / (d.d) <= nearest^(3/2), without the cube root */
    double cube = c * line->moment * line->inverse;
    if (cube * cube <= nearest * nearest * nearest && nearest > 1e-20 * c * c) return false;
    double r = double_max(cbrt(cube), 1e-10 * c);
    *middle = -(line->org.x * line->dir.x + line->org.z * line->dir.z) / level;
    *half = sqrt(double_max(r * r - nearest, 0) / level);
    return *half < HUGE_VAL && fabs(*middle) < HUGE_VAL;
}

/* The zone of a sphere: f is a parabola with its vertex at u = 0. */
static void cross_sphere(const TubeLine *line, const Stop *a, const Stop *b, TubeCrossings *out)
{
    double u = sqrt(double_max(line->squared - vec3_dot(line->org, line->org), 0) * line->inverse);
    double found[2] = {-u, u};
    int n = a->inside != b->inside ? 1 : !a->inside && u > 0 && a->u < 0 && b->u > 0 ? 2 : 0;
    if (n == 1 && a->inside) found[0] = u;
    if (n == 2 && !(time_of(line, -u) < time_of(line, u))) n = 0;
    for (int i = 0; i < n; i++) {
        double t = time_of(line, found[i]);
        if (!(t > line->t_min && t <= line->t_max)) continue;
        if (out->n == 0) out->first_enters = (i == 0) != a->inside;
        out->t[out->n++] = t;
    }
}

/* Cuts the line down to where the surface can be: a ball about the tube's centre, and for a whole tube the slab
 * between its top and bottom. False where nothing is left. */
static bool clip(const TubeLine *line, double *low, double *high)
{
    const Tube *tube = line->tube;
    double c = fabs(tube->centre_r), a = line->radius;
    double reach = tube->part == TUBE_INNER ? c * c + line->squared : (c + a) * (c + a);
    double left = reach * (1 + 1e-12) - vec3_dot(line->org, line->org);
    if (!(left > 0)) return false;
    double half = sqrt(left * line->inverse);
    *low = double_max(*low, -half);
    *high = double_min(*high, half);
    if (tube->part == TUBE_WHOLE && line->dir.y != 0) {
        double top = a * (1 + 1e-12);
        double p = (-top - line->org.y) / line->dir.y, q = (top - line->org.y) / line->dir.y;
        *low = double_max(*low, double_min(p, q));
        *high = double_min(*high, double_max(p, q));
    } else if (tube->part == TUBE_WHOLE && fabs(line->org.y) > a) {
        return false;
    }
    return *low < *high;
}

static void cross_stretches(const TubeLine *line, Stop a, Stop b, TubeCrossings *out)
{
    double middle, half;
    Stop from = a, nearest;
    if (concave_stretch(line, &middle, &half)) {
        const double cuts[2] = {middle - half, middle + half};
        for (int i = 0; i < 2; i++) {
            if (!(cuts[i] > from.u && cuts[i] < b.u)) continue;
            Stop cut = stop_at(line, cuts[i]);
            cross_stretch(line, &from, &cut, from.u >= cuts[0] && cut.u <= cuts[1], out);
            from = cut;
        }
        cross_stretch(line, &from, &b, from.u >= cuts[0] && b.u <= cuts[1], out);
    } else if (!a.inside && !b.inside && passes_middle(line, &a, &b, &nearest)) {
        cross_stretch(line, &a, &nearest, false, out);
        cross_stretch(line, &nearest, &b, false, out);
    } else {
        cross_stretch(line, &a, &b, false, out);
    }
}

void tube_cross(const Tube *tube, const PieceLine *piece_line, const TubeSpan *span, double t_min, double t_max,
                PieceStart start, TubeCrossings *out)
{
    static const TubeSpan everything = {-HUGE_VAL, HUGE_VAL, false, false};
    if (!span) span = &everything;
    Vec3 org = piece_line->org, dir = piece_line->dir;
    org.y -= tube->centre_y;
    double radius = sqrt(tube->squared), length = vec3_dot(dir, dir), inverse = 1 / length;
    TubeLine line = {.tube = tube,
                     .base = -vec3_dot(org, dir) * inverse,
                     .dir = dir,
                     .length = length,
                     .inverse = inverse,
                     .speed = sqrt(length),
                     .radius = radius,
                     .squared = tube->squared,
                     .first = span->a,
                     .last = span->b,
                     .t_min = t_min,
                     .t_max = t_max,
                     .start = start,
                     .noise = 0x1p-53 * radius * (fabs(tube->centre_r) + radius)};
    line.org = vec3_along(org, line.base, dir);
    double moment = line.org.x * dir.z - line.org.z * dir.x;
    line.moment = moment * moment;
    /* along the top and the bottom, where the parts meet, no part may find crossings in what is only noise: dips of
     * outer ones must be deeper than that, inner ones are as much thicker */
    if (tube->part == TUBE_INNER) line.squared += DEPTH * line.noise;
    line.least_slope = 1e10 * 0x1p-53 * (fabs(tube->centre_r) + radius) * line.speed;
    out->n = 0;
    out->first_enters = true;
    double low = span->a - line.base, high = span->b - line.base;
    if (span->inside_a == span->inside_b && !(low < high)) return;
    double from = low, to = high;
    if (!clip(&line, &from,
              &to)) { /* ends that differ all the same do so by rounding: the one near the surface is known */
        if (span->inside_a == span->inside_b) return;
        out->t[0] = span->inside_a == (tube->part != TUBE_INNER) ? span->a : span->b;
        out->n = out->t[0] > t_min && out->t[0] <= t_max;
        out->first_enters = !span->inside_a;
        return;
    }
    if (time_of(&line, to) <= t_min || time_of(&line, from) > t_max) return;
    if (tube->centre_r == 0 && tube->part == TUBE_OUTER) {
        Stop a = {.u = low, .inside = span->inside_a}, b = {.u = high, .inside = span->inside_b};
        cross_sphere(&line, &a, &b, out);
        return;
    }
    Stop a = stop_at(&line, from), b = stop_at(&line, to);
    a.inside = span->inside_a;
    b.inside = span->inside_b;
    cross_stretches(&line, a, b, out);
}
