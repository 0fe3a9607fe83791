/* catcher_test.c - shadow catchers: what is nothing where nothing is, shadows in closed form, and the picture that they
 * make of another one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include <string.h>

enum { WIDTH = 8, SAMPLES = 1024, SIDE = 24 };

#define HEAD "meniscus 1.0 unit m  param catch = true  param full = true  film { filter = box }\n"
#define CATCHER(what) " surface = surface { " what "  shadow_catcher = catch } "
#define GREY CATCHER("albedo = .5")
#define HIDDEN_SKY " environment { color = 1  visible = false } "
/* A spot of a floor at y = 0, seen from beside, under all that is higher than 2. */
#define SPOT " camera { from = <20, 2, 0>  to = <0, 0, 0>  projection = orthographic  width = .001 } "

static Picture take(const char *text, bool catches, bool full, const RenderSettings *settings)
{
    Fixture scene;
    Picture picture;
    const char *const defines[] = {catches ? "catch=true" : "catch=false", full ? "full=true" : "full=false", NULL};
    truth_open(&scene, (TruthInput){.text = text, .defines = defines});
    truth_render(&scene, settings, 0, &picture);
    fixture_clear(&scene);
    return picture;
}

static const float *pixel_at(const Picture *picture, size_t i)
{
    return picture->image.pixels + i * picture->image.n_channels;
}

/* ---- where nothing is ---- */

#define LAMP " light { from = <5, 9, 3>  to = <0, 0, 0>  size = <3, 3>  radiance = 20 } "
#define LOOK_DOWN " camera { from = <0, 8, 20>  to = <0, 1, 0>  fov = 40 } "
#define FLOOR " plane { " GREY " } "

/* No noise is left, as both paths of a sample find the same. */
static void nothing_is_caught_where_nothing_is(void **state)
{
    static const char *const scenes[] = {
        FLOOR LAMP,
        FLOOR HIDDEN_SKY,
        FLOOR " environment { sky = clear  elevation = 30deg  visible = false } ",
        FLOOR
        " light { shape = point  from = <3, 9, 3>  intensity = 100 } light { shape = distant  from = <3, 9, 3>  to = "
        "<0, 0, 0>  angle = .5 } light { shape = sphere  from = <0, 9, 0>  radius = 2  visible = false } ",
        " plane { " CATCHER("albedo = .5  ior = 1.5  roughness = .2") " } " LAMP HIDDEN_SKY,
        " plane { " CATCHER("metal = silver") " } " HIDDEN_SKY,
        " plane { " CATCHER("pattern = checker  albedo = rgb(.9, .2, .1)") " } " LAMP,
        /* catchers light each other */
        FLOOR
        " box { from = <-30, -1, -6>  to = <30, 20, -5> " CATCHER("albedo = rgb(.9, .2, .2)") " } " LAMP HIDDEN_SKY,
        " difference { box { from = <-9, -4, -9>  to = <9, 0, 9> }  sphere { radius = 2  translate(<0, 0, 5>) } " GREY
        " } " LAMP HIDDEN_SKY,
        /* the camera is within an operand */
        " difference { box { from = <-90, -4, -90>  to = <90, 30, 90> }  box { from = <-12, 0, -30>  to = <12, 40, 30> "
        "} " GREY " } " LAMP HIDDEN_SKY,
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(scenes); i++)
        for (int denoised = 0; denoised < 2; denoised++) {
            char text[2000];
            snprintf(text, sizeof text, HEAD LOOK_DOWN "%s", scenes[i]);
            RenderSettings settings = truth_settings(SIDE, 16);
            settings.denoises = settings.spreads = denoised;
            Picture picture = take(text, true, true, &settings);
            for (size_t k = 0; k < SIDE * SIDE; k++)
                for (int c = 0; c < 4; c++)
                    if (pixel_at(&picture, k)[c] != 0)
                        fail_msg("%s: channel %d of pixel %zu is %g", scenes[i], c, k,
                                 (double)pixel_at(&picture, k)[c]);
            assert_int_equal(picture.stats.nesting_faults, 0);
            truth_clear(&picture);
        }
}

/* ---- shadows ---- */

typedef struct Caught {
    Estimate alpha, light;
} Caught;

static Caught measure(const char *matter, const char *sky)
{
    char text[3000];
    double alphas[WIDTH * WIDTH];
    snprintf(text, sizeof text, HEAD SPOT FLOOR "%s\n%s", sky, matter);
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    Picture picture = take(text, true, true, &settings);
    for (size_t i = 0; i < WIDTH * WIDTH; i++) alphas[i] = (double)pixel_at(&picture, i)[3];
    Caught caught = {truth_estimate(alphas, WIDTH * WIDTH), truth_mean(&picture, -1)};
    truth_clear(&picture);
    return caught;
}

/* A disc of radius r at a height h takes r^2 / (r^2 + h^2) of an even sky from the place under its middle, and gives as
 * much of its own radiance; absorbers take 1 - exp(-s d) of light from above, and what is before the floor as much of all
 * that comes from it. */
static void shadows_have_their_depth(void **state)
{
#define DISC(what)                                                                                                     \
    "cylinder { radius = 2  from = <0, 3, 0>  to = <0, 3.01, 0>  surface = surface { albedo = 0 " what " } }"
    const double f = 4 / (4. + 9), taken = 1 - exp(-.6);
    const char *sun = " light { shape = distant  from = <0, 1, 0>  to = <0, 0, 0>  angle = .1 } ";
    const struct {
        const char *what, *matter, *sky;
        double alpha, light;
    } cases[] = {
        {"a disc under a sky", DISC(""), HIDDEN_SKY, f, 0},
        {"one that is dimmer", DISC("emission = .25"), HIDDEN_SKY, .75 * f, 0},
        {"one that is brighter", DISC("emission = 3"), HIDDEN_SKY, 0, .5 * 2 * f},
        {"a wall around", "box { from = <-9, 2.5, -9>  to = <9, 3, 9>  surface = surface { albedo = 0 } }", sun, 1, 0},
        {"an absorber above",
         "medium grey { ior = 1  absorption = .3 } box { from = <-9, 3, -9>  to = <9, 5, 9>  interior = grey }", sun,
         taken, 0},
        {"a lamp above, and no other light", DISC("emission = 3"), " ", 0, .5 * 3 * f},
        {"sheets before it, seen nowhere",
         "box { from = <9, -1, -9>  to = <9.5, 9, 9>  surface = surface { thin = true  ior = 1.5  transmission = 1  "
         "specular = 0 } }",
         HIDDEN_SKY, 0, 0},
        {"black nets before it",
         "box { from = <9, -1, -9>  to = <9.5, 9, 9>  surface = surface { thin = true  ior = 1.001  transmission = .5  "
         "albedo = 0 } }",
         sun, 1 - .25, 0},
        {"what is bent", "medium glass { ior = 1.5 } sphere { center = <9, .9, 0>  radius = .5  interior = glass }",
         sun, 1, -1},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Caught caught = measure(cases[i].matter, cases[i].sky);
        /* of three channels with noise the least is a little less than each */
        truth_expect(cases[i].what, cases[i].alpha, caught.alpha, 4, 0.01);
        if (cases[i].light > 0) truth_expect("and what it adds", cases[i].light, caught.light, 3, 0.01);
        if (cases[i].light == 0) assert_near(caught.light.mean, 0, 0.002);
    }
}

/* What is clear and red takes more of green and blue: their part is alpha, and red is added. */
static void shadows_are_coloured(void **state)
{
    char text[2000];
    (void)state;
    snprintf(text, sizeof text,
             HEAD SPOT FLOOR " light { shape = distant  from = <0, 1, 0>  to = <0, 0, 0>  angle = .1 }\n"
                             "medium red { ior = 1  tint = rgb(.8, .2, .2)  depth = 1 }\n"
                             "if (full) { box { from = <-9, 3, -9>  to = <9, 4, 9>  interior = red } }");
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    Picture caught = take(text, true, true, &settings), lit = take(text, false, true, &settings),
            bare = take(text, false, false, &settings);
    double alpha = 0, red[2] = {0}, green[2] = {0};
    for (size_t i = 0; i < WIDTH * WIDTH; i++) alpha += (double)pixel_at(&caught, i)[3] / (WIDTH * WIDTH);
    for (int full = 0; full < 2; full++) {
        red[full] = truth_mean(full ? &lit : &bare, 0).mean;
        green[full] = fmin(truth_mean(full ? &lit : &bare, 1).mean, truth_mean(full ? &lit : &bare, 2).mean);
    }
    truth_figure("alpha", 1 - green[1] / green[0], alpha, 0);
    assert_near(alpha, 1 - green[1] / green[0], 0.01);
    assert_near(truth_mean(&caught, 0).mean, red[1] - (1 - alpha) * red[0], 0.01);
    assert_true(truth_mean(&caught, 0).mean > 0.3 * red[0]);
    truth_clear(&caught);
    truth_clear(&lit);
    truth_clear(&bare);
}

/* ---- over another picture ---- */

/* The part of the pixels in which the picture over one of the bare scene is another than that of the whole scene, by more
 * than three standard errors; not none, as some have light that others have by chance. Each picture has samples of its
 * own. */
static double unlike_over_bare(const char *what, const char *text)
{
    RenderSettings settings = truth_settings(SIDE, 256);
    Picture caught = take(text, true, true, &settings);
    settings.seed = 2;
    Picture lit = take(text, false, true, &settings);
    settings.seed = 3;
    Picture bare = take(text, false, false, &settings);
    double unlike = 0, sum = 0, sum_of_variances = 0, partly = 0;
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            size_t i = (size_t)y * SIDE + x;
            double clear = 1 - (double)pixel_at(&caught, i)[3], own = truth_film_error(&lit, x, y),
                   behind = clear * truth_film_error(&bare, x, y);
            /* lit of one seed and of another; bare of one seed, as far as it is not the same, and of another */
            double variance = 2 * own * own + 2 * behind * behind + 1e-10;
            double over = truth_luminance(&caught, x, y) + clear * truth_luminance(&bare, x, y);
            double difference = over - truth_luminance(&lit, x, y);
            unlike += difference * difference > 9 * variance;
            sum += difference;
            sum_of_variances += variance;
            partly += clear > 0.01 && clear < 0.99;
        }
    char line[200];
    snprintf(line, sizeof line, "%s, in standard errors: the sum", what);
    truth_figure(line, 0, sum / sqrt(sum_of_variances), 1);
    assert_true(fabs(sum) < 4 * sqrt(sum_of_variances));
    assert_true(partly > 50);
    truth_clear(&caught);
    truth_clear(&lit);
    truth_clear(&bare);
    return unlike / (SIDE * SIDE);
}

#define THINGS                                                                                                         \
    "medium glass { ior = media.abbe(1.5, 30)  tint = rgb(.9, .4, .1)  depth = 1 }\n"                                  \
    "if (full) { sphere { center = <-3, 2, 0>  radius = 2  interior = glass }\n"                                       \
    "sphere { center = <3, 1.5, 1>  radius = 1.5  surface = surface { albedo = rgb(.1, .3, .8) } } }\n"

static void over_the_bare_picture_it_is_the_whole_one(void **state)
{
    static const struct {
        const char *what, *scene;
    } cases[] = {
        {"a lamp", LOOK_DOWN FLOOR LAMP},
        {"a lamp and a sky", LOOK_DOWN FLOOR LAMP HIDDEN_SKY},
        {"a skin", LOOK_DOWN " plane { " CATCHER("albedo = .5  ior = 1.5  roughness = .2") " } " HIDDEN_SKY LAMP},
        {"a cove", LOOK_DOWN FLOOR " box { from = <-30, -1, -6>  to = <30, 20, -5> " CATCHER("albedo = .8") " } " LAMP},
        {"a table with a hollow", LOOK_DOWN
         " difference { box { from = <-9, -4, -9>  to = <9, 0, 9> }  sphere { radius = 2  translate(<0, 0, 5>) } " GREY
         " } " LAMP HIDDEN_SKY},
        {"a lens",
         " camera { from = <0, 8, 20>  to = <0, 1, 0>  fov = 40  aperture = 1  focus = <0, 0, 4> } " FLOOR LAMP},
        {"smoke", LOOK_DOWN FLOOR LAMP "medium smoke { mixes = true  scattering = .1 } if (full) { box { from = <-2, "
                                       "0, 2>  to = <2, 4, 5>  interior = "
                                       "smoke } }"},
        {"a thing that shines", LOOK_DOWN FLOOR LAMP
         "if (full) { sphere { center = <0, .5, 3>  radius = .5  surface = surface { emission = 9 } } }"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[3000];
        snprintf(text, sizeof text, HEAD "use \"std/media.mns\" as media\n%s\n" THINGS, cases[i].scene);
        double unlike = unlike_over_bare(cases[i].what, text);
        truth_figure("  and the part of its pixels beyond three", 0, unlike, 0);
        assert_true(unlike < 0.02);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_caught_where_nothing_is),
        cmocka_unit_test(shadows_have_their_depth),
        cmocka_unit_test(shadows_are_coloured),
        cmocka_unit_test(over_the_bare_picture_it_is_the_whole_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
