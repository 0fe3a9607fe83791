/* techniques.c - what sharing out the work among pixels, and stopping each by itself, are worth: with against without, in
 * one run. Renders of several seeds tell each pixel's error, without a reference.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/luminance.h"
#include "measure.h"

enum { WIDTH = 96, HEIGHT = 72, PIXELS = WIDTH * HEIGHT, SEEDS = 4, BORDER = 6 };

/* Luminances of renders that differ in their seed alone. */
typedef struct Renders {
    float luminance[SEEDS][PIXELS];
    double mean_samples, cpu_s; /* of one */
} Renders;

static void render_all(const CompiledScene *compiled, RenderSettings settings, Pool *pool, Renders *renders)
{
    renders->mean_samples = renders->cpu_s = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Error error = {0};
        Image image;
        RenderStats stats;
        settings.seed = seed;
        if (render_image(compiled, &settings, pool, NULL, &image, &stats, &error) != STATUS_OK)
            bench_fail("render", &error);
        for (uint32_t p = 0; p < PIXELS; p++)
            renders->luminance[seed][p] = color_luminance(image.pixels + p * image.n_channels);
        renders->mean_samples += stats.mean_samples / SEEDS;
        renders->cpu_s += stats.cpu_seconds / SEEDS;
        image_clear(&image);
    }
}

static float mean_at(const Renders *renders, uint32_t p)
{
    float sum = 0;
    for (int s = 0; s < SEEDS; s++) sum += renders->luminance[s][p];
    return sum / SEEDS;
}

/* Mean square of the errors, relative to the root of luminance^2 + 0.1^2, after a Gaussian of a standard deviation of 1.5
 * pixels: what is seen from a distance, or left by a filter. */
static double blurred_error(const Renders *renders)
{
    static float error[PIXELS];
    double kernel[2 * BORDER + 1], all = 0, sum = 0;
    for (int i = -BORDER; i <= BORDER; i++) all += kernel[i + BORDER] = exp(-i * i / 4.5);
    for (int s = 0; s < SEEDS; s++) {
        for (uint32_t p = 0; p < PIXELS; p++) {
            float mean = mean_at(renders, p);
            error[p] = (renders->luminance[s][p] - mean) / hypotf(mean, 0.1f);
        }
        for (int y = BORDER; y < HEIGHT - BORDER; y++)
            for (int x = BORDER; x < WIDTH - BORDER; x++) {
                double blurred = 0;
                for (int v = -BORDER; v <= BORDER; v++)
                    for (int u = -BORDER; u <= BORDER; u++)
                        blurred += kernel[u + BORDER] * kernel[v + BORDER] * (double)error[(y + v) * WIDTH + x + u];
                sum += blurred * blurred / pow(all, 4);
            }
    }
    return sum;
}

static int compare_float(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Relative errors, root mean squares: of all pixels, and what one square of 4 x 4 pixels in twenty is above. */
static void pixel_errors(const Renders *renders, double *rms, double *twentieth)
{
    enum { SIDE = 4, SQUARES = PIXELS / SIDE / SIDE };
    static float error[SQUARES];
    memset(error, 0, sizeof error);
    *rms = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        float mean = mean_at(renders, p), squares = 0;
        for (int s = 0; s < SEEDS; s++) squares += powf(renders->luminance[s][p] - mean, 2) / (SEEDS - 1);
        squares /= mean * mean + 0.01f;
        error[p / WIDTH / SIDE * (WIDTH / SIDE) + p % WIDTH / SIDE] += squares / (SIDE * SIDE);
        *rms += (double)squares / PIXELS;
    }
    qsort(error, SQUARES, sizeof *error, compare_float);
    *rms = sqrt(*rms);
    *twentieth = sqrt((double)error[SQUARES - SQUARES / 20]);
}

/* The two are rendered with as many samples; neither costs more than the other. */
static void compare_shared(const CompiledScene *compiled, RenderSettings settings, Pool *pool)
{
    static Renders with, without;
    for (settings.samples = 1; settings.samples <= 16; settings.samples *= 4) {
        settings.trial.pattern = PATTERN_SHARED;
        render_all(compiled, settings, pool, &with);
        settings.trial.pattern = PATTERN_ALONE;
        render_all(compiled, settings, pool, &without);
        printf(" %8.2f", blurred_error(&with) / blurred_error(&without));
    }
}

/* Errors, of all and of the worst places, in relation by the root of the times: as they would be after equal time. */
static void print_after_equal_time(const Renders *with, const Renders *without)
{
    double with_rms, with_twentieth, rms, twentieth;
    pixel_errors(with, &with_rms, &with_twentieth);
    pixel_errors(without, &rms, &twentieth);
    double time = sqrt(with->cpu_s / without->cpu_s);
    printf(" %8.2f %8.2f", time * with_rms / rms, time * with_twentieth / twentieth);
}

/* The plain one has as many samples as the one whose pixels stop by themselves, or nearly. */
static void compare_stopping(const CompiledScene *compiled, RenderSettings settings, Pool *pool)
{
    static Renders with, without;
    settings.noise = 0.12;
    settings.samples = 1024;
    render_all(compiled, settings, pool, &with);
    settings.noise = 0;
    settings.samples = (uint32_t)lround(with.mean_samples);
    render_all(compiled, settings, pool, &without);
    printf(" %9.1f", with.mean_samples);
    print_after_equal_time(&with, &without);
}

static void compare_sharing(const CompiledScene *compiled, RenderSettings settings, Pool *pool)
{
    static Renders with, without;
    settings.samples = 64;
    render_all(compiled, settings, pool, &without);
    settings.adaptive = true;
    render_all(compiled, settings, pool, &with);
    print_after_equal_time(&with, &without);
}

static void compare_airlight(const CompiledScene *compiled, RenderSettings settings, Pool *pool)
{
    static Renders with, without;
    bool scatters = false;
    for (uint32_t i = 0; i < compiled->scene->n_media; i++) scatters = scatters || compiled->scene->media[i].scatters;
    if (!scatters) return;
    settings.samples = 32;
    render_all(compiled, settings, pool, &with);
    settings.no_airlight = true;
    render_all(compiled, settings, pool, &without);
    print_after_equal_time(&with, &without);
}

void bench_techniques(char **paths, int n)
{
    Pool *one = pool_of(1);
    printf("errors with against without, below 1 is better. Neighbours share out the work: low frequencies of the "
           "squared error\n"
           "at 1, 4 and 16 samples. Pixels stop by themselves at 12 %%: samples, then after equal time the error of "
           "all pixels,\n"
           "and what one square of 4 x 4 pixels in twenty is above. 64 samples a pixel are shared out by need: the "
           "same errors\n"
           "after equal time. Light is looked for within haze, not only where paths are scattered in it: the same.\n");
    printf("%-24s %8s %8s %8s %9s %8s %8s %8s %8s %8s %8s\n", "scene", "1", "4", "16", "samples", "all", "worst",
           "shared", "worst", "haze", "worst");
    for (int i = 0; i < n; i++) {
        Made made;
        made_from_file(&made, paths[i]);
        RenderSettings settings = {.width = WIDTH, .height = HEIGHT, .bounces = made.scene->render.bounces};
        printf("%-24s", file_name(paths[i]));
        compare_shared(made.compiled, settings, one);
        compare_stopping(made.compiled, settings, one);
        compare_sharing(made.compiled, settings, one);
        compare_airlight(made.compiled, settings, one);
        printf("\n");
        fflush(stdout);
        made_clear(&made);
    }
    pool_free(one);
}
