/* phase_test.c - phase functions: integrals by quadrature, mean cosines, sampled directions against the density; lobes, and tables
 * of spheres.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "optics/phase.h"
#include "optics/spheres.h"

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
    return (Phase){cases[i].weight, {{cases[i].g1, cases[i].a1}, {cases[i].g2, cases[i].a2}}, NULL};
}

/* Of the phase function times the cosine to the power k, over the sphere; graded towards the peak. */
static double moment(const Phase *phase, int k)
{
    enum { STEPS = 400000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double x = (i + 0.5) / STEPS, cosine = 1 - 2 * x * x * x, width = 6 * x * x / STEPS;
        sum += 2 * pi * width * (double)phase_evaluate_lobes(phase, (float)cosine) * pow(cosine, k);
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
}

/* Rayleigh's is 3 / (16 pi) (1 + cos^2); Henyey and Greenstein's mean cosine is g. */
static void known_values(void **state)
{
    (void)state;
    Phase rayleigh = phase_draine(0, 1), hg = phase_hg(.85);
    for (double c = -1; c <= 1; c += 0.25)
        assert_near((double)phase_evaluate_lobes(&rayleigh, (float)c), 3 / (16 * pi) * (1 + c * c), 1e-7);
    assert_near(mean_cosine(&hg), .85, 1e-12);
    assert_near((double)phase_evaluate_lobes(&hg, 1), (1 - .85 * .85) / (4 * pi * pow(.15, 3)), 1e-4);
}

/* ---- tables ---- */

static Spheres droplets(double diameter_um, double width)
{
    Spheres spheres = {.diameter_um = diameter_um, .width = width};
    for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
        spheres.index[k] = spheres_water_index(phase_table_nm(k));
        spheres.around[k] = 1;
    }
    return spheres;
}

/* Between any two waves, over s, by the nodes and their middles: exact for what is linear in between. */
static double table_moment(const PhaseTable *table, double nm, int k)
{
    double sum = 0;
    for (uint32_t i = 0; i + 1 < table->n_nodes; i++) {
        double from = (double)table->nodes[i], to = (double)table->nodes[i + 1], s[] = {from, 0.5 * (from + to), to};
        static const double weights[] = {1 / 6.0, 4 / 6.0, 1 / 6.0};
        for (int j = 0; j < 3; j++) {
            double value = (double)lanes_get(phase_table_at(table, (float)s[j], lanes_all((float)nm)), 0);
            sum += 4 * pi * (to - from) * weights[j] * value * pow(1 - 2 * s[j], k);
        }
    }
    return sum;
}

static void tables_are_densities(void **state)
{
    (void)state;
    static const double diameters[] = {.1, 1, 10, 50, 300, 5000};
    Arena arena;
    arena_init(&arena);
    for (size_t i = 0; i < COUNT_OF(diameters); i++) {
        const Spheres spheres = droplets(diameters[i], .2);
        const PhaseTable *table = spheres_table(&arena, &spheres, NULL);
        assert_non_null(table);
        for (uint32_t k = 1; k < table->n_nodes; k++) assert_true(table->nodes[k] > table->nodes[k - 1]);
        double least = 2, most = 0;
        for (double nm = 360; nm <= 830; nm += 29) {
            double whole = table_moment(table, nm, 0);
            least = fmin(least, whole);
            most = fmax(most, whole);
        }
        printf("    droplets of %g um: %u nodes, integrals %.6f to %.6f, mean cosine %.4f\n", diameters[i],
               table->n_nodes, least, most, table_moment(table, 550, 1));
        assert_near(least, 1, 1e-5);
        assert_near(most, 1, 1e-5);
    }
    arena_clear(&arena);
}

/* ---- sampling ---- */

enum { COSINES = 20, ANGLES = 8 };

/* s that the shares 1 / COSINES, 2 / COSINES ... lie below, by quadrature at one wavelength. */
static void find_quantiles(const Phase *phase, Lanes nm, double edges[COSINES + 1])
{
    enum { STEPS = 2000000 };
    double sum = 0;
    int edge = 1;
    for (int k = 0; k < STEPS && edge < COSINES; k++) {
        double x = (k + 0.5) / STEPS, s = pow(x, 6), width = 6 * pow(x, 5) / STEPS;
        float value = phase->table ? lanes_get(phase_table_at(phase->table, (float)s, nm), 0)
                                   : phase_evaluate_lobes(phase, (float)(1 - 2 * s));
        sum += 4 * pi * width * (double)value;
        if (sum >= (double)edge / COSINES) edges[edge++] = s;
    }
    edges[0] = 0;
    edges[COSINES] = 1.001;
}

/* Chi-square over bins of equal probability in the angle of turning and of equal width in the angle around. */
static void compare(const char *name, const Phase *phase, float nm)
{
    enum { SAMPLES = 200000 };
    const Vec3f along = vec3f_normalize(vec3f(0.3f, -0.8f, 0.5f));
    const Lanes wavelengths = lanes(nm, 500, 600, 700);
    double edges[COSINES + 1], counts[COSINES][ANGLES] = {{0}};
    find_quantiles(phase, wavelengths, edges);
    for (uint32_t k = 0; k < SAMPLES; k++) {
        float u[2] = {hash_to_unit_f(hash_u32(2 * k)), hash_to_unit_f(hash_u32(2 * k + 1))};
        Lanes pdf;
        Vec3f d = phase_sample(phase, along, u, wavelengths, &pdf);
        Lanes again = phase_evaluate(phase, along, d, wavelengths);
        assert_near((double)vec3f_dot(d, d), 1, 1e-5);
        for (int lane = 0; lane < LANES; lane++)
            assert_near((double)lanes_get(pdf, lane), (double)lanes_get(again, lane),
                        0.05 * (double)lanes_get(pdf, lane) + 1e-4);
        Vec3f off = vec3f_sub(d, along);
        double s = 0.25 * (double)vec3f_dot(off, off);
        int bin = 0;
        while (bin + 1 < COSINES && s >= edges[bin + 1]) bin++;
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

static void samples_follow_the_density(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Phase phase = phase_of(i);
        compare(cases[i].name, &phase, 550);
    }
    static const struct {
        const char *name;
        double diameter_um, width;
        float nm;
    } tables[] = {{"haze, .3 um", .3, .4, 400}, {"fog, 20 um", 20, .2, 450}, {"drizzle, 300 um", 300, .3, 611}};
    Arena arena;
    arena_init(&arena);
    for (size_t i = 0; i < COUNT_OF(tables); i++) {
        const Spheres spheres = droplets(tables[i].diameter_um, tables[i].width);
        Phase phase = phase_of_table(spheres_table(&arena, &spheres, NULL));
        assert_non_null(phase.table);
        assert_false(phase_is_grey(&phase));
        compare(tables[i].name, &phase, tables[i].nm);
    }
    arena_clear(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integrals_are_one),
        cmocka_unit_test(known_values),
        cmocka_unit_test(tables_are_densities),
        cmocka_unit_test(samples_follow_the_density),
    };
    return cmocka_run_group_tests_name("phase", tests, NULL, NULL);
}
