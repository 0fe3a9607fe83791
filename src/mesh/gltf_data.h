/* gltf_data.h - the JSON and the buffers of a glTF file; private to gltf*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GLTF_DATA_H
#define MEN_GLTF_DATA_H

#include <jansson.h>

#include "mesh/mesh_file.h"

typedef struct GltfBuffer {
    const unsigned char *bytes;
    size_t length;
    char *owned; /* NULL: part of the file itself */
} GltfBuffer;

typedef struct Gltf {
    char *path; /* owned */
    Error *error;
    char *file;
    size_t file_length;
    json_t *root;
    GltfBuffer *buffers;
    size_t n_buffers;
    bool has_normals, has_uvs;
} Gltf;

/* Reads the file, checks version and extensions, and loads the buffers. gltf_close after a failure, too. */
ATTR_NODISCARD Status gltf_open(Gltf *gltf);
void gltf_close(Gltf *gltf);

/* STATUS_INPUT: the path, then the text. */
Status gltf_fail(const Gltf *gltf, const char *format, ...) ATTR_PRINTF(2, 3);
/* The item of the root's list that holder[key] numbers. */
ATTR_NODISCARD Status gltf_item(const Gltf *gltf, const json_t *holder, const char *key, const char *list,
                                const json_t **item);
/* The same for the number at a place of an array. */
ATTR_NODISCARD Status gltf_item_at(const Gltf *gltf, const json_t *array, size_t place, const char *list,
                                   size_t *number, const json_t **item);
/* The item of a list that a number of the file stands for, and its place, if that is wanted; NULL: none. */
const json_t *gltf_numbered(const json_t *list, const json_t *number, size_t *place);
/* The accessor that holder[key] numbers: *count times n floats, malloc'd, finite. */
ATTR_NODISCARD Status gltf_read_floats(const Gltf *gltf, const json_t *holder, const char *key, int n, float **out,
                                       size_t *count);
/* How many items the accessor that holder[key] numbers has, with no look at these. */
ATTR_NODISCARD Status gltf_count_items(const Gltf *gltf, const json_t *holder, const char *key, size_t *count);
/* holder.indices, malloc'd. */
ATTR_NODISCARD Status gltf_read_indices(const Gltf *gltf, const json_t *holder, uint32_t **out, size_t *count);

/* The path that a URI spells, with its %20 and the like decoded; malloc'd, NULL when memory ends. */
char *gltf_decode_uri(const char *uri);
/* The bytes of a "data:" URI in base64, malloc'd; *bytes stays NULL where it is none. */
void gltf_data_uri(const char *uri, char **bytes, size_t *length);
/* The bytes of the buffer view that holder.bufferView numbers; false where it is not within its buffer. */
bool gltf_view_bytes(const Gltf *gltf, const json_t *holder, const unsigned char **bytes, size_t *length);

/* Tells the source what the file's materials say, and then which of its images they need; see gltf_materials.c. */
void gltf_list_materials(const Gltf *gltf, MeshSource *source);
void gltf_list_images(const Gltf *gltf, MeshSource *source);
/* Tells the source the camera and the light of a node, if it has them; see gltf_views.c. */
void gltf_list_views(const Gltf *gltf, const json_t *node, const Affine *to_world, MeshSource *source);

#endif
