/* ply_test.c - PLY files of all three kinds, as writers make them, and as nobody should.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/buf.h"
#include "icosphere.h"
#include "mesh_reader.h"
#include "near.h"

#define HEAD(format, n_vertices, n_faces)                                                                              \
    "ply\nformat " format " 1.0\nelement vertex " n_vertices                                                           \
    "\nproperty float x\nproperty float y\nproperty float z\nelement face " n_faces                                    \
    "\nproperty list uchar int vertex_indices\nend_header\n"

static void test_text(void **state)
{
    (void)state;
    Mesh *mesh = load(HEAD("ascii", "4", "2") "0 0 0\n1 0 0\n1 1 0\n0 1 -2.5e-1\n3 0 1 2\n4 0 1 2 3\n");
    assert_int_equal(mesh->n_vertices, 4);
    assert_int_equal(mesh->n_triangles, 3);
    assert_near((double)mesh->positions[3].z, -0.25, 0);
    const uint32_t expected[3][3] = {{0, 1, 2}, {0, 1, 2}, {0, 2, 3}};
    assert_memory_equal(mesh->triangles, expected, sizeof expected);
    assert_null(mesh->normals);
    assert_null(mesh->uvs);
    mesh_free(mesh);
}

static void test_text_with_everything(void **state)
{
    (void)state;
    /* lines end as on Windows; comments; unknown elements and properties; normals to be made unit; the
     * older name of the list; faces before vertices; no line end at the end */
    Mesh *mesh = load("ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info nothing\r\n"
                      "element strange 2\r\nproperty list uchar float values\r\nproperty double d\r\n"
                      "element face 1\r\nproperty uchar red\r\nproperty list uint8 uint32 vertex_index\r\n"
                      "property list uchar float texcoord\r\n"
                      "element vertex 3\r\nproperty double z\r\nproperty float64 y\r\nproperty float32 x\r\n"
                      "property uchar red\r\nproperty float nx\r\nproperty float ny\r\nproperty float nz\r\n"
                      "property float s\r\nproperty float t\r\nelement edge 1\r\nproperty int vertex1\r\nend_header\r\n"
                      "3 1 2 3 9\r\n0 8\r\n255 3 2 1 0 6 0 0 0 0 0 0\r\n"
                      "3 2 1 255 0 0 2 0.5 0.25\r\n6 5 4 0 3 0 4 1 1\r\n9 8 7 1 0 1 0 0 0");
    assert_int_equal(mesh->n_triangles, 1);
    assert_int_equal(mesh->triangles[0][0], 2);
    assert_near((double)mesh->positions[1].x, 4, 0);
    assert_near((double)mesh->positions[1].z, 6, 0);
    assert_near((double)mesh->normals[0].z, 1, 0);
    assert_near((double)mesh->normals[1].x, 0.6, 1e-7);
    assert_near((double)mesh->uvs[1], 0.25, 0);
    mesh_free(mesh);
}

static void add_value(Buf *buf, const void *bytes, size_t size, bool big)
{
    const uint16_t one = 1;
    bool machine_is_big = *(const char *)&one == 0;
    const char *at = bytes;
    for (size_t i = 0; i < size; i++) buf_add_bytes(buf, &at[big != machine_is_big ? size - 1 - i : i], 1);
}

static void add_double(Buf *buf, double x, bool big)
{
    add_value(buf, &x, sizeof x, big);
}
static void add_float(Buf *buf, float x, bool big)
{
    add_value(buf, &x, sizeof x, big);
}
static void add_short(Buf *buf, int16_t x, bool big)
{
    add_value(buf, &x, sizeof x, big);
}
static void add_int(Buf *buf, int32_t x, bool big)
{
    add_value(buf, &x, sizeof x, big);
}

/* A tetrahedron with mixed types, elements to pass over, and a face of four corners. */
static void add_binary(Buf *buf, bool big)
{
    buf_format(buf,
               "ply\nformat binary_%s_endian 1.0\nelement odd 3\nproperty short a\nproperty list ushort short b\n"
               "element vertex 4\nproperty short x\nproperty double y\nproperty float z\nproperty list char int more\n"
               "element plain 2\nproperty int q\nproperty char r\n"
               "element face 4\nproperty list int ushort vertex_indices\nproperty float quality\nend_header\n",
               big ? "big" : "little");
    for (int i = 0; i < 3; i++) {
        add_short(buf, -1, big);
        add_short(buf, (int16_t)i, big);
        for (int k = 0; k < i; k++) add_short(buf, 300, big);
    }
    for (int i = 0; i < 4; i++) {
        add_short(buf, i == 1 ? -300 : 0, big);
        add_double(buf, i == 2 ? 0.1 : 0, big);
        add_float(buf, i == 3 ? 7.5F : 0, big);
        buf_add_bytes(buf, i ? "\1" : "\0", 1);
        if (i) add_int(buf, i, big);
    }
    buf_add_bytes(buf, "1234x1234x", 10);
    static const int faces[4][4] = {{3, 0, 1, 2}, {4, 0, 3, 1}, {3, 1, 3, 2}, {3, 0, 2, 3}};
    for (int i = 0; i < 4; i++) {
        add_int(buf, faces[i][0], big);
        for (int k = 1; k <= 3; k++) add_short(buf, (int16_t)faces[i][k], big);
        if (faces[i][0] == 4) add_short(buf, 2, big);
        add_float(buf, 1, big);
    }
}

static void test_binary(void **state)
{
    (void)state;
    for (int big = 0; big < 2; big++) {
        Buf buf = {0};
        add_binary(&buf, big != 0);
        Mesh *mesh = load_bytes(buf.text, buf.length);
        assert_int_equal(mesh->n_vertices, 4);
        assert_int_equal(mesh->n_triangles, 5);
        assert_near((double)mesh->positions[1].x, -300, 0);
        assert_near((double)mesh->positions[2].y, (double)0.1F, 0);
        assert_near((double)mesh->positions[3].z, 7.5, 0);
        const uint32_t second[2][3] = {{0, 3, 1}, {0, 1, 2}};
        assert_memory_equal(mesh->triangles[1], second, sizeof second);
        mesh_free(mesh);
        /* cut off at every byte: an error with a place, never a crash */
        for (size_t length = 0; length < buf.length; length++) refuse_bytes(buf.text, length, "");
        buf_clear(&buf);
    }
}

static void test_noise(void **state)
{
    (void)state;
    Buf buf = {0};
    add_binary(&buf, false);
    spoil(buf.text, buf.length, 2000);
    buf_clear(&buf);
}

static void test_header_refusals(void **state)
{
    (void)state;
    refuse("", "not a PLY");
    refuse("plyx\n", "not a PLY");
    refuse("ply\nformat ascii 1.0\nelement vertex 3\n", "ends inside its PLY header");
    refuse("ply\nelement vertex 3\nend_header\n", "does not say the format");
    refuse("ply\nformat utf8 1.0\n", "'utf8'");
    refuse("ply\nproperty float x\n", "before the first element");
    refuse("ply\nelement vertex -3\n", "'-3'");
    refuse("ply\nelement vertex 3x\n", "'3x'");
    refuse("ply\nelement vertex 99999999999999999999999\n", "'vertex'");
    refuse("ply\nelement vertex 5000000000\n", "4294967294");
    refuse("ply\nelement vertex 3\nproperty quad x\n", "unknown type 'quad'");
    refuse("ply\nelement face 3\nproperty list float int vertex_indices\n", "unknown type 'float int'");
    refuse("ply\nelement face 3\nproperty list uchar float vertex_indices\n", "of type 'float'");
    refuse("ply\nelement vertex 3\nproperty float x\nproperty float x\n", "two properties that mean 'x'");
    refuse("ply\nelement vertex 3\nelement vertex 4\n", "'vertex' twice");
    refuse("ply\nformat ascii 1.0\nnonsense\n", "':3: unknown word 'nonsense'");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face 1\n"
           "property list uchar int vertex_indices\nend_header\n0 0\n3 0 0 0\n",
           "lack one of x, y and z");
    refuse("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nelement "
           "face 1\n"
           "property list uchar int corners\nend_header\n0 0 0\n3 0 0 0\n",
           "no list 'vertex_indices'");
    refuse(HEAD("ascii", "0", "0"), "has no vertices");
    refuse(HEAD("ascii", "1", "0") "0 0 0\n", "has no faces");
}

static void test_body_refusals(void **state)
{
    (void)state;
    /* promises are checked before memory is taken */
    refuse(HEAD("binary_little_endian", "4000000000", "1") "abc", "promises 4000000000 of element 'vertex'");
    refuse(HEAD("ascii", "2", "4000000000") "0 0 0 0 0 0", "promises 4000000000 of element 'face'");
    refuse(HEAD("ascii", "2", "1") "0.25 0.25 0.25\n1 1\n", "ends inside vertex 1 of 2");
    refuse(HEAD("ascii", "1", "2") "0 0 0\n3 0 0 0\n3 0", "ends inside face 1 of 2");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", "vertex 1 of 3 has 'nan'");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n",
           "vertex 1 of 3 has a coordinate that is not finite");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1,5 0\n0 1 0\n3 0 1 2\n", "'1,5'");
    refuse(HEAD("ascii", "3", "2") "0 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 1 3\n", "face 1 of 2 uses vertex 3; there are 3");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n3 0 1 -1\n", "uses vertex -1");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n3 0 1 1.5\n", "uses vertex 1.5");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n2 0 1\n", "face 0 of 1 has 2 corners");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n0\n", "face 0 of 1 has 0 corners");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n256 1 1 1\n", "has 256 corners; 3 to 255");
    refuse(HEAD("ascii", "3", "1") "0 0 0\n1 1 0\n0 1 0\n-3 0 1 2\n", "a list of -3 values");
    const float infinite = (float)INFINITY;
    Buf buf = {0};
    buf_add(&buf, HEAD("binary_little_endian", "1", "1"));
    buf_add_bytes(&buf, (const char *)&infinite, sizeof infinite);
    buf_add_bytes(&buf, "\0\0\0\0\0\0\0\0\3\0\0\0\0\0\0\0\0\0\0\0\0", 21);
    refuse_bytes(buf.text, buf.length, "vertex 0 of 1 has a coordinate that is not finite");
    buf_clear(&buf);
}

static void test_round_trip(void **state)
{
    (void)state;
    Mesh *sphere = icosphere(3, 4), *mesh = NULL;
    assert_non_null(sphere);
    Buf buf = {0};
    buf_format(
        &buf,
        "ply\nformat binary_big_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nelement face %u\n"
        "property list uchar uint vertex_indices\nend_header\n",
        sphere->n_vertices, sphere->n_triangles);
    for (uint32_t i = 0; i < sphere->n_vertices; i++) {
        const float values[6] = {sphere->positions[i].x, sphere->positions[i].y, sphere->positions[i].z,
                                 sphere->normals[i].x,   sphere->normals[i].y,   sphere->normals[i].z};
        for (int k = 0; k < 6; k++) add_float(&buf, values[k], true);
    }
    for (uint32_t i = 0; i < sphere->n_triangles; i++) {
        buf_add_bytes(&buf, "\3", 1);
        for (int k = 0; k < 3; k++) add_int(&buf, (int32_t)sphere->triangles[i][k], true);
    }
    mesh = load_bytes(buf.text, buf.length);
    buf_clear(&buf);
    assert_int_equal(mesh->n_vertices, sphere->n_vertices);
    assert_memory_equal(mesh->positions, sphere->positions, sphere->n_vertices * sizeof(Vec3f));
    assert_memory_equal(mesh->triangles, sphere->triangles, sphere->n_triangles * sizeof mesh->triangles[0]);
    assert_non_null(mesh->normals);
    mesh_free(mesh);
    mesh_free(sphere);
}

static void test_hollow(void **state)
{
    (void)state;
    static const char vertices[] = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n",
                      faces[] = "element face 1\nproperty list uchar int vertex_indices\n",
                      places[] = "0 0 0\n2 1 0\n0 2 0\n1 1 0\n";
    char text[500];
    const uint32_t cut[][3] = {{3, 0, 1}, {2, 3, 1}}, fan[][3] = {{0, 1, 2}, {0, 2, 3}};
    for (int first = 0; first < 2; first++) { /* where faces stand first, nothing is known of their corners */
        snprintf(text, sizeof text, "ply\nformat ascii 1.0\n%s%send_header\n%s%s", first ? faces : vertices,
                 first ? vertices : faces, first ? "4 0 1 2 3\n" : places, first ? places : "4 0 1 2 3\n");
        Mesh *mesh = load(text);
        assert_int_equal(mesh->n_triangles, 2);
        assert_memory_equal(mesh->triangles, first ? fan : cut, sizeof cut);
        mesh_free(mesh);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_text_with_everything),
        cmocka_unit_test(test_binary),
        cmocka_unit_test(test_noise),
        cmocka_unit_test(test_header_refusals),
        cmocka_unit_test(test_body_refusals),
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_hollow),
    };
    mesh_name = "mesh.ply";
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
