/* layered.h - tables of what becomes of light under a clear layer, of fuzz, and of stretched facets.
 *
 * A surface that scatters f(v, l), all of it where it is white, under a layer that lets T(v) in: what comes out must
 * be T(v) again, and the same both ways. f(v, l) t(v) t(l) does that for one function t, found as in microfacet.h. Over
 * a smooth mirror it is sqrt(T), over Lambert's law T / sqrt(mean T). The tables hold the factor by which t departs from
 * these: under_mirror for facets of a roughness from the first, under_diffuse for EON from the other; and as rough facets
 * spread light as EON does, from the other for them, too, but for the smoothest. What fuzz stands
 * on is treated alike.
 *
 * Fuzz: the microfiber distribution D = (2 + e) / (2 pi) sin(h)^e of A. Conty Estevez, C. Kulla, "Production Friendly
 * Microfacet Sheen BRDF" (2017), with 1 / e from 0.25 to 1, and the visibility 1 / (4 (v.z + l.z - v.z l.z)) of D.
 * Neubelt, M. Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886" (2013). It is reciprocal and, for
 * these exponents, reflects less than all from any direction.
 *
 * Stretched facets, of different alphas along x and y: what k of mirrors (microfacet.h) is over that of round ones of the
 * same root mean square of alphas at the same microfacet_angle.
 *
 * Solved at build time by layered_gen.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LAYERED_H
#define MEN_LAYERED_H

#include "optics/microfacet.h"

enum {
    LAYERED_ANGLES = 33,
    LAYERED_INDICES = 12,     /* of the layer, as those of microfacet.h */
    LAYERED_ROUGHNESSES = 13, /* of the layer */
    LAYERED_MIRRORS = 9,      /* roughnesses of what is under it, from 0 to 1 */
    LAYERED_DIFFUSES = 4,     /* the same of EON */
    LAYERED_FUZZ = 9,         /* roughnesses of fuzz */
    LAYERED_SHARES = 3,       /* of what it stands on that is covered, from 0 to 1 */
    STRETCHED_ROUGHNESSES = 9,
    STRETCHED_RATIOS = 6,   /* 1 minus the root of the smaller alpha over the larger, from 0 to 1 */
    STRETCHED_AZIMUTHS = 9, /* |y| / (|x| + |y|), x along the larger alpha */
    STRETCHED_ANGLES = 33
};

typedef float LayeredTable[LAYERED_ROUGHNESSES][2][LAYERED_INDICES][LAYERED_ANGLES];
extern const LayeredTable layered_under_mirror[LAYERED_MIRRORS], layered_under_diffuse[LAYERED_DIFFUSES];
typedef float LayeredFuzzTable[LAYERED_FUZZ][LAYERED_SHARES][LAYERED_ANGLES];
extern const LayeredFuzzTable layered_fuzz_mirror[LAYERED_MIRRORS], layered_fuzz_diffuse[LAYERED_DIFFUSES];
extern const float layered_fuzz_albedo[LAYERED_FUZZ][LAYERED_ANGLES]; /* by the root of the cosine */

/* Which of these: t of a row of under_mirror, under a layer, is u sqrt(T) (T / mean T)^(quarters / 4). */
static inline int layered_quarters(int row)
{
    return row < 2 ? 0 : row == 2 ? 1 : 2;
}
/* base: among the rows of the table; index: of the layer, of microfacet_index_among; angle 0..1: microfacet_angle of
 * the facets, or the cosine over EON. */
Lanes layered_lookup(const LayeredTable table[], MicrofacetPlace base, const MicrofacetIndex *index, float angle);
/* The same under fuzz. */
float layered_lookup_fuzz(const LayeredFuzzTable table[], MicrofacetPlace base, MicrofacetPlace roughness, float share,
                          float angle);
float layered_fuzz(MicrofacetPlace roughness, float cosine);

extern const float stretched_mirror[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES];
/* Where alphas are in it. */
typedef struct StretchedPlace {
    MicrofacetPlace roughness, ratio;
    bool along_y; /* the larger alpha is that along y */
} StretchedPlace;
static inline StretchedPlace stretched_place(float alpha_x, float alpha_y)
{
    float square = 0.5f * (alpha_x * alpha_x + alpha_y * alpha_y);
    float ratio = float_min(alpha_x, alpha_y) / float_max(alpha_x, alpha_y);
    return (StretchedPlace){microfacet_place(sqrtf(sqrtf(square)), STRETCHED_ROUGHNESSES),
                            microfacet_place(1 - sqrtf(ratio), STRETCHED_RATIOS), alpha_y > alpha_x};
}
static inline float stretched_azimuth(Vec3f w, bool along_y)
{
    float x = fabsf(along_y ? w.y : w.x), y = fabsf(along_y ? w.x : w.y);
    return y / (x + y + 1e-20f);
}
float stretched_lookup(const StretchedPlace *place, Vec3f w, float angle);

static inline float layered_fuzz_exponent(float roughness)
{
    return 1 / (0.25f + 0.75f * roughness);
}
/* f of fuzz */
static inline float layered_fuzz_value(float exponent, Vec3f view, Vec3f light)
{
    Vec3f h = vec3f_normalize(vec3f_add(view, light));
    float distribution =
        (2 + exponent) / (2 * SAMPLING_PI) * powf(float_max((1 - h.z) * (1 + h.z), 0), 0.5f * exponent);
    return distribution / (4 * (view.z + light.z - view.z * light.z));
}

#endif
