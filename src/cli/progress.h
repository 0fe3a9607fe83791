/* progress.h - shows how a render goes: a bar on a terminal, plain lines, JSON lines, or nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PROGRESS_H
#define MEN_PROGRESS_H

#include "cli/talk.h"
#include "render/render.h"

typedef enum ProgressForm { PROGRESS_NONE, PROGRESS_BAR, PROGRESS_PLAIN, PROGRESS_JSON } ProgressForm;

typedef struct Progress {
    ProgressForm form;
    bool color, bar_is_shown;
    int tenths_printed;                    /* of the work, for plain lines */
    double last_line_s;                    /* when the last plain line was printed */
    uint32_t frame, frames_done, n_frames; /* of an animation; n_frames 0: a single picture */
    const volatile sig_atomic_t *stop;     /* nothing is drawn over what the signal handler says */
} Progress;

/* How a bar's line is written over. */
#define TO_LINE_START "\r"
#define CLEAR_TO_LINE_END "\033[K"

/* By --progress and what else the options say. */
ProgressForm progress_form(const Options *options, const Talk *talk);
void progress_init(Progress *progress, const Options *options, const Talk *talk, const volatile sig_atomic_t *stop);
/* The next frame of an animation; frames_done: those before it. */
void progress_begin_frame(Progress *progress, uint32_t frame, uint32_t frames_done);
/* For RenderEvents; context is a Progress. */
void progress_show(void *context, const RenderProgress *state);
/* At the end of each frame: takes the bar off the terminal; with all of the work done, plain progress says so. */
void progress_end(Progress *progress, bool complete);

#endif
