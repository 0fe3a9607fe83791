/* bsdf_spec.h - a surface as a scene describes it, and the Bsdf of it at one hit.
 * Parameters are OpenPBR's (Academy Software Foundation, "OpenPBR Surface Specification" 1.1) where it has them, so
 * that a material means the same elsewhere. Where it departs: metals may have measured indices, a Fresnel term is
 * exact, coat and fuzz cover what is opaque only, light is not bent on its way through the coat, and the skin of a dielectric
 * under a coat reflects the same at all angles: what it reflects, in the mean, of light that the coat has bent.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_SPEC_H
#define MEN_BSDF_SPEC_H

#include "optics/bsdf.h"
#include "optics/bsdf_kept.h"
#include "optics/spectrum.h"

/* Weights and roughnesses are in 0..1; a roughness is the artist's, the square root of alpha. bsdf_spec_init gives the
 * values in brackets. */
typedef struct BsdfSpec {
    Spectrum base_color;                 /* albedo of the diffuse base, reflectance of the metal head on [0.8] */
    float base_diffuse_roughness;        /* [0] */
    float base_metalness;                /* the part that is metal [0] */
    bool measured_metal;                 /* metal_n and metal_k instead of base_color */
    Spectrum metal_n, metal_k;           /* relative to vacuum */
    float specular_weight;               /* scales what a dielectric reflects head on; 0: a bare diffuse base [1] */
    float specular_roughness;            /* [0.3] */
    float specular_roughness_anisotropy; /* 1: along the tangent only, about [0] */
    Spectrum specular_ior;               /* relative to vacuum [1.5] */
    float transmission_weight;           /* the part of what is not metal that is clear [0] */
    Spectrum transmission_color;         /* thin walls: what one crossing of the wall leaves [1] */
    float coat_weight;                   /* [0] */
    Spectrum coat_color;                 /* [1] */
    float coat_roughness;                /* [0] */
    float coat_roughness_anisotropy;     /* [0] */
    Spectrum coat_ior;                   /* relative to vacuum [1.6] */
    float fuzz_weight;                   /* [0] */
    Spectrum fuzz_color;                 /* [1] */
    float fuzz_roughness;                /* [0.5] */
    bool thin_walled;   /* what is clear is a sheet, with the medium of the point on both sides [false] */
    float translucency; /* thin walls: the part of the diffuse light that comes out on the far side [0] */
    float mix_weight;   /* of a surface that is a mix of two: the part of the second; not for bsdf_from_spec */
    Spectrum film_ior;  /* of a film on a boundary or a metal; a thin wall's is specular_ior [1.4] */
    float
        film_thickness_nm; /* a thin wall's own, or that of a film on what is smooth and clear, or metal; below 0: none [-1] */
} BsdfSpec;

void bsdf_spec_init(BsdfSpec *spec);

/* alpha along the tangent and across of a roughness and an anisotropy: OpenPBR 1.1, "Microfacet model". Facets take the
 * smaller of two alphas as at least STRETCHED_LEAST_RATIO of the larger. */
void bsdf_alphas(float roughness, float anisotropy, float *alpha_x, float *alpha_y);

/* The index on the same side of 1 whose head-on reflectance is weight times as large. */
Lanes bsdf_weakened(Lanes eta, float weight);

/* eta_i: the medium that owns the point; eta_t: the one behind, for what is clear and not thin. specular_weight scales
 * the reflectance through the index: eta such that F0 = weight * F0. kept: of that surface between these
 * media, or NULL; not owned. */
void bsdf_from_spec(const BsdfSpec *spec, Lanes wavelength_nm, Lanes eta_i, Lanes eta_t, const BsdfKept *kept,
                    Bsdf *bsdf);
/* The layers of a surface, in a medium of index eta_i, that are the same at all wavelengths: false where there is none, or it is not
 * so. Of its skin, as it stands bare; and of its coat. */
bool bsdf_skin_look(const BsdfSpec *spec, float eta_i, LayerLook *look);
bool bsdf_coat_look(const BsdfSpec *spec, float eta_i, LayerLook *look);
/* What of diffuse light between a coat and the base under it the base's own skin reflects; 0: it has none. */
float bsdf_inner_reflectance(const BsdfSpec *spec, Lanes eta_i, Lanes wavelength_nm);
/* From n fours of reflectances of what is not metal to those of the whole: the part of it that is a measured metal has what that
 * mirrors head on, in air. */
void bsdf_mix_metal(const BsdfSpec *spec, const Lanes *wavelength_nm, int n, Lanes *reflectance);

#endif
