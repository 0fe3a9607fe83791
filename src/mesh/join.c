/* join.c - vertices that ought to be one, and are not by the last bits: the two ends of a seam, the corners of neighbours that
 * were rounded by themselves.
 *
 * Only places on open edges are looked at, so that what is closed stays as it is. Two of them are one where they are nearer
 * than what was said, and than a quarter of all edges at both: no triangle can lose an edge by that. All take the place of
 * the lowest vertex among them, bit by bit, and with it the edges are what they are by position (topology.h); normals and
 * coordinates for textures stay as they are. What does not close the mesh, or gives edges more faces than they should have, is
 * taken back.
 *
 * Edges that are shorter than the rounding of a coordinate as large as the mesh are no edges on purpose: who computes sin(pi) has
 * poles of many places, 1e-16 or, in floats, 1e-7 of the size apart. An open one becomes one place, and its triangles vanish, which
 * are the only ones that may. That takes nothing that was drawn: not from a closed mesh, not where it leaves the mesh open, and
 * not where edges that short add up, one after the other, to more than what is joined.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/topology.h"

#define PART_OF_SIZE 1e-6 /* a few units in the last place of coordinates as large as the mesh */
#define PART_OF_EDGES 0.25
#define ROUNDING_OF_SIZE 0x1p-23 /* the last place of a float as large as the mesh; texts have about as many digits */
#define LEAST_CELL_OF_SIZE 1e-12 /* so that numbers of cells are whole numbers of 64 bits */
enum { COMPARISONS = 64, LONGER = 4 }; /* of each place, at most; each attempt's distance over that of the one before */

/* How edges and triangles are, to be compared. */
typedef struct Faults {
    size_t n_open, n_crowded; /* edges of an odd number of faces, and of more than two */
} Faults;

typedef struct Joiner {
    Mesh *mesh;
    const Mesh *end; /* the same triangles later; NULL: they stay */
    Pool *pool;
    Topology topology;
    Faults faults;
    uint32_t *index;       /* of each vertex: its place among the open ones + 1; 0: it is none of them */
    uint32_t *vertex;      /* of each open place, its first vertex */
    double *reach;         /* the part of the shortest edge there that is more than rounding */
    uint32_t *parent;      /* places that are one */
    uint32_t *head, *next; /* of a table of cells, each the last place + 1 in it, and the one before that */
    Vec3f *positions;      /* as they were */
    uint32_t n;            /* open places */
    Box3 bounds;           /* of these */
    double size;           /* the diagonal of the whole mesh */
} Joiner;

static Faults faults_of(const Topology *topology)
{
    Faults faults = {0};
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    while (topology_next_edge(topology, &low, &at, &edge)) {
        faults.n_open += edge.n & 1;
        faults.n_crowded += edge.n > 2;
    }
    return faults;
}

static double distance_of(const Vec3f *positions, uint32_t a, uint32_t b)
{
    return vec3_length(vec3_sub(vec3_from_f(positions[a]), vec3_from_f(positions[b])));
}

/* Whether two vertices are two by rounding alone, and stay that. */
static bool same_by_rounding(const Joiner *joiner, const Vec3f *positions, uint32_t a, uint32_t b)
{
    double most = ROUNDING_OF_SIZE * joiner->size;
    return distance_of(positions, a, b) <= most && (!joiner->end || distance_of(joiner->end->positions, a, b) <= most);
}

static Vec3 place_of(const Joiner *joiner, uint32_t open)
{
    return vec3_from_f(joiner->mesh->positions[joiner->vertex[open]]);
}

/* Numbers the places on open edges, in the order of their vertices. */
static void number_open(Joiner *joiner)
{
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    while (topology_next_edge(&joiner->topology, &low, &at, &edge))
        if (edge.n & 1) joiner->index[edge.low] = joiner->index[edge.high] = 1;
    for (uint32_t v = 0; v < joiner->mesh->n_vertices; v++)
        if (joiner->index[v]) joiner->index[v] = ++joiner->n;
}

static void shorten(Joiner *joiner, uint32_t vertex, double length)
{
    uint32_t i = joiner->index[vertex];
    if (i && length * PART_OF_EDGES < joiner->reach[i - 1]) joiner->reach[i - 1] = length * PART_OF_EDGES;
}

static void measure_open(Joiner *joiner)
{
    const Mesh *mesh = joiner->mesh;
    for (uint32_t v = 0; v < mesh->n_vertices; v++) {
        uint32_t i = joiner->index[v];
        if (!i) continue;
        joiner->vertex[i - 1] = v;
        joiner->reach[i - 1] = HUGE_VAL;
        joiner->bounds = box3_add_point(joiner->bounds, vec3_from_f(mesh->positions[v]));
    }
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    while (topology_next_edge(&joiner->topology, &low, &at, &edge)) {
        if (same_by_rounding(joiner, mesh->positions, edge.low, edge.high)) continue;
        double length = distance_of(mesh->positions, edge.low, edge.high);
        shorten(joiner, edge.low, length);
        shorten(joiner, edge.high, length);
    }
}

static size_t table_room(const Joiner *joiner)
{
    size_t room = 16;
    while (room < 2 * (size_t)joiner->n) room *= 2;
    return room;
}

static void joiner_clear(Joiner *joiner)
{
    topology_clear(&joiner->topology);
    free(joiner->index);
    free(joiner->vertex);
    free(joiner->reach);
    free(joiner->parent);
    free(joiner->head);
    free(joiner->next);
    free(joiner->positions);
}

static Status joiner_init(Joiner *joiner, Mesh *mesh, const Mesh *end, Pool *pool, Error *error)
{
    Box3 all = mesh_bounds(mesh);
    *joiner = (Joiner){.mesh = mesh, .end = end, .pool = pool, .bounds = box3_empty()};
    joiner->size = vec3_length(vec3_sub(all.max, all.min));
    TRY(topology_make(mesh, pool, &joiner->topology, error));
    joiner->faults = faults_of(&joiner->topology);
    if (!joiner->faults.n_open || !isfinite(joiner->size)) return STATUS_OK;
    joiner->index = calloc(mesh->n_vertices + 1UL, sizeof *joiner->index);
    if (joiner->index) number_open(joiner);
    size_t n = joiner->n + 1UL;
    joiner->vertex = malloc(n * sizeof *joiner->vertex);
    joiner->reach = malloc(n * sizeof *joiner->reach);
    joiner->parent = malloc(n * sizeof *joiner->parent);
    joiner->next = malloc(n * sizeof *joiner->next);
    joiner->head = malloc(table_room(joiner) * sizeof *joiner->head);
    joiner->positions = malloc((mesh->n_vertices + 1UL) * sizeof *joiner->positions);
    if (!joiner->index || !joiner->vertex || !joiner->reach || !joiner->parent || !joiner->next || !joiner->head ||
        !joiner->positions)
        return fail_memory(error, mesh->n_vertices * sizeof *joiner->positions, "the joining of a mesh");
    measure_open(joiner);
    return STATUS_OK;
}

/* ---- which are near each other ---- */

typedef struct Cell {
    int64_t at[3];
} Cell;

static size_t bucket_of(const Joiner *joiner, Cell cell)
{
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) h = hash_u64(h ^ (uint64_t)cell.at[k]);
    return (size_t)h & (table_room(joiner) - 1);
}

/* The cell of a place, and the one of two neighbours along each axis that the place is nearer to. Cells are twice as
 * wide as what is near. */
static Cell cell_of(const Joiner *joiner, Vec3 place, double within, int64_t side[3])
{
    Cell cell;
    double width = 2 * double_max(within, LEAST_CELL_OF_SIZE * joiner->size);
    Vec3 from_corner = vec3_scale(vec3_sub(place, joiner->bounds.min), 1 / width);
    const double at[3] = {from_corner.x, from_corner.y, from_corner.z};
    for (int k = 0; k < 3; k++) {
        cell.at[k] = (int64_t)at[k];
        side[k] = at[k] - (double)cell.at[k] < 0.5 ? -1 : 1;
    }
    return cell;
}

/* Makes one of the ends of edges that are none; the first of these stands for all from here on. */
static void unite_rounded(Joiner *joiner, double within, MeshJoin *join)
{
    const Vec3f *positions = joiner->mesh->positions;
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    for (uint32_t i = 0; i < joiner->n; i++) joiner->parent[i] = i;
    while (topology_next_edge(&joiner->topology, &low, &at, &edge)) {
        uint32_t a = joiner->index[edge.low], b = joiner->index[edge.high];
        if (!a || !b || !same_by_rounding(joiner, positions, edge.low, edge.high)) continue;
        double length = distance_of(positions, edge.low, edge.high);
        if (length > within) continue;
        set_unite(joiner->parent, a - 1, b - 1);
        join->farthest = double_max(join->farthest, length);
    }
    for (uint32_t i = 0; i < joiner->n; i++) {
        double *reach = &joiner->reach[set_find(joiner->parent, i)];
        if (joiner->reach[i] < *reach) *reach = joiner->reach[i];
    }
}

/* Makes one of all that are near each other; false where there are too many for that. */
static bool unite_near(Joiner *joiner, double within, MeshJoin *join)
{
    uint64_t left = (uint64_t)COMPARISONS * joiner->n;
    memset(joiner->head, 0, table_room(joiner) * sizeof *joiner->head);
    for (uint32_t i = 0; i < joiner->n; i++) {
        if (joiner->parent[i] != i) continue; /* by rounding: what is near has not come to it yet */
        Vec3 place = place_of(joiner, i);
        int64_t side[3];
        Cell own = cell_of(joiner, place, within, side);
        for (int corner = 0; corner < 8; corner++) {
            Cell cell = own;
            for (int k = 0; k < 3; k++) cell.at[k] += corner >> k & 1 ? side[k] : 0;
            for (uint32_t at = joiner->head[bucket_of(joiner, cell)]; at; at = joiner->next[at - 1]) {
                double distance = vec3_length(vec3_sub(place_of(joiner, at - 1), place));
                if (!left--) return false;
                if (!(distance <= within && distance <= joiner->reach[i] && distance <= joiner->reach[at - 1]))
                    continue;
                set_unite(joiner->parent, i, at - 1);
                join->farthest = double_max(join->farthest, distance);
            }
        }
        size_t bucket = bucket_of(joiner, own);
        joiner->next[i] = joiner->head[bucket];
        joiner->head[bucket] = i + 1;
    }
    return true;
}

/* Whether every open edge has an end that is one with others: else it stays open. */
static bool may_close(const Joiner *joiner)
{
    bool *joined = calloc(joiner->n + 1UL, sizeof *joined), may = joined != NULL;
    for (uint32_t i = 0; may && i < joiner->n; i++) {
        uint32_t leader = set_find(joiner->parent, i);
        if (leader != i) joined[leader] = joined[i] = true;
    }
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    while (may && topology_next_edge(&joiner->topology, &low, &at, &edge))
        if (edge.n & 1) may = joined[joiner->index[edge.low] - 1] || joined[joiner->index[edge.high] - 1];
    free(joined);
    return may;
}

/* ---- joining ---- */

/* The vertex whose place a vertex takes: itself where it has no other. */
static uint32_t leader_of(Joiner *joiner, uint32_t vertex)
{
    uint32_t i = joiner->index[topology_number(joiner->topology.position_id, vertex)];
    uint32_t leader = i ? set_find(joiner->parent, i - 1) : 0;
    return i && leader != i - 1 ? joiner->vertex[leader] : vertex;
}

static void move_to_leaders(Joiner *joiner, Mesh *mesh)
{
    for (uint32_t v = 0; v < mesh->n_vertices; v++) mesh->positions[v] = mesh->positions[leader_of(joiner, v)];
    mesh->distinct = false;
}

/* Whether all triangles that have lost an edge lost one that was none, of ends that were moved no farther than within. */
static bool only_rounded_vanish(const Joiner *joiner, const Topology *after, double within, MeshJoin *join)
{
    uint32_t before_ids[3], ids[3];
    for (uint32_t i = 0; i < joiner->mesh->n_triangles; i++) {
        if (topology_corners(after, i, ids) || !topology_corners(&joiner->topology, i, before_ids)) continue;
        for (int k = 0; k < 3; k++) {
            uint32_t a = before_ids[k], b = before_ids[(k + 1) % 3];
            if (ids[k] != ids[(k + 1) % 3]) continue;
            if (!same_by_rounding(joiner, joiner->positions, a, b)) return false;
            Vec3 now = vec3_from_f(joiner->mesh->positions[a]);
            double moved = double_max(vec3_length(vec3_sub(vec3_from_f(joiner->positions[a]), now)),
                                      vec3_length(vec3_sub(vec3_from_f(joiner->positions[b]), now)));
            if (moved > within) return false;
            join->farthest = double_max(join->farthest, moved);
        }
    }
    return true;
}

/* Joins what is within a distance; n_joined stays 0 where the mesh is not closed by that, and then it is as it was. */
static Status attempt(Joiner *joiner, double within, MeshJoin *join, Error *error)
{
    Mesh *mesh = joiner->mesh;
    *join = (MeshJoin){0};
    if (!joiner->index || !(within > 0)) return STATUS_OK;
    unite_rounded(joiner, within, join);
    if (!unite_near(joiner, within, join) || !may_close(joiner)) return STATUS_OK;
    bool distinct = mesh->distinct;
    Topology after;
    memcpy(joiner->positions, mesh->positions, mesh->n_vertices * sizeof *mesh->positions);
    move_to_leaders(joiner, mesh);
    Status status = topology_make(mesh, joiner->pool, &after, error);
    Faults faults = status == STATUS_OK ? faults_of(&after) : (Faults){.n_open = 1};
    bool closes = !faults.n_open && faults.n_crowded <= joiner->faults.n_crowded &&
                  only_rounded_vanish(joiner, &after, within, join);
    topology_clear(&after);
    if (!closes) {
        memcpy(mesh->positions, joiner->positions, mesh->n_vertices * sizeof *mesh->positions);
        mesh->distinct = distinct;
        return status;
    }
    for (uint32_t i = 0; i < joiner->n; i++) join->n_joined += set_find(joiner->parent, i) != i;
    return STATUS_OK;
}

Status mesh_join(Mesh *mesh, Mesh *end, double within, Pool *pool, MeshJoin *join, Error *error)
{
    Joiner joiner;
    Status status = joiner_init(&joiner, mesh, end, pool, error);
    *join = (MeshJoin){0};
    if (status == STATUS_OK) status = attempt(&joiner, within >= 0 ? within : PART_OF_SIZE * joiner.size, join, error);
    if (status == STATUS_OK && join->n_joined && end) move_to_leaders(&joiner, end);
    joiner_clear(&joiner);
    return status;
}

Status mesh_find_join(Mesh *mesh, double most, Pool *pool, MeshJoin *join, double *within, Error *error)
{
    Joiner joiner;
    Status status = joiner_init(&joiner, mesh, NULL, pool, error);
    bool distinct = mesh->distinct;
    *join = (MeshJoin){0};
    *within = PART_OF_SIZE * joiner.size / LONGER;
    while (status == STATUS_OK && !join->n_joined && *within < most * joiner.size) {
        *within *= LONGER;
        status = attempt(&joiner, *within, join, error);
    }
    if (join->n_joined) {
        memcpy(mesh->positions, joiner.positions, mesh->n_vertices * sizeof *mesh->positions);
        mesh->distinct = distinct;
    }
    joiner_clear(&joiner);
    return status;
}

Status mesh_inspect_joined(Mesh *mesh, MeshJoin *join, MeshReport *report, Error *error)
{
    *join = (MeshJoin){0};
    TRY(mesh_inspect(mesh, NULL, report, error));
    if (!report->n_open_edges || !report->finite) return STATUS_OK;
    TRY(mesh_join(mesh, NULL, -1, NULL, join, error));
    return join->n_joined ? mesh_inspect(mesh, NULL, report, error) : STATUS_OK;
}
