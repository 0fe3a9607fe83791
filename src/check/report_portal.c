/* report_portal.c - portals that glass closes: what it bends aside is not looked for through them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"
#include "check/sight_line.h"
#include "scene/slabs.h"

enum { PLACES = 5 }; /* along each side */

/* What is looked at. */
typedef struct Finder {
    const CompiledScene *compiled;
    Slabs slabs; /* that light is looked for through */
} Finder;

/* Whether light is looked for through an object; through a combination where it is through all that it is made of. */
static bool lets_looks_through(const Finder *finder, uint32_t object)
{
    const Scene *scene = finder->compiled->scene;
    bool is_slab = slabs_are_looked_through(&finder->slabs, object), has_operands = false, all = true;
    for (uint32_t i = object + 1; i < scene->n_objects && scene->objects[i].part_of == object; i++) {
        has_operands = true;
        all = all && slabs_are_looked_through(&finder->slabs, i);
    }
    return is_slab || (has_operands && all);
}

/* Where a clear object ends the way from a place of the portal, to within or without; NULL: nowhere near it. */
static const SceneObject *closed_by(const Finder *finder, Vec3 place, Vec3 direction, double reach)
{
    const CompiledScene *compiled = finder->compiled;
    const SceneObject *object = NULL;
    Ray ray = ray_make(place, vec3f_from(direction));
    SightLine line;
    if (sight_line_find(compiled, &ray, &line, NULL) == STATUS_OK)
        for (size_t i = 0; i < line.n && !object && line.steps[i].distance < reach; i++)
            if (line.steps[i].kind == SIGHT_BOUNDARY && !lets_looks_through(finder, line.steps[i].object))
                object = &compiled->scene->objects[line.steps[i].object];
    sight_line_clear(&line);
    return object;
}

/* Of how many of its places the way is closed; *object: by what, of one of them. */
static int count_closed(const Finder *finder, const SceneLight *light, const SceneObject **object)
{
    const double reach = 2 * fmax(light->half_width, light->half_height);
    const Vec3 within = affine_vector(&light->to_world, vec3(0, 1, 0));
    int n = 0;
    for (int i = 0; i < PLACES * PLACES; i++) {
        double x = (2.0 * (i % PLACES) + 1) / PLACES - 1, z = (2.0 * (double)(i / PLACES) + 1) / PLACES - 1;
        Vec3 place = affine_point(&light->to_world, vec3(x * light->half_width, 0, z * light->half_height));
        const SceneObject *by = closed_by(finder, place, within, reach);
        if (!by) by = closed_by(finder, place, vec3_scale(within, -1), reach);
        if (!by) continue;
        *object = by;
        n++;
    }
    return n;
}

void report_portals(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    Finder finder = {.compiled = compiled};
    uint32_t n = 0;
    if (!scene->environment || !scene_has_portal(scene) || !compiled->n_hulls ||
        slabs_find(compiled, &finder.slabs, NULL) != STATUS_OK)
        return;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        const SceneObject *object = NULL;
        if (light->kind != LIGHT_PORTAL || 2 * count_closed(&finder, light, &object) <= PLACES * PLACES) continue;
        if (++n > REPORT_MOST) continue;
        Diagnostic *report =
            diag_report(diag, D_CLOSED_PORTAL, light->span,
                        "%s, a portal, is of little use: %s bends the light that comes in there, which is "
                        "then found by chance alone",
                        light->name, object->name);
        diag_note(diag, report, object->span, "%s is here", object->name);
        diag_hint(
            diag, report,
            "make its faces flat and parallel, smooth and still; or in place of its interior, write: surface = surface "
            "{ thin = true  ior = 1.52  transmission = 1 }; a box of that is two panes, as double glazing is");
    }
    slabs_clear(&finder.slabs);
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_CLOSED_PORTAL, "%u more portals are closed by glass", (unsigned)(n - REPORT_MOST));
}
