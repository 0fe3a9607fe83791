/* box_cells.c - a table over a grid of cells of which boxes are where.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/box_cells.h"

#include <math.h>
#include <stdlib.h>

static uint32_t cell_along(double x, double low, double per_length, uint32_t n)
{
    double cell = floor((x - low) * per_length);
    return cell <= 0 ? 0 : cell >= n ? n - 1 : (uint32_t)cell;
}

static void cell_of(const BoxCells *cells, Vec3 p, uint32_t cell[3])
{
    cell[0] = cell_along(p.x, cells->bounds.min.x, cells->per_length.x, cells->n[0]);
    cell[1] = cell_along(p.y, cells->bounds.min.y, cells->per_length.y, cells->n[1]);
    cell[2] = cell_along(p.z, cells->bounds.min.z, cells->per_length.z, cells->n[2]);
}

static size_t cell_number(const BoxCells *cells, const uint32_t cell[3])
{
    return ((size_t)cell[2] * cells->n[1] + cell[1]) * cells->n[0] + cell[0];
}

/* Counts (items NULL) or lists the boxes of each cell; first[] must be zero, or the ends of the cells. */
static void sort_boxes(BoxCells *cells, const Box3 *boxes, size_t stride, size_t n_boxes, uint32_t *items)
{
    for (size_t i = n_boxes; i > 0; i--) {
        const Box3 *box = (const Box3 *)(const void *)((const char *)boxes + (i - 1) * stride);
        uint32_t low[3], high[3], cell[3];
        cell_of(cells, box->min, low);
        cell_of(cells, box->max, high);
        for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
            for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
                for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
                    size_t number = cell_number(cells, cell);
                    if (items)
                        items[--cells->first[number]] = (uint32_t)(i - 1);
                    else
                        cells->first[number]++;
                }
    }
}

Status box_cells_make(BoxCells *cells, Box3 bounds, double per_box, uint32_t most, const Box3 *boxes, size_t stride,
                      size_t n_boxes, const char *what, Error *error)
{
    *cells = (BoxCells){.bounds = bounds};
    const double sides[3] = {bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y, bounds.max.z - bounds.min.z};
    double size = cbrt(sides[0] * sides[1] * sides[2] / (per_box * (double)n_boxes));
    for (int axis = 0; axis < 3; axis++) cells->n[axis] = (uint32_t)fmin(fmax(sides[axis] / size, 1), most);
    cells->per_length = vec3(cells->n[0] / sides[0], cells->n[1] / sides[1], cells->n[2] / sides[2]);
    size_t n_cells = (size_t)cells->n[0] * cells->n[1] * cells->n[2];
    cells->first = calloc(n_cells + 1, sizeof *cells->first);
    if (!cells->first) return fail_memory(error, n_cells * sizeof *cells->first, what);
    sort_boxes(cells, boxes, stride, n_boxes, NULL);
    uint64_t total = 0;
    for (size_t i = 0; i < n_cells; i++) {
        total += cells->first[i];
        if (total >= UINT32_MAX) return fail(error, STATUS_SCENE, "%s has too many parts in one place", what);
        cells->first[i] = (uint32_t)total;
    }
    cells->first[n_cells] = (uint32_t)total;
    cells->items = malloc((total + 1) * sizeof *cells->items);
    if (!cells->items) return fail_memory(error, total * sizeof *cells->items, what);
    sort_boxes(cells, boxes, stride, n_boxes, cells->items);
    return STATUS_OK;
}

void box_cells_clear(BoxCells *cells)
{
    free(cells->first);
    free(cells->items);
    *cells = (BoxCells){.first = NULL};
}

const uint32_t *box_cells_at(const BoxCells *cells, Vec3 p, uint32_t *n)
{
    uint32_t cell[3];
    cell_of(cells, p, cell);
    size_t number = cell_number(cells, cell);
    *n = cells->first[number + 1] - cells->first[number];
    return cells->items + cells->first[number];
}

BoxCellsRange box_cells_range(const BoxCells *cells, Box3 box)
{
    BoxCellsRange range = {.n = 1};
    cell_of(cells, box.min, range.low);
    cell_of(cells, box.max, range.high);
    for (int axis = 0; axis < 3; axis++) {
        range.at[axis] = range.low[axis];
        range.n *= range.high[axis] - range.low[axis] + 1;
    }
    return range;
}

bool box_cells_next(const BoxCells *cells, BoxCellsRange *range, const uint32_t **items, uint32_t *n)
{
    if (range->at[2] > range->high[2]) return false;
    size_t number = cell_number(cells, range->at);
    *items = cells->items + cells->first[number];
    *n = cells->first[number + 1] - cells->first[number];
    for (int axis = 0; axis < 3; axis++) {
        if (++range->at[axis] <= range->high[axis] || axis == 2) break;
        range->at[axis] = range->low[axis];
    }
    return true;
}
