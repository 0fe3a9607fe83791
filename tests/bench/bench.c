/* bench.c - how fast the program is, as ratios of two things measured in one run.
 * usage: bench NAME [SCENE...]; `make bench` runs most of them
 * Each figure is the median of several runs, with their quartiles. Times are of the processor where nothing else is said.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "base/attr.h"
#include "measure.h"

typedef struct Benchmark {
    const char *name, *about;
    void (*of_scenes)(char **paths, int n);
    void (*alone)(void);
} Benchmark;

static const Benchmark benchmarks[] = {
    {"paths", "paths for each second", bench_paths, NULL},
    {"limit", "renders in ratio to their own rays, cast again through bare Embree", bench_limit, NULL},
    {"noise", "the error of pictures against time", bench_noise, NULL},
    {"fireflies", "single pixels that are far too bright, and the light in them", bench_fireflies, NULL},
    {"denoise", "the error of pictures before and after denoising", bench_denoise, NULL},
    {"techniques", "sharing out the work, stopping pixels, light in haze: errors with against without",
     bench_techniques, NULL},
    {"sampling", "patterns of samples, wavelengths and roulette: errors at equal time", bench_sampling, NULL},
    {"stated", "the noise that is stated over the error that is there", bench_stated, NULL},
    {"caustics", "small lights behind glass: errors with photons against without", NULL, bench_caustics},
    {"threads", "two threads over one, and the time from the file to the first picture", bench_threads, NULL},
    {"nesting", "what the interior list costs and saves", NULL, bench_nesting},
    {"rays", "exact rays over bare ones, and a crossing alone", NULL, bench_rays},
    {"scale", "many bubbles, many triangles", NULL, bench_scale},
    {"objects", "very many objects; takes minutes", NULL, bench_objects},
};

int main(int argc, char **argv)
{
    for (size_t i = 0; argc > 1 && i < COUNT_OF(benchmarks); i++) {
        const Benchmark *benchmark = &benchmarks[i];
        if (strcmp(argv[1], benchmark->name) != 0 || (argc > 2) != (benchmark->of_scenes != NULL)) continue;
        if (benchmark->of_scenes)
            benchmark->of_scenes(argv + 2, argc - 2);
        else
            benchmark->alone();
        return 0;
    }
    fprintf(stderr, "usage: bench NAME [SCENE...]\n");
    for (size_t i = 0; i < COUNT_OF(benchmarks); i++)
        fprintf(stderr, "  %-10s %-9s %s\n", benchmarks[i].name, benchmarks[i].of_scenes ? "SCENE..." : "",
                benchmarks[i].about);
    return 2;
}
