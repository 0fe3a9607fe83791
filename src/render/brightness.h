/* brightness.h - how often which luminance occurs in a picture, and by how much it is to be brightened for a display.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BRIGHTNESS_H
#define MEN_BRIGHTNESS_H

#include "base/exposure.h"
#include "image/image.h"

/* Bands of a quarter of a stop. A luminance of 1 is where their upper half begins. */
enum { BRIGHTNESS_BANDS_OF_STOP = 4, BRIGHTNESS_STOPS = 64 };
enum { BRIGHTNESS_BANDS = 2 * BRIGHTNESS_STOPS * BRIGHTNESS_BANDS_OF_STOP };

typedef struct Brightness {
    size_t n, n_of[BRIGHTNESS_BANDS]; /* pixels: all, and those of each band */
    double mean;                      /* luminance */
} Brightness;

/* Notes a pixel's luminance. */
void brightness_note(Brightness *brightness, double luminance);
/* Of a scene-linear picture that is brightened by so many stops: of the pixels in which something is, where it has an alpha. A
 * picture without colours has no pixels. */
Brightness brightness_find(const Image *image, double stops);
/* The luminance where the band begins that holds the pixel which has this part of all below it. */
double brightness_at(const Brightness *brightness, double part);
/* The stops by which the picture is to be brightened so that it is well seen on a display, in quarters: 0 where it is black.
 *
 * What counts are the highlights, as with slide film: 2 % of the picture are left to be white or brighter. As long as much of it
 * would be dark then, 5 stops below white or more, it is brightened further, until what is white is worth as much: one pixel as
 * much as some seven that are dark. So white walls stay white, a lamp or a window does not leave its room black, and what lies
 * before a dark ground is seen, and the ground hardly. A meter that goes by the mean of the logarithm (E. Reinhard et al.,
 * "Photographic Tone Reproduction for Digital Images", ACM TOG 21(3) (2002), section 2) makes all three grey. */
double brightness_stops(const Brightness *brightness);
/* The luminance that is white where a picture of this brightness is so exposed. */
double brightness_white(const Brightness *brightness, Exposure exposure);

#endif
