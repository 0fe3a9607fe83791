/* report_warnings.c - mistakes that only the geometry shows: thin gaps, and objects that nothing is ever seen of.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "scene/lines.h"
#include "scene/report_parts.h"

enum {
    WARNINGS_MAX = 10, /* of a kind; the rest are counted */
    LINES_IN_ALL = 200000,
    LINES_OF_HULL_MAX = 600,
    LINES_OF_HULL_MIN = 30
};

/* ---- gaps ---- */

static void warn_of_gaps(const CompiledScene *compiled, Diag *diag)
{
    uint32_t n = 0;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!isfinite(pair->gap) || ++n > WARNINGS_MAX) continue;
        const SceneObject *a = &compiled->scene->objects[pair->a], *b = &compiled->scene->objects[pair->b];
        Buf gap = {0};
        report_add_length(&gap, compiled->scene, pair->gap);
        Diagnostic *report =
            diag_report(diag, D_AIR_GAP, b->span, "between %s and %s is a gap of %s, filled with the world's %s",
                        b->name, a->name, buf_text(&gap), compiled->scene->media[0].name);
        diag_note(diag, report, a->span, "%s is here", a->name);
        diag_hint(diag, report, "let them overlap by a little: the overlap is resolved");
        buf_clear(&gap);
    }
    if (n > WARNINGS_MAX)
        diag_report_nowhere(diag, D_AIR_GAP, "%u more pairs of objects leave thin gaps", (unsigned)(n - WARNINGS_MAX));
}

/* ---- hidden objects ---- */

/* Whether the hull owns some stretch of its interval: one that no hull of higher rank covers. */
static bool owns_part(const CompiledScene *compiled, const Probe *probe, const Interval *own)
{
    const uint32_t *rank = compiled->order.rank;
    double reached = own->begin;
    const Hit *from = own->enter;
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
        if ((next - reached) * fmin(cos_from, cos_until) > rounding) return true;
        reached = next > reached ? next : nextafter(reached, HUGE_VAL);
    }
    return false;
}

static bool is_hidden(const CompiledScene *compiled, Probe *probe, uint32_t hull, uint32_t n_lines)
{
    bool met = false;
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, compiled->hull_bounds[hull], direction, n_lines / LINE_DIRECTIONS, hull);
        while (line_set_next(&set, &line)) {
            if (!probe_surfaces(probe, compiled, &line, hull)) continue;
            probe_intervals(probe, compiled, &line);
            for (uint32_t i = probe->first[hull]; i != INTERVAL_NONE; i = probe->intervals[i].next) {
                met = true;
                if (owns_part(compiled, probe, &probe->intervals[i])) return false;
            }
        }
    }
    return met && !probe->out_of_memory;
}

/* Only a hull that is below another one somewhere can be hidden. */
static void mark_lower(const CompiledScene *compiled, bool *lower)
{
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        if (!compiled->pairs[i].overlaps) continue;
        ReportVerdict verdict = report_verdict(compiled, &compiled->pairs[i]);
        if (verdict.kind == VERDICT_RULE || verdict.kind == VERDICT_CIRCLE) lower[verdict.bottom] = true;
    }
}

static void report_hidden(const CompiledScene *compiled, uint32_t hull, Diag *diag)
{
    uint32_t number = compiled->object_of_hull[hull];
    const SceneObject *object = report_object(compiled, hull);
    Diagnostic *report = diag_report(diag, D_HIDDEN_OBJECT, object->span,
                                     "%s is wholly inside of objects that are on top of it", object->name);
    int n = 0;
    for (size_t i = 0; i < compiled->n_pairs && n < 3; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps || (pair->a != number && pair->b != number)) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.bottom != hull || verdict.kind == VERDICT_MERGE) continue;
        diag_note(diag, report, report_object(compiled, verdict.top)->span, "%s is on top by %s",
                  report_object(compiled, verdict.top)->name,
                  verdict.kind == VERDICT_CIRCLE ? "volume within a circle" : nest_rule_text(verdict.rule));
        n++;
    }
    diag_hint(diag, report, "give it a larger priority if it is meant to be seen");
}

static void warn_of_hidden(const CompiledScene *compiled, Diag *diag)
{
    uint32_t n = compiled->n_hulls, n_hidden = 0;
    bool *lower = calloc(n ? n : 1, sizeof *lower);
    Probe probe;
    Status status = probe_init(&probe, compiled, NULL);
    if (lower && status == STATUS_OK) mark_lower(compiled, lower);
    uint32_t n_lines = n ? LINES_IN_ALL / n : 0;
    if (n_lines > LINES_OF_HULL_MAX) n_lines = LINES_OF_HULL_MAX;
    if (n_lines < LINES_OF_HULL_MIN) n_lines = LINES_OF_HULL_MIN;
    for (uint32_t h = 0; lower && status == STATUS_OK && h < n; h++)
        if (lower[h] && is_hidden(compiled, &probe, h, n_lines) && ++n_hidden <= WARNINGS_MAX)
            report_hidden(compiled, h, diag);
    if (n_hidden > WARNINGS_MAX)
        diag_report_nowhere(diag, D_HIDDEN_OBJECT,
                            "%u more objects are wholly inside of others that are on top of them",
                            (unsigned)(n_hidden - WARNINGS_MAX));
    probe_clear(&probe);
    free(lower);
}

void report_warnings(const CompiledScene *compiled, Diag *diag)
{
    warn_of_gaps(compiled, diag);
    warn_of_hidden(compiled, diag);
}
