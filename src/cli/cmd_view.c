/* cmd_view.c - the command view: a scene-linear picture as a display shows it.
 * SPDX-License-Identifier: Apache-2.0 */
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/preview.h"

/* The default display and the default view of each first. */
static void list_views(const ColorConfig *config, const char *display, Buf *out)
{
    const char *standard = color_config_default_view(config, display), *view;
    if (standard) buf_format(out, "%s\t%s\n", display, standard);
    for (int i = 0; (view = color_config_view(config, display, i)); i++)
        if (!standard || strcmp(view, standard) != 0) buf_format(out, "%s\t%s\n", display, view);
}

static Status list_all(const ColorConfig *config, Error *error)
{
    const char *standard = color_config_default_display(config), *display;
    Buf out = {0};
    if (standard) list_views(config, standard, &out);
    for (int i = 0; (display = color_config_display(config, i)); i++)
        if (!standard || strcmp(display, standard) != 0) list_views(config, display, &out);
    Status status = print_out(&out, error);
    buf_clear(&out);
    return status;
}

static Status check_output(const char *path, const char *preview, Error *error)
{
    if (!path && preview) return STATUS_OK;
    if (!path) return fail(error, STATUS_USAGE, "option '--output' is missing: which file is to be written?");
    if (strcmp(path, "-") == 0 && isatty(STDOUT_FILENO))
        return fail(error, STATUS_USAGE, "standard output is a terminal; a picture would only confuse it");
    const char *extension = file_extension(path);
    if (*extension && strcasecmp(extension, "png") != 0)
        return fail(error, STATUS_USAGE, "output '%s' must end in .png", path);
    return output_probe(path, error);
}

static Status write_png(const Options *options, const ColorConfig *config, const Image *image, const char *path,
                        Error *error)
{
    Image shown;
    ColorLook look = output_look(options, 0);
    TRY(image_for_display(image, config, &look, &shown, error));
    Status status = png_write(path, &shown, option_is(options, OPTION_BITS, "16") ? 16 : 8, error);
    image_clear(&shown);
    return status;
}

static Status show(const Options *options, const ColorConfig *config, const Image *image, const char *where,
                   Error *error)
{
    Preview preview;
    ColorLook look = output_look(options, 0);
    Status status = preview_open(where, file_name(options->operands[0]), &preview, error);
    if (status == STATUS_OK && preview.kind == PREVIEW_FILE)
        status =
            fail(error, STATUS_USAGE, "option '--preview' of 'view' takes term or tev; '-o %s' writes a file", where);
    if (status == STATUS_OK)
        status = preview_show(&preview, image, NULL, config, &look, error);
    preview_close(&preview);
    return status;
}

static Status view_file(const Options *options, const ColorConfig *config, const char *path, Error *error)
{
    Image image;
    const char *where = option_text(options, OPTION_VIEW_PREVIEW, NULL);
    TRY(image_read_linear(options->operands[0], &image, error));
    Status status = where ? show(options, config, &image, where, error) : STATUS_OK;
    if (status == STATUS_OK && path) status = write_png(options, config, &image, path, error);
    image_clear(&image);
    return status;
}

Status cmd_view(const Options *options, const Talk *talk, Error *error)
{
    (void)talk;
    bool list = option_given(options, OPTION_LIST);
    const char *path = option_text(options, OPTION_VIEW_OUTPUT, NULL);
    if (!list && options->n_operands == 0) return fail(error, STATUS_USAGE, "'view' needs FILE");
    if (!list) TRY(check_output(path, option_text(options, OPTION_VIEW_PREVIEW, NULL), error));
    OutputClaim claims[] = {{list ? NULL : options->operands[0], "what is viewed"}, {path, "the output"}};
    TRY(output_check_claims(claims, COUNT_OF(claims), error));
    ColorConfig *config = NULL;
    TRY(color_config_open(option_text(options, OPTION_OCIO, NULL), &config, error));
    Status status = list ? list_all(config, error) : view_file(options, config, path, error);
    color_config_close(config);
    return status;
}
