/* vanish_test.c - what must leave no trace at all: hulls whose index is that of their surroundings, and the number of
 * threads. Silent crossings change nothing but the interior list, so that the bits are the same, not only the expectation.
 * SPDX-License-Identifier: Apache-2.0 */
#include "arrangements.h"
#include "truth.h"

enum { WIDTH = 48, SAMPLES = 16 };

static double two_skies(double elevation)
{
    return elevation > 0.3 ? 2 : 0.3;
}

static void render_text(const char *text, NestPolicy policy, unsigned threads, Picture *picture)
{
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .sky = two_skies, .policy = policy});
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    truth_render(&scene, &settings, threads, picture);
    assert_int_equal(picture->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

static void expect_same_bits(const char *what, const Picture *a, const Picture *b)
{
    size_t bytes = (size_t)a->image.width * a->image.height * a->image.n_channels * sizeof *a->image.pixels;
    truth_figure(what, 0, truth_largest_difference(a, b), 0);
    assert_memory_equal(a->image.pixels, b->image.pixels, bytes);
}

#define HEAD                                                                                                           \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass { ior = 1.5  absorption = .02 / 1mm  state = solid }\n"                                              \
    "medium water { ior = 1.33 state = liquid }\n"
#define SURROUNDINGS                                                                                                   \
    TRUTH_SKY "ground { y = -20  surface = surface { albedo = .6  pattern = \"checker\"  check_size = 7 } }\n"         \
              "camera { from = <10, 25, 70>  to = <0, 0, 0>  fov = 50deg  aperture = 1 }\n"

static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED};

/* [SB02] fig. 1: indices equal to that of the air around. */
static void spheres_of_air_vanish(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        Picture with, without;
        render_text(HEAD "medium a { ior = 1 } medium b { ior = 1 state = gas }\n"
                         "sphere { interior = a center = <-6, 0, 0> radius = 12 }\n"
                         "sphere { interior = b center = <6, 0, 0> radius = 12  priority = 1 }\n"
                         "sphere { interior = air center = <0, 10, 0> radius = 12  priority = 2 }\n"
                         "box { interior = b size = <30, 50, 20> bevel = 2 rotate(y, 20) }\n" SURROUNDINGS,
                    policies[i], 0, &with);
        render_text(HEAD SURROUNDINGS, policies[i], 0, &without);
        assert_true(with.stats.silent_crossings > 10000);
        expect_same_bits("air in air", &with, &without);
        truth_clear(&with);
        truth_clear(&without);
    }
}

/* Water in a world of water, with things in it that do show. */
static void water_in_water_vanishes(void **state)
{
    (void)state;
    static const char *const body = "sphere { interior = glass  radius = 9  priority = 5 }\n";
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        Picture with, without;
        char text[2000];
        snprintf(
            text, sizeof text, "%s%s%s",
            HEAD
            "world { medium = water } medium same { ior = 1.33 }\n"
            "box { interior = same size = <40, 30, 40> rotate(<10, 20, 0>) } sphere { interior = water radius = 14 }\n",
            body, SURROUNDINGS);
        render_text(text, policies[i], 0, &with);
        snprintf(text, sizeof text, "%s%s%s", HEAD "world { medium = water }\n", body, SURROUNDINGS);
        render_text(text, policies[i], 0, &without);
        assert_true(with.stats.silent_crossings > 10000);
        expect_same_bits("water in water", &with, &without);
        truth_clear(&with);
        truth_clear(&without);
    }
}

/* Hulls of one medium that overlap merge; one that is hidden below them is not there. */
static void what_is_inside_glass_vanishes(void **state)
{
    (void)state;
    static const char *const block =
        "box { interior = glass  size = <30, 24, 20>  bevel = 2  priority = 3  rotate(y, 25) }\n";
    Picture with, without;
    char text[2000];
    snprintf(
        text, sizeof text, "%s%s%s", HEAD "medium twin { ior = 1.5  absorption = .02 / 1mm }\n", block,
        "sphere { interior = glass  radius = 8  priority = 9 }\n"
        "sphere { interior = water  center = <3, 0, 0>  radius = 8  priority = 1 }\n"
        "cylinder { interior = twin  from = <-5, -6, 0>  to = <5, 6, 0>  radius = 3  priority = 7 }\n" SURROUNDINGS);
    render_text(text, NEST_PRIORITY, 0, &with);
    snprintf(text, sizeof text, "%s%s%s", HEAD, block, SURROUNDINGS);
    render_text(text, NEST_PRIORITY, 0, &without);
    assert_true(with.stats.silent_crossings > 10000);
    /* Not the same bits: absorption is summed up over stretches. One path that went another way would be 1 / SAMPLES. */
    double difference = truth_largest_difference(&with, &without);
    truth_figure("glass in glass", 0, difference, 0);
    assert_true(difference <= 1e-5);
    truth_clear(&with);
    truth_clear(&without);
}

static void threads_leave_no_trace(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(arrangements); i++) {
        char text[4096];
        snprintf(text, sizeof text, "%s" TRUTH_SKY, arrangements[i].text);
        Picture one, more;
        render_text(text, NEST_AUTOMATIC, 1, &one);
        for (unsigned threads = 2; threads <= 3; threads++) {
            char what[100];
            snprintf(what, sizeof what, "%s, %u threads", arrangements[i].name, threads);
            render_text(text, NEST_AUTOMATIC, threads, &more);
            expect_same_bits(what, &one, &more);
            assert_int_equal(one.stats.rays, more.stats.rays);
            truth_clear(&more);
        }
        truth_clear(&one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres_of_air_vanish),
        cmocka_unit_test(water_in_water_vanishes),
        cmocka_unit_test(what_is_inside_glass_vanishes),
        cmocka_unit_test(threads_leave_no_trace),
    };
    return cmocka_run_group_tests_name("vanish", tests, NULL, NULL);
}
