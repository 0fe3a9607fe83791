/* cmd_view.c - the command view: a scene-linear picture as a display shows it, or several on a sheet.
 * SPDX-License-Identifier: Apache-2.0 */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "base/file.h"
#include "base/num.h"
#include "cli/commands.h"
#include "cli/preview.h"
#include "base/suggest.h"
#include "image/layer.h"
#include "image/relight.h"
#include "image/sheet.h"
#include "scene/aov.h"

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

/* A picture, or a layer of it. */
typedef struct Viewed {
    Image image;
    bool shown;     /* as a display shows it, not scene-linear */
    ColorLook look; /* what its file says of how it is shown, and then how it is shown */
} Viewed;

static Status read_picture(const char *path, Viewed *viewed, Error *error)
{
    TRY(image_read_linear(path, &viewed->image, error));
    viewed->look = output_read_look(path);
    return STATUS_OK;
}

/* What the channels of an AOV are as a layer: "N" of "N.X|N.Y|N.Z", "Z" of "Z". */
static void layer_of_aov(Aov aov, char layer[LAYER_NAME_SIZE])
{
    const char *channels = aov_channels(aov);
    size_t length = strcspn(channels, "|*");
    while (channels[length] && length > 0 && channels[length] != '.') length--; /* a single channel is the layer */
    snprintf(layer, LAYER_NAME_SIZE, "%.*s", (int)length, channels);
}

/* What a layer is asked for by: the name of its AOV, if it is one. Of those of mattes each has its own. */
static const char *asked_name(const char *layer)
{
    for (Aov aov = 0; aov < AOV_COUNT; aov++) {
        char name[LAYER_NAME_SIZE];
        if (aov == AOV_CRYPTOMATTE || aov == AOV_BEHIND_CRYPTOMATTE) continue;
        layer_of_aov(aov, name);
        if (strcmp(name, layer) == 0) return aov_name(aov);
    }
    return layer;
}

/* The names of the layers whose channels' names begin so, each once, in `words`, which has room for as many as there are channels;
 * those that are no AOV in `names`. Returns how many. */
static size_t list_layers(const Image *image, const char *front, char (*names)[LAYER_NAME_SIZE], const char **words)
{
    size_t n = 0;
    for (uint32_t i = 0; i < image->n_channels; i++) {
        if (strncmp(image->names[i], front, strlen(front)) != 0) continue;
        bool known = false;
        layer_of_channel(image, i, names[n]);
        words[n] = asked_name(names[n]);
        for (size_t k = 0; k < n && !known; k++) known = strcmp(words[k], words[n]) == 0;
        n += !known;
    }
    return n;
}

static Status fail_to_find(const Image *image, const char *asked, const char *layer, Error *error)
{
    size_t size = image->n_channels * sizeof *image->names;
    char(*names)[LAYER_NAME_SIZE] = malloc(size), front[LAYER_NAME_SIZE + 1];
    const char **words = malloc(image->n_channels * sizeof *words);
    Buf list = {0};
    Status status = STATUS_INPUT;
    if (names && words) {
        snprintf(front, sizeof front, "%s.", layer);
        size_t n_parts = list_layers(image, front, names, words),
               n = n_parts ? n_parts : list_layers(image, "", names, words);
        const char *near = n_parts ? NULL : suggest_nearest(asked, words, n);
        for (size_t i = 0; i < n; i++) buf_format(&list, "%s%s", i ? ", " : "", words[i]);
        if (near)
            (void)fail(error, status, "the picture has no layer '%s'; did you mean '%s'?", asked, near);
        else if (n_parts)
            (void)fail(error, status, "the channels of '%s' are no colours; name one of them: %s", asked,
                       buf_text(&list));
        else
            (void)fail(error, status, "the picture has no layer '%s', only: %s", asked, buf_text(&list));
    } else {
        status = fail_memory(error, size, "the names of layers");
    }
    buf_clear(&list);
    free(words);
    free(names);
    return status;
}

/* The layer takes the picture's place. */
static Status choose_layer(const char *name, const Talk *talk, Viewed *viewed, Error *error)
{
    char in_file[LAYER_NAME_SIZE];
    Layer layer;
    Aov aov = aov_named(name, strlen(name));
    if (aov == AOV_CRYPTOMATTE || aov == AOV_BEHIND_CRYPTOMATTE)
        return fail(error, STATUS_USAGE,
                    "the mattes of '%s' are for programs that composite; 'object' and 'medium' are layers to look at",
                    name);
    snprintf(in_file, sizeof in_file, "%s", name);
    if (aov != AOV_COUNT) layer_of_aov(aov, in_file);
    if (!layer_is_in(&viewed->image, in_file)) return fail_to_find(&viewed->image, name, in_file, error);
    TRY(layer_of(&viewed->image, in_file, &layer, error));
    const bool light = strncmp(in_file, LAYER_LIGHTS, strlen(LAYER_LIGHTS)) == 0;
    const char *holes = layer.has_holes ? "; dark blue is where nothing is" : "";
    if (layer.kind == LAYER_NUMBERS && layer.white > layer.black)
        talk_remark(talk, "%s: black is %.4g, white %.4g%s%s", name, (double)layer.black, (double)layer.white,
                    layer.held ? " and more" : "", holes);
    else if (layer.kind == LAYER_NUMBERS)
        talk_remark(talk, "%s: all of it is %.4g%s", name, (double)layer.black, holes);
    image_clear(&viewed->image);
    if (!light) viewed->look = (ColorLook){0}; /* colours of surfaces */
    viewed->image = layer.image;
    viewed->shown = layer.kind != LAYER_COLOR;
    return STATUS_OK;
}

/* An automatic exposure is that of the whole picture, also where a part of it is viewed. */
static Status choose_part(const Options *options, const Talk *talk, bool says_exposure, Viewed *viewed, Error *error)
{
    Image *image = &viewed->image;
    uint32_t crop[4];
    viewed->look = output_look(options, &viewed->look);
    if (!viewed->shown && says_exposure) output_say_exposure(talk, image, &viewed->look);
    if (!viewed->shown) viewed->look = output_look_for(image, &viewed->look);
    if (!option_given(options, OPTION_VIEW_CROP)) return STATUS_OK;
    TRY(option_crop(options, OPTION_VIEW_CROP, image->width, image->height, crop, error));
    image_crop(image, crop);
    return STATUS_OK;
}

/* What a display shows of it, into *shown; the picture may be empty then. */
static Status bring_to_display(const ColorConfig *config, Viewed *viewed, Image *shown, Error *error)
{
    if (!viewed->shown) return image_for_display(&viewed->image, config, &viewed->look, shown, error);
    *shown = viewed->image;
    viewed->image = (Image){0};
    return STATUS_OK;
}

static Status write_png(const Options *options, const ColorConfig *config, Viewed *viewed, const char *path,
                        Error *error)
{
    Image shown = {0};
    Status status = bring_to_display(config, viewed, &shown, error);
    if (status == STATUS_OK) status = png_write(path, &shown, option_is(options, OPTION_BITS, "16") ? 16 : 8, error);
    image_clear(&shown);
    return status;
}

static Status show(const Options *options, const ColorConfig *config, const Viewed *viewed, const char *where,
                   Error *error)
{
    Preview preview;
    Status status = preview_open(where, file_name(options->operands[0]), &preview, error);
    if (status == STATUS_OK && preview.kind == PREVIEW_FILE)
        status =
            fail(error, STATUS_USAGE, "option '--preview' of 'view' takes term or tev; '-o %s' writes a file", where);
    if (status == STATUS_OK && preview.kind == PREVIEW_TERMINAL && viewed->shown)
        status = terminal_preview_show(&preview.terminal, &viewed->image, error);
    else if (status == STATUS_OK && options->n_operands > 1)
        status =
            fail(error, STATUS_USAGE, "'--preview %s' shows one picture, and a sheet in the terminal (term)", where);
    else if (status == STATUS_OK)
        status = preview_show(&preview, &viewed->image, NULL, config, &viewed->look, error);
    preview_close(&preview);
    return status;
}

/* GROUP=FACTOR, of one number or three; the name is put into *name. */
static Status read_light(const char *text, char name[IMAGE_NAME_SIZE], Relight *change, Error *error)
{
    const char *equals = strchr(text, '='), *end = NULL;
    const size_t length = equals ? (size_t)(equals - text) : 0;
    double factor[3];
    if (equals) end = num_parse_list(equals + 1, factor, 3);
    if (equals && !end) {
        end = num_parse_list(equals + 1, factor, 1);
        factor[1] = factor[2] = factor[0];
    }
    bool good = length > 0 && length < IMAGE_NAME_SIZE && end && !*end;
    for (int i = 0; i < 3 && good; i++) {
        good = factor[i] >= 0 && factor[i] <= (double)FLT_MAX;
        change->factor[i] = (float)factor[i];
    }
    if (!good)
        return fail(error, STATUS_USAGE,
                    "'--light %s' is not GROUP=FACTOR, with one number of 0 or more, or three, for red, green and "
                    "blue: key=.5, or key=1,.8,.6",
                    text);
    snprintf(name, IMAGE_NAME_SIZE, "%.*s", (int)length, text);
    change->group = name;
    return STATUS_OK;
}

static Status relight(const OptionValue *lights, Image *image, Error *error)
{
    const size_t n = lights->n_items;
    Relight *changes = calloc(n, sizeof *changes);
    char(*names)[IMAGE_NAME_SIZE] = calloc(n, sizeof *names);
    Status status = changes && names ? STATUS_OK : fail_memory(error, n * sizeof *names, "lights");
    for (size_t i = 0; i < n && status == STATUS_OK; i++)
        status = read_light(lights->items[i], names[i], &changes[i], error);
    if (status == STATUS_OK) status = image_relight(image, changes, n, error);
    free(names);
    free(changes);
    return status;
}

/* A picture as the options want it. */
static Status open_picture(const Options *options, const Talk *talk, const char *file, bool says_exposure,
                           Viewed *viewed, Error *error)
{
    const char *layer = option_text(options, OPTION_LAYER, NULL);
    TRY(read_picture(file, viewed, error));
    if (option_given(options, OPTION_LIGHT)) TRY(relight(&options->values[OPTION_LIGHT], &viewed->image, error));
    if (layer) TRY(choose_layer(layer, talk, viewed, error));
    return choose_part(options, talk, says_exposure, viewed, error);
}

/* The name of a file without its folder and its ending, where that tells it from all others; else as it is given. */
static char *caption_of(const Options *options, size_t number)
{
    const char *path = options->operands[number], *name = file_name(path);
    size_t length = file_stem_length(name);
    bool alone = length > 0;
    for (size_t i = 0; i < options->n_operands; i++) {
        const char *other = file_name(options->operands[i]);
        alone = alone && (i == number || file_stem_length(other) != length || strncmp(other, name, length) != 0);
    }
    return alone ? strndup(name, length) : strdup(path);
}

/* One of several: what is wrong with it names it. */
static Status open_for_sheet(const Options *options, const ColorConfig *config, const Talk *talk, const char *file,
                             Image *shown, Error *error)
{
    Viewed one = {.shown = false};
    Error own;
    Status status = open_picture(options, talk, file, false, &one, &own);
    if (status == STATUS_OK) status = bring_to_display(config, &one, shown, &own);
    image_clear(&one.image);
    if (status == STATUS_OK) return STATUS_OK;
    return strstr(own.text, file) ? fail(error, status, "%s", own.text)
                                  : fail(error, status, "'%s': %s", file, own.text);
}

/* All of the pictures beside each other, each as a display shows it by itself. */
static Status open_sheet(const Options *options, const ColorConfig *config, const Talk *talk, Viewed *viewed,
                         Error *error)
{
    size_t n = options->n_operands;
    SheetPicture *pictures = calloc(n, sizeof *pictures);
    char **captions = calloc(n, sizeof *captions);
    Status status = pictures && captions ? STATUS_OK : fail_memory(error, n * sizeof *pictures, "a sheet");
    for (size_t i = 0; i < n && status == STATUS_OK; i++) {
        pictures[i].caption = captions[i] = caption_of(options, i);
        status = captions[i] ? open_for_sheet(options, config, talk, options->operands[i], &pictures[i].image, error)
                             : fail_memory(error, strlen(options->operands[i]), "a name");
    }
    uint32_t columns = options->values[OPTION_COLUMNS].whole[0];
    if (status == STATUS_OK) status = sheet_new(pictures, n, columns, &viewed->image, error);
    viewed->shown = true;
    for (size_t i = 0; i < n && pictures && captions; i++) {
        image_clear(&pictures[i].image);
        free(captions[i]);
    }
    free(pictures);
    free(captions);
    return status;
}

static Status view_files(const Options *options, const ColorConfig *config, const Talk *talk, const char *path,
                         Error *error)
{
    Viewed viewed = {.shown = false};
    const char *where = option_text(options, OPTION_VIEW_PREVIEW, NULL);
    Status status = options->n_operands > 1
                        ? open_sheet(options, config, talk, &viewed, error)
                        : open_picture(options, talk, options->operands[0], path != NULL, &viewed, error);
    if (status == STATUS_OK && where) status = show(options, config, &viewed, where, error);
    if (status == STATUS_OK && path) status = write_png(options, config, &viewed, path, error);
    image_clear(&viewed.image);
    return status;
}

Status cmd_view(const Options *options, const Talk *talk, Error *error)
{
    bool list = option_given(options, OPTION_LIST);
    const char *path = option_text(options, OPTION_VIEW_OUTPUT, NULL);
    if (!list && options->n_operands == 0) return fail(error, STATUS_USAGE, "'view' needs FILE");
    if (!list) TRY(check_output(path, option_text(options, OPTION_VIEW_PREVIEW, NULL), error));
    if (option_given(options, OPTION_COLUMNS) && options->n_operands < 2)
        return fail(error, STATUS_USAGE, "'--columns' is about a sheet of several pictures");
    for (size_t i = 0; !list && i < options->n_operands; i++) {
        OutputClaim claims[] = {{options->operands[i], "what is viewed"}, {path, "the output"}};
        TRY(output_check_claims(claims, COUNT_OF(claims), error));
    }
    ColorConfig *config = NULL;
    TRY(color_config_open(option_text(options, OPTION_OCIO, NULL), &config, error));
    Status status = list ? list_all(config, error) : view_files(options, config, talk, path, error);
    color_config_close(config);
    return status;
}
