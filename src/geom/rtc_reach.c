/* rtc_reach.c - how large the coordinates of a scene are: of all, of the pieces whose boxes are widened, and of triangles from place
 * to place (rtc_grain.h).
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_scene.h"

/* The box of a mesh, and the one before: instances of one mesh mostly stand in a row. */
typedef struct MeshBox {
    const Mesh *mesh, *end;
    Box3 box;
} MeshBox;

static double reach_of_box(Box3 box)
{
    return box.min.x <= box.max.x ? double_max(vec3_max_abs(box.min), vec3_max_abs(box.max)) : 0;
}

static Box3 add_points(Box3 box, const Vec3f *points, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) box = box3_add_point(box, vec3_from_f(points[i]));
    return box;
}

static Box3 box_of_mesh(MeshBox *known, const Mesh *mesh, const Mesh *end)
{
    if (known->mesh == mesh && known->end == end) return known->box;
    Box3 box = add_points(box3_empty(), mesh->positions, mesh->n_vertices);
    if (end) box = add_points(box, end->positions, mesh->n_vertices);
    *known = (MeshBox){mesh, end, box};
    return box;
}

/* The box of a mesh wherever it moves. */
static Box3 box_of_placed_mesh(const RtcScene *scene, const RtcPlaced *object, MeshBox *known)
{
    const RtcMesh *mesh = object->mesh;
    if (mesh->baked) return add_points(box3_empty(), rtc_positions(mesh), mesh->source->n_vertices);
    Box3 local = box_of_mesh(known, mesh->source, mesh->end);
    Affine to_world = rtc_first_to_world(object);
    Box3 box = affine_box(&to_world, local);
    for (uint32_t k = 1; object->moves && k < scene->n_keys; k++)
        box = box3_union(box, affine_box(&object->keys[k], local));
    return box;
}

/* The axis across which a triangle is level; -1: none. */
static inline int level_axis(const Vec3f corner[3])
{
    if (corner[0].y == corner[1].y && corner[0].y == corner[2].y) return 1;
    if (corner[0].x == corner[1].x && corner[0].x == corner[2].x) return 0;
    return corner[0].z == corner[1].z && corner[0].z == corner[2].z ? 2 : -1;
}

static inline float largest_of(float a, float b, float c)
{
    return float_max(fabsf(a), float_max(fabsf(b), fabsf(c)));
}

/* The coordinate that float rounds where a triangle is met: the largest of its corners. But one that is level stands where its
 * one coordinate says, to the bit: cross products of its edges have zeros in the other two, whatever is rounded, and its
 * distance is a quotient of two heights. What float rounds there is no more than that of the place itself, and what the height
 * was rounded to before the mesh was moved: by that surfaces are at one place (rtc_coordinate_across). */
static inline double coordinate_of(const RtcMesh *mesh, const Affine *to_world, const uint32_t *of)
{
    const Vec3f *world = rtc_positions(mesh), *local = mesh->source->positions;
    Vec3f corner[3] = {world[of[0]], world[of[1]], world[of[2]]};
    int axis = level_axis(corner);
    if (axis < 0)
        return (double)largest_of(largest_of(corner[0].x, corner[0].y, corner[0].z),
                                  largest_of(corner[1].x, corner[1].y, corner[1].z),
                                  largest_of(corner[2].x, corner[2].y, corner[2].z));
    if (!mesh->moved) return 0;
    const double *row = to_world->m[axis];
    Vec3f a = local[of[0]], b = local[of[1]], c = local[of[2]];
    return fabs(row[0]) * (double)largest_of(a.x, b.x, c.x) + fabs(row[1]) * (double)largest_of(a.y, b.y, c.y) +
           fabs(row[2]) * (double)largest_of(a.z, b.z, c.z);
}

/* Where some triangles of a baked mesh are that float rounds, first <= i < end, and the largest coordinate of them. */
static Box3 box_of_run(const RtcMesh *mesh, const Affine *to_world, uint32_t first, uint32_t end, double *coordinate)
{
    Box3 box = box3_empty();
    *coordinate = 0;
    for (uint32_t i = first; i < end; i++) {
        const uint32_t *of = mesh->source->triangles[i];
        double own = coordinate_of(mesh, to_world, of);
        if (own == 0) continue;
        for (int k = 0; k < 3; k++) box = box3_add_point(box, vec3_from_f(rtc_positions(mesh)[of[k]]));
        *coordinate = double_max(*coordinate, own);
    }
    return box;
}

/* Boxes about so many runs of the triangles of a mesh in the world's frame say well enough where it is. */
enum { GRAIN_RUNS = 1 << 14 };

static void add_grain_of_runs(RtcGrain *grain, const RtcPlaced *object)
{
    Affine to_world = rtc_first_to_world(object);
    uint32_t n = object->mesh->source->n_triangles, run = n / GRAIN_RUNS + 1;
    for (uint32_t first = 0; first < n; first += run) {
        double coordinate;
        Box3 box = box_of_run(object->mesh, &to_world, first, n - first < run ? n : first + run, &coordinate);
        if (coordinate > 0) rtc_grain_add(grain, box, coordinate);
    }
}

/* The largest coordinate that float rounds where an object's mesh is met; box: the mesh's. */
static float grain_of_object(const RtcPlaced *object, Box3 box)
{
    const RtcMesh *mesh = object->mesh;
    double coordinate = mesh->baked ? 0 : reach_of_box(box);
    Affine to_world = rtc_first_to_world(object);
    for (uint32_t i = 0; mesh->baked && i < mesh->source->n_triangles; i++)
        coordinate = double_max(coordinate, coordinate_of(mesh, &to_world, mesh->source->triangles[i]));
    return coordinate > 0 ? nextafterf((float)coordinate, INFINITY) : 0;
}

/* The sizes of pieces: the sums of the sides of their boxes. */
typedef struct PieceSizes {
    size_t n;
    double inverse; /* the sum of one over each */
} PieceSizes;

/* The largest coordinate of a solid's pieces, but for planes. */
static double reach_of_solid(const Solid *solid, const Affine *to_world, PieceSizes *sizes)
{
    double reach = 0;
    for (uint32_t k = 0; k < solid->n_pieces; k++) {
        const Piece *piece = &solid->pieces[k];
        if (piece->kind == PIECE_PLANE) continue;
        Box3 box = affine_box(to_world, piece_bounds(piece));
        Vec3 sides = vec3_sub(box.max, box.min);
        reach = double_max(reach, reach_of_box(box));
        sizes->n++;
        sizes->inverse += 1 / (sides.x + sides.y + sides.z);
    }
    return reach;
}

void rtc_find_reach(RtcScene *scene)
{
    MeshBox known = {0};
    PieceSizes sizes = {0};
    float most = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        RtcPlaced *object = &scene->objects[i];
        Affine to_world = rtc_first_to_world(object);
        if (object->is_mesh) {
            Box3 box = box_of_placed_mesh(scene, object, &known);
            scene->reach = double_max(scene->reach, reach_of_box(box));
            object->grain = grain_of_object(object, box);
            most = float_max(most, object->grain);
            continue;
        }
        if (!object->solid) continue;
        scene->reach = double_max(scene->reach, reach_of_solid(object->solid, &to_world, &sizes));
        for (uint32_t k = 1; object->moves && k < scene->n_keys; k++)
            scene->reach = double_max(scene->reach, reach_of_solid(object->solid, &object->keys[k], &sizes));
    }
    scene->piece_reach = sizes.n ? rtc_piece_reach(scene->reach, (double)sizes.n / sizes.inverse) : scene->reach;
    rtc_grain_begin(&scene->grain, most);
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const RtcPlaced *object = &scene->objects[i];
        if (object->is_mesh && object->mesh->baked)
            add_grain_of_runs(&scene->grain, object);
        else if (object->is_mesh && object->grain > 0)
            rtc_grain_add(&scene->grain, box_of_placed_mesh(scene, object, &known), (double)object->grain);
    }
}
