/* bsdf_cover.c - what a clear layer makes of what is under it, plastic as such a pair, and fuzz.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

/* ---- under a layer ---- */

Lanes layer_over_rough_diffuse(const BsdfLayer *layer, float roughness, Vec3f view, Vec3f light)
{
    if (roughness == 0) return lanes_all(1);
    MicrofacetPlace base = microfacet_place(roughness, LAYERED_DIFFUSES);
    const float from[2] = {view.z, view.z}, to[2] = {light.z, light.z};
    return lanes_mul(layered_lookup(layered_under_diffuse, base, &layer->among, from),
                     layered_lookup(layered_under_diffuse, base, &layer->among, to));
}

/* T over the root of T' of layered.h, for facets of that alpha. */
static Lanes softened_root(const BsdfLayer *layer, Vec3f w, Lanes passed, float alpha)
{
    const MicrofacetIndex *index = facets_round_index(&layer->facets, &layer->index);
    Lanes root = lanes_sqrt(passed);
    if (!index->any_dense) return root;
    float z = float_min(microfacet_softened(w.z, index->critical, alpha), 1);
    float across = sqrtf((1 - z) * (1 + z) / float_max((1 - w.z) * (1 + w.z), 1e-12f));
    Vec3f soft = vec3f(across * w.x, across * w.y, z);
    Lanes divisor = lanes_sqrt(lanes_rest(layer_reflectance(layer, soft)));
    for (int i = 0; i < LANES; i++)
        if (index->side[i]) lanes_set(&root, i, lanes_get(passed, i) / float_max(lanes_get(divisor, i), 1e-6f));
    return root;
}

static float mean_alpha(const BsdfFacets *facets)
{
    return sqrtf(0.5f * (facets->alpha_x * facets->alpha_x + facets->alpha_y * facets->alpha_y));
}

/* t where a balance puts right the rest: about as layered.h has it, with u = 1, and the same power for all directions.
 * Under a layer that is itself the rougher one nothing needs to be softened. */
static Lanes passed_to_balanced(const BsdfLayer *layer, const BsdfFacets *facets, Vec3f w, Lanes passed)
{
    float alpha = mean_alpha(facets);
    int quarters = layered_quarters(microfacet_place(sqrtf(alpha), LAYERED_MIRRORS).knot);
    bool soft = mean_alpha(&layer->facets) < 2 * alpha;
    Lanes smooth = soft ? softened_root(layer, w, passed, facets_alpha(facets, w)) : lanes_sqrt(passed);
    if (quarters == 0) return smooth;
    Lanes over = lanes_div(passed, lanes_add(lanes_mul(smooth, lanes_sqrt(layer->mean_passed)), lanes_all(1e-12f)));
    return lanes_mul(smooth, quarters == 1 ? lanes_sqrt(over) : over);
}

/* t of layered.h; passed: T, without tint. */
static Lanes passed_to_mirrors(const BsdfLayer *layer, const BsdfConductor *base, Vec3f w, Lanes passed)
{
    const BsdfFacets *facets = &base->facets;
    if (facets->smooth) return lanes_sqrt(passed);
    if (base->balanced) return passed_to_balanced(layer, facets, w, passed);
    float alpha = facets_alpha(facets, w), s = stretched_slope(alpha, w.z);
    const float angles[2] = {microfacet_angle(w.z, s),
                             layer->among.any_dense ? microfacet_angle_within(w.z, s, layer->among.critical, alpha)
                                                    : 0};
    MicrofacetPlace row = facets_row(facets, w);
    Lanes smooth = softened_root(layer, w, passed, alpha);
    /* over / smooth = (T' / mean T)^(1/2), with T = T' where nothing is softened */
    Lanes over = lanes_div(passed, lanes_add(lanes_mul(smooth, lanes_sqrt(layer->mean_passed)), lanes_all(1e-12f)));
    const Lanes factors[3] = {smooth, lanes_mul(smooth, lanes_sqrt(over)), lanes_mul(smooth, over)};
    int near = layered_quarters(row.knot), far = layered_quarters(row.knot + 1);
    if (near == far) return lanes_mul(factors[near], layered_lookup(layered_under_mirror, row, &layer->among, angles));
    Lanes first = layered_lookup(layered_under_mirror, (MicrofacetPlace){row.knot, 0}, &layer->among, angles);
    Lanes second = layered_lookup(layered_under_mirror, (MicrofacetPlace){row.knot, 1}, &layer->among, angles);
    return lanes_add(lanes_scale(lanes_mul(factors[near], first), 1 - row.fraction),
                     lanes_scale(lanes_mul(factors[far], second), row.fraction));
}

/* What a base that reflects `mean` sends out, over what a white one does and over what it reflects once. Of what it sends up a part a
 * comes back at first, and b each time after that: (1 - a) + a m (1 - b) / (1 - b m). A smooth mirror has the layer's R for both; a
 * rough one sends much beyond the critical angle, a long way through the layer. */
static Lanes over_again(const BsdfLayer *layer, const BsdfConductor *base, Vec3f view, Vec3f light, Lanes mirrored)
{
    const MicrofacetPlace roughness = microfacet_place(sqrtf(mean_alpha(&base->facets)), LAYERED_RETURN_ROUGHNESSES);
    Lanes more[2], back[2], left[2];
    const float angles[2] = {view.z, light.z};
    layered_returned(roughness, &layer->among, angles, more);
    for (int i = 0; i < 2; i++) {
        back[i] = lanes_lesser(lanes_add(mirrored, more[i]), lanes_all(1 - 1e-6f));
        left[i] = back[i];
    }
    if (layer->tinted) {
        Lanes straight = lanes_mul(mirrored, lanes_exp(lanes_scale(layer->depth, -2)));
        for (int i = 0; i < 2; i++)
            left[i] = lanes_lesser(back[i], lanes_add(straight, lanes_mul(more[i], layer->returned_left)));
    }
    Lanes later = lanes_div(lanes_rest(back[1]), lanes_rest(lanes_mul(left[1], base->mean)));
    return lanes_add(lanes_rest(back[0]), lanes_mul(lanes_mul(left[0], base->mean), later));
}

Lanes layer_over_mirrors(const BsdfLayer *layer, const BsdfConductor *base, Vec3f view, Vec3f light,
                         Lanes reflectance_v, Lanes reflectance_l, Lanes passed_v, Lanes passed_l)
{
    Lanes in = lanes_rest(reflectance_v), out = lanes_rest(reflectance_l);
    Lanes factor = lanes_mul(passed_to_mirrors(layer, base, view, in), passed_to_mirrors(layer, base, light, out));
    if (layer->tinted) {
        Lanes tint = lanes_div(lanes_mul(passed_v, passed_l), lanes_add(lanes_mul(in, out), lanes_all(1e-20f)));
        factor = lanes_mul(factor, lanes_clamp(tint, 0, 1));
    }
    Lanes mirrored = lanes_sqrt(lanes_mul(reflectance_v, reflectance_l));
    return lanes_mul(factor, over_again(layer, base, view, light, mirrored));
}

Lanes layer_inner_reflectance(Lanes eta, Lanes eta_base)
{
    /* Gauss's three points of the square of the cosine */
    static const float squares[] = {0.1127017f, 0.5f, 0.8872983f}, weights[] = {5.0f / 18, 8.0f / 18, 5.0f / 18};
    Lanes sum = lanes_all(0), weight = lanes_all(1e-12f);
    for (int i = 0; i < 3; i++)
        for (int lane = 0; lane < LANES; lane++) {
            float n = lanes_get(eta, lane), square = 1 - (1 - squares[i]) / (n * n);
            if (!(square > 0)) continue; /* does not get in */
            float r = fresnel_dielectric(sqrtf(square), n, lanes_get(eta_base, lane));
            lanes_set(&sum, lane, lanes_get(sum, lane) + weights[i] * r);
            lanes_set(&weight, lane, lanes_get(weight, lane) + weights[i]);
        }
    return lanes_div(sum, weight);
}

/* ---- plastic ---- */

void plastic_evaluate(const BsdfPlastic *plastic, Vec3f view, Vec3f light, Lanes reflectance_v, LobeOver over,
                      Lanes *f_cos, Lanes *pdf_w)
{
    const BsdfLayer *layer = plastic->layer;
    Lanes reflectance_l = layer_reflectance(layer, light);
    Lanes passed =
        lanes_mul(layer_transmittance(layer, view, reflectance_v), layer_transmittance(layer, light, reflectance_l));
    Lanes base =
        lanes_mul(diffuse_evaluate(&plastic->base, view, light), layer_over_diffuse(layer, plastic->base.albedo));
    base = lanes_mul(base, layer_over_rough_diffuse(layer, plastic->base.roughness, view, light));
    Lanes chance = layer_chance(layer, 1, reflectance_v, plastic->base.albedo);
    float layer_pdf;
    layer_evaluate(layer, view, light, f_cos, &layer_pdf);
    *f_cos = lanes_add(lanes_scale(*f_cos, over.mirror), lanes_scale(lanes_mul(base, passed), over.diffuse));
    *pdf_w = lanes_add(lanes_scale(chance, layer_pdf),
                       lanes_scale(lanes_rest(chance), diffuse_density(&plastic->base, light)));
}

bool plastic_sample(const BsdfPlastic *plastic, Vec3f view, Lanes reflectance_v, float u_choice, const float u[2],
                    LobeSample *sample)
{
    const BsdfLayer *layer = plastic->layer;
    Lanes chance = layer_chance(layer, 1, reflectance_v, plastic->base.albedo);
    if (!lobe_choose(&u_choice, lanes_get(chance, 0))) {
        sample->direction = diffuse_sample(&plastic->base, u_choice, u);
        return true;
    }
    if (!layer->facets.smooth) return facets_sample_reflection(&layer->facets, view, u, &sample->direction);
    sample->specular = true;
    sample->direction = mirrored(view);
    sample->value = reflectance_v;
    sample->density = chance;
    return true;
}

/* ---- fuzz ---- */

BsdfFuzz fuzz_make(float share, Lanes color, float roughness)
{
    return (BsdfFuzz){.roughness = microfacet_place(roughness, LAYERED_FUZZ),
                      .skin = microfacet_place(roughness, LAYERED_SKIN_FUZZ),
                      .skin_share = microfacet_place(share, LAYERED_SKIN_SHARES),
                      .exponent = layered_fuzz_exponent(roughness),
                      .share = share,
                      .color = color};
}

float fuzz_albedo(const BsdfFuzz *fuzz, Vec3f w)
{
    return fuzz->share * layered_fuzz(fuzz->roughness, fabsf(w.z));
}

float fuzz_to_mirrors(const BsdfFuzz *fuzz, const BsdfFacets *facets, Vec3f w, float passed)
{
    if (facets->smooth) return sqrtf(passed);
    float angle = microfacet_angle(w.z, stretched_slope(facets_alpha(facets, w), w.z));
    return sqrtf(passed) *
           layered_lookup_fuzz(layered_fuzz_mirror, facets_row(facets, w), fuzz->roughness, fuzz->share, angle);
}

float fuzz_to_diffuse(const BsdfFuzz *fuzz, float roughness, Vec3f w, float passed)
{
    if (roughness == 0) return passed;
    MicrofacetPlace row = microfacet_place(roughness, LAYERED_DIFFUSES);
    return passed * layered_lookup_fuzz(layered_fuzz_diffuse, row, fuzz->roughness, fuzz->share, fabsf(w.z));
}

float fuzz_to_base(const BsdfFuzz *fuzz, const BsdfLayer *layer, Vec3f w)
{
    if (layer->facets.smooth) return 1;
    float alpha = facets_alpha(&layer->facets, w), angle = microfacet_angle(w.z, stretched_slope(alpha, w.z));
    Lanes reflectance = layer_reflectance(layer, w);
    Lanes out = layered_lookup_skin(fuzz->skin, fuzz->skin_share,
                                    microfacet_place(sqrtf(alpha), LAYERED_SKIN_ROUGHNESSES), &layer->among, angle);
    float passed = 1 - lanes_mean(reflectance), rest = 1 - lanes_mean(lanes_mul(reflectance, out));
    return rest > 0 ? rest / float_max(passed, 1e-3f) : 0;
}

void fuzz_evaluate(const BsdfFuzz *fuzz, Vec3f view, Vec3f light, Lanes *f_cos, float *pdf_w)
{
    *f_cos = lanes_scale(fuzz->color, fuzz->share * layered_fuzz_value(fuzz->exponent, view, light) * light.z);
    *pdf_w = (0.25f + 0.5f * light.z) / SAMPLING_PI;
}

/* Half evenly, half by the cosine. */
Vec3f fuzz_sample(float u_choice, const float u[2])
{
    float pdf_w;
    if (u_choice < 0.5f) return sampling_cosine_hemisphere(u[0], u[1], vec3f(0, 0, 1), &pdf_w);
    Vec3f light = sampling_cone(u[0], u[1], vec3f(0, 0, 1), 1);
    light.z = float_max(light.z, 1e-7f);
    return light;
}
