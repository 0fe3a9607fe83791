/* stated.c - the noise that a render states over the error that it has, against a reference with far more samples.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>

#include "base/luminance.h"
#include "measure.h"

enum { WIDTH = 48, HEIGHT = 36, PIXELS = WIDTH * HEIGHT, SEEDS = 4, REFERENCE = 1024, MOST = 512, FIRST_SEED = 100 };

/* What is smooth: a floor beneath one large lamp, and matte balls in even light. */
static const char *const smooth[][2] = {
    {"(floor, large lamp)",
     "meniscus 1.0 unit mm light { from = <0, 10, 0> to = <0, 0, 0> size = <8, 8> radiance = 12 }"
     "ground { surface = surface { albedo = .6 } } camera { from = <0, 3, 8> to = <0, 0, 0> fov = 30 }"},
    {"(matte balls, even sky)",
     "meniscus 1.0 unit mm environment { color = 1 } ground { surface = surface { albedo = .6 } }"
     "sphere { center = <0, 1, 0> radius = 1 surface = surface { albedo = .5 } }"
     "sphere { center = <2, .7, .4> radius = .7 surface = surface { albedo = .8 } }"
     "camera { from = <0, 3, 8> to = <0, .8, 0> fov = 30 }"},
};

typedef struct Rendered {
    double luminance[PIXELS], noise, samples;
} Rendered;

static void render_one(const CompiledScene *compiled, uint32_t samples, double noise, uint32_t seed, Pool *pool,
                       Rendered *rendered)
{
    Error error = {0};
    Image image;
    RenderStats stats;
    RenderSettings settings = {.width = WIDTH,
                               .height = HEIGHT,
                               .samples = samples,
                               .noise = noise,
                               .seed = seed,
                               .bounces = compiled->scene->render.bounces,
                               .caustics = compiled->scene->render.caustics,
                               .spreads = compiled->scene->render.spreads};
    if (render_image(compiled, &settings, pool, NULL, &image, &stats, &error) != STATUS_OK)
        bench_fail("render", &error);
    for (uint32_t p = 0; p < PIXELS; p++)
        rendered->luminance[p] = (double)color_luminance(image.pixels + p * image.n_channels);
    rendered->noise = stats.noise;
    rendered->samples = stats.mean_samples;
    image_clear(&image);
}

/* The noise as render/adapt.h has it, of which the reference's own part is taken off as if errors were normal. */
static double measured_noise(const Rendered *rendered, const Rendered *reference)
{
    double sum = 0;
    for (int p = 0; p < PIXELS; p++)
        sum += fabs(rendered->luminance[p] - reference->luminance[p]) / hypot(reference->luminance[p], 0.1) / PIXELS;
    return sum / sqrt(1 + rendered->samples / reference->samples);
}

/* Prints the quotient with its standard error. */
static void compare(const CompiledScene *compiled, uint32_t samples, double noise, Pool *pool,
                    const Rendered *reference)
{
    static Rendered rendered;
    double ratio = 0, squares = 0, mean_samples = 0, measured = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        render_one(compiled, samples, noise, seed, pool, &rendered);
        double error = measured_noise(&rendered, reference), quotient = rendered.noise / error;
        measured += error / SEEDS;
        mean_samples += rendered.samples / SEEDS;
        ratio += quotient / SEEDS;
        squares += quotient * quotient / SEEDS;
    }
    double error = sqrt(fmax(squares - ratio * ratio, 0) / (SEEDS - 1));
    printf("  %5.1f %5.0f %5.2f +-%4.2f%s", 100 * measured, mean_samples, ratio, error,
           ratio < 0.8 || ratio > 1.25 ? "!" : " ");
    fflush(stdout);
}

static void stated_of_scene(const char *name, const Made *made, Pool *pool)
{
    static Rendered reference;
    static const uint32_t samples[] = {16, 64};
    static const double targets[] = {0.2, 0.1};
    render_one(made->compiled, REFERENCE, 0, FIRST_SEED, pool, &reference);
    printf("%-24s", name);
    for (size_t i = 0; i < COUNT_OF(samples); i++) compare(made->compiled, samples[i], 0, pool, &reference);
    for (size_t i = 0; i < COUNT_OF(targets); i++) compare(made->compiled, MOST, targets[i], pool, &reference);
    printf("\n");
}

void bench_stated(char **paths, int n)
{
    Pool *pool = pool_of(2);
    printf("the noise that is stated over the error against %d samples, within a quarter: !, where not. Of 16 and 64 "
           "samples\neverywhere, and of pixels that stop at 20 and 10 %%: error in %%, samples, quotient with its "
           "standard error\n",
           REFERENCE);
    Made made;
    for (size_t i = 0; i < COUNT_OF(smooth); i++) {
        made_from_text(&made, smooth[i][1]);
        stated_of_scene(smooth[i][0], &made, pool);
        made_clear(&made);
    }
    for (int i = 0; i < n; i++) {
        made_from_file(&made, paths[i]);
        stated_of_scene(file_name(paths[i]), &made, pool);
        made_clear(&made);
    }
    pool_free(pool);
}
