/* compile_camera.c - cameras: where their rays start, which must be on no surface, and in which media.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/compile.h"

#include <math.h>

/* ---- on the surface of an operand ---- */

/* The operands in the list, without those whose surfaces are here: of them it tells nothing. */
static Status sure_operands(const CompiledScene *compiled, const NestList *list, const SurfacesHere *here,
                            NestList *operands)
{
    uint32_t n = compiled_operands_in(compiled, list);
    nest_list_empty(operands);
    TRY(nest_list_reserve(operands, n + here->n));
    for (uint32_t i = 0; i < n; i++)
        nest_csg_pass(&compiled->csg, operands, nest_item(&compiled->order, list, i), true);
    for (uint32_t k = 0; k < here->n; k++)
        nest_csg_pass(&compiled->csg, operands, compiled->hull_of_object[here->items[k].object], false);
    return STATUS_OK;
}

/* Whether the combination holds the point when it is inside of those surfaces' operands that are set in `sides`. */
static bool holds_at(const CompiledScene *compiled, uint32_t tree, const SurfacesHere *here, uint32_t sides,
                     NestList *operands)
{
    const NestCsg *csg = &compiled->csg;
    for (uint32_t i = 0; i < here->n; i++)
        if (sides >> i & 1) nest_csg_pass(csg, operands, compiled->hull_of_object[here->items[i].object], true);
    bool holds = nest_csg_holds(csg, tree, operands);
    for (uint32_t i = 0; i < here->n; i++)
        nest_csg_pass(csg, operands, compiled->hull_of_object[here->items[i].object], false);
    return holds;
}

/* All around the point the combinations have the same value, whichever of the operands hold it there. */
Status compiled_are_no_surfaces(const CompiledScene *compiled, const NestList *list, const SurfacesHere *here,
                                bool *result)
{
    *result = !here->too_many;
    for (uint32_t i = 0; i < here->n; i++) {
        uint32_t operand = compiled->hull_of_object[here->items[i].object];
        *result &= operand != SCENE_NONE && operand >= compiled->n_hulls;
    }
    if (!*result) return STATUS_OK;
    NestList operands;
    nest_list_init(&operands);
    Status status = sure_operands(compiled, list, here, &operands);
    for (uint32_t i = 0; status == STATUS_OK && i < here->n; i++) {
        uint32_t tree = nest_csg_tree(&compiled->csg, compiled->hull_of_object[here->items[i].object]);
        bool holds = holds_at(compiled, tree, here, 0, &operands);
        for (uint32_t sides = 1; sides < 1u << here->n; sides++)
            *result &= holds_at(compiled, tree, here, sides, &operands) == holds;
    }
    nest_list_clear(&operands);
    return status;
}

/* A place off those surfaces, to one side or the other of each, and on no other; false when none was found. */
static bool step_off(const CompiledScene *compiled, const SurfacesHere *here, Vec3 *point)
{
    enum { ROUNDINGS = 4 };
    for (uint32_t sides = 0; sides < 1u << here->n; sides++) {
        SurfacesHere there;
        Vec3 place = *point;
        for (uint32_t i = 0; i < here->n; i++)
            place = vec3_along(place, (sides >> i & 1 ? -ROUNDINGS : ROUNDINGS) * rtc_rounding(*point),
                               vec3_from_f(here->items[i].normal));
        place = vec3_rounded(place); /* whose hulls are found for float */
        compiled_surfaces_at(compiled, place, 0, &there);
        if (there.n) continue;
        *point = place;
        return true;
    }
    return false;
}

/* ---- on a surface that it flies through ---- */

/* In an animation a camera may come to any surface, and in one of its frames be right there. */
static bool may_fly(const CompiledScene *compiled, const SceneCamera *camera)
{
    return compiled->scene->animation.n_frames > 1 && camera->projection != PROJECTION_ORTHOGRAPHIC;
}

/* A place just beyond those surfaces, the way that it looks, and on no other; false when that is none. */
static bool step_ahead(const CompiledScene *compiled, const SurfacesHere *here, Vec3 forward, Vec3 *point)
{
    enum { ROUNDINGS = 4 };
    Vec3 place = *point;
    for (uint32_t i = 0; i < here->n; i++) {
        Vec3 normal = vec3_from_f(here->items[i].normal);
        place = vec3_along(place, copysign(ROUNDINGS * rtc_rounding(*point), vec3_dot(normal, forward)), normal);
    }
    SurfacesHere there;
    place = vec3_rounded(place);
    compiled_surfaces_at(compiled, place, 0, &there);
    if (there.n) return false;
    *point = place;
    return true;
}

static Status stand(const CompiledScene *compiled, SceneCamera *camera, HitList *hits, NestList *list,
                    uint32_t *on_surface)
{
    TRY(compiled_interior(compiled, vec3f_from(camera->from), 0, hits, list, on_surface));
    if (*on_surface == SCENE_NONE || camera->keys) return STATUS_OK;
    SurfacesHere here;
    bool none;
    compiled_surfaces_at(compiled, vec3_rounded(camera->from), 0, &here);
    TRY(compiled_are_no_surfaces(compiled, list, &here, &none));
    bool off = none ? step_off(compiled, &here, &camera->from)
                    : may_fly(compiled, camera) && !here.too_many &&
                          step_ahead(compiled, &here, camera->forward, &camera->from);
    if (!off) return STATUS_OK;
    return compiled_interior(compiled, vec3f_from(camera->from), 0, hits, list, on_surface);
}

Status compiled_stand(const CompiledScene *compiled, SceneCamera *camera, NestList *list, uint32_t *on_surface,
                      Error *error)
{
    HitList hits = {0};
    uint32_t surface;
    Status status = stand(compiled, camera, &hits, list, on_surface ? on_surface : &surface);
    if (status != STATUS_OK)
        status = fail_memory(error, hits.capacity * sizeof *hits.items, "the camera's surroundings");
    hit_list_clear(&hits);
    return status;
}

/* ---- on a surface in the picture plane ---- */

/* Of an object that lies in the plane that an orthographic camera's rays start in, over more than a little of its picture, the
 * surface; false: there is none. What cuts through the plane parts the rays, and each of them is on one side. */
static bool surface_in_plane(const CompiledScene *compiled, const SceneCamera *camera, RtcSurface *surface)
{
    for (uint32_t i = 0; i < SCENE_CAMERA_PLACES; i++) {
        SurfacesHere here;
        compiled_surfaces_at(compiled, vec3_rounded(scene_camera_some_place(compiled->scene, camera, i)), 0, &here);
        for (uint32_t k = 0; k < here.n; k++) {
            if (fabs(vec3_dot(vec3_from_f(here.items[k].normal), camera->forward)) <= 1 - 1e-6) continue;
            *surface = here.items[k];
            return true;
        }
    }
    return false;
}

/* ---- reports ---- */

static void add_medium(Buf *buf, const CompiledScene *compiled, uint32_t medium)
{
    buf_format(buf, "%s%s", buf->length ? ", " : "", compiled->scene->media[medium].name);
}

/* Whichever way its axis lies, it is that crystal. */
static bool is_of(const Scene *scene, uint32_t medium, uint32_t expected)
{
    return medium == expected || scene->media[medium].turned_from == expected;
}

/* The media from the outside in, the world's own left out: a camera in the air may expect [air] or []. */
static bool meets_expectation(const CompiledScene *compiled, const SceneCamera *camera, const NestList *list)
{
    const NestOrder *order = &compiled->order;
    uint32_t n = camera->n_expect, first = compiled_operands_in(compiled, list),
             n_hulls = nest_list_count(list) - first;
    const uint32_t *expect = camera->expect;
    if (n && expect[0] == 0 && (n_hulls == 0 || compiled->hulls[nest_item(order, list, first)].medium != 0)) {
        expect++;
        n--;
    }
    if (n != n_hulls) return false;
    for (uint32_t i = 0; i < n; i++)
        if (!is_of(compiled->scene, compiled->hulls[nest_item(order, list, first + i)].medium, expect[i])) return false;
    return true;
}

static Status report_expectation(const CompiledScene *compiled, const SceneCamera *camera, const NestList *list,
                                 Diag *diag, Error *error)
{
    Buf is = {0}, expected = {0};
    const NestOrder *order = &compiled->order;
    uint32_t n = nest_list_count(list), first = compiled_operands_in(compiled, list);
    for (uint32_t i = first; i < n; i++) add_medium(&is, compiled, compiled->hulls[nest_item(order, list, i)].medium);
    for (uint32_t i = 0; i < camera->n_expect; i++) add_medium(&expected, compiled, camera->expect[i]);
    if (first == n) buf_format(&is, "only the world's %s", compiled->scene->media[0].name);
    if (is.failed || expected.failed) {
        buf_clear(&is);
        buf_clear(&expected);
        return fail_memory(error, 0, "a message");
    }
    Diagnostic *report = diag_report(diag, D_CAMERA_EXPECTATION, camera->expect_span, "%s is in %s, not in [%s]",
                                     camera->name, buf_text(&is), buf_text(&expected));
    for (uint32_t i = first; i < n; i++) {
        uint32_t hull = nest_item(order, list, i);
        const SceneObject *object = &compiled->scene->objects[compiled->object_of_hull[hull]];
        diag_note(diag, report, object->span, "it is inside of %s", object->name);
    }
    buf_clear(&is);
    buf_clear(&expected);
    return STATUS_SCENE;
}

void compiled_advise_off_surface(const CompiledScene *compiled, const RtcSurface *surface, Diagnostic *report,
                                 Diag *diag)
{
    const SceneObject *object = &compiled->scene->objects[surface->object];
    diag_note(diag, report, object->span, "%s is here", object->name);
    if (surface->rounding > 0)
        diag_hint(diag, report, "move it by %.1g or more, to the side that it is meant to be on",
                  2 * surface->rounding);
    else
        diag_hint(diag, report, "move it by a little, to the side that it is meant to be on");
}

static void report_on_surface(const CompiledScene *compiled, const SceneCamera *camera, bool plane,
                              const RtcSurface *surface, Diag *diag)
{
    const SceneObject *object = &compiled->scene->objects[surface->object];
    const char *of = plane ? "the picture plane of " : "";
    Diagnostic *report =
        surface->distance > 0
            ? diag_report(diag, D_CAMERA_ON_SURFACE, camera->span,
                          "%s%s is %.1g from the surface of %s, and places there are told apart by %.1g", of,
                          camera->name, surface->distance, object->name, surface->rounding)
            : diag_report(diag, D_CAMERA_ON_SURFACE, camera->span, "%s%s is exactly on the surface of %s", of,
                          camera->name, object->name);
    compiled_advise_off_surface(compiled, surface, report, diag);
}

/* Warns of a camera that was on a surface, and has been moved beyond it. STATUS_NOMEM. */
static Status report_step(const CompiledScene *compiled, const SceneCamera *camera, const NestList *list, Diag *diag,
                          Error *error)
{
    SurfacesHere here;
    bool none;
    compiled_surfaces_at(compiled, vec3_rounded(camera->from), 0, &here);
    if (compiled_are_no_surfaces(compiled, list, &here, &none) != STATUS_OK)
        return fail_memory(error, 0, "the camera's surroundings");
    if (none || !here.n) return STATUS_OK;
    const SceneObject *object = &compiled->scene->objects[here.items[0].object];
    Diagnostic *report =
        diag_report(diag, D_CAMERA_STEPPED, camera->span,
                    "in frame %u %s is on the surface of %s: it is taken to be just beyond it, the way "
                    "that it looks",
                    (unsigned)compiled->scene->frame, camera->name, object->name);
    diag_note(diag, report, object->span, "%s is here", object->name);
    return STATUS_OK;
}

Status compile_check_camera(const CompiledScene *compiled, uint32_t camera_number, Diag *diag, Error *error)
{
    const SceneCamera *camera = &compiled->scene->cameras[camera_number];
    SceneCamera standing = *camera;
    NestList list;
    nest_list_init(&list);
    uint32_t on_surface;
    bool in_plane = false;
    RtcSurface surface = {.object = RTC_NO_OBJECT};
    Status status = compiled_stand(compiled, &standing, &list, &on_surface, error);
    if (camera->projection == PROJECTION_ORTHOGRAPHIC) {
        in_plane = status == STATUS_OK && surface_in_plane(compiled, &standing, &surface);
        if (!camera->expect) on_surface = SCENE_NONE; /* one that cuts through its middle */
    }
    if (status == STATUS_OK && !in_plane && on_surface != SCENE_NONE) {
        SurfacesHere here;
        compiled_surfaces_at(compiled, vec3_rounded(standing.from), 0, &here);
        surface = here.items[0];
    }
    bool moved = vec3_length(vec3_sub(standing.from, camera->from)) > 0;
    if (status == STATUS_OK && on_surface == SCENE_NONE && moved && may_fly(compiled, camera))
        status = report_step(compiled, camera, &list, diag, error);
    if (status == STATUS_OK && (on_surface != SCENE_NONE || in_plane)) {
        report_on_surface(compiled, camera, in_plane, &surface, diag);
        status = STATUS_SCENE;
    } else if (status == STATUS_OK && camera->expect && !meets_expectation(compiled, camera, &list)) {
        status = report_expectation(compiled, camera, &list, diag, error);
    }
    nest_list_clear(&list);
    return status;
}
