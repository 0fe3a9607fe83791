/* mesh.c - storage of triangle meshes, welding, transformation.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/mesh.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/equal.h"

enum { EMBREE_PADDING = 16 }; /* Embree reads 16 bytes at the last position's 12 */

void mesh_free(Mesh *mesh)
{
    if (!mesh) return;
    free(mesh->positions);
    free(mesh->normals);
    free(mesh->uvs);
    free(mesh->triangles);
    free(mesh->cuts);
    free(mesh);
}

Status mesh_new(uint32_t n_vertices, uint32_t n_triangles, bool normals, bool uvs, Mesh **mesh, Error *error)
{
    Mesh *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a mesh");
    size_t position_bytes = n_vertices * sizeof(Vec3f) + EMBREE_PADDING;
    size_t triangle_bytes = n_triangles * sizeof *made->triangles + EMBREE_PADDING;
    made->positions = calloc(1, position_bytes);
    made->triangles = calloc(1, triangle_bytes);
    if (normals) made->normals = calloc(1, position_bytes);
    if (uvs) made->uvs = calloc(2 * (size_t)n_vertices + 1, sizeof(float));
    if (!made->positions || !made->triangles || (normals && !made->normals) || (uvs && !made->uvs)) {
        mesh_free(made);
        return fail_memory(error, position_bytes + triangle_bytes, "a mesh");
    }
    made->n_vertices = n_vertices;
    made->n_triangles = n_triangles;
    *mesh = made;
    return STATUS_OK;
}

/* All that makes a vertex itself, as bits; -0 is 0. */
enum { MAX_VERTEX_WORDS = 8 };
typedef struct VertexKey {
    uint32_t words[MAX_VERTEX_WORDS];
} VertexKey;

static uint32_t float_bits(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits == 0x80000000U ? 0 : bits;
}

static VertexKey vertex_key(const Mesh *mesh, size_t i)
{
    VertexKey key = {{0}};
    const Vec3f *p = &mesh->positions[i];
    key.words[0] = float_bits(p->x);
    key.words[1] = float_bits(p->y);
    key.words[2] = float_bits(p->z);
    if (mesh->normals) {
        const Vec3f *n = &mesh->normals[i];
        key.words[3] = float_bits(n->x);
        key.words[4] = float_bits(n->y);
        key.words[5] = float_bits(n->z);
    }
    if (mesh->uvs) {
        key.words[6] = float_bits(mesh->uvs[2 * i]);
        key.words[7] = float_bits(mesh->uvs[2 * i + 1]);
    }
    return key;
}

static uint32_t key_hash(const void *context, uint32_t i)
{
    VertexKey key = vertex_key(context, i);
    uint64_t h = 0;
    for (size_t k = 0; k < MAX_VERTEX_WORDS; k += 2)
        h = hash_u64(h ^ (key.words[k] | (uint64_t)key.words[k + 1] << 32));
    return (uint32_t)h;
}

static bool same_key(const void *context, uint32_t i, uint32_t k)
{
    VertexKey a = vertex_key(context, i), b = vertex_key(context, k);
    return memcmp(&a, &b, sizeof a) == 0;
}

static uint32_t position_hash(const void *context, uint32_t i)
{
    const Vec3f *p = &((const Mesh *)context)->positions[i];
    return (uint32_t)hash_u64(hash_u64(float_bits(p->x) | (uint64_t)float_bits(p->y) << 32) ^ float_bits(p->z));
}

static bool same_position(const void *context, uint32_t i, uint32_t k)
{
    const Mesh *mesh = context;
    Vec3f a = mesh->positions[i], b = mesh->positions[k];
    return float_bits(a.x) == float_bits(b.x) && float_bits(a.y) == float_bits(b.y) &&
           float_bits(a.z) == float_bits(b.z);
}

Status mesh_number_positions(const Mesh *mesh, Pool *pool, uint32_t **ids, Error *error)
{
    EqualItems items = {mesh, position_hash, same_position};
    if (!mesh->distinct) return equal_find(&items, mesh->n_vertices, "the inspection of a mesh", pool, ids, error);
    *ids = malloc((mesh->n_vertices + 1UL) * sizeof **ids);
    if (!*ids) return fail_memory(error, mesh->n_vertices * sizeof **ids, "the inspection of a mesh");
    for (uint32_t i = 0; i < mesh->n_vertices; i++) (*ids)[i] = i;
    return STATUS_OK;
}

/* Gives back what the arrays have more than the mesh needs; a failure leaves them as they are. */
static void shrink(void *array_pointer, size_t bytes)
{
    void *array;
    memcpy(&array, array_pointer, sizeof array);
    void *smaller = array ? realloc(array, bytes) : NULL;
    if (smaller) memcpy(array_pointer, &smaller, sizeof smaller);
}

static void shrink_vertices(Mesh *mesh)
{
    shrink(&mesh->positions, mesh->n_vertices * sizeof(Vec3f) + EMBREE_PADDING);
    shrink(&mesh->normals, mesh->n_vertices * sizeof(Vec3f) + EMBREE_PADDING);
    shrink(&mesh->uvs, (2 * (size_t)mesh->n_vertices + 1) * sizeof(float));
}

static void keep_vertex(Mesh *mesh, uint32_t to, uint32_t from)
{
    mesh->positions[to] = mesh->positions[from];
    if (mesh->normals) mesh->normals[to] = mesh->normals[from];
    if (mesh->uvs) memmove(&mesh->uvs[2 * (size_t)to], &mesh->uvs[2 * (size_t)from], 2 * sizeof(float));
}

/* first: of each vertex the first that is equal to it; becomes its new number. */
static void drop_vertices(Mesh *mesh, const bool *used, uint32_t *first)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        bool is_first = first[i] == i;
        if (!is_first) {
            first[i] = first[first[i]];
        } else if (used[i]) {
            keep_vertex(mesh, kept, i);
            first[i] = kept++;
        }
    }
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int k = 0; k < 3; k++) mesh->triangles[i][k] = first[mesh->triangles[i][k]];
    mesh->n_vertices = kept;
    shrink_vertices(mesh);
}

Status mesh_weld(Mesh *mesh, Pool *pool, Error *error)
{
    bool plain = !mesh->normals && !mesh->uvs, spare = false;
    EqualItems items =
        plain ? (EqualItems){mesh, position_hash, same_position} : (EqualItems){mesh, key_hash, same_key};
    uint32_t *first;
    TRY(equal_find(&items, mesh->n_vertices, "the welding of a mesh", pool, &first, error));
    bool *used = calloc(mesh->n_vertices + 1UL, sizeof *used);
    if (!used) {
        free(first);
        return fail_memory(error, mesh->n_vertices * sizeof *used, "the welding of a mesh");
    }
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (int k = 0; k < 3; k++)
            used[first[mesh->triangles[i][k]]] = true; /* also where only an equal one is used */
    for (uint32_t i = 0; i < mesh->n_vertices; i++) spare = spare || !used[i];
    if (spare) drop_vertices(mesh, used, first);
    mesh->distinct = plain;
    free(used);
    free(first);
    return STATUS_OK;
}

void mesh_transform(Mesh *mesh, const Affine *transform)
{
    /* Normals go with the matrix of cofactors, which is the transposed inverse times the determinant and
     * exists for every map. */
    const double(*m)[3] = transform->m;
    double cofactor[3][3];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) {
            int r1 = (row + 1) % 3, r2 = (row + 2) % 3, c1 = (column + 1) % 3, c2 = (column + 2) % 3;
            cofactor[row][column] = m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
        }
    bool mirrors = affine_determinant(transform) < 0;
    mesh->distinct = false; /* rounding may bring some together */
    double sign = mirrors ? -1 : 1;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        mesh->positions[i] = vec3f_from(affine_point(transform, vec3_from_f(mesh->positions[i])));
        if (!mesh->normals) continue;
        Vec3 n = vec3_from_f(mesh->normals[i]);
        Vec3 turned = vec3(cofactor[0][0] * n.x + cofactor[0][1] * n.y + cofactor[0][2] * n.z,
                           cofactor[1][0] * n.x + cofactor[1][1] * n.y + cofactor[1][2] * n.z,
                           cofactor[2][0] * n.x + cofactor[2][1] * n.y + cofactor[2][2] * n.z);
        double length = vec3_length(turned);
        if (length > 0) mesh->normals[i] = vec3f_from(vec3_scale(turned, sign / length));
    }
    if (!mirrors) return;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        uint32_t keep = mesh->triangles[i][1];
        mesh->triangles[i][1] = mesh->triangles[i][2];
        mesh->triangles[i][2] = keep;
    }
}

Status mesh_normalize_normals(Mesh *mesh, Error *error)
{
    if (!mesh->normals) return STATUS_OK;
    bool missing = false;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        Vec3 n = vec3_from_f(mesh->normals[i]);
        double length = vec3_length(n);
        if (length > 0)
            mesh->normals[i] = vec3f_from(vec3_scale(n, 1 / length));
        else
            missing = true;
    }
    if (!missing) return STATUS_OK;
    Vec3 *sums = calloc((size_t)mesh->n_vertices + 1, sizeof *sums);
    if (!sums) return fail_memory(error, mesh->n_vertices * sizeof *sums, "the normals of a mesh");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 n = mesh_area_normal(mesh, i);
        for (int k = 0; k < 3; k++) sums[t[k]] = vec3_add(sums[t[k]], n);
    }
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        Vec3f n = mesh->normals[i];
        if (n.x != 0 || n.y != 0 || n.z != 0) continue;
        double length = vec3_length(sums[i]);
        mesh->normals[i] = length > 0 ? vec3f_from(vec3_scale(sums[i], 1 / length)) : vec3f(0, 1, 0);
    }
    free(sums);
    return STATUS_OK;
}

bool mesh_same_triangles(const Mesh *a, const Mesh *b)
{
    return a->n_vertices == b->n_vertices && a->n_triangles == b->n_triangles && !a->normals == !b->normals &&
           memcmp(a->triangles, b->triangles, a->n_triangles * sizeof *a->triangles) == 0;
}
