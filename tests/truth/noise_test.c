/* noise_test.c - the noise that is stated against the error that is there; adaptive renders against plain ones.
 * No reference is needed: of several renders with seeds of their own, each is compared with the mean of the others.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include <stdlib.h>

enum { RENDERS = 8, WIDTH = 32, HEIGHT = 24, PIXELS = WIDTH * HEIGHT, MOST = 256, BINS = 4 };

typedef struct Series {
    double luminance[RENDERS][PIXELS], squared_error[RENDERS][PIXELS]; /* the second as the channel noise.Y has it */
    double mean_samples, least, most;
    double noises[RENDERS]; /* stated */
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

/* wish: the noise, the samples, whether they are shared out, caustics, and the first seed. */
static void render_series(const Fixture *scene, RenderSettings wish, Series *series)
{
    series->mean_samples = 0;
    series->least = INFINITY;
    series->most = 0;
    for (uint32_t i = 0; i < RENDERS; i++) {
        Picture picture;
        RenderSettings settings = settings_of(scene, wish.noise, wish.samples, wish.seed + i);
        settings.adaptive = wish.adaptive;
        settings.caustics = wish.caustics;
        render(scene, &settings, 0, &picture);
        for (uint32_t p = 0; p < PIXELS; p++) {
            series->luminance[i][p] = truth_luminance(&picture, p % WIDTH, p / WIDTH);
            series->squared_error[i][p] = pow(truth_channel(&picture, p % WIDTH, p / WIDTH, 4), 2);
        }
        series->noises[i] = picture.stats.noise;
        series->mean_samples += picture.stats.mean_samples / RENDERS;
        series->least = fmin(series->least, picture.stats.samples);
        series->most = fmax(series->most, picture.stats.most_samples);
        truth_clear(&picture);
    }
}

/* What a series says of its errors against what they are. */
typedef struct Errors {
    double noise;    /* mean over pixels and pictures of |error| over the root of luminance^2 + 0.1^2 */
    Estimate stated; /* the noise that each picture states over its own: mean, and standard error over the pictures */
    /* the root mean square of the channel noise.Y over that of the error, of the quarter of the pixels for which it is lowest,
     * the next, ...; and its standard error */
    Estimate film[BINS];
} Errors;

typedef struct StatedError {
    double stated, error; /* squares */
} StatedError;

static int by_stated(const void *a, const void *b)
{
    double x = ((const StatedError *)a)->stated, y = ((const StatedError *)b)->stated;
    return x < y ? -1 : x > y;
}

/* Of pixels with squares of errors, by pictures. */
static void fill_bins(StatedError pixels[RENDERS][PIXELS], Errors *errors)
{
    double stated[BINS] = {0}, squares[BINS][RENDERS] = {{0}};
    for (uint32_t i = 0; i < RENDERS; i++) {
        qsort(pixels[i], PIXELS, sizeof pixels[i][0], by_stated);
        for (uint32_t p = 0; p < PIXELS; p++) {
            stated[p * BINS / PIXELS] += pixels[i][p].stated / RENDERS;
            squares[p * BINS / PIXELS][i] += pixels[i][p].error;
        }
    }
    for (int bin = 0; bin < BINS; bin++) {
        Estimate square = truth_estimate(squares[bin], RENDERS);
        double ratio = sqrt(stated[bin] / square.mean);
        errors->film[bin] = (Estimate){ratio, 0.5 * ratio * square.error / square.mean};
    }
}

/* The error of the mean of the others comes on top; it is taken off as if both were normal. */
static Errors errors_of(const Series *series)
{
    double others = 1 + 1.0 / (RENDERS - 1), noise[RENDERS] = {0}, quotients[RENDERS];
    Errors errors = {0};
    static StatedError pixels[RENDERS][PIXELS];
    for (uint32_t p = 0; p < PIXELS; p++) {
        double sum = 0;
        for (uint32_t i = 0; i < RENDERS; i++) sum += series->luminance[i][p];
        for (uint32_t i = 0; i < RENDERS; i++) {
            double rest = (sum - series->luminance[i][p]) / (RENDERS - 1), error = series->luminance[i][p] - rest;
            noise[i] += fabs(error) / sqrt(others) / hypot(sum / RENDERS, 0.1) / PIXELS;
            pixels[i][p] = (StatedError){series->squared_error[i][p], error * error / others};
        }
    }
    for (uint32_t i = 0; i < RENDERS; i++) {
        quotients[i] = series->noises[i] / noise[i];
        errors.noise += noise[i] / RENDERS;
    }
    errors.stated = truth_estimate(quotients, RENDERS);
    fill_bins(pixels, &errors);
    return errors;
}

/* The mean of whole pictures. */
static Estimate mean_of(const Series *series)
{
    double means[RENDERS] = {0};
    for (uint32_t i = 0; i < RENDERS; i++)
        for (uint32_t p = 0; p < PIXELS; p++) means[i] += series->luminance[i][p] / PIXELS;
    return truth_estimate(means, RENDERS);
}

static bool is_within(Estimate quotient, double low, double high)
{
    double doubt = 2 * quotient.error;
    return quotient.mean + doubt > low && quotient.mean - doubt < high;
}

/* To two standard errors. The channel noise.Y only where single samples do not make up its mean square; it may state more
 * for quiet pixels beside noisy ones: in surfaces.mns 1.6 times what is there, after 16 samples, of a quarter of the pixels. */
static void expect_within_a_quarter(const char *what, const Series *series, bool fireflies)
{
    Errors errors = errors_of(series);
    print_message("    %-22s %5.1f samples  error %7.3f %%; stated over measured %.2f +- %.2f, noise.Y", what,
                  series->mean_samples, 100 * errors.noise, errors.stated.mean, errors.stated.error);
    for (int bin = 0; bin < BINS; bin++) print_message(" %.2f +- %.2f", errors.film[bin].mean, errors.film[bin].error);
    print_message("\n");
    assert_true(is_within(errors.stated, 0.8, 1.25));
    for (int bin = 0; bin < BINS && !fireflies; bin++) assert_true(is_within(errors.film[bin], 0.8, 1.6));
}

static void expect_same_mean(const Series *adaptive, const Series *plain)
{
    Estimate one = mean_of(adaptive), other = mean_of(plain);
    double error = hypot(one.error, other.error);
    print_message("    its mean %.6f, of plain pictures %.6f: %+.2f standard errors of %.2g\n", one.mean, other.mean,
                  (one.mean - other.mean) / error, error);
    assert_true(fabs(one.mean - other.mean) < 4 * error);
}

/* With as many samples everywhere, shared out, and at two targets. */
static void stated_is_measured(TruthInput input, bool fireflies, const double targets[2])
{
    static Series plain, adaptive;
    Fixture scene;
    input.policy = NEST_AUTOMATIC;
    truth_open(&scene, input);
    print_message("%s\n", input.file ? input.file : "a scene of its own");
    render_series(&scene, (RenderSettings){.samples = 16, .seed = 201}, &plain);
    expect_within_a_quarter("16 everywhere", &plain, fireflies);
    render_series(&scene, (RenderSettings){.samples = 64, .seed = 101}, &plain);
    expect_within_a_quarter("64 everywhere", &plain, fireflies);
    render_series(&scene, (RenderSettings){.samples = 64, .adaptive = true, .seed = 301}, &adaptive);
    expect_within_a_quarter("64 shared out", &adaptive, fireflies);
    expect_same_mean(&adaptive, &plain);
    assert_near(adaptive.mean_samples, 64, 0.02 * 64);
    assert_true(adaptive.least >= 16);
    for (uint32_t i = 0; i < 2; i++) {
        char what[40];
        render_series(&scene, (RenderSettings){.noise = targets[i], .samples = MOST, .seed = 1 + 20 * i}, &adaptive);
        snprintf(what, sizeof what, "each pixel to %g %%", 100 * targets[i]);
        expect_within_a_quarter(what, &adaptive, fireflies);
        if (adaptive.most < MOST) assert_true(errors_of(&adaptive).noise < 1.05 * targets[i]);
        expect_same_mean(&adaptive, &plain);
    }
    fixture_clear(&scene);
}

/* As smooth as it gets: nothing but two dimensions of one large light. Evenly spread samples converge much faster there than
 * their halves say. */
static void a_floor_beneath_a_large_lamp(void **state)
{
    (void)state;
    const char *text = "meniscus 1.0 unit mm light { from = <0, 10, 0> to = <0, 0, 0> size = <8, 8> radiance = 12 }"
                       "environment { strength = .3 } ground { surface = surface { albedo = .6 } }"
                       "camera { from = <0, 3, 8> to = <0, 0, 0> fov = 30 }";
    stated_is_measured((TruthInput){.text = text}, false, (const double[2]){0.05, 0.02});
}

static void matte_balls_in_even_light(void **state)
{
    (void)state;
    const char *text = "meniscus 1.0 unit mm environment { color = 1 } ground { surface = surface { albedo = .6 } }"
                       "sphere { center = <0, 1, 0> radius = 1 surface = surface { albedo = .5 } }"
                       "sphere { center = <2, .7, .4> radius = .7 surface = surface { albedo = .8 } }"
                       "camera { from = <0, 3, 8> to = <0, .8, 0> fov = 30 }";
    stated_is_measured((TruthInput){.text = text}, false, (const double[2]){0.06, 0.03});
}

static void whisky(void **state)
{
    (void)state;
    stated_is_measured((TruthInput){.file = "examples/whisky.mns"}, false, (const double[2]){0.2, 0.12});
}

/* Caustics. */
static void tea(void **state)
{
    (void)state;
    stated_is_measured((TruthInput){.file = "examples/tea.mns"}, false, (const double[2]){0.25, 0.16});
}

static void candles(void **state)
{
    (void)state;
    stated_is_measured((TruthInput){.file = "examples/candles.mns"}, true, (const double[2]){0.2, 0.12});
}

static void surfaces(void **state)
{
    (void)state;
    stated_is_measured((TruthInput){.file = "examples/surfaces.mns"}, false, (const double[2]){0.16, 0.08});
}

static void snells_window(void **state)
{
    (void)state;
    const char *const defines[] = {"sun=false", NULL}; /* whose light through waves is that of single samples */
    stated_is_measured((TruthInput){.file = "examples/snells-window.mns", .defines = defines}, false,
                       (const double[2]){0.2, 0.1});
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
    render_series(&scene, (RenderSettings){.samples = 16, .seed = 100}, &series);
    truth_expect("a rare light, by adaptive renders, and looked for", mean_of(&series).mean,
                 truth_estimate(means, RENDERS), 4, 0.005);
    fixture_clear(&scene);
}

/* What the manual says of it where even neighbours have not met it: as photons would a lamp behind water, which is here left to chance. */
static void rarer_light_is_hardly_lost(void **state)
{
    (void)state;
    static Series stopped, plain;
    Fixture scene;
    fixture_compile(&scene,
                    "meniscus 1.0 unit m  light { shape = sphere  from = <20, 40, 30>  radius = 2  radiance = 350 }"
                    "environment { color = .2 }  plane { surface = surface { albedo = .6 }  translate(<0, -12, 0>) }"
                    "medium water { ior = 1.33  state = liquid  absorption = .01  scattering = .01  phase = hg(.7) }"
                    "medium glass { ior = 1.5  state = solid  absorption = .01 }"
                    "box { from = <-10, -11, -10>  to = <10, 6, 10>  interior = water }"
                    "sphere { center = <0, 0, -4>  radius = 5  interior = glass }"
                    "camera { from = <0, 3, 45>  to = <0, 0, -8>  fov = 60 }",
                    1);
    render_series(&scene, (RenderSettings){.noise = 0.05, .samples = 2048, .caustics = CAUSTICS_OFF, .seed = 1},
                  &stopped);
    render_series(&scene, (RenderSettings){.samples = 512, .caustics = CAUSTICS_OFF, .seed = 100}, &plain);
    Estimate one = mean_of(&stopped), other = mean_of(&plain);
    double lost = 1 - one.mean / other.mean, error = hypot(one.error, other.error) / other.mean;
    print_message("    stopped at 5 %%, after %.0f samples: %.2f +- %.2f %% too dark\n", stopped.mean_samples,
                  100 * lost, 100 * error);
    assert_true(lost - 4 * error < 0.02 && lost + 4 * error > 0 && error < 0.004);
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
    const uint32_t bounces[] = {32, scene.scene->render.bounces, 20000};
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
        cmocka_unit_test(a_floor_beneath_a_large_lamp),
        cmocka_unit_test(matte_balls_in_even_light),
        cmocka_unit_test(whisky),
        cmocka_unit_test(tea),
        cmocka_unit_test(candles),
        cmocka_unit_test(surfaces),
        cmocka_unit_test(snells_window),
        cmocka_unit_test(rare_light_is_not_lost),
        cmocka_unit_test(rarer_light_is_hardly_lost),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(long_ways_are_not_cut_off),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
