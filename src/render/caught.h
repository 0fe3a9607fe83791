/* caught.h - shadow catchers in a picture that is made: of their light it holds only what other things change of it.
 *
 * Differential rendering, after [Debevec98], by pixels: `lit` is what a pixel's samples found of catchers' light, `bare`
 * what they would have found if nothing were there but lights and catchers, both as means. Of a picture behind, a part
 * lit / bare is left, in the channel in which that is least; it comes through, as alpha says, and light that makes
 * another channel brighter than that is added to it: shadows of coloured glass are coloured, caustics only add. So over a
 * picture that shows `bare` there is `lit`, exactly. It is the ratio of means: that of a sample says nothing, and its
 * mean would be another one. Samples that nothing has changed have found the same in both, to the bit, and no noise of
 * them is left.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CAUGHT_H
#define MEN_CAUGHT_H

#include "render/film.h"

/* The channels of what is caught, without the part. */
enum { CAUGHT_LIT = 0, CAUGHT_BARE = 3, CAUGHT_CHANNELS = 6 };

/* R, G, B and alpha of a pixel as if catchers were like all else become what they are beside them. part: of the pixel,
 * that catchers cover. */
void caught_take(const float caught[CAUGHT_CHANNELS], float part, float rgba[4]);
/* The same by the film's own means. Nothing where its scene has no catchers, or the pixel no samples. */
void caught_take_pixel(const Film *film, uint32_t x, uint32_t y, float rgba[4]);
/* Of all pixels, the means of lit and bare, for what is to be done with the picture before they are taken out of it.
 * image: the film's, with what has been done already; that is catchers' as far as they cover the pixel. STATUS_NOMEM. */
ATTR_NODISCARD Status caught_means(const Film *film, const Image *image, Image *means, Error *error);
/* Takes them out of the image's first channels, R, G, B and A. */
void caught_take_all(const Film *film, const Image *means, Image *image);

#endif
