/* bsdf_lobe.h - what a surface's scattering is assembled from; made by bsdf.h's functions, private to
 * src/optics/bsdf*.c. Everything that depends on the wavelength is per lane. Directions, f_cos and densities are as in
 * bsdf.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_LOBE_H
#define MEN_BSDF_LOBE_H

#include "base/lanes.h"
#include "base/vec3.h"
#include "optics/direction_grid.h"
#include "optics/layered.h"
#include "optics/microfacet.h"
#include "optics/stretched.h"
#include "optics/thin_film.h"

/* A rough surface's facets; smooth: there are none. */
typedef struct BsdfFacets {
    float alpha_x, alpha_y;
    bool smooth, stretched; /* stretched: the alphas differ */
} BsdfFacets;

/* Facets of a boundary in the tables of round or stretched ones. */
typedef union BsdfIndex {
    MicrofacetIndex round;
    StretchedIndex stretched;
} BsdfIndex;

/* What one facet makes of light at one boundary, in place of tables. */
typedef struct BsdfKnown {
    DirectionGrid grid;
    float critical; /* cosine of the critical angle; below 0: there is none */
    float mean;     /* over diffuse light */
} BsdfKnown;

/* What is known of one surface between two media, made by balance.h. */
typedef struct Balance {
    bool skin, coat, boundary;              /* whether there are: */
    BsdfKnown skin_reflects, coat_reflects; /* beyond layer_smooth_reflectance; the mean is of all */
    BsdfKnown boundary_misses[2];           /* seen from in front, and from behind */
    /* factors to what lets pass the covers of a base */
    bool bare_metal, plastic_base, coated_metal, coated_diffuse;
    DirectionGrid to_bare_metal, to_plastic_base, to_coated_metal, to_coated_diffuse;
} Balance;

/* Facets that are mirrors. */
typedef struct BsdfMirrors {
    MicrofacetPlace roughness;
    StretchedPlace stretched;
} BsdfMirrors;

typedef struct BsdfDiffuse {
    Lanes albedo;
    Lanes multiple;        /* albedo of what is reflected more than once, over its normalization */
    float roughness;       /* 0: Lambert's law */
    float single, average; /* A and the mean albedo of one reflection in the model's terms */
} BsdfDiffuse;

typedef struct BsdfConductor {
    BsdfFacets facets;
    BsdfMirrors mirrors;
    Lanes n, k;           /* relative to the medium in front */
    Lanes mean, multiple; /* mean reflectance; the tint of what is reflected more than once */
    bool white;           /* facets reflect all, whatever n and k */
    bool balanced;        /* under a coat, with a balance */
    bool filmed;          /* with this film on it, all relative to the medium in front */
    ThinFilm film;
} BsdfConductor;

/* A clear layer that is so thin that light leaves it where it entered, over something opaque. */
typedef struct BsdfLayer {
    BsdfFacets facets;
    BsdfIndex index;
    MicrofacetIndex among;  /* in the tables of layered.h */
    Lanes eta;              /* relative to the medium in front */
    Lanes depth;            /* optical depth of one crossing along the normal */
    Lanes returned;         /* part of diffuse light from below that comes back, absorption included; */
    Lanes returned_left;    /* and what that leaves of it, where it is tinted */
    Lanes mean_passed;      /* of diffuse light from above, without absorption */
    Lanes norm;             /* what passes of diffuse light from below, over what passes from above */
    const BsdfKnown *known; /* of what it reflects; NULL: nothing */
    bool tinted;
    /* layer_read of them gives layer_reflectance, and what one of its facets reflects, for all lanes; NULL: to be computed */
    const float *reflectances, *facet_reflectances;
} BsdfLayer;

typedef struct BsdfPlastic {
    const BsdfLayer *layer; /* `own`, or one that was made before */
    BsdfLayer own;
    BsdfDiffuse base;
} BsdfPlastic;

typedef struct BsdfBoundary {
    BsdfFacets facets;
    BsdfIndex index;
    Lanes eta_i, eta_t;
    Lanes blurred; /* 0 for wavelengths that go straight on, as their indices are too nearly equal; else 1 */
    Lanes reflected, transmitted;           /* how the light is split that one facet misses; the sum is 1 */
    Lanes reflected_norm, transmitted_norm; /* the same over pi times the mean of what is missing there */
    float spread[2], spread_norm[2];        /* of the directions that are sampled for it: reflected, transmitted */
    const BsdfKnown *known[2];              /* of what is missing, in front and behind; NULL: nothing */
    bool filmed;                            /* with this film on it, relative to the vacuum; it is smooth then */
    ThinFilm film;
} BsdfBoundary;

typedef struct BsdfSheet {
    BsdfFacets facets;
    BsdfMirrors mirrors;
    Lanes eta;   /* relative to the medium on both sides */
    Lanes depth; /* as in BsdfLayer */
    bool tinted;
    bool filmed; /* so thin that light interferes: this film, relative to that medium */
    ThinFilm film;
    float brightness[2]; /* of what lies in the mirrored direction, and straight on: see fresnel_choice */
} BsdfSheet;

/* Fibres that stand on what is opaque. */
typedef struct BsdfFuzz {
    MicrofacetPlace roughness;
    MicrofacetPlace skin, skin_share; /* in layered_fuzz_skin */
    float exponent;
    float share; /* of what they stand on that is covered */
    Lanes color;
} BsdfFuzz;

typedef enum BsdfKind {
    BSDF_DIFFUSE,
    BSDF_TRANSLUCENT, /* Lambert's law on the far side */
    BSDF_CONDUCTOR,
    BSDF_PLASTIC,
    BSDF_BOUNDARY,
    BSDF_SHEET
} BsdfKind;

typedef struct BsdfLobe {
    BsdfKind kind;
    float share;  /* of the surface */
    bool covered; /* by the coat */
    Lanes seen;   /* of Bsdf.view: what a plastic's skin reflects, or what facets of a boundary miss; see lobe_see */
    const DirectionGrid *balance; /* factors to what is under covers; NULL: none */
    float balance_seen;           /* of Bsdf.view */
    float fuzz_norm; /* of what is diffuse: one over the mean that layers let pass, with the fuzz over without it */
    union {
        BsdfDiffuse diffuse; /* translucent too */
        BsdfConductor conductor;
        BsdfPlastic plastic;
        BsdfBoundary boundary;
        BsdfSheet sheet;
    } as;
} BsdfLobe;

/* What was sampled of a lobe. specular: value is what comes of that direction, density the probability of the choice.
 */
typedef struct LobeSample {
    Vec3f direction;
    Lanes value, density;
    bool specular, hero_only;
} LobeSample;

/* ---- facets ---- */
BsdfFacets facets_make(float alpha_x, float alpha_y);
/* Density per steradian of the reflection of view by visible facets, and G2/G1; light.z > 0. */
typedef struct FacetReflection {
    float cosine; /* between view and the facet's normal */
    float density, shadowing;
    float angle_v, angle_l; /* microfacet_angle */
} FacetReflection;
FacetReflection facets_reflect(const BsdfFacets *facets, Vec3f view, Vec3f light);
/* eta: of the boundary that they are of */
void facets_index(const BsdfFacets *facets, Lanes eta, BsdfIndex *index);
static inline const MicrofacetIndex *facets_round_index(const BsdfFacets *facets, const BsdfIndex *index)
{
    return facets->stretched ? &index->stretched.index : &index->round;
}
/* Of microfacet_missing and microfacet_excess, at a direction and in the mean. behind: it is on the far side. */
Lanes facets_missing(const BsdfFacets *facets, const BsdfIndex *index, bool behind, Vec3f w);
Lanes facets_excess(const BsdfFacets *facets, const BsdfIndex *index, Vec3f w);
Lanes facets_missing_mean(const BsdfFacets *facets, const BsdfIndex *index, bool behind);
Lanes facets_reflected_mean(const BsdfFacets *facets, const BsdfIndex *index);
/* The alpha of round facets that are alike for a direction. */
static inline float facets_alpha(const BsdfFacets *facets, Vec3f w)
{
    return facets->stretched ? stretched_alpha(facets->alpha_x, facets->alpha_y, w) : facets->alpha_x;
}
BsdfMirrors mirrors_make(const BsdfFacets *facets);
/* What puts back what such facets miss: the product of k at both directions. */
float mirrors_scaling(const BsdfMirrors *mirrors, const BsdfFacets *facets, Vec3f view, Vec3f light,
                      const FacetReflection *r);
/* false: the reflection goes down, where nothing comes of it */
bool facets_sample_reflection(const BsdfFacets *facets, Vec3f view, const float u[2], Vec3f *light);

/* Where facets are among the rows of a table of layered.h, for a direction. */
static inline MicrofacetPlace facets_row(const BsdfFacets *facets, Vec3f w)
{
    return microfacet_place(sqrtf(facets_alpha(facets, w)), LAYERED_MIRRORS);
}
static inline Vec3f mirrored(Vec3f view)
{
    return vec3f(-view.x, -view.y, view.z);
}
/* Takes one of two ways with probability p, and makes u uniform again. */
static inline bool lobe_choose(float *u, float p)
{
    bool taken = *u < p;
    *u = float_min(taken ? *u / p : (*u - p) / (1 - p), 0x1.fffffep-1f);
    return taken;
}

/* What is left of a lobe's light under something else: of what facets reflect, and of what is diffuse. */
typedef struct LobeOver {
    float mirror, diffuse;
} LobeOver;

/* ---- lobes: light.z > 0 but for boundary and sheet ---- */
BsdfDiffuse diffuse_make(Lanes albedo, float roughness);
Lanes diffuse_evaluate(const BsdfDiffuse *diffuse, Vec3f view, Vec3f light);
float diffuse_density(const BsdfDiffuse *diffuse, Vec3f light);
Vec3f diffuse_sample(const BsdfDiffuse *diffuse, float u_choice, const float u[2]);
void conductor_evaluate(const BsdfConductor *conductor, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
bool conductor_sample(const BsdfConductor *conductor, Vec3f view, const float u[2], LobeSample *sample);
Lanes boundary_missing(const BsdfBoundary *boundary, bool behind, Vec3f w); /* what one facet misses */
/* missing_v: of view */
void boundary_evaluate(const BsdfBoundary *boundary, Vec3f view, Vec3f light, Lanes missing_v, Lanes *f_cos,
                       Lanes *pdf_w);
bool boundary_sample(const BsdfBoundary *boundary, Vec3f view, float u_choice, const float u[2], LobeSample *sample);
void sheet_evaluate(const BsdfSheet *sheet, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
/* What a smooth sheet lets straight on; of a rough one nothing. */
Lanes sheet_straight(const BsdfSheet *sheet, float cosine);
bool sheet_sample(const BsdfSheet *sheet, Vec3f view, float u_choice, const float u[2], LobeSample *sample);
/* reflectance_v: layer_reflectance of view */
void plastic_evaluate(const BsdfPlastic *plastic, Vec3f view, Vec3f light, Lanes reflectance_v, LobeOver over,
                      Lanes *f_cos, Lanes *pdf_w);
bool plastic_sample(const BsdfPlastic *plastic, Vec3f view, Lanes reflectance_v, float u_choice, const float u[2],
                    LobeSample *sample);

/* ---- the layer ---- */
/* -ln, held finite */
Lanes layer_depth(Lanes transmittance);
/* known: of what it reflects, or NULL; not owned */
void layer_make(Lanes eta, float alpha_x, float alpha_y, Lanes tint, const BsdfKnown *known, BsdfLayer *layer);
/* Tables by the root of the cosine, as most happens at grazing angles. */
enum { LAYER_STEPS = 512, LAYER_READINGS = LAYER_STEPS + 2 };
static inline float layer_read(const float readings[LAYER_READINGS], float cosine)
{
    float at = sqrtf(float_min(float_max(cosine, 0), 1)) * LAYER_STEPS;
    int step = (int)at;
    return readings[step] + (readings[step + 1] - readings[step]) * (at - (float)step);
}
/* What it would reflect if it were about smooth: past the critical angle softly. */
Lanes layer_smooth_reflectance(const BsdfLayer *layer, Vec3f w);
/* Fills in `among`, for all that is under the layer but Lambert's law. */
void layer_find_among(BsdfLayer *layer);
Lanes layer_reflectance(const BsdfLayer *layer, Vec3f w);
/* What goes down, from above, absorption included. reflectance: layer_reflectance(layer, w) */
Lanes layer_transmittance(const BsdfLayer *layer, Vec3f w, Lanes reflectance);
/* The reflection by its upper side, zero where it is smooth. */
void layer_evaluate(const BsdfLayer *layer, Vec3f view, Vec3f light, Lanes *f_cos, float *pdf_w);
/* How often it is sampled rather than the base, where it covers a share: by what they reflect, about. */
Lanes layer_chance(const BsdfLayer *layer, float share, Lanes reflectance, Lanes base_albedo);
/* ---- fuzz ---- */
BsdfFuzz fuzz_make(float share, Lanes color, float roughness);
float fuzz_albedo(const BsdfFuzz *fuzz, Vec3f w); /* of white fibres */
/* What passes the fuzz on the way to facets, and to what is diffuse: t of layered.h, there times a mean of its own.
 * passed: 1 - fuzz_albedo(). */
float fuzz_to_mirrors(const BsdfFuzz *fuzz, const BsdfFacets *facets, Vec3f w, float passed);
float fuzz_to_diffuse(const BsdfFuzz *fuzz, float roughness, Vec3f w, float passed);
/* What of light that passes fuzz and a layer reaches what is under both, over the product of what each lets pass: the
 * layer's own reflection does not get all of its share out. About, as the same for all lanes. */
float fuzz_to_base(const BsdfFuzz *fuzz, const BsdfLayer *layer, Vec3f w);
void fuzz_evaluate(const BsdfFuzz *fuzz, Vec3f view, Vec3f light, Lanes *f_cos, float *pdf_w);
Vec3f fuzz_sample(float u_choice, const float u[2]);

/* ---- under a layer ---- */
/* What becomes of f_cos of a diffuse base under it: the factor besides the transmittances; EON departs from that, see
 * layered.h. */
Lanes layer_over_diffuse(const BsdfLayer *layer, Lanes base_albedo);
Lanes layer_over_rough_diffuse(const BsdfLayer *layer, float roughness, Vec3f view, Vec3f light);
/* What becomes of f_cos of mirrors, white or not: all of the factor. passed: layer_transmittance(). */
Lanes layer_over_mirrors(const BsdfLayer *layer, const BsdfConductor *base, Vec3f view, Vec3f light,
                         Lanes reflectance_v, Lanes reflectance_l, Lanes passed_v, Lanes passed_l);
/* What the layer reflects of light between it and a base of index eta_base (relative to the same medium), in the mean:
 * of light that came in through the layer, bent. */
Lanes layer_inner_reflectance(Lanes eta, Lanes eta_base);

/* ---- for balance.c ---- */

struct Bsdf;
/* The layer over a lobe's base; NULL: none. */
const BsdfLayer *bsdf_layer_over(const struct Bsdf *bsdf, const BsdfLobe *lobe);
/* A lobe's base gives k(v, l) without what is over it, if white, and with it k(v, l) g(v) g(l). This is g. */
float bsdf_cover_factor(const struct Bsdf *bsdf, const BsdfLobe *lobe, Vec3f w);

#endif
