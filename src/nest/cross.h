/* cross.h - what crossing a hull does to the medium that a ray travels in.
 * Pure bookkeeping on hulls, ranks and media: no geometry, no scene. One data structure (list.h), one
 * operation, four policies (order.h).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CROSS_H
#define MEN_CROSS_H

#include "nest/list.h"
#include "nest/order.h"

#define NEST_WORLD UINT32_MAX /* "owner" of a point that no hull holds */

/* The hull that owns the point: the top of the list, NEST_WORLD when there is none. */
static inline uint32_t nest_owner(const NestOrder *order, const NestList *list)
{
    uint32_t top = list->n ? nest_list_items(list)[list->n - 1] : NEST_WORLD;
    return top < order->n_hulls && !nest_mixes(order, top) ? top : NEST_WORLD; /* operands alone are nothing */
}
/* The medium there. */
static inline uint32_t nest_medium(const NestOrder *order, const NestList *list)
{
    return list->n ? order->medium[nest_list_items(list)[list->n - 1]] : order->world_medium;
}

/* One crossing of the surface of one hull, or of one operand of a combination. */
typedef struct NestPass {
    uint32_t hull;
    bool entering; /* from the geometric normal, never the shading normal */
} NestPass;

typedef struct NestCrossing {
    uint32_t medium_from, medium_to; /* equal: the surface is not there, go on with the new list */
    uint32_t owner_from, owner_to;   /* hulls, or NEST_WORLD */
    uint32_t n_faults;               /* passes whose direction disagreed with the list; the list was healed */
    bool opaque;                     /* the surface of an opaque combination is here */
} NestCrossing;

/* Crosses all n surfaces that stand at one distance, together, and leaves the list as it is behind them.
 * Passes of one hull in both directions (a ray through an edge) cancel; repeated passes of one hull in one
 * direction (an edge reported by both its triangles) count once. The order of the passes does not
 * matter, except that under NEST_ENTERED hulls are entered in the order given.
 * O(n * depth); no locks. On STATUS_NOMEM the list is as it was. */
ATTR_NODISCARD Status nest_cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                                 NestCrossing *crossing);

/* The same for one surface, as most are. */
ATTR_NODISCARD static inline Status nest_cross_one(NestList *list, const NestOrder *order, NestPass pass,
                                                   NestCrossing *crossing)
{
    if (UNLIKELY(!order->sorted || list->n == list->capacity)) return nest_cross(list, order, &pass, 1, crossing);
    /* A sorted list shows by a hull's place whether the hull is there. */
    const uint32_t *items = nest_list_items(list);
    uint32_t n = list->n, place = n, rank = order->rank[pass.hull];
    while (place > 0 && order->rank[items[place - 1]] > rank) place--;
    bool on_top = place == n, inside = place > 0 && items[place - 1] == pass.hull;
    crossing->owner_from = crossing->owner_to = nest_owner(order, list);
    crossing->medium_from = crossing->medium_to = nest_medium(order, list);
    crossing->opaque = false;
    crossing->n_faults = inside == pass.entering;
    if (UNLIKELY(inside == pass.entering)) return STATUS_OK;
    if (inside)
        nest_list_remove(list, place - 1);
    else
        nest_list_insert(list, place, pass.hull);
    if (on_top) {
        crossing->owner_to = nest_owner(order, list);
        crossing->medium_to = nest_medium(order, list);
    }
    return STATUS_OK;
}

#endif
