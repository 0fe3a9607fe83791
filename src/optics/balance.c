/* balance.c - summing what the tables leave over of one surface's light.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/balance.h"

#include <stdlib.h>

#include "optics/facet_sums.h"

/* Lattices of ways under covers. FINE: steps of a knot's distance in which covers are looked up. */
enum { WAYS = 987, WAY_STRIDE = 610, FEW_WAYS = 377, FEW_STRIDE = 233, FINE = 8, ROUNDS = 16 };
/* Knots for what is under covers, at most. */
enum { AZIMUTHS = 13, COSINES = 33, KNOTS = AZIMUTHS * COSINES };

static DirectionEdge edge_of(const BsdfFacets *facets, float eta)
{
    float critical = eta < 1 ? microfacet_critical(eta) : -1;
    float least = MICROFACET_SMOOTH_ALPHA; /* smooth ones have no alphas */
    return (DirectionEdge){critical, float_max(facets->alpha_x, least), float_max(facets->alpha_y, least)};
}

static const DirectionEdge no_edge = {-1, 0, 0};

static float stretch_of(const BsdfFacets *facets)
{
    return facets->smooth ? 1 : facets->alpha_x / facets->alpha_y;
}

/* ---- facets ---- */

/* Over the diffuse light from a quarter of the hemisphere. */
static float mean_over_directions(float (*function)(const void *, Vec3f), const void *context)
{
    enum { STEPS = 96, TURNS = 40 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        for (int k = 0; k < TURNS; k++) {
            float z = ((float)i + 0.5f) / STEPS, turn = ((float)k + 0.5f) / TURNS * 0.5f * SAMPLING_PI;
            float r = sqrtf(1 - z * z);
            sum += (double)(2 * z * function(context, vec3f(r * cosf(turn), r * sinf(turn), z)));
        }
    return (float)(sum / (STEPS * TURNS));
}

static float layer_reflects(const void *layer, Vec3f w)
{
    return lanes_get(layer_reflectance(layer, w), 0);
}

static float grid_says(const void *grid, Vec3f w)
{
    return direction_grid_at(grid, w);
}

/* As in bsdf_lobe.h; the mean is summed as the grid is looked up. */
static void find_reflected(const BsdfFacets *facets, float eta, BsdfKnown *known)
{
    const DirectionEdge edges[DIRECTION_EDGES] = {edge_of(facets, eta), no_edge};
    BsdfLayer layer;
    layer_make(lanes_all(eta), facets->alpha_x, facets->alpha_y, lanes_all(1), NULL, &layer);
    known->critical = edges[0].critical;
    direction_grid_init(&known->grid, edges, stretch_of(facets), DIRECTION_AZIMUTHS, DIRECTION_COSINES);
    for (int i = 0; i < direction_grid_knots(&known->grid); i++) {
        Vec3f v = direction_grid_knot(&known->grid, i);
        float reflected;
        facet_sums(facets->alpha_x, facets->alpha_y, eta, v, &reflected, NULL);
        *direction_grid_value(&known->grid, i) = reflected - lanes_get(layer_smooth_reflectance(&layer, v), 0);
    }
    layer.known = known;
    known->mean = mean_over_directions(layer_reflects, &layer);
}

static void find_missing(const BsdfFacets *facets, float eta, BsdfKnown *known)
{
    const DirectionEdge edges[DIRECTION_EDGES] = {edge_of(facets, eta), no_edge};
    known->critical = edges[0].critical;
    direction_grid_init(&known->grid, edges, stretch_of(facets), DIRECTION_AZIMUTHS, DIRECTION_COSINES);
    for (int i = 0; i < direction_grid_knots(&known->grid); i++) {
        float reflected;
        facet_sums(facets->alpha_x, facets->alpha_y, eta, direction_grid_knot(&known->grid, i), &reflected,
                   direction_grid_value(&known->grid, i));
    }
    known->mean = mean_over_directions(grid_says, &known->grid);
}

/* ---- what is under covers ---- */

/* A function of directions, looked up in finer steps of the cosine than a grid's. */
typedef float FineValues[AZIMUTHS][(COSINES - 1) * FINE + 1];

typedef struct Work {
    const Bsdf *bsdf; /* white */
    const BsdfLobe *lobe;
    DirectionGrid *grid;
    bool edged;           /* what is over it has a critical angle */
    Balance known;        /* what is, and factors of 1 */
    FineValues covers;    /* g: of what is over the lobe */
    float wanted[KNOTS];  /* what the covers leave of all light */
    float factors[KNOTS]; /* the unknowns: factor_i times the sum of weights[i][k] factor_k = wanted_i */
    float weights[KNOTS][KNOTS];
} Work;

static void tabulate(const Work *work, float (*function)(const Work *, Vec3f), FineValues values)
{
    int last = work->grid->n_cosines - 1;
    for (int row = 0; row < work->grid->n_azimuths; row++) {
        const float *cosines = work->grid->cosines[row];
        Vec3f along = direction_grid_knot(work->grid, row * work->grid->n_cosines);
        float length = sqrtf(along.x * along.x + along.y * along.y);
        for (int i = 0; i <= last * FINE; i++) {
            int cell = i / FINE < last ? i / FINE : last - 1;
            float part = (float)(i - cell * FINE) / FINE;
            float z = cosines[cell] + (cosines[cell + 1] - cosines[cell]) * part;
            float r = sqrtf(float_max((1 - z) * (1 + z), 0)) / length;
            values[row][i] = function(work, vec3f(r * along.x, r * along.y, z));
        }
    }
}

static float fine_at(const Work *work, FineValues values, const DirectionPlace *place)
{
    float ends[2], at = ((float)place->cosine + place->past_cosine) * FINE;
    int most = (work->grid->n_cosines - 1) * FINE - 1, knot = (int)at < most ? (int)at : most;
    for (int i = 0; i <= 1; i++) {
        const float *row = values[place->azimuth + i] + knot;
        ends[i] = row[0] + (row[1] - row[0]) * (at - (float)knot);
    }
    return ends[0] + (ends[1] - ends[0]) * place->past_azimuth;
}

static float covers_of(const Work *work, Vec3f w)
{
    return bsdf_cover_factor(work->bsdf, work->lobe, w);
}

static float fuzz_over_layer(const Work *work, Vec3f w)
{
    const BsdfFuzz *fuzz = &work->bsdf->fuzz;
    const BsdfFacets *facets = &bsdf_layer_over(work->bsdf, work->lobe)->facets;
    return fuzz_to_mirrors(fuzz, facets, w, 1 - fuzz_albedo(fuzz, w));
}

/* What comes out under fuzz of what the layer reflects of light from v, by facets alone. */
static float reflected_under_fuzz(const Work *work, const BsdfLayer *layer, FineValues fuzz, Vec3f v)
{
    double all = 0, out = 0;
    for (int i = 0; i < FEW_WAYS; i++) {
        float u[2];
        Vec3f l;
        facet_lattice(i, FEW_WAYS, FEW_STRIDE, u);
        if (!facets_sample_reflection(&layer->facets, v, u, &l)) continue;
        FacetReflection r = facets_reflect(&layer->facets, v, l);
        DirectionPlace place = direction_grid_place(work->grid, l);
        float weight = r.shadowing * fresnel_dielectric(r.cosine, 1, lanes_get(layer->eta, 0));
        all += (double)weight;
        out += (double)(weight * fine_at(work, fuzz, &place));
    }
    return all > 0 ? (float)(out / all) * fuzz_over_layer(work, v) : 1;
}

static void find_wanted(Work *work)
{
    const BsdfLayer *layer = bsdf_layer_over(work->bsdf, work->lobe);
    const BsdfFuzz *fuzz = &work->bsdf->fuzz;
    bool fuzzy = fuzz->share > 0;
    if (fuzzy && layer && !layer->facets.smooth) tabulate(work, fuzz_over_layer, work->covers);
    for (int i = 0; i < direction_grid_knots(work->grid); i++) {
        Vec3f v = direction_grid_knot(work->grid, i);
        float passed = fuzzy ? 1 - fuzz_albedo(fuzz, v) : 1, reflected = 0;
        if (layer) reflected = lanes_get(layer_reflectance(layer, v), 0);
        if (layer && layer->facets.smooth)
            reflected *= passed;
        else if (layer && fuzzy)
            reflected *= reflected_under_fuzz(work, layer, work->covers, v);
        work->wanted[i] = float_max(passed - reflected, 0);
    }
}

/* Where the base sends light from v, and how much, without covers; 0: nowhere. */
static float base_sends(const BsdfLobe *lobe, Vec3f v, const float u[2], Vec3f *l)
{
    if (lobe->kind == BSDF_CONDUCTOR) {
        const BsdfConductor *conductor = &lobe->as.conductor;
        if (!facets_sample_reflection(&conductor->facets, v, u, l)) return 0;
        FacetReflection r = facets_reflect(&conductor->facets, v, *l);
        return r.shadowing * mirrors_scaling(&conductor->mirrors, &conductor->facets, v, *l, &r);
    }
    const BsdfDiffuse *diffuse = lobe->kind == BSDF_PLASTIC ? &lobe->as.plastic.base : &lobe->as.diffuse;
    float pdf;
    *l = sampling_cosine_hemisphere(u[0], u[1], vec3f(0, 0, 1), &pdf);
    return lanes_get(diffuse_evaluate(diffuse, v, *l), 0) / pdf;
}

static void look_from(Work *work, int knot)
{
    Vec3f v = direction_grid_knot(work->grid, knot), l;
    int n_ways = work->edged ? WAYS : FEW_WAYS, stride = work->edged ? WAY_STRIDE : FEW_STRIDE;
    float *row = work->weights[knot], at_v = covers_of(work, v) / (float)n_ways;
    memset(row, 0, sizeof work->weights[knot]);
    for (int i = 0; i < n_ways; i++) {
        float u[2];
        facet_lattice(i, n_ways, stride, u);
        float weight = base_sends(work->lobe, v, u, &l) * at_v;
        if (!(weight > 0)) continue;
        DirectionPlace place = direction_grid_place(work->grid, l);
        weight *= fine_at(work, work->covers, &place);
        for (int k = 0; k <= 1; k++) {
            float *at = row + (place.azimuth + k) * work->grid->n_cosines + place.cosine;
            float share = weight * (k ? place.past_azimuth : 1 - place.past_azimuth);
            at[0] += share * (1 - place.past_cosine);
            at[1] += share * place.past_cosine;
        }
    }
}

static void solve(Work *work)
{
    const float least = 0.3f, most = 12, nothing = 1e-4f; /* what next to nothing comes of is left as it is */
    int n = direction_grid_knots(work->grid);
    for (int i = 0; i < n; i++) work->factors[i] = 1;
    for (int round = 0; round < ROUNDS; round++) {
        float next[KNOTS];
        for (int i = 0; i < n; i++) {
            float sum = 0;
            for (int k = 0; k < n; k++) sum += work->weights[i][k] * work->factors[k];
            next[i] = work->factors[i];
            if (sum > nothing && work->wanted[i] > nothing) next[i] = sqrtf(next[i] * work->wanted[i] / sum);
            next[i] = float_min(float_max(next[i], least), most);
        }
        memcpy(work->factors, next, (size_t)n * sizeof *next);
    }
}

static void find_factors(Work *work, const BsdfLobe *lobe, const DirectionEdge edges[DIRECTION_EDGES], float ratio,
                         DirectionGrid *grid)
{
    work->lobe = lobe;
    work->grid = grid;
    work->edged = edges[0].critical >= 0;
    direction_grid_init(grid, edges, ratio, AZIMUTHS, COSINES);
    int n = direction_grid_knots(grid);
    find_wanted(work);
    tabulate(work, covers_of, work->covers);
    for (int i = 0; i < n; i++) look_from(work, i);
    solve(work);
    for (int i = 0; i < n; i++) *direction_grid_value(grid, i) = work->factors[i];
}

/* ---- surfaces ---- */

/* What there is of a surface, and how it reflects. */
typedef struct Parts {
    BsdfFacets base, coat;
    float skin_eta, coat_eta; /* relative to the medium in front */
    bool metal, plastic;      /* bare */
    bool coated_metal, coated_diffuse;
    bool clear;
    bool fuzzy, matte; /* matte: what is diffuse follows EON */
} Parts;

static Parts parts_of(const BsdfSpec *spec, float eta_i, float eta_t)
{
    float alpha_x, alpha_y, metal = spec->base_metalness, opaque = (1 - metal) * (1 - spec->transmission_weight);
    float coat = spec->coat_weight;
    Parts parts = {.fuzzy = spec->fuzz_weight > 0, .matte = spec->base_diffuse_roughness > 0};
    bsdf_alphas(spec->specular_roughness, spec->specular_roughness_anisotropy, &alpha_x, &alpha_y);
    parts.base = facets_make(alpha_x, alpha_y);
    bsdf_alphas(spec->coat_roughness, spec->coat_roughness_anisotropy, &alpha_x, &alpha_y);
    parts.coat = facets_make(alpha_x, alpha_y);
    float skin = spectrum_at_one(&spec->specular_ior, BALANCE_NM) / eta_i;
    parts.skin_eta = lanes_get(bsdf_weakened(lanes_all(skin), spec->specular_weight), 0);
    parts.coat_eta = spectrum_at_one(&spec->coat_ior, BALANCE_NM) / eta_i;
    parts.metal = metal > 0 && coat < 1;
    parts.plastic = opaque > 0 && coat < 1 && spec->specular_weight > 0;
    parts.coated_metal = (metal > 0 || (opaque > 0 && spec->specular_weight > 0)) && coat > 0;
    parts.coated_diffuse = opaque > 0 && coat > 0;
    parts.clear = !spec->thin_walled && metal < 1 && spec->transmission_weight > 0 && eta_i != eta_t;
    return parts;
}

/* Layers that tables are too coarse for. */
static bool is_coarse(const BsdfFacets *facets, float eta)
{
    return !facets->smooth && (facets->stretched || eta < 1);
}

/* Which parts of a balance are worth it. */
static Balance wanted_of(const Parts *parts)
{
    bool skin = is_coarse(&parts->base, parts->skin_eta), coat = is_coarse(&parts->coat, parts->coat_eta);
    bool fuzzy = parts->fuzzy, stretched = parts->base.stretched, rough = !parts->base.smooth;
    return (Balance){
        .skin = parts->plastic && skin,
        .coat = (parts->coated_metal || parts->coated_diffuse) && coat,
        .boundary = parts->clear && stretched,
        .bare_metal = parts->metal && stretched && fuzzy,
        .plastic_base = parts->plastic && skin && (fuzzy || parts->matte),
        .coated_metal = parts->coated_metal && rough && (stretched || coat || parts->coat_eta < 1),
        .coated_diffuse = parts->coated_diffuse && coat && (fuzzy || parts->matte),
    };
}

bool balance_is_wanted(const BsdfSpec *spec, float eta_i, float eta_t)
{
    Parts parts = parts_of(spec, eta_i, eta_t);
    Balance b = wanted_of(&parts);
    return b.skin || b.coat || b.boundary || b.bare_metal || b.plastic_base || b.coated_metal || b.coated_diffuse;
}

/* What of the surface is opaque, white. */
static BsdfSpec white_cover(const BsdfSpec *spec)
{
    BsdfSpec white = *spec;
    float metal = spec->base_metalness, rest = (1 - metal) * (1 - spec->transmission_weight);
    white.base_metalness = metal > 0 ? metal / (metal + rest) : 0;
    white.transmission_weight = white.translucency = 0;
    white.measured_metal = false;
    white.film_thickness_nm = -1;
    white.base_color = white.coat_color = white.fuzz_color = spectrum_constant(1);
    return white;
}

/* The grid for what is under a lobe's covers. */
static DirectionGrid *grid_for(Balance *balance, const BsdfLobe *lobe)
{
    switch (lobe->kind) {
    case BSDF_CONDUCTOR:
        if (lobe->covered) return balance->coated_metal ? &balance->to_coated_metal : NULL;
        return balance->bare_metal ? &balance->to_bare_metal : NULL;
    case BSDF_DIFFUSE: return lobe->covered && balance->coated_diffuse ? &balance->to_coated_diffuse : NULL;
    case BSDF_PLASTIC: return balance->plastic_base ? &balance->to_plastic_base : NULL;
    default: return NULL;
    }
}

static void fill_with_ones(DirectionGrid *grid)
{
    const DirectionEdge edges[DIRECTION_EDGES] = {no_edge, no_edge};
    direction_grid_init(grid, edges, 1, 2, 2);
    for (int i = 0; i < direction_grid_knots(grid); i++) *direction_grid_value(grid, i) = 1;
}

static void find_all_factors(const BsdfSpec *spec, const Parts *parts, float eta_i, Work *work, Balance *balance)
{
    Balance *known = &work->known;
    *known = *balance;
    DirectionGrid *const ones[] = {&known->to_bare_metal, &known->to_plastic_base, &known->to_coated_metal,
                                   &known->to_coated_diffuse};
    for (size_t i = 0; i < sizeof ones / sizeof *ones; i++) fill_with_ones(ones[i]);
    BsdfSpec white = white_cover(spec);
    const BsdfKept kept = {.balance = known, .inner = -1};
    Bsdf bsdf;
    bsdf_from_spec(&white, lanes_all(BALANCE_NM), lanes_all(eta_i), lanes_all(eta_i), &kept, &bsdf);
    work->bsdf = &bsdf;
    const DirectionGrid *found[BSDF_LOBES];
    for (uint32_t i = 0; i < bsdf.n_lobes; i++) {
        const BsdfLobe *lobe = &bsdf.lobes[i];
        DirectionGrid *grid = grid_for(balance, lobe);
        found[i] = grid;
        bool again = !grid; /* facets of the metal and those under a coat are the same */
        for (uint32_t k = 0; k < i; k++) again |= found[k] == grid;
        if (again) continue;
        bool covered = lobe->covered;
        DirectionEdge over = covered ? edge_of(&parts->coat, parts->coat_eta) : no_edge;
        if (lobe->kind == BSDF_PLASTIC) over = edge_of(&parts->base, parts->skin_eta);
        DirectionEdge below = over;
        below.alpha_x = float_max(parts->base.alpha_x, MICROFACET_SMOOTH_ALPHA);
        below.alpha_y = float_max(parts->base.alpha_y, MICROFACET_SMOOTH_ALPHA);
        const DirectionEdge edges[DIRECTION_EDGES] = {over, lobe->kind == BSDF_CONDUCTOR ? below : no_edge};
        float ratio = stretch_of(&parts->base);
        if (covered) ratio = float_max(ratio, stretch_of(&parts->coat));
        find_factors(work, lobe, edges, ratio, grid);
    }
    work->bsdf = NULL;
}

Status balance_new(const BsdfSpec *spec, float eta_i, float eta_t, Balance **balance)
{
    Parts parts = parts_of(spec, eta_i, eta_t);
    Balance *b = *balance = malloc(sizeof *b);
    Work *work = malloc(sizeof *work);
    if (!b || !work) {
        free(b);
        free(work);
        *balance = NULL;
        return STATUS_NOMEM;
    }
    *b = wanted_of(&parts);
    if (b->skin) find_reflected(&parts.base, parts.skin_eta, &b->skin_reflects);
    if (b->coat) find_reflected(&parts.coat, parts.coat_eta, &b->coat_reflects);
    if (b->boundary)
        for (int i = 0; i <= 1; i++)
            find_missing(&parts.base, i ? eta_i / eta_t : eta_t / eta_i, &b->boundary_misses[i]);
    if (b->bare_metal || b->plastic_base || b->coated_metal || b->coated_diffuse)
        find_all_factors(spec, &parts, eta_i, work, b);
    free(work);
    return STATUS_OK;
}
