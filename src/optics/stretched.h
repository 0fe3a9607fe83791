/* stretched.h - tables of what becomes of light at stretched facets, of different alphas along x and y.
 * A direction sees facets about as round ones of one alpha, stretched_alpha: near the normal they tilt it by the root mean
 * square of both, far from it by that along its azimuth. The tables of microfacet.h are asked for these; here is what
 * stretched facets do beyond that: a factor to k of mirrors, and what is to be added to what a boundary's facets miss and
 * reflect. Solved at build time by stretched_gen.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_STRETCHED_H
#define MEN_STRETCHED_H

#include "optics/microfacet.h"

enum {
    STRETCHED_ROUGHNESSES = 11, /* the root of the root mean square of the alphas */
    STRETCHED_RATIOS = 7,       /* 1 minus the root of the smaller alpha over the larger, from 0 to the least */
    STRETCHED_AZIMUTHS = 9,     /* |y| / (|x| + |y|), x along the larger alpha */
    STRETCHED_ANGLES = 33,      /* of mirrors */
    STRETCHED_INDICES = 12,     /* as those of microfacet.h, fewer */
    STRETCHED_STEPS = 17        /* of angles at boundaries */
};

/* The smaller alpha over the larger is at least this. */
#define STRETCHED_LEAST_RATIO 0.05f

/* Where facets are in the tables. */
typedef struct StretchedPlace {
    MicrofacetPlace roughness, ratio;
    bool along_y; /* the larger alpha is that along y */
} StretchedPlace;

static inline StretchedPlace stretched_place(float alpha_x, float alpha_y)
{
    float square = 0.5f * (alpha_x * alpha_x + alpha_y * alpha_y);
    float ratio = float_min(alpha_x, alpha_y) / float_max(alpha_x, alpha_y);
    float rest = (1 - sqrtf(ratio)) / (1 - sqrtf(STRETCHED_LEAST_RATIO));
    return (StretchedPlace){microfacet_place(sqrtf(sqrtf(square)), STRETCHED_ROUGHNESSES),
                            microfacet_place(rest, STRETCHED_RATIOS), alpha_y > alpha_x};
}
static inline float stretched_azimuth(Vec3f w, bool along_y)
{
    float x = fabsf(along_y ? w.y : w.x), y = fabsf(along_y ? w.x : w.y);
    return y / (x + y + 1e-20f);
}
static inline float stretched_alpha(float alpha_x, float alpha_y, Vec3f w)
{
    float x = alpha_x * alpha_x, y = alpha_y * alpha_y;
    return sqrtf(w.x * w.x * x + w.y * w.y * y + w.z * w.z * 0.5f * (x + y));
}
/* s of round facets of that alpha */
static inline float stretched_slope(float alpha, float z)
{
    return sqrtf(z * z + alpha * alpha * float_max((1 - z) * (1 + z), 0));
}

/* The factor to k of mirrors (microfacet.h) of round facets of the same root mean square at the same microfacet_angle. */
extern const float stretched_mirror[STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS][STRETCHED_ANGLES];
float stretched_lookup(const StretchedPlace *place, Vec3f w, float angle);

/* values -1 .. 1 as (x + 1) * MICROFACET_ONE */
typedef uint16_t StretchedTable[2][STRETCHED_INDICES][STRETCHED_ROUGHNESSES][STRETCHED_RATIOS][STRETCHED_AZIMUTHS]
                               [STRETCHED_STEPS];
extern const StretchedTable stretched_missing, stretched_excess;
/* The same for diffuse light, beyond round facets of the same root mean square. */
typedef float StretchedMeans[2][STRETCHED_INDICES][STRETCHED_ROUGHNESSES][STRETCHED_RATIOS];
extern const StretchedMeans stretched_missing_mean, stretched_reflected_mean;

/* A boundary of stretched facets in these tables and those of microfacet.h. */
typedef struct StretchedIndex {
    StretchedPlace place;
    MicrofacetIndex index, among; /* in tables of round facets, whatever the roughness, and here */
    float alpha_x, alpha_y;
} StretchedIndex;
StretchedIndex stretched_index(float alpha_x, float alpha_y, Lanes eta);
/* What facets miss or reflect (microfacet_lookup), all in all: of a table of round facets and its other here. */
Lanes stretched_lookup_boundary(const MicrofacetTable round, const StretchedTable rest, const StretchedIndex *index,
                                bool behind, Vec3f w);
Lanes stretched_lookup_mean(const MicrofacetMeans round, const StretchedMeans rest, const StretchedIndex *index,
                            bool behind);

#endif
