/* embree.h - Embree 3 and 4 under one set of names. Only rtc*.c includes it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_EMBREE_H
#define MEN_EMBREE_H

#if defined(MEN_EMBREE) && MEN_EMBREE == 4
#include <embree4/rtcore.h>
typedef struct RTCRayQueryContext EmbreeContext;
static inline void embree_init_context(EmbreeContext *context) { rtcInitRayQueryContext(context); }
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
#else
#include <embree3/rtcore.h>
typedef struct RTCIntersectContext EmbreeContext;
static inline void embree_init_context(EmbreeContext *context) { rtcInitIntersectContext(context); }
static inline void embree_intersect(RTCScene scene, EmbreeContext *context, struct RTCRayHit *ray)
{
    rtcIntersect1(scene, context, ray);
}
static inline void embree_occluded(RTCScene scene, EmbreeContext *context, struct RTCRay *ray)
{
    rtcOccluded1(scene, context, ray);
}
#endif

#endif
