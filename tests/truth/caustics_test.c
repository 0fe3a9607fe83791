/* caustics_test.c - small lights behind glass: with the guide of photons and without the mean is the same, closed forms
 * are met that chance alone never would, and noise is less.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

typedef struct Measured {
    Estimate mean;
    GuideStats guide;
    double cpu_s;
} Measured;

/* The mean of a picture that shows the same everywhere. */
static Measured measure(const char *text, uint32_t samples, SceneCaustics caustics)
{
    enum { PICTURE = 16 };
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, samples);
    settings.caustics = caustics;
    truth_render(&scene, &settings, 0, &picture);
    assert_int_equal(picture.stats.nesting_faults, 0);
    Measured measured = {truth_mean(&picture, -1), picture.stats.guide, picture.stats.cpu_seconds};
    truth_clear(&picture);
    fixture_clear(&scene);
    return measured;
}

#define MEDIA                                                                                                          \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass { ior = 1.5  state = solid } medium water { ior = 1.33  state = liquid  absorption = .002 }\n"       \
    "medium lead { ior = cauchy(1.6, .02)  state = solid }\n"
/* A camera that looks at one point of the floor, from the side. */
#define LOOK "camera { from = <0, 77, 290>  to = <0, 0, 0>  fov = .001deg }\n"
#define FLOOR "ground { surface = surface { albedo = .05 } }\n"

/* ---- closed forms ---- */

/* E: of the sun that the scenes below have. */
static const double sun_irradiance = 10;
#define SUN "light { shape = \"distant\"  from = <0, 1, 0>  to = <0, 0, 0>  angle = .53deg  power = 10 }\n"

static void closed_forms(void **state)
{
    (void)state;
    double glass = truth_fresnel(1, 1, 1.5), thin = truth_fresnel(1, 1, 1.1);
    double albedo = .05 / TRUTH_PI;
    /* a slab: all internal reflections add up to (1 - R) / (1 + R); what is not reflected in it is found by looking */
    Measured slab = measure(MEDIA LOOK FLOOR SUN "box { interior = glass  from = <-6, 60, -6>  to = <6, 66, 6> }\n",
                            1024, CAUSTICS_AUTOMATIC);
    truth_expect("floor under a slab of glass, in the sun: E (1-R)/(1+R)",
                 albedo * sun_irradiance * (1 - glass) / (1 + glass), slab.mean, 4, 0.004);
    /* a ball of index n and radius r is a lens of focal length n r / (2 (n - 1)) about its centre; what it sends to the axis
     * at a distance d is denser by (1 - d / f)^-2 */
    Measured ball = measure(MEDIA LOOK FLOOR SUN "medium thin { ior = 1.1 state = solid }\n"
                                                 "sphere { interior = thin  center = <0, 12, 0>  radius = 10 }\n",
                            256, CAUSTICS_AUTOMATIC);
    double focal = 1.1 * 10 / (2 * 0.1), denser = 1 / ((1 - 12 / focal) * (1 - 12 / focal));
    truth_expect("floor on the axis of a ball of index 1.1, in the sun",
                 albedo * sun_irradiance * (1 - thin) * (1 - thin) * denser, ball.mean, 4, 0.01);
    assert_true(ball.guide.landed > 0);
    /* photons go through holes, which are a part of a mix; the box has two sides */
    Measured lace = measure(MEDIA LOOK FLOOR SUN
                            "medium thin { ior = 1.1 state = solid }\n"
                            "sphere { interior = thin  center = <0, 12, 0>  radius = 10 }\n"
                            "box { from = <-19, 70, -19>  to = <19, 70.001, 19>  surface = surface { weight = .3\n"
                            "  mix = [surface { thin = true  transmission = 1  ior = 1  specular = 0 },\n"
                            "         surface { albedo = 0 }] } }\n",
                            1024, CAUSTICS_AUTOMATIC);
    assert_true(lace.guide.landed > 0);
    truth_expect("floor under such a ball behind holes",
                 albedo * sun_irradiance * (1 - thin) * (1 - thin) * denser * .7 * .7, lace.mean, 4, 0.01);
}

/* ---- with and without ---- */

static const struct {
    const char *what, *text;
    uint32_t with, without;
} lit[] = {
    /* probes find little there. By as many samples each: what is evenly spread gets better by more than their number */
    {"a matte table beside a ball of glass under a lamp",
     MEDIA "ground { surface = surface { albedo = .7 } } environment { color = .02 }\n"
           "sphere { interior = glass  center = <0, 14, 0>  radius = 10 }\n"
           "light { shape = \"sphere\"  from = <10, 80, 20>  radius = 8  radiance = 50 }\n"
           "camera { from = <60, 200, -300>  to = <-1, 0, -3>  fov = .001deg }\n",
     800, 800},
    {"the floor of a pool under a tilted sun, with dispersion",
     MEDIA "ground { surface = surface { albedo = .5 } } environment { color = .1 }\n"
           "light { shape = \"distant\"  from = <.5, 1, .2>  to = <0, 0, 0>  angle = 12deg  power = 5 }\n"
           "box { interior = lead  from = <-100, -1, -100>  to = <100, 40, 100> }\n"
           "camera { from = <0, 200, 20>  to = <0, 0, 0>  fov = .001deg }\n",
     200, 3000},
    {"a lamp in a bulb of glass in fog",
     MEDIA "medium fog { ior = 1  scattering = .01  phase = hg(.3)  state = gas }\n"
           "box { interior = fog  from = <-100, -1, -100>  to = <100, 100, 100> }\n"
           "ground { surface = surface { albedo = .5 } }\n"
           "sphere { interior = glass  center = <0, 40, 0>  radius = 12 }\n"
           "sphere { interior = air  center = <0, 40, 0>  radius = 10 }\n"
           "sphere { center = <0, 40, 0>  radius = 6  surface = surface { albedo = 0  emission = 1  radiance = 20 } }\n"
           "camera { from = <60, 80, 50>  to = <30, 10, 20>  fov = .001deg }\n",
     1000, 5000},
    {"a floor before a foil that is matte in part",
     MEDIA "ground { surface = surface { albedo = .5 } } environment { color = .05 }\n"
           "box { from = <-20, 0, -1>  to = <20, 30, 0>  surface = surface { weight = .2\n"
           "  mix = [surface { metal = gold  roughness = 0 }, surface { albedo = .2 }] } }\n"
           "light { shape = \"sphere\"  from = <0, 60, 80>  radius = 9  radiance = 50 }\n"
           "camera { from = <60, 150, 200>  to = <0, 0, 27>  fov = .001deg }\n",
     400, 4000},
    {"a table of rough metal behind a glass",
     MEDIA "ground { surface = surface { metal = gold  roughness = .5 } } environment { color = .05 }\n"
           "cylinder { interior = glass  from = <0, .5, 0>  to = <0, 40, 0>  radius = 12 }\n"
           "light { shape = \"sphere\"  from = <80, 50, 0>  radius = 9  radiance = 50 }\n"
           "camera { from = <-150, 100, 50>  to = <-22, 0, 0>  fov = .001deg }\n",
     1600, 1600},
    {"a floor under a frosted globe with a lamp in it",
     MEDIA
     "surface frost { roughness = .35 } ground { surface = surface { albedo = .5 } } environment { color = .05 }\n"
     "sphere { interior = glass  surface = frost  radius = 40  center = <0, 60, 0> }\n"
     "sphere { interior = air  surface = frost  radius = 37  center = <0, 60, 0> }\n"
     "light { shape = \"sphere\"  from = <0, 60, 0>  radius = 4  radiance = 90 }\n"
     "camera { from = <-150, 100, 50>  to = <-32, 0, 0>  fov = .001deg }\n",
     500, 3000},
    {"a frosted globe that one looks at, with a lamp in it",
     MEDIA "surface frost { roughness = .3 } ground { surface = surface { albedo = .5 } } environment { color = .05 }\n"
           "sphere { interior = glass  surface = frost  radius = 40  center = <0, 60, 0> }\n"
           "sphere { interior = air  radius = 38  center = <0, 60, 0> }\n"
           "light { shape = \"sphere\"  from = <0, 60, 0>  radius = 3  radiance = 90 }\n"
           "camera { from = <0, 60, 300>  to = <9, 60, 0>  fov = .001deg }\n",
     500, 8000},
    /* lamps that are surfaces of shapes, of which a ring stands in its own light */
    {"a floor under a bulb, with a rod in it that glows",
     MEDIA "surface hot { emission = 1  radiance = 400 } ground { surface = surface { albedo = .5 } }\n"
           "environment { color = .05 }\n"
           "ellipsoid { interior = glass  radii = <14, 30, 14>  translate(<0, 50, 0>) }\n"
           "ellipsoid { interior = air  radii = <13, 29, 13>  translate(<0, 50, 0>) }\n"
           "capsule { from = <0, 40, 0>  to = <0, 60, 0>  radius = 1  surface = hot }\n"
           "camera { from = <-150, 100, 50>  to = <-32, 0, 0>  fov = .001deg }\n",
     500, 6000},
    {"a floor under a ball of glass and a ring that glows",
     MEDIA "surface hot { emission = 1  radiance = 100 } ground { surface = surface { albedo = .5 } }\n"
           "environment { color = .05 }\n"
           "sphere { interior = glass  center = <0, 20, 0>  radius = 15 }\n"
           "torus { radius = 12  tube = 1.5  surface = hot  rotate(x, 20)  translate(<0, 70, 0>) }\n"
           "camera { from = <-150, 100, 50>  to = <-4, 0, 0>  fov = .001deg }\n",
     500, 6000},
    {"a table with a coat, seen through a glass with a drink in it",
     MEDIA "ground { surface = surface { albedo = .6  ior = 1.5  roughness = .1 } } environment { color = .05 }\n"
           "cylinder { interior = glass  from = <0, .5, 0>  to = <0, 40, 0>  radius = 15 }\n"
           "cylinder { interior = water  from = <0, 4, 0>  to = <0, 30, 0>  radius = 12.1 }\n"
           "cylinder { interior = air  from = <0, 30, 0>  to = <0, 41, 0>  radius = 12 }\n"
           "sphere { interior = air  center = <2, 20, 3>  radius = 3 }\n"
           "light { shape = \"sphere\"  from = <60, 90, 0>  radius = 12  radiance = 50 }\n"
           "camera { from = <150, 120, 40>  to = <-20, 0, 0>  fov = .001deg }\n",
     600, 4000},
    /* scattered some thirty times on its way, and at each place asked for a direction */
    {"foam in a shell of glass",
     MEDIA "medium foam { ior = 1  scattering = .9 / 1mm  phase = hg(.4)  state = liquid }\n"
           "sphere { interior = glass  radius = 30  center = <0, 30, 0> } sphere { interior = foam  radius = 27  "
           "center = <0, 30, 0> }\n"
           "light { from = <300, 400, 100>  to = <0, 30, 0>  size = <100, 300>  radiance = 7 } environment { color "
           "= .1 }\n"
           "camera { from = <0, 60, 200>  to = <0, 28, 0>  fov = 5deg }\n",
     150, 150},
    {"smoke in the cone of light behind a ball of glass",
     MEDIA "medium smoke { ior = 1  scattering = <.003, .004, .006>  absorption = .002  phase = hg(.3)  state = gas }\n"
           "box { interior = smoke  from = <-100, -60, -100>  to = <100, 100, 100> }\n"
           "sphere { interior = glass  center = <0, 30, 0>  radius = 12 }\n"
           "light { shape = \"sphere\"  from = <0, 90, 0>  radius = 10  radiance = 50 }\n"
           "camera { from = <150, 20, 60>  to = <0, 9, 0>  fov = .001deg }\n",
     500, 8000},
    {"a beam through flint, in two kinds of smoke that vary and mix",
     MEDIA "def f(p) = max(0, noise(p / 8mm) + .4) def g(p) = max(0, 1 - length(p - <0, -20mm, 0>) / 60mm)\n"
           "medium grey { mixes = true  scattering = .02  phase = hg(.3)\n"
           "  density = volume { function = f  from = vec3(-80)  to = vec3(80) } }\n"
           "medium blue { mixes = true  scattering = <.01, .02, .06>  absorption = .01  phase = rayleigh()\n"
           "  density = volume { function = g  from = vec3(-80)  to = vec3(80) } }\n"
           "box { interior = grey  from = vec3(-80)  to = vec3(80) }\n"
           "box { interior = blue  from = <-60, -70, -70>  to = <60, 60, 60> }\n"
           "sphere { interior = lead  center = <0, 20, 0>  radius = 14 }\n"
           "light { shape = disc  radius = 9  from = <60, 110, 0>  to = <0, 20, 0>  angle = 25  radiance = 90 }\n"
           "camera { from = <150, 20, 60>  to = <-8, 0, 0>  fov = .001deg }\n",
     500, 8000},
    {"the sun in a pool of thin milk, past a ball of glass and a bubble",
     MEDIA "medium milk { ior = 1.33  scattering = .004  phase = hg(.6)\n"
           "  absorption = <.004, .002, .001>  state = liquid }\n"
           "ground { surface = surface { albedo = .5 } } environment { color = .05 }\n"
           "light { shape = \"distant\"  from = <.5, 1, .2>  to = <0, 0, 0>  angle = 8deg  power = 5 }\n"
           "box { interior = milk  from = <-300, -1, -300>  to = <300, 60, 300> }\n"
           "sphere { interior = glass  center = <0, 60, 0>  radius = 25 }\n"
           "sphere { interior = air  center = <10, 30, 8>  radius = 9 }\n"
           "camera { from = <-80, 200, 120>  to = <0, 0, 0>  fov = .001deg }\n",
     500, 6000},
    /* no lamp is seen straight from what scatters */
    {"broth in a glass under a lamp, with haze in a bubble",
     MEDIA "medium haze { ior = 1  scattering = .02 }\n"
           "medium broth { ior = 1.34  scattering = <.01, .006, .003>  phase = hg(.5)  absorption = <.001, .004, .01>\n"
           "  state = liquid }\n"
           "cylinder { interior = glass  from = <0, 0, 0>  to = <0, 60, 0>  radius = 20 }\n"
           "cylinder { interior = broth  from = <0, 4, 0>  to = <0, 61, 0>  radius = 18 }\n"
           "sphere { interior = haze  center = <3, 30, 2>  radius = 7 }\n"
           "light { shape = \"sphere\"  from = <60, 90, 30>  radius = 6  radiance = 50 } environment { color = .02 }\n"
           "camera { from = <-30, 60, 140>  to = <0, 25, 0>  fov = .001deg }\n",
     600, 6000},
    /* probes are led to what is mirrored on the way */
    {"a floor in what a ball of water mirrors within, with dispersion",
     MEDIA "medium rain { ior = cauchy(1.324, .0031)  state = liquid }\n"
           "ground { surface = surface { albedo = .5 } } environment { color = .01 }\n"
           "sphere { interior = rain  center = <0, 14, 0>  radius = 10 }\n"
           "light { shape = \"sphere\"  from = <160, 70, 0>  radius = 10  radiance = 300 }\n"
           "camera { from = <80, 120, -200>  to = <25, 0, 12>  fov = 2deg }\n",
     1000, 15000},
    {"the same of glass, with bubbles in it and a drink around it",
     MEDIA "ground { surface = surface { albedo = .5 } } environment { color = .01 }\n"
           "sphere { interior = glass  center = <0, 14, 0>  radius = 10 }\n"
           "sphere { interior = air  center = <-4, 15, 2>  radius = 3 } sphere { interior = air  center = <3, 11, -2>  "
           "radius = 2 }\n"
           "box { interior = water  from = <-40, -1, -40>  to = <40, 30, 40> }\n"
           "light { shape = \"sphere\"  from = <160, 170, 0>  radius = 20  radiance = 300 }\n"
           "camera { from = <80, 190, -80>  to = <18, 0, 6>  fov = 2deg }\n",
     1000, 10000},
    /* little of the light is the photons', and most comes by several bounces */
    {"between a floor and a mirror that lets half through",
     MEDIA "ground { surface = surface { albedo = .8 } }\n"
           "surface half { thin = true  transmission = .5  albedo = .6  ior = 1.5  roughness = 0 }\n"
           "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = half }\n"
           "light { shape = \"sphere\"  from = <5, 18, 0>  radius = 8  radiance = 2 }\n"
           "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg }\n",
     500, 500},
};

static void same_mean(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(lit); i++) {
        Measured with = measure(lit[i].text, lit[i].with, CAUSTICS_ON);
        Measured without = measure(lit[i].text, lit[i].without, CAUSTICS_OFF);
        assert_true(with.guide.landed > 0);
        assert_int_equal(without.guide.followed, 0);
        double ratio = without.mean.error / with.mean.error;
        truth_alike(lit[i].what, without.mean, with.mean, 4, 0.04);
        double a_sample = ratio * ratio * lit[i].without / lit[i].with;
        printf("    %-66s %.1f times less variance a sample, %.1f at equal times\n", "", a_sample,
               ratio * ratio * without.cpu_s / with.cpu_s);
        /* Probes only add to what is found; the rest is the chance of 256 pixels. Over 16 seeds the least were 0.64 of the
         * matte table and 0.9 of the metal, whose single bright paths had made it 0.57 to 2.5 by fewer samples. */
        assert_true(a_sample > 1.0 / 3);
    }
}

/* ---- seas ---- */

/* A sea over a bottom, in the sun, without end or as a box so large that nothing tells. Not quite flat: else looks find all. */
#define WAVES "  surface = surface { bump = noise { scale(900) }  bump_height = .001 }"
#define SEA "plane { distance = 6000  interior = water" WAVES " }\n"
#define LARGE_BOX "box { interior = water  from = <-3e6, -1000, -3e6>  to = <3e6, 6000, 3e6>" WAVES " }\n"
#define SEA_LIGHT                                                                                                      \
    "medium water { ior = 1.333  state = liquid } ground { surface = surface { albedo = .5 } }\n"                      \
    "environment { color = .1 }\n"                                                                                     \
    "light { shape = distant  from = <.5, 1, .3>  to = <0, 0, 0>  angle = 1deg  power = 5 }\n"

/* The same, as the total of a picture that shows other things here and there. */
static Measured measure_total(const char *begin, const char *water, const char *end, uint32_t samples,
                              SceneCaustics caustics)
{
    enum { PICTURE = 24 };
    char text[2000];
    Fixture scene;
    Picture picture;
    assert_in_range(snprintf(text, sizeof text, "%s%s%s", begin, water, end), 1, sizeof text - 1);
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, samples);
    settings.caustics = caustics;
    truth_render(&scene, &settings, 0, &picture);
    assert_int_equal(picture.stats.nesting_faults, 0);
    Measured measured = {truth_total(&picture), picture.stats.guide, picture.stats.cpu_seconds};
    truth_clear(&picture);
    fixture_clear(&scene);
    return measured;
}

/* Nothing bounded is there to say how far photons are to go, or it is far from where the camera looks: what the camera sees does. */
static void seas_without_end(void **state)
{
    (void)state;
    const struct {
        const char *what, *camera;
    } views[] = {
        {"a sea, straight down from 4 m", "camera { from = <0, 4000, 0>  to = <0, 0, -1>  fov = 40 }\n"},
        {"a sea, up to 70 m away from 9 m, with a ball",
         "sphere { radius = 800 surface = surface { albedo = .5 } }\n"
         "camera { from = <0, 9000, 20000>  to = <0, 0, 0>  fov = 30 }\n"},
        {"a sea, from within", "camera { from = <0, 4000, 0>  to = <0, 0, -20000>  fov = 30 }\n"},
        {"a sea, up to its horizon", "camera { from = <0, 7600, 0>  to = <0, 7000, -3000>  fov = 60 }\n"},
    };
    for (size_t i = 0; i < COUNT_OF(views); i++) {
        Measured endless = measure_total("meniscus 1.0 unit mm\n" SEA_LIGHT, SEA, views[i].camera, 200, CAUSTICS_ON),
                 box = measure_total("meniscus 1.0 unit mm\n" SEA_LIGHT, LARGE_BOX, views[i].camera, 200, CAUSTICS_ON);
        assert_true(endless.guide.landed > 0);
        truth_alike(views[i].what, box.mean, endless.mean, 4, 0.03);
        printf("    %-66s %.2g times the error of a box\n", "", endless.mean.error / box.mean.error);
        assert_true(endless.mean.error < 0.01 * endless.mean.mean);
    }
}

/* A lake 40 or 200 m wide with waves of some millimetres, of which the picture shows some 4 m, for what it does not show is dark: photons
 * go where it looks, and find what chance does, of a wide sun, and of a small one with no more noise than in a pond. */
#define LAKE_LIGHT(angle)                                                                                              \
    "meniscus 1.0 unit mm\nmedium water { ior = 1.333  state = liquid } environment { color = .1 }\n"                  \
    "def seen(p) = max(abs(p.x), abs(p.z)) < 2500 ? .5 : .001\n"                                                       \
    "ground { surface = surface { albedo = seen } }\n"                                                                 \
    "light { shape = distant  from = <.5, 1, .3>  to = <0, 0, 0>  angle = " angle "  power = 5 }\n"
#define LAKE(wide)                                                                                                     \
    "box { interior = water  from = <-" wide ", -1000, -" wide ">  to = <" wide ", 3000, " wide ">\n"                  \
    "  surface = surface { bump = noise { scale(900) }  bump_height = 40 } }\n"

static void wide_lakes(void **state)
{
    (void)state;
    const char *camera = "camera { from = <0, 7600, 0>  to = <0, 0, 1>  fov = 40 }\n";
    const struct {
        const char *what, *water;
    } lakes[] = {{"a lake of 40 m", LAKE("20000")}, {"a lake of 200 m", LAKE("100000")}};
    Measured pond = measure_total(LAKE_LIGHT(".5deg"), LAKE("5000"), camera, 200, CAUSTICS_ON);
    for (size_t i = 0; i < COUNT_OF(lakes); i++) {
        Measured of_wide_sun = measure_total(LAKE_LIGHT("6deg"), lakes[i].water, camera, 200, CAUSTICS_ON),
                 by_chance = measure_total(LAKE_LIGHT("6deg"), lakes[i].water, camera, 4000, CAUSTICS_OFF),
                 of_sun = measure_total(LAKE_LIGHT(".5deg"), lakes[i].water, camera, 200, CAUSTICS_ON);
        truth_alike(lakes[i].what, by_chance.mean, of_wide_sun.mean, 4, 0.03);
        printf("    %-66s %.2g times the error of a pond\n", "", of_sun.mean.error / pond.mean.error);
        assert_true(of_sun.mean.error < 3 * pond.mean.error);
    }
}

/* ---- bits ---- */

static void any_threads_and_idle_scenes(void **state)
{
    (void)state;
    const char *text = MEDIA FLOOR SUN "sphere { interior = glass  center = <0, 14, 0>  radius = 10 }\n"
                                       "camera { from = <0, 100, 100>  to = <0, 0, 0>  fov = 20 }\n";
    Fixture scene;
    Picture one, three;
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(32, 4);
    truth_render(&scene, &settings, 1, &one);
    truth_render(&scene, &settings, 3, &three);
    assert_true(one.stats.guide.landed > 1000);
    assert_true(one.stats.guide.landed == three.stats.guide.landed && one.stats.guide.bytes == three.stats.guide.bytes);
    assert_true(truth_largest_difference(&one, &three) == 0);
    truth_clear(&one);
    truth_clear(&three);
    fixture_clear(&scene);
    /* an even sky, and lamps as large as the sky, are found without: no photon is followed far */
    const char *const idle[] = {
        MEDIA LOOK FLOOR "environment { color = 1 } sphere { interior = glass  center = <0, 14, 0>  radius = 10 }\n",
        MEDIA LOOK FLOOR "environment { color = .2 } sphere { interior = glass  center = <0, 14, 0>  radius = 10 }\n"
                         "light { from = <0, 60, 0>  to = <0, 0, 0>  size = <90, 90>  radiance = 3 }\n",
        MEDIA LOOK FLOOR "light { from = <0, 60, 0>  to = <0, 0, 0>  size = <2, 2>  radiance = 3 }\n",
    };
    for (size_t i = 0; i < COUNT_OF(idle); i++)
        assert_int_equal(measure(idle[i], 4, CAUSTICS_AUTOMATIC).guide.landed, 0);
}

/* The sun comes through a slit to a prism of flint and makes a rainbow on a wall: 3 of 1,600 pixels, which the trial's paths hardly
 * meet, and where a probe seldom finds its colour. */
static const char rainbow[] =
    "meniscus 1.0 unit cm\n"
    "use \"std/media.mns\" as media\n"
    "prism { outline = [<-2, -1>, <2, -1>, <0, 2.46>]  from = -2  to = 2  interior = media.n_sf11 }\n"
    "difference {\n"
    "  box { from = <-6, -2, -60>  to = <-5.9, 30, 60> } box { from = <-7, -1.5, -2.65>  to = <-5, 1, -2.45> }\n"
    "  surface = surface { albedo = 0 } }\n"
    "box { from = <10, -5, -20>  to = <10.2, 5, 20>  surface = surface { albedo = .9 } }\n"
    "box { from = <-25, -2.2, -20>  to = <15.2, -2, 20>  surface = surface { albedo = .9 } }\n"
    "light { shape = distant  from = <-20, .4, -13>  to = <0, 0, 0>  power = 60 } environment { color = .01 }\n"
    "camera { from = <0, 20, 22>  to = <2, 0, -2>  fov = 55 }\n";

/* All that comes through the lens lands on one or two pixels; the lens is what two balls have in common, a hundredth of the box around
 * each. */
static const char burning_glass[] =
    "meniscus 1.0 unit cm\n"
    "use \"std/media.mns\" as media\n"
    "intersection { interior = media.n_bk7  sphere { center = <0, 38.9, 0>  radius = 20 }\n"
    "               sphere { center = <0, -.1, 0>  radius = 20 } }\n"
    "ground { surface = surface { albedo = .5 } } environment { color = .25 }\n"
    "light { shape = distant  from = <0, 100, 0>  to = <0, 0, 0>  power = 3 }\n"
    "camera { from = <10, 30, 50>  to = <0, 9, 0>  fov = 34 }\n";

/* Photons land on what returns nothing. */
static const char black_table[] =
    MEDIA "ground { surface = surface { albedo = 0  ior = 1.4  roughness = .05 } } environment { color = .3 }\n"
          "sphere { center = <0, 30, 0>  radius = 30  interior = glass }\n"
          "light { shape = distant  from = <5, 10, 2>  to = <0, 0, 0>  power = 5 }\n"
          "camera { from = <0, 80, 200>  to = <0, 30, 0>  fov = 40 }\n";

/* A guide is used where it pays: the sun through a drink and a window; not where the camera sees little of what it finds.
 * In some, cells hold one photon, or a row of them. */
static void guides_unasked(void **state)
{
    (void)state;
    const struct {
        const char *what;
        TruthInput input;
        bool guided;
    } cases[] = {{"whisky in the sun", {.file = "examples/whisky-sun.mns"}, true},
                 {"minirt", {.file = "examples/minirt.mns"}, true},
                 {"a rainbow on few pixels", {.text = rainbow}, true},
                 {"the focus of a burning glass", {.text = burning_glass}, true},
                 {"a light bulb", {.file = "examples/light-bulb.mns"}, false},
                 {"a black table", {.text = black_table}, false},
                 {"finishes", {.file = "examples/finishes.mns"}, false}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture scene;
        Picture picture;
        TruthInput input = cases[i].input;
        input.policy = NEST_AUTOMATIC;
        truth_open(&scene, input);
        RenderSettings settings = truth_settings(40, 4);
        settings.caustics = CAUSTICS_AUTOMATIC;
        truth_render(&scene, &settings, 0, &picture);
        if ((picture.stats.guide.landed > 0) != cases[i].guided)
            fail_msg("%s has %s guide", cases[i].what, cases[i].guided ? "no" : "a");
        truth_clear(&picture);
        fixture_clear(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_forms),
        cmocka_unit_test(same_mean),
        cmocka_unit_test(seas_without_end),
        cmocka_unit_test(wide_lakes),
        cmocka_unit_test(any_threads_and_idle_scenes),
        cmocka_unit_test(guides_unasked),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
