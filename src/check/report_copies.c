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

/* What one line of the text has placed: where several are, in the order of objects. */
typedef struct Row {
    const SceneObject *object;
    uint32_t n_places, n_objects;
} Row;

static void report_one(const Row *row, Diag *diag)
{
    Diagnostic *report =
        row->n_places == 1 ? diag_report(diag, D_SAME_PLACE, row->object->span,
                                         "%u objects of one kind are here, all at one place", (unsigned)row->n_objects)
                           : diag_report(diag, D_SAME_PLACE, row->object->span,
                                         "%u objects of one kind are here at only %u places, several at each",
                                         (unsigned)row->n_objects, (unsigned)row->n_places);
    diag_hint(diag, report, "what places them has to differ: in for (i in 1..5), say, translate(<2 * i, 0, 0>)");
}

void report_copies(const CompiledScene *compiled, const Box3 *bounds, Diag *diag)
{
    const Copies copies = {compiled, bounds};
    const EqualItems items = {&copies, hash_object, same_object};
    const Scene *scene = compiled->scene;
    uint32_t *first, *n_of = calloc((size_t)scene->n_objects + 1, sizeof *n_of), n_rows = 0, more = 0;
    Error unused; /* a remark is not worth a failure */
    Row rows[REPORT_MOST];
    if (!n_of || equal_find(&items, scene->n_objects, "objects at one place", NULL, &first, &unused) != STATUS_OK) {
        free(n_of);
        return;
    }
    for (uint32_t i = 0; i < scene->n_objects; i++) n_of[first[i]]++;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        uint32_t k = 0;
        if (n_of[i] < 2) continue;
        while (k < n_rows && !span_same_place(rows[k].object->span, scene->objects[i].span)) k++;
        if (k == REPORT_MOST) {
            more++;
            continue;
        }
        if (k == n_rows) rows[n_rows++] = (Row){.object = &scene->objects[i]};
        rows[k].n_places++;
        rows[k].n_objects += n_of[i];
    }
    for (uint32_t k = 0; k < n_rows; k++) report_one(&rows[k], diag);
    if (more) diag_report_nowhere(diag, D_SAME_PLACE, "%u more of the same kind", (unsigned)more);
    free(first);
    free(n_of);
}
