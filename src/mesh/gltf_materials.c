/* gltf_materials.c - what the materials of a glTF file say, by the rows of material.def, and its images.
 * What is not made as it should be counts as not said: the triangles are there all the same.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/gltf_data.h"

/* The object that a row's member is in; NULL: it is not there. */
static const json_t *holder_of(const json_t *material, const MaterialRow *row)
{
    const json_t *holder = row->outer ? json_object_get(material, row->outer) : material;
    return row->extension ? json_object_get(holder, row->extension) : holder;
}

static void read_fact(const json_t *material, const MaterialRow *row, MeshMaterial *out)
{
    const json_t *member = json_object_get(holder_of(material, row), row->name);
    double numbers[3];
    for (int k = 0; k < row->n; k++) {
        const json_t *number = json_is_array(member) ? json_array_get(member, (size_t)(row->at + k)) : member;
        numbers[k] = json_number_value(number);
        if (!json_is_number(number) || !isfinite(numbers[k])) return;
        if (!json_is_array(member) && row->n > 1) return;
    }
    if (member) material_set(out, row, numbers);
}

/* The item of a list of the file that a number in an object stands for; NULL: none. */
static const json_t *item_of(const Gltf *gltf, const json_t *holder, const char *key, const char *list, size_t *place)
{
    return gltf_numbered(json_object_get(gltf->root, list), json_object_get(holder, key), place);
}

static void read_pair(const json_t *holder, const char *key, double pair[2])
{
    const json_t *list = json_object_get(holder, key), *first = json_array_get(list, 0),
                 *second = json_array_get(list, 1);
    if (!json_is_number(first) || !json_is_number(second)) return;
    pair[0] = json_number_value(first);
    pair[1] = json_number_value(second);
}

static PictureWrap wrap_of(const json_t *sampler, const char *key)
{
    enum { CLAMP_TO_EDGE = 33071, MIRRORED_REPEAT = 33648 };
    json_int_t code = json_integer_value(json_object_get(sampler, key));
    return code == CLAMP_TO_EDGE     ? PICTURE_WRAP_CLAMP
           : code == MIRRORED_REPEAT ? PICTURE_WRAP_MIRROR
                                     : PICTURE_WRAP_REPEAT;
}

static void read_picture(const Gltf *gltf, const json_t *material, const MaterialRow *row, MeshMaterial *out)
{
    const json_t *info = json_object_get(holder_of(material, row), row->name);
    const json_t *texture = item_of(gltf, info, "index", "textures", NULL);
    if (!json_is_object(info)) return;
    MeshPicture *picture = &out->pictures[row->key];
    size_t place = UINT32_MAX - 1; /* some picture, of which no more is known */
    const json_t *image = item_of(gltf, texture, "source", "images", &place);
    const json_t *extensions = json_object_get(texture, "extensions");
    const char *const others[] = {"EXT_texture_webp", "KHR_texture_basisu"};
    for (size_t i = 0; !image && i < COUNT_OF(others); i++)
        image = item_of(gltf, json_object_get(extensions, others[i]), "source", "images", &place);
    const char *uri = json_string_value(json_object_get(image, "uri"));
    if (uri && strncmp(uri, "data:", 5) != 0) picture->file = gltf_decode_uri(uri);
    if (!picture->file) picture->image = place < UINT32_MAX - 1 ? (uint32_t)place : UINT32_MAX - 1;
    const json_t *sampler = item_of(gltf, texture, "sampler", "samplers", NULL);
    picture->wrap = wrap_of(sampler, "wrapS");
    picture->other_wrap_upward = wrap_of(sampler, "wrapT") != picture->wrap;
    const json_t *moved = json_object_get(json_object_get(info, "extensions"), "KHR_texture_transform");
    const json_t *set = json_object_get(moved, "texCoord");
    if (!set) set = json_object_get(info, "texCoord");
    picture->second_uvs = json_integer_value(set) != 0;
    read_pair(moved, "offset", picture->offset);
    read_pair(moved, "scale", picture->scale);
    picture->turned = json_number_value(json_object_get(moved, "rotation"));
}

static bool is_known(const char *extension)
{
    const MaterialRow *row;
    for (size_t i = 0; (row = material_row(i)) != NULL; i++)
        if (row->extension && strcmp(row->extension, extension) == 0) return true;
    return strcmp(extension, "KHR_materials_unlit") == 0;
}

/* The names of those that no row is of. */
static char *unknown_of(json_t *extensions)
{
    Buf names = {0};
    const char *name;
    json_t *unused;
    json_object_foreach(extensions, name, unused) if (!is_known(name))
        buf_format(&names, "%s%s", names.length ? ", " : "", name);
    (void)unused;
    return names.text;
}

static void list_material(const Gltf *gltf, const json_t *json, MeshSource *source)
{
    const char *name = json_string_value(json_object_get(json, "name"));
    MeshMaterial material = material_new(name ? name : "", name ? strlen(name) : 0);
    const MaterialRow *row;
    for (size_t i = 0; (row = material_row(i)) != NULL; i++) {
        if (!row->name) continue;
        if (row->is_picture)
            read_picture(gltf, json, row, &material);
        else
            read_fact(json, row, &material);
    }
    memcpy(material.facts[FACT_FILTER], material.facts[FACT_BASE_COLOR], sizeof material.facts[FACT_FILTER]);
    json_t *extensions = json_object_get(json, "extensions");
    material.left_out = unknown_of(extensions);
    material.packed = true;
    material.unlit = json_object_get(extensions, "KHR_materials_unlit") != NULL;
    material.volume = json_object_get(extensions, "KHR_materials_volume") != NULL;
    const char *alpha = json_string_value(json_object_get(json, "alphaMode"));
    if (alpha && strcmp(alpha, "MASK") == 0) material.alpha = ALPHA_MASK;
    if (alpha && strcmp(alpha, "BLEND") == 0) material.alpha = ALPHA_BLEND;
    mesh_source_material(source, &material);
}

void gltf_list_materials(const Gltf *gltf, MeshSource *source)
{
    const json_t *materials = json_object_get(gltf->root, "materials");
    for (size_t i = 0; i < json_array_size(materials); i++) list_material(gltf, json_array_get(materials, i), source);
}

/* ---- images ---- */

/* The bytes of an image that is within the file; a copy, where there is still room for it. */
static void read_image(const Gltf *gltf, const json_t *json, size_t *room, MeshImage *image)
{
    const char *name = json_string_value(json_object_get(json, "name")),
               *uri = json_string_value(json_object_get(json, "uri"));
    image->name = strdup(name ? name : "");
    if (uri && strncmp(uri, "data:", 5) == 0) {
        gltf_data_uri(uri, &image->bytes, &image->length);
        return;
    }
    const unsigned char *bytes;
    size_t length;
    if (uri || !gltf_view_bytes(gltf, json, &bytes, &length) || length > *room) return;
    image->bytes = malloc(length + 1);
    if (!image->bytes) return;
    *room -= length;
    memcpy(image->bytes, bytes, length);
    image->length = length;
}

/* Those that a material has: others would only be in the way. NULL: memory ended. */
static bool *find_used(const MeshSource *source, size_t n)
{
    bool *used = calloc(n + 1, sizeof *used);
    for (size_t i = 0; used && i < source->n_materials; i++)
        for (int k = 0; k < PICTURE_COUNT; k++)
            if (source->materials[i].pictures[k].image < n) used[source->materials[i].pictures[k].image] = true;
    return used;
}

void gltf_list_images(const Gltf *gltf, MeshSource *source)
{
    enum { MOST_COPIES = 4 }; /* of the whole file; images may share their bytes, and a small file have very many */
    const json_t *images = json_object_get(gltf->root, "images");
    size_t n = json_array_size(images), room = 0;
    bool *used = find_used(source, n);
    source->images = calloc(n + 1, sizeof *source->images);
    if (source->images && used) source->n_images = n;
    for (size_t i = 0; i < gltf->n_buffers; i++) room += MOST_COPIES * gltf->buffers[i].length;
    for (size_t i = 0; i < source->n_images; i++)
        if (used[i]) read_image(gltf, json_array_get(images, i), &room, &source->images[i]);
    free(used);
}
