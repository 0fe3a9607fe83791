/* turns.c - see turns.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/turns.h"

/* ---- leads ---- */

/* The density of leads that agree with the turns so far, and pass next; *mirrored: of those that are mirrored next. */
static float ahead(const Leads *leads, const Turns *turns, float *mirrored)
{
    const uint32_t n = turns->n < TURNS_TOLD ? turns->n : TURNS_TOLD, done = ((1U << n) - 1) | TURNS_LIKE_NONE;
    float passed = *mirrored = 0;
    for (uint32_t i = 0; i < leads->n; i++) {
        if (((leads->turns[i] ^ turns->bits) & done) != 0) continue;
        *(n < TURNS_TOLD && leads->turns[i] >> n & 1 ? mirrored : &passed) += leads->density[i];
    }
    return passed;
}

float leads_lift(const Leads *leads, const Turns *turns)
{
    const float least =
        1e-20f; /* what is as unlikely as that carries nothing, and one over it would leave the range of float */
    float mirrored, passed = ahead(leads, turns, &mirrored), chance = lanes_mean(turns->chance);
    return leads->unled + (chance > least ? (passed + mirrored) / chance : 0);
}

bool leads_choose(const Leads *leads, const Turns *turns, Lanes *mirrored)
{
    float back, on = ahead(leads, turns, &back);
    if (!(on + back > 0)) return false;
    Lanes unled = lanes_scale(turns->chance, leads->unled);
    *mirrored =
        lanes_div(lanes_add(lanes_mul(unled, *mirrored), lanes_all(back)), lanes_add(unled, lanes_all(on + back)));
    return true;
}

/* ---- hopes ---- */

/* The part of a node's photons that landed; of few, as of its parent's, which counts as so many more. */
static float hope_of(const Hopes *hopes, uint32_t node)
{
    const float more = 8;
    const uint32_t parent = node / 2;
    float of_parent = (float)hopes->landed[parent] / (float)hopes->followed[parent];
    return ((float)hopes->landed[node] + more * of_parent) / ((float)hopes->followed[node] + more);
}

/* Photons that land carry alike if what leads to many of them is chosen as much more often. */
bool hopes_choose(const Hopes *hopes, uint32_t node, Lanes *mirrored)
{
    const float explored = 0.2f, least_mirrored = 0.25f, least_passed = 0.1f;
    const uint32_t few = 1 << 4; /* the node of four turns is beyond */
    if (hopes->followed[1] == 0) {
        if (node < few) *mirrored = lanes_clamp(*mirrored, explored, 1 - explored);
        return node < few;
    }
    if (node >= HOPES / 2 || hopes->landed[node] == 0) return false;
    const Lanes natural = *mirrored, rest = lanes_rest(natural);
    Lanes back = lanes_scale(natural, hope_of(hopes, 2 * node + 1)), on = lanes_scale(rest, hope_of(hopes, 2 * node));
    Lanes chosen = lanes_lesser(lanes_div(back, lanes_add(back, on)), lanes_rest(lanes_scale(rest, least_passed)));
    *mirrored = lanes_greater(chosen, lanes_scale(natural, least_mirrored));
    return true;
}

void hopes_count(Hopes *hopes, uint32_t node, bool landed)
{
    for (; node > 0; node /= 2) {
        hopes->followed[node]++;
        hopes->landed[node] += landed;
    }
}
