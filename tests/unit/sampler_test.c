/* sampler_test.c - the random numbers of a path: strata, convergence, and how the errors of neighbouring pixels cancel.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/clock.h"
#include "near.h"
#include "trace/sampler.h"

#define assert_in(value, low, high) assert_near(value, ((low) + (high)) / 2.0, ((high) - (low)) / 2.0)

enum { WIDTH = 128, BORDER = 8 };

typedef Sampler (*Maker)(uint32_t seed, uint32_t x, uint32_t y, uint32_t index);

/* ---- strata ---- */

/* All elementary intervals of the first 2^m points of every pixel hold one point each: a (0, m, 2)-net. */
static void pixels_have_nets(void **state)
{
    (void)state;
    for (uint32_t m = 1; m <= 9; m++)
        for (uint32_t pixel = 0; pixel < 40; pixel++)
            for (uint32_t a = 0; a <= m; a++) {
                uint8_t met[512] = {0};
                for (uint32_t i = 0; i < 1U << m; i++) {
                    Sampler sampler = sampler_make(7, 3 * pixel, pixel * pixel, i);
                    float u[2];
                    sampler_2d(&sampler, 5 + pixel, u);
                    assert_true(u[0] >= 0 && u[0] < 1 && u[1] >= 0 && u[1] < 1);
                    uint32_t cell =
                        (uint32_t)ldexp((double)u[0], (int)a) << (m - a) | (uint32_t)ldexp((double)u[1], (int)(m - a));
                    assert_int_equal(met[cell]++, 0);
                }
            }
}

static uint32_t stratum(double u, uint32_t digits)
{
    return (uint32_t)ldexp(u, (int)digits);
}

static double third_of(const Sampler *sampler, uint32_t dimension)
{
    SamplerStream stream = sampler_stream(sampler, dimension);
    return ldexp(sampler_stream_third(&stream, sampler->index_reversed), -32);
}

/* With the third number all elementary intervals of twice the volume hold two points each: a (1, m, 3)-net; and the third
 * by itself has one in each of 2^m strata. */
static void pixels_have_nets_in_space(void **state)
{
    (void)state;
    for (uint32_t m = 1; m <= 8; m++)
        for (uint32_t pixel = 0; pixel < 40; pixel++) {
            double point[256][3];
            uint8_t alone[256] = {0};
            for (uint32_t i = 0; i < 1U << m; i++) {
                Sampler sampler = sampler_make(7, 3 * pixel, pixel * pixel, i);
                float u[2];
                sampler_2d(&sampler, 5 + pixel, u);
                point[i][0] = (double)u[0], point[i][1] = (double)u[1];
                point[i][2] = third_of(&sampler, 5 + pixel);
                assert_true(point[i][2] >= 0 && point[i][2] < 1);
                assert_int_equal(alone[stratum(point[i][2], m)]++, 0);
            }
            for (uint32_t a = 0; a < m; a++)
                for (uint32_t b = 0; a + b < m; b++) {
                    uint32_t c = m - 1 - a - b;
                    uint8_t met[128] = {0};
                    for (uint32_t i = 0; i < 1U << m; i++) {
                        const double *p = point[i];
                        assert_true(met[(stratum(p[0], a) << b | stratum(p[1], b)) << c | stratum(p[2], c)]++ < 2);
                    }
                }
        }
}

/* The first 2^m numbers of a pixel are in as many strata, and so are those of a quad, by two for the odd. */
static void quads_have_strata(void **state)
{
    (void)state;
    for (uint32_t m = 0; m <= 6; m++)
        for (uint32_t quad = 0; quad < 256; quad++) {
            uint32_t n = 4U << m, met[256] = {0};
            for (uint32_t i = 0; i < n; i++) {
                Sampler sampler = sampler_make(3, quad % 16 * 2 + (i & 1), quad / 16 * 2 + (i >> 1 & 1), i >> 2);
                met[(uint32_t)((double)sampler_1d(&sampler, 9) * n)]++;
            }
            for (uint32_t i = 0; i < n; i += 2) assert_true(met[i] + met[i + 1] > 0);
        }
}

/* The third numbers of 2^m samples of pairs of pixels on a diagonal, of quads, of two quads on a diagonal, ... of whole blocks,
 * are all in strata of their own, as far as the block scrambles the digits. */
static void thirds_have_strata(void **state)
{
    (void)state;
    for (uint32_t m = 0; m <= 6; m++)
        for (uint32_t k = 0; k <= 6 && m + k <= SAMPLER_DIGITS_SHARED; k++)
            for (uint32_t first = 0; first < 256; first += 1U << k) {
                uint8_t met[1 << SAMPLER_DIGITS_SHARED] = {0};
                for (uint32_t place = first; place < first + (1U << k); place++) {
                    uint32_t y = 0, x = 0;
                    for (uint32_t level = 0; level < 4; level++) {
                        uint32_t digits =
                            place >> 2 * level; /* the lower parts what the higher one leaves, see sampler_place */
                        y |= (digits & 1) << level;
                        x |= ((digits ^ digits >> 1) & 1) << level;
                    }
                    for (uint32_t i = 0; i < 1U << m; i++) {
                        Sampler sampler = sampler_make(3, x, y, i);
                        assert_int_equal(met[stratum(third_of(&sampler, 9), m + k)]++, 0);
                    }
                }
            }
}

/* Numbers of different dimensions have nothing to do with each other, in one pixel and among neighbours: an 8 x 8 table of
 * all pairs over many pixels is flat, by its chi-square. */
static void dimensions_are_independent(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t samples = 1; samples <= 16; samples *= 4)
        for (uint32_t other = 1; other <= 6; other++) {
            double count[8][8] = {{0}}, n = 0, chi = 0;
            for (uint32_t y = 0; y < 256; y++)
                for (uint32_t x = 0; x < 256; x++) {
                    Sampler sampler = sampler_make(other, x, y, (x * 7 + y * 3) % samples);
                    float u[2];
                    sampler_2d(&sampler, 8, u);
                    count[(int)(8 * u[0])][(int)(8 * sampler_1d(&sampler, 8 + other))]++;
                    n++;
                }
            for (int i = 0; i < 64; i++) chi += pow(count[i / 8][i % 8] - n / 64, 2) / (n / 64);
            worst = fmax(worst, chi);
        }
    print_message("pairs of dimensions: chi-square of 63 degrees of freedom at most %.1f\n", worst);
    assert_true(worst < 120); /* the largest of 18 by chance is above that once in 3000 */
}

/* Nor has the third number with each of a stream's two: one sample, or another, of many pixels. */
static void thirds_are_independent(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t samples = 1; samples <= 16; samples *= 4)
        for (uint32_t seed = 1; seed <= 3; seed++) {
            double count[2][64] = {{0}}, n = 256 * 256, chi[2] = {0};
            for (uint32_t y = 0; y < 256; y++)
                for (uint32_t x = 0; x < 256; x++) {
                    Sampler sampler = sampler_make(seed, x, y, (x * 7 + y * 3) % samples);
                    float u[2];
                    uint32_t third = sampler_3d(&sampler, 8, u) >> 29;
                    for (int i = 0; i < 2; i++) count[i][stratum((double)u[i], 3) << 3 | third]++;
                }
            for (int i = 0; i < 128; i++) chi[i / 64] += pow(count[i / 64][i % 64] - n / 64, 2) / (n / 64);
            worst = fmax(worst, fmax(chi[0], chi[1]));
        }
    print_message("third numbers with the others: chi-square of 63 degrees of freedom at most %.1f\n", worst);
    assert_true(worst < 120);
}

/* ---- errors ---- */

typedef struct Integrand {
    const char *name;
    double (*value)(const Sampler *sampler);
    double mean;
} Integrand;

static double ramp(const Sampler *sampler)
{
    return (double)sampler_1d(sampler, 3);
}

static double bump(const Sampler *sampler)
{
    float u[2];
    sampler_2d(sampler, 4, u);
    return exp(-8 * (pow((double)u[0] - 0.4, 2) + pow((double)u[1] - 0.6, 2)));
}

static double disc(const Sampler *sampler)
{
    float u[2];
    sampler_2d(sampler, 5, u);
    return hypot((double)u[0] - 0.5, (double)u[1] - 0.5) < 0.4;
}

/* Of a pair of dimensions, and another one: as a light seen through a lens. */
static double product(const Sampler *sampler)
{
    float u[2];
    sampler_2d(sampler, 12, u);
    return bump(sampler) * (double)(u[0] + u[1]);
}

/* One of two, by the third number, and something of each by the other two: as boundaries choose. */
static double choice(const Sampler *sampler)
{
    float u[2];
    int first = ldexp(sampler_3d(sampler, 6, u), -32) < 0.3;
    return first ? 1 + (double)u[0] : 0.5 * (double)u[1];
}

static double bump_mean(void)
{
    return (erf(sqrt(8) * 0.6) + erf(sqrt(8) * 0.4)) * (erf(sqrt(8) * 0.6) + erf(sqrt(8) * 0.4)) * acos(-1) / 32;
}

static void render(const Integrand *integrand, Maker make, uint32_t samples, double *error)
{
    for (uint32_t y = 0; y < WIDTH; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            double sum = 0;
            for (uint32_t i = 0; i < samples; i++) {
                Sampler sampler = make(1, x, y, i);
                sum += integrand->value(&sampler);
            }
            error[y * WIDTH + x] = sum / samples - integrand->mean;
        }
}

static double power(const double *error, uint32_t border)
{
    double sum = 0;
    for (uint32_t y = border; y < WIDTH - border; y++)
        for (uint32_t x = border; x < WIDTH - border; x++) sum += error[y * WIDTH + x] * error[y * WIDTH + x];
    return sum / ((double)(WIDTH - 2 * border) * (WIDTH - 2 * border));
}

/* Power of what is left by a Gaussian of a standard deviation of two pixels, relative to what that leaves of white noise
 * of the power `white`. */
static double low_power(const double *error, double white)
{
    static double half[WIDTH * WIDTH], whole[WIDTH * WIDTH];
    double kernel[2 * BORDER + 1], sum = 0, squares = 0;
    for (int i = -BORDER; i <= BORDER; i++) sum += kernel[i + BORDER] = exp(-i * i / 8.0);
    for (int i = 0; i <= 2 * BORDER; i++) squares += pow(kernel[i] /= sum, 2);
    for (int y = 0; y < WIDTH; y++)
        for (int x = BORDER; x < WIDTH - BORDER; x++) {
            half[y * WIDTH + x] = 0;
            for (int i = -BORDER; i <= BORDER; i++)
                half[y * WIDTH + x] += kernel[i + BORDER] * error[y * WIDTH + x + i];
        }
    for (int y = BORDER; y < WIDTH - BORDER; y++)
        for (int x = BORDER; x < WIDTH - BORDER; x++) {
            whole[y * WIDTH + x] = 0;
            for (int i = -BORDER; i <= BORDER; i++)
                whole[y * WIDTH + x] += kernel[i + BORDER] * half[(y + i) * WIDTH + x];
        }
    return power(whole, BORDER) / (white * squares * squares);
}

/* What smooth integrands leave in the low frequencies at 1, 4 and 16 samples is a fraction of white noise's; and nowhere is
 * the error of the pixels by themselves larger, up to many samples. */
static void errors_are_blue(void **state)
{
    (void)state;
    const Integrand integrands[] = {{"ramp", ramp, 0.5},
                                    {"bump", bump, bump_mean()},
                                    {"disc", disc, acos(-1) * 0.16},
                                    {"product", product, bump_mean()},
                                    {"choice", choice, 0.3 * 1.5 + 0.7 * 0.25}};
    static const double most[5][3] = {
        {0.3, 0.3, 0.3}, {0.35, 0.3, 0.3}, {0.65, 0.6, 0.55}, {0.5, 0.75, 1}, {0.35, 0.35, 0.4}};
    static double white[WIDTH * WIDTH], blue[WIDTH * WIDTH];
    for (int i = 0; i < 5; i++) {
        print_message("%-8s low frequencies against white noise:", integrands[i].name);
        for (uint32_t m = 0; m <= 8; m += 2) {
            render(&integrands[i], sampler_make_alone, 1U << m, white);
            render(&integrands[i], sampler_make, 1U << m, blue);
            double white_power = power(white, 0), ratio = low_power(blue, white_power);
            print_message("  %u spp %.2f", 1U << m, ratio);
            assert_in(power(blue, 0) / white_power, 0.85, 1.15);
            assert_in(low_power(white, white_power), 0.75, 1.3);
            assert_in(ratio, 0, m <= 4 ? most[i][m / 2] : 1.2);
        }
        print_message("\n");
    }
}

/* A smooth integrand converges as Owen-scrambled nets do, N^-3/2, in every pixel and in the mean over all. */
static void errors_fall_fast(void **state)
{
    (void)state;
    const Integrand integrand = {"bump", bump, bump_mean()};
    static double error[WIDTH * WIDTH];
    render(&integrand, sampler_make, 16, error);
    double few = sqrt(power(error, 0));
    render(&integrand, sampler_make, 256, error);
    double many = sqrt(power(error, 0)), order = log(few / many) / log(16), mean = 0;
    for (int i = 0; i < WIDTH * WIDTH; i++) mean += error[i] / (WIDTH * WIDTH);
    print_message("errors fall with N^-%.2f; of the mean of all pixels %.2g, of one %.2g\n", order, mean, many);
    assert_true(order > 1.3);
    assert_true(fabs(mean) < 4 * many / WIDTH);
}

static void costs_little(void **state)
{
    (void)state;
    enum { TIMES = 2000000 };
    double start = clock_cpu_s(), sum = 0;
    for (uint32_t i = 0; i < TIMES; i++) {
        Sampler sampler = {i, i >> 6, i << 26, i};
        sum += (double)sampler_1d(&sampler, i & 255);
    }
    double middle = clock_cpu_s();
    for (uint32_t i = 0; i < TIMES; i++) {
        Sampler sampler = {i, i >> 6, i << 26, i};
        float u[2];
        sampler_2d(&sampler, i & 255, u);
        sum += (double)(u[0] + u[1]);
    }
    print_message("%.1f ns for one number, %.1f ns for two\n", 1e9 / TIMES * (middle - start),
                  1e9 / TIMES * (clock_cpu_s() - middle));
    assert_in(sum / (3.0 * TIMES), 0.49, 0.51);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_have_nets),
        cmocka_unit_test(pixels_have_nets_in_space),
        cmocka_unit_test(quads_have_strata),
        cmocka_unit_test(thirds_have_strata),
        cmocka_unit_test(dimensions_are_independent),
        cmocka_unit_test(thirds_are_independent),
        cmocka_unit_test(errors_are_blue),
        cmocka_unit_test(errors_fall_fast),
        cmocka_unit_test(costs_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
