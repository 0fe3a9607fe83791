/* light_layers.c - pixel by pixel, colour by colour.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/light_layers.h"

#include <math.h>
#include <stdio.h>

#include "image/layer.h"
#include "render/caught.h"

LightLayers light_layers_of(const Image *image, const LightGroups *groups)
{
    char name[IMAGE_NAME_SIZE];
    snprintf(name, sizeof name, LAYER_LIGHTS "%s.R", groups->names[0]);
    int first = groups->n ? image_channel(image, name) : -1;
    return first < 0 ? (LightLayers){0, 0} : (LightLayers){(uint32_t)first, groups->n};
}

/* How much more light a pixel has in a colour than its layers add up to. */
static double more_than_layers(const LightLayers *layers, const float *pixel, int color)
{
    double sum = 0;
    for (uint32_t i = 0; i < layers->n; i++) sum += (double)pixel[layers->first + 3 * i + (uint32_t)color];
    return (double)pixel[color] - sum;
}

/* Takes light from the brightest layers of a pixel; taken: of each group. */
static void take_from_layers(const LightLayers *layers, float *pixel, int color, double light,
                             double taken[LIMIT_LIGHT_GROUPS])
{
    for (uint32_t turns = 0; turns < layers->n && light > 0; turns++) {
        uint32_t brightest = 0;
        float *parts = pixel + layers->first + color;
        for (uint32_t i = 1; i < layers->n; i++)
            if (parts[3 * i] > parts[3 * brightest]) brightest = i;
        double part = fmin(light, (double)parts[3 * brightest]);
        if (!(part > 0)) return;
        parts[3 * brightest] -= (float)part;
        taken[brightest] += part;
        light -= part;
    }
}

static void follow_in_color(const LightLayers *layers, Image *image, int color)
{
    double taken[LIMIT_LIGHT_GROUPS] = {0}, all = 0;
    const size_t n_pixels = (size_t)image->width * image->height;
    for (size_t i = 0; i < n_pixels; i++) {
        float *pixel = image->pixels + i * image->n_channels;
        double more = more_than_layers(layers, pixel, color);
        if (more < 0) take_from_layers(layers, pixel, color, -more, taken);
    }
    for (uint32_t k = 0; k < layers->n; k++) all += taken[k];
    for (size_t i = 0; i < n_pixels && all > 0; i++) {
        float *pixel = image->pixels + i * image->n_channels;
        double more = more_than_layers(layers, pixel, color);
        for (uint32_t k = 0; k < layers->n && more > 0; k++)
            pixel[layers->first + 3 * k + (uint32_t)color] += (float)(more * taken[k] / all);
    }
}

void light_layers_follow(const LightLayers *layers, Image *image)
{
    for (int color = 0; color < 3 && layers->n > 0; color++) follow_in_color(layers, image, color);
}

void light_layers_give_up(const LightLayers *layers, const Image *caught, Image *image)
{
    const size_t n_pixels = (size_t)image->width * image->height;
    for (size_t i = 0; i < n_pixels && layers->n > 0; i++) {
        const float *bare = caught->pixels + i * caught->n_channels + CAUGHT_BARE;
        float *pixel = image->pixels + i * image->n_channels;
        if (!(fmaxf(bare[0], fmaxf(bare[1], bare[2])) > 0)) continue;
        for (int color = 0; color < 3; color++) {
            double whole = (double)pixel[color], sum = whole - more_than_layers(layers, pixel, color);
            float left = sum > 0 ? (float)(whole / sum) : 0;
            for (uint32_t k = 0; k < layers->n; k++) pixel[layers->first + 3 * k + (uint32_t)color] *= left;
        }
    }
}
