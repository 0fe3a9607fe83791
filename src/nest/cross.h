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
 * The passes of one hull are in the order in which they are met: where the last goes another way than the first (a ray
 * through an edge) they cancel, else they count once (an edge reported by both its triangles, a ripple that is left, entered
 * and left). Apart from that their order does not matter, except that under NEST_ENTERED hulls are entered in the order given.
 * O(n * depth); no locks. On STATUS_NOMEM the list is as it was. */
ATTR_NODISCARD Status nest_cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                                 NestCrossing *crossing);

/* What crossing one surface comes to, before the list is changed. */
typedef struct NestStep {
    uint32_t hull, place; /* where in the list it goes, or behind which it is */
    bool entering, apt;   /* false: the list stays */
} NestStep;

/* Decides on the crossing of one surface, as most are, under a sorted order: a hull's place shows whether it is there. */
static inline NestStep nest_look(const NestList *list, const NestOrder *order, NestPass pass, NestCrossing *crossing)
{
    const uint32_t *items = nest_list_items(list);
    uint32_t n = list->n, place = n, rank = order->rank[pass.hull];
    while (place > 0 && order->rank[items[place - 1]] > rank) place--;
    bool inside = place > 0 && items[place - 1] == pass.hull, apt = inside != pass.entering;
    crossing->owner_from = crossing->owner_to = nest_owner(order, list);
    crossing->medium_from = crossing->medium_to = nest_medium(order, list);
    crossing->opaque = false;
    crossing->n_faults = !apt;
    if (apt && place == n) { /* on top */
        uint32_t owner = pass.entering ? pass.hull : n > 1 ? items[n - 2] : NEST_WORLD;
        crossing->owner_to = owner;
        crossing->medium_to = owner == NEST_WORLD ? order->world_medium : order->medium[owner];
    }
    return (NestStep){pass.hull, place, pass.entering, apt};
}

/* Changes the list, as it was looked at; it must have room for one more hull. */
static inline void nest_step(NestList *list, NestStep step)
{
    if (UNLIKELY(!step.apt)) return;
    if (step.entering)
        nest_list_insert(list, step.place, step.hull);
    else
        nest_list_remove(list, step.place - 1);
}

/* nest_cross for one surface. */
ATTR_NODISCARD static inline Status nest_cross_one(NestList *list, const NestOrder *order, NestPass pass,
                                                   NestCrossing *crossing)
{
    if (UNLIKELY(!order->sorted || list->n == list->capacity)) return nest_cross(list, order, &pass, 1, crossing);
    nest_step(list, nest_look(list, order, pass, crossing));
    return STATUS_OK;
}

#endif
