/* ties_test.c - which of several opaque surfaces at one place is met, and which lamps yield to others.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "scene/ties.h"
#include "scene_fixture.h"

#define VIEW " camera { from = <0, 0, 900>  to = <0, 0, 0> }"

static void lamps_win_then_what_shines_then_the_later(void **state)
{
    (void)state;
    enum { LAMP, SHINING, DARK, SHEET, FLOOR, LATER, LATER_LAMP };
    Fixture f;
    fixture_good(
        &f, "meniscus 1.0 unit mm light { shape = quad  from = <0, 9, 0>  to = <0, 0, 0>  size = <1, 1> }"
            "sphere { surface = surface { emission = 1 } } sphere { surface = surface { } }"
            "sphere { surface = surface { thin = true  ior = 1.5  transmission = 1 } } ground { surface = surface { } }"
            "sphere { surface = surface { } } light { shape = quad  from = <0, 9, 0>  to = <0, 0, 0>  size = "
            "<1, 1> }" VIEW);
    static const struct {
        uint32_t loser, winner;
        bool loser_faces, winner_faces;
    } cases[] = {
        {SHINING, LAMP, true, true},    {DARK, LAMP, false, true},       {LATER, LAMP, true, true},
        {LAMP, DARK, false, true},      {LAMP, SHINING, false, false},   {DARK, SHINING, true, true},
        {LATER, SHINING, true, false},  {SHEET, DARK, true, true},       {SHEET, LAMP, true, false},
        {DARK, LATER, true, false},     {FLOOR, DARK, true, true},       {SHEET, FLOOR, true, true},
        {LAMP, LATER_LAMP, true, true}, {LATER_LAMP, LAMP, false, true},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        assert_true(ties_wins(f.scene, cases[i].loser, cases[i].loser_faces, cases[i].winner, cases[i].winner_faces));
        assert_false(ties_wins(f.scene, cases[i].winner, cases[i].winner_faces, cases[i].loser, cases[i].loser_faces));
    }
    fixture_clear(&f);
}

/* A stripe that is flush with a wall, and a rug with a floor, seen aslant by 10,000 rays each. */
static void rugs_are_seen_all_over(void **state)
{
    (void)state;
    enum { SIDE = 100 };
    Fixture f;
    fixture_compile(&f,
                    "meniscus 1.0 unit mm box { from = <-50, 0, -10>  to = <50, 60, .1>  surface = surface { } }"
                    "cylinder { from = <0, 30, -5>  to = <0, 30, .1>  radius = 15  surface = surface { } }"
                    "box { from = <-30, -1, 5>  to = <30, 0, 30>  surface = surface { } rotate(y, 7deg) }"
                    "ground { surface = surface { } }" VIEW,
                    1);
    const Vec3 eye = vec3(20, 60, 120);
    HitList hits = {0};
    uint32_t n_ties = 0;
    for (int i = 0; i < 2 * SIDE * SIDE; i++) {
        double x = (i % SIDE + .5) / SIDE * 2 - 1, y = (double)(i / SIDE % SIDE + .5) / SIDE * 2 - 1;
        bool wall = i < SIDE * SIDE;
        Vec3 aim = wall ? vec3(10 * x, 30 + 10 * y, .1) : vec3(20 * x, 0, 17.5 + 6 * y);
        Ray ray = ray_make(eye, vec3f_from(vec3_normalize(vec3_sub(aim, eye))));
        size_t n = rtc_nearest(f.compiled->rtc, &ray, &hits, NULL);
        const Hit *met = ties_met(f.compiled, hits.items, n);
        assert_non_null(met);
        assert_int_equal(met->object, wall ? 1 : 2);
        n_ties += n > 1;
    }
    printf("  %u of %d rays met two surfaces at one place\n", n_ties, 2 * SIDE * SIDE);
    assert_true(n_ties > 2 * SIDE * SIDE - SIDE);
    hit_list_clear(&hits);
    fixture_clear(&f);
}

/* Lamps yield that others may cover; those beside each other, back to back or across each other do not. */
static void which_lamps_yield(void **state)
{
    (void)state;
#define QUAD(place) "light { shape = quad  size = <4, 4>  " place " }"
    static const struct {
        const char *scene, *yields; /* of each object, in order: y or n; NULL: none */
    } cases[] = {
        {QUAD("from = <0, 9, 0>  to = <0, 0, 0>") QUAD("from = <1, 9, 0>  to = <1, 0, 0>"), "yn"},
        {QUAD("from = <0, 9, 0>  to = <0, 0, 0>") QUAD("from = <5, 9, 0>  to = <5, 0, 0>"), NULL},
        {QUAD("from = <0, 9, 0>  to = <0, 0, 0>") QUAD("from = <0, 9, 0>  to = <0, 20, 0>"), NULL},
        {QUAD("from = <0, 9, 0>  to = <0, 0, 0>") QUAD("from = <0, 9, 0>  to = <9, 9, 0>"), NULL},
        {"light { shape = sphere  radius = 2 } light { shape = sphere  radius = 2 }", "yn"},
        {"light { shape = sphere  radius = 2 } light { shape = sphere  radius = 1.9 }", NULL},
        {"light { shape = sphere  radius = 2 } sphere { radius = 2  surface = surface { emission = 1 } }", "ny"},
        {"sphere { surface = surface { emission = 1 } } sphere { surface = surface { emission = 1 } }", "yn"},
        {"light { shape = sphere  radius = 2 } sphere { radius = 2  surface = surface { } }", NULL},
        {"light { shape = sphere  radius = 2 } ground { surface = surface { emission = 1 } }", NULL},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        char text[500];
        Error error;
        bool *yields;
        snprintf(text, sizeof text, "meniscus 1.0 unit mm %s" VIEW, cases[i].scene);
        fixture_good(&f, text);
        assert_int_equal(ties_find_yielding(f.scene, &yields, &error), STATUS_OK);
        if ((yields != NULL) != (cases[i].yields != NULL)) fail_msg("%s", text);
        for (uint32_t k = 0; yields && k < f.scene->n_objects; k++)
            if (yields[k] != (cases[i].yields[k] == 'y')) fail_msg("object %u of %s", k, text);
        free(yields);
        fixture_clear(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lamps_win_then_what_shines_then_the_later),
        cmocka_unit_test(rugs_are_seen_all_over),
        cmocka_unit_test(which_lamps_yield),
    };
    return cmocka_run_group_tests_name("surfaces at one place", tests, NULL, NULL);
}
