/* measured_test.c - spectrum(): rows in place and from files reach the media
 * and lights; rows that make no sense are refused where they stand.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <stdlib.h>
#include <unistd.h>

#include "near.h"
#include "optics/color.h"
#include "scene_fixture.h"

#define M FIXTURE_MEDIA
#define V FIXTURE_VIEW

static double at(const Spectrum *spectrum, double nm)
{
    return (double)spectrum_at_one(spectrum, (float)nm);
}

static void rows_in_place_are_linear_in_between(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, M "let s = spectrum([<400, 1>, <500, 2>, <700, 10>]) medium "
                       "w { ior = spectrum([<300, 1.5>, <900, 1.2>])"
                       "  absorption = s / 1cm } medium v { ior = 1.3 absorption "
                       "= 2 * s * 3 } sphere { interior = w } "
                       "sphere { interior = v center = <9, 0, 0> } " V);
    const SceneMedium *media = f.scene->media;
    uint32_t w = f.scene->objects[0].medium, v = f.scene->objects[1].medium;
    assert_true(media[w].disperses && media[w].absorbs);
    assert_near(at(&media[w].ior, 360), 1.47, 1e-6);
    assert_near(at(&media[w].ior, 600), 1.35, 1e-6);
    assert_near(at(&media[w].absorption, 450), .15, 1e-7); /* a row of per centimetre, in a scene of millimetres */
    assert_near(at(&media[w].absorption, 500), .2, 1e-7);
    assert_near(at(&media[w].absorption, 600), .6, 1e-7);
    assert_near(at(&media[w].absorption, 365), .1, 1e-7);
    assert_near(at(&media[w].absorption, 825), 1, 1e-7);
    assert_near(at(&media[v].absorption, 500), 12, 1e-5);
    fixture_clear(&f);
}

/* A line of 1 nm counts by its area, wherever between the kept wavelengths it
 * lies. */
static void fine_rows_keep_their_area(void **state)
{
    (void)state;
    float table[SPECTRUM_SAMPLES];
    for (double line = 545; line < 550; line += .3) {
        double rows[] = {300, 0, line - 1, 0, line, 7, line + 1, 0, 900, 0};
        Spectrum spectrum = spectrum_from_rows(rows, 5, table);
        double area = 0;
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) area += (double)table[i] * SPECTRUM_STEP_NM;
        assert_near(area, 7, line == 545 ? 28 : 1e-4); /* a lone row at a kept wavelength is taken as it is */
        assert_true(at(&spectrum, 700) == 0);
    }
    double coarse[] = {360, 1, 830, 1};
    Spectrum flat = spectrum_from_rows(coarse, 2, table);
    assert_true(spectrum_is_constant(&flat));
}

static void lights_are_as_bright_as_white(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, M "sphere { interior = glass } light { shape = sphere from "
                       "= <0, 90, 0> radius = 3 "
                       "color = .5 * spectrum([<400, 10>, <700, 90>]) } camera { "
                       "from = <0, 0, 50> }");
    const Spectrum *light = &f.scene->lights[0].radiance;
    assert_near(spectrum_luminance(light), .5, 1e-6);
    assert_near(at(light, 700) / at(light, 400), 9, 1e-4);
    fixture_clear(&f);
    fixture_good(&f, M "sphere { interior = glass } light { shape = sphere from = <0, 90, 0> radius = 3 "
                       "color = 3 * blackbody(2856K) } camera { from = <0, 0, 50> }");
    assert_near(spectrum_luminance(&f.scene->lights[0].radiance), 3, 1e-5);
    fixture_clear(&f);
}

/* The text of a file; where and what is wrong with it, NULL for nothing. */
static void file_is(const char *text, size_t length, DiagCode code, const char *place)
{
    char path[] = "/tmp/meniscus-spectrum-XXXXXX", scene[800];
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, text, length), (ssize_t)length);
    close(descriptor);
    snprintf(scene, sizeof scene,
             M "medium w { ior = 1.3 absorption = spectrum(\"%s\") } sphere { "
               "interior = w }" V,
             path);
    Fixture f;
    fixture_text(&f, scene);
    if (place) {
        const Diagnostic *report = fixture_find(&f, code);
        if (!report) fixture_print(&f);
        assert_non_null(report);
        Buf out = {0};
        diag_print(&f.diag, &out, false);
        if (!strstr(buf_text(&out), place)) fail_msg("'%s' is not in: %s", place, buf_text(&out));
        buf_clear(&out);
    } else {
        if (f.status != STATUS_OK) fixture_print(&f);
        assert_int_equal(f.status, STATUS_OK);
        const Spectrum *absorption = &f.scene->media[f.scene->objects[0].medium].absorption;
        assert_near(at(absorption, 450), 1.5, 1e-6);
        assert_int_equal(f.scene->n_files, 1);
    }
    fixture_clear(&f);
    unlink(path);
}
#define FILE_IS(text, code, place) file_is(text, sizeof(text) - 1, code, place)

static void files_have_two_columns(void **state)
{
    (void)state;
    FILE_IS("400 1\n500 2\n", 0, NULL);
    FILE_IS("\xef\xbb\xbfnm,per mm\r\n# measured\r\n400,1\r\n\r\n500;\t2 # the "
            "last\r\n",
            0, NULL);
    FILE_IS("400 1\n500 2", 0, NULL);
    FILE_IS("nm,per mm\r400,1\r500,2\r", 0, NULL);
    FILE_IS("400 1\rfive 2\r", D_BAD_SPECTRUM, ":2:1: error: a row is");
    FILE_IS("400 1\n500 2 3\n", D_BAD_SPECTRUM, ":2:1: error: a row is");
    FILE_IS("400 1\n  five\n", D_BAD_SPECTRUM, ":2:3: error: a row is");
    FILE_IS("400 1\n500 nan\n", D_BAD_SPECTRUM, ":2:1: error: a row is");
    FILE_IS("400 1\n500nm 2\n", D_BAD_SPECTRUM, ":2:1: error: a row is");
    FILE_IS("400 1\n500 1e999\n", D_VALUE_OUT_OF_RANGE, ":2:1: error: 'absorption' of inf at 500 nm");
    FILE_IS("400 1\n500 -2\n", D_VALUE_OUT_OF_RANGE, ":2:1: error: 'absorption' of -2 at 500 nm");
    FILE_IS("400 1\n500 2\n500 3\n", D_BAD_SPECTRUM, ":3:1: error: 500 nm does not come after 500 nm");
    FILE_IS("-400 1\n500 2\n", D_BAD_SPECTRUM, ":1:1: error: -400 nm is no wavelength");
    FILE_IS("0.4 1\n0.5 2\n", D_BAD_SPECTRUM, "hint: wavelengths are in nanometres");
    FILE_IS("400 1\n", D_BAD_SPECTRUM, "two rows or more, not 1");
    FILE_IS("", D_BAD_SPECTRUM, "two rows or more, not 0");
    FILE_IS("400 1\0\n500 2\n", D_BAD_SPECTRUM, "is no text");
}

static void wrong_rows_are_refused(void **state)
{
    (void)state;
#define REFUSED(rows, code)                                                                                            \
    fixture_refused(M "medium w { ior = 1.3 absorption = " rows " } sphere { interior = w }" V, code)
    REFUSED("spectrum([<400, 1>, <300, 1>])", D_BAD_SPECTRUM);
    REFUSED("spectrum([<400, 1>])", D_BAD_SPECTRUM);
    REFUSED("spectrum([<900, 1>, <1000, 1>])", D_BAD_SPECTRUM);
    REFUSED("spectrum([<400, 1>, <500, -1>])", D_VALUE_OUT_OF_RANGE);
    REFUSED("spectrum([<400, 1>, <500, 2>]) * -1", D_VALUE_OUT_OF_RANGE);
    REFUSED("spectrum([<400, 1>, <500, 1e300>])", D_VALUE_OUT_OF_RANGE);
    REFUSED("spectrum([<400, 1>, <500, 1e300>]) * 1e300", D_VALUE_OUT_OF_RANGE);
    REFUSED("spectrum([])", D_WRONG_TYPE);
    REFUSED("spectrum([1, 2])", D_WRONG_TYPE);
    REFUSED("spectrum(400)", D_WRONG_TYPE);
    REFUSED("spectrum([<400, 1>, <500, 2>]) + 1", D_WRONG_TYPE);
    REFUSED("spectrum([<400, 1>, <500, 2>]) / 0", D_BAD_NUMBER);
    REFUSED("2 / spectrum([<400, 1>, <500, 2>])", D_WRONG_TYPE);
    REFUSED("2 * cauchy(1, 2)", D_WRONG_TYPE);
    REFUSED("spectrum(\"no-such-file.txt\")", D_FILE_NOT_FOUND);
    REFUSED("spectrum(\"/tmp\")", D_FILE_UNREADABLE);
    fixture_refused(M "medium w { ior = spectrum([<400, 1>, <500, 12>]) } sphere "
                      "{ interior = w }" V,
                    D_VALUE_OUT_OF_RANGE);
    fixture_refused(M "light { shape = sphere radius = 1 color = -1 * blackbody(3000K) }" V, D_VALUE_OUT_OF_RANGE);
    fixture_refused(M "light { shape = sphere radius = 1 color = 1e40 * "
                      "spectrum([<400, 1>, <500, 2>]) }" V,
                    D_VALUE_OUT_OF_RANGE);
    fixture_refused(M "light { shape = sphere radius = 1 color = cauchy(1, 2) }" V, D_WRONG_TYPE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_in_place_are_linear_in_between),
        cmocka_unit_test(fine_rows_keep_their_area),
        cmocka_unit_test(lights_are_as_bright_as_white),
        cmocka_unit_test(files_have_two_columns),
        cmocka_unit_test(wrong_rows_are_refused),
    };
    return cmocka_run_group_tests_name("measured", tests, NULL, NULL);
}
