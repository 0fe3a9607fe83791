/* volume_test.c - media whose density varies, that shine, and that mix: against quadrature, closed forms, and media that
 * are the same made in another way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include "optics/color.h"

enum { WIDTH = 32, ALL = -1 };

#define HEAD "meniscus 1.0 unit m\n"
/* A lamp of radiance 1, seen straight along z through z = 1 .. -1, and nothing else. */
#define LAMP                                                                                                           \
    " camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = .02deg }"                                                       \
    " light { shape = disc  from = <0, 0, -5>  to = <0, 0, 9>  radius = .02  radiance = 1 }"
#define DARK " camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = .02deg }"
#define PROBE_BOX " box { interior = m  size = <1, 1, 2> } "
/* Cells along z alone: the grid is stretched across. */
#define GRID " from = <-.01, -.01, -1>  to = <.01, .01, 1>  scale(<100, 100, 1>) "

static void picture_of(const char *text, uint32_t samples, bool furnace, Picture *picture)
{
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .furnace = furnace});
    RenderSettings settings = truth_settings(WIDTH, samples);
    settings.no_absorption = furnace;
    settings.bounces = 1000000;
    truth_render(&scene, &settings, 0, picture);
    if (picture->stats.nesting_faults)
        fail_msg("%s: %llu faults", text, (unsigned long long)picture->stats.nesting_faults);
    fixture_clear(&scene);
}

static Estimate mean_of(const char *text, uint32_t samples, bool furnace, int channel)
{
    Picture picture;
    picture_of(text, samples, furnace, &picture);
    Estimate mean = truth_mean(&picture, channel);
    truth_clear(&picture);
    return mean;
}

static Estimate scaled(Estimate a, double by)
{
    return (Estimate){a.mean * by, a.error * by};
}

/* ---- densities along z, from the far end up ---- */

static double ramp(double z)
{
    return 1.5 + 1.5 * z;
}

static double peak(double z)
{
    return 8 * exp(-40 * (z - 0.2) * (z - 0.2));
}

static double waves(double z)
{
    return 1 + sin(40 * z);
}

typedef struct Density {
    const char *name, *formula; /* of the scene's p */
    double (*at)(double z);
} Density;

static const Density densities[] = {
    {"a ramp", "1.5 + 1.5 * p.z", ramp},
    {"a peak", "8 * exp(-40 * (p.z - .2) ^ 2)", peak},
    {"waves", "1 + sin(40 * p.z)", waves},
};

/* Simpson's rule. */
static double integral(double (*f)(double z, const void *context), const void *context, double from, double to)
{
    enum { STEPS = 2000 };
    double sum = 0, step = (to - from) / STEPS;
    for (int i = 0; i <= STEPS; i++) sum += f(from + i * step, context) * (i == 0 || i == STEPS ? 1 : i & 1 ? 4 : 2);
    return sum * step / 3;
}

static double density_at(double z, const void *context)
{
    return ((const Density *)context)->at(z);
}

static double depth_of(const Density *density, double from, double to)
{
    return integral(density_at, density, from, to);
}

/* ---- transmittance ---- */

/* What is left of a lamp, by absorption, by scattering, and by both: e^-depth. */
static void transmittance(void **state)
{
    (void)state;
    static const double parts[][2] = {{0.7, 0}, {0, 0.7}, {0.4, 0.3}};
    static const char *const losses[] = {"absorbs", "scatters", "does both"};
    Estimate clear = mean_of(HEAD LAMP, 16, false, ALL);
    for (size_t i = 0; i < COUNT_OF(densities); i++)
        for (size_t k = 0; k < COUNT_OF(parts); k++) {
            char text[1200], what[100];
            snprintf(text, sizeof text,
                     HEAD "def f(p) = %s medium m { ior = 1  absorption = %g  scattering = %g  density = volume { "
                          "function = f " GRID " cells = 400 } }" PROBE_BOX LAMP,
                     densities[i].formula, parts[k][0], parts[k][1]);
            snprintf(what, sizeof what, "transmittance of %s that %s", densities[i].name, losses[k]);
            truth_expect(what, exp(-0.7 * depth_of(&densities[i], -1, 1)),
                         truth_ratio(mean_of(text, 128, false, ALL), clear), 4, 0.01);
        }
}

/* What moves an object moves the smoke in it, and what moves a volume moves it in the object; a grid of a file has its
 * own lengths: eight voxels of half a metre along z, from 7 / 64 to 28 / 64, and half a metre at both ends over which
 * they fade. */
static void places(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
        double depth;
    } cases[] = {
        {"smoke that is turned with its object",
         HEAD
         "def f(p) = 1.5 + 1.5 * p.x medium m { ior = 1  absorption = 1  density = volume { function = f  cells = 8 } }"
         "group { translate(<0, .2, 0>)  box { interior = m  size = <2, 1, 1>  rotate(y, 90)  translate(<.1, 0, -1>) } "
         "}" LAMP,
         3},
        {"smoke that is turned in its object",
         HEAD
         "def f(p) = 1.5 + 1.5 * p.x medium m { ior = 1  absorption = 1  density = volume { function = f  cells = 8"
         " rotate(y, 90)  translate(<0, 0, 1>) } } box { interior = m  size = <1, 1, 2> }" LAMP,
         2.25}, /* x is turned to -z: half of the grid is in the box */
        {"a grid of a file",
         HEAD
         "medium m { ior = 1  absorption = 2  density = volume { file = \"tests/unit/voxels.nvdb\"  grid = \"density\""
         " translate(<-10, -22.5, -34.25>)  scale(<1, 1, .5>) } } box { interior = m  size = <.5, .5, 5> }" LAMP,
         0.5 * 2 * 0.5 * 140 / 64.0},
    };
    Estimate clear = mean_of(HEAD LAMP, 16, false, ALL);
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        truth_expect(cases[i].name, exp(-cases[i].depth), truth_ratio(mean_of(cases[i].text, 64, false, ALL), clear), 4,
                     0.01);
}

/* The same for light on a wall, which comes by straight rays: the sun through a slab that does not hide the wall. */
static void shadow_rays(void **state)
{
    (void)state;
    static const char *const view =
        " box { from = <-9, -9, -2>  to = <9, 9, -1.5>  surface = surface { albedo = .5 } }"
        " camera { from = <6, 0, -1>  to = <0, 0, -1.5>  fov = .05deg }"
        " light { shape = distant  from = <0, 0, 1>  to = <0, 0, 0>  angle = .001deg  power = 1 }";
    char text[1200];
    snprintf(text, sizeof text, HEAD "%s", view);
    Estimate clear = mean_of(text, 16, false, ALL);
    for (size_t i = 0; i < COUNT_OF(densities); i++) {
        snprintf(text, sizeof text,
                 HEAD "def f(p) = %s medium m { ior = 1  absorption = .7  density = volume { function = f " GRID
                      " cells = 400 } }" PROBE_BOX "%s",
                 densities[i].formula, view);
        char what[100];
        snprintf(what, sizeof what, "sunlight through %s", densities[i].name);
        truth_expect(what, exp(-0.7 * depth_of(&densities[i], -1, 1)),
                     truth_ratio(mean_of(text, 64, false, ALL), clear), 4, 0.01);
    }
}

/* Scattering that is 100 times as strong in blue as in red: each channel as through an even medium as deep, and about as
 * little noise. */
static void colors(void **state)
{
    (void)state;
    static const char *const fog = "ior = 1  scattering = <.05, .5, 5>  absorption = <.3, .1, 0>";
    char even[1000], uneven[1000];
    double mean = depth_of(&densities[2], -1, 1) / 2;
    snprintf(even, sizeof even,
             HEAD "medium m { ior = 1  scattering = <%g, %g, %g>  absorption = <%g, %g, 0> }" PROBE_BOX LAMP,
             .05 * mean, .5 * mean, 5 * mean, .3 * mean, .1 * mean);
    snprintf(uneven, sizeof uneven,
             HEAD "def f(p) = 1 + sin(40 * p.z) medium m { %s  density = volume { function = f " GRID
                  " cells = 400 } }" PROBE_BOX LAMP,
             fog);
    Picture pictures[2];
    picture_of(even, 128, false, &pictures[0]);
    picture_of(uneven, 128, false, &pictures[1]);
    for (int channel = 0; channel < 3; channel++) {
        static const char *const names[] = {"red", "green", "blue"};
        Estimate of[2];
        char what[100];
        for (int i = 0; i < 2; i++) of[i] = truth_mean(&pictures[i], channel);
        snprintf(what, sizeof what, "%s through waves of a fog that is bluest, over an even one", names[channel]);
        truth_expect(what, 1, truth_ratio(of[1], of[0]), 4, 0.02);
        printf("  noise of %s: %.2g of its mean in a pixel of 128 samples, %.2g in the even fog\n", names[channel],
               of[1].error / of[1].mean * WIDTH, of[0].error / of[0].mean * WIDTH);
        assert_true(of[1].error < 3 * of[0].error + 0.001 * of[0].mean);
    }
    for (int i = 0; i < 2; i++) truth_clear(&pictures[i]);
}

/* ---- scattering ---- */

typedef struct Slab {
    const Density *density;
    double extinction, secant;
} Slab;

static double scattered_at(double z, const void *context)
{
    const Slab *slab = context;
    double above = depth_of(slab->density, z, 1) * slab->extinction;
    return slab->density->at(z) * exp(-above * (1 + slab->secant));
}

/* Light of the sun at 60 degrees that is scattered once on its way through a slab, as in media_test.c. */
static void single_scattering(void **state)
{
    (void)state;
    static const char *const view =
        " camera { from = <0, 0, 50>  to = <0, 0, 0>  fov = .02deg }"
        " light { shape = distant  from = <1.7320508, 0, 1>  to = <0, 0, 0>  angle = .01deg  power = 1 }";
    const double extinction = 0.6, share = 1e-3, cos_sun = 0.5, g = 0.4;
    char text[1000];
    snprintf(text, sizeof text, HEAD "box { size = <90, 90, 2>  surface = surface { albedo = 1 } } %s", view);
    double irradiance = mean_of(text, 16, false, ALL).mean * TRUTH_PI / cos_sun;
    for (size_t i = 0; i < 2; i++) {
        char what[100];
        const Slab slab = {&densities[i], extinction, 1 / cos_sun};
        snprintf(text, sizeof text,
                 HEAD "def f(p) = %s medium m { ior = 1  absorption = %.12g  scattering = %.12g  phase = hg(%g)"
                      " density = volume { function = f " GRID " cells = 400  scale(<90, 90, 1>) } }"
                      " box { interior = m  size = <90, 90, 2> } %s",
                 densities[i].formula, extinction * (1 - share), extinction * share, g, view);
        Estimate seen = mean_of(text, 512, false, ALL);
        double phase = (1 - g * g) / (4 * TRUTH_PI * pow(1 + g * g + 2 * g * cos_sun, 1.5));
        double expected = irradiance * phase * extinction * share * integral(scattered_at, &slab, -1, 1);
        snprintf(what, sizeof what, "single scattering in %s", densities[i].name);
        truth_expect(what, 1, scaled(seen, 1 / expected), 4, 0.06);
    }
}

/* Nothing is absorbed: smoke of all densities and colours in glass, in the open, moved, mixed. */
static void furnaces(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
    } cases[] = {
        {"smoke in a bubble in glass",
         HEAD "def f(p) = 4 * max(0, noise(p * 4)) medium glass { ior = 1.5  state = solid }"
              "medium smoke { ior = 1.1  scattering = <2, 3, 5>  phase = hg(.5)  density = volume { function = f  "
              "cells = 40 } }"
              "sphere { interior = glass  radius = 1.1 } sphere { interior = smoke  radius = 1 }"
              "camera { from = <0, 0, 4>  to = <0, 0, 0>  fov = 40deg }" TRUTH_SKY},
        {"two smokes that mix with air and with each other, one turned and partly within glass",
         HEAD "def f(p) = 3 * max(0, 1 - length(p)) medium glass { ior = 1.5  state = solid }"
              "medium grey { mixes = true  scattering = 2  density = volume { function = f } }"
              "medium blue { mixes = true  scattering = <1, 2, 6>  phase = rayleigh()  density = volume { function = f "
              " scale(.8) } }"
              "sphere { interior = glass  radius = .4  center = <.5, .2, 0> } box { interior = grey  size = <2, 2, 2> }"
              "box { interior = blue  size = <1.6, 1.6, 1.6>  rotate(y, 30)  translate(<.4, 0, .2>) }"
              "camera { from = <0, 0, 4>  to = <0, 0, 0>  fov = 40deg }" TRUTH_SKY},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        truth_expect(cases[i].name, 1, mean_of(cases[i].text, 64, true, ALL), 4, 0.004);
}

/* ---- mixing ---- */

/* Two smokes in one place are one smoke of the sum of their coefficients: in what is seen through them, and in what they
 * scatter. */
static void mixing_adds_up(void **state)
{
    (void)state;
    static const char *const view =
        " camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 16deg }"
        " light { shape = sphere  from = <3, 3, 3>  radius = .5  radiance = 30 }" TRUTH_WHITE_SKY;
    static const char *const two =
        "def f(p) = 3 * max(0, 1 - length(p)) def g(p) = 1 - f(p) / 3"
        " medium a { mixes = true  scattering = <2, 1, .5>  absorption = .2  density = volume { function = f } }"
        " medium b { mixes = true  scattering = <6, 3, 1.5>  absorption = .6  density = volume { function = g } }"
        " sphere { interior = a } sphere { interior = b }";
    static const char *const one =
        " medium m { ior = 1  scattering = <6, 3, 1.5>  absorption = .6 } sphere { interior = m }";
    char text[1200];
    Estimate total[2];
    for (int i = 0; i < 2; i++) {
        Picture picture;
        snprintf(text, sizeof text, HEAD "%s%s", i ? one : two, view);
        picture_of(text, 64, false, &picture);
        total[i] = truth_total(&picture);
        truth_clear(&picture);
    }
    truth_expect("two smokes that make up an even one, over that", 1, truth_ratio(total[0], total[1]), 4, 0.01);
}

/* ---- light ---- */

typedef struct Column {
    double (*glow)(double z), extinction;
} Column;

static double seen_of(double z, const void *context)
{
    const Column *column = context;
    return column->glow(z) * exp(-column->extinction * (1 - z));
}

static double seen_of_itself(double z, const void *context)
{
    const Slab *slab = context;
    return slab->density->at(z) * exp(-slab->extinction * depth_of(slab->density, z, 1));
}

/* Radiance gained along a column: j (1 - e^-ad) / a, and by quadrature. */
static void columns(void **state)
{
    (void)state;
    char text[1200], what[100];
    static const double absorptions[] = {0, 1e-6, 0.8, 5};
    for (size_t i = 0; i < COUNT_OF(absorptions); i++) {
        double a = absorptions[i];
        snprintf(text, sizeof text, HEAD "medium m { ior = 1  emission = 1  radiance = .4  absorption = %g } %s %s", a,
                 PROBE_BOX, DARK);
        snprintf(what, sizeof what, "an even column that shines and absorbs %g", a);
        /* white of radiance 1 has luminance 1, to the noise of its wavelengths */
        truth_expect(what, 0.4 * (a > 0 ? -expm1(-2 * a) / a : 2), mean_of(text, 32, false, ALL), 4, 0.01);
    }
    for (size_t i = 0; i < COUNT_OF(densities); i++) {
        const Slab slab = {&densities[i], 0.7, 0};
        snprintf(text, sizeof text,
                 HEAD "def f(p) = %s medium m { ior = 1  emission = 1  absorption = .4  scattering = .3"
                      " density = volume { function = f " GRID " cells = 400 } } %s %s",
                 densities[i].formula, PROBE_BOX, DARK);
        /* scattered light is seen as well: so little is lost sideways that it has to be left out by an albedo of nothing */
        char *scattering = strstr(text, "absorption = .4  scattering = .3");
        memcpy(scattering, "absorption = .7                 ", 32);
        snprintf(what, sizeof what, "a column of %s", densities[i].name);
        truth_expect(what, integral(seen_of_itself, &slab, -1, 1), mean_of(text, 32, false, ALL), 4, 0.01);
    }
    const Column column = {ramp, 0.9};
    snprintf(text, sizeof text,
             HEAD "def f(p) = %s medium haze { ior = 1  absorption = .9 } medium m { mixes = true  emission = 1 "
                  " density = volume { function = f " GRID " } } box { interior = haze  size = <1, 1, 2> } %s %s",
             densities[0].formula, PROBE_BOX, DARK);
    truth_expect("a flame in a haze", integral(seen_of, &column, -1, 1), mean_of(text, 32, false, ALL), 4, 0.01);
}

static double planck(void *context, double nm)
{
    double kelvin = *(double *)context;
    return 1e15 / (nm * nm * nm * nm * nm) / expm1(1.438776877e7 / (nm * kelvin));
}

static double planck_luminance(double kelvin)
{
    float table[SPECTRUM_SAMPLES];
    Spectrum spectrum = spectrum_tabulate(planck, &kelvin, table);
    return spectrum_luminance(&spectrum);
}

/* A place at another temperature than the one that radiance is given for shines by Planck's law. */
static void temperatures(void **state)
{
    (void)state;
    static const double kelvins[] = {1200, 1800, 2600};
    for (size_t i = 0; i < COUNT_OF(kelvins); i++) {
        char text[1000], what[100];
        snprintf(text, sizeof text,
                 HEAD "def f(p) = 1 def t(p) = %g medium m { ior = 1  emission = blackbody(1800)  radiance = .5"
                      " density = volume { function = f " GRID " } temperature = volume { function = t " GRID
                      " } } %s %s",
                 kelvins[i], PROBE_BOX, DARK);
        snprintf(what, sizeof what, "a column at %g K, over one at 1800 K", kelvins[i]);
        double expected = planck_luminance(kelvins[i]) / planck_luminance(1800);
        Estimate seen = mean_of(text, 64, false, ALL);
        seen.error = hypot(seen.error, 0.001 * expected); /* tables in steps of 5 nm, of spectra as steep as these */
        truth_expect(what, expected, seen, 4, 0.02);
    }
}

/* Light of a flame on a wall and in fog, found by light sampling; and by chance alone, behind a boundary that blocks
 * straight rays but hardly bends them. */
static void flames(void **state)
{
    (void)state;
    static const double indices[] = {1, 1.00001};
    Estimate total[2];
    for (int i = 0; i < 2; i++) {
        char text[1400];
        Picture picture;
        snprintf(text, sizeof text,
                 HEAD
                 "def f(p) = 6 * max(0, 1 - length(p)) def t(p) = 1900 - 600 * length(p)"
                 " medium skin { ior = %.6g } medium fog { mixes = true  scattering = .1  absorption = .02 }"
                 " medium flame { mixes = true  emission = blackbody(1900)  radiance = 3  absorption = .5  state = gas"
                 " density = volume { function = f } temperature = volume { function = t } }"
                 " sphere { interior = skin  radius = 1.2 } sphere { interior = flame }"
                 " box { interior = fog  size = <9, 9, 9> } ground { y = -1.3 }"
                 " camera { from = <0, 1, 7>  to = <0, -1, 0>  fov = 30deg }",
                 indices[i]);
        picture_of(text, i ? 256 : 64, false, &picture);
        total[i] = truth_total(&picture);
        truth_clear(&picture);
    }
    truth_expect("a flame's light found by sampling, and by chance", 1, truth_ratio(total[0], total[1]), 4, 0.02);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(transmittance),     cmocka_unit_test(places),
        cmocka_unit_test(shadow_rays),       cmocka_unit_test(colors),
        cmocka_unit_test(single_scattering), cmocka_unit_test(furnaces),
        cmocka_unit_test(mixing_adds_up),    cmocka_unit_test(columns),
        cmocka_unit_test(temperatures),      cmocka_unit_test(flames),
    };
    return cmocka_run_group_tests_name("volume", tests, NULL, NULL);
}
