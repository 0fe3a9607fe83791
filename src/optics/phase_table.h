/* phase_table.h - a phase function as values at angles and wavelengths.
 *
 * Angles are kept as s, the squared sine of half the angle by which light is turned: 0 for what goes on straight, 1 for what turns
 * back. Floats tell the narrowest forward peaks apart by it, which by their cosines they would not; and a solid angle is 4 pi
 * times a difference of s. Between the nodes the density is linear in s, so that its integral is inverted in closed form;
 * wavelengths are evenly spaced by their inverse, and between two the density is a mixture of theirs. So each wavelength's
 * table is its own density to the last bit, and its integral is 1.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PHASE_TABLE_H
#define MEN_PHASE_TABLE_H

#include <stdint.h>

#include "base/arena.h"
#include "base/lanes.h"

enum { PHASE_TABLE_WAVES = 24, PHASE_TABLE_BUCKETS = 1024 };

typedef struct PhaseTable {
    uint32_t n_nodes, n_waves; /* n_waves 1: the same at all wavelengths; else PHASE_TABLE_WAVES */
    float *nodes;              /* s, ascending from 0 to 1 */
    float *values;             /* per steradian, of wave k at node i: [i * n_waves + k] */
    double *shares;            /* what is below node i: [k * n_nodes + i] */
    uint16_t *first;           /* by the square root of s: the last node that is not above the bucket's beginning */
    const void *recipe;        /* what the values follow from, for comparisons and hashes */
    size_t recipe_size;
} PhaseTable;

/* The wavelength of wave k. */
double phase_table_nm(uint32_t k);
/* With room for values; n_nodes of 2 to 65535. */
PhaseTable *phase_table_new(Arena *arena, uint32_t n_nodes, uint32_t n_waves);
/* Makes the values, of any scale, none below 0, into densities, and all else from nodes and values. */
void phase_table_finish(PhaseTable *table);

/* Per steradian, at each of the wavelengths. 0 <= s <= 1. */
Lanes phase_table_at(const PhaseTable *table, float s, Lanes wavelength_nm);
/* s for u uniform in [0, 1), at one wavelength. */
float phase_table_sample(const PhaseTable *table, float u, float wavelength_nm);

#endif
