/* spread_films.h - films for tests of what is spread, filled sample by sample.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_SPREAD_FILMS_H
#define MEN_TEST_SPREAD_FILMS_H

#include "test.h"

#include "render/spread.h"

typedef struct Films {
    Film film;
    BrightFilm bright;
    Image kept, spread;
    Spread way;
} Films;

static inline void add_reflected(Films *films, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing,
                                 Reflected reflected)
{
    (void)film_add(&films->film, x, y, rgb, thing != BRIGHT_NOTHING);
    bright_film_add(&films->bright, x, y, rgb, thing, &reflected);
}

static inline void add(Films *films, uint32_t x, uint32_t y, const float rgb[3], uint32_t thing)
{
    add_reflected(films, x, y, rgb, thing, (Reflected){.mean = -1});
}

/* With three threads, and the same bits with one. */
static inline void resolve(Films *films)
{
    Error error;
    Pool *pool;
    Spread alone;
    size_t n = (size_t)films->film.width * films->film.height;
    assert_int_equal(film_resolve(&films->film, NULL, NULL, &films->kept, &error), STATUS_OK);
    assert_int_equal(pool_new(3, &pool, &error), STATUS_OK);
    assert_int_equal(spread_init(&films->way, &films->film, &films->bright, pool, &error), STATUS_OK);
    pool_free(pool);
    assert_int_equal(spread_init(&alone, &films->film, &films->bright, NULL, &error), STATUS_OK);
    assert_memory_equal(alone.pixels, films->way.pixels, n * sizeof *alone.pixels);
    assert_int_equal(alone.samples, films->way.samples);
    assert_true(alone.light == films->way.light);
    spread_clear(&alone);
    assert_int_equal(film_resolve(&films->film, &films->way, NULL, &films->spread, &error), STATUS_OK);
}

static inline void end(Films *films)
{
    spread_clear(&films->way);
    image_clear(&films->kept);
    image_clear(&films->spread);
    film_clear(&films->film);
    bright_film_clear(&films->bright);
}

enum { LARGE = 220, SAMPLES_OF_LARGE = 16 };

/* A large film, without samples. */
static inline void begin_empty(Films *films)
{
    Error error;
    assert_int_equal(film_init(&films->film, LARGE, LARGE, &error), STATUS_OK);
    assert_int_equal(bright_film_init(&films->bright, false, LARGE, LARGE, &error), STATUS_OK);
}

/* A large film, on which one thing is seen from its left border up to a column: each pixel as bright as is said. */
static inline void begin_large(Films *films, uint32_t columns, float (*light_of)(uint32_t x, uint32_t y))
{
    begin_empty(films);
    for (uint32_t y = 0; y < LARGE; y++)
        for (uint32_t x = 0; x < LARGE; x++)
            for (uint32_t i = 0; i < SAMPLES_OF_LARGE; i++) {
                float light = light_of(x, y);
                add(films, x, y, (float[]){light, light, light}, x < columns ? 1 : BRIGHT_NOTHING);
            }
}

static inline double gain_at(const Films *films, uint32_t x, uint32_t y)
{
    return films->way.pixels[y * LARGE + x].rgb[0];
}

#endif
