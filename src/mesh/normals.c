/* normals.c - normals at the vertices of a mesh that has none, from the triangles around them.
 *
 * An edge between two triangles is smooth where they turn by less than an angle. The corners that triangles have at one place
 * are in one group where smooth edges lead from one to the next, and share a normal: the mean of the triangles' own, by
 * their angles there, so that it does not depend on how a face was cut. Between groups there is a crease.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/equal.h"
#include "mesh/topology.h"

/* Corner 3 i + k is corner k of triangle i. */
typedef struct Corners {
    Mesh *mesh;
    uint32_t n;
    uint32_t *parent; /* of each corner, in sets_new's way; then the number of its group */
    uint32_t n_groups;
    uint32_t *first; /* of each corner, the first of the same group and vertex; then its new vertex */
    uint32_t n_vertices;
} Corners;

/* Unit; without length where the triangle has no area. */
static Vec3 face_normal(const Mesh *mesh, uint32_t triangle)
{
    Vec3 n = mesh_area_normal(mesh, triangle);
    double length = vec3_length(n);
    return length > 0 ? vec3_scale(n, 1 / length) : vec3(0, 0, 0);
}

/* Between the edges of a triangle that meet in a corner. */
static double angle_at(const Mesh *mesh, uint32_t corner)
{
    const uint32_t *t = mesh->triangles[corner / 3];
    Vec3 tip = vec3_from_f(mesh->positions[t[corner % 3]]);
    Vec3 a = vec3_sub(vec3_from_f(mesh->positions[t[(corner + 1) % 3]]), tip);
    Vec3 b = vec3_sub(vec3_from_f(mesh->positions[t[(corner + 2) % 3]]), tip);
    return vec3_angle(a, b);
}

static uint32_t corner_at(const Topology *topology, uint32_t triangle, uint32_t place)
{
    uint32_t k = 0, ids[3];
    topology_corners(topology, triangle, ids);
    while (ids[k] != place) k++;
    return 3 * triangle + k;
}

/* Unites what meets at smooth edges. */
static Status unite_smooth(Corners *corners, double cos_crease, Pool *pool, Error *error)
{
    Topology topology;
    Status status = topology_make(corners->mesh, pool, &topology, error);
    Edge edge;
    uint32_t low = 0;
    size_t at = 0;
    while (status == STATUS_OK && topology_next_edge(&topology, &low, &at, &edge)) {
        if (edge.n != 2 || edge.n_upward != 1) continue;
        uint32_t a = edge.uses[0].triangle, b = edge.uses[1].triangle;
        if (!(vec3_dot(face_normal(corners->mesh, a), face_normal(corners->mesh, b)) > cos_crease)) continue;
        set_unite(corners->parent, corner_at(&topology, a, edge.low), corner_at(&topology, b, edge.low));
        set_unite(corners->parent, corner_at(&topology, a, edge.high), corner_at(&topology, b, edge.high));
    }
    topology_clear(&topology);
    return status;
}

Status mesh_is_rounded(Mesh *mesh, double crease_rad, bool *rounded, Error *error)
{
    enum { LEAST_TRIANGLES = 500 };
    const double flat = cos(0.01), sharp = cos(0.5 * crease_rad);
    Topology topology;
    Edge edge;
    uint32_t low = 0;
    size_t at = 0, n_turning = 0, n_sharp = 0;
    *rounded = false;
    if (mesh->n_triangles < LEAST_TRIANGLES) return STATUS_OK;
    Status status = topology_make(mesh, NULL, &topology, error);
    while (status == STATUS_OK && topology_next_edge(&topology, &low, &at, &edge)) {
        if (edge.n != 2 || edge.n_upward != 1) continue;
        double cosine = vec3_dot(face_normal(mesh, edge.uses[0].triangle), face_normal(mesh, edge.uses[1].triangle));
        n_turning += cosine < flat;
        n_sharp += cosine < sharp;
    }
    topology_clear(&topology);
    *rounded = 2 * n_sharp < n_turning;
    return status;
}

/* The leader of a group is its lowest corner, so that it has its number before the others ask for it. */
static void number_groups(Corners *corners)
{
    for (uint32_t c = 0; c < corners->n; c++) corners->parent[c] = set_find(corners->parent, c);
    for (uint32_t c = 0; c < corners->n; c++) {
        uint32_t leader = corners->parent[c];
        corners->parent[c] = leader == c ? corners->n_groups++ : corners->parent[leader];
    }
}

static uint32_t vertex_of(const Corners *corners, uint32_t corner)
{
    return corners->mesh->triangles[corner / 3][corner % 3];
}

static uint32_t hash_corner(const void *context, uint32_t i)
{
    const Corners *corners = context;
    return (uint32_t)hash_u64(vertex_of(corners, i) | (uint64_t)corners->parent[i] << 32);
}

static bool same_corner(const void *context, uint32_t i, uint32_t k)
{
    const Corners *corners = context;
    return vertex_of(corners, i) == vertex_of(corners, k) && corners->parent[i] == corners->parent[k];
}

static Status number_vertices(Corners *corners, Pool *pool, Error *error)
{
    EqualItems items = {corners, hash_corner, same_corner};
    TRY(equal_find(&items, corners->n, "the normals of a mesh", pool, &corners->first, error));
    for (uint32_t c = 0; c < corners->n; c++) {
        uint32_t first = corners->first[c];
        corners->first[c] = first == c ? corners->n_vertices++ : corners->first[first];
    }
    return STATUS_OK;
}

static Vec3 *sum_normals(const Corners *corners, const Mesh *mesh)
{
    Vec3 *sums = calloc(corners->n_groups + 1UL, sizeof *sums);
    for (uint32_t i = 0; sums && i < mesh->n_triangles; i++) {
        Vec3 normal = face_normal(mesh, i);
        for (uint32_t c = 3 * i; c < 3 * i + 3; c++) {
            Vec3 *sum = &sums[corners->parent[c]];
            *sum = vec3_add(*sum, vec3_scale(normal, angle_at(mesh, c)));
        }
    }
    return sums;
}

/* Gives the mesh, or what it becomes, the vertices and normals that were found. */
static Status split(const Corners *corners, Mesh *mesh, Error *error)
{
    Mesh *made;
    TRY(mesh_new(corners->n_vertices, mesh->n_triangles, true, mesh->uvs != NULL, &made, error));
    Vec3 *sums = sum_normals(corners, mesh);
    if (!sums) {
        mesh_free(made);
        return fail_memory(error, corners->n_groups * sizeof *sums, "the normals of a mesh");
    }
    for (uint32_t c = 0; c < corners->n; c++) {
        uint32_t to = corners->first[c], from = mesh->triangles[c / 3][c % 3];
        made->triangles[c / 3][c % 3] = to;
        made->positions[to] = mesh->positions[from];
        double length = vec3_length(sums[corners->parent[c]]);
        made->normals[to] = vec3f_from(vec3_scale(sums[corners->parent[c]], length > 1e-9 ? 1 / length : 0));
        if (mesh->uvs) memcpy(&made->uvs[2 * (size_t)to], &mesh->uvs[2 * (size_t)from], 2 * sizeof(float));
    }
    free(sums);
    made->grid_columns = mesh->grid_columns;
    Mesh old = *mesh;
    *mesh = *made;
    *made = old;
    mesh_free(made);
    return mesh_normalize_normals(mesh, error);
}

Status mesh_make_normals(Mesh *mesh, Mesh *end, double crease_rad, Pool *pool, Error *error)
{
    if (mesh->n_triangles > UINT32_MAX / 3)
        return fail(error, STATUS_SCENE, "a mesh is too large to have normals made");
    Corners corners = {.mesh = mesh, .n = 3 * mesh->n_triangles};
    Status status = sets_new(corners.n, &corners.parent, error);
    if (status == STATUS_OK) status = unite_smooth(&corners, cos(crease_rad), pool, error);
    if (status == STATUS_OK) {
        number_groups(&corners);
        status = number_vertices(&corners, pool, error);
    }
    if (status == STATUS_OK && end) status = split(&corners, end, error);
    if (status == STATUS_OK) status = split(&corners, mesh, error);
    free(corners.parent);
    free(corners.first);
    return status;
}
