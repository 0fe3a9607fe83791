/* denoise.c - what denoising does to the error of pictures, and what it takes.
 * The error of a picture is the mean product of its differences from two others of other seeds: their noise is independent, and
 * leaves no trace in that. A pixel counts by its relative error, between -1 and 1: single bright samples are another matter,
 * see fireflies.c.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/clock.h"
#include "measure.h"

enum { WIDTH = 240, REFERENCE_SAMPLES = 96 };
static const uint32_t sample_counts[] = {16, 64};

/* What dark pixels are held up by, against the picture's mean. */
#define LITTLE 0.1

typedef struct References {
    Image a, b;
    double mean;
} References;

static double color_of(const Image *image, size_t i, size_t k)
{
    return (double)image->pixels[i * image->n_channels + k];
}

static double error_of(const Image *image, const References *references)
{
    const Image *a = &references->a, *b = &references->b;
    size_t n = (size_t)image->width * image->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        double luminance = 0, product = 0;
        for (size_t k = 0; k < 3; k++) {
            luminance += (color_of(a, i, k) + color_of(b, i, k)) / 6;
            product += (color_of(image, i, k) - color_of(a, i, k)) * (color_of(image, i, k) - color_of(b, i, k)) / 3;
        }
        double of = product / (luminance * luminance + LITTLE * LITTLE * references->mean * references->mean);
        sum += fmax(fmin(of, 1), -1);
    }
    return sum / (double)n;
}

static double mean_of(const Image *image)
{
    size_t n = (size_t)image->width * image->height;
    double sum = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < 3; k++) sum += color_of(image, i, k) / (3.0 * (double)n);
    return sum;
}

/* What a render takes that notes nothing of what its pixels meet. */
static double seconds_without(const Made *made, RenderSettings settings, Pool *pool)
{
    RenderStats stats;
    Image image;
    Error error = {0};
    settings.denoises = false;
    if (render_image(made->compiled, &settings, pool, NULL, &image, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    image_clear(&image);
    return stats.cpu_seconds;
}

/* One render, denoised, and as it was sampled. */
static void measure(const Made *made, RenderSettings settings, const References *references, Pool *pool)
{
    const double without_s = seconds_without(made, settings, pool);
    RenderState state = {0};
    RenderStats stats;
    Image smooth, plain;
    Error error = {0};
    if (render_go_on(made->compiled, &settings, pool, NULL, &state, &smooth, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    image_clear(&smooth);
    double resolve_s[2], samples_s = stats.cpu_seconds;
    for (int smooths = 0; smooths < 2; smooths++) {
        double start = clock_cpu_s();
        state.aovs.guides = smooths;
        if (render_state_resolve(&state, (Exposure){0}, pool, smooths ? &smooth : &plain, &stats, &error) != STATUS_OK)
            bench_fail("denoise", &error);
        resolve_s[smooths] = clock_cpu_s() - start;
    }
    double before = error_of(&plain, references), after = error_of(&smooth, references);
    double denoise_s = resolve_s[1] - resolve_s[0];
    printf("  %4u  %8.5f %8.5f %7.2f  %8.4f  %7.2f %7.1f %7.1f", settings.samples, before, after, before / after,
           mean_of(&smooth) / mean_of(&plain), denoise_s / (smooth.width * smooth.height) * 1e6,
           100 * denoise_s / (samples_s - denoise_s), 100 * ((samples_s - denoise_s) / without_s - 1));
    image_clear(&smooth);
    image_clear(&plain);
    render_state_clear(&state);
}

static void measure_scene(const char *path, Pool *pool)
{
    Made made;
    made_from_file(&made, path);
    const SceneRender *wish = &made.scene->render;
    double tall = (double)made.scene->film.height / made.scene->film.width;
    RenderSettings settings = {.width = WIDTH,
                               .height = (uint32_t)fmax(WIDTH * tall, 1),
                               .samples = REFERENCE_SAMPLES,
                               .bounces = wish->bounces,
                               .caustics = wish->caustics,
                               .spreads = true};
    References references;
    for (int i = 0; i < 2; i++) {
        RenderStats stats;
        Error error = {0};
        settings.seed = 2 + (uint32_t)i;
        if (render_image(made.compiled, &settings, pool, NULL, i ? &references.b : &references.a, &stats, &error) !=
            STATUS_OK)
            bench_fail("render", &error);
    }
    references.mean = (mean_of(&references.a) + mean_of(&references.b)) / 2;
    settings.seed = 1;
    settings.denoises = true;
    for (size_t i = 0; i < COUNT_OF(sample_counts); i++) {
        settings.samples = sample_counts[i];
        printf("%-22s", i ? "" : file_name(path));
        measure(&made, settings, &references, pool);
        printf("\n");
        fflush(stdout);
    }
    image_clear(&references.a);
    image_clear(&references.b);
    made_clear(&made);
}

void bench_denoise(char **paths, int n)
{
    Pool *pool = pool_of(0);
    printf("denoising, of renders %d pixels wide: samples; squared relative error before and after, and their ratio; "
           "brightness after\nover before; microseconds of the processor for each pixel, and in ratio to the samples'; "
           "and by how "
           "much those take\nlonger where what is met first is noted for it\n"
           "%-22s  %4s  %8s %8s %7s  %8s  %7s %7s %7s\n",
           WIDTH, "", "spp", "before", "after", "ratio", "bright", "us", "%", "notes %");
    for (int i = 0; i < n; i++) measure_scene(paths[i], pool);
    pool_free(pool);
}
