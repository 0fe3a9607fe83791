/* early.h - a picture of a film before all of its pixels have samples.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EARLY_H
#define MEN_EARLY_H

#include "render/film.h"

/* Channels R G B A of the whole film. Within the area, pixels from x0, y0 up to but without x1, y1, one without samples gets a
 * mean of those that have some among the four around it on a lattice: every step-th column and row from x0, y0 on. The others
 * without samples are black and clear. STATUS_NOMEM. */
ATTR_NODISCARD Status early_resolve(const Film *film, const uint32_t area[4], uint32_t step, Image *image,
                                    Error *error);

#endif
