/* exposure.h - by how much a picture is brightened for a display.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EXPOSURE_H
#define MEN_EXPOSURE_H

#include <stdbool.h>

typedef struct Exposure {
    double stops;   /* each is twice the light */
    bool automatic; /* these are beside what the picture asks for */
} Exposure;

#endif
