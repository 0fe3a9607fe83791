/* check_rays.h - the rays of light that `check --ray` follows: their options, what is said of them, and how they are drawn.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CHECK_RAYS_H
#define MEN_CHECK_RAYS_H

#include "base/json.h"
#include "check/slice.h"
#include "cli/options.h"
#include "trace/light_way.h"

/* What one --ray asks for: a pixel of the camera's, or n rays, evenly spread from a first one to a last. */
typedef struct RayWish {
    const char *text; /* the command line's */
    bool through_pixel;
    double pixel[2];
    uint32_t n;
    Vec3 from[2], along[2];
} RayWish;

/* A ray of one wavelength, and what becomes of it. */
typedef struct CheckRay {
    Ray ray;
    float nm;
    LightWays ways;
} CheckRay;

enum { RAY_WAVELENGTHS = 32 };
typedef struct CheckRays {
    RayWish *wishes;
    size_t n_wishes;
    double nm[RAY_WAVELENGTHS];
    uint32_t n_nm;
    double least;
    CheckRay *items;
    size_t n;
} CheckRays;

/* Where a picture's camera and pixels are. */
typedef struct RayView {
    uint32_t camera, width, height;
} RayView;

/* Reads the options, before any work is done; STATUS_USAGE. check_rays_clear is due in every case. */
ATTR_NODISCARD Status check_rays_init(CheckRays *rays, const Options *options, Error *error);
void check_rays_clear(CheckRays *rays);
/* Follows them all, where there are any. STATUS_USAGE names the ray that cannot be. */
ATTR_NODISCARD Status check_rays_find(CheckRays *rays, const CompiledScene *compiled, RayView view, Pool *pool,
                                      Error *error);
/* Where they go, as text and as the member "rays". */
void check_rays_print(const CheckRays *rays, const CompiledScene *compiled, Buf *out);
void check_rays_print_json(const CheckRays *rays, const CompiledScene *compiled, JsonWriter *json);

/* Widens a plane's rectangle to hold what is met of the rays, but not to more than some times what it was. */
void check_rays_widen(const CheckRays *rays, SlicePlane *plane);
/* Draws them over a slice, as they are seen along the plane's normal. */
void check_rays_draw(const CheckRays *rays, const SlicePlane *plane, SliceImage *image);
/* The colour in which those of a wavelength are drawn. */
void check_rays_color(const CheckRays *rays, double nm, float rgb[3]);

#endif
