/* cmd_merge.c - the command merge: slices of one render, or parts of one picture, into the whole.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "cli/commands.h"
#include "cli/merge_tiles.h"
#include "cli/output.h"
#include "render/merge.h"

enum { NUMBER_SIZE = 32, MOST_OUTPUTS = 16 };

typedef struct MergeRun {
    const Options *options;
    const Talk *talk;
    Pool *pool;
    ColorSource color;
    Output outputs[MOST_OUTPUTS];
    size_t n_outputs;
    Merge merge;
    ColorLook look; /* with which the picture is shown */
    RenderState state;
    Image image;
    RenderStats stats;
} MergeRun;

static Status plan_outputs(MergeRun *run, Error *error)
{
    const OptionValue *given = &run->options->values[OPTION_MERGE_OUTPUT];
    if (!given->n_items) return fail(error, STATUS_USAGE, "where to? '-o FILE' names the picture, .exr or .png");
    if (given->n_items > MOST_OUTPUTS) return fail(error, STATUS_USAGE, "more than %d outputs", MOST_OUTPUTS);
    for (size_t i = 0; i < given->n_items; i++) {
        Output *output = &run->outputs[run->n_outputs++];
        TRY(output_choose_format(given->items[i], &output->png, error));
        for (size_t k = 0; k < run->options->n_operands; k++)
            if (file_same(run->options->operands[k], given->items[i]))
                return fail(error, STATUS_USAGE, "'%s' is both an input and the output", given->items[i]);
        output->path = (char *)(uintptr_t)given->items[i]; /* not freed here */
        TRY(output_probe(output->path, error));
        if (output->png) TRY(color_source_open(&run->color, error));
    }
    return STATUS_OK;
}

/* The attributes of a slice are those of the picture, but for what was counted. */
static void describe(const MergeRun *run, Attributes *attributes)
{
    const CheckpointNotes *notes = &run->merge.parts[0].notes;
    const RenderStats *stats = &run->stats;
    *attributes = (Attributes){.n = 0};
    for (uint32_t i = 0; i < notes->n_attributes; i++) {
        ImageAttribute attribute = notes->attributes[i];
        if (strcmp(attribute.name, "meniscus/noise") == 0 && stats->noise < 0) continue;
        if (strcmp(attribute.name, "meniscus/noise") == 0) attribute.number = stats->noise;
        if (strcmp(attribute.name, "meniscus/lightSpread") == 0) attribute.number = stats->spread_light;
        if (strcmp(attribute.name, "meniscus/samples") == 0) attribute.whole = (int)stats->samples;
        attributes_add(attributes, &attribute);
    }
    attributes_set_count(attributes, "meniscus/crossings", stats->crossings);
    attributes_set_count(attributes, "meniscus/nestingFaults", stats->nesting_faults);
}

/* What the slices or parts say of how the picture is shown, and what options say instead. */
static ColorLook look_of(const MergeRun *run, const ImageAttribute *attributes, size_t n)
{
    ColorLook own = {.alpha = false};
    for (size_t i = 0; i < n; i++) {
        const ImageAttribute *attribute = &attributes[i];
        double value = attribute->type == ATTRIBUTE_FLOAT ? attribute->number : attribute->whole;
        output_find_look(&own, attribute->name, value);
    }
    return output_look(run->options, &own);
}

static Status write_outputs(const MergeRun *run, const Image *image, const ImagePlace *place,
                            const Attributes *attributes, Error *error)
{
    unsigned half = run->options->values[OPTION_HALF].place, full = run->options->values[OPTION_FLOAT].place;
    ExrOptions exr = {.half = half > full,
                      .attributes = attributes->items,
                      .n_attributes = attributes->n,
                      .place = place,
                      .pool = run->pool};
    bool displayed = false;
    for (size_t i = 0; i < run->n_outputs; i++) {
        TRY(output_write(&run->outputs[i], image, &exr, run->color.config, &run->look, error));
        displayed |= run->outputs[i].png;
    }
    if (displayed) output_say_exposure(run->talk, image, &run->look);
    return STATUS_OK;
}

/* Returns how many samples are missing. */
static uint32_t warn_of_gaps(const MergeRun *run)
{
    uint32_t first = 0, end, missing = 0, total = run->merge.parts[0].notes.samples;
    for (; merge_find_gap(&run->merge, &first, &end); first = end) {
        talk_warning(run->talk,
                     "the samples %u..%u of %u are missing: render them with '--sample-range %u..%u', and merge again",
                     first + 1, end, total, first + 1, end);
        missing += end - first;
    }
    return missing;
}

/* Says which pixels no part has; whether there are any. */
static bool warn_of_missing_parts(const MergeRun *run, Tiles *tiles)
{
    enum { MOST = 8 };
    uint32_t gap[4], n = 0;
    for (; tiles_take_gap(tiles, gap); n++)
        if (n < MOST)
            talk_warning(run->talk, "a part is missing: render it with '--crop %u,%u,%u,%u', and merge again", gap[0],
                         gap[1], gap[2], gap[3]);
    if (n > MOST) talk_warning(run->talk, "%u more parts are missing", n - MOST);
    return n > 0;
}

/* what: of how much it was made. */
static void say_written(const MergeRun *run, const ImagePlace *place, const char *what)
{
    for (size_t i = 0; i < run->n_outputs && !run->talk->quiet; i++)
        talk_event(run->talk, "done", "wrote %s (%u x %u, %s)",
                   strcmp(run->outputs[i].path, "-") == 0 ? "standard output" : run->outputs[i].path, place->width,
                   place->height, what);
}

static Status merge_tiles(MergeRun *run, Tiles *tiles, Error *error)
{
    const Options *options = run->options;
    TRY(tiles_read(options->operands, options->n_operands, tiles, error));
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &run->pool, error));
    run->look = look_of(run, tiles->attributes.items, tiles->attributes.n);
    const ImagePlace whole = {.width = tiles->image.width, .height = tiles->image.height};
    TRY(write_outputs(run, &tiles->image, &whole, &tiles->attributes, error));
    char what[2 * NUMBER_SIZE];
    snprintf(what, sizeof what, "from %zu part%s", options->n_operands, plural(options->n_operands));
    say_written(run, &whole, what);
    error->text[0] = 0;
    return warn_of_missing_parts(run, tiles) ? STATUS_STOPPED : STATUS_OK;
}

static Status merge_slices(MergeRun *run, Error *error)
{
    const Options *options = run->options;
    Attributes attributes;
    char what[4 * NUMBER_SIZE];
    TRY(merge_open(options->operands, options->n_operands, &run->merge, error));
    TRY(pool_new(options->values[OPTION_THREADS].whole[0], &run->pool, error));
    TRY(merge_read(&run->merge, &run->state, error));
    run->look = look_of(run, run->merge.parts[0].notes.attributes, run->merge.parts[0].notes.n_attributes);
    TRY(render_state_resolve(&run->state, run->look.exposure, run->pool, &run->image, &run->stats, error));
    describe(run, &attributes);
    Status status = write_outputs(run, &run->image, &run->state.place, &attributes, error);
    attributes_clear(&attributes);
    if (status != STATUS_OK) return status;
    const uint32_t total = run->merge.parts[0].notes.samples;
    snprintf(what, sizeof what, "%u of %u sample%s, from %zu slice%s", run->stats.samples, total, plural(total),
             run->merge.n, plural(run->merge.n));
    say_written(run, &run->state.place, what);
    error->text[0] = 0;
    return warn_of_gaps(run) ? STATUS_STOPPED : STATUS_OK;
}

static Status merge(MergeRun *run, Error *error)
{
    const Options *options = run->options;
    for (size_t i = 0; i < options->n_operands; i++)
        if (strcmp(options->operands[i], "-") == 0)
            return fail(error, STATUS_USAGE, "'-': slices are read twice, and standard input only once; give files");
    if (option_given(options, OPTION_OCIO)) TRY(color_source_open(&run->color, error));
    TRY(plan_outputs(run, error));
    if (!tile_is(options->operands[0])) return merge_slices(run, error);
    Tiles tiles;
    Status status = merge_tiles(run, &tiles, error);
    tiles_clear(&tiles);
    return status;
}

Status cmd_merge(const Options *options, const Talk *talk, Error *error)
{
    MergeRun run = {.options = options, .talk = talk, .color = {.path = option_text(options, OPTION_OCIO, NULL)}};
    Status status = merge(&run, error);
    image_clear(&run.image);
    render_state_clear(&run.state);
    merge_clear(&run.merge);
    color_config_close(run.color.config);
    pool_free(run.pool);
    return status;
}
