/* completion.c - the command completion: scripts for bash, zsh and fish, from the tables.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/commands.h"

static bool is_shown(Command command, OptionKey key)
{
    return command_has_option(command, key) && option_row(key)->help;
}

static bool takes_folder(const OptionRow *row)
{
    return row->kind == KIND_FOLDER || row->kind == KIND_FOLDERS;
}

static bool takes_file(const OptionRow *row)
{
    return row->kind == KIND_FILE || row->kind == KIND_OPTIONAL_FILE || row->kind == KIND_LIST;
}

static const char *operand_words(Command command)
{
    if (command_row(command)->completes == COMPLETES_SHELLS) return "bash zsh fish";
    return NULL;
}

/* a|b|c as a b c */
static void add_choices(const char *choices, Buf *out)
{
    for (; *choices; choices++) buf_add_bytes(out, *choices == '|' ? " " : choices, 1);
}

static void add_commands(Buf *out)
{
    const char *gap = "";
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        if (!command_row(command)->summary) continue;
        buf_format(out, "%s%s", gap, command_row(command)->name);
        gap = " ";
    }
}

/* ---- bash ---- */

static void add_bash_values(Command command, Buf *out)
{
    const char *name = command_row(command)->name;
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (!is_shown(command, key) || row->kind == KIND_FLAG || row->kind == KIND_OPTIONAL_FILE) continue;
        buf_add(out, "    ");
        if (row->letter) buf_format(out, "%s:-%c|", name, row->letter);
        buf_format(out, "%s:--%s) ", name, row->name);
        if (row->choices) {
            buf_add(out, "COMPREPLY=($(compgen -W '");
            add_choices(row->choices, out);
            buf_add(out, "' -- \"$current\")); ");
        } else if (takes_folder(row)) {
            buf_add(out, "COMPREPLY=($(compgen -d -- \"$current\")); ");
        } else if (takes_file(row)) {
            buf_add(out, "COMPREPLY=($(compgen -f -- \"$current\")); ");
        }
        buf_add(out, "return ;;\n");
    }
}

static void add_bash_options(Command command, Buf *out)
{
    buf_format(out, "    %s) words='", command_row(command)->name);
    const char *gap = "";
    for (OptionKey key = 0; key < OPTION_COUNT; key++) {
        const OptionRow *row = option_row(key);
        if (!is_shown(command, key)) continue;
        if (row->letter) buf_format(out, "%s-%c", gap, row->letter);
        if (row->letter) gap = " ";
        if (row->name) buf_format(out, "%s--%s", gap, row->name);
        gap = " ";
    }
    buf_add(out, "'");
    if (operand_words(command)) buf_format(out, " operands='%s'", operand_words(command));
    buf_add(out, " ;;\n");
}

static void print_bash(Buf *out)
{
    buf_add(out, "# bash completion for meniscus; made by `meniscus completion bash`\n"
                 "_meniscus() {\n"
                 "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]}\n"
                 "    local command=${COMP_WORDS[1]} words='' operands=''\n"
                 "    COMPREPLY=()\n"
                 "    # --name=value arrives as three words\n"
                 "    if [[ $current == '=' ]]; then\n"
                 "        current=''\n"
                 "    elif [[ $previous == '=' && COMP_CWORD -gt 2 ]]; then\n"
                 "        previous=${COMP_WORDS[COMP_CWORD-2]}\n"
                 "    fi\n"
                 "    if [[ COMP_CWORD -eq 1 && $current != -* ]]; then\n"
                 "        COMPREPLY=($(compgen -W '");
    add_commands(out);
    buf_add(out, "' -- \"$current\") $(compgen -f -- \"$current\"))\n"
                 "        return\n"
                 "    fi\n"
                 "    case $command in\n"
                 "    *[./]*|-*) command=render ;;\n"
                 "    esac\n"
                 "    case $command:$previous in\n");
    for (Command command = 0; command < COMMAND_COUNT; command++)
        if (command_row(command)->summary) add_bash_values(command, out);
    buf_add(out, "    esac\n"
                 "    case $command in\n");
    for (Command command = 0; command < COMMAND_COUNT; command++)
        if (command_row(command)->summary) add_bash_options(command, out);
    buf_add(out, "    esac\n"
                 "    if [[ $current == -* ]]; then\n"
                 "        COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
                 "    elif [[ -n $operands ]]; then\n"
                 "        COMPREPLY=($(compgen -W \"$operands\" -- \"$current\"))\n"
                 "    fi\n"
                 "}\n"
                 "complete -o default -F _meniscus meniscus\n");
}

/* ---- zsh ---- */

/* Text within '...[...]': brackets, colons and quotes mean something there. */
static void add_zsh_text(const char *text, Buf *out)
{
    for (; *text; text++) {
        if (*text == '\'')
            buf_add(out, "'\\''");
        else if (strchr("[]:\\", *text))
            buf_format(out, "\\%c", *text);
        else
            buf_add_bytes(out, text, 1);
    }
}

static void add_zsh_value(const OptionRow *row, Buf *out)
{
    if (row->kind == KIND_FLAG) return;
    buf_add(out, row->kind == KIND_OPTIONAL_FILE ? "::" : ":");
    add_zsh_text(row->argument, out);
    buf_add(out, ":");
    if (row->choices) {
        buf_add(out, "(");
        add_choices(row->choices, out);
        buf_add(out, ")");
    } else if (takes_folder(row)) {
        buf_add(out, "_files -/");
    } else if (takes_file(row)) {
        buf_add(out, "_files");
    }
}

static void add_zsh_option(const OptionRow *row, Buf *out)
{
    if (row->letter) {
        buf_format(out, "      '*-%c%s[", row->letter, row->kind == KIND_FLAG ? "" : "+");
        add_zsh_text(row->help, out);
        buf_add(out, "]");
        add_zsh_value(row, out);
        buf_add(out, "' \\\n");
    }
    if (row->name) {
        buf_format(out, "      '*--%s%s[", row->name,
                   row->kind == KIND_FLAG            ? ""
                   : row->kind == KIND_OPTIONAL_FILE ? "=-"
                                                     : "=");
        add_zsh_text(row->help, out);
        buf_add(out, "]");
        add_zsh_value(row, out);
        buf_add(out, "' \\\n");
    }
}

static void print_zsh(Buf *out)
{
    buf_add(out, "#compdef meniscus\n"
                 "# zsh completion for meniscus; made by `meniscus completion zsh`\n"
                 "_meniscus() {\n"
                 "  local -a commands\n"
                 "  commands=(\n");
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        const CommandRow *row = command_row(command);
        if (!row->summary) continue;
        buf_format(out, "    '%s:", row->name);
        add_zsh_text(row->summary, out);
        buf_add(out, "'\n");
    }
    buf_add(out, "  )\n"
                 "  if (( CURRENT == 2 )) && [[ $words[2] != -* ]]; then\n"
                 "    _describe command commands\n"
                 "    _files\n"
                 "    return\n"
                 "  fi\n"
                 "  local command=$words[2]\n"
                 "  case $command in\n"
                 "    *[./]*|-*) command=render ;;\n"
                 "    *) shift words; (( CURRENT-- )) ;;\n"
                 "  esac\n"
                 "  case $command in\n");
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        if (!command_row(command)->summary) continue;
        buf_format(out, "    %s)\n      _arguments -s \\\n", command_row(command)->name);
        for (OptionKey key = 0; key < OPTION_COUNT; key++)
            if (is_shown(command, key)) add_zsh_option(option_row(key), out);
        if (operand_words(command))
            buf_format(out, "      '*:operand:(%s)' ;;\n", operand_words(command));
        else
            buf_add(out, "      '*:operand:_files' ;;\n");
    }
    buf_add(out, "  esac\n"
                 "}\n"
                 "if [[ $zsh_eval_context[-1] == loadautofunc ]]; then\n"
                 "  _meniscus \"$@\"\n"
                 "else\n"
                 "  compdef _meniscus meniscus\n"
                 "fi\n");
}

/* ---- fish ---- */

static void add_fish_text(const char *text, Buf *out)
{
    buf_add(out, "'");
    for (; *text; text++) {
        if (*text == '\'' || *text == '\\') buf_add(out, "\\");
        buf_add_bytes(out, text, 1);
    }
    buf_add(out, "'");
}

static void add_fish_option(Command command, const OptionRow *row, Buf *out)
{
    buf_format(out, "complete -c meniscus -n '__fish_seen_subcommand_from %s'", command_row(command)->name);
    if (row->letter) buf_format(out, " -s %c", row->letter);
    if (row->name) buf_format(out, " -l %s", row->name);
    if (row->choices) {
        buf_add(out, " -x -a '");
        add_choices(row->choices, out);
        buf_add(out, "'");
    } else if (takes_folder(row)) {
        buf_add(out, " -x -a '(__fish_complete_directories)'");
    } else if (takes_file(row)) {
        buf_add(out, row->kind == KIND_OPTIONAL_FILE ? "" : " -r -F");
    } else if (row->kind != KIND_FLAG) {
        buf_add(out, " -x");
    }
    buf_add(out, " -d ");
    add_fish_text(row->help, out);
    buf_add(out, "\n");
}

static void print_fish(Buf *out)
{
    buf_add(out, "# fish completion for meniscus; made by `meniscus completion fish`\n");
    for (Command command = 0; command < COMMAND_COUNT; command++) {
        const CommandRow *row = command_row(command);
        if (!row->summary) continue;
        buf_format(out, "complete -c meniscus -n __fish_use_subcommand -a %s -d ", row->name);
        add_fish_text(row->summary, out);
        buf_add(out, "\n");
        for (OptionKey key = 0; key < OPTION_COUNT; key++)
            if (is_shown(command, key)) add_fish_option(command, option_row(key), out);
        if (operand_words(command))
            buf_format(out, "complete -c meniscus -n '__fish_seen_subcommand_from %s' -f -a '%s'\n", row->name,
                       operand_words(command));
    }
}

/* The completion script of a shell ("bash", "zsh", "fish"); false for another word. */
static bool completion_print(const char *shell, Buf *out)
{
    static const struct {
        const char *name;
        void (*print)(Buf *out);
    } shells[] = {{"bash", print_bash}, {"zsh", print_zsh}, {"fish", print_fish}};
    for (size_t i = 0; i < COUNT_OF(shells); i++)
        if (strcmp(shells[i].name, shell) == 0) {
            shells[i].print(out);
            return true;
        }
    return false;
}

Status cmd_completion(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    const char *shell = options->operands[0];
    Buf out = {0};
    Status status =
        completion_print(shell, &out)
            ? print_out(&out, error)
            : fail(error, STATUS_USAGE, "there is no completion for '%s', only for bash, zsh and fish", shell);
    buf_clear(&out);
    return status;
}
