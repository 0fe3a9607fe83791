/* cmd_help.c - the commands help and version.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>
#include <string.h>

#include "cli/commands.h"
#include "cli/reference.h"
#include "diag/suggest.h"
#include "geom/rtc.h"
#include "scene/build.h"

/* Everything that has help, for did-you-mean. */
static const char *nearest_topic(const char *wrong)
{
    const Schema *schema = scene_schema();
    const char **names = malloc((COMMAND_COUNT + schema->n_nodes + D_COUNT) * sizeof *names);
    if (!names) return NULL;
    size_t n = 0;
    for (Command command = 0; command < COMMAND_COUNT; command++)
        if (command_row(command)->summary) names[n++] = command_row(command)->name;
    for (size_t i = 0; i < schema->n_nodes; i++) names[n++] = schema->nodes[i].name;
    for (DiagCode code = 0; code < D_COUNT; code++) names[n++] = diag_slug(code);
    const char *near = suggest_nearest(wrong, names, n);
    free(names);
    return near;
}

/* A word can be a command and a node (render): then both are explained. */
static Status explain(const char *topic, Buf *out, Error *error)
{
    Command command = command_named(topic);
    const NodeType *node = reference_node(topic);
    DiagCode code = reference_diagnostic(topic);
    if (command != COMMAND_COUNT && command_row(command)->summary) help_print(command, true, out);
    if (node) {
        if (out->length) buf_add(out, "\nIn a scene:\n\n");
        reference_print_node(node, out);
    }
    if (code != D_COUNT) reference_print_diagnostic(code, out);
    if (out->length) return STATUS_OK;
    const char *near = nearest_topic(topic);
    return fail(error, STATUS_USAGE, "there is no help for '%s'%s%s%s", topic, near ? "; did you mean '" : "", near ? near : "",
                near ? "'?" : "");
}

Status cmd_help(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    Buf out = {0};
    Status status = STATUS_OK;
    if (option_given(options, OPTION_JSON))
        help_print_json(&out);
    else if (options->n_operands)
        status = explain(options->operands[0], &out, error);
    else
        help_print_overview(&out);
    if (status == STATUS_OK) status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

Status cmd_version(const Options *options, const Talk *talk, Error *error)
{
    (void)options;
    (void)talk;
    Buf out = {0};
    buf_format(&out, "meniscus %s\n%s\n", MEN_VERSION, rtc_library_version());
    Status status = print_out(&out, error);
    buf_clear(&out);
    return status;
}
