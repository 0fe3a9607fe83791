/* report_json.c - the report for programs.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/json.h"
#include "check/report_parts.h"

static void add_place(JsonWriter *json, SourceSet *sources, Span span)
{
    if (!sources || span.source >= sources->n) return;
    SourcePosition place = source_position(sources, span.source, span.begin);
    json_add_text(json, "file", sources->sources[span.source].name);
    json_add_whole(json, "line", place.line);
    json_add_whole(json, "column", place.column);
}

static void add_medium(JsonWriter *json, const SceneMedium *medium)
{
    static const char *const states[] = {NULL, "liquid", "gas", "solid"};
    json_begin_object(json);
    json_add_text(json, "name", medium->name);
    json_add_float(json, "ior", spectrum_at_one(&medium->ior, SCENE_INDEX_NM));
    if (medium->refracts_doubly) {
        const Vec3 axis = medium->optic_axis;
        json_add_float(json, "extraordinary_ior", spectrum_at_one(&medium->extraordinary, SCENE_INDEX_NM));
        json_add_truth(json, "pleochroic", medium->pleochroic);
        json_add_numbers(json, "optic_axis", (const double[3]){axis.x, axis.y, axis.z}, 3);
    }
    json_add_truth(json, "disperses", medium->disperses);
    json_add_truth(json, "absorbs", medium->absorbs);
    json_add_truth(json, "scatters", medium->scatters);
    json_add_truth(json, "shines", medium->emits);
    json_add_truth(json, "mixes", medium->mixes);
    json_add_truth(json, "varies", medium->density != NULL);
    json_add_text(json, "state", states[medium->state]);
    json_add_number(json, "priority", medium->priority);
    json_end(json);
}

static void add_hulls(JsonWriter *json, const CompiledScene *compiled, SourceSet *sources)
{
    uint32_t n = compiled->n_hulls;
    uint32_t *by_rank = calloc(n ? n : 1, sizeof *by_rank);
    ReportOrder order;
    if (!report_order_init(&order, compiled) || !by_rank) {
        json->out->failed = true;
        report_order_clear(&order);
        free(by_rank);
        return;
    }
    for (uint32_t h = 0; h < n; h++) by_rank[n - 1 - compiled->order.rank[h]] = h;
    json_key(json, "objects");
    json_begin_array(json);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t hull = by_rank[i];
        const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[hull]];
        json_begin_object(json);
        json_add_text(json, "name", object->name);
        json_add_whole(json, "number", compiled->object_of_hull[hull]);
        json_add_text(json, "medium", compiled->scene->media[object->medium].name);
        json_add_whole(json, "rank", compiled->order.rank[hull]);
        json_add_whole(json, "cluster", order.cluster[hull]);
        json_add_whole(json, "level", order.level[hull]);
        json_add_number(json, "priority", object->priority);
        json_add_number(json, "volume", compiled->hulls[hull].volume);
        if (compiled->order.circle[hull]) json_add_whole(json, "circle", compiled->order.circle[hull]);
        add_place(json, sources, object->span);
        json_end(json);
    }
    json_end(json);
    report_order_clear(&order);
    free(by_rank);
}

static void add_pair(JsonWriter *json, const CompiledScene *compiled, const HullPair *pair)
{
    static const char *const relations[] = {"partial", "a-in-b", "b-in-a"};
    static const char *const verdicts[] = {"rule", "circle", "merge", "entered", "none", "mix"};
    const Scene *scene = compiled->scene;
    json_begin_object(json);
    json_add_text(json, "a", scene->objects[pair->a].name);
    json_add_text(json, "b", scene->objects[pair->b].name);
    json_add_whole(json, "a_number", pair->a);
    json_add_whole(json, "b_number", pair->b);
    json_add_truth(json, "overlaps", pair->overlaps);
    json_add_truth(json, "touches", pair->touches);
    if (pair->touches) {
        json_add_number(json, "contact_area", pair->contact_area);
        json_add_number(json, "contact_area_error", pair->contact_area_error);
        json_add_number(json, "contact_offset", pair->contact_offset);
    }
    json_add_number(json, "gap", pair->gap); /* infinite: null */
    if (isfinite(pair->gap)) {
        json_add_truth(json, "wedge", pair->wedge); /* then the gap narrows to nothing */
        json_add_number(json, "gap_most", pair->gap_most);
        json_add_number(json, "gap_area", pair->gap_area);
        json_add_number(json, "gap_area_error", pair->gap_area_error);
    }
    if (pair->overlaps) {
        ReportVerdict verdict = report_verdict(compiled, pair);
        bool decided = verdict.kind == VERDICT_RULE || verdict.kind == VERDICT_CIRCLE;
        json_add_text(json, "relation", relations[pair->relation]);
        json_add_number(json, "overlap_volume", pair->overlap_volume);
        json_add_number(json, "overlap_volume_error", pair->overlap_volume_error);
        if (pair->relation == NEST_PARTIAL) json_add_number(json, "overlap_depth", pair->overlap_depth);
        json_add_text(json, "decided", verdicts[verdict.kind]);
        json_add_text(json, "top", decided ? scene->objects[compiled->object_of_hull[verdict.top]].name : NULL);
        json_add_text(json, "rule", decided ? nest_rule_text(verdict.rule) : NULL);
    }
    json_end(json);
}

void report_print_json(const CompiledScene *compiled, SourceSet *sources, Buf *out)
{
    const Scene *scene = compiled->scene;
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_text(&json, "nesting", nest_policy_text(compiled->order.policy));
    json_add_number(&json, "unit_m", scene->unit_m);
    json_key(&json, "media");
    json_begin_array(&json);
    for (uint32_t i = 0; i < scene->n_media; i++) add_medium(&json, &scene->media[i]);
    json_end(&json);
    add_hulls(&json, compiled, sources);
    json_key(&json, "pairs");
    json_begin_array(&json);
    for (size_t i = 0; i < compiled->n_pairs; i++) add_pair(&json, compiled, &compiled->pairs[i]);
    json_end(&json);
    json_add_whole(&json, "circles", compiled->order.n_circles);
    json_end(&json);
    buf_add(out, "\n");
}
