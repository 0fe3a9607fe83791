/* compile_bare.c - a compiled scene with nothing in it but lights and what catches shadows.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "scene/compile.h"

/* What is to be kept. Of a combination all operands are, if one of them is: they cut each other. Fails when memory ends. */
static bool *find_kept(const Scene *scene, bool *any)
{
    bool *kept = calloc(scene->n_objects + (size_t)1, sizeof *kept);
    *any = false;
    for (uint32_t i = 0; kept && i < scene->n_objects; i++)
        if (scene_is_catcher(scene, i)) *any = kept[scene_whole(scene, i)] = true;
    for (uint32_t i = 0; kept && i < scene->n_objects; i++)
        kept[i] = kept[scene_whole(scene, i)] || scene->objects[i].light != SCENE_NONE;
    return kept;
}

typedef struct Keeping {
    const CompiledScene *compiled;
    const bool *kept;
} Keeping;

static RtcObject describe_kept(const void *context, uint32_t i)
{
    const Keeping *keeping = context;
    RtcObject described = compiled_describe(keeping->compiled, i);
    if (keeping->kept[i]) return described;
    described.mesh = described.mesh_end = NULL;
    described.solid = NULL;
    return described;
}

/* Of the objects that are half of space, those that are there. */
static bool keep_planes(CompiledScene *bare, const bool *kept)
{
    const uint32_t *planes = bare->planes;
    uint32_t n = bare->n_planes;
    bare->planes = malloc((n + (size_t)1) * sizeof *bare->planes);
    bare->n_planes = 0;
    for (uint32_t i = 0; bare->planes && i < n; i++)
        if (kept[planes[i]]) bare->planes[bare->n_planes++] = planes[i];
    return bare->planes != NULL;
}

static Status keep(CompiledScene *bare, const CompiledScene *compiled, const bool *kept, unsigned n_threads,
                   Error *error)
{
    const Scene *scene = compiled->scene;
    const Keeping keeping = {compiled, kept};
    *bare = *compiled;
    bare->rtc = NULL;
    if (!keep_planes(bare, kept)) return fail_memory(error, scene->n_objects * sizeof *bare->planes, "shadow catchers");
    return rtc_scene_new_from(describe_kept, &keeping, scene->n_objects, scene->n_keys, n_threads, &bare->rtc, error);
}

Status compiled_bare_new(const CompiledScene *compiled, unsigned n_threads, CompiledScene **out, Error *error)
{
    bool any;
    bool *kept = find_kept(compiled->scene, &any);
    CompiledScene *bare = any ? malloc(sizeof *bare) : NULL;
    Status status = STATUS_OK;
    *out = NULL;
    if (!kept || (any && !bare))
        status = fail_memory(error, compiled->scene->n_objects, "shadow catchers");
    else if (any)
        status = keep(bare, compiled, kept, n_threads, error);
    free(kept);
    if (status == STATUS_OK)
        *out = bare;
    else
        compiled_bare_free(bare);
    return status;
}

void compiled_bare_free(CompiledScene *bare)
{
    if (!bare) return;
    rtc_scene_free(bare->rtc);
    free(bare->planes);
    free(bare);
}
