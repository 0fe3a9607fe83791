/* rtc_convex.h - convex meshes of few faces, cut gems above all, as the planes of their faces; private to src/geom/rtc*.c.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RTC_CONVEX_H
#define MEN_RTC_CONVEX_H

#include "geom/rtc_scene.h"

/* Meshes of more primitives are not looked at, nor any where there are more objects of such meshes. */
enum { RTC_CONVEX_MOST = 256, RTC_CONVEX_OBJECTS = 1 << 16 };

typedef struct RtcConvex RtcConvex;

/* The mesh of an object, which stands still and keeps its shape, in the world, if it is convex to within rounding; else NULL, also
 * where memory ends. To be freed by rtc_convex_free. */
RtcConvex *rtc_convex_make(const RtcScene *scene, uint32_t object);
/* Keeps what rtc_convex_is_off and rtc_convex_exit need, and no more. */
void rtc_convex_trim(RtcConvex *convex);
void rtc_convex_free(RtcConvex *convex);
/* Around it. */
Ball rtc_convex_ball(const RtcConvex *convex);
/* Whether the plane of one of its faces has all points on its other side, by more than `margin`. */
bool rtc_convex_is_apart(const RtcConvex *convex, const Vec3 *points, uint32_t n, double margin);
/* Whether it is on one side of a plane; normal: unit. Where it is not farther from it than `margin`, it touches what is in the
 * plane: that is noted, and true if there is room for it. */
bool rtc_convex_note_plane(RtcConvex *convex, Vec3 normal, Vec3 place, double margin);
/* Whether a point of it is farther from all that it touches than that margin. */
bool rtc_convex_is_off(const RtcConvex *convex, Vec3 point);
bool rtc_convex_is_within(const RtcConvex *convex, const Ball *ball, double margin);

/* The face by which a line from within leaves it, as far as float tells; NULL: none. Its triangles, by their primitives. */
typedef struct RtcFace {
    uint32_t n;
    const uint32_t *primitives;
} RtcFace;
bool rtc_convex_exit(const RtcConvex *convex, Vec3 from, Vec3f direction, RtcFace *face);

#endif
