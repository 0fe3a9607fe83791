/* sky.h - a clear sky and its sun, from what air is made of; and an overcast one.
 *
 * The air is that of air.h, around a round earth, its light of all orders of scattering that of sky_field.h, for 16
 * wavelengths. Random walks of light through the same air find the same (tests/truth/sky_test.c, suns from 20 degrees above the
 * horizon to 4 below, turbidities of 1 to 4, at 454, 548 and 642 nm): in the mean over directions within 3 %, in single ones
 * within 3 % of their own errors in clean air by day, within 8 % else and 10 % in twilight, and within 15 % two degrees above
 * the horizon in thick haze. The sun above the air is a black body of 5778 K that gives 133.3 klx (S. Darula, R. Kittler, C. A.
 * Gueymard, "Reference luminous solar constant", Solar Energy 79 (2005)); through clean air its light is that of Kasten's and
 * Young's air mass within 2 %, down to the horizon.
 * Left out: clouds, the ground's haze below the horizon, polarization, refraction of scattered light (as if the sun stood up to
 * half a degree lower when it sets), Fraunhofer's lines, water vapour. The picture has 127 rows, 1.4 degrees each.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SKY_H
#define MEN_SKY_H

#include "base/pool.h"
#include "optics/texture.h"

typedef struct SkyModel {
    double elevation; /* of the sun above the horizon as it is seen, radians; below it there is twilight */
    double turbidity; /* how much more than clean air scatters, straight up at 550 nm: 1 is clean air, 2 a very clear
                             * sky, 3 a clear one, 6 a warm hazy day; 1.9 has the illuminances of the IES's
                             * clear day but for its lower value of the sun above the air, 127.5 klx */
    const Spectrum *ground; /* albedo of what is below */
    double strength; /* radiance per 100 klx / pi: at 1 a white surface that 100 klx fall on has the radiance 1 */
    Pool *pool;      /* whose threads compute it, or NULL */
} SkyModel;

/* The sky without the sun's disc, for an environment in whose frame the sun is in the half plane x = 0, z > 0; and the
 * irradiance of the sun alone on a surface that faces it, at the wavelengths of a spectrum's table (0 at or below the
 * horizon). Takes half a second of one processor by day, one to two with a low sun; threads share it. */
ATTR_NODISCARD Status sky_new(const SkyModel *model, Environment **environment, float sun[SPECTRUM_SAMPLES],
                              Error *error);

/* A sky that is closed by clouds, three times as bright at the zenith as at the horizon: L = Lz (1 + 2 sin e) / 3, P. Moon,
 * D. E. Spencer, "Illumination from a non-uniform sky", Illuminating Engineering 37 (1942), CIE's overcast sky. It is of
 * the white of the working space, D65, and gives 0.3 + 21 sin(elevation) klx on level ground (IES Lighting Handbook, 9th
 * edition, 8-6). The turbidity does not count; the elevation is not negative. */
ATTR_NODISCARD Status sky_new_overcast(const SkyModel *model, Environment **environment, Error *error);

#endif
