/* film.c - integer accumulators and what they mean.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/film.h"

#include <math.h>
#include <stdlib.h>

#define SQUARE_UNIT 0x1p-20
#define LARGEST_SQUARE 0x1p28

Status film_init(Film *film, uint32_t width, uint32_t height, Error *error)
{
    *film = (Film){width, height, calloc((size_t)width * height, sizeof(FilmPixel))};
    if (!film->pixels)
        return fail_memory(error, (size_t)width * height * sizeof(FilmPixel), "the film");
    return STATUS_OK;
}

void film_clear(Film *film)
{
    free(film->pixels);
    *film = (Film){0};
}

static double held(double value, double largest, bool *saturated)
{
    if (fabs(value) <= largest) return value;
    *saturated = true;
    return value > 0 ? largest : -largest;
}

static double luminance(const double rgb[3])
{
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

bool film_add(Film *film, uint32_t x, uint32_t y, const float rgb[3], float alpha)
{
    FilmPixel *pixel = &film->pixels[(size_t)y * film->width + x];
    bool saturated = false;
    double value[3];
    for (int i = 0; i < 3; i++) {
        value[i] = held((double)rgb[i], FILM_LARGEST, &saturated);
        pixel->rgb[i] += llrint(value[i] / FILM_UNIT);
    }
    double y_value = luminance(value);
    bool square_held = false; /* only the estimate of the noise suffers */
    pixel->squares += llrint(held(y_value * y_value, LARGEST_SQUARE, &square_held) / SQUARE_UNIT);
    pixel->alpha += alpha > 0.5f;
    pixel->n++;
    return saturated;
}

void film_luminance(const FilmPixel *pixel, double *mean, double *standard_error)
{
    *mean = 0;
    *standard_error = -1;
    if (!pixel->n) return;
    double n = pixel->n;
    double sum[3] = {(double)pixel->rgb[0] * FILM_UNIT, (double)pixel->rgb[1] * FILM_UNIT, (double)pixel->rgb[2] * FILM_UNIT};
    *mean = luminance(sum) / n;
    if (pixel->n < 2) return;
    double variance = ((double)pixel->squares * SQUARE_UNIT / n - *mean * *mean) * n / (n - 1);
    *standard_error = sqrt(fmax(variance, 0) / n);
}

double film_noise(const Film *film, const uint32_t crop[4])
{
    double sum = 0;
    uint64_t n = 0;
    for (uint32_t y = crop[1]; y < crop[3]; y++)
        for (uint32_t x = crop[0]; x < crop[2]; x++) {
            double mean, error;
            film_luminance(&film->pixels[(size_t)y * film->width + x], &mean, &error);
            if (error < 0) return -1;
            sum += error / (fabs(mean) + 0.01);
            n++;
        }
    return n ? sum / (double)n : -1;
}

Status film_resolve(const Film *film, Image *image, Error *error)
{
    static const char *const names[] = {"R", "G", "B", "A", "noise.Y"};
    TRY(image_new(film->width, film->height, names, COUNT_OF(names), image, error));
    size_t n = (size_t)film->width * film->height;
    for (size_t i = 0; i < n; i++) {
        const FilmPixel *pixel = &film->pixels[i];
        float *out = image->pixels + i * COUNT_OF(names);
        double scale = pixel->n ? 1.0 / pixel->n : 0, mean, standard_error;
        for (int c = 0; c < 3; c++) out[c] = (float)((double)pixel->rgb[c] * FILM_UNIT * scale);
        out[3] = (float)(pixel->alpha * scale);
        film_luminance(pixel, &mean, &standard_error);
        out[4] = (float)fmax(standard_error, 0);
    }
    return STATUS_OK;
}
