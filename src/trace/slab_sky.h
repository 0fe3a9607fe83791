/* slab_sky.h - light of the sky and the sun through flat faces: window panes, still water, blocks of glass; private to src/trace.
 *
 * In which direction light from infinity comes to a place is known, whatever faces it comes by and wherever these are: where the index is
 * that of what is outside, in the one in which it is there; and elsewhere, where all faces are parallel, in the one to which it would be
 * refracted at a single face, or what a side of the body mirrors of that, totally. So looks are started there, and followed through flat
 * faces, and to and fro between them, until they leave the scene. Where one does so in a direction from which that single face would have
 * led to its start, the light there is what was looked for, and counts by what the faces let through; and, where it is bent, by how many
 * steradians outside come of one at the place. A path that is scattered so, and leaves the scene so by chance, finds the same; both are
 * weighed as where nothing is in the way. From within a body there is a look for each way in that its outermost faces allow for, so that
 * near the side of a tank there are several, of which some find a wall. What leaves at another angle, or is mirrored more often, is none
 * of this, and is found as it was before.
 *
 * A look always goes through each face, and is mirrored besides as often as the face reflects. Its way is that of the hero, for both
 * paths of a sample (sample.c). The other wavelengths would go beside it, by some hundredths of the body's thickness, and are taken to
 * come as far as that one does; of what the faces let through each has its own part. Where each would come to the place from another
 * direction, a look takes the indices that its path does.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLAB_SKY_H
#define MEN_SLAB_SKY_H

#include "trace/shade.h"

/* As path_shadow, for light from infinity that comes through slabs. The ray is one that path_shadow says is blocked. */
bool slab_shadow(Path *path, const Ray *ray, Lanes *transmittance);
/* If the light that was chosen is from infinity, and the place's index another than outside, lights are added that are in the directions
 * in which it comes there; its own density becomes 0 unless it comes straight, too. */
void slab_look_at_sky(Path *path, const LookPlace *from, LightLooks *looks);

/* A path leaves the scene by slabs: if looks would have found the same, the density of its scattering becomes that of the direction
 * outside; else nothing competes with it. */
void slab_leave_scene(Path *path);
/* Whether looks from a place to which a photon has come through slabs find the same. outward: against the direction in which it began.
 * normal: of a surface there, to the photon's side; else zero. */
bool slab_sky_is_looked_at(Path *photon, Vec3f outward, Vec3 place, Vec3f normal);

#endif
