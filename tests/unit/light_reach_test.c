/* light_reach_test.c - media that light is said not to come straight into get none: neither where that is known, nor from any
 * place to any other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"
#include "trace/light.h"

typedef struct Lit {
    Fixture fixture;
    World world;
} Lit;

static void lit_make(Lit *lit, const char *text)
{
    fixture_compile(&lit->fixture, text, 1);
    assert_int_equal(world_init(&lit->world, lit->fixture.compiled, 0, 64, false, NULL, &lit->fixture.error),
                     STATUS_OK);
}

static void lit_clear(Lit *lit)
{
    world_clear(&lit->world);
    fixture_clear(&lit->fixture);
}

/* Of the medium that an object holds; NULL: of the world's. */
static unsigned reach_in(const Lit *lit, const char *object)
{
    const Scene *scene = lit->fixture.scene;
    return lit->world.reach[object ? scene->objects[fixture_object(&lit->fixture, object)].medium : WORLD_MEDIUM];
}

static bool is_clear(const Lit *lit, NestList *list, const HitList *hits)
{
    const CompiledScene *compiled = lit->fixture.compiled;
    for (size_t i = 0; i < hits->n; i++) {
        uint32_t hull = compiled->hull_of_object[hits->items[i].object];
        NestCrossing crossing;
        if (hull == SCENE_NONE) return false;
        assert_int_equal(nest_cross_one(list, &compiled->order, (NestPass){hull, hits->items[i].entering}, &crossing),
                         STATUS_OK);
        if (crossing.opaque) return false;
        for (float nm = 400; nm <= 700; nm += 20)
            if (spectrum_at_one(&lit->fixture.scene->media[crossing.medium_from].ior, nm) !=
                spectrum_at_one(&lit->fixture.scene->media[crossing.medium_to].ior, nm))
                return false;
    }
    return true;
}

/* Straight rays from places anywhere, to infinity and to lights: what arrives was said to be able to. */
static void follow_rays(const Lit *lit, int n)
{
    const CompiledScene *compiled = lit->fixture.compiled;
    Box3 box = rtc_scene_bounds(compiled->rtc);
    Vec3 size = vec3_sub(box.max, box.min);
    HitList hits = {0};
    NestList list;
    int arrived[2] = {0, 0};
    nest_list_init(&list);
    Dice dice = {11};
    for (int i = 0; i < n; i++) {
        double x = dice_unit(&dice), y = dice_unit(&dice), z = dice_unit(&dice);
        Vec3f from = vec3f_from(vec3_add(box.min, vec3(x * size.x, y * size.y, z * size.z)));
        bool near = i % 2 && lit->world.emitters.n;
        Vec3 direction = dice_direction(&dice);
        Ray ray = ray_make(vec3_from_f(from), vec3f_from(direction));
        if (near) {
            uint32_t emitter = (uint32_t)(dice_unit(&dice) * lit->world.emitters.n);
            const float u[2] = {(float)dice_unit(&dice) * 0.99f, (float)dice_unit(&dice) * 0.99f};
            Vec3 to = vec3_sub(light_pivot(&lit->world, emitter, 0, 0.5, u).place, vec3_from_f(from));
            ray = ray_make(vec3_from_f(from), vec3f_from(vec3_normalize(to)));
            ray.t_max = vec3_length(to) * (1 - 1e-5);
        }
        uint32_t on_surface;
        assert_int_equal(compiled_interior(compiled, from, 0, &hits, &list, &on_surface), STATUS_OK);
        if (on_surface != SCENE_NONE) continue;
        unsigned reach = lit->world.reach[nest_medium(&list)];
        rtc_all(compiled->rtc, &ray, false, &hits);
        if (!is_clear(lit, &list, &hits)) continue;
        arrived[near]++;
        if (!(reach & (near ? REACH_NEAR : REACH_FAR))) fail_msg("ray %d arrives", i);
    }
    printf("    %d rays arrive from afar, %d from lights nearby\n", arrived[0], arrived[1]);
    assert_true(arrived[0] + arrived[1] > n / 100);
    nest_list_clear(&list);
    hit_list_clear(&hits);
}

#define LAMP "light { shape = sphere  from = <0, 30, 0>  radius = 2 } "

static void lamp_outside(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit,
             FIXTURE_MEDIA "lathe tumbler { interior = glass profile = [<0,-2>, <11,-2>, <11,26>, <8.9,26>, "
                           "<8.9,.1>, <0,.1>] } cylinder drink { interior = water  to = <0, 20, 0>  radius = 9 } "
                           "sphere bubble { interior = gas  radius = 2  center = <0, 19, 0> } " LAMP FIXTURE_VIEW);
    assert_int_equal(reach_in(&lit, NULL), REACH_FAR | REACH_NEAR);
    assert_int_equal(reach_in(&lit, "bubble"),
                     REACH_FAR | REACH_NEAR); /* of the air's index, and half out of the drink */
    assert_int_equal(reach_in(&lit, "tumbler"), 0);
    assert_int_equal(reach_in(&lit, "drink"), 0);
    follow_rays(&lit, 40000);
    lit_clear(&lit);
}

static void lamp_inside(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit, FIXTURE_MEDIA
             "medium argon { ior = 1.0003 } sphere bulb { interior = glass  radius = 10  center = <0, 30, 0> } "
             "sphere hollow { interior = argon  radius = 9  center = <0, 30, 0> } " LAMP FIXTURE_VIEW);
    assert_int_equal(reach_in(&lit, NULL), REACH_FAR);
    assert_int_equal(reach_in(&lit, "hollow"), REACH_NEAR);
    assert_int_equal(world_lights_in(&lit.world, WORLD_MEDIUM)->near > 0, 0);
    follow_rays(&lit, 40000);
    lit_clear(&lit);
}

/* Lamps without size are found by looking alone, and so are looked for from the world whatever is around them. */
static void lamp_without_size(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit,
             FIXTURE_MEDIA "sphere bulb { interior = glass  radius = 10 } sphere other { interior = water  "
                           "radius = 5  center = <40, 0, 0> } light { shape = point  from = <0, 0, 0> } " FIXTURE_VIEW);
    assert_int_equal(reach_in(&lit, NULL), REACH_FAR | REACH_NEAR);
    assert_int_equal(reach_in(&lit, "bulb"), REACH_NEAR);
    assert_int_equal(reach_in(&lit, "other"), 0);
    follow_rays(&lit, 40000);
    lit_clear(&lit);
}

/* A sea without end reaches to the sky's lower half. */
static void sea_without_end(void **state)
{
    (void)state;
    Lit lit;
    lit_make(&lit,
             FIXTURE_MEDIA "plane sea { interior = water } sphere ball { interior = ice  radius = 5  center = "
                           "<0, -20, 0> } sphere stone { radius = 3  center = <0, 9, 0>  surface = surface { } } "
                           "sphere fish { radius = 3  center = <9, -9, 0>  surface = surface { } } " LAMP FIXTURE_VIEW);
    assert_int_equal(reach_in(&lit, NULL), REACH_FAR | REACH_NEAR);
    assert_true(reach_in(&lit, "sea") & REACH_FAR);
    assert_int_equal(reach_in(&lit, "ball"), 0);
    follow_rays(&lit, 40000);
    lit_clear(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamp_outside),
        cmocka_unit_test(lamp_inside),
        cmocka_unit_test(lamp_without_size),
        cmocka_unit_test(sea_without_end),
    };
    return cmocka_run_group_tests_name("light_reach", tests, NULL, NULL);
}
