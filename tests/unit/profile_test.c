/* profile_test.c - photometric files: what their candelas are towards directions of the world, for every type of
 * photometry, with symmetries, factors and tilts.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"
#include "scene_fixture.h"

static const double pi = 3.14159265358979323846;

/* Watts per steradian of the scene's one light towards a direction of the world; a watt is 683 lumens. */
static double towards(const SceneLight *light, double unit_m, Vec3 direction)
{
    Vec3 local = affine_normal(&light->to_world, vec3_normalize(direction)); /* rigid: the transpose inverts it */
    return (double)light_shape(light, local) * spectrum_luminance(&light->radiance) * unit_m * unit_m;
}

typedef struct Expected {
    Vec3 direction;
    double intensity;
} Expected;

static void check(const char *light, const Expected *expected, size_t n)
{
    char text[500];
    Fixture f;
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm camera { from = z } light { shape = point  profile = \"tests/unit/%s }", light);
    fixture_good(&f, text);
    for (size_t i = 0; i < n; i++) {
        double found = towards(&f.scene->lights[0], f.scene->unit_m, expected[i].direction);
        if (!(fabs(found - expected[i].intensity) <= 1e-5))
            fail_msg("%s: %g towards <%g, %g, %g>, not %g", light, found, expected[i].direction.x,
                     expected[i].direction.y, expected[i].direction.z, expected[i].intensity);
    }
    fixture_clear(&f);
}
#define CHECK(light, ...)                                                                                              \
    do {                                                                                                               \
        const Expected expected_[] = {__VA_ARGS__};                                                                    \
        check(light, expected_, COUNT_OF(expected_));                                                                  \
    } while (0)

static double cosine(double degrees)
{
    return cos(degrees * pi / 180);
}
static double sine(double degrees)
{
    return sin(degrees * pi / 180);
}

/* Of a lamp that faces -z, with y up and x to the right: so far up, and so far to the right, as type B has it. */
static Vec3 by_b(double vertical, double horizontal)
{
    return vec3(sine(horizontal), cosine(horizontal) * sine(vertical), -cosine(horizontal) * cosine(vertical));
}
/* The same as type A has it. */
static Vec3 by_a(double vertical, double horizontal)
{
    return vec3(cosine(vertical) * sine(horizontal), sine(vertical), -cosine(vertical) * cosine(horizontal));
}

static void type_b(void **state)
{
    (void)state;
    /* 2 to the left, 0 to the right, and in between from 0 below to 2 above */
    CHECK("lamp_b.ies\"  to = <0, 0, -1>", {by_b(0, 0), 1}, {by_b(90, 0), 2}, {by_b(-90, 0), 0}, {by_b(45, 0), 1.5},
          {by_b(-45, 0), 0.5}, {by_b(0, 45), 0.5}, {by_b(0, -45), 1.5}, {by_b(0, 89.999), 0.001 / 90},
          {by_b(0, -89.999), 2 - 0.001 / 90}, {by_b(45, 45), 0.75}, {by_b(-60, -30), 2.0 / 3 + (1.0 / 3) * 2.0 / 3},
          {{0, 0, 1}, 0}, {{0.3, 0.2, 0.1}, 0});
    /* the same from the side: towards +x, with z to the right */
    CHECK("lamp_b.ies\"  to = <1, 0, 0>", {{1, 0, 0}, 1}, {{1, 1, 0}, 1.5}, {{1, 0, 1}, 0.5}, {{1, 0, -1}, 1.5});
    /* by a factor, and turned by a transform about its axis: what was up is left */
    CHECK("lamp_b.ies\"  to = <0, 0, -1>  intensity = 3  rotate(z, 90deg)", {{0, 0, -1}, 3}, {{-1, 0, -1}, 4.5},
          {{0, 1, -1}, 1.5}, {{0, -1, -1}, 4.5});
    /* straight down, up being towards +z */
    CHECK("lamp_b.ies\"", {{0, -1, 0}, 1}, {{0, -1, 1}, 1.5}, {{0, -1, -1}, 0.5});
}

static void type_a(void **state)
{
    (void)state;
    /* the same on both sides; 2 above, 0 below, in between at the height of the lamp from 1 ahead to 0.5 at the sides */
    CHECK("lamp_a.ies\"  to = <0, 0, -1>", {by_a(0, 0), 1}, {by_a(90, 0), 2}, {by_a(-90, 0), 0}, {by_a(45, 0), 1.5},
          {by_a(0, 45), 0.75}, {by_a(0, -45), 0.75}, {by_a(45, 45), 1.375}, {by_a(-45, -60), 1.0 / 3}, {{0, 0, 1}, 0});
}

/* A quarter of the field stands for all of it; 1991's second factor counts: .5 times .5 times 4 in the middle. */
static void quadrants(void **state)
{
    (void)state;
    CHECK("lamp_quarter.ies\"  to = <0, 0, -1>", {by_b(0, 0), 1}, {by_b(45, 0), 0.5}, {by_b(-45, 0), 0.5},
          {by_b(0, 45), 0.5}, {by_b(0, -45), 0.5}, {by_b(-45, -45), 0.25}, {by_b(30, -60), 2.0 / 9}, {{0, 0, 1}, 0});
}

/* How much there is depends on how far from straight down the lamp is aimed: 1, at 30 degrees .8, at 90 degrees .5 */
static void tilts(void **state)
{
    (void)state;
    static const char *const files[] = {"lamp_tilted.ies", "lamp_tilt_file.ies"};
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        static const struct {
            const char *light;
            double factor;
        } cases[] = {{"\"", 1},
                     {"\"  to = <0, -1, 0>", 1},
                     {"\"  to = <0, -cos(15), sin(15)>", 0.9},
                     {"\"  to = <sin(30), -cos(30), 0>", 0.8},
                     {"\"  to = <0, 0, 1>", 0.5},
                     {"\"  rotate(x, 60deg)", 0.65},
                     {"\"  to = <0, sin(30), cos(30)>", 0.65}, /* 120 degrees: as 60 */
                     {"\"  to = <0, 1, 0>", 1}};
        for (size_t k = 0; k < COUNT_OF(cases); k++) {
            char light[200];
            snprintf(light, sizeof light, "%s%s", files[i], cases[k].light);
            CHECK(light, {{1, 2, 3}, cases[k].factor}, {{0, -1, 0}, cases[k].factor});
        }
    }
}

/* By power the whole of it is that many watts, whatever the type. */
static void flux(void **state)
{
    (void)state;
    static const char *const files[] = {"lamp.ies", "lamp_a.ies", "lamp_b.ies", "lamp_quarter.ies", "lamp_tilted.ies"};
    for (size_t i = 0; i < COUNT_OF(files); i++) {
        enum { N = 500 };
        char text[300];
        Fixture f;
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm camera { from = z } light { shape = point  profile = \"tests/unit/%s\"  to = "
                 "<1, 2, 3>"
                 "  power = 7 }",
                 files[i]);
        fixture_good(&f, text);
        double sum = 0;
        for (int k = 0; k < N * N; k++) {
            double y = 1 - (2 * (k / N) + 1.0) / N, r = sqrt(1 - y * y), a = 2 * pi * (k % N + 0.5) / N;
            sum += towards(&f.scene->lights[0], f.scene->unit_m, vec3(r * cos(a), y, r * sin(a))) * 4 * pi / (N * N);
        }
        assert_near(sum, 7, 0.02);
        fixture_clear(&f);
    }
}

/* Of one that falls from 1 at the middle to nothing at a tenth of a degree, along each of its angles: closed forms of flat
 * figures, off by the square of the angle. Types A and B have pyramids of bilinear sides, C a cone. */
static void narrow_beams(void **state)
{
    (void)state;
    static const float whole[] = {-90, -0.1f, 0, 0.1f, 90}, half[] = {0, 0.1f, 90}, none[] = {0};
    static const float of_whole[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
    static const float of_half[] = {1, 0, 0, 0, 0, 0, 0, 0, 0}, of_cone[] = {1, 0, 0};
    const double width = 0.1 * pi / 180;
    const LightProfile profiles[] = {
        {PROFILE_C, half, none, of_cone, 3, 1},
        {PROFILE_A, whole, whole, of_whole, 5, 5},
        {PROFILE_B, whole, whole, of_whole, 5, 5},
        {PROFILE_A, half, half, of_half, 3, 3},
    };
    for (size_t i = 0; i < COUNT_OF(profiles); i++) {
        SceneLight light = {.kind = LIGHT_POINT, .profile = &profiles[i]};
        double wanted = profiles[i].type == PROFILE_C ? pi * width * width / 3 : width * width;
        assert_near(light_beam(&light) / wanted, 1, 1e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(type_b), cmocka_unit_test(type_a), cmocka_unit_test(quadrants),
        cmocka_unit_test(tilts),  cmocka_unit_test(flux),   cmocka_unit_test(narrow_beams),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
