/* json_test.c - the JSON writer.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/json.h"

static void items_are_divided(void **state)
{
    (void)state;
    Buf out = {0};
    JsonWriter json = json_writer(&out, false);
    json_begin_object(&json);
    json_add_text(&json, "a", "b");
    json_add_whole(&json, "n", UINT64_MAX);
    json_key(&json, "list");
    json_begin_array(&json);
    json_number(&json, 0.1);
    json_float(&json, 1.34f);
    json_truth(&json, true);
    json_text(&json, NULL);
    json_begin_object(&json);
    json_end(&json);
    json_raw(&json, "[1]");
    json_end(&json);
    json_end(&json);
    assert_string_equal(buf_text(&out),
                        "{\"a\": \"b\", \"n\": 18446744073709551615, \"list\": [0.1, 1.34, true, null, {}, [1]]}");
    buf_clear(&out);
}

static void what_is_json_already_stands_as_deep_as_it_is_put(void **state)
{
    (void)state;
    Buf out = {0};
    JsonWriter json = json_writer(&out, true);
    json_begin_object(&json);
    json_key(&json, "list");
    json_raw(&json, "[\n  1\n]\n\n");
    json_add_whole(&json, "n", 2);
    json_end(&json);
    assert_string_equal(buf_text(&out), "{\n  \"list\": [\n    1\n  ],\n  \"n\": 2\n}");
    buf_clear(&out);
}

static void lines_are_indented(void **state)
{
    (void)state;
    Buf out = {0};
    JsonWriter json = json_writer(&out, true);
    json_begin_array(&json);
    json_whole(&json, 1);
    json_begin_array(&json);
    json_whole(&json, 2);
    json_end(&json);
    json_begin_array(&json);
    json_end(&json);
    json_end(&json);
    assert_string_equal(buf_text(&out), "[\n  1,\n  [\n    2\n  ],\n  []\n]");
    buf_clear(&out);
}

/* Whatever the bytes, what is written is valid. */
static void texts_are_escaped(void **state)
{
    (void)state;
    Buf out = {0};
    JsonWriter json = json_writer(&out, false);
    json_text(&json, "\"\\\n\t\x01\x7f \xc3\xa9 \xff\xc3");
    assert_string_equal(buf_text(&out), "\"\\\"\\\\\\n\\t\\u0001\\u007f \xc3\xa9 \xef\xbf\xbd\xef\xbf\xbd\"");
    buf_clear(&out);
}

static void numbers_that_json_lacks_are_null(void **state)
{
    (void)state;
    const double numbers[] = {(double)NAN, (double)INFINITY, -(double)INFINITY};
    for (int i = 0; i < 3; i++) {
        Buf out = {0};
        JsonWriter json = json_writer(&out, false);
        json_begin_array(&json);
        json_number(&json, numbers[i]);
        json_float(&json, (float)numbers[i]);
        json_end(&json);
        assert_string_equal(buf_text(&out), "[null, null]");
        buf_clear(&out);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_json_already_stands_as_deep_as_it_is_put),
        cmocka_unit_test(items_are_divided),
        cmocka_unit_test(lines_are_indented),
        cmocka_unit_test(texts_are_escaped),
        cmocka_unit_test(numbers_that_json_lacks_are_null),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
