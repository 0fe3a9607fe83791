/* compile_test.c - how hulls lie to each other, the order that follows, and which hulls hold a point.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "check/report.h"
#include "scene_fixture.h"

static const double pi = 3.14159265358979323846;

#define M FIXTURE_MEDIA
#define V FIXTURE_VIEW
#define COMPILE(f, text) fixture_compile(f, M text V, 1)

/* What text says of its two named objects a and b. */
static HullPair pair_in(const char *text)
{
    char whole[4000];
    snprintf(whole, sizeof whole, "%s%s%s", M, text, V);
    Fixture f;
    fixture_compile(&f, whole, 1);
    const HullPair *found = fixture_pair(&f, "a", "b");
    HullPair pair = found ? *found : (HullPair){.gap = HUGE_VAL};
    fixture_clear(&f);
    return pair;
}

static void assert_overlap(const char *text, NestRelation relation, double volume)
{
    HullPair pair = pair_in(text);
    if (!pair.overlaps || pair.relation != relation)
        fail_msg("%s: overlaps %d, relation %d", text, pair.overlaps, pair.relation);
    double slack = 4 * pair.overlap_volume_error + 1e-6 * volume;
    if (!(fabs(pair.overlap_volume - volume) <= slack) || !(pair.overlap_volume_error <= 0.2 * volume))
        fail_msg("%s: %g +- %g, not %g", text, pair.overlap_volume, pair.overlap_volume_error, volume);
}

/* ---- pairs ---- */

static void contained_hulls_are_seen_to_be(void **state)
{
    (void)state;
    assert_overlap("box a { interior = glass size = <10, 10, 10> } sphere b { interior = gas radius = 2 }", NEST_B_IN_A,
                   32 * pi / 3);
    assert_overlap("sphere a { interior = gas radius = 2 } box b { interior = glass size = <4, 4, 4> }", NEST_A_IN_B,
                   32 * pi / 3);
    assert_overlap("sphere a { interior = gas radius = 2 } sphere b { interior = glass radius = 3 center = <1, 0, 0> }",
                   NEST_A_IN_B, 32 * pi / 3);
    /* faces in one plane, inside all the same */
    assert_overlap("box a { interior = glass from = <0, 0, 0> to = <4, 4, 4> } box b { interior = water from = <0, 0, "
                   "0> to = <4, 2, 1> }",
                   NEST_B_IN_A, 8);
    assert_overlap("cylinder a { interior = glass to = <0, 9, 0> radius = 3 } cylinder b { interior = water to = <0, "
                   "9, 0> radius = 2 }",
                   NEST_B_IN_A, 36 * pi);
    /* the same hull twice is in neither */
    assert_overlap("box a { interior = glass size = <1, 2, 3> } box b { interior = water size = <1, 2, 3> }",
                   NEST_PARTIAL, 6);
    assert_overlap("sphere a { interior = glass } sphere b { interior = water }", NEST_PARTIAL, 4 * pi / 3);
    /* mirrored, turned and instanced */
    assert_overlap(
        "group { scale(<-1, 1, 1>) rotate(<10, 20, 30>) box a { interior = glass size = <10, 10, 10> bevel = 1 } "
        "sphere b { interior = gas radius = 2 center = <1, 1, 1> } }",
        NEST_B_IN_A, 32 * pi / 3);
    /* a hair's breadth sticks out */
    assert_overlap("box a { interior = glass size = <10, 10, 10> } cylinder b { interior = water from = <0, -5.001, 0> "
                   "to = <0, 0, 0> radius = 2 }",
                   NEST_PARTIAL, 20 * pi);
}

static void overlaps_are_measured(void **state)
{
    (void)state;
    assert_overlap(
        "box a { interior = glass size = <2, 2, 2> } box b { interior = water from = <0, 0, 0> to = <3, 3, 3> }",
        NEST_PARTIAL, 1);
    assert_overlap("sphere a { interior = glass } sphere b { interior = water center = <1, 0, 0> }", NEST_PARTIAL,
                   5 * pi / 12);
    assert_overlap("cylinder a { interior = glass from = <0, -9, 0> to = <0, 9, 0> radius = 1 } box b { interior = "
                   "water size = <30, 2, 30> }",
                   NEST_PARTIAL, 2 * pi);
    /* two thick rods that cross: no surface of either in the middle */
    assert_overlap("box a { interior = glass size = <90, 9, 9> } box b { interior = water size = <9, 9.5, 90> }",
                   NEST_PARTIAL, 729);
    /* a drink that reaches a tenth of a millimetre into its tumbler */
    assert_overlap(
        "lathe a { interior = glass profile = [<0, 0>, <38, 0>, <40, 2>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
        "cylinder b { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }",
        NEST_PARTIAL, pi * (37 * 37 * .1 + (37.1 * 37.1 - 37 * 37) * 34.1));
    /* panes of a tank */
    assert_overlap("box a { interior = glass from = <-51, -1, -26> to = <51, 0, 26> } box b { interior = glass from = "
                   "<49.8, -.1, -26> to = <51, 45, 26> }",
                   NEST_PARTIAL, 1.2 * .1 * 52);
}

static void small_overlaps_are_not_missed(void **state)
{
    (void)state;
    /* corners */
    assert_true(pair_in("box a { interior = glass size = <2, 2, 2> } box b { interior = water from = <.999, .999, "
                        ".999> to = <9, 9, 9> }")
                    .overlaps);
    /* the top of a ball, 0.01 deep into a large plate: a cap 0.28 wide, 1 part in 5,000 of the ball's silhouette */
    assert_true(pair_in("sphere a { interior = gas radius = 2 center = <0, 2, 0> scale(<1, 1, 1.001>) } "
                        "box b { interior = glass from = <-50, 3.99, -50> to = <50, 9, 50> }")
                    .overlaps);
    /* an ellipsoid that bites into a cylinder's side by 0.002 of its size, off any axis */
    assert_true(pair_in("sphere a { interior = gas scale(<1, 1.5, 1>) translate(<1.41, .3, 1.41>) } "
                        "cylinder b { interior = glass from = <0, -5, 0> to = <0, 5, 0> radius = .996 }")
                    .overlaps);
    /* and these do not overlap */
    assert_false(pair_in("sphere a { interior = gas scale(<1, 1.5, 1>) translate(<1.42, .3, 1.42>) } "
                         "cylinder b { interior = glass from = <0, -5, 0> to = <0, 5, 0> radius = .996 }")
                     .overlaps);
    assert_false(pair_in("box a { interior = glass size = <2, 2, 2> } box b { interior = water from = <1.001, .999, "
                         ".999> to = <9, 9, 9> }")
                     .overlaps);
    assert_false(
        pair_in("sphere a { interior = glass } sphere b { interior = water center = <1.2, 1.2, 1.2> }").overlaps);
}

static void touching_and_gaps_are_told_apart(void **state)
{
    (void)state;
    HullPair pair = pair_in("box a { interior = glass from = <0, 0, 0> to = <4, 1, 4> } box b { interior = water from "
                            "= <0, 1, 0> to = <4, 3, 4> }");
    assert_true(pair.touches && !pair.overlaps && isinf(pair.gap));
    pair = pair_in("lathe a { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                   "cylinder b { interior = water from = <0, 10.1, 0> to = <0, 44, 0> radius = 36.9 }");
    assert_true(!pair.touches && !pair.overlaps);
    assert_near(pair.gap, .1, 1e-4);
    /* a gap at the side and an overlap at the bottom */
    pair = pair_in("lathe a { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                   "cylinder b { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 36.9 }");
    assert_true(pair.overlaps);
    assert_near(pair.gap, .1, 1e-4);
    /* a gap that is filled is none; a ball that rests on a plate is no gap; a wide gap is meant */
    assert_true(isinf(pair_in("box a { interior = glass from = <0, 0, 0> to = <4, 1, 4> } box b { interior = ice from "
                              "= <0, 1.01, 0> to = <4, 3, 4> }"
                              "box { interior = water from = <-1, -1, -1> to = <9, 9, 9> }")
                          .gap));
    /* by two that meet in its middle, too, of which neither is there */
    assert_true(isinf(pair_in("box a { interior = glass from = <0, 0, 0> to = <4, 1, 4> } box b { interior = ice from "
                              "= <0, 1.02, 0> to = <4, 3, 4> }"
                              "for (i in 0..1) { box { interior = water from = <0, 1 + .01 * i, 0> to = <4, 1 + .01 * "
                              "(i + 1), 4> } }")
                          .gap));
    assert_true(isinf(
        pair_in("box a { interior = glass from = <-9, -2, -9> to = <9, -1, 9> } sphere b { interior = ice }").gap));
    assert_true(isinf(pair_in("box a { interior = glass from = <0, 0, 0> to = <4, 1, 4> } box b { interior = ice from "
                              "= <0, 1.5, 0> to = <4, 3, 4> }")
                          .gap));
}

/* Beside an edge where two boxes meet, and around the place where a ball of a large radius rests, the smallest distance that
 * a line meets is chance; a gap that is open at its narrowest is told from those. */
static void wedges_are_told_from_gaps(void **state)
{
    static const struct {
        const char *other;
        bool wedge;
        double gap;
    } cases[] = {
        {"box b { interior = ice from = <0, 0, 0> to = <20, 10, 20> rotate(z, 1) }", true, 0},
        {"sphere b { interior = ice radius = 100 center = <10, 100, 10> }", true, 0},
        {"box b { interior = ice from = <0, 0, 0> to = <20, 10, 20> rotate(z, 1) translate(y * .05) }", false, .05},
        {"box b { interior = ice from = <0, .01, 0> to = <20, 10, 20> }", false, .01},
        {"box b { interior = ice from = <0, .01, 0> to = <20, 10, 20> bevel = 1 }", false, .01},
        {"sphere b { interior = ice radius = 100 center = <10, 100.1, 10> }", false, .1},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[400];
        snprintf(text, sizeof text, "box a { interior = glass from = <0, -10, 0> to = <20, 0, 20> } %s",
                 cases[i].other);
        HullPair pair = pair_in(text);
        assert_true(isfinite(pair.gap) && pair.gap_most >= pair.gap);
        if (pair.wedge != cases[i].wedge) fail_msg("%s: wedge %d", text, pair.wedge);
        if (!pair.wedge) assert_true(pair.gap >= 0.99 * cases[i].gap && pair.gap < 1.2 * cases[i].gap);
    }
}

static void assert_estimate(const char *what, double value, double standard_error, double expected)
{
    if (!(fabs(value - expected) <= 4 * standard_error + 1e-4 * expected) || !(standard_error <= 0.1 * expected))
        fail_msg("%s: %g +- %g, not %g", what, value, standard_error, expected);
}

#define RODS(gap)                                                                                                      \
    "box a { interior = glass from = <0, 0, 0> to = <40, 3, 60> } box b { interior = water from = <0, " gap            \
    ", 0> to = <30, 50, 50> }"

/* The area of a contact and of a gap, and how deep an overlap is. */
static void areas_and_depths_are_measured(void **state)
{
    (void)state;
    HullPair pair = pair_in(RODS("3"));
    assert_true(pair.touches && !pair.overlaps && pair.contact_offset < 1e-9);
    assert_estimate("contact", pair.contact_area, pair.contact_area_error, 1500);
    pair = pair_in("group { rotate(<10, 20, 30>) " RODS("3") "}");
    assert_true(pair.touches && pair.contact_offset < 1e-4);
    assert_estimate("contact, turned", pair.contact_area, pair.contact_area_error, 1500);
    pair = pair_in(RODS("3.25"));
    assert_near(pair.gap, .25, 1e-5);
    assert_estimate("gap", pair.gap_area, pair.gap_area_error, 1500);
    /* wide for panes 3 thick, narrow beside their width */
    pair = pair_in(RODS("3.6"));
    assert_near(pair.gap, .6, 1e-5);
    /* the bottom and the wall of a tumbler */
    pair = pair_in("lathe a { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                   "cylinder b { interior = water from = <0, 10, 0> to = <0, 44, 0> radius = 37 }");
    assert_estimate("contact in a tumbler", pair.contact_area, pair.contact_area_error, pi * (37 * 37 + 2 * 37 * 34));
    pair = pair_in("lathe a { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                   "cylinder b { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }");
    assert_true(pair.overlap_depth > .099 && pair.overlap_depth < .15);
    pair =
        pair_in("sphere a { interior = glass radius = 3 } sphere b { interior = water radius = 2 center = <4, 0, 0> }");
    assert_near(pair.overlap_depth, 1, 1e-12);
    /* a ball that is none to the program: the lens between two spheres again, from lines */
    pair = pair_in("sphere a { interior = glass radius = 3 } "
                   "sphere b { interior = water radius = 2 scale(<1, 1, 1.0001>) translate(<4, 0, 0>) }");
    assert_true(pair.overlap_depth > .9 && pair.overlap_depth < 1.01);
    assert_estimate("lens", pair.overlap_volume, pair.overlap_volume_error, pi * (16 + 8 * 5 - 3) / 48);
}

/* Where an object keeps away from the surface of another, the answer is exact; near it nothing is missed. */
static void pairs_that_keep_apart_are_decided_at_once(void **state)
{
    (void)state;
    /* of a drink: far inside, near its wall and through it; the same of what is turned and stretched */
    static const char *const drinks[] = {
        "cylinder a { interior = water from = <0, 10, 0> to = <0, 80, 0> radius = 37",
        "lathe a { interior = water profile = [<0, 10>, <37, 10>, <37, 80>, <0, 80>] rounding = [0, 9, 1, 0]",
        "capsule a { interior = water from = <0, 20, 0> to = <0, 70, 0> radius = 37",
        "box a { interior = water from = <-37, 10, -37> to = <37, 80, 37>"};
    static const char *const turns[] = {"", "rotate(<20, 30, 40>)", "scale(<2, .5, 1>) rotate(<50, 10, 80>)"};
    static const char *const places[] = {"20, 40, 5", "36.6, 40, 0", "37.9, 40, 37.9"};
    for (size_t i = 0; i < COUNT_OF(drinks) * COUNT_OF(turns) * COUNT_OF(places); i++) {
        const char *drink = drinks[i / 9], *turn = turns[i / 3 % 3];
        double volume = 4 * pi / 3 * 1.2;
        char text[700];
        snprintf(text, sizeof text, "%s %s } sphere b { interior = gas scale(<1, 1.2, 1>) translate(<%s>) %s } ", drink,
                 turn, places[i % 3], turn);
        HullPair pair = pair_in(text);
        if (i % 3 == 0) { /* well inside */
            assert_true(pair.overlaps && !pair.touches && pair.relation == NEST_B_IN_A &&
                        pair.overlap_volume_error == 0);
            assert_near(pair.overlap_volume, volume, 1e-9);
        } else if (i % 3 == 1) { /* through the wall */
            assert_true(pair.overlaps && pair.relation == NEST_PARTIAL && pair.overlap_volume < 0.9 * volume);
        } else { /* outside, within the drink's bounds */
            assert_true(!pair.overlaps && !pair.touches && isinf(pair.gap));
        }
    }
    /* a combination of which nothing is left has bounds, but is nowhere */
    assert_false(
        pair_in(
            "intersection a { interior = glass sphere { radius = 1 } sphere { radius = 1 center = <1.9, 1.9, 0> } } "
            "cylinder b { interior = water from = <0, -9, 0> to = <0, 9, 0> radius = 9 }")
            .overlaps);
    /* boxes whose bounds share much, but nothing else: room between them, a thin gap, contact, and an overlap */
#define LEANING(height)                                                                                                \
    "box a { interior = glass size = <10, 2, 2> rotate(z, 45) } "                                                      \
    "box b { interior = ice size = <10, 2, 2> translate(" height " * y) rotate(z, 45) }"
    HullPair pair = pair_in(LEANING("2.3"));
    assert_true(!pair.overlaps && !pair.touches && isinf(pair.gap));
    pair = pair_in(LEANING("2.03"));
    assert_true(!pair.overlaps && !pair.touches);
    assert_near(pair.gap, 0.03, 1e-3);
    assert_true(pair_in(LEANING("2")).touches);
    pair = pair_in(LEANING("1.95"));
    assert_true(pair.overlaps && pair.relation == NEST_PARTIAL);
    assert_near(pair.overlap_depth, 0.05, 1e-6);
}

static size_t count_pairs(const Fixture *f, bool touching)
{
    size_t n = 0;
    for (size_t i = 0; i < f->compiled->n_pairs; i++) {
        const HullPair *pair = &f->compiled->pairs[i];
        if (touching ? pair->touches && pair->contact_area > 0.5 : isfinite(pair->gap)) n++;
        if (touching && pair->touches && pair->contact_area > 0.5) /* a whole face */
            assert_true(fabs(pair->contact_area - 1) < 6 * pair->contact_area_error + 0.02);
    }
    return n;
}

/* Pairs that lie alike have one answer, but not where something else has a part in it. */
static void pairs_that_lie_alike_are_judged_once(void **state)
{
    (void)state;
#define GRID(step)                                                                                                     \
    M "let cube = box { interior = glass from = <0, 0, 0> to = <1, 1, 1> } "                                           \
      "for (i in 1..5) { for (j in 1..5) { for (k in 1..5) { cube { translate(<i, j, k> * " step ") } } } }" V
    Fixture f;
    size_t n_overlaps = 0;
    fixture_compile(&f, GRID("1"), 2);
    assert_int_equal(count_pairs(&f, true), 3 * 4 * 25);
    for (size_t i = 0; i < f.compiled->n_pairs; i++) {
        const HullPair *pair = &f.compiled->pairs[i];
        if (pair->overlaps) { /* rounding, at edges */
            assert_true(pair->overlap_volume < 1e-8);
            n_overlaps++;
        }
        assert_true(pair->a < pair->b);
        assert_true(i == 0 || pair[-1].a < pair->a || (pair[-1].a == pair->a && pair[-1].b < pair->b));
    }
    assert_true(n_overlaps < 30);
    fixture_clear(&f);
    fixture_compile(&f, GRID("1.01"), 1);
    assert_int_equal(count_pairs(&f, false), 3 * 4 * 25);
    fixture_clear(&f);
    /* the same cubes, which overlap */
    fixture_compile(&f, GRID(".9"), 1);
    n_overlaps = 0;
    for (size_t i = 0; i < f.compiled->n_pairs; i++) {
        const HullPair *pair = &f.compiled->pairs[i];
        if (pair->overlaps && pair->overlap_volume > 0.05) {
            assert_true(fabs(pair->overlap_volume - 0.1) < 4 * pair->overlap_volume_error + 1e-3);
            n_overlaps++;
        }
    }
    assert_int_equal(n_overlaps, 3 * 4 * 25);
    fixture_clear(&f);
    /* a thin gap, and the same pair with a sheet in it, whichever comes first */
    for (int first = 0; first < 2; first++) {
        char text[1500];
        snprintf(text, sizeof text,
                 "%s let plate = box { interior = glass from = <0, 0, 0> to = <10, 1, 10> } "
                 "for (x in [0, 20]) { plate { translate(<x, 0, 0>) } plate { translate(<x, 1.015, 0>) } } "
                 "box sheet { interior = water from = <%d, 1, -1> to = <%d, 1.015, 11> } %s",
                 M, 20 * first - 1, 20 * first + 11, V);
        fixture_compile(&f, text, 1);
        size_t n = 0;
        for (size_t i = 0; i < f.compiled->n_pairs; i++)
            if (isfinite(f.compiled->pairs[i].gap)) {
                assert_int_equal(f.compiled->pairs[i].a, first ? 0 : 2);
                assert_int_equal(f.compiled->pairs[i].b, first ? 1 : 3);
                n++;
            }
        assert_int_equal(n, 1);
        fixture_clear(&f);
    }
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    const char *text = M "lathe { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                         "cylinder { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }"
                         "for (i in 1..40) { box { interior = ice size = <9, 9, 9> rotate(<i, 2 * i, 3 * i>) "
                         "translate(<25 * cos(77 * i), 10 + i, 25 * sin(77 * i)>) } "
                         "for (k in 1..10) { sphere { interior = gas scale(<1, 1.2, 1>) "
                         "translate(<34 * cos(9 * i), 6 * k, 34 * sin(9 * i)>) } } }" V;
    Fixture one, many;
    fixture_compile(&one, text, 1);
    fixture_compile(&many, text, 3);
    assert_int_equal(one.compiled->n_pairs, many.compiled->n_pairs);
    assert_true(one.compiled->n_pairs > 40);
    for (size_t i = 0; i < one.compiled->n_pairs; i++) {
        const HullPair *a = &one.compiled->pairs[i], *b = &many.compiled->pairs[i];
        assert_true(a->a == b->a && a->b == b->b && a->relation == b->relation &&
                    a->overlap_volume == b->overlap_volume);
    }
    for (uint32_t h = 0; h < one.compiled->n_hulls; h++)
        assert_int_equal(one.compiled->order.rank[h], many.compiled->order.rank[h]);
    fixture_clear(&one);
    fixture_clear(&many);
}

/* ---- order ---- */

static uint32_t rank_of(const Fixture *f, const char *name)
{
    return f->compiled->order.rank[f->compiled->hull_of_object[fixture_object(f, name)]];
}

static void the_order_follows_the_rules(void **state)
{
    (void)state;
    Fixture f;
    /* state of matter: glass over the larger and the smaller drink; the ice over the drink; the bubble inside */
    COMPILE(&f, "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
                "cylinder drink { interior = water from = <0, 9.9, 0> to = <0, 90, 0> radius = 37.1 }"
                "box cube { interior = ice size = <24, 24, 24> translate(<0, 85, 0>) } sphere bead { interior = gas "
                "center = <0, 40, 0> }");
    assert_true(rank_of(&f, "tumbler") > rank_of(&f, "drink"));
    assert_true(rank_of(&f, "cube") > rank_of(&f, "drink"));
    assert_true(rank_of(&f, "bead") > rank_of(&f, "drink"));
    fixture_clear(&f);
    COMPILE(&f, "sphere a { interior = oil radius = 2 } sphere b { interior = glass center = <2, 0, 0> }");
    assert_true(rank_of(&f, "b") > rank_of(&f, "a"));
    fixture_clear(&f);
    COMPILE(&f, "sphere a { interior = oil radius = 2 priority = 1 } sphere b { interior = glass center = <2, 0, 0> }");
    assert_true(rank_of(&f, "a") > rank_of(&f, "b"));
    fixture_clear(&f);
}

static void circles_are_reported(void **state)
{
    (void)state;
    Fixture f;
    /* inner is in outer: on top. outer (gas) is over wet (liquid) by state. wet is over inner by volume, for inner's
     * state is unknown. */
    COMPILE(&f, "box outer { interior = gas from = <0, 0, 0> to = <10, 10, 10> } box inner { interior = oil from = <1, "
                "1, 1> to = <9, 9, 9> }"
                "box wet { interior = water from = <8, 4, 4> to = <14, 6, 6> }");
    const Diagnostic *circle = fixture_find(&f, D_ORDER_CIRCLE);
    assert_non_null(circle);
    assert_int_equal(f.compiled->order.n_circles, 1);
    assert_non_null(circle->notes);
    fixture_clear(&f);
}

static void hidden_objects_are_reported(void **state)
{
    (void)state;
    Fixture f;
    COMPILE(&f, "box { interior = glass size = <9, 9, 9> priority = 1 } sphere lost { interior = gas }"
                "sphere half { interior = gas center = <4.5, 0, 0> }");
    report_warnings(f.compiled, NULL, &f.diag);
    const Diagnostic *hidden = fixture_find(&f, D_HIDDEN_OBJECT);
    assert_non_null(hidden);
    assert_non_null(strstr(hidden->text, "lost"));
    assert_int_equal(f.diag.n_warnings, 1);
    fixture_clear(&f);
    /* between two that hide it together */
    COMPILE(&f, "box a { interior = glass from = <0, 0, 0> to = <5, 9, 9> priority = 1 } box b { interior = ice from = "
                "<4, 0, 0> to = <9, 9, 9> priority = 1 }"
                "box c { interior = water from = <1, 1, 1> to = <8, 8, 8> }");
    report_warnings(f.compiled, NULL, &f.diag);
    assert_non_null(fixture_find(&f, D_HIDDEN_OBJECT));
    fixture_clear(&f);
}

/* ---- points ---- */

/* Names of the hulls that hold a point, the owner last. */
static void assert_inside(const Fixture *f, Vec3f point, const char *expected)
{
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    uint32_t on_surface;
    char names[500] = "";
    assert_int_equal(compiled_interior(f->compiled, point, 0, &hits, &list, &on_surface), STATUS_OK);
    for (uint32_t i = 0; i < nest_list_count(&list); i++) {
        strcat(names, i ? " " : "");
        strcat(names, f->scene->objects[f->compiled->object_of_hull[nest_item(&f->compiled->order, &list, i)]].name);
    }
    assert_string_equal(names, expected);
    assert_int_equal(on_surface, SCENE_NONE);
    nest_list_clear(&list);
    hit_list_clear(&hits);
}

static void points_know_where_they_are(void **state)
{
    (void)state;
    Fixture f;
    const char *scene =
        "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
        "cylinder drink { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }"
        "box cube { interior = ice from = <-12, 30, -12> to = <12, 54, 12> bevel = 2 } "
        "sphere bead { interior = gas center = <0, 40, 0> } ground { y = -1 }";
    static const char *const policies[] = {"automatic", "priority", "entered"};
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        char text[2000];
        snprintf(text, sizeof text, "%s%s render { nesting = %s } %s", M, scene, policies[i], V);
        fixture_compile(&f, text, 1);
        assert_inside(&f, vec3f(0, 70, 0), "");
        assert_inside(&f, vec3f(0, 1e6f, 0), "");
        assert_inside(&f, vec3f(1e6f, 20, 0), "");
        assert_inside(&f, vec3f(20, 20, 0), "drink");
        assert_inside(&f, vec3f(0, 5, 0), "tumbler");
        assert_inside(&f, vec3f(39, 20, 0), "tumbler");
        assert_inside(&f, vec3f(0, 50, 0), "cube");
        if (i == 0) {
            assert_inside(&f, vec3f(0, 9.95f, 0), "drink tumbler");
            assert_inside(&f, vec3f(0, 40, 0), "drink cube bead");
            assert_inside(&f, vec3f(5, 40, 5), "drink cube");
        }
        fixture_clear(&f);
    }
}

static void hulls_are_found_through_a_thousand_shells(void **state)
{
    (void)state;
    Fixture f;
    COMPILE(&f, "for (i in 1..1000) { sphere { interior = i % 2 == 1 ? glass : water radius = i } }");
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    assert_int_equal(compiled_interior(f.compiled, vec3f(0, 0, 0), 0, &hits, &list, NULL), STATUS_OK);
    assert_int_equal(nest_list_count(&list), 1000);
    for (uint32_t i = 0; i < nest_list_count(&list); i++)
        assert_int_equal(nest_item(&f.compiled->order, &list, i), 999 - i);
    assert_int_equal(compiled_interior(f.compiled, vec3f(500.5f, 0, 0), 0, &hits, &list, NULL), STATUS_OK);
    assert_int_equal(nest_list_count(&list), 500);
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&f);
}

/* Random points against formulas. */
static void random_points_agree_with_formulas(void **state)
{
    (void)state;
    Fixture f;
    COMPILE(&f,
            "sphere a { interior = glass radius = 2 } box b { interior = water from = <-1, -3, -1> to = <3, 1, 1> }"
            "group { rotate(<30, 40, 50>) scale(<-1, 1, 1>) box c { interior = ice size = <3, 3, 3> bevel = .1 } }");
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    const Affine *to_world = &f.scene->objects[2].to_world;
    Affine inverse;
    assert_true(affine_invert(to_world, &inverse));
    uint32_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        float x[3];
        for (int k = 0; k < 3; k++) {
            seed = seed * 1664525u + 1013904223u;
            x[k] = (float)(seed >> 8) * 0x1p-24f * 8 - 4;
        }
        Vec3 p = vec3((double)x[0], (double)x[1], (double)x[2]), q = affine_point(&inverse, p);
        bool in_a = vec3_length(p)<2, in_b = p.x> - 1 && p.x < 3 && p.y > -3 && p.y < 1 && fabs(p.z) < 1;
        assert_int_equal(compiled_interior(f.compiled, vec3f(x[0], x[1], x[2]), 0, &hits, &list, NULL), STATUS_OK);
        assert_int_equal(nest_has(&f.compiled->order, &list, 0), in_a);
        assert_int_equal(nest_has(&f.compiled->order, &list, 1), in_b);
        double most = vec3_max_abs(q);
        if (most < 1.4 || most > 1.5)
            assert_int_equal(nest_has(&f.compiled->order, &list, 2), most < 1.4); /* away from the bevels */
    }
    nest_list_clear(&list);
    hit_list_clear(&hits);
    fixture_clear(&f);
}

/* ---- cameras ---- */

static void check_alone(const char *text, DiagCode expected, const char *word)
{
    Fixture f;
    char whole[2000];
    snprintf(whole, sizeof whole, "%s environment { } %s", M, text);
    fixture_compile(&f, whole, 1);
    Status status = compile_check_camera(f.compiled, 0, &f.diag, &f.error);
    const Diagnostic *report = f.diag.first;
    if (expected == D_COUNT) {
        if (status != STATUS_OK || report) {
            fixture_print(&f);
            fail_msg("refused: %s", text);
        }
    } else {
        assert_int_equal(status, STATUS_SCENE);
        assert_non_null(report);
        assert_int_equal(report->code, expected);
        assert_non_null(strstr(report->text, word));
    }
    fixture_clear(&f);
}

static void check_cameras(const char *text, DiagCode expected, const char *word)
{
    char whole[1800];
    snprintf(whole, sizeof whole,
             "cylinder pond { interior = water from = <0, -5, 0> to = <0, 0, 0> radius = 9 } "
             "box pane { interior = glass from = <0, -9, 20> to = <1, 9, 30> } %s",
             text);
    check_alone(whole, expected, word);
}

static void cameras_are_where_they_are_expected(void **state)
{
    (void)state;
    check_cameras("camera { from = <0, -2, 0> to = <0, -2, 9> expect = [water] }", D_COUNT, "");
    check_cameras("camera { from = <0, -2, 0> to = <0, -2, 9> }", D_COUNT, "");
    check_cameras("camera { from = <0, 2, 0> expect = [] }", D_COUNT, "");
    check_cameras("camera { from = <0, 2, 0> expect = [air] }", D_COUNT, "");
    check_cameras("camera eye { from = <0, 2, 0> expect = [water] }", D_CAMERA_EXPECTATION,
                  "eye is in only the world's air");
    check_cameras("camera eye { from = <0, -2, 0> to = <0, 1, 1> expect = [glass] }", D_CAMERA_EXPECTATION,
                  "is in water, not in [glass]");
    check_cameras("camera eye { from = <0, -2, 0> to = <0, 1, 1> expect = [] }", D_CAMERA_EXPECTATION, "is in water");
    check_cameras("camera eye { from = <3, 0, 2> to = <0, 1, 1> }", D_CAMERA_ON_SURFACE, "pond");
    check_cameras("camera eye { from = <1, 1, 25> }", D_CAMERA_ON_SURFACE, "pane");
}

/* The faces of a cutter at x = 30 and x = 41 reach beyond the ball of radius 3 about <40, 0, 0>. */
#define CUT                                                                                                            \
    "difference cut { interior = glass  sphere { center = <40, 0, 0> radius = 3 } "                                    \
    "box { from = <30, -9, -9> to = <41, 9, 9> } }"

static void cameras_may_stand_on_what_is_no_surface(void **state)
{
    (void)state;
    check_cameras(CUT "camera { from = <41, 8, 0> to = <0, 8, 0> expect = [] }", D_COUNT, "");
    check_cameras(CUT "camera { from = <30, 9, 9> to = <40, 0, 0> expect = [] }", D_COUNT, "");
    check_cameras(CUT "camera { from = <37, 0, 0> to = <50, 0, 0> expect = [] }", D_COUNT, ""); /* the ball's own */
    check_cameras(CUT "camera eye { from = <41, 1, 0> to = <50, 0, 0> }", D_CAMERA_ON_SURFACE, "box");
    check_cameras(CUT "camera eye { from = <43, 0, 0> to = <50, 0, 0> }", D_CAMERA_ON_SURFACE, "sphere");
    check_cameras("union { interior = glass  box { from = <40, 0, 0> to = <42, 9, 9> }  box { from = <41, 0, 0> "
                  "to = <50, 9, 9> } } camera { from = <41, 5, 5> to = <50, 5, 5> expect = [glass] }",
                  D_COUNT, "");
    check_cameras("union { interior = glass  box { from = <40, 0, 0> to = <41, 9, 9> }  box { from = <41, 0, 0> "
                  "to = <50, 9, 9> } } camera { from = <41, 5, 5> to = <50, 5, 5> }",
                  D_CAMERA_ON_SURFACE, "");
    check_cameras(CUT "box { interior = glass  from = <30, 0, 0> to = <33, 9, 9> }"
                      "camera eye { from = <30, 5, 5> to = <50, 0, 0> }",
                  D_CAMERA_ON_SURFACE, "box");
}

/* Wherever that is: the origin has no coordinates of its own to be off by. Near is not on it, in scenes of any size. */
static void cameras_at_corners_and_tips_are_on_them(void **state)
{
    (void)state;
    const struct {
        const char *object;
        double tip[3], out[3]; /* a corner or a tip, and which way it looks */
    } shapes[] = {
        {"box a { interior = glass from = <-1, -1, -1> to = <0, 0, 0> }", {0, 0, 0}, {1, 1, 1}},
        {"box a { interior = glass from = <-1, -1, -1> to = <.25, .5, .75> }", {.25, .5, .75}, {1, 1, 1}},
        {"mesh a { positions = [<0,0,0>, <1,0,0>, <0,1,0>, <0,0,1>] triangles = [<0,2,1>, <0,3,2>, <0,1,3>, <1,2,3>] "
         "interior = glass }",
         {0, 0, 0},
         {-1, -1, -1}},
        {"cone a { radius_from = 1 radius_to = 0 interior = glass }", {0, 1, 0}, {0, 1, 0}},
        {"cone a { from = <0, -1, 0> to = <0, 0, 0> radius_from = 1 radius_to = 0 interior = glass }",
         {0, 0, 0},
         {0, 1, 0}},
        {"cone a { from = <.1, .2, .3> to = <.7, .6, .5> radius_from = .5 radius_to = 0 interior = glass }",
         {.7, .6, .5},
         {3, 2, 1}},
        {"lathe a { profile = [<0, -1>, <1, -1>, <0, 0>] interior = glass scale(<1, 1e-3, 5>) rotate(<20, 40, 60>) "
         "translate(<1, 2, 3>) }",
         {1, 2, 3},
         {0, 0, 0}},
        {"sphere a { center = <3, 4, 0> radius = 5 interior = glass }", {0, 0, 0}, {-3, -4, 0}},
        {"torus a { radius = 3 tube = 1 interior = glass translate(<-4, 0, 0>) }", {0, 0, 0}, {1, 0, 0}},
    };
    const double sizes[] = {1, 1e-12, 1e9};
    for (size_t i = 0; i < COUNT_OF(shapes); i++)
        for (size_t k = 0; k < COUNT_OF(sizes); k++)
            for (int off = 0; off < 2; off++) {
                char text[1000];
                double place[3], size = sizes[k];
                for (int axis = 0; axis < 3; axis++)
                    place[axis] = size * (shapes[i].tip[axis] + off * 4e-6 * shapes[i].out[axis]);
                if (off && shapes[i].out[1] == 0 && shapes[i].out[0] == 0) continue;
                snprintf(text, sizeof text,
                         "group { %s scale(%.17g) } camera { from = <%.17g, %.17g, %.17g> to = <0, 0, %.17g> }",
                         shapes[i].object, size, place[0], place[1], place[2], 50 * size);
                check_alone(text, off ? D_COUNT : D_CAMERA_ON_SURFACE, "surface of a");
            }
}

/* The box of a mesh stands in for its vertices where the map keeps the axes, and gives the same bits. */
static void bounds_of_many_are_those_of_each(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, M "let b = superellipsoid { interior = glass radius = <.3, .7, .2> exponents = <.4, .7> }"
                       "let c = box { interior = glass size = <.1, .3, .7> }"
                       "for (i in 1..40) { b { scale(rnd(i)) translate(<rnd(1, i), 1e3 * rnd(2, i), -rnd(3, i)>) } "
                       "c { rotate(z, 90 * i) translate(<rnd(4, i), rnd(5, i), rnd(6, i)>) }"
                       "b { rotate(<i, 2 * i, 0>) } b { scale(<-1, rnd(7, i), 3>) translate(rnd(8, i) * y) } }" V);
    assert_true(f.scene->n_objects == 160);
    SceneShapeBox known = {0};
    for (uint32_t i = 0; i < f.scene->n_objects; i++) {
        Box3 next = scene_next_bounds(f.scene, &f.scene->objects[i], &known);
        Box3 alone = scene_object_bounds(f.scene, &f.scene->objects[i], NULL);
        assert_memory_equal(&next, &alone, sizeof next);
    }
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_of_many_are_those_of_each),
        cmocka_unit_test(contained_hulls_are_seen_to_be),
        cmocka_unit_test(overlaps_are_measured),
        cmocka_unit_test(small_overlaps_are_not_missed),
        cmocka_unit_test(touching_and_gaps_are_told_apart),
        cmocka_unit_test(wedges_are_told_from_gaps),
        cmocka_unit_test(areas_and_depths_are_measured),
        cmocka_unit_test(pairs_that_keep_apart_are_decided_at_once),
        cmocka_unit_test(pairs_that_lie_alike_are_judged_once),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(the_order_follows_the_rules),
        cmocka_unit_test(circles_are_reported),
        cmocka_unit_test(hidden_objects_are_reported),
        cmocka_unit_test(points_know_where_they_are),
        cmocka_unit_test(hulls_are_found_through_a_thousand_shells),
        cmocka_unit_test(random_points_agree_with_formulas),
        cmocka_unit_test(cameras_are_where_they_are_expected),
        cmocka_unit_test(cameras_may_stand_on_what_is_no_surface),
        cmocka_unit_test(cameras_at_corners_and_tips_are_on_them),
    };
    return cmocka_run_group_tests_name("compile", tests, NULL, NULL);
}
