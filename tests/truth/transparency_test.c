/* transparency_test.c - backgrounds and lights that the camera does not see: what a pixel covers, in closed form, and all that stays as
 * it is, to the bit.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 8, SAMPLES = 4096 };

/* Eight units wide, seen along -z without perspective: one unit a pixel. */
#define VIEW                                                                                                           \
    " film { filter = box }  camera { from = <0, 0, 50>  to = <0, 0, 0>  projection = orthographic  width = 8 } "
#define HIDDEN_SKY " environment { color = 1  visible = false } "
#define SHEETS(what) "box { from = <-9, -9, 0>  to = <9, 9, 1>  surface = surface { thin = true  " what " } }"
#define AIR "medium thin { ior = 1  absorption = .3 }  medium fog { ior = 1  scattering = .3 } "

typedef struct Covered {
    Estimate alpha, light;
} Covered;

/* Means over all pixels, which show the same. */
static Covered measure(const char *text)
{
    Fixture scene;
    Picture picture;
    double alphas[WIDTH * WIDTH];
    truth_open(&scene, (TruthInput){.text = text});
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    truth_render(&scene, &settings, 0, &picture);
    int channel = image_channel(&picture.image, "A");
    for (uint32_t i = 0; i < WIDTH * WIDTH; i++)
        alphas[i] = (double)picture.image.pixels[i * picture.image.n_channels + (size_t)channel];
    Covered covered = {truth_estimate(alphas, WIDTH * WIDTH), truth_mean(&picture, -1)};
    truth_clear(&picture);
    fixture_clear(&scene);
    return covered;
}

typedef struct Case {
    const char *what, *matter;
    double alpha, light; /* light < 0: not asked */
} Case;

/* A wall of a reflectance of a half, which covers a part of each pixel; and what lets a part of the light straight on. */
static void cover_is_what_stops_straight_lines(void **state)
{
    (void)state;
    const double pane = truth_pane(1, 1.5), fresnel = truth_fresnel(1, 1, 1.5);
    const Case cases[] = {
        {"nothing", "", 0, 0},
        {"half of a pixel",
         "for (i in -4..3) { box { from = <i, -9, -1>  to = <i + .5, 9, 0>  surface = surface { albedo = .5 } } }", .5,
         .25},
        {"a thin pane", "box { from = <-9, -9, 0>  to = <9, 9, 0.001>  interior = glass }", 1, 1},
        {"two sheets", SHEETS("ior = 1.5  transmission = 1"), 1 - pane * pane, -1},
        {"sheets seen nowhere", SHEETS("ior = 1.5  transmission = 1  specular = 0"), 0, 0},
        {"painted sheets", SHEETS("ior = 1.001  transmission = .4  albedo = 0"), 1 - .4 * .4, -1},
        {"what absorbs", "box { from = <-9, -9, -1>  to = <9, 9, 1>  interior = thin }", 1 - exp(-.6), 0},
        {"what scatters", "box { from = <-9, -9, -1>  to = <9, 9, 1>  interior = fog }", 1 - exp(-.6), 1 - exp(-.6)},
        {"fog before a wall",
         "box { from = <-9, -9, -1>  to = <9, 9, 1>  interior = fog }"
         "box { from = <-9, -9, -3>  to = <9, 9, -2>  surface = surface { albedo = 0 } }",
         1, -1},
        {"a skin", "box { from = <-9, -9, 0>  to = <9, 9, 1>  surface = surface { ior = 1.5  albedo = 0 } }", 1,
         fresnel},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit m  medium glass { ior = 1.5 }  " AIR "let _all = [glass, thin, fog]\n"
                 "%s\n" HIDDEN_SKY VIEW,
                 cases[i].matter);
        Covered covered = measure(text);
        truth_expect(cases[i].what, cases[i].alpha, covered.alpha, 3, 0.01);
        if (cases[i].light >= 0) truth_expect("and its light", cases[i].light, covered.light, 3, 0.01);
    }
}

/* A ball of glass and a matte one before the sky of a lamp and a sun: what is covered wholly is as it is with all of that seen. */
#define STILL                                                                                                          \
    "meniscus 1.0 unit m  medium glass { ior = 1.5 }\n"                                                                \
    "sphere { center = <-1.9, 0, 0>  radius = 1.7  interior = glass }\n"                                               \
    "sphere { center = <1.9, 0, 0>  radius = 1.7  surface = surface { albedo = .7 } }\n"

static void all_else_stays_to_the_bit(void **state)
{
    enum { SIDE = 24 };
    (void)state;
    Picture pictures[2];
    for (int hidden = 0; hidden < 2; hidden++) {
        char text[2000];
        Fixture scene;
        const char *visible = hidden ? "false" : "true";
        snprintf(text, sizeof text,
                 STILL VIEW "environment { sky = clear  visible = %s }\n"
                            "light { shape = quad  from = <0, 4, 2>  to = <0, 0, 0>  size = <2, 2>  radiance = 9 }",
                 visible);
        truth_open(&scene, (TruthInput){.text = text});
        RenderSettings settings = truth_settings(SIDE, 64);
        truth_render(&scene, &settings, 0, &pictures[hidden]);
        fixture_clear(&scene);
    }
    const Image *seen = &pictures[0].image, *hidden = &pictures[1].image;
    uint32_t n_whole = 0, n_empty = 0;
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        const float *a = seen->pixels + i * seen->n_channels, *b = hidden->pixels + i * hidden->n_channels;
        assert_true(a[3] == 1 && b[3] >= 0 && b[3] <= 1);
        if (b[3] == 1) assert_memory_equal(a, b, 3 * sizeof(float));
        if (b[3] == 0) assert_true(b[0] == 0 && b[1] == 0 && b[2] == 0);
        n_whole += b[3] == 1;
        n_empty += b[3] == 0;
    }
    assert_in_range(n_whole, 100, SIDE * SIDE - 100);
    assert_in_range(n_empty, 100, SIDE * SIDE - 100);
    for (int i = 0; i < 2; i++) truth_clear(&pictures[i]);
}

/* What stands behind a lamp that is not seen is as bright as if the camera stood before the lamp, and the lamp lights it: a disc of
 * radius r at a distance d on the axis of a matte wall gives it an irradiance of pi L r^2 / (r^2 + d^2). */
static void lamps_in_front_light_and_are_not_seen(void **state)
{
    (void)state;
    const char *const lamps[] = {"shape = disc  radius = 2  to = <0, 0, 0>", "size = <4, 3>  to = <0, 0, 0>",
                                 "shape = sphere  radius = 1"};
    for (size_t i = 0; i < COUNT_OF(lamps); i++) {
        Estimate seen[2];
        for (int before = 0; before < 2; before++) {
            char text[1000];
            snprintf(text, sizeof text,
                     "meniscus 1.0 unit m  film { filter = box }  light { from = <0, 0, 5>  %s  visible = false }\n"
                     "box { from = <-9, -9, -1>  to = <9, 9, 0>  surface = surface { albedo = .6 } }\n"
                     "camera { from = <0, 0, %d>  to = <0, 0, 0>  projection = orthographic  width = .01 }",
                     lamps[i], before ? 3 : 50);
            Covered covered = measure(text);
            assert_near(covered.alpha.mean, 1, 0);
            seen[before] = covered.light;
        }
        if (i == 0) truth_expect("a disc that is not seen", .6 * 4 / (4 + 25.), seen[0], 3, 0.01);
        truth_alike(lamps[i], seen[1], seen[0], 3, 0.01);
    }
}

/* Glass shows such a lamp, as a ball's mirror does; and a sun that is not seen leaves no disc in the sky. */
static void lamps_are_seen_in_glass_alone(void **state)
{
    (void)state;
    const char *const front =
        "light { from = <0, 0, -5>  to = <0, 0, 9>  size = <90, 90>  radiance = 1  visible = false }";
    char text[1000];
    snprintf(text, sizeof text, "meniscus 1.0 unit m  %s" VIEW, front);
    Covered bare = measure(text);
    assert_near(bare.alpha.mean, 0, 0);
    assert_near(bare.light.mean, 0, 0);
    snprintf(text, sizeof text,
             "meniscus 1.0 unit m  medium glass { ior = 1.5 }  box { from = <-9, -9, 0>  to = <9, 9, 1>  interior = "
             "glass }\n%s" VIEW,
             front);
    Covered glazed = measure(text);
    assert_near(glazed.alpha.mean, 1, 0);
    truth_expect("a lamp through glass", truth_pane(1, 1.5), glazed.light, 3, 0.01);
    Covered sun = measure("meniscus 1.0 unit m  light { shape = distant  from = <0, 0, -1>  to = <0, 0, 0>  angle = 60 "
                          " visible = false }" VIEW);
    assert_near(sun.light.mean, 0, 0);
    assert_near(sun.alpha.mean, 0, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cover_is_what_stops_straight_lines),
        cmocka_unit_test(all_else_stays_to_the_bit),
        cmocka_unit_test(lamps_in_front_light_and_are_not_seen),
        cmocka_unit_test(lamps_are_seen_in_glass_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
