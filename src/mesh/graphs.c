/* graphs.c - triangles that cannot cross each other, because together they are the graph of a function.
 *
 * Take all triangles of a mesh that face upward, seen along an axis. How many of them lie above a point of the plane
 * is how often their common border, seen from above, winds round that point: each triangle adds one where it is, and
 * inner edges cancel. If the border is one loop that does not touch itself, no point has more than one triangle above
 * it, and so no two of them cross. A landscape is cleared in this way in one step instead of pair by pair. The idea of
 * looking at normals and at a border only is that of P. Volino, N. Magnenat-Thalmann, "Efficient Self-Collision
 * Detection on Smoothly Discretized Surface Animations Using Geometrical Shape Regularity", Computer Graphics Forum
 * 13(3) (1994); all signs here are exact.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/array.h"
#include "mesh/crossing.h"
#include "mesh/exact.h"

enum { DIRECTIONS = 6 }; /* +x, -x, +y ... */

typedef struct BorderEdge {
    uint32_t from, to; /* by position */
} BorderEdge;

/* What faces one way. */
typedef struct Side {
    int axis;
    uint32_t n; /* triangles */
    BorderEdge *border;
    size_t n_border, capacity;
    bool given_up;
} Side;

static Point2 seen_along(int axis, Vec3f p)
{
    const double all[3] = {(double)p.x, (double)p.y, (double)p.z};
    return (Point2){all[(axis + 1) % 3], all[(axis + 2) % 3]};
}

/* Which of the directions a triangle faces, a bit for each. */
static uint8_t facing(const Mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangles[triangle];
    uint8_t bits = 0;
    for (int axis = 0; axis < 3; axis++) {
        int turn = exact_turn(seen_along(axis, mesh->positions[t[0]]), seen_along(axis, mesh->positions[t[1]]),
                              seen_along(axis, mesh->positions[t[2]]));
        if (turn) bits |= (uint8_t)(1 << (2 * axis + (turn < 0)));
    }
    return bits;
}

/* A border is looked at pair by pair, which must stay cheap beside what it saves. */
static bool is_short(size_t n_border, uint32_t n_triangles)
{
    return n_border <= 100 || n_border / 32 <= n_triangles / n_border;
}

/* Adds the edge to the borders that it is part of. */
static bool add_edge(const Edge *edge, const uint8_t *faces, Side sides[DIRECTIONS], uint32_t n_triangles)
{
    uint8_t any = 0, all = UINT8_MAX;
    for (size_t k = 0; k < edge->n; k++) {
        any |= faces[edge->uses[k].triangle];
        all &= faces[edge->uses[k].triangle];
    }
    bool balanced = 2 * edge->n_upward == edge->n;
    for (int d = 0; d < DIRECTIONS; d++) {
        Side *side = &sides[d];
        uint8_t bit = (uint8_t)(1 << d);
        if (side->given_up || !(any & bit) || (balanced && (all & bit))) continue;
        int net = 0;
        for (size_t k = 0; k < edge->n; k++)
            if (faces[edge->uses[k].triangle] & bit) net += edge->uses[k].upward ? 1 : -1;
        if (net == 0) continue;
        side->given_up = abs(net) > 1 || !is_short(side->n_border + 1, n_triangles);
        if (side->given_up) continue;
        if (!ARRAY_ROOM(side->border, side->capacity, side->n_border)) return false;
        side->border[side->n_border++] =
            net > 0 ? (BorderEdge){edge->low, edge->high} : (BorderEdge){edge->high, edge->low};
    }
    return true;
}

static int compare_edges(const void *left, const void *right)
{
    const BorderEdge *a = left, *b = right;
    return (a->from > b->from) - (a->from < b->from);
}

/* The border's corners in their order, as they are seen; false unless it is one loop. */
static bool walk_border(const Mesh *mesh, Side *side, Point2 *loop)
{
    size_t n = side->n_border, at = 0;
    if (n < 3) return false;
    qsort(side->border, n, sizeof *side->border, compare_edges);
    for (size_t i = 1; i < n; i++)
        if (side->border[i].from == side->border[i - 1].from) return false;
    for (size_t i = 0; i < n; i++) {
        loop[i] = seen_along(side->axis, mesh->positions[side->border[at].from]);
        BorderEdge next = {side->border[at].to, 0};
        const BorderEdge *found = bsearch(&next, side->border, n, sizeof next, compare_edges);
        if (!found) return false;
        at = (size_t)(found - side->border);
        if ((at == 0) != (i + 1 == n)) return false;
    }
    return true;
}

/* b stands between two others: whether the way through them turns back on itself there, or stands still. */
static bool turns_back(Point2 a, Point2 b, Point2 c)
{
    if (exact_turn(a, b, c) != 0) return false;
    return a.x != b.x ? (a.x < b.x) == (c.x < b.x) || c.x == b.x
                      : (a.y < b.y) == (c.y < b.y) || a.y == b.y || c.y == b.y;
}

static bool ranges_meet(double a, double b, double c, double d)
{
    return (a < b ? a : b) <= (c > d ? c : d) && (c < d ? c : d) <= (a > b ? a : b);
}

/* Segments a b and c d; in doubt true. */
static bool segments_meet(Point2 a, Point2 b, Point2 c, Point2 d)
{
    return ranges_meet(a.x, b.x, c.x, d.x) && ranges_meet(a.y, b.y, c.y, d.y) &&
           exact_turn(a, b, c) * exact_turn(a, b, d) <= 0 && exact_turn(c, d, a) * exact_turn(c, d, b) <= 0;
}

static bool is_simple(const Point2 *loop, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (turns_back(loop[i], loop[(i + 1) % n], loop[(i + 2) % n])) return false;
    for (size_t i = 0; i < n; i++)
        for (size_t k = i + 2; k < n && !(i == 0 && k == n - 1); k++)
            if (segments_meet(loop[i], loop[i + 1], loop[k], loop[(k + 1) % n])) return false;
    return true;
}

/* Finds the borders of what faces each way. */
static Status find_borders(const Topology *topology, const uint8_t *faces, Side sides[DIRECTIONS], Error *error)
{
    const Mesh *mesh = topology->mesh;
    for (int d = 0; d < DIRECTIONS; d++) sides[d].axis = d / 2;
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int d = 0; d < DIRECTIONS; d++) sides[d].n += faces[i] >> d & 1;
    uint32_t low = 0;
    size_t at = 0;
    Edge edge;
    while (topology_next_edge(topology, &low, &at, &edge))
        if (!add_edge(&edge, faces, sides, mesh->n_triangles))
            return fail_memory(error, mesh->n_triangles, "the search for crossings in a mesh");
    return STATUS_OK;
}

/* Labels the triangles of a side if it is a graph. */
static Status label_side(const Mesh *mesh, const uint8_t *faces, Side *side, int direction, uint32_t *labels,
                         Error *error)
{
    Point2 *loop = malloc((side->n_border + 1) * sizeof *loop);
    if (!loop) return fail_memory(error, side->n_border * sizeof *loop, "the search for crossings in a mesh");
    bool is_graph = walk_border(mesh, side, loop) && is_simple(loop, side->n_border);
    free(loop);
    for (uint32_t i = 0; is_graph && i < mesh->n_triangles; i++)
        if (!labels[i] && faces[i] >> direction & 1) labels[i] = (uint32_t)direction + 1;
    return STATUS_OK;
}

/* The largest side first, as a triangle has one label only. */
static Status label_sides(const Mesh *mesh, const uint8_t *faces, Side sides[DIRECTIONS], uint32_t *labels,
                          Error *error)
{
    for (int round = 0; round < DIRECTIONS; round++) {
        int best = 0;
        for (int d = 1; d < DIRECTIONS; d++)
            if (sides[best].given_up || (!sides[d].given_up && sides[d].n > sides[best].n)) best = d;
        if (sides[best].given_up) break;
        TRY(label_side(mesh, faces, &sides[best], best, labels, error));
        sides[best].given_up = true;
    }
    return STATUS_OK;
}

Status mesh_label_graphs(const Topology *topology, uint32_t **labels, Error *error)
{
    const Mesh *mesh = topology->mesh;
    Side sides[DIRECTIONS] = {{0}};
    uint8_t *faces = calloc((size_t)mesh->n_triangles + 1, sizeof *faces);
    *labels = calloc((size_t)mesh->n_triangles + 1, sizeof **labels);
    Status status = faces && *labels
                        ? STATUS_OK
                        : fail_memory(error, mesh->n_triangles * sizeof **labels, "the search for crossings in a mesh");
    uint32_t ids[3];
    for (uint32_t i = 0; faces && i < mesh->n_triangles; i++)
        if (topology_corners(topology, i, ids)) faces[i] = facing(mesh, i);
    if (status == STATUS_OK) status = find_borders(topology, faces, sides, error);
    if (status == STATUS_OK) status = label_sides(mesh, faces, sides, *labels, error);
    for (int d = 0; d < DIRECTIONS; d++) free(sides[d].border);
    free(faces);
    return status;
}
