/* color.h - the CIE 1931 observer, the working space, and RGB to spectra and back.
 * The working space is linear with Rec.709 primaries and D65 white; a light of RGB (1,1,1) has the spectrum of D65,
 * normalized so that it resolves to exactly (1,1,1).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COLOR_H
#define MEN_COLOR_H

#include "optics/spectrum.h"

/* The standard observer at one wavelength (tabulated at 5 nm, linear in between). */
void color_matching(float wavelength_nm, float xyz[3]);

/* Reflectance or any quantity in 0..1 of a colour: [JH19] W. Jakob, J. Hanika, "A Low-Dimensional
 * Function Space for Efficient Spectral Upsampling" (2019). rgb is linear Rec.709 and is clamped to
 * 0..1 in each channel (the caller has checked and reported). Equal channels give a constant. */
Spectrum spectrum_from_reflectance(const double rgb[3]);
/* Emission of a colour of any size: scale * sigmoid * D65; resolves to rgb again. */
Spectrum spectrum_from_light(const double rgb[3]);
/* The three [JH19] coefficients of a colour with channels in 0..1, for images: table look-up, right to 0.002 in
 * linear RGB (spectrum_from_reflectance: 1e-5). */
void upsample_coefficients(const float rgb[3], float coefficients[3]);
/* The same for colours of any size from 0 on, as light is, to 0.004 of their largest channel: returns what upsample_at is to be
 * multiplied by. Equal channels are a constant of 1, times that. */
float upsample_light(const float rgb[3], float coefficients[3]);
/* The same for reflectances, clamped to 0..1: dark ones, of which 0.002 would be much, are brighter ones times a number below 1. */
float upsample_reflectance(const float rgb[3], float coefficients[3]);
/* Evaluates what upsample_coefficients gave; a reflectance, without illuminant. */
Lanes upsample_at(const float coefficients[3], Lanes wavelength_nm);
/* The white illuminant (D65), scaled so that spectrum_from_light({1,1,1}) is exactly this. */
Lanes white_at(Lanes wavelength_nm);

/* Absorption per length such that white light that has gone `depth` takes the colour `tint`:
 * sigma(w) = -ln T(w) / depth. Channels of 0 are raised to 1e-4. table: SPECTRUM_SAMPLES floats. */
Spectrum spectrum_from_tint(const double tint[3], double depth, float *table);
/* A non-negative quantity per length given as red, green, blue (absorption, scattering): a smooth
 * spectrum that equals r, g, b at the primaries' dominant wavelengths, so that Beer-Lambert over
 * a length gives about the colour exp(-rgb * length). table: SPECTRUM_SAMPLES floats. */
Spectrum spectrum_from_coefficients(const double rgb[3], float *table);

/* Four wavelengths of one path: the first by importance from u in [0,1), the others rotated evenly
 * through the same distribution, so that each is sampled alike. pdf is per nm, above 0 from 360 to 830. Where only
 * the first lane goes on (dispersion), its radiance times 4 and 0 in the others is as right. */
typedef struct WavelengthSample {
    Lanes nm;
    Lanes pdf;
} WavelengthSample;
WavelengthSample wavelengths_sample(float u);

/* What a path's four radiances add to the pixel: the mean over the lanes of L(w) * cmf(w) / pdf(w),
 * in linear working RGB, scaled so that white light of radiance 1 gives (1,1,1) in expectation. */
void color_from_lanes(Lanes radiance, const WavelengthSample *wavelengths, float rgb[3]);

/* Wavelengths that are evenly spread by importance, and what a reflectance at each of them adds to a colour under white light:
 * what reflects all is (1,1,1). Other colours come back within .01, .0021 root mean square. */
enum { COLOR_FOURS = 32 };
typedef struct ReflectedColor {
    Lanes nm[COLOR_FOURS], weights[COLOR_FOURS][3]; /* of red, green and blue */
} ReflectedColor;
void reflected_color_init(ReflectedColor *color);

/* Mean of the spectrum under the luminous efficiency y: 1 for white_at and for the constant 1. */
double spectrum_luminance(const Spectrum *spectrum);

#endif
