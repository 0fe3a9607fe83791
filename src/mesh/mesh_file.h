/* mesh_file.h - meshes from files: the formats there are, and the parts that a file names.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MESH_FILE_H
#define MEN_MESH_FILE_H

#include "mesh/material.h"
#include "mesh/mesh.h"

/* Something in a file that has triangles and a name, or a number where it has none: an object, a group, a material. */
typedef struct MeshPart {
    const char *kind;
    char *name;     /* owned by the source; "#3" of one without a name */
    size_t number;  /* among those of its kind, from 0 */
    bool by_number; /* two of one name are two */
    uint32_t asked; /* bits 1 << i: item i of what is asked for means this part */
    uint64_t n_triangles;
} MeshPart;

/* Triangles that follow each other in the mesh and are of the same parts. */
typedef struct MeshRun {
    size_t first_part; /* in run_parts */
    uint32_t n_parts;
    uint64_t n_triangles;
} MeshRun;

typedef struct MeshCamera {
    char *name; /* "": none; owned */
    Affine to_world;
    bool orthographic;
    double fov_y;         /* radians */
    double width, height; /* of orthographic: what is seen; else width over 1 is the shape of the picture, or 0 */
} MeshCamera;

typedef enum MeshLightKind { MESH_LIGHT_POINT, MESH_LIGHT_SPOT, MESH_LIGHT_DISTANT } MeshLightKind;
typedef struct MeshLight {
    char *name;      /* "": none; owned */
    Affine to_world; /* it shines along -z */
    MeshLightKind kind;
    double color[3], intensity; /* candela; lux of distant ones */
    double inner, outer;        /* of a spot, half angles in radians */
} MeshLight;

/* A picture within the file. */
typedef struct MeshImage {
    char *name, *bytes; /* owned; NULL bytes: it is not within the file, or not as it should be */
    size_t length;
} MeshImage;

typedef enum MeshLeft {
    MESH_LEFT_MOTION,
    MESH_LEFT_COLORS,
    MESH_LEFT_LINES,
    MESH_LEFT_INSTANCES,
    MESH_LEFT_MATERIALS,
    MESH_LEFT_FACE_UVS,
    MESH_LEFT_DISPERSION,
    MESH_LEFT_COUNT
} MeshLeft;

enum { MESH_MOST_ASKED = 32 };

/* A file that stays open, for others of its parts. Starts zeroed; formats that are read from end to end leave it so. */
typedef struct MeshKept {
    struct Gltf *gltf;
} MeshKept;
void mesh_kept_clear(MeshKept *kept);

/* What is asked of a file, and what was found out about it. Starts zeroed, but for `asked`, `n_asked`,
 * `kept` and `whole`. */
typedef struct MeshSource {
    /* Only triangles that are of all of these, at most MESH_MOST_ASKED: "NAME" of whatever kind, "KIND:NAME", "KIND:#NUMBER", or
     * "KIND:" for what has none of that kind. */
    const char *const *asked;
    size_t n_asked;  /* 0: all triangles */
    MeshKept *kept;  /* where a file of which a part is taken stays open; NULL: nowhere */
    bool whole;      /* runs, cameras, lights and images are wanted, too */
    MeshPart *parts; /* everything that the file names, in its order */
    size_t n_parts, part_capacity;
    uint32_t *table; /* of part numbers + 1, by kind and name */
    size_t table_room;
    MeshMaterial *materials; /* of glTF, in the order of the file; else of each name the first */
    size_t n_materials, material_capacity;
    MeshRun *runs; /* all triangles of the mesh, in its order */
    size_t n_runs, run_capacity;
    uint32_t *run_parts;
    size_t n_run_parts, run_part_capacity;
    MeshCamera *cameras;
    size_t n_cameras, camera_capacity;
    MeshLight *lights;
    size_t n_lights, light_capacity;
    MeshImage *images;
    size_t n_images;
    unsigned left_out;  /* bits 1 << MESH_LEFT_...: what else it has, of which nothing is taken */
    char *lost_library; /* the first .mtl file that it names and that is not there; owned; NULL: none */
    double unit_m;      /* the length of the file's unit where the format says it; 0: it does not */
} MeshSource;

void mesh_source_clear(MeshSource *source);

/* Reads a file by its extension: .ply, .obj, .stl, .gltf, .glb, .asc. Polygons are fanned; vertices are welded where the
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

/* glTF 2.0, .gltf and .glb: see gltf.c. The unit is the metre. Parts: nodes (with what is below), objects (nodes without what
 * is below), meshes, materials. */
ATTR_NODISCARD Status mesh_load_gltf(const char *path, MeshSource *source, Mesh **mesh, Error *error);

/* Cutting instructions of GemCad, as text: the stone that its facets enclose, see gemcad.c. The unit, about half of a stone's
 * width, is 5 mm. Its material is called 'stone', with the refractive index that the file says. */
ATTR_NODISCARD Status mesh_load_gemcad(const char *path, MeshSource *source, Mesh **mesh, Error *error);

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
/* The same of one that has a number in the file, and perhaps a name, which others may have, too. */
uint32_t mesh_source_numbered_part(MeshSource *source, const char *kind, size_t number, const char *name);
/* The part of that kind and number, if it is one that has a number in the file; NULL: there is none. */
const MeshPart *mesh_source_find_numbered(const MeshSource *source, const char *kind, size_t number);
/* A material, which is taken over and empty afterwards. */
void mesh_source_material(MeshSource *source, MeshMaterial *material);
/* The first material of that name; NULL: none. */
const MeshMaterial *mesh_source_find_material(const MeshSource *source, const char *name);
/* What is said of a part; NULL: it is no material, or there is nothing. */
const MeshMaterial *mesh_source_material_of(const MeshSource *source, const MeshPart *part);
/* The materials of an .mtl file, whose name stands in an OBJ file beside it; false: it is not there, or cannot be read. */
bool mesh_list_mtl(const char *obj_path, const char *name, MeshSource *source);
/* Counts triangles that are of n parts (UINT32_MAX: none) and says whether they are wanted; they are then the next of the mesh.
 * source may be NULL. */
bool mesh_source_wants(MeshSource *source, const uint32_t *parts, size_t n, uint64_t n_triangles);
/* Whether triangles of n parts are meant by one item of what can be asked for. */
bool mesh_parts_are(const MeshSource *source, const uint32_t *parts, size_t n, const char *asked);
/* Why no triangle is left: no part of that name, one without triangles, or no faces at all. STATUS_INPUT. */
ATTR_NODISCARD Status mesh_source_nothing(const MeshSource *source, const char *path, Error *error);

#endif
