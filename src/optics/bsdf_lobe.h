/* bsdf_lobe.h - what a surface's scattering is assembled from; made by bsdf.h's functions, private to
 * src/optics/bsdf*.c. Everything that depends on the wavelength is per lane. Directions, f_cos and densities are as in
 * bsdf.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_LOBE_H
#define MEN_BSDF_LOBE_H

#include "base/lanes.h"
#include "base/vec3.h"
#include "optics/microfacet.h"

/* A rough surface's facets; smooth: there are none. */
typedef struct BsdfFacets {
    float alpha_x, alpha_y;
    bool smooth;
} BsdfFacets;

typedef struct BsdfDiffuse {
    Lanes albedo;
    Lanes multiple;        /* albedo of what is reflected more than once, over its normalization */
    float roughness;       /* 0: Lambert's law */
    float single, average; /* A and the mean albedo of one reflection in the model's terms */
} BsdfDiffuse;

typedef struct BsdfConductor {
    BsdfFacets facets;
    MicrofacetPlace roughness;
    Lanes n, k;           /* relative to the medium in front */
    Lanes mean, multiple; /* mean reflectance; the tint of what is reflected more than once */
} BsdfConductor;

/* A clear layer that is so thin that light leaves it where it entered, over something opaque. */
typedef struct BsdfLayer {
    BsdfFacets facets;
    MicrofacetIndex index;
    Lanes eta;      /* relative to the medium in front */
    Lanes depth;    /* optical depth of one crossing along the normal */
    Lanes returned; /* part of diffuse light from below that comes back, absorption included */
    Lanes norm;     /* what passes of diffuse light from below, over what passes from above */
    bool tinted;
} BsdfLayer;

typedef struct BsdfPlastic {
    BsdfLayer layer;
    BsdfDiffuse base;
} BsdfPlastic;

typedef struct BsdfBoundary {
    BsdfFacets facets;
    MicrofacetIndex index;
    Lanes eta_i, eta_t;
    Lanes blurred; /* 0 for wavelengths that go straight on, as their indices are too nearly equal; else 1 */
    Lanes reflected, transmitted;           /* how the light is split that one facet misses; the sum is 1 */
    Lanes reflected_norm, transmitted_norm; /* the same over pi times the mean of what is missing there */
    float spread[2], spread_norm[2];        /* of the directions that are sampled for it: reflected, transmitted */
} BsdfBoundary;

typedef struct BsdfSheet {
    BsdfFacets facets;
    MicrofacetPlace roughness;
    Lanes eta;   /* relative to the medium on both sides */
    Lanes depth; /* as in BsdfLayer */
    bool tinted;
} BsdfSheet;

typedef enum BsdfKind { BSDF_DIFFUSE, BSDF_CONDUCTOR, BSDF_PLASTIC, BSDF_BOUNDARY, BSDF_SHEET } BsdfKind;

typedef struct BsdfLobe {
    BsdfKind kind;
    float share; /* of the surface */
    union {
        BsdfDiffuse diffuse;
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
/* false: the reflection goes down, where nothing comes of it */
bool facets_sample_reflection(const BsdfFacets *facets, Vec3f view, const float u[2], Vec3f *light);

static inline Vec3f mirrored(Vec3f view)
{
    return vec3f(-view.x, -view.y, view.z);
}
/* A table for a direction. Tables know of round facets only; others count as of the root mean square of their alphas.
 */
static inline Lanes lobe_lookup(const MicrofacetTable table, const BsdfFacets *facets, const MicrofacetIndex *index,
                                bool behind, Vec3f w)
{
    return microfacet_lookup(table, index, behind, fabsf(w.z), microfacet_slope(facets->alpha_x, facets->alpha_y, w));
}
/* Takes one of two ways with probability p, and makes u uniform again. */
static inline bool lobe_choose(float *u, float p)
{
    bool taken = *u < p;
    *u = float_min(taken ? *u / p : (*u - p) / (1 - p), 0x1.fffffep-1f);
    return taken;
}

/* ---- lobes: light.z > 0 but for boundary and sheet ---- */
Lanes diffuse_evaluate(const BsdfDiffuse *diffuse, Vec3f view, Vec3f light);
float diffuse_density(const BsdfDiffuse *diffuse, Vec3f light);
Vec3f diffuse_sample(const BsdfDiffuse *diffuse, float u_choice, const float u[2]);
void conductor_evaluate(const BsdfConductor *conductor, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
bool conductor_sample(const BsdfConductor *conductor, Vec3f view, const float u[2], LobeSample *sample);
void boundary_evaluate(const BsdfBoundary *boundary, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
bool boundary_sample(const BsdfBoundary *boundary, Vec3f view, float u_choice, const float u[2], LobeSample *sample);
void sheet_evaluate(const BsdfSheet *sheet, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
bool sheet_sample(const BsdfSheet *sheet, Vec3f view, float u_choice, const float u[2], LobeSample *sample);
void plastic_evaluate(const BsdfPlastic *plastic, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
bool plastic_sample(const BsdfPlastic *plastic, Vec3f view, float u_choice, const float u[2], LobeSample *sample);

/* ---- the layer ---- */
Lanes layer_reflectance(const BsdfLayer *layer, Vec3f w);
/* What goes down, from above, absorption included. reflectance: layer_reflectance(layer, w) */
Lanes layer_transmittance(const BsdfLayer *layer, Vec3f w, Lanes reflectance);
/* The reflection by its upper side, zero where it is smooth. */
void layer_evaluate(const BsdfLayer *layer, Vec3f view, Vec3f light, Lanes *f_cos, float *pdf_w);
/* How often it is sampled rather than the base, where it covers a share: by what they reflect, about. */
Lanes layer_chance(const BsdfLayer *layer, float share, Lanes reflectance, Lanes base_albedo);
/* What becomes of f_cos of a base under it: the factor besides the transmittances. */
Lanes layer_over_diffuse(const BsdfLayer *layer, Lanes base_albedo);
Lanes layer_over_mirror(const BsdfLayer *layer, Lanes base_albedo, Lanes reflectance_v, Lanes reflectance_l);

#endif
