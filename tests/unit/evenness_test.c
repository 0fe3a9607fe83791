/* evenness_test.c - errors of evenly spread samples from their differences: closed forms, and films of known integrands.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "render/evenness.h"
#include "trace/sampler.h"

#define assert_in(value, low, high) assert_near(value, ((low) + (high)) / 2.0, ((high) - (low)) / 2.0)

enum { SIDE = 96 };

/* Nothing is better than by chance where differences fall by chance, whatever the number of samples. */
static void independent_samples_are_as_their_halves_say(void **state)
{
    (void)state;
    for (uint32_t n = 2; n < 3000; n += 1 + n / 7) {
        assert_near(evenness_factor(-0.5, 0, n), 1, 1e-9);
        assert_near(evenness_factor(-0.5 - 1e-6, 0, n), 1, 1e-3);
    }
    for (uint32_t n = 2; n < 3000; n = n & (n - 1) ? n / 3 * 4 : n / 2 * 3)
        assert_true(evenness_factor(-1, 0, n) < 1 && evenness_factor(-1.4, 0, n) < evenness_factor(-1, 0, n));
}

/* D = r^k with r = 1/8: the variance of 2^(k+1) is D / 4 * r / (1 - r), of independent ones D / 4. Three pieces:
 * (r / (1 - r) / 4 + 1/36 - 2 r / 9) / (1/4 + r) against 2/9. */
static void smooth_samples_have_closed_forms(void **state)
{
    (void)state;
    for (uint32_t n = 2; n <= 1U << 20; n *= 2) {
        assert_near(evenness_factor(-1.5, 0, n), sqrt(1 / 7.0), 1e-9);
        assert_near(evenness_factor(-2, 0, n), sqrt(1 / 7.0), 1e-9);
    }
    double three = (1 / 28.0 + 1 / 36.0 - 1 / 36.0) / (1 / 4.0 + 1 / 8.0) / (2 / 9.0);
    for (uint32_t n = 3; n <= 3U << 20; n *= 2) assert_near(evenness_factor(-1.5, 0, n), sqrt(three), 1e-9);
}

/* ---- films ---- */

typedef float (*Integrand)(uint32_t x, uint32_t y, uint32_t i);

static float by_chance(uint32_t x, uint32_t y, uint32_t i)
{
    return (float)hash_to_unit(hash_u64(((uint64_t)x << 40) + ((uint64_t)y << 20) + i));
}

static float ramp(uint32_t x, uint32_t y, uint32_t i)
{
    Sampler sampler = sampler_make_alone(1, x, y, i);
    return sampler_1d(&sampler, 3);
}

/* Half of a square is lit, through a filter. */
static float edge(uint32_t x, uint32_t y, uint32_t i)
{
    Sampler sampler = sampler_make_alone(1, x, y, i);
    float u[2];
    sampler_2d(&sampler, 5, u);
    return (u[0] < 0.3f + 0.4f * u[1] ? 2 : 0) * sampler_1d(&sampler, 7);
}

/* Something smooth, and something that is not spread evenly, of which as much is left at some 30 samples. */
static float mixture(uint32_t x, uint32_t y, uint32_t i)
{
    return ramp(x, y, i) + 0.05f * by_chance(x, y, i) + 0.475f;
}

/* What 1 in 50 samples brings. */
static float rare(uint32_t x, uint32_t y, uint32_t i)
{
    return by_chance(x, y, i) < 0.02f ? 25 : 0;
}

static double stated_over_measured(Integrand integrand, uint32_t n, double mean)
{
    Error error;
    Film film;
    Evenness evenness;
    double stated = 0, measured = 0;
    assert_int_equal(film_init(&film, SIDE, SIDE, &error), STATUS_OK);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++)
            for (uint32_t i = 0; i < n; i++) {
                float value = integrand(x, y, i);
                (void)film_add(&film, x, y, (float[]){value, value, value}, 1);
            }
    assert_int_equal(evenness_init(&evenness, &film, NULL, &error), STATUS_OK);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const FilmPixel *pixel = film_pixel(&film, x, y);
            double of_samples, value;
            film_luminance(pixel, &value, &of_samples);
            measured += fabs(value - mean);
            stated += film_spread(pixel) / sqrt(n) * evenness_of_error(&evenness, x, y, n);
        }
    evenness_clear(&evenness);
    film_clear(&film);
    return stated / measured;
}

/* Where all pixels have the same integrand, of one kind or at the turn from one kind to another, a forecast may be off by
 * more than in pictures. */
static void films_of_known_integrands(void **state)
{
    (void)state;
    const struct {
        const char *name;
        Integrand integrand;
        double mean, low, high;
    } cases[] = {{"by chance", by_chance, 0.5, 0.93, 1.07},
                 {"ramp", ramp, 0.5, 0.93, 1.07},
                 {"edge", edge, 0.5, 0.8, 1.25},
                 {"mixture", mixture, 1, 0.5, 1.25},
                 {"rare", rare, 0.5, 0.7, 1.35}};
    static const uint32_t samples[] = {16, 24, 32, 64, 96, 100, 256};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        print_message("%-13s stated over measured at 16 to 256 samples:", cases[i].name);
        for (size_t k = 0; k < COUNT_OF(samples); k++) {
            double quotient = stated_over_measured(cases[i].integrand, samples[k], cases[i].mean);
            print_message(" %.2f", quotient);
            assert_in(quotient, cases[i].low, cases[i].high);
        }
        print_message("\n");
    }
}

/* Where too few samples are there, or none differ, chance is what is assumed. */
static void little_is_known_of_few_samples(void **state)
{
    (void)state;
    Error error;
    Film film;
    Evenness evenness;
    assert_int_equal(film_init(&film, SIDE, SIDE, &error), STATUS_OK);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++)
            for (uint32_t i = 0; i < (y < SIDE / 2 ? 12U : 40U); i++) {
                float value = y < SIDE / 2 ? ramp(x, y, i) : 1;
                (void)film_add(&film, x, y, (float[]){value, value, value}, 1);
            }
    assert_int_equal(evenness_init(&evenness, &film, NULL, &error), STATUS_OK);
    for (uint32_t y = 0; y < SIDE; y++) {
        if (y + 20 > SIDE / 2 && y < SIDE / 2 + 20) continue;
        assert_near(evenness_of_square(&evenness, 5, y, 16), 1, 1e-9);
        assert_near(evenness_of_error(&evenness, 5, y, 16), 1, 1e-6);
    }
    evenness_clear(&evenness);
    film_clear(&film);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(independent_samples_are_as_their_halves_say),
        cmocka_unit_test(smooth_samples_have_closed_forms),
        cmocka_unit_test(films_of_known_integrands),
        cmocka_unit_test(little_is_known_of_few_samples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
