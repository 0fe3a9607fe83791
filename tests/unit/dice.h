/* dice.h - random numbers for tests of geometry: the same ones in every run.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_DICE_H
#define MEN_TEST_DICE_H

#include <math.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/vec3.h"

typedef struct Dice {
    uint64_t state;
} Dice;

static inline double dice_unit(Dice *dice)
{
    return hash_to_unit(hash_u64(dice->state++));
}

static inline Vec3 dice_direction(Dice *dice)
{
    double y = 2 * dice_unit(dice) - 1;
    double angle = 2 * 3.14159265358979323846 * dice_unit(dice);
    double r = sqrt(1 - y * y);
    return vec3(r * cos(angle), y, r * sin(angle));
}

/* from 1 down to 1e-18, evenly in the logarithm */
static inline double dice_tiny(Dice *dice)
{
    return pow(10, -18 * dice_unit(dice));
}

#endif
