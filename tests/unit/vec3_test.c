/* vec3_test.c - roundings that no compiler may leave out, and affine maps against what defines them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/vec3.h"
#include "dice.h"
#include "near.h"

enum { TURNS = 1000 };

static Affine some_map(Dice *dice)
{
    Affine map;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 3; column++) map.m[row][column] = 2 * dice_unit(dice) - 1;
    map.t = dice_point(dice, 10);
    return map;
}

static void assert_same_place(Vec3 a, Vec3 b, double tolerance)
{
    assert_near(a.x, b.x, tolerance);
    assert_near(a.y, b.y, tolerance);
    assert_near(a.z, b.z, tolerance);
}

/* gcc 12 makes vectors of neighbouring doubles and takes what rounds them to float and back for nothing. */
static void places_are_rounded_to_floats(void **state)
{
    (void)state;
    Dice dice = {1};
    for (int i = 0; i < TURNS; i++) {
        Vec3 place = dice_point(&dice, 1000), rounded = vec3_rounded(place);
        volatile float x = (float)place.x, y = (float)place.y, z = (float)place.z;
        assert_true(rounded.x == (double)x && rounded.y == (double)y && rounded.z == (double)z);
        assert_true(rounded.x != place.x || rounded.y != place.y || rounded.z != place.z);
        place = vec3_rounded(rounded);
        assert_memory_equal(&place, &rounded, sizeof place);
    }
}

static void maps_compose_and_invert(void **state)
{
    (void)state;
    Dice dice = {2};
    int inverted = 0;
    for (int i = 0; i < TURNS; i++) {
        Affine a = some_map(&dice), b = some_map(&dice), inverse, both = affine_compose(&a, &b);
        Vec3 place = dice_point(&dice, 10), there = affine_point(&b, place);
        assert_same_place(affine_point(&both, place), affine_point(&a, there), 1e-12);
        assert_near(affine_determinant(&both), affine_determinant(&a) * affine_determinant(&b), 1e-13);
        assert_true(vec3_length(affine_vector(&b, place)) <= affine_max_stretch(&b) * vec3_length(place) * (1 + 1e-15));
        if (!(fabs(affine_determinant(&b)) > 0.01)) continue;
        inverted++;
        assert_true(affine_invert(&b, &inverse));
        assert_same_place(affine_point(&inverse, there), place, 1e-11);
    }
    assert_true(inverted > TURNS / 2);
}

/* Two edges' cross product is an area; so are the mapped edges'. */
static void areas_and_normals_are_mapped(void **state)
{
    (void)state;
    Dice dice = {3};
    for (int i = 0; i < TURNS; i++) {
        Affine map = some_map(&dice), inverse;
        Vec3 u = dice_point(&dice, 1), v = dice_point(&dice, 1);
        Vec3 area = vec3_cross(affine_vector(&map, u), affine_vector(&map, v));
        assert_same_place(affine_area(&map, vec3_cross(u, v)), area, 1e-14);
        if (!(fabs(affine_determinant(&map)) > 0.01) || !affine_invert(&map, &inverse)) continue;
        Vec3 normal = affine_normal(&inverse, vec3_cross(u, v)); /* up to its length and, in mirrors, its sign */
        assert_near(vec3_length(vec3_cross(normal, area)), 0, 1e-12 * vec3_length(normal));
    }
}

static void flat_and_endless_maps_have_no_inverse(void **state)
{
    (void)state;
    Affine map = affine_identity(), inverse;
    assert_true(affine_is_identity(&map) && affine_invert(&map, &inverse) && affine_is_identity(&inverse));
    map.m[1][1] = 0;
    assert_false(affine_invert(&map, &inverse));
    map.m[1][1] = 1e-320; /* 1 over it is not finite */
    assert_false(affine_invert(&map, &inverse));
    map = affine_identity();
    map.t.z = HUGE_VAL;
    assert_false(affine_invert(&map, &inverse));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(places_are_rounded_to_floats),
        cmocka_unit_test(maps_compose_and_invert),
        cmocka_unit_test(areas_and_normals_are_mapped),
        cmocka_unit_test(flat_and_endless_maps_have_no_inverse),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
