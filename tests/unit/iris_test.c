/* iris_test.c - irises: the area of a disc, sides of equal shares, arcs where they are round; and the map from two numbers onto
 * them: even, and without a seam.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "complex_of.h"
#include "near.h"
#include "optics/sampling.h"
#include "scene/iris.h"

static const double pi = 3.14159265358979323846;

typedef struct Iris {
    Arena arena;
    const float *corners;
    uint32_t n;
} Iris;

static const double roundnesses[] = {0, 0.001, 0.2, 0.7, 0.999};
static const uint32_t blades[] = {3, 4, 5, 6, 7, 9, 16, 100};

static void iris_open(Iris *iris, uint32_t n_blades, double rotation, double roundness)
{
    arena_init(&iris->arena);
    iris->corners = iris_corners(&iris->arena, n_blades, rotation, roundness, &iris->n);
}

static double complex corner(const Iris *iris, uint32_t i)
{
    const float *at = iris->corners + 2 * (i % iris->n);
    return complex_of((double)at[0], (double)at[1]);
}

static double triangle(double complex a, double complex b)
{
    return 0.5 * cimag(conj(a) * b);
}

static void sides_have_equal_shares(void **state)
{
    (void)state;
    uint32_t most = 0;
    for (size_t i = 0; i < COUNT_OF(blades); i++)
        for (size_t k = 0; k < COUNT_OF(roundnesses); k++) {
            Iris iris;
            double sum = 0;
            iris_open(&iris, blades[i], 0.3, roundnesses[k]);
            most = iris.n > most ? iris.n : most;
            if (roundnesses[k] == 0) assert_int_equal(iris.n, blades[i]);
            for (uint32_t side = 0; side < iris.n; side++) {
                double area = triangle(corner(&iris, side), corner(&iris, side + 1));
                assert_near(area * iris.n / pi, 1, 2e-5); /* floats */
                sum += area;
            }
            assert_near(sum, pi, 1e-6);
            /* a corner upright, but for the rotation */
            assert_near(carg(corner(&iris, 0)), 0.3 + pi / 2, 1e-6);
            assert_near(iris_reach(iris.corners, iris.n), cabs(corner(&iris, 0)), 1e-6);
            arena_clear(&iris.arena);
        }
    printf("    %u sides at most\n", most);
    assert_true(most <= 300);
}

/* The points of an edge are on one circle, which bulges as far as is asked for; chords are within 1e-4 of it. */
static void edges_are_arcs(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(blades); i++)
        for (size_t k = 0; k < COUNT_OF(roundnesses); k++) {
            Iris iris;
            iris_open(&iris, blades[i], -1, roundnesses[k]);
            uint32_t chords = iris.n / blades[i];
            double size = cabs(corner(&iris, 0)), half = pi / blades[i], bulge = roundnesses[k] * (1 - cos(half));
            double radius = bulge > 0 ? (sin(half) * sin(half) + bulge * bulge) / (2 * bulge) : 0;
            double complex out = cexp(complex_of(0, half - 1 + pi / 2)); /* towards the middle of the first edge */
            double complex middle = out * (cos(half) + bulge - radius);
            for (uint32_t side = 0; side < chords; side++) {
                double complex a = corner(&iris, side) / size, b = corner(&iris, side + 1) / size;
                double off = chords > 1 ? radius - cabs(0.5 * (a + b) - middle) : bulge;
                if (chords > 1) assert_near(cabs(a - middle), radius, 1e-6 * (1 + radius));
                assert_true(off < 1.2e-4);
            }
            arena_clear(&iris.arena);
        }
}

static double complex place(const Iris *iris, double u, double v)
{
    float x, y;
    sampling_polygon((float)u, (float)v, iris->corners, iris->n, &x, &y);
    return complex_of((double)x, (double)y);
}

/* Small squares anywhere become areas of one size, but for those that a side's end goes through; and no two near numbers become
 * places that are far from each other, also across the diagonals, where the way around the square begins, and in the middle. */
static void the_map_is_even_and_has_no_seam(void **state)
{
    (void)state;
    srand(3);
    const double h = 1. / 512;
    for (size_t i = 0; i < COUNT_OF(blades); i++)
        for (size_t k = 0; k < COUNT_OF(roundnesses); k += 2) {
            Iris iris;
            iris_open(&iris, blades[i], 1, roundnesses[k]);
            double reach = iris_reach(iris.corners, iris.n), farthest = 0;
            int uneven = 0;
            for (int round = 0; round < 4000; round++) {
                double u = (1 - h) * rand() / RAND_MAX, v = (1 - h) * rand() / RAND_MAX;
                double complex p[4] = {place(&iris, u, v), place(&iris, u + h, v), place(&iris, u + h, v + h),
                                       place(&iris, u, v + h)};
                double area = 0;
                for (int c = 0; c < 4; c++) {
                    area += triangle(p[c], p[(c + 1) % 4]);
                    farthest = fmax(farthest, cabs(p[c] - p[(c + 1) % 4]) / h);
                }
                assert_near(area / (pi * h * h), 1, 0.4);
                uneven += fabs(area / (pi * h * h) - 1) > 2e-3;
                assert_true(cabs(p[0]) <= reach * (1 + 1e-6));
            }
            for (int step = 0; step < 1000; step++) { /* across both diagonals, and the middle line */
                double t = step / 1000., d = 1e-5;
                farthest = fmax(farthest, cabs(place(&iris, t + d, t) - place(&iris, t, t + d)) / (d * sqrt(2)));
                farthest =
                    fmax(farthest, cabs(place(&iris, t, 1 - t) - place(&iris, t + d, 1 - t + d)) / (d * sqrt(2)));
                farthest = fmax(farthest, cabs(place(&iris, t, 0.5 - d) - place(&iris, t, 0.5 + d)) / (2 * d));
            }
            assert_true(uneven < 400);
            assert_true(farthest < 2.8 * reach); /* as of a disc */
            arena_clear(&iris.arena);
        }
}

/* Means of powers of the place over all numbers, against those over the polygon: of the squared distance R^2 (2 + cos a) / 6, with
 * the angle a of a side, and of z^n 2 z0^n / ((n + 1) (n + 2)) with its first corner z0, which a disc has none of. */
static void moments_are_those_of_the_polygon(void **state)
{
    (void)state;
    enum { GRID = 1024 };
    for (size_t i = 0; i < 6; i++) {
        Iris iris;
        uint32_t n = blades[i];
        double squared = 0;
        double complex power = 0, mean = 0;
        iris_open(&iris, n, 0.4, 0);
        for (int y = 0; y < GRID; y++)
            for (int x = 0; x < GRID; x++) {
                double complex z = place(&iris, (x + 0.5) / GRID, (y + 0.5) / GRID);
                mean += z / ((double)GRID * GRID);
                squared += creal(z * conj(z)) / ((double)GRID * GRID);
                power += cpow(z, n) / ((double)GRID * GRID);
            }
        double complex first = corner(&iris, 0), expected = 2 * cpow(first, n) / ((n + 1.) * (n + 2));
        double size = cabs(first);
        assert_near(size, sqrt(2 * pi / (n * sin(2 * pi / n))), 1e-6);
        assert_near(cabs(mean), 0, 1e-6);
        assert_near(squared, size * size * (2 + cos(2 * pi / n)) / 6, 1e-5);
        assert_near(cabs(power - expected), 0, 1e-4);
        arena_clear(&iris.arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_have_equal_shares),
        cmocka_unit_test(edges_are_arcs),
        cmocka_unit_test(the_map_is_even_and_has_no_seam),
        cmocka_unit_test(moments_are_those_of_the_polygon),
    };
    return cmocka_run_group_tests_name("iris", tests, NULL, NULL);
}
