/* mesh_test.c - storage, copies, welding, transformation of meshes, and the choice of a reader.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "mesh/mesh_file.h"

static Mesh *made_box(Vec3 from, Vec3 to, double bevel, unsigned segments)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_make_box(from, to, bevel, segments, &mesh, NULL), STATUS_OK);
    return mesh;
}

static void test_new(void **state)
{
    (void)state;
    mesh_free(NULL);
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(0, 0, true, true, &mesh, NULL), STATUS_OK);
    mesh_free(mesh);
    assert_int_equal(mesh_new(3, 1, false, true, &mesh, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 3);
    assert_int_equal(mesh->n_triangles, 1);
    assert_null(mesh->normals);
    assert_near((double)mesh->uvs[5], 0, 0);
    mesh_free(mesh);
}

static void test_weld(void **state)
{
    (void)state;
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(6, 2, true, true, &mesh, NULL), STATUS_OK);
    /* two triangles with vertices of their own: two are equal in all, one of them with -0 for 0; one pair
     * differs in its normal, one in its texture coordinate */
    const float x[6] = {0, 1, 0, 1, -0.0F, 5};
    const float y[6] = {0, 0, 1, 0, 1, 5};
    for (uint32_t i = 0; i < 6; i++) {
        mesh->positions[i] = vec3f(x[i], y[i], 0);
        mesh->normals[i] = vec3f(0, 0, 1);
        mesh->triangles[i / 3][i % 3] = i;
    }
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 4);
    const uint32_t expected[2][3] = {{0, 1, 2}, {1, 2, 3}};
    assert_memory_equal(mesh->triangles, expected, sizeof expected);
    assert_near((double)mesh->positions[3].x, 5, 0);
    mesh->positions[3] = mesh->positions[2];
    mesh->normals[3] = vec3f(0, 1, 0);
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 4);
    mesh->normals[3] = mesh->normals[2];
    mesh->uvs[6] = 0.25F;
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 4);
    mesh->uvs[6] = 0;
    assert_int_equal(mesh_weld(mesh, NULL, NULL), STATUS_OK);
    assert_int_equal(mesh->n_vertices, 3);
    mesh_free(mesh);
}

static void test_transform(void **state)
{
    (void)state;
    Mesh *mesh = made_box(vec3(-1, -1, -1), vec3(1, 1, 1), 0.5, 4);
    double volume = mesh_volume(mesh);
    /* stretches, shears, mirrors and moves */
    Affine map = {{{2, 0.5, 0}, {0, -3, 0}, {0, 1, 0.25}}, {10, 20, 30}};
    mesh_transform(mesh, &map);
    assert_near(mesh_volume(mesh), volume * 1.5, 1e-5);
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed);
    assert_near(report.bounds.min.y, 17, 1e-5);
    /* normals stay unit and outward */
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 a = vec3_from_f(mesh->positions[t[0]]);
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(vec3_from_f(mesh->positions[t[1]]), a),
                                                vec3_sub(vec3_from_f(mesh->positions[t[2]]), a)));
        for (int k = 0; k < 3; k++) {
            Vec3 n = vec3_from_f(mesh->normals[t[k]]);
            assert_near(vec3_length(n), 1, 1e-6);
            assert_true(vec3_dot(n, normal) > 0);
        }
    }
    mesh_free(mesh);
}

static void test_normals_are_made_good(void **state)
{
    (void)state;
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(4, 1, true, false, &mesh, NULL), STATUS_OK);
    mesh->positions[1] = vec3f(1, 0, 0);
    mesh->positions[2] = vec3f(0, 1, 0);
    mesh->normals[0] = vec3f(0, 3, 4);
    for (uint32_t k = 0; k < 3; k++) mesh->triangles[0][k] = k;
    assert_int_equal(mesh_normalize_normals(mesh, NULL), STATUS_OK);
    assert_near((double)mesh->normals[0].z, 0.8, 1e-7);
    assert_near((double)mesh->normals[1].z, 1, 0);             /* had none: the triangle's */
    assert_near((double)vec3f_length(mesh->normals[3]), 1, 0); /* used by nothing */
    mesh_free(mesh);
}

static void test_load_by_extension(void **state)
{
    (void)state;
    Mesh *mesh = NULL;
    Error error;
    assert_int_equal(mesh_load("a/b.xyz", NULL, &mesh, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, ".ply, .obj, .stl, .gltf, .glb and .asc can be read"));
    assert_int_equal(mesh_load("a/b.stp", NULL, &mesh, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "export .glb or .stl"));
    assert_int_equal(mesh_load("noextension", NULL, &mesh, &error), STATUS_INPUT);
    assert_int_equal(mesh_load("there-is-no-such-file.PLY", NULL, &mesh, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "there-is-no-such-file.PLY"));
    assert_int_equal(mesh_load("there-is-no-such-file.obj", NULL, &mesh, &error), STATUS_INPUT);
    assert_null(mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_new),
        cmocka_unit_test(test_weld),
        cmocka_unit_test(test_transform),
        cmocka_unit_test(test_normals_are_made_good),
        cmocka_unit_test(test_load_by_extension),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
