/* json.c - the JSON writer.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/json.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/num.h"
#include "base/utf8.h"

JsonWriter json_writer(Buf *out, bool indent)
{
    return (JsonWriter){.out = out, .indent = indent};
}

static void new_line(JsonWriter *json)
{
    if (!json->indent) return;
    buf_add_bytes(json->out, "\n", 1);
    buf_add_repeat(json->out, ' ', (size_t)json->depth * 2);
}

/* What stands before a value or a key: a comma after the item before it, and a line of its own. */
static void begin_item(JsonWriter *json)
{
    if (json->after_key) {
        json->after_key = false;
        return;
    }
    if (json->depth == 0) return;
    bool *has_items = &json->has_items[json->depth - 1];
    if (*has_items) buf_add(json->out, json->indent ? "," : ", ");
    *has_items = true;
    new_line(json);
}

static void begin_group(JsonWriter *json, bool is_object)
{
    assert(json->depth < JSON_MAX_DEPTH);
    begin_item(json);
    buf_add_bytes(json->out, is_object ? "{" : "[", 1);
    json->is_object[json->depth] = is_object;
    json->has_items[json->depth] = false;
    json->depth++;
}

void json_begin_object(JsonWriter *json)
{
    begin_group(json, true);
}

void json_begin_array(JsonWriter *json)
{
    begin_group(json, false);
}

void json_end(JsonWriter *json)
{
    assert(json->depth > 0 && !json->after_key);
    json->depth--;
    if (json->has_items[json->depth]) new_line(json);
    buf_add_bytes(json->out, json->is_object[json->depth] ? "}" : "]", 1);
}

static void add_quoted(Buf *out, const char *text)
{
    size_t length = strlen(text);
    buf_add_bytes(out, "\"", 1);
    for (size_t i = 0; i < length;) {
        uint32_t code;
        size_t n = utf8_decode(text + i, length - i, &code);
        if (code == UTF8_INVALID)
            buf_add(out, "\xef\xbf\xbd");
        else if (code == '"' || code == '\\')
            buf_format(out, "\\%c", (char)code);
        else if (code == '\n')
            buf_add(out, "\\n");
        else if (code == '\t')
            buf_add(out, "\\t");
        else if (code < 0x20 || code == 0x7f)
            buf_format(out, "\\u%04x", (unsigned)code);
        else
            buf_add_bytes(out, text + i, n);
        i += n;
    }
    buf_add_bytes(out, "\"", 1);
}

void json_key(JsonWriter *json, const char *key)
{
    assert(json->depth > 0 && json->is_object[json->depth - 1] && !json->after_key);
    begin_item(json);
    add_quoted(json->out, key);
    buf_add(json->out, ": ");
    json->after_key = true;
}

void json_text(JsonWriter *json, const char *text)
{
    begin_item(json);
    if (text)
        add_quoted(json->out, text);
    else
        buf_add(json->out, "null");
}

/* text: of a number; what is not finite is null */
static void add_number_text(JsonWriter *json, bool finite, const char *text)
{
    begin_item(json);
    buf_add(json->out, finite ? text : "null");
}

void json_number(JsonWriter *json, double number)
{
    char text[NUM_TEXT_SIZE];
    num_print(number, text);
    add_number_text(json, isfinite(number), text);
}

void json_float(JsonWriter *json, float number)
{
    char text[NUM_TEXT_SIZE];
    num_print_float(number, text);
    add_number_text(json, isfinite(number), text);
}

void json_whole(JsonWriter *json, uint64_t number)
{
    begin_item(json);
    buf_format(json->out, "%llu", (unsigned long long)number);
}

void json_truth(JsonWriter *json, bool truth)
{
    begin_item(json);
    buf_add(json->out, truth ? "true" : "false");
}

void json_raw(JsonWriter *json, const char *value)
{
    begin_item(json);
    for (size_t length = 0; *value; value += length) { /* its lines stand as deep as it does, and none is empty */
        length = strcspn(value, "\n");
        buf_add_bytes(json->out, value, length);
        size_t breaks = strspn(value + length, "\n");
        if (breaks && value[length + breaks]) new_line(json);
        length += breaks;
    }
}

void json_add_text(JsonWriter *json, const char *key, const char *text)
{
    json_key(json, key);
    json_text(json, text);
}

void json_add_number(JsonWriter *json, const char *key, double number)
{
    json_key(json, key);
    json_number(json, number);
}

void json_add_float(JsonWriter *json, const char *key, float number)
{
    json_key(json, key);
    json_float(json, number);
}

void json_add_whole(JsonWriter *json, const char *key, uint64_t number)
{
    json_key(json, key);
    json_whole(json, number);
}

void json_add_truth(JsonWriter *json, const char *key, bool truth)
{
    json_key(json, key);
    json_truth(json, truth);
}

void json_add_numbers(JsonWriter *json, const char *key, const double *numbers, size_t n)
{
    json_key(json, key);
    json_begin_array(json);
    for (size_t i = 0; i < n; i++) json_number(json, numbers[i]);
    json_end(json);
}
