/* bench.c - what nesting and exactness cost, as ratios of two things measured in one run.
 * usage: bench SCENE...          all of them; the examples are rendered small; run by `make bench`
 *        bench limit SCENE...    a render's time in ratio to that of its own rays
 *        bench paths SCENE...    paths for each second of the processor
 * Each figure is the median of several runs, with the range of all of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/hash.h"
#include "geom/embree.h"
#include "geom/mesh_file.h"
#include "geom/rtc.h"
#include "nest/cross.h"
#include "check/report.h"
#include "measure.h"

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

/* What Embree alone makes of a mesh. */
static RTCScene bare_scene(RTCDevice device, const Mesh *mesh)
{
    RTCScene bare = rtcNewScene(device);
    rtcSetSceneFlags(bare, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh->positions, 0,
                               sizeof(Vec3f), mesh->n_vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh->triangles, 0, 12,
                               mesh->n_triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(bare, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(bare);
    return bare;
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
        rtc_nearest(scene, &ray, &hits);
    }
    double seconds = clock_cpu_s() - start;
    hit_list_clear(&hits);
    return seconds;
}

static void bench_rays(void)
{
    static RaySet rays;
    make_rays(&rays);
    Mesh *mesh;
    RtcScene *scene;
    Error error;
    if (mesh_make_sphere(1, 7, &mesh, &error) != STATUS_OK) exit(1);
    RtcObject object = {.mesh = mesh, .to_world = affine_identity()};
    if (rtc_scene_new(&object, 1, 0, 1, &scene, &error) != STATUS_OK) exit(1);
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene bare = bare_scene(device, mesh);
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

/* ---- from a mesh file to a scene ---- */

static void write_ply(const char *path, const Mesh *mesh)
{
    FILE *file = fopen(path, "wb");
    if (!file) exit(1);
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
            "property float z\nelement face %u\nproperty list uchar int vertex_indices\nend_header\n",
            mesh->n_vertices, mesh->n_triangles);
    fwrite(mesh->positions, sizeof *mesh->positions, mesh->n_vertices, file);
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        fputc(3, file);
        fwrite(mesh->triangles[i], sizeof *mesh->triangles, 1, file);
    }
    if (fclose(file) != 0) exit(1);
}

/* Load, weld, closedness, geometry and hierarchy; or Embree's part of it alone. Both with two threads. */
static void bench_mesh_file(void)
{
    enum { THREADS = 2 };
    char path[] = "/tmp/meniscus-bench-XXXXXX";
    int descriptor = mkstemp(path);
    Mesh *sphere;
    Error error;
    if (descriptor < 0 || mesh_make_sphere(1, 8, &sphere, &error) != STATUS_OK) exit(1);
    close(descriptor);
    write_ply(path, sphere);
    RTCDevice device = rtcNewDevice("threads=2");
    Pool *pool;
    if (pool_new(THREADS, &pool, &error) != STATUS_OK) exit(1);
    double ratio[RUNS], crossing[RUNS], bare_ms[RUNS], bytes = 0;
    for (int i = 0; i < RUNS; i++) {
        double start = clock_now_s();
        rtcReleaseScene(bare_scene(device, sphere));
        double bare = clock_now_s() - start;
        Mesh *mesh;
        MeshReport report;
        MeshCrossings found;
        RtcScene *scene;
        start = clock_now_s();
        if (mesh_load_ply(path, NULL, &mesh, &error) != STATUS_OK || mesh_weld(mesh, &error) != STATUS_OK ||
            mesh_inspect(mesh, &report, &error) != STATUS_OK || !report.closed)
            exit(1);
        RtcObject object = {.mesh = mesh, .to_world = affine_identity()};
        if (rtc_scene_new(&object, 1, 0, THREADS, &scene, &error) != STATUS_OK) exit(1);
        ratio[i] = (clock_now_s() - start) / bare;
        start = clock_now_s();
        if (mesh_find_crossings(mesh, pool, &found, &error) != STATUS_OK || found.n) exit(1);
        crossing[i] = (clock_now_s() - start) / bare;
        bare_ms[i] = bare * 1e3;
        bytes = (double)rtc_scene_bytes(scene) / mesh->n_triangles;
        rtc_scene_free(scene);
        mesh_free(mesh);
    }
    printf("a binary PLY file of %u triangles, two threads; Embree holds %.1f bytes a triangle beside the mesh\n",
           sphere->n_triangles, bytes);
    print_figure("  Embree's own building of it", bare_ms, RUNS, "ms");
    print_figure("  from the file to the scene, over that", ratio, RUNS, "x");
    print_figure("  looking whether it crosses itself, over that", crossing, RUNS, "x");
    rtcReleaseDevice(device);
    pool_free(pool);
    mesh_free(sphere);
    remove(path);
}

/* ---- crossings alone ---- */

static void bench_crossing(void)
{
    enum { HULLS = 8, TURNS = 400000 };
    NestHull hulls[HULLS];
    for (uint32_t h = 0; h < HULLS; h++) hulls[h] = (NestHull){h + 1, (int32_t)h, NEST_STATE_UNKNOWN, 1, false};
    NestOrder order;
    if (nest_order_build(&order, NEST_PRIORITY, 0, hulls, HULLS, NULL, 0, NULL) != STATUS_OK) exit(1);
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
                if (nest_cross(&list, &order, &pass, 1, &crossing) != STATUS_OK) exit(1);
                sink += crossing.medium_to;
            }
        ns[run] = (clock_cpu_s() - start) / (TURNS * 8.0) * 1e9;
    }
    print_figure(sink ? "nest_cross, four hulls deep" : "", ns, RUNS, "ns");
    nest_order_clear(&order);
}

/* ---- whole renders ---- */

static RenderStats render_once(const CompiledScene *compiled, unsigned threads)
{
    Pool *pool = pool_of(threads);
    RenderStats stats = render_at(compiled, 96, 72, 16, pool);
    pool_free(pool);
    return stats;
}

static void bench_scene(const char *path)
{
    Made made;
    made_from_file(&made, path);
    double path_us[RUNS], ray_ns[RUNS], two[RUNS];
    RenderStats one = {0};
    for (int i = 0; i < RUNS; i++) {
        one = render_once(made.compiled, 1);
        RenderStats both = render_once(made.compiled, 2);
        path_us[i] = one.cpu_seconds / (double)one.paths * 1e6;
        ray_ns[i] = one.cpu_seconds / (double)one.rays * 1e9;
        two[i] = one.seconds / both.seconds;
    }
    printf("%s: %.2f rays a path, %.1f %% of crossings silent, %llu faults in %llu crossings\n", path,
           (double)one.rays / (double)one.paths,
           100 * (double)one.silent_crossings / (double)(one.crossings ? one.crossings : 1),
           (unsigned long long)one.nesting_faults, (unsigned long long)one.crossings);
    print_figure("  a path", path_us, RUNS, "us");
    print_figure("  a ray, shading and all", ray_ns, RUNS, "ns");
    print_figure("  two threads over one", two, RUNS, "x");
    made_clear(&made);
}

/* ---- many objects ---- */

#define SODA                                                                                                           \
    "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } medium soda { ior = 1.33 state = liquid } "         \
    "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] } "           \
    "cylinder drink { interior = soda from = <0, 9.9, 0> to = <0, 80, 0> radius = 37.1 } "                             \
    "ground { y = -.01 } environment { } camera { from = <0, 90, -240> to = <0, 45, 0> fov = 24 } "                    \
    "render { bounces = 64 } let n = %u let size = 16 / n ^ (1 / 3) "                                                  \
    "for (i in 1..n) { let r = 34 * sqrt(rnd(i, 2)) let a = 360 * rnd(i, 1) "                                          \
    "%s translate(<r * cos(a), 14 + 60 * rnd(i, 4), r * sin(a)>) } }"

/* A soda with ever more, ever smaller bubbles, that fill the same part of it: what a ray costs should grow as the depth
 * of the hierarchy does, what a scene costs as the number of bubbles. */
static void bench_bubbles(const char *name, const char *bubble)
{
    enum { SIZES = 5, TURNS = 3 };
    double first_ns = 0;
    printf("%s in a soda: for each ray, in ratio to 10 of them; building, compiling, and checking the scene\n", name);
    for (unsigned k = 0, n = 10; k < SIZES; k++, n *= 10) {
        char text[2000];
        Made made;
        double ns[TURNS];
        RenderStats stats = {0};
        snprintf(text, sizeof text, SODA, n, bubble);
        made_from_text(&made, text);
        for (int i = 0; i < TURNS; i++) {
            stats = render_once(made.compiled, 1);
            ns[i] = stats.cpu_seconds / (double)stats.rays * 1e9;
        }
        double ray_ns = spread_of(ns, TURNS).median;
        double start = clock_cpu_s();
        Buf out = {0};
        report_warnings(made.compiled, &made.diag);
        report_remarks(made.compiled, &made.diag);
        report_print(made.compiled, &made.sources, &out);
        double check_s = clock_cpu_s() - start;
        buf_clear(&out);
        if (k == 0) first_ns = ray_ns;
        printf("  %7u %9.0f ns a ray %6.2f x %7.1f rays a path %8.3f s to build %8.3f s to compile %8.3f s to check, "
               "%llu faults\n",
               n, ray_ns, ray_ns / first_ns, (double)stats.rays / (double)stats.paths, made.build_s, made.compile_s,
               check_s, (unsigned long long)stats.nesting_faults);
        made_clear(&made);
    }
}

/* Every one of them overlaps every other one. */
static void bench_shells(void)
{
    printf("boxes, each inside of all before it, in a lathe's room\n");
    for (unsigned n = 250; n <= 1000; n *= 2) {
        char text[1000];
        Made made;
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } medium soda { ior = 1.33 state = liquid } "
            "lathe { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] } "
            "camera { from = <0, 90, -240> to = <0, 45, 0> } environment { } let n = %u "
            "for (i in 1..n) { box { interior = i %% 2 == 0 ? soda : glass size = vec3(50 * (n + 1 - i) / n) "
            "translate(50 * y) } }",
            n);
        made_from_text(&made, text);
        printf("  %7u %9zu pairs %8.3f s to compile\n", n, made.compiled->n_pairs, made.compile_s);
        made_clear(&made);
    }
}

/* Memory of the program so far at its largest, in bytes. */
static double most_memory(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return 1024.0 * (double)usage.ru_maxrss;
}

/* Objects spread evenly in a cube, a tenth of a unit in radius; each kind in a program of its own, as the system knows
 * only of the most memory that a program ever had. MENISCUS_BENCH_OBJECTS: how many, if not a million. */
static void bench_many(const char *name, const char *object)
{
    const char *wanted = getenv("MENISCUS_BENCH_OBJECTS");
    unsigned n = wanted ? (unsigned)strtoul(wanted, NULL, 10) : 1000000;
    fflush(stdout);
    pid_t child = fork();
    if (child < 0) exit(1);
    if (child > 0) {
        int status;
        if (waitpid(child, &status, 0) != child || status != 0) exit(1);
        return;
    }
    char text[1000];
    Made made;
    snprintf(text, sizeof text,
             "meniscus 1.0 unit cm medium gas { ior = 1 state = gas } environment { } "
             "camera { from = <50, 50, 300> to = <50, 50, 50> } let b = %s "
             "for (i in 1..%u) { b { translate(<100 * rnd(1, i), 100 * rnd(2, i), 100 * rnd(3, i)>) } }",
             object, n);
    double before = most_memory();
    made_from_text(&made, text);
    printf(
        "%u %s: %.0f bytes each at the most, %.0f of them Embree's; %.2f us to build, %.2f us to compile; %zu pairs\n",
        n, name, (most_memory() - before) / n, (double)rtc_scene_bytes(made.compiled->rtc) / n, made.build_s / n * 1e6,
        made.compile_s / n * 1e6, made.compiled->n_pairs);
    fflush(stdout);
    _exit(0);
}

int main(int argc, char **argv)
{
    if (argc > 2 && strcmp(argv[1], "limit") == 0) {
        bench_limit(argv + 2, argc - 2);
        return 0;
    }
    if (argc > 2 && strcmp(argv[1], "paths") == 0) {
        bench_paths(argv + 2, argc - 2);
        return 0;
    }
    bench_many("spheres", "sphere { interior = gas radius = .1 }");
    bench_many("instances of a mesh, apart from each other", "box { interior = gas size = <.01, .01, .01> }");
    bench_rays();
    bench_mesh_file();
    bench_crossing();
    bench_bubbles("spheres", "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3))");
    bench_bubbles("ellipsoids", "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3)) scale(<1, 1.2, 1>)");
    bench_shells();
    for (int i = 1; i < argc; i++) bench_scene(argv[i]);
    return 0;
}
