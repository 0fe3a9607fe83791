/* emitter_place.h - places of emitters that are triangles or pieces, by two numbers, and back; private to src/trace.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMITTER_PLACE_H
#define MEN_EMITTER_PLACE_H

#include "trace/emitter.h"

/* The place of u in [0, 1)^2, uniform in area for uniform u (of a piece: before it is stretched), as light sampling has it; of the hit
 * (NULL: not wanted) the object, the primitive, u, v and the outward normal are set. */
Vec3 emitter_place(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2], Hit *hit);
/* The same of a triangle; across: along its outward normal, twice as long as its area. */
Vec3 emitter_place_on_triangle(const CompiledScene *compiled, const Emitter *emitter, double time, const double u[2],
                               Vec3 *across);
/* Of one that is a piece of a solid. */
static inline const Piece *emitter_piece(const Scene *scene, const Emitter *emitter)
{
    return &scene->shapes[scene->objects[emitter->of].shape].solid->pieces[emitter->part];
}
/* Number i of a sequence that covers the square and the shutter's time evenly: u, and the time, of scenes in which something moves; else
 * that is 0. */
double emitter_place_in_turn(const Scene *scene, uint32_t i, double u[2]);
/* The u of the place where a ray has met the emitter. */
void emitter_place_of_hit(const CompiledScene *compiled, const Emitter *emitter, const Ray *ray, const Hit *hit,
                          double u[2]);

#endif
