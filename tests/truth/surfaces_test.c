/* surfaces_test.c - rough boundaries, skins, coats and metals in scenes: white furnaces, and light that is the same
 * whether light sampling or scattering finds it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 32 };

#define HEAD                                                                                                           \
    "meniscus 1.0 unit m\n"                                                                                            \
    "medium glass { ior = 1.5  state = solid } medium gem { ior = 2.42  state = solid } medium water { ior = 1.33  state = liquid }\n" \
    "medium flint { ior = cauchy(1.6, .01)  state = solid }\n"
#define VIEW "camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 22deg }\n"

static double two_skies(double elevation)
{
    return elevation > 0.4 ? 3 : 0.2;
}

static Picture render(const char *text, uint32_t samples)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .sky = two_skies});
    RenderSettings settings = truth_settings(WIDTH, samples);
    settings.bounces = 1000000;
    truth_render(&scene, &settings, 0, &picture);
    if (picture.stats.nesting_faults) fail_msg("%s: nesting faults", text);
    fixture_clear(&scene);
    return picture;
}

/* Nothing is absorbed, and so everything is 1: what one facet throws at another is not lost. The bound is that of the
 * tables by which it is kept. */
static void white_furnaces(void **state)
{
    (void)state;
    static const char *const things[] = {
        "sphere { interior = glass  surface = surface { roughness = %g } }",
        "sphere { interior = gem  surface = surface { roughness = %g } }",
        "sphere { interior = flint  surface = surface { roughness = %g } }",
        "sphere { interior = glass  surface = surface { roughness = %g } } sphere { interior = water  center = <.3, .2, 0>  radius = .9 }",
        "sphere { surface = surface { albedo = 1  ior = 1.5  roughness = %g } }",
        "sphere { surface = surface { albedo = 1  coat = .7  coat_roughness = %g } }",
        "sphere { surface = surface { albedo = 1  diffuse_roughness = %g } }",
        "sphere { interior = water  radius = 1.3 } sphere { surface = surface { albedo = 1  ior = 1.5  roughness = %g } }",
    };
    const double roughness[] = {0.1, 0.3, 0.6, 1};
    for (size_t i = 0; i < COUNT_OF(things); i++)
        for (size_t k = 0; k < COUNT_OF(roughness); k++) {
            char thing[400], text[1200], what[140];
            snprintf(what, sizeof what, "%.*s..., roughness %g", 62, things[i], roughness[k]);
            const char *hole = strstr(things[i], "%g");
            snprintf(thing, sizeof thing, "%.*s%g%s", (int)(hole - things[i]), things[i], roughness[k], hole + 2);
            snprintf(text, sizeof text, HEAD "%s " VIEW TRUTH_WHITE_SKY, thing);
            Picture picture = render(text, 256);
            Estimate mean = truth_mean(&picture, -1);
            truth_figure(what, 1, mean.mean, mean.error);
            if (!(fabs(mean.mean - 1) <= 0.005 + 3 * mean.error)) fail_msg("%s: %.5f +- %.5f", what, mean.mean, mean.error);
            assert_true(mean.error < 0.01);
            truth_clear(&picture);
        }
}

/* Within a medium of next to no index of its own around everything, light sampling is blocked by the boundary, and all
 * light is found by scattering. */
static void lights_are_found_alike(void **state)
{
    (void)state;
    static const char *const things[] = {
        "sphere { interior = glass  surface = surface { roughness = .5 } }",
        "sphere { surface = surface { metal = gold  roughness = .4 } }",
        "sphere { surface = surface { albedo = rgb(.8, .3, .1)  ior = 1.5  roughness = .3 } }",
        "sphere { surface = surface { albedo = rgb(.8, .3, .1)  coat = 1  coat_roughness = .5  coat_tint = rgb(.9, .8, .3) } }",
        "sphere { surface = surface { albedo = .8  diffuse_roughness = 1 } }",
    };
    for (size_t i = 0; i < COUNT_OF(things); i++) {
        Estimate seen[2];
        for (int chance = 0; chance < 2; chance++) {
            char text[1200];
            snprintf(text, sizeof text, HEAD "%s %s " VIEW TRUTH_SKY, things[i],
                     chance ? "medium veil { ior = 1.00001 } sphere { interior = veil  radius = 20  priority = -1 }" : "");
            Picture picture = render(text, 512);
            seen[chance] = truth_total(&picture);
            truth_clear(&picture);
        }
        truth_expect(things[i], 1,
                     (Estimate){seen[0].mean / seen[1].mean,
                                hypot(seen[0].error / seen[0].mean, seen[1].error / seen[1].mean)},
                     4, 0.01);
    }
}

/* What reflects under water reflects less: a skin of water's own index is not there. */
static void surroundings_count(void **state)
{
    (void)state;
    static const char *const text[] = {
        HEAD "sphere { interior = water  radius = 20 } sphere { surface = surface { albedo = 0  ior = 1.33 } }" VIEW TRUTH_WHITE_SKY,
        HEAD "sphere { surface = surface { albedo = 0  ior = 1.33 } }" VIEW TRUTH_WHITE_SKY,
    };
    double middle[2];
    for (int i = 0; i < 2; i++) {
        Picture picture = render(text[i], 2048);
        middle[i] = truth_luminance(&picture, WIDTH / 2, WIDTH / 2);
        truth_clear(&picture);
    }
    double expected = pow(0.33 / 2.33, 2);
    truth_figure("a skin of water in the air, head on", expected, middle[1], 0);
    truth_figure("the same in water", 0, middle[0], 0);
    assert_true(middle[0] < 1e-5);
    assert_true(fabs(middle[1] - expected) < 0.03 * expected);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_furnaces),
        cmocka_unit_test(lights_are_found_alike),
        cmocka_unit_test(surroundings_count),
    };
    return cmocka_run_group_tests_name("surfaces", tests, NULL, NULL);
}
