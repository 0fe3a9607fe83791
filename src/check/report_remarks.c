/* report_remarks.c - what is worth a look in a scene, and as likely meant as not.
 * A remark that is wrong costs more than one that is missing, so that each of them asks for clear evidence.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/angle.h"
#include "base/array.h"
#include "check/report_parts.h"

/* What the remarks share. */
typedef struct Remarks {
    const CompiledScene *compiled;
    const Scene *scene;
    Diag *diag;
    Box3 *bounds; /* of each object */
    ReportGroups groups;
    Probe probe;
} Remarks;

/* The first few of a kind are reported, the rest counted. */
typedef struct Tally {
    DiagCode code;
    uint32_t n;
} Tally;

static bool tally_next(Tally *tally)
{
    return ++tally->n <= REPORT_MOST;
}

static void tally_end(Remarks *r, const Tally *tally)
{
    report_rest(r->diag, tally->code, tally->n);
}

static bool is_bounded(const Box3 *box)
{
    return box->min.x <= box->max.x;
}

static double size_of(const Box3 *box)
{
    return is_bounded(box) ? vec3_length(vec3_sub(box->max, box->min)) : 0;
}

static bool boxes_meet(const Box3 *a, const Box3 *b, double slack)
{
    return a->min.x - slack <= b->max.x && b->min.x - slack <= a->max.x && a->min.y - slack <= b->max.y &&
           b->min.y - slack <= a->max.y && a->min.z - slack <= b->max.z && b->min.z - slack <= a->max.z;
}

static bool is_one_of_many(const Remarks *r, uint32_t hull)
{
    return r->groups.items[r->groups.of_hull[hull]].n > REPORT_FEW;
}

/* ---- the order ---- */

/* Do nothing but their volumes, which hardly differ, or the order of their declarations say which of the two is on top? */
static bool is_close_order(const Remarks *r, const HullPair *pair, ReportVerdict *verdict)
{
    if (!pair->overlaps) return false;
    *verdict = report_verdict(r->compiled, pair);
    if (verdict->kind != VERDICT_RULE || !isfinite(r->compiled->hulls[verdict->bottom].volume)) return false;
    return verdict->rule == NEST_BY_DECLARATION ||
           (verdict->rule == NEST_BY_VOLUME && report_volumes_differ(r->compiled, verdict) < REPORT_CLOSE_VOLUMES);
}

/* Of pairs of what the same two lines of the text place, one report tells of all. */
static void note_likes(Remarks *r, Diagnostic *report, uint32_t n)
{
    if (n > 1)
        diag_note_nowhere(r->diag, report, "and so it is in %u more pairs of what these lines place",
                          (unsigned)(n - 1));
}

static void remark_one_close_order(Remarks *r, const HullPair *pair, uint32_t n)
{
    const ReportVerdict verdict = report_verdict(r->compiled, pair);
    const SceneObject *top = report_object(r->compiled, verdict.top);
    const SceneObject *bottom = report_object(r->compiled, verdict.bottom);
    Diagnostic *report =
        verdict.rule == NEST_BY_VOLUME
            ? diag_report(r->diag, D_CLOSE_ORDER, top->span,
                          "%s is on top of %s by their volumes, which differ by %.2g %%", top->name, bottom->name,
                          100 * report_volumes_differ(r->compiled, &verdict))
            : diag_report(r->diag, D_CLOSE_ORDER, top->span, "%s is on top of %s only because it is declared later",
                          top->name, bottom->name);
    note_likes(r, report, n);
    diag_note(r->diag, report, bottom->span, "%s is here", bottom->name);
    diag_hint(r->diag, report, "give the one that is meant to be on top a larger priority");
}

static void remark_close_order(Remarks *r)
{
    const HullPair *pairs = r->compiled->pairs;
    ReportLikes likes = {.n = 0};
    for (size_t i = 0; i < r->compiled->n_pairs; i++) {
        ReportVerdict verdict;
        if (is_close_order(r, &pairs[i], &verdict))
            (void)report_count_like(&likes, report_object(r->compiled, verdict.top),
                                    report_object(r->compiled, verdict.bottom), i);
    }
    for (uint32_t i = 0; i < likes.n; i++) remark_one_close_order(r, &pairs[likes.first[i]], likes.counts[i]);
    report_others(r->diag, D_CLOSE_ORDER, likes.n_others);
}

/* What coordinates tell apart at the corner of a box that is farthest out. */
static double rounding_in(const Box3 *box)
{
    return rtc_rounding(
        vec3(fmax(-box->min.x, box->max.x), fmax(-box->min.y, box->max.y), fmax(-box->min.z, box->max.z)));
}

/* Beyond what storing coordinates as floats does by itself: half of a unit in the last place on each side, a quarter of
 * the rounding at most. */
static bool is_near_coincidence(const Remarks *r, const HullPair *pair)
{
    return pair->touches && pair->contact_offset > 0.3 * rounding_in(&r->bounds[pair->a]) &&
           pair->contact_area > 2 * pair->contact_area_error;
}

static void remark_one_near_coincidence(Remarks *r, const HullPair *pair, uint32_t n)
{
    const SceneObject *a = &r->scene->objects[pair->a], *b = &r->scene->objects[pair->b];
    Buf offset = {0};
    report_add_length(&offset, r->scene, pair->contact_offset);
    Diagnostic *report = diag_report(r->diag, D_NEAR_COINCIDENT, b->span,
                                     "faces of %s and %s are %s apart, which is less than coordinates can tell there",
                                     b->name, a->name, buf_text(&offset));
    note_likes(r, report, n);
    diag_note(r->diag, report, a->span, "%s is here", a->name);
    buf_clear(&offset);
}

static void remark_near_coincidence(Remarks *r)
{
    const HullPair *pairs = r->compiled->pairs;
    const SceneObject *objects = r->scene->objects;
    ReportLikes likes = {.n = 0};
    for (size_t i = 0; i < r->compiled->n_pairs; i++)
        if (is_near_coincidence(r, &pairs[i]))
            (void)report_count_like(&likes, &objects[pairs[i].b], &objects[pairs[i].a], i);
    for (uint32_t i = 0; i < likes.n; i++) remark_one_near_coincidence(r, &pairs[likes.first[i]], likes.counts[i]);
    report_others(r->diag, D_NEAR_COINCIDENT, likes.n_others);
}

/* ---- what cannot be seen ---- */

static void mark_merging(const Remarks *r, bool *suspect)
{
    for (size_t i = 0; i < r->compiled->n_pairs; i++) {
        const HullPair *pair = &r->compiled->pairs[i];
        if (!pair->overlaps) continue;
        uint32_t a = r->compiled->hull_of_object[pair->a], b = r->compiled->hull_of_object[pair->b];
        if (r->compiled->hulls[a].medium == r->compiled->hulls[b].medium) suspect[a] = suspect[b] = true;
    }
}

/* An engraving that stands half out: the body is on top where both are, so that nothing is cut out of it. */
static bool hint_at_cut(Remarks *r, Diagnostic *report, uint32_t hull)
{
    const CompiledScene *compiled = r->compiled;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps || pair->relation != NEST_PARTIAL) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.kind != VERDICT_RULE || verdict.bottom != hull) continue;
        const SceneObject *object = report_object(compiled, hull), *body = report_object(compiled, verdict.top);
        diag_hint(r->diag, report,
                  "%s is on top where both are; to cut %s out of it, put both into difference { ... }, %s first, or "
                  "give %s a larger priority",
                  body->name, object->name, body->name, object->name);
        return true;
    }
    return false;
}

/* An equal object of the same medium at the same place; SCENE_NONE. */
static uint32_t twin_of(const CompiledScene *compiled, uint32_t hull)
{
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
        if ((a == hull || b == hull) && report_goes_on_in(compiled, pair, a) && report_goes_on_in(compiled, pair, b))
            return a == hull ? pair->b : pair->a;
    }
    return SCENE_NONE;
}

/* Nothing is said of glasses of the library: several at one place are how liquids are poured on each other. */
static void remark_one_indifferent(Remarks *r, uint32_t hull, bool merges, Tally *tally)
{
    const CompiledScene *compiled = r->compiled;
    const SceneObject *object = report_object(compiled, hull);
    const SceneMedium *medium = &r->scene->media[compiled->hulls[hull].medium];
    const uint32_t twin = twin_of(compiled, hull);
    if ((twin != SCENE_NONE && object->of_library && r->scene->objects[twin].of_library) || !tally_next(tally)) return;
    bool other = !merges && compiled->hulls[hull].medium != NEST_WORLD_MEDIUM; /* and looks the same */
    Diagnostic *report =
        twin == SCENE_NONE
            ? diag_report(r->diag, D_INVISIBLE_OBJECT, object->span,
                          "nothing would change without %s: it is of %s%s%s, and so %s all that it is in", object->name,
                          medium->name, other ? ", which looks like " : "",
                          other ? r->scene->media[NEST_WORLD_MEDIUM].name : "", other ? "does" : "is")
            : diag_report(r->diag, D_INVISIBLE_OBJECT, object->span,
                          "nothing would change without %s: %s is as large, at the same place, and of %s, too",
                          object->name, r->scene->objects[twin].name, medium->name);
    if (twin != SCENE_NONE)
        diag_note(r->diag, report, r->scene->objects[twin].span, "%s is here", r->scene->objects[twin].name);
    else if (!hint_at_cut(r, report, hull) && compiled->hulls[hull].medium != NEST_WORLD_MEDIUM && !other)
        diag_hint(r->diag, report, "a hollow in a body is one of air: interior = air");
}

static void remark_indifferent(Remarks *r)
{
    const CompiledScene *compiled = r->compiled;
    NestPolicy policy = compiled->order.policy;
    bool *suspect = calloc(compiled->n_hulls + 1, sizeof *suspect);
    Tally tally = {.code = D_INVISIBLE_OBJECT};
    if (!suspect || (policy != NEST_AUTOMATIC && policy != NEST_PRIORITY)) {
        free(suspect);
        return;
    }
    mark_merging(r, suspect);
    uint32_t n_lines = report_lines_of_each(compiled->n_hulls);
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        const SceneMedium *medium = &r->scene->media[compiled->hulls[h].medium];
        bool clear = !medium->absorbs && !medium->scatters && !medium->emits &&
                     spectrum_at_one(&medium->ior, 550) == spectrum_at_one(&r->scene->media[0].ior, 550);
        if ((!suspect[h] && !clear) || is_one_of_many(r, h)) continue;
        if (report_look_at(compiled, &r->probe, h, n_lines) == REPORT_INDIFFERENT)
            remark_one_indifferent(r, h, suspect[h], &tally);
    }
    tally_end(r, &tally);
    free(suspect);
}

/* What a gas hides of a liquid that only sticks out of it. Of one that is wholly inside nothing is hidden, so that a
 * hair's breadth decides whether a stream is there. */
static void remark_mostly_hidden(Remarks *r)
{
    const double most = 0.9; /* of the liquid's volume */
    const CompiledScene *compiled = r->compiled;
    Tally tally = {.code = D_MOSTLY_HIDDEN};
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!pair->overlaps || pair->relation != NEST_PARTIAL) continue;
        ReportVerdict verdict = report_verdict(compiled, pair);
        if (verdict.kind != VERDICT_RULE || verdict.rule != NEST_BY_STATE) continue;
        const SceneMedium *medium = &r->scene->media[compiled->hulls[verdict.bottom].medium];
        double hidden = pair->overlap_volume / compiled->hulls[verdict.bottom].volume;
        if (medium->state != NEST_LIQUID || hidden < most || is_one_of_many(r, verdict.bottom)) continue;
        if (r->scene->media[compiled->hulls[verdict.top].medium].state != NEST_GAS || !tally_next(&tally)) continue;
        const SceneObject *liquid = report_object(compiled, verdict.bottom),
                          *gas = report_object(compiled, verdict.top);
        Diagnostic *report = diag_report(
            r->diag, D_MOSTLY_HIDDEN, liquid->span,
            "%s is hidden in %s but for %.2g %% of it, as gas is on top of a liquid that is not wholly inside",
            liquid->name, gas->name, 100 * fmax(0, 1 - hidden));
        diag_note(r->diag, report, gas->span, "%s is here", gas->name);
        diag_hint(r->diag, report,
                  "give %s a larger priority, or cut the hollow with difference { ... } in place of %s; to end within "
                  "it leaves a gap at its wall",
                  liquid->name, gas->name);
    }
    tally_end(r, &tally);
}

/* The height of a point above a plane, in the plane's own measure. */
static double height_of(const Affine *to_plane, Vec3 point)
{
    return affine_point(to_plane, point).y;
}

/* Of each object, in the world; empty for operands of combinations, which count for nothing by themselves. A
 * combination lies within the bounds of its operands. false when memory ends. */
static bool find_bounds(Remarks *r)
{
    const Scene *scene = r->scene;
    r->bounds = malloc((scene->n_objects ? scene->n_objects : 1) * sizeof *r->bounds);
    Box3 *shapes = malloc((scene->n_shapes ? scene->n_shapes : 1) * sizeof *shapes);
    bool ready = r->bounds && shapes;
    for (uint32_t i = 0; ready && i < scene->n_shapes; i++) shapes[i] = scene_shape_bounds(&scene->shapes[i]);
    for (uint32_t i = 0; ready && i < scene->n_objects; i++) r->bounds[i] = box3_empty();
    for (uint32_t i = 0; ready && i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        uint32_t whole = scene_whole(scene, i);
        if (object->shape != SCENE_NONE && is_bounded(&shapes[object->shape]) &&
            !box3_is_unbounded(shapes[object->shape]))
            r->bounds[whole] = box3_union(r->bounds[whole], affine_box(&object->to_world, shapes[object->shape]));
    }
    for (uint32_t h = 0; ready && h < r->compiled->n_hulls; h++)
        r->bounds[r->compiled->object_of_hull[h]] = r->compiled->hull_bounds[h];
    free(shapes);
    return ready;
}

/* A place that a light shines from. One that lies in a wall shines from right before it. */
static Vec3 place_of_light(const Remarks *r, const SceneLight *light)
{
    Vec3 place = light->object == SCENE_NONE ? light->to_world.t : box3_centre(r->bounds[light->object]);
    double step = light_is_flat(light)         ? 1e-3 * light->half_width
                  : light->kind == LIGHT_POINT ? 16 * rtc_rounding(place)
                                               : 0;
    return vec3_along(place, step, affine_vector(&light->to_world, vec3(0, 1, 0)));
}

/* A room that is lit within is a room; by its own walls, too, which shine from both sides. */
static bool holds_light(Remarks *r, uint32_t object)
{
    if (scene_shines(r->scene, object)) return true;
    for (uint32_t i = 0; i < r->scene->n_lights; i++) {
        const SceneLight *light = &r->scene->lights[i];
        if (light->kind == LIGHT_DISTANT || light->kind == LIGHT_PORTAL) continue;
        if (report_is_within(r->compiled, place_of_light(r, light), object, &r->probe.forward)) return true;
    }
    for (uint32_t i = 0; i < r->scene->n_objects; i++)
        if (scene_shines(r->scene, i) && scene_whole(r->scene, i) == i && is_bounded(&r->bounds[i]) &&
            report_is_within(r->compiled, box3_centre(r->bounds[i]), object, &r->probe.forward))
            return true;
    return false;
}

static bool is_behind(const Box3 *box, const Affine *to_plane, double side)
{
    for (int corner = 0; corner < 8; corner++)
        if (!(side * height_of(to_plane, box3_corner(*box, corner)) < 0)) return false;
    return true;
}

static bool is_seen_through(const Scene *scene, const SceneObject *object)
{
    return object->medium != SCENE_NONE || (object->surface != SCENE_NONE && scene->surfaces[object->surface].thin);
}

/* What is behind grounds, by the lines of the text that place it. */
typedef struct Behind {
    ReportLikes likes;
    uint32_t grounds[REPORT_MOST];
    bool below[REPORT_MOST];
} Behind;

static void find_behind(Remarks *r, uint32_t ground, Behind *behind)
{
    const Scene *scene = r->scene;
    Affine to_plane;
    if (!affine_invert(&scene->objects[ground].to_world, &to_plane) || !scene->n_cameras) return;
    double side = height_of(&to_plane, scene->cameras[0].from) > 0 ? 1 : -1;
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        for (int corner = 0; corner < 4; corner++) {
            Vec3 place = scene_camera_place(scene, &scene->cameras[i], corner & 1 ? 1 : -1, corner & 2 ? 1 : -1);
            if (side * height_of(&to_plane, place) <= 0) return;
        }
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        if (!is_bounded(&r->bounds[i]) || !is_behind(&r->bounds[i], &to_plane, side)) continue;
        uint32_t group = report_count_like(&behind->likes, &scene->objects[i], &scene->objects[ground], i);
        if (group == REPORT_MOST || behind->likes.counts[group] > 1) continue;
        behind->grounds[group] = ground;
        behind->below[group] = side > 0;
    }
}

static void remark_behind(Remarks *r, const SceneObject *object, const SceneObject *ground, bool below, uint32_t n)
{
    Diagnostic *report =
        diag_report(r->diag, D_BEHIND_GROUND, object->span, "%s is wholly %s %s, where no camera sees it", object->name,
                    below ? "below" : "above", ground->name);
    if (n > 1)
        diag_note_nowhere(r->diag, report, "and so %s %u more that this line places", n == 2 ? "is" : "are",
                          (unsigned)(n - 1));
    diag_note(r->diag, report, ground->span, "%s is here", ground->name);
}

static void remark_behind_ground(Remarks *r)
{
    Behind behind = {.likes.n = 0};
    const SceneObject *objects = r->scene->objects;
    for (uint32_t i = 0; i < r->scene->n_objects; i++)
        if (report_is_plane(r->scene, i) && !is_seen_through(r->scene, &objects[i])) find_behind(r, i, &behind);
    for (uint32_t i = 0; i < behind.likes.n; i++)
        remark_behind(r, &objects[behind.likes.first[i]], &objects[behind.grounds[i]], behind.below[i],
                      behind.likes.counts[i]);
    report_others(r->diag, D_BEHIND_GROUND, behind.likes.n_others);
}

/* ---- sizes, liquids, cameras, media ---- */

typedef struct Size {
    double size;
    uint32_t object;
} Size;

static int compare_sizes(const void *left, const void *right)
{
    const Size *a = left, *b = right;
    if (a->size != b->size) return a->size < b->size ? -1 : 1;
    return a->object < b->object ? -1 : a->object > b->object;
}

/* Opaque, and of triangles: where such a one is large, rays near it are searched for as far as its corners are coarse. */
static bool may_be_ground(const Remarks *r, uint32_t object)
{
    uint32_t shape = r->scene->objects[object].shape;
    return shape != SCENE_NONE && r->scene->shapes[shape].mesh && r->compiled->hull_of_object[object] == SCENE_NONE;
}

/* A hundred frames of one picture, which take a hundred times as long. */
static void remark_still_animation(Remarks *r)
{
    if (r->scene->animation.n_frames < 2 || !r->scene->is_still) return;
    Diagnostic *report = diag_report_nowhere(r->diag, D_STILL_ANIMATION, "all %u frames of the animation are the same",
                                             (unsigned)r->scene->animation.n_frames);
    diag_hint(r->diag, report, "what moves depends on clock, which goes from 0 to 1: rotate(y, 360 * clock)");
}

/* The one object beyond a step of a factor of a thousand in the sizes of all. Bubbles are small, but there are many. */
static void remark_odd_size(Remarks *r)
{
    const double odd = 1000;
    uint32_t n = 0;
    Size *sizes = malloc((r->scene->n_objects + 1) * sizeof *sizes);
    for (uint32_t i = 0; sizes && i < r->scene->n_objects; i++)
        if (r->scene->objects[i].light == SCENE_NONE && size_of(&r->bounds[i]) > 0)
            sizes[n++] = (Size){size_of(&r->bounds[i]), i};
    if (n > 2) {
        qsort(sizes, n, sizeof *sizes, compare_sizes);
        const Size *ends[2] = {&sizes[0], &sizes[n - 1]};
        const double factors[2] = {sizes[1].size / sizes[0].size, sizes[n - 1].size / sizes[n - 2].size};
        for (int i = 0; i < 2; i++) {
            const SceneObject *object = &r->scene->objects[ends[i]->object];
            if (!(factors[i] >= odd)) continue;
            Diagnostic *report =
                diag_report(r->diag, D_ODD_SIZE, object->span, "%s is %.3g times %s than anything else in the scene",
                            object->name, factors[i], i ? "larger" : "smaller");
            Buf size = {0};
            report_add_length(&size, r->scene, ends[i]->size);
            diag_hint(r->diag, report, "it is %s across; is that its unit?%s", buf_text(&size),
                      i && may_be_ground(r, ends[i]->object) ? " A floor takes less time as a ground, which has no end"
                                                             : "");
            buf_clear(&size);
        }
    }
    free(sizes);
}

static bool lies_within(const Box3 *inner, const Box3 *outer, double slack)
{
    Vec3 by = vec3(slack, slack, slack);
    Box3 wide = {vec3_sub(outer->min, by), vec3_add(outer->max, by)};
    return box3_holds(wide, *inner);
}

/* Glass with a liquid in it, larger than any aquarium: icebergs and seas are not within each other. The largest one. */
static void remark_large_vessel(Remarks *r)
{
    const double large_m = 30;
    const CompiledScene *compiled = r->compiled;
    uint32_t largest = SCENE_NONE;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        uint32_t a = compiled->hull_of_object[pair->a], b = compiled->hull_of_object[pair->b];
        bool first = compiled->hulls[a].state == NEST_SOLID;
        uint32_t vessel = first ? pair->a : pair->b, liquid = first ? pair->b : pair->a;
        const NestHull *held = &compiled->hulls[first ? b : a];
        double size = size_of(&r->bounds[vessel]);
        if (compiled->hulls[first ? a : b].state != NEST_SOLID || held->state != NEST_LIQUID) continue;
        if (!isfinite(held->volume) || !isfinite(size) || size * r->scene->unit_m < large_m) continue;
        if (!lies_within(&r->bounds[liquid], &r->bounds[vessel], 0.02 * size)) continue;
        if (largest == SCENE_NONE || size > size_of(&r->bounds[largest])) largest = vessel;
    }
    if (largest == SCENE_NONE) return;
    const SceneObject *object = &r->scene->objects[largest];
    Buf size = {0};
    report_add_length(&size, r->scene, size_of(&r->bounds[largest]));
    Diagnostic *report = diag_report(r->diag, D_ODD_SIZE, object->span, "%s, which holds a liquid, is %s across",
                                     object->name, buf_text(&size));
    if (r->scene->unit_m == 1)
        diag_hint(r->diag, report,
                  "lengths are metres, as the scene's first line has %s; if millimetres are meant, "
                  "write there: unit mm",
                  r->scene->has_unit ? "'unit m'" : "no unit");
    else
        diag_hint(r->diag, report, "is the unit in the scene's first line the one that is meant?");
    buf_clear(&size);
}

static bool meets_anything(const Remarks *r, uint32_t object)
{
    for (size_t i = 0; i < r->compiled->n_pairs; i++)
        if (r->compiled->pairs[i].a == object || r->compiled->pairs[i].b == object) return true;
    double slack = 0.02 * size_of(&r->bounds[object]);
    for (uint32_t i = 0; i < r->scene->n_objects; i++) {
        if (r->compiled->hull_of_object[i] != SCENE_NONE) continue;
        if (report_is_plane(r->scene, i)) {
            Affine to_plane;
            if (!affine_invert(&r->scene->objects[i].to_world, &to_plane)) continue;
            Box3 near = {vec3_sub(r->bounds[object].min, vec3(slack, slack, slack)),
                         vec3_add(r->bounds[object].max, vec3(slack, slack, slack))};
            if (!is_behind(&near, &to_plane, 1) && !is_behind(&near, &to_plane, -1)) return true;
        } else if (is_bounded(&r->bounds[i]) && boxes_meet(&r->bounds[i], &r->bounds[object], slack)) {
            return true;
        }
    }
    return false;
}

/* Places on a surface, and its normals there. */
typedef struct Patches {
    struct Patch {
        Vec3 place, normal;
    } * items;
    size_t n, capacity;
} Patches;

static void add_patch(Patches *patches, const Line *line, const Hit *hit)
{
    if (!hit || !ARRAY_ROOM(patches->items, patches->capacity, patches->n)) return;
    patches->items[patches->n++] =
        (struct Patch){vec3_along(line->start, hit->t, vec3_from_f(line->direction)), vec3_from_f(hit->normal)};
}

/* Lines meet surfaces by their area, whatever these consist of: where many of them meet one plane, a face is flat. */
static bool has_flat_face(const Patches *patches, double size)
{
    const double least = 0.08, flat = 1e-4, parallel = 1e-6; /* least: of the whole surface */
    enum { LEAST_MET = 6 };
    for (size_t i = 0; i < patches->n; i++) {
        size_t n = 0;
        for (size_t k = 0; k < patches->n; k++) {
            Vec3 normal = patches->items[i].normal;
            n += 1 - vec3_dot(normal, patches->items[k].normal) < parallel &&
                 fabs(vec3_dot(normal, vec3_sub(patches->items[k].place, patches->items[i].place))) < flat * size;
        }
        if (n >= LEAST_MET && (double)n >= least * (double)patches->n) return true;
    }
    return false;
}

/* Liquid is flat where it lies level, and against the walls of what it is in. */
static bool was_held(Remarks *r, uint32_t hull)
{
    enum { LINES = 150 };
    Patches patches = {0};
    for (int direction = 0; direction < LINE_DIRECTIONS; direction++) {
        LineSet set;
        Line line;
        line_set_begin(&set, r->compiled->hull_bounds[hull], direction, LINES / LINE_DIRECTIONS, hull);
        while (probe_next_line(&r->probe, r->compiled, &set, hull, &line))
            for (uint32_t i = r->probe.first[hull]; i != INTERVAL_NONE; i = r->probe.intervals[i].next) {
                add_patch(&patches, &line, r->probe.intervals[i].enter);
                add_patch(&patches, &line, r->probe.intervals[i].leave);
            }
    }
    bool flat = has_flat_face(&patches, size_of(&r->compiled->hull_bounds[hull]));
    free(patches.items);
    return flat;
}

/* A drop may fly, and splashes do, of any shape that is nowhere flat; a body of liquid with a level surface, or that has the
 * form of a vessel, wants something to hold it. A sea has no end. */
static void remark_loose_liquid(Remarks *r)
{
    Tally tally = {.code = D_LOOSE_LIQUID};
    for (uint32_t h = 0; h < r->compiled->n_hulls; h++) {
        const SceneObject *object = report_object(r->compiled, h);
        const NestHull *hull = &r->compiled->hulls[h];
        if (hull->state != NEST_LIQUID || !isfinite(hull->volume) || is_one_of_many(r, h)) continue;
        if (meets_anything(r, r->compiled->object_of_hull[h]) || !was_held(r, h) || !tally_next(&tally)) continue;
        diag_report(r->diag, D_LOOSE_LIQUID, object->span, "%s is a liquid with flat sides, and touches nothing",
                    object->name);
    }
    tally_end(r, &tally);
}

/* Of an orthographic camera: the opaque object that a part of its picture plane is inside of, and how large that part is. */
static uint32_t find_plane_cover(Remarks *r, const SceneCamera *camera, double *part)
{
    uint32_t cover = SCENE_NONE, n = 0;
    for (uint32_t i = 0; i < SCENE_CAMERA_PLACES; i++) {
        uint32_t here = report_cover(r->compiled, scene_camera_some_place(r->scene, camera, i), &r->probe.forward);
        if (here == SCENE_NONE || (cover != SCENE_NONE && here != cover)) continue;
        cover = here;
        n++;
    }
    *part = (double)n / SCENE_CAMERA_PLACES;
    return cover;
}

/* Of cameras from first to before end. */
static void remark_covered_cameras(Remarks *r, uint32_t first, uint32_t end)
{
    for (uint32_t i = first; i < end; i++) {
        const SceneCamera *camera = &r->scene->cameras[i];
        double part = 1;
        bool wide = camera->projection == PROJECTION_ORTHOGRAPHIC && !camera->expect; /* else it is a section */
        uint32_t cover =
            wide ? find_plane_cover(r, camera, &part) : report_cover(r->compiled, camera->from, &r->probe.forward);
        if (cover == SCENE_NONE || (!r->bounds && !find_bounds(r)) || holds_light(r, cover)) continue;
        const SceneObject *object = &r->scene->objects[cover];
        Buf what = {0};
        if (part < 1) buf_format(&what, "about %.2g %% of the picture plane of ", 100 * part);
        Diagnostic *report = diag_report(r->diag, D_CAMERA_INSIDE, camera->span,
                                         "%s%s is inside of %s, which is opaque, and no light is there with it",
                                         buf_text(&what), camera->name, object->name);
        diag_note(r->diag, report, object->span, "%s is here", object->name);
        if (part < 1)
            diag_hint(
                r->diag, report,
                "let 'from' be farther out of it, or the picture less wide; if it is a section, state by 'expect' "
                "what its middle is in");
        else
            diag_hint(r->diag, report, "move the camera out of it, or bring a light in");
        buf_clear(&what);
    }
}

/* By the first camera, which is the one that renders: others may be for films of another shape. */
static void remark_beyond_poles(Remarks *r)
{
    const SceneFilm *film = &r->scene->film;
    const SceneCamera *camera = r->scene->n_cameras ? &r->scene->cameras[0] : NULL;
    if (!camera || camera->projection != PROJECTION_PANORAMA) return;
    const double height = 2 * camera->half_width * film->height / film->width;
    if (height <= 180 * MEN_DEGREE + 2 * camera->half_width / film->width) return; /* by a row of pixels */
    Diagnostic *report = diag_report(
        r->diag, D_BEYOND_POLES, camera->span,
        "%s sees %.4g degrees across, so that this film would be %.4g degrees high, and nothing is beyond 180",
        camera->name, 2 * camera->half_width / MEN_DEGREE, height / MEN_DEGREE);
    diag_hint(r->diag, report, "write: film { size = <%u, %u> }", film->width,
              (unsigned)fmax(1, round(film->width * 90 * MEN_DEGREE / camera->half_width)));
}

/* The media of a list, outermost first. */
static void add_media(const Remarks *r, const NestList *list, Buf *media)
{
    const CompiledScene *compiled = r->compiled;
    uint32_t n = nest_list_count(list), first = compiled_operands_in(compiled, list);
    for (uint32_t k = first; k < n; k++) {
        const NestHull *hull = &compiled->hulls[nest_item(&compiled->order, list, k)];
        buf_format(media, "%s%s", k > first ? ", " : "", r->scene->media[hull->medium].name);
    }
}

static Diagnostic *report_inside(Remarks *r, const SceneCamera *camera, const char *part, const NestList *list)
{
    const SceneObject *object = report_object(r->compiled, nest_owner(&r->compiled->order, list));
    Diagnostic *report = diag_report(r->diag, D_CAMERA_INSIDE, camera->span, "%s%s is inside of %s, in %s", part,
                                     camera->name, object->name, r->scene->media[nest_medium(list)].name);
    diag_note(r->diag, report, object->span, "%s is here", object->name);
    return report;
}

/* The middle of an orthographic camera's picture is in nothing, and some other part of it may be. */
static void remark_picture_plane(Remarks *r, const SceneCamera *camera, NestList *list)
{
    for (uint32_t i = 0; i < SCENE_CAMERA_PLACES; i++) {
        Vec3f place = vec3f_from(scene_camera_some_place(r->scene, camera, i));
        if (compiled_interior(r->compiled, place, 0, &r->probe.forward, list, NULL) != STATUS_OK) return;
        if (nest_medium(list) == NEST_WORLD_MEDIUM) continue;
        diag_hint(
            r->diag, report_inside(r, camera, "a part of the picture plane of ", list),
            "only what is in front of the plane through 'from' is seen: move that back, or say what the middle is in: "
            "expect = [%s]",
            r->scene->media[NEST_WORLD_MEDIUM].name);
        return;
    }
}

static void remark_cameras(Remarks *r)
{
    NestList list;
    nest_list_init(&list);
    for (uint32_t i = 0; i < r->scene->n_cameras; i++) {
        const SceneCamera *camera = &r->scene->cameras[i];
        if (camera->expect ||
            compiled_interior(r->compiled, vec3f_from(camera->from), 0, &r->probe.forward, &list, NULL) != STATUS_OK)
            continue;
        if (nest_medium(&list) == NEST_WORLD_MEDIUM) {
            if (camera->projection == PROJECTION_ORTHOGRAPHIC) remark_picture_plane(r, camera, &list);
            continue;
        }
        Buf expect = {0};
        add_media(r, &list, &expect);
        diag_hint(r->diag, report_inside(r, camera, "", &list), "if that is meant, say so: expect = [%s]",
                  buf_text(&expect));
        buf_clear(&expect);
    }
    nest_list_clear(&list);
}

void report_remarks(const CompiledScene *compiled, Diag *diag)
{
    Remarks r = {.compiled = compiled, .scene = compiled->scene, .diag = diag};
    bool grouped = report_groups_init(&r.groups, compiled);
    bool ready = find_bounds(&r) && probe_init(&r.probe, compiled, NULL) == STATUS_OK && grouped;
    if (ready) {
        remark_close_order(&r);
        report_order_by_volume(compiled, diag);
        remark_near_coincidence(&r);
        report_copies(compiled, r.bounds, diag);
        remark_indifferent(&r);
        remark_mostly_hidden(&r);
        report_enclosed(compiled, diag);
        remark_behind_ground(&r);
        remark_odd_size(&r);
        remark_large_vessel(&r);
        remark_still_animation(&r);
        report_coarse_places(compiled, diag);
        report_contacts(compiled, diag);
        report_buried(compiled, diag);
        report_sunken(compiled, diag);
        report_portals(compiled, diag);
        remark_loose_liquid(&r);
        report_leaks(compiled, diag);
        report_brims(compiled, diag);
        remark_cameras(&r);
        remark_covered_cameras(&r, 0, r.scene->n_cameras);
        remark_beyond_poles(&r);
        for (uint32_t i = 0; i < r.scene->n_cameras; i++) report_empty_view(compiled, i, diag);
        report_many_scatterings(compiled, 60, diag);
        report_mesh_materials(compiled, diag);
    }
    probe_clear(&r.probe);
    report_groups_clear(&r.groups);
    free(r.bounds);
}

void report_covered_camera(const CompiledScene *compiled, uint32_t camera, Diag *diag)
{
    Remarks r = {.compiled = compiled, .scene = compiled->scene, .diag = diag};
    if (probe_init(&r.probe, compiled, NULL) == STATUS_OK) remark_covered_cameras(&r, camera, camera + 1);
    probe_clear(&r.probe);
    free(r.bounds);
}
