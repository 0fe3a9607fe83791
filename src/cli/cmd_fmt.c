/* cmd_fmt.c - the command fmt: scenes laid out in one way.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/scene_input.h"
#include "lang/format.h"

typedef struct Formatting {
    const Options *options;
    const Talk *talk;
    size_t n_changed;
} Formatting;

/* One file on its way through the formatter. */
typedef struct Text {
    SceneInput *input;
    const char *bytes;
    size_t length;
    Buf out;
    Error *error;
    Status status;
} Text;

static void format(void *context)
{
    Text *text = context;
    const char *name = strcmp(text->input->path, "-") == 0 ? "<stdin>" : text->input->path;
    text->status = format_text(name, text->bytes, text->length, &text->input->diag, &text->out, text->error);
}

static Status put_out(Formatting *formatting, const Text *text, Error *error)
{
    const char *path = text->input->path;
    bool check = option_given(formatting->options, OPTION_FMT_CHECK);
    bool in_place = option_given(formatting->options, OPTION_IN_PLACE);
    bool same = text->out.length == text->length && memcmp(buf_text(&text->out), text->bytes, text->length) == 0;
    if (!check && !in_place) return print_out(&text->out, error);
    if (same) return STATUS_OK;
    formatting->n_changed++;
    if (!check) return file_write(path, buf_text(&text->out), text->out.length, error);
    Buf line = {0};
    buf_format(&line, "%s\n", path);
    Status status = print_out(&line, error);
    buf_clear(&line);
    return status;
}

static Status format_file(Formatting *formatting, const char *path, Error *error)
{
    SceneInput input;
    char *bytes;
    size_t length;
    TRY(file_read(path, 0, &bytes, &length, error));
    scene_input_init(&input, formatting->options, formatting->talk);
    input.path = path;
    Text text = {.input = &input, .bytes = bytes, .length = length, .error = error};
    Status status = length > UINT32_MAX / 2 ? fail(error, STATUS_INPUT, "'%s' is too large", path)
                                            : scene_input_guard(&input, format, &text, error);
    if (status == STATUS_OK) status = text.status;
    if (status == STATUS_SCENE) status = scene_input_print_reports(&input, error);
    if (status == STATUS_OK) status = put_out(formatting, &text, error);
    buf_clear(&text.out);
    scene_input_close(&input);
    free(bytes);
    return status;
}

Status cmd_fmt(const Options *options, const Talk *talk, Error *error)
{
    Formatting formatting = {.options = options, .talk = talk};
    bool check = option_given(options, OPTION_FMT_CHECK);
    if (options->n_operands > 1 && !check && !option_given(options, OPTION_IN_PLACE))
        return fail(error, STATUS_USAGE, "more than one scene: give --in-place or --check");
    for (size_t i = 0; i < options->n_operands && !check && option_given(options, OPTION_IN_PLACE); i++)
        if (strcmp(options->operands[i], "-") == 0)
            return fail(error, STATUS_USAGE, "standard input has no place to write to: leave '--in-place' out");
    Status status = STATUS_OK; /* the first thing that goes wrong; the other files are seen to all the same */
    for (size_t i = 0; i < options->n_operands; i++) {
        Error own = {0};
        Status result = format_file(&formatting, options->operands[i], &own);
        if (result == STATUS_OK) continue;
        if (status == STATUS_OK) {
            status = result;
            *error = own;
        } else if (own.text[0]) {
            talk_error(talk, &own);
        }
    }
    if (status != STATUS_OK || !check || formatting.n_changed == 0) return status;
    return fail(error, STATUS_RENDER, "%zu of %zu files %s not laid out as fmt would", formatting.n_changed,
                options->n_operands, formatting.n_changed == 1 ? "is" : "are");
}
