/* inspect.c - whether a mesh encloses anything: its edges, components, volume.
 * It rests on the edges of topology.h. There is no tolerance anywhere, so the size of the mesh does not matter. What is
 * summed is summed in blocks that depend on the mesh alone, so that threads do not change the last digits.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/topology.h"

enum { LEAST_BLOCK = 1 << 13, MOST_BLOCKS = 256, EXAMPLES = COUNT_OF(((MeshReport *)0)->open) };

/* What a block of triangles adds to the report. */
typedef struct BlockSums {
    Box3 bounds;
    bool finite;
    double area, volume;
    uint32_t n_degenerate, n_components;
} BlockSums;

/* What the edges of a block of lower vertices add to it. */
typedef struct EdgeFacts {
    uint32_t n_open, n_non_manifold;
    bool consistent, repeated;
    struct {
        Vec3f a, b;
    } open[EXAMPLES], non_manifold[EXAMPLES];
} EdgeFacts;

typedef struct Inspection {
    const Mesh *mesh;
    Topology topology;
    uint32_t n_blocks;
    uint32_t triangles, vertices; /* of a block */
    BlockSums *sums;
    EdgeFacts *facts;
    atomic_uint *parent; /* triangles that share edges are one set, of which the first leads */
    Vec3 tip;            /* of what the volumes are sums of */
} Inspection;

typedef struct Block {
    uint32_t begin, end;
} Block;

static Block block_of(uint32_t number, uint32_t size, uint32_t n)
{
    uint64_t begin = (uint64_t)number * size, end = begin + size;
    return (Block){(uint32_t)(begin < n ? begin : n), (uint32_t)(end < n ? end : n)};
}

/* ---- sets of triangles, united by several threads ---- */

static uint32_t find_leader(atomic_uint *parent, uint32_t i)
{
    for (;;) {
        uint32_t up = atomic_load_explicit(&parent[i], memory_order_relaxed);
        if (up == i) return i;
        uint32_t above = atomic_load_explicit(&parent[up], memory_order_relaxed);
        if (above != up)
            atomic_store_explicit(&parent[i], above, memory_order_relaxed); /* any of those above will do */
        i = above;
    }
}

static void unite(atomic_uint *parent, uint32_t a, uint32_t b)
{
    for (;;) {
        a = find_leader(parent, a);
        b = find_leader(parent, b);
        if (a == b) return;
        uint32_t low = a < b ? a : b, high = a < b ? b : a;
        unsigned expected = high; /* nobody may have put it under another one meanwhile */
        if (atomic_compare_exchange_weak_explicit(&parent[high], &expected, low, memory_order_relaxed,
                                                  memory_order_relaxed))
            return;
    }
}

/* ---- edges ---- */

static void note_edge(const Topology *topology, const Edge *edge, Inspection *inspection, EdgeFacts *facts)
{
    const Vec3f *positions = topology->mesh->positions;
    Vec3f a = positions[edge->low], b = positions[edge->high];
    size_t n_downward = edge->n - edge->n_upward;
    size_t more = edge->n_upward > n_downward ? edge->n_upward - n_downward : n_downward - edge->n_upward;
    if (edge->n_upward > 1 || n_downward > 1) facts->repeated = true;
    if (more > 1) facts->consistent = false;
    if (edge->n > 2) {
        if (facts->n_non_manifold < EXAMPLES) {
            facts->non_manifold[facts->n_non_manifold].a = a;
            facts->non_manifold[facts->n_non_manifold].b = b;
        }
        facts->n_non_manifold++;
    }
    if (more > 0) {
        if (facts->n_open < EXAMPLES) {
            facts->open[facts->n_open].a = a;
            facts->open[facts->n_open].b = b;
        }
        facts->n_open++;
    }
    for (size_t k = 1; k < edge->n; k++) unite(inspection->parent, edge->uses[0].triangle, edge->uses[k].triangle);
}

static void count_block(void *context, uint32_t number, unsigned worker)
{
    (void)worker;
    Inspection *inspection = context;
    const Topology *topology = &inspection->topology;
    Block block = block_of(number, inspection->vertices, inspection->mesh->n_vertices);
    EdgeFacts facts = {.consistent = true};
    uint32_t low = block.begin;
    size_t at = topology->first_use[low];
    Edge edge;
    while (low < block.end && topology_next_edge(topology, &low, &at, &edge) && edge.low < block.end)
        note_edge(topology, &edge, inspection, &facts);
    inspection->facts[number] = facts;
}

static void count_edges(Inspection *inspection, Pool *pool, MeshReport *report, bool *repeated)
{
    pool_run(pool, inspection->n_blocks, count_block, inspection);
    report->consistent = true;
    *repeated = false;
    for (uint32_t i = 0; i < inspection->n_blocks; i++) {
        const EdgeFacts *facts = &inspection->facts[i];
        for (uint32_t k = 0; k < facts->n_open && k < EXAMPLES && report->n_open_edges + k < EXAMPLES; k++) {
            report->open[report->n_open_edges + k].a = facts->open[k].a;
            report->open[report->n_open_edges + k].b = facts->open[k].b;
        }
        for (uint32_t k = 0; k < facts->n_non_manifold && k < EXAMPLES && report->n_non_manifold_edges + k < EXAMPLES;
             k++) {
            report->non_manifold[report->n_non_manifold_edges + k].a = facts->non_manifold[k].a;
            report->non_manifold[report->n_non_manifold_edges + k].b = facts->non_manifold[k].b;
        }
        report->n_open_edges += facts->n_open;
        report->n_non_manifold_edges += facts->n_non_manifold;
        report->consistent = report->consistent && facts->consistent;
        *repeated = *repeated || facts->repeated;
    }
}

/* Triangles with the same corners in the same turning sense, beyond the first. */
static Status count_duplicates(const Topology *topology, uint32_t *count, Error *error)
{
    const Mesh *mesh = topology->mesh;
    size_t room = 16;
    while (room < 2 * (size_t)mesh->n_triangles) room *= 2;
    uint32_t(*table)[3] = calloc(room, sizeof *table); /* corners + 1, lowest first */
    if (!table) return fail_memory(error, room * sizeof *table, "the search for double triangles");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t ids[3];
        if (!topology_corners(topology, i, ids)) continue;
        int first = ids[0] < ids[1] ? (ids[0] < ids[2] ? 0 : 2) : (ids[1] < ids[2] ? 1 : 2);
        uint32_t key[3] = {ids[first] + 1, ids[(first + 1) % 3] + 1, ids[(first + 2) % 3] + 1};
        size_t slot = (size_t)hash_u64(hash_u64(key[0] | (uint64_t)key[1] << 32) ^ key[2]) & (room - 1);
        while (table[slot][0] && memcmp(table[slot], key, sizeof key) != 0) slot = (slot + 1) & (room - 1);
        if (table[slot][0])
            ++*count;
        else
            memcpy(table[slot], key, sizeof key);
    }
    free(table);
    return STATUS_OK;
}

/* ---- volumes ---- */

double mesh_triangle_volume6(const Mesh *mesh, uint32_t triangle, Vec3 tip)
{
    const uint32_t *t = mesh->triangles[triangle];
    Vec3 a = vec3_sub(vec3_from_f(mesh->positions[t[0]]), tip);
    Vec3 b = vec3_sub(vec3_from_f(mesh->positions[t[1]]), tip);
    Vec3 c = vec3_sub(vec3_from_f(mesh->positions[t[2]]), tip);
    return vec3_dot(a, vec3_cross(b, c));
}

static Box3 add_corner(Box3 box, Vec3 p)
{
    box.min = vec3(double_min(box.min.x, p.x), double_min(box.min.y, p.y), double_min(box.min.z, p.z));
    box.max = vec3(double_max(box.max.x, p.x), double_max(box.max.y, p.y), double_max(box.max.z, p.z));
    return box;
}

static void measure_block(void *context, uint32_t number, unsigned worker)
{
    (void)worker;
    Inspection *inspection = context;
    const Mesh *mesh = inspection->mesh;
    Block block = block_of(number, inspection->triangles, mesh->n_triangles);
    BlockSums sums = {.bounds = box3_empty(), .finite = true};
    for (uint32_t i = block.begin; i < block.end; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 corner[3];
        for (int k = 0; k < 3; k++) {
            corner[k] = vec3_from_f(mesh->positions[t[k]]);
            sums.bounds = add_corner(sums.bounds, corner[k]);
            sums.finite = sums.finite && vec3_is_finite(corner[k]);
        }
        Vec3 cross = vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
        double twice_area = vec3_length(cross);
        sums.area += 0.5 * twice_area;
        sums.volume += vec3_dot(vec3_sub(corner[0], inspection->tip), cross) / 6;
        uint32_t ids[3];
        bool proper = topology_corners(&inspection->topology, i, ids);
        if (!proper || twice_area == 0) sums.n_degenerate++;
        if (proper) sums.n_components += find_leader(inspection->parent, i) == i;
    }
    inspection->sums[number] = sums;
}

/* A corner of the first triangle that has edges, the leader of its component. */
static Vec3 first_corner(const Topology *topology)
{
    uint32_t ids[3];
    for (uint32_t i = 0; i < topology->mesh->n_triangles; i++)
        if (topology_corners(topology, i, ids))
            return vec3_from_f(topology->mesh->positions[topology->mesh->triangles[i][0]]);
    return vec3(0, 0, 0);
}

/* How many components enclose a negative volume. A closed part's volume does not depend on the reference; its own first
 * corner keeps it exact when the part is small and far from the centre. */
static Status count_inverted(Inspection *inspection, MeshReport *report, Error *error)
{
    const Mesh *mesh = inspection->mesh;
    double *volumes = calloc((size_t)mesh->n_triangles + 1, sizeof *volumes); /* six times, at the leading triangle */
    if (!volumes) return fail_memory(error, mesh->n_triangles * sizeof *volumes, "the volumes of a mesh");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t ids[3], leader = find_leader(inspection->parent, i);
        if (!topology_corners(&inspection->topology, i, ids)) continue;
        volumes[leader] += mesh_triangle_volume6(mesh, i, vec3_from_f(mesh->positions[mesh->triangles[leader][0]]));
    }
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        if (volumes[i] < 0) report->n_inverted++;
    free(volumes);
    return STATUS_OK;
}

static Status measure(Inspection *inspection, Pool *pool, MeshReport *report, Error *error)
{
    inspection->tip = first_corner(&inspection->topology);
    report->bounds = box3_empty();
    report->finite = true;
    pool_run(pool, inspection->n_blocks, measure_block, inspection);
    for (uint32_t i = 0; i < inspection->n_blocks; i++) {
        const BlockSums *sums = &inspection->sums[i];
        if (!box3_is_empty(sums->bounds)) report->bounds = box3_union(report->bounds, sums->bounds);
        report->finite = report->finite && sums->finite;
        report->area += sums->area;
        report->volume += sums->volume;
        report->n_degenerate += sums->n_degenerate;
        report->n_components += sums->n_components;
    }
    if (report->n_components > 1) return count_inverted(inspection, report, error);
    report->n_inverted = report->n_components && report->volume < 0;
    return STATUS_OK;
}

static Status inspection_init(Inspection *inspection, const Mesh *mesh, Error *error)
{
    uint32_t n = mesh->n_triangles;
    *inspection = (Inspection){.mesh = mesh, .triangles = n / MOST_BLOCKS + 1};
    if (inspection->triangles < LEAST_BLOCK) inspection->triangles = LEAST_BLOCK;
    inspection->n_blocks = n / inspection->triangles + 1;
    inspection->vertices = mesh->n_vertices / inspection->n_blocks + 1;
    inspection->sums = malloc(inspection->n_blocks * sizeof *inspection->sums);
    inspection->facts = malloc(inspection->n_blocks * sizeof *inspection->facts);
    if (!inspection->sums || !inspection->facts)
        return fail_memory(error, inspection->n_blocks * sizeof *inspection->facts, "the inspection of a mesh");
    return STATUS_OK;
}

static void inspection_clear(Inspection *inspection)
{
    topology_clear(&inspection->topology);
    free(inspection->parent);
    free(inspection->sums);
    free(inspection->facts);
}

static Status inspect(Inspection *inspection, Pool *pool, MeshReport *report, Error *error)
{
    const Mesh *mesh = inspection->mesh;
    bool repeated = false;
    inspection->parent = malloc(((size_t)mesh->n_triangles + 1) * sizeof *inspection->parent);
    if (!inspection->parent)
        return fail_memory(error, mesh->n_triangles * sizeof *inspection->parent, "the parts of a mesh");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) atomic_init(&inspection->parent[i], i);
    TRY(topology_make(mesh, pool, &inspection->topology, error));
    count_edges(inspection, pool, report, &repeated);
    if (repeated) TRY(count_duplicates(&inspection->topology, &report->n_duplicate, error));
    return measure(inspection, pool, report, error);
}

Status mesh_inspect(const Mesh *mesh, Pool *pool, MeshReport *report, Error *error)
{
    memset(report, 0, sizeof *report);
    Inspection inspection;
    Status status = inspection_init(&inspection, mesh, error);
    if (status == STATUS_OK) status = inspect(&inspection, pool, report, error);
    inspection_clear(&inspection);
    report->closed = report->n_components > 0 && report->n_open_edges == 0 && report->consistent && report->finite;
    report->inside_out = report->volume < 0;
    return status;
}

Box3 mesh_bounds(const Mesh *mesh)
{
    Box3 bounds = box3_empty();
    for (uint32_t i = 0; i < mesh->n_vertices; i++) bounds = box3_add_point(bounds, vec3_from_f(mesh->positions[i]));
    return bounds;
}

double mesh_volume(const Mesh *mesh)
{
    Box3 bounds = box3_empty();
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int k = 0; k < 3; k++) bounds = add_corner(bounds, vec3_from_f(mesh->positions[mesh->triangles[i][k]]));
    Vec3 centre = box3_centre(bounds);
    double sum = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) sum += mesh_triangle_volume6(mesh, i, centre);
    return sum / 6;
}
