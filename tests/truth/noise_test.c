/* noise_test.c - the noise that is stated against the error that is there; adaptive renders against plain ones.
 * No reference is needed: of several renders with seeds of their own, each is compared with the mean of the others.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { RENDERS = 8, WIDTH = 32, HEIGHT = 24, PIXELS = WIDTH * HEIGHT, MOST = 256 };

typedef struct Series {
    double luminance[RENDERS][PIXELS], squared_error[RENDERS][PIXELS]; /* the second as the channel noise.Y has it */
    double mean_samples, least, most;
    Estimate noise;
} Series;

static RenderSettings settings_of(const Fixture *scene, double noise, uint32_t samples, uint32_t seed)
{
    return (RenderSettings){.width = WIDTH,
                            .height = HEIGHT,
                            .samples = samples,
                            .noise = noise,
                            .seed = seed,
                            .bounces = scene->scene->render.bounces};
}

static void render(const Fixture *scene, const RenderSettings *settings, unsigned threads, Picture *picture)
{
    Pool *pool = NULL;
    Error error;
    if (pool_new(threads, &pool, &error) != STATUS_OK) fail_msg("%s", error.text);
    if (render_image(scene->compiled, settings, pool, NULL, &picture->image, &picture->stats, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    pool_free(pool);
}

static void render_series(const Fixture *scene, double noise, uint32_t samples, uint32_t seed, Series *series)
{
    double noises[RENDERS];
    series->mean_samples = 0;
    series->least = INFINITY;
    series->most = 0;
    for (uint32_t i = 0; i < RENDERS; i++) {
        Picture picture;
        RenderSettings settings = settings_of(scene, noise, samples, seed + i);
        render(scene, &settings, 0, &picture);
        for (uint32_t p = 0; p < PIXELS; p++) {
            series->luminance[i][p] = truth_luminance(&picture, p % WIDTH, p / WIDTH);
            series->squared_error[i][p] = pow(truth_channel(&picture, p % WIDTH, p / WIDTH, 4), 2);
        }
        noises[i] = picture.stats.noise;
        series->mean_samples += picture.stats.mean_samples / RENDERS;
        series->least = fmin(series->least, picture.stats.samples);
        series->most = fmax(series->most, picture.stats.most_samples);
        truth_clear(&picture);
    }
    series->noise = truth_estimate(noises, RENDERS);
}

/* The fifth channel is noise.Y. The mean over the pixels of |error| over the root of luminance^2 + 0.1^2, and the root mean squares of the error and of
 * noise.Y. The error of the mean of the others comes on top; it is taken off as if both were normal. */
static void measure(const Series *series, double *relative, double *rms, double *film_rms)
{
    double others = 1 + 1.0 / (RENDERS - 1);
    *relative = *rms = *film_rms = 0;
    for (uint32_t p = 0; p < PIXELS; p++) {
        double sum = 0;
        for (uint32_t i = 0; i < RENDERS; i++) sum += series->luminance[i][p];
        for (uint32_t i = 0; i < RENDERS; i++) {
            double rest = (sum - series->luminance[i][p]) / (RENDERS - 1), error = series->luminance[i][p] - rest;
            *relative += fabs(error) / sqrt(others) / hypot(sum / RENDERS, 0.1) / (RENDERS * PIXELS);
            *rms += error * error / others / (RENDERS * PIXELS);
            *film_rms += series->squared_error[i][p] / (RENDERS * PIXELS);
        }
    }
    *rms = sqrt(*rms);
    *film_rms = sqrt(*film_rms);
}

/* The mean of whole pictures. */
static Estimate mean_of(const Series *series)
{
    double means[RENDERS] = {0};
    for (uint32_t i = 0; i < RENDERS; i++)
        for (uint32_t p = 0; p < PIXELS; p++) means[i] += series->luminance[i][p] / PIXELS;
    return truth_estimate(means, RENDERS);
}

static void expect_within_a_quarter(const char *what, double stated, double measured)
{
    print_message("    %-44s %7.3f %%, measured %7.3f %%, ratio %.2f\n", what, 100 * stated, 100 * measured,
                  stated / measured);
    assert_true(stated < 1.25 * measured && stated > measured / 1.25);
}

static void stated_is_measured(const char *file, double noise)
{
    static Series plain, adaptive;
    Fixture scene;
    truth_open(&scene, (TruthInput){.file = file, .policy = NEST_AUTOMATIC});
    render_series(&scene, noise, MOST, 1, &adaptive);
    render_series(&scene, 0, 64, 101, &plain);
    print_message("%s, each pixel to %g %%: %g to %g samples, %.1f on average\n", file, 100 * noise, adaptive.least,
                  adaptive.most, adaptive.mean_samples);
    double relative, rms, film_rms;
    measure(&adaptive, &relative, &rms, &film_rms);
    expect_within_a_quarter("noise stated, adaptive", adaptive.noise.mean, relative);
    expect_within_a_quarter("noise.Y, root mean square, adaptive", film_rms, rms);
    assert_true(relative < 1.05 * noise);
    measure(&plain, &relative, &rms, &film_rms);
    expect_within_a_quarter("noise stated, 64 samples everywhere", plain.noise.mean, relative);
    expect_within_a_quarter("noise.Y, root mean square, 64 samples", film_rms, rms);
    Estimate one = mean_of(&adaptive), other = mean_of(&plain);
    double error = hypot(one.error, other.error);
    print_message("    mean of adaptive pictures %.6f, of plain ones %.6f: %+.2f standard errors of %.2g\n", one.mean,
                  other.mean, (one.mean - other.mean) / error, error);
    assert_true(fabs(one.mean - other.mean) < 4 * error);
    fixture_clear(&scene);
}

static void whisky(void **state)
{
    (void)state;
    stated_is_measured("examples/whisky.mns", 0.16);
}

static void tea(void **state)
{
    (void)state;
    stated_is_measured("examples/tea.mns", 0.2);
}

static void surfaces(void **state)
{
    (void)state;
    stated_is_measured("examples/surfaces.mns", 0.08);
}

static void snells_window(void **state)
{
    (void)state;
    stated_is_measured("examples/snells-window.mns", 0.12);
}

/* What stops when its own samples happen to agree is too dark in the mean: lights so small that few paths meet them show it.
 * Here the floor is lit by a small sun, which is left to chance, through nothing. */
static void rare_light_is_not_lost(void **state)
{
    (void)state;
    static Series series;
    Fixture scene;
    fixture_compile(
        &scene,
        "meniscus 1.0 unit mm ground { surface = surface { albedo = .8 } }"
        "sphere { center = <0, 8, 0>  radius = 1  surface = surface { albedo = 0  emission = 1  radiance = 20 } }"
        "camera { from = <0, 4, 6>  to = <0, 0, 0>  fov = 20 }",
        1);
    double means[RENDERS];
    for (uint32_t i = 0; i < RENDERS; i++) {
        Picture picture;
        RenderSettings settings = settings_of(&scene, 0.12, 4096, i);
        settings.by_chance = true;
        render(&scene, &settings, 0, &picture);
        means[i] = 0;
        for (uint32_t p = 0; p < PIXELS; p++) means[i] += truth_luminance(&picture, p % WIDTH, p / WIDTH) / PIXELS;
        assert_true(picture.stats.mean_samples > 30);
        truth_clear(&picture);
    }
    render_series(&scene, 0, 16, 100, &series);
    truth_expect("a rare light, by adaptive renders, and looked for", mean_of(&series).mean,
                 truth_estimate(means, RENDERS), 4, 0.005);
    fixture_clear(&scene);
}

/* The bits are the same for any number of threads. */
static void threads_do_not_matter(void **state)
{
    (void)state;
    Fixture scene;
    truth_open(&scene, (TruthInput){.file = "examples/surfaces.mns", .policy = NEST_AUTOMATIC});
    Picture one, three;
    RenderSettings settings = settings_of(&scene, 0.1, MOST, 5);
    settings.aovs = (AovSet)1 << AOV_SAMPLES;
    render(&scene, &settings, 1, &one);
    render(&scene, &settings, 3, &three);
    size_t bytes = (size_t)PIXELS * one.image.n_channels * sizeof *one.image.pixels;
    assert_memory_equal(one.image.pixels, three.image.pixels, bytes);
    assert_true(one.stats.noise == three.stats.noise && one.stats.paths == three.stats.paths);
    int samples = image_channel(&one.image, "samples");
    assert_true(samples >= 0);
    double sum = 0;
    for (uint32_t p = 0; p < PIXELS; p++) sum += (double)one.image.pixels[p * one.image.n_channels + (uint32_t)samples];
    assert_near(sum / PIXELS, one.stats.mean_samples, 1e-6);
    assert_true(one.stats.most_samples > one.stats.samples && one.stats.most_samples <= MOST);
    truth_clear(&one);
    truth_clear(&three);
    fixture_clear(&scene);
}

/* Total reflection within a cut diamond is not cut off by the default number of bounces, which 32 would do. The paths are
 * the same ones, so that their means differ by what is cut off alone. */
static void long_ways_are_not_cut_off(void **state)
{
    (void)state;
    Fixture scene;
    truth_open(&scene, (TruthInput){.file = "examples/diamond.mns", .policy = NEST_AUTOMATIC});
    const uint32_t bounces[] = {32, scene.scene->render.bounces, 4000};
    double mean[3] = {0};
    for (int i = 0; i < 3; i++) {
        Picture picture;
        RenderSettings settings = settings_of(&scene, 0, 192, 1);
        settings.bounces = bounces[i];
        render(&scene, &settings, 0, &picture);
        for (uint32_t p = 0; p < PIXELS; p++) mean[i] += truth_luminance(&picture, p % WIDTH, p / WIDTH) / PIXELS;
        truth_clear(&picture);
    }
    print_message("a diamond with %u, %u and %u bounces: %.6f, %.6f, %.6f\n", bounces[0], bounces[1], bounces[2],
                  mean[0], mean[1], mean[2]);
    assert_true(mean[0] < 0.997 * mean[2]);
    assert_near(mean[1] / mean[2], 1, 0.001);
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whisky),
        cmocka_unit_test(tea),
        cmocka_unit_test(surfaces),
        cmocka_unit_test(snells_window),
        cmocka_unit_test(rare_light_is_not_lost),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(long_ways_are_not_cut_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
