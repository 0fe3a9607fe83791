/* bsdf_layer.c - diffuse surfaces, and a clear layer over something opaque.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

/* ---- diffuse ---- */

/* Albedo of one reflection by the model of Fujii at a cosine, over its constant A: EON, eq. 8 and 9. */
static float fujii_albedo(float roughness, float cosine)
{
    float sine = sqrtf(float_max((1 - cosine) * (1 + cosine), 0));
    float tail = cosine > 1e-4f ? sine / cosine * (1 - sine * sine * sine) : 1.5f * cosine;
    float g = sine * (acosf(float_min(cosine, 1)) - sine * cosine) + (2.0f / 3) * (tail - sine);
    return 1 + roughness / SAMPLING_PI * g;
}

Lanes diffuse_evaluate(const BsdfDiffuse *diffuse, Vec3f view, Vec3f light)
{
    float lambert = light.z / SAMPLING_PI;
    if (diffuse->roughness == 0) return lanes_scale(diffuse->albedo, lambert);
    float s = vec3f_dot(view, light) - view.z * light.z;
    float shape = s > 0 ? s / float_max(view.z, light.z) : s;
    float single = diffuse->single * (1 + diffuse->roughness * shape);
    float rest_v = 1 - diffuse->single * fujii_albedo(diffuse->roughness, view.z);
    float rest_l = 1 - diffuse->single * fujii_albedo(diffuse->roughness, light.z);
    float both = float_max(rest_v, 1e-7f) * float_max(rest_l, 1e-7f);
    return lanes_scale(lanes_add(lanes_scale(diffuse->albedo, single), lanes_scale(diffuse->multiple, both)), lambert);
}

/* The rough model grows as 1 / max(v.z, l.z) towards grazing angles, so a part is sampled evenly. */
float diffuse_density(const BsdfDiffuse *diffuse, Vec3f light)
{
    float even = 0.5f * diffuse->roughness;
    return (even * 0.5f + (1 - even) * light.z) / SAMPLING_PI;
}

Vec3f diffuse_sample(const BsdfDiffuse *diffuse, float u_choice, const float u[2])
{
    float pdf_w;
    if (!lobe_choose(&u_choice, 0.5f * diffuse->roughness))
        return sampling_cosine_hemisphere(u[0], u[1], vec3f(0, 0, 1), &pdf_w);
    Vec3f light = sampling_cone(u[0], u[1], vec3f(0, 0, 1), 1);
    light.z = float_max(light.z, 1e-7f);
    return light;
}

/* ---- layer ---- */

Lanes layer_reflectance(const BsdfLayer *layer, Vec3f w)
{
    Lanes reflectance = fresnel_dielectric_lanes(w.z, lanes_all(1), layer->eta);
    if (layer->facets.smooth) return reflectance;
    if (layer->index.any_dense) {
        float soft = float_min(microfacet_softened(w.z, layer->index.critical, layer->index.alpha), 1);
        Lanes softened = fresnel_dielectric_lanes(soft, lanes_all(1), layer->eta);
        for (int i = 0; i < LANES; i++)
            if (layer->index.side[i]) lanes_set(&reflectance, i, lanes_get(softened, i));
    }
    Lanes excess = lobe_lookup(microfacet_excess, &layer->facets, &layer->index, false, w);
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
    *f_cos = lanes_scale(fresnel_dielectric_lanes(r.cosine, lanes_all(1), layer->eta), r.density * r.shadowing);
    *pdf_w = r.density;
}

/* Diffuse light from the base: a part R_i comes back at once, and of that the base's albedo, and so on. The mean T of
 * diffuse light from above passes, so T / eta^2 = 1 - R_i of that from below (reciprocity), and with f_cos = albedo /
 * pi cos T(v) T(l) (1 - R_i) / (T (1 - albedo R_i)) a white base gives all back. */
Lanes layer_over_diffuse(const BsdfLayer *layer, Lanes base_albedo)
{
    return lanes_div(layer->norm, lanes_rest(lanes_mul(base_albedo, layer->returned)));
}

/* A mirror sends light back at the angle at which it came, so that the layer's reflectance on both sides is the same.
 */
Lanes layer_over_mirror(const BsdfLayer *layer, Lanes base_albedo, Lanes reflectance_v, Lanes reflectance_l)
{
    Lanes back = lanes_mul(base_albedo, lanes_sqrt(lanes_mul(reflectance_v, reflectance_l)));
    if (layer->tinted) back = lanes_mul(back, lanes_exp(lanes_scale(layer->depth, -2)));
    return lanes_div(lanes_all(1), lanes_clamp(lanes_rest(back), 1e-6f, 1));
}

Lanes layer_chance(const BsdfLayer *layer, float share, Lanes reflectance, Lanes base_albedo)
{
    Lanes reflected = lanes_scale(reflectance, share);
    Lanes base = lanes_mul(lanes_rest(reflected), lanes_clamp(base_albedo, 0.05f, 1));
    /* the table does not know of anisotropy; what it takes for nothing is sampled, too */
    if (!layer->facets.smooth) reflected = lanes_add(reflected, lanes_all(0.02f * share));
    return lanes_div(reflected, lanes_add(lanes_add(reflected, base), lanes_all(1e-30f)));
}

/* ---- plastic ---- */

void plastic_evaluate(const BsdfPlastic *plastic, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    const BsdfLayer *layer = &plastic->layer;
    Lanes reflectance_v = layer_reflectance(layer, view), reflectance_l = layer_reflectance(layer, light);
    Lanes passed =
        lanes_mul(layer_transmittance(layer, view, reflectance_v), layer_transmittance(layer, light, reflectance_l));
    Lanes base =
        lanes_mul(diffuse_evaluate(&plastic->base, view, light), layer_over_diffuse(layer, plastic->base.albedo));
    Lanes chance = layer_chance(layer, 1, reflectance_v, plastic->base.albedo);
    float layer_pdf;
    layer_evaluate(layer, view, light, f_cos, &layer_pdf);
    *f_cos = lanes_add(*f_cos, lanes_mul(base, passed));
    *pdf_w = lanes_add(lanes_scale(chance, layer_pdf),
                       lanes_scale(lanes_rest(chance), diffuse_density(&plastic->base, light)));
}

bool plastic_sample(const BsdfPlastic *plastic, Vec3f view, float u_choice, const float u[2], LobeSample *sample)
{
    const BsdfLayer *layer = &plastic->layer;
    Lanes reflectance = layer_reflectance(layer, view),
          chance = layer_chance(layer, 1, reflectance, plastic->base.albedo);
    if (!lobe_choose(&u_choice, lanes_get(chance, 0))) {
        sample->direction = diffuse_sample(&plastic->base, u_choice, u);
        return true;
    }
    if (!layer->facets.smooth) return facets_sample_reflection(&layer->facets, view, u, &sample->direction);
    sample->specular = true;
    sample->direction = mirrored(view);
    sample->value = reflectance;
    sample->density = chance;
    return true;
}
