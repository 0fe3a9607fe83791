/* buf.h - a growing text buffer. Never fails loudly: when memory ends, `failed` is set and the text
 * stops growing, so that callers check once at the end.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BUF_H
#define MEN_BUF_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/attr.h"

typedef struct Buf {
    char *text; /* terminated whenever it is not NULL */
    size_t length, capacity;
    bool failed;
} Buf;

void buf_clear(Buf *buf); /* frees; the Buf can be used again */
void buf_add(Buf *buf, const char *text);
void buf_add_bytes(Buf *buf, const char *bytes, size_t length);
void buf_add_repeat(Buf *buf, char byte, size_t count);
void buf_format(Buf *buf, const char *format, ...) ATTR_PRINTF(2, 3);
void buf_format_list(Buf *buf, const char *format, va_list arguments) ATTR_PRINTF(2, 0);
/* Adds a text of others on one line: what is no text, would move a cursor, or turn around what is beside it, is '?'; behind
 * `most` characters it ends in "...". */
void buf_add_shown(Buf *buf, const char *text, size_t most);
/* The text, "" when empty. */
const char *buf_text(const Buf *buf);

/* Reads back the bytes of a buffer, in their order. */
typedef struct BufReader {
    const char *at;
    size_t left;
} BufReader;

/* false, and nothing is read, when there are not as many. */
bool buf_take(BufReader *reader, void *to, size_t length);

#endif
