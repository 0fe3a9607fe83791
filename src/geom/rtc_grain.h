/* rtc_grain.h - how coarse Embree's numbers are from place to place; private to src/geom/rtc*.c.
 *
 * What float rounds of a triangle goes with the largest coordinate of its corners, and of the ray's start. A floor is a
 * hundred times as coarse at its far end as the glass that stands on it, and if all distances were believed to be as coarse
 * as that, Embree would have to begin its search far behind the ray's start, and to go on far behind what it has found. So a
 * grid says how large the coordinates are of what stands near a place. Its cells grow with the distance from the origin, as
 * floats do: the next one begins where a coordinate has four times the size.
 *
 * Pieces are exact, and need none of this: only meshes count. Of these faces that are level count by their height alone; see
 * rtc_reach.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_GRAIN_H
#define MEN_RTC_GRAIN_H

#include "base/lanes.h"
#include "base/vec3.h"

/* Along each axis: from far on the negative side to zero, and from there to far on the other. */
enum { RTC_GRAIN_SLOTS = 16 };

typedef struct RtcGrain {
    float most;        /* not less than any coordinate of the meshes that counts; 0: there are none */
    float matters;     /* rays whose own coordinates and lengths are larger need not ask */
    uint8_t slot[256]; /* of a coordinate, by the highest byte of it as a float: its sign, and its power of 4 */
    float cells[RTC_GRAIN_SLOTS * RTC_GRAIN_SLOTS *
                RTC_GRAIN_SLOTS]; /* > 0: as `most`, of triangles near each; x first */
} RtcGrain;

/* The largest coordinate of the triangles near a place. */
static inline float rtc_grain_at(const RtcGrain *grain, Vec3 place)
{
    Lanes rounded = lanes((float)place.x, (float)place.y, (float)place.z, 0);
    uint32_t bits[LANES];
    memcpy(bits, &rounded, sizeof bits);
    uint32_t x = grain->slot[bits[0] >> 24], y = grain->slot[bits[1] >> 24], z = grain->slot[bits[2] >> 24];
    return grain->cells[x + RTC_GRAIN_SLOTS * (y + RTC_GRAIN_SLOTS * z)];
}

/* Begins a grid for meshes whose coordinates are no larger than `most`. */
void rtc_grain_begin(RtcGrain *grain, float most);
/* Adds triangles within a box; coordinate: the largest that float rounds there. */
void rtc_grain_add(RtcGrain *grain, Box3 box, double coordinate);

#endif
