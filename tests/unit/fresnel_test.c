/* fresnel_test.c - reflectance and refraction against the textbook's equations in long double.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "optics/fresnel.h"
#include "optics/sampling.h"

static float random_unit(uint32_t *state)
{
    *state += 1;
    return hash_to_unit_f(hash_u32(*state));
}

/* Drawn one after the other: the order of a call's arguments is the compiler's. */
static Vec3f random_direction(uint32_t *state)
{
    float u = random_unit(state), v = random_unit(state);
    return sampling_sphere(u, v);
}

static long double reference(long double cos_i, long double eta_i, long double eta_t)
{
    long double a = eta_i * cos_i, square = a * a + eta_t * eta_t - eta_i * eta_i;
    if (eta_i == eta_t) return 0;
    if (square <= 0) return 1;
    long double b = sqrtl(square);
    long double r_s = (a - b) / (a + b),
                r_p = (eta_t * eta_t * a - eta_i * eta_i * b) / (eta_t * eta_t * a + eta_i * eta_i * b);
    return 0.5L * (r_s * r_s + r_p * r_p);
}

static void known_values(void **unused)
{
    (void)unused;
    assert_float_equal(fresnel_dielectric(1, 1, 1.5f), 0.04f, 1e-7f);
    assert_float_equal(fresnel_dielectric(1, 1.5f, 1), 0.04f, 1e-7f);
    assert_float_equal(fresnel_dielectric(0, 1, 1.5f), 1, 0);
    assert_float_equal(fresnel_dielectric(0, 1.5f, 1), 1, 0);
    /* Brewster's angle: the p wave is gone, and r_s = (n^2 - 1) / (n^2 + 1) */
    float brewster = cosf(atanf(1.5f)), r_s = (1.5f * 1.5f - 1) / (1.5f * 1.5f + 1);
    assert_float_equal(fresnel_dielectric(brewster, 1, 1.5f), 0.5f * r_s * r_s, 1e-7f);
    /* cosines a little outside of 0..1 are taken for the ends */
    assert_float_equal(fresnel_dielectric(1.0000002f, 1, 1.5f), 0.04f, 1e-7f);
    assert_float_equal(fresnel_dielectric(-1e-7f, 1, 1.5f), 1, 0);
}

/* Both polarizations, which are the mean together. */
static void polarized(void **unused)
{
    (void)unused;
    Lanes both[2];
    uint32_t state = 7;
    fresnel_dielectric_polarized(cosf(atanf(1.5f)), lanes_all(1), lanes_all(1.5f), both);
    assert_float_equal(lanes_get(both[1], 0), 0, 1e-7f);
    fresnel_dielectric_polarized(0.3f, lanes_all(1.5f), lanes_all(1), both); /* total */
    assert_true(lanes_get(both[0], 0) == 1 && lanes_get(both[1], 0) == 1);
    for (int i = 0; i < 100000; i++) {
        float cos_i = random_unit(&state), eta_i = 1 + random_unit(&state), eta_t = 1 + 2 * random_unit(&state);
        fresnel_dielectric_polarized(cos_i, lanes_all(eta_i), lanes_all(eta_t), both);
        assert_true(lanes_get(both[0], 2) >= lanes_get(both[1], 2) - 1e-6f);
        assert_float_equal(0.5f * (lanes_get(both[0], 2) + lanes_get(both[1], 2)),
                           fresnel_dielectric(cos_i, eta_i, eta_t), 1e-6f);
    }
}

static void exact_at_random(void **unused)
{
    (void)unused;
    uint32_t state = 0;
    double worst = 0, worst_near = 0;
    for (int i = 0; i < 1000000; i++) {
        float cos_i = random_unit(&state), eta_i = 1 + random_unit(&state), eta_t = 1 + 2 * random_unit(&state);
        if (i % 4 == 1) cos_i *= cos_i * cos_i * cos_i;
        if (i % 4 == 2) eta_t = eta_i + (random_unit(&state) - 0.5f) * 1e-5f; /* nearly equal */
        if (i % 4 == 3 && eta_i > eta_t) {                                    /* nearly critical */
            float critical = sqrtf(1 - (eta_t / eta_i) * (eta_t / eta_i));
            cos_i = fminf(critical * (1 + (random_unit(&state) - 0.5f) * 1e-5f), 1);
        }
        double expected = (double)reference((long double)cos_i, (long double)eta_i, (long double)eta_t);
        double found = (double)fresnel_dielectric(cos_i, eta_i, eta_t);
        assert_true(found >= 0 && found <= 1);
        worst = fmax(worst, fabs(found - expected));
        if (i % 4 == 2 && expected > 1e-30) worst_near = fmax(worst_near, fabs(found / expected - 1));
    }
    printf("largest error %.2g; relative error at nearly equal indices %.2g\n", worst, worst_near);
    assert_true(worst < 2e-6);
    /* Brewster's zero aside the weak reflection keeps its digits. */
    assert_true(worst_near < 1e-4);
}

static void lanes_agree_with_one(void **unused)
{
    (void)unused;
    uint32_t state = 9;
    for (int i = 0; i < 100000; i++) {
        float cos_i = random_unit(&state), eta[4];
        for (int k = 0; k < 4; k++) eta[k] = 1 + random_unit(&state);
        Lanes across = lanes(eta[0], eta[1], eta[2], eta[3]), uniform = lanes_all(1.3f);
        Lanes out = fresnel_dielectric_lanes(cos_i, across, uniform),
              in = fresnel_dielectric_lanes(cos_i, uniform, across);
        Lanes same = fresnel_dielectric_lanes(cos_i, lanes_all(eta[0]), uniform);
        for (int k = 0; k < 4; k++) {
            assert_true(lanes_get(out, k) == fresnel_dielectric(cos_i, eta[k], 1.3f));
            assert_true(lanes_get(in, k) == fresnel_dielectric(cos_i, 1.3f, eta[k]));
            assert_true(lanes_get(same, k) == fresnel_dielectric(cos_i, eta[0], 1.3f));
        }
    }
}

static void equal_indices_vanish(void **unused)
{
    (void)unused;
    const float eta[] = {1, 1.31f, 1.333f, 1.5f, 2.4f};
    for (size_t i = 0; i < 5; i++)
        for (int k = 0; k <= 1000; k++) {
            float cos_i = (float)k / 1000;
            assert_true(fresnel_dielectric(cos_i, eta[i], eta[i]) == 0);
            Vec3f direction = vec3f(sqrtf(1 - cos_i * cos_i), 0, -cos_i), refracted;
            assert_true(refract_direction(direction, vec3f(0, 0, 1), eta[i], eta[i], &refracted));
            assert_true(refracted.x == direction.x && refracted.z == direction.z);
        }
    assert_true(lanes_zero(fresnel_dielectric_lanes(0, lanes(1, 1.1f, 1.2f, 1.3f), lanes(1, 1.1f, 1.2f, 1.3f))));
}

/* Total reflection in one is total reflection in the other, whatever the input; and Snell's law. */
static void refraction_agrees_with_reflectance(void **unused)
{
    (void)unused;
    uint32_t state = 3;
    int total = 0;
    double worst_snell = 0, worst_length = 0;
    for (int i = 0; i < 1000000; i++) {
        Vec3f normal = random_direction(&state);
        float pdf, u = random_unit(&state), v = random_unit(&state);
        Vec3f direction = vec3f_negate(sampling_cosine_hemisphere(u, v, normal, &pdf));
        float eta_i = 1 + random_unit(&state), eta_t = 1 + random_unit(&state);
        if (i % 3 == 1) eta_t = eta_i + (random_unit(&state) - 0.5f) * 1e-6f;
        if (i % 3 == 2) {
            float sine = sqrtf(fmaxf(0, 1 - vec3f_dot(direction, normal) * vec3f_dot(direction, normal)));
            eta_t = fmaxf(1, eta_i * sine * (1 + (random_unit(&state) - 0.5f) * 1e-6f)); /* about critical */
        }
        float reflectance = fresnel_dielectric(-vec3f_dot(direction, normal), eta_i, eta_t);
        Vec3f refracted;
        bool passes = refract_direction(direction, normal, eta_i, eta_t, &refracted);
        if (!passes) {
            assert_true(reflectance == 1);
            total++;
            continue;
        }
        worst_length = fmax(worst_length, fabs((double)vec3f_length(refracted) - 1));
        Vec3f before = vec3f_cross(direction, normal), after = vec3f_cross(refracted, normal);
        Vec3f difference = vec3f_sub(vec3f_scale(before, eta_i), vec3f_scale(after, eta_t));
        worst_snell = fmax(worst_snell, (double)vec3f_length(difference));
        assert_true(vec3f_dot(refracted, normal) < 1e-6f);
        Vec3f reflected = reflect_direction(direction, normal);
        assert_float_equal(vec3f_dot(reflected, normal), -vec3f_dot(direction, normal), 1e-6f);
    }
    printf("%d of 1000000 total; Snell's law to %.2g, length to %.2g\n", total, worst_snell, worst_length);
    assert_true(total > 100000);
    assert_true(worst_snell < 2e-6 && worst_length < 3e-7);

    /* the same along a line through the critical angle in steps of one float */
    float critical = sqrtf(1 - 1 / (1.5f * 1.5f));
    for (int k = -200; k <= 200; k++) {
        float cos_i = critical;
        for (int step = 0; step < abs(k); step++) cos_i = nextafterf(cos_i, k < 0 ? 0.0f : 1.0f);
        Vec3f refracted, direction = vec3f(sqrtf(1 - cos_i * cos_i), 0, -cos_i);
        bool passes = refract_direction(direction, vec3f(0, 0, 1), 1.5f, 1, &refracted);
        float reflectance = fresnel_dielectric(cos_i, 1.5f, 1);
        assert_true(passes ? reflectance < 1 : reflectance == 1);
        if (k <= -2) assert_false(passes);
        if (k >= 2) assert_true(passes);
    }
}

static void mean_is_the_integral(void **unused)
{
    (void)unused;
    const float eta[] = {1.0001f, 1.002f, 1.05f, 1.31f, 1.5f, 2.4f, 4.0f};
    double worst = 0;
    for (size_t i = 0; i < 7; i++)
        for (int inside = 0; inside <= 1; inside++) {
            long double sum = 0, n = (long double)eta[i];
            enum { STEPS = 400000 };
            for (int k = 0; k < STEPS; k++) {
                long double cos_i = (k + 0.5L) / STEPS;
                sum += 2 * cos_i * (inside ? reference(cos_i, n, 1) : reference(cos_i, 1, n)) / STEPS;
            }
            float mean = inside ? fresnel_dielectric_mean(eta[i], 1) : fresnel_dielectric_mean(1, eta[i]);
            worst = fmax(worst, fabs((double)mean - (double)sum));
        }
    printf("largest error of the mean %.2g\n", worst);
    assert_true(worst < 1e-6);
    assert_float_equal(fresnel_dielectric_mean(1, 1), 0, 0);
    assert_float_equal(fresnel_dielectric_mean(1.33f, 1.33f), 0, 0);
    assert_float_equal(fresnel_dielectric_mean(1, 1.5f), 0.0918f, 5e-5f); /* Walsh: 9.18 % */
}

/* sampling.h */
static void samples_are_where_they_should(void **unused)
{
    (void)unused;
    uint32_t state = 11;
    double cosine = 0, cone = 0, disc = 0;
    enum { N = 200000 };
    const float cap = 1e-3f;
    for (int i = 0; i < N; i++) {
        Vec3f normal = random_direction(&state), tangent, bitangent;
        if (i == 0) normal = vec3f(0, 0, -1);
        sampling_basis(normal, &tangent, &bitangent);
        assert_float_equal(vec3f_length(tangent), 1, 1e-6f);
        assert_float_equal(vec3f_dot(tangent, normal), 0, 1e-6f);
        assert_float_equal(vec3f_length(vec3f_sub(vec3f_cross(tangent, bitangent), normal)), 0, 1e-6f);
        float u = random_unit(&state), v = random_unit(&state), pdf, x, y;
        Vec3f direction = sampling_cosine_hemisphere(u, v, normal, &pdf);
        assert_float_equal(vec3f_length(direction), 1, 1e-6f);
        assert_float_equal(vec3f_dot(direction, normal), pdf * SAMPLING_PI, 1e-6f);
        cosine += (double)vec3f_dot(direction, normal);
        direction = sampling_cone(u, v, normal, cap);
        assert_float_equal(vec3f_length(direction), 1, 1e-6f);
        float height = 1 - vec3f_dot(direction, normal);
        assert_true(height > -1e-6f && height < cap + 1e-6f);
        cone += (double)(height / cap);
        sampling_disc(u, v, &x, &y);
        assert_true(x * x + y * y <= 1.000001f);
        disc += (double)(x * x + y * y);
    }
    assert_float_equal((float)(cosine / N), 2.0f / 3, 4 * 0.2357f / sqrtf(N));
    assert_float_equal((float)(cone / N), 0.5f, 4 * 0.2887f / sqrtf(N));
    assert_float_equal((float)(disc / N), 0.5f, 4 * 0.2887f / sqrtf(N));
    assert_float_equal(sampling_cone_pdf(2), 1 / (4 * SAMPLING_PI), 1e-8f);
    assert_float_equal(sampling_balance(3, 1), 0.75f, 1e-7f);
}

static void circle_is_even(void **unused)
{
    (void)unused;
    const int n = 4096;
    for (int i = 0; i <= 2 * n; i++) {
        float u = (float)i / (float)n, x, y;
        sampling_circle(u, &x, &y);
        double angle = 2 * 3.14159265358979323846 * (double)u;
        assert_true(fabs((double)x - cos(angle)) < 2e-7 && fabs((double)y - sin(angle)) < 2e-7);
        assert_true(fabsf(x) <= 1 && fabsf(y) <= 1);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(circle_is_even),
        cmocka_unit_test(known_values),
        cmocka_unit_test(polarized),
        cmocka_unit_test(exact_at_random),
        cmocka_unit_test(lanes_agree_with_one),
        cmocka_unit_test(equal_indices_vanish),
        cmocka_unit_test(refraction_agrees_with_reflectance),
        cmocka_unit_test(mean_is_the_integral),
        cmocka_unit_test(samples_are_where_they_should),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
