/* bsdf.c - a surface as a mixture of lobes: making them, and sampling and evaluating their sum.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf.h"

#include <stddef.h>

#include "optics/fresnel.h"

/* ---- making ---- */

void bsdf_begin(Bsdf *bsdf)
{
    bsdf->n_lobes = 0;
    bsdf->total = bsdf->opaque_share = bsdf->coat_share = 0;
    bsdf->transmits = false;
    bsdf->specular_only = true;
    bsdf->albedo = lanes_all(0);
}

static BsdfLobe *add_lobe(Bsdf *bsdf, BsdfKind kind, float share)
{
    if (!(share > 0) || bsdf->n_lobes == BSDF_LOBES) return NULL;
    BsdfLobe *lobe = &bsdf->lobes[bsdf->n_lobes++];
    lobe->kind = kind;
    lobe->share = share;
    bsdf->total += share;
    return lobe;
}

/* albedo: about, of an opaque lobe */
static void note_opaque(Bsdf *bsdf, float share, Lanes albedo, bool specular)
{
    bsdf->albedo = lanes_add(lanes_scale(bsdf->albedo, bsdf->opaque_share), lanes_scale(albedo, share));
    bsdf->opaque_share += share;
    bsdf->albedo = lanes_scale(bsdf->albedo, 1 / bsdf->opaque_share);
    if (!specular) bsdf->specular_only = false;
}

static BsdfDiffuse diffuse_make(Lanes albedo, float roughness)
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

static Lanes depth_of(Lanes transmittance) /* -ln, held finite */
{
    Lanes depth = lanes_all(0);
    for (int i = 0; i < LANES; i++) {
        float t = lanes_get(transmittance, i);
        lanes_set(&depth, i, t < 1 ? -logf(float_max(t, 1e-6f)) : 0);
    }
    return depth;
}

static BsdfLayer layer_make(Lanes eta, float alpha_x, float alpha_y, Lanes tint)
{
    BsdfLayer layer = {.facets = facets_make(alpha_x, alpha_y), .eta = eta};
    float used_x = layer.facets.smooth ? 0 : layer.facets.alpha_x,
          used_y = layer.facets.smooth ? 0 : layer.facets.alpha_y;
    layer.index = microfacet_index(used_x, used_y, eta);
    layer.depth = lanes_scale(depth_of(tint), 0.5f);
    layer.tinted = !lanes_zero(layer.depth);
    Lanes passed = lanes_rest(microfacet_lookup_mean(microfacet_reflected_mean, &layer.index, false));
    /* Reciprocity. Under a layer of the smaller index it can say more than all, as what one facet misses counts as
     * passed. */
    Lanes passed_back = lanes_clamp(lanes_div(passed, lanes_mul(eta, eta)), 0, 1);
    layer.norm = lanes_div(passed_back, lanes_add(passed, lanes_all(1e-12f)));
    layer.returned = lanes_rest(passed_back);
    if (layer.tinted) layer.returned = lanes_mul(layer.returned, lanes_exp(lanes_scale(layer.depth, -2)));
    return layer;
}

void bsdf_add_diffuse(Bsdf *bsdf, float share, Lanes albedo, float roughness)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_DIFFUSE, share);
    if (!lobe) return;
    lobe->as.diffuse = diffuse_make(albedo, roughness);
    note_opaque(bsdf, share, lobe->as.diffuse.albedo, false);
}

void bsdf_add_conductor(Bsdf *bsdf, float share, Lanes n, Lanes k, float alpha_x, float alpha_y)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_CONDUCTOR, share);
    if (!lobe) return;
    BsdfConductor *conductor = &lobe->as.conductor;
    conductor->facets = facets_make(alpha_x, alpha_y);
    conductor->n = n;
    conductor->k = k;
    conductor->mean = fresnel_conductor_mean(n, k);
    if (!conductor->facets.smooth) {
        conductor->roughness =
            microfacet_index(conductor->facets.alpha_x, conductor->facets.alpha_y, lanes_all(1)).roughness;
        float average = microfacet_mirror_albedo(conductor->roughness);
        /* second and later reflections: F a / (1 - F (1 - a)), as Kulla and Conty */
        Lanes series = lanes_rest(lanes_scale(conductor->mean, 1 - average));
        conductor->multiple = lanes_div(lanes_scale(conductor->mean, average), series);
    }
    note_opaque(bsdf, share, conductor->mean, conductor->facets.smooth);
}

void bsdf_add_plastic(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint, Lanes albedo,
                      float roughness)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_PLASTIC, share);
    if (!lobe) return;
    lobe->as.plastic.base = diffuse_make(albedo, roughness);
    lobe->as.plastic.layer = layer_make(eta, alpha_x, alpha_y, tint);
    note_opaque(bsdf, share, lobe->as.plastic.base.albedo, false);
}

void bsdf_add_sheet(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_SHEET, share);
    if (!lobe) return;
    BsdfSheet *sheet = &lobe->as.sheet;
    sheet->facets = facets_make(alpha_x, alpha_y);
    sheet->eta = eta;
    sheet->depth = depth_of(tint);
    sheet->tinted = !lanes_zero(sheet->depth);
    if (!sheet->facets.smooth) {
        sheet->roughness = microfacet_index(sheet->facets.alpha_x, sheet->facets.alpha_y, lanes_all(1)).roughness;
        bsdf->specular_only = false;
    }
    bsdf->transmits = true;
}

/* Refraction by rough facets blurs by about alpha |n - 1|. What is narrower than this is what rounding does to
 * directions, and goes straight on. */
#define BLUR_LIMIT 4e-6f

static bool find_blurred(BsdfBoundary *boundary)
{
    float apart = BLUR_LIMIT / float_min(boundary->facets.alpha_x, boundary->facets.alpha_y);
    for (int i = 0; i < LANES; i++) {
        float eta_i = lanes_get(boundary->eta_i, i);
        lanes_set(&boundary->blurred, i, fabsf(lanes_get(boundary->eta_t, i) - eta_i) < apart * eta_i ? 0.0f : 1.0f);
    }
    return !lanes_zero(boundary->blurred);
}

void bsdf_add_boundary(Bsdf *bsdf, float share, Lanes eta_i, Lanes eta_t, float alpha_x, float alpha_y)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_BOUNDARY, share);
    if (!lobe) return;
    BsdfBoundary *boundary = &lobe->as.boundary;
    boundary->facets = facets_make(alpha_x, alpha_y);
    boundary->eta_i = eta_i;
    boundary->eta_t = eta_t;
    bsdf->transmits = true;
    boundary->facets.smooth = boundary->facets.smooth || !find_blurred(boundary);
    if (boundary->facets.smooth) return;
    bsdf->specular_only = false;
    Lanes eta = lanes_div(boundary->eta_t, eta_i);
    MicrofacetIndex index = boundary->index = microfacet_index(boundary->facets.alpha_x, boundary->facets.alpha_y, eta);
    bool dense = lanes_mean(eta) < 1;
    float alpha = sqrtf(boundary->facets.alpha_x * boundary->facets.alpha_y);
    for (int through = 0; through <= 1; through++) {
        float a = boundary->spread[through] =
            dense != through ? float_min(alpha, index.critical * index.critical) : alpha;
        boundary->spread_norm[through] = 1 / (SAMPLING_PI * logf(1 + 1 / (a * a)));
    }
    Lanes here = microfacet_lookup_mean(microfacet_missing_mean, &index, false);
    Lanes there = microfacet_lookup_mean(microfacet_missing_mean, &index, true);
    /* Of diffuse light that is missing the part 1 - F (mean) should pass. With n_i^2 (1 - F_i) = n_t^2 (1 - F_t),
     * dividing by the larger of the two means makes the split reciprocal and at most that. Row 0 is the smooth
     * boundary. */
    index.roughness = (MicrofacetPlace){0, 0};
    for (int i = 0; i < LANES; i++) {
        MicrofacetIndex rare = index;
        rare.side[i] = 0;
        float n = lanes_get(eta, i),
              passed = 1 - lanes_get(microfacet_lookup_mean(microfacet_reflected_mean, &rare, false), i);
        if (n < 1) passed *= n * n;
        float mean_here = float_max(lanes_get(here, i), 1e-9f), mean_there = float_max(lanes_get(there, i), 1e-9f);
        float transmitted = passed * mean_there / float_max(mean_here, mean_there);
        lanes_set(&boundary->transmitted, i, transmitted);
        lanes_set(&boundary->reflected, i, 1 - transmitted);
        lanes_set(&boundary->transmitted_norm, i, transmitted / (SAMPLING_PI * mean_there));
        lanes_set(&boundary->reflected_norm, i, (1 - transmitted) / (SAMPLING_PI * mean_here));
    }
}

void bsdf_set_coat(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint)
{
    if (!(share > 0) || !(bsdf->opaque_share > 0)) return;
    bsdf->coat_share = float_min(share, 1);
    bsdf->coat = layer_make(eta, alpha_x, alpha_y, tint);
    if (!bsdf->coat.facets.smooth) bsdf->specular_only = false;
}

/* ---- the coat ---- */

typedef struct CoatView {
    Lanes reflectance, passed; /* of a direction */
} CoatView;

static CoatView coat_view(const Bsdf *bsdf, Vec3f w)
{
    Lanes reflectance = layer_reflectance(&bsdf->coat, w);
    return (CoatView){reflectance, layer_transmittance(&bsdf->coat, w, reflectance)};
}

/* What the coat, where it is, makes of a lobe's f_cos. */
static Lanes under_coat(const Bsdf *bsdf, const BsdfLobe *lobe, const CoatView *v, const CoatView *l)
{
    Lanes factor = lobe->kind == BSDF_CONDUCTOR
                       ? layer_over_mirror(&bsdf->coat, lobe->as.conductor.mean, v->reflectance, l->reflectance)
                       : layer_over_diffuse(&bsdf->coat, lobe->kind == BSDF_DIFFUSE ? lobe->as.diffuse.albedo
                                                                                    : lobe->as.plastic.base.albedo);
    Lanes coated = lanes_mul(factor, lanes_mul(v->passed, l->passed));
    return lanes_add(lanes_all(1 - bsdf->coat_share), lanes_scale(coated, bsdf->coat_share));
}

/* How often the coat is sampled rather than what is under it. */
static Lanes coat_chance(const Bsdf *bsdf, const CoatView *v)
{
    if (!(bsdf->coat_share > 0)) return lanes_all(0);
    return layer_chance(&bsdf->coat, bsdf->coat_share, v->reflectance, bsdf->albedo);
}

/* ---- the sum ---- */

static bool covered(const BsdfLobe *lobe) /* by a coat, and opaque */
{
    return lobe->kind == BSDF_DIFFUSE || lobe->kind == BSDF_CONDUCTOR || lobe->kind == BSDF_PLASTIC;
}

static void lobe_evaluate(const BsdfLobe *lobe, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    switch (lobe->kind) {
    case BSDF_DIFFUSE:
        *f_cos = diffuse_evaluate(&lobe->as.diffuse, view, light);
        *pdf_w = lanes_all(diffuse_density(&lobe->as.diffuse, light));
        break;
    case BSDF_CONDUCTOR: conductor_evaluate(&lobe->as.conductor, view, light, f_cos, pdf_w); break;
    case BSDF_PLASTIC: plastic_evaluate(&lobe->as.plastic, view, light, f_cos, pdf_w); break;
    case BSDF_BOUNDARY: boundary_evaluate(&lobe->as.boundary, view, light, f_cos, pdf_w); break;
    case BSDF_SHEET: sheet_evaluate(&lobe->as.sheet, view, light, f_cos, pdf_w); break;
    }
}

void bsdf_evaluate(const Bsdf *bsdf, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    *f_cos = *pdf_w = lanes_all(0);
    if (bsdf->specular_only || !(view.z > 0) || !(light.z > 0 || (bsdf->transmits && light.z < 0))) return;
    bool coated = bsdf->coat_share > 0 && light.z > 0;
    CoatView v = {lanes_all(0), lanes_all(1)}, l = v;
    Lanes base = lanes_all(1); /* chance of what is under the coat */
    if (coated) {
        v = coat_view(bsdf, view);
        l = coat_view(bsdf, light);
        Lanes chance = coat_chance(bsdf, &v), coat_f;
        base = lanes_rest(chance);
        float coat_pdf;
        layer_evaluate(&bsdf->coat, view, light, &coat_f, &coat_pdf);
        *f_cos = lanes_scale(coat_f, bsdf->opaque_share * bsdf->coat_share);
        *pdf_w = lanes_scale(chance, coat_pdf * bsdf->opaque_share);
    }
    for (uint32_t i = 0; i < bsdf->n_lobes; i++) {
        const BsdfLobe *lobe = &bsdf->lobes[i];
        bool under = covered(lobe);
        if (under && !(light.z > 0)) continue;
        Lanes f, pdf;
        lobe_evaluate(lobe, view, light, &f, &pdf);
        if (under && coated) {
            f = lanes_mul(f, under_coat(bsdf, lobe, &v, &l));
            pdf = lanes_mul(pdf, base);
        }
        *f_cos = lanes_add(*f_cos, lanes_scale(f, lobe->share));
        *pdf_w = lanes_add(*pdf_w, lanes_scale(pdf, lobe->share));
    }
    *pdf_w = lanes_scale(*pdf_w, 1 / bsdf->total);
}

static const BsdfLobe *choose_lobe(const Bsdf *bsdf, float *u_choice)
{
    float left = bsdf->total;
    for (uint32_t i = 0; i + 1 < bsdf->n_lobes; i++) {
        if (lobe_choose(u_choice, bsdf->lobes[i].share / left)) return &bsdf->lobes[i];
        left -= bsdf->lobes[i].share;
    }
    return &bsdf->lobes[bsdf->n_lobes - 1];
}

static bool lobe_sample(const BsdfLobe *lobe, Vec3f view, float u_choice, const float u[2], LobeSample *sample)
{
    switch (lobe->kind) {
    case BSDF_DIFFUSE: sample->direction = diffuse_sample(&lobe->as.diffuse, u_choice, u); return true;
    case BSDF_CONDUCTOR: return conductor_sample(&lobe->as.conductor, view, u, sample);
    case BSDF_PLASTIC: return plastic_sample(&lobe->as.plastic, view, u_choice, u, sample);
    case BSDF_BOUNDARY: return boundary_sample(&lobe->as.boundary, view, u_choice, u, sample);
    case BSDF_SHEET: return sheet_sample(&lobe->as.sheet, view, u_choice, u, sample);
    }
    return false;
}

/* One sample of the chosen lobe or of the coat over it; a specular one's value and density are those within the whole.
 */
static bool sample_part(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, float u_choice, const float u[2],
                        LobeSample *sample)
{
    bool coated = bsdf->coat_share > 0 && covered(lobe);
    CoatView v = {lanes_all(0), lanes_all(1)};
    Lanes chance = lanes_all(0);
    float share = lobe->share;
    if (coated) {
        v = coat_view(bsdf, view);
        chance = coat_chance(bsdf, &v);
    }
    if (coated && lobe_choose(&u_choice, lanes_get(chance, 0))) {
        if (!bsdf->coat.facets.smooth) return facets_sample_reflection(&bsdf->coat.facets, view, u, &sample->direction);
        sample->specular = true;
        sample->direction = mirrored(view);
        sample->value = lanes_scale(v.reflectance, bsdf->coat_share);
        sample->density = chance;
        share = bsdf->opaque_share;
    } else {
        if (!lobe_sample(lobe, view, u_choice, u, sample)) return false;
        if (!sample->specular) return true;
        if (coated) {
            sample->value = lanes_mul(sample->value, under_coat(bsdf, lobe, &v, &v));
            sample->density = lanes_mul(sample->density, lanes_rest(chance));
        }
    }
    sample->value = lanes_scale(sample->value, share);
    sample->density = lanes_scale(sample->density, share / bsdf->total);
    return true;
}

bool bsdf_sample(const Bsdf *bsdf, Vec3f view, float u_choice, const float u[2], BsdfSample *sample)
{
    if (!bsdf->n_lobes || !(view.z > 0)) return false;
    LobeSample part = {.specular = false};
    const BsdfLobe *lobe = choose_lobe(bsdf, &u_choice);
    if (!sample_part(bsdf, lobe, view, u_choice, u, &part)) return false;
    if (!part.specular) bsdf_evaluate(bsdf, view, part.direction, &part.value, &part.density);
    float hero = lanes_get(part.density, 0);
    if (!(hero > 0)) return false;
    sample->direction = part.direction;
    sample->specular = part.specular;
    sample->transmitted = part.direction.z < 0;
    sample->hero_only = part.hero_only;
    sample->weight = lanes_div(part.value, lanes_all(hero));
    sample->pdf_w = part.density;
    return true;
}
