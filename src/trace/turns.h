/* turns.h - what light does at the smooth boundaries on its way, mirrored or passed, and how a probe does the same;
 * private to src/trace.
 *
 * Of what comes to a rainbow's drop one part in fifty is mirrored within. A probe that leaves the wall in just the right
 * direction, and chooses at each boundary as often as that reflects, comes out on the sun's side one time in fifty. But photons
 * that came that way tell what they did at each boundary; so a probe does the same, in the other order, in most cases, and is
 * weighted by how often it would have done so by itself. For the same reason photons, of which one in fifty would be mirrored
 * in the drop, and all others leave the scene, choose more often what lets them land.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TURNS_H
#define MEN_TURNS_H

#include "base/attr.h"
#include "base/lanes.h"

/* ---- turns ---- */

/* As bits, 1: mirrored. Of a path towards a light the first one is the lowest, of light on its way to it the last one; so
 * that both ways have the same bits. Of more than TURNS_TOLD the farthest are not told of light, and for a path are as if it had
 * passed. */
enum { TURNS_TOLD = 31 };
#define TURNS_UNTOLD UINT32_MAX    /* nothing is known; */
#define TURNS_LIKE_NONE (1U << 31) /* no light is known to have done the same */

/* What a path has done since its direction was chosen. A turn is counted where light may do either, and the surface's shape allows
 * both; what is reflected totally is none. */
typedef struct Turns {
    uint32_t bits, n;
    Lanes chance; /* the probability of it at each wavelength, where no lead is followed */
} Turns;

/* ---- leads, of probes ---- */

/* What the lobes of a guide say that light did which comes to a place from one direction: densities of that direction, of lobes that
 * say the same together. */
enum { LEADS = 8 };
typedef struct Leads {
    float all, unled; /* of all lobes; and of those that lead nowhere, or are not followed */
    uint32_t n, turns[LEADS];
    float density[LEADS];
} Leads;

static inline Turns turns_none(void)
{
    return (Turns){.chance = lanes_all(1)};
}

/* mirrored: how often at each wavelength, did: it was. alone: each wavelength that passes goes another way, and this is the hero's. */
static inline void turns_add(Turns *turns, Lanes mirrored, bool did, bool alone, bool of_light)
{
    Lanes chance = did ? mirrored : lanes_rest(mirrored);
    turns->chance = lanes_mul(turns->chance, chance);
    if (alone && !did) turns->chance = lanes_all(lanes_get(turns->chance, 0));
    if (of_light)
        turns->bits = (turns->bits << 1 | did) & ~TURNS_LIKE_NONE;
    else if (did)
        turns->bits |= turns->n < TURNS_TOLD ? 1U << turns->n : TURNS_LIKE_NONE;
    turns->n++;
}

/* How dense the probes are that leave in the leads' direction and do the same: over how likely a path is to do so by itself. */
float leads_lift(const Leads *leads, const Turns *turns);
/* How often a probe is to be mirrored next, that would be so naturally as often as *mirrored says: leads that agree with what it did so
 * far tell, and natural choice, in proportion to how dense the probes are that got there by each. false: no lead agrees. */
bool leads_choose(const Leads *leads, const Turns *turns, Lanes *mirrored);

/* ---- hopes, of photons ---- */

/* What became of photons by what they did at the first boundaries: node 1 is of all, its children 2 n and 2 n + 1 of those that
 * passed next, and that were mirrored. */
enum { HOPES_TURNS = 6, HOPES = 2 << HOPES_TURNS };
typedef struct Hopes {
    uint32_t followed[HOPES], landed[HOPES];
} Hopes;

/* The node of one more turn; those of all that comes after the last one is the same. */
static inline uint32_t hopes_step(uint32_t node, bool mirrored)
{
    return node < HOPES / 2 ? 2 * node + mirrored : node;
}
/* How often a photon is to be mirrored that would be so naturally as often as *mirrored says; where nothing is known yet, at its first
 * boundaries one in five at least. false: naturally. */
bool hopes_choose(const Hopes *hopes, uint32_t node, Lanes *mirrored);
/* One photon has come to a node, and landed, or not. */
void hopes_count(Hopes *hopes, uint32_t node, bool landed);

#endif
