/* outline.c - outlines of straight edges and arcs: checked, and made into bands and arcs of revolution.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/outline.h"

#include <stdlib.h>

#include "base/angle.h"
#include "base/array.h"

enum {
    MAX_TESTS = 1000000000, /* box tests in the search for crossings */
    ARC_STEP_DEGREES = 1    /* of the search for crossings */
};

void outline_clear(Outline *outline)
{
    free(outline->points);
    free(outline->arcs);
    *outline = (Outline){0};
}

OutlinePoint *outline_add_point(Outline *outline, double r, double y, uint32_t source)
{
    if (!ARRAY_ROOM(outline->points, outline->capacity, outline->n)) return NULL;
    OutlinePoint *point = &outline->points[outline->n++];
    *point = (OutlinePoint){.r = r, .y = y, .source = source};
    return point;
}

void outline_give_normal(OutlinePoint *point, Dir2 normal)
{
    point->normal_in = point->normal_out = normal;
    point->given_in = point->given_out = true;
}

/* A part of an arc that does not turn from up to down: its normals go from `angle` by `turned`; its last point is left
 * to what comes behind. side is the radius, negative where the solid is outside of the circle. */
static bool add_monotonic_arc(Outline *outline, Dir2 start, Dir2 centre, double side, double angle, double turned,
                              uint32_t source)
{
    if (!ARRAY_ROOM(outline->arcs, outline->arcs_capacity, outline->n_arcs + 1)) return false;
    if (outline->n_arcs == 0) outline->arcs[outline->n_arcs++] = (Arc){{0, 0}, false};
    uint32_t arc = (uint32_t)outline->n_arcs;
    outline->arcs[outline->n_arcs++] = (Arc){centre, side * cos(angle + 0.5 * turned) > 0};
    unsigned steps = (unsigned)ceil(fabs(turned) / (ARC_STEP_DEGREES * MEN_DEGREE) - 1e-9);
    if (steps == 0) steps = 1;
    for (unsigned k = 0; k < steps; k++) {
        Dir2 normal = {cos(angle + turned * k / steps), sin(angle + turned * k / steps)};
        if (fabs(normal.r) < 1e-15) normal.r = 0;
        Dir2 at = {fmax(centre.r + side * normal.r, 0), centre.y + side * normal.y};
        if (k == 0) at = start;
        OutlinePoint *point = outline_add_point(outline, at.r, at.y, source);
        if (!point) return false;
        point->arc = arc;
        outline_give_normal(point, normal);
    }
    return true;
}

bool outline_add_arc(Outline *outline, Dir2 start, Dir2 centre, double side, double from, double turned,
                     uint32_t source)
{
    double sense = turned > 0 ? 1 : -1, end = from + turned;
    for (double at = from; at != end;) { /* cut where it turns between up and down */
        double quarters = (at / MEN_PI - 0.5) * sense;
        double next = (floor(quarters + 1e-9) + 1) * sense * MEN_PI + 0.5 * MEN_PI;
        if (fabs(next - from) > fabs(turned) - 1e-9) next = end;
        if (!add_monotonic_arc(outline, start, centre, side, at, next - at, source)) return false;
        start = (Dir2){fmax(centre.r, 0), centre.y + side * sin(next)};
        at = next;
    }
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
        last->closes = point->closes;
        last->normal_out = point->normal_out;
        last->given_out = point->given_out;
        if (point->r == 0) last->r = 0;
    }
    outline->n = kept;
}

static bool edge_on_axis(const Outline *outline, size_t i)
{
    return outline->points[i].r == 0 && outline->points[(i + 1) % outline->n].r == 0;
}

static Dir2 edge_direction(const Outline *outline, size_t i)
{
    const OutlinePoint *a = &outline->points[i];
    const OutlinePoint *b = &outline->points[(i + 1) % outline->n];
    return dir2_between(a->r, a->y, b->r, b->y);
}

/* Fills the normals that no arc has given. */
static void set_normals(Outline *outline, bool smooth_all)
{
    const double limit = cos(40 * MEN_DEGREE);
    for (size_t i = 0; i < outline->n; i++) {
        OutlinePoint *point = &outline->points[i];
        size_t edge_in = (i + outline->n - 1) % outline->n;
        bool axis_in = edge_on_axis(outline, edge_in);
        bool axis_out = edge_on_axis(outline, i);
        Dir2 in = axis_in ? (Dir2){0, -1} : dir2_outward(edge_direction(outline, edge_in));
        Dir2 out = axis_out ? (Dir2){0, 1} : dir2_outward(edge_direction(outline, i));
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

static Status fail_crossing(const Outline *outline, size_t edge, size_t other, Error *error)
{
    if (outline->points[edge].closes) { /* as of a profile that goes down */
        size_t keep = edge;
        edge = other;
        other = keep;
    }
    const OutlinePoint *a = &outline->points[edge];
    const OutlinePoint *b = &outline->points[(edge + 1) % outline->n];
    const OutlinePoint *c = &outline->points[other];
    const OutlinePoint *d = &outline->points[(other + 1) % outline->n];
    /* the outside of a vessel alone is no profile: its ends are joined right through it */
    if (c->closes && !a->closes && (c->r > 0 || d->r > 0) && c->y != d->y)
        return fail(
            error, STATUS_SCENE,
            "the profile crosses or touches itself: <%g, %g> to <%g, %g> (at profile[%u]) meets the edge that closes "
            "it, from the last point to the first; lead it back along the inside, or to the axis",
            a->r, a->y, b->r, b->y, a->source);
    return fail(
        error, STATUS_SCENE,
        "the profile crosses or touches itself: <%g, %g> to <%g, %g> (at profile[%u]) meets <%g, %g> to <%g, %g> (at "
        "profile[%u])",
        a->r, a->y, b->r, b->y, a->source, c->r, c->y, d->r, d->y, c->source);
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
    return fail_crossing(outline, search.edge_a, search.edge_b, error);
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

Status outline_finish(Outline *outline, bool smooth_all, Solid **solid, Error *error)
{
    merge_points(outline);
    if (outline->n < 3) return fail(error, STATUS_SCENE, "the profile encloses no volume");
    TRY(check_crossings(outline, error));
    set_normals(outline, smooth_all);
    return make_pieces(outline, solid, error);
}
