/* build_picture.c - the pictures that textures are made of: read once however many surfaces have them, and checked.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/hash.h"
#include "diag/limits.h"
#include "scene/build_parts.h"

/* A texture's picture as it is wanted: what makes two of one file different. */
typedef struct PictureWish {
    const char *path;
    const char *space; /* as SceneImageLoader takes it */
    TextureUse use;
    int channel; /* of numbers: -1 for the mean, else 0 .. 2 */
    bool clip;
    bool once; /* of colours: those of pixels with an alpha of 0 count for nothing */
} PictureWish;

static const char *wish_key(Builder *b, const PictureWish *wish)
{
    return arena_format(b->arena, "%d %d %d %d %d %s %s", (int)wish->use, wish->channel, wish->clip, wish->once,
                        wish->space != NULL, wish->space ? wish->space : "", wish->path);
}

/* ---- pixels ---- */

typedef struct Pixels {
    float *rgb; /* malloc'd; changed in place */
    uint32_t width, height;
} Pixels;

static const char *const channel_names[] = {"red", "green", "blue"};

static void report_pixel(Builder *b, Span span, const char *path, const Pixels *pixels, size_t at, const char *wanted)
{
    size_t pixel = at / 3;
    double value = (double)pixels->rgb[at];
    Diagnostic *report = diag_report(b->diag, D_IMAGE_INVALID, span,
                                     "'%s' has %s %g in the %s of pixel <%zu, %zu> (from the top left), %s", path,
                                     isfinite(value) ? "the value" : "no number but", value, channel_names[at % 3],
                                     pixel % pixels->width, pixel / pixels->width, wanted);
    if (!isfinite(value))
        diag_hint(b->diag, report, "mend the picture; clip = true takes such a pixel as 0");
    else
        diag_hint(b->diag, report, "clip = true holds all values to 0..1; data are read with colorspace = \"raw\"");
}

/* Holds pixels to what can be used, or reports the first that is not. Conversions of colours round. */
static bool check_pixels(Builder *b, Span span, const PictureWish *wish, Pixels *pixels)
{
    const float slack = 1e-3f, brightest = 1e30f;
    bool color = wish->use == TEXTURE_OF_COLORS, light = wish->use == TEXTURE_OF_LIGHT;
    size_t n = (size_t)pixels->width * pixels->height * 3;
    for (size_t i = 0; i < n; i++) {
        float *value = &pixels->rgb[i];
        bool fine = isfinite(*value) && (!color || (*value >= -slack && *value <= 1 + slack));
        fine = fine && (!light || (*value >= -slack && *value <= brightest));
        if (!fine && !wish->clip) {
            report_pixel(b, span, wish->path, pixels, i,
                         color   ? "and what a surface reflects is in 0..1"
                         : light ? "and light is in 0..1e30"
                                 : "and a texture needs finite numbers");
            return false;
        }
        if (!color && !light && !wish->clip) continue;
        if (!(*value > 0)) *value = 0; /* also what is no number */
        if (*value > 1 && (color || wish->clip)) *value = 1;
    }
    return true;
}

/* One number to a pixel, in place. */
static void take_channel(Pixels *pixels, int channel)
{
    size_t n = (size_t)pixels->width * pixels->height;
    for (size_t i = 0; i < n; i++) {
        const float *rgb = pixels->rgb + 3 * i;
        bool grey = rgb[0] == rgb[1] && rgb[1] == rgb[2];
        pixels->rgb[i] = channel >= 0 ? rgb[channel] : grey ? rgb[0] : (rgb[0] + rgb[1] + rgb[2]) / 3;
    }
}

/* ---- colours of what is not there ---- */

/* A mask of three numbers to a pixel, as the loader has it: whether the first is 0. */
static bool is_unseen(const Pixels *mask, size_t pixel)
{
    return !(mask->rgb[3 * pixel] > 0);
}

/* The mean of what is seen of each four pixels; of none, nothing is seen. */
static void halve_seen(const Pixels *colors, const Pixels *mask, Pixels *half_colors, Pixels *half_mask)
{
    for (uint32_t y = 0; y < half_mask->height; y++)
        for (uint32_t x = 0; x < half_mask->width; x++) {
            float sum[3] = {0, 0, 0}, n = 0;
            for (uint32_t i = 0; i < 4; i++) {
                uint32_t column = 2 * x + (i & 1), row = 2 * y + (i >> 1);
                size_t from = (size_t)row * mask->width + column;
                if (column >= mask->width || row >= mask->height || is_unseen(mask, from)) continue;
                for (int c = 0; c < 3; c++) sum[c] += colors->rgb[3 * from + (size_t)c];
                n++;
            }
            size_t to = (size_t)y * half_mask->width + x;
            for (int c = 0; c < 3; c++) half_colors->rgb[3 * to + (size_t)c] = n > 0 ? sum[c] / n : 0;
            half_mask->rgb[3 * to] = n;
        }
}

/* Pixels of which nothing is seen have any colour, black mostly, which would make a dark line around what is seen where both are
 * filtered. They get that of their surroundings, the nearer the finer: from a picture of half the size, where that has any. */
static Status fill_unseen(Pixels *colors, const Pixels *mask, Error *error)
{
    uint32_t width = (mask->width + 1) / 2, height = (mask->height + 1) / 2;
    size_t n = (size_t)mask->width * mask->height, n_unseen = 0, size = (size_t)width * height * 3 * sizeof(float);
    for (size_t i = 0; i < n; i++) n_unseen += is_unseen(mask, i);
    if (n_unseen == 0 || n_unseen == n) return STATUS_OK;
    Pixels half_colors = {malloc(size), width, height}, half_mask = {malloc(size), width, height};
    Status status = half_colors.rgb && half_mask.rgb ? STATUS_OK : fail_memory(error, size, "a picture");
    if (status == STATUS_OK) {
        halve_seen(colors, mask, &half_colors, &half_mask);
        status = fill_unseen(&half_colors, &half_mask, error);
    }
    for (size_t i = 0; status == STATUS_OK && i < n; i++)
        if (is_unseen(mask, i))
            memcpy(colors->rgb + 3 * i, half_colors.rgb + 3 * (i / mask->width / 2 * width + i % mask->width / 2),
                   3 * sizeof(float));
    free(half_colors.rgb);
    free(half_mask.rgb);
    return status;
}

/* Colours of EXR files are multiplied by alpha. */
static void divide_by_alpha(Pixels *colors, const Pixels *mask)
{
    size_t n = (size_t)mask->width * mask->height;
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3 && !is_unseen(mask, i); c++) colors->rgb[3 * i + (size_t)c] /= mask->rgb[3 * i];
}

/* ---- reading ---- */

static bool fits(Builder *b, Span span, const PictureWish *wish, const Pixels *pixels)
{
    double bytes = texture_image_bytes(wish->use == TEXTURE_OF_NUMBERS ? 1 : 3, pixels->width, pixels->height);
    double most = LIMIT_PICTURES_MB * 1048576.0;
    if (b->picture_bytes + bytes > most) {
        Diagnostic *report = diag_report(
            b->diag, D_LIMIT, span, "'%s' of %u by %u pixels needs %.0f MB, and the pictures of a scene may have %d MB",
            wish->path, pixels->width, pixels->height, bytes / 1048576, LIMIT_PICTURES_MB);
        diag_hint(b->diag, report, "make the picture smaller");
        return false;
    }
    b->picture_bytes += bytes;
    return true;
}

/* While the shutter is open it is only asked whether there is another picture: one pixel stands for all. */
static Status load_stand_in(Pixels *pixels, Error *error)
{
    pixels->rgb = malloc(3 * sizeof *pixels->rgb);
    if (!pixels->rgb) return fail_memory(error, 3 * sizeof *pixels->rgb, "a picture");
    for (int c = 0; c < 3; c++) pixels->rgb[c] = 0.5f;
    pixels->width = pixels->height = 1;
    return STATUS_OK;
}

static Status load(Builder *b, const PictureWish *wish, Pixels *pixels, Error *error)
{
    if (build_is_later(b)) return load_stand_in(pixels, error);
    if (!b->options->load_image) return fail(error, STATUS_INPUT, "images cannot be read here");
    TRY(b->options->load_image(b->options->load_image_context, wish->path, wish->space, &pixels->rgb, &pixels->width,
                               &pixels->height, error));
    if (pixels->width && pixels->height) return STATUS_OK;
    free(pixels->rgb);
    return fail(error, STATUS_INPUT, "'%s' has no pixels", wish->path);
}

static Status load_once(Builder *b, const PictureWish *wish, Pixels *pixels, Error *error)
{
    Pixels mask = {0};
    PictureWish of_mask = *wish;
    of_mask.space = SCENE_SPACE_ALPHA;
    TRY(load(b, wish, pixels, error));
    if (!wish->once || build_is_later(b)) return STATUS_OK;
    Status status = load(b, &of_mask, &mask, error);
    bool alike = status == STATUS_OK && mask.width == pixels->width && mask.height == pixels->height;
    if (alike && strcasecmp(file_extension(wish->path), "exr") == 0) divide_by_alpha(pixels, &mask);
    if (alike) status = fill_unseen(pixels, &mask, error);
    free(mask.rgb);
    if (status == STATUS_OK) return STATUS_OK;
    free(pixels->rgb);
    *pixels = (Pixels){0};
    return status;
}

static TextureImage *new_picture(Builder *b, Span span, const PictureWish *wish)
{
    Error error;
    Pixels pixels = {0};
    TextureImage *image = NULL;
    Status status = load_once(b, wish, &pixels, &error);
    if (status == STATUS_OK && check_pixels(b, span, wish, &pixels) && fits(b, span, wish, &pixels)) {
        if (wish->use == TEXTURE_OF_NUMBERS) take_channel(&pixels, wish->channel);
        status = wish->use == TEXTURE_OF_COLORS || wish->use == TEXTURE_OF_LIGHT
                     ? (wish->use == TEXTURE_OF_LIGHT ? texture_image_new_light : texture_image_new_colors)(
                           pixels.rgb, pixels.width, pixels.height, &image, &error)
                     : texture_image_new_numbers(pixels.rgb, wish->use == TEXTURE_OF_VECTORS ? 3 : 1, pixels.width,
                                                 pixels.height, &image, &error);
    }
    if (status == STATUS_NOMEM)
        build_succeeded(b, status, &error, span);
    else if (status != STATUS_OK)
        diag_report(b->diag, D_IMAGE_INVALID, span, "%s", error.text);
    if (pixels.width && pixels.height) free(pixels.rgb);
    return image;
}

const TextureImage *build_texture_image(Builder *b, const EvalNode *node, TextureUse use, uint64_t *source)
{
    Scene *scene = b->scene;
    const EvalProp *file = eval_prop(node, "file"), *space = eval_prop(node, "colorspace");
    const char *word = eval_word(node, "channel");
    if (!file) return NULL; /* reported */
    PictureWish wish = {.use = use, .channel = -1, .clip = eval_truth(node, "clip")};
    wish.once = use == TEXTURE_OF_COLORS && strcmp(eval_word(node, "wrap"), "once") == 0;
    wish.path = file->as.text;
    if (use == TEXTURE_OF_NUMBERS) {
        for (int c = 0; c < 3; c++)
            if (strcmp(word, channel_names[c]) == 0) wish.channel = c;
        wish.space = SCENE_SPACE_DATA;
    } else {
        build_needs(b, node, "channel", "where all channels are taken");
        if (use == TEXTURE_OF_VECTORS) wish.space = SCENE_SPACE_DATA;
    }
    if (space) wish.space = strcmp(space->as.text, "raw") == 0 ? SCENE_SPACE_DATA : space->as.text;
    if (use == TEXTURE_OF_NUMBERS && strcmp(word, "alpha") == 0) wish.space = SCENE_SPACE_ALPHA;
    const char *key = wish_key(b, &wish);
    *source = hash_bytes(key, strlen(key), 0);
    if (!build_is_later(b)) {
        wish.path = eval_find_file(&b->eval_options, b->diag, file->span, file->as.text);
        if (!wish.path) return NULL;
        key = wish_key(b, &wish);
    }
    const uint32_t *known = map_seek(&b->pictures, key, strlen(key));
    if (known) return *known == SCENE_NONE ? NULL : scene->images[*known];
    if (!build_is_later(b)) build_note_file(b, wish.path);
    scene->images =
        room_for_one(b->arena, scene->images, scene->n_images, &b->pictures_capacity, sizeof *scene->images);
    uint32_t *row = map_find(b->arena, &b->pictures, key, strlen(key), SCENE_NONE);
    TextureImage *image = new_picture(b, file->span, &wish);
    if (!image) return NULL;
    *row = scene->n_images;
    scene->images[scene->n_images++] = image;
    return image;
}
