/* diag_test.c - the sink and its printers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "diag/diag.h"
#include "base/suggest.h"

typedef struct Sink {
    Arena arena;
    SourceSet sources;
    Diag diag;
    Buf out;
} Sink;

static void sink_open(Sink *sink, const char *text)
{
    memset(sink, 0, sizeof *sink);
    arena_init(&sink->arena);
    sink->sources.arena = &sink->arena;
    diag_init(&sink->diag, &sink->arena, &sink->sources);
    source_add(&sink->sources, "glass.mns", NULL, text, strlen(text));
}

static void sink_close(Sink *sink)
{
    buf_clear(&sink->out);
    arena_clear(&sink->arena);
}

static Span span_of(const Sink *sink, const char *word)
{
    const char *text = sink->sources.sources[0].text, *at = strstr(text, word);
    assert_non_null(at);
    uint32_t begin = (uint32_t)(at - text);
    return (Span){0, begin, begin + (uint32_t)strlen(word)};
}

static void expect_print(Sink *sink, const char *text)
{
    diag_print(&sink->diag, &sink->out, false);
    assert_string_equal(buf_text(&sink->out), text);
}

static void test_shape(void **state)
{
    Sink sink;
    static const char *const candidates[] = {"ior", "tint", "depth"};
    (void)state;
    sink_open(&sink, "meniscus 1.0\n    medium élan { iorr = 1.5 }\n");
    Diagnostic *report =
        diag_report(&sink.diag, D_UNKNOWN_PROPERTY, span_of(&sink, "iorr"), "medium has no property '%s'", "iorr");
    diag_suggest(&sink.diag, report, "iorr", candidates, COUNT_OF(candidates));
    diag_note(&sink.diag, report, span_of(&sink, "élan"), "of this medium");
    expect_print(&sink, "glass.mns:2:19: error: medium has no property 'iorr' [unknown-property]\n"
                        "    2 |     medium élan { iorr = 1.5 }\n"
                        "      |                   ^~~~\n"
                        "      = hint: did you mean 'ior'?\n"
                        "glass.mns:2:12: note: of this medium\n"
                        "    2 |     medium élan { iorr = 1.5 }\n"
                        "      |            ^~~~\n");
    sink_close(&sink);
}

static void test_columns(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "\tx = 水 y\r\ne\xcc\x81 z\x01 \xff w");
    diag_report(&sink.diag, D_SYNTAX, span_of(&sink, "y"), "y");
    diag_report(&sink.diag, D_SYNTAX, span_of(&sink, "w"), "w");
    diag_report(&sink.diag, D_SYNTAX, (Span){0, (uint32_t)strlen(sink.sources.sources[0].text), 1000}, "end");
    expect_print(&sink, "glass.mns:1:8: error: y [syntax]\n"
                        "    1 |         x = 水 y\n"
                        "      |                ^\n"
                        "glass.mns:2:9: error: w [syntax]\n"
                        "    2 | e\xcc\x81 z\xef\xbf\xbd \xef\xbf\xbd w\n"
                        "      |        ^\n"
                        "glass.mns:2:10: error: end [syntax]\n"
                        "    2 | e\xcc\x81 z\xef\xbf\xbd \xef\xbf\xbd w\n"
                        "      |         ^\n");
    sink_close(&sink);
}

static void test_empty_source(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "");
    diag_report(&sink.diag, D_MISSING_HEADER, (Span){0, 0, 0}, "nothing here");
    expect_print(&sink, "glass.mns:1:1: error: nothing here [missing-header]\n"
                        "    1 |\n"
                        "      | ^\n");
    sink_close(&sink);
}

static void test_order_limit_repetition(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "a b c\n");
    diag_report_nowhere(&sink.diag, D_NO_CAMERA, "the scene has no camera");
    diag_report(&sink.diag, D_SYNTAX, span_of(&sink, "c"), "last");
    diag_report(&sink.diag, D_UNUSED_NAME, span_of(&sink, "a"), "first");
    diag_report(&sink.diag, D_UNUSED_NAME, span_of(&sink, "a"), "first");
    assert_int_equal(sink.diag.n_errors, 2);
    assert_int_equal(sink.diag.n_warnings, 1);
    /* in the order of the text, and names that are not used behind errors, which may be why */
    expect_print(&sink, "glass.mns:1:5: error: last [syntax]\n    1 | a b c\n      |     ^\n"
                        "meniscus: error: the scene has no camera [no-camera]\n"
                        "glass.mns:1:1: warning: first [unused-name]\n    1 | a b c\n      | ^\n");
    for (int i = 0; i < 100; i++) diag_report(&sink.diag, D_SYNTAX, span_of(&sink, "b"), "mistake %d", i);
    assert_int_equal(sink.diag.n_errors, 102);
    buf_clear(&sink.out);
    diag_print(&sink.diag, &sink.out, false);
    assert_non_null(strstr(buf_text(&sink.out), "... and 82 more errors"));
    assert_non_null(strstr(buf_text(&sink.out), "mistake 17"));
    assert_null(strstr(buf_text(&sink.out), "mistake 18"));
    sink_close(&sink);
}

static void test_warnings_as_errors(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "a\n");
    sink.diag.warnings_are_errors = true;
    diag_report(&sink.diag, D_UNUSED_NAME, span_of(&sink, "a"), "unused");
    assert_int_equal(sink.diag.n_errors, 1);
    assert_int_equal(sink.diag.n_warnings, 0);
    sink_close(&sink);
}

static void test_color(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "a\n");
    diag_report(&sink.diag, D_SYNTAX, span_of(&sink, "a"), "wrong");
    diag_print(&sink.diag, &sink.out, true);
    assert_string_equal(buf_text(&sink.out),
                        "\033[1mglass.mns:1:1: \033[1;31merror:\033[0m\033[1m wrong\033[0m [syntax]\n"
                        "\033[34m    1 |\033[0m a\n"
                        "\033[34m      |\033[0m \033[1;32m^\033[0m\n");
    sink_close(&sink);
}

static void test_json(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "é \"a\"\n");
    DiagChain chain = {NULL, {0, 0, 2}, "included from"};
    diag_print_json(&sink.diag, &sink.out);
    assert_string_equal(buf_text(&sink.out), "[]\n");
    buf_clear(&sink.out);
    sink.diag.chain = &chain;
    Diagnostic *report = diag_report(&sink.diag, D_WRONG_TYPE, span_of(&sink, "\"a\""), "not \"a\"\n");
    diag_hint(&sink.diag, report, "hint");
    diag_note(&sink.diag, report, span_of(&sink, "é"), "note");
    diag_print_json(&sink.diag, &sink.out);
    assert_string_equal(
        buf_text(&sink.out),
        "[\n  {\"severity\": \"error\", \"code\": \"wrong-type\", \"file\": \"glass.mns\", \"line\": 1, \"column\": 3, "
        "\"end_line\": 1, \"end_column\": 6, \"begin\": 3, \"end\": 6, \"message\": \"not \\\"a\\\"\\u000a\", "
        "\"hint\": \"hint\", \"notes\": [{\"file\": \"glass.mns\", \"line\": 1, \"column\": 1, \"end_line\": 1, "
        "\"end_column\": 2, \"begin\": 0, \"end\": 2, \"message\": \"note\"}], \"chain\": [{\"file\": \"glass.mns\", "
        "\"line\": 1, \"column\": 1, \"end_line\": 1, \"end_column\": 2, \"begin\": 0, \"end\": 2, \"message\": "
        "\"included from\"}]}\n]\n");
    sink_close(&sink);
}

static void test_suggest(void **state)
{
    static const char *const words[] = {"radius", "center", "interior", "from", "to", "ior", "size", "Size2"};
    (void)state;
    size_t n = COUNT_OF(words);
    assert_string_equal(suggest_nearest("raduis", words, n), "radius");
    assert_string_equal(suggest_nearest("centre", words, n), "center");
    assert_string_equal(suggest_nearest("iorr", words, n), "ior");
    assert_string_equal(suggest_nearest("SIZE", words, n), "size");
    assert_null(suggest_nearest("wobble", words, n));
    assert_null(suggest_nearest("q", words, n));
    assert_null(suggest_nearest("", words, n));
    static const char *const twins[] = {"cat", "car"};
    assert_null(suggest_nearest("cab", twins, 2)); /* two as near: none is suggested */
    static const char *const number[] = {"cat", "cats"};
    assert_string_equal(suggest_nearest("catt", number, 2), "cats");
    assert_string_equal(suggest_nearest("ctas", number, 2), "cats");
    assert_string_equal(suggest_nearest("ca", number, 2), "cat");
    static const char *const same[] = {"cat", "cat"};
    assert_string_equal(suggest_nearest("catt", same, 2), "cat");
}

/* the table itself: slugs are unique words, cause and cure are sentences */
static void test_table(void **state)
{
    (void)state;
    for (int code = 0; code < D_COUNT; code++) {
        const char *slug = diag_slug((DiagCode)code), *cause = diag_cause((DiagCode)code),
                   *cure = diag_cure((DiagCode)code);
        assert_int_equal(strspn(slug, "abcdefghijklmnopqrstuvwxyz0123456789-"), strlen(slug));
        assert_true(strlen(cause) > 10 && cause[strlen(cause) - 1] == '.');
        assert_true(strlen(cure) > 5);
        for (int other = 0; other < code; other++) assert_string_not_equal(slug, diag_slug((DiagCode)other));
    }
}

/* Reports one warning at word, as the evaluation of a frame does. */
static void report_in_frame(Sink *sink, uint32_t frame, const char *word, const char *text)
{
    sink->diag.in_frame = true;
    sink->diag.frame = frame;
    diag_report(&sink->diag, D_SCENE_WARNING, span_of(sink, word), "%s", text);
}

static void open_frame(Sink *one, uint32_t frame)
{
    sink_open(one, "early late\n");
    if (frame <= 2) report_in_frame(one, frame, "early", "is early");
    report_in_frame(one, frame, "late", frame == 1 ? "is late, at 1" : "is late");
}

static void test_frames(void **state)
{
    static const uint32_t seen[] = {1, 2, 3, 7, 9, 11, 13, 20};
    Sink all, one;
    (void)state;
    sink_open(&all, "early late\n");
    for (size_t i = 0; i < COUNT_OF(seen); i++) {
        open_frame(&one, seen[i]);
        diag_drop_known(&one.diag, &all.diag);
        assert_int_equal(one.diag.n_warnings, i == 0 ? 2 : 0);
        sink_close(&one);
        open_frame(&one, seen[i]);
        diag_merge(&all.diag, &one.diag);
        sink_close(&one); /* what was merged is a copy */
    }
    assert_int_equal(all.diag.n_warnings, 2);
    expect_print(&all, "glass.mns:1:1: warning: is early [scene-warning]\n"
                       "    1 | early late\n"
                       "      | ^~~~~\n"
                       "      = in frames 1, 2\n"
                       "glass.mns:1:7: warning: is late, at 1 [scene-warning]\n"
                       "    1 | early late\n"
                       "      |       ^~~~\n"
                       "      = in frames 1 to 3, 7 to 13 by 2, 20\n");
    sink_close(&all);
}

static void test_rewind(void **state)
{
    Sink sink;
    (void)state;
    sink_open(&sink, "early late\n");
    DiagMark nothing = diag_mark(&sink.diag);
    report_in_frame(&sink, 4, "early", "is early");
    DiagMark mark = diag_mark(&sink.diag);
    report_in_frame(&sink, 5, "late", "is late");
    source_add(&sink.sources, "more.mns", NULL, "", 0);
    diag_rewind(&sink.diag, mark);
    assert_int_equal(sink.sources.n, 1);
    expect_print(&sink, "glass.mns:1:1: warning: is early [scene-warning]\n"
                        "    1 | early late\n"
                        "      | ^~~~~\n"
                        "      = in frame 4\n");
    diag_rewind(&sink.diag, nothing);
    assert_null(sink.diag.first);
    assert_int_equal(sink.diag.n_warnings, 0);
    report_in_frame(&sink, 5, "late", "is late");
    assert_ptr_equal(sink.diag.first, sink.diag.last);
    sink_close(&sink);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shape),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_rewind),
        cmocka_unit_test(test_columns),
        cmocka_unit_test(test_empty_source),
        cmocka_unit_test(test_order_limit_repetition),
        cmocka_unit_test(test_warnings_as_errors),
        cmocka_unit_test(test_color),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_suggest),
        cmocka_unit_test(test_table),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
