/* crystal_test.c - double refraction in pictures: what a plate of calcite lets through of each polarization, where the second image
 * lies, an axis that turns with its object, and furnaces.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

static const double degree = TRUTH_PI / 180;
static const double calcite_o = 1.6584, calcite_e = 1.4864;

#define CALCITE "meniscus 1.0 unit mm medium calcite { ior = 1.6584  extraordinary_ior = 1.4864  optic_axis = <%s> }\n"
#define PLATE "box { interior = calcite  from = <-90, 0, -90>  to = <90, 10, 90> }\n"
#define SPOT "camera { from = <%s>  to = <0, 10, 0>  projection = orthographic  width = .001  up = <0, 0, 1> }\n"

/* Of one polarization, with all reflections within: R at either face. */
static double passed(double reflectance)
{
    return (1 - reflectance) / (1 + reflectance);
}

/* Light that swings across the plane of incidence, or along it. */
static double polarized(double cosine, double ior, bool across)
{
    const double refracted = sqrt(1 - (1 - cosine * cosine) / (ior * ior));
    const double r = across ? (cosine - ior * refracted) / (cosine + ior * refracted)
                            : (ior * cosine - refracted) / (ior * cosine + refracted);
    return r * r;
}

/* Bright below the horizon, black above: what a plate lets through from below. */
static double sky_below(double elevation)
{
    return elevation < 0 ? 1 : 0;
}

/* The axis lies in the plate, across the plane of incidence: light that swings across has the extraordinary index, and that along the
 * ordinary one; neither becomes the other. */
static void a_plate_polarizes(void **state)
{
    (void)state;
    static const int angles[] = {0, 40, 70, 80};
    for (size_t i = 0; i < COUNT_OF(angles); i++) {
        char text[1000], from[100], what[100];
        const double angle = angles[i] * degree;
        snprintf(from, sizeof from, "%.9f, %.9f, 0", 40 * sin(angle), 10 + 40 * cos(angle));
        snprintf(text, sizeof text, CALCITE PLATE SPOT TRUTH_SKY, "0, 0, 1", from);
        const double expected =
            0.5 * (passed(polarized(cos(angle), calcite_e, true)) + passed(polarized(cos(angle), calcite_o, false)));
        snprintf(what, sizeof what, "light through a plate of calcite at %d degrees", angles[i]);
        truth_expect(what, expected, truth_measure(text, sky_below, 4096, false), 4, 0.005);
    }
}

/* What passes a plate of the thickness, head on, of one wave: with all reflections within. */
static double absorbed(double ior, double absorption, double thickness)
{
    const double r = pow((ior - 1) / (ior + 1), 2), a = exp(-absorption * thickness);
    return (1 - r) * (1 - r) * a / (1 - r * r * a * a);
}

/* Each wave is absorbed in its own way: along the axis both as ordinary light, across it one more than the other, and between in
 * proportion to the square of the field along the axis. */
static void crystals_have_two_colors(void **state)
{
    (void)state;
    static const int angles[] = {0, 30, 60, 90}; /* of the axis, from the normal */
    for (size_t i = 0; i < COUNT_OF(angles); i++) {
        char text[1000], what[100];
        const double angle = angles[i] * degree, o = 1.64, e = 1.6, by_o = 0.03, by_e = 0.2;
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit mm medium stone { ior = 1.64  extraordinary_ior = 1.6  optic_axis = <%.9f, %.9f, 0>\n"
            "  absorption = .03 / 1mm  extraordinary_absorption = .2 / 1mm }\n"
            "box { interior = stone  from = <-90, 0, -90>  to = <90, 10, 90> }\n" SPOT TRUTH_SKY,
            sin(angle), cos(angle), "0, 50, 0");
        /* the ray walks off the normal, and its field leans as much */
        const double off = atan((o * o - e * e) * tan(angle) / (e * e + o * o * tan(angle) * tan(angle)));
        const double index = 1 / sqrt(pow(cos(angle) / o, 2) + pow(sin(angle) / e, 2));
        const double field = angles[i] == 90 ? 1 : pow(sin(angle + off), 2);
        const double expected =
            0.5 * (absorbed(o, by_o, 10) + absorbed(index, by_o + field * (by_e - by_o), 10 / cos(off)));
        snprintf(what, sizeof what, "light through a stone of two colours, its axis at %d degrees", angles[i]);
        truth_expect(what, expected, truth_measure(text, sky_below, 4096, false), 4, 0.005);
    }
}

/* Half a plane shines below a plate whose axis is at 45 degrees to its faces: seen from above its edge is where it is by ordinary light,
 * and 10 mm * tan(6.22 degrees) beside that by the other. */
static void images_are_two(void **state)
{
    (void)state;
    const double square_o = calcite_o * calcite_o, square_e = calcite_e * calcite_e;
    const double beside = 10 * (square_o - square_e) / (square_o + square_e),
                 index_e = sqrt(2 / (1 / square_o + 1 / square_e));
    const double by_o = 0.5 * passed(polarized(1, calcite_o, true)), by_e = 0.5 * passed(polarized(1, index_e, true));
    /* light that goes down bends away from an axis that comes up: to its side */
    for (int side = -1; side <= 1; side += 2) {
        const double edge_e = -side * beside,
                     places[] = {-beside - 0.1, -beside + 0.1, -0.1, 0.1, beside - 0.1, beside + 0.1};
        const char *axis = side > 0 ? "1, 1, 0" : "-1, 1, 0";
        for (size_t i = 0; i < COUNT_OF(places); i++) {
            char text[1000], what[100];
            snprintf(text, sizeof text,
                     CALCITE PLATE "light { from = <-40, -.01, 0>  to = <-40, 0, 0>  size = <80, 80>  radiance = 1 }\n"
                                   "camera { from = <%.9f, 50, 0>  to = <%.9f, 10, 0>  projection = orthographic  "
                                   "width = .001  up = <0, 0, 1> }\n",
                     axis, places[i], places[i]);
            snprintf(what, sizeof what, "half a plane under a plate, %.2f mm beside its edge", places[i]);
            const double expected = (places[i] < 0 ? by_o : 0) + (places[i] < edge_e ? by_e : 0);
            truth_expect(what, expected, truth_measure(text, NULL, 1024, false), 4, 0.01);
        }
    }
}

/* Which way an axis lies is the object's to say. */
static void the_axis_turns_with_the_object(void **state)
{
    (void)state;
    static const struct {
        const char *group, *turn, *end, *axis; /* the same axis, by itself */
    } rows[] = {{"", "rotate(y, 90)", "", "<0, .6, -1>"},
                {"group { rotate(y, 45)", "", "}", "<.70710678, .6, -.70710678>"}};
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        Estimate both[2];
        for (int turned = 0; turned < 2; turned++) {
            char text[1200];
            snprintf(
                text, sizeof text,
                "meniscus 1.0 unit mm medium calcite { ior = 1.6584  extraordinary_ior = 1.4864  optic_axis = %s }\n"
                "%s cylinder { interior = calcite  from = <0, 0, 0>  to = <0, 10, 0>  radius = 60  %s } %s\n"
                "camera { from = <30, 40, 9>  to = <0, 10, 0>  projection = orthographic  width = .001 }" TRUTH_SKY,
                turned ? "<1, .6, 0>" : rows[i].axis, turned ? rows[i].group : "", turned ? rows[i].turn : "",
                turned ? rows[i].end : "");
            both[turned] = truth_measure(text, truth_two_skies, 4096, false);
        }
        truth_alike("a crystal that is turned, and one whose axis is", both[0], both[1], 4, 0.005);
    }
}

/* A sheet that is seen nowhere, and paint that lets all through, leave each wave as it is: its direction, and what is absorbed of it. */
static void sheets_leave_waves_alone(void **state)
{
    (void)state;
    static const char *const within[] = {
        "box { from = <-50, 4, -50>  to = <50, 6, 50>  surface = surface { thin = true  ior = 1  transmission = 1  "
        "specular = 0 } }",
        "box { interior = two_colors  from = <-50, 4, -50>  to = <50, 6, 50>  surface = surface { transmission = 1 } }",
        "box { from = <-50, 5, -50>  to = <50, 10, 50>  surface = surface { thin = true  ior = 1  transmission = 1  "
        "specular = 0 } }"};
    static const char pattern[] =
        "meniscus 1.0 unit mm\n"
        "medium two_colors { ior = 1.66  extraordinary_ior = 1.49  optic_axis = <1, .6, 0>  absorption = .02  "
        "extraordinary_absorption = .2 }\n"
        "cylinder { interior = two_colors  from = <0, 0, 0>  to = <0, 10, 0>  radius = 60 }  %s\n"
        "camera { from = <30, 40, 9>  to = <0, 10, 0>  projection = orthographic  width = .001 }" TRUTH_SKY;
    char text[1200];
    truth_fill(text, sizeof text, pattern, "");
    const Estimate bare = truth_measure(text, truth_two_skies, 4096, false);
    for (size_t i = 0; i < COUNT_OF(within); i++) {
        truth_fill(text, sizeof text, pattern, within[i]);
        const Estimate through = truth_measure(text, truth_two_skies, 4096, false);
        truth_alike("a crystal, and one with nothing to be seen in it", bare, through, 4, 0.005);
    }
}

/* A lamp in a cloudy crystal of two colours, looked for along ways of either wave: what comes from it to where it is scattered is of both. */
static void lamps_in_cloudy_crystals(void **state)
{
    (void)state;
    static const char text[] =
        "meniscus 1.0 unit mm\n"
        "medium cloudy { ior = 1.5  extraordinary_ior = 1.5001  optic_axis = <0, 0, 1>  absorption = .01  "
        "extraordinary_absorption = .6  scattering = .01 }\n"
        "cylinder { interior = cloudy  from = <0, 0, 0>  to = <0, 10, 0>  radius = 60 }\n"
        "light { shape = sphere  from = <4, 5, 0>  radius = 1.5  radiance = 10 }\n"
        "camera { from = <0, 40, 0>  to = <0, 10, 0>  projection = orthographic  width = .001  up = <0, 0, 1> }\n";
    truth_found_alike("a lamp in a cloudy crystal of two colours", text, 1 << 15, 0.02);
}

/* Crystals in crystals, in oil and across each other, with dispersion and cloudy: in even light they are not to be seen. */
static void crystals_are_not_seen_in_even_light(void **state)
{
    (void)state;
    static const char text[] =
        "meniscus 1.0 unit mm\n"
        "medium calcite { ior = cauchy(1.63, .012)  extraordinary_ior = cauchy(1.47, .006)  optic_axis = <1, 1, .3>  "
        "state = solid }\n"
        "medium rutile { ior = 2.6  extraordinary_ior = 2.9  optic_axis = <0, 0, 1>  state = solid }\n"
        "medium milky { ior = 1.5  extraordinary_ior = 1.6  scattering = .4 / 1mm  state = solid }\n"
        "medium oil { ior = 1.47  state = liquid }\n"
        "sphere { interior = oil  radius = 14 }\n"
        "sphere { interior = calcite  radius = 8  center = <-5, 2, 0> }\n"
        "box { interior = rutile  from = <-3, -3, -3>  to = <6, 5, 4>  rotate(<20, 30, 50>) }\n"
        "box { interior = calcite  from = <-3, -3, -3>  to = <3, 3, 3>  rotate(<60, 30, 10>)  translate(<8, -8, 2>) }\n"
        "torus { interior = milky  radius = 12  tube = 2  rotate(<80, 0, 20>) }\n"
        "ellipsoid { interior = rutile  radii = <4, 3, 5>  translate(<2, 9, 6>) }\n"
        "camera { from = <0, 30, 50>  to = <0, 0, 0>  fov = 34 }\n" TRUTH_WHITE_SKY;
    (void)truth_white("crystals in oil, and in each other", text, 24, 512, 0.002);
}

/* Light that came in through a bump and that the ball's own surface would hold for ever gets out by other bumps. */
static void bumps_let_light_out(void **state)
{
    (void)state;
    static const char text[] =
        "meniscus 1.0 unit mm\n"
        "medium calcite { ior = 1.65  extraordinary_ior = 1.48  optic_axis = <1, 1, .3> }\n"
        "def dots(p) = .5 + .5 * sin(200 * p.x) * sin(200 * p.y)\n"
        "sphere { interior = calcite  radius = 5  surface = surface { bump = dots  bump_height = .3 } }\n"
        "camera { from = <0, 12, 22>  to = <0, 0, 0>  fov = 24 }\n" TRUTH_WHITE_SKY;
    (void)truth_white("a ball of calcite with bumps", text, 24, 256, 0.001);
}

/* The mean of a small picture, of several renders. */
static Estimate mean_of_pictures(const char *text, SceneCaustics caustics)
{
    enum { SEEDS = 12, PICTURE = 24, SAMPLES = 256 };
    double means[SEEDS];
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, SAMPLES);
    settings.caustics = caustics;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Picture picture;
        settings.seed = seed;
        truth_render(&scene, &settings, 0, &picture);
        means[seed] = truth_total(&picture).mean / (PICTURE * PICTURE);
        assert_true((picture.stats.guide.landed > 0) == (caustics == CAUSTICS_ON));
        truth_clear(&picture);
    }
    fixture_clear(&scene);
    return truth_estimate(means, SEEDS);
}

/* The light that a lamp sends through a crystal to a floor around it is what chance finds of it where photons lead paths there. */
static void caustics_are_found(void **state)
{
    (void)state;
    static const char text[] =
        "meniscus 1.0 unit mm medium calcite { ior = cauchy(1.64, .006)  extraordinary_ior = cauchy(1.477, .003)  "
        "optic_axis = <1, 1, 0> }\n"
        "sphere { interior = calcite  center = <0, 4, 0>  radius = 3 }\n"
        "ground { surface = surface { albedo = .6 } }\n"
        "light { shape = sphere  from = <8, 16, 3>  radius = 3  radiance = 10 }\n"
        "camera { from = <0, 12, 22>  to = <0, 2, 0>  fov = 30 }\n";
    truth_alike("a lamp above a ball of calcite", mean_of_pictures(text, CAUSTICS_OFF),
                mean_of_pictures(text, CAUSTICS_ON), 4, 0.005);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_polarizes),
        cmocka_unit_test(crystals_have_two_colors),
        cmocka_unit_test(images_are_two),
        cmocka_unit_test(the_axis_turns_with_the_object),
        cmocka_unit_test(sheets_leave_waves_alone),
        cmocka_unit_test(lamps_in_cloudy_crystals),
        cmocka_unit_test(crystals_are_not_seen_in_even_light),
        cmocka_unit_test(bumps_let_light_out),
        cmocka_unit_test(caustics_are_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
