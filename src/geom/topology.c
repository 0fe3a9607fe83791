/* topology.c - the edges of a mesh.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/topology.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"

static uint32_t float_word(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits == 0x80000000U ? 0 : bits;
}

static bool same_position(Vec3f a, Vec3f b)
{
    return float_word(a.x) == float_word(b.x) && float_word(a.y) == float_word(b.y) &&
           float_word(a.z) == float_word(b.z);
}

Status mesh_number_positions(const Mesh *mesh, uint32_t **ids, Error *error)
{
    size_t room = 16;
    while (room < 2 * (size_t)mesh->n_vertices) room *= 2;
    uint32_t *table = calloc(room, sizeof *table); /* vertex + 1, 0: free */
    *ids = malloc(((size_t)mesh->n_vertices + 1) * sizeof **ids);
    if (!table || !*ids) {
        free(table);
        free(*ids);
        *ids = NULL;
        return fail_memory(error, room * sizeof *table, "the inspection of a mesh");
    }
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        Vec3f p = mesh->positions[i];
        uint64_t h = hash_u64(float_word(p.x) | (uint64_t)float_word(p.y) << 32);
        h = hash_u64(h ^ float_word(p.z));
        size_t slot = (size_t)h & (room - 1);
        while (table[slot] && !same_position(mesh->positions[table[slot] - 1], p)) slot = (slot + 1) & (room - 1);
        if (!table[slot]) table[slot] = i + 1;
        (*ids)[i] = table[slot] - 1;
    }
    free(table);
    return STATUS_OK;
}

bool topology_corners(const Topology *topology, uint32_t triangle, uint32_t ids[3])
{
    const uint32_t *t = topology->mesh->triangles[triangle];
    for (int k = 0; k < 3; k++) ids[k] = topology->position_id[t[k]];
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

static Status list_edges(Topology *topology, Error *error)
{
    const Mesh *mesh = topology->mesh;
    size_t n_vertices = mesh->n_vertices;
    topology->first_use = calloc(n_vertices + 2, sizeof *topology->first_use);
    topology->uses = malloc((3 * (size_t)mesh->n_triangles + 1) * sizeof *topology->uses);
    if (!topology->first_use || !topology->uses)
        return fail_memory(error, 3 * (size_t)mesh->n_triangles * sizeof *topology->uses, "the edges of a mesh");
    /* A counting sort: first_use[v + 2] counts, then after summing first_use[v + 1] is the place to write
     * next for v, and in the end the place where v + 1 starts. */
    size_t *next = topology->first_use + 1;
    uint32_t ids[3];
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        if (!topology_corners(topology, i, ids)) continue;
        for (int k = 0; k < 3; k++) {
            uint32_t from = ids[k], to = ids[(k + 1) % 3];
            next[(from < to ? from : to) + 1]++;
        }
    }
    for (size_t v = 1; v <= n_vertices; v++) next[v] += next[v - 1];
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        if (!topology_corners(topology, i, ids)) continue;
        for (int k = 0; k < 3; k++) {
            uint32_t from = ids[k], to = ids[(k + 1) % 3];
            bool upward = from < to;
            topology->uses[next[upward ? from : to]++] = (EdgeUse){upward ? to : from, i, upward};
        }
    }
    for (size_t v = 0; v < n_vertices; v++)
        sort_uses(topology->uses + topology->first_use[v], topology->first_use[v + 1] - topology->first_use[v]);
    return STATUS_OK;
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

Status topology_make(const Mesh *mesh, Topology *topology, Error *error)
{
    *topology = (Topology){.mesh = mesh};
    TRY(mesh_number_positions(mesh, &topology->position_id, error));
    return list_edges(topology, error);
}

Status sets_new(uint32_t n, uint32_t **parent, Error *error)
{
    *parent = malloc(((size_t)n + 1) * sizeof **parent);
    if (!*parent) return fail_memory(error, n * sizeof **parent, "the parts of a mesh");
    for (uint32_t i = 0; i < n; i++) (*parent)[i] = i;
    return STATUS_OK;
}
