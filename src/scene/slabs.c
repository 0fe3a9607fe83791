/* slabs.c - see slabs.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/slabs.h"

#include <stdlib.h>

#include "base/array.h"

/* Faces are parallel whose normals are so near to each other: meshes have their corners in float. */
static const double parallel = 1 - 1e-8;

/* What is known of a shape's surface, as a map makes it. */
typedef struct Faces {
    const SceneShape *shape;
    const Affine *map; /* NULL: none */
    Vec3 axes[SLAB_AXES];
    double towards[SLAB_AXES], against[SLAB_AXES]; /* areas */
    uint32_t n;
    double area;  /* of all, */
    Vec3 largest; /* and the largest flat part that looks along none of the axes, as its area along its normal */
} Faces;

static Vec3 in_map(const Faces *faces, Vec3 area)
{
    return faces->map ? affine_area(faces->map, area) : area;
}

/* A part of a body's surface, by its area along its normal. */
static void add_flat(Faces *faces, Vec3 flat)
{
    double area = vec3_length(flat);
    faces->area += area;
    for (uint32_t i = 0; i < faces->n; i++) {
        double along = vec3_dot(flat, faces->axes[i]);
        if (fabs(along) < parallel * area) continue;
        *(along > 0 ? &faces->towards[i] : &faces->against[i]) += area;
        return;
    }
    if (area > vec3_length(faces->largest)) faces->largest = flat;
}

static void add_mesh(Faces *faces, const Mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        Vec3 corner[3];
        for (int k = 0; k < 3; k++) corner[k] = vec3_from_f(mesh->positions[mesh->triangles[i][k]]);
        Vec3 area = vec3_scale(vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0])), 0.5);
        add_flat(faces, in_map(faces, area));
    }
}

static bool is_flat(const Piece *piece)
{
    return piece->kind == PIECE_BAND && piece->y0 == piece->y1;
}

/* Of what is curved, only an uneven map needs to know where it looks. */
static void add_curved(Faces *faces, const Piece *piece)
{
    enum { PARTS = 8 };
    const double area = piece_area(piece), part = area / (PARTS * PARTS);
    if (!faces->map) faces->area += area;
    for (int k = 0; k < PARTS * PARTS && faces->map; k++) {
        Vec3 normal;
        (void)piece_sample(piece, (k % PARTS + 0.5) / PARTS, (k / PARTS + 0.5) / PARTS, &normal);
        faces->area += vec3_length(affine_area(faces->map, vec3_scale(normal, part)));
    }
}

static void add_solid(Faces *faces, const Solid *solid)
{
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *piece = &solid->pieces[i];
        Vec3 normal;
        if (!is_flat(piece)) {
            add_curved(faces, piece);
            continue;
        }
        (void)piece_sample(piece, 0.5, 0.5, &normal);
        add_flat(faces, in_map(faces, vec3_scale(normal, piece_area(piece))));
    }
}

/* Goes over the whole surface once. */
static void add_surface(Faces *faces)
{
    faces->area = 0;
    faces->largest = vec3(0, 0, 0);
    for (uint32_t i = 0; i < SLAB_AXES; i++) faces->towards[i] = faces->against[i] = 0;
    if (faces->shape->mesh)
        add_mesh(faces, faces->shape->mesh);
    else
        add_solid(faces, faces->shape->solid);
}

/* How far a mesh reaches along its axes, where it has several. */
static void find_reach(const Faces *faces, SlabAxes *slab)
{
    const Mesh *mesh = faces->shape->mesh;
    for (uint32_t i = 0; i < slab->n; i++) {
        slab->low[i] = HUGE_VAL;
        slab->high[i] = -HUGE_VAL;
    }
    for (uint32_t k = 0; mesh && slab->n > 1 && k < mesh->n_vertices; k++) {
        Vec3 own = vec3_from_f(mesh->positions[k]), corner = faces->map ? affine_point(faces->map, own) : own;
        for (uint32_t i = 0; i < slab->n; i++) {
            double along = vec3_dot(vec3_from_f(slab->axes[i]), corner);
            slab->low[i] = double_min(along, slab->low[i]);
            slab->high[i] = double_max(along, slab->high[i]);
        }
    }
}

/* The axes of a body's flat faces, but for small ones, the largest first; of all of its surface, the part that they are. paired: faces
 * count that there are to both sides of their axis. */
static double find_axes(const SceneShape *shape, const Affine *map, bool paired, SlabAxes *slab)
{
    const double least = 0.02; /* of the surface, of one axis */
    Faces faces = {.shape = shape, .map = map};
    double flat = 0;
    slab->n = 0;
    add_surface(&faces);
    while (faces.n < (paired ? SLAB_PAIRS : SLAB_AXES) && vec3_length(faces.largest) > 0) {
        uint32_t i = faces.n++;
        faces.axes[i] = vec3_normalize(faces.largest);
        add_surface(&faces);
        double towards = faces.towards[i], against = faces.against[i];
        double area = paired ? 2 * fmin(towards, against) : towards + against;
        if (area < least * faces.area) break;
        flat += area;
        slab->axes[slab->n++] = vec3f_from(faces.axes[i]);
    }
    find_reach(&faces, slab);
    return flat / faces.area;
}

/* Whether most of a body's surface are parallel faces; of rounded edges and the rim of a disc there is less. */
static bool is_slab(const SceneShape *shape, const Affine *map, SlabAxes *slab)
{
    return find_axes(shape, map, true, slab) > 0.5;
}

typedef enum SlabKind {
    SLAB_NONE,
    SLAB_PAIRED,
    SLAB_PLANE,
    SLAB_BASIN /* a solid with flat faces that are not paired, or are not most of it; a prism */
} SlabKind;

static bool is_plane(const SceneShape *shape)
{
    return shape->solid && shape->solid->n_pieces == 1 && shape->solid->pieces[0].kind == PIECE_PLANE;
}

static bool may_be_slab(const SceneShape *shape)
{
    bool has_flat = shape->mesh != NULL;
    if (shape->mesh_end) return false;
    for (uint32_t i = 0; shape->solid && i < shape->solid->n_pieces; i++) {
        if (shape->solid->pieces[i].kind == PIECE_PLANE) return false;
        has_flat |= is_flat(&shape->solid->pieces[i]);
    }
    return has_flat;
}

/* Shapes that many objects share are looked at once. */
typedef struct Finder {
    const CompiledScene *compiled;
    SlabAxes *of_shape; /* in its own frame */
    SlabKind *kind_of_shape;
    bool *shape_known; /* of each shape */
} Finder;

/* A mesh of so few triangles may be a prism. */
enum { FEW_TRIANGLES = 256 };
static bool has_few(const SceneShape *shape)
{
    return !shape->mesh || shape->mesh->n_triangles <= FEW_TRIANGLES;
}

/* Of a shape as a map makes it, or in its own frame: NULL. */
static SlabKind kind_of(const SceneShape *shape, const Affine *map, SlabAxes *slab)
{
    if (is_slab(shape, map, slab)) return SLAB_PAIRED;
    return has_few(shape) && find_axes(shape, map, false, slab) > (shape->solid ? 0 : 0.5) ? SLAB_BASIN : SLAB_NONE;
}

static void map_axes(const Affine *map, const SlabAxes *own, SlabAxes *slab)
{
    slab->n = own->n;
    for (uint32_t i = 0; i < own->n; i++) {
        const Vec3 axis = vec3_from_f(own->axes[i]), across = vec3_normalize(affine_area(map, axis));
        double low = vec3_dot(across, affine_point(map, vec3_scale(axis, own->low[i]))),
               high = vec3_dot(across, affine_point(map, vec3_scale(axis, own->high[i])));
        slab->axes[i] = vec3f_from(across);
        slab->low[i] = double_min(low, high);
        slab->high[i] = double_max(low, high);
    }
}

/* A map keeps faces parallel, but where it stretches unevenly others are most of the surface: then shapes of few parts are looked
 * at as they are in the world. */
static SlabKind find_slab(Finder *finder, const SceneObject *object, SlabAxes *slab)
{
    const SceneShape *shape = &finder->compiled->scene->shapes[object->shape];
    SlabAxes *known = &finder->of_shape[object->shape];
    SlabKind *kind = &finder->kind_of_shape[object->shape];
    if (is_plane(shape)) {
        map_axes(&object->to_world, &(SlabAxes){.axes = {{0, 1, 0}}, .n = 1}, slab);
        return SLAB_PLANE;
    }
    if (!may_be_slab(shape)) return SLAB_NONE;
    if (has_few(shape) && !(affine_even_scale(&object->to_world, 1e-9) > 0))
        return kind_of(shape, &object->to_world, slab);
    if (!finder->shape_known[object->shape]) *kind = kind_of(shape, NULL, known);
    finder->shape_known[object->shape] = true;
    map_axes(&object->to_world, known, slab);
    return *kind;
}

/* Whether light goes through an object's surface as through smooth glass wherever it meets it, and always at the same place. */
static bool is_clear(const CompiledScene *compiled, uint32_t number)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[number];
    if (compiled_hull(compiled, number) == SCENE_NONE || object->shape == SCENE_NONE || object->motion != SCENE_NONE)
        return false;
    if (object->surface == SCENE_NONE) return true;
    const SceneSurface *surface = &scene->surfaces[object->surface];
    return surface_is_clear(surface) && !surface->mixed && !surface_has_relief(surface);
}

/* Whether an object is of a medium of another index than what is outside, or of a combination that is. */
static bool bends(const CompiledScene *compiled, uint32_t object)
{
    uint32_t medium = compiled->order.top[compiled_hull(compiled, object)].medium;
    return compiled_indices_differ(compiled->scene, medium, NEST_WORLD_MEDIUM);
}

/* How much room there is. */
typedef struct Capacities {
    size_t items, boxes, planes, basins;
} Capacities;

static bool add_box(Box3 **boxes, size_t *capacity, uint32_t *n, Box3 box)
{
    if (!array_reserve(boxes, capacity, *n + 1U, sizeof **boxes)) return false;
    (*boxes)[(*n)++] = box;
    return true;
}

static bool add_plane(Slabs *slabs, size_t *capacity, const SceneObject *object, const SlabAxes *slab)
{
    if (!array_reserve(&slabs->planes, capacity, slabs->n_planes + 1U, sizeof *slabs->planes)) return false;
    Vec3 normal = vec3_from_f(slab->axes[0]);
    slabs->planes[slabs->n_planes++] = (SlabPlane){normal, vec3_dot(normal, object->to_world.t)};
    return true;
}

/* Where it is, so that looks know when to expect it. */
static bool add_bending(Slabs *slabs, Capacities *has, SlabKind kind, const SceneObject *object, const SlabAxes *slab,
                        Box3 box)
{
    if (kind == SLAB_PLANE) return add_plane(slabs, &has->planes, object, slab);
    bool basin = kind == SLAB_BASIN;
    Box3 *bounds = basin ? &slabs->basin_bounds : &slabs->bounds;
    *bounds = box3_union(*bounds, box);
    return basin ? add_box(&slabs->basins, &has->basins, &slabs->n_basins, box)
                 : add_box(&slabs->boxes, &has->boxes, &slabs->n_boxes, box);
}

/* Puts one more into the set; false when memory ends. */
static bool add_slab(Slabs *slabs, size_t *capacity, uint32_t object, const SlabAxes *slab)
{
    if (!array_reserve(&slabs->items, capacity, slabs->n + 1U, sizeof *slabs->items)) return false;
    slabs->items[slabs->n] = *slab;
    slabs->of_object[object] = slabs->n++;
    return true;
}

/* A body of air, say, that reaches into one that bends light: a hole in it, or a recess. */
static bool reaches_into_one(const Slabs *slabs, Box3 box)
{
    for (uint32_t i = 0; i < slabs->n_boxes; i++)
        if (!box3_is_empty(box3_intersection(slabs->boxes[i], box))) return true;
    return false;
}

static Box3 everywhere(void)
{
    return (Box3){vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL), vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL)};
}

/* With what is right beside a box: places on walls that are flush with it count as within. */
static Box3 with_rim(Box3 box)
{
    const double part = 1e-5;
    Vec3 size = vec3_sub(box.max, box.min), middle = box3_centre(box);
    double rim = part * (fabs(size.x) + fabs(size.y) + fabs(size.z) + fabs(middle.x) + fabs(middle.y) + fabs(middle.z));
    Vec3 out = vec3(rim, rim, rim);
    return (Box3){vec3_sub(box.min, out), vec3_add(box.max, out)};
}

/* False when memory ends. */
static bool find_one(Finder *finder, Slabs *slabs, Capacities *has, uint32_t number, bool bending)
{
    const Scene *scene = finder->compiled->scene;
    const SceneObject *object = &scene->objects[number];
    SlabAxes slab;
    if (!is_clear(finder->compiled, number) || bends(finder->compiled, number) != bending ||
        (!bending && !slabs->n_boxes))
        return true;
    SlabKind kind = find_slab(finder, object, &slab);
    if (kind == SLAB_NONE) return true;
    Box3 box = scene_object_bounds(scene, object, NULL);
    if (!bending && (kind != SLAB_PAIRED || !reaches_into_one(slabs, box))) return true;
    slab.within = kind == SLAB_BASIN;
    slab.box = kind == SLAB_PLANE ? everywhere() : with_rim(box);
    slabs->n_bending += bending;
    return add_slab(slabs, &has->items, number, &slab) &&
           (!bending || add_bending(slabs, has, kind, object, &slab, box));
}

/* First those that bend light, and then what is within them. False when memory ends. */
static bool find_all(Finder *finder, Slabs *slabs)
{
    const Scene *scene = finder->compiled->scene;
    Capacities has = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) slabs->of_object[i] = SCENE_NONE;
    for (int bending = 1; bending >= 0; bending--)
        for (uint32_t i = 0; i < scene->n_objects; i++)
            if (!find_one(finder, slabs, &has, i, bending)) return false;
    return true;
}

Status slabs_find(const CompiledScene *compiled, Slabs *slabs, Error *error)
{
    const Scene *scene = compiled->scene;
    Finder finder = {.compiled = compiled};
    *slabs = (Slabs){.bounds = box3_empty(), .basin_bounds = box3_empty()};
    slabs->of_object = malloc((scene->n_objects + (size_t)1) * sizeof *slabs->of_object);
    finder.of_shape = malloc((scene->n_shapes + (size_t)1) * sizeof *finder.of_shape);
    finder.kind_of_shape = malloc((scene->n_shapes + (size_t)1) * sizeof *finder.kind_of_shape);
    finder.shape_known = calloc(scene->n_shapes + (size_t)1, sizeof *finder.shape_known);
    bool good =
        slabs->of_object && finder.of_shape && finder.kind_of_shape && finder.shape_known && find_all(&finder, slabs);
    free(finder.of_shape);
    free(finder.kind_of_shape);
    free(finder.shape_known);
    if (good) return STATUS_OK;
    slabs_clear(slabs);
    return fail_memory(error, scene->n_objects * sizeof *slabs->items, "bodies with flat faces");
}

void slabs_clear(Slabs *slabs)
{
    free(slabs->items);
    free(slabs->boxes);
    free(slabs->planes);
    free(slabs->basins);
    free(slabs->of_object);
    *slabs = (Slabs){0};
}

/* Whether a line between two points may come to a box: not if both are beside it, to the same side. */
static bool may_come_to(const Box3 *box, Vec3 from, Vec3 to)
{
    return (from.x < box->max.x || to.x < box->max.x) && (from.x > box->min.x || to.x > box->min.x) &&
           (from.y < box->max.y || to.y < box->max.y) && (from.y > box->min.y || to.y > box->min.y) &&
           (from.z < box->max.z || to.z < box->max.z) && (from.z > box->min.z || to.z > box->min.z);
}

/* Of more boxes that around all of them tells. */
enum { MOST_BOXES = 32 };

static bool boxes_are_on_way(const Slabs *slabs, Vec3 from, Vec3 to, Vec3 direction)
{
    double enter, leave;
    if (!slabs->n_boxes || !may_come_to(&slabs->bounds, from, to)) return false;
    if (slabs->n_boxes > MOST_BOXES) return box3_cut(&slabs->bounds, from, direction, &enter, &leave);
    for (uint32_t i = 0; i < slabs->n_boxes; i++)
        if (may_come_to(&slabs->boxes[i], from, to) && box3_cut(&slabs->boxes[i], from, direction, &enter, &leave))
            return true;
    return false;
}

static bool crosses_plane(const Slabs *slabs, Vec3 from, Vec3 to)
{
    for (uint32_t i = 0; i < slabs->n_planes; i++) {
        const SlabPlane *plane = &slabs->planes[i];
        if ((vec3_dot(plane->normal, from) < plane->offset) != (vec3_dot(plane->normal, to) < plane->offset))
            return true;
    }
    return false;
}

static bool is_in_basin(const Slabs *slabs, Vec3 from)
{
    if (!slabs->n_basins || !box3_holds_point(slabs->basin_bounds, from)) return false;
    for (uint32_t i = 0; i < slabs->n_basins && slabs->n_basins <= MOST_BOXES; i++)
        if (box3_holds_point(slabs->basins[i], from)) return true;
    return slabs->n_basins > MOST_BOXES;
}

uint32_t slabs_around(const Slabs *slabs, Vec3 place, const SlabAxes *around[SLABS_AROUND])
{
    enum { MOST_BODIES = 500 };
    uint32_t n = 0;
    for (uint32_t i = 0; i < slabs->n_bending && i < MOST_BODIES && n < SLABS_AROUND; i++)
        if (box3_holds_point(slabs->items[i].box, place)) around[n++] = &slabs->items[i];
    return n;
}

/* How far along a line the outermost face across an axis is; from there on it is so far to the one opposite. */
static double distance_across(const SlabAxes *slab, uint32_t axis, Vec3 from, Vec3 direction, double *on)
{
    const Vec3 normal = vec3_from_f(slab->axes[axis]);
    double slope = vec3_dot(normal, direction), edge = slope > 0 ? slab->high[axis] : slab->low[axis];
    *on = (slab->high[axis] - slab->low[axis]) / fabs(slope);
    return slope != 0 ? (edge - vec3_dot(normal, from)) / slope : HUGE_VAL;
}

bool slab_leaves_across(const SlabAxes *slab, uint32_t axis, uint32_t mirror, Vec3 from, Vec3 direction)
{
    double on, own;
    if (slab->n == 1) return true;
    own = distance_across(slab, axis, from, direction, &on);
    for (uint32_t i = 0; i < slab->n; i++) {
        if (i == axis) continue;
        double other = distance_across(slab, i, from, direction, &on);
        if (i == mirror ? other > own || other + on < own : other < own) return false;
    }
    return isfinite(own);
}

bool slabs_are_on_way(const Slabs *slabs, Vec3 from, Vec3f direction, double distance)
{
    const Vec3 d = vec3_from_f(direction), to = vec3_along(from, double_min(distance, 1e30), d);
    return boxes_are_on_way(slabs, from, to, d) || crosses_plane(slabs, from, to) || is_in_basin(slabs, from);
}
