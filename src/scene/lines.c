/* lines.c - evenly spread lines through a box, and where along a line each hull begins and ends.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/lines.h"

#include <stdlib.h>

#include "base/array.h"
#include "base/hash.h"

Vec3 line_direction(int i)
{
    /* the columns of a rotation by an irrational angle about an irrational axis */
    static const double d[LINE_DIRECTIONS][3] = {
        {0.6253688769553447, 0.7041620779661303, -0.33625813847404845},
        {-0.33867251874299803, 0.6331422255500111, 0.6960113844427063},
        {0.703004048910022, -0.3213824671322321, 0.6344277870933107},
    };
    return vec3(d[i][0], d[i][1], d[i][2]);
}

/* ---- lines through a box ---- */

static double get(Vec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static void put(Vec3 *v, int axis, double x)
{
    *(axis == 0 ? &v->x : axis == 1 ? &v->y : &v->z) = x;
}

void line_set_begin(LineSet *set, Box3 box, int direction, uint32_t n, uint64_t seed)
{
    /* faces of hulls often lie in the box's own: the lines start beyond what rounding can confuse */
    double largest = fmax(vec3_max_abs(box.min), vec3_max_abs(box.max));
    double by = 4 * rtc_rounding(vec3(largest, largest, largest));
    box = (Box3){vec3_sub(box.min, vec3(by, by, by)), vec3_add(box.max, vec3(by, by, by))};
    Vec3 size = vec3_sub(box.max, box.min);
    *set = (LineSet){.box = box, .direction = line_direction(direction)};
    double whole = 0;
    for (int axis = 0; axis < 3; axis++) {
        set->face_area[axis] = get(size, (axis + 1) % 3) * get(size, (axis + 2) % 3) * fabs(get(set->direction, axis));
        whole += set->face_area[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        double share = whole > 0 ? set->face_area[axis] / whole * n : 0;
        set->n_face[axis] = share > 1 ? (uint32_t)(share + 0.5) : 1;
    }
    uint64_t hash = hash_u64(seed * LINE_DIRECTIONS + (uint64_t)direction);
    set->offset[0] = hash_to_unit(hash);
    set->offset[1] = hash_to_unit(hash_u64(hash));
}

/* How far it is from a point on the box to where the direction leaves it. */
static double length_inside(const Box3 *box, Vec3 start, Vec3 direction)
{
    double length = HUGE_VAL;
    for (int axis = 0; axis < 3; axis++) {
        double along = get(direction, axis);
        double wall = along > 0 ? get(box->max, axis) : get(box->min, axis);
        length = fmin(length, (wall - get(start, axis)) / along);
    }
    return fmax(length, 0);
}

bool line_set_next(LineSet *set, Line *line)
{
    while (set->face < 3 && set->i == set->n_face[set->face]) {
        set->face++;
        set->i = 0;
    }
    if (set->face == 3) return false;
    /* the additive recurrence of the plastic number fills a rectangle evenly for any count (M. Roberts, 2018) */
    const double step[2] = {0.7548776662466927, 0.5698402909980532};
    int axis = (int)set->face;
    Vec3 start, size = vec3_sub(set->box.max, set->box.min);
    put(&start, axis, get(set->direction, axis) > 0 ? get(set->box.min, axis) : get(set->box.max, axis));
    for (int k = 0; k < 2; k++) {
        int other = (axis + 1 + k) % 3;
        double u = set->offset[k] + step[k] * (set->i + 1.0);
        put(&start, other, get(set->box.min, other) + (u - floor(u)) * get(size, other));
    }
    line->start = start;
    line->direction = vec3f_from(set->direction);
    line->length = length_inside(&set->box, start, vec3_from_f(line->direction));
    line->area = set->face_area[axis] / set->n_face[axis];
    double turns = set->offset[0] + 0.6180339887498949 * (set->i + 1.0);
    line->time = turns - floor(turns);
    set->i++;
    return true;
}

uint32_t line_set_size(const LineSet *set)
{
    return set->n_face[0] + set->n_face[1] + set->n_face[2];
}

void line_set_skip(LineSet *set, uint32_t n)
{
    for (; set->face < 3 && n >= set->n_face[set->face] - set->i; set->i = 0) n -= set->n_face[set->face++] - set->i;
    set->i += n;
}

/* ---- what stands on a line ---- */

Status probe_init(Probe *probe, const CompiledScene *compiled, Error *error)
{
    *probe = (Probe){.look_back = HUGE_VAL};
    nest_list_init(&probe->operands);
    size_t n = (size_t)compiled->n_hulls + compiled->csg.n_operands + 1;
    probe->depth = calloc(n, sizeof *probe->depth);
    probe->first = malloc(n * sizeof *probe->first);
    if (!probe->depth || !probe->first) return fail_memory(error, n * sizeof *probe->depth, "how the hulls lie");
    for (uint32_t h = 0; h < compiled->n_hulls; h++) probe->first[h] = INTERVAL_NONE;
    return STATUS_OK;
}

void probe_clear(Probe *probe)
{
    hit_list_clear(&probe->forward);
    hit_list_clear(&probe->backward);
    nest_list_clear(&probe->operands);
    free(probe->intervals);
    free(probe->depth);
    free(probe->first);
    *probe = (Probe){.look_back = HUGE_VAL};
}

bool hit_repeats(const HitList *hits, size_t i)
{
    const Hit *hit = &hits->items[i];
    for (size_t k = i; k-- > 0;) {
        const Hit *before = &hits->items[k];
        if ((hit->t - before->t) * fabs(hit->cos_normal) > hit->rounding) return false;
        if (before->object == hit->object) return before->entering == hit->entering;
    }
    return false;
}

/* All surfaces of hulls along a ray. */
static void trace(Probe *probe, const CompiledScene *compiled, const Line *line, Vec3f direction, double length,
                  HitList *hits)
{
    Ray ray = ray_make(line->start, direction);
    ray.time = line_time(compiled, line);
    ray.t_max = length;
    rtc_all(compiled->rtc, &ray, false, hits);
    if (hits->out_of_memory) probe->out_of_memory = true;
    size_t kept = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (compiled_hull(compiled, hits->items[i].object) != SCENE_NONE) hits->items[kept++] = hits->items[i];
    hits->n = kept;
}

bool probe_surfaces(Probe *probe, const CompiledScene *compiled, const Line *line, uint32_t must)
{
    trace(probe, compiled, line, line->direction, line->length, &probe->forward);
    if (must == SCENE_NONE) return probe->forward.n > 0;
    for (size_t i = 0; i < probe->forward.n; i++)
        if (compiled_hull(compiled, probe->forward.items[i].object) == must) return true;
    return false;
}

static bool add_interval(Probe *probe, uint32_t hull, double begin, const Hit *enter)
{
    if (!ARRAY_ROOM(probe->intervals, probe->intervals_capacity, probe->n_intervals)) {
        probe->out_of_memory = true;
        return false;
    }
    probe->intervals[probe->n_intervals++] =
        (Interval){.hull = hull, .begin = begin, .end = HUGE_VAL, .enter = enter, .next = INTERVAL_NONE};
    return true;
}

/* The line's start is inside of that hull, or operand. */
static void starts_inside(Probe *probe, const CompiledScene *compiled, uint32_t pass)
{
    if (pass < compiled->n_hulls)
        add_interval(probe, pass, 0, NULL);
    else if (nest_list_reserve(&probe->operands, 1) != STATUS_OK)
        probe->out_of_memory = true;
    else
        nest_csg_pass(&compiled->csg, &probe->operands, pass, true);
}

/* Of a hull that is not around the line's start, a short look back may see one side alone. */
static bool may_hold_start(const Probe *probe, const CompiledScene *compiled, uint32_t object, Vec3 p)
{
    uint32_t pass = compiled->hull_of_object[object];
    if (isinf(probe->look_back) || compiled->csg.n_trees || pass >= compiled->n_hulls) return true;
    const Box3 *box = &compiled->hull_bounds[pass];
    double slack = rtc_rounding(p);
    return box->min.x - slack <= p.x && p.x <= box->max.x + slack && box->min.y - slack <= p.y &&
           p.y <= box->max.y + slack && box->min.z - slack <= p.z && p.z <= box->max.z + slack;
}

/* Opens the intervals of hulls that the line's start is inside of. */
static void intervals_at_start(Probe *probe, const CompiledScene *compiled, const Line *line)
{
    const HitList *behind = &probe->backward;
    const NestCsg *csg = &compiled->csg;
    for (uint32_t i = 0; i < compiled->n_planes; i++) {
        uint32_t pass = compiled->hull_of_object[compiled->planes[i]];
        if (compiled_hull(compiled, compiled->planes[i]) != SCENE_NONE &&
            rtc_below_plane(compiled->rtc, compiled->planes[i], line->start, line_time(compiled, line)))
            starts_inside(probe, compiled, pass);
    }
    for (size_t i = 0; i < behind->n; i++)
        if (!hit_repeats(behind, i) && !rtc_is_plane(compiled->rtc, behind->items[i].object) &&
            may_hold_start(probe, compiled, behind->items[i].object, line->start))
            probe->depth[compiled->hull_of_object[behind->items[i].object]] += behind->items[i].entering ? -1 : 1;
    for (size_t i = 0; i < behind->n; i++) {
        uint32_t pass = compiled->hull_of_object[behind->items[i].object];
        if (probe->depth[pass] > 0) starts_inside(probe, compiled, pass);
        probe->depth[pass] = 0;
    }
    const uint32_t *inside = nest_list_items(&probe->operands);
    for (uint32_t i = 0; i < probe->operands.n; i++) {
        uint32_t tree = nest_csg_tree(csg, inside[i]);
        bool first = i == 0 || nest_csg_tree(csg, inside[i - 1]) != tree;
        if (first && nest_csg_holds(csg, tree, &probe->operands)) add_interval(probe, csg->trees[tree].hull, 0, NULL);
    }
}

/* Which hull a surface bounds, and whether it is entered there: an operand's is that of its combination, where
 * crossing it makes a difference. SCENE_NONE elsewhere. */
static uint32_t hull_crossed(Probe *probe, const CompiledScene *compiled, const Hit *hit, bool *entering)
{
    uint32_t pass = compiled->hull_of_object[hit->object];
    *entering = hit->entering;
    if (pass < compiled->n_hulls) return pass;
    const NestCsg *csg = &compiled->csg;
    uint32_t tree = nest_csg_tree(csg, pass);
    bool before = nest_csg_holds(csg, tree, &probe->operands);
    if (nest_list_reserve(&probe->operands, 1) != STATUS_OK) probe->out_of_memory = true;
    if (probe->out_of_memory || !nest_csg_pass(csg, &probe->operands, pass, hit->entering)) return SCENE_NONE;
    *entering = nest_csg_holds(csg, tree, &probe->operands);
    return *entering == before ? SCENE_NONE : csg->trees[tree].hull;
}

void probe_intervals(Probe *probe, const CompiledScene *compiled, const Line *line)
{
    Vec3f back = vec3f_negate(line->direction);
    trace(probe, compiled, line, back, compiled->csg.n_trees ? HUGE_VAL : probe->look_back, &probe->backward);
    for (size_t i = 0; i < probe->n_intervals; i++) probe->first[probe->intervals[i].hull] = INTERVAL_NONE;
    probe->n_intervals = 0;
    intervals_at_start(probe, compiled, line);
    const HitList *ahead = &probe->forward;
    /* from here on: 1 + the number of the hull's open interval */
    for (size_t i = 0; i < probe->n_intervals; i++) probe->depth[probe->intervals[i].hull] = (int32_t)i + 1;
    for (size_t i = 0; i < ahead->n; i++) {
        const Hit *hit = &ahead->items[i];
        bool entering;
        uint32_t hull = hull_crossed(probe, compiled, hit, &entering);
        if (hull == SCENE_NONE) continue;
        int32_t open = probe->depth[hull];
        /* an edge reported by both its triangles enters twice or leaves twice: the second says nothing new */
        if (entering && !open && add_interval(probe, hull, hit->t, hit))
            probe->depth[hull] = (int32_t)probe->n_intervals;
        if (entering || !open) continue;
        probe->intervals[open - 1].end = hit->t;
        probe->intervals[open - 1].leave = hit;
        probe->depth[hull] = 0;
    }
    probe->operands.n = 0;
    for (size_t i = probe->n_intervals; i-- > 0;) {
        Interval *interval = &probe->intervals[i];
        probe->depth[interval->hull] = 0;
        if (isinf(interval->end)) interval->end = line->length;
        interval->next = probe->first[interval->hull];
        probe->first[interval->hull] = (uint32_t)i;
    }
}

bool probe_next_line(Probe *probe, const CompiledScene *compiled, LineSet *set, uint32_t hull, Line *line)
{
    while (line_set_next(set, line)) {
        if (!probe_surfaces(probe, compiled, line, hull)) continue;
        probe_intervals(probe, compiled, line);
        return true;
    }
    return false;
}
