/* bsdf_mirrors.c - conductors and thin sheets: lobes whose facets are mirrors.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf_lobe.h"
#include "optics/fresnel.h"

BsdfMirrors mirrors_make(const BsdfFacets *facets)
{
    BsdfMirrors mirrors = {.roughness = microfacet_index(facets->alpha_x, facets->alpha_y, lanes_all(1)).roughness};
    if (facets->stretched) mirrors.stretched = stretched_place(facets->alpha_x, facets->alpha_y);
    return mirrors;
}

float mirrors_scaling(const BsdfMirrors *mirrors, const BsdfFacets *facets, Vec3f view, Vec3f light,
                      const FacetReflection *r)
{
    float round = microfacet_mirror(mirrors->roughness, r->angle_v) * microfacet_mirror(mirrors->roughness, r->angle_l);
    if (!facets->stretched) return round;
    return round * stretched_lookup(&mirrors->stretched, view, r->angle_v) *
           stretched_lookup(&mirrors->stretched, light, r->angle_l);
}

/* ---- conductor ---- */

static Lanes conductor_reflectance(const BsdfConductor *conductor, float cosine)
{
    if (conductor->white) return lanes_all(1);
    if (UNLIKELY(conductor->filmed))
        return thin_film_reflectance(&conductor->film, cosine, lanes_all(1), conductor->n, conductor->k);
    return fresnel_conductor(cosine, conductor->n, conductor->k);
}

void conductor_evaluate(const BsdfConductor *conductor, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    *f_cos = *pdf_w = lanes_all(0);
    if (conductor->facets.smooth) return;
    FacetReflection r = facets_reflect(&conductor->facets, view, light);
    Lanes reflectance = conductor_reflectance(conductor, r.cosine);
    /* the scaling puts back what white facets miss; coloured ones give back less of it, more saturated */
    float scaling = mirrors_scaling(&conductor->mirrors, &conductor->facets, view, light, &r);
    Lanes scale = lanes_add(lanes_all(1), lanes_scale(conductor->multiple, scaling - 1));
    *f_cos = lanes_scale(lanes_mul(reflectance, scale), r.density * r.shadowing);
    *pdf_w = lanes_all(r.density);
}

bool conductor_sample(const BsdfConductor *conductor, Vec3f view, const float u[2], LobeSample *sample)
{
    if (!conductor->facets.smooth) return facets_sample_reflection(&conductor->facets, view, u, &sample->direction);
    sample->specular = true;
    sample->direction = mirrored(view);
    sample->value = conductor_reflectance(conductor, view.z);
    sample->density = lanes_all(1);
    return true;
}

/* ---- sheet ---- */

/* What the whole sheet reflects and transmits of light at an angle to it. Between its sides each polarization keeps to itself:
 * of each the sums of two geometric series, and the means of both. */
static void sheet_split(const BsdfSheet *sheet, float cosine, Lanes *reflected, Lanes *transmitted)
{
    Lanes through = lanes_all(1), once[2];
    if (sheet->tinted) {
        Lanes sine_square = lanes_div(lanes_all((1 - cosine) * (1 + cosine)), lanes_mul(sheet->eta, sheet->eta));
        Lanes inside = lanes_sqrt(lanes_clamp(lanes_rest(sine_square), 1e-6f, 1));
        through = lanes_exp(lanes_sub(lanes_all(0), lanes_div(sheet->depth, inside)));
    }
    if (sheet->filmed) {
        *reflected = thin_film_reflectance(&sheet->film, cosine, lanes_all(1), lanes_all(1), lanes_all(0));
        *transmitted = lanes_mul(lanes_rest(*reflected), through);
        return;
    }
    fresnel_dielectric_polarized(cosine, lanes_all(1), sheet->eta, once);
    *reflected = *transmitted = lanes_all(0);
    for (int i = 0; i < 2; i++) { /* what reflects all lets nothing in */
        Lanes rest = lanes_rest(once[i]), back = lanes_mul(once[i], through);
        Lanes entered = lanes_div(lanes_mul(lanes_mul(rest, rest), through),
                                  lanes_clamp(lanes_rest(lanes_mul(back, back)), 1e-12f, 1));
        *transmitted = lanes_add(*transmitted, lanes_scale(entered, 0.5f));
        *reflected = lanes_add(*reflected, lanes_scale(lanes_add(once[i], lanes_mul(entered, back)), 0.5f));
    }
}

void sheet_evaluate(const BsdfSheet *sheet, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    *f_cos = *pdf_w = lanes_all(0);
    if (sheet->facets.smooth || light.z == 0) return;
    bool through = light.z < 0;
    if (through) light.z = -light.z;
    FacetReflection r = facets_reflect(&sheet->facets, view, light);
    Lanes reflected, transmitted;
    sheet_split(sheet, float_min(r.cosine, 1), &reflected, &transmitted);
    Lanes taken = through ? transmitted : reflected, sum = lanes_add(reflected, transmitted);
    float scaling = mirrors_scaling(&sheet->mirrors, &sheet->facets, view, light, &r);
    *f_cos = lanes_scale(taken, r.density * r.shadowing * scaling);
    *pdf_w = lanes_scale(lanes_div(taken, lanes_add(sum, lanes_all(1e-30f))), r.density);
}

Lanes sheet_straight(const BsdfSheet *sheet, float cosine)
{
    Lanes reflected, transmitted;
    if (!sheet->facets.smooth) return lanes_all(0);
    sheet_split(sheet, cosine, &reflected, &transmitted);
    return transmitted;
}

bool sheet_sample(const BsdfSheet *sheet, Vec3f view, float u_choice, const float u[2], LobeSample *sample)
{
    float cosine = view.z;
    sample->direction = mirrored(view);
    if (!sheet->facets.smooth) {
        Vec3f h = microfacet_visible(sheet->facets.alpha_x, sheet->facets.alpha_y, view, u);
        sample->direction = vec3f_normalize(reflect_direction(vec3f_negate(view), h));
        cosine = vec3f_dot(view, h);
        if (!(sample->direction.z > 0)) return false;
    }
    Lanes reflected, transmitted;
    sheet_split(sheet, float_min(cosine, 1), &reflected, &transmitted);
    Lanes sum = lanes_add(lanes_add(reflected, transmitted), lanes_all(1e-30f));
    bool lean = sheet->facets.smooth && sheet->brightness[0] != sheet->brightness[1];
    Lanes chosen = lanes_div(reflected, sum);
    if (UNLIKELY(lean)) chosen = fresnel_choice(chosen, sheet->brightness[0], sheet->brightness[1]);
    bool back = lobe_choose(&u_choice, lanes_get(chosen, 0));
    if (!back) sample->direction.z = -sample->direction.z;
    if (!sheet->facets.smooth) return true;
    sample->specular = true;
    sample->value = back ? reflected : transmitted;
    sample->density = back ? chosen : lean ? lanes_rest(chosen) : lanes_div(transmitted, sum);
    return true;
}
