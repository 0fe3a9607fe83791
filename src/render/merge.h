/* merge.h - slices of one render into the picture of all samples, bit for bit that of a render that was not sliced.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MERGE_H
#define MEN_MERGE_H

#include "render/checkpoint.h"

/* Slices in the order of their samples. */
typedef struct Merge {
    Checkpoint *parts;
    size_t n;
} Merge;

/* Reads the heads of all files. STATUS_INPUT where they are not finished slices of one render, without samples that two of them
 * hold: says which, and what differs. merge_clear is due in any case. The paths must live as long. */
ATTR_NODISCARD Status merge_open(const char *const *paths, size_t n, Merge *merge, Error *error);
void merge_clear(Merge *merge);
/* The first samples at or behind *first that no slice holds, from *first up to but without *end, counted from 0; false: none. */
bool merge_find_gap(const Merge *merge, uint32_t *first, uint32_t *end);
/* What all samples come to; one file after the other, row by row: it takes the memory of one state, however many they are. Where
 * there are gaps it is good for a picture, but not to be gone on from. */
ATTR_NODISCARD Status merge_read(Merge *merge, RenderState *state, Error *error);

#endif
