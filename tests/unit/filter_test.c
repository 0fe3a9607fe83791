/* filter_test.c - what an edge becomes under the film's filters.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"
#include "render/render.h"
#include "scene_fixture.h"

enum { WIDTH = 8, HEIGHT = 4, SAMPLES = 1024 };

/* Everything to the left of the picture's middle shines; the edge is where two pixels meet. */
#define EDGE                                                                                                           \
    "meniscus 1.0 unit mm box { from = <-100, -100, -1> to = <0, 100, 0> "                                             \
    "surface = surface { albedo = 0 emission = 1 } } camera { from = <0, 0, 50> to = <0, 0, 0> fov = 20 } "

/* The mean of each column's green. */
static void columns_of(const char *film, double mean[WIDTH])
{
    Fixture fixture;
    char text[1000];
    Pool *pool;
    Image image;
    RenderStats stats;
    snprintf(text, sizeof text, EDGE "%s", film);
    fixture_compile(&fixture, text, 1);
    assert_int_equal(pool_new(1, &pool, &fixture.error), STATUS_OK);
    RenderSettings settings = {.width = WIDTH, .height = HEIGHT, .samples = SAMPLES, .bounces = 1};
    assert_int_equal(render_image(fixture.compiled, &settings, pool, NULL, &image, &stats, &fixture.error), STATUS_OK);
    for (uint32_t x = 0; x < WIDTH; x++) {
        mean[x] = 0;
        for (uint32_t y = 0; y < HEIGHT; y++)
            mean[x] += (double)image.pixels[(y * WIDTH + x) * image.n_channels + 1] / HEIGHT;
    }
    image_clear(&image);
    pool_free(pool);
    fixture_clear(&fixture);
}

static void a_box_keeps_pixels_apart(void **state)
{
    (void)state;
    double mean[WIDTH];
    columns_of("film { filter = box }", mean);
    for (int x = 0; x < WIDTH; x++) assert_near(mean[x], x < WIDTH / 2 ? 1 : 0, x < WIDTH / 2 ? 0.01 : 0);
}

/* Of a tent of radius 1 an eighth is further than half a pixel to one side. */
static void a_tent_reaches_half_over_its_neighbours(void **state)
{
    (void)state;
    double mean[WIDTH];
    columns_of("", mean);
    for (int x = 0; x < WIDTH; x++) {
        double expected = x < WIDTH / 2 ? 1 : 0;
        if (x == WIDTH / 2 - 1) expected = 0.875;
        if (x == WIDTH / 2) expected = 0.125;
        assert_near(mean[x], expected, expected > 0 ? 0.01 : 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_keeps_pixels_apart),
        cmocka_unit_test(a_tent_reaches_half_over_its_neighbours),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
