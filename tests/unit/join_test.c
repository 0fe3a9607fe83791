/* join_test.c - meshes that are open by the last bits, and close.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <string.h>

#include "dice.h"
#include "icosphere.h"

static const double pi = 3.14159265358979323846;

/* Every triangle has vertices of its own, each of them off by up to `jitter`. */
static Mesh *torn_sphere(unsigned subdivisions, double jitter)
{
    Mesh *whole = icosphere(1, subdivisions), *torn = NULL;
    assert_non_null(whole);
    assert_int_equal(mesh_new(3 * whole->n_triangles, whole->n_triangles, false, false, &torn, NULL), STATUS_OK);
    Dice dice = {1};
    for (uint32_t i = 0; i < 3 * whole->n_triangles; i++) {
        Vec3 at = vec3_from_f(whole->positions[whole->triangles[i / 3][i % 3]]);
        torn->positions[i] = vec3f_from(vec3_add(at, dice_point(&dice, jitter)));
        torn->triangles[i / 3][i % 3] = i;
    }
    mesh_free(whole);
    assert_int_equal(mesh_weld(torn, NULL, NULL), STATUS_OK);
    return torn;
}

/* As programs make them: by angles, with the first column again as the last one, and poles that are the ends of all columns. */
static Mesh *seam_sphere(uint32_t columns, uint32_t rows, bool with_cap)
{
    Mesh *mesh = NULL;
    uint32_t n = 0;
    assert_int_equal(mesh_new((columns + 1) * (rows + 1), 2 * columns * rows, true, true, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i <= rows; i++)
        for (uint32_t k = 0; k <= columns; k++) {
            uint32_t at = i * (columns + 1) + k;
            double u = (double)k / columns, v = (double)i / rows;
            Vec3 p = vec3(-cos(2 * pi * u) * sin(pi * v), cos(pi * v), sin(2 * pi * u) * sin(pi * v));
            mesh->positions[at] = mesh->normals[at] = vec3f_from(p);
            mesh->uvs[2 * at] = (float)u;
            mesh->uvs[2 * at + 1] = (float)(1 - v);
            if (i == rows || k == columns || (i == 0 && !with_cap)) continue;
            uint32_t a = at + 1, b = at, c = at + columns + 1, d = c + 1;
            const uint32_t faces[2][3] = {{a, b, d}, {b, c, d}};
            for (int f = 0; f < 2; f++)
                if (f ? i != rows - 1 : i != 0) memcpy(mesh->triangles[n++], faces[f], sizeof faces[f]);
        }
    mesh->n_triangles = n;
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    return mesh;
}

static MeshReport inspect(const Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    return report;
}

static void jittered_spheres_close(void **state)
{
    (void)state;
    const unsigned subdivisions[] = {0, 2, 5};
    for (size_t i = 0; i < COUNT_OF(subdivisions); i++) {
        MeshJoin join;
        Mesh *mesh = torn_sphere(subdivisions[i], 1e-7);
        uint32_t n = mesh->n_triangles;
        assert_false(inspect(mesh).closed);
        assert_int_equal(mesh_join(mesh, NULL, -1, NULL, &join, NULL), STATUS_OK);
        MeshReport report = inspect(mesh);
        assert_true(report.closed);
        assert_int_equal(report.n_components, 1);
        assert_int_equal(report.n_degenerate + report.n_non_manifold_edges, 0);
        assert_true(join.farthest > 0 && join.farthest < 5e-7);
        assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
        assert_int_equal(mesh->n_triangles, n);
        assert_int_equal(mesh->n_vertices, n / 2 + 2);
        mesh_free(mesh);
    }
}

static void seams_close_and_keep_their_coordinates(void **state)
{
    (void)state;
    MeshJoin join;
    Mesh *mesh = seam_sphere(32, 16, true);
    uint32_t n = mesh->n_vertices;
    assert_int_equal(inspect(mesh).n_open_edges, 94);
    assert_int_equal(mesh_join(mesh, NULL, -1, NULL, &join, NULL), STATUS_OK);
    assert_true(join.n_joined > 0 && join.farthest < 1e-6);
    MeshReport report = inspect(mesh);
    assert_true(report.closed && report.volume > 0);
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, n);
    bool first = false, last = false; /* on the seam both are there */
    for (uint32_t v = 0; v < n; v++) {
        if (fabsf(mesh->positions[v].z) > 0 || mesh->positions[v].x > -0.5F) continue;
        first |= mesh->uvs[2 * v] == 0;
        last |= mesh->uvs[2 * v] == 1;
    }
    assert_true(first && last);
    mesh_free(mesh);
}

static void expect_untouched(Mesh *mesh, double within)
{
    MeshJoin join;
    size_t bytes = mesh->n_vertices * sizeof *mesh->positions;
    Vec3f *before = malloc(bytes);
    assert_non_null(before);
    memcpy(before, mesh->positions, bytes);
    assert_int_equal(mesh_join(mesh, NULL, within, NULL, &join, NULL), STATUS_OK);
    assert_int_equal(join.n_joined, 0);
    assert_memory_equal(before, mesh->positions, bytes);
    free(before);
    mesh_free(mesh);
}

static void what_is_closed_or_has_a_hole_stays(void **state)
{
    (void)state;
    expect_untouched(icosphere(1, 3), 0.01);
    expect_untouched(seam_sphere(32, 16, false), -1);
    Mesh *holed = torn_sphere(3, 1e-7);
    holed->n_triangles--;
    expect_untouched(holed, -1);
    expect_untouched(torn_sphere(3, 1e-7), 0);
    expect_untouched(torn_sphere(3, 1e-4), -1);
    expect_untouched(torn_sphere(5, 0.03), 0.2); /* as far apart as vertices of one triangle */
    Mesh *lost = torn_sphere(0, 1e-7);
    lost->positions[3].x = HUGE_VALF;
    expect_untouched(lost, -1);
}

static void the_distance_that_closes_is_found(void **state)
{
    (void)state;
    const double jitters[] = {1e-5, 1e-4, 2e-3};
    for (size_t i = 0; i < COUNT_OF(jitters); i++) {
        MeshJoin found, join;
        double within;
        Mesh *mesh = torn_sphere(3, jitters[i]);
        uint32_t n_open = inspect(mesh).n_open_edges;
        assert_int_equal(mesh_find_join(mesh, 0.02, NULL, &found, &within, NULL), STATUS_OK);
        assert_true(found.n_joined > 0 && found.farthest <= within && found.farthest < 4 * jitters[i]);
        assert_int_equal(inspect(mesh).n_open_edges, n_open);
        assert_int_equal(mesh_join(mesh, NULL, found.farthest, NULL, &join, NULL), STATUS_OK);
        assert_true(join.n_joined == found.n_joined && inspect(mesh).closed);
        mesh_free(mesh);
    }
    MeshJoin found;
    double within;
    Mesh *holed = seam_sphere(32, 16, false);
    assert_int_equal(mesh_find_join(holed, 0.02, NULL, &found, &within, NULL), STATUS_OK);
    assert_int_equal(found.n_joined, 0);
    mesh_free(holed);
}

/* A sphere about the middle, its upper pole one place, its lower one a circle of that radius. */
static Mesh *poled_sphere(uint32_t columns, double pole)
{
    enum { ROWS = 12 };
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(columns * (ROWS + 1), 2 * columns * ROWS, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i <= ROWS; i++)
        for (uint32_t k = 0; k < columns; k++) {
            double r = i == 0 ? 0 : i == ROWS ? pole : sin(pi * i / ROWS), turn = 2 * pi * k / columns;
            mesh->positions[i * columns + k] = vec3f_from(vec3(r * cos(turn), cos(pi * i / ROWS), -r * sin(turn)));
            if (i == ROWS) continue;
            uint32_t a = i * columns + k, b = a + columns, d = i * columns + (k + 1) % columns, c = d + columns;
            const uint32_t faces[2][3] = {{a, b, c}, {a, c, d}};
            memcpy(mesh->triangles[2 * a], faces, sizeof faces);
        }
    return mesh;
}

/* sin(pi) is 1.2e-16 in doubles and -8.7e-8 in floats. */
static void poles_that_are_rounded_become_places(void **state)
{
    (void)state;
    const double poles[] = {1.2246e-16, -8.7423e-8}, within[] = {-1, 1e-3};
    const uint32_t columns[] = {3, 32, 1000};
    for (size_t i = 0; i < 12; i++) {
        MeshJoin join;
        uint32_t n = columns[i / 4];
        Mesh *mesh = poled_sphere(n, poles[i % 2]);
        MeshReport report = inspect(mesh);
        assert_int_equal(report.n_open_edges, n);
        assert_int_equal(mesh_join(mesh, NULL, within[i / 2 % 2], NULL, &join, NULL), STATUS_OK);
        report = inspect(mesh);
        assert_true(report.closed && join.n_joined == n - 1 && join.farthest < 2e-7);
        assert_int_equal(report.n_degenerate, 2 * n); /* of both poles; the rest is as it was */
        assert_int_equal(report.n_components, 1);
        assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
        assert_int_equal(mesh->n_vertices, 11 * n + 2);
        mesh_free(mesh);
    }
}

static void small_holes_that_are_no_rounding_stay(void **state)
{
    (void)state;
    MeshJoin join;
    expect_untouched(poled_sphere(32, 1e-4), -1);  /* edges that were drawn */
    expect_untouched(poled_sphere(400, 5e-6), -1); /* edges of rounding that add up */
    Mesh *holed = poled_sphere(32, 1.2246e-16);
    memset(holed->triangles[200], 0, sizeof holed->triangles[200]);
    expect_untouched(holed, -1);
    expect_untouched(poled_sphere(32, 1.2246e-16), 0);
    Mesh *mesh = poled_sphere(32, 1.2246e-16), *opens = poled_sphere(32, 0.1);
    assert_int_equal(mesh_join(mesh, opens, -1, NULL, &join, NULL), STATUS_OK);
    assert_int_equal(join.n_joined, 0);
    mesh_free(mesh);
    mesh_free(opens);
}

static void what_closes_a_rounded_pole_is_found(void **state)
{
    (void)state;
    MeshJoin found, join;
    double within;
    Mesh *mesh = poled_sphere(32, 1.2246e-16);
    assert_int_equal(mesh_find_join(mesh, 0.02, NULL, &found, &within, NULL), STATUS_OK);
    assert_int_equal(found.n_joined, 31);
    assert_int_equal(inspect(mesh).n_open_edges, 32);
    assert_int_equal(mesh_join(mesh, NULL, found.farthest, NULL, &join, NULL), STATUS_OK);
    assert_true(join.n_joined == 31 && inspect(mesh).closed);
    mesh_free(mesh);
}

/* What moves: both ends are joined alike. */
static void the_end_goes_along(void **state)
{
    (void)state;
    MeshJoin join;
    Mesh *mesh = torn_sphere(2, 1e-7), *end = torn_sphere(2, 1e-7);
    for (uint32_t v = 0; v < end->n_vertices; v++) end->positions[v].y += 1;
    assert_true(mesh_same_triangles(mesh, end));
    assert_int_equal(mesh_join(mesh, end, -1, NULL, &join, NULL), STATUS_OK);
    assert_true(join.n_joined > 0 && inspect(mesh).closed && inspect(end).closed);
    mesh_free(mesh);
    mesh_free(end);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(jittered_spheres_close),
        cmocka_unit_test(seams_close_and_keep_their_coordinates),
        cmocka_unit_test(what_is_closed_or_has_a_hole_stays),
        cmocka_unit_test(the_distance_that_closes_is_found),
        cmocka_unit_test(poles_that_are_rounded_become_places),
        cmocka_unit_test(small_holes_that_are_no_rounding_stay),
        cmocka_unit_test(what_closes_a_rounded_pole_is_found),
        cmocka_unit_test(the_end_goes_along),
    };
    return cmocka_run_group_tests_name("join", tests, NULL, NULL);
}
