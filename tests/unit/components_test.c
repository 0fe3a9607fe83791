/* components_test.c - spectra as mixtures of a few of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "optics/components.h"

enum { BANDS = ENVIRONMENT_BANDS, SPECTRA = 500 };

static float chance(uint32_t a, uint32_t b)
{
    return hash_to_unit_f(hash_combine(a, b));
}

/* Mixtures of `kinds` spectra, some of them black. */
static void make_spectra(uint32_t kinds, float spectra[SPECTRA * BANDS], float luminance[SPECTRA])
{
    for (uint32_t i = 0; i < SPECTRA; i++) {
        luminance[i] = i % 7 ? 1 + 50 * chance(i, 1) : 0;
        for (uint32_t k = 0; k < BANDS; k++) {
            double sum = 0;
            for (uint32_t kind = 0; kind < kinds; kind++)
                sum += (double)(chance(i, 100 + kind) * chance(1000 + kind, k));
            spectra[i * BANDS + k] = (float)sum * luminance[i];
        }
    }
}

/* The largest difference, over the luminance. */
static double worst(uint32_t kinds)
{
    static float spectra[SPECTRA * BANDS], luminance[SPECTRA], mixtures[SPECTRA * COMPONENTS];
    Components components;
    double largest = 0;
    make_spectra(kinds, spectra, luminance);
    components_find(spectra, luminance, SPECTRA, &components);
    for (int i = 0; i < COMPONENTS; i++)
        for (int j = 0; j <= i; j++) {
            double product = 0;
            for (int k = 0; k < BANDS; k++) product += components.of[i][k] * components.of[j][k];
            assert_true(fabs(product - (i == j)) < 1e-12);
        }
    components_split(&components, spectra, luminance, SPECTRA, mixtures);
    for (size_t i = 0; i < SPECTRA; i++)
        for (size_t k = 0; k < BANDS; k++) {
            double sum = 0;
            for (size_t c = 0; c < COMPONENTS; c++) sum += components.of[c][k] * (double)mixtures[i * COMPONENTS + c];
            double right = luminance[i] > 0 ? (double)(spectra[i * BANDS + k] / luminance[i]) : 0;
            largest = fmax(largest, fabs(sum - right));
        }
    return largest;
}

static void test_few_kinds_are_exact(void **state)
{
    (void)state;
    for (uint32_t kinds = 1; kinds <= COMPONENTS; kinds++) assert_true(worst(kinds) < 2e-6);
}

static void test_of_many_kinds_most_is_kept(void **state)
{
    (void)state;
    double more = worst(COMPONENTS + 1), all = worst(BANDS); /* of about 4, with a spread of about 0.5 */
    assert_true(more > 1e-4 && more < 0.5);
    assert_true(all > 1e-3 && all < 1.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_few_kinds_are_exact),
        cmocka_unit_test(test_of_many_kinds_most_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
