/* compile.c - geometry and order of a scene, and which hulls hold a point.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/compile.h"

#include <stdlib.h>
#include <string.h>

#include "scene/lines.h"
#include "scene/relations.h"

/* ---- hulls ---- */

static Box3 bounds_of(const SceneShape *shape, const Affine *map)
{
    Box3 box = box3_empty();
    if (shape->mesh) {
        for (uint32_t i = 0; i < shape->mesh->n_vertices; i++)
            box = box3_add_point(box, affine_point(map, vec3_from_f(shape->mesh->positions[i])));
        return box;
    }
    for (uint32_t i = 0; i < shape->solid->n_pieces; i++) {
        const Piece *piece = &shape->solid->pieces[i];
        if (piece->kind == PIECE_SPHERE) { /* tighter than the box around its box */
            double half[3];
            for (int row = 0; row < 3; row++)
                half[row] = piece->r0 * vec3_length(vec3(map->m[row][0], map->m[row][1], map->m[row][2]));
            Vec3 reach = vec3(half[0], half[1], half[2]);
            box = box3_union(box, (Box3){vec3_sub(map->t, reach), vec3_add(map->t, reach)});
        } else {
            box = box3_union(box, affine_box(map, piece_bounds(piece)));
        }
    }
    return box;
}

static Status number_hulls(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    size_t n = scene->n_objects ? scene->n_objects : 1;
    compiled->hull_of_object = malloc(n * sizeof *compiled->hull_of_object);
    compiled->object_of_hull = malloc(n * sizeof *compiled->object_of_hull);
    compiled->hulls = malloc(n * sizeof *compiled->hulls);
    compiled->hull_bounds = malloc(n * sizeof *compiled->hull_bounds);
    if (!compiled->hull_of_object || !compiled->object_of_hull || !compiled->hulls || !compiled->hull_bounds)
        return fail_memory(error, n * sizeof *compiled->hull_bounds, "the hulls");
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
                                           .volume = object->volume};
        compiled->hull_bounds[hull] = bounds_of(&scene->shapes[object->shape], &object->to_world);
    }
    return STATUS_OK;
}

static Status build_geometry(CompiledScene *compiled, Pool *pool, Error *error)
{
    const Scene *scene = compiled->scene;
    RtcObject *objects = malloc((scene->n_objects ? scene->n_objects : 1) * sizeof *objects);
    if (!objects) return fail_memory(error, scene->n_objects * sizeof *objects, "the geometry");
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        const SceneShape *shape = &scene->shapes[object->shape];
        objects[i] = (RtcObject){.mesh = shape->mesh,
                                 .solid = shape->solid,
                                 .to_world = object->to_world,
                                 .opaque = object->medium == SCENE_NONE};
    }
    Status status = rtc_scene_new(objects, scene->n_objects, pool ? pool_threads(pool) : 1, &compiled->rtc, error);
    free(objects);
    return status;
}

/* ---- order ---- */

/* Hulls of one medium merge, whichever is on top: between them there is nothing to order. */
static bool needs_order(const CompiledScene *compiled, const HullPair *pair)
{
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
    Status status =
        nest_order_build(&compiled->order, policy, 0, compiled->hulls, compiled->n_hulls, overlaps, n, error);
    free(overlaps);
    return status;
}

static const char *hull_name(const CompiledScene *compiled, uint32_t hull)
{
    return compiled->scene->objects[compiled->object_of_hull[hull]].name;
}

/* The answers that run in a circle, as notes under the warning. pairs are of hulls still. */
static void note_circle(const CompiledScene *compiled, uint32_t circle, Diag *diag, Diagnostic *report)
{
    enum { NOTES_MAX = 6 };
    int n = 0;
    for (size_t i = 0; i < compiled->n_pairs && n < NOTES_MAX; i++) {
        const HullPair *pair = &compiled->pairs[i];
        if (!needs_order(compiled, pair)) continue;
        if (compiled->order.circle[pair->a] != circle || compiled->order.circle[pair->b] != circle) continue;
        NestOverlap overlap = {pair->a, pair->b, pair->relation};
        NestDecision decision = nest_decide(compiled->hulls, &overlap);
        diag_note(diag, report, compiled->scene->objects[compiled->object_of_hull[decision.top]].span,
                  "%s is on top of %s by %s", hull_name(compiled, decision.top), hull_name(compiled, decision.bottom),
                  nest_rule_text(decision.rule));
        n++;
    }
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
        note_circle(compiled, circle, diag, report);
        diag_hint(diag, report, "give one of them a priority; the larger is on top");
    }
}

static Status compile(CompiledScene *compiled, NestPolicy policy, Pool *pool, Diag *diag, Error *error)
{
    TRY(number_hulls(compiled, error));
    TRY(build_geometry(compiled, pool, error));
    TRY(relations_find(compiled, pool, &compiled->pairs, &compiled->n_pairs, error));
    TRY(build_order(compiled, policy, error));
    if (diag) report_circles(compiled, diag);
    for (size_t i = 0; i < compiled->n_pairs; i++) { /* hulls are numbered in the order of objects, so a < b still */
        compiled->pairs[i].a = compiled->object_of_hull[compiled->pairs[i].a];
        compiled->pairs[i].b = compiled->object_of_hull[compiled->pairs[i].b];
    }
    return STATUS_OK;
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
    if (status == STATUS_OK)
        *out = compiled;
    else
        compiled_scene_free(compiled);
    return status;
}

void compiled_scene_free(CompiledScene *compiled)
{
    if (!compiled) return;
    rtc_scene_free(compiled->rtc);
    nest_order_clear(&compiled->order);
    free(compiled->hull_of_object);
    free(compiled->object_of_hull);
    free(compiled->hulls);
    free(compiled->hull_bounds);
    free(compiled->pairs);
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

/* The hulls that hold the point, seen along one direction from the point outward: those that are left more often than
 * they are entered. They come in the order in which a ray from outside enters them: the one that is left last first. */
static Status interior_along(const CompiledScene *compiled, Vec3 point, int direction, HitList *hits, NestList *list)
{
    Ray ray = ray_make(point, vec3f_from(line_direction(direction)));
    rtc_all(compiled->rtc, &ray, false, hits);
    if (hits->out_of_memory) return STATUS_NOMEM;
    size_t n = 0, n_inside = 0;
    for (size_t i = 0; i < hits->n; i++)
        if (compiled->hull_of_object[hits->items[i].object] != SCENE_NONE && !hit_repeats(hits, i))
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
    list->n = 0;
    TRY(nest_list_reserve(list, (uint32_t)n_inside));
    for (size_t i = 0; i < n_inside; i++)
        nest_list_insert(list, list->n, compiled->hull_of_object[hits->items[i].object]);
    return STATUS_OK;
}

static bool same_set(const NestList *a, const NestList *b)
{
    if (a->n != b->n) return false;
    for (uint32_t i = 0; i < a->n; i++)
        if (!nest_list_has(b, nest_list_items(a)[i])) return false;
    return true;
}

/* Members of at least two of three lists, in the order of the first that has them. */
static Status majority(const NestList *lists, NestList *out)
{
    out->n = 0;
    for (int i = 0; i < 2; i++)
        for (uint32_t k = 0; k < lists[i].n; k++) {
            uint32_t hull = nest_list_items(&lists[i])[k];
            if (nest_list_has(out, hull)) continue;
            bool elsewhere = nest_list_has(&lists[2], hull) || nest_list_has(&lists[1 - i], hull);
            if (!elsewhere) continue;
            TRY(nest_list_reserve(out, 1));
            nest_list_insert(out, out->n, hull);
        }
    return STATUS_OK;
}

/* Puts the owner last. Under NEST_ENTERED the order of entry stands; without nesting only the innermost counts. */
static void sort_list(const CompiledScene *compiled, NestList *list)
{
    const NestOrder *order = &compiled->order;
    uint32_t *items = nest_list_hulls(list);
    if (order->policy == NEST_ENTERED) return;
    if (order->policy == NEST_NONE) {
        uint32_t innermost = 0;
        for (uint32_t i = 1; i < list->n; i++)
            if (compiled->hulls[items[i]].volume < compiled->hulls[items[innermost]].volume) innermost = i;
        if (list->n) items[0] = items[innermost];
        list->n = list->n > 0;
        return;
    }
    for (uint32_t i = 1; i < list->n; i++) {
        uint32_t hull = items[i], k = i;
        for (; k > 0 && order->rank[items[k - 1]] > order->rank[hull]; k--) items[k] = items[k - 1];
        items[k] = hull;
    }
}

/* The object whose surface is at the point. Of three directions at right angles at least one is within 55 degrees of
 * the normal, so that a surface within the rounding along the normal shows within twice the rounding along it. */
static uint32_t surface_at(const CompiledScene *compiled, Vec3 point, HitList *hits)
{
    double rounding = rtc_rounding(point);
    for (int i = 0; i < LINE_DIRECTIONS; i++) {
        Vec3f direction = vec3f_from(line_direction(i));
        Ray ray = ray_make(vec3_along(point, -2 * rounding, vec3_from_f(direction)), direction);
        ray.t_max = 4 * rounding;
        rtc_all(compiled->rtc, &ray, false, hits);
        for (size_t k = 0; k < hits->n; k++) {
            const Hit *hit = &hits->items[k];
            Vec3 from_point = vec3_sub(ray_point(&ray, hit->t), point);
            if (fabs(vec3_dot(from_point, vec3_from_f(hit->normal))) <= rounding) return hit->object;
        }
    }
    return SCENE_NONE;
}

Status compiled_interior(const CompiledScene *compiled, Vec3f point, HitList *hits, NestList *list,
                         uint32_t *on_surface)
{
    NestList lists[3];
    Vec3 at = vec3_from_f(point);
    for (int i = 0; i < 3; i++) nest_list_init(&lists[i]);
    Status status = interior_along(compiled, at, 0, hits, &lists[0]);
    if (status == STATUS_OK) status = interior_along(compiled, at, 1, hits, &lists[1]);
    if (status == STATUS_OK && same_set(&lists[0], &lists[1])) {
        status = nest_list_copy(list, &lists[0]);
    } else if (status == STATUS_OK) {
        status = interior_along(compiled, at, 2, hits, &lists[2]);
        if (status == STATUS_OK) status = majority(lists, list);
    }
    for (int i = 0; i < 3; i++) nest_list_clear(&lists[i]);
    if (status != STATUS_OK) return status;
    sort_list(compiled, list);
    if (on_surface) *on_surface = surface_at(compiled, at, hits);
    return hits->out_of_memory ? STATUS_NOMEM : STATUS_OK;
}

/* ---- cameras ---- */

static void add_medium(Buf *buf, const CompiledScene *compiled, uint32_t medium)
{
    buf_format(buf, "%s%s", buf->length ? ", " : "", compiled->scene->media[medium].name);
}

/* The media from the outside in, the world's own left out: a camera in the air may expect [air] or []. */
static bool meets_expectation(const CompiledScene *compiled, const SceneCamera *camera, const NestList *list)
{
    const uint32_t *expect = camera->expect, *hulls = nest_list_items(list);
    uint32_t n = camera->n_expect;
    if (n && expect[0] == 0 && (list->n == 0 || compiled->hulls[hulls[0]].medium != 0)) {
        expect++;
        n--;
    }
    if (n != list->n) return false;
    for (uint32_t i = 0; i < n; i++)
        if (expect[i] != compiled->hulls[hulls[i]].medium) return false;
    return true;
}

static Status report_expectation(const CompiledScene *compiled, const SceneCamera *camera, const NestList *list,
                                 Diag *diag, Error *error)
{
    Buf is = {0}, expected = {0};
    for (uint32_t i = 0; i < list->n; i++) add_medium(&is, compiled, compiled->hulls[nest_list_items(list)[i]].medium);
    for (uint32_t i = 0; i < camera->n_expect; i++) add_medium(&expected, compiled, camera->expect[i]);
    if (!list->n) buf_format(&is, "only the world's %s", compiled->scene->media[0].name);
    if (is.failed || expected.failed) {
        buf_clear(&is);
        buf_clear(&expected);
        return fail_memory(error, 0, "a message");
    }
    Diagnostic *report = diag_report(diag, D_CAMERA_EXPECTATION, camera->expect_span, "%s is in %s, not in [%s]",
                                     camera->name, buf_text(&is), buf_text(&expected));
    for (uint32_t i = 0; i < list->n; i++) {
        const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[nest_list_items(list)[i]]];
        diag_note(diag, report, object->span, "it is inside of %s", object->name);
    }
    buf_clear(&is);
    buf_clear(&expected);
    return STATUS_SCENE;
}

Status compile_check_camera(const CompiledScene *compiled, uint32_t camera_number, Diag *diag, Error *error)
{
    const SceneCamera *camera = &compiled->scene->cameras[camera_number];
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    uint32_t on_surface;
    Status status = compiled_interior(compiled, vec3f_from(camera->from), &hits, &list, &on_surface);
    if (status != STATUS_OK) {
        status = fail(error, status, "out of memory while looking where the camera is");
    } else if (on_surface != SCENE_NONE) {
        const SceneObject *object = &compiled->scene->objects[on_surface];
        Diagnostic *report = diag_report(diag, D_CAMERA_ON_SURFACE, camera->span, "%s is exactly on the surface of %s",
                                         camera->name, object->name);
        diag_note(diag, report, object->span, "%s is here", object->name);
        diag_hint(diag, report, "move it by a little, to the side that it is meant to be on");
        status = STATUS_SCENE;
    } else if (camera->expect && !meets_expectation(compiled, camera, &list)) {
        status = report_expectation(compiled, camera, &list, diag, error);
    }
    nest_list_clear(&list);
    hit_list_clear(&hits);
    return status;
}
