/* rtc_passed.c - surfaces that a ray passes by: the ones noted in a search for the nearest place, as far as they are in front
 * of what was found.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_query.h"

/* All hits in one row, and those in front of the first place at which the ray does not pass by everything back again: as
 * if each place had been searched for by itself. */
ATTR_COLD static size_t part_anew(Query *query)
{
    HitList *hits = query->hits, *passed = query->passed;
    for (size_t i = 0; i < passed->n; i++) {
        Hit *hit = rtc_hit_place(hits);
        if (!hit) return 0;
        *hit = passed->items[i];
        hits->n++;
    }
    rtc_sort_hits(hits);
    size_t begin = 0, n = 0;
    for (;; begin += n) {
        n = rtc_cluster(hits->items + begin, hits->n - begin);
        size_t i = 0;
        while (i < n && rtc_passes(query, hits->items[begin + i].object)) i++;
        if (i < n || n == 0) break;
    }
    passed->n = 0;
    for (size_t i = 0; i < begin; i++) {
        Hit *hit = rtc_hit_place(passed);
        if (!hit) return 0;
        *hit = hits->items[i];
        passed->n++;
    }
    hits->n -= begin;
    for (size_t i = 0; i < hits->n; i++) hits->items[i] = hits->items[begin + i];
    return n;
}

size_t rtc_part_passed(Query *query, size_t n)
{
    if (n == 0) return 0;
    const Hit *first = &query->hits->items[0], *last = &query->hits->items[n - 1];
    HitList *passed = query->passed;
    size_t before = 0;
    while (before < passed->n && passed->items[before].t <= last->t) before++;
    bool apart_before =
        before == 0 || (passed->items[before - 1].t < first->t && !rtc_together(&passed->items[before - 1], first));
    bool apart_behind = before == passed->n || !rtc_together(last, &passed->items[before]);
    if (UNLIKELY(!apart_before || !apart_behind)) return part_anew(query);
    passed->n = before;
    return n;
}
