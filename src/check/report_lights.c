/* report_lights.c - lights without size whose light has to go through curved glass, or comes off mirrors: no path finds them there.
 * A path that meets a smooth boundary is bent in one direction only, and would have to hit the light by chance; that it
 * is looked for, from where the path is, is of use up to the first such boundary that is not flat (scene/slabs.h).
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "check/report_parts.h"
#include "check/sight_line.h"
#include "scene/slabs.h"

enum { DIRECTIONS = 256, BENDERS = 8, LINES_TO_PLACES = 60000 };
/* What less is lost is not reported: of a light's flux, and of the picture. */
static const double worth_a_word = 0.1, worth_a_word_in_picture = 0.01;

/* Where lights are, and what they are found through. */
typedef struct Finder {
    const CompiledScene *compiled;
    Slabs slabs;
} Finder;

/* What becomes of a light's flux, or of its way to what is seen. */
typedef struct Fate {
    double all, lost;
    uint32_t bender[BENDERS]; /* objects that bend it, as far as there is room */
    double by[BENDERS];
    uint32_t n;
    double nearest; /* distance of one of these; 0 while there is none */
} Fate;

/* Whether what is lost at a boundary is found otherwise, or was not meant to pass: of a rough one, and of one all painted. */
static bool loses_nothing(const Scene *scene, uint32_t object)
{
    uint32_t number = scene->objects[object].surface;
    if (number == SCENE_NONE) return false;
    const SceneSurface *surface = &scene->surfaces[number];
    return surface->roughness > 0 || (surface->painted && !surface->mixed && surface->spec.transmission_weight == 0);
}

/* Where a smooth surface that is not flat bends a line before it ends; NULL where none does. */
static const SightStep *bend_along(const Finder *finder, const SightLine *line)
{
    const Scene *scene = finder->compiled->scene;
    for (size_t i = 0; i < line->n; i++) {
        const SightStep *step = &line->steps[i];
        if (step->kind == SIGHT_OPAQUE) return NULL;
        if (step->kind == SIGHT_BOUNDARY && slabs_are_looked_through(&finder->slabs, step->operand) &&
            slabs_face(&finder->slabs, step->operand, step->normal))
            continue;
        if (step->kind == SIGHT_BOUNDARY || step->kind == SIGHT_PAINTED)
            return loses_nothing(scene, step->object) ? NULL : step;
    }
    return NULL;
}

/* Whether a surface sends on most of the light that comes to it in one direction, as polished metal does. */
static bool is_mirror(const Scene *scene, uint32_t object)
{
    const double most_alpha = 1e-3, mostly = 0.5; /* see bsdf.h */
    uint32_t number = scene->objects[object].surface;
    if (number == SCENE_NONE) return false;
    const SceneSurface *surface = &scene->surfaces[number];
    double roughness = (double)surface->spec.specular_roughness;
    return surface->finished && !surface->mixed && (double)surface->spec.base_metalness >= mostly &&
           roughness * roughness < most_alpha;
}

static void add_loss(Fate *fate, const SightStep *bend, double flux)
{
    uint32_t i = 0;
    fate->lost += flux;
    if (!(fate->nearest > 0) || bend->distance < fate->nearest) fate->nearest = bend->distance;
    while (i < fate->n && fate->bender[i] != bend->object) i++;
    if (i == BENDERS) return;
    if (i == fate->n) fate->bender[fate->n++] = bend->object;
    fate->by[i] += flux;
}

Vec3 report_direction(int i, int n, double least_y)
{
    const double golden_angle = 2.399963229728653;
    double y = 1 - (1 - least_y) * (i + 0.5) / n, r = sqrt(fmax(1 - y * y, 0));
    return vec3(r * cos(golden_angle * i), y, r * sin(golden_angle * i));
}

/* mirrored: what comes to mirrors by ways on which nothing is lost. false when memory ends */
static bool follow(const Finder *finder, const SceneLight *light, Fate *fate, Fate *mirrored)
{
    for (int i = 0; i < DIRECTIONS; i++) {
        Vec3 local = report_direction(i, DIRECTIONS, light->cos_none);
        double flux = (double)light_shape(light, local);
        if (!(flux > 0)) continue;
        Ray ray = ray_make(light->to_world.t, vec3f_from(affine_vector(&light->to_world, local)));
        SightLine line;
        bool found = sight_line_find(finder->compiled, &ray, &line, NULL) == STATUS_OK;
        const SightStep *bend = found ? bend_along(finder, &line) : NULL;
        const SightStep *end = found && !bend ? sight_line_end(&line) : NULL;
        fate->all += flux;
        if (bend) add_loss(fate, bend, flux);
        if (end && is_mirror(finder->compiled->scene, end->object)) add_loss(mirrored, end, flux);
        sight_line_clear(&line);
        if (!found) return false;
    }
    return true;
}

static const SceneObject *worst_bender(const Scene *scene, const Fate *fate)
{
    uint32_t most = 0;
    for (uint32_t i = 1; i < fate->n; i++)
        if (fate->by[i] > fate->by[most]) most = i;
    return &scene->objects[fate->bender[most]];
}

/* A radius that a lamp might have, for what is so far away: a fiftieth of that, as a round number. */
static double good_radius(double distance)
{
    double radius = distance / 50, power = pow(10, floor(log10(radius)));
    return floor(radius / power) * power;
}

static void finish_report(const SceneLight *light, const SceneObject *object, const Fate *fate, Diagnostic *report,
                          Diag *diag)
{
    diag_note(diag, report, object->span, "%s is here", object->name);
    diag_hint(diag, report, "a light with a size is found: write, say, shape = %s  radius = %g",
              light->cos_none > -1 ? "disc" : "sphere", good_radius(fate->nearest));
}

static void report_loss(const Scene *scene, const SceneLight *light, const Fate *fate, Diag *diag)
{
    const SceneObject *object = worst_bender(scene, fate);
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
    finish_report(light, object, fate, report, diag);
}

/* part: of its light. */
static void report_mirrored(const Scene *scene, const SceneLight *light, const Fate *fate, double part, Diag *diag)
{
    const SceneObject *object = worst_bender(scene, fate);
    Diagnostic *report =
        diag_report(diag, D_LOST_LIGHT, light->span,
                    "%s has no size, and %.0f %% of its light meets the polished metal of %s%s: what that "
                    "throws will not be found",
                    light->name, 100 * part, object->name, fate->n > 1 ? " and others" : "");
    finish_report(light, object, fate, report, diag);
}

/* Whether a line from the light ends at a place: what is opaque there, and nothing opaque before it. */
static bool ends_at(const SightLine *line, double distance)
{
    const double same = 1e-3; /* of the distance: place and line are told by float directions */
    const SightStep *end = sight_line_end(line);
    return end && fabs(end->distance - distance) < same * distance;
}

/* As follow(), of straight ways to places, each of which counts 1. */
static bool follow_to(const Finder *finder, const SceneLight *light, const ReportView *view, uint32_t step, Fate *fate)
{
    for (uint32_t i = 0; i < view->n; i += step) {
        Vec3 away = vec3_sub(view->places[i], light->to_world.t);
        Vec3 direction = vec3_normalize(away), local = affine_normal(&light->to_world, direction); /* a rigid frame */
        if (!(light_shape(light, local) > 0)) continue;
        Ray ray = ray_make(light->to_world.t, vec3f_from(direction));
        SightLine line;
        bool found = sight_line_find(finder->compiled, &ray, &line, NULL) == STATUS_OK;
        bool comes = found && ends_at(&line, vec3_length(away));
        const SightStep *bend = comes ? bend_along(finder, &line) : NULL;
        if (bend) add_loss(fate, bend, 1);
        sight_line_clear(&line);
        if (!found) return false;
    }
    return true;
}

/* Of one that loses little, but leaves a part of the picture in the dark. */
static void report_dark(const Scene *scene, const SceneLight *light, const Fate *fate, double part, Diag *diag)
{
    const SceneObject *object = worst_bender(scene, fate);
    Diagnostic *report =
        diag_report(diag, D_LOST_LIGHT, light->span,
                    "%s has no size, and what of its light meets the smooth surface of %s%s is bent and will not be "
                    "found: %.0f %% of the picture is in the dark behind that",
                    light->name, object->name, fate->n > 1 ? " and others" : "", 100 * part);
    finish_report(light, object, fate, report, diag);
}

static void report_each(const Finder *finder, const ReportView *view, uint32_t step, Diag *diag)
{
    const Scene *scene = finder->compiled->scene;
    uint32_t n = 0, n_places = view ? view->n : 0;
    for (uint32_t i = 0; i < scene->n_lights; i++) {
        const SceneLight *light = &scene->lights[i];
        Fate flux = {0}, way = {0}, mirrored = {0};
        if (light->kind != LIGHT_POINT || n > REPORT_MOST) continue;
        if (!follow(finder, light, &flux, &mirrored)) return; /* no memory for a warning: what needs more will say so */
        bool loses = flux.lost > worth_a_word * flux.all;
        if (mirrored.lost > worth_a_word * flux.all && ++n <= REPORT_MOST)
            report_mirrored(scene, light, &mirrored, mirrored.lost / flux.all, diag);
        if (!loses && n_places > 0 && !follow_to(finder, light, view, step, &way)) return;
        double part = n_places > 0 ? way.lost * step / view->n_lines : 0;
        if ((!loses && !(part > worth_a_word_in_picture)) || ++n > REPORT_MOST) continue;
        if (loses)
            report_loss(scene, light, &flux, diag);
        else
            report_dark(scene, light, &way, part, diag);
    }
    if (n > REPORT_MOST)
        diag_report_nowhere(diag, D_LOST_LIGHT,
                            "and more lights without size shine at what bends or mirrors their light");
}

void report_lost_lights(const CompiledScene *compiled, const ReportView *view, Diag *diag)
{
    const Scene *scene = compiled->scene;
    uint32_t n_points = 0, n_places = view ? view->n : 0;
    for (uint32_t i = 0; i < scene->n_lights; i++) n_points += scene->lights[i].kind == LIGHT_POINT;
    uint32_t step = 1 + (uint32_t)((uint64_t)n_points * n_places / LINES_TO_PLACES);
    Finder finder = {.compiled = compiled};
    if (!n_points || slabs_find(compiled, &finder.slabs, NULL) != STATUS_OK) return;
    report_each(&finder, view, step, diag);
    slabs_clear(&finder.slabs);
}
