/* report_warnings.c - mistakes that only the geometry shows: thin gaps, and objects that nothing is ever seen of.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "check/report_parts.h"

/* ---- gaps ---- */

static Vec3 extent_of(const CompiledScene *compiled, uint32_t object)
{
    Box3 box = compiled->hull_bounds[compiled->hull_of_object[object]];
    return vec3_sub(box.max, box.min);
}

/* A gap that is thin for things of that size, or that keeps a liquid from what holds it, is seldom meant. Two panes
 * with a little room between them are, and what is beside an edge or around a place where solids stand on each other. What
 * mixes has no boundary that a gap could be seen by. */
static bool is_mistake(const CompiledScene *compiled, const HullPair *pair)
{
    const double thin = 0.02;
    const NestHull *first = &compiled->hulls[compiled->hull_of_object[pair->a]],
                   *second = &compiled->hulls[compiled->hull_of_object[pair->b]];
    Vec3 a = extent_of(compiled, pair->a), b = extent_of(compiled, pair->b);
    if (!isfinite(pair->gap) || first->mixes || second->mixes) return false;
    if (!pair->wedge && pair->gap <= thin * fmin(fmin(a.x, fmin(a.y, a.z)), fmin(b.x, fmin(b.y, b.z)))) return true;
    return (first->state == NEST_LIQUID && second->state == NEST_SOLID) ||
           (first->state == NEST_SOLID && second->state == NEST_LIQUID);
}

static bool are_both_solid(const CompiledScene *compiled, const HullPair *pair)
{
    const NestHull *hulls = compiled->hulls;
    return hulls[compiled->hull_of_object[pair->a]].state == NEST_SOLID &&
           hulls[compiled->hull_of_object[pair->b]].state == NEST_SOLID;
}

/* By how much to let two objects overlap: a thousandth of the smaller one's size or the gap itself, whichever is more,
 * as a round number. */
static double good_overlap(const CompiledScene *compiled, const HullPair *pair)
{
    double wanted =
        0.001 * fmin(vec3_max_abs(extent_of(compiled, pair->a)), vec3_max_abs(extent_of(compiled, pair->b)));
    wanted = fmax(wanted, pair->gap) * compiled->scene->unit_m * (1 - 1e-3);
    double power = pow(10, floor(log10(wanted)));
    double round = wanted <= power       ? power
                   : wanted <= 2 * power ? 2 * power
                   : wanted <= 5 * power ? 5 * power
                                         : 10 * power;
    return round / compiled->scene->unit_m;
}

/* n: how many gaps there are between what the same two places in the text are of. */
static void warn_of_gap(const CompiledScene *compiled, const HullPair *pair, uint32_t n, Diag *diag)
{
    const SceneObject *a = &compiled->scene->objects[pair->a], *b = &compiled->scene->objects[pair->b];
    Buf gap = {0}, overlap = {0};
    report_add_length(&overlap, compiled->scene, good_overlap(compiled, pair));
    report_add_length(&gap, compiled->scene, pair->wedge ? pair->gap_most : pair->gap);
    Diagnostic *report = diag_report(
        diag, D_AIR_GAP, b->span, "between %s and %s is a gap %s%s, filled with the world's %s", b->name, a->name,
        pair->wedge ? "that narrows to nothing from " : "of ", buf_text(&gap), compiled->scene->media[0].name);
    if (n > 1) diag_note_nowhere(diag, report, "and so are %u more between what these lines place", (unsigned)(n - 1));
    diag_note(diag, report, a->span, "%s is here", a->name);
    if (pair->wedge)
        diag_hint(diag, report, "let them overlap all along: the overlap is resolved");
    else if (are_both_solid(compiled, pair))
        diag_hint(diag, report, "right where one stands on the other; to make them one piece, let them overlap by %s",
                  buf_text(&overlap));
    else
        diag_hint(diag, report, "let them overlap by %s: the overlap is resolved", buf_text(&overlap));
    buf_clear(&gap);
    buf_clear(&overlap);
}

static void warn_of_gaps(const CompiledScene *compiled, Diag *diag)
{
    const SceneObject *objects = compiled->scene->objects;
    const HullPair *pairs = compiled->pairs;
    ReportLikes likes = {.n = 0};
    for (size_t i = 0; i < compiled->n_pairs; i++)
        if (is_mistake(compiled, &pairs[i]))
            (void)report_count_like(&likes, &objects[pairs[i].a], &objects[pairs[i].b], i);
    for (uint32_t i = 0; i < likes.n; i++) warn_of_gap(compiled, &pairs[likes.first[i]], likes.counts[i], diag);
    if (likes.n_others)
        diag_report_nowhere(diag, D_AIR_GAP, "%u more pairs of objects leave thin gaps", (unsigned)likes.n_others);
}

/* ---- hidden objects ---- */

/* Only a hull that is below another one somewhere can be hidden, and none that goes on in another one of its medium: of two
 * equal glasses at one place, each poured with a liquid of its own, one is enough to be seen. */
static void mark_lower(const CompiledScene *compiled, bool *lower)
{
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        if (!compiled->pairs[i].overlaps) continue;
        ReportVerdict verdict = report_verdict(compiled, &compiled->pairs[i]);
        if (verdict.kind == VERDICT_RULE || verdict.kind == VERDICT_CIRCLE) lower[verdict.bottom] = true;
    }
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
        if (report_goes_on_in(compiled, pair, a)) lower[a] = false;
        if (report_goes_on_in(compiled, pair, b)) lower[b] = false;
    }
}

/* A hull that the hull is wholly inside of and that is on top of it; SCENE_NONE when it takes several. */
static uint32_t holder_of(const CompiledScene *compiled, uint32_t hull)
{
    uint32_t number = compiled->object_of_hull[hull];
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        bool inside = (pair->a == number && pair->relation == NEST_A_IN_B) ||
                      (pair->b == number && pair->relation == NEST_B_IN_A);
        if (!pair->overlaps || !inside) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.bottom == hull && verdict.kind != VERDICT_MERGE && verdict.kind != VERDICT_MIX) return verdict.top;
    }
    return SCENE_NONE;
}

static void report_hidden(const CompiledScene *compiled, uint32_t hull, Diag *diag)
{
    uint32_t number = compiled->object_of_hull[hull];
    const SceneObject *object = report_object(compiled, hull);
    uint32_t holder = holder_of(compiled, hull);
    Diagnostic *report =
        holder == SCENE_NONE
            ? diag_report(diag, D_HIDDEN_OBJECT, object->span, "%s is wholly inside of objects that are on top of it",
                          object->name)
            : diag_report(diag, D_HIDDEN_OBJECT, object->span, "%s is wholly hidden in %s, which is on top of it",
                          object->name, report_object(compiled, holder)->name);
    int n = 0;
    for (size_t i = 0; i < compiled->n_pairs && n < 3; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps || (pair->a != number && pair->b != number)) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.bottom != hull || verdict.kind == VERDICT_MERGE || verdict.kind == VERDICT_MIX) continue;
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
    uint32_t n_lines = report_lines_of_each(n);
    for (uint32_t h = 0; lower && status == STATUS_OK && h < n; h++)
        if (lower[h] && report_look_at(compiled, &probe, h, n_lines) == REPORT_HIDDEN && ++n_hidden <= REPORT_MOST)
            report_hidden(compiled, h, diag);
    if (n_hidden > REPORT_MOST)
        diag_report_nowhere(diag, D_HIDDEN_OBJECT,
                            "%u more objects are wholly inside of others that are on top of them",
                            (unsigned)(n_hidden - REPORT_MOST));
    probe_clear(&probe);
    free(lower);
}

void report_warnings(const CompiledScene *compiled, const ReportView *view, Diag *diag)
{
    warn_of_gaps(compiled, diag);
    report_vessels(compiled, diag);
    warn_of_hidden(compiled, diag);
    report_lost_lights(compiled, view, diag);
    report_enclosed_lights(compiled, diag);
    report_endless(compiled, diag);
    report_small_volumes(compiled, diag);
    report_nested_parts(compiled, diag);
}
