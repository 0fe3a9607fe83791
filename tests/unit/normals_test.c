/* normals_test.c - normals that are made from the triangles around a vertex.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "icosphere.h"
#include "near.h"

static const double degree = 3.14159265358979323846 / 180;

static Mesh *bare_sphere(unsigned subdivisions)
{
    Mesh *mesh = icosphere(1, subdivisions);
    assert_non_null(mesh);
    free(mesh->normals);
    mesh->normals = NULL;
    return mesh;
}

static Mesh *plain_box(void)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_make_box(vec3(-1, -2, -3), vec3(1, 2, 3), 0, 1, &mesh, NULL), STATUS_OK);
    free(mesh->normals);
    mesh->normals = NULL;
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 8);
    return mesh;
}

static void spheres_get_their_own(void **state)
{
    (void)state;
    Mesh *mesh = bare_sphere(4);
    uint32_t n = mesh->n_vertices;
    double worst = 0;
    assert_int_equal(mesh_make_normals(mesh, NULL, 30 * degree, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, n);
    for (uint32_t v = 0; v < n; v++)
        worst = fmax(worst, vec3_length(vec3_sub(vec3_from_f(mesh->normals[v]), vec3_from_f(mesh->positions[v]))));
    print_message("normals of a sphere of 5,120 triangles: %.2g off\n", worst);
    assert_true(worst < 4e-3);
    mesh_free(mesh);
}

/* The faces of a box turn by 90 degrees: vertices are split, or, beyond that, the three at a corner count alike, however each
 * is cut into triangles. */
static void edges_are_kept_that_turn_by_more(void **state)
{
    (void)state;
    Mesh *mesh = plain_box();
    assert_int_equal(mesh_make_normals(mesh, NULL, 89 * degree, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 24);
    for (uint32_t v = 0; v < 24; v++) {
        Vec3f n = mesh->normals[v], p = mesh->positions[v];
        assert_near((double)fabsf(n.x) + (double)fabsf(n.y) + (double)fabsf(n.z), 1, 1e-6);
        assert_true(vec3f_dot(n, p) > 0.9F);
    }
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed);
    mesh_free(mesh);
    mesh = plain_box();
    assert_int_equal(mesh_make_normals(mesh, NULL, 91 * degree, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 8);
    for (uint32_t v = 0; v < 8; v++) {
        assert_near((double)fabsf(mesh->normals[v].x), sqrt(1. / 3), 1e-6);
        assert_near((double)fabsf(mesh->normals[v].y), sqrt(1. / 3), 1e-6);
    }
    mesh_free(mesh);
}

/* Of a tube with flat ends: round the side, sharp where the ends begin. */
static void tubes_are_round_and_have_ends(void **state)
{
    (void)state;
    enum { SIDES = 24 };
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(2 * SIDES + 2, 4 * SIDES, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i < SIDES; i++) {
        uint32_t next = (i + 1) % SIDES, *t = mesh->triangles[4 * i];
        double angle = 360 * degree * i / SIDES;
        mesh->positions[i] = vec3f_from(vec3(cos(angle), 0, -sin(angle)));
        mesh->positions[SIDES + i] = vec3f_from(vec3(cos(angle), 5, -sin(angle)));
        const uint32_t faces[12] = {i,         next, SIDES + i, next,          SIDES + next, SIDES + i,
                                    2 * SIDES, next, i,         2 * SIDES + 1, SIDES + i,    SIDES + next};
        for (int k = 0; k < 12; k++) t[k] = faces[k];
    }
    mesh->positions[2 * SIDES] = vec3f(0, 0, 0);
    mesh->positions[2 * SIDES + 1] = vec3f(0, 5, 0);
    assert_int_equal(mesh_make_normals(mesh, NULL, 40 * degree, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 4 * SIDES + 2);
    for (uint32_t v = 0; v < mesh->n_vertices; v++) {
        Vec3f n = mesh->normals[v], p = mesh->positions[v];
        if (fabsf(n.y) > 0.5F)
            assert_near((double)n.y, p.y > 1 ? 1 : -1, 1e-6);
        else
            assert_near((double)(n.x * p.x + n.z * p.z), 1, 1e-5);
    }
    mesh_free(mesh);
}

/* A later shape of the same triangles is split as the first is, even where it has become flat. */
static void what_it_becomes_is_split_alike(void **state)
{
    (void)state;
    Mesh *mesh = plain_box(), *end = plain_box();
    for (uint32_t v = 0; v < end->n_vertices; v++) end->positions[v].y *= 1e-3F;
    assert_int_equal(mesh_make_normals(mesh, end, 40 * degree, NULL, NULL), STATUS_OK);
    assert_true(mesh_same_triangles(mesh, end));
    for (uint32_t v = 0; v < end->n_vertices; v++)
        assert_near((double)vec3f_dot(mesh->normals[v], end->normals[v]), 1, 1e-6);
    mesh_free(mesh);
    mesh_free(end);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_get_their_own),
        cmocka_unit_test(edges_are_kept_that_turn_by_more),
        cmocka_unit_test(tubes_are_round_and_have_ends),
        cmocka_unit_test(what_it_becomes_is_split_alike),
    };
    return cmocka_run_group_tests_name("normals", tests, NULL, NULL);
}
