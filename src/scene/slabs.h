/* slabs.h - bodies with flat faces: window panes, table tops, blocks of glass, still water.
 *
 * Light of the sky and of the sun leaves bodies with parallel faces in the direction in which it came, and the way of light
 * through given flat faces is known in closed form. So looks for light go on through them (slab_lamp.h, slab_sky.h), where at any
 * other boundary they end.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLABS_H
#define MEN_SLABS_H

#include "scene/compile.h"

/* Its faces look along these axes; those of parallel pairs along three at most. */
enum { SLAB_AXES = 4, SLAB_PAIRS = 3 };
typedef struct SlabAxes {
    Vec3f axes[SLAB_AXES];                  /* unit */
    double low[SLAB_AXES], high[SLAB_AXES]; /* how far it reaches along each, where it has several */
    uint32_t n;
    bool within; /* looks go through its faces from within it alone */
    Box3 box;    /* around it; a plane's: everything */
} SlabAxes;

/* The points p of normal . p = offset. */
typedef struct SlabPlane {
    Vec3 normal;
    double offset;
} SlabPlane;

/* All of a scene that are smooth and stand still: those of which most of the surface is faces that are parallel in pairs, planes,
 * and solids with any flat face, as a drink has at its top, and meshes most of which is few flat faces, as prisms of three sides.
 * Those of the index of what is outside, as the air in double glazing, count where they are within the box of one that is not: a
 * line from outside then comes to that box first. */
typedef struct Slabs {
    SlabAxes *items;     /* first those that bend light which comes from outside */
    uint32_t *of_object; /* SCENE_NONE: it is none */
    uint32_t n, n_bending;
    /* Of those that bend light which comes from outside: around each with parallel faces, and around all of these; planes; and
     * around solids with other flat faces, by which light is looked for from within alone */
    Box3 *boxes, bounds;
    SlabPlane *planes;
    Box3 *basins, basin_bounds;
    uint32_t n_boxes, n_planes, n_basins;
} Slabs;

/* STATUS_NOMEM. */
ATTR_NODISCARD Status slabs_find(const CompiledScene *compiled, Slabs *slabs, Error *error);
void slabs_clear(Slabs *slabs);

/* Whether looks go through flat faces of an object from wherever they come. */
static inline bool slabs_are_looked_through(const Slabs *slabs, uint32_t object)
{
    uint32_t number = slabs->of_object[object];
    return number != SCENE_NONE && !slabs->items[number].within;
}
/* Which of a slab's flat faces an object's surface is where it has that normal, of all of the scene: a number of its own; 0:
 * none. */
static inline uint64_t slabs_face(const Slabs *slabs, uint32_t object, Vec3f normal)
{
    const float parallel = 1 - 1e-6f;
    uint32_t number = slabs->of_object[object];
    if (number == SCENE_NONE) return 0;
    const SlabAxes *slab = &slabs->items[number];
    for (uint32_t i = 0; i < slab->n; i++) {
        float along = vec3f_dot(slab->axes[i], normal);
        if (fabsf(along) > parallel) return 1 + 2 * ((uint64_t)object * SLAB_AXES + i) + (along > 0);
    }
    return 0;
}
/* Those that bend light which comes from outside, and may do so on its way to a place: whose box it is in, to within what meshes
 * round. Of more than some hundreds, the later ones do not count, and not more of them than these. Returns how many. */
enum { SLABS_AROUND = 6 };
uint32_t slabs_around(const Slabs *slabs, Vec3 place, const SlabAxes *around[SLABS_AROUND]);
/* Whether a line from within a body would leave it by a face across one of its axes, if it had just the outermost faces of all.
 * mirror: another, at a face across which it is mirrored before; or the same: it is not. */
bool slab_leaves_across(const SlabAxes *slab, uint32_t axis, uint32_t mirror, Vec3 from, Vec3 direction);

/* Whether looks along a line go through such faces, as there may be some within a distance. */
bool slabs_are_on_way(const Slabs *slabs, Vec3 from, Vec3f direction, double distance);

#endif
