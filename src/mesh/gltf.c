/* gltf.c - reads the triangles of glTF 2.0 scenes (Khronos Group, ISO/IEC 12113): .gltf with buffers beside or within
 * it, and .glb. The default scene, or all nodes where there is none, with the nodes' transforms applied; positions,
 * normals and the first texture coordinates, whose v counts down from a picture's upper edge there, and up from its lower one
 * here. Skins and morph targets stay as they were drawn.
 * The numbers are in gltf_data.c.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "mesh/gltf_data.h"

enum {
    MAX_DEPTH = 128,           /* of nodes within nodes */
    MAX_TRIANGLES = 268435456, /* of the whole scene; a small file can place a mesh very often */
    MODE_TRIANGLES = 4,
    MODE_STRIP = 5,
    MODE_FAN = 6
};

typedef struct Walk {
    Gltf *gltf;
    MeshSource *source;
    uint32_t
        parts[MAX_DEPTH + 3]; /* the nodes down to here, then the last one alone, mesh and material; UINT32_MAX: none */
    bool *visited;            /* nodes */
    Mesh **meshes;            /* one for each primitive that is wanted */
    size_t n_meshes, capacity;
    uint64_t n_vertices, n_triangles;
} Walk;

/* ---- transforms ---- */

static Status numbers_of(const Gltf *gltf, const json_t *list, const char *what, size_t n, double *numbers)
{
    if (json_array_size(list) != n)
        return gltf_fail(gltf, "a node's %s has %zu numbers, not %zu", what, json_array_size(list), n);
    for (size_t i = 0; i < n; i++) {
        const json_t *item = json_array_get(list, i);
        numbers[i] = json_number_value(item);
        if (!json_is_number(item) || !isfinite(numbers[i]))
            return gltf_fail(gltf, "a node's %s is not made of numbers", what);
    }
    return STATUS_OK;
}

/* A node's matrix, or its scale, then rotation, then translation. */
static Status local_transform(const Gltf *gltf, const json_t *node, Affine *out)
{
    double m[16], t[3] = {0, 0, 0}, r[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    const json_t *list = json_object_get(node, "matrix");
    if (list) {
        TRY(numbers_of(gltf, list, "matrix", 16, m));
        *out = (Affine){{{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}}, {m[12], m[13], m[14]}};
        return STATUS_OK;
    }
    if ((list = json_object_get(node, "translation"))) TRY(numbers_of(gltf, list, "translation", 3, t));
    if ((list = json_object_get(node, "rotation"))) TRY(numbers_of(gltf, list, "rotation", 4, r));
    if ((list = json_object_get(node, "scale"))) TRY(numbers_of(gltf, list, "scale", 3, s));
    double x = r[0], y = r[1], z = r[2], w = r[3], length = sqrt(x * x + y * y + z * z + w * w);
    if (!(length > 0) || !isfinite(length)) return gltf_fail(gltf, "a node's rotation is no rotation");
    x /= length;
    y /= length;
    z /= length;
    w /= length;
    *out = (Affine){{{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - w * z) * s[1], 2 * (x * z + w * y) * s[2]},
                     {2 * (x * y + w * z) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - w * x) * s[2]},
                     {2 * (x * z - w * y) * s[0], 2 * (y * z + w * x) * s[1], (1 - 2 * (x * x + y * y)) * s[2]}},
                    {t[0], t[1], t[2]}};
    return STATUS_OK;
}

/* ---- primitives ---- */

typedef struct Primitive {
    float *positions, *normals, *uvs; /* normals, uvs: NULL without */
    uint32_t *indices;                /* NULL: the vertices in order */
    size_t n_vertices, n_corners;
    int mode;
} Primitive;

static void primitive_clear(Primitive *primitive)
{
    free(primitive->positions);
    free(primitive->normals);
    free(primitive->uvs);
    free(primitive->indices);
}

static Status read_attribute(const Gltf *gltf, const json_t *attributes, const char *name, int n, size_t n_vertices,
                             float **out)
{
    size_t count;
    if (!json_object_get(attributes, name)) return STATUS_OK;
    TRY(gltf_read_floats(gltf, attributes, name, n, out, &count));
    if (count == n_vertices) return STATUS_OK;
    return gltf_fail(gltf, "a primitive has %zu positions, and %zu of %s", n_vertices, count, name);
}

static Status read_primitive(const Gltf *gltf, const json_t *json, Primitive *primitive)
{
    const json_t *attributes = json_object_get(json, "attributes");
    TRY(gltf_read_floats(gltf, attributes, "POSITION", 3, &primitive->positions, &primitive->n_vertices));
    TRY(read_attribute(gltf, attributes, "NORMAL", 3, primitive->n_vertices, &primitive->normals));
    TRY(read_attribute(gltf, attributes, "TEXCOORD_0", 2, primitive->n_vertices, &primitive->uvs));
    primitive->n_corners = primitive->n_vertices;
    if (json_object_get(json, "indices"))
        TRY(gltf_read_indices(gltf, json, &primitive->indices, &primitive->n_corners));
    for (size_t i = 0; primitive->indices && i < primitive->n_corners; i++)
        if (primitive->indices[i] >= primitive->n_vertices)
            return gltf_fail(gltf, "a primitive uses vertex %lu; there are %zu, from 0",
                             (unsigned long)primitive->indices[i], primitive->n_vertices);
    if (primitive->mode == MODE_TRIANGLES && primitive->n_corners % 3)
        return gltf_fail(gltf, "a primitive of triangles has %zu corners, which are not threes", primitive->n_corners);
    return STATUS_OK;
}

static size_t triangles_of(const Primitive *primitive)
{
    if (primitive->mode == MODE_TRIANGLES) return primitive->n_corners / 3;
    return primitive->n_corners < 3 ? 0 : primitive->n_corners - 2;
}

/* How many corners it says that it has. */
static Status count_corners(const Gltf *gltf, const json_t *json, Primitive *primitive)
{
    if (json_object_get(json, "indices")) return gltf_count_items(gltf, json, "indices", &primitive->n_corners);
    return gltf_count_items(gltf, json_object_get(json, "attributes"), "POSITION", &primitive->n_corners);
}

/* The corners of a triangle, as numbers of vertices. */
static void triangle_of(const Primitive *primitive, size_t i, uint32_t corners[3])
{
    size_t at[3] = {3 * i, 3 * i + 1, 3 * i + 2};
    if (primitive->mode == MODE_STRIP) {
        at[0] = i;
        at[1] = i + 1 + i % 2;
        at[2] = i + 2 - i % 2;
    } else if (primitive->mode == MODE_FAN) {
        at[0] = i + 1;
        at[1] = i + 2;
        at[2] = 0;
    }
    for (int k = 0; k < 3; k++) corners[k] = primitive->indices ? primitive->indices[at[k]] : (uint32_t)at[k];
}

static Vec3f vector_at(const float *numbers, size_t i)
{
    return vec3f(numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]);
}

/* A mesh without normals is flat, so that its corners are vertices of their own; where the whole file has none they are
 * left out and welded in the end. */
static Status mesh_of(const Gltf *gltf, const Primitive *primitive, Mesh **out)
{
    uint32_t n_triangles = (uint32_t)triangles_of(primitive);
    bool split = !primitive->normals;
    uint32_t n_vertices = split ? 3 * n_triangles : (uint32_t)primitive->n_vertices;
    Mesh *mesh;
    TRY(mesh_new(n_vertices, n_triangles, true, true, &mesh, gltf->error));
    for (uint32_t i = 0; i < n_triangles; i++) {
        uint32_t corners[3];
        triangle_of(primitive, i, corners);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t from = corners[k], to = split ? 3 * i + k : from;
            mesh->triangles[i][k] = to;
            mesh->positions[to] = vector_at(primitive->positions, from);
            if (primitive->normals) mesh->normals[to] = vector_at(primitive->normals, from);
            if (!primitive->uvs) continue;
            mesh->uvs[2 * (size_t)to] = primitive->uvs[2 * (size_t)from];
            mesh->uvs[2 * (size_t)to + 1] = 1 - primitive->uvs[2 * (size_t)from + 1]; /* from the lower edge */
        }
    }
    *out = mesh;
    return STATUS_OK;
}

/* Things without a name are called by their number. */
static uint32_t part_of(const Walk *walk, const char *kind, size_t number, const json_t *thing)
{
    const char *name = json_string_value(json_object_get(thing, "name"));
    return walk->source && thing ? mesh_source_numbered_part(walk->source, kind, number, name) : UINT32_MAX;
}

static void leave_out(const Walk *walk, MeshLeft what)
{
    if (walk->source) walk->source->left_out |= 1U << what;
}

static size_t number_of(const json_t *holder, const char *key)
{
    return (size_t)json_number_value(json_object_get(holder, key));
}

static Status keep_mesh(Walk *walk, const Primitive *primitive, const Affine *to_world)
{
    Gltf *gltf = walk->gltf;
    if (!ARRAY_ROOM(walk->meshes, walk->capacity, walk->n_meshes))
        return fail_memory(gltf->error, walk->n_meshes * 2 * sizeof(Mesh *), "a glTF scene");
    Mesh *mesh;
    TRY(mesh_of(gltf, primitive, &mesh));
    walk->meshes[walk->n_meshes++] = mesh;
    gltf->has_normals = gltf->has_normals || primitive->normals;
    gltf->has_uvs = gltf->has_uvs || primitive->uvs;
    walk->n_vertices += mesh->n_vertices;
    walk->n_triangles += mesh->n_triangles;
    mesh_transform(mesh, to_world);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        if (!vec3_is_finite(vec3_from_f(mesh->positions[i]))) return gltf_fail(gltf, "a vertex is at no finite place");
    return mesh_normalize_normals(mesh, gltf->error);
}

/* depth: of the part that the material is behind. */
static Status add_primitive(Walk *walk, const json_t *json, uint32_t depth, const Affine *to_world)
{
    Gltf *gltf = walk->gltf;
    const json_t *mode = json_object_get(json, "mode");
    Primitive primitive = {.mode = mode ? (int)json_integer_value(mode) : MODE_TRIANGLES};
    if (primitive.mode < MODE_TRIANGLES) {
        leave_out(walk, MESH_LEFT_LINES);
        return STATUS_OK;
    }
    if (primitive.mode > MODE_FAN) return gltf_fail(gltf, "a primitive's mode is %d, which is unknown", primitive.mode);
    const json_t *material = NULL;
    if (json_object_get(json, "material")) TRY(gltf_item(gltf, json, "material", "materials", &material));
    walk->parts[depth + 1] = part_of(walk, "material", number_of(json, "material"), material);
    const json_t *attributes = json_object_get(json, "attributes");
    if (json_object_get(attributes, "COLOR_0")) leave_out(walk, MESH_LEFT_COLORS);
    if (json_object_get(json, "targets")) leave_out(walk, MESH_LEFT_MOTION);
    TRY(count_corners(gltf, json, &primitive));
    size_t n = triangles_of(&primitive);
    if (n == 0 || !mesh_source_wants(walk->source, walk->parts, depth + 2, n)) return STATUS_OK; /* unread */
    if (n > MAX_TRIANGLES || walk->n_triangles + n > MAX_TRIANGLES)
        return gltf_fail(gltf, "more than %d triangles", MAX_TRIANGLES);
    Status status = read_primitive(gltf, json, &primitive);
    if (status == STATUS_OK) status = keep_mesh(walk, &primitive, to_world);
    primitive_clear(&primitive);
    return status;
}

/* ---- nodes ---- */

static Status add_node(Walk *walk, const json_t *list, size_t place, uint32_t depth, const Affine *parent)
{
    Gltf *gltf = walk->gltf;
    size_t number;
    const json_t *node;
    TRY(gltf_item_at(gltf, list, place, "nodes", &number, &node));
    if (depth >= MAX_DEPTH) return gltf_fail(gltf, "nodes are nested deeper than %d", MAX_DEPTH);
    if (walk->visited[number]) return gltf_fail(gltf, "node %zu stands in the scene twice", number);
    walk->visited[number] = true;
    Affine to_world;
    TRY(local_transform(gltf, node, &to_world));
    to_world = affine_compose(parent, &to_world);
    walk->parts[depth] = part_of(walk, "node", number, node);
    if (walk->source && walk->source->whole) gltf_list_views(gltf, node, &to_world, walk->source);
    if (json_object_get(json_object_get(node, "extensions"), "EXT_mesh_gpu_instancing"))
        leave_out(walk, MESH_LEFT_INSTANCES);
    if (json_object_get(node, "mesh")) {
        const json_t *mesh;
        TRY(gltf_item(gltf, node, "mesh", "meshes", &mesh));
        const json_t *primitives = json_object_get(mesh, "primitives");
        walk->parts[depth + 1] = part_of(walk, "object", number, node);
        walk->parts[depth + 2] = part_of(walk, "mesh", number_of(node, "mesh"), mesh);
        for (size_t i = 0; i < json_array_size(primitives); i++)
            TRY(add_primitive(walk, json_array_get(primitives, i), depth + 2, &to_world));
    }
    const json_t *children = json_object_get(node, "children");
    for (size_t i = 0; i < json_array_size(children); i++) TRY(add_node(walk, children, i, depth + 1, &to_world));
    return STATUS_OK;
}

/* The nodes of the scene that the file names, else of its first, else those that no other node has as a child. */
static Status root_nodes(const Gltf *gltf, json_t **roots)
{
    const json_t *scenes = json_object_get(gltf->root, "scenes"), *scene = NULL;
    if (json_object_get(gltf->root, "scene"))
        TRY(gltf_item(gltf, gltf->root, "scene", "scenes", &scene));
    else
        scene = json_array_get(scenes, 0);
    *roots = scene ? json_copy(json_object_get(scene, "nodes")) : NULL;
    if (scene) return STATUS_OK;
    const json_t *nodes = json_object_get(gltf->root, "nodes");
    size_t n = json_array_size(nodes);
    bool *is_child = calloc(n + 1, sizeof *is_child);
    *roots = json_array();
    if (!is_child || !*roots) {
        free(is_child);
        return fail_memory(gltf->error, n, "a glTF scene");
    }
    for (size_t i = 0; i < n; i++) {
        const json_t *children = json_object_get(json_array_get(nodes, i), "children");
        for (size_t k = 0; k < json_array_size(children); k++) {
            json_int_t child = json_integer_value(json_array_get(children, k));
            if (child >= 0 && (uint64_t)child < n) is_child[child] = true;
        }
    }
    for (size_t i = 0; i < n; i++)
        if (!is_child[i]) json_array_append_new(*roots, json_integer((json_int_t)i));
    free(is_child);
    return STATUS_OK;
}

static Status walk_scene(Walk *walk)
{
    json_t *roots = NULL;
    size_t n_nodes = json_array_size(json_object_get(walk->gltf->root, "nodes"));
    walk->visited = calloc(n_nodes + 1, sizeof *walk->visited);
    Status status =
        walk->visited ? root_nodes(walk->gltf, &roots) : fail_memory(walk->gltf->error, n_nodes, "a glTF scene");
    Affine identity = affine_identity();
    for (size_t i = 0; status == STATUS_OK && i < json_array_size(roots); i++)
        status = add_node(walk, roots, i, 0, &identity);
    json_decref(roots);
    return status;
}

/* One mesh of all; without what no primitive has. */
static Status join(const Walk *walk, Mesh **out)
{
    const Gltf *gltf = walk->gltf;
    Mesh *mesh;
    if (walk->n_triangles == 0) return mesh_source_nothing(walk->source, gltf->path, gltf->error);
    TRY(mesh_new((uint32_t)walk->n_vertices, (uint32_t)walk->n_triangles, gltf->has_normals, gltf->has_uvs, &mesh,
                 gltf->error));
    uint32_t vertex = 0, triangle = 0;
    for (size_t i = 0; i < walk->n_meshes; i++) {
        const Mesh *from = walk->meshes[i];
        memcpy(mesh->positions + vertex, from->positions, from->n_vertices * sizeof *from->positions);
        if (mesh->normals) memcpy(mesh->normals + vertex, from->normals, from->n_vertices * sizeof *from->normals);
        if (mesh->uvs) memcpy(mesh->uvs + 2 * (size_t)vertex, from->uvs, from->n_vertices * 2 * sizeof *from->uvs);
        for (uint32_t t = 0; t < from->n_triangles; t++, triangle++)
            for (int k = 0; k < 3; k++) mesh->triangles[triangle][k] = from->triangles[t][k] + vertex;
        vertex += from->n_vertices;
    }
    Status status = mesh_weld(mesh, NULL, gltf->error);
    if (status == STATUS_OK)
        *out = mesh;
    else
        mesh_free(mesh);
    return status;
}

static void close_file(Gltf *gltf)
{
    gltf_close(gltf);
    free(gltf->path);
    free(gltf);
}

void mesh_kept_clear(MeshKept *kept)
{
    if (kept->gltf) close_file(kept->gltf);
    kept->gltf = NULL;
}

/* The file as it was opened for another part, or newly. */
static Status open_file(const char *path, MeshKept *kept, Error *error, Gltf **out)
{
    if (kept && kept->gltf && strcmp(kept->gltf->path, path) == 0) {
        *out = kept->gltf;
        (*out)->error = error;
        (*out)->has_normals = (*out)->has_uvs = false;
        return STATUS_OK;
    }
    if (kept) mesh_kept_clear(kept);
    Gltf *gltf = calloc(1, sizeof *gltf);
    char *own_path = gltf ? strdup(path) : NULL;
    if (!own_path) {
        free(gltf);
        return fail_memory(error, strlen(path), "a glTF file");
    }
    gltf->path = own_path;
    gltf->error = error;
    Status status = gltf_open(gltf);
    *out = gltf;
    if (status != STATUS_OK) close_file(gltf);
    if (status == STATUS_OK && kept) kept->gltf = gltf;
    return status;
}

Status mesh_load_gltf(const char *path, MeshSource *source, Mesh **mesh, Error *error)
{
    Gltf *gltf = NULL;
    MeshKept *kept = source && source->n_asked ? source->kept : NULL;
    TRY(open_file(path, kept, error, &gltf));
    Walk walk = {.gltf = gltf, .source = source};
    Status status = walk_scene(&walk);
    if (status == STATUS_OK) status = join(&walk, mesh);
    if (status == STATUS_OK && source) {
        source->unit_m = 1;
        gltf_list_materials(gltf, source);
        if (source->whole) gltf_list_images(gltf, source);
        if (json_array_size(json_object_get(gltf->root, "animations")) ||
            json_array_size(json_object_get(gltf->root, "skins")))
            leave_out(&walk, MESH_LEFT_MOTION);
    }
    for (size_t i = 0; i < walk.n_meshes; i++) mesh_free(walk.meshes[i]);
    free(walk.meshes);
    free(walk.visited);
    if (!kept) close_file(gltf);
    return status;
}
