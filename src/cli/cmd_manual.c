/* cmd_manual.c - the hidden command manual: prints a manual page with its generated sections made anew.
 * A section stands between the lines
 *     .\" generated: KIND [ARGUMENT]
 *     .\" end
 * and comes from the tables of commands, options, exit statuses, nodes and diagnostics; all else in a page is
 * written by hand and stays as it is.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/library_doc.h"
#include "cli/mdoc.h"
#include "cli/reference.h"
#include "diag/limits.h"
#include "lang/builtin.h"
#include "lang/habits.h"
#include "scene/build.h"

#define BEGIN_MARK ".\\\" generated: "
#define END_MARK ".\\\" end\n"

/* ---- options ---- */

static void print_item(const OptionRow *row, Buf *out)
{
    buf_add(out, ".It");
    if (row->letter) buf_format(out, " Fl %c%s", row->letter, row->name ? " ," : "");
    if (row->name) buf_format(out, " Fl -%s", row->name);
    if (row->kind == KIND_OPTIONAL_FILE)
        buf_format(out, " Ns Op = Ns Ar %s", row->argument);
    else if (row->argument)
        buf_format(out, " Ar %s", row->argument);
    buf_add(out, "\n");
}

static void print_option(const OptionRow *row, Buf *out)
{
    print_item(row, out);
    mdoc_sentence(out, row->help);
    if (row->manual) mdoc_text(out, row->manual);
    if (row->default_text && row->kind != KIND_FLAG) {
        Buf text = {0};
        buf_format(&text, "Default: %s.", row->default_text);
        buf_add(out, ".br\n");
        mdoc_text(out, buf_text(&text));
        buf_clear(&text);
    }
    if (row->example) mdoc_example(out, row->example, strlen(row->example));
}

static void print_options(Command command, Buf *out)
{
    const char *group = "";
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (!command_has_option(command, key) || !row->help) continue;
        if (strcmp(group, row->group) != 0)
            buf_format(out, "%s.Ss %s\n.Bl -tag -width Ds\n", *group ? ".El\n" : "", row->group);
        group = row->group;
        print_option(row, out);
    }
    buf_add(out, ".El\n");
}

/* ---- commands ---- */

static void print_command_examples(const char *examples, Buf *out)
{
    while (*examples) {
        size_t line = strcspn(examples, "\n"), code = line;
        const char *comment = strstr(examples, "  # ");
        if (comment && comment < examples + line) {
            code = (size_t)(comment - examples);
            Buf text = {0};
            buf_add_bytes(&text, comment + 4, line - code - 4);
            if (text.text && text.length) {
                text.text[0] =
                    (char)(text.text[0] >= 'a' && text.text[0] <= 'z' ? text.text[0] - 'a' + 'A' : text.text[0]);
                buf_add(&text, ":");
                mdoc_text(out, text.text);
            }
            buf_clear(&text);
        }
        mdoc_example(out, examples, code);
        examples += line + (examples[line] ? 1 : 0);
    }
}

static Status print_command(const char *name, Buf *out, Error *error)
{
    Command command = command_named(name);
    if (command == COMMAND_COUNT) return fail(error, STATUS_USAGE, "there is no command '%s'", name);
    const CommandRow *row = command_row(command);
    buf_format(out, ".Sh NAME\n.Nm meniscus-%s\n.Nd ", row->name);
    mdoc_escape(out, row->summary, strlen(row->summary), true);
    buf_format(out, "\n.Sh SYNOPSIS\n.Nm meniscus %s\n.Op options\n", row->name);
    const char *operands = row->operands;
    while (*operands) { /* A B, [TOPIC] */
        size_t length = strcspn(operands, " ");
        if (*operands == '[')
            buf_format(out, ".Op Ar %.*s\n", (int)length - 2, operands + 1);
        else
            buf_format(out, ".Ar %.*s\n", (int)length, operands);
        operands += length + (operands[length] ? 1 : 0);
    }
    buf_add(out, ".Sh DESCRIPTION\n");
    mdoc_text(out, row->manual);
    buf_add(out, ".Sh OPTIONS\n");
    print_options(command, out);
    return STATUS_OK;
}

static Status print_examples_of(const char *name, Buf *out, Error *error)
{
    Command command = command_named(name);
    if (command == COMMAND_COUNT) return fail(error, STATUS_USAGE, "there is no command '%s'", name);
    buf_add(out, ".Sh EXAMPLES\n");
    print_command_examples(command_row(command)->examples, out);
    return STATUS_OK;
}

static void print_command_list(Buf *out)
{
    buf_add(out, ".Bl -tag -width Ds\n");
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        const CommandRow *row = command_row(command);
        if (!row->summary) continue;
        buf_format(out, ".It Xr meniscus-%s 1\n", row->name);
        mdoc_sentence(out, row->summary);
    }
    buf_add(out, ".El\n");
}

static void print_exit_statuses(Buf *out)
{
    static const struct {
        int exit_status;
        const char *text;
    } rows[] = {
#define STATUS(name, exit_status, text) {exit_status, text},
#include "base/status.def"
#undef STATUS
    };
    buf_add(out, ".Bl -tag -width Ds -compact\n");
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        bool same = i > 0 && rows[i].exit_status == rows[i - 1].exit_status;
        if (!same) buf_format(out, ".It %d\n", rows[i].exit_status);
        mdoc_sentence(out, rows[i].text);
    }
    buf_add(out, ".El\n");
}

/* ---- the language ---- */

static void print_node_flags(const NodeType *node, Buf *out)
{
    if (node->flags & NODE_NAMED) buf_add(out, "It needs a name to be used by.\n");
    if (node->flags & NODE_SINGLE)
        buf_add(out, "Settings, once in a file; a later one adds to and overrides an earlier one.\n");
    if (node->flags & NODE_TRANSFORMS) buf_add(out, "It can be transformed.\n");
    if (node->flags & NODE_CHILDREN) buf_add(out, "It holds other nodes.\n");
}

static void print_property(const PropType *type, Buf *out)
{
    Buf text = {0};
    buf_format(out, ".It Va %s\n", type->name);
    mdoc_sentence(out, type->doc);
    reference_print_type(type, &text);
    buf_format(out, ".br\nType: ");
    mdoc_escape(out, buf_text(&text), text.length, false);
    if (type->flags & PROP_REQUIRED) buf_add(out, "; required");
    buf_add(out, ".\n");
    if (type->default_text) {
        buf_add(out, "Default: ");
        mdoc_escape(out, type->default_text, strlen(type->default_text), true);
        buf_add(out, ".\n");
    }
    buf_clear(&text);
}

static void print_nodes(Buf *out)
{
    const Schema *schema = scene_schema();
    for (size_t i = 0; i < schema->n_nodes; i++) {
        const NodeType *node = &schema->nodes[i];
        buf_format(out, ".Ss %s\n", node->name);
        mdoc_sentence(out, node->doc);
        print_node_flags(node, out);
        if (node->n_props) buf_add(out, ".Bl -tag -width Ds\n");
        for (size_t j = 0; j < node->n_props; j++) print_property(&node->props[j], out);
        if (node->n_props) buf_add(out, ".El\n");
    }
}

static void print_terms(Buf *out)
{
    const Schema *schema = scene_schema();
    buf_add(out, ".Bl -tag -width Ds\n");
    for (size_t i = 0; i < schema->n_terms; i++) {
        const TermType *term = &schema->terms[i];
        buf_format(out, ".It Fn %s\n", term->name);
        mdoc_sentence(out, term->doc);
        if (term->flags & TERM_TABLE)
            buf_add(out, "It takes a list of vectors of 2, or the name of a file.\n");
        else if (term->min_args == term->max_args)
            buf_format(out, "It takes %u number%s.\n", term->min_args, term->min_args == 1 ? "" : "s");
        else
            buf_format(out, "It takes %u to %u numbers.\n", term->min_args, term->max_args);
        if (term->flags & TERM_SCALES) buf_add(out, "A number can multiply it or divide it.\n");
    }
    buf_add(out, ".El\n");
}

/* A doc can begin with the call, "mix(a, b, t): ...": then the arguments go to the name. */
static void print_function(const Builtin *builtin, Buf *out)
{
    const char *doc = builtin->doc;
    size_t length = strlen(builtin->name), n = length + 1;
    buf_format(out, ".It Fn %s", builtin->name);
    if (strncmp(doc, builtin->name, length) == 0 && doc[length] == '(') {
        n += strspn(doc + n, "abcdefghijklmnopqrstuvwxyz., ");
        if (doc[n] == ')' && doc[n + 1] == ':') {
            const char *argument = doc + length + 1, *end = doc + n;
            while (argument < end) {
                size_t size = strcspn(argument, ",)");
                buf_format(out, " \"%.*s\"", (int)size, argument);
                argument += size + 1 + strspn(argument + size + 1, " ");
            }
            doc = end + 2 + strspn(end + 2, " ");
        }
    }
    Buf text = {0};
    buf_format(&text, "%s.", doc);
    buf_add(out, "\n");
    mdoc_text(out, buf_text(&text));
    buf_clear(&text);
}

static void print_functions(Buf *out)
{
    buf_add(out, ".Bl -tag -width Ds\n");
    for (size_t i = 0; i < builtin_count(); i++) print_function(builtin_at(i), out);
    buf_add(out, ".El\n");
}

static void print_aovs(Buf *out)
{
    buf_add(out, ".Bl -tag -width Ds\n");
    for (Aov aov = 0; aov < AOV_COUNT; aov++) {
        Buf text = {0};
        const char *channels = aov_channels(aov);
        size_t length = strlen(channels);
        buf_format(out, ".It Li %s\n", aov_name(aov));
        mdoc_sentence(out, aov_doc(aov));
        buf_add(&text, "Channels: ");
        for (size_t i = 0; i < length; i++) buf_add_bytes(&text, channels[i] == '|' ? " " : channels + i, 1);
        buf_add(&text, ".");
        mdoc_text(out, buf_text(&text));
        buf_clear(&text);
    }
    buf_add(out, ".El\n");
}

static void print_diagnostics(DiagSeverity severity, Buf *out)
{
    buf_add(out, ".Bl -tag -width Ds\n");
    for (DiagCode code = 0; code < D_COUNT; code++) {
        if (diag_severity(code) != severity) continue;
        buf_format(out, ".It Li %s\n", diag_slug(code));
        mdoc_text(out, diag_cause(code));
        mdoc_text(out, diag_cure(code));
    }
    buf_add(out, ".El\n");
}

static int compare_habits(const void *left, const void *right)
{
    const HabitRow *a = left, *b = right;
    return strcmp(a->words, b->words);
}

/* What messages say of POV-Ray's blocks. */
static Status print_habits(Buf *out, Error *error)
{
    size_t n;
    const HabitRow *blocks = habit_blocks(&n);
    HabitRow *sorted = malloc(n * sizeof *sorted);
    if (!sorted) return fail_memory(error, n * sizeof *sorted, "words of POV-Ray");
    memcpy(sorted, blocks, n * sizeof *sorted);
    qsort(sorted, n, sizeof *sorted, compare_habits);
    buf_add(out, ".Bl -tag -width Ds -compact\n");
    for (size_t i = 0; i < n; i++) {
        buf_format(out, ".It Li %s\n", sorted[i].words);
        mdoc_sentence(out, sorted[i].text);
    }
    buf_add(out, ".El\n");
    free(sorted);
    return STATUS_OK;
}

static void print_limits(Buf *out)
{
    buf_add(out, ".Bl -column \"1073741824\" \"elements\"\n");
    for (Limit limit = 0; limit < LIMIT_COUNT; limit++) {
        const LimitRow *row = limit_row(limit);
        buf_format(out, ".It %.0f Ta ", row->number);
        mdoc_escape(out, row->what, strlen(row->what), true);
        buf_add(out, "\n");
    }
    buf_add(out, ".El\n");
}

/* ---- pages ---- */

static Status print_section(const char *kind, Buf *out, Error *error)
{
    static const char command[] = "command ", examples[] = "examples ";
    if (strncmp(kind, command, sizeof command - 1) == 0) return print_command(kind + sizeof command - 1, out, error);
    if (strncmp(kind, examples, sizeof examples - 1) == 0)
        return print_examples_of(kind + sizeof examples - 1, out, error);
    if (strcmp(kind, "habits") == 0) return print_habits(out, error);
    if (strcmp(kind, "commands") == 0)
        print_command_list(out);
    else if (strcmp(kind, "exit statuses") == 0)
        print_exit_statuses(out);
    else if (strcmp(kind, "nodes") == 0)
        print_nodes(out);
    else if (strcmp(kind, "terms") == 0)
        print_terms(out);
    else if (strcmp(kind, "functions") == 0)
        print_functions(out);
    else if (strcmp(kind, "library") == 0)
        library_print_manual(out);
    else if (strcmp(kind, "aovs") == 0)
        print_aovs(out);
    else if (strcmp(kind, "limits") == 0)
        print_limits(out);
    else if (strcmp(kind, "errors") == 0)
        print_diagnostics(DIAG_ERROR, out);
    else if (strcmp(kind, "warnings") == 0)
        print_diagnostics(DIAG_WARNING, out);
    else if (strcmp(kind, "remarks") == 0)
        print_diagnostics(DIAG_REMARK, out);
    else
        return fail(error, STATUS_USAGE, "there is no generated section '%s'", kind);
    return STATUS_OK;
}

static Status renew(const char *page, Buf *out, Error *error)
{
    const char *mark;
    while ((mark = strstr(page, BEGIN_MARK))) {
        const char *kind = mark + sizeof BEGIN_MARK - 1, *line_end = strchr(kind, '\n');
        const char *end = line_end ? strstr(line_end, END_MARK) : NULL;
        if (!end) return fail(error, STATUS_INPUT, "a generated section has no end");
        char name[64] = "";
        size_t length = (size_t)(line_end - kind);
        if (length < sizeof name) memcpy(name, kind, length);
        buf_add_bytes(out, page, (size_t)(line_end + 1 - page));
        TRY(print_section(name, out, error));
        page = end;
        buf_add_bytes(out, page, sizeof END_MARK - 1);
        page += sizeof END_MARK - 1;
    }
    buf_add(out, page);
    return STATUS_OK;
}

Status cmd_manual(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    char *page = NULL;
    size_t length;
    Buf out = {0};
    TRY(file_read(options->operands[0], 0, &page, &length, error));
    Status status = renew(page, &out, error);
    if (status == STATUS_OK) status = print_out(&out, error);
    buf_clear(&out);
    free(page);
    return status;
}
