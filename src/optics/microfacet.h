/* microfacet.h - the GGX distribution of facets, and what keeps it from losing light.
 * Local frame: z is the mean normal. A direction w counts by |w.z|; s(w) = sqrt(z^2 + (alpha_x x)^2 + (alpha_y y)^2),
 * with which Smith's masking G1 = 2 z / (z + s) and the height-correlated G2 = 2 z_v z_l / (z_v s_l + z_l s_v) have no
 * singularity at grazing angles: [Heitz14] eqs. 72 and 99.
 * For transmission G2 is taken as the smaller of the two G1, which is its upper bound. Heitz's G2 has light that passes
 * one facet end at the next; but between nearly equal indices it goes on, and with this G2 all of it does, so that a
 * boundary that cannot be seen is not seen, however rough.
 *
 * Light that meets more than one facet is missing in a model of one. It is put back so that the whole reflects and
 * transmits what comes in, in ways that are reciprocal. At boundaries a diffuse lobe is added on each side, in proportion
 * to what is missing at v and at l ([KC17]). Where facets are mirrors, f(v, l) becomes f(v, l) k(v) k(l) with a k that makes
 * the albedo 1, which is the scaling of a symmetric matrix to given row sums (R. Sinkhorn, "A Relationship between
 * Arbitrary Positive Matrices and Doubly Stochastic Matrices", 1964) and needs no lobe of its own. The tables are solved at
 * build time by microfacet_gen.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MICROFACET_H
#define MEN_MICROFACET_H

#include <stdint.h>

#include "base/lanes.h"
#include "base/vec3.h"
#include "optics/sampling.h"

/* Rougher than 0, below this: smooth. Facets tilted by a thousandth blur by less than a pixel. */
#define MICROFACET_SMOOTH_ALPHA 1e-3f

static inline float microfacet_slope(float alpha_x, float alpha_y, Vec3f w) /* s(w) */
{
    float x = alpha_x * w.x, y = alpha_y * w.y;
    return sqrtf(w.z * w.z + (x * x + y * y));
}

/* Density of facet normals per steradian and projected area, at a normal of h.z > 0. */
static inline float microfacet_density(float alpha_x, float alpha_y, Vec3f h)
{
    float x = h.x / alpha_x, y = h.y / alpha_y, q = x * x + y * y + h.z * h.z;
    return 1 / (SAMPLING_PI * alpha_x * alpha_y * q * q);
}

/* A facet normal as seen from v: [DB23].
 * Density D(h) (v.h) 2 / (v.z + s(v)). */
static inline Vec3f microfacet_visible(float alpha_x, float alpha_y, Vec3f v, const float u[2])
{
    Vec3f stretched = vec3f_normalize(vec3f(alpha_x * v.x, alpha_y * v.y, v.z));
    float up = (1 - u[0]) * (1 + stretched.z); /* z of the sum; kept apart, as it may be small */
    float z = up - stretched.z, radius = sqrtf(float_max(1 - z * z, 0)), x, y;
    sampling_circle(u[1], &x, &y);
    return vec3f_normalize(
        vec3f(alpha_x * (stretched.x + radius * x), alpha_y * (stretched.y + radius * y), float_max(up, 1e-12f)));
}

/* G2(v, l) / G1(v) of two directions given by |z| and s: reflected, transmitted. */
static inline float microfacet_shadowing(float z_v, float s_v, float z_l, float s_l)
{
    return z_l * (z_v + s_v) / (z_v * s_l + z_l * s_v);
}
static inline float microfacet_shadowing_through(float z_v, float s_v, float z_l, float s_l)
{
    return float_min(1, z_l * (z_v + s_v) / (z_v * (z_l + s_l)));
}

/* ---- the tables ---- */

enum { MICROFACET_ANGLES = 65, MICROFACET_ROUGHNESSES = 33, MICROFACET_INDICES = 40 };

/* Angles are tabulated by the mean of cosine, masking, and what is between, so that the grazing part, of the width of
 * alpha, the way from there on, and the rest have a third of the knots each; 0..1. */
static inline float microfacet_angle(float z, float s)
{
    float tilt = sqrtf(float_max((s - z) * (s + z), 0)); /* alpha times the sine */
    return z * (1.0f / 3) * (1 + 2 / (z + s) + 1 / (z + 6 * tilt));
}
/* On the side of the larger index most happens about the critical angle, of cosine c > 0, within the width of what facets
 * tilt: three fifths of the knots are for that. */
static inline float microfacet_angle_within(float z, float s, float c, float alpha)
{
    float per_width = 1 / (alpha + 0.0005f), near = (z - c) * per_width, least = -c * per_width,
          most = (1 - c) * per_width;
    float at = near / (1 + fabsf(near)), from = least / (1 - least), to = most / (1 + most);
    return 0.4f * microfacet_angle(z, s) + 0.6f * (at - from) / (to - from);
}
/* The cosine at which a smooth boundary reflects about as much as a rough one does at z: past the critical angle, softly. */
static inline float microfacet_softened(float z, float c, float alpha)
{
    float past = z - c;
    return 0.5f * (z + c + sqrtf(past * past + alpha * alpha));
}
/* cosine of the critical angle towards a relative index n < 1 */
static inline float microfacet_critical(float n)
{
    return sqrtf(float_max((1 - n) * (1 + n), 1e-6f));
}
/* alpha by its root, the artist's roughness. A relative index n by the fourth root of |n - 1| / (n + 1), over what that is for the largest:
 * the critical angle goes with the root of n - 1, and most happens near 1; up to 10, beyond as at 10. */
#define MICROFACET_LARGEST_CONTRAST (9.0f / 11)
/* place: 0 .. 1, among the rows of a table; n >= 1 */
static inline float microfacet_index_at(float place)
{
    float contrast = MICROFACET_LARGEST_CONTRAST * place * place * place * place;
    return (1 + contrast) / (1 - contrast);
}

/* values -1 .. 1 as (x + 1) * MICROFACET_ONE */
#define MICROFACET_ONE 32767
typedef uint16_t MicrofacetTable[2][MICROFACET_INDICES][MICROFACET_ROUGHNESSES][MICROFACET_ANGLES];
/* [0]: seen from the side of the smaller index, [1]: from the other */
/* What one facet neither reflects nor transmits. */
extern const MicrofacetTable microfacet_missing;
/* What one facet reflects, less the Fresnel reflectance of the smooth boundary at that angle; on side 1 at the softened
 * one. */
extern const MicrofacetTable microfacet_excess;
/* The same for diffuse light: what is missing, and what is reflected. */
typedef float MicrofacetMeans[2][MICROFACET_INDICES][MICROFACET_ROUGHNESSES];
extern const MicrofacetMeans microfacet_missing_mean, microfacet_reflected_mean;
/* k where every facet is a perfect mirror, and the mean albedo of such a surface without k. */
extern const float microfacet_mirror_scaling[MICROFACET_ROUGHNESSES][MICROFACET_ANGLES];
extern const float microfacet_mirror_mean[MICROFACET_ROUGHNESSES];

/* A place between knots. */
typedef struct MicrofacetPlace {
    int knot; /* and the one behind it */
    float fraction;
} MicrofacetPlace;

static inline MicrofacetPlace microfacet_place(float position, int n_knots) /* position: 0..1 over all knots */
{
    position *= (float)(n_knots - 1);
    position = position > 0 ? position : 0; /* NaN gives 0 */
    int knot = position < (float)(n_knots - 2) ? (int)position : n_knots - 2;
    return (MicrofacetPlace){knot, float_min(position - (float)knot, 1)};
}

/* Where a boundary's roughness and the relative indices eta_t / eta_i of the lanes are in the tables. */
typedef struct MicrofacetIndex {
    MicrofacetPlace roughness;
    Lanes fraction;
    float alpha;    /* of all directions about the normal */
    float critical; /* microfacet_critical, about, as the same for all lanes */
    unsigned char side[LANES], cell[LANES];
    bool one_cell;  /* all lanes are in one cell */
    bool any_dense; /* side is set for some lane */
} MicrofacetIndex;

MicrofacetIndex microfacet_index(float alpha_x, float alpha_y, Lanes eta);
/* The same in tables of other sizes. */
MicrofacetIndex microfacet_index_among(float alpha_x, float alpha_y, Lanes eta, int n_roughnesses, int n_indices);
/* A table for a direction of |z| and s; behind: it is on the far side of the boundary. */
Lanes microfacet_lookup(const MicrofacetTable table, const MicrofacetIndex *index, bool behind, float z, float s);
Lanes microfacet_lookup_mean(const MicrofacetMeans means, const MicrofacetIndex *index, bool behind);
float microfacet_mirror(MicrofacetPlace roughness, float angle); /* k of mirrors */
float microfacet_mirror_albedo(MicrofacetPlace roughness);       /* their mean albedo without k */

#endif
