/* brightness_test.c - the exposure that pictures ask for: of pictures whose best one is known.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "render/brightness.h"

enum { WIDTH = 100, HEIGHT = 40, QUARTER = 10 }; /* QUARTER: rows */

/* A grey picture: rows up to the first limit have the first luminance, and so on. */
static Image striped(const uint32_t *limits, const double *luminances, size_t n)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    Image image;
    Error error;
    assert_int_equal(image_new(WIDTH, HEIGHT, names, 4, &image, &error), STATUS_OK);
    size_t stripe = 0;
    for (uint32_t y = 0; y < HEIGHT; y++) {
        while (stripe + 1 < n && y >= limits[stripe]) stripe++;
        for (uint32_t x = 0; x < WIDTH; x++) {
            float *pixel = image_at(&image, x, y);
            for (int c = 0; c < 3; c++) pixel[c] = (float)luminances[stripe];
            pixel[3] = luminances[stripe] < 0 ? 0.0f : 1.0f; /* below 0: nothing is there */
        }
    }
    return image;
}

static double stops_of(const uint32_t *limits, const double *luminances, size_t n)
{
    Image image = striped(limits, luminances, n);
    Brightness brightness = brightness_find(&image, 0);
    image_clear(&image);
    return brightness_stops(&brightness);
}

/* Whatever its luminance, a wall of one colour is at most white, and at least that less a quarter of a stop. */
static void walls_are_white(void **state)
{
    (void)state;
    const uint32_t all = HEIGHT;
    for (double luminance = 1e-6; luminance < 1e6; luminance *= 1.7) {
        double shown = luminance * exp2(stops_of(&all, &luminance, 1));
        assert_true(shown <= 1.00001 && shown >= 0.8408);
    }
}

/* Twice the light is a stop less, of any picture. */
static void light_and_stops_make_up_for_each_other(void **state)
{
    (void)state;
    const uint32_t limits[] = {3, 17, HEIGHT};
    double luminances[] = {4.1, 0.37, 0.021};
    double first = stops_of(limits, luminances, 3);
    for (int k = 1; k < 12; k++) {
        for (int i = 0; i < 3; i++) luminances[i] *= 2;
        assert_near(stops_of(limits, luminances, 3), first - k, 0);
    }
}

/* A window of a twentieth of the picture, 2000 times as bright as the room: the room is seen, 5 stops below white; one of a
 * quarter of it is worth more than the room. A lamp of a hundredth counts for nothing. */
static void rooms_are_seen_beside_windows(void **state)
{
    (void)state;
    const uint32_t small[] = {HEIGHT / 20, HEIGHT}, large[] = {QUARTER, HEIGHT};
    const double luminances[] = {200.3, 0.1};
    double room = luminances[1] * exp2(stops_of(small, luminances, 2));
    assert_true(room >= 1.0 / 32 && room <= 1.0 / 24);
    double window = luminances[0] * exp2(stops_of(large, luminances, 2));
    assert_true(window <= 1);

    Image image = striped((const uint32_t[]){HEIGHT}, &luminances[1], 1);
    for (uint32_t x = 0; x < WIDTH * HEIGHT / 100; x++)
        for (int c = 0; c < 3; c++) image_at(&image, x, 0)[c] = 1000;
    Brightness brightness = brightness_find(&image, 0);
    double beside_lamp = luminances[1] * exp2(brightness_stops(&brightness));
    assert_true(beside_lamp <= 1 && beside_lamp > 0.8);
    image_clear(&image);
}

/* What lies before a dark ground is shown as it would be alone, as the ground is not black; and black is not worth anything. */
static void grounds_may_be_dark(void **state)
{
    (void)state;
    const uint32_t limits[] = {QUARTER, HEIGHT};
    assert_near(stops_of(limits, (const double[]){0.9, 0.04}, 2), 0, 0);
    assert_near(stops_of(limits, (const double[]){0.9, 0}, 2), 0, 0);
    assert_near(stops_of(limits, (const double[]){0.9, -1}, 2), 0, 0); /* nothing is there */
}

static void black_pictures_stay(void **state)
{
    (void)state;
    const uint32_t all = HEIGHT;
    assert_near(stops_of(&all, (const double[]){0}, 1), 0, 0);
    assert_near(stops_of(&all, (const double[]){-1}, 1), 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls_are_white),
        cmocka_unit_test(light_and_stops_make_up_for_each_other),
        cmocka_unit_test(rooms_are_seen_beside_windows),
        cmocka_unit_test(grounds_may_be_dark),
        cmocka_unit_test(black_pictures_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
