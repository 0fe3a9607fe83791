/* nanovdb.h - grids of numbers from NanoVDB files (.nvdb), as smoke and flames are simulated and exchanged.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_NANOVDB_H
#define MEN_NANOVDB_H

#include "optics/volume.h"

/* Reads a grid of numbers (float, double, Fp4, Fp8, Fp16, FpN) from a file that is stored plainly, or compressed by ZIP or
 * BLOSC. grid: its name; NULL: the only one in the file. The volume's map is the file's, from its own lengths to voxels.
 * Values must be 0 or more, and finite. most_bytes: of memory, for the file, the unpacked grid and the volume each.
 * STATUS_INPUT when the file cannot be read, is broken or has no such grid, with a text that names file and grid, and the
 * grids that there are; STATUS_NOMEM. */
ATTR_NODISCARD Status nanovdb_read(const char *path, const char *grid, size_t most_bytes, Volume **out, Error *error);

/* What a file says of one of its grids. */
typedef struct NanovdbGrid {
    const char *name;           /* as long as the visit */
    const char *type;           /* "float", "Fp8", ...; "?" for what is not known */
    bool readable;              /* by nanovdb_read, as far as its type goes */
    uint64_t n_voxels, n_bytes; /* voxels that are set, bytes in memory */
    int32_t n[3];               /* voxels that it spans */
    Box3 box;                   /* in the file's own lengths */
    double voxel[3];            /* size of one */
} NanovdbGrid;

/* Visits all grids of a file. STATUS_INPUT, also for a file without any, STATUS_NOMEM. */
ATTR_NODISCARD Status nanovdb_visit(const char *path, void (*visit)(void *context, const NanovdbGrid *grid),
                                    void *context, Error *error);

#endif
