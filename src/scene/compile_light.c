/* compile_light.c - lights on the surfaces of clear objects, where what becomes of their light is up to rounding; and at one
 * place with other lamps, of which one hides the other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/compile.h"
#include "scene/ties.h"

enum { MOST = 10 };

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
                    "%s has no size and is on the surface of %s: it lights both sides of that, as if it were on each",
                    light->name, compiled->scene->objects[surface.object].name);
    compiled_advise_off_surface(compiled, &surface, report, diag);
    return STATUS_OK;
}

/* One that is flat, in a face of a clear object. */
static Status check_flat(const CompiledScene *compiled, const SceneLight *light, HitList *hits, uint32_t *n, Diag *diag)
{
    Vec3 places[LIGHT_PLACES], up[LIGHT_PLACES];
    RtcSurface surface = {0};
    uint32_t n_found = 0;
    light_some_places(light, places, up);
    for (int i = 0; i < LIGHT_PLACES; i++) {
        RtcSurface here;
        bool found;
        TRY(find_surface(compiled, places[i], &up[i], hits, &here, &found));
        if (found && n_found++ == 0) surface = here;
    }
    if (2 * n_found <= LIGHT_PLACES || ++*n > MOST) return STATUS_OK;
    Diagnostic *report = diag_report(diag, D_LIGHT_ON_SURFACE, light->span,
                                     "%s lies in a face of %s and shines into it: it counts as inside, and looks less "
                                     "bright from outside by the square "
                                     "of the index",
                                     light->name, compiled->scene->objects[surface.object].name);
    compiled_advise_off_surface(compiled, &surface, report, diag);
    return STATUS_OK;
}

/* Whether what stands at one place with a light is a lamp that is declared later, or a surface that shines. */
static bool shines_there(const CompiledScene *compiled, const SceneLight *light, Vec3 up, const RtcSurface *surface)
{
    const Scene *scene = compiled->scene;
    const SceneObject *object = &scene->objects[surface->object];
    double facing = vec3_dot(vec3_from_f(surface->normal), up);
    bool lamp = object->light != SCENE_NONE;
    if (lamp ? !ties_wins(scene, light->object, true, surface->object, true) : !scene_shines(scene, surface->object))
        return false;
    return (lamp || scene->shapes[object->shape].closed ? facing : fabs(facing)) > 1 - 1e-6;
}

/* The first such object, where there is one at most of a light's places; SCENE_NONE: there is none. */
static uint32_t find_lamp_there(const CompiledScene *compiled, const SceneLight *light)
{
    Vec3 places[LIGHT_PLACES], up[LIGHT_PLACES];
    uint32_t n_found = 0, first = SCENE_NONE;
    light_some_places(light, places, up);
    for (int i = 0; i < LIGHT_PLACES; i++) {
        SurfacesHere here;
        uint32_t k = 0;
        compiled_surfaces_at(compiled, places[i], 0, &here);
        while (k < here.n && (here.items[k].object == light->object || is_clear(compiled, &here.items[k]) ||
                              !shines_there(compiled, light, up[i], &here.items[k])))
            k++;
        if (k < here.n && n_found++ == 0) first = here.items[k].object;
    }
    return 2 * n_found > LIGHT_PLACES ? first : SCENE_NONE;
}

static void check_shared(const CompiledScene *compiled, const SceneLight *light, uint32_t *n, Diag *diag)
{
    uint32_t other = find_lamp_there(compiled, light);
    if (other == SCENE_NONE || ++*n > MOST) return;
    const SceneObject *object = &compiled->scene->objects[other];
    Diagnostic *report;
    if (object->light != SCENE_NONE)
        report = diag_report(diag, D_LIGHT_ON_SURFACE, light->span,
                             "%s is at one place with %s, which is declared later: there only %s shines", light->name,
                             object->name, object->name);
    else
        report = diag_report(diag, D_LIGHT_ON_SURFACE, light->span,
                             "%s is on the surface of %s, which shines, too: there only %s does", light->name,
                             object->name, light->name);
    diag_note(diag, report, object->span, "%s is here", object->name);
    diag_hint(diag, report, "leave one of them out, or move it; their light does not add up");
}

Status compile_check_lights(const CompiledScene *compiled, Diag *diag, Error *error)
{
    HitList hits = {0};
    Status status = STATUS_OK;
    uint32_t n = 0;
    for (uint32_t i = 0; status == STATUS_OK && i < compiled->scene->n_lights; i++) {
        const SceneLight *light = &compiled->scene->lights[i];
        if (light->kind == LIGHT_POINT)
            status = compiled->n_hulls ? check_point(compiled, light, &hits, &n, diag) : STATUS_OK;
        else if (compiled->n_hulls && light_is_flat(light))
            status = check_flat(compiled, light, &hits, &n, diag);
        if (light->object != SCENE_NONE) check_shared(compiled, light, &n, diag);
    }
    hit_list_clear(&hits);
    if (status != STATUS_OK) return fail_memory(error, 0, "the lights' surroundings");
    if (n > MOST) diag_report_nowhere(diag, D_LIGHT_ON_SURFACE, "and %u more lights are", (unsigned)(n - MOST));
    return STATUS_OK;
}
