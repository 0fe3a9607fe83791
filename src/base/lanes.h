/* lanes.h - four floats at once: the four wavelengths that a path carries.
 * One SSE or NEON register with gcc and clang (vector extensions), a plain array elsewhere. All
 * arithmetic goes through the functions below, so that nothing depends on which it is.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LANES_H
#define MEN_LANES_H

#include <math.h>
#include <stdbool.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

enum { LANES = 4 };

#if defined(__GNUC__)
typedef float LaneVector __attribute__((vector_size(16)));
typedef struct Lanes {
    LaneVector v;
} Lanes;
#define LANES_BINARY(name, operator)                                                               \
    static inline Lanes name(Lanes a, Lanes b) { return (Lanes){a.v operator b.v}; }
static inline Lanes lanes_all(float x) { return (Lanes){(LaneVector){x, x, x, x}}; }
static inline Lanes lanes(float a, float b, float c, float d) { return (Lanes){(LaneVector){a, b, c, d}}; }
#else
typedef struct Lanes {
    float v[LANES];
} Lanes;
#define LANES_BINARY(name, operator)                                                               \
    static inline Lanes name(Lanes a, Lanes b)                                                     \
    {                                                                                              \
        for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] operator b.v[i];                           \
        return a;                                                                                  \
    }
static inline Lanes lanes_all(float x) { return (Lanes){{x, x, x, x}}; }
static inline Lanes lanes(float a, float b, float c, float d) { return (Lanes){{a, b, c, d}}; }
#endif

LANES_BINARY(lanes_add, +)
LANES_BINARY(lanes_sub, -)
LANES_BINARY(lanes_mul, *)
LANES_BINARY(lanes_div, /)

static inline Lanes lanes_scale(Lanes a, float s) { return lanes_mul(a, lanes_all(s)); }
static inline float lanes_get(Lanes a, int lane) { return a.v[lane]; }
static inline void lanes_set(Lanes *a, int lane, float x) { a->v[lane] = x; }
static inline float lanes_sum(Lanes a) { return (a.v[0] + a.v[1]) + (a.v[2] + a.v[3]); }
static inline float lanes_mean(Lanes a) { return lanes_sum(a) * 0.25f; }
/* plain comparisons: fmaxf and fminf are calls of the mathematical library under our flags */
static inline float float_max(float a, float b) { return a > b ? a : b; }
static inline float float_min(float a, float b) { return a < b ? a : b; }
static inline float lanes_max(Lanes a) { return float_max(float_max(a.v[0], a.v[1]), float_max(a.v[2], a.v[3])); }
static inline float lanes_min(Lanes a) { return float_min(float_min(a.v[0], a.v[1]), float_min(a.v[2], a.v[3])); }
static inline bool lanes_equal(Lanes a, Lanes b)
{
#if defined(__GNUC__) && defined(__SSE2__)
    return _mm_movemask_ps(_mm_cmpeq_ps((__m128)a.v, (__m128)b.v)) == 0xf;
#else
    return a.v[0] == b.v[0] && a.v[1] == b.v[1] && a.v[2] == b.v[2] && a.v[3] == b.v[3];
#endif
}
/* no lane differs from lane 0 */
static inline bool lanes_uniform(Lanes a) { return lanes_equal(a, lanes_all(a.v[0])); }
static inline bool lanes_zero(Lanes a) { return lanes_equal(a, lanes_all(0)); }
static inline bool lanes_finite(Lanes a)
{
    return isfinite(a.v[0]) && isfinite(a.v[1]) && isfinite(a.v[2]) && isfinite(a.v[3]);
}
static inline Lanes lanes_sqrt(Lanes a)
{
    return lanes(sqrtf(a.v[0]), sqrtf(a.v[1]), sqrtf(a.v[2]), sqrtf(a.v[3]));
}
/* each lane within low .. high; NaN becomes low */
static inline Lanes lanes_clamp(Lanes a, float low, float high)
{
    for (int i = 0; i < LANES; i++) a.v[i] = a.v[i] > low ? (a.v[i] < high ? a.v[i] : high) : low;
    return a;
}
/* 1 - a */
static inline Lanes lanes_rest(Lanes a) { return lanes_sub(lanes_all(1), a); }
static inline Lanes lanes_exp(Lanes a)
{
    return lanes(expf(a.v[0]), expf(a.v[1]), expf(a.v[2]), expf(a.v[3]));
}

#endif
