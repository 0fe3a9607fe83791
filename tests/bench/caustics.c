/* caustics.c - what leading paths to small lights behind glass is worth: the squared error at equal time, with against
 * without, by several seeds.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/luminance.h"
#include "measure.h"

enum { WIDTH = 64, HEIGHT = 48, SAMPLES = 32, LONGER = 24, SEEDS = 5 };

static double render(const CompiledScene *compiled, uint32_t samples, uint32_t seed, SceneCaustics caustics, Pool *pool,
                     Image *image)
{
    RenderSettings settings = {
        .width = WIDTH, .height = HEIGHT, .samples = samples, .seed = seed, .bounces = 32, .caustics = caustics};
    RenderStats stats;
    Error error = {0};
    if (render_image(compiled, &settings, pool, NULL, image, &stats, &error) != STATUS_OK) bench_fail("render", &error);
    return stats.cpu_seconds;
}

/* Mean square of the errors, relative to the root of luminance^2 + 0.01^2. A pixel counts 1 at most: some lone bright samples
 * that one seed meets and another does not would be all that is measured. */
static double relative_error(const Image *image, const Image *truth)
{
    double sum = 0;
    for (uint32_t p = 0; p < WIDTH * HEIGHT; p++) {
        double is = (double)color_luminance(image->pixels + p * image->n_channels);
        double should = (double)color_luminance(truth->pixels + p * truth->n_channels);
        sum += fmin((is - should) * (is - should) / (should * should + 1e-4), 1) / (WIDTH * HEIGHT);
    }
    return sum;
}

static int compare_numbers(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Without photons, what is bright by a lone sample is met by some seeds only: the median of several is what a user sees,
 * the least and the most are how far luck goes. */
static void compare(const char *what, const char *text, Pool *pool)
{
    Made made;
    Image truth, with, without;
    double ratios[SEEDS], errors[SEEDS], plain[SEEDS];
    uint32_t samples = 0;
    made_from_text(&made, text);
    render(made.compiled, LONGER * SAMPLES, 1, CAUSTICS_AUTOMATIC, pool, &truth);
    for (uint32_t i = 0; i < SEEDS; i++) {
        double cpu_s = render(made.compiled, SAMPLES, 2 + i, CAUSTICS_AUTOMATIC, pool, &with);
        double trial_s = render(made.compiled, SAMPLES, 2 + i, CAUSTICS_OFF, pool, &without);
        if (i == 0) samples = (uint32_t)fmax(SAMPLES * cpu_s / trial_s, 1);
        image_clear(&without);
        render(made.compiled, samples, 2 + i, CAUSTICS_OFF, pool, &without);
        errors[i] = relative_error(&with, &truth);
        plain[i] = relative_error(&without, &truth);
        ratios[i] = plain[i] / errors[i];
        image_clear(&with);
        image_clear(&without);
    }
    qsort(ratios, SEEDS, sizeof *ratios, compare_numbers);
    qsort(errors, SEEDS, sizeof *errors, compare_numbers);
    qsort(plain, SEEDS, sizeof *plain, compare_numbers);
    printf("%-34s %6u %8u %12.4g %12.4g %10.3g  %.3g .. %.3g\n", what, SAMPLES, samples, errors[SEEDS / 2],
           plain[SEEDS / 2], ratios[SEEDS / 2], ratios[0], ratios[SEEDS - 1]);
    fflush(stdout);
    image_clear(&truth);
    made_clear(&made);
}

#define START                                                                                                          \
    "meniscus 1.0 unit mm medium glass { ior = 1.5 state = solid } medium water { ior = 1.33 state = liquid } "        \
    "ground { surface = surface { albedo = .6 } } environment { color = .2 } "
#define SUN "light { shape = \"distant\" from = <.5, 1, .2> to = <0, 0, 0> angle = .53deg power = 5 } "
#define FLINT "medium flint { ior = cauchy(1.6, .012) state = solid } "
#define SMOKE                                                                                                          \
    "medium smoke { ior = 1 scattering = .0004 absorption = .00002 phase = hg(.2) state = gas } "                      \
    "box { interior = smoke from = <-700, -600, -600> to = <800, 600, 1000> } "

void bench_caustics(void)
{
    Pool *one = pool_of(1);
    printf("caustics: samples with photons and, in the same time, without; mean squares of relative errors, 1 at most "
           "of a pixel, and their "
           "ratio: medians of %d seeds, and the least and greatest ratio\n%-34s %6s %8s %12s %12s %10s\n",
           SEEDS, "", "with", "without", "with", "without", "ratio");
    compare("a ball of glass in the sun",
            START SUN "sphere { interior = glass center = <0, 14, 0> radius = 10 } "
                      "camera { from = <0, 60, 120> to = <-6, 2, -2> fov = 20 }",
            one);
    compare("a pool in the sun, with a drop",
            START SUN "box { interior = water from = <-200, -1, -200> to = <200, 40, 200> } "
                      "sphere { interior = water center = <0, 42, 0> radius = 10 } "
                      "camera { from = <0, 200, 100> to = <0, 0, 0> fov = 24 }",
            one);
    compare("a lamp in a bulb of glass",
            START
            "sphere { interior = glass center = <0, 40, 0> radius = 12 } "
            "sphere { interior = air center = <0, 40, 0> radius = 11 } "
            "sphere { center = <0, 40, 0> radius = 1 surface = surface { albedo = 0 emission = 1 radiance = 2000 } } "
            "camera { from = <0, 90, 200> to = <0, 15, 0> fov = 30 }",
            one);
    compare("a lamp in a frosted globe, a floor",
            START
            "sphere { interior = glass center = <0, 80, 0> radius = 60 surface = surface { roughness = .2 } } "
            "sphere { interior = air center = <0, 80, 0> radius = 58 } "
            "sphere { center = <0, 80, 0> radius = 1 surface = surface { albedo = 0 emission = 1 radiance = 20000 } } "
            "camera { from = <0, 120, 400> to = <0, 50, 0> fov = 35 }",
            one);
    compare("a drink in the sun",
            START SUN "cylinder { interior = glass from = <0, .1, 0> to = <0, 40, 0> radius = 15 } "
                      "cylinder { interior = water from = <0, 4, 0> to = <0, 30, 0> radius = 12.1 } "
                      "cylinder { interior = air from = <0, 30, 0> to = <0, 41, 0> radius = 12 } "
                      "sphere { interior = air center = <2, 20, 3> radius = 3 } "
                      "camera { from = <0, 120, 150> to = <-10, 8, 0> fov = 28 }",
            one);
    compare("a rainbow of the sun on a floor",
            START SUN FLINT "prism { interior = flint outline = [<-20, 0>, <20, 0>, <0, 34.6>] from = -60 to = 60 "
                            "rotate(x, -90) rotate(z, -120) translate(<60, 200, 0>) } "
                            "camera { from = <-30, 230, 260> to = <-30, 0, 0> fov = 34 }",
            one);
    compare("a beam in smoke, behind a prism",
            "meniscus 1.0 unit mm environment { color = .002 } " SMOKE FLINT
            "prism { interior = flint outline = [<-80, 0>, <80, 0>, <0, 138>] from = -50 to = 50 rotate(x, -90) } "
            "light { shape = disc radius = 7 from = <-400, -170, 0> to = <-40, 69, 0> angle = 1 power = .15 } "
            "camera { from = <0, 20, 900> to = <270, -70, 0> fov = 12 expect = [smoke] }",
            one);
    compare("smoke behind a ball of glass",
            "meniscus 1.0 unit mm environment { color = .002 } medium glass { ior = 1.5 state = solid } " SMOKE
            "sphere { interior = glass radius = 80 } "
            "light { shape = disc radius = 50 from = <-500, 300, 0> to = <0, 0, 0> angle = 2 power = .5 } "
            "camera { from = <0, 0, 900> to = <150, -90, 0> fov = 14 expect = [smoke] }",
            one);
    pool_free(one);
}
