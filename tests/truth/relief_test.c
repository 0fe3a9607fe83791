/* relief_test.c - bumps move light about: in a white furnace they neither make any nor lose any, however
 * steep they are, and light sampling and scattering agree about them. Textures that are the same everywhere are the value
 * itself.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 24 };

#define HEAD                                                                                                           \
    "meniscus 1.0 unit m medium glass { ior = 1.5  state = solid } medium water { ior = 1.33  state = liquid }\n"
#define VIEW " camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 22deg } "

/* Slopes of about 45 degrees, and of 85. */
static const char *const reliefs[] = {
    "bump = noise { octaves = 2 scale(.2) } bump_height = .15",
    "bump = crackle { scale(.1) } bump_height = 1",
};

static void white_furnaces(void **state)
{
    (void)state;
    static const char *const things[] = {
        "sphere { surface = surface { albedo = 1 %s } }",
        "sphere { surface = surface { albedo = 1 diffuse_roughness = .7 %s } }",
        "sphere { surface = surface { albedo = 1 ior = 1.5 roughness = .3 %s } }",
        "sphere { surface = surface { albedo = 1 ior = 1.5 roughness = 0 %s } }",
        "sphere { surface = surface { albedo = 1 coat = .7 coat_roughness = .2 %s } }",
        "sphere { interior = glass surface = surface { %s } }",
        "sphere { interior = glass surface = surface { roughness = .4 %s } }",
        /* nested and overlapping: which side a ray is on is the surface's to say, whatever its relief; truth_render_text
         * takes no fault of nesting */
        "sphere { interior = glass surface = surface { %s } } sphere { interior = water center = <.4, .2, 0> radius = "
        ".9 "
        "surface = surface { roughness = .3 bump = noise { scale(.1) } bump_height = .1 } } "
        "sphere { interior = air radius = .3 surface = surface { bump = crackle { scale(.1) } bump_height = 1 } }",
        "box { size = <1.6, 1.6, 1.6> rotate(<20, 30, 0>) surface = surface { albedo = 1 ior = 1.5 roughness = .5 %s } "
        "}",
    };
    double worst = 0;
    for (size_t i = 0; i < COUNT_OF(things); i++)
        for (size_t k = 0; k < COUNT_OF(reliefs); k++) {
            char thing[400], text[1200], what[140];
            truth_fill(thing, sizeof thing, things[i], reliefs[k]);
            snprintf(text, sizeof text, HEAD "%s" VIEW TRUTH_WHITE_SKY, thing);
            snprintf(what, sizeof what, "%.55s..., relief %zu", things[i], k);
            worst = fmax(worst, fabs(truth_white(what, text, WIDTH, 128, 0.005) - 1));
        }
    printf("    at worst %.5f off\n", worst);
}

/* Behind a boundary of next to no index, light sampling is blocked, and all light is found by scattering. */
static void lights_are_found_alike(void **state)
{
    (void)state;
    static const char *const finishes[] = {"albedo = .8", "albedo = .8 ior = 1.5 roughness = .4",
                                           "metal = gold roughness = .5"};
    for (size_t i = 0; i < COUNT_OF(finishes); i++) {
        Estimate seen[2];
        for (int chance = 0; chance < 2; chance++) {
            char text[1200];
            snprintf(text, sizeof text,
                     HEAD "medium nearly { ior = 1.0000001 state = gas } sphere { surface = surface { %s "
                          "bump = noise { octaves = 2 scale(.2) } bump_height = .2 } } %s" VIEW TRUTH_SKY,
                     finishes[i], chance ? "sphere { radius = 3 interior = nearly }" : "");
            Picture picture = truth_render_text(text, WIDTH, 512);
            seen[chance] = truth_total(&picture);
            truth_clear(&picture);
        }
        truth_alike(finishes[i], seen[0], seen[1], 4, 0.01);
    }
}

/* The same picture, sample for sample, from a constant and from textures that come to it. */
static void constants_are_constants(void **state)
{
    (void)state;
    static const char *const pairs[][2] = {
        {"albedo = rgb(.8, .3, .1)", "albedo = noise { from = rgb(.8, .3, .1) to = rgb(.8, .3, .1) }"},
        {"albedo = .5 ior = 1.5 roughness = .3", "albedo = .5 ior = 1.5 roughness = marble { from = .3 to = .3 }"},
        {"albedo = .5 coat = .4 coat_roughness = .2 coat_tint = rgb(.9, .5, .2)",
         "albedo = mix { from = .5 to = .5 } coat = brick { ramp = [.4] } coat_roughness = agate { from = .2 to = .2 } "
         "coat_tint = variation { ramp = [rgb(.9, .5, .2), rgb(.9, .5, .2)] }"},
    };
    for (size_t i = 0; i < COUNT_OF(pairs); i++) {
        Picture pictures[2];
        for (int k = 0; k < 2; k++) {
            char text[1200];
            snprintf(text, sizeof text, HEAD "sphere { surface = surface { %s } } " VIEW TRUTH_SKY, pairs[i][k]);
            pictures[k] = truth_render_text(text, WIDTH, 64);
        }
        double difference = truth_largest_difference(&pictures[0], &pictures[1]);
        printf("    %.50s: at most %.2g apart\n", pairs[i][0], difference);
        assert_true(difference < 1e-4);
        for (int k = 0; k < 2; k++) truth_clear(&pictures[k]);
    }
}

/* What shines by a texture lights a floor as what it looks like: found by sampling or by chance, and where the texture
 * comes to a constant, like one. */
static void textures_shine(void **state)
{
    (void)state;
    static const char *const shapes[] = {
        "sphere { radius = .5 %s translate(<0, 1, 0>) }",
        "box { size = <1, 1, 1> rotate(<30, 40, 0>) %s translate(<0, 1, 0>) }",
        "cylinder { to = <0, .8, 0> radius = .4 %s translate(<0, .7, 0>) }",
    };
    static const char *const emissions[] = {
        "surface = surface { albedo = 0 emission = rgb(3, 2, 1) }",
        "surface = surface { albedo = 0 emission = noise { from = rgb(3, 2, 1) to = rgb(3, 2, 1) } }",
        "surface = surface { albedo = 0 emission = gradient { ramp = [rgb(6, 1, 0), rgb(0, 3, 2)] wave = once "
        "translate(<-.5, 0, 0>) } }",
    };
    for (size_t i = 0; i < COUNT_OF(shapes); i++) {
        Estimate seen[4];
        for (int k = 0; k < 4; k++) { /* the last by chance */
            char thing[400], text[1200];
            truth_fill(thing, sizeof thing, shapes[i], emissions[k < 3 ? k : 2]);
            snprintf(text, sizeof text,
                     HEAD
                     "medium nearly { ior = 1.0000001 state = gas } %s ground { surface = surface { albedo = .8 } } %s "
                     "camera { from = <0, 6, 3> to = <.8, 0, .6> fov = 12deg }",
                     thing, k == 3 ? "sphere { radius = 1 center = <0, 1.01, 0> interior = nearly }" : "");
            Picture picture = truth_render_text(text, WIDTH, k == 3 ? 2048 : 64);
            seen[k] = truth_total(&picture);
            truth_clear(&picture);
        }
        printf("    %.20s: a constant gives %.4f, a texture that is one %.4f\n", shapes[i], seen[0].mean, seen[1].mean);
        assert_near(seen[1].mean / seen[0].mean, 1, 1e-4);
        truth_alike("by sampling and by chance", seen[2], seen[3], 4, 0.05);
    }
}

static double luminance_error(const Picture *a, const Picture *b)
{
    double sum = 0;
    for (uint32_t y = 0; y < a->image.height; y++)
        for (uint32_t x = 0; x < a->image.width; x++)
            sum += pow(truth_luminance(a, x, y) - truth_luminance(b, x, y), 2) /
                   ((double)a->image.width * a->image.height);
    return sqrt(sum);
}

/* A ground of squares up to the horizon, seen directly, through a pane, and in a mirror: averaged over what a sample sees
 * it has the mean of what points have, and less noise. Behind glass and mirrors a sample is taken to see a quarter. */
static void far_patterns_are_averaged(void **state)
{
    (void)state;
    static const char *const views[][2] = {
        {"directly", "camera { from = <0, 1, 0>  to = <0, .75, 5>  fov = 20deg }"},
        {"through a pane", "camera { from = <0, 1, 0>  to = <0, .75, 5>  fov = 20deg } "
                           "box { from = <-2, -1, 1>  to = <2, 3, 1.1>  interior = glass }"},
        {"in a mirror",
         "camera { from = <0, 1, 0>  to = <0, 1.1, -5>  fov = 20deg } "
         "box { from = <-9, -1, -9>  to = <9, 9, -8>  surface = surface { metalness = 1  albedo = 1 } }"},
    };
    static const char *const squares[] = {"checker { from = .1  to = .9  scale(.1) }",
                                          "formula { function = squares  from = .1  to = .9  scale(.1) }"};
    for (size_t i = 0; i < COUNT_OF(views); i++) {
        Picture few[2], many[2];
        for (int k = 0; k < 2; k++) {
            char text[1200];
            snprintf(text, sizeof text,
                     HEAD "def squares(p) = mod(floor(p.x) + floor(p.y) + floor(p.z), 2) "
                          "ground { surface = surface { albedo = %s } } %s " TRUTH_WHITE_SKY,
                     squares[k], views[i][1]);
            few[k] = truth_render_text(text, 48, 4);
            many[k] = truth_render_text(text, 48, 256);
        }
        Estimate averaged = truth_mean(&many[0], -1), points = truth_mean(&many[1], -1);
        double quiet = luminance_error(&few[0], &many[1]), loud = luminance_error(&few[1], &many[1]);
        printf("    %-15s means %.4f averaged, %.4f by points; noise of 4 samples %.4f and %.4f\n", views[i][0],
               averaged.mean, points.mean, quiet, loud);
        assert_true(fabs(averaged.mean - points.mean) < 0.004 * points.mean + 3 * (averaged.error + points.error));
        assert_true(quiet < (i == 0 ? 0.8 : 0.97) * loud);
        for (int k = 0; k < 2; k++) {
            truth_clear(&few[k]);
            truth_clear(&many[k]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_furnaces),
        cmocka_unit_test(lights_are_found_alike),
        cmocka_unit_test(constants_are_constants),
        cmocka_unit_test(textures_shine),
        cmocka_unit_test(far_patterns_are_averaged),
    };
    return cmocka_run_group_tests_name("relief", tests, NULL, NULL);
}
