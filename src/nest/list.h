/* list.h - the interior list: the set of hulls that a ray is inside, the owner of the point last.
 * Where an order (order.h) has few levels, bits of a word say which of them are in, and nothing else is kept. Else hulls are
 * numbers in a row: up to NEST_INLINE cost no allocation; beyond that the list grows on the heap.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIST_H
#define MEN_LIST_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/status.h"

#ifndef NEST_INLINE
#define NEST_INLINE 12 /* a hostile build sets 1, so that every list grows */
#endif

/* At most so many levels are kept as bits, one each behind the lowest bit, which stands for the world. */
#define NEST_NARROW (NEST_INLINE > 1 ? 63 : 0)

/* The number of the medium outside of all hulls. */
#define NEST_WORLD_MEDIUM 0

/* Whose a point is. */
typedef struct NestTop {
    uint32_t level;  /* of the owner (order.h), 0 where it is the world */
    uint32_t medium; /* there */
} NestTop;

/* What is known of a point without the row: all, where hulls are kept as bits. */
typedef struct NestPoint {
    uint64_t mask; /* bit 0, and the levels of those that are kept as bits */
    NestTop top;
} NestPoint;

typedef struct NestList {
    NestPoint point;
    uint32_t n; /* how many are kept in a row */
    uint32_t capacity;
    uint32_t *grown; /* NULL while inline */
    uint32_t hulls_inline[NEST_INLINE];
} NestList;

/* Takes all hulls out. */
static inline void nest_list_empty(NestList *list)
{
    list->point = (NestPoint){1, {0, NEST_WORLD_MEDIUM}};
    list->n = 0;
}
static inline void nest_list_init(NestList *list)
{
    nest_list_empty(list);
    list->capacity = NEST_INLINE;
    list->grown = NULL;
}
/* Frees what has grown; the list is empty and usable afterwards. */
static inline void nest_list_clear(NestList *list)
{
    if (UNLIKELY(list->grown != NULL)) free(list->grown);
    nest_list_init(list);
}
/* How many hulls there are. */
static inline uint32_t nest_list_count(const NestList *list)
{
    uint32_t n = list->n;
    for (uint64_t bits = list->point.mask & (list->point.mask - 1); bits; bits &= bits - 1) n++;
    return n;
}
/* Those that are kept in a row. */
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
    to->point = from->point;
    to->n = from->n;
    if (LIKELY(!from->n)) return STATUS_OK;
    if (UNLIKELY(from->grown || to->grown)) return nest_list_copy_grown(to, from);
    memcpy(to->hulls_inline, from->hulls_inline, sizeof to->hulls_inline); /* all at once is faster than those in use */
    return STATUS_OK;
}
static inline void nest_list_swap(NestList *a, NestList *b)
{
    NestList swap = *a;
    *a = *b;
    *b = swap;
}
/* Whether a hull is in the row. */
bool nest_list_has(const NestList *list, uint32_t hull);
/* Into the row. There must be room. place 0 .. n; what stands there moves up. */
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
