/* pixel_noise.h - the standard error of each pixel, as far as its samples and its neighbours' tell.
 *
 * A pixel of few samples knows little of its own variance: where light is rare, those that have met none believe that they are
 * done. So the variance of its samples is drawn towards the mean of those around it, by as much of the differences among
 * them as is chance: differences between pixels that touch, over those in the whole neighbourhood. What then is left of it by
 * evenly spread samples (evenness.h) is told by a neighbourhood of three blocks of the sampler.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PIXEL_NOISE_H
#define MEN_PIXEL_NOISE_H

#include "base/pool.h"
#include "render/spread.h"

/* For each pixel of the film, by rows: the standard error of the luminance; 0 with fewer than 2 samples. spread: NULL, or
 * which samples are shared out. pool: NULL, or who shares the work; the same bits for any number of threads. STATUS_NOMEM. */
ATTR_NODISCARD Status pixel_noise(const Film *film, const Spread *spread, Pool *pool, float *noise, Error *error);

#endif
