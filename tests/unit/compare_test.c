/* compare_test.c - sums against values worked out by hand, FLIP against an implementation by its definition.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "image/compare.h"

enum { WIDTH = 31, HEIGHT = 23 };

static void assert_near(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.9f is not %.9f", value, expected);
}

static Image new_image(uint32_t width, uint32_t height)
{
    static const char *const names[] = {"R", "G", "B"};
    Image image;
    Error error;
    assert_int_equal(image_new(width, height, names, 3, &image, &error), STATUS_OK);
    return image;
}

/* Stripes and checks that differ with kind. */
static Image pattern(int kind, float scale)
{
    Image image = new_image(WIDTH, HEIGHT);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float *pixel = image.pixels + 3 * (y * WIDTH + x);
            pixel[0] = scale * fminf(1, 1.2f * (float)((x * 37 + y * 91 + kind * 13) % 101) / 100);
            pixel[1] = scale * (float)((x * x + 3 * y + kind * 29) % 97) / 96;
            pixel[2] = scale * 0.9f * (float)((x * 5 + y * y * 7 + kind * kind * 11) % 89) / 88;
        }
    return image;
}

static Image uniform(float r, float g, float b)
{
    Image image = new_image(WIDTH, HEIGHT);
    const float rgb[3] = {r, g, b};
    for (int i = 0; i < WIDTH * HEIGHT; i++) memcpy(image.pixels + 3 * i, rgb, sizeof rgb);
    return image;
}

/* Clears both. */
static double flip_of(Image a, Image b)
{
    Comparison comparison;
    Error error = {0};
    assert_int_equal(image_compare(&a, &b, 1, true, &comparison, &error), STATUS_OK);
    image_clear(&a);
    image_clear(&b);
    return comparison.flip;
}

static void sums_are_what_they_say(void **state)
{
    (void)state;
    Image a = new_image(3, 2), b = new_image(3, 2);
    Comparison comparison;
    Error error = {0};
    for (int i = 0; i < 18; i++) a.pixels[i] = b.pixels[i] = 1;
    a.pixels[3 * 5 + 1] = 4; /* pixel (2, 1), green: 3 more */
    assert_int_equal(image_compare(&a, &b, 1, false, &comparison, &error), STATUS_OK);
    assert_near(comparison.rmse, sqrt(9.0 / 18), 1e-12);
    assert_near(comparison.relative_mse, 9 / 1.01 / 18, 1e-12);
    assert_near(comparison.max_difference, 3, 0);
    assert_int_equal(comparison.max_x, 2);
    assert_int_equal(comparison.max_y, 1);
    assert_near(comparison.mean_a[0], 1, 1e-12);
    assert_near(comparison.mean_a[1], 1.5, 1e-12);
    assert_near(comparison.mean_b[1], 1, 1e-12);
    assert_true(comparison.n_not_finite == 0 && comparison.flip == 0);
    image_clear(&a);
    image_clear(&b);
}

/* Pictures of a hundredth of the light, of which a hundredth is white: in relation to it all is the same. */
static void what_is_relative_goes_by_white(void **state)
{
    (void)state;
    Comparison full, faint;
    Error error = {0};
    Image a = pattern(0, 1), b = pattern(1, 1), faint_a = pattern(0, 0.01f), faint_b = pattern(1, 0.01f);
    assert_int_equal(image_compare(&a, &b, 1, true, &full, &error), STATUS_OK);
    assert_int_equal(image_compare(&faint_a, &faint_b, 0.01, true, &faint, &error), STATUS_OK);
    assert_true(full.relative_mse > 0.1 && full.relative_error > 0.1 && full.flip > 0.1);
    assert_near(faint.relative_mse, full.relative_mse, 1e-5);
    assert_near(faint.relative_error, full.relative_error, 1e-5);
    assert_near(faint.flip, full.flip, 1e-5);
    assert_near(faint.rmse, 0.01 * full.rmse, 1e-6);
    image_clear(&a);
    image_clear(&b);
    image_clear(&faint_a);
    image_clear(&faint_b);
}

static void what_is_not_finite_is_counted_and_left_out(void **state)
{
    (void)state;
    Image a = new_image(4, 1), b = new_image(4, 1);
    Comparison comparison;
    Error error = {0};
    for (int i = 0; i < 12; i++) a.pixels[i] = 1, b.pixels[i] = 2;
    a.pixels[0] = NAN;
    b.pixels[4] = INFINITY;
    a.pixels[8] = b.pixels[8] = -INFINITY;
    assert_int_equal(image_compare(&a, &b, 1, true, &comparison, &error), STATUS_OK);
    assert_true(comparison.n_not_finite == 3);
    assert_near(comparison.rmse, 1, 1e-12);
    assert_near(comparison.mean_b[1], 2, 1e-12);
    assert_true(isfinite(comparison.flip) && comparison.flip >= 0 && comparison.flip <= 1);
    for (int i = 0; i < 12; i++) a.pixels[i] = NAN;
    assert_int_equal(image_compare(&a, &b, 1, true, &comparison, &error), STATUS_OK);
    assert_true(comparison.n_not_finite == 12 && comparison.rmse == 0 && comparison.mean_a[0] == 0);
    image_clear(&a);
    image_clear(&b);
}

static void other_sizes_and_channels_are_refused(void **state)
{
    (void)state;
    Image a = new_image(4, 1), b = new_image(4, 2), c = new_image(4, 1);
    Comparison comparison;
    Error error = {0};
    assert_int_equal(image_compare(&a, &b, 1, true, &comparison, &error), STATUS_USAGE);
    assert_non_null(strstr(error.text, "4 x 1 and 4 x 2"));
    memcpy(c.names[2], "Z", 2);
    assert_int_equal(image_compare(&a, &c, 1, true, &comparison, &error), STATUS_USAGE);
    assert_non_null(strstr(error.text, "the second has no channels R, G and B"));
    image_clear(&a);
    image_clear(&b);
    image_clear(&c);
}

static void flip_of_a_picture_and_itself_is_nought(void **state)
{
    (void)state;
    assert_true(flip_of(pattern(0, 1), pattern(0, 1)) == 0);
    assert_true(flip_of(uniform(1, 1, 1), uniform(1, 1, 1)) == 0);
    assert_true(flip_of(uniform(3, 3, 3), uniform(9, 9, 9)) == 0); /* the display shows both as white */
}

/* Numbers by whole two-dimensional kernels in double precision, as the paper defines them. */
static void flip_agrees_with_its_definition(void **state)
{
    (void)state;
    assert_near(flip_of(pattern(0, 1), pattern(1, 1)), 0.5011975, 1e-5);
    assert_near(flip_of(pattern(0, 1), pattern(0, 0.8f)), 0.2955154, 1e-5);
    assert_near(flip_of(uniform(0, 0, 0), uniform(1, 1, 1)), 0.9673798, 1e-5);
}

static void flip_grows_with_the_difference(void **state)
{
    (void)state;
    double last = 0;
    for (int i = 1; i <= 9; i++) {
        double flip = flip_of(pattern(0, 1), pattern(0, 1 - 0.1f * (float)i));
        assert_true(flip > last && flip < 1);
        last = flip;
    }
    assert_near(flip_of(pattern(0, 1), pattern(3, 1)), flip_of(pattern(3, 1), pattern(0, 1)), 1e-12);
    /* green and blue are farthest apart */
    assert_near(flip_of(uniform(0, 1, 0), uniform(0, 0, 1)), 1, 1e-6);
}

/* A fine pattern averages out in the eye, an even shift of the same size does not. */
static void flip_sees_what_the_eye_sees(void **state)
{
    (void)state;
    Image checked = uniform(0.2f, 0.2f, 0.2f);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++) checked.pixels[3 * (y * WIDTH + x) + c] += (x + y) % 2 ? 0.05f : -0.05f;
    double fine = flip_of(uniform(0.2f, 0.2f, 0.2f), checked);
    double even = flip_of(uniform(0.2f, 0.2f, 0.2f), uniform(0.25f, 0.25f, 0.25f));
    assert_true(fine < 0.5 * even);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_what_they_say),
        cmocka_unit_test(what_is_relative_goes_by_white),
        cmocka_unit_test(what_is_not_finite_is_counted_and_left_out),
        cmocka_unit_test(other_sizes_and_channels_are_refused),
        cmocka_unit_test(flip_of_a_picture_and_itself_is_nought),
        cmocka_unit_test(flip_agrees_with_its_definition),
        cmocka_unit_test(flip_grows_with_the_difference),
        cmocka_unit_test(flip_sees_what_the_eye_sees),
    };
    return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
