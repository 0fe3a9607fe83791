/* sky.h - a clear sky and its sun, from what air is made of; and an overcast one.
 *
 * Light is scattered once by molecules and by aerosol along every line of sight, and the rest of the scattering is added
 * as the sum of a geometric series after S. Hillaire, "A Scalable and Production Ready Sky and Atmosphere Rendering
 * Technique", EGSR (2020), section 5.5, for 16 wavelengths. Rayleigh's optical depth is that of J. E. Hansen and L. D.
 * Travis, "Light scattering in planetary atmospheres", Space Science Reviews 16 (1974), eq. 2.30; aerosol falls off with
 * Angstrom's exponent of 1.3 and Henyey and Greenstein's phase function, whose narrow part counts as not scattered in what
 * is scattered further (T. Nakajima, M. Tanaka, "Algorithms for radiative intensity calculations in moderately thick
 * atmospheres using a truncation approximation", Journal of Quantitative Spectroscopy and Radiative Transfer 40 (1988));
 * ozone absorbs in Chappuis' band, and stands in a layer at 25 km. What falls on level ground is within 4 % of what single
 * photons in the same air find, for turbidities of 1 to 4 and a sun above 20 degrees (7 % for violet light in clean air). The sun above the air is a black body of 5778 K that gives 133.3 klx (S. Darula, R. Kittler, C. A.
 * Gueymard, "Reference luminous solar constant", Solar Energy 79 (2005)).
 * Left out: clouds, the ground's haze below the horizon, polarization, refraction, Fraunhofer's lines, water vapour.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SKY_H
#define MEN_SKY_H

#include "optics/texture.h"

typedef struct SkyModel {
    double elevation; /* of the sun above the horizon, radians; below it there is twilight */
    double turbidity; /* how much more than clean air scatters, straight up at 550 nm: 1 is clean air, 2 a very clear
                             * sky, 3 a clear one, 6 a warm hazy day; 1.9 has the illuminances of the IES's
                             * clear day but for its lower value of the sun above the air, 127.5 klx */
    const Spectrum *ground; /* albedo of what is below */
    double strength; /* radiance per 100 klx / pi: at 1 a white surface that 100 klx fall on has the radiance 1 */
} SkyModel;

/* The sky without the sun's disc, for an environment in whose frame the sun is in the half plane x = 0, z > 0; and the
 * irradiance of the sun alone on a surface that faces it, at the wavelengths of a spectrum's table (0 at or below the
 * horizon). Takes some 50 ms. */
ATTR_NODISCARD Status sky_new(const SkyModel *model, Environment **environment, float sun[SPECTRUM_SAMPLES],
                              Error *error);

/* A sky that is closed by clouds, three times as bright at the zenith as at the horizon: L = Lz (1 + 2 sin e) / 3, P. Moon,
 * D. E. Spencer, "Illumination from a non-uniform sky", Illuminating Engineering 37 (1942), CIE's overcast sky. It is of
 * the white of the working space, D65, and gives 0.3 + 21 sin(elevation) klx on level ground (IES Lighting Handbook, 9th
 * edition, 8-6). The turbidity does not count; the elevation is not negative. */
ATTR_NODISCARD Status sky_new_overcast(const SkyModel *model, Environment **environment, Error *error);

#endif
