/* bsdf.c - a surface as a mixture of lobes: making them, and sampling and evaluating their sum.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/bsdf.h"

#include <stddef.h>

#include "base/attr.h"
#include "optics/fresnel.h"

/* ---- making ---- */

void bsdf_begin(Bsdf *bsdf)
{
    bsdf->n_lobes = 0;
    bsdf->total = bsdf->opaque_share = bsdf->coat_share = bsdf->fuzz.share = 0;
    bsdf->transmits = bsdf->coating = bsdf->looked = false;
    bsdf->specular_only = true;
    bsdf->balance = NULL;
    bsdf->opaque_albedo = bsdf->coat_albedo = lanes_all(0);
}

void bsdf_set_balance(Bsdf *bsdf, const Balance *balance)
{
    bsdf->balance = balance;
}

static BsdfLobe *add_lobe(Bsdf *bsdf, BsdfKind kind, float share)
{
    if (!(share > 0) || bsdf->n_lobes == BSDF_LOBES) return NULL;
    BsdfLobe *lobe = &bsdf->lobes[bsdf->n_lobes++];
    lobe->kind = kind;
    lobe->share = share;
    lobe->covered = false;
    lobe->fuzz_norm = 1;
    lobe->balance = NULL;
    bsdf->total += share;
    return lobe;
}

/* albedo: about, of an opaque lobe */
static void note_opaque(Bsdf *bsdf, BsdfLobe *lobe, Lanes albedo, bool specular)
{
    Lanes part = lanes_scale(albedo, lobe->share);
    bsdf->opaque_albedo = lanes_add(bsdf->opaque_albedo, part);
    bsdf->opaque_share += lobe->share;
    if (bsdf->coating) {
        lobe->covered = true;
        bsdf->coat_albedo = lanes_add(bsdf->coat_albedo, part);
        bsdf->coat_share += lobe->share;
        if (!bsdf->coat->facets.smooth) bsdf->specular_only = false;
    }
    if (!specular) bsdf->specular_only = false;
}

void bsdf_add_diffuse(Bsdf *bsdf, float share, Lanes albedo, float roughness)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_DIFFUSE, share);
    if (!lobe) return;
    lobe->as.diffuse = diffuse_make(albedo, roughness);
    const Balance *balance = bsdf->balance;
    if (bsdf->coating && balance && balance->coated_diffuse) lobe->balance = &balance->to_coated_diffuse;
    note_opaque(bsdf, lobe, lobe->as.diffuse.albedo, false);
}

void bsdf_add_translucent(Bsdf *bsdf, float share, Lanes albedo)
{
    bool coating = bsdf->coating;
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_TRANSLUCENT, share);
    if (!lobe) return;
    lobe->as.diffuse = diffuse_make(albedo, 0);
    bsdf->coating = false;
    note_opaque(bsdf, lobe, lobe->as.diffuse.albedo, false);
    bsdf->coating = coating;
    bsdf->transmits = true;
}

static void add_facets(Bsdf *bsdf, float share, const BsdfConductor *like, float alpha_x, float alpha_y)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_CONDUCTOR, share);
    if (!lobe) return;
    BsdfConductor *conductor = &lobe->as.conductor;
    *conductor = *like;
    const Balance *balance = bsdf->balance;
    conductor->balanced = balance && (bsdf->coating ? balance->coated_metal : balance->bare_metal);
    if (conductor->balanced) lobe->balance = bsdf->coating ? &balance->to_coated_metal : &balance->to_bare_metal;
    conductor->facets = facets_make(alpha_x, alpha_y);
    if (!conductor->facets.smooth) {
        conductor->mirrors = mirrors_make(&conductor->facets);
        float average = microfacet_mirror_albedo(conductor->mirrors.roughness);
        /* second and later reflections: F a / (1 - F (1 - a)), as Kulla and Conty */
        Lanes series = lanes_rest(lanes_scale(conductor->mean, 1 - average));
        conductor->multiple = lanes_div(lanes_scale(conductor->mean, average), series);
    }
    note_opaque(bsdf, lobe, conductor->mean, conductor->facets.smooth);
}

void bsdf_add_conductor(Bsdf *bsdf, float share, Lanes n, Lanes k, float alpha_x, float alpha_y, const ThinFilm *film)
{
    BsdfConductor conductor = {.n = n, .k = k, .filmed = film != NULL};
    if (film) conductor.film = *film;
    conductor.mean = film ? thin_film_mean_reflectance(film, lanes_all(1), n, k) : fresnel_conductor_mean(n, k);
    add_facets(bsdf, share, &conductor, alpha_x, alpha_y);
}

void bsdf_add_mirrors(Bsdf *bsdf, float share, float alpha_x, float alpha_y)
{
    add_facets(bsdf, share, &(BsdfConductor){.mean = lanes_all(1), .white = true}, alpha_x, alpha_y);
}

void bsdf_add_plastic(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint, Lanes albedo,
                      float roughness)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_PLASTIC, share);
    if (!lobe) return;
    BsdfPlastic *plastic = &lobe->as.plastic;
    plastic->base = diffuse_make(albedo, roughness);
    const Balance *balance = bsdf->balance;
    if (balance && balance->plastic_base) lobe->balance = &balance->to_plastic_base;
    layer_make(eta, alpha_x, alpha_y, tint, balance && balance->skin ? &balance->skin_reflects : NULL, &plastic->own);
    if (plastic->base.roughness > 0) layer_find_among(&plastic->own);
    plastic->layer = &plastic->own;
    note_opaque(bsdf, lobe, plastic->base.albedo, false);
}

void bsdf_add_plastic_kept(Bsdf *bsdf, float share, const BsdfLayer *skin, Lanes albedo, float roughness)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_PLASTIC, share);
    if (!lobe) return;
    lobe->as.plastic.base = diffuse_make(albedo, roughness);
    lobe->as.plastic.layer = skin;
    note_opaque(bsdf, lobe, lobe->as.plastic.base.albedo, false);
}

void bsdf_add_sheet(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint, const ThinFilm *film)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_SHEET, share);
    if (!lobe) return;
    BsdfSheet *sheet = &lobe->as.sheet;
    sheet->facets = facets_make(alpha_x, alpha_y);
    sheet->eta = eta;
    sheet->depth = layer_depth(tint);
    sheet->tinted = !lanes_zero(sheet->depth);
    sheet->filmed = film != NULL;
    if (film) sheet->film = *film;
    sheet->brightness[0] = sheet->brightness[1] = 1;
    if (!sheet->facets.smooth) {
        sheet->mirrors = mirrors_make(&sheet->facets);
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

void bsdf_add_boundary(Bsdf *bsdf, float share, Lanes eta_i, Lanes eta_t, float alpha_x, float alpha_y,
                       const ThinFilm *film)
{
    BsdfLobe *lobe = add_lobe(bsdf, BSDF_BOUNDARY, share);
    if (!lobe) return;
    BsdfBoundary *boundary = &lobe->as.boundary;
    boundary->facets = facets_make(alpha_x, alpha_y);
    boundary->known[0] = boundary->known[1] = NULL;
    boundary->filmed = film != NULL;
    if (film) boundary->film = *film;
    boundary->eta_i = eta_i;
    boundary->eta_t = eta_t;
    bsdf->transmits = true;
    boundary->facets.smooth = boundary->facets.smooth || film || !find_blurred(boundary);
    if (boundary->facets.smooth) return;
    bsdf->specular_only = false;
    Lanes eta = lanes_div(boundary->eta_t, eta_i);
    const BsdfFacets *facets = &boundary->facets;
    facets_index(facets, eta, &boundary->index);
    MicrofacetIndex round = *facets_round_index(facets, &boundary->index);
    bool dense = lanes_mean(eta) < 1;
    for (int through = 0; through <= 1; through++) {
        float a = boundary->spread[through] =
            dense != through ? float_min(round.alpha, round.critical * round.critical) : round.alpha;
        boundary->spread_norm[through] = 1 / (SAMPLING_PI * logf(1 + 1 / (a * a)));
    }
    Lanes means[2];
    for (int side = 0; side <= 1; side++) {
        const Balance *balance = bsdf->balance;
        const BsdfKnown *known = balance && balance->boundary ? &balance->boundary_misses[side] : NULL;
        boundary->known[side] = known;
        means[side] = known ? lanes_all(known->mean) : facets_missing_mean(facets, &boundary->index, side);
    }
    Lanes here = means[0], there = means[1];
    /* Of diffuse light that is missing the part 1 - F (mean) should pass. With n_i^2 (1 - F_i) = n_t^2 (1 - F_t),
     * dividing by the larger of the two means makes the split reciprocal and at most that. Row 0 is the smooth
     * boundary. */
    round.roughness = (MicrofacetPlace){0, 0};
    for (int i = 0; i < LANES; i++) round.side[i] = 0;
    Lanes smooth = microfacet_lookup_mean(microfacet_reflected_mean, &round, false);
    for (int i = 0; i < LANES; i++) {
        float n = lanes_get(eta, i), passed = 1 - lanes_get(smooth, i);
        if (n < 1) passed *= n * n;
        float mean_here = float_max(lanes_get(here, i), 1e-9f), mean_there = float_max(lanes_get(there, i), 1e-9f);
        float transmitted = passed * mean_there / float_max(mean_here, mean_there);
        lanes_set(&boundary->transmitted, i, transmitted);
        lanes_set(&boundary->reflected, i, 1 - transmitted);
        lanes_set(&boundary->transmitted_norm, i, transmitted / (SAMPLING_PI * mean_there));
        lanes_set(&boundary->reflected_norm, i, (1 - transmitted) / (SAMPLING_PI * mean_here));
    }
}

void bsdf_begin_coat(Bsdf *bsdf, Lanes eta, float alpha_x, float alpha_y, Lanes tint)
{
    const Balance *balance = bsdf->balance;
    layer_make(eta, alpha_x, alpha_y, tint, balance && balance->coat ? &balance->coat_reflects : NULL, &bsdf->own_coat);
    layer_find_among(&bsdf->own_coat);
    bsdf_begin_coat_kept(bsdf, &bsdf->own_coat);
}

void bsdf_begin_coat_kept(Bsdf *bsdf, const BsdfLayer *coat)
{
    bsdf->coating = true;
    bsdf->coat = coat;
}

void bsdf_end_coat(Bsdf *bsdf)
{
    bsdf->coating = false;
}

/* ---- what is over the lobes ---- */

static bool is_covered(const Bsdf *bsdf)
{
    return bsdf->coat_share > 0 || bsdf->fuzz.share > 0;
}
/* What is true where nothing is. */
static const BsdfCovers no_covers = {.passed = {{1, 1, 1, 1}}, .fuzz = 1, .skin = 1};
static const BsdfChances no_chances = {.fuzz = 0};

static BsdfCovers covers_at(const Bsdf *bsdf, Vec3f w)
{
    BsdfCovers covers = {lanes_all(0), lanes_all(1), 1, 1};
    if (bsdf->coat_share > 0 && w.z > 0) {
        covers.reflectance = layer_reflectance(bsdf->coat, w);
        covers.passed = layer_transmittance(bsdf->coat, w, covers.reflectance);
    }
    if (!(bsdf->fuzz.share > 0)) return covers;
    covers.fuzz = 1 - fuzz_albedo(&bsdf->fuzz, w);
    if (bsdf->coat_share > 0 && w.z > 0) covers.skin = fuzz_to_base(&bsdf->fuzz, bsdf->coat, w);
    return covers;
}

const BsdfLayer *bsdf_layer_over(const Bsdf *bsdf, const BsdfLobe *lobe)
{
    return lobe->kind == BSDF_PLASTIC ? lobe->as.plastic.layer : lobe->covered ? bsdf->coat : NULL;
}

/* Over what is diffuse f T(v) T(l) / mean T; the mean is that of all layers together. */
static float fuzz_norm(const Bsdf *bsdf, const BsdfLobe *lobe)
{
    /* Gauss's six points in the cosine */
    static const float cosines[] = {0.0337652f, 0.1693953f, 0.3806904f, 0.6193096f, 0.8306047f, 0.9662348f};
    static const float weights[] = {0.0856622f, 0.1803808f, 0.2339570f, 0.2339570f, 0.1803808f, 0.0856622f};
    const BsdfLayer *layer = bsdf_layer_over(bsdf, lobe);
    float without = 0, with = 0;
    for (int i = 0; i < 6; i++) {
        float aside = sqrtf(0.5f * (1 - cosines[i] * cosines[i]));
        Vec3f w = vec3f(aside, aside, cosines[i]);
        float part = 2 * cosines[i] * weights[i];
        if (layer) part *= 1 - lanes_mean(layer_reflectance(layer, w));
        without += part;
        with += part * (1 - fuzz_albedo(&bsdf->fuzz, w)) * (layer ? fuzz_to_base(&bsdf->fuzz, layer, w) : 1);
    }
    return with > 0 ? without / with : 1;
}

void bsdf_set_fuzz(Bsdf *bsdf, float share, Lanes color, float roughness)
{
    if (!(share > 0) || !(bsdf->opaque_share > 0)) return;
    bsdf->fuzz = fuzz_make(float_min(share, 1), color, roughness);
    bsdf->specular_only = false;
    for (uint32_t i = 0; i < bsdf->n_lobes; i++) {
        BsdfLobe *lobe = &bsdf->lobes[i];
        if (lobe->kind == BSDF_PLASTIC && lobe->as.plastic.layer == &lobe->as.plastic.own)
            layer_find_among(&lobe->as.plastic.own);
        if (lobe->kind == BSDF_DIFFUSE || lobe->kind == BSDF_TRANSLUCENT || lobe->kind == BSDF_PLASTIC)
            lobe->fuzz_norm = fuzz_norm(bsdf, lobe);
    }
}

static bool is_clear(const BsdfLobe *lobe)
{
    return lobe->kind == BSDF_BOUNDARY || lobe->kind == BSDF_SHEET;
}

static BsdfChances chances_of(const Bsdf *bsdf, const BsdfCovers *v)
{
    BsdfChances chances = {0, lanes_all(0)};
    if (bsdf->fuzz.share > 0) {
        float fuzz = (1 - v->fuzz) * lanes_mean(bsdf->fuzz.color);
        chances.fuzz = fuzz / (fuzz + v->fuzz * float_max(lanes_mean(bsdf->opaque_albedo) / bsdf->opaque_share, 0.05f));
    }
    if (bsdf->coat_share > 0)
        chances.coat =
            layer_chance(bsdf->coat, 1, v->reflectance, lanes_scale(bsdf->coat_albedo, 1 / bsdf->coat_share));
    return chances;
}

/* The probabilities with which bsdf_sample takes fuzz, coat, and a lobe. */
static float fuzz_probability(const Bsdf *bsdf, const BsdfChances *chances)
{
    return chances->fuzz * (bsdf->opaque_share / bsdf->total);
}
static Lanes coat_probability(const Bsdf *bsdf, const BsdfChances *chances)
{
    return lanes_scale(chances->coat, (1 - chances->fuzz) * (bsdf->coat_share / bsdf->total));
}
static Lanes lobe_probability(const Bsdf *bsdf, const BsdfLobe *lobe, const BsdfChances *chances)
{
    float share = lobe->share / bsdf->total;
    if (!is_clear(lobe)) share *= 1 - chances->fuzz;
    return lobe->covered ? lanes_scale(lanes_rest(chances->coat), share) : lanes_all(share);
}

/* ---- the sum ---- */

static bool is_looked_at(const Bsdf *bsdf, Vec3f view)
{
    return bsdf->looked && view.x == bsdf->view.x && view.y == bsdf->view.y && view.z == bsdf->view.z;
}

static float balance_of(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view)
{
    return is_looked_at(bsdf, view) ? lobe->balance_seen : direction_grid_at(lobe->balance, view);
}

static const BsdfFacets *facets_of(const BsdfLobe *lobe) /* NULL: none that reflect by themselves */
{
    return lobe->kind == BSDF_CONDUCTOR ? &lobe->as.conductor.facets
           : lobe->kind == BSDF_PLASTIC ? &lobe->as.plastic.layer->facets
                                        : NULL;
}

/* What of a lobe's light is under fuzz, and the balance. */
static LobeOver lobe_over(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, Vec3f light, const BsdfCovers *v,
                          const BsdfCovers *l)
{
    const BsdfFuzz *fuzz = &bsdf->fuzz;
    LobeOver over = {1, lobe->fuzz_norm};
    if (lobe->balance) {
        float balance = balance_of(bsdf, lobe, view) * direction_grid_at(lobe->balance, light);
        over.diffuse *= balance;
        if (lobe->kind == BSDF_CONDUCTOR) over.mirror = balance;
    }
    if (!(fuzz->share > 0)) return over;
    const BsdfFacets *facets = facets_of(lobe);
    if (facets)
        over.mirror *= fuzz_to_mirrors(fuzz, facets, view, v->fuzz) * fuzz_to_mirrors(fuzz, facets, light, l->fuzz);
    if (lobe->kind == BSDF_CONDUCTOR) {
        if (lobe->covered) over.mirror *= sqrtf(v->skin * l->skin);
        return over;
    }
    float roughness = lobe->kind == BSDF_PLASTIC ? lobe->as.plastic.base.roughness : lobe->as.diffuse.roughness;
    over.diffuse *= fuzz_to_diffuse(fuzz, roughness, view, v->fuzz) * fuzz_to_diffuse(fuzz, roughness, light, l->fuzz);
    if (lobe->covered) over.diffuse *= v->skin * l->skin;
    if (lobe->kind == BSDF_PLASTIC) {
        const BsdfLayer *layer = lobe->as.plastic.layer;
        over.diffuse *= fuzz_to_base(fuzz, layer, view) * fuzz_to_base(fuzz, layer, light);
    }
    return over;
}

static Lanes coat_over_mirrors(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, Vec3f light, const BsdfCovers *v,
                               const BsdfCovers *l)
{
    return layer_over_mirrors(bsdf->coat, &lobe->as.conductor, view, light, v->reflectance, l->reflectance, v->passed,
                              l->passed);
}

static Lanes diffuse_under_covers(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, Vec3f light, const BsdfCovers *v,
                                  const BsdfCovers *l)
{
    const BsdfDiffuse *diffuse = &lobe->as.diffuse;
    Lanes f = lanes_scale(diffuse_evaluate(diffuse, view, light), lobe_over(bsdf, lobe, view, light, v, l).diffuse);
    if (!lobe->covered) return f;
    f = lanes_mul(f, lanes_mul(v->passed, l->passed));
    f = lanes_mul(f, layer_over_rough_diffuse(bsdf->coat, diffuse->roughness, view, light));
    return lanes_mul(f, layer_over_diffuse(bsdf->coat, diffuse->albedo));
}

float bsdf_cover_factor(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f w)
{
    BsdfCovers covers = covers_at(bsdf, w);
    LobeOver over = lobe_over(bsdf, lobe, w, w, &covers, &covers);
    if (lobe->kind == BSDF_CONDUCTOR) {
        float coat = lobe->covered ? lanes_get(coat_over_mirrors(bsdf, lobe, w, w, &covers, &covers), 0) : 1;
        return sqrtf(over.mirror * coat);
    }
    const BsdfLayer *layer = bsdf_layer_over(bsdf, lobe);
    if (!layer) return sqrtf(over.diffuse);
    float roughness = lobe->kind == BSDF_PLASTIC ? lobe->as.plastic.base.roughness : lobe->as.diffuse.roughness;
    Lanes passed = layer_transmittance(layer, w, layer_reflectance(layer, w));
    Lanes both = lanes_mul(layer_over_diffuse(layer, lanes_all(1)), layer_over_rough_diffuse(layer, roughness, w, w));
    return lanes_get(passed, 0) * sqrtf(over.diffuse * lanes_get(both, 0));
}

static Lanes lobe_see(const BsdfLobe *lobe, Vec3f view)
{
    if (lobe->kind == BSDF_PLASTIC) return layer_reflectance(lobe->as.plastic.layer, view);
    if (lobe->kind == BSDF_BOUNDARY && !lobe->as.boundary.facets.smooth)
        return boundary_missing(&lobe->as.boundary, false, view);
    return lanes_all(0);
}

void bsdf_set_brightness(Bsdf *bsdf, const float brightness[2])
{
    for (uint32_t i = 0; i < bsdf->n_lobes; i++)
        for (int k = 0; k < 2 && bsdf->lobes[i].kind == BSDF_SHEET; k++)
            bsdf->lobes[i].as.sheet.brightness[k] = brightness[k];
}

void bsdf_look(Bsdf *bsdf, Vec3f view)
{
    for (uint32_t i = 0; i < bsdf->n_lobes; i++) {
        BsdfLobe *lobe = &bsdf->lobes[i];
        lobe->seen = lobe_see(lobe, view);
        if (lobe->balance) lobe->balance_seen = direction_grid_at(lobe->balance, view);
    }
    bsdf->view = view;
    bsdf->looked = true;
    if (!is_covered(bsdf)) return;
    bsdf->covers = covers_at(bsdf, view);
    bsdf->chances = chances_of(bsdf, &bsdf->covers);
}

static Lanes seen_by(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view)
{
    return is_looked_at(bsdf, view) ? lobe->seen : lobe_see(lobe, view);
}

static void lobe_evaluate(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, Vec3f light, const BsdfCovers *v,
                          const BsdfCovers *l, Lanes *f_cos, Lanes *pdf_w)
{
    bool below = light.z < 0;
    *f_cos = *pdf_w = lanes_all(0);
    switch (lobe->kind) {
    case BSDF_DIFFUSE:
        if (below) return;
        *f_cos = diffuse_under_covers(bsdf, lobe, view, light, v, l);
        *pdf_w = lanes_all(diffuse_density(&lobe->as.diffuse, light));
        break;
    case BSDF_TRANSLUCENT:
        if (!below) return;
        *pdf_w = lanes_all(-light.z / SAMPLING_PI);
        *f_cos =
            lanes_scale(lanes_mul(lobe->as.diffuse.albedo, *pdf_w), lobe_over(bsdf, lobe, view, light, v, l).diffuse);
        break;
    case BSDF_CONDUCTOR:
        if (below) return;
        conductor_evaluate(&lobe->as.conductor, view, light, f_cos, pdf_w);
        if (lobe->covered) *f_cos = lanes_mul(*f_cos, coat_over_mirrors(bsdf, lobe, view, light, v, l));
        *f_cos = lanes_scale(*f_cos, lobe_over(bsdf, lobe, view, light, v, l).mirror);
        break;
    case BSDF_PLASTIC:
        if (below) return;
        plastic_evaluate(&lobe->as.plastic, view, light, seen_by(bsdf, lobe, view),
                         lobe_over(bsdf, lobe, view, light, v, l), f_cos, pdf_w);
        break;
    case BSDF_BOUNDARY:
        boundary_evaluate(&lobe->as.boundary, view, light, seen_by(bsdf, lobe, view), f_cos, pdf_w);
        break;
    case BSDF_SHEET: sheet_evaluate(&lobe->as.sheet, view, light, f_cos, pdf_w); break;
    }
}

/* The lobes' sum begins with what is over them; light.z > 0. */
static void covers_evaluate(const Bsdf *bsdf, Vec3f view, Vec3f light, const BsdfCovers *v, const BsdfCovers *l,
                            const BsdfChances *chances, Lanes *f_cos, Lanes *pdf_w)
{
    Lanes f;
    float pdf;
    if (bsdf->fuzz.share > 0) {
        fuzz_evaluate(&bsdf->fuzz, view, light, &f, &pdf);
        *f_cos = lanes_scale(f, bsdf->opaque_share);
        *pdf_w = lanes_all(pdf * fuzz_probability(bsdf, chances));
    }
    if (bsdf->coat_share > 0) {
        layer_evaluate(bsdf->coat, view, light, &f, &pdf);
        float over = 1;
        if (bsdf->fuzz.share > 0)
            over = fuzz_to_mirrors(&bsdf->fuzz, &bsdf->coat->facets, view, v->fuzz) *
                   fuzz_to_mirrors(&bsdf->fuzz, &bsdf->coat->facets, light, l->fuzz);
        *f_cos = lanes_add(*f_cos, lanes_scale(f, bsdf->coat_share * over));
        *pdf_w = lanes_add(*pdf_w, lanes_scale(coat_probability(bsdf, chances), pdf));
    }
}

/* What covers the lobes for a view, and how often that is sampled. */
typedef struct Cover {
    const BsdfCovers *covers;
    const BsdfChances *chances;
    BsdfCovers own_covers; /* where they are not kept */
    BsdfChances own_chances;
} Cover;

static inline void find_cover(const Bsdf *bsdf, Vec3f view, Cover *cover)
{
    cover->covers = &no_covers;
    cover->chances = &no_chances;
    if (LIKELY(!is_covered(bsdf))) return;
    cover->covers = &bsdf->covers;
    cover->chances = &bsdf->chances;
    if (is_looked_at(bsdf, view)) return;
    cover->own_covers = covers_at(bsdf, view);
    cover->own_chances = chances_of(bsdf, &cover->own_covers);
    cover->covers = &cover->own_covers;
    cover->chances = &cover->own_chances;
}

void bsdf_evaluate(const Bsdf *bsdf, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w)
{
    *f_cos = *pdf_w = lanes_all(0);
    if (bsdf->specular_only || !(view.z > 0) || !(light.z > 0 || (bsdf->transmits && light.z < 0))) return;
    Cover cover;
    BsdfCovers below;
    const BsdfCovers *l = &no_covers;
    find_cover(bsdf, view, &cover);
    if (UNLIKELY(is_covered(bsdf))) {
        below = covers_at(bsdf, light);
        l = &below;
        if (light.z > 0) covers_evaluate(bsdf, view, light, cover.covers, l, cover.chances, f_cos, pdf_w);
    }
    for (uint32_t i = 0; i < bsdf->n_lobes; i++) {
        const BsdfLobe *lobe = &bsdf->lobes[i];
        Lanes f, pdf;
        lobe_evaluate(bsdf, lobe, view, light, cover.covers, l, &f, &pdf);
        *f_cos = lanes_add(*f_cos, lanes_scale(f, lobe->share));
        *pdf_w = lanes_add(*pdf_w, lanes_mul(pdf, lobe_probability(bsdf, lobe, cover.chances)));
    }
}

Lanes bsdf_straight(const Bsdf *bsdf, float cosine)
{
    Lanes sum = lanes_all(0);
    for (uint32_t i = 0; i < bsdf->n_lobes; i++)
        if (bsdf->lobes[i].kind == BSDF_SHEET)
            sum = lanes_add(sum, lanes_scale(sheet_straight(&bsdf->lobes[i].as.sheet, cosine), bsdf->lobes[i].share));
    return sum;
}

static bool lobe_sample(const Bsdf *bsdf, const BsdfLobe *lobe, Vec3f view, float u_choice, const float u[2],
                        LobeSample *sample)
{
    switch (lobe->kind) {
    case BSDF_DIFFUSE: sample->direction = diffuse_sample(&lobe->as.diffuse, u_choice, u); return true;
    case BSDF_TRANSLUCENT:
        sample->direction = diffuse_sample(&lobe->as.diffuse, u_choice, u);
        sample->direction.z = -sample->direction.z;
        return true;
    case BSDF_CONDUCTOR: return conductor_sample(&lobe->as.conductor, view, u, sample);
    case BSDF_PLASTIC: return plastic_sample(&lobe->as.plastic, view, seen_by(bsdf, lobe, view), u_choice, u, sample);
    case BSDF_BOUNDARY: return boundary_sample(&lobe->as.boundary, view, u_choice, u, sample);
    case BSDF_SHEET: return sheet_sample(&lobe->as.sheet, view, u_choice, u, sample);
    }
    return false;
}

/* Takes what `left` of a probability is for, out of what is left of all. */
static bool take(float *u_choice, float *left, float probability)
{
    bool taken = lobe_choose(u_choice, float_min(probability / *left, 1));
    *left -= probability;
    return taken;
}

/* One sample; a specular one's value and density are those within the whole. */
static bool sample_part(const Bsdf *bsdf, Vec3f view, float u_choice, const float u[2], LobeSample *sample)
{
    Cover cover;
    find_cover(bsdf, view, &cover);
    const BsdfCovers *v = cover.covers;
    const BsdfChances *chances = cover.chances;
    float left = 1;
    if (chances->fuzz > 0 && take(&u_choice, &left, fuzz_probability(bsdf, chances))) {
        sample->direction = fuzz_sample(u_choice, u);
        return true;
    }
    Lanes coat = coat_probability(bsdf, chances);
    if (bsdf->coat_share > 0 && take(&u_choice, &left, lanes_get(coat, 0))) {
        if (!bsdf->coat->facets.smooth)
            return facets_sample_reflection(&bsdf->coat->facets, view, u, &sample->direction);
        sample->specular = true;
        sample->direction = mirrored(view);
        sample->value = lanes_scale(v->reflectance, bsdf->coat_share * v->fuzz);
        sample->density = coat;
        return true;
    }
    const BsdfLobe *lobe = bsdf->lobes;
    for (uint32_t i = 0; i + 1 < bsdf->n_lobes; i++, lobe++)
        if (take(&u_choice, &left, lanes_get(lobe_probability(bsdf, lobe, chances), 0))) break;
    if (!lobe_sample(bsdf, lobe, view, u_choice, u, sample)) return false;
    if (!sample->specular) return true;
    if (lobe->covered) sample->value = lanes_mul(sample->value, coat_over_mirrors(bsdf, lobe, view, view, v, v));
    sample->value = lanes_scale(sample->value, lobe->share * (is_clear(lobe) ? 1 : v->fuzz));
    sample->density = lanes_mul(sample->density, lobe_probability(bsdf, lobe, chances));
    return true;
}

bool bsdf_sample(const Bsdf *bsdf, Vec3f view, float u_choice, const float u[2], BsdfSample *sample)
{
    if (!bsdf->n_lobes || !(view.z > 0)) return false;
    LobeSample part = {.specular = false};
    if (!sample_part(bsdf, view, u_choice, u, &part)) return false;
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
