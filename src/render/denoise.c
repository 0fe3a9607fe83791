/* denoise.c - non-local means with known noise, tile by tile.
 * All is kept in planes, a float a pixel, with a border that mirrors the picture: the inner loops run along rows, ask nothing,
 * and become SIMD by themselves.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/denoise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/lanes.h"
#include "base/luminance.h"
#include "render/around.h"

/* Measured on the examples, by the error against pictures of many samples (bench denoise), and by eye. */

/* How far pixels are looked for, and the half side of the squares that are compared. */
enum { WINDOW = 10, PATCH = 3, BORDER = WINDOW + PATCH };
/* Differences of colours are told in this many standard errors. */
#define STANDARD_ERRORS 0.7f
/* The noise of another pixel explains no more than what is this many times the own one's: where one in many has found a glint, it
 * cannot be said that the others have not. */
#define MORE_NOISE 3.0f
/* A pixel's own noise, against that of those around it. */
#define OWN_NOISE 0.11f
/* The noise that is stated counts as far as this many times the square of what a pixel's own samples say: what is beside a dot has
 * the noise of it stated, and would take it for its like. */
#define HELD 4.0f
/* By how much two pixels themselves may differ: what one sample in many has found is not in their squares' mean. And how soon they
 * are too far apart, beyond that. */
#define CHANCE 9.0f
#define TOO_FAR (1 / 8.0f)
/* Differences below this part of the colours are not seen. */
#define UNSEEN 0.002f
/* By how much what is met first may differ: an albedo, a normal, a distance in relation to itself. */
#define ALBEDO_APART 0.06f
#define NORMAL_APART 0.25f
#define DISTANCE_APART 0.06f
/* By how much what is seen behind clear things may, of which each counts with .25 to 1; and the variance of one sample of that,
 * where a rough boundary, or one that is clear in part, shows now the one and now the other. */
#define PASSED_APART 0.15f
#define PASSED_VARIANCE 0.25f
/* Changes are made up to this many times what those around a pixel say that pays: see settle. */
#define CHANGES_PAID 1.5f
enum { CHANGES_AROUND = 4 };
/* How far from where it was light is given back, twice over for what has no edge; and the share of those that have lost none: see
 * give_back. */
enum { GIVEN_AROUND = 8 };
#define LEAST_SHARE 1e-20f
/* A single pixel counts with so many times of what it gains, at most, so that a dot does not keep the noise around it. */
#define CHANGED_MOST 32.0f
/* Squared distances are held at this: nothing is left of a weight long before. */
#define FAR 64.0f
/* Around a pixel, for how the noise of its colours goes with that of its luminance. */
enum { COLORS_AROUND = 5 };
/* How many times the halves' part of a colour in that, neighbours may say. */
#define COLORS_MENDED 3.0f
/* Pixels that a thread works on at a time. */
enum { TILE_X = 64, TILE_Y = 16, WIDE = TILE_X + 2 * PATCH, HIGH = TILE_Y + 2 * PATCH };

enum {
    PLANE_RED,
    PLANE_NOISE = 3,
    PLANE_GUIDE = 6,
    PLANE_VALID = PLANE_GUIDE + AOV_GUIDES,
    PLANES,
    PLANE_CARRIED = PLANES,
    PLANES_CARRIED = PLANES + DENOISE_MOST_CARRIED
};

/* Maps of the film's size. */
enum {
    MAP_RED,
    MAP_GAINED = 3,
    MAP_CHANGED,
    MAP_SCRATCH,
    MAP_MEAN,
    MAP_OWN,
    MAP_LOST,
    MAPS,
    MAP_CARRIED = MAPS,
    MAPS_CARRIED = MAPS + DENOISE_MOST_CARRIED
};

/* The picture in planes, and what its mirror images add to whole tiles and a border around them. */
typedef struct Planes {
    uint32_t width, height;
    uint32_t tiles_x, tiles_y;
    size_t stride;                /* of rows with their borders */
    int n_carried;                /* channels */
    float *plane[PLANES_CARRIED]; /* where the picture begins; PLANE_NOISE: squares of standard errors */
    float *maps[MAPS_CARRIED];
    float *memory;
    Pool *pool;
    float passed_scale; /* 1 / what may be the difference between what two pixels see behind clear things */
} Planes;

static Status planes_new(Planes *planes, uint32_t width, uint32_t height, size_t n_carried, Pool *pool, Error *error)
{
    const size_t n_planes = PLANES + n_carried, n_maps = MAPS + n_carried;
    uint32_t tiles_x = (width + TILE_X - 1) / TILE_X, tiles_y = (height + TILE_Y - 1) / TILE_Y;
    size_t stride = (size_t)tiles_x * TILE_X + 2 * BORDER, size = stride * ((size_t)tiles_y * TILE_Y + 2 * BORDER);
    size_t map_size = (size_t)width * height, bytes = (size * n_planes + map_size * n_maps) * sizeof(float);
    *planes = (Planes){.width = width,
                       .height = height,
                       .tiles_x = tiles_x,
                       .tiles_y = tiles_y,
                       .stride = stride,
                       .n_carried = (int)n_carried,
                       .pool = pool};
    planes->memory = malloc(bytes);
    if (!planes->memory) return fail_memory(error, bytes, "denoising the picture");
    for (size_t i = 0; i < n_planes; i++) planes->plane[i] = planes->memory + i * size + BORDER * stride + BORDER;
    for (size_t i = 0; i < n_maps; i++) planes->maps[i] = planes->memory + n_planes * size + i * map_size;
    return STATUS_OK;
}

/* ---- the planes ---- */

/* Where the picture between mirrors has what is at i, for any i. */
static uint32_t place_in_mirror(int64_t i, uint32_t size)
{
    int64_t period = 2 * (int64_t)size, k = ((i % period) + period) % period;
    return (uint32_t)(k < size ? k : period - 1 - k);
}

static void mirror(const Planes *planes, float *plane)
{
    const int64_t width = planes->width, height = planes->height, stride = (int64_t)planes->stride;
    const int64_t end = (int64_t)planes->tiles_x * TILE_X + BORDER, bottom = (int64_t)planes->tiles_y * TILE_Y + BORDER;
    for (int64_t y = 0; y < height; y++) {
        float *row = plane + y * stride;
        for (int64_t x = -BORDER; x < 0; x++) row[x] = row[place_in_mirror(x, planes->width)];
        for (int64_t x = width; x < end; x++) row[x] = row[place_in_mirror(x, planes->width)];
    }
    for (int64_t y = -BORDER; y < bottom; y++) {
        const float *from = plane + place_in_mirror(y, planes->height) * stride;
        if (y < 0 || y >= height) memcpy(plane + y * stride - BORDER, from - BORDER, planes->stride * sizeof *plane);
    }
}

static void fill(Planes *planes, const Film *film, const AovFilm *aovs, const Image *image)
{
    double looks = 0;
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++) {
            size_t pixel = (size_t)y * image->width + x, to = y * planes->stride + x;
            float guide[AOV_GUIDES];
            looks += aov_film_guide(aovs, film, pixel, guide);
            for (int i = 0; i < 3; i++)
                planes->plane[PLANE_RED + i][to] = image->pixels[pixel * image->n_channels + (size_t)i];
            for (int i = 0; i < AOV_GUIDES; i++) planes->plane[PLANE_GUIDE + i][to] = guide[i];
            planes->plane[PLANE_VALID][to] = film->pixels[pixel].n >= DENOISE_LEAST_SAMPLES ? 1.0f : 0.0f;
        }
    double mean = fmax(looks / ((double)planes->width * planes->height), 1);
    planes->passed_scale = 1 / sqrtf(PASSED_APART * PASSED_APART + 2 * PASSED_VARIANCE / (float)mean);
}

static void fill_carried(Planes *planes, const Image *carried)
{
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++)
            for (int i = 0; i < planes->n_carried; i++)
                planes->plane[PLANE_CARRIED + i][y * planes->stride + x] = image_at(carried, x, y)[i];
}

/* A map's mean around each pixel takes its place. */
static void blur(const Planes *planes, int map, uint32_t radius)
{
    float *from = planes->maps[map], *mean = planes->maps[MAP_MEAN];
    mean_around(from, planes->width, planes->height, radius, planes->maps[MAP_SCRATCH], mean, planes->pool);
    memcpy(from, mean, (size_t)planes->width * planes->height * sizeof *from);
}

/* The standard error of luminance by a pixel's own samples. What a film states of its noise is that of those around it. */
static void fill_own_error(const Planes *planes, const Film *film)
{
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++) {
            double mean, standard_error;
            film_luminance(film_pixel(film, x, y), &mean, &standard_error);
            planes->maps[MAP_OWN][(size_t)y * planes->width + x] = (float)fmax(standard_error, 0);
        }
}

/* How the noise of each colour goes with that of the luminance, around each pixel: in the first maps. Noisier pixels count more, but
 * only by their error, not its square: a dot of one colour would speak for all around it. */
static void fill_color_noise(const Planes *planes, const Film *film)
{
    const float least = 1e-20f;
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++) {
            size_t i = (size_t)y * planes->width + x;
            float squared[4], scale = 1 / float_max(planes->maps[MAP_OWN][i], sqrtf(least));
            film_squared_errors(film, x, y, squared);
            for (int k = 0; k < 4; k++) planes->maps[k][i] = squared[k] * scale;
        }
    for (int k = 0; k < 4; k++) blur(planes, k, COLORS_AROUND);
    const float *luminance = planes->maps[3];
    for (size_t i = 0; i < (size_t)planes->width * planes->height; i++)
        for (int k = 0; k < 3; k++) planes->maps[k][i] = (planes->maps[k][i] + least) / (luminance[i] + least);
}

/* By how much a pixel differs from what those next to it foretell, for an even slope: R, G, B and luminance. */
static void differ_beside(const Image *image, uint32_t x, uint32_t y, float difference[4])
{
    uint32_t right = x + 1 < image->width ? x + 1 : x > 0 ? x - 1 : x;
    uint32_t below = y + 1 < image->height ? y + 1 : y > 0 ? y - 1 : y;
    const float *here = image_at(image, x, y), *beside = image_at(image, right, y), *under = image_at(image, x, below),
                *across = image_at(image, right, below);
    for (int k = 0; k < 3; k++) difference[k] = here[k] - beside[k] - under[k] + across[k];
    difference[3] = color_luminance(difference);
}

/* Colours may make up for each other in the luminance of all samples, and not of halves of them: what neighbours differ by shows
 * that. Textures differ, too: so it counts only so far. */
static void mend_color_noise(const Planes *planes, const Image *image)
{
    const float least = 1e-20f;
    for (int k = 3; k >= 0; k--) {
        float *squares = planes->maps[k == 3 ? MAP_CHANGED : MAP_GAINED];
        for (uint32_t y = 0; y < planes->height; y++)
            for (uint32_t x = 0; x < planes->width; x++) {
                size_t i = (size_t)y * planes->width + x;
                float difference[4];
                differ_beside(image, x, y, difference);
                squares[i] = difference[k] * difference[k] / float_max(planes->maps[MAP_OWN][i], sqrtf(least));
            }
        blur(planes, k == 3 ? MAP_CHANGED : MAP_GAINED, COLORS_AROUND);
        for (size_t i = 0; k < 3 && i < (size_t)planes->width * planes->height; i++) {
            float *ratio = &planes->maps[k][i], most = COLORS_MENDED * *ratio;
            float beside = (squares[i] + least) / (planes->maps[MAP_CHANGED][i] + least);
            *ratio = float_min(float_max(beside, *ratio), most);
        }
    }
}

static void fill_noise(const Planes *planes, const Film *film, const Image *image)
{
    const int channel = image_channel(image, "noise.Y");
    float *noise = planes->maps[MAP_CHANGED], *around = planes->maps[MAP_MEAN];
    fill_own_error(planes, film);
    fill_color_noise(planes, film);
    mend_color_noise(planes, image);
    for (int k = 0; k < 3; k++) {
        for (size_t i = 0; i < (size_t)planes->width * planes->height; i++) {
            float error = image->pixels[i * image->n_channels + (size_t)channel], own = planes->maps[MAP_OWN][i];
            noise[i] = float_min(error * error, HELD * own * own) * planes->maps[k][i];
        }
        mean_around(noise, planes->width, planes->height, 1, planes->maps[MAP_SCRATCH], around, planes->pool);
        for (size_t i = 0; i < (size_t)planes->width * planes->height; i++)
            planes->plane[PLANE_NOISE + k][i / planes->width * planes->stride + i % planes->width] =
                around[i] + OWN_NOISE * (noise[i] - around[i]);
    }
}

/* ---- a tile ---- */

/* What a thread has at hand: of a tile and the squares about its pixels. */
typedef struct Tile {
    float apart[HIGH][WIDE]; /* of each pixel and the one beside it by the offset, by their colours */
    float rows[HIGH][WIDE];  /* the sums of that over 2 PATCH + 1 of a row */
    float sums[4 + DENOISE_MOST_CARRIED][TILE_Y][TILE_X]; /* of what is taken: R, G, B, weights, and what is carried */
} Tile;

/* exp(-d), about. */
static float shape(float d)
{
    float part = float_max(1 - d * (1.0f / 8), 0), squared = part * part;
    squared *= squared;
    return squared * squared;
}

/* By how much the colours at a and b of a row differ beyond their noise, in standard errors; n of them, beside each other. */
static void tell_colors_apart(const Planes *planes, ptrdiff_t a, ptrdiff_t b, int n, float *restrict apart)
{
    for (int x = 0; x < n; x++) apart[x] = 0;
    for (int k = 0; k < 3; k++) {
        const float *color_a = planes->plane[PLANE_RED + k] + a, *color_b = planes->plane[PLANE_RED + k] + b;
        const float *noise_a = planes->plane[PLANE_NOISE + k] + a, *noise_b = planes->plane[PLANE_NOISE + k] + b;
        for (int x = 0; x < n; x++) {
            float difference = color_a[x] - color_b[x], unseen = UNSEEN * (color_a[x] + color_b[x]);
            float noise = noise_a[x] + float_min(noise_b[x], MORE_NOISE * noise_a[x]),
                  chance = noise_a[x] + float_min(noise_a[x], noise_b[x]);
            float d = (difference * difference - chance) /
                      (STANDARD_ERRORS * STANDARD_ERRORS * noise + unseen * unseen + 1e-20f);
            apart[x] += float_min(d, FAR) * (1.0f / 3);
        }
    }
}

/* The same of what is met first. */
static void tell_guides_apart(const Planes *planes, ptrdiff_t a, ptrdiff_t b, int n, float *restrict apart)
{
    const float passed = planes->passed_scale,
                scales[AOV_GUIDES] = {
                    1 / ALBEDO_APART, 1 / ALBEDO_APART,   1 / ALBEDO_APART, 1 / NORMAL_APART, 1 / NORMAL_APART,
                    1 / NORMAL_APART, 1 / DISTANCE_APART, passed,           passed,           passed};
    for (int x = 0; x < n; x++) apart[x] = 0;
    for (int k = 0; k < AOV_GUIDES; k++) {
        const float *guide_a = planes->plane[PLANE_GUIDE + k] + a, *guide_b = planes->plane[PLANE_GUIDE + k] + b;
        for (int x = 0; x < n; x++) {
            float d = (guide_a[x] - guide_b[x]) * scales[k];
            apart[x] += d * d;
        }
    }
}

/* Of the tile that begins at a place and the squares about its pixels, apart from what is at an offset. */
static void tell_tile_apart(const Planes *planes, ptrdiff_t at, ptrdiff_t offset, Tile *tile)
{
    for (int y = 0; y < HIGH; y++) {
        ptrdiff_t row = at + (y - PATCH) * (ptrdiff_t)planes->stride - PATCH;
        tell_colors_apart(planes, row, row + offset, WIDE, tile->apart[y]);
        for (int x = 0; x < TILE_X; x++) {
            float sum = 0;
            for (int k = 0; k <= 2 * PATCH; k++) sum += tile->apart[y][x + k];
            tile->rows[y][x] = sum;
        }
    }
}

/* Takes from the pixels at an offset, as much as they are like those of the tile. */
static void take(const Planes *planes, ptrdiff_t at, ptrdiff_t offset, Tile *tile)
{
    const float mean = 1.0f / ((2 * PATCH + 1) * (2 * PATCH + 1));
    for (int y = 0; y < TILE_Y; y++) {
        ptrdiff_t row = at + y * (ptrdiff_t)planes->stride, other = row + offset;
        float guides[TILE_X], weights[TILE_X];
        tell_guides_apart(planes, row, other, TILE_X, guides);
        for (int x = 0; x < TILE_X; x++) {
            float sum = 0;
            for (int k = 0; k <= 2 * PATCH; k++) sum += tile->rows[y + k][x];
            float center = (tile->apart[y + PATCH][x + PATCH] - CHANCE) * TOO_FAR;
            weights[x] = shape(float_max(float_max(sum * mean, center), float_max(guides[x], 0))) *
                         planes->plane[PLANE_VALID][other + x];
        }
        for (int k = 0; k < 3; k++) {
            const float *color = planes->plane[PLANE_RED + k] + other;
            for (int x = 0; x < TILE_X; x++) tile->sums[k][y][x] += weights[x] * color[x];
        }
        for (int x = 0; x < TILE_X; x++) tile->sums[3][y][x] += weights[x];
        for (int k = 0; k < planes->n_carried; k++) {
            const float *carried = planes->plane[PLANE_CARRIED + k] + other;
            for (int x = 0; x < TILE_X; x++) tile->sums[4 + k][y][x] += weights[x] * carried[x];
        }
    }
}

/* What the tile has taken becomes its pixels' means, in the maps; and with them, by how much they change, and by how much what
 * they take lessens their noise. */
static void put_tile(const Planes *planes, uint32_t x0, uint32_t y0, const Tile *tile)
{
    for (uint32_t y = 0; y < TILE_Y && y0 + y < planes->height; y++)
        for (uint32_t x = 0; x < TILE_X && x0 + x < planes->width; x++) {
            size_t i = (size_t)(y0 + y) * planes->width + x0 + x, at = (y0 + y) * planes->stride + x0 + x;
            float gained = 0, changed = 0, weights = tile->sums[3][y][x];
            for (int k = 0; k < 3 && planes->plane[PLANE_VALID][at] != 0; k++) {
                float mean = tile->sums[k][y][x] / weights, change = mean - planes->plane[PLANE_RED + k][at];
                planes->maps[MAP_RED + k][i] = mean;
                changed += change * change;
                gained +=
                    planes->plane[PLANE_NOISE + k][at] * (1 - 1 / weights); /* 1: the weight of the pixel itself */
            }
            for (int k = 0; k < planes->n_carried && planes->plane[PLANE_VALID][at] != 0; k++)
                planes->maps[MAP_CARRIED + k][i] = tile->sums[4 + k][y][x] / weights;
            planes->maps[MAP_GAINED][i] = gained;
            planes->maps[MAP_CHANGED][i] = float_min(changed, CHANGED_MOST * gained);
        }
}

static void denoise_tile(void *context, uint32_t index, unsigned worker)
{
    (void)worker;
    const Planes *planes = context;
    uint32_t x0 = index % planes->tiles_x * TILE_X, y0 = index / planes->tiles_x * TILE_Y;
    const ptrdiff_t at = (ptrdiff_t)(y0 * planes->stride + x0);
    Tile tile;
    memset(tile.sums, 0, (size_t)(4 + planes->n_carried) * sizeof *tile.sums);
    for (int y = -WINDOW; y <= WINDOW; y++)
        for (int x = -WINDOW; x <= WINDOW; x++) {
            ptrdiff_t offset = y * (ptrdiff_t)planes->stride + x;
            tell_tile_apart(planes, at, offset, &tile);
            take(planes, at, offset, &tile);
        }
    put_tile(planes, x0, y0, &tile);
}

/* ---- the picture ---- */

/* Of y with noise s, and a mean m that takes a part c from y itself, y + t (m - y) errs least with t = s (1 - c) / (m - y)^2, in
 * the mean over such pixels: the errors of y and of m - y together have the expectation s (c - 1), after [Stein81]. So where the
 * changes are what noise explains, they are made; and where they are far more, because what is there resembles nothing around it,
 * few are. */
static void settle(const Planes *planes, Image *image, Image *carried)
{
    blur(planes, MAP_GAINED, CHANGES_AROUND);
    blur(planes, MAP_CHANGED, CHANGES_AROUND);
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++) {
            size_t i = (size_t)y * planes->width + x;
            if (planes->plane[PLANE_VALID][y * planes->stride + x] == 0) continue;
            float part =
                float_min(CHANGES_PAID * planes->maps[MAP_GAINED][i] / (planes->maps[MAP_CHANGED][i] + 1e-20f), 1);
            float *color = image_at(image, x, y);
            for (size_t k = 0; k < 3; k++) color[k] += part * (planes->maps[MAP_RED + k][i] - color[k]);
            float *others = planes->n_carried ? image_at(carried, x, y) : NULL;
            for (int k = 0; k < planes->n_carried; k++)
                others[k] += part * (planes->maps[MAP_CARRIED + k][i] - others[k]);
        }
}

/* What a pixel's colours have lost, and what of it counts: the luminance it has lost (gained: below 0). */
static float lost_at(const Planes *planes, uint32_t x, uint32_t y, const float *color, float lost[3])
{
    size_t at = y * planes->stride + x;
    for (int k = 0; k < 3; k++) lost[k] = planes->plane[PLANE_RED + k][at] - color[k];
    return color_luminance(lost);
}

/* Of what is lost (or gained) around a pixel it gets (gives) back its share, in proportion to the square of what it has lost (gained)
 * itself: mostly it is a few bright ones that did, and all others have as much more as less. */
static float share_of(float lost)
{
    float some = float_max(lost, 0);
    return some * some + LEAST_SHARE;
}

static void blur_widely(const Planes *planes, int map)
{
    for (int i = 0; i < 2; i++) blur(planes, map, GIVEN_AROUND);
}

/* What goes with a color becomes as many times more; the same, where it is the same. */
static void carry(float *carried, float before, float color)
{
    *carried = *carried == before ? color : before > 0 ? *carried * (color / before) : *carried;
}

/* What each pixel lost, and all their shares around each. */
static void find_lost(const Planes *planes, const Image *image)
{
    float *const *maps = planes->maps, lost[3];
    for (uint32_t y = 0; y < planes->height; y++)
        for (uint32_t x = 0; x < planes->width; x++) {
            size_t i = (size_t)y * planes->width + x;
            float all = lost_at(planes, x, y, image_at(image, x, y), lost);
            for (int k = 0; k < 3; k++) maps[MAP_RED + k][i] = lost[k];
            maps[MAP_LOST][i] = all;
            maps[MAP_CHANGED][i] = share_of(all);
            maps[MAP_GAINED][i] = share_of(-all);
        }
    for (int map = MAP_RED; map <= MAP_CHANGED; map++) blur_widely(planes, map);
}

/* What is lost on balance around each pixel becomes that for each unit of share there: in a channel's map what is to go back, and
 * in another what is to go away. */
static void deal_out(const Planes *planes, float *back, float *away)
{
    float *const *maps = planes->maps;
    for (size_t i = 0; i < (size_t)planes->width * planes->height; i++) {
        float around = back[i];
        back[i] = float_max(around, 0) / maps[MAP_CHANGED][i];
        away[i] = float_min(around, 0) / maps[MAP_GAINED][i];
    }
}

/* Bright pixels that stand alone lose light that nothing around them gets: a diamond was a sixteenth darker. So what is lost on
 * balance over a wide neighbourhood, where the noise of single pixels is small, goes back to those in it that have lost most. (In
 * proportion to what they lost, and over squares, there were squares of coloured dots around what had been one bright dot; and the
 * errors of diamond and prism were larger by a tenth and a twentieth.) */
static void give_back(const Planes *planes, Image *image, Image *carried)
{
    float *const *maps = planes->maps, *away = maps[MAP_OWN];
    find_lost(planes, image);
    for (int k = 0; k < 3; k++) {
        float *back = maps[MAP_RED + k];
        deal_out(planes, back, away);
        blur_widely(planes, MAP_RED + k);
        blur_widely(planes, MAP_OWN);
        for (uint32_t y = 0; y < planes->height; y++)
            for (uint32_t x = 0; x < planes->width; x++) {
                if (planes->plane[PLANE_VALID][y * planes->stride + x] == 0) continue;
                size_t i = (size_t)y * planes->width + x;
                float *color = &image_at(image, x, y)[k], before = *color, all = maps[MAP_LOST][i];
                float given = before + share_of(all) * back[i] + share_of(-all) * away[i];
                *color = before > 0 ? float_max(given, 0) : given;
                for (int c = k; c < planes->n_carried; c += 3) carry(&image_at(carried, x, y)[c], before, *color);
            }
    }
}

Status denoise(const Film *film, const AovFilm *aovs, Pool *pool, Image *image, Image *carried, Error *error)
{
    Planes planes;
    TRY(planes_new(&planes, film->width, film->height, carried ? carried->n_channels : 0, pool, error));
    fill(&planes, film, aovs, image);
    if (carried) fill_carried(&planes, carried);
    fill_noise(&planes, film, image);
    for (int i = 0; i < PLANES + planes.n_carried; i++) mirror(&planes, planes.plane[i]);
    pool_run(pool, planes.tiles_x * planes.tiles_y, denoise_tile, &planes);
    settle(&planes, image, carried);
    give_back(&planes, image, carried);
    free(planes.memory);
    return STATUS_OK;
}
