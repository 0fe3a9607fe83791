/* texture.h - images that light a scene: a latitude-longitude environment with importance sampling.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEXTURE_H
#define MEN_TEXTURE_H

#include "base/pool.h"
#include "base/status.h"
#include "base/vec3.h"
#include "optics/color.h"

typedef struct Environment Environment;

/* Beyond this radiance the products along a path could leave the range of float. */
#define ENVIRONMENT_BRIGHTEST 1e30f

/* rgb: width * height * 3 floats, linear Rec.709, row 0 at the top (direction +y), the middle column at
 * direction -z turned so that u = 0.5 + atan2(x, -z) / (2 pi); negative and non-finite values are the
 * caller's to refuse. The pixels are copied (upsampled to spectra). scale multiplies the radiance. light: what a pixel of
 * (1,1,1) shines with, NULL for white; copied, but for a table that it points to. STATUS_INPUT when
 * a side is 0 or above 131072, or when a pixel times scale is above ENVIRONMENT_BRIGHTEST; STATUS_NOMEM. The same for any pool,
 * NULL included. */
ATTR_NODISCARD Status environment_new_image(const float *rgb, unsigned width, unsigned height, double scale,
                                            const Spectrum *light, Pool *pool, Environment **environment, Error *error);
/* From the scene towards the middle of a pixel of such an image; of length 1. */
Vec3 environment_pixel_direction(unsigned width, unsigned height, unsigned column, unsigned row);
/* By wavelengths: width * height * ENVIRONMENT_BANDS values at evenly spread wavelengths, from SPECTRUM_MIN_NM to
 * SPECTRUM_MAX_NM, linear in between; light: SPECTRUM_SAMPLES values that all of them are multiplied with. Copied. The last rows,
 * as far as they are alike, are what is below a horizon: it begins sharply, at the middle of the row above them. */
enum { ENVIRONMENT_BANDS = 16 };
ATTR_NODISCARD Status environment_new_bands(const float *values, unsigned width, unsigned height, const float *light,
                                            Pool *pool, Environment **environment, Error *error);
/* The same radiance from everywhere. The spectrum is copied; a table that it points to must live as long. */
ATTR_NODISCARD Status environment_new_constant(const Spectrum *radiance, Environment **environment, Error *error);
void environment_free(Environment *environment);

/* Radiance from a unit direction (the direction from the scene to the environment), in the environment's
 * own frame. Bilinear in the image. */
Lanes environment_radiance(const Environment *environment, Vec3f direction, Lanes wavelength_nm);
/* Its luminance, as the density below has it. */
float environment_luminance(const Environment *environment, Vec3f direction);
unsigned environment_width(const Environment *environment); /* of the image, in pixels; 0: the same everywhere */
/* The radiance, and the density with which environment_sample_place picks the direction, per steradian. */
Lanes environment_look(const Environment *environment, Vec3f direction, Lanes wavelength_nm, float *pdf_w);
/* Where a direction lies in an image: the cell between the centres of four pixels, and the place in it, each 0..1. What is
 * there is fetched from memory meanwhile, for whom it may concern: */
typedef struct EnvironmentPlace {
    unsigned row, column;
    float across, down; /* down: in the polar angle */
} EnvironmentPlace;
EnvironmentPlace environment_find(const Environment *environment, Vec3f direction, float *pdf_w);
/* Picks a direction in proportion to luminance times solid angle, and finds what was picked; pdf_w per steradian, > 0. */
Vec3f environment_sample_place(const Environment *environment, float u, float v, float *pdf_w, EnvironmentPlace *place);
Lanes environment_radiance_at(const Environment *environment, const EnvironmentPlace *place, Lanes wavelength_nm);
/* Integral of luminance over the sphere, for choosing between lights (a coarse image's is off by a few percent
 * beside the poles). */
float environment_power(const Environment *environment);
bool environment_is_black(const Environment *environment);
/* What all of its light is a part of: that of a constant one, and of an image with a light; NULL: nothing that is one spectrum. */
const Spectrum *environment_light(const Environment *environment);

#endif
