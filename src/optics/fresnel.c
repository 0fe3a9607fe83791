/* fresnel.c - reflectance and refraction at a smooth boundary between two dielectrics, or at a conductor.
 * The equations are Fresnel's as in any text (M. Born, E. Wolf, "Principles of Optics", 1.5.2), written
 * so that nothing cancels. With
 *     a = eta_i cos_i     b = eta_t cos_t     d = eta_t^2 - eta_i^2     b^2 = a^2 + d   (Snell's law)
 * the amplitudes are, up to sign,
 *     r_s = (a - b) / (a + b)                           = -d / (a + b)^2
 *     r_p = (eta_t^2 a - eta_i^2 b) / (eta_t^2 a + eta_i^2 b)
 *         = d (a b - eta_i^2 sin_i^2) / ((a + b) (eta_t^2 a + eta_i^2 b))
 * whose right-hand sides go to zero with d without losing digits.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/fresnel.h"

#include <float.h>

/* A cosine from rounded vectors may lie outside 0..1. Comparisons, here and below, because fmaxf is a
 * call with gcc. */
static inline float clamp_cosine(float cos_i)
{
    return cos_i < 1 ? (cos_i > 0 ? cos_i : 0) : 1;
}

/* The quantities above, for cos_i already in 0..1. */
typedef struct Crossing {
    Lanes eta_i, eta_t, a, b, d; /* b is 0 where reflection is total */
    Lanes per_sum;               /* 1 / (a + b) */
} Crossing;

/* Reflection is total where b^2 is not above zero and d is not zero; fresnel_* and refract_direction both decide by
 * this and so never disagree. In double: the products of floats are exact, and b is right up to the critical angle, where
 * a^2 and d cancel. */
static inline Crossing crossing(float cos_i, Lanes eta_i, Lanes eta_t)
{
    Crossing c = {.eta_i = eta_i, .eta_t = eta_t, .a = lanes_scale(eta_i, cos_i)};
    LanesWide wide_i = lanes_widen(eta_i), wide_t = lanes_widen(eta_t);
    LanesWide a = lanes_wide_mul(wide_i, lanes_wide_all((double)cos_i));
    LanesWide d = lanes_wide_sub(lanes_wide_mul(wide_t, wide_t), lanes_wide_mul(wide_i, wide_i));
    c.d = lanes_narrow(d);
    c.b = lanes_narrow(lanes_wide_add(lanes_wide_mul(a, a), d));
    c.b = lanes_sqrt(lanes_greater(c.b, lanes_all(0)));
    /* both vanish at a grazing ray between equal indices */
    c.per_sum = lanes_div(lanes_all(1), lanes_add(lanes_add(c.a, c.b), lanes_all(FLT_MIN)));
    return c;
}

/* r_s and r_p, up to sign, where reflection is not total. */
static inline void crossing_amplitudes(const Crossing *c, float cos_i, Lanes *r_s, Lanes *r_p)
{
    Lanes square_i = lanes_mul(c->eta_i, c->eta_i), square_t = lanes_mul(c->eta_t, c->eta_t);
    Lanes share = lanes_mul(c->d, c->per_sum);
    Lanes brewster = lanes_sub(lanes_mul(c->a, c->b), lanes_scale(square_i, (1 - cos_i) * (1 + cos_i)));
    Lanes below = lanes_add(lanes_mul(square_t, c->a), lanes_mul(square_i, c->b));
    *r_s = lanes_mul(share, c->per_sum);
    *r_p = lanes_div(lanes_mul(share, brewster), lanes_add(below, lanes_all(FLT_MIN)));
}

/* Branch-free: all outcomes are made and one is chosen. */
static inline Lanes crossing_choose(const Crossing *c, Lanes partial)
{
    const Lanes zero = lanes_all(0), one = lanes_all(1);
    Lanes reflectance = lanes_select_less(zero, c->b, lanes_lesser(partial, one), one);
    return lanes_select_less(zero, lanes_abs(c->d), reflectance, zero);
}

static inline Lanes crossing_reflectance(const Crossing *c, float cos_i)
{
    Lanes r_s, r_p;
    crossing_amplitudes(c, cos_i, &r_s, &r_p);
    return crossing_choose(c, lanes_scale(lanes_add(lanes_mul(r_s, r_s), lanes_mul(r_p, r_p)), 0.5f));
}

float fresnel_dielectric(float cos_i, float eta_i, float eta_t)
{
    return lanes_get(fresnel_dielectric_lanes(cos_i, lanes_all(eta_i), lanes_all(eta_t)), 0);
}

Lanes fresnel_dielectric_lanes(float cos_i, Lanes eta_i, Lanes eta_t)
{
    cos_i = clamp_cosine(cos_i);
    Crossing c = crossing(cos_i, eta_i, eta_t);
    return crossing_reflectance(&c, cos_i);
}

void fresnel_dielectric_polarized(float cos_i, Lanes eta_i, Lanes eta_t, Lanes reflectance[2])
{
    Lanes r_s, r_p;
    cos_i = clamp_cosine(cos_i);
    Crossing c = crossing(cos_i, eta_i, eta_t);
    crossing_amplitudes(&c, cos_i, &r_s, &r_p);
    reflectance[0] = crossing_choose(&c, lanes_mul(r_s, r_s));
    reflectance[1] = crossing_choose(&c, lanes_mul(r_p, r_p));
}

Lanes fresnel_dielectric_pair(Lanes cos_i, Lanes cos_t, Lanes eta_i, Lanes eta_t)
{
    Lanes square_i = lanes_mul(eta_i, eta_i), square_t = lanes_mul(eta_t, eta_t);
    Lanes a = lanes_mul(eta_i, cos_i), b = lanes_mul(eta_t, cos_t);
    Lanes d = lanes_mul(lanes_sub(eta_t, eta_i), lanes_add(eta_t, eta_i));
    Lanes sum = lanes_add(lanes_add(a, b), lanes_all(FLT_MIN));
    Lanes r_s = lanes_div(d, lanes_mul(sum, sum));
    Lanes sine_square = lanes_mul(lanes_rest(cos_i), lanes_add(lanes_all(1), cos_i));
    Lanes brewster = lanes_sub(lanes_mul(a, b), lanes_mul(square_i, sine_square));
    Lanes below = lanes_mul(sum, lanes_add(lanes_mul(square_t, a), lanes_mul(square_i, b)));
    Lanes r_p = lanes_div(lanes_mul(d, brewster), lanes_add(below, lanes_all(FLT_MIN)));
    return lanes_clamp(lanes_scale(lanes_add(lanes_mul(r_s, r_s), lanes_mul(r_p, r_p)), 0.5f), 0, 1);
}

Lanes fresnel_conductor(float cos_i, Lanes n, Lanes k)
{
    float cosine = clamp_cosine(cos_i), square = cosine * cosine, sine_square = (1 - cosine) * (1 + cosine);
    Lanes n_square = lanes_mul(n, n), k_square = lanes_mul(k, k);
    /* (a + i b)^2 = (n + i k)^2 - sin^2 */
    Lanes real = lanes_sub(lanes_sub(n_square, k_square), lanes_all(sine_square));
    Lanes size = lanes_sqrt(lanes_add(lanes_mul(real, real), lanes_scale(lanes_mul(n_square, k_square), 4)));
    Lanes a = lanes_sqrt(lanes_clamp(lanes_scale(lanes_add(size, real), 0.5f), 0, FLT_MAX));
    Lanes s_sum = lanes_add(size, lanes_all(square)), s_mixed = lanes_scale(a, 2 * cosine);
    Lanes r_s = lanes_div(lanes_sub(s_sum, s_mixed), lanes_add(s_sum, lanes_add(s_mixed, lanes_all(FLT_MIN))));
    Lanes p_sum = lanes_add(lanes_scale(size, square), lanes_all(sine_square * sine_square));
    Lanes p_mixed = lanes_scale(s_mixed, sine_square);
    Lanes r_p =
        lanes_mul(r_s, lanes_div(lanes_sub(p_sum, p_mixed), lanes_add(p_sum, lanes_add(p_mixed, lanes_all(FLT_MIN)))));
    return lanes_clamp(lanes_scale(lanes_add(r_s, r_p), 0.5f), 0, 1);
}

Lanes fresnel_conductor_mean(Lanes n, Lanes k)
{
    /* Gauss quadrature for the weight x on 0..1: M. Abramowitz, I. Stegun, "Handbook of Mathematical Functions", table 25.8 */
    const float cosine[3] = {0.2123405382f, 0.5905331356f, 0.9114120405f};
    const float weight[3] = {0.0698269799f, 0.2292411064f, 0.2009319137f};
    Lanes sum = lanes_all(0);
    for (int i = 0; i < 3; i++) sum = lanes_add(sum, lanes_scale(fresnel_conductor(cosine[i], n, k), 2 * weight[i]));
    return sum;
}

/* J. W. T. Walsh (1926), as corrected in S. Q. Duntley, "The Optical Properties of Diffusing
 * Materials", J. Opt. Soc. Am. 32 (1942): diffuse light on a medium n times as dense, n > 1. */
static double mean_from_outside(double n)
{
    double s = n * n, t = s + 1, v = n + 1, u = (n - 1) * v * t; /* u is n^4 - 1 */
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * v * v) + s * (s - 1) * (s - 1) / (t * t * t) * log((n - 1) / v) -
           2 * n * s * (s + 2 * n - 1) / (t * u) + 8 * s * s * (s * s + 1) / (t * u * u) * log(n);
}

float fresnel_dielectric_mean(float eta_i, float eta_t)
{
    /* Nearer to 1 the terms, which grow as (n - 1)^-2, cancel to noise; the mean goes to 0 there about
     * in proportion to n - 1 (within 0.1 %). */
    const double nearest = 1 + 1e-4;
    bool inside = eta_i > eta_t;
    double n = inside ? (double)eta_i / (double)eta_t : (double)eta_t / (double)eta_i;
    double mean = n >= nearest ? mean_from_outside(n) : mean_from_outside(nearest) * (n - 1) / (nearest - 1);
    /* Reciprocity: what a diffuse radiance passes is the same both ways, and inside it is spread over
     * n^2 times the solid angle, so 1 - F_inside = (1 - F_outside) / n^2. */
    return (float)(inside ? 1 - (1 - mean) / (n * n) : mean);
}

/* Snell: eta_t t = eta_i d + (a - b) n, with a - b = -d / (a + b). The length of that is eta_t but for rounding, most of
 * which one step of Newton's root takes off. */
static inline bool crossing_refract(const Crossing *c, Vec3f direction, Vec3f normal, Vec3f *refracted)
{
    float d = lanes_get(c->d, 0), per_t = 1 / lanes_get(c->eta_t, 0);
    if (d == 0) {
        *refracted = direction;
        return true;
    }
    if (!(lanes_get(c->b, 0) > 0)) return false;
    Vec3f t = vec3f_along(vec3f_scale(direction, lanes_get(c->eta_i, 0) * per_t), -d * lanes_get(c->per_sum, 0) * per_t,
                          normal);
    *refracted = vec3f_scale(t, 1.5f - 0.5f * vec3f_dot(t, t));
    return true;
}

bool refract_direction(Vec3f direction, Vec3f normal, float eta_i, float eta_t, Vec3f *refracted)
{
    Crossing c = crossing(clamp_cosine(-vec3f_dot(direction, normal)), lanes_all(eta_i), lanes_all(eta_t));
    return crossing_refract(&c, direction, normal, refracted);
}

bool fresnel_refract(Vec3f direction, Vec3f normal, Lanes eta_i, Lanes eta_t, Lanes *reflectance, Vec3f *refracted)
{
    float cos_i = clamp_cosine(-vec3f_dot(direction, normal));
    Crossing c = crossing(cos_i, eta_i, eta_t);
    *reflectance = crossing_reflectance(&c, cos_i);
    return crossing_refract(&c, direction, normal, refracted);
}
