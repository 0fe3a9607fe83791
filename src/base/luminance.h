/* luminance.h - the luminance of colours of the working space, linear Rec.709 (ITU-R BT.709-6, item 3.2).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LUMINANCE_H
#define MEN_LUMINANCE_H

static inline double luminance_of(double red, double green, double blue)
{
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue;
}

static inline float color_luminance(const float rgb[3])
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

#endif
