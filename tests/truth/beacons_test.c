/* beacons_test.c - boundaries that choose their way by what lies there: the light is what it was, and less noise.
 *
 * A plate that does not absorb, under one angle, mirrors 2 R / (1 + R) of what is before it and shows the rest of what
 * is behind it, R being the reflectance of one of its sides.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

static const double around = 0.2, angle = 50 * TRUTH_PI / 180;

/* A plate seen under the angle, in even light, with lamps of these radiances where the camera looks by mirroring, and
 * through it. */
static void write_plate(Buf *text, const char *ior, double mirrored, double behind)
{
    const double along = sin(angle), up = cos(angle);
    buf_format(text,
               "meniscus 1.0 unit mm medium glass { ior = %s }\n"
               "box { interior = glass  from = <-1000, -5, -1000>  to = <1000, 0, 1000> }\n"
               "camera { from = <0, %g, %g>  to = <0, 0, 0>  fov = .05deg }\n"
               "environment { color = %g }\n",
               ior, 100 * up, -100 * along, around);
    if (mirrored > 0)
        buf_format(text, "light { from = <0, %g, %g>  to = <0, 0, 0>  size = <60, 60>  radiance = %g }\n", 300 * up,
                   300 * along, mirrored);
    if (behind > 0)
        buf_format(text, "light { from = <0, %g, %g>  to = <0, 0, 0>  size = <60, 60>  radiance = %g }\n", -300 * up,
                   300 * along, behind);
}

static Estimate measure(const Buf *text, bool fresnel_alone)
{
    RenderSettings settings = truth_small(256);
    settings.trial.fresnel_alone = fresnel_alone;
    return truth_measure_as(buf_text(text), NULL, &settings);
}

/* Lamps that are seen mirrored, through the plate, and both; brighter than all around them and hardly brighter. */
static void plates_have_their_closed_form(void **state)
{
    (void)state;
    static const double lamps[][2] = {{20, 0}, {0, 20}, {20, 3}, {3, 20}, {2000, 0}, {0.3, 0}};
    double r = truth_fresnel(cos(angle), 1, 1.5), part = 2 * r / (1 + r);
    for (size_t i = 0; i < COUNT_OF(lamps); i++) {
        char what[100];
        Buf text = {0};
        double mirrored = lamps[i][0] > 0 ? lamps[i][0] : around, behind = lamps[i][1] > 0 ? lamps[i][1] : around;
        write_plate(&text, "1.5", lamps[i][0], lamps[i][1]);
        snprintf(what, sizeof what, "a plate, %g mirrored, %g behind", mirrored, behind);
        truth_expect(what, part * mirrored + (1 - part) * behind, measure(&text, false), 4, 0.01);
        buf_clear(&text);
    }
}

/* A lamp that is mirrored is most of a pixel's noise. */
static void mirrored_lamps_are_less_noisy(void **state)
{
    (void)state;
    static const char *const iors[] = {"1.5", "cauchy(1.5, .01)"};
    for (size_t i = 0; i < COUNT_OF(iors); i++) {
        Buf text = {0};
        write_plate(&text, iors[i], 4, 0);
        Estimate aware = measure(&text, false), alone = measure(&text, true);
        double both = hypot(aware.error, alone.error);
        printf("  %s: %.6f +- %.2g by light, %.6f +- %.2g by Fresnel alone\n", iors[i], aware.mean, aware.error,
               alone.mean, alone.error);
        assert_true(fabs(aware.mean - alone.mean) <= 4 * both);
        assert_true(aware.error < 0.6 * alone.error);
        buf_clear(&text);
    }
}

/* Of all pixels of a picture under two skies. */
static Estimate total_of(const char *text, Trial trial, uint32_t samples)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .sky = truth_two_skies, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(32, samples);
    settings.trial = trial;
    truth_render(&scene, &settings, 0, &picture);
    Estimate total = truth_total(&picture);
    truth_clear(&picture);
    fixture_clear(&scene);
    return total;
}

/* Bodies that bend light anywhere, with shading normals, dispersion, absorption and other bodies within: what is
 * predicted is mostly wrong there, and the sum of the light must be the same. */
static void wrong_guesses_cost_nothing_but_noise(void **state)
{
    (void)state;
    static const char text[] =
        "meniscus 1.0 unit mm medium glass { ior = cauchy(1.5, .008)  absorption = .01 / 1mm } medium water { ior = "
        "1.33 }\n"
        "blob { interior = glass  threshold = .4  sphere { radius = 14 }  sphere { center = <13, 1, 3>  radius = 11 } "
        "}\n"
        "sphere { interior = water  radius = 5 }\n"
        "ground { y = -20  surface = surface { albedo = .5 } }\n"
        "light { from = <-60, 70, 20>  to = <0, 0, 0>  size = <60, 60>  radiance = 12 }\n"
        "light { shape = sphere  from = <70, 30, 30>  radius = 12  radiance = 20 }\n"
        "light { shape = \"distant\"  from = <.3, 1, 1>  to = <0, 0, 0>  angle = 20deg  power = 1 }\n"
        "camera { from = <0, 20, 120>  to = <3, 0, 0>  fov = 22deg }\n" TRUTH_SKY;
    Estimate by_light = total_of(text, (Trial){.fresnel_alone = false}, 512),
             alone = total_of(text, (Trial){.fresnel_alone = true}, 512);
    truth_alike("a blob: by light, and by Fresnel alone", alone, by_light, 4, 0.003);
}

/* A pane whose faces are rough, and a sun behind it, off the line of sight: the way in is chosen by the sun that is looked
 * at there. */
static void frosted_panes_are_less_noisy(void **state)
{
    (void)state;
    static const double roughness[] = {0.1, 0.2, 0.35, 0.5}, slant[] = {3, 8, 8, 8};
    static const double at_most[] = {0.65, 0.65, 0.75, 0.95}; /* of the standard error */
    for (size_t i = 0; i < COUNT_OF(roughness); i++) {
        Buf text = {0};
        buf_format(
            &text,
            "meniscus 1.0 unit cm medium glass { ior = 1.52  state = solid }\n"
            "box { interior = glass  from = <-30, -30, 0>  to = <30, 30, .6>  surface = surface { roughness = %g } }\n"
            "light { shape = distant  from = <0, sin(%gdeg), -cos(%gdeg)>  to = <0, 0, 0>  angle = .5deg  radiance = "
            "20000 }\n"
            "environment { color = .1 }\n"
            "camera { from = <0, 0, 120>  to = <0, 0, 0>  fov = .01deg }\n",
            roughness[i], slant[i], slant[i]);
        Estimate seen[2];
        for (int alone = 0; alone < 2; alone++) {
            RenderSettings settings = truth_small(1024);
            settings.trial.frost_alone = alone;
            settings.caustics = CAUSTICS_OFF; /* or photons find the sun, and better where it is rare */
            seen[alone] = truth_measure_as(buf_text(&text), NULL, &settings);
        }
        printf("  a pane of roughness %g: %.6f +- %.2g by light, %.6f +- %.2g by itself\n", roughness[i], seen[0].mean,
               seen[0].error, seen[1].mean, seen[1].error);
        assert_true(fabs(seen[0].mean - seen[1].mean) <= 4 * hypot(seen[0].error, seen[1].error));
        assert_true(seen[0].error < at_most[i] * seen[1].error);
        buf_clear(&text);
    }
}

/* Bodies whose far sides are anywhere, with shading normals, one within another, and lights on all sides and within; and a pane in a
 * liquid whose index is its own at some wavelengths, which go straight on. */
static void frosted_bodies_are_as_bright(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "meniscus 1.0 unit mm medium glass { ior = cauchy(1.5, .008) } medium water { ior = 1.33 }\n"
        "blob { interior = glass  threshold = .4  sphere { radius = 14 }  sphere { center = <13, 1, 3>  radius = 11 }\n"
        "  surface = surface { roughness = .4 } }\n"
        "sphere { interior = water  radius = 5  surface = surface { roughness = .3 } }\n"
        "sphere { center = <12, 1, 3>  radius = 1  surface = surface { emission = 9  albedo = 0 } }\n"
        "ground { y = -20  surface = surface { albedo = .5 } }\n"
        "light { from = <-60, 70, 20>  to = <0, 0, 0>  size = <60, 60>  radiance = 12 }\n"
        "light { shape = sphere  from = <20, 10, -60>  radius = 6  radiance = 60 }\n"
        "camera { from = <0, 20, 120>  to = <3, 0, 0>  fov = 22deg }\n" TRUTH_SKY,
        "meniscus 1.0 unit mm medium glass { ior = cauchy(1.5, .008) } medium liquid { ior = 1.525 }\n"
        "box { interior = liquid  from = <-200, -200, -200>  to = <200, 200, 200> }\n"
        "box { interior = glass  from = <-60, -60, -3>  to = <60, 60, 3>  surface = surface { roughness = .9 } }\n"
        "light { shape = sphere  from = <0, 0, -60>  radius = 9  radiance = 60 }\n"
        "camera { from = <0, 0, 120>  to = <0, 0, 0>  fov = 12deg }\n" TRUTH_SKY};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        Estimate by_light = total_of(texts[i], (Trial){.frost_alone = false}, 1024),
                 alone = total_of(texts[i], (Trial){.frost_alone = true}, 1024);
        truth_alike("frosted bodies: by light, and by themselves", alone, by_light, 4, 0.005);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(plates_have_their_closed_form),        cmocka_unit_test(mirrored_lamps_are_less_noisy),
        cmocka_unit_test(wrong_guesses_cost_nothing_but_noise), cmocka_unit_test(frosted_panes_are_less_noisy),
        cmocka_unit_test(frosted_bodies_are_as_bright),
    };
    return cmocka_run_group_tests_name("beacons", tests, NULL, NULL);
}
