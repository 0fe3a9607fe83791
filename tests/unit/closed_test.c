/* closed_test.c - what a mesh encloses: reports of good and broken meshes, volume, and mended orientation.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "base/hash.h"
#include "icosphere.h"
#include "mesh_joined.h"

static const double pi = 3.14159265358979323846;

static MeshReport inspected(const Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    return report;
}

static Mesh *box(double from, double to)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_make_box(vec3(from, from, from), vec3(to, to, to), 0, 0, &mesh, NULL), STATUS_OK);
    return mesh;
}

static void turn_triangle(Mesh *mesh, uint32_t i)
{
    uint32_t keep = mesh->triangles[i][1];
    mesh->triangles[i][1] = mesh->triangles[i][2];
    mesh->triangles[i][2] = keep;
}

static Mesh *turned(Mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->n_triangles; i++) turn_triangle(mesh, i);
    return mesh;
}

static Mesh *from_arrays(const Vec3f *positions, uint32_t n_vertices, const uint32_t (*triangles)[3],
                         uint32_t n_triangles)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(n_vertices, n_triangles, false, false, &mesh, NULL), STATUS_OK);
    memcpy(mesh->positions, positions, n_vertices * sizeof *positions);
    memcpy(mesh->triangles, triangles, n_triangles * sizeof *triangles);
    return mesh;
}

static void test_whole_box(void **state)
{
    (void)state;
    Mesh *mesh = box(1, 3);
    MeshReport report = inspected(mesh);
    assert_true(report.closed && report.consistent && report.finite && !report.inside_out);
    assert_int_equal(report.n_open_edges + report.n_non_manifold_edges + report.n_degenerate + report.n_duplicate, 0);
    assert_int_equal(report.n_components, 1);
    assert_int_equal(report.n_inverted, 0);
    assert_near(report.volume, 8, 1e-12);
    assert_near(mesh_volume(mesh), 8, 1e-12);
    assert_near(report.area, 24, 1e-12);
    turned(mesh);
    report = inspected(mesh);
    assert_true(report.closed && report.inside_out);
    assert_int_equal(report.n_inverted, 1);
    assert_near(report.volume, -8, 1e-12);
    mesh_free(mesh);
}

static void test_split_vertices_are_closed(void **state)
{
    (void)state;
    Mesh *whole = icosphere(1, 3), *split = NULL;
    assert_non_null(whole);
    assert_int_equal(mesh_new(3 * whole->n_triangles, whole->n_triangles, false, false, &split, NULL), STATUS_OK);
    for (uint32_t i = 0; i < whole->n_triangles; i++)
        for (uint32_t k = 0; k < 3; k++) {
            split->positions[3 * i + k] = whole->positions[whole->triangles[i][k]];
            split->triangles[i][k] = 3 * i + k;
        }
    MeshReport report = inspected(split);
    assert_true(report.closed);
    assert_int_equal(report.n_components, 1);
    /* one unit in the last place is a gap */
    split->positions[0].x = nextafterf(split->positions[0].x, 2);
    report = inspected(split);
    assert_false(report.closed);
    assert_int_equal(report.n_open_edges, 4);
    mesh_free(whole);
    mesh_free(split);
}

static void test_scale_does_not_matter(void **state)
{
    (void)state;
    for (double scale = 1e-15; scale < 1e10; scale *= 1e6) {
        Mesh *mesh = icosphere(scale, 4);
        assert_non_null(mesh);
        MeshReport report = inspected(mesh);
        assert_true(report.closed);
        assert_int_equal(report.n_degenerate, 0);
        assert_near(report.volume / (4 * pi / 3 * scale * scale * scale), 1, 5e-3);
        mesh_free(mesh);
    }
}

static void test_hole(void **state)
{
    (void)state;
    Mesh *mesh = box(0, 1);
    mesh->n_triangles--;
    MeshReport report = inspected(mesh);
    assert_false(report.closed);
    assert_true(report.consistent);
    assert_int_equal(report.n_open_edges, 3);
    /* the open edges that are shown are the missing triangle's */
    for (int i = 0; i < 3; i++) {
        int on_face = 0;
        for (int k = 0; k < 3; k++) {
            Vec3f p = mesh->positions[mesh->triangles[11][k]];
            on_face += memcmp(&p, &report.open[i].a, sizeof p) == 0;
            on_face += memcmp(&p, &report.open[i].b, sizeof p) == 0;
        }
        assert_int_equal(on_face, 2);
    }
    mesh_free(mesh);
}

static void test_odd_triangles(void **state)
{
    (void)state;
    Mesh *mesh = joined(box(0, 1), box(5, 6));
    uint32_t n = mesh->n_triangles;
    mesh->triangles[n - 1][1] = mesh->triangles[n - 1][0]; /* two equal vertices: a hole of a triangle */
    MeshReport report = inspected(mesh);
    assert_int_equal(report.n_degenerate, 1);
    assert_int_equal(report.n_components, 2);
    assert_int_equal(report.n_open_edges, 3);
    memcpy(mesh->triangles[n - 1], mesh->triangles[0], sizeof mesh->triangles[0]); /* the same one twice */
    report = inspected(mesh);
    assert_int_equal(report.n_duplicate, 1);
    assert_int_equal(report.n_non_manifold_edges, 3);
    assert_false(report.closed);
    mesh->positions[0].x = NAN;
    report = inspected(mesh);
    assert_false(report.finite || report.closed);
    mesh_free(mesh);
    assert_int_equal(mesh_new(0, 0, false, false, &mesh, NULL), STATUS_OK);
    report = inspected(mesh);
    assert_false(report.closed);
    assert_near(mesh_volume(mesh), 0, 0);
    mesh_free(mesh);
}

static void test_needle_is_counted(void **state)
{
    (void)state;
    const Vec3f p[] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {0, 3, 0}};
    const uint32_t t[][3] = {{0, 1, 2}, {0, 1, 3}};
    Mesh *mesh = from_arrays(p, 4, t, 2);
    MeshReport report = inspected(mesh);
    assert_int_equal(report.n_degenerate, 1);
    assert_false(report.consistent); /* both run from 0 to 1 */
    mesh_free(mesh);
}

static void test_orient_mixed_sphere(void **state)
{
    (void)state;
    Mesh *mesh = icosphere(2, 4);
    assert_non_null(mesh);
    double volume = mesh_volume(mesh);
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        if (hash_u32(i) & 1) turn_triangle(mesh, i);
    MeshReport report = inspected(mesh);
    assert_false(report.consistent || report.closed);
    bool mended = false;
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_true(mended);
    report = inspected(mesh);
    assert_true(report.closed);
    assert_near(report.volume, volume, 1e-12);
    /* inside out altogether, normals too */
    uint32_t n_turned;
    turned(mesh);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) mesh->normals[i] = vec3f_negate(mesh->normals[i]);
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_near(mesh_volume(mesh), volume, 1e-12);
    assert_int_equal(mesh_turn_normals(mesh, &n_turned, NULL), STATUS_OK);
    assert_int_equal(n_turned, mesh->n_vertices);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) assert_true(vec3f_dot(mesh->normals[i], mesh->positions[i]) > 0);
    /* triangles inside out, normals right: those stay */
    turned(mesh);
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_true(mended);
    assert_int_equal(mesh_turn_normals(mesh, &n_turned, NULL), STATUS_OK);
    assert_int_equal(n_turned, 0);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) assert_true(vec3f_dot(mesh->normals[i], mesh->positions[i]) > 0);
    mesh_free(mesh);
}

static void check_oriented(Mesh *mesh, double volume)
{
    bool mended = false;
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_true(mended);
    MeshReport report = inspected(mesh);
    assert_true(report.closed && !report.inside_out);
    assert_near(report.volume, volume, 1e-9);
    mesh_free(mesh);
}

static void test_orient_cavities(void **state)
{
    (void)state;
    check_oriented(joined(box(0, 4), turned(box(1, 2))), 64 - 1);         /* a cavity stays one */
    check_oriented(turned(joined(box(0, 4), turned(box(1, 2)))), 64 - 1); /* reversed as a whole */
    check_oriented(joined(box(0, 4), box(1, 2)), 64 + 1);                 /* was none, becomes none */
    check_oriented(joined(box(0, 4), turned(box(5, 6))), 64 + 1);         /* outside: inside out by mistake */
    check_oriented(joined(joined(box(0, 9), turned(box(1, 8))), joined(box(2, 7), turned(box(3, 6)))),
                   729 - 343 + 125 - 27);                  /* shells within shells */
    Mesh *beside = joined(box(0, 4), turned(box(3, 4.5))); /* within the box of the other, but not inside */
    Affine skew = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
    mesh_transform(beside, &skew);
    check_oriented(beside, 64 + 3.375);
    /* touching along an edge */
    check_oriented(joined(box(0, 1), turned(box(1, 2))), 2);
}

static void test_orient_refuses(void **state)
{
    (void)state;
    Vec3f p[10];
    uint32_t t[10][3];
    for (uint32_t i = 0; i < 5; i++) { /* a Moebius band of five quads */
        float angle = (float)(2 * pi * i / 5);
        float lift = cosf(angle / 2), out = 3 + sinf(angle / 2);
        float in = 3 - sinf(angle / 2);
        p[2 * i] = vec3f(out * cosf(angle), lift, out * sinf(angle));
        p[2 * i + 1] = vec3f(in * cosf(angle), -lift, in * sinf(angle));
        uint32_t a = 2 * i, b = 2 * i + 1, c = 2 * i + 2, d = 2 * i + 3;
        if (i == 4) {
            c = 1;
            d = 0;
        }
        const uint32_t quad[2][3] = {{a, b, c}, {c, b, d}};
        memcpy(t[2 * i], quad, sizeof quad);
    }
    Mesh *mesh = from_arrays(p, 10, (const uint32_t(*)[3])t, 10);
    bool mended = true;
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_false(mended);
    assert_memory_equal(mesh->triangles, t, sizeof t);
    mesh_free(mesh);
    /* three fins on one edge have no sides that agree, but nothing is wrong with them either */
    const Vec3f fins[] = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
    const uint32_t same_way[][3] = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}};
    mesh = from_arrays(fins, 5, same_way, 3);
    assert_int_equal(mesh_orient(mesh, NULL, &mended, NULL), STATUS_OK);
    assert_false(mended);
    mesh_free(mesh);
}

static void test_fan_of_many(void **state)
{
    (void)state;
    enum { N = 200000 }; /* one vertex in all triangles: a spindle */
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(N + 2, 2 * N, false, false, &mesh, NULL), STATUS_OK);
    mesh->positions[0] = vec3f(0, 1, 0);
    mesh->positions[1] = vec3f(0, -1, 0);
    for (uint32_t i = 0; i < N; i++) {
        double angle = 2 * pi * i / N;
        mesh->positions[i + 2] = vec3f((float)cos(angle), 0, (float)sin(angle));
        uint32_t here = i + 2, next = (i + 1) % N + 2;
        const uint32_t pair[2][3] = {{0, next, here}, {1, here, next}};
        memcpy(mesh->triangles[2 * i], pair, sizeof pair);
    }
    MeshReport report = inspected(mesh);
    assert_true(report.closed);
    assert_near(report.volume, 2 * pi / 3, 1e-5);
    mesh_free(mesh);
}

static Mesh *copied(const Mesh *mesh)
{
    Mesh *copy = NULL;
    assert_int_equal(mesh_new(mesh->n_vertices, mesh->n_triangles, mesh->normals, false, &copy, NULL), STATUS_OK);
    memcpy(copy->positions, mesh->positions, mesh->n_vertices * sizeof *copy->positions);
    memcpy(copy->triangles, mesh->triangles, mesh->n_triangles * sizeof *copy->triangles);
    if (copy->normals) memcpy(copy->normals, mesh->normals, mesh->n_vertices * sizeof *copy->normals);
    return copy;
}

/* What is found, and the welding before it, do not depend on the threads, nor on how the mesh is cut into blocks. */
static void test_threads(void **state)
{
    (void)state;
    Mesh *mesh = NULL, *copy = NULL;
    Pool *pool;
    assert_int_equal(pool_new(3, &pool, NULL), STATUS_OK);
    for (int kind = 0; kind < 4; kind++) {
        mesh = icosphere(2, 6);
        assert_non_null(mesh);
        if (kind == 1) mesh = joined(mesh, box(-1, 1));
        /* every triangle with corners of its own, in another order; and without normals */
        uint32_t n = mesh->n_triangles;
        Mesh *split = NULL;
        assert_int_equal(mesh_new(3 * n, n, kind == 2, false, &split, NULL), STATUS_OK);
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t k = 0; k < 3; k++) {
                uint32_t from = mesh->triangles[(uint64_t)i * 7919 % n][k];
                split->positions[3 * i + k] = mesh->positions[from];
                if (kind == 2) split->normals[3 * i + k] = vec3f(0, 0, i % 2 ? 1 : -1);
                split->triangles[i][k] = 3 * i + k;
            }
        if (kind == 3) split->n_triangles -= 100;
        copy = copied(split);
        assert_int_equal(mesh_weld(split, NULL, NULL), STATUS_OK);
        assert_int_equal(mesh_weld(copy, pool, NULL), STATUS_OK);
        if (kind == 0) assert_int_equal(split->n_vertices, n / 2 + 2);
        assert_int_equal(split->n_vertices, copy->n_vertices);
        assert_memory_equal(split->triangles, copy->triangles, split->n_triangles * sizeof *split->triangles);
        MeshReport alone = inspected(split), together;
        assert_int_equal(mesh_inspect(copy, pool, &together, NULL), STATUS_OK);
        assert_memory_equal(&alone, &together, sizeof alone);
        assert_true(alone.closed == (kind != 3));
        assert_true((alone.n_open_edges > 0) == (kind == 3));
        assert_int_equal(alone.n_components, kind == 1 ? 2 : kind == 3 ? alone.n_components : 1);
        if (kind != 3) assert_near(alone.volume, 4 * pi / 3 * 8 + (kind == 1 ? 8 : 0), 0.02);
        mesh_free(mesh);
        mesh_free(split);
        mesh_free(copy);
    }
    pool_free(pool);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_whole_box),
        cmocka_unit_test(test_split_vertices_are_closed),
        cmocka_unit_test(test_scale_does_not_matter),
        cmocka_unit_test(test_hole),
        cmocka_unit_test(test_odd_triangles),
        cmocka_unit_test(test_needle_is_counted),
        cmocka_unit_test(test_orient_mixed_sphere),
        cmocka_unit_test(test_orient_cavities),
        cmocka_unit_test(test_orient_refuses),
        cmocka_unit_test(test_fan_of_many),
        cmocka_unit_test(test_threads),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
