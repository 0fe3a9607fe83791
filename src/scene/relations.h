/* relations.h - how the hulls of a scene lie to each other. Private to src/scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RELATIONS_H
#define MEN_RELATIONS_H

#include "scene/compile.h"

/* Every pair of hulls that overlaps, touches or leaves a thin gap of world between them, in order of (a, b); a and b
 * are hulls here. *meetings: every pair that is not known for certain to be apart, at all times of the shutter. compiled
 * needs its rtc, hulls and hull_bounds. *pairs and *meetings are malloc'd. The same for any number of
 * threads. */
ATTR_NODISCARD Status relations_find(const CompiledScene *compiled, Pool *pool, HullPair **pairs, size_t *n_pairs,
                                     NestMeeting **meetings, size_t *n_meetings, Error *error);

#endif
