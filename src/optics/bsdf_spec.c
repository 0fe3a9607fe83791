/* bsdf_spec.c - from the parameters of a surface to its lobes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_spec.h"

void bsdf_spec_init(BsdfSpec *spec)
{
    *spec = (BsdfSpec){
        .base_color = spectrum_constant(0.8f),
        .specular_weight = 1,
        .specular_roughness = 0.3f,
        .specular_ior = spectrum_constant(1.5f),
        .transmission_color = spectrum_constant(1),
        .coat_color = spectrum_constant(1),
        .coat_ior = spectrum_constant(1.6f),
    };
}

void bsdf_alphas(float roughness, float anisotropy, float *alpha_x, float *alpha_y)
{
    float alpha = roughness * roughness, across = 1 - anisotropy;
    *alpha_x = alpha * sqrtf(2 / (1 + across * across));
    *alpha_y = across * *alpha_x;
    *alpha_x = float_min(*alpha_x, 1);
}

Lanes bsdf_metal_of_reflectance(Lanes reflectance)
{
    /* head on, with n = 1: R = k^2 / (4 + k^2) */
    Lanes held = lanes_clamp(reflectance, 0, 0.9999f);
    return lanes_scale(lanes_sqrt(lanes_div(held, lanes_rest(held))), 2);
}

/* The index on the same side of 1 whose head-on reflectance is weight times as large. */
static Lanes weakened(Lanes eta, float weight)
{
    if (!(weight < 1)) return eta;
    Lanes root =
        lanes_scale(lanes_div(lanes_sub(eta, lanes_all(1)), lanes_add(eta, lanes_all(1))), sqrtf(float_max(weight, 0)));
    return lanes_div(lanes_add(lanes_all(1), root), lanes_rest(root));
}

/* Of the opaque base. Under a coat of a larger index nothing is totally reflected, as light is bent on its way in,
 * which the directions here do not know of; so the inverse stands for that, as in OpenPBR. */
static Lanes base_eta(const BsdfSpec *spec, Lanes wavelength_nm, Lanes above)
{
    Lanes eta = lanes_div(spectrum_at(&spec->specular_ior, wavelength_nm), above);
    for (int i = 0; i < LANES; i++)
        if (spec->coat_weight > 0 && lanes_get(eta, i) < 1) lanes_set(&eta, i, 1 / lanes_get(eta, i));
    return weakened(eta, spec->specular_weight);
}

void bsdf_from_spec(const BsdfSpec *spec, Lanes wavelength_nm, Lanes eta_i, Lanes eta_t, Bsdf *bsdf)
{
    float metal = spec->base_metalness, clear = (1 - metal) * spec->transmission_weight, opaque = 1 - metal - clear;
    float alpha_x, alpha_y;
    bsdf_alphas(spec->specular_roughness, spec->specular_roughness_anisotropy, &alpha_x, &alpha_y);
    Lanes coat_eta = lanes_div(spectrum_at(&spec->coat_ior, wavelength_nm), eta_i);
    /* what lies under a coat borders on that; where only a part is covered, on something between */
    Lanes above = lanes_add(lanes_all(1), lanes_scale(lanes_sub(coat_eta, lanes_all(1)), spec->coat_weight));
    above = lanes_mul(eta_i, above);
    Lanes base_color = spectrum_at(&spec->base_color, wavelength_nm);
    bsdf_begin(bsdf);
    if (metal > 0) {
        Lanes n = lanes_all(1), k;
        if (spec->measured_metal) {
            n = lanes_div(spectrum_at(&spec->metal_n, wavelength_nm), above);
            k = lanes_div(spectrum_at(&spec->metal_k, wavelength_nm), above);
        } else {
            k = bsdf_metal_of_reflectance(base_color);
        }
        bsdf_add_conductor(bsdf, metal, n, k, alpha_x, alpha_y);
    }
    if (opaque > 0) {
        if (spec->specular_weight > 0)
            bsdf_add_plastic(bsdf, opaque, base_eta(spec, wavelength_nm, above), alpha_x, alpha_y, lanes_all(1),
                             base_color, spec->base_diffuse_roughness);
        else
            bsdf_add_diffuse(bsdf, opaque, base_color, spec->base_diffuse_roughness);
    }
    if (clear > 0) {
        if (spec->thin_walled)
            bsdf_add_sheet(bsdf, clear, lanes_div(spectrum_at(&spec->specular_ior, wavelength_nm), eta_i), alpha_x,
                           alpha_y, spectrum_at(&spec->transmission_color, wavelength_nm));
        else
            bsdf_add_boundary(bsdf, clear, eta_i, eta_t, alpha_x, alpha_y);
    }
    if (spec->coat_weight > 0) {
        bsdf_alphas(spec->coat_roughness, spec->coat_roughness_anisotropy, &alpha_x, &alpha_y);
        bsdf_set_coat(bsdf, spec->coat_weight, coat_eta, alpha_x, alpha_y,
                      spectrum_at(&spec->coat_color, wavelength_nm));
    }
}
