/* share.c - levels for many hulls.
 *
 * The hulls are taken from the bottom to the top. Each goes to the lowest level of its kind above all hulls that it meets
 * and that rank below it, or to a new one on top of all. So two hulls that meet have different levels, in the order of
 * their ranks, and only such hulls are ever in a list together. Which of two of one medium is on top would not matter, and
 * a chain of a hundred bubbles that meet could do with two levels; but then rays would cross them elsewhere, and sums be
 * rounded otherwise.
 *
 * A surface that is lost or met twice, which no list is safe from, leaves a bit that is wrong. Where it is set and should
 * not be, say because the way out of a bubble was lost, the next bubble of the level that is entered is a fault, counted,
 * and leaving that one mends the list: sooner than a list of all bubbles is mended, which waits for the same one to be met
 * again. Where it is not set and should be, the ray is in that bubble and meets no other of its level before it leaves it:
 * a fault, counted, and mended there, as ever.
 * SPDX-License-Identifier: Apache-2.0 */
#include "nest/share.h"

#include <stdlib.h>
#include <string.h>

typedef struct Sharer {
    const NestOrder *order;
    uint32_t *first, *below; /* hull h meets those of lower rank at below[first[h] .. first[h + 1]) */
    uint8_t *level;          /* of each hull */
    uint32_t kind[NEST_NARROW + 1], hull[NEST_NARROW + 1], n_levels; /* of each level; the first level is 1 */
} Sharer;

static uint32_t upper_of(const NestOrder *order, NestMeeting meeting)
{
    return order->rank[meeting.a] > order->rank[meeting.b] ? meeting.a : meeting.b;
}

static void list_meetings(Sharer *s, const NestMeeting *meetings, size_t n)
{
    uint32_t n_hulls = s->order->n_hulls;
    for (size_t i = 0; i < n; i++) s->first[upper_of(s->order, meetings[i])]++;
    for (uint32_t h = 1; h <= n_hulls; h++) s->first[h] += s->first[h - 1]; /* where each one's end, for now */
    for (size_t i = 0; i < n; i++) {
        uint32_t upper = upper_of(s->order, meetings[i]);
        s->below[--s->first[upper]] = meetings[i].a ^ meetings[i].b ^ upper;
    }
}

/* False where there are too many levels. */
static bool place(Sharer *s, uint32_t hull, uint32_t kind)
{
    uint32_t level = 0;
    for (uint32_t i = s->first[hull]; i < s->first[hull + 1]; i++)
        if (s->level[s->below[i]] > level) level = s->level[s->below[i]];
    do level++;
    while (level <= s->n_levels && (kind == NEST_ALONE || s->kind[level] != kind));
    if (level > NEST_NARROW) return false;
    if (level > s->n_levels) {
        s->n_levels = level;
        s->kind[level] = kind;
        s->hull[level] = hull;
    }
    s->level[hull] = (uint8_t)level;
    return true;
}

static void take_levels(const Sharer *s, NestOrder *order)
{
    for (uint32_t h = 0; h < order->n_hulls; h++) order->top[h].level = s->level[h];
    for (uint32_t level = 1; level <= s->n_levels; level++) order->hull_at[level] = s->hull[level];
    nest_order_narrow(order);
}

Status nest_order_share(NestOrder *order, const uint32_t *kind, const NestMeeting *meetings, size_t n, Error *error)
{
    if (!order->sorted || order->narrow || NEST_NARROW == 0) return STATUS_OK;
    Sharer s = {.order = order};
    size_t n_hulls = order->n_hulls, bytes = (n_hulls + 1 + n) * sizeof *s.first + n_hulls;
    if (n > UINT32_MAX) return STATUS_OK;
    s.first = calloc(1, bytes);
    if (!s.first) return fail_memory(error, bytes, "the order of the hulls");
    s.below = s.first + n_hulls + 1;
    s.level = (uint8_t *)(s.below + n);
    list_meetings(&s, meetings, n);
    bool placed = true;
    for (uint32_t level = 1; placed && level <= n_hulls; level++)
        placed = place(&s, order->hull_at[level], kind[order->hull_at[level]]);
    if (placed) take_levels(&s, order);
    free(s.first);
    return STATUS_OK;
}
