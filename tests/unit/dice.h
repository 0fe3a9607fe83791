/* dice.h - random numbers for tests: the same ones in every run.
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

/* a whole number from 0 to n - 1 */
static inline int dice_below(Dice *dice, int n)
{
    return (int)(dice_unit(dice) * n);
}

/* coordinates of -reach to reach */
static inline Vec3 dice_point(Dice *dice, double reach)
{
    double x = dice_unit(dice), y = dice_unit(dice), z = dice_unit(dice);
    return vec3((2 * x - 1) * reach, (2 * y - 1) * reach, (2 * z - 1) * reach);
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
