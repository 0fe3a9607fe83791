/* combinations.h - what combinations of objects enclose, and those of which nothing is left: parts of compiling.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMBINATIONS_H
#define MEN_COMBINATIONS_H

#include "scene/compile.h"

/* Fills in the volumes of the hulls that are combinations, in cubic scene units, to about 1e-3 of plain shapes. The same for any
 * number of threads; the pool may be NULL. */
ATTR_NODISCARD Status combinations_measure(CompiledScene *compiled, Pool *pool, Error *error);
/* After that: D_NOTHING_LEFT for clear ones without volume, and for opaque ones that no line finds anything of. */
ATTR_NODISCARD Status combinations_report_empty(const CompiledScene *compiled, Diag *diag, Error *error);

#endif
