/* utf8.h - decoding of UTF-8 and the columns that a code point takes on a terminal.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_UTF8_H
#define MEN_UTF8_H

#include <stddef.h>
#include <stdint.h>

#define UTF8_INVALID UINT32_MAX

/* How long the mark is that some writers put before a text: 3, or 0. */
size_t utf8_mark_length(const char *text, size_t length);

/* Decodes the code point at text (length bytes are readable) and returns how many bytes it takes, at least 1
 * unless length is 0. A byte that starts no valid sequence (overlong forms and surrogates included) counts as one
 * byte with *code = UTF8_INVALID. */
size_t utf8_decode(const char *text, size_t length, uint32_t *code);

/* Writes code (up to 0x10ffff, no surrogate) to out and returns the number of bytes, 1 to 4. */
size_t utf8_encode(uint32_t code, char out[4]);

/* Columns on a terminal: 0 for combining marks and format characters, 2 for wide East Asian characters and
 * emoji, 1 for the rest. Control characters have no width of their own; they count as 1. */
unsigned utf8_width(uint32_t code);

#endif
