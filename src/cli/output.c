/* output.c - names, probes and writes the pictures of a render.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/output.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"

/* ---- names ---- */

/* A row of '#' becomes the number with at least as many digits. */
static char *with_frame(const char *path, unsigned frame)
{
    Buf out = {0};
    while (*path) {
        size_t n = strspn(path, "#"), m = strcspn(path, "#");
        if (n) buf_format(&out, "%0*u", (int)n, frame);
        buf_add_bytes(&out, path + n, n ? 0 : m);
        path += n ? n : m;
    }
    if (out.failed) {
        buf_clear(&out);
        return NULL;
    }
    return out.text; /* a path is not empty */
}

static bool is_device(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

static Status choose_format(const char *path, bool *png, Error *error)
{
    const char *extension = file_extension(path);
    *png = strcasecmp(extension, "png") == 0;
    if (*png || strcasecmp(extension, "exr") == 0) return STATUS_OK;
    if (strcmp(path, "-") == 0 || is_device(path)) return STATUS_OK; /* as EXR */
    return fail(error, STATUS_USAGE, "output '%s' must end in .exr or .png", path);
}

static Status add_output(OutputList *list, const char *path, unsigned frame, Error *error)
{
    Output *output = &list->items[list->n];
    if (!*path) return fail(error, STATUS_USAGE, "the name of an output is empty");
    output->path = with_frame(path, frame);
    if (!output->path) return fail_memory(error, strlen(path) + 1, "the name of an output");
    list->n++;
    TRY(choose_format(output->path, &output->png, error));
    list->has_png = list->has_png || output->png;
    for (size_t i = 0; i + 1 < list->n; i++)
        if (strcmp(list->items[i].path, output->path) == 0)
            return fail(error, STATUS_USAGE, "output '%s' is named twice", output->path);
    if (strcmp(output->path, "-") == 0 && isatty(STDOUT_FILENO))
        return fail(error, STATUS_USAGE, "standard output is a terminal; a picture would only confuse it");
    return STATUS_OK;
}

/* dir/glass.mns gives glass.exr, in the current folder; standard input gives scene.exr. */
static Status add_default(OutputList *list, const char *scene_path, Error *error)
{
    if (strcmp(scene_path, "-") == 0) return add_output(list, "scene.exr", 1, error);
    const char *slash = strrchr(scene_path, '/'), *name = slash ? slash + 1 : scene_path;
    const char *extension = file_extension(scene_path);
    size_t length = strlen(name) - (*extension ? strlen(extension) + 1 : 0);
    Buf path = {0};
    buf_add_bytes(&path, name, length);
    buf_add(&path, ".exr");
    Status status = path.failed ? fail_memory(error, length, "the name of an output")
                                : add_output(list, path.text, 1, error);
    buf_clear(&path);
    return status;
}

Status outputs_collect(OutputList *list, const Options *options, const Scene *scene, unsigned frame, Error *error)
{
    const OptionValue *given = &options->values[OPTION_OUTPUT];
    const char *const *paths = given->n_items ? given->items : scene->film.outputs;
    size_t n = given->n_items ? given->n_items : scene->film.n_outputs;
    *list = (OutputList){.items = calloc(n + 1, sizeof *list->items)};
    if (!list->items) return fail_memory(error, (n + 1) * sizeof *list->items, "the names of outputs");
    for (size_t i = 0; i < n; i++) TRY(add_output(list, paths[i], frame, error));
    return n ? STATUS_OK : add_default(list, options->operands[0], error);
}

void outputs_clear(OutputList *list)
{
    for (size_t i = 0; i < list->n; i++) free(list->items[i].path);
    free(list->items);
    *list = (OutputList){0};
}

/* ---- before the render ---- */

Status output_probe(const char *path, Error *error)
{
    struct stat info;
    size_t length = strlen(path);
    if (strcmp(path, "-") == 0) return STATUS_OK;
    if ((stat(path, &info) == 0 && S_ISDIR(info.st_mode)) || path[length - 1] == '/')
        return fail(error, STATUS_OUTPUT, "cannot write '%s': it is a folder", path);
    if (is_device(path)) { /* opening a pipe would wait for its reader */
        if (access(path, W_OK) == 0) return STATUS_OK;
        return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
    }
    FileOut file;
    TRY(file_create(&file, path, error));
    file_abandon(&file);
    return STATUS_OK;
}

Status outputs_probe(const OutputList *list, Error *error)
{
    for (size_t i = 0; i < list->n; i++) TRY(output_probe(list->items[i].path, error));
    return STATUS_OK;
}

/* ---- after it ---- */

Status image_for_display(const Image *image, double factor, const ColorConfig *color, const char *display,
                         const char *view, Image *shown, Error *error)
{
    static const char *const names[] = {"R", "G", "B"};
    int channels[3];
    *shown = (Image){0};
    if (!image_rgb(image, channels)) return fail(error, STATUS_INPUT, "the picture has no colour channels");
    TRY(image_new(image->width, image->height, names, 3, shown, error));
    size_t n = (size_t)image->width * image->height;
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            shown->pixels[3 * i + c] = image->pixels[i * image->n_channels + (size_t)channels[c]] * (float)factor;
    Status status = color_view(color, display, view, shown, error);
    if (status != STATUS_OK) image_clear(shown);
    return status;
}

Status output_write(const Output *output, const Image *image, const ExrOptions *exr, const ColorConfig *color,
                    const char *display, const char *view, Error *error)
{
    if (!output->png) return exr_write(output->path, image, exr, error);
    Image shown;
    TRY(image_for_display(image, 1, color, display, view, &shown, error));
    Status status = png_write(output->path, &shown, 8, error);
    image_clear(&shown);
    return status;
}
