/* around_test.c - means over the neighbours of each pixel, against sums one by one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "dice.h"
#include "near.h"
#include "render/around.h"

enum { MOST = 40 };

static double mean_by_hand(const float *map, int width, int height, int radius, int x, int y)
{
    double sum = 0;
    int n = 0;
    for (int v = y - radius; v <= y + radius; v++)
        for (int u = x - radius; u <= x + radius; u++) {
            if (u < 0 || v < 0 || u >= width || v >= height || (u == x && v == y)) continue;
            sum += (double)map[v * width + u];
            n++;
        }
    return n ? sum / n : (double)map[y * width + x];
}

/* Of any shape, also where a few values are far larger than the others: what is beside them, and they themselves, are told to rounding. */
static void means_are_those_of_the_neighbours(void **state)
{
    (void)state;
    static const int cases[][3] = {{1, 1, 1}, {1, 9, 2}, {9, 1, 16}, {5, 3, 1}, {40, 30, 4}, {31, 40, 16}, {7, 7, 40}};
    static float map[MOST * MOST], scratch[MOST * MOST], mean[MOST * MOST];
    Dice dice = {7};
    for (size_t c = 0; c < COUNT_OF(cases); c++)
        for (int with_dots = 0; with_dots < 2; with_dots++) {
            int width = cases[c][0], height = cases[c][1], radius = cases[c][2];
            for (int i = 0; i < width * height; i++)
                map[i] = (float)dice_unit(&dice) * (with_dots && dice_unit(&dice) < 0.01 ? 1e14f : 1);
            mean_around(map, (uint32_t)width, (uint32_t)height, (uint32_t)radius, scratch, mean, NULL);
            for (int y = 0; y < height; y++)
                for (int x = 0; x < width; x++) {
                    double wanted = mean_by_hand(map, width, height, radius, x, y);
                    assert_near((double)mean[y * width + x], wanted, 1e-5 * wanted);
                }
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(means_are_those_of_the_neighbours)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
