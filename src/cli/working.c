/* working.c - a line on the terminal, in a log, or as JSON.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/working.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>

#include "base/clock.h"
#include "cli/signals.h"

/* When the first word is said, and how long it takes to the next: on a terminal, and in logs, which are to stay short. */
static const double first_s = 1, interval_s = 1, first_line_s = 5, line_interval_s = 60;

static void say(Working *working)
{
    double seconds = clock_now_s() - working->begin_s;
    char time[32];
    Buf line = {0};
    seconds_print(seconds, time);
    if (working->form == PROGRESS_JSON) {
        JsonWriter json = talk_event_begin(&line, "building");
        json_add_text(&json, "what", working->what);
        json_add_number(&json, "seconds", seconds);
        talk_event_end(&json);
        return;
    }
    if (working->form == PROGRESS_BAR) {
        Buf words = {0};
        buf_format(&words, "%s, for %.0f s", working->what, seconds);
        buf_format(&line, TO_LINE_START "%.*s" CLEAR_TO_LINE_END, (int)terminal_columns() - 1, buf_text(&words));
        buf_clear(&words);
        working->shown = true;
    } else {
        buf_format(&line, "Progress: %s, for %s\n", working->what, time);
    }
    talk_write(&line);
    buf_clear(&line);
}

static void *watch(void *context)
{
    Working *working = context;
    const bool bar = working->form == PROGRESS_BAR;
    double wait_s = bar ? first_s : first_line_s;
    pthread_mutex_lock(&working->lock);
    while (!working->ended) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        double at = (double)until.tv_nsec * 1e-9 + wait_s, whole = floor(at);
        until.tv_sec += (time_t)whole;
        until.tv_nsec = (long)((at - whole) * 1e9);
        if (pthread_cond_timedwait(&working->end, &working->lock, &until) != ETIMEDOUT) continue;
        if (!*signals_flag()) say(working); /* nothing is drawn over what the signal handler says */
        wait_s = bar ? interval_s : line_interval_s;
    }
    pthread_mutex_unlock(&working->lock);
    return NULL;
}

void working_begin(Working *working, ProgressForm form, const char *what)
{
    *working = (Working){.form = form, .begin_s = clock_now_s()};
    snprintf(working->what, WORKING_WHAT_SIZE, "%s", what);
    if (form == PROGRESS_NONE || pthread_mutex_init(&working->lock, NULL) != 0) return;
    if (pthread_cond_init(&working->end, NULL) == 0) {
        working->watches = pthread_create(&working->thread, NULL, watch, working) == 0;
        if (working->watches) return;
        pthread_cond_destroy(&working->end);
    }
    pthread_mutex_destroy(&working->lock);
}

void working_at_node(void *context, const char *type, const char *name)
{
    Working *working = context;
    if (!working->watches) return;
    pthread_mutex_lock(&working->lock);
    snprintf(working->what, WORKING_WHAT_SIZE, name ? "building the %s '%s'" : "building a %s", type, name);
    pthread_mutex_unlock(&working->lock);
}

void working_end(Working *working)
{
    if (!working->watches) return;
    pthread_mutex_lock(&working->lock);
    working->ended = true;
    pthread_cond_signal(&working->end);
    pthread_mutex_unlock(&working->lock);
    pthread_join(working->thread, NULL);
    pthread_cond_destroy(&working->end);
    pthread_mutex_destroy(&working->lock);
    working->watches = false;
    if (working->shown) {
        fputs(TO_LINE_START CLEAR_TO_LINE_END, stderr);
        fflush(stderr);
    }
}
