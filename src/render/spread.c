/* spread.c - which samples stand alone, and where they go.
 * First it is found for each row of pixels, by whichever thread, where its samples go; then each band of rows takes what is
 * for it, in the order of the rows that it comes from: the same sums for any number of threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/spread.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "render/around.h"
#include "render/spread_maps.h"

/* What a sample adds to its pixel, over what is there without, that is not to be seen yet. */
#define STANDS_OUT 0.2
/* Pixels around, for what is usual there, for what is found, twice over, and for which colour. */
enum { AROUND = 2, BESIDE = 1, COLORS_AROUND = 8 };
/* A pixel is a hole by what it has less than this one of those next to it, counted from the darkest: holes may be two or three
 * in a row, and what is beside an edge is none. */
enum { HOLE_RANK = 3 };
/* What samples say of the reflectance is believed where around a pixel this part of them do; of fewer in proportion. */
#define TOLD_PART 0.25f
/* Rows that a thread gathers at a time. */
enum { BAND = 16 };

/* Of what comes to pixels in each channel, the part that is to be added so that as much comes as goes. */
typedef struct Settlement {
    const Maps *maps;
    double missing[3];
} Settlement;

/* The pixel's samples of its seen-th thing that are as bright, as far as they are kept. */
static uint32_t count_comparable(const BrightPixel *pixel, uint32_t seen, float least)
{
    uint32_t n = 0;
    if (seen == BRIGHT_THINGS) return 0;
    for (int i = 0; i < BRIGHT_KEPT && bright_light(pixel->rgb[i]) >= least; i++) n += bright_seen(pixel, i) == seen;
    return n;
}

static bool has_few_alike(const BrightPixel *pixel, int i, uint32_t n_samples)
{
    float light = bright_light(pixel->rgb[i]);
    uint32_t seen = bright_seen(pixel, i);
    return light > 0 && seen < BRIGHT_THINGS && count_comparable(pixel, seen, light * ALIKE) < few_of(n_samples);
}

/* Whether no sample of a pixel has few alike, by a quick look: false where a close one is needed. */
static bool is_plain(const BrightPixel *pixel, uint32_t n_samples)
{
    uint32_t few = few_of(n_samples);
    return few == 0 || (!pixel->counts[1] && pixel->counts[0] >= few &&
                        bright_light(pixel->rgb[few - 1]) >= bright_light(pixel->rgb[0]) * ALIKE);
}

static uint8_t bits_of_few(const BrightPixel *pixel, uint32_t n_samples)
{
    uint8_t bits = 0;
    for (int i = 0; i < BRIGHT_KEPT; i++) bits |= (uint8_t)(has_few_alike(pixel, i, n_samples) << i);
    return bits;
}
_Static_assert(BRIGHT_KEPT <= 8, "a bit for each");

/* What a pixel's mean is without the samples that have few like them, or with them. */
static double light_of(const FilmPixel *pixel, const BrightPixel *without)
{
    double rgb[3];
    int n_without = 0;
    for (int c = 0; c < 3; c++) rgb[c] = (double)pixel->rgb[c] * FILM_UNIT;
    for (int i = 0; without && !is_plain(without, pixel->n) && i < BRIGHT_KEPT; i++)
        if (has_few_alike(without, i, pixel->n)) {
            for (int c = 0; c < 3; c++) rgb[c] -= (double)without->rgb[i][c];
            n_without++;
        }
    for (int c = 0; c < 3; c++)
        if (fabs(rgb[c]) <= n_without * FILM_UNIT) rgb[c] = 0; /* by how much the film rounded these */
    return pixel->n ? (fabs(rgb[0]) + fabs(rgb[1]) + fabs(rgb[2])) / (3.0 * pixel->n) : 0;
}

/* By how much a pixel would be darker than those next to it, were all its samples that have few alike to go. Where light is
 * folded or a shadow ends, neighbours may have found by many samples what a pixel has found by one. */
static double hole_at(const Maps *maps, uint32_t x, uint32_t y)
{
    float darkest[HOLE_RANK];
    uint32_t n = 0;
    for (uint32_t v = y > 0 ? y - 1 : y; v <= y + 1 && v < maps->height; v++)
        for (uint32_t u = x > 0 ? x - 1 : x; u <= x + 1 && u < maps->width; u++) {
            float light = maps->looks.plain[place_in(maps, u, v)];
            if ((u == x && v == y) || (n == HOLE_RANK && light >= darkest[n - 1])) continue;
            uint32_t k = n < HOLE_RANK ? n++ : HOLE_RANK - 1;
            for (; k > 0 && darkest[k - 1] > light; k--) darkest[k] = darkest[k - 1];
            darkest[k] = light;
        }
    if (n < HOLE_RANK) return 0;
    return fmax((double)darkest[HOLE_RANK - 1] - (double)maps->looks.plain[place_in(maps, x, y)], 0);
}

/* In murky water one sample in thirty comes to a dark bottom, and all others are scattered before: such pixels are not black ones
 * among white. So a pixel in which few say something has some of what those around it say, and what few say around it counts little. */
static bool find_reflectances(const Maps *maps, float *scratch)
{
    const size_t n = (size_t)maps->width * maps->height;
    float *told = maps->looks.told, *sums = calloc(2 * n, sizeof *sums), *reflected = sums, *around = sums + n;
    if (!sums) return false;
    for (uint32_t y = 0; y < maps->height; y++)
        for (uint32_t x = 0; x < maps->width; x++) {
            const BrightPixel *bright = bright_at(maps, x, y);
            const float n_samples = fmaxf((float)film_pixel(maps->film, x, y)->n, 1);
            told[place_in(maps, x, y)] = (float)bright->n_reflected / n_samples;
            reflected[place_in(maps, x, y)] = (float)bright->reflected / (BRIGHT_REFLECTED * n_samples);
        }
    mean_around(told, maps->width, maps->height, AROUND, scratch, around, maps->pool);
    memcpy(told, around, n * sizeof *told);
    mean_around(reflected, maps->width, maps->height, AROUND, scratch, around, maps->pool);
    for (uint32_t y = 0; y < maps->height; y++)
        for (uint32_t x = 0; x < maps->width; x++) {
            const size_t i = place_in(maps, x, y);
            const BrightPixel *bright = bright_at(maps, x, y);
            const float own = (float)bright->n_reflected, n_samples = (float)film_pixel(maps->film, x, y)->n;
            const float others = n_samples > own ? 1 - own / n_samples : 0; /* as many samples of those around */
            const float mean = told[i] > 0 ? around[i] / told[i] : 1;
            const float said =
                own + others > 0 ? ((float)bright->reflected / BRIGHT_REFLECTED + others * mean) / (own + others) : 1;
            told[i] = float_min(told[i] / TOLD_PART, 1);
            maps->looks.reflectance[i] = float_max(1 + told[i] * (said - 1), LEAST_REFLECTED);
        }
    free(sums);
    return true;
}

static void look_at_row(void *context, uint32_t index, unsigned worker)
{
    Maps *maps = context;
    uint32_t y = index;
    (void)worker;
    for (uint32_t x = 0; x < maps->width; x++) {
        size_t i = place_in(maps, x, y);
        Looks *looks = &maps->looks;
        const FilmPixel *pixel = film_pixel(maps->film, x, y);
        const BrightPixel *bright = bright_at(maps, x, y);
        float reflectance = reflectance_at(maps, x, y);
        looks->plain[i] = (float)light_of(pixel, bright);
        looks->plain_root[i] = sqrtf(sqrtf(looks->plain[i]));
        looks->lit[i] = looks->plain[i] / reflectance;
        looks->found[i] = (float)light_of(pixel, NULL) / reflectance;
        looks->brightest[i] = bright_light(bright->rgb[0]);
        looks->seen[i] = bright->seen;
        for (int c = 0; c < 3; c++)
            looks->colors[c][i] = pixel->n ? (float)((double)pixel->rgb[c] * FILM_UNIT / pixel->n) : 0;
        for (int k = 0; k < BRIGHT_KEPT; k++) looks->lights[i][k] = bright_light(bright->rgb[k]);
        looks->few[i] = is_plain(bright, pixel->n) ? 0 : bits_of_few(bright, pixel->n);
        for (int k = 0; k < BRIGHT_THINGS && bright->counts[k] && pixel->n; k++) {
            looks->things[k][i] = bright->things[k];
            looks->shares[k][i] = reflectance * (float)bright->counts[k] / (float)pixel->n;
        }
        maps->rows[index].light += light_of(pixel, NULL);
    }
}

/* Of all samples of a pixel that stand alone: where each goes by itself. */
static void find_ways_of_pixel(const Maps *maps, uint32_t x, uint32_t y, Row *row)
{
    const BrightPixel *bright = bright_at(maps, x, y);
    uint32_t n = film_pixel(maps->film, x, y)->n;
    if (n < SPREAD_LEAST_SAMPLES || is_plain(bright, n)) return;
    double much = STANDS_OUT * n * spread_reference(maps, x, y);
    for (int i = 0; i < BRIGHT_KEPT && (double)bright_light(bright->rgb[i]) > much; i++) {
        if (!has_few_alike(bright, i, n)) continue;
        Lone lone = spread_lone(maps, x, y, i);
        spread_find_shares(maps, &lone);
        Way way = {.x = x,
                   .kept = (uint8_t)i,
                   .part = 1,
                   .light = lone.light,
                   .seen = lone.seen,
                   .black = lone.black,
                   .slope = lone.slope};
        spread_find_way(maps, &lone, &way);
        if (!ARRAY_ROOM(row->ways, row->capacity, row->n)) {
            row->out_of_memory = true;
            return;
        }
        row->ways[row->n++] = way;
    }
}

static void find_ways_of_row(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    (void)worker;
    for (uint32_t x = 0; x < maps->width; x++) find_ways_of_pixel(maps, x, index, &maps->rows[index]);
}

/* Of a sample, what goes: as part of its pixel's mean. */
static void find_taken(const Maps *maps, uint32_t y, const Way *way, double rgb[3])
{
    const BrightPixel *pixel = bright_at(maps, way->x, y);
    double part = way->part / film_pixel(maps->film, way->x, y)->n;
    for (int c = 0; c < 3; c++) rgb[c] = part * (double)pixel->rgb[way->kept][c];
}

/* The channel that has nearly all of a sample's light; 3: none has. */
static int only_channel(const double rgb[3])
{
    const double little = 0.1;
    int most = rgb[1] > rgb[0] ? 1 : 0;
    if (rgb[2] > rgb[most]) most = 2;
    for (int c = 0; c < 3; c++)
        if (c != most && rgb[c] < little * rgb[most]) return most;
    return 3;
}

/* What of each sample goes, as what fills a hole stays; and which do not go at all. */
static void settle_row(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    Row *row = &maps->rows[index];
    double hole = 0;
    size_t n = 0;
    (void)worker;
    for (size_t i = 0; i < row->n; i++) {
        Way way = row->ways[i];
        if (i == 0 || way.x != row->ways[i - 1].x) hole = hole_at(maps, way.x, index);
        way.part = way.radius > 0 ? fmin(way.part, 1 - fmin(hole / way.seen, 1)) : 0;
        hole = fmax(hole - (1 - way.part) * way.light, 0);
        row->ways[i].part = way.part;
        if (way.part == 0) continue;
        n++;
        double taken[3];
        find_taken(maps, index, &way, taken);
        for (int c = 0; c < 3; c++) row->taken[c] += taken[c];
        row->moved += way.part * way.light;
        int only = only_channel(taken);
        if (only < 3) row->one_colored[only] += way.part * way.light;
        if (!way.far && way.radius > row->farthest) row->farthest = way.radius;
    }
    row->n_going = n;
}

/* What a sample that is taken from row y brings to rows from y0 up to but without y1. */
static void go_way(const Maps *maps, uint32_t y, const Way *way, uint32_t y0, uint32_t y1)
{
    Lone lone = spread_lone_on_way(maps, y, way);
    double squared = spread_squared_luminance(lone.untinted);
    Square square = square_around(&lone, way->radius);
    for (uint32_t v = square.y0 > y0 ? square.y0 : y0; v < square.y1 && v < y1; v++) {
        double weights[2 * SPREAD_FARTHEST + 1];
        Columns span = spread_weights_of_row(maps, &lone, way, v, weights);
        SpreadPixel *to = &maps->pixels[place_in(maps, span.x0, v)];
        for (uint32_t i = 0; i < span.x1 - span.x0; i++, to++) {
            double part = weights[i] / way->weights;
            for (int c = 0; c < 3; c++) to->rgb[c] += part * lone.untinted[c];
            to->given += part * part * squared;
        }
    }
}

/* Some rows of what samples bring, from all rows around. */
static void gather_band(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    uint32_t y0 = index * BAND, y1 = y0 + BAND < maps->height ? y0 + BAND : maps->height;
    (void)worker;
    for (uint32_t y = y0 > SPREAD_FARTHEST ? y0 - SPREAD_FARTHEST : 0; y < y1 + SPREAD_FARTHEST && y < maps->height;
         y++) {
        const Row *row = &maps->rows[y];
        uint32_t farthest = (uint32_t)row->farthest;
        if (y + farthest < y0 || y >= y1 + farthest) continue;
        for (size_t i = 0; i < row->n; i++)
            if (row->ways[i].part > 0 && !row->ways[i].far) go_way(maps, y, &row->ways[i], y0, y1);
    }
}

/* What comes to a row gets the colour of what is reflected there. */
static void tint_row(void *context, uint32_t index, unsigned worker)
{
    const Maps *maps = context;
    uint32_t y = index;
    Row *row = &maps->rows[index];
    (void)worker;
    for (uint32_t x = 0; x < maps->width; x++) {
        SpreadPixel *pixel = &maps->pixels[place_in(maps, x, y)];
        if (!(pixel->given > 0)) continue;
        double untinted = spread_squared_luminance(pixel->rgb);
        float tint[3];
        tint_at(maps, x, y, tint);
        for (int c = 0; c < 3; c++) {
            pixel->rgb[c] *= (double)tint[c];
            row->given[c] += pixel->rgb[c];
            row->given_size[c] += fabs(pixel->rgb[c]);
        }
        if (untinted > 0) pixel->given *= spread_squared_luminance(pixel->rgb) / untinted;
    }
}

static void take(const Maps *maps, uint32_t y, const Way *way)
{
    SpreadPixel *from = &maps->pixels[place_in(maps, way->x, y)];
    double rgb[3], mean, standard_error;
    find_taken(maps, y, way, rgb);
    for (int c = 0; c < 3; c++) from->rgb[c] -= rgb[c];
    film_luminance(film_pixel(maps->film, way->x, y), &mean, &standard_error);
    if (standard_error > 0) from->taken += spread_squared_luminance(rgb) / (standard_error * standard_error);
}

/* What is found where red is reflected may go to where blue is, and the other way. Over both no channel is lost; what is, by
 * chance, is made up for by all that comes. */
static void balance_row(void *context, uint32_t index, unsigned worker)
{
    const Settlement *balance = context;
    const Maps *maps = balance->maps;
    const Row *row = &maps->rows[index];
    SpreadPixel *pixels = &maps->pixels[(size_t)index * maps->width];
    (void)worker;
    for (uint32_t x = 0; x < maps->width; x++)
        for (int c = 0; c < 3; c++) pixels[x].rgb[c] += balance->missing[c] * fabs(pixels[x].rgb[c]);
    for (size_t i = 0; i < row->n; i++)
        if (row->ways[i].part > 0) take(maps, index, &row->ways[i]);
}

static void settle_colors(Maps *maps)
{
    Settlement balance = {.maps = maps};
    double size[3] = {0};
    pool_run(maps->pool, maps->height, tint_row, maps);
    for (uint32_t y = 0; y < maps->height; y++)
        for (int c = 0; c < 3; c++) {
            balance.missing[c] += maps->rows[y].taken[c] - maps->rows[y].given[c];
            size[c] += maps->rows[y].given_size[c];
        }
    for (int c = 0; c < 3; c++) balance.missing[c] = size[c] > 0 ? balance.missing[c] / size[c] : 0;
    pool_run(maps->pool, maps->height, balance_row, &balance);
}

static bool maps_init(Maps *maps)
{
    size_t n = (size_t)maps->width * maps->height;
    Looks *looks = &maps->looks;
    float **floats[] = {&looks->plain,     &looks->plain_root, &looks->around,      &looks->brightest,
                        &looks->lit,       &looks->lit_around, &looks->found,       &looks->colors[0],
                        &looks->colors[1], &looks->colors[2],  &looks->reflectance, &looks->told};
    bool ready = (maps->rows = calloc(maps->height, sizeof *maps->rows)) != NULL;
    for (size_t i = 0; i < COUNT_OF(floats); i++) ready = (*floats[i] = calloc(n, sizeof(float))) != NULL && ready;
    ready = (looks->lights = calloc(n, sizeof *looks->lights)) != NULL && ready;
    ready = (looks->seen = calloc(n, sizeof *looks->seen)) != NULL && ready;
    ready = (looks->few = calloc(n, sizeof *looks->few)) != NULL && ready;
    for (int k = 0; k < BRIGHT_THINGS; k++) {
        ready = (looks->things[k] = calloc(n, sizeof *looks->things[k])) != NULL && ready;
        ready = (looks->shares[k] = calloc(n, sizeof *looks->shares[k])) != NULL && ready;
    }
    return ready;
}

static void maps_clear(Maps *maps)
{
    Looks *looks = &maps->looks;
    for (uint32_t y = 0; maps->rows && y < maps->height; y++) free(maps->rows[y].ways);
    for (int k = 0; k < BRIGHT_THINGS; k++) {
        free(looks->things[k]);
        free(looks->shares[k]);
    }
    free(looks->plain);
    free(looks->plain_root);
    free(looks->around);
    free(looks->lit);
    free(looks->lit_around);
    free(looks->found);
    for (int c = 0; c < 3; c++) free(looks->colors[c]);
    free(looks->reflectance);
    free(looks->told);
    free(looks->brightest);
    free(looks->lights);
    free(looks->seen);
    free(looks->few);
    thing_boxes_clear(&maps->boxes);
    free(maps->rows);
}

static bool find_boxes(Maps *maps)
{
    const Looks *looks = &maps->looks;
    for (uint32_t y = 0; y < maps->height; y++)
        for (uint32_t x = 0; x < maps->width; x++)
            for (size_t i = place_in(maps, x, y), k = 0; k < BRIGHT_THINGS && looks->shares[k][i] > 0; k++)
                if (!thing_boxes_add(&maps->boxes, looks->things[k][i], x, y)) return false;
    return true;
}

static double typical_light(const Looks *looks, size_t n)
{
    double root = 0;
    for (size_t i = 0; i < n; i++) {
        float light = fabsf(looks->colors[0][i]) + fabsf(looks->colors[1][i]) + fabsf(looks->colors[2][i]);
        root += (double)sqrtf(sqrtf(light * (1.0f / 3)));
    }
    root /= (double)n;
    return root * root * root * root;
}

static bool look(Maps *maps)
{
    Looks *looks = &maps->looks;
    uint32_t width = maps->width, height = maps->height;
    size_t n = (size_t)width * height;
    float *scratch = calloc(n, sizeof *scratch), *around = calloc(n, sizeof *around);
    bool ready = scratch && around && find_reflectances(maps, scratch);
    if (ready) {
        pool_run(maps->pool, height, look_at_row, maps);
        mean_around(looks->plain, width, height, AROUND, scratch, looks->around, maps->pool);
        mean_around(looks->lit, width, height, AROUND, scratch, looks->lit_around, maps->pool);
        mean_around(looks->found, width, height, BESIDE, scratch, around, maps->pool);
        mean_around(around, width, height, BESIDE, scratch, looks->found, maps->pool);
    }
    for (int c = 0; ready && c < 3; c++) {
        float *own = looks->colors[c];
        mean_around(own, width, height, COLORS_AROUND, scratch, around, maps->pool);
        looks->colors[c] = around;
        around = own;
    }
    free(scratch);
    free(around);
    if (ready) maps->typical = typical_light(looks, n);
    return ready && find_boxes(maps);
}

static bool find_ways(Maps *maps, FarSamples *far)
{
    pool_run(maps->pool, maps->height, find_ways_of_row, maps);
    for (uint32_t y = 0; y < maps->height; y++)
        if (maps->rows[y].out_of_memory) return false;
    if (!spread_far_find(maps, far)) return false;
    pool_run(maps->pool, maps->height, settle_row, maps);
    return true;
}

/* The light of samples of one colour, where others are of another: what is red in all samples is a red thing. */
static double one_colored_of(const Maps *maps)
{
    const double most = 0.8;
    double sums[3] = {0}, largest = 0;
    for (uint32_t y = 0; y < maps->height; y++)
        for (int c = 0; c < 3; c++) sums[c] += maps->rows[y].one_colored[c];
    for (int c = 0; c < 3; c++) largest = fmax(largest, sums[c]);
    double all = sums[0] + sums[1] + sums[2];
    return largest <= most * all ? all : 0;
}

static bool go(Maps *maps, const FarSamples *far, Spread *spread)
{
    double light = 0, moved = 0;
    for (uint32_t y = 0; y < maps->height; y++) {
        const Row *row = &maps->rows[y];
        spread->samples += row->n_going;
        light += row->light;
        moved += row->moved;
    }
    spread->light = light > 0 ? moved / light : 0;
    spread->one_colored = moved > 0 ? one_colored_of(maps) / moved : 0;
    if (!spread->samples) return true;
    pool_run(maps->pool, (maps->height + BAND - 1) / BAND, gather_band, maps);
    if (!spread_far_give(maps, far)) return false;
    settle_colors(maps);
    return true;
}

Status spread_init(Spread *spread, const Film *film, const BrightFilm *bright, Pool *pool, Error *error)
{
    *spread = (Spread){.width = film->width, .height = film->height};
    size_t n = (size_t)film->width * film->height;
    spread->pixels = calloc(n, sizeof *spread->pixels);
    Maps maps = {.film = film,
                 .bright = bright,
                 .width = film->width,
                 .height = film->height,
                 .pixels = spread->pixels,
                 .pool = pool};
    FarSamples far = {0};
    bool good = spread->pixels && maps_init(&maps) && look(&maps) && find_ways(&maps, &far) && go(&maps, &far, spread);
    spread_far_clear(&far);
    maps_clear(&maps);
    if (good) return STATUS_OK;
    spread_clear(spread);
    return fail_memory(error, n * (sizeof *spread->pixels + (2 * BRIGHT_THINGS + 13 + BRIGHT_KEPT) * sizeof(float)),
                       "single bright samples");
}

void spread_clear(Spread *spread)
{
    free(spread->pixels);
    *spread = (Spread){0};
}

void spread_apply(const Spread *spread, Image *image)
{
    for (uint32_t y = 0; y < spread->height; y++)
        for (uint32_t x = 0; x < spread->width; x++) {
            const SpreadPixel *from = spread_pixel(spread, x, y);
            float *pixel = image_at(image, x, y);
            for (int c = 0; c < 3; c++)
                if (from->rgb[c] != 0) pixel[c] = (float)((double)pixel[c] + from->rgb[c]);
        }
}
