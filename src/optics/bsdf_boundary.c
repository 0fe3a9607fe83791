/* bsdf_boundary.c - the boundary between two dielectrics: [WMLT07], in basic radiance, and with the light kept that one
 * facet misses (microfacet.h).
 * The half vector H = eta_i view + eta_t light of a transmission is not normalized: its length cancels from the density
 *     D (v.h) G1 / v.z eta_t^2 (-l.h) / (eta_i v.h + eta_t l.h)^2
 *         = 2 eta_t^2 (v.H) (-l.H) / (pi alpha_x alpha_y q^2 (v.z + s_v))
 *     q = (H_x / alpha_x)^2 + (H_y / alpha_y)^2 + H_z^2
 * so that nothing is divided by a small number where the indices are nearly equal.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/hash.h"
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

/* Each wavelength as far from its critical angle as that is from its own for which it is known. */
static Lanes known_missing(const BsdfBoundary *boundary, const BsdfKnown *known, bool behind, Vec3f w)
{
    Lanes eta = lanes_div(boundary->eta_t, boundary->eta_i);
    if (known->critical < 0 || lanes_uniform(eta)) return lanes_all(direction_grid_at(&known->grid, w));
    Lanes missing = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        float n = lanes_get(eta, i), critical = microfacet_critical(behind ? 1 / n : n);
        Vec3f shifted = w; /* only the azimuth of x and y counts */
        shifted.z = float_min(float_max(fabsf(w.z) + known->critical - critical, 0), 1);
        lanes_set(&missing, i, direction_grid_at(&known->grid, shifted));
    }
    return missing;
}

Lanes boundary_missing(const BsdfBoundary *boundary, bool behind, Vec3f w)
{
    const BsdfKnown *known = boundary->known[behind];
    return known ? known_missing(boundary, known, behind, w)
                 : facets_missing(&boundary->facets, &boundary->index, behind, w);
}

/* What is missing falls off about as 1 / cos^2, from cos = alpha on, or from the square of the critical angle's if that
 * is less. So directions for it are sampled with a density of the cosine in proportion to cos / (cos^2 + a^2), a: where
 * that begins; at 1 it is nearly Lambert's law. */
static float missing_density(const BsdfBoundary *boundary, bool through, float cosine)
{
    float a = boundary->spread[through];
    return boundary->spread_norm[through] * cosine / (cosine * cosine + a * a);
}

static Vec3f sample_missing(const BsdfBoundary *boundary, bool through, const float u[2])
{
    float square = boundary->spread[through] * boundary->spread[through];
    float z = sqrtf(float_min(square * (powf(1 + 1 / square, 1 - u[0]) - 1), 1)), radius = sqrtf(1 - z * z), x, y;
    sampling_circle(u[1], &x, &y);
    return vec3f(radius * x, radius * y, through ? -z : z);
}

/* Densities of refraction by visible facets, times 1 - F; zero for wavelengths that no facet bends this way. */
static Lanes refraction_density(const BsdfBoundary *boundary, Vec3f view, Vec3f light, float s_v)
{
    Lanes x = lanes_add(lanes_scale(boundary->eta_i, view.x), lanes_scale(boundary->eta_t, light.x));
    Lanes y = lanes_add(lanes_scale(boundary->eta_i, view.y), lanes_scale(boundary->eta_t, light.y));
    Lanes z = lanes_add(lanes_scale(boundary->eta_i, view.z), lanes_scale(boundary->eta_t, light.z));
    Lanes v = lanes_add(lanes_add(lanes_scale(x, view.x), lanes_scale(y, view.y)), lanes_scale(z, view.z));
    Lanes l = lanes_add(lanes_add(lanes_scale(x, light.x), lanes_scale(y, light.y)), lanes_scale(z, light.z));
    /* up: the same sign as z */
    for (int i = 0; i < LANES; i++) {
        float sign = lanes_get(z, i) > 0 ? 1.0f : -1.0f;
        lanes_set(&v, i, float_max(sign * lanes_get(v, i), 0));
        lanes_set(&l, i, float_max(-sign * lanes_get(l, i), 0));
    }
    Lanes across_x = lanes_scale(x, 1 / boundary->facets.alpha_x),
          across_y = lanes_scale(y, 1 / boundary->facets.alpha_y);
    Lanes q = lanes_add(lanes_add(lanes_mul(across_x, across_x), lanes_mul(across_y, across_y)), lanes_mul(z, z));
    Lanes length = lanes_sqrt(lanes_add(lanes_add(lanes_mul(x, x), lanes_mul(y, y)), lanes_mul(z, z)));
    Lanes per_length = lanes_div(lanes_all(1), lanes_add(length, lanes_all(1e-30f)));
    Lanes reflectance =
        fresnel_dielectric_pair(lanes_clamp(lanes_mul(v, per_length), 0, 1),
                                lanes_clamp(lanes_mul(l, per_length), 0, 1), boundary->eta_i, boundary->eta_t);
    float scale = 2 / (SAMPLING_PI * boundary->facets.alpha_x * boundary->facets.alpha_y * (view.z + s_v));
    Lanes eta_l = lanes_mul(boundary->eta_t, lanes_div(l, lanes_add(q, lanes_all(1e-30f))));
    Lanes eta_v = lanes_mul(boundary->eta_t, lanes_div(v, lanes_add(q, lanes_all(1e-30f))));
    return lanes_mul(lanes_rest(reflectance), lanes_scale(lanes_mul(eta_l, eta_v), scale));
}

void boundary_evaluate(const BsdfBoundary *boundary, Vec3f view, Vec3f light, Lanes missing_v, Lanes *f_cos,
                       Lanes *pdf_w)
{
    *f_cos = *pdf_w = lanes_all(0);
    if (boundary->facets.smooth || light.z == 0) return;
    bool through = light.z < 0;
    Lanes density;
    float shadowing;
    if (through) {
        float s_v = microfacet_slope(boundary->facets.alpha_x, boundary->facets.alpha_y, view);
        float s_l = microfacet_slope(boundary->facets.alpha_x, boundary->facets.alpha_y, light);
        density = refraction_density(boundary, view, light, s_v);
        shadowing = microfacet_shadowing_through(view.z, s_v, -light.z, s_l);
    } else {
        FacetReflection r = facets_reflect(&boundary->facets, view, light);
        density = lanes_scale(fresnel_dielectric_lanes(r.cosine, boundary->eta_i, boundary->eta_t), r.density);
        shadowing = r.shadowing;
    }
    Lanes missing_l = boundary_missing(boundary, through, light);
    missing_v = lanes_mul(missing_v, boundary->blurred);
    density = lanes_scale(lanes_mul(density, boundary->blurred), shadowing);
    Lanes norm = through ? boundary->transmitted_norm : boundary->reflected_norm;
    Lanes part = through ? boundary->transmitted : boundary->reflected;
    float cosine = fabsf(light.z);
    *f_cos = lanes_add(density, lanes_scale(lanes_mul(norm, lanes_mul(missing_v, missing_l)), cosine));
    *pdf_w = lanes_add(density, lanes_scale(lanes_mul(missing_v, part), missing_density(boundary, through, cosine)));
}

/* A smooth boundary, or a rough one whose hero is not blurred; then other wavelengths do not go the same way. */
static bool sample_smooth(const BsdfBoundary *boundary, Vec3f view, float u_choice, LobeSample *sample)
{
    Lanes reflectance = UNLIKELY(boundary->filmed) ? thin_film_reflectance(&boundary->film, view.z, boundary->eta_i,
                                                                           boundary->eta_t, lanes_all(0))
                                                   : fresnel_dielectric_lanes(view.z, boundary->eta_i, boundary->eta_t);
    Vec3f in = vec3f_negate(view), normal = vec3f(0, 0, 1);
    sample->specular = true;
    bool back = lobe_choose(&u_choice, lanes_get(reflectance, 0));
    if (!back && !refract_direction(in, normal, lanes_get(boundary->eta_i, 0), lanes_get(boundary->eta_t, 0),
                                    &sample->direction))
        back = true; /* within rounding of the critical angle */
    if (back) sample->direction = mirrored(view);
    if (!back && !(sample->direction.z < 0)) return false;
    sample->value = sample->density = back ? reflectance : lanes_rest(reflectance);
    bool dispersed = !back && !(lanes_uniform(boundary->eta_i) && lanes_uniform(boundary->eta_t));
    if (dispersed || !boundary->facets.smooth) {
        sample->hero_only = true;
        sample->value = sample->density = lanes_mul(sample->value, lanes(1, 0, 0, 0));
    }
    return true;
}

/* What leaves a facet and is not hidden by others. Returns whether it is one. */
static bool sample_facets(const BsdfBoundary *boundary, Vec3f view, float *u_choice, const float u[2], Vec3f *light)
{
    const BsdfFacets *facets = &boundary->facets;
    Vec3f h = microfacet_visible(facets->alpha_x, facets->alpha_y, view, u), in = vec3f_negate(view);
    float eta_i = lanes_get(boundary->eta_i, 0), eta_t = lanes_get(boundary->eta_t, 0);
    bool back = lobe_choose(u_choice, fresnel_dielectric(vec3f_dot(view, h), eta_i, eta_t));
    if (!back && !refract_direction(in, h, eta_i, eta_t, light)) back = true;
    if (back) *light = vec3f_normalize(reflect_direction(in, h));
    if (!(back ? light->z > 0 : light->z < 0)) return false;
    float s_v = microfacet_slope(facets->alpha_x, facets->alpha_y, view);
    float s_l = microfacet_slope(facets->alpha_x, facets->alpha_y, *light);
    return lobe_choose(u_choice, back ? microfacet_shadowing(view.z, s_v, light->z, s_l)
                                      : microfacet_shadowing_through(view.z, s_v, -light->z, s_l));
}

/* Two numbers as even as those of the facet that was not taken, and independent of these. */
static void draw_again(const float u[2], float again[2])
{
    uint32_t first = (uint32_t)(u[0] * 0x1p24f), second = (uint32_t)(u[1] * 0x1p24f);
    again[0] = hash_to_unit_f(hash_combine(first, second));
    again[1] = hash_to_unit_f(hash_combine(~second, first));
}

/* Of the directions that facets send light to, those that others hide, or that lead to the wrong side, are what one facet
 * misses: there the other lobe is sampled, as often as its table says but for the table's errors. So all directions have
 * weights of about 1, and a path that is reflected totally many times in rough glass carries what it did. Were facets sampled
 * by themselves, and what they miss apart, each would weigh up to G2 / G1 over the share of the first: a furnace of rough
 * diamond had 12 times the variance. */
bool boundary_sample(const BsdfBoundary *boundary, Vec3f view, float u_choice, const float u[2], LobeSample *sample)
{
    if (boundary->facets.smooth || lanes_get(boundary->blurred, 0) == 0)
        return sample_smooth(boundary, view, u_choice, sample);
    if (sample_facets(boundary, view, &u_choice, u, &sample->direction)) return true;
    bool through = !lobe_choose(&u_choice, lanes_get(boundary->reflected, 0));
    float again[2];
    draw_again(u, again);
    sample->direction = sample_missing(boundary, through, again);
    return true;
}
