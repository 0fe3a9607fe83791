/* packets.c - rays eight at a time.
 * SPDX-License-Identifier: Apache-2.0 */
#include "packets.h"

#include <stdlib.h>
#include <string.h>

#include "base/clock.h"

enum { WINDOW = 4096, LANES = 8 };

typedef struct Packet {
    struct RTCRay8 rays;
    int valid[LANES];
    bool any;
} Packet;

struct Packets {
    Packet *items; /* aligned as Embree wants it */
    size_t n;
};

typedef struct Keyed {
    uint64_t key;
    const NotedRay *ray;
} Keyed;

static uint64_t spread_bits(uint64_t x) /* ten bits, two places apart */
{
    uint64_t y = 0;
    for (int bit = 0; bit < 10; bit++) y |= (x >> bit & 1) << (3 * bit);
    return y;
}

/* The question, then the octant of the direction, then the place along Morton's curve through the window's bounds. */
static uint64_t key_of(const NotedRay *ray, const float low[3], const float high[3])
{
    uint64_t key = (uint64_t)ray->any << 33;
    for (int axis = 0; axis < 3; axis++) {
        float width = high[axis] - low[axis], part = width > 0 ? (ray->origin[axis] - low[axis]) / width : 0;
        key |= (uint64_t)(ray->direction[axis] < 0) << (30 + axis);
        key |= spread_bits((uint64_t)(part * 1023)) << axis;
    }
    return key;
}

static int by_key(const void *a, const void *b)
{
    const Keyed *x = a, *y = b;
    return x->key < y->key ? -1 : x->key > y->key;
}

static void sort_window(const NotedRay *rays, size_t n, Keyed *sorted)
{
    float low[3], high[3];
    memcpy(low, rays[0].origin, sizeof low);
    memcpy(high, rays[0].origin, sizeof high);
    for (size_t i = 0; i < n; i++)
        for (int axis = 0; axis < 3; axis++) {
            if (rays[i].origin[axis] < low[axis]) low[axis] = rays[i].origin[axis];
            if (rays[i].origin[axis] > high[axis]) high[axis] = rays[i].origin[axis];
        }
    for (size_t i = 0; i < n; i++) sorted[i] = (Keyed){key_of(&rays[i], low, high), &rays[i]};
    qsort(sorted, n, sizeof *sorted, by_key);
}

static void put_lane(Packet *packet, int lane, const NotedRay *ray)
{
    struct RTCRay8 *to = &packet->rays;
    to->org_x[lane] = ray->origin[0];
    to->org_y[lane] = ray->origin[1];
    to->org_z[lane] = ray->origin[2];
    to->dir_x[lane] = ray->direction[0];
    to->dir_y[lane] = ray->direction[1];
    to->dir_z[lane] = ray->direction[2];
    to->tnear[lane] = ray->t_near;
    to->tfar[lane] = ray->t_far;
    to->mask[lane] = 0xffffffffU;
    packet->valid[lane] = -1;
}

/* A packet ends where it is full, and where the question changes. */
static void pack_window(Packets *packets, const Keyed *sorted, size_t n)
{
    int lane = LANES;
    for (size_t i = 0; i < n; i++) {
        if (lane == LANES || packets->items[packets->n - 1].any != sorted[i].ray->any) {
            memset(&packets->items[packets->n], 0, sizeof *packets->items);
            packets->items[packets->n++].any = sorted[i].ray->any;
            lane = 0;
        }
        put_lane(&packets->items[packets->n - 1], lane++, sorted[i].ray);
    }
}

Packets *packets_new(const NotedRay *rays, size_t n)
{
    Packets *packets = calloc(1, sizeof *packets);
    Keyed *sorted = malloc(WINDOW * sizeof *sorted);
    /* of each window, either question may leave a packet that is not full */
    size_t most = n / LANES + 2 * (n / WINDOW + 1);
    if (packets) packets->items = aligned_alloc(64, (most * sizeof(Packet) + 63) / 64 * 64);
    if (!packets || !sorted || !packets->items) {
        packets_free(packets);
        free(sorted);
        return NULL;
    }
    for (size_t first = 0; first < n; first += WINDOW) {
        size_t part = n - first < WINDOW ? n - first : WINDOW;
        sort_window(rays + first, part, sorted);
        pack_window(packets, sorted, part);
    }
    free(sorted);
    return packets;
}

double packets_cast(const Packets *packets, RTCScene scene)
{
    EmbreeContext embree;
    embree_init_context(&embree);
    double start = clock_cpu_s();
    for (size_t i = 0; i < packets->n; i++) {
        const Packet *packet = &packets->items[i];
        if (packet->any) {
            struct RTCRay8 rays = packet->rays;
            embree_occluded8(packet->valid, scene, &embree, &rays);
        } else {
            struct RTCRayHit8 rays;
            rays.ray = packet->rays;
            memset(rays.hit.geomID, 0xff, sizeof rays.hit.geomID);
            embree_intersect8(packet->valid, scene, &embree, &rays);
        }
    }
    return clock_cpu_s() - start;
}

void packets_free(Packets *packets)
{
    if (packets) free(packets->items);
    free(packets);
}
