/* render_settings.c - how to render: what the scene says, and what options say instead.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "cli/render_run.h"

enum { LARGEST_SIDE = 65536 };

static uint32_t count_of(const Options *options, OptionKey key, uint32_t otherwise)
{
    return option_given(options, key) ? options->values[key].whole[0] : otherwise;
}

static Status merge_size(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    const SceneFilm *film = &run->input.scene->film;
    const uint32_t *given = options->values[OPTION_SIZE].whole;
    bool sized = option_given(options, OPTION_SIZE);
    uint32_t *sides[2] = {&run->settings.width, &run->settings.height};
    uint32_t wanted[2] = {sized ? given[0] : film->width, sized ? given[1] : film->height};
    double scale = option_given(options, OPTION_SCALE) ? options->values[OPTION_SCALE].number : 1;
    for (int i = 0; i < 2; i++) {
        double side = fmax(1, floor(wanted[i] * scale + 0.5));
        if (side > LARGEST_SIDE)
            return fail(error, STATUS_USAGE, "option '--scale': a %s of %.0f pixels is beyond %d",
                        i ? "height" : "width", side, LARGEST_SIDE);
        *sides[i] = (uint32_t)side;
    }
    return STATUS_OK;
}

static Status merge_crop(RenderRun *run, Error *error)
{
    RenderSettings *settings = &run->settings;
    if (!option_given(run->options, OPTION_CROP)) return STATUS_OK;
    memcpy(settings->crop, run->options->values[OPTION_CROP].whole, sizeof settings->crop);
    if (settings->crop[2] <= settings->width && settings->crop[3] <= settings->height) return STATUS_OK;
    return fail(error, STATUS_USAGE, "option '--crop': %u,%u is outside of the picture of %u x %u", settings->crop[2],
                settings->crop[3], settings->width, settings->height);
}

typedef struct CameraReport {
    SceneInput *input;
    const char *wanted;
} CameraReport;

static void report_camera(void *context)
{
    CameraReport *report = context;
    Diag *diag = &report->input->diag;
    const Scene *scene = report->input->scene;
    const char **names = ARENA_ARRAY(diag->arena, const char *, scene->n_cameras + 1);
    size_t n = 0;
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        if (scene->cameras[i].name) names[n++] = scene->cameras[i].name;
    Diagnostic *diagnostic =
        diag_report_nowhere(diag, D_UNKNOWN_CAMERA, "--camera: the scene has no camera '%s'", report->wanted);
    diag_suggest_or_list(diag, diagnostic, report->wanted, names, n, "cameras");
}

static Status merge_camera(RenderRun *run, Error *error)
{
    const Scene *scene = run->input.scene;
    const char *wanted = option_text(run->options, OPTION_CAMERA, NULL);
    if (!wanted) return STATUS_OK;
    for (uint32_t i = 0; i < scene->n_cameras; i++)
        if (scene->cameras[i].name && strcmp(scene->cameras[i].name, wanted) == 0) {
            run->settings.camera = i;
            return STATUS_OK;
        }
    CameraReport report = {&run->input, wanted};
    TRY(scene_input_guard(&run->input, report_camera, &report, error));
    error->text[0] = 0;
    return STATUS_SCENE;
}

/* The names of all that there is, for a message. */
static void list_aovs(char *text, size_t size)
{
    *text = 0;
    for (Aov aov = 0; aov < AOV_COUNT; aov++) {
        size_t used = strlen(text);
        snprintf(text + used, size - used, "%s%s",
                 aov == 0               ? ""
                 : aov + 1 == AOV_COUNT ? " and "
                                        : ", ",
                 aov_name(aov));
    }
}

static Status merge_aovs(RenderRun *run, Error *error)
{
    const char *rest = option_text(run->options, OPTION_AOV, NULL);
    run->settings.aovs = rest ? 0 : run->input.scene->film.aovs;
    while (rest) {
        size_t length = strcspn(rest, ",");
        Aov aov = aov_named(rest, length);
        char known[256];
        list_aovs(known, sizeof known);
        if (length == 3 && strncmp(rest, "all", length) == 0)
            run->settings.aovs = ((AovSet)1 << AOV_COUNT) - 1;
        else if (aov < AOV_COUNT)
            run->settings.aovs |= (AovSet)1 << aov;
        else
            return fail(error, STATUS_USAGE, "option '--aov': there is no '%.*s'; there are %s", (int)length, rest,
                        known);
        rest = rest[length] ? rest + length + 1 : NULL;
    }
    return STATUS_OK;
}

/* Samples are counted from 1 on the command line. */
static Status merge_range(RenderRun *run, Error *error)
{
    RenderSettings *settings = &run->settings;
    const uint32_t *range = run->options->values[OPTION_SAMPLE_RANGE].whole;
    run->slices = option_given(run->options, OPTION_SAMPLE_RANGE);
    settings->repeatable = run->slices || run->checkpoint.wanted;
    if (!run->slices) return STATUS_OK;
    bool by_noise = settings->noise > 0;
    if (render_is_uneven(settings))
        return fail(error, STATUS_USAGE,
                    "'--sample-range' takes the same samples of every pixel, and %s it depends on those before how "
                    "many a pixel has; '%s' gives all of them as many",
                    by_noise ? "with a noise" : "in an adaptive render", by_noise ? "--noise 0" : "--adaptive off");
    if (range[1] > settings->samples)
        return fail(error, STATUS_USAGE,
                    "option '--sample-range': sample %u is beyond the %u of the picture; '--spp' says how many it has",
                    range[1], settings->samples);
    settings->first_sample = range[0] - 1;
    settings->end_sample = range[1];
    return STATUS_OK;
}

Status render_settings_merge(RenderRun *run, Error *error)
{
    const Options *options = run->options;
    const SceneRender *render = &run->input.scene->render;
    const OptionValue *values = options->values;
    run->settings = (RenderSettings){
        .samples = count_of(options, OPTION_SPP, render->samples),
        .noise = option_given(options, OPTION_NOISE) ? values[OPTION_NOISE].number : render->noise,
        .adaptive = strcmp(option_text(options, OPTION_ADAPTIVE, render->adaptive ? "on" : "off"), "on") == 0,
        .time_limit_s = values[OPTION_TIME_LIMIT].number,
        .bounces = render->bounces,
        .seed = count_of(options, OPTION_SEED, render->seed),
        .caustics = render->caustics,
        .spreads = strcmp(option_text(options, OPTION_FIREFLIES, render->spreads ? "spread" : "keep"), "spread") == 0,
        .denoises = strcmp(option_text(options, OPTION_DENOISE, render->denoises ? "on" : "off"), "on") == 0,
        .no_absorption = option_given(options, OPTION_NO_ABSORPTION),
    };
    bool samples_given = option_given(options, OPTION_SPP) || render->samples_given;
    if (run->settings.noise > 0 && !samples_given) run->settings.samples = RENDER_MOST_SAMPLES;
    const char *caustics = option_text(options, OPTION_CAUSTICS, NULL);
    if (caustics && !scene_caustics_from_text(caustics, &run->settings.caustics))
        return fail(error, STATUS_USAGE, "option '--caustics': there is no choice '%s'", caustics);
    TRY(merge_range(run, error));
    TRY(merge_aovs(run, error));
    TRY(merge_size(run, error));
    TRY(merge_crop(run, error));
    TRY(render_merge_pixel(run, error));
    return merge_camera(run, error);
}
