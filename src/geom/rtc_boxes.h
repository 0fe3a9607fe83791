/* rtc_boxes.h - boxes around the triangles of a mesh, for questions about a whole line; private to src/geom/rtc*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_BOXES_H
#define MEN_RTC_BOXES_H

#include "geom/rtc_scene.h"

typedef struct RtcBoxes RtcBoxes;

void rtc_boxes_free(RtcBoxes *boxes); /* NULL is fine */

/* Is told of primitives: first <= primitive < end. */
typedef void RtcTake(void *context, uint32_t first, uint32_t end);

/* Tells of all triangles of a mesh object which a line, without ends, may meet at a time, and of others near it. The boxes are made
 * when an object's mesh is first asked about, for nearly none is; where memory ends, that is all triangles. */
void rtc_along(const RtcScene *scene, uint32_t object, Vec3 origin, Vec3 direction, double time, RtcTake *take,
               void *context);

#endif
