/* relations.c - how the hulls of a scene lie to each other, found along lines.
 *
 * First, lines through each hull, over its whole silhouette: what they meet says whether the hull lies inside of
 * another one, overlaps it, touches it, or leaves a thin gap. A pair is judged along the lines of its smaller hull.
 * Second, lines through the common part of the bounds of pairs where that is much smaller than the hull. Third, where a
 * pair's surfaces are near each other and no overlap has been seen, lines through ever smaller boxes about the place
 * where the two are nearest. Fourth, where a pair overlaps in part, a line or two through the thickest place of what
 * they share. Spheres need none of this: two of them are judged by formula.
 *
 * All lines are fixed by the scene, each task writes to its own place, and the results are put together in
 * order, so that the answer does not depend on threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/relations.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/hash.h"
#include "geom/box_pairs.h"
#include "scene/lines.h"

enum {
    LINES_IN_ALL = 300000, /* of one stage and one class: about half a second */
    LINES_MAX = 600,       /* of one hull, of one pair */
    LINES_MIN = 15,
    SEARCH_LINES_IN_ALL = 500000,
    SEARCH_STEPS_MAX = 10,
    SEARCH_STEPS_MIN = 3,
    SEARCH_LINES = 45
};
static const double pi = 3.14159265358979323846;
static const double gap_part = 0.02;       /* of the smaller hull's middle extent: wider is no gap but room */
static const double gap_lines_part = 0.05; /* of the lines that meet the hull: fewer are a near miss, not a gap */
/* Cosines between normals: faces that run along each other, not a ball that rests on a plate. */
static const double opposite = -0.998, parallel = 0.99;
static const double facing = -0.2; /* two ends of a stretch between which it makes sense to speak of a thickness */

/* A quantity summed over evenly spread lines. */
typedef struct Estimate {
    double sum_face, squares_face; /* of the present face */
    double sum, variance;
} Estimate;

/* What is known of one pair. `own` is the hull whose lines or bounds were used. */
typedef struct PairFacts {
    uint32_t own, other;
    bool overlaps, touches, own_out, other_out, seen;
    uint32_t n_inside; /* lines that meet own and find it inside of other */
    uint32_t n_gap;
    double gap;
    double depth;                       /* the thickness of the overlap where it seems to be largest, */
    double depth_time;                  /* when, */
    Vec3 depth_place;                   /* where the middle of the stretch is that says so, */
    Vec3 depth_normal;                  /* and the direction between its faces */
    double offset;                      /* the largest distance between faces that stand at one place */
    Estimate volume, contact, gap_area; /* volume three times over, once for each direction */
    double nearest;                     /* distance along a line between the two, the least so far */
    Vec3 nearest_place;
} PairFacts;

typedef struct FactList {
    PairFacts *items;
    size_t n, capacity;
    uint32_t n_lines; /* that met the hull */
} FactList;

/* The memory of one worker. */
typedef struct Worker {
    Probe probe;
    uint32_t *fact_of; /* of each other hull: 1 + its place in the list of the present hull's facts, or 0 */
} Worker;

/* A pair whose bounds come near each other, but for two balls. */
typedef struct Candidate {
    uint32_t a, b;
    Box3 region;       /* common part of the bounds */
    bool meet;         /* there is one */
    bool region_small; /* and it is much smaller than the smaller hull: worth lines of its own */
    FactList facts;    /* of the second and third stage; at most one */
    double depth;      /* of the fourth */
} Candidate;

typedef struct Finder {
    const CompiledScene *compiled;
    Worker *workers;
    double *radius;         /* of spheres; 0: no sphere */
    float *reach;           /* of each hull: no point near it is further from the far end of a hull around that point */
    uint32_t *judges;       /* hulls with a pair that is judged along their lines, in rising order */
    uint32_t n_judges;
    uint32_t *judge_of;     /* of each hull: 1 + its place among these, or 0 */
    FactList *judge_facts;  /* of each judge */
    Candidate *candidates;
    size_t n_candidates, candidates_capacity;
    HullPair *ball_pairs;   /* that meet: two balls are judged at once */
    size_t n_ball_pairs, ball_pairs_capacity;
    size_t n_small_regions; /* of all two balls whose bounds come near each other */
    uint32_t lines_of_hull[2],
        lines_of_pair[2]; /* [0] balls and pairs with a ball, [1] others: bubbles are many, glasses few */
    int search_steps;
} Finder;

/* ---- hulls by size ---- */

/* Half the area of a box. */
static double half_area(Box3 box)
{
    Vec3 s = vec3_sub(box.max, box.min);
    return s.x * s.y + s.y * s.z + s.z * s.x;
}

/* By which hulls are small or large. */
static double extent_of(const Finder *f, uint32_t hull)
{
    return half_area(f->compiled->hull_bounds[hull]);
}

/* The second of the three: the width of a pane, the thickness of a rod. */
static double middle_extent(Box3 box)
{
    Vec3 s = vec3_sub(box.max, box.min);
    return fmax(fmin(s.x, s.y), fmin(fmax(s.x, s.y), s.z));
}

static Box3 widened(Box3 box, double by)
{
    Vec3 margin = vec3(by, by, by);
    return (Box3){vec3_sub(box.min, margin), vec3_add(box.max, margin)};
}

static bool smaller(const Finder *f, uint32_t a, uint32_t b)
{
    double extent_a = extent_of(f, a), extent_b = extent_of(f, b);
    return extent_a != extent_b ? extent_a < extent_b : a < b;
}

static double box_rounding(Box3 box)
{
    double largest = fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
    return rtc_rounding(vec3(largest, largest, largest));
}

/* How far beyond a hull's bounds its gaps are looked for. */
static double margin_of(Box3 box)
{
    return gap_part * middle_extent(box) + 2 * box_rounding(box);
}

/* A hull that is a ball in the world: its radius, else 0. */
static double sphere_radius(const SceneShape *shape, const Affine *map)
{
    if (!shape->solid || shape->solid->n_pieces != 1 || shape->solid->pieces[0].kind != PIECE_SPHERE) return 0;
    Vec3 x = vec3(map->m[0][0], map->m[1][0], map->m[2][0]), y = vec3(map->m[0][1], map->m[1][1], map->m[2][1]),
         z = vec3(map->m[0][2], map->m[1][2], map->m[2][2]);
    double s = vec3_length(x), slack = 1e-9 * s;
    bool even = fabs(vec3_length(y) - s) <= slack && fabs(vec3_length(z) - s) <= slack &&
                fabs(vec3_dot(x, y)) <= slack * s && fabs(vec3_dot(y, z)) <= slack * s &&
                fabs(vec3_dot(z, x)) <= slack * s;
    return even ? shape->solid->pieces[0].r0 * s : 0;
}

/* ---- what one line says about one pair ---- */

static double cosine(const Hit *hit)
{
    return hit ? fabs(hit->cos_normal) : 1;
}

static double rounding_of(const Hit *a, const Hit *b)
{
    return fmax(a ? a->rounding : 0, b ? b->rounding : 0);
}

/* Whether a stretch between two surfaces is more than what rounding can make or hide. */
static bool is_real(double length, const Hit *a, const Hit *b)
{
    return length > 0 && length * fmin(cosine(a), cosine(b)) > rounding_of(a, b);
}

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

/* The direction of a hit's normal along the line. */
static Vec3 normal_ahead(const Hit *hit)
{
    Vec3 normal = vec3_from_f(hit->normal);
    return hit->cos_normal < 0 ? vec3_scale(normal, -1) : normal;
}

/* Faces of both at one place. */
static bool coincide(const Hit *a, const Hit *b)
{
    return a && b && fabs(a->t - b->t) * fmax(cosine(a), cosine(b)) <= rounding_of(a, b) &&
           fabs(normals_dot(a, b)) > parallel;
}

/* Nothing but the world stands at t. */
static bool is_empty_at(const Probe *probe, double t)
{
    for (size_t i = 0; i < probe->n_intervals; i++)
        if (probe->intervals[i].begin < t && t < probe->intervals[i].end) return false;
    return true;
}

/* What one line adds to a pair's estimates. */
typedef struct LineSums {
    double shared, contact, gap;
} LineSums;

static void note_gap(const Finder *f, const Probe *probe, const Line *line, PairFacts *facts, const Hit *leave,
                     const Hit *enter, LineSums *sums)
{
    if (!leave || !enter || enter->t <= leave->t) return;
    double along = enter->t - leave->t, middle = leave->t + along / 2;
    if (along < facts->nearest) {
        facts->nearest = along;
        facts->nearest_place = vec3_along(line->start, middle, vec3_from_f(line->direction));
    }
    double across = along * fmax(cosine(leave), cosine(enter));
    double widest = gap_part * fmin(middle_extent(f->compiled->hull_bounds[facts->own]),
                                    middle_extent(f->compiled->hull_bounds[facts->other]));
    if (across > widest || across <= rounding_of(leave, enter) || outward_dot(leave, enter) > opposite) return;
    if (!is_empty_at(probe, middle)) return;
    sums->gap += cosine(leave);
    facts->gap = fmin(facts->gap, across);
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

/* The stretch that two intervals share. */
typedef struct Shared {
    double begin, end;
    const Hit *from, *to;
} Shared;

static Shared shared_of(const Interval *a, const Interval *b)
{
    bool a_last = a->begin > b->begin, a_first = a->end < b->end;
    return (Shared){a_last ? a->begin : b->begin, a_first ? a->end : b->end, a_last ? a->enter : b->enter,
                    a_first ? a->leave : b->leave};
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
static void judge_stretches(const Finder *f, const Probe *probe, const Line *line, PairFacts *facts,
                            const Interval *own, const Interval *other, LineSums *sums)
{
    const Hit *own_ends[2] = {own->enter, own->leave}, *other_ends[2] = {other->enter, other->leave};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2; k++) note_contact(facts, own_ends[i], other_ends[k], sums);
    note_gap(f, probe, line, facts, own->leave, other->enter, sums);
    note_gap(f, probe, line, facts, other->leave, own->enter, sums);
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

/* Judges a pair on the line whose intervals are in the probe. */
static void judge(const Finder *f, const Probe *probe, const Line *line, PairFacts *facts)
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
            judge_stretches(f, probe, line, facts, &intervals[i], &intervals[k], &sums);
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

static void end_face(PairFacts *facts, uint32_t n)
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

/* The only row of a list: there may be millions of such lists. */
static PairFacts *add_only_facts(FactList *list, uint32_t own, uint32_t other)
{
    list->items = malloc(sizeof *list->items);
    if (!list->items) return NULL;
    list->capacity = 1;
    return add_facts(list, own, other);
}

/* Gives back the room for more: lists are as many as hulls, and most of them have one row. */
static void fit_facts(FactList *list)
{
    if (list->n == list->capacity) return;
    PairFacts *items = list->n ? realloc(list->items, list->n * sizeof *items) : NULL;
    if (!list->n) free(list->items);
    if (list->n && !items) return;
    list->items = items;
    list->capacity = list->n;
}

/* The facts of a hull's lines; NULL when memory ends. */
static PairFacts *facts_of(Worker *worker, FactList *list, uint32_t own, uint32_t other)
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

static int compare_facts(const void *left, const void *right)
{
    const PairFacts *a = left, *b = right;
    return a->other < b->other ? -1 : a->other > b->other;
}

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
    return other != hull && smaller(f, hull, other) && !(f->radius[hull] > 0 && f->radius[other] > 0);
}

static void judge_hull_line(const Finder *f, Worker *worker, FactList *list, uint32_t hull, const Line *line)
{
    const CompiledScene *compiled = f->compiled;
    Probe *probe = &worker->probe;
    bool met = probe_surfaces(probe, compiled, line, hull);
    for (size_t i = 0; i < probe->forward.n; i++) { /* whose surface comes near the hull, even if this line misses it */
        uint32_t other = compiled_hull(compiled, probe->forward.items[i].object);
        if (!is_judged_by(f, hull, other)) continue;
        PairFacts *facts = facts_of(worker, list, hull, other);
        if (facts) facts->seen = true;
    }
    if (!met) return;
    probe_intervals(probe, compiled, line);
    if (!meets_really(probe, hull)) return;
    list->n_lines++;
    for (size_t i = 0; i < probe->n_intervals; i++) {
        uint32_t other = probe->intervals[i].hull;
        if (probe->first[other] != i || !is_judged_by(f, hull, other)) continue;
        PairFacts *facts = facts_of(worker, list, hull, other);
        if (facts) judge(f, probe, line, facts);
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
                for (size_t i = 0; i < list->n; i++) end_face(&list->items[i], set.n_face[face]);
            face = set.face;
            judge_hull_line(f, worker, list, hull, &line);
        }
        for (size_t i = 0; i < list->n; i++) end_face(&list->items[i], set.n_face[face]);
    }
    for (size_t i = 0; i < list->n; i++) worker->fact_of[list->items[i].other] = 0;
    if (list->n) qsort(list->items, list->n, sizeof *list->items, compare_facts);
    fit_facts(list);
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
            if (set.face != face) end_face(facts, set.n_face[face]);
            face = set.face;
            probe_surfaces(probe, f->compiled, &line, SCENE_NONE); /* none: the line may still be inside of both */
            probe_intervals(probe, f->compiled, &line);
            judge(f, probe, &line, facts);
        }
        end_face(facts, set.n_face[face]);
    }
}

static Box3 common(Box3 a, Box3 b)
{
    return (Box3){vec3(fmax(a.min.x, b.min.x), fmax(a.min.y, b.min.y), fmax(a.min.z, b.min.z)),
                  vec3(fmin(a.max.x, b.max.x), fmin(a.max.y, b.max.y), fmin(a.max.z, b.max.z))};
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
    return list && list->n ? bsearch(&key, list->items, list->n, sizeof key, compare_facts) : NULL;
}

/* The smaller hull of the pair first. */
static void by_size(const Finder *f, const Candidate *candidate, uint32_t *own, uint32_t *other)
{
    bool a_first = smaller(f, candidate->a, candidate->b);
    *own = a_first ? candidate->a : candidate->b;
    *other = a_first ? candidate->b : candidate->a;
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
    by_size(f, candidate, &own, &other);
    if (!candidate->region_small || !is_judged_by(f, own, other)) return;
    PairFacts *facts = add_only_facts(&candidate->facts, own, other);
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
    by_size(f, candidate, &own, &other);
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
    by_size(f, candidate, &own, &other);
    Probe *probe = &f->workers[worker].probe;
    PairFacts *facts = candidate->facts.n ? candidate->facts.items : add_only_facts(&candidate->facts, own, other);
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

/* ---- pairs whose bounds meet ---- */

static bool has_room(Box3 box)
{
    return box.min.x < box.max.x && box.min.y < box.max.y && box.min.z < box.max.z;
}

static bool come_near(const Box3 *a, const Box3 *b, double margin)
{
    return a->min.x - b->max.x < margin && b->min.x - a->max.x < margin && a->min.y - b->max.y < margin &&
           b->min.y - a->max.y < margin && a->min.z - b->max.z < margin && b->min.z - a->max.z < margin;
}

/* Of a ball. */
static Vec3 centre_of(const Finder *f, uint32_t hull)
{
    return f->compiled->scene->objects[f->compiled->object_of_hull[hull]].to_world.t;
}

/* Two balls, by formula. */
static HullPair judge_spheres(const Finder *f, uint32_t a, uint32_t b)
{
    HullPair pair = {.a = a, .b = b, .gap = HUGE_VAL};
    double small = fmin(f->radius[a], f->radius[b]), large = fmax(f->radius[a], f->radius[b]);
    Vec3 centre_a = centre_of(f, a), centre_b = centre_of(f, b);
    double d = vec3_length(vec3_sub(centre_a, centre_b));
    double rounding = fmax(rtc_rounding(centre_a), rtc_rounding(centre_b));
    rounding = fmax(rounding, rtc_rounding(vec3(large, large, large)));
    bool a_small = f->radius[a] < f->radius[b];
    pair.touches = fabs(d - (small + large)) <= rounding || fabs(d + small - large) <= rounding;
    pair.overlaps = d < small + large - rounding;
    if (d <= rounding && large - small <= rounding) pair.contact_area = 4 * pi * small * small;
    if (!pair.overlaps) return pair;
    if (d + small <= large + rounding) {
        pair.relation = small == large ? NEST_PARTIAL : a_small ? NEST_A_IN_B : NEST_B_IN_A;
        pair.overlap_volume = 4 * pi / 3 * small * small * small;
    } else { /* a lens of two caps */
        double depth = small + large - d;
        pair.overlap_depth = depth;
        pair.overlap_volume =
            pi * depth * depth * (d * d + 2 * d * (small + large) - 3 * (large - small) * (large - small)) / (12 * d);
    }
    return pair;
}

/* The bounds of a hull with a little more than its margin around them: the boxes that lines are started from lie
 * within. */
static Box3 neighbourhood(const void *context, uint32_t hull)
{
    const Finder *f = context;
    Box3 box = f->compiled->hull_bounds[hull];
    return box3_is_empty(box) ? box : widened(box, 1.001 * margin_of(box) + 2 * box_rounding(box));
}

static double diagonal(Box3 box)
{
    return vec3_length(vec3_sub(box.max, box.min));
}

static void note_reach(Finder *f, uint32_t a, uint32_t b)
{
    float length = (float)(1.001 * diagonal(box3_union(neighbourhood(f, a), neighbourhood(f, b))));
    f->reach[a] = fmaxf(f->reach[a], length);
    f->reach[b] = fmaxf(f->reach[b], length);
}

/* Pairs whose bounds come near enough for a gap; only where the bounds meet can there be more than that. */
static Status add_candidate(void *context, uint32_t a, uint32_t b, Error *error)
{
    Finder *f = context;
    Box3 box_a = f->compiled->hull_bounds[a], box_b = f->compiled->hull_bounds[b];
    note_reach(f, a, b);
    if (!come_near(&box_a, &box_b, 2 * fmin(margin_of(box_a), margin_of(box_b)))) return STATUS_OK;
    double rounding = fmax(box_rounding(box_a), box_rounding(box_b));
    Box3 region = common(widened(box_a, rounding), widened(box_b, rounding));
    bool meet = has_room(region);
    bool region_small = meet && half_area(region) < 0.6 * fmin(half_area(box_a), half_area(box_b));
    if (f->radius[a] > 0 && f->radius[b] > 0) {
        HullPair pair = judge_spheres(f, a, b);
        f->n_small_regions += region_small;
        if (!pair.overlaps && !pair.touches) return STATUS_OK;
        if (!ARRAY_ROOM(f->ball_pairs, f->ball_pairs_capacity, f->n_ball_pairs))
            return fail_memory(error, f->n_ball_pairs * sizeof *f->ball_pairs, "pairs of hulls");
        f->ball_pairs[f->n_ball_pairs++] = pair;
        return STATUS_OK;
    }
    if (!ARRAY_ROOM(f->candidates, f->candidates_capacity, f->n_candidates))
        return fail_memory(error, f->n_candidates * sizeof *f->candidates, "pairs of hulls");
    f->candidates[f->n_candidates++] =
        (Candidate){.a = a, .b = b, .region = region, .meet = meet, .region_small = region_small};
    return STATUS_OK;
}

static int compare_numbers(uint32_t a, uint32_t b, uint32_t other_a, uint32_t other_b)
{
    if (a != other_a) return a < other_a ? -1 : 1;
    return b < other_b ? -1 : b > other_b;
}

static int compare_candidates(const void *left, const void *right)
{
    const Candidate *a = left, *b = right;
    return compare_numbers(a->a, a->b, b->a, b->b);
}

static int compare_pairs(const void *left, const void *right)
{
    const HullPair *a = left, *b = right;
    return compare_numbers(a->a, a->b, b->a, b->b);
}

static Status find_candidates(Finder *f, Error *error)
{
    TRY(box_pairs_visit(f->compiled->n_hulls, neighbourhood, add_candidate, f, error));
    if (f->n_candidates) qsort(f->candidates, f->n_candidates, sizeof *f->candidates, compare_candidates);
    if (f->n_ball_pairs) qsort(f->ball_pairs, f->n_ball_pairs, sizeof *f->ball_pairs, compare_pairs);
    if (f->n_candidates > UINT32_MAX) return fail(error, STATUS_NOMEM, "too many pairs of hulls");
    return STATUS_OK;
}

/* ---- putting it together ---- */

static void relate(const Finder *f, const PairFacts *first, uint32_t n_lines, HullPair *pair)
{
    const Box3 *bounds = f->compiled->hull_bounds;
    if (!first || !pair->overlaps) return;
    double slack = box_rounding(bounds[first->other]);
    bool own_inside =
        !first->own_out && first->n_inside == n_lines && box3_holds(widened(bounds[first->other], slack), bounds[first->own]);
    bool other_inside = !first->other_out && box3_holds(widened(bounds[first->own], slack), bounds[first->other]);
    if (own_inside == other_inside) return; /* both: the same hull twice */
    uint32_t inner = own_inside ? first->own : first->other;
    pair->relation = inner == pair->a ? NEST_A_IN_B : NEST_B_IN_A;
    pair->overlap_volume = f->compiled->hulls[inner].volume;
    pair->overlap_volume_error = 0;
}

static HullPair judge_candidate(const Finder *f, const Candidate *candidate)
{
    uint32_t own, other;
    by_size(f, candidate, &own, &other);
    HullPair pair = {.a = candidate->a, .b = candidate->b, .gap = HUGE_VAL, .overlap_depth = candidate->depth};
    const PairFacts *first = hull_facts_of(f, own, other), *second = candidate->facts.n ? candidate->facts.items : NULL;
    const FactList *along_own = facts_along(f, own);
    uint32_t n_lines = along_own ? along_own->n_lines : 0;
    const PairFacts *volume = second && (candidate->region_small || !first || !first->overlaps) ? second : first;
    const PairFacts *facts[2] = {first, second};
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
        const NestHull *hulls = f->compiled->hulls;
        pair.overlap_volume = fmin(volume->volume.sum / LINE_DIRECTIONS, fmin(hulls[own].volume, hulls[other].volume));
        pair.overlap_volume_error = sqrt(volume->volume.variance) / LINE_DIRECTIONS;
    }
    relate(f, first, n_lines, &pair);
    if (first && first->n_gap >= 2 && first->n_gap >= gap_lines_part * n_lines) {
        pair.gap = first->gap;
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
    by_size(f, candidate, &own, &other);
    if (!is_judged_by(f, own, other)) return;
    HullPair pair = judge_candidate(f, candidate);
    if (!pair.overlaps || pair.relation != NEST_PARTIAL) return;
    const PairFacts *first = hull_facts_of(f, own, other), *best = candidate->facts.n ? candidate->facts.items : first;
    if (first && best && first->depth > best->depth) best = first;
    if (!best || !(best->depth > 0)) return;
    Vec3 place = best->depth_place, normal = best->depth_normal;
    Box3 box = f->compiled->hull_bounds[own];
    double reach = diagonal(box);
    probe->look_back = 1.001 * (reach + diagonal(box3_union(neighbourhood(f, own), neighbourhood(f, other))));
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

/* The pairs that meet, those of two balls among them, in order. */
static Status put_together(const Finder *f, HullPair **pairs, size_t *n_pairs, Error *error)
{
    size_t n = 0, n_balls = 0, most = f->n_candidates + f->n_ball_pairs;
    HullPair *list = malloc((most ? most : 1) * sizeof *list);
    if (!list) return fail_memory(error, most * sizeof *list, "pairs of hulls");
    for (size_t i = 0; i < f->n_candidates; i++) {
        HullPair pair = judge_candidate(f, &f->candidates[i]);
        if (!pair.overlaps && !pair.touches && !isfinite(pair.gap)) continue;
        while (n_balls < f->n_ball_pairs && compare_pairs(&f->ball_pairs[n_balls], &pair) < 0)
            list[n++] = f->ball_pairs[n_balls++];
        list[n++] = pair;
    }
    while (n_balls < f->n_ball_pairs) list[n++] = f->ball_pairs[n_balls++];
    *pairs = list;
    *n_pairs = n;
    return STATUS_OK;
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
        by_size(f, candidate, &own, &other);
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

static Status prepare(Finder *f, unsigned n_workers, Error *error)
{
    const CompiledScene *compiled = f->compiled;
    size_t n = compiled->n_hulls ? compiled->n_hulls : 1;
    f->radius = calloc(n, sizeof *f->radius);
    f->reach = calloc(n, sizeof *f->reach);
    f->judge_of = calloc(n, sizeof *f->judge_of);
    if (!f->radius || !f->reach || !f->judge_of) return fail_memory(error, n * sizeof *f->radius, "how the hulls lie");
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[h]];
        if (object->shape == SCENE_NONE) continue; /* a combination */
        f->radius[h] = sphere_radius(&compiled->scene->shapes[object->shape], &object->to_world);
    }
    TRY(find_candidates(f, error));
    plan(f);
    return prepare_workers(f, n_workers, error);
}

static void finder_clear(Finder *f, unsigned n_workers)
{
    for (unsigned i = 0; f->workers && i < n_workers; i++) {
        probe_clear(&f->workers[i].probe);
        free(f->workers[i].fact_of);
    }
    for (uint32_t i = 0; f->judge_facts && i < f->n_judges; i++) free(f->judge_facts[i].items);
    for (size_t i = 0; i < f->n_candidates; i++) free(f->candidates[i].facts.items);
    free(f->workers);
    free(f->radius);
    free(f->reach);
    free(f->judges);
    free(f->judge_of);
    free(f->judge_facts);
    free(f->candidates);
    free(f->ball_pairs);
}

Status relations_find(const CompiledScene *compiled, Pool *pool, HullPair **pairs, size_t *n_pairs, Error *error)
{
    unsigned n_workers = pool_threads(pool);
    Finder f = {.compiled = compiled};
    Status status = prepare(&f, n_workers, error);
    if (status == STATUS_OK && f.n_candidates) {
        pool_run(pool, f.n_judges, task_of_judge, &f);
        pool_run(pool, (uint32_t)f.n_candidates, task_of_pair, &f);
        double n_searches = 1;
        for (size_t i = 0; i < f.n_candidates; i++) n_searches += needs_search(&f, &f.candidates[i]);
        f.search_steps = (int)fmin(SEARCH_LINES_IN_ALL / (SEARCH_LINES * n_searches), SEARCH_STEPS_MAX);
        if (f.search_steps >= SEARCH_STEPS_MIN) pool_run(pool, (uint32_t)f.n_candidates, task_of_search, &f);
        pool_run(pool, (uint32_t)f.n_candidates, task_of_depth, &f);
    }
    for (unsigned i = 0; status == STATUS_OK && i < n_workers; i++)
        if (f.workers[i].probe.out_of_memory)
            status = fail(error, STATUS_NOMEM, "out of memory while finding out how the hulls lie");
    if (status == STATUS_OK) status = put_together(&f, pairs, n_pairs, error);
    finder_clear(&f, n_workers);
    return status;
}
