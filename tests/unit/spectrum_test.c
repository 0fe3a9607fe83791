/* spectrum_test.c - every kind of spectrum at its known values.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/luminance.h"
#include "exact_color.h"
#include "optics/color.h"
#include "optics/spectrum.h"

static void constants(void **unused)
{
    (void)unused;
    Spectrum half = spectrum_constant(0.5f), zero = spectrum_constant(0);
    assert_true(spectrum_is_constant(&half) && !spectrum_is_zero(&half));
    assert_true(spectrum_is_constant(&zero) && spectrum_is_zero(&zero));
    Lanes value = spectrum_at(&half, lanes(360, 500, 700, 830));
    assert_true(lanes_uniform(value) && lanes_get(value, 0) == 0.5f);
    assert_float_equal(spectrum_max(&half), 0.5f, 0);
    half.scale = 3;
    assert_float_equal(spectrum_at_one(&half, 500), 1.5f, 0);
}

/* Schott's data sheet of N-BK7: Sellmeier's coefficients and the indices at the Fraunhofer lines. */
static void sellmeier_is_the_data_sheet(void **unused)
{
    (void)unused;
    const double b[3] = {1.03961212, 0.231792344, 1.01046945}, c[3] = {0.00600069867, 0.0200179144, 103.560653};
    Spectrum glass = spectrum_sellmeier(b, c);
    assert_float_equal(spectrum_at_one(&glass, 587.5618f), 1.51680f, 5e-6f); /* d */
    assert_float_equal(spectrum_at_one(&glass, 486.1327f), 1.52238f, 5e-6f); /* F */
    assert_float_equal(spectrum_at_one(&glass, 656.2725f), 1.51432f, 5e-6f); /* C */
    assert_false(spectrum_is_constant(&glass) || spectrum_is_zero(&glass));
    assert_float_equal(spectrum_max(&glass), spectrum_at_one(&glass, 360), 0);
    const double none[3] = {0, 0, 0};
    Spectrum vacuum = spectrum_sellmeier(none, none);
    assert_true(spectrum_is_constant(&vacuum));
    assert_float_equal(spectrum_at_one(&vacuum, 500), 1, 0);
}

static void cauchy(void **unused)
{
    (void)unused;
    Spectrum water = spectrum_cauchy(1.3239, 3.1e-3, 2e-5);
    for (double nm = 360; nm <= 830; nm += 10) {
        double um = nm * 1e-3;
        float expected = (float)(1.3239 + 3.1e-3 / (um * um) + 2e-5 / (um * um * um * um));
        assert_float_equal(spectrum_at_one(&water, (float)nm), expected, 3e-7f);
    }
    Spectrum flat = spectrum_cauchy(1.5, 0, 0);
    assert_true(spectrum_is_constant(&flat) && !spectrum_is_constant(&water));
    assert_float_equal(spectrum_at_one(&flat, 400), 1.5f, 0);
}

static double ramp(void *context, double wavelength_nm)
{
    return *(const double *)context * (wavelength_nm - 360);
}

static void tables_are_linear_in_between(void **unused)
{
    (void)unused;
    float table[SPECTRUM_SAMPLES];
    double slope = 0.01;
    Spectrum spectrum = spectrum_tabulate(ramp, &slope, table);
    for (float nm = 360; nm <= 830; nm += 0.25f)
        assert_float_equal(spectrum_at_one(&spectrum, nm), 0.01f * (nm - 360), 2e-6f);
    assert_float_equal(spectrum_at_one(&spectrum, 830), 4.7f, 0);
    assert_float_equal(spectrum_max(&spectrum), 4.7f, 0);
    assert_false(spectrum_is_constant(&spectrum));
    /* outside, the ends */
    assert_float_equal(spectrum_at_one(&spectrum, 100), 0, 0);
    assert_float_equal(spectrum_at_one(&spectrum, 1e6f), 4.7f, 0);
    assert_float_equal(spectrum_at_one(&spectrum, NAN), 0, 0);
    slope = 0;
    spectrum = spectrum_tabulate(ramp, &slope, table);
    assert_true(spectrum_is_constant(&spectrum) && spectrum_is_zero(&spectrum));
}

static void blackbody_is_plancks(void **unused)
{
    (void)unused;
    float table[SPECTRUM_SAMPLES];
    const double kelvins[] = {1, 300, 1000, 2700, 5600, 6504, 20000, 1e6};
    for (size_t i = 0; i < 8; i++) {
        double kelvin = kelvins[i];
        Spectrum light = spectrum_blackbody(kelvin, table);
        for (int k = 0; k < SPECTRUM_SAMPLES; k++) assert_true(isfinite(table[k]) && table[k] >= 0);
        assert_float_equal((float)spectrum_luminance(&light), 1, 1e-5f);
        if (kelvin < 1000) continue;
        double expected =
            pow(600.0 / 500, 5) * expm1(1.438776877e7 / (600 * kelvin)) / expm1(1.438776877e7 / (500 * kelvin));
        double found = (double)spectrum_at_one(&light, 500) / (double)spectrum_at_one(&light, 600);
        assert_float_equal((float)(found / expected), 1, 2e-6f);
        double rgb[3];
        color_from_spectrum(&light, rgb);
        float luminance = color_luminance((const float[3]){(float)rgb[0], (float)rgb[1], (float)rgb[2]});
        assert_float_equal(luminance, 1, 1e-3f); /* its three weights are rounded */
        if (kelvin < 6000) assert_true(rgb[0] > rgb[1] && rgb[1] > rgb[2]);
        if (kelvin > 7000) assert_true(rgb[0] < rgb[1] && rgb[1] < rgb[2]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constants),
        cmocka_unit_test(sellmeier_is_the_data_sheet),
        cmocka_unit_test(cauchy),
        cmocka_unit_test(tables_are_linear_in_between),
        cmocka_unit_test(blackbody_is_plancks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
