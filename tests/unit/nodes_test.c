/* nodes_test.c - the table of nodes is in order: what the checker and the manual are made from.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/num.h"
#include "lang/habits.h"
#include "scene/library.h"
#include "scene_fixture.h"

static void check_doc(const char *what, const char *doc)
{
    if (!doc || !*doc) fail_msg("%s has no documentation", what);
    if (doc[strlen(doc) - 1] == '.') fail_msg("the documentation of %s ends in a full stop", what);
    if (isupper((unsigned char)doc[0])) fail_msg("the documentation of %s starts with a capital", what);
}

static bool is_choice(const char *choices, const char *word)
{
    size_t n = strlen(word);
    for (const char *p = choices; p; p = strchr(p, '|') ? strchr(p, '|') + 1 : NULL)
        if (strncmp(p, word, n) == 0 && (p[n] == '|' || p[n] == 0)) return true;
    return false;
}

static bool is_node(const char *name)
{
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++)
        if (strcmp(schema->nodes[i].name, name) == 0) return true;
    return false;
}

static void names_are_unique_and_documented(void **state)
{
    (void)state;
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const NodeType *node = &schema->nodes[i];
        check_doc(node->name, node->doc);
        for (size_t k = 0; k < i; k++) assert_string_not_equal(node->name, schema->nodes[k].name);
        for (size_t p = 0; p < node->n_props; p++) {
            check_doc(node->props[p].name, node->props[p].doc);
            for (size_t q = 0; q < p; q++) assert_string_not_equal(node->props[p].name, node->props[q].name);
        }
    }
    for (size_t i = 0; i < schema->n_terms; i++) check_doc(schema->terms[i].name, schema->terms[i].doc);
}

static void defaults_are_in_range(void **state)
{
    (void)state;
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++)
        for (size_t p = 0; p < schema->nodes[i].n_props; p++) {
            const PropType *prop = &schema->nodes[i].props[p];
            assert_true(prop->min <= prop->max);
            if (prop->flags & PROP_REQUIRED) assert_null(prop->default_text);
            if (prop->kind == PROP_CHOICE) assert_non_null(prop->choices);
            if (prop->kind == PROP_CHOICE && prop->default_text)
                assert_true(is_choice(prop->choices, prop->default_text));
            if (prop->kind == PROP_NODE || prop->kind == PROP_NODES) assert_true(is_node(prop->choices));
            if ((prop->kind != PROP_NUMBER && prop->kind != PROP_INTEGER) || !prop->default_text) continue;
            double value;
            assert_int_equal(num_parse(prop->default_text, strlen(prop->default_text), &value),
                             strlen(prop->default_text));
            assert_true(value >= prop->min && value <= prop->max);
            if (prop->kind == PROP_INTEGER) assert_true(value == floor(value));
        }
}

/* Every node can be written with nothing but what it must have. */
static void bare_nodes_are_accepted(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(
        &f, "meniscus 1.0 unit mm medium m { ior = 1.5 } surface s { } world { } sphere { surface = s } "
            "cylinder { interior = m } torus { interior = m } capsule { interior = m } "
            "ellipsoid { radii = <1, 2, 3> interior = m } cone { interior = m } box { size = <1, 1, 1> interior = m } "
            "lathe { profile = [<0, 0>, <1, 0>, <1, 1>, <0, 1>] interior = m } ground { } group { } "
            "mesh { positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>] triangles = [<0, 1, 2>] surface = s } "
            "light { to = <1, 0, 0> size = <1, 1> } environment { } camera { from = <9, 9, 9> } film { } render { }");
    fixture_clear(&f);
}

/* How many of the nodes, or of all where they are "", have such a property? */
static size_t count_property(const char *nodes, const char *name, size_t length)
{
    const Schema *schema = scene_schema();
    size_t n = 0;
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const NodeType *type = &schema->nodes[i];
        if (*nodes && !habit_is_one_of(nodes, type->name)) continue;
        for (size_t p = 0; p < type->n_props; p++)
            n += strlen(type->props[p].name) == length && strncmp(type->props[p].name, name, length) == 0;
    }
    return n;
}

static size_t count_words(const char *words)
{
    size_t n = 0;
    for (; *words; words += strspn(words, " "), n++) words += strcspn(words, " ");
    return n;
}

/* What hints tell writers of other languages to write can be written. */
static void hints_name_what_there_is(void **state)
{
    (void)state;
#define HABIT_DIRECTIVE(word, form, pattern)
#define HABIT_LIBRARY(words, text)
#define HABIT_SETTING(node, word, pattern)
#define HABIT_TYPE(word)
#define HABIT_FUNCTION(word)
#define HABIT_HOLDS(node)
#define HABIT_IMPORT(word)
#define HABIT_STATEMENT(word, text)
#define HABIT_CHOICE(property, word, choice)
#define HABIT_INSTEAD(property, words, text)
#define HABIT_ADVICE(node, word, text)
#define HABIT_FORMAL(formal, words, text)
#define HABIT_UNIT(word, unit)
#define HABIT_PATTERN(node, property, text) {node, property},
#define HABIT_FILE(beginnings, text)
#define HABIT_MEASURE(node, property, unit, text) {node, property},
#define HABIT_UNLIKELY(node, property, from, to, what, text) {node, #property},
#define HABIT_VALUES(node, names) {#node, names},
#define HABIT_PROPERTY(node, word, property) {node, property},
    static const struct {
        const char *node, *names;
    } hints[] = {
#include "lang/habits.def"
#include "lang/habit_properties.def"
    };
    assert_true(COUNT_OF(hints) > 80);
    for (size_t i = 0; i < COUNT_OF(hints); i++)
        for (const char *name = hints[i].names; *name; name += strspn(name, "*+ ")) {
            size_t length = strcspn(name, "*+ ");
            size_t n_nodes = count_words(hints[i].node);
            if (count_property(hints[i].node, name, length) < (n_nodes ? n_nodes : 1))
                fail_msg("no property '%.*s' of '%s'", (int)length, name, hints[i].node);
            name += length;
            if (strncmp(name, " =", 2) == 0) break; /* the rest is an example */
        }
}

/* A hint for what is a property would never be seen, nor one for a node that there is not. */
static void hints_are_for_what_there_is_not(void **state)
{
    (void)state;
#undef HABIT_ADVICE
#undef HABIT_PATTERN
#undef HABIT_MEASURE
#define HABIT_MEASURE(node, property, unit, text)
#undef HABIT_UNLIKELY
#define HABIT_UNLIKELY(node, property, from, to, what, text)
#undef HABIT_VALUES
#undef HABIT_PROPERTY
#define HABIT_PATTERN(node, property, text)
#define HABIT_VALUES(node, names)
#define HABIT_PROPERTY(node, word, property) {node, word},
#define HABIT_ADVICE(node, word, text) {node, word},
    static const struct {
        const char *nodes, *words;
    } hints[] = {
#include "lang/habit_properties.def"
    };
    for (size_t i = 0; i < COUNT_OF(hints); i++) {
        size_t n = 0;
        for (size_t k = 0; k < scene_schema()->n_nodes; k++)
            n += habit_is_one_of(hints[i].nodes, scene_schema()->nodes[k].name);
        if (n != count_words(hints[i].nodes)) fail_msg("one of '%s' is no node", hints[i].nodes);
        for (const char *word = hints[i].words; *hints[i].nodes && *word; word += strspn(word, " ")) {
            size_t length = strcspn(word, " ");
            if (count_property(hints[i].nodes, word, length) == n)
                fail_msg("'%.*s' is a property of '%s'", (int)length, word, hints[i].nodes);
            word += length;
        }
    }
}

/* Nor one for a node that there is. */
static void other_nodes_are_none_here(void **state)
{
    (void)state;
#define HABIT_BLOCK(words, text)
#define HABIT_NODE(words, text) words,
    static const char *const rows[] = {
#include "lang/habit_nodes.def"
    };
    assert_true(COUNT_OF(rows) > 40);
    for (size_t i = 0; i < COUNT_OF(rows); i++)
        for (size_t k = 0; k < scene_schema()->n_nodes; k++)
            if (habit_is_one_of(rows[i], scene_schema()->nodes[k].name))
                fail_msg("'%s' is a node", scene_schema()->nodes[k].name);
}

static bool library_declares(const char *file, const char *name, size_t length)
{
    static const char *const keywords[] = {"def", "medium"};
    char whole[80], line[80];
    snprintf(whole, sizeof whole, "std/%s.mns", file);
    const EvalLibraryFile *found = NULL;
    for (size_t i = 0; i < std_library.n_files; i++)
        if (strcmp(std_library.files[i].name, whole) == 0) found = &std_library.files[i];
    assert_non_null(found);
    for (size_t i = 0; i < COUNT_OF(keywords); i++) {
        snprintf(line, sizeof line, "\n%s %.*s", keywords[i], (int)length, name);
        const char *at = strstr(found->text, line);
        for (; at; at = strstr(at + 1, line))
            if (at[strlen(line)] == ' ' || at[strlen(line)] == '(') return true;
    }
    return false;
}

/* Other words for what the library has: they are no names of its files, and what they stand for is. */
static void names_of_the_library_are_there(void **state)
{
    (void)state;
#undef HABIT_WORD
#define HABIT_WORD(words, text)
#define HABIT_PREFIX(beginning, text)
#define HABIT_EXPORT(file, words, names) {#file, words, names},
    static const struct {
        const char *file, *words, *names;
    } rows[] = {
#include "lang/habit_words.def"
    };
    assert_true(COUNT_OF(rows) > 20);
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        for (const char *name = rows[i].names; *name; name += strcspn(name, " "), name += strspn(name, " "))
            if (!library_declares(rows[i].file, name, strcspn(name, " "))) fail_msg("%s: no '%s'", rows[i].file, name);
        for (const char *word = rows[i].words; *word; word += strcspn(word, " "), word += strspn(word, " "))
            if (library_declares(rows[i].file, word, strcspn(word, " ")))
                fail_msg("%s: '%s' is a name", rows[i].file, word);
    }
}

/* The parser, which knows no schema, is told which nodes hold others: those of the table of nodes, and no more. */
static void nodes_that_hold_others(void **state)
{
    (void)state;
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++)
        assert_int_equal(habit_holds_nodes(schema->nodes[i].name), (schema->nodes[i].flags & NODE_CHILDREN) != 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nodes_that_hold_others),          cmocka_unit_test(hints_name_what_there_is),
        cmocka_unit_test(hints_are_for_what_there_is_not), cmocka_unit_test(other_nodes_are_none_here),
        cmocka_unit_test(names_are_unique_and_documented), cmocka_unit_test(defaults_are_in_range),
        cmocka_unit_test(bare_nodes_are_accepted),         cmocka_unit_test(names_of_the_library_are_there),
    };
    return cmocka_run_group_tests_name("nodes", tests, NULL, NULL);
}
