/* exif.h - how a camera was held, as it notes it in its pictures.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EXIF_H
#define MEN_EXIF_H

#include "image/image.h"

/* Exif's tag "Orientation" (CIPA DC-008-2019, section 4.6.5): 1 to 8; 1, upright, also where none is noted that can be read.
 * bytes: those of the segment APP1 of a JPEG file. */
unsigned exif_orientation(const unsigned char *bytes, size_t n);

/* Turns a picture that is stored so, that it is upright. STATUS_NOMEM leaves it as it is. */
ATTR_NODISCARD Status image_turn_upright(Image *image, unsigned orientation, Error *error);

#endif
