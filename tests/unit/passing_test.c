/* passing_test.c - a search that passes by silent surfaces finds what a search from surface to surface does.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"

/* What is met along one line: each surface in order, and whether it was silent. */
typedef struct Met {
    uint32_t object;
    bool entering, silent;
    double t;
} Met;
enum { MOST = 200 };

typedef struct Walker {
    const CompiledScene *compiled;
    HitList hits, passed;
    NestList list;
    int searches;
} Walker;

static void cross(Walker *walker, const Hit *hits, size_t n, Met *met, int *n_met)
{
    NestPass passes[16];
    NestCrossing crossing = {0};
    uint32_t n_passes = 0;
    assert_true(n <= COUNT_OF(passes));
    for (size_t i = 0; i < n; i++) {
        uint32_t hull = walker->compiled->hull_of_object[hits[i].object];
        if (hull != SCENE_NONE) passes[n_passes++] = (NestPass){hull, hits[i].entering};
    }
    if (n_passes)
        assert_int_equal(nest_cross(&walker->list, &walker->compiled->order, passes, n_passes, &crossing), STATUS_OK);
    assert_int_equal(crossing.n_faults, 0);
    for (size_t i = 0; i < n && *n_met < MOST; i++)
        met[(*n_met)++] =
            (Met){hits[i].object, hits[i].entering, crossing.medium_from == crossing.medium_to, hits[i].t};
}

/* All surfaces along a ray that starts in the open, until it leaves the scene. Returns how many. */
static int walk(Walker *walker, Ray ray, bool passing, Met *met)
{
    int n_met = 0;
    nest_list_empty(&walker->list);
    for (size_t n = 1; n;) {
        if (passing) compiled_let_pass(walker->compiled, &walker->list, &ray);
        n = rtc_nearest(walker->compiled->rtc, &ray, &walker->hits, &walker->passed);
        walker->searches++;
        for (size_t i = 0, cluster; i < walker->passed.n; i += cluster) {
            const Hit *hits = &walker->passed.items[i];
            cluster = rtc_cluster(hits, walker->passed.n - i);
            int before = n_met;
            cross(walker, hits, cluster, met, &n_met);
            for (; before < n_met; before++) assert_true(met[before].silent);
        }
        cross(walker, walker->hits.items, n, met, &n_met);
        if (n) ray.t_min = walker->hits.items[n - 1].t;
    }
    return n_met;
}

/* Random lines through a scene, both ways of looking. Returns the searches of the one over those of the other. */
static double compare(const char *text, int n_rays)
{
    Fixture fixture;
    fixture_compile(&fixture, text, 1);
    Walker walker = {.compiled = fixture.compiled}, other = {.compiled = fixture.compiled};
    nest_list_init(&walker.list);
    nest_list_init(&other.list);
    Dice dice = {3};
    int total = 0;
    for (int i = 0; i < n_rays; i++) {
        Vec3 from = vec3(200 * dice_unit(&dice) - 100, 300, 200 * dice_unit(&dice) - 100);
        if (i % 3 == 1) from = vec3(from.y, from.x, from.z);
        if (i % 3 == 2) from = vec3(from.x, from.z, -from.y);
        Vec3 to = vec3(24 * dice_unit(&dice) - 12, 30 * dice_unit(&dice) - 4, 24 * dice_unit(&dice) - 12);
        Ray ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(to, from))));
        Met met[MOST], met_other[MOST];
        int n = walk(&walker, ray, true, met), n_other = walk(&other, ray, false, met_other);
        if (n != n_other) fail_msg("ray %d of '%s' meets %d surfaces, or %d", i, text, n, n_other);
        for (int k = 0; k < n; k++)
            if (met[k].object != met_other[k].object || met[k].entering != met_other[k].entering ||
                met[k].silent != met_other[k].silent || fabs(met[k].t - met_other[k].t) > 1e-9 * met[k].t)
                fail_msg("surface %d of ray %d of '%s' is of object %u at %.17g, or %u at %.17g", k, i, text,
                         met[k].object, met[k].t, met_other[k].object, met_other[k].t);
        assert_int_equal(nest_list_count(&walker.list), 0);
        total += n;
    }
    double ratio = (double)walker.searches / other.searches;
    printf("%d rays, %d surfaces, %d searches in place of %d\n", n_rays, total, walker.searches, other.searches);
    hit_list_clear(&walker.hits);
    hit_list_clear(&walker.passed);
    hit_list_clear(&other.hits);
    hit_list_clear(&other.passed);
    nest_list_clear(&walker.list);
    nest_list_clear(&other.list);
    fixture_clear(&fixture);
    return ratio;
}

#define TUMBLER "lathe tumbler { interior = glass profile = [<0,-2>, <11,-2>, <11,26>, <8.9,26>, <8.9,.1>, <0,.1>] } "

/* Drink that reaches into the glass, ice and a bubble half in the drink: meshes and pieces. */
static void test_drink(void **state)
{
    (void)state;
    double ratio =
        compare(FIXTURE_MEDIA "cylinder drink { interior = water  from = <0, 0, 0>  to = <0, 20, 0>  radius = 9 } "
                              "box cube { interior = ice  from = <-3, 14, -3>  to = <5, 22, 5> } " TUMBLER
                              "sphere { interior = gas radius = 3 center = <-4, 20, -2> } " FIXTURE_VIEW,
                20000);
    assert_true(ratio < 0.85);
}

/* Surfaces at one place: hulls that touch, with one of them hidden in part. */
static void test_touching(void **state)
{
    (void)state;
    compare(FIXTURE_MEDIA "box { interior = glass  from = <-6, 0, -6>  to = <6, 10, 6> } "
                          "box { interior = water  from = <-4, 5, -4>  to = <4, 10, 4>  priority = -1 } "
                          "box { interior = ice  from = <-5, 10, -5>  to = <5, 16, 5> } "
                          "box { interior = gas  from = <0, 4, -8>  to = <8, 12, 8>  priority = -2 } " FIXTURE_VIEW,
            20000);
}

/* Hulls of one medium, in each other and across each other, and one of the world's own. */
static void test_one_medium(void **state)
{
    (void)state;
    double ratio = compare(FIXTURE_MEDIA "box { interior = glass  from = <-8, 0, -8>  to = <8, 20, 8> } "
                                         "for (i in 1..12) { sphere { interior = glass radius = 3 "
                                         "center = <16 * rnd(1, i) - 8, 20 * rnd(2, i), 16 * rnd(3, i) - 8> } } "
                                         "sphere { interior = gas radius = 5 center = <0, 8, 0> } " FIXTURE_VIEW,
                           10000);
    assert_true(ratio < 0.85);
}

/* A scene where nothing may be passed by: combinations, and the order of entry. */
static void test_operands(void **state)
{
    (void)state;
    double ratio = compare(
        FIXTURE_MEDIA "difference { interior = glass  sphere { radius = 10 }  sphere { radius = 6 } } " FIXTURE_VIEW,
        5000);
    assert_true(ratio == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_drink),
        cmocka_unit_test(test_touching),
        cmocka_unit_test(test_one_medium),
        cmocka_unit_test(test_operands),
    };
    return cmocka_run_group_tests_name("passing", tests, NULL, NULL);
}
