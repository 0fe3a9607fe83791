/* bsdf_kept.h - what is the same at all hits of a surface between two media, made once: its balance, and clear layers.
 *
 * A layer whose index is the same at all wavelengths reflects as a function of one cosine. It is made once, and what it
 * reflects is read from a table: at each hit three directions are asked for, and Fresnel's equations with what facets add
 * to them are long.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BSDF_KEPT_H
#define MEN_BSDF_KEPT_H

#include "base/status.h"
#include "optics/bsdf_lobe.h"

/* What there is of a surface; NULL: to be made at each hit. Not owned. */
typedef struct BsdfKept {
    const Balance *balance;
    const BsdfLayer *skin, *coat; /* of a plastic, and over all; not where there is a balance */
    float inner; /* layer_inner_reflectance of the coat over the base, where there is a coat; < 0: to be computed */
} BsdfKept;

/* All that a layer depends on. */
typedef struct LayerLook {
    float eta; /* relative to the medium in front */
    float alpha_x, alpha_y;
    float tint;
} LayerLook;

/* A layer with its tables; it refers to them. */
typedef struct KeptLayer {
    LayerLook look;
    BsdfLayer layer;
    float reflectances[LAYER_READINGS], facet_reflectances[LAYER_READINGS];
} KeptLayer;

/* Takes a twentieth of a millisecond. Where a table would be off by more than it may be, as near critical angles, the layer does
 * without; of stretched facets, which reflect by more than a cosine, too. */
void kept_layer_make(const LayerLook *look, KeptLayer *kept);

#endif
