/* slab_look.h - ways through flat faces of clear bodies: what paths know of those that they went, and single steps of looks that are
 * followed there; private to src/trace. Which light looks find so is said in slab_sky.h and slab_lamp.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLAB_LOOK_H
#define MEN_SLAB_LOOK_H

#include "base/hash.h"
#include "trace/event.h"
#include "trace/shade.h"

/* A way by more faces than these, or mirrored by more, is none of this; thin panes between them do not count. */
enum { SLAB_FACES = 64, SLAB_MIRRORED = 8 };

/* Whether the path has met nothing but faces of slabs, and thin panes, since it came to the first of these faces. */
static inline bool path_is_in_slabs(const Path *path)
{
    return UNLIKELY(path->slab_way.bounce == path->bounce);
}
/* Whether a look could have found what the path finds by its way: it was scattered in front of it, or is a probe that was sent there. */
static inline bool slab_way_has_rival(const Path *path)
{
    return path->slab_way.scatter_pdf >= 0 || (path->probing.is_probe && !path->slab_way.bent);
}
/* The number of the slab's face that a boundary is, see slabs_face; 0: it is none. place: where it is met. */
static inline uint64_t slab_face_at(const World *world, const Hit *hit, const SurfacePlace *place)
{
    if (LIKELY(!world->slabs.n) || path_is_bent(place)) return 0;
    return slabs_face(&world->slabs, hit->object, hit->normal);
}
/* The path is about to be refracted at a face of a slab, or mirrored; rarity: of its airway, in front. */
void slab_meet_face(Path *path, const Event *event, uint64_t face, bool mirrored, float rarity);
/* It has gone straight through a thin pane. */
static inline void slab_pass_pane(Path *path)
{
    path->slab_way.bounce += path_is_in_slabs(path);
}
/* Whether the index of a medium is that of what is outside. */
bool slab_is_as_outside(const Path *path, uint32_t medium);

/* ---- for looks ---- */

/* Whether a surface takes light from that direction; normal: as LightQuery's. */
static inline bool slab_is_in_front(Vec3f normal, Vec3f direction)
{
    return vec3f_dot(normal, normal) == 0 || vec3f_dot(direction, normal) > 0;
}
/* Where a look meets a face. */
typedef struct SlabFace {
    SurfacePlace place;
    uint64_t number; /* see slabs_face */
    Lanes reflectance;
    Vec3f refracted;
    bool passes;
} SlabFace;

/* Of the faces of a way, and what is done there, from 0 on; the same whichever way round they are met. */
static inline uint64_t slab_step(uint64_t steps, uint64_t face, bool mirrored)
{
    return steps + hash_u64(2 * face + mirrored);
}
/* A look of a path, followed by a tracer of its own, in a ray that is yet to be set. Of which indices: see Path.index_lane. */
void slab_begin_look(const Path *path, Tracer *looker, int index_lane, Path *look);
/* The ray of a look from a place in a direction; the list of the path's looker, which is lent, becomes that of its start. False when memory
 * ends. */
bool slab_start_ray(Path *path, const LookPlace *from, Vec3f direction, Ray *ray);
/* A look from a place in a direction, by which indices: see Path.index_lane. The looker becomes its tracer. False when memory ends. */
bool slab_start_look(Path *path, const LookPlace *from, int index_lane, Vec3f direction, Path *look);
/* False: it is none. */
bool slab_look_at_face(Path *look, const Event *event, SlabFace *face);
/* A thin pane, or a hole in a sheet; false: it is none, or lies in a boundary. */
bool slab_cross_pane(Path *look, Event *event);

#endif
