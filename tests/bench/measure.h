/* measure.h - what the benchmarks share: figures with their spread, scenes from files and texts, renders of them.
 * Every failure ends the program with a message.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_TEST_MEASURE_H
#define MEN_TEST_MEASURE_H

#include "render/render.h"
#include "scene/build.h"

enum { RUNS = 7 };

ATTR_NORETURN void bench_fail(const char *what, const Error *error);

/* Median and quartiles of n values, which are sorted. */
typedef struct Spread {
    double median, low, high; /* quartiles; of fewer than 5 values the extremes */
} Spread;
Spread spread_of(double *values, int n);
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
void made_from_file(Made *made, const char *path);
void made_clear(Made *made);

/* Renders with a pool of that many threads and throws the picture away. */
RenderStats render_at(const CompiledScene *compiled, uint32_t width, uint32_t height, uint32_t samples, Pool *pool);
Pool *pool_of(unsigned threads);

/* ---- the benchmarks ---- */

/* A render's time in ratio to that of its own rays, replayed through bare Embree calls. */
void bench_limit(char **paths, int n);
/* Paths per second of the processor. */
void bench_paths(char **paths, int n);

#endif
