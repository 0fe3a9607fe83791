/* looks.c - finding surfaces that are alike.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/looks.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "mesh/equal.h"

/* All of a surface's bytes but its name. Where equal ones differ in what is between their parts, both are kept. */
static SceneSurface nameless(const Scene *scene, uint32_t surface)
{
    SceneSurface copy;
    memcpy(&copy, &scene->surfaces[surface], sizeof copy);
    copy.name = NULL;
    if (!copy.n_textures) copy.textures = NULL;
    return copy;
}

static uint32_t hash_of(const void *context, uint32_t i)
{
    SceneSurface surface = nameless(context, i);
    return (uint32_t)hash_bulk(&surface, sizeof surface, 0);
}

static bool same(const void *context, uint32_t i, uint32_t k)
{
    SceneSurface a = nameless(context, i), b = nameless(context, k);
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Of looks: parts of one whole with the same surface. */
static uint32_t hash_of_thing(const void *context, uint32_t i)
{
    const ObjectLook *look = &((const ObjectLook *)context)[i];
    return (uint32_t)hash_u64((uint64_t)look->whole << 32 | look->surface);
}

static bool is_one_thing(const void *context, uint32_t i, uint32_t k)
{
    const ObjectLook *a = &((const ObjectLook *)context)[i], *b = &((const ObjectLook *)context)[k];
    return a->whole == b->whole && a->surface == b->surface;
}

static Status find_things(ObjectLook *looks, uint32_t n, Error *error)
{
    const EqualItems items = {.context = looks, .hash = hash_of_thing, .same = is_one_thing};
    uint32_t *first = NULL;
    TRY(equal_find(&items, n, "comparing the parts of objects", NULL, &first, error));
    for (uint32_t i = 0; i < n; i++) looks[i].thing = first[i];
    free(first);
    return STATUS_OK;
}

Status looks_find(const Scene *scene, ObjectLook **looks, Error *error)
{
    const EqualItems items = {.context = scene, .hash = hash_of, .same = same};
    ObjectLook *made = *looks = malloc((scene->n_objects + (size_t)1) * sizeof *made);
    uint32_t *first = NULL;
    if (!made) return fail_memory(error, scene->n_objects * sizeof *made, "the looks of objects");
    TRY(equal_find(&items, scene->n_surfaces, "comparing surfaces", NULL, &first, error));
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        made[i] = (ObjectLook){.surface = object->surface == SCENE_NONE ? SCENE_NONE : first[object->surface],
                               .light = object->light,
                               .whole = scene_whole(scene, i),
                               .shines = object->light != SCENE_NONE || scene_surface_shines(scene, i),
                               .catches = scene_is_catcher(scene, i),
                               .identity = object->texture_frame == SCENE_NONE ? 0 : scene_texture_identity(scene, i)};
    }
    free(first);
    return find_things(made, scene->n_objects, error);
}
