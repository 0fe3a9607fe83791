/* buf.c - the growing text buffer.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/buf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/utf8.h"

void buf_clear(Buf *buf)
{
    free(buf->text);
    *buf = (Buf){0};
}

static bool buf_reserve(Buf *buf, size_t more)
{
    if (buf->failed) return false;
    if (more < buf->capacity - buf->length) return true;
    size_t capacity = buf->capacity ? buf->capacity * 2 : 256;
    while (capacity <= buf->length + more) capacity *= 2;
    char *text = realloc(buf->text, capacity);
    if (!text) {
        buf->failed = true;
        return false;
    }
    buf->text = text;
    buf->capacity = capacity;
    return true;
}

void buf_add_bytes(Buf *buf, const char *bytes, size_t length)
{
    if (!buf_reserve(buf, length)) return;
    if (length) memcpy(buf->text + buf->length, bytes, length);
    buf->length += length;
    buf->text[buf->length] = 0;
}

void buf_add(Buf *buf, const char *text)
{
    buf_add_bytes(buf, text, strlen(text));
}

void buf_add_repeat(Buf *buf, char byte, size_t count)
{
    if (!buf_reserve(buf, count)) return;
    memset(buf->text + buf->length, byte, count);
    buf->length += count;
    buf->text[buf->length] = 0;
}

void buf_format_list(Buf *buf, const char *format, va_list arguments)
{
    va_list again;
    va_copy(again, arguments);
    int length = vsnprintf(NULL, 0, format, arguments);
    if (length >= 0 && buf_reserve(buf, (size_t)length)) {
        vsnprintf(buf->text + buf->length, (size_t)length + 1, format, again);
        buf->length += (size_t)length;
    }
    va_end(again);
}

void buf_format(Buf *buf, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    buf_format_list(buf, format, arguments);
    va_end(arguments);
}

/* No text, or it moves a cursor, or turns what stands beside it around (marks of the direction of writing). */
static bool is_hidden(uint32_t code)
{
    return code == UTF8_INVALID || code < ' ' || (code >= 0x7f && code < 0xa0) || code == 0x200e || code == 0x200f ||
           (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

void buf_add_shown(Buf *buf, const char *text, size_t most)
{
    size_t length = strlen(text), shown = 0;
    for (size_t at = 0; at < length; shown++) {
        if (shown == most) {
            buf_add(buf, "...");
            return;
        }
        uint32_t code;
        size_t n = utf8_decode(text + at, length - at, &code);
        if (is_hidden(code))
            buf_add(buf, "?");
        else
            buf_add_bytes(buf, text + at, n);
        at += n;
    }
}

const char *buf_text(const Buf *buf)
{
    return buf->text ? buf->text : "";
}

bool buf_take(BufReader *reader, void *to, size_t length)
{
    if (length > reader->left) return false;
    if (length) memcpy(to, reader->at, length);
    reader->at += length;
    reader->left -= length;
    return true;
}
