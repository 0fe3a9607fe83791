/* noise.c - the error of a picture against the time that it took.
 * Less noise in a sample counts as speed. Renders with different seeds are independent, so that half of their mean squared
 * difference is their variance: no reference is needed. The error is relative, squared, a mean over all pixels and
 * channels, as in `meniscus compare`; times the processor's time for each pixel it is what an integrator is
 * worth, whatever the number of samples: half of it is twice as fast.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "measure.h"

enum { WIDTH = 64, HEIGHT = 48, SEEDS = 4, CHANNELS = 3, FEW = 8, MANY = 32 };

typedef struct Noise {
    double relative, most_relative; /* of all pixels; without the worst hundredth, which a few bright paths make */
    double pixel_us;
} Noise;

static int compare_double(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static Noise noise_of(const CompiledScene *compiled, uint32_t samples, Pool *pool)
{
    enum { PIXELS = WIDTH * HEIGHT };
    static double values[SEEDS][PIXELS * CHANNELS], relative[PIXELS];
    Noise noise = {0};
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Image image;
        RenderStats stats = render_image_at(compiled, WIDTH, HEIGHT, samples, seed, pool, &image);
        noise.pixel_us += stats.cpu_seconds / (PIXELS * SEEDS) * 1e6;
        for (int i = 0; i < PIXELS * CHANNELS; i++)
            values[seed][i] =
                (double)image.pixels[(uint32_t)(i / CHANNELS) * image.n_channels + (uint32_t)(i % CHANNELS)];
        image_clear(&image);
    }
    for (int p = 0; p < PIXELS; p++) {
        relative[p] = 0;
        for (int i = p * CHANNELS; i < (p + 1) * CHANNELS; i++) {
            double mean = 0, squares = 0;
            for (int s = 0; s < SEEDS; s++) mean += values[s][i] / SEEDS;
            for (int s = 0; s < SEEDS; s++) squares += (values[s][i] - mean) * (values[s][i] - mean) / (SEEDS - 1);
            relative[p] += squares / (mean * mean + 0.01) / CHANNELS;
        }
        noise.relative += relative[p] / PIXELS;
    }
    qsort(relative, PIXELS, sizeof *relative, compare_double);
    for (int p = 0; p < PIXELS * 99 / 100; p++) noise.most_relative += relative[p] / (PIXELS * 99 / 100);
    return noise;
}

void bench_noise(char **paths, int n)
{
    Pool *one = pool_of(1);
    printf("relative mean squared error times microseconds a pixel: all pixels, and without the worst hundredth;\n"
           "how the error falls from %d to %d samples: 1 is as by chance, more is better\n",
           FEW, MANY);
    printf("%-24s %10s %12s %12s %8s\n", "scene", "us a path", "all", "most", "falls by");
    for (int i = 0; i < n; i++) {
        Made made;
        made_from_file(&made, paths[i]);
        Noise few = noise_of(made.compiled, FEW, one), many = noise_of(made.compiled, MANY, one);
        printf("%-24s %10.2f %12.3f %12.3f %8.2f\n", file_name(paths[i]), many.pixel_us / MANY,
               many.relative * many.pixel_us, many.most_relative * many.pixel_us,
               log(few.most_relative / many.most_relative) / log((double)MANY / FEW));
        fflush(stdout);
        made_clear(&made);
    }
    pool_free(one);
}
