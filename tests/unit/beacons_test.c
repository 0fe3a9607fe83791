/* beacons_test.c - lamps are where they are looked for, and choices stay within their bounds.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "dice.h"
#include "optics/fresnel.h"
#include "scene_fixture.h"
#include "trace/backdrop.h"

static void find(const char *text, Beacons *beacons)
{
    Fixture fixture;
    fixture_compile(&fixture, text, 1);
    beacons_find(fixture.compiled, 1, beacons);
    fixture_clear(&fixture);
}

/* From a place towards another one. */
static float look(const Beacons *beacons, Vec3 from, Vec3 to)
{
    float brightness[2];
    Vec3f direction = vec3f_from(vec3_normalize(vec3_sub(to, from)));
    beacons_look(beacons, vec3f_from(from), direction, vec3f(0, 0, 0), brightness);
    assert_true(brightness[0] == brightness[1]);
    return brightness[0];
}

#define GLASS                                                                                                          \
    "meniscus 1.0 unit mm medium glass { ior = 1.5 } sphere { interior = glass  radius = 5 }\n"                        \
    "camera { from = <0, 0, 50>  to = <0, 0, 0> } "

/* A quad, a disc, a ball and a sun, each brighter than all that were before. */
static void lamps_are_met(void **state)
{
    (void)state;
    Beacons beacons;
    find(GLASS "environment { color = .1 }\n"
               "light { from = <0, 100, 0>  to = <0, 0, 0>  size = <20, 40>  radiance = 2 }\n"
               "light { shape = disc  from = <100, 0, 0>  to = <0, 0, 0>  radius = 10  radiance = 3 }\n"
               "light { shape = sphere  from = <0, 0, -100>  radius = 10  radiance = 4 }\n"
               "light { shape = \"distant\"  from = <-1, 0, 0>  to = <0, 0, 0>  angle = 2deg  radiance = 8 }\n",
         &beacons);
    const Vec3 from = vec3(1, 2, 3);
    float quad = look(&beacons, from, vec3(0, 100, 0)), disc = look(&beacons, from, vec3(100, 0, 0));
    float ball = look(&beacons, from, vec3(0, 0, -100)), sun = look(&beacons, vec3(0, 9, 0), vec3(-1e6, 9, 0));
    assert_true(quad > 1.25f);
    assert_true(fabsf(disc / quad - 1.5f) < 1e-4f);
    assert_true(fabsf(ball / quad - 2) < 1e-4f);
    assert_true(fabsf(sun / quad - 4) < 1e-4f);
    assert_true(look(&beacons, vec3(0, 0, 0), vec3(-1, tan(0.99 * acos(-1) / 180), 0)) == sun);
    assert_true(look(&beacons, vec3(0, 0, 0), vec3(-1, tan(1.01 * acos(-1) / 180), 0)) == 1);
    assert_true(look(&beacons, from, vec3(9.9, 100, 0)) == quad || look(&beacons, from, vec3(0, 100, 9.9)) == quad);
    assert_true(look(&beacons, from, vec3(20.1, 100, 20.1)) == 1);
    assert_true(look(&beacons, from, vec3(100, 9.9, 0)) == disc);
    assert_true(look(&beacons, from, vec3(100, 7.2, 7.2)) == 1);
    assert_true(look(&beacons, from, vec3(0, 10.4, -100)) == 1);
    assert_true(look(&beacons, vec3(0, 200, 0), vec3(0, 100, 0)) == 1); /* they shine to one side */
    assert_true(look(&beacons, from, vec3(0, 0, 100)) == 1);
}

/* The two ways are the sum and the difference. */
static void both_ways_are_looked_at(void **state)
{
    (void)state;
    Beacons beacons;
    find(GLASS "environment { color = .1 }\n"
               "light { from = <0, 100, 0>  to = <0, 0, 0>  size = <20, 40>  radiance = 2 }\n"
               "light { shape = sphere  from = <0, -100, 0>  radius = 10  radiance = 4 }\n",
         &beacons);
    float brightness[2];
    beacons_look(&beacons, vec3f(0, 0, 0), vec3f(0, 0, 0), vec3f(0, 1, 0), brightness);
    assert_true(brightness[0] > 1 && fabsf(brightness[1] / brightness[0] - 2) < 1e-4f);
}

/* Even light has no beacons: choices are those of Fresnel, and furnaces without noise. Nor are dim lamps any. */
static void even_light_has_none(void **state)
{
    (void)state;
    Beacons beacons;
    find(GLASS "environment { color = 1 }", &beacons);
    assert_false(beacons.any);
    find(GLASS "environment { color = 1 } light { from = <0, 100, 0>  to = <0, 0, 0>  size = <20, 40>  radiance = 1 }",
         &beacons);
    assert_false(beacons.any);
    find(GLASS, &beacons);
    assert_false(beacons.any);
}

/* A sky is looked up where it is, whatever the direction. */
static void skies_are_looked_up(void **state)
{
    (void)state;
    Beacons beacons;
    find(GLASS "environment { sky = clear  elevation = 10deg  azimuth = 90deg  disc = false }", &beacons);
    assert_true(beacons.has_map);
    float least = INFINITY, most = 0;
    Dice dice = {3};
    for (int i = 0; i < 20000; i++) {
        float brightness = look(&beacons, vec3(0, 0, 0), dice_direction(&dice));
        assert_true(brightness >= 1 && brightness <= 64);
        least = fminf(least, brightness);
        most = fmaxf(most, brightness);
    }
    assert_true(least == 1 && most > 2);
    assert_true(look(&beacons, vec3(0, 0, 0), vec3(0, -1, 0)) == 1);
}

/* What is thin mirrors lamps as what is clear does, wherever it is: here the origin is behind the lamp. */
static void thin_surfaces_have_them(void **state)
{
    (void)state;
    Beacons beacons;
    find("meniscus 1.0 unit mm surface film { thin = true  ior = 1.33  transmission = 1  film = 300nm }\n"
         "sphere { center = <1000, 0, 0>  surface = film } environment { color = .1 }\n"
         "light { from = <500, 0, 0>  to = <1000, 0, 0>  size = <80, 80>  radiance = 9 }\n"
         "camera { from = <1000, 0, 50>  to = <1000, 0, 0> }",
         &beacons);
    assert_true(beacons.any);
    assert_true(look(&beacons, vec3(1000, 0, 0), vec3(500, 30, 0)) > 2);
    assert_true(look(&beacons, vec3(1000, 0, 0), vec3(500, 50, 0)) == 1);
}

/* What a pane has behind it and around, lit by a lamp beside. */
static double backdrop_of(const char *behind)
{
    Fixture fixture;
    Buf text = {0};
    buf_format(&text,
               "meniscus 1.0 unit mm surface film { thin = true  ior = 1.33  transmission = 1 }\n"
               "mesh { positions = [<-100, -100, 0>, <100, -100, 0>, <100, 100, 0>, <-100, 100, 0>]\n"
               "       triangles = [<0, 1, 2>, <0, 2, 3>]  surface = film }\n"
               "light { from = <0, 400, 0>  to = <0, 0, 0>  size = <80, 80>  radiance = 9 }\n"
               "camera { from = <0, 0, 50>  to = <0, 0, 0> } %s\n",
               behind);
    fixture_compile(&fixture, buf_text(&text), 1);
    World world;
    assert_int_equal(world_init(&world, fixture.compiled, 0, 8, false, NULL, &fixture.error), STATUS_OK);
    assert_true(world.beacons.any);
    double backdrop = world.beacons.backdrop;
    world_clear(&world);
    fixture_clear(&fixture);
    buf_clear(&text);
    return backdrop;
}

/* Closed form: the lamp's 9 x 0.04 steradians are 0.0286 in the mean over all directions; each way past the lamp brings the
 * environment's luminance (white's mean over paths' wavelengths is 3 % below its luminance). Where there is none, it is the least
 * there may be; brighter than the mean none counts. */
static void backdrops_are_as_bright_as_they_look(void **state)
{
    (void)state;
    const double pi = acos(-1), lamp = 9 * 4 * asin(sin(atan(0.1)) * sin(atan(0.1))) / (4 * pi);
    double dim = backdrop_of("environment { color = .01 }"), dimmer = backdrop_of("environment { color = .004 }");
    assert_true(fabs(dim - 0.01 / (0.01 + lamp)) < 0.04 * dim);
    assert_true(fabs(dimmer - 0.004 / (0.004 + lamp)) < 0.04 * dimmer);
    assert_true(backdrop_of("environment { color = 0 }") == 1.0 / 16);
    assert_true(backdrop_of("plane { normal = z  distance = -10  surface = surface { emission = 5 } }") == 1);
}

static void choices_keep_their_bounds(void **state)
{
    (void)state;
    Dice dice = {5};
    for (int i = 0; i < 20000; i++) {
        float reflected = (float)dice_unit(&dice), mirrored = 1 + 63 * (float)dice_unit(&dice);
        float refracted = i % 2 ? 1 : 1 + 63 * (float)dice_unit(&dice);
        Lanes chosen = fresnel_choice(lanes(reflected, 0, 1, 0.04f), mirrored, refracted);
        float first = lanes_get(chosen, 0);
        assert_true(first >= 0.2f * reflected && first <= fmaxf(0.5f, reflected) && (first > 0) == (reflected > 0));
        assert_true(lanes_get(chosen, 1) == 0); /* what is not reflected, or nothing but reflected, is no choice */
        assert_true(lanes_get(chosen, 2) == 1);
        if (mirrored > refracted) assert_true(lanes_get(chosen, 3) > 0.04f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps_are_met),
        cmocka_unit_test(both_ways_are_looked_at),
        cmocka_unit_test(even_light_has_none),
        cmocka_unit_test(skies_are_looked_up),
        cmocka_unit_test(thin_surfaces_have_them),
        cmocka_unit_test(backdrops_are_as_bright_as_they_look),
        cmocka_unit_test(choices_keep_their_bounds),
    };
    return cmocka_run_group_tests_name("beacons", tests, NULL, NULL);
}
