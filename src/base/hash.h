/* hash.h - integer hashing: the root of all randomness in the program (counter based, no state).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_HASH_H
#define MEN_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

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

static inline uint32_t hash_combine(uint32_t seed, uint32_t x)
{
    return hash_u32(seed ^ hash_u32(x + 0x9e3779b9U));
}

/* uniform in [0, 1) from the upper 53 bits of a hash, and in [0, 1) as a float from 32 bits */
static inline double hash_to_unit(uint64_t x)
{
    return (double)(x >> 11) * 0x1p-53;
}
static inline float hash_to_unit_f(uint32_t x)
{
    return (float)(x >> 8) * 0x1p-24f;
}

/* FNV-1a of bytes, 64 bits, for identities of names and files (not for randomness). */
static inline uint64_t hash_bytes(const void *bytes, size_t length, uint64_t seed)
{
    const unsigned char *p = bytes;
    uint64_t h = seed ^ 0xcbf29ce484222325U;
    for (size_t i = 0; i < length; i++) h = (h ^ p[i]) * 0x100000001b3U;
    return h;
}

/* The same purpose for large arrays, at many times the speed: four strands of eight bytes each. The number depends on the
 * machine's byte order. */
static inline uint64_t hash_bulk(const void *bytes, size_t length, uint64_t seed)
{
    enum { STRANDS = 4 };
    const unsigned char *p = bytes;
    uint64_t h[STRANDS] = {seed, ~seed, seed + 0x9e3779b97f4a7c15U, length};
    for (size_t left = length; left > 0;) {
        uint64_t words[STRANDS] = {0};
        size_t n = left < sizeof words ? left : sizeof words;
        memcpy(words, p, n);
        for (int i = 0; i < STRANDS; i++) {
            uint64_t mixed = (h[i] ^ words[i]) * 0xd1342543de82ef95U;
            h[i] = mixed << 29 | mixed >> 35; /* so that the highest bits reach the others, too */
        }
        p += n;
        left -= n;
    }
    return hash_u64(hash_u64(hash_u64(hash_u64(h[0]) ^ h[1]) ^ h[2]) ^ h[3]);
}

#endif
