/* report_sight.c - whether anything of a hull can be seen, found by looking along lines through it.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"

enum {
    LINES_IN_ALL = 200000,
    LINES_OF_HULL_MAX = 600,
    LINES_OF_HULL_MIN = 30,
    CROWD = 200 /* hulls on one line, among which it is not asked what would be there without one of them */
};

uint32_t report_lines_of_each(uint32_t n)
{
    uint32_t lines = n ? LINES_IN_ALL / n : 0;
    return lines > LINES_OF_HULL_MAX ? LINES_OF_HULL_MAX : lines < LINES_OF_HULL_MIN ? LINES_OF_HULL_MIN : lines;
}

/* The same to the eye, whatever they are called. */
static bool alike(const Scene *scene, uint32_t a, uint32_t b)
{
    static const float samples_nm[] = {400, 450, 500, 550, 600, 650, 700};
    const SceneMedium *x = &scene->media[a], *y = &scene->media[b];
    if (a == b) return true;
    if (x->absorbs != y->absorbs || x->emits || y->emits || x->density || y->density || x->mixes || y->mixes)
        return false;
    for (size_t i = 0; i < COUNT_OF(samples_nm); i++) {
        if (spectrum_at_one(&x->ior, samples_nm[i]) != spectrum_at_one(&y->ior, samples_nm[i])) return false;
        if ((x->scatters || y->scatters) &&
            spectrum_at_one(&x->scattering, samples_nm[i]) != spectrum_at_one(&y->scattering, samples_nm[i]))
            return false;
        if (x->absorbs &&
            spectrum_at_one(&x->absorption, samples_nm[i]) != spectrum_at_one(&y->absorption, samples_nm[i]))
            return false;
    }
    return true;
}

/* The medium at t if the hull were not there. */
static uint32_t medium_without(const CompiledScene *compiled, const Probe *probe, uint32_t hull, double t)
{
    uint32_t top = SCENE_NONE;
    for (size_t i = 0; i < probe->n_intervals; i++) {
        const Interval *other = &probe->intervals[i];
        if (other->hull == hull || !(other->begin < t && t < other->end)) continue;
        if (compiled->hulls[other->hull].mixes) continue;
        if (top == SCENE_NONE || compiled->order.rank[other->hull] > compiled->order.rank[top]) top = other->hull;
    }
    return top == SCENE_NONE ? NEST_WORLD_MEDIUM : compiled->hulls[top].medium;
}

/* Whether the hull makes a difference between begin and end, where it is on top. */
static bool makes_difference(const CompiledScene *compiled, const Probe *probe, uint32_t hull, double begin, double end)
{
    const Scene *scene = compiled->scene;
    uint32_t medium = compiled->hulls[hull].medium;
    if (probe->n_intervals > CROWD || scene_is_painted(scene, compiled->object_of_hull[hull])) return true;
    if (!alike(scene, medium, medium_without(compiled, probe, hull, (begin + end) / 2))) return true;
    for (size_t i = 0; i < probe->n_intervals; i++) { /* what is below may change in between */
        const Interval *other = &probe->intervals[i];
        const double ends[2] = {other->begin, other->end};
        for (int k = 0; k < 2; k++) {
            if (other->hull == hull || !(begin < ends[k] && ends[k] < end)) continue;
            double step = 0.25 * fmin(ends[k] - begin, end - ends[k]);
            if (!alike(scene, medium, medium_without(compiled, probe, hull, ends[k] - step)) ||
                !alike(scene, medium, medium_without(compiled, probe, hull, ends[k] + step)))
                return true;
        }
    }
    return false;
}

bool report_next_seen(const CompiledScene *compiled, const Probe *probe, const Interval *own, ReportStretch *stretch)
{
    const uint32_t *rank = compiled->order.rank;
    double reached = stretch->end;
    const Hit *from = stretch->until;
    while (reached < own->end) {
        double next = own->end;
        const Hit *until = own->leave;
        bool covered = false;
        for (size_t i = 0; i < probe->n_intervals && !covered; i++) {
            const Interval *other = &probe->intervals[i];
            if (rank[other->hull] <= rank[own->hull] || other->end <= reached) continue;
            if (other->begin <= reached) {
                reached = other->end;
                from = other->leave;
                covered = true;
            } else if (other->begin < next) {
                next = other->begin;
                until = other->enter;
            }
        }
        if (covered) continue;
        double cos_from = from ? fabs(from->cos_normal) : 1, cos_until = until ? fabs(until->cos_normal) : 1;
        double rounding = fmax(from ? from->rounding : 0, until ? until->rounding : 0);
        *stretch = (ReportStretch){reached, next, from, until};
        if ((next - reached) * fmin(cos_from, cos_until) > rounding) return true;
        reached = next > reached ? next : nextafter(reached, HUGE_VAL);
        from = until;
    }
    return false;
}

/* What is seen on one of the hull's intervals. */
static ReportSight sight_on(const CompiledScene *compiled, const Probe *probe, const Interval *own)
{
    ReportSight sight = REPORT_HIDDEN;
    ReportStretch stretch = report_stretch_before(own);
    while (report_next_seen(compiled, probe, own, &stretch)) {
        if (makes_difference(compiled, probe, own->hull, stretch.begin, stretch.end)) return REPORT_SEEN;
        sight = REPORT_INDIFFERENT;
    }
    return sight;
}

ReportSight report_look_at(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines)
{
    ReportSight sight = REPORT_NOT_MET;
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, compiled->hull_bounds[hull], direction, n_lines / LINE_DIRECTIONS, hull);
        while (probe_next_line(probe, compiled, &set, hull, &line))
            for (uint32_t i = probe->first[hull]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
                ReportSight here = sight_on(compiled, probe, &probe->intervals[i]);
                if (here == REPORT_SEEN) return REPORT_SEEN;
                if (here > sight) sight = here;
            }
    }
    return probe->out_of_memory ? REPORT_NOT_MET : sight;
}
