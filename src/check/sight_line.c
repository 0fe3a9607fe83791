/* sight_line.c - what stands along a line through a compiled scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include "check/sight_line.h"

#include <stdlib.h>

#include "base/array.h"
#include "check/report_parts.h"
#include "nest/cross.h"
#include "scene/ties.h"

/* A combination has a surface where it begins or ends, and none where an operand does so within it, or outside. Leaves of n hits those
 * whose objects have one; entering becomes the object's own. */
static size_t keep_surfaces(const CompiledScene *compiled, const NestList *before, const NestList *behind, Hit *hits,
                            size_t n)
{
    const NestCsg *csg = compiled->order.csg;
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t hull = compiled->hull_of_object[hits[i].object];
        if (csg && hull != SCENE_NONE && hull >= csg->first_operand) {
            uint32_t tree = nest_csg_tree(csg, hull);
            bool held = nest_csg_holds(csg, tree, before), holds = nest_csg_holds(csg, tree, behind);
            if (held == holds) continue;
            hits[i].entering = holds;
        }
        hits[kept++] = hits[i];
    }
    return kept;
}

/* The objects whose surfaces are among n hits, each once. */
static uint32_t count_objects(const CompiledScene *compiled, const Hit *hits, size_t n)
{
    uint32_t count = 0;
    for (size_t i = 0; i < n; i++) {
        size_t k = 0;
        while (scene_whole(compiled->scene, hits[k].object) != scene_whole(compiled->scene, hits[i].object)) k++;
        count += k == i;
    }
    return count;
}

/* What no paint has a say in. */
static SightKind kind_of(const CompiledScene *compiled, const NestCrossing *crossing)
{
    const SceneMedium *media = compiled->scene->media;
    if (crossing->owner_from == crossing->owner_to) return SIGHT_SILENT;
    if (crossing->medium_from == crossing->medium_to) return SIGHT_MERGED;
    for (float nm = 400; nm <= 700; nm += 50)
        if (spectrum_at_one(&media[crossing->medium_from].ior, nm) !=
            spectrum_at_one(&media[crossing->medium_to].ior, nm))
            return SIGHT_BOUNDARY;
    return SIGHT_ALIKE;
}

/* Crosses the surfaces at one place; false when memory ends. */
static bool cross_all(const CompiledScene *compiled, const Hit *hits, size_t n, NestList *list, NestCrossing *crossing)
{
    uint32_t n_passes = 0;
    NestPass *passes = malloc(n * sizeof *passes);
    if (!passes) return false;
    crossing->owner_from = crossing->owner_to = nest_owner(&compiled->order, list);
    crossing->medium_from = crossing->medium_to = nest_medium(list);
    for (size_t i = 0; i < n; i++) {
        uint32_t pass = compiled->hull_of_object[hits[i].object];
        if (pass != SCENE_NONE) passes[n_passes++] = (NestPass){pass, hits[i].entering};
    }
    bool fine = !n_passes || nest_cross(list, &compiled->order, passes, n_passes, crossing) == STATUS_OK;
    free(passes);
    return fine;
}

/* Crosses the surfaces at one place, and notes what that is; false when memory ends. */
static bool add_step(const CompiledScene *compiled, Hit *hits, size_t n, NestList *list, SightLine *line)
{
    NestCrossing crossing = {0};
    NestList before;
    nest_list_init(&before);
    bool fine = ARRAY_ROOM(line->steps, line->capacity, line->n) && nest_list_copy(&before, list) == STATUS_OK &&
                cross_all(compiled, hits, n, list, &crossing);
    if (fine) n = keep_surfaces(compiled, &before, list, hits, n);
    nest_list_clear(&before);
    if (!fine || n == 0) return fine;
    const Hit *opaque = ties_met(compiled, hits, n), *first = opaque ? opaque : &hits[0];
    bool painted = false;
    for (size_t i = 0; i < n; i++) painted |= scene_is_painted(compiled->scene, hits[i].object);
    SightKind kind = opaque || crossing.opaque ? SIGHT_OPAQUE : kind_of(compiled, &crossing);
    if (painted && (kind == SIGHT_MERGED || kind == SIGHT_ALIKE)) kind = SIGHT_PAINTED;
    line->steps[line->n++] = (SightStep){.distance = hits[0].t,
                                         .kind = kind,
                                         .object = scene_whole(compiled->scene, first->object),
                                         .n = count_objects(compiled, hits, n),
                                         .from = crossing.medium_from,
                                         .to = crossing.medium_to,
                                         .top = crossing.owner_to,
                                         .entering = first->entering,
                                         .operand = first->object,
                                         .normal = first->normal};
    return true;
}

Status sight_line_find(const CompiledScene *compiled, const Ray *ray, SightLine *line, Error *error)
{
    HitList hits = {0};
    NestList list;
    *line = (SightLine){0};
    nest_list_init(&list);
    bool fine = compiled_interior(compiled, vec3f_from(ray->origin), ray->time, &hits, &list, NULL) == STATUS_OK;
    if (fine) {
        line->start = nest_medium(&list);
        rtc_all(compiled->rtc, ray, false, &hits);
        fine = !hits.out_of_memory;
    }
    for (size_t begin = 0; fine && begin < hits.n;) {
        size_t n = rtc_cluster(hits.items + begin, hits.n - begin);
        fine = add_step(compiled, hits.items + begin, n, &list, line);
        begin += n;
        if (line->n && line->steps[line->n - 1].kind == SIGHT_OPAQUE) break;
    }
    hit_list_clear(&hits);
    nest_list_clear(&list);
    return fine ? STATUS_OK : fail_memory(error, 0, "what stands along a line");
}

void sight_line_clear(SightLine *line)
{
    free(line->steps);
    *line = (SightLine){0};
}

const SightStep *sight_line_end(const SightLine *line)
{
    const SightStep *last = line->n ? &line->steps[line->n - 1] : NULL;
    return last && last->kind == SIGHT_OPAQUE ? last : NULL;
}

/* The rule by which the hull on top is above an object's own; NULL when the report of pairs does not know of them. */
static const char *rule_between(const CompiledScene *compiled, uint32_t top, uint32_t object)
{
    uint32_t above = compiled->object_of_hull[top];
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if ((pair->a != above || pair->b != object) && (pair->b != above || pair->a != object)) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        return verdict.kind == VERDICT_RULE ? nest_rule_text(verdict.rule) : NULL;
    }
    return NULL;
}

static void print_step(const CompiledScene *compiled, const SightStep *step, Buf *row)
{
    const Scene *scene = compiled->scene;
    const char *from = scene->media[step->from].name, *to = scene->media[step->to].name;
    report_add_length(&row[0], scene, step->distance);
    buf_add(&row[1], scene->objects[step->object].name);
    if (step->n > 1) buf_format(&row[1], " and %u more", (unsigned)step->n - 1);
    switch (step->kind) {
    case SIGHT_BOUNDARY: buf_format(&row[2], "boundary from %s to %s", from, to); break;
    case SIGHT_MERGED: buf_format(&row[2], "in silence: what is before and behind is %s", to); break;
    case SIGHT_ALIKE: buf_format(&row[2], "in silence: %s and %s bend light alike", from, to); break;
    case SIGHT_PAINTED: buf_format(&row[2], "painted, from %s to %s, which bend light alike", from, to); break;
    case SIGHT_OPAQUE: buf_add(&row[2], "opaque"); break;
    case SIGHT_SILENT:
        buf_format(&row[2], "%s in silence", step->entering ? "entered" : "left");
        uint32_t hull = compiled_hull(compiled, step->object);
        if (hull != SCENE_NONE && compiled->hulls[hull].mixes) {
            bool adds = report_adds(scene, compiled->hulls[hull].medium, step->to);
            buf_format(&row[2], adds ? ": it adds to %s" : ": there is none of it in %s", to);
            break;
        }
        if (step->top == NEST_WORLD) break;
        buf_format(&row[2], ": %s is on top", report_object(compiled, step->top)->name);
        const char *rule = rule_between(compiled, step->top, step->object);
        if (rule) buf_format(&row[2], ", by %s", rule);
        break;
    }
}

void sight_line_print(const CompiledScene *compiled, const SightLine *line, Buf *out)
{
    ReportTable table = {.n_columns = 3, .right = {[0] = true}};
    buf_format(out, "Along the line, which starts in %s and goes straight through all boundaries\n",
               compiled->scene->media[line->start].name);
    if (!line->n) buf_add(out, "  nothing\n");
    for (size_t i = 0; i < line->n; i++) print_step(compiled, &line->steps[i], report_row(&table));
    report_print_table(&table, out);
}

void sight_line_print_json(const CompiledScene *compiled, const SightLine *line, JsonWriter *json)
{
    static const char *const kinds[] = {"boundary", "silent", "merged", "alike", "painted", "opaque"};
    const Scene *scene = compiled->scene;
    json_begin_object(json);
    json_add_text(json, "start", scene->media[line->start].name);
    json_key(json, "surfaces");
    json_begin_array(json);
    for (size_t i = 0; i < line->n; i++) {
        const SightStep *step = &line->steps[i];
        json_begin_object(json);
        json_add_number(json, "distance", step->distance);
        json_add_text(json, "object", scene->objects[step->object].name);
        json_add_whole(json, "objects", step->n);
        json_add_text(json, "kind", kinds[step->kind]);
        json_add_truth(json, "entering", step->entering);
        json_add_text(json, "from", scene->media[step->from].name);
        json_add_text(json, "to", scene->media[step->to].name);
        json_end(json);
    }
    json_end(json);
    json_end(json);
}
