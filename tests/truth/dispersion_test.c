/* dispersion_test.c - two paths a sample where wavelengths are bent apart (trace/sample.c): the light is what one wavelength that
 * goes on alone finds, and there is less noise. (What the light is, by closed forms, stands in refraction_test.c.)
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { PICTURE = 16, SAMPLES = 64, SEEDS = 24, PARTS = 4, CHANNELS = 3 };

/* The four quarters of a picture, of each seed. */
typedef struct Parts {
    double value[PARTS][CHANNELS][SEEDS];
} Parts;

static void measure(const char *text, bool caustics, bool hero_alone, Parts *parts)
{
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .sky = truth_two_skies, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, SAMPLES);
    settings.caustics = caustics ? CAUSTICS_ON : CAUSTICS_OFF;
    settings.trial.hero_alone = hero_alone;
    memset(parts, 0, sizeof *parts);
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Picture picture;
        settings.seed = seed + (hero_alone ? SEEDS : 0);
        truth_render(&scene, &settings, 0, &picture);
        assert_int_equal(picture.stats.nesting_faults, 0);
        for (uint32_t i = 0; i < (uint32_t)(PICTURE * PICTURE); i++) {
            uint32_t x = i % PICTURE, y = i / PICTURE;
            int part = 2 * (y >= PICTURE / 2) + (x >= PICTURE / 2);
            for (int c = 0; c < CHANNELS; c++)
                parts->value[part][c][seed] += truth_channel(&picture, x, y, c) * PARTS / (PICTURE * PICTURE);
        }
        truth_clear(&picture);
    }
    fixture_clear(&scene);
}

#define LIGHTS                                                                                                         \
    "ground { y = -20  surface = surface { albedo = rgb(.7, .5, .3) } }\n"                                             \
    "light { from = <-60, 70, -20>  to = <0, 0, 0>  size = <60, 60>  radiance = 12 }\n"                                \
    "light { shape = sphere  from = <70, 30, -30>  radius = 12  radiance = 20 }\n" TRUTH_SKY
#define CAMERA "camera { from = <0, 20, -120>  to = <3, 0, 0>  fov = 22deg }\n"

static const struct {
    const char *name, *text;
    double gain;   /* of squared error, at least */
    bool caustics; /* are looked for */
} scenes[] = {
    {"glasses in each other",
     "meniscus 1.0 unit mm medium crown { ior = cauchy(1.5, .012)  absorption = <.02, .01, .03> / 1mm }\n"
     "medium flint { ior = cauchy(1.6, .03) }\n"
     "lathe { interior = crown  profile = [<0, -18>, <15, -18>, <17, 16>, <14, 16>, <12, -12>, <0, -12>] }\n"
     "cylinder { interior = flint  from = <0, -12.1, 0>  to = <0, 5, 0>  radius = 13.5 }\n"
     "sphere { interior = air  center = <4, -3, -2>  radius = 4 }\n"
     "sphere { interior = crown  center = <-24, -8, 0>  radius = 10  surface = surface { roughness = .3 } }\n"
     "sphere { interior = flint  center = <24, -8, 0>  radius = 8 }\n" CAMERA LIGHTS,
     2, false},
    {"a liquid that scatters in colours",
     "meniscus 1.0 unit mm medium crown { ior = cauchy(1.5, .012) }\n"
     "medium milk { ior = cauchy(1.33, .004)  scattering = <.02, .08, .3> / 1mm  absorption = <.03, .01, .002> / 1mm\n"
     "              phase = hg(.6)  state = liquid }\n"
     "sphere { interior = crown  radius = 19 }\n"
     "sphere { interior = milk  radius = 15 }\n" CAMERA LIGHTS,
     1.2, false},
    {"a stone with fire",
     "meniscus 1.0 unit mm use \"std/gems.mns\" as gems\n"
     "gems.round_brilliant { radius = 18  rotate(x, -30) }\n" CAMERA LIGHTS,
     1, false},
    {"under water",
     "meniscus 1.0 unit mm medium water { ior = cauchy(1.32, .01)  tint = rgb(.5, .8, .9)  depth = 100mm }\n"
     "medium crown { ior = cauchy(1.5, .012) }\n"
     "box { interior = water  from = <-90, -30, -140>  to = <90, 40, 60> }\n"
     "sphere { interior = crown  radius = 14 }\n"
     "sphere { interior = air  center = <20, 8, -20>  radius = 6 }\n" CAMERA LIGHTS,
     1.2, false},
    {"the rainbow of a prism on a floor", /* light comes to it by probes */
     "meniscus 1.0 unit mm medium flint { ior = cauchy(1.52, .03) }\n"
     "mesh { interior = flint  positions = [<-20, -11.5, 60>, <20, -11.5, 60>, <0, 23.1, 60>,\n"
     "                                      <-20, -11.5, -60>, <20, -11.5, -60>, <0, 23.1, -60>]\n"
     "       triangles = [<0, 1, 2>, <3, 5, 4>, <0, 4, 1>, <0, 3, 4>, <1, 5, 2>, <1, 4, 5>, <2, 3, 0>, <2, 5, 3>]\n"
     "       rotate(z, -60)  translate(<0, 300, 0>) }\n"
     "ground { y = 0  surface = surface { albedo = .7 } }\n"
     "light { shape = \"distant\"  from = <-80, 60, 0>  to = <0, 0, 0>  angle = 2deg  power = 1 }\n"
     "camera { from = <36, 200, -300>  to = <36, 0, 0>  fov = 20deg }\n",
     1, true},
};

static void it_is_the_same_light_with_less_noise(void **state)
{
    (void)state;
    static Parts pairs, alone;
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        measure(scenes[i].text, scenes[i].caustics, false, &pairs);
        measure(scenes[i].text, scenes[i].caustics, true, &alone);
        double square[2] = {0};
        for (int part = 0; part < PARTS; part++)
            for (int c = 0; c < CHANNELS; c++) {
                char what[80];
                Estimate e = truth_estimate(pairs.value[part][c], SEEDS),
                         of_hero = truth_estimate(alone.value[part][c], SEEDS);
                snprintf(what, sizeof what, "%s, quarter %d, %s", scenes[i].name, part + 1,
                         c == 0   ? "red"
                         : c == 1 ? "green"
                                  : "blue");
                truth_alike(what, of_hero, e, 4.5, 0.02);
                square[0] += e.error * e.error;
                square[1] += of_hero.error * of_hero.error;
            }
        printf("  %s: the hero alone has %.2f times the squared error\n", scenes[i].name, square[1] / square[0]);
        assert_true(square[1] >= scenes[i].gain * square[0]);
    }
}

/* Where lists are bits (above), rows, and hold combinations; where textures are read by the width of a path, where several surfaces
 * are met at once, and where a path has been scattered before its wavelengths part. */
static const char *const more_pairs[] = {
    "meniscus 1.0 unit mm medium crown { ior = cauchy(1.5, .012) } medium flint { ior = cauchy(1.6, .03) }\n"
    "for (i in 0..79) { sphere { interior = i < 40 ? crown : flint  radius = 18 - .1 * i } }\n" /* too many for bits */
    CAMERA LIGHTS,
    "meniscus 1.0 unit mm medium crown { ior = cauchy(1.5, .012) }\n"
    "difference { interior = crown  sphere { radius = 18 }  sphere { radius = 9  center = <0, 6, -14> } }\n"
    "sphere { interior = crown  center = <24, -8, 0>  radius = 10  surface = surface { roughness = .3 } }\n" /* apart */
    CAMERA LIGHTS,
    "meniscus 1.0 unit mm medium crown { ior = cauchy(1.5, .012) }\n"
    "sphere { interior = crown  radius = 18\n"
    "         surface = surface { roughness = .2  bump = noise { octaves = 2  scale(3) }  bump_height = .3 } }\n"
    "box { interior = crown  from = <20, -20, -20>  to = <40, 0, 0> }\n"
    "box { interior = air  from = <20, 0, -20>  to = <40, 9, 0> }\n" /* both at once */
    CAMERA LIGHTS};

/* The second path begins where the wavelengths part: the same light to the last bit as from the camera on, by fewer rays. */
static void pairs_share_their_beginning(const char *text, SceneCaustics caustics, uint32_t samples)
{
    Picture pictures[2];
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .sky = truth_two_skies, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(PICTURE, samples);
    settings.caustics = caustics;
    for (int from_camera = 0; from_camera < 2; from_camera++) {
        settings.trial.pairs_from_camera = from_camera;
        truth_render(&scene, &settings, 0, &pictures[from_camera]);
    }
    for (uint32_t i = 0; i < (uint32_t)(PICTURE * PICTURE * CHANNELS); i++) {
        uint32_t x = i / CHANNELS % PICTURE, y = i / CHANNELS / PICTURE;
        int c = (int)(i % CHANNELS);
        assert_true(truth_channel(&pictures[0], x, y, c) == truth_channel(&pictures[1], x, y, c));
    }
    assert_true(pictures[0].stats.rays < pictures[1].stats.rays);
    assert_int_equal(pictures[0].stats.paths, pictures[1].stats.paths);
    for (int i = 0; i < 2; i++) truth_clear(&pictures[i]);
    fixture_clear(&scene);
}

static void all_pairs_share_their_beginning(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(scenes); i++) pairs_share_their_beginning(scenes[i].text, CAUSTICS_OFF, SAMPLES);
    for (size_t i = 0; i < COUNT_OF(more_pairs); i++) pairs_share_their_beginning(more_pairs[i], CAUSTICS_OFF, SAMPLES);
}

/* Where probes are sent by chance, as what the path carries is little: the second path goes on by the colour of its own, which says from
 * where light comes. (It kept that of the first: behind a pane that lets a tenth through, light was 0.6 % too bright.) */
static void pairs_part_behind_where_probes_look(void **state)
{
    (void)state;
    pairs_share_their_beginning(
        "meniscus 1.0 unit mm medium lead { ior = cauchy(1.4, .1)  state = solid }\n"
        "ground { surface = surface { albedo = .8 } }\n"
        "sphere { interior = lead  center = <0, 40, 0>  radius = 20 }\n"
        "sphere { center = <-100, 120, -200>  radius = 5\n"
        "         surface = surface { thin = true  transmission = 1  ior = 1  specular = 0  tint = rgb(.1, .1, .1) } "
        "}\n"
        "light { shape = \"distant\"  from = <2, 1, 0>  to = <0, 0, 0>  angle = 3  power = 10 }\n"
        "camera { from = <-100, 120, -200>  to = <-55, 0, 0>  fov = .5deg }\n",
        CAUSTICS_ON, 64 * SAMPLES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_pairs_share_their_beginning),
                                       cmocka_unit_test(pairs_part_behind_where_probes_look),
                                       cmocka_unit_test(it_is_the_same_light_with_less_noise)};
    return cmocka_run_group_tests_name("dispersion", tests, NULL, NULL);
}
