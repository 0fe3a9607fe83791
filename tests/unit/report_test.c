/* report_test.c - what `check` says: the text as a whole, the JSON's facts, the warnings.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "check/report.h"
#include "scene_fixture.h"

#define DRINK                                                                                                          \
    FIXTURE_MEDIA                                                                                                      \
    "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }\n"          \
    "cylinder drink { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }\n"                           \
    "box cube { interior = ice from = <-12, 30, -12> to = <12, 54, 12> }\n"
#define BUBBLES                                                                                                        \
    "for (i in 1..7) { sphere { interior = gas radius = .5 center = <20 * cos(50 * i), 20, 20 * sin(50 * i)> } }\n"

static char *report_of(const char *text, bool json)
{
    Fixture f;
    Buf out = {0};
    fixture_compile(&f, text, 1);
    if (json)
        report_print_json(f.compiled, &f.sources, &out);
    else
        report_print(f.compiled, &f.sources, &out);
    assert_false(out.failed);
    fixture_clear(&f);
    return out.text;
}

static void assert_has(const char *report, const char *line)
{
    if (!strstr(report, line)) fail_msg("no '%s' in:\n%s", line, report);
}

static void the_text_says_who_is_on_top(void **state)
{
    (void)state;
    char *text = report_of(DRINK BUBBLES FIXTURE_VIEW, false);
    assert_has(text, "Media\n  air    index 1     gas     the world\n");
    assert_has(text, "glass  index 1.5   solid\n");
    assert_null(strstr(text, "oil")); /* used by nothing */
    assert_has(text, "Clear objects from top to bottom, nesting = automatic\n");
    assert_has(text, "7 ×  sphere");
    assert_has(text, "test.mns:2\n");
    assert_has(text, "Where they meet\n");
    assert_has(text, "  tumbler overlaps drink by ");
    assert_has(text, ": tumbler on top, by state of matter\n");
    assert_has(text, "  cube overlaps drink by ");
    assert_has(text, "  7 × sphere (gas) inside drink: the spheres on top, by containment\n");
    assert_null(strstr(text, " \n"));
    free(text);
}

/* A wall that drops stand in is one wall; where many meet many, the pairs are counted. */
static void what_there_are_many_of_is_counted(void **state)
{
    (void)state;
    char *text = report_of(
        "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid } medium water { ior = 1.33  state = "
        "liquid }\n"
        "box pane { interior = glass  size = <90, 90, 4> }\n"
        "for (i in 0..9) { sphere dew { interior = water  radius = 2  center = <6 * i - 30, 0, 2> } }\n" FIXTURE_VIEW,
        false);
    assert_has(text, "  pane overlaps 10 × dew (water) by ");
    assert_has(text, " together: pane on top, by state of matter\n");
    free(text);
}

/* What mixes has no place in an order, also where nothing is on top of it. */
static void what_mixes_stands_below(void **state)
{
    (void)state;
    char *text =
        report_of("meniscus 1.0 unit mm medium glass { ior = 1.5 } medium milk { mixes = true  scattering = .1 }\n"
                  "sphere cloud { interior = milk  radius = 2 } sphere mist { interior = milk  center = <90, 0, 0> }\n"
                  "box tank { interior = glass  size = <9, 9, 9> }" FIXTURE_VIEW,
                  false);
    const char *tank = strstr(text, "  1  tank "), *cloud = strstr(text, "  +  cloud "),
               *mist = strstr(text, "     mist ");
    assert_true(tank && cloud && mist && tank < cloud && cloud < mist);
    assert_has(mist, "\n  +: never on top; it adds to what is there, or gives way to it\n");
    free(text);
}

/* A medium without a name is called after what it fills first; a let names it, too, also where a function makes it. */
static void nameless_media_are_told_apart(void **state)
{
    (void)state;
    char *text = report_of(
        "meniscus 1.0 unit mm def dye(n) = medium { ior = n } def double(n) = dye(2 * n) let ink = double(.65)\n"
        "let oil = medium { ior = 1.45 } sphere { interior = ink  center = <0, -5, 0> } let bead = sphere { interior = "
        "medium "
        "{ ior = 1.6 } } bead { } "
        "bead { translate(9 * x) } sphere ball { interior = oil center = <0, 5, 0> } world { medium "
        "= medium { ior = 1.1 } } "
        "union pair { sphere { center = <0, 9, 0> } interior = medium { ior = 1.7 } } " FIXTURE_VIEW,
        false);
    assert_has(text, "  medium of the world  index 1.1");
    assert_has(text, "  oil                  index 1.45\n");
    assert_has(text, "  ink                  index 1.3\n");
    assert_has(text, "  medium of bead 1     index 1.6\n");
    assert_has(text, "  medium of pair       index 1.7\n");
    assert_has(text, "bead 2    medium of bead 1 ");
    free(text);
}

/* A macro and a loop make them anew each time. */
static void nameless_media_of_the_same_values_are_one(void **state)
{
    (void)state;
    char *text = report_of("meniscus 1.0 unit mm def pane(at, c) { box { from = <at, 0, 0>  to = <at + 2, 1, 1>\n"
                           "  interior = medium { ior = cauchy(1.5, .004)  tint = c  depth = 1 } } }\n"
                           "for (i in 0..<6) { pane(1.5 * i, rgb(.9, .9, .8)) }\n"
                           "pane(30, rgb(.9, .8, .8))\n" FIXTURE_VIEW,
                           false);
    assert_has(text, "  medium of box 1  index");
    assert_has(text, "  medium of box 7  index");
    assert_null(strstr(text, "  medium of box 2  index"));
    assert_has(text, "both medium of box 1, they merge");
    free(text);
}

/* A lens of shells: what is around the next one outward follows from that one's own line. JSON has every pair. */
static void shells_are_inside_of_the_next_one(void **state)
{
    (void)state;
    const char *scene =
        "meniscus 1.0 unit mm for (i in 1..6) { sphere { radius = 8 - i  interior = medium { ior = 1 + i / 10 } } } "
        "sphere other { radius = .5 center = <0, 0, 1>  interior = medium { ior = 1.9 } }" FIXTURE_VIEW;
    char *text = report_of(scene, false), *json = report_of(scene, true);
    assert_has(text, "  sphere 2 inside sphere 1: sphere 2 on top, by containment\n");
    assert_has(text, "  sphere 6 inside sphere 5, and 4 more around that: sphere 6 on top, by containment\n");
    assert_has(text, "  other inside sphere 6, and 5 more around that: other on top, by containment\n");
    assert_null(strstr(text, "sphere 6 inside sphere 4"));
    size_t n = 0;
    for (const char *at = json; (at = strstr(at, "\"a_number\"")); at++) n++;
    assert_int_equal(n, 7 * 6 / 2);
    free(text);
    free(json);
}

static void few_pairs_stand_by_themselves(void **state)
{
    (void)state;
    char *text = report_of(
        FIXTURE_MEDIA
        "box block { interior = glass size = <9, 9, 9> } sphere { interior = gas center = <2, 0, 0> } "
        "sphere { interior = gas center = <-2, 0, 0> } box twin { interior = glass from = <4, -1, -1> to = <6, 1, 1> }"
        "box lid { interior = ice from = <-4.5, 4.5, -4.5> to = <4.5, 5, 4.5> }" FIXTURE_VIEW,
        false);
    assert_has(text, "  sphere 1 inside block: sphere 1 on top, by containment\n");
    assert_has(text, "  sphere 2 inside block: sphere 2 on top, by containment\n");
    assert_has(text, ": both glass, they merge\n");
    assert_has(text, "  lid touches block over ");
    assert_has(text, "\n  1  sphere 2  gas");
    assert_has(text, "\n  2  block     glass");
    assert_has(text, "\n\n     lid       ice"); /* meets nothing, stands apart */
    free(text);
    text = report_of(FIXTURE_MEDIA "sphere { interior = glass }" FIXTURE_VIEW, false);
    assert_has(text, "Where they meet\n  no clear object meets another\n");
    free(text);
    text = report_of(FIXTURE_MEDIA FIXTURE_VIEW, false);
    assert_has(text, "  none\n");
    free(text);
}

static void other_policies_decide_otherwise(void **state)
{
    (void)state;
    static const struct {
        const char *policy, *says;
    } cases[] = {{"priority", ": drink on top, by order of declaration\n"},
                 {"entered", ": the one that a ray enters last is on top\n"},
                 {"none", ": each is bounded by the world's medium\n"}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char scene[2000];
        snprintf(scene, sizeof scene, "%s render { nesting = %s } %s", DRINK, cases[i].policy, FIXTURE_VIEW);
        char *text = report_of(scene, false);
        assert_has(text, cases[i].says);
        assert_has(text, cases[i].policy);
        free(text);
    }
}

static void units_suit_people(void **state)
{
    (void)state;
    static const struct {
        const char *unit, *volume;
    } cases[] = {{"um", "8.00 µm³"}, {"mm", "8.00 mm³"}, {"cm", "8.00 cm³"}, {"m", "8.00 m³"}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char scene[500];
        snprintf(scene, sizeof scene,
                 "meniscus 1.0 unit %s medium glass { ior = 1.5 } box { size = <2, 2, 2> interior = glass } %s",
                 cases[i].unit, FIXTURE_VIEW);
        char *text = report_of(scene, false);
        assert_has(text, cases[i].volume);
        free(text);
    }
}

static void json_has_every_pair(void **state)
{
    (void)state;
    char *text = report_of(DRINK BUBBLES FIXTURE_VIEW, true);
    size_t n = 0;
    for (const char *p = text; (p = strstr(p, "\"relation\": \"b-in-a\"")) != NULL; p++) n++;
    assert_int_equal(n, 7);
    assert_has(text, "\"nesting\": \"automatic\"");
    assert_has(text, "\"unit_m\": 0.001");
    assert_has(text, "\"rule\": \"state of matter\"");
    assert_has(text, "\"top\": \"tumbler\"");
    assert_has(text, "\"gap\": null");
    assert_has(text, "\"circles\": 0");
    int depth = 0;
    for (const char *p = text; *p; p++) depth += (*p == '{' || *p == '[') - (*p == '}' || *p == ']');
    assert_int_equal(depth, 0);
    free(text);
}

static void warnings_name_both_sides_of_a_gap(void **state)
{
    (void)state;
    Fixture f;
    fixture_compile(
        &f,
        FIXTURE_MEDIA
        "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }"
        "cylinder drink { interior = water from = <0, 10.1, 0> to = <0, 44, 0> radius = 36.9 }" FIXTURE_VIEW,
        1);
    report_warnings(f.compiled, NULL, &f.diag);
    const Diagnostic *gap = fixture_find(&f, D_AIR_GAP);
    assert_non_null(gap);
    assert_string_equal(gap->text, "between drink and tumbler is a gap of 0.1 mm, filled with the world's air");
    assert_non_null(gap->notes);
    assert_int_equal(f.diag.n_warnings, 1);
    fixture_clear(&f);
}

/* Thousands of mistakes of one kind make a few messages. */
static void many_warnings_are_summed_up(void **state)
{
    (void)state;
    Fixture f;
    fixture_compile(&f,
                    FIXTURE_MEDIA
                    "box { interior = glass size = <99, 99, 99> priority = 1 } "
                    "for (i in 1..50) { sphere { interior = gas radius = .2 center = <i - 25, 0, 0> } }" FIXTURE_VIEW,
                    1);
    report_warnings(f.compiled, NULL, &f.diag);
    assert_int_equal(f.diag.n_warnings, 11);
    assert_non_null(strstr(f.diag.last->text, "40 more objects"));
    fixture_clear(&f);
}

/* What a loop or a macro makes again and again is told once. */
static void gaps_of_a_loop_are_one_warning(void **state)
{
    (void)state;
    Fixture f;
    fixture_compile(&f,
                    FIXTURE_MEDIA
                    "for (i in 1..20) { box pane { interior = glass from = <30 * i, 0, 0> to = <30 * i + 20, 5, 20> } "
                    "box film { interior = water from = <30 * i, 5.01, 0> to = <30 * i + 20, 6, 20> } }" FIXTURE_VIEW,
                    1);
    report_warnings(f.compiled, NULL, &f.diag);
    const Diagnostic *gap = fixture_find(&f, D_AIR_GAP);
    assert_non_null(gap);
    assert_int_equal(f.diag.n_warnings, 1);
    assert_string_equal(gap->notes->text, "and so are 19 more between what these lines place");
    fixture_clear(&f);
}

/* ---- remarks ---- */

#define TWO_MEDIA "meniscus 1.0 unit mm medium glass { ior = 1.5 } medium water { ior = 1.33 } "
#define GLASS "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid } "
#define WATER "meniscus 1.0 unit mm medium water { ior = 1.33  state = liquid } "
#define VIEW " camera eye { from = <0, 0, 1000>  to = <0, 0, 0> } environment { } "

static void remarks_tell_what_is_worth_a_look(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        DiagCode code;
        const char *text;
    } cases[] = {
        {TWO_MEDIA "box a { interior = glass size = <10, 10, 10> } "
                   "box b { interior = water from = <0, 0, 0> to = <10, 10, 10.2> }" VIEW,
         D_CLOSE_ORDER, "a is on top of b by their volumes, which differ by 2 %"},
        {TWO_MEDIA "box a { interior = glass size = <10, 10, 10> } box b { interior = water from = <0, 0, 0> to = <10, "
                   "10, 10> }" VIEW,
         D_CLOSE_ORDER, "b is on top of a only because it is declared later"},
        {GLASS "sphere a { interior = glass radius = 4 } sphere b { interior = glass }" VIEW, D_INVISIBLE_OBJECT,
         "nothing would change without b: it is of glass, and so is all that it is in"},
        {GLASS "sphere a { interior = glass } box b { interior = air size = <1, 1, 1> translate(<9, 0, 0>) }" VIEW,
         D_INVISIBLE_OBJECT, "nothing would change without b: it is of air, and so is all that it is in"},
        {GLASS "medium argon { ior = 1  state = gas } sphere a { interior = glass } "
               "box b { interior = argon size = <1, 1, 1> translate(<9, 0, 0>) }" VIEW,
         D_INVISIBLE_OBJECT,
         "nothing would change without b: it is of argon, which looks like air, and so does all that it is in"},
        {GLASS "box a { surface = surface { } size = <9, 9, 9> } sphere b { interior = glass }" VIEW, D_ENCLOSED_OBJECT,
         "b is wholly inside of a, which is opaque: nothing of it is seen"},
        {GLASS "ground floor { } sphere b { interior = glass center = <0, -2, 0> }"
               "camera eye { from = <0, 5, 1000>  to = <0, 0, 0> } environment { }",
         D_BEHIND_GROUND, "b is wholly below floor, where no camera sees it"},
        {GLASS "sphere a { interior = glass } sphere b { interior = glass center = <9, 0, 0> } "
               "sphere c { interior = glass radius = 1.5m center = <0, 9m, 0> }" VIEW,
         D_ODD_SIZE, "c is 1.5e+03 times larger than anything else in the scene"},
        {WATER "box a { interior = water size = <1, 1, 1> }" VIEW, D_LOOSE_LIQUID,
         "a is a liquid with flat sides, and touches nothing"},
        {GLASS "box a { interior = glass size = <10, 10, 3000> }" VIEW, D_CAMERA_INSIDE,
         "eye is inside of a, in glass"},
        {TWO_MEDIA "box a { interior = glass from = <90, 0, 0> to = <100, 1, 1> } "
                   "box b { interior = water from = <100.00002, 0, 0> to = <110, 1, 1> }" VIEW,
         D_NEAR_COINCIDENT, "faces of b and a are 22.9 nm apart, which is less than coordinates can tell there"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        fixture_compile(&f, cases[i].scene, 1);
        report_enclosed_lights(f.compiled, &f.diag);
        report_remarks(f.compiled, &f.diag);
        const Diagnostic *remark = fixture_find(&f, cases[i].code);
        if (!remark || strcmp(remark->text, cases[i].text) != 0 || f.diag.n_remarks != 1 || f.diag.n_warnings) {
            fixture_print(&f);
            fail_msg("not only '%s', but %u remarks", cases[i].text, f.diag.n_remarks);
        }
        assert_int_equal(remark->severity, DIAG_REMARK);
        fixture_clear(&f);
    }
}

/* What is painted shows, whatever it is of. */
static void paint_is_seen(void **state)
{
    (void)state;
    Fixture f;
    fixture_compile(&f,
                    GLASS "sphere a { interior = glass  surface = surface { transmission = .5 } }"
                          "sphere b { interior = glass  radius = .5  surface = surface { transmission = 0 } }"
                          "box c { interior = air  surface = surface { transmission = 0 }  size = <1, 1, 1> "
                          "translate(<9, 0, 0>) }" VIEW,
                    1);
    report_remarks(f.compiled, &f.diag);
    assert_int_equal(f.diag.n_remarks, 0);
    fixture_clear(&f);
}

/* What looks alike and is as it should be. */
static void remarks_are_not_made_of_what_is_meant(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        /* panes of one glass that overlap, a bubble in one of them, a shell of air */
        GLASS
        "box a { interior = glass size = <10, 10, 1> } box b { interior = glass from = <-5, -5, -4> to = <5, -4, 4> } "
        "sphere c { interior = air radius = .2 }" VIEW,
        /* part of the inner one shows; a lens on a ground; an opaque stone in glass */
        GLASS "sphere a { interior = glass radius = 4 } sphere b { interior = glass center = <4, 0, 0> } "
              "ground { y = -4 surface = surface { } } sphere c { radius = .5 surface = surface { } }"
              "camera eye { from = <0, 5, 1000>  to = <0, 0, 0> } environment { }",
        /* drops; a drink on an opaque table; a bubble of ten thousand */
        WATER "sphere a { interior = water } box b { interior = water from = <5, 0, 0> to = <6, 1, 1> } "
              "box { from = <4, -1, -1> to = <7, 0, 2> surface = surface { } }" VIEW,
        /* an air pocket that a diver looks out of */
        GLASS "box a { interior = glass size = <10, 10, 3000> } box b { interior = air size = <8, 8, 2990> }" VIEW,
        GLASS "box a { interior = glass size = <10, 10, 3000> } camera { from = <0, 0, 1000> to = <0, 0, 0> expect = "
              "[glass] } "
              "environment { }",
    };
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Fixture f;
        fixture_compile(&f, scenes[i], 1);
        report_remarks(f.compiled, &f.diag);
        if (f.diag.n_remarks) {
            fixture_print(&f);
            fail_msg("remarks on %s", scenes[i]);
        }
        fixture_clear(&f);
    }
}

/* Combinations have the volume that they enclose, here eight times that of what is on top, and half of it: not nearly the same. */
static void volumes_of_combinations_are_not_close(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        TWO_MEDIA "box a { interior = glass size = <10, 10, 10> } difference b { interior = water "
                  "box { from = <0, 0, 0> to = <20, 20, 20> } box { from = <18, 18, 18> to = <19, 19, 19> } }" VIEW,
        TWO_MEDIA "union a { interior = glass box { size = <10, 10, 10> } sphere { radius = 5 } } "
                  "box b { interior = water from = <0, 0, 0> to = <10, 10, 20> }" VIEW,
    };
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Fixture f;
        fixture_compile(&f, scenes[i], 1);
        report_remarks(f.compiled, &f.diag);
        assert_int_equal(f.diag.n_remarks, 1);
        assert_non_null(fixture_find(&f, D_ORDER_BY_VOLUME));
        fixture_clear(&f);
    }
}

/* ---- what is enclosed ---- */

#define OPAQUE " surface = surface { } "

static void enclosed_things_are_proved(void **state)
{
    (void)state;
    static const struct {
        const char *scene;
        DiagCode code;
        const char *text;
    } cases[] = {
        {"box a { size = <9, 9, 9>" OPAQUE "} sphere b {" OPAQUE "}", D_ENCLOSED_OBJECT,
         "b is wholly inside of a, which is opaque: nothing of it is seen"},
        /* turned, skewed and mirrored: the bounds of b are as large as those of a */
        {"capsule a { from = <0, 0, 0> to = <20, 0, 0> radius = 2" OPAQUE "rotate(z, 40) scale(<1, -2, 1>) }"
         "capsule b { from = <0, 0, 0> to = <20, 0, 0> radius = 1.5" OPAQUE "rotate(z, 40) scale(<1, -2, 1>) }",
         D_ENCLOSED_OBJECT, "b is wholly inside of a, which is opaque: nothing of it is seen"},
        /* in the wall of a vessel, a text of two bodies */
        {"lathe a { profile = [<0, 0>, <20, 0>, <20, 60>, <16, 60>, <16, 4>, <0, 4>]" OPAQUE "}"
         "prism b { outline = [<-6, 20>, <6, 20>, <0, 30>] from = 17 to = 18" OPAQUE "rotate(x, 0) }"
         "box c { size = <4, 20, .5> translate(<0, 30, 18>)" OPAQUE "}",
         D_ENCLOSED_OBJECT, "c is wholly inside of a, which is opaque: nothing of it is seen"},
        /* in what is left of a difference, whose hole is beside it */
        {"difference a { box { size = <9, 9, 9> } cylinder { from = <-5, 0, 0> to = <5, 0, 0> radius = 2 }" OPAQUE "}"
         "sphere b { center = <0, 3.2, 0> radius = 1" OPAQUE "}",
         D_ENCLOSED_OBJECT, "b is wholly inside of a, which is opaque: nothing of it is seen"},
        /* the smallest that holds it, and a combination is one object */
        {"box a { size = <9, 9, 9>" OPAQUE "} union b { sphere { } box { size = <3, 1, 1> }" OPAQUE "}",
         D_ENCLOSED_OBJECT, "b is wholly inside of a, which is opaque: nothing of it is seen"},
        {"box a { size = <9, 9, 9>" OPAQUE "} light b { shape = point from = <1, 1, 1> intensity = 1 }",
         D_ENCLOSED_LIGHT, "b is wholly inside of a, which is opaque: none of its light comes out"},
        {"box a { size = <9, 9, 9>" OPAQUE "} light b { shape = sphere radius = 1 from = <1, 1, 1> radiance = 1 }",
         D_ENCLOSED_LIGHT, "b is wholly inside of a, which is opaque: none of its light comes out"},
        {"box a { size = <9, 9, 9>" OPAQUE
         "} light b { shape = quad size = <1, 1> from = <1, 1, 1> to = <4, 3, 2> radiance = 1 }",
         D_ENCLOSED_LIGHT, "b is wholly inside of a, which is opaque: none of its light comes out"},
        /* it lies in a face, and shines into it */
        {"box a { size = <10, 10, 10>" OPAQUE
         "} light b { size = <2, 2> from = <0, -5, 0> to = <0, 0, 0> radiance = 1 }",
         D_ENCLOSED_LIGHT, "b lies in a face of a, which is opaque, and shines into it: none of its light comes out"},
        /* it nearly fills its globe, and its housing */
        {"sphere a { radius = 5" OPAQUE "} light b { shape = sphere radius = 4.999 from = <0, 0, 0> radiance = 1 }",
         D_ENCLOSED_LIGHT, "b is wholly inside of a, which is opaque: none of its light comes out"},
        {"box a { size = <10, 10, 10>" OPAQUE
         "} light b { shape = sphere radius = 4.999 from = <0, 0, 0> radiance = 1 }",
         D_ENCLOSED_LIGHT, "b is wholly inside of a, which is opaque: none of its light comes out"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        char scene[1200];
        snprintf(scene, sizeof scene, "meniscus 1.0 unit mm %s" VIEW, cases[i].scene);
        fixture_compile(&f, scene, 1);
        report_enclosed_lights(f.compiled, &f.diag);
        report_remarks(f.compiled, &f.diag);
        const Diagnostic *remark = fixture_find(&f, cases[i].code);
        if (!remark || strcmp(remark->text, cases[i].text) != 0) {
            fixture_print(&f);
            fail_msg("no '%s'", cases[i].text);
        }
        assert_non_null(remark->hint);
        fixture_clear(&f);
    }
}

static void what_may_be_seen_is_not_enclosed(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        /* a thousandth of it shows; it touches the side; the bounds are within, and it is not */
        "box a { size = <10, 10, 10>" OPAQUE "} sphere b { center = <0, 4.001, 0> radius = 1" OPAQUE "}",
        "box a { size = <10, 10, 10>" OPAQUE "} sphere b { center = <0, 4, 0> radius = 1" OPAQUE "}",
        "sphere a { radius = 5" OPAQUE "} sphere b { center = <3.4, 3.4, 0> radius = .5" OPAQUE "}",
        /* in the hole of a ring, of a vessel and of a difference, and through the wall between two holes */
        "torus a { radius = 5 tube = 1" OPAQUE "} sphere b { radius = .5" OPAQUE "}",
        "lathe a { profile = [<0, 0>, <20, 0>, <20, 60>, <16, 60>, <16, 4>, <0, 4>]" OPAQUE "}"
        "sphere b { radius = 5 center = <0, 20, 0>" OPAQUE "}",
        "difference a { box { size = <9, 9, 9> } box { size = <3, 3, 20> }" OPAQUE "} sphere b { radius = 1" OPAQUE "}",
        "difference a { box { size = <9, 9, 9> } box { size = <3, 3, 20> translate(<2, 0, 0>) } box { size = <3, 3, "
        "20> "
        "translate(<-2, 0, 0>) }" OPAQUE "} cylinder b { from = <-2, 0, 0> to = <2, 0, 0> radius = .4" OPAQUE "}",
        /* what light goes through, and what is clear */
        "sphere a { radius = 5 surface = surface { ior = 1.5  transmission = 1  thin = true } } sphere b {" OPAQUE "}",
        "medium glass { ior = 1.5 } sphere a { radius = 5 interior = glass } sphere b {" OPAQUE "}",
        /* operands lie within each other, and are one object */
        "union a { sphere { radius = 5 } sphere { radius = 1 }" OPAQUE "}",
        /* it comes out while the shutter is open; a room with a camera in it */
        "box a { size = <9, 9, 9>" OPAQUE "} sphere b { center = <9 * clock, 0, 0> " OPAQUE "}"
        "camera { from = <0, 0, 1000>  to = <0, 0, 0>  shutter = 180deg }",
        "box a { size = <2100, 2100, 2100>" OPAQUE "} sphere b {" OPAQUE "}"
        "light c { shape = sphere radius = 1 from = <0, 300, 0> radiance = 1 }",
        /* of many things that are strewn some are hidden */
        "box a { size = <10, 10, 10>" OPAQUE "} for (i in 0..9) { sphere { center = <i, 0, 0> radius = .1" OPAQUE "} }",
        "light a { shape = sphere radius = 5 radiance = 1 from = <0, 0, 0> } sphere b {" OPAQUE "}",
        /* a lamp that is its globe's own surface, and one in the ceiling of a room */
        "sphere a { radius = 5" OPAQUE "} light b { shape = sphere radius = 5 from = <0, 0, 0> radiance = 1 }",
        "box a { size = <2100, 2100, 2100>" OPAQUE
        "} light b { size = <9, 9> from = <0, 1050, 0> to = <0, 0, 0> radiance = 1 }",
        "box a { size = <10, 10, 10>" OPAQUE
        "} light b { size = <2, 2> from = <0, 5, 0> to = <0, 20, 0> radiance = 1 }",
        "box a { size = <10, 10, 10>" OPAQUE
        "} light b { size = <2, 2> from = <5.5, 5, 0> to = <5.5, 0, 0> radiance = 1 }",
    };
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Fixture f;
        char scene[1200];
        snprintf(scene, sizeof scene, "meniscus 1.0 unit mm %s" VIEW, scenes[i]);
        fixture_compile(&f, scene, 1);
        report_enclosed_lights(f.compiled, &f.diag);
        report_remarks(f.compiled, &f.diag);
        if (fixture_find(&f, D_ENCLOSED_OBJECT) || fixture_find(&f, D_ENCLOSED_LIGHT)) {
            fixture_print(&f);
            fail_msg("enclosed: %s", scenes[i]);
        }
        fixture_clear(&f);
    }
}

static void report_all_warnings(const CompiledScene *compiled, Diag *diag)
{
    report_warnings(compiled, NULL, diag);
}

/* Whether a scene is reported with that code. */
static void expect_told(const char *scene, void (*report)(const CompiledScene *, Diag *), DiagCode code, bool told)
{
    Fixture f;
    fixture_compile(&f, scene, 1);
    report(f.compiled, &f.diag);
    if ((fixture_find(&f, code) != NULL) != told) {
        fixture_print(&f);
        fail_msg("%s", scene);
    }
    fixture_clear(&f);
}

/* A picture plane that goes through the object shows what is in it, and so does a lens that reaches into it. */
static void cameras_see_what_they_are_in(void **state)
{
    (void)state;
    static const struct {
        const char *camera;
        bool enclosed;
    } cases[] = {
        {"camera { projection = orthographic width = 40 from = <0, 0, 30> to = <0, 0, 0> }", true},
        {"camera { projection = orthographic width = 40 from = <30, 20, 30> to = <0, 0, 0> }", true},
        {"camera { projection = orthographic width = 40 from = <0, 8, 4> to = <0, 8, 0> }", false},
        {"camera { projection = orthographic width = 4 from = <0, 8, 4> to = <0, 8, 0> }", true},
        {"camera { from = <0, 0, 4.6> to = <0, 0, 9> }", true},
        {"camera { from = <0, 0, 4.4> to = <0, 0, 9> }", false},
        {"camera { from = <0, 0, 30> to = <0, 0, 0> shutter = 180deg } sphere c { center = <clock, 0, 0>" OPAQUE "}",
         true},
        {"camera { from = <0, 0, 5 - clock> to = <0, 0, 9> shutter = 180deg }", false},
        {"camera { from = <0, 0, 30> to = <0, 0, 0> } camera other { from = <4, 0, 0> to = <0, 0, 0> }", false},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char scene[1200];
        snprintf(scene, sizeof scene,
                 "meniscus 1.0 unit mm box a { size = <9, 9, 9>" OPAQUE "} sphere b {" OPAQUE "} environment { } %s",
                 cases[i].camera);
        expect_told(scene, report_remarks, D_ENCLOSED_OBJECT, cases[i].enclosed);
    }
}

/* A liquid that stands off its glass is a mistake even where the gap is wide; two panes with room between them are not.
 */
static void wide_gaps_are_mistakes_of_liquids_only(void **state)
{
    (void)state;
    static const char *const interiors[] = {"water", "glass", "ink"};
    for (int i = 0; i < (int)COUNT_OF(interiors); i++) {
        char scene[1000];
        snprintf(scene, sizeof scene,
                 FIXTURE_MEDIA "medium ink { mixes = true  absorption = 1  state = liquid } "
                               "box pane { interior = glass from = <-50, -3, -50> to = <50, 0, 50> } "
                               "box other { interior = %s from = <-50, 1, -50> to = <50, 4, 50> }" FIXTURE_VIEW,
                 interiors[i]);
        Fixture f;
        fixture_compile(&f, scene, 1);
        report_warnings(f.compiled, NULL, &f.diag);
        const HullPair *pair = fixture_pair(&f, "pane", "other");
        assert_non_null(pair);
        assert_near(pair->gap, 1, 1e-5);
        const Diagnostic *warning = fixture_find(&f, D_AIR_GAP);
        assert_int_equal(warning != NULL, i == 0);
        if (warning) assert_string_equal(warning->hint, "let them overlap by 1.00 mm: the overlap is resolved");
        fixture_clear(&f);
    }
}

/* Smoke of a function whose box was forgotten; at all times of the shutter. */
static void small_volumes_are_told_of(void **state)
{
    (void)state;
#define SMOKE(box) "medium smoke { mixes = true  scattering = 1  density = volume { function = f " box " } } "
#define WRITTEN SMOKE("from = vec3(-2)  to = vec3(2)")
    static const struct {
        const char *scene;
        bool told;
    } cases[] = {
        {SMOKE("") "sphere { interior = smoke  radius = 3 }", false},
        {SMOKE("") "sphere { interior = smoke  radius = 4 }", true},
        {SMOKE("") "sphere { interior = smoke  scale(80) }", false},
        {SMOKE("") "group { scale(80)  box { interior = smoke  size = vec3(2)  translate(<9, 9, 9>) } }", false},
        {SMOKE("") "sphere { interior = smoke  center = <9, 0, 0> }", true},
        {SMOKE("translate(<9, 0, 0>)") "sphere { interior = smoke  center = <9, 0, 0> }", false},
        {SMOKE("scale(80)  rotate(y, 45)") "box { interior = smoke  size = vec3(160) }", false},
        {SMOKE("scale(<.1, 9, .1>)  align(y, vec3(1))") /* a thin volume along a rod that stands askew */
         "cylinder { interior = smoke  from = vec3(-5)  to = vec3(5)  radius = .1 }",
         false},
        {SMOKE("scale = 0") "sphere { interior = smoke  radius = 80 }", false},
        {WRITTEN "sphere { interior = smoke  radius = 19 }", false},
        {WRITTEN "sphere { interior = smoke  radius = 21 }", true},
        {SMOKE("to = <2, 2, 2>") "sphere { interior = smoke  radius = 19 }", true},
        /* what has no end, and a half of a ball that is cut off */
        {SMOKE("") "plane { interior = smoke }", false},
        {SMOKE("") "world { medium = medium { ior = 1  scattering = 1  density = volume { function = f } } } "
                   "sphere { interior = smoke }",
         false},
        {SMOKE("") "intersection { sphere { radius = 80 }  plane { }  interior = smoke }", true},
        {SMOKE("") "difference { box { size = vec3(2) }  sphere { radius = .5 }  interior = smoke  scale(80) }", false},
        {SMOKE("") "sphere { interior = smoke  radius = 80  translate(<clock, 0, 0>) }", true},
        {WRITTEN "sphere { interior = smoke  radius = 3  translate(<900 * clock, 0, 0>) }", false},
        {WRITTEN "sphere { interior = smoke  radius = 3  center = <900 * clock, 0, 0> }", false},
        {WRITTEN "union { sphere { }  sphere { radius = 3 }  interior = smoke  translate(<900 * clock, 0, 0>) }",
         false},
        {SMOKE("translate(<0, 9 - 18 * clock, 0>)") "sphere { interior = smoke }", false},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char scene[1500];
        snprintf(scene, sizeof scene,
                 "meniscus 1.0 unit mm def f(p) = 1 + noise(p) %s camera { from = <0, 0, 1000>  to = <0, 0, 0> "
                 "shutter = 360deg  shutter_steps = 2 } environment { } animation { frames = 2 }",
                 cases[i].scene);
        expect_told(scene, report_all_warnings, D_SMALL_VOLUME, cases[i].told);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_says_who_is_on_top),
        cmocka_unit_test(what_there_are_many_of_is_counted),
        cmocka_unit_test(what_mixes_stands_below),
        cmocka_unit_test(nameless_media_are_told_apart),
        cmocka_unit_test(nameless_media_of_the_same_values_are_one),
        cmocka_unit_test(few_pairs_stand_by_themselves),
        cmocka_unit_test(shells_are_inside_of_the_next_one),
        cmocka_unit_test(other_policies_decide_otherwise),
        cmocka_unit_test(units_suit_people),
        cmocka_unit_test(json_has_every_pair),
        cmocka_unit_test(warnings_name_both_sides_of_a_gap),
        cmocka_unit_test(many_warnings_are_summed_up),
        cmocka_unit_test(gaps_of_a_loop_are_one_warning),
        cmocka_unit_test(remarks_tell_what_is_worth_a_look),
        cmocka_unit_test(paint_is_seen),
        cmocka_unit_test(remarks_are_not_made_of_what_is_meant),
        cmocka_unit_test(volumes_of_combinations_are_not_close),
        cmocka_unit_test(enclosed_things_are_proved),
        cmocka_unit_test(what_may_be_seen_is_not_enclosed),
        cmocka_unit_test(cameras_see_what_they_are_in),
        cmocka_unit_test(wide_gaps_are_mistakes_of_liquids_only),
        cmocka_unit_test(small_volumes_are_told_of),
    };
    return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
