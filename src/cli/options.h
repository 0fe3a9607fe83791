/* options.h - the commands and options of the program as tables, and the parser that reads a command line by them.
 * Parsing does no work: it checks the form and range of each value and stores it. What the values mean is the
 * commands' business.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OPTIONS_H
#define MEN_OPTIONS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/status.h"

typedef enum Command {
#define COMMAND(key, name, operands, fewest, most, completes, summary, manual, examples) COMMAND_##key,
#include "cli/commands.def"
#undef COMMAND
    COMMAND_COUNT
} Command;

typedef enum OptionKey {
#define OPTION(key, ...) OPTION_##key,
#include "cli/options.def"
#undef OPTION
    OPTION_COUNT
} OptionKey;

typedef enum OptionKind {
    KIND_FLAG,
    KIND_TEXT,
    KIND_FILE,
    KIND_FOLDER,
    KIND_OPTIONAL_FILE, /* only as --name=FILE; without a value it is a flag */
    KIND_LIST,          /* every value counts, in order */
    KIND_FOLDERS,       /* the same, of folders */
    KIND_DEFINES,       /* the same, of NAME=VALUE; of one name the last one counts */
    KIND_CHOICE,
    KIND_COUNT, /* a whole number */
    KIND_NUMBER,
    KIND_FRACTION, /* 0.5 or 50% */
    KIND_DURATION, /* in seconds */
    KIND_KELVIN,   /* 2700 or 2700K; off: 0 */
    KIND_SIZE,     /* WxH */
    KIND_CROP,     /* X0,Y0,X1,Y1, each in pixels or percent */
    KIND_PIXEL,    /* X,Y */
    KIND_FRAMES,   /* N, A..B, A..B/STEP: whole holds first, last, step; or all: step is 0 */
    KIND_SHARD,    /* I/N */
    KIND_RANGE     /* A..B */
} OptionKind;

/* What the shell offers for operands. */
typedef enum OperandKind {
    COMPLETES_NOTHING,
    COMPLETES_SCENES,
    COMPLETES_IMAGES,
    COMPLETES_FILES,
    COMPLETES_SHELLS,
    COMPLETES_TOPICS
} OperandKind;

typedef struct CommandRow {
    const char *name, *operands;
    size_t fewest, most;
    OperandKind completes;
    const char *summary, *manual, *examples;
} CommandRow;

typedef struct OptionRow {
    unsigned commands; /* bit 1 << COMMAND_... for each */
    char letter;       /* 0: none */
    const char *name;  /* NULL: only the letter */
    const char *argument;
    OptionKind kind;
    double low, high;
    const char *choices, *default_text, *group;
    const char *help; /* NULL: hidden */
    const char *manual, *example;
} OptionRow;

typedef struct OptionValue {
    unsigned place; /* where on the command line it was given last, from 1; 0: not given */
    const char *text;
    double number;
    uint32_t whole[4];
    double parts[4];    /* KIND_CROP: of the picture's sides, where percent are given; else below 0, and whole holds */
    const char **items; /* KIND_LIST, KIND_FOLDERS, KIND_DEFINES; owned, the texts are the command line's */
    size_t n_items;
} OptionValue;

typedef struct Options {
    Command command;
    OptionValue values[OPTION_COUNT];
    const char **operands; /* owned, 0-terminated */
    size_t n_operands;
} Options;

const CommandRow *command_row(Command command);
const OptionRow *option_row(OptionKey key);
bool command_has_option(Command command, OptionKey key);
/* COMMAND_COUNT when no command has that name. */
Command command_named(const char *name);
/* The command nearest to a wrong word, NULL when none is near. */
const char *command_nearest(const char *wrong);

/* Reads the words behind the command's name. STATUS_USAGE names the word that is wrong. Reading stops at -h and
 * --help. The words must live as long as the options. options_clear is due in every case. */
ATTR_NODISCARD Status options_parse(Options *options, Command command, char *const *words, size_t n_words,
                                    Error *error);
void options_clear(Options *options);

bool option_given(const Options *options, OptionKey key);
/* The text of the value given last, else otherwise. */
const char *option_text(const Options *options, OptionKey key, const char *otherwise);
bool option_is(const Options *options, OptionKey key, const char *choice);
/* The pixels that an option of KIND_CROP means of a picture of this size: x0, y0, x1, y1. STATUS_USAGE: they are not within it, or
 * none. */
ATTR_NODISCARD Status option_crop(const Options *options, OptionKey key, uint32_t width, uint32_t height,
                                  uint32_t crop[4], Error *error);

/* Reads one value (option_value.c). spelled: the option as it was typed, for messages. */
ATTR_NODISCARD Status option_value_read(const OptionRow *row, const char *spelled, const char *text, OptionValue *value,
                                        Error *error);
/* The first of the words a|b|c, in a buffer of size bytes; *rest goes on to the next, NULL after the last. */
const char *choice_next(const char **rest, char *word, size_t size);

#endif
