/* color_test.c - the standard data, what is derived from it, and colours from sampled wavelengths.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "base/luminance.h"
#include "dice.h"
#include "exact_color.h"
#include "near.h"
#include "optics/spectral_lines.h"
#include "optics/observer.h"
#include "optics/white_balance.h"

static void observer_adds_up(void **unused)
{
    (void)unused;
    double whole[3] = {0}, short_range[3] = {0};
    for (int nm = 360; nm <= 830; nm += 5) {
        float xyz[3];
        color_matching((float)nm, xyz);
        for (int k = 0; k < 3; k++) {
            whole[k] += (double)xyz[k];
            if (nm >= 380 && nm <= 780) short_range[k] += (double)xyz[k];
        }
        assert_true(xyz[1] < 1 || nm == 555);
    }
    /* The standard's sums: a fifth of those at 1 nm (106.865, 106.857, 106.892) over the whole range, and
     * those of CIE 15's 5 nm table over 380 to 780 nm. */
    assert_float_equal((float)whole[0], 21.3731f, 1e-3f);
    assert_float_equal((float)whole[1], 21.3714f, 1e-3f);
    assert_float_equal((float)whole[2], 21.3785f, 1e-3f);
    assert_float_equal((float)short_range[0], 21.3714f, 1e-3f);
    assert_float_equal((float)short_range[1], 21.3711f, 1e-3f);
    assert_float_equal((float)short_range[2], 21.3715f, 1e-3f);
    float xyz[3];
    color_matching(555, xyz);
    assert_float_equal(xyz[1], 1, 0);
    color_matching(602.5f, xyz); /* half way between 1.0622, 0.631 at 600 and 1.0456, 0.5668 at 605 */
    assert_float_equal(xyz[0], 1.0539f, 1e-6f);
    assert_float_equal(xyz[1], 0.5989f, 1e-6f);
}

/* The integral of tables that are linear in between, of the product of two. */
static double integral(const double *a, const double *b)
{
    double sum = 0;
    for (int i = 0; i + 1 < SPECTRUM_SAMPLES; i++)
        sum += (2 * a[i] * b[i] + a[i] * b[i + 1] + a[i + 1] * b[i] + 2 * a[i + 1] * b[i + 1]) * SPECTRUM_STEP_NM / 6;
    return sum;
}

/* OBSERVER_WHITE_SCALE and observer_rgb_from_xyz from the data and Rec.709's primaries. */
static void matrix_follows_from_the_data(void **unused)
{
    (void)unused;
    double xyz[3][SPECTRUM_SAMPLES], white[SPECTRUM_SAMPLES], one[SPECTRUM_SAMPLES];
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        for (int k = 0; k < 3; k++) xyz[k][i] = (double)observer_xyz[i][k];
        white[i] = 0.5 * ((double)observer_d65[i / 2] + (double)observer_d65[(i + 1) / 2]);
        one[i] = 1;
    }
    double luminance = integral(xyz[1], one);
    assert_true(fabs(luminance / integral(xyz[1], white) / OBSERVER_WHITE_SCALE - 1) < 1e-12);

    double sums[3];
    for (int k = 0; k < 3; k++) sums[k] = OBSERVER_WHITE_SCALE * integral(xyz[k], white);
    double x = sums[0] / (sums[0] + sums[1] + sums[2]), y = sums[1] / (sums[0] + sums[1] + sums[2]);
    assert_float_equal((float)x, 0.3127f, 5e-5f);
    assert_float_equal((float)y, 0.3290f, 5e-5f);
    const double primary[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
    for (int row = 0; row < 3; row++) {
        double white_row = 0;
        for (int k = 0; k < 3; k++) white_row += observer_rgb_from_xyz[row][k] * sums[k];
        assert_true(fabs(white_row - 1) < 1e-12);
        /* light of a primary's chromaticity has none of the two others */
        for (int p = 0; p < 3; p++) {
            double px = primary[p][0], py = primary[p][1];
            double value = observer_rgb_from_xyz[row][0] * px + observer_rgb_from_xyz[row][1] * py +
                           observer_rgb_from_xyz[row][2] * (1 - px - py);
            assert_true(row == p ? value > 0 : fabs(value) < 1e-15);
        }
    }
}

static void wavelengths_cover_the_range(void **unused)
{
    (void)unused;
    /* in order, end to end, so each density is above zero */
    assert_float_equal(observer_wavelengths[0], SPECTRUM_MIN_NM, 0);
    assert_float_equal(observer_wavelengths[OBSERVER_WAVELENGTH_CELLS], SPECTRUM_MAX_NM, 0);
    for (int i = 0; i < OBSERVER_WAVELENGTH_CELLS; i++)
        assert_true(observer_wavelengths[i] < observer_wavelengths[i + 1]);

    double mass = 0;
    float before = SPECTRUM_MIN_NM;
    enum { STEPS = 1 << 16 };
    for (int i = 0; i < STEPS; i++) {
        float u = ((float)i + 0.5f) / STEPS;
        WavelengthSample sample = wavelengths_sample(u);
        for (int k = 0; k < LANES; k++) {
            float nm = lanes_get(sample.nm, k), pdf = lanes_get(sample.pdf, k);
            assert_true(nm >= SPECTRUM_MIN_NM && nm <= SPECTRUM_MAX_NM && pdf > 0 && isfinite(pdf));
            /* the other lanes are what the first would be a quarter further */
            WavelengthSample turned = wavelengths_sample(u + 0.25f * (float)k - (u + 0.25f * (float)k >= 1 ? 1 : 0));
            assert_float_equal(lanes_get(turned.nm, 0), nm, 1e-3f);
        }
        float nm = lanes_get(sample.nm, 0);
        assert_true(nm >= before);
        mass += (double)(nm - before) * (double)lanes_get(sample.pdf, 0);
        before = nm;
    }
    assert_float_equal((float)mass, 1, 1e-4f);
    assert_float_equal(lanes_get(wavelengths_sample(0).nm, 0), SPECTRUM_MIN_NM, 0);
    assert_true(lanes_get(wavelengths_sample(0x1.fffffep-1f).nm, 0) <= SPECTRUM_MAX_NM);
}

typedef struct Moments {
    double mean[3], deviation[3];
} Moments;

/* Over all u. hero: only the first lane carries radiance, four times over, as after dispersion. lines: NULL, or whose wavelengths. */
static Moments moments_by(const WavelengthLines *lines, const Spectrum *light, bool hero)
{
    Moments moments = {{0}, {0}};
    enum { STEPS = 1 << 18 };
    for (int i = 0; i < STEPS; i++) {
        float rgb[3];
        float u = ((float)i + 0.5f) / STEPS;
        WavelengthSample wavelengths = lines ? wavelength_lines_sample(lines, u) : wavelengths_sample(u);
        Lanes radiance = spectrum_at(light, wavelengths.nm);
        if (hero) radiance = lanes(LANES * lanes_get(radiance, 0), 0, 0, 0);
        color_from_lanes(radiance, &wavelengths, rgb);
        for (int c = 0; c < 3; c++) {
            moments.mean[c] += (double)rgb[c] / STEPS;
            moments.deviation[c] += (double)rgb[c] * (double)rgb[c] / STEPS;
        }
    }
    for (int c = 0; c < 3; c++) moments.deviation[c] = sqrt(moments.deviation[c] - moments.mean[c] * moments.mean[c]);
    return moments;
}

static Moments moments_of(const Spectrum *light, bool hero)
{
    return moments_by(NULL, light, hero);
}

static void white_is_white(void **unused)
{
    (void)unused;
    Spectrum white = spectrum_from_light((const double[3]){1, 1, 1});
    double rgb[3];
    color_from_spectrum(&white, rgb);
    Moments four = moments_of(&white, false), one = moments_of(&white, true);
    for (int c = 0; c < 3; c++) {
        assert_float_equal((float)rgb[c], 1, 1e-6f);
        assert_float_equal((float)four.mean[c], 1, 1e-5f);
        assert_float_equal((float)one.mean[c], 1, 1e-4f);
    }
    printf("white per path: deviation %.3f %.3f %.3f; one wavelength alone: %.2f %.2f %.2f\n", four.deviation[0],
           four.deviation[1], four.deviation[2], one.deviation[0], one.deviation[1], one.deviation[2]);
    /* what color.c claims; uniform wavelengths give 0.77 0.41 0.81 */
    for (int c = 0; c < 3; c++) assert_true(four.deviation[c] < 0.03 && one.deviation[c] < 3);
    /* to the last bit, whatever the wavelengths */
    for (float nm = 360; nm <= 830; nm += 0.37f) {
        Lanes at = lanes_all(nm);
        assert_true(lanes_zero(lanes_sub(spectrum_at(&white, at), white_at(at))));
    }
    assert_float_equal((float)spectrum_luminance(&white), 1, 1e-6f);
    Spectrum flat = spectrum_constant(1);
    assert_float_equal((float)spectrum_luminance(&flat), 1, 1e-6f);
}

static void sampling_is_unbiased(void **unused)
{
    (void)unused;
    uint32_t state = 1;
    float table[SPECTRUM_SAMPLES];
    for (int trial = 0; trial < 8; trial++) {
        for (int i = 0; i < SPECTRUM_SAMPLES; i++) table[i] = hash_to_unit_f(hash_u32(state++));
        Spectrum light = {.kind = SPECTRUM_TABLE, .scale = 2, .table = table};
        double exact[3];
        color_from_spectrum(&light, exact);
        Moments four = moments_of(&light, false), one = moments_of(&light, true);
        for (int c = 0; c < 3; c++) {
            assert_float_equal((float)four.mean[c], (float)exact[c], 1e-4f);
            assert_float_equal((float)one.mean[c], (float)exact[c], 1e-4f);
        }
    }
}

/* The lamp of sodium, and two lasers. */
static const double sodium_rows[] = {588.9, 0, 589, 1, 589.1, 0, 589.5, 0, 589.6, .5, 589.7, 0};
static const double laser_rows[] = {450, 0, 452, 1, 454, 0, 530, 0, 532, 2, 534, 0};

static double worst_of(const double deviation[3], const double mean[3])
{
    double size = fmax(fmax(fabs(mean[0]), fabs(mean[1])), fabs(mean[2]));
    return fmax(fmax(deviation[0], deviation[1]), deviation[2]) / size;
}

static bool is_lines(const Spectrum *light)
{
    Error error;
    bool lines;
    assert_int_equal(spectrum_find_lines(light, &lines, &error), STATUS_OK);
    return lines;
}

static void lines_are_told_apart(void **unused)
{
    (void)unused;
    float sodium[SPECTRUM_SAMPLES], lasers[SPECTRUM_SAMPLES], glow[SPECTRUM_SAMPLES];
    Spectrum lines[] = {spectrum_from_rows(sodium_rows, COUNT_OF(sodium_rows) / 2, sodium),
                        spectrum_from_rows(laser_rows, COUNT_OF(laser_rows) / 2, lasers)};
    for (size_t i = 0; i < COUNT_OF(lines); i++) assert_true(is_lines(&lines[i]));
    static const double colors[][3] = {{1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, .2, .05}, {0, 0, 0}};
    for (size_t i = 0; i < COUNT_OF(colors); i++) {
        Spectrum light = spectrum_from_light(colors[i]);
        assert_false(is_lines(&light));
    }
    Spectrum candle = spectrum_blackbody(1800, glow), flat = spectrum_constant(1);
    assert_false(is_lines(&candle));
    assert_false(is_lines(&flat));
    const LightOfScene none[] = {{&candle, 1}, {&flat, 2}, {NULL, 3}, {&lines[0], 0.05}, {&lines[1], 0}};
    WavelengthLines *found;
    Error error;
    assert_int_equal(wavelength_lines_new(none, COUNT_OF(none), &found, &error), STATUS_OK);
    assert_null(found);
    wavelength_lines_free(found);
}

/* With lanes for lines, alone and beside a white light: of each light the same is found as without, of the lines with a part of
 * the noise, and of the others with not much more. */
static void lines_are_found(void **unused)
{
    (void)unused;
    float sodium[SPECTRUM_SAMPLES], lasers[SPECTRUM_SAMPLES], random[SPECTRUM_SAMPLES];
    for (uint32_t i = 0; i < SPECTRUM_SAMPLES; i++) random[i] = hash_to_unit_f(hash_u32(i + 77));
    const Spectrum white = spectrum_from_light((const double[3]){1, 1, 1});
    const Spectrum lights[] = {spectrum_from_rows(sodium_rows, COUNT_OF(sodium_rows) / 2, sodium),
                               spectrum_from_rows(laser_rows, COUNT_OF(laser_rows) / 2, lasers),
                               white,
                               {.kind = SPECTRUM_TABLE, .scale = 2, .table = random}};
    for (int others = 0; others < 2; others++) {
        Error error;
        WavelengthLines *lines;
        const LightOfScene list[] = {{&lights[0], 0.1}, {&lights[1], 0.02}, {&white, 1}};
        assert_int_equal(wavelength_lines_new(list, 2 + (size_t)others, &lines, &error), STATUS_OK);
        assert_non_null(lines);
        for (size_t i = 0; i < COUNT_OF(lights); i++) {
            double exact[3], size = 0;
            color_from_spectrum(&lights[i], exact);
            for (int c = 0; c < 3; c++) size = fmax(size, fabs(exact[c]));
            Moments four = moments_by(lines, &lights[i], false), one = moments_by(lines, &lights[i], true);
            Moments before = moments_by(NULL, &lights[i], false);
            double noise = worst_of(four.deviation, exact), noise_before = worst_of(before.deviation, exact);
            for (int c = 0; c < 3; c++) {
                assert_near(four.mean[c] / size, exact[c] / size, 2e-4);
                assert_near(one.mean[c] / size, exact[c] / size, 2e-3);
            }
            printf("light %zu%s: deviation %.3f, %.3f without lanes for lines\n", i, others ? " beside white" : "",
                   noise, noise_before);
            if (i < 2)
                assert_true(noise < (others ? 0.65 : 0.36) * noise_before);
            else
                assert_true(noise < (others ? 0.75 : 3));
        }
        wavelength_lines_free(lines);
    }
}

/* Mean and deviation of the wavelengths that a light is found at, weighed by what it brings there, and the sum of that. */
typedef struct Found {
    double sum, mean, deviation, least, most;
} Found;

static Found found_of(const WavelengthLines *lines, const Spectrum *light)
{
    enum { STEPS = 1 << 20 };
    Found f = {.least = HUGE_VAL};
    for (int i = 0; i < STEPS; i++) {
        WavelengthSample wavelengths = wavelength_lines_sample(lines, ((float)i + 0.5f) / STEPS);
        float nm = lanes_get(wavelengths.nm, 0);
        double power = (double)spectrum_at_one(light, nm) / (double)lanes_get(wavelengths.pdf, 0) / STEPS;
        f.sum += power;
        f.mean += power * (double)nm;
        f.deviation += power * ((double)nm - 589) * ((double)nm - 589);
        if (power > 0) f.least = fmin(f.least, (double)nm), f.most = fmax(f.most, (double)nm);
    }
    f.mean /= f.sum;
    f.deviation = sqrt(fmax(f.deviation / f.sum - (f.mean - 589) * (f.mean - 589), 0));
    return f;
}

/* Lines in rows are where they are, and as narrow: a hat of half width h has a deviation of h / sqrt(6). Beside white light and
 * where they bring next to nothing as well, and none of their power is lost. */
static void lines_in_rows_are_exact(void **unused)
{
    (void)unused;
    static const double places[] = {585, 587.5, 532.3, 700.01}, widths[] = {2, .1, .01};
    const Spectrum white = spectrum_from_light((const double[3]){1, 1, 1});
    static SpectrumRows kept;
    SpectrumRow room[5];
    kept.row = room;
    for (size_t i = 0; i < COUNT_OF(places) * COUNT_OF(widths); i++) {
        double at = places[i / COUNT_OF(widths)], half = widths[i % COUNT_OF(widths)];
        const double rows[] = {at - half, 0, at, 1, at + half, 0};
        assert_true(spectrum_rows_are_fine(rows, 3));
        Spectrum line = spectrum_from_fine_rows(rows, 3, &kept);
        assert_true(is_lines(&line));
        assert_float_equal(spectrum_at_one(&line, (float)at), 1, 0.01f);
        assert_float_equal(spectrum_at_one(&line, (float)(at + 1.5 * half)), 0, 0);
        float xyz[3];
        color_matching((float)at, xyz);
        if (half < 1) assert_near(spectrum_luminance(&line) * 106.857 / (half * (double)xyz[1]), 1, 1e-3);
        line.scale = (float)(1 / half); /* a power of 1 */
        for (int others = 0; others < 3; others++) {
            const LightOfScene lights[] = {{&line, others == 2 ? 1e-4 : 1}, {&white, others ? 1 : 0}};
            WavelengthLines *lines;
            Error error;
            assert_int_equal(wavelength_lines_new(lights, 2, &lines, &error), STATUS_OK);
            Found f = found_of(lines, &line);
            assert_near(f.sum, 1, others == 2 ? 0.02 : 0.005);
            assert_near(f.mean, at, 0.01 * half + 1e-4);
            assert_near(f.deviation * sqrt(6) / half, 1, 0.03);
            assert_true(f.least >= at - half - 1e-4 && f.most <= at + half + 1e-4);
            assert_near(moments_by(lines, &white, false).mean[1], 1, 2e-4);
            wavelength_lines_free(lines);
        }
    }
}

/* The two lines of sodium are apart, the second half as strong; and means, as tables keep them, have the same power. */
static void rows_keep_what_tables_mean(void **unused)
{
    (void)unused;
    static SpectrumRows kept;
    SpectrumRow room[8];
    kept.row = room;
    Spectrum sodium = spectrum_from_fine_rows(sodium_rows, COUNT_OF(sodium_rows) / 2, &kept);
    Spectrum table = spectrum_smoothed(&sodium);
    assert_int_equal(table.kind, SPECTRUM_TABLE);
    assert_near(spectrum_luminance(&sodium) / spectrum_luminance(&table), 1, 0.02);
    assert_float_equal(spectrum_at_one(&sodium, 589.0f), 1, 1e-3f);
    assert_float_equal(spectrum_at_one(&sodium, 589.3f), 0, 0);
    assert_float_equal(spectrum_at_one(&sodium, 589.6f), 0.5f, 1e-3f);
    assert_float_equal(spectrum_max(&sodium), 1, 0);
    assert_false(spectrum_is_zero(&sodium) || spectrum_is_constant(&sodium) || spectrum_same(&sodium, &table));
    assert_true(spectrum_same(&sodium, &sodium));
    /* a step between two floats stays one, and values go on beyond the ends */
    const double step[] = {500, 3, 600, 3, 600.000001, 1, 700, 2};
    Spectrum stepped = spectrum_from_fine_rows(step, 4, &kept);
    assert_float_equal(spectrum_at_one(&stepped, 380), 3, 0);
    assert_float_equal(spectrum_at_one(&stepped, 599.9f), 3, 1e-6f);
    assert_float_equal(spectrum_at_one(&stepped, 600.1f), 1.001f, 1e-5f);
    assert_float_equal(spectrum_at_one(&stepped, 830), 2, 0);
}

static void luminance_weighs(void **unused)
{
    (void)unused;
    assert_float_equal(color_luminance((const float[3]){1, 1, 1}), 1, 1e-6f);
    assert_float_equal(color_luminance((const float[3]){0, 1, 0}), 0.7152f, 1e-6f);
}

/* Chromaticities of single wavelengths as they are published: ISO/CIE 11664-1, table 1. */
static void spectral_locus(void **unused)
{
    (void)unused;
    static const double rows[][3] = {{400, 0.1733, 0.0048}, {440, 0.1644, 0.0109}, {460, 0.1440, 0.0297},
                                     {480, 0.0913, 0.1327}, {500, 0.0082, 0.5384}, {520, 0.0743, 0.8338},
                                     {540, 0.2296, 0.7543}, {560, 0.3731, 0.6245}, {580, 0.5125, 0.4866},
                                     {600, 0.6270, 0.3725}, {620, 0.6915, 0.3083}, {700, 0.7347, 0.2653}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        float xyz[3];
        color_matching((float)rows[i][0], xyz);
        double sum = (double)xyz[0] + (double)xyz[1] + (double)xyz[2];
        assert_float_equal((float)((double)xyz[0] / sum), (float)rows[i][1], 1.5e-4f);
        assert_float_equal((float)((double)xyz[1] / sum), (float)rows[i][2], 1.5e-4f);
    }
}

static void color_found_again(const ReflectedColor *color, const float reflectance[3], float rgb[3])
{
    float coefficients[3];
    upsample_coefficients(reflectance, coefficients);
    for (int c = 0; c < 3; c++) rgb[c] = 0;
    for (int i = 0; i < COLOR_FOURS; i++)
        for (int c = 0; c < 3; c++)
            rgb[c] += lanes_sum(lanes_mul(upsample_at(coefficients, color->nm[i]), color->weights[i][c]));
}

/* Colours that are made spectra are found in them again. */
static void reflectances_have_colors(void **unused)
{
    (void)unused;
    static const float colors[][3] = {
        {1, 1, 1}, {.6f, .6f, .6f}, {.5f, .25f, .125f}, {.02f, .6f, .1f}, {.05f, .1f, .8f}};
    ReflectedColor color;
    reflected_color_init(&color);
    for (size_t k = 0; k < COUNT_OF(colors); k++) {
        float rgb[3];
        color_found_again(&color, colors[k], rgb);
        for (int c = 0; c < 3; c++) assert_float_equal(rgb[c], colors[k][c], 0.004f); /* see upsample_coefficients */
    }
    enum { RANDOM = 2000 };
    Dice dice = {4};
    double worst = 0, squares = 0;
    for (int k = 0; k < RANDOM; k++) {
        const float any[3] = {(float)dice_unit(&dice), (float)dice_unit(&dice), (float)dice_unit(&dice)};
        float rgb[3];
        color_found_again(&color, any, rgb);
        for (int c = 0; c < 3; c++) {
            worst = fmax(worst, fabs((double)(rgb[c] - any[c])));
            squares += pow((double)(rgb[c] - any[c]), 2) / (3 * RANDOM);
        }
    }
    printf("reflectances by %d wavelengths: within %.2g, root mean square %.2g\n", LANES * COLOR_FOURS, worst,
           sqrt(squares));
    assert_true(worst < 0.012 && sqrt(squares) < 0.003);
}

static void apply(float matrix[3][3], const double rgb[3], double balanced[3])
{
    for (int i = 0; i < 3; i++) {
        balanced[i] = 0;
        for (int k = 0; k < 3; k++) balanced[i] += (double)matrix[i][k] * rgb[k];
    }
}

/* A light of that temperature becomes grey of its own luminance; and by 2856 K the illuminant A does, for which the Bradford matrix
 * from A to D65 is published (B. Lindbloom: 0.8446965 -0.1179225 0.3948108, -0.1366303 1.1041226 0.1291718, 0.0798489 -0.1348999
 * 3.1924009, of XYZ). */
static void light_is_shown_white(void **unused)
{
    (void)unused;
    static const double published[3][3] = {
        {0.8446965, -0.1179225, 0.3948108}, {-0.1366303, 1.1041226, 0.1291718}, {0.0798489, -0.1348999, 3.1924009}};
    float table[SPECTRUM_SAMPLES], matrix[3][3];
    for (double kelvin = 1000; kelvin <= 40000; kelvin *= 1.3) {
        Spectrum light = spectrum_blackbody(kelvin, table);
        double rgb[3], balanced[3];
        color_from_spectrum(&light, rgb);
        white_balance(kelvin, matrix);
        apply(matrix, rgb, balanced);
        for (int c = 0; c < 3; c++) assert_near(balanced[c], spectrum_luminance(&light), 2e-4);
    }
    /* the same in XYZ: of each primary what it becomes, by both ways */
    white_balance(2856, matrix);
    for (int c = 0; c < 3; c++) {
        /* rgb_from_xyz of the published one's columns against the matrix of those: m R = R p */
        for (int row = 0; row < 3; row++) {
            double ours = 0, theirs = 0;
            for (int k = 0; k < 3; k++) {
                ours += (double)matrix[row][k] * observer_rgb_from_xyz[k][c];
                theirs += observer_rgb_from_xyz[row][k] * published[k][c];
            }
            assert_near(ours, theirs, 4e-3 * fabs(theirs) + 2e-4);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reflectances_have_colors),
        cmocka_unit_test(observer_adds_up),
        cmocka_unit_test(matrix_follows_from_the_data),
        cmocka_unit_test(wavelengths_cover_the_range),
        cmocka_unit_test(white_is_white),
        cmocka_unit_test(sampling_is_unbiased),
        cmocka_unit_test(lines_are_told_apart),
        cmocka_unit_test(lines_are_found),
        cmocka_unit_test(lines_in_rows_are_exact),
        cmocka_unit_test(rows_keep_what_tables_mean),
        cmocka_unit_test(luminance_weighs),
        cmocka_unit_test(light_is_shown_white),
        cmocka_unit_test(spectral_locus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
