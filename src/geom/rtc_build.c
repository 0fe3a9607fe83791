/* rtc_build.c - from meshes and solids to Embree's scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "geom/rtc_boxes.h"
#include "geom/rtc_convex.h"
#include "geom/rtc_scene.h"

/* Meshes of no more triangles than SMALL_MESH are baked even where they are placed more than once, for a ray that comes to
 * an instance has to be moved into its frame; but not if that made more triangles than MOST_BAKED. */
enum { SMALL_MESH = 64, MOST_BAKED = 1 << 18 };

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

/* Whether an object is a ball wherever it moves; sets its radius where it stands still. */
static bool is_ball(RtcPlaced *placed, uint32_t n_keys)
{
    if (placed->is_mesh || !placed->solid || placed->solid->n_pieces != 1 ||
        placed->solid->pieces[0].kind != PIECE_SPHERE)
        return false;
    for (uint32_t k = 0; placed->moves && k < n_keys; k++) /* between keys that are turned it is none */
        if (!is_even(&placed->keys[k])) return false;
    if (placed->moves) return true;
    /* rounding leaves some 1e-16 of turned ones */
    double scale = placed->mapped ? affine_even_scale(&placed->maps->to_world, 5e-15) : placed->scale;
    if (scale > 0) placed->radius = scale * placed->solid->pieces[0].r0;
    return scale > 0;
}

/* Up to here what is rounded is no more than usual; see tests/unit/embree_noise_test.c. */
#define USUAL_CONDITION 6

/* The condition number of R. D. Skeel, "Scaling for Numerical Stability in Gaussian Elimination", JACM 26(3) (1979), section 3:
 * what is rounded as coordinates go into a frame comes back as so many times that at most. 1 to 3 of a frame that is stretched
 * and then turned, more of one that is turned and then stretched. */
static double frame_rounding(const Affine *to_world, const Affine *to_local)
{
    double largest = 0;
    for (int row = 0; row < 3; row++) {
        double sum = 0;
        for (int column = 0; column < 3; column++)
            for (int k = 0; k < 3; k++) sum += fabs(to_world->m[row][k] * to_local->m[k][column]);
        largest = double_max(largest, sum);
    }
    return double_max(1, largest / USUAL_CONDITION);
}

/* maps: room for those of this object, if it needs them. */
static Status place_object(RtcPlaced *placed, const RtcObject *object, RtcMaps *maps, uint32_t n_keys, uint32_t i,
                           Error *error)
{
    Affine to_local;
    *placed = (RtcPlaced){.place = object->to_world.t,
                          .scale = object->to_world.m[0][0],
                          .solid = object->solid,
                          .frame = i,
                          .pass_level = RTC_NO_PASS,
                          .pass_alike = RTC_NO_PASS,
                          .opaque = object->opaque,
                          .hidden = object->hidden,
                          .is_mesh = object->mesh != NULL,
                          .moves = object->keys != NULL};
    if (!affine_invert(&object->to_world, &to_local))
        return fail(error, STATUS_SCENE, "the transform of object %u is singular: it has no volume", i);
    if (placed->moves) {
        placed->keys = object->keys;
    } else if (!is_even(&object->to_world)) {
        *maps = (RtcMaps){object->to_world, to_local, frame_rounding(&object->to_world, &to_local)};
        placed->maps = maps;
        placed->mapped = true;
    }
    placed->mirrored = affine_determinant(&object->to_world) < 0;
    placed->ball = is_ball(placed, n_keys);
    placed->lone = placed->ball && !placed->opaque && n_keys == 0 ? RTC_PERHAPS_LONE : RTC_NOT_LONE;
    for (uint32_t k = 0; object->keys && k < n_keys; k++) {
        double determinant = affine_determinant(&object->keys[k]);
        if (!(determinant != 0) || !isfinite(determinant) || (determinant < 0) != placed->mirrored)
            return fail(error, STATUS_SCENE, "object %u is turned inside out while it moves", i);
    }
    return STATUS_OK;
}

/* Whether two objects that stand still stand in one frame, bit by bit. */
static bool is_same_frame(const RtcPlaced *a, const RtcPlaced *b)
{
    if (a->moves || b->moves) return false;
    Affine of_a = rtc_first_to_world(a), of_b = rtc_first_to_world(b);
    return memcmp(&of_a, &of_b, sizeof of_a) == 0;
}

static Status place_objects(RtcScene *scene, RtcDescribe *describe, const void *context, Error *error)
{
    size_t n_maps = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcObject object = describe(context, i);
        n_maps += !object.keys && !is_even(&object.to_world);
    }
    scene->maps = malloc((n_maps + 1) * sizeof *scene->maps);
    if (!scene->maps) return fail_memory(error, n_maps * sizeof *scene->maps, "the scene's objects");
    RtcMaps *maps = scene->maps;
    const RtcPlaced *last = NULL; /* that has a frame: balls need none */
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcObject object = describe(context, i);
        RtcPlaced *placed = &scene->objects[i];
        TRY(place_object(placed, &object, maps, scene->n_keys, i, error));
        maps += placed->mapped;
        scene->has_hidden = scene->has_hidden || placed->hidden;
        if (placed->ball) continue;
        if (last && is_same_frame(last, placed)) placed->frame = last->frame;
        last = placed;
    }
    return STATUS_OK;
}

/* World-space vertices of a mesh that stands in one place only. */
static Status bake_mesh(const RtcPlaced *placed, RtcMesh *mesh, Error *error)
{
    const Mesh *source = mesh->source;
    Affine to_world = rtc_first_to_world(placed);
    mesh->baked = true;
    if (affine_is_identity(&to_world)) return STATUS_OK; /* the source's positions are padded, too */
    size_t bytes = (size_t)source->n_vertices * sizeof(Vec3f) + sizeof(float); /* Embree reads 4 bytes past the end */
    mesh->moved = malloc(bytes);
    if (!mesh->moved) return fail_memory(error, bytes, "a mesh");
    for (uint32_t i = 0; i < source->n_vertices; i++)
        mesh->moved[i] = vec3f_from(affine_point(&to_world, vec3_from_f(source->positions[i])));
    return STATUS_OK;
}

/* turned: the transform of a baked mesh mirrors. */
static Status make_quads(RtcMesh *mesh, bool turned, Error *error)
{
    MeshQuad *pairs;
    uint32_t n;
    TRY(mesh_pair_triangles(mesh->source, &pairs, &n, error));
    const Vec3f *positions = rtc_positions(mesh);
    mesh->quads = aligned_alloc(64, (n + (size_t)1) * sizeof *mesh->quads);
    mesh->n_quads = n;
    for (uint32_t i = 0; mesh->quads && i < n; i++) {
        RtcQuad *quad = &mesh->quads[i];
        if (turned) mesh_quad_turn(pairs[i]);
        for (int k = 0; k < 4; k++) {
            quad->vertex[k] = pairs[i][k];
            quad->corner[k] = positions[pairs[i][k]];
        }
    }
    free(pairs);
    return mesh->quads ? STATUS_OK : fail_memory(error, (n + (size_t)1) * sizeof *mesh->quads, "a mesh");
}

static RTCGeometry quad_geometry(RtcScene *scene, const RtcMesh *mesh)
{
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_QUAD);
    const Vec3f *positions[2] = {rtc_positions(mesh), mesh->end ? mesh->end->positions : NULL};
    unsigned n_times = mesh->end ? 2 : 1;
    rtcSetGeometryTimeStepCount(geometry, n_times);
    for (unsigned k = 0; k < n_times; k++)
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, k, RTC_FORMAT_FLOAT3, positions[k], 0,
                                   sizeof(Vec3f), mesh->source->n_vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, mesh->quads,
                               offsetof(RtcQuad, vertex), sizeof *mesh->quads, mesh->n_quads);
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

static void add_instances(RtcScene *scene, const RtcMesh *mesh, const MeshUse *uses, uint32_t n)
{
    RTCScene shared = new_scene(scene);
    attach(shared, quad_geometry(scene, mesh), 0);
    rtcCommitScene(shared);
    scene->shared[scene->n_shared++] = shared;
    for (uint32_t i = 0; i < n; i++) {
        const RtcPlaced *placed = &scene->objects[uses[i].object];
        RTCGeometry instance = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_INSTANCE);
        rtcSetGeometryInstancedScene(instance, shared);
        Affine first = rtc_first_to_world(placed);
        uint32_t n_steps = placed->moves ? scene->n_keys : 1;
        if (n_steps > 1) rtcSetGeometryTimeStepCount(instance, n_steps);
        for (uint32_t k = 0; k < n_steps; k++) set_transform(instance, k, k > 0 ? &placed->keys[k] : &first);
        rtcSetGeometryMask(instance, 0xffffffffU);
        rtcCommitGeometry(instance);
        attach(scene->world, instance, uses[i].object);
    }
}

/* The uses of all meshes, those of one in a row; malloc'd. */
static Status find_uses(const RtcScene *scene, RtcDescribe *describe, const void *context, MeshUse **uses, uint32_t *n,
                        Error *error)
{
    size_t bytes = (scene->n_objects + (size_t)1) * sizeof **uses; /* as if all were meshes */
    *n = 0;
    *uses = malloc(bytes);
    if (!*uses) return fail_memory(error, bytes, "the scene's objects");
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcObject object = describe(context, i);
        if (object.mesh) (*uses)[(*n)++] = (MeshUse){object.mesh, object.mesh_end, i};
    }
    qsort(*uses, *n, sizeof **uses, compare_use);
    return STATUS_OK;
}

/* How many of n >= 1 uses are of the first one's mesh: a row. */
static uint32_t row_of(const MeshUse *uses, uint32_t n)
{
    uint32_t end = 1;
    while (end < n && uses[end].mesh == uses->mesh && uses[end].mesh_end == uses->mesh_end) end++;
    return end;
}

/* Whether the n uses of a mesh stand still, and are one or of a small mesh. */
static bool may_bake(const RtcScene *scene, const MeshUse *uses, uint32_t n)
{
    if (uses->mesh_end || (n > 1 && uses->mesh->n_triangles > SMALL_MESH)) return false;
    for (uint32_t i = 0; i < n; i++)
        if (scene->objects[uses[i].object].moves) return false;
    return true;
}

/* Decides which meshes are baked, and how many there are then. */
static void plan_meshes(RtcScene *scene, const MeshUse *uses, uint32_t n, bool *bakes_small, uint32_t *n_meshes)
{
    uint64_t n_triangles = 0;
    uint32_t n_rows = 0, n_more = 0; /* n_more: meshes, if all are baked that may be */
    for (uint32_t i = 0, row; i < n; i += row, n_rows++) {
        row = row_of(uses + i, n - i);
        if (row == 1 || !may_bake(scene, uses + i, row)) continue;
        n_triangles += (uint64_t)row * uses[i].mesh->n_triangles;
        n_more += row - 1;
    }
    *bakes_small = n_triangles <= MOST_BAKED;
    *n_meshes = n_rows + (*bakes_small ? n_more : 0);
}

static RtcMesh *next_mesh(RtcScene *scene, const MeshUse *use)
{
    RtcMesh *mesh = &scene->meshes[scene->n_meshes++];
    *mesh = (RtcMesh){.source = use->mesh, .end = use->mesh_end};
    return mesh;
}

static Status add_baked(RtcScene *scene, const MeshUse *use, Error *error)
{
    RtcPlaced *placed = &scene->objects[use->object];
    RtcMesh *mesh = next_mesh(scene, use);
    placed->mesh = mesh;
    TRY(bake_mesh(placed, mesh, error));
    TRY(make_quads(mesh, placed->mirrored, error));
    attach(scene->world, quad_geometry(scene, mesh), use->object);
    return STATUS_OK;
}

static Status add_shared(RtcScene *scene, const MeshUse *uses, uint32_t n, Error *error)
{
    RtcMesh *mesh = next_mesh(scene, uses);
    for (uint32_t i = 0; i < n; i++) scene->objects[uses[i].object].mesh = mesh;
    TRY(make_quads(mesh, false, error));
    add_instances(scene, mesh, uses, n);
    return STATUS_OK;
}

/* Geometry number o of the world is object o; the pieces of all solids come after them. */
static Status add_meshes(RtcScene *scene, const MeshUse *uses, uint32_t n, Error *error)
{
    bool bakes_small;
    uint32_t n_meshes;
    plan_meshes(scene, uses, n, &bakes_small, &n_meshes);
    scene->meshes = calloc(n_meshes + 1U, sizeof *scene->meshes);
    scene->shared = calloc(n_meshes + 1U, sizeof *scene->shared);
    if (!scene->meshes || !scene->shared)
        return fail_memory(error, n_meshes * sizeof *scene->meshes, "the scene's meshes");
    for (uint32_t i = 0, row; i < n; i += row) {
        row = row_of(uses + i, n - i);
        bool baked = (row == 1 || bakes_small) && may_bake(scene, uses + i, row);
        if (!baked) TRY(add_shared(scene, uses + i, row, error));
        for (uint32_t k = 0; baked && k < row; k++) TRY(add_baked(scene, &uses[i + k], error));
    }
    return STATUS_OK;
}

/* Which mesh objects may be lone. */
static Status note_convex(RtcScene *scene, const MeshUse *uses, uint32_t n, Error *error)
{
    uint32_t n_candidates = 0;
    if (scene->n_keys) return STATUS_OK;
    for (uint32_t i = 0; i < n; i++) {
        RtcPlaced *placed = &scene->objects[uses[i].object];
        if (placed->opaque || placed->mesh->end || 2 * placed->mesh->n_quads > RTC_CONVEX_MOST) continue;
        placed->frame = n_candidates++;
        placed->lone = RTC_PERHAPS_LONE;
    }
    if (n_candidates > RTC_CONVEX_OBJECTS) { /* of so many the planes would take too much memory */
        for (uint32_t i = 0; i < n; i++) scene->objects[uses[i].object].lone = RTC_NOT_LONE;
        return STATUS_OK;
    }
    scene->convex = calloc(n_candidates + 1U, sizeof *scene->convex);
    if (!scene->convex) return fail_memory(error, n_candidates * sizeof *scene->convex, "the scene's meshes");
    scene->n_convex = n_candidates;
    return STATUS_OK;
}

/* Whether a piece is hollow enough for eighths to have much smaller boxes. Not a torus: most rays into its box meet it,
 * often in several eighths, and finding all crossings anew in each costs more (487 ns a ray whole, 627 ns in eighths).
 */
static bool is_cut(const Piece *piece)
{
    if (piece->kind == PIECE_SPHERE || piece->kind == PIECE_TORUS || piece->kind == PIECE_RECT ||
        piece->kind == PIECE_PLANE)
        return false;
    HalfBox box = piece_half_bounds(piece);
    return box.r0 > 0.3 * box.r1;
}

/* How many pieces of each sort there are; [1] of what moves. */
typedef struct PieceCounts {
    size_t balls[2], whole[2], cut[2], planes;
} PieceCounts;

/* The pieces of an object that are met in its frame: none of a mesh or of a ball. */
static uint32_t n_framed_pieces(const RtcPlaced *object)
{
    return object->is_mesh || object->ball || !object->solid ? 0 : (uint32_t)object->solid->n_pieces;
}

static PieceCounts count_pieces(const RtcScene *scene)
{
    PieceCounts counts = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const RtcPlaced *object = &scene->objects[i];
        bool moves = object->moves;
        counts.balls[moves] += object->ball;
        for (uint32_t k = 0; k < n_framed_pieces(object); k++) {
            const Piece *piece = &object->solid->pieces[k];
            ++*(piece->kind == PIECE_PLANE ? &counts.planes
                : is_cut(piece)            ? &counts.cut[moves]
                                           : &counts.whole[moves]);
        }
    }
    return counts;
}

static RtcPiece piece_of(const RtcPlaced *object, uint32_t number, uint32_t piece)
{
    return (RtcPiece){.object = number, .piece = piece, .shape = &object->solid->pieces[piece], .frame = object->frame};
}

static RtcPlane plane_of(const RtcScene *scene, const RtcPlaced *object, uint32_t number)
{
    Affine to_local = rtc_to_local(scene, object, 0);
    const double *up = to_local.m[1];
    return (RtcPlane){number, object->moves, vec3(up[0], up[1], up[2]), object->place};
}

static void list_pieces(RtcScene *scene)
{
    uint32_t *balls[2] = {scene->still.balls, scene->moving.balls};
    RtcPiece *whole[2] = {scene->still.pieces, scene->moving.pieces};
    RtcPiece *cut[2] = {whole[0] + scene->still.n_whole, whole[1] + scene->moving.n_whole};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const RtcPlaced *object = &scene->objects[i];
        bool moves = object->moves;
        if (object->ball) *balls[moves]++ = i;
        for (uint32_t k = 0; k < n_framed_pieces(object); k++) {
            const Piece *piece = &object->solid->pieces[k];
            if (piece->kind == PIECE_PLANE)
                scene->planes[scene->n_planes++] = plane_of(scene, object, i);
            else
                *(is_cut(piece) ? cut : whole)[moves]++ = piece_of(object, i, k);
        }
    }
}

static void add_piece_set(RtcScene *scene, RtcPieceSet *set, uint32_t id)
{
    if (!rtc_n_parts(set)) return;
    RTCGeometry geometry = rtcNewGeometry(scene->device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, rtc_n_parts(set));
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
    scene->n_few = rtc_n_parts(&scene->still);
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
    PieceCounts counts = count_pieces(scene);
    size_t n_still = counts.whole[0] + counts.cut[0], n = n_still + counts.whole[1] + counts.cut[1],
           n_balls = counts.balls[0] + counts.balls[1];
    if (n_balls + n + (RTC_SECTORS - 1) * (counts.cut[0] + counts.cut[1]) >= UINT32_MAX)
        return fail(error, STATUS_NOMEM, "%zu analytic pieces are too many", n_balls + n);
    scene->balls = malloc((n_balls + 1) * sizeof *scene->balls);
    scene->pieces = malloc((n + 1) * sizeof *scene->pieces);
    scene->planes = malloc((counts.planes + 1) * sizeof *scene->planes);
    if (!scene->balls || !scene->pieces || !scene->planes)
        return fail_memory(error, (n_balls + n + counts.planes) * sizeof *scene->pieces, "the scene's solids");
    scene->still = (RtcPieceSet){.scene = scene,
                                 .balls = scene->balls,
                                 .pieces = scene->pieces,
                                 .n_balls = (uint32_t)counts.balls[0],
                                 .n_whole = (uint32_t)counts.whole[0],
                                 .n_cut = (uint32_t)counts.cut[0]};
    scene->moving = (RtcPieceSet){.scene = scene,
                                  .balls = scene->balls + counts.balls[0],
                                  .pieces = scene->pieces + n_still,
                                  .first = (uint32_t)n_still,
                                  .n_balls = (uint32_t)counts.balls[1],
                                  .n_whole = (uint32_t)counts.whole[1],
                                  .n_cut = (uint32_t)counts.cut[1],
                                  .moving = true};
    list_pieces(scene);
    if (rtc_n_parts(&scene->still) <= RTC_FEW)
        keep_few(scene);
    else
        add_piece_set(scene, &scene->still, scene->n_objects);
    add_piece_set(scene, &scene->moving, scene->n_objects + 1);
    return STATUS_OK;
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

static Status build_world(RtcScene *scene, const MeshUse *uses, uint32_t n_uses, Error *error)
{
    scene->world = new_scene(scene);
    TRY(add_meshes(scene, uses, n_uses, error));
    TRY(note_convex(scene, uses, n_uses, error));
    rtc_find_reach(scene);
    TRY(add_pieces(scene, error));
    rtcCommitScene(scene->world);
    if (scene->error.status != STATUS_OK) return fail(error, scene->error.status, "%s", scene->error.text);
    scene->bounds = world_bounds(scene);
    return STATUS_OK;
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
    MeshUse *uses;
    uint32_t n_uses;
    TRY(find_uses(scene, describe, context, &uses, &n_uses, error));
    Status status = build_world(scene, uses, n_uses, error);
    free(uses);
    return status;
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
    scene->objects = aligned_alloc(RTC_LINE, ((size_t)n_objects + 1) * sizeof *scene->objects);
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
    for (uint32_t i = 0; i < scene->n_meshes; i++) {
        free(scene->meshes[i].moved);
        free(scene->meshes[i].quads);
        rtc_boxes_free(scene->meshes[i].boxes);
    }
    for (uint32_t i = 0; i < scene->n_convex; i++) rtc_convex_free(scene->convex[i]);
    free(scene->convex);
    free(scene->meshes);
    free(scene->maps);
    free(scene->objects);
    free(scene->shared);
    free(scene->balls);
    free(scene->pieces);
    free(scene->planes);
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
