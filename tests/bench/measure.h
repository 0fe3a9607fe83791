/* measure.h - what the benchmarks share: figures with their spread, scenes from files and texts, renders of them.
 * Every failure ends the program with a message.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_MEASURE_H
#define MEN_TEST_MEASURE_H

#include "base/file.h"
#include "render/render.h"
#include "scene/build.h"

enum { RUNS = 7 };

ATTR_NORETURN void bench_fail(const char *what, const Error *error);

/* Median and quartiles of n values, which are sorted. */
typedef struct Quartiles {
    double median, low, high; /* quartiles; of fewer than 5 values the extremes */
} Quartiles;
Quartiles spread_of(double *values, int n);
/* The median of n values, and how far they spread. */
void print_figure(const char *what, double *values, int n, const char *unit);

/* A scene, compiled, with the time of the processor that it took. */
typedef struct Made {
    Arena arena;
    SourceSet sources;
    Diag diag;
    Scene *scene;
    CompiledScene *compiled;
    double build_s, compile_s;
} Made;
void made_from_text(Made *made, const char *text);
void made_with_pool(Made *made, const char *text, Pool *pool); /* compiled by several threads */
void made_from_file(Made *made, const char *path);
void made_with_params(Made *made, const char *path, const char *const *defines, size_t n); /* as with -D, n times */
/* The same, but false for a file of parts for other scenes, without a camera: then nothing is made. */
bool made_from_whole_file(Made *made, const char *path);
/* The two halves of these: the scene's description, from text or, where that is NULL, from the file; and the rest. */
void made_begin(Made *made, const char *path, const char *text, Pool *pool);
void made_compile(Made *made, const char *path, Pool *pool);
void made_clear(Made *made);

/* Renders with the scene's bounces, and without photons first: those cost the same however many samples follow, and a
 * small picture with few would show little else. *image is the caller's to clear. */
RenderStats render_image_at(const CompiledScene *compiled, uint32_t width, uint32_t height, uint32_t samples,
                            uint32_t seed, Pool *pool, Image *image);
/* The same, and throws the picture away. */
RenderStats render_at(const CompiledScene *compiled, uint32_t width, uint32_t height, uint32_t samples, Pool *pool);
Pool *pool_of(unsigned threads);
/* Prints the processor's time for the same paths beside another process over that alone: of processes that share the scene's
 * memory, and of such as do not. Before this process has built a scene or has threads. */
void processes_of(const char *path);

/* ---- the benchmarks; see the table in bench.c ---- */

void bench_limit(char **paths, int n);
void bench_paths(char **paths, int n);
void bench_noise(char **paths, int n);
void bench_fireflies(char **paths, int n);
void bench_denoise(char **paths, int n);
void bench_techniques(char **paths, int n);
void bench_sampling(char **paths, int n);
void bench_stated(char **paths, int n);
void bench_threads(char **paths, int n);
void bench_nesting(void);
void bench_rays(void);
void bench_caustics(void);
void bench_scale(void);
void bench_objects(void);

/* A soda with ever more, ever smaller bubbles, which fill the same part of it: arguments for snprintf are their number
 * and the statement that makes one, without its last bracket; `size` is theirs, i the bubble. */
#define SODA                                                                                                           \
    "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } medium soda { ior = 1.33 state = liquid } "         \
    "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] } "           \
    "cylinder drink { interior = soda from = <0, 9.9, 0> to = <0, 80, 0> radius = 37.1 } "                             \
    "ground { y = -.01 } environment { } camera { from = <0, 90, -240> to = <0, 45, 0> fov = 24 } "                    \
    "render { bounces = 64 } let n = %u let size = 16 / n ^ (1 / 3) "                                                  \
    "for (i in 1..n) { let r = 34 * sqrt(rnd(i, 2)) let a = 360 * rnd(i, 1) "                                          \
    "%s translate(<r * cos(a), 14 + 60 * rnd(i, 4), r * sin(a)>) } }"

#endif
