/* scene_input.c - reads, builds and compiles the scene of a command.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/scene_input.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "cli/working.h"

/* Of a scene on standard input; longer ones are files. */
static const size_t largest_text = (size_t)1 << 30;

Status color_source_open(ColorSource *color, Error *error)
{
    return color->config ? STATUS_OK : color_config_open(color->path, &color->config, error);
}

static void start(SceneInput *input)
{
    arena_init(&input->arena);
    input->sources = (SourceSet){.arena = &input->arena};
    diag_init(&input->diag, &input->arena, &input->sources);
    input->diag.warnings_are_errors = option_given(input->options, OPTION_WERROR);
    input->diag_printed = false;
}

void scene_input_init(SceneInput *input, const Options *options, const Talk *talk)
{
    *input = (SceneInput){.options = options, .talk = talk, .path = options->operands[0]};
    start(input);
    arena_init(&input->known_arena);
    diag_init(&input->known, &input->known_arena, NULL);
    input->color.path = option_text(options, OPTION_OCIO, NULL);
    const OptionValue *defines = &options->values[OPTION_DEFINE], *folders = &options->values[OPTION_INCLUDE],
                      *overrides = &options->values[OPTION_SET];
    input->scene_options = (SceneOptions){
        .eval = {.schema = scene_schema(),
                 .defines = defines->items,
                 .n_defines = defines->n_items,
                 .overrides = overrides->items,
                 .n_overrides = overrides->n_items,
                 .include_folders = folders->items,
                 .n_include_folders = folders->n_items,
                 /* a scene that comes through a pipe may be anybody's */
                 .confine = option_text(options, OPTION_CONFINE, strcmp(input->path, "-") == 0 ? "." : NULL),
                 .preset = option_text(options, OPTION_PRESET, NULL)},
        .load_image = load_scene_image,
        .load_image_context = &input->color,
    };
}

static void clear_scene(SceneInput *input)
{
    compiled_scene_free(input->compiled);
    scene_free(input->scene);
    buf_clear(&input->printed);
    arena_clear(&input->arena);
    input->compiled = NULL;
    input->scene = NULL;
}

void scene_input_next(SceneInput *input, uint32_t frame)
{
    clear_scene(input);
    start(input);
    input->animation = input->instant.animation;
    input->scene_options.moment = (SceneMoment){.has_frame = true, .frame = frame, .animation = &input->animation};
}

void scene_input_close(SceneInput *input)
{
    clear_scene(input);
    color_config_close(input->color.config);
    free(input->text);
    arena_clear(&input->known_arena);
    *input = (SceneInput){0};
}

Status scene_input_guard(SceneInput *input, void (*task)(void *context), void *context, Error *error)
{
    if (arena_guard(&input->arena, task, context)) return STATUS_OK;
    return fail(error, STATUS_NOMEM, "out of memory: the scene took %zu bytes so far", input->arena.total);
}

/* ---- stages, each with the arena guarded ---- */

typedef struct Stage {
    SceneInput *input;
    Error *error;
    Status status;
    EvalResult *result;
    Pool *pool;
    NestPolicy policy;
    Buf text;
} Stage;

/* what: it does, for who waits. */
static Status run_stage(Stage *stage, const char *what, void (*task)(void *context))
{
    Working working;
    SceneOptions *options = &stage->input->scene_options;
    working_begin(&working, progress_form(stage->input->options, stage->input->talk), what);
    options->building = working_at_node;
    options->building_context = &working;
    Status guarded = scene_input_guard(stage->input, task, stage, stage->error);
    options->building = NULL;
    options->building_context = NULL;
    working_end(&working);
    TRY(guarded);
    if (stage->status == STATUS_SCENE && stage->input->diag.n_errors)
        stage->error->text[0] = 0; /* the reports say it */
    return stage->status;
}

void scene_input_print_said(SceneInput *input)
{
    if (input->printed.length == 0 || input->talk->quiet) return;
    if (input->talk->json) {
        Buf line = {0};
        JsonWriter json = talk_event_begin(&line, "print");
        if (input->diag.in_frame) json_add_whole(&json, "frame", input->diag.frame);
        json_add_text(&json, "text", buf_text(&input->printed));
        talk_event_end(&json);
    } else {
        talk_write(&input->printed);
    }
    buf_clear(&input->printed);
}

static SceneText text_of(const SceneInput *input)
{
    if (!input->text) return (SceneText){.path = input->path};
    return (SceneText){"<stdin>", input->text, input->text_length};
}

/* A folder that is not there would hide that files are sought in the wrong place, or confine a scene to nothing. */
static Status check_folders(const Options *options, Error *error)
{
    const OptionValue *folders = &options->values[OPTION_INCLUDE];
    for (size_t i = 0; i < folders->n_items; i++)
        if (file_kind(folders->items[i]) != FILE_FOLDER)
            return fail(error, STATUS_INPUT, "option '--include': there is no folder '%s'", folders->items[i]);
    const char *confine = option_text(options, OPTION_CONFINE, NULL);
    if (!confine || file_kind(confine) == FILE_FOLDER) return STATUS_OK;
    return fail(error, STATUS_INPUT, "option '--confine': there is no folder '%s'", confine);
}

bool scene_with_ending(const char *path, char scene[SCENE_PATH_SIZE])
{
    return snprintf(scene, SCENE_PATH_SIZE, "%s.mns", path) < SCENE_PATH_SIZE && file_exists(scene);
}

/* That another is not there is told of by who reads it. */
static Status check_ending(const char *path, Error *error)
{
    char scene[SCENE_PATH_SIZE];
    if (file_exists(path) || !scene_with_ending(path, scene)) return STATUS_OK;
    return fail(error, STATUS_INPUT, "cannot read '%s': there is no such file, but '%s'", path, scene);
}

/* What stands before any look at the scene: which moment, and the text where it comes from standard input. */
static Status get_ready(SceneInput *input, Error *error)
{
    TRY(check_folders(input->options, error));
    /* a name that is wrong is told at once, not when a picture first needs the configuration */
    if (option_given(input->options, OPTION_OCIO)) TRY(color_source_open(&input->color, error));
    if (!input->scene_options.moment.animation) TRY(frames_moment(input->options, &input->scene_options.moment, error));
    if (strcmp(input->path, "-") != 0) return check_ending(input->path, error);
    if (input->text) return STATUS_OK;
    return file_read("-", largest_text, &input->text, &input->text_length, error);
}

static void build(void *context)
{
    Stage *stage = context;
    SceneInput *input = stage->input;
    SceneText text = text_of(input);
    stage->status = scene_build_from(&text, &input->scene_options, &input->diag, &input->scene, &input->printed,
                                     &input->instant, stage->error);
}

Status scene_input_build(SceneInput *input, Error *error)
{
    Stage stage = {.input = input, .error = error};
    TRY(get_ready(input, error));
    return run_stage(&stage, "reading the scene", build);
}

static void evaluate(void *context)
{
    Stage *stage = context;
    SceneInput *input = stage->input;
    SceneText text = text_of(input);
    EvalOptions options = scene_eval_options(&input->scene_options);
    stage->status = scene_evaluate(&text, &options, &input->scene_options.moment, &input->diag, stage->result,
                                   &input->instant, stage->error);
}

Status scene_input_evaluate(SceneInput *input, EvalResult *result, Error *error)
{
    Stage stage = {.input = input, .error = error, .result = result};
    TRY(get_ready(input, error));
    return run_stage(&stage, "reading the scene", evaluate);
}

static void compile(void *context)
{
    Stage *stage = context;
    SceneInput *input = stage->input;
    stage->status =
        compile_scene(input->scene, stage->policy, stage->pool, &input->diag, &input->compiled, stage->error);
}

Status scene_input_compile(SceneInput *input, Pool *pool, Error *error)
{
    Stage stage = {.input = input, .error = error, .pool = pool, .policy = input->scene->render.nesting};
    const char *policy = option_text(input->options, OPTION_NESTING, NULL);
    if (policy && !nest_policy_from_text(policy, &stage.policy))
        return fail(error, STATUS_USAGE, "option '--nesting': there is no policy '%s'", policy);
    TRY(run_stage(&stage, "finding how objects meet", compile));
    if (input->diag.n_errors == 0) return STATUS_OK;
    error->text[0] = 0;
    return STATUS_SCENE;
}

/* ---- reports ---- */

static void count_print(Buf *out, uint32_t n, const char *what)
{
    buf_format(out, "%u %s%s", n, what, n == 1 ? "" : "s");
}

static void print_counts(const SceneInput *input, Buf *out)
{
    const Diag *diag = &input->diag;
    buf_add(out, strcmp(input->path, "-") == 0 ? "<stdin>" : input->path);
    if (diag->in_frame && !input->several_frames) buf_format(out, ", frame %u", diag->frame);
    buf_add(out, ": ");
    const uint32_t counts[] = {diag->n_errors, diag->n_warnings, diag->n_remarks};
    bool any = false, more = false;
    for (size_t i = 0; i < COUNT_OF(counts); i++) {
        if (counts[i] && any) buf_add(out, ", ");
        if (counts[i]) count_print(out, counts[i], diag_severity_text((DiagSeverity)i));
        any = any || counts[i];
        more = more || counts[i] > diag->limit;
    }
    if (more) buf_format(out, " (%u of a kind are shown)", diag->limit);
    buf_add(out, "\n");
}

static void print_json_line(Diag *diag, Buf *out)
{
    Buf array = {0};
    diag_print_json(diag, &array);
    JsonWriter json = talk_event_begin(out, "diagnostics");
    if (diag->in_frame) json_add_whole(&json, "frame", diag->frame);
    json_add_whole(&json, "errors", diag->n_errors);
    json_add_whole(&json, "warnings", diag->n_warnings);
    json_add_whole(&json, "remarks", diag->n_remarks);
    /* One line per event: blanks and texts hold no line breaks in JSON, so each one is only layout. */
    for (size_t i = 0; i < array.length; i++)
        if (array.text[i] == '\n') array.text[i] = ' ';
    json_key(&json, "diagnostics");
    json_raw(&json, buf_text(&array));
    json_end(&json);
    buf_add(out, "\n");
    out->failed = out->failed || array.failed;
    buf_clear(&array);
}

static void print_reports(void *context)
{
    Stage *stage = context;
    SceneInput *input = stage->input;
    if (input->talk->json) {
        print_json_line(&input->diag, &stage->text);
        return;
    }
    diag_print(&input->diag, &stage->text, input->talk->color);
    print_counts(input, &stage->text);
}

static void remember_reports(void *context)
{
    SceneInput *input = context;
    diag_merge(&input->known, &input->diag);
}

Status scene_input_gather(SceneInput *input, Error *error)
{
    if (arena_guard(&input->known_arena, remember_reports, input)) return STATUS_OK;
    return fail(error, STATUS_NOMEM, "out of memory: the reports took %zu bytes so far", input->known_arena.total);
}

void scene_input_use_gathered(SceneInput *input)
{
    input->diag.first = input->known.first;
    input->diag.last = input->known.last;
    input->diag.n_errors = input->known.n_errors;
    input->diag.n_warnings = input->known.n_warnings;
    input->diag.n_remarks = input->known.n_remarks;
    input->several_frames = true;
}

Status scene_input_print_reports(SceneInput *input, Error *error)
{
    Stage stage = {.input = input, .error = error};
    Status status = STATUS_OK;
    if (!input->diag_printed && input->instant.animation.n_frames > 1 && !input->several_frames) {
        diag_drop_known(&input->diag, &input->known);
        TRY(scene_input_gather(input, error));
    }
    if (!input->diag_printed && (input->diag.n_errors || input->diag.n_warnings || input->diag.n_remarks)) {
        status = scene_input_guard(input, print_reports, &stage, error);
        talk_write(&stage.text);
        buf_clear(&stage.text);
    }
    input->diag_printed = true;
    if (status != STATUS_OK || input->diag.n_errors == 0) return status;
    error->text[0] = 0;
    return STATUS_SCENE;
}
