/* noise.h - noise on a lattice: functions of a point that have no state and are specified bit for bit in terms of
 * base/hash.h, so that a scene looks the same everywhere.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_NOISE_H
#define MEN_NOISE_H

#include <stdint.h>

#include "base/vec3.h"

/* Beyond these coordinates all numbers are whole, and noise has no meaning. */
#define NOISE_LARGEST_COORDINATE 4503599627370496.0 /* 2^52 */

/* The language's noise(): -1..1 at a point of n = 1 to 3 coordinates. Its value at a lattice point: h = "noise" in ASCII
 * as a number; for each coordinate h = hash_u64(h ^ coordinate as 64 bits in two's complement); 2 * hash_to_unit(h) - 1.
 * Between the points t -> t^3 (6 t^2 - 15 t + 10) mixes, along x first. */
double noise_value(const double *point, unsigned n);

/* Gradient noise, smoother to look at: about -1..1 with a root mean square of 0.27, zero at lattice points. [Perlin02],
 * with hash_u64 in place of the permutation: h = hash_u64(seed); for each coordinate h =
 * hash_u64(h ^ coordinate); the gradient is number h % 12 of the directions from a cube's middle to its edges: with
 * k = h % 12 / 4 the axis that has no part in it, and the signs of the others, in order, from bits 0 and 1 of h % 4
 * (set: -). Mixed as above. */
double noise_gradient(Vec3 p, uint64_t seed);
/* Three of these at once, not related to each other: of h, of h >> 16 and of h >> 32. */
Vec3 noise_gradient3(Vec3 p, uint64_t seed);

#endif
