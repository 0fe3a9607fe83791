/* csg_test.c - combinations: whether a point is inside against plain evaluation of random trees, crossings along random
 * lines against the hulls that they make up, volumes against closed forms, and the interior of random points.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "dice.h"
#include "nest/cross.h"
#include "scene_fixture.h"

enum { HULLS = 3, OPERANDS = 24, PARTS = 64 };

/* ---- the core alone ---- */

typedef struct Model {
    NestPart parts[PARTS];
    NestTree trees[2];
    uint32_t tree_of_operand[OPERANDS];
    NestCsg csg;
    Dice dice;
} Model;

static uint32_t pick(Model *model, int n)
{
    return (uint32_t)dice_below(&model->dice, n);
}

/* Fills a part with operands, in order of their numbers. */
static void grow(Model *model, uint32_t part, uint32_t tree, uint32_t depth)
{
    NestCsg *csg = &model->csg;
    uint32_t begin = HULLS + csg->n_operands;
    if (depth == 0 || pick(model, 4) == 0 || csg->n_parts + 4 > PARTS || csg->n_operands + 8 > OPERANDS) {
        model->tree_of_operand[csg->n_operands++] = tree;
        model->parts[part] = (NestPart){NEST_OPERAND, begin, begin + 1, 0, 0};
        return;
    }
    uint32_t n = 1 + pick(model, 3), first = csg->n_parts;
    NestOperation operation = (NestOperation)(NEST_UNION + pick(model, 3));
    csg->n_parts += n;
    for (uint32_t i = 0; i < n; i++) grow(model, first + i, tree, depth - 1);
    model->parts[part] = (NestPart){operation, begin, HULLS + csg->n_operands, first, n};
}

/* Two combinations: hull 1, and an opaque one. */
static void make_model(Model *model, uint64_t seed)
{
    *model = (Model){.dice = {seed << 32}};
    model->csg = (NestCsg){.first_operand = HULLS,
                           .n_trees = 2,
                           .n_parts = 2,
                           .parts = model->parts,
                           .trees = model->trees,
                           .tree_of_operand = model->tree_of_operand};
    for (uint32_t t = 0; t < 2; t++) {
        model->trees[t] = (NestTree){t, t == 0 ? 1 : NEST_OPAQUE};
        grow(model, t, t, 3);
    }
}

static bool plain(const Model *model, uint32_t number, const bool *inside)
{
    const NestPart *part = &model->parts[number];
    if (part->operation == NEST_OPERAND) return inside[part->begin];
    bool any = false, all = true, rest = false;
    for (uint32_t i = 0; i < part->n_children; i++) {
        bool child = plain(model, part->first_child + i, inside);
        any = any || child;
        all = all && child;
        rest = rest || (i > 0 && child);
    }
    if (part->operation == NEST_UNION) return any;
    return part->operation == NEST_INTERSECTION ? all : plain(model, part->first_child, inside) && !rest;
}

/* Random crossings of hulls and operands, one or several at a time; after each the list holds what a set would, and the
 * crossing says what changed. */
static void check_crossings(NestPolicy policy, uint64_t seed, uint64_t *n_flips)
{
    Model model;
    NestOrder order;
    make_model(&model, seed);
    const NestHull hulls[HULLS] = {{1, 0, NEST_STATE_UNKNOWN, 3, false},
                                   {2, 0, NEST_STATE_UNKNOWN, 2, false},
                                   {3, 0, NEST_STATE_UNKNOWN, 1, false}};
    assert_int_equal(nest_order_build(&order, policy, hulls, HULLS, NULL, 0, NULL), STATUS_OK);
    assert_int_equal(nest_order_combine(&order, &model.csg, NULL), STATUS_OK);
    bool inside[HULLS + OPERANDS] = {false};
    NestList list;
    nest_list_init(&list);
    for (int step = 0; step < 200; step++) {
        NestPass passes[3];
        uint32_t n = 1 + pick(&model, 3), n_all = HULLS + model.csg.n_operands;
        bool opaque_before = plain(&model, 1, inside);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t pass = pick(&model, (int)n_all);
            bool again = pass == 1; /* hull 1 is a combination and crossed through its operands only */
            for (uint32_t k = 0; k < i; k++) again = again || passes[k].hull == pass;
            if (again) {
                i--;
                continue;
            }
            passes[i] = (NestPass){pass, !inside[pass]};
        }
        for (uint32_t i = 0; i < n; i++) inside[passes[i].hull] = passes[i].entering;
        inside[1] = plain(&model, 0, inside);
        NestCrossing crossing;
        uint32_t medium = nest_medium(&list);
        assert_int_equal(nest_cross(&list, &order, passes, n, &crossing), STATUS_OK);
        assert_int_equal(crossing.n_faults, 0);
        bool opaque_after = plain(&model, 1, inside);
        assert_true(crossing.opaque == (opaque_before != opaque_after));
        *n_flips += crossing.opaque;
        for (uint32_t h = 0; h < n_all; h++) assert_true(nest_list_has(&list, h) == inside[h]);
        assert_int_equal(crossing.medium_from, medium);
        assert_int_equal(crossing.medium_to, nest_medium(&list));
        if (policy != NEST_AUTOMATIC) continue;
        uint32_t owner = inside[2] ? 2 : inside[1] ? 1 : inside[0] ? 0 : NEST_WORLD;
        assert_int_equal(nest_owner(&order, &list), owner);
    }
    nest_list_clear(&list);
    nest_order_clear(&order);
}

static void lists_hold_what_the_operands_make_up(void **state)
{
    (void)state;
    uint64_t n_flips = 0;
    for (uint64_t seed = 1; seed <= 3000; seed++) {
        check_crossings(NEST_AUTOMATIC, seed, &n_flips);
        check_crossings(NEST_ENTERED, seed, &n_flips);
    }
    assert_true(n_flips > 10000);
}

/* On an operand's surface, the combination's is there where being in the operand makes a difference; and it is out of one that is taken
 * away. */
static void operands_show(void **state)
{
    (void)state;
    uint64_t n_shown = 0, n_taken = 0;
    for (uint64_t seed = 1; seed <= 3000; seed++) {
        Model model;
        make_model(&model, seed);
        bool inside[HULLS + OPERANDS] = {false};
        NestList list;
        nest_list_init(&list);
        assert_int_equal(nest_list_reserve(&list, OPERANDS), STATUS_OK);
        for (uint32_t i = 0; i < model.csg.n_operands; i++) {
            inside[HULLS + i] = pick(&model, 2) != 0;
            if (inside[HULLS + i]) assert_true(nest_csg_pass(&model.csg, &list, HULLS + i, true));
        }
        for (uint32_t i = HULLS; i < HULLS + model.csg.n_operands; i++) {
            const bool now = inside[i];
            const uint32_t tree = nest_csg_tree(&model.csg, i), n = list.n;
            inside[i] = true;
            bool within = plain(&model, tree, inside);
            inside[i] = false;
            bool without = plain(&model, tree, inside);
            inside[i] = now;
            assert_true(nest_csg_shows(&model.csg, &list, i) == (within != without));
            assert_int_equal(list.n, n);
            assert_true(nest_list_has(&list, i) == now);
            if (within != without) assert_true(nest_csg_takes(&model.csg, i) == without);
            n_shown += within != without;
            n_taken += within != without && without;
        }
        nest_list_clear(&list);
    }
    assert_true(n_shown > 3000 && n_taken > 500);
}

/* ---- in scenes ---- */

static const double pi = 3.14159265358979323846;

static void volumes_are_measured(void **state)
{
    (void)state;
    Fixture scene;
    fixture_compile(&scene,
                    FIXTURE_MEDIA
                    "intersection { interior = glass sphere { center = <-1, 0, 0> radius = 2 }"
                    "  sphere { center = <1, 0, 0> radius = 2 } }"
                    "difference { interior = glass box { from = <10, 0, 0> to = <14, 4, 4> }"
                    "  cylinder { from = <12, -1, 2> to = <12, 5, 2> radius = 1 } }"
                    "union { interior = water sphere { center = <0, 20, 0> radius = 3 }"
                    "  sphere { center = <0, 20, 0> radius = 2 } sphere { center = <9, 20, 0> radius = 1 } }"
                    "merge { interior = ice group { box { from = <20, 0, 0> to = <21, 1, 1> }"
                    "  box { from = <21, 0, 0> to = <22, 1, 1> } } }" FIXTURE_VIEW,
                    2);
    const double cap = pi * 1 * 1 * (3 * 2 - 1) / 3; /* of height 1 on a ball of radius 2 */
    const double expected[] = {2 * cap, 64 - 4 * pi, 36 * pi + 4 * pi / 3, 2};
    assert_int_equal(scene.compiled->n_hulls, 4);
    for (uint32_t h = 0; h < 4; h++) {
        double volume = scene.compiled->hulls[h].volume;
        if (fabs(volume - expected[h]) > 3e-3 * expected[h])
            fail_msg("hull %u: %.6g, expected %.6g", h, volume, expected[h]);
    }
    fixture_clear(&scene);
}

/* A ball of radius 3 less a bore of that radius through its middle. */
static double pierced_ball(double bore)
{
    return 4 * pi / 3 * pow(9 - bore * bore, 1.5);
}

static double volume_of(const Fixture *scene, const char *name)
{
    return scene->compiled->hulls[scene->compiled->hull_of_object[fixture_object(scene, name)]].volume;
}

/* To what lines can tell; and to rounding as many times as large as that of a prototype, if it shares that one's. */
static void assert_volume(const Fixture *scene, const char *name, double expected, const char *prototype, double factor)
{
    double volume = volume_of(scene, name);
    if (fabs(volume - expected) > 5e-3 * expected) fail_msg("%s: %.9g, expected %.9g", name, volume, expected);
    double shared = factor * volume_of(scene, prototype);
    bool shares = fabs(volume - shared) < 1e-12 * shared;
    if (shares != (factor > 0)) fail_msg("%s: %.17g, %s has %.17g", name, volume, prototype, shared);
}

/* Nearly all of a pierced ball at a key is in the box where it is said to be, which is not much larger. */
static void assert_found(const Fixture *scene, const char *name, uint32_t key)
{
    const uint32_t object = fixture_object(scene, name), ball = object + 1;
    const Box3 box = scene->compiled->found_bounds[scene->compiled->hull_of_object[object]];
    const Affine *keys = scene_keys(scene->scene, &scene->scene->objects[ball]);
    const Affine place = keys ? keys[key] : scene->scene->objects[ball].to_world;
    Box3 seen = box3_empty();
    Dice dice = {9};
    for (int i = 0; i < 100000; i++) {
        Vec3 p = dice_point(&dice, 1); /* in a ball of radius 1 */
        if (vec3_length(p) > 1 || p.x * p.x + p.z * p.z < 1.0 / 9) continue;
        Vec3 there = affine_point(&place, p);
        if (!box3_holds_point(box, there)) fail_msg("%s is beyond its box", name);
        seen = box3_add_point(seen, there);
    }
    Vec3 size = vec3_sub(box.max, box.min), least = vec3_sub(seen.max, seen.min);
    if (!keys) assert_true(size.x < 1.2 * least.x && size.y < 1.2 * least.y && size.z < 1.2 * least.z);
}

#define PIERCED(bore)                                                                                                  \
    "interior = glass sphere { radius = 3 } cylinder { from = <0, -4, 0> to = <0, 4, 0> radius = " bore " } "

static void instances_share_what_is_measured(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double bore, factor;
        bool shares;
    } cases[] = {
        {"d other { translate(<20, 7, 0>) }", 1, 1, true},
        {"d other { rotate(x, 35) translate(<20, 0, 0>) interior = water }", 1, 1, true},
        {"d other { rotate(z, 50) scale(<-3, 1, .5>) rotate(x, 35) translate(<30, 0, 0>) priority = 3 }", 1, 1.5, true},
        {"d other { scale(1e-2) rotate(x, 77) translate(<200, 0, 0>) }", 1, 1e-6, true},
        {"d other { translate(<2e5, 1e5, 0>) }", 1, 1, false}, /* in coarse numbers */
        {"group { group { d other { scale(<1, -1, 1>) } scale(2) } translate(<30, 4, 4>) }", 1, 8, true},
        {"difference other { " PIERCED("1") " translate(<20, .1, 0>) }", 1, 1, true},
        {"difference other { " PIERCED("2") " translate(<20, 0, 0>) }", 2, 1, false},
        {"difference other { " PIERCED("1.00001") " translate(<20, 0, 0>) }", 1, 1, false},
        {"difference other { interior = glass sphere { radius = 3 } cylinder { from = <0, -4, 0> to = <0, 4, 0> radius "
         "= "
         "1 translate(<1e-5, 0, 0>) } translate(<20, 0, 0>) }",
         1, 1, false},
        {"difference other { " PIERCED("1") " sphere { radius = .9 } translate(<20, 0, 0>) }", 1, 1, false},
        {"difference { surface = surface { } sphere { radius = 3 } cylinder { from = <0, -4, 0> to = <0, 4, 0> radius "
         "= "
         "1 } translate(<40, 0, 0>) } d other { translate(<20, 0, 0>) }",
         1, 1, true},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1500];
        Fixture scene;
        snprintf(text, sizeof text, FIXTURE_MEDIA "let d = difference { " PIERCED("1") "} d first { } %s" FIXTURE_VIEW,
                 cases[i].text);
        fixture_compile(&scene, text, 1 + i % 2);
        assert_volume(&scene, "first", pierced_ball(1), "first", 1);
        assert_volume(&scene, "other", cases[i].factor * pierced_ball(cases[i].bore), "first",
                      cases[i].shares ? cases[i].factor : 0);
        assert_found(&scene, "first", 0);
        if (cases[i].bore == 1) assert_found(&scene, "other", 0);
        fixture_clear(&scene);
    }
    /* the operation counts, too */
    Fixture scene;
    fixture_compile(&scene,
                    FIXTURE_MEDIA "difference first { " PIERCED("1") "} intersection other { " PIERCED(
                        "1") "translate(<20, 0, 0>) }" FIXTURE_VIEW,
                    1);
    assert_volume(&scene, "other", 4 * pi / 3 * 27 - pierced_ball(1), "first", 0);
    fixture_clear(&scene);
}

#define SHUTTER " camera { from = <0, 0, 1000>  to = <0, 0, 0>  shutter = 180deg  shutter_steps = 2 } environment { } "

/* What moves has its mean volume, shared where its operands keep together. */
static void what_moves_shares_what_is_measured(void **state)
{
    (void)state;
    const double mean_cube = (pow(1.5, 4) - 1) / (4 * 0.5); /* of a number that grows from 1 to 1.5 */
    static const char moving[] = "d grows { scale(1 + clock) translate(<40 + 10 * clock, 0, 0>) } ";
    static const char others[] =
        "d shifts { rotate(x, 20) translate(<0, 30 + 3 * clock, 0>) } d stays { translate(<0, 60, 0>) } "
        "difference parts { interior = glass sphere { radius = 3 } cylinder { from = <0, -4, 0> to = <0, 4, 0> radius "
        "= 1 "
        "  translate(<.2 * clock, 0, 0>) } translate(<0, 90, 0>) }";
    char text[2000];
    Fixture scene;
    for (int alone = 0; alone < 2; alone++) { /* measured itself, and shared */
        snprintf(text, sizeof text, FIXTURE_MEDIA "let d = difference { " PIERCED("1") "} %s %s %s" SHUTTER,
                 alone ? "" : "d first { }", moving, alone ? "" : others);
        fixture_compile(&scene, text, 2);
        const char *from = alone ? "grows" : "first";
        assert_volume(&scene, "grows", mean_cube * pierced_ball(1), from, alone ? 1 : mean_cube);
        for (uint32_t key = 0; key < 3; key++) assert_found(&scene, "grows", key);
        if (!alone) {
            assert_volume(&scene, "stays", pierced_ball(1), from, 1);
            assert_volume(&scene, "shifts", pierced_ball(1), from, 1);
            assert_volume(&scene, "parts", pierced_ball(1), from, 0);
            for (uint32_t key = 0; key < 3; key++) assert_found(&scene, "shifts", key);
        }
        fixture_clear(&scene);
    }
    /* of the measured one, too */
    snprintf(text, sizeof text, FIXTURE_MEDIA "let d = difference { " PIERCED("1") "} %s d stays { }" SHUTTER, moving);
    fixture_compile(&scene, text, 2);
    assert_volume(&scene, "stays", pierced_ball(1), "grows", 1 / mean_cube);
    assert_found(&scene, "stays", 0);
    fixture_clear(&scene);
}

/* Inside the pierced cube of the scene below, by its formula. */
static bool in_pierced_cube(Vec3 p)
{
    bool cube = vec3_max_abs(p) < 10, ball = vec3_length(vec3_sub(p, vec3(10, 10, 10))) < 8;
    bool rod = p.y * p.y + p.z * p.z<36, cut = p.x> 9 && p.x < 12;
    return cube && !(rod && fabs(p.x) < 20) && !(ball && !cut);
}

static void interiors_of_points_are_found(void **state)
{
    (void)state;
    Fixture scene;
    fixture_compile(&scene,
                    FIXTURE_MEDIA "difference { interior = glass box { size = <20, 20, 20> }"
                                  "  cylinder { from = <-20, 0, 0> to = <20, 0, 0> radius = 6 }"
                                  "  difference { sphere { center = <10, 10, 10> radius = 8 }"
                                  "    box { from = <9, -30, -30> to = <12, 30, 30> } } }" FIXTURE_VIEW,
                    1);
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    Dice dice = {5};
    int n_inside = 0;
    for (int i = 0; i < 20000; i++) {
        Vec3 p = vec3_from_f(vec3f_from(dice_point(&dice, 12)));
        assert_int_equal(compiled_interior(scene.compiled, vec3f_from(p), 0, &hits, &list, NULL), STATUS_OK);
        uint32_t n = nest_list_count(&list) - compiled_operands_in(scene.compiled, &list);
        if ((n == 1) != in_pierced_cube(p)) fail_msg("<%.9g, %.9g, %.9g>: in %u hulls", p.x, p.y, p.z, n);
        n_inside += n == 1;
    }
    assert_true(n_inside > 3000);
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&scene);
}

/* A sea, a block of ice cut off by planes, and what a ray meets below. */
static void planes_divide_space(void **state)
{
    (void)state;
    Fixture scene;
    fixture_compile(
        &scene,
        FIXTURE_MEDIA
        "plane { interior = water  distance = 3 }"
        "intersection { interior = ice  plane { normal = <0, 1, 0>  distance = 5 }"
        "  plane { normal = <0, -1, 0>  distance = 1 }  cylinder { from = <0, -9, 0>  to = <0, 9, 0>  radius = 2 } }"
        "plane { interior = glass  normal = <1, 0, 1>  distance = -50 }" FIXTURE_VIEW,
        1);
    assert_true(isinf(scene.compiled->hulls[0].volume) && isinf(scene.compiled->hulls[2].volume));
    assert_true(fabs(scene.compiled->hulls[1].volume - 6 * 4 * pi) < 0.1);
    static const struct {
        float at[3];
        const char *owner;
    } points[] = {{{0, 2, 0}, "ice"},     {{0, 4.5f, 0}, "ice"},     {{3, 2.9f, 0}, "water"},
                  {{3, 3.1f, 0}, "air"},  {{0, -1.5f, 0}, "water"},  {{0, 5.1f, 0}, "air"},
                  {{-90, 9, 0}, "glass"}, {{-90, -900, 0}, "glass"}, {{1e6f, -1e6f, 3}, "water"}};
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    for (size_t i = 0; i < COUNT_OF(points); i++) {
        Vec3f p = {points[i].at[0], points[i].at[1], points[i].at[2]};
        assert_int_equal(compiled_interior(scene.compiled, p, 0, &hits, &list, NULL), STATUS_OK);
        uint32_t medium = nest_medium(&list);
        assert_string_equal(scene.scene->media[medium].name, points[i].owner);
    }
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&scene);
}

static void mistakes_are_reported(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        DiagCode code;
    } cases[] = {
        {"difference { sphere { } sphere { radius = .5 } }", D_MISSING_PROPERTY},
        {"difference { interior = glass sphere { } light { shape = \"sphere\" radius = 1 } }", D_MISPLACED},
        {"difference { interior = glass sphere { interior = water } sphere { radius = .5 } }",
         D_CONFLICTING_PROPERTIES},
        {"difference { interior = glass sphere { } sphere { radius = .5 surface = surface { } } }",
         D_CONFLICTING_PROPERTIES},
        {"union { interior = glass sphere { priority = 3 } }", D_CONFLICTING_PROPERTIES},
        {"union { interior = glass }", D_EMPTY_COMBINATION},
        {"union { interior = glass mesh { positions = [<0,0,0>, <1,0,0>, <0,1,0>] triangles = [<0,1,2>] } }",
         D_OPEN_MESH},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[600];
        snprintf(text, sizeof text, FIXTURE_MEDIA "%s" FIXTURE_VIEW, cases[i].text);
        fixture_refused(text, cases[i].code);
    }
}

static void operands_may_say_what_the_whole_is_made_of(void **state)
{
    (void)state;
    Fixture scene;
    fixture_compile(&scene,
                    FIXTURE_MEDIA
                    "let ball = sphere { interior = water }"
                    "difference { ball { } ball { translate(<1, 0, 0>) } }"
                    "intersection { box { size = <4, 4, 4> surface = surface { albedo = .2 } translate(<9, 0, 0>) }"
                    "  sphere { center = <9, 0, 0> radius = 2.5 } }" FIXTURE_VIEW,
                    1);
    assert_int_equal(scene.compiled->n_hulls, 1);
    assert_string_equal(scene.scene->media[scene.compiled->hulls[0].medium].name, "water");
    assert_true(scene.scene->objects[3].medium == SCENE_NONE && scene.scene->objects[3].surface != SCENE_NONE);
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(operands_show),
        cmocka_unit_test(lists_hold_what_the_operands_make_up),
        cmocka_unit_test(volumes_are_measured),
        cmocka_unit_test(instances_share_what_is_measured),
        cmocka_unit_test(what_moves_shares_what_is_measured),
        cmocka_unit_test(interiors_of_points_are_found),
        cmocka_unit_test(planes_divide_space),
        cmocka_unit_test(mistakes_are_reported),
        cmocka_unit_test(operands_may_say_what_the_whole_is_made_of),
    };
    return cmocka_run_group_tests_name("csg", tests, NULL, NULL);
}
