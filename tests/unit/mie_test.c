/* mie_test.c - spheres: published values of Mie's theory, its limits, bows where geometry has them, and the hand-over to rays.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "optics/large_sphere.h"
#include "optics/mie.h"
#include "optics/spheres.h"

static const double pi = 3.14159265358979323846;

typedef struct Sphere {
    double x;
    MieNumber m, *a, *b;
} Sphere;

static Sphere sphere_new(double x, double n, double k)
{
    Sphere sphere = {.x = x, .m = {n, k}};
    size_t terms = mie_terms(x);
    MieNumber *scratch = test_malloc(mie_scratch(x, sphere.m) * sizeof *scratch);
    sphere.a = test_malloc(terms * sizeof *sphere.a);
    sphere.b = test_malloc(terms * sizeof *sphere.b);
    mie_coefficients(x, sphere.m, scratch, sphere.a, sphere.b);
    test_free(scratch);
    return sphere;
}

static void sphere_clear(Sphere *sphere)
{
    test_free(sphere->a);
    test_free(sphere->b);
}

/* (|S1|^2 + |S2|^2) / 2 / x^2 */
static double intensity(const Sphere *sphere, double angle)
{
    MieNumber s1, s2;
    mie_amplitudes(sphere->x, sphere->a, sphere->b, cos(angle), &s1, &s2);
    return 0.5 * (s1.re * s1.re + s1.im * s1.im + s2.re * s2.re + s2.im * s2.im) / (sphere->x * sphere->x);
}

/* Q of 1.5 and 10: Wiscombe's report NCAR/TN-140+STR (1979); 1.55: Bohren and Huffman's program, appendix A. */
static void published_values(void **state)
{
    (void)state;
    static const struct {
        double x, n, k, extinction, scattering, mean_cosine, tolerance;
    } cases[] = {
        {10, 1.5, 0, 2.881999, 2.881999, 0.742913, 1e-6},
        {100, 1.5, 0, 2.094388, 2.094388, 0.818246, 1e-6},
        {1000, 1.5, 0, 2.013945, 2.013945, 0.827882, 1e-6},
        {5.2128204, 1.55, 0, 3.10543, 3.10543, 0.63314, 1e-5},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Sphere sphere = sphere_new(cases[i].x, cases[i].n, cases[i].k);
        MieEfficiencies q = mie_efficiencies(sphere.x, sphere.a, sphere.b);
        printf("    x %g, m %g: %.6f, %.6f, %.6f\n", cases[i].x, cases[i].n, q.extinction, q.scattering, q.mean_cosine);
        assert_near(q.extinction, cases[i].extinction, cases[i].tolerance);
        assert_near(q.scattering, cases[i].scattering, cases[i].tolerance);
        assert_near(q.mean_cosine, cases[i].mean_cosine, cases[i].tolerance);
        sphere_clear(&sphere);
    }
}

/* What is scattered into all directions is the scattering cross-section, and its mean cosine g; nothing else is taken out of the
 * light where nothing is absorbed; and what is taken out is what misses straight on (the optical theorem). */
static void energy(void **state)
{
    (void)state;
    static const double sizes[] = {.1, 1, 7, 40, 200};
    static const double indices[][2] = {{1.33, 0}, {.75, 0}, {1.6, .01}, {1.5, 1}};
    for (size_t i = 0; i < COUNT_OF(sizes) * COUNT_OF(indices); i++) {
        const double *m = indices[i % COUNT_OF(indices)];
        Sphere sphere = sphere_new(sizes[i / COUNT_OF(indices)], m[0], m[1]);
        MieEfficiencies q = mie_efficiencies(sphere.x, sphere.a, sphere.b);
        double sum = 0, forward = 0;
        enum { STEPS = 20000 };
        for (int k = 0; k < STEPS; k++) {
            double angle = (k + 0.5) * pi / STEPS, part = 2 * sin(angle) * pi / STEPS * intensity(&sphere, angle);
            sum += part;
            forward += part * cos(angle);
        }
        assert_near(sum / q.scattering, 1, 1e-4);
        assert_near(forward / q.scattering, q.mean_cosine, 1e-4);
        if (m[1] == 0) assert_near(q.extinction / q.scattering, 1, 1e-10);
        if (m[1] > 0) assert_true(q.extinction > q.scattering);
        MieNumber s1, s2;
        mie_amplitudes(sphere.x, sphere.a, sphere.b, 1, &s1, &s2);
        assert_near(4 / (sphere.x * sphere.x) * s1.re / q.extinction, 1, 1e-9);
        sphere_clear(&sphere);
    }
}

/* Spheres that are small against the wavelength scatter after Rayleigh: Q = 8/3 x^4 ((m^2 - 1) / (m^2 + 2))^2. */
static void small_spheres(void **state)
{
    (void)state;
    Sphere sphere = sphere_new(0.01, 1.5, 0);
    MieEfficiencies q = mie_efficiencies(sphere.x, sphere.a, sphere.b);
    assert_near(q.scattering / (8 / 3.0 * 1e-8 * pow(1.25 / 4.25, 2)), 1, 1e-4);
    for (double angle = 0; angle < pi; angle += 0.2)
        assert_near(intensity(&sphere, angle) / intensity(&sphere, 0), 0.5 * (1 + pow(cos(angle), 2)), 2e-4);
    sphere_clear(&sphere);
}

/* The sums in float of many angles are those in double. */
static void sums_in_float(void **state)
{
    (void)state;
    static const double angles[MIE_ANGLES] = {0, .001, .3, 1, 2, 2.42, 3.1, 3.14159265};
    double cosines[MIE_ANGLES], worst = 0;
    for (int i = 0; i < MIE_ANGLES; i++) cosines[i] = cos(angles[i]);
    for (double x = 0.5; x < 500; x *= 1.7) {
        Sphere sphere = sphere_new(x, 1.335, 0);
        size_t n = mie_terms(x);
        MieTerm *terms = test_malloc(n * sizeof *terms);
        MieAngles *rows = aligned_alloc(_Alignof(MieAngles), n * sizeof *rows);
        Lanes sum[2];
        assert_non_null(rows);
        mie_make_terms(sphere.a, sphere.b, n, terms);
        mie_angles(cosines, n, rows);
        mie_intensities(terms, n, rows, sum);
        for (int i = 0; i < MIE_ANGLES; i++) {
            double expected = intensity(&sphere, angles[i]) * x * x, got = (double)lanes_get(sum[i / LANES], i % LANES);
            double of = fmax(expected, 0.01 * x * x); /* where waves cancel out, of the rest */
            worst = fmax(worst, fabs(got - expected) / of);
        }
        free(rows);
        test_free(terms);
        sphere_clear(&sphere);
    }
    printf("    worst error in float %.2g\n", worst);
    assert_true(worst < 1e-3);
}

/* ---- large spheres ---- */

static double large_at(const LargeAiry *airy, double index, double x, double spread, double angle)
{
    LargeRays rays;
    large_rays(index, angle, &rays);
    return (double)large_intensity(airy, &rays, x, spread, angle, 1);
}

/* Both halves of what a large sphere scatters come to 2. */
static void large_energy(void **state)
{
    (void)state;
    static LargeAiry airy;
    static const double indices[] = {1.333, .75, 1.5, 2.4};
    large_airy(&airy);
    for (size_t i = 0; i < COUNT_OF(indices); i++) {
        double sum = 0, x = 3000;
        enum { STEPS = 100000 };
        for (int k = 0; k < STEPS; k++) {
            double root = (k + 0.5) / STEPS, s = root * root, angle = 2 * asin(root * root > 1 ? 1 : sqrt(s));
            sum += 8 * root / STEPS * large_at(&airy, indices[i], x, .05, angle);
        }
        printf("    index %g: Q %.4f\n", indices[i], sum);
        assert_near(sum, 2, .02);
    }
}

/* Mie's theory and rays with waves, of the same sizes about the border. */
static void hand_over(void **state)
{
    (void)state;
    static LargeAiry airy;
    static const double water[] = {1, 5, 20, 40, 60, 90, 125, 138, 139, 140, 142, 150}; /* degrees */
    static const double air[] = {1, 5, 20, 40, 60, 90, 120, 150};
    large_airy(&airy);
    for (int bubbles = 0; bubbles < 2; bubbles++) {
        const double *degrees = bubbles ? air : water, index = bubbles ? .75 : 1.335, width = .12;
        size_t n = bubbles ? COUNT_OF(air) : COUNT_OF(water);
        double mie[16] = {0}, large[16] = {0}, worst = 0;
        enum { SIZES = 400 };
        for (int k = 0; k < SIZES; k++) {
            double t = 1 + width * (-3.5 + 7 * (k + 0.5) / SIZES), weight = exp(-0.5 * pow((t - 1) / width, 2));
            Sphere sphere = sphere_new(SPHERES_BORDER * t, index, 0);
            for (size_t i = 0; i < n; i++) {
                double angle = degrees[i] * pi / 180;
                mie[i] += weight * intensity(&sphere, angle);
                large[i] += weight * large_at(&airy, index, sphere.x, 7 * width / SIZES / t, angle);
            }
            sphere_clear(&sphere);
        }
        for (size_t i = 0; i < n; i++) {
            printf("    index %g, %g degrees: Mie %.4g, rays %.4g, %+.1f %%\n", index, degrees[i], mie[i], large[i],
                   100 * (large[i] / mie[i] - 1));
            worst = fmax(worst, fabs(large[i] / mie[i] - 1));
        }
        assert_true(worst < (bubbles ? .3 : .12));
    }
}

/* ---- bows ---- */

/* Degrees from the point opposite to the sun at which a table is brightest. */
static double brightest(const PhaseTable *table, float nm, double from, double to)
{
    double best = 0, at = 0;
    for (double angle = from; angle <= to; angle += 0.01) {
        double sine = sin(0.5 * (180 - angle) * pi / 180);
        double value = (double)lanes_get(phase_table_at(table, (float)(sine * sine), lanes_all(nm)), 0);
        if (value > best) at = angle;
        best = fmax(best, value);
    }
    return at;
}

/* Rays that turn least: [Hulst57] 13.1, degrees from the point opposite to the sun. */
static double bow(double index, int p)
{
    double incidence = acos(sqrt((index * index - 1) / (p * p - 1))), within = asin(sin(incidence) / index);
    double turned = (p - 1) * pi + 2 * incidence - 2 * p * within;
    return fabs(p == 2 ? pi - turned : turned - pi) * 180 / pi;
}

static void bows(void **state)
{
    (void)state;
    static const float wavelengths[] = {400, 550, 700};
    Arena arena;
    arena_init(&arena);
    Spheres spheres = {.diameter_um = 2000, .width = .3};
    for (uint32_t k = 0; k < PHASE_TABLE_WAVES; k++) {
        spheres.index[k] = spheres_water_index(phase_table_nm(k));
        spheres.around[k] = 1;
    }
    const PhaseTable *table = spheres_table(&arena, &spheres, NULL);
    assert_non_null(table);
    for (size_t i = 0; i < COUNT_OF(wavelengths); i++) {
        double index = spheres_water_index((double)wavelengths[i]);
        double first = brightest(table, wavelengths[i], 38, 46), second = brightest(table, wavelengths[i], 48.5, 58);
        printf("    %g nm: %.2f and %.2f degrees, of rays %.2f and %.2f\n", (double)wavelengths[i], first, second,
               bow(index, 2), bow(index, 3));
        /* waves put a bow on the lit side of where rays have it: the first by some .2, the second by .35 degrees */
        assert_near(first, bow(index, 2), .25);
        assert_near(second, bow(index, 3), .45);
    }
    double red = bow(spheres_water_index(700), 2), violet = bow(spheres_water_index(400), 2);
    assert_true(red > 42 && red < 42.6 && violet > 40.2 && violet < 40.9);
    /* Alexander's dark band */
    double sine = sin(0.5 * (180 - 46.5) * pi / 180), inside = sin(0.5 * (180 - 38) * pi / 180);
    Lanes nm = lanes_all(550);
    float dark = lanes_get(phase_table_at(table, (float)(sine * sine), nm), 0);
    float lit = lanes_get(phase_table_at(table, (float)(inside * inside), nm), 0);
    printf("    between the bows %.4f, within the first %.4f\n", (double)dark, (double)lit);
    assert_true(dark < .2f * lit);
    arena_clear(&arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(published_values),
        cmocka_unit_test(energy),
        cmocka_unit_test(small_spheres),
        cmocka_unit_test(sums_in_float),
        cmocka_unit_test(large_energy),
        cmocka_unit_test(hand_over),
        cmocka_unit_test(bows),
    };
    return cmocka_run_group_tests_name("mie", tests, NULL, NULL);
}
