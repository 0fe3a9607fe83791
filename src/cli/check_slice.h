/* check_slice.h - the picture of a cross-section that `check --slice` makes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CHECK_SLICE_H
#define MEN_CHECK_SLICE_H

#include "base/json.h"
#include "cli/options.h"
#include "check/slice.h"
#include "cli/check_rays.h"

typedef struct CheckSlice {
    bool wanted;
    Vec3 point, normal;
    bool has_region;
    double region[4];       /* left, bottom, right, top, in the plane, from the point */
    uint32_t width, height; /* 0: as the region's shape wants it */
    char *path;
    SlicePlane plane;
    SliceImage image;
    const CheckRays *rays; /* that are drawn over it; not owned */
} CheckSlice;

/* Reads the options, before any work is done; STATUS_USAGE. check_slice_clear is due in every case. */
ATTR_NODISCARD Status check_slice_init(CheckSlice *slice, const Options *options, Error *error);
void check_slice_clear(CheckSlice *slice);
/* Draws the slice, and rays over it, and writes the file. */
ATTR_NODISCARD Status check_slice_make(CheckSlice *slice, const CompiledScene *compiled, const CheckRays *rays,
                                       Pool *pool, Error *error);
/* What the colours mean, as text and as the member "slice". */
void check_slice_print(const CheckSlice *slice, const CompiledScene *compiled, Buf *out);
void check_slice_print_json(const CheckSlice *slice, const CompiledScene *compiled, JsonWriter *json);

#endif
