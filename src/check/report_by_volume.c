/* report_by_volume.c - objects of which nothing but their size says which is on top.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"

double report_volumes_differ(const CompiledScene *compiled, const ReportVerdict *verdict)
{
    return 1 - compiled->hulls[verdict->top].volume / compiled->hulls[verdict->bottom].volume;
}

static bool is_by_volume(const CompiledScene *compiled, const HullPair *pair, ReportVerdict *verdict)
{
    if (!pair->overlaps || pair->relation != NEST_PARTIAL) return false;
    *verdict = report_verdict(compiled, pair);
    if (verdict->kind != VERDICT_RULE || verdict->rule != NEST_BY_VOLUME) return false;
    const NestHull *top = &compiled->hulls[verdict->top], *bottom = &compiled->hulls[verdict->bottom];
    bool has_states = top->state != NEST_STATE_UNKNOWN && bottom->state != NEST_STATE_UNKNOWN;
    return !has_states && isfinite(bottom->volume) &&
           report_volumes_differ(compiled, verdict) >= REPORT_CLOSE_VOLUMES; /* else close-order says it */
}

static void report_one(const CompiledScene *compiled, const ReportVerdict *verdict, Diag *diag)
{
    const SceneObject *top = report_object(compiled, verdict->top), *bottom = report_object(compiled, verdict->bottom);
    Diagnostic *report = diag_report(
        diag, D_ORDER_BY_VOLUME, top->span,
        "%s is on top of %s only because it has less volume: no state says which of %s and %s is solid", top->name,
        bottom->name, compiled->scene->media[top->medium].name, compiled->scene->media[bottom->medium].name);
    diag_note(diag, report, bottom->span, "%s is here", bottom->name);
    diag_hint(diag, report, "write state = solid or state = liquid in both media, or a priority");
}

void report_order_by_volume(const CompiledScene *compiled, Diag *diag)
{
    uint32_t tops[REPORT_MOST], bottoms[REPORT_MOST], n = 0; /* media, of which it is said once */
    for (size_t i = 0; i < compiled->n_pairs && n < REPORT_MOST; i++) {
        ReportVerdict verdict;
        if (!is_by_volume(compiled, &compiled->pairs[i], &verdict)) continue;
        uint32_t top = compiled->hulls[verdict.top].medium, bottom = compiled->hulls[verdict.bottom].medium, known = 0;
        while (known < n && (tops[known] != top || bottoms[known] != bottom)) known++;
        if (known < n) continue;
        tops[n] = top;
        bottoms[n++] = bottom;
        report_one(compiled, &verdict, diag);
    }
}
