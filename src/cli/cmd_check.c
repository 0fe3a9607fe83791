/* cmd_check.c - the command check: what is wrong with a scene, and how its objects nest.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>

#include "base/file_reads.h"
#include "base/hash.h"
#include "check/report.h"
#include "check/sight_line.h"
#include "cli/check_rays.h"
#include "cli/check_slice.h"
#include "cli/commands.h"
#include "cli/other_frames.h"
#include "cli/viewpoint.h"
#include "trace/path.h"

enum { NUMBER_SIZE = 32 };

typedef struct Check {
    SceneInput input;
    Pool *pool;
    CheckSlice slice;
    const uint32_t *pixel; /* of --pixel; NULL: not asked for */
    SightLine sight;
    CheckRays rays;
    uint32_t camera, width, height; /* what --camera, --size and --scale say */
    Buf out, report;                /* report: of the first frame that could be built, as text or as JSON */
    bool as_json, built;
    uint64_t hash; /* of that frame's scene */
    FrameList frames;
    uint64_t texts; /* a hash of the scene's texts, in which the reports of all frames point */
    Status status;  /* of a guarded task, with its error */
    Error *error;
} Check;

static void warn(void *context)
{
    Check *check = context;
    Vec3 places[VIEWPOINT_PLACES];
    ReportView view = viewpoint_look(&check->input, check->camera, check->width, check->height, places);
    report_warnings(check->input.compiled, &view, &check->input.diag);
    check->status = report_mesh_crossings(check->input.compiled, check->pool, &check->input.diag, check->error);
    if (!check->input.talk->quiet) report_remarks(check->input.compiled, &check->input.diag);
}

static void print_report(void *context)
{
    Check *check = context;
    if (check->as_json)
        report_print_json(check->input.compiled, &check->input.sources, &check->report);
    else
        report_print(check->input.compiled, &check->input.sources, &check->report);
    if (!check->as_json && check->pixel) {
        buf_add(&check->report, "\n");
        sight_line_print(check->input.compiled, &check->sight, &check->report);
    }
    if (!check->as_json && check->rays.n) check_rays_print(&check->rays, check->input.compiled, &check->report);
    if (!check->as_json && check->slice.wanted) check_slice_print(&check->slice, check->input.compiled, &check->report);
    check->hash = check->input.scene->hash;
    check->built = true;
}

/* A line for each file that was read. */
static void list_files(Buf *out)
{
    const char *path;
    for (size_t i = 0; (path = file_read_path(i)) != NULL; i++) buf_format(out, "%s\n", path);
}

static void list_files_json(JsonWriter *json)
{
    const char *path;
    json_key(json, "files");
    json_begin_array(json);
    for (size_t i = 0; (path = file_read_path(i)) != NULL; i++) json_text(json, path);
    json_end(json);
}

/* One object: the diagnostics, and the report, which is null for a scene that could not be built. */
static void print_json(void *context)
{
    Check *check = context;
    Diag *diag = &check->input.diag;
    Buf diagnostics = {0};
    diag_print_json(diag, &diagnostics);
    JsonWriter json = json_writer(&check->out, true);
    json_begin_object(&json);
    char hash[NUMBER_SIZE];
    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)check->hash);
    json_add_text(&json, "scene", check->input.path);
    json_add_text(&json, "hash", check->built ? hash : NULL); /* as in the EXR files of its renders */
    json_add_whole(&json, "errors", diag->n_errors);
    json_add_whole(&json, "warnings", diag->n_warnings);
    json_add_whole(&json, "remarks", diag->n_remarks);
    list_files_json(&json);
    json_key(&json, "diagnostics");
    json_raw(&json, buf_text(&diagnostics));
    json_key(&json, "report");
    json_raw(&json, check->built ? buf_text(&check->report) : "null");
    if (check->built && check->pixel) {
        json_key(&json, "sight");
        sight_line_print_json(check->input.compiled, &check->sight, &json);
    }
    if (check->built && check->rays.n) check_rays_print_json(&check->rays, check->input.compiled, &json);
    if (check->built && check->slice.wanted) check_slice_print_json(&check->slice, check->input.compiled, &json);
    json_end(&json);
    buf_add(&check->out, "\n");
    check->out.failed = check->out.failed || diagnostics.failed || check->report.failed;
    buf_clear(&diagnostics);
}

/* The line of sight through a pixel of the picture that the options ask for. */
static Status look_through_pixel(Check *check, Error *error)
{
    Ray ray;
    TRY(viewpoint_ray(check->input.compiled, check->camera, check->pixel, check->width, check->height, "--pixel", &ray,
                      error));
    return sight_line_find(check->input.compiled, &ray, &check->sight, error);
}

/* What --camera, --size and --scale say is looked at whether --pixel asks for it or not. */
static Status look(Check *check, Error *error)
{
    TRY(viewpoint_size(&check->input, &check->width, &check->height, error));
    TRY(viewpoint_camera(&check->input, &check->camera, error));
    if (check->pixel) TRY(look_through_pixel(check, error));
    RayView view = {check->camera, check->width, check->height};
    return check_rays_find(&check->rays, check->input.compiled, view, check->pool, error);
}

/* Everything that can be wrong with the input's frame. */
static Status examine_frame(Check *check, Error *error)
{
    Status status = scene_input_build(&check->input, error);
    scene_input_print_said(&check->input);
    TRY(status);
    TRY(scene_input_compile(&check->input, check->pool, error));
    if (!check->built) TRY(look(check, error));
    if (check->slice.wanted)
        TRY(check_slice_make(&check->slice, check->input.compiled, &check->rays, check->pool, error));
    if (!check->built) TRY(scene_input_guard(&check->input, print_report, check, error));
    check->error = error;
    TRY(scene_input_guard(&check->input, warn, check, error));
    return check->status;
}

static uint64_t hash_of_texts(const SourceSet *sources)
{
    uint64_t hash = sources->n;
    for (uint32_t i = 0; i < sources->n; i++)
        hash = hash_bytes(sources->sources[i].text, sources->sources[i].length, hash);
    return hash;
}

/* Keeps what was found in a frame; mistakes of the scene do not keep the next one from being looked at. */
static Status keep_findings(Check *check, Status status, Error *error)
{
    if (status != STATUS_OK && status != STATUS_SCENE) return status;
    uint64_t texts = hash_of_texts(&check->input.sources);
    if (check->texts && texts != check->texts)
        return fail(error, STATUS_INPUT, "the files of the scene changed while its frames were checked");
    check->texts = texts;
    return scene_input_gather(&check->input, error);
}

/* What is a mistake whichever frames are rendered: all of them, where the options do not say, as render does. */
static Status examine_others(Check *check, const Options *options, Error *error)
{
    FrameList all;
    TRY(frames_choose(options, &check->input.instant.animation, true, &all, error));
    return other_frames_check(&check->input, &all, true, error);
}

static Status examine(Check *check, const Options *options, Error *error)
{
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &check->pool, error));
    check->input.scene_options.pool = check->pool;
    Status status = examine_frame(check, error);
    if ((status != STATUS_OK && status != STATUS_SCENE) || check->input.instant.animation.n_frames == 0) return status;
    TRY(frames_choose(options, &check->input.instant.animation, false, &check->frames, error));
    if (status == STATUS_OK) status = examine_others(check, options, error);
    if (check->frames.n < 2) return status;
    if (check->slice.wanted)
        return fail(error, STATUS_USAGE, "'--slice' is of one frame, and these are %u", check->frames.n);
    TRY(keep_findings(check, status, error));
    for (uint32_t i = 1; i < check->frames.n; i++) {
        scene_input_next(&check->input, frames_at(&check->frames, i));
        TRY(keep_findings(check, examine_frame(check, error), error));
    }
    scene_input_use_gathered(&check->input);
    return check->input.diag.n_errors ? STATUS_SCENE : STATUS_OK;
}

/* What was found goes out also when the scene has errors; only when nothing could be read there is nothing to say. */
static Status print_findings(Check *check, bool quiet, Error *error)
{
    const bool files = option_given(check->input.options, OPTION_FILES);
    if (check->as_json) {
        TRY(scene_input_guard(&check->input, print_json, check, error));
        TRY(print_out(&check->out, error));
        error->text[0] = 0;
        return check->input.diag.n_errors ? STATUS_SCENE : STATUS_OK;
    }
    TRY(scene_input_print_reports(&check->input, error));
    if (files) list_files(&check->out);
    if (files) return print_out(&check->out, error);
    if (quiet || !check->built) return STATUS_OK;
    return print_out(&check->report, error);
}

/* Sections and rays that begin at a place are looked at without any picture. */
static bool draws_only(const Check *check)
{
    bool through_pixel = check->pixel != NULL;
    for (size_t i = 0; i < check->rays.n_wishes; i++) through_pixel |= check->rays.wishes[i].through_pixel;
    return !through_pixel && (check->slice.wanted || check->rays.n_wishes);
}

Status cmd_check(const Options *options, const Talk *talk, Error *error)
{
    Check check = {.as_json = option_given(options, OPTION_JSON),
                   .pixel = option_given(options, OPTION_PIXEL) ? options->values[OPTION_PIXEL].whole : NULL};
    scene_input_init(&check.input, options, talk);
    Status status = check_slice_init(&check.slice, options, error);
    if (status == STATUS_OK) status = check_rays_init(&check.rays, options, error);
    check.input.scene_options.no_picture = draws_only(&check);
    if (status == STATUS_OK) status = examine(&check, options, error);
    if (status == STATUS_OK || status == STATUS_SCENE) {
        Error own = {0};
        Status printed = print_findings(&check, talk->quiet, &own);
        if (printed != STATUS_OK) {
            status = printed;
            *error = own;
        }
    }
    buf_clear(&check.out);
    check_slice_clear(&check.slice);
    check_rays_clear(&check.rays);
    sight_line_clear(&check.sight);
    buf_clear(&check.report);
    scene_input_close(&check.input);
    pool_free(check.pool);
    return status;
}
