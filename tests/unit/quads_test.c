/* quads_test.c - triangles in pairs: none is lost, none is there twice, and rectangles are found.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "icosphere.h"
#include "mesh/quads.h"

#include <stdlib.h>
#include <string.h>

/* A triangle with its smallest number first, in its own direction. */
typedef struct Turned {
    uint32_t corner[3];
} Turned;

static Turned turned(const uint32_t corners[3])
{
    int first = corners[0] <= corners[1] && corners[0] <= corners[2] ? 0 : corners[1] <= corners[2] ? 1 : 2;
    return (Turned){{corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3]}};
}

static int compare_turned(const void *a, const void *b)
{
    for (int i = 0; i < 3; i++) {
        uint32_t x = ((const Turned *)a)->corner[i], y = ((const Turned *)b)->corner[i];
        if (x != y) return x < y ? -1 : 1;
    }
    return 0;
}

/* Pairs the triangles, checks that they are those of the mesh, and returns how many quads there are. */
static uint32_t pair(const Mesh *mesh)
{
    MeshQuad *quads = NULL;
    uint32_t n = 0, found = 0;
    assert_int_equal(mesh_pair_triangles(mesh, &quads, &n, NULL), STATUS_OK);
    Turned *before = calloc(mesh->n_triangles + 1U, sizeof *before), *after = calloc(2 * n + 1U, sizeof *after);
    assert_true(before && after);
    for (uint32_t i = 0; i < mesh->n_triangles; i++) before[i] = turned(mesh->triangles[i]);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t half = 0; half < (mesh_quad_is_single(quads[i]) ? 1U : 2U); half++) {
            uint32_t corners[3];
            mesh_quad_triangle(quads[i], half, corners);
            after[found++] = turned(corners);
        }
    assert_int_equal(found, mesh->n_triangles);
    qsort(before, found, sizeof *before, compare_turned);
    qsort(after, found, sizeof *after, compare_turned);
    assert_memory_equal(before, after, found * sizeof *before);
    free(before);
    free(after);
    free(quads);
    return n;
}

/* A sheet of n by n rectangles, a little bent, each cut along one diagonal or the other. */
static Mesh *sheet(uint32_t n)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new((n + 1) * (n + 1), 2 * n * n, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i <= n; i++)
        for (uint32_t k = 0; k <= n; k++)
            mesh->positions[i * (n + 1) + k] = vec3f((float)i, (float)k * 1.1F, 0.01F * (float)(i * i + k));
    for (uint32_t i = 0, at = 0; i < n; i++)
        for (uint32_t k = 0; k < n; k++) {
            uint32_t a = i * (n + 1) + k, b = a + n + 1, c = b + 1, d = a + 1;
            const uint32_t one[2][3] = {{a, b, c}, {c, d, a}}, other[2][3] = {{d, a, b}, {b, c, d}};
            memcpy(mesh->triangles[at], (i + k) % 3 ? one : other, sizeof one);
            at += 2;
        }
    return mesh;
}

static void test_rectangles(void **state)
{
    (void)state;
    Mesh *mesh = sheet(40), *box = NULL;
    assert_int_equal(pair(mesh), 40 * 40);
    mesh_free(mesh);
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 2, 3), 0, 1, &box, NULL), STATUS_OK);
    assert_int_equal(pair(box), 6);
    mesh_free(box);
}

static void test_even_triangles(void **state)
{
    (void)state;
    Mesh *mesh = icosphere(1, 5);
    assert_non_null(mesh);
    uint32_t n = pair(mesh);
    print_message("%u triangles of a sphere: %u quads\n", mesh->n_triangles, n);
    assert_true(n < 0.6 * mesh->n_triangles);
    mesh_free(mesh);
}

/* No triangles; one; two that do not fit; two that look the wrong way at their edge; one without area. */
static void test_singles(void **state)
{
    (void)state;
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(4, 0, false, false, &mesh, NULL), STATUS_OK);
    assert_int_equal(pair(mesh), 0);
    mesh_free(mesh);
    assert_int_equal(mesh_new(4, 2, false, false, &mesh, NULL), STATUS_OK);
    const Vec3f positions[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-90, -1, 80}};
    memcpy(mesh->positions, positions, sizeof positions);
    const uint32_t apart[2][3] = {{0, 1, 2}, {0, 2, 3}}, alike[2][3] = {{0, 1, 2}, {0, 1, 3}},
                   flat[2][3] = {{0, 0, 1}, {1, 1, 1}};
    memcpy(mesh->triangles, apart, sizeof apart);
    assert_int_equal(pair(mesh), 2);
    mesh->positions[3] = vec3f(-1, 0, 0);
    assert_int_equal(pair(mesh), 1);
    memcpy(mesh->triangles, alike, sizeof alike);
    assert_int_equal(pair(mesh), 2);
    memcpy(mesh->triangles, flat, sizeof flat);
    assert_int_equal(pair(mesh), 2);
    mesh->n_triangles = 1;
    assert_int_equal(pair(mesh), 1);
    mesh_free(mesh);
}

/* Very many triangles about one vertex, and very many on one edge, take no longer for each. */
static void test_hubs(void **state)
{
    (void)state;
    enum { N = 200000 };
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(N + 1, N, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i < N; i++) {
        mesh->positions[i + 1] = vec3f((float)(i % 100), (float)i * 1e-3F, 1);
        const uint32_t corners[3] = {0, i + 1, (i + 1) % N + 1};
        memcpy(mesh->triangles[i], corners, sizeof corners);
    }
    assert_true(pair(mesh) >= N / 2);
    for (uint32_t i = 0; i < N; i++) mesh->triangles[i][1] = 1;
    assert_true(pair(mesh) >= N / 2);
    mesh_free(mesh);
}

static void test_turned(void **state)
{
    (void)state;
    MeshQuad quad = {5, 6, 7, 8};
    const uint32_t even[3] = {5, 8, 6}, odd[3] = {7, 6, 8};
    uint32_t corners[3];
    mesh_quad_turn(quad);
    mesh_quad_triangle(quad, 0, corners);
    assert_memory_equal(corners, even, sizeof even);
    mesh_quad_triangle(quad, 1, corners);
    assert_memory_equal(corners, odd, sizeof odd);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rectangles), cmocka_unit_test(test_even_triangles), cmocka_unit_test(test_singles),
        cmocka_unit_test(test_hubs),       cmocka_unit_test(test_turned),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
