/* render_watch.c - by looking at the files several times a second, which works on every file system.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/render_watch.h"

#include <string.h>
#include <time.h>

#include "base/file.h"
#include "base/file_reads.h"
#include "cli/signals.h"

static void nap(void)
{
    const struct timespec tenth_of_a_second = {.tv_nsec = 100000000};
    nanosleep(&tenth_of_a_second, NULL);
}

static Status check_options(const Options *options, Error *error)
{
    static const OptionKey of_one_render[] = {OPTION_CHECKPOINT, OPTION_RESUME, OPTION_RESTART, OPTION_SKIP_EXISTING};
    if (strcmp(options->operands[0], "-") == 0)
        return fail(error, STATUS_USAGE, "option '--watch' needs a scene that can change: a file, not standard input");
    for (size_t i = 0; i < COUNT_OF(of_one_render); i++)
        if (option_given(options, of_one_render[i]))
            return fail(error, STATUS_USAGE,
                        "'--watch' renders a scene anew when it changes, and '--%s' is about one that does not",
                        option_row(of_one_render[i])->name);
    return STATUS_OK;
}

static void say_what_is_watched(const Options *options, const Talk *talk)
{
    size_t n = file_count_reads();
    if (talk->quiet) return;
    if (n > 1)
        talk_event(talk, "watching", "watching '%s' and %zu file%s that it reads; Ctrl-C ends this",
                   options->operands[0], n - 1, plural(n - 1));
    else
        talk_event(talk, "watching", "watching '%s'; Ctrl-C ends this", options->operands[0]);
}

/* Until a file is another one, and all that are being written are whole. */
static void wait_for_change(const Options *options, const Talk *talk)
{
    const char *changed;
    while (!(changed = file_find_changed())) nap();
    if (!talk->quiet) talk_event(talk, "changed", "'%s' has changed", changed);
    do nap();
    while (file_renote_reads() || !file_exists(options->operands[0]));
}

Status render_watch(const Options *options, const Talk *talk, RenderOnce *render, Error *error)
{
    TRY(check_options(options, error));
    for (bool first = true;; first = false) {
        file_forget_reads();
        Status status = render(options, talk, error);
        if (*signals_flag() || (first && (status == STATUS_USAGE || file_count_reads() == 0))) return status;
        if (status != STATUS_OK && error->text[0]) talk_error(talk, error);
        error->text[0] = 0;
        if (!file_find_changed()) say_what_is_watched(options, talk);
        wait_for_change(options, talk);
        *signals_stop() = 0;
    }
}

void render_watch_look(void)
{
    if (file_find_changed()) *signals_stop() = 1;
}
