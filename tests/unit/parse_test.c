/* parse_test.c - the shape of expressions (through what they evaluate to), statements, hostile input, and that the
 * parser and the written grammar agree.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/file.h"
#include "lang_fixture.h"

static void expect_printed(const char *expression, const char *value)
{
    Run run;
    Buf text = {0}, wanted = {0};
    buf_format(&text, "print(%s)", expression);
    buf_format(&wanted, "%s\n", value);
    run_text(&run, buf_text(&text));
    if (run.status != STATUS_OK) {
        char *reports = run_reports(&run);
        print_error("%s: %s", expression, reports);
        free(reports);
    }
    assert_int_equal(run.status, STATUS_OK);
    assert_string_equal(buf_text(&run.result.printed), buf_text(&wanted));
    buf_clear(&text);
    buf_clear(&wanted);
    run_close(&run);
}

static void test_precedence(void **state)
{
    (void)state;
    expect_printed("1 + 2 * 3", "7");
    expect_printed("(1 + 2) * 3", "9");
    expect_printed("10 - 4 - 3", "3");
    expect_printed("24 / 4 / 2", "3");
    expect_printed("2 ^ 3 ^ 2", "512");
    expect_printed("-2 ^ 2", "-4");
    expect_printed("2 ^ -1", "0.5");
    expect_printed("--3", "3");
    expect_printed("-7 % 3", "2");
    expect_printed("1 < 2 and 2 < 3", "true");
    expect_printed("not 1 > 2 or false", "true");
    expect_printed("true or false and false", "true");
    expect_printed("1 == 1 ? 2 : 3", "2");
    expect_printed("false ? 1 : true ? 2 : 3", "2");
    expect_printed("<1, 2, 3>.zyx", "<3, 2, 1>");
    expect_printed("<1, 2 + 3 * 4, -5>", "<1, 14, -5>");
    expect_printed("[1, 2, 3][1] + 1", "3");
    expect_printed("let (a = 2, b = a * 3) a + b", "8");
    expect_printed("1..4", "1..4");
    expect_printed("[for (i in 0..<3) i * i]", "[0, 1, 4]");
    expect_printed("[for (i in 1..6) if (i % 2 == 0) for (k in [1, 2]) i * k]", "[2, 4, 4, 8, 6, 12]");
    expect_printed("[1, [2, \"a\"], <1, 2>,]", "[1, [2, \"a\"], <1, 2>]");
    expect_printed("[for (i in 1..0) i]", "[]");
    expect_printed("[]", "[]");
    expect_printed("[1, 2,]", "[1, 2]");
    expect_printed("[<1, 2>, <3, 4>, <5, 6, 7>]", "[<1, 2>, <3, 4>, <5, 6, 7>]");
    expect_printed("[1, 2 + 3, -4]", "[1, 5, -4]");
    expect_printed("[1cm, 2 /* two */, /* three */ 3]", "[10, 2, 3]");
}

static void test_ranges(void **state)
{
    (void)state;
    expect_printed("[for (i in 0..1 by .1) i][10] == 1", "true");
    expect_printed("len(0..1 by .1)", "11");
    expect_printed("len(0..<1 by .1)", "10");
    expect_printed("[for (i in 3..1 by -1) i]", "[3, 2, 1]");
    expect_printed("len(5..4)", "0");
    expect_printed("(1..5 by 2) == [1, 3, 5]", "true");
}

static void test_units(void **state)
{
    (void)state;
    expect_printed("[1m, 1cm, 1in, 1ft, 1km, 1um]", "[1000, 10, 25.4, 304.8, 1000000, 0.001]");
    expect_printed("[.25turn, 90deg]", "[90, 90]");
    expect_printed("[1500ms, 2s, 5600K]", "[1.5, 2, 5600]");
    expect_printed("round(3.14159265rad)", "180");
    expect_printed("<.4, .08> / 1m", "<0.0004, 0.00008>");
}

static void test_statements(void **state)
{
    Run run;
    (void)state;
    run_text(&run,
             "; ; let a = 1; let b = a var c = b c := c + 1 if (c == 2) { print(\"two\") } else { print(\"no\") }\n"
             "if (false) {} else if (c == 3) {} else { print(\"else\") } while (c < 5) { c := c + 1 } print(c)\n"
             "def f(a: number, b = a * 2) = a + b  print(f(1), \" \", f(1, 1), \" \", f(b = 5, a = 2))\n"
             "def m(n) { for (i in 1..n) { children() } } m(2) { print(\"child\") }\n"
             "sphere { radius = 1 } sphere named { radius = 2 } named { translate(x) }\n");
    assert_int_equal(run.status, STATUS_OK);
    assert_string_equal(buf_text(&run.result.printed), "two\nelse\n5\n3 2 7\nchild\nchild\n");
    assert_int_equal(run.result.n_nodes, 4); /* with the prelude's air */
    run_close(&run);
}

/* A text of n times what, between a head and a tail. */
static char *repeated(const char *head, const char *what, size_t n, const char *tail)
{
    Buf out = {0};
    buf_add(&out, head);
    for (size_t i = 0; i < n; i++) buf_add(&out, what);
    buf_add(&out, tail);
    assert_false(out.failed);
    return out.text;
}

static void expect_hostile(const char *head, const char *what, const char *tail, bool fine)
{
    Run run;
    char *text = repeated(head, what, 100000, tail);
    run_text(&run, text);
    assert_false(run.out_of_memory);
    assert_int_equal(run.status, fine ? STATUS_OK : STATUS_SCENE);
    run_close(&run);
    free(text);
}

static void test_hostile(void **state)
{
    (void)state;
    expect_hostile("let a = ", "(", "", false);
    expect_hostile("let a = ", "[", "", false);
    expect_hostile("let a = ", "<", "", false);
    expect_hostile("let a = ", "-", "1", false);
    expect_hostile("let a = ", "not ", "true", false);
    expect_hostile("let a = 1", "+1", "", false);
    expect_hostile("let a = 1", "[0]", "", false);
    expect_hostile("let a = ", "true ? 1 : ", "1", false);
    expect_hostile("let a = ", "f(", "", false);
    expect_hostile("let a = ", "let (a = 1) ", "1", false);
    expect_hostile("let a = [", "for (i in 1..2) ", "1]", false);
    expect_hostile("", "group { ", "", false);
    expect_hostile("", "if (true) { ", "", false);
    expect_hostile("", "} ", "", false);
    expect_hostile("", "/* ", "", false);
    expect_hostile("", "a.", "", false);
    expect_hostile("if (false) {} ", "else if (false) {} ", "", true);
    expect_hostile("print(len([1", ", 2", "]))", true);
    expect_hostile("", ";", "", true);
    expect_hostile("", "def f() = ", "1", false);
}

/* Every prefix of a scene that uses all of the grammar ends in a report or is fine; none hangs or crashes. */
static void test_prefixes(void **state)
{
    static const char scene[] =
        "param p: number = 3mm in 1mm..5mm \"doc\" use \"std/glassware.mns\" as gw defaults sphere { radius = 2 }\n"
        "medium glass { ior = cauchy(1.5, 3e-3) state = solid absorption = <.4, .1, .2> / 1m }\n"
        "def f(a, b = [1, <2, 3>]) = let (k = a) k > 1 and not false ? b[0] : -a ^ 2 % 3 // c\n"
        "def m(n) { if (n > 0) { children() m(n - 1) } else { box { size = <n, n, 1> + <1, 1, 1> } } } /* d */\n"
        "m(2) { sphere ball { interior = glass rotate(y, 3deg) center = <1, 2, 3>.zyx } ball { scale(2) } }\n"
        "gw.tumbler { radius = p } var i = 0 while (i < 3) { i := i + 1 } for (k in 0..<4 by 2) { print(k, #abc) }\n"
        "preset draft { render { samples = 2 } }";
    (void)state;
    for (size_t length = 0; length <= sizeof scene - 1; length++) {
        Run run;
        char *text = malloc(length + 1);
        assert_non_null(text);
        memcpy(text, scene, length);
        text[length] = 0;
        run_text(&run, text);
        assert_true(run.status == STATUS_OK || (run.status == STATUS_SCENE && run.diag.n_errors > 0));
        if (length == sizeof scene - 1) assert_int_equal(run.status, STATUS_OK);
        run_close(&run);
        free(text);
    }
}

/* Text with its blanks squeezed, so that lines can be compared. */
static void squeeze(char *text)
{
    char *to = text;
    for (char *from = text; *from; from++) {
        bool blank = *from == ' ' || *from == '\n';
        if (blank && (to == text || to[-1] == ' ')) continue;
        *to++ = blank ? ' ' : *from;
    }
    *to = 0;
}

/* Each rule above a function of the parser stands in grammar/meniscus.ebnf, word for word up to blanks and comments. */
static void test_grammar(void **state)
{
    static const char *const sources[] = {"src/lang/parse.c", "src/lang/parse_expr.c"};
    char *grammar;
    size_t length, rules = 0;
    (void)state;
    assert_int_equal(file_read("grammar/meniscus.ebnf", 0, &grammar, &length, NULL), STATUS_OK);
    squeeze(grammar);
    for (size_t i = 0; i < COUNT_OF(sources); i++) {
        char *source;
        assert_int_equal(file_read(sources[i], 0, &source, &length, NULL), STATUS_OK);
        for (char *at = strstr(source, "\n/* "); at; at = strstr(at + 1, "\n/* ")) {
            size_t name = strspn(at + 4, "abcdefghijklmnopqrstuvwxyz");
            const char *end = strstr(at, "*/");
            if (name == 0 || strncmp(at + 4 + name, " = ", 3) != 0 || !end) continue;
            const char *body = at + 4 + name + 3;
            const char *stop = strstr(body, " ;");
            assert_true(stop && stop < end);
            char rule[512];
            size_t n = (size_t)(stop - body);
            assert_true(n < sizeof rule);
            memcpy(rule, body, n);
            rule[n] = 0;
            squeeze(rule);
            size_t first = strcspn(rule, "|;"); /* the grammar has comments between alternatives */
            rule[first] = 0;
            while (first > 0 && rule[first - 1] == ' ') rule[--first] = 0;
            if (!strstr(grammar, rule)) print_error("%s is not in the grammar\n", rule);
            assert_non_null(strstr(grammar, rule));
            rules++;
        }
        free(source);
    }
    assert_true(rules > 25);
    free(grammar);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_precedence), cmocka_unit_test(test_ranges),  cmocka_unit_test(test_units),
        cmocka_unit_test(test_statements), cmocka_unit_test(test_hostile), cmocka_unit_test(test_prefixes),
        cmocka_unit_test(test_grammar),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
