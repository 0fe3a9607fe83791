/* gltf_data.c - the parts of a glTF file: its JSON, through Jansson; buffers; accessors, also sparse and quantized ones.
 * Every length is held against the bytes that are there before memory is taken.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/gltf_data.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/utf8.h"

enum {
    GLB_HEADER = 12,
    GLB_CHUNK_HEADER = 8,
    GLB_JSON = 0x4e4f534a,
    GLB_BINARY = 0x004e4942,
    MAX_ITEMS = 134217728, /* of an accessor that has no bytes behind it */
    MAX_ZEROS = 16777216
};

Status gltf_fail(const Gltf *gltf, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *c = text; *c; c++)
        if ((unsigned char)*c < ' ') *c = '?';
    return fail(gltf->error, STATUS_INPUT, "'%s': %s", gltf->path, text);
}

/* ---- JSON ---- */

/* The number under the key: `missing` without one; STATUS_INPUT unless it is whole and 0 .. 2^53. */
static Status whole(const Gltf *gltf, const json_t *holder, const char *key, size_t missing, size_t *number)
{
    const json_t *item = json_object_get(holder, key);
    *number = missing;
    if (!item) return STATUS_OK;
    double value = json_number_value(item);
    if (!json_is_number(item) || !(value >= 0) || value > 9007199254740992.0 || value != floor(value))
        return gltf_fail(gltf, "'%s' is no whole number from 0 on", key);
    *number = (size_t)value;
    return STATUS_OK;
}

static Status item_numbered(const Gltf *gltf, size_t number, const char *list, const json_t **item)
{
    const json_t *items = json_object_get(gltf->root, list);
    *item = json_array_get(items, number);
    if (json_is_object(*item)) return STATUS_OK;
    return gltf_fail(gltf, "there is no number %zu of its %zu %s", number, json_array_size(items), list);
}

const json_t *gltf_numbered(const json_t *list, const json_t *number, size_t *place)
{
    json_int_t i = json_integer_value(number);
    if (!json_is_integer(number) || i < 0) return NULL;
    if (place) *place = (size_t)i;
    return json_array_get(list, (size_t)i);
}

Status gltf_item(const Gltf *gltf, const json_t *holder, const char *key, const char *list, const json_t **item)
{
    size_t number;
    TRY(whole(gltf, holder, key, SIZE_MAX, &number));
    if (number == SIZE_MAX) return gltf_fail(gltf, "'%s' is missing", key);
    return item_numbered(gltf, number, list, item);
}

Status gltf_item_at(const Gltf *gltf, const json_t *array, size_t place, const char *list, size_t *number,
                    const json_t **item)
{
    const json_t *value = json_array_get(array, place);
    if (!json_is_integer(value) || json_integer_value(value) < 0)
        return gltf_fail(gltf, "a number of one of the %s is none", list);
    *number = (size_t)json_integer_value(value);
    return item_numbered(gltf, *number, list, item);
}

/* What does not touch geometry may be there unread. */
static bool extension_is_harmless(const char *name)
{
    static const char *const starts[] = {"KHR_materials_", "KHR_texture_",  "EXT_texture_",
                                         "MSFT_texture_",  "KHR_lights_",   "EXT_lights_",
                                         "KHR_xmp",        "KHR_animation", "ADOBE_materials_"};
    for (size_t i = 0; i < COUNT_OF(starts); i++)
        if (strncmp(name, starts[i], strlen(starts[i])) == 0) return true;
    return strcmp(name, "KHR_mesh_quantization") == 0;
}

static Status check_extensions(const Gltf *gltf)
{
    const json_t *required = json_object_get(gltf->root, "extensionsRequired");
    for (size_t i = 0; i < json_array_size(required); i++) {
        const char *name = json_string_value(json_array_get(required, i));
        if (!name || extension_is_harmless(name)) continue;
        bool compressed = strstr(name, "compression") != NULL;
        return gltf_fail(gltf, "it needs the glTF extension '%s', which cannot be read; export it without %s", name,
                         compressed ? "compression" : "it");
    }
    return STATUS_OK;
}

static Status parse_json(Gltf *gltf, const char *text, size_t length)
{
    json_error_t mistake;
    gltf->root = json_loadb(text, length, 0, &mistake);
    if (!gltf->root) return gltf_fail(gltf, "line %d, column %d: %s", mistake.line, mistake.column, mistake.text);
    const json_t *asset = json_object_get(gltf->root, "asset");
    const char *version = json_string_value(json_object_get(asset, "version"));
    if (!version) return gltf_fail(gltf, "it is not a glTF file: it has no asset with a version");
    if (strncmp(version, "2.", 2) != 0) return gltf_fail(gltf, "it is of version %s of glTF; 2.0 can be read", version);
    return check_extensions(gltf);
}

/* ---- buffers ---- */

static int base64_digit(char c)
{
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' || c == '-' ? 62 : c == '/' || c == '_' ? 63 : -1;
}

/* malloc'd bytes; false when memory ended, *wrong SIZE_MAX, or at a character that is none of base64. */
static bool decode_base64(const char *text, char **bytes, size_t *n, size_t *wrong)
{
    size_t length = strlen(text);
    while (length && text[length - 1] == '=') length--;
    *wrong = SIZE_MAX;
    *n = 0;
    *bytes = malloc(length / 4 * 3 + 4);
    if (!*bytes) return false;
    uint32_t bits = 0;
    for (size_t i = 0; i < length; i++) {
        int digit = base64_digit(text[i]);
        if (digit < 0) {
            *wrong = i;
            return false;
        }
        bits = bits << 6 | (uint32_t)digit;
        if (i % 4) (*bytes)[(*n)++] = (char)(bits >> (6 - 2 * (i % 4)));
    }
    return true;
}

void gltf_data_uri(const char *uri, char **bytes, size_t *length)
{
    const char *comma = strstr(uri, ";base64,");
    size_t wrong;
    if (!comma || decode_base64(comma + 8, bytes, length, &wrong)) return;
    free(*bytes);
    *bytes = NULL;
}

static Status decode_buffer(const Gltf *gltf, const char *text, GltfBuffer *buffer)
{
    size_t wrong;
    if (!decode_base64(text, &buffer->owned, &buffer->length, &wrong))
        return wrong == SIZE_MAX ? fail_memory(gltf->error, strlen(text), "a glTF buffer")
                                 : gltf_fail(gltf, "a buffer's base64 text has a wrong character, number %zu", wrong);
    buffer->bytes = (const unsigned char *)buffer->owned;
    return STATUS_OK;
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

char *gltf_decode_uri(const char *uri)
{
    char *path = malloc(strlen(uri) + 1), *to = path;
    if (!path) return NULL;
    for (const char *from = uri; *from; from++) {
        bool escaped = from[0] == '%' && hex_digit(from[1]) >= 0 && hex_digit(from[2]) >= 0;
        *to++ = escaped ? (char)(hex_digit(from[1]) * 16 + hex_digit(from[2])) : *from;
        if (escaped) from += 2;
    }
    *to = 0;
    return path;
}

/* A file beside the scene's, or in a folder there: never one elsewhere, whatever the name says. */
static Status read_beside(const Gltf *gltf, const char *uri, GltfBuffer *buffer)
{
    char *folder = file_folder(gltf->path), *name = gltf_decode_uri(uri);
    size_t room = (folder ? strlen(folder) : 0) + (name ? strlen(name) : 0) + 1;
    char *path = folder && name ? malloc(room) : NULL;
    if (path) {
        memcpy(path, folder, strlen(folder));
        memcpy(path + strlen(folder), name, strlen(name) + 1);
    }
    free(name);
    if (!path) {
        free(folder);
        return fail_memory(gltf->error, room, "a path");
    }
    Status status;
    if (strstr(uri, "://"))
        status = gltf_fail(gltf, "its buffer '%.100s' is not a file", uri);
    else if (!file_exists(path))
        status = gltf_fail(gltf, "there is no file '%.200s', which has its numbers", path);
    else if (!file_lies_in(path, folder))
        status = gltf_fail(gltf, "its buffer '%.100s' lies outside of its folder", uri);
    else if (file_kind(path) != FILE_REGULAR)
        status = gltf_fail(gltf, "its buffer '%.100s' is not a regular file", uri);
    else
        status = file_read(path, 0, &buffer->owned, &buffer->length, gltf->error);
    if (status == STATUS_OK) buffer->bytes = (const unsigned char *)buffer->owned;
    free(path);
    free(folder);
    return status;
}

static Status load_buffers(Gltf *gltf, const unsigned char *binary, size_t binary_length)
{
    const json_t *list = json_object_get(gltf->root, "buffers");
    gltf->n_buffers = json_array_size(list);
    gltf->buffers = calloc(gltf->n_buffers + 1, sizeof *gltf->buffers);
    if (!gltf->buffers) return fail_memory(gltf->error, gltf->n_buffers * sizeof *gltf->buffers, "glTF buffers");
    for (size_t i = 0; i < gltf->n_buffers; i++) {
        GltfBuffer *buffer = &gltf->buffers[i];
        const json_t *item = json_array_get(list, i);
        const char *uri = json_string_value(json_object_get(item, "uri"));
        size_t length;
        TRY(whole(gltf, item, "byteLength", 0, &length));
        if (!uri && i == 0 && binary) {
            buffer->bytes = binary;
            buffer->length = binary_length;
        } else if (!uri) {
            continue; /* of an extension; whoever uses it finds it empty */
        } else if (strncmp(uri, "data:", 5) == 0) {
            const char *comma = strstr(uri, ";base64,");
            if (!comma) return gltf_fail(gltf, "buffer %zu is written in a way other than base64", i);
            TRY(decode_buffer(gltf, comma + 8, buffer));
        } else {
            TRY(read_beside(gltf, uri, buffer));
        }
        if (length > buffer->length)
            return gltf_fail(gltf, "buffer %zu should have %zu bytes and has %zu", i, length, buffer->length);
        buffer->length = length;
    }
    return STATUS_OK;
}

static Status open_binary(Gltf *gltf)
{
    const unsigned char *bytes = (const unsigned char *)gltf->file, *binary = NULL;
    size_t binary_length = 0, length = load_le32(bytes + 8), at = GLB_HEADER;
    if (load_le32(bytes + 4) != 2)
        return gltf_fail(gltf, "it is of version %lu of GLB; 2 can be read", (unsigned long)load_le32(bytes + 4));
    if (length > gltf->file_length)
        return gltf_fail(gltf, "it should have %zu bytes and has %zu", length, gltf->file_length);
    for (int chunk = 0; at + GLB_CHUNK_HEADER <= length; chunk++) {
        size_t n = load_le32(bytes + at);
        uint32_t kind = load_le32(bytes + at + 4);
        at += GLB_CHUNK_HEADER;
        if (n > length - at)
            return gltf_fail(gltf, "its chunk %d should have %zu bytes, and there are %zu", chunk, n, length - at);
        if (chunk == 0 && kind != GLB_JSON) break;
        if (chunk == 0) TRY(parse_json(gltf, gltf->file + at, n));
        if (chunk == 1 && kind == GLB_BINARY) {
            binary = bytes + at;
            binary_length = n;
        }
        at += n;
    }
    if (!gltf->root) return gltf_fail(gltf, "its first chunk is not JSON");
    return load_buffers(gltf, binary, binary_length);
}

Status gltf_open(Gltf *gltf)
{
    TRY(file_read(gltf->path, 0, &gltf->file, &gltf->file_length, gltf->error));
    if (gltf->file_length >= GLB_HEADER && memcmp(gltf->file, "glTF", 4) == 0) return open_binary(gltf);
    size_t mark = utf8_mark_length(gltf->file, gltf->file_length);
    TRY(parse_json(gltf, gltf->file + mark, gltf->file_length - mark));
    return load_buffers(gltf, NULL, 0);
}

void gltf_close(Gltf *gltf)
{
    for (size_t i = 0; gltf->buffers && i < gltf->n_buffers; i++) free(gltf->buffers[i].owned);
    free(gltf->buffers);
    free(gltf->file);
    json_decref(gltf->root);
}

/* ---- accessors ---- */

static const struct {
    size_t code, size;
    double whole; /* the largest, for numbers that stand for fractions */
} components[] = {{5120, 1, 127},   {5121, 1, 255},          {5122, 2, 32767},
                  {5123, 2, 65535}, {5125, 4, 4294967295.0}, {5126, 4, 1}};

/* A stretch of equal items in a buffer. */
typedef struct Items {
    const unsigned char *at; /* NULL: all zeros */
    size_t count, stride, component_size, component_code;
    int n;        /* components of an item */
    double whole; /* of a normalized one; 0 otherwise */
} Items;

bool gltf_view_bytes(const Gltf *gltf, const json_t *holder, const unsigned char **bytes, size_t *length)
{
    Gltf quiet = *gltf; /* that one is missing is no failure of the whole */
    Error unused;
    quiet.error = &unused;
    const json_t *view = NULL;
    size_t offset, number;
    if (gltf_item(&quiet, holder, "bufferView", "bufferViews", &view) != STATUS_OK ||
        whole(&quiet, view, "byteOffset", 0, &offset) != STATUS_OK ||
        whole(&quiet, view, "byteLength", 0, length) != STATUS_OK ||
        whole(&quiet, view, "buffer", SIZE_MAX, &number) != STATUS_OK || number >= gltf->n_buffers)
        return false;
    const GltfBuffer *buffer = &gltf->buffers[number];
    if (!buffer->bytes || offset > buffer->length || *length > buffer->length - offset) return false;
    *bytes = buffer->bytes + offset;
    return true;
}

/* Where the items are: held against the buffer view and the buffer. */
static Status find_items(const Gltf *gltf, const json_t *holder, const json_t *accessor, int n, size_t count,
                         Items *items)
{
    size_t code, offset, view_offset, view_length, buffer_number;
    TRY(whole(gltf, holder, "componentType", 0, &code));
    *items = (Items){.count = count, .n = n, .component_code = code};
    for (size_t i = 0; i < COUNT_OF(components); i++)
        if (components[i].code == code) {
            items->component_size = components[i].size;
            items->whole = json_is_true(json_object_get(accessor, "normalized")) ? components[i].whole : 0;
        }
    if (!items->component_size) return gltf_fail(gltf, "an accessor's componentType is %zu, which is unknown", code);
    if (!json_object_get(holder, "bufferView")) return STATUS_OK;
    const json_t *view, *list = json_object_get(gltf->root, "buffers");
    TRY(gltf_item(gltf, holder, "bufferView", "bufferViews", &view));
    TRY(whole(gltf, holder, "byteOffset", 0, &offset));
    TRY(whole(gltf, view, "byteOffset", 0, &view_offset));
    TRY(whole(gltf, view, "byteLength", 0, &view_length));
    size_t item_size = items->component_size * (size_t)n;
    TRY(whole(gltf, view, "byteStride", item_size, &items->stride));
    TRY(whole(gltf, view, "buffer", SIZE_MAX, &buffer_number));
    if (buffer_number >= gltf->n_buffers)
        return gltf_fail(gltf, "there is no number %zu of its %zu buffers", buffer_number, json_array_size(list));
    const GltfBuffer *buffer = &gltf->buffers[buffer_number];
    if (view_offset > buffer->length || view_length > buffer->length - view_offset)
        return gltf_fail(gltf, "a buffer view ends at byte %zu + %zu, and buffer %zu has %zu", view_offset, view_length,
                         buffer_number, buffer->length);
    if (items->stride < item_size || items->stride > 65535)
        return gltf_fail(gltf, "a buffer view's byteStride is %zu, for items of %zu bytes", items->stride, item_size);
    if (count > 0 && (offset > view_length || item_size > view_length - offset ||
                      (count - 1) > (view_length - offset - item_size) / items->stride))
        return gltf_fail(gltf, "an accessor of %zu items of %zu bytes does not fit a buffer view of %zu", count,
                         item_size, view_length);
    items->at = buffer->bytes + view_offset + offset;
    return STATUS_OK;
}

static double component(const Items *items, size_t item, int k)
{
    if (!items->at) return 0;
    const unsigned char *b = items->at + item * items->stride + (size_t)k * items->component_size;
    double value = 0;
    float real;
    uint32_t bits;
    switch (items->component_code) {
    case 5120: value = (signed char)b[0]; break;
    case 5121: value = b[0]; break;
    case 5122: value = (int16_t)(b[0] | b[1] << 8); break;
    case 5123: value = b[0] | b[1] << 8; break;
    case 5125: return (double)load_le32(b);
    default:
        bits = load_le32(b);
        memcpy(&real, &bits, sizeof real);
        return (double)real;
    }
    return items->whole > 0 ? fmax(value / items->whole, -1) : value;
}

/* The accessor's own items, and the indices and values of those that stand in for some of them. */
typedef struct Accessor {
    Items items, sparse_indices, sparse_values; /* sparse ones: count 0 without */
} Accessor;

static Status find_accessor(const Gltf *gltf, const json_t *holder, const char *key, int n, Accessor *accessor)
{
    const json_t *json = NULL;
    size_t count;
    *accessor = (Accessor){0};
    TRY(gltf_item(gltf, holder, key, "accessors", &json));
    TRY(whole(gltf, json, "count", 0, &count));
    const char *type = json_string_value(json_object_get(json, "type")), *wanted = n == 1   ? "SCALAR"
                                                                                   : n == 2 ? "VEC2"
                                                                                            : "VEC3";
    if (!type || strcmp(type, wanted) != 0)
        return gltf_fail(gltf, "the accessor of %s is of type %s, not %s", key, type ? type : "none", wanted);
    TRY(find_items(gltf, json, json, n, count, &accessor->items));
    if (count > (accessor->items.at ? MAX_ITEMS : MAX_ZEROS))
        return gltf_fail(gltf, "an accessor of %zu items is too large", count);
    const json_t *sparse = json_object_get(json, "sparse");
    if (!sparse) return STATUS_OK;
    TRY(whole(gltf, sparse, "count", 0, &count));
    const json_t *indices = json_object_get(sparse, "indices"), *values = json_object_get(sparse, "values");
    TRY(find_items(gltf, indices, indices, 1, count, &accessor->sparse_indices));
    json_t *typed = json_pack("{s:O, s:I}", "bufferView", json_object_get(values, "bufferView"), "componentType",
                              (json_int_t)accessor->items.component_code);
    if (!typed) return gltf_fail(gltf, "a sparse accessor has no values");
    if (json_object_get(values, "byteOffset"))
        json_object_set(typed, "byteOffset", json_object_get(values, "byteOffset"));
    Status status = find_items(gltf, typed, json, n, count, &accessor->sparse_values);
    json_decref(typed);
    if (status == STATUS_OK && (!accessor->sparse_indices.at || !accessor->sparse_values.at))
        return gltf_fail(gltf, "a sparse accessor has no indices or values");
    return status;
}

/* All components as doubles, one after another, through a function that stores them. */
typedef void Store(void *out, size_t at, double value);

static void store_float(void *out, size_t at, double value)
{
    ((float *)out)[at] = (float)value;
}

static void store_index(void *out, size_t at, double value)
{
    ((uint32_t *)out)[at] = (uint32_t)value;
}

static Status copy_items(const Gltf *gltf, const Accessor *accessor, void *out, Store *store)
{
    size_t n = (size_t)accessor->items.n;
    for (size_t i = 0; i < accessor->items.count; i++)
        for (size_t k = 0; k < n; k++) store(out, i * n + k, component(&accessor->items, i, (int)k));
    for (size_t i = 0; i < accessor->sparse_indices.count; i++) {
        double index = component(&accessor->sparse_indices, i, 0);
        if (!(index >= 0 && index < (double)accessor->items.count) || index != floor(index))
            return gltf_fail(gltf, "a sparse accessor sets item %g of %zu", index, accessor->items.count);
        for (size_t k = 0; k < n; k++)
            store(out, (size_t)index * n + k, component(&accessor->sparse_values, i, (int)k));
    }
    return STATUS_OK;
}

Status gltf_count_items(const Gltf *gltf, const json_t *holder, const char *key, size_t *count)
{
    const json_t *json = NULL;
    TRY(gltf_item(gltf, holder, key, "accessors", &json));
    return whole(gltf, json, "count", 0, count);
}

Status gltf_read_floats(const Gltf *gltf, const json_t *holder, const char *key, int n, float **out, size_t *count)
{
    Accessor accessor;
    TRY(find_accessor(gltf, holder, key, n, &accessor));
    *count = accessor.items.count;
    size_t n_numbers = *count * (size_t)n;
    *out = malloc((n_numbers + 1) * sizeof **out);
    if (!*out) return fail_memory(gltf->error, n_numbers * sizeof **out, "the vertices of a mesh");
    TRY(copy_items(gltf, &accessor, *out, store_float));
    for (size_t i = 0; i < n_numbers; i++)
        if (!isfinite((*out)[i])) return gltf_fail(gltf, "number %zu of %s is not finite", i, key);
    return STATUS_OK;
}

Status gltf_read_indices(const Gltf *gltf, const json_t *holder, uint32_t **out, size_t *count)
{
    Accessor accessor;
    TRY(find_accessor(gltf, holder, "indices", 1, &accessor));
    size_t code = accessor.items.component_code;
    if (code != 5121 && code != 5123 && code != 5125)
        return gltf_fail(gltf, "vertex numbers are of componentType %zu", code);
    *count = accessor.items.count;
    *out = malloc((*count + 1) * sizeof **out);
    if (!*out) return fail_memory(gltf->error, *count * sizeof **out, "the triangles of a mesh");
    return copy_items(gltf, &accessor, *out, store_index);
}
