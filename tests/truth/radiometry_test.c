/* radiometry_test.c - absorption by Beer and Lambert, the irradiance of every kind of light, and a diffuse floor under
 * water, against their closed forms.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

static const double degree = TRUTH_PI / 180;

/* Mean of a small picture of something that is the same everywhere; all three channels are kept. */
typedef struct Measured {
    Estimate luminance, rgb[3];
} Measured;

static Measured measure(const char *text, double (*sky)(double), uint32_t samples)
{
    enum { PICTURE = 16 };
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .sky = sky, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, samples);
    truth_render(&scene, &settings, 0, &picture);
    assert_int_equal(picture.stats.nesting_faults, 0);
    Measured measured = {.luminance = truth_mean(&picture, -1)};
    for (int c = 0; c < 3; c++) measured.rgb[c] = truth_mean(&picture, c);
    truth_clear(&picture);
    fixture_clear(&scene);
    return measured;
}

/* ---- absorption ---- */

#define NARROW_VIEW "camera { from = <0, 0, 1000>  to = <0, 0, 0>  fov = .002deg }\n"

static void beer_lambert(void **state)
{
    (void)state;
    static const struct {
        const char *what, *text;
        double depth; /* sigma times length */
    } cases[] = {
        {"box of 30 mm, 0.04 / mm", "box { interior = fog  from = <-50, -50, -10>  to = <50, 50, 20> }", 0.04 * 30},
        {"sphere of radius 20 mm", "sphere { interior = fog  radius = 20 }", 0.04 * 40},
        {"the same by the metre", "medium far { ior = 1  absorption = 40 / 1m } sphere { interior = far  radius = 20 }",
         0.04 * 40},
        {"two boxes that overlap merge",
         "box { interior = fog  from = <-50, -50, -10>  to = <50, 50, 5> }\n"
         "box { interior = fog  from = <-40, -40, 0>  to = <40, 40, 20> }",
         0.04 * 30},
        {"a clear ball cut out of it",
         "box { interior = fog  from = <-50, -50, -10>  to = <50, 50, 20> } sphere { interior = clear  radius = 5 }",
         0.04 * 20},
        {"a thicker ball in it, and a clear one in that",
         "box { interior = fog  from = <-50, -50, -10>  to = <50, 50, 20> }\n"
         "sphere { interior = thick  radius = 8 } sphere { interior = clear  radius = 3 }",
         0.04 * 14 + 0.1 * 10},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm medium fog { ior = 1  absorption = .04 / 1mm }\n"
                 "medium clear { ior = 1 } medium thick { ior = 1  absorption = .1 / 1mm }\n%s\n" NARROW_VIEW
                     TRUTH_WHITE_SKY,
                 cases[i].text);
        truth_expect(cases[i].what, exp(-cases[i].depth), measure(text, NULL, 1024).luminance, 4, 0.00025);
    }
}

/* White light that has gone `depth` through a medium has the colour `tint`. The spectrum behind it is fitted to sums at every
 * 5 nm, a render integrates over all wavelengths: they differ by some 1e-4. */
static void tint_at_depth(void **state)
{
    (void)state;
    static const double tints[][3] = {{.95, .78, .22}, {.8, .95, .88}, {.3, .5, .9}, {.6, .6, .6}};
    for (size_t i = 0; i < COUNT_OF(tints); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm medium drink { ior = 1  tint = rgb(%g, %g, %g)  depth = 12mm }\n"
                 "box { interior = drink  from = <-50, -50, 0>  to = <50, 50, 12> }\n" NARROW_VIEW TRUTH_WHITE_SKY,
                 tints[i][0], tints[i][1], tints[i][2]);
        Measured measured = measure(text, NULL, 4096);
        for (int c = 0; c < 3; c++) {
            char what[100];
            snprintf(what, sizeof what, "tint %g %g %g, channel %d", tints[i][0], tints[i][1], tints[i][2], c);
            truth_figure(what, tints[i][c], measured.rgb[c].mean, measured.rgb[c].error);
            assert_near(measured.rgb[c].mean, tints[i][c], 4 * measured.rgb[c].error + 5e-4);
        }
    }
}

/* ---- direct light ---- */

/* The part of what leaves a small level patch that meets a parallel rectangle of a x b centred above it at height h:
 * four times that of a rectangle with a corner above the patch, J. R. Howell, A Catalog of Radiation Heat Transfer
 * Configuration Factors, "differential planar element to finite parallel rectangle". */
static double rectangle_factor(double a, double b, double h)
{
    double x = a / 2 / h, y = b / 2 / h, u = sqrt(1 + x * x), v = sqrt(1 + y * y);
    return 4 / (2 * TRUTH_PI) * (x / u * atan(y / u) + y / v * atan(x / v));
}

static double bright_zenith(double elevation)
{
    return 0.2 + 3 * pow(fmax(sin(elevation), 0), 4);
}

/* Irradiance of each light on a diffuse floor of albedo 0.8 at the origin; it then has the radiance 0.8 E / pi. The
 * renderer weighs light sampling against scattering, so that a mistake in the density of either shows here. */
static void lights_on_a_floor(void **state)
{
    (void)state;
    const struct {
        const char *what, *light;
        double irradiance;
        double (*sky)(double);
    } cases[] = {
        {"sphere above: pi L (r/d)^2", "light { shape = \"sphere\"  from = <0, 30, 0>  radius = 10  radiance = 2 }",
         TRUTH_PI * 2 / 9, NULL},
        {"sphere aslant: pi L (r/d)^2 cos",
         "light { shape = \"sphere\"  from = <20, 15, 0>  radius = 10  radiance = 2 }", TRUTH_PI * 2 * 100 / 625 * 0.6,
         NULL},
        {"disc above: pi L r^2 / (r^2 + h^2)",
         "light { shape = \"disc\"  from = <0, 20, 0>  to = <0, 0, 0>  radius = 15  radiance = 2 }",
         TRUTH_PI * 2 * 225 / 625, NULL},
        {"quad above: by its form factor", "light { from = <0, 20, 0>  to = <0, 0, 0>  size = <30, 12>  radiance = 2 }",
         TRUTH_PI * 2 * rectangle_factor(30, 12, 20), NULL},
        {"wide quad, low: by its form factor",
         "light { from = <0, 5, 0>  to = <0, 0, 0>  size = <80, 100>  radiance = 1 }",
         TRUTH_PI * rectangle_factor(80, 100, 5), NULL},
        {"two lights: the sum",
         "light { shape = \"disc\"  from = <0, 20, 0>  to = <0, 0, 0>  radius = 3  radiance = 20 }\n"
         "light { shape = \"sphere\"  from = <20, 15, 0>  radius = 10  radiance = 2 }",
         TRUTH_PI * 20 * 9 / 409 + TRUTH_PI * 2 * 100 / 625 * 0.6, NULL},
        {"distant, half angle 20 degrees: pi L sin^2",
         "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = 40deg  radiance = 3 }",
         TRUTH_PI * 3 * sin(20 * degree) * sin(20 * degree), NULL},
        {"the sun, by its power, aslant: E cos",
         "light { shape = \"distant\"  from = <0, cos(35), sin(35)>  to = <0, 0, 0>  power = 2 }", 2 * cos(35 * degree),
         NULL},
        {"environment of 1: pi", TRUTH_WHITE_SKY, TRUTH_PI, NULL},
        /* integral over the hemisphere of (a + b sin^4 e) sin e: pi a + 2 pi b / 6 */
        {"environment by a function: its integral",
         "def zenith(p) = .2 + 3 * max(p.y, 0) ^ 4 environment { function = zenith }",
         TRUTH_PI * 0.2 + 2 * TRUTH_PI * 3 / 6, NULL},
        {"environment from an image: its integral", TRUTH_SKY, TRUTH_PI * 0.2 + 2 * TRUTH_PI * 3 / 6, bright_zenith},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm ground { surface = surface { albedo = .8 } }\n"
                 "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg }\n%s\n",
                 cases[i].light);
        Estimate measured = measure(text, cases[i].sky, 4096).luminance;
        truth_expect(cases[i].what, 0.8 / TRUTH_PI * cases[i].irradiance, measured, 4, 0.00075);
    }
}

/* ---- a diffuse floor under water ---- */

/* The part of diffuse light in a medium that its plane surface throws back: 2 integral of R(cos) cos d(cos). */
static double diffuse_reflectance(double ior_from, double ior_to)
{
    enum { STEPS = 200000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double cosine = (i + 0.5) / STEPS;
        sum += 2 * truth_fresnel(cosine, ior_from, ior_to) * cosine / STEPS;
    }
    return sum;
}

/* Under a sky of radiance 1 a floor of albedo rho in water gets, as basic radiance, 1 - F from above and F of its own
 * back, so that it has B = rho (1 - F) / (1 - rho F), F the diffuse reflectance from inside; seen from above it is
 * (1 - R) B + R.
 * J. L. Saunderson, "Calculation of the color of pigmented plastics", JOSA 32 (1942). */
static void floor_under_water(void **state)
{
    (void)state;
    static const double albedos[] = {0.2, 0.5, 0.9};
    double n = 1.33, inside = diffuse_reflectance(n, 1), r = truth_fresnel(1, 1, n);
    for (size_t i = 0; i < COUNT_OF(albedos); i++)
        for (int below = 0; below < 2; below++) {
            char text[1000], what[100];
            double basic = albedos[i] * (1 - inside) / (1 - albedos[i] * inside);
            snprintf(text, sizeof text,
                     "meniscus 1.0 unit mm medium water { ior = 1.33 }\n"
                     "ground { surface = surface { albedo = %g } }\n"
                     "box { interior = water  from = <-1e5, -1, -1e5>  to = <1e5, 10, 1e5> }\n"
                     "camera { from = <0, %d, 0>  to = <0, 0, 0>  up = <0, 0, 1>  fov = 1deg }\n" TRUTH_WHITE_SKY,
                     albedos[i], below ? 5 : 500);
            snprintf(what, sizeof what, "floor of albedo %g under water, seen from %s", albedos[i],
                     below ? "below" : "above");
            Estimate measured = measure(text, NULL, 4096).luminance;
            truth_expect(what, below ? basic : (1 - r) * basic + r, measured, 4, 0.002);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beer_lambert),
        cmocka_unit_test(tint_at_depth),
        cmocka_unit_test(lights_on_a_floor),
        cmocka_unit_test(floor_under_water),
    };
    return cmocka_run_group_tests_name("radiometry", tests, NULL, NULL);
}
