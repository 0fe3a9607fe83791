/* relight.h - a picture as it would be with brighter, darker or coloured lights, by its layers of groups of lights.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RELIGHT_H
#define MEN_RELIGHT_H

#include "image/image.h"

/* What a group of lights is to be, of its red, green and blue. */
typedef struct Relight {
    const char *group;
    float factor[3];
} Relight;

/* Colours of the picture become what all its layers lights.GROUP.R, .G and .B come to by these factors, which are 1 of groups that are not
 * named, over what they come to as they are. So what was denoised stays so, and noise that layers have in common is
 * not seen. Of several for one group the last one counts. STATUS_INPUT where there are no such layers, or none of a name. */
ATTR_NODISCARD Status image_relight(Image *image, const Relight *changes, size_t n, Error *error);

#endif
