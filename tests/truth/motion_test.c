/* motion_test.c - what moves while the shutter is open: the blurred picture is the mean of sharp ones at all times, a
 * furnace stays one, and nothing is lost on the way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 32, SAMPLES = 1024, TIMES = 64 };

#define HEAD                                                                                                           \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass { ior = 1.5  absorption = .01 / 1mm  state = solid }\n"                                              \
    "medium water { ior = 1.33 absorption = .005 / 1mm state = liquid }\n"                                             \
    "medium gas { ior = 1 state = gas }\n"
/* Everything in it moves: balls through each other, a box that turns through water, a lens that is cut while it moves,
 * a mesh that is deformed, a light, and the camera. */
#define MOVING                                                                                                         \
    "sphere { interior = water  center = <0, 8 * t, 0>  radius = 14 }\n"                                               \
    "box { interior = glass  size = <9, 9, 9>  bevel = 1  rotate(y, 80 * t)  translate(<-8 + 10 * t, 4, 3>) }\n"       \
    "for (i in 0..2) { sphere { interior = gas  radius = 2  center = <5 * i - 4, 6 * t - 3, 6> } }\n"                  \
    "difference { interior = glass  sphere { center = <12, 0, 0>  radius = 8 }\n"                                      \
    "  sphere { center = <12, 9 - 5 * t, 2>  radius = 6 } }\n"                                                         \
    "mesh { interior = glass  positions = [<-20, -8, 0>, <-12, -8, 0>, <-16, -8, 7>, <-16 + 6 * t, 3 + 4 * t, 3>]\n"   \
    "  triangles = [<0, 1, 2>, <0, 3, 1>, <1, 3, 2>, <2, 3, 0>] }\n"
#define OPAQUE                                                                                                         \
    "ground { y = -14  surface = surface { albedo = .6  pattern = \"checker\"  check_size = 5 } }\n"                   \
    "sphere { radius = 3  surface = surface { albedo = .7 }  center = <8 - 12 * t, -10, 14> }\n"

#define LIT(shutter)                                                                                                   \
    "light { shape = sphere  from = <20 - 10 * t, 40, 20>  radius = 6  radiance = 9 }\n"                               \
    "camera { from = <6 * t, 16, 60>  to = <0, 0, 0>  fov = 46deg  " shutter " }\n" TRUTH_WHITE_SKY

static void render_at(const char *text, double clock, Picture *picture)
{
    char define[60];
    snprintf(define, sizeof define, "at=%.17g", clock);
    const char *defines[] = {define, NULL};
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .defines = defines});
    RenderSettings settings = truth_settings(WIDTH, SAMPLES / TIMES);
    settings.seed = 7 + (uint32_t)(clock * 1e6);
    truth_render(&scene, &settings, 0, picture);
    assert_int_equal(picture->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

/* The mean of the blurred picture and of many sharp ones, the sharp ones stratified in time: the expectation is the
 * same but for the motion between two keys, which is straight. Judged by luminance in cells of the picture. */
static void blurred_is_the_mean_of_sharp(void **state)
{
    (void)state;
    enum { CELLS = 4, CELL = WIDTH / CELLS };
    Fixture scene;
    truth_open(&scene,
               (TruthInput){.text = HEAD "let t = clock\n" MOVING OPAQUE LIT("shutter = 360deg  shutter_steps = 16")});
    assert_int_equal(scene.scene->n_keys, 17);
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    Picture blurred;
    truth_render(&scene, &settings, 0, &blurred);
    assert_int_equal(blurred.stats.nesting_faults, 0);
    double sum[WIDTH][WIDTH] = {{0}};
    for (int i = 0; i < TIMES; i++) {
        Picture sharp;
        render_at(HEAD "param at = 0\nlet t = at\n" MOVING OPAQUE LIT(""), (i + 0.5) / TIMES, &sharp);
        for (uint32_t y = 0; y < WIDTH; y++)
            for (uint32_t x = 0; x < WIDTH; x++) sum[y][x] += truth_luminance(&sharp, x, y) / TIMES;
        truth_clear(&sharp);
    }
    double worst = 0, squares = 0;
    for (int cell = 0; cell < CELLS * CELLS; cell++) {
        double a = 0, b = 0, variance = 0;
        for (int k = 0; k < CELL * CELL; k++) {
            uint32_t x = (uint32_t)(cell % CELLS * CELL + k % CELL), y = (uint32_t)(cell / CELLS * CELL + k / CELL);
            double error = truth_film_error(&blurred, x, y);
            a += truth_luminance(&blurred, x, y);
            b += sum[y][x];
            variance += 2 * error * error; /* both are means of as many paths */
        }
        double sigmas = (a - b) / sqrt(variance);
        worst = fmax(worst, fabs(sigmas));
        squares += sigmas * sigmas;
        if (sqrt(variance) > 0.02 * b) fail_msg("cell %d: too noisy to see a mistake", cell);
    }
    printf("  blurred against %d sharp pictures: cells differ by %.2f sigmas rms, %.2f at most\n", TIMES,
           sqrt(squares / (CELLS * CELLS)), worst);
    assert_true(worst < 4);
    truth_clear(&blurred);
    fixture_clear(&scene);
}

static void moving_furnace(void **state)
{
    (void)state;
    static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED};
    FaultCount faults = {0};
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        Fixture scene;
        Picture picture;
        truth_open(
            &scene,
            (TruthInput){.text = HEAD
                         "let t = clock\n" MOVING OPAQUE
                         "camera { from = <6 * t, 12, 60>  to = <0, 0, 0>  fov = 46deg  shutter = 270deg }\n" TRUTH_SKY,
                         .furnace = true,
                         .policy = policies[i]});
        RenderSettings settings = truth_settings(WIDTH, 256);
        settings.no_absorption = true;
        settings.bounces = 1000000;
        truth_render(&scene, &settings, 0, &picture);
        double difference = truth_difference_from_empty(&settings, &picture);
        printf("  %s: %.2g from the empty scene\n", nest_policy_text(policies[i]), difference);
        assert_true(difference <= 1e-5);
        truth_count(&faults, &picture.stats);
        truth_clear(&picture);
        fixture_clear(&scene);
    }
    truth_print_faults("moving furnaces", &faults);
    assert_int_equal(faults.faults, 0);
}

/* The camera goes under water while the shutter is open, so that its media are others at other times. */
static void camera_dives(void **state)
{
    (void)state;
    Fixture scene;
    Picture picture;
    truth_open(&scene,
               (TruthInput){.text = HEAD
                            "plane { interior = water }\n"
                            "sphere { interior = glass  center = <0, 1, 0>  radius = 3 }\n"
                            "camera { from = <0, 4 - 8 * clock, 20>  to = <0, 0, 0>  fov = 50deg  aperture = .5\n"
                            "  shutter = 360deg }\n" TRUTH_SKY,
                            .furnace = true});
    RenderSettings settings = truth_settings(WIDTH, 256);
    settings.no_absorption = true;
    settings.bounces = 1000000;
    truth_render(&scene, &settings, 0, &picture);
    double difference = truth_difference_from_empty(&settings, &picture);
    printf("  a dive: %.2g from the empty scene, %llu faults in %.3f million crossings\n", difference,
           (unsigned long long)picture.stats.nesting_faults, (double)picture.stats.crossings * 1e-6);
    assert_true(difference <= 1e-5);
    assert_int_equal(picture.stats.nesting_faults, 0);
    truth_clear(&picture);
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blurred_is_the_mean_of_sharp),
        cmocka_unit_test(moving_furnace),
        cmocka_unit_test(camera_dives),
    };
    return cmocka_run_group_tests_name("motion", tests, NULL, NULL);
}
