/* layer.h - one layer of a picture by itself, as it can be seen.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LAYER_H
#define MEN_LAYER_H

#include "image/image.h"

typedef enum LayerKind {
    LAYER_COLOR,     /* scene-linear, still to be brought to a display */
    LAYER_DIRECTION, /* X, Y and Z as red, green and blue, -1 as 0 and 1 as 1: as a display shows it */
    LAYER_NUMBERS    /* in relation to each other, from 0, black, to 1, white: as a display shows it */
} LayerKind;

typedef struct Layer {
    LayerKind kind;
    float black,
        white;      /* of LAYER_NUMBERS: which numbers become that. Equal where all are the same, which is grey then */
    bool held;      /* of these: more than white is white, too */
    bool has_holes; /* of these: some pixels have no number, and a colour that no number has: dark blue */
    Image image;    /* R, G, B */
} Layer;

/* A layer is the channels NAME.R, NAME.G and NAME.B, or .X, .Y and .Z, or .U and .V, or the one channel NAME. */
enum { LAYER_NAME_SIZE = IMAGE_NAME_SIZE };
/* What the names of layers begin with that are the light of a group of lights. */
#define LAYER_LIGHTS "lights."
bool layer_is_in(const Image *image, const char *name);
/* The layer that a channel belongs to: all that there are, some of them several times. */
void layer_of_channel(const Image *image, uint32_t channel, char name[LAYER_NAME_SIZE]);

/* Of numbers the least is black; white is the largest, or where a few are far larger, what 99 of 100 do not exceed, and of a
 * depth whose half is far nearer than that, a number that leaves the middle one a quarter of the way. What is not
 * finite, or so large that it stands for nothing at all, does not count, and its pixel is dark blue.
 * STATUS_INPUT where the picture has no layer of that name; STATUS_NOMEM. */
#define LAYER_NOTHING 1e29f
ATTR_NODISCARD Status layer_of(const Image *image, const char *name, Layer *layer, Error *error);
void layer_clear(Layer *layer);

#endif
