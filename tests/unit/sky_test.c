/* sky_test.c - the computed sky against published illuminances, Beer's law, and what a sky looks like.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/luminance.h"
#include "exact_color.h"
#include "near.h"

#include "base/clock.h"
#include "optics/air.h"
#include "optics/sky.h"

static const double pi = 3.14159265358979323846;

typedef struct Day {
    Environment *sky;
    float sun[SPECTRUM_SAMPLES];
    double direct, level; /* klx: on what faces the sun, by the sun; on level ground, by the sky */
    double level_rgb[3], sun_rgb[3];
} Day;

static double to_klx(double value)
{
    return value * 100 / pi;
}

static Vec3f towards(double elevation, double azimuth)
{
    return vec3f((float)(cos(elevation) * sin(azimuth)), (float)sin(elevation), (float)(cos(elevation) * cos(azimuth)));
}

/* The colour of the sky in a direction. */
static void colour_of(const Environment *sky, Vec3f direction, double rgb[3])
{
    float table[SPECTRUM_SAMPLES];
    for (int i = 0; i < SPECTRUM_SAMPLES; i++)
        table[i] = lanes_get(
            environment_radiance(sky, direction, lanes_all(SPECTRUM_MIN_NM + (float)(i * SPECTRUM_STEP_NM))), 0);
    Spectrum spectrum = {.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
    color_from_spectrum(&spectrum, rgb);
}

static double luminance(const double rgb[3])
{
    return luminance_of(rgb[0], rgb[1], rgb[2]);
}

static void begin(Day *day, double elevation, double turbidity)
{
    Spectrum ground = spectrum_constant(0.2f);
    Error error;
    SkyModel model = {elevation * pi / 180, turbidity, &ground, 1, NULL};
    memset(day, 0, sizeof *day);
    assert_int_equal(sky_new(&model, &day->sky, day->sun, &error), STATUS_OK);
    Spectrum sun = {.kind = SPECTRUM_TABLE, .scale = 1, .table = day->sun};
    color_from_spectrum(&sun, day->sun_rgb);
    day->direct = to_klx(spectrum_luminance(&sun));
    enum { ROWS = 40, COLUMNS = 40 };
    for (int y = 0; y < ROWS; y++)
        for (int x = 0; x < COLUMNS; x++) {
            double rgb[3], height = sqrt((y + 0.5) / ROWS); /* even in the cosine's square */
            colour_of(day->sky, towards(asin(height), 2 * pi * (x + 0.5) / COLUMNS), rgb);
            for (int c = 0; c < 3; c++) day->level_rgb[c] += rgb[c] * pi / (ROWS * COLUMNS);
        }
    day->level = to_klx(luminance(day->level_rgb));
}

static void end(Day *day)
{
    environment_free(day->sky);
}

/* The illuminances of a clear day of the IES, from measurements (IESNA Lighting Handbook, 9th edition, chapter 8):
 * direct 127.5 exp(-0.21 / sin a) klx, sky on level ground 0.8 + 15.5 sqrt(sin a) klx. 127.5 klx stands for the sun above
 * the air, which is 133.3 here: what the air does to it is compared. 0.21 straight up is a turbidity of 1.9. Real clear
 * days differ by more than the limits here; towards the horizon the formula knows nothing of the earth's curvature. */
static void published(void **state)
{
    (void)state;
    static const double elevations[] = {10, 20, 30, 40, 60, 90};
    for (size_t i = 0; i < COUNT_OF(elevations); i++) {
        double sine = sin(elevations[i] * pi / 180), direct = 127.5 * exp(-0.21 / sine), above = 127.5 / 133.3,
               level = 0.8 + 15.5 * sqrt(sine);
        Day day;
        begin(&day, elevations[i], 1.9);
        print_message(
            "      %2.0f degrees: sun %5.1f klx (IES %5.1f), sky %4.1f klx (IES %4.1f), off by %.1f and %.1f %%\n",
            elevations[i], above * day.direct, direct, above * day.level, level,
            100 * (above * day.direct / direct - 1), 100 * (above * day.level / level - 1));
        assert_near(above * day.direct, direct, elevations[i] < 20 ? 0.08 * direct : 0.015 * direct);
        assert_near(above * day.level, level, elevations[i] < 20 ? 0.08 * level : 0.05 * level);
        end(&day);
    }
}

/* The air mass, how many times as much clean air the light of a sun that is seen at an elevation passes as straight down,
 * after F. Kasten, A. T. Young, "Revised optical air mass tables and approximation formula", Applied Optics 28 (1989). Ozone,
 * high up, has less of it, and next to none at 420 nm. */
static void air_mass(void **state)
{
    (void)state;
    static const double elevations[] = {0, 1, 3, 6, 10, 20, 45};
    double straight = log(air_sun_transmittance(1, 90 * pi / 180, 420));
    for (size_t i = 0; i < COUNT_OF(elevations); i++) {
        double e = elevations[i], expected = 1 / (sin(e * pi / 180) + 0.50572 * pow(e + 6.07995, -1.6364));
        double mass = log(air_sun_transmittance(1, e * pi / 180, 420)) / straight;
        print_message("      %2.0f degrees: %.2f (Kasten and Young %.2f)\n", e, mass, expected);
        assert_near(mass, expected, 0.02 * expected);
    }
}

/* Straight up through clean air the sun loses what the optical depths say: Rayleigh's of Hansen and Travis and 300 Dobson
 * units of ozone. */
static void beers_law(void **state)
{
    (void)state;
    Day clean, hazy;
    begin(&clean, 90, 1);
    begin(&hazy, 90, 3);
    for (int nm = 450; nm <= 750; nm += 50) {
        int i = (nm - 360) / SPECTRUM_STEP_NM;
        double um = 1e-3 * nm, w = 1 / (um * um);
        double aerosol = 2 * 0.0973 * pow(um / 0.55, -1.3),
               molecules = 0.008569 * w * w * (1 + 0.0113 * w + 0.00013 * w * w);
        assert_near(log((double)(clean.sun[i] / hazy.sun[i])), aerosol, 0.02 * aerosol);
        float table[SPECTRUM_SAMPLES];
        Spectrum above = spectrum_blackbody(5778, table);
        double lost = -log((double)(clean.sun[i] / table[i]) / (1.333 * pi)) - molecules;
        assert_true(lost > -0.01 && lost < 0.055); /* Chappuis' band */
        (void)above;
    }
    end(&clean);
    end(&hazy);
}

static void looks_like_a_sky(void **state)
{
    (void)state;
    Day noon, evening, night;
    double zenith[3], horizon[3], left[3], right[3], near_sun[3], below[3];
    double start = clock_now_s();
    begin(&noon, 50, 2.2);
    print_message("      made and measured in %.0f ms\n", 1e3 * (clock_now_s() - start));
    begin(&evening, 3, 2.2);
    begin(&night, -6, 2.2);
    colour_of(noon.sky, towards(pi / 2, 0), zenith);
    colour_of(noon.sky, towards(0.05, pi), horizon);
    print_message("      zenith %.3f %.3f %.3f, horizon %.3f %.3f %.3f\n", zenith[0], zenith[1], zenith[2], horizon[0],
                  horizon[1], horizon[2]);
    assert_true(zenith[2] > 1.6 * zenith[0] && zenith[2] > zenith[1] && zenith[1] > zenith[0]); /* blue */
    assert_true(horizon[2] / horizon[0] < 0.7 * zenith[2] / zenith[0]);                         /* paler below */
    assert_true(luminance(horizon) > 1.5 * luminance(zenith));
    double lowest[3], low[3];
    colour_of(noon.sky, towards(0.0005, pi), lowest);
    colour_of(noon.sky, towards(0.015, pi), low);
    assert_near(luminance(lowest), luminance(low), 0.05 * luminance(low)); /* nothing of the land below is in it */
    colour_of(noon.sky, towards(0.5, 1), left);
    colour_of(noon.sky, towards(0.5, -1), right);
    for (int c = 0; c < 3; c++) assert_near(left[c], right[c], 1e-3 * left[c]);
    colour_of(noon.sky, towards(50 * pi / 180, 0.1), near_sun);
    assert_true(luminance(near_sun) > 3 * luminance(zenith));
    /* the ground has its albedo times what falls on it */
    colour_of(noon.sky, towards(-1, 2), below);
    colour_of(noon.sky, towards(-0.0005, pi), lowest); /* the horizon is sharp */
    assert_near(luminance(lowest), luminance(below), 1e-3 * luminance(below));
    double whole = noon.level * pi / 100 + luminance(noon.sun_rgb) * sin(50 * pi / 180);
    assert_near(luminance(below), 0.2 / pi * whole, 0.03 * luminance(below));
    /* a low sun is red, and twilight is thousands of times darker than day */
    assert_true(evening.sun_rgb[0] > 4 * evening.sun_rgb[2] && noon.sun_rgb[0] < 1.8 * noon.sun_rgb[2]);
    assert_true(night.direct == 0 && night.level > 0 && night.level < noon.level / 300);
    end(&noon);
    end(&evening);
    end(&night);
}

/* Where the horizon is sharp, directions are drawn with the density that is said of them, on either side of it. */
static void drawn_at_the_horizon(void **state)
{
    (void)state;
    enum { SIDE = 400 };
    Day day;
    int near = 0;
    begin(&day, 12, 2.2);
    for (int i = 0; i < SIDE * SIDE; i++) {
        float pdf, again;
        EnvironmentPlace place;
        float u = ((float)(i % SIDE) + 0.5f) / SIDE, v = ((float)(i / SIDE) + 0.5f) / SIDE;
        Vec3f direction = environment_sample_place(day.sky, u, v, &pdf, &place);
        if (fabsf(direction.y) > 0.02f || fabsf(direction.y) < 1e-4f) continue;
        Lanes drawn = environment_radiance_at(day.sky, &place, lanes_all(550));
        Lanes found = environment_look(day.sky, direction, lanes_all(550), &again);
        assert_near((double)again, (double)pdf, 2e-3 * (double)pdf);
        assert_near((double)lanes_get(found, 0), (double)lanes_get(drawn, 0), 2e-3 * (double)lanes_get(drawn, 0));
        near++;
    }
    assert_true(near > 500);
    end(&day);
}

/* CIE's overcast sky: white, three times as bright above as at the horizon, and on level ground what the IES measured. */
static void overcast(void **state)
{
    (void)state;
    for (int elevation = 0; elevation <= 90; elevation += 30) {
        Spectrum ground = spectrum_constant(0.3f);
        Error error;
        SkyModel model = {elevation * pi / 180, 2.2, &ground, 2, NULL};
        Environment *sky;
        assert_int_equal(sky_new_overcast(&model, &sky, &error), STATUS_OK);
        double zenith[3], slope[3], below[3], level = 2 * (0.3 + 21 * sin(elevation * pi / 180)) * pi / 100;
        colour_of(sky, towards(pi / 2, 0), zenith);
        colour_of(sky, towards(pi / 6, 1), slope);
        colour_of(sky, towards(-0.3, 1), below);
        for (int c = 0; c < 3; c++) {
            assert_near(zenith[c] / luminance(zenith), 1, 2e-3);
            assert_near(zenith[c], level / pi * 9 / 7, 3e-3 * level);
            assert_near(slope[c] / zenith[c], 2.0 / 3, 1e-3);
            assert_near(below[c], 0.3 * level / pi, 2e-3 * level);
        }
        environment_free(sky);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(published),
                                       cmocka_unit_test(air_mass),
                                       cmocka_unit_test(beers_law),
                                       cmocka_unit_test(looks_like_a_sky),
                                       cmocka_unit_test(drawn_at_the_horizon),
                                       cmocka_unit_test(overcast)};
    return cmocka_run_group_tests_name("sky", tests, NULL, NULL);
}
