/* levels.c - hulls that share a level of the order.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "scene/compile.h"

/* Hulls are of one kind where nothing but their shapes tells them apart. A medium that varies or shines does so in each
 * hull in its own way. Whether rays are to look for surfaces that they pass by in a hull changes no light, but the last bits
 * of a picture. */
static uint32_t kind_of(const CompiledScene *compiled, uint32_t hull)
{
    uint32_t number = compiled->hulls[hull].medium;
    const SceneMedium *medium = &compiled->scene->media[number];
    if (medium->density || medium->temperature || medium->emits || compiled->unbounded[hull]) return NEST_ALONE;
    bool passes = compiled->passing[compiled->order.top[hull].level].level > 0;
    return 2 * number + passes;
}

static Status share(CompiledScene *compiled, Error *error)
{
    if (compiled->order.narrow || !compiled->order.sorted) return STATUS_OK;
    size_t n = compiled->n_hulls;
    uint32_t *kinds = malloc(n * sizeof *kinds);
    if (!kinds) return fail_memory(error, n * sizeof *kinds, "the order of the hulls");
    for (uint32_t h = 0; h < n; h++) kinds[h] = kind_of(compiled, h);
    Status status = nest_order_share(&compiled->order, kinds, compiled->meetings, compiled->n_meetings, error);
    free(kinds);
    return status == STATUS_OK && compiled->order.narrow ? compiled_mark_stops(compiled, error) : status;
}

Status compiled_share_levels(CompiledScene *compiled, Error *error)
{
    Status status = share(compiled, error);
    free(compiled->meetings);
    compiled->meetings = NULL;
    compiled->n_meetings = 0;
    return status;
}
