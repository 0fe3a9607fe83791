/* compile.c - geometry and order of a scene, and which hulls hold a point.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/compile.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "scene/combinations.h"
#include "scene/lines.h"
#include "scene/relations.h"

/* ---- hulls ---- */

static Status number_hulls(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    size_t n = scene->n_objects ? scene->n_objects : 1;
    compiled->hull_of_object = malloc(n * sizeof *compiled->hull_of_object);
    compiled->object_of_hull = malloc(n * sizeof *compiled->object_of_hull);
    compiled->hulls = malloc(n * sizeof *compiled->hulls);
    compiled->hull_bounds = malloc(n * sizeof *compiled->hull_bounds);
    compiled->found_bounds = malloc(n * sizeof *compiled->found_bounds);
    if (!compiled->hull_of_object || !compiled->object_of_hull || !compiled->hulls || !compiled->hull_bounds ||
        !compiled->found_bounds)
        return fail_memory(error, n * sizeof *compiled->hull_bounds, "the hulls");
    SceneShapeBox known = {0};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        compiled->hull_of_object[i] = SCENE_NONE;
        if (object->medium == SCENE_NONE) continue;
        uint32_t hull = compiled->n_hulls++;
        compiled->hull_of_object[i] = hull;
        compiled->object_of_hull[hull] = i;
        compiled->hulls[hull] = (NestHull){.medium = object->medium,
                                           .priority = object->priority,
                                           .state = scene->media[object->medium].state,
                                           .volume = object->volume,
                                           .mixes = scene->media[object->medium].mixes};
        compiled->hull_bounds[hull] = scene_next_bounds(scene, object, &known);
    }
    return STATUS_OK;
}

/* The scene's combinations, with operands numbered after the hulls. */
static Status number_operands(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    NestCsg *csg = &compiled->csg;
    *csg = (NestCsg){compiled->n_hulls, scene->n_operands, scene->n_trees, scene->n_parts, NULL, NULL, NULL};
    if (!scene->n_trees) return STATUS_OK;
    csg->parts = malloc(scene->n_parts * sizeof *csg->parts);
    csg->trees = malloc(scene->n_trees * sizeof *csg->trees);
    csg->tree_of_operand = malloc((scene->n_operands + 1U) * sizeof *csg->tree_of_operand);
    if (!csg->parts || !csg->trees || !csg->tree_of_operand)
        return fail_memory(error, scene->n_parts * sizeof *csg->parts, "combinations of objects");
    for (uint32_t i = 0; i < scene->n_parts; i++) {
        csg->parts[i] = scene->parts[i];
        csg->parts[i].begin += compiled->n_hulls;
        csg->parts[i].end += compiled->n_hulls;
    }
    for (uint32_t i = 0; i < scene->n_trees; i++) {
        uint32_t hull = compiled->hull_of_object[scene->trees[i].object];
        csg->trees[i] = (NestTree){scene->trees[i].root, hull == SCENE_NONE ? NEST_OPAQUE : hull};
    }
    for (uint32_t i = 0; i < scene->n_operands; i++) {
        uint32_t object = scene->operands[i];
        compiled->hull_of_object[object] = compiled->n_hulls + i;
        csg->tree_of_operand[i] = scene->objects[scene->objects[object].part_of].tree;
    }
    return STATUS_OK;
}

uint32_t compiled_hull(const CompiledScene *compiled, uint32_t object)
{
    uint32_t pass = compiled->hull_of_object[object];
    if (pass == SCENE_NONE || pass < compiled->n_hulls) return pass;
    uint32_t hull = compiled->csg.trees[nest_csg_tree(&compiled->csg, pass)].hull;
    return hull == NEST_OPAQUE ? SCENE_NONE : hull;
}

RtcObject compiled_describe(const CompiledScene *compiled, uint32_t i)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[i];
    RtcObject described = {.to_world = object->to_world,
                           .opaque = compiled->hull_of_object[i] == SCENE_NONE && !scene_is_pane(scene, i)};
    if (object->shape == SCENE_NONE) return described; /* a combination: its operands have the geometry */
    described.hidden = object->light != SCENE_NONE && scene->lights[object->light].hidden;
    described.mesh = scene->shapes[object->shape].mesh;
    described.solid = scene->shapes[object->shape].solid;
    described.mesh_end = scene->shapes[object->shape].mesh_end;
    described.keys = scene_keys(scene, object);
    return described;
}

static RtcObject describe_object(const void *context, uint32_t i)
{
    return compiled_describe(context, i);
}

static Status build_geometry(CompiledScene *compiled, Pool *pool, Error *error)
{
    const Scene *scene = compiled->scene;
    return rtc_scene_new_from(describe_object, compiled, scene->n_objects, scene->n_keys, pool_threads(pool),
                              &compiled->rtc, error);
}

/* Marks what reaches to infinity, and clips its bounds to where bounded things and cameras are. */
static Status find_unbounded(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    size_t n = (size_t)compiled->n_hulls + compiled->csg.n_operands + 1;
    compiled->unbounded = calloc(n, sizeof *compiled->unbounded);
    compiled->planes = malloc((scene->n_objects + 1U) * sizeof *compiled->planes);
    if (!compiled->unbounded || !compiled->planes) return fail_memory(error, n * sizeof *compiled->planes, "the hulls");
    Box3 region = rtc_scene_bounds(compiled->rtc);
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        region = box3_union(region, scene_camera_bounds(scene, &scene->cameras[i]));
    if (box3_is_empty(region)) region = box3_add_point(region, vec3(0, 0, 0));
    double reach = fmax(vec3_length(vec3_sub(region.max, region.min)), 1);
    region = (Box3){vec3_sub(region.min, vec3(reach, reach, reach)), vec3_add(region.max, vec3(reach, reach, reach))};
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        uint32_t pass = compiled->hull_of_object[i];
        if (pass == SCENE_NONE || scene->objects[i].shape == SCENE_NONE || !rtc_is_plane(compiled->rtc, i)) continue;
        compiled->planes[compiled->n_planes++] = i;
        compiled->unbounded[pass] = true;
    }
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        if (!box3_is_unbounded(compiled->hull_bounds[h])) continue;
        compiled->unbounded[h] = true;
        compiled->hulls[h].volume = HUGE_VAL;
        compiled->hull_bounds[h] = box3_intersection(compiled->hull_bounds[h], region);
    }
    return STATUS_OK;
}

/* ---- order ---- */

/* Hulls of one medium merge, whichever is on top, and those that mix are on top of nothing: there is nothing to order. */
static bool needs_order(const CompiledScene *compiled, const HullPair *pair)
{
    if (compiled->hulls[pair->a].mixes || compiled->hulls[pair->b].mixes) return false;
    return pair->overlaps && compiled->hulls[pair->a].medium != compiled->hulls[pair->b].medium;
}

static Status build_order(CompiledScene *compiled, NestPolicy policy, Error *error)
{
    NestOverlap *overlaps = malloc((compiled->n_pairs ? compiled->n_pairs : 1) * sizeof *overlaps);
    if (!overlaps) return fail_memory(error, compiled->n_pairs * sizeof *overlaps, "the order of the hulls");
    size_t n = 0;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (needs_order(compiled, pair)) overlaps[n++] = (NestOverlap){pair->a, pair->b, pair->relation};
    }
    Status status = nest_order_build(&compiled->order, policy, compiled->hulls, compiled->n_hulls, overlaps, n, error);
    free(overlaps);
    return status;
}

static const char *hull_name(const CompiledScene *compiled, uint32_t hull)
{
    return compiled->scene->objects[compiled->object_of_hull[hull]].name;
}

/* A way round a circle: what each hull is on top of, and by which rule. below: SCENE_NONE of hulls that are not on it. */
typedef struct Round {
    uint32_t *below, *queue;
    NestRule *rules;
} Round;

/* The shortest from a hull back to it. Pairs are of hulls still. */
static void find_round(const CompiledScene *compiled, uint32_t first, Round *round)
{
    const uint32_t circle = compiled->order.circle[first];
    uint32_t n = 1;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) round->below[h] = SCENE_NONE;
    round->queue[0] = first;
    for (uint32_t k = 0; k < n && round->below[first] == SCENE_NONE; k++)
        for (size_t i = 0; i < compiled->n_pairs; i++) {
            const HullPair *pair = &compiled->pairs[i];
            const uint32_t at = round->queue[k];
            if ((pair->a != at && pair->b != at) || !needs_order(compiled, pair)) continue;
            NestOverlap overlap = {pair->a, pair->b, pair->relation};
            NestDecision decision = nest_decide(compiled->hulls, &overlap);
            const uint32_t top = decision.top;
            if (top == at || compiled->order.circle[top] != circle || round->below[top] != SCENE_NONE) continue;
            round->below[top] = at;
            round->rules[top] = decision.rule;
            if (top != first) round->queue[n++] = top;
        }
}

/* The answers that run in a circle, as notes under the warning: each is on top of the next, and the last on top of the first. */
static void note_circle(const CompiledScene *compiled, uint32_t first, Diag *diag, Diagnostic *report)
{
    enum { NOTES_MAX = 8 };
    Round round = {.below = ARENA_ARRAY(diag->arena, uint32_t, compiled->n_hulls),
                   .queue = ARENA_ARRAY(diag->arena, uint32_t, compiled->n_hulls),
                   .rules = ARENA_ARRAY(diag->arena, NestRule, compiled->n_hulls)};
    find_round(compiled, first, &round);
    uint32_t top = first;
    for (int n = 0; n < NOTES_MAX && round.below[top] != SCENE_NONE && (n == 0 || top != first); n++) {
        diag_note(diag, report, compiled->scene->objects[compiled->object_of_hull[top]].span,
                  "%s is on top of %s by %s", hull_name(compiled, top), hull_name(compiled, round.below[top]),
                  nest_rule_text(round.rules[top]));
        top = round.below[top];
    }
}

/* Of the hulls on a circle that overlap and are of one medium, the pair whose smaller one is largest; NULL: there is none. Of things in
 * one of both that reach into the other one the rules say that one is on top of them, and the other one is not. */
static const HullPair *find_parts_of_one(const CompiledScene *compiled, uint32_t circle)
{
    const HullPair *found = NULL;
    double largest = 0;
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        const HullPair *pair = &compiled->pairs[i];
        const NestHull *a = &compiled->hulls[pair->a], *b = &compiled->hulls[pair->b];
        if (compiled->order.circle[pair->a] != circle || compiled->order.circle[pair->b] != circle) continue;
        if (a->medium != b->medium || pair->relation != NEST_PARTIAL || !(fmin(a->volume, b->volume) > largest))
            continue;
        largest = fmin(a->volume, b->volume);
        found = pair;
    }
    return found;
}

static void report_circles(const CompiledScene *compiled, Diag *diag)
{
    for (uint32_t circle = 1; circle <= compiled->order.n_circles; circle++) {
        uint32_t first = SCENE_NONE, n = 0;
        for (uint32_t h = 0; h < compiled->n_hulls; h++)
            if (compiled->order.circle[h] == circle) {
                if (first == SCENE_NONE) first = h;
                n++;
            }
        Diagnostic *report =
            diag_report(diag, D_ORDER_CIRCLE, compiled->scene->objects[compiled->object_of_hull[first]].span,
                        "which of %u overlapping objects is on top runs in a circle; among them the "
                        "smaller volume is taken to be on top",
                        (unsigned)n);
        note_circle(compiled, first, diag, report);
        const HullPair *parts = find_parts_of_one(compiled, circle);
        if (parts)
            diag_hint(diag, report,
                      "give one of them a priority; the larger is on top; or, where %s and %s, both %s, are to hold "
                      "together what is "
                      "in them, write: union { interior = ... }, with both of them in it",
                      hull_name(compiled, parts->a), hull_name(compiled, parts->b),
                      compiled->scene->media[compiled->hulls[parts->a].medium].name);
        else
            diag_hint(diag, report, "give one of them a priority; the larger is on top");
    }
}

/* As of the world's medium, see check_world in build.c. */
static void report_endless_light(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        const SceneObject *object = &scene->objects[compiled->object_of_hull[h]];
        if (!compiled->unbounded[h] || object->medium == SCENE_NONE) continue;
        const SceneMedium *medium = &scene->media[object->medium];
        if (!scene_medium_is_endless(medium) || !scene_medium_adds_up(medium)) continue;
        Diagnostic *report = diag_report(diag, D_VALUE_OUT_OF_RANGE, object->span,
                                         "%s has no end, and its medium '%s' shines and lets all light through: it is "
                                         "infinitely bright",
                                         object->name, medium->name);
        diag_hint(diag, report, "let the medium absorb, or take a box of it");
    }
}

static Status compile(CompiledScene *compiled, NestPolicy policy, Pool *pool, Diag *diag, Error *error)
{
    TRY(number_hulls(compiled, error));
    TRY(number_operands(compiled, error));
    TRY(build_geometry(compiled, pool, error));
    TRY(find_unbounded(compiled, error));
    memcpy(compiled->found_bounds, compiled->hull_bounds, compiled->n_hulls * sizeof *compiled->found_bounds);
    if (compiled->csg.n_trees) TRY(combinations_measure(compiled, pool, error));
    if (compiled->csg.n_trees && diag) TRY(combinations_report_empty(compiled, diag, error));
    TRY(relations_find(compiled, pool, &compiled->pairs, &compiled->n_pairs, &compiled->meetings, &compiled->n_meetings,
                       error));
    TRY(build_order(compiled, policy, error));
    if (compiled->csg.n_trees) TRY(nest_order_combine(&compiled->order, &compiled->csg, error));
    if (diag) {
        report_circles(compiled, diag);
        report_endless_light(compiled, diag);
    }
    for (size_t i = 0; i < compiled->n_pairs; i++) { /* hulls are numbered in the order of objects, so a < b still */
        compiled->pairs[i].a = compiled->object_of_hull[compiled->pairs[i].a];
        compiled->pairs[i].b = compiled->object_of_hull[compiled->pairs[i].b];
    }
    return compiled_mark_stops(compiled, error);
}

Status compile_scene(const Scene *scene, NestPolicy policy, Pool *pool, Diag *diag, CompiledScene **out, Error *error)
{
    *out = NULL;
    CompiledScene *compiled = calloc(1, sizeof *compiled);
    if (!compiled) return fail_memory(error, sizeof *compiled, "the compiled scene");
    compiled->scene = scene;
    Status status = compile(compiled, policy, pool, diag, error);
    for (uint32_t i = 0; status == STATUS_OK && diag && i < scene->n_cameras; i++) {
        status = compile_check_camera(compiled, i, diag, error);
        if (status == STATUS_SCENE) status = STATUS_OK; /* it is in diag; the geometry is as good as ever */
    }
    if (status == STATUS_OK && diag) status = compile_check_lights(compiled, diag, error);
    if (status == STATUS_OK)
        *out = compiled;
    else
        compiled_scene_free(compiled);
    memory_give_back();
    return status;
}

void compiled_scene_free(CompiledScene *compiled)
{
    if (!compiled) return;
    rtc_scene_free(compiled->rtc);
    nest_order_clear(&compiled->order);
    free(compiled->hull_of_object);
    free(compiled->passing);
    free(compiled->object_of_hull);
    free(compiled->hulls);
    free(compiled->hull_bounds);
    free(compiled->found_bounds);
    free(compiled->unbounded);
    free(compiled->planes);
    free(compiled->pairs);
    free(compiled->meetings);
    free(compiled->csg.parts);
    free(compiled->csg.trees);
    free(compiled->csg.tree_of_operand);
    free(compiled);
}

/* ---- which hulls hold a point ---- */

static int compare_by_object(const void *left, const void *right)
{
    const Hit *a = left, *b = right;
    if (a->object != b->object) return a->object < b->object ? -1 : 1;
    return a->t < b->t ? -1 : a->t > b->t;
}

static int compare_farthest_first(const void *left, const void *right)
{
    const Hit *a = left, *b = right;
    if (a->t != b->t) return a->t > b->t ? -1 : 1;
    return a->object < b->object ? -1 : a->object > b->object;
}

/* Adds the hulls of the combinations that the operands in the list make up. There must be room. */
static void add_combinations(const CompiledScene *compiled, NestList *list)
{
    const NestCsg *csg = &compiled->csg;
    for (uint32_t i = 0; i < list->n && nest_list_items(list)[i] >= compiled->n_hulls; i++) {
        uint32_t tree = nest_csg_tree(csg, nest_list_items(list)[i]), hull = csg->trees[tree].hull;
        if (hull != NEST_OPAQUE && !nest_list_has(list, hull) && nest_csg_holds(csg, tree, list))
            nest_list_insert(list, list->n, hull);
    }
}

/* Puts a hull on top of the list, or an operand in its place. There must be room. */
static void add_inside(const CompiledScene *compiled, NestList *list, uint32_t object)
{
    uint32_t pass = compiled->hull_of_object[object];
    if (pass < compiled->n_hulls)
        nest_list_insert(list, list->n, pass);
    else
        nest_csg_pass(&compiled->csg, list, pass, true);
}

/* The hulls that hold the point, seen along one direction from the point outward: those that are left more often than
 * they are entered, and halves of space that it is in. They come in the order in which a ray from outside enters them:
 * the one that is left last first. */
static Status interior_along(const CompiledScene *compiled, Vec3 point, double time, int direction, HitList *hits,
                             NestList *list)
{
    Ray ray = ray_make(point, vec3f_from(line_direction(direction)));
    ray.time = time;
    rtc_all(compiled->rtc, &ray, false, hits);
    if (hits->out_of_memory) return STATUS_NOMEM;
    size_t n = 0, n_inside = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (compiled->hull_of_object[hits->items[i].object] != SCENE_NONE && !hit_repeats(hits, i) &&
            !rtc_is_plane(compiled->rtc, hits->items[i].object))
            hits->items[n++] = hits->items[i];
    hits->n = n;
    if (n > 1) qsort(hits->items, n, sizeof *hits->items, compare_by_object);
    for (size_t i = 0; i < n;) {
        size_t first = i;
        int net = 0;
        for (; i < n && hits->items[i].object == hits->items[first].object; i++)
            net += hits->items[i].entering ? -1 : 1;
        for (size_t k = first; net > 0 && k < i; k++) {
            if (hits->items[k].entering) continue;
            hits->items[n_inside++] = hits->items[k];
            break;
        }
    }
    if (n_inside > 1) qsort(hits->items, n_inside, sizeof *hits->items, compare_farthest_first);
    nest_list_empty(list);
    TRY(nest_list_reserve(list, 2 * ((uint32_t)n_inside + compiled->n_planes)));
    for (uint32_t i = 0; i < compiled->n_planes; i++)
        if (rtc_below_plane(compiled->rtc, compiled->planes[i], point, time))
            add_inside(compiled, list, compiled->planes[i]);
    for (size_t i = 0; i < n_inside; i++) add_inside(compiled, list, hits->items[i].object);
    add_combinations(compiled, list);
    return STATUS_OK;
}

static bool same_set(const NestList *a, const NestList *b)
{
    if (a->n != b->n) return false;
    for (uint32_t i = 0; i < a->n; i++)
        if (!nest_list_has(b, nest_list_items(a)[i])) return false;
    return true;
}

/* Members of at least two of three lists, in the order of the first that has them; operands first. */
static Status majority(const CompiledScene *compiled, const NestList *lists, NestList *out)
{
    nest_list_empty(out);
    for (int i = 0; i < 2; i++)
        for (uint32_t k = 0; k < lists[i].n; k++) {
            uint32_t hull = nest_list_items(&lists[i])[k];
            if (nest_list_has(out, hull)) continue;
            bool elsewhere = nest_list_has(&lists[2], hull) || nest_list_has(&lists[1 - i], hull);
            if (!elsewhere) continue;
            TRY(nest_list_reserve(out, 1));
            if (hull < compiled->n_hulls)
                nest_list_insert(out, out->n, hull);
            else
                nest_csg_pass(&compiled->csg, out, hull, true);
        }
    return STATUS_OK;
}

/* Moves the hulls that mix in front of the others, from `first` on; returns where the others begin. */
static uint32_t sink_mixing(const NestOrder *order, uint32_t *items, uint32_t first, uint32_t n)
{
    for (uint32_t i = first; order->n_mixing && i < n; i++) {
        uint32_t hull = items[i], k = i;
        if (!nest_mixes(order, hull)) continue;
        for (; k > first; k--) items[k] = items[k - 1];
        items[first++] = hull;
    }
    return first;
}

/* Puts the owner last. Under NEST_ENTERED the order of entry stands; without nesting only the innermost counts.
 * Operands of combinations stay first, and hulls that mix stand behind them. */
static void sort_list(const CompiledScene *compiled, NestList *list)
{
    const NestOrder *order = &compiled->order;
    uint32_t *items = nest_list_hulls(list), first = 0;
    while (first < list->n && items[first] >= compiled->n_hulls) first++;
    first = sink_mixing(order, items, first, list->n);
    if (order->policy == NEST_ENTERED) return;
    if (order->policy == NEST_NONE) {
        uint32_t innermost = first;
        for (uint32_t i = first + 1; i < list->n; i++)
            if (compiled->hulls[items[i]].volume < compiled->hulls[items[innermost]].volume) innermost = i;
        if (first < list->n) {
            items[first] = items[innermost];
            list->n = first + 1;
        }
        return;
    }
    for (uint32_t i = first + 1; i < list->n; i++) {
        uint32_t hull = items[i], k = i;
        for (; k > first && order->rank[items[k - 1]] > order->rank[hull]; k--) items[k] = items[k - 1];
        items[k] = hull;
    }
}

/* By object, then by normal, so that it does not matter in which order surfaces are found. */
static bool comes_before(const RtcSurface *a, const RtcSurface *b)
{
    if (a->object != b->object) return a->object < b->object;
    if (a->normal.x != b->normal.x) return a->normal.x < b->normal.x;
    return a->normal.y != b->normal.y ? a->normal.y < b->normal.y : a->normal.z < b->normal.z;
}

static void add_surface(void *context, const RtcSurface *surface)
{
    SurfacesHere *here = context;
    for (uint32_t i = 0; i < here->n; i++) {
        RtcSurface *known = &here->items[i];
        if (known->object != surface->object || fabsf(vec3f_dot(known->normal, surface->normal)) <= 0.9999f) continue;
        if (surface->distance < known->distance) *known = *surface;
        return;
    }
    here->too_many = here->too_many || here->n == COUNT_OF(here->items);
    uint32_t place = here->n;
    if (here->n < COUNT_OF(here->items)) here->n++;
    for (; place > 0 && comes_before(surface, &here->items[place - 1]); place--)
        if (place < COUNT_OF(here->items)) here->items[place] = here->items[place - 1];
    if (place < COUNT_OF(here->items)) here->items[place] = *surface;
}

void compiled_surfaces_at(const CompiledScene *compiled, Vec3 point, double time, SurfacesHere *here)
{
    *here = (SurfacesHere){0};
    rtc_surfaces_at(compiled->rtc, point, time, add_surface, here);
}

Status compiled_interior(const CompiledScene *compiled, Vec3f point, double time, HitList *hits, NestList *list,
                         uint32_t *on_surface)
{
    NestList lists[3];
    Vec3 at = vec3_from_f(point);
    for (int i = 0; i < 3; i++) nest_list_init(&lists[i]);
    Status status = interior_along(compiled, at, time, 0, hits, &lists[0]);
    if (status == STATUS_OK) status = interior_along(compiled, at, time, 1, hits, &lists[1]);
    if (status == STATUS_OK && same_set(&lists[0], &lists[1])) {
        status = nest_list_copy(list, &lists[0]);
    } else if (status == STATUS_OK) {
        status = interior_along(compiled, at, time, 2, hits, &lists[2]);
        if (status == STATUS_OK) status = majority(compiled, lists, list);
    }
    for (int i = 0; i < 3; i++) nest_list_clear(&lists[i]);
    if (status != STATUS_OK) return status;
    sort_list(compiled, list);
    nest_order_settle(&compiled->order, list);
    if (on_surface) {
        SurfacesHere here;
        compiled_surfaces_at(compiled, at, time, &here);
        *on_surface = here.n ? here.items[0].object : SCENE_NONE;
    }
    return hits->out_of_memory ? STATUS_NOMEM : STATUS_OK;
}

uint32_t compiled_operands_in(const CompiledScene *compiled, const NestList *list)
{
    uint32_t n = nest_list_count(list), n_operands = 0;
    if (!compiled->order.csg) return 0;
    while (n_operands < n && nest_item(&compiled->order, list, n_operands) >= compiled->n_hulls) n_operands++;
    return n_operands;
}
