/* lamps_test.c - lamps near by through flat faces: found by looking along the ways that are known in closed form, against closed
 * forms, and against chance alone.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#define BENCH_OF(albedo)                                                                                               \
    "meniscus 1.0 unit mm ground { surface = surface { albedo = " albedo " } }\n"                                      \
    "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg }\n"                                                    \
    "medium glass { ior = 1.5  state = solid }\n"                                                                      \
    "medium green { ior = 1.6  absorption = .05 / 1mm  state = solid }\n"                                              \
    "medium water { ior = 1.33 }\n"                                                                                    \
    "medium fog { ior = 1  scattering = .02 / 1mm }\n"                                                                 \
    "medium murk { ior = 1.33  scattering = .02 / 1mm }\n"                                                             \
    "medium hole { ior = 1 }\n"                                                                                        \
    "medium flint { ior = cauchy(1.6, .02)  state = solid }\n"                                                         \
    "surface pane { thin = true  transmission = 1  ior = 1.5  roughness = 0  tint = rgb(.4, .7, .9) }\n"
#define BENCH BENCH_OF(".8")
#define DARK BENCH_OF(".00001") /* what it lights itself, by a reflection, is nothing */

/* ---- closed forms ---- */

/* The angle outside a plate of glass of a way of light whose layers' offsets add up to a distance aside. */
static double angle_outside(double aside, double air, double glass, double ior)
{
    double low = 0, high = TRUTH_PI / 2;
    for (int i = 0; i < 200; i++) {
        double angle = 0.5 * (low + high), inside = asin(sin(angle) / ior);
        *(air * tan(angle) + glass * tan(inside) < aside ? &low : &high) = angle;
    }
    return low;
}

/* A point above a plate of glass, aside of the place. A steradian outside is spread over s ds / (sin da) of a level plane, cos(angle) of
 * that across. What goes to and fro in the plate once is the same for a plate three times as thick; n: so often at most. */
static double point_through_plate(double aside, double above, double thickness, double ior, int n)
{
    double sum = 0;
    for (int again = 0; again <= n; again++) {
        double glass = thickness * (1 + 2 * again), air = above - thickness,
               angle = angle_outside(aside, air, glass, ior);
        double cosine = cos(angle), inside = sqrt(1 - pow(sin(angle) / ior, 2));
        double around = air / cosine + glass / (ior * inside);
        double along = air / (cosine * cosine) + glass * cosine / (ior * pow(inside, 3));
        double r = truth_fresnel(cosine, 1, ior);
        sum += (1 - r) * (1 - r) * pow(r, 2 * again) / (around * along);
    }
    return sum;
}

static void points(void **state)
{
    (void)state;
    static const double asides[] = {1e-9, 10, 30, 90};
    for (size_t i = 0; i < COUNT_OF(asides); i++) {
        char text[2000], what[80];
        snprintf(text, sizeof text,
                 DARK "light { shape = point  from = <%.17g, 40, 0>  intensity = 20 }\n"
                      "box { from = <-900, 20, -900>  to = <900, 30, 900>  interior = glass }\n",
                 asides[i]);
        snprintf(what, sizeof what, "a point %g aside, through a plate", asides[i]);
        RenderSettings looking = truth_small(4096);
        looking.caustics = CAUSTICS_OFF;
        /* cos(angle) of the floor is in the spread already */
        truth_expect(what, 0.00001 / TRUTH_PI * 2e7 * point_through_plate(asides[i], 40, 10, 1.5, 1),
                     truth_measure_as(text, NULL, &looking), 4, 0.001);
    }
}

/* Spots, whose cones hold the way by the plate alone; straight towards the place they are dark. */
static void beams(void **state)
{
    (void)state;
    static const double asides[] = {15, 30, 60};
    for (size_t i = 0; i < COUNT_OF(asides); i++) {
        double aside = asides[i], angle = angle_outside(aside, 30, 10, 1.5), straight = atan(aside / 40);
        char text[2000], what[80];
        snprintf(text, sizeof text,
                 DARK "light { shape = spot  from = <%.17g, 40, 0>  to = <%.17g, 0, 0>  intensity = 20  angle = %.17g"
                      "  blend = 0 }\n"
                      "light { shape = spot  from = <0, 50, 0>  to = <9, 90, 0>  intensity = 20 }\n" /* elsewhere */
                      "box { from = <-900, 20, -900>  to = <900, 30, 900>  interior = glass }\n"
                      "box { from = <%.17g, %.17g, -1>  to = <%.17g, 10.5, 1>  surface = surface { albedo = 0 } }\n",
                 aside, aside - 40 * tan(angle), (angle - straight) * 180 / TRUTH_PI, 10 * tan(straight),
                 5 + 5 * tan(straight) / tan(angle), 10 * tan(straight) + 0.05); /* a card in the straight way alone */
        snprintf(what, sizeof what, "a spot %g aside, through a plate", aside);
        RenderSettings looking = truth_small(4096);
        looking.caustics = CAUSTICS_OFF;
        truth_expect(what, 0.00001 / TRUTH_PI * 2e7 * point_through_plate(aside, 40, 10, 1.5, 0),
                     truth_measure_as(text, NULL, &looking), 4, 0.001);
    }
}

/* Straight above, under water, where what is in air seems to be n times as far. Radiance is told as it would be in air. */
static void under_water(void **state)
{
    (void)state;
    double r = truth_fresnel(1, 1, 1.33), apart = 12 + 28 * 1.33;
    static const char *const waters[] = {"box { from = <-900, -1, -900>  to = <900, 12, 900>",
                                         "plane { translate(<0, 12, 0>)"};
    for (size_t i = 0; i < COUNT_OF(waters); i++) {
        char text[1000];
        RenderSettings looking = truth_small(256);
        looking.caustics = CAUSTICS_OFF;
        looking.bounces = 2;
        snprintf(text, sizeof text,
                 BENCH
                 "light { shape = sphere  from = <0, 40, 0>  radius = .05  radiance = 3e3 }\n%s  interior = water }\n",
                 waters[i]);
        truth_expect("a lamp above still water, seen from its floor", 0.8 * 3e3 * pow(0.05 / apart, 2) * (1 - r),
                     truth_measure_as(text, NULL, &looking), 4, 0.002);
    }
}

/* Balls of one power, of which some lamps are points: through water aslant light comes from another part of them than is seen straight,
 * and looks go to their surface, however small they are and however far from the origin. */
static void balls_as_points(void **state)
{
    (void)state;
    static const struct {
        double radius;
        int x;
    } cases[] = {{1, 0}, {.1, 0}, {.03, 0}, {.1, 3000}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2][2000], what[80];
        for (int ball = 0; ball < 2; ball++) {
            char lamp[200];
            if (ball)
                snprintf(lamp, sizeof lamp, "shape = sphere  radius = %.17g  radiance = %.17g", cases[i].radius,
                         20e6 / TRUTH_PI / pow(cases[i].radius, 2));
            else
                snprintf(lamp, sizeof lamp, "shape = point  intensity = 20");
            snprintf(text[ball], sizeof text[ball],
                     "meniscus 1.0 unit mm medium water { ior = 1.33 }\n"
                     "group { ground { surface = surface { albedo = .8 } }\n"
                     "camera { from = <60, 3, 4.5>  to = <60, 0, 0>  fov = .01deg }\n"
                     "light { from = <0, 60, 0>  %s }\n"
                     "box { from = <-900, -1, -900>  to = <900, 30, 900>  interior = water }\n"
                     "translate(<%d, 0, 0>) }\n",
                     lamp, cases[i].x);
        }
        snprintf(what, sizeof what, "a ball of %g mm in water, %d mm from the origin, as a point", cases[i].radius,
                 cases[i].x);
        RenderSettings looking = truth_small(2048);
        looking.caustics = CAUSTICS_OFF;
        looking.bounces = 2;
        truth_alike(what, truth_measure_as(text[0], NULL, &looking), truth_measure_as(text[1], NULL, &looking), 4,
                    0.0002);
    }
}

/* ---- against chance ---- */

/* Beams in water that scatters, and in such that varies as well, which the camera's line crosses: looked for where they go, and found by
 * flights that happen to be scattered within them. */
static void beams_in_water(void **state)
{
    (void)state;
    static const char *const waters[] = {
        "box { from = <-40, -1, -40>  to = <40, 12, 40>  interior = murk }\n",
        "def f(p) = 1 + sin(60 * p.x) * cos(70 * p.z)\n"
        "medium clouds { ior = 1.33  scattering = .04 / 1mm  density = volume { function = f  from = <-40, -1, -40>"
        "  to = <40, 12, 40>  cells = 80 } }\n"
        "box { from = <-40, -1, -40>  to = <40, 12, 40>  interior = clouds }\n"};
    static const char *const lamps[] = {
        "light { shape = disc  from = <-18.1, 30, 2.2>  to = <-5.1, 12, 2.2>  radius = .5  angle = 2  radiance = 1e5 "
        "}\n",
        "light { shape = spot  from = <-18.1, 30, 2.2>  to = <-5.1, 12, 2.2>  angle = 3  intensity = .04 }\n",
        "light { shape = disc  from = <-18.1, 30, 2.2>  to = <-5.1, 12, 2.2>  radius = .5  angle = 2  radiance = 1e5 "
        "}\n"
        "light { shape = spot  from = <-18.1, 30, 1.8>  to = <-5.1, 12, 2.2>  angle = 3  intensity = .04 }\n"};
    for (size_t w = 0; w < COUNT_OF(waters); w++)
        for (size_t i = 0; i < COUNT_OF(lamps); i++) {
            char text[3000], what[80];
            snprintf(text, sizeof text, DARK "%s%s", lamps[i], waters[w]);
            snprintf(what, sizeof what, "beam %zu in water %zu", i + 1, w + 1);
            RenderSettings looking = truth_small(256), flying = truth_small(8192);
            looking.caustics = flying.caustics = CAUSTICS_OFF;
            flying.trial.flights_alone = true;
            Estimate by_chance = truth_measure_as(text, NULL, &flying), looked = truth_measure_as(text, NULL, &looking);
            truth_alike(what, by_chance, looked, 4, 0.03);
            double less = 32 * by_chance.error * by_chance.error / (looked.error * looked.error);
            printf("      the variance of a sample is %.0f times less\n", less);
            assert_true(less > 4);
        }
}

typedef struct Case {
    const char *what, *between;
    bool photons; /* with them, too */
} Case;

static void expect_alike(const Case *c)
{
    char text[3000], name[120];
    snprintf(text, sizeof text, BENCH "%s\n", c->between);
    Estimate by_chance = truth_measure(text, NULL, 2048, true);
    for (int photons = 0; photons <= c->photons; photons++) {
        RenderSettings looking = truth_small(512);
        looking.caustics = photons ? CAUSTICS_ON : CAUSTICS_OFF;
        snprintf(name, sizeof name, "%s%s", c->what, photons ? ", with photons" : "");
        truth_alike(name, by_chance, truth_measure_as(text, NULL, &looking), 4, 0.012);
    }
}

/* Beams that a block mirrors to where they do not shine straight: onto a floor, and across the camera's line in fog, where what looks
 * find from wherever flights are scattered is told beside what is looked for where the beam goes. */
static void off_a_block(void **state)
{
    (void)state;
    static const char block[] = "box { from = <8, -1, -30>  to = <14, 40, 30>  interior = glass }\n";
    char text[3000];
    RenderSettings looking = truth_small(512), flying = truth_small(8192);
    looking.caustics = flying.caustics = CAUSTICS_OFF;
    flying.trial.flights_alone = true;
    snprintf(
        text, sizeof text,
        BENCH
        "light { shape = disc  from = <-20, 20, 0>  to = <8, 4.44, 0>  radius = 8  angle = 26deg  radiance = 40 }\n%s",
        block);
    truth_alike("a disc into a narrow cone, mirrored by a block", truth_measure(text, NULL, 1 << 15, true),
                truth_measure_as(text, NULL, &looking), 4, 0.03);
    static const char *const lamps[] = {"shape = disc  radius = .5  angle = 2  radiance = 1e5",
                                        "shape = spot  angle = 3  intensity = .04"};
    for (size_t i = 0; i < COUNT_OF(lamps); i++) {
        char what[80];
        snprintf(text, sizeof text,
                 DARK "light { from = <-20, 12, 2.2>  to = <8, 3.83, 2.2>  %s }\n%s"
                      "box { from = <-40, -1, -40>  to = <40, 40, 40>  interior = fog }\n",
                 lamps[i], block);
        snprintf(what, sizeof what, "beam %zu in fog, mirrored by a block", i + 1);
        truth_alike(what, truth_measure_as(text, NULL, &flying), truth_measure_as(text, NULL, &looking), 4, 0.03);
    }
}

/* A pencil of light that a prism turns by 37 degrees, so that no straight line from where it falls to the lamp comes to the prism: with an index
 * for each wavelength, by some of which no light comes there, too; onto a floor, and seen in fog. */
static void through_a_prism(void **state)
{
    (void)state;
    static const char *const glasses[] = {"ior = 1.5", "ior = cauchy(1.46, .014)"};
    for (size_t i = 0; i < COUNT_OF(glasses); i++) {
        char text[3000], what[80];
        RenderSettings looking = truth_small(2048);
        looking.caustics = CAUSTICS_OFF;
        snprintf(text, sizeof text,
                 BENCH
                 "medium dense { %s  state = solid }\n"
                 "light { shape = disc  from = <-26.1, 57.5, 0>  to = <-1.914, 25.69, 0>  radius = 3  angle = 4  "
                 "radiance = 40 }\n"
                 "prism { interior = dense  outline = [<-6, 0>, <6, 0>, <0, 10.3923>]  from = -6  to = 6\n"
                 "  rotate(x, -90)  translate(<0, -5.19615, 0>)  rotate(z, -71.4)  translate(<-.957, 22.84, 0>) }\n",
                 glasses[i]);
        snprintf(what, sizeof what, "a pencil through a prism, %s", glasses[i]);
        truth_alike(what, truth_measure(text, NULL, 1 << 16, true), truth_measure_as(text, NULL, &looking), 4, 0.03);
    }
}

#define QUAD "light { from = <6, 30, 4>  to = <0, 0, 0>  size = <16, 12>  radiance = 2 }\n"

static void as_by_chance(void **state)
{
    (void)state;
    static const Case cases[] = {
        {"quad, a pane", QUAD "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }", true},
        {"quad, the edge of a pane across it", QUAD "box { from = <2, 8, -30>  to = <30, 14, 30>  interior = glass }",
         false},
        {"quad, panes aslant",
         QUAD
         "box { from = <-30, 0, -30>  to = <30, 4, 30>  rotate(<20, 30, 10>)  translate(<3, 8, 0>)  interior = glass }"
         "box { from = <-30, 0, -30>  to = <30, 3, 30>  rotate(<-10, 0, -30>)  translate(<3, 18, 0>)  interior = green "
         "}",
         true},
        {"quad, panes that reach into each other",
         QUAD "box { from = <-30, 8, -30>  to = <30, 11, 30>  interior = green }\n"
              "box { from = <-30, 10, -30>  to = <30, 14, 30>  interior = glass }",
         false},
        {"quad, a pane on the place", QUAD "box { from = <-30, -1, -30>  to = <30, 1, 30>  interior = glass }", false},
        {"quad, water", QUAD "box { from = <-30, -1, -30>  to = <30, 12, 30>  interior = water }", true},
        {"quad, water in murk", QUAD "box { from = <-30, -1, -30>  to = <30, 12, 30>  interior = murk }", true},
        {"quad, a pane in fog",
         QUAD "box { from = <-40, -1, -40>  to = <40, 26, 40>  interior = fog }\n"
              "box { from = <-30, 8, -30>  to = <30, 12, 30>  interior = glass }",
         false},
        {"quad, water and a block aslant in it",
         QUAD
         "box { from = <-30, -1, -30>  to = <30, 20, 30>  interior = water }\n"
         "box { from = <-9, 0, -9>  to = <9, 5, 9>  rotate(<20, 30, 10>)  translate(<3, 9, 0>)  interior = glass }",
         false},
        {"quad, a pane and a sheet",
         QUAD "box { from = <-30, 8, -30>  to = <30, 9, 30>  interior = glass }\n"
              "box { from = <2, 12, -90>  to = <90, 12.1, 90>  surface = pane }\n"
              "box { from = <-90, 5, -90>  to = <90, 5.1, 2>  surface = pane }",
         false},
        {"quad, a dent in a pane",
         QUAD
         "difference { box { from = <-30, 8, -30>  to = <30, 12, 30> } sphere { center = <5, 13, 0>  radius = 5 }  "
         "interior = glass }",
         true},
        {"quad, half hidden",
         QUAD "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }\n"
              "box { from = <2, 4, -30>  to = <4, 6, 30>  surface = surface { albedo = .5 } }",
         false},
        {"quad, flint", QUAD "box { from = <-30, 8, -30>  to = <30, 18, 30>  interior = flint }", false},
        {"quad, under flint", QUAD "box { from = <-30, -1, -30>  to = <30, 12, 30>  interior = flint }", true},
        {"quad, a hollow block",
         QUAD "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass  priority = 1 }\n"
              "box { from = <-29, 9, -29>  to = <29, 13, 29>  interior = hole  priority = 2 }",
         false},
        {"ball, a pane",
         "light { shape = sphere  from = <5, 24, 0>  radius = 6  radiance = 4 }\n"
         "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }",
         false},
        {"ball within glass",
         "light { shape = sphere  from = <5, 24, 0>  radius = 6  radiance = 4 }\n"
         "box { from = <-30, 12, -30>  to = <30, 44, 30>  interior = glass }",
         true},
        {"disc into a cone, water",
         "light { shape = disc  from = <5, 24, 0>  to = <0, 0, 0>  radius = 9  angle = 60deg  radiance = 2 }\n"
         "box { from = <-30, -1, -30>  to = <30, 12, 30>  interior = water }",
         false},
        {"disc into a narrow cone, a block aslant, beside the cone",
         "light { shape = disc  from = <4, 34, 0>  to = <4, 0, 0>  radius = 6  angle = 30deg  radiance = 4 }\n"
         "box { from = <-30, 0, -30>  to = <30, 12, 30>  rotate(<0, 0, 40>)  translate(<0, 12, 0>)  interior = glass }",
         true},
        {"quad, water, hidden in the straight way",
         "light { from = <30, 40, 0>  to = <0, 0, 0>  size = <6, 6>  radiance = 40 }\n"
         "box { from = <-50, -1, -50>  to = <50, 18, 50>  interior = water }\n"
         "box { from = <10.5, 6, -9>  to = <10.6, 14, 9>  surface = surface { albedo = .2 } }",
         true},
        {"quad, water with a leaf on it",
         QUAD
         "box { from = <-30, -1, -30>  to = <30, 12, 30>  interior = water }\n"
         "mesh { positions = [<1, 12, -3>, <4, 12, -3>, <4, 12, 5>, <1, 12, 5>]  triangles = [<0, 1, 2>, <0, 2, 3>]"
         "  surface = surface { albedo = .3 } }",
         false},
        {"quad, a mask",
         "light { from = <0, 30, 0>  to = <0, 0, 0>  size = <14, 14>  radiance = 8 }\n"
         "box { from = <-9, 10, -9>  to = <9, 10.01, 9>  surface = surface { weight = checker { scale(2.2) "
         "translate(<1.1, 0, 1.1>) }  mix = [pane, surface { albedo = 0 }] } }",
         false},
        {"quad, a painted sheet",
         "light { from = <0, 30, 0>  to = <0, 0, 0>  size = <14, 14>  radiance = 8 }\n"
         "box { from = <-9, 10, -9>  to = <9, 10.01, 9>  surface = surface { thin = true  ior = 1.5  roughness = 0  "
         "transmission = checker { from = 0  to = 1  scale(2.2)  translate(<1.1, 0, 1.1>) } } }",
         false},
        {"shining box, a pane",
         "box { from = <0, 20, 0>  to = <8, 28, 6>  rotate(<10, 20, 30>)  surface = surface { albedo = .5  emission = "
         "1  radiance = 4 } }\n"
         "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }",
         false},
        {"shining ring, a pane",
         "torus { radius = 9  tube = 4  translate(<0, 24, 0>)  surface = surface { albedo = .5  emission = 1  radiance "
         "= 2 } }\n"
         "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }",
         false},
        {"a painted ball that shines, a pane",
         "def part(p) = p.y > 24 ? .2 : 1\n"
         "sphere { center = <0, 24, 0>  radius = 6  surface = surface { albedo = 0  emission = part  radiance = 4 } }\n"
         "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }",
         false},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) expect_alike(&cases[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points),          cmocka_unit_test(beams),          cmocka_unit_test(under_water),
        cmocka_unit_test(balls_as_points), cmocka_unit_test(beams_in_water), cmocka_unit_test(off_a_block),
        cmocka_unit_test(through_a_prism), cmocka_unit_test(as_by_chance),
    };
    return cmocka_run_group_tests_name("lamps", tests, NULL, NULL);
}
