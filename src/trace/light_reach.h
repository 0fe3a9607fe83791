/* light_reach.h - which lights can be seen straight from within which media.
 *
 * A straight ray to a light is blocked wherever the index changes. So from within a medium only what stands in one of the
 * same index is worth a look: not the sky from under water, not a lamp outside from within a glass of tea. Looks that would
 * be blocked cost as much as others, and take their share of the samples.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_REACH_H
#define MEN_LIGHT_REACH_H

#include "trace/world.h"

/* Sets world->reach and reach_through: of each medium REACH_FAR, REACH_NEAR, both or neither. What may come is told apart by bounds, so that
 * nothing is left out that could be found; but whether any of the lights nearby stands in the world's own medium, by
 * some places of each: should none of these, but some other place be there, it is found by chance. World's lights
 * and slabs are to be known. STATUS_NOMEM. */
ATTR_NODISCARD Status light_reach_find(World *world, Error *error);

#endif
