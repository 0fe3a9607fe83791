/* box_cells.h - which of many boxes are where: a table over a grid of cells.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BOX_CELLS_H
#define MEN_BOX_CELLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"
#include "base/vec3.h"

typedef struct BoxCells {
    Box3 bounds;
    uint32_t n[3];
    Vec3 per_length; /* cells */
    uint32_t *first,
        *items; /* items[first[cell] .. first[cell + 1]]: the boxes that reach into a cell, in their order */
} BoxCells;

/* Of n_boxes that stand `stride` bytes apart, all within bounds that have a volume. The cells are about cubes, some `per_box` of them
 * for each box, `most` at most along an axis. STATUS_SCENE where more than 2^32 boxes are counted in all cells; `what` has them.
 * box_cells_clear is due in any case. */
ATTR_NODISCARD Status box_cells_make(BoxCells *cells, Box3 bounds, double per_box, uint32_t most, const Box3 *boxes,
                                     size_t stride, size_t n_boxes, const char *what, Error *error);
void box_cells_clear(BoxCells *cells);

/* The boxes that reach into the cell of a place, of which some may hold it; what is out of bounds has the nearest cell. */
const uint32_t *box_cells_at(const BoxCells *cells, Vec3 p, uint32_t *n);
/* The cells that a box reaches into, n of them, and the one that is next. */
typedef struct BoxCellsRange {
    uint32_t low[3], high[3], at[3];
    uint64_t n;
} BoxCellsRange;
BoxCellsRange box_cells_range(const BoxCells *cells, Box3 box);
/* The boxes that reach into the next of these cells, a box in each of its cells; false: all have been. */
bool box_cells_next(const BoxCells *cells, BoxCellsRange *range, const uint32_t **items, uint32_t *n);

#endif
