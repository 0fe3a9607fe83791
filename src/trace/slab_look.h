/* slab_look.h - light of the sky and the sun through bodies with parallel faces; private to src/trace.
 *
 * Such light comes to a place from the direction in which it leaves the scene, so that a look for it can be followed, through
 * flat faces and to and fro between them, until it leaves the scene. Where it does so in the direction in which it was sent, the
 * light there is what was looked for, and counts by what the faces let through. A path that is scattered in that direction, and
 * goes through by chance, finds the same; both are weighed as where nothing is in the way. What leaves at another angle is none of
 * this, and is found as it was before; of what starts where the index is another than outside see slab_sky.h. A look always goes
 * through each face, and is mirrored besides as often as the face reflects.
 *
 * The way of a look is that of the hero, for both paths of a sample (sample.c). The other wavelengths would go beside it, by some
 * hundredths of the body's thickness, and are taken to come as far as that one does; of what the faces let through each has its
 * own part.
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
/* Whether the index of a medium is that of what is outside. From elsewhere light is looked for as slab_sky.h says: what left in the
 * direction of its start would be a light's one direction of all, and count by what it fills of the sky there. */
bool slab_is_as_outside(const Path *path, uint32_t medium);
/* Whether what the path goes on in now is the direction in front of all slabs, and that was outside; and looks would go so. from,
 * direction: of such a look. */
bool slab_keeps_direction(const Path *path, Vec3 from, Vec3f direction);
/* It leaves the scene behind slabs: if as it came to them, that way counts as straight. */
void slab_leave_scene(Path *path);

/* As path_shadow, for light from infinity that comes through slabs. The ray is one that path_shadow says is blocked. */
bool slab_shadow(Path *path, const Ray *ray, Lanes *transmittance);

/* ---- for looks: slab_look.c, slab_lamp.c ---- */

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
/* False: it is none. */
bool slab_look_at_face(Path *look, const Event *event, SlabFace *face);
/* A thin pane, or a hole in a sheet; false: it is none. */
bool slab_cross_pane(Path *look, Event *event);

#endif
