/* phase_test.c - phase functions: integrals by quadrature, mean cosines, sampled directions against the density.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "optics/phase.h"

static const double pi = 3.14159265358979323846;

static const struct {
    const char *name;
    double weight, g1, a1, g2, a2;
} cases[] = {
    {"isotropic", 1, 0, 0, 0, 0},        {"Henyey-Greenstein .85", 1, .85, 0, 0, 0},
    {"backward", 1, -.6, 0, 0, 0},       {"Rayleigh", 1, 0, 1, 0, 0},
    {"Draine .5, 20", 1, .5, 20, 0, 0},  {"Draine .002, 3", 1, .002, 3, 0, 0},
    {"Cornette-Shanks", 1, .8, 1, 0, 0}, {"two lobes", .7, .9, 0, -.3, 0},
};

static Phase phase_of(size_t i)
{
    return (Phase){cases[i].weight, {{cases[i].g1, cases[i].a1}, {cases[i].g2, cases[i].a2}}};
}

/* Of the phase function times the cosine to the power k, over the sphere; graded towards the peak. */
static double moment(const Phase *phase, int k)
{
    enum { STEPS = 400000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double x = (i + 0.5) / STEPS, cosine = 1 - 2 * x * x * x, width = 6 * x * x / STEPS;
        sum += 2 * pi * width * (double)phase_evaluate(phase, (float)cosine) * pow(cosine, k);
    }
    return sum;
}

static double lobe_mean_cosine(PhaseLobe lobe)
{
    double g = lobe.g, a = lobe.alpha;
    return g * (1 + a * (3 + 2 * g * g) / 5) / (1 + a * (1 + 2 * g * g) / 3);
}

static double mean_cosine(const Phase *phase)
{
    return phase->weight * lobe_mean_cosine(phase->lobes[0]) + (1 - phase->weight) * lobe_mean_cosine(phase->lobes[1]);
}

static void integrals_are_one(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Phase phase = phase_of(i);
        assert_near(moment(&phase, 0), 1, 2e-5);
        assert_near(moment(&phase, 1), mean_cosine(&phase), 2e-5);
    }
    for (double d = 5; d <= 50; d += 5) {
        Phase phase = phase_droplets(d);
        assert_near(moment(&phase, 0), 1, 1e-3); /* a peak of a hundredth of a degree, at cosines in float */
        assert_true(mean_cosine(&phase) > 0.7 && mean_cosine(&phase) < 0.95);
    }
}

/* Rayleigh's is 3 / (16 pi) (1 + cos^2); Henyey and Greenstein's mean cosine is g. */
static void known_values(void **state)
{
    (void)state;
    Phase rayleigh = phase_draine(0, 1), hg = phase_hg(.85);
    for (double c = -1; c <= 1; c += 0.25)
        assert_near((double)phase_evaluate(&rayleigh, (float)c), 3 / (16 * pi) * (1 + c * c), 1e-7);
    assert_near(mean_cosine(&hg), .85, 1e-12);
    assert_near((double)phase_evaluate(&hg, 1), (1 - .85 * .85) / (4 * pi * pow(.15, 3)), 1e-4);
}

/* Chi-square over bins of equal probability in the cosine and of equal width in the angle around. */
static void samples_follow_the_density(void **state)
{
    (void)state;
    enum { SAMPLES = 200000, COSINES = 20, ANGLES = 8 };
    const Vec3f along = vec3f_normalize(vec3f(0.3f, -0.8f, 0.5f));
    for (size_t i = 0; i < COUNT_OF(cases) + 1; i++) {
        Phase phase = i < COUNT_OF(cases) ? phase_of(i) : phase_droplets(20);
        const char *name = i < COUNT_OF(cases) ? cases[i].name : "droplets";
        double edges[COSINES + 1] = {-1}, counts[COSINES][ANGLES] = {{0}}, sum = 0;
        int edge = 1;
        for (int k = 0; k < 2000000 && edge < COSINES; k++) { /* quantiles by quadrature, from behind */
            double x = 1 - (k + 0.5) / 2000000, c = 1 - 2 * x * x * x;
            sum += 2 * pi * 6 * x * x / 2000000 * (double)phase_evaluate(&phase, (float)c);
            if (sum >= (double)edge / COSINES) edges[edge++] = c;
        }
        edges[COSINES] = 1.001;
        for (uint32_t k = 0; k < SAMPLES; k++) {
            float u[2] = {hash_to_unit_f(hash_u32(2 * k)), hash_to_unit_f(hash_u32(2 * k + 1))}, pdf;
            Vec3f d = phase_sample(&phase, along, u, &pdf);
            float cosine = vec3f_dot(d, along);
            assert_near((double)vec3f_dot(d, d), 1, 1e-5);
            assert_near((double)pdf, (double)phase_evaluate(&phase, cosine), 0.05 * (double)pdf + 1e-4);
            int bin = 0;
            while (bin + 1 < COSINES && (double)cosine >= edges[bin + 1]) bin++;
            counts[bin][(int)(u[1] * ANGLES) % ANGLES]++;
        }
        double chi = 0, expected = (double)SAMPLES / (COSINES * ANGLES);
        for (int a = 0; a < COSINES; a++)
            for (int b = 0; b < ANGLES; b++) chi += pow(counts[a][b] - expected, 2) / expected;
        int freedom = COSINES * ANGLES - 1;
        double deviations = (chi - freedom) / sqrt(2.0 * freedom);
        printf("    %-22s chi-square %.1f over %d, %.2f standard deviations\n", name, chi, freedom, deviations);
        assert_true(deviations < 4);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integrals_are_one),
        cmocka_unit_test(known_values),
        cmocka_unit_test(samples_follow_the_density),
    };
    return cmocka_run_group_tests_name("phase", tests, NULL, NULL);
}
