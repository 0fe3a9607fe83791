/* mesh_file.h - meshes from files: the formats there are, and the parts that a file names.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MESH_FILE_H
#define MEN_MESH_FILE_H

#include "mesh/mesh.h"

/* Something in a file that has a name and triangles: an object, a group, a material. */
typedef struct MeshPart {
    const char *kind;
    char *name; /* owned by the source */
    uint64_t n_triangles;
} MeshPart;

/* What a file says that parts of it are made of. Nothing of it is taken, and it is kept only to be told. */
typedef struct MeshMaterial {
    char *
        name; /* "": it has none; owned by the source, as what it is said to be: "base colour 0.8 0.1 0.1, index 1.5" */
    char *said;
} MeshMaterial;

/* What is asked of a file, and what was found out about it. Starts zeroed, but for `part`. */
typedef struct MeshSource {
    const char *part; /* only triangles of parts of this name, of whatever kind; NULL: all */
    MeshPart *parts;  /* everything that the file names, in its order */
    size_t n_parts, part_capacity;
    uint32_t *table; /* of part numbers + 1, by kind and name */
    size_t table_room;
    MeshMaterial *materials; /* those that are said to be something */
    size_t n_materials, material_capacity;
    double unit_m; /* the length of the file's unit where the format says it; 0: it does not */
} MeshSource;

void mesh_source_clear(MeshSource *source);

/* Reads a file by its extension: .ply, .obj, .stl, .gltf, .glb. Polygons are fanned; vertices are welded where the
 * format splits them; normals are unit. Damaged files, indices out of range, numbers that are not finite, and parts that there
 * are not are STATUS_INPUT with the place. source may be NULL. */
ATTR_NODISCARD Status mesh_load(const char *path, MeshSource *source, Mesh **mesh, Error *error);
/* Whether files of that extension (without dot, any case) are meshes that mesh_load reads. */
bool mesh_has_reader(const char *extension);

/* Polygon File Format: binary little- and big-endian and text. A million triangles take about 20 ms. */
ATTR_NODISCARD Status mesh_load_ply(const char *path, MeshSource *source, Mesh **mesh, Error *error);
/* Wavefront OBJ: v, vn, vt, f (any polygon, negative indices); parts: o, g, usemtl. */
ATTR_NODISCARD Status mesh_load_obj(const char *path, MeshSource *source, Mesh **mesh, Error *error);
/* STL, binary (whatever its header says) and text; facet normals are passed over. Parts: the solids of a text. */
ATTR_NODISCARD Status mesh_load_stl(const char *path, MeshSource *source, Mesh **mesh, Error *error);

/* glTF 2.0, .gltf and .glb: see gltf.c. The unit is the metre. Parts: nodes (with what is below), meshes, materials. */
ATTR_NODISCARD Status mesh_load_gltf(const char *path, MeshSource *source, Mesh **mesh, Error *error);

/* For readers. How many bytes of a text to quote that stand where something else should: up to the end of the word, but not all
 * of a long one. 0: there is a blank, or the end. */
int mesh_text_shown(const char *at, const char *end);
/* A number of four bytes, the lowest first, on every machine. */
static inline uint32_t load_le32(const void *at)
{
    const unsigned char *b = at;
    return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}
/* The number of the part, new or known; UINT32_MAX when memory ends. The name is cut at 255 bytes. */
uint32_t mesh_source_part(MeshSource *source, const char *kind, const char *name, size_t length);
/* A material that is new, and what it is said to be; NULL, where memory ended, and "" are passed over. Takes the text over. */
void mesh_source_material(MeshSource *source, const char *name, size_t length, char *said);
/* What a material is said to be; NULL: nothing. */
const char *mesh_source_said(const MeshSource *source, const char *material);
/* The materials of an .mtl file, whose name stands in an OBJ file beside it; one that cannot be read has none. */
void mesh_list_mtl(const char *obj_path, const char *name, MeshSource *source);
/* Counts triangles that are of n parts (UINT32_MAX: none) and says whether they are wanted. source may be NULL. */
bool mesh_source_wants(MeshSource *source, const uint32_t *parts, size_t n, uint64_t n_triangles);
/* Why no triangle is left: no part of that name, one without triangles, or no faces at all. STATUS_INPUT. */
ATTR_NODISCARD Status mesh_source_nothing(const MeshSource *source, const char *path, Error *error);

#endif
