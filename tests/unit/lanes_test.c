/* lanes_test.c - four floats at once, against the same in double.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/lanes.h"
#include "test.h"

static void exponential_is_exact_to_a_float(void **unused)
{
    (void)unused;
    double worst = 0;
    for (float x = -87; x <= 88; x += 1.1e-4f) {
        Lanes all = lanes_exp(lanes(0, x, -INFINITY, x));
        double exact = exp((double)x);
        worst = fmax(worst, fabs((double)lanes_get(all, 1) - exact) / exact * 0x1p23);
        assert_true(lanes_get(all, 0) == 1 && lanes_get(all, 2) == 0 && lanes_get(all, 3) == lanes_get(all, 1));
    }
    printf("largest error of the exponential: %.2f units in the last place\n", worst);
    assert_true(worst < 1);
    assert_true(lanes_zero(lanes_exp(lanes_all(-87.5f))));
    assert_true(lanes_get(lanes_exp(lanes_all(-86.9f)), 2) > 0);
}

static void roots_and_limits(void **unused)
{
    (void)unused;
    Lanes values = lanes(0, 2, 1e-40f, 3e38f), roots = lanes_sqrt(values),
          held = lanes_clamp(lanes(-1, NAN, 7, 2), 0, 3);
    for (int i = 0; i < LANES; i++) assert_true(lanes_get(roots, i) == sqrtf(lanes_get(values, i)));
    assert_true(lanes_equal(held, lanes(0, 0, 3, 2)));
    assert_false(lanes_equal(values, lanes(0, 2, 1e-40f, 2)));
    assert_true(lanes_uniform(lanes_all(0.3f)) && !lanes_uniform(lanes(1, 1, 1, 2)));
    assert_true(lanes_zero(lanes(0, -0.0f, 0, 0)) && !lanes_zero(lanes(0, 0, 0, 1e-45f)));
    assert_true(lanes_equal(lanes_exchange(lanes(1, 2, 3, 4), 2), lanes(3, 2, 1, 4)));
    assert_true(lanes_equal(lanes_exchange(lanes(1, 2, 3, 4), 0), lanes(1, 2, 3, 4)));
}

static void comparisons(void **unused)
{
    (void)unused;
    Lanes a = lanes(1, -2, 3, -0.0f), b = lanes(1, 2, -3, NAN);
    assert_true(lanes_not_above(a, b) == 3);
    assert_true(lanes_equal(lanes_abs(a), lanes(1, 2, 3, 0)) && isnan(lanes_get(lanes_abs(b), 3)));
    Lanes lesser = lanes_lesser(a, b), greater = lanes_greater(a, b);
    for (int i = 0; i < LANES - 1; i++) {
        assert_true(lanes_get(lesser, i) == fminf(lanes_get(a, i), lanes_get(b, i)));
        assert_true(lanes_get(greater, i) == fmaxf(lanes_get(a, i), lanes_get(b, i)));
    }
    assert_true(isnan(lanes_get(lesser, 3)) && isnan(lanes_get(greater, 3)));
}

static void whole_parts(void **unused)
{
    (void)unused;
    int32_t whole[LANES];
    Lanes rest = lanes_split(lanes(0, 2.75f, -2.75f, 8388609), whole);
    assert_true(lanes_equal(rest, lanes(0, 0.75f, -0.75f, 0)));
    assert_true(whole[0] == 0 && whole[1] == 2 && whole[2] == -2 && whole[3] == 8388609);
}

/* Sums of pairs first, on every machine. */
static void sums_and_extremes(void **unused)
{
    (void)unused;
    const float a = 1e8f, b = 3, c = -1e8f, d = 5;
    Lanes four = lanes(a, b, c, d);
    float first = a + b, second = c + d;
    assert_true(lanes_sum(four) == first + second);
    assert_true(lanes_max(four) == a && lanes_min(four) == c);
    for (int i = 0; i < LANES; i++) {
        Lanes one = lanes_all(-2);
        lanes_set(&one, i, -1);
        assert_true(lanes_max(one) == -1 && lanes_min(one) == -2);
    }
}

static void wide_products_are_exact(void **unused)
{
    (void)unused;
    const float x[LANES] = {1.0000001f, -3.1415927f, 1e-20f, 8388609},
                y[LANES] = {1.0000002f, 2.7182817f, 3e-20f, 8388607};
    LanesWide wide_x = lanes_widen(lanes_load(x)), wide_y = lanes_widen(lanes_load(y));
    Lanes found = lanes_narrow(lanes_wide_sub(lanes_wide_mul(wide_x, wide_x), lanes_wide_mul(wide_y, wide_y)));
    Lanes more = lanes_narrow(lanes_wide_add(lanes_wide_mul(wide_x, wide_y), lanes_wide_all(0.5)));
    for (int i = 0; i < LANES; i++) {
        double a = (double)x[i], b = (double)y[i];
        assert_true(lanes_get(found, i) == (float)(a * a - b * b));
        assert_true(lanes_get(more, i) == (float)(a * b + 0.5));
    }
}

static void angles_all_around(void **unused)
{
    (void)unused;
    for (int i = -40000; i <= 40000; i++) {
        double angle = i * 3.14159265358979 / 40000, radius = pow(10, i % 7);
        float x = (float)(radius * cos(angle)), y = (float)(radius * sin(angle));
        Lanes found = lanes_atan2(lanes(y, 1e-3f * y, 0, 0), lanes(x, 1e3f * fabsf(x), 1, 0));
        assert_true(fabs((double)lanes_get(found, 0) - atan2((double)y, (double)x)) < 4e-7);
        double small = atan2((double)(1e-3f * y), (double)(1e3f * fabsf(x)));
        if (fabs(small) < 1) assert_true(fabs((double)lanes_get(found, 1) - small) <= 3e-7 * fabs(small));
        assert_true(lanes_get(found, 2) == 0 && lanes_get(found, 3) == 0);
    }
    assert_true(lanes_equal(lanes_atan2(lanes(0, 2, 0, -2), lanes(3, 0, -3, 0)),
                            lanes(0, 1.57079633f, 3.14159265f, -1.57079633f)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exponential_is_exact_to_a_float),
        cmocka_unit_test(roots_and_limits),
        cmocka_unit_test(comparisons),
        cmocka_unit_test(whole_parts),
        cmocka_unit_test(sums_and_extremes),
        cmocka_unit_test(wide_products_are_exact),
        cmocka_unit_test(angles_all_around),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
