/* topology.c - the edges of a mesh.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/topology.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"

bool topology_corners(const Topology *topology, uint32_t triangle, uint32_t ids[3])
{
    const uint32_t *t = topology->mesh->triangles[triangle];
    for (int k = 0; k < 3; k++) ids[k] = topology_number(topology->position_id, t[k]);
    return ids[0] != ids[1] && ids[1] != ids[2] && ids[2] != ids[0];
}

static int compare_uses(const void *a, const void *b)
{
    const EdgeUse *p = a;
    const EdgeUse *q = b;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

/* Groups the uses of each edge. Lists are short as a rule (three in a regular mesh); one vertex in a
 * hundred thousand triangles is still sorted in n log n. */
static void sort_uses(EdgeUse *uses, size_t n)
{
    if (n > 32) {
        qsort(uses, n, sizeof *uses, compare_uses);
        return;
    }
    for (size_t i = 1; i < n; i++) {
        EdgeUse use = uses[i];
        size_t k = i;
        for (; k > 0 && compare_uses(&uses[k - 1], &use) > 0; k--) uses[k] = uses[k - 1];
        uses[k] = use;
    }
}

/* ---- listing the edges ---- */

/* Blocks of triangles first sort their edges into ranges of lower vertices; then each range, which a processor's caches
 * hold, is sorted by itself. Both the sorted and the half-sorted edges are in the same memory. */
enum { LEAST_BLOCK = 1 << 13, MOST_BLOCKS = 256, EDGES_OF_A_RANGE = 1 << 14, MOST_RANGES = 1024 };

/* A triangle's edge before its range is sorted: as large as what it becomes. */
typedef struct Directed {
    uint32_t from, to, triangle;
} Directed;
_Static_assert(sizeof(Directed) == sizeof(EdgeUse), "edges are sorted in place");

typedef struct RangeSorter {
    Directed *edges;
    size_t *next; /* per vertex of the range */
    size_t edges_capacity, next_capacity;
    bool failed; /* memory ended */
} RangeSorter;

typedef struct Lister {
    Topology *topology;
    uint32_t block, n_blocks; /* of triangles */
    uint32_t range, n_ranges; /* of vertices */
    size_t *places;           /* of each range and block: how many, then where the next goes */
    RangeSorter *sorters;     /* one per worker */
} Lister;

static uint32_t least(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* Counts the edges of a block's triangles for each range, and puts them in their places if there is room for them. */
static inline void walk_block(const Lister *lister, uint32_t block, size_t *places, void *edges)
{
    const Topology *topology = lister->topology;
    uint32_t begin = block * lister->block, n = topology->mesh->n_triangles;
    uint32_t end = begin + least(lister->block, n - begin), ids[3];
    for (uint32_t i = begin; i < end; i++) {
        if (!topology_corners(topology, i, ids)) continue;
        for (int k = 0; k < 3; k++) {
            Directed edge = {ids[k], ids[(k + 1) % 3], i};
            size_t *place = &places[(size_t)(least(edge.from, edge.to) / lister->range) * lister->n_blocks + block];
            if (edges) memcpy((Directed *)edges + *place, &edge, sizeof edge);
            ++*place;
        }
    }
}

static void count_block(void *context, uint32_t block, unsigned worker)
{
    (void)worker;
    Lister *lister = context;
    walk_block(lister, block, lister->places, NULL);
}

static void part_block(void *context, uint32_t block, unsigned worker)
{
    (void)worker;
    Lister *lister = context;
    walk_block(lister, block, lister->places, lister->topology->uses);
}

/* A counting sort by the lower vertex, out of the sorter's memory. */
static void sort_range(void *context, uint32_t range, unsigned worker)
{
    Lister *lister = context;
    Topology *topology = lister->topology;
    RangeSorter *sorter = &lister->sorters[worker];
    /* after parting, a range ends where the next place of its last block is */
    size_t begin = range ? lister->places[(size_t)range * lister->n_blocks - 1] : 0,
           end = lister->places[(size_t)(range + 1) * lister->n_blocks - 1], n = end - begin;
    uint32_t first = range * lister->range, n_vertices = least(lister->range, topology->mesh->n_vertices - first);
    if (!array_reserve(&sorter->edges, &sorter->edges_capacity, n + 1, sizeof *sorter->edges) ||
        !array_reserve(&sorter->next, &sorter->next_capacity, n_vertices + 1UL, sizeof *sorter->next)) {
        sorter->failed = true;
        return;
    }
    size_t *next = sorter->next, sum = begin;
    memcpy(sorter->edges, topology->uses + begin, n * sizeof *sorter->edges);
    memset(next, 0, n_vertices * sizeof *next);
    for (size_t i = 0; i < n; i++) next[least(sorter->edges[i].from, sorter->edges[i].to) - first]++;
    for (uint32_t v = 0; v < n_vertices; v++) {
        size_t count = next[v];
        topology->first_use[first + v] = next[v] = sum;
        sum += count;
    }
    for (size_t i = 0; i < n; i++) {
        Directed edge = sorter->edges[i];
        bool upward = edge.from < edge.to;
        topology->uses[next[(upward ? edge.from : edge.to) - first]++] =
            (EdgeUse){upward ? edge.to : edge.from, edge.triangle, upward};
    }
    for (uint32_t v = 0; v < n_vertices; v++) {
        size_t from = topology->first_use[first + v];
        sort_uses(topology->uses + from, next[v] - from);
    }
}

static bool lister_init(Lister *lister, Topology *topology, unsigned n_workers)
{
    const Mesh *mesh = topology->mesh;
    uint32_t n_ranges = least(mesh->n_triangles / (EDGES_OF_A_RANGE / 3) + 1, MOST_RANGES);
    lister->topology = topology;
    lister->block = mesh->n_triangles / MOST_BLOCKS + 1;
    if (lister->block < LEAST_BLOCK) lister->block = LEAST_BLOCK;
    lister->n_blocks = mesh->n_triangles / lister->block + 1;
    lister->range = mesh->n_vertices / n_ranges + 1;
    lister->n_ranges = mesh->n_vertices / lister->range + 1;
    lister->places = calloc((size_t)lister->n_ranges * lister->n_blocks, sizeof *lister->places);
    lister->sorters = calloc(n_workers, sizeof *lister->sorters);
    topology->first_use = malloc((mesh->n_vertices + 1UL) * sizeof *topology->first_use);
    topology->uses = malloc((3 * (size_t)mesh->n_triangles + 1) * sizeof *topology->uses);
    return lister->places && lister->sorters && topology->first_use && topology->uses;
}

static bool list_edges(Topology *topology, Pool *pool)
{
    unsigned n_workers = pool_threads(pool);
    Lister lister = {0};
    bool done = lister_init(&lister, topology, n_workers);
    if (done) {
        pool_run(pool, lister.n_blocks, count_block, &lister);
        size_t sum = 0;
        for (size_t i = 0; i < (size_t)lister.n_ranges * lister.n_blocks; i++) {
            size_t count = lister.places[i];
            lister.places[i] = sum;
            sum += count;
        }
        pool_run(pool, lister.n_blocks, part_block, &lister);
        pool_run(pool, lister.n_ranges, sort_range, &lister);
        topology->first_use[topology->mesh->n_vertices] = sum;
    }
    for (unsigned i = 0; lister.sorters && i < n_workers; i++) {
        if (lister.sorters[i].failed) done = false;
        free(lister.sorters[i].edges);
        free(lister.sorters[i].next);
    }
    free(lister.places);
    free(lister.sorters);
    return done;
}

bool topology_next_edge(const Topology *topology, uint32_t *low, size_t *at, Edge *edge)
{
    while (*low < topology->mesh->n_vertices && *at >= topology->first_use[*low + 1]) ++*low;
    if (*low >= topology->mesh->n_vertices) return false;
    const EdgeUse *uses = topology->uses + *at;
    size_t left = topology->first_use[*low + 1] - *at;
    *edge = (Edge){*low, uses->high, uses, 0, 0};
    while (edge->n < left && uses[edge->n].high == edge->high) edge->n_upward += uses[edge->n++].upward;
    *at += edge->n;
    return true;
}

void topology_clear(Topology *topology)
{
    free(topology->position_id);
    free(topology->first_use);
    free(topology->uses);
}

Status topology_make(const Mesh *mesh, Pool *pool, Topology *topology, Error *error)
{
    *topology = (Topology){.mesh = mesh};
    if (!mesh->distinct) TRY(mesh_number_positions(mesh, pool, &topology->position_id, error));
    if (list_edges(topology, pool)) return STATUS_OK;
    return fail_memory(error, 3 * (size_t)mesh->n_triangles * sizeof *topology->uses, "the edges of a mesh");
}

Status sets_new(uint32_t n, uint32_t **parent, Error *error)
{
    *parent = malloc(((size_t)n + 1) * sizeof **parent);
    if (!*parent) return fail_memory(error, n * sizeof **parent, "the parts of a mesh");
    for (uint32_t i = 0; i < n; i++) (*parent)[i] = i;
    return STATUS_OK;
}
