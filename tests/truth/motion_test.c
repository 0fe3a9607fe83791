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

/* Of the picture that textures have here: bands. */
static double striped(double elevation)
{
    return elevation > 0.3 || (elevation > -0.9 && elevation < -0.2) ? 0.9 : 0.1;
}

/* How a picture of what moves is compared with sharp ones. */
typedef struct Look {
    const char *name;
    const char *things; /* what there is, by t */
    const char *rest;   /* what lights and shows it; a %s for the shutter */
    uint32_t samples, times;
    double resolution; /* of a cell's mean, as a part of it */
} Look;

static void text_of(const Look *look, const char *moment, const char *shutter, char *text, size_t size)
{
    size_t length = (size_t)snprintf(text, size, HEAD "%s\n%s", moment, look->things);
    assert_true(length < size);
    truth_fill(text + length, size - length, look->rest, shutter);
}

static void render_at(const Look *look, double clock, Picture *picture)
{
    char define[60], text[4000];
    snprintf(define, sizeof define, "at=%.17g", clock);
    text_of(look, "param at = 0\nlet t = at", "", text, sizeof text);
    const char *defines[] = {define, NULL};
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .defines = defines, .sky = striped});
    RenderSettings settings = truth_settings(WIDTH, look->samples / look->times);
    settings.seed = 7 + (uint32_t)(clock * 1e6);
    truth_render(&scene, &settings, 0, picture);
    assert_int_equal(picture->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

static void render_blurred(const Look *look, Picture *blurred)
{
    char text[4000];
    Fixture scene;
    text_of(look, "let t = clock", "shutter = 360deg  shutter_steps = 16", text, sizeof text);
    truth_open(&scene, (TruthInput){.text = text, .sky = striped});
    assert_int_equal(scene.scene->n_keys, 17);
    if (fixture_find(&scene, D_VALUE_CHANGES)) fail_msg("%s is told to stay", look->name);
    RenderSettings settings = truth_settings(WIDTH, look->samples);
    truth_render(&scene, &settings, 0, blurred);
    assert_int_equal(blurred->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

/* The mean of the blurred picture and of many sharp ones, the sharp ones stratified in time: the expectation is the
 * same but for the motion between two keys, which is straight. Judged by luminance in cells of the picture. *still: how
 * far the picture as the shutter opens is from that, in the same errors. */
static double compare_with_sharp(const Look *look, double *still)
{
    enum { CELLS = 4, CELL = WIDTH / CELLS };
    Picture blurred, first;
    render_blurred(look, &blurred);
    render_at(look, 0, &first);
    double sum[WIDTH][WIDTH] = {{0}};
    for (uint32_t i = 0; i < look->times; i++) {
        Picture sharp;
        render_at(look, (i + 0.5) / look->times, &sharp);
        for (uint32_t y = 0; y < WIDTH; y++)
            for (uint32_t x = 0; x < WIDTH; x++) sum[y][x] += truth_luminance(&sharp, x, y) / look->times;
        truth_clear(&sharp);
    }
    double worst = 0, squares = 0;
    *still = 0;
    for (int cell = 0; cell < CELLS * CELLS; cell++) {
        double a = 0, b = 0, at_first = 0, variance = 0;
        for (int k = 0; k < CELL * CELL; k++) {
            uint32_t x = (uint32_t)(cell % CELLS * CELL + k % CELL), y = (uint32_t)(cell / CELLS * CELL + k / CELL);
            double error = truth_film_error(&blurred, x, y);
            a += truth_luminance(&blurred, x, y);
            b += sum[y][x];
            at_first += truth_luminance(&first, x, y);
            variance += 2 * error * error; /* both are means of as many paths */
        }
        double sigmas = (a - b) / sqrt(variance);
        worst = fmax(worst, fabs(sigmas));
        squares += sigmas * sigmas;
        *still = fmax(*still, fabs(at_first - b) / sqrt(variance));
        if (sqrt(variance) > look->resolution * b)
            fail_msg("%s, cell %d: too noisy to see a mistake", look->name, cell);
    }
    printf(
        "  %s: blurred against %u sharp pictures: cells differ by %.2f sigmas rms, %.2f at most; the first by %.0f\n",
        look->name, look->times, sqrt(squares / (CELLS * CELLS)), worst, *still);
    truth_clear(&blurred);
    truth_clear(&first);
    return worst;
}

static void blurred_is_the_mean_of_sharp(void **state)
{
    (void)state;
    double still;
    assert_true(compare_with_sharp(&(Look){"all that moves", MOVING OPAQUE, LIT("%s"), SAMPLES, TIMES, 0.02}, &still) <
                4);
}

#define NEAR "camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 40deg  %s }\n" TRUTH_WHITE_SKY
#define PANEL(albedo) "box { size = <4, 4, 1>  surface = surface { albedo = " albedo " } }\n"
#define BALL(place, albedo) "sphere { radius = 1.9  " place "  surface = surface { albedo = " albedo " } }\n"
#define CHECKS "checker { from = .1  to = .9  scale(1.3) "
#define PUFF "def puff(p) = max(0, 2 - length(p * <1, 2, 2>))\n"
#define CLOUD(volume) "medium cloud { mixes = true  scattering = .3  absorption = 1  density = " volume " }\n"

static const Look textures[] = {
    {"a ball through its checks", BALL("center = <t, .5 * t, 0>", CHECKS "}"), NEAR, 256, 32, .02},
    {"a ball with its checks", BALL("translate(<t, .5 * t, 0>)", CHECKS "}"), NEAR, 256, 32, .02},
    {"a ball through checks of the world", BALL("translate(<t, .5 * t, 0>)", CHECKS " space = \"world\" }"), NEAR, 256,
     32, .02},
    {"checks that drift", PANEL(CHECKS "translate(<1.1 * t, .3 * t, 0>) }"), NEAR, 256, 32, .02},
    {"checks that turn the other way",
     "box { size = <3, 3, 1>  rotate(z, 30 * t)  surface = surface { albedo = " CHECKS "rotate(z, -50 * t) } } }\n",
     NEAR, 256, 32, .02},
    {"checks that grow", PANEL("checker { from = .1  to = .9  scale(1 + t) }"), NEAR, 256, 32, .02},
    {"squares of the surface's own that grow",
     "box { size = <4, 4, 1>  surface = surface { albedo = .9  pattern = \"checker\""
     "  check_size = .5 + .4 * t } }\n",
     NEAR, 256, 32, .02},
    {"a wave", PANEL("gradient { from = .1  to = .9  wave = \"ramp\"  frequency = .3  phase = .8 * t }"), NEAR, 256, 32,
     .02},
    {"noise that is stirred", PANEL("noise { from = .1  to = .9  turbulence = t }"), NEAR, 256, 32, .02},
    {"colours", PANEL("checker { from = rgb(.8 * t, .2, .5)  to = rgb(1 - .6 * t, .9, t) }"), NEAR, 256, 32, .02},
    {"a ramp",
     PANEL("gradient { frequency = .25  ramp = [[0, .1], [.2 + .4 * t, .1], [.3 + .4 * t, 1 - .4 * t], [1, .9]] }"),
     NEAR, 256, 32, .02},
    {"a mixture", PANEL("mix { blend = gradient { frequency = .25  phase = .4 * t }  from = .1 to = .8 }"), NEAR, 256,
     32, .02},
    {"a function", "def f(p) = .5 + .4 * sin(100 * p.x + 250 * t) * (p.y > 1.5 - 2 * t ? 1 : 0)\n" PANEL("f"), NEAR,
     256, 32, .02},
    {"an albedo", PANEL("gradient { from = t  to = t }"), NEAR, 256, 32, .02},
    {"a picture",
     PANEL("image { file = \"" __FILE__ "\"  projection = \"planar\"  scale(3 - 1.5 * t)  translate(<0, t, 0>) }"),
     NEAR, 256, 32, .02},
    {"what shines",
     "box { size = <4, 4, 1>  surface = surface { albedo = 0  emission = " CHECKS "translate(<t, 0, 0>) } } }\n", NEAR,
     256, 32, .02},
    {"a mix of surfaces",
     "box { size = <4, 4, 1>  surface = surface { weight = " CHECKS "translate(<t, 0, 0>) }  mix = ["
     "surface { albedo = .1 }, surface { albedo = gradient { phase = t } }] } }\n",
     NEAR, 256, 32, .02},
    {"a bump",
     "sphere { radius = 1.9  surface = surface { albedo = .8  bump = gradient { wave = \"sine\"  phase = t }"
     "  bump_height = .2 } }\n"
     "light { shape = distant  from = <9, 3, 2>  to = <0, 0, 0>  radiance = 20000 }",
     NEAR, 512, 32, .02},
};

static const Look volumes[] = {
    {"a ball through its cloud",
     PUFF CLOUD(
         "volume { function = puff  from = <-2, -2, -2>  to = <2, 2, 2> }") "sphere { interior = cloud  center = <1.5 "
                                                                            "* t - 1, 0, 0>  radius = 1.5 }\n",
     NEAR, 1024, 32, .02},
    {"a box with its cloud",
     PUFF CLOUD("volume { function = puff  from = <-2, -2, -2>  to = <2, 2, 2> }") "box { interior = cloud  size = <4, "
                                                                                   "4, 4>  translate(<t, .5 * t, 0>)  "
                                                                                   "rotate(z, 40 * t) }\n",
     NEAR, 1024, 32, .02},
    {"a cloud that drifts",
     PUFF CLOUD("volume { function = puff  from = <-2, -2, -2>  to = <2, 2, 2>"
                "  translate(<1.5 * t - 1, 0, 0>)  scale(1 - .5 * t) }") "box { interior = cloud  size = <4, 4, 4> }\n",
     NEAR, 1024, 32, .02},
    {"a cut cloud that moves",
     PUFF CLOUD(
         "volume { function = puff  from = <-2, -2, -2>  to = <2, 2, 2> }") "difference { interior = cloud  box { size "
                                                                            "= <4, 4, 4> }  sphere { center = <1, 0, "
                                                                            "0> }  translate(<t, .5 * t, 0>) }\n",
     NEAR, 1024, 32, .02},
    {"a flame that drifts",
     PUFF "medium cloud { mixes = true  absorption = 1  emission = #fff  radiance = 20  density = "
          "volume { function = puff  from = <-2, -2, -2>  to = <2, 2, 2>  translate(<1.5 * t - 1, 0, 0>) } }\n"
          "box { interior = cloud  size = <4, 4, 4> }\n",
     NEAR, 1024, 32, .02},
};

/* The camera stands in what is taken away, beyond all that is left, and is not in it when the shutter closes. */
#define DRILLED                                                                                                        \
    "box { from = <-4, -4, -2>  to = <4, 4, -1> }\n"                                                                   \
    "  box { from = <-1, -1, -9>  to = <1, 1, 9>  translate(<0, 3 * t, 0>) } }\n"
static const Look drills[] = {
    {"a drill around the camera", "difference { surface = surface { albedo = .2 }  " DRILLED, NEAR, 256, 32, .02},
    {"a drill through glass",
     "difference { interior = glass  " DRILLED "ground { y = -2  surface = surface { albedo = .5 } }\n", NEAR, 256, 32,
     .02},
};

static void compare_all(const Look *looks, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        double still;
        assert_true(compare_with_sharp(&looks[i], &still) < 4.5); /* of some hundred cells */
        assert_true(still > 8);                                   /* and what is told apart is there */
    }
}

static void textures_are_blurred(void **state)
{
    (void)state;
    compare_all(textures, COUNT_OF(textures));
}

static void volumes_are_blurred(void **state)
{
    (void)state;
    compare_all(volumes, COUNT_OF(volumes));
}

static void drills_pass_the_camera(void **state)
{
    (void)state;
    compare_all(drills, COUNT_OF(drills));
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
        cmocka_unit_test(textures_are_blurred),
        cmocka_unit_test(volumes_are_blurred),
        cmocka_unit_test(drills_pass_the_camera),
        cmocka_unit_test(moving_furnace),
        cmocka_unit_test(camera_dives),
    };
    return cmocka_run_group_tests_name("motion", tests, NULL, NULL);
}
