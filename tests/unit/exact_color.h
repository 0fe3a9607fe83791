/* exact_color.h - the colour of a whole spectrum, which the few wavelengths of paths must come to.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_EXACT_COLOR_H
#define MEN_TEST_EXACT_COLOR_H

#include "optics/observer.h"

static inline void color_from_spectrum(const Spectrum *emission, double rgb[3])
{
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int node = 0; node < OBSERVER_NODES; node++) {
        double weight[3], radiance = (double)spectrum_at_one(emission, (float)observer_node(node));
        observer_node_rgb(node, weight);
        for (int c = 0; c < 3; c++) rgb[c] += weight[c] * radiance;
    }
}

#endif
