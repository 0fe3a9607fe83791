/* texture_image.c - pictures on surfaces.
 *
 * A picture is kept with its smaller versions (L. Williams, "Pyramidal Parametrics", 1983). Colours are kept as the
 * coefficients of their spectra, so that a look-up solves nothing: filtering mixes the spectra of the pixels, which
 * resolves to the mixture of their colours, as reflectance demands.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/texture_image.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/luminance.h"
#include "optics/color.h"

enum { MOST_LEVELS = 17 };
/* Of a colour: the coefficients of upsample_at, and what that is multiplied by. */
enum { COLOR_STRIDE = 4 };

typedef struct Level {
    uint32_t width, height;
    float *texels; /* width * height * stride */
} Level;

struct TextureImage {
    uint32_t n_channels, stride; /* stride: floats to a texel */
    bool light;                  /* the colours are those of light */
    float luminance;             /* of light: the mean */
    int n_levels;
    Level levels[MOST_LEVELS];
    float least[3], most[3]; /* of numbers */
    uint64_t hash;
};

void texture_image_free(TextureImage *image)
{
    if (!image) return;
    for (int i = 0; i < image->n_levels; i++) free(image->levels[i].texels);
    free(image);
}

double texture_image_bytes(uint32_t channels, uint32_t width, uint32_t height)
{
    uint32_t stride = channels == 1 ? 1 : COLOR_STRIDE;
    return 4.0 / 3 * width * height * stride * (double)sizeof(float);
}

uint64_t texture_image_hash(const TextureImage *image)
{
    return image->hash;
}
uint32_t texture_image_channels(const TextureImage *image)
{
    return image->n_channels;
}

void texture_image_range(const TextureImage *image, uint32_t channel, float *least, float *most)
{
    *least = image->least[channel];
    *most = image->most[channel];
}

/* ---- making ---- */

/* Which cells of the larger row, 2 or 3 of them, lie under cell i of one that is half as long, and how much of each: so
 * that the mean of a row stays what it is, whatever its length. */
static int cells_below(uint32_t i, uint32_t large, uint32_t small, uint32_t *first, float weight[3])
{
    double scale = (double)large / small, begin = i * scale, end = (i + 1) * scale;
    *first = (uint32_t)begin;
    int n = 0;
    for (uint32_t k = *first; k < large && (double)k < end && n < 3; k++) {
        double low = fmax(begin, k), high = fmin(end, (double)k + 1);
        if (high - low > 1e-9) weight[n++] = (float)((high - low) / scale);
    }
    return n;
}

static void halve(const Level *from, Level *to, uint32_t n_channels)
{
    for (uint32_t y = 0; y < to->height; y++) {
        uint32_t row, column;
        float down[3], across[3];
        int n_rows = cells_below(y, from->height, to->height, &row, down);
        for (uint32_t x = 0; x < to->width; x++) {
            int n_columns = cells_below(x, from->width, to->width, &column, across);
            float sum[3] = {0, 0, 0};
            for (int j = 0; j < n_rows; j++)
                for (int i = 0; i < n_columns; i++) {
                    const float *texel =
                        from->texels + ((row + (uint32_t)j) * (size_t)from->width + column + (uint32_t)i) * n_channels;
                    for (uint32_t c = 0; c < n_channels; c++) sum[c] += down[j] * across[i] * texel[c];
                }
            memcpy(to->texels + ((size_t)y * to->width + x) * n_channels, sum, n_channels * sizeof(float));
        }
    }
}

static void find_range(TextureImage *image)
{
    const Level *level = &image->levels[0];
    size_t n = (size_t)level->width * level->height;
    for (uint32_t c = 0; c < image->n_channels; c++) {
        image->least[c] = image->most[c] = level->texels[c];
        for (size_t i = 1; i < n; i++) {
            float value = level->texels[i * image->n_channels + c];
            image->least[c] = float_min(image->least[c], value);
            image->most[c] = float_max(image->most[c], value);
        }
    }
}

static Status new_image(const float *values, uint32_t channels, uint32_t width, uint32_t height, TextureImage **image,
                        Error *error)
{
    if (width == 0 || height == 0 || width > TEXTURE_IMAGE_LARGEST || height > TEXTURE_IMAGE_LARGEST)
        return fail(error, STATUS_INPUT, "a picture of %u by %u pixels; 1 to %d are possible each way", width, height,
                    TEXTURE_IMAGE_LARGEST);
    TextureImage *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "a picture");
    made->n_channels = made->stride = channels;
    for (uint32_t w = width, h = height;; w = w > 1 ? w / 2 : 1, h = h > 1 ? h / 2 : 1) {
        Level *level = &made->levels[made->n_levels++];
        size_t size = (size_t)w * h * channels * sizeof(float);
        *level = (Level){w, h, malloc(size)};
        if (!level->texels) {
            texture_image_free(made);
            return fail_memory(error, size, "a picture");
        }
        if (made->n_levels == 1)
            memcpy(level->texels, values, size);
        else
            halve(level - 1, level, channels);
        if (w == 1 && h == 1) break;
    }
    uint64_t key[3] = {width, height, channels};
    made->hash = hash_bulk(values, (size_t)width * height * channels * sizeof(float), hash_bytes(key, sizeof key, 0));
    *image = made;
    return STATUS_OK;
}

/* Rows of pixels are often alike: the last colour's coefficients are kept. */
static Status colors_to_spectra(Level *level, bool light, Error *error)
{
    size_t n = (size_t)level->width * level->height;
    float *spectra = malloc(n * COLOR_STRIDE * sizeof *spectra);
    if (!spectra) return fail_memory(error, n * COLOR_STRIDE * sizeof *spectra, "a picture");
    float last[COLOR_STRIDE] = {0};
    for (size_t i = 0; i < n; i++) {
        const float *rgb = level->texels + 3 * i;
        if (i == 0 || memcmp(rgb, rgb - 3, 3 * sizeof *rgb) != 0)
            last[3] = light ? upsample_light(rgb, last) : upsample_reflectance(rgb, last);
        memcpy(spectra + COLOR_STRIDE * i, last, sizeof last);
    }
    free(level->texels);
    level->texels = spectra;
    return STATUS_OK;
}

static Status new_spectra(const float *rgb, uint32_t width, uint32_t height, bool light, TextureImage **image,
                          Error *error)
{
    TextureImage *made = NULL;
    TRY(new_image(rgb, 3, width, height, &made, error));
    made->stride = COLOR_STRIDE;
    made->light = light;
    made->luminance = color_luminance(made->levels[made->n_levels - 1].texels);
    made->hash = hash_u64(light ? ~made->hash : made->hash);
    Status status = STATUS_OK;
    for (int i = 0; i < made->n_levels && status == STATUS_OK; i++)
        status = colors_to_spectra(&made->levels[i], light, error);
    if (status == STATUS_OK)
        *image = made;
    else
        texture_image_free(made);
    return status;
}

Status texture_image_new_colors(const float *rgb, uint32_t width, uint32_t height, TextureImage **image, Error *error)
{
    return new_spectra(rgb, width, height, false, image, error);
}

Status texture_image_new_light(const float *rgb, uint32_t width, uint32_t height, TextureImage **image, Error *error)
{
    return new_spectra(rgb, width, height, true, image, error);
}

float texture_image_luminance(const TextureImage *image)
{
    return image->luminance;
}

Status texture_image_new_numbers(const float *values, uint32_t channels, uint32_t width, uint32_t height,
                                 TextureImage **image, Error *error)
{
    TRY(new_image(values, channels, width, height, image, error));
    find_range(*image);
    return STATUS_OK;
}

/* ---- looking up ---- */

static uint32_t wrapped(double cell, uint32_t n, TextureWrap wrap)
{
    double size = n;
    if (wrap == WRAP_CLAMP || wrap == WRAP_ONCE) return cell < 0 ? 0 : cell >= size ? n - 1 : (uint32_t)cell;
    double period = wrap == WRAP_MIRROR ? 2 * size : size;
    double within = cell - period * floor(cell / period);
    if (within >= size && wrap == WRAP_MIRROR) within = period - 1 - within;
    return within >= size || !(within >= 0) ? n - 1 : (uint32_t)within;
}

/* Two cells next to a place, and how much of the second. */
typedef struct Between {
    uint32_t cell[2];
    float part;
    bool beyond[2]; /* the cell is one of nothing */
} Between;

static Between between(double at, uint32_t n, TextureWrap wrap)
{
    double x = at * n - 0.5, low = floor(x);
    Between two = {{wrapped(low, n, wrap), wrapped(low + 1, n, wrap)}, (float)(x - low), {false, false}};
    if (LIKELY(wrap != WRAP_ONCE)) return two;
    for (int i = 0; i < 2; i++) two.beyond[i] = low + i < 0 || low + i >= n;
    return two;
}

/* The four texels of a level around a place. */
typedef struct Four {
    const float *texel[4];
    float weight[4];
} Four;

static Four four_around(const TextureImage *image, int level_number, const TextureLook *look)
{
    const Level *level = &image->levels[level_number];
    Between across = between(look->u, level->width, look->wrap), down = between(1 - look->v, level->height, look->wrap);
    Four four;
    for (int i = 0; i < 4; i++) {
        int x = i & 1, y = i >> 1;
        four.texel[i] = level->texels + ((size_t)down.cell[y] * level->width + across.cell[x]) * image->stride;
        four.weight[i] = (x ? across.part : 1 - across.part) * (y ? down.part : 1 - down.part);
        if (UNLIKELY(across.beyond[x] || down.beyond[y])) four.weight[i] = 0;
    }
    return four;
}

float texture_image_pixels_seen(const TextureImage *image, const TextureLook *look)
{
    const Level *level = &image->levels[0];
    return float_max(look->width_u * (float)level->width, look->width_v * (float)level->height);
}

/* The level whose pixels are as large as the width, or less, and how much of the next. */
static int level_of(const TextureImage *image, const TextureLook *look, float *part)
{
    float pixels = texture_image_pixels_seen(image, look);
    *part = 0;
    if (!(pixels > 1)) return 0;
    float at = log2f(pixels), last = (float)(image->n_levels - 1);
    if (!(at < last)) return image->n_levels - 1;
    int whole = (int)at;
    *part = at - (float)whole;
    return whole;
}

/* Far out there are no parts of a picture any more. */
static TextureLook usable(const TextureLook *look)
{
    const double largest = 1e12, far = look->wrap == WRAP_ONCE ? -largest : 0;
    TextureLook at = *look;
    if (!(fabs(at.u) < largest)) at.u = far;
    if (!(fabs(at.v) < largest)) at.v = far;
    return at;
}

static Lanes add_color(Lanes sum, const Four *four, float weight, Lanes wavelength_nm)
{
    for (int i = 0; i < 4; i++)
        if (four->weight[i] > 0)
            sum = lanes_add(sum, lanes_scale(upsample_at(four->texel[i], wavelength_nm),
                                             weight * four->weight[i] * four->texel[i][3]));
    return sum;
}

void texture_image_add_color(const TextureImage *image, const TextureLook *look, float weight,
                             const Wavelengths *wavelengths, Lanes *sums)
{
    TextureLook at = usable(look);
    float part;
    if (at.wrap == WRAP_ONCE && !image->light) at.wrap = WRAP_CLAMP;
    int level = level_of(image, &at, &part);
    Four near = four_around(image, level, &at), far = near;
    if (part > 0) far = four_around(image, level + 1, &at);
    for (int k = 0; k < wavelengths->n; k++) {
        Lanes nm = wavelengths->nm[k], color = add_color(lanes_all(0), &near, 1 - part, nm);
        if (part > 0) color = add_color(color, &far, part, nm);
        if (image->light) color = lanes_mul(color, white_at(nm));
        sums[k] = lanes_add(sums[k], lanes_scale(color, weight));
    }
}

/* Where a part of the four is of nothing, vectors are those of a flat surface. */
static void add_numbers(float *values, const Four *four, float weight, uint32_t n)
{
    static const float flat[3] = {0.5f, 0.5f, 1};
    float left = 1;
    for (int i = 0; i < 4; i++) {
        left -= four->weight[i];
        for (uint32_t c = 0; c < n; c++) values[c] += weight * four->weight[i] * four->texel[i][c];
    }
    if (UNLIKELY(left > 1e-3f) && n == COUNT_OF(flat))
        for (uint32_t c = 0; c < n; c++) values[c] += weight * left * flat[c];
}

void texture_image_numbers(const TextureImage *image, const TextureLook *look, float *values)
{
    TextureLook at = usable(look);
    float part;
    int level = level_of(image, &at, &part);
    Four four = four_around(image, level, &at);
    for (uint32_t c = 0; c < image->n_channels; c++) values[c] = 0;
    add_numbers(values, &four, 1 - part, image->n_channels);
    if (!(part > 0)) return;
    four = four_around(image, level + 1, &at);
    add_numbers(values, &four, part, image->n_channels);
}
