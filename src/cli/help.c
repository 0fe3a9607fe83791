/* help.c - -h, --help and the list of commands, from the tables.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/commands.h"

enum { COLUMNS = 80, OPTION_COLUMN = 28, COMMAND_COLUMN = 14, OPTION_INDENT = 6 };

/* ---- text ---- */

static void add_word(Buf *out, const char *word, size_t length)
{
    for (size_t i = 0; i < length; i++) buf_add_bytes(out, word[i] == '`' ? "'" : &word[i], 1);
}

/* Words are divided by blanks, but what stands between two backticks stays together. */
static size_t word_length(const char *text)
{
    size_t n = 0;
    bool within = false;
    while (text[n] && text[n] != '\n' && (within || text[n] != ' ')) {
        if (text[n] == '`') within = !within;
        n++;
    }
    return n;
}

void help_wrap(Buf *out, const char *text, size_t indent, size_t column)
{
    bool line_is_empty = true;
    if (column < indent) {
        buf_add_repeat(out, ' ', indent - column);
        column = indent;
    }
    while (*text) {
        size_t length = word_length(text);
        if (length && !line_is_empty && column + 1 + length > COLUMNS) {
            buf_add(out, "\n");
            buf_add_repeat(out, ' ', indent);
            column = indent;
            line_is_empty = true;
        }
        if (length) {
            if (!line_is_empty) buf_add(out, " ");
            add_word(out, text, length);
            column += length + (line_is_empty ? 0 : 1);
            line_is_empty = false;
        }
        text += length;
        if (*text == '\n') { /* a paragraph */
            buf_add(out, "\n\n");
            buf_add_repeat(out, ' ', indent);
            column = indent;
            line_is_empty = true;
        }
        if (*text) text++;
    }
    buf_add(out, "\n");
}

/* "-o, --output FILE", "    --stats[=FILE.json]" */
static void help_print_spelling(const OptionRow *row, Buf *out)
{
    if (row->letter)
        buf_format(out, "-%c%s", row->letter, row->name ? ", " : "");
    else
        buf_add(out, "    ");
    if (row->name) buf_format(out, "--%s", row->name);
    if (row->kind == KIND_OPTIONAL_FILE)
        buf_format(out, "[=%s]", row->argument);
    else if (row->argument)
        buf_format(out, " %s", row->argument);
}

/* "command  # what it does", one per line */
static void print_examples(const char *examples, Buf *out)
{
    buf_add(out, "\nExamples:\n");
    while (*examples) {
        size_t line = strcspn(examples, "\n");
        const char *comment = strstr(examples, "  # ");
        if (comment && comment < examples + line) {
            buf_format(out, "  %.*s\n      %.*s\n", (int)(comment - examples), examples,
                       (int)(line - (size_t)(comment + 4 - examples)), comment + 4);
        } else {
            buf_format(out, "  %.*s\n", (int)line, examples);
        }
        examples += line + (examples[line] ? 1 : 0);
    }
}

/* ---- one command ---- */

static void print_option_line(const OptionRow *row, Buf *out)
{
    size_t start = out->length;
    buf_add(out, "  ");
    help_print_spelling(row, out);
    size_t column = out->length - start;
    if (column >= OPTION_COLUMN) {
        buf_add(out, "\n");
        column = 0;
    }
    help_wrap(out, row->help, OPTION_COLUMN, column);
}

static void print_option_fully(const OptionRow *row, Buf *out)
{
    buf_add(out, "  ");
    help_print_spelling(row, out);
    buf_add(out, "\n");
    Buf text = {0};
    buf_format(&text, "%c%s.", row->help[0] >= 'a' && row->help[0] <= 'z' ? row->help[0] - 'a' + 'A' : row->help[0],
               row->help + 1);
    if (row->manual) buf_format(&text, " %s", row->manual);
    help_wrap(out, buf_text(&text), OPTION_INDENT, 0);
    buf_clear(&text);
    if (row->default_text && row->kind != KIND_FLAG) {
        buf_format(&text, "Default: %s.", row->default_text);
        help_wrap(out, buf_text(&text), OPTION_INDENT, 0);
        buf_clear(&text);
    }
    if (row->example) {
        buf_add_repeat(out, ' ', OPTION_INDENT);
        buf_format(out, "Example: %s\n", row->example);
    }
}

static void print_options(Command command, bool full, Buf *out)
{
    const char *group = "";
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (!command_has_option(command, key) || !row->help) continue;
        if (strcmp(group, row->group) != 0) buf_format(out, "%s%s:\n", full && *group ? "" : "\n", row->group);
        group = row->group;
        if (full) {
            print_option_fully(row, out);
            buf_add(out, "\n");
        } else {
            print_option_line(row, out);
        }
    }
}

void help_print(Command command, bool full, Buf *out)
{
    const CommandRow *row = command_row(command);
    buf_format(out, "meniscus %s - %s\n\nusage: meniscus %s [options]%s%s\n", row->name, row->summary, row->name,
               *row->operands ? " " : "", row->operands);
    if (full) {
        buf_add(out, "\n");
        help_wrap(out, row->manual, 0, 0);
    }
    print_options(command, full, out);
    print_examples(row->examples, out);
    if (full)
        buf_format(out, "\nManual: meniscus-%s(1)\n", row->name);
    else
        buf_format(out, "\n'meniscus %s --help' says all.\n", row->name);
}

/* "render, check and view" */
static void print_commands_of(OptionKey key, Buf *out)
{
    unsigned n = 0, k = 0;
    for (Command command = 0; command < COMMAND_COUNT; command++)
        n += command_row(command)->summary && command_has_option(command, key);
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        if (!command_row(command)->summary || !command_has_option(command, key)) continue;
        buf_format(out, "%s%s", k == 0 ? "" : k + 1 == n ? " and " : ", ", command_row(command)->name);
        k++;
    }
}

void help_print_option(const char *name, Buf *out)
{
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (!row->help || !row->name || strcmp(row->name, name) != 0) continue;
        if (out->length) buf_add(out, "\n");
        buf_add(out, "As an option of ");
        print_commands_of(key, out);
        buf_add(out, ":\n\n");
        print_option_fully(row, out);
    }
}

void help_print_overview(Buf *out)
{
    buf_add(out, "meniscus - render nested transparent volumes: glass, liquids, ice, bubbles\n\n"
                 "usage: meniscus COMMAND [options] ...\n"
                 "       meniscus SCENE [options]         the same as meniscus render\n\nCommands:\n");
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        const CommandRow *row = command_row(command);
        if (!row->summary) continue;
        buf_format(out, "  %s", row->name);
        help_wrap(out, row->summary, COMMAND_COLUMN, 2 + strlen(row->name));
    }
    buf_add(out, "\nExamples:\n"
                 "  meniscus render glass.mns -o glass.png\n"
                 "  meniscus check glass.mns\n"
                 "  meniscus help render\n");
}

/* ---- for programs ---- */

static const char *kind_name(OptionKind kind)
{
    static const char *const names[] = {
        [KIND_FLAG] = "flag",          [KIND_TEXT] = "text",       [KIND_FILE] = "file",
        [KIND_FOLDER] = "folder",      [KIND_LIST] = "list",       [KIND_OPTIONAL_FILE] = "optional file",
        [KIND_FOLDERS] = "folders",    [KIND_DEFINES] = "defines", [KIND_CHOICE] = "choice",
        [KIND_COUNT] = "whole number", [KIND_NUMBER] = "number",   [KIND_FRACTION] = "fraction",
        [KIND_DURATION] = "duration",  [KIND_SIZE] = "size",       [KIND_CROP] = "crop",
        [KIND_PIXEL] = "pixel",        [KIND_FRAMES] = "frames",   [KIND_SHARD] = "shard",
        [KIND_RANGE] = "range",        [KIND_KELVIN] = "kelvin",
    };
    return names[kind];
}

static void print_option_json(const OptionRow *row, JsonWriter *json)
{
    const char letter[] = {row->letter, 0}, *rest = row->choices;
    char word[64];
    json_begin_object(json);
    json_add_text(json, "name", row->name);
    json_add_text(json, "letter", row->letter ? letter : NULL);
    json_add_text(json, "argument", row->argument);
    json_add_text(json, "kind", kind_name(row->kind));
    json_add_text(json, "group", row->group);
    json_add_text(json, "default", row->default_text);
    json_key(json, "choices");
    json_begin_array(json);
    while (choice_next(&rest, word, sizeof word)) json_text(json, word);
    json_end(json);
    json_add_text(json, "help", row->help);
    json_add_text(json, "manual", row->manual);
    json_add_text(json, "example", row->example);
    json_end(json);
}

static void print_command_json(Command command, JsonWriter *json)
{
    const CommandRow *row = command_row(command);
    json_begin_object(json);
    json_add_text(json, "name", row->name);
    json_add_text(json, "operands", row->operands);
    json_add_text(json, "summary", row->summary);
    json_add_text(json, "manual", row->manual);
    json_key(json, "options");
    json_begin_array(json);
    for (OptionKey key = 0; key < OPTION_COUNT; key++)
        if (command_has_option(command, key) && option_row(key)->help) print_option_json(option_row(key), json);
    json_end(json);
    json_end(json);
}

static const struct {
    int exit_status;
    const char *text;
} exit_statuses[] = {
#define STATUS(name, exit_status, text) {exit_status, text},
#include "base/status.def"
#undef STATUS
};

void help_print_json(Buf *out)
{
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_text(&json, "program", "meniscus");
    json_add_text(&json, "version", MEN_VERSION);
    json_key(&json, "commands");
    json_begin_array(&json);
    for (Command command = 0; command < COMMAND_COUNT; command++)
        if (command_row(command)->summary) print_command_json(command, &json);
    json_end(&json);
    json_key(&json, "exitStatuses");
    json_begin_array(&json);
    for (size_t i = 0; i < COUNT_OF(exit_statuses); i++) {
        json_begin_object(&json);
        json_add_whole(&json, "exit", (uint64_t)exit_statuses[i].exit_status);
        json_add_text(&json, "text", exit_statuses[i].text);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
    buf_add(out, "\n");
}
