/* air.h - what air is made of, and how much of it is along a line through the atmosphere around a round earth.
 *
 * Molecules scatter by Rayleigh's law: the optical depth is that of J. E. Hansen and L. D. Travis, "Light scattering in
 * planetary atmospheres", Space Science Reviews 16 (1974), eq. 2.30. Aerosol falls off with Angstrom's exponent of 1.3 and
 * scatters after Henyey and Greenstein. Ozone absorbs in Chappuis' band, 300 Dobson units in a layer at 25 km. Densities of
 * the first two fall off exponentially with height. Lengths are in kilometres.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_AIR_H
#define MEN_AIR_H

#include "base/vec3.h"
#include "optics/texture.h"

enum { AIR_BANDS = ENVIRONMENT_BANDS, AIR_COLUMN_HEIGHTS = 64, AIR_COLUMN_ANGLES = 192 };

static const double air_ground = 6371, air_top = 6471; /* radii */
static const double air_aerosol_g = 0.76;              /* Henyey and Greenstein's */
static const double air_aerosol_albedo = 0.93;         /* of what aerosol takes from a ray, so much is scattered */

/* How much of a substance is at a place, in units of its densest, or along a line: lengths at that density. */
typedef struct Columns {
    float rayleigh, aerosol, ozone;
} Columns;

typedef struct Air {
    float rayleigh[AIR_BANDS], aerosol[AIR_BANDS], ozone[AIR_BANDS]; /* extinction per km where it is densest */
    Columns columns[AIR_COLUMN_HEIGHTS][AIR_COLUMN_ANGLES];          /* up to space, by height and angle */
} Air;

double air_band_nm(int band);
/* turbidity: see sky.h. */
void air_init(Air *air, double turbidity);
Columns air_density(double height);
/* From a radius along a direction of that cosine against the vertical: to the ground (true), or out of the air. */
bool air_line(double radius, double cosine, double *length);
/* Up to space along a straight line; false: the earth is in the way. */
bool air_columns(const Air *air, double radius, double cosine, Columns *columns);
/* What passes through the air from the sun to the ground, where the sun is seen at an elevation of 0 or more, at one
 * wavelength. The light is bent on its way (refraction, by a refractive index of 1.000277 at the ground). */
double air_sun_transmittance(double turbidity, double elevation_rad, double nm);

#endif
