/* json.h - writes JSON into a text buffer, one value after another; commas, quotes and indentation are its own.
 * Everything it writes is valid whatever the text: bytes that are no UTF-8 become U+FFFD, and numbers that
 * are not finite become null.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_JSON_H
#define MEN_JSON_H

#include <stdbool.h>
#include <stdint.h>

#include "base/buf.h"

enum { JSON_MAX_DEPTH = 32 };

typedef struct JsonWriter {
    Buf *out;
    bool indent;    /* one item per line; otherwise all on one line */
    bool after_key; /* the next value belongs to the key just written */
    unsigned depth;
    bool is_object[JSON_MAX_DEPTH], has_items[JSON_MAX_DEPTH];
} JsonWriter;

JsonWriter json_writer(Buf *out, bool indent);
/* A value stands at the top level, in an array, or behind a key. Deeper than JSON_MAX_DEPTH is a bug. */
void json_begin_object(JsonWriter *json);
void json_begin_array(JsonWriter *json);
void json_end(JsonWriter *json); /* of the innermost object or array */
void json_key(JsonWriter *json, const char *key);
void json_text(JsonWriter *json, const char *text); /* NULL: null */
void json_number(JsonWriter *json, double number);  /* the shortest text that reads back the same */
void json_float(JsonWriter *json, float number); /* that reads back as the same float: for all that is stored as one */
void json_whole(JsonWriter *json, uint64_t number);
void json_truth(JsonWriter *json, bool truth);
/* A value that is JSON already, in lines of its own where it has several; they are put as deep as the value stands. */
void json_raw(JsonWriter *json, const char *value);
/* A key with its value. */
void json_add_text(JsonWriter *json, const char *key, const char *text);
void json_add_number(JsonWriter *json, const char *key, double number);
void json_add_float(JsonWriter *json, const char *key, float number);
void json_add_whole(JsonWriter *json, const char *key, uint64_t number);
void json_add_truth(JsonWriter *json, const char *key, bool truth);
void json_add_numbers(JsonWriter *json, const char *key, const double *numbers, size_t n); /* an array */

#endif
