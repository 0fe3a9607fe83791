/* cmd_help.c - the commands help and version.
 * SPDX-License-Identifier: Apache-2.0 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/library_doc.h"
#include "cli/reference.h"
#include "base/suggest.h"
#include "geom/rtc.h"
#include "lang/habits.h"
#include "lang/lex.h"
#include "lang/resolve.h"
#include "scene/build.h"
#include "scene/library.h"

/* Subjects that no node, function or option bears the name of. */
static const struct {
    const char *const *words; /* NULL behind the last one */
    const char *text, *page;
} topics[] = {
#define WORDS(...) ((const char *const[]){__VA_ARGS__, NULL})
#define TOPIC(words, text, page) {words, text, page},
#include "cli/topics.def"
#undef TOPIC
#undef WORDS
};

/* Each once: between two that are as near none is the nearest. */
static void add_topic(const char **names, size_t *n, const char *name)
{
    size_t k = 0;
    while (k < *n && strcmp(names[k], name) != 0) k++;
    if (k == *n) names[(*n)++] = name;
}

/* The name of a file of the library without its folder and its ending. */
static const char *bare_name(char bare[64], const char *name)
{
    const char *folder = "std/";
    if (strncmp(name, folder, strlen(folder)) == 0) name += strlen(folder);
    snprintf(bare, 64, "%.*s", (int)strcspn(name, "."), name);
    return bare;
}

static const char *nearest_file(const char *wrong)
{
    enum { MOST = 32 };
    char bare[MOST + 1][64];
    const char *names[MOST];
    size_t n = std_library.n_files < MOST ? std_library.n_files : MOST;
    for (size_t i = 0; i < n; i++) names[i] = bare_name(bare[i], std_library.files[i].name);
    const char *near = suggest_nearest(bare_name(bare[MOST], wrong), names, n);
    for (size_t i = 0; i < n; i++)
        if (near == names[i]) return std_library.files[i].name;
    return NULL;
}

/* Everything that has help, for did-you-mean. */
static const char *nearest_topic(const char *wrong)
{
    const Schema *schema = scene_schema();
    size_t n_props = 0, n_words = 0;
    for (size_t i = 0; i < schema->n_nodes; i++) n_props += schema->nodes[i].n_props;
    for (size_t i = 0; i < COUNT_OF(topics); i++)
        for (const char *const *word = topics[i].words; *word; word++) n_words++;
    const char **names = malloc((COMMAND_COUNT + schema->n_nodes + n_props + OPTION_COUNT + builtin_count() +
                                 schema->n_terms + D_COUNT + TOKEN_COUNT + n_words) *
                                sizeof *names);
    if (!names) return NULL;
    size_t n = 0;
    for (Command command = 0; command < COMMAND_COUNT; command++)
        if (command_row(command)->summary) names[n++] = command_row(command)->name;
    for (size_t i = 0; i < schema->n_nodes; i++) names[n++] = schema->nodes[i].name;
    for (size_t i = 0; i < schema->n_nodes; i++)
        for (size_t p = 0; p < schema->nodes[i].n_props; p++) add_topic(names, &n, schema->nodes[i].props[p].name);
    for (OptionKey key = 0; key < OPTION_COUNT; key++)
        if (option_row(key)->help && option_row(key)->name) add_topic(names, &n, option_row(key)->name);
    for (size_t i = 0; i < builtin_count(); i++) names[n++] = builtin_at(i)->name;
    for (size_t i = 0; i < schema->n_terms; i++) names[n++] = schema->terms[i].name;
    for (DiagCode code = 0; code < D_COUNT; code++) names[n++] = diag_slug(code);
    for (size_t i = 0; keyword_at(i); i++) add_topic(names, &n, keyword_at(i)->word);
    for (size_t i = 0; i < COUNT_OF(topics); i++)
        for (const char *const *word = topics[i].words; *word; word++) add_topic(names, &n, *word);
    const char *near = suggest_nearest(wrong, names, n);
    if (!near) near = nearest_file(wrong);
    free(names);
    return near;
}

/* std, std/glassware, and std/glassware.mns: the text itself */
static void explain_library(const char *topic, Buf *out)
{
    const EvalLibraryFile *file = library_named(topic);
    if (strcmp(topic, "std") == 0)
        library_print_overview(out);
    else if (file && strcmp(topic, file->name) == 0)
        buf_add_bytes(out, file->text, file->length);
    else if (file)
        library_print_file(file, out);
}

/* glassware, as std/glassware */
static void explain_library_file(const char *topic, Buf *out)
{
    Buf whole = {0};
    buf_format(&whole, "std/%s", topic);
    const EvalLibraryFile *file = library_named(buf_text(&whole));
    if (file) library_print_file(file, out);
    buf_clear(&whole);
}

/* The manual explains the language as a whole. */
static void explain_word(const char *topic, Buf *out)
{
    size_t i = 0, k = 0;
    while (keyword_at(i) && strcmp(keyword_at(i)->word, topic) != 0) i++;
    while (k < PREDECLARED_COUNT && strcmp(predeclared_names[k], topic) != 0) k++;
    if (!keyword_at(i) && k == PREDECLARED_COUNT) return;
    if (out->length) buf_add(out, "\nIn the language:\n\n");
    if (keyword_at(i))
        buf_format(out, "%s is a word of the scene language:\n    %s\n", topic, keyword_at(i)->example);
    else
        buf_format(out, "%s is predeclared in the scene language: %s.\n", topic,
                   k < PREDECLARED_X    ? "clock, frame, frames and time are those of an animation's picture"
                   : k < PREDECLARED_PI ? "x, y and z are the axes, <1, 0, 0>, <0, 1, 0> and <0, 0, 1>"
                                        : "the number; angles are in degrees");
    buf_add(out, "\nManual: meniscus-language(5)\n");
}

static int compare_names(const void *left, const void *right)
{
    return strcmp(*(const char *const *)left, *(const char *const *)right);
}

/* The first word of each subject, in order. */
static void list_subjects(Buf *out)
{
    const char *names[COUNT_OF(topics)];
    for (size_t i = 0; i < COUNT_OF(topics); i++) names[i] = topics[i].words[0];
    qsort(names, COUNT_OF(names), sizeof names[0], compare_names);
    Buf list = {0};
    for (size_t i = 0; i < COUNT_OF(names); i++) buf_format(&list, "%s%s", i ? ", " : "", names[i]);
    help_wrap(out, "Subjects that have help, beside commands, options, nodes, properties and functions:", 0, 0);
    buf_add(out, "\n");
    help_wrap(out, buf_text(&list), 2, 0);
    buf_clear(&list);
}

static void explain_subject(const char *topic, Buf *out)
{
    if (strcmp(topic, "subjects") == 0) {
        list_subjects(out);
        return;
    }
    for (size_t i = 0; i < COUNT_OF(topics); i++) {
        const char *const *word = topics[i].words;
        while (*word && strcmp(*word, topic) != 0) word++;
        if (!*word) continue;
        help_wrap(out, topics[i].text, 0, 0);
        buf_format(out, "\nManual: %s\n", topics[i].page);
        return;
    }
}

static Status refuse_property_of(const NodeType *node, const char *property, Error *error)
{
    const char *other = NULL, *advice = habit_advice(node->name, property);
    for (unsigned i = 0; (other = habit_property(node->name, property, i)); i++) {
        size_t length = strcspn(other, " ");
        for (size_t k = 0; k < node->n_props; k++)
            if (strlen(node->props[k].name) == length && strncmp(node->props[k].name, other, length) == 0)
                return fail(error, STATUS_USAGE, "'%s' has no property '%s'; write: %s%s", node->name, property, other,
                            other[length] ? "" : " = ...");
    }
    if (advice) return fail(error, STATUS_USAGE, "'%s' has no property '%s'; %s", node->name, property, advice);
    const char **names = malloc((node->n_props + 1) * sizeof *names);
    size_t n = 0;
    while (names && n < node->n_props) names[n] = node->props[n].name, n++;
    const char *near = suggest_nearest(property, names, n);
    free(names);
    if (near)
        return fail(error, STATUS_USAGE, "'%s' has no property '%s'; did you mean '%s'?", node->name, property, near);
    return fail(error, STATUS_USAGE, "'%s' has no property '%s'; 'meniscus help %s' lists those that it has",
                node->name, property, node->name);
}

/* lathe.profile; *done: it is one, or nearly */
static Status explain_property_of(const char *topic, Buf *out, bool *done, Error *error)
{
    size_t length = strcspn(topic, ".");
    char name[64]; /* of a node: longer ones are none */
    *done = false;
    if (!topic[length] || !topic[length + 1] || length >= sizeof name) return STATUS_OK;
    memcpy(name, topic, length);
    name[length] = 0;
    const NodeType *node = reference_node(name);
    if (!node) return STATUS_OK;
    *done = true;
    if (!reference_print_property_of(node, topic + length + 1, out))
        return refuse_property_of(node, topic + length + 1, error);
    return STATUS_OK;
}

/* What other programs call a property of a node, and what is written here; STATUS_OK: nothing. */
static Status refuse_property(const char *topic, const char *node, Error *error)
{
    const char *property = habit_property_of(node, topic), *advice = habit_advice(node, topic);
    if (property)
        return fail(error, STATUS_USAGE, "there is no help for '%s'; in a %s, write: %s%s", topic, node, property,
                    strchr(property, '=') ? "" : " = ...");
    if (advice && advice != habit_advice("", topic))
        return fail(error, STATUS_USAGE, "there is no help for '%s'; in a %s, %s", topic, node, advice);
    return STATUS_OK;
}

/* The same of all nodes: what cameras share with lights is meant of a camera. */
static Status refuse_properties(const char *topic, Error *error)
{
    const Schema *schema = scene_schema();
    TRY(refuse_property(topic, "camera", error));
    for (size_t i = 0; i < schema->n_nodes; i++) TRY(refuse_property(topic, schema->nodes[i].name, error));
    const char *advice = habit_advice("", topic);
    return advice ? fail(error, STATUS_USAGE, "there is no help for '%s'; %s", topic, advice) : STATUS_OK;
}

/* POV-Ray's words and others', with what is written here; STATUS_OK: it is none of them. */
static Status refuse_word(const char *topic, Error *error)
{
    const char *block = habit_block(topic), *word = habit_word(topic), *node = habit_node(topic);
    if (block) return fail(error, STATUS_USAGE, "'%s' is POV-Ray's, see meniscus-povray(7); %s", topic, block);
    if (node) return fail(error, STATUS_USAGE, "there is no help for '%s'; %s", topic, node);
    if (word) return fail(error, STATUS_USAGE, "there is no help for '%s'; write: %s", topic, word);
    return refuse_properties(topic, error);
}

/* What is nearly the same as something that has help, or is POV-Ray's behind a '#'. */
static Status refuse_near(const char *topic, Error *error)
{
    const char *near = nearest_topic(topic), *directive = habit_directive_pattern(topic);
    if (near) return fail(error, STATUS_USAGE, "there is no help for '%s'; did you mean '%s'?", topic, near);
    if (!directive) return STATUS_OK;
    size_t name = strcspn(directive, "@");
    return fail(error, STATUS_USAGE, "'%s' is POV-Ray's, see meniscus-povray(7); write: %.*s%s%s", topic, (int)name,
                directive, directive[name] ? "NAME" : "", directive[name] ? directive + name + 1 : "");
}

/* A word can be a command and a node (render), a node, a function and an option (noise): then all are explained. Out
 * stays empty where there is nothing of that name. */
static Status explain(const char *topic, Buf *out, Error *error)
{
    Command command = command_named(topic);
    const NodeType *node = reference_node(topic);
    DiagCode code = reference_diagnostic(topic);
    bool done;
    TRY(explain_property_of(topic, out, &done, error));
    if (done) return STATUS_OK;
    if (command != COMMAND_COUNT && command_row(command)->summary) help_print(command, true, out);
    const Builtin *function = builtin_find(topic);
    const TermType *term = reference_term(topic);
    if (node) {
        if (out->length) buf_add(out, "\nIn a scene:\n\n");
        reference_print_node(node, out);
    }
    if ((function || term) && out->length) buf_add(out, "\nAs a function:\n\n");
    if (function) reference_print_function(function, out);
    if (term) reference_print_term(term, out);
    if (reference_is_property(topic)) {
        if (out->length) buf_add(out, "\nAs a property:\n\n");
        reference_print_property(topic, out);
    }
    help_print_option(topic, out);
    if (code != D_COUNT) reference_print_diagnostic(code, out);
    explain_library(topic, out);
    explain_word(topic, out);
    if (out->length == 0) explain_subject(topic, out);
    if (out->length == 0) explain_library_file(topic, out);
    library_print_named(topic, out);
    return STATUS_OK;
}

/* Of several words, as 'rough ice', those that have help each by itself. */
static Status refuse_for_part(const char *topic, Error *error)
{
    Buf found = {0}, word = {0}, text = {0};
    Status status = STATUS_OK;
    for (const char *at = topic; status == STATUS_OK && *at; at += *at == ' ') {
        size_t length = strcspn(at, " ");
        buf_clear(&word);
        buf_clear(&text);
        buf_format(&word, "%.*s", (int)length, at);
        at += length;
        status = explain(buf_text(&word), &text, error);
        if (text.length) buf_format(&found, "%s'%s'", found.length ? " and " : "", buf_text(&word));
    }
    if (status == STATUS_OK && found.length)
        status =
            fail(error, STATUS_USAGE, "there is no help for '%s' as one thing, but for %s", topic, buf_text(&found));
    buf_clear(&found);
    buf_clear(&word);
    buf_clear(&text);
    return status;
}

/* The words of all operands, which may be several in one, with this between them. */
static void join_words(const Options *options, const char *between, Buf *topic)
{
    for (size_t k = 0; k < options->n_operands; k++)
        for (const char *word = options->operands[k]; *word;) {
            size_t blanks = strspn(word, " \t\n"), length = strcspn(word + blanks, " \t\n");
            if (length) buf_format(topic, "%s%.*s", topic->length ? between : "", (int)length, word + blanks);
            word += blanks + length;
        }
}

/* Several words are one topic, however such are joined: double glazing, open mesh, camera fov, std glassware. A hyphen
 * can stand between them as well, tilt-shift, and capitals and apostrophes are of no account. */
static Status explain_words(const Options *options, Buf *out, Error *error)
{
    enum { BLANK, UNDERSCORE, HYPHEN, N_BETWEEN = 5 };
    static const char *const between[N_BETWEEN] = {" ", "_", "-", ".", "/"};
    Buf topic[N_BETWEEN + 1] = {0};
    Status status = STATUS_OK;
    for (size_t i = 0; i < N_BETWEEN; i++) join_words(options, between[i], &topic[i]);
    for (const char *at = buf_text(&topic[UNDERSCORE]); *at; at++) /* Newton's rings */
        if (*at != '\'') buf_format(&topic[N_BETWEEN], "%c", *at == '-' ? '_' : tolower((unsigned char)*at));
    for (size_t i = 0; status == STATUS_OK && !out->length && i < COUNT_OF(topic); i++)
        status = explain(buf_text(&topic[i]), out, error);
    static const size_t refused[] = {UNDERSCORE, HYPHEN, N_BETWEEN, BLANK};
    for (size_t i = 0; status == STATUS_OK && !out->length && i < COUNT_OF(refused); i++)
        status = refuse_word(buf_text(&topic[refused[i]]), error);
    if (status == STATUS_OK && !out->length) status = refuse_for_part(buf_text(&topic[BLANK]), error);
    for (size_t i = 0; status == STATUS_OK && !out->length && i < COUNT_OF(refused); i++)
        status = refuse_near(buf_text(&topic[refused[i]]), error);
    if (status == STATUS_OK && !out->length)
        status = fail(
            error, STATUS_USAGE,
            "there is no help for '%s', only for commands, their options, nodes, properties, functions, words of the "
            "language, subjects (help subjects), and the library (help std); see meniscus(1) for the manual's pages",
            buf_text(&topic[BLANK]));
    for (size_t i = 0; i < COUNT_OF(topic); i++) buf_clear(&topic[i]);
    return status;
}

Status cmd_help(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    Buf out = {0};
    Status status = STATUS_OK;
    if (option_given(options, OPTION_JSON) && options->n_operands)
        status = fail(error, STATUS_USAGE, "'%s' is one word too many: with '--json' help gives all that there is",
                      options->operands[0]);
    else if (option_given(options, OPTION_JSON))
        help_print_json(&out);
    else if (options->n_operands)
        status = explain_words(options, &out, error);
    else
        help_print_overview(&out);
    if (status == STATUS_OK) status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

Status cmd_version(const Options *options, const Talk *talk, Error *error)
{
    (void)options;
    (void)talk;
    Buf out = {0};
    buf_format(&out, "meniscus %s\n%s\n", MEN_VERSION, rtc_library_version());
    Status status = print_out(&out, error);
    buf_clear(&out);
    return status;
}
