/* gltf_materials.c - what the materials of a glTF file say. Only to be told: a scene gives its own surfaces and media.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "mesh/gltf_data.h"

/* A number within objects that lie in each other, and what it says. */
static const struct {
    const char *outer, *inner, *number, *what;
} rows[] = {
    {"pbrMetallicRoughness", NULL, "metallicFactor", "metal"},
    {"pbrMetallicRoughness", NULL, "roughnessFactor", "roughness"},
    {"extensions", "KHR_materials_transmission", "transmissionFactor", "transmission"},
    {"extensions", "KHR_materials_ior", "ior", "index"},
    {"extensions", "KHR_materials_volume", "thicknessFactor", "thickness"},
    {"extensions", "KHR_materials_emissive_strength", "emissiveStrength", "emission"},
};

static void add_text(Buf *said, const char *what)
{
    buf_format(said, "%s%s", said->length ? ", " : "", what);
}

static void add_color(Buf *said, const char *what, const json_t *list)
{
    if (json_array_size(list) < 3) return;
    add_text(said, what);
    for (size_t i = 0; i < 3; i++) buf_format(said, " %.3g", json_number_value(json_array_get(list, i)));
    if (json_array_size(list) > 3 && json_number_value(json_array_get(list, 3)) < 1)
        buf_format(said, ", opacity %.3g", json_number_value(json_array_get(list, 3)));
}

/* The item of a list of the file that a number in an object stands for; NULL: none. */
static const json_t *item_of(const Gltf *gltf, const json_t *holder, const char *key, const char *list)
{
    const json_t *number = json_object_get(holder, key);
    json_int_t i = json_integer_value(number);
    return json_is_integer(number) && i >= 0 ? json_array_get(json_object_get(gltf->root, list), (size_t)i) : NULL;
}

static void add_picture(const Gltf *gltf, const json_t *texture_info, Buf *said)
{
    if (!json_is_object(texture_info)) return;
    const json_t *image = item_of(gltf, item_of(gltf, texture_info, "index", "textures"), "source", "images");
    const char *uri = json_string_value(json_object_get(image, "uri"));
    add_text(said, "picture ");
    if (uri && strncmp(uri, "data:", 5) != 0)
        buf_format(said, "%.200s", uri);
    else
        buf_add(said, "within the file");
}

static void list_material(const Gltf *gltf, const json_t *material, MeshSource *source)
{
    Buf said = {0};
    const char *name = json_string_value(json_object_get(material, "name"));
    const json_t *look = json_object_get(material, "pbrMetallicRoughness"),
                 *extensions = json_object_get(material, "extensions"),
                 *volume = json_object_get(extensions, "KHR_materials_volume");
    add_color(&said, "base colour", json_object_get(look, "baseColorFactor"));
    add_picture(gltf, json_object_get(look, "baseColorTexture"), &said);
    add_color(&said, "attenuation", json_object_get(volume, "attenuationColor"));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const json_t *holder = json_object_get(material, rows[i].outer);
        if (rows[i].inner) holder = json_object_get(holder, rows[i].inner);
        const json_t *number = json_object_get(holder, rows[i].number);
        if (!json_is_number(number)) continue;
        add_text(&said, rows[i].what);
        buf_format(&said, " %.3g", json_number_value(number));
    }
    if (said.length) mesh_source_material(source, name ? name : "", name ? strlen(name) : 0, strdup(buf_text(&said)));
    buf_clear(&said);
}

void gltf_list_materials(const Gltf *gltf, MeshSource *source)
{
    const json_t *materials = json_object_get(gltf->root, "materials");
    for (size_t i = 0; i < json_array_size(materials); i++) list_material(gltf, json_array_get(materials, i), source);
}
