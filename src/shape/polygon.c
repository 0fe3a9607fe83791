/* polygon.c - areas bounded by loops: where edges cross, and the loops that bound the inside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/polygon.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/array.h"
#include "shape/polygon_sweep.h"

enum { MAX_TESTS = 2000000000, MAX_ROUNDS = 40 };

void outline2_clear(Outline2 *outline)
{
    free(outline->points);
    free(outline->loop_ends);
    *outline = (Outline2){0};
}

bool outline2_add_point(Outline2 *outline, const OutlinePoint2 *point)
{
    if (!ARRAY_ROOM(outline->points, outline->points_capacity, outline->n_points)) return false;
    outline->points[outline->n_points++] = *point;
    return true;
}

bool outline2_end_loop(Outline2 *outline)
{
    if (!ARRAY_ROOM(outline->loop_ends, outline->loops_capacity, outline->n_loops)) return false;
    outline->loop_ends[outline->n_loops++] = outline->n_points;
    return true;
}

/* ---- edges ---- */

/* Part of an edge of the outline, as it is walked, with what it needs to become an edge of the result. */
typedef struct Edge {
    Point2 from, to, leave, arrive;
    uint32_t source_from, source_to;
    size_t origin; /* the point of the outline that its edge begins at */
} Edge;

typedef struct Edges {
    Edge *items;
    size_t n, capacity;
} Edges;

static bool same_point(Point2 a, Point2 b)
{
    return a.x == b.x && a.y == b.y;
}

static Status collect_edges(const Outline2 *outline, Edges *edges, Error *error)
{
    if (outline->n_points > POLYGON_MAX_POINTS)
        return fail(error, STATUS_SCENE, "an outline of %zu points is too long; the limit is %d", outline->n_points,
                    POLYGON_MAX_POINTS);
    size_t begin = 0;
    for (size_t loop = 0; loop < outline->n_loops; loop++) {
        size_t end = outline->loop_ends[loop];
        for (size_t i = begin; i < end; i++) {
            const OutlinePoint2 *a = &outline->points[i], *b = &outline->points[i + 1 < end ? i + 1 : begin];
            if (same_point(a->at, b->at)) continue;
            if (!ARRAY_ROOM(edges->items, edges->capacity, edges->n))
                return fail_memory(error, edges->n * sizeof *edges->items, "an outline");
            edges->items[edges->n++] = (Edge){a->at, b->at, a->leave, b->arrive, a->source, b->source, i};
        }
        begin = end;
    }
    return STATUS_OK;
}

/* ---- crossings ---- */

static bool between(double a, double x, double b)
{
    return (a <= x && x <= b) || (b <= x && x <= a);
}

/* p is on the edge, but at none of its ends. */
static bool within(const Edge *edge, Point2 p)
{
    if (same_point(p, edge->from) || same_point(p, edge->to)) return false;
    return between(edge->from.x, p.x, edge->to.x) && between(edge->from.y, p.y, edge->to.y) &&
           exact_turn(edge->from, edge->to, p) == 0;
}

/* Where two edges meet elsewhere than at common ends: up to two points. An end within the other edge comes first, as
 * it is exact. */
static int meeting(const Edge *a, const Edge *b, Point2 at[2])
{
    int n = 0;
    const Point2 ends[4] = {b->from, b->to, a->from, a->to};
    for (int i = 0; i < 4 && n < 2; i++)
        if (within(i < 2 ? a : b, ends[i])) at[n++] = ends[i];
    if (n) return n;
    int from = exact_turn(a->from, a->to, b->from), to = exact_turn(a->from, a->to, b->to);
    if (from * to >= 0 || exact_turn(b->from, b->to, a->from) * exact_turn(b->from, b->to, a->to) >= 0) return 0;
    double ux = a->to.x - a->from.x, uy = a->to.y - a->from.y, vx = b->to.x - b->from.x, vy = b->to.y - b->from.y;
    double wx = b->from.x - a->from.x, wy = b->from.y - a->from.y;
    double cross = ux * vy - uy * vx, t = cross != 0 ? (wx * vy - wy * vx) / cross : 0.5;
    t = fmin(fmax(t, 0), 1);
    at[0] = (Point2){a->from.x + t * ux, a->from.y + t * uy};
    return 1;
}

typedef struct Span1 {
    double low_x, high_x, low_y, high_y;
    uint32_t edge;
} Span1;

static int compare_spans(const void *left, const void *right)
{
    const Span1 *a = left, *b = right;
    if (a->low_x != b->low_x) return a->low_x < b->low_x ? -1 : 1;
    return a->edge < b->edge ? -1 : a->edge > b->edge;
}

/* Calls found for each meeting of two edges, until it says false. */
static Status visit_meetings(const Edges *edges, bool (*found)(void *context, uint32_t a, uint32_t b, Point2 at),
                             void *context, Error *error)
{
    Span1 *spans = malloc((edges->n + 1) * sizeof *spans);
    if (!spans) return fail_memory(error, edges->n * sizeof *spans, "an outline");
    for (uint32_t i = 0; i < edges->n; i++) {
        const Edge *e = &edges->items[i];
        spans[i] = (Span1){fmin(e->from.x, e->to.x), fmax(e->from.x, e->to.x), fmin(e->from.y, e->to.y),
                           fmax(e->from.y, e->to.y), i};
    }
    qsort(spans, edges->n, sizeof *spans, compare_spans);
    int64_t tests = 0;
    bool more = true;
    for (size_t i = 0; i < edges->n && more && tests <= MAX_TESTS; i++)
        for (size_t k = i + 1; k < edges->n && more && spans[k].low_x <= spans[i].high_x; k++) {
            if (++tests > MAX_TESTS) break;
            if (spans[k].low_y > spans[i].high_y || spans[k].high_y < spans[i].low_y) continue;
            Point2 at[2];
            int n = meeting(&edges->items[spans[i].edge], &edges->items[spans[k].edge], at);
            for (int j = 0; j < n && more; j++) more = found(context, spans[i].edge, spans[k].edge, at[j]);
        }
    free(spans);
    if (tests > MAX_TESTS)
        return fail(error, STATUS_SCENE,
                    "an outline of %zu edges is too tangled: too many of them lie beside each other", edges->n);
    return STATUS_OK;
}

typedef struct FindContext {
    const Edges *edges;
    Crossing2 *crossing;
} FindContext;

static bool note_crossing(void *context, uint32_t a, uint32_t b, Point2 at)
{
    FindContext *find = context;
    *find->crossing = (Crossing2){true, at, find->edges->items[a].origin, find->edges->items[b].origin};
    return false;
}

Status polygon_find_crossing(const Outline2 *outline, Crossing2 *crossing, Error *error)
{
    Edges edges = {0};
    *crossing = (Crossing2){0};
    Status status = collect_edges(outline, &edges, error);
    FindContext context = {&edges, crossing};
    if (status == STATUS_OK) status = visit_meetings(&edges, note_crossing, &context, error);
    free(edges.items);
    return status;
}

/* ---- splitting where edges cross ---- */

typedef struct Cut {
    uint32_t edge;
    double along; /* squared distance from where the edge begins */
    Point2 at;
} Cut;

typedef struct Cuts {
    Cut *items;
    size_t n, capacity;
    const Edges *edges;
    double grid;
    bool out_of_memory;
} Cuts;

static void add_cut(Cuts *cuts, uint32_t edge, Point2 at)
{
    const Edge *e = &cuts->edges->items[edge];
    if (same_point(at, e->from) || same_point(at, e->to)) return;
    if (!ARRAY_ROOM(cuts->items, cuts->capacity, cuts->n)) {
        cuts->out_of_memory = true;
        return;
    }
    double dx = at.x - e->from.x, dy = at.y - e->from.y;
    cuts->items[cuts->n++] = (Cut){edge, dx * dx + dy * dy, at};
}

static bool note_cut(void *context, uint32_t a, uint32_t b, Point2 at)
{
    Cuts *cuts = context;
    /* ends of edges are on the grid already */
    Point2 rounded = {cuts->grid * round(at.x / cuts->grid), cuts->grid * round(at.y / cuts->grid)};
    add_cut(cuts, a, rounded);
    add_cut(cuts, b, rounded);
    return !cuts->out_of_memory;
}

static int compare_cuts(const void *left, const void *right)
{
    const Cut *a = left, *b = right;
    if (a->edge != b->edge) return a->edge < b->edge ? -1 : 1;
    return a->along < b->along ? -1 : a->along > b->along;
}

static Point2 mixed_direction(Point2 a, Point2 b, double t)
{
    Point2 mix = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    double length = hypot(mix.x, mix.y);
    return length > 0 ? (Point2){mix.x / length, mix.y / length} : a;
}

/* Cuts the edges at the places noted; the pieces of an edge keep its place and its directions. */
static bool apply_cuts(Edges *edges, Cuts *cuts)
{
    if (cuts->n) qsort(cuts->items, cuts->n, sizeof *cuts->items, compare_cuts);
    for (size_t i = 0; i < cuts->n;) {
        Edge rest = edges->items[cuts->items[i].edge];
        uint32_t slot = cuts->items[i].edge;
        double length = hypot(rest.to.x - rest.from.x, rest.to.y - rest.from.y);
        Point2 first = rest.leave, last = rest.arrive;
        for (; i < cuts->n && cuts->items[i].edge == slot; i++) {
            if (same_point(cuts->items[i].at, rest.from)) continue;
            Edge piece = rest;
            piece.to = cuts->items[i].at;
            piece.arrive = mixed_direction(first, last, fmin(sqrt(cuts->items[i].along) / length, 1));
            rest.from = piece.to;
            rest.leave = piece.arrive;
            if (!ARRAY_ROOM(edges->items, edges->capacity, edges->n)) return false;
            edges->items[edges->n++] = piece;
        }
        edges->items[slot] = rest;
    }
    return true;
}

static Status split_edges(Edges *edges, Error *error)
{
    double size = 0;
    for (size_t i = 0; i < edges->n; i++)
        size = fmax(size, fmax(fabs(edges->items[i].from.x), fabs(edges->items[i].from.y)));
    int exponent;
    frexp(size, &exponent);
    double grid = ldexp(1, exponent - 40);
    for (size_t i = 0; i < edges->n; i++) {
        Edge *e = &edges->items[i];
        e->from = (Point2){grid * round(e->from.x / grid), grid * round(e->from.y / grid)};
        e->to = (Point2){grid * round(e->to.x / grid), grid * round(e->to.y / grid)};
    }
    for (int round = 0; round < MAX_ROUNDS; round++) { /* rounding a cut moves its edges a little: look again */
        Cuts cuts = {.edges = edges, .grid = grid};
        size_t kept = 0;
        for (size_t i = 0; i < edges->n; i++)
            if (!same_point(edges->items[i].from, edges->items[i].to)) edges->items[kept++] = edges->items[i];
        edges->n = kept;
        Status status = visit_meetings(edges, note_cut, &cuts, error);
        size_t n = cuts.n;
        bool fine = status != STATUS_OK || (!cuts.out_of_memory && apply_cuts(edges, &cuts));
        free(cuts.items);
        if (!fine) return fail_memory(error, edges->n * sizeof *edges->items, "an outline");
        if (status != STATUS_OK || n == 0) return status;
        if (edges->n > POLYGON_MAX_POINTS) break;
    }
    return fail(error, STATUS_SCENE, "the outline crosses itself too often to be resolved");
}

/* ---- from edges to the sweep's input ---- */

typedef struct Graph {
    Point2 *points;
    SweepEdge *edges;
    size_t n_points, n_edges;
    uint32_t *edge_of; /* per Edge: its SweepEdge */
} Graph;

typedef struct EndKey {
    Point2 at;
    uint32_t end; /* 2 * edge, + 1: where it ends */
} EndKey;

static int compare_ends(const void *left, const void *right)
{
    const EndKey *a = left, *b = right;
    return sweep_before(a->at, b->at) ? -1 : sweep_before(b->at, a->at);
}

typedef struct PairKey {
    uint32_t low, high, edge;
    int32_t winding;
} PairKey;

static int compare_pairs(const void *left, const void *right)
{
    const PairKey *a = left, *b = right;
    if (a->low != b->low) return a->low < b->low ? -1 : 1;
    return a->high < b->high ? -1 : a->high > b->high;
}

static void clear_graph(Graph *graph)
{
    free(graph->points);
    free(graph->edges);
    free(graph->edge_of);
}

/* Points at one place become one, and so do edges with the same ends. Numbers of points follow the sweep. */
static Status make_graph(const Edges *edges, Graph *graph, Error *error)
{
    size_t n = edges->n;
    *graph = (Graph){.points = malloc((2 * n + 1) * sizeof(Point2)),
                     .edges = malloc((n + 1) * sizeof(SweepEdge)),
                     .edge_of = malloc((n + 1) * sizeof(uint32_t))};
    EndKey *ends = malloc((2 * n + 1) * sizeof *ends);
    PairKey *pairs = malloc((n + 1) * sizeof *pairs);
    uint32_t *point_of = malloc((2 * n + 1) * sizeof *point_of);
    bool fine = graph->points && graph->edges && graph->edge_of && ends && pairs && point_of;
    for (uint32_t i = 0; i < n && fine; i++) {
        ends[2 * i] = (EndKey){edges->items[i].from, 2 * i};
        ends[2 * i + 1] = (EndKey){edges->items[i].to, 2 * i + 1};
    }
    if (fine) qsort(ends, 2 * n, sizeof *ends, compare_ends);
    for (size_t i = 0; i < 2 * n && fine; i++) {
        if (i == 0 || !same_point(ends[i].at, ends[i - 1].at)) graph->points[graph->n_points++] = ends[i].at;
        point_of[ends[i].end] = (uint32_t)graph->n_points - 1;
    }
    for (uint32_t i = 0; i < n && fine; i++) {
        uint32_t from = point_of[2 * i], to = point_of[2 * i + 1];
        pairs[i] = from < to ? (PairKey){from, to, i, 1} : (PairKey){to, from, i, -1};
    }
    if (fine) qsort(pairs, n, sizeof *pairs, compare_pairs);
    for (size_t i = 0; i < n && fine; i++) {
        if (i == 0 || compare_pairs(&pairs[i], &pairs[i - 1]) != 0)
            graph->edges[graph->n_edges++] = (SweepEdge){.low = pairs[i].low, .high = pairs[i].high};
        graph->edges[graph->n_edges - 1].winding += pairs[i].winding;
        graph->edge_of[pairs[i].edge] = (uint32_t)graph->n_edges - 1;
    }
    free(ends);
    free(pairs);
    free(point_of);
    if (fine) return STATUS_OK;
    clear_graph(graph);
    return fail_memory(error, n * 100, "an outline");
}

/* ---- loops of the result ---- */

static Point2 negative(Point2 d)
{
    return (Point2){-d.x, -d.y};
}

static Edge reversed(const Edge *e)
{
    return (Edge){e->to, e->from, negative(e->arrive), negative(e->leave), e->source_to, e->source_from, e->origin};
}

/* The edges that have the inside on one side only, each once, turned so that this is the left. */
static void keep_boundary(Edges *edges, const Graph *graph, bool *taken)
{
    size_t kept = 0;
    for (size_t i = 0; i < edges->n; i++) {
        uint32_t k = graph->edge_of[i];
        const SweepEdge *sweep_edge = &graph->edges[k];
        if (taken[k] || sweep_edge->inside_left == sweep_edge->inside_right) continue;
        taken[k] = true;
        Edge edge = edges->items[i];
        bool upward = sweep_before(edge.from, edge.to);
        edges->items[kept++] = upward == sweep_edge->inside_left ? edge : reversed(&edge);
    }
    edges->n = kept;
}

static int compare_starts(const void *left, const void *right)
{
    const Edge *a = left, *b = right;
    return sweep_before(a->from, b->from) ? -1 : sweep_before(b->from, a->from);
}

/* Of the edges that leave the place where `before` ends, the one that bounds the same wedge of the inside: the first
 * one clockwise from the way back. The edges are sorted by where they begin. */
static size_t next_edge(const Edges *edges, const bool *used, const Edge *before)
{
    size_t low = 0, high = edges->n;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (sweep_before(edges->items[middle].from, before->to))
            low = middle + 1;
        else
            high = middle;
    }
    size_t best = SIZE_MAX;
    double best_angle = 0, back = atan2(before->from.y - before->to.y, before->from.x - before->to.x);
    for (size_t i = low; i < edges->n && same_point(edges->items[i].from, before->to); i++) {
        if (used[i]) continue;
        const Edge *e = &edges->items[i];
        double angle = back - atan2(e->to.y - e->from.y, e->to.x - e->from.x);
        if (angle <= 0) angle += 2 * MEN_PI;
        if (best != SIZE_MAX && angle >= best_angle) continue;
        best = i;
        best_angle = angle;
    }
    return best;
}

static bool chain_loops(Edges *edges, bool *used, Outline2 *outline)
{
    if (edges->n) qsort(edges->items, edges->n, sizeof *edges->items, compare_starts);
    outline->n_points = outline->n_loops = 0;
    for (size_t start = 0; start < edges->n; start++) {
        size_t first_point = outline->n_points, last = SIZE_MAX;
        for (size_t i = start; i != SIZE_MAX && !used[i]; i = next_edge(edges, used, &edges->items[i])) {
            const Edge *e = &edges->items[i];
            used[i] = true;
            OutlinePoint2 point = {e->from, e->arrive, e->leave, e->source_from};
            if (last != SIZE_MAX) point.arrive = edges->items[last].arrive;
            if (!outline2_add_point(outline, &point)) return false;
            last = i;
        }
        if (last == SIZE_MAX) continue;
        outline->points[first_point].arrive = edges->items[last].arrive;
        if (!outline2_end_loop(outline)) return false;
    }
    return true;
}

static Status loops_from(Edges *edges, FillRule rule, Outline2 *outline, Error *error)
{
    Graph graph;
    TRY(make_graph(edges, &graph, error));
    SweepInput input = {graph.points, graph.n_points, graph.edges, graph.n_edges, rule};
    Status status = polygon_sweep(&input, NULL, NULL, error);
    bool *used = calloc(2 * edges->n + 2, sizeof *used);
    if (status == STATUS_OK && used) keep_boundary(edges, &graph, used + edges->n + 1);
    if (status == STATUS_OK && (!used || !chain_loops(edges, used, outline)))
        status = fail_memory(error, edges->n * sizeof(OutlinePoint2), "an outline");
    free(used);
    clear_graph(&graph);
    return status;
}

Status polygon_clean(Outline2 *outline, FillRule rule, Error *error)
{
    Edges edges = {0};
    Status status = collect_edges(outline, &edges, error);
    if (status == STATUS_OK && rule == FILL_NONZERO) status = split_edges(&edges, error);
    if (status == STATUS_OK) status = loops_from(&edges, rule, outline, error);
    free(edges.items);
    return status;
}

/* ---- triangles ---- */

Status polygon_triangulate(const Outline2 *outline, uint32_t (**triangles)[3], size_t *n_triangles, Error *error)
{
    Edges edges = {0};
    Graph graph;
    Status status = collect_edges(outline, &edges, error);
    if (status == STATUS_OK) status = make_graph(&edges, &graph, error);
    if (status == STATUS_OK) {
        uint32_t *number = malloc((graph.n_points + 1) * sizeof *number);
        SweepInput input = {graph.points, graph.n_points, graph.edges, graph.n_edges, FILL_NONZERO};
        status = number ? polygon_sweep(&input, triangles, n_triangles, error)
                        : fail_memory(error, graph.n_points * sizeof *number, "an outline");
        for (size_t i = 0; i < edges.n && status == STATUS_OK; i++) {
            const SweepEdge *e = &graph.edges[graph.edge_of[i]];
            bool upward = sweep_before(edges.items[i].from, edges.items[i].to);
            number[upward ? e->low : e->high] = (uint32_t)edges.items[i].origin;
        }
        for (size_t i = 0; status == STATUS_OK && i < *n_triangles; i++)
            for (int k = 0; k < 3; k++) (*triangles)[i][k] = number[(*triangles)[i][k]];
        free(number);
        clear_graph(&graph);
    }
    free(edges.items);
    return status;
}
