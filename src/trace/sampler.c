/* sampler.c - how the pixels of a block divide the work, and what their samples have in common.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/sampler.h"

/* The columns of the two matrices, for the six digits of a pixel's place, the finest first; a column's lowest bit goes
 * to the coordinate's first digit. Found by annealing: the least sum of rank deficits over all elementary intervals of
 * 1, 2, ... 512 samples of 2, 4, ... 64 pixels. Most of these sets are (t, m, 2)-nets of t = 1, a few of t = 2 or 3. */
#define DIGIT(place, n, column) ((place) >> (5 - (n)) & 1 ? (column) : 0)
#define FIRST(p)                                                                                                       \
    (DIGIT(p, 0, 0xb2dbU) ^ DIGIT(p, 1, 0x85b6U) ^ DIGIT(p, 2, 0xbb3cU) ^ DIGIT(p, 3, 0x9d14U) ^                       \
     DIGIT(p, 4, 0xad63U) ^ DIGIT(p, 5, 0xd235U))
#define SECOND(p)                                                                                                      \
    (DIGIT(p, 0, 0xbdabU) ^ DIGIT(p, 1, 0x1efdU) ^ DIGIT(p, 2, 0xd262U) ^ DIGIT(p, 3, 0x1711U) ^                       \
     DIGIT(p, 4, 0x83e6U) ^ DIGIT(p, 5, 0xdf22U))
#define SHIFT(p)                                                                                                       \
    {                                                                                                                  \
        FIRST(p), SECOND(p)                                                                                            \
    }
#define FOUR(p) SHIFT(p), SHIFT((p) + 1), SHIFT((p) + 2), SHIFT((p) + 3)

const uint32_t sampler_shifts[64][2] = {FOUR(0),  FOUR(4),  FOUR(8),  FOUR(12), FOUR(16), FOUR(20), FOUR(24), FOUR(28),
                                        FOUR(32), FOUR(36), FOUR(40), FOUR(44), FOUR(48), FOUR(52), FOUR(56), FOUR(60)};

/* scramble_reversed's seed, of which the lower bits are the block's. */
static uint32_t mixed(uint32_t pixel, uint32_t block)
{
    const uint32_t shared = (1U << SAMPLER_DIGITS_SHARED) - 1;
    return (block & shared) | (pixel & ~shared);
}

void sampler_stream(const Sampler *sampler, uint32_t dimension, SamplerStream *stream)
{
    uint64_t pixel = hash_u64((uint64_t)sampler->pixel << 32 | dimension);
    uint64_t block = hash_u64((uint64_t)sampler->block << 32 | dimension);
    uint32_t place = scramble_reversed(sampler->place, (uint32_t)(block >> 16)) >> 26;
    stream->order = (uint32_t)(pixel >> 16);
    uint32_t first = (uint32_t)((block * 0xd1342543de82ef95U) >> 32);
    uint32_t start = reverse_bits(scramble_reversed(0, stream->order) ^ first);
    for (int i = 0; i < 2; i++) {
        uint32_t of_pixel = (uint32_t)(pixel >> 32 * i), of_block = (uint32_t)(block >> 32 * i);
        stream->offset[i] = (i ? sobol_second_reversed(start) : start) ^ sampler_shifts[place][i];
        stream->seed[i] = mixed(of_pixel, of_block);
        stream->factor[i] = mixed(of_pixel >> 16, of_block >> 16) | 1;
    }
}
