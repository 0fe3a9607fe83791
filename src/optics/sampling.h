/* sampling.h - directions and discs from two uniform numbers, and the weight for combining techniques.
 * u and v are in [0,1). Maps without a seam where there is a choice, so that low-discrepancy points
 * stay well spread.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SAMPLING_H
#define MEN_SAMPLING_H

#include "base/angle.h"
#include "base/lanes.h"
#include "base/vec3.h"

#define SAMPLING_PI ((float)MEN_PI)

/* Two unit vectors that make a right-handed basis with the unit vector normal: T. Duff, J. Burgess,
 * P. Christensen, C. Hery, A. Kensler, M. Liani, R. Villemin, "Building an Orthonormal Basis,
 * Revisited", JCGT 6(1), 2017, listing 3. */
static inline void sampling_basis(Vec3f normal, Vec3f *tangent, Vec3f *bitangent)
{
    float sign = copysignf(1.0f, normal.z);
    float a = -1.0f / (sign + normal.z), b = normal.x * normal.y * a;
    *tangent = vec3f(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    *bitangent = vec3f(b, sign + normal.y * normal.y * a, -normal.y);
}

/* local (z along normal) to the space of normal */
static inline Vec3f sampling_to_world(Vec3f local, Vec3f normal)
{
    Vec3f tangent, bitangent;
    sampling_basis(normal, &tangent, &bitangent);
    return vec3f_along(vec3f_along(vec3f_scale(tangent, local.x), local.y, bitangent), local.z, normal);
}

/* Sine and cosine of t pi / 4 for -1 <= t <= 1, to 1e-7 and never beyond 1: polynomials through Chebyshev's nodes, the same on
 * every machine. */
static inline void sampling_eighth(float t, float *sine, float *cosine)
{
    float z = t * t;
    *sine = t * (0.785398161f + z * (-0.0807454347f + z * (0.0024900068f + z * -3.59542907e-5f)));
    *cosine = 1 + z * (-0.308425135f + z * (0.0158543252f + z * (-0.000325938586f + z * 3.52979713e-6f)));
}

/* a and b in lanes 0 and 1 where less < more, else b and a: without a branch. */
static inline Lanes sampling_either_way(Lanes less, Lanes more, float a, float b)
{
    return lanes_select_less(less, more, lanes(a, b, 0, 0), lanes(b, a, 0, 0));
}

/* The point of the circle of radius 1 that is u of a turn from x on, 0 <= u < 2: u times 2 pi, but the same on every machine.
 * Which quarter it is in no processor can foretell: without branches. */
static inline void sampling_circle(float u, float *x, float *y)
{
    int quarter = (int)(4 * u + 0.5f);
    float sine, cosine; /* as if it were in the quarter about x */
    sampling_eighth(8 * u - 2 * (float)quarter, &sine, &cosine);
    Lanes even = lanes_all((float)(1 - (quarter & 1)));
    Lanes point = sampling_either_way(lanes_all(0), even, cosine, sine);
    *x = (float)(1 - ((quarter + 1) & 2)) * lanes_get(point, 0);
    *y = (float)(1 - (quarter & 2)) * lanes_get(point, 1);
}

/* Uniform on the disc of radius 1: P. Shirley, K. Chiu, "A Low Distortion Map Between Disk and Square",
 * JGT 2(3), 1997, in the two-branch form of D. Cline. pdf 1/pi. Returns how far from the middle the point is, or less that.
 * Which of the numbers is the larger no processor can foretell, and in memory they would have to be waited for: so both ways
 * are taken, side by side in lanes. */
static inline float sampling_disc(float u, float v, float *x, float *y)
{
    float a = 2 * u - 1, b = 2 * v - 1, sine, cosine;
    Lanes size_a = lanes_all(fabsf(a)), size_b = lanes_all(fabsf(b));
    Lanes place = sampling_either_way(size_b, size_a, a, b);
    float radius = lanes_get(place, 0);
    sampling_eighth(radius != 0 ? lanes_get(place, 1) / radius : 0, &sine, &cosine);
    Lanes disc = sampling_either_way(size_b, size_a, cosine, sine);
    *x = radius * lanes_get(disc, 0);
    *y = radius * lanes_get(disc, 1);
    return radius;
}

/* Uniform on a polygon of n corners, x and y of each, of which each side makes a triangle of the same area with the middle,
 * <0, 0>: as in sampling_disc, squares about the middle become the polygon's own shape, and their turn goes around it with the
 * area. */
static inline void sampling_polygon(float u, float v, const float *corners, uint32_t n, float *x, float *y)
{
    float a = 2 * u - 1, b = 2 * v - 1, size = float_max(fabsf(a), fabsf(b)), turn = 0;
    if (fabsf(a) > fabsf(b))
        turn = (a > 0 ? 0.125f : 0.625f) + 0.125f * (b / a);
    else if (b != 0)
        turn = (b > 0 ? 0.375f : 0.875f) - 0.125f * (a / b);
    float place = turn * (float)n;
    uint32_t side = (uint32_t)place < n ? (uint32_t)place : n - 1;
    float along = place - (float)side;
    const float *from = corners + 2 * side, *to = corners + 2 * (side + 1 < n ? side + 1 : 0);
    *x = size * (from[0] + along * (to[0] - from[0]));
    *y = size * (from[1] + along * (to[1] - from[1]));
}

/* In proportion to the cosine about the unit normal (N. Malley: the disc, projected up). Never below the
 * surface; *pdf_w is cos/pi and above 0. The height needs the distance from the middle alone, and so need not wait for the
 * point. */
static inline Vec3f sampling_cosine_hemisphere(float u, float v, Vec3f normal, float *pdf_w)
{
    float x, y, radius = sampling_disc(u, v, &x, &y);
    float z = sqrtf(float_max(1e-12f, (1 - radius) * (1 + radius)));
    *pdf_w = z * (1 / SAMPLING_PI);
    return sampling_to_world(vec3f(x, y, z), normal);
}

static inline Vec3f sampling_sphere(float u, float v)
{
    float z = 1 - 2 * u, radius = 2 * sqrtf(float_max(0.0f, u * (1 - u))), x, y;
    sampling_circle(v, &x, &y);
    return vec3f(radius * x, radius * y, z);
}

/* Uniform in the cone about the unit axis. one_minus_cos: of the half angle, 0..2; taken so, and not as
 * the cosine, because the sun's is 1e-5. pdf per steradian: sampling_cone_pdf. */
static inline Vec3f sampling_cone(float u, float v, Vec3f axis, float one_minus_cos)
{
    /* the disc map keeps the sample set's shape: squared radius in the disc is u's share of the cap */
    float x, y, radius = sampling_disc(u, v, &x, &y);
    float height = one_minus_cos * (radius * radius); /* 1 - cos of the sample */
    float stretch = sqrtf(float_max(0.0f, one_minus_cos * (2 - height)));
    return sampling_to_world(vec3f(x * stretch, y * stretch, 1 - height), axis);
}
static inline float sampling_cone_pdf(float one_minus_cos)
{
    return 1 / (2 * SAMPLING_PI * one_minus_cos);
}

/* Places t on a line, begin <= t <= end, in proportion to 1 / (distance^2 + t^2), so that they are spread evenly over the
 * angle under which a place beside the line's t = 0, at that distance > 0, sees them: C. Kulla, M. Fajardo, "Importance
 * Sampling Techniques for Path Tracing in Participating Media", EGSR 2012, section 3. angle: sampling_angle, > 0. */
static inline double sampling_angle(double distance, double begin, double end)
{
    return atan2(distance * (end - begin), distance * distance + end * begin);
}
static inline double sampling_equiangular(double u, double distance, double begin, double end, double angle)
{
    double first = begin / distance, further = tan(u * angle), t;
    t = distance * (first + further) / (1 - first * further);
    return fmin(fmax(t, begin), end);
}
static inline double sampling_equiangular_pdf(double t, double distance, double begin, double end, double angle)
{
    return t < begin || t > end ? 0 : distance / (angle * (distance * distance + t * t));
}

/* 0 <= t <= end in proportion to e^(-rate t); rate > 0. */
static inline double sampling_exponential(double u, double rate, double end)
{
    return fmin(-log1p(u * expm1(-rate * end)) / rate, end);
}
static inline double sampling_exponential_pdf(double t, double rate, double end)
{
    return -rate * exp(-rate * t) / expm1(-rate * end);
}

/* Weight of a sample of density pdf_a where another technique has pdf_b there: E. Veach, "Robust Monte
 * Carlo Methods for Light Transport Simulation" (1997), 9.2.2. Formed from the ratio, so that densities
 * up to FLT_MAX do not overflow. pdf_a > 0. */
static inline float sampling_balance(float pdf_a, float pdf_b)
{
    return 1 / (1 + pdf_b / pdf_a);
}

#endif
