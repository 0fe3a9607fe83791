/* render_report.c - what is said of a finished render: warnings, statistics, and the closing line.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "base/file.h"
#include "cli/render_run.h"
#include "cli/viewpoint.h"
#include "render/brightness.h"

static double per_million(uint64_t n, uint64_t of)
{
    return of ? 1e6 * (double)n / (double)of : 0;
}

/* ---- how bright the picture is ---- */

static ColorLook look_of(const RenderRun *run)
{
    ColorLook look = render_look(run);
    return output_look_for(&run->image, &look);
}

/* Something shows the picture as a display does: an EXR file is for those who choose an exposure. */
static bool is_displayed(const RenderRun *run)
{
    bool png = false;
    for (size_t i = 0; i < run->outputs.n; i++) png |= run->outputs.items[i].png;
    return png || preview_is_for_display(&run->preview);
}

/* The first file of a kind that was written; NULL. */
static const char *file_of(const RenderRun *run, bool png)
{
    for (size_t i = 0; i < run->outputs.n; i++)
        if (run->outputs.items[i].png == png && !output_is_stream(run->outputs.items[i].path))
            return run->outputs.items[i].path;
    return NULL;
}

/* stops: more than it is shown by. */
static void remark_exposure(const RenderRun *run, const char *what, int stops)
{
    const char *exr = file_of(run, false), *png = file_of(run, true), *more = stops > 0 ? "more" : "less";
    double exposure = look_of(run).exposure.stops + stops;
    char factor[24];
    snprintf(factor, sizeof factor, abs(stops) < 20 ? "%.0f" : "%.3g", exp2(abs(stops)));
    if (exr)
        talk_remark(run->talk, "%s: give it %s times %s light, or: meniscus view %s -o %s --exposure %g", what, factor,
                    more, exr, png ? png : "FILE.png", exposure);
    else
        talk_remark(run->talk, "%s: give it %s times %s light, or film { exposure = %g }", what, factor, more,
                    exposure);
}

/* From end to end, in metres, without what has no end: what there is, and the camera that looks at it. */
static double size_of_scene_m(const RenderRun *run)
{
    const Scene *scene = run->input.scene;
    Box3 all = scene_camera_bounds(scene, &scene->cameras[run->settings.camera]);
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        Box3 box = scene_object_bounds(scene, &scene->objects[i], NULL);
        if (!box3_is_empty(box) && !box3_is_unbounded(box)) all = box3_union(all, box);
    }
    return box3_is_empty(all) ? 0 : vec3_length(vec3_sub(all.max, all.min)) * scene->unit_m;
}

/* Lengths that were meant in millimetres and are metres, as nobody said, or said by habit: a lamp of a table lights a stadium. */
static void remark_unit(const RenderRun *run, bool lost)
{
    const Scene *scene = run->input.scene;
    const double large_m = scene->has_unit ? 50 : 10;
    if (scene->unit_m != 1 || (scene->has_unit && !lost) || !(scene->n_lights > 0)) return;
    double size_m = size_of_scene_m(run);
    if (size_m >= large_m)
        talk_remark(run->talk,
                    "the picture is nearly black, and the first line of its scene %s, and it is %.3g m across, which a "
                    "lamp hardly lights; if millimetres are meant, write: meniscus 1.0 unit mm",
                    scene->has_unit ? "has 'unit m': lengths are metres" : "has no unit: lengths are metres then",
                    size_m);
}

/* Half of the picture that is as bright as two whites, or a third as four: less is what lamps and skies have. In stops above
 * white, and of which part; 0: it is not so. */
static int clipped_stops(const Brightness *brightness, const char **part)
{
    enum { HALF = 1, THIRD = 2 };
    int half = ilogb(brightness_at(brightness, 0.5)), third = ilogb(brightness_at(brightness, 2.0 / 3));
    *part = half >= HALF ? "half" : "a third";
    return half >= HALF ? half : third >= THIRD ? third : 0;
}

/* Nothing of it is to be seen as it is: nearly all is darker than the first step of a display, or brighter than white. That is
 * said of an EXR file alone, too. */
static bool is_lost(const Brightness *brightness, double nearly_all)
{
    const double first_step = 0.5 / 255 / 12.92;
    return brightness_at(brightness, nearly_all) < first_step || brightness_at(brightness, 1 - nearly_all) >= 1;
}

/* The commonest reason of white is a lamp of so many watts, as in a room, above a table of centimetres; of black one of an
 * intensity of 1 that is metres away. Not of frames behind the first, which may fade. What is meant to be dark has a bright
 * spot somewhere. */
static void remark_brightness(const RenderRun *run)
{
    const double black = 1.0 / 64 /* 6 of 255 on a display */, dark = 1.0 / 128, nearly_all = 0.998, grey = 0.18;
    enum { LEAST_PIXELS = 64 };
    if (run->n_rendered) return;
    Brightness brightness = brightness_find(&run->image, look_of(run).exposure.stops);
    if (brightness.n < LEAST_PIXELS || !(brightness.mean > 0)) return;
    char what[200];
    const char *part;
    int clipped = clipped_stops(&brightness, &part), tenth = ilogb(brightness_at(&brightness, 0.9));
    bool is_dark = run->stats.samples && !scene_catches(run->input.scene) && brightness.mean < dark &&
                   brightness_at(&brightness, nearly_all) < black;
    bool lost = is_lost(&brightness, nearly_all), speaks = lost || is_displayed(run);
    if (speaks && clipped > 0) {
        /* where a tenth is brighter by far, what is lit is that, and the rest its surroundings */
        const bool by_far = tenth > clipped + 2;
        char and_a_tenth[40] = "";
        if (by_far) snprintf(and_a_tenth, sizeof and_a_tenth, ", and a tenth %d", tenth);
        snprintf(what, sizeof what, "%s of the picture is %d stop%s or more above white%s", part, clipped,
                 plural((unsigned)clipped), and_a_tenth);
        remark_exposure(run, what, by_far ? -tenth : -clipped - 1);
    } else if (speaks && is_dark) {
        snprintf(what, sizeof what, "the picture is nearly black: its mean luminance is %.2g, where white is 1",
                 brightness.mean);
        remark_exposure(run, what, (int)lrint(log2(grey / brightness.mean)));
    }
    if (is_dark) remark_unit(run, lost);
}

static bool is_black(const Image *image, bool and_clear)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    size_t n_pixels = (size_t)image->width * image->height, n_names = COUNT_OF(names) - !and_clear;
    for (size_t k = 0; k < n_names; k++) {
        int channel = image_channel(image, names[k]);
        for (size_t i = 0; channel >= 0 && i < n_pixels; i++)
            if (image->pixels[i * image->n_channels + (unsigned)channel] != 0) return false;
    }
    return true;
}

/* Not where the scene has no light at all, which is said before; nor of frames behind the first, which may fade. */
static void warn_of_black(const RenderRun *run)
{
    const bool catches = scene_catches(run->input.scene); /* shadows, which are black, but cover something */
    if (run->n_rendered || run->stats.samples == 0 || diag_has(&run->input.diag, D_NO_LIGHT) ||
        !is_black(&run->image, catches))
        return;
    if (catches) {
        talk_warning(run->talk,
                     "the picture is empty: no thing is in it, and none changes the light of its shadow catchers");
        return;
    }
    const RenderSettings *settings = &run->settings;
    Buf view = {0};
    viewpoint_add_options(&run->input, settings->width, settings->height, &view);
    const char *why = is_black(&run->image, true)
                          ? "the camera looks past all that there is, and around it nothing shines"
                          : "the camera is inside of an opaque object, or no light comes to what it looks at, or is "
                            "found by so few samples";
    talk_warning(run->talk,
                 "all of the picture is black: %s; 'meniscus check %s%s --pixel %u,%u' says what is in front of it",
                 why, run->input.path, buf_text(&view), (unsigned)settings->width / 2, (unsigned)settings->height / 2);
    buf_clear(&view);
}

/* A number with so many digits, and all of those before the point: never 1e+03. */
static void add_digits(Buf *line, double value, int digits)
{
    if (value >= pow(10, digits) - 0.5)
        buf_format(line, "%.0f", value);
    else
        buf_format(line, "%.*g", digits, value);
}

/* Of a mean that is above what was aimed at: so few samples are judged by nobody, or they did not do. */
static void remark_noise(const RenderRun *run)
{
    const RenderStats *stats = &run->stats;
    uint32_t samples = run->settings.samples;
    if (stats->stopped || !(run->settings.noise > 0) || !(stats->noise > run->settings.noise)) return;
    Buf noise = {0};
    add_digits(&noise, 100 * stats->noise, 2);
    talk_remark(run->talk,
                "a noise of %.3g %% was aimed at, and %s %% was reached, as no pixel gets more than %u sample%s: "
                "'--spp' allows more",
                100 * run->settings.noise, buf_text(&noise), samples, plural(samples));
    buf_clear(&noise);
}

static bool disperses(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_media; i++)
        if (scene->media[i].disperses) return true;
    return false;
}

/* Of what is smooth, and may be a guess. Not of frames behind the first, which say the same. */
static void remark_spread(const RenderRun *run)
{
    const double much = 0.15, most = 0.5;
    const uint32_t few = 32; /* of each pixel: of what clear things mirror, a twentieth, one or two samples tell */
    const RenderStats *stats = &run->stats;
    uint32_t samples = run->settings.samples;
    if (run->n_rendered || stats->stopped || !(stats->spread_light > much)) return;
    Buf light = {0}, usual = {0};
    add_digits(&light, 100 * stats->spread_light, 2);
    if (samples < few)
        buf_format(&usual, ", which is usual where each pixel has no more than %u of them", (unsigned)samples);
    talk_remark(
        run->talk,
        "%s %% of the light came by few samples%s, and was spread over what is around them: how bright that is, "
        "and of which colour, is a guess so far; more samples ('--spp') make it sure%s, and '--fireflies keep' "
        "shows what was found%s",
        buf_text(&light), buf_text(&usual),
        run->settings.caustics == CAUSTICS_OFF ? ", '--caustics on' looks where such light is" : "",
        stats->spread_one_colored > most && disperses(run->input.scene)
            ? "; most of it was of single colours, as glass bends each another way: where no rainbows are to be "
              "seen, '--set render.dispersion=false' is less noisy"
            : "");
    buf_clear(&light);
    buf_clear(&usual);
}

void render_warn(const RenderRun *run)
{
    const RenderStats *stats = &run->stats;
    const Talk *talk = run->talk;
    unsigned long long faults = stats->nesting_faults, limit = stats->silent_limit, bad = stats->bad_samples,
                       saturated = stats->saturated_samples;
    if (stats->searching)
        talk_warning(
            talk, "the time was over while photons for caustics were on their way: the picture is one without these, "
                  "and its samples are not kept");
    if (faults)
        talk_warning(
            talk,
            "%llu nesting fault%s, %.3g per million crossings: a surface was left that was never entered, or entered "
            "twice; 'meniscus check' names meshes that cross themselves and what is too small for its place, which do "
            "that; a camera or a light within rounding of a surface does, too",
            faults, plural(faults), per_million(faults, stats->crossings));
    if (limit)
        talk_warning(talk, "%llu path%s gave up after too many surfaces between equal media", limit, plural(limit));
    if (bad) talk_warning(talk, "%llu sample%s without a finite value left out", bad, plural(bad));
    remark_noise(run);
    remark_spread(run);
    remark_brightness(run);
    warn_of_black(run);
    if (saturated)
        talk_warning(talk, "%llu sample%s brighter than the film can hold, and held at its limit", saturated,
                     plural(saturated));
}

static void list_outputs(const OutputList *outputs, Buf *text)
{
    for (size_t i = 0; i < outputs->n; i++) {
        const char *path = outputs->items[i].path;
        buf_add(text, i == 0 ? "" : i + 1 == outputs->n ? " and " : ", ");
        buf_add(text, strcmp(path, "-") == 0 ? "standard output" : path);
    }
}

static void summarize_as_json(const RenderRun *run, double seconds)
{
    Buf line = {0};
    JsonWriter json = talk_event_begin(&line, "done");
    if (run->plan.numbered) json_add_whole(&json, "frame", run->input.scene->frame);
    json_key(&json, "outputs");
    json_begin_array(&json);
    for (size_t i = 0; i < run->outputs.n; i++) json_text(&json, run->outputs.items[i].path);
    json_end(&json);
    json_add_whole(&json, "width", run->settings.width);
    json_add_whole(&json, "height", run->settings.height);
    json_add_whole(&json, "samples", run->stats.samples);
    json_add_number(&json, "meanSamples", run->stats.mean_samples);
    json_add_number(&json, "noise", run->noise < 0 ? (double)NAN : run->noise);
    json_add_truth(&json, "stopped", run->stats.stopped);
    json_add_number(&json, "lightSpread", run->stats.spread_light);
    json_add_number(&json, "exposure", look_of(run).exposure.stops);
    json_add_whole(&json, "nestingFaults", run->stats.nesting_faults);
    json_add_number(&json, "seconds", seconds);
    talk_event_end(&json);
}

/* 16 to 4096 samples, 87.1 on average, noise 0.94 % */
static void summarize_noise(const RenderRun *run, Buf *line)
{
    const RenderStats *stats = &run->stats;
    double pixels = stats->mean_samples > 0 ? (double)stats->paths / stats->mean_samples : 0;
    buf_format(line, "%u to %u samples, ", stats->samples, stats->most_samples);
    add_digits(line, stats->mean_samples, 3);
    buf_add(line, " on average");
    if (stats->noise >= 0) {
        buf_add(line, ", noise ");
        add_digits(line, 100 * stats->noise, 2);
        buf_add(line, " %");
    }
    if (stats->noisy_pixels && pixels > 0) {
        buf_add(line, ", ");
        add_digits(line, 100 * (double)stats->noisy_pixels / pixels, 2);
        buf_format(line, " %% of the pixels above %.3g %% at %u sample%s", 100 * run->settings.noise,
                   run->settings.samples, plural(run->settings.samples));
    }
}

void render_summarize(const RenderRun *run)
{
    const RenderStats *stats = &run->stats;
    double seconds = clock_now_s() - run->start_s;
    if (run->talk->quiet) return;
    if (run->talk->json) {
        summarize_as_json(run, seconds);
        return;
    }
    Buf line = {0};
    char time[32], total[32] = "";
    seconds_print(seconds, time);
    const RenderSettings *settings = &run->settings;
    uint32_t wanted = (settings->end_sample ? settings->end_sample : settings->samples) - settings->first_sample;
    if (stats->stopped) snprintf(total, sizeof total, " of %u", wanted);
    buf_add(&line, "wrote ");
    list_outputs(&run->outputs, &line);
    buf_format(&line, " (%u x %u, ", run->settings.width, run->settings.height);
    if (stats->samples == 0 && stats->mean_samples < 1)
        buf_format(&line, "one sample in %.3g %% of the pixels", 100 * stats->mean_samples);
    else if (render_is_uneven(settings))
        summarize_noise(run, &line);
    else
        buf_format(&line, "%u%s sample%s", stats->samples, total, plural(stats->stopped ? wanted : stats->samples));
    if (run->slices)
        buf_format(&line, ", %u to %u of %u", settings->first_sample + 1, settings->end_sample, settings->samples);
    if (stats->spread_samples) {
        buf_add(&line, ", ");
        add_digits(&line, 100 * stats->spread_light, 2);
        buf_add(&line, " % of the light spread");
    }
    if (run->settings.denoises) buf_add(&line, ", denoised");
    if (render_look(run).exposure.automatic && is_displayed(run))
        buf_format(&line, ", exposure %g", look_of(run).exposure.stops);
    buf_format(&line, ", %llu nesting fault%s) in %s\n", (unsigned long long)stats->nesting_faults,
               plural(stats->nesting_faults), time);
    bool stays = stats->stopped || run->checkpoint.stays;
    if (stays && run->checkpoint.path && render_state_is_worth_keeping(&run->state))
        buf_format(&line, "%s is there to go on from with --resume\n", run->checkpoint.path);
    talk_write(&line);
    buf_clear(&line);
}

static void count_frames(Buf *line, uint32_t n)
{
    if (n == 0)
        buf_add(line, "no frame");
    else
        buf_format(line, "%u frame%s", n, plural(n));
}

void render_summarize_frames(const RenderRun *run)
{
    double seconds = clock_now_s() - run->command_start_s;
    uint32_t rendered = run->n_rendered, skipped = run->n_skipped;
    Buf line = {0};
    char time[32];
    if (run->talk->quiet) return;
    if (run->talk->json) {
        JsonWriter json = talk_event_begin(&line, "frames");
        json_add_whole(&json, "wanted", run->frames.n);
        json_add_whole(&json, "rendered", rendered);
        json_add_whole(&json, "skipped", skipped);
        json_add_number(&json, "seconds", seconds);
        talk_event_end(&json);
        return;
    }
    seconds_print(seconds, time);
    buf_add(&line, "rendered ");
    count_frames(&line, rendered);
    if (rendered + skipped < run->frames.n) buf_format(&line, " of %u", run->frames.n);
    buf_format(&line, " in %s", time);
    if (skipped) buf_format(&line, "; %u %s there already", skipped, skipped == 1 ? "was" : "were");
    if (run->frames.n == 0) buf_add(&line, "; this share holds none");
    buf_add(&line, "\n");
    talk_write(&line);
    buf_clear(&line);
}

/* ---- --stats ---- */

uint32_t render_count_shining(const Scene *scene)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < scene->n_objects; i++)
        n += scene->objects[i].part_of == SCENE_NONE && scene_shines(scene, i);
    return n;
}

static void print_stats_json(const RenderRun *run, Buf *out)
{
    const RenderStats *stats = &run->stats;
    const SceneInput *input = &run->input;
    JsonWriter json = json_writer(out, true);
    json_begin_object(&json);
    json_add_text(&json, "version", MEN_VERSION);
    json_add_text(&json, "scene", input->path);
    if (run->plan.numbered) json_add_whole(&json, "frame", input->scene->frame);
    json_add_whole(&json, "width", run->settings.width);
    json_add_whole(&json, "height", run->settings.height);
    json_add_whole(&json, "seed", run->settings.seed);
    json_add_text(&json, "nesting", nest_policy_text(input->compiled->order.policy));
    json_add_whole(&json, "samples", stats->samples);
    json_add_whole(&json, "mostSamples", stats->most_samples);
    json_add_number(&json, "meanSamples", stats->mean_samples);
    json_add_whole(&json, "samplesWanted", run->settings.samples);
    json_add_truth(&json, "stopped", stats->stopped);
    json_add_number(&json, "noise", run->noise < 0 ? (double)NAN : run->noise);
    json_add_number(&json, "noiseWanted", run->settings.noise);
    json_add_whole(&json, "noisyPixels", stats->noisy_pixels);
    json_add_whole(&json, "objects", input->scene->n_objects);
    json_add_whole(&json, "hulls", input->compiled->n_hulls);
    json_add_whole(&json, "media", input->scene->n_media);
    json_add_whole(&json, "lights", input->scene->n_lights);
    json_add_whole(&json, "objectsThatShine", render_count_shining(input->scene));
    json_add_whole(&json, "geometryBytes", rtc_scene_bytes(input->compiled->rtc));
    json_add_whole(&json, "threads", pool_threads(run->pool));
    json_add_whole(&json, "paths", stats->paths);
    json_add_whole(&json, "rays", stats->rays);
    json_add_whole(&json, "crossings", stats->crossings);
    json_add_whole(&json, "silentCrossings", stats->silent_crossings);
    json_add_whole(&json, "nestingFaults", stats->nesting_faults);
    json_add_number(&json, "nestingFaultsPerMillionCrossings", per_million(stats->nesting_faults, stats->crossings));
    json_add_whole(&json, "silentLimit", stats->silent_limit);
    json_add_whole(&json, "badSamples", stats->bad_samples);
    json_add_whole(&json, "saturatedSamples", stats->saturated_samples);
    json_add_whole(&json, "samplesSpread", stats->spread_samples);
    json_add_number(&json, "lightSpread", stats->spread_light);
    json_add_truth(&json, "denoised", run->settings.denoises);
    json_add_whole(&json, "photons", stats->guide.followed);
    json_add_whole(&json, "photonsLanded", stats->guide.landed);
    json_add_whole(&json, "guideBytes", stats->guide.bytes);
    json_add_number(&json, "guideCpuSeconds", stats->guide.cpu_seconds);
    json_add_number(&json, "renderSeconds", stats->seconds);
    json_add_number(&json, "cpuSeconds", stats->cpu_seconds);
    json_add_number(&json, "totalSeconds", clock_now_s() - run->start_s);
    json_end(&json);
    buf_add(out, "\n");
}

static void print_stats_text(const RenderRun *run, Buf *out)
{
    const RenderStats *stats = &run->stats;
    double crossings = stats->crossings ? (double)stats->crossings : 1, seconds = fmax(stats->seconds, 1e-9);
    buf_format(out, "paths              %llu\n", (unsigned long long)stats->paths);
    buf_format(out, "rays               %llu, %.3g million a second\n", (unsigned long long)stats->rays,
               (double)stats->rays / seconds * 1e-6);
    buf_format(out, "crossings          %llu, %.1f %% of them silent\n", (unsigned long long)stats->crossings,
               100 * (double)stats->silent_crossings / crossings);
    buf_format(out, "nesting faults     %llu, %.3g per million crossings\n", (unsigned long long)stats->nesting_faults,
               per_million(stats->nesting_faults, stats->crossings));
    buf_format(out, "samples            %u to %u per pixel, ", stats->samples, stats->most_samples);
    add_digits(out, stats->mean_samples, 4);
    buf_add(out, " on average\n");
    if (stats->guide.landed)
        buf_format(out, "caustics           %llu of %llu photons landed, %.1f MiB, %.2f s of processors\n",
                   (unsigned long long)stats->guide.landed, (unsigned long long)stats->guide.followed,
                   (double)stats->guide.bytes / (1024.0 * 1024), stats->guide.cpu_seconds);
    if (stats->spread_samples)
        buf_format(out,
                   "fireflies          %llu sample%s that stood alone, with %.2g %% of the light, spread over their "
                   "surroundings\n",
                   (unsigned long long)stats->spread_samples, plural(stats->spread_samples), 100 * stats->spread_light);
    if (run->noise >= 0) {
        buf_add(out, "noise              ");
        add_digits(out, 100 * run->noise, 3);
        buf_add(out, " %\n");
    }
    buf_format(out, "geometry           %.1f MiB\n",
               (double)rtc_scene_bytes(run->input.compiled->rtc) / (1024.0 * 1024));
    buf_format(out, "time               %.2f s to render, %.2f s of processors, %u thread%s\n", stats->seconds,
               stats->cpu_seconds, pool_threads(run->pool), plural(pool_threads(run->pool)));
}

static Status write_stats_file(const char *path, const Buf *text, Error *error)
{
    FileOut file;
    if (text->failed) return fail(error, STATUS_NOMEM, "out of memory for the statistics");
    TRY(file_create(&file, path, error));
    fwrite(text->text, 1, text->length, file.stream); /* a failure shows in the commit */
    return file_commit(&file, error);
}

Status render_print_stats(const RenderRun *run, Error *error)
{
    if (!option_given(run->options, OPTION_STATS)) return STATUS_OK;
    const char *path = run->stats_path;
    Buf text = {0};
    Status status = STATUS_OK;
    if (path) {
        print_stats_json(run, &text);
        status = write_stats_file(path, &text, error);
    } else if (run->talk->json) {
        Buf stats = {0};
        print_stats_json(run, &stats);
        for (size_t i = 0; i < stats.length; i++)
            if (stats.text[i] == '\n') stats.text[i] = ' '; /* one line per event */
        JsonWriter json = talk_event_begin(&text, "stats");
        json_key(&json, "stats");
        json_raw(&json, buf_text(&stats));
        talk_event_end(&json);
        buf_clear(&stats);
    } else {
        print_stats_text(run, &text);
        talk_write(&text);
    }
    buf_clear(&text);
    return status;
}
