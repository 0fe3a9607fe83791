/* merge_tiles.h - parts of a picture that were rendered with --crop, put together.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MERGE_TILES_H
#define MEN_MERGE_TILES_H

#include "render/checkpoint.h"

/* The attribute of EXR files that says which pixels were rendered, as --crop takes them: "x0,y0,x1,y1". */
#define TILE_ATTRIBUTE "meniscus/crop"

typedef struct Tiles {
    Image image;
    bool *covered;         /* of each pixel, in rows: whether a part has it */
    Attributes attributes; /* what the first part says, but for what is not of the whole */
    uint64_t counts[2];    /* crossings and nesting faults of all parts */
} Tiles;

/* Whether a file is such a part, and no slice of samples, whether of a part or not. What cannot be read is none. */
bool tile_is(const char *path);
/* Puts parts together; of pixels that several have, those of the first. STATUS_INPUT names one that is none, and what differs where they
 * are not of one picture. tiles_clear is due in any case. */
ATTR_NODISCARD Status tiles_read(const char *const *paths, size_t n, Tiles *tiles, Error *error);
/* A rectangle of pixels that no part has: x0, y0, x1, y1; false: there is none. It counts as covered then. */
bool tiles_take_gap(Tiles *tiles, uint32_t gap[4]);
void tiles_clear(Tiles *tiles);

#endif
