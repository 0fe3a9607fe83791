/* adapt_test.c - where more samples are asked for: by the neighbours, in steps, up to the most.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "render/adapt.h"
#include "render/pixel_noise.h"

enum { SIDE = 40, MIDDLE = SIDE / 2 };
static float light = 1; /* what luminances are multiplied by */

/* Samples of a pixel, to the right of the middle of luminances of 1 with a deviation of 0.5; to the left, of 1 alone. */
static void add(Film *film, uint32_t x, uint32_t y, uint32_t samples, bool noisy)
{
    for (uint32_t first = film_pixel(film, x, y)->n, i = first; i < first + samples; i++) {
        double u = hash_to_unit(hash_u64(((uint64_t)y * SIDE + x) * 1000 + i)) - 0.5;
        float value = (float)(noisy ? 1 + u * sqrt(3) : 1);
        (void)film_add(film, x, y, (float[]){light * value, light * value, light * value}, 1);
    }
}

static void fill(Film *film, uint32_t samples)
{
    Error error;
    assert_int_equal(film_init(film, SIDE, SIDE, &error), STATUS_OK);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) add(film, x, y, samples, x >= MIDDLE);
}

static AdaptPlan plan_of(const Film *film, double noise, uint32_t most, uint32_t *wanted)
{
    Error error;
    Adapt adapt;
    assert_int_equal(adapt_init(&adapt, film, (Exposure){0}, &error), STATUS_OK);
    AdaptPlan plan;
    assert_int_equal(adapt_plan(&adapt, film, noise, most, NULL, &plan, &error), STATUS_OK);
    memcpy(wanted, adapt.wanted, SIDE * SIDE * sizeof *wanted);
    adapt_clear(&adapt);
    return plan;
}

/* The mean |error| of a mean of 16 samples is sqrt(2 / pi) * 0.5 / 4, of luminance 1, in half of the pixels. */
static void noise_is_the_mean_error(void **state)
{
    (void)state;
    Film film;
    fill(&film, 16);
    double expected = 0.5 * sqrt(2 / acos(-1)) * 0.125 / sqrt(1.01);
    assert_near(adapt_noise(&film, NULL, (Exposure){0}, NULL), expected, 0.06 * expected);
    film_clear(&film);
    fill(&film, 1);
    assert_true(adapt_noise(&film, NULL, (Exposure){0}, NULL) < 0);
    film_clear(&film);
}

static void samples_go_where_the_noise_is(void **state)
{
    (void)state;
    static uint32_t wanted[SIDE * SIDE];
    Film film;
    fill(&film, 16);
    AdaptPlan plan = plan_of(&film, 0.02, 1000, wanted);
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        if (i % SIDE + 5 < MIDDLE) assert_int_equal(wanted[i], 16);
        if (i % SIDE >= MIDDLE)
            assert_int_equal(wanted[i], 32); /* about 400 are needed, twice as many are taken at once */
    }
    assert_int_equal(plan.next, 16);
    assert_true(plan.left > SIDE * MIDDLE * 200 && plan.left < plan.at_most && plan.at_most == SIDE * SIDE * 984);
    plan = plan_of(&film, 0.02, 20, wanted);
    assert_int_equal(wanted[SIDE - 1], 20);
    plan = plan_of(&film, 0.02, 16, wanted);
    assert_int_equal(plan.next, 0);
    assert_true(plan.unmet >= SIDE * MIDDLE && plan.unmet < SIDE * SIDE);
    plan = plan_of(&film, 0.2, 1000, wanted);
    assert_int_equal(plan.next, 0);
    assert_int_equal(plan.left + plan.unmet, 0);
    film_clear(&film);
}

/* A firefly calls for samples all around, not at its own place. */
static void no_pixel_judges_itself(void **state)
{
    (void)state;
    static uint32_t before[SIDE * SIDE], after[SIDE * SIDE];
    Film film;
    fill(&film, 16);
    uint32_t place = 10 * SIDE + 8; /* where all is smooth */
    (void)plan_of(&film, 0.02, 1000, before);
    (void)film_add(&film, 8, 10, (float[]){100, 100, 100}, 1);
    (void)plan_of(&film, 0.02, 1000, after);
    assert_int_equal(before[place], 16);
    assert_int_equal(after[place], 17); /* what it has */
    for (uint32_t y = 8; y <= 12; y++)
        for (uint32_t x = 6; x <= 10; x++)
            if (y * SIDE + x != place) assert_true(after[y * SIDE + x] > before[y * SIDE + x]);
    film_clear(&film);
}

static AdaptPlan shares_of(const Film *film, uint32_t samples, uint32_t *wanted, double *mean)
{
    Error error;
    Adapt adapt;
    AdaptPlan plan;
    assert_int_equal(adapt_init(&adapt, film, (Exposure){0}, &error), STATUS_OK);
    assert_int_equal(adapt_share(&adapt, film, samples, NULL, &plan, &error), STATUS_OK);
    double sum = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) sum += wanted[i] = adapt.wanted[i];
    *mean = sum / (SIDE * SIDE);
    adapt_clear(&adapt);
    return plan;
}

/* Plan by plan, to the last one; the mean number of samples then. */
static double hand_out(Film *film, uint32_t samples)
{
    static uint32_t wanted[SIDE * SIDE];
    double mean;
    while (shares_of(film, samples, wanted, &mean).next)
        for (uint32_t i = 0; i < SIDE * SIDE; i++) {
            FilmPixel *pixel = &film->pixels[i];
            uint64_t rays = pixel->rays / pixel->n;
            add(film, i % SIDE, i / SIDE, wanted[i] - pixel->n, i % SIDE >= MIDDLE);
            pixel->rays = rays * pixel->n;
        }
    return mean;
}

static void a_number_of_samples_is_shared_out_by_need(void **state)
{
    (void)state;
    static uint32_t wanted[SIDE * SIDE];
    double mean;
    Film film;
    fill(&film, 16);
    AdaptPlan plan = shares_of(&film, 1000, wanted, &mean); /* twice as many, then it is asked again */
    assert_true(plan.left == SIDE * SIDE * 984 && plan.next == 16);
    for (uint32_t i = 0; i < SIDE * SIDE; i++)
        if (i % SIDE + 1 < MIDDLE || i % SIDE > MIDDLE) assert_int_equal(wanted[i], i % SIDE < MIDDLE ? 16 : 32);
    (void)shares_of(&film, 28, wanted, &mean); /* the noisy ones are to have more than that in the end */
    assert_true(mean > 23 && mean < 25);
    plan = shares_of(&film, 16, wanted, &mean);
    assert_true(plan.next == 0 && plan.left == 0 && mean == 16);
    assert_near(hand_out(&film, 40), 40, 0.2);
    film_clear(&film);
    fill(&film, 16); /* what takes eight times as many rays gets fewer samples */
    for (uint32_t i = 0; i < SIDE * SIDE; i++) film_add_rays(&film, i % SIDE, i / SIDE, i / SIDE < SIDE / 2 ? 16 : 240);
    assert_near(hand_out(&film, 32), 32, 0.3);
    double above = 0, below = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) *(i / SIDE < SIDE / 2 ? &above : &below) += film.pixels[i].n - 16;
    assert_true(above > 2 * below && below > 0);
    film_clear(&film);
    fill(&film, 1024); /* no pixel has less than a quarter of the mean, however quiet it is */
    FilmPixel *quiet = &film.pixels[MIDDLE * SIDE];
    *quiet = (FilmPixel){0};
    for (int i = 0; i < 16; i++) (void)film_add(&film, 0, MIDDLE, (float[]){1, 1, 1}, 1);
    (void)shares_of(&film, 2048, wanted, &mean);
    assert_in_range(wanted[MIDDLE * SIDE], 512, 768);
    film_clear(&film);
}

/* Where nothing is noisy there is nobody to give the rest to. */
static void without_noise_a_render_ends(void **state)
{
    (void)state;
    static uint32_t wanted[SIDE * SIDE];
    double mean;
    Film film;
    Error error;
    assert_int_equal(film_init(&film, SIDE, SIDE, &error), STATUS_OK);
    for (uint32_t i = 0; i < SIDE * SIDE * 16; i++)
        (void)film_add(&film, i % SIDE, i / SIDE % SIDE, (float[]){1, 1, 1}, 1);
    assert_int_equal(shares_of(&film, 64, wanted, &mean).next, 0);
    assert_true(mean == 16);
    film_clear(&film);
}

/* Of a picture of so many pixels each way: the mean of the stated standard errors over the true one, and the least. */
static void small_error(uint32_t side, double *mean, double *least)
{
    static const float true_error = 0.5f / 8; /* of 64 samples */
    Error error;
    Film film;
    static float errors[SIDE * SIDE];
    assert_int_equal(film_init(&film, side, side, &error), STATUS_OK);
    for (uint32_t y = 0; y < side; y++)
        for (uint32_t x = 0; x < side; x++) add(&film, x, y, 64, true);
    assert_int_equal(pixel_noise(&film, NULL, NULL, errors, &error), STATUS_OK);
    *mean = 0;
    *least = 9;
    for (uint32_t i = 0; i < side * side; i++) {
        double ratio = (double)(errors[i] / true_error);
        *mean += ratio / (side * side);
        if (ratio < *least) *least = ratio;
    }
    film_clear(&film);
}

static void small_pictures_know_their_noise(void **state)
{
    (void)state;
    double mean, least;
    for (uint32_t side = 1; side <= MIDDLE; side += 6) {
        small_error(side, &mean, &least);
        printf("        %u x %u pixels: stated over true %.3f, at least %.3f\n", side, side, mean, least);
        assert_near(mean, 1, 0.25);
        assert_true(least > 0.7);
    }
}

/* All that is asked of a film: what its noise is, the errors of its pixels, and its samples' shares. */
typedef struct Answers {
    double noise;
    float errors[SIDE * SIDE];
    uint32_t shares[SIDE * SIDE], wanted[SIDE * SIDE];
} Answers;

static void ask(const Film *film, Exposure exposure, Pool *pool, Answers *answers)
{
    Error error;
    Adapt adapt;
    AdaptPlan plan;
    answers->noise = adapt_noise(film, NULL, exposure, pool);
    assert_int_equal(pixel_noise(film, NULL, pool, answers->errors, &error), STATUS_OK);
    assert_int_equal(adapt_init(&adapt, film, exposure, &error), STATUS_OK);
    assert_int_equal(adapt_share(&adapt, film, 64, pool, &plan, &error), STATUS_OK);
    memcpy(answers->shares, adapt.wanted, sizeof answers->shares);
    assert_int_equal(adapt_plan(&adapt, film, 0.08, 64, pool, &plan, &error), STATUS_OK);
    memcpy(answers->wanted, adapt.wanted, sizeof answers->wanted);
    adapt_clear(&adapt);
}

static void threads_change_nothing(void **state)
{
    (void)state;
    static Answers alone, together;
    Film film;
    Pool *pool;
    Error error;
    assert_int_equal(pool_new(3, &pool, &error), STATUS_OK);
    fill(&film, 16);
    ask(&film, (Exposure){0}, NULL, &alone);
    ask(&film, (Exposure){0}, pool, &together);
    assert_true(alone.noise > 0);
    assert_true(alone.noise == together.noise);
    assert_memory_equal(alone.errors, together.errors, sizeof alone.errors);
    assert_memory_equal(alone.shares, together.shares, sizeof alone.shares);
    film_clear(&film);
    pool_free(pool);
}

/* By moonlight and at noon, in candelas per square metre: with an exposure that shows the same picture, or one that is found, the
 * same noise is stated, and the same is wanted. Without, all that is dark has no noise, and what is bright has as much. */
static void what_looks_alike_is_judged_alike(void **state)
{
    (void)state;
    static Answers usual, found, scaled;
    Film film;
    fill(&film, 16);
    ask(&film, (Exposure){0}, NULL, &usual);
    ask(&film, (Exposure){.automatic = true}, NULL, &found);
    film_clear(&film);
    for (int stops = -16; stops <= 10; stops += 13) { /* by which the film is brightened */
        light = exp2f((float)-stops);
        fill(&film, 16);
        for (int automatic = 0; automatic < 2; automatic++) {
            const Answers *expected = automatic ? &found : &usual;
            ask(&film, (Exposure){automatic ? 0 : stops, automatic}, NULL, &scaled);
            assert_near(scaled.noise, expected->noise, 1e-5 * expected->noise);
            assert_memory_equal(scaled.wanted, expected->wanted, sizeof scaled.wanted);
            assert_memory_equal(scaled.shares, expected->shares, sizeof scaled.shares);
            for (uint32_t i = 0; i < SIDE * SIDE; i++)
                assert_near((double)(scaled.errors[i] / light), expected->errors[i], 1e-5);
        }
        double unexposed = adapt_noise(&film, NULL, (Exposure){0}, NULL) / usual.noise;
        if (stops > 0)
            assert_true(unexposed < 0.02);
        else
            assert_near(unexposed, 1, 0.01);
        film_clear(&film);
    }
    light = 1;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_change_nothing),      cmocka_unit_test(what_looks_alike_is_judged_alike),
        cmocka_unit_test(noise_is_the_mean_error),     cmocka_unit_test(samples_go_where_the_noise_is),
        cmocka_unit_test(no_pixel_judges_itself),      cmocka_unit_test(a_number_of_samples_is_shared_out_by_need),
        cmocka_unit_test(without_noise_a_render_ends), cmocka_unit_test(small_pictures_know_their_noise),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
