/* cmd_check.c - the command check: what is wrong with a scene, and how its objects nest.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>

#include "cli/check_slice.h"
#include "cli/commands.h"
#include "cli/scene_input.h"
#include "scene/report.h"

enum { NUMBER_SIZE = 32 };

typedef struct Check {
    SceneInput input;
    Pool *pool;
    CheckSlice slice;
    Buf out;
    bool built;
    Status status; /* of a guarded task, with its error */
    Error *error;
} Check;

static void warn(void *context)
{
    Check *check = context;
    report_warnings(check->input.compiled, &check->input.diag);
    check->status = report_mesh_crossings(check->input.compiled, check->pool, &check->input.diag, check->error);
    if (!check->input.talk->quiet) report_remarks(check->input.compiled, &check->input.diag);
}

static void print_report(void *context)
{
    Check *check = context;
    report_print(check->input.compiled, &check->input.sources, &check->out);
    if (check->slice.wanted) check_slice_print(&check->slice, check->input.compiled, &check->out);
}

/* One object: the diagnostics, and the report, which is null for a scene that could not be built. */
static void print_json(void *context)
{
    Check *check = context;
    Diag *diag = &check->input.diag;
    Buf diagnostics = {0}, report = {0};
    diag_print_json(diag, &diagnostics);
    if (check->built) report_print_json(check->input.compiled, &check->input.sources, &report);
    JsonWriter json = json_writer(&check->out, true);
    json_begin_object(&json);
    char hash[NUMBER_SIZE];
    snprintf(hash, sizeof hash, "%016llx", check->built ? (unsigned long long)check->input.scene->hash : 0);
    json_add_text(&json, "scene", check->input.path);
    json_add_text(&json, "hash", check->built ? hash : NULL); /* as in the EXR files of its renders */
    json_add_whole(&json, "errors", diag->n_errors);
    json_add_whole(&json, "warnings", diag->n_warnings);
    json_add_whole(&json, "remarks", diag->n_remarks);
    json_key(&json, "diagnostics");
    json_raw(&json, buf_text(&diagnostics));
    json_key(&json, "report");
    json_raw(&json, check->built ? buf_text(&report) : "null");
    if (check->built && check->slice.wanted) check_slice_print_json(&check->slice, check->input.compiled, &json);
    json_end(&json);
    buf_add(&check->out, "\n");
    check->out.failed = check->out.failed || diagnostics.failed || report.failed;
    buf_clear(&diagnostics);
    buf_clear(&report);
}

static Status examine(Check *check, const Options *options, Error *error)
{
    TRY(scene_input_build(&check->input, error));
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &check->pool, error));
    TRY(scene_input_compile(&check->input, check->pool, error));
    check->built = true;
    check->error = error;
    TRY(scene_input_guard(&check->input, warn, check, error));
    TRY(check->status);
    return check->slice.wanted ? check_slice_make(&check->slice, check->input.compiled, check->pool, error) : STATUS_OK;
}

/* What was found goes out also when the scene has errors; only when nothing could be read there is nothing to say. */
static Status print_findings(Check *check, bool as_json, bool quiet, Error *error)
{
    if (as_json) {
        TRY(scene_input_guard(&check->input, print_json, check, error));
        TRY(print_out(&check->out, error));
        error->text[0] = 0;
        return check->input.diag.n_errors ? STATUS_SCENE : STATUS_OK;
    }
    TRY(scene_input_print_reports(&check->input, error));
    if (quiet || !check->built) return STATUS_OK;
    TRY(scene_input_guard(&check->input, print_report, check, error));
    return print_out(&check->out, error);
}

Status cmd_check(const Options *options, const Talk *talk, Error *error)
{
    Check check = {0};
    scene_input_init(&check.input, options, talk);
    Status status = check_slice_init(&check.slice, options, error);
    if (status == STATUS_OK) status = examine(&check, options, error);
    if (status == STATUS_OK || status == STATUS_SCENE) {
        Error own = {0};
        Status printed = print_findings(&check, option_given(options, OPTION_JSON), talk->quiet, &own);
        if (printed != STATUS_OK) {
            status = printed;
            *error = own;
        }
    }
    buf_clear(&check.out);
    check_slice_clear(&check.slice);
    scene_input_close(&check.input);
    pool_free(check.pool);
    return status;
}
