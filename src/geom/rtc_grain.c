/* rtc_grain.c - where which triangles stand.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_grain.h"

#include <float.h>

#include "base/attr.h"

/* How near such a triangle may be to what is found, of its coordinates. They are at one place within 2^-21; and where something
 * else is found by a ray, that may be off by the usual doubt (rtc.c) of the ray's own coordinates. Of these it need be no more
 * than that of a thirtieth of the triangle's, for what float makes of the triangle is a thirtieth of the usual doubt. */
#define BESIDE 0x1p-17
/* A ray asks where the meshes' largest coordinate is so many times its own. */
#define MATTERS 6

static uint32_t highest_byte(float coordinate)
{
    uint32_t bits;
    memcpy(&bits, &coordinate, sizeof bits);
    return bits >> 24;
}

void rtc_grain_begin(RtcGrain *grain, float most)
{
    enum { HALF = RTC_GRAIN_SLOTS / 2, SIGN = 0x80 };
    grain->most = most;
    grain->matters = most / MATTERS;
    int top = (int)highest_byte(most);
    for (int i = 0; i < SIGN; i++) {
        int below = top - i < 0 ? 0 : top - i < HALF ? top - i : HALF - 1;
        grain->slot[i] = (uint8_t)(RTC_GRAIN_SLOTS - 1 - below);
        grain->slot[i | SIGN] = (uint8_t)below;
    }
    for (size_t i = 0; i < COUNT_OF(grain->cells); i++) grain->cells[i] = FLT_MIN;
}

void rtc_grain_add(RtcGrain *grain, Box3 box, double coordinate)
{
    double beside = BESIDE * coordinate;
    const double low[3] = {box.min.x, box.min.y, box.min.z}, high[3] = {box.max.x, box.max.y, box.max.z};
    float coordinates = nextafterf((float)coordinate, INFINITY);
    uint32_t first[3], last[3];
    for (int axis = 0; axis < 3; axis++) {
        first[axis] = grain->slot[highest_byte((float)(low[axis] - beside))];
        last[axis] = grain->slot[highest_byte((float)(high[axis] + beside))];
    }
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++) {
                float *cell = &grain->cells[x + RTC_GRAIN_SLOTS * (y + RTC_GRAIN_SLOTS * z)];
                *cell = float_max(*cell, coordinates);
            }
}
