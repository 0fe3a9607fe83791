/* film.c - integer accumulators and what they mean.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/film.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/luminance.h"
#include "base/memory.h"
#include "render/pixel_noise.h"
#include "render/spread.h"

/* So wide that errors are known of rooms by moonlight as of a beach at noon, both in candelas per square metre. */
#define SQUARE_UNIT 0x1p-12
#define SQUARE_REST_UNIT 0x1p-44
#define LARGEST_SQUARE 0x1p49
/* Of sums, in their units: one more sample does not overflow. */
#define LARGEST_SUM (INT64_C(1) << 62)
/* A sample's alpha is held at 1 - this, or less than that. */
static const double most_open = 64;

Status film_init(Film *film, uint32_t width, uint32_t height, Error *error)
{
    *film =
        (Film){.width = width, .height = height, .pixels = memory_sparse((size_t)width * height, sizeof(FilmPixel))};
    if (!film->pixels) return fail_memory(error, (size_t)width * height * sizeof(FilmPixel), "the film");
    return STATUS_OK;
}

Status film_catch(Film *film, Error *error)
{
    size_t n = (size_t)film->width * film->height;
    film->caught = memory_sparse(n, sizeof *film->caught);
    return film->caught ? STATUS_OK : fail_memory(error, n * sizeof *film->caught, "what catches shadows");
}

void film_clear(Film *film)
{
    size_t n = (size_t)film->width * film->height;
    memory_sparse_free(film->pixels, n * sizeof *film->pixels);
    memory_sparse_free(film->caught, n * sizeof *film->caught);
    *film = (Film){0};
}

void film_forget_row(Film *film, uint32_t y)
{
    const size_t begin = (size_t)y * film->width;
    memset(&film->pixels[begin], 0, film->width * sizeof *film->pixels);
    if (film->caught) memset(&film->caught[begin], 0, film->width * sizeof *film->caught);
}

void film_count_samples(const Film *film, uint32_t *least, uint32_t *most, uint64_t *sum)
{
    const size_t n_pixels = (size_t)film->width * film->height;
    *least = UINT32_MAX;
    *most = 0;
    *sum = 0;
    for (size_t i = 0; i < n_pixels; i++) {
        const uint32_t n = film->pixels[i].n;
        if (n < *least) *least = n;
        if (n > *most) *most = n;
        *sum += n;
    }
}

static double held(double value, double largest, bool *saturated)
{
    if (fabs(value) <= largest) return value;
    *saturated = true;
    return value > 0 ? largest : -largest;
}

/* Of light, which is positive, the sum is then the same in any order. */
static bool hold_sum(int64_t *sum)
{
    const int64_t value = *sum;
    if (LIKELY(value > -LARGEST_SUM && value < LARGEST_SUM)) return false;
    *sum = value > 0 ? LARGEST_SUM - 1 : 1 - LARGEST_SUM;
    return true;
}

/* The same of squares, with what is left of them. rest: what it is, which may be more than a whole unit. */
static void set_squares(FilmPixel *pixel, int64_t squares, uint64_t rest)
{
    squares += (int64_t)(rest >> 32);
    bool fits = squares < LARGEST_SUM - 1;
    pixel->squares = fits ? squares : LARGEST_SUM - 1;
    pixel->squares_rest = fits ? (uint32_t)rest : 0;
}

static void add_square(FilmPixel *pixel, double square)
{
    if (square > LARGEST_SQUARE) square = LARGEST_SQUARE; /* only the estimate of the noise suffers */
    double units = floor(square / SQUARE_UNIT);
    uint64_t rest = (uint64_t)llrint((square - units * SQUARE_UNIT) / SQUARE_REST_UNIT);
    set_squares(pixel, pixel->squares + (int64_t)units, pixel->squares_rest + rest);
}

/* Before sample number 2^k. */
static void mark(FilmPixel *pixel)
{
    for (int i = FILM_LADDER; i > 0; i--) pixel->before[i] = pixel->before[i - 1];
    pixel->before[0] = pixel->luminance;
    memcpy(pixel->first_rgb, pixel->rgb, sizeof pixel->first_rgb);
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
    double y_value = luminance_of(value[0], value[1], value[2]);
    uint32_t number = film->first_sample + pixel->n;
    if ((number & (number - 1)) == 0 && number) mark(pixel);
    pixel->luminance += llrint(y_value / FILM_UNIT);
    add_square(pixel, y_value * y_value);
    for (int i = 0; i < 3; i++) saturated |= hold_sum(&pixel->rgb[i]);
    (void)hold_sum(&pixel->luminance);
    pixel->alpha += llrint(fmin(fmax((double)alpha, 1 - most_open), 1) / FILM_UNIT);
    pixel->n++;
    return saturated;
}

static void add_held(int64_t *sum, float value)
{
    bool saturated = false; /* film_add has told */
    *sum += llrint(held((double)value, FILM_LARGEST, &saturated) / FILM_UNIT);
    (void)hold_sum(sum);
}

void film_add_caught(Film *film, uint32_t x, uint32_t y, const float lit[3], const float bare[3], float part)
{
    FilmCaught *caught = &film->caught[(size_t)y * film->width + x];
    for (int i = 0; i < 3; i++) {
        add_held(&caught->lit[i], lit[i]);
        add_held(&caught->bare[i], bare[i]);
    }
    caught->part += llrint(fmin((double)part, most_open) / FILM_UNIT);
}

void film_luminance(const FilmPixel *pixel, double *mean, double *standard_error)
{
    *mean = 0;
    *standard_error = -1;
    if (!pixel->n) return;
    double n = pixel->n;
    *mean = (double)pixel->luminance * FILM_UNIT / n;
    if (pixel->n < 2) return;
    double squares = (double)pixel->squares * SQUARE_UNIT + pixel->squares_rest * SQUARE_REST_UNIT;
    double variance = (squares / n - *mean * *mean) * n / (n - 1);
    *standard_error = sqrt(fmax(variance, 0) / n);
}

float film_alpha(const FilmPixel *pixel)
{
    return pixel->n ? (float)fmax((double)pixel->alpha * FILM_UNIT / pixel->n, 0) : 0;
}

uint32_t film_first_part(uint32_t n)
{
    uint32_t first = 1;
    while (first < n - first) first *= 2;
    return first;
}

double film_spread(const FilmPixel *pixel)
{
    if (pixel->n < 2) return -1;
    uint32_t n_first = film_first_part(pixel->n);
    double n = pixel->n, n_rest = n - n_first, first = (double)pixel->before[0],
           rest = (double)pixel->luminance - first;
    return fabs(first / n_first - rest / n_rest) * FILM_UNIT / sqrt(1 / (double)n_first + 1 / n_rest);
}

void film_ladder(const FilmPixel *pixel, float ladder[FILM_LADDER])
{
    bool whole = pixel->n && (pixel->n & (pixel->n - 1)) == 0;
    uint32_t n = whole || pixel->n < 2 ? pixel->n : film_first_part(pixel->n);
    for (int i = 0; i < FILM_LADDER; i++, n /= 2) {
        int64_t twice = whole ? i ? pixel->before[i - 1] : pixel->luminance : pixel->before[i];
        int64_t once = pixel->before[whole ? i : i + 1];
        ladder[i] =
            n < 2 ? 0 : sqrtf((float)FILM_UNIT * 2 * fabsf((float)(2 * (double)once - (double)twice)) / (float)n);
    }
}

void film_squared_errors(const Film *film, uint32_t x, uint32_t y, float squared[4])
{
    const FilmPixel *pixel = film_pixel(film, x, y);
    uint32_t end = film->first_sample + pixel->n, middle = film_first_part(end);
    bool halves = middle > film->first_sample && middle < end;
    double n = pixel->n, n_first = halves ? middle - film->first_sample : 0, n_rest = n - n_first, difference[4];
    for (int i = 0; i < 3; i++) {
        double first = (double)pixel->first_rgb[i], rest = (double)pixel->rgb[i] - first;
        difference[i] = halves ? (first / n_first - rest / n_rest) * FILM_UNIT : 0;
    }
    difference[3] = luminance_of(difference[0], difference[1], difference[2]);
    for (int i = 0; i < 4; i++) squared[i] = (float)(difference[i] * difference[i] * n_first * n_rest / fmax(n * n, 1));
}

/* ---- as bytes ---- */

/* No bytes are between its members. */
_Static_assert(sizeof(FilmPixel) == 8 * (11 + FILM_LADDER) + 8, "the pixels of a film as bytes");
_Static_assert(sizeof(FilmCaught) == 8 * 7, "what is caught as bytes");

void film_save_row(const Film *film, uint32_t y, Buf *out)
{
    const size_t begin = (size_t)y * film->width;
    buf_add_bytes(out, (const char *)&film->pixels[begin], film->width * sizeof(FilmPixel));
    if (film->caught) buf_add_bytes(out, (const char *)&film->caught[begin], film->width * sizeof(FilmCaught));
}

static bool is_within(int64_t sum, double largest)
{
    return sum < LARGEST_SUM && sum > -LARGEST_SUM && fabs((double)sum) <= largest;
}

static bool can_be(const FilmPixel *pixel)
{
    double most = pixel->n * (FILM_LARGEST / FILM_UNIT + 1);
    bool good = pixel->n <= FILM_MOST_SAMPLES && is_within(pixel->alpha, pixel->n * most_open / FILM_UNIT) &&
                is_within(pixel->luminance, most) && pixel->squares >= 0 &&
                is_within(pixel->squares, pixel->n * (LARGEST_SQUARE / SQUARE_UNIT + 1));
    for (int i = 0; i < 3; i++) good = good && is_within(pixel->rgb[i], most) && is_within(pixel->first_rgb[i], most);
    for (int i = 0; i <= FILM_LADDER; i++) good = good && is_within(pixel->before[i], most);
    return good;
}

static bool can_be_caught(const FilmCaught *caught, uint32_t n)
{
    double most = n * (FILM_LARGEST / FILM_UNIT + 1);
    bool good = caught->part >= 0 && is_within(caught->part, n * most_open / FILM_UNIT);
    for (int i = 0; i < 3; i++) good = good && is_within(caught->lit[i], most) && is_within(caught->bare[i], most);
    return good;
}

bool film_load_row(Film *film, uint32_t y, BufReader *in)
{
    FilmPixel *row = &film->pixels[(size_t)y * film->width];
    bool good = buf_take(in, row, film->width * sizeof *row);
    for (uint32_t x = 0; good && x < film->width; x++) good = can_be(&row[x]);
    if (!good || !film->caught) return good;
    FilmCaught *caught = &film->caught[(size_t)y * film->width];
    good = buf_take(in, caught, film->width * sizeof *caught);
    for (uint32_t x = 0; good && x < film->width; x++) good = can_be_caught(&caught[x], row[x].n);
    return good;
}

/* Neither is beyond the limit. */
static int64_t add(int64_t a, int64_t b)
{
    int64_t sum = a + b;
    (void)hold_sum(&sum);
    return sum;
}

void film_join(FilmPixel *pixel, const FilmPixel *next, uint32_t from)
{
    FilmPixel sum = *pixel;
    uint32_t power = film_first_part(from + next->n);
    for (int i = 0, own = 0; i <= FILM_LADDER; i++, power /= 2) {
        if (power >= from)
            sum.before[i] = add(pixel->luminance, next->before[i]);
        else
            sum.before[i] = power ? pixel->before[own++] : 0;
    }
    bool first_ends_in_next = film_first_part(from + next->n) >= from;
    for (int i = 0; i < 3; i++) {
        sum.rgb[i] = add(pixel->rgb[i], next->rgb[i]);
        if (first_ends_in_next) sum.first_rgb[i] = add(pixel->rgb[i], next->first_rgb[i]);
    }
    set_squares(&sum, pixel->squares + next->squares, (uint64_t)pixel->squares_rest + next->squares_rest);
    sum.luminance = add(sum.luminance, next->luminance);
    sum.alpha += next->alpha;
    sum.n += next->n;
    sum.rays += next->rays;
    *pixel = sum;
}

void film_join_caught(FilmCaught *caught, const FilmCaught *next)
{
    for (int i = 0; i < 3; i++) {
        caught->lit[i] = add(caught->lit[i], next->lit[i]);
        caught->bare[i] = add(caught->bare[i], next->bare[i]);
    }
    caught->part += next->part;
}

typedef struct Resolve {
    const Film *film;
    float *noise; /* of each pixel */
    Image *image;
} Resolve;

/* Of samples that heed no other. */
static void independent_noise_of_row(void *context, uint32_t y, unsigned worker)
{
    const Resolve *resolve = context;
    (void)worker;
    for (uint32_t x = 0; x < resolve->film->width; x++) {
        double mean, standard_error;
        film_luminance(film_pixel(resolve->film, x, y), &mean, &standard_error);
        resolve->noise[(size_t)y * resolve->film->width + x] = (float)fmax(standard_error, 0);
    }
}

static void resolve_row(void *context, uint32_t y, unsigned worker)
{
    const Resolve *resolve = context;
    (void)worker;
    for (uint32_t x = 0; x < resolve->film->width; x++) {
        const FilmPixel *pixel = film_pixel(resolve->film, x, y);
        float *out = image_at(resolve->image, x, y);
        double scale = pixel->n ? 1.0 / pixel->n : 0;
        for (int c = 0; c < 3; c++) out[c] = (float)((double)pixel->rgb[c] * FILM_UNIT * scale);
        out[3] = film_alpha(pixel);
        out[4] = resolve->noise[(size_t)y * resolve->film->width + x];
    }
}

Status film_resolve(const Film *film, const Spread *spread, Pool *pool, Image *image, Error *error)
{
    static const char *const names[] = {"R", "G", "B", "A", "noise.Y"};
    float *noise = malloc((size_t)film->width * film->height * sizeof *noise);
    if (!noise)
        return fail_memory(error, (size_t)film->width * film->height * sizeof *noise, "the noise of the picture");
    Resolve resolve = {film, noise, image};
    Status status = STATUS_OK;
    if (film->first_sample)
        pool_run(pool, film->height, independent_noise_of_row, &resolve);
    else
        status = pixel_noise(film, spread, pool, noise, error);
    if (status == STATUS_OK) status = image_new(film->width, film->height, names, COUNT_OF(names), image, error);
    if (status == STATUS_OK) pool_run(pool, film->height, resolve_row, &resolve);
    free(noise);
    if (status == STATUS_OK && spread) spread_apply(spread, image);
    return status;
}
