/* lanes.h - four floats at once: the four wavelengths that a path carries.
 * One SSE or NEON register with gcc and clang (vector extensions), a plain array elsewhere. All
 * arithmetic goes through the functions below, so that nothing depends on which it is.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LANES_H
#define MEN_LANES_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/angle.h"

/* With -DMEN_PLAIN_LANES the plain array stands everywhere: `make check-plain-lanes`. The bits are the same. */
#if defined(__GNUC__) && !defined(MEN_PLAIN_LANES)
#define LANES_VECTORS
#if defined(__SSE2__)
#include <emmintrin.h>
#define LANES_SSE
#elif defined(__aarch64__)
#include <arm_neon.h>
#define LANES_NEON
#endif
#endif

enum { LANES = 4 };

#if defined(LANES_VECTORS)
typedef float LaneVector __attribute__((vector_size(16)));
typedef struct Lanes {
    LaneVector v;
} Lanes;
#define LANES_BINARY(name, operator)                                                                                   \
    static inline Lanes name(Lanes a, Lanes b)                                                                         \
    {                                                                                                                  \
        return (Lanes){a.v operator b.v };                                                                             \
    }
static inline Lanes lanes_all(float x)
{
    return (Lanes){(LaneVector){x, x, x, x}};
}
static inline Lanes lanes(float a, float b, float c, float d)
{
    return (Lanes){(LaneVector){a, b, c, d}};
}
#else
typedef struct Lanes {
    float v[LANES];
} Lanes;
#define LANES_BINARY(name, operator)                                                                                   \
    static inline Lanes name(Lanes a, Lanes b)                                                                         \
    {                                                                                                                  \
        for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] operator b.v[i];                                               \
        return a;                                                                                                      \
    }
static inline Lanes lanes_all(float x)
{
    return (Lanes){{x, x, x, x}};
}
static inline Lanes lanes(float a, float b, float c, float d)
{
    return (Lanes){{a, b, c, d}};
}
#endif

LANES_BINARY(lanes_add, +)
LANES_BINARY(lanes_sub, -)
LANES_BINARY(lanes_mul, *)
LANES_BINARY(lanes_div, /)

static inline Lanes lanes_scale(Lanes a, float s)
{
    return lanes_mul(a, lanes_all(s));
}
static inline float lanes_get(Lanes a, int lane)
{
    return a.v[lane];
}
static inline void lanes_set(Lanes *a, int lane, float x)
{
    a->v[lane] = x;
}
/* The first lane and another one in each other's place. */
static inline Lanes lanes_exchange(Lanes a, int lane)
{
    float first = lanes_get(a, 0);
    lanes_set(&a, 0, lanes_get(a, lane));
    lanes_set(&a, lane, first);
    return a;
}
static inline Lanes lanes_load(const float values[LANES])
{
    Lanes a;
    memcpy(&a, values, sizeof a);
    return a;
}
static inline void lanes_store(Lanes a, float values[LANES])
{
    memcpy(values, &a, sizeof a);
}
static inline float lanes_sum(Lanes a)
{
#if defined(LANES_SSE)
    __m128 v = (__m128)a.v, pairs = _mm_add_ps(v, _mm_shuffle_ps(v, v, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtss_f32(_mm_add_ss(pairs, _mm_movehl_ps(pairs, pairs)));
#else
    return (a.v[0] + a.v[1]) + (a.v[2] + a.v[3]);
#endif
}
static inline float lanes_mean(Lanes a)
{
    return lanes_sum(a) * 0.25f;
}
/* plain comparisons: fmaxf and fminf are calls of the mathematical library under our flags */
static inline float float_max(float a, float b)
{
    return a > b ? a : b;
}
static inline float float_min(float a, float b)
{
    return a < b ? a : b;
}
static inline float lanes_max(Lanes a)
{
#if defined(LANES_SSE)
    __m128 v = (__m128)a.v, pairs = _mm_max_ps(v, _mm_shuffle_ps(v, v, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtss_f32(_mm_max_ss(pairs, _mm_movehl_ps(pairs, pairs)));
#else
    return float_max(float_max(a.v[0], a.v[1]), float_max(a.v[2], a.v[3]));
#endif
}
static inline float lanes_min(Lanes a)
{
    return float_min(float_min(a.v[0], a.v[1]), float_min(a.v[2], a.v[3]));
}
static inline bool lanes_equal(Lanes a, Lanes b)
{
#if defined(LANES_SSE)
    return _mm_movemask_ps(_mm_cmpeq_ps((__m128)a.v, (__m128)b.v)) == 0xf;
#else
    return a.v[0] == b.v[0] && a.v[1] == b.v[1] && a.v[2] == b.v[2] && a.v[3] == b.v[3];
#endif
}
/* no lane differs from lane 0 */
static inline bool lanes_uniform(Lanes a)
{
    return lanes_equal(a, lanes_all(a.v[0]));
}
static inline bool lanes_zero(Lanes a)
{
    return lanes_equal(a, lanes_all(0));
}
static inline Lanes lanes_sqrt(Lanes a)
{
#if defined(LANES_SSE)
    return (Lanes){(LaneVector)_mm_sqrt_ps((__m128)a.v)};
#elif defined(LANES_NEON)
    return (Lanes){(LaneVector)vsqrtq_f32((float32x4_t)a.v)};
#else
    return lanes(sqrtf(a.v[0]), sqrtf(a.v[1]), sqrtf(a.v[2]), sqrtf(a.v[3]));
#endif
}
/* the lesser, or the greater, in each lane; b where one of both is NaN */
static inline Lanes lanes_lesser(Lanes a, Lanes b)
{
#if defined(LANES_SSE)
    return (Lanes){(LaneVector)_mm_min_ps((__m128)a.v, (__m128)b.v)};
#else
    for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] < b.v[i] ? a.v[i] : b.v[i];
    return a;
#endif
}
static inline Lanes lanes_greater(Lanes a, Lanes b)
{
#if defined(LANES_SSE)
    return (Lanes){(LaneVector)_mm_max_ps((__m128)a.v, (__m128)b.v)};
#else
    for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] > b.v[i] ? a.v[i] : b.v[i];
    return a;
#endif
}
/* each lane within low .. high; NaN becomes low */
static inline Lanes lanes_clamp(Lanes a, float low, float high)
{
    return lanes_lesser(lanes_greater(a, lanes_all(low)), lanes_all(high));
}
static inline Lanes lanes_abs(Lanes a)
{
    return lanes_greater(a, lanes_sub(lanes_all(0), a));
}
/* the lanes in which a <= b, as bits: 1 for lane 0 */
static inline unsigned lanes_not_above(Lanes a, Lanes b)
{
#if defined(LANES_SSE)
    return (unsigned)_mm_movemask_ps(_mm_cmple_ps((__m128)a.v, (__m128)b.v));
#else
    unsigned bits = 0;
    for (int i = 0; i < LANES; i++) bits |= (unsigned)(a.v[i] <= b.v[i]) << i;
    return bits;
#endif
}
/* the same four numbers as doubles: products of two are then exact */
typedef struct LanesWide {
#if defined(LANES_SSE)
    __m128d low, high;
#else
    double v[LANES];
#endif
} LanesWide;
#if defined(LANES_SSE)
#define LANES_WIDE_BINARY(name, operator)                                                                              \
    static inline LanesWide name(LanesWide a, LanesWide b)                                                             \
    {                                                                                                                  \
        return (LanesWide){_mm_##operator##_pd(a.low, b.low), _mm_##operator##_pd(a.high, b.high)};                    \
    }
static inline LanesWide lanes_widen(Lanes a)
{
    __m128 v = (__m128)a.v;
    return (LanesWide){_mm_cvtps_pd(v), _mm_cvtps_pd(_mm_movehl_ps(v, v))};
}
static inline LanesWide lanes_wide_all(double x)
{
    return (LanesWide){_mm_set1_pd(x), _mm_set1_pd(x)};
}
static inline Lanes lanes_narrow(LanesWide a) /* rounds */
{
    return (Lanes){(LaneVector)_mm_movelh_ps(_mm_cvtpd_ps(a.low), _mm_cvtpd_ps(a.high))};
}
LANES_WIDE_BINARY(lanes_wide_add, add)
LANES_WIDE_BINARY(lanes_wide_sub, sub)
LANES_WIDE_BINARY(lanes_wide_mul, mul)
#else
#define LANES_WIDE_BINARY(name, operator)                                                                              \
    static inline LanesWide name(LanesWide a, LanesWide b)                                                             \
    {                                                                                                                  \
        for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] operator b.v[i];                                               \
        return a;                                                                                                      \
    }
static inline LanesWide lanes_widen(Lanes a)
{
    return (LanesWide){{(double)a.v[0], (double)a.v[1], (double)a.v[2], (double)a.v[3]}};
}
static inline LanesWide lanes_wide_all(double x)
{
    return (LanesWide){{x, x, x, x}};
}
static inline Lanes lanes_narrow(LanesWide a) /* rounds */
{
    return lanes((float)a.v[0], (float)a.v[1], (float)a.v[2], (float)a.v[3]);
}
LANES_WIDE_BINARY(lanes_wide_add, +)
LANES_WIDE_BINARY(lanes_wide_sub, -)
LANES_WIDE_BINARY(lanes_wide_mul, *)
#endif
/* the whole part of each lane, towards 0; returns what is left. |a| < 2^31 */
static inline Lanes lanes_split(Lanes a, int32_t whole[LANES])
{
#if defined(LANES_SSE)
    __m128i truncated = _mm_cvttps_epi32((__m128)a.v);
    _mm_storeu_si128((__m128i *)(void *)whole, truncated);
    return (Lanes){a.v - (LaneVector)_mm_cvtepi32_ps(truncated)};
#else
    for (int i = 0; i < LANES; i++) {
        whole[i] = (int32_t)a.v[i];
        a.v[i] -= (float)whole[i];
    }
    return a;
#endif
}
/* in each lane `yes` where a < b, else `no` */
static inline Lanes lanes_select_less(Lanes a, Lanes b, Lanes yes, Lanes no)
{
#if defined(LANES_SSE)
    __m128 mask = _mm_cmplt_ps((__m128)a.v, (__m128)b.v);
    return (Lanes){(LaneVector)_mm_or_ps(_mm_and_ps(mask, (__m128)yes.v), _mm_andnot_ps(mask, (__m128)no.v))};
#else
    for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] < b.v[i] ? yes.v[i] : no.v[i];
    return a;
#endif
}
/* 1 - a */
static inline Lanes lanes_rest(Lanes a)
{
    return lanes_sub(lanes_all(1), a);
}
/* The angle of the point x, y against the x axis, -pi to pi, to 4e-7, and to 3e-7 of small ones; finite numbers, 0 where both
 * are 0. By the angle's distance from the nearest eighth of a turn, whose tangent is a series. */
static inline Lanes lanes_atan2(Lanes y, Lanes x)
{
    const Lanes zero = lanes_all(0);
    Lanes across = lanes_abs(y), along = lanes_abs(x);
    Lanes less = lanes_lesser(across, along), more = lanes_greater(across, along);
    Lanes far = lanes_scale(more, 0.414213562f); /* the tangent of a sixteenth */
    Lanes top = lanes_select_less(far, less, lanes_sub(less, more), less);
    Lanes bottom = lanes_add(more, lanes_select_less(far, less, less, lanes_all(1e-37f)));
    Lanes t = lanes_div(top, bottom), z = lanes_mul(t, t);
    Lanes p = lanes_add(lanes_scale(z, -0.0645171887f), lanes_all(0.107436683f));
    p = lanes_add(lanes_mul(p, z), lanes_all(-0.142639498f));
    p = lanes_add(lanes_mul(p, z), lanes_all(0.199995403f));
    p = lanes_add(lanes_mul(p, z), lanes_all(-0.333333318f));
    Lanes angle = lanes_add(t, lanes_mul(lanes_mul(t, z), p));
    angle = lanes_add(angle, lanes_select_less(far, less, lanes_all(0.785398163f), zero));
    angle = lanes_select_less(along, across, lanes_sub(lanes_all((float)(0.5 * MEN_PI)), angle), angle);
    angle = lanes_select_less(x, zero, lanes_sub(lanes_all((float)MEN_PI), angle), angle);
    return lanes_select_less(y, zero, lanes_sub(zero, angle), angle);
}
/* What lanes_exp needs: 2^n e^r by its two factors, where `shifted` is n + LANES_SHIFT, whose last bits are n's, moved to
 * where exponents stand; and 0 where a is less than low. */
#define LANES_SHIFT 12582912.0f /* 1.5 * 2^23 */
static inline Lanes lanes_times_power(Lanes factor, Lanes shifted, Lanes a, float low)
{
#if defined(LANES_VECTORS)
    typedef uint32_t Bits __attribute__((vector_size(16)));
    Bits bits;
    memcpy(&bits, &shifted, sizeof bits);
    bits = (bits << 23) + 0x3f800000U;
    bits &= (Bits)(a.v >= lanes_all(low).v);
    memcpy(&shifted, &bits, sizeof bits);
#else
    uint32_t bits[LANES];
    memcpy(bits, &shifted, sizeof bits);
    for (int i = 0; i < LANES; i++) bits[i] = a.v[i] >= low ? (bits[i] << 23) + 0x3f800000U : 0;
    memcpy(&shifted, bits, sizeof bits);
#endif
    return lanes_mul(factor, shifted);
}
/* e^a for a up to 88, to 0.75 units in the last place; exactly 1 at 0, and 0 below -87, where it is 1e-38. As 2^n e^r with
 * |r| <= ln(2) / 2; ln(2) in two parts, of which the first has so few digits that n of it are exact. The same bits on
 * every machine, which the C library's function does not promise. */
static inline Lanes lanes_exp(Lanes a)
{
    const float low = -87;
    Lanes held = lanes_clamp(a, low, 88);
    Lanes shifted = lanes_add(lanes_scale(held, 1.44269504f), lanes_all(LANES_SHIFT));
    Lanes n = lanes_sub(shifted, lanes_all(LANES_SHIFT));
    Lanes r = lanes_sub(lanes_sub(held, lanes_scale(n, 0.693359375f)), lanes_scale(n, -2.12194440e-4f));
    Lanes square = lanes_mul(r, r); /* the series by pairs, so that a processor can take several steps at once */
    Lanes pair1 = lanes_add(lanes_scale(r, 1.6666667e-1f), lanes_all(0.5f));
    Lanes pair2 = lanes_add(lanes_scale(r, 8.3333333e-3f), lanes_all(4.1666667e-2f));
    Lanes pair3 = lanes_add(lanes_scale(r, 1.9841270e-4f), lanes_all(1.3888889e-3f));
    Lanes p = lanes_add(lanes_mul(lanes_add(lanes_mul(pair3, square), pair2), square), pair1);
    p = lanes_add(lanes_add(lanes_mul(p, square), r), lanes_all(1));
    return lanes_times_power(p, shifted, a, low);
}

#endif
