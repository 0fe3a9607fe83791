/* view_test.c - colour management: known values, awkward values, unknown names, other configurations.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "image/config.h"
#include "image/view.h"

static ColorConfig *config;

static int open_config(void **state)
{
    (void)state;
    Error error;
    unsetenv("OCIO");
    return color_config_open(NULL, &config, &error) == STATUS_OK ? 0 : -1;
}

static int close_config(void **state)
{
    (void)state;
    color_config_close(config);
    return 0;
}

static void assert_near(float value, double expected, double tolerance)
{
    if (!(fabs((double)value - expected) <= tolerance)) fail_msg("%.6f is not %.6f", (double)value, expected);
}

/* One pixel through a view; rgb in place. */
static Status view_pixel(const ColorConfig *color, const char *display, const char *view, float rgb[3], Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    Image image;
    Status status = image_new(1, 1, names, 3, &image, error);
    if (status != STATUS_OK) return status;
    memcpy(image.pixels, rgb, 3 * sizeof(float));
    status = color_view(color, &(ColorLook){.display = display, .view = view}, &image, error);
    memcpy(rgb, image.pixels, 3 * sizeof(float));
    image_clear(&image);
    return status;
}

static void assert_view(const char *display, const char *view, float grey, double expected)
{
    Error error = {0};
    float rgb[3] = {grey, grey, grey};
    assert_int_equal(color_to_working(config, "ACEScg", rgb, 1, &error), STATUS_OK);
    assert_int_equal(view_pixel(config, display, view, rgb, &error), STATUS_OK);
    for (int c = 0; c < 3; c++) assert_near(rgb[c], expected, 1e-4);
}

static void middle_grey_is_where_aces_puts_it(void **state)
{
    (void)state;
    assert_view("sRGB", "ACES 1.0 SDR", 0.18f, 0.35595);
    assert_view("sRGB", "Un-tone-mapped", 0.18f, 0.46136);
    assert_view("sRGB", "ACES 1.0 SDR", 1.0f, 0.81197);
    assert_view("Rec.1886 Rec.709", "ACES 1.0 SDR", 0.18f, 0.38953);
    assert_view("Display P3", "ACES 1.0 SDR", 0.18f, 0.35595);
    assert_view("Display P3", "Un-tone-mapped", 0.18f, 0.46136);
    assert_view("sRGB", "Raw", 0.18f, 0.18);
    assert_view(NULL, NULL, 0.18f, 0.35595);
    assert_string_equal(color_config_default_display(config), "sRGB");
    assert_string_equal(color_config_default_view(config, "sRGB"), "ACES 1.0 SDR");
}

/* By stops it is brightened as light, before the view. */
static void stops_are_light(void **state)
{
    (void)state;
    static const char *const names[] = {"R", "G", "B"};
    for (int stops = -2; stops <= 2; stops++) {
        float plain[3] = {.5f, .18f, .06f}, rgb[3];
        Image image;
        Error error;
        assert_int_equal(image_new(1, 1, names, 3, &image, NULL), STATUS_OK);
        for (int c = 0; c < 3; c++) image.pixels[c] = ldexpf(plain[c], -stops);
        assert_int_equal(color_view(config, &(ColorLook){.exposure = {stops, false}}, &image, &error), STATUS_OK);
        memcpy(rgb, image.pixels, sizeof rgb);
        assert_int_equal(view_pixel(config, NULL, NULL, plain, &error), STATUS_OK);
        for (int c = 0; c < 3; c++) assert_float_equal(rgb[c], plain[c], 1e-6f);
        image_clear(&image);
    }
}

static void assert_space(const char *space, float r, float g, float b, double x, double y, double z)
{
    Error error = {0};
    float rgb[3] = {r, g, b};
    assert_int_equal(color_to_working(config, space, rgb, 1, &error), STATUS_OK);
    assert_near(rgb[0], x, 2e-5);
    assert_near(rgb[1], y, 2e-5);
    assert_near(rgb[2], z, 2e-5);
}

static void inputs_come_into_the_working_space(void **state)
{
    (void)state;
    assert_space("ACEScg", 1, 0, 0, 1.705051, -0.130256, -0.024003);
    assert_space("ACES2065-1", .5f, .5f, .5f, .5, .5, .5);
    assert_space("lin_rec709", .1f, .2f, 30, .1, .2, 30);
    assert_space("linear", .1f, .2f, 30, .1, .2, 30);
    assert_space("Utility - Linear - sRGB", .1f, .2f, .3f, .1, .2, .3);
    assert_space("sRGB texture", .5f, .5f, 1, .214041, .214041, 1);
    assert_space("sRGB", .5f, .5f, 1, .214041, .214041, 1); /* the display's name means what one sees */
    assert_space("Raw", .5f, .25f, 2, .5, .25, 2);
    assert_space("data", .5f, .25f, 2, .5, .25, 2);
    assert_space("Linear P3-D65", 1, 0, 0, 1.224940, -.042057, -.019638);
    assert_space("Linear Rec.2020", 1, 0, 0, 1.660491, -.124550, -.018151);
    assert_space("Linear P3-D65", 1, 1, 1, 1, 1, 1);
}

static void many_pixels_are_as_one(void **state)
{
    (void)state;
    enum { N = 20001 };
    Error error = {0};
    float *rgb = malloc(3 * N * sizeof *rgb);
    for (size_t i = 0; i < 3 * N; i++) rgb[i] = (float)(i % 977) / 977;
    assert_int_equal(color_to_working(config, "sRGB texture", rgb, N, &error), STATUS_OK);
    for (size_t i = 0; i < 3 * N; i += 3)
        assert_near(rgb[i], pow(((double)(i % 977) / 977 + .055) / 1.055, 2.4), 0.005);
    free(rgb);
}

/* Not-a-numbers and infinities spoil no neighbour, and a bright pixel is white, never black. */
static void awkward_values_are_held(void **state)
{
    (void)state;
    static const float awkward[] = {1e30f, 3e38f, INFINITY, 1e20f, 65504, -1e30f, -INFINITY, NAN};
    static const char *const views[] = {"ACES 1.0 SDR", "Un-tone-mapped", "Raw"};
    Error error = {0};
    for (size_t v = 0; v < COUNT_OF(views); v++)
        for (size_t i = 0; i < COUNT_OF(awkward); i++) {
            float all[3] = {awkward[i], awkward[i], awkward[i]}, one[3] = {awkward[i], .18f, .18f};
            assert_int_equal(view_pixel(config, "sRGB", views[v], all, &error), STATUS_OK);
            assert_int_equal(view_pixel(config, "sRGB", views[v], one, &error), STATUS_OK);
            for (int c = 0; c < 3; c++) {
                assert_true(one[c] >= 0 && one[c] <= 1);
                if (awkward[i] > 0)
                    assert_true(all[c] == 1);
                else
                    assert_true(all[c] < 0.01f);
            }
            if (isnan(awkward[i])) assert_true(one[1] > .1f);
        }
}

static void alpha_and_other_channels_are_left(void **state)
{
    (void)state;
    static const char *const names[] = {"A", "B", "G", "R", "depth"};
    Error error = {0};
    Image image;
    assert_int_equal(image_new(3, 2, names, 5, &image, &error), STATUS_OK);
    for (size_t i = 0; i < 30; i++) image.pixels[i] = i % 5 == 4 ? 500 : .18f;
    assert_int_equal(color_view(config, &(ColorLook){.display = "sRGB", .view = "Un-tone-mapped"}, &image, &error),
                     STATUS_OK);
    for (size_t i = 0; i < 30; i++) assert_near(image.pixels[i], i % 5 == 4 ? 500 : i % 5 == 0 ? .18 : .46136, 1e-4);
    image_clear(&image);
}

static void unknown_names_come_with_the_nearest(void **state)
{
    (void)state;
    Error error = {0};
    float rgb[3] = {0, 0, 0};
    assert_int_equal(view_pixel(config, "sRGB", "ACES SDR", rgb, &error), STATUS_USAGE);
    assert_string_equal(error.text, "the display 'sRGB' has no view 'ACES SDR'; did you mean 'ACES 1.0 SDR'?");
    assert_int_equal(view_pixel(config, "Display-P3", NULL, rgb, &error), STATUS_USAGE);
    assert_string_equal(error.text, "there is no display 'Display-P3'; did you mean 'Display P3'?");
    assert_int_equal(color_to_working(config, "ACESgc", rgb, 1, &error), STATUS_USAGE);
    assert_string_equal(error.text, "there is no color space 'ACESgc'; did you mean 'ACEScg'?");
    assert_int_equal(view_pixel(config, "sRGB", "film", rgb, &error), STATUS_USAGE);
    assert_string_equal(error.text,
                        "the display 'sRGB' has no view 'film'; there is 'ACES 1.0 SDR', 'Un-tone-mapped', 'Raw'");
    assert_int_equal(view_pixel(config, "srgb", "raw", rgb, &error), STATUS_OK);
}

static void names_are_listed_to_their_end(void **state)
{
    (void)state;
    int n = 0;
    while (color_config_display(config, n)) n++;
    assert_int_equal(n, 3);
    assert_string_equal(color_config_display(config, 0), "sRGB");
    for (n = 0; color_config_view(config, "Display P3", n);) n++;
    assert_int_equal(n, 3);
    assert_null(color_config_display(config, -1));
    assert_null(color_config_view(config, "absent", 0));
}

/* --- other configurations --- */

static char path[] = "/tmp/meniscus-view-XXXXXX";

static Status open_text(const char *text, ColorConfig **color, Error *error)
{
    strcpy(path, "/tmp/meniscus-view-XXXXXX");
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), (ssize_t)strlen(text));
    close(file);
    Status status = color_config_open(path, color, error);
    unlink(path);
    return status;
}

#define CONFIG_HEAD                                                                                                    \
    "ocio_profile_version: 2\n"                                                                                        \
    "search_path: \"\"\n"                                                                                              \
    "displays:\n  d:\n    - !<View> {name: plain, colorspace: out}\n"
#define CONFIG_OUT                                                                                                     \
    "  - !<ColorSpace>\n    name: out\n    isdata: false\n"                                                            \
    "    from_reference: !<GroupTransform>\n      children:\n"                                                         \
    "        - !<BuiltinTransform> {style: UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD}\n"                                   \
    "        - !<BuiltinTransform> {style: DISPLAY - CIE-XYZ-D65_to_sRGB}\n"

/* A config whose reference is ACES2065-1 and which does not know Rec.709 by name. */
static void a_config_is_reached_through_interchange(void **state)
{
    (void)state;
    ColorConfig *color;
    Error error = {0};
    Status status =
        open_text(CONFIG_HEAD "roles:\n  aces_interchange: ap0\n  scene_linear: ap1\n  default: ap0\n"
                              "colorspaces:\n  - !<ColorSpace>\n    name: ap0\n    isdata: false\n"
                              "  - !<ColorSpace>\n    name: ap1\n    isdata: false\n"
                              "    to_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}\n" CONFIG_OUT,
                  &color, &error);
    if (status != STATUS_OK) fail_msg("%s", error.text);
    float rgb[3] = {1, .18f, 0}, ap1[3] = {1, 0, 0};
    assert_int_equal(view_pixel(color, "d", "plain", rgb, &error), STATUS_OK);
    assert_near(rgb[0], 1, 1e-4);
    assert_near(rgb[1], .46136, 1e-4);
    assert_near(rgb[2], 0, 1e-3);
    assert_int_equal(color_to_working(color, "ap1", ap1, 1, &error), STATUS_OK);
    assert_near(ap1[0], 1.705051, 2e-5);
    color_config_close(color);
}

static void a_config_is_reached_by_name(void **state)
{
    (void)state;
    ColorConfig *color;
    Error error = {0};
    Status status = open_text("ocio_profile_version: 1\nsearch_path: \"\"\n"
                              "displays:\n  d:\n    - !<View> {name: plain, colorspace: Utility - Linear - sRGB}\n"
                              "roles:\n  scene_linear: Utility - Linear - sRGB\n  default: Utility - Linear - sRGB\n"
                              "colorspaces:\n  - !<ColorSpace>\n    name: Utility - Linear - sRGB\n    isdata: false\n",
                              &color, &error);
    if (status != STATUS_OK) fail_msg("%s", error.text);
    float rgb[3] = {1, .18f, 0};
    assert_int_equal(view_pixel(color, NULL, NULL, rgb, &error), STATUS_OK);
    assert_near(rgb[1], .18, 1e-6);
    color_config_close(color);
}

static void unusable_configs_are_refused(void **state)
{
    (void)state;
    ColorConfig *color;
    Error error = {0};
    Status status = open_text(CONFIG_HEAD "roles:\n  scene_linear: mine\n  default: mine\n"
                                          "colorspaces:\n  - !<ColorSpace>\n    name: mine\n    isdata: false\n"
                                          "  - !<ColorSpace>\n    name: out\n    isdata: false\n",
                              &color, &error);
    assert_int_equal(status, STATUS_INPUT);
    assert_null(color);
    assert_non_null(strstr(error.text, "does not tell where linear Rec.709 is"));
    static const char *const texts[] = {"", "ocio_profile_version: 99\n", "hello: [", "just words"};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        assert_int_equal(open_text(texts[i], &color, &error), STATUS_INPUT);
        assert_null(strchr(error.text, '\n'));
    }
    assert_int_equal(color_config_open("/dev/null/absent.ocio", &color, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "/dev/null/absent.ocio"));
    assert_int_equal(color_config_open("/tmp", &color, &error), STATUS_INPUT);
    setenv("OCIO", "/dev/null/of the environment.ocio", 1);
    assert_int_equal(color_config_open(NULL, &color, &error), STATUS_INPUT);
    assert_non_null(strstr(error.text, "of the environment"));
    setenv("OCIO", "", 1);
    assert_int_equal(color_config_open(NULL, &color, &error), STATUS_OK);
    color_config_close(color);
    unsetenv("OCIO");
}

/* The program carries the file as it is. */
static void the_built_in_config_is_the_file(void **state)
{
    (void)state;
    char *bytes;
    size_t length;
    Error error;
    if (file_read("src/image/meniscus.ocio", 0, &bytes, &length, &error) != STATUS_OK) skip();
    Buf joined = {0};
    for (const char *const *line = color_config_lines; *line; line++) buf_add(&joined, *line);
    assert_string_equal(buf_text(&joined), bytes);
    buf_clear(&joined);
    free(bytes);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(middle_grey_is_where_aces_puts_it),
        cmocka_unit_test(stops_are_light),
        cmocka_unit_test(inputs_come_into_the_working_space),
        cmocka_unit_test(many_pixels_are_as_one),
        cmocka_unit_test(awkward_values_are_held),
        cmocka_unit_test(alpha_and_other_channels_are_left),
        cmocka_unit_test(unknown_names_come_with_the_nearest),
        cmocka_unit_test(names_are_listed_to_their_end),
        cmocka_unit_test(a_config_is_reached_through_interchange),
        cmocka_unit_test(a_config_is_reached_by_name),
        cmocka_unit_test(unusable_configs_are_refused),
        cmocka_unit_test(the_built_in_config_is_the_file),
    };
    return cmocka_run_group_tests_name("view", tests, open_config, close_config);
}
