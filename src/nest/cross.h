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
    return order->hull_at[list->point.top.level];
}
/* The medium there. */
static inline uint32_t nest_medium(const NestList *list)
{
    return list->point.top.medium;
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
 * and left). Apart from that their order does not matter, except that under NEST_ENTERED hulls are entered in the order
 * given, and that hulls which share a level (share.h) come in the order in which they are met.
 * O(n * depth); no locks. On STATUS_NOMEM the list is as it was. */
ATTR_NODISCARD Status nest_cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                                 NestCrossing *crossing);

/* Crosses one surface where lists keep hulls as bits. false: the pass contradicts the list, and the point stays as it
 * is: the geometry has the last word on where the ray is after the crossing, and the list says that already. */
static inline bool nest_toggle(NestPoint *point, const NestOrder *order, NestPass pass)
{
    uint32_t level = order->narrow_level[pass.hull];
    if (UNLIKELY((point->mask >> level & 1) == pass.entering)) return false;
    point->mask ^= 1ULL << level;
    point->top = order->narrow_top[HIGHEST_BIT(point->mask)];
    return true;
}

/* What crossing one surface of a hull comes to in a row, before the list is changed. */
typedef struct NestStep {
    NestPoint point;
    uint32_t n;           /* hulls behind it; as many as before where the pass contradicts the list */
    uint32_t hull, place; /* where n changes: where in the row the hull goes, or stands */
} NestStep;
void nest_look(const NestList *list, const NestOrder *order, NestPass pass, NestStep *step);

/* Changes the list, as it was looked at; it must have room for one more hull. */
static inline void nest_step(NestList *list, const NestStep *step)
{
    if (step->n > list->n)
        nest_list_insert(list, step->place, step->hull);
    else if (step->n < list->n)
        nest_list_remove(list, step->place);
    list->point = step->point;
}
/* The same at once; returns how many faults there are. The list must have room. */
uint32_t nest_cross_in_row(NestList *list, const NestOrder *order, NestPass pass);
/* Whether nest_look and nest_step will do for the surface of a hull. */
static inline bool nest_may_look(const NestList *list, const NestOrder *order)
{
    return order->sorted && !order->narrow && list->n < list->capacity;
}

/* nest_cross for one surface; the owners are not told. */
ATTR_NODISCARD static inline Status nest_cross_one(NestList *list, const NestOrder *order, NestPass pass,
                                                   NestCrossing *crossing)
{
    bool in_row = nest_may_look(list, order);
    if (UNLIKELY(!order->narrow && !in_row)) return nest_cross(list, order, &pass, 1, crossing);
    crossing->medium_from = nest_medium(list);
    crossing->opaque = false;
    crossing->n_faults =
        LIKELY(!in_row) ? !nest_toggle(&list->point, order, pass) : nest_cross_in_row(list, order, pass);
    crossing->medium_to = nest_medium(list);
    return STATUS_OK;
}

#endif
