/* sampler.c - how the pixels of a block divide the work.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/sampler.h"

/* The columns of the first two matrices, for the six digits of a pixel's place, the finest first; a column's lowest bit goes
 * to the coordinate's first digit. Found by annealing: the least sum of rank deficits over all elementary intervals of
 * 1, 2, ... 512 samples of 2, 4, ... 64 pixels. Most of these sets are (t, m, 2)-nets of t = 1, a few of t = 2 or 3. */
#define DIGIT(place, n, column) ((place) >> (5 - (n)) & 1 ? (column) : 0)
#define FIRST(p)                                                                                                       \
    (DIGIT(p, 0, 0xb2dbU) ^ DIGIT(p, 1, 0x85b6U) ^ DIGIT(p, 2, 0xbb3cU) ^ DIGIT(p, 3, 0x9d14U) ^                       \
     DIGIT(p, 4, 0xad63U) ^ DIGIT(p, 5, 0xd235U))
#define SECOND(p)                                                                                                      \
    (DIGIT(p, 0, 0xbdabU) ^ DIGIT(p, 1, 0x1efdU) ^ DIGIT(p, 2, 0xd262U) ^ DIGIT(p, 3, 0x1711U) ^                       \
     DIGIT(p, 4, 0x83e6U) ^ DIGIT(p, 5, 0xdf22U))
/* The third coordinate is what chooses, and is to be even by itself first of all. Digit i of column j is a polynomial of i of
 * degree j, a sum of binomials modulo 2: any j digits in a row of the first j columns make a matrix of determinant 1, so
 * that 2^m samples of 2^k pixels that are next to each other in the order have their thirds in 2^(m + k) strata. Of these
 * polynomials those were taken whose rank deficits together with the first two coordinates are least. */
#define THIRD(p)                                                                                                       \
    (DIGIT(p, 0, 0xffffU) ^ DIGIT(p, 1, 0x5555U) ^ DIGIT(p, 2, 0x9999U) ^ DIGIT(p, 3, 0x8888U) ^                       \
     DIGIT(p, 4, 0x6969U) ^ DIGIT(p, 5, 0x3636U))
#define SHIFT(p)                                                                                                       \
    {                                                                                                                  \
        FIRST(p), SECOND(p), THIRD(p)                                                                                  \
    }
#define FOUR(p) SHIFT(p), SHIFT((p) + 1), SHIFT((p) + 2), SHIFT((p) + 3)

const uint32_t sampler_shifts[64][3] = {FOUR(0),  FOUR(4),  FOUR(8),  FOUR(12), FOUR(16), FOUR(20), FOUR(24), FOUR(28),
                                        FOUR(32), FOUR(36), FOUR(40), FOUR(44), FOUR(48), FOUR(52), FOUR(56), FOUR(60)};

/* All sums of four columns of a matrix; a column's lowest bit goes to the coordinate's first digit. */
#define SUMS_OF_TWO(from, a, b) (from), (from) ^ (a), (from) ^ (b), (from) ^ (a) ^ (b)
#define SUMS(a, b, c, d)                                                                                               \
    {                                                                                                                  \
        SUMS_OF_TWO(0U, a, b), SUMS_OF_TWO(c, a, b), SUMS_OF_TWO(d, a, b), SUMS_OF_TWO((c) ^ (d), a, b)                \
    }

/* The direction numbers of the primitive polynomial x^2 + x + 1, begun with 1 and 3. */
const uint32_t sampler_thirds[8][16] = {SUMS(0x1U, 0x3U, 0x6U, 0x9U),
                                        SUMS(0x17U, 0x3aU, 0x71U, 0xa3U),
                                        SUMS(0x116U, 0x339U, 0x677U, 0x9aaU),
                                        SUMS(0x1601U, 0x3903U, 0x7706U, 0xaa09U),
                                        SUMS(0x10117U, 0x3033aU, 0x60671U, 0x909a3U),
                                        SUMS(0x171616U, 0x3a3939U, 0x717777U, 0xa3aaaaU),
                                        SUMS(0x1170001U, 0x33a0003U, 0x6710006U, 0x9a30009U),
                                        SUMS(0x16160017U, 0x3939003aU, 0x77770071U, 0xaaaa00a3U)};
