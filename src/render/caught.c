/* caught.c - what is left of a picture behind a shadow catcher, and what comes to it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/caught.h"

#include <math.h>

/* A channel in which the bare surface has less than this part of its brightest is noise, or out of the working space's
 * colours: under a red lamp green says nothing of a shadow. */
#define LEAST_PART (1 / 256.0f)

/* What part of a picture behind is left. Where there is no light, none is taken away. */
static float part_left(const float caught[CAUGHT_CHANNELS])
{
    const float *lit = caught + CAUGHT_LIT, *bare = caught + CAUGHT_BARE;
    float most = fmaxf(bare[0], fmaxf(bare[1], bare[2])), left = 1;
    if (!(most > 0)) return 1;
    for (int i = 0; i < 3; i++)
        if (bare[i] >= LEAST_PART * most) left = fminf(left, lit[i] / bare[i]);
    return fmaxf(left, 0);
}

void caught_take(const float caught[CAUGHT_CHANNELS], float part, float rgba[4])
{
    float left = part_left(caught);
    for (int i = 0; i < 3; i++) rgba[i] -= left * caught[CAUGHT_BARE + i];
    rgba[3] = fmaxf(rgba[3] - left * part, 0);
}

static float mean_of(int64_t sum, uint32_t n)
{
    return (float)((double)sum * FILM_UNIT * (1.0 / n));
}

static void means_of(const FilmCaught *caught, uint32_t n, float means[CAUGHT_CHANNELS])
{
    for (int i = 0; i < 3; i++) {
        means[CAUGHT_LIT + i] = mean_of(caught->lit[i], n);
        means[CAUGHT_BARE + i] = mean_of(caught->bare[i], n);
    }
}

void caught_take_pixel(const Film *film, uint32_t x, uint32_t y, float rgba[4])
{
    uint32_t n = film_pixel(film, x, y)->n;
    float means[CAUGHT_CHANNELS];
    if (!film->caught || !n) return;
    const FilmCaught *caught = &film->caught[(size_t)y * film->width + x];
    means_of(caught, n, means);
    caught_take(means, mean_of(caught->part, n), rgba);
}

Status caught_means(const Film *film, const Image *image, Image *means, Error *error)
{
    static const char *const names[CAUGHT_CHANNELS] = {"lit.R", "lit.G", "lit.B", "bare.R", "bare.G", "bare.B"};
    TRY(image_new(film->width, film->height, names, CAUGHT_CHANNELS, means, error));
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) {
            const FilmPixel *pixel = film_pixel(film, x, y);
            const FilmCaught *caught = &film->caught[(size_t)y * film->width + x];
            float *out = image_at(means, x, y);
            if (!pixel->n) continue;
            means_of(caught, pixel->n, out);
            float part = fminf(mean_of(caught->part, pixel->n), 1);
            for (int i = 0; i < 3; i++)
                out[CAUGHT_LIT + i] += part * (image_at(image, x, y)[i] - mean_of(pixel->rgb[i], pixel->n));
        }
    return STATUS_OK;
}

void caught_take_all(const Film *film, const Image *means, Image *image)
{
    for (uint32_t y = 0; y < film->height; y++)
        for (uint32_t x = 0; x < film->width; x++) {
            uint32_t n = film_pixel(film, x, y)->n;
            if (n)
                caught_take(image_at(means, x, y), mean_of(film->caught[(size_t)y * film->width + x].part, n),
                            image_at(image, x, y));
        }
}
