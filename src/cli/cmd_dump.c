/* cmd_dump.c - the command dump: a scene with everything expanded.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/commands.h"
#include "cli/scene_input.h"
#include "lang/flat.h"

/* The properties of nodes.def that name a file to read. */
static const char *const file_properties[] = {"file", "next_file", "image", NULL};

typedef struct Dump {
    SceneInput *input;
    EvalResult result;
    Buf out;
    Error *error;
    Status status;
} Dump;

/* A camera whose picture is of more than a moment. */
static bool has_shutter(const Dump *dump)
{
    for (size_t i = 0; i < dump->result.n_nodes; i++) {
        const EvalNode *node = dump->result.nodes[i];
        if (strcmp(node->type->name, "camera") == 0 && eval_number(node, "shutter") > 0) return true;
    }
    return false;
}

static void print_flat(void *context)
{
    Dump *dump = context;
    SceneInput *input = dump->input;
    scene_keep_one_frame(&dump->result, &input->instant, &input->arena);
    FlatOptions options = {.eval = &input->scene_options.eval, .sources = &input->sources, .files = file_properties};
    dump->status = flat_print(&dump->result, &options, &input->diag, &dump->out, dump->error);
}

static Status make_text(Dump *dump, Error *error)
{
    TRY(scene_input_evaluate(dump->input, &dump->result, error));
    TRY(scene_input_guard(dump->input, print_flat, dump, error));
    return dump->status;
}

Status cmd_dump(const Options *options, const Talk *talk, Error *error)
{
    SceneInput input;
    scene_input_init(&input, options, talk);
    Dump dump = {.input = &input, .error = error};
    Status status = make_text(&dump, error);
    Error report_error = {0};
    Status reported = scene_input_print_reports(&input, &report_error);
    if (reported != STATUS_OK && (status == STATUS_OK || status == STATUS_SCENE)) {
        status = reported;
        *error = report_error;
    }
    input.printed = dump.result.printed;
    scene_input_print_said(&input);
    if (status == STATUS_OK && input.instant.animation.n_frames > 1 && has_shutter(&dump))
        talk_warning(
            talk,
            "the shutter of a camera is open for a while, and this is the scene as it opens: nothing moves in it");
    if (status == STATUS_OK) status = print_out(&dump.out, error);
    buf_clear(&dump.out);
    scene_input_close(&input);
    return status;
}
