/* implicit_blocks.c - an implicit surface crosses few of the blocks of a grid: large blocks are bounded first, and cut into
 * smaller ones where they can be crossed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/implicit_blocks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LARGE = 8 }; /* blocks along each side of the largest that are bounded: a power of 2 */

typedef struct Search {
    const ImplicitField *field;
    const Lattice *lattice;
    const Blocks *blocks;
    uint32_t n_large[3];
} Search;

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

/* The points of the grid from point `first` to point `last`; computed as the points are, so that rounding leaves none out. */
static Box3 box_of_points(const Lattice *lattice, const uint32_t first[3], const uint32_t last[3])
{
    return (Box3){lattice_point(lattice, first[0], first[1], first[2]),
                  lattice_point(lattice, last[0], last[1], last[2])};
}

static int side_of(const ImplicitField *field, Box3 box)
{
    double low, high;
    if (!field->bounds(field->context, box, &low, &high)) return 0;
    return low > 0 ? 1 : high <= 0 ? -1 : 0;
}

static void search(const Search *s, const uint32_t at[3], uint32_t size)
{
    uint32_t first[3], last[3], end[3];
    for (int axis = 0; axis < 3; axis++) {
        if (at[axis] >= s->blocks->n[axis]) return;
        end[axis] = smaller(at[axis] + size, s->blocks->n[axis]);
        first[axis] = at[axis] * BLOCK_CELLS;
        last[axis] = smaller(end[axis] * BLOCK_CELLS, s->lattice->n[axis] - 1);
    }
    int side = side_of(s->field, box_of_points(s->lattice, first, last));
    if (side == 0 && size > 1) {
        for (uint32_t k = 0; k < 8; k++) {
            const uint32_t half = size / 2;
            const uint32_t part[3] = {at[0] + (k & 1) * half, at[1] + (k >> 1 & 1) * half, at[2] + (k >> 2) * half};
            search(s, part, half);
        }
        return;
    }
    for (size_t k = at[2]; k < end[2]; k++)
        for (size_t j = at[1]; j < end[1]; j++)
            memset(s->blocks->sides + (k * s->blocks->n[1] + j) * s->blocks->n[0] + at[0], side, end[0] - at[0]);
}

static void task_of_row(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    const Search *s = context;
    for (uint32_t i = 0; i < s->n_large[0]; i++) {
        const uint32_t at[3] = {i * LARGE, index % s->n_large[1] * LARGE, index / s->n_large[1] * LARGE};
        search(s, at, LARGE);
    }
}

Status blocks_make(const ImplicitField *field, const Lattice *lattice, Pool *pool, Blocks *blocks, Error *error)
{
    double low, high;
    if (!field->bounds) return STATUS_OK;
    const uint32_t middle[3] = {lattice->n[0] / 2, lattice->n[1] / 2, lattice->n[2] / 2};
    if (!field->bounds(field->context, box_of_points(lattice, middle, middle), &low, &high)) return STATUS_OK;
    Search s = {.field = field, .lattice = lattice, .blocks = blocks};
    for (int axis = 0; axis < 3; axis++) {
        blocks->n[axis] = (lattice->n[axis] - 2) / BLOCK_CELLS + 1;
        s.n_large[axis] = (blocks->n[axis] - 1) / LARGE + 1;
    }
    size_t n_blocks = (size_t)blocks->n[0] * blocks->n[1] * blocks->n[2];
    blocks->sides = calloc(n_blocks, 1);
    if (!blocks->sides) return fail_memory(error, n_blocks, "an implicit surface");
    pool_run(pool, s.n_large[1] * s.n_large[2], task_of_row, &s);
    return STATUS_OK;
}

/* What the blocks of one layer of blocks say of the points of a layer of points. */
static void mark(const Blocks *blocks, const Lattice *lattice, size_t layer, uint8_t *wanted, double *values)
{
    const int8_t *side = blocks->sides + layer * blocks->n[1] * blocks->n[0];
    for (uint32_t j = 0; j < blocks->n[1]; j++)
        for (uint32_t i = 0; i < blocks->n[0]; i++, side++) {
            uint32_t i_end = smaller((i + 1) * BLOCK_CELLS, lattice->n[0] - 1);
            uint32_t j_end = smaller((j + 1) * BLOCK_CELLS, lattice->n[1] - 1);
            for (uint32_t y = j * BLOCK_CELLS; y <= j_end; y++)
                for (uint32_t x = i * BLOCK_CELLS; x <= i_end; x++) {
                    size_t at = (size_t)y * lattice->n[0] + x;
                    if (*side)
                        values[at] = *side;
                    else
                        wanted[at] = 1;
                }
        }
}

void blocks_of_layer(const Blocks *blocks, const Lattice *lattice, uint32_t k, uint8_t *wanted, double *values)
{
    memset(wanted, 0, (size_t)lattice->n[0] * lattice->n[1]);
    if (k < lattice->n[2] - 1) mark(blocks, lattice, k / BLOCK_CELLS, wanted, values);
    if (k > 0 && (k % BLOCK_CELLS == 0 || k == lattice->n[2] - 1))
        mark(blocks, lattice, (k - 1) / BLOCK_CELLS, wanted, values);
}

void blocks_clear(Blocks *blocks)
{
    free(blocks->sides);
    *blocks = (Blocks){.sides = NULL};
}
