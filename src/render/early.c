/* early.c - pixels without samples between those that have some.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/early.h"

#include "render/caught.h"

enum { CHANNELS = 4 };

static void put_mean(const Film *film, uint32_t x, uint32_t y, float out[CHANNELS])
{
    const FilmPixel *pixel = film_pixel(film, x, y);
    double scale = 1.0 / pixel->n;
    for (int c = 0; c < 3; c++) out[c] = (float)((double)pixel->rgb[c] * FILM_UNIT * scale);
    out[3] = film_alpha(pixel);
    caught_take_pixel(film, x, y, out);
}

/* Weights fall linearly with the distance from the lattice's pixels. */
static void put_between(const Film *film, uint32_t step, uint32_t x, uint32_t y, float out[CHANNELS])
{
    uint32_t left = x - x % step, top = y - y % step;
    float sum = 0;
    for (uint32_t corner = 0; corner < 4; corner++) {
        uint32_t u = left + (corner & 1) * step, v = top + (corner >> 1) * step;
        if (u >= film->width || v >= film->height || !film_pixel(film, u, v)->n) continue;
        uint32_t across = corner & 1 ? x - left : step - (x - left), down = corner >> 1 ? y - top : step - (y - top);
        float weight = (float)(across * down), mean[CHANNELS];
        put_mean(film, u, v, mean);
        for (int c = 0; c < CHANNELS; c++) out[c] += weight * mean[c];
        sum += weight;
    }
    for (int c = 0; c < CHANNELS && sum > 0; c++) out[c] /= sum;
}

static bool has_lattice(const Film *film, uint32_t step)
{
    for (uint32_t y = 0; y < film->height; y += step)
        for (uint32_t x = 0; x < film->width; x += step)
            if (!film_pixel(film, x, y)->n) return false;
    return true;
}

uint32_t early_step(const Film *film)
{
    for (uint32_t step = 1; step <= EARLY_COARSEST; step *= 2)
        if (has_lattice(film, step)) return step;
    return 0;
}

void early_fill(const Film *film, uint32_t step, Image *image)
{
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            if (!film_pixel(film, x, y)->n) put_between(film, step, x, y, image_at(image, x, y));
}

Status early_resolve(const Film *film, uint32_t step, Image *image, Error *error)
{
    static const char *const names[CHANNELS] = {"R", "G", "B", "A"};
    TRY(image_new(film->width, film->height, names, CHANNELS, image, error));
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++)
            if (film_pixel(film, x, y)->n)
                put_mean(film, x, y, image->pixels + ((size_t)y * image->width + x) * CHANNELS);
    early_fill(film, step, image);
    return STATUS_OK;
}
