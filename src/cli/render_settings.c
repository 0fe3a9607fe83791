/* render_settings.c - how to render: what the scene says, and what options say instead.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "cli/render_run.h"
#include "cli/viewpoint.h"
#include "base/suggest.h"
#include "lang/habits.h"

static uint32_t count_of(const Options *options, OptionKey key, uint32_t otherwise)
{
    return option_given(options, key) ? options->values[key].whole[0] : otherwise;
}

static Status merge_crop(RenderRun *run, Error *error)
{
    RenderSettings *settings = &run->settings;
    if (!option_given(run->options, OPTION_CROP)) return STATUS_OK;
    return option_crop(run->options, OPTION_CROP, settings->width, settings->height, settings->crop, error);
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

/* What was meant by a name that is none, by its spelling or by what other programs call it. */
static Status refuse_aov(const char *name, Error *error)
{
    const char *names[AOV_COUNT], *meant = habit_choice("aovs", name), *instead = habit_instead("aovs", name);
    for (Aov aov = 0; aov < AOV_COUNT; aov++) names[aov] = aov_name(aov);
    if (!meant && instead) return fail(error, STATUS_USAGE, "option '--aov': there is no '%s'; %s", name, instead);
    if (!meant) meant = suggest_nearest(name, names, COUNT_OF(names));
    if (meant) return fail(error, STATUS_USAGE, "option '--aov': there is no '%s'; did you mean '%s'?", name, meant);
    char known[512];
    list_aovs(known, sizeof known);
    return fail(error, STATUS_USAGE, "option '--aov': there is no '%s'; there are %s", name, known);
}

static Status merge_aovs(RenderRun *run, Error *error)
{
    const char *rest = option_text(run->options, OPTION_AOV, NULL);
    run->settings.aovs = rest ? 0 : run->input.scene->film.aovs;
    while (rest) {
        size_t length = strcspn(rest, ",");
        Aov aov = aov_named(rest, length);
        char name[64];
        snprintf(name, sizeof name, "%.*s", (int)length, rest);
        if (length == 3 && strncmp(rest, "all", length) == 0)
            run->settings.aovs = AOV_SET_ALL;
        else if (aov < AOV_COUNT)
            run->settings.aovs |= (AovSet)1 << aov;
        else
            return refuse_aov(name, error);
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
        .exposure = render_look(run).exposure,
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
    TRY(viewpoint_size(&run->input, &run->settings.width, &run->settings.height, error));
    TRY(merge_crop(run, error));
    TRY(render_merge_pixel(run, error));
    return viewpoint_camera(&run->input, &run->settings.camera, error);
}
