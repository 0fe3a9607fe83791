/* pattern_test.c - noise as it is specified, and patterns: ranges, periods, continuity, parts.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "base/hash.h"
#include "near.h"
#include "optics/pattern.h"

static double unit(uint64_t *state)
{
    return hash_to_unit(hash_u64((*state)++));
}

static Vec3 somewhere(uint64_t *state, double reach)
{
    double x = unit(state), y = unit(state), z = unit(state);
    return vec3((2 * x - 1) * reach, (2 * y - 1) * reach, (2 * z - 1) * reach);
}

static double at(const Pattern *pattern, Vec3 p)
{
    PatternPlace place = {.p = p};
    return pattern_at(pattern, &place);
}

static const Pattern all[] = {
    {.kind = PATTERN_CHECKER},
    {.kind = PATTERN_BRICK, .size = {8, 3, 4.5}, .mortar = 0.5, .bond = 0.5},
    {.kind = PATTERN_BRICK, .size = {1, 1, 1}, .mortar = 0.1, .bevel = 0.2},
    {.kind = PATTERN_HEXAGON},
    {.kind = PATTERN_GRADIENT, .frequency = 1},
    {.kind = PATTERN_GRADIENT, .shape = GRADIENT_RADIAL, .wave = WAVE_TRIANGLE, .frequency = 5},
    {.kind = PATTERN_GRADIENT, .shape = GRADIENT_SPHERICAL, .wave = WAVE_SINE, .frequency = -3, .phase = 0.2},
    {.kind = PATTERN_GRADIENT, .shape = GRADIENT_CYLINDRICAL, .wave = WAVE_SCALLOP, .frequency = 2},
    {.kind = PATTERN_GRADIENT, .wave = WAVE_ONCE, .frequency = 0.1},
    {.kind = PATTERN_NOISE, .octaves = 1, .lacunarity = 2, .gain = 0.5},
    {.kind = PATTERN_NOISE, .octaves = 16, .lacunarity = 2, .gain = 0.5, .style = NOISE_TURBULENCE},
    {.kind = PATTERN_NOISE, .octaves = 2, .lacunarity = 16, .gain = 0.1, .style = NOISE_RIDGED},
    {.kind = PATTERN_WOOD, .grain = 1},
    {.kind = PATTERN_GRANITE},
    {.kind = PATTERN_CRACKLE},
    {.kind = PATTERN_CRACKLE, .value = CRACKLE_DISTANCE},
    {.kind = PATTERN_CRACKLE, .value = CRACKLE_CELL},
    {.kind = PATTERN_SPOTS, .radius = 0.3, .blur = 0.1},
    {.kind = PATTERN_AGATE},
    {.kind = PATTERN_NOISE, .octaves = 16, .lacunarity = 16, .gain = 0.3},
};

static void patterns_are_within_0_and_1(void **state)
{
    (void)state;
    static const double reaches[] = {1e-300, 1, 1e3, 1e9, 1e18, 1e300};
    for (size_t i = 0; i < COUNT_OF(all); i++) {
        uint64_t dice = i;
        double least = 1, most = 0;
        for (int k = 0; k < 6000; k++) {
            double value = at(&all[i], somewhere(&dice, k % 2 ? 5 : reaches[(size_t)k / 2 % COUNT_OF(reaches)]));
            if (!(value >= 0 && value <= 1)) fail_msg("pattern %zu is %g", i, value);
            least = fmin(least, value);
            most = fmax(most, value);
        }
        /* and they use it */
        if (!(least < 0.25 && most > 0.75)) fail_msg("pattern %zu is in %g..%g only", i, least, most);
        static const Vec3 odd[] = {{HUGE_VAL, 0, 0}, {0, -HUGE_VAL, 0}, {0, 0, (double)NAN}, {0, 0, 0}};
        for (size_t k = 0; k < COUNT_OF(odd); k++) {
            double value = at(&all[i], odd[k]);
            assert_true(value >= 0 && value <= 1);
        }
    }
}

/* The words of base/noise.h, once more. */
static double specified_noise(Vec3 p, uint64_t seed, unsigned shift)
{
    const double point[3] = {p.x, p.y, p.z};
    double values[8];
    for (unsigned corner = 0; corner < 8; corner++) {
        uint64_t h = hash_u64(seed);
        double offset[3];
        for (int i = 0; i < 3; i++) {
            double cell = floor(point[i]) + (corner >> i & 1);
            h = hash_u64(h ^ (uint64_t)(int64_t)cell);
            offset[i] = point[i] - cell;
        }
        unsigned k = (unsigned)((h >> shift) % 12);
        double first = k / 4 == 0 ? offset[1] : offset[0], second = k / 4 == 2 ? offset[1] : offset[2];
        values[corner] = (k & 1 ? -first : first) + (k & 2 ? -second : second);
    }
    for (int i = 0; i < 3; i++) {
        double t = point[i] - floor(point[i]), w = t * t * t * (t * (t * 6 - 15) + 10);
        for (int k = 0; k < 4 >> i; k++) values[k] = values[2 * k] + (values[2 * k + 1] - values[2 * k]) * w;
    }
    return values[0];
}

static void noise_is_as_specified(void **state)
{
    (void)state;
    uint64_t dice = 7;
    double squares = 0;
    enum { N = 20000 };
    for (int i = 0; i < N; i++) {
        Vec3 p = somewhere(&dice, i % 3 ? 100 : 1e9);
        uint64_t seed = hash_u64((uint64_t)i) >> (i % 64);
        double value = noise_gradient(p, seed);
        assert_near(value, specified_noise(p, seed, 0), 0);
        Vec3 three = noise_gradient3(p, seed);
        assert_near(three.x, value, 0);
        assert_near(three.y, specified_noise(p, seed, 16), 0);
        assert_near(three.z, specified_noise(p, seed, 32), 0);
        squares += value * value;
        Vec3 whole = vec3(floor(p.x), floor(p.y), floor(p.z));
        assert_near(noise_gradient(whole, seed), 0, 0);
    }
    assert_near(sqrt(squares / N), 0.27, 0.005);
    /* it is the same everywhere, for ever */
    assert_near(noise_gradient(vec3(0.5, 0.25, 0.125), 0), specified_noise(vec3(0.5, 0.25, 0.125), 0, 0), 0);
    assert_near(noise_value((double[]){0.5}, 1), (noise_value((double[]){0}, 1) + noise_value((double[]){1}, 1)) / 2,
                1e-15);
}

/* What is continuous does not jump. */
static void smooth_patterns_are_continuous(void **state)
{
    (void)state;
    static const size_t smooth[] = {2, 6, 7, 8, 9, 13, 14, 15, 17, 18};
    const double step = 1e-6;
    for (size_t i = 0; i < COUNT_OF(smooth); i++) {
        uint64_t dice = 100 + i;
        for (int k = 0; k < 20000; k++) {
            Vec3 p = somewhere(&dice, 4), q = vec3_add(p, somewhere(&dice, step));
            double jump = fabs(at(&all[smooth[i]], p) - at(&all[smooth[i]], q));
            /* agate rises like a root from its valleys */
            double bound = all[smooth[i]].kind == PATTERN_AGATE ? 3e-4 : 400 * step;
            if (jump > bound) fail_msg("pattern %zu jumps by %g", smooth[i], jump);
        }
    }
}

static void patterns_repeat(void **state)
{
    (void)state;
    uint64_t dice = 3;
    const Pattern *checker = &all[0], *brick = &all[1], *hexagon = &all[3], *ramp = &all[4], *radial = &all[5];
    const double side = sqrt(3.0);
    for (int k = 0; k < 5000; k++) {
        Vec3 p = somewhere(&dice, 20);
        assert_near(at(checker, vec3_add(p, vec3(1, 0, 0))), 1 - at(checker, p), 0);
        assert_near(at(checker, vec3_add(p, vec3(1, 0, -1))), at(checker, p), 0);
        assert_near(at(brick, vec3_add(p, vec3(8, 6, 9))), at(brick, p), 0);
        assert_near(at(brick, vec3_add(p, vec3(4, 3, 0))), at(brick, p), 0);
        assert_near(at(hexagon, vec3_add(p, vec3(4.5, 5, side * 1.5))), at(hexagon, p), 0);
        assert_near(at(hexagon, vec3_add(p, vec3(0, 0, 3 * side))), at(hexagon, p), 0);
        assert_near(fabs(remainder(at(ramp, vec3_add(p, vec3(1, 2, 3))) - at(ramp, p), 1)), 0, 1e-12);
        double turn = 2 * 3.14159265358979323846 / 5;
        Vec3 turned = vec3(p.x * cos(turn) - p.z * sin(turn), p.y, p.x * sin(turn) + p.z * cos(turn));
        assert_near(at(radial, turned), at(radial, p), 1e-9);
    }
    const double quarter[] = {0.25, 0.5, 0.5, sqrt(0.5), 0.25};
    for (int wave = WAVE_RAMP; wave <= WAVE_ONCE; wave++) {
        assert_near(pattern_wave((PatternWave)wave, 0.25), quarter[wave], 1e-12);
        assert_near(pattern_wave((PatternWave)wave, -0.75), wave == WAVE_ONCE ? 0 : quarter[wave], 1e-12);
        assert_near(pattern_wave((PatternWave)wave, 0), 0, 1e-12);
    }
    assert_near(pattern_wave(WAVE_ONCE, 7), 1, 0);
}

static double mean(const Pattern *pattern, Vec3 normal)
{
    uint64_t dice = 9;
    double sum = 0;
    enum { N = 200000 };
    for (int k = 0; k < N; k++) {
        PatternPlace place = {.p = somewhere(&dice, 36), .normal = normal};
        sum += pattern_at(pattern, &place);
    }
    return sum / N;
}

static void parts_are_as_they_should(void **state)
{
    (void)state;
    assert_near(mean(&all[0], vec3(0, 0, 0)), 0.5, 0.005);
    assert_near(mean(&all[3], vec3(0, 0, 0)), 0.5, 0.005);
    double across = 7.5 / 8, up = 2.5 / 3, deep = 4 / 4.5;
    assert_near(mean(&all[1], vec3(0, 0, 0)), across * up * deep, 0.005);
    assert_near(mean(&all[1], vec3(0, 0, 1)), across * up,
                0.005); /* a wall that faces z shows no joints along itself */
    assert_near(mean(&all[1], vec3(-1, 0, 0)), up * deep, 0.005);
    assert_near(mean(&all[1], vec3(0, 1, 0)), across * deep, 0.005);
}

/* Cells by looking at many more points than can matter. */
static void cells_are_the_nearest(void **state)
{
    (void)state;
    uint64_t dice = 21;
    for (int k = 0; k < 3000; k++) {
        Vec3 p = somewhere(&dice, 50);
        double nearest = HUGE_VAL, second = HUGE_VAL;
        for (int i = 0; i < 343; i++) {
            double cell[3] = {floor(p.x) + i % 7 - 3, floor(p.y) + i / 7 % 7 - 3, floor(p.z) + i / 49 - 3};
            uint64_t h = hash_u64(5);
            for (int c = 0; c < 3; c++) h = hash_u64(h ^ (uint64_t)(int64_t)cell[c]);
            double distance = 0;
            const double at_p[3] = {p.x, p.y, p.z};
            for (int c = 0; c < 3; c++) {
                double d = cell[c] + (double)(h >> (21 * c) & 0x1fffff) / 2097152 - at_p[c];
                distance += d * d;
            }
            if (distance < nearest) {
                second = nearest;
                nearest = distance;
            } else if (distance < second) {
                second = distance;
            }
        }
        PatternCells cells = pattern_cells(p, 5);
        assert_near(cells.nearest, sqrt(nearest), 1e-9);
        assert_near(cells.second, sqrt(second), 1e-9);
    }
}

/* Details that are smaller than the footprint are gone, and the mean stays. */
static void footprints_smooth(void **state)
{
    (void)state;
    for (size_t i = 9; i <= 13; i++) {
        if (all[i].kind == PATTERN_WOOD) continue;
        double sum[2] = {0}, squares[2] = {0};
        enum { N = 20000 };
        for (int far = 0; far < 2; far++) {
            uint64_t dice = 4;
            for (int k = 0; k < N; k++) {
                PatternPlace place = {.p = somewhere(&dice, 50), .footprint = far ? 1e6 : 0};
                double value = pattern_at(&all[i], &place);
                sum[far] += value / N;
                squares[far] += value * value / N;
            }
        }
        assert_near(sum[1], sum[0], 0.06);
        assert_near(squares[1] - sum[1] * sum[1], 0, 1e-9);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns_are_within_0_and_1),
        cmocka_unit_test(noise_is_as_specified),
        cmocka_unit_test(smooth_patterns_are_continuous),
        cmocka_unit_test(patterns_repeat),
        cmocka_unit_test(parts_are_as_they_should),
        cmocka_unit_test(cells_are_the_nearest),
        cmocka_unit_test(footprints_smooth),
    };
    return cmocka_run_group_tests_name("pattern", tests, NULL, NULL);
}
