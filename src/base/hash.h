/* hash.h - integer hashing: the root of all randomness in the program (counter based, no state).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_HASH_H
#define MEN_HASH_H

#include <stddef.h>
#include <stdint.h>

/* A bijection of 32 bits with low bias (C. Wellons' hash prospector, constants of "lowbias32"). */
static inline uint32_t hash_u32(uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352dU;
    x ^= x >> 15;
    x *= 0x846ca68bU;
    x ^= x >> 16;
    return x;
}

/* A bijection of 64 bits: the finalizer of splitmix64 (Steele, Lea, Flood 2014). */
static inline uint64_t hash_u64(uint64_t x)
{
    x += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
}

static inline uint32_t hash_combine(uint32_t seed, uint32_t x) { return hash_u32(seed ^ hash_u32(x + 0x9e3779b9U)); }

/* uniform in [0, 1) from the upper 53 bits of a hash, and in [0, 1) as a float from 32 bits */
static inline double hash_to_unit(uint64_t x) { return (double)(x >> 11) * 0x1p-53; }
static inline float hash_to_unit_f(uint32_t x) { return (float)(x >> 8) * 0x1p-24f; }

/* FNV-1a of bytes, 64 bits, for identities of names and files (not for randomness). */
static inline uint64_t hash_bytes(const void *bytes, size_t length, uint64_t seed)
{
    const unsigned char *p = bytes;
    uint64_t h = seed ^ 0xcbf29ce484222325U;
    for (size_t i = 0; i < length; i++) h = (h ^ p[i]) * 0x100000001b3U;
    return h;
}

#endif
