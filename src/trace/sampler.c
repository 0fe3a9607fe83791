/* sampler.c - how the pixels of a block divide the work.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/sampler.h"

/* The columns of the two matrices, for the six digits of a pixel's place, the finest first; a column's lowest bit goes
 * to the coordinate's first digit. Found by annealing: the least sum of rank deficits over all elementary intervals of
 * 1, 2, ... 512 samples of 2, 4, ... 64 pixels. Most of these sets are (t, m, 2)-nets of t = 1, a few of t = 2 or 3. */
#define DIGIT(place, n, column) ((place) >> (5 - (n)) & 1 ? (column) : 0)
#define FIRST(p)                                                                                 \
    (DIGIT(p, 0, 0xb2dbU) ^ DIGIT(p, 1, 0x85b6U) ^ DIGIT(p, 2, 0xbb3cU) ^ DIGIT(p, 3, 0x9d14U) ^ \
     DIGIT(p, 4, 0xad63U) ^ DIGIT(p, 5, 0xd235U))
#define SECOND(p)                                                                                \
    (DIGIT(p, 0, 0xbdabU) ^ DIGIT(p, 1, 0x1efdU) ^ DIGIT(p, 2, 0xd262U) ^ DIGIT(p, 3, 0x1711U) ^ \
     DIGIT(p, 4, 0x83e6U) ^ DIGIT(p, 5, 0xdf22U))
#define SHIFT(p) {FIRST(p), SECOND(p)}
#define FOUR(p) SHIFT(p), SHIFT((p) + 1), SHIFT((p) + 2), SHIFT((p) + 3)

const uint32_t sampler_shifts[64][2] = {FOUR(0),  FOUR(4),  FOUR(8),  FOUR(12), FOUR(16), FOUR(20), FOUR(24), FOUR(28),
                                        FOUR(32), FOUR(36), FOUR(40), FOUR(44), FOUR(48), FOUR(52), FOUR(56), FOUR(60)};
