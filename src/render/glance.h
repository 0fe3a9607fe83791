/* glance.h - how bright a picture will be, before it has any sample.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GLANCE_H
#define MEN_GLANCE_H

#include "render/brightness.h"
#include "trace/world.h"

/* What some thousand paths say, evenly spread over a frame of width x height pixels; a function of the scene and the camera alone.
 * With few paths each place counts as brighter or darker than it is: white is known to a stop or so. STATUS_NOMEM. */
ATTR_NODISCARD Status glance(const World *world, uint32_t width, uint32_t height, Brightness *brightness, Error *error);

#endif
