/* large_sphere.h - how a clear sphere that is large against the wavelength scatters: rays, and waves where rays fail.
 *
 * Diffraction around the sphere, and rays that are mirrored off it (p = 0) or go through it along p chords, by Snell's and Fresnel's
 * laws: [Hulst57] H. C. van de Hulst, "Light Scattering by Small Particles" (1957), chapters 8 and 12. Where two rays of one p come
 * out alike, at a bow, both together are a uniform approximation by Airy's function, which goes over into the sum of both
 * rays away from the bow and into the dark beyond it: [CFU57] C. Chester, B. Friedman, F. Ursell, "An Extension of the Method
 * of Steepest Descents", Proceedings of the Cambridge Philosophical Society 53 (1957); for spheres, G. P. Können, J. H. de Boer,
 * "Polarized Rainbow", Applied Optics 18 (1979), have its limit at the bow. Terms of different p are added without interference, as
 * spheres of many sizes add up. No glory, which by x = 500 is a third of a degree wide.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LARGE_SPHERE_H
#define MEN_LARGE_SPHERE_H

#include <stdint.h>

enum { LARGE_MOST_CHORDS = 7, LARGE_MOST_RAYS = 24 };

/* Light of one p in one direction, near a bow or beyond it. Amplitudes of both polarizations, across the plane of the ray
 * first: sum is (a1 + a2) z^(1/4), difference (a1 - a2) z^(-1/4), with z the square of Airy's argument over x^(2/3). */
typedef struct LargePair {
    float z; /* below 0 where rays of geometry are none */
    float sum[2], difference[2];
} LargePair;

/* What leaves a sphere of that index, whatever its size, in the direction of that angle. */
typedef struct LargeRays {
    float plain; /* of rays that come out alone: |S|^2 / x^2, unpolarized */
    uint32_t n;
    LargePair pairs[LARGE_MOST_RAYS];
} LargeRays;

/* index: relative, 0.4 to 4 but for 1; angle: of turning, 0 to pi. */
void large_rays(double index, double angle, LargeRays *rays);
/* Airy's function and its derivative between what a bow needs. */
enum { LARGE_AIRY_STEPS = 2048 };
typedef struct LargeAiry {
    float value[LARGE_AIRY_STEPS + 1], slope[LARGE_AIRY_STEPS + 1];
} LargeAiry;
void large_airy(LargeAiry *airy);
/* |S|^2 / x^2, unpolarized, in the mean over spheres of x (1 - spread / 2) to x (1 + spread / 2); x of 100 and more. diffracted: what
 * part of diffraction counts, 0 to 1. */
float large_intensity(const LargeAiry *airy, const LargeRays *rays, double x, double spread, double angle,
                      double diffracted);

#endif
