/* bsdf.h - how a surface scatters light: sampling directions, and evaluating given ones.
 * Local frame: z is the (shading) normal on the side that the path comes from. view points to where the path came from,
 * view.z > 0; light is the other direction, light.z > 0 for reflection, < 0 for transmission. Unit vectors.
 *
 * Radiance is basic radiance, L / n^2, so that transmission needs no factor n^2. f is then reciprocal in the sense
 * f(v, l) / n_l^2 = f(l, v) / n_v^2 with the indices of the media that v and l are in. "f_cos" is f |cos(light)|.
 *
 * The four wavelengths of a path: directions are sampled for lane 0, the hero. pdf_w holds for every lane the density
 * with which the direction would have been sampled had that lane been the hero, for weighting over the wavelengths
 * ([WNDWH14]).
 *
 * A Bsdf is made for one hit: bsdf_begin, then one bsdf_add_* per lobe, those under a coat between bsdf_begin_coat and
 * bsdf_end_coat, and bsdf_set_fuzz at the end if at all. It refers to nothing else. alpha is that of GGX, the square of
 * an artist's roughness; below 1e-3 a surface counts as smooth.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_H
#define MEN_BSDF_H

#include "optics/bsdf_lobe.h"

enum { BSDF_LOBES = 8 };

/* What a direction goes through on its way to the lobes. */
typedef struct BsdfCovers {
    Lanes reflectance, passed; /* of the coat */
    float fuzz;                /* what it lets pass */
    float skin;                /* fuzz_to_base() of the coat */
} BsdfCovers;

/* How often what is over the lobes is sampled rather than these. */
typedef struct BsdfChances {
    float fuzz;
    Lanes coat;
} BsdfChances;

typedef struct Bsdf {
    uint32_t n_lobes;
    float total, opaque_share, coat_share; /* sums of shares: of all lobes, of those that fuzz covers, and a coat */
    bool transmits;                        /* light may come from below */
    bool specular_only;                    /* bsdf_evaluate gives 0 for all directions */
    bool looked;                           /* at from: */
    Vec3f view;
    BsdfCovers covers;                /* of that view, where there are any */
    BsdfChances chances;              /* likewise */
    bool coating;                     /* between bsdf_begin_coat and bsdf_end_coat */
    Lanes opaque_albedo, coat_albedo; /* about, of these lobes: the sums over their shares */
    const BsdfLayer *coat;            /* own_coat, or one that was made before */
    BsdfLayer own_coat;
    BsdfFuzz fuzz;          /* share 0: none */
    const Balance *balance; /* NULL: none */
    BsdfLobe lobes[BSDF_LOBES];
} Bsdf;

typedef struct BsdfSample {
    Vec3f direction;
    Lanes weight;  /* f |cos| / the hero's density; f as above */
    Lanes pdf_w;   /* per steradian; of a specular sample the probability with which its way was chosen */
    bool specular; /* sampled from no density: the direction is the only one, and bsdf_evaluate does not know it */
    bool transmitted;
    bool hero_only; /* other wavelengths go elsewhere; weight and pdf_w are 0 in the other lanes */
} BsdfSample;

/* share: the part of the surface that is covered with the lobe, 0..1; all together at most 1, less absorbs. More than
 * BSDF_LOBES lobes and shares of 0 are left out. */
void bsdf_begin(Bsdf *bsdf);
/* Next, if at all: what is known of the surface; not owned, NULL: nothing. */
void bsdf_set_balance(Bsdf *bsdf, const Balance *balance);
/* roughness 0: Lambert; up to 1: EON, J. Portsmouth, P. Kutz, S. Hill, "EON: A Practical Energy-Preserving Rough
 * Diffuse BRDF" (2024). albedo 0..1. */
void bsdf_add_diffuse(Bsdf *bsdf, float share, Lanes albedo, float roughness);
/* Lambert's law for light that comes out on the far side. */
void bsdf_add_translucent(Bsdf *bsdf, float share, Lanes albedo);
/* n + i k relative to the medium in front, and so is the film on it; NULL: there is none. */
void bsdf_add_conductor(Bsdf *bsdf, float share, Lanes n, Lanes k, float alpha_x, float alpha_y, const ThinFilm *film);
/* Facets that reflect all. */
void bsdf_add_mirrors(Bsdf *bsdf, float share, float alpha_x, float alpha_y);
/* Not under a coat. A clear layer of relative index eta over a diffuse base; tint: what a crossing of the layer along
 * the normal leaves, squared, which is about the colour that a white base gets; 1: clear. */
void bsdf_add_plastic(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint, Lanes albedo,
                      float roughness);
/* The same with a layer that was made before, with bsdf_kept.h: not owned. */
void bsdf_add_plastic_kept(Bsdf *bsdf, float share, const BsdfLayer *skin, Lanes albedo, float roughness);
/* The boundary between the medium of view, eta_i, and the one behind. film: NULL, or one on it, relative to what the indices are; it is
 * smooth then, whatever the alphas. */
void bsdf_add_boundary(Bsdf *bsdf, float share, Lanes eta_i, Lanes eta_t, float alpha_x, float alpha_y,
                       const ThinFilm *film);
/* A dielectric sheet without thickness, all its internal reflections summed; eta relative to the medium on both sides;
 * tint: what one crossing along the normal leaves. Both lobes, reflected and straight on, have the same facets. film:
 * NULL where it is too thick for interference; else relative to that medium, and of index eta. */
void bsdf_add_sheet(Bsdf *bsdf, float share, Lanes eta, float alpha_x, float alpha_y, Lanes tint, const ThinFilm *film);
/* The one clear layer over the diffuse, conductor and mirror lobes that are added until bsdf_end_coat; as in
 * bsdf_add_plastic. */
void bsdf_begin_coat(Bsdf *bsdf, Lanes eta, float alpha_x, float alpha_y, Lanes tint);
void bsdf_begin_coat_kept(Bsdf *bsdf, const BsdfLayer *coat); /* as bsdf_add_plastic_kept */
void bsdf_end_coat(Bsdf *bsdf);
/* Fibres on all that is opaque: the part of it that they stand on, 0..1; roughness 0..1, how far they are from upright. */
void bsdf_set_fuzz(Bsdf *bsdf, float share, Lanes color, float roughness);

/* How bright it is in the mirrored direction, and straight on: smooth sheets choose between the two accordingly. */
void bsdf_set_brightness(Bsdf *bsdf, const float brightness[2]);
/* Keeps what depends on a view alone, when all lobes are there, which makes evaluating and sampling for that view faster. */
void bsdf_look(Bsdf *bsdf, Vec3f view);
/* Sums over all lobes that are not specular. pdf_w: of bsdf_sample. */
void bsdf_evaluate(const Bsdf *bsdf, Vec3f view, Vec3f light, Lanes *f_cos, Lanes *pdf_w);
/* What goes through smooth sheets without changing its direction, of light at an angle of that cosine: what bsdf_sample
 * finds as specular and transmitted. */
Lanes bsdf_straight(const Bsdf *bsdf, float cosine);
/* u_choice, u: uniform in [0,1). false: the light is absorbed. What is sampled without specular has exactly the f_cos
 * and pdf_w of bsdf_evaluate. */
bool bsdf_sample(const Bsdf *bsdf, Vec3f view, float u_choice, const float u[2], BsdfSample *sample);

#endif
