/* scale.c - how time and memory grow with bubbles and triangles.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include "../unit/icosphere.h"
#include "bare.h"
#include "base/clock.h"
#include "measure.h"

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
    const Mesh *whole = context;
    Error error;
    Mesh *mesh;
    if (mesh_new(whole->n_vertices, whole->n_triangles, true, false, &mesh, &error) != STATUS_OK)
        bench_fail("a mesh", &error);
    memcpy(mesh->positions, whole->positions, whole->n_vertices * sizeof *whole->positions);
    memcpy(mesh->normals, whole->normals, whole->n_vertices * sizeof *whole->normals);
    memcpy(mesh->triangles, whole->triangles, whole->n_triangles * sizeof *whole->triangles);
    bare_mesh(rtcNewDevice("threads=2"), mesh);
}

static void bench_mesh(void)
{
    char folder[] = "/tmp/meniscus-bench-XXXXXX", path[100], text[1000];
    Mesh *mesh = icosphere(1, 8);
    if (!mkdtemp(folder)) bench_fail(folder, NULL);
    snprintf(path, sizeof path, "%s/mesh.ply", folder);
    if (!mesh) bench_fail("a mesh", NULL);
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
