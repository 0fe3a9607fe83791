/* combinations.c - what combinations of objects enclose, and those of which nothing is left: both have no closed form, and
 * are found along evenly spread lines.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/combinations.h"

#include <stdlib.h>

#include "base/array.h"
#include "scene/combination_alike.h"
#include "scene/lines.h"

/* ---- volumes ---- */

/* The measuring of a combination, in tasks that are always the same. */
enum {
    MEASURE_LINES = 6000 /* of each direction; the error is about 1e-3 of the volume for plain shapes */,
    MEASURE_TASKS = 8,
    MEASURE_PARTS = LINE_DIRECTIONS * MEASURE_TASKS
};

typedef struct Places {
    Vec3 *items;
    size_t n, capacity;
} Places;

typedef struct Measure {
    CompiledScene *compiled;
    Probe *probes; /* of each worker */
    unsigned n_probes;
    uint32_t tree, hull;
    bool others; /* are alike, and need: */
    double volume[MEASURE_PARTS];
    Box3 found[MEASURE_PARTS];   /* around what lines found of it, and as far as these are from each other */
    double apart[MEASURE_PARTS]; /* that */
    Box3 all_found;              /* around those boxes */
    Places ends[MEASURE_PARTS];  /* where lines first enter it and last leave it, in its own frame; for others */
} Measure;

static Box3 add_around(Box3 box, const Line *line, double t, double margin)
{
    Vec3 place = vec3_along(line->start, t, vec3_from_f(line->direction)), more = vec3(margin, margin, margin);
    return box3_union(box, (Box3){vec3_sub(place, more), vec3_add(place, more)});
}

/* What is between two ends is in any box around them. */
static void keep_ends(Measure *measure, Probe *probe, uint32_t number, const Line *line, double enter, double leave)
{
    const CompiledScene *compiled = measure->compiled;
    const SceneObject *first = combination_first_operand(compiled->scene, measure->tree);
    Places *ends = &measure->ends[number];
    Affine room, to_frame;
    if (!array_reserve(&ends->items, &ends->capacity, ends->n + 2, sizeof *ends->items)) {
        probe->out_of_memory = true;
    } else if (affine_invert(scene_object_place(compiled->scene, first, line_time(compiled, line), &room), &to_frame)) {
        Vec3 direction = vec3_from_f(line->direction);
        ends->items[ends->n++] = affine_point(&to_frame, vec3_along(line->start, enter, direction));
        ends->items[ends->n++] = affine_point(&to_frame, vec3_along(line->start, leave, direction));
    }
}

/* The lines start outside of the combination: those that meet no surface of it find nothing. */
static void task_of_measure(void *context, uint32_t number, unsigned worker)
{
    Measure *measure = context;
    Probe *probe = &measure->probes[worker];
    LineSet set;
    Line line;
    line_set_begin(&set, measure->compiled->hull_bounds[measure->hull], (int)(number / MEASURE_TASKS), MEASURE_LINES,
                   measure->hull);
    uint32_t n = line_set_size(&set), part = number % MEASURE_TASKS;
    uint32_t begin = n * part / MEASURE_TASKS, end = n * (part + 1) / MEASURE_TASKS;
    double volume = 0, widest = 0;
    Box3 found = box3_empty();
    measure->ends[number].n = 0;
    line_set_skip(&set, begin);
    for (uint32_t i = begin; i < end && line_set_next(&set, &line); i++) {
        if (!probe_surfaces(probe, measure->compiled, &line, measure->hull)) continue;
        probe_intervals(probe, measure->compiled, &line);
        double apart = sqrt(line.area), first = HUGE_VAL, last = 0;
        for (uint32_t k = probe->first[measure->hull]; k != INTERVAL_NONE; k = probe->intervals[k].next) {
            double enter = probe->intervals[k].begin, leave = probe->intervals[k].end;
            volume += line.area * (leave - enter) / LINE_DIRECTIONS;
            found = add_around(add_around(found, &line, enter, apart), &line, leave, apart);
            first = double_min(first, enter);
            last = double_max(last, leave);
            widest = double_max(widest, apart);
        }
        if (measure->others && first < HUGE_VAL) keep_ends(measure, probe, number, &line, first, last);
    }
    measure->volume[number] = volume;
    measure->found[number] = found;
    measure->apart[number] = widest;
}

/* others: keeps what task_of_alike needs. */
static double measure_combination(Measure *measure, Pool *pool, uint32_t tree, bool others)
{
    CompiledScene *compiled = measure->compiled;
    uint32_t hull = compiled->csg.trees[tree].hull;
    double volume = 0;
    Box3 found = box3_empty(), *bounds = &compiled->found_bounds[hull];
    measure->tree = tree;
    measure->hull = hull;
    measure->others = others;
    pool_run(pool, MEASURE_PARTS, task_of_measure, measure);
    for (size_t i = 0; i < MEASURE_PARTS; i++) {
        volume += measure->volume[i];
        if (!box3_is_empty(measure->found[i])) found = box3_union(found, measure->found[i]);
    }
    if (!box3_is_empty(found)) *bounds = box3_intersection(*bounds, found);
    measure->all_found = found;
    compiled->hulls[hull].volume = volume;
    return volume;
}

static Status measure_init(Measure *measure, CompiledScene *compiled, unsigned n_workers, Error *error)
{
    *measure = (Measure){.compiled = compiled, .probes = calloc(n_workers, sizeof *measure->probes)};
    if (!measure->probes) return fail_memory(error, n_workers * sizeof *measure->probes, "the volumes of combinations");
    while (measure->n_probes < n_workers) TRY(probe_init(&measure->probes[measure->n_probes++], compiled, error));
    return STATUS_OK;
}

/* Says whether memory lasted. */
static bool measure_clear(Measure *measure)
{
    bool lasted = true;
    for (unsigned i = 0; i < measure->n_probes; i++) {
        lasted = lasted && !measure->probes[i].out_of_memory;
        probe_clear(&measure->probes[i]);
    }
    for (size_t i = 0; i < MEASURE_PARTS; i++) free(measure->ends[i].items);
    free(measure->probes);
    return lasted;
}

/* ---- those that are alike ---- */

/* Combinations that are like the one that has been measured. */
typedef struct Sharing {
    const Measure *measure;
    const uint32_t *trees;
    double volume; /* in their frames */
} Sharing;

/* Around what was found of the measured one if it were where this one is at a key, with the distance of lines from each
 * other as it would be there. */
static Box3 found_there(const Measure *measure, const Affine *place, const Affine *from_measured)
{
    const Affine map = affine_compose(place, from_measured);
    Box3 box = box3_empty();
    double apart = 0;
    for (size_t i = 0; i < MEASURE_PARTS; i++) {
        const Places *ends = &measure->ends[i];
        apart = double_max(apart, measure->apart[i]);
        for (size_t k = 0; k < ends->n; k++) box = box3_add_point(box, affine_point(place, ends->items[k]));
    }
    if (box3_is_empty(box)) return box;
    const Vec3 more = {apart * (fabs(map.m[0][0]) + fabs(map.m[0][1]) + fabs(map.m[0][2])),
                       apart * (fabs(map.m[1][0]) + fabs(map.m[1][1]) + fabs(map.m[1][2])),
                       apart * (fabs(map.m[2][0]) + fabs(map.m[2][1]) + fabs(map.m[2][2]))};
    return (Box3){vec3_sub(box.min, more), vec3_add(box.max, more)};
}

/* Whether two objects stand still, and only in different places. */
static bool only_shifted(const SceneObject *a, const SceneObject *b)
{
    bool same = a->motion == SCENE_NONE && b->motion == SCENE_NONE;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++)
            same = same && a->to_world.m[row][column] == b->to_world.m[row][column];
    return same;
}

/* Around what is there of one that is like the measured one, wherever it moves; first is its first operand. */
static Box3 found_of(const Measure *measure, const SceneObject *first)
{
    const Scene *scene = measure->compiled->scene;
    const SceneObject *measured = combination_first_operand(scene, measure->tree);
    Affine from_measured;
    Box3 found = box3_empty();
    if (only_shifted(first, measured)) { /* as most are: there is no need for each of the ends */
        Vec3 by = vec3_sub(first->to_world.t, measured->to_world.t);
        return (Box3){vec3_add(measure->all_found.min, by), vec3_add(measure->all_found.max, by)};
    }
    if (!affine_invert(combination_place(scene, measured, 0), &from_measured)) return found;
    for (uint32_t key = 0; key < (first->motion == SCENE_NONE ? 1 : scene->n_keys); key++) {
        Box3 there = found_there(measure, combination_place(scene, first, key), &from_measured);
        if (!box3_is_empty(there)) found = box3_union(found, there);
    }
    return found;
}

static void task_of_alike(void *context, uint32_t number, unsigned worker)
{
    (void)worker;
    const Sharing *sharing = context;
    CompiledScene *compiled = sharing->measure->compiled;
    uint32_t tree = sharing->trees[number], hull = compiled->csg.trees[tree].hull;
    Box3 found = found_of(sharing->measure, combination_first_operand(compiled->scene, tree));
    Box3 *bounds = &compiled->found_bounds[hull];
    compiled->hulls[hull].volume = sharing->volume * combination_scale(compiled->scene, tree);
    if (!box3_is_empty(found)) *bounds = box3_intersection(*bounds, found);
}

/* Where nothing is found of the first one, it may be so thin that lines find it by chance: then all are looked at. */
static void measure_alike(Measure *measure, Pool *pool, const uint32_t *trees, uint32_t n)
{
    double volume = measure_combination(measure, pool, trees[0], n > 1);
    if (volume > 0) {
        Sharing sharing = {measure, trees + 1, volume / combination_scale(measure->compiled->scene, trees[0])};
        pool_run(pool, n - 1, task_of_alike, &sharing);
    } else {
        for (uint32_t i = 1; i < n; i++) measure_combination(measure, pool, trees[i], false);
    }
}

/* The combinations whose volume is to be found. */
static uint32_t list_bounded(const CompiledScene *compiled, uint32_t *trees)
{
    uint32_t n = 0;
    for (uint32_t t = 0; t < compiled->csg.n_trees; t++) {
        uint32_t hull = compiled->csg.trees[t].hull;
        if (hull != NEST_OPAQUE && !compiled->unbounded[hull] && !box3_is_empty(compiled->hull_bounds[hull]))
            trees[n++] = t;
    }
    return n;
}

/* Puts the trees that are alike side by side, each group in its order. place[i] becomes where the group ends whose first is
 * trees[i]. */
static void sort_alike(const uint32_t *trees, uint32_t n, const uint32_t *first, uint32_t *sorted, uint32_t *place)
{
    for (uint32_t i = 0; i < n; i++) place[i] = 0;
    for (uint32_t i = 0; i < n; i++) place[first[i]]++;
    for (uint32_t i = 0, at = 0; i < n; i++) {
        uint32_t size = place[i];
        place[i] = at;
        at += size;
    }
    for (uint32_t i = 0; i < n; i++) sorted[place[first[i]]++] = trees[i];
}

/* What a combination encloses has no closed form: it is measured along evenly spread lines; once for all that are alike. */
Status combinations_measure(CompiledScene *compiled, Pool *pool, Error *error)
{
    static const char what[] = "the volumes of combinations";
    uint32_t n_trees = compiled->csg.n_trees, *first = NULL;
    if (!n_trees) return STATUS_OK;
    uint32_t *memory = malloc(3 * (size_t)n_trees * sizeof *memory);
    if (!memory) return fail_memory(error, 3 * (size_t)n_trees * sizeof *memory, what);
    uint32_t *trees = memory, *sorted = memory + n_trees, *end = sorted + n_trees;
    uint32_t n = list_bounded(compiled, trees);
    Measure measure;
    Status status = measure_init(&measure, compiled, pool_threads(pool), error);
    if (status == STATUS_OK) status = combination_find_alike(compiled->scene, trees, n, pool, &first, error);
    if (status == STATUS_OK) {
        sort_alike(trees, n, first, sorted, end);
        for (uint32_t i = 0, begin = 0; i < n; i++) {
            if (first[i] != i) continue;
            measure_alike(&measure, pool, sorted + begin, end[i] - begin);
            begin = end[i];
        }
    }
    if (!measure_clear(&measure) && status == STATUS_OK) status = fail_memory(error, 0, what);
    free(first);
    free(memory);
    return status;
}

/* ---- what is left ---- */

/* Looking for the inside of an opaque combination, which is no hull. */
typedef struct Search {
    const CompiledScene *compiled;
    uint32_t tree;
    HitList hits;
    NestList held; /* operands that hold the place on the line */
    int32_t *net;  /* of each operand, how often the line leaves it less how often it enters it: 0 between lines */
} Search;

static bool is_operand(const Search *search, uint32_t object)
{
    uint32_t pass = search->compiled->hull_of_object[object];
    return pass != SCENE_NONE && pass >= search->compiled->n_hulls &&
           nest_csg_tree(&search->compiled->csg, pass) == search->tree;
}

/* The operands that the line begins in: those that it leaves more often than it enters, and halves of space. */
static void hold_start(Search *search, const Line *line)
{
    const CompiledScene *compiled = search->compiled;
    const NestCsg *csg = &compiled->csg;
    search->held.n = 0;
    for (uint32_t i = 0; i < compiled->n_planes; i++)
        if (is_operand(search, compiled->planes[i]) &&
            rtc_below_plane(compiled->rtc, compiled->planes[i], line->start, line_time(compiled, line)))
            nest_csg_pass(csg, &search->held, compiled->hull_of_object[compiled->planes[i]], true);
    for (size_t i = 0; i < search->hits.n; i++) {
        const Hit *hit = &search->hits.items[i];
        if (!hit_repeats(&search->hits, i) && !rtc_is_plane(compiled->rtc, hit->object))
            search->net[compiled->hull_of_object[hit->object] - csg->first_operand] += hit->entering ? -1 : 1;
    }
    for (size_t i = 0; i < search->hits.n; i++) {
        uint32_t operand = compiled->hull_of_object[search->hits.items[i].object];
        int32_t *net = &search->net[operand - csg->first_operand];
        if (*net > 0) nest_csg_pass(csg, &search->held, operand, true);
        *net = 0;
    }
}

/* Whether any of the line, from its start on, is inside of the combination. */
static bool meets_inside(Search *search, const Line *line)
{
    const CompiledScene *compiled = search->compiled;
    HitList *hits = &search->hits;
    Ray ray = ray_make(line->start, line->direction);
    ray.time = line_time(compiled, line);
    rtc_all(compiled->rtc, &ray, false, hits);
    size_t kept = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (is_operand(search, hits->items[i].object)) hits->items[kept++] = hits->items[i];
    hits->n = kept;
    hold_start(search, line);
    bool inside = nest_csg_holds(&compiled->csg, search->tree, &search->held);
    double begin = 0;
    for (size_t i = 0; i < hits->n; i++) {
        const Hit *hit = &hits->items[i];
        if (inside && (hit->t - begin) * fabs(hit->cos_normal) > hit->rounding) return true;
        nest_csg_pass(&compiled->csg, &search->held, compiled->hull_of_object[hit->object], hit->entering);
        bool still = nest_csg_holds(&compiled->csg, search->tree, &search->held);
        if (still && !inside) begin = hit->t;
        inside = still;
    }
    return inside;
}

/* Few lines find what is plain, more of them what is thin. */
static bool is_left(Search *search, Box3 box)
{
    static const uint32_t n_lines[] = {4, 64, 1000, MEASURE_LINES};
    if (box3_is_empty(box)) return false;
    for (size_t i = 0; i < COUNT_OF(n_lines); i++)
        for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
            LineSet set;
            Line line;
            line_set_begin(&set, box, direction, n_lines[i], search->tree);
            while (line_set_next(&set, &line))
                if (meets_inside(search, &line)) return true;
        }
    return false;
}

static void report_empty(const SceneObject *object, Diag *diag)
{
    diag_hint(diag, diag_report(diag, D_NOTHING_LEFT, object->span, "nothing is left of %s", object->name),
              "do its operands meet, and is not all of it taken away?");
}

Status combinations_report_empty(const CompiledScene *compiled, Diag *diag, Error *error)
{
    const NestCsg *csg = &compiled->csg;
    Search search = {.compiled = compiled, .net = calloc(csg->n_operands, sizeof *search.net)};
    nest_list_init(&search.held);
    bool enough = search.net && nest_list_reserve(&search.held, csg->n_operands) == STATUS_OK;
    for (uint32_t t = 0; enough && t < csg->n_trees; t++) {
        const SceneObject *object = &compiled->scene->objects[compiled->scene->trees[t].object];
        uint32_t hull = csg->trees[t].hull;
        search.tree = t;
        if (hull != NEST_OPAQUE) {
            if (!(compiled->hulls[hull].volume > 0)) report_empty(object, diag);
            continue;
        }
        Box3 box = scene_object_bounds(compiled->scene, object, NULL);
        if (!box3_is_unbounded(box) && !is_left(&search, box)) report_empty(object, diag);
        enough = !search.hits.out_of_memory;
    }
    free(search.net);
    nest_list_clear(&search.held);
    hit_list_clear(&search.hits);
    return enough ? STATUS_OK : fail_memory(error, csg->n_operands * sizeof(int32_t), "what is left of combinations");
}
