/* ties.h - which of several surfaces at one place is met, where they are not those of clear bodies, which are crossed together.
 *
 * What shines wins over what does not, and a lamp over all else, wherever it shines towards the ray: so a panel lights a room in
 * whose ceiling it lies. From behind a lamp the other surface is seen. A plane without end loses against its like, and of two that
 * are left the one that is declared later is met. A thin sheet, which light may go through, loses against what it lies on: a ray
 * that went on through both of them would be behind a wall.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TIES_H
#define MEN_TIES_H

#include "scene/compile.h"

/* Whether a ray that comes to both objects at one place meets b rather than a. faces_a, faces_b: whether each turns its outer side to
 * the ray. */
bool ties_wins(const Scene *scene, uint32_t a, bool faces_a, uint32_t b, bool faces_b);
/* Of hits at one place the one that is met of those that are no boundary of clear bodies; NULL: there is none. */
const Hit *ties_met(const CompiledScene *compiled, const Hit *hits, size_t n);

/* Of each object, whether it shines and may have places where another one that does is met in its stead: what is looked for there
 * must not count, as no ray finds it. True is said more often than it is so. NULL where none does; malloc'd. */
ATTR_NODISCARD Status ties_find_yielding(const Scene *scene, bool **yields, Error *error);

#endif
