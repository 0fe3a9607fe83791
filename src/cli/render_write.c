/* render_write.c - the outputs of a render, and what is said in their headers.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli/merge_tiles.h"
#include "cli/render_run.h"

enum { MOST_ATTRIBUTES = CHECKPOINT_MOST_ATTRIBUTES, NUMBER_SIZE = 32 };

typedef struct Attributes {
    ImageAttribute items[MOST_ATTRIBUTES];
    size_t n;
    char *owned[2 * MOST_ATTRIBUTES];
    size_t n_owned;
    char hash[NUMBER_SIZE], seed[NUMBER_SIZE], crossings[NUMBER_SIZE], faults[NUMBER_SIZE], crop[2 * NUMBER_SIZE];
} Attributes;

static void add_text(Attributes *attributes, const char *name, const char *text)
{
    if (text) attributes->items[attributes->n++] = (ImageAttribute){.name = name, .type = ATTRIBUTE_TEXT, .text = text};
}

static void attributes_clear(Attributes *attributes)
{
    for (size_t i = 0; i < attributes->n_owned; i++) free(attributes->owned[i]);
}

/* Of the further channels; left out when memory ends. */
static void add_aov_attribute(void *context, const char *name, const char *text)
{
    Attributes *attributes = context;
    if (attributes->n == MOST_ATTRIBUTES) return;
    char *own_name = strdup(name), *own_text = strdup(text);
    attributes->owned[attributes->n_owned++] = own_name;
    attributes->owned[attributes->n_owned++] = own_text;
    if (own_name) add_text(attributes, own_name, own_text);
}

/* Counts that can be beyond the format's 32-bit integers are text. No times: two renders of one scene are one file,
 * byte for byte; --stats has the times. Of a slice the noise of the picture that will be merged is left open. */
static void describe(const RenderRun *run, bool of_merged, Attributes *attributes)
{
    const Scene *scene = run->input.scene;
    *attributes = (Attributes){0};
    snprintf(attributes->hash, NUMBER_SIZE, "%016llx", (unsigned long long)scene->hash);
    snprintf(attributes->seed, NUMBER_SIZE, "%u", run->settings.seed);
    snprintf(attributes->crossings, NUMBER_SIZE, "%llu", (unsigned long long)run->stats.crossings);
    snprintf(attributes->faults, NUMBER_SIZE, "%llu", (unsigned long long)run->stats.nesting_faults);
    add_text(attributes, "software", "meniscus " MEN_VERSION);
    add_text(attributes, "meniscus/version", MEN_VERSION);
    add_text(attributes, "meniscus/scene", run->input.path);
    add_text(attributes, "meniscus/sceneHash", attributes->hash);
    if (run->plan.numbered)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/frame", .type = ATTRIBUTE_INT, .whole = (int)scene->frame};
    add_text(attributes, "meniscus/camera", scene->cameras[run->settings.camera].name);
    add_text(attributes, "meniscus/nesting", nest_policy_text(run->input.compiled->order.policy));
    add_text(attributes, "meniscus/seed", attributes->seed);
    add_text(attributes, "meniscus/crossings", attributes->crossings);
    add_text(attributes, "meniscus/nestingFaults", attributes->faults);
    attributes->items[attributes->n++] =
        (ImageAttribute){.name = "meniscus/samples", .type = ATTRIBUTE_INT, .whole = (int)run->stats.samples};
    const uint32_t *crop = run->settings.crop;
    const uint32_t width = crop[2] - crop[0], height = crop[3] - crop[1];
    if (crop[2] > 0 && (width < run->settings.width || height < run->settings.height)) {
        snprintf(attributes->crop, sizeof attributes->crop, "%u,%u,%u,%u", crop[0], crop[1], crop[2], crop[3]);
        add_text(attributes, TILE_ATTRIBUTE, attributes->crop);
    }
    if (render_is_uneven(&run->settings))
        attributes->items[attributes->n++] = (ImageAttribute){
            .name = "meniscus/meanSamples", .type = ATTRIBUTE_FLOAT, .number = run->stats.mean_samples};
    if (run->noise >= 0 || of_merged)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/noise", .type = ATTRIBUTE_FLOAT, .number = run->noise};
    if (run->settings.spreads)
        attributes->items[attributes->n++] = (ImageAttribute){
            .name = "meniscus/lightSpread", .type = ATTRIBUTE_FLOAT, .number = run->stats.spread_light};
    if (run->settings.denoises)
        attributes->items[attributes->n++] =
            (ImageAttribute){.name = "meniscus/denoised", .type = ATTRIBUTE_INT, .whole = 1};
    ColorLook look = film_look(&scene->film);
    attributes->n += output_note_look(&look, &attributes->items[attributes->n]);
    aov_visit_attributes(run->settings.aovs, scene, add_aov_attribute, attributes);
}

/* A picture, or a slice of one. */
static Status write_output(const RenderRun *run, const Output *output, const ExrOptions *exr, Error *error)
{
    ColorLook look = render_look(run);
    if (!run->slices || output->png)
        return output_write(output, &run->image, exr, run->input.color.config, &look, error);
    Attributes merged;
    CheckpointTexts texts;
    CheckpointNotes notes;
    describe(run, true, &merged);
    render_note(run, &notes, &texts);
    notes.n_attributes = (uint32_t)merged.n;
    memcpy(notes.attributes, merged.items, merged.n * sizeof *merged.items);
    Status status = checkpoint_write(output->path, &run->state, &notes, &run->image, exr, error);
    attributes_clear(&merged);
    return status;
}

/* Each output is worth the time that the render took, also when one of them fails. */
Status render_write_outputs(const RenderRun *run, bool again, Error *error)
{
    Attributes attributes;
    describe(run, false, &attributes);
    unsigned half = run->options->values[OPTION_HALF].place, full = run->options->values[OPTION_FLOAT].place;
    ExrOptions exr = {
        .half = half > full, .attributes = attributes.items, .n_attributes = attributes.n, .pool = run->pool};
    Status first = STATUS_OK;
    for (size_t i = 0; i < run->outputs.n; i++) {
        Error own = {0};
        if (again && output_is_stream(run->outputs.items[i].path)) continue;
        Status status = write_output(run, &run->outputs.items[i], &exr, &own);
        if (status == STATUS_OK) continue;
        if (first == STATUS_OK)
            *error = own;
        else
            talk_error(run->talk, &own);
        first = first == STATUS_OK ? status : first;
    }
    attributes_clear(&attributes);
    return first;
}
