/* line_light_test.c - light first, then the place on a line: the densities of places, by Pearson's chi-square; where lights
 * shine on a line, against what light sampling gives there; and the tree's choice for lines.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "near.h"
#include "optics/sampling.h"
#include "scene_fixture.h"
#include "trace/light.h"

enum { BINS = 50, SAMPLES = 200000 };

/* The chi-square of counts against a density's integral over even bins, by Simpson's rule. */
static void judge(const char *what, const int counted[BINS], double (*density)(const double *, double),
                  const double *parameters, double begin, double end)
{
    enum { STEPS = 200 };
    double chi = 0, whole = 0, n = 0;
    for (int i = 0; i < BINS; i++) {
        double step = (end - begin) / BINS / STEPS, from = begin + (end - begin) * i / BINS, sum = 0;
        for (int k = 0; k <= STEPS; k++)
            sum += density(parameters, fmin(from + step * k, end)) * (k == 0 || k == STEPS ? 1 : k % 2 ? 4 : 2);
        double expected = sum * step / 3;
        whole += expected;
        if (expected * SAMPLES < 8) continue;
        chi += pow(counted[i] - expected * SAMPLES, 2) / (expected * SAMPLES);
        n++;
    }
    print_message("%s: chi-square %.1f of %.0f bins\n", what, chi, n);
    assert_near(whole, 1, 1e-4);
    assert_true(n >= 3);
    assert_true(chi < n + 4.5 * sqrt(2 * n));
}

static double equiangular(const double *p, double t)
{
    return sampling_equiangular_pdf(t, p[0], p[1], p[2], sampling_angle(p[0], p[1], p[2]));
}

static double exponential(const double *p, double t)
{
    return sampling_exponential_pdf(t, p[0], p[1]);
}

static int bin_of(double t, double begin, double end)
{
    assert_true(t >= begin && t <= end);
    int bin = (int)((t - begin) / (end - begin) * BINS);
    return bin < BINS ? bin : BINS - 1;
}

static void densities(void **state)
{
    (void)state;
    static const double falls[][3] = {{1, -3, 5}, {.3, -1, 1}, {2, 3, 9}, {.01, -9, -.1}, {50, -1, 1}, {1e-4, 1, 2}};
    static const double rates[][2] = {{1, 1}, {9, 1}, {1e-9, 5}, {.3, 40}};
    Dice dice = {3};
    for (size_t i = 0; i < COUNT_OF(falls); i++) {
        const double *p = falls[i];
        int counted[BINS] = {0};
        for (int k = 0; k < SAMPLES; k++)
            counted[bin_of(sampling_equiangular(dice_unit(&dice), p[0], p[1], p[2], sampling_angle(p[0], p[1], p[2])),
                           p[1], p[2])]++;
        judge("equiangular", counted, equiangular, p, p[1], p[2]);
    }
    for (size_t i = 0; i < COUNT_OF(rates); i++) {
        const double *p = rates[i];
        int counted[BINS] = {0};
        for (int k = 0; k < SAMPLES; k++)
            counted[bin_of(sampling_exponential(dice_unit(&dice), p[0], p[1]), 0, p[1])]++;
        judge("exponential", counted, exponential, p, 0, p[1]);
    }
    /* at the ends, and where a line goes through the light */
    assert_near(sampling_equiangular(0, 1, -2, 3, sampling_angle(1, -2, 3)), -2, 1e-12);
    assert_near(sampling_equiangular(1, 1, -2, 3, sampling_angle(1, -2, 3)), 3, 1e-12);
    assert_near(sampling_equiangular(.5, 1e-9, -1, 1, sampling_angle(1e-9, -1, 1)), 0, 1e-9);
}

static void open_world(Fixture *f, World *world, const char *scene)
{
    char text[2000];
    snprintf(text, sizeof text, "meniscus 1.0 unit mm camera { from = <0, 0, 900>  to = <0, 0, 0> }\n%s\n", scene);
    fixture_compile(f, text, 1);
    assert_int_equal(world_init(world, f->compiled, 0, 8, false, NULL, &f->error), STATUS_OK);
}

static Vec3 dice_place(Dice *dice, double size)
{
    double x = dice_unit(dice), y = dice_unit(dice), z = dice_unit(dice);
    return vec3(size * (2 * x - 1), size * (2 * y - 1), size * (2 * z - 1));
}

/* Where light_reach says that an emitter shines on a line, and only there, some place of it does so; and the place that
 * light_pivot says is what light_sample_emitter looks at. */
static void reach(void **state)
{
    (void)state;
    static const char *const lights[] = {
        "light { shape = spot  from = <0, 0, 0>  to = <3, 1, 2>  angle = 40deg  blend = 0  intensity = 1 }",
        "light { shape = spot  from = <1, 0, 0>  to = <3, 1, -2>  angle = 150deg  blend = 0  intensity = 1 }",
        "light { shape = quad  from = <0, 0, 0>  to = <1, -1, 0>  size = <.5, 1>  radiance = 1 }",
        "light { shape = disc  from = <0, 0, 0>  to = <0, 0, 9>  radius = .3  radiance = 1 }",
        "light { shape = point  from = <0, 0, 0>  intensity = 1 }",
        "light { shape = sphere  from = <0, 1, 0>  radius = .5  radiance = 1 }",
        "box { size = <1, 1, 1>  surface = surface { emission = 1 } }",
        "torus { radius = 1  tube = .2  surface = surface { emission = 1 } }",
        "medium gas { ior = 1  emission = 1 } box { size = <1, 1, 1>  interior = gas }",
    };
    const Lanes nm = lanes(450, 520, 590, 650);
    for (size_t i = 0; i < COUNT_OF(lights); i++) {
        Fixture f;
        World world;
        Dice dice = {(uint64_t)i + 1};
        open_world(&f, &world, lights[i]);
        int n_shone = 0;
        for (int k = 0; k < 20000; k++) {
            uint32_t emitter = (uint32_t)(dice_unit(&dice) * world.emitters.n);
            float u[2] = {(float)dice_unit(&dice) * 0.999f, (float)dice_unit(&dice) * 0.999f};
            Vec3 from = dice_place(&dice, 4), along = vec3_normalize(dice_place(&dice, 1));
            double begin = 0, end = 5, t = 5 * dice_unit(&dice), rest = dice_unit(&dice);
            Vec3f direction = vec3f_from(along);
            bool reaches = light_reach(&world, emitter, 0, from, direction, &begin, &end);
            Vec3 place = vec3_along(from, t, vec3_from_f(direction));
            const LightQuery query = {.from = place, .rest = rest, .u = {u[0], u[1]}, .wavelength_nm = nm};
            LightSample sample;
            light_sample_emitter(&world, emitter, &query, &sample);
            bool inside = reaches && t > begin + 1e-3 && t < end - 1e-3;
            bool outside = !reaches || t < begin - 1e-3 || t > end + 1e-3;
            n_shone += sample.pdf_w > 0;
            if (outside && sample.pdf_w > 0) fail_msg("%s: shines beyond its reach", lights[i]);
            if (inside && i < 5 && !(sample.pdf_w > 0)) fail_msg("%s: dark within its reach", lights[i]);
            if (!(sample.pdf_w > 0)) continue;
            LightPivot pivot = light_pivot(&world, emitter, 0, rest, u);
            Vec3 seen = vec3_along(place, sample.distance, vec3_from_f(sample.direction));
            LightPivot again = light_pivot_at(&world, emitter, 0, seen);
            double off = vec3_length(vec3_sub(pivot.place, again.place));
            if (off > 0.02 * (1 + sample.distance)) /* grazing, it is taken a little short */
                fail_msg("%s: the pivot is %g beside", lights[i], off);
            assert_true(pivot.softening2 == again.softening2);
        }
        assert_true(n_shone > 500);
        world_clear(&world);
        fixture_clear(&f);
    }
}

/* How often the tree chooses each light for a line, against what it says; and the sum of that. */
static void choices(void **state)
{
    (void)state;
    enum { LIGHTS = 30, TRIALS = 60000 };
    LightBounds bounds[LIGHTS];
    Dice dice = {8};
    for (int i = 0; i < LIGHTS; i++) {
        Vec3 low = dice_place(&dice, 5), high = vec3_add(low, vec3(dice_unit(&dice), dice_unit(&dice), 0.1));
        bounds[i] = (LightBounds){.low = vec3f_from(low),
                                  .high = vec3f_from(high),
                                  .axis = vec3f_from(vec3_normalize(dice_place(&dice, 1))),
                                  .cos_o = i % 3 ? 1 : -1,
                                  .power = i % 7 ? (float)(0.1 + dice_unit(&dice)) : 0,
                                  .two_sided = i % 2};
    }
    LightTree *tree;
    Error error;
    assert_int_equal(light_tree_new(bounds, LIGHTS, NULL, &tree, &error), STATUS_OK);
    for (int k = 0; k < 5; k++) {
        Vec3 from = dice_place(&dice, 5);
        LightLine line = {vec3f_from(from), vec3f_from(vec3_normalize(dice_place(&dice, 1))), 0.5f,
                          0.5f + 3 * (float)k};
        if (k == 0) line.end = 0.6f;
        int counted[LIGHTS] = {0};
        double sum = 0, chi = 0, n = 0;
        for (int i = 0; i < TRIALS; i++) {
            double u = dice_unit(&dice);
            float p;
            uint32_t light = light_tree_choose_along(tree, &line, &u, &p);
            assert_true(light < LIGHTS && u >= 0 && u < 1);
            assert_near((double)p, (double)light_tree_probability_along(tree, light, &line), 1e-6);
            counted[light]++;
        }
        for (uint32_t i = 0; i < LIGHTS; i++) {
            double p = (double)light_tree_probability_along(tree, i, &line), expected = p * TRIALS;
            sum += p;
            assert_true(i % 7 ? p > 0 : p == 0);
            if (expected < 8) continue;
            chi += pow(counted[i] - expected, 2) / expected;
            n++;
            double x = (double)light_tree_middle(tree, i).x;
            assert_near(x, 0.5 * ((double)bounds[i].low.x + (double)bounds[i].high.x), 1e-4);
        }
        assert_near(sum, 1, 1e-4);
        assert_true(chi < n + 4.5 * sqrt(2 * n));
    }
    light_tree_free(tree);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities),
        cmocka_unit_test(reach),
        cmocka_unit_test(choices),
    };
    return cmocka_run_group_tests_name("line_light", tests, NULL, NULL);
}
