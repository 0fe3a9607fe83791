/* pixel_noise.c - variances of neighbourhoods, and what evenness leaves of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/pixel_noise.h"

#include <math.h>
#include <stdlib.h>

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
    uint32_t area[4], width, height; /* x0, y0, x1, y1 */
    size_t n;
    float *maps[MAPS];
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

static const FilmPixel *pixel_of(const Noise *noise, size_t i)
{
    return film_pixel(noise->film, noise->area[0] + (uint32_t)(i % noise->width),
                      noise->area[1] + (uint32_t)(i / noise->width));
}

static void ask_around(Noise *noise, int of, uint32_t radius, int answer)
{
    mean_around(noise->maps[of], noise->width, noise->height, radius, noise->maps[SCRATCH], noise->maps[answer]);
}

static void ask_samples(Noise *noise, const Evenness *evenness)
{
    float *variance = noise->maps[VARIANCE], *halves = noise->maps[OWN], *even = noise->maps[EVENNESS];
    for (size_t i = 0; i < noise->n; i++) {
        const FilmPixel *pixel = pixel_of(noise, i);
        uint32_t x = noise->area[0] + (uint32_t)(i % noise->width), y = noise->area[1] + (uint32_t)(i / noise->width);
        double mean, of_samples;
        film_luminance(pixel, &mean, &of_samples);
        variance[i] = of_samples > 0 ? (float)(of_samples * of_samples * pixel->n) : 0;
        double half = of_samples > 0 ? film_spread(pixel) * evenness_of_square(evenness, x, y, pixel->n) : 0;
        halves[i] = (float)(half * half);
    }
    ask_around(noise, OWN, FAR, EVENNESS);
    ask_around(noise, VARIANCE, FAR, OWN);
    bool few = noise->n < FEWEST_TO_ASK;
    for (size_t i = 0; i < noise->n; i++) even[i] = noise->maps[OWN][i] > 0 && !few ? even[i] / noise->maps[OWN][i] : 1;
}

/* What has left a pixel with the samples that it gave away, and what came. */
static void move_variance(Noise *noise, const Spread *spread)
{
    size_t from = 0;
    for (uint32_t y = spread->area[1]; y < spread->area[3]; y++)
        for (uint32_t x = spread->area[0]; x < spread->area[2]; x++) {
            const SpreadPixel *moved = &spread->pixels[from++];
            if (x < noise->area[0] || x >= noise->area[2] || y < noise->area[1] || y >= noise->area[3]) continue;
            size_t i = (size_t)(y - noise->area[1]) * noise->width + (x - noise->area[0]);
            double left = (double)noise->maps[VARIANCE][i] * fmax(1 - moved->taken, 0);
            noise->maps[VARIANCE][i] = (float)(left + moved->given * pixel_of(noise, i)->n);
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

static void ask_neighbours(Noise *noise)
{
    uint32_t width = noise->width, height = noise->height;
    float *variance = noise->maps[VARIANCE], *own = noise->maps[OWN];
    for (size_t i = 0; i < noise->n; i++)
        own[i] = jump_at(variance, width, height, (uint32_t)(i % width), (uint32_t)(i / width));
    ask_around(noise, OWN, NEAR, JUMP);
    for (size_t i = 0; i < noise->n; i++) own[i] = variance[i] * variance[i];
    ask_around(noise, OWN, NEAR, SQUARE);
    ask_around(noise, VARIANCE, NEAR, OWN);
    for (size_t i = 0; i < noise->n; i++) {
        float mean = own[i], spread = noise->maps[SQUARE][i] - mean * mean;
        float believed = spread > 0 ? fminf(fmaxf(1 - noise->maps[JUMP][i] / spread, 0), 1) : 0;
        variance[i] = mean + believed * (variance[i] - mean);
    }
}

Status pixel_noise(const Film *film, const Spread *spread, float *errors, Error *error)
{
    Noise noise;
    Evenness evenness;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) errors[i] = 0;
    if (!find_area(&noise, film)) return STATUS_OK;
    TRY(evenness_init(&evenness, film, noise.area, error));
    float *maps = malloc(MAPS * noise.n * sizeof *maps);
    if (maps) {
        for (int i = 0; i < MAPS; i++) noise.maps[i] = maps + (size_t)i * noise.n;
        ask_samples(&noise, &evenness);
        if (spread) move_variance(&noise, spread);
        ask_neighbours(&noise);
        for (size_t i = 0; i < noise.n; i++) {
            float square = noise.maps[VARIANCE][i] * noise.maps[EVENNESS][i];
            const FilmPixel *pixel = pixel_of(&noise, i);
            errors[pixel - film->pixels] = pixel->n > 1 ? sqrtf(fmaxf(square, 0) / (float)pixel->n) : 0;
        }
    }
    evenness_clear(&evenness);
    free(maps);
    return maps ? STATUS_OK : fail_memory(error, MAPS * noise.n * sizeof *maps, "the errors of pixels");
}
