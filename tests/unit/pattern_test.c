/* pattern_test.c - noise as it is specified, and patterns: ranges, periods, continuity, parts.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "dice.h"
#include "near.h"
#include "optics/pattern.h"

static double mean_at(const Pattern *pattern, const PatternPlace *place)
{
    PatternParts parts;
    pattern_parts(pattern, place, &parts);
    double sum = 0;
    for (int i = 0; i < parts.n; i++) sum += parts.part[i] * parts.value[i];
    return sum;
}

static double at(const Pattern *pattern, Vec3 p)
{
    PatternPlace place = {.p = p};
    return mean_at(pattern, &place);
}

static Vec3 axis_of(int k)
{
    return vec3(k % 4 == 1, k % 4 == 2, k % 4 == 3); /* and none */
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
        Dice dice = {i};
        double least = 1, most = 0;
        for (int k = 0; k < 6000; k++) {
            double value = at(&all[i], dice_point(&dice, k % 2 ? 5 : reaches[(size_t)k / 2 % COUNT_OF(reaches)]));
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
    Dice dice = {7};
    double squares = 0;
    enum { N = 20000 };
    for (int i = 0; i < N; i++) {
        Vec3 p = dice_point(&dice, i % 3 ? 100 : 1e9);
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
}

static double specified_value_at(const double *whole, unsigned n)
{
    uint64_t h = 0x6e6f697365U;
    for (unsigned i = 0; i < n; i++) h = hash_u64(h ^ (uint64_t)(int64_t)whole[i]);
    return 2 * hash_to_unit(h) - 1;
}

static double near_weight(double t, double s)
{
    return s * ((1 + t) + t * t * t * (3 * t - 4.5));
}

static double far_weight(double t, double s)
{
    return t * s * (s * s) * (-.5 - t);
}

/* Mixed along the last axis by what is found for four of its whole numbers; x is mixed first. */
static double specified_mix(const double *point, double *whole, unsigned n, unsigned axes)
{
    if (axes == 0) return specified_value_at(whole, n);
    unsigned axis = axes - 1;
    double low = floor(point[axis]), t = point[axis] - low, s = 1 - t, v[4];
    for (int i = 0; i < 4; i++) {
        whole[axis] = low + (i - 1);
        v[i] = specified_mix(point, whole, n, axis);
    }
    return (far_weight(t, s) * v[0] + far_weight(s, t) * v[3]) + (near_weight(t, s) * v[1] + near_weight(s, t) * v[2]);
}

static double specified_value(const double *point, unsigned n)
{
    double whole[3], v = specified_mix(point, whole, n, n), x = (fabs(v) - .8) / .2;
    double drawn_in = .8 + .2 * (x / sqrt(1 + x * x));
    return x <= 0 ? v : v < 0 ? -drawn_in : drawn_in;
}

/* However places follow one another: near ones, ones that lie far apart, in cells of the same place in what is kept, too. */
static void values_are_as_specified(void **state)
{
    (void)state;
    Dice dice = {11};
    for (int i = 0; i < 100000; i++) {
        static const double reaches[] = {0.9, 3, 40, 1e4, 1e9, 1e15};
        Vec3 p = dice_point(&dice, reaches[i % 6]);
        if (i % 5 == 0) p.x = floor(p.x);
        if (i % 7 == 0) p = vec3(-0.0, 256 * dice_below(&dice, 9) - 1024.0, 0.5 - (i & 1));
        for (unsigned n = 1; n <= 3; n++) {
            double point[3] = {p.x, p.y, p.z};
            assert_near(noise_value(point, n), specified_value(point, n), 0);
        }
    }
}

/* The weights are those of the quintic with central differences, as they are written in powers. */
static void weights_are_those_of_a_quintic(void **state)
{
    (void)state;
    for (int i = 0; i <= 1000; i++) {
        double t = i / 1000.0, s = 1 - t, t2 = t * t, t3 = t2 * t, t4 = t3 * t, t5 = t4 * t;
        assert_near(far_weight(t, s), -t / 2 + t2 / 2 + 3 * t3 / 2 - 5 * t4 / 2 + t5, 1e-15);
        assert_near(near_weight(t, s), 1 - t2 - 9 * t3 / 2 + 15 * t4 / 2 - 3 * t5, 4e-15);
        assert_near(far_weight(t, s) + near_weight(t, s) + near_weight(s, t) + far_weight(s, t), 1, 1e-15);
    }
}

/* The first and the second derivative along an axis of what lies on one side of a point. */
static void derivatives(const double *point, unsigned n, unsigned axis, double step, double derivative[2])
{
    double f[4], at[3];
    memcpy(at, point, sizeof at);
    for (int i = 0; i < 4; i++) {
        at[axis] = point[axis] + i * step;
        f[i] = noise_value(at, n);
    }
    derivative[0] = (-11 * f[0] + 18 * f[1] - 9 * f[2] + 2 * f[3]) / (6 * step);
    derivative[1] = (2 * f[0] - 5 * f[1] + 4 * f[2] - f[3]) / (step * step);
}

/* At whole numbers, too, both derivatives are the same on both sides; and there the slopes are not 0, as of a fade. */
static void values_have_no_creases(void **state)
{
    (void)state;
    enum { N = 20000 };
    Dice dice = {12};
    double squares[3] = {0}, slopes[3] = {0};
    for (int i = 0; i < N; i++)
        for (unsigned n = 1; n <= 3; n++) {
            unsigned axis = (unsigned)dice_below(&dice, (int)n);
            Vec3 p = dice_point(&dice, 1000);
            double point[3] = {p.x, p.y, p.z}, before[2], after[2], value = noise_value(point, n);
            squares[n - 1] += value * value / N;
            assert_true(fabs(value) <= 1);
            point[axis] = round(point[axis]);
            derivatives(point, n, axis, -1e-4, before);
            derivatives(point, n, axis, 1e-4, after);
            assert_near(before[0], after[0], 1e-6);
            assert_near(before[1], after[1], 1e-2);
            slopes[n - 1] += after[0] * after[0] / N;
        }
    static const double rms[3] = {0.517, 0.477, 0.436}, rms_slope[3] = {0.385, 0.364, 0.337};
    for (int k = 0; k < 3; k++) {
        assert_near(sqrt(squares[k]), rms[k], 0.01);
        assert_near(sqrt(slopes[k]), rms_slope[k], 0.01);
    }
}

static void random_box(Dice *dice, double low[3], double high[3])
{
    Vec3 p = dice_point(dice, dice_below(dice, 2) ? 3 : 1e6);
    const double at[3] = {p.x, p.y, p.z}, size = pow(10, -4 * dice_unit(dice)) * 2;
    for (int i = 0; i < 3; i++) {
        low[i] = dice_below(dice, 3) ? at[i] : floor(at[i]);
        high[i] = low[i] + size * dice_below(dice, 4) / 3;
        if (dice_below(dice, 4) == 0) high[i] = ceil(high[i]);
    }
}

/* They are never too narrow, and close to what there is where a box is small. */
static void bounds_of_values(void **state)
{
    (void)state;
    Dice dice = {13};
    double excess = 0, n_small = 0;
    int n_known = 0;
    for (int i = 0; i < 20000; i++) {
        unsigned n = 1 + (unsigned)i % 3;
        double low[3], high[3], point[3], least, most, found[2] = {1, -1}, size = 0;
        random_box(&dice, low, high);
        if (!noise_bounds(low, high, n, &least, &most)) continue;
        n_known++;
        for (int k = 0; k < 64; k++) {
            for (unsigned axis = 0; axis < n; axis++) {
                size = fmax(size, high[axis] - low[axis]);
                double part = dice_below(&dice, 2) ? dice_below(&dice, 2) : dice_unit(&dice);
                point[axis] = fmin(low[axis] + part * (high[axis] - low[axis]), high[axis]);
            }
            double value = noise_value(point, n);
            if (!(value >= least - 1e-13 && value <= most + 1e-13))
                fail_msg("%.17g, bounds %.17g .. %.17g", value, least, most);
            found[0] = fmin(found[0], value);
            found[1] = fmax(found[1], value);
        }
        if (size > 0.03 || size == 0) continue;
        excess += ((most - least) - (found[1] - found[0])) / size;
        n_small++;
    }
    assert_true(n_known > 10000 && n_small > 1000 && excess / n_small < 0.01);
}

/* What is continuous does not jump. */
static void smooth_patterns_are_continuous(void **state)
{
    (void)state;
    static const size_t smooth[] = {2, 6, 7, 8, 9, 13, 14, 15, 17, 18};
    const double step = 1e-6;
    for (size_t i = 0; i < COUNT_OF(smooth); i++) {
        Dice dice = {100 + i};
        for (int k = 0; k < 20000; k++) {
            Vec3 p = dice_point(&dice, 4), q = vec3_add(p, dice_point(&dice, step));
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
    Dice dice = {3};
    const Pattern *checker = &all[0], *brick = &all[1], *hexagon = &all[3], *ramp = &all[4], *radial = &all[5];
    const double side = sqrt(3.0);
    for (int k = 0; k < 5000; k++) {
        Vec3 p = dice_point(&dice, 20);
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
    Dice dice = {9};
    double sum = 0;
    enum { N = 200000 };
    for (int k = 0; k < N; k++) {
        PatternPlace place = {.p = dice_point(&dice, 36), .normal = normal};
        sum += mean_at(pattern, &place);
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
    Dice dice = {21};
    for (int k = 0; k < 3000; k++) {
        Vec3 p = dice_point(&dice, 50);
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
            Dice dice = {4};
            for (int k = 0; k < N; k++) {
                PatternPlace place = {.p = dice_point(&dice, 50), .footprint = far ? 1e6 : 0};
                double value = mean_at(&all[i], &place);
                sum[far] += value / N;
                squares[far] += value * value / N;
            }
        }
        assert_near(sum[1], sum[0], 0.06);
        assert_near(squares[1] - sum[1] * sum[1], 0, 1e-9);
    }
}

/* Over all of a pattern that is smaller than the footprint the parts tell how often it is above what: a ramp with steps has the same
 * mean from far away as close up. With their mean alone all of it was on one side of a step: up to a half too much or too little. */
static void check_parts(const char *name, const Pattern *pattern)
{
    enum { N = 20000, THRESHOLDS = 8 };
    double above[2][THRESHOLDS] = {{0}}, most = 0, sum = 0;
    Dice dice = {4};
    for (int k = 0; k < N; k++) {
        PatternPlace place = {.p = dice_point(&dice, 50)};
        double value = mean_at(pattern, &place);
        for (int i = 0; i < THRESHOLDS; i++) above[0][i] += (value > (i + 0.5) / THRESHOLDS) * 1.0 / N;
    }
    PatternParts parts;
    pattern_parts(pattern, &(PatternPlace){.p = vec3(1, 2, 3), .footprint = 1e6}, &parts);
    for (int k = 0; k < parts.n; k++)
        for (int i = 0; i < THRESHOLDS; i++) above[1][i] += (parts.value[k] > (i + 0.5) / THRESHOLDS) * parts.part[k];
    for (int i = 0; i < THRESHOLDS; i++) {
        double off = fabs(above[1][i] - above[0][i]);
        most = fmax(most, off);
        sum += off / THRESHOLDS;
    }
    printf("    %s: %d parts, above thresholds by %.3f in the mean and %.3f at most\n", name, parts.n, sum, most);
    assert_true(most < 0.15 && sum < 0.06); /* a seventh is one part */
}

static void patterns_keep_their_parts(void **state)
{
    (void)state;
    for (int style = NOISE_SMOOTH; style <= NOISE_RIDGED; style++)
        for (unsigned octaves = 1; octaves <= 5; octaves += 2) {
            char name[40];
            snprintf(name, sizeof name, "style %d, %u octaves", style, octaves);
            check_parts(name, &(Pattern){.kind = PATTERN_NOISE,
                                         .style = (NoiseStyle)style,
                                         .octaves = octaves,
                                         .lacunarity = 2,
                                         .gain = 0.5,
                                         .seed = 5});
        }
    check_parts("borders", &(Pattern){.kind = PATTERN_CRACKLE, .value = CRACKLE_BORDER, .seed = 5});
    check_parts("distances", &(Pattern){.kind = PATTERN_CRACKLE, .value = CRACKLE_DISTANCE, .seed = 5});
    check_parts("granite", &(Pattern){.kind = PATTERN_GRANITE, .seed = 5});
    check_parts("agate", &(Pattern){.kind = PATTERN_AGATE, .seed = 5});
    check_parts("wood", &(Pattern){.kind = PATTERN_WOOD, .seed = 5});
    for (int wave = WAVE_RAMP; wave <= WAVE_SCALLOP; wave++)
        check_parts("waves", &(Pattern){.kind = PATTERN_GRADIENT, .wave = (PatternWave)wave, .frequency = 1.3});
}

/* The mean of a pattern at points all over a box of a width, along two directions. */
static double sampled(const Pattern *pattern, const PatternPlace *place, Vec3 across, Vec3 up)
{
    enum { SIDE = 40 };
    double sum = 0;
    for (int i = 0; i < SIDE; i++)
        for (int k = 0; k < SIDE; k++) {
            PatternPlace point = {.p = place->p, .normal = place->normal};
            point.p = vec3_along(point.p, ((i + 0.5) / SIDE - 0.5) * place->footprint, across);
            point.p = vec3_along(point.p, ((k + 0.5) / SIDE - 0.5) * place->footprint, up);
            sum += mean_at(pattern, &point);
        }
    return sum / (SIDE * SIDE);
}

/* On a surface across an axis the integral over a footprint is the mean of points in it, for every width. */
static void footprints_are_averaged(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        Pattern pattern;
        int axis;     /* of the surface's normal */
        double bound; /* of the root mean square difference */
    } cases[] = {
        {"checker", {.kind = PATTERN_CHECKER}, 1, 0.012},
        {"brick", {.kind = PATTERN_BRICK, .size = {2, 0.7, 1}, .mortar = 0.1, .bond = 0.5}, 2, 0.012},
        {"brick from above", {.kind = PATTERN_BRICK, .size = {2, 0.7, 1}, .mortar = 0.1, .bond = 0.5}, 1, 0.012},
        {"bevelled brick",
         {.kind = PATTERN_BRICK, .size = {2, 0.7, 1}, .mortar = 0.05, .bevel = 0.1, .bond = 0.3},
         2,
         0.02},
        {"hexagon", {.kind = PATTERN_HEXAGON}, 1, 0.05},
        {"ramp", {.kind = PATTERN_GRADIENT, .frequency = 1.3}, 1, 0.012},
        {"triangle", {.kind = PATTERN_GRADIENT, .wave = WAVE_TRIANGLE, .frequency = 2}, 1, 0.01},
        {"sine", {.kind = PATTERN_GRADIENT, .wave = WAVE_SINE, .frequency = 2, .phase = 0.3}, 2, 0.01},
        {"scallop", {.kind = PATTERN_GRADIENT, .wave = WAVE_SCALLOP, .frequency = 1}, 1, 0.01},
        {"once", {.kind = PATTERN_GRADIENT, .wave = WAVE_ONCE, .frequency = 0.2}, 1, 0.01},
        {"rings", {.kind = PATTERN_GRADIENT, .shape = GRADIENT_CYLINDRICAL, .frequency = 1}, 1, 0.1},
        {"wood", {.kind = PATTERN_WOOD}, 2, 0.1},
        {"cells", {.kind = PATTERN_CRACKLE, .value = CRACKLE_CELL}, 1, 0.09},
        {"spots", {.kind = PATTERN_SPOTS, .radius = 0.4}, 1, 0.11},
    };
    const Vec3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    enum { PLACES = 250 };
    for (size_t c = 0; c < COUNT_OF(cases); c++) {
        Dice dice = {50 + c};
        double squares = 0, bias = 0;
        for (int i = 0; i < PLACES; i++) {
            double width = 0.02 * pow(200, dice_unit(&dice)); /* 0.02 to 4 */
            PatternPlace place = {.p = dice_point(&dice, 20), .normal = axes[cases[c].axis], .footprint = width};
            double found = mean_at(&cases[c].pattern, &place);
            double wanted =
                sampled(&cases[c].pattern, &place, axes[(cases[c].axis + 1) % 3], axes[(cases[c].axis + 2) % 3]);
            squares += (found - wanted) * (found - wanted) / PLACES;
            bias += (found - wanted) / PLACES;
        }
        printf("%-18s footprints of .02 to 4: off by %.4f, in the mean by %+.4f\n", cases[c].name, sqrt(squares), bias);
        assert_true(sqrt(squares) < cases[c].bound);
        assert_true(fabs(bias) < 0.02);
    }
}

/* Of a footprint over an edge both values are told, not what is between them. */
static void parts_of_a_footprint(void **state)
{
    (void)state;
    Dice dice = {9};
    for (size_t i = 0; i < COUNT_OF(all); i++)
        for (int k = 0; k < 3000; k++) {
            PatternParts parts;
            PatternPlace place = {.p = dice_point(&dice, k % 3 ? 9 : 1e6),
                                  .normal = axis_of(k),
                                  .footprint = pow(10, 4 * dice_unit(&dice) - 3)};
            pattern_parts(&all[i], &place, &parts);
            double sum = 0;
            assert_true(parts.n >= 1 && parts.n <= PATTERN_MOST_PARTS);
            for (int n = 0; n < parts.n; n++) {
                assert_true(parts.value[n] >= 0 && parts.value[n] <= 1 && parts.part[n] > 0);
                sum += parts.part[n];
                bool hard = all[i].kind == PATTERN_CHECKER || (all[i].kind == PATTERN_BRICK && !(all[i].bevel > 0));
                if (hard) assert_true(parts.value[n] == 0 || parts.value[n] == 1);
                if (all[i].kind == PATTERN_HEXAGON) assert_near(2 * parts.value[n], round(2 * parts.value[n]), 0);
            }
            assert_near(sum, 1, 1e-9);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(patterns_are_within_0_and_1),
        cmocka_unit_test(noise_is_as_specified),
        cmocka_unit_test(values_are_as_specified),
        cmocka_unit_test(weights_are_those_of_a_quintic),
        cmocka_unit_test(values_have_no_creases),
        cmocka_unit_test(bounds_of_values),
        cmocka_unit_test(smooth_patterns_are_continuous),
        cmocka_unit_test(patterns_repeat),
        cmocka_unit_test(parts_are_as_they_should),
        cmocka_unit_test(cells_are_the_nearest),
        cmocka_unit_test(footprints_smooth),
        cmocka_unit_test(patterns_keep_their_parts),
        cmocka_unit_test(footprints_are_averaged),
        cmocka_unit_test(parts_of_a_footprint),
    };
    return cmocka_run_group_tests_name("pattern", tests, NULL, NULL);
}
