/* cross.h - what crossing a hull does to the medium that a ray travels in.
 * Pure bookkeeping on hulls, ranks and media: no geometry, no scene. One data structure (list.h), one
 * operation, four policies (order.h).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CROSS_H
#define MEN_CROSS_H

#include "nest/list.h"
#include "nest/order.h"

/* The hull that owns the point: the top of the list, NEST_WORLD when there is none. */
static inline uint32_t nest_owner(const NestOrder *order, const NestList *list)
{
    return order->hull_at[list->level];
}
/* The medium there. */
static inline uint32_t nest_medium(const NestOrder *order, const NestList *list)
{
    return order->medium_at[list->level];
}

/* One crossing of the surface of one hull, or of one operand of a combination. */
typedef struct NestPass {
    uint32_t hull;
    bool entering; /* from the geometric normal, never the shading normal */
} NestPass;

typedef struct NestCrossing {
    uint32_t medium_from, medium_to; /* equal: the surface is not there, go on with the new list */
    uint32_t n_faults;               /* passes whose direction disagreed with the list; the list was healed */
    bool opaque;                     /* the surface of an opaque combination is here */
    uint32_t owner_from, owner_to;   /* hulls, or NEST_WORLD; told by nest_cross alone */
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
    uint64_t mask; /* the list's, behind it, */
    uint32_t level;
    uint32_t n, hull, place; /* and of a row: where n changes, where the hull goes, or stands */
} NestStep;

/* nest_look in a row of hulls. */
NestStep nest_look_in_row(const NestList *list, const NestOrder *order, NestPass pass, NestCrossing *crossing);

/* Decides on the crossing of one surface, as most are, under a sorted order. crossing: at first nest_stay; its owners are not
 * told. */
static inline NestStep nest_look(const NestList *list, const NestOrder *order, NestPass pass, NestCrossing *crossing)
{
    if (UNLIKELY(!order->narrow)) return nest_look_in_row(list, order, pass, crossing);
    NestStep step;
    uint64_t bit = 1ULL << order->level[pass.hull];
    if (UNLIKELY(((list->mask & bit) != 0) == pass.entering)) {
        step.mask = list->mask;
        step.level = list->level;
        crossing->n_faults = 1;
        return step;
    }
    step.mask = list->mask ^ bit;
    step.level = HIGHEST_BIT(step.mask);
    crossing->medium_to = order->medium_at[step.level];
    return step;
}

/* Changes the list, as it was looked at; it must have room for one more hull. */
static inline void nest_step(NestList *list, const NestOrder *order, const NestStep *step)
{
    if (UNLIKELY(!order->narrow) && step->n != list->n) {
        if (step->n > list->n)
            nest_list_insert(list, step->place, step->hull);
        else
            nest_list_remove(list, step->place);
    }
    list->mask = step->mask;
    list->level = step->level;
}
/* Whether nest_look and nest_step will do. */
static inline bool nest_may_look(const NestList *list, const NestOrder *order)
{
    return LIKELY(order->narrow) || (order->sorted && list->n < list->capacity);
}

/* Where nothing is crossed. */
static inline NestCrossing nest_stay(const NestOrder *order, const NestList *list)
{
    uint32_t medium = nest_medium(order, list);
    return (NestCrossing){.medium_from = medium, .medium_to = medium};
}

/* nest_cross for one surface. */
ATTR_NODISCARD static inline Status nest_cross_one(NestList *list, const NestOrder *order, NestPass pass,
                                                   NestCrossing *crossing)
{
    if (UNLIKELY(!nest_may_look(list, order))) return nest_cross(list, order, &pass, 1, crossing);
    *crossing = nest_stay(order, list);
    NestStep step = nest_look(list, order, pass, crossing);
    nest_step(list, order, &step);
    return STATUS_OK;
}

#endif
