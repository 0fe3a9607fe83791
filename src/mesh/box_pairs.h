/* box_pairs.h - which of many boxes come near each other.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BOX_PAIRS_H
#define MEN_BOX_PAIRS_H

#include <stdint.h>

#include "base/status.h"
#include "base/vec3.h"

/* A box with what belongs around it. Empty boxes come near nothing. */
typedef Box3 BoxAt(const void *context, uint32_t number);
/* Boxes a < b meet; what it returns, unless STATUS_OK, ends the search. */
typedef Status BoxPairVisit(void *context, uint32_t a, uint32_t b, Error *error);

/* Visits every pair of n boxes that have a point in common, each once, in no particular order. Time grows with
 * n log n and the number of pairs, however the boxes are spread; memory is at most 56 bytes a box. What the visitor
 * refuses, or STATUS_NOMEM. */
ATTR_NODISCARD Status box_pairs_visit(uint32_t n, BoxAt *box_at, BoxPairVisit *visit, void *context, Error *error);

#endif
