/* render_write.c - the outputs of a render, and what is said in their headers.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "cli/merge_tiles.h"
#include "cli/render_run.h"
#include "image/attributes.h"

/* Of the further channels. */
static void add_aov_attribute(void *context, const char *name, const char *text)
{
    attributes_add_text(context, name, text);
}

/* The hash of the scene, and which pixels of a part were rendered. */
static void describe_scene(const RenderRun *run, Attributes *attributes)
{
    const Scene *scene = run->input.scene;
    char text[100];
    snprintf(text, sizeof text, "%016llx", (unsigned long long)scene->hash);
    attributes_add_text(attributes, "software", "meniscus " MEN_VERSION);
    attributes_add_text(attributes, "meniscus/version", MEN_VERSION);
    attributes_add_text(attributes, "meniscus/scene", run->input.path);
    attributes_add_text(attributes, "meniscus/sceneHash", text);
    if (run->plan.numbered) attributes_add_whole(attributes, "meniscus/frame", (int)scene->frame);
    attributes_add_text(attributes, "meniscus/camera", scene->cameras[run->settings.camera].name);
    attributes_add_text(attributes, "meniscus/nesting", nest_policy_text(run->input.compiled->order.policy));
    const uint32_t *crop = run->settings.crop;
    const uint32_t width = crop[2] - crop[0], height = crop[3] - crop[1];
    if (crop[2] == 0 || (width == run->settings.width && height == run->settings.height)) return;
    snprintf(text, sizeof text, "%u,%u,%u,%u", crop[0], crop[1], crop[2], crop[3]);
    attributes_add_text(attributes, TILE_ATTRIBUTE, text);
}

/* No times: two renders of one scene are one file, byte for byte; --stats has the times. Of a slice the noise of the picture that will be
 * merged is left open. */
static void describe(const RenderRun *run, bool of_merged, Attributes *attributes)
{
    const Scene *scene = run->input.scene;
    const RenderStats *stats = &run->stats;
    *attributes = (Attributes){.n = 0};
    describe_scene(run, attributes);
    attributes_add_count(attributes, "meniscus/seed", run->settings.seed);
    attributes_add_count(attributes, "meniscus/crossings", stats->crossings);
    attributes_add_count(attributes, "meniscus/nestingFaults", stats->nesting_faults);
    attributes_add_whole(attributes, "meniscus/samples", (int)stats->samples);
    if (render_is_uneven(&run->settings))
        attributes_add_number(attributes, "meniscus/meanSamples", stats->mean_samples);
    if (run->noise >= 0 || of_merged) attributes_add_number(attributes, "meniscus/noise", run->noise);
    if (run->settings.spreads) attributes_add_number(attributes, "meniscus/lightSpread", stats->spread_light);
    if (run->settings.denoises) attributes_add_whole(attributes, "meniscus/denoised", 1);
    ColorLook look = film_look(&scene->film);
    output_note_look(&look, attributes);
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
    ExrOptions exr = {.half = half > full,
                      .attributes = attributes.items,
                      .n_attributes = attributes.n,
                      .place = &run->state.place,
                      .pool = run->pool};
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
