/* bsdf_diffuse.c - diffuse surfaces: Lambert's law and EON.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"

BsdfDiffuse diffuse_make(Lanes albedo, float roughness)
{
    /* EON, eq. 6 and 13: 1/2 - 2/(3 pi), and 2/3 - 28/(15 pi) */
    const float c1 = 0.5f - 2 / (3 * SAMPLING_PI), c2 = 2.0f / 3 - 28 / (15 * SAMPLING_PI);
    BsdfDiffuse diffuse = {.albedo = lanes_clamp(albedo, 0, 1), .roughness = float_min(float_max(roughness, 0), 1)};
    diffuse.single = 1 / (1 + c1 * diffuse.roughness);
    diffuse.average = diffuse.single * (1 + c2 * diffuse.roughness);
    float rest = float_max(1 - diffuse.average, 1e-7f);
    Lanes series = lanes_rest(lanes_scale(diffuse.albedo, rest));
    diffuse.multiple =
        lanes_div(lanes_scale(lanes_mul(diffuse.albedo, diffuse.albedo), diffuse.average / rest), series);
    return diffuse;
}

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
