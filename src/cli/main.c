/* main.c - finds the command, runs it, and turns what became of it into an exit status.
 * SPDX-License-Identifier: Apache-2.0 */
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/scene_input.h"
#include "cli/signals.h"

static Status (*const command_functions[])(const Options *options, const Talk *talk, Error *error) = {
    [COMMAND_RENDER] = cmd_render,   [COMMAND_CHECK] = cmd_check,   [COMMAND_FMT] = cmd_fmt,
    [COMMAND_DUMP] = cmd_dump,       [COMMAND_PARAMS] = cmd_params, [COMMAND_BENCH] = cmd_bench,
    [COMMAND_MERGE] = cmd_merge,     [COMMAND_VIEW] = cmd_view,     [COMMAND_COMPARE] = cmd_compare,
    [COMMAND_INFO] = cmd_info,       [COMMAND_IMPORT] = cmd_import, [COMMAND_COMPLETION] = cmd_completion,
    [COMMAND_HELP] = cmd_help,       [COMMAND_MANUAL] = cmd_manual, [COMMAND_EDITOR] = cmd_editor,
    [COMMAND_VERSION] = cmd_version,
};

static Status print_help(Command command, bool full, Error *error)
{
    Buf out = {0};
    help_print(command, full, &out);
    Status status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

/* On standard output, or on standard error where it stands for an error. */
static Status print_overview(Status status, Error *error)
{
    Buf out = {0};
    help_print_overview(&out);
    if (status == STATUS_OK)
        status = print_out(&out, error);
    else
        talk_write(&out);
    buf_clear(&out);
    return status;
}

static Status run(Command command, char *const *words, size_t n_words, Talk *talk, Error *error)
{
    Options options;
    Status status = options_parse(&options, command, words, n_words, error);
    talk_init(talk, &options);
    bool full = option_given(&options, OPTION_HELP), help = full || option_given(&options, OPTION_SHORT_HELP);
    if (status != STATUS_OK && !talk->json) {
        talk_error(talk, error);
        talk_hint(talk, "'meniscus %s -h' lists the options", command_row(command)->name);
        error->text[0] = 0;
    } else if (status == STATUS_OK && help) {
        status = command_row(command)->summary ? print_help(command, full, error) : print_overview(STATUS_OK, error);
    } else if (status == STATUS_OK) {
        status = command_functions[command](&options, talk, error);
    }
    if (status != STATUS_OK && error->text[0]) talk_error(talk, error);
    options_clear(&options);
    return status;
}

/* "glass.mns" and "-" are scenes; so are options before a scene. */
static bool looks_like_scene(const char *word)
{
    return word[0] == '-' || strchr(word, '.') || strchr(word, '/');
}

static Status unknown_command(const char *word, const Talk *talk, Error *error)
{
    const char *near = command_nearest(word);
    Status status = fail(error, STATUS_USAGE, "unknown command '%s'%s%s%s", word, near ? "; did you mean '" : "",
                         near ? near : "", near ? "'?" : "");
    talk_error(talk, error);
    char scene[SCENE_PATH_SIZE];
    if (scene_with_ending(word, scene)) talk_hint(talk, "to render '%s', write its whole name", scene);
    if (file_exists(word)) talk_hint(talk, "to render the file of that name, write 'meniscus render %s'", word);
    talk_hint(talk, "'meniscus help' lists the commands");
    return status;
}

static Status run_overview(const Talk *talk)
{
    Error error = {0};
    Status status = print_overview(STATUS_OK, &error);
    if (error.text[0]) talk_error(talk, &error);
    return status;
}

static Status dispatch(int argc, char **argv)
{
    Talk talk;
    Error error = {0};
    talk_init(&talk, NULL);
    if (argc < 2) return print_overview(STATUS_USAGE, &error);
    const char *word = argv[1];
    char *const *rest = argv + 2;
    size_t n_rest = (size_t)argc - 2;
    if (strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0) return run_overview(&talk);
    if (strcmp(word, "--version") == 0) return run(COMMAND_VERSION, rest, n_rest, &talk, &error);
    Command command = command_named(word);
    if (command != COMMAND_COUNT) return run(command, rest, n_rest, &talk, &error);
    if (looks_like_scene(word)) return run(COMMAND_RENDER, argv + 1, n_rest + 1, &talk, &error);
    return unknown_command(word, &talk, &error);
}

/* A standard stream that is closed would leave its number to the next file that is opened, and messages would end in a
 * picture. What stands there instead cannot be read or written either. */
static void occupy_closed_streams(void)
{
    for (int stream = STDIN_FILENO; stream <= STDERR_FILENO; stream++)
        if (fcntl(stream, F_GETFD) < 0 && open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
}

int main(int argc, char **argv)
{
    occupy_closed_streams();
    /* A closed pipe, or a file beyond a limit, is an output that cannot be written, and not a reason to lose the others. */
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigaction(SIGPIPE, &ignore, NULL);
#ifdef SIGXFSZ
    sigaction(SIGXFSZ, &ignore, NULL);
#endif
    Status status = dispatch(argc, argv);
    signals_raise_again();
    return status_exit_code(status);
}
