/* stl_test.c - STL files of both kinds, with headers that lie about which it is, and damaged ones.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/buf.h"
#include "mesh_reader.h"
#include "near.h"

static const Vec3f corners[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

static void add_word(Buf *buf, uint32_t word)
{
    const char bytes[4] = {(char)word, (char)(word >> 8), (char)(word >> 16), (char)(word >> 24)};
    buf_add_bytes(buf, bytes, 4);
}

static void add_float(Buf *buf, float x)
{
    uint32_t word;
    memcpy(&word, &x, sizeof word);
    add_word(buf, word);
}

/* A tetrahedron of 4 triangles that says it has n. */
static void add_binary(Buf *buf, const char *header, uint32_t n)
{
    char padded[80] = {0};
    memcpy(padded, header, strlen(header));
    buf_add_bytes(buf, padded, sizeof padded);
    add_word(buf, n);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) add_float(buf, NAN); /* a normal that nobody needs */
        for (int k = 0; k < 3; k++) {
            Vec3f p = corners[faces[i][k]];
            add_float(buf, p.x);
            add_float(buf, p.y);
            add_float(buf, p.z);
        }
        buf_add_bytes(buf, "\1\2", 2);
    }
}

static void add_text(Buf *buf, const char *name, float shift)
{
    buf_format(buf, "solid %s\r\n", name);
    for (int i = 0; i < 4; i++) {
        buf_add(buf, "  FACET normal nan 0 -1e0\n    outer loop\n");
        for (int k = 0; k < 3; k++) {
            Vec3f p = corners[faces[i][k]];
            buf_format(buf, "      vertex %g %ge0\t%g\r\n", (double)(p.x + shift), (double)p.y, (double)p.z);
        }
        buf_add(buf, "    endloop\n  endfacet\n");
    }
    buf_format(buf, "endsolid %s\n", name);
}

static void assert_tetrahedron(Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh->n_triangles, 4);
    assert_int_equal(mesh->n_vertices, 4);
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed && !report.inside_out);
    assert_near(report.volume, 1.0 / 6, 1e-15);
    mesh_free(mesh);
}

static void binary_files_are_read_whatever_their_header_says(void **state)
{
    (void)state;
    static const char *const headers[] = {"", "binary STL", "solid", "solid tetrahedron\nfacet normal 0 0 0"};
    for (size_t i = 0; i < COUNT_OF(headers); i++) {
        Buf buf = {0};
        add_binary(&buf, headers[i], 4);
        assert_tetrahedron(load_bytes(buf.text, buf.length));
        buf_clear(&buf);
    }
}

static void what_stands_behind_the_last_triangle_is_passed_over(void **state)
{
    (void)state;
    Buf buf = {0};
    add_binary(&buf, "solid by a program that appends its name", 4);
    buf_add(&buf, "colours");
    assert_tetrahedron(load_bytes(buf.text, buf.length));
    buf_clear(&buf);
}

static void counts_that_lie_are_refused(void **state)
{
    (void)state;
    static const uint32_t counts[] = {5, 1000000, 0xffffffffU};
    for (size_t i = 0; i < COUNT_OF(counts); i++) {
        Buf buf = {0};
        add_binary(&buf, "solid", counts[i]);
        refuse_bytes(buf.text, buf.length, i == 2 ? "can be read" : "ends too early");
        buf_clear(&buf);
    }
    Buf buf = {0};
    add_binary(&buf, "", 0);
    refuse_bytes(buf.text, 84, "no faces");
    buf_clear(&buf);
}

static void coordinates_that_are_not_finite_are_refused(void **state)
{
    (void)state;
    Buf buf = {0};
    add_binary(&buf, "", 4);
    memcpy(buf.text + 84 + 2 * 50 + 12 + 16, "\0\0\xc0\x7f", 4);
    refuse_bytes(buf.text, buf.length, "triangle 2 of 4");
    buf_clear(&buf);
}

static void texts_are_read_and_their_solids_are_parts(void **state)
{
    (void)state;
    Buf buf = {0};
    add_text(&buf, "left one", 0);
    assert_tetrahedron(load(buf_text(&buf)));
    add_text(&buf, "right one", 2);
    Mesh *mesh = load(buf_text(&buf));
    assert_int_equal(mesh->n_triangles, 8);
    mesh_free(mesh);
    mesh = load_part("right one");
    assert_near((double)mesh->positions[0].x, 2, 0);
    assert_tetrahedron(mesh);
    refuse_part("rihgt one", "did you mean 'right one'?");
    refuse_part("middle", "it has solid 'left one', solid 'right one'");
    buf_clear(&buf);
    add_binary(&buf, "solid left one", 4);
    write_bytes(in_folder(mesh_name), buf.text, buf.length);
    refuse_part("left one", "names no parts");
    buf_clear(&buf);
}

static void damaged_texts_are_refused_with_the_line(void **state)
{
    (void)state;
    refuse("", "not an STL");
    refuse("solid x\nendsolid x\n", "no faces");
    refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n", ":4: 'zero' stands where a finite number");
    refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1e99\n", ":4: '1e99' stands where a finite number");
    refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nendloop",
           ":6: 'endloop' stands where 'vertex'");
    refuse("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 1 0 0\nvertex 1 1 1\n",
           "a facet has three corners");
    refuse("solid x\nfacet normal 0 0 1\nouter loop", ":3: the file ends where 'vertex'");
}

static void spoilt_files_do_no_harm(void **state)
{
    (void)state;
    Buf binary = {0}, text = {0};
    add_binary(&binary, "solid", 4);
    spoil(binary.text, binary.length, 2000);
    add_text(&text, "x", 0);
    spoil(text.text, text.length, 2000);
    buf_clear(&binary);
    buf_clear(&text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(binary_files_are_read_whatever_their_header_says),
        cmocka_unit_test(what_stands_behind_the_last_triangle_is_passed_over),
        cmocka_unit_test(counts_that_lie_are_refused),
        cmocka_unit_test(coordinates_that_are_not_finite_are_refused),
        cmocka_unit_test(texts_are_read_and_their_solids_are_parts),
        cmocka_unit_test(damaged_texts_are_refused_with_the_line),
        cmocka_unit_test(spoilt_files_do_no_harm),
    };
    mesh_name = "mesh.stl";
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
