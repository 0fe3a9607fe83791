/* stops_test.c - straight rays that end at a hull at once are those that the whole list of crossings says are blocked.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"

typedef struct Counts {
    int rays, blocked, early;
} Counts;

static Vec3 place_in(Box3 box, Dice *dice)
{
    Vec3 size = vec3_sub(box.max, box.min);
    return vec3(box.min.x + dice_unit(dice) * size.x, box.min.y + dice_unit(dice) * size.y,
                box.min.z + dice_unit(dice) * size.z);
}

/* Whether the medium changes to one of another index on the way, by crossing everything. */
static bool is_blocked(const CompiledScene *compiled, NestList *list, const HitList *hits)
{
    const SceneMedium *media = compiled->scene->media;
    for (size_t i = 0; i < hits->n; i++) {
        uint32_t hull = compiled->hull_of_object[hits->items[i].object];
        if (hull == SCENE_NONE) return true;
        NestPass pass = {hull, hits->items[i].entering};
        NestCrossing crossing;
        assert_int_equal(nest_cross(list, &compiled->order, &pass, 1, &crossing), STATUS_OK);
        if (crossing.opaque) return true;
        float from = spectrum_at_one(&media[crossing.medium_from].ior, 500);
        float to = spectrum_at_one(&media[crossing.medium_to].ior, 500);
        if (from != to) return true;
    }
    return false;
}

/* Between random places of the scene. A ray that is stopped at once must be blocked. */
static Counts follow_rays(const char *text, int n)
{
    Fixture fixture;
    fixture_compile(&fixture, text, 1);
    const CompiledScene *compiled = fixture.compiled;
    Box3 box = rtc_scene_bounds(compiled->rtc);
    Vec3 margin = vec3_scale(vec3_sub(box.max, box.min), 0.2);
    box = (Box3){vec3_sub(box.min, margin), vec3_add(box.max, margin)};
    Counts counts = {0};
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    Dice dice = {7};
    for (int i = 0; i < n; i++) {
        Vec3f from = vec3f_from(place_in(box, &dice));
        Vec3 to = vec3_sub(place_in(box, &dice), vec3_from_f(from));
        uint32_t on_surface;
        assert_int_equal(compiled_interior(compiled, from, 0, &hits, &list, &on_surface), STATUS_OK);
        if (on_surface != SCENE_NONE) continue;
        Ray ray = ray_make(vec3_from_f(from), vec3f_from(vec3_normalize(to)));
        ray.t_max = vec3_length(to);
        rtc_all(compiled->rtc, &ray, false, &hits);
        ray.stops = compiled_stop_class(nest_medium(&list));
        bool blocked = is_blocked(compiled, &list, &hits);
        bool stopped = !rtc_all(compiled->rtc, &ray, true, &hits);
        if (stopped && !blocked) fail_msg("ray %d of '%s' is stopped, and nothing blocks it", i, text);
        counts.rays++;
        counts.blocked += blocked;
        counts.early += stopped;
    }
    printf("%d rays, %d blocked, %d of these at once\n", counts.rays, counts.blocked, counts.early);
    hit_list_clear(&hits);
    nest_list_clear(&list);
    fixture_clear(&fixture);
    return counts;
}

#define BALL(name, medium, radius, at)                                                                                 \
    "sphere " name " { interior = " medium "  radius = " radius " translate(" at ") } "

/* A ball of glass in the air stops every ray from the air; of those from inside nothing is known beforehand. */
static void test_one_ball(void **state)
{
    (void)state;
    Counts counts = follow_rays(FIXTURE_MEDIA BALL("a", "glass", "10", "<0, 0, 0>") FIXTURE_VIEW, 20000);
    assert_true(counts.early > counts.blocked / 2);
    assert_true(counts.early < counts.blocked);
}

/* Drink in a glass, ice in the drink, a bubble of the air's index in the drink's surface, and all of it overlapping:
 * the glass stops rays from the air, but the drink does not: it may be crossed inside of the bubble. */
static void test_overlaps(void **state)
{
    (void)state;
    Counts counts = follow_rays(
        FIXTURE_MEDIA
        "cylinder drink { interior = water  from = <0, 0, 0>  to = <0, 20, 0>  radius = 9 } "
        "box cube { interior = ice  from = <-3, 14, -3>  to = <5, 22, 5> } medium air { ior = 1 state = solid } " BALL(
            "bubble", "air", "6", "<-4, 20, -2>") "lathe tumbler { interior = glass profile = [<0,-2>, <11,-2>, "
                                                  "<11,26>, <8.9,26>, <8.9,.1>, <0,.1>] } " FIXTURE_VIEW,
        60000);
    assert_true(counts.early > 10000);
    assert_true(counts.early < counts.blocked);
}

/* Indices that are the same are no boundary, wherever. */
static void test_equal_indices(void **state)
{
    (void)state;
    Counts counts = follow_rays(
        FIXTURE_MEDIA BALL("a", "gas", "10", "<0, 0, 0>") BALL("b", "gas", "10", "<8, 0, 0>") FIXTURE_VIEW, 10000);
    assert_int_equal(counts.blocked, 0);
    assert_int_equal(counts.early, 0);
}

/* Operands and what is entered last are never known beforehand. */
static void test_nothing_is_assumed(void **state)
{
    (void)state;
    Counts counts =
        follow_rays(FIXTURE_MEDIA "difference whole { interior = glass " BALL("a", "glass", "10", "<0, 0, 0>")
                        BALL("b", "glass", "10", "<8, 0, 0>") "} " FIXTURE_VIEW,
                    10000);
    assert_true(counts.blocked > 500);
    assert_int_equal(counts.early, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_one_ball),
        cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_equal_indices),
        cmocka_unit_test(test_nothing_is_assumed),
    };
    return cmocka_run_group_tests_name("stops", tests, NULL, NULL);
}
