/* num_test.c - reading and printing of doubles: known hard cases, and random ones against the C library in the "C"
 * locale.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/attr.h"
#include "base/hash.h"
#include "base/num.h"

static void test_reads(void **state)
{
    static const struct {
        const char *text;
        size_t length;
        double value;
    } cases[] = {
        {"0", 1, 0},
        {"12", 2, 12},
        {"1.5x", 3, 1.5},
        {".5", 2, .5},
        {"5.", 2, 5},
        {"1..5", 1, 1},
        {"1e3", 3, 1000},
        {"1e", 1, 1},
        {"1e+", 1, 1},
        {"1E-2m", 4, .01},
        {"-3", 2, -3},
        {"+3", 2, 3},
        {"x", 0, -1},
        {".", 0, -1},
        {"-", 0, -1},
        {"1.2.3", 3, 1.2},
        {"007", 3, 7},
        {"", 0, -1},
        {"..5", 0, -1},
        {"1e400", 5, (double)INFINITY},
        {"1e-400", 6, 0},
        {"2.2250738585072011e-308", 23, 2.2250738585072011e-308},
        {"9007199254740993", 16, 9007199254740992.0},
        {"9007199254740993.00000000000000000000000000000000000000001", 58, 9007199254740994.0},
        {"1.7976931348623157e308", 22, 1.7976931348623157e308},
        {"4.9406564584124654e-324", 23, 4.9406564584124654e-324},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double value = -1;
        assert_int_equal(num_parse(cases[i].text, strlen(cases[i].text), &value), cases[i].length);
        assert_true(value == cases[i].value);
    }
    double value = 0;
    assert_int_equal(num_parse("12345", 3, &value), 3); /* not beyond the length */
    assert_true(value == 123);
}

static void test_prints_rounded(void **state)
{
    (void)state;
    static const struct {
        double value;
        const char *text;
    } cases[] = {{92 * .1, "9.2"},
                 {.1 + .2, "0.3"},
                 {.1 + .7, "0.8"},
                 {-1.1 * 1.1, "-1.21"},
                 {3.141592653589793, "3.141592653589793"},
                 {1 / 3., "0.3333333333333333"},
                 {5e-324, "5e-324"},
                 {1e15 + .3, "1000000000000000"},
                 {1.0000000000000002, "1"},
                 {9007199254740993., "9007199254740992"},
                 {.1, "0.1"},
                 {12, "12"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[NUM_TEXT_SIZE];
        assert_int_equal(num_print_rounded(cases[i].value, text), strlen(cases[i].text));
        assert_string_equal(text, cases[i].text);
    }
}

static void test_prints(void **state)
{
    static const struct {
        double value;
        const char *text;
    } cases[] = {
        {0, "0"},
        {-0.0, "-0"},
        {1, "1"},
        {-3, "-3"},
        {0.1, "0.1"},
        {100, "100"},
        {1e20, "1e20"},
        {123456.75, "123456.75"},
        {1e-7, "1e-7"},
        {0.00001, "0.00001"},
        {1.0 / 3, "0.3333333333333333"},
        {5e-324, "5e-324"},
        {1.7976931348623157e308, "1.7976931348623157e308"},
        {9007199254740992.0, "9007199254740992"},
        {(double)INFINITY, "inf"},
        {-(double)INFINITY, "-inf"},
        {(double)NAN, "nan"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[NUM_TEXT_SIZE];
        assert_int_equal(num_print(cases[i].value, text), strlen(cases[i].text));
        assert_string_equal(text, cases[i].text);
    }
}

static double random_double(uint64_t i)
{
    uint64_t bits = hash_u64(i);
    double value;
    if (i % 3 == 0) return (double)(int64_t)(bits % 2000000001) / (i % 2 ? 1e6 : 1e4);
    memcpy(&value, &bits, sizeof value);
    return isfinite(value) ? value : 1;
}

static void test_random(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 20000; i++) {
        double value = random_double(i), again = 0, reference;
        char text[NUM_TEXT_SIZE], written[64];
        size_t n = num_print(value, text);
        assert_int_equal(num_parse(text, n, &again), n);
        assert_memory_equal(&again, &value, sizeof value);
        snprintf(written, sizeof written, "%.*e", (int)(i % 24), value);
        reference = strtod(written, NULL);
        assert_int_equal(num_parse(written, strlen(written), &again), strlen(written));
        assert_memory_equal(&again, &reference, sizeof reference);
    }
}

/* no shorter text reads back as the same double */
static void test_shortest(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 2000; i++) {
        double value = fabs(random_double(3 * i + 1)), again;
        char text[NUM_TEXT_SIZE], written[64];
        size_t digits = 0;
        num_print(value, text);
        for (const char *c = text; *c && *c != 'e'; c++) digits += *c >= '0' && *c <= '9';
        for (int precision = 1; precision < (int)digits; precision++) {
            snprintf(written, sizeof written, "%.*e", precision - 1, value);
            num_parse(written, strlen(written), &again);
            if (again == value) { /* only zeros in front of or behind the digits may be left out */
                assert_true(text[0] == '0' || text[strlen(text) - 1] == '0');
                break;
            }
        }
    }
}

static void test_floats(void **state)
{
    static const struct {
        float value;
        const char *text;
    } cases[] = {{1.34f, "1.34"},
                 {0.1f, "0.1"},
                 {-2.5f, "-2.5"},
                 {123456789.f, "123456790"},
                 {16777216.f, "16777216"},
                 {1e-7f, "1e-7"},
                 {1e-45f, "1e-45"},
                 {1e30f, "1e30"},
                 {1e15f, "1000000000000000"},
                 {3.4028235e38f, "3.4028235e38"},
                 {1.1754944e-38f, "1.1754944e-38"},
                 {0.3333333433f, "0.33333334"},
                 {0, "0"},
                 {(float)INFINITY, "inf"}};
    (void)state;
    char text[NUM_TEXT_SIZE];
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        assert_int_equal(num_print_float(cases[i].value, text), strlen(cases[i].text));
        assert_string_equal(text, cases[i].text);
    }
    for (uint32_t i = 0; i < 20000; i++) {
        uint32_t bits = i * 2654435761U;
        float value;
        memcpy(&value, &bits, sizeof value);
        if (!isfinite(value)) continue;
        size_t n = num_print_float(value, text);
        assert_true(n <= 19); /* -0.0000, and 9 digits more; or 17 and a sign */
        assert_true(strtof(text, NULL) == value);
    }
}

static void limits_in_few_digits_are_not_more_than_they_are(void **state)
{
    (void)state;
    const double numbers[] = {0.0469, 0.047, 3.999, 1e-7, 0.29, 12345678.9, 0.3, 7};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        for (int digits = 1; digits < 12; digits++) {
            char text[40];
            double said, down = num_round_down(numbers[i], digits), unit = 2 * numbers[i] * pow(10, 1 - digits);
            snprintf(text, sizeof text, "%.*g", digits, down);
            assert_true(num_parse(text, strlen(text), &said) > 0);
            assert_true(said <= numbers[i] * (1 + 1e-15) && said > numbers[i] - unit);
        }
    assert_true(num_round_down(0.0469, 2) == 0.046);
    assert_true(num_round_down(0, 2) == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(limits_in_few_digits_are_not_more_than_they_are),
        cmocka_unit_test(test_reads),
        cmocka_unit_test(test_prints),
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_shortest),
        cmocka_unit_test(test_prints_rounded),
        cmocka_unit_test(test_floats),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
