/* import_text.c - nodes, numbers, names and comments of a scene that is written.
 * Lines are broken here and laid out by fmt's printer afterwards.
 * SPDX-License-Identifier: Apache-2.0 */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"
#include "base/num.h"
#include "base/utf8.h"
#include "import/import_parts.h"
#include "lang/lex.h"
#include "lang/resolve.h"
#include "scene/build.h"

enum { LINE_WIDTH = 108, COMMENT_WIDTH = 108, LONGEST_SHOWN = 60, LONGEST_NAME = 40, LONGEST_STRING = 200 };

/* ---- names ---- */

static bool is_word_of_language(const char *name)
{
    const char *word;
    for (size_t i = 0; (word = language_word_at(scene_schema(), i)) != NULL; i++)
        if (strcmp(word, name) == 0) return true;
    /* the medium of the prelude, and what the scene itself uses */
    static const char *const others[] = {"air", "studio", "_"};
    for (size_t i = 0; i < COUNT_OF(others); i++)
        if (strcmp(others[i], name) == 0) return true;
    return false;
}

static ImportName *find_name_taken(const Importer *im, const char *name)
{
    for (size_t i = 0; i < im->n_names; i++)
        if (strcmp(im->names[i].text, name) == 0) return &im->names[i];
    return NULL;
}

/* What has the name; NULL: nothing. */
static const char *taken_by(const Importer *im, const char *name)
{
    const ImportName *found = find_name_taken(im, name);
    if (found) return found->kind;
    return is_word_of_language(name) ? "" : NULL;
}

/* Letters of any script, digits and single underscores, lower case as far as ASCII goes: "Green Glass.001" is green_glass_001. */
static void spell(const char *called, char name[LONGEST_NAME + 1])
{
    size_t n = 0, length = strlen(called);
    for (size_t at = 0; at < length;) {
        uint32_t code;
        size_t size = utf8_decode(called + at, length - at, &code);
        bool plain = code < 0x80 && isalnum((int)code), letter = code >= 0x80 && lexer_is_letter(code);
        if (n + size > LONGEST_NAME) break;
        if (letter) memcpy(name + n, called + at, size);
        if (plain) name[n] = (char)tolower((int)code);
        if (letter || plain)
            n += size;
        else if (n > 0 && name[n - 1] != '_')
            name[n++] = '_';
        at += size;
    }
    while (n > 0 && name[n - 1] == '_') n--;
    name[n] = 0;
}

char *import_name(Importer *im, const char *called, const char *unspelt, const char *kind)
{
    char stem[LONGEST_NAME + 1], name[2 * LONGEST_NAME + 24], first[2 * LONGEST_NAME];
    spell(called, stem);
    if (!*stem) snprintf(stem, sizeof stem, "%s", unspelt);
    if (!isdigit((unsigned char)*stem))
        snprintf(first, sizeof first, "%s", stem);
    else
        snprintf(first, sizeof first, "%s_%s", kind, stem);
    snprintf(name, sizeof name, "%s", first);
    const char *other = taken_by(im, name);
    if (other && strcmp(other, kind) != 0) {
        snprintf(first, sizeof first, "%s_%s", stem, kind);
        snprintf(name, sizeof name, "%s", first);
    }
    ImportName *same = find_name_taken(im, first);
    unsigned long number = same ? same->n_same : 1;
    while (taken_by(im, name)) snprintf(name, sizeof name, "%s_%lu", first, ++number);
    if (same) same->n_same = number;
    char *kept = strdup(name), *copy = strdup(name);
    if (!kept || !copy || !ARRAY_ROOM(im->names, im->name_capacity, im->n_names)) {
        im->failed = true;
        free(kept);
        return copy;
    }
    im->names[im->n_names++] = (ImportName){kept, kind, 1};
    return copy;
}

/* ---- values ---- */

void add_number(Buf *out, double value)
{
    char text[NUM_TEXT_SIZE + 8];
    snprintf(text, sizeof text, "%.4g", value);
    num_parse(text, strlen(text), &value); /* 1e+03 is 1000 */
    num_print(value == 0 ? 0 : value, text);
    buf_add(out, text);
}

void add_color(Buf *out, const double rgb[3])
{
    if (rgb[0] == rgb[1] && rgb[1] == rgb[2]) {
        add_number(out, rgb[0]);
        return;
    }
    for (int i = 0; i < 3; i++) {
        buf_add(out, i == 0 ? "rgb(" : ", ");
        add_number(out, rgb[i]);
    }
    buf_add(out, ")");
}

void add_coordinate(const Importer *im, Buf *out, double value)
{
    char text[NUM_TEXT_SIZE];
    double rounded = round(value / im->step) * im->step;
    num_print_rounded(rounded == 0 ? 0 : rounded, text);
    buf_add(out, text);
}

void add_point(const Importer *im, Buf *out, Vec3 p)
{
    const double numbers[3] = {p.x, p.y, p.z};
    for (int i = 0; i < 3; i++) {
        buf_add(out, i == 0 ? "<" : ", ");
        add_coordinate(im, out, numbers[i]);
    }
    buf_add(out, ">");
}

bool text_is_plain(const char *text)
{
    size_t length = strlen(text);
    if (length == 0 || length > LONGEST_STRING) return false;
    for (size_t at = 0; at < length;) {
        uint32_t code;
        at += utf8_decode(text + at, length - at, &code);
        if (code == UTF8_INVALID || code < ' ' || code == 0x7f) return false;
    }
    return true;
}

/* ---- comments ---- */

void add_shown(Buf *out, const char *text)
{
    buf_add_shown(out, text, LONGEST_SHOWN);
}

/* Adds words as lines of a comment. */
static void add_comment(Buf *out, const char *text)
{
    size_t column = 0;
    for (const char *at = text; *at;) {
        size_t n = strcspn(at, " ");
        if (column == 0 || column + 1 + n > COMMENT_WIDTH) {
            buf_add(out, column ? "\n//" : "//");
            column = 2;
        }
        buf_add(out, " ");
        buf_add_bytes(out, at, n);
        column += 1 + n;
        at += n;
        while (*at == ' ') at++;
    }
    buf_add(out, "\n");
}

static void note_text(Importer *im, const char *text)
{
    Import *out = im->out;
    Buf line = {0};
    if (im->subject) buf_format(&line, "%s: ", im->subject);
    buf_add(&line, text);
    for (size_t i = 0; i < out->n_notes && line.text; i++)
        if (strcmp(out->notes[i], line.text) == 0) { /* of another object of the same material */
            buf_clear(&line);
            return;
        }
    if (line.failed || !ARRAY_ROOM(out->notes, out->note_capacity, out->n_notes)) {
        im->failed = true;
        buf_clear(&line);
        return;
    }
    out->notes[out->n_notes++] = line.text;
}

static void say(Importer *im, bool note, const char *format, va_list arguments) ATTR_PRINTF(3, 0);
/* In a comment it is a sentence. */
static void say(Importer *im, bool note, const char *format, va_list arguments)
{
    Buf text = {0};
    buf_format_list(&text, format, arguments);
    if (note) {
        note_text(im, buf_text(&text));
        if (text.text) text.text[0] = (char)toupper((unsigned char)text.text[0]);
        buf_add(&text, ".");
    }
    add_comment(&im->comment, buf_text(&text));
    im->failed |= text.failed;
    buf_clear(&text);
}

void import_say(Importer *im, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(im, false, format, arguments);
    va_end(arguments);
}

void import_note(Importer *im, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    say(im, true, format, arguments);
    va_end(arguments);
}

void import_write_comment(Importer *im)
{
    buf_add(im->text, buf_text(&im->comment));
    im->failed |= im->comment.failed;
    buf_clear(&im->comment);
}

void import_begin_section(Importer *im, const char *title)
{
    buf_format(im->text, "\n// ---- %s ----\n\n", title);
}

/* ---- nodes ---- */

NodeText node_begin(Importer *im, const char *type, const char *name)
{
    NodeText node = {.im = im};
    buf_format(&node.line, "%s%s%s {", type, name ? " " : "", name ? name : "");
    return node;
}

/* Where the property written last goes beyond the width, it goes to a line of its own. */
static void node_break(NodeText *node)
{
    if (node->value || node->n_props == 0 || node->line.length - node->line_begin <= LINE_WIDTH ||
        node->prop_begin == node->line_begin)
        return;
    Buf broken = {0};
    buf_add_bytes(&broken, buf_text(&node->line), node->prop_begin);
    buf_add(&broken, "\n");
    size_t begin = broken.length;
    const char *rest = buf_text(&node->line) + node->prop_begin;
    while (*rest == ' ') rest++;
    buf_format(&broken, "  %s", rest);
    buf_clear(&node->line);
    node->line = broken;
    node->line_begin = node->prop_begin = begin;
}

Buf *node_prop(NodeText *node, const char *key)
{
    node_break(node);
    node->prop_begin = node->line.length;
    buf_format(&node->line, "%s%s = ", node->n_props++ ? "  " : " ", key);
    return &node->line;
}

void node_number(NodeText *node, const char *key, double value)
{
    add_number(node_prop(node, key), value);
}

void node_color(NodeText *node, const char *key, const double rgb[3])
{
    add_color(node_prop(node, key), rgb);
}

void node_point(NodeText *node, const char *key, Vec3 p)
{
    add_point(node->im, node_prop(node, key), p);
}

void node_word(NodeText *node, const char *key, const char *word)
{
    buf_add(node_prop(node, key), word);
}

/* With its unit, as 12mm. */
void node_length(NodeText *node, const char *key, double metres)
{
    add_number(node_prop(node, key), metres / node->im->scene_m);
    buf_add(&node->line, node->im->unit);
}

void node_end(NodeText *node)
{
    node_break(node);
    Importer *im = node->im;
    import_write_comment(im);
    buf_add(im->text, buf_text(&im->lets));
    buf_format(im->text, "%s }\n", buf_text(&node->line));
    im->failed |= node->line.failed || im->lets.failed;
    buf_clear(&im->lets);
    buf_clear(&node->line);
}

void node_end_value(NodeText *node, Buf *out)
{
    buf_format(out, "%s }", buf_text(&node->line));
    node->im->failed |= node->line.failed;
    buf_clear(&node->line);
}
