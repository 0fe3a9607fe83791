/* sampler.h - the random numbers of a path: Owen-scrambled Sobol' points without any state.
 * A number is a function of (seed, pixel, sample index, named dimension) alone, so that any split of the work
 * gives the same picture. Each named dimension is one, two or three coordinates of a Sobol' sequence whose
 * order and digits are scrambled by that dimension's own hash: padding after [Burley20] B. Burley, "Practical
 * Hash-based Owen Scrambling", JCGT 9(4) (2020).
 *
 * The pixels of a block of 8 x 8 divide the work among them, so that their errors cancel where the eye, or a filter,
 * takes them together: blue noise. The idea is [AW20]'s (A. Ahmed, P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte
 * Carlo Sampling Error via Hierarchical Ordering of Pixels", ACM TOG 39(6), 2020): the points of a quad of pixels, of four
 * quads, ... are together as evenly spread as one pixel's. There a pixel has a stretch of one sequence, as long as its
 * number of samples, which must be known; here it has the whole sequence, shifted by digits that are linear in the
 * pixel's place, by matrices for which 1, 2, 4, ... 64 samples of 2, 4, ... 64 pixels make nearly a net (sampler.c). The
 * first digits of the scrambling, DIGITS_SHARED of them, are the block's, all others the pixel's own: blocks, and pixels
 * with many samples, are independent of each other, and each pixel by itself has Owen-scrambled Sobol' points.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SAMPLER_H
#define MEN_SAMPLER_H

#include "base/hash.h"

/* Named dimensions. A new one is added at the end of its group, so that the others stay as they are. */
enum {
    DIM_PIXEL,                 /* 2: place in the pixel's filter; and a third, of what boundaries choose */
    DIM_LENS,                  /* 2 */
    DIM_WAVELENGTH,            /* 1 */
    DIM_PATH,                  /* the first bounce's group begins here */
    DIM_TIME = 0x40000000,     /* 1: of the shutter; beyond all groups, as it came later */
    DIM_INDICES = 0x48000000,  /* 1: which wavelengths' indices a sample's paths take, see sample.c */
    DIM_FLIGHTS = 0x50000000,  /* keys of the many numbers of flights through media, two for each bounce */
    DIM_AIRLIGHT = 0x60000000, /* of looks for light within media, see airlight.c */
    DIM_SHAFTS = 0x68000000,   /* of looks for it where photons were scattered, see shaft.c */
    DIM_PROBES = 0x70000000,   /* 2 for each bounce: the direction of a probe, see probe.c */
    DIM_BEAMS = 0x78000000,    /* 3 for each bounce: a place on a lamp, and which, see slab_lamp.c */

    DIM_LOBE = 0,     /* 1: reflect or refract */
    DIM_SCATTER,      /* 2: direction; and a third, of the lobe */
    DIM_LIGHT_CHOICE, /* a key: further digits of the choice */
    DIM_LIGHT,        /* 2: point on the light; and a third, of which light */
    DIM_ROULETTE,     /* 1 */
    DIM_DISTANCE,     /* 1: to where a medium scatters */
    DIM_MIX,          /* 1: which of the surfaces of a mix */
    DIM_GUIDE,        /* 1: whether to send a probe, and by which lobe of the guide */
    DIM_PER_BOUNCE = 8
};

static inline uint32_t sampler_dimension(uint32_t bounce, uint32_t which)
{
    return DIM_PATH + bounce * DIM_PER_BOUNCE + which;
}

typedef struct Sampler {
    uint32_t pixel, block;   /* seeds of the two */
    uint32_t place;          /* of the pixel in its block: reversed, in the upper six bits */
    uint32_t index_reversed; /* of the sample */
} Sampler;

enum { SAMPLER_DIGITS_SHARED = 10 };

/* What is added, digit by digit, to the three coordinates at a place in the block, reversed. */
extern const uint32_t sampler_shifts[64][3];

static inline uint32_t reverse_bits(uint32_t x)
{
    x = (x >> 16) | (x << 16);
    x = ((x & 0xff00ff00U) >> 8) | ((x & 0x00ff00ffU) << 8);
    x = ((x & 0xf0f0f0f0U) >> 4) | ((x & 0x0f0f0f0fU) << 4);
    x = ((x & 0xccccccccU) >> 2) | ((x & 0x33333333U) << 2);
    return ((x & 0xaaaaaaaaU) >> 1) | ((x & 0x55555555U) << 1);
}

static inline uint64_t reverse_bits_64(uint64_t x)
{
    x = (x >> 32) | (x << 32);
    x = ((x & 0xffff0000ffff0000U) >> 16) | ((x & 0x0000ffff0000ffffU) << 16);
    x = ((x & 0xff00ff00ff00ff00U) >> 8) | ((x & 0x00ff00ff00ff00ffU) << 8);
    x = ((x & 0xf0f0f0f0f0f0f0f0U) >> 4) | ((x & 0x0f0f0f0f0f0f0f0fU) << 4);
    x = ((x & 0xccccccccccccccccU) >> 2) | ((x & 0x3333333333333333U) << 2);
    return ((x & 0xaaaaaaaaaaaaaaaaU) >> 1) | ((x & 0x5555555555555555U) << 1);
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

/* Third coordinate of the Sobol' sequence, bits reversed: sums of its matrix's columns, four by four. */
extern const uint32_t sampler_thirds[8][16];

static inline uint32_t sobol_third_reversed(uint32_t index)
{
    uint32_t x = 0;
    for (int i = 0; i < 8; i++) x ^= sampler_thirds[i][index >> 4 * i & 15];
    return x;
}

/* The place of a pixel in its block along a curve that halves it, again and again: the highest digit parts diagonal
 * neighbours from the others. Reversed, as scrambling wants it. */
static inline uint32_t sampler_place(uint32_t x, uint32_t y)
{
    uint32_t diagonal = x ^ y;
    return y << 31 | (diagonal & 1) << 30 | (y & 2) << 28 | (diagonal & 2) << 27 | (y & 4) << 25 | (diagonal & 4) << 24;
}

static inline Sampler sampler_make(uint32_t seed, uint32_t x, uint32_t y, uint32_t index)
{
    return (Sampler){.pixel = hash_combine(hash_combine(seed, x), y),
                     .block = hash_combine(hash_combine(~seed, x >> 3), y >> 3),
                     .place = sampler_place(x, y),
                     .index_reversed = reverse_bits(index)};
}

/* The same for a pixel that heeds no other: white noise. For tests and comparisons. */
static inline Sampler sampler_make_alone(uint32_t seed, uint32_t x, uint32_t y, uint32_t index)
{
    Sampler sampler = sampler_make(seed, x, y, index);
    sampler.block = ~sampler.pixel;
    sampler.place = 0;
    return sampler;
}

/* The same, and every sample heeds no other: plain Monte Carlo. */
static inline Sampler sampler_make_independent(uint32_t seed, uint32_t x, uint32_t y, uint32_t index)
{
    return sampler_make_alone(hash_combine(seed, ~index), x, y, 0);
}

/* What the samples of a pixel have in common in one dimension. */
typedef struct SamplerStream {
    uint32_t order, first; /* how they are shuffled */
    const uint32_t *shift;
    uint64_t pixel, block; /* hashes */
} SamplerStream;

/* The order of the samples is shuffled by the pixel's hash within each of [1, 2), [2, 4), [4, 8), ..., and by the
 * block's beyond that: after 1, 2, 4, ... samples all pixels of a block have used the same stretch of the sequence. */
static inline SamplerStream sampler_stream(const Sampler *sampler, uint32_t dimension)
{
    SamplerStream stream = {.pixel = hash_u64((uint64_t)sampler->pixel << 32 | dimension),
                            .block = hash_u64((uint64_t)sampler->block << 32 | dimension)};
    uint32_t first = (uint32_t)((stream.block * 0xd1342543de82ef95U) >> 32);
    stream.order = (uint32_t)(stream.pixel >> 16);
    stream.first = scramble_reversed(0, stream.order) ^ first;
    stream.shift = sampler_shifts[scramble_reversed(sampler->place, (uint32_t)(stream.block >> 16)) >> 26];
    return stream;
}

/* Which point of the sequence is a sample's. */
static inline uint32_t sampler_point(const SamplerStream *stream, uint32_t index_reversed)
{
    return reverse_bits(scramble_reversed(index_reversed, stream->order) ^ stream->first);
}

/* scramble_reversed with seeds of which the lower bits are the block's: a bit of its result depends on no higher ones. */
static inline uint32_t sampler_scramble(uint32_t reversed, uint32_t pixel, uint32_t block)
{
    const uint32_t shared = (1U << SAMPLER_DIGITS_SHARED) - 1;
    uint32_t factor = (block >> 16 & shared) | (pixel >> 16 & ~shared) | 1;
    reversed ^= reversed * 0x3d20adeaU;
    reversed += (block & shared) | (pixel & ~shared);
    reversed *= factor;
    reversed ^= reversed * 0x05526c56U;
    return reversed ^ (reversed * 0x53a22864U);
}

/* For more numbers than have names: hash_combine of it and 0, 1, 2, ... */
static inline uint32_t sampler_key(const Sampler *sampler, uint32_t dimension)
{
    return hash_combine(hash_combine(sampler->pixel, dimension), sampler->index_reversed);
}

/* uniform in [0, 1): of a stream, and of a dimension; and all 32 digits of it */
static inline uint32_t sampler_stream_digits(const SamplerStream *stream, uint32_t index_reversed)
{
    uint32_t x = sampler_point(stream, index_reversed) ^ stream->shift[0];
    return reverse_bits(sampler_scramble(x, (uint32_t)stream->pixel, (uint32_t)stream->block));
}

static inline float sampler_stream_1d(const SamplerStream *stream, uint32_t index_reversed)
{
    return hash_to_unit_f(sampler_stream_digits(stream, index_reversed));
}

static inline void sampler_stream_2d(const SamplerStream *stream, uint32_t index_reversed, float u[2])
{
    uint32_t point = sampler_point(stream, index_reversed);
    uint32_t x = sampler_scramble(point ^ stream->shift[0], (uint32_t)stream->pixel, (uint32_t)stream->block);
    uint32_t y = sampler_scramble(sobol_second_reversed(point) ^ stream->shift[1], (uint32_t)(stream->pixel >> 32),
                                  (uint32_t)(stream->block >> 32));
    uint64_t both = reverse_bits_64((uint64_t)y << 32 | x);
    u[0] = hash_to_unit_f((uint32_t)(both >> 32));
    u[1] = hash_to_unit_f((uint32_t)both);
}

/* A third number to a stream's two, all 32 digits: 2^m samples of a pixel are together a (1, m, 3)-net. It has a shift of its own:
 * were it made of the first one's index, shift and all, half of the strata of two or four pixels would be empty, and its low
 * frequencies up to 2.5 times as strong. */
static inline uint32_t sampler_stream_third(const SamplerStream *stream, uint32_t index_reversed)
{
    uint32_t x = sobol_third_reversed(sampler_point(stream, index_reversed)) ^ stream->shift[2];
    uint32_t pixel = (uint32_t)((stream->pixel * 0xd1342543de82ef95U) >> 32);
    return reverse_bits(sampler_scramble(x, pixel, (uint32_t)((stream->block * 0xaf251af3b0f025b5U) >> 32)));
}

static inline uint32_t sampler_digits(const Sampler *sampler, uint32_t dimension)
{
    SamplerStream stream = sampler_stream(sampler, dimension);
    return sampler_stream_digits(&stream, sampler->index_reversed);
}

static inline float sampler_1d(const Sampler *sampler, uint32_t dimension)
{
    SamplerStream stream = sampler_stream(sampler, dimension);
    return sampler_stream_1d(&stream, sampler->index_reversed);
}

static inline void sampler_2d(const Sampler *sampler, uint32_t dimension, float u[2])
{
    SamplerStream stream = sampler_stream(sampler, dimension);
    sampler_stream_2d(&stream, sampler->index_reversed, u);
}

/* Two numbers, and a third one, all 32 digits: those samples for which the third is in some interval have evenly spread pairs
 * among themselves. So is what is chosen by it: one of the lights, and by the pair a point on it. */
static inline uint32_t sampler_3d(const Sampler *sampler, uint32_t dimension, float u[2])
{
    SamplerStream stream = sampler_stream(sampler, dimension);
    sampler_stream_2d(&stream, sampler->index_reversed, u);
    return sampler_stream_third(&stream, sampler->index_reversed);
}

#endif
