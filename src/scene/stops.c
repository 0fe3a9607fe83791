/* stops.c - which hulls' surfaces a ray need not look at closely: those that end a straight ray of light for certain, and
 * those that a path crosses in silence for certain.
 *
 * A shadow ray is blocked where the medium along it changes to one of another index. Say it starts in a medium M and
 * crosses the surface of a hull H. Just inside of that surface the place belongs to H, or to a hull that is above H and
 * meets it. If all of these have other indices than M, then the medium has changed on the way, wherever that was: the ray is
 * blocked, and no list is needed to see that. For surfaces inside of which M may still be all around, say of a drink
 * that bubbles of the air outside are in, nothing is known beforehand.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "scene/compile.h"

/* By more than they could change between the wavelengths that are looked at. */
bool compiled_indices_differ(const Scene *scene, uint32_t medium_a, uint32_t medium_b)
{
    const Spectrum *a = &scene->media[medium_a].ior, *b = &scene->media[medium_b].ior;
    bool constant = spectrum_is_constant(a) && spectrum_is_constant(b);
    const float least = constant ? FLT_MIN : 1e-3f;
    int sign = 0;
    if (medium_a == medium_b) return false;
    if (scene->media[medium_a].refracts_doubly || scene->media[medium_b].refracts_doubly) return true;
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float nm = SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM);
        float difference = spectrum_at_one(a, nm) - spectrum_at_one(b, nm);
        if (!(fabsf(difference) >= least) || difference * (float)sign < 0) return false;
        if (constant) return true;
        sign = difference > 0 ? 1 : -1;
    }
    return true;
}

/* The classes of the media whose index may be this one's at some wavelength: itself among them. */
static uint32_t like(const Scene *scene, uint32_t medium, uint32_t n_classes)
{
    uint32_t classes = 0;
    for (uint32_t m = 0; m < n_classes; m++)
        if (!compiled_indices_differ(scene, m, medium)) classes |= 1U << m;
    return classes;
}

/* What a ray may meet inside of each hull's surface, of the hulls above it too. */
static void find_alike(const CompiledScene *compiled, const uint32_t *of_medium, uint32_t *alike)
{
    const NestOrder *order = &compiled->order;
    for (uint32_t h = 0; h < compiled->n_hulls; h++)
        alike[h] = nest_mixes(order, h) ? UINT32_MAX : of_medium[compiled->hulls[h].medium];
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        uint32_t a = compiled_hull(compiled, compiled->pairs[i].a), b = compiled_hull(compiled, compiled->pairs[i].b);
        if (a >= compiled->n_hulls || b >= compiled->n_hulls) continue;
        uint32_t top = order->rank[a] > order->rank[b] ? a : b, bottom = top == a ? b : a;
        if (!nest_mixes(order, top)) alike[bottom] |= of_medium[compiled->hulls[top].medium];
    }
}

/* Rays in a hull pass by what is below it, and by what is like it. */
static void let_pass(CompiledScene *compiled, uint32_t hull)
{
    uint32_t level = compiled->order.top[hull].level;
    if (level) compiled->passing[level] = (CompiledPassing){level, compiled->order.top[hull].medium};
}

/* Where a path is in hull O, and O is on top, crossing hulls of lower rank changes nothing but the list, in whatever order
 * they come; and so does crossing hulls of O's own medium, which may get on top of it. Where no such hull is known to meet
 * O, rays are not asked to look for them: that is not needed to be right, only to be quick. */
static void mark_passing(CompiledScene *compiled)
{
    const Scene *scene = compiled->scene;
    const NestOrder *order = &compiled->order;
    for (uint32_t h = 0; h < compiled->n_hulls; h++) {
        uint32_t object = compiled->object_of_hull[h], medium = order->top[h].medium;
        if (nest_mixes(order, h) || scene->objects[object].shape == SCENE_NONE) continue;
        /* the volumes of a medium that varies are each hull's own, and paint shows wherever the owner changes */
        bool own = scene->media[medium].density || scene->media[medium].emits || scene_is_painted(scene, object);
        rtc_set_passing(compiled->rtc, object, order->top[h].level, own ? RTC_NO_PASS : medium);
        if (!own && medium == NEST_WORLD_MEDIUM) compiled->passing[0].alike = medium;
    }
    for (size_t i = 0; i < compiled->n_pairs; i++) {
        uint32_t a = compiled_hull(compiled, compiled->pairs[i].a), b = compiled_hull(compiled, compiled->pairs[i].b);
        if (a >= compiled->n_hulls || b >= compiled->n_hulls) continue;
        bool alike = order->top[a].medium == order->top[b].medium, a_on_top = order->rank[a] > order->rank[b];
        NestRelation relation = compiled->pairs[i].relation; /* from within, a hull all around is not met */
        if ((alike || a_on_top) && relation != NEST_A_IN_B) let_pass(compiled, a);
        if ((alike || !a_on_top) && relation != NEST_B_IN_A) let_pass(compiled, b);
    }
}

Status compiled_mark_stops(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    NestPolicy policy = compiled->order.policy;
    size_t n_levels = compiled->n_hulls + (size_t)1;
    free(compiled->passing);
    compiled->passing = malloc(n_levels * sizeof *compiled->passing);
    if (!compiled->passing) return fail_memory(error, n_levels * sizeof *compiled->passing, "the hulls");
    for (size_t i = 0; i < n_levels; i++) compiled->passing[i] = (CompiledPassing){0, RTC_NO_PASS};
    if ((policy != NEST_AUTOMATIC && policy != NEST_PRIORITY) || !compiled->n_hulls) return STATUS_OK;
    mark_passing(compiled);
    if (scene->n_keys) return STATUS_OK;
    uint32_t n_classes = scene->n_media < COMPILED_STOP_CLASSES ? scene->n_media : COMPILED_STOP_CLASSES;
    uint32_t *of_medium = malloc(((size_t)scene->n_media + compiled->n_hulls) * sizeof *of_medium);
    if (!of_medium) return fail_memory(error, compiled->n_hulls * sizeof *of_medium, "the hulls");
    uint32_t *alike = of_medium + scene->n_media;
    for (uint32_t m = 0; m < scene->n_media; m++) of_medium[m] = like(scene, m, n_classes);
    find_alike(compiled, of_medium, alike);
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        uint32_t hull = compiled->hull_of_object[i];
        bool operand = hull >= compiled->n_hulls; /* its surface need not be there */
        if (!operand && scene->objects[i].shape != SCENE_NONE) rtc_set_stops(compiled->rtc, i, ~alike[hull]);
    }
    free(of_medium);
    return STATUS_OK;
}
