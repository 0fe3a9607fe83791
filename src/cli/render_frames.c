/* render_frames.c - the frames of a render: which ones, their files, and each in its turn.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "cli/other_frames.h"
#include "cli/render_run.h"
#include "cli/signals.h"

bool render_has_frames(const RenderRun *run)
{
    return run->plan.n && (run->frames.n != 1 || option_given(run->options, OPTION_SKIP_EXISTING));
}

/* ---- before the first one ---- */

static Status plan_stats(RenderRun *run, Error *error)
{
    const char *name = option_text(run->options, OPTION_STATS, NULL);
    if (!name) return STATUS_OK;
    uint32_t last = scene_last_frame(&run->input.scene->animation);
    run->stats_name = run->frames.numbered ? output_numbered(name, last) : strdup(name);
    return run->stats_name ? STATUS_OK : fail_memory(error, strlen(name) + 1, "the name of the statistics");
}

static Status name_stats(RenderRun *run, uint32_t frame, Error *error)
{
    free(run->stats_path);
    run->stats_path = NULL;
    if (!run->stats_name) return STATUS_OK;
    run->stats_path = output_of_frame(run->stats_name, frame);
    return run->stats_path ? STATUS_OK : fail_memory(error, strlen(run->stats_name) + 1, "the name of the statistics");
}

/* Two of one name would end as one file, or as one text on standard output. */
static Status check_claims(const RenderRun *run, const OutputList *list, bool done, Error *error)
{
    OutputClaim *claims = malloc((list->n + 3) * sizeof *claims);
    if (!claims) return fail_memory(error, (list->n + 3) * sizeof *claims, "the names of outputs");
    size_t n = 0;
    for (size_t i = 0; i < list->n; i++) claims[n++] = (OutputClaim){list->items[i].path, "an output"};
    claims[n++] = (OutputClaim){done ? NULL : run->checkpoint.path, "the checkpoint"};
    claims[n++] = (OutputClaim){run->stats_path, "the statistics"};
    claims[n++] = (OutputClaim){run->preview.file.path, "the preview"};
    Status status = output_check_claims(claims, n, error);
    free(claims);
    return status;
}

static Status probe_frame(RenderRun *run, uint32_t frame, Error *error)
{
    OutputList list;
    Status status = outputs_of_frame(&list, &run->plan, frame, error);
    if (status == STATUS_OK) status = outputs_probe(&list, error);
    bool done = option_given(run->options, OPTION_SKIP_EXISTING) && outputs_exist(&list);
    if (status == STATUS_OK) status = render_name_checkpoint(run, &list, error);
    if (status == STATUS_OK) status = name_stats(run, frame, error);
    if (status == STATUS_OK) status = check_claims(run, &list, done, error);
    if (status == STATUS_OK && !done) status = render_check_checkpoint(run, error);
    outputs_clear(&list);
    return status == STATUS_OK && run->stats_path ? output_probe(run->stats_path, error) : status;
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* "a#.exr" and "a1#.exr" would both be a11.exr, of different frames; two of one frame were found by its claims. */
static Status check_names(const RenderRun *run, Error *error)
{
    const OutputPlan *plan = &run->plan;
    if (plan->n < 2 || run->frames.n < 2) return STATUS_OK;
    size_t size = plan->n * run->frames.n * sizeof(char *), made = 0;
    char **names = malloc(size);
    Status status = names ? STATUS_OK : fail_memory(error, size, "the names of outputs");
    for (size_t k = 0; k < plan->n; k++)
        for (uint32_t i = 0; i < run->frames.n && status == STATUS_OK && strchr(plan->names[k], '#'); i++) {
            names[made] = output_of_frame(plan->names[k], frames_at(&run->frames, i));
            if (names[made])
                made++;
            else
                status = fail_memory(error, size, "the names of outputs");
        }
    if (status == STATUS_OK) qsort(names, made, sizeof *names, compare_names);
    for (size_t i = 1; i < made && status == STATUS_OK; i++)
        if (strcmp(names[i], names[i - 1]) == 0)
            status = fail(error, STATUS_USAGE,
                          "output '%s' would be written for two frames; let the names differ elsewhere", names[i]);
    for (size_t i = 0; i < made; i++) free(names[i]);
    free(names);
    return status;
}

static Status check_standard_output(const RenderRun *run, Error *error)
{
    bool used = false;
    for (size_t i = 0; i < run->plan.n; i++) used = used || strcmp(run->plan.names[i], "-") == 0;
    if (used && option_given(run->options, OPTION_WATCH))
        return fail(error, STATUS_USAGE, "standard output takes one picture, and with '--watch' there are many");
    if (used && run->frames.n > 1)
        return fail(error, STATUS_USAGE,
                    "standard output takes one picture, and these are %u frames; --frame %u is one", run->frames.n,
                    run->frames.first);
    return STATUS_OK;
}

Status render_plan_frames(RenderRun *run, Error *error)
{
    const Scene *scene = run->input.scene;
    TRY(frames_choose(run->options, &scene->animation, true, &run->frames, error));
    TRY(other_frames_check(&run->input, &run->frames, !option_given(run->options, OPTION_OUTPUT), error));
    TRY(outputs_plan(&run->plan, run->options, scene, run->frames.numbered, error));
    TRY(check_standard_output(run, error));
    TRY(plan_stats(run, error));
    for (uint32_t i = 0; i < run->frames.n; i++) TRY(probe_frame(run, frames_at(&run->frames, i), error));
    return check_names(run, error);
}

/* ---- each in turn ---- */

static void report_outputs(void *context)
{
    SceneInput *input = context;
    diag_report_nowhere(
        &input->diag, D_CLOCK_DEPENDENT,
        "the film's output is another one in this frame, and all files are tried before the first frame");
}

/* The files of the run were named by its first frame, which the last ones agree with. */
static Status check_outputs(RenderRun *run, Error *error)
{
    OutputPlan plan;
    Status status = outputs_plan(&plan, run->options, run->input.scene, run->frames.numbered, error);
    bool same = status == STATUS_OK && plan.n == run->plan.n;
    for (size_t i = 0; same && i < plan.n; i++) same = strcmp(plan.names[i], run->plan.names[i]) == 0;
    outputs_plan_clear(&plan);
    if (status != STATUS_OK || same) return status;
    TRY(scene_input_guard(&run->input, report_outputs, &run->input, error));
    error->text[0] = 0;
    return STATUS_SCENE;
}

/* Makes the scene of the frame the input's; the one that there is may be used once. */
static Status go_to(RenderRun *run, uint32_t frame, bool *fresh, Error *error)
{
    bool there = *fresh && run->input.scene->frame == frame;
    *fresh = false;
    if (there) return STATUS_OK;
    scene_input_next(&run->input, frame);
    TRY(scene_input_build(&run->input, error));
    return check_outputs(run, error);
}

static Status render_one(RenderRun *run, uint32_t i, bool *fresh, Status (*render)(RenderRun *run, Error *error),
                         Error *error)
{
    uint32_t frame = frames_at(&run->frames, i);
    outputs_clear(&run->outputs);
    TRY(outputs_of_frame(&run->outputs, &run->plan, frame, error));
    if (option_given(run->options, OPTION_SKIP_EXISTING) && outputs_exist(&run->outputs)) {
        talk_note(run->talk, "%s is there already", run->outputs.items[0].path);
        run->n_skipped++;
        return STATUS_OK;
    }
    TRY(name_stats(run, frame, error));
    TRY(render_name_checkpoint(run, &run->outputs, error));
    TRY(go_to(run, frame, fresh, error));
    progress_begin_frame(&run->progress, frame, i);
    TRY(render(run, error));
    run->start_s = clock_now_s();
    return STATUS_OK;
}

Status render_each_frame(RenderRun *run, Status (*render)(RenderRun *run, Error *error), Error *error)
{
    bool fresh = true;
    run->begun = true;
    run->progress.n_frames = run->frames.n > 1 ? run->frames.n : 0;
    for (uint32_t i = 0; i < run->frames.n && !*signals_stop(); i++) TRY(render_one(run, i, &fresh, render, error));
    if (run->n_rendered == 0) { /* what a scene says that was only looked at is for those who render it */
        run->input.diag_printed = true;
        buf_clear(&run->input.printed);
    }
    return STATUS_OK;
}

void render_frames_clear(RenderRun *run)
{
    outputs_clear(&run->outputs);
    outputs_plan_clear(&run->plan);
    free(run->stats_name);
    free(run->stats_path);
}
