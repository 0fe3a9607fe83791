/* list.h - the interior list: the set of hulls that a ray is inside, the owner of the point last.
 * Up to NEST_INLINE hulls cost no allocation; beyond that the list grows on the heap.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIST_H
#define MEN_LIST_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/status.h"

#ifndef NEST_INLINE
#define NEST_INLINE 12 /* a hostile build sets 1, so that every list grows */
#endif

typedef struct NestList {
    uint32_t n, capacity;
    uint32_t *grown; /* NULL while inline */
    uint32_t hulls_inline[NEST_INLINE];
} NestList;

static inline void nest_list_init(NestList *list)
{
    list->n = 0;
    list->capacity = NEST_INLINE;
    list->grown = NULL;
}
/* Frees what has grown; the list is empty and usable afterwards. */
void nest_list_clear(NestList *list);
static inline uint32_t *nest_list_hulls(NestList *list)
{
    return list->grown ? list->grown : list->hulls_inline;
}
static inline const uint32_t *nest_list_items(const NestList *list)
{
    return list->grown ? list->grown : list->hulls_inline;
}
/* Makes room for `more` further hulls, so that inserting them cannot fail. */
ATTR_NODISCARD Status nest_list_grow(NestList *list, uint32_t more);
static inline Status nest_list_reserve(NestList *list, uint32_t more)
{
    return LIKELY(more <= list->capacity - list->n) ? STATUS_OK : nest_list_grow(list, more);
}
Status nest_list_copy_grown(NestList *to, const NestList *from);
/* Makes *to equal to *from (each branch of a path has its own list). STATUS_NOMEM leaves *to empty. */
ATTR_NODISCARD static inline Status nest_list_copy(NestList *to, const NestList *from)
{
    if (UNLIKELY(from->grown || to->grown)) return nest_list_copy_grown(to, from);
    to->n = from->n;
    memcpy(to->hulls_inline, from->hulls_inline, sizeof to->hulls_inline); /* all at once is faster than those in use */
    return STATUS_OK;
}
static inline void nest_list_swap(NestList *a, NestList *b)
{
    NestList swap = *a;
    *a = *b;
    *b = swap;
}
bool nest_list_has(const NestList *list, uint32_t hull);
/* There must be room. place 0 .. n; what stands there moves up. */
static inline void nest_list_insert(NestList *list, uint32_t place, uint32_t hull)
{
    uint32_t *items = nest_list_hulls(list);
    for (uint32_t i = list->n; i > place; i--) items[i] = items[i - 1];
    items[place] = hull;
    list->n++;
}
static inline void nest_list_remove(NestList *list, uint32_t place)
{
    uint32_t *items = nest_list_hulls(list);
    list->n--;
    for (uint32_t i = place; i < list->n; i++) items[i] = items[i + 1];
}

#endif
