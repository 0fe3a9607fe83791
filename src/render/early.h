/* early.h - a picture of a film before all of its pixels have samples.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EARLY_H
#define MEN_EARLY_H

#include "render/film.h"

enum { EARLY_COARSEST = 16 };

/* The least step, 1, 2, 4, ... up to EARLY_COARSEST, of a lattice whose pixels all have samples: every step-th column and row from
 * the first on. 0: there is none. */
uint32_t early_step(const Film *film);
/* A pixel without samples gets a mean of those that have some among the four around it on such a lattice. The first four channels of
 * the image, of the film's size, are R G B A. */
void early_fill(const Film *film, uint32_t step, Image *image);
/* Channels R G B A, filled so. The others without samples are black and clear. STATUS_NOMEM. */
ATTR_NODISCARD Status early_resolve(const Film *film, uint32_t step, Image *image, Error *error);

#endif
