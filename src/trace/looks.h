/* looks.h - what shading asks first of an object that was hit, side by side, and surfaces that are all alike as one: rows
 * of objects and surfaces are large, and loops of a scene make thousands of them that differ in nothing, so that each hit
 * would wait for its own from far away in memory.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LOOKS_H
#define MEN_LOOKS_H

#include "base/status.h"
#include "scene/scene.h"

typedef struct ObjectLook {
    uint32_t surface; /* the first of those that are the same but for their names; SCENE_NONE: none */
    uint32_t light;   /* as the scene has it: SCENE_NONE when it does not shine */
    uint32_t whole;   /* scene_whole() */
    uint32_t thing;   /* the first part of that with the same surface: what single bright samples are shared out over */
    bool shines;      /* it is a light, or its surface gives light */
    bool catches;     /* shadows, see catcher.h */
    uint64_t identity; /* scene_texture_identity() where the object has a frame for textures, else 0 */
} ObjectLook;

/* One for each object; malloc'd. */
ATTR_NODISCARD Status looks_find(const Scene *scene, ObjectLook **looks, Error *error);

#endif
