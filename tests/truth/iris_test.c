/* iris_test.c - a small light that is far out of focus makes a picture of the iris: its size, its corners, their direction, and as
 * much light as without blades. By moments of the picture over its own pixels.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include "complex_of.h"

enum { PIXELS = 64, SEEDS = 16 };
static const double lens = 20, spot = 2; /* radii of the disc of the lens's area and of the light in focus, in pixels */

/* A light behind the plane that is sharp, or before it, where the picture is upside down. */
#define FAR "sphere { center = <0, 0, -1000>  radius = 1  surface = lamp }"
#define NEAR "sphere { center = <0, 0, -.5>  radius = .0005  surface = lamp }"

typedef struct Case {
    const char *what, *light, *blades;
    uint32_t n;
    double top, roundness; /* top: the direction of a corner in the picture, in degrees from its right */
} Case;

typedef struct Moments {
    Estimate light;      /* of all pixels, in those of the spot */
    Estimate squared;    /* mean squared distance from the middle, of the lens's radius squared */
    Estimate along, off; /* mean of the n-th power of the place, towards the corners and off them */
} Moments;

/* The mean of (r e^it)^n, and of r^2, over an iris whose first corner is on x: by its edges' arcs, a thin sector at a time. */
static void iris_moments(const Case *c, double *squared, double *power)
{
    enum { STEPS = 20000 };
    double half = TRUTH_PI / c->n, bulge = fmax(c->roundness, 1e-6) * (1 - cos(half)), across = sin(half);
    double radius = (across * across + bulge * bulge) / (2 * bulge), behind = radius - cos(half) - bulge;
    double end = asin(fmin(across / radius, 1)), area = 0, second = 0;
    double complex sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double angle = end * (2 * (i + 0.5) / STEPS - 1);
        double complex at = (radius * cexp(complex_of(0, angle)) - behind) * cexp(complex_of(0, half));
        double sector = radius * (radius - behind * cos(angle)); /* twice its area, for its angle */
        area += sector;
        second += sector * pow(cabs(at), 2) / 2;
        sum += sector * cpow(at, c->n) * 2 / (c->n + 2);
    }
    double size = TRUTH_PI / (0.5 * area * c->n * 2 * end / STEPS); /* to the area of a disc: of the square */
    *squared = size * second / area;
    *power = pow(size, 0.5 * c->n) * creal(sum) / area;
}

static Moments measure(const Case *c)
{
    char text[1000];
    double light[SEEDS], squared[SEEDS], along[SEEDS], off[SEEDS];
    Fixture scene;
    snprintf(text, sizeof text,
             "meniscus 1.0 unit m  film { filter = box }  let lamp = surface { emission = 1  albedo = 0 }  %s\n"
             "camera { from = <0, 0, 0>  to = <0, 0, -1>  fov = 2 * atan(.016)  aperture = .02  %s }",
             c->light, c->blades);
    truth_open(&scene, (TruthInput){.text = text});
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Picture picture;
        RenderSettings settings = truth_settings(PIXELS, 128);
        double sum = 0, second = 0;
        double complex power = 0;
        settings.seed = seed + 1;
        truth_render(&scene, &settings, 0, &picture);
        for (uint32_t y = 0; y < PIXELS; y++)
            for (uint32_t x = 0; x < PIXELS; x++) {
                double value = truth_luminance(&picture, x, y);
                double complex at = complex_of(x + 0.5 - PIXELS / 2, PIXELS / 2 - 0.5 - y) / lens;
                sum += value;
                second += value * pow(cabs(at), 2);
                power += value * cpow(at, c->n);
            }
        truth_clear(&picture);
        power *= cexp(complex_of(0, -TRUTH_PI / 180 * c->top * c->n));
        light[seed] = sum / (TRUTH_PI * spot * spot);
        squared[seed] = second / sum;
        along[seed] = creal(power) / sum;
        off[seed] = cimag(power) / sum;
    }
    fixture_clear(&scene);
    return (Moments){truth_estimate(light, SEEDS), truth_estimate(squared, SEEDS), truth_estimate(along, SEEDS),
                     truth_estimate(off, SEEDS)};
}

static void lights_out_of_focus_show_the_iris(void **state)
{
    (void)state;
    static const Case cases[] = {
        {"three blades", FAR, "blades = 3", 3, 90, 0},
        {"three blades, before the focus", NEAR, "blades = 3", 3, -90, 0},
        {"four blades, turned", FAR, "blades = 4  blade_rotation = 20", 4, 110, 0},
        {"five blades", FAR, "blades = 5", 5, 90, 0},
        {"five blades, half round", FAR, "blades = 5  blade_roundness = .5", 5, 90, 0.5},
        {"six blades, before the focus, turned", NEAR, "blades = 6  blade_rotation = -10deg", 6, 80, 0},
        {"three blades, nearly round", FAR, "blades = 3  blade_roundness = .8", 3, 90, 0.8}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const Case *c = &cases[i];
        char what[100];
        double squared, power, n = c->n;
        iris_moments(c, &squared, &power);
        if (c->roundness == 0) { /* closed forms of polygons */
            double corner = sqrt(2 * TRUTH_PI / (n * sin(2 * TRUTH_PI / n)));
            assert_near(squared, corner * corner * (2 + cos(2 * TRUTH_PI / n)) / 6, 1e-5);
            assert_near(power, 2 * pow(corner, n) / ((n + 1) * (n + 2)), 1e-5);
        }
        Moments is = measure(c);
        squared += (spot * spot / 2 + 1. / 6) / (lens * lens); /* of the spot, and of a pixel */
        snprintf(what, sizeof what, "%s: light", c->what);
        truth_expect(what, 1, is.light, 3, 0.01);
        snprintf(what, sizeof what, "%s: squared distance", c->what);
        truth_expect(what, squared, is.squared, 3, 0.01);
        snprintf(what, sizeof what, "%s: power %u of the place", c->what, c->n);
        truth_expect(what, power, is.along, 3, 0.2);
        if (!(fabs(is.off.mean) < 3 * is.off.error))
            fail_msg("%s: turned, %g +- %g", c->what, is.off.mean, is.off.error);
    }
}

/* A round lens, and blades that are round all the way. */
static void round_ones_have_no_corners(void **state)
{
    (void)state;
    static const Case cases[] = {{"a round lens", FAR, "", 5, 90, 1},
                                 {"five round blades", FAR, "blades = 5  blade_roundness = 1", 5, 90, 1}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Moments is = measure(&cases[i]);
        truth_expect(cases[i].what, 1, is.light, 3, 0.01);
        truth_expect(cases[i].what, 0.5 + (spot * spot / 2 + 1. / 6) / (lens * lens), is.squared, 3, 0.01);
        assert_true(fabs(is.along.mean) < 3 * is.along.error);
        assert_true(fabs(is.off.mean) < 3 * is.off.error);
        assert_true(is.along.error < 0.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lights_out_of_focus_show_the_iris),
        cmocka_unit_test(round_ones_have_no_corners),
    };
    return cmocka_run_group_tests_name("iris", tests, NULL, NULL);
}
