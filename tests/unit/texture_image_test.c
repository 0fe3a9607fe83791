/* texture_image_test.c - pictures on surfaces: filtering held to means, edges, orientation, spectra.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "base/hash.h"
#include "exact_color.h"
#include "near.h"
#include "optics/color.h"
#include "optics/texture_image.h"

static float *noise_pixels(size_t n)
{
    float *pixels = malloc(n * sizeof *pixels);
    assert_non_null(pixels);
    for (size_t i = 0; i < n; i++) pixels[i] = hash_to_unit_f(hash_u32((uint32_t)i));
    return pixels;
}

static TextureImage *new_numbers(const float *pixels, uint32_t channels, uint32_t width, uint32_t height)
{
    TextureImage *image;
    Error error;
    assert_int_equal(texture_image_new_numbers(pixels, channels, width, height, &image, &error), STATUS_OK);
    return image;
}

static double number_at(const TextureImage *image, double u, double v, double width, TextureWrap wrap)
{
    TextureLook look = {u, v, (float)width, (float)width, wrap};
    float values[3];
    texture_image_numbers(image, &look, values);
    return (double)values[0];
}

static Lanes color_at(const TextureImage *image, const TextureLook *look, Lanes nm)
{
    Lanes sum = lanes_all(0);
    texture_image_add_color(image, look, 1, &(Wavelengths){1, &nm}, &sum);
    return sum;
}

/* Whatever the size, powers of two or not: the whole seen from afar is the mean of all pixels, and so is the mean of what
 * is seen at any width. */
static void means_stay(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {2, 3}, {7, 5}, {64, 64}, {100, 33}, {257, 1}, {1, 31}, {129, 255}};
    for (size_t i = 0; i < COUNT_OF(sizes); i++) {
        uint32_t width = sizes[i][0], height = sizes[i][1];
        size_t n = (size_t)width * height;
        float *pixels = noise_pixels(n);
        double mean = 0;
        for (size_t k = 0; k < n; k++) mean += (double)pixels[k] / (double)n;
        TextureImage *image = new_numbers(pixels, 1, width, height);
        assert_near(number_at(image, 0.37, 0.9, 10, WRAP_REPEAT), mean, 1e-5);
        for (double look = 0.001; look < 2; look *= 3) {
            double sum = 0;
            const int steps = 512;
            for (int y = 0; y < steps; y++)
                for (int x = 0; x < steps; x++)
                    sum += number_at(image, (x + 0.5) / steps, (y + 0.5) / steps, look, WRAP_REPEAT) / (steps * steps);
            assert_near(sum, mean, 0.003);
        }
        texture_image_free(image);
        free(pixels);
    }
}

/* A look of the width of many pixels differs from the mean over that width by little. */
static void wide_looks_are_local_means(void **state)
{
    (void)state;
    enum { SIDE = 128 };
    float *pixels = noise_pixels(SIDE * SIDE);
    TextureImage *image = new_numbers(pixels, 1, SIDE, SIDE);
    double squares = 0;
    for (int k = 0; k < 200; k++) {
        double u = k / 200.0, v = k * 7 % 200 / 200.0;
        squares += pow(number_at(image, u, v, 1.0 / 8, WRAP_REPEAT) - 0.5, 2) / 200;
    }
    /* of 16 by 16 pixels, uniform in 0..1; bilinear between such means varies less */
    assert_true(sqrt(squares) < sqrt(1.0 / 12) / 16);
    assert_true(sqrt(squares) > sqrt(1.0 / 12) / 16 / 4);
    texture_image_free(image);
    free(pixels);
}

static void pixels_are_where_they_are(void **state)
{
    (void)state;
    /* top left, top right, bottom left, bottom right */
    const float pixels[4] = {1, 2, 3, 4};
    TextureImage *image = new_numbers(pixels, 1, 2, 2);
    for (int wrap = WRAP_REPEAT; wrap <= WRAP_ONCE; wrap++) {
        TextureWrap w = (TextureWrap)wrap;
        assert_near(number_at(image, 0.25, 0.75, 0, w), 1, 0);
        assert_near(number_at(image, 0.75, 0.75, 0, w), 2, 0);
        assert_near(number_at(image, 0.25, 0.25, 0, w), 3, 0);
        assert_near(number_at(image, 0.75, 0.25, 0, w), 4, 0);
        assert_near(number_at(image, 0.5, 0.5, 0, w), 2.5, 1e-6);
        assert_near(number_at(image, 0.5, 0.25, 0, w), 3.5, 1e-6);
    }
    assert_near(number_at(image, -3.75, 5.75, 0, WRAP_REPEAT), 1, 0);
    assert_near(number_at(image, 1, 0.75, 0, WRAP_REPEAT), 1.5, 1e-6);
    assert_near(number_at(image, -7, 9, 0, WRAP_CLAMP), 1, 0);
    assert_near(number_at(image, 1, 0.25, 0, WRAP_CLAMP), 4, 0);
    assert_near(number_at(image, 1.25, 0.75, 0, WRAP_MIRROR), 2, 0);
    assert_near(number_at(image, -0.25, 0.75, 0, WRAP_MIRROR), 1, 0);
    assert_near(number_at(image, 2.25, 0.75, 0, WRAP_MIRROR), 1, 0);
    assert_near(number_at(image, 1.75, -0.75, 0, WRAP_MIRROR), 1, 0);
    static const double odd[] = {1e300, -1e300, 1e13};
    for (size_t i = 0; i < COUNT_OF(odd); i++)
        for (int wrap = WRAP_REPEAT; wrap <= WRAP_ONCE; wrap++)
            assert_true(isfinite(number_at(image, odd[i], (double)NAN, 0, (TextureWrap)wrap)));
    assert_true(isfinite(number_at(image, HUGE_VAL, 0, (double)NAN, WRAP_REPEAT)));
    assert_true(isfinite(number_at(image, 0, 0, HUGE_VAL, WRAP_REPEAT)));
    texture_image_free(image);
}

/* One picture and nothing else: a number is 0 beyond it, half of it at its edge, and all of them together are what the picture has. */
static void pictures_end_where_they_end(void **state)
{
    (void)state;
    const float pixels[4] = {1, 2, 3, 4};
    TextureImage *image = new_numbers(pixels, 1, 2, 2);
    assert_near(number_at(image, -0.25, 0.75, 0, WRAP_ONCE), 0, 0);
    assert_near(number_at(image, 0.25, 1.25, 0, WRAP_ONCE), 0, 0);
    assert_near(number_at(image, 1e300, 0.5, 0, WRAP_ONCE), 0, 0);
    assert_near(number_at(image, (double)NAN, 0.5, 0, WRAP_ONCE), 0, 0);
    assert_near(number_at(image, 0, 0.75, 0, WRAP_ONCE), 0.5, 1e-6);
    assert_near(number_at(image, 1, 0, 0, WRAP_ONCE), 1, 1e-6);
    for (double width = 0.001; width < 5; width *= 5) {
        enum { STEPS = 200 };
        double sum = 0;
        for (int y = 0; y < STEPS; y++)
            for (int x = 0; x < STEPS; x++)
                sum += number_at(image, 3 * (x + 0.5) / STEPS - 1, 3 * (y + 0.5) / STEPS - 1, width, WRAP_ONCE);
        assert_near(sum * 9 / (STEPS * STEPS), 2.5, 0.003);
    }
    texture_image_free(image);
    const float bent[3] = {0.7f, 0.4f, 0.9f};
    image = new_numbers(bent, 3, 1, 1);
    float values[3];
    texture_image_numbers(image, &(TextureLook){.u = 3, .v = 0.5, .wrap = WRAP_ONCE}, values);
    assert_true(values[0] == 0.5f && values[1] == 0.5f && values[2] == 1);
    texture_image_numbers(image, &(TextureLook){.u = 0.5, .v = 0.5, .wrap = WRAP_ONCE}, values);
    assert_true(values[0] == bent[0] && values[1] == bent[1] && values[2] == bent[2]);
    texture_image_free(image);
    Error error;
    TextureLook inside = {.u = 0.5, .v = 0.5, .wrap = WRAP_ONCE}, beyond = {.u = 2, .v = 0.5, .wrap = WRAP_ONCE};
    assert_int_equal(texture_image_new_colors(bent, 1, 1, &image, &error), STATUS_OK);
    assert_true(lanes_equal(color_at(image, &inside, lanes_all(550)), color_at(image, &beyond, lanes_all(550))));
    texture_image_free(image);
    assert_int_equal(texture_image_new_light(bent, 1, 1, &image, &error), STATUS_OK);
    assert_true(lanes_zero(color_at(image, &beyond, lanes_all(550))));
    assert_false(lanes_zero(color_at(image, &inside, lanes_all(550))));
    texture_image_free(image);
}

static void resolve(const TextureImage *image, bool light, double rgb[3])
{
    float table[SPECTRUM_SAMPLES];
    const TextureLook look = {.u = 0.75, .v = 0.25, .wrap = WRAP_CLAMP};
    for (int s = 0; s < SPECTRUM_SAMPLES; s++) {
        Lanes nm = lanes_all(SPECTRUM_MIN_NM + (float)(s * SPECTRUM_STEP_NM)), color = color_at(image, &look, nm);
        table[s] = lanes_get(light ? color : lanes_mul(color, white_at(nm)), 0);
    }
    color_from_spectrum(&(Spectrum){.kind = SPECTRUM_TABLE, .scale = 1, .table = table}, rgb);
}

/* Beside what is far brighter, too: a lamp in a picture of a room. */
static void dark_colours_are_as_right_as_bright_ones(void **state)
{
    (void)state;
    enum { SIDE = 2 };
    double worst = 0;
    for (int light = 0; light < 2; light++)
        for (float beside = 1; beside < 2e8f; beside *= light ? 10 : 1e9f)
            for (float scale = 1; scale > 1e-5f; scale /= 3) {
                const float colour[3] = {0.5f * scale, 0.25f * scale, 0.1f * scale};
                float pixels[SIDE * SIDE * 3];
                for (int i = 0; i < SIDE * SIDE * 3; i++) pixels[i] = i < 3 ? beside : colour[i % 3];
                TextureImage *image;
                Error error;
                double rgb[3];
                assert_int_equal(
                    (light ? texture_image_new_light : texture_image_new_colors)(pixels, SIDE, SIDE, &image, &error),
                    STATUS_OK);
                resolve(image, light, rgb);
                for (int c = 0; c < 3; c++)
                    worst = fmax(worst, fabs(rgb[c] - (double)colour[c]) / (0.5 * (double)scale));
                texture_image_free(image);
            }
    printf("    of the largest channel, colours are off by %.5f at most\n", worst);
    assert_true(worst < 0.016); /* the table's 0.002, where it is used as it is; beside 1e5 it was 40 */
}

/* A picture of one colour is that colour, at any width; a mixture of two is what both come to. */
static void colours_are_spectra(void **state)
{
    (void)state;
    static const double colours[][3] = {{0.8, 0.1, 0.05}, {0, 0, 0},       {1, 1, 1},
                                        {0.2, 0.5, 0.9},  {0.5, 0.5, 0.5}, {1, 0, 1}};
    enum { N = 3 };
    double worst = 0;
    for (size_t i = 0; i < COUNT_OF(colours); i++) {
        float pixels[N * N * 3];
        for (size_t k = 0; k < N * N * 3; k++) pixels[k] = (float)colours[i][k % 3];
        TextureImage *image;
        Error error;
        assert_int_equal(texture_image_new_colors(pixels, N, N, &image, &error), STATUS_OK);
        float table[SPECTRUM_SAMPLES];
        for (int far = 0; far < 2; far++) {
            TextureLook look = {.u = 0.3, .v = 0.7, .width_u = (float)far};
            for (int s = 0; s < SPECTRUM_SAMPLES; s++) {
                Lanes nm = lanes_all(SPECTRUM_MIN_NM + (float)(s * SPECTRUM_STEP_NM));
                float reflectance = lanes_get(color_at(image, &look, nm), 0);
                assert_true(reflectance >= 0 && reflectance <= 1.000001f);
                table[s] = reflectance * lanes_get(white_at(nm), 0);
            }
            Spectrum spectrum = {.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
            double rgb[3];
            color_from_spectrum(&spectrum, rgb);
            for (int c = 0; c < 3; c++) worst = fmax(worst, fabs(rgb[c] - colours[i][c]));
        }
        texture_image_free(image);
    }
    printf("    colours of pictures come back to within %.5f\n", worst);
    assert_true(worst < 0.002);
}

static void sizes_are_checked(void **state)
{
    (void)state;
    TextureImage *image;
    Error error;
    float pixel[3] = {0};
    assert_int_equal(texture_image_new_numbers(pixel, 1, 0, 1, &image, &error), STATUS_INPUT);
    assert_int_equal(texture_image_new_colors(pixel, 1, 65537, &image, &error), STATUS_INPUT);
    TextureImage *one = new_numbers(pixel, 3, 1, 1);
    assert_int_equal(texture_image_channels(one), 3);
    pixel[1] = 0.5f;
    TextureImage *other = new_numbers(pixel, 3, 1, 1);
    assert_true(texture_image_hash(one) != texture_image_hash(other));
    float least, most;
    texture_image_range(other, 1, &least, &most);
    assert_true(least == 0.5f && most == 0.5f);
    texture_image_free(one);
    texture_image_free(other);
    texture_image_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(means_stay),
        cmocka_unit_test(wide_looks_are_local_means),
        cmocka_unit_test(pixels_are_where_they_are),
        cmocka_unit_test(pictures_end_where_they_end),
        cmocka_unit_test(colours_are_spectra),
        cmocka_unit_test(dark_colours_are_as_right_as_bright_ones),
        cmocka_unit_test(sizes_are_checked),
    };
    return cmocka_run_group_tests_name("texture_image", tests, NULL, NULL);
}
