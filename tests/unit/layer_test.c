/* layer_test.c - layers of a picture, as they can be seen.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <string.h>

#include "image/layer.h"

enum { PIXELS = 200 };

/* One row of pixels, by channels; number i of channel k is values(i, k). */
static Image picture_of(const char *const *names, uint32_t n, float (*values)(uint32_t i, uint32_t k))
{
    Image image;
    Error error;
    assert_int_equal(image_new(PIXELS, 1, names, n, &image, &error), STATUS_OK);
    for (uint32_t i = 0; i < PIXELS; i++)
        for (uint32_t k = 0; k < n; k++) image.pixels[i * n + k] = values(i, k);
    return image;
}

static Layer layer_named(const Image *image, const char *name)
{
    Layer layer;
    Error error;
    assert_true(layer_is_in(image, name));
    assert_int_equal(layer_of(image, name, &layer, &error), STATUS_OK);
    return layer;
}

static void check_pixel(const Layer *layer, uint32_t i, float red, float green, float blue)
{
    const float *pixel = image_at(&layer->image, i, 0);
    assert_float_equal(pixel[0], red, 1e-6);
    assert_float_equal(pixel[1], green, 1e-6);
    assert_float_equal(pixel[2], blue, 1e-6);
}

static float by_number(uint32_t i, uint32_t k)
{
    return (float)i + 1000 * (float)k;
}

static void colors_stay_as_they_are(void **state)
{
    (void)state;
    Image image = picture_of((const char *const[]){"B", "a.B", "a.G", "a.R", "a.b.R"}, 5, by_number);
    Layer layer = layer_named(&image, "a");
    assert_int_equal(layer.kind, LAYER_COLOR);
    check_pixel(&layer, 7, 3007, 2007, 1007);
    layer_clear(&layer);
    image_clear(&image);
}

/* Unit vectors, but nothing at first. */
static float turning(uint32_t i, uint32_t k)
{
    return i == 0 ? 0 : k == 0 ? (i % 2 ? 1.0f : -1.0f) : 0;
}

static void directions_are_grey_at_nothing(void **state)
{
    (void)state;
    const char *const names[] = {"N.X", "N.Y", "N.Z"};
    Image image = picture_of(names, 3, turning), places = picture_of(names, 3, by_number);
    Layer layer = layer_named(&image, "N");
    assert_int_equal(layer.kind, LAYER_DIRECTION);
    check_pixel(&layer, 0, 0.5f, 0.5f, 0.5f);
    check_pixel(&layer, 1, 1, 0.5f, 0.5f);
    check_pixel(&layer, 2, 0, 0.5f, 0.5f);
    layer_clear(&layer);
    layer = layer_named(&places, "N"); /* longer: not directions */
    assert_int_equal(layer.kind, LAYER_NUMBERS);
    assert_float_equal(layer.white, 2000 + PIXELS - 1, 0);
    check_pixel(&layer, 0, 0, 1000.0f / 2199, 2000.0f / 2199);
    layer_clear(&layer);
    image_clear(&image);
    image_clear(&places);
}

static float far_off(uint32_t i, uint32_t k)
{
    (void)k;
    return i == 0 ? 1e30f : i == 1 ? (float)NAN : 2 + (float)i;
}

static void distances_go_from_black_to_white(void **state)
{
    (void)state;
    Image image = picture_of((const char *const[]){"Z"}, 1, far_off);
    Layer layer = layer_named(&image, "Z");
    assert_int_equal(layer.kind, LAYER_NUMBERS);
    assert_false(layer.held);
    assert_float_equal(layer.black, 4, 0);
    assert_float_equal(layer.white, 1 + PIXELS, 0);
    assert_true(layer.has_holes);
    check_pixel(&layer, 0, 0.05f, 0.05f, 0.4f); /* nothing there */
    check_pixel(&layer, 1, 0.05f, 0.05f, 0.4f);
    check_pixel(&layer, 2, 0, 0, 0);
    check_pixel(&layer, PIXELS - 1, 1, 1, 1);
    layer_clear(&layer);
    image_clear(&image);
}

/* A ground below a camera: twice as far where half as many rows are left to the horizon. */
static float to_the_horizon(uint32_t i, uint32_t k)
{
    (void)k;
    return 10 + 1000 / (float)(PIXELS - i);
}

static void a_ground_to_the_horizon_leaves_the_near_bright(void **state)
{
    (void)state;
    Image image = picture_of((const char *const[]){"Z"}, 1, to_the_horizon);
    Layer layer = layer_named(&image, "Z");
    assert_true(layer.held);
    assert_float_equal(layer.black, 10 + 1000.0F / PIXELS, 1e-3F);
    assert_float_equal(layer.white - layer.black, 4 * 1000.0F / PIXELS, 0.5F);
    check_pixel(&layer, PIXELS - 1, 1, 1, 1);
    layer_clear(&layer);
    image_clear(&image);
}

/* Of two hundred numbers one is far larger. */
static float peaked(uint32_t i, uint32_t k)
{
    (void)k;
    return i == 50 ? 1e6f : (float)(i % 100);
}

static void a_few_large_numbers_leave_the_rest_bright(void **state)
{
    (void)state;
    Image image = picture_of((const char *const[]){"variance.Y"}, 1, peaked);
    Layer layer = layer_named(&image, "variance.Y");
    assert_true(layer.held);
    assert_false(layer.has_holes);
    assert_float_equal(layer.white, 98, 1);
    check_pixel(&layer, 50, 1, 1, 1);
    assert_true(image_at(&layer.image, 49, 0)[0] > 0.49f);
    layer_clear(&layer);
    image_clear(&image);
}

static float even(uint32_t i, uint32_t k)
{
    (void)i;
    (void)k;
    return 16;
}

static void what_is_even_is_grey_and_two_channels_leave_blue_black(void **state)
{
    (void)state;
    Image image = picture_of((const char *const[]){"samples"}, 1, even);
    Layer layer = layer_named(&image, "samples");
    assert_float_equal(layer.black, 16, 0);
    assert_float_equal(layer.white, 16, 0);
    check_pixel(&layer, 3, 0.5f, 0.5f, 0.5f);
    layer_clear(&layer);
    image_clear(&image);
    image = picture_of((const char *const[]){"uv.U", "uv.V"}, 2, by_number);
    layer = layer_named(&image, "uv");
    check_pixel(&layer, 0, 0, 1000.0f / 1199, 0);
    layer_clear(&layer);
    image_clear(&image);
}

static void names_are_of_layers_or_channels(void **state)
{
    (void)state;
    char name[LAYER_NAME_SIZE];
    Layer layer;
    Error error;
    Image image = picture_of((const char *const[]){"N.X", "N.Y", "N.Z", "noise.Y", "R"}, 5, by_number);
    layer_of_channel(&image, 1, name);
    assert_string_equal(name, "N");
    layer_of_channel(&image, 3, name);
    assert_string_equal(name, "noise.Y");
    layer_of_channel(&image, 4, name);
    assert_string_equal(name, "R");
    assert_false(layer_is_in(&image, "noise"));
    assert_false(layer_is_in(&image, ""));
    assert_int_equal(layer_of(&image, "noise", &layer, &error), STATUS_INPUT);
    image_clear(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(colors_stay_as_they_are),
        cmocka_unit_test(directions_are_grey_at_nothing),
        cmocka_unit_test(distances_go_from_black_to_white),
        cmocka_unit_test(a_ground_to_the_horizon_leaves_the_near_bright),
        cmocka_unit_test(a_few_large_numbers_leave_the_rest_bright),
        cmocka_unit_test(what_is_even_is_grey_and_two_channels_leave_blue_black),
        cmocka_unit_test(names_are_of_layers_or_channels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
