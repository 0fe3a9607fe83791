/* light_groups_test.c - what each group of lights lights: together the picture, and each as if the others were off.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include <string.h>

enum { WIDTH = 12, GROUPS = 7 };
static const char *const groups[GROUPS] = {"other", "lamp", "far", "sky", "hot", "gas", "beam"};

/* All kinds of lights, of which `only` leaves one; glass that disperses, so that there are two paths a sample; a pane that looks go
 * through, a ball that photons do, and smoke with a beam in it. */
static const char scene_text[] =
    "meniscus 1.0 unit mm\nparam only = \"all\"\n"
    "def on(name) = only == \"all\" or only == name ? 1 : 0\n"
    "medium flint { ior = cauchy(1.6, .02)  state = solid }  medium glass { ior = 1.5  state = solid }\n"
    "medium smoke { mixes = true  scattering = .004 / 1mm }\n"
    "medium flame { mixes = true  emission = rgb(1, .5, .2)  radiance = .05 / 1mm * on(\"gas\")  light_group = \"gas\" "
    "}\n"
    "surface hot { emission = rgb(1, .6, .3)  radiance = 3 * on(\"hot\")  light_group = \"hot\" }\n"
    "ground { surface = surface { albedo = .6 } }\n"
    "sphere { interior = flint  center = <-6, 6, 0>  radius = 6 }\n"
    "box { interior = glass  from = <-30, 22, -30>  to = <30, 25, 30> }\n"
    "box { interior = smoke  from = <-40, -5, -40>  to = <40, 20, 40> }\n"
    "sphere { interior = flame  center = <10, 6, -6>  radius = 5 }\n"
    "sphere { surface = hot  center = <12, 3, 9>  radius = 2 }\n"
    "light { shape = sphere  from = <9, 60, 15>  radius = 6  radiance = 30 * on(\"lamp\")  light_group = \"lamp\" }\n"
    "light { shape = distant  from = <2, 3, 1>  to = <0, 0, 0>  angle = 8deg  power = 2 * on(\"far\")  light_group = "
    "\"far\" }\n"
    "light { from = <-20, 40, 20>  to = <0, 0, 0>  size = <12, 12>  radiance = 4 * on(\"other\") }\n"
    "light { shape = disc  from = <-22, 12, 16>  to = <6, 4, 18>  radius = 3  angle = 8  radiance = 3000 * on(\"beam\")"
    "  light_group = \"beam\" }\n"
    "environment { color = rgb(.3, .4, .6) * on(\"sky\")  light_group = \"sky\" }\n"
    "camera { from = <0, 17, 45>  to = <0, 5, 0>  fov = 40 }\n";

/* The mean of a channel over the whole picture. */
static double mean_of(const Picture *picture, const char *channel)
{
    const Image *image = &picture->image;
    int c = image_channel(image, channel);
    double sum = 0;
    assert_true(c >= 0);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) sum += (double)image_at(image, x, y)[c];
    return sum / ((double)image->width * image->height);
}

static RenderSettings settings_for(uint32_t samples, uint32_t seed)
{
    RenderSettings settings = truth_settings(WIDTH, samples);
    settings.aovs = (AovSet)1 << AOV_LIGHTS;
    settings.caustics = CAUSTICS_ON;
    settings.seed = seed;
    return settings;
}

/* Pixel by pixel, in each colour, to the rounding of floats. */
static void expect_sum(const Picture *picture)
{
    static const char *const colors[] = {"R", "G", "B"};
    const Image *image = &picture->image;
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++)
            for (int c = 0; c < 3; c++) {
                double sum = 0;
                for (size_t g = 0; g < GROUPS; g++) {
                    char name[40];
                    snprintf(name, sizeof name, "lights.%s.%s", groups[g], colors[c]);
                    sum += (double)image_at(image, x, y)[image_channel(image, name)];
                }
                double whole = truth_channel(picture, x, y, c);
                assert_near(sum, whole, 2e-6 * fmax(fabs(whole), 1));
            }
}

static void groups_are_the_picture_and_lights_alone(void **state)
{
    (void)state;
    enum { SEEDS = 8 };
    double in_all[GROUPS][SEEDS], alone[GROUPS][SEEDS];
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = scene_text, .policy = NEST_AUTOMATIC});
    assert_int_equal(scene.scene->light_groups.n, GROUPS);
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        RenderSettings settings = settings_for(192, seed);
        Picture picture;
        truth_render(&scene, &settings, 0, &picture);
        expect_sum(&picture);
        for (size_t g = 0; g < GROUPS; g++) {
            char name[40];
            snprintf(name, sizeof name, "lights.%s.G", groups[g]);
            in_all[g][seed] = mean_of(&picture, name);
        }
        truth_clear(&picture);
    }
    fixture_clear(&scene);
    for (size_t g = 0; g < GROUPS; g++) {
        char only[40];
        snprintf(only, sizeof only, "only=\"%s\"", groups[g]);
        truth_open(&scene,
                   (TruthInput){.text = scene_text, .defines = (const char *[]){only, NULL}, .policy = NEST_AUTOMATIC});
        for (uint32_t seed = 0; seed < SEEDS; seed++) {
            RenderSettings settings = settings_for(128, 100 + seed);
            Picture picture;
            truth_render(&scene, &settings, 0, &picture);
            alone[g][seed] = mean_of(&picture, "G");
            truth_clear(&picture);
        }
        fixture_clear(&scene);
        truth_alike(groups[g], truth_estimate(alone[g], SEEDS), truth_estimate(in_all[g], SEEDS), 4, 0.03);
    }
}

/* A ball and its shadow on a floor that is to be laid over a picture: most of the floor's light is not in this one, nor in its layers. */
static void layers_of_shadow_catchers(void **state)
{
    (void)state;
    Fixture scene;
    Picture picture;
    char text[sizeof scene_text + 100];
    const char *floor = "albedo = .6", *after = strstr(scene_text, floor) + strlen(floor);
    snprintf(text, sizeof text, "%.*s  shadow_catcher = true%s", (int)(after - scene_text), scene_text, after);
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    for (int denoises = 0; denoises < 2; denoises++) {
        RenderSettings settings = settings_for(64, 7);
        settings.denoises = denoises == 1;
        truth_render(&scene, &settings, 0, &picture);
        expect_sum(&picture);
        truth_clear(&picture);
    }
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(groups_are_the_picture_and_lights_alone),
        cmocka_unit_test(layers_of_shadow_catchers),
    };
    return cmocka_run_group_tests_name("light groups", tests, NULL, NULL);
}
