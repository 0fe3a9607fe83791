/* box_test.c - made meshes: boxes with every kind of bevel, and spheres, against closed forms.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "mesh/mesh.h"

static const double pi = 3.14159265358979323846;

static MeshReport inspected(const Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    return report;
}

/* Makes a box that must be closed, in one part, and within its corners. */
static Mesh *make(Vec3 from, Vec3 to, double bevel, unsigned segments, MeshReport *report)
{
    Mesh *mesh = NULL;
    Error error = {STATUS_OK, ""};
    if (mesh_make_box(from, to, bevel, segments, &mesh, &error) != STATUS_OK) fail_msg("%s", error.text);
    *report = inspected(mesh);
    assert_true(report->closed);
    assert_true(report->consistent);
    assert_false(report->inside_out);
    assert_int_equal(report->n_components, 1);
    assert_int_equal(report->n_duplicate, 0);
    const double low[3] = {fmin(from.x, to.x), fmin(from.y, to.y), fmin(from.z, to.z)};
    const double high[3] = {fmax(from.x, to.x), fmax(from.y, to.y), fmax(from.z, to.z)};
    const double bounds[6] = {report->bounds.min.x, report->bounds.min.y, report->bounds.min.z,
                              report->bounds.max.x, report->bounds.max.y, report->bounds.max.z};
    for (int axis = 0; axis < 3; axis++) {
        assert_near(bounds[axis], (double)(float)low[axis], 0);
        assert_near(bounds[axis + 3], (double)(float)high[axis], 0);
    }
    return mesh;
}

static void test_plain(void **state)
{
    (void)state;
    MeshReport report;
    Mesh *mesh = make(vec3(1, 5, 2), vec3(-1, 2, 6), 0, 0, &report);
    assert_int_equal(mesh->n_vertices, 8);
    assert_int_equal(mesh->n_triangles, 12);
    assert_null(mesh->normals);
    assert_near(report.volume, 24, 1e-12);
    assert_near(report.area, 2 * (6 + 8 + 12), 1e-12);
    mesh_free(mesh);
}

static void test_chamfer(void **state)
{
    (void)state;
    MeshReport report;
    const double a = 2, b = 3, c = 4, h = 0.25;
    Mesh *mesh = make(vec3(0, 0, 0), vec3(a, b, c), h, 1, &report);
    assert_int_equal(mesh->n_vertices, 24);
    assert_int_equal(mesh->n_triangles, 12 + 24 + 8);
    assert_null(mesh->normals);
    /* the inner box, its six slabs, twelve triangular prisms, eight tetrahedra */
    double ia = a - 2 * h, ib = b - 2 * h, ic = c - 2 * h;
    assert_near(report.volume,
                ia * ib * ic + 2 * h * (ia * ib + ib * ic + ic * ia) + 2 * h * h * (ia + ib + ic) + 8 * h * h * h / 6,
                1e-12);
    mesh_free(mesh);
}

static void test_rounded(void **state)
{
    (void)state;
    const double a = 2, b = 3, c = 4, r = 0.25;
    double ia = a - 2 * r, ib = b - 2 * r, ic = c - 2 * r;
    double volume =
        ia * ib * ic + 2 * r * (ia * ib + ib * ic + ic * ia) + pi * r * r * (ia + ib + ic) + 4 * pi / 3 * r * r * r;
    double area = 2 * (ia * ib + ib * ic + ic * ia) + 2 * pi * r * (ia + ib + ic) + 4 * pi * r * r;
    double error_before = HUGE_VAL;
    for (unsigned segments = 2; segments <= 32; segments *= 2) {
        MeshReport report;
        Mesh *mesh = make(vec3(0, 0, 0), vec3(a, b, c), r, segments, &report);
        assert_int_equal(mesh->n_triangles, 12 + 24 * segments + 8 * segments * segments);
        assert_int_equal(mesh->n_vertices, mesh->n_triangles / 2 + 2); /* welded whole: Euler */
        double off = volume - report.volume;
        assert_true(off > 0 && off < error_before / 3); /* second order */
        error_before = off;
        if (segments == 32) assert_near(report.area, area, 1e-3 * area);
        mesh_free(mesh);
    }
}

static void test_faces_stay_flat(void **state)
{
    (void)state;
    MeshReport report;
    Mesh *mesh = make(vec3(-1, -2, -3), vec3(1, 2, 3), 0.5, 6, &report);
    int n_flat = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3f n = mesh->normals[t[0]];
        if (memcmp(&n, &mesh->normals[t[1]], sizeof n) == 0 && memcmp(&n, &mesh->normals[t[2]], sizeof n) == 0) {
            assert_near((double)(fabsf(n.x) + fabsf(n.y) + fabsf(n.z)), 1, 0);
            n_flat++;
        }
    }
    assert_int_equal(n_flat, 12);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) { /* normals point from the inner box to the surface */
        Vec3 p = vec3_from_f(mesh->positions[i]), n = vec3_from_f(mesh->normals[i]);
        assert_near(vec3_length(n), 1, 1e-6);
        Vec3 inner = vec3_along(p, -0.5, n);
        assert_near(fabs(inner.x), 0.5, 1e-6);
        assert_near(fabs(inner.y), 1.5, 1e-6);
        assert_near(fabs(inner.z), 2.5, 1e-6);
    }
    mesh_free(mesh);
}

static void test_bevels_at_their_limits(void **state)
{
    (void)state;
    MeshReport report;
    /* half of all sides: a ball; half of one: a rounded slab; in numbers that float rounds */
    mesh_free(make(vec3(-1, -1, -1), vec3(1, 1, 1), 1, 16, &report));
    assert_near(report.volume, 4 * pi / 3, 0.03);
    mesh_free(make(vec3(0.3, 0, 0), vec3(1.4, 2, 3), 0.55, 7, &report));
    mesh_free(make(vec3(0.1, 0.2, 0.3), vec3(0.4, 0.5, 0.6), 0.15, 3, &report));
    /* too small for float at this place: the rounds vanish, the box stays closed */
    mesh_free(make(vec3(1000.1, 0.1, 7), vec3(1001.3, 0.2, 9), 1e-5, 5, &report));
    mesh_free(make(vec3(1e6, 1e6, 1e6), vec3(1e6 + 1, 1e6 + 1, 1e6 + 1), 1e-9, 4, &report));
    assert_near(report.volume, 1, 1e-9);
    mesh_free(make(vec3(0, 0, 0), vec3(1e-20, 1e-20, 1e-20), 1e-21, 4, &report));
}

static void test_refusals(void **state)
{
    (void)state;
    Mesh *mesh = NULL;
    Error error;
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 0, 1), 0, 0, &mesh, &error), STATUS_SCENE);
    assert_non_null(strstr(error.text, "no extent in y"));
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 1, 1), 0.51, 3, &mesh, &error), STATUS_SCENE);
    assert_non_null(strstr(error.text, "0.51"));
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 1, 1), -0.1, 3, &mesh, &error), STATUS_SCENE);
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 1, 1), 0.1, 0, &mesh, &error), STATUS_SCENE);
    assert_int_equal(mesh_make_box(vec3(0, 0, 0), vec3(1, 1, 1), 0.1, 257, &mesh, &error), STATUS_SCENE);
    assert_int_equal(mesh_make_box(vec3(0, 0, (double)NAN), vec3(1, 1, 1), 0, 0, &mesh, &error), STATUS_SCENE);
    assert_null(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain),
        cmocka_unit_test(test_chamfer),
        cmocka_unit_test(test_rounded),
        cmocka_unit_test(test_faces_stay_flat),
        cmocka_unit_test(test_bevels_at_their_limits),
        cmocka_unit_test(test_refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
