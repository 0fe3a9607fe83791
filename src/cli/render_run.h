/* render_run.h - what the parts of the command render share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_RENDER_RUN_H
#define MEN_RENDER_RUN_H

#include "cli/output.h"
#include "render/render.h"

typedef struct RenderRun {
    const Options *options;
    const Talk *talk;
    SceneInput input;
    Pool *pool;
    OutputList outputs;
    RenderSettings settings;
    Image image;
    RenderStats stats;
    double noise;   /* that was reached: mean relative standard error per pixel */
    double start_s; /* of the whole command */
} RenderRun;

/* The scene's film and render nodes, overridden by options (render_settings.c). STATUS_SCENE, after a report, when
 * there is no such camera. */
ATTR_NODISCARD Status render_settings_merge(RenderRun *run, Error *error);

/* What is said of a finished render (render_report.c). */
void render_warn(const RenderRun *run);
void render_summarize(const RenderRun *run);
ATTR_NODISCARD Status render_print_stats(const RenderRun *run, Error *error);
/* The mean over the crop of noise.Y relative to luminance; negative without that channel. */
double render_noise_of(const Image *image, const RenderSettings *settings);

#endif
