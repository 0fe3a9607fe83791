/* merge.c - joins the states of slices.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/merge.h"

#include <stdlib.h>

static int compare_parts(const void *left, const void *right)
{
    const CheckpointNotes *a = &((const Checkpoint *)left)->notes, *b = &((const Checkpoint *)right)->notes;
    return a->first_sample < b->first_sample ? -1 : a->first_sample > b->first_sample;
}

/* As the facts say, too, unless a file is damaged: then rows would not fit. */
static bool is_same_part(const Checkpoint *a, const Checkpoint *b)
{
    return a->film_width == b->film_width && a->film_height == b->film_height && a->place.x == b->place.x &&
           a->place.y == b->place.y;
}

static Status check_part(const Checkpoint *first, const Checkpoint *part, Error *error)
{
    const CheckpointNotes *notes = &part->notes, *others = &first->notes;
    uint32_t wanted = notes->end_sample - notes->first_sample;
    Buf text = {0};
    checkpoint_compare(others, first->path, notes, part->path, &text);
    if (notes->samples != others->samples)
        buf_format(&text, "%ssamples of the whole: %u in %s, %u in %s", text.length ? "; " : "", others->samples,
                   first->path, notes->samples, part->path);
    if (!is_same_part(first, part)) buf_format(&text, "%swhich pixels they hold", text.length ? "; " : "");
    if (text.failed) return fail_memory(error, text.capacity, "what differs");
    Status status = STATUS_OK;
    if (text.length)
        status = fail(error, STATUS_INPUT, "'%s' and '%s' are not of one render, as there differs: %s", first->path,
                      part->path, text.text);
    buf_clear(&text);
    if (status == STATUS_OK && (part->least_samples != wanted || part->most_samples != wanted))
        status = fail(error, STATUS_INPUT,
                      "'%s' has only %u of its %u samples: render it to its end, with '--sample-range %u..%u --resume'",
                      part->path, part->least_samples, wanted, notes->first_sample + 1, notes->end_sample);
    return status;
}

static Status check_overlaps(const Merge *merge, Error *error)
{
    for (size_t i = 1; i < merge->n; i++) {
        const Checkpoint *a = &merge->parts[i - 1], *b = &merge->parts[i];
        if (b->notes.first_sample >= a->notes.end_sample) continue;
        uint32_t end = b->notes.end_sample < a->notes.end_sample ? b->notes.end_sample : a->notes.end_sample;
        return fail(error, STATUS_INPUT, "'%s' and '%s' both hold the samples %u..%u; leave one of them out", a->path,
                    b->path, b->notes.first_sample + 1, end);
    }
    return STATUS_OK;
}

/* Files are open one at a time: there can be more of them than a process may have open. */
static void let_go(Checkpoint *part)
{
    fclose(part->stream);
    part->stream = NULL;
}

Status merge_open(const char *const *paths, size_t n, Merge *merge, Error *error)
{
    *merge = (Merge){.parts = calloc(n, sizeof *merge->parts)};
    if (!merge->parts) return fail_memory(error, n * sizeof *merge->parts, "slices");
    for (size_t i = 0; i < n; i++) {
        Checkpoint *part = &merge->parts[merge->n++];
        TRY(checkpoint_open(paths[i], part, error));
        TRY(check_part(&merge->parts[0], part, error));
        let_go(part);
    }
    qsort(merge->parts, n, sizeof *merge->parts, compare_parts);
    return check_overlaps(merge, error);
}

void merge_clear(Merge *merge)
{
    for (size_t i = 0; i < merge->n; i++) checkpoint_close(&merge->parts[i]);
    free(merge->parts);
    *merge = (Merge){0};
}

bool merge_find_gap(const Merge *merge, uint32_t *first, uint32_t *end)
{
    *end = merge->parts[0].notes.samples;
    for (size_t i = 0; i < merge->n; i++) {
        const CheckpointNotes *notes = &merge->parts[i].notes;
        if (notes->first_sample > *first) {
            *end = notes->first_sample;
            break;
        }
        if (notes->end_sample > *first) *first = notes->end_sample;
    }
    return *first < *end;
}

/* One row of the part has room in `row`. */
static Status join_rows(Checkpoint *part, RenderState *row, RenderState *state, Error *error)
{
    const uint32_t width = state->film.width;
    for (uint32_t y = 0; y < state->film.height; y++) {
        TRY(checkpoint_read_row(part, row, 0, error));
        for (uint32_t x = 0; x < width; x++) {
            size_t pixel = (size_t)y * width + x;
            film_join(&state->film.pixels[pixel], film_pixel(&row->film, x, 0), part->notes.first_sample);
            if (state->film.caught && row->film.caught)
                film_join_caught(&state->film.caught[pixel], &row->film.caught[x]);
        }
        if (!bright_film_join_row(&state->bright, y, &row->bright, 0) ||
            !aov_film_join_row(&state->aovs, y, &row->aovs, 0))
            return fail(error, STATUS_NOMEM, "out of memory for merging '%s'", part->path);
    }
    return STATUS_OK;
}

static Status join_part(Checkpoint *part, RenderState *state, Error *error)
{
    RenderState row;
    TRY(checkpoint_make_state(part, 1, &row, error));
    Status status = join_rows(part, &row, state, error);
    render_state_clear(&row);
    if (status != STATUS_OK) return status;
    path_counters_add(&state->counters, &part->counters);
    state->saturated_samples += part->saturated_samples;
    return STATUS_OK;
}

/* It may be another file by now: one that still fits the first one, but holds other samples, would count some twice. */
static Status open_again(const Merge *merge, Checkpoint *part, Error *error)
{
    const char *path = part->path;
    const CheckpointNotes before = part->notes;
    checkpoint_close(part);
    TRY(checkpoint_open(path, part, error));
    TRY(check_part(&merge->parts[0], part, error));
    if (part->notes.first_sample == before.first_sample && part->notes.end_sample == before.end_sample)
        return STATUS_OK;
    return fail(error, STATUS_INPUT, "'%s' has changed since the merge began: it held the samples %u..%u, now %u..%u",
                path, before.first_sample + 1, before.end_sample, part->notes.first_sample + 1, part->notes.end_sample);
}

Status merge_read(Merge *merge, RenderState *state, Error *error)
{
    Status status = STATUS_OK;
    *state = (RenderState){0};
    for (size_t i = 0; i < merge->n && status == STATUS_OK; i++) {
        Checkpoint *part = &merge->parts[i];
        status = open_again(merge, part, error);
        if (status == STATUS_OK) status = i ? join_part(part, state, error) : checkpoint_read(part, state, error);
        if (status == STATUS_OK) let_go(part);
    }
    uint32_t first = 0, end;
    /* what is known of the evenness of samples is of those from the first on */
    if (status == STATUS_OK && merge_find_gap(merge, &first, &end) && !state->film.first_sample)
        state->film.first_sample = 1;
    if (status != STATUS_OK) render_state_clear(state);
    return status;
}
