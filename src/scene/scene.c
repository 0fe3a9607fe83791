/* scene.c - letting go of a scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene.h"

#include <stdlib.h>

void scene_free(Scene *scene)
{
    if (!scene) return;
    for (uint32_t i = 0; i < scene->n_shapes; i++) {
        mesh_free(scene->shapes[i].mesh);
        solid_free(scene->shapes[i].solid);
    }
    environment_free(scene->environment);
    arena_clear(&scene->arena);
    free(scene);
}
