/* options.c - reads a command line by the table of options.
 * --name=value, --name value, -x value, -xvalue, clusters of letters (-qv), and -- before operands that start
 * with a dash. An option given again replaces its value, but for lists, which grow.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/file.h"
#include "base/suggest.h"

typedef struct Parser {
    Options *options;
    char *const *words;
    size_t n_words, next;
    bool stop; /* -h or --help was read */
    Error *error;
} Parser;

/* The option of that name, of the first length bytes; OPTION_COUNT when the command has none. */
static OptionKey find_name(Command command, const char *name, size_t length)
{
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (command_has_option(command, key) && row->name && strlen(row->name) == length &&
            memcmp(row->name, name, length) == 0)
            return key;
    }
    return OPTION_COUNT;
}

static OptionKey find_letter(Command command, char letter)
{
    for (OptionKey key = 0; key < OPTION_COUNT; key++)
        if (command_has_option(command, key) && option_row(key)->letter == letter) return key;
    return OPTION_COUNT;
}

/* What writers of POV-Ray's command lines mean, by the letters behind '+' or '-', of which meniscus-povray(7) has all; and
 * words of other programs. */
static const struct {
    const char *letters, *instead;
} habits[] = {
    {"W", "--size 640x480"},
    {"w", "--size 640x480"},
    {"H", "--size 640x480"},
    {"width", "--size 640x480"},
    {"height", "--size 640x480"},
    {"I", "the scene's name"},
    {"L", "-I FOLDER"},
    {"O", "-o picture.exr"},
    {"F", "-o picture.png"},
    {"WT", "-j 4"},
    {"KF", "--frames 1..120"},
    {"K", "--clock 0.5"},
    {"KC", "animation { cyclic = true } in the scene"},
    {"Q", "-s 32, and more for the last picture"},
    {"quality", "-s 32, and more for the last picture"},
    {"A", "-s 256: more samples smooth edges, too"},
    {"R", "-s 256: more samples smooth edges, too"},
    {"P", "--preview term"},
    {"D", "--preview term"},
    {"C", "--skip-existing by whole frames, --resume from a checkpoint"},
    {"SC", "--crop 10,20,110,120"},
    {"SR", "--crop 10,20,110,120"},
    {"EC", "--crop 10,20,110,120"},
    {"ER", "--crop 10,20,110,120"},
    {"SF", "--frames 10..20"},
    {"EF", "--frames 10..20"},
    {"GA", "-v, and -q for less"},
    {"antialias", "-s 256: more samples smooth edges, too"},
    {"samples", "--spp 32"},
    {"sample", "--spp 32"},
    {"samples-per-pixel", "--spp 32"},
    {"o", "--slice-output level.png"},
    {"out", "--output picture.exr"},
    {"outfile", "--output picture.exr"},
    {"output-file", "--output picture.exr"},
    {"resolution", "--size 640x480"},
    {"res", "--size 640x480"},
    {"region", "--crop 10,20,110,120"},
    {"crop-window", "--crop 10,20,110,120"},
    {"timeout", "--time-limit 10m"},
    {"max-time", "--time-limit 10m"},
    {"bounces", "--set render.bounces=32"},
    {"max-bounces", "--set render.bounces=32"},
    {"depth", "--set render.bounces=32"},
    {"max-depth", "--set render.bounces=32"},
    {"start-frame", "--frames 10..20"},
    {"end-frame", "--frames 10..20"},
    {"frame-start", "--frames 10..20"},
    {"frame-end", "--frames 10..20"},
    {"frame-range", "--frames 10..20"},
    {"f", "--frames 12, or 1..120"},
    {"dry-run", "meniscus check SCENE, which finds all mistakes and renders nothing"},
    {"validate", "meniscus check SCENE, which finds all mistakes and renders nothing"},
    {"depfile", "meniscus check SCENE --files, which lists what a scene reads"},
    {"deps", "meniscus check SCENE --files, which lists what a scene reads"},
    {"video", "--frames all, and another program makes a film of the pictures: ffmpeg -i glass.%04d.png glass.mp4"},
    {"movie", "--frames all, and another program makes a film of the pictures: ffmpeg -i glass.%04d.png glass.mp4"},
    {"dependencies", "meniscus check SCENE --files, which lists what a scene reads"},
    {"M", "meniscus check SCENE --files, which lists what a scene reads"},
    {"MD", "meniscus check SCENE --files, which lists what a scene reads"},
    {"jobs", "-j 4"},
    {"cores", "-j 4"},
    {"output-dir", "-o FOLDER/picture.exr"},
    {"outdir", "-o FOLDER/picture.exr"},
    {"json", "--progress json, --log-format json for messages, and --stats=FILE.json"},
    {"param", "-D NAME=VALUE"},
    {"var", "-D NAME=VALUE"},
    {"Declare", "-D NAME=VALUE"},
    {"aov", "--layer depth"},
    {"depth", "--layer depth"},
    {"channel", "--layer depth"},
    {"channels", "--layer depth"},
};

/* Does the command take the option that a habit is written as? */
static bool takes_habit(Command command, const char *instead)
{
    if (strncmp(instead, "--", 2) == 0)
        return find_name(command, instead + 2, strcspn(instead + 2, " ")) != OPTION_COUNT;
    return *instead != '-' || find_letter(command, instead[1]) != OPTION_COUNT;
}

/* NULL: of no use to them. */
static const char *habit_of(Command command, const char *word)
{
    const char *letters = word + strspn(word, "+-");
    const char *found = NULL;
    size_t most = 0;
    for (size_t i = 0; i < sizeof habits / sizeof *habits; i++) {
        size_t n = strlen(habits[i].letters);
        if (n <= most || strncmp(letters, habits[i].letters, n) != 0 || !takes_habit(command, habits[i].instead))
            continue;
        if (!letters[n] || strchr("=.0123456789", letters[n]) || *word == '+') {
            most = n;
            found = habits[i].instead;
        }
    }
    return found;
}

/* Of n names, the only one that begins with a word of three letters or more; NULL: there is none, or several. */
static const char *only_one_with_start(const char *word, size_t length, const char *const *names, size_t n)
{
    const char *found = NULL;
    for (size_t i = 0; length >= 3 && i < n; i++) {
        if (strncmp(names[i], word, length) != 0) continue;
        if (found) return NULL;
        found = names[i];
    }
    return found;
}

/* An option of another command is named with that command; else the nearest of this one. */
static Status unknown_name(Parser *parser, const char *name, size_t length)
{
    Command command = parser->options->command;
    char wrong[64];
    snprintf(wrong, sizeof wrong, "%.*s", (int)length, name);
    const char *habit = habit_of(command, wrong);
    for (Command other = 0; other < COMMAND_COUNT; other++) {
        OptionKey key = find_name(other, name, length);
        if (other != command && key != OPTION_COUNT && option_row(key)->help && command == COMMAND_HELP)
            return fail(parser->error, STATUS_USAGE, "'help' has no option '--%.*s'; 'meniscus help %.*s' explains it",
                        (int)length, name, (int)length, name);
        if (other != command && key != OPTION_COUNT && option_row(key)->help && !habit)
            return fail(parser->error, STATUS_USAGE, "'%s' has no option '--%.*s'; '%s' has one",
                        command_row(command)->name, (int)length, name, command_row(other)->name);
    }
    const char *names[OPTION_COUNT];
    size_t n = 0;
    for (OptionKey key = 0; key < OPTION_COUNT; key++)
        if (command_has_option(command, key) && option_row(key)->name && option_row(key)->help)
            names[n++] = option_row(key)->name;
    const char *near = suggest_nearest(wrong, names, n);
    if (!near) near = only_one_with_start(wrong, length, names, n);
    if (habit) return fail(parser->error, STATUS_USAGE, "unknown option '--%s'; here it is %s", wrong, habit);
    if (near)
        return fail(parser->error, STATUS_USAGE, "unknown option '--%.*s'; did you mean '--%s'?", (int)length, name,
                    near);
    if (command_has_option(command, OPTION_DEFINE) && !strchr(wrong, '-'))
        return fail(parser->error, STATUS_USAGE,
                    "unknown option '--%.*s'; a parameter of the scene is set by '-D %s=...'", (int)length, name,
                    wrong);
    return fail(parser->error, STATUS_USAGE, "unknown option '--%.*s'", (int)length, name);
}

static bool is_list(OptionKind kind)
{
    return kind == KIND_LIST || kind == KIND_FOLDERS || kind == KIND_DEFINES;
}

/* The item that sets the same name; value->n_items when there is none. */
static size_t find_define(const OptionValue *value, const char *text)
{
    size_t length = strcspn(text, "=") + 1, i = 0;
    while (i < value->n_items && strncmp(value->items[i], text, length) != 0) i++;
    return i;
}

static Status add_item(Parser *parser, OptionKind kind, OptionValue *value, const char *text)
{
    if (!value->items) {
        value->items = malloc(parser->n_words * sizeof *value->items); /* no list has more items than there are words */
        if (!value->items) return fail_memory(parser->error, parser->n_words * sizeof *value->items, "the options");
    }
    size_t place = kind == KIND_DEFINES ? find_define(value, text) : value->n_items;
    value->items[place] = text;
    if (place == value->n_items) value->n_items++;
    return STATUS_OK;
}

/* Stores one option; text is NULL where it takes no value or got none. */
static Status set_option(Parser *parser, OptionKey key, const char *spelled, const char *text)
{
    const OptionRow *row = option_row(key);
    OptionValue *value = &parser->options->values[key];
    if (text) TRY(option_value_read(row, spelled, text, value, parser->error));
    if (!text) value->text = NULL;
    if (is_list(row->kind)) TRY(add_item(parser, row->kind, value, text));
    value->place = (unsigned)parser->next;
    if (key == OPTION_HELP || key == OPTION_SHORT_HELP) parser->stop = true;
    return STATUS_OK;
}

static bool takes_value(const OptionRow *row)
{
    return row->kind != KIND_FLAG && row->kind != KIND_OPTIONAL_FILE;
}

/* The word behind an option is its value, whatever it looks like, as everywhere. */
static Status next_value(Parser *parser, const OptionRow *row, const char *spelled, const char **text)
{
    if (parser->next >= parser->n_words)
        return fail(parser->error, STATUS_USAGE, "option '%s' needs a value: %s, as in: %s", spelled, row->argument,
                    row->example);
    *text = parser->words[parser->next++];
    return STATUS_OK;
}

static Status read_long(Parser *parser, const char *word)
{
    const char *name = word + 2, *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    OptionKey key = find_name(parser->options->command, name, length);
    if (key == OPTION_COUNT) return unknown_name(parser, name, length);
    const OptionRow *row = option_row(key);
    char spelled[64];
    snprintf(spelled, sizeof spelled, "--%s", row->name);
    const char *text = equals ? equals + 1 : NULL;
    if (text && row->kind == KIND_FLAG) return fail(parser->error, STATUS_USAGE, "option '%s' takes no value", spelled);
    if (!text && takes_value(row)) TRY(next_value(parser, row, spelled, &text));
    return set_option(parser, key, spelled, text);
}

static Status read_cluster(Parser *parser, const char *word)
{
    Command command = parser->options->command;
    if (word[2] && find_name(command, word + 1, strlen(word + 1)) != OPTION_COUNT)
        return fail(parser->error, STATUS_USAGE, "unknown option '%s'; did you mean '-%s' (with two dashes)?", word,
                    word);
    const char *habit = habit_of(command, word);
    const bool whole_word = habit && word[2] >= 'a' && word[2] <= 'z'; /* "-samples" is not -s amples */
    for (const char *letter = word + 1; *letter && !parser->stop; letter++) {
        OptionKey key = find_letter(command, *letter);
        if (letter == word + 1 && (key == OPTION_COUNT || whole_word))
            return fail(parser->error, STATUS_USAGE, "unknown option '%s'%s%s", word, habit ? "; here it is " : "",
                        habit ? habit : "");
        if (key == OPTION_COUNT)
            return fail(parser->error, STATUS_USAGE, "unknown option '-%c' in '%s'", *letter, word);
        const OptionRow *row = option_row(key);
        const char spelled[] = {'-', *letter, 0}, *text = NULL;
        if (takes_value(row)) {
            if (letter[1])
                text = letter + (letter[1] == '=' ? 2 : 1);
            else
                TRY(next_value(parser, row, spelled, &text));
        }
        TRY(set_option(parser, key, spelled, text));
        if (text) break;
    }
    return STATUS_OK;
}

/* The option that stands right before that word, with its value; OPTION_COUNT: none. */
static OptionKey option_before(const Parser *parser, const char *word)
{
    size_t at = 0;
    while (at < parser->n_words && parser->words[at] != word) at++;
    for (OptionKey key = 0; at > 0 && key < OPTION_COUNT; key++)
        if (parser->options->values[key].place == at && option_row(key)->kind != KIND_FLAG) return key;
    return OPTION_COUNT;
}

/* A word that stands behind the value of an option, and is no scene, was meant to be of that value. */
static Status refuse_second_value(Parser *parser, const char *word)
{
    OptionKey key = option_before(parser, word);
    if (key == OPTION_COUNT || strcmp(word, "-") == 0 || strcasecmp(file_extension(word), "mns") == 0) return STATUS_OK;
    const OptionRow *row = option_row(key);
    char spelled[64] = {'-', row->letter}; /* as examples have them: -D, but --spp */
    if (!row->letter || !is_list(row->kind)) snprintf(spelled, sizeof spelled, "--%s", row->name);
    if (row->kind == KIND_OPTIONAL_FILE)
        return fail(parser->error, STATUS_USAGE,
                    "'%s' is one word too many: the file of '%s' stands behind '=', as %s=%s", word, spelled, spelled,
                    word);
    if (is_list(row->kind))
        return fail(parser->error, STATUS_USAGE, "'%s' is one word too many: each %s has its own '%s', as %s %s", word,
                    row->argument, spelled, spelled, word);
    return fail(parser->error, STATUS_USAGE, "'%s' is one word too many: '%s' takes one, %s, as in: %s", word, spelled,
                row->argument, row->example);
}

static Status refuse_surplus(Parser *parser, const char *word)
{
    Command command = parser->options->command;
    const CommandRow *row = command_row(command);
    const char *ending = file_extension(word);
    bool picture = strcasecmp(ending, "png") == 0 || strcasecmp(ending, "exr") == 0;
    if (picture && find_name(command, "output", strlen("output")) != OPTION_COUNT)
        return fail(parser->error, STATUS_USAGE,
                    "'%s' is one word too many: what is written stands behind -o, as -o %s", word, word);
    for (size_t i = 0; i < parser->options->n_operands; i++)
        TRY(refuse_second_value(parser, parser->options->operands[i]));
    return fail(parser->error, STATUS_USAGE, "'%s' is one word too many: '%s' takes %s", word, row->name,
                row->most == 0 ? "none" : row->operands);
}

static Status check_operands(Parser *parser)
{
    const Options *options = parser->options;
    const CommandRow *row = command_row(options->command);
    for (size_t i = 0; i < options->n_operands && options->n_operands > row->most; i++)
        if ((*options->operands[i] == '+' || strncmp(options->operands[i], "Declare=", strlen("Declare=")) == 0) &&
            habit_of(options->command, options->operands[i]))
            return fail(parser->error, STATUS_USAGE, "'%s' is POV-Ray's; here it is %s (see meniscus-povray(7))",
                        options->operands[i], habit_of(options->command, options->operands[i]));
    if (options->n_operands > row->most) return refuse_surplus(parser, options->operands[row->most]);
    if (options->n_operands < row->fewest)
        return fail(parser->error, STATUS_USAGE, "'%s' needs %s%s", row->name, row->operands,
                    row->most == 1 && strcmp(row->operands, "SCENE") == 0 ? ": a file, or - for standard input" : "");
    return STATUS_OK;
}

Status options_parse(Options *options, Command command, char *const *words, size_t n_words, Error *error)
{
    *options = (Options){.command = command};
    options->operands = malloc((n_words + 1) * sizeof *options->operands);
    if (!options->operands) return fail_memory(error, (n_words + 1) * sizeof *options->operands, "the operands");
    Parser parser = {.options = options, .words = words, .n_words = n_words, .error = error};
    bool only_operands = false;
    while (parser.next < n_words && !parser.stop) {
        const char *word = words[parser.next++];
        if (only_operands || word[0] != '-' || !word[1])
            options->operands[options->n_operands++] = word;
        else if (strcmp(word, "--") == 0)
            only_operands = true;
        else if (word[1] == '-')
            TRY(read_long(&parser, word));
        else
            TRY(read_cluster(&parser, word));
    }
    options->operands[options->n_operands] = NULL;
    return parser.stop ? STATUS_OK : check_operands(&parser);
}

void options_clear(Options *options)
{
    for (size_t key = 0; key < OPTION_COUNT; key++) free(options->values[key].items);
    free(options->operands);
    *options = (Options){0};
}

bool option_given(const Options *options, OptionKey key)
{
    return options->values[key].place != 0;
}

const char *option_text(const Options *options, OptionKey key, const char *otherwise)
{
    const char *text = options->values[key].text;
    return text ? text : otherwise;
}

bool option_is(const Options *options, OptionKey key, const char *choice)
{
    const char *text = options->values[key].text;
    return text && strcmp(text, choice) == 0;
}
