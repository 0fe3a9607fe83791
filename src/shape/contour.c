/* contour.c - closed curves in a plane, from lines and curves to points that keep their directions.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/contour.h"

#include <math.h>
#include <stdlib.h>

#include "base/angle.h"
#include "shape/smooth.h"

enum { MAX_STEPS = 4096, DEGREES_PER_STEP = 5 };

static Point2 mixed(Point2 a, Point2 b, double t)
{
    return (Point2){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
}

/* from a to b; without extent the fallback */
static Point2 direction(Point2 a, Point2 b, Point2 fallback)
{
    double length = hypot(b.x - a.x, b.y - a.y);
    return length > 0 ? (Point2){(b.x - a.x) / length, (b.y - a.y) / length} : fallback;
}

static double turn(Point2 a, Point2 b)
{
    return fabs(atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y));
}

static void add_point(Pen *pen, Point2 at, Point2 arrive, Point2 leave)
{
    OutlinePoint2 point = {at, arrive, leave, pen->source};
    if (pen->outline->n_points >= POLYGON_MAX_POINTS || !outline2_add_point(pen->outline, &point)) pen->failed = true;
}

void pen_begin(Pen *pen, Point2 at)
{
    pen->start = pen->at = at;
    pen->arrive = (Point2){0, 0};
    pen->first = pen->outline->n_points;
}

void pen_line(Pen *pen, Point2 to)
{
    if (to.x == pen->at.x && to.y == pen->at.y) return;
    Point2 along = direction(pen->at, to, pen->arrive);
    add_point(pen, pen->at, pen->arrive, along);
    pen->arrive = along;
    pen->at = to;
}

static Point2 cubic_point(const Point2 p[4], double t)
{
    Point2 a = mixed(p[0], p[1], t), b = mixed(p[1], p[2], t), c = mixed(p[2], p[3], t);
    return mixed(mixed(a, b, t), mixed(b, c, t), t);
}

static Point2 cubic_direction(const Point2 p[4], double t)
{
    if (t == 0) return direction(p[0], p[1], direction(p[0], p[2], direction(p[0], p[3], (Point2){1, 0})));
    if (t == 1) return direction(p[2], p[3], direction(p[1], p[3], direction(p[0], p[3], (Point2){1, 0})));
    Point2 a = mixed(p[0], p[1], t), b = mixed(p[1], p[2], t), c = mixed(p[2], p[3], t);
    return direction(mixed(a, b, t), mixed(b, c, t), direction(p[0], p[3], (Point2){1, 0}));
}

static unsigned cubic_steps(const Point2 p[4], double tolerance)
{
    double bend = fmax(hypot(p[0].x - 2 * p[1].x + p[2].x, p[0].y - 2 * p[1].y + p[2].y),
                       hypot(p[1].x - 2 * p[2].x + p[3].x, p[1].y - 2 * p[2].y + p[3].y));
    Point2 along = cubic_direction(p, 0);
    Point2 second = direction(p[1], p[2], along), third = direction(p[2], p[3], second);
    double turning = turn(along, second) + turn(second, third);
    /* a chord of a curve with a second derivative of at most 6 bend, over a step of 1 / n, is off by 6 bend / 8 n^2 */
    double n = fmax(sqrt(0.75 * bend / tolerance), turning / (DEGREES_PER_STEP * MEN_DEGREE));
    return n < 1 ? 1 : n > MAX_STEPS ? MAX_STEPS : (unsigned)ceil(n);
}

void pen_cubic(Pen *pen, Point2 control1, Point2 control2, Point2 to)
{
    const Point2 p[4] = {pen->at, control1, control2, to};
    unsigned n = cubic_steps(p, pen->tolerance);
    for (unsigned i = 0; i < n; i++) {
        Point2 along = cubic_direction(p, (double)i / n);
        add_point(pen, i ? cubic_point(p, (double)i / n) : pen->at, i ? along : pen->arrive, along);
    }
    pen->arrive = cubic_direction(p, 1);
    pen->at = to;
}

void pen_end(Pen *pen)
{
    pen_line(pen, pen->start);
    Outline2 *outline = pen->outline;
    if (pen->failed || outline->n_points < pen->first + 3) {
        outline->n_points = pen->first;
        return;
    }
    outline->points[pen->first].arrive = pen->arrive;
    for (size_t i = pen->first; i < outline->n_points; i++) {
        OutlinePoint2 *point = &outline->points[i];
        if (turn(point->arrive, point->leave) > pen->smooth_degrees * MEN_DEGREE) continue;
        Point2 sum = {point->arrive.x + point->leave.x, point->arrive.y + point->leave.y};
        point->arrive = point->leave = direction((Point2){0, 0}, sum, point->leave);
    }
    if (!outline2_end_loop(outline)) pen->failed = true;
}

static double time_between(Point2 a, Point2 b)
{
    return smooth_time(hypot(b.x - a.x, b.y - a.y));
}

/* The smooth curve from p[1] to p[2], with Bezier's controls. */
static void draw_smooth_step(Pen *pen, const Point2 p[4])
{
    double t[3] = {time_between(p[0], p[1]), time_between(p[1], p[2]), time_between(p[2], p[3])};
    Point2 control1 = {p[1].x + smooth_velocity(p[0].x, p[1].x, p[2].x, t[0], t[1]) / 3,
                       p[1].y + smooth_velocity(p[0].y, p[1].y, p[2].y, t[0], t[1]) / 3};
    Point2 control2 = {p[2].x + smooth_velocity(p[3].x, p[2].x, p[1].x, t[2], t[1]) / 3, /* backwards */
                       p[2].y + smooth_velocity(p[3].y, p[2].y, p[1].y, t[2], t[1]) / 3};
    pen_cubic(pen, control1, control2, p[2]);
}

/* The points without those that stand there twice, which are corners, and by which point of the list each is. */
typedef struct Distinct {
    double *xy, *times, *velocities;
    NaturalAt *at;
    size_t *source;
    size_t n;
} Distinct;

static bool distinct_new(Distinct *distinct, const double *xy, size_t n)
{
    double *numbers = calloc(7 * n, sizeof *numbers);
    *distinct = (Distinct){.xy = numbers, .at = calloc(n, sizeof(NaturalAt)), .source = calloc(n, sizeof(size_t))};
    if (!numbers || !distinct->at || !distinct->source) return false;
    distinct->times = numbers + 2 * n;
    distinct->velocities = numbers + 3 * n;
    for (size_t i = 0; i < n; i++) {
        size_t k = distinct->n;
        if (k && xy[2 * i] == xy[2 * i - 2] && xy[2 * i + 1] == xy[2 * i - 1]) {
            distinct->at[k - 1] = NATURAL_CORNER;
            continue;
        }
        distinct->xy[2 * k] = xy[2 * i];
        distinct->xy[2 * k + 1] = xy[2 * i + 1];
        distinct->source[k] = i;
        distinct->n++;
    }
    const double *last = distinct->xy + 2 * distinct->n - 2; /* the loop goes back to the first by itself */
    if (distinct->n > 1 && last[0] == xy[0] && last[1] == xy[1]) distinct->n--;
    for (size_t i = 0; i < distinct->n; i++) {
        const double *p = distinct->xy + 2 * i, *q = distinct->xy + 2 * ((i + 1) % distinct->n);
        distinct->times[i] = smooth_time(hypot(q[0] - p[0], q[1] - p[1]));
        if (distinct->n < 3) distinct->at[i] = NATURAL_CORNER; /* there and back */
    }
    return true;
}

static void distinct_clear(Distinct *distinct)
{
    free(distinct->xy);
    free(distinct->at);
    free(distinct->source);
}

/* The pen stands at the first point. */
static void draw_natural(Pen *pen, const double *xy, size_t n)
{
    Distinct distinct;
    uint32_t source = pen->source;
    bool fine = distinct_new(&distinct, xy, n);
    if (fine && distinct.n > 1)
        fine = natural_velocities(&(NaturalPoints){.values = distinct.xy,
                                                   .times = distinct.times,
                                                   .at = distinct.at,
                                                   .n = distinct.n,
                                                   .width = 2,
                                                   .closed = true},
                                  distinct.velocities);
    for (size_t i = 0; fine && distinct.n > 1 && i < distinct.n && !pen->failed; i++) {
        const double *p = distinct.xy + 2 * i, *q = distinct.xy + 2 * ((i + 1) % distinct.n);
        const double *u = distinct.velocities + 4 * i, *v = u + 2;
        pen->source = source + (uint32_t)distinct.source[i];
        pen_cubic(pen, (Point2){p[0] + u[0] / 3, p[1] + u[1] / 3}, (Point2){q[0] - v[0] / 3, q[1] - v[1] / 3},
                  (Point2){q[0], q[1]});
    }
    distinct_clear(&distinct);
    pen->failed |= !fine;
}

Status contour_draw(Pen *pen, ContourKind kind, const double *xy, size_t n, Error *error)
{
#define AT(i) ((Point2){xy[2 * ((i) % n)], xy[2 * ((i) % n) + 1]})
    if (n < 3) return fail(error, STATUS_SCENE, "an outline needs at least 3 points; this one has %zu", n);
    if (kind == CONTOUR_BEZIER && n % 3 != 0)
        return fail(error, STATUS_SCENE,
                    "an outline of Bezier curves has its points in threes, one on the curve and two controls; "
                    "this one has %zu points",
                    n);
    uint32_t source = pen->source;
    if (kind != CONTOUR_BEZIER) /* a last point that repeats the first closes the loop, as POV-Ray's do */
        while (n > 3 && xy[0] == xy[2 * n - 2] && xy[1] == xy[2 * n - 1]) n--;
    pen_begin(pen, AT(0));
    if (kind == CONTOUR_NATURAL) draw_natural(pen, xy, n);
    for (size_t i = 0; kind != CONTOUR_NATURAL && i < n && !pen->failed; i += kind == CONTOUR_BEZIER ? 3 : 1) {
        pen->source = source + (uint32_t)i;
        const Point2 around[4] = {AT(i + n - 1), AT(i), AT(i + 1), AT(i + 2)};
        if (kind == CONTOUR_LINEAR) pen_line(pen, AT(i + 1));
        if (kind == CONTOUR_CUBIC) draw_smooth_step(pen, around);
        if (kind == CONTOUR_BEZIER) pen_cubic(pen, AT(i + 1), AT(i + 2), AT(i + 3));
    }
    pen_end(pen);
#undef AT
    if (!pen->failed) return STATUS_OK;
    if (pen->outline->n_points < POLYGON_MAX_POINTS) return fail_memory(error, 0, "an outline");
    return fail(error, STATUS_SCENE, "the outline has more than %d points; make its tolerance larger",
                POLYGON_MAX_POINTS);
}
