/* view.h - colour management: from scene-linear pictures to what a display shows, and from the colour
 * spaces of inputs to the working space. Behind it OpenColorIO (ocio.cpp).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VIEW_H
#define MEN_VIEW_H

#include "base/exposure.h"
#include "image/image.h"

typedef struct ColorConfig ColorConfig;

/* config: a path (--ocio), or NULL for $OCIO when it is set, else the built-in configuration, which needs
 * no installation. STATUS_INPUT with OpenColorIO's reason. */
ATTR_NODISCARD Status color_config_open(const char *config, ColorConfig **out, Error *error);
void color_config_close(ColorConfig *config);

/* Names, for checking and listing. index past the end: NULL. The strings are the config's. */
const char *color_config_display(const ColorConfig *config, int index);
const char *color_config_view(const ColorConfig *config, const char *display, int index);
const char *color_config_default_display(const ColorConfig *config);
const char *color_config_default_view(const ColorConfig *config, const char *display);

/* How light is shown. */
typedef struct ColorLook {
    const char *display, *view; /* NULL: the defaults */
    Exposure exposure;          /* before that; an automatic one is found by output_look_for() of cli/output.h first */
    double white_balance; /* before that, by image_for_display() of cli/output.h: of which light is white, K; 0: none */
    bool alpha;           /* a picture for a display keeps its alpha, and is not over black */
} ColorLook;

/* Applies that to R, G, B (and keeps A) of a scene-linear picture of the
 * working space (linear Rec.709, D65); the result is display-referred in 0..1. Not-a-numbers become 0, values are held to
 * 65504 first. Alpha is not looked at, look->alpha neither: where colours are multiplied by it, the output is over black.
 * STATUS_USAGE names an unknown display or view, and the nearest that there is, or all where none is near. */
ATTR_NODISCARD Status color_view(const ColorConfig *config, const ColorLook *look, Image *image, Error *error);
/* In place: rgb triples from a named colour space to linear Rec.709 (D65), the working space. */
ATTR_NODISCARD Status color_to_working(const ColorConfig *config, const char *space, float *rgb, size_t n_pixels,
                                       Error *error);

#endif
