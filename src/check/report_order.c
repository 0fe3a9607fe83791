/* report_order.c - the text of the report: the clear objects from top to bottom.
 * The order that rays are traced with is one list of all hulls, as that costs least. People are shown what it comes to:
 * clusters of hulls that have to do with each other, and in each only as many levels as there are hulls on top of
 * hulls.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "check/report_parts.h"

/* ---- clusters and levels ---- */

static uint32_t find_root(uint32_t *parent, uint32_t h)
{
    while (parent[h] != h) h = parent[h] = parent[parent[h]];
    return h;
}

static void join_clusters(const CompiledScene *compiled, uint32_t *parent)
{
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps) continue;
        uint32_t a = find_root(parent, compiled->hull_of_object[pair->a]);
        uint32_t b = find_root(parent, compiled->hull_of_object[pair->b]);
        if (a != b) parent[a > b ? a : b] = a < b ? a : b; /* the first declared stands for all */
    }
}

typedef struct OnTop {
    uint32_t rank, top, bottom; /* rank: of the top */
} OnTop;

static int compare_ranks(const void *left, const void *right)
{
    const OnTop *a = left, *b = right;
    return a->rank > b->rank ? -1 : a->rank < b->rank;
}

/* From the top down, so that the level of a hull is known before it is asked for. */
static bool find_levels(const CompiledScene *compiled, uint32_t *level)
{
    OnTop *tops = malloc((compiled->n_pairs ? compiled->n_pairs : 1) * sizeof *tops);
    size_t n = 0;
    if (!tops) return false;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        if (!compiled->pairs[i].overlaps) continue;
        ReportVerdict verdict = report_verdict(compiled, &compiled->pairs[i]);
        level[verdict.top] = level[verdict.bottom] = 1;
        if (verdict.kind != VERDICT_MERGE && verdict.kind != VERDICT_MIX)
            tops[n++] = (OnTop){compiled->order.rank[verdict.top], verdict.top, verdict.bottom};
    }
    qsort(tops, n, sizeof *tops, compare_ranks);
    for (size_t i = 0; i < n; i++)
        if (level[tops[i].bottom] <= level[tops[i].top]) level[tops[i].bottom] = level[tops[i].top] + 1;
    free(tops);
    return true;
}

static bool is_ordered(const CompiledScene *compiled)
{
    return compiled->order.policy == NEST_AUTOMATIC || compiled->order.policy == NEST_PRIORITY;
}

bool report_order_init(ReportOrder *order, const CompiledScene *compiled)
{
    uint32_t n = compiled->n_hulls;
    *order = (ReportOrder){.cluster = malloc((n ? n : 1) * sizeof *order->cluster),
                           .level = calloc(n ? n : 1, sizeof *order->level)};
    if (!order->cluster || !order->level) return false;
    for (uint32_t h = 0; h < n; h++) order->cluster[h] = h;
    join_clusters(compiled, order->cluster);
    for (uint32_t h = 0; h < n; h++) { /* a root comes before the rest of its cluster */
        uint32_t root = order->cluster[h];
        order->cluster[h] = root == h ? order->n_clusters++ : order->cluster[root];
    }
    return !is_ordered(compiled) || find_levels(compiled, order->level);
}

void report_order_clear(ReportOrder *order)
{
    free(order->cluster);
    free(order->level);
    *order = (ReportOrder){0};
}

/* ---- the table ---- */

static void add_place(Buf *out, SourceSet *sources, Span span)
{
    if (!sources || span.source >= sources->n) return;
    SourcePosition place = source_position(sources, span.source, span.begin);
    buf_format(out, "%s:%u", sources->sources[span.source].name, (unsigned)place.line);
}

static void add_size(Buf *out, const Scene *scene, double volume)
{
    if (volume == 0)
        buf_add(out, "empty");
    else
        report_add_volume(out, scene, volume);
}

static void print_hull(const CompiledScene *compiled, SourceSet *sources, uint32_t hull, Buf *row)
{
    const SceneObject *object = report_object(compiled, hull);
    buf_add(&row[2], object->name);
    buf_add(&row[3], compiled->scene->media[object->medium].name);
    add_size(&row[4], compiled->scene, compiled->hulls[hull].volume);
    if (object->priority) buf_format(&row[5], "priority %d", (int)object->priority);
    add_place(&row[6], sources, object->span);
}

static void print_hull_group(const CompiledScene *compiled, const ReportGroup *group, Buf *row)
{
    buf_format(&row[1], "%u ×", (unsigned)group->n);
    buf_add_bytes(&row[2], group->first.word, group->first.length);
    buf_add(&row[3], compiled->scene->media[group->first.medium].name);
    add_size(&row[4], compiled->scene, group->sum);
    buf_add(&row[5], "together");
}

/* A hull, or the first of a group of like hulls, in the order of printing. */
typedef struct Entry {
    uint32_t cluster, level, last_level, rank, hull;
    bool alone, mixes;
} Entry;

static int compare_entries(const void *left, const void *right)
{
    const Entry *a = left, *b = right;
    if (a->alone != b->alone) return a->alone ? 1 : -1;
    if (!a->alone && a->cluster != b->cluster) return a->cluster < b->cluster ? -1 : 1;
    if (a->mixes != b->mixes) return a->mixes ? 1 : -1; /* whatever it is in, it is not on top of that */
    if (a->level != b->level) return a->level < b->level ? -1 : 1;
    return a->rank > b->rank ? -1 : a->rank < b->rank;
}

/* Like hulls are one entry, at the highest of their levels; cluster and rank are those of the first declared. */
static size_t collect_entries(const CompiledScene *compiled, const ReportGroups *groups, const ReportOrder *order,
                              Entry *entries, uint32_t *entry_of_group)
{
    bool ordered = is_ordered(compiled);
    size_t n = 0;
    for (uint32_t g = 0; g < groups->n; g++) entry_of_group[g] = UINT32_MAX;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        uint32_t g = groups->of_hull[h], level = order->level[h];
        bool many = groups->items[g].n > REPORT_FEW;
        if (!many || entry_of_group[g] == UINT32_MAX) {
            entry_of_group[g] = (uint32_t)n;
            entries[n++] = (Entry){.cluster = ordered ? order->cluster[h] : 0,
                                   .level = level,
                                   .last_level = level,
                                   .rank = ordered ? compiled->order.rank[h] : compiled->n_hulls - h,
                                   .hull = h,
                                   .alone = ordered && level == 0,
                                   .mixes = ordered && compiled->hulls[h].mixes};
            continue;
        }
        Entry *entry = &entries[entry_of_group[g]];
        if (level == 0) continue;
        if (entry->alone)
            *entry =
                (Entry){order->cluster[h], level, level, compiled->order.rank[h], entry->hull, false, entry->mixes};
        if (level < entry->level) entry->level = level;
        if (level > entry->last_level) entry->last_level = level;
    }
    qsort(entries, n, sizeof *entries, compare_entries);
    return n;
}

static void print_entry(const CompiledScene *compiled, const ReportGroups *groups, SourceSet *sources,
                        const Entry *entry, Buf *row)
{
    const ReportGroup *group = &groups->items[groups->of_hull[entry->hull]];
    if (entry->mixes && !entry->alone)
        buf_add(&row[0], "+");
    else if (entry->level)
        buf_format(&row[0], "%u", (unsigned)entry->level);
    if (!entry->mixes && entry->last_level > entry->level) buf_format(&row[0], "-%u", (unsigned)entry->last_level);
    if (group->n > REPORT_FEW)
        print_hull_group(compiled, group, row);
    else
        print_hull(compiled, sources, entry->hull, row);
}

static void print_entries(const CompiledScene *compiled, const ReportGroups *groups, SourceSet *sources,
                          const Entry *entries, size_t n, Buf *out)
{
    ReportTable table = {.n_columns = 7, .right = {[1] = true, [4] = true}};
    bool mixing = false;
    for (size_t i = 0; i < n; i++) {
        mixing |= entries[i].mixes && !entries[i].alone;
        bool apart = i && (entries[i].alone != entries[i - 1].alone ||
                           (!entries[i].alone && entries[i].cluster != entries[i - 1].cluster));
        if (apart) report_row(&table); /* an empty line */
        print_entry(compiled, groups, sources, &entries[i], report_row(&table));
    }
    report_print_table(&table, out);
    if (mixing) buf_add(out, "  +: never on top; it adds to what is there, or gives way to it\n");
}

void report_print_hulls(const CompiledScene *compiled, const ReportGroups *groups, SourceSet *sources, Buf *out)
{
    uint32_t n = compiled->n_hulls;
    ReportOrder order;
    Entry *entries = calloc(n ? n : 1, sizeof *entries);
    uint32_t *entry_of_group = malloc((groups->n ? groups->n : 1) * sizeof *entry_of_group);
    bool ready = report_order_init(&order, compiled) && entries && entry_of_group;
    buf_format(out, "\nClear objects%s, nesting = %s\n", is_ordered(compiled) ? " from top to bottom" : "",
               nest_policy_text(compiled->order.policy));
    if (n == 0) buf_add(out, "  none\n");
    if (ready)
        print_entries(compiled, groups, sources, entries,
                      collect_entries(compiled, groups, &order, entries, entry_of_group), out);
    else
        out->failed = true;
    report_order_clear(&order);
    free(entries);
    free(entry_of_group);
}
