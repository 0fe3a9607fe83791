/* guide_fit.h - lobes that describe from where the photons of a small region come; private to src/trace/guide*.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GUIDE_FIT_H
#define MEN_GUIDE_FIT_H

#include "trace/guide_lobes.h"
#include "trace/photon.h"

/* A photon whose neighbours are known. */
typedef struct GuideKnown {
    const Photon *photon;
    bool lent; /* by another cell */
} GuideKnown;

/* Photons of a cell: n >= 1 of them, and what is known: at first of GUIDE_CELL_KNOWN of its own at most. Lobes' places are
 * relative to the origin. */
typedef struct GuidePhotons {
    const Photon *photons;
    uint32_t n, n_known;
    GuideKnown known[GUIDE_CELL_LOBES];
    Vec3f origin;
    /* Photons of cells near by, which may come here as well, though none of so few has: each counts as so much of one. */
    struct {
        const Photon *photons;
        uint32_t n;
    } near[2];
    float near_part;
} GuidePhotons;

/* Some photons of a cell may have come by ways of which none that is known there tells, as where the tree was split between the
 * cell and those that do: then the nearest of n others that do become known, too, for the ways with most light first,
 * GUIDE_CELL_LENT at most. So do those that tell of ways by which photons came near by, and none here, where that may be chance. */
void guide_borrow(GuidePhotons *cell, const Photon *others, uint32_t n);

/* Makes a lobe of each known photon, which are put into another order, and one around all: the ways that light takes are
 * weighted after the flux of all. Returns how many. */
uint32_t guide_fit(GuidePhotons *cell, GuideLobe *lobes);

#endif
