/* order.c - the rules between two hulls, and one strict order of all hulls from them.
 *
 * The pairwise answers make a graph: an arrow from the hull on top to the one below, for every pair that
 * overlaps. Its strongly connected components (Tarjan 1972) are the circles; inside a circle volume decides. What
 * remains has no circle, and is sorted topologically with the smaller volume first, so that the order is
 * the same however the pairs are listed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "nest/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const policy_texts[] = {"automatic", "entered", "priority", "none"};
static const char *const rule_texts[] = {"priority", "containment", "state of matter", "volume",
                                         "order of declaration"};

const char *nest_rule_text(NestRule rule)
{
    return rule_texts[rule];
}

const char *nest_policy_text(NestPolicy policy)
{
    return policy_texts[policy];
}

bool nest_policy_from_text(const char *text, NestPolicy *policy)
{
    for (int i = 0; i < (int)COUNT_OF(policy_texts); i++)
        if (strcmp(text, policy_texts[i]) == 0) {
            *policy = (NestPolicy)i;
            return true;
        }
    return false;
}

/* A volume as it is compared, to a millionth: that of a thing and of the same thing turned round differ by rounding, and in an
 * animation now the one and now the other would be on top. */
static double compared_volume(double volume)
{
    enum { BITS = 20 };
    int exponent;
    if (!isfinite(volume)) return volume;
    double fraction = frexp(volume, &exponent);
    return ldexp(round(ldexp(fraction, BITS)), exponent - BITS);
}

NestDecision nest_decide(const NestHull *hulls, const NestOverlap *overlap)
{
    const NestHull *a = &hulls[overlap->a], *b = &hulls[overlap->b];
    double a_volume = compared_volume(a->volume), b_volume = compared_volume(b->volume);
    bool a_on_top;
    NestRule rule;
    if (a->priority != b->priority) {
        rule = NEST_BY_PRIORITY;
        a_on_top = a->priority > b->priority;
    } else if (overlap->relation != NEST_PARTIAL) {
        rule = NEST_BY_CONTAINMENT;
        a_on_top = overlap->relation == NEST_A_IN_B;
    } else if (a->state != b->state && a->state != NEST_STATE_UNKNOWN && b->state != NEST_STATE_UNKNOWN) {
        rule = NEST_BY_STATE;
        a_on_top = a->state > b->state;
    } else if (a_volume != b_volume) {
        rule = NEST_BY_VOLUME;
        a_on_top = a_volume < b_volume;
    } else {
        rule = NEST_BY_DECLARATION;
        a_on_top = overlap->a > overlap->b;
    }
    return (NestDecision){a_on_top ? overlap->a : overlap->b, a_on_top ? overlap->b : overlap->a, rule};
}

/* The working state of nest_order_build; arrays of n_hulls unless said otherwise. */
typedef struct Sorter {
    const NestHull *hulls;
    uint32_t n;
    uint32_t *first_arrow; /* n + 1: arrows of hull h are arrow[first_arrow[h] .. first_arrow[h + 1]) */
    uint32_t *arrow;       /* to the hull below */
    uint32_t *component;   /* number of the strongly connected component */
    uint32_t n_components;
    uint32_t *component_size, *n_above;                /* per component: members, arrows into it not yet sorted away */
    uint32_t *index, *low, *stack, *path, *next_arrow; /* Tarjan's */
    bool *on_stack;
    uint32_t *by_volume;          /* hulls, top first within equal claims: smaller volume, then later declaration */
    uint32_t *heap;               /* components that are free to be placed, the smallest of their hulls on top */
    uint32_t *first_of_component; /* place in by_volume of its first hull */
    void *memory;
} Sorter;

static Status sorter_init(Sorter *s, const NestHull *hulls, uint32_t n, size_t n_arrows, Error *error)
{
    *s = (Sorter){.hulls = hulls, .n = n};
    uint32_t **arrays[] = {&s->component,
                           &s->component_size,
                           &s->n_above,
                           &s->index,
                           &s->low,
                           &s->stack,
                           &s->path,
                           &s->next_arrow,
                           &s->by_volume,
                           &s->heap,
                           &s->first_of_component,
                           &s->first_arrow};
    size_t stride = (size_t)n + 1;
    size_t bytes = (COUNT_OF(arrays) * stride + n_arrows) * sizeof(uint32_t) + stride * sizeof(bool);
    uint32_t *memory = calloc(1, bytes);
    if (!memory) return fail_memory(error, bytes, "the order of the hulls");
    s->memory = memory;
    for (size_t i = 0; i < COUNT_OF(arrays); i++) *arrays[i] = memory + i * stride;
    s->arrow = memory + COUNT_OF(arrays) * stride;
    s->on_stack = (bool *)(s->arrow + n_arrows);
    return STATUS_OK;
}

static void add_arrows(Sorter *s, const NestOverlap *overlaps, size_t n_overlaps)
{
    for (size_t i = 0; i < n_overlaps; i++) s->first_arrow[nest_decide(s->hulls, &overlaps[i]).top + 1]++;
    for (uint32_t h = 0; h < s->n; h++) s->first_arrow[h + 1] += s->first_arrow[h];
    memcpy(s->next_arrow, s->first_arrow, s->n * sizeof *s->next_arrow);
    for (size_t i = 0; i < n_overlaps; i++) {
        NestDecision decision = nest_decide(s->hulls, &overlaps[i]);
        s->arrow[s->next_arrow[decision.top]++] = decision.bottom;
    }
}

/* Tarjan's algorithm from one root, with its own stack: hulls may be nested 1,000 deep and more. */
static void find_components_from(Sorter *s, uint32_t root, uint32_t *counter, uint32_t *n_stack)
{
    uint32_t depth = 0;
    s->path[depth++] = root;
    while (depth) {
        uint32_t h = s->path[depth - 1];
        if (!s->index[h]) {
            s->index[h] = s->low[h] = ++*counter;
            s->stack[(*n_stack)++] = h;
            s->on_stack[h] = true;
            s->next_arrow[h] = s->first_arrow[h];
        }
        bool descended = false;
        while (s->next_arrow[h] < s->first_arrow[h + 1]) {
            uint32_t below = s->arrow[s->next_arrow[h]];
            if (!s->index[below]) {
                s->path[depth++] = below;
                descended = true;
                break;
            }
            if (s->on_stack[below] && s->low[below] < s->low[h]) s->low[h] = s->low[below];
            s->next_arrow[h]++;
        }
        if (descended) continue;
        if (s->low[h] == s->index[h]) {
            uint32_t member;
            do {
                member = s->stack[--*n_stack];
                s->on_stack[member] = false;
                s->component[member] = s->n_components;
                s->component_size[s->n_components]++;
            } while (member != h);
            s->n_components++;
        }
        depth--;
    }
}

static void find_components(Sorter *s)
{
    uint32_t counter = 0, n_stack = 0;
    for (uint32_t h = 0; h < s->n; h++)
        if (!s->index[h]) find_components_from(s, h, &counter, &n_stack);
}

/* qsort has no context, so what is sorted carries its key. */
typedef struct VolumeKey {
    double volume;
    uint32_t hull;
} VolumeKey;

static int compare_volume(const void *left, const void *right)
{
    const VolumeKey *a = left, *b = right;
    if (a->volume != b->volume) return a->volume < b->volume ? -1 : 1;
    return a->hull > b->hull ? -1 : a->hull < b->hull ? 1 : 0;
}

static Status sort_by_volume(Sorter *s, Error *error)
{
    VolumeKey *keys = malloc((s->n ? s->n : 1) * sizeof *keys);
    if (!keys) return fail_memory(error, s->n * sizeof *keys, "the order of the hulls");
    for (uint32_t h = 0; h < s->n; h++) keys[h] = (VolumeKey){compared_volume(s->hulls[h].volume), h};
    qsort(keys, s->n, sizeof *keys, compare_volume);
    for (uint32_t i = 0; i < s->n; i++) s->by_volume[i] = keys[i].hull;
    free(keys);
    return STATUS_OK;
}

/* A heap of components by the place of their first hull in by_volume. */
static void heap_push(Sorter *s, uint32_t *n, uint32_t component)
{
    uint32_t i = (*n)++;
    while (i > 0 && s->first_of_component[s->heap[(i - 1) / 2]] > s->first_of_component[component]) {
        s->heap[i] = s->heap[(i - 1) / 2];
        i = (i - 1) / 2;
    }
    s->heap[i] = component;
}

static uint32_t heap_pop(Sorter *s, uint32_t *n)
{
    uint32_t top = s->heap[0], last = s->heap[--*n], i = 0;
    for (;;) {
        uint32_t child = 2 * i + 1;
        if (child >= *n) break;
        if (child + 1 < *n && s->first_of_component[s->heap[child + 1]] < s->first_of_component[s->heap[child]])
            child++;
        if (s->first_of_component[s->heap[child]] >= s->first_of_component[last]) break;
        s->heap[i] = s->heap[child];
        i = child;
    }
    s->heap[i] = last;
    return top;
}

/* Kahn's algorithm over the components; ranks are given from the top (n - 1) downwards. */
static void give_ranks(Sorter *s, uint32_t *rank)
{
    /* members of each component in order of volume, as linked lists: next_arrow is the link, low the last */
    for (uint32_t c = 0; c < s->n_components; c++) s->first_of_component[c] = UINT32_MAX;
    for (uint32_t i = 0; i < s->n; i++) {
        uint32_t h = s->by_volume[i], c = s->component[h];
        s->next_arrow[h] = UINT32_MAX;
        if (s->first_of_component[c] == UINT32_MAX)
            s->first_of_component[c] = i;
        else
            s->next_arrow[s->low[c]] = h;
        s->low[c] = h;
    }
    for (uint32_t h = 0; h < s->n; h++)
        for (uint32_t k = s->first_arrow[h]; k < s->first_arrow[h + 1]; k++)
            if (s->component[s->arrow[k]] != s->component[h]) s->n_above[s->component[s->arrow[k]]]++;
    uint32_t n_heap = 0, next_rank = s->n;
    for (uint32_t c = 0; c < s->n_components; c++)
        if (s->n_above[c] == 0) heap_push(s, &n_heap, c);
    while (n_heap) {
        uint32_t c = heap_pop(s, &n_heap);
        for (uint32_t h = s->by_volume[s->first_of_component[c]]; h != UINT32_MAX; h = s->next_arrow[h]) {
            rank[h] = --next_rank;
            for (uint32_t k = s->first_arrow[h]; k < s->first_arrow[h + 1]; k++) {
                uint32_t below = s->component[s->arrow[k]];
                if (below != c && --s->n_above[below] == 0) heap_push(s, &n_heap, below);
            }
        }
    }
}

static Status order_automatic(NestOrder *order, const NestHull *hulls, const NestOverlap *overlaps, size_t n_overlaps,
                              Error *error)
{
    Sorter sorter;
    if (n_overlaps > UINT32_MAX)
        return fail(error, STATUS_NOMEM, "%zu pairs of overlapping hulls are too many", n_overlaps);
    TRY(sorter_init(&sorter, hulls, order->n_hulls, n_overlaps, error));
    add_arrows(&sorter, overlaps, n_overlaps);
    find_components(&sorter);
    Status status = sort_by_volume(&sorter, error);
    if (status == STATUS_OK) {
        give_ranks(&sorter, order->rank);
        /* number the circles in order of declaration of their first member; heap is free by now */
        memset(sorter.heap, 0, sorter.n * sizeof *sorter.heap);
        for (uint32_t h = 0; h < sorter.n; h++) {
            uint32_t c = sorter.component[h];
            if (sorter.component_size[c] < 2) continue;
            if (!sorter.heap[c]) sorter.heap[c] = ++order->n_circles;
            order->circle[h] = sorter.heap[c];
        }
    }
    free(sorter.memory);
    return status;
}

typedef struct PriorityKey {
    int32_t priority;
    uint32_t hull;
} PriorityKey;

static int compare_priority(const void *left, const void *right)
{
    const PriorityKey *a = left, *b = right;
    if (a->priority != b->priority) return a->priority < b->priority ? -1 : 1;
    return a->hull < b->hull ? -1 : a->hull > b->hull ? 1 : 0;
}

static Status order_priority(NestOrder *order, const NestHull *hulls, Error *error)
{
    PriorityKey *keys = malloc((order->n_hulls ? order->n_hulls : 1) * sizeof *keys);
    if (!keys) return fail_memory(error, order->n_hulls * sizeof *keys, "the order of the hulls");
    for (uint32_t h = 0; h < order->n_hulls; h++) keys[h] = (PriorityKey){hulls[h].priority, h};
    qsort(keys, order->n_hulls, sizeof *keys, compare_priority);
    for (uint32_t i = 0; i < order->n_hulls; i++) order->rank[keys[i].hull] = i;
    free(keys);
    return STATUS_OK;
}

/* Hulls that mix go below all others; among both kinds everything stays as it was. */
static Status sink_mixing(NestOrder *order, const NestHull *hulls, Error *error)
{
    for (uint32_t h = 0; h < order->n_hulls; h++) order->n_mixing += hulls[h].mixes;
    if (!order->n_mixing) return STATUS_OK;
    uint32_t *hull_of_rank = malloc(order->n_hulls * sizeof *hull_of_rank), next[2] = {order->n_mixing, 0};
    if (!hull_of_rank) return fail_memory(error, order->n_hulls * sizeof *hull_of_rank, "the order of the hulls");
    for (uint32_t h = 0; h < order->n_hulls; h++) hull_of_rank[order->rank[h]] = h;
    for (uint32_t r = 0; r < order->n_hulls; r++) order->rank[hull_of_rank[r]] = next[hulls[hull_of_rank[r]].mixes]++;
    free(hull_of_rank);
    return STATUS_OK;
}

/* Room for tables of n hulls and operands, of n_hulls and the world, all in one. */
static Status make_tables(NestOrder *order, size_t n, Error *error)
{
    size_t size = 4 * n + order->n_hulls + 1 + (order->n_hulls + 3) / 4;
    order->rank = calloc(size, sizeof *order->rank);
    if (!order->rank) return fail_memory(error, size * sizeof *order->rank, "the order of the hulls");
    order->circle = order->rank + n;
    order->top = (NestTop *)(void *)(order->circle + n);
    order->hull_at = order->circle + 3 * n;
    order->narrow_level = (uint8_t *)(order->hull_at + order->n_hulls + 1);
    return STATUS_OK;
}

/* Levels, from ranks and media. */
static void give_levels(NestOrder *order)
{
    order->hull_at[0] = NEST_WORLD;
    for (uint32_t h = 0; h < order->n_hulls; h++) {
        uint32_t level = order->rank[h] + 1;
        order->top[h].level = nest_mixes(order, h) ? 0 : level;
        order->hull_at[level] = h;
    }
}

void nest_order_narrow(NestOrder *order)
{
    order->narrow = true;
    order->narrow_top[0] = (NestTop){0, NEST_WORLD_MEDIUM};
    for (uint32_t h = 0; h < order->n_hulls; h++) {
        order->narrow_level[h] = (uint8_t)order->top[h].level;
        order->narrow_top[order->top[h].level] = order->top[h];
    }
}

Status nest_order_build(NestOrder *order, NestPolicy policy, const NestHull *hulls, uint32_t n_hulls,
                        const NestOverlap *overlaps, size_t n_overlaps, Error *error)
{
    *order = (NestOrder){.policy = policy, .n_hulls = n_hulls};
    TRY(make_tables(order, n_hulls ? n_hulls : 1, error));
    for (uint32_t h = 0; h < n_hulls; h++) {
        order->top[h].medium = hulls[h].mixes ? NEST_WORLD_MEDIUM : hulls[h].medium;
        order->rank[h] = h;
    }
    Status status = STATUS_OK;
    if (policy == NEST_AUTOMATIC) status = order_automatic(order, hulls, overlaps, n_overlaps, error);
    if (policy == NEST_PRIORITY) status = order_priority(order, hulls, error);
    if (status == STATUS_OK) status = sink_mixing(order, hulls, error);
    if (status == STATUS_OK) give_levels(order);
    order->sorted = (policy == NEST_AUTOMATIC || policy == NEST_PRIORITY) && !order->n_mixing;
    if (order->sorted && n_hulls <= NEST_NARROW && status == STATUS_OK) nest_order_narrow(order);
    if (status != STATUS_OK) nest_order_clear(order);
    return status;
}

Status nest_order_combine(NestOrder *order, const NestCsg *csg, Error *error)
{
    NestOrder combined = *order;
    size_t n_hulls = order->n_hulls, n = n_hulls + csg->n_operands + 1;
    TRY(make_tables(&combined, n, error));
    for (size_t h = 0; h < n_hulls; h++) {
        combined.rank[h] = order->rank[h];
        combined.top[h].medium = order->top[h].medium;
        combined.circle[h] = order->circle[h];
    }
    /* operands stand below all hulls, rank 0, and where no hull is there is the world */
    for (size_t h = n_hulls; h < n; h++) combined.top[h].medium = NEST_WORLD_MEDIUM;
    free(order->rank);
    give_levels(&combined);
    combined.csg = csg;
    combined.sorted = combined.narrow = false;
    *order = combined;
    return STATUS_OK;
}

void nest_order_clear(NestOrder *order)
{
    free(order->rank);
    *order = (NestOrder){0};
}

void nest_order_settle(const NestOrder *order, NestList *list)
{
    const uint32_t *items = nest_list_items(list);
    NestPoint *point = &list->point;
    *point = (NestPoint){1, nest_top_of_row(order, items, list->n)};
    if (!order->narrow) return;
    for (uint32_t i = 0; i < list->n; i++) point->mask |= 1ULL << order->top[items[i]].level;
    point->top = order->narrow_top[HIGHEST_BIT(point->mask)];
    list->n = 0;
}

bool nest_has(const NestOrder *order, const NestList *list, uint32_t hull)
{
    return order->narrow ? list->point.mask >> order->top[hull].level & 1 : nest_list_has(list, hull);
}

uint32_t nest_item(const NestOrder *order, const NestList *list, uint32_t i)
{
    if (!order->narrow) return nest_list_items(list)[i];
    uint32_t level = 0;
    for (uint32_t k = 0; k <= i; k++) do
            level++;
        while (!(list->point.mask >> level & 1));
    return order->hull_at[level];
}
