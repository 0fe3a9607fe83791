/* image.h - pictures in memory, EXR, PNG, JPEG and Radiance's files.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_IMAGE_H
#define MEN_IMAGE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "base/pool.h"
#include "base/status.h"

enum { IMAGE_NAME_SIZE = 64 }; /* of a channel's name, with its end */

/* Interleaved float channels, row 0 at the top. Owns its arrays (malloc). */
typedef struct Image {
    uint32_t width, height, n_channels;
    char (*names)[IMAGE_NAME_SIZE]; /* "R", "G", "B", "A", "noise.Y", ... */
    float *pixels;                  /* width * height * n_channels */
} Image;

/* Where a picture lies that is a part of a larger one: its first pixel, and how large the whole is. */
typedef struct ImagePlace {
    uint32_t x, y, width, height;
} ImagePlace;

typedef enum AttributeType { ATTRIBUTE_TEXT, ATTRIBUTE_INT, ATTRIBUTE_FLOAT } AttributeType;
typedef struct ImageAttribute {
    const char *name;
    AttributeType type;
    const char *text;
    int whole;
    double number;
} ImageAttribute;

typedef struct ExrOptions {
    bool half;                        /* R, G, B, A as half; all other channels are float in any case */
    const float *chromaticities;      /* red xy, green xy, blue xy, white xy; NULL: Rec.709, D65 */
    const ImageAttribute *attributes; /* the render's settings: "meniscus/samples", ... */
    size_t n_attributes;
    float pixel_aspect; /* 0: 1 */
    const ImagePlace
        *place; /* of the picture, as a data window in the whole, which it lies in; NULL: it is the whole */
    /* Writes more bytes behind the picture, which readers of EXR files do not look at; NULL: none. */
    Status (*append)(void *context, FILE *stream, Error *error);
    void *append_context;
    Pool *pool; /* compresses; the file is the same for any number of threads. NULL: one thread */
} ExrOptions;

/* Dimensions are 1..65536 each, channels 1..1024; STATUS_NOMEM otherwise fits memory or not. */
ATTR_NODISCARD Status image_new(uint32_t width, uint32_t height, const char *const *names, uint32_t n_channels,
                                Image *image, Error *error);
/* The same, with the channels of another. */
ATTR_NODISCARD Status image_new_like(const Image *like, uint32_t width, uint32_t height, Image *image, Error *error);
void image_clear(Image *image);
/* The channels of a pixel. */
static inline float *image_at(const Image *image, uint32_t x, uint32_t y)
{
    return image->pixels + ((size_t)y * image->width + x) * image->n_channels;
}
/* What a display shows, 0..1, in eight bits. */
static inline unsigned image_byte(float shown)
{
    return (unsigned)(shown > 0 ? lrintf(255 * fminf(shown, 1)) : 0);
}
/* Takes away all pixels but those from crop[0], crop[1] up to but without crop[2], crop[3], of which there are some. */
void image_crop(Image *image, const uint32_t crop[4]);
/* Makes a part the whole, which is 0 beyond it. STATUS_NOMEM; the image is then as it was. */
ATTR_NODISCARD Status image_expand(Image *image, const ImagePlace *place, Error *error);
/* Copies n channels, from `first` on, to those from `at` on of an image of the same size. */
void image_copy_channels(const Image *from, uint32_t first, uint32_t n, Image *to, uint32_t at);
/* The index of a channel, -1 when there is none. */
int image_channel(const Image *image, const char *name);
/* The channels that hold the colour: R, G, B; else those of the first layer that has them (layer.R ...); else
 * Y three times. false when there is no colour. */
bool image_rgb(const Image *image, int rgb[3]);
/* sRGB's curve undone on the colour channels: from what png_read and jpeg_read give to linear Rec.709. */
void image_decode_srgb(Image *image);

/* Scan lines, ZIPS compression, chromaticities and attributes; written beside its place and renamed when whole.
 * STATUS_OUTPUT with the reason; what stood there before is then untouched. "-" is standard output. */
ATTR_NODISCARD Status exr_write(const char *path, const Image *image, const ExrOptions *options, Error *error);
/* The first part, all channels as float; scan lines or tiles (full resolution), data window placed in the
 * display window (outside of it 0). STATUS_INPUT. */
ATTR_NODISCARD Status exr_read(const char *path, Image *image, Error *error);
/* The same, but only what the data window has of the display window; STATUS_INPUT where that is nothing. */
ATTR_NODISCARD Status exr_read_part(const char *path, Image *image, ImagePlace *place, Error *error);
/* The attribute's text or number as text, into a malloc'd string; NULL text when it has none. */
ATTR_NODISCARD Status exr_read_attribute(const char *path, const char *name, char **text, Error *error);
/* Every attribute of the first part in the file's order, as text: windows, channels with their types, compression,
 * chromaticities and all that programs added. Attributes of types with no short text say their type and size.
 * STATUS_INPUT, when all is said, for a file that is cut short. */
ATTR_NODISCARD Status exr_visit_attributes(const char *path,
                                           void (*visit)(void *context, const char *name, const char *text),
                                           void *context, Error *error);
/* Those of them that programs added as texts, whole numbers and floats, as exr_write takes them. Names and texts are good while
 * visited. */
ATTR_NODISCARD Status exr_visit_own_attributes(const char *path,
                                               void (*visit)(void *context, const ImageAttribute *attribute),
                                               void *context, Error *error);

/* 8 or 16 bits per channel; rgb or rgba display-referred floats in 0..1, quantized with rounding (16) or
 * rounding plus a fixed ordered dither (8, so that gradients do not band). Atomic, as exr_write. */
ATTR_NODISCARD Status png_write(const char *path, const Image *image, unsigned bits, Error *error);
ATTR_NODISCARD Status png_read(const char *path, Image *image, Error *error);
/* 8 bits, grey or colour, baseline or progressive, as display-referred R, G, B in 0..1; upright where a camera notes
 * how it was held (exif.h). STATUS_INPUT for CMYK, and for files that are damaged or cut short. */
ATTR_NODISCARD Status jpeg_read(const char *path, Image *image, Error *error);
/* Radiance's pictures (.hdr): mantissas and exponents (RGBE, XYZE), flat or in runs, in any of the eight orders of lines and places.
 * As linear R, G, B, divided by EXPOSURE and COLORCORR; what has other PRIMARIES than Rec.709's, or X, Y, Z, is brought to these, white
 * to white, and not below 0. Pixels are taken as square. STATUS_INPUT for files that are damaged, cut short or of another FORMAT. */
ATTR_NODISCARD Status hdr_read(const char *path, Image *image, Error *error);
/* Every line "name=text" of the header, in order. */
typedef void HdrVisit(void *context, const char *name, const char *text);
ATTR_NODISCARD Status hdr_visit_header(const char *path, HdrVisit *visit, void *context, Error *error);
/* By content, then extension: EXR, PNG, JPEG, Radiance's. *encoded (may be NULL): whether its values are a display's, as those of PNG
 * and JPEG, rather than linear. */
ATTR_NODISCARD Status image_read_as(const char *path, Image *image, bool *encoded, Error *error);
/* The same without that. */
ATTR_NODISCARD Status image_read(const char *path, Image *image, Error *error);

#endif
