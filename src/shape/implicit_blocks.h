/* implicit_blocks.h - which blocks of a grid are on one side of an implicit surface as a whole, by the bounds of its function;
 * private to src/shape/implicit*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_IMPLICIT_BLOCKS_H
#define MEN_IMPLICIT_BLOCKS_H

#include "base/pool.h"
#include "shape/implicit.h"

enum { BLOCK_CELLS = 4 }; /* along each side of a block */

/* Neighbours share the points between them: where one of them may be crossed, these have to be known. */
typedef struct Blocks {
    uint32_t n[3];
    int8_t *sides; /* of each block, x first: 1 inside, -1 outside, 0 not known; NULL: of none */
} Blocks;

/* Begun zeroed. Tells nothing about functions whose bounds are not known. */
ATTR_NODISCARD Status blocks_make(const ImplicitField *field, const Lattice *lattice, Pool *pool, Blocks *blocks,
                                  Error *error);
/* For the points of layer k: whether they have to be asked, and what stands for the value of the others. */
void blocks_of_layer(const Blocks *blocks, const Lattice *lattice, uint32_t k, uint8_t *wanted, double *values);
void blocks_clear(Blocks *blocks);

#endif
