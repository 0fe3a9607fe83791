/* crystal_cross.h - a path that comes to a smooth boundary of a crystal that refracts doubly; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CRYSTAL_CROSS_H
#define MEN_CRYSTAL_CROSS_H

#include "trace/shade.h"

/* A medium on one side of a boundary, at the wavelength of the hero. *bends_alike: becomes false where others have other indices. */
CrystalSide path_crystal_side(Path *path, uint32_t medium, bool *bends_alike);
/* All ways on from there; see crystal_meet. bends_alike: whether all wavelengths that the path carries go them.
 * Of a path that has begun in the crystal, or was scattered there, one of both kinds of waves, by chance. */
uint32_t path_crystal_ways(Path *path, const Event *event, const SurfacePlace *place, CrystalWay ways[CRYSTAL_WAYS],
                           bool *bends_alike);
/* One of the ways on is chosen, as often as it is bright. Looks through flat faces (slab_look.h) and beacons know nothing of them:
 * what is behind a crystal is found by following it, and by what photons say. */
void path_cross_crystal(Path *path, Event *event, const SurfacePlace *place);

#endif
