/* pixel_noise.c - variances of neighbourhoods, and what evenness leaves of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/pixel_noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/around.h"
#include "render/evenness.h"

/* How far neighbours are asked, in pixels: for the variance of samples, and for what evenness leaves of it. */
enum { NEAR = 3, FAR = 12 };
/* Of fewer pixels nobody can tell what evenness leaves: their samples are taken as independent, which states too much. */
enum { FEWEST_TO_ASK = 100 };

/* Of all pixels: the variance of samples; what evenness leaves of it; half the square of the difference of variances from
 * those of pixels that touch; the square of the variance; and what is needed on the way. */
enum { VARIANCE, EVENNESS, JUMP, SQUARE, OWN, SCRATCH, MAPS };

typedef struct Noise {
    const Film *film;
    const Evenness *evenness;
    uint32_t width, height;
    size_t n;
    float *maps[MAPS];
    float *errors; /* of the film's pixels */
    Pool *pool;
} Noise;

static bool has_two_samples(const Film *film)
{
    uint32_t least, most;
    uint64_t sum;
    film_count_samples(film, &least, &most, &sum);
    return most > 1;
}

static void ask_around(Noise *noise, int of, uint32_t radius, int answer)
{
    mean_around(noise->maps[of], noise->width, noise->height, radius, noise->maps[SCRATCH], noise->maps[answer],
                noise->pool);
}

/* What is done for each row. */
typedef void Row(void *noise, uint32_t y, unsigned worker);
static void for_rows(Noise *noise, Row *row)
{
    pool_run(noise->pool, noise->height, row, noise);
}

static void read_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    size_t i = (size_t)y * noise->width;
    for (uint32_t x = 0; x < noise->width; x++, i++) {
        const FilmPixel *pixel = film_pixel(noise->film, x, y);
        double mean, of_samples, half = 0;
        film_luminance(pixel, &mean, &of_samples);
        noise->maps[VARIANCE][i] = of_samples > 0 ? (float)(of_samples * of_samples * pixel->n) : 0;
        if (of_samples > 0) half = film_spread(pixel) * evenness_of_square(noise->evenness, x, y, pixel->n);
        noise->maps[OWN][i] = (float)(half * half);
    }
}

static void compare_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    float *even = noise->maps[EVENNESS];
    const float *variance = noise->maps[OWN];
    bool few = noise->n < FEWEST_TO_ASK;
    for (size_t i = (size_t)y * noise->width, end = i + noise->width; i < end; i++)
        even[i] = variance[i] > 0 && !few ? even[i] / variance[i] : 1;
}

static void ask_samples(Noise *noise)
{
    for_rows(noise, read_row);
    ask_around(noise, OWN, FAR, EVENNESS);
    ask_around(noise, VARIANCE, FAR, OWN);
    for_rows(noise, compare_row);
}

/* What has left a pixel with the samples that it gave away, and what came. */
static void move_variance(Noise *noise, const Spread *spread)
{
    for (size_t i = 0; i < noise->n; i++) {
        const SpreadPixel *moved = &spread->pixels[i];
        float *variance = &noise->maps[VARIANCE][i];
        double left = (double)*variance * fmax(1 - moved->taken, 0);
        *variance = (float)(left + moved->given * noise->film->pixels[i].n);
    }
}

static float jump_at(const float *map, uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    const float *here = map + (size_t)y * width + x;
    const bool there[] = {x > 0, x + 1 < width, y > 0, y + 1 < height};
    const ptrdiff_t step[] = {-1, 1, -(ptrdiff_t)width, (ptrdiff_t)width};
    float sum = 0, n = 0;
    for (size_t i = 0; i < COUNT_OF(step); i++) {
        if (!there[i]) continue;
        sum += (here[step[i]] - *here) * (here[step[i]] - *here);
        n++;
    }
    return n > 0 ? sum / (2 * n) : 0;
}

static void find_jumps_of_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    float *jump = noise->maps[OWN] + (size_t)y * noise->width;
    for (uint32_t x = 0; x < noise->width; x++)
        jump[x] = jump_at(noise->maps[VARIANCE], noise->width, noise->height, x, y);
}

static void square_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    const float *variance = noise->maps[VARIANCE];
    for (size_t i = (size_t)y * noise->width, end = i + noise->width; i < end; i++)
        noise->maps[OWN][i] = variance[i] * variance[i];
}

static void believe_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    float *variance = noise->maps[VARIANCE];
    for (size_t i = (size_t)y * noise->width, end = i + noise->width; i < end; i++) {
        float mean = noise->maps[OWN][i], spread = noise->maps[SQUARE][i] - mean * mean;
        float believed = spread > 0 ? fminf(fmaxf(1 - noise->maps[JUMP][i] / spread, 0), 1) : 0;
        variance[i] = mean + believed * (variance[i] - mean);
    }
}

static void ask_neighbours(Noise *noise)
{
    for_rows(noise, find_jumps_of_row);
    ask_around(noise, OWN, NEAR, JUMP);
    for_rows(noise, square_row);
    ask_around(noise, OWN, NEAR, SQUARE);
    ask_around(noise, VARIANCE, NEAR, OWN);
    for_rows(noise, believe_row);
}

static void state_row(void *context, uint32_t y, unsigned worker)
{
    const Noise *noise = context;
    (void)worker;
    size_t i = (size_t)y * noise->width;
    for (uint32_t x = 0; x < noise->width; x++, i++) {
        float square = noise->maps[VARIANCE][i] * noise->maps[EVENNESS][i];
        const FilmPixel *pixel = film_pixel(noise->film, x, y);
        if (pixel->n > 1) noise->errors[i] = sqrtf(fmaxf(square, 0) / (float)pixel->n);
    }
}

Status pixel_noise(const Film *film, const Spread *spread, Pool *pool, float *errors, Error *error)
{
    Evenness evenness;
    Noise noise = {.film = film,
                   .evenness = &evenness,
                   .width = film->width,
                   .height = film->height,
                   .n = (size_t)film->width * film->height,
                   .errors = errors,
                   .pool = pool};
    memset(errors, 0, noise.n * sizeof *errors);
    if (!has_two_samples(film)) return STATUS_OK;
    TRY(evenness_init(&evenness, film, pool, error));
    float *maps = malloc(MAPS * noise.n * sizeof *maps);
    if (maps) {
        for (int i = 0; i < MAPS; i++) noise.maps[i] = maps + (size_t)i * noise.n;
        ask_samples(&noise);
        if (spread) move_variance(&noise, spread);
        ask_neighbours(&noise);
        for_rows(&noise, state_row);
    }
    evenness_clear(&evenness);
    free(maps);
    return maps ? STATUS_OK : fail_memory(error, MAPS * noise.n * sizeof *maps, "the errors of pixels");
}
