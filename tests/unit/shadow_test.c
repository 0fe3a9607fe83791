/* shadow_test.c - straight rays to lights: what Embree misses of their way is found as it is for paths.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"
#include "trace/event.h"

#define CORNERS 48
/* A mesh turned in steps, which absorbs and has the index of what is around it, so that straight rays go through. */
#define TURNED                                                                                                         \
    "meniscus 1.0 unit mm medium ink { ior = 1 absorption = 1 / 1m } let n = 48 "                                      \
    "let profile = [<0, 0>, <30, 0>, <34, 2>, <41, 80>, <0, 80>] "                                                     \
    "def at(k, i) = let (a = 360deg * i / n, p = profile[k]) <p.x * cos(a), p.y, p.x * sin(a)> "                       \
    "mesh { interior = ink positions = [at(0, 0), at(4, 0), for (k in 1..3) for (i in 0..<n) at(k, i)] "               \
    "triangles = [for (i in 0..<n) let (j = (i + 1) % n) <0, 2 + i, 2 + j>] + "                                        \
    "[for (i in 0..<n) let (j = (i + 1) % n) <1, 2 + 2 * n + j, 2 + 2 * n + i>] + "                                    \
    "[for (k in [2, 2 + n]) for (i in 0..<n) let (j = (i + 1) % n) <k + i, k + n + i, k + j>] + "                      \
    "[for (k in [2, 2 + n]) for (i in 0..<n) let (j = (i + 1) % n) <k + j, k + n + i, k + n + j>] } "                  \
    "environment { } camera { from = <0, 0, 500> to = <0, 0, 0> } "

/* Whether the surfaces that a search finds along a ray from outside do not come in turn. */
static bool contradicts(const CompiledScene *compiled, const Ray *ray, HitList *hits)
{
    assert_true(rtc_all(compiled->rtc, ray, true, hits));
    for (size_t i = 0; i < hits->n; i++)
        if (hits->items[i].entering != (i % 2 == 0)) return true;
    return false;
}

/* Embree may miss all triangles of a corner that a ray is aimed at. */
static void test_corners(void **state)
{
    (void)state;
    enum { RAYS = 300000 };
    Fixture fixture;
    fixture_compile(&fixture, TURNED, 1);
    const CompiledScene *compiled = fixture.compiled;
    World world;
    Tracer tracer;
    Error error;
    assert_int_equal(world_init(&world, compiled, 0, 4, false, NULL, &error), STATUS_OK);
    tracer_init(&tracer, &world);
    Path path;
    path_init(&path, &tracer, sampler_make(1, 0, 0, 0));
    path.wavelengths = wavelengths_sample(0.5f);
    HitList hits = {0};
    Dice dice = {11};
    int n_through = 0, n_missed = 0;
    for (int i = 0; i < RAYS; i++) {
        double angle = 2 * acos(-1) * (i % CORNERS) / CORNERS;
        Vec3 corner = vec3_from_f(vec3f_from(vec3(30 * cos(angle), 0, 30 * sin(angle))));
        Vec3 from = vec3_scale(dice_direction(&dice), 480), aim = vec3_along(corner, 1e-5, dice_direction(&dice));
        if (from.y > -300) continue;
        Ray ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(aim, from))));
        ray.t_max = 900;
        n_missed += contradicts(compiled, &ray, &hits);
        Lanes transmittance;
        uint32_t medium;
        assert_true(path_shadow(&path, &ray, &transmittance, &medium));
        assert_int_equal(nest_list_count(&tracer.shadow_list), 0);
        n_through += lanes_max(transmittance) < 1;
    }
    printf("%d straight rays through corners, %d that Embree came through without a way in or out; %llu faults\n",
           n_through, n_missed, (unsigned long long)tracer.counters.nesting_faults);
    assert_true(n_through > RAYS / 20);
    assert_int_equal(tracer.counters.nesting_faults, 0);
    hit_list_clear(&hits);
    tracer_clear(&tracer);
    world_clear(&world);
    fixture_clear(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_corners)};
    return cmocka_run_group_tests_name("shadow", tests, NULL, NULL);
}
