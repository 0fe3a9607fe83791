/* bsdf_layer.c - a clear layer over something opaque: what it reflects and lets pass.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

Lanes layer_depth(Lanes transmittance)
{
    Lanes depth = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        float t = lanes_get(transmittance, i);
        lanes_set(&depth, i, t < 1 ? -logf(float_max(t, 1e-6f)) : 0);
    }
    return depth;
}

/* What a boundary reflects of light from its side of index eta, relative to the other one, at cosines above the critical one. */
static Lanes reflected_within(Lanes eta, Lanes cosine)
{
    Lanes sine_square = lanes_mul(lanes_mul(eta, eta), lanes_rest(lanes_mul(cosine, cosine)));
    Lanes passed = lanes_sqrt(lanes_greater(lanes_rest(sine_square), lanes_all(0)));
    return fresnel_dielectric_pair(cosine, passed, eta, lanes_all(1));
}

/* What is left of diffuse light from below that comes back from the layer's outer face: most of it goes beyond the critical
 * angle, a long way through the layer. By Gauss's points, up to that angle's cosine and, as the square of a number, from there. */
static Lanes left_of_returned(Lanes eta, Lanes depth)
{
    static const float points[] = {0.0469101f, 0.2307653f, 0.5f, 0.7692347f, 0.9530899f},
                       weights[] = {0.1184634f, 0.2393143f, 0.2844444f, 0.2393143f, 0.1184634f};
    const Lanes twice = lanes_scale(depth, -2), one = lanes_all(1);
    Lanes square = lanes_greater(lanes_rest(lanes_div(one, lanes_mul(eta, eta))), lanes_all(0));
    Lanes critical = lanes_sqrt(square), above = lanes_rest(critical), left = lanes_all(0), all = square;
    for (size_t i = 0; i < COUNT_OF(points); i++) {
        Lanes cosine = lanes_greater(lanes_scale(critical, points[i]), lanes_all(1e-6f));
        left = lanes_add(
            left, lanes_scale(lanes_mul(square, lanes_exp(lanes_div(twice, cosine))), 2 * points[i] * weights[i]));
        cosine = lanes_add(critical, lanes_scale(above, points[i] * points[i]));
        Lanes part =
            lanes_mul(lanes_scale(lanes_mul(cosine, above), 4 * points[i] * weights[i]), reflected_within(eta, cosine));
        all = lanes_add(all, part);
        left = lanes_add(left, lanes_mul(part, lanes_exp(lanes_div(twice, cosine))));
    }
    return lanes_div(left, lanes_add(all, lanes_all(1e-12f)));
}

/* Written where it is wanted: its index is large, and each copy is waited for. */
void layer_make(Lanes eta, float alpha_x, float alpha_y, Lanes tint, const BsdfKnown *known, BsdfLayer *layer)
{
    layer->facets = facets_make(alpha_x, alpha_y);
    layer->eta = eta;
    layer->known = known;
    layer->reflectances = layer->facet_reflectances = NULL;
    facets_index(&layer->facets, eta, &layer->index);
    layer->depth = lanes_scale(layer_depth(tint), 0.5f);
    layer->tinted = !lanes_zero(layer->depth);
    Lanes passed = lanes_rest(facets_reflected_mean(&layer->facets, &layer->index));
    if (known) passed = lanes_all(1 - known->mean);
    layer->mean_passed = passed;
    /* Reciprocity. Under a layer of the smaller index it can say more than all, as what one facet misses counts as
     * passed. */
    Lanes passed_back = lanes_clamp(lanes_div(passed, lanes_mul(eta, eta)), 0, 1);
    layer->norm = lanes_div(passed_back, lanes_add(passed, lanes_all(1e-12f)));
    layer->returned = lanes_rest(passed_back);
    if (layer->tinted) {
        layer->returned_left = left_of_returned(eta, layer->depth);
        layer->returned = lanes_mul(layer->returned, layer->returned_left);
    }
}

void layer_find_among(BsdfLayer *layer)
{
    layer->among = microfacet_index_among(layer->facets.alpha_x, layer->facets.alpha_y, layer->eta, LAYERED_ROUGHNESSES,
                                          LAYERED_INDICES);
}

Lanes layer_smooth_reflectance(const BsdfLayer *layer, Vec3f w)
{
    Lanes reflectance = fresnel_dielectric_lanes(w.z, lanes_all(1), layer->eta);
    const MicrofacetIndex *index = facets_round_index(&layer->facets, &layer->index);
    if (!index->any_dense) return reflectance;
    float width = direction_edge_width(layer->facets.alpha_x, layer->facets.alpha_y, w);
    float soft = float_min(microfacet_softened(w.z, index->critical, width), 1);
    Lanes softened = fresnel_dielectric_lanes(soft, lanes_all(1), layer->eta);
    return lanes_select_less(layer->eta, lanes_all(1), softened, reflectance);
}

Lanes layer_reflectance(const BsdfLayer *layer, Vec3f w)
{
    if (layer->reflectances) return lanes_all(layer_read(layer->reflectances, w.z));
    if (layer->known) {
        Lanes beyond = lanes_all(direction_grid_at(&layer->known->grid, w));
        return lanes_clamp(lanes_add(layer_smooth_reflectance(layer, w), beyond), 0, 1);
    }
    Lanes reflectance = fresnel_dielectric_lanes(w.z, lanes_all(1), layer->eta);
    if (layer->facets.smooth) return reflectance;
    const MicrofacetIndex *index = facets_round_index(&layer->facets, &layer->index);
    if (index->any_dense) {
        float alpha = facets_alpha(&layer->facets, w);
        float soft = float_min(microfacet_softened(w.z, index->critical, alpha), 1);
        Lanes softened = fresnel_dielectric_lanes(soft, lanes_all(1), layer->eta);
        for (int i = 0; i < LANES; i++)
            if (index->side[i]) lanes_set(&reflectance, i, lanes_get(softened, i));
    }
    Lanes excess = facets_excess(&layer->facets, &layer->index, w);
    return lanes_clamp(lanes_add(reflectance, excess), 0, 1);
}

Lanes layer_transmittance(const BsdfLayer *layer, Vec3f w, Lanes reflectance)
{
    Lanes passed = lanes_rest(reflectance);
    if (!layer->tinted) return passed;
    Lanes sine_square = lanes_div(lanes_all(float_max((1 - w.z) * (1 + w.z), 0)), lanes_mul(layer->eta, layer->eta));
    Lanes cosine = lanes_sqrt(lanes_clamp(lanes_rest(sine_square), 1e-6f, 1));
    return lanes_mul(passed, lanes_exp(lanes_sub(lanes_all(0), lanes_div(layer->depth, cosine))));
}

void layer_evaluate(const BsdfLayer *layer, Vec3f view, Vec3f light, Lanes *f_cos, float *pdf_w)
{
    *f_cos = lanes_all(0);
    *pdf_w = 0;
    if (layer->facets.smooth) return;
    FacetReflection r = facets_reflect(&layer->facets, view, light);
    Lanes reflected = layer->facet_reflectances ? lanes_all(layer_read(layer->facet_reflectances, r.cosine))
                                                : fresnel_dielectric_lanes(r.cosine, lanes_all(1), layer->eta);
    *f_cos = lanes_scale(reflected, r.density * r.shadowing);
    *pdf_w = r.density;
}

/* Diffuse light from the base: a part R_i comes back at once, and of that the base's albedo, and so on. The mean T of
 * diffuse light from above passes, so T / eta^2 = 1 - R_i of that from below (reciprocity), and with f_cos = albedo /
 * pi cos T(v) T(l) (1 - R_i) / (T (1 - albedo R_i)) a white base gives all back. */
Lanes layer_over_diffuse(const BsdfLayer *layer, Lanes base_albedo)
{
    return lanes_div(layer->norm, lanes_rest(lanes_mul(base_albedo, layer->returned)));
}

Lanes layer_chance(const BsdfLayer *layer, float share, Lanes reflectance, Lanes base_albedo)
{
    Lanes reflected = lanes_scale(reflectance, share);
    Lanes base = lanes_mul(lanes_rest(reflected), lanes_clamp(base_albedo, 0.05f, 1));
    /* tables have errors: what they take for nothing is sampled, too */
    if (!layer->facets.smooth) reflected = lanes_add(reflected, lanes_all(0.02f * share));
    return lanes_div(reflected, lanes_add(lanes_add(reflected, base), lanes_all(1e-30f)));
}
