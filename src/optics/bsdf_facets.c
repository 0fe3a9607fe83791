/* bsdf_facets.c - the facets of rough surfaces: how they reflect, and sampling that.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

BsdfFacets facets_make(float alpha_x, float alpha_y)
{
    float larger = float_max(alpha_x, alpha_y);
    BsdfFacets facets = {.smooth = !(larger >= MICROFACET_SMOOTH_ALPHA)};
    if (facets.smooth) return facets;
    float least = float_max(MICROFACET_SMOOTH_ALPHA, STRETCHED_LEAST_RATIO * float_min(larger, 1));
    facets.alpha_x = float_min(float_max(alpha_x, least), 1);
    facets.alpha_y = float_min(float_max(alpha_y, least), 1);
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

void facets_index(const BsdfFacets *facets, Lanes eta, BsdfIndex *index)
{
    if (facets->stretched)
        index->stretched = stretched_index(facets->alpha_x, facets->alpha_y, eta);
    else
        index->round = microfacet_index(facets->alpha_x, facets->alpha_x, eta); /* smooth: 0 */
}

static Lanes lookup(const MicrofacetTable round, const StretchedTable rest, const BsdfFacets *facets,
                    const BsdfIndex *index, bool behind, Vec3f w)
{
    if (facets->stretched) return stretched_lookup_boundary(round, rest, &index->stretched, behind, w);
    return microfacet_lookup(round, &index->round, behind, fabsf(w.z),
                             microfacet_slope(facets->alpha_x, facets->alpha_y, w));
}

Lanes facets_missing(const BsdfFacets *facets, const BsdfIndex *index, bool behind, Vec3f w)
{
    Lanes missing = lookup(microfacet_missing, stretched_missing, facets, index, behind, w);
    return facets->stretched ? lanes_clamp(missing, 0, 1) : missing;
}

Lanes facets_excess(const BsdfFacets *facets, const BsdfIndex *index, Vec3f w)
{
    return lookup(microfacet_excess, stretched_excess, facets, index, false, w);
}

Lanes facets_missing_mean(const BsdfFacets *facets, const BsdfIndex *index, bool behind)
{
    if (!facets->stretched) return microfacet_lookup_mean(microfacet_missing_mean, &index->round, behind);
    return stretched_lookup_mean(microfacet_missing_mean, stretched_missing_mean, &index->stretched, behind);
}

Lanes facets_reflected_mean(const BsdfFacets *facets, const BsdfIndex *index)
{
    if (!facets->stretched) return microfacet_lookup_mean(microfacet_reflected_mean, &index->round, false);
    return stretched_lookup_mean(microfacet_reflected_mean, stretched_reflected_mean, &index->stretched, false);
}
