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
    if (order->policy == NEST_ENTERED && !nest_mixes(order, hull)) return place; /* on top, whatever it is */
    const uint32_t *items = nest_list_items(list);
    uint32_t rank = order->rank[hull];
    while (place > 0 && order->rank[items[place - 1]] > rank) place--;
    return place;
}

/* Where the surface is on top of a sorted list, as most are: nothing is searched. */
static inline bool look_at_top(const NestList *list, const NestOrder *order, NestPass pass, NestStep *step)
{
    uint32_t n = list->n;
    if (pass.entering) {
        NestTop top = order->top[pass.hull];
        if (top.level <= list->point.top.level) return false;
        *step = (NestStep){{1, top}, n + 1, pass.hull, n};
        return true;
    }
    const uint32_t *items = nest_list_items(list);
    if (n == 0 || items[n - 1] != pass.hull) return false;
    *step = (NestStep){{1, nest_top_of_row(order, items, n - 1)}, n - 1, pass.hull, n - 1};
    return true;
}

void nest_look(const NestList *list, const NestOrder *order, NestPass pass, NestStep *step)
{
    if (order->sorted && LIKELY(look_at_top(list, order, pass, step))) return;
    const uint32_t *items = nest_list_items(list);
    uint32_t n = list->n, place = n;
    while (place > 0 && items[place - 1] != pass.hull) place--;
    bool inside = place > 0;
    step->point = list->point;
    step->n = n;
    if (UNLIKELY(inside == pass.entering)) return;
    step->n = pass.entering ? n + 1 : n - 1;
    step->hull = pass.hull;
    step->place = pass.entering ? place_of(list, order, pass.hull) : place - 1;
    if (pass.entering && step->place == n)
        step->point.top = order->top[pass.hull];
    else if (inside && place == n)
        step->point.top = nest_top_of_row(order, items, n - 1);
}

uint32_t nest_cross_in_row(NestList *list, const NestOrder *order, NestPass pass)
{
    NestStep step;
    uint32_t n = list->n;
    nest_look(list, order, pass, &step);
    nest_step(list, &step);
    return list->n == n;
}

/* Whether pass i is the one that counts for its hull: the first, where the last goes the same way. */
static bool counts(const NestPass *passes, uint32_t n, uint32_t i)
{
    for (uint32_t k = 0; k < i; k++)
        if (passes[k].hull == passes[i].hull) return false;
    uint32_t last = n - 1;
    while (passes[last].hull != passes[i].hull) last--;
    return passes[last].entering == passes[i].entering;
}

/* Crosses the operands of one combination, of which pass i is the first, and says whether its hull is crossed. */
static bool combine(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n, uint32_t i,
                    NestCrossing *crossing)
{
    const NestCsg *csg = order->csg;
    uint32_t tree = nest_csg_tree(csg, passes[i].hull);
    bool before = nest_csg_holds(csg, tree, list);
    for (uint32_t k = i; k < n; k++) {
        if (passes[k].hull < order->n_hulls || nest_csg_tree(csg, passes[k].hull) != tree) continue;
        if (counts(passes, n, k) && !nest_csg_pass(csg, list, passes[k].hull, passes[k].entering)) crossing->n_faults++;
    }
    return nest_csg_holds(csg, tree, list) != before;
}

/* Whether pass i is the first of an operand of its combination. */
static bool opens_tree(const NestOrder *order, const NestPass *passes, uint32_t i)
{
    if (passes[i].hull < order->n_hulls) return false;
    uint32_t tree = nest_csg_tree(order->csg, passes[i].hull);
    for (uint32_t k = 0; k < i; k++)
        if (passes[k].hull >= order->n_hulls && nest_csg_tree(order->csg, passes[k].hull) == tree) return false;
    return true;
}

/* A renderer that knows no nesting: a surface lies between the world's medium and its own, and a ray
 * remembers only the last one. Operands of combinations stay, below it. */
static void pass_without_nesting(NestList *list, const NestOrder *order, NestPass last, NestCrossing *crossing)
{
    uint32_t medium = order->top[last.hull].medium;
    crossing->owner_from = last.entering ? NEST_WORLD : last.hull;
    crossing->owner_to = last.entering ? last.hull : NEST_WORLD;
    crossing->medium_from = last.entering ? NEST_WORLD_MEDIUM : medium;
    crossing->medium_to = last.entering ? medium : NEST_WORLD_MEDIUM;
    if (nest_owner(order, list) != NEST_WORLD) list->n--;
    if (last.entering) nest_list_insert(list, list->n, last.hull);
}

/* Hulls that mix are added and taken away as ever: they have no surfaces to show. */
static void cross_without_nesting(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                                  NestCrossing *crossing)
{
    NestPass last = {NEST_WORLD, false};
    for (uint32_t i = 0; i < n; i++) {
        if (nest_mixes(order, passes[i].hull)) {
            crossing->n_faults += nest_cross_in_row(list, order, passes[i]);
        } else if (passes[i].hull < order->n_hulls) {
            last = passes[i];
        } else if (opens_tree(order, passes, i) && combine(list, order, passes, n, i, crossing)) {
            uint32_t tree = nest_csg_tree(order->csg, passes[i].hull), hull = order->csg->trees[tree].hull;
            NestPass pass = {hull, nest_csg_holds(order->csg, tree, list)};
            if (hull == NEST_OPAQUE)
                crossing->opaque = true;
            else if (nest_mixes(order, hull))
                nest_cross_in_row(list, order, pass);
            else
                last = pass;
        }
    }
    if (last.hull != NEST_WORLD) pass_without_nesting(list, order, last, crossing);
}

/* All passes of n >= 2, or some of operands. What is left is left before anything is entered: touching hulls meet in one
 * boundary. */
static void cross_several(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                          NestCrossing *crossing)
{
    for (int entering = 0; entering < 2; entering++)
        for (uint32_t i = 0; i < n; i++) {
            if (passes[i].hull < order->n_hulls) {
                if (passes[i].entering == (entering != 0) && counts(passes, n, i))
                    crossing->n_faults += nest_cross_in_row(list, order, passes[i]);
                continue;
            }
            if (!opens_tree(order, passes, i)) continue;
            uint32_t tree = nest_csg_tree(order->csg, passes[i].hull), hull = order->csg->trees[tree].hull;
            if (!entering && combine(list, order, passes, n, i, crossing) && hull == NEST_OPAQUE)
                crossing->opaque = true;
            if (hull == NEST_OPAQUE) continue;
            /* a combination's hull is in the list exactly where its operands say so */
            NestPass pass = {hull, nest_csg_holds(order->csg, tree, list)};
            if (pass.entering == (entering != 0) && pass.entering != nest_list_has(list, hull))
                nest_cross_in_row(list, order, pass);
        }
}

/* All passes, where lists keep hulls as bits. */
static void cross_narrow(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                         NestCrossing *crossing)
{
    for (uint32_t i = 0; i < n; i++)
        if (counts(passes, n, i)) crossing->n_faults += !nest_toggle(&list->point, order, passes[i]);
}

/* The same in a row. */
static void cross_in_row(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n,
                         NestCrossing *crossing)
{
    if (LIKELY(n == 1 && passes[0].hull < order->n_hulls))
        crossing->n_faults = nest_cross_in_row(list, order, passes[0]);
    else
        cross_several(list, order, passes, n, crossing);
    nest_order_settle(order, list);
}

Status nest_cross(NestList *list, const NestOrder *order, const NestPass *passes, uint32_t n, NestCrossing *crossing)
{
    crossing->n_faults = 0;
    crossing->opaque = false;
    if (!order->narrow)
        TRY(nest_list_reserve(list, order->csg ? 2 * n : n)); /* an operand may bring its combination's hull */
    crossing->owner_from = crossing->owner_to = nest_owner(order, list);
    crossing->medium_from = crossing->medium_to = nest_medium(list);
    if (UNLIKELY(order->policy == NEST_NONE)) {
        cross_without_nesting(list, order, passes, n, crossing);
        nest_order_settle(order, list);
        return STATUS_OK;
    }
    if (LIKELY(order->narrow))
        cross_narrow(list, order, passes, n, crossing);
    else
        cross_in_row(list, order, passes, n, crossing);
    crossing->owner_to = nest_owner(order, list);
    crossing->medium_to = nest_medium(list);
    return STATUS_OK;
}
