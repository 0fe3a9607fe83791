/* report_test.c - what `check` says: the text as a whole, the JSON's facts, the warnings.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "scene/report.h"
#include "scene_fixture.h"

#define DRINK                                                                                                          \
    FIXTURE_MEDIA                                                                                                      \
        "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }\n"      \
        "cylinder drink { interior = water from = <0, 9.9, 0> to = <0, 44, 0> radius = 37.1 }\n"                       \
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
    assert_has(text, "Where they meet\n  nowhere\n");
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
    report_warnings(f.compiled, &f.diag);
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
    report_warnings(f.compiled, &f.diag);
    assert_int_equal(f.diag.n_warnings, 11);
    assert_non_null(strstr(f.diag.last->text, "40 more objects"));
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_says_who_is_on_top),
        cmocka_unit_test(few_pairs_stand_by_themselves),
        cmocka_unit_test(other_policies_decide_otherwise),
        cmocka_unit_test(units_suit_people),
        cmocka_unit_test(json_has_every_pair),
        cmocka_unit_test(warnings_name_both_sides_of_a_gap),
        cmocka_unit_test(many_warnings_are_summed_up),
    };
    return cmocka_run_group_tests_name("report", tests, NULL, NULL);
}
