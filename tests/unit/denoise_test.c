/* denoise_test.c - what denoising takes away, and what it leaves.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "render/denoise.h"
#include "render/render.h"
#include "scene_fixture.h"

enum { WIDTH = 72, HEIGHT = 40 };

/* What a pixel shows. */
typedef float Level(uint32_t x, uint32_t y);

typedef struct Films {
    Film film;
    AovFilm aovs;
    Image noisy, image;
} Films;

/* Samples between 0 and twice the level, in each colour by themselves. */
static void fill(Films *films, Level *level, uint32_t samples, float noise)
{
    Error error;
    assert_int_equal(film_init(&films->film, WIDTH, HEIGHT, &error), STATUS_OK);
    const LightGroups groups = light_groups_none();
    assert_int_equal(aov_film_init(&films->aovs, 0, &groups, true, 0x1p-20, WIDTH, HEIGHT, &error), STATUS_OK);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (uint32_t i = 0; i < samples; i++) {
                float rgb[3];
                for (uint32_t k = 0; k < 3; k++) {
                    uint32_t hash = hash_combine(hash_combine(hash_combine(x, y), i), k);
                    rgb[k] = level(x, y) * (1 + noise * (2 * hash_to_unit_f(hash) - 1));
                }
                (void)film_add(&films->film, x, y, rgb, 1);
            }
}

enum { CARRIED = 6 };

/* What is carried along: the same colours, and half of them. */
static Image carried_of(const Image *image)
{
    static const char *const names[CARRIED] = {"a", "b", "c", "d", "e", "f"};
    Image carried;
    Error error;
    assert_int_equal(image_new(WIDTH, HEIGHT, names, CARRIED, &carried, &error), STATUS_OK);
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        for (size_t k = 0; k < 3; k++) {
            float color = image->pixels[i * image->n_channels + k];
            carried.pixels[i * CARRIED + k] = color;
            carried.pixels[i * CARRIED + 3 + k] = 0.5f * color;
        }
    return carried;
}

/* The same stays so to the bit, wherever it is, and half remains half. */
static void is_carried(Image *carried, const Image *image)
{
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        for (size_t k = 0; k < 3; k++) {
            float color = image->pixels[i * image->n_channels + k], *carries = carried->pixels + i * CARRIED;
            assert_true(carries[k] == color);
            assert_near(carries[3 + k], 0.5f * color, 1e-5 * fabs((double)color));
        }
    image_clear(carried);
}

/* With three threads, and the same bits with one. */
static void run(Films *films)
{
    Error error;
    Pool *pool;
    Image alone;
    assert_int_equal(aov_film_resolve(&films->aovs, &films->film, NULL, NULL, &films->noisy, &error), STATUS_OK);
    assert_int_equal(aov_film_resolve(&films->aovs, &films->film, NULL, NULL, &films->image, &error), STATUS_OK);
    assert_int_equal(aov_film_resolve(&films->aovs, &films->film, NULL, NULL, &alone, &error), STATUS_OK);
    assert_int_equal(pool_new(3, &pool, &error), STATUS_OK);
    Image carried = carried_of(&films->image);
    assert_int_equal(denoise(&films->film, &films->aovs, pool, &films->image, &carried, &error), STATUS_OK);
    is_carried(&carried, &films->image);
    pool_free(pool);
    assert_int_equal(denoise(&films->film, &films->aovs, NULL, &alone, NULL, &error), STATUS_OK);
    assert_memory_equal(alone.pixels, films->image.pixels, sizeof(float) * WIDTH * HEIGHT * (size_t)alone.n_channels);
    image_clear(&alone);
}

static void end(Films *films)
{
    film_clear(&films->film);
    aov_film_clear(&films->aovs);
    image_clear(&films->noisy);
    image_clear(&films->image);
}

/* The mean square of what columns x0 up to but without x1 are off their levels, in relation to these. */
static double error_of(const Image *image, Level *level, uint32_t x0, uint32_t x1, double *mean)
{
    double squares = 0, sum = 0, n = 3.0 * HEIGHT * (x1 - x0);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = x0; x < x1; x++)
            for (int k = 0; k < 3; k++) {
                double off = (double)image_at(image, x, y)[k] / (double)level(x, y) - 1;
                squares += off * off / n;
                sum += off / n;
            }
    if (mean) *mean = sum;
    return squares;
}

static float flat(uint32_t x, uint32_t y)
{
    (void)x;
    (void)y;
    return 0.3f;
}

static float stepped(uint32_t x, uint32_t y)
{
    (void)y;
    return x < WIDTH / 2 ? 0.1f : 0.4f;
}

static float lined(uint32_t x, uint32_t y)
{
    (void)y;
    return x == WIDTH / 2 ? 0.4f : 0.1f;
}

/* A texture far finer than the squares that are compared. */
static float checkered(uint32_t x, uint32_t y)
{
    return (x ^ y) & 1 ? 0.5f : 0.1f;
}

static float high(uint32_t x, uint32_t y)
{
    return x == 20 && y == 20 ? 1e30f : (x & 1) ? 0.0f : 1e-30f;
}

static void a_flat_picture_becomes_smooth(void **state)
{
    (void)state;
    for (uint32_t samples = 8; samples <= 48; samples *= 6) {
        Films films;
        double before, after;
        fill(&films, flat, samples, 1);
        run(&films);
        double noisy = error_of(&films.noisy, flat, 0, WIDTH, &before);
        assert_true(error_of(&films.image, flat, 0, WIDTH, &after) < noisy / 25);
        assert_near(after, before, 0.1 * sqrt(noisy)); /* and as bright as it was */
        end(&films);
    }
}

/* What a glint that one sample of one pixel found is, says nothing of those around it: no patch of its colour. */
static void a_dot_makes_no_patch(void **state)
{
    (void)state;
    enum { X = 30, Y = 20 };
    Films films;
    fill(&films, flat, 16, 1);
    (void)film_add(&films.film, X, Y, (float[]){5000, 300, 700}, 1);
    run(&films);
    float most = 0, least = 1;
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (int k = 0; k < 3 && (x != X || y != Y); k++) {
                most = fmaxf(most, image_at(&films.image, x, y)[k]);
                least = fminf(least, image_at(&films.image, x, y)[k]);
            }

    printf("    beside a dot: %.3f to %.3f\n", (double)least, (double)most);
    assert_true(most < 0.45f && least > 0.2f);
    end(&films);
}

/* By how much a pixel differs from the mean of the four beside it: 1 where a colour has as much again. */
static double grain_at(const Image *image, uint32_t x, uint32_t y)
{
    double most = 0;
    for (int k = 0; k < 3; k++) {
        double beside = ((double)image_at(image, x - 1, y)[k] + (double)image_at(image, x + 1, y)[k] +
                         (double)image_at(image, x, y - 1)[k] + (double)image_at(image, x, y + 1)[k]) /
                        4;
        most = fmax(most, fabs((double)image_at(image, x, y)[k] / beside - 1));
    }
    return most;
}

/* Some coloured glints, which lose light as they look alike: it does not come back as grain on all that is around. */
static void glints_leave_no_grain(void **state)
{
    (void)state;
    static const uint32_t glints[][2] = {{34, 18}, {36, 21}, {38, 17}, {39, 22}, {33, 22}, {37, 19}};
    Films films;
    double sum = 0, n = 0;
    fill(&films, flat, 16, 1);
    for (size_t i = 0; i < COUNT_OF(glints); i++)
        (void)film_add(&films.film, glints[i][0], glints[i][1], (float[]){30, 3, 20}, 1);
    run(&films);
    for (uint32_t y = 2; y + 2 < HEIGHT; y++)
        for (uint32_t x = 24; x < 49; x++) {
            bool beside = false;
            for (size_t i = 0; i < COUNT_OF(glints); i++)
                beside = beside || hypot((double)x - glints[i][0], (double)y - glints[i][1]) < 3;
            if (beside) continue;
            sum += grain_at(&films.image, x, y);
            n++;
        }
    printf("    grain around glints: %.4f\n", sum / n);
    assert_true(sum / n < 0.02);
    end(&films);
}

/* Glints that one pixel in many has found: none of their light is lost, though there are fewer of them. */
static void glints_keep_their_light(void **state)
{
    (void)state;
    Films films;
    double before = 0, after = 0;
    fill(&films, flat, 16, 1);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            uint32_t hash = hash_combine(hash_combine(x, 99), y);
            float bright = 8 * hash_to_unit_f(hash_combine(hash, 1));
            if (hash_to_unit_f(hash) < 0.2f) (void)film_add(&films.film, x, y, (float[]){bright, bright, bright}, 1);
        }
    run(&films);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            before += (double)image_at(&films.noisy, x, y)[1];
            after += (double)image_at(&films.image, x, y)[1];
        }
    printf("    light after denoising over that before: %.4f\n", after / before);
    assert_near(after / before, 1, 0.002);
    end(&films);
}

static void edges_and_lines_stay(void **state)
{
    (void)state;
    Level *const levels[] = {stepped, lined, checkered};
    for (size_t i = 0; i < COUNT_OF(levels); i++) {
        Films films;
        fill(&films, levels[i], 32, 1);
        run(&films);
        uint32_t x0 = WIDTH / 2 - 1, x1 = WIDTH / 2 + 1;
        double noisy = error_of(&films.noisy, levels[i], 0, WIDTH, NULL);
        assert_true(error_of(&films.image, levels[i], 0, WIDTH, NULL) < noisy / 10);
        assert_true(error_of(&films.image, levels[i], x0, x1, NULL) < noisy / 4);
        end(&films);
    }
}

static void what_has_no_noise_stays(void **state)
{
    (void)state;
    Films films;
    fill(&films, checkered, 16, 0);
    run(&films);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (int k = 0; k < 3; k++) assert_near(image_at(&films.image, x, y)[k], checkered(x, y), 1e-6);
    end(&films);
}

/* Of two things of one colour, and of one that has too few samples. */
static void what_is_unlike_is_kept_apart(void **state)
{
    (void)state;
    Films films;
    fill(&films, flat, 16, 1);
    float few[] = {9, 9, 9};
    films.film.pixels[20 * WIDTH + 30] = (FilmPixel){.n = 0};
    for (int i = 0; i < DENOISE_LEAST_SAMPLES - 1; i++) (void)film_add(&films.film, 30, 20, few, 1);
    run(&films);
    for (int k = 0; k < 3; k++) assert_true(image_at(&films.image, 30, 20)[k] == 9);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            if (x != 30 || y != 20) assert_true(image_at(&films.image, x, y)[0] < 1);
    end(&films);
}

static void whatever_a_film_holds_is_good(void **state)
{
    (void)state;
    for (uint32_t samples = 0; samples <= 4; samples++) {
        Films films;
        fill(&films, high, samples, 0.5f);
        run(&films);
        for (size_t i = 0; i < (size_t)WIDTH * HEIGHT * films.image.n_channels; i++)
            assert_true(isfinite(films.image.pixels[i]));
        end(&films);
    }
}

/* A glass with a drink on a table: against two pictures of other seeds, the products of the differences from which have the
 * squared error as their mean, without what is left of their own noise. */
static void rendered(void **state)
{
    (void)state;
    enum { SIZE = 96, PLAIN = 0, DENOISED, REFERENCE, ALL = 4 };
    Fixture scene;
    Error error;
    Image images[ALL];
    fixture_compile(
        &scene,
        "meniscus 1.0 unit mm lathe { interior = medium { ior = 1.5 state = solid } "
        "profile = [<0, 0>, <20, 0>, <22, 40>, <20, 40>, <18, 4>, <0, 4>] } "
        "cylinder { from = <0, 3.5, 0> to = <0, 25, 0> radius = 18.9 "
        "interior = medium { ior = 1.33 tint = rgb(.9, .6, .3) depth = 20mm state = liquid } } "
        "ground { y = -.01 surface = surface { albedo = .6 } } "
        "light { shape = sphere from = <-90, 120, -60> radius = 30 radiance = 40 } environment { strength = .3 } "
        "camera { from = <0, 60, -140> to = <0, 18, 0> fov = 28 }",
        1);
    for (uint32_t k = 0; k < ALL; k++) {
        RenderSettings settings = {.width = SIZE,
                                   .height = SIZE,
                                   .samples = k < REFERENCE ? 32 : 64,
                                   .bounces = 64,
                                   .seed = k < REFERENCE ? 0 : k,
                                   .denoises = k == DENOISED,
                                   .spreads = true};
        RenderStats stats;
        assert_int_equal(render_image(scene.compiled, &settings, NULL, NULL, &images[k], &stats, &error), STATUS_OK);
        assert_int_equal(images[k].n_channels, 5); /* what guides it is not written */
    }
    double squares[2] = {0}, means[ALL] = {0};
    for (uint32_t y = 0; y < SIZE; y++)
        for (uint32_t x = 0; x < SIZE; x++)
            for (int i = 0; i < 3; i++) {
                double of[ALL];
                for (int k = 0; k < ALL; k++) means[k] += of[k] = (double)image_at(&images[k], x, y)[i];
                double weight = 1 / (of[2] * of[3] + 0.01);
                for (int k = 0; k < 2; k++) squares[k] += (of[k] - of[2]) * (of[k] - of[3]) * weight;
            }
    printf("    squared error of 32 samples, denoised over plain: %.3f; as bright: %.4f\n", squares[1] / squares[0],
           means[1] / means[0]);
    assert_true(squares[1] < 0.62 * squares[0]);
    assert_near(means[1] / means[0], 1, 0.003);
    for (int k = 0; k < ALL; k++) image_clear(&images[k]);
    fixture_clear(&scene);
}

static double mean_of_columns(const Image *image, uint32_t x0, uint32_t x1)
{
    double sum = 0;
    for (uint32_t y = image->height / 4; y < image->height * 3 / 4; y++)
        for (uint32_t x = x0; x < x1; x++) sum += (double)image_at(image, x, y)[1];
    return sum / (x1 - x0);
}

/* A thin rod that is hardly darker than the glass around it, and is met behind that glass's surface. */
static void faint_things_behind_glass_stay(void **state)
{
    (void)state;
    enum { SIZE = 96, PLAIN = 0, DENOISED, MANY, ALL };
    static const uint32_t samples[ALL] = {16, 16, 256};
    Fixture scene;
    Error error;
    double contrast[ALL];
    fixture_compile(&scene,
                    "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } "
                    "medium plastic { ior = 1.49 tint = rgb(.85) depth = 6mm state = solid } "
                    "box { interior = glass from = <-40, 0, -10> to = <40, 60, 10> } "
                    "cylinder { interior = plastic from = <0, 2, 0> to = <0, 58, 0> radius = 1.2 } "
                    "box { from = <-100, -100, 60> to = <100, 200, 65> surface = surface { albedo = .7 } } "
                    "light { shape = sphere from = <-90, 160, -30> radius = 25 radiance = 40 } "
                    "environment { strength = .2 } camera { from = <0, 30, -200> to = <0, 30, 0> fov = 18 }",
                    1);
    for (uint32_t k = 0; k < ALL; k++) {
        RenderSettings settings = {
            .width = SIZE, .height = SIZE, .samples = samples[k], .bounces = 64, .denoises = k == DENOISED};
        RenderStats stats;
        Image image;
        assert_int_equal(render_image(scene.compiled, &settings, NULL, NULL, &image, &stats, &error), STATUS_OK);
        double beside = (mean_of_columns(&image, 36, 43) + mean_of_columns(&image, 53, 60)) / 2;
        contrast[k] = 1 - mean_of_columns(&image, 47, 49) / beside;
        image_clear(&image);
    }
    printf("    contrast of a rod in glass: %.4f, of 16 samples %.4f, denoised %.4f\n", contrast[MANY], contrast[PLAIN],
           contrast[DENOISED]);
    assert_true(contrast[DENOISED] > 0.75 * contrast[MANY]);
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flat_picture_becomes_smooth),
        cmocka_unit_test(a_dot_makes_no_patch),
        cmocka_unit_test(glints_leave_no_grain),
        cmocka_unit_test(glints_keep_their_light),
        cmocka_unit_test(edges_and_lines_stay),
        cmocka_unit_test(what_has_no_noise_stays),
        cmocka_unit_test(what_is_unlike_is_kept_apart),
        cmocka_unit_test(whatever_a_film_holds_is_good),
        cmocka_unit_test(rendered),
        cmocka_unit_test(faint_things_behind_glass_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
