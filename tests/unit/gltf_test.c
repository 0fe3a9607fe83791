/* gltf_test.c - glTF files: buffers in all places, nodes, sparse and quantized numbers, strips and fans, and damage.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/buf.h"
#include "mesh_reader.h"
#include "near.h"

/* A tetrahedron of volume 1/6: 4 positions from byte 0, 12 shorts of corners from 48, 4 positions as shorts of 30,000
 * from 72, one index and one position (0, 0, 2) for a sparse accessor from 96 and 100, a strip of four corners from
 * 112. */
enum { BUFFER = 116 };

static void make_buffer(unsigned char bytes[BUFFER])
{
    static const float positions[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, moved[3] = {0, 0, 2};
    static const uint16_t corners[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, strip[2] = {0x0100, 0x0302};
    static const int16_t shorts[12] = {0, 0, 0, 32767, 0, 0, 0, 32767, 0, 0, 0, 32767};
    static const uint32_t third = 3;
    memcpy(bytes, positions, 48);
    memcpy(bytes + 48, corners, 24);
    memcpy(bytes + 72, shorts, 24);
    memcpy(bytes + 96, &third, 4);
    memcpy(bytes + 100, moved, 12);
    memcpy(bytes + 112, strip, 4);
}

static void add_base64(Buf *out)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    unsigned char bytes[BUFFER + 2] = {0};
    make_buffer(bytes);
    for (size_t i = 0; i < BUFFER; i += 3) {
        uint32_t word = (uint32_t)bytes[i] << 16 | (uint32_t)bytes[i + 1] << 8 | bytes[i + 2];
        for (int k = 18; k >= 0; k -= 6) buf_add_bytes(out, &digits[word >> k & 63], 1);
    }
    out->text[out->length - 1] = '='; /* 116 bytes are 38 threes and two */
}

#define DATA "data:application/octet-stream;base64,@"
#define TETRAHEDRON "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}"
#define NODES "\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"mesh\": 0}]"

/* A file of these nodes, of this list of primitives, and of this buffer, where a @ stands for the base64 text. */
static char *file_text(const char *nodes, const char *primitives, const char *uri)
{
    Buf out = {0};
    buf_format(&out,
               "{\"asset\": {\"version\": \"2.0\"}, %s, \"meshes\": [{\"name\": \"shape\", \"primitives\": [%s]}], ",
               nodes, primitives);
    buf_add(&out,
            "\"materials\": [{\"name\": \"amber\"}], \"accessors\": ["
            "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"},"
            "{\"bufferView\": 1, \"componentType\": 5123, \"count\": 12, \"type\": \"SCALAR\"},"
            "{\"bufferView\": 2, \"componentType\": 5122, \"normalized\": true, \"count\": 4, \"type\": \"VEC3\"},"
            "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\", \"sparse\": {\"count\": 1,"
            " \"indices\": {\"bufferView\": 3, \"componentType\": 5125}, \"values\": {\"bufferView\": 3, "
            "\"byteOffset\": 4}}},"
            "{\"bufferView\": 4, \"componentType\": 5121, \"count\": 4, \"type\": \"SCALAR\"},"
            "{\"bufferView\": 1, \"componentType\": 5123, \"count\": 13, \"type\": \"SCALAR\"},"
            "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 3, \"type\": \"VEC3\"},"
            "{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC2\"}],"
            "\"bufferViews\": [{\"buffer\": 0, \"byteLength\": 48}, {\"buffer\": 0, \"byteOffset\": 48, "
            "\"byteLength\": 24},"
            "{\"buffer\": 0, \"byteOffset\": 72, \"byteLength\": 24}, {\"buffer\": 0, \"byteOffset\": 96, "
            "\"byteLength\": 16},"
            "{\"buffer\": 0, \"byteOffset\": 112, \"byteLength\": 4}], \"buffers\": [{\"byteLength\": 116");
    if (uri) buf_add(&out, ", \"uri\": \"");
    for (const char *c = uri; c && *c; c++)
        if (*c == '@')
            add_base64(&out);
        else
            buf_add_bytes(&out, c, 1);
    buf_add(&out, uri ? "\"}]}" : "}]}");
    return out.text;
}

static Mesh *load_nodes(const char *nodes, const char *primitives)
{
    char *text = file_text(nodes, primitives, DATA);
    Mesh *mesh = load(text);
    free(text);
    return mesh;
}

static void refuse_nodes(const char *nodes, const char *primitives, const char *uri, const char *reason)
{
    char *text = file_text(nodes, primitives, uri);
    refuse(text, reason);
    free(text);
}

static MeshReport measured(Mesh *mesh)
{
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    mesh_free(mesh);
    return report;
}

static void assert_tetrahedron(Mesh *mesh, double volume)
{
    assert_int_equal(mesh->n_triangles, 4);
    assert_int_equal(mesh->n_vertices, 4);
    MeshReport report = measured(mesh);
    assert_true(report.closed && !report.inside_out);
    assert_near(report.volume, volume, 1e-7);
}

static void add_word(Buf *out, uint32_t word)
{
    const char bytes[4] = {(char)word, (char)(word >> 8), (char)(word >> 16), (char)(word >> 24)};
    buf_add_bytes(out, bytes, 4);
}

static void make_glb(Buf *out)
{
    unsigned char bytes[BUFFER];
    char *text = file_text(NODES, TETRAHEDRON, NULL);
    uint32_t length = (uint32_t)strlen(text);
    make_buffer(bytes);
    buf_add_bytes(out, "glTF", 4);
    add_word(out, 2);
    add_word(out, 12 + 8 + length + 8 + BUFFER);
    add_word(out, length);
    buf_add_bytes(out, "JSON", 4);
    buf_add_bytes(out, text, length);
    add_word(out, BUFFER);
    buf_add_bytes(out, "BIN\0", 4);
    buf_add_bytes(out, (const char *)bytes, BUFFER);
    free(text);
}

static void buffers_are_within_beside_and_in_binary_files(void **state)
{
    (void)state;
    unsigned char bytes[BUFFER];
    make_buffer(bytes);
    assert_tetrahedron(load_nodes(NODES, TETRAHEDRON), 1.0 / 6);
    write_bytes(in_folder("my numbers.bin"), bytes, sizeof bytes);
    char *text = file_text(NODES, TETRAHEDRON, "my%20numbers.bin");
    assert_tetrahedron(load(text), 1.0 / 6);
    free(text);
    Buf glb = {0};
    make_glb(&glb);
    mesh_name = "mesh.glb";
    assert_tetrahedron(load_bytes(glb.text, glb.length), 1.0 / 6);
    for (size_t length = 0; length < glb.length; length += length < 64 || length + 200 > glb.length ? 1 : 37)
        refuse_bytes(glb.text, length, "");
    mesh_name = "mesh.gltf";
    buf_clear(&glb);
}

static void nodes_move_turn_scale_and_mirror(void **state)
{
    (void)state;
    Mesh *mesh = load_nodes("\"scene\": 0, \"scenes\": [{\"nodes\": [1]}], \"nodes\": ["
                            "{\"mesh\": 0, \"rotation\": [0, 0, 0.7071067811865476, 0.7071067811865476]},"
                            "{\"children\": [0], \"translation\": [10, 0, 0], \"scale\": [2, 2, 2]}]",
                            TETRAHEDRON);
    MeshReport report = measured(mesh);
    assert_near(report.volume, 8.0 / 6, 1e-6);
    assert_near(report.bounds.min.x, 8, 1e-6); /* y became -x */
    assert_near(report.bounds.max.y, 2, 1e-6);
    assert_tetrahedron(load_nodes("\"nodes\": [{\"mesh\": 0, \"scale\": [-1, 1, 3]}]", TETRAHEDRON), 0.5);
    assert_tetrahedron(
        load_nodes("\"nodes\": [{\"mesh\": 0, \"matrix\": [0,0,1,0, 1,0,0,0, 0,1,0,0, 5,6,7,1]}]", TETRAHEDRON),
        1.0 / 6);
    /* the default scene's only; the same mesh twice */
    const char *nodes = "\"scene\": 1, \"scenes\": [{\"nodes\": [0]}, {\"nodes\": [1, 2]}], \"nodes\": [{\"mesh\": 0}, "
                        "{\"mesh\": 0, \"translation\": [5, 0, 0]}, {\"mesh\": 0, \"translation\": [9, 0, 0]}]";
    report = measured(load_nodes(nodes, TETRAHEDRON));
    assert_int_equal(report.n_components, 2);
    assert_near(report.bounds.min.x, 5, 0);
}

static void sparse_and_quantized_numbers_are_read(void **state)
{
    (void)state;
    assert_tetrahedron(load_nodes(NODES, "{\"attributes\": {\"POSITION\": 3}, \"indices\": 1}"), 1.0 / 3);
    assert_tetrahedron(load_nodes("\"extensionsRequired\": [\"KHR_mesh_quantization\"], " NODES,
                                  "{\"attributes\": {\"POSITION\": 2}, \"indices\": 1}"),
                       1.0 / 6);
}

static void strips_fans_normals_and_uvs_are_read(void **state)
{
    (void)state;
    Mesh *mesh = load_nodes(NODES, "{\"mode\": 5, \"attributes\": {\"POSITION\": 0}, \"indices\": 4}");
    assert_int_equal(mesh->n_triangles, 2);
    MeshReport report = measured(mesh);
    assert_true(report.consistent);
    mesh = load_nodes(NODES, "{\"mode\": 6, \"attributes\": {\"POSITION\": 0}}");
    assert_int_equal(mesh->n_triangles, 2);
    report = measured(mesh);
    assert_true(report.consistent);
    mesh = load_nodes(
        NODES, "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 3}, \"indices\": 1}, "
               "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}, {\"mode\": 1, \"attributes\": {\"POSITION\": 0}}");
    assert_int_equal(mesh->n_triangles, 8);
    assert_non_null(mesh->normals);
    assert_null(mesh->uvs);
    /* the second has none: it is flat */
    Vec3f flat = mesh->normals[mesh->triangles[4][0]];
    assert_near((double)flat.z, -1, 1e-6);
    mesh_free(mesh);
}

/* v counts down from a picture's upper edge in the file, and up from its lower one in a mesh. Read as pairs, the positions
 * are (0, 0), (0, 1), (0, 0), (0, 1). */
static void pictures_stand_upright(void **state)
{
    (void)state;
    static const char *const primitives[] = {
        "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 0, \"TEXCOORD_0\": 7}, \"indices\": 1}",
        "{\"attributes\": {\"POSITION\": 0, \"TEXCOORD_0\": 7}, \"indices\": 1}", /* flat: corners stand alone */
    };
    for (size_t i = 0; i < COUNT_OF(primitives); i++) {
        Mesh *mesh = load_nodes(NODES, primitives[i]);
        assert_non_null(mesh->uvs);
        for (uint32_t v = 0; v < mesh->n_vertices; v++) {
            bool down = mesh->positions[v].x > 0 || mesh->positions[v].z > 0; /* the second vertex and the fourth */
            assert_true(mesh->uvs[2 * v] == 0);
            assert_true(mesh->uvs[2 * v + 1] == (down ? 0 : 1));
        }
        mesh_free(mesh);
    }
}

static void parts_are_nodes_meshes_and_materials(void **state)
{
    (void)state;
    Mesh *mesh =
        load_nodes("\"nodes\": [{\"name\": \"bottle\", \"children\": [1, 2]}, {\"mesh\": 0, \"name\": \"body\"}, "
                   "{\"mesh\": 0, \"name\": \"cap\", \"translation\": [0, 3, 0]}]",
                   TETRAHEDRON ", {\"attributes\": {\"POSITION\": 6}, \"material\": 0}");
    assert_int_equal(mesh->n_triangles, 10);
    mesh_free(mesh);
    static const struct {
        const char *part;
        uint32_t n;
    } cases[] = {{"bottle", 10}, {"body", 5}, {"cap", 5}, {"shape", 10}, {"amber", 2}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        mesh = load_part(cases[i].part);
        assert_int_equal(mesh->n_triangles, cases[i].n);
        mesh_free(mesh);
    }
    refuse_part("ambre", "did you mean 'amber'?");
    MeshSource source = {0};
    Error error;
    assert_int_equal(mesh_load(in_folder(mesh_name), &source, &mesh, &error), STATUS_OK);
    assert_near(source.unit_m, 1, 0);
    mesh_source_clear(&source);
    mesh_free(mesh);
}

/* A node and a material of one name, a child below its parent, nodes of one name, and what has none. */
static void parts_are_of_a_kind_or_numbered_or_several_at_once(void **state)
{
    (void)state;
    mesh_free(load_nodes("\"nodes\": [{\"mesh\": 0, \"name\": \"amber\", \"children\": [1]}, {\"mesh\": 0, \"name\": "
                         "\"cap\"}, {\"mesh\": 0, \"name\": \"cap\"}, {\"mesh\": 0}]",
                         TETRAHEDRON ", {\"attributes\": {\"POSITION\": 6}, \"material\": 0}"));
    static const struct {
        const char *parts[3];
        size_t n;
        uint32_t n_triangles;
    } cases[] = {
        {{"amber"}, 1, 12},
        {{"node:amber"}, 1, 10},
        {{"object:amber"}, 1, 5},
        {{"material:amber"}, 1, 4},
        {{"material:#0"}, 1, 4},
        {{"material:"}, 1, 16},
        {{"cap"}, 1, 10},
        {{"node:#2"}, 1, 5},
        {{"#3"}, 1, 5},
        {{"cap", "material:amber"}, 2, 2},
        {{"object:#1", "material:"}, 2, 4},
        {{"amber", "cap", "shape"}, 3, 6},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Mesh *mesh = load_parts(cases[i].parts, cases[i].n);
        assert_int_equal(mesh->n_triangles, cases[i].n_triangles);
        mesh_free(mesh);
    }
    static const char *const apart[] = {"object:#1", "object:#2"}, *const wrong[] = {"cap", "material:ambre"};
    refuse_parts(apart, 2, "no face is of 'object:#1' and of 'object:#2' at once");
    refuse_parts(wrong, 2, "has no part 'material:ambre'");
}

static void assert_said(const MeshSource *source, const char *name, const char *expected)
{
    Buf said = {0};
    const MeshMaterial *material = mesh_source_find_material(source, name);
    assert_non_null(material);
    material_describe(material, &said);
    assert_string_equal(buf_text(&said), expected);
    buf_clear(&said);
}

static void what_materials_are_said_to_be_is_listed(void **state)
{
    (void)state;
    char *text =
        file_text("\"images\": [{\"uri\": \"label.png\"}, {\"bufferView\": 0}], \"textures\": [{\"source\": 0}, "
                  "{\"source\": 1}, {}], " NODES,
                  TETRAHEDRON, DATA);
    static const char
        plain[] = "{\"name\": \"amber\"}",
        rich[] = "{\"name\": \"amber\", \"pbrMetallicRoughness\": {\"baseColorFactor\": [1, 0.5, 0, 0.25], "
                 "\"baseColorTexture\": {\"index\": 0}, \"roughnessFactor\": 0.1}, \"extensions\": "
                 "{\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, \"KHR_materials_ior\": {\"ior\": "
                 "1.54}}}, {\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 1}}}, {\"name\": "
                 "\"wrong\", \"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 7}, \"baseColorFactor\": "
                 "3, \"metallicFactor\": \"x\"}}";
    const char *at = strstr(text, plain);
    assert_non_null(at);
    Buf changed = {0};
    buf_format(&changed, "%.*s%s%s", (int)(at - text), text, rich, at + strlen(plain));
    free(text);
    write_bytes(in_folder(mesh_name), changed.text, changed.length);
    buf_clear(&changed);
    MeshSource source = {0};
    Mesh *mesh;
    Error error;
    assert_int_equal(mesh_load(in_folder(mesh_name), &source, &mesh, &error), STATUS_OK);
    assert_int_equal(source.n_materials, 3);
    assert_said(&source, "amber",
                "base colour 1 0.5 0, opacity 0.25, picture label.png, roughness 0.1, transmission 1, index 1.54");
    assert_said(&source, "", "picture within the file");
    assert_null(mesh_source_find_material(&source, "green"));
    mesh_source_clear(&source);
    mesh_free(mesh);
}

static void extensions_that_cannot_be_read_are_named(void **state)
{
    (void)state;
    refuse_nodes("\"extensionsRequired\": [\"KHR_materials_unlit\", \"KHR_draco_mesh_compression\"], " NODES,
                 TETRAHEDRON, DATA,
                 "extension 'KHR_draco_mesh_compression', which cannot be read; export it without compression");
    refuse_nodes("\"extensionsRequired\": [\"EXT_mesh_gpu_instancing\"], " NODES, TETRAHEDRON, DATA,
                 "extension 'EXT_mesh_gpu_instancing', which cannot be read; export it without it");
    assert_tetrahedron(load_nodes("\"extensionsRequired\": [\"KHR_materials_unlit\"], " NODES, TETRAHEDRON), 1.0 / 6);
}

static void what_does_not_fit_together_is_refused(void **state)
{
    (void)state;
    refuse("", "line");
    refuse("{}", "not a glTF file");
    refuse("{\"asset\": {\"version\": \"1.0\"}}", "version 1.0 of glTF");
    refuse("{\"asset\": {\"version\": \"2.0\"}}", "no faces");
    refuse_nodes(NODES, TETRAHEDRON, "gone.bin", "there is no file");
    refuse_nodes(NODES, TETRAHEDRON, "../../etc/passwd", "outside of its folder");
    refuse_nodes(NODES, TETRAHEDRON, "/etc/passwd", "there is no file");
    refuse_nodes(NODES, TETRAHEDRON, "http://example.org/a.bin", "is not a file");
    refuse_nodes(NODES, TETRAHEDRON, "data:text/plain,abc", "other than base64");
    refuse_nodes(NODES, TETRAHEDRON, "data:;base64,AA*A", "wrong character");
    refuse_nodes(NODES, TETRAHEDRON, "data:;base64,AAAA", "buffer 0 should have 116 bytes and has 3");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 6}, \"indices\": 1}", DATA, "uses vertex 3; there are 3");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 5}", DATA, "does not fit a buffer view");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 0}, \"indices\": 4}", DATA, "4 corners, which are not threes");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 9}}", DATA, "no number 9 of its 8 accessors");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 1}}", DATA, "of type SCALAR, not VEC3");
    refuse_nodes(NODES, "{\"attributes\": {}}", DATA, "'POSITION' is missing");
    refuse_nodes(NODES, "{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 6}}", DATA, "4 positions, and 3 of NORMAL");
    refuse_nodes(NODES, "{\"mode\": 9, \"attributes\": {\"POSITION\": 0}}", DATA, "mode is 9");
    refuse_nodes("\"scene\": 3, " NODES, TETRAHEDRON, DATA, "no number 3 of its 1 scenes");
    refuse_nodes("\"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"children\": [0]}]", TETRAHEDRON, DATA, "twice");
    refuse_nodes("\"nodes\": [{\"mesh\": 4}]", TETRAHEDRON, DATA, "no number 4 of its 1 meshes");
    refuse_nodes("\"nodes\": [{\"mesh\": 0, \"scale\": [1, 1]}]", TETRAHEDRON, DATA, "scale has 2 numbers, not 3");
    refuse_nodes("\"nodes\": [{\"mesh\": 0, \"rotation\": [0, 0, 0, 0]}]", TETRAHEDRON, DATA, "no rotation");
    refuse_nodes("\"nodes\": [{\"mesh\": 0, \"scale\": [1e300, 1, 1]}]", TETRAHEDRON, DATA, "no finite place");
}

static void spoilt_files_do_no_harm(void **state)
{
    (void)state;
    char *text =
        file_text(NODES, TETRAHEDRON ", {\"attributes\": {\"POSITION\": 3, \"NORMAL\": 2}, \"material\": 0}", DATA);
    spoil(text, strlen(text), 3000);
    free(text);
    Buf glb = {0};
    make_glb(&glb);
    mesh_name = "mesh.glb";
    spoil(glb.text, glb.length, 3000);
    mesh_name = "mesh.gltf";
    buf_clear(&glb);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buffers_are_within_beside_and_in_binary_files),
        cmocka_unit_test(nodes_move_turn_scale_and_mirror),
        cmocka_unit_test(sparse_and_quantized_numbers_are_read),
        cmocka_unit_test(strips_fans_normals_and_uvs_are_read),
        cmocka_unit_test(pictures_stand_upright),
        cmocka_unit_test(parts_are_nodes_meshes_and_materials),
        cmocka_unit_test(parts_are_of_a_kind_or_numbered_or_several_at_once),
        cmocka_unit_test(what_materials_are_said_to_be_is_listed),
        cmocka_unit_test(extensions_that_cannot_be_read_are_named),
        cmocka_unit_test(what_does_not_fit_together_is_refused),
        cmocka_unit_test(spoilt_files_do_no_harm),
    };
    mesh_name = "mesh.gltf";
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
