/* airlight_test.c - light on its way through media: what hulls that shine give to their surroundings, and what haze
 * scatters of lamps, against closed forms and quadrature; and the ways to find it against each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#define FLOOR                                                                                                          \
    "meniscus 1.0 unit m ground { surface = surface { albedo = .8 } }\n"                                               \
    "camera { from = <0, .1, 4.5>  to = <0, 0, 0>  fov = .01deg }\n"

/* ---- hulls that shine ---- */

/* A ball of clear gas shines in all directions as much for each volume. What a small surface gets from it falls with the
 * squared distance of each of its parts and with the cosine, as the pull of its mass would: as if all were in the middle. */
static void shining_ball(void **state)
{
    (void)state;
    static const struct {
        const char *what, *scene;
        double h, volume;
    } cases[] = {
        {"floor under a ball of gas that shines", "sphere { interior = gas  center = <0, 3, 0>  radius = 1 }", 3,
         4 * TRUTH_PI / 3},
        {"the same, nearly touching the floor", "sphere { interior = gas  center = <0, 1.05, 0>  radius = 1 }", 1.05,
         4 * TRUTH_PI / 3},
        {"the same, in haze of its own that mixes",
         "medium thin { mixes = true } box { interior = thin  size = <10, 10, 10> }"
         "sphere { interior = gas  center = <0, 3, 0>  radius = 1 }",
         3, 4 * TRUTH_PI / 3},
        {"a shell: a ball with a hole",
         "difference { sphere { center = <0, 3, 0>  radius = 1 } sphere { center = <0, 3, 0>  radius = .9 }"
         "  interior = gas }",
         3, 4 * TRUTH_PI / 3 * (1 - .729)},
        {"a ball with another hull in its middle",
         "medium air2 { ior = 1  priority = 5 } sphere { interior = gas  center = <0, 3, 0>  radius = 1 }"
         "sphere { interior = air2  center = <0, 3, 0>  radius = .7 }",
         3, 4 * TRUTH_PI / 3 * (1 - .343)},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "medium gas { ior = 1  emission = 1  radiance = 2 } %s", cases[i].scene);
        double expected = 0.8 / TRUTH_PI * 2 * cases[i].volume / (cases[i].h * cases[i].h);
        truth_expect(cases[i].what, expected, truth_measure(text, NULL, 256, false), 4, 0.01);
    }
}

/* The same where no closed form is at hand: found by light sampling as well, and by chance alone. */
static void shining_hulls_agree(void **state)
{
    (void)state;
    static const struct {
        const char *what, *scene;
    } cases[] = {
        {"a dense bar", "medium gas { ior = 1  emission = 1  absorption = <1, 3, 8>  scattering = .5 }"
                        "box { interior = gas  size = <.5, 2, .5>  rotate(<30, 20, 10>)  translate(<1, 1.5, 0>) }"},
        {"a flame, hotter above, in fog",
         "def t(p) = 1500 + 200 * p.y medium gas { mixes = true  emission = blackbody(1700)  absorption = .1"
         "  temperature = volume { function = t  from = <-3, -3, -3>  to = <3, 3, 3>  cells = 12 } }"
         "medium fog { ior = 1  scattering = .1 } box { interior = fog  from = <-5, -1, -5>  to = <5, 6, 5> }"
         "cone { interior = gas  from = <0, .5, 0>  to = <0, 2, 0>  radius_from = .6  radius_to = 0 }"},
        {"two of them, one small and one in glass", "medium gas { ior = 1  emission = 1 } medium glass { ior = 1.5 }"
                                                    "sphere { interior = gas  center = <.5, .5, 0>  radius = .3 }"
                                                    "sphere { interior = glass  center = <-1, 1.2, 0>  radius = 1 }"
                                                    "sphere { interior = gas  center = <-1, 1.2, 0>  radius = .8 }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "%s", cases[i].scene);
        Estimate sought = truth_measure(text, NULL, 512, false), chance = truth_measure(text, NULL, 1024, true);
        truth_expect(cases[i].what, 1, truth_ratio(sought, chance), 4, 0.03);
    }
}

/* ---- light that haze scatters ---- */

/* A mean of a small picture that shows the same everywhere; airlight: looked for along the way. */
static Estimate measure(const char *text, uint32_t samples, bool airlight)
{
    RenderSettings settings = truth_small(samples);
    settings.no_airlight = !airlight;
    return truth_measure_as(text, NULL, &settings);
}

typedef struct Haze {
    double scattering, absorption, g;
    double begin, end;    /* the line of sight in it */
    double across, along; /* from the line's start to the lamp */
    double around;        /* as far as the haze reaches around the lamp; INFINITY: everywhere */
} Haze;

/* The airlight integral: light of a lamp of intensity 1 that is scattered once towards the line's start,
 *     integral of s p(cos) e^-(x t) e^-(x d) / d^2 dt,    d the distance of t from the lamp,
 * by Simpson's rule in the angle under which the lamp sees the line. x: scattering and absorption. */
static double airlight(const Haze *haze)
{
    enum { STEPS = 20000 };
    const double x = haze->scattering + haze->absorption, g = haze->g;
    double first = atan((haze->begin - haze->along) / haze->across),
           last = atan((haze->end - haze->along) / haze->across);
    double sum = 0;
    for (int i = 0; i <= STEPS; i++) {
        double angle = first + (last - first) * i / STEPS, from_foot = haze->across * tan(angle);
        double t = haze->along + from_foot, d = hypot(haze->across, from_foot);
        /* light travels from the lamp to the place, then back to the eye, towards -t */
        double cosine = -from_foot / d;
        double phase = (1 - g * g) / (4 * TRUTH_PI * pow(1 + g * g - 2 * g * cosine, 1.5));
        double passes = exp(-x * (t - haze->begin) - x * fmin(d, haze->around));
        double weight = i == 0 || i == STEPS ? 1 : i % 2 ? 4 : 2;
        sum += weight * phase * passes; /* dt / d^2 is the angle's differential over the distance across */
    }
    return haze->scattering / haze->across * sum * (last - first) / STEPS / 3;
}

#define EYE " camera { from = <0, 0, 0>  to = <0, 0, -1>  fov = .001deg }"

/* Lamps without size in haze so thin, or with so much more absorption, that what is scattered twice does not matter. */
static void lamps_in_haze(void **state)
{
    (void)state;
    static const struct {
        const char *what, *scene;
        Haze haze;
        double resolution;
    } cases[] = {
        {"a lamp in a slab",
         "box { interior = haze  from = <-90, -90, -9>  to = <90, 90, -1> }",
         {2e-5, .02, 0, 1, 9, .5, 4, INFINITY},
         0.01},
        {"crossed by hulls that the haze outranks",
         "medium water { ior = 1.33 } medium outer { ior = 1.1 } box { interior = outer  from = <-5, -5, -7>  to = <5, "
         "5, -1.5>"
         "  priority = -2 } sphere { interior = water  center = <0, 0, -4>  radius = .8  priority = -1 }"
         "box { interior = haze  from = <-90, -90, -9>  to = <90, 90, -1> }",
         {2e-5, .02, 0, 1, 9, .5, 4, INFINITY},
         0.01},
        {"close to the line of sight, forward",
         "box { interior = haze  from = <-90, -90, -9>  to = <90, 90, -1> }",
         {2e-5, .02, .8, 1, 9, .01, 6, INFINITY},
         0.02},
        {"behind the eye, backward",
         "box { interior = haze  from = <-90, -90, -9>  to = <90, 90, 9> }",
         {2e-5, .02, -.5, 0, 9, 1, -.5, INFINITY},
         0.01},
        {"beyond a wall",
         "box { interior = haze  from = <-90, -90, -99>  to = <90, 90, 9> }"
         "box { from = <-1, -1, -7>  to = <1, 1, -6>  surface = surface { albedo = 0 } }",
         {2e-5, .02, 0, 0, 6, 2, 4, INFINITY},
         0.01},
        {"dense, and mostly absorbing",
         "box { interior = haze  from = <-90, -90, -9>  to = <90, 90, -1> }",
         {.0005, 1, .3, 1, 9, .2, 2, INFINITY},
         0.01},
        {"endless",
         "medium far { ior = 1  scattering = 2e-5  absorption = .1 } world { medium = far }",
         {2e-5, .1, 0, 0, INFINITY, .5, 4, INFINITY},
         0.01},
        {"in parts, by hulls of nothing else",
         "for (z in 0..7) { box { interior = haze  from = <-90, -90, -2 - z>  to = <90, 90, -1 - z> } }",
         {1e-4, .02, 0, 1, 9, .5, 4, INFINITY},
         0.01},
        {"mixing with air, and with nothing",
         "medium more { mixes = true  scattering = 1e-5 } box { interior = thin  from = <-90, -90, -9>  to = <90, 90, "
         "-1> }"
         "box { interior = more  from = <-90, -90, -9>  to = <90, 90, -1> } box { interior = more  from = <-90, -90, "
         "-9>  to = <90, 90, -1> }",
         {2e-5, 0, 0, 1, 9, .5, 4, INFINITY},
         0.01},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const Haze *haze = &cases[i].haze;
        char text[1500];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit m medium haze { ior = 1  scattering = %.12g  absorption = %.12g  phase = hg(%g) }"
                 " medium thin { mixes = true  scattering = 0  absorption = 0 } %s"
                 " light { shape = point  from = <%.12g, 0, %.12g>  intensity = 1 }" EYE,
                 haze->scattering, haze->absorption, haze->g, cases[i].scene, haze->across, -haze->along);
        double expected = airlight(haze);
        Estimate seen = measure(text, 2048, true);
        truth_expect(cases[i].what, 1, (Estimate){seen.mean / expected, seen.error / expected}, 4, cases[i].resolution);
    }
}

/* Media and lights of all kinds, for EYE. */
static const struct {
    const char *what, *scene;
    uint32_t samples;
} lit_media[] = {
    {"a ball of light in fog of many colours",
     "medium fog { ior = 1  scattering = <.05, .2, .8>  absorption = <.2, 0, .1>  phase = hg(.5) }"
     "box { interior = fog  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "light { shape = sphere  from = <.3, 0, -3>  radius = .1  radiance = 20 }",
     512},
    {"the same in droplets, which send colours each another way",
     "medium fog { ior = 1  scattering = <.05, .2, .8>  absorption = <.2, 0, .1>  phase = droplets(2, .4) }"
     "box { interior = fog  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "light { shape = sphere  from = <.3, 0, -3>  radius = .1  radiance = 20 }",
     512},
    {"a cloud of droplets that scatters colours unlike, in a mist of others",
     "def g(p) = 2 * max(0, 1 - length(p - <0, .5, -2>)) medium cloud { mixes = true  scattering = <.3, 1, 3>"
     "  phase = droplets(3, .4)  density = volume { function = g  from = <-1, -1, -4>  to = <1, 2, 0>  cells = 20 } }"
     "medium mist { mixes = true  scattering = .05  phase = droplets(10) }"
     "sphere { interior = cloud  center = <0, .5, -2> } box { interior = mist  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "light { shape = sphere  from = <.9, 1.5, -2.5>  radius = .2  radiance = 20 }"
     "light { shape = distant  from = <1, 1, -1>  to = <0, 0, 0>  angle = 3deg  power = 1 }",
     512},
    {"the same far off, before a wall",
     "medium fog { ior = 1  scattering = .05  phase = hg(-.3) } box { interior = fog  from = <-4, -4, -8>  to = "
     "<4, 4, 1> }"
     "light { shape = sphere  from = <3, 3, -3>  radius = .3  radiance = 20 }"
     "box { from = <-4, -4, -8>  to = <4, 4, -7> surface = surface { albedo = .5 } }",
     256},
    {"thick fog around a window and a mesh that shine",
     "medium fog { ior = 1  scattering = 3  absorption = .1 } box { interior = fog  from = <-4, -4, -8>  to = <4, "
     "4, 1> }"
     "light { shape = quad  from = <0, .6, -1>  to = <0, 0, -1>  size = <.5, .3>  radiance = 2 }"
     "mesh { positions = [<-.6, -.2, -1>, <-.6, .2, -1>, <-.6, 0, -.8>]  triangles = [<0, 1, 2>]"
     "  surface = surface { emission = 1  radiance = 5 } }",
     128},
    {"the sun and a bright part of the sky over haze of two layers",
     "medium low { ior = 1  scattering = .3 } medium high { ior = 1  scattering = <.02, .05, .2>  phase = "
     "rayleigh() }"
     "box { interior = low  from = <-4, -4, -4>  to = <4, 4, -2> } box { interior = high  from = <-4, -4, -2>  to "
     "= <4, 4, 1> }"
     "light { shape = distant  from = <1, 1, 1>  to = <0, 0, 0>  angle = 2deg  power = 1 }"
     "environment { color = 1  strength = .1 }",
     256},
    {"a flame in its own smoke, in haze",
     "def f(p) = max(0, 1 - length(p - <.2, 0, -2>)) def g(p) = 2 * max(0, 1 - length(p - <0, .5, -2>))"
     " medium flame { mixes = true  emission = 1  density = volume { function = f from = <-1, -1, -3>  to = <1, 1, "
     "-1>"
     "  cells = 20 } } medium smoke { mixes = true  scattering = <.5, 1, 2>  phase = hg(.4)  density = volume {"
     "  function = g from = <-1, -1, -4>  to = <1, 2, 0>  cells = 20 } } medium haze { mixes = true  scattering = "
     ".05 }"
     "sphere { interior = flame  center = <.2, 0, -2> } sphere { interior = smoke  center = <0, .5, -2> }"
     "box { interior = haze  from = <-4, -4, -8>  to = <4, 4, 1> }",
     256},
    {"gas that shines and scatters, beside water",
     "medium gas { ior = 1  emission = 1  scattering = .4 } medium haze { ior = 1  scattering = .1 }"
     " medium water { ior = 1.33  scattering = .2 } box { interior = haze  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "sphere { interior = gas  center = <.4, 0, -2>  radius = .3 } box { interior = water  from = <-1, -1, -4>  to "
     "= <1, 1, -2> }",
     256},
    {"many small lights",
     "medium haze { ior = 1  scattering = .1 } box { interior = haze  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "for (i in 0..40) { sphere { center = <sin(i), cos(i * 1.7), -.1 * i - .5>  radius = .02  surface = surface { "
     "emission = 1  radiance = i + 1 } } }",
     256},
    {"a beam",
     "medium haze { ior = 1  scattering = .1  phase = hg(.6) } box { interior = haze  from = <-4, -4, -8>  to = "
     "<4, 4, 1> }"
     "light { shape = disc  from = <1, 1, -3>  to = <0, 0, -3>  radius = .2  angle = 30deg  radiance = 5 }",
     256},
    {"a lamp behind a grid",
     "medium haze { ior = 1  scattering = .1 } box { interior = haze  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "light { from = <0, 2, -3>  to = <0, 0, -3>  size = <2, 1>  angle = 50deg  blend = .5  radiance = 5 }",
     256},
    {"a beam beside a larger lamp",
     "medium haze { ior = 1  scattering = .1 } box { interior = haze  from = <-4, -4, -8>  to = <4, 4, 1> }"
     "light { shape = disc  from = <3, .5, -2>  to = <-3, 0, -3>  radius = .2  angle = 4deg  power = 1 }"
     "light { from = <0, 3.5, -3>  to = <0, 0, -3>  size = <2, 1>  power = 5 }",
     256},
    {"a spot",
     "medium haze { ior = 1  scattering = .1  phase = hg(.6) } box { interior = haze  from = <-4, -4, -8>  to = "
     "<4, 4, 1> }"
     "light { shape = spot  from = <1, 1, -3>  to = <0, 0, -3>  angle = 30deg  intensity = 1 }",
     256},
};

/* Whatever the medium and the lights are: looked for along the way as well, and only where paths are scattered. */
static void looks_agree(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(lit_media); i++) {
        char text[1600];
        snprintf(text, sizeof text, "meniscus 1.0 unit m %s" EYE, lit_media[i].scene);
        Estimate with = measure(text, lit_media[i].samples, true), without = measure(text, lit_media[i].samples, false);
        truth_expect(lit_media[i].what, 1, truth_ratio(with, without), 4, 0.05);
        print_message("    %.3g times the variance\n", pow(with.error / without.error, 2));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shining_ball),
        cmocka_unit_test(shining_hulls_agree),
        cmocka_unit_test(lamps_in_haze),
        cmocka_unit_test(looks_agree),
    };
    return cmocka_run_group_tests_name("airlight", tests, NULL, NULL);
}
