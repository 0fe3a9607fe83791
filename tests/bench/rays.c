/* rays.c - what the exactness of a ray costs, and a crossing alone.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>

#include "../unit/icosphere.h"
#include "bare.h"
#include "base/clock.h"
#include "base/hash.h"
#include "measure.h"
#include "nest/cross.h"

enum { RAYS = 200000 };

/* ---- rtc_nearest against bare Embree, on the same rays ---- */

typedef struct RaySet {
    Vec3 origin[RAYS];
    Vec3f direction[RAYS];
} RaySet;

static double unit(uint64_t *state)
{
    *state = hash_u64(*state);
    return hash_to_unit(*state);
}

static void make_rays(RaySet *rays)
{
    uint64_t state = 1;
    for (int i = 0; i < RAYS; i++) {
        Vec3 from = vec3_normalize(vec3(unit(&state) - 0.5, unit(&state) - 0.5, unit(&state) - 0.5));
        Vec3 to = vec3(unit(&state) - 0.5, unit(&state) - 0.5, unit(&state) - 0.5);
        rays->origin[i] = vec3_scale(from, 4);
        rays->direction[i] = vec3f_from(vec3_normalize(vec3_sub(to, rays->origin[i])));
    }
}

static double time_bare(RTCScene scene, const RaySet *rays)
{
    EmbreeContext context;
    embree_init_context(&context);
    double start = clock_cpu_s();
    for (int i = 0; i < RAYS; i++) {
        struct RTCRayHit ray = {.ray = {.org_x = (float)rays->origin[i].x,
                                        .org_y = (float)rays->origin[i].y,
                                        .org_z = (float)rays->origin[i].z,
                                        .dir_x = rays->direction[i].x,
                                        .dir_y = rays->direction[i].y,
                                        .dir_z = rays->direction[i].z,
                                        .tfar = INFINITY,
                                        .mask = 0xffffffffU}};
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        embree_intersect(scene, &context, &ray);
    }
    return clock_cpu_s() - start;
}

static double time_exact(const RtcScene *scene, const RaySet *rays)
{
    HitList hits = {0};
    double start = clock_cpu_s();
    for (int i = 0; i < RAYS; i++) {
        Ray ray = ray_make(rays->origin[i], rays->direction[i]);
        rtc_nearest(scene, &ray, &hits, NULL);
    }
    double seconds = clock_cpu_s() - start;
    hit_list_clear(&hits);
    return seconds;
}

static void bench_nearest(void)
{
    static RaySet rays;
    make_rays(&rays);
    Mesh *mesh = icosphere(1, 7);
    RtcScene *scene;
    Error error;
    if (!mesh) bench_fail("rays", NULL);
    RtcObject object = {.mesh = mesh, .to_world = affine_identity()};
    if (rtc_scene_new(&object, 1, 0, 1, &scene, &error) != STATUS_OK) bench_fail("rays", NULL);
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene bare = bare_mesh(device, mesh);
    double ratio[RUNS], bare_ns[RUNS];
    for (int i = 0; i < RUNS; i++) {
        double b = time_bare(bare, &rays), e = time_exact(scene, &rays);
        ratio[i] = e / b;
        bare_ns[i] = b / RAYS * 1e9;
    }
    printf("a sphere of %u triangles, %d rays\n", mesh->n_triangles, RAYS);
    print_figure("  bare rtcIntersect1, robust", bare_ns, RUNS, "ns");
    print_figure("  rtc_nearest over bare rtcIntersect1", ratio, RUNS, "x");
    rtcReleaseScene(bare);
    rtcReleaseDevice(device);
    rtc_scene_free(scene);
    mesh_free(mesh);
}

/* ---- crossings alone ---- */

static void bench_crossing(void)
{
    enum { HULLS = 8, TURNS = 400000 };
    NestHull hulls[HULLS];
    for (uint32_t h = 0; h < HULLS; h++) hulls[h] = (NestHull){h + 1, (int32_t)h, NEST_STATE_UNKNOWN, 1, false};
    NestOrder order;
    if (nest_order_build(&order, NEST_PRIORITY, hulls, HULLS, NULL, 0, NULL) != STATUS_OK) bench_fail("rays", NULL);
    double ns[RUNS];
    uint64_t sink = 0;
    for (int run = 0; run < RUNS; run++) {
        NestList list;
        nest_list_init(&list);
        double start = clock_cpu_s();
        for (int i = 0; i < TURNS; i++)
            for (uint32_t k = 0; k < 8; k++) { /* +a +b +c +d -a -b -c -d */
                NestPass pass = {(uint32_t)i % 5 + k % 4, k < 4};
                NestCrossing crossing;
                if (nest_cross_one(&list, &order, pass, &crossing) != STATUS_OK) bench_fail("rays", NULL);
                sink += crossing.medium_to;
            }
        ns[run] = (clock_cpu_s() - start) / (TURNS * 8.0) * 1e9;
    }
    print_figure(sink ? "nest_cross, four hulls deep" : "", ns, RUNS, "ns");
    nest_order_clear(&order);
}

void bench_rays(void)
{
    bench_nearest();
    bench_crossing();
}
