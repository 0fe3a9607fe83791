/* list.c - the interior list: growth, and what lists do that have grown.
 * SPDX-License-Identifier: Apache-2.0 */
#include "nest/list.h"

#include <stdlib.h>
#include <string.h>

Status nest_list_grow(NestList *list, uint32_t more)
{
    if (more > UINT32_MAX - list->n) return STATUS_NOMEM;
    uint32_t n = list->n + more, capacity = list->capacity;
    while (capacity < n) {
        if (capacity > UINT32_MAX / 2) return STATUS_NOMEM;
        capacity *= 2;
    }
    uint32_t *grown = realloc(list->grown, capacity * sizeof *grown);
    if (!grown) return STATUS_NOMEM;
    if (!list->grown) memcpy(grown, list->hulls_inline, list->n * sizeof *grown);
    list->grown = grown;
    list->capacity = capacity;
    return STATUS_OK;
}

Status nest_list_copy_grown(NestList *to, const NestList *from)
{
    nest_list_empty(to);
    TRY(nest_list_reserve(to, from->n));
    to->point = from->point;
    to->n = from->n;
    const uint32_t *items = nest_list_items(from);
    uint32_t *copies = nest_list_hulls(to);
    for (uint32_t i = 0; i < from->n; i++) copies[i] = items[i];
    return STATUS_OK;
}

bool nest_list_has(const NestList *list, uint32_t hull)
{
    const uint32_t *items = nest_list_items(list);
    for (uint32_t i = 0; i < list->n; i++)
        if (items[i] == hull) return true;
    return false;
}
