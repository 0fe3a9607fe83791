/* light_layers_test.c - layers of lights follow what is done to the picture, and a picture follows what is done to its layers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "image/relight.h"
#include "near.h"
#include "render/light_layers.h"

enum { WIDTH = 40, HEIGHT = 30, GROUPS = 3, PIXELS = WIDTH * HEIGHT };

static LightGroups three_groups(void)
{
    LightGroups groups = light_groups_none();
    assert_int_equal(light_groups_add(&groups, "key"), 1);
    assert_int_equal(light_groups_add(&groups, "sky"), 2);
    assert_int_equal(light_groups_add(&groups, "key"), 1);
    return groups;
}

/* Colours that are the sum of their layers; of some pixels one layer is far too bright. */
static Image make(void)
{
    static const char *const names[] = {"R",
                                        "G",
                                        "B",
                                        "A",
                                        "lights.other.R",
                                        "lights.other.G",
                                        "lights.other.B",
                                        "lights.key.R",
                                        "lights.key.G",
                                        "lights.key.B",
                                        "lights.sky.R",
                                        "lights.sky.G",
                                        "lights.sky.B",
                                        "Z"};
    Image image;
    Error error;
    assert_int_equal(image_new(WIDTH, HEIGHT, names, COUNT_OF(names), &image, &error), STATUS_OK);
    for (uint32_t i = 0; i < PIXELS; i++) {
        float *pixel = image.pixels + i * image.n_channels;
        pixel[3] = pixel[13] = 7;
        for (uint32_t k = 0; k < 3 * GROUPS; k++) {
            pixel[4 + k] = hash_to_unit_f(hash_combine(i, k));
            if (i % 97 == 0 && k / 3 == 1) pixel[4 + k] += 50;
            if (i % 83 == 0 && k / 3 == 2) pixel[4 + k] += 20;
            pixel[k % 3] += pixel[4 + k];
        }
    }
    return image;
}

static double total(const Image *image, uint32_t channel)
{
    double sum = 0;
    for (uint32_t i = 0; i < PIXELS; i++) sum += (double)image->pixels[i * image->n_channels + channel];
    return sum;
}

/* What stands out of a pixel goes to the pixels behind it. */
static void spread(Image *image)
{
    for (uint32_t i = 0; i < PIXELS; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *color = image->pixels + i * image->n_channels + c, light = *color - 3;
            if (!(light > 0)) continue;
            *color = 3;
            for (uint32_t k = 1; k <= 8; k++) image->pixels[(i + k) % PIXELS * image->n_channels + c] += light / 8;
        }
}

static void layers_follow(void **state)
{
    (void)state;
    LightGroups groups = three_groups();
    Image before = make(), image = make();
    LightLayers layers = light_layers_of(&image, &groups);
    assert_int_equal(layers.first, 4);
    assert_int_equal(layers.n, GROUPS);
    spread(&image);
    light_layers_follow(&layers, &image);
    for (uint32_t i = 0; i < PIXELS; i++)
        for (uint32_t c = 0; c < 3; c++) {
            const float *pixel = image.pixels + i * image.n_channels;
            double sum = 0;
            for (uint32_t k = 0; k < GROUPS; k++) {
                assert_true(pixel[4 + 3 * k + c] >= 0);
                sum += (double)pixel[4 + 3 * k + c];
            }
            assert_near(sum, (double)pixel[c], 1e-5 * sum);
        }
    for (uint32_t k = 0; k < 3 * GROUPS; k++) assert_near(total(&image, 4 + k), total(&before, 4 + k), 1e-5 * PIXELS);
    assert_near(total(&image, 3), 7 * PIXELS, 0);
    image_clear(&image);
    image_clear(&before);
    image = (Image){0};
    assert_int_equal(light_layers_of(&image, &groups).n, 0);
}

static void pictures_follow(void **state)
{
    (void)state;
    Error error;
    Image before = make(), image = make();
    const Relight changes[] = {{"key", {9, 9, 9}}, {"key", {2, .5f, 0}}, {"sky", {0, 0, 0}}};
    assert_int_equal(image_relight(&image, changes, COUNT_OF(changes), &error), STATUS_OK);
    for (uint32_t i = 0; i < PIXELS; i++)
        for (uint32_t c = 0; c < 3; c++) {
            const float *was = before.pixels + i * before.n_channels;
            double expected = (double)was[4 + c] + (double)changes[1].factor[c] * (double)was[7 + c];
            assert_near((double)image.pixels[i * image.n_channels + c], expected, 1e-5 * fmax(expected, 1));
        }
    const Relight other[] = {{"skye", {1, 1, 1}}};
    assert_int_equal(image_relight(&image, other, 1, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "'skye', only: other, key, sky; did you mean 'sky'?"));
    image_clear(&image);
    image_clear(&before);
}

static void names_become_parts_of_channels(void **state)
{
    (void)state;
    static const char *const good[] = {"key", "a", "Key_2-b", "1234567890123456789012345678901"},
                             *const bad[] = {"", "a.b", "a b", "*", "12345678901234567890123456789012", "\xc3\xa9"};
    for (size_t i = 0; i < COUNT_OF(good); i++) assert_true(light_group_can_be(good[i]));
    for (size_t i = 0; i < COUNT_OF(bad); i++) assert_false(light_group_can_be(bad[i]));
    LightGroups groups = light_groups_none();
    for (uint32_t i = 1; i < LIMIT_LIGHT_GROUPS; i++) {
        char name[20];
        snprintf(name, sizeof name, "group-%u", (unsigned)i);
        assert_int_equal(light_groups_add(&groups, name), i);
    }
    assert_int_equal(light_groups_add(&groups, "more"), groups.n);
    assert_int_equal(light_groups_add(&groups, LIGHT_GROUP_OTHER), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_follow),
        cmocka_unit_test(pictures_follow),
        cmocka_unit_test(names_become_parts_of_channels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
