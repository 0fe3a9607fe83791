/* sampler.h - the random numbers of a path: Owen-scrambled Sobol' points without any state.
 * A number is a function of (seed, pixel, sample index, named dimension) alone, so that any split of the work
 * gives the same picture. Each named dimension is one or two coordinates of a Sobol' (0,2)-sequence whose
 * order and digits are scrambled by that dimension's own hash: padding after [Burley20] B. Burley, "Practical
 * Hash-based Owen Scrambling", JCGT 9(4) (2020).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SAMPLER_H
#define MEN_SAMPLER_H

#include "base/hash.h"

/* Named dimensions. A new one is added at the end of its group, so that the others stay as they are. */
enum {
    DIM_PIXEL,             /* 2: place in the pixel's filter */
    DIM_LENS,              /* 2 */
    DIM_WAVELENGTH,        /* 1 */
    DIM_PATH,              /* the first bounce's group begins here */
    DIM_TIME = 0x40000000, /* 1: of the shutter; beyond all groups, as it came later */

    DIM_LOBE = 0,     /* 1: reflect or refract */
    DIM_SCATTER,      /* 2: direction */
    DIM_LIGHT_CHOICE, /* 1 */
    DIM_LIGHT,        /* 2: point on the light */
    DIM_ROULETTE,     /* 1 */
    DIM_DISTANCE,     /* 1: to where a medium scatters */
    DIM_PER_BOUNCE = 8
};

static inline uint32_t sampler_dimension(uint32_t bounce, uint32_t which)
{
    return DIM_PATH + bounce * DIM_PER_BOUNCE + which;
}

typedef struct Sampler {
    uint32_t seed;  /* of the pixel */
    uint32_t index; /* of the sample */
} Sampler;

static inline Sampler sampler_make(uint32_t seed, uint32_t x, uint32_t y, uint32_t index)
{
    return (Sampler){hash_combine(hash_combine(seed, x), y), index};
}

static inline uint32_t reverse_bits(uint32_t x)
{
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00U) >> 8) | ((x & 0x00ff00ffU) << 8);
    x = ((x & 0xf0f0f0f0U) >> 4) | ((x & 0x0f0f0f0fU) << 4);
    x = ((x & 0xccccccccU) >> 2) | ((x & 0x33333333U) << 2);
    return ((x & 0xaaaaaaaaU) >> 1) | ((x & 0x55555555U) << 1);
}

/* A hash that changes a bit by the bits below it only: Owen scrambling of bit-reversed numbers. S. Laine and
 * T. Karras, "Stratified Sampling for Stochastic Transparency" (2011), with N. Vegdahl's constants (2021). */
static inline uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    x ^= x * 0x3d20adeaU;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526c56U;
    x ^= x * 0x53a22864U;
    return x;
}

/* Second coordinate of the Sobol' sequence, bits reversed: the Pascal matrix mod 2 in five steps. */
static inline uint32_t sobol_second_reversed(uint32_t index)
{
    index ^= index >> 16;
    index ^= (index & 0xff00ff00U) >> 8;
    index ^= (index & 0xf0f0f0f0U) >> 4;
    index ^= (index & 0xccccccccU) >> 2;
    return index ^ ((index & 0xaaaaaaaaU) >> 1);
}

/* uniform in [0, 1) */
static inline float sampler_1d(const Sampler *sampler, uint32_t dimension)
{
    uint32_t seed = hash_combine(sampler->seed, dimension);
    uint32_t index = reverse_bits(scramble_reversed(reverse_bits(sampler->index), seed));
    return hash_to_unit_f(reverse_bits(scramble_reversed(index, hash_u32(seed + 1))));
}

static inline void sampler_2d(const Sampler *sampler, uint32_t dimension, float u[2])
{
    uint32_t seed = hash_combine(sampler->seed, dimension);
    uint32_t index = reverse_bits(scramble_reversed(reverse_bits(sampler->index), seed));
    u[0] = hash_to_unit_f(reverse_bits(scramble_reversed(index, hash_u32(seed + 1))));
    u[1] = hash_to_unit_f(reverse_bits(scramble_reversed(sobol_second_reversed(index), hash_u32(seed + 2))));
}

#endif
