/* stops.c - which hulls end a straight ray of light for certain, so that it need not be followed any further.
 *
 * A shadow ray is blocked where the medium along it changes to one of another index. Say it starts in a medium M and
 * crosses the surface of a hull H. Just inside of that surface the place belongs to H, or to a hull that is above H and
 * meets it. If all of these have other indices than M, then the medium has changed on the way, wherever that was: the ray is
 * blocked, and no list is needed to see that. For surfaces inside of which M may still be all around, say of a drink
 * that bubbles of the air outside are in, nothing is known beforehand.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "scene/compile.h"

/* Whether two indices differ at every wavelength, by more than they could change between those that are looked at. */
static bool differ_everywhere(const Spectrum *a, const Spectrum *b)
{
    const float least = 1e-3f;
    bool constant = spectrum_is_constant(a) && spectrum_is_constant(b);
    int sign = 0;
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
        if (m == medium || !differ_everywhere(&scene->media[m].ior, &scene->media[medium].ior)) classes |= 1U << m;
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

Status compiled_mark_stops(CompiledScene *compiled, Error *error)
{
    const Scene *scene = compiled->scene;
    NestPolicy policy = compiled->order.policy;
    if ((policy != NEST_AUTOMATIC && policy != NEST_PRIORITY) || scene->n_keys || !compiled->n_hulls) return STATUS_OK;
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
