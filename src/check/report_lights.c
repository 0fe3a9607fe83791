/* report_lights.c - lights without size whose light has to go through glass: no path finds them there.
 * A path that meets a smooth boundary is bent in one direction only, and would have to hit the light by chance; that it
 * is looked for straight on, from where the path is, is of use up to the first such boundary.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"
#include "check/sight_line.h"

enum { DIRECTIONS = 256, BENDERS = 8 };
static const double worth_a_word = 0.1; /* of a light's flux: what less is lost is not reported */

/* What becomes of a light's flux. */
typedef struct Fate {
    double all, lost;
    uint32_t bender[BENDERS]; /* objects that bend it, as far as there is room */
    double by[BENDERS];
    uint32_t n;
} Fate;

/* Whether what is lost at a boundary is found otherwise, or was not meant to pass: of a rough one, and of one all painted. */
static bool loses_nothing(const Scene *scene, uint32_t object)
{
    uint32_t number = scene->objects[object].surface;
    if (number == SCENE_NONE) return false;
    const SceneSurface *surface = &scene->surfaces[number];
    return surface->roughness > 0 || (surface->painted && !surface->mixed && surface->spec.transmission_weight == 0);
}

/* The object whose smooth surface a line is bent by before it ends; SCENE_NONE where there is none. */
static uint32_t bender_along(const Scene *scene, const SightLine *line)
{
    for (size_t i = 0; i < line->n; i++) {
        const SightStep *step = &line->steps[i];
        if (step->kind == SIGHT_OPAQUE) return SCENE_NONE;
        if (step->kind == SIGHT_BOUNDARY || step->kind == SIGHT_PAINTED)
            return loses_nothing(scene, step->object) ? SCENE_NONE : step->object;
    }
    return SCENE_NONE;
}

static void add_loss(Fate *fate, uint32_t object, double flux)
{
    uint32_t i = 0;
    fate->lost += flux;
    while (i < fate->n && fate->bender[i] != object) i++;
    if (i == BENDERS) return;
    if (i == fate->n) fate->bender[fate->n++] = object;
    fate->by[i] += flux;
}

Vec3 report_direction(int i, int n, double least_y)
{
    const double golden_angle = 2.399963229728653;
    double y = 1 - (1 - least_y) * (i + 0.5) / n, r = sqrt(fmax(1 - y * y, 0));
    return vec3(r * cos(golden_angle * i), y, r * sin(golden_angle * i));
}

/* false when memory ends */
static bool follow(const CompiledScene *compiled, const SceneLight *light, Fate *fate)
{
    for (int i = 0; i < DIRECTIONS; i++) {
        Vec3 local = report_direction(i, DIRECTIONS, light->cos_none);
        double flux = (double)light_shape(light, local);
        if (!(flux > 0)) continue;
        Ray ray = ray_make(light->to_world.t, vec3f_from(affine_vector(&light->to_world, local)));
        SightLine line;
        bool found = sight_line_find(compiled, &ray, &line, NULL) == STATUS_OK;
        uint32_t bender = found ? bender_along(compiled->scene, &line) : SCENE_NONE;
        sight_line_clear(&line);
        if (!found) return false;
        fate->all += flux;
        if (bender != SCENE_NONE) add_loss(fate, bender, flux);
    }
    return true;
}

static void report_loss(const Scene *scene, const SceneLight *light, const Fate *fate, Diag *diag)
{
    uint32_t most = 0;
    for (uint32_t i = 1; i < fate->n; i++)
        if (fate->by[i] > fate->by[most]) most = i;
    const SceneObject *object = &scene->objects[fate->bender[most]];
    double percent = 100 * fate->lost / fate->all;
    Diagnostic *report =
        percent > 99.9
            ? diag_report(diag, D_LOST_LIGHT, light->span,
                          "%s has no size, and all of its light goes into %s, which bends it: none of it will be found "
                          "behind that",
                          light->name, object->name)
            : diag_report(diag, D_LOST_LIGHT, light->span,
                          "%s has no size, and %.0f %% of its light meets the smooth surface of %s%s, which bends it: "
                          "what is behind gets none of that",
                          light->name, percent, object->name, fate->n > 1 ? " and others" : "");
    diag_note(diag, report, object->span, "%s is here", object->name);
    diag_hint(diag, report, "a light with a size, such as shape = sphere with a small radius, is found");
}

void report_lost_lights(const CompiledScene *compiled, Diag *diag)
{
    const Scene *scene = compiled->scene;
    uint32_t n = 0;
    for (uint32_t i = 0; i < scene->n_lights && compiled->n_hulls; i++) {
        const SceneLight *light = &scene->lights[i];
        Fate fate = {0};
        if (light->kind != LIGHT_POINT || n > REPORT_MOST) continue;
        if (!follow(compiled, light, &fate)) return; /* no memory for a warning: what needs more will say so */
        if (!(fate.lost > worth_a_word * fate.all) || ++n > REPORT_MOST) continue;
        report_loss(scene, light, &fate, diag);
    }
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_LOST_LIGHT, "and more lights without size shine through what bends their light");
}
