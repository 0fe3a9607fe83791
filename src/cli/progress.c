/* progress.c - the forms of progress.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define GREEN "\033[32m"
#define PLAIN "\033[0m"

enum { WIDEST_BAR = 30, NARROWEST_BAR = 8, LINE_SIZE = 256 };
static const double plain_interval_s = 60;

ProgressForm progress_form(const Options *options, const Talk *talk)
{
    if (option_is(options, OPTION_PROGRESS, "json")) return PROGRESS_JSON;
    if (option_is(options, OPTION_PROGRESS, "plain")) return PROGRESS_PLAIN;
    if (talk->quiet || option_is(options, OPTION_PROGRESS, "none")) return PROGRESS_NONE;
    if (talk->json) return PROGRESS_JSON;
    return terminal_is_capable() ? PROGRESS_BAR : PROGRESS_PLAIN;
}

void progress_init(Progress *progress, const Options *options, const Talk *talk, const volatile sig_atomic_t *stop)
{
    *progress = (Progress){.form = progress_form(options, talk), .color = talk->color, .stop = stop};
}

void progress_begin_frame(Progress *progress, uint32_t frame, uint32_t frames_done)
{
    progress->frame = frame;
    progress->frames_done = frames_done;
    progress->last_line_s = 0; /* times are those of the frame */
}

static void add(char *line, const char *text)
{
    size_t used = strlen(line);
    snprintf(line + used, LINE_SIZE - used, "%s", text);
}

static void add_rays(char *line, const RenderProgress *state)
{
    char text[48];
    if (state->seconds <= 0 || state->rays == 0) return;
    double rate = (double)state->rays / state->seconds;
    if (rate >= 1e6)
        snprintf(text, sizeof text, "  %.2f Mrays/s", rate * 1e-6);
    else
        snprintf(text, sizeof text, "  %.0f krays/s", rate * 1e-3);
    add(line, text);
}

static void add_time_left(char *line, const RenderProgress *state)
{
    char low[32], high[32], text[96];
    if (state->seconds_left_low < 0 || state->seconds_left_high < 0) return;
    seconds_print(state->seconds_left_low, low);
    seconds_print(state->seconds_left_high, high);
    if (strcmp(low, high) == 0)
        snprintf(text, sizeof text, "  %s left", low);
    else
        snprintf(text, sizeof text, "  %s to %s left", low, high);
    add(line, text);
}

/* of all frames */
static double whole_fraction(const Progress *progress, double fraction)
{
    return progress->n_frames ? (progress->frames_done + fraction) / progress->n_frames : fraction;
}

/* frame 12 (3 of 120)  [=====     ]  42%  107/256 samples  3.21 Mrays/s  noise 1.2%  1m10s to 1m25s left */
static void show_bar(Progress *progress, const RenderProgress *state)
{
    char facts[LINE_SIZE] = "", text[64];
    snprintf(text, sizeof text, " %3d%%  %u/%u sample%s", (int)(100 * state->fraction), state->samples_done,
             state->samples_total, plural(state->samples_total));
    if (state->photons >= 0) snprintf(text, sizeof text, " following photons, %d%%", (int)(100 * state->photons));
    add(facts, text);
    add_rays(facts, state);
    if (state->noise >= 0) {
        snprintf(text, sizeof text, "  noise %.2g%%", 100 * state->noise);
        add(facts, text);
        if (state->noise_wanted > 0) snprintf(text, sizeof text, " of %.2g%%", 100 * state->noise_wanted);
        if (state->noise_wanted > 0) add(facts, text);
    }
    add_time_left(facts, state);
    char front[64] = "";
    if (progress->n_frames)
        snprintf(front, sizeof front, "frame %u (%u of %u)  ", progress->frame, progress->frames_done + 1,
                 progress->n_frames);
    int columns = (int)terminal_columns() - 1 - (int)strlen(front), width = columns - (int)strlen(facts) - 2;
    if (width > WIDEST_BAR) width = WIDEST_BAR;
    Buf line = {0};
    buf_add(&line, TO_LINE_START);
    buf_add(&line, front);
    if (width >= NARROWEST_BAR) {
        int done = (int)(state->fraction * width);
        buf_add(&line, "[");
        if (progress->color) buf_add(&line, GREEN);
        buf_add_repeat(&line, '=', (size_t)done);
        if (progress->color) buf_add(&line, PLAIN);
        buf_add_repeat(&line, ' ', (size_t)(width - done));
        buf_add(&line, "]");
    }
    buf_format(&line, "%.*s%s", columns > 0 ? columns : 0, facts, CLEAR_TO_LINE_END);
    talk_write(&line);
    buf_clear(&line);
    progress->bar_is_shown = true;
}

static void print_percent(const Progress *progress, int percent)
{
    Buf line = {0};
    buf_format(&line, "Progress: %d%%", percent);
    if (progress->n_frames) buf_format(&line, " (frame %u)", progress->frame);
    buf_add(&line, "\n");
    talk_write(&line);
    buf_clear(&line);
}

static void show_plain(Progress *progress, const RenderProgress *state)
{
    double fraction = whole_fraction(progress, state->fraction);
    int tenths = (int)floor(fraction * 10);
    bool minute = state->seconds - progress->last_line_s >= plain_interval_s;
    if (tenths <= progress->tenths_printed && !minute) return;
    int percent = (int)floor(fraction * 100);
    if (state->photons >= 0) {
        progress->last_line_s = state->seconds;
        Buf line = {0};
        buf_format(&line, "Progress: following photons, %d%%\n", (int)(100 * state->photons));
        talk_write(&line);
        buf_clear(&line);
        return;
    }
    if (tenths > progress->tenths_printed) progress->tenths_printed = tenths;
    if (percent >= 100) return; /* progress_end says so */
    progress->last_line_s = state->seconds;
    print_percent(progress, percent);
}

static void show_json(const Progress *progress, const RenderProgress *state)
{
    Buf line = {0};
    JsonWriter json = talk_event_begin(&line, "progress");
    if (progress->n_frames) {
        json_add_whole(&json, "frame", progress->frame);
        json_add_whole(&json, "framesDone", progress->frames_done);
        json_add_whole(&json, "framesTotal", progress->n_frames);
        json_add_number(&json, "fractionOfAll", whole_fraction(progress, state->fraction));
    }
    json_add_number(&json, "fraction", state->fraction);
    json_add_number(&json, "photons", state->photons < 0 ? (double)NAN : state->photons);
    json_add_whole(&json, "samples", state->samples_done);
    json_add_whole(&json, "samplesTotal", state->samples_total);
    json_add_number(&json, "seconds", state->seconds);
    json_add_number(&json, "secondsLeftLow", state->seconds_left_low < 0 ? (double)NAN : state->seconds_left_low);
    json_add_number(&json, "secondsLeftHigh", state->seconds_left_high < 0 ? (double)NAN : state->seconds_left_high);
    json_add_number(&json, "noise", state->noise < 0 ? (double)NAN : state->noise);
    json_add_number(&json, "noiseWanted", state->noise_wanted);
    json_add_whole(&json, "paths", state->paths);
    json_add_whole(&json, "rays", state->rays);
    talk_event_end(&json);
}

void progress_show(void *context, const RenderProgress *state)
{
    Progress *progress = context;
    if (progress->stop && *progress->stop) return;
    switch (progress->form) {
    case PROGRESS_NONE: break;
    case PROGRESS_BAR: show_bar(progress, state); break;
    case PROGRESS_PLAIN: show_plain(progress, state); break;
    case PROGRESS_JSON: show_json(progress, state); break;
    }
}

void progress_end(Progress *progress, bool complete)
{
    if (progress->bar_is_shown && !(progress->stop && *progress->stop)) {
        fputs(TO_LINE_START CLEAR_TO_LINE_END, stderr);
        fflush(stderr);
    }
    bool last = progress->frames_done + 1 >= progress->n_frames;
    if (progress->form == PROGRESS_PLAIN && complete && last) print_percent(progress, 100);
    progress->bar_is_shown = false;
}
