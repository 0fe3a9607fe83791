/* mdoc.h - writes the language of manual pages, mdoc(7), from the plain texts of the tables.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MDOC_H
#define MEN_MDOC_H

#include "base/buf.h"

/* Running text on lines of its own: a sentence begins a line, `...` becomes a literal or an option, a line
 * break a paragraph. */
void mdoc_text(Buf *out, const char *text);
/* The same, as a sentence: with a capital letter and a full stop. */
void mdoc_sentence(Buf *out, const char *text);
/* Text within a line, with what roff would read as its own escaped. literal: hyphens stay minus signs. */
void mdoc_escape(Buf *out, const char *text, size_t length, bool literal);
/* Lines to be typed, as a block. */
void mdoc_example(Buf *out, const char *line, size_t length);

#endif
