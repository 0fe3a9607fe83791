/* cmd_render.c - the command render: from a scene to pictures.
 * Everything that can be found wrong cheaply is found before the first ray: options, outputs, display and view.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/memory.h"
#include "check/report.h"
#include "cli/commands.h"
#include "cli/render_run.h"
#include "cli/render_watch.h"
#include "cli/signals.h"
#include "cli/viewpoint.h"

ColorLook film_look(const SceneFilm *film)
{
    return (ColorLook){.exposure = film->exposure, .white_balance = film->white_balance, .alpha = film->alpha};
}

ColorLook render_look(const RenderRun *run)
{
    ColorLook own = film_look(&run->input.scene->film);
    return output_look(run->options, &own);
}

/* Opens the colour configuration and tries display and view on one pixel. */
static Status probe_view(RenderRun *run, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    Image pixel;
    TRY(color_source_open(&run->input.color, error));
    TRY(image_new(1, 1, names, 3, &pixel, error));
    ColorLook look = render_look(run);
    Status status = color_view(run->input.color.config, &look, &pixel, error);
    image_clear(&pixel);
    return status;
}

/* Memory that is not there is promised all the same; the system then ends the program in the midst of its work. */
static void warn_of_memory(const RenderRun *run)
{
    const double of_a_pixel = 320,
                 machine = memory_of_machine(); /* film, bright samples, the picture: without more channels */
    const uint32_t *crop = run->settings.crop;
    double width = crop[2] ? crop[2] - crop[0] : run->settings.width;
    double height = crop[3] ? crop[3] - crop[1] : run->settings.height, needed = of_a_pixel * width * height;
    if (machine > 0 && needed > 0.8 * machine)
        talk_warning(run->talk,
                     "%.0f x %.0f pixels need some %.0f GB of memory, and this machine has %.0f: parts of a picture, "
                     "by '--crop', are put together by 'meniscus merge'; meniscus help poster",
                     width, height, needed / 1e9, machine / 1e9);
}

/* All that can be done before the first frame's turn. */
static Status prepare(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    TRY(render_plan_checkpoints(run, error));
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &run->pool, error));
    run->input.scene_options.pool = run->pool;
    TRY(scene_input_build(&run->input, error));
    TRY(render_settings_merge(run, error));
    warn_of_memory(run);
    TRY(preview_open(option_text(options, OPTION_PREVIEW, NULL), file_name(run->input.path), &run->preview, error));
    TRY(render_plan_frames(run, error));
    if (option_given(options, OPTION_AOV) && !run->plan.has_exr && !option_given(options, OPTION_RENDER_PIXEL))
        talk_warning(run->talk,
                     "'--aov': channels are kept in EXR files, and no output is one; '-o FILE.exr' would be");
    bool shows =
        run->plan.has_png || option_given(options, OPTION_RENDER_PIXEL) || preview_is_for_display(&run->preview);
    bool looks = option_given(options, OPTION_DISPLAY) || option_given(options, OPTION_VIEW);
    return shows || looks ? probe_view(run, error) : STATUS_OK;
}

/* Prints what was found in the scene; status: of what was done so far. */
static Status print_findings(RenderRun *run, Status status, Error *error)
{
    Error own = {0};
    scene_input_print_said(&run->input);
    Status printed = scene_input_print_reports(&run->input, &own);
    if (status != STATUS_OK || printed == STATUS_OK) return status;
    *error = own;
    return printed;
}

static void note_scene(const RenderRun *run)
{
    const Scene *scene = run->input.scene;
    char time[32];
    seconds_print(clock_now_s() - run->start_s, time);
    char shining[48] = "";
    uint32_t n_shining = render_count_shining(scene);
    if (n_shining)
        snprintf(shining, sizeof shining, ", and %u object%s", n_shining,
                 n_shining == 1 ? " that shines" : "s that shine");
    talk_note(run->talk, "objects: %u (%u with an inside); media: %u; lights: %u%s; read and built in %s",
              scene->n_objects, run->input.compiled->n_hulls, scene->n_media, scene->n_lights, shining, time);
    talk_note(run->talk, "%u x %u; samples per pixel: %u; nesting: %s; threads: %u", run->settings.width,
              run->settings.height, run->settings.samples, nest_policy_text(run->input.compiled->order.policy),
              pool_threads(run->pool));
}

static void show_progress(void *context, const RenderProgress *state)
{
    RenderRun *run = context;
    progress_show(&run->progress, state);
    if (option_given(run->options, OPTION_WATCH)) render_watch_look();
}

static void show_picture(void *context, const Image *image)
{
    RenderRun *run = context;
    Error error;
    if (run->preview_failed) return;
    ColorLook look = render_look(run);
    Status status = preview_show(&run->preview, image, run->pool, run->input.color.config, &look, &error);
    run->preview_failed = status != STATUS_OK;
    if (run->preview_failed) talk_warning(run->talk, "%s; the render goes on without a preview", error.text);
}

/* The scene has changed, and this would be no picture of it. */
static bool is_given_up(void)
{
    return *signals_stop() && !*signals_flag();
}

static void save_state(void *context, const RenderState *state, bool asked)
{
    render_save(context, state, asked);
}

/* What is made of it is made afterwards: a second signal then finds it kept. */
static void save_stopped(void *context)
{
    RenderRun *run = context;
    if (is_given_up()) return;
    run->checkpoint.status = render_write_checkpoint(run, &run->checkpoint.error);
    run->checkpoint.kept = true;
}

static Status render(RenderRun *run, Error *error)
{
    const RenderSettings *settings = &run->settings;
    RenderEvents events = {.context = run, .progress = show_progress, .stop = signals_stop()};
    if (run->preview.kind != PREVIEW_NONE) events.picture = show_picture;
    events.save = save_state;
    events.stopped = save_stopped;
    events.wish = signals_wish();
    events.save_interval_s = run->checkpoint.interval_s;
    Status status =
        render_go_on(run->input.compiled, settings, run->pool, &events, &run->state, &run->image, &run->stats, error);
    progress_end(&run->progress, status == STATUS_OK && !run->stats.stopped);
    if (status == STATUS_OK) run->noise = run->stats.noise;
    return status;
}

/* The files that a second signal leaves no part of. */
static Status begin_signals(const RenderRun *run, Error *error)
{
    size_t n = run->outputs.n;
    const char **paths = malloc((n + 3) * sizeof *paths);
    if (!paths) return fail_memory(error, (n + 3) * sizeof *paths, "the names of outputs");
    for (size_t i = 0; i < n; i++) paths[i] = run->outputs.items[i].path;
    if (run->stats_path) paths[n++] = run->stats_path;
    if (run->preview.file.path) paths[n++] = run->preview.file.path;
    if (run->checkpoint.path) paths[n++] = run->checkpoint.path;
    SignalsKeep keep = !render_has_frames(run) ? SIGNALS_KEEP_PICTURE
                       : run->checkpoint.path  ? SIGNALS_KEEP_CHECKPOINT
                                               : SIGNALS_KEEP_NOTHING;
    Status status = signals_begin(paths, n, run->talk->json, keep, error);
    free(paths);
    return status;
}

/* A picture without samples is black: it is not written over one that may be there. */
static Status refuse_empty(RenderRun *run, Error *error)
{
    bool kept = run->checkpoint.path && render_state_is_worth_keeping(&run->state);
    const char *photons = kept ? "; the photons so far are kept for '--resume' in " : "",
               *path = kept ? run->checkpoint.path : "";
    run->stopped_early = false;
    if (!*signals_flag())
        return fail(error, STATUS_STOPPED, "the time was over before the first sample: nothing was written%s%s%s",
                    photons, path, kept ? "" : "; try a longer '-t'");
    /* also where all is quiet: it was said that something would be written */
    talk_event(run->talk, "empty", "stopped before the first sample: nothing was written%s%s", photons, path);
    return STATUS_OK;
}

/* The checkpoint of a render that was stopped, unless it was written before its picture was made. */
static Status keep_checkpoint(RenderRun *run, Error *error)
{
    if (!run->checkpoint.kept) return render_write_checkpoint(run, error);
    if (run->checkpoint.status != STATUS_OK) *error = run->checkpoint.error;
    return run->checkpoint.status;
}

/* What was rendered: its checkpoint first, and none when all is done and written. */
static Status keep(RenderRun *run, Error *error)
{
    bool stopped = run->stats.stopped;
    run->stopped_early = run->stopped_early || (stopped && run->checkpoint.path);
    if (!stopped && !run->checkpoint.stays) { /* slices are to be merged, not gone on from */
        guide_search_free(run->state.search);
        run->state.search = NULL;
    }
    Status status = stopped || run->checkpoint.stays ? keep_checkpoint(run, error) : STATUS_OK;
    if (render_has_frames(run) && *signals_flag()) return status;
    if (stopped && run->stats.most_samples == 0) return refuse_empty(run, error);
    if (status != STATUS_OK) talk_error(run->talk, error);
    render_warn(run);
    Status written = render_write_outputs(run, false, error);
    if (written == STATUS_OK) written = render_print_pixel(run, error);
    if (written == STATUS_OK) written = render_print_stats(run, error);
    if (written == STATUS_OK) {
        if (run->outputs.n) render_summarize(run);
        run->n_rendered++;
    }
    if (status != STATUS_OK) { /* that was said */
        if (written == STATUS_OK) error->text[0] = 0;
        return status;
    }
    if (stopped) return written;
    if (written == STATUS_OK) {
        if (!run->checkpoint.stays) render_drop_checkpoint(run);
    } else {
        Error own = {0};
        if (render_write_checkpoint(run, &own) != STATUS_OK) talk_error(run->talk, &own);
    }
    return written;
}

static Status render_and_write(RenderRun *run, Error *error)
{
    TRY(render_resume(run, error));
    Status status = begin_signals(run, error);
    if (status == STATUS_OK) status = render(run, error);
    if (status == STATUS_OK && !is_given_up()) status = keep(run, error);
    signals_end();
    return status;
}

/* What a picture would be without, and not look wrong for; and what it would take for ever. */
static void warn_of_losses(void *context)
{
    const double many_scatterings =
        600; /* ten times what check says something of: it takes minutes for what others take seconds */
    RenderRun *run = context;
    Vec3 places[VIEWPOINT_PLACES];
    ReportView view =
        viewpoint_look(&run->input, run->settings.camera, run->settings.width, run->settings.height, places);
    report_lost_lights(run->input.compiled, &view, &run->input.diag);
    report_enclosed_lights(run->input.compiled, &run->input.diag);
    report_endless(run->input.compiled, &run->input.diag);
    report_small_volumes(run->input.compiled, &run->input.diag);
    report_nested_parts(run->input.compiled, &run->input.diag);
    if (!run->talk->quiet) {
        report_order_by_volume(run->input.compiled, &run->input.diag);
        report_many_scatterings(run->input.compiled, many_scatterings, &run->input.diag);
        report_coarse_places(run->input.compiled, &run->input.diag);
        if (!run->plan.numbered) report_empty_view(run->input.compiled, run->settings.camera, &run->input.diag);
        report_covered_camera(run->input.compiled, run->settings.camera, &run->input.diag);
    }
}

/* The input's scene is at the frame. */
static Status render_frame(RenderRun *run, Error *error)
{
    Status status = render_settings_merge(run, error);
    if (status == STATUS_OK) status = scene_input_compile(&run->input, run->pool, error);
    if (status == STATUS_OK) status = scene_input_guard(&run->input, warn_of_losses, run, error);
    if (status == STATUS_OK) status = compiled_share_levels(run->input.compiled, error);
    TRY(print_findings(run, status, error));
    note_scene(run);
    status = render_and_write(run, error);
    image_clear(&run->image);
    render_state_clear(&run->state);
    return status;
}

static Status render_scene(const Options *options, const Talk *talk, Error *error)
{
    double now = clock_now_s();
    RenderRun run = {.options = options, .talk = talk, .noise = -1, .start_s = now, .command_start_s = now};
    scene_input_init(&run.input, options, talk);
    Status status = prepare(&run, error);
    if (status == STATUS_OK) {
        progress_init(&run.progress, options, talk, signals_flag());
        status = render_each_frame(&run, render_frame, error);
    }
    status = print_findings(&run, status, error);
    if (run.begun && render_has_frames(&run) && !is_given_up()) render_summarize_frames(&run);
    image_clear(&run.image);
    render_state_clear(&run.state);
    free(run.checkpoint.path);
    render_frames_clear(&run);
    preview_close(&run.preview);
    scene_input_close(&run.input);
    pool_free(run.pool);
    if (status == STATUS_OK && run.stopped_early) { /* which the closing line says */
        error->text[0] = 0;
        status = STATUS_STOPPED;
    }
    return status;
}

Status cmd_render(const Options *options, const Talk *talk, Error *error)
{
    signals_take_wishes(); /* from the first moment: it may come while a scene is built */
    return option_given(options, OPTION_WATCH) ? render_watch(options, talk, render_scene, error)
                                               : render_scene(options, talk, error);
}
