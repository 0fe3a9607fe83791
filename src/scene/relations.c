/* relations.c - how the hulls of a scene lie to each other, found along lines.
 *
 * First, lines through each hull, over its whole silhouette: what they meet says whether the hull lies inside of
 * another one, overlaps it, touches it, or leaves a thin gap. A pair is judged along the lines of its smaller hull.
 * Second, lines through the common part of the bounds of pairs where that is much smaller than the hull. Third, where a
 * pair's surfaces are near each other and no overlap has been seen, lines through ever smaller boxes about the place
 * where the two are nearest. Fourth, where a pair overlaps in part, a line or two through the thickest place of what
 * they share. None of this is needed for two spheres, which are judged by formula, nor for hulls that keep away from each
 * other's surfaces (relation_apart.c), as nearly all of many bubbles do. Of pairs that lie alike one is judged
 * (relation_alike.c).
 *
 * All lines are fixed by the scene, each task writes to its own place, and the results are put together in
 * order, so that the answer does not depend on threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/relations.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/hash.h"
#include "scene/relation_parts.h"

enum {
    LINES_IN_ALL = 300000, /* of one stage and one class: about half a second */
    LINES_MAX = 600,       /* of one hull, of one pair */
    LINES_MIN = 15,
    SEARCH_LINES_IN_ALL = 500000,
    SEARCH_STEPS_MAX = 10,
    SEARCH_STEPS_MIN = 3,
    SEARCH_LINES = 45
};
static const double gap_lines_part = 0.05; /* of the lines that meet the hull: fewer are a near miss, not a gap */

/* ---- the first stage: lines through a hull ---- */

/* Whether the hull has more on the line than an edge, about which the surfaces of others may disagree. */
static bool meets_really(const Probe *probe, uint32_t hull)
{
    for (uint32_t i = probe->first[hull]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
        const Interval *interval = &probe->intervals[i];
        if (is_real(interval->end - interval->begin, interval->enter, interval->leave)) return true;
    }
    return false;
}

/* A pair is judged along the lines of its smaller hull, and two balls by formula. */
static bool is_judged_by(const Finder *f, uint32_t hull, uint32_t other)
{
    return other != hull && relation_is_smaller(f, hull, other) && !(f->radius[hull] > 0 && f->radius[other] > 0);
}

static void judge_hull_line(const Finder *f, Worker *worker, FactList *list, uint32_t hull, const Line *line)
{
    const CompiledScene *compiled = f->compiled;
    Probe *probe = &worker->probe;
    bool met = probe_surfaces(probe, compiled, line, hull);
    for (size_t i = 0; i < probe->forward.n; i++) { /* whose surface comes near the hull, even if this line misses it */
        uint32_t other = compiled_hull(compiled, probe->forward.items[i].object);
        if (!is_judged_by(f, hull, other)) continue;
        PairFacts *facts = relation_facts_of(worker, list, hull, other);
        if (facts) facts->seen = true;
    }
    if (!met) return;
    probe_intervals(probe, compiled, line);
    if (!meets_really(probe, hull)) return;
    list->n_lines++;
    for (size_t i = 0; i < probe->n_intervals; i++) {
        uint32_t other = probe->intervals[i].hull;
        if (probe->first[other] != i || !is_judged_by(f, hull, other)) continue;
        PairFacts *facts = relation_facts_of(worker, list, hull, other);
        if (facts) relation_judge(f->compiled, probe, line, facts);
    }
}

/* How many lines a hull gets. Where very many surfaces stand on each line, fewer lines are enough to pay for. */
static uint32_t lines_through(const Finder *f, Probe *probe, uint32_t hull, Box3 box)
{
    const double many = 50;
    size_t n_surfaces = 0;
    LineSet set;
    Line line;
    line_set_begin(&set, box, 0, 1, hull);
    while (line_set_next(&set, &line)) {
        probe_surfaces(probe, f->compiled, &line, SCENE_NONE);
        probe_intervals(probe, f->compiled, &line);
        size_t n = probe->forward.n + probe->backward.n;
        if (n > n_surfaces) n_surfaces = n;
    }
    double share = fmax(1, (double)n_surfaces / many);
    return (uint32_t)fmax(f->lines_of_hull[f->radius[hull] == 0] / share, LINES_MIN);
}

static void task_of_judge(void *context, uint32_t judge_number, unsigned number)
{
    Finder *f = context;
    Worker *worker = &f->workers[number];
    FactList *list = &f->judge_facts[judge_number];
    uint32_t hull = f->judges[judge_number];
    Box3 box = widened(f->compiled->hull_bounds[hull], margin_of(f->compiled->hull_bounds[hull]));
    worker->probe.look_back = HUGE_VAL; /* how much stands on a line counts, too */
    uint32_t n_lines = lines_through(f, &worker->probe, hull, box);
    worker->probe.look_back = (double)f->reach[hull];
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        uint32_t face = 0;
        line_set_begin(&set, box, direction, n_lines / LINE_DIRECTIONS, hull);
        while (line_set_next(&set, &line)) {
            if (set.face != face)
                for (size_t i = 0; i < list->n; i++) relation_end_face(&list->items[i], set.n_face[face]);
            face = set.face;
            judge_hull_line(f, worker, list, hull, &line);
        }
        for (size_t i = 0; i < list->n; i++) relation_end_face(&list->items[i], set.n_face[face]);
    }
    for (size_t i = 0; i < list->n; i++) worker->fact_of[list->items[i].other] = 0;
    if (list->n) qsort(list->items, list->n, sizeof *list->items, relation_compare_facts);
    relation_fit_facts(list);
}

/* ---- the second and third stage: lines through a pair ---- */

static void judge_pair_in(const Finder *f, Probe *probe, PairFacts *facts, Box3 box, uint32_t n, uint64_t seed)
{
    probe->look_back = (double)f->reach[facts->own];
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        uint32_t face = 0;
        line_set_begin(&set, box, direction, n / LINE_DIRECTIONS, seed);
        while (line_set_next(&set, &line)) {
            if (set.face != face) relation_end_face(facts, set.n_face[face]);
            face = set.face;
            probe_surfaces(probe, f->compiled, &line, SCENE_NONE); /* none: the line may still be inside of both */
            probe_intervals(probe, f->compiled, &line);
            relation_judge(f->compiled, probe, &line, facts);
        }
        relation_end_face(facts, set.n_face[face]);
    }
}

/* What the lines of a hull said; NULL when it has none. */
static const FactList *facts_along(const Finder *f, uint32_t hull)
{
    return f->judge_of[hull] ? &f->judge_facts[f->judge_of[hull] - 1] : NULL;
}

static const PairFacts *hull_facts_of(const Finder *f, uint32_t own, uint32_t other)
{
    const FactList *list = facts_along(f, own);
    const PairFacts key = {.other = other};
    return list && list->n ? bsearch(&key, list->items, list->n, sizeof key, relation_compare_facts) : NULL;
}

static uint64_t pair_seed(const Candidate *candidate)
{
    return ((uint64_t)candidate->a << 32 | candidate->b) + 1;
}

/* The second stage. */
static void task_of_pair(void *context, uint32_t number, unsigned worker)
{
    Finder *f = context;
    Candidate *candidate = &f->candidates[number];
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    if (!candidate->region_small || !is_judged_by(f, own, other)) return;
    PairFacts *facts = relation_only_facts(&candidate->facts, own, other);
    uint32_t n = f->lines_of_pair[f->radius[own] == 0 && f->radius[other] == 0];
    if (facts)
        judge_pair_in(f, &f->workers[worker].probe, facts, candidate->region, n, pair_seed(candidate));
    else
        f->workers[worker].probe.out_of_memory = true;
}

/* Whether no overlap has been seen where there could be one. */
static bool needs_search(const Finder *f, const Candidate *candidate)
{
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    if (!candidate->meet || !is_judged_by(f, own, other)) return false;
    const PairFacts *known = hull_facts_of(f, own, other);
    if (known && known->overlaps) return false;
    if (candidate->facts.n) return !candidate->facts.items[0].overlaps;
    return known && known->seen;
}

/* The third stage closes in on the place where the two come nearest, until they overlap or are seen not to. The volume
 * that a late step finds is that of its box alone: small, but then so is the overlap. */
static void task_of_search(void *context, uint32_t number, unsigned worker)
{
    const double shrink =
        0.45; /* of the box from step to step; the nearest place may lie somewhat off the place found */
    Finder *f = context;
    Candidate *candidate = &f->candidates[number];
    if (!needs_search(f, candidate)) return;
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    Probe *probe = &f->workers[worker].probe;
    PairFacts *facts = candidate->facts.n ? candidate->facts.items : relation_only_facts(&candidate->facts, own, other);
    if (!facts) {
        probe->out_of_memory = true;
        return;
    }
    const Estimate contact = facts->contact, gap_area = facts->gap_area; /* of the whole region: better than a box's */
    Box3 region = candidate->region;
    Vec3 half = vec3_scale(vec3_sub(region.max, region.min), 0.5);
    for (int step = 0; step < f->search_steps && !facts->overlaps; step++) {
        Box3 box = region;
        if (isfinite(facts->nearest)) {
            half = vec3_scale(half, shrink);
            box = common(region, (Box3){vec3_sub(facts->nearest_place, half), vec3_add(facts->nearest_place, half)});
        } else if (step > 1) {
            break; /* no line meets both */
        }
        facts->volume = (Estimate){0};
        judge_pair_in(f, probe, facts, box, SEARCH_LINES, pair_seed(candidate) + hash_u64((uint64_t)step));
    }
    facts->contact = contact;
    facts->gap_area = gap_area;
}

/* ---- putting it together ---- */

static void relate(const Finder *f, const PairFacts *first, uint32_t n_lines, HullPair *pair)
{
    const Box3 *bounds = f->compiled->hull_bounds;
    if (!first || !pair->overlaps) return;
    double slack = box_rounding(bounds[first->other]);
    bool own_inside = !first->own_out && first->n_inside == n_lines &&
                      box3_holds(widened(bounds[first->other], slack), bounds[first->own]);
    bool other_inside = !first->other_out && box3_holds(widened(bounds[first->own], slack), bounds[first->other]);
    if (own_inside == other_inside) return; /* both: the same hull twice */
    uint32_t inner = own_inside ? first->own : first->other;
    pair->relation = inner == pair->a ? NEST_A_IN_B : NEST_B_IN_A;
    pair->overlap_volume = f->compiled->hulls[inner].volume;
    pair->overlap_volume_error = 0;
}

void relation_facts_known(const Finder *f, const Candidate *candidate, const PairFacts *facts[2])
{
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    facts[0] = hull_facts_of(f, own, other);
    facts[1] = candidate->facts.n ? candidate->facts.items : NULL;
}

/* Whether the gap narrows to nothing, as beside an edge where two boxes meet, or around the place where a ball rests on a
 * plate. In both the distances across are spread evenly by area, from nothing on, so that of n lines the nearest is about an
 * n-th of the way to twice their mean. Where it is several times that from nothing, the gap is open at its narrowest, too. */
static bool is_wedge(const PairFacts *facts)
{
    const double several = 4, least_lines = 8;
    double n = facts->n_across, step = 2 * (facts->gap_sum / n - facts->gap) / n;
    return n >= least_lines && facts->gap <= several * step;
}

HullPair relation_judge_candidate(const Finder *f, const Candidate *candidate)
{
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    HullPair pair = {.a = candidate->a, .b = candidate->b, .gap = HUGE_VAL, .overlap_depth = candidate->depth};
    const NestHull *hulls = f->compiled->hulls;
    if (!(hulls[own].volume > 0 && hulls[other].volume > 0)) return pair; /* combinations of which nothing is left */
    const PairFacts *facts[2];
    relation_facts_known(f, candidate, facts);
    const PairFacts *first = facts[0], *second = facts[1];
    const FactList *along_own = facts_along(f, own);
    uint32_t n_lines = along_own ? along_own->n_lines : 0;
    const PairFacts *volume = second && (candidate->region_small || !first || !first->overlaps) ? second : first;
    for (int i = 0; i < 2; i++) {
        if (!facts[i]) continue;
        pair.overlaps = pair.overlaps || facts[i]->overlaps;
        pair.touches = pair.touches || facts[i]->touches;
        pair.contact_offset = fmax(pair.contact_offset, facts[i]->offset);
    }
    const PairFacts *areas = candidate->region_small && second ? second : first;
    if (areas) {
        pair.contact_area = areas->contact.sum;
        pair.contact_area_error = sqrt(areas->contact.variance);
    }
    if (volume && pair.overlaps) {
        pair.overlap_volume = fmin(volume->volume.sum / LINE_DIRECTIONS, fmin(hulls[own].volume, hulls[other].volume));
        pair.overlap_volume_error = sqrt(volume->volume.variance) / LINE_DIRECTIONS;
    }
    relate(f, first, n_lines, &pair);
    if (first && first->n_gap >= 2 && first->n_gap >= gap_lines_part * n_lines) {
        pair.gap = first->gap;
        pair.gap_most = first->gap_most;
        pair.wedge = is_wedge(first);
        pair.gap_area = first->gap_area.sum;
        pair.gap_area_error = sqrt(first->gap_area.variance);
    }
    return pair;
}

/* The fourth stage: the thickness of a partial overlap, along a line through its thickest place, as far as is known,
 * that is turned until it stands at right angles to the faces where it begins and ends. */
static void task_of_depth(void *context, uint32_t number, unsigned worker)
{
    enum { TURNS = 5 };
    Finder *f = context;
    Candidate *candidate = &f->candidates[number];
    Probe *probe = &f->workers[worker].probe;
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    if (!is_judged_by(f, own, other)) return;
    HullPair pair = relation_judge_candidate(f, candidate);
    if (!pair.overlaps || pair.relation != NEST_PARTIAL) return;
    const PairFacts *first = hull_facts_of(f, own, other), *best = candidate->facts.n ? candidate->facts.items : first;
    if (first && best && first->depth > best->depth) best = first;
    if (!best || !(best->depth > 0)) return;
    Vec3 place = best->depth_place, normal = best->depth_normal;
    Box3 box = f->compiled->hull_bounds[own];
    double reach = diagonal(box);
    Box3 both = box3_union(relation_neighbourhood(f, own), relation_neighbourhood(f, other));
    probe->look_back = 1.001 * (reach + diagonal(both));
    candidate->depth = best->depth;
    for (int turn = 0; turn < TURNS && vec3_length(normal) > 0; turn++) {
        Vec3 direction = vec3_normalize(normal);
        Line line = {vec3_along(place, -reach, direction), vec3f_from(direction), 2 * reach, best->depth_time, 0};
        Shared shared = {0};
        probe_surfaces(probe, f->compiled, &line, SCENE_NONE);
        probe_intervals(probe, f->compiled, &line);
        for (uint32_t i = probe->first[own]; i != INTERVAL_NONE; i = probe->intervals[i].next)
            for (uint32_t k = probe->first[other]; k != INTERVAL_NONE; k = probe->intervals[k].next) {
                Shared found = shared_of(&probe->intervals[i], &probe->intervals[k]);
                if (found.begin < reach && reach < found.end) shared = found;
            }
        if (!shared.from || !shared.to) return;
        candidate->depth = (shared.end - shared.begin) * fmin(cosine(shared.from), cosine(shared.to));
        place = vec3_along(line.start, (shared.begin + shared.end) / 2, vec3_from_f(line.direction));
        normal = vec3_add(normal_ahead(shared.from), normal_ahead(shared.to));
    }
}

static uint32_t lines_of_each(size_t n)
{
    size_t lines = LINES_IN_ALL / (n ? n : 1);
    return lines < LINES_MIN ? LINES_MIN : lines > LINES_MAX ? LINES_MAX : (uint32_t)lines;
}

/* Shares the lines out. */
static void plan(Finder *f)
{
    size_t n_hulls[2] = {0}, n_pairs[2] = {f->n_small_regions, 0};
    for (size_t i = 0; i < f->n_candidates; i++) {
        const Candidate *candidate = &f->candidates[i];
        uint32_t own, other;
        relation_by_size(f, candidate, &own, &other);
        f->judge_of[own] = 1; /* to be numbered */
        n_pairs[f->radius[candidate->a] == 0 && f->radius[candidate->b] == 0] += candidate->region_small;
    }
    for (uint32_t h = 0; h < f->compiled->n_hulls; h++)
        if (f->judge_of[h]) {
            n_hulls[f->radius[h] == 0]++;
            f->judge_of[h] = ++f->n_judges;
        }
    for (int i = 0; i < 2; i++) {
        f->lines_of_hull[i] = lines_of_each(n_hulls[i]);
        f->lines_of_pair[i] = lines_of_each(n_pairs[i]);
    }
}

static Status prepare_workers(Finder *f, unsigned n_workers, Error *error)
{
    size_t n = f->compiled->n_hulls;
    f->workers = calloc(n_workers, sizeof *f->workers);
    f->judges = malloc((f->n_judges + 1U) * sizeof *f->judges);
    f->judge_facts = calloc(f->n_judges + 1U, sizeof *f->judge_facts);
    if (!f->workers || !f->judges || !f->judge_facts)
        return fail_memory(error, f->n_judges * sizeof *f->judge_facts, "how the hulls lie");
    for (uint32_t h = 0; h < n; h++)
        if (f->judge_of[h]) f->judges[f->judge_of[h] - 1] = h;
    for (unsigned i = 0; i < n_workers && f->n_candidates; i++) {
        f->workers[i].fact_of = calloc(n, sizeof *f->workers[i].fact_of);
        if (!f->workers[i].fact_of) return fail_memory(error, n * sizeof *f->workers[i].fact_of, "how the hulls lie");
        TRY(probe_init(&f->workers[i].probe, f->compiled, error));
    }
    return STATUS_OK;
}

static Status prepare(Finder *f, Error *error)
{
    const CompiledScene *compiled = f->compiled;
    size_t n = compiled->n_hulls ? compiled->n_hulls : 1;
    f->radius = calloc(n, sizeof *f->radius);
    f->reach = calloc(n, sizeof *f->reach);
    f->judge_of = calloc(n, sizeof *f->judge_of);
    f->near_shape_of = calloc(compiled->scene->n_shapes + 1U, sizeof *f->near_shape_of);
    if (!f->radius || !f->reach || !f->judge_of || !f->near_shape_of)
        return fail_memory(error, n * sizeof *f->radius, "how the hulls lie");
    TRY(relation_find_near(f, error));
    return relation_set_alike_aside(f, error);
}

/* What was needed to judge the candidates, and what was found out about them. */
static void forget_judged(Finder *f)
{
    for (unsigned i = 0; f->workers && i < pool_threads(f->pool); i++) {
        probe_clear(&f->workers[i].probe);
        free(f->workers[i].fact_of);
    }
    for (uint32_t i = 0; f->judge_facts && i < f->n_judges; i++) free(f->judge_facts[i].items);
    for (size_t i = 0; i < f->n_candidates; i++) free(f->candidates[i].facts.items);
    free(f->workers);
    free(f->judges);
    free(f->judge_facts);
    f->workers = NULL;
    f->judges = NULL;
    f->judge_facts = NULL;
    f->n_judges = 0;
    f->n_candidates = 0;
}

static void finder_clear(Finder *f)
{
    forget_judged(f);
    relation_forget_shapes(f);
    free(f->radius);
    free(f->reach);
    free(f->judge_of);
    free(f->candidates);
    free(f->alike);
    free(f->decided);
    free(f->meetings);
}

/* All stages, for the candidates that there are. */
static Status judge_candidates(Finder *f, Error *error)
{
    Pool *pool = f->pool;
    if (!f->n_candidates) return STATUS_OK;
    plan(f);
    TRY(prepare_workers(f, pool_threads(pool), error));
    pool_run(pool, f->n_judges, task_of_judge, f);
    pool_run(pool, (uint32_t)f->n_candidates, task_of_pair, f);
    double n_searches = 1;
    for (size_t i = 0; i < f->n_candidates; i++) n_searches += needs_search(f, &f->candidates[i]);
    f->search_steps = (int)fmin(SEARCH_LINES_IN_ALL / (SEARCH_LINES * n_searches), SEARCH_STEPS_MAX);
    if (f->search_steps >= SEARCH_STEPS_MIN) pool_run(pool, (uint32_t)f->n_candidates, task_of_search, f);
    pool_run(pool, (uint32_t)f->n_candidates, task_of_depth, f);
    for (unsigned i = 0; i < pool_threads(pool); i++)
        if (f->workers[i].probe.out_of_memory)
            return fail(error, STATUS_NOMEM, "out of memory while finding out how the hulls lie");
    for (size_t i = 0; i < f->n_candidates; i++) {
        HullPair pair = relation_judge_candidate(f, &f->candidates[i]);
        if (pair.overlaps || pair.touches || isfinite(pair.gap)) TRY(relation_add_decided(f, &pair, error));
    }
    return STATUS_OK;
}

/* Those that lie as others do. Where the answer of one is not good for all of its like, another may be asked. */
static Status judge_alike(Finder *f, Error *error)
{
    enum { ROUNDS = 4 };
    for (int round = 1;; round++) {
        TRY(relation_share(f, error));
        if (!f->n_alike) return STATUS_OK;
        forget_judged(f);
        for (; f->n_alike; f->n_alike--) {
            AlikePair pair = f->alike[f->n_alike - 1];
            if (!ARRAY_ROOM(f->candidates, f->candidates_capacity, f->n_candidates))
                return fail_memory(error, f->n_candidates * sizeof *f->candidates, "pairs of hulls");
            f->candidates[f->n_candidates++] = relation_candidate(f, pair.a, pair.b);
        }
        if (round < ROUNDS) TRY(relation_set_alike_aside(f, error));
        memset(f->judge_of, 0, f->compiled->n_hulls * sizeof *f->judge_of);
        TRY(judge_candidates(f, error));
    }
}

Status relations_find(const CompiledScene *compiled, Pool *pool, HullPair **pairs, size_t *n_pairs,
                      NestMeeting **meetings, size_t *n_meetings, Error *error)
{
    Finder f = {.compiled = compiled, .pool = pool};
    Status status = prepare(&f, error);
    if (status == STATUS_OK) status = judge_candidates(&f, error);
    if (status == STATUS_OK) status = judge_alike(&f, error);
    if (status == STATUS_OK && !ARRAY_ROOM(f.decided, f.decided_capacity, f.n_decided)) /* none is a list, too */
        status = fail_memory(error, f.n_decided * sizeof *f.decided, "pairs of hulls");
    if (status == STATUS_OK) {
        if (f.n_decided) qsort(f.decided, f.n_decided, sizeof *f.decided, relation_compare_pairs);
        *pairs = f.decided;
        *n_pairs = f.n_decided;
        *meetings = f.meetings;
        *n_meetings = f.n_meetings;
        f.decided = NULL;
        f.meetings = NULL;
    }
    finder_clear(&f);
    return status;
}
