/* metal_test.c - conductors: Fresnel's equations, and what measured metals reflect head on.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "lang/schema_find.h"
#include "optics/fresnel.h"
#include "optics/metal.h"
#include "scene/build.h"

static double reference(double cosine, double complex n)
{
    double complex inside = csqrt(1 - (1 - cosine * cosine) / (n * n));
    double s = cabs((cosine - n * inside) / (cosine + n * inside)),
           p = cabs((n * cosine - inside) / (n * cosine + inside));
    return 0.5 * (s * s + p * p);
}

static void conductors_are_exact(void **unused)
{
    (void)unused;
    double worst = 0, worst_mean = 0;
    for (uint32_t i = 0; i < 200000; i++) {
        float cosine = hash_to_unit_f(hash_u32(3 * i)), n = 0.03f + 4 * hash_to_unit_f(hash_u32(3 * i + 1));
        float k = 9 * hash_to_unit_f(hash_u32(3 * i + 2));
        double found = (double)lanes_get(fresnel_conductor(cosine, lanes_all(n), lanes_all(k)), 2);
        double off = fabs(found - reference((double)cosine, CMPLX((double)n, (double)k)));
        /* nearly transparent, about the critical angle, a root of a small difference is taken */
        assert_true(off < 1e-4);
        if (k < 1) continue;
        worst = fmax(worst, off);
        if (i % 1000) continue;
        double sum = 0;
        enum { STEPS = 2000 };
        for (int j = 0; j < STEPS; j++) {
            double c = (j + 0.5) / STEPS;
            sum += 2 * c * reference(c, CMPLX((double)n, (double)k)) / STEPS;
        }
        worst_mean =
            fmax(worst_mean, fabs(sum - (double)lanes_get(fresnel_conductor_mean(lanes_all(n), lanes_all(k)), 0)));
    }
    printf("largest error %.2g, of the mean %.2g\n", worst, worst_mean);
    assert_true(worst < 5e-6);
    assert_true(worst_mean < 0.003);
    /* without absorption it is a dielectric */
    for (int i = 0; i <= 100; i++) {
        float cosine = (float)i / 100;
        assert_float_equal(lanes_get(fresnel_conductor(cosine, lanes_all(1.5f), lanes_all(0)), 0),
                           fresnel_dielectric(cosine, 1, 1.5f), 1e-5f);
    }
}

static float head_on(const char *name, float wavelength_nm)
{
    Spectrum n, k;
    float n_table[SPECTRUM_SAMPLES], k_table[SPECTRUM_SAMPLES];
    assert_true(metal_index(name, &n, &k, n_table, k_table));
    Lanes at = lanes_all(wavelength_nm);
    return lanes_get(fresnel_conductor(1, spectrum_at(&n, at), spectrum_at(&k, at)), 0);
}

/* What is generally given for polished metals, within the few per cent by which sources differ. */
static void metals_reflect_as_published(void **unused)
{
    (void)unused;
    const struct {
        const char *name;
        float wavelength_nm, reflectance, tolerance;
    } known[] = {
        {"gold", 450, 0.39f, 0.02f},      {"gold", 550, 0.81f, 0.03f},       {"gold", 650, 0.96f, 0.02f},
        {"silver", 450, 0.975f, 0.02f},   {"silver", 650, 0.985f, 0.015f},   {"copper", 450, 0.54f, 0.02f},
        {"copper", 650, 0.94f, 0.03f},    {"aluminium", 550, 0.916f, 0.01f}, {"chromium", 550, 0.56f, 0.03f},
        {"iron", 550, 0.52f, 0.05f},      {"nickel", 550, 0.62f, 0.03f},     {"titanium", 550, 0.60f, 0.04f},
        {"brass", 450, 0.43f, 0.06f},     {"brass", 600, 0.86f, 0.03f},      {"stainless_steel", 550, 0.58f, 0.04f},
        {"platinum", 450, 0.59f, 0.03f},  {"platinum", 550, 0.64f, 0.03f},   {"platinum", 650, 0.68f, 0.03f},
        {"palladium", 550, 0.69f, 0.03f}, {"rhodium", 550, 0.78f, 0.02f},    {"bronze", 450, 0.48f, 0.04f},
        {"bronze", 650, 0.91f, 0.03f},    {"green_gold", 450, 0.56f, 0.1f},  {"green_gold", 650, 0.93f, 0.03f},
    };
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        float found = head_on(known[i].name, known[i].wavelength_nm);
        printf("%-16s %g nm: %.3f\n", known[i].name, (double)known[i].wavelength_nm, (double)found);
        assert_float_equal(found, known[i].reflectance, known[i].tolerance);
    }
}

static void names_are_known(void **unused)
{
    (void)unused;
    Spectrum n, k;
    float n_table[SPECTRUM_SAMPLES], k_table[SPECTRUM_SAMPLES];
    assert_false(metal_index("unobtainium", &n, &k, n_table, k_table));
    const char *words = schema_prop(schema_node(scene_schema(), "surface"), "metal")->choices;
    char name[40], before[40] = "";
    for (size_t length; (length = strcspn(words, "|")) > 0; words += length + (words[length] == '|')) {
        snprintf(name, sizeof name, "%.*s", (int)length, words);
        assert_true(metal_index(name, &n, &k, n_table, k_table));
        assert_true(strcmp(before, name) < 0);
        strcpy(before, name);
        for (int j = 0; j < SPECTRUM_SAMPLES; j++) assert_true(n_table[j] > 0 && k_table[j] > 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(conductors_are_exact),
        cmocka_unit_test(metals_reflect_as_published),
        cmocka_unit_test(names_are_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
