/* guide_fit.h - lobes that describe from where the photons of a small region come; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_FIT_H
#define MEN_GUIDE_FIT_H

#include "trace/guide_lobes.h"
#include "trace/photon.h"

/* Makes lobes of n_known <= GUIDE_CELL_KNOWN photons that have been looked around at, and one around all n >= 1 photons
 * of a cell, after whose flux the ways that light takes are weighted. `known` is put into another order. Places are relative to
 * origin. Returns how many. */
uint32_t guide_fit(Photon *known, uint32_t n_known, const Photon *photons, uint32_t n, Vec3f origin, GuideLobe *lobes);

#endif
