/* light_tree_test.c - choosing among lights: the probabilities are those of a distribution, no light that shines to a
 * place is left out, and the choice is worth its while; areas of pieces and points on them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "base/clock.h"
#include "base/hash.h"
#include "shape/piece.h"
#include "trace/light_tree.h"

static const double pi = 3.14159265358979323846;

static uint64_t dice_state = 1;
static double dice(void)
{
    return hash_to_unit(hash_u64(dice_state++));
}
static Vec3 dice_direction(void)
{
    double y = 2 * dice() - 1, angle = 2 * pi * dice(), r = sqrt(1 - y * y);
    return vec3(r * cos(angle), y, r * sin(angle));
}
static Vec3 dice_point(double size)
{
    return vec3(size * (dice() - 0.5), size * (dice() - 0.5), size * (dice() - 0.5));
}

/* A small flat light. */
typedef struct Lamp {
    Vec3 corner[3], normal;
    bool two_sided;
} Lamp;

static LightBounds bounds_of(const Lamp *lamp, double power)
{
    Box3 box = box3_empty();
    for (int i = 0; i < 3; i++) box = box3_add_point(box, lamp->corner[i]);
    return (LightBounds){.low = vec3f_from(box.min),
                         .high = vec3f_from(box.max),
                         .axis = vec3f_from(lamp->normal),
                         .cos_o = 1,
                         .cos_e = 0,
                         .power = (float)power,
                         .two_sided = lamp->two_sided};
}

static Lamp make_lamp(Vec3 place, double size)
{
    Lamp lamp = {.two_sided = dice() < 0.2};
    for (int i = 0; i < 3; i++) lamp.corner[i] = vec3_add(place, dice_point(size));
    lamp.normal =
        vec3_normalize(vec3_cross(vec3_sub(lamp.corner[1], lamp.corner[0]), vec3_sub(lamp.corner[2], lamp.corner[0])));
    return lamp;
}

/* Whether some of the lamp shines onto a surface at the place. */
static bool shines(const Lamp *lamp, Vec3 place, Vec3 normal)
{
    Vec3 to = vec3_sub(lamp->corner[0], place);
    double cosine = -vec3_dot(to, lamp->normal);
    if (lamp->two_sided) cosine = fabs(cosine);
    if (!(cosine > 1e-5 * vec3_length(to))) return false;
    if (vec3_length(normal) == 0) return true;
    for (int i = 0; i < 3; i++)
        if (vec3_dot(vec3_sub(lamp->corner[i], place), normal) > 1e-5) return true;
    return false;
}

static void probabilities(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 3, 17, 300};
    static Lamp lamps[300];
    static LightBounds bounds[300];
    for (size_t c = 0; c < COUNT_OF(counts); c++)
        for (int kind = 0; kind < 3; kind++) { /* scattered; in a line; all at one place */
            uint32_t n = counts[c];
            for (uint32_t i = 0; i < n; i++) {
                Vec3 place = kind == 0 ? dice_point(10) : kind == 1 ? vec3(0.1 * i, 0, 0) : vec3(1, 1, 1);
                lamps[i] = make_lamp(place, 0.5);
                bounds[i] = bounds_of(&lamps[i], i % 7 == 6 ? 0 : 0.1 + dice());
            }
            LightTree *tree;
            Error error;
            assert_int_equal(light_tree_new(bounds, n, NULL, &tree, &error), STATUS_OK);
            for (int k = 0; k < 200; k++) {
                Vec3 place = dice_point(12), normal = k % 3 ? dice_direction() : vec3(0, 0, 0);
                double sum = 0;
                bool any = false;
                for (uint32_t i = 0; i < n; i++) {
                    double p = (double)light_tree_probability(tree, i, place, vec3f_from(normal));
                    sum += p;
                    if (!(bounds[i].power > 0)) assert_true(p == 0);
                    if (!(bounds[i].power > 0) || !shines(&lamps[i], place, normal)) continue;
                    assert_true(p > 0);
                    any = true;
                }
                float p;
                double u = dice();
                uint32_t chosen = light_tree_choose(tree, place, vec3f_from(normal), &u, &p);
                assert_true(u >= 0 && u < 1);
                if (chosen == LIGHT_TREE_NONE) continue; /* went down where nothing shines; the rest of the sum */
                assert_near((double)p, (double)light_tree_probability(tree, chosen, place, vec3f_from(normal)),
                            1e-5 * (double)p);
                assert_true(sum < 1 + 1e-5);
                if (n <= 3 && any) assert_true(sum > 0.999); /* all are compared at once */
            }
            light_tree_free(tree);
        }
}

/* How often each light is chosen is how often the tree says it is. */
static void frequencies(void **state)
{
    (void)state;
    enum { N = 40, TRIALS = 400000 };
    Lamp lamps[N];
    LightBounds bounds[N];
    uint32_t count[N] = {0};
    for (int i = 0; i < N; i++) {
        lamps[i] = make_lamp(dice_point(10), 1);
        bounds[i] = bounds_of(&lamps[i], 0.1 + dice());
    }
    LightTree *tree;
    Error error;
    assert_int_equal(light_tree_new(bounds, N, NULL, &tree, &error), STATUS_OK);
    Vec3 place = vec3(0.3, -4, 1);
    Vec3f normal = vec3f(0, 1, 0);
    for (int i = 0; i < TRIALS; i++) {
        float p;
        double u = (i + 0.5) / TRIALS;
        uint32_t chosen = light_tree_choose(tree, place, normal, &u, &p);
        if (chosen != LIGHT_TREE_NONE) count[chosen]++;
    }
    for (uint32_t i = 0; i < N; i++)
        assert_near((double)count[i] / TRIALS, (double)light_tree_probability(tree, i, place, normal),
                    2.0 / TRIALS + 1e-6);
    light_tree_free(tree);
}

/* A grid of equal lamps that shine down on a floor: the variance of one choice, which is known exactly, against that of
 * choosing by power alone. */
static void worth_its_while(void **state)
{
    (void)state;
    enum { SIDE = 40, N = SIDE * SIDE };
    static LightBounds bounds[N];
    static Vec3 places[N];
    for (int i = 0; i < N; i++) {
        places[i] = vec3(i % SIDE - SIDE / 2.0, 0.3, i / SIDE - SIDE / 2.0);
        Vec3f p = vec3f_from(places[i]);
        bounds[i] = (LightBounds){.low = p, .high = p, .axis = {0, -1, 0}, .cos_o = 1, .cos_e = 0, .power = 1};
    }
    LightTree *tree;
    Error error;
    assert_int_equal(light_tree_new(bounds, N, NULL, &tree, &error), STATUS_OK);
    double by_tree = 0, by_power = 0;
    for (int k = 0; k < 200; k++) {
        Vec3 from = vec3((dice() - 0.5) * SIDE, 0, (dice() - 0.5) * SIDE);
        double sum = 0, square = 0, even = 0;
        for (uint32_t i = 0; i < N; i++) {
            Vec3 to = vec3_sub(places[i], from);
            double d2 = vec3_dot(to, to), f = to.y * to.y / (d2 * d2);
            sum += f;
            square += f * f / (double)light_tree_probability(tree, i, from, vec3f(0, 1, 0));
            even += f * f * N;
        }
        by_tree += (square - sum * sum) / (sum * sum);
        by_power += (even - sum * sum) / (sum * sum);
    }
    light_tree_free(tree);
    print_message("      %d lamps: relative variance %.2f by the tree, %.1f by power\n", N, by_tree / 200,
                  by_power / 200);
    assert_true(by_tree < by_power / 25);
}

/* Many triangles of a ball: how long the building and a choice take (printed; the limits are far off). */
static void many(void **state)
{
    (void)state;
    enum { N = 100000, CHOICES = 200000 };
    LightBounds *bounds = malloc(N * sizeof *bounds);
    assert_non_null(bounds);
    for (int i = 0; i < N; i++) {
        Vec3 normal = dice_direction();
        Lamp lamp = make_lamp(vec3_scale(normal, 10), 0.05);
        bounds[i] = bounds_of(&lamp, 1);
        bounds[i].axis = vec3f_from(normal);
        bounds[i].two_sided = false;
    }
    LightTree *tree;
    Error error;
    double begin = clock_now_s();
    assert_int_equal(light_tree_new(bounds, N, NULL, &tree, &error), STATUS_OK);
    double built = clock_now_s();
    double sum = 0;
    for (int i = 0; i < CHOICES; i++) {
        float p;
        Vec3 normal = dice_direction();
        double u = dice();
        if (light_tree_choose(tree, vec3_scale(dice_direction(), 12 + 5 * dice()), vec3f_from(normal), &u, &p) !=
            LIGHT_TREE_NONE)
            sum += (double)p;
    }
    double chosen = clock_now_s();
    assert_true(sum > 0);
    print_message("      %d lights: built in %.0f ms, a choice in %.0f ns\n", N, 1e3 * (built - begin),
                  1e9 * (chosen - built) / CHOICES);
    assert_true(chosen - built < 20e-6 * CHOICES);
    light_tree_free(tree);
    free(bounds);
}

/* The tree is the same whoever builds it. */
static void threads(void **state)
{
    (void)state;
    enum { N = 20000 };
    LightBounds *bounds = malloc(N * sizeof *bounds);
    assert_non_null(bounds);
    for (int i = 0; i < N; i++) {
        Lamp lamp = make_lamp(dice_point(i % 3 ? 10 : 0.1), 0.05);
        bounds[i] = bounds_of(&lamp, 0.1 + dice());
    }
    LightTree *alone, *together;
    Pool *pool;
    Error error;
    assert_int_equal(pool_new(3, &pool, &error), STATUS_OK);
    assert_int_equal(light_tree_new(bounds, N, NULL, &alone, &error), STATUS_OK);
    assert_int_equal(light_tree_new(bounds, N, pool, &together, &error), STATUS_OK);
    for (int k = 0; k < 20000; k++) {
        float p, q;
        Vec3 place = dice_point(12);
        Vec3f normal = vec3f_from(k % 2 ? dice_direction() : vec3(0, 0, 0));
        double u = dice();
        double v = u;
        uint32_t chosen = light_tree_choose(alone, place, normal, &u, &p);
        assert_int_equal(light_tree_choose(together, place, normal, &v, &q), chosen);
        assert_true(p == q && u == v);
        if (chosen != LIGHT_TREE_NONE) assert_true(light_tree_probability(together, chosen, place, normal) == p);
    }
    light_tree_free(alone);
    light_tree_free(together);
    pool_free(pool);
    free(bounds);
}

/* Lights that halve in distance to one corner, and thousands at one place: no tree is too deep for its builder. */
static void steep(void **state)
{
    (void)state;
    enum { N = 6000 };
    static LightBounds bounds[N];
    for (int i = 0; i < N; i++) {
        double d = i < 1000 ? ldexp(1, -i % 140) * (i % 3 == 0 ? 1 : 1.3) : 0;
        Vec3f p = i < N - 500 ? vec3f_from(vec3(d, i % 2 ? d : 0, 0)) : vec3f((float)i, 0, 0);
        bounds[i] = (LightBounds){.low = p, .high = p, .axis = {0, 1, 0}, .cos_o = -1, .cos_e = 0, .power = 1};
    }
    LightTree *tree;
    Error error;
    assert_int_equal(light_tree_new(bounds, N, NULL, &tree, &error), STATUS_OK);
    double sum = 0;
    for (uint32_t i = 0; i < N; i++) sum += (double)light_tree_probability(tree, i, vec3(-3, 1, 2), vec3f(0, 0, 0));
    assert_near(sum, 1, 1e-4);
    light_tree_free(tree);
}

/* ---- pieces ---- */

/* Areas by a fine sum over the profile that the samples themselves draw: the radius at the middle of equal shares of u is
 * where equal shares of area are. */
static void pieces(void **state)
{
    (void)state;
    const struct {
        const char *what;
        Piece piece;
        double area, mean_y; /* of the area */
    } cases[] = {
        {"sphere", {.kind = PIECE_SPHERE, .r0 = 2}, 16 * pi, 0},
        {"cylinder", piece_make_band(2, 1, 2, 4), 12 * pi, 2.5},
        {"disc", piece_make_band(3, 1, 0, 1), 9 * pi, 1},
        {"ring, facing down", piece_make_band(1, 1, 3, 1), 8 * pi, 1},
        {"cone", piece_make_band(3, 0, 0, 4), 15 * pi, 4.0 / 3},
        {"torus", {.kind = PIECE_TORUS, .r0 = 3, .r1 = 1}, 12 * pi * pi, 0},
        /* 4 pi r1 (r0 t + r1 sin t), cos t = -r0 / r1 = -1/2 */
        {"torus without a hole", {.kind = PIECE_TORUS, .r0 = 1, .r1 = 2}, 8 * pi * (2 * pi / 3 + sqrt(3)), 0},
        {"half a sphere",
         {.kind = PIECE_OUTER_ARC, .r0 = 2, .y0 = 0, .r1 = 0, .y1 = 2, .centre_r = 0, .centre_y = 0},
         8 * pi,
         1},
        /* outer half of a torus: 2 pi (pi R r + 2 r^2) */
        {"outside of a torus",
         {.kind = PIECE_OUTER_ARC, .r0 = 3, .y0 = -1, .r1 = 3, .y1 = 1, .centre_r = 3, .centre_y = 0},
         2 * pi * (3 * pi + 2),
         0},
        {"inside of a torus",
         {.kind = PIECE_INNER_ARC, .r0 = 3, .y0 = 1, .r1 = 3, .y1 = -1, .centre_r = 3, .centre_y = 0},
         2 * pi * (3 * pi - 2),
         0},
        {"rectangle", {.kind = PIECE_RECT, .r0 = 2, .r1 = 3}, 24, 0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        enum { STEPS = 4000 };
        const Piece *piece = &cases[i].piece;
        assert_near(piece_area(piece), cases[i].area, 1e-9 * cases[i].area);
        double sum_y = 0;
        for (int k = 0; k < STEPS; k++) {
            double turn = dice(), found[2];
            Vec3 normal, p = piece_sample(piece, (k + 0.5) / STEPS, turn, &normal);
            sum_y += p.y / STEPS;
            piece_find(piece, p, found);
            assert_near(found[0], (k + 0.5) / STEPS, 1e-7);
            assert_near(found[1], turn, 1e-7);
            assert_near(vec3_length(normal), 1, 1e-9);
            /* a line along the normal meets the piece there, and its normal is the same */
            double t[PIECE_MAX_ROOTS], nearest = HUGE_VAL, at = 0;
            Vec3 start = vec3_along(p, 0.25, normal), back = vec3_scale(normal, -1);
            int n = piece_intersect(piece, start, back, 0, 10, t);
            for (int j = 0; j < n; j++)
                if (fabs(t[j] - 0.25) < nearest) {
                    nearest = fabs(t[j] - 0.25);
                    at = t[j];
                }
            assert_true(nearest < 1e-6);
            assert_true(vec3_dot(piece_normal(piece, start, back, at), normal) > 1 - 1e-5);
        }
        assert_near(sum_y, cases[i].mean_y, 2e-3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(probabilities), cmocka_unit_test(frequencies), cmocka_unit_test(worth_its_while),
        cmocka_unit_test(many),          cmocka_unit_test(threads),     cmocka_unit_test(steep),
        cmocka_unit_test(pieces),
    };
    return cmocka_run_group_tests_name("light tree", tests, NULL, NULL);
}
