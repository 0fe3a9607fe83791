/* relight.c - sums of layers over sums of layers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/relight.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/suggest.h"
#include "image/layer.h"

/* One channel of a layer: which of the colours it is of, and by what it is to be multiplied. */
typedef struct Part {
    uint32_t channel;
    int color;
    float factor;
} Part;

static const char *const colors[] = {"R", "G", "B"};

/* The colour of a channel that is of a layer of lights, and its group; -1: it is none. */
static int part_of_lights(const char *name, char group[IMAGE_NAME_SIZE])
{
    const char *dot = strrchr(name, '.');
    size_t before = strlen(LAYER_LIGHTS);
    if (strncmp(name, LAYER_LIGHTS, before) != 0 || dot < name + before) return -1;
    snprintf(group, IMAGE_NAME_SIZE, "%.*s", (int)(dot - name - (ptrdiff_t)before), name + before);
    for (int i = 0; i < 3; i++)
        if (strcmp(dot + 1, colors[i]) == 0) return i;
    return -1;
}

static uint32_t find_parts(const Image *image, const Relight *changes, size_t n, Part *parts)
{
    uint32_t n_parts = 0;
    for (uint32_t i = 0; i < image->n_channels; i++) {
        char group[IMAGE_NAME_SIZE];
        int color = part_of_lights(image->names[i], group);
        if (color < 0) continue;
        parts[n_parts] = (Part){i, color, 1};
        for (size_t k = 0; k < n; k++)
            if (strcmp(changes[k].group, group) == 0) parts[n_parts].factor = changes[k].factor[color];
        n_parts++;
    }
    return n_parts;
}

/* Every group that is to change must be there. */
static Status check_groups(const Image *image, const Relight *changes, size_t n, Error *error)
{
    char(*groups)[IMAGE_NAME_SIZE] = malloc(image->n_channels * sizeof *groups);
    const char **words = malloc(image->n_channels * sizeof *words);
    Status status = groups && words ? STATUS_OK : fail_memory(error, image->n_channels * sizeof *groups, "names");
    size_t n_words = 0;
    Buf list = {0};
    for (uint32_t i = 0; i < image->n_channels && status == STATUS_OK; i++) {
        if (part_of_lights(image->names[i], groups[n_words]) != 0) continue;
        buf_format(&list, "%s%s", n_words ? ", " : "", groups[n_words]);
        words[n_words] = groups[n_words];
        n_words++;
    }
    if (status == STATUS_OK && n_words == 0)
        status = fail(error, STATUS_INPUT,
                      "the picture has no layers of lights: give them a light_group, and render with '--aov lights'");
    for (size_t k = 0; k < n && status == STATUS_OK; k++) {
        size_t i = 0;
        while (i < n_words && strcmp(words[i], changes[k].group) != 0) i++;
        if (i < n_words) continue;
        const char *near = suggest_nearest(changes[k].group, words, n_words);
        status = fail(error, STATUS_INPUT, "the picture has no group of lights '%s', only: %s%s%s%s", changes[k].group,
                      buf_text(&list), near ? "; did you mean '" : "", near ? near : "", near ? "'?" : "");
    }
    buf_clear(&list);
    free(words);
    free(groups);
    return status;
}

/* A pixel's colours. Where no light was there are none to be multiplied. */
static void relight_pixel(float *pixel, const int channels[3], const Part *parts, uint32_t n)
{
    float before[3] = {0}, after[3] = {0};
    for (uint32_t i = 0; i < n; i++) {
        float part = pixel[parts[i].channel];
        before[parts[i].color] += part;
        after[parts[i].color] += part * parts[i].factor;
    }
    for (int i = 0; i < 3; i++)
        if (before[i] > 0) pixel[channels[i]] *= after[i] / before[i];
}

Status image_relight(Image *image, const Relight *changes, size_t n, Error *error)
{
    int channels[3];
    TRY(check_groups(image, changes, n, error));
    for (int i = 0; i < 3; i++) {
        channels[i] = image_channel(image, colors[i]);
        if (channels[i] < 0) return fail(error, STATUS_INPUT, "the picture has no channel '%s'", colors[i]);
    }
    Part *parts = malloc(image->n_channels * sizeof *parts);
    if (!parts) return fail_memory(error, image->n_channels * sizeof *parts, "layers of lights");
    uint32_t n_parts = find_parts(image, changes, n, parts);
    for (uint32_t y = 0; y < image->height; y++)
        for (uint32_t x = 0; x < image->width; x++) relight_pixel(image_at(image, x, y), channels, parts, n_parts);
    free(parts);
    return STATUS_OK;
}
