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

/* Of the pixels that are rendered: what is beyond a crop is no neighbour. */
typedef struct Noise {
    const Film *film;
    const Evenness *evenness;
    uint32_t area[4], width, height; /* x0, y0, x1, y1 */
    size_t n;
    float *maps[MAPS];
    float *errors; /* of the film's pixels */
    Pool *pool;
} Noise;

/* false: no pixel has two samples */
static bool find_area(Noise *noise, const Film *film)
{
    *noise = (Noise){.film = film, .area = {film->width, film->height, 0, 0}};
    bool any = false;
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) {
            uint32_t n = film_pixel(film, x, y)->n;
            if (n == 0) continue;
            any = any || n > 1;
            if (x < noise->area[0]) noise->area[0] = x;
            if (y < noise->area[1]) noise->area[1] = y;
            if (x >= noise->area[2]) noise->area[2] = x + 1;
            noise->area[3] = y + 1;
        }
    if (!any) return false;
    noise->width = noise->area[2] - noise->area[0];
    noise->height = noise->area[3] - noise->area[1];
    noise->n = (size_t)noise->width * noise->height;
    return true;
}

static const FilmPixel *pixel_of(const Noise *noise, uint32_t x, uint32_t y)
{
    return film_pixel(noise->film, noise->area[0] + x, noise->area[1] + y);
}

static void ask_around(Noise *noise, int of, uint32_t radius, int answer)
{
    mean_around(noise->maps[of], noise->width, noise->height, radius, noise->maps[SCRATCH], noise->maps[answer],
                noise->pool);
}

/* What is done for each row of the area. */
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
        const FilmPixel *pixel = pixel_of(noise, x, y);
        double mean, of_samples, half = 0;
        film_luminance(pixel, &mean, &of_samples);
        noise->maps[VARIANCE][i] = of_samples > 0 ? (float)(of_samples * of_samples * pixel->n) : 0;
        if (of_samples > 0)
            half = film_spread(pixel) *
                   evenness_of_square(noise->evenness, noise->area[0] + x, noise->area[1] + y, pixel->n);
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
    size_t from = 0;
    for (uint32_t y = spread->area[1]; y < spread->area[3]; y++)
        for (uint32_t x = spread->area[0]; x < spread->area[2]; x++) {
            const SpreadPixel *moved = &spread->pixels[from++];
            if (x < noise->area[0] || x >= noise->area[2] || y < noise->area[1] || y >= noise->area[3]) continue;
            float *variance =
                &noise->maps[VARIANCE][(size_t)(y - noise->area[1]) * noise->width + (x - noise->area[0])];
            double left = (double)*variance * fmax(1 - moved->taken, 0);
            *variance = (float)(left + moved->given * film_pixel(noise->film, x, y)->n);
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
        const FilmPixel *pixel = pixel_of(noise, x, y);
        if (pixel->n > 1) noise->errors[pixel - noise->film->pixels] = sqrtf(fmaxf(square, 0) / (float)pixel->n);
    }
}

Status pixel_noise(const Film *film, const Spread *spread, Pool *pool, float *errors, Error *error)
{
    Noise noise;
    Evenness evenness;
    memset(errors, 0, (size_t)film->width * film->height * sizeof *errors);
    if (!find_area(&noise, film)) return STATUS_OK;
    noise.errors = errors;
    noise.pool = pool;
    TRY(evenness_init(&evenness, film, noise.area, pool, error));
    noise.evenness = &evenness;
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
