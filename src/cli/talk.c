/* talk.c - messages to people and to programs.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/talk.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define RED "\033[1;31m"
#define MAGENTA "\033[1;35m"
#define BOLD "\033[1m"
#define PLAIN "\033[0m"

bool terminal_is_capable(void)
{
    const char *term = getenv("TERM");
    return isatty(STDERR_FILENO) && term && *term && strcmp(term, "dumb") != 0;
}

unsigned terminal_columns(void)
{
    struct winsize size;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return 80;
}

/* https://no-color.org: set and not empty */
static bool color_is_wanted(void)
{
    const char *no_color = getenv("NO_COLOR");
    return terminal_is_capable() && !(no_color && *no_color);
}

void talk_init(Talk *talk, const Options *options)
{
    *talk = (Talk){.color = color_is_wanted()};
    if (!options) return;
    talk->command = command_row(options->command)->name;
    talk->json = option_is(options, OPTION_LOG_FORMAT, "json");
    talk->quiet = option_given(options, OPTION_QUIET);
    talk->verbose = option_given(options, OPTION_VERBOSE) && !talk->quiet;
    if (option_is(options, OPTION_COLOR, "always")) talk->color = true;
    if (option_is(options, OPTION_COLOR, "never") || talk->json) talk->color = false;
}

/* Progress is shown again and again on one line, which does not count. */
static uint64_t n_lines;

uint64_t talk_lines(void)
{
    return n_lines;
}

void talk_write(const Buf *text)
{
    for (size_t i = 0; i < text->length; i++) n_lines += text->text[i] == '\n';
    fwrite(buf_text(text), 1, text->length, stderr);
    if (text->failed) fputs("\nmeniscus: out of memory for a message\n", stderr);
    fflush(stderr);
}

JsonWriter talk_event_begin(Buf *line, const char *event)
{
    JsonWriter json = json_writer(line, false);
    json_begin_object(&json);
    json_add_text(&json, "event", event);
    return json;
}

void talk_event_end(JsonWriter *json)
{
    json_end(json);
    buf_add(json->out, "\n");
    talk_write(json->out);
    buf_clear(json->out);
}

/* One message. exit_status < 0: the event has none. */
static void say(const Talk *talk, const char *event, const char *color, int exit_status, const char *message)
{
    Buf line = {0};
    if (talk->json) {
        JsonWriter json = talk_event_begin(&line, event);
        if (exit_status >= 0) json_add_whole(&json, "exit", (uint64_t)exit_status);
        json_add_text(&json, "message", message);
        talk_event_end(&json);
        return;
    }
    buf_format(&line, "meniscus%s%s: ", talk->command ? " " : "", talk->command ? talk->command : "");
    if (talk->color) buf_add(&line, color);
    buf_format(&line, "%s:", event);
    if (talk->color) buf_add(&line, PLAIN);
    buf_format(&line, " %s\n", message);
    talk_write(&line);
    buf_clear(&line);
}

void talk_event(const Talk *talk, const char *event, const char *format, ...)
{
    char message[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    if (talk->json) {
        say(talk, event, "", -1, message);
        return;
    }
    Buf line = {0};
    buf_format(&line, "%s\n", message);
    talk_write(&line);
    buf_clear(&line);
}

static void say_formatted(const Talk *talk, const char *event, const char *color, const char *format, va_list args)
    ATTR_PRINTF(4, 0);
static void say_formatted(const Talk *talk, const char *event, const char *color, const char *format, va_list args)
{
    char message[1024];
    vsnprintf(message, sizeof message, format, args);
    say(talk, event, color, -1, message);
}

void talk_error(const Talk *talk, const Error *error)
{
    const char *message = error->text[0] ? error->text : status_text(error->status);
    say(talk, "error", RED, status_exit_code(error->status), message);
}

void talk_hint(const Talk *talk, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say_formatted(talk, "hint", BOLD, format, args);
    va_end(args);
}

void talk_warning(const Talk *talk, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    say_formatted(talk, "warning", MAGENTA, format, args);
    va_end(args);
}

void talk_remark(const Talk *talk, const char *format, ...)
{
    if (talk->quiet) return;
    va_list args;
    va_start(args, format);
    say_formatted(talk, "remark", BOLD, format, args);
    va_end(args);
}

void talk_note(const Talk *talk, const char *format, ...)
{
    if (!talk->verbose) return;
    va_list args;
    va_start(args, format);
    say_formatted(talk, "note", BOLD, format, args);
    va_end(args);
}

Status print_out(const Buf *text, Error *error)
{
    if (text->failed) return fail(error, STATUS_NOMEM, "out of memory for the text");
    if (fwrite(buf_text(text), 1, text->length, stdout) == text->length && fflush(stdout) == 0) return STATUS_OK;
    int reason = errno;
    fail(error, STATUS_OUTPUT, "cannot write to standard output: %s", strerror(reason));
    if (reason == EPIPE) error->text[0] = 0; /* the reader has seen enough: that is no news */
    return STATUS_OUTPUT;
}

const char *plural(uint64_t n)
{
    return n == 1 ? "" : "s";
}

void add_for_shell(Buf *line, const char *path)
{
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=@:,./";
    if (path[strspn(path, plain)] == 0) {
        buf_add(line, path);
        return;
    }
    buf_add(line, "'");
    for (const char *c = path; *c; c++) *c == '\'' ? buf_add(line, "'\\''") : buf_add_bytes(line, c, 1);
    buf_add(line, "'");
}

void seconds_print(double seconds, char text[32])
{
    if (seconds < 59.95) {
        snprintf(text, 32, "%.1f s", seconds);
        return;
    }
    long long whole = llround(fmin(seconds, 1e15));
    if (whole < 3600)
        snprintf(text, 32, "%lldm%02llds", whole / 60, whole % 60);
    else
        snprintf(text, 32, "%lldh%02lldm", whole / 3600, whole / 60 % 60);
}
