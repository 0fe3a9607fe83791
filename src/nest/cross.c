/* cross.c - the core of the program: crossing hulls.
 *
 * The interior list holds the hulls that the ray is inside, the owner of the point last. Crossing a hull
 * toggles its membership; where the medium of the owner changes there is a boundary, elsewhere there is
 * nothing to see. The policies differ in one place only, place_of(): where in the list a hull that is
 * entered goes.
 *
 * [WR19] keeps a stack in which a hull may occur twice, with parity bits, because it identifies hulls by
 * their materials. We identify hulls, so a set is enough; equality of media decides only whether a boundary is
 * visible. An entry of the stack with odd parity is a member of our list, and `topmost` is the
 * membership itself. [SB02] calls a crossing whose owner does not change a false intersection.
 * SPDX-License-Identifier: Apache-2.0 */
#include "nest/cross.h"

/* Where in the list a hull goes that is entered now. */
static uint32_t place_of(const NestList *list, const NestOrder *order, uint32_t hull)
{
    uint32_t place = list->n;
    if (order->policy == NEST_ENTERED) return place; /* on top, whatever it is */
    const uint32_t *items = nest_list_items(list);
    uint32_t rank = order->rank[hull];
    while (place > 0 && order->rank[items[place - 1]] > rank) place--;
    return place;
}

/* The list must have room. Returns 1 when the pass contradicts the list, which then stays as it is: the
 * geometry has the last word on where the ray is after the crossing, and the list says that already. */
static uint32_t apply(NestList *list, const NestOrder *order, NestPass pass)
{
    const uint32_t *items = nest_list_items(list);
    uint32_t place = list->n;
    while (place > 0 && items[place - 1] != pass.hull) place--;
    bool inside = place > 0;
    if (inside == pass.entering) return 1;
    if (inside)
        nest_list_remove(list, place - 1);
    else
        nest_list_insert(list, place_of(list, order, pass.hull), pass.hull);
    return 0;
}

/* Whether pass i is the one that counts for its hull: the first of its kind, and none goes the other way. */
static bool counts(const NestPass *passes, uint32_t n, uint32_t i)
{
    for (uint32_t j = 0; j < n; j++) {
        if (passes[j].hull != passes[i].hull) continue;
        if (passes[j].entering != passes[i].entering) return false;
        if (j < i) return false;
    }
    return true;
}

/* A renderer that knows no nesting: a surface lies between the world's medium and its own, and a ray
 * remembers only the last one. */
static void cross_without_nesting(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                                  NestCrossing *crossing)
{
    NestPass last = passes[n - 1];
    uint32_t medium = order->medium[last.hull];
    crossing->owner_from = last.entering ? NEST_WORLD : last.hull;
    crossing->owner_to = last.entering ? last.hull : NEST_WORLD;
    crossing->medium_from = last.entering ? order->world_medium : medium;
    crossing->medium_to = last.entering ? medium : order->world_medium;
    list->n = 0;
    if (last.entering) {
        nest_list_hulls(list)[0] = last.hull;
        list->n = 1;
    }
}

Status nest_cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n, NestCrossing *crossing)
{
    crossing->n_faults = 0;
    if (UNLIKELY(order->policy == NEST_NONE)) {
        cross_without_nesting(list, order, passes, n, crossing);
        return STATUS_OK;
    }
    TRY(nest_list_reserve(list, n));
    crossing->owner_from = nest_owner(list);
    crossing->medium_from = nest_medium(order, list);
    if (LIKELY(n == 1)) {
        crossing->n_faults = apply(list, order, passes[0]);
    } else {
        /* what is left is left before anything is entered: touching hulls meet in one boundary */
        for (uint32_t i = 0; i < n; i++)
            if (!passes[i].entering && counts(passes, n, i)) crossing->n_faults += apply(list, order, passes[i]);
        for (uint32_t i = 0; i < n; i++)
            if (passes[i].entering && counts(passes, n, i)) crossing->n_faults += apply(list, order, passes[i]);
    }
    crossing->owner_to = nest_owner(list);
    crossing->medium_to = nest_medium(order, list);
    return STATUS_OK;
}
