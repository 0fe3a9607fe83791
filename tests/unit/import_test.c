/* import_test.c - scenes from mesh files: whatever these say, what is written is a scene, laid out, that can be built; and all of the
 * triangles are in it, each once.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "import/import.h"
#include "lang/format.h"
#include "mesh_reader.h"
#include "near.h"
#include "scene_fixture.h"

/* A tetrahedron, or three of its faces, in base64. */
#define BUFFERS                                                                                                        \
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}, "                 \
    "{\"bufferView\": 1, "                                                                                             \
    "\"componentType\": 5121, \"count\": 12, \"type\": \"SCALAR\"}, {\"bufferView\": 1, \"componentType\": 5121, "     \
    "\"count\": 9, \"type\": \"SCALAR\"}], \"bufferViews\": [{\"buffer\": 0, \"byteLength\": 48}, {\"buffer\": 0, "    \
    "\"byteOffset\": 48, \"byteLength\": 12}], \"buffers\": [{\"byteLength\": 60, \"uri\": \"data:;base64,"            \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAAMCAQID\"}]"
#define CLOSED "{\"attributes\": {\"POSITION\": 0}, \"indices\": 1"
#define OPEN "{\"attributes\": {\"POSITION\": 0}, \"indices\": 2"
#define HEAD "{\"asset\": {\"version\": \"2.0\"}, "

/* What an import made, and the scene of it. */
typedef struct Made {
    Import import;
    MeshSource source;
    Mesh *mesh;
    char *text; /* laid out */
    Fixture fixture;
} Made;

static void made_clear(Made *made)
{
    fixture_clear(&made->fixture);
    import_clear(&made->import);
    mesh_source_clear(&made->source);
    mesh_free(made->mesh);
    free(made->text);
}

typedef struct LaidOut {
    const Buf *text;
    Buf out;
    Diag *diag;
    Status status;
    Error error;
} LaidOut;

static void lay_out(void *context)
{
    LaidOut *laid_out = context;
    laid_out->status = format_text("scene", buf_text(laid_out->text), laid_out->text->length, laid_out->diag,
                                   &laid_out->out, &laid_out->error);
}

/* As fmt does it, twice: the second time nothing changes. */
static char *formatted(const Buf *text)
{
    Arena arena;
    SourceSet sources = {.arena = &arena};
    Diag diag;
    arena_init(&arena);
    diag_init(&diag, &arena, &sources);
    LaidOut first = {.text = text, .diag = &diag}, second = {.text = &first.out, .diag = &diag};
    assert_true(arena_guard(&arena, lay_out, &first));
    if (first.status != STATUS_OK) fail_msg("not in the language: %s", buf_text(text));
    assert_true(arena_guard(&arena, lay_out, &second));
    assert_string_equal(buf_text(&first.out), buf_text(&second.out));
    buf_clear(&second.out);
    arena_clear(&arena);
    return first.out.text;
}

/* Imports a text as a file of that name. */
static void import_only(Made *made, const char *name, const char *text)
{
    Error error;
    char path[256], beside[256];
    memset(made, 0, sizeof *made);
    mesh_name = name;
    write_bytes(in_folder(name), text, strlen(text));
    snprintf(path, sizeof path, "%s", in_folder(name));
    snprintf(beside, sizeof beside, "%s/", folder);
    made->source.whole = true;
    if (mesh_load(path, &made->source, &made->mesh, &error) != STATUS_OK) fail_msg("%s in %s", error.text, text);
    ImportOptions options = {.path = path, .file = path, .folder = beside, .real_folder = beside, .stem = "model"};
    if (import_scene(&options, &made->source, made->mesh, &made->import, &error) != STATUS_OK)
        fail_msg("%s in %s", error.text, text);
    made->text = formatted(&made->import.text);
}

/* And builds the scene. */
static void import_text_as(Made *made, const char *name, const char *text)
{
    import_only(made, name, text);
    fixture_good(&made->fixture, made->text);
    if (made->fixture.diag.n_warnings) {
        fixture_print(&made->fixture);
        fail_msg("warnings of %s", made->text);
    }
}

static void import_text(Made *made, const char *text)
{
    import_text_as(made, "model.gltf", text);
}

static void assert_says(const Made *made, const char *text)
{
    if (!strstr(made->text, text)) fail_msg("'%s' is not in %s", text, made->text);
}

static void assert_notes(const Made *made, const char *text)
{
    for (size_t i = 0; i < made->import.n_notes; i++)
        if (strstr(made->import.notes[i], text)) return;
    fail_msg("nothing notes '%s' of %s", text, made->text);
}

/* A file of one object of this material. */
static char *file_of(const char *primitive, const char *material)
{
    Buf text = {0};
    buf_format(&text,
               HEAD "\"nodes\": [{\"name\": \"thing\", \"mesh\": 0}], \"meshes\": [{\"primitives\": [%s, "
                    "\"material\": 0}]}], \"materials\": [%s], " BUFFERS "}",
               primitive, material);
    return text.text;
}

static void import_material(Made *made, const char *primitive, const char *material)
{
    char *text = file_of(primitive, material);
    import_text(made, text);
    free(text);
}

#define LOOK(text)                                                                                                     \
    "{\"name\": \"Stuff\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"roughnessFactor\": 0" text "}"
#define GLASS ", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}"

/* A material with a picture of that URI. */
static void import_picture_of(Made *made, const char *uri)
{
    Buf material = {0};
    buf_format(&material,
               LOOK(", \"baseColorTexture\": {\"index\": 0}") "}], \"textures\": [{\"source\": 0}], \"images\": "
                                                              "[{\"uri\": \"%s\"}",
               uri);
    import_material(made, CLOSED, buf_text(&material));
    buf_clear(&material);
}

static void names_of_pictures_stay_in_their_comments(void **state)
{
    (void)state;
    Made made;
    import_picture_of(&made, "a%0Alight {}%0D.png");
    assert_says(&made, "picture a?light {}?.png");
    made_clear(&made);
    import_picture_of(&made, "b%C3.png");
    assert_says(&made, "picture b?.png");
    made_clear(&made);
}

static void clear_materials_fill_closed_meshes(void **state)
{
    (void)state;
    Made made;
    import_material(&made, CLOSED,
                    LOOK("") GLASS
                    ", \"KHR_materials_ior\": {\"ior\": 1.36}, \"KHR_materials_volume\": {"
                    "\"thicknessFactor\": 1, \"attenuationDistance\": 0.012, \"attenuationColor\": [0.85, "
                    "0.42, 0.08]}}}");
    assert_says(&made, "medium stuff { ior = 1.36  state = solid  tint = rgb(0.85, 0.42, 0.08)  depth = 1.2cm }");
    assert_says(&made, "interior = stuff }");
    assert_int_equal(made.import.n_notes, 0);
    made_clear(&made);
    import_material(&made, OPEN, LOOK(", \"baseColorFactor\": [0.5, 1, 1, 1]") GLASS "}}");
    assert_says(&made, "surface stuff { thin = true  ior = 1.5  transmission = 1  tint = rgb(0.5, 1, 1) }");
    assert_notes(&made, "not closed (3 open edges)");
    made_clear(&made);
    import_material(&made, CLOSED, LOOK("") GLASS ", \"KHR_materials_volume\": {}}}");
    assert_says(&made, "surface stuff { thin = true  ior = 1.5  transmission = 1 }");
    made_clear(&made);
    /* the mean way is four times the volume over the area: 4 / 6 over (3 + sqrt 3) / 2 */
    import_material(&made, CLOSED, LOOK(", \"baseColorFactor\": [0.5, 1, 1, 1]") GLASS "}}");
    assert_says(&made, "tint = rgb(0.5, 1, 1)  depth = 28cm }");
    made_clear(&made);
    import_material(&made, CLOSED,
                    "{\"name\": \"Still Water\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, "
                    "\"roughnessFactor\": 0.25}" GLASS ", \"KHR_materials_dispersion\": {\"dispersion\": 1}}}");
    assert_says(&made, "medium still_water { ior = cauchy(1.462, 0.01309)  state = liquid }"); /* Abbe's number is 20 */
    assert_says(&made, "surface still_water_boundary { roughness = 0.25 }");
    assert_says(&made, "interior = still_water\n  surface = still_water_boundary }");
    made_clear(&made);
}

static void opaque_materials_become_surfaces(void **state)
{
    (void)state;
    static const struct {
        const char *material, *surface;
    } cases[] = {
        {LOOK(", \"baseColorFactor\": [0.8, 0.1, 0.1, 1]") "}",
         "surface stuff { albedo = rgb(0.8, 0.1, 0.1)  ior = 1.5 }"},
        {"{\"name\": \"Stuff\"}", "surface stuff { albedo = 1  metalness = 1  roughness = 1 }"},
        {"{\"name\": \"Stuff\", \"extensions\": {\"KHR_materials_iridescence\": {\"iridescenceFactor\": 1, "
         "\"iridescenceIor\": 2.2, \"iridescenceThicknessMaximum\": 90}}}",
         "surface stuff { albedo = 1  metalness = 1  roughness = 1  film = 90nm  film_ior = 2.2 }"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_specular\": {\"specularFactor\": 0}}}",
         "surface stuff { albedo = 1 }"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_specular\": {\"specularFactor\": 0.8, \"specularColorFactor\": "
                  "[0.5, 0.5, 0.5]}}}",
         "surface stuff { albedo = 1  ior = 1.5  specular = 0.4 }"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_clearcoat\": {\"clearcoatFactor\": 0.5, "
                  "\"clearcoatRoughnessFactor\": 0.1}}}",
         "surface stuff { albedo = 1  ior = 1.5  coat = 0.5  coat_roughness = 0.1 }"},
        {LOOK("") ", \"emissiveFactor\": [1, 0.5, 0], \"extensions\": {\"KHR_materials_emissive_strength\": "
                  "{\"emissiveStrength\": 7}}}",
         "surface stuff { albedo = 1  ior = 1.5  emission = rgb(1, 0.5, 0)  radiance = 7 }"},
        {LOOK(", \"baseColorFactor\": [0.2, 0.2, 0.2, 0.25]") ", \"alphaMode\": \"BLEND\"}", "weight = 0.25"},
        {LOOK(", \"baseColorFactor\": [0.2, 0.2, 0.2, 0.25]") ", \"alphaMode\": \"BLEND\", \"emissiveFactor\": [2, 1, "
                                                              "0]}",
         "emission = mix { from = 0  to = rgb(1, 0.5, 0)  blend = 0.25 }  radiance = 2"},
        {LOOK(", \"baseColorFactor\": [0.2, 0.4, 0.6, 0.25]") ", \"alphaMode\": \"BLEND\", \"extensions\": "
                                                              "{\"KHR_materials_unlit\": {}}}",
         "emission = mix { from = 0  to = rgb(0.2, 0.4, 0.6)  blend = 0.25 }"},
        {LOOK(", \"baseColorFactor\": [0.2, 0.2, 0.2, 0.25]") "}", "surface stuff { albedo = 0.2  ior = 1.5 }"},
        {LOOK(", \"baseColorFactor\": [0.2, 0.4, 0.6, 1]") ", \"extensions\": {\"KHR_materials_unlit\": {}}}",
         "surface stuff { albedo = 0  emission = rgb(0.2, 0.4, 0.6) }"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_diffuse_transmission\": {\"diffuseTransmissionFactor\": 0.5}}}",
         "surface stuff { thin = true  albedo = 1  translucency = 0.5 }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Made made;
        import_material(&made, CLOSED, cases[i].material);
        assert_says(&made, cases[i].surface);
        made_clear(&made);
    }
}

/* The triangles of all objects. */
static size_t count_triangles(const Scene *scene)
{
    size_t n = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const Mesh *mesh = scene->shapes[scene->objects[i].shape].mesh;
        if (mesh && strcmp(scene->objects[i].name, "sweep") != 0) n += mesh->n_triangles;
    }
    return n;
}

static void names_are_made_valid_and_parts_are_exact(void **state)
{
    (void)state;
    static const char *const names[] = {
        "glass",
        "Glass",
        "GLASS.001",
        "sphere",
        "for",
        "air",
        "12 Stones",
        "\\u00e9lan",
        "\\\"; } box { }",
        "*/ // \\\\",
        "a\\nb\\tc",
        "\\u7403",
        "  ",
        "",
        "node:glass",
        "material:",
        "#2",
        "x",
        "pi",
        "studio",
        "model",
        "rgb",
        "a very long name that goes on and on and on and on and on and on and on and on and on and on and on and on "
        "and on "
        "and on and on and on and on and on and on and on and on and on and on and on and on and on and on and on and "
        "on and on",
    };
    const size_t n = COUNT_OF(names);
    Buf text = {0};
    buf_add(&text, HEAD "\"nodes\": [");
    for (size_t i = 0; i < 2 * n; i++) { /* each twice, the second below the first */
        buf_format(&text, "%s{\"name\": \"%s\", \"mesh\": %zu", i ? ", " : "", names[i % n], i % n);
        if (i < n) buf_format(&text, ", \"children\": [%zu]", i + n);
        buf_add(&text, "}");
    }
    buf_add(&text, "], \"meshes\": [");
    for (size_t i = 0; i < n; i++)
        buf_format(&text,
                   "%s{\"primitives\": [" CLOSED ", \"material\": %zu}, " OPEN "}, " OPEN ", \"material\": %zu}]}",
                   i ? ", " : "", i, (i + 1) % n);
    buf_add(&text, "], \"materials\": [");
    for (size_t i = 0; i < n; i++)
        buf_format(&text, "%s{\"name\": \"%s\"%s}", i ? ", " : "", names[i], i % 2 ? "" : GLASS "}");
    buf_add(&text, "], " BUFFERS "}");
    Made made;
    import_text(&made, text.text);
    assert_int_equal(made.import.n_objects, 6 * n);
    assert_int_equal(count_triangles(made.fixture.scene), made.mesh->n_triangles);
    made_clear(&made);
    buf_clear(&text);
}

/* Any numbers in any of the places where a material has some, within what they may be and far beyond. */
static void whatever_a_material_says_a_scene_comes_of_it(void **state)
{
    (void)state;
    static const char *const numbers[] = {"-1",  "0",  "1e-12", "0.3",    "0.9999", "1",
                                          "1.5", "40", "1e9",   "-1e300", "1e300"};
    const uint32_t rounds = 300;
    uint32_t n = 0;
    for (uint32_t round = 0; round < rounds; round++) {
        Buf text = {0};
        buf_format(&text, "{\"name\": \"Stuff\", \"alphaMode\": \"%s\"",
                   hash_u64(n++) % 3 ? hash_u64(n++) % 2 ? "BLEND" : "MASK" : "OPAQUE");
        static const char *const outers[] = {"pbrMetallicRoughness", "extensions", NULL};
        for (size_t outer = 0; outer < COUNT_OF(outers); outer++) {
            const char *open = NULL; /* the extension that is being written */
            if (outers[outer]) buf_format(&text, ", \"%s\": {", outers[outer]);
            bool first = outers[outer] != NULL;
            const MaterialRow *row;
            for (size_t i = 0; (row = material_row(i)) != NULL; i++) {
                bool here =
                    row->outer && outers[outer] ? strcmp(row->outer, outers[outer]) == 0 : row->outer == outers[outer];
                if (!here || !row->name || row->is_picture || row->key == FACT_OPACITY || hash_u64(n++) % 3 == 0)
                    continue;
                if (open && row->extension != open && strcmp(open, row->extension) != 0) {
                    buf_add(&text, "}");
                    open = NULL;
                }
                if (!open || !row->extension) buf_add(&text, first ? "" : ", ");
                first = false;
                if (row->extension && !open) buf_format(&text, "\"%s\": {\"x\": 0", row->extension);
                open = row->extension;
                buf_format(&text, "%s\"%s\": ", open ? ", " : "", row->name);
                for (int k = 0; k < (row->key == FACT_BASE_COLOR ? 4 : row->n); k++)
                    buf_format(&text, "%s%s",
                               k            ? ", "
                               : row->n > 1 ? "["
                                            : "",
                               numbers[hash_u64(n++) % COUNT_OF(numbers)]);
                if (row->n > 1) buf_add(&text, "]");
            }
            buf_add(&text, open ? "}" : "");
            buf_add(&text, outers[outer] ? "}" : "");
        }
        buf_add(&text, "}");
        Made made;
        import_material(&made, round % 3 ? CLOSED : OPEN, text.text);
        made_clear(&made);
        buf_clear(&text);
    }
}

static void lights_and_cameras_stand_where_the_file_has_them(void **state)
{
    (void)state;
    Made made;
    import_text(
        &made, HEAD
        "\"nodes\": [{\"mesh\": 0}, {\"name\": \"Camera\", \"camera\": 0, \"translation\": [0, 0, 4]}, {\"camera\": 1, "
        "\"name\": \"Side\", \"rotation\": [0, 0.7071067811865476, 0, 0.7071067811865476], \"translation\": [5, 0, "
        "0]}, "
        "{\"name\": \"Lamp\", \"translation\": [1, 2, 3], \"extensions\": {\"KHR_lights_punctual\": {\"light\": 0}}}], "
        "\"cameras\": [{\"perspective\": {\"yfov\": 0.5, \"aspectRatio\": 2}}, {\"orthographic\": {\"xmag\": 1.5, "
        "\"ymag\": 1, \"znear\": 0, \"zfar\": 9}}], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": "
        "\"point\", \"intensity\": 543.5141306588226}]}}, \"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}");
    const Scene *scene = made.fixture.scene;
    assert_int_equal(scene->n_cameras, 2);
    assert_says(&made, "camera camera_view { from = <0, 0, 400>  to = <0, 0, 50>  fov = 54.11 }");
    assert_says(&made, "camera side { projection = orthographic  from = <500, 0, 0>  to = <50, 0, 0>  width = 300 }");
    assert_says(&made,
                "light lamp { shape = sphere  from = <100, 200, 300>  radius = 2  power = 10  visible = false }");
    assert_int_equal(scene->n_lights, 1);
    made_clear(&made);
}

static void what_is_left_out_is_told(void **state)
{
    (void)state;
    Made made;
    import_text(&made, HEAD
                "\"nodes\": [{\"mesh\": 0, \"extensions\": {\"EXT_mesh_gpu_instancing\": {}}}], \"skins\": [{}], "
                "\"materials\": [{\"name\": \"Skin\", \"extensions\": {\"KHR_materials_unlit\": {}, "
                "\"KHR_materials_pbrSpecularGlossiness\": {}, \"EXT_own\": 3}}], \"meshes\": [{\"primitives\": [" CLOSED
                ", \"material\": 0}, {\"mode\": 1, \"attributes\": {\"POSITION\": 0}}]}], " BUFFERS "}");
    assert_notes(&made, "material 'Skin': what it says by KHR_materials_pbrSpecularGlossiness, EXT_own is not taken");
    assert_notes(&made, "what moves in the file");
    assert_notes(&made, "its points and lines");
    assert_notes(&made, "EXT_mesh_gpu_instancing");
    made_clear(&made);
}

static void what_vertices_and_faces_have_besides_is_told_of(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
        const char *note; /* NULL: none */
    } cases[] = {
        {"model.obj", "v 0 0 0 1 .5 0\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\n", "colours of vertices are not taken"},
        {"model.obj", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n", NULL},
        {"model.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n",
         "colours of vertices are not taken"},
        {"model.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face "
         "1\n"
         "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
         "3 0 1 2 6 0 0 1 0 0 1\n",
         "texture coordinates of faces are not taken"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Made made;
        import_only(&made, cases[i].name, cases[i].text);
        if (cases[i].note)
            assert_notes(&made, cases[i].note);
        else
            assert_null(strstr(made.text, "not taken"));
        made_clear(&made);
    }
}

static void one_wrap_in_place_of_two_is_told(void **state)
{
    (void)state;
    write_bytes(in_folder("a.png"), "", 0);
    for (int alike = 0; alike < 2; alike++) { /* repeated is what is not said */
        Buf text = {0};
        buf_format(&text,
                   HEAD "\"nodes\": [{\"mesh\": 0}], \"meshes\": [{\"primitives\": [" CLOSED ", \"material\": 0}]}], "
                        "\"materials\": [{\"pbrMetallicRoughness\": {\"baseColorTexture\": {\"index\": 0}}}], "
                        "\"textures\": [{\"source\": 0, \"sampler\": 0}], \"images\": [{\"uri\": \"a.png\"}], "
                        "\"samplers\": [{\"wrapS\": 33071, \"wrapT\": %d}], " BUFFERS "}",
                   alike ? 33071 : 10497);
        Made made;
        import_only(&made, "model.gltf", buf_text(&text));
        assert_says(&made, "wrap = clamp");
        if (alike)
            assert_null(strstr(buf_text(&made.import.text), "beyond its edges"));
        else
            assert_notes(&made, "beyond its edges its picture goes on in another way upwards than to the sides");
        made_clear(&made);
        buf_clear(&text);
    }
}

static void a_file_with_very_many_materials_is_read_in_part(void **state)
{
    (void)state;
    Buf text = {0};
    buf_add(&text,
            HEAD "\"nodes\": [{\"mesh\": 0}], \"meshes\": [{\"primitives\": [" CLOSED "}]}], \"materials\": [{}");
    for (int i = 0; i < 5000; i++) buf_add(&text, ", {}");
    buf_add(&text, "], " BUFFERS "}");
    Made made;
    import_text(&made, buf_text(&text));
    assert_notes(&made, "it has more materials than are read");
    made_clear(&made);
    buf_clear(&text);
}

static void long_descriptions_are_whole(void **state)
{
    (void)state;
    static const char *const keys[] = {"clearcoatTexture", "clearcoatRoughnessTexture", "clearcoatNormalTexture"};
    Buf text = {0};
    char name[101] = {0};
    memset(name, 'n', sizeof name - 1);
    buf_add(&text, LOOK(", \"baseColorTexture\": {\"index\": 0}, \"metallicRoughnessTexture\": {\"index\": 0}"));
    buf_add(&text, ", \"normalTexture\": {\"index\": 0}, \"emissiveTexture\": {\"index\": 0}, \"extensions\": {"
                   "\"KHR_materials_sheen\": {\"sheenColorTexture\": {\"index\": 0}}, "
                   "\"KHR_materials_iridescence\": {\"iridescenceTexture\": {\"index\": 0}, "
                   "\"iridescenceThicknessTexture\": {\"index\": 0}}, "
                   "\"KHR_materials_anisotropy\": {\"anisotropyTexture\": {\"index\": 0}}, "
                   "\"KHR_materials_clearcoat\": {");
    for (size_t i = 0; i < COUNT_OF(keys); i++) buf_format(&text, "%s\"%s\": {\"index\": 0}", i ? ", " : "", keys[i]);
    buf_format(&text, "}}}], \"textures\": [{\"source\": 0}], \"images\": [{\"uri\": \"%s\"}", name);
    Made made;
    import_material(&made, CLOSED, buf_text(&text));
    const char *at = made.text;
    size_t n = 0;
    while ((at = strstr(at, name)) != NULL) n++, at += sizeof name - 1;
    assert_int_equal(n, 11);
    made_clear(&made);
    buf_clear(&text);
}

static void lights_beyond_all_measure_are_left_out(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"0, 0, 0", "\"type\": \"point\", \"intensity\": 1e300"},
        {"0, 0, 0", "\"type\": \"directional\", \"intensity\": 1e300"},
        {"0, 0, 0", "\"type\": \"spot\", \"intensity\": 10, \"color\": [1e300, 0, 0]"},
        {"0, 0, 0", "\"type\": \"spot\", \"spot\": {\"outerConeAngle\": 1e-9}"},
        {"1e20, 0, 0", "\"type\": \"point\""},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Buf text = {0};
        buf_format(&text,
                   HEAD "\"nodes\": [{\"mesh\": 0}, {\"translation\": [%s], \"extensions\": {\"KHR_lights_punctual\": "
                        "{\"light\": 0}}}], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{%s}]}}, "
                        "\"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}",
                   cases[i][0], cases[i][1]);
        Made made;
        import_text(&made, buf_text(&text));
        assert_notes(&made, "too far away, too narrow or too bright");
        made_clear(&made);
        buf_clear(&text);
    }
}

static void cameras_see_something(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"\"perspective\": {\"yfov\": 1e-9}", "fov = 0.01 "},
        {"\"perspective\": {\"yfov\": 3.14159}", "fov = 179 "},
        {"\"perspective\": {\"yfov\": 3.14, \"aspectRatio\": 1e30}", "fov = 179 "},
        {"\"orthographic\": {\"xmag\": 1e30, \"ymag\": 1}", "width = 1"},
        {"\"orthographic\": {\"xmag\": 1e-30, \"ymag\": 1}", "width = 0.01 "},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Buf text = {0};
        buf_format(&text,
                   HEAD "\"nodes\": [{\"mesh\": 0}, {\"translation\": [0.2, 0.3, 5], \"camera\": 0}], \"cameras\": "
                        "[{%s}], \"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}",
                   cases[i][0]);
        Made made;
        import_text(&made, buf_text(&text));
        assert_says(&made, cases[i][1]);
        made_clear(&made);
        buf_clear(&text);
    }
}

/* A lamp on a camera, as rigs have it. */
static void a_spot_is_not_where_a_camera_is(void **state)
{
    (void)state;
    Made made;
    import_text(&made,
                HEAD "\"nodes\": [{\"mesh\": 0}, {\"translation\": [0.25, 0.25, 5], \"camera\": 0, \"extensions\": "
                     "{\"KHR_lights_punctual\": {\"light\": 0}}}], \"cameras\": [{\"perspective\": {\"yfov\": 0.5}}], "
                     "\"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"spot\", \"intensity\": "
                     "1000}]}}, \"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}");
    assert_says(&made, "It is moved back by its radius");
    assert_says(&made, "shape = disc  from = <25, 25, 502>");
    assert_says(&made, "A spot of 18.4 W in Blender");
    made_clear(&made);
}

/* 100 candela at two metres. */
static void dim_lights_get_an_exposure(void **state)
{
    (void)state;
    Made made;
    import_text(
        &made, HEAD
        "\"nodes\": [{\"mesh\": 0}, {\"translation\": [0.5, 2.5, 0.5], \"extensions\": {\"KHR_lights_punctual\": "
        "{\"light\": "
        "0}}}], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"point\", \"intensity\": 100}]}}, "
        "\"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}");
    assert_says(&made, "film { exposure = 6 ");
    assert_says(&made, "environment { color = 0.0007813 }");
    assert_notes(&made, "its lights are too dim for a picture as they are");
    made_clear(&made);
    /* glass with a lamp is in a room, which it mirrors */
    import_text(
        &made,
        HEAD "\"nodes\": [{\"mesh\": 0}, {\"translation\": [0.5, 2.5, 0.5], \"extensions\": {\"KHR_lights_punctual\": "
             "{\"light\": 0}}}], \"extensions\": {\"KHR_lights_punctual\": {\"lights\": [{\"type\": \"point\", "
             "\"intensity\": 5000}]}}, \"materials\": [" LOOK("") GLASS "}}], \"meshes\": [{\"primitives\": [" CLOSED
                                                                        ", \"material\": 0}]}], " BUFFERS "}");
    assert_says(&made, "use \"std/studio.mns\" as studio");
    assert_says(&made, "studio.room { light = 0.15  rotate(y, 30) }");
    made_clear(&made);
}

static void a_file_without_light_gets_some_and_a_floor_unless_it_has_one(void **state)
{
    (void)state;
    Made made;
    import_material(&made, CLOSED, LOOK("") "}");
    assert_says(&made, "studio.sweep(100, 0.01)");
    assert_says(&made, "studio.product_lights(100)");
    made_clear(&made);
    import_text(&made,
                HEAD "\"nodes\": [{\"mesh\": 0, \"translation\": [0, 1.1, 0]}, {\"name\": \"table\", \"mesh\": 0, "
                     "\"scale\": [9, 1, 9], "
                     "\"translation\": [-2, 0, -2]}], \"meshes\": [{\"primitives\": [" CLOSED "}]}], " BUFFERS "}");
    assert_null(strstr(made.text, "studio.sweep"));
    assert_says(&made, "studio.product_lights(100)");
    made_clear(&made);
}

static void wavefront_materials_are_understood(void **state)
{
    (void)state;
    static const struct {
        const char *library, *written;
    } cases[] = {
        {"newmtl m\nKd .2 .6 .3\nNi 1.52\nd .1\n", "medium m { ior = 1.52  state = solid  tint = rgb(0.3333, 1, 0.5)"},
        {"newmtl m\nKd .8 .8 .8\nillum 7\nNs 1000\n", "medium m { ior = 1.5  state = solid }"},
        {"# Blender 4.1.0\nnewmtl m\nKd .8 .8 .8\nNi 1.45\nd 1\nTf 1 1 1\nNs 250\n",
         "surface m_boundary { roughness = 0.5 }"},
        {"newmtl m\nKd .8 .8 .8\nTf 1 1 1\nNi 1\nd 1\n", "surface m { albedo = 0.8  ior = 1.5  roughness = 0.5 }"},
        {"newmtl m\nKd .8 .6 .4\nKs 0 0 0\n", "surface m { albedo = rgb(0.8, 0.6, 0.4) }"},
        {"newmtl m\nKd .8 .6 .4\nPm 1\nPr .25\n",
         "surface m { albedo = rgb(0.8, 0.6, 0.4)  metalness = 1  roughness = 0.25 }"},
        {"newmtl m\nKd .5 .5 .5\nTr .75\n", "weight = 0.25"},
        {"newmtl m\nKe 2 1 0\nKd 0 0 0\n", "emission = rgb(1, 0.5, 0)  radiance = 2"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        write_bytes(in_folder("m.mtl"), cases[i].library, strlen(cases[i].library));
        Made made;
        import_text_as(&made, "model.obj",
                       "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 "
                       "3\nf 2 3 4\n");
        assert_says(&made, cases[i].written);
        assert_notes(&made, "a metre is assumed");
        made_clear(&made);
    }
}

static void pictures_of_wavefront_materials_stand_behind_options(void **state)
{
    (void)state;
    static const struct {
        const char *library, *written;
    } cases[] = {
        {"map_Kd a b.png", "a b.png\" }  ior"},
        {"map_Kd -s 2 2 1 -o 0.5 0.25 0 a b.png", "a b.png\"\n  translate(<-0.5, -0.25, 0>)  scale(<0.5, 0.5, 1>)"},
        {"map_Kd -s 2 -bm 1 a b.png", "a b.png\"  scale(<0.5, 1, 1>)"},
        {"map_Kd -s 1 1 1 -clamp on a b.png", "a b.png\"  wrap = clamp }"},
        {"map_Kd -new 7 a.png", "picture a.png"},
        {"map_Kd -s 1 1 1", "albedo = 0.8"},
        {"map_Kd -s 1e-300 1e-300 a b.png", "scaled or moved so far"},
        {"map_Bump -bm 2 a b.png", "bump_height = "},
    };
    write_bytes(in_folder("a b.png"), "", 0);
    for (size_t i = 0; i <= COUNT_OF(cases); i++) {
        bool of_blender = i == COUNT_OF(cases);
        Buf library = {0};
        buf_format(&library, "%snewmtl m\n%s\n", of_blender ? "# Blender 4.1.0\n" : "",
                   cases[of_blender ? i - 1 : i].library);
        write_bytes(in_folder("m.mtl"), library.text, library.length);
        buf_clear(&library);
        Made made;
        import_only(&made, "model.obj", "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 3 2\n");
        assert_says(&made, of_blender ? "normal_strength = 2" : cases[i].written); /* whose bumps are normals */
        made_clear(&made);
    }
}

static void what_has_no_place_in_a_material_is_told_of(void **state)
{
    (void)state;
    static const struct {
        const char *material, *note;
    } cases[] = {
        {"{\"name\": \"Stuff\", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}}}",
         "metal lets no light through: of its transmission 0 is left, as metallicFactor is 1 where the file does not "
         "say it"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, "
                  "\"KHR_materials_clearcoat\": {\"clearcoatFactor\": 1}}}",
         "its coat is not taken"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, "
                  "\"KHR_materials_specular\": {\"specularFactor\": 0.5}}}",
         "its specular is not taken"},
        {"{\"name\": \"Stuff\", \"pbrMetallicRoughness\": {\"metallicFactor\": 0, \"roughnessFactor\": 0.3}, "
         "\"extensions\": "
         "{\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, "
         "\"KHR_materials_iridescence\": {\"iridescenceFactor\": 1}}}",
         "its iridescence is not taken"},
        {LOOK("") ", \"extensions\": {\"KHR_materials_transmission\": {\"transmissionFactor\": 1}, "
                  "\"KHR_materials_iridescence\": {\"iridescenceFactor\": 0.5}}}",
         "its iridescence is taken whole"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Made made;
        import_material(&made, CLOSED, cases[i].material);
        assert_notes(&made, cases[i].note);
        made_clear(&made);
    }
}

/* Several names, one with blanks, and what is told of where one is not there, or describes nothing. */
static void libraries_that_are_not_there_are_told_of(void **state)
{
    (void)state;
    static const struct {
        const char *line, *lost, *plain;
    } cases[] = {{"a.mtl b.mtl", NULL, NULL},
                 {"c d.mtl", NULL, "material red is described nowhere"},
                 {"a.mtl x.mtl", "materials x.mtl is not beside it", "material blue is described nowhere"},
                 {"e f.mtl", "materials e f.mtl is not beside it", "material red and 1 more are described nowhere"}};
    const char *const red = "newmtl red\nKd 1 0 0\n", *const blue = "newmtl blue\nKd 0 0 1\n";
    write_bytes(in_folder("a.mtl"), red, strlen(red));
    write_bytes(in_folder("b.mtl"), blue, strlen(blue));
    write_bytes(in_folder("c d.mtl"), blue, strlen(blue));
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Made made;
        char text[300];
        snprintf(text, sizeof text,
                 "mtllib %s\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nusemtl blue\nf 1 4 3\n"
                 "f 2 3 4\n",
                 cases[i].line);
        import_text_as(&made, "model.obj", text);
        assert_notes(&made, cases[i].lost ? cases[i].lost : "a metre is assumed");
        if (cases[i].plain) assert_notes(&made, cases[i].plain);
        assert_int_equal(made.import.n_notes, 1 + (cases[i].lost != NULL) + (cases[i].plain != NULL));
        made_clear(&made);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_pictures_stay_in_their_comments),
        cmocka_unit_test(clear_materials_fill_closed_meshes),
        cmocka_unit_test(opaque_materials_become_surfaces),
        cmocka_unit_test(names_are_made_valid_and_parts_are_exact),
        cmocka_unit_test(whatever_a_material_says_a_scene_comes_of_it),
        cmocka_unit_test(lights_and_cameras_stand_where_the_file_has_them),
        cmocka_unit_test(what_is_left_out_is_told),
        cmocka_unit_test(one_wrap_in_place_of_two_is_told),
        cmocka_unit_test(what_vertices_and_faces_have_besides_is_told_of),
        cmocka_unit_test(a_file_with_very_many_materials_is_read_in_part),
        cmocka_unit_test(long_descriptions_are_whole),
        cmocka_unit_test(lights_beyond_all_measure_are_left_out),
        cmocka_unit_test(cameras_see_something),
        cmocka_unit_test(a_spot_is_not_where_a_camera_is),
        cmocka_unit_test(dim_lights_get_an_exposure),
        cmocka_unit_test(a_file_without_light_gets_some_and_a_floor_unless_it_has_one),
        cmocka_unit_test(wavefront_materials_are_understood),
        cmocka_unit_test(pictures_of_wavefront_materials_stand_behind_options),
        cmocka_unit_test(libraries_that_are_not_there_are_told_of),
        cmocka_unit_test(what_has_no_place_in_a_material_is_told_of),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
