/* slab_sky.h - light of the sky and the sun from within what bends it at flat faces: still water, blocks of glass; private to src/trace.
 *
 * Where the index is another than outside, light from infinity comes in another direction than it has there. Through flat faces that is
 * known: a look goes through the faces that are in the straight line towards the light, and starts in the direction which these bend
 * into the light's own. It has that one's density, times how many steradians outside come of one at the place. A path that is scattered
 * in that direction, and leaves the scene by the same faces, knows what a look would have done, so that both are weighed as where
 * nothing is in the way. What is opaque, or curved, in the straight line does not matter, but in the bent one. Light that comes by other
 * faces than these, or is mirrored, is found as it was before.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLAB_SKY_H
#define MEN_SLAB_SKY_H

#include "trace/shade.h"

/* If the light that was chosen is from infinity, and the place's index another than outside, it becomes one in the direction in which it
 * comes there; its density becomes 0 if none does. */
void slab_look_at_sky(Path *path, const LookPlace *from, LightLooks *looks);
/* A path leaves the scene by slabs, from where the index was another: if a look would have found the same, the density of its scattering
 * becomes that of the direction outside; else nothing competes with it. */
void slab_leave_for_sky(Path *path);
/* Whether looks from a place to which a photon has come through slabs find the same. outward: against the direction in which it began. */
bool slab_sky_is_looked_at(const Path *photon, Vec3f outward, Vec3 place);

#endif
