/* output.c - names, probes and writes the pictures of a render.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/output.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/file_reads.h"
#include "base/num.h"
#include "optics/white_balance.h"
#include "render/brightness.h"

enum { FEWEST_DIGITS = 4, LONGEST_NUMBER = 64 };

/* ---- names ---- */

char *output_of_frame(const char *name, uint32_t frame)
{
    Buf out = {0};
    while (*name) {
        size_t n = strspn(name, "#"), m = strcspn(name, "#");
        if (n) buf_format(&out, "%0*u", (int)(n < LONGEST_NUMBER ? n : LONGEST_NUMBER), frame);
        buf_add_bytes(&out, name + n, n ? 0 : m);
        name += n ? n : m;
    }
    if (out.failed) {
        buf_clear(&out);
        return NULL;
    }
    return out.text; /* a name is not empty */
}

char *output_numbered(const char *name, uint32_t last_frame)
{
    Buf out = {0};
    size_t stem = file_stem_length(name), digits = FEWEST_DIGITS;
    for (uint32_t rest = last_frame / 10000; rest; rest /= 10) digits++;
    bool has_own = strchr(name, '#') != NULL;
    buf_add_bytes(&out, name, has_own ? strlen(name) : stem);
    if (!has_own) {
        buf_add(&out, ".");
        buf_add_repeat(&out, '#', digits);
        buf_add(&out, name + stem);
    }
    if (out.failed) buf_clear(&out);
    return out.text;
}

bool output_is_stream(const char *path)
{
    return strcmp(path, "-") == 0 || file_kind(path) == FILE_OTHER;
}

Status output_check_name(const char *path, Error *error)
{
    const char *name = file_name(path);
    size_t length;
    const char *mark = file_number_mark(path, &length);
    if (mark)
        return fail(error, STATUS_USAGE,
                    "'%.*s' is no place for the number of a frame in the output '%s'; write: %.*s####%s", (int)length,
                    mark, path, (int)(mark - path), path, mark + length);
    if (strcasecmp(name, ".png") != 0 && strcasecmp(name, ".exr") != 0) return STATUS_OK;
    return fail(error, STATUS_USAGE, "output '%s' has no name in front of its ending, as %.*spicture%s does", path,
                (int)(name - path), path, name);
}

Status output_choose_format(const char *path, bool *png, Error *error)
{
    TRY(output_check_name(path, error));
    const char *extension = file_extension(path);
    *png = strcasecmp(extension, "png") == 0;
    if (*png || strcasecmp(extension, "exr") == 0) return STATUS_OK;
    if (output_is_stream(path)) return STATUS_OK; /* as EXR */
    return fail(error, STATUS_USAGE, "output '%s' must end in .exr or .png", path);
}

static Status add_name(OutputPlan *plan, const char *name, bool numbered, uint32_t last_frame, Error *error)
{
    bool png;
    if (!*name) return fail(error, STATUS_USAGE, "the name of an output is empty");
    TRY(output_choose_format(name, &png, error));
    plan->has_png = plan->has_png || png;
    plan->has_exr = plan->has_exr || !png;
    bool stream = output_is_stream(name);
    if (strcmp(name, "-") == 0 && isatty(STDOUT_FILENO))
        return fail(error, STATUS_USAGE, "standard output is a terminal; a picture would only confuse it");
    char *own = numbered && !stream ? output_numbered(name, last_frame) : strdup(name);
    if (!own) return fail_memory(error, strlen(name) + 1, "the name of an output");
    plan->names[plan->n++] = own;
    return STATUS_OK;
}

/* dir/glass.mns gives glass.exr, in the current folder; standard input gives scene.exr. */
static Status add_default(OutputPlan *plan, const char *scene_path, bool numbered, uint32_t last_frame, Error *error)
{
    if (strcmp(scene_path, "-") == 0) return add_name(plan, "scene.exr", numbered, last_frame, error);
    const char *name = file_name(scene_path);
    size_t length = file_stem_length(name);
    Buf path = {0};
    buf_add_bytes(&path, name, length);
    buf_add(&path, ".exr");
    Status status = path.failed ? fail_memory(error, length, "the name of an output")
                                : add_name(plan, path.text, numbered, last_frame, error);
    buf_clear(&path);
    return status;
}

Status outputs_plan(OutputPlan *plan, const Options *options, const Scene *scene, bool numbered, Error *error)
{
    const OptionValue *given = &options->values[OPTION_OUTPUT];
    const char *const *names = given->n_items ? given->items : scene->film.outputs;
    size_t n = given->n_items ? given->n_items : scene->film.n_outputs;
    uint32_t last = scene_last_frame(&scene->animation);
    *plan = (OutputPlan){.names = calloc(n + 1, sizeof *plan->names), .numbered = numbered};
    if (!plan->names) return fail_memory(error, (n + 1) * sizeof *plan->names, "the names of outputs");
    if (!given->n_items && option_given(options, OPTION_RENDER_PIXEL)) return STATUS_OK; /* which is no picture */
    for (size_t i = 0; i < n; i++) TRY(add_name(plan, names[i], numbered, last, error));
    return n ? STATUS_OK : add_default(plan, options->operands[0], numbered, last, error);
}

void outputs_plan_clear(OutputPlan *plan)
{
    for (size_t i = 0; i < plan->n; i++) free(plan->names[i]);
    free(plan->names);
    *plan = (OutputPlan){0};
}

Status outputs_of_frame(OutputList *list, const OutputPlan *plan, uint32_t frame, Error *error)
{
    *list = (OutputList){.items = calloc(plan->n + 1, sizeof *list->items)};
    if (!list->items) return fail_memory(error, (plan->n + 1) * sizeof *list->items, "the names of outputs");
    for (size_t i = 0; i < plan->n; i++) {
        Output *output = &list->items[i];
        output->path = output_of_frame(plan->names[i], frame);
        if (!output->path) return fail_memory(error, strlen(plan->names[i]) + 1, "the name of an output");
        list->n++;
        TRY(output_choose_format(output->path, &output->png, error));
    }
    return STATUS_OK;
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
    if (file_was_read(path))
        return fail(error, STATUS_USAGE,
                    "'%s' is not written over: it was read for this. Give what is written another name", path);
    if (file_kind(path) == FILE_OTHER) { /* opening a pipe would wait for its reader */
        if (access(path, W_OK) == 0) return STATUS_OK;
        return fail(error, STATUS_OUTPUT, "cannot write '%s': %s", path, strerror(errno));
    }
    FileOut file;
    TRY(file_create(&file, path, error));
    file_abandon(&file);
    return STATUS_OK;
}

Status output_check_claims(const OutputClaim *claims, size_t n, Error *error)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = 0; k < i; k++)
            if (claims[i].path && claims[k].path && file_same(claims[i].path, claims[k].path))
                return strcmp(claims[i].what, claims[k].what) == 0
                           ? fail(error, STATUS_USAGE, "output '%s' is named twice", claims[i].path)
                           : fail(error, STATUS_USAGE, "'%s' is both %s and %s; let one have another name",
                                  claims[i].path, claims[k].what, claims[i].what);
    return STATUS_OK;
}

Status outputs_probe(const OutputList *list, Error *error)
{
    for (size_t i = 0; i < list->n; i++) TRY(output_probe(list->items[i].path, error));
    return STATUS_OK;
}

bool outputs_exist(const OutputList *list)
{
    if (list->n == 0) return false;
    for (size_t i = 0; i < list->n; i++)
        if (file_kind(list->items[i].path) != FILE_REGULAR) return false;
    return true;
}

/* ---- after it ---- */

ColorLook output_look(const Options *options, const ColorLook *own)
{
    ColorLook look = *own;
    look.display = option_text(options, OPTION_DISPLAY, NULL);
    look.view = option_text(options, OPTION_VIEW, NULL);
    if (option_given(options, OPTION_EXPOSURE)) look.exposure.stops = options->values[OPTION_EXPOSURE].number;
    if (option_given(options, OPTION_AUTO_EXPOSURE))
        look.exposure.automatic = option_is(options, OPTION_AUTO_EXPOSURE, "on");
    if (option_given(options, OPTION_WHITE_BALANCE)) look.white_balance = options->values[OPTION_WHITE_BALANCE].number;
    if (option_given(options, OPTION_ALPHA)) look.alpha = option_is(options, OPTION_ALPHA, "on");
    return look;
}

static const char *const exposure_name = "meniscus/exposure", *const automatic_name = "meniscus/autoExposure",
                         *const white_name = "meniscus/whiteBalance", *const alpha_name = "meniscus/alpha";

void output_note_look(const ColorLook *look, Attributes *attributes)
{
    attributes_add_number(attributes, exposure_name, look->exposure.stops);
    if (look->exposure.automatic) attributes_add_whole(attributes, automatic_name, 1);
    if (look->white_balance > 0) attributes_add_number(attributes, white_name, look->white_balance);
    if (look->alpha) attributes_add_whole(attributes, alpha_name, 1);
}

void output_find_look(ColorLook *look, const char *name, double value)
{
    const OptionRow *exposure = option_row(OPTION_EXPOSURE), *white = option_row(OPTION_WHITE_BALANCE);
    if (strcmp(name, exposure_name) == 0 && value >= exposure->low && value <= exposure->high)
        look->exposure.stops = value;
    if (strcmp(name, white_name) == 0 && value >= white->low && value <= white->high) look->white_balance = value;
    if (strcmp(name, automatic_name) == 0) look->exposure.automatic = value == 1;
    if (strcmp(name, alpha_name) == 0) look->alpha = value == 1;
}

static void find_look(void *context, const char *name, const char *text)
{
    double value;
    if (num_parse(text, strlen(text), &value)) output_find_look(context, name, value);
}

ColorLook output_read_look(const char *path)
{
    Error none;
    ColorLook look = {.alpha = false};
    if (file_kind(path) != FILE_REGULAR || exr_visit_attributes(path, find_look, &look, &none) != STATUS_OK)
        look = (ColorLook){.alpha = false};
    return look;
}

ColorLook output_look_for(const Image *image, const ColorLook *look)
{
    ColorLook found = *look;
    if (!look->exposure.automatic) return found;
    Brightness brightness = brightness_find(image, 0);
    found.exposure.stops += brightness_stops(&brightness);
    found.exposure.automatic = false;
    return found;
}

void output_say_exposure(const Talk *talk, const Image *image, const ColorLook *look)
{
    if (look->exposure.automatic)
        talk_remark(talk, "the automatic exposure is the same as: --exposure %g",
                    output_look_for(image, look).exposure.stops);
}

/* As PNG files have it: alpha from 0 to 1, and colours not multiplied by it. Where chance found too much of what is behind panes,
 * alpha may be a little outside. */
static void unassociate(float pixel[4])
{
    float alpha = pixel[3];
    pixel[3] = alpha < 1 ? (alpha > 0 ? alpha : 0) : 1;
    for (int c = 0; c < 3; c++) pixel[c] = pixel[3] > 0 ? pixel[c] / pixel[3] : 0;
}

static void balance_white(double kelvin, Image *shown)
{
    float m[3][3];
    if (!(kelvin > 0)) return;
    white_balance(kelvin, m);
    for (size_t i = 0; i < (size_t)shown->width * shown->height; i++) {
        float *p = shown->pixels + shown->n_channels * i, rgb[3];
        for (int c = 0; c < 3; c++) rgb[c] = m[c][0] * p[0] + m[c][1] * p[1] + m[c][2] * p[2];
        for (int c = 0; c < 3; c++) p[c] = rgb[c];
    }
}

Status image_for_display(const Image *image, const ColorConfig *color, const ColorLook *look, Image *shown,
                         Error *error)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    int channels[4];
    *shown = (Image){0};
    if (!image_rgb(image, channels)) return fail(error, STATUS_INPUT, "the picture has no colour channels");
    channels[3] = look->alpha ? image_channel(image, "A") : -1;
    uint32_t n_shown = channels[3] >= 0 ? 4 : 3;
    TRY(image_new(image->width, image->height, names, n_shown, shown, error));
    size_t n = (size_t)image->width * image->height;
    for (size_t i = 0; i < n; i++) {
        float *pixel = shown->pixels + n_shown * i;
        for (uint32_t c = 0; c < n_shown; c++) pixel[c] = image->pixels[i * image->n_channels + (size_t)channels[c]];
        if (n_shown == 4) unassociate(pixel);
    }
    ColorLook found = output_look_for(image, look);
    balance_white(found.white_balance, shown);
    Status status = color_view(color, &found, shown, error);
    if (status != STATUS_OK) image_clear(shown);
    return status;
}

Status output_write(const Output *output, const Image *image, const ExrOptions *exr, const ColorConfig *color,
                    const ColorLook *look, Error *error)
{
    if (!output->png) return exr_write(output->path, image, exr, error);
    Image shown;
    TRY(image_for_display(image, color, look, &shown, error));
    Status status = exr->place ? image_expand(&shown, exr->place, error) : STATUS_OK;
    if (status == STATUS_OK) status = png_write(output->path, &shown, 8, error);
    image_clear(&shown);
    return status;
}
