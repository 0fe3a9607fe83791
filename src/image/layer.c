/* layer.c - which channels a layer has, and how its numbers become what can be seen.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/layer.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 3 };

/* Channels far above this many times what nearly all pixels stay below would leave the rest black. */
#define FAR_LARGER 2.0f
#define NEARLY_ALL 0.99
/* Depths of a ground that goes on to the horizon have no few that are far larger, but ever more: where half of them are
 * within this part of the way to white, white is as far behind the middle one as leaves that a quarter. */
#define MOSTLY_NEAR 0.125f
#define QUARTER 0.25f
/* Directions are this long at most: means of unit vectors, rounded. */
#define LONGEST_DIRECTION 1.001f

/* Neither near nor far, nor any grey. */
static const float hole_color[MOST] = {0.05f, 0.05f, 0.4f};

/* The channels of a layer, in their order. */
typedef struct Channels {
    int at[MOST];
    int n;
} Channels;

/* NAME.a, NAME.b, ... of the letters. */
static bool find_lettered(const Image *image, const char *name, const char *letters, Channels *channels)
{
    size_t length = strlen(name);
    char whole[LAYER_NAME_SIZE];
    if (length + 2 >= sizeof whole) return false;
    memcpy(whole, name, length);
    whole[length] = '.';
    whole[length + 2] = 0;
    channels->n = (int)strlen(letters);
    for (int i = 0; i < channels->n; i++) {
        whole[length + 1] = letters[i];
        channels->at[i] = image_channel(image, whole);
        if (channels->at[i] < 0) return false;
    }
    return true;
}

/* false: there is no such layer. */
static bool find_channels(const Image *image, const char *name, Channels *channels)
{
    if (find_lettered(image, name, "RGB", channels) || find_lettered(image, name, "XYZ", channels) ||
        find_lettered(image, name, "UV", channels))
        return true;
    *channels = (Channels){{image_channel(image, name)}, 1};
    return channels->at[0] >= 0;
}

bool layer_is_in(const Image *image, const char *name)
{
    Channels unused;
    return find_channels(image, name, &unused);
}

void layer_of_channel(const Image *image, uint32_t channel, char name[LAYER_NAME_SIZE])
{
    memcpy(name, image->names[channel], LAYER_NAME_SIZE);
    char *dot = strrchr(name, '.');
    if (!dot) return;
    *dot = 0;
    if (!layer_is_in(image, name)) *dot = '.';
}

static int compare_floats(const void *left, const void *right)
{
    float a = *(const float *)left, b = *(const float *)right;
    return (a > b) - (a < b);
}

static bool is_something(float value)
{
    return isfinite(value) && fabsf(value) < LAYER_NOTHING;
}

/* Is it the one channel of a depth, which EXR files call Z? */
static bool is_depth(const Image *image, const Channels *channels)
{
    const char *name = image->names[channels->at[0]], *dot = strrchr(name, '.');
    return channels->n == 1 && strcmp(dot ? dot + 1 : name, "Z") == 0;
}

/* From black to white. */
static Status find_range(const Image *image, const Channels *channels, Layer *layer, Error *error)
{
    size_t pixels = (size_t)image->width * image->height, size = pixels * (size_t)channels->n * sizeof(float), n = 0;
    float *values = malloc(size);
    if (!values) return fail_memory(error, size, "the numbers of a layer");
    for (size_t i = 0; i < pixels; i++)
        for (int k = 0; k < channels->n; k++) {
            float value = image->pixels[i * image->n_channels + (size_t)channels->at[k]];
            if (is_something(value)) values[n++] = value;
        }
    qsort(values, n, sizeof *values, compare_floats);
    if (n > 0) {
        float most = values[n - 1], nearly = values[(size_t)((double)(n - 1) * NEARLY_ALL)];
        layer->black = values[0];
        layer->held = most - layer->black > FAR_LARGER * (nearly - layer->black) && nearly > layer->black;
        layer->white = layer->held ? nearly : most;
        float middle = values[n / 2] - layer->black;
        if (is_depth(image, channels) && middle > 0 && middle < MOSTLY_NEAR * (layer->white - layer->black)) {
            layer->held = true;
            layer->white = layer->black + middle / QUARTER;
        }
    }
    free(values);
    return STATUS_OK;
}

static bool are_directions(const Image *image, const Channels *channels)
{
    for (size_t i = 0; i < (size_t)image->width * image->height; i++) {
        float squares = 0;
        for (int k = 0; k < channels->n; k++) {
            float value = image->pixels[i * image->n_channels + (size_t)channels->at[k]];
            squares += value * value;
        }
        if (!(squares <= LONGEST_DIRECTION * LONGEST_DIRECTION)) return false;
    }
    return true;
}

static float shown(const Layer *layer, float value)
{
    switch (layer->kind) {
    case LAYER_COLOR: return value;
    case LAYER_DIRECTION: return 0.5f + 0.5f * value;
    case LAYER_NUMBERS: break;
    }
    if (!(layer->white > layer->black)) return 0.5f;
    return fminf((value - layer->black) / (layer->white - layer->black), 1);
}

/* Which of the layer's channels is red, green, blue; -1: none, it is black. */
static int channel_for(const Channels *channels, int color)
{
    if (channels->n == 1) return channels->at[0];
    return color < channels->n ? channels->at[color] : -1;
}

/* Whether a pixel has a number in each of the layer's channels. */
static bool is_whole(const float *pixel, const Channels *channels)
{
    bool whole = true;
    for (int k = 0; k < channels->n; k++) whole = whole && is_something(pixel[channels->at[k]]);
    return whole;
}

static void show_pixel(Layer *layer, const float *pixel, const Channels *channels, float *out)
{
    bool hole = layer->kind == LAYER_NUMBERS && !is_whole(pixel, channels);
    layer->has_holes = layer->has_holes || hole;
    for (int color = 0; color < MOST; color++) {
        int channel = channel_for(channels, color);
        out[color] = hole ? hole_color[color] : channel < 0 ? 0 : shown(layer, pixel[channel]);
    }
}

static LayerKind kind_of(const Image *image, const Channels *channels)
{
    if (channels->n < MOST) return LAYER_NUMBERS;
    const char *name = image->names[channels->at[0]];
    if (name[strlen(name) - 1] == 'R') return LAYER_COLOR;
    return are_directions(image, channels) ? LAYER_DIRECTION : LAYER_NUMBERS;
}

Status layer_of(const Image *image, const char *name, Layer *layer, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    Channels channels;
    *layer = (Layer){.kind = LAYER_COLOR};
    if (!find_channels(image, name, &channels)) return fail(error, STATUS_INPUT, "the picture has no layer '%s'", name);
    layer->kind = kind_of(image, &channels);
    if (layer->kind == LAYER_NUMBERS) TRY(find_range(image, &channels, layer, error));
    TRY(image_new(image->width, image->height, names, COUNT_OF(names), &layer->image, error));
    for (size_t i = 0; i < (size_t)image->width * image->height; i++)
        show_pixel(layer, &image->pixels[i * image->n_channels], &channels, &layer->image.pixels[i * MOST]);
    return STATUS_OK;
}

void layer_clear(Layer *layer)
{
    image_clear(&layer->image);
}
