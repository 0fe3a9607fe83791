/* lathe.c - a profile turned about the y axis: checked, rounded, and made into bands and arcs.
 * The profile is a closed polygon in the half plane (r, y). Walked counter-clockwise (r to the right, y up)
 * the solid is on the left. Steps: clean the corners, orient, replace rounded corners by arcs, set normals,
 * search for crossings, make pieces. An arc stands in the outline as a run of short edges, for the search, and becomes
 * one piece in the end, exactly round.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "geom/piece.h"

static const double pi = 3.14159265358979323846;
static const double degree = 3.14159265358979323846 / 180;

enum {
    MAX_POINTS = 100000,
    MAX_EDGES = 200000,
    MAX_TESTS = 1000000000, /* box tests in the search for crossings */
    ARC_STEP_DEGREES = 1    /* of the search for crossings */
};

/* A point of the profile as written, with the length of the edges that its rounding takes away. */
typedef struct Corner {
    double r, y;
    double round, tangent;
    uint32_t source; /* its number in the caller's profile */
} Corner;

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
} OutlinePoint;

typedef struct Outline {
    OutlinePoint *points;
    size_t n, capacity;
    Arc *arcs; /* number 0 is none */
    size_t n_arcs, arcs_capacity;
} Outline;

static Dir2 direction(double r0, double y0, double r1, double y1)
{
    double length = hypot(r1 - r0, y1 - y0);
    return (Dir2){(r1 - r0) / length, (y1 - y0) / length};
}

/* With the solid on the left, outside is on the right. */
static Dir2 outward(Dir2 along)
{
    return (Dir2){along.y, -along.r};
}

/* The angle from a to b, in (-pi, pi], positive to the left. */
static double turn(Dir2 a, Dir2 b)
{
    return atan2(a.r * b.y - a.y * b.r, a.r * b.r + a.y * b.y);
}

static Status check_points(const double (*profile)[2], uint32_t n, const double *round, Error *error)
{
    if (n < 3) return fail(error, STATUS_SCENE, "a profile needs at least 3 points; this one has %u", n);
    if (n > MAX_POINTS)
        return fail(error, STATUS_SCENE, "a profile may have at most %d points; this one has %u", MAX_POINTS, n);
    for (uint32_t i = 0; i < n; i++) {
        double r = profile[i][0];
        double y = profile[i][1];
        if (!(fabs(r) <= 1e15) || !(fabs(y) <= 1e15))
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is not within +-1e15", i, r, y);
        if (r < 0)
            return fail(error, STATUS_SCENE, "profile[%u] = <%g, %g> is left of the axis; r must not be negative", i, r,
                        y);
        if (round && !(round[i] >= 0 && round[i] <= 1e15))
            return fail(error, STATUS_SCENE, "the rounding %g of profile[%u] = <%g, %g> is not within 0..1e15",
                        round[i], i, r, y);
    }
    return STATUS_OK;
}

/* Copies the points without repetitions; returns how many. */
static uint32_t clean_corners(const double (*profile)[2], uint32_t n, const double *round, Corner *corners)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        Corner corner = {profile[i][0] + 0.0, profile[i][1] + 0.0, round ? round[i] : 0, 0, i}; /* -0 becomes 0 */
        if (kept && corners[kept - 1].r == corner.r && corners[kept - 1].y == corner.y) {
            corners[kept - 1].round = fmax(corners[kept - 1].round, corner.round);
            continue;
        }
        corners[kept++] = corner;
    }
    while (kept > 1 && corners[0].r == corners[kept - 1].r && corners[0].y == corners[kept - 1].y) {
        kept--;
        corners[0].round = fmax(corners[0].round, corners[kept].round);
    }
    return kept;
}

/* Puts the solid on the left of the walk. */
static void orient_corners(Corner *corners, uint32_t n)
{
    double volume = 0;
    for (uint32_t i = 0; i < n; i++) {
        const Corner *a = &corners[i];
        const Corner *b = &corners[(i + 1) % n];
        volume += (a->r * a->r + a->r * b->r + b->r * b->r) * (b->y - a->y);
    }
    if (volume >= 0) return;
    for (uint32_t i = 0, k = n - 1; i < k; i++, k--) {
        Corner keep = corners[i];
        corners[i] = corners[k];
        corners[k] = keep;
    }
}

static bool on_axis(const Corner *a, const Corner *b)
{
    return a->r == 0 && b->r == 0;
}

/* The directions in which the outline comes to corner i and goes from it. At an end on the axis the other
 * side is the mirror image's: there the outline arrives, or starts, horizontally. False where both edges
 * lie on the axis. */
static bool corner_directions(const Corner *corners, uint32_t n, uint32_t i, Dir2 *in, Dir2 *out)
{
    const Corner *before = &corners[(i + n - 1) % n];
    const Corner *here = &corners[i];
    const Corner *after = &corners[(i + 1) % n];
    bool axis_in = on_axis(before, here);
    bool axis_out = on_axis(here, after);
    if (axis_in && axis_out) return false;
    *in = axis_in ? (Dir2){1, 0} : direction(before->r, before->y, here->r, here->y);
    *out = axis_out ? (Dir2){-1, 0} : direction(here->r, here->y, after->r, after->y);
    return true;
}

/* How much of its edges each rounding takes. */
static Status measure_roundings(Corner *corners, uint32_t n, Error *error)
{
    for (uint32_t i = 0; i < n; i++) {
        Corner *corner = &corners[i];
        Dir2 in, out;
        if (!corner_directions(corners, n, i, &in, &out)) continue;
        double angle = fabs(turn(in, out));
        bool tip = on_axis(&corners[(i + n - 1) % n], corner) || on_axis(corner, &corners[(i + 1) % n]);
        if (!tip && angle > 179.999999 * degree)
            return fail(error, STATUS_SCENE, "the profile turns back on itself at profile[%u] = <%g, %g>",
                        corner->source, corner->r, corner->y);
        if (corner->round == 0 || angle < 1e-9) continue;
        if (!tip && corner->r == 0)
            return fail(error, STATUS_SCENE,
                        "profile[%u] = <%g, %g> touches the axis between two edges and cannot be rounded",
                        corner->source, corner->r, corner->y);
        corner->tangent = corner->round * tan(tip ? angle : angle / 2); /* a tip's arc is half of one */
    }
    for (uint32_t i = 0; i < n; i++) {
        const Corner *a = &corners[i];
        const Corner *b = &corners[(i + 1) % n];
        if (on_axis(a, b) || a->tangent + b->tangent == 0) continue;
        double length = hypot(b->r - a->r, b->y - a->y);
        if (a->tangent + b->tangent > length * (1 + 1e-12))
            return fail(error, STATUS_SCENE,
                        "the edge from profile[%u] = <%g, %g> to profile[%u] = <%g, %g> is %g long; rounding takes %g "
                        "of it at the "
                        "first point and %g at the second",
                        a->source, a->r, a->y, b->source, b->r, b->y, length, a->tangent, b->tangent);
    }
    return STATUS_OK;
}

static OutlinePoint *add_point(Outline *outline, double r, double y, uint32_t source)
{
    if (!ARRAY_ROOM(outline->points, outline->capacity, outline->n)) return NULL;
    OutlinePoint *point = &outline->points[outline->n++];
    *point = (OutlinePoint){.r = r, .y = y, .source = source};
    return point;
}

static void give_in(OutlinePoint *point, Dir2 normal)
{
    point->normal_in = normal;
    point->given_in = true;
}

static void give_out(OutlinePoint *point, Dir2 normal)
{
    point->normal_out = normal;
    point->given_out = true;
}

/* A part of an arc that does not turn from up to down: its normals go from `angle` by `turned`; its last point is left
 * to what comes behind. side is the radius, negative where the solid is outside of the circle. */
static bool add_monotonic_arc(Outline *outline, Dir2 centre, double side, double angle, double turned, uint32_t source)
{
    if (!ARRAY_ROOM(outline->arcs, outline->arcs_capacity, outline->n_arcs + 1)) return false;
    if (outline->n_arcs == 0) outline->arcs[outline->n_arcs++] = (Arc){{0, 0}, false};
    uint32_t arc = (uint32_t)outline->n_arcs;
    outline->arcs[outline->n_arcs++] = (Arc){centre, side * cos(angle + 0.5 * turned) > 0};
    unsigned steps = (unsigned)ceil(fabs(turned) / (ARC_STEP_DEGREES * degree) - 1e-9);
    if (steps == 0) steps = 1;
    for (unsigned k = 0; k < steps; k++) {
        Dir2 normal = {cos(angle + turned * k / steps), sin(angle + turned * k / steps)};
        if (fabs(normal.r) < 1e-15) normal.r = 0;
        OutlinePoint *point =
            add_point(outline, fmax(centre.r + side * normal.r, 0), centre.y + side * normal.y, source);
        if (!point) return false;
        point->arc = arc;
        give_in(point, normal);
        give_out(point, normal);
    }
    return true;
}

/* The arc at a corner whose tangent is not 0, from the edge before it to the edge behind it. */
static bool add_arc(Outline *outline, const Corner *corner, Dir2 in, Dir2 out)
{
    double angle = turn(in, out);
    double side = angle > 0 ? corner->round : -corner->round; /* from the arc's centre along the normal */
    bool starts_on_axis = corner->r == 0 && in.r == 1 && in.y == 0;
    bool ends_on_axis = corner->r == 0 && out.r == -1 && out.y == 0;
    Dir2 centre; /* from the tangent point on an edge that is really there */
    if (starts_on_axis)
        centre = (Dir2){0, corner->y + corner->tangent * out.y + side * out.r};
    else
        centre = (Dir2){ends_on_axis ? 0 : corner->r - corner->tangent * in.r - side * in.y,
                        corner->y - corner->tangent * in.y + side * in.r};
    /* cut where it turns between up and down */
    Dir2 normal = outward(in);
    double from = atan2(normal.y, normal.r), end = from + angle;
    for (double at = from; at != end;) {
        double quarters = (at / pi - 0.5) * (angle > 0 ? 1 : -1);
        double next = (floor(quarters + 1e-9) + 1) * (angle > 0 ? 1 : -1) * pi + 0.5 * pi;
        if (fabs(next - from) > fabs(angle) - 1e-9) next = end;
        if (!add_monotonic_arc(outline, centre, side, at, next - at, corner->source)) return false;
        at = next;
    }
    normal = outward(out);
    OutlinePoint *last = add_point(outline, ends_on_axis ? 0 : fmax(centre.r + side * normal.r, 0),
                                   centre.y + side * normal.y, corner->source);
    if (!last) return false;
    give_in(last, normal);
    give_out(last, normal);
    return true;
}

/* Where roundings leave nothing of an edge, the arc's end and the next point are one. */
static void merge_points(Outline *outline)
{
    double size = 0;
    for (size_t i = 0; i < outline->n; i++)
        size = fmax(size, fmax(fabs(outline->points[i].r), fabs(outline->points[i].y)));
    size_t kept = 0;
    for (size_t i = 0; i < outline->n; i++) {
        const OutlinePoint *point = &outline->points[i];
        OutlinePoint *last = kept ? &outline->points[kept - 1] : &outline->points[outline->n - 1];
        bool same = outline->n > 3 && fmax(fabs(last->r - point->r), fabs(last->y - point->y)) <= 1e-12 * size &&
                    (last->given_out || point->given_in);
        if (!same) {
            outline->points[kept++] = *point;
            continue;
        }
        last->arc = point->arc;
        last->normal_out = point->normal_out;
        last->given_out = point->given_out;
        if (point->r == 0) last->r = 0;
    }
    outline->n = kept;
}

static Status make_outline(const Corner *corners, uint32_t n, Outline *outline, Error *error)
{
    for (uint32_t i = 0; i < n; i++) {
        const Corner *corner = &corners[i];
        Dir2 in, out;
        if (!corner_directions(corners, n, i, &in, &out)) continue;
        bool added = corner->tangent > 0 ? add_arc(outline, corner, in, out)
                                         : add_point(outline, corner->r, corner->y, corner->source) != NULL;
        if (!added) return fail_memory(error, outline->n * sizeof *outline->points, "a profile");
        if (outline->n > MAX_EDGES)
            return fail(error, STATUS_SCENE, "the profile makes more than %d edges; round fewer of its corners",
                        MAX_EDGES);
    }
    merge_points(outline);
    return STATUS_OK;
}

static bool edge_on_axis(const Outline *outline, size_t i)
{
    return outline->points[i].r == 0 && outline->points[(i + 1) % outline->n].r == 0;
}

static Dir2 edge_direction(const Outline *outline, size_t i)
{
    const OutlinePoint *a = &outline->points[i];
    const OutlinePoint *b = &outline->points[(i + 1) % outline->n];
    return direction(a->r, a->y, b->r, b->y);
}

/* Fills the normals that no arc has given. */
static void set_normals(Outline *outline, bool smooth_all)
{
    const double limit = cos(40 * degree);
    for (size_t i = 0; i < outline->n; i++) {
        OutlinePoint *point = &outline->points[i];
        size_t edge_in = (i + outline->n - 1) % outline->n;
        bool axis_in = edge_on_axis(outline, edge_in);
        bool axis_out = edge_on_axis(outline, i);
        Dir2 in = axis_in ? (Dir2){0, -1} : outward(edge_direction(outline, edge_in));
        Dir2 out = axis_out ? (Dir2){0, 1} : outward(edge_direction(outline, i));
        bool smooth = smooth_all && !point->given_in && !point->given_out;
        if (smooth && (axis_in || axis_out)) {
            /* On the axis the surface meets its mirror image: it turns by twice the angle to the axis. */
            double c = in.r * out.r + in.y * out.y;
            if (2 * c * c - 1 > limit && c > 0) {
                if (axis_in)
                    out = in;
                else
                    in = out;
            }
        } else if (smooth && in.r * out.r + in.y * out.y > limit) {
            double length = hypot(in.r + out.r, in.y + out.y);
            in = out = (Dir2){(in.r + out.r) / length, (in.y + out.y) / length};
        }
        if (!point->given_in) point->normal_in = in;
        if (!point->given_out) point->normal_out = out;
    }
}

/* The search for crossings: boxes around runs of consecutive edges, in a binary tree whose node k covers
 * a range of edges and has children 2k and 2k + 1. */
typedef struct EdgeBox {
    double r0, y0, r1, y1;
} EdgeBox;

typedef struct CrossingSearch {
    const Outline *outline;
    EdgeBox *boxes;
    size_t n_tests;
    size_t edge_a, edge_b; /* a pair that meets */
    bool found, given_up;
} CrossingSearch;

static void fill_boxes(CrossingSearch *search, size_t node, size_t first, size_t count)
{
    EdgeBox *box = &search->boxes[node];
    if (count == 1) {
        const OutlinePoint *a = &search->outline->points[first];
        const OutlinePoint *b = &search->outline->points[(first + 1) % search->outline->n];
        *box = (EdgeBox){fmin(a->r, b->r), fmin(a->y, b->y), fmax(a->r, b->r), fmax(a->y, b->y)};
        return;
    }
    fill_boxes(search, 2 * node, first, count / 2);
    fill_boxes(search, 2 * node + 1, first + count / 2, count - count / 2);
    const EdgeBox *a = &search->boxes[2 * node];
    const EdgeBox *b = &search->boxes[2 * node + 1];
    *box = (EdgeBox){fmin(a->r0, b->r0), fmin(a->y0, b->y0), fmax(a->r1, b->r1), fmax(a->y1, b->y1)};
}

/* Which side of the line from a to b the point c is on: 1 left, -1 right, 0 on it. */
static int side_of(const OutlinePoint *a, const OutlinePoint *b, const OutlinePoint *c)
{
    double area = (b->r - a->r) * (c->y - a->y) - (b->y - a->y) * (c->r - a->r);
    return (area > 0) - (area < 0);
}

/* c, known to be on the line through a and b, stands between them and off the axis. */
static bool touches(const OutlinePoint *a, const OutlinePoint *b, const OutlinePoint *c)
{
    return c->r > 0 && c->r >= fmin(a->r, b->r) && c->r <= fmax(a->r, b->r) && c->y >= fmin(a->y, b->y) &&
           c->y <= fmax(a->y, b->y);
}

static bool edges_meet(const Outline *outline, size_t i, size_t k)
{
    size_t n = outline->n;
    if ((i + 1) % n == k || (k + 1) % n == i) return false; /* neighbours share a point */
    if (edge_on_axis(outline, i) || edge_on_axis(outline, k)) return false;
    const OutlinePoint *a = &outline->points[i];
    const OutlinePoint *b = &outline->points[(i + 1) % n];
    const OutlinePoint *c = &outline->points[k];
    const OutlinePoint *d = &outline->points[(k + 1) % n];
    int abc = side_of(a, b, c);
    int abd = side_of(a, b, d);
    int cda = side_of(c, d, a);
    int cdb = side_of(c, d, b);
    if (abc * abd < 0 && cda * cdb < 0) return true;
    return (abc == 0 && touches(a, b, c)) || (abd == 0 && touches(a, b, d)) || (cda == 0 && touches(c, d, a)) ||
           (cdb == 0 && touches(c, d, b));
}

typedef struct EdgeRun {
    size_t node, first, count;
} EdgeRun;

static EdgeRun first_half(EdgeRun run)
{
    return (EdgeRun){2 * run.node, run.first, run.count / 2};
}

static EdgeRun second_half(EdgeRun run)
{
    return (EdgeRun){2 * run.node + 1, run.first + run.count / 2, run.count - run.count / 2};
}

static void search_between(CrossingSearch *search, EdgeRun a, EdgeRun b)
{
    if (search->found || search->given_up) return;
    if (++search->n_tests > MAX_TESTS) {
        search->given_up = true;
        return;
    }
    const EdgeBox *p = &search->boxes[a.node];
    const EdgeBox *q = &search->boxes[b.node];
    if (p->r0 > q->r1 || q->r0 > p->r1 || p->y0 > q->y1 || q->y0 > p->y1) return;
    if (a.count == 1 && b.count == 1) {
        if (!edges_meet(search->outline, a.first, b.first)) return;
        search->found = true;
        search->edge_a = a.first;
        search->edge_b = b.first;
    } else if (a.count >= b.count) {
        search_between(search, first_half(a), b);
        search_between(search, second_half(a), b);
    } else {
        search_between(search, a, first_half(b));
        search_between(search, a, second_half(b));
    }
}

static void search_within(CrossingSearch *search, EdgeRun run)
{
    if (run.count == 1) return;
    search_within(search, first_half(run));
    search_within(search, second_half(run));
    search_between(search, first_half(run), second_half(run));
}

static Status check_crossings(const Outline *outline, Error *error)
{
    size_t room = 2;
    while (room < outline->n) room *= 2;
    CrossingSearch search = {.outline = outline, .boxes = calloc(2 * room, sizeof(EdgeBox))};
    if (!search.boxes) return fail_memory(error, 2 * room * sizeof(EdgeBox), "the check of a profile");
    fill_boxes(&search, 1, 0, outline->n);
    search_within(&search, (EdgeRun){1, 0, outline->n});
    free(search.boxes);
    if (search.given_up)
        return fail(error, STATUS_SCENE, "the profile is too tangled to be checked for crossings; use fewer points");
    if (!search.found) return STATUS_OK;
    const OutlinePoint *a = &outline->points[search.edge_a];
    const OutlinePoint *b = &outline->points[(search.edge_a + 1) % outline->n];
    const OutlinePoint *c = &outline->points[search.edge_b];
    const OutlinePoint *d = &outline->points[(search.edge_b + 1) % outline->n];
    return fail(
        error, STATUS_SCENE,
        "the profile crosses or touches itself: <%g, %g> to <%g, %g> (at profile[%u]) meets <%g, %g> to <%g, %g> (at "
        "profile[%u])",
        a->r, a->y, b->r, b->y, a->source, c->r, c->y, d->r, d->y, c->source);
}

/* Where the run of edges that starts at i ends: the edges of one arc, or a single one. */
static size_t run_end(const Outline *outline, size_t i)
{
    size_t end = i + 1;
    while (outline->points[i].arc && end < outline->n && outline->points[end].arc == outline->points[i].arc) end++;
    return end;
}

static Piece make_piece(const Outline *outline, const OutlinePoint *a, const OutlinePoint *b)
{
    if (a->arc && a->y != b->y) {
        const Arc *arc = &outline->arcs[a->arc];
        return (Piece){.kind = arc->outer ? PIECE_OUTER_ARC : PIECE_INNER_ARC,
                       .r0 = a->r,
                       .y0 = a->y,
                       .r1 = b->r,
                       .y1 = b->y,
                       .centre_r = arc->centre.r,
                       .centre_y = arc->centre.y};
    }
    return (Piece){.kind = PIECE_BAND,
                   .r0 = a->r,
                   .y0 = a->y,
                   .r1 = b->r,
                   .y1 = b->y,
                   .nr0 = (float)a->normal_out.r,
                   .ny0 = (float)a->normal_out.y,
                   .nr1 = (float)b->normal_in.r,
                   .ny1 = (float)b->normal_in.y};
}

static Status make_pieces(const Outline *outline, Solid **solid, Error *error)
{
    uint32_t n_pieces = 0;
    double length = 0;
    for (size_t i = 0; i < outline->n; i++) {
        if (edge_on_axis(outline, i)) continue;
        const OutlinePoint *a = &outline->points[i];
        const OutlinePoint *b = &outline->points[(i + 1) % outline->n];
        length += hypot(b->r - a->r, b->y - a->y);
        n_pieces++;
    }
    Solid *made;
    TRY(solid_new(n_pieces, &made, error));
    uint32_t n = 0;
    double along = 0;
    for (size_t i = 0, end; i < outline->n; i = end) {
        end = run_end(outline, i);
        if (edge_on_axis(outline, i)) continue;
        Piece *piece = &made->pieces[n++];
        *piece = make_piece(outline, &outline->points[i], &outline->points[end % outline->n]);
        piece->v0 = (float)fmin(along / length, 1);
        for (size_t k = i; k < end; k++) {
            const OutlinePoint *a = &outline->points[k];
            const OutlinePoint *b = &outline->points[(k + 1) % outline->n];
            along += hypot(b->r - a->r, b->y - a->y);
        }
        piece->v1 = (float)fmin(along / length, 1);
        made->volume += piece_volume(piece);
    }
    made->n_pieces = n;
    if (!(made->volume > 0)) {
        solid_free(made);
        return fail(error, STATUS_SCENE, "the profile encloses no volume");
    }
    *solid = made;
    return STATUS_OK;
}

Status solid_make_lathe(const double (*profile)[2], uint32_t n, const double *round, bool smooth_all, Solid **solid,
                        Error *error)
{
    TRY(check_points(profile, n, round, error));
    Corner *corners = calloc(n, sizeof *corners);
    if (!corners) return fail_memory(error, n * sizeof *corners, "a profile");
    Outline outline = {0};
    uint32_t n_corners = clean_corners(profile, n, round, corners);
    Status status = STATUS_OK;
    if (n_corners < 3)
        status = fail(error, STATUS_SCENE, "a profile needs at least 3 different points; this one has %u", n_corners);
    if (status == STATUS_OK) {
        orient_corners(corners, n_corners);
        status = measure_roundings(corners, n_corners, error);
    }
    if (status == STATUS_OK) status = make_outline(corners, n_corners, &outline, error);
    if (status == STATUS_OK && outline.n < 3) status = fail(error, STATUS_SCENE, "the profile encloses no volume");
    if (status == STATUS_OK) status = check_crossings(&outline, error);
    if (status == STATUS_OK) {
        set_normals(&outline, smooth_all);
        status = make_pieces(&outline, solid, error);
    }
    free(outline.points);
    free(outline.arcs);
    free(corners);
    return status;
}
