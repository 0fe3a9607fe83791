/* embree.h - Embree 3 and 4 under one set of names. Only rtc*.c includes it, and the benchmarks. Those alone cast
 * packets: eight rays of different paths at once, sorted for nothing, would be 1.1 to 1.2 times as fast (bench limit).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMBREE_H
#define MEN_EMBREE_H

#if defined(MEN_EMBREE) && MEN_EMBREE == 4
#include <embree4/rtcore.h>
typedef struct RTCRayQueryContext EmbreeContext;
static inline void embree_init_context(EmbreeContext *context)
{
    rtcInitRayQueryContext(context);
}
static inline void embree_intersect(RTCScene scene, EmbreeContext *context, struct RTCRayHit *ray)
{
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    rtcIntersect1(scene, ray, &arguments);
}
static inline void embree_occluded(RTCScene scene, EmbreeContext *context, struct RTCRay *ray)
{
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    rtcOccluded1(scene, ray, &arguments);
}
static inline void embree_intersect8(const int *valid, RTCScene scene, EmbreeContext *context, struct RTCRayHit8 *rays)
{
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    rtcIntersect8(valid, scene, rays, &arguments);
}
static inline void embree_occluded8(const int *valid, RTCScene scene, EmbreeContext *context, struct RTCRay8 *rays)
{
    struct RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    rtcOccluded8(valid, scene, rays, &arguments);
}
#else
#include <embree3/rtcore.h>
typedef struct RTCIntersectContext EmbreeContext;
static inline void embree_init_context(EmbreeContext *context)
{
    rtcInitIntersectContext(context);
}
static inline void embree_intersect(RTCScene scene, EmbreeContext *context, struct RTCRayHit *ray)
{
    rtcIntersect1(scene, context, ray);
}
static inline void embree_occluded(RTCScene scene, EmbreeContext *context, struct RTCRay *ray)
{
    rtcOccluded1(scene, context, ray);
}
static inline void embree_intersect8(const int *valid, RTCScene scene, EmbreeContext *context, struct RTCRayHit8 *rays)
{
    rtcIntersect8(valid, scene, context, rays);
}
static inline void embree_occluded8(const int *valid, RTCScene scene, EmbreeContext *context, struct RTCRay8 *rays)
{
    rtcOccluded8(valid, scene, context, rays);
}
#endif

#endif
