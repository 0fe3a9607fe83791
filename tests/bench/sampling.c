/* sampling.c - the ways in which samples are taken, against others: errors at equal time.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>

#include "measure.h"

enum { WIDTH = 64, HEIGHT = 48, PIXELS = WIDTH * HEIGHT, SEEDS = 8, CHANNELS = 3, BORDER = 6 };
enum { FEW = 2, SOME = 4, MANY = 16 }; /* samples */

static const struct {
    const char *name;
    Trial trial;
} ways[] = {
    {"as it is", {0}},
    {"every pixel for itself", {.pattern = PATTERN_ALONE}},
    {"every sample for itself", {.pattern = PATTERN_INDEPENDENT}},
    {"wavelengths by chance", {.wavelengths_by_chance = true}},
    {"choices by numbers apart", {.choices_apart = true}},
    {"choices by Fresnel alone", {.fresnel_alone = true}},
    {"frost by itself", {.frost_alone = true}},
    {"the hero alone goes on", {.hero_alone = true}},
    {"pairs from the camera on", {.pairs_from_camera = true}},
    {"roulette below 1/50", {.roulette_below = 0.02f}},
    {"roulette below 1/5", {.roulette_below = 0.2f}},
    {"roulette below 1/2", {.roulette_below = 0.5f}},
    {"roulette below 1", {.roulette_below = 1}},
};

/* Mean squares of relative errors, times the processor's time. */
typedef struct Worth {
    double pixels, blurred;
} Worth;

/* The mean square of what a Gaussian of a standard deviation of 1.5 pixels leaves of the error: what is seen from afar. */
static double blurred_square(float error[PIXELS][CHANNELS], int channel)
{
    double kernel[2 * BORDER + 1], all = 0, sum = 0;
    for (int i = -BORDER; i <= BORDER; i++) all += kernel[i + BORDER] = exp(-i * i / 4.5);
    for (int y = BORDER; y < HEIGHT - BORDER; y++)
        for (int x = BORDER; x < WIDTH - BORDER; x++) {
            double blurred = 0;
            for (int v = -BORDER; v <= BORDER; v++)
                for (int u = -BORDER; u <= BORDER; u++)
                    blurred +=
                        kernel[u + BORDER] * kernel[v + BORDER] * (double)error[(y + v) * WIDTH + x + u][channel];
            sum += blurred * blurred / pow(all, 4);
        }
    return sum / ((WIDTH - 2 * BORDER) * (HEIGHT - 2 * BORDER));
}

static Worth worth_of(const CompiledScene *compiled, uint32_t samples, Trial trial, Pool *pool)
{
    static float values[SEEDS][PIXELS][CHANNELS];
    double cpu_s = 0;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        Error error = {0};
        Image image;
        RenderStats stats;
        RenderSettings settings = {.width = WIDTH, .height = HEIGHT, .samples = samples, .seed = seed, .trial = trial};
        settings.bounces = compiled->scene->render.bounces;
        settings.caustics = CAUSTICS_OFF;
        if (render_image(compiled, &settings, pool, NULL, &image, &stats, &error) != STATUS_OK)
            bench_fail("render", &error);
        for (uint32_t p = 0; p < PIXELS; p++)
            for (uint32_t c = 0; c < CHANNELS; c++) values[seed][p][c] = image.pixels[p * image.n_channels + c];
        cpu_s += stats.cpu_seconds;
        image_clear(&image);
    }
    for (int p = 0; p < PIXELS; p++)
        for (int c = 0; c < CHANNELS; c++) {
            float mean = 0;
            for (int s = 0; s < SEEDS; s++) mean += values[s][p][c] / SEEDS;
            for (int s = 0; s < SEEDS; s++) values[s][p][c] = (values[s][p][c] - mean) / hypotf(mean, 0.1f);
        }
    Worth worth = {0};
    for (int s = 0; s < SEEDS; s++)
        for (int c = 0; c < CHANNELS; c++) {
            for (int p = 0; p < PIXELS; p++) worth.pixels += pow((double)values[s][p][c], 2) * cpu_s;
            worth.blurred += blurred_square(values[s], c) * cpu_s;
        }
    return worth;
}

void bench_sampling(char **paths, int n)
{
    Pool *one = pool_of(1);
    printf("other ways to take samples: their squared error times their time, over that of the present way; above 1 is "
           "worse.\nOf pixels of %d samples, of their low frequencies, and of those of %d and of %d\n",
           MANY, SOME, FEW);
    printf("%-26s", "");
    for (int i = 0; i < n; i++) printf("  %-27.27s", file_name(paths[i]));
    printf("\n");
    enum { MOST_SCENES = 16 };
    static Worth many[COUNT_OF(ways)][MOST_SCENES], some[COUNT_OF(ways)][MOST_SCENES], few[COUNT_OF(ways)][MOST_SCENES];
    for (int i = 0; i < n && i < MOST_SCENES; i++) {
        Made made;
        made_from_file(&made, paths[i]);
        for (size_t k = 0; k < COUNT_OF(ways); k++) {
            many[k][i] = worth_of(made.compiled, MANY, ways[k].trial, one);
            some[k][i] = worth_of(made.compiled, SOME, ways[k].trial, one);
            few[k][i] = worth_of(made.compiled, FEW, ways[k].trial, one);
        }
        made_clear(&made);
    }
    for (size_t k = 1; k < COUNT_OF(ways); k++) {
        printf("%-26s", ways[k].name);
        for (int i = 0; i < n && i < MOST_SCENES; i++)
            printf(" %5.2f  %5.2f  %5.2f  %5.2f  ", many[k][i].pixels / many[0][i].pixels,
                   many[k][i].blurred / many[0][i].blurred, some[k][i].blurred / some[0][i].blurred,
                   few[k][i].blurred / few[0][i].blurred);
        printf("\n");
    }
    pool_free(one);
}
