/* habits.c - looks words up in habits.def and its like. Only done for messages, so that a walk along the rows is fast enough.
 * SPDX-License-Identifier: Apache-2.0 */
#include "lang/habits.h"

#include <string.h>
#include <strings.h>

#include "base/attr.h"

#define HABIT_DIRECTIVE(word, form, pattern)
#define HABIT_LIBRARY(words, text)
#define HABIT_VALUES(node, names)
#define HABIT_BLOCK(words, text)
#define HABIT_NODE(words, text)
#define HABIT_SETTING(node, word, pattern)
#define HABIT_TYPE(word)
#define HABIT_FUNCTION(word)
#define HABIT_IMPORT(word)
#define HABIT_HOLDS(node)
#define HABIT_STATEMENT(word, text)
#define HABIT_WORD(word, text)
#define HABIT_PREFIX(beginning, text)
#define HABIT_EXPORT(file, words, names)
#define HABIT_CHOICE(property, word, choice)
#define HABIT_INSTEAD(property, words, text)
#define HABIT_PROPERTY(node, word, property)
#define HABIT_ADVICE(node, word, text)
#define HABIT_FORMAL(formal, words, text)
#define HABIT_PATTERN(node, property, text)
#define HABIT_UNIT(word, unit)
#define HABIT_UNLIKELY(node, property, from, to, what, text)
#define HABIT_MEASURE(node, property, unit, text)
#define HABIT_FILE(beginnings, text)

static const struct {
    const char *word;
    DirectiveForm form;
    const char *pattern;
} directives[] = {
#undef HABIT_DIRECTIVE
#define HABIT_DIRECTIVE(word, form, pattern) {#word, DIRECTIVE_##form, pattern},
#include "lang/habits.def"
#undef HABIT_DIRECTIVE
#define HABIT_DIRECTIVE(word, form, pattern)
};

static const HabitRow library_rows[] = {
#undef HABIT_LIBRARY
#define HABIT_LIBRARY(words, text) {words, text},
#include "lang/habits.def"
#undef HABIT_LIBRARY
#define HABIT_LIBRARY(words, text)
};

static const HabitRow value_rows[] = {
#undef HABIT_VALUES
#define HABIT_VALUES(node, names) {#node, names},
#include "lang/habits.def"
#undef HABIT_VALUES
#define HABIT_VALUES(node, names)
};

static const HabitRow block_rows[] = {
#undef HABIT_BLOCK
#define HABIT_BLOCK(words, text) {words, text},
#include "lang/habit_nodes.def"
#undef HABIT_BLOCK
#define HABIT_BLOCK(words, text)
};

static const HabitRow node_rows[] = {
#undef HABIT_NODE
#define HABIT_NODE(words, text) {words, text},
#include "lang/habit_nodes.def"
#undef HABIT_NODE
#define HABIT_NODE(words, text)
};

/* What is so of nodes of one or some types, or of all: "". */
typedef struct NodeRow {
    const char *node, *word, *text;
} NodeRow;

static const NodeRow setting_rows[] = {
#undef HABIT_SETTING
#define HABIT_SETTING(node, word, pattern) {node, #word, pattern},
#include "lang/habits.def"
#undef HABIT_SETTING
#define HABIT_SETTING(node, word, pattern)
};

static const HabitRow type_rows[] = {
#undef HABIT_TYPE
#define HABIT_TYPE(word) {#word, #word},
#include "lang/habits.def"
#undef HABIT_TYPE
#define HABIT_TYPE(word)
};

static const HabitRow function_rows[] = {
#undef HABIT_FUNCTION
#define HABIT_FUNCTION(word) {#word, #word},
#include "lang/habits.def"
#undef HABIT_FUNCTION
#define HABIT_FUNCTION(word)
};

static const HabitRow import_rows[] = {
#undef HABIT_IMPORT
#define HABIT_IMPORT(word) {#word, #word},
#include "lang/habits.def"
#undef HABIT_IMPORT
#define HABIT_IMPORT(word)
};

static const HabitRow holder_rows[] = {
#undef HABIT_HOLDS
#define HABIT_HOLDS(node) {#node, #node},
#include "lang/habits.def"
#undef HABIT_HOLDS
#define HABIT_HOLDS(node)
};

static const HabitRow statement_rows[] = {
#undef HABIT_STATEMENT
#define HABIT_STATEMENT(word, text) {#word, text},
#include "lang/habits.def"
#undef HABIT_STATEMENT
#define HABIT_STATEMENT(word, text)
};

static const HabitRow word_rows[] = {
#undef HABIT_WORD
#define HABIT_WORD(word, text) {#word, text},
#include "lang/habit_words.def"
#undef HABIT_WORD
#define HABIT_WORD(word, text)
};

static const HabitRow prefix_rows[] = {
#undef HABIT_PREFIX
#define HABIT_PREFIX(beginning, text) {beginning, text},
#include "lang/habit_words.def"
#undef HABIT_PREFIX
#define HABIT_PREFIX(beginning, text)
};

static const NodeRow export_rows[] = {
#undef HABIT_EXPORT
#define HABIT_EXPORT(file, words, names) {"std/" #file ".mns", words, names},
#include "lang/habit_words.def"
#undef HABIT_EXPORT
#define HABIT_EXPORT(file, words, names)
};

static const struct {
    const char *property, *word, *choice;
} choice_rows[] = {
#undef HABIT_CHOICE
#define HABIT_CHOICE(property, word, choice) {property, #word, #choice},
#include "lang/habit_properties.def"
#undef HABIT_CHOICE
#define HABIT_CHOICE(property, word, choice)
};

static const NodeRow instead_rows[] = {
#undef HABIT_INSTEAD
#define HABIT_INSTEAD(property, words, text) {property, words, text},
#include "lang/habit_properties.def"
#undef HABIT_INSTEAD
#define HABIT_INSTEAD(property, words, text)
};

static const NodeRow property_rows[] = {
#undef HABIT_PROPERTY
#define HABIT_PROPERTY(node, word, property) {node, word, property},
#include "lang/habit_properties.def"
#undef HABIT_PROPERTY
#define HABIT_PROPERTY(node, word, property)
};

static const NodeRow advice_rows[] = {
#undef HABIT_ADVICE
#define HABIT_ADVICE(node, word, text) {node, word, text},
#include "lang/habit_properties.def"
#undef HABIT_ADVICE
#define HABIT_ADVICE(node, word, text)
};

static const NodeRow formal_rows[] = {
#undef HABIT_FORMAL
#define HABIT_FORMAL(formal, words, text) {formal, words, text},
#include "lang/habit_properties.def"
#undef HABIT_FORMAL
#define HABIT_FORMAL(formal, words, text)
};

static const NodeRow pattern_rows[] = {
#undef HABIT_PATTERN
#define HABIT_PATTERN(node, property, text) {node, property, text},
#include "lang/habit_properties.def"
#undef HABIT_PATTERN
#define HABIT_PATTERN(node, property, text)
};

static const HabitRow file_rows[] = {
#undef HABIT_FILE
#define HABIT_FILE(beginnings, text) {beginnings, text},
#include "lang/habits.def"
#undef HABIT_FILE
#define HABIT_FILE(beginnings, text)
};

static const struct {
    const char *node, *property;
    PropUnit unit;
    const char *text;
} measure_rows[] = {
#undef HABIT_MEASURE
#define HABIT_MEASURE(node, property, unit, text) {node, property, UNIT_##unit, text},
#include "lang/habit_properties.def"
#undef HABIT_MEASURE
#define HABIT_MEASURE(node, property, unit, text)
};

static const struct {
    const char *node, *property;
    double from, to;
    const char *what, *text;
} unlikely_rows[] = {
#undef HABIT_UNLIKELY
#define HABIT_UNLIKELY(node, property, from, to, what, text) {node, #property, from, to, what, text},
#include "lang/habit_properties.def"
#undef HABIT_UNLIKELY
#define HABIT_UNLIKELY(node, property, from, to, what, text)
};

static const HabitRow unit_rows[] = {
#undef HABIT_UNIT
#define HABIT_UNIT(word, unit) {#word, #unit},
#include "lang/habits.def"
};

bool habit_is_one_of(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = words; *at; at += strspn(at, " ")) {
        size_t n = strcspn(at, " ");
        if (n == length && memcmp(at, word, length) == 0) return true;
        at += n;
    }
    return false;
}

static const char *find(const HabitRow *rows, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++)
        if (habit_is_one_of(rows[i].words, word)) return rows[i].text;
    return NULL;
}

static const char *find_of_node(const NodeRow *rows, size_t n, const char *node, const char *word)
{
    for (size_t i = 0; i < n; i++)
        if (habit_is_one_of(rows[i].word, word) && (!*rows[i].node || (node && habit_is_one_of(rows[i].node, node))))
            return rows[i].text;
    return NULL;
}

DirectiveForm habit_directive(const char *word, size_t length)
{
    for (size_t i = 0; i < COUNT_OF(directives); i++)
        if (strlen(directives[i].word) == length && memcmp(directives[i].word, word, length) == 0)
            return directives[i].form;
    return DIRECTIVE_NONE;
}

const char *habit_directive_pattern(const char *word)
{
    for (size_t i = 0; i < COUNT_OF(directives); i++)
        if (strcmp(directives[i].word, word) == 0) return directives[i].pattern;
    return NULL;
}

const char *habit_values(const char *node)
{
    return find(value_rows, COUNT_OF(value_rows), node);
}
const char *habit_library(const char *name)
{
    return find(library_rows, COUNT_OF(library_rows), name);
}
const char *habit_block(const char *word)
{
    return find(block_rows, COUNT_OF(block_rows), word);
}
const HabitRow *habit_blocks(size_t *n)
{
    *n = COUNT_OF(block_rows);
    return block_rows;
}
const char *habit_node(const char *word)
{
    const char *block = habit_block(word);
    return block ? block : find(node_rows, COUNT_OF(node_rows), word);
}
const char *habit_setting(const char *node, const char *word)
{
    return find_of_node(setting_rows, COUNT_OF(setting_rows), node, word);
}
const char *habit_statement(const char *word)
{
    return find(statement_rows, COUNT_OF(statement_rows), word);
}

const char *habit_word(const char *word)
{
    const char *text = find(word_rows, COUNT_OF(word_rows), word);
    for (size_t i = 0; !text && i < COUNT_OF(prefix_rows); i++)
        if (strncmp(word, prefix_rows[i].words, strlen(prefix_rows[i].words)) == 0) text = prefix_rows[i].text;
    return text;
}
const char *habit_export(const char *file, const char *word)
{
    return find_of_node(export_rows, COUNT_OF(export_rows), file, word);
}
const char *habit_choice(const char *property, const char *word)
{
    for (size_t i = 0; i < COUNT_OF(choice_rows); i++)
        if (strcmp(choice_rows[i].property, property) == 0 && strcasecmp(choice_rows[i].word, word) == 0)
            return choice_rows[i].choice;
    return NULL;
}
const char *habit_instead(const char *property, const char *word)
{
    return find_of_node(instead_rows, COUNT_OF(instead_rows), property, word);
}
const char *habit_unit(const char *word)
{
    return find(unit_rows, COUNT_OF(unit_rows), word);
}
bool habit_is_type(const char *word)
{
    return find(type_rows, COUNT_OF(type_rows), word) != NULL;
}
bool habit_is_function(const char *word)
{
    return find(function_rows, COUNT_OF(function_rows), word) != NULL;
}
bool habit_holds_nodes(const char *node)
{
    return find(holder_rows, COUNT_OF(holder_rows), node) != NULL;
}
bool habit_is_import(const char *word)
{
    return find(import_rows, COUNT_OF(import_rows), word) != NULL;
}

const char *habit_property(const char *node, const char *word, unsigned number)
{
    for (size_t i = 0; i < COUNT_OF(property_rows); i++) {
        if (!habit_is_one_of(property_rows[i].word, word)) continue;
        if (*property_rows[i].node && !habit_is_one_of(property_rows[i].node, node)) continue;
        if (number-- == 0) return property_rows[i].text;
    }
    return NULL;
}

const char *habit_property_of(const char *node, const char *word)
{
    for (size_t i = 0; i < COUNT_OF(property_rows); i++)
        if (habit_is_one_of(property_rows[i].word, word) && habit_is_one_of(property_rows[i].node, node))
            return property_rows[i].text;
    return NULL;
}

const char *habit_assignment(Arena *arena, const char *candidate, const char *value)
{
    return strchr(candidate, '=') ? candidate : arena_format(arena, "%s = %s", candidate, value);
}

const char *habit_advice(const char *node, const char *word)
{
    return find_of_node(advice_rows, COUNT_OF(advice_rows), node, word);
}

const char *habit_formal(const char *const *formals, size_t n, const char *word)
{
    for (size_t i = 0; i < COUNT_OF(formal_rows); i++) {
        if (!habit_is_one_of(formal_rows[i].word, word)) continue;
        if (!*formal_rows[i].node) return formal_rows[i].text;
        for (size_t k = 0; k < n; k++)
            if (strcmp(formals[k], formal_rows[i].node) == 0) return formal_rows[i].text;
    }
    return NULL;
}

const char *habit_pattern(const char *node, const char *property)
{
    return find_of_node(pattern_rows, COUNT_OF(pattern_rows), node, property);
}

const char *habit_file(const char *text)
{
    for (size_t i = 0; i < COUNT_OF(file_rows); i++)
        for (const char *at = file_rows[i].words; *at; at += strspn(at, " ")) {
            size_t n = strcspn(at, " ");
            bool whole =
                strncmp(text, at, n) == 0 && (strchr(" \t\r\n\"=", text[n]) || strchr("<{", *at)); /* or the 0 */
            if (whole) return file_rows[i].text;
            at += n;
        }
    return NULL;
}

const char *habit_measure(const char *node, const char *property, PropUnit unit)
{
    for (size_t i = 0; i < COUNT_OF(measure_rows); i++)
        if (measure_rows[i].unit == unit && habit_is_one_of(measure_rows[i].property, property) &&
            habit_is_one_of(measure_rows[i].node, node))
            return measure_rows[i].text;
    return NULL;
}

const char *habit_unlikely(const char *node, const char *property, double number, const char **what)
{
    for (size_t i = 0; i < COUNT_OF(unlikely_rows); i++)
        if (strcmp(unlikely_rows[i].property, property) == 0 && habit_is_one_of(unlikely_rows[i].node, node) &&
            number >= unlikely_rows[i].from && number <= unlikely_rows[i].to) {
            *what = unlikely_rows[i].what;
            return unlikely_rows[i].text;
        }
    return NULL;
}

const char *habit_fill(Arena *arena, const char *pattern, const char *text)
{
    const char *mark = strchr(pattern, '@');
    if (!mark) return pattern;
    return arena_format(arena, "%.*s%s%s", (int)(mark - pattern), pattern, text, mark + 1 + (mark[1] == '*'));
}
