/* environment_test.c - environments: look-up, density and samples agree with each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "lanes_finite.h"
#include "optics/texture.h"

static const double pi = 3.14159265358979323846;

static Environment *make_image(const float *rgb, unsigned width, unsigned height, double scale)
{
    Environment *environment = NULL;
    Error error;
    assert_int_equal(environment_new_image(rgb, width, height, scale, NULL, NULL, &environment, &error), STATUS_OK);
    return environment;
}

static Vec3f direction_at(double u, double v)
{
    double polar = pi * v, angle = 2 * pi * (u - 0.5);
    return vec3f((float)(sin(polar) * sin(angle)), (float)cos(polar), (float)(-sin(polar) * cos(angle)));
}

static Vec3f sample(const Environment *environment, float u, float v, float *pdf_w)
{
    EnvironmentPlace place;
    return environment_sample_place(environment, u, v, pdf_w, &place);
}

static float density_of(const Environment *environment, Vec3f direction)
{
    float pdf_w;
    environment_find(environment, direction, &pdf_w);
    return pdf_w;
}

static Lanes some_wavelengths(void)
{
    return lanes(420, 500, 580, 660);
}

/* Radiance over white: a grey image's value. */
static float grey_at(const Environment *environment, Vec3f direction)
{
    Lanes nm = some_wavelengths();
    Lanes ratio = lanes_div(environment_radiance(environment, direction, nm), white_at(nm));
    assert_true(lanes_max(ratio) - lanes_min(ratio) <= 1e-6f * lanes_max(ratio));
    return lanes_get(ratio, 0);
}

static float random_unit(uint32_t *state)
{
    *state += 1;
    return hash_to_unit_f(hash_combine(*state, 77));
}

/* Images that are hard in one way each. */
enum { WIDTH = 16, HEIGHT = 8 };
enum { IMAGE_FLAT, IMAGE_SUN, IMAGE_NOISE, IMAGE_POLE, IMAGE_SEAM, IMAGE_COLUMN, N_IMAGES };

static void fill_image(int kind, float rgb[HEIGHT * WIDTH * 3])
{
    uint32_t state = 5;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float value = 0;
            if (kind == IMAGE_FLAT) value = 1;
            if (kind == IMAGE_SUN) value = x == 5 && y == 3 ? 10000.0f : 1.0f;
            if (kind == IMAGE_NOISE) value = random_unit(&state);
            if (kind == IMAGE_POLE) value = x == 3 && y == 0 ? 5.0f : 0.0f;
            if (kind == IMAGE_SEAM) value = x == WIDTH - 1 && y == 4 ? 5.0f : 0.0f;
            if (kind == IMAGE_COLUMN) value = x == 8 ? 3.0f : 0.0f;
            for (int c = 0; c < 3; c++) rgb[(y * WIDTH + x) * 3 + c] = value;
        }
}

static void look_up_finds_the_texels(void **unused)
{
    (void)unused;
    float rgb[HEIGHT * WIDTH * 3];
    fill_image(IMAGE_NOISE, rgb);
    Environment *environment = make_image(rgb, WIDTH, HEIGHT, 2);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            float found = grey_at(environment, direction_at((x + 0.5) / WIDTH, (y + 0.5) / HEIGHT));
            assert_float_equal(found, 2 * rgb[(y * WIDTH + x) * 3], 1e-4f);
            /* half way to the next, across the seam too */
            float next = rgb[(y * WIDTH + (x + 1) % WIDTH) * 3];
            found = grey_at(environment, direction_at((x + 1.0) / WIDTH, (y + 0.5) / HEIGHT));
            assert_float_equal(found, rgb[(y * WIDTH + x) * 3] + next, 1e-4f);
        }
    /* row 0 is up, the middle column is -z, a quarter further is +x */
    fill_image(IMAGE_POLE, rgb);
    environment_free(environment);
    environment = make_image(rgb, WIDTH, HEIGHT, 1);
    assert_true(grey_at(environment, direction_at(3.5 / WIDTH, 0)) >= 0);
    assert_float_equal(grey_at(environment, vec3f(0, -1, 0)), 0, 0);
    environment_free(environment);
    fill_image(IMAGE_COLUMN, rgb);
    environment = make_image(rgb, WIDTH, HEIGHT, 1);
    assert_float_equal(grey_at(environment, vec3f(0, 0, -1)), 1.5f, 1e-5f); /* the seam of columns 7 and 8 */
    assert_true(grey_at(environment, vec3f(sinf(0.2f), 0, -cosf(0.2f))) > 2.9f);
    assert_float_equal(grey_at(environment, vec3f(1, 0, 0)), 0, 0);
    environment_free(environment);
}

/* The density integrates to 1, and is above zero wherever there is light. */
static void density_is_normalized_and_covers_the_light(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < N_IMAGES; kind++) {
        float rgb[HEIGHT * WIDTH * 3];
        fill_image(kind, rgb);
        Environment *environment = make_image(rgb, WIDTH, HEIGHT, 1);
        enum { ROWS = 1600, COLUMNS = 640 };
        double total = 0, light = 0;
        float ratio = 0;
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < COLUMNS; x++) {
                double v = (y + 0.5) / ROWS;
                Vec3f direction = direction_at((x + 0.5) / COLUMNS, v);
                double solid_angle = 2 * pi * pi / ((double)ROWS * COLUMNS) * sin(pi * v);
                float pdf = density_of(environment, direction), radiance = grey_at(environment, direction);
                total += (double)pdf * solid_angle;
                light += (double)radiance * solid_angle;
                assert_true(radiance <= 0 || pdf > 0);
                if (radiance > 0) ratio = fmaxf(ratio, radiance / pdf);
            }
        assert_float_equal((float)total, 1, 2e-4f);
        /* what one sample can add, in units of the whole: 1 would be perfect */
        ratio /= environment_power(environment);
        printf("image %d: density integrates to %.5f, power %g of %g, brightest sample %.3f\n", kind, total,
               (double)environment_power(environment), light, (double)ratio);
        assert_true(ratio < 2.2f);
        /* the power interpolates in the cosine, not the angle, which shows beside the poles of a coarse image */
        assert_float_equal(environment_power(environment) / (float)light, 1, kind == IMAGE_POLE ? 0.2f : 0.02f);
        environment_free(environment);
    }
}

/* The mean of radiance / density over samples is the integral of the image. */
static void samples_integrate_the_image(void **unused)
{
    (void)unused;
    for (int kind = 0; kind < N_IMAGES; kind++) {
        float rgb[HEIGHT * WIDTH * 3];
        fill_image(kind, rgb);
        Environment *environment = make_image(rgb, WIDTH, HEIGHT, 1);
        enum { ROWS = 1600, COLUMNS = 640, SAMPLES = 200000 };
        double integral = 0, sum = 0, squares = 0;
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < COLUMNS; x++) {
                double v = (y + 0.5) / ROWS;
                integral += 2 * pi * pi / ((double)ROWS * COLUMNS) * sin(pi * v) *
                            (double)grey_at(environment, direction_at((x + 0.5) / COLUMNS, v));
            }
        uint32_t state = (uint32_t)kind * 1000003U;
        for (int i = 0; i < SAMPLES; i++) {
            float u = random_unit(&state), v = random_unit(&state), pdf;
            Vec3f direction = sample(environment, u, v, &pdf);
            assert_true(pdf > 0 && isfinite(pdf));
            assert_float_equal(vec3f_length(direction), 1, 1e-6f);
            double estimate = (double)(grey_at(environment, direction) / pdf);
            sum += estimate;
            squares += estimate * estimate;
        }
        double mean = sum / SAMPLES, error = sqrt(fmax(squares / SAMPLES - mean * mean, 0) / SAMPLES);
        printf("image %d: integral %.6g, samples %.6g +- %.2g\n", kind, integral, mean, error);
        /* 1e-4: of the quadrature, and of floats where the error is zero */
        assert_true(fabs(mean - integral) < 4 * error + 1e-4 * integral);
        environment_free(environment);
    }
}

/* Pearson's chi-square of samples in bins against the integral of the density over them. */
static void samples_follow_the_density(void **unused)
{
    (void)unused;
    enum { ROWS = 12, COLUMNS = 20, FINE = 40, SAMPLES = 200000 };
    for (int kind = 0; kind < N_IMAGES; kind++) {
        float rgb[HEIGHT * WIDTH * 3];
        fill_image(kind, rgb);
        Environment *environment = make_image(rgb, WIDTH, HEIGHT, 1);
        static double expected[ROWS][COLUMNS];
        static int counted[ROWS][COLUMNS];
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < COLUMNS; x++) {
                expected[y][x] = 0;
                counted[y][x] = 0;
                for (int j = 0; j < FINE; j++)
                    for (int i = 0; i < FINE; i++) {
                        double u = (x + (i + 0.5) / FINE) / COLUMNS, v = (y + (j + 0.5) / FINE) / ROWS;
                        double cell = 2 * pi * pi * sin(pi * v) / ((double)ROWS * COLUMNS * FINE * FINE);
                        expected[y][x] += SAMPLES * cell * (double)density_of(environment, direction_at(u, v));
                    }
            }
        uint32_t state = (uint32_t)kind * 7919U + 3;
        for (int i = 0; i < SAMPLES; i++) {
            float u = random_unit(&state), v = random_unit(&state), pdf;
            Vec3f d = sample(environment, u, v, &pdf);
            if (i % 64 == 0) { /* both at once, and each by itself */
                float at_once;
                Lanes nm = lanes(450, 520, 590, 650), radiance = environment_look(environment, d, nm, &at_once);
                assert_true(at_once == density_of(environment, d));
                assert_true(lanes_equal(radiance, environment_radiance(environment, d, nm)));
            }
            int x = (int)((0.5 + atan2((double)d.x, -(double)d.z) / (2 * pi)) * COLUMNS);
            int y = (int)(acos(fmax(-1, fmin(1, (double)d.y))) / pi * ROWS);
            counted[y < ROWS ? y : ROWS - 1][x < COLUMNS ? x : COLUMNS - 1]++;
        }
        double chi = 0;
        int bins = 0;
        for (int y = 0; y < ROWS; y++)
            for (int x = 0; x < COLUMNS; x++) {
                if (expected[y][x] < 8) continue; /* the usual condition of the test */
                double difference = counted[y][x] - expected[y][x];
                chi += difference * difference / expected[y][x];
                bins++;
            }
        /* Wilson-Hilferty: the cube root of chi^2 / k is about normal */
        double k = bins - 1, z = (cbrt(chi / k) - (1 - 2 / (9 * k))) / sqrt(2 / (9 * k));
        printf("image %d: chi-square %.1f over %d bins, %.2f standard deviations\n", kind, chi, bins, z);
        assert_true(z < 4);
        environment_free(environment);
    }
}

/* What is sampled comes with its place in the image, which is that of its direction, also where it is found by another way. */
static void samples_know_their_places(void **unused)
{
    (void)unused;
    const unsigned heights[] = {3, 63, 64, 300};
    enum { COLUMNS = 30, SAMPLES = 20000 };
    for (size_t i = 0; i < COUNT_OF(heights); i++) {
        size_t n = (size_t)heights[i] * COLUMNS * 3;
        float *rgb = malloc(n * sizeof *rgb);
        assert_non_null(rgb);
        for (size_t k = 0; k < n; k++) rgb[k] = 1 + hash_to_unit_f(hash_combine((uint32_t)i, (uint32_t)(k / 3)));
        Environment *environment = make_image(rgb, COLUMNS, heights[i], 1);
        for (uint32_t k = 0; k < SAMPLES; k++) {
            float pdf, u = hash_to_unit_f(hash_combine(k, 1)), v = hash_to_unit_f(hash_combine(k, 2));
            EnvironmentPlace place;
            Vec3f direction = environment_sample_place(environment, u, v, &pdf, &place);
            float there = lanes_get(environment_radiance_at(environment, &place, some_wavelengths()), 0);
            float found = lanes_get(environment_radiance(environment, direction, some_wavelengths()), 0);
            assert_float_equal(there / found, 1, 2e-4f);
            assert_float_equal(pdf / density_of(environment, direction), 1, 2e-3f);
        }
        environment_free(environment);
        free(rgb);
    }
}

static void constant_is_uniform(void **unused)
{
    (void)unused;
    Spectrum white = spectrum_from_light((const double[3]){1, 1, 1});
    Environment *environment;
    Error error;
    assert_int_equal(environment_new_constant(&white, &environment, &error), STATUS_OK);
    Lanes nm = some_wavelengths();
    double sum = 0;
    uint32_t state = 1;
    for (int i = 0; i < 20000; i++) {
        float u = random_unit(&state), v = random_unit(&state), pdf;
        Vec3f direction = sample(environment, u, v, &pdf);
        assert_float_equal(pdf, (float)(1 / (4 * pi)), 1e-9f);
        assert_float_equal(density_of(environment, direction), (float)(1 / (4 * pi)), 1e-9f);
        assert_float_equal(vec3f_length(direction), 1, 1e-6f);
        sum += (double)direction.y;
        Lanes difference = lanes_sub(environment_radiance(environment, direction, nm), white_at(nm));
        assert_true(lanes_zero(difference));
    }
    assert_float_equal((float)(sum / 20000), 0, 4 / sqrtf(3 * 20000.0f));
    assert_float_equal(environment_power(environment), (float)(4 * pi), 1e-5f);
    assert_false(environment_is_black(environment));
    environment_free(environment);

    /* a grey image is the same, to the last bit of its radiance */
    float rgb[HEIGHT * WIDTH * 3];
    fill_image(IMAGE_FLAT, rgb);
    environment = make_image(rgb, WIDTH, HEIGHT, 1);
    for (int i = 0; i < 20000; i++) {
        float u = random_unit(&state), v = random_unit(&state), pdf;
        Vec3f direction = sample(environment, u, v, &pdf);
        assert_float_equal(pdf * 4 * (float)pi, 1, 1e-5f);
        assert_float_equal(grey_at(environment, direction), 1, 3e-7f);
    }
    environment_free(environment);
}

static void colours_resolve(void **unused)
{
    (void)unused;
    const float rgb[2 * 3] = {3.0f, 0.5f, 0.1f, 3.0f, 0.5f, 0.1f};
    Environment *environment = make_image(rgb, 2, 1, 4);
    double sum[3] = {0, 0, 0};
    enum { STEPS = 65536 };
    for (int i = 0; i < STEPS; i++) {
        float added[3];
        WavelengthSample wavelengths = wavelengths_sample(((float)i + 0.5f) / STEPS);
        color_from_lanes(environment_radiance(environment, vec3f(0.6f, 0, 0.8f), wavelengths.nm), &wavelengths, added);
        for (int c = 0; c < 3; c++) sum[c] += (double)added[c] / STEPS;
    }
    for (int c = 0; c < 3; c++) assert_float_equal((float)sum[c], 4 * rgb[c], 0.01f);
    environment_free(environment);
}

/* What a light of lines gives an image: its own wavelengths, by the image's values, and as much power. */
static void images_shine_with_a_light(void **unused)
{
    (void)unused;
    float table[SPECTRUM_SAMPLES], rgb[HEIGHT * WIDTH * 3];
    const double rows[] = {550, 0, 580, 40, 600, 0};
    Spectrum light = spectrum_from_rows(rows, COUNT_OF(rows) / 2, table);
    fill_image(IMAGE_FLAT, rgb);
    Environment *environment = NULL;
    Error error;
    assert_int_equal(environment_new_image(rgb, WIDTH, HEIGHT, 3, &light, NULL, &environment, &error), STATUS_OK);
    Lanes nm = some_wavelengths(), radiance = environment_radiance(environment, vec3f(0.6f, 0, 0.8f), nm);
    for (int i = 0; i < LANES; i++)
        assert_float_equal(lanes_get(radiance, i), 3 * spectrum_at_one(&light, lanes_get(nm, i)), 1e-4f);
    assert_float_equal(environment_power(environment) / (12 * (float)pi * (float)spectrum_luminance(&light)), 1, 1e-5f);
    assert_true(spectrum_same(environment_light(environment), &light));
    environment_free(environment);
    environment = make_image(rgb, WIDTH, HEIGHT, 1);
    assert_null(environment_light(environment));
    environment_free(environment);

    /* as bright as can be by itself, and with its light too bright */
    const float bright[3] = {1e29f, 1e29f, 1e29f};
    assert_int_equal(environment_new_image(bright, 1, 1, 1, NULL, NULL, &environment, &error), STATUS_OK);
    environment_free(environment);
    assert_int_equal(environment_new_image(bright, 1, 1, 1, &light, NULL, &environment, &error), STATUS_INPUT);
}

static void black_bad_and_tiny_images(void **unused)
{
    (void)unused;
    const float black[12] = {0}, blinding[3] = {1e30f, 1, 1}, one[3] = {0.2f, 0.3f, 0.4f};
    Error error;
    Environment *environment = make_image(black, 2, 2, 1);
    float pdf;
    assert_true(environment_is_black(environment));
    Vec3f direction = sample(environment, 0, 0, &pdf);
    assert_true(pdf > 0);
    assert_true(lanes_zero(environment_radiance(environment, direction, some_wavelengths())));
    environment_free(environment);

    assert_int_equal(environment_new_image(blinding, 1, 1, 10, NULL, NULL, &environment, &error), STATUS_INPUT);
    assert_int_equal(environment_new_image(blinding, 1, 1, 1, NULL, NULL, &environment, &error), STATUS_OK);
    environment_free(environment);
    assert_int_equal(environment_new_image(one, 0, 1, 1, NULL, NULL, &environment, &error), STATUS_INPUT);
    assert_int_equal(environment_new_image(one, 1, 1u << 20, 1, NULL, NULL, &environment, &error), STATUS_INPUT);

    environment = make_image(one, 1, 1, 1);
    direction = sample(environment, 0.999999f, 0.999999f, &pdf);
    assert_float_equal(pdf * 4 * (float)pi, 1, 1e-5f);
    /* every corner of the sphere, and no direction at all, are read within the image */
    const float axis[3] = {-1, 0, 1};
    for (int i = 0; i < 27; i++) {
        Vec3f d = vec3f(axis[i % 3], axis[i / 3 % 3], axis[i / 9]);
        assert_true(lanes_finite(environment_radiance(environment, d, some_wavelengths())));
    }
    environment_free(environment);
    environment_free(NULL);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(look_up_finds_the_texels),
        cmocka_unit_test(density_is_normalized_and_covers_the_light),
        cmocka_unit_test(samples_integrate_the_image),
        cmocka_unit_test(samples_follow_the_density),
        cmocka_unit_test(samples_know_their_places),
        cmocka_unit_test(constant_is_uniform),
        cmocka_unit_test(colours_resolve),
        cmocka_unit_test(images_shine_with_a_light),
        cmocka_unit_test(black_bad_and_tiny_images),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
