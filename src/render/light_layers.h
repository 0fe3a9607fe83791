/* light_layers.h - layers of what groups of lights light, as sums of samples made them, and a picture that something else was done to.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LIGHT_LAYERS_H
#define MEN_LIGHT_LAYERS_H

#include "image/image.h"
#include "scene/light_groups.h"

/* Where the layers of groups are among an image's channels, three of each in a row. n: of groups; 0: there are none. */
typedef struct LightLayers {
    uint32_t first, n;
} LightLayers;

LightLayers light_layers_of(const Image *image, const LightGroups *groups);
/* Spreading single bright samples took light from pixels, the image's first three channels, and gave it to others. Here the layers
 * follow, so that they add up to the picture again: what a pixel lost is taken from its brightest layer, and then the next, as it
 * is one group's light that was so bright; and what pixels got is each group's in the proportion in which all were taken from. No group has
 * more or less light afterwards, but for rounding. */
void light_layers_follow(const LightLayers *layers, Image *image);
/* A shadow catcher leaves only a part of its light in the picture: from what its pixels have in their layers all groups give up the same
 * part, so that they add up to the picture. caught: of each pixel, as caught_means has it. */
void light_layers_give_up(const LightLayers *layers, const Image *caught, Image *image);

#endif
