/* relation_line.c - what one line says about a pair of hulls, and the lists of what is known of pairs.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/array.h"
#include "scene/relation_parts.h"

/* Cosines between normals: faces that run along each other, not a ball that rests on a plate. */
static const double opposite = -0.998, parallel = 0.99;
static const double facing = -0.2; /* two ends of a stretch between which it makes sense to speak of a thickness */

static double normals_dot(const Hit *a, const Hit *b)
{
    return (double)vec3f_dot(a->normal, b->normal);
}

/* The same for the outward normals of the two hulls, where a line leaves the one and enters the other: the face of an
 * operand that is taken away from a combination looks into it. */
static double outward_dot(const Hit *leave, const Hit *enter)
{
    bool turned = (leave->cos_normal < 0) != (enter->cos_normal > 0);
    return turned ? -normals_dot(leave, enter) : normals_dot(leave, enter);
}

/* Faces of both at one place. */
static bool coincide(const Hit *a, const Hit *b)
{
    return a && b && fabs(a->t - b->t) * fmax(cosine(a), cosine(b)) <= rounding_of(a, b) &&
           fabs(normals_dot(a, b)) > parallel;
}

/* Nothing but the world stands between two faces. */
static bool is_empty_between(const Probe *probe, const Hit *leave, const Hit *enter)
{
    const double nothing = rounding_of(leave, enter);
    for (size_t i = 0; i < probe->n_intervals; i++) {
        const Interval *in = &probe->intervals[i];
        if (fmin(in->end, enter->t) - fmax(in->begin, leave->t) > nothing) return false;
    }
    return true;
}

/* What one line adds to a pair's estimates. */
typedef struct LineSums {
    double shared, contact, gap;
} LineSums;

static void note_gap(const CompiledScene *compiled, const Probe *probe, const Line *line, PairFacts *facts,
                     const Hit *leave, const Hit *enter, LineSums *sums)
{
    if (!leave || !enter || enter->t <= leave->t) return;
    double along = enter->t - leave->t, middle = leave->t + along / 2;
    if (along < facts->nearest) {
        facts->nearest = along;
        facts->nearest_place = vec3_along(line->start, middle, vec3_from_f(line->direction));
    }
    double across = along * fmax(cosine(leave), cosine(enter));
    double widest = RELATION_GAP_PART * fmin(middle_extent(compiled->hull_bounds[facts->own]),
                                             middle_extent(compiled->hull_bounds[facts->other]));
    if (across > widest || across <= rounding_of(leave, enter) || outward_dot(leave, enter) > opposite) return;
    if (!is_empty_between(probe, leave, enter)) {
        facts->blocked = true;
        return;
    }
    sums->gap += cosine(leave);
    facts->gap = fmin(facts->gap, across);
    facts->gap_most = fmax(facts->gap_most, across);
    facts->gap_sum += across;
    facts->n_across++;
}

/* The directions of the lines are at right angles to each other, so that the squares of their cosines with a normal add
 * up to 1: a face's area is the sum, over all lines, of the cosine times the area that the line stands for. */
static void note_contact(PairFacts *facts, const Hit *own, const Hit *other, LineSums *sums)
{
    if (!coincide(own, other)) return;
    facts->touches = true;
    facts->offset = fmax(facts->offset, fabs(own->t - other->t) * cosine(own));
    sums->contact += cosine(own);
}

/* The thickness of a stretch that both hulls have, where its ends face each other. A slanting line overrates it where
 * the faces are not parallel, so that this only says where to look closer. */
static void note_depth(PairFacts *facts, const Line *line, double begin, double end, const Hit *from, const Hit *to)
{
    if (!from || !to || outward_dot(to, from) > facing) return;
    double depth = (end - begin) * fmin(cosine(from), cosine(to));
    if (depth <= facts->depth) return;
    facts->depth = depth;
    facts->depth_time = line->time;
    facts->depth_place = vec3_along(line->start, (begin + end) / 2, vec3_from_f(line->direction));
    facts->depth_normal = vec3_add(normal_ahead(from), normal_ahead(to));
}

/* The parts of an interval of one hull that the intervals of the other do not cover: whether one is real. */
static bool sticks_out(const Probe *probe, const Interval *of, uint32_t other)
{
    double reached = of->begin;
    const Hit *from = of->enter;
    for (uint32_t i = probe->first[other]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
        const Interval *cover = &probe->intervals[i];
        if (cover->end <= reached) continue;
        if (cover->begin >= of->end) break;
        if (is_real(cover->begin - reached, from, cover->enter)) return true;
        reached = cover->end;
        from = cover->leave;
        if (reached >= of->end) return false;
    }
    return is_real(of->end - reached, from, of->leave);
}

/* One stretch of each of the two: what they share, whether faces coincide, the gaps between them. */
static void judge_stretches(const CompiledScene *compiled, const Probe *probe, const Line *line, PairFacts *facts,
                            const Interval *own, const Interval *other, LineSums *sums)
{
    const Hit *own_ends[2] = {own->enter, own->leave}, *other_ends[2] = {other->enter, other->leave};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) note_contact(facts, own_ends[i], other_ends[k], sums);
    note_gap(compiled, probe, line, facts, own->leave, other->enter, sums);
    note_gap(compiled, probe, line, facts, other->leave, own->enter, sums);
    Shared shared = shared_of(own, other);
    if (!is_real(shared.end - shared.begin, shared.from, shared.to)) return;
    sums->shared += shared.end - shared.begin;
    note_depth(facts, line, shared.begin, shared.end, shared.from, shared.to);
}

static void add_to(Estimate *estimate, double value)
{
    estimate->sum_face += value;
    estimate->squares_face += value * value;
}

void relation_judge(const CompiledScene *compiled, const Probe *probe, const Line *line, PairFacts *facts)
{
    const Interval *intervals = probe->intervals;
    uint32_t first_own = probe->first[facts->own], first_other = probe->first[facts->other];
    LineSums sums = {0};
    bool own_out = false;
    for (uint32_t k = first_other; k != INTERVAL_NONE && !facts->other_out; k = intervals[k].next)
        facts->other_out = sticks_out(probe, &intervals[k], facts->own);
    for (uint32_t i = first_own; i != INTERVAL_NONE; i = intervals[i].next) {
        own_out = own_out || sticks_out(probe, &intervals[i], facts->other);
        for (uint32_t k = first_other; k != INTERVAL_NONE; k = intervals[k].next)
            judge_stretches(compiled, probe, line, facts, &intervals[i], &intervals[k], &sums);
    }
    if (sums.shared > 0) facts->overlaps = true;
    if (own_out) facts->own_out = true;
    if (first_own != INTERVAL_NONE && !own_out) facts->n_inside++;
    if (sums.gap > 0) facts->n_gap++;
    add_to(&facts->volume, sums.shared * line->area);
    add_to(&facts->contact, sums.contact * line->area);
    add_to(&facts->gap_area, sums.gap * line->area);
}

/* Lines are spread over each face by themselves, so the variance adds up over the faces. */
static void end_face_of(Estimate *estimate, uint32_t n)
{
    double mean_square = estimate->squares_face - estimate->sum_face * estimate->sum_face / n;
    estimate->sum += estimate->sum_face;
    estimate->variance += n > 1 ? fmax(mean_square, 0) * n / (n - 1.0) : estimate->squares_face;
    estimate->sum_face = estimate->squares_face = 0;
}

void relation_end_face(PairFacts *facts, uint32_t n)
{
    end_face_of(&facts->volume, n);
    end_face_of(&facts->contact, n);
    end_face_of(&facts->gap_area, n);
}

static PairFacts *add_facts(FactList *list, uint32_t own, uint32_t other)
{
    if (!ARRAY_ROOM(list->items, list->capacity, list->n)) return NULL;
    list->items[list->n] = (PairFacts){.own = own, .other = other, .gap = HUGE_VAL, .nearest = HUGE_VAL};
    return &list->items[list->n++];
}

PairFacts *relation_only_facts(FactList *list, uint32_t own, uint32_t other)
{
    list->items = malloc(sizeof *list->items);
    if (!list->items) return NULL;
    list->capacity = 1;
    return add_facts(list, own, other);
}

void relation_fit_facts(FactList *list)
{
    if (list->n == list->capacity) return;
    PairFacts *items = list->n ? realloc(list->items, list->n * sizeof *items) : NULL;
    if (!list->n) free(list->items);
    if (list->n && !items) return;
    list->items = items;
    list->capacity = list->n;
}

PairFacts *relation_facts_of(Worker *worker, FactList *list, uint32_t own, uint32_t other)
{
    uint32_t place = worker->fact_of[other];
    if (place) return &list->items[place - 1];
    PairFacts *facts = add_facts(list, own, other);
    if (facts)
        worker->fact_of[other] = (uint32_t)list->n;
    else
        worker->probe.out_of_memory = true;
    return facts;
}

int relation_compare_facts(const void *left, const void *right)
{
    const PairFacts *a = left, *b = right;
    return a->other < b->other ? -1 : a->other > b->other;
}
