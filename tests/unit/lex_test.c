/* lex_test.c - tokens, their places, and what is reported about broken ones.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/attr.h"
#include "base/num.h"
#include "lang/lex.h"

typedef struct Fixture {
    Arena arena;
    SourceSet sources;
    Diag diag;
    SymbolTable symbols;
    Lexer lexer;
} Fixture;

static void open_text(Fixture *fixture, const char *text, size_t length)
{
    memset(fixture, 0, sizeof *fixture);
    arena_init(&fixture->arena);
    fixture->sources.arena = &fixture->arena;
    diag_init(&fixture->diag, &fixture->arena, &fixture->sources);
    symbol_table_init(&fixture->symbols, &fixture->arena);
    lexer_init(&fixture->lexer, &fixture->diag, &fixture->symbols,
               source_add(&fixture->sources, "t", NULL, text, length));
}

static void expect_kinds(const char *text, const TokenKind *kinds, size_t n)
{
    Fixture fixture;
    open_text(&fixture, text, strlen(text));
    for (size_t i = 0; i < n; i++) assert_int_equal(lexer_next(&fixture.lexer).kind, kinds[i]);
    for (int i = 0; i < 3; i++) assert_int_equal(lexer_next(&fixture.lexer).kind, TOKEN_END);
    assert_int_equal(fixture.diag.n_errors, 0);
    arena_clear(&fixture.arena);
}

#define EXPECT(text, ...)                                                                                              \
    do {                                                                                                               \
        static const TokenKind kinds[] = {__VA_ARGS__};                                                                \
        expect_kinds(text, kinds, COUNT_OF(kinds));                                                                    \
    } while (0)

static void test_kinds(void **state)
{
    (void)state;
    EXPECT("\xef\xbb\xbfmeniscus 1.0", TOKEN_NAME, TOKEN_NUMBER);
    EXPECT("{}()[]<>,;:?.", TOKEN_BRACE_OPEN, TOKEN_BRACE_CLOSE, TOKEN_PAREN_OPEN, TOKEN_PAREN_CLOSE,
           TOKEN_BRACKET_OPEN, TOKEN_BRACKET_CLOSE, TOKEN_LESS, TOKEN_GREATER, TOKEN_COMMA, TOKEN_SEMICOLON,
           TOKEN_COLON, TOKEN_QUESTION, TOKEN_DOT);
    EXPECT("a:=b==c=d<=e>=f!=g", TOKEN_NAME, TOKEN_CHANGE, TOKEN_NAME, TOKEN_EQUAL, TOKEN_NAME, TOKEN_ASSIGN,
           TOKEN_NAME, TOKEN_LESS_EQUAL, TOKEN_NAME, TOKEN_GREATER_EQUAL, TOKEN_NAME, TOKEN_NOT_EQUAL, TOKEN_NAME);
    EXPECT("1..5 0..<n a.xy", TOKEN_NUMBER, TOKEN_RANGE, TOKEN_NUMBER, TOKEN_NUMBER, TOKEN_RANGE_OPEN, TOKEN_NAME,
           TOKEN_NAME, TOKEN_DOT, TOKEN_NAME);
    EXPECT("+-*/%^", TOKEN_PLUS, TOKEN_MINUS, TOKEN_STAR, TOKEN_SLASH, TOKEN_PERCENT, TOKEN_CARET);
    EXPECT("a // b\n/* c /* d */ e */ f", TOKEN_NAME, TOKEN_NAME);
    EXPECT("while whiles in inn", TOKEN_WHILE, TOKEN_NAME, TOKEN_IN, TOKEN_NAME);
    EXPECT("élan 水 _x9", TOKEN_NAME, TOKEN_NAME, TOKEN_NAME);
    EXPECT("", TOKEN_END);
}

static void test_numbers(void **state)
{
    static const struct {
        const char *text;
        double number;
        const char *unit;
    } cases[] = {
        {"3", 3, NULL},       {"3mm", 3, "mm"}, {"1.5e-3cm", 1.5e-3, "cm"}, {".5turn", .5, "turn"},
        {"5600K", 5600, "K"}, {"2in", 2, "in"}, {"90deg", 90, "deg"},       {"1e3s", 1000, "s"},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture fixture;
        open_text(&fixture, cases[i].text, strlen(cases[i].text));
        Token token = lexer_next(&fixture.lexer);
        assert_int_equal(token.kind, TOKEN_NUMBER);
        assert_false(token.bad);
        assert_true(token.number == cases[i].number);
        assert_int_equal(token.unit != NULL, cases[i].unit != NULL);
        if (cases[i].unit) assert_string_equal(token.unit->name, cases[i].unit);
        assert_int_equal(lexer_next(&fixture.lexer).kind, TOKEN_END);
        arena_clear(&fixture.arena);
    }
}

/* Whole units of other sizes are moved points: nothing is rounded but once, from the text. */
static void test_unit_values(void **state)
{
    static const struct {
        const char *text, *unit;
        double unit_m, value;
    } cases[] = {
        {"92", "mm", 1e-2, 9.2},
        {"0.7", "mm", 1e-2, 0.07},
        {"-3.3", "um", 1e-3, -0.0033},
        {"1.1", "km", 1e-3, 1.1e6},
        {"1", "in", 1e-2, 2.54},
        {"2.5", "in", 1e-3, 63.5},
        {"1", "ft", 25.4e-3, 12},
        {"25.4", "mm", 25.4e-3, 1},
        /* where a product of doubles would be off by a rounding */
        {"139.686796", "in", 0.3048, 11.640566333333334},
        {"270", "rad", 1e-3, 15469.860468532226},
        {"30.5923", "cm", 0.3048, 1.0036843832020996},
        {"19.54", "ft", 1e-3, 5955.792},
        {"175.8424", "turn", 1e-3, 63303.264},
        {"107.29322", "in", 1e-2, 272.5247788},
        {"102.2", "in", 1, 2.59588},
        {"268.94881", "ft", 1e-2, 8197.5597288},
        {"53.59482", "mm", 25.4e-3, 2.110032283464567},
        {"205.787170", "ft", 25.4e-3, 2469.44604},
        {"278.863", "mm", 0.3048, 0.9149048556430446},
        {"146.00733", "cm", 25.4e-3, 57.48320078740157},
        {"88.41727", "ft", 1, 26.949583896},
        {"39.41", "in", 1e-3, 1001.014},
        {"3.14159265358979323846264338327950288419716939937510582", "rad", 1e-3, 180},
        {"1", "in", .3048, 0.08333333333333333},
        {"1e-320", "turn", 1e-3, 3.6e-318},
        {"1e308", "turn", 1e-3, HUGE_VAL},
        {"40", "ms", 1e-3, .04},
        {".25", "turn", 1e-3, 90.},
        {"35", "mm", 1, 0.035},
        {"1e-3", "m", 1e-9, 1e6},
    };
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const char *name = cases[i].unit, *text = cases[i].text;
        assert_true(unit_value(text, strlen(text), unit_of(name, strlen(name)), cases[i].unit_m) == cases[i].value);
    }
    for (int i = 0; i < 20000; i++) {
        char text[32];
        double value;
        size_t length = (size_t)snprintf(text, sizeof text, "%de-3", i);
        num_parse(text, length, &value);
        length = (size_t)snprintf(text, sizeof text, "%d.%02dmm", i / 100, i % 100);
        assert_true(unit_value(text, length, unit_of("mm", 2), 1e-2) == value);
        length = (size_t)snprintf(text, sizeof text, "%de-4", i * 254);
        num_parse(text, length, &value);
        length = (size_t)snprintf(text, sizeof text, "%d.%02din", i / 100, i % 100);
        assert_true(unit_value(text, length, unit_of("in", 2), 1e-2) == value);
        length = (size_t)snprintf(text, sizeof text, "%d.%02dft", i / 100, i % 100);
        num_parse(text, length - 2, &value);
        assert_true(unit_value(text, length, unit_of("ft", 2), .3048) == value);
    }
}

static void test_strings_and_colors(void **state)
{
    Fixture fixture;
    static const char text[] = "\"a\\n\\t\\\"\\\\\\u{1F378}é\" #abc #0A1b2C";
    (void)state;
    open_text(&fixture, text, strlen(text));
    Token token = lexer_next(&fixture.lexer);
    assert_int_equal(token.kind, TOKEN_STRING);
    assert_string_equal(token.as.text, "a\n\t\"\\\xf0\x9f\x8d\xb8é");
    assert_int_equal(lexer_next(&fixture.lexer).as.rgb, 0xaabbcc);
    assert_int_equal(lexer_next(&fixture.lexer).as.rgb, 0x0a1b2c);
    assert_int_equal(fixture.diag.n_errors, 0);
    arena_clear(&fixture.arena);
}

static void test_places(void **state)
{
    Fixture fixture;
    static const char text[] = "  ab\n 12mm";
    (void)state;
    open_text(&fixture, text, strlen(text));
    Token token = lexer_next(&fixture.lexer);
    assert_int_equal(token.begin, 2);
    assert_int_equal(token.end, 4);
    token = lexer_next(&fixture.lexer);
    assert_int_equal(token.begin, 6);
    assert_int_equal(token.end, 10);
    assert_int_equal(fixture.lexer.previous_end, 4);
    SourcePosition position = source_position(&fixture.sources, 0, token.begin);
    assert_int_equal(position.line, 2);
    assert_int_equal(position.column, 2);
    arena_clear(&fixture.arena);
}

/* Every sequence of three bytes out of some, and random bytes, ends in TOKEN_END without a slip of memory. */
static void test_any_bytes(void **state)
{
    static const char bytes[] = "a1.\"\\#/*-<\n\xc3\xa9\xff{u0";
    (void)state;
    size_t n = sizeof bytes; /* the 0 byte too */
    for (size_t i = 0; i < n * n * n; i++) {
        char *text = malloc(4);
        assert_non_null(text);
        text[0] = bytes[i % n];
        text[1] = bytes[i / n % n];
        text[2] = bytes[i / n / n];
        text[3] = 0;
        Fixture fixture;
        open_text(&fixture, text, 3);
        int tokens = 0;
        while (lexer_next(&fixture.lexer).kind != TOKEN_END) assert_true(++tokens < 10);
        arena_clear(&fixture.arena);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),       cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_unit_values), cmocka_unit_test(test_strings_and_colors),
        cmocka_unit_test(test_places),      cmocka_unit_test(test_any_bytes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
