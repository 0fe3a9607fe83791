/* mdoc.c - plain text to mdoc(7).
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/mdoc.h"

#include <stdbool.h>
#include <string.h>

enum { LINE = 78 };

/* A text under way: what stands on the present line. */
typedef struct Writer {
    Buf *out;
    size_t column; /* 0: a line begins */
    bool after_sentence;
} Writer;

void mdoc_escape(Buf *out, const char *text, size_t length, bool literal)
{
    for (size_t i = 0; i < length; i++) {
        if (text[i] == '\\')
            buf_add(out, "\\e");
        else if (text[i] == '"')
            buf_add(out, "\\(dq");
        else if (literal && text[i] == '-')
            buf_add(out, "\\-");
        else
            buf_add_bytes(out, &text[i], 1);
    }
}

static void end_line(Writer *writer)
{
    if (writer->column) buf_add(writer->out, "\n");
    writer->column = 0;
}

/* J. Opt. Soc. Am. of a source: no end of a sentence, neither here nor for roff */
static bool is_abbreviation(const char *word, size_t length)
{
    enum { LONGEST = 6 };
    bool capital = word[0] >= 'A' && word[0] <= 'Z', capitals = word[1] >= 'A' && word[1] <= 'Z';
    return length <= LONGEST && word[length - 1] == '.' && capital && !capitals;
}

static void add_word(Writer *writer, const char *word, size_t length)
{
    if (writer->column && (writer->after_sentence || writer->column + 1 + length > LINE)) end_line(writer);
    if (writer->column)
        buf_add(writer->out, " ");
    else if (word[0] == '.' || word[0] == '\'')
        buf_add(writer->out, "\\&"); /* no request of roff's */
    size_t start = writer->out->length;
    for (size_t i = 0; i < length;) {
        const char *tick = memchr(word + i, '`', length - i);
        size_t n = tick ? (size_t)(tick - word) - i : length - i;
        mdoc_escape(writer->out, word + i, n, false);
        i += n;
        const char *close = tick ? memchr(word + i + 1, '`', length - i - 1) : NULL;
        if (!close) break;
        buf_add(writer->out, "\\(oq");
        mdoc_escape(writer->out, word + i + 1, (size_t)(close - word) - i - 1, true);
        buf_add(writer->out, "\\(cq");
        i = (size_t)(close - word) + 1;
    }
    writer->column += writer->out->length - start + 1;
    bool abbreviated = is_abbreviation(word, length);
    if (abbreviated) buf_add(writer->out, "\\&");
    writer->after_sentence = !abbreviated && strchr(".?!", word[length - 1]) != NULL;
}

/* A span that stands by itself: `.Fl -json` for an option, `.Ql text` for anything else, with the punctuation behind it. */
static void add_span(Writer *writer, const char *span, size_t length, const char *marks, size_t n_marks)
{
    end_line(writer);
    bool option = span[0] == '-' && length > 1 && !memchr(span, ' ', length) && !memchr(span, '=', length);
    if (option)
        buf_add(writer->out, ".Fl ");
    else
        buf_add(writer->out, ".Ql \"");
    if (option)
        buf_add_bytes(writer->out, span + 1, length - 1);
    else
        mdoc_escape(writer->out, span, length, true);
    if (!option) buf_add(writer->out, "\"");
    for (size_t i = 0; i < n_marks; i++) buf_format(writer->out, " %c", marks[i]);
    buf_add(writer->out, "\n");
    writer->after_sentence = false;
}

/* The length of a function's name when the word is name() and perhaps punctuation, else 0. */
static size_t function_name(const char *word, size_t length)
{
    size_t n = strspn(word, "abcdefghijklmnopqrstuvwxyz_0123456789");
    if (n == 0 || n + 2 > length || word[n] != '(' || word[n + 1] != ')') return 0;
    return strspn(word + n + 2, ".,;:") >= length - n - 2 ? n : 0;
}

static void add_function(Writer *writer, const char *word, size_t n, size_t length)
{
    end_line(writer);
    buf_format(writer->out, ".Fn %.*s", (int)n, word);
    for (size_t i = n + 2; i < length; i++) buf_format(writer->out, " %c", word[i]);
    buf_add(writer->out, "\n");
    writer->after_sentence = false;
}

/* Words are divided by blanks, but a blank within `...` is part of its word. */
static size_t word_length(const char *text)
{
    size_t n = 0;
    bool within = false;
    while (text[n] && (within || (text[n] != ' ' && text[n] != '\n'))) {
        if (text[n] == '`') within = !within;
        n++;
    }
    return n;
}

void mdoc_text(Buf *out, const char *text)
{
    Writer writer = {.out = out};
    while (*text) {
        size_t length = word_length(text);
        const char *close = length > 1 && text[0] == '`' ? memchr(text + 1, '`', length - 1) : NULL;
        size_t span = close ? (size_t)(close - text) - 1 : 0, marks = close ? length - span - 2 : 0;
        if (close && strspn(close + 1, ".,;:") >= marks)
            add_span(&writer, text + 1, span, close + 1, marks);
        else if (function_name(text, length))
            add_function(&writer, text, function_name(text, length), length);
        else if (length)
            add_word(&writer, text, length);
        text += length;
        if (*text == '\n') {
            end_line(&writer);
            buf_add(out, ".Pp\n");
        }
        if (*text) text++;
    }
    end_line(&writer);
}

void mdoc_sentence(Buf *out, const char *text)
{
    Buf sentence = {0};
    bool lower = text[0] >= 'a' && text[0] <= 'z';
    size_t length = strlen(text);
    buf_format(&sentence, "%c%s%s", lower ? text[0] - 'a' + 'A' : text[0], text + 1,
               length && text[length - 1] == '.' ? "" : ".");
    mdoc_text(out, buf_text(&sentence));
    buf_clear(&sentence);
}

void mdoc_example(Buf *out, const char *line, size_t length)
{
    buf_add(out, ".Bd -literal -offset indent\n");
    mdoc_escape(out, line, length, true);
    buf_add(out, "\n.Ed\n");
}
