/* mie.h - how a sphere scatters a plane wave, by the theory of Lorenz and Mie.
 * [BH83] C. F. Bohren, D. R. Huffman, "Absorption and Scattering of Light by Small Particles" (1983), chapter 4; [Wiscombe80]
 * W. J. Wiscombe, "Improved Mie Scattering Algorithms", Applied Optics 19 (1980). x is the sphere's circumference over the
 * wavelength around it, m its index over that of what is around it, n + ik with k >= 0 for what absorbs.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MIE_H
#define MEN_MIE_H

#include <stddef.h>

#include "base/lanes.h"

typedef struct MieNumber {
    double re, im;
} MieNumber;

/* Terms of the series after which what is left is below 1e-8: [Wiscombe80] section 2. */
size_t mie_terms(double x);
/* Numbers that mie_coefficients needs to work with. */
size_t mie_scratch(double x, MieNumber m);
/* a_n and b_n for n = 1 .. mie_terms(x), in a[n - 1], b[n - 1]: [BH83] eq. 4.88. 0 < x <= 20000. */
void mie_coefficients(double x, MieNumber m, MieNumber *scratch, MieNumber *a, MieNumber *b);

/* Cross-sections over the sphere's own, and the mean cosine of what is scattered: [BH83] eq. 4.61, 4.62, section 4.5. */
typedef struct MieEfficiencies {
    double extinction, scattering, mean_cosine;
} MieEfficiencies;
MieEfficiencies mie_efficiencies(double x, const MieNumber *a, const MieNumber *b);
/* Amplitudes in the direction of that cosine: [BH83] eq. 4.74. */
void mie_amplitudes(double x, const MieNumber *a, const MieNumber *b, double cosine, MieNumber *s1, MieNumber *s2);

/* ---- the same for very many spheres and angles, in float ---- */

enum { MIE_ANGLES = 8 }; /* at once */
/* pi_n + tau_n and pi_n - tau_n of four angles, and of four others. */
typedef struct MieAngles {
    Lanes plus[2], minus[2];
} MieAngles;
void mie_angles(const double cosines[MIE_ANGLES], size_t n, MieAngles *angles);
/* (2n + 1) / (n (n + 1)) times a_n + b_n, and a_n - b_n. */
typedef struct MieTerm {
    float plus_re, plus_im, minus_re, minus_im;
} MieTerm;
void mie_make_terms(const MieNumber *a, const MieNumber *b, size_t n, MieTerm *terms);
/* (|S1|^2 + |S2|^2) / 2 in each of the directions, to 1e-4. */
void mie_intensities(const MieTerm *terms, size_t n, const MieAngles *angles, Lanes intensity[2]);

#endif
