/* sweep.c - an outline moved along a path: tubes, ropes, springs.
 * The path becomes stations, close enough for the tolerance; each has a frame and a copy of the outline. Straight
 * pieces meet in mitres: at a corner the copy lies in the plane that halves the angle.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/array.h"
#include "shape/smooth.h"
#include "shape/sweep_parts.h"

/* How far a side is bent, of its length. */
#define HOLLOW 1e-5
enum { MAX_STATIONS = 4000000, MAX_STEPS = 100000, DEGREES_PER_STEP = 5, MAX_CIRCLE = 2048, MIN_CIRCLE = 24 };

typedef struct SweepMaker {
    const SweepShape *shape;
    const Outline2 *outline;
    /* the same with what is straight bent inwards a little: so no triangle of a flat end has three points of one side, which
     * rounding would turn over */
    const Outline2 *hollow;
    Station *stations; /* closed: the last is the first again */
    size_t n_stations, capacity;
    double *
        natural; /* of natural curves: for each piece the velocities of x, y, z and the scale, at its begin and at its end */
    double twist, twist_rate; /* in all, in degrees; per length, in radians */
    bool folds;               /* it has been found to, or to have a corner that is too sharp */
    Grower grower;
} SweepMaker;

/* ---- the path ---- */

/* Point i - 1 of the path: i is 0 .. n + 1, and what is beyond an open end goes straight on. */
static Vec3 path_point(const SweepShape *shape, size_t i)
{
    size_t n = shape->n_path;
    if (shape->closed) return shape->path[(i + n - 1) % n];
    if (i == 0) return vec3_sub(vec3_scale(shape->path[0], 2), shape->path[1]);
    if (i == n + 1) return vec3_sub(vec3_scale(shape->path[n - 1], 2), shape->path[n - 2]);
    return shape->path[i - 1];
}

/* The same of the scales. */
static double scale_at(const SweepShape *shape, size_t i)
{
    size_t n = shape->n_path;
    if (shape->n_scales == 1) return shape->scales[0];
    if (shape->closed) return shape->scales[(i + n - 1) % n];
    if (i == 0) return 2 * shape->scales[0] - shape->scales[1];
    if (i == n + 1) return 2 * shape->scales[n - 1] - shape->scales[n - 2];
    return shape->scales[i - 1];
}

/* A piece of the path, from a to b, where the scale goes from s0 to s1. */
typedef struct Piece {
    Vec3 a, b, start, end; /* start, end: the velocities there */
    double s0, s1, scale_start, scale_end;
} Piece;

/* The velocities of a value that has these four ones at four points, between the second and the third of them. */
static void piece_velocities(const double times[3], const double values[4], double *start, double *end)
{
    *start = smooth_velocity(values[0], values[1], values[2], times[0], times[1]);
    *end = -smooth_velocity(values[3], values[2], values[1], times[2], times[1]);
}

static Piece piece_from(const SweepMaker *maker, size_t i)
{
    const SweepShape *shape = maker->shape;
    Vec3 p[4];
    double s[4], times[3];
    for (size_t k = 0; k < 4; k++) p[k] = path_point(shape, i + k);
    for (size_t k = 0; k < 4; k++) s[k] = scale_at(shape, i + k);
    Piece piece = {.a = p[1], .b = p[2], .s0 = s[1], .s1 = s[2]};
    if (maker->natural) {
        const double *u = maker->natural + 8 * i, *v = u + 4;
        piece.start = vec3(u[0], u[1], u[2]);
        piece.end = vec3(v[0], v[1], v[2]);
        piece.scale_start = u[3];
        piece.scale_end = v[3];
        return piece;
    }
    for (size_t k = 0; k < 3; k++) times[k] = smooth_time(vec3_length(vec3_sub(p[k + 1], p[k])));
    piece_velocities(times, (double[]){p[0].x, p[1].x, p[2].x, p[3].x}, &piece.start.x, &piece.end.x);
    piece_velocities(times, (double[]){p[0].y, p[1].y, p[2].y, p[3].y}, &piece.start.y, &piece.end.y);
    piece_velocities(times, (double[]){p[0].z, p[1].z, p[2].z, p[3].z}, &piece.start.z, &piece.end.z);
    piece_velocities(times, s, &piece.scale_start, &piece.scale_end);
    return piece;
}

/* What all pieces of a natural curve need. */
static Status solve_path(SweepMaker *maker, Error *error)
{
    const SweepShape *shape = maker->shape;
    size_t n = shape->n_path;
    if (shape->curve != SWEEP_NATURAL) return STATUS_OK;
    double *values = calloc(5 * n, sizeof *values), *times = values + 4 * n;
    maker->natural = calloc(8 * n, sizeof *maker->natural);
    bool fine = values && maker->natural;
    for (size_t i = 0; fine && i < n; i++) {
        Vec3 p = path_point(shape, i + 1);
        const double point[4] = {p.x, p.y, p.z, scale_at(shape, i + 1)};
        memcpy(values + 4 * i, point, sizeof point);
        times[i] = smooth_time(vec3_length(vec3_sub(path_point(shape, i + 2), p)));
    }
    const NaturalPoints points = {.values = values, .times = times, .n = n, .width = 4, .closed = shape->closed};
    fine = fine && natural_velocities(&points, maker->natural);
    free(values);
    return fine ? STATUS_OK : fail_memory(error, 13 * n * sizeof *values, "a sweep");
}

/* Hermite's cubic from a to b, with these velocities at its ends. */
static double hermite(double a, double b, double start, double end, double t, double *velocity)
{
    double e = 3 * (b - a) - 2 * start - end, f = start + end - 2 * (b - a);
    *velocity = start + t * (2 * e + 3 * f * t);
    return a + t * (start + t * (e + t * f));
}

static Vec3 piece_at(const Piece *piece, double t, Vec3 *velocity)
{
    const Vec3 *a = &piece->a, *b = &piece->b, *start = &piece->start, *end = &piece->end;
    return vec3(hermite(a->x, b->x, start->x, end->x, t, &velocity->x),
                hermite(a->y, b->y, start->y, end->y, t, &velocity->y),
                hermite(a->z, b->z, start->z, end->z, t, &velocity->z));
}

/* How far the outline is from the path, at a scale of 1. */
static double outline_reach(const SweepShape *shape)
{
    double reach = shape->outline ? 0 : 1;
    for (size_t i = 0; shape->outline && i < shape->outline->n_points; i++)
        reach = fmax(reach, hypot(shape->outline->points[i].at.x, shape->outline->points[i].at.y));
    return reach;
}

/* Degrees of twist from station to station: the outline's farthest point goes round with so small chords. */
static double twist_step(const SweepShape *shape)
{
    double reach = outline_reach(shape), largest = 0;
    for (size_t i = 0; i < shape->n_scales; i++) largest = fmax(largest, shape->scales[i]);
    return fmin(DEGREES_PER_STEP, sqrt(8 * shape->tolerance / (reach * largest)) / MEN_DEGREE);
}

/* The place at t on a side from a to b, in front of its middle: to the left, where the inside is. */
static Point2 in_front(Point2 a, Point2 b, double t)
{
    double dx = b.x - a.x, dy = b.y - a.y, by = 4 * t * (1 - t) * HOLLOW;
    return (Point2){a.x + t * dx - by * dy, a.y + t * dy + by * dx};
}

/* A straight side of the outline becomes a screw by twisting; cut into triangles, it is off by a quarter of how far its
 * ends leave their common plane from station to station. Shorter sides keep that within the tolerance. In `hollow` they are
 * bent inwards, for the triangles of flat ends. */
static Status cut_sides(const SweepShape *shape, Outline2 *cut, Outline2 *hollow, Error *error)
{
    const Outline2 *outline = shape->outline;
    double largest = 0, angle = twist_step(shape) * MEN_DEGREE;
    for (size_t i = 0; i < shape->n_scales; i++) largest = fmax(largest, shape->scales[i]);
    size_t begin = 0;
    bool fine = true;
    for (size_t loop = 0; loop < outline->n_loops && fine; loop++) {
        size_t end = outline->loop_ends[loop];
        for (size_t i = begin; i < end && fine; i++) {
            const OutlinePoint2 *a = &outline->points[i], *b = &outline->points[i + 1 < end ? i + 1 : begin];
            double dx = b->at.x - a->at.x, dy = b->at.y - a->at.y;
            double n = fmin(fmax(ceil(largest * hypot(dx, dy) * angle / (4 * shape->tolerance)), 1), 1000);
            for (double k = 0; k < n && fine; k++) {
                double t = k / n;
                Point2 along = {a->leave.x + t * (b->arrive.x - a->leave.x),
                                a->leave.y + t * (b->arrive.y - a->leave.y)};
                OutlinePoint2 point = {
                    {a->at.x + t * dx, a->at.y + t * dy}, k > 0 ? along : a->arrive, along, a->source};
                fine = cut->n_points < POLYGON_MAX_POINTS && outline2_add_point(cut, &point);
                point.at = in_front(a->at, b->at, t);
                fine = fine && outline2_add_point(hollow, &point);
            }
        }
        fine = fine && outline2_end_loop(cut) && outline2_end_loop(hollow);
        begin = end;
    }
    return fine ? STATUS_OK : fail_memory(error, cut->n_points * sizeof *cut->points, "a sweep");
}

/* The larger of the second derivatives at both ends of a cubic, between which they go straight. */
static double cubic_bend(double step, double start, double end)
{
    return fmax(fabs(6 * step - 4 * start - 2 * end), fabs(2 * start + 4 * end - 6 * step));
}

static unsigned steps_of(const SweepShape *shape, const Piece *piece, double twist)
{
    double steps = twist != 0 ? fabs(twist) / twist_step(shape) : 0;
    if (shape->curve != SWEEP_LINEAR) {
        Vec3 m0 = piece->start, m1 = piece->end, chord = vec3_sub(piece->b, piece->a);
        Vec3 first = vec3_sub(vec3_scale(chord, 6), vec3_add(vec3_scale(m0, 4), vec3_scale(m1, 2)));
        Vec3 last = vec3_sub(vec3_add(vec3_scale(m0, 2), vec3_scale(m1, 4)), vec3_scale(chord, 6));
        double bend = fmax(vec3_length(first), vec3_length(last));
        double turning = vec3_angle(m0, chord) + vec3_angle(chord, m1);
        if (shape->n_scales > 1) { /* the outline's farthest point as it would go along a straight path */
            double reach = outline_reach(shape), rise = reach * (piece->s1 - piece->s0), length = vec3_length(chord);
            double start = reach * piece->scale_start, end = reach * piece->scale_end, middle = atan2(rise, length);
            bend += cubic_bend(rise, start, end);
            turning += fabs(atan2(start, vec3_length(m0)) - middle) + fabs(atan2(end, vec3_length(m1)) - middle);
        }
        steps = fmax(steps, fmax(sqrt(bend / (8 * shape->tolerance)), turning / (DEGREES_PER_STEP * MEN_DEGREE)));
    }
    return steps < 1 ? 1 : steps > MAX_STEPS ? MAX_STEPS : (unsigned)ceil(steps);
}

static Status add_station(SweepMaker *maker, Vec3 at, Vec3 tangent, double scale, size_t source, Error *error)
{
    if (maker->n_stations >= MAX_STATIONS)
        return fail(error, STATUS_SCENE, "the path needs more than %d steps; make the tolerance larger", MAX_STATIONS);
    if (!ARRAY_ROOM(maker->stations, maker->capacity, maker->n_stations))
        return fail_memory(error, maker->n_stations * sizeof *maker->stations, "a sweep");
    Station *station = &maker->stations[maker->n_stations];
    *station =
        (Station){.at = at, .tangent = tangent, .before = tangent, .after = tangent, .scale = scale, .source = source};
    if (maker->n_stations) station->along = station[-1].along + vec3_length(vec3_sub(at, station[-1].at));
    maker->n_stations++;
    return STATUS_OK;
}

static Status check_path(const SweepShape *shape, Error *error)
{
    size_t n = shape->n_path, fewest = shape->closed ? 3 : 2;
    if (n < fewest)
        return fail(error, STATUS_SCENE, "a%s path needs at least %zu points; this one has %zu",
                    shape->closed ? " closed" : "", fewest, n);
    if (shape->n_scales != 1 && shape->n_scales != n)
        return fail(error, STATUS_SCENE, "there are %zu radii for %zu points of the path", shape->n_scales, n);
    for (size_t i = 0; i + (shape->closed ? 0 : 1) < n; i++) {
        Vec3 a = shape->path[i], b = shape->path[(i + 1) % n];
        if (!(vec3_length(vec3_sub(a, b)) > 0))
            return fail(error, STATUS_SCENE, "the points %zu and %zu of the path are the same: <%g, %g, %g>", i,
                        (i + 1) % n, a.x, a.y, a.z);
    }
    return STATUS_OK;
}

static Status walk_path(SweepMaker *maker, Error *error)
{
    const SweepShape *shape = maker->shape;
    size_t n_pieces = shape->closed ? shape->n_path : shape->n_path - 1;
    double total = 0;
    for (size_t i = 0; i < n_pieces; i++)
        total += vec3_length(vec3_sub(path_point(shape, i + 2), path_point(shape, i + 1)));
    for (size_t i = 0; i < n_pieces; i++) {
        const Piece piece = piece_from(maker, i);
        Vec3 step = vec3_sub(piece.b, piece.a);
        unsigned n = steps_of(shape, &piece, maker->twist * vec3_length(step) / total);
        for (unsigned k = i ? 1 : 0; k <= n; k++) {
            double t = (double)k / n, scale = piece.s0 + t * (piece.s1 - piece.s0), ignored;
            Vec3 at = k == n ? piece.b : vec3_along(piece.a, t, step), slope = step;
            if (shape->curve != SWEEP_LINEAR) {
                at = piece_at(&piece, t, &slope);
                scale = hermite(piece.s0, piece.s1, piece.scale_start, piece.scale_end, t, &ignored);
            }
            if (scale < 0) scale = 0; /* the spline can swing below where radii are 0 */
            double speed = vec3_length(slope);
            if (!(speed > 0))
                return fail(error, STATUS_SCENE, "the path turns back on the spot at point %zu, <%g, %g, %g>",
                            k == n ? i + 1 : i, at.x, at.y, at.z);
            TRY(add_station(maker, at, vec3_scale(slope, 1 / speed), scale, i, error));
        }
    }
    return STATUS_OK;
}

/* Directions on both sides of the corners of a straight path, and the plane of the mitre. */
static Status set_corners(SweepMaker *maker, Error *error)
{
    size_t n = maker->n_stations;
    const SweepShape *shape = maker->shape;
    for (size_t i = 0; i < n && shape->curve == SWEEP_LINEAR; i++) {
        Station *s = &maker->stations[i];
        bool first = i == 0, last = i + 1 == n;
        const Station *behind = last ? &maker->stations[1] : s + 1, *ahead = first ? &maker->stations[n - 2] : s - 1;
        Vec3 to = last ? maker->stations[0].at : s->at, from = first ? maker->stations[n - 1].at : s->at;
        s->before = vec3_normalize(vec3_sub(from, ahead->at));
        s->after = vec3_normalize(vec3_sub(behind->at, to));
        if (first && !shape->closed) s->before = s->after;
        if (last && !shape->closed) s->after = s->before;
        Vec3 sum = vec3_add(s->before, s->after);
        double length = vec3_length(sum);
        s->turns_back = length < 0.26; /* 165 degrees */
        if (s->turns_back && shape->outline)
            return fail(error, STATUS_SCENE, "the path turns back too sharply at point %zu, <%g, %g, %g>",
                        s->source + 1, s->at.x, s->at.y, s->at.z);
        maker->folds |= s->turns_back;
        s->tangent = s->turns_back ? s->after : vec3_scale(sum, 1 / length);
    }
    return STATUS_OK;
}

/* ---- frames ---- */

static Vec3 reflected(Vec3 x, Vec3 across)
{
    double c = vec3_dot(across, across);
    return c > 0 ? vec3_along(x, -2 * vec3_dot(across, x) / c, across) : x;
}

static void set_first_frame(Station *station, Vec3 up)
{
    Vec3 t = station->after, v = vec3_along(up, -vec3_dot(up, t), t);
    if (!(vec3_length(v) > 1e-6 * vec3_length(up))) { /* along the path: any axis that is not */
        Vec3 other = fabs(t.z) < 0.9 ? vec3(0, 0, -1) : vec3(1, 0, 0);
        v = vec3_along(other, -vec3_dot(other, t), t);
    }
    station->v = vec3_normalize(v);
    station->u = vec3_cross(station->v, t);
}

/* Frames are carried along the pieces, from the direction behind one station to that behind the next. */
static void set_frames(SweepMaker *maker)
{
    Station *s = maker->stations;
    size_t n = maker->n_stations;
    const SweepShape *shape = maker->shape;
    set_first_frame(&s[0], shape->up);
    for (size_t i = 1; i < n; i++) {
        Vec3 step = vec3_sub(s[i].at, s[i - 1].at);
        Vec3 v = reflected(s[i - 1].v, step), t = reflected(s[i - 1].after, step);
        v = reflected(v, vec3_sub(s[i].after, t));
        v = vec3_along(v, -vec3_dot(v, s[i].after), s[i].after);
        s[i].v = vec3_normalize(v);
        s[i].u = vec3_cross(s[i].v, s[i].after);
    }
    double total = maker->twist * MEN_DEGREE;
    if (shape->closed) /* what the frame has turned by on its way round is taken back evenly */
        total += atan2(vec3_dot(s[n - 1].v, s[0].u), vec3_dot(s[n - 1].v, s[0].v));
    maker->twist_rate = total / s[n - 1].along;
    for (size_t i = 0; i < n; i++) {
        s[i].turn = total * s[i].along / s[n - 1].along;
        const Station *a = i ? &s[i - 1] : shape->closed ? &s[n - 2] : &s[0];
        const Station *b = i + 1 < n ? &s[i + 1] : shape->closed ? &s[1] : &s[n - 1];
        double length = i && i + 1 < n  ? b->along - a->along
                        : shape->closed ? s[n - 1].along - s[n - 2].along + s[1].along
                                        : fabs(b->along - a->along);
        s[i].slope = (b->scale - a->scale) / length;
        s[i].bend =
            shape->curve != SWEEP_LINEAR ? vec3_scale(vec3_sub(b->tangent, a->tangent), 1 / length) : vec3(0, 0, 0);
    }
    if (shape->closed) {
        Station first = s[0];
        first.along = s[n - 1].along;
        first.source = s[n - 1].source;
        s[n - 1] = first; /* bit for bit, so that the sweep closes */
    }
}

/* ---- the surface ---- */

/* A direction of the outline's plane in space. */
static Vec3 outline_vector(const Station *station, Point2 p)
{
    double c = cos(station->turn), s = sin(station->turn);
    double x = c * p.x - s * p.y, y = s * p.x + c * p.y;
    return vec3_add(vec3_scale(station->u, x), vec3_scale(station->v, y));
}

static Vec3 station_point(const Station *station, Point2 p)
{
    Vec3 offset = vec3_scale(outline_vector(station, p), station->scale);
    double lean = vec3_dot(offset, station->tangent) / vec3_dot(station->after, station->tangent); /* onto the mitre */
    return vec3_add(station->at, vec3_along(offset, -lean, station->after));
}

static Vec3 negative(Vec3 v)
{
    return vec3_scale(v, -1);
}

/* The surface's normal where the outline goes along `along`; `piece` is the one whose frame holds. */
static Vec3 station_normal(const SweepMaker *maker, const Station *station, const Station *piece, Point2 p,
                           Point2 along)
{
    Point2 out = {along.y, -along.x};
    Station frame = *station;
    frame.u = piece->u;
    frame.v = piece->v;
    Vec3 normal = outline_vector(&frame, out), offset = vec3_scale(outline_vector(&frame, p), station->scale);
    Vec3 t = maker->shape->curve != SWEEP_LINEAR ? station->tangent : piece->after;
    double slope = maker->shape->curve != SWEEP_LINEAR
                       ? station->slope
                       : (piece[1].scale - piece->scale) / (piece[1].along - piece->along);
    double rate =
        slope * (p.x * out.x + p.y * out.y) + station->scale * maker->twist_rate * (-p.y * out.x + p.x * out.y);
    return vec3_along(normal, -rate / fmax(1 - vec3_dot(station->bend, offset), 1e-3), t);
}

static Status check_fold(SweepMaker *maker, const Station *a, const Station *b, Point2 p, Error *error)
{
    Vec3 step = vec3_sub(station_point(b, p), station_point(a, p)), chord = vec3_sub(b->at, a->at);
    if (vec3_dot(step, chord) > 0) return STATUS_OK;
    maker->folds = true;
    double reach = a->scale * hypot(p.x, p.y), left = vec3_dot(step, chord) / vec3_dot(chord, chord);
    bool bends = vec3_length(a->bend) > 0 || vec3_length(b->bend) > 0;
    if (bends) /* what is left of a step so far within is 1 - reach / radius */
        return fail(
            error, STATUS_SCENE,
            "the sweep folds over itself near <%.6g, %.6g, %.6g>, behind point %zu of the path: the path bends with a "
            "radius of %.3g there, and the outline reaches %.3g from it",
            a->at.x, a->at.y, a->at.z, a->source, reach / (1 - left), reach);
    return fail(error, STATUS_SCENE,
                "the sweep folds over itself near <%.6g, %.6g, %.6g>, behind point %zu of the path: the outline, which "
                "reaches %.3g from it, is too wide for this corner",
                a->at.x, a->at.y, a->at.z, a->source, reach);
}

/* How far a line from 1 on falls per unit when it comes to `after` at 1: up to which value it is above 0. */
static double zero_of(double after)
{
    return after < 1 ? 1 / (1 - after) : HUGE_VAL;
}

/* How many times its size the outline can have without a fold between any two stations: whatever a step is longer or shorter
 * than its chord goes with the size, and so does what the bend takes away of it. */
static double fit_of_stations(const SweepMaker *maker)
{
    double fit = HUGE_VAL;
    for (size_t i = 0; i + 1 < maker->n_stations; i++) {
        const Station *a = &maker->stations[i], *b = a + 1;
        Vec3 chord = vec3_sub(b->at, a->at);
        for (size_t k = 0; k < maker->outline->n_points; k++) {
            Point2 p = maker->outline->points[k].at;
            Vec3 step = vec3_sub(station_point(b, p), station_point(a, p));
            Vec3 offset = vec3_scale(outline_vector(a, p), a->scale);
            fit = fmin(fit, zero_of(vec3_dot(step, chord) / vec3_dot(chord, chord)));
            fit = fmin(fit, zero_of(1 - vec3_dot(a->bend, offset)));
        }
    }
    return fit;
}

/* The same of the path itself, somewhat less: a smooth one may bend more between stations, and smaller outlines have more of
 * those. 0: it bends without end, or takes too long to look at. */
static double largest_fit(const SweepMaker *maker)
{
    enum { ROUNDS = 8 };
    const double margin = 0.98, settled = 0.98, most_work = 5e7;
    double fit = fit_of_stations(maker);
    if (maker->shape->curve == SWEEP_LINEAR) return margin * fit;
    SweepShape finer = *maker->shape;
    for (int i = 0; i < ROUNDS && fit > 0; i++) {
        SweepMaker again = {.shape = &finer, .outline = maker->outline, .twist = maker->twist};
        Error none;
        double next = 0;
        finer.tolerance *= 0.1;
        bool walked = walk_path(&again, &none) == STATUS_OK && set_corners(&again, &none) == STATUS_OK;
        if (walked && (double)again.n_stations * (double)again.outline->n_points < most_work) {
            set_frames(&again);
            next = fit_of_stations(&again);
        }
        free(again.stations);
        if (next >= settled * fit) return margin * fmin(fit, next);
        fit = next;
    }
    return 0;
}

static Status add_span(SweepMaker *maker, size_t i, Error *error)
{
    const Station *a = &maker->stations[i], *b = a + 1;
    size_t begin = 0;
    for (size_t loop = 0; loop < maker->outline->n_loops; loop++) {
        size_t end = maker->outline->loop_ends[loop];
        for (size_t k = begin; k < end; k++) {
            const OutlinePoint2 *p = &maker->outline->points[k],
                                *q = &maker->outline->points[k + 1 < end ? k + 1 : begin];
            TRY(check_fold(maker, a, b, p->at, error));
            uint32_t corners[4];
            const Station *stations[4] = {a, a, b, b};
            for (int c = 0; c < 4; c++) {
                bool second = c == 1 || c == 2;
                const Station *at = stations[c], *frame = maker->shape->curve != SWEEP_LINEAR ? at : a;
                Vec3 normal = station_normal(maker, at, frame, second ? q->at : p->at, second ? q->arrive : p->leave);
                corners[c] = grower_vertex(&maker->grower, station_point(at, second ? q->at : p->at), normal);
            }
            grower_quad(&maker->grower, corners[0], corners[1], corners[2], corners[3]);
        }
        begin = end;
    }
    return STATUS_OK;
}

static Status add_flat_end(SweepMaker *maker, const Station *station, bool last, Error *error)
{
    uint32_t(*triangles)[3] = NULL;
    size_t n = 0;
    if (station->scale == 0) return STATUS_OK;
    TRY(polygon_triangulate(maker->hollow, &triangles, &n, error));
    uint32_t first = (uint32_t)maker->grower.n_vertices;
    Vec3 normal = last ? station->tangent : negative(station->tangent);
    for (size_t i = 0; i < maker->outline->n_points; i++)
        grower_vertex(&maker->grower, station_point(station, maker->outline->points[i].at), normal);
    for (size_t i = 0; i < n; i++)
        grower_triangle(&maker->grower, first + triangles[i][0], first + triangles[i][last ? 1 : 2],
                        first + triangles[i][last ? 2 : 1]);
    free(triangles);
    return STATUS_OK;
}

/* Half a ball, in rings from the circle to its pole. */
static void add_round_end(SweepMaker *maker, const Station *station, bool last)
{
    const Outline2 *circle = maker->outline;
    size_t n = circle->n_points, n_rings = n / 4;
    Vec3 out = last ? station->tangent : negative(station->tangent);
    uint32_t before = 0;
    for (size_t ring = 0; ring <= n_rings; ring++) {
        double angle = 90 * MEN_DEGREE * (double)ring / (double)n_rings, c = ring == n_rings ? 0 : cos(angle),
               s = sin(angle);
        uint32_t first = (uint32_t)maker->grower.n_vertices;
        for (size_t k = 0; k < n; k++) {
            Point2 p = circle->points[k].at;
            Vec3 normal = vec3_add(vec3_scale(outline_vector(station, p), c), vec3_scale(out, s));
            Vec3 at = ring ? vec3_along(station->at, station->scale, normal) : station_point(station, p);
            grower_vertex(&maker->grower, at, normal);
        }
        for (uint32_t k = 0; ring && k < n; k++) {
            uint32_t next = k + 1 < n ? k + 1 : 0;
            if (last)
                grower_quad(&maker->grower, before + k, before + next, first + next, first + k);
            else
                grower_quad(&maker->grower, before + next, before + k, first + k, first + next);
        }
        before = first;
    }
}

/* ---- does it run into itself? ---- */

/* A place on the path. */
typedef struct Place {
    Vec3 at;
    double scale, along;
    size_t span;
} Place;

static int compare_places(const void *left, const void *right)
{
    const Place *a = left, *b = right;
    return a->at.x < b->at.x ? -1 : a->at.x > b->at.x;
}

/* Places on the path that are less than half a radius from each other. */
static Status list_places(const SweepMaker *maker, Place **places, size_t *n_places, double *largest, Error *error)
{
    size_t capacity = 0;
    for (size_t i = 0; i + 1 < maker->n_stations; i++) {
        const Station *a = &maker->stations[i], *b = a + 1;
        double radius = fmax(a->scale, b->scale);
        double steps = fmin(ceil((b->along - a->along) / (0.5 * radius)), 1000);
        *largest = fmax(*largest, radius);
        for (double k = 0; k < steps; k++) {
            double t = k / steps;
            if (!ARRAY_ROOM(*places, capacity, *n_places))
                return fail_memory(error, *n_places * sizeof **places, "a sweep");
            (*places)[(*n_places)++] =
                (Place){vec3_along(a->at, t, vec3_sub(b->at, a->at)), a->scale + t * (b->scale - a->scale),
                        a->along + t * (b->along - a->along), i};
        }
    }
    return STATUS_OK;
}

static bool runs_into(const SweepMaker *maker, const Place *a, const Place *b)
{
    double total = maker->stations[maker->n_stations - 1].along;
    double reach = a->scale + b->scale, apart = fabs(a->along - b->along);
    size_t spans = a->span > b->span ? a->span - b->span : b->span - a->span, n_spans = maker->n_stations - 1;
    if (maker->shape->closed) apart = fmin(apart, total - apart);
    if (maker->shape->closed && n_spans - spans < spans) spans = n_spans - spans;
    if (maker->shape->curve == SWEEP_LINEAR && spans < 2) return false; /* a mitre keeps neighbours apart */
    return apart > 90 * MEN_DEGREE * reach && vec3_length(vec3_sub(a->at, b->at)) < 0.999 * reach;
}

/* Of round sweeps: is the path elsewhere nearer than both radii? */
static Status find_overlap(const SweepMaker *maker, bool *found, Error *error)
{
    enum { MAX_TESTS = 100000000 };
    Place *places = NULL;
    size_t n = 0;
    double largest = 0;
    Status status = list_places(maker, &places, &n, &largest, error);
    if (status == STATUS_OK) qsort(places, n, sizeof *places, compare_places);
    int64_t tests = 0;
    for (size_t i = 0; status == STATUS_OK && i < n && !*found && tests < MAX_TESTS; i++)
        for (size_t k = i + 1; k < n && places[k].at.x - places[i].at.x < places[i].scale + largest; k++) {
            if (++tests >= MAX_TESTS) break;
            *found = runs_into(maker, &places[i], &places[k]);
            if (*found) break;
        }
    free(places);
    return status;
}

/* Whether the circle or the half ball at an end reaches through the plane of a station that is no farther along than runs_into asks of. */
static bool end_reaches_back(const SweepMaker *maker, bool last)
{
    const Station *stations = maker->stations, *end = &stations[last ? maker->n_stations - 1 : 0];
    Vec3 out = last ? end->tangent : negative(end->tangent);
    for (size_t i = 1; i + 1 < maker->n_stations; i++) {
        const Station *station = &stations[last ? maker->n_stations - 1 - i : i];
        if (fabs(end->along - station->along) > 90 * MEN_DEGREE * (end->scale + station->scale)) return false;
        Vec3 towards = last ? station->tangent : negative(station->tangent);
        double cosine = vec3_dot(towards, out), before = vec3_dot(vec3_sub(end->at, station->at), towards);
        double reach = cosine < 0 && maker->shape->round_ends ? 1 : sqrt(fmax(1 - cosine * cosine, 0));
        if (before < end->scale * reach * (1 - 1e-9)) return true;
    }
    return false;
}

/* ---- all ---- */

static Status make_circle(const SweepShape *shape, Outline2 *circle, Error *error)
{
    double largest = 0;
    for (size_t i = 0; i < shape->n_scales; i++) largest = fmax(largest, shape->scales[i]);
    if (!(largest > 0)) return fail(error, STATUS_SCENE, "a sweep of radius 0 has no volume");
    double wanted = 180 * MEN_DEGREE / acos(fmax(1 - shape->tolerance / largest, 0));
    unsigned n = shape->segments;
    if (!n) n = wanted > MAX_CIRCLE ? MAX_CIRCLE : wanted < MIN_CIRCLE ? MIN_CIRCLE : 4 * ((unsigned)wanted / 4 + 1);
    for (unsigned i = 0; i < n; i++) {
        double angle = 360 * MEN_DEGREE * i / n;
        Point2 at = {cos(angle), sin(angle)}, along = {-at.y, at.x};
        if (!outline2_add_point(circle, &(OutlinePoint2){.at = at, .arrive = along, .leave = along}))
            return fail_memory(error, n * sizeof(OutlinePoint2), "a sweep");
    }
    return outline2_end_loop(circle) ? STATUS_OK : fail_memory(error, n, "a sweep");
}

static Status make_path(SweepMaker *maker, Error *error)
{
    const SweepShape *shape = maker->shape;
    TRY(check_path(shape, error));
    if (shape->closed && shape->outline && fmod(shape->twist, 360) != 0)
        return fail(error, STATUS_SCENE,
                    "a closed sweep must be twisted by whole turns to meet itself, not by %g degrees", shape->twist);
    TRY(solve_path(maker, error));
    TRY(walk_path(maker, error));
    TRY(set_corners(maker, error));
    set_frames(maker);
    return STATUS_OK;
}

static Status make_surface(SweepMaker *maker, Error *error)
{
    const SweepShape *shape = maker->shape;
    for (size_t i = 0; i + 1 < maker->n_stations; i++) {
        TRY(add_span(maker, i, error));
        if (maker->grower.out_of_memory || maker->grower.too_large) return STATUS_OK; /* grower_finish will tell */
    }
    const Station *first = &maker->stations[0], *last = &maker->stations[maker->n_stations - 1];
    if (!shape->closed && shape->round_ends) {
        add_round_end(maker, first, false);
        add_round_end(maker, last, true);
    } else if (!shape->closed) {
        TRY(add_flat_end(maker, first, false, error));
        TRY(add_flat_end(maker, last, true, error));
    }
    return STATUS_OK;
}

/* Where its surface would pass through its own inside, that of the union of its pieces is made. */
static Status make_round(SweepMaker *maker, Pool *pool, Mesh **mesh, SweepFound *found, Error *error)
{
    bool meets_itself = maker->folds;
    Status status = meets_itself ? STATUS_OK : make_surface(maker, error);
    meets_itself |= maker->folds;
    if (!maker->shape->closed) meets_itself |= end_reaches_back(maker, false) || end_reaches_back(maker, true);
    if (status == STATUS_OK && !meets_itself) status = find_overlap(maker, &meets_itself, error);
    if (!meets_itself) return status == STATUS_OK ? grower_finish(&maker->grower, "the sweep", mesh, error) : status;
    grower_clear(&maker->grower);
    return sweep_make_union(maker->shape, maker->stations, maker->n_stations, pool, mesh, &found->reached, error);
}

static Status make_outlined(SweepMaker *maker, Mesh **mesh, SweepFound *found, Error *error)
{
    Status status = make_surface(maker, error);
    found->folds = maker->folds;
    if (maker->folds) found->fits = largest_fit(maker);
    return status == STATUS_OK ? grower_finish(&maker->grower, "the sweep", mesh, error) : status;
}

Status mesh_make_sweep(const SweepShape *shape, Pool *pool, Mesh **mesh, SweepFound *found, Error *error)
{
    Outline2 own = {0}, hollow = {0}; /* a circle, or the outline with shorter sides */
    SweepMaker maker = {.shape = shape, .outline = shape->outline, .twist = shape->outline ? shape->twist : 0};
    *found = (SweepFound){.folds = false};
    Status status = STATUS_OK;
    if (!shape->outline)
        status = make_circle(shape, &own, error);
    else if (maker.twist != 0)
        status = cut_sides(shape, &own, &hollow, error);
    if (own.n_points) maker.outline = &own;
    maker.hollow = hollow.n_points ? &hollow : maker.outline;
    if (status == STATUS_OK) status = make_path(&maker, error);
    if (status == STATUS_OK)
        status =
            shape->outline ? make_outlined(&maker, mesh, found, error) : make_round(&maker, pool, mesh, found, error);
    grower_clear(&maker.grower);
    free(maker.stations);
    free(maker.natural);
    outline2_clear(&own);
    outline2_clear(&hollow);
    return status;
}
