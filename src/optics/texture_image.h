/* texture_image.h - pictures on surfaces: filtered, as spectra or as numbers.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEXTURE_IMAGE_H
#define MEN_TEXTURE_IMAGE_H

#include "base/status.h"
#include "base/vec3.h"
#include "optics/spectrum.h"

typedef struct TextureImage TextureImage;

/* WRAP_ONCE: beyond the edges numbers and light are 0; three numbers are a vector, and that of a flat surface; colours are those at the
 * edge, as they mean something only where a mask of the same picture is not 0. */
typedef enum TextureWrap { WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR, WRAP_ONCE } TextureWrap;

enum { TEXTURE_IMAGE_LARGEST = 65536 }; /* pixels each way */

/* rgb: width * height triples, row 0 at the top; copied. As reflectances: linear Rec.709, each channel in 0..1 (held to it;
 * the caller has checked), upsampled to spectra, right to 0.002 (see upsample_reflectance). Smaller versions of the
 * picture, for what is far away, are means of reflectance, each of half the size of the one before. STATUS_INPUT when a
 * side is 0 or too large; STATUS_NOMEM. */
ATTR_NODISCARD Status texture_image_new_colors(const float *rgb, uint32_t width, uint32_t height, TextureImage **image,
                                               Error *error);
/* The same for light of any brightness that is not below 0: spectra as spectrum_from_light has them. */
ATTR_NODISCARD Status texture_image_new_light(const float *rgb, uint32_t width, uint32_t height, TextureImage **image,
                                              Error *error);
/* The mean luminance of a picture of light. */
float texture_image_luminance(const TextureImage *image);
/* The same for numbers of any range, `channels` (1 or 3) to a pixel. */
ATTR_NODISCARD Status texture_image_new_numbers(const float *values, uint32_t channels, uint32_t width, uint32_t height,
                                                TextureImage **image, Error *error);
void texture_image_free(TextureImage *image); /* NULL is fine */
/* Bytes that such an image takes at most, its smaller versions included. */
double texture_image_bytes(uint32_t channels, uint32_t width, uint32_t height);
/* Of all it consists of. */
uint64_t texture_image_hash(const TextureImage *image);
uint32_t texture_image_channels(const TextureImage *image);
/* The least and the largest number of a channel. */
void texture_image_range(const TextureImage *image, uint32_t channel, float *least, float *most);

/* Where to look: u to the right and v up, the picture filling 0..1 both ways; and how far apart, in u and v, things need
 * be told from each other: 0 looks at the picture itself, bilinearly. */
typedef struct TextureLook {
    double u, v;
    float width_u, width_v;
    TextureWrap wrap;
} TextureLook;
/* Trilinear between the two versions whose pixels are next to the wider of both widths in size: what is seen of a picture
 * that is stretched in one direction is blurred in the other rather than left to alias. Adds weight times the value for each of the
 * wavelengths to the sums. */
void texture_image_add_color(const TextureImage *image, const TextureLook *look, float weight,
                             const Wavelengths *wavelengths, Lanes *sums);
/* How many pixels of the picture itself are averaged along the longer side of what is seen at a look; 1 or less: none. */
float texture_image_pixels_seen(const TextureImage *image, const TextureLook *look);
/* The same of numbers. */
void texture_image_numbers(const TextureImage *image, const TextureLook *look, float *values);

#endif
