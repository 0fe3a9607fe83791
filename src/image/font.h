/* font.h - a small face of 5 by 7 pixels, with descenders of 2, for what is written into pictures. ASCII and
 * the sign of micro; everything else is a question mark.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FONT_H
#define MEN_FONT_H

#include "image/image.h"

enum { FONT_ADVANCE = 6, FONT_HEIGHT = 9 }; /* pixels, at scale 1 */

/* How wide a text in UTF-8 is, in pixels. */
uint32_t font_width(const char *text, unsigned scale);
/* Draws it with its upper left corner at x, y, into the first three channels; what is outside of the picture is cut. */
void font_draw(Image *image, uint32_t x, uint32_t y, unsigned scale, const char *text, const float rgb[3]);

#endif
