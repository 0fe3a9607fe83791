/* compile_light.c - lights on the surfaces of clear objects, where what becomes of their light is up to rounding.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/compile.h"

enum { MOST = 10, PLACES = 5 };

static bool is_clear(const CompiledScene *compiled, const RtcSurface *surface)
{
    return compiled->hull_of_object[surface->object] != SCENE_NONE;
}

/* Where there is a surface of a combination, or none of an operand. */
static Status is_boundary(const CompiledScene *compiled, Vec3 place, const SurfacesHere *here, HitList *hits,
                          bool *result)
{
    NestList list;
    bool none = false;
    nest_list_init(&list);
    Status status = compiled_interior(compiled, vec3f_from(place), 0, hits, &list, NULL);
    if (status == STATUS_OK) status = compiled_are_no_surfaces(compiled, &list, here, &none);
    nest_list_clear(&list);
    *result = !none;
    return status;
}

/* The surface of a clear object that a place is on, of those that face against a direction (NULL: whichever way they face);
 * false: none. */
static Status find_surface(const CompiledScene *compiled, Vec3 place, const Vec3 *against, HitList *hits,
                           RtcSurface *surface, bool *found)
{
    SurfacesHere here;
    *found = false;
    compiled_surfaces_at(compiled, place, 0, &here);
    for (uint32_t i = 0; i < here.n && !*found; i++) {
        *surface = here.items[i];
        *found =
            is_clear(compiled, surface) && (!against || vec3_dot(vec3_from_f(surface->normal), *against) < -(1 - 1e-6));
    }
    return *found ? is_boundary(compiled, place, &here, hits, found) : STATUS_OK;
}

/* One without size. */
static Status check_point(const CompiledScene *compiled, const SceneLight *light, HitList *hits, uint32_t *n,
                          Diag *diag)
{
    RtcSurface surface;
    bool found;
    TRY(find_surface(compiled, light->to_world.t, NULL, hits, &surface, &found));
    if (!found || ++*n > MOST) return STATUS_OK;
    Diagnostic *report =
        diag_report(diag, D_LIGHT_ON_SURFACE, light->span,
                    "%s has no size and is on the surface of %s: whether it is inside is up to rounding", light->name,
                    compiled->scene->objects[surface.object].name);
    compiled_advise_off_surface(compiled, &surface, report, diag);
    return STATUS_OK;
}

/* One that is flat, asked for at its middle and halfway to its corners. */
static Status check_flat(const CompiledScene *compiled, const SceneLight *light, HitList *hits, uint32_t *n, Diag *diag)
{
    double x = 0.5 * light->half_width, z = light->kind == LIGHT_DISC ? x : 0.5 * light->half_height;
    const Vec3 places[PLACES] = {{0, 0, 0}, {x, 0, z}, {-x, 0, z}, {x, 0, -z}, {-x, 0, -z}};
    Vec3 axis = affine_vector(&light->to_world, vec3(0, 1, 0));
    RtcSurface surface = {0};
    uint32_t n_found = 0;
    for (int i = 0; i < PLACES; i++) {
        RtcSurface here;
        bool found;
        TRY(find_surface(compiled, affine_point(&light->to_world, places[i]), &axis, hits, &here, &found));
        if (found && n_found++ == 0) surface = here;
    }
    if (2 * n_found <= PLACES || ++*n > MOST) return STATUS_OK;
    Diagnostic *report = diag_report(diag, D_LIGHT_ON_SURFACE, light->span,
                                     "%s lies in a face of %s and shines into it: it counts as inside, and looks less "
                                     "bright from outside by the square "
                                     "of the index",
                                     light->name, compiled->scene->objects[surface.object].name);
    compiled_advise_off_surface(compiled, &surface, report, diag);
    return STATUS_OK;
}

Status compile_check_lights(const CompiledScene *compiled, Diag *diag, Error *error)
{
    HitList hits = {0};
    Status status = STATUS_OK;
    uint32_t n = 0;
    for (uint32_t i = 0; compiled->n_hulls && status == STATUS_OK && i < compiled->scene->n_lights; i++) {
        const SceneLight *light = &compiled->scene->lights[i];
        if (light->kind == LIGHT_POINT)
            status = check_point(compiled, light, &hits, &n, diag);
        else if (light_is_flat(light))
            status = check_flat(compiled, light, &hits, &n, diag);
    }
    hit_list_clear(&hits);
    if (status != STATUS_OK) return fail_memory(error, 0, "the lights' surroundings");
    if (n > MOST) diag_report_nowhere(diag, D_LIGHT_ON_SURFACE, "and %u more lights are", (unsigned)(n - MOST));
    return STATUS_OK;
}
