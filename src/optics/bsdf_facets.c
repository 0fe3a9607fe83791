/* bsdf_facets.c - the facets of rough surfaces: how they reflect, and sampling that.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

BsdfFacets facets_make(float alpha_x, float alpha_y)
{
    float larger = float_max(alpha_x, alpha_y);
    BsdfFacets facets = {.smooth = !(larger >= MICROFACET_SMOOTH_ALPHA)};
    if (facets.smooth) return facets;
    facets.alpha_x = float_min(float_max(alpha_x, MICROFACET_SMOOTH_ALPHA), 1);
    facets.alpha_y = float_min(float_max(alpha_y, MICROFACET_SMOOTH_ALPHA), 1);
    facets.stretched = facets.alpha_x != facets.alpha_y;
    return facets;
}

FacetReflection facets_reflect(const BsdfFacets *facets, Vec3f view, Vec3f light)
{
    Vec3f sum = vec3f_add(view, light), h = vec3f_scale(sum, 1 / sqrtf(vec3f_dot(sum, sum)));
    float s_v = microfacet_slope(facets->alpha_x, facets->alpha_y, view);
    float s_l = microfacet_slope(facets->alpha_x, facets->alpha_y, light);
    float density = microfacet_density(facets->alpha_x, facets->alpha_y, h) / (2 * (view.z + s_v));
    return (FacetReflection){vec3f_dot(view, h), density, microfacet_shadowing(view.z, s_v, light.z, s_l),
                             microfacet_angle(view.z, s_v), microfacet_angle(light.z, s_l)};
}

bool facets_sample_reflection(const BsdfFacets *facets, Vec3f view, const float u[2], Vec3f *light)
{
    Vec3f h = microfacet_visible(facets->alpha_x, facets->alpha_y, view, u);
    *light = vec3f_normalize(reflect_direction(vec3f_negate(view), h));
    return light->z > 0;
}
