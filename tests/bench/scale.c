/* scale.c - how time and memory grow with threads, bubbles and triangles, and how soon there is a picture.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "bare.h"
#include "base/clock.h"
#include "measure.h"

/* ---- threads, and the first picture ---- */

/* When the first picture was shown; nothing is rendered after it. */
typedef struct FirstPicture {
    double wall_s, cpu_s; /* since the start */
    sig_atomic_t stop;
} FirstPicture;

static void note_first_picture(void *context, const Image *image)
{
    FirstPicture *first = context;
    (void)image;
    if (first->stop) return;
    first->wall_s += clock_now_s();
    first->cpu_s += clock_cpu_s();
    first->stop = 1;
}

/* Of 640 x 480, from the compiled scene, with photons where the scene has use for them. Lights and the camera's surroundings
 * are a part of it. */
static FirstPicture first_picture(const CompiledScene *compiled, Pool *pool)
{
    FirstPicture first = {-clock_now_s(), -clock_cpu_s(), 0};
    RenderSettings settings = {.width = 640, .height = 480, .samples = 1, .bounces = compiled->scene->render.bounces};
    RenderEvents events = {.context = &first, .stop = &first.stop, .picture = note_first_picture};
    Error error = {0};
    Image image;
    RenderStats stats;
    if (render_image(compiled, &settings, pool, &events, &image, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    image_clear(&image);
    return first;
}

/* Of the clock on the wall: on a machine that does other work, too, this says little. */
void bench_threads(char **paths, int n)
{
    Pool *one = pool_of(1), *two = pool_of(2);
    printf("two threads over one, by the clock on the wall (goal: 1.95) and by the processors' time for a path;\n"
           "seconds from the compiled scene to the first picture of 640 x 480 that is shown by two threads (goal: "
           "0.3), and\n"
           "half of the processors' time for it, which other work does not change; the same for one sample in every "
           "pixel\n");
    printf("%-24s %-22s %-22s %-22s %-8s %s\n", "scene", "wall", "time for a path", "first picture, s", "half",
           "sample");
    for (int i = 0; i < n; i++) {
        Made made;
        double wall[RUNS], path[RUNS], first[RUNS], half[RUNS], whole[RUNS];
        made_from_file(&made, paths[i]);
        for (int run = 0; run < RUNS; run++) {
            RenderStats a = render_at(made.compiled, 96, 72, 16, one), b = render_at(made.compiled, 96, 72, 16, two);
            wall[run] = a.seconds / b.seconds;
            path[run] = b.cpu_seconds / a.cpu_seconds;
            double cpu = clock_cpu_s();
            render_at(made.compiled, 640, 480, 1, two);
            whole[run] = (clock_cpu_s() - cpu) / 2;
            FirstPicture picture = first_picture(made.compiled, two);
            first[run] = picture.wall_s;
            half[run] = picture.cpu_s / 2;
        }
        Spread w = spread_of(wall, RUNS), p = spread_of(path, RUNS), f = spread_of(first, RUNS);
        printf("%-24s %5.2f (%.2f .. %.2f)    %5.2f (%.2f .. %.2f)    %5.2f (%.2f .. %.2f)    %5.2f    %5.2f\n",
               file_name(paths[i]), w.median, w.low, w.high, p.median, p.low, p.high, f.median, f.low, f.high,
               spread_of(half, RUNS).median, spread_of(whole, RUNS).median);
        fflush(stdout);
        made_clear(&made);
    }
    pool_free(one);
    pool_free(two);
}

/* ---- bubbles ---- */

static void bench_bubbles(void)
{
    static const unsigned counts[2] = {10, 10000};
    Made made[2];
    Pool *one = pool_of(1);
    double ratio[RUNS], ns[2] = {0};
    for (int k = 0; k < 2; k++) {
        char text[2000];
        snprintf(text, sizeof text, SODA, counts[k], "sphere { interior = air radius = size * (.3 + .5 * rnd(i, 3))");
        made_from_text(&made[k], text);
    }
    for (int run = 0; run < RUNS; run++) {
        for (int k = 0; k < 2; k++) {
            RenderStats stats = render_at(made[k].compiled, 96, 72, 8, one);
            ns[k] = stats.cpu_seconds / (double)stats.rays;
        }
        ratio[run] = ns[1] / ns[0];
    }
    print_figure("a ray among 10,000 bubbles over one among 10 (goal: 1.6)", ratio, RUNS, "x");
    pool_free(one);
    made_clear(&made[0]);
    made_clear(&made[1]);
}

/* ---- a mesh of a million triangles ---- */

static void write_ply(const char *path, const Mesh *mesh)
{
    FILE *file = fopen(path, "wb");
    if (!file) bench_fail(path, NULL);
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty float x\nproperty float y\n"
            "property float z\nelement face %u\nproperty list uchar int vertex_indices\nend_header\n",
            mesh->n_vertices, mesh->n_triangles);
    fwrite(mesh->positions, sizeof *mesh->positions, mesh->n_vertices, file);
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        fputc(3, file);
        fwrite(mesh->triangles[i], sizeof *mesh->triangles, 1, file);
    }
    if (fclose(file) != 0) bench_fail(path, NULL);
}

static double held_memory(void)
{
    long pages = 0, held = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &pages, &held) != 2) bench_fail("/proc/self/statm", NULL);
    fclose(file);
    return (double)held * (double)sysconf(_SC_PAGESIZE);
}

static void mesh_text(char *text, size_t size, const char *path)
{
    snprintf(text, size,
             "meniscus 1.0 unit cm medium glass { ior = 1.5 } mesh { file = \"%s\" interior = glass } environment { } "
             "camera { from = <0, 0, 5> to = <0, 0, 0> }",
             path);
}

/* From the text of a scene to one pixel of its picture. */
static void first_pixel(const char *text, Made *made, Pool *pool)
{
    made_with_pool(made, text, pool);
    render_at(made->compiled, 1, 1, 1, pool);
}

static void bench_mesh_time(const char *text, const Mesh *mesh, RTCDevice device, Pool *pool)
{
    double ratio[RUNS], bare_ms[RUNS];
    for (int run = 0; run < RUNS; run++) {
        double start = clock_cpu_s();
        rtcReleaseScene(bare_mesh(device, mesh));
        double bare = clock_cpu_s() - start;
        Made made;
        start = clock_cpu_s();
        first_pixel(text, &made, pool);
        ratio[run] = (clock_cpu_s() - start) / bare;
        bare_ms[run] = bare * 1e3;
        made_clear(&made);
    }
    print_figure("  Embree's own building of it", bare_ms, RUNS, "ms");
    print_figure("  from the file to the first pixel, over that (goal: 2)", ratio, RUNS, "x");
}

/* In a program of its own, so that nothing is held from before: bytes a triangle of what is held at the end. */
static double held_by(void (*make)(const void *context), const void *context, uint32_t n_triangles)
{
    int channel[2];
    double bytes = 0;
    fflush(stdout);
    if (pipe(channel) != 0) bench_fail("a pipe", NULL);
    pid_t child = fork();
    if (child < 0) bench_fail("a process", NULL);
    if (child == 0) {
        double before = held_memory();
        make(context);
        double held = held_memory() - before;
        _exit(write(channel[1], &held, sizeof held) != (ssize_t)sizeof held);
    }
    int status;
    if (read(channel[0], &bytes, sizeof bytes) != (ssize_t)sizeof bytes || waitpid(child, &status, 0) != child ||
        status != 0)
        bench_fail("a process", NULL);
    close(channel[0]);
    close(channel[1]);
    return bytes / n_triangles;
}

static void hold_scene(const void *context)
{
    Made made;
    first_pixel(context, &made, pool_of(2));
}

/* The mesh's arrays, and what Embree makes of them. */
static void hold_bare(const void *context)
{
    Error error;
    Mesh *mesh;
    if (mesh_copy(context, &mesh, &error) != STATUS_OK) bench_fail("a mesh", &error);
    bare_mesh(rtcNewDevice("threads=2"), mesh);
}

static void bench_mesh(void)
{
    char folder[] = "/tmp/meniscus-bench-XXXXXX", path[100], text[1000];
    Error error = {0};
    Mesh *mesh;
    if (!mkdtemp(folder)) bench_fail(folder, NULL);
    snprintf(path, sizeof path, "%s/mesh.ply", folder);
    if (mesh_make_sphere(1, 8, &mesh, &error) != STATUS_OK) bench_fail("a mesh", &error);
    write_ply(path, mesh);
    mesh_text(text, sizeof text, path);
    printf("a binary PLY file of %u triangles, two threads\n", mesh->n_triangles);
    /* before there are threads: a program that has some must not be forked and go on */
    double ours = held_by(hold_scene, text, mesh->n_triangles), bare = held_by(hold_bare, mesh, mesh->n_triangles);
    RTCDevice device = rtcNewDevice("threads=2");
    Pool *pool = pool_of(2);
    bench_mesh_time(text, mesh, device, pool);
    printf("%-58s %8.1f bytes; %.1f of Embree with the mesh alone: %.2f x (goal: 1.1)\n",
           "  memory for each triangle, all in all", ours, bare, ours / bare);
    pool_free(pool);
    rtcReleaseDevice(device);
    mesh_free(mesh);
    remove(path);
    rmdir(folder);
}

void bench_scale(void)
{
    bench_mesh();
    bench_bubbles();
}
