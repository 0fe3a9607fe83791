/* glance_test.c - a first look at a scene says how bright its picture will be.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "render/glance.h"
#include "render/render.h"
#include "scene_fixture.h"

enum { WIDTH = 96, HEIGHT = 72 };

/* The stops by which the picture is to be brightened: of many samples, and at a glance. Neither depends on the light's unit but by
 * that. */
static void compare_stops(const char *text, double *rendered, double *glanced)
{
    Fixture scene;
    World world;
    Image image;
    RenderStats stats;
    Error error;
    Brightness brightness;
    RenderSettings settings = {.width = WIDTH, .height = HEIGHT, .samples = 256, .bounces = 64, .spreads = true};
    fixture_compile(&scene, text, 1);
    assert_int_equal(render_image(scene.compiled, &settings, NULL, NULL, &image, &stats, &error), STATUS_OK);
    brightness = brightness_find(&image, 0);
    *rendered = brightness_stops(&brightness);
    image_clear(&image);
    assert_int_equal(world_init(&world, scene.compiled, 0, 64, false, NULL, &error), STATUS_OK);
    assert_int_equal(glance(&world, WIDTH, HEIGHT, &brightness, &error), STATUS_OK);
    *glanced = brightness_stops(&brightness);
    world_clear(&world);
    fixture_clear(&scene);
}

#define VIEW "camera { from = <0, 3, 12>  to = <0, 1, 0>  fov = 40 } film { alpha = true } "
#define TABLE "ground { surface = surface { albedo = .5 } } "
#define BALL FIXTURE_MEDIA "sphere { center = <0, 1, 0>  radius = 1  interior = glass } "

static void white_is_known_to_a_stop(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        BALL TABLE VIEW
        "light { from = <3, 6, 3>  to = <0, 1, 0>  size = <1, 1>  radiance = 20 } environment { color = .05 }",
        BALL TABLE VIEW "light { shape = \"sphere\"  from = <3, 6, 3>  radius = .05  radiance = 2000 }",
        BALL TABLE VIEW "environment { color = .0003 }",
        /* nothing is around it: what the film does not cover has no brightness */
        FIXTURE_MEDIA "sphere { center = <0, 1, 0>  radius = 1  surface = surface { albedo = .8 } } " VIEW
                      "light { shape = \"distant\"  from = <1, 1, 1>  to = <0, 0, 0>  angle = .5deg  radiance = 1e9 }",
    };
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        double rendered, glanced;
        compare_stops(scenes[i], &rendered, &glanced);
        printf("        scene %zu: rendered %.2f stops, at a glance %.2f\n", i, rendered, glanced);
        assert_near(glanced, rendered, 1.01);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_is_known_to_a_stop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
