/* compare.h - how much two pictures differ.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_COMPARE_H
#define MEN_COMPARE_H

#include "image/image.h"

/* Over R, G, B of all pixels. relative: squared difference over (reference^2 + (white / 10)^2), meaned.
 * relative_error: of the luminance of all pixels, |difference| over the root of the same, meaned: what a render states as its noise. */
typedef struct Comparison {
    double white; /* as it was given */
    double rmse, relative_mse, relative_error, max_difference, mean_a[3], mean_b[3];
    double flip;           /* mean of the FLIP map (Andersson et al. 2020) of the two under the sRGB view, over white */
    uint32_t max_x, max_y; /* where the largest difference is */
    uint64_t n_not_finite; /* channels that are NaN or infinite in either; left out of the sums */
} Comparison;

/* b: the reference. white: the value that a display shows white, > 0. flip only when asked for. STATUS_USAGE when the sizes or
 * channels do not match, with both. */
ATTR_NODISCARD Status image_compare(const Image *a, const Image *b, double white, bool flip, Comparison *comparison,
                                    Error *error);

#endif
