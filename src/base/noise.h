/* noise.h - noise on a lattice: functions of a point that have no state and are specified bit for bit in terms of
 * base/hash.h, so that a scene looks the same everywhere.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_NOISE_H
#define MEN_NOISE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/vec3.h"

/* Beyond these coordinates all numbers are whole, and noise has no meaning. */
#define NOISE_LARGEST_COORDINATE 4503599627370496.0 /* 2^52 */

/* The language's noise(): -1..1 at a point of n = 1 to 3 coordinates, with a root mean square of 0.52, 0.48 and 0.44. Its
 * value at a lattice point: h = "noise" in ASCII as a number; for each coordinate h = hash_u64(h ^ coordinate as 64 bits in
 * two's complement); 2 * hash_to_unit(h) - 1.
 * Between two points it is the quintic that has at each of them its value, the central difference as its slope, and the
 * second difference as its second derivative; it goes one derivative further than the cubic with such slopes (E. Catmull,
 * R. Rom, "A Class of Local Interpolating Splines", 1974). What mixes the values of the two points by a fade has the slope 0
 * along an axis at all its whole numbers: waves and hills made of it have creases along the axes, and are rectangles.
 * With t the part of the coordinate beyond the whole number below, s = 1 - t, and v[] at -1, 0, 1 and 2 from there:
 *     near(t, s) = s * (1 + t + t * t * t * (3 * t - 4.5))
 *     far(t, s) = t * s * (s * s) * (-0.5 - t)
 *     v = (far(t, s) * v[-1] + far(s, t) * v[2]) + (near(t, s) * v[0] + near(s, t) * v[1])
 * in the order that C has, along x first, then y, then z. This goes beyond -1..1 at places, to 1.3; so where |v| > 0.8 it is
 * drawn in, which leaves its second derivatives continuous: with x = (|v| - 0.8) / 0.2 it becomes
 * 0.8 + 0.2 * (x / sqrt(1 + x * x)), with the sign of v. */
double noise_value(const double *point, unsigned n);
/* What noise_value() is between in a box, but for its rounding; false where this would take too long to find. The bounds are
 * the closer the smaller the box. */
bool noise_bounds(const double *low, const double *high, unsigned n, double *least, double *most);

/* Gradient noise, smoother to look at: about -1..1 with a root mean square of 0.27, zero at lattice points. [Perlin02],
 * with hash_u64 in place of the permutation: h = hash_u64(seed); for each coordinate h =
 * hash_u64(h ^ coordinate); the gradient is number h % 12 of the directions from a cube's middle to its edges: with
 * k = h % 12 / 4 the axis that has no part in it, and the signs of the others, in order, from bits 0 and 1 of h % 4
 * (set: -). t -> t^3 (6 t^2 - 15 t + 10) mixes what the two points of each axis give, along x first. */
double noise_gradient(Vec3 p, uint64_t seed);
/* Three of these at once, not related to each other: of h, of h >> 16 and of h >> 32. */
Vec3 noise_gradient3(Vec3 p, uint64_t seed);

#endif
