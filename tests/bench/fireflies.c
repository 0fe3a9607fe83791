/* fireflies.c - pixels that are far brighter than what is around them, by chance.
 * A highlight is bright in every render, a firefly in one: so each scene is rendered twice, with the samples that it asks
 * for. A pixel counts when it is brighter, by a factor, than all three: the median of the pixels around it, the other
 * render there, and a little of the picture's mean. In front of the scenes may stand `keep`, so that every sample stays where
 * it was found, and a width in pixels.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/luminance.h"
#include "measure.h"

enum { WIDTH = 160, WIDEST = 4096, RADIUS = 2, AROUND = (2 * RADIUS + 1) * (2 * RADIUS + 1) };
#define LITTLE 0.02
/* What is seen at once, and what would be taken for a light. */
static const double factors[] = {2, 5};

typedef struct Size {
    uint32_t width, height;
} Size;

typedef struct Count {
    uint32_t n[COUNT_OF(factors)];
    double excess; /* over the reference, of those that the first factor counts */
    double worst;  /* ratio */
} Count;

static double median_around(const double *luminance, Size size, uint32_t x, uint32_t y)
{
    double values[AROUND];
    int n = 0;
    for (int v = -RADIUS; v <= RADIUS; v++)
        for (int u = -RADIUS; u <= RADIUS; u++) {
            uint32_t at_x = x + (uint32_t)u, at_y = y + (uint32_t)v; /* beyond the left or top edge: very large */
            if (at_x < size.width && at_y < size.height) values[n++] = luminance[at_y * size.width + at_x];
        }
    return spread_of(values, n).median;
}

static void count(const double *luminance, const double *other, Size size, double mean, Count *sum)
{
    for (uint32_t y = 0; y < size.height; y++)
        for (uint32_t x = 0; x < size.width; x++) {
            double is = luminance[y * size.width + x];
            double reference = fmax(other[y * size.width + x], LITTLE * mean);
            if (is <= factors[0] * reference) continue; /* most */
            reference = fmax(reference, median_around(luminance, size, x, y));
            for (size_t i = 0; i < COUNT_OF(factors); i++) sum->n[i] += is > factors[i] * reference;
            if (is > factors[0] * reference) sum->excess += is - reference;
            sum->worst = fmax(sum->worst, is / reference);
        }
}

/* Renders with what the scene asks for, but for its size. */
static RenderStats render_seed(const Made *made, Size size, uint32_t seed, bool keep, Pool *pool, double *luminance)
{
    const SceneRender *wish = &made->scene->render;
    RenderSettings settings = {.width = size.width,
                               .height = size.height,
                               .samples = wish->samples,
                               .noise = wish->noise,
                               .seed = seed,
                               .bounces = wish->bounces,
                               .caustics = wish->caustics,
                               .spreads = wish->spreads && !keep};
    RenderStats stats;
    Image image;
    Error error = {0};
    if (render_image(made->compiled, &settings, pool, NULL, &image, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    for (uint32_t p = 0; p < size.width * size.height; p++)
        luminance[p] = (double)color_luminance(image.pixels + p * image.n_channels);
    image_clear(&image);
    return stats;
}

static void measure(const char *path, uint32_t width, bool keep, Pool *pool)
{
    Made made;
    if (!made_from_whole_file(&made, path)) {
        printf("%-26s parts of other scenes, without a camera\n", file_name(path));
        return;
    }
    double tall = (double)made.scene->film.height / made.scene->film.width;
    Size size = {width, (uint32_t)fmax(width * tall, 1)};
    uint32_t n = size.width * size.height;
    double *pictures[2], mean = 0, cpu_s = 0, before_s = 0, spread = 0;
    Count sum = {{0}, 0, 0};
    for (uint32_t i = 0; i < 2; i++) {
        pictures[i] = malloc(n * sizeof *pictures[i]);
        if (!pictures[i]) bench_fail("out of memory", NULL);
        RenderStats stats = render_seed(&made, size, i + 1, keep, pool, pictures[i]);
        cpu_s += stats.cpu_seconds / 2;
        before_s += stats.guide.cpu_seconds / 2;
        spread += stats.spread_light / 2;
        for (uint32_t p = 0; p < n; p++) mean += pictures[i][p] / n / 2;
    }
    for (int i = 0; i < 2; i++) count(pictures[i], pictures[!i], size, mean, &sum);
    double all = 2.0 * n;
    printf("%-26s %8.2f %8.2f %10.3f %8.1f %9.2f %8.1f %7.1f\n", file_name(path), 1e4 * sum.n[0] / all,
           1e4 * sum.n[1] / all, 100 * sum.excess / (mean * all), sum.worst, 100 * spread, cpu_s,
           100 * before_s / cpu_s);
    fflush(stdout);
    for (int i = 0; i < 2; i++) free(pictures[i]);
    made_clear(&made);
}

void bench_fireflies(char **paths, int n)
{
    Pool *pool = pool_of(0);
    bool keep = strcmp(paths[0], "keep") == 0;
    int first = keep;
    char *end = paths[0];
    unsigned long width = first < n ? strtoul(paths[first], &end, 10) : 0;
    if (width > 0 && width <= WIDEST && !*end)
        first++;
    else
        width = WIDTH;
    printf(
        "fireflies, of renders %lu pixels wide with each scene's own samples: pixels in ten thousand that are %g and "
        "%g "
        "times\nas bright as those around and as in another render; their excess over these, of all light; the worst "
        "of them;\nthe light of samples that stood alone and were spread, of all; seconds of the processor, and how "
        "much of "
        "that photons take\n"
        "%-26s %8s %8s %10s %8s %9s %8s %7s\n",
        width, factors[0], factors[1], "", "twice", "5 times", "excess %", "worst", "spread %", "cpu s", "first %");
    for (int i = first; i < n; i++) measure(paths[i], (uint32_t)width, keep, pool);
    pool_free(pool);
}
