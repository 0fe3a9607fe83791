/* looks_test.c - surfaces that are alike are one to shading, and none that differ in anything but their names.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "scene_fixture.h"
#include "trace/looks.h"

#define HEAD "meniscus 1.0\nmedium water { ior = 1.3 }\ncamera { from = <0, 0, 9> to = <0, 0, 0> }\n"

typedef struct Looked {
    Fixture fixture;
    ObjectLook *looks;
} Looked;

static void look(Looked *looked, const char *text)
{
    Error error;
    fixture_compile(&looked->fixture, text, 1);
    assert_int_equal(looks_find(looked->fixture.scene, &looked->looks, &error), STATUS_OK);
}

static void look_clear(Looked *looked)
{
    free(looked->looks);
    fixture_clear(&looked->fixture);
}

static void equal_surfaces_are_one(void **unused)
{
    (void)unused;
    Looked looked;
    look(&looked,
         HEAD "for (i in 0..<40) {\n"
              "  sphere { center = <3 * i, 0, 0>  radius = 1  surface = surface { albedo = i % 2 == 0 ? .3 : .6 } }\n"
              "}\n");
    const Scene *scene = looked.fixture.scene;
    assert_int_equal(scene->n_objects, 40);
    assert_true(scene->n_surfaces >= 40);
    for (uint32_t i = 0; i < 40; i++) {
        const ObjectLook *a = &looked.looks[i], *b = &looked.looks[i & 1];
        assert_int_equal(a->surface, b->surface);
        assert_int_equal(a->whole, i);
        assert_true(a->light == SCENE_NONE && !a->shines);
    }
    assert_int_not_equal(looked.looks[0].surface, looked.looks[1].surface);
    look_clear(&looked);
}

/* Each of these differs from all others in one property. */
static void others_are_not(void **unused)
{
    (void)unused;
    static const char *const surfaces[] = {
        "albedo = .3",
        "albedo = .31",
        "albedo = rgb(.3, .3, .29)",
        "albedo = .3  ior = 1.5",
        "albedo = .3  ior = 1.6",
        "albedo = .3  ior = 1.5  roughness = .2",
        "metal = iron  roughness = .2",
        "metal = gold  roughness = .2",
        "albedo = .3  emission = .5  radiance = 2",
        "albedo = .3  emission = .5  radiance = 3",
        "albedo = checker { from = .3  to = .6 }",
        "albedo = checker { from = .3  to = .7 }",
    };
    char text[4096] = HEAD;
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) {
        size_t n = strlen(text);
        snprintf(text + n, sizeof text - n, "sphere { center = <%zu, 0, 0>  radius = .3  surface = surface { %s } }\n",
                 i, surfaces[i]);
    }
    Looked looked;
    look(&looked, text);
    for (uint32_t i = 0; i < COUNT_OF(surfaces); i++) {
        assert_true(looked.looks[i].shines == (strstr(surfaces[i], "emission") != NULL));
        for (uint32_t k = 0; k < i; k++) assert_int_not_equal(looked.looks[i].surface, looked.looks[k].surface);
    }
    look_clear(&looked);
}

static void lights_and_combinations(void **unused)
{
    (void)unused;
    Looked looked;
    look(&looked, HEAD "sphere { interior = water  radius = 1 }\n"
                       "light { shape = sphere  from = <0, 4, 0>  radius = .5 }\n"
                       "difference { surface = surface { albedo = .5 }  box { from = <2, 0, 0>  to = <4, 2, 2> }\n"
                       "  sphere { center = <3, 1, 1>  radius = .8 } }\n");
    const Scene *scene = looked.fixture.scene;
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        assert_int_equal(looked.looks[i].whole, scene_whole(scene, i));
        assert_int_equal(looked.looks[i].light, object->light);
        assert_true(looked.looks[i].shines == (object->light != SCENE_NONE));
        assert_true((looked.looks[i].surface == SCENE_NONE) == (object->surface == SCENE_NONE));
    }
    look_clear(&looked);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_surfaces_are_one),
        cmocka_unit_test(others_are_not),
        cmocka_unit_test(lights_and_combinations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
