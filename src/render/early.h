/* early.h - a picture of a film before all of its pixels have samples.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EARLY_H
#define MEN_EARLY_H

#include "render/film.h"

enum { EARLY_COARSEST = 16 };

/* The least step, 1, 2, 4, ... up to EARLY_COARSEST, of a lattice in the area, pixels from x0, y0 up to but without x1, y1, whose
 * pixels all have samples: every step-th column and row from x0, y0 on. 0: there is none. */
uint32_t early_step(const Film *film, const uint32_t area[4]);
/* Within the area, a pixel without samples gets a mean of those that have some among the four around it on such a lattice. The
 * first four channels of the image, of the whole film, are R G B A. */
void early_fill(const Film *film, const uint32_t area[4], uint32_t step, Image *image);
/* Channels R G B A of the whole film, filled so. The others without samples are black and clear. STATUS_NOMEM. */
ATTR_NODISCARD Status early_resolve(const Film *film, const uint32_t area[4], uint32_t step, Image *image,
                                    Error *error);

#endif
