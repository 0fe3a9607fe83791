/* phase.h - in which directions a medium scatters.
 * Directions are those of travel: the cosine of light that goes on straight is 1. Every function here is its own
 * density, so that sampling needs no weight. Lobes are the same at all wavelengths; a table need not be.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PHASE_H
#define MEN_PHASE_H

#include <stdbool.h>

#include "base/vec3.h"
#include "optics/phase_table.h"

/* B. T. Draine, "Scattering by Interstellar Dust Grains in the Optical and Ultraviolet", ApJ 598 (2003), eq. 4:
 * (1 - g^2) (1 + alpha u^2) / (4 pi (1 + alpha (1 + 2 g^2) / 3) (1 + g^2 - 2 g u)^(3/2)) at cosine u. alpha 0 is Henyey
 * and Greenstein's, g 0 and alpha 1 Rayleigh's, alpha 1 Cornette and Shanks'. |g| <= PHASE_MOST_G, alpha >= 0. */
#define PHASE_MOST_G 0.999
typedef struct PhaseLobe {
    double g, alpha;
} PhaseLobe;

/* weight of the first lobe, 1 - weight of the second */
typedef struct Phase {
    double weight;
    PhaseLobe lobes[2];
    const PhaseTable *table; /* instead of lobes; NULL: there is none. Not owned */
} Phase;

Phase phase_isotropic(void);
Phase phase_hg(double g);
Phase phase_draine(double g, double alpha);
Phase phase_two_hg(double g1, double g2, double weight);
Phase phase_of_table(const PhaseTable *table);
/* Whether the density is the same at all wavelengths. */
static inline bool phase_is_grey(const Phase *phase)
{
    return !phase->table || phase->table->n_waves == 1;
}
/* Per steradian, of a phase without a table. */
float phase_evaluate_lobes(const Phase *phase, float cosine);
/* Per steradian at each of the wavelengths, from one unit vector to another. */
Lanes phase_evaluate(const Phase *phase, Vec3f along, Vec3f direction, Lanes wavelength_nm);
/* A direction for the first of the wavelengths. u uniform in [0, 1)^2; *pdf_w is what phase_evaluate says of the direction. */
Vec3f phase_sample(const Phase *phase, Vec3f along, const float u[2], Lanes wavelength_nm, Lanes *pdf_w);

#endif
