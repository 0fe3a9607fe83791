/* combination_alike.h - combinations of objects that are the same but for an affine map, as instances of one prototype are,
 * whatever they are made of.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMBINATION_ALIKE_H
#define MEN_COMBINATION_ALIKE_H

#include "base/pool.h"
#include "scene/scene.h"

/* (*first)[i] is the first of the n trees (of scene->trees) that trees[i] is the same as, but for the map from the frame of
 * the one's first operand to that of the other's, to about 1e-9 of their size; i itself where there is none before it.
 * Those that move, too, if their operands do not move against each other. malloc'd. STATUS_NOMEM. */
ATTR_NODISCARD Status combination_find_alike(const Scene *scene, const uint32_t *trees, uint32_t n, Pool *pool,
                                             uint32_t **first, Error *error);
/* The first operand, of which there must be one: its frame is what those that are alike are compared in. */
static inline const SceneObject *combination_first_operand(const Scene *scene, uint32_t tree)
{
    return &scene->objects[scene->operands[scene->parts[scene->trees[tree].root].begin]];
}
/* How many times as large a volume is in the world as in that frame; of one that moves in the mean of the shutter's time. */
double combination_scale(const Scene *scene, uint32_t tree);
/* Where an object is at a key of the scene's; at key 0 where nothing moves. */
static inline const Affine *combination_place(const Scene *scene, const SceneObject *object, uint32_t key)
{
    const Affine *keys = scene_keys(scene, object);
    return keys ? &keys[key] : &object->to_world;
}

#endif
