/* packets.h - the rays of a render, as they were noted, and what they cost in packets of eight.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_PACKETS_H
#define MEN_TEST_PACKETS_H

#include "bare.h"

typedef struct NotedRay {
    float origin[3], direction[3], t_near, t_far;
    float met; /* the nearest surface's distance, INFINITY for none; of a question for any: 0 when something is there */
    float tolerance; /* of that distance: triangles are not where pieces are */
    bool any;
} NotedRay;

typedef struct Packets Packets;

/* Packets of eight rays each, of one question, as alike as can be: of every 4,096 rays in the order in which they were
 * cast, those are together whose directions share an octant and whose origins are neighbours. A renderer with hundreds of
 * paths in flight could not do better, and would have to pay for the sorting, which is not in the time. NULL: no memory. */
Packets *packets_new(const NotedRay *rays, size_t n);
/* Casts them all through bare Embree, and returns seconds of the processor. */
double packets_cast(const Packets *packets, RTCScene scene);
void packets_free(Packets *packets);

#endif
