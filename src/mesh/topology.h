/* topology.h - the edges of a mesh, and who shares them: directed edges sorted by their lower vertex, where vertices
 * are numbered by the bits of their positions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TOPOLOGY_H
#define MEN_TOPOLOGY_H

#include "mesh/mesh.h"

/* A triangle's use of an edge. */
typedef struct EdgeUse {
    uint32_t high; /* the edge's higher vertex; the lower one is the list's index */
    uint32_t triangle;
    bool upward; /* the triangle runs from the lower to the higher vertex */
} EdgeUse;

typedef struct Topology {
    const Mesh *mesh;
    uint32_t *position_id; /* per vertex: the first vertex at the same position; NULL: itself */
    size_t *first_use;     /* per vertex: where its edges start in uses; one more at the end */
    EdgeUse *uses;
} Topology;

/* All uses of one edge. */
typedef struct Edge {
    uint32_t low, high;
    const EdgeUse *uses;
    size_t n, n_upward;
} Edge;

/* The mesh must stay. What was made is cleared also after a failure. The pool may be NULL. */
ATTR_NODISCARD Status topology_make(const Mesh *mesh, Pool *pool, Topology *topology, Error *error);
void topology_clear(Topology *topology);
/* A vertex's number by position, from position_id. */
static inline uint32_t topology_number(const uint32_t *position_id, uint32_t vertex)
{
    return position_id ? position_id[vertex] : vertex;
}
/* The three positions of a triangle; false when two of them are one: such a triangle has no edges here. */
bool topology_corners(const Topology *topology, uint32_t triangle, uint32_t ids[3]);
/* Steps through all edges: *low and *at start at 0. False at the end. */
bool topology_next_edge(const Topology *topology, uint32_t *low, size_t *at, Edge *edge);

/* Six times the signed volume of the tetrahedron over a triangle. */
double mesh_triangle_volume6(const Mesh *mesh, uint32_t triangle, Vec3 tip);

/* Sets of numbers that are united step by step; each begins as its own parent. *parent is malloc'd. */
ATTR_NODISCARD Status sets_new(uint32_t n, uint32_t **parent, Error *error);
static inline uint32_t set_find(uint32_t *parent, uint32_t i)
{
    while (parent[i] != i) {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    return i;
}

static inline void set_unite(uint32_t *parent, uint32_t a, uint32_t b)
{
    a = set_find(parent, a);
    b = set_find(parent, b);
    /* the lower number leads, so that the result does not depend on the order */
    if (a < b)
        parent[b] = a;
    else
        parent[a] = b;
}

#endif
