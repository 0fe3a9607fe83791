/* layered.h - tables of what becomes of light under a clear layer, and of fuzz.
 *
 * A surface that scatters f(v, l), all of it where it is white, under a layer that lets T(v) in: what comes out must
 * be T(v) again, and the same both ways. f(v, l) t(v) t(l) does that for one function t, found as in microfacet.h. Over
 * a smooth mirror it is sqrt(T), over Lambert's law T / sqrt(mean T). The tables hold the factor by which t departs from
 * these: under_mirror for facets of a roughness from the first, under_diffuse for EON from the other; and as rough facets
 * spread light as EON does, from the other for them, too, but for the smoothest. What fuzz stands
 * on is treated alike. Under a layer of the smaller index T ends at the critical angle, and facets see that blurred: sqrt(T)
 * becomes T over the root of T at a softened cosine (microfacet_softened).
 *
 * What rough facets send up to the layer goes beyond its critical angle, in part, and comes back: more than the layer reflects of light
 * that comes from outside. The table layered_return has that excess of the first time, and of all later ones as if they were alike, for
 * facets as they are within the layer, where light comes to them bent. Under a layer of the smaller index there is none.
 *
 * Fuzz: the microfiber distribution D = (2 + e) / (2 pi) sin(h)^e of A. Conty Estevez, C. Kulla, "Production Friendly
 * Microfacet Sheen BRDF" (2017), with 1 / e from 0.25 to 1, and the visibility 1 / (4 (v.z + l.z - v.z l.z)) of D.
 * Neubelt, M. Pettineo, "Crafting a Next-Gen Material Pipeline for The Order: 1886" (2013). It is reciprocal and, for
 * these exponents, reflects less than all from any direction.
 *
 * Solved at build time by layered_gen.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LAYERED_H
#define MEN_LAYERED_H

#include "optics/microfacet.h"

enum {
    LAYERED_ANGLES = 33,
    LAYERED_INDICES = 14,           /* of the layer, as those of microfacet.h */
    LAYERED_ROUGHNESSES = 13,       /* of the layer */
    LAYERED_MIRRORS = 17,           /* roughnesses of what is under it, from 0 to 1 */
    LAYERED_DIFFUSES = 4,           /* the same of EON */
    LAYERED_RETURN_ROUGHNESSES = 9, /* the same of facets, for what comes back to them */
    LAYERED_RETURN_ANGLES = 9,      /* by the cosine outside */
    LAYERED_FUZZ = 9,               /* roughnesses of fuzz */
    LAYERED_SHARES = 5,             /* of what it stands on that is covered, from 0 to 1 */
    LAYERED_SKIN_FUZZ = 5,          /* the same for what becomes of a layer's own reflection, in fewer steps */
    LAYERED_SKIN_SHARES = 3,
    LAYERED_SKIN_ROUGHNESSES = 7,
    LAYERED_SKIN_ANGLES = 17
};

typedef float LayeredTable[LAYERED_ROUGHNESSES][2][LAYERED_INDICES][LAYERED_ANGLES];
extern const LayeredTable layered_under_mirror[LAYERED_MIRRORS], layered_under_diffuse[LAYERED_DIFFUSES];
typedef float LayeredFuzzTable[LAYERED_FUZZ][LAYERED_SHARES][LAYERED_ANGLES];
extern const LayeredFuzzTable layered_fuzz_mirror[LAYERED_MIRRORS], layered_fuzz_diffuse[LAYERED_DIFFUSES];
/* What comes out under fuzz of the light that a layer of a roughness reflects, over what it reflects and what the fuzz
 * lets pass from there. */
typedef float LayeredSkinTable[LAYERED_SKIN_FUZZ][LAYERED_SKIN_SHARES][LAYERED_SKIN_ROUGHNESSES][2][LAYERED_INDICES]
                              [LAYERED_SKIN_ANGLES];
extern const LayeredSkinTable layered_fuzz_skin;
typedef float LayeredReturnTable[LAYERED_INDICES][LAYERED_RETURN_ANGLES][2];
extern const LayeredReturnTable layered_return[LAYERED_RETURN_ROUGHNESSES];
extern const float layered_fuzz_albedo[LAYERED_FUZZ][LAYERED_ANGLES]; /* by the root of the cosine */

/* Which of these: t of a row of under_mirror, under a layer, is u sqrt(T) (T / mean T)^(quarters / 4); within, with T' at the
 * softened cosine, u T / sqrt(T') (T' / mean T)^(quarters / 4). */
static inline int layered_quarters(int row)
{
    return row < 3 ? 0 : row < 5 ? 1 : 2;
}
/* base: among the rows of the table; index: of the layer, of microfacet_index_among; angles 0..1, by side of the layer:
 * microfacet_angle and microfacet_angle_within of the facets, or both the cosine over EON. */
Lanes layered_lookup(const LayeredTable table[], MicrofacetPlace base, const MicrofacetIndex *index,
                     const float angles[2]);
/* Of two directions, outside, for both together: *more* of the first time and of later ones. */
void layered_returned(MicrofacetPlace roughness, const MicrofacetIndex *index, const float cosines[2], Lanes more[2]);
/* The same under fuzz. */
float layered_lookup_fuzz(const LayeredFuzzTable table[], MicrofacetPlace base, MicrofacetPlace roughness, float share,
                          float angle);
float layered_fuzz(MicrofacetPlace roughness, float cosine);
/* fuzz, share, roughness: places among the rows of that table; index: as in layered_lookup; angle: microfacet_angle */
Lanes layered_lookup_skin(MicrofacetPlace fuzz, MicrofacetPlace share, MicrofacetPlace roughness,
                          const MicrofacetIndex *index, float angle);

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
