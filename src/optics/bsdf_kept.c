/* bsdf_kept.c - clear layers that are made once.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_kept.h"

#include "optics/fresnel.h"

/* What tables may be off by. Those of microfacet.h, which a layer's is made of, are themselves off by more between their knots. */
static const float layer_error = 4e-4f, facet_error = 2e-5f;

static float of_layer(const BsdfLayer *layer, float cosine)
{
    return lanes_get(layer_reflectance(layer, vec3f(sqrtf((1 - cosine) * (1 + cosine)), 0, cosine)), 0);
}

static float of_facet(const BsdfLayer *layer, float cosine)
{
    return fresnel_dielectric(cosine, 1, lanes_get(layer->eta, 0));
}

/* Whether the table says what the function does, also halfway between its places. */
static bool tabulate(float (*function)(const BsdfLayer *, float), const BsdfLayer *layer, float most_error,
                     float readings[LAYER_READINGS])
{
    for (int i = 0; i <= LAYER_STEPS; i++) {
        float root = (float)i / LAYER_STEPS;
        readings[i] = function(layer, root * root);
    }
    readings[LAYER_STEPS + 1] = readings[LAYER_STEPS];
    for (int i = 0; i < LAYER_STEPS; i++) {
        float root = ((float)i + 0.5f) / LAYER_STEPS;
        if (!(fabsf(layer_read(readings, root * root) - function(layer, root * root)) <= most_error)) return false;
    }
    return true;
}

void kept_layer_make(const LayerLook *look, KeptLayer *kept)
{
    BsdfLayer *layer = &kept->layer;
    kept->look = *look;
    layer_make(lanes_all(look->eta), look->alpha_x, look->alpha_y, lanes_all(look->tint), NULL, layer);
    layer_find_among(layer);
    bool round = !layer->facets.stretched;
    if (round && tabulate(of_layer, layer, layer_error, kept->reflectances)) layer->reflectances = kept->reflectances;
    if (tabulate(of_facet, layer, facet_error, kept->facet_reflectances))
        layer->facet_reflectances = kept->facet_reflectances;
}
