/* cmd_render.c - the command render: from a scene to pictures.
 * Everything that can be found wrong cheaply is found before the first ray: options, outputs, display and view.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "check/report.h"
#include "cli/commands.h"
#include "cli/render_run.h"
#include "cli/signals.h"
#include "render/aov_film.h"

enum { MOST_ATTRIBUTES = 32, NUMBER_SIZE = 32 };

const char *render_display(const RenderRun *run)
{
    return option_text(run->options, OPTION_DISPLAY, NULL);
}

const char *render_view(const RenderRun *run)
{
    return option_text(run->options, OPTION_VIEW, NULL);
}

/* Opens the colour configuration and tries display and view on one pixel. */
static Status probe_view(RenderRun *run, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    Image pixel;
    TRY(color_source_open(&run->input.color, error));
    TRY(image_new(1, 1, names, 3, &pixel, error));
    Status status = color_view(run->input.color.config, render_display(run), render_view(run), &pixel, error);
    image_clear(&pixel);
    return status;
}

/* All that can be done before the first frame's turn. */
static Status prepare(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &run->pool, error));
    run->input.scene_options.pool = run->pool;
    TRY(scene_input_build(&run->input, error));
    TRY(render_settings_merge(run, error));
    TRY(render_plan_frames(run, error));
    TRY(render_plan_preview(run, error));
    if (run->plan.has_png || run->preview.png || option_given(options, OPTION_DISPLAY) || option_given(options, OPTION_VIEW))
        TRY(probe_view(run, error));
    return STATUS_OK;
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
    talk_note(run->talk, "objects: %u (%u with an inside); media: %u; lights: %u; read and built in %s", scene->n_objects,
              run->input.compiled->n_hulls, scene->n_media, scene->n_lights, time);
    talk_note(run->talk, "%u x %u; samples per pixel: %u; nesting: %s; threads: %u", run->settings.width, run->settings.height,
              run->settings.samples, nest_policy_text(run->input.compiled->order.policy), pool_threads(run->pool));
}

static void show_progress(void *context, const RenderProgress *state)
{
    RenderRun *run = context;
    progress_show(&run->progress, state);
}

static void show_picture(void *context, const Image *image)
{
    render_write_preview(context, image);
}

static Status render(RenderRun *run, Error *error)
{
    const RenderSettings *settings = &run->settings;
    RenderEvents events = {.context = run, .progress = show_progress, .stop = signals_flag()};
    if (run->preview.path) events.picture = show_picture;
    Status status =
        render_image(run->input.compiled, settings, run->pool, &events, &run->image, &run->stats, error);
    progress_end(&run->progress, status == STATUS_OK && !run->stats.stopped);
    if (status == STATUS_OK) run->noise = run->stats.noise;
    return status;
}

/* ---- writing ---- */

typedef struct Attributes {
    ImageAttribute items[MOST_ATTRIBUTES];
    size_t n;
    char *owned[2 * MOST_ATTRIBUTES];
    size_t n_owned;
    char hash[NUMBER_SIZE], seed[NUMBER_SIZE], crossings[NUMBER_SIZE], faults[NUMBER_SIZE];
} Attributes;

static void add_text(Attributes *attributes, const char *name, const char *text)
{
    if (text) attributes->items[attributes->n++] = (ImageAttribute){.name = name, .type = ATTRIBUTE_TEXT, .text = text};
}

static void attributes_clear(Attributes *attributes)
{
    for (size_t i = 0; i < attributes->n_owned; i++) free(attributes->owned[i]);
}

/* Of the further channels; left out when memory ends. */
static void add_aov_attribute(void *context, const char *name, const char *text)
{
    Attributes *attributes = context;
    if (attributes->n == MOST_ATTRIBUTES) return;
    char *own_name = strdup(name), *own_text = strdup(text);
    attributes->owned[attributes->n_owned++] = own_name;
    attributes->owned[attributes->n_owned++] = own_text;
    if (own_name) add_text(attributes, own_name, own_text);
}

/* Counts that can be beyond the format's 32-bit integers are text. No times: two renders of one scene are one file,
 * byte for byte; --stats has the times. */
static void describe(const RenderRun *run, Attributes *attributes)
{
    const Scene *scene = run->input.scene;
    *attributes = (Attributes){0};
    snprintf(attributes->hash, NUMBER_SIZE, "%016llx", (unsigned long long)scene->hash);
    snprintf(attributes->seed, NUMBER_SIZE, "%u", run->settings.seed);
    snprintf(attributes->crossings, NUMBER_SIZE, "%llu", (unsigned long long)run->stats.crossings);
    snprintf(attributes->faults, NUMBER_SIZE, "%llu", (unsigned long long)run->stats.nesting_faults);
    add_text(attributes, "software", "meniscus " MEN_VERSION);
    add_text(attributes, "meniscus/version", MEN_VERSION);
    add_text(attributes, "meniscus/scene", run->input.path);
    add_text(attributes, "meniscus/sceneHash", attributes->hash);
    if (run->plan.numbered)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/frame", .type = ATTRIBUTE_INT, .whole = (int)scene->frame};
    add_text(attributes, "meniscus/camera", scene->cameras[run->settings.camera].name);
    add_text(attributes, "meniscus/nesting", nest_policy_text(run->input.compiled->order.policy));
    add_text(attributes, "meniscus/seed", attributes->seed);
    add_text(attributes, "meniscus/crossings", attributes->crossings);
    add_text(attributes, "meniscus/nestingFaults", attributes->faults);
    attributes->items[attributes->n++] =
        (ImageAttribute){.name = "meniscus/samples", .type = ATTRIBUTE_INT, .whole = (int)run->stats.samples};
    if (run->settings.noise > 0)
        attributes->items[attributes->n++] = (ImageAttribute){
            .name = "meniscus/meanSamples", .type = ATTRIBUTE_FLOAT, .number = run->stats.mean_samples};
    if (run->noise >= 0)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/noise", .type = ATTRIBUTE_FLOAT, .number = run->noise};
    if (run->settings.spreads)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/lightSpread", .type = ATTRIBUTE_FLOAT, .number = run->stats.spread_light};
    aov_visit_attributes(run->settings.aovs, scene, add_aov_attribute, attributes);
}

/* Writes every output, also when one of them fails: each is worth the time that the render took. */
static Status write_outputs(const RenderRun *run, Error *error)
{
    Attributes attributes;
    describe(run, &attributes);
    unsigned half = run->options->values[OPTION_HALF].place, full = run->options->values[OPTION_FLOAT].place;
    ExrOptions exr = {
        .half = half > full, .attributes = attributes.items, .n_attributes = attributes.n, .pool = run->pool};
    Status first = STATUS_OK;
    for (size_t i = 0; i < run->outputs.n; i++) {
        Error own = {0};
        Status status = output_write(&run->outputs.items[i], &run->image, &exr, run->input.color.config, render_display(run),
                                     render_view(run), &own);
        if (status == STATUS_OK) continue;
        if (first == STATUS_OK)
            *error = own;
        else
            talk_error(run->talk, &own);
        first = first == STATUS_OK ? status : first;
    }
    attributes_clear(&attributes);
    return first;
}

static Status render_and_write(RenderRun *run, Error *error)
{
    size_t n = run->outputs.n;
    const char **paths = malloc((n + 2) * sizeof *paths);
    if (!paths) return fail_memory(error, (n + 2) * sizeof *paths, "the names of outputs");
    for (size_t i = 0; i < n; i++) paths[i] = run->outputs.items[i].path;
    if (run->stats_path) paths[n++] = run->stats_path;
    if (run->preview.path) paths[n++] = run->preview.path;
    bool keeps = !render_has_frames(run);
    Status status = signals_begin(paths, n, run->talk->json, keeps, error);
    free(paths);
    if (status == STATUS_OK) status = render(run, error);
    bool writes = status == STATUS_OK && (keeps || !*signals_flag());
    if (writes) {
        render_warn(run);
        status = write_outputs(run, error);
    }
    if (writes && status == STATUS_OK) status = render_print_stats(run, error);
    if (writes && status == STATUS_OK) {
        render_summarize(run);
        run->n_rendered++;
    }
    signals_end();
    return status;
}

/* What a picture would be without, and not look wrong for. */
static void warn_of_lights(void *context)
{
    RenderRun *run = context;
    report_lost_lights(run->input.compiled, &run->input.diag);
}

/* The input's scene is at the frame. */
static Status render_frame(RenderRun *run, Error *error)
{
    Status status = render_settings_merge(run, error);
    if (status == STATUS_OK) status = scene_input_compile(&run->input, run->pool, error);
    if (status == STATUS_OK) status = scene_input_guard(&run->input, warn_of_lights, run, error);
    TRY(print_findings(run, status, error));
    note_scene(run);
    status = render_and_write(run, error);
    image_clear(&run->image);
    return status;
}

Status cmd_render(const Options *options, const Talk *talk, Error *error)
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
    if (run.begun && render_has_frames(&run)) render_summarize_frames(&run);
    image_clear(&run.image);
    render_frames_clear(&run);
    free(run.preview.path);
    scene_input_close(&run.input);
    pool_free(run.pool);
    return status;
}
