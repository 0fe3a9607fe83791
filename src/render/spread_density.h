/* spread_density.h - how close together the samples of a thing that stand alone lie, around each of its cells.
 *
 * A disc around a sample may reach to where there are none like it: behind a wall in haze, into the part of a thing that no light
 * comes to. Where it holds many, the emptiness of a part of it is no chance, and that part gets less, or nothing. So the density at
 * the place that gets is compared with that of the disc: it is that of the least square around which holds enough of them (a nearest-
 * neighbour estimate, as the discs themselves are, but from the side that gets). Where those that are as bright are too few to tell,
 * there may be many others: no bright light comes where none comes at all. So all that brought any light are a kind, too.
 * Private to src/render/spread*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPREAD_DENSITY_H
#define MEN_SPREAD_DENSITY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/pool.h"

/* Samples are told apart by how bright they are: those of a power of two and more are a kind. */
enum { DENSITY_KINDS = 256, DENSITY_ANY = 0 /* the kind of all that brought light, alone or not */ };

typedef struct DensityOfKind {
    uint32_t *counts; /* of samples in all cells above and to the left of a corner; NULL: not asked for yet */
    float *around;    /* for each share in the thing, around each cell; HUGE_VALF: too few are there to tell */
} DensityOfKind;

typedef struct Densities {
    uint32_t width, height; /* in cells */
    double *shares;         /* in the thing, of all cells above and to the left of a corner */
    DensityOfKind kinds[DENSITY_KINDS];
} Densities;

/* Cells from x0, y0 up to but without x1, y1. */
typedef struct CellSquare {
    uint32_t x0, y0, x1, y1;
} CellSquare;

/* How many samples of a light and more a cell has; least 0: of any. */
typedef uint32_t (*DensityCount)(const void *context, size_t cell, float least);

/* shares: of each cell, by rows. false when memory ends; density_clear is due in any case. */
bool density_init(Densities *densities, uint32_t width, uint32_t height, const double *shares);
void density_clear(Densities *densities);
/* The kind that a sample's comparable ones are of. */
int density_kind(float least);
/* Makes a kind known, if it is not. false when memory ends. */
bool density_find(Densities *densities, int kind, DensityCount count, const void *context, Pool *pool);
/* For each share, of the cells of a square; of a known kind. 0 where nothing of the thing is. */
double density_within(const Densities *densities, int kind, CellSquare square);

/* The part of what a cell would get by its light that it gets by how close samples lie there, where those of the disc lie that close.
 * Half as close is chance; and any light at all is so uneven by itself that a tenth says nothing. */
static inline double density_part(const Densities *densities, int kind, size_t cell, double of_disc)
{
    double part = (kind == DENSITY_ANY ? 10 : 2) * (double)densities->kinds[kind].around[cell] / of_disc;
    return part < 1 ? part * part : 1;
}

#endif
