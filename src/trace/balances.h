/* balances.h - the balances (optics/balance.h) of a scene's surfaces between its media, and their layers (optics/bsdf_kept.h),
 * each made when a path first needs it.
 * What they hold depends on the scene alone, not on who comes first.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BALANCES_H
#define MEN_BALANCES_H

#include "optics/balance.h"
#include "scene/scene.h"

typedef struct Balances Balances;

ATTR_NODISCARD Status balances_new(const Scene *scene, Balances **balances, Error *error);
void balances_free(Balances *balances); /* NULL is fine */

/* Where a surface is met. */
typedef struct BalanceCase {
    const SceneSurface *surface; /* of the scene */
    const BsdfSpec *spec;        /* of it at the hit, textures read */
    uint32_t medium_from, medium_to;
    bool bare; /* only the boundary between the media is there */
} BalanceCase;

/* NULL: the surface does without, or memory is short. Numbers that textures say are taken in steps: of 1/32 where it
 * is one of them, 1/8 of two, 1/4 of three; where there are more, there is no balance; and no layers where there is
 * any. By any thread; may take some hundredths of a second, the first time. */
const BsdfKept *balances_find(Balances *balances, const BalanceCase *at);

#endif
