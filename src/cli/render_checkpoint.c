/* render_checkpoint.c - checkpoints: their names, when they are written, and going on from one.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/render_run.h"
#include "render/early.h"

static const double usual_interval_s = 300;

/* ---- before the first frame ---- */

Status render_plan_checkpoints(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    bool resumes = option_given(options, OPTION_RESUME), restarts = option_given(options, OPTION_RESTART);
    bool timed = option_given(options, OPTION_CHECKPOINT);
    if (resumes && restarts)
        return fail(error, STATUS_USAGE,
                    "'--resume' goes on from a checkpoint, '--restart' begins at the start: give one of them");
    run->checkpoint.wanted = timed || resumes || restarts;
    run->checkpoint.interval_s = timed                    ? options->values[OPTION_CHECKPOINT].number
                                 : run->checkpoint.wanted ? usual_interval_s
                                                          : 0;
    return STATUS_OK;
}

/* As the first output that is a file, else as the scene. */
static char *name_beside(const RenderRun *run, const OutputList *outputs)
{
    const char *name = NULL;
    for (size_t i = 0; i < outputs->n && !name; i++)
        if (!output_is_stream(outputs->items[i].path)) name = outputs->items[i].path;
    if (!name) name = strcmp(run->input.path, "-") == 0 ? "scene" : file_name(run->input.path);
    Buf path = {0};
    buf_add_bytes(&path, name, file_stem_length(name));
    buf_add(&path, ".checkpoint.exr");
    if (path.failed) buf_clear(&path);
    return path.text;
}

static Status check_slices(const RenderRun *run, const OutputList *outputs, Error *error)
{
    if (!run->slices || outputs->n == 0) return STATUS_OK;
    for (size_t i = 0; i < outputs->n; i++)
        if (!outputs->items[i].png) return STATUS_OK;
    return fail(error, STATUS_USAGE, "what '--sample-range' makes is merged from EXR files: name one with '-o'");
}

Status render_name_checkpoint(RenderRun *run, const OutputList *outputs, Error *error)
{
    RenderKeeping *checkpoint = &run->checkpoint;
    free(checkpoint->path);
    checkpoint->path = NULL;
    TRY(check_slices(run, outputs, error));
    if (checkpoint->wanted) checkpoint->path = name_beside(run, outputs);
    return checkpoint->wanted && !checkpoint->path ? fail_memory(error, 1, "the name of the checkpoint") : STATUS_OK;
}

Status render_check_checkpoint(const RenderRun *run, Error *error)
{
    const RenderKeeping *checkpoint = &run->checkpoint;
    if (!checkpoint->path) return STATUS_OK;
    if (file_exists(checkpoint->path) && !option_given(run->options, OPTION_RESUME) &&
        !option_given(run->options, OPTION_RESTART))
        return fail(error, STATUS_USAGE,
                    "there is a checkpoint '%s' of a render that was not finished: '--resume' goes on from it, "
                    "'--restart' begins anew",
                    checkpoint->path);
    return output_probe(checkpoint->path, error);
}

/* ---- what a checkpoint is of ---- */

static void add_fact(CheckpointNotes *notes, CheckpointTexts *texts, const char *name, const char *format, ...)
    ATTR_PRINTF(4, 5);
static void add_fact(CheckpointNotes *notes, CheckpointTexts *texts, const char *name, const char *format, ...)
{
    va_list arguments;
    char *text = texts->items[notes->n_facts];
    va_start(arguments, format);
    vsnprintf(text, sizeof *texts->items, format, arguments);
    va_end(arguments);
    notes->facts[notes->n_facts++] = (CheckpointFact){name, text};
}

static void add_scene(const RenderRun *run, CheckpointNotes *notes, CheckpointTexts *texts)
{
    static const char *const names[SCENE_PARTS] = {[SCENE_PART_OBJECTS] = "the objects of the scene",
                                                   [SCENE_PART_MEDIA] = "its media",
                                                   [SCENE_PART_SURFACES] = "its surfaces",
                                                   [SCENE_PART_LIGHTS] = "its lights",
                                                   [SCENE_PART_CAMERAS] = "its cameras",
                                                   [SCENE_PART_ENVIRONMENT] = "its environment"};
    const Scene *scene = run->input.scene;
    for (int i = 0; i < SCENE_PARTS; i++)
        add_fact(notes, texts, names[i], "#%016llx", (unsigned long long)scene->part_hashes[i]);
    /* "##": said only where none of them is */
    add_fact(notes, texts, "something in the scene", "##%016llx", (unsigned long long)scene->hash);
}

static void list_aovs(AovSet set, char *text, size_t size)
{
    snprintf(text, size, "%s", set ? "" : "none");
    for (Aov aov = 0; aov < AOV_COUNT; aov++) {
        size_t used = strlen(text);
        if (set >> aov & 1) snprintf(text + used, size - used, "%s%s", used ? "," : "", aov_name(aov));
    }
}

void render_note(const RenderRun *run, CheckpointNotes *notes, CheckpointTexts *texts)
{
    const RenderSettings *settings = &run->settings;
    const Scene *scene = run->input.scene;
    const char *camera = scene->cameras[settings->camera].name;
    const uint32_t *crop = settings->crop;
    static const char *const caustics[] = {
        [CAUSTICS_AUTOMATIC] = "automatic", [CAUSTICS_ON] = "on", [CAUSTICS_OFF] = "off"};
    char aovs[sizeof *texts->items];
    *notes = (CheckpointNotes){.samples = settings->samples,
                               .noise = settings->noise,
                               .first_sample = settings->first_sample,
                               .end_sample = settings->end_sample ? settings->end_sample : settings->samples};
    list_aovs(settings->aovs, aovs, sizeof aovs);
    add_fact(notes, texts, "meniscus", "%s", MEN_VERSION);
    add_scene(run, notes, texts);
    add_fact(notes, texts, "frame", "%u", scene->frame);
    if (camera) add_fact(notes, texts, "camera", "%s", camera);
    add_fact(notes, texts, "number of the camera", "%u", settings->camera + 1);
    add_fact(notes, texts, "size", "%u x %u", settings->width, settings->height);
    if (crop[2] > crop[0])
        add_fact(notes, texts, "crop", "%u,%u,%u,%u", crop[0], crop[1], crop[2], crop[3]);
    else
        add_fact(notes, texts, "crop", "none");
    add_fact(notes, texts, "seed", "%u", settings->seed);
    add_fact(notes, texts, "nesting", "%s", nest_policy_text(run->input.compiled->order.policy));
    if (settings->bounces == SCENE_BOUNCES_BY_CHANCE)
        add_fact(notes, texts, "bounces", "no limit");
    else
        add_fact(notes, texts, "bounces", "%u", settings->bounces);
    add_fact(notes, texts, "caustics", "%s", caustics[settings->caustics]);
    add_fact(notes, texts, "adaptive", "%s", settings->adaptive ? "on" : "off");
    add_fact(notes, texts, "fireflies", "%s", settings->spreads ? "spread" : "keep");
    add_fact(notes, texts, "denoise", "%s", settings->denoises ? "on" : "off");
    add_fact(notes, texts, "AOVs", "%s", aovs);
    if (settings->no_absorption) add_fact(notes, texts, "absorption", "off");
}

/* ---- going on ---- */

/* A slice's own file serves, where it was stopped. */
static const char *find_source(const RenderRun *run)
{
    if (file_exists(run->checkpoint.path)) return run->checkpoint.path;
    for (size_t i = 0; run->slices && i < run->outputs.n; i++)
        if (!run->outputs.items[i].png && file_exists(run->outputs.items[i].path)) return run->outputs.items[i].path;
    return NULL;
}

static Status check_source(const RenderRun *run, const Checkpoint *file, Error *error)
{
    CheckpointTexts texts;
    CheckpointNotes notes;
    Buf text = {0};
    render_note(run, &notes, &texts);
    checkpoint_compare(&notes, "this render", &file->notes, "the checkpoint", &text);
    bool sliced = notes.first_sample > 0 || notes.end_sample < notes.samples || file->notes.first_sample > 0 ||
                  file->notes.end_sample < file->notes.samples;
    if (sliced && (notes.first_sample != file->notes.first_sample || notes.end_sample != file->notes.end_sample ||
                   notes.samples != file->notes.samples))
        buf_format(&text, "%ssamples: %u..%u of %u in this render, %u..%u of %u in the checkpoint",
                   text.length ? "; " : "", notes.first_sample + 1, notes.end_sample, notes.samples,
                   file->notes.first_sample + 1, file->notes.end_sample, file->notes.samples);
    Status status = STATUS_OK;
    if (text.failed)
        status = fail_memory(error, text.capacity, "what has changed");
    else if (text.length)
        status = fail(error, STATUS_INPUT, "cannot go on from '%s', as there has changed: %s ('--restart' begins anew)",
                      file->path, text.text);
    buf_clear(&text);
    return status;
}

/* Whether a render that asks for so much has more to do than this one. */
static bool asks_for_more(const CheckpointNotes *notes, const RenderSettings *settings)
{
    bool noise = settings->noise > 0 && (!(notes->noise > 0) || notes->noise < settings->noise);
    return notes->samples > settings->samples || noise;
}

Status render_resume(RenderRun *run, Error *error)
{
    render_state_clear(&run->state);
    run->checkpoint.stays = run->checkpoint.kept = false;
    const char *path = option_given(run->options, OPTION_RESUME) ? find_source(run) : NULL;
    if (!path) return STATUS_OK;
    Checkpoint file;
    Status status = checkpoint_open(path, &file, error);
    if (status == STATUS_OK) status = check_source(run, &file, error);
    if (status == STATUS_OK) status = checkpoint_read(&file, &run->state, error);
    if (status == STATUS_OK && strcmp(path, run->checkpoint.path) == 0) {
        run->checkpoint.stays = asks_for_more(&file.notes, &run->settings);
        run->checkpoint.samples = file.notes.samples;
        run->checkpoint.noise = file.notes.noise;
    }
    if (status == STATUS_OK && !run->talk->quiet && file.searching)
        talk_event(run->talk, "resumed", "going on from %s: photons for caustics are still on their way", path);
    else if (status == STATUS_OK && !run->talk->quiet)
        talk_event(run->talk, "resumed", "going on from %s: %u sample%s of each pixel %s there", path,
                   file.least_samples, plural(file.least_samples), file.least_samples == 1 ? "is" : "are");
    checkpoint_close(&file);
    return status;
}

/* ---- keeping ---- */

Status render_write_checkpoint(RenderRun *run, Error *error)
{
    const RenderState *state = &run->state;
    if (!run->checkpoint.path || !render_state_is_worth_keeping(state)) return STATUS_OK;
    CheckpointTexts texts;
    CheckpointNotes notes;
    Image image;
    render_note(run, &notes, &texts);
    if (run->checkpoint.stays) {
        bool whole = notes.end_sample == notes.samples;
        notes.samples = run->checkpoint.samples;
        notes.noise = run->checkpoint.noise;
        if (whole) notes.end_sample = notes.samples;
    }
    TRY(early_resolve(&state->film, 1, &image, error));
    ImageAttribute software = {.name = "software", .type = ATTRIBUTE_TEXT, .text = "meniscus " MEN_VERSION};
    ExrOptions exr = {.half = true, .attributes = &software, .n_attributes = 1, .pool = run->pool};
    Status status = checkpoint_write(run->checkpoint.path, state, &notes, &image, &exr, error);
    image_clear(&image);
    return status;
}

void render_drop_checkpoint(const RenderRun *run)
{
    if (run->checkpoint.path) unlink(run->checkpoint.path);
}

/* The outputs, as far as the picture is. Those of frames bear their names only when these are done. */
static void write_snapshot(RenderRun *run)
{
    Error error = {0};
    RenderStats stats = {.seconds = 0};
    if (render_has_frames(run)) return;
    if (render_state_is_empty(&run->state)) {
        if (!run->talk->quiet) talk_event(run->talk, "snapshot", "there is no sample yet: nothing was written");
        return;
    }
    Status status = render_state_resolve(&run->state, run->settings.exposure, run->pool, &run->image, &stats, &error);
    run->stats = stats;
    run->noise = stats.noise;
    if (status == STATUS_OK) status = render_write_outputs(run, true, &error);
    image_clear(&run->image);
    if (status != STATUS_OK)
        talk_warning(run->talk, "%s; the render goes on", error.text);
    else if (!run->talk->quiet)
        talk_event(run->talk, "snapshot", "wrote the picture so far, of %u sample%s", stats.samples,
                   plural(stats.samples));
}

/* A disk that is full stays so for long: the first is told of, and then the second, the fourth, and so on. */
static void tell_of_failure(RenderRun *run, const Error *error, bool asked)
{
    unsigned n = ++run->checkpoint.n_failed;
    if (!asked && (n & (n - 1))) return;
    if (n == 1)
        talk_warning(run->talk, "%s; the render goes on without this checkpoint", error->text);
    else
        talk_warning(run->talk, "%s; the render goes on without this checkpoint, as without the %u before it",
                     error->text, n - 1);
}

void render_save(RenderRun *run, const RenderState *state, bool asked)
{
    Error error = {0};
    (void)state; /* is the run's */
    if (asked) progress_end(&run->progress, false);
    if (render_write_checkpoint(run, &error) != STATUS_OK)
        tell_of_failure(run, &error, asked);
    else
        run->checkpoint.n_failed = 0;
    if (asked) write_snapshot(run);
}
