/* spheres.h - phase functions of spheres of many sizes: droplets, bubbles, pearls.
 *
 * Sizes are distributed as J. E. Hansen and L. D. Travis have it, "Light Scattering in Planetary Atmospheres", Space Science
 * Reviews 16 (1974), eq. 2.53 to 2.56, for of all distributions scattering hardly heeds more than these two numbers: the mean
 * diameter, by the area of the spheres' shadows, and the relative standard deviation of that, the root of their effective variance.
 * Fog and clouds have one of 0.2 to 0.4, rain after J. S. Marshall and W. M. Palmer 0.58.
 *
 * Spheres of a circumference of up to SPHERES_BORDER wavelengths are summed by mie.h, larger ones by large_sphere.h. What drops of
 * more than some 150 micrometres diffract straight on counts as not scattered.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SPHERES_H
#define MEN_SPHERES_H

#include "base/pool.h"
#include "optics/phase_table.h"

/* There both differ, of water, by 1 to 4 % at the bows and straight on, by 10 % at right angles, and by 20 to 30 % between the bows and
 * about 80 and 163 degrees, where it is dark: what creeps around the spheres falls off slowly with their size. Of bubbles,
 * by 10 % but near the critical angle, where it is 25 %. See tests/unit/mie_test.c. */
#define SPHERES_BORDER 450.0
#define SPHERES_LEAST_WIDTH 0.02
#define SPHERES_MOST_WIDTH 0.8
/* of fog: narrow enough for some rings of a corona */
#define SPHERES_WIDTH 0.2
/* Indices may be relative to what is around from the first to the second, and not closer than this to 1. */
#define SPHERES_LEAST_INDEX 0.4
#define SPHERES_MOST_INDEX 4.0
#define SPHERES_LEAST_CONTRAST 0.005

/* All that the table depends on. */
typedef struct Spheres {
    double diameter_um, width;
    double index[PHASE_TABLE_WAVES];  /* relative to what is around, */
    double around[PHASE_TABLE_WAVES]; /* whose index is this, at the waves of a PhaseTable */
} Spheres;

/* Of water at 20 degrees Celsius: M. Daimon, A. Masumura, Applied Optics 46, 3811 (2007). */
double spheres_water_index(double wavelength_nm);
/* A table without values, whose recipe is a copy of the spheres. */
PhaseTable *spheres_stand_in(Arena *arena, const Spheres *spheres);
/* NULL when memory ends beside the arena's. */
PhaseTable *spheres_table(Arena *arena, const Spheres *spheres, Pool *pool);

#endif
