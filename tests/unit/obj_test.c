/* obj_test.c - OBJ files as writers make them, and as nobody should.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "mesh/face.h"
#include "mesh_reader.h"
#include "near.h"

static const char cube[] = "# a cube\nmtllib none.mtl\no cube\n"
                           "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1 1.0\nv 1 0 1\nv 1 1 1\nv 0 1 1 .5 .5 .5\n"
                           "g sides\nusemtl none\ns off\n"
                           "f 4 3 2 1\nf 5 6 7 8\nf -8 -7 -3 -4\nf 2 3 7 6\nf 3 4 8 7 # the back\nf 4 1 5 8\n";

static void test_cube(void **state)
{
    (void)state;
    Mesh *mesh = load(cube);
    assert_int_equal(mesh->n_vertices, 8);
    assert_int_equal(mesh->n_triangles, 12);
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed);
    assert_near(report.volume, 1, 1e-12);
    mesh_free(mesh);
}

static void test_corners_of_all_kinds(void **state)
{
    (void)state;
    Mesh *mesh =
        load("v 0 0 0\r\nv 2 0 0\r\n\tv 0 2 0\r\nv 0 0 2\r\n"
             "vt .5\r\nvt 1 0.25 0\r\nvn 0 0 3\r\nvn 0 4 3\r\n"
             "f 1/1/1 2/2/1 \\\r\n 3/-1/1\r\nf 1//2 3//2 4//2\r\nf 1 2 3\r\nf 1/1 3/2 4/2\r\nf 1/1/1 2/2/1 3/2/1");
    assert_int_equal(mesh->n_triangles, 5);
    assert_int_equal(mesh->n_vertices, 3 + 3 + 3 + 3); /* the last face's corners are the first's */
    assert_memory_equal(mesh->triangles[4], mesh->triangles[0], sizeof mesh->triangles[0]);
    const uint32_t *t = mesh->triangles[0];
    assert_near((double)mesh->uvs[2 * t[0]], 0.5, 0);
    assert_near((double)mesh->uvs[2 * t[1] + 1], 0.25, 0);
    assert_near((double)mesh->normals[t[0]].z, 1, 0);
    t = mesh->triangles[1];
    assert_near((double)mesh->normals[t[2]].y, 0.8, 1e-7);
    assert_near((double)mesh->positions[t[2]].z, 2, 0);
    t = mesh->triangles[2]; /* corners without a normal get the face's */
    assert_near((double)mesh->normals[t[0]].z, 1, 0);
    mesh_free(mesh);
}

/* Twice the area of a triangle, seen from +z. */
static double area_of(const Mesh *mesh, uint32_t triangle)
{
    const uint32_t *t = mesh->triangles[triangle];
    Vec3 a = vec3_from_f(mesh->positions[t[0]]), b = vec3_from_f(mesh->positions[t[1]]);
    return vec3_cross(vec3_sub(b, a), vec3_sub(vec3_from_f(mesh->positions[t[2]]), a)).z;
}

/* Triangles that cover a polygon and nothing else: as large together, and none turned over. Whichever corner is the first, whether
 * positions are before or behind the face. */
static void test_hollows(void **state)
{
    (void)state;
    static const struct {
        uint32_t n;
        double twice_area;
        float at[12][2];
    } outlines[] = {
        {4, 2, {{0, 0}, {2, 1}, {0, 2}, {1, 1}}},
        {5, 4.6, {{0, 0}, {2, 0}, {2, 2}, {1, .3F}, {0, 2}}},
        {7, 10, {{0, 0}, {1, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}},
        {8, 4.8, {{0, 2}, {-.3F, .3F}, {-2, 0}, {-.3F, -.3F}, {0, -2}, {.3F, -.3F}, {2, 0}, {.3F, .3F}}},
        /* a square with a hole, which a line leads to */
        {10, 24, {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}},
    };
    for (size_t i = 0; i < COUNT_OF(outlines); i++)
        for (uint32_t first = 0; first < 2 * outlines[i].n; first++) {
            char text[1000], face[100] = "f", *end = text;
            uint32_t n = outlines[i].n;
            for (uint32_t k = 0; k < n; k++) {
                const float *at = outlines[i].at[k];
                end += sprintf(end, "v %.9g %.9g %.9g\n", (double)at[0], (double)at[1], .1 * (double)at[0]);
                sprintf(face + strlen(face), " %u", (first + k) % n + 1);
            }
            bool ahead = first >= n;
            memmove(text + (ahead ? strlen(face) + 1 : 0), text, strlen(text) + 1);
            if (ahead) {
                memcpy(text, face, strlen(face));
                text[strlen(face)] = '\n';
            } else {
                strcat(text, face);
            }
            Mesh *mesh = load(text);
            assert_int_equal(mesh->n_triangles, n - 2);
            double sum = 0, least = 1;
            for (uint32_t k = 0; k < n - 2; k++) {
                sum += area_of(mesh, k);
                least = double_min(least, area_of(mesh, k));
            }
            if (fabs(sum - outlines[i].twice_area) > 1e-5 || least < 0)
                fail_msg("outline %zu from corner %u: area %g, least %g", i, first, sum, least);
            mesh_free(mesh);
        }
}

static void test_cuts_are_kept(void **state)
{
    (void)state;
    static const char *const forms[] = {"v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 0\n", "v 0 0 0\nv 2 1 0\nv 0 2 0\nv -1 1 0\n",
                                        "v 0 0 0\nv 2 1 0\nv 0 2 0\nv 1 1 1\nf 1 2 4\n"};
    Mesh *meshes[3];
    for (int i = 0; i < 3; i++) {
        char text[200];
        snprintf(text, sizeof text, "%sf 1 2 3%s\nf 1 2 3\n", forms[i], i < 2 ? " 4" : "");
        meshes[i] = load(text);
        assert_int_equal(meshes[i]->n_triangles, 3);
    }
    assert_false(mesh_same_triangles(meshes[0], meshes[1]));
    mesh_keep_cuts(meshes[0], meshes[2]);
    assert_false(mesh_same_triangles(meshes[0], meshes[2]));
    mesh_keep_cuts(meshes[1], meshes[0]);
    assert_true(mesh_same_triangles(meshes[0], meshes[1]));
    for (int i = 0; i < 3; i++) mesh_free(meshes[i]);
}

static void test_fans(void **state)
{
    (void)state;
    Mesh *mesh = load("v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nv 0 .5 0\nf 2 3 4 5 6 1\nf 1 2 3 \\\n4 5\n"
                      "f 2 2 2 2\n");
    const uint32_t expected[][3] = {{1, 2, 3}, {1, 3, 4}, {1, 4, 5}, {1, 5, 0}, {0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
    assert_true(mesh->n_triangles >= COUNT_OF(expected));
    assert_memory_equal(mesh->triangles, expected, sizeof expected);
    mesh_free(mesh);
}

static void test_numbers_ahead(void **state)
{
    (void)state;
    Mesh *mesh = load("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n");
    assert_int_equal(mesh->n_vertices, 3);
    mesh_free(mesh);
}

static void test_mark_of_utf8(void **state)
{
    (void)state;
    Mesh *mesh = load("\xef\xbb\xbfv 0 0 7\nv 1 0 7\nv 0 1 7\nf 1 2 3\n");
    assert_int_equal(mesh->n_vertices, 3);
    assert_near((double)mesh->positions[0].z, 7, 0);
    mesh_free(mesh);
    refuse("\xef\xbb\xbf", "has no faces");
    refuse("\xef\xbb", "has no faces");
}

static void test_lines_of_other_systems(void **state)
{
    (void)state;
    static const char *const texts[] = {"v 0 0 7\rv 1 0 7\rv 0 1 7\rf 1 2 3",
                                        "v 0 0 7\r\nv 1 0 7\r\nv 0 1 7\r\nf 1 2 3\r\n"};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        Mesh *mesh = load(texts[i]);
        assert_int_equal(mesh->n_vertices, 3);
        assert_int_equal(mesh->n_triangles, 1);
        assert_near((double)mesh->positions[2].z, 7, 0);
        mesh_free(mesh);
    }
    refuse("v 0 0 7\rv 1 0\rf 1 2 3\r", ":2: ");
}

static void test_refusals(void **state)
{
    (void)state;
    refuse("", "has no faces");
    refuse("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "has no faces");
    refuse("v 0 0\n", ":1: the line ends where a number");
    refuse("\nv 0 0 x\n", ":2: 'x' stands where a number");
    refuse("v 0 0 1e99\n", ":1: the number");
    refuse("v 0 nan 0\n", "'nan'");
    refuse("v 0 0 0\nf 1 1\n", ":2: a face has 2 corners");
    refuse("v 0 0 0\nf\nf 1 1 1\nf \n", ":4: a face has 0 corners");
    refuse("v 0 0 0\nf 1 1 0\n", ":2: '0' stands where");
    refuse("v 0 0 0\nf 1 1 a\n", ":2: 'a' stands where");
    refuse("v 0 0 0\nf 1 1 1/\n", ":2:");
    refuse("v 0 0 0\nf 1 1 1x\n", ":2: 'x' stands where");
    refuse("v 0 0 0\nf 1 1 -2\n", ":2: the vertex number -2 is out of range");
    refuse("v 0 0 0\nf 1 1 99999999999999999999999999999\n",
           ":2: the vertex number 99999999999999999999 is out of range");
    refuse("v 0 0 0\n\nf 1 1 2\n", ":3: a face uses position 2; there are 1");
    refuse("v 0 0 0\nf 1/1 1/1 1/1\n", ":2: a face uses texture coordinate 1; there are 0");
    refuse("v 0 0 0\nf 1//1 1//1 1//7\nvn 0 0 1\n", ":2: a face uses normal 7; there are 1");
}

static void test_noise(void **state)
{
    (void)state;
    spoil(cube, sizeof cube - 1, 2000);
}

static void test_parts(void **state)
{
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no the left one \r\nv 5 0 0\nf 1 2 4\n"
                               "usemtl red\nf 2 3 4\no right\nf 1 3 4\nusemtl blue\ng empty\ng right\nf 4 3 2\n";
    Mesh *mesh = load(text);
    assert_int_equal(mesh->n_triangles, 5);
    mesh_free(mesh);
    static const struct {
        const char *part;
        uint32_t n;
    } cases[] = {{"the left one", 2}, {"red", 2}, {"right", 2}, {"blue", 1}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        mesh = load_part(cases[i].part);
        assert_int_equal(mesh->n_triangles, cases[i].n);
        mesh_free(mesh);
    }
    refuse_part("empty", "the group 'empty' has no faces");
    refuse_part("rigth", "did you mean 'right'?");
    refuse_part("green",
                "object 'the left one', material 'red', object 'right', material 'blue', group 'empty', group 'right'");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cube),
        cmocka_unit_test(test_corners_of_all_kinds),
        cmocka_unit_test(test_numbers_ahead),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_parts),
        cmocka_unit_test(test_hollows),
        cmocka_unit_test(test_fans),
        cmocka_unit_test(test_cuts_are_kept),
        cmocka_unit_test(test_mark_of_utf8),
        cmocka_unit_test(test_lines_of_other_systems),
    };
    mesh_name = "mesh.obj";
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
