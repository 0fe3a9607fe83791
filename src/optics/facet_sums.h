/* facet_sums.h - what all facets of a surface do with light from one direction, summed over a fixed set of them; for what
 * makes tables.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FACET_SUMS_H
#define MEN_FACET_SUMS_H

#include "optics/fresnel.h"
#include "optics/microfacet.h"

/* Facets, and the stride of their lattice. */
enum { FACETS = 987, FACET_STRIDE = 610 };

/* Point i of n of a lattice in the unit square; n and stride are neighbours in Fibonacci's sequence. */
static inline void facet_lattice(int i, int n, int stride, float u[2])
{
    u[0] = ((float)i + 0.5f) / (float)n;
    u[1] = ((float)((i * stride) % n) + 0.5f) / (float)n;
}

/* Facet i of FACETS that are seen from v. */
static inline Vec3f facet_visible(float alpha_x, float alpha_y, Vec3f v, int i)
{
    float u[2];
    facet_lattice(i, FACETS, FACET_STRIDE, u);
    return microfacet_visible(alpha_x, alpha_y, v, u);
}

/* What one facet reflects of light from v, and what it neither reflects nor transmits; missed: NULL where it is not wanted.
 * eta: eta_t / eta_i. */
static inline void facet_sums(float alpha_x, float alpha_y, float eta, Vec3f v, float *reflected, float *missed)
{
    Vec3f in = vec3f_negate(v), l;
    float s_v = microfacet_slope(alpha_x, alpha_y, v);
    double back = 0, through = 0;
    for (int i = 0; i < FACETS; i++) {
        Vec3f h = facet_visible(alpha_x, alpha_y, v, i);
        float reflectance = fresnel_dielectric(vec3f_dot(v, h), 1, eta);
        l = reflect_direction(in, h);
        if (l.z > 0)
            back += (double)(reflectance * microfacet_shadowing(v.z, s_v, l.z, microfacet_slope(alpha_x, alpha_y, l)));
        if (missed && reflectance < 1 && refract_direction(in, h, 1, eta, &l) && l.z < 0)
            through += (double)((1 - reflectance) *
                                microfacet_shadowing_through(v.z, s_v, -l.z, microfacet_slope(alpha_x, alpha_y, l)));
    }
    *reflected = (float)(back / FACETS);
    if (missed) *missed = float_max(0, 1 - *reflected - (float)(through / FACETS));
}

#endif
