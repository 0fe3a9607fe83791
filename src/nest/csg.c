/* csg.c - whether a point is inside of a combination of solids.
 * SPDX-License-Identifier: Apache-2.0 */
#include "nest/csg.h"

/* The child that an operand belongs to. */
static uint32_t child_with(const NestCsg *csg, const NestPart *part, uint32_t operand)
{
    uint32_t low = part->first_child, high = low + part->n_children - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (operand < csg->parts[middle].end)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/* inside: n operands of the part that the point is inside of, in increasing order. */
static bool part_holds(const NestCsg *csg, uint32_t number, const uint32_t *inside, uint32_t n)
{
    const NestPart *part = &csg->parts[number];
    if (n == 0 || part->operation == NEST_OPERAND) return n > 0;
    bool any = part->operation == NEST_UNION;
    uint32_t next = part->first_child; /* intersection: the child that must come now; difference: the first */
    while (n) {
        uint32_t child = child_with(csg, part, inside[0]), count = 0;
        while (count < n && inside[count] < csg->parts[child].end) count++;
        bool holds = part_holds(csg, child, inside, count);
        if (any && holds) return true;
        if (part->operation == NEST_INTERSECTION && (!holds || child != next)) return false;
        if (part->operation == NEST_DIFFERENCE && holds != (child == part->first_child)) return false;
        if (part->operation == NEST_DIFFERENCE && next == part->first_child && child != next) return false;
        next = child + 1;
        inside += count;
        n -= count;
    }
    return part->operation == NEST_INTERSECTION ? next == part->first_child + part->n_children
                                                : part->operation == NEST_DIFFERENCE;
}

bool nest_csg_holds(const NestCsg *csg, uint32_t tree, const NestList *list)
{
    const NestPart *root = &csg->parts[csg->trees[tree].root];
    const uint32_t *items = nest_list_items(list);
    uint32_t first = 0;
    while (first < list->n && items[first] >= csg->first_operand && items[first] < root->begin) first++;
    uint32_t end = first;
    while (end < list->n && items[end] >= root->begin && items[end] < root->end) end++;
    return part_holds(csg, csg->trees[tree].root, items + first, end - first);
}

bool nest_csg_pass(const NestCsg *csg, NestList *list, uint32_t operand, bool entering)
{
    const uint32_t *items = nest_list_items(list);
    uint32_t place = 0;
    while (place < list->n && items[place] >= csg->first_operand && items[place] < operand) place++;
    bool inside = place < list->n && items[place] == operand;
    if (inside == entering) return false;
    if (inside)
        nest_list_remove(list, place);
    else
        nest_list_insert(list, place, operand);
    return true;
}

bool nest_csg_takes(const NestCsg *csg, uint32_t operand)
{
    const NestPart *part = &csg->parts[csg->trees[nest_csg_tree(csg, operand)].root];
    bool taken = false;
    while (part->operation != NEST_OPERAND) {
        uint32_t child = child_with(csg, part, operand);
        if (part->operation == NEST_DIFFERENCE && child != part->first_child) taken = !taken;
        part = &csg->parts[child];
    }
    return taken;
}

bool nest_csg_shows(const NestCsg *csg, NestList *list, uint32_t operand)
{
    uint32_t tree = nest_csg_tree(csg, operand);
    bool entered = nest_csg_pass(csg, list, operand, true), within = nest_csg_holds(csg, tree, list);
    nest_csg_pass(csg, list, operand, false);
    bool without = nest_csg_holds(csg, tree, list);
    if (!entered) nest_csg_pass(csg, list, operand, true);
    return within != without;
}
