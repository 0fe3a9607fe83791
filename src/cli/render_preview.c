/* render_preview.c - the picture so far, in a file that viewers watch.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>

#include "cli/render_run.h"

Status render_plan_preview(RenderRun *run, Error *error)
{
    const char *path = option_text(run->options, OPTION_PREVIEW, NULL);
    if (!path) return STATUS_OK;
    if (strcmp(path, "-") == 0)
        return fail(error, STATUS_USAGE, "a preview is written again and again: it needs a file, not standard output");
    TRY(output_choose_format(path, &run->preview.png, error));
    TRY(output_probe(path, error));
    run->preview.path = strdup(path);
    return run->preview.path ? STATUS_OK : fail_memory(error, strlen(path) + 1, "the name of the preview");
}

void render_write_preview(RenderRun *run, const Image *image)
{
    Error error;
    ExrOptions exr = {.half = true, .pool = run->pool};
    if (run->preview_failed) return;
    run->preview_failed = output_write(&run->preview, image, &exr, run->input.color.config, render_display(run),
                                       render_view(run), &error) != STATUS_OK;
    if (run->preview_failed) talk_warning(run->talk, "%s; the render goes on without a preview", error.text);
}
