/* between_planes.h - where a combination of planes ends, though none of these does.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BETWEEN_PLANES_H
#define MEN_BETWEEN_PLANES_H

#include "scene/scene.h"

/* Around what the planes of a part, an intersection or a difference, leave of space, wherever they move together, moved by
 * `after` (NULL: not); without end where that is, where they move against each other, and where memory ends. */
Box3 between_planes(const Scene *scene, uint32_t part, const Affine *after);

#endif
