/* early_test.c - pictures that are shown before all pixels have samples: filled, in their order, and without a trace.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"
#include "render/early.h"
#include "render/render.h"
#include "scene_fixture.h"

/* Between pixels that lie on a plane all others do, up to the last lattice's row and column. */
static void a_plane_is_filled(void **state)
{
    (void)state;
    enum { WIDTH = 21, HEIGHT = 13, STEP = 4, LAST_X = WIDTH - 1 - (WIDTH - 1) % STEP, LAST_Y = HEIGHT - 1 };
    Film film;
    Error error;
    Image image;
    assert_int_equal(film_init(&film, WIDTH, HEIGHT, &error), STATUS_OK);
    for (uint32_t y = 0; y < HEIGHT; y += STEP)
        for (uint32_t x = 0; x < WIDTH; x += STEP)
            for (int i = 0; i < 3; i++)
                (void)film_add(&film, x, y, (float[]){(float)x, (float)y, (float)i * 2}, x > 9 ? 1 : 0);
    assert_int_equal(early_resolve(&film, STEP, &image, &error), STATUS_OK);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            const float *pixel = image.pixels + (y * WIDTH + x) * image.n_channels;
            assert_near(pixel[0], x < LAST_X ? x : LAST_X, 1e-5);
            assert_near(pixel[1], y < LAST_Y ? y : LAST_Y, 1e-5);
            assert_near(pixel[2], 2, 1e-5);
            assert_near(pixel[3], x >= 12 ? 1 : x > 8 ? pixel[3] : 0, 1e-5);
        }
    image_clear(&image);
    assert_int_equal(early_step(&film), STEP);
    (void)film_add(&film, STEP + STEP / 2, 0, (float[]){9, 9, 9}, 1); /* of a finer lattice that is not whole */
    assert_int_equal(early_step(&film), STEP);
    film_forget_row(&film, 0);
    assert_int_equal(early_step(&film), 0);
    film_clear(&film);
}

/* The limit is over before the first pass is: pixels that have no sample get what is between others. */
static void a_limit_leaves_a_whole_picture(void **state)
{
    (void)state;
    enum { WIDTH = 500, HEIGHT = 300 };
    Fixture scene;
    Image image;
    RenderStats stats;
    Error error;
    Pool *pool;
    fixture_compile(&scene, "meniscus 1.0 unit mm sphere { radius = 1 interior = medium { ior = 1.5 } }" FIXTURE_VIEW,
                    1);
    assert_int_equal(pool_new(2, &pool, &error), STATUS_OK);
    RenderSettings settings = {
        .width = WIDTH, .height = HEIGHT, .samples = 64, .bounces = 4, .spreads = true, .time_limit_s = 1e-6};
    assert_int_equal(render_image(scene.compiled, &settings, pool, NULL, &image, &stats, &error), STATUS_OK);
    assert_true(stats.stopped && stats.samples == 0 && stats.most_samples == 1);
    assert_true(stats.mean_samples * WIDTH * HEIGHT >= (WIDTH / 16) * (HEIGHT / 16));
    for (size_t i = 0; i < WIDTH * HEIGHT; i++) assert_near(image.pixels[i * image.n_channels + 1], 1, 0.05);
    image_clear(&image);
    pool_free(pool);
    fixture_clear(&scene);
}

typedef struct Shown {
    int n, black;
    double sums[8];      /* of the first pictures */
    float last[37 * 25]; /* green, of the last one */
} Shown;

static void note_picture(void *context, const Image *image)
{
    Shown *shown = context;
    assert_int_equal(image->n_channels, 4);
    size_t n = (size_t)image->width * image->height;
    if (shown->n < 8) shown->sums[shown->n] = 0;
    for (size_t i = 0; i < n; i++) {
        shown->black += !(image->pixels[4 * i + 1] > 0);
        if (shown->n < 8) shown->sums[shown->n] += (double)image->pixels[4 * i + 1] / (double)n;
    }
    for (size_t i = 0; i < n; i++) shown->last[i] = image->pixels[4 * i + 1];
    shown->n++;
}

/* Where there is a guide, and where there is none: pictures are shown, none of them has holes, and the last one is the
 * same as if nobody had looked. */
static void who_looks_changes_nothing(void **state)
{
    (void)state;
    static const char *const texts[] = {
        "meniscus 1.0 unit mm environment { color = 1 } ground { surface = surface { albedo = .5 } }"
        "sphere { center = <0, 1, 0> radius = 1 interior = medium { ior = 1.5 } }"
        "camera { from = <0, 3, 8> to = <0, 1, 0> fov = 30 }",
        "meniscus 1.0 unit mm environment { strength = .1 } ground { surface = surface { albedo = .5 } }"
        "sphere { center = <0, 3, 0> radius = 1 interior = medium { ior = 1.5 } }"
        "light { shape = sphere from = <0, 9, 0> radius = .05 radiance = 9000 }"
        "camera { from = <0, 8, 9> to = <0, 1, 0> fov = 30 }"};
    for (size_t k = 0; k < COUNT_OF(texts); k++) {
        Fixture scene;
        fixture_compile(&scene, texts[k], 1);
        for (int adaptive = 0; adaptive < 2; adaptive++) {
            Error error;
            Pool *pool;
            Image images[2];
            RenderStats stats[2];
            Shown shown = {0};
            RenderSettings settings = {.width = 38, .height = 27, .crop = {1, 2, 38, 27}, .bounces = 32};
            settings.samples = adaptive ? 64 : 5;
            settings.noise = adaptive ? 0.05 : 0;
            settings.aovs = (AovSet)1 << AOV_DEPTH;
            settings.spreads = true;
            RenderEvents events = {.context = &shown, .picture = note_picture};
            assert_int_equal(pool_new(2, &pool, &error), STATUS_OK);
            for (int looks = 0; looks < 2; looks++)
                assert_int_equal(render_image(scene.compiled, &settings, pool, looks ? &events : NULL, &images[looks],
                                              &stats[looks], &error),
                                 STATUS_OK);
            assert_true(shown.n >= 4);
            assert_true(shown.black <= 5 * shown.n); /* here and there a path that brings nothing */
            assert_int_equal(images[0].width * images[0].height, 37 * 25);
            for (int i = 1; i < 4; i++) assert_near(shown.sums[i] / shown.sums[0], 1, 0.5);
            assert_int_equal((stats[0].guide.followed > 0) + (stats[1].guide.followed > 0), k ? 2 : 0);
            assert_true(stats[0].rays == stats[1].rays && stats[0].paths == stats[1].paths);
            assert_memory_equal(images[0].pixels, images[1].pixels,
                                37 * 25 * images[0].n_channels * sizeof *images[0].pixels);
            for (size_t i = 0; i < COUNT_OF(shown.last); i++)
                assert_true(shown.last[i] == images[1].pixels[i * images[1].n_channels + 1]);
            assert_true(k == 0 || stats[1].spread_samples > 0 || !adaptive);
            for (int i = 0; i < 2; i++) image_clear(&images[i]);
            pool_free(pool);
        }
        fixture_clear(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_is_filled),
        cmocka_unit_test(a_limit_leaves_a_whole_picture),
        cmocka_unit_test(who_looks_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
