/* Natural curves through points against closed forms: those of regular polygons, of parabolas and lines, of three points; their
 * bending does not jump; their equations hold for steps of any length.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <stdlib.h>

#include "near.h"
#include "shape/smooth.h"

static const double pi = 3.14159265358979323846;

enum { MOST = 64, WIDTH = 2 };

typedef struct Curve {
    double values[MOST * WIDTH], times[MOST], velocities[2 * MOST * WIDTH];
    NaturalAt at[MOST];
    NaturalPoints points;
} Curve;

static void curve_solve(Curve *c, size_t n, bool closed, bool ends)
{
    for (size_t i = 0; i < n; i++) {
        const double *p = c->values + WIDTH * i, *q = c->values + WIDTH * ((i + 1) % n);
        c->times[i] = smooth_time(hypot(q[0] - p[0], q[1] - p[1]));
    }
    c->points = (NaturalPoints){c->values, c->times, ends ? c->at : NULL, n, WIDTH, closed};
    assert_true(natural_velocities(&c->points, c->velocities));
}

/* The place, or its first or second derivative in the curve's own time, at u of piece i. */
static double curve_at(const Curve *c, size_t i, unsigned which, double u, int derivative)
{
    size_t n = c->points.n;
    const double *v = c->velocities + 2 * WIDTH * i;
    double a = c->values[WIDTH * i + which], b = c->values[WIDTH * ((i + 1) % n) + which], s = v[which],
           e = v[WIDTH + which];
    double p = 3 * (b - a) - 2 * s - e, q = s + e - 2 * (b - a), h = c->times[i];
    if (derivative == 2) return (2 * p + 6 * q * u) / (h * h);
    if (derivative == 1) return (s + u * (2 * p + 3 * q * u)) / h;
    return a + u * (s + u * (p + u * q));
}

/* Through n points of the unit circle the radius is least halfway between two of them. */
static void regular_polygons(void **state)
{
    (void)state;
    static Curve c;
    for (size_t n = 3; n <= 32; n++) {
        double angle = 2 * pi / (double)n, least = 1, most = 1;
        for (size_t i = 0; i < n; i++) {
            c.values[2 * i] = cos(angle * (double)i);
            c.values[2 * i + 1] = sin(angle * (double)i);
        }
        curve_solve(&c, n, true, false);
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k <= 20; k++) {
                double r = hypot(curve_at(&c, i, 0, k / 20., 0), curve_at(&c, i, 1, k / 20., 0));
                least = fmin(least, r);
                most = fmax(most, r);
            }
        double expected = cos(angle / 2) * (1 + 0.75 * (1 - cos(angle)) / (2 + cos(angle)));
        assert_near(least, expected, 1e-14);
        assert_near(most, 1, 1e-14);
        if (n == 4) assert_near(least, 11 * sqrt(2) / 16, 1e-14);
        if (n == 4 || n == 8 || n == 16)
            printf("    %zu points of a circle: the radius is off by %.4f %%\n", n, 100 * (1 - least));
    }
}

/* Random points, with steps of very different lengths: velocity and second derivative are the same on both sides of each, and the
 * latter is 0 at open ends. */
static void bending_does_not_jump(void **state)
{
    (void)state;
    static Curve c;
    srand(7);
    double worst = 0;
    for (int round = 0; round < 2000; round++) {
        size_t n = 3 + (size_t)rand() % (MOST - 3);
        bool closed = round % 2;
        double x = 0, y = 0;
        for (size_t i = 0; i < n; i++) {
            double step = pow(10, 6. * rand() / RAND_MAX - 3), angle = 2 * pi * rand() / RAND_MAX;
            c.values[2 * i] = x += step * cos(angle);
            c.values[2 * i + 1] = y += step * sin(angle);
        }
        curve_solve(&c, n, closed, false);
        for (size_t i = 0; i < (closed ? n : n - 1); i++)
            for (unsigned which = 0; which < 2; which++) {
                bool last = !closed && i == n - 2;
                size_t next = (i + 1) % n;
                double scale =
                    fabs(c.values[2 * i] - c.values[2 * next]) + fabs(c.values[2 * i + 1] - c.values[2 * next + 1]);
                scale = (fabs(curve_at(&c, i, which, 0, 2)) + fabs(curve_at(&c, i, which, 1, 2)) +
                         scale / pow(c.times[i], 2));
                double after = last ? 0 : curve_at(&c, next, which, 0, 2);
                worst = fmax(worst, fabs(curve_at(&c, i, which, 1, 2) - after) / (scale + fabs(after)));
                if (!closed && i == 0) worst = fmax(worst, fabs(curve_at(&c, 0, which, 0, 2)) / scale);
                if (!last)
                    assert_near(curve_at(&c, i, which, 1, 1), curve_at(&c, next, which, 0, 1),
                                1e-9 * scale * c.times[i]);
            }
    }
    printf("    second derivatives on both sides of a point differ by %.1g of themselves at most\n", worst);
    assert_true(worst < 1e-8);
}

static void open_curves(void **state)
{
    (void)state;
    static Curve c;
    /* two points: a straight line, evenly; three of an angle: 11/16 of its height after half of a leg */
    const double two[] = {1, 2, 5, -6}, three[] = {-1, 0, 0, 1, 1, 0};
    memcpy(c.values, two, sizeof two);
    curve_solve(&c, 2, false, false);
    assert_near(curve_at(&c, 0, 0, 0.25, 0), 2, 1e-15);
    assert_near(curve_at(&c, 0, 1, 0.25, 0), 0, 1e-15);
    memcpy(c.values, three, sizeof three);
    curve_solve(&c, 3, false, false);
    assert_near(curve_at(&c, 0, 1, 0.5, 0), 11. / 16, 1e-15);
    assert_near(curve_at(&c, 0, 0, 0.5, 0), -0.5, 1e-15);
    assert_near(curve_at(&c, 1, 1, 0.5, 0), 11. / 16, 1e-15);
}

/* A closed curve with corners is open curves in a row; with ends at the axis it is half of the closed curve through the points and
 * their mirror images. */
static void curves_with_ends(void **state)
{
    (void)state;
    static Curve whole, half;
    enum { N = 7 };
    for (size_t i = 0; i < 2 * N - 2; i++) { /* i = 0 and i = N - 1 on the axis */
        double turn = pi * (double)i / (N - 1), r = 1 + 0.3 * cos(2 * turn) + 0.1 * cos(3 * turn);
        whole.values[2 * i] = i % (N - 1) ? r * sin(turn) : 0;
        whole.values[2 * i + 1] = -r * cos(turn);
    }
    curve_solve(&whole, 2 * N - 2, true, false);
    memcpy(half.values, whole.values, 2 * N * sizeof(double));
    for (size_t i = 0; i < N; i++) half.at[i] = i % (N - 1) ? NATURAL_PASSES : NATURAL_MIRRORED;
    curve_solve(&half, N, true, true);
    for (size_t i = 0; i < N - 1; i++)
        for (unsigned which = 0; which < 2; which++)
            assert_near(curve_at(&half, i, which, 0.3, 0), curve_at(&whole, i, which, 0.3, 0), 1e-14);
    /* the piece that closes it along the axis is by itself */
    assert_near(curve_at(&half, N - 1, 0, 0.5, 0), 0, 0);
    static Curve square;
    const double corners[] = {0, 0, 1, 0, 1, 1, 0, 1};
    memcpy(square.values, corners, sizeof corners);
    for (size_t i = 0; i < 4; i++) square.at[i] = NATURAL_CORNER;
    curve_solve(&square, 4, true, true);
    assert_near(curve_at(&square, 0, 1, 0.5, 0), 0, 0);
    assert_near(curve_at(&square, 3, 1, 0.5, 0), 0.5, 1e-15);
    /* one corner, wherever it is counted from: around, and back to it */
    for (size_t corner = 0; corner < 4; corner++) {
        for (size_t i = 0; i < 4; i++) square.at[i] = i == corner ? NATURAL_CORNER : NATURAL_PASSES;
        curve_solve(&square, 4, true, true);
        for (unsigned which = 0; which < 2; which++) {
            assert_near(curve_at(&square, corner, which, 0, 2), 0, 1e-14);
            assert_near(curve_at(&square, (corner + 3) % 4, which, 1, 2), 0, 1e-14);
            assert_near(curve_at(&square, corner, which, 1, 2), curve_at(&square, (corner + 1) % 4, which, 0, 2),
                        1e-14);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regular_polygons),
        cmocka_unit_test(bending_does_not_jump),
        cmocka_unit_test(open_curves),
        cmocka_unit_test(curves_with_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
