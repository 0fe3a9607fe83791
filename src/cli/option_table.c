/* option_table.c - the tables that commands.def and options.def spell out.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "base/attr.h"
#include "cli/options.h"
#include "base/suggest.h"

static const CommandRow command_table[] = {
#define COMMAND(key, name, operands, fewest, most, completes, summary, manual, examples)                               \
    {name, operands, fewest, most, COMPLETES_##completes, summary, manual, examples},
#include "cli/commands.def"
#undef COMMAND
};

#define IN(command) (1U << COMMAND_##command)
#define IN_ALL ((1U << COMMAND_COUNT) - 1)
static const OptionRow option_table[] = {
#define OPTION(key, commands, letter, name, argument, kind, low, high, choices, default_text, group, help, manual,     \
               example)                                                                                                \
    {commands, letter, name, argument, KIND_##kind, low, high, choices, default_text, group, help, manual, example},
#include "cli/options.def"
#undef OPTION
};

const CommandRow *command_row(Command command)
{
    return &command_table[command];
}

const OptionRow *option_row(OptionKey key)
{
    return &option_table[key];
}

bool command_has_option(Command command, OptionKey key)
{
    return (option_table[key].commands >> command & 1) != 0;
}

Command command_named(const char *name)
{
    Command command = 0;
    while (command < COMMAND_COUNT && strcmp(command_table[command].name, name) != 0) command++;
    return command;
}

const char *command_nearest(const char *wrong)
{
    const char *names[COMMAND_COUNT];
    size_t n = 0;
    for (size_t i = 0; i < COMMAND_COUNT; i++)
        if (command_table[i].summary) names[n++] = command_table[i].name;
    return suggest_nearest(wrong, names, n);
}
