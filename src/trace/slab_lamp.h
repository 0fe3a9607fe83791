/* slab_lamp.h - light of lamps near by through flat faces; private to src/trace.
 *
 * A look at a place of a lamp goes straight towards it, through all flat faces of clear bodies that are between: so these are known.
 * The direction in which the light really comes by them is then found in closed form (flat_way.h), and followed up to the lamp. In that
 * direction it has the density of the straight look, times how much faster the lamp's place moves as the bent direction is turned
 * than as the straight one is. A path that is scattered in that direction, and comes to the lamp by the same faces, knows that
 * density as well, by looking from its beginning for what it has found; so both are weighed as where nothing is in the way. Light that
 * goes to and fro once between two parallel faces is looked for likewise, by a part of the looks. What is opaque in the straight
 * line does not hide a lamp whose light comes beside it: lamps without size are looked for past it always, others by a part of the
 * looks, where the index is another than outside. Spots and the like are tried where they do not shine straight, too (beams.h). All
 * else, what is mirrored otherwise, or where something curved is in the straight line, is found as it was before.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SLAB_LAMP_H
#define MEN_SLAB_LAMP_H

#include "trace/slab_look.h"

/* The light, lights[0], that was chosen there becomes one that is seen through faces, if such are on the way to it, and where it is
 * seen by another way at the same time, lights[1] becomes that one. */
void slab_look_at_lamp(Path *path, const LookPlace *from, LightLooks *looks);

/* A path through slabs has come to a lamp: the density with which a look from where it was scattered last would have found that by
 * the same faces; 0: none would. */
float slab_lamp_density(Path *path, const Hit *hit);
/* What light of a radiance (a mean of the wavelengths) counts that it has found there, against these looks, or where there are none,
 * probes. */
float slab_weigh_lamp(Path *path, const Hit *hit, float radiance);
/* Whether looks from a place to which a photon has come through slabs find the same way. begin: where it came from a lamp. */
bool slab_lamp_is_looked_at(const Path *photon, uint32_t emitter, const Ray *begin, Vec3 place);

#endif
