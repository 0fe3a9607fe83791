/* render_run.h - what the parts of the command render share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RENDER_RUN_H
#define MEN_RENDER_RUN_H

#include "cli/preview.h"
#include "cli/progress.h"
#include "render/checkpoint.h"

/* Checkpoints of the frame's render (render_checkpoint.c). */
typedef struct RenderKeeping {
    bool wanted;
    double interval_s;
    char *path; /* of the present frame; NULL: not wanted */
    /* The render that it is of asks for more samples, or for less noise, than this one: it stays when this one is done. */
    bool stays;
    uint32_t samples; /* which that asks for */
    double noise;
    /* It was written when the render was stopped, or this is why not. */
    bool kept;
    unsigned n_failed; /* in a row, so far */
    Status status;
    Error error;
} RenderKeeping;

/* What the texts of facts point into. */
typedef struct CheckpointTexts {
    char items[CHECKPOINT_MOST_FACTS][256];
} CheckpointTexts;

typedef struct RenderRun {
    const Options *options;
    const Talk *talk;
    SceneInput input;
    Pool *pool;
    FrameList frames;
    OutputPlan plan;
    char *stats_name; /* of --stats, with '#' for the frame's number; NULL */
    char *stats_path; /* of the present frame */
    OutputList outputs;
    Preview preview;
    bool preview_failed; /* once, which was said */
    Progress progress;
    bool begun;                     /* the frames */
    uint32_t n_rendered, n_skipped; /* so far */
    RenderKeeping checkpoint;
    bool slices;        /* outputs are slices of the picture */
    bool stopped_early; /* by the time limit, with a checkpoint */
    RenderSettings settings;
    RenderState state;
    Image image;
    RenderStats stats;
    double noise;   /* that was reached, as render/adapt.h has it; < 0: not known */
    double start_s; /* of the frame's work, which begins with the command or the end of the frame before */
    double command_start_s;
} RenderRun;

/* Is the run about more than one picture, or one that may be there already? (render_frames.c) */
bool render_has_frames(const RenderRun *run);
/* Chooses the frames, names and tries the files of all of them. The scene is at one of its frames. */
ATTR_NODISCARD Status render_plan_frames(RenderRun *run, Error *error);
/* Each frame in turn: names its files, makes its scene the input's, and calls render. Stops at the first failure, or after
 * a signal. */
ATTR_NODISCARD Status render_each_frame(RenderRun *run, Status (*render)(RenderRun *run, Error *error), Error *error);
void render_frames_clear(RenderRun *run);

/* The scene's film and render nodes, overridden by options (render_settings.c). STATUS_SCENE, after a report, when
 * there is no such camera. */
ATTR_NODISCARD Status render_settings_merge(RenderRun *run, Error *error);

/* The pixel of --pixel as a crop (render_pixel.c). STATUS_USAGE where the picture has none there. */
ATTR_NODISCARD Status render_merge_pixel(RenderRun *run, Error *error);
/* Prints what it came to, where it was asked for, on standard output. */
ATTR_NODISCARD Status render_print_pixel(const RenderRun *run, Error *error);

/* Whether checkpoints are wanted, and whether the options for it agree (render_checkpoint.c). */
ATTR_NODISCARD Status render_plan_checkpoints(RenderRun *run, Error *error);
/* Names the checkpoint of a frame, whose outputs are known. */
ATTR_NODISCARD Status render_name_checkpoint(RenderRun *run, const OutputList *outputs, Error *error);
/* Tries it; one that is there needs a word. */
ATTR_NODISCARD Status render_check_checkpoint(const RenderRun *run, Error *error);
/* Reads the state of the present frame, where it is to go on from one. */
ATTR_NODISCARD Status render_resume(RenderRun *run, Error *error);
/* For RenderEvents: writes a checkpoint, and, when a person asked, the outputs as they are. */
void render_save(RenderRun *run, const RenderState *state, bool asked);
/* Of run->state, where it is wanted and there is something to keep. */
ATTR_NODISCARD Status render_write_checkpoint(RenderRun *run, Error *error);
void render_drop_checkpoint(const RenderRun *run);
/* What has to be the same to go on, or to be merged. */
void render_note(const RenderRun *run, CheckpointNotes *notes, CheckpointTexts *texts);

/* Writes every output, and in them what the render was (render_write.c). again: those that can be written more than once. */
ATTR_NODISCARD Status render_write_outputs(const RenderRun *run, bool again, Error *error);

/* How a film says that light is shown. */
ColorLook film_look(const SceneFilm *film);
/* That, and what the options say: the display and the view of PNG files; NULL: the first. */
ColorLook render_look(const RenderRun *run);

/* What is said of a finished render (render_report.c). */
void render_warn(const RenderRun *run);
void render_summarize(const RenderRun *run);
void render_summarize_frames(const RenderRun *run);
/* How many objects give light by themselves, beside the lights. */
uint32_t render_count_shining(const Scene *scene);
ATTR_NODISCARD Status render_print_stats(const RenderRun *run, Error *error);

#endif
