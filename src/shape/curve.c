/* curve.c - a curved profile turned about the y axis: cubic pieces through points, made into pairs of arcs.
 *
 * Every cubic piece is replaced by biarcs, two arcs that meet each other and the curve's ends with one tangent, halved
 * until they keep within a tolerance of it. So the solid is made of a few parts of tori, and its surface is smooth by
 * itself: the normals are those of the surface, and no shading has to hide any edges.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "shape/outline.h"
#include "shape/smooth.h"

enum {
    MAX_POINTS = 100000,
    MAX_DEPTH = 12, /* halvings of a piece */
    PROBES = 8      /* places of a piece that are held against the arcs */
};

/* A piece of the curve: Bezier's four points; a straight one needs only its ends. */
typedef struct Cubic {
    Dir2 p[4];
    bool straight;
    uint32_t source;
} Cubic;

typedef struct Curve {
    Outline *outline;
    double tolerance;
    uint32_t last; /* the number of the profile's last point */
} Curve;

static Dir2 dir2_mix(Dir2 a, Dir2 b, double t)
{
    return (Dir2){a.r + t * (b.r - a.r), a.y + t * (b.y - a.y)};
}

static double dir2_distance(Dir2 a, Dir2 b)
{
    return hypot(b.r - a.r, b.y - a.y);
}

static Dir2 cubic_at(const Cubic *c, double t)
{
    Dir2 a = dir2_mix(c->p[0], c->p[1], t), b = dir2_mix(c->p[1], c->p[2], t), d = dir2_mix(c->p[2], c->p[3], t);
    return dir2_mix(dir2_mix(a, b, t), dir2_mix(b, d, t), t);
}

static void cubic_halves(const Cubic *c, Cubic *first, Cubic *second)
{
    Dir2 a = dir2_mix(c->p[0], c->p[1], 0.5), b = dir2_mix(c->p[1], c->p[2], 0.5), d = dir2_mix(c->p[2], c->p[3], 0.5);
    Dir2 e = dir2_mix(a, b, 0.5), f = dir2_mix(b, d, 0.5), middle = dir2_mix(e, f, 0.5);
    *first = (Cubic){{c->p[0], a, e, middle}, false, c->source};
    *second = (Cubic){{middle, f, d, c->p[3]}, false, c->source};
}

/* The directions at both ends: towards the nearest other point that differs. */
static void cubic_ends(const Cubic *c, Dir2 *start, Dir2 *end)
{
    double small =
        1e-9 * (dir2_distance(c->p[0], c->p[1]) + dir2_distance(c->p[1], c->p[2]) + dir2_distance(c->p[2], c->p[3]));
    int i = 1, k = 2;
    while (i < 3 && dir2_distance(c->p[0], c->p[i]) <= small) i++;
    while (k > 0 && dir2_distance(c->p[3], c->p[k]) <= small) k--;
    *start = dir2_between(c->p[0].r, c->p[0].y, c->p[i].r, c->p[i].y);
    *end = dir2_between(c->p[k].r, c->p[k].y, c->p[3].r, c->p[3].y);
}

/* ---- biarcs ---- */

/* An arc from p in a direction to q; too flat for a circle, it is a straight edge. */
typedef struct CurveArc {
    Dir2 p, q, centre;
    double side, from, turned;
    bool flat;
} CurveArc;

static CurveArc arc_between(Dir2 p, Dir2 direction, Dir2 q)
{
    Dir2 normal = dir2_outward(direction);
    double r = q.r - p.r, y = q.y - p.y;
    double across = -(r * normal.r + y * normal.y), squared = r * r + y * y;
    CurveArc arc = {.p = p, .q = q, .flat = fabs(across) <= 1e-7 * sqrt(squared)};
    if (arc.flat) return arc;
    arc.side = squared / (2 * across);
    arc.centre = (Dir2){p.r - arc.side * normal.r, p.y - arc.side * normal.y};
    /* the middle of a sphere's cap belongs on the axis */
    if (fabs(arc.centre.r) < 1e-12 * fabs(arc.side)) arc.centre.r = 0;
    arc.from = atan2(normal.y, normal.r);
    arc.turned = 2 * atan2(across, r * direction.r + y * direction.y);
    return arc;
}

/* Two arcs with the directions a at p and b at q, whose joint is as far along one as along the other; false where there
 * are none. */
static bool biarc(Dir2 p, Dir2 a, Dir2 q, Dir2 b, CurveArc arcs[2])
{
    double r = q.r - p.r, y = q.y - p.y, squared = r * r + y * y;
    double along = r * (a.r + b.r) + y * (a.y + b.y), spread = 2 * (1 - (a.r * b.r + a.y * b.y));
    double root = sqrt(along * along + spread * squared);
    double length = squared / (along + root); /* of the tangents */
    if (!(along + root > 1e-9 * sqrt(squared)) || !(length < 1e3 * sqrt(squared))) return false;
    Dir2 u = {p.r + length * a.r, p.y + length * a.y}, v = {q.r - length * b.r, q.y - length * b.y};
    Dir2 joint = dir2_mix(u, v, 0.5);
    if (!(dir2_distance(u, v) > 0)) return false;
    arcs[0] = arc_between(p, a, joint);
    arcs[1] = arc_between(joint, dir2_between(u.r, u.y, v.r, v.y), q);
    return true;
}

/* How far a point is from an arc, or from its chord where it is flat. */
static double arc_distance(const CurveArc *arc, Dir2 at)
{
    if (!arc->flat) return fabs(dir2_distance(arc->centre, at) - fabs(arc->side));
    Dir2 along = dir2_between(arc->p.r, arc->p.y, arc->q.r, arc->q.y);
    return fabs((at.r - arc->p.r) * along.y - (at.y - arc->p.y) * along.r);
}

static bool arcs_fit(const CurveArc arcs[2], const Cubic *cubic, double tolerance)
{
    if (fabs(arcs[0].turned) > 1.6 || fabs(arcs[1].turned) > 1.6) return false;
    Dir2 joint = arcs[0].q, before = dir2_between(arcs[0].p.r, arcs[0].p.y, arcs[1].q.r, arcs[1].q.y);
    for (int i = 1; i < PROBES; i++) {
        Dir2 at = cubic_at(cubic, (double)i / PROBES);
        bool second = (at.r - joint.r) * before.r + (at.y - joint.y) * before.y > 0;
        if (arc_distance(&arcs[second], at) > tolerance) return false;
    }
    return true;
}

static bool add_curve_arc(Outline *outline, const CurveArc *arc, uint32_t source)
{
    if (arc->flat) return outline_add_point(outline, fmax(arc->p.r, 0), arc->p.y, source) != NULL;
    return outline_add_arc(outline, arc->p, arc->centre, arc->side, arc->from, arc->turned, source);
}

/* Adds a piece without its last point; false when memory ends. */
static bool add_cubic(const Curve *curve, const Cubic *cubic, int depth)
{
    Outline *outline = curve->outline;
    if (outline->n > OUTLINE_MAX_EDGES) return true; /* refused by the caller */
    Dir2 a, b;
    CurveArc arcs[2];
    cubic_ends(cubic, &a, &b);
    bool found = !cubic->straight && biarc(cubic->p[0], a, cubic->p[3], b, arcs);
    if (found && (depth == 0 || arcs_fit(arcs, cubic, curve->tolerance)))
        return add_curve_arc(outline, &arcs[0], cubic->source) && add_curve_arc(outline, &arcs[1], cubic->source);
    if (cubic->straight || depth == 0)
        return outline_add_point(outline, cubic->p[0].r, cubic->p[0].y, cubic->source) != NULL;
    Cubic first, second;
    cubic_halves(cubic, &first, &second);
    return add_cubic(curve, &first, depth - 1) && add_cubic(curve, &second, depth - 1);
}

/* ---- from points to cubic pieces ---- */

static Dir2 velocity_at(Dir2 before, Dir2 here, Dir2 after)
{
    double since = smooth_time(dir2_distance(before, here)), until = smooth_time(dir2_distance(here, after));
    return (Dir2){smooth_velocity(before.r, here.r, after.r, since, until),
                  smooth_velocity(before.y, here.y, after.y, since, until)};
}

static bool both_on_axis(Dir2 a, Dir2 b)
{
    return a.r == 0 && b.r == 0;
}

/* The piece from point i to the next one. At the axis the curve goes on into its mirror image; at a corner it ends
 * without bending. */
static Cubic smooth_piece(const Dir2 *points, const bool *corner, uint32_t n, uint32_t i)
{
    uint32_t k = (i + 1) % n;
    Dir2 p = points[i], q = points[k], before = points[(i + n - 1) % n], after = points[(k + 1) % n];
    Cubic cubic = {.p = {p, p, q, q}, .source = i, .straight = both_on_axis(p, q) || (corner[i] && corner[k])};
    if (cubic.straight) return cubic;
    if (p.r == 0) before = (Dir2){-q.r, q.y};
    if (q.r == 0) after = (Dir2){-p.r, p.y};
    Dir2 u = velocity_at(before, p, q), v = velocity_at(after, q, p); /* v: backwards */
    if (corner[i]) u = (Dir2){1.5 * (q.r - p.r) + 0.5 * v.r, 1.5 * (q.y - p.y) + 0.5 * v.y};
    if (corner[k]) v = (Dir2){1.5 * (p.r - q.r) + 0.5 * u.r, 1.5 * (p.y - q.y) + 0.5 * u.y};
    cubic.p[1] = (Dir2){p.r + u.r / 3, p.y + u.y / 3};
    cubic.p[2] = (Dir2){q.r + v.r / 3, q.y + v.y / 3};
    return cubic;
}

/* The same with a curvature that does not jump. */
static Status natural_pieces(const Dir2 *points, const bool *corner, uint32_t n, Cubic *cubics, Error *error)
{
    double *times = calloc(5 * (size_t)n, sizeof *times), *velocities = times + n;
    NaturalAt *at = calloc(n, sizeof *at);
    bool fine = times && at;
    for (uint32_t i = 0; fine && i < n; i++) {
        times[i] = smooth_time(dir2_distance(points[i], points[(i + 1) % n]));
        at[i] = corner[i] ? NATURAL_CORNER : points[i].r == 0 ? NATURAL_MIRRORED : NATURAL_PASSES;
    }
    fine = fine &&
           natural_velocities(
               &(NaturalPoints){.values = &points[0].r, .times = times, .at = at, .n = n, .width = 2, .closed = true},
               velocities);
    for (uint32_t i = 0; fine && i < n; i++) {
        uint32_t k = (i + 1) % n;
        Dir2 p = points[i], q = points[k];
        const double *u = velocities + 4 * (size_t)i, *v = u + 2;
        cubics[i] = (Cubic){.p = {p, {p.r + u[0] / 3, p.y + u[1] / 3}, {q.r - v[0] / 3, q.y - v[1] / 3}, q},
                            .source = i,
                            .straight = both_on_axis(p, q) || (corner[i] && corner[k])};
    }
    free(times);
    free(at);
    return fine ? STATUS_OK : fail_memory(error, 6 * (size_t)n * sizeof *times, "a profile");
}

static uint32_t bezier_pieces(const Dir2 *points, uint32_t n, Cubic *cubics)
{
    uint32_t n_cubics = 0;
    for (uint32_t i = 0; i + 2 < n; i += 3) {
        const Dir2 *p = &points[i];
        cubics[n_cubics++] = (Cubic){{p[0], p[1], p[2], points[(i + 3) % n]}, false, i};
    }
    Dir2 last = points[n - 1];
    if (n % 3 == 1 && dir2_distance(last, points[0]) > 0) /* closed by a straight edge */
        cubics[n_cubics++] = (Cubic){{last, last, points[0], points[0]}, true, n - 1};
    for (uint32_t i = 0; i < n_cubics; i++)
        if (both_on_axis(cubics[i].p[0], cubics[i].p[3]))
            cubics[i].straight |= cubics[i].p[1].r == 0 && cubics[i].p[2].r == 0;
    return n_cubics;
}

/* Puts the solid on the left of the walk. */
static void orient_pieces(Cubic *cubics, uint32_t n)
{
    double volume = 0;
    for (uint32_t i = 0; i < n; i++) {
        Dir2 a = cubics[i].p[0];
        for (int k = 1; k <= PROBES; k++) {
            Dir2 b = cubic_at(&cubics[i], (double)k / PROBES);
            volume += (a.r * a.r + a.r * b.r + b.r * b.r) * (b.y - a.y);
            a = b;
        }
    }
    if (volume >= 0) return;
    for (uint32_t i = 0; i < n; i++)
        cubics[i] = (Cubic){
            {cubics[i].p[3], cubics[i].p[2], cubics[i].p[1], cubics[i].p[0]}, cubics[i].straight, cubics[i].source};
    for (uint32_t i = 0, k = n - 1; i < k; i++, k--) {
        Cubic keep = cubics[i];
        cubics[i] = cubics[k];
        cubics[k] = keep;
    }
}

static Status check_points(const double (*profile)[2], uint32_t n, LatheCurve kind, Error *error)
{
    if (n < 3) return fail(error, STATUS_SCENE, "a profile needs at least 3 points; this one has %u", n);
    if (n > MAX_POINTS)
        return fail(error, STATUS_SCENE, "a profile may have at most %d points; this one has %u", MAX_POINTS, n);
    if (kind == LATHE_BEZIER && n % 3 == 2)
        return fail(error, STATUS_SCENE,
                    "a profile of Bezier pieces has 3 points for each piece, and one more where it does not end at its "
                    "beginning; this one has %u",
                    n);
    for (uint32_t i = 0; i < n; i++) {
        double r = profile[i][0], y = profile[i][1];
        if (!(fabs(r) <= 1e15) || !(fabs(y) <= 1e15))
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is not within +-1e15", i, r, y);
        bool control = kind == LATHE_BEZIER && i % 3 != 0;
        if (r < 0 && !control)
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is left of the axis; r must not be negative", i, r,
                        y);
        if (i && kind != LATHE_BEZIER && r == profile[i - 1][0] && y == profile[i - 1][1])
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> repeats the point before it", i, r, y);
    }
    if (kind != LATHE_BEZIER && profile[0][0] == profile[n - 1][0] && profile[0][1] == profile[n - 1][1])
        return fail(error, STATUS_SCENE, "profile[%u] repeats the first point; the curve is closed without it", n - 1);
    return STATUS_OK;
}

static Status check_axis(const Cubic *cubics, uint32_t n, double size, Error *error)
{
    for (uint32_t i = 0; i < n; i++)
        for (int k = 1; k < 4 * PROBES; k++) {
            Dir2 at = cubic_at(&cubics[i], (double)k / (4 * PROBES));
            if (at.r < -1e-12 * size)
                return fail(error, STATUS_SCENE,
                            "the curve crosses the axis behind profile[%u], at height %g; add points or corners",
                            cubics[i].source, at.y);
        }
    return STATUS_OK;
}

static Status curve_outline(const Cubic *cubics, uint32_t n, Curve *curve, Error *error)
{
    Outline *outline = curve->outline;
    for (uint32_t i = 0; i < n; i++) {
        size_t first = outline->n;
        if (!add_cubic(curve, &cubics[i], MAX_DEPTH))
            return fail_memory(error, outline->n * sizeof *outline->points, "a profile");
        if (first < outline->n)
            outline->points[first].given_in = false; /* a straight edge before it has its own normal */
        for (size_t k = first; k < outline->n; k++) outline->points[k].closes = cubics[i].source == curve->last;
        if (outline->n > OUTLINE_MAX_EDGES)
            return fail(error, STATUS_SCENE, "the profile makes more than %d edges; use fewer points",
                        OUTLINE_MAX_EDGES);
    }
    return STATUS_OK;
}

Status solid_make_curved_lathe(const double (*profile)[2], uint32_t n, LatheCurve kind, const bool *corner,
                               double tolerance, Solid **solid, Error *error)
{
    TRY(check_points(profile, n, kind, error));
    Dir2 *points = calloc(n, sizeof *points);
    Cubic *cubics = calloc(n, sizeof *cubics);
    if (!points || !cubics) {
        free(points);
        free(cubics);
        return fail_memory(error, n * sizeof *cubics, "a profile");
    }
    double low = 0, high = 0, size = 0;
    for (uint32_t i = 0; i < n; i++) {
        points[i] = (Dir2){profile[i][0] + 0.0, profile[i][1] + 0.0}; /* -0 becomes 0 */
        low = i ? fmin(low, points[i].y) : points[i].y;
        high = i ? fmax(high, points[i].y) : points[i].y;
        size = fmax(size, points[i].r);
    }
    size = fmax(size, high - low);
    uint32_t n_cubics = n;
    if (kind == LATHE_BEZIER) n_cubics = bezier_pieces(points, n, cubics);
    for (uint32_t i = 0; kind == LATHE_CUBIC && i < n; i++) cubics[i] = smooth_piece(points, corner, n, i);
    Status status = kind == LATHE_NATURAL ? natural_pieces(points, corner, n, cubics, error) : STATUS_OK;
    Outline outline = {0};
    Curve curve = {&outline, tolerance > 0 ? fmax(tolerance, 1e-12 * size) : 1e-5 * size, n - 1};
    if (status == STATUS_OK) {
        orient_pieces(cubics, n_cubics);
        status = check_axis(cubics, n_cubics, size, error);
    }
    if (status == STATUS_OK) status = curve_outline(cubics, n_cubics, &curve, error);
    if (status == STATUS_OK) status = outline_finish(&outline, false, solid, error);
    outline_clear(&outline);
    free(points);
    free(cubics);
    return status;
}
