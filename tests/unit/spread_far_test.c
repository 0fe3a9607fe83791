/* spread_far_test.c - samples that stand alone and go far, over a large thing, by cells; and how close together they lie.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "render/spread_density.h"
#include "spread_films.h"

static float even_light(uint32_t x, uint32_t y)
{
    (void)x;
    (void)y;
    return 0.1f;
}

static float chequered_light(uint32_t x, uint32_t y)
{
    return (x / 3 + y / 3) % 2 ? 0.1f : 1e-5f;
}

/* All of it arrives, as far as is expected of its brightness; pixels that are next to black get a sixth. */
static void what_goes_far_arrives(void **state)
{
    (void)state;
    Films films;
    double sum = 0, chequers[2] = {0};
    const double light = 900.0 / (SAMPLES_OF_LARGE + 1);
    begin_large(&films, LARGE, chequered_light);
    uint32_t x = LARGE / 2 + 1, y = LARGE / 2 - 2;
    assert_true(chequered_light(x, y) > 0.05f);
    add(&films, x, y, (float[]){900, 900, 900}, 1);
    resolve(&films);
    assert_int_equal(films.way.samples, 1);
    double farthest = 0;
    for (uint32_t at = 0; at < LARGE * LARGE; at++) {
        double u = (double)(at % LARGE) - x, v = (double)(at / LARGE) - y,
               gain = gain_at(&films, at % LARGE, at / LARGE);
        sum += gain;
        if (gain > 0) farthest = fmax(farthest, sqrt(u * u + v * v));
        if (u * u + v * v > 9 && u * u + v * v < 30 * 30)
            chequers[chequered_light(at % LARGE, at / LARGE) > 0.05f] += gain;
    }
    assert_near(sum / light, 0, 1e-12);
    assert_near(chequers[0] / chequers[1], 1 / 6.0, 0.02);
    assert_true(farthest > 90 && farthest < 180);
    printf("    a sample of %g times what is there goes %.0f pixels far\n", light / 0.05, farthest);
    end(&films);
}

/* A sample in each column, one at a time: what all columns get of these together, over what they give. By columns, as rows are
 * alike. */
static void edges_get_as_much_from_far(void **state)
{
    (void)state;
    enum { COLUMNS = LARGE / 2 };
    static double sums[COLUMNS];
    Error error;
    Films films;
    const float bright = 600;
    double worst = 0;
    begin_large(&films, COLUMNS, even_light);
    for (uint32_t x = 0; x < COLUMNS; x++) {
        size_t at = (size_t)LARGE / 2 * LARGE + x;
        FilmPixel pixel = films.film.pixels[at];
        BrightPixel kept = films.bright.pixels[at];
        add(&films, x, LARGE / 2, (float[]){bright, bright, bright}, 1);
        assert_int_equal(spread_init(&films.way, &films.film, &films.bright, NULL, &error), STATUS_OK);
        assert_int_equal(films.way.samples, 1);
        for (uint32_t to = 0; to < LARGE * LARGE; to++)
            if (to % LARGE < COLUMNS)
                sums[to % LARGE] += gain_at(&films, to % LARGE, to / LARGE) / ((double)bright / (SAMPLES_OF_LARGE + 1));
        spread_clear(&films.way);
        films.film.pixels[at] = pixel;
        films.bright.pixels[at] = kept;
    }
    for (uint32_t x = 0; x < COLUMNS; x++) worst = fmax(worst, fabs(sums[x]));
    printf("    columns get what they give within %.3f\n", worst);
    assert_near(worst, 0, 0.08); /* by pixels 0.071 */
    film_clear(&films.film);
    bright_film_clear(&films.bright);
}

/* Many of all brightnesses, on three things that overlap: nothing is lost, and any number of threads gives the same. */
static void much_goes_far(void **state)
{
    (void)state;
    Films films;
    double sum = 0, light = 0;
    begin_large(&films, LARGE, chequered_light);
    for (uint32_t i = 0; i < 600; i++) {
        uint64_t key = hash_u64(i);
        float bright = expf(10 * hash_to_unit_f(hash_u32(i + 7))) * 0.3f;
        add(&films, (uint32_t)(key % LARGE), (uint32_t)(key / LARGE % LARGE), (float[]){bright, 0.5f * bright, bright},
            1 + i % 3 / 2);
        light += (double)bright / (SAMPLES_OF_LARGE + 1);
    }
    resolve(&films);
    assert_true(films.way.samples > 200);
    for (uint32_t at = 0; at < LARGE * LARGE; at++) sum += gain_at(&films, at % LARGE, at / LARGE);
    assert_near(sum / light, 0, 1e-12);
    end(&films);
}

/* ---- how close they lie ---- */

enum { COLUMNS = 60, ROWS = 40, BORDER = 24 };

/* So many in each cell to the left of the border, and none to the right. */
static uint32_t count_left(const void *each, size_t cell, float least)
{
    return least > 0 || cell % COLUMNS >= BORDER ? 0 : *(const uint32_t *)each;
}

/* Amid what is even the density is just that, to an edge of the thing, too; beyond the border it is that of the least square that
 * holds sixteen, by areas: k cells beyond, it takes 16 of the columns' strip of 2 (k + 1) + 1 rows. */
static void densities_of_what_is_even_and_of_nothing(void **state)
{
    (void)state;
    double shares[COLUMNS * ROWS];
    for (size_t i = 0; i < COUNT_OF(shares); i++) shares[i] = 0.25;
    for (uint32_t each = 1; each < 40; each += 3) {
        Densities densities;
        assert_true(density_init(&densities, COLUMNS, ROWS, shares));
        assert_true(density_find(&densities, DENSITY_ANY, count_left, &each, NULL));
        const float *around = densities.kinds[DENSITY_ANY].around;
        const uint32_t rows[] = {0, 1, ROWS / 2, ROWS - 1};
        for (size_t i = 0; i < COUNT_OF(rows); i++) {
            for (uint32_t x = 0; x < BORDER - 5; x++)
                assert_near((double)around[rows[i] * COLUMNS + x], each / 0.25, 1e-4 * each);
            double before = HUGE_VAL;
            for (uint32_t x = BORDER; x < (COLUMNS + BORDER) / 2 - 1; x++) { /* where no square is cut */
                double density = (double)around[rows[i] * COLUMNS + x];
                assert_true(density > 0 && density < before);
                before = density;
            }
        }
        double k = 8, inner = 2 * k + 1, outer = inner + 2, of_border = each * outer, part = fmin(16 / of_border, 1);
        if (part < 1) {
            double wanted = 16 / (0.25 * (inner * inner + part * (outer * outer - inner * inner)));
            assert_near((double)around[ROWS / 2 * COLUMNS + BORDER + (size_t)k], wanted, 1e-4 * wanted);
        }
        assert_near(density_within(&densities, DENSITY_ANY, (CellSquare){BORDER - 3, 4, BORDER + 3, 9}), each / 0.5,
                    1e-9);
        density_clear(&densities);
    }
}

/* Too few to tell: all get what they would. */
static void few_say_nothing(void **state)
{
    (void)state;
    double shares[COLUMNS * ROWS] = {1};
    Densities densities;
    const uint32_t none = 0;
    assert_true(density_init(&densities, COLUMNS, ROWS, shares));
    assert_true(density_find(&densities, DENSITY_ANY, count_left, &none, NULL));
    for (size_t i = 0; i < COUNT_OF(shares); i++) assert_true(density_part(&densities, DENSITY_ANY, i, 1) == 1);
    density_clear(&densities);
}

static void kinds_are_powers_of_two(void **state)
{
    (void)state;
    for (float least = 1e-30f; least < 1e30f; least *= 1.3f) {
        int kind = density_kind(least);
        assert_true(kind > DENSITY_ANY && kind < DENSITY_KINDS);
        assert_true(density_kind(2 * least) == kind + 1);
    }
    assert_true(density_kind(0) > DENSITY_ANY && density_kind(1e-44f) > DENSITY_ANY &&
                density_kind(3e38f) < DENSITY_KINDS);
}

static float no_light(uint32_t x, uint32_t y)
{
    (void)x;
    (void)y;
    return 0;
}

/* In haze before a wall and behind it, which is one thing, samples before the wall find light, faint ones often and bright ones now and
 * then: none of it goes far behind the wall. By discs alone it would be 18 % of what is before it; 0.5 % now. */
static void nothing_goes_where_none_is_found(void **state)
{
    (void)state;
    Films films;
    enum { WALL = 120 };
    double before = 0, behind = 0;
    begin_large(&films, LARGE, no_light);
    for (uint32_t i = 0; i < 6000; i++) {
        uint64_t key = hash_u64(i);
        float bright = i % 250 == 0 ? 800 : i % 10 == 0 ? 40 : 1;
        add(&films, (uint32_t)(key % WALL), (uint32_t)(key / WALL % LARGE), (float[]){bright, bright, bright}, 1);
    }
    resolve(&films);
    assert_true(films.way.samples > 300);
    for (uint32_t at = 0; at < LARGE * LARGE; at++) {
        double light = (double)image_at(&films.spread, at % LARGE, at / LARGE)[1];
        if (at % LARGE < WALL) before += light / (WALL * LARGE);
        if (at % LARGE >= WALL + 30) behind += light / ((LARGE - WALL - 30) * LARGE);
    }
    printf("    %g before the wall, %g behind it\n", before, behind);
    assert_true(behind < 0.01 * before);
    end(&films);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_goes_far_arrives),
        cmocka_unit_test(edges_get_as_much_from_far),
        cmocka_unit_test(much_goes_far),
        cmocka_unit_test(densities_of_what_is_even_and_of_nothing),
        cmocka_unit_test(few_say_nothing),
        cmocka_unit_test(kinds_are_powers_of_two),
        cmocka_unit_test(nothing_goes_where_none_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
