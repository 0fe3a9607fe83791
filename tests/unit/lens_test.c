/* lens_test.c - what the cells of a lens say that a ray starts in is what is there.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"
#include "trace/lens.h"

/* Points of the lens of the scene's only camera; returns the part of them of which the hulls are known. */
static double part_known(const char *text)
{
    enum { POINTS = 3000 };
    Fixture fixture;
    Lens *lens;
    HitList hits = {0};
    NestList list;
    Dice dice = {7};
    int n_known = 0, n_inside = 0;
    nest_list_init(&list);
    fixture_compile(&fixture, text, 1);
    const SceneCamera *camera = &fixture.scene->cameras[0];
    assert_int_equal(lens_new(fixture.compiled, camera, &lens, &fixture.error), STATUS_OK);
    for (int i = 0; i < POINTS; i++) {
        double angle = 7 * dice_unit(&dice), r = camera->lens_reach * sqrt(dice_unit(&dice));
        Vec3 middle = scene_camera_place(fixture.scene, camera, 2 * dice_unit(&dice) - 1, 2 * dice_unit(&dice) - 1);
        Vec3 at = vec3_along(vec3_along(middle, r * cos(angle), camera->right), r * sin(angle), camera->up);
        const NestList *known = lens_list_at(lens, at);
        if (!known) continue;
        n_known++;
        assert_int_equal(compiled_interior(fixture.compiled, vec3f_from(at), 0, &hits, &list, NULL), STATUS_OK);
        assert_int_equal(nest_medium(known), nest_medium(&list));
        assert_int_equal(nest_list_count(known), nest_list_count(&list));
        n_inside += nest_list_count(&list) > 0;
    }
    printf("  %d of %d points known, %d of them inside of something\n", n_known, POINTS, n_inside);
    double beyond = 2 * camera->lens_reach + 2 * camera->half_width;
    assert_null(lens_list_at(lens, vec3_along(camera->from, beyond, camera->right)));
    lens_free(lens);
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&fixture);
    return (double)n_known / POINTS;
}

#define CAMERA "camera { from = <0, 10, 0>  to = <0, 10, -50>  aperture = 4  focus = <0, 0, -50> } environment { } "

static void water_line(void **state)
{
    (void)state;
    assert_true(part_known(FIXTURE_MEDIA
                           "box { interior = water  from = <-90, -90, -90>  to = <90, 10.2, 90> } " CAMERA) > 0.7);
    assert_true(part_known(FIXTURE_MEDIA "plane { interior = water  distance = 9 } " CAMERA) > 0.7);
    assert_true(part_known(FIXTURE_MEDIA "sphere { interior = water  radius = 10 } " CAMERA) > 0.7);
}

static void drops_and_walls(void **state)
{
    (void)state;
    assert_true(part_known(FIXTURE_MEDIA
                           "sphere { interior = water  radius = .5  center = <.7, 10.3, 0> } "
                           "sphere { interior = glass  radius = .4  center = <.7, 10.3, .1> } "
                           "torus { interior = ice  radius = 1.2  tube = .2  center = <0, 10, 0>  rotate(x, 80) } "
                           "box { interior = oil  from = <-3, 0, -3>  to = <0, 9.6, 3>  rotate(z, 5) } " CAMERA) > 0.2);
}

#define PARALLEL(lens)                                                                                                 \
    "camera { projection = orthographic  from = <0, 10, 0>  to = <-8, 3, -50>  width = 12 " lens                       \
    " } film { size = <300, 200> } environment { } "

static void picture_planes(void **state)
{
    (void)state;
    static const char *const cameras[] = {PARALLEL(""), PARALLEL("aperture = 2")};
    for (size_t i = 0; i < COUNT_OF(cameras); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "box { interior = water  from = <-90, -90, -90>  to = <90, 10.2, 90> } "
                 "sphere { interior = glass  radius = 1.5  center = <2, 10, 0> } "
                 "torus { interior = ice  radius = 2  tube = .4  center = <-3, 11, 0>  rotate(z, 10) } %s",
                 cameras[i]);
        double part = part_known(text);
        assert_true(part > 0.6);
        assert_true(part < 0.98);
    }
    assert_true(
        part_known(FIXTURE_MEDIA "sphere { interior = water  radius = 2  center = <0, 30, 0> } " PARALLEL("")) == 1);
}

/* The corners of three blades are half as far again from the middle as the rim of a disc of their area. */
static void blades(void **state)
{
    (void)state;
    assert_true(part_known(FIXTURE_MEDIA "plane { interior = water  distance = 9 } "
                                         "sphere { interior = glass  radius = .5  center = <0, 12.8, 0> } "
                                         "camera { from = <0, 10, 0>  to = <0, 10, -50>  aperture = 4  blades = 3 } "
                                         "environment { } ") > 0.7);
}

static void nothing_is_near(void **state)
{
    (void)state;
    assert_true(part_known(FIXTURE_MEDIA "sphere { interior = water  radius = 5  center = <0, 30, 0> } " CAMERA) == 1);
    assert_true(
        part_known(FIXTURE_MEDIA "box { interior = water  from = <-90, -90, -90>  to = <90, 90, 90> } " CAMERA) == 1);
    lens_free(NULL);
    assert_null(lens_list_at(NULL, vec3(0, 0, 0)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(water_line), cmocka_unit_test(drops_and_walls), cmocka_unit_test(picture_planes),
        cmocka_unit_test(blades),     cmocka_unit_test(nothing_is_near),
    };
    return cmocka_run_group_tests_name("lens", tests, NULL, NULL);
}
