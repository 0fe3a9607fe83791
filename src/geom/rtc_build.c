/* rtc_build.c - from meshes and solids to Embree's scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geom/rtc_scene.h"

static void on_error(void *context, enum RTCError code, const char *text)
{
    RtcScene *scene = context;
    if (scene->error.status != STATUS_OK) return;
    if (code == RTC_ERROR_OUT_OF_MEMORY)
        fail(&scene->error, STATUS_NOMEM, "out of memory for Embree's hierarchy");
    else
        fail(&scene->error, STATUS_RENDER, "Embree: %s", text);
}

static bool on_memory(void *context, ssize_t bytes, bool post)
{
    RtcScene *scene = context;
    (void)post;
    atomic_fetch_add_explicit(&scene->bytes, (long long)bytes, memory_order_relaxed);
    return true;
}

typedef struct MeshUse {
    const Mesh *mesh, *mesh_end;
    uint32_t object;
} MeshUse;

static int compare_address(const void *left, const void *right)
{
    uintptr_t a = (uintptr_t)left, b = (uintptr_t)right;
    return a < b ? -1 : a > b;
}

static int compare_use(const void *left, const void *right)
{
    const MeshUse *a = left, *b = right;
    if (a->mesh != b->mesh) return compare_address(a->mesh, b->mesh);
    if (a->mesh_end != b->mesh_end) return compare_address(a->mesh_end, b->mesh_end);
    return a->object < b->object ? -1 : a->object > b->object ? 1 : 0;
}

const RtcDetail rtc_no_detail = {0};

/* Whether a map only moves, and makes larger evenly. */
static bool is_even(const Affine *map)
{
    double s = map->m[0][0];
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            if (row == column ? map->m[row][column] != s : map->m[row][column] != 0 || signbit(map->m[row][column]))
                return false;
    return s > 0;
}

/* An object's own row of details. */
static RtcDetail *detail_of(RtcPlaced *placed, Error *error)
{
    RtcDetail *detail = calloc(1, sizeof *detail);
    if (detail)
        placed->detail = detail;
    else
        fail_memory(error, sizeof *detail, "the scene's objects");
    return detail;
}

/* maps: room for those of this object, if it needs them. */
static Status place_object(RtcPlaced *placed, const RtcObject *object, RtcMaps *maps, uint32_t n_keys, uint32_t i,
                           Error *error)
{
    Affine to_local;
    *placed = (RtcPlaced){.mesh = object->mesh,
                          .solid = object->solid,
                          .detail = &rtc_no_detail,
                          .opaque = object->opaque,
                          .pass_level = RTC_NO_PASS,
                          .pass_alike = RTC_NO_PASS,
                          .place = object->to_world.t,
                          .scale = object->to_world.m[0][0]};
    if (!affine_invert(&object->to_world, &to_local))
        return fail(error, STATUS_SCENE, "the transform of object %u is singular: it has no volume", i);
    if (!is_even(&object->to_world)) {
        *maps = (RtcMaps){object->to_world, to_local};
        placed->maps = maps;
    }
    placed->mirrored = affine_determinant(&object->to_world) < 0;
    if (object->keys || object->mesh_end) {
        RtcDetail *detail = detail_of(placed, error);
        if (!detail) return STATUS_NOMEM;
        *detail = (RtcDetail){.keys = object->keys, .mesh_end = object->mesh_end};
    }
    placed->is_ball = object->solid && !placed->maps && !object->keys && object->solid->pieces[0].kind == PIECE_SPHERE;
    for (uint32_t k = 0; object->keys && k < n_keys; k++) {
        double determinant = affine_determinant(&object->keys[k]);
        if (!(determinant != 0) || !isfinite(determinant) || (determinant < 0) != placed->mirrored)
            return fail(error, STATUS_SCENE, "object %u is turned inside out while it moves", i);
    }
    return STATUS_OK;
}

static Status place_objects(RtcScene *scene, RtcDescribe *describe, const void *context, Error *error)
{
    size_t n_maps = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcObject object = describe(context, i);
        n_maps += !is_even(&object.to_world);
    }
    scene->maps = malloc((n_maps + 1) * sizeof *scene->maps);
    if (!scene->maps) return fail_memory(error, n_maps * sizeof *scene->maps, "the scene's objects");
    RtcMaps *maps = scene->maps;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcObject object = describe(context, i);
        TRY(place_object(&scene->objects[i], &object, maps, scene->n_keys, i, error));
        maps += scene->objects[i].maps != NULL;
    }
    return STATUS_OK;
}

/* World-space vertices (and turned triangles when mirrored) of a mesh that stands in one place only. */
static Status bake_mesh(RtcPlaced *placed, Error *error)
{
    const Mesh *mesh = placed->mesh;
    RtcDetail *detail = detail_of(placed, error);
    if (!detail) return STATUS_NOMEM;
    Affine to_world = rtc_first_to_world(placed);
    if (affine_is_identity(&to_world)) {
        detail->baked = mesh->positions; /* they are padded, too */
        return STATUS_OK;
    }
    size_t bytes = (size_t)mesh->n_vertices * sizeof(Vec3f) + sizeof(float); /* Embree reads 4 bytes past the end */
    detail->baked = malloc(bytes);
    detail->owns_baked = true;
    if (!detail->baked) return fail_memory(error, bytes, "a mesh");
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        detail->baked[i] = vec3f_from(affine_point(&to_world, vec3_from_f(mesh->positions[i])));
    if (!placed->mirrored) return STATUS_OK;
    bytes = (size_t)mesh->n_triangles * sizeof *detail->triangles;
    detail->triangles = malloc(bytes ? bytes : 1);
    if (!detail->triangles) return fail_memory(error, bytes, "a mesh");
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        detail->triangles[i][0] = mesh->triangles[i][0];
        detail->triangles[i][1] = mesh->triangles[i][2];
        detail->triangles[i][2] = mesh->triangles[i][1];
    }
    return STATUS_OK;
}

/* positions_end: NULL, or those at time 1. */
static RTCGeometry triangle_geometry(RtcScene *scene, const Vec3f *positions, const Vec3f *positions_end,
                                     uint32_t n_vertices, uint32_t (*triangles)[3], uint32_t n_triangles)
{
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    if (positions_end) {
        rtcSetGeometryTimeStepCount(geometry, 2);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 1, RTC_FORMAT_FLOAT3, positions_end, 0,
                                   sizeof(Vec3f), n_vertices);
    }
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0, sizeof(Vec3f),
                               n_vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles, 0, sizeof *triangles,
                               n_triangles);
    rtcSetGeometryMask(geometry, 0xffffffffU);
    rtcSetGeometryIntersectFilterFunction(geometry, rtc_filter_nearest);
    rtcSetGeometryOccludedFilterFunction(geometry, rtc_filter_any);
    rtcCommitGeometry(geometry);
    return geometry;
}

static RTCScene new_scene(RtcScene *scene)
{
    RTCScene rtc = rtcNewScene(scene->device);
    rtcSetSceneFlags(rtc, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(rtc, RTC_BUILD_QUALITY_MEDIUM); /* HIGH is ignored in robust mode */
    return rtc;
}

static void attach(RTCScene rtc, RTCGeometry geometry, uint32_t id)
{
    rtcAttachGeometryByID(rtc, geometry, id);
    rtcReleaseGeometry(geometry);
}

/* Geometry number o of the world is object o; the pieces of all solids come after them. */
static Status add_baked(RtcScene *scene, uint32_t object, Error *error)
{
    RtcPlaced *placed = &scene->objects[object];
    TRY(bake_mesh(placed, error));
    const Mesh *mesh = placed->mesh;
    uint32_t(*triangles)[3] = placed->detail->triangles ? placed->detail->triangles : mesh->triangles;
    attach(scene->world,
           triangle_geometry(scene, placed->detail->baked, NULL, mesh->n_vertices, triangles, mesh->n_triangles),
           object);
    return STATUS_OK;
}

static void set_transform(RTCGeometry instance, uint32_t step, const Affine *a)
{
    float matrix[12]; /* three columns, then the translation */
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++) matrix[3 * column + row] = (float)a->m[row][column];
    matrix[9] = (float)a->t.x;
    matrix[10] = (float)a->t.y;
    matrix[11] = (float)a->t.z;
    rtcSetGeometryTransform(instance, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
}

static void add_instances(RtcScene *scene, const MeshUse *uses, uint32_t n)
{
    const Mesh *mesh = uses[0].mesh, *end = uses[0].mesh_end;
    RTCScene shared = new_scene(scene);
    attach(shared,
           triangle_geometry(scene, mesh->positions, end ? end->positions : NULL, mesh->n_vertices, mesh->triangles,
                             mesh->n_triangles),
           0);
    rtcCommitScene(shared);
    scene->shared[scene->n_shared++] = shared;
    for (uint32_t i = 0; i < n; i++) {
        const RtcPlaced *placed = &scene->objects[uses[i].object];
        RTCGeometry instance = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, shared);
        const Affine *keys = placed->detail->keys;
        Affine to_world = rtc_first_to_world(placed);
        uint32_t n_steps = keys ? scene->n_keys : 1;
        if (n_steps > 1) rtcSetGeometryTimeStepCount(instance, n_steps);
        for (uint32_t k = 0; k < n_steps; k++) set_transform(instance, k, keys ? &keys[k] : &to_world);
        rtcSetGeometryMask(instance, 0xffffffffU);
        rtcCommitGeometry(instance);
        attach(scene->world, instance, uses[i].object);
    }
}

static Status add_meshes(RtcScene *scene, Error *error)
{
    size_t bytes = (scene->n_objects + 1U) * sizeof(MeshUse);
    MeshUse *uses = malloc(bytes);
    scene->shared = calloc(scene->n_objects + 1U, sizeof *scene->shared);
    if (!uses || !scene->shared) {
        free(uses);
        return fail_memory(error, bytes, "the scene's objects");
    }
    uint32_t n = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].mesh)
            uses[n++] = (MeshUse){scene->objects[i].mesh, scene->objects[i].detail->mesh_end, i};
    qsort(uses, n, sizeof *uses, compare_use);
    Status status = STATUS_OK;
    for (uint32_t i = 0; i < n && status == STATUS_OK;) {
        uint32_t end = i + 1;
        while (end < n && uses[end].mesh == uses[i].mesh && uses[end].mesh_end == uses[i].mesh_end) end++;
        if (end - i == 1 && !scene->objects[uses[i].object].detail->keys && !uses[i].mesh_end)
            status = add_baked(scene, uses[i].object, error);
        else
            add_instances(scene, uses + i, end - i);
        i = end;
    }
    free(uses);
    return status;
}

/* Whether a piece is hollow enough for eighths to have much smaller boxes. Not a torus: most rays into its box meet it,
 * often in several eighths, and finding all crossings anew in each costs more (487 ns a ray whole, 627 ns in eighths).
 */
static uint32_t sectors_of(const Piece *piece)
{
    if (piece->kind == PIECE_SPHERE || piece->kind == PIECE_TORUS || piece->kind == PIECE_RECT ||
        piece->kind == PIECE_PLANE)
        return 1;
    HalfBox box = piece_half_bounds(piece);
    return box.r0 > 0.3 * box.r1 ? RTC_SECTORS : 1;
}

static void count_pieces(const RtcScene *scene, size_t n[2], size_t *n_planes)
{
    n[0] = n[1] = *n_planes = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const Solid *solid = scene->objects[i].solid;
        for (uint32_t k = 0; solid && k < solid->n_pieces; k++)
            if (solid->pieces[k].kind == PIECE_PLANE)
                ++*n_planes;
            else
                n[scene->objects[i].detail->keys != NULL] += sectors_of(&solid->pieces[k]);
    }
}

static void list_pieces(RtcScene *scene)
{
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const Solid *solid = scene->objects[i].solid;
        RtcPieceSet *set = scene->objects[i].detail->keys ? &scene->moving : &scene->still;
        for (uint32_t k = 0; solid && k < solid->n_pieces; k++) {
            uint32_t n_sectors = sectors_of(&solid->pieces[k]);
            if (solid->pieces[k].kind == PIECE_PLANE)
                scene->planes[scene->n_planes++] = (RtcPiece){i, k, RTC_ALL_SECTORS};
            else if (n_sectors == 1)
                set->pieces[set->n++] = (RtcPiece){i, k, RTC_ALL_SECTORS};
            else
                for (uint32_t s = 0; s < n_sectors; s++) set->pieces[set->n++] = (RtcPiece){i, k, s};
        }
    }
}

static void add_piece_set(RtcScene *scene, RtcPieceSet *set, uint32_t id)
{
    if (!set->n) return;
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, set->n);
    if (set->moving) rtcSetGeometryTimeStepCount(geometry, scene->n_keys);
    rtcSetGeometryUserData(geometry, set);
    rtcSetGeometryMask(geometry, 0xffffffffU);
    rtcSetGeometryBoundsFunction(geometry, rtc_piece_bounds, set);
    rtcSetGeometryIntersectFunction(geometry, rtc_piece_intersect);
    rtcSetGeometryOccludedFunction(geometry, rtc_piece_occluded);
    rtcCommitGeometry(geometry);
    attach(scene->world, geometry, id);
}

static struct RTCBounds piece_box(RtcPieceSet *set, uint32_t primitive)
{
    struct RTCBounds box;
    struct RTCBoundsFunctionArguments asked = {.geometryUserPtr = set, .primID = primitive, .bounds_o = &box};
    rtc_piece_bounds(&asked);
    return box;
}

static void keep_few(RtcScene *scene)
{
    scene->n_few = scene->still.n;
    for (uint32_t i = 0; i < scene->n_few; i++) {
        struct RTCBounds box = piece_box(&scene->still, i);
        const float lower[3] = {box.lower_x, box.lower_y, box.lower_z};
        const float upper[3] = {box.upper_x, box.upper_y, box.upper_z};
        if (scene->n_few <= RTC_ALONE) {
            scene->alone[i].lower = lanes(box.lower_x, box.lower_y, box.lower_z, -INFINITY);
            scene->alone[i].upper = lanes(box.upper_x, box.upper_y, box.upper_z, INFINITY);
        }
        RtcFour *four = &scene->few[i / LANES];
        for (int axis = 0; axis < 3; axis++) {
            lanes_set(&four->lower[axis], (int)(i % LANES), lower[axis]);
            lanes_set(&four->upper[axis], (int)(i % LANES), upper[axis]);
        }
    }
}

static Status add_pieces(RtcScene *scene, Error *error)
{
    size_t n[2], n_planes;
    count_pieces(scene, n, &n_planes);
    if (n[0] + n[1] > UINT32_MAX - 1) return fail(error, STATUS_NOMEM, "%zu analytic pieces are too many", n[0] + n[1]);
    scene->pieces = malloc((n[0] + n[1] + n_planes + 1) * sizeof *scene->pieces);
    if (!scene->pieces)
        return fail_memory(error, (n[0] + n[1] + n_planes) * sizeof *scene->pieces, "the scene's solids");
    scene->still = (RtcPieceSet){.scene = scene, .pieces = scene->pieces};
    scene->moving = (RtcPieceSet){.scene = scene, .pieces = scene->pieces + n[0], .moving = true};
    scene->planes = scene->pieces + n[0] + n[1];
    list_pieces(scene);
    if (scene->still.n <= RTC_FEW)
        keep_few(scene);
    else
        add_piece_set(scene, &scene->still, scene->n_objects);
    add_piece_set(scene, &scene->moving, scene->n_objects + 1);
    return STATUS_OK;
}

/* The box of a mesh, and the one before: instances of one mesh mostly stand in a row. */
typedef struct MeshBox {
    const Mesh *mesh, *end;
    Box3 box;
} MeshBox;

static double reach_of_box(Box3 box)
{
    return fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
}

static Box3 box_of_mesh(MeshBox *known, const Mesh *mesh, const Mesh *end)
{
    if (known->mesh == mesh && known->end == end) return known->box;
    *known = (MeshBox){mesh, end, box3_empty()};
    for (uint32_t k = 0; k < mesh->n_vertices; k++) {
        known->box = box3_add_point(known->box, vec3_from_f(mesh->positions[k]));
        if (end) known->box = box3_add_point(known->box, vec3_from_f(end->positions[k]));
    }
    return known->box;
}

/* The largest coordinate of a mesh under a map, if it is beyond `reach`. Most of many instances are within: their boxes
 * show that. */
static double mesh_reach(const RtcPlaced *object, const Affine *to_world, MeshBox *known, double reach)
{
    const double rounding = 1 + 1e-12;
    const Mesh *mesh = object->mesh, *end = object->detail->mesh_end;
    if (!mesh->n_vertices) return reach;
    double most = reach_of_box(affine_box(to_world, box_of_mesh(known, mesh, end)));
    if (most * rounding < reach) return reach;
    if (is_even(to_world)) return double_max(reach, most);
    for (uint32_t k = 0; k < mesh->n_vertices; k++) {
        reach = fmax(reach, vec3_max_abs(affine_point(to_world, vec3_from_f(mesh->positions[k]))));
        if (end) reach = fmax(reach, vec3_max_abs(affine_point(to_world, vec3_from_f(end->positions[k]))));
    }
    return reach;
}

/* The largest coordinate of an object under one of its maps, if it is beyond `reach`. */
static double object_reach(const RtcPlaced *object, const Affine *to_world, MeshBox *known, double reach)
{
    if (object->mesh) reach = mesh_reach(object, to_world, known, reach);
    for (uint32_t k = 0; object->solid && k < object->solid->n_pieces; k++) {
        const Piece *piece = &object->solid->pieces[k];
        if (piece->kind == PIECE_PLANE) continue;
        reach = fmax(reach, reach_of_box(affine_box(to_world, piece_bounds(piece))));
    }
    return reach;
}

/* The largest coordinate of anything bounded; the boxes of the pieces are widened in proportion to it. */
static double find_reach(const RtcScene *scene)
{
    double reach = 0;
    MeshBox known = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const RtcPlaced *object = &scene->objects[i];
        const Affine *keys = object->detail->keys;
        Affine to_world = rtc_first_to_world(object);
        reach = object_reach(object, &to_world, &known, reach);
        for (uint32_t k = 1; keys && k < scene->n_keys; k++) reach = object_reach(object, &keys[k], &known, reach);
    }
    return reach;
}

static Box3 box_of(struct RTCBounds b)
{
    if (!(b.lower_x <= b.upper_x)) return box3_empty();
    return (Box3){vec3((double)b.lower_x, (double)b.lower_y, (double)b.lower_z),
                  vec3((double)b.upper_x, (double)b.upper_y, (double)b.upper_z)};
}

static Box3 world_bounds(RtcScene *scene)
{
    struct RTCBounds of_embree;
    rtcGetSceneBounds(scene->world, &of_embree);
    Box3 bounds = box_of(of_embree);
    for (uint32_t i = 0; i < scene->n_few; i++) bounds = box3_union(bounds, box_of(piece_box(&scene->still, i)));
    return bounds;
}

static Status build(RtcScene *scene, RtcDescribe *describe, const void *context, unsigned n_threads, Error *error)
{
    char config[64];
    snprintf(config, sizeof config, "threads=%u", n_threads);
    scene->device = rtcNewDevice(config);
    if (!scene->device)
        return fail(error, STATUS_RENDER, "Embree cannot be started (error %d)", (int)rtcGetDeviceError(NULL));
    rtcSetDeviceErrorFunction(scene->device, on_error, scene);
    rtcSetDeviceMemoryMonitorFunction(scene->device, on_memory, scene);
    TRY(place_objects(scene, describe, context, error));
    scene->reach = find_reach(scene);
    scene->world = new_scene(scene);
    TRY(add_meshes(scene, error));
    TRY(add_pieces(scene, error));
    rtcCommitScene(scene->world);
    if (scene->error.status != STATUS_OK) return fail(error, scene->error.status, "%s", scene->error.text);
    scene->bounds = world_bounds(scene);
    return STATUS_OK;
}

static RtcObject object_in_list(const void *context, uint32_t i)
{
    return ((const RtcObject *)context)[i];
}

Status rtc_scene_new(const RtcObject *objects, uint32_t n_objects, uint32_t n_keys, unsigned n_threads, RtcScene **out,
                     Error *error)
{
    return rtc_scene_new_from(object_in_list, objects, n_objects, n_keys, n_threads, out, error);
}

Status rtc_scene_new_from(RtcDescribe *describe, const void *context, uint32_t n_objects, uint32_t n_keys,
                          unsigned n_threads, RtcScene **out, Error *error)
{
    *out = NULL;
    RtcScene *scene = calloc(1, sizeof *scene);
    if (!scene) return fail_memory(error, sizeof *scene, "the scene");
    scene->n_objects = n_objects;
    scene->n_keys = n_keys;
    scene->objects = calloc(n_objects + 1U, sizeof *scene->objects);
    Status status = scene->objects ? build(scene, describe, context, n_threads, error)
                                   : fail_memory(error, n_objects * sizeof *scene->objects, "the scene's objects");
    if (status != STATUS_OK) {
        rtc_scene_free(scene);
        return status;
    }
    *out = scene;
    return STATUS_OK;
}

void rtc_scene_free(RtcScene *scene)
{
    if (!scene) return;
    if (scene->world) rtcReleaseScene(scene->world);
    for (uint32_t i = 0; i < scene->n_shared; i++) rtcReleaseScene(scene->shared[i]);
    if (scene->device) rtcReleaseDevice(scene->device);
    for (uint32_t i = 0; scene->objects && i < scene->n_objects; i++) {
        const RtcDetail *detail = scene->objects[i].detail;
        if (!detail || detail == &rtc_no_detail) continue;
        if (detail->owns_baked) free(detail->baked);
        free(detail->triangles);
        free((void *)(uintptr_t)detail);
    }
    free(scene->maps);
    free(scene->objects);
    free(scene->shared);
    free(scene->pieces);
    free(scene);
}

void rtc_set_stops(RtcScene *scene, uint32_t object, uint32_t classes)
{
    scene->objects[object].stops = classes;
}

void rtc_set_passing(RtcScene *scene, uint32_t object, uint32_t level, uint32_t alike)
{
    scene->objects[object].pass_level = level;
    scene->objects[object].pass_alike = alike;
}

Box3 rtc_scene_bounds(const RtcScene *scene)
{
    return scene->bounds;
}

size_t rtc_scene_bytes(const RtcScene *scene)
{
    long long bytes = atomic_load_explicit(&scene->bytes, memory_order_relaxed);
    return bytes > 0 ? (size_t)bytes : 0;
}

const char *rtc_library_version(void)
{
    return "Embree " RTC_VERSION_STRING;
}
