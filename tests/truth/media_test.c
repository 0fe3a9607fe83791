/* media_test.c - media that scatter: furnaces, transmittance and single scattering in closed form, and light that is
 * the same however it is found.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include "optics/spheres.h"

enum { WIDTH = 32 };

#define HEAD "meniscus 1.0 unit m\n"

static Estimate mean_of(const char *text, uint32_t samples, bool furnace, const char *what)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text, .furnace = furnace});
    RenderSettings settings = truth_settings(WIDTH, samples);
    settings.no_absorption = furnace;
    settings.bounces = 1000000;
    truth_render(&scene, &settings, 0, &picture);
    if (picture.stats.nesting_faults)
        fail_msg("%s: %llu faults", what, (unsigned long long)picture.stats.nesting_faults);
    Estimate mean = truth_mean(&picture, -1);
    truth_clear(&picture);
    fixture_clear(&scene);
    return mean;
}

/* Nothing is absorbed: whatever scatters how often, in whatever lies in what, the picture is 1. */
static void furnaces(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
    } cases[] = {
        {"fog in a ball of its own index",
         HEAD "medium fog { ior = 1  scattering = 2  phase = hg(.6) } sphere { interior = fog  radius = 1 }"
              "camera { from = <0, 0, 4>  to = <0, 0, 0>  fov = 40deg }" TRUTH_SKY},
        {"milk in a glass, ice in the milk, colours that scatter unlike",
         HEAD "medium glass { ior = 1.5  state = solid } medium ice { ior = 1.31  state = solid }"
              "medium milk { ior = 1.34  scattering = <3, 4, 6>  phase = two_hg(.8, -.2, .9)  state = liquid }"
              "lathe { interior = glass  profile = [<0, 0>, <1, 0>, <1, 2>, <.9, 2>, <.9, .1>, <0, .1>] }"
              "cylinder { interior = milk  from = <0, .05, 0>  to = <0, 1.5, 0>  radius = .95 }"
              "box { interior = ice  size = <.6, .6, .6>  rotate(<20, 30, 0>)  translate(<.1, 1.5, 0>) }"
              "camera { from = <0, 3, 5>  to = <0, 1, 0>  fov = 36deg }" TRUTH_SKY},
        {"droplets, Rayleigh's air in a bubble, a camera inside",
         HEAD "medium cloud { ior = 1  scattering = 1.5  phase = droplets(10) } medium air2 { ior = 1.2  scattering = "
              ".8  phase = rayleigh() }"
              "sphere { interior = cloud  radius = 2 } sphere { interior = air2  center = <.5, 0, -1>  radius = .6 }"
              "camera { from = <0, 0, 1>  to = <0, 0, 0>  fov = 60deg }" TRUTH_SKY},
        {"spray of many colours, bubbles in water",
         HEAD "medium spray { ior = 1  scattering = <.5, 1, 2>  phase = droplets(3, .4) }"
              "medium soda { ior = 1.333  scattering = <3, 2, 1>  phase = bubbles(300) }"
              "sphere { interior = spray  radius = 2 } sphere { interior = soda  center = <.5, 0, -1>  radius = .6 }"
              "camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = 40deg }" TRUTH_SKY},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++)
        truth_expect(cases[i].name, 1, mean_of(cases[i].text, 256, true, cases[i].name), 4, 0.002);
}

/* A lamp seen straight through: what is left of it is e^-(absorption + scattering). */
static void transmittance(void **state)
{
    (void)state;
    static const char *const view =
        "camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = .02deg }"
        "light { shape = disc  from = <0, 0, -5>  to = <0, 0, 9>  radius = .02  radiance = 1 }";
    char text[1000];
    double depths[] = {0.1, 1, 3};
    Estimate clear = mean_of("meniscus 1.0 unit m\n"
                             "camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = .02deg }"
                             "light { shape = disc  from = <0, 0, -5>  to = <0, 0, 9>  radius = .02  radiance = 1 }",
                             64, false, "clear");
    for (size_t i = 0; i < COUNT_OF(depths); i++) {
        char what[80];
        snprintf(text, sizeof text,
                 HEAD
                 "medium fog { ior = 1  absorption = %g  scattering = %g } box { interior = fog  size = <4, 4, 2> } %s",
                 depths[i] * 0.25, depths[i] * 0.25, view);
        Estimate seen = mean_of(text, 1024, false, "fog");
        snprintf(what, sizeof what, "transmittance at an optical depth of %g", depths[i]);
        truth_expect(what, exp(-depths[i]), (Estimate){seen.mean / clear.mean, seen.error / clear.mean}, 4, 0.02);
    }
}

/* A slab that scatters little, lit by the sun from the camera's side at 60 degrees: light that was scattered once,
 * against a white wall under the same sun. With a share of 1e-3 of scattering, what is scattered twice is below 1e-3 of
 * it. */
static void single_scattering(void **state)
{
    (void)state;
    static const char *const view =
        "camera { from = <0, 0, 50>  to = <0, 0, 0>  fov = .5deg }"
        "light { shape = distant  from = <1.7320508, 0, 1>  to = <0, 0, 0>  angle = .01deg  power = 1 }";
    const double extinction = 1.5, share = 1e-3, thickness = 1, cos_sun = 0.5, g = 0.4;
    char text[1000];
    snprintf(text, sizeof text,
             HEAD "box { from = <-90, -90, -1>  to = <90, 90, 0>  surface = surface { albedo = 1 } } %s", view);
    /* albedo E cos / pi, with E 1 in the light's own unit */
    Estimate wall = mean_of(text, 64, false, "wall");
    double irradiance = wall.mean * TRUTH_PI / cos_sun;
    snprintf(text, sizeof text,
             HEAD "medium haze { ior = 1  absorption = %.12g  scattering = %.12g  phase = hg(%g) }"
                  "box { interior = haze  from = <-90, -90, -1>  to = <90, 90, 0> } %s",
             extinction * (1 - share), extinction * share, g, view);
    Estimate seen = mean_of(text, 4096, false, "haze");
    /* the sun's light travels towards -z at 60 degrees, and what is seen towards +z */
    double cosine = -cos_sun, phase = (1 - g * g) / (4 * TRUTH_PI * pow(1 + g * g - 2 * g * cosine, 1.5));
    double both = extinction * (1 + 1 / cos_sun);
    double expected = irradiance * phase * extinction * share * (1 - exp(-both * thickness)) / both;
    truth_expect("single scattering in a slab", 1, (Estimate){seen.mean / expected, seen.error / expected}, 4, 0.05);
}

/* Droplets of water, and a slab in the light of a sun of few wavelengths: seen from the side of the sun, or against it, at the
 * angle by which light is turned. Radiance over that of light scattered once, by the table. */
static void droplets_in_a_slab(void **state)
{
    (void)state;
    static const struct {
        double diameter_um, nm, degrees, resolution;
    } cases[] = {
        {20, 450, 3, .02},     {20, 650, 30, .02},      {20, 450, 141, .02},   {20, 550, 178.5, .02},
        {1000, 460, 143, .02}, {1000, 620, 139.4, .02}, {1000, 620, 129, .02},
    };
    const double extinction = .2, share = 1e-3, degree = TRUTH_PI / 180;
    Arena arena;
    arena_init(&arena);
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const double nm = cases[i].nm, turned = cases[i].degrees * degree, slant = fabs(cos(turned));
        char light[300], text[1200], what[100];
        snprintf(light, sizeof light,
                 "camera { from = <0, 0, 50>  to = <0, 0, 0>  fov = .01deg }"
                 "light { shape = distant  to = <0, 0, 0>  angle = .01deg  power = 1"
                 "  color = spectrum([<%g, 0>, <%g, 1>, <%g, 1>, <%g, 0>])",
                 nm - 6, nm - 5, nm + 5, nm + 6);
        snprintf(text, sizeof text,
                 HEAD "box { from = <-9000, -9000, -1>  to = <9000, 9000, 0>  surface = surface { albedo = 1 } } %s"
                      " from = <0, 0, 1> }",
                 light);
        Estimate wall = mean_of(text, 256, false, "wall");
        snprintf(text, sizeof text,
                 HEAD "medium mist { ior = 1  absorption = %.12g  scattering = %.12g  phase = droplets(%g) }"
                      "box { interior = mist  from = <-9000, -9000, -1>  to = <9000, 9000, 0> } %s"
                      " from = <%.12g, 0, %.12g> }",
                 extinction * (1 - share), extinction * share, cases[i].diameter_um, light, sin(turned), -cos(turned));
        Estimate seen = mean_of(text, 1024, false, "mist");
        Spheres spheres = {.diameter_um = cases[i].diameter_um, .width = SPHERES_WIDTH};
        for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
            spheres.index[k] = spheres_water_index(phase_table_nm(k));
            spheres.around[k] = 1;
        }
        const PhaseTable *table = spheres_table(&arena, &spheres, NULL);
        double sine = sin(0.5 * turned);
        double phase = (double)lanes_get(phase_table_at(table, (float)(sine * sine), lanes_all((float)nm)), 0);
        double way = turned > TRUTH_PI / 2
                         ? (1 - exp(-extinction * (1 + 1 / slant))) / (extinction * (1 + 1 / slant))
                         : (exp(-extinction) - exp(-extinction / slant)) / (extinction / slant - extinction);
        double expected = wall.mean * TRUTH_PI * phase * extinction * share * way;
        snprintf(what, sizeof what, "droplets of %g um, %g nm, turned by %g degrees", cases[i].diameter_um, nm,
                 cases[i].degrees);
        truth_expect(what, 1, (Estimate){seen.mean / expected, hypot(seen.error, .003 * seen.mean) / expected}, 4,
                     cases[i].resolution);
    }
    arena_clear(&arena);
}

static double two_skies(double elevation)
{
    return elevation > 0.5 ? 3 : 0.2;
}

/* A fog of the air's own index gets its light from light sampling, through a boundary that is not there. With an index
 * that is another one by next to nothing the boundary blocks that, and all light is found by chance. */
static void lights_agree(void **state)
{
    (void)state;
    static const char *const phases[] = {"hg(-.3)", "droplets(3, .4)", "measured([<0, 1>, <120, 5>, <180, .1>])"};
    double indices[] = {1, 1.00001};
    Estimate seen[2];
    for (size_t k = 0; k < 2 * COUNT_OF(phases); k++) {
        size_t i = k % 2;
        char text[1000];
        Fixture scene;
        Picture picture;
        snprintf(text, sizeof text,
                 HEAD "medium fog { ior = %.6g  scattering = <1, 1.5, 2>  absorption = .1  phase = %s }"
                      "sphere { interior = fog  radius = 1 }"
                      "camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 16deg }" TRUTH_SKY,
                 indices[i], phases[k / 2]);
        truth_open(&scene, (TruthInput){.text = text, .sky = two_skies});
        RenderSettings settings = truth_settings(WIDTH, 512);
        truth_render(&scene, &settings, 0, &picture);
        seen[i] = truth_total(&picture);
        truth_clear(&picture);
        fixture_clear(&scene);
        if (i == 0) continue;
        char what[100];
        snprintf(what, sizeof what, "light found by sampling, and by chance: %s", phases[k / 2]);
        truth_expect(what, 1, truth_ratio(seen[0], seen[1]), 4, 0.01);
    }
}

/* Rays that graze a ball no deeper than rounding go in and out at one place: paths that scatter in between are not to take
 * themselves for ones outside of the ball, whether it is empty or filled with the mist around it. 16 in two million did. */
static void grazed_balls(void **state)
{
    (void)state;
    static const char *const fillings[] = {"air", "mist"};
    for (size_t i = 0; i < COUNT_OF(fillings); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 HEAD "medium mist { ior = 1  scattering = 2 / 1m }"
                      "box { interior = mist  size = vec3(3) } sphere { interior = %s  radius = 1 }"
                      "camera { from = <1, 0, -1>  to = <1, 0, 0>  fov = .0001deg }",
                 fillings[i]);
        truth_expect(fillings[i], 1, mean_of(text, 256, true, fillings[i]), 4, 0.005);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(furnaces),           cmocka_unit_test(transmittance), cmocka_unit_test(single_scattering),
        cmocka_unit_test(droplets_in_a_slab), cmocka_unit_test(lights_agree),  cmocka_unit_test(grazed_balls),
    };
    return cmocka_run_group_tests_name("media", tests, NULL, NULL);
}
