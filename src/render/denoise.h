/* denoise.h - the noise that is left in a picture, averaged away over places that look alike.
 *
 * Each pixel becomes a mean over the pixels around it whose surroundings, a small square of pixels each, differ from its own by
 * no more than noise explains: non-local means, with the noise known from the samples themselves [RKZ12]. So a plain wall is
 * smoothed over the whole window, a line along itself, and a glint that nothing resembles stays as it is. What the samples
 * meet first - colour, direction and distance of the surface, which have little noise - keeps pixels of unlike things apart
 * [RMZ13]; and so does which things a line of sight comes to behind a boundary of clear media, such as a thin tube in a bottle, which
 * is as faint as the noise. What is mirrored there, and what differs within one thing, the colours alone tell.
 *
 * Deviations from these: the noise of a colour is that of the luminance, as pixel_noise.h has it of evenly spread samples,
 * in proportion to how the means of a pixel's first samples and of its others differ in that colour around the pixel, or
 * neighbours do, where colours make up for each other; it is held by what a pixel's own samples say, and two pixels that differ by
 * more than chance are not alike whatever is around them, so that a single bright pixel stays one, and makes no patch. What is
 * spread (spread.h) has been spread before. Weights have the shape of (1 - d / 8)^8, which is exp(-d) without the exponential.
 *
 * It is biased, as all of this kind: it takes a small thing that is as faint as the noise for noise. But not by its light: what
 * a neighbourhood has lost on balance goes back to those in it that have lost most. With more samples less is averaged, and the
 * picture converges to what it would without.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_DENOISE_H
#define MEN_DENOISE_H

#include "render/aov_film.h"

/* Pixels with fewer samples do not know their noise: they stay, and nothing is taken from them. */
enum { DENOISE_LEAST_SAMPLES = 4 };

/* Channels that can be carried: of shadow catchers, and of layers of lights. */
enum { DENOISE_MOST_CARRIED = 6 + 3 * LIMIT_LIGHT_GROUPS };

/* Of the image's first channels, R, G and B, and noise.Y, as
 * aov_film_resolve makes them of film and aovs; aovs must keep guides. carried: NULL, or an image of up to DENOISE_MOST_CARRIED
 * channels, a multiple of three, which belong to R, G and B in turn, and of which the same means are taken: what is the same in both stays so. With the
 * same bits for any number of threads. pool: NULL is fine. STATUS_NOMEM. */
ATTR_NODISCARD Status denoise(const Film *film, const AovFilm *aovs, Pool *pool, Image *image, Image *carried,
                              Error *error);

#endif
