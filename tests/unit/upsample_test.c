/* upsample_test.c - colours to spectra and back.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "dice.h"
#include "exact_color.h"
#include "near.h"
#include "optics/color.h"
#include "optics/upsample_solve.h"

static double largest_error(const double a[3], const double b[3])
{
    return fmax(fabs(a[0] - b[0]), fmax(fabs(a[1] - b[1]), fabs(a[2] - b[2])));
}

/* The colour of a reflectance under white. */
static void color_of_reflectance(const Spectrum *reflectance, double rgb[3])
{
    for (int c = 0; c < 3; c++) rgb[c] = 0;
    for (int node = 0; node < OBSERVER_NODES; node++) {
        double weight[3];
        float nm = (float)observer_node(node);
        observer_node_rgb(node, weight);
        double light = (double)(spectrum_at_one(reflectance, nm) * lanes_get(white_at(lanes_all(nm)), 0));
        for (int c = 0; c < 3; c++) rgb[c] += weight[c] * light;
    }
}

static void reflectances_come_back(void **unused)
{
    (void)unused;
    Dice dice = {1};
    double worst = 0, sum = 0;
    enum { N = 3000 };
    for (int i = 0; i < N; i++) {
        double rgb[3], back[3];
        for (int c = 0; c < 3; c++) rgb[c] = dice_unit(&dice);
        if (i % 3 == 1) rgb[i / 3 % 3] = 0; /* the faces, edges and corners of the cube as well */
        if (i % 3 == 2) rgb[i / 3 % 3] = 1;
        if (i % 9 == 5) rgb[(i / 3 + 1) % 3] = 0;
        if (i < 27)
            for (int c = 0; c < 3; c++) rgb[c] = 0.5 * (i / (c == 0 ? 1 : c == 1 ? 3 : 9) % 3);
        Spectrum spectrum = spectrum_from_reflectance(rgb);
        color_of_reflectance(&spectrum, back);
        double error = largest_error(rgb, back);
        worst = fmax(worst, error);
        sum += error * error;
        for (float nm = 360; nm <= 830; nm += 7) {
            float value = spectrum_at_one(&spectrum, nm);
            assert_true(value >= 0 && value <= 1);
        }
    }
    printf("solved: largest error %.2g, root mean square %.2g\n", worst, sqrt(sum / N));
    assert_true(worst < 1e-5);
}

/* From the table, from nothing, and from where the sigmoid is flat and leads nowhere. */
static void starts_do_not_matter(void **unused)
{
    (void)unused;
    Dice dice = {2};
    UpsampleSolver solver;
    upsample_solver_init(&solver);
    for (int i = 0; i < 500; i++) {
        double rgb[3], from[3][3] = {{0}, {0}, {9e3, 0, 0}};
        float near[3];
        for (int c = 0; c < 3; c++) rgb[c] = dice_unit(&dice);
        upsample_coefficients((const float[3]){(float)rgb[0], (float)rgb[1], (float)rgb[2]}, near);
        for (int c = 0; c < 3; c++) from[1][c] = (double)near[c];
        assert_true(upsample_solve(&solver, rgb, from[0]) < 1e-7);
        for (int k = 1; k < 3; k++) {
            assert_true(upsample_solve_near(&solver, rgb, from[k]) < 1e-7);
            for (int c = 0; c < 3; c++) assert_near(from[k][c], from[0][c], 1e-4 * (1 + fabs(from[0][c])));
        }
    }
}

static void greys_are_constant(void **unused)
{
    (void)unused;
    for (int i = 0; i <= 100; i++) {
        double value = i / 100.0;
        Spectrum spectrum = spectrum_from_reflectance((const double[3]){value, value, value});
        assert_true(spectrum_is_constant(&spectrum));
        assert_true(spectrum_at_one(&spectrum, 500) == (float)value);
        assert_true(spectrum_is_zero(&spectrum) == (i == 0));
    }
    /* what lies outside is clamped */
    Spectrum spectrum = spectrum_from_reflectance((const double[3]){2, 1.5, 7});
    assert_true(spectrum_is_constant(&spectrum) && spectrum_at_one(&spectrum, 500) == 1);
    spectrum = spectrum_from_reflectance((const double[3]){-1, -2, 0});
    assert_true(spectrum_is_zero(&spectrum));
}

static void lights_come_back(void **unused)
{
    (void)unused;
    Dice dice = {2};
    double worst = 0;
    for (int i = 0; i < 2000; i++) {
        double rgb[3], back[3], size = pow(10, 12 * dice_unit(&dice) - 6), largest = 0;
        for (int c = 0; c < 3; c++) rgb[c] = size * (i % 4 == 1 && c == i / 4 % 3 ? 0 : dice_unit(&dice));
        if (i % 4 == 2) rgb[0] = rgb[1] = 0;
        for (int c = 0; c < 3; c++) largest = fmax(largest, rgb[c]);
        Spectrum light = spectrum_from_light(rgb);
        color_from_spectrum(&light, back);
        worst = fmax(worst, largest_error(rgb, back) / largest);
    }
    printf("lights: largest error relative to the largest channel %.2g\n", worst);
    assert_true(worst < 1e-5);
    /* grey lights are white times a number, exactly, and none is none */
    Spectrum light = spectrum_from_light((const double[3]){4, 4, 4});
    for (float nm = 360; nm <= 830; nm += 0.37f)
        assert_true(spectrum_at_one(&light, nm) == 4 * lanes_get(white_at(lanes_all(nm)), 0));
    light = spectrum_from_light((const double[3]){0, 0, 0});
    assert_true(spectrum_is_zero(&light) && spectrum_is_constant(&light));
}

static double table_error(const double rgb[3])
{
    const float single[3] = {(float)rgb[0], (float)rgb[1], (float)rgb[2]};
    Spectrum spectrum = {.kind = SPECTRUM_SIGMOID, .scale = 1};
    double back[3];
    upsample_coefficients(single, spectrum.value);
    for (int i = 0; i < 3; i++) assert_true(isfinite(spectrum.value[i]));
    color_of_reflectance(&spectrum, back);
    return largest_error(rgb, back);
}

static void table_comes_back(void **unused)
{
    (void)unused;
    Dice dice = {3};
    double worst = 0, sum = 0, worst_scaled = 0;
    enum { N = 40000 };
    for (int i = 0; i < N; i++) {
        double rgb[3], power = i % 2 ? 1 : 2.2; /* as many dark colours as light ones */
        for (int c = 0; c < 3; c++) rgb[c] = 0.001 + 0.998 * pow(dice_unit(&dice), power);
        double error = table_error(rgb);
        worst = fmax(worst, error);
        sum += error * error;
        /* the largest channel at 1/2, as for environments */
        double largest = fmax(rgb[0], fmax(rgb[1], rgb[2]));
        for (int c = 0; c < 3; c++) rgb[c] *= 0.5 / largest;
        worst_scaled = fmax(worst_scaled, 2 * table_error(rgb));
    }
    printf("table: largest error %.2g, root mean square %.2g; lights %.2g of their largest channel\n", worst,
           sqrt(sum / N), worst_scaled);
    assert_true(worst < 0.002);
    assert_true(worst_scaled < 0.002);
    /* the surface of the cube */
    worst = 0;
    for (int i = 0; i < 125; i++) {
        const double rgb[3] = {i % 5 / 4.0, i / 5 % 5 / 4.0, i / 25 / 4.0};
        worst = fmax(worst, table_error(rgb));
    }
    printf("table at the cube's surface: %.2g\n", worst);
    assert_true(worst < 0.005);
    /* grey: constant, and exact where that can be said */
    for (int i = 0; i <= 100; i++) {
        float value = (float)i / 100, coefficients[3];
        upsample_coefficients((const float[3]){value, value, value}, coefficients);
        Lanes found = upsample_at(coefficients, lanes(360, 500, 600, 830));
        assert_true(lanes_uniform(found));
        assert_float_equal(lanes_get(found, 0), value, 1e-6f);
        if (i == 100) assert_true(lanes_get(found, 0) == 1);
    }
    /* nonsense does no harm */
    float coefficients[3];
    upsample_coefficients((const float[3]){NAN, -1, 7}, coefficients);
    assert_true(isfinite(coefficients[0]) && isfinite(coefficients[1]) && isfinite(coefficients[2]));
}

/* Neighbouring colours have neighbouring spectra, also where the largest channel changes. */
static void table_has_no_seams(void **unused)
{
    (void)unused;
    Dice dice = {4};
    float worst = 0;
    for (int i = 0; i < 20000; i++) {
        float a[3], b[3];
        for (int c = 0; c < 3; c++) a[c] = b[c] = 0.05f + 0.9f * (float)dice_unit(&dice);
        a[1] = a[0];
        b[1] = a[0] * 1.0001f;
        float first[3], second[3];
        upsample_coefficients(a, first);
        upsample_coefficients(b, second);
        Lanes nm = lanes(430, 510, 570, 650), difference = lanes_sub(upsample_at(first, nm), upsample_at(second, nm));
        worst = fmaxf(worst, fmaxf(lanes_max(difference), -lanes_min(difference)));
    }
    printf("across a seam: %.2g\n", (double)worst);
    assert_true(worst < 0.02f);
}

/* The colour of white light after a length of an absorbing medium, integrated finely. */
static void color_through(const Spectrum *absorption, double length, double rgb[3])
{
    enum { STEPS = 4700 };
    for (int c = 0; c < 3; c++) rgb[c] = 0;
    for (int i = 0; i < STEPS; i++) {
        float xyz[3], nm = 360 + ((float)i + 0.5f) * 470 / STEPS;
        color_matching(nm, xyz);
        double light =
            exp(-length * (double)spectrum_at_one(absorption, nm)) * (double)lanes_get(white_at(lanes_all(nm)), 0);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) rgb[c] += observer_rgb_from_xyz[c][k] * (double)xyz[k] * light * 470 / STEPS;
    }
}

static void tints_tint(void **unused)
{
    (void)unused;
    const double tints[][3] = {{0.85, 0.42, 0.08}, {0.92, 0.97, 0.95}, {0.80, 0.95, 0.88}, {0.96, 0.90, 0.78},
                               {1, 0.5, 0.25},     {0.3, 0.3, 0.9},    {0.5, 0.5, 0.5},    {1, 1, 1}};
    float table[SPECTRUM_SAMPLES];
    double worst = 0;
    for (size_t i = 0; i < 8; i++) {
        Spectrum absorption = spectrum_from_tint(tints[i], 12, table);
        double rgb[3];
        color_through(&absorption, 12, rgb);
        worst = fmax(worst, largest_error(rgb, tints[i]));
        for (float nm = 360; nm <= 830; nm += 5) assert_true(spectrum_at_one(&absorption, nm) >= 0);
    }
    printf("tints: largest error %.2g\n", worst);
    assert_true(worst < 1e-3);
    Spectrum clear = spectrum_from_tint((const double[3]){1, 1, 1}, 12, table);
    assert_true(spectrum_is_zero(&clear));
    Spectrum grey = spectrum_from_tint((const double[3]){0.5, 0.5, 0.5}, 2, table);
    assert_true(spectrum_is_constant(&grey));
    assert_float_equal(spectrum_at_one(&grey, 500), (float)(log(2) / 2), 1e-7f);
    /* black and pure colours stay finite */
    const double extreme[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}};
    for (size_t i = 0; i < 7; i++) {
        Spectrum absorption = spectrum_from_tint(extreme[i], 1, table);
        float largest = spectrum_max(&absorption);
        assert_true(isfinite(largest) && largest > 1);
    }
}

static void coefficients_absorb(void **unused)
{
    (void)unused;
    const double media[][3] = {{0.40, 0.08, 0.03}, {0.35, 0.07, 0.02}, {0.02, 0.025, 0.03},
                               {300, 200, 100},    {1, 0, 0},          {0, 0.5, 1}};
    float table[SPECTRUM_SAMPLES];
    double worst = 0;
    for (size_t i = 0; i < 6; i++) {
        Spectrum absorption = spectrum_from_coefficients(media[i], table);
        double largest = fmax(media[i][0], fmax(media[i][1], media[i][2]));
        for (float nm = 360; nm <= 830; nm += 5) assert_true(spectrum_at_one(&absorption, nm) >= 0);
        for (double depth = 0.05; depth < 1.5; depth *= 2) {
            double length = depth / largest, rgb[3], expected[3];
            for (int c = 0; c < 3; c++) expected[c] = exp(-media[i][c] * length);
            color_through(&absorption, length, rgb);
            worst = fmax(worst, largest_error(rgb, expected));
        }
    }
    printf("Beer-Lambert in three channels against spectra, optical depth 0.05 to 0.8: %.2g\n", worst);
    assert_true(worst < 0.1);
    Spectrum grey = spectrum_from_coefficients((const double[3]){0.25, 0.25, 0.25}, table);
    assert_true(spectrum_is_constant(&grey) && spectrum_at_one(&grey, 700) == 0.25f);
    Spectrum none = spectrum_from_coefficients((const double[3]){0, 0, 0}, table);
    assert_true(spectrum_is_zero(&none) && spectrum_at_one(&none, 700) == 0);
}

/* CIELAB of linear Rec.709 under its own white. */
static void lab_from_rgb(const double rgb[3], double lab[3])
{
    static const double rows[3][3] = {
        {0.4123908, 0.3575843, 0.1804808}, {0.2126390, 0.7151687, 0.0721923}, {0.0193308, 0.1191948, 0.9505322}};
    double f[3];
    for (int k = 0; k < 3; k++) {
        double white = rows[k][0] + rows[k][1] + rows[k][2];
        double t = (rows[k][0] * rgb[0] + rows[k][1] * rgb[1] + rows[k][2] * rgb[2]) / white;
        f[k] = t > 216.0 / 24389 ? cbrt(t) : (24389.0 / 27 * t + 16) / 116;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 500 * (f[0] - f[1]);
    lab[2] = 200 * (f[1] - f[2]);
}

/* A grid of sRGB colours to spectra and back under white: no shift that could be seen (1 is just so), for surfaces, whose
 * spectra are solved, and for pixels, whose spectra come from the table. */
static void no_colour_shifts(void **unused)
{
    (void)unused;
    enum { STEPS = 9 };
    double worst[2] = {0, 0}, sum[2] = {0, 0};
    for (int i = 0; i < STEPS * STEPS * STEPS; i++) {
        const int at[3] = {i % STEPS, i / STEPS % STEPS, i / STEPS / STEPS};
        double rgb[3], lab[3];
        for (int c = 0; c < 3; c++) {
            double code = (double)at[c] / (STEPS - 1);
            rgb[c] = code <= 0.04045 ? code / 12.92 : pow((code + 0.055) / 1.055, 2.4);
        }
        lab_from_rgb(rgb, lab);
        for (int way = 0; way < 2; way++) {
            double back[3], back_lab[3];
            Spectrum spectrum = spectrum_from_reflectance(rgb);
            if (way == 1) {
                spectrum = (Spectrum){.kind = SPECTRUM_SIGMOID, .scale = 1};
                upsample_coefficients((const float[3]){(float)rgb[0], (float)rgb[1], (float)rgb[2]}, spectrum.value);
            }
            color_of_reflectance(&spectrum, back);
            lab_from_rgb(back, back_lab);
            double difference = hypot(hypot(lab[0] - back_lab[0], lab[1] - back_lab[1]), lab[2] - back_lab[2]);
            worst[way] = fmax(worst[way], difference);
            sum[way] += difference / (STEPS * STEPS * STEPS);
        }
    }
    printf("sRGB and back: colour difference in CIELAB at most %.4f, mean %.5f; by the table %.3f, mean %.4f\n",
           worst[0], sum[0], worst[1], sum[1]);
    assert_true(worst[0] < 0.05);
    assert_true(worst[1] < 1 && sum[1] < 0.1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(starts_do_not_matter), cmocka_unit_test(reflectances_come_back),
        cmocka_unit_test(greys_are_constant),   cmocka_unit_test(lights_come_back),
        cmocka_unit_test(table_comes_back),     cmocka_unit_test(table_has_no_seams),
        cmocka_unit_test(tints_tint),           cmocka_unit_test(coefficients_absorb),
        cmocka_unit_test(no_colour_shifts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
