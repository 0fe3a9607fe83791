/* balance.h - what the tables leave over of a surface's light, put right for the very surface.
 *
 * The tables of microfacet.h, stretched.h and layered.h keep the light at round facets to some per mille. Stretched ones, and
 * layers towards a smaller index, have more dimensions than tables can follow; formulas then lose or make up to some
 * per cent. So for a surface between two media all is summed once, at directions all around, and what the formulas are
 * off is kept: what is to be added to what facets reflect and miss, and factors to t of layered.h, the same for v and
 * l, with which what is under a cover gives back all that the cover lets pass (Sinkhorn's scaling, as in microfacet.h).
 * Reciprocity and sampling stay as they are. Indices are taken at BALANCE_NM, for all wavelengths.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BALANCE_H
#define MEN_BALANCE_H

#include "base/status.h"
#include "optics/bsdf_spec.h"

#define BALANCE_NM 550.0f

/* Whether what the formulas are off is worth it. eta_i, eta_t: as of bsdf_from_spec. */
bool balance_is_wanted(const BsdfSpec *spec, float eta_i, float eta_t);
/* Takes some hundredths of a second. STATUS_NOMEM: *balance is NULL. To be freed with free(). */
ATTR_NODISCARD Status balance_new(const BsdfSpec *spec, float eta_i, float eta_t, Balance **balance);

#endif
