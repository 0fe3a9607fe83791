/* emitter_cells.h - where on a triangle or a piece there is light, of one whose emission is a texture or that is an operand of which
 * little shows: its square of two numbers (emitter_place.h) in cells, which are chosen by how bright they are.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMITTER_CELLS_H
#define MEN_EMITTER_CELLS_H

#include "trace/emitter.h"

/* A part of the square. */
typedef struct EmitterWindow {
    double low[2], size[2];
} EmitterWindow;

/* side x side cells of a window, first u: the rows' probabilities summed up, then those of each row's cells. None of them is 0; there
 * is no light beyond the window, or it is left to chance. */
struct EmitterCells {
    EmitterWindow window;
    uint32_t side;
    float sums[];
};

/* A place by two uniform numbers; returns its density in relation to that of places that are spread evenly. u and chosen may be the
 * same. */
float emitter_cells_choose(const EmitterCells *cells, const float u[2], float chosen[2]);
/* That density of any place. */
float emitter_cells_density(const EmitterCells *cells, const double u[2]);
/* The same where a ray has met the emitter, which has cells. */
float emitter_cells_density_hit(const EmitterSet *set, const CompiledScene *compiled, const Emitter *emitter,
                                const Ray *ray, const Hit *hit);

/* For n emitters of the set that are triangles or pieces of surfaces whose emission is a texture, sets cells where that pays; a ball
 * that gets cells becomes a piece. means: of each its power, as if it were even and of one brightness; and then how bright it is as a
 * mean. Nothing of it depends on the number of threads. STATUS_NOMEM. */
ATTR_NODISCARD Status emitter_cells_find(const struct World *world, EmitterSet *set, const uint32_t *numbers,
                                         uint32_t n, Pool *pool, float *means, Error *error);
/* The same of operands without textures, of which a part shows; that is what it puts into means, where there are few enough of them. */
ATTR_NODISCARD Status emitter_cells_find_cut(const struct World *world, EmitterSet *set, const uint32_t *numbers,
                                             uint32_t n, Pool *pool, float *means, Error *error);
void emitter_cells_clear(EmitterSet *set);

#endif
