/* nesting.c - what nesting costs: next to nothing where there is none, less than a gap where there is some.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>

#include "measure.h"

/* A line of sight through 24 thin sheets: of the block's own medium (silent), or of one that is a little denser; so little
 * that nothing is reflected. */
#define SHEETS                                                                                                         \
    "meniscus 1.0 unit mm medium glass { ior = 1.5 } medium dense { ior = 1.5001 } "                                   \
    "box { interior = glass size = <100, 100, 200> } for (i in 1..<%d + 1) { "                                         \
    "box { interior = %s from = <-40, -40, 7 * i - 95> to = <40, 40, 7 * i - 93> } } "                                 \
    "environment { } camera { from = <0, 0, 400> to = <0, 0, 0> fov = 8 } render { bounces = 100 }"

/* The ratio of the times that a path takes, in turns. */
static void compare_paths(const Made *a, const Made *b, uint32_t samples, double ratio[RUNS])
{
    Pool *one = pool_of(1);
    for (int run = 0; run < RUNS; run++) {
        double seconds[2] = {0};
        for (int turn = 0; turn < 4; turn++) { /* a b b a: what drifts meanwhile falls on both */
            int k = turn == 1 || turn == 2;
            seconds[k] += render_at((k ? b : a)->compiled, 96, 72, samples, one).cpu_seconds;
        }
        ratio[run] = seconds[0] / seconds[1];
    }
    pool_free(one);
}

static void bench_opaque(void)
{
    static const char scene[] = "tests/bench/room.mns";
    for (int n = 1; n <= 8; n *= 8) {
        Made with, without;
        char what[100], hulls[20];
        double ratio[RUNS];
        snprintf(hulls, sizeof hulls, "hulls=%d", n);
        made_with_params(&with, scene, (const char *[]){hulls, "opaque=false"}, 2);
        made_with_params(&without, scene, (const char *[]){hulls, "opaque=true"}, 2);
        compare_paths(&with, &without, 24, ratio);
        snprintf(what, sizeof what, "  opaque objects, a list of %d over an empty one", n);
        print_figure(what, ratio, RUNS, "x");
        made_clear(&with);
        made_clear(&without);
    }
}

/* Overlapping hulls against a gap of air between them. */
static void bench_gap(const char *what, const char *overlapping, const char *gap)
{
    Made a, b;
    double ratio[RUNS];
    made_from_file(&a, overlapping);
    made_from_file(&b, gap);
    compare_paths(&a, &b, 16, ratio);
    print_figure(what, ratio, RUNS, "x");
    made_clear(&a);
    made_clear(&b);
}

static double path_seconds(const Made *made, Pool *pool)
{
    RenderStats stats = render_at(made->compiled, 96, 72, 8, pool);
    return stats.cpu_seconds / (double)stats.paths;
}

static void bench_silent(void)
{
    enum { SHEET_COUNT = 12 };
    static const char *const media[] = {"glass", "dense"};
    Made none, sheets[2];
    char text[2000];
    snprintf(text, sizeof text, SHEETS, 0, "glass");
    made_from_text(&none, text);
    for (int k = 0; k < 2; k++) {
        snprintf(text, sizeof text, SHEETS, SHEET_COUNT, media[k]);
        made_from_text(&sheets[k], text);
    }
    Pool *one = pool_of(1);
    double ns[2][RUNS], ratio[RUNS];
    for (int run = 0; run < RUNS; run++) {
        double empty = path_seconds(&none, one);
        for (int k = 0; k < 2; k++) ns[k][run] = (path_seconds(&sheets[k], one) - empty) / (2 * SHEET_COUNT) * 1e9;
        ratio[run] = ns[0][run] / ns[1][run];
    }
    print_figure("  a silent crossing", ns[0], RUNS, "ns");
    print_figure("  a real one", ns[1], RUNS, "ns");
    print_figure("  a silent crossing over a real one", ratio, RUNS, "x");
    pool_free(one);
    made_clear(&none);
    made_clear(&sheets[0]);
    made_clear(&sheets[1]);
}

void bench_nesting(void)
{
    printf("nesting (goals: 1.005; 0.95; 0.33)\n");
    bench_opaque();
    bench_gap("  whisky: hulls that overlap over hulls with a gap", "examples/whisky.mns", "examples/whisky-gap.mns");
    bench_gap("  aquarium: the same", "examples/aquarium.mns", "examples/aquarium-gap.mns");
    bench_silent();
}
