/* report_copies.c - objects of which several are at one place, as of a loop that does not use its variable.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "check/report_parts.h"
#include "mesh/equal.h"

typedef struct Copies {
    const CompiledScene *compiled;
    const Box3 *bounds; /* of each object */
} Copies;

/* Two lamps at one place are warned of elsewhere. */
static bool may_be_copy(const Copies *copies, uint32_t i)
{
    const SceneObject *object = &copies->compiled->scene->objects[i];
    return object->part_of == SCENE_NONE && object->light == SCENE_NONE && object->motion == SCENE_NONE &&
           !box3_is_empty(copies->bounds[i]) && !box3_is_unbounded(copies->bounds[i]);
}

static uint32_t hash_object(const void *context, uint32_t i)
{
    const Copies *copies = context;
    const SceneObject *object = &copies->compiled->scene->objects[i];
    if (!may_be_copy(copies, i)) return hash_u32(i);
    uint64_t hash = hash_bytes(&copies->bounds[i], sizeof copies->bounds[i], object->span.begin);
    return (uint32_t)hash_bytes(&object->to_world, sizeof object->to_world, hash);
}

static bool same_object(const void *context, uint32_t i, uint32_t k)
{
    const Copies *copies = context;
    const SceneObject *a = &copies->compiled->scene->objects[i], *b = &copies->compiled->scene->objects[k];
    if (!may_be_copy(copies, i) || !may_be_copy(copies, k) || !span_same_place(a->span, b->span)) return false;
    /* two triangles may have one box */
    return memcmp(&copies->bounds[i], &copies->bounds[k], sizeof copies->bounds[i]) == 0 &&
           memcmp(&a->to_world, &b->to_world, sizeof a->to_world) == 0 && a->volume == b->volume &&
           (a->volume > 0 || a->tree != SCENE_NONE || a->shape == b->shape);
}

static void report_one(const SceneObject *object, uint32_t n_objects, uint32_t n_places, Diag *diag)
{
    Diagnostic *report = n_places == 1
                             ? diag_report(diag, D_SAME_PLACE, object->span,
                                           "%u objects of one kind are here, all at one place", (unsigned)n_objects)
                             : diag_report(diag, D_SAME_PLACE, object->span,
                                           "%u objects of one kind are here at only %u places, several at each",
                                           (unsigned)n_objects, (unsigned)n_places);
    diag_hint(diag, report, "what places them has to differ: in for (i in 1..5), say, translate(<2 * i, 0, 0>)");
}

void report_copies(const CompiledScene *compiled, const Box3 *bounds, Diag *diag)
{
    const Copies copies = {compiled, bounds};
    const EqualItems items = {&copies, hash_object, same_object};
    const Scene *scene = compiled->scene;
    uint32_t *first, *n_of = calloc((size_t)scene->n_objects + 1, sizeof *n_of);
    uint32_t n_objects[REPORT_MOST] = {0}; /* of a line, at all of its places */
    Error unused;                          /* a remark is not worth a failure */
    ReportLikes likes = {.n = 0};          /* places where there are several, by the line */
    if (!n_of || equal_find(&items, scene->n_objects, "objects at one place", NULL, &first, &unused) != STATUS_OK) {
        free(n_of);
        return;
    }
    for (uint32_t i = 0; i < scene->n_objects; i++) n_of[first[i]]++;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        if (n_of[i] < 2) continue;
        uint32_t line = report_count_like(&likes, &scene->objects[i], &scene->objects[i], i);
        if (line < REPORT_MOST) n_objects[line] += n_of[i];
    }
    for (uint32_t k = 0; k < likes.n; k++)
        report_one(&scene->objects[likes.first[k]], n_objects[k], likes.counts[k], diag);
    report_others(diag, D_SAME_PLACE, likes.n_others);
    free(first);
    free(n_of);
}
