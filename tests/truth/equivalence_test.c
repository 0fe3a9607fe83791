/* equivalence_test.c - the same glass, water and ice modelled with hulls that overlap and with faces that coincide
 * converge to the same picture; with gaps of air they do not, nor without nesting.
 *
 * Two pictures are each made several times with seeds of their own. In every pixel the difference of their means over its
 * standard error from the spread of the repetitions is Student's t with 2 K - 2 degrees of freedom if the expectations are
 * equal; the mean of t^2 over the pixels is then nu / (nu - 2), with a variance that follows from the fourth
 * moment 3 nu^2 / ((nu - 2) (nu - 4)) (N. L. Johnson, S. Kotz, N. Balakrishnan, Continuous Univariate Distributions, ch. 28).
 * SPDX-License-Identifier: Apache-2.0 */
#include "arrangements.h"
#include "truth.h"

enum { WIDTH = 40, N_PIXELS = WIDTH * WIDTH, REPEATS = 32, SAMPLES = 16 };

/* Bright enough at the top, and with a horizon, so that what is bent elsewhere looks different. */
static double banded_sky(double elevation)
{
    return elevation > 0 ? 0.6 + 0.4 * sin(6 * elevation) : 0.15;
}

typedef struct Series {
    double mean[N_PIXELS], error[N_PIXELS]; /* of each pixel's luminance, by repetition */
    Estimate whole;                         /* mean of the picture, by repetition */
} Series;

static FaultCount faults;

static void render_series(const char *text, const char *define, NestPolicy policy, uint32_t first_seed, Series *series)
{
    static double values[N_PIXELS][REPEATS];
    double means[REPEATS] = {0};
    char whole[4096];
    const char *defines[] = {define, NULL};
    snprintf(whole, sizeof whole, "%s" TRUTH_SKY, text);
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = whole, .defines = defines, .sky = banded_sky, .policy = policy});
    for (uint32_t k = 0; k < REPEATS; k++) {
        RenderSettings settings = truth_settings(WIDTH, SAMPLES);
        settings.seed = first_seed + k;
        Picture picture;
        truth_render(&scene, &settings, 0, &picture);
        if (policy != NEST_NONE) truth_count(&faults, &picture.stats);
        for (uint32_t i = 0; i < N_PIXELS; i++) {
            values[i][k] = truth_luminance(&picture, i % WIDTH, i / WIDTH);
            means[k] += values[i][k] / N_PIXELS;
        }
        truth_clear(&picture);
    }
    fixture_clear(&scene);
    for (uint32_t i = 0; i < N_PIXELS; i++) {
        Estimate e = truth_estimate(values[i], REPEATS);
        series->mean[i] = e.mean;
        series->error[i] = e.error;
    }
    series->whole = truth_estimate(means, REPEATS);
}

/* How far two series are apart: of the means, and of the pixels' t^2 from what chance makes of it. */
typedef struct Distance {
    double mean_sigmas, pixels_sigmas;
} Distance;

static Distance distance_between(const char *what, const Series *a, const Series *b)
{
    char name[120];
    double sum = 0, n = 0;
    for (uint32_t i = 0; i < N_PIXELS; i++) {
        double variance = a->error[i] * a->error[i] + b->error[i] * b->error[i], d = a->mean[i] - b->mean[i];
        if (!(variance > 0)) continue;
        sum += d * d / variance;
        n++;
    }
    double nu = 2 * REPEATS - 2, second = nu / (nu - 2), fourth = 3 * nu * nu / ((nu - 2) * (nu - 4));
    double t2 = sum / n, t2_error = sqrt((fourth - second * second) / n), error = hypot(a->whole.error, b->whole.error);
    snprintf(name, sizeof name, "%s: mean", what);
    truth_figure(name, a->whole.mean, b->whole.mean, error);
    snprintf(name, sizeof name, "%s: t^2", what);
    truth_figure(name, second, t2, t2_error);
    return (Distance){fabs(a->whole.mean - b->whole.mean) / error, (t2 - second) / t2_error};
}

static const Arrangement *arrangement(const char *name)
{
    for (size_t i = 0; i < COUNT_OF(arrangements); i++)
        if (strcmp(arrangements[i].name, name) == 0) return &arrangements[i];
    fail_msg("no arrangement '%s'", name);
    return NULL;
}

/* In units of what chance does; what differs is off by hundreds. */
static const double same = 4, other = 100;

static void expect_same(const char *name, const char *what, const Series *a, const Series *b)
{
    char text[100];
    snprintf(text, sizeof text, "%s, %s", name, what);
    Distance distance = distance_between(text, a, b);
    assert_true(distance.mean_sigmas <= same && fabs(distance.pixels_sigmas) <= same);
}

static void expect_other(const char *name, const char *what, const Series *a, const Series *b)
{
    char text[100];
    snprintf(text, sizeof text, "%s, %s", name, what);
    Distance distance = distance_between(text, a, b);
    assert_true(distance.pixels_sigmas >= other);
}

static void check_arrangement(const char *name, NestPolicy policy)
{
    static Series overlap, series;
    const char *text = arrangement(name)->text;
    render_series(text, "fit=.1", policy, 1, &overlap);
    render_series(text, "fit=.1", policy, 101, &series);
    expect_same(name, "overlap/overlap", &overlap, &series); /* what chance alone does */
    render_series(text, "fit=0", policy, 201, &series);
    expect_same(name, "overlap/faces", &overlap, &series);
    render_series(text, "fit=-.1", policy, 301, &series);
    expect_other(name, "overlap/gap", &overlap, &series);
    render_series(text, "fit=.1", NEST_NONE, 401, &series);
    expect_other(name, "nested/none", &overlap, &series);
}

static void whisky_glass(void **state)
{
    (void)state;
    check_arrangement("whisky on the rocks", NEST_AUTOMATIC);
}

static void aquarium(void **state)
{
    (void)state;
    check_arrangement("aquarium", NEST_AUTOMATIC);
}

static void glass_of_water_by_priorities(void **state)
{
    (void)state;
    check_arrangement("glass of water, by priorities", NEST_PRIORITY);
}

static void no_faults(void **state)
{
    (void)state;
    truth_print_faults("all pictures", &faults);
    assert_int_equal(faults.faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whisky_glass),
        cmocka_unit_test(aquarium),
        cmocka_unit_test(glass_of_water_by_priorities),
        cmocka_unit_test(no_faults),
    };
    return cmocka_run_group_tests_name("equivalence", tests, NULL, NULL);
}
