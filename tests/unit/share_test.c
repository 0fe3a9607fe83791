/* share_test.c - hulls that share a level: the media along lines stay what they are with lists in a row, faults are counted
 * and mended, and only hulls share that may.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"

/* ---- hulls on a line ---- */

enum { HULLS = 300, PLACES = 2000, LEVELS = NEST_NARROW, MEDIA = 4 };

/* Hulls that hold the line from begin to end. */
typedef struct Row {
    NestHull hulls[HULLS];
    uint32_t kinds[HULLS], begin[HULLS], end[HULLS], n;
    NestMeeting *meetings;
    size_t n_meetings;
    NestOverlap *overlaps;
    size_t n_overlaps;
    NestOrder rows, bits; /* the same, but for what is shared */
} Row;

/* Many short hulls and few long ones, at places some of which have several; a pair that touches meets. */
static void row_make(Row *row, uint64_t seed)
{
    Dice dice = {seed << 32};
    *row = (Row){.n = HULLS - (uint32_t)(dice_unit(&dice) * HULLS / 2)};
    double short_ones = 4 + 20 * dice_unit(&dice), long_part = 0.1 * dice_unit(&dice);
    for (uint32_t h = 0; h < row->n; h++) {
        double most = dice_unit(&dice) < long_part ? PLACES / 2 : short_ones;
        uint32_t length = 1 + (uint32_t)(most * dice_unit(&dice)), medium = (uint32_t)(MEDIA * dice_unit(&dice));
        row->begin[h] = (uint32_t)(dice_unit(&dice) * (PLACES - length));
        row->end[h] = row->begin[h] + length;
        int priority = dice_unit(&dice) < 0.1 ? 1 : 0;
        row->hulls[h] = (NestHull){medium, priority, NEST_STATE_UNKNOWN, length + 0.5 * dice_unit(&dice), false};
        row->kinds[h] = dice_unit(&dice) < 0.02 ? NEST_ALONE : medium;
    }
    row->meetings = malloc(sizeof *row->meetings * HULLS * HULLS);
    row->overlaps = malloc(sizeof *row->overlaps * HULLS * HULLS);
    for (uint32_t a = 0; a < row->n; a++)
        for (uint32_t b = a + 1; b < row->n; b++) {
            bool apart = row->begin[a] > row->end[b] || row->begin[b] > row->end[a];
            if (!apart)
                row->meetings[row->n_meetings++] = dice_unit(&dice) < 0.5 ? (NestMeeting){a, b} : (NestMeeting){b, a};
            if (!apart && row->begin[a] != row->end[b] && row->begin[b] != row->end[a])
                row->overlaps[row->n_overlaps++] = (NestOverlap){a, b, NEST_PARTIAL};
        }
    NestPolicy policy = seed % 2 ? NEST_AUTOMATIC : NEST_PRIORITY;
    NestOrder *orders[] = {&row->rows, &row->bits};
    for (int i = 0; i < 2; i++)
        assert_int_equal(nest_order_build(orders[i], policy, row->hulls, row->n, row->overlaps, row->n_overlaps, NULL),
                         STATUS_OK);
    assert_int_equal(nest_order_share(&row->bits, row->kinds, row->meetings, row->n_meetings, NULL), STATUS_OK);
}

static void row_clear(Row *row)
{
    nest_order_clear(&row->rows);
    nest_order_clear(&row->bits);
    free(row->meetings);
    free(row->overlaps);
}

/* The passes of one place. */
static uint32_t passes_at(const Row *row, uint32_t place, bool backwards, NestPass *passes)
{
    uint32_t n = 0;
    for (uint32_t h = 0; h < row->n; h++) {
        if (row->begin[h] == place) passes[n++] = (NestPass){h, !backwards};
        if (row->end[h] == place) passes[n++] = (NestPass){h, backwards};
    }
    return n;
}

static void row_walk(const Row *row, bool backwards)
{
    NestList rows, bits;
    nest_list_init(&rows);
    nest_list_init(&bits);
    for (uint32_t i = 0; i <= PLACES; i++) {
        NestPass passes[2 * HULLS];
        NestCrossing expected, crossing;
        uint32_t n = passes_at(row, backwards ? PLACES - i : i, backwards, passes);
        if (!n) continue;
        assert_int_equal(nest_cross(&rows, &row->rows, passes, n, &expected), STATUS_OK);
        if (n == 1)
            assert_int_equal(nest_cross_one(&bits, &row->bits, passes[0], &crossing), STATUS_OK);
        else
            assert_int_equal(nest_cross(&bits, &row->bits, passes, n, &crossing), STATUS_OK);
        assert_int_equal(crossing.medium_from, expected.medium_from);
        assert_int_equal(crossing.medium_to, expected.medium_to);
        assert_int_equal(crossing.n_faults, 0);
        assert_int_equal(nest_list_count(&bits), nest_list_count(&rows));
        for (uint32_t k = 0; k < nest_list_count(&rows); k++)
            assert_true(nest_has(&row->bits, &bits, nest_item(&row->rows, &rows, k)));
        uint32_t owner = nest_owner(&row->rows, &rows);
        if (owner != NEST_WORLD && row->kinds[owner] == NEST_ALONE)
            assert_int_equal(nest_owner(&row->bits, &bits), owner);
    }
    assert_int_equal(nest_list_count(&bits), 0);
    nest_list_clear(&rows);
    nest_list_clear(&bits);
}

/* Those on one level are of one kind and do not meet, and of those that meet the same one is on top as by rank. */
static void check_levels(const Row *row)
{
    const NestOrder *order = &row->bits;
    for (uint32_t h = 0; h < row->n; h++) {
        uint32_t level = order->top[h].level, other = order->hull_at[level];
        assert_in_range(level, 1, LEVELS);
        assert_int_equal(order->top[h].medium, row->hulls[h].medium);
        assert_int_equal(row->kinds[other], row->kinds[h]);
        if (row->kinds[h] == NEST_ALONE) assert_int_equal(other, h);
    }
    for (size_t i = 0; i < row->n_meetings; i++) {
        uint32_t a = row->meetings[i].a, b = row->meetings[i].b;
        assert_int_not_equal(order->top[a].level, order->top[b].level);
        assert_int_equal(order->top[a].level > order->top[b].level, order->rank[a] > order->rank[b]);
    }
}

static void test_media_are_the_same(void **state)
{
    (void)state;
    enum { SEEDS = 200 };
    int n_narrow = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        Row row;
        row_make(&row, seed);
        if (row.bits.narrow) {
            n_narrow++;
            check_levels(&row);
            row_walk(&row, false);
            row_walk(&row, true);
        } else { /* all stays as it was */
            for (uint32_t level = 0; level <= row.n; level++)
                assert_int_equal(row.bits.hull_at[level], row.rows.hull_at[level]);
        }
        row_clear(&row);
    }
    printf("%d of %d are narrow\n", n_narrow, SEEDS);
    if (NEST_NARROW) assert_in_range(n_narrow, SEEDS / 4, SEEDS - 1);
}

/* Bubbles in a drink in a glass, one behind the other. */
enum { DRINK, GLASS, BUBBLES, DRINK_MEDIUM = 1, GLASS_MEDIUM, GAS_MEDIUM };

static void make_bubbles(NestOrder *order, bool apart)
{
    NestHull hulls[HULLS];
    uint32_t kinds[HULLS];
    NestMeeting meetings[3 * HULLS];
    size_t n = 0;
    for (uint32_t h = 0; h < HULLS; h++) {
        kinds[h] = h < BUBBLES ? h + DRINK_MEDIUM : GAS_MEDIUM;
        hulls[h] = (NestHull){kinds[h], (int32_t)h, NEST_STATE_UNKNOWN, 1, false};
        if (h >= BUBBLES) meetings[n++] = (NestMeeting){h, DRINK};
        if (h >= GLASS) meetings[n++] = (NestMeeting){GLASS, h == GLASS ? (uint32_t)DRINK : h};
        if (!apart && h > BUBBLES) meetings[n++] = (NestMeeting){h, h - 1};
    }
    assert_int_equal(nest_order_build(order, NEST_PRIORITY, hulls, HULLS, NULL, 0, NULL), STATUS_OK);
    assert_int_equal(nest_order_share(order, kinds, meetings, n, NULL), STATUS_OK);
}

/* One crossing, the medium behind it, and whether it was a fault. */
static void cross_to(NestList *list, const NestOrder *order, NestPass pass, uint32_t medium, uint32_t n_faults)
{
    NestCrossing crossing;
    assert_int_equal(nest_cross_one(list, order, pass, &crossing), STATUS_OK);
    assert_int_equal(crossing.medium_to, medium);
    assert_int_equal(crossing.n_faults, n_faults);
}

static void test_faults_heal(void **state)
{
    (void)state;
    NestOrder order;
    NestList list;
    make_bubbles(&order, true);
    nest_list_init(&list);
    if (NEST_NARROW) {
        assert_true(order.narrow);
        assert_int_equal(order.top[BUBBLES].level, order.top[HULLS - 1].level);
        cross_to(&list, &order, (NestPass){DRINK, true}, DRINK_MEDIUM, 0);
        cross_to(&list, &order, (NestPass){BUBBLES, true}, GAS_MEDIUM, 0);
        /* the way out is lost: the next bubble says so, and mends it */
        cross_to(&list, &order, (NestPass){BUBBLES + 1, true}, GAS_MEDIUM, 1);
        cross_to(&list, &order, (NestPass){BUBBLES + 1, false}, DRINK_MEDIUM, 0);
        cross_to(&list, &order, (NestPass){BUBBLES + 2, true}, GAS_MEDIUM, 0);
        cross_to(&list, &order, (NestPass){BUBBLES + 2, false}, DRINK_MEDIUM, 0);
        /* the way in is lost: the way out says so */
        cross_to(&list, &order, (NestPass){BUBBLES + 3, false}, DRINK_MEDIUM, 1);
        cross_to(&list, &order, (NestPass){BUBBLES + 4, true}, GAS_MEDIUM, 0);
        cross_to(&list, &order, (NestPass){BUBBLES + 4, false}, DRINK_MEDIUM, 0);
        cross_to(&list, &order, (NestPass){DRINK, false}, NEST_WORLD_MEDIUM, 0);
        assert_int_equal(nest_list_count(&list), 0);
    }
    nest_list_clear(&list);
    nest_order_clear(&order);
}

/* A chain of bubbles takes as many levels as it is long where each is above the last: too many. */
static void test_too_many_stay_in_rows(void **state)
{
    (void)state;
    NestOrder order;
    make_bubbles(&order, false);
    assert_false(order.narrow);
    for (uint32_t h = 0; h < HULLS; h++) assert_int_equal(order.top[h].level, h + 1);
    nest_order_clear(&order);
}

/* ---- hulls of scenes ---- */

#define CROWD "for (i in 1..80) { sphere { interior = gas radius = .2 center = <i, 90, 0> } } "

static void compile_shared(Fixture *f, const char *text)
{
    fixture_compile(f, text, 1);
    assert_int_equal(compiled_share_levels(f->compiled, &f->error), STATUS_OK);
}

static uint32_t level_of(const Fixture *f, const char *name)
{
    for (uint32_t h = 0; h < f->compiled->n_hulls; h++)
        if (strcmp(f->scene->objects[f->compiled->object_of_hull[h]].name, name) == 0)
            return f->compiled->order.top[h].level;
    fail_msg("no hull %s", name);
    return 0;
}

/* Whether a and b of a scene, in which there are many bubbles besides, share a level. */
static bool share(const char *text)
{
    Fixture f;
    compile_shared(&f, text);
    if (NEST_NARROW) assert_true(f.compiled->order.narrow);
    bool same = level_of(&f, "a") == level_of(&f, "b");
    fixture_clear(&f);
    return same;
}
#define SHARE(nodes) share(FIXTURE_MEDIA CROWD nodes FIXTURE_VIEW)

static void test_who_shares(void **state)
{
    (void)state;
    if (!NEST_NARROW) return;
    assert_true(SHARE("sphere a { interior = water } sphere b { interior = water center = <3, 0, 0> }"));
    assert_true(SHARE("box a { interior = water size = <1, 1, 1> } box b { interior = water size = <1, 1, 1> "
                      "translate(<3, 0, 0>) }"));
    /* of other media, overlapping, touching, within rounding; in each other */
    assert_false(SHARE("sphere a { interior = water } sphere b { interior = ice center = <3, 0, 0> }"));
    assert_false(SHARE("sphere a { interior = water } sphere b { interior = water center = <1, 0, 0> }"));
    assert_false(SHARE("sphere a { interior = water } sphere b { interior = water center = <2, 0, 0> }"));
    assert_false(SHARE("sphere a { interior = water } sphere b { interior = water center = <2 + 1e-8, 0, 0> }"));
    assert_true(SHARE("sphere a { interior = water } sphere b { interior = water center = <2 + 1e-5, 0, 0> }"));
    assert_false(SHARE("sphere a { interior = water } sphere b { interior = water radius = .2 }"));
    assert_false(
        SHARE("box a { interior = water from = <0, 0, 0> to = <1, 1, 1> } box b { interior = water from = <1, 0, "
              "0> to = <2, 1, 1> }"));
    assert_false(
        SHARE("box a { interior = water from = <0, 0, 0> to = <1, 1, 1> } box b { interior = water from = <1 + "
              "1e-8, 0, 0> to = <2, 1, 1> }"));
    assert_false(
        SHARE("box a { interior = water from = <0, 0, 0> to = <4, 4, 4> } sphere b { interior = water center = "
              "<2, 2, 2> }"));
    /* what is told apart */
    assert_false(SHARE("medium lava { ior = 1.5 emission = 1 } sphere a { interior = lava } sphere b { interior = lava "
                       "center = <3, 0, 0> }"));
    assert_false(SHARE("plane a { interior = water distance = -9 } plane b { interior = water distance = -90 "
                       "rotate(x, 170) }"));
}

static void test_what_moves(void **state)
{
    (void)state;
    if (!NEST_NARROW) return;
#define SHUTTER " camera { from = <0, 0, 1000>  to = <0, 0, 0>  shutter = 360deg  shutter_steps = 2 } environment { } "
#define MOVING(path)                                                                                                   \
    share(FIXTURE_MEDIA CROWD "sphere a { interior = water center = " path " * clock } sphere b { "                    \
                              "interior = water center = <9, 0, 0> } " SHUTTER)
    assert_false(MOVING("<18, 0, 0>"));
    assert_true(MOVING("<0, 18, 0>"));
}

/* Lists stay rows where hulls are not kept by rank, and where few are enough they are told apart. */
static void test_what_stays(void **state)
{
    (void)state;
    const char *const texts[] = {
        FIXTURE_MEDIA CROWD "render { nesting = entered } " FIXTURE_VIEW,
        FIXTURE_MEDIA CROWD "render { nesting = none } " FIXTURE_VIEW,
        FIXTURE_MEDIA CROWD "union { interior = water  sphere { }  sphere { center = <1, 0, 0> } } " FIXTURE_VIEW,
        FIXTURE_MEDIA CROWD "medium mist { mixes = true scattering = .1 } sphere { interior = mist } " FIXTURE_VIEW,
        FIXTURE_MEDIA "for (i in 1..60) { sphere { interior = gas radius = .2 center = <i, 90, 0> } } " FIXTURE_VIEW};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        Fixture f;
        compile_shared(&f, texts[i]);
        const NestOrder *order = &f.compiled->order;
        assert_int_equal(order->narrow, NEST_NARROW && i == 4);
        for (uint32_t h = 0; h < f.compiled->n_hulls; h++)
            if (!nest_mixes(order, h)) assert_int_equal(order->top[h].level, order->rank[h] + 1);
        fixture_clear(&f);
    }
}

/* The media along a line through a scene, surface by surface. Returns how many. */
enum { MOST = 400 };
static size_t media_along(const CompiledScene *compiled, const Ray *ray, HitList *hits, NestList *list, uint32_t *media)
{
    size_t n = 0;
    nest_list_empty(list);
    rtc_all(compiled->rtc, ray, false, hits);
    for (size_t i = 0, cluster; i < hits->n && n < MOST; i += cluster) {
        NestPass passes[MOST];
        NestCrossing crossing;
        cluster = rtc_cluster(hits->items + i, hits->n - i);
        for (size_t k = 0; k < cluster; k++)
            passes[k] = (NestPass){compiled->hull_of_object[hits->items[i + k].object], hits->items[i + k].entering};
        assert_int_equal(nest_cross(list, &compiled->order, passes, (uint32_t)cluster, &crossing), STATUS_OK);
        assert_int_equal(crossing.n_faults, 0);
        media[n++] = crossing.medium_to;
    }
    assert_int_equal(nest_list_count(list), 0);
    return n;
}

/* Random lines, and random points, with hulls told apart and not. */
static void compare(const char *text)
{
    Fixture apart, shared;
    fixture_compile(&apart, text, 1);
    compile_shared(&shared, text);
    assert_true(!NEST_NARROW || shared.compiled->order.narrow);
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    Dice dice = {7};
    size_t total = 0;
    for (int i = 0; i < 20000; i++) {
        Vec3 from = vec3_scale(dice_direction(&dice), 400);
        Vec3 to = vec3(24 * dice_unit(&dice) - 12, 24 * dice_unit(&dice) - 2, 24 * dice_unit(&dice) - 12);
        Ray ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(to, from))));
        uint32_t expected[MOST], media[MOST];
        size_t n = media_along(apart.compiled, &ray, &hits, &list, expected);
        assert_int_equal(media_along(shared.compiled, &ray, &hits, &list, media), n);
        assert_memory_equal(media, expected, n * sizeof *media);
        total += n;
        if (i % 20) continue;
        assert_int_equal(compiled_interior(apart.compiled, vec3f_from(to), 0, &hits, &list, NULL), STATUS_OK);
        uint32_t medium = nest_medium(&list), count = nest_list_count(&list);
        assert_int_equal(compiled_interior(shared.compiled, vec3f_from(to), 0, &hits, &list, NULL), STATUS_OK);
        assert_int_equal(nest_medium(&list), medium);
        assert_int_equal(nest_list_count(&list), count);
    }
    printf("%zu crossings\n", total);
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&apart);
    fixture_clear(&shared);
}

#define TUMBLER "lathe { interior = glass profile = [<0,-2>, <11,-2>, <11,26>, <8.9,26>, <8.9,.1>, <0,.1>] } "

static void test_lines_through_scenes(void **state)
{
    (void)state;
    /* bubbles and cubes, many of which overlap each other, and the drink's surface, and the glass */
    compare(FIXTURE_MEDIA TUMBLER
            "cylinder { interior = water  from = <0, 0, 0>  to = <0, 20, 0>  radius = 9 } "
            "for (i in 1..300) { sphere { interior = gas  radius = .1 + .5 * rnd(4, i) "
            "center = <18 * rnd(1, i) - 9, 22 * rnd(2, i), 18 * rnd(3, i) - 9> } } "
            "for (i in 1..20) { box { interior = ice  size = <2, 2, 2>  rotate(<1, 2, 3>, 360 * rnd(9, i)) "
            "translate(<12 * rnd(6, i) - 6, 20 * rnd(7, i), 12 * rnd(8, i) - 6>) } } " FIXTURE_VIEW);
    /* cubes face to face in a grid, of one medium by turns */
    compare(FIXTURE_MEDIA
            "for (i in 0..5) { for (j in 0..5) { for (k in 0..5) { let m = (i + j + k) % 2 "
            "box { interior = m == 0 ? water : ice  from = 2 * <i, j, k>  to = 2 * <i, j, k> + <2, 2, 2> } "
            "} } } " FIXTURE_VIEW);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_media_are_the_same),
        cmocka_unit_test(test_faults_heal),
        cmocka_unit_test(test_too_many_stay_in_rows),
        cmocka_unit_test(test_who_shares),
        cmocka_unit_test(test_what_moves),
        cmocka_unit_test(test_what_stays),
        cmocka_unit_test(test_lines_through_scenes),
    };
    return cmocka_run_group_tests_name("share", tests, NULL, NULL);
}
