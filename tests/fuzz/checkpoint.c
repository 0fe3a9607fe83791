/* checkpoint.c - any file is a state of a render, or refused; one that is read can be gone on with, merged and made a
 * picture of.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "render/merge.h"

static void resolve(RenderState *state)
{
    Image image = {0};
    RenderStats stats = {0};
    Error error = {0};
    bool small = (double)state->film.width * state->film.height < 1e5; /* it takes its time */
    if (small) {
        Status status = render_state_resolve(state, (Exposure){0}, NULL, &image, &stats, &error);
        FUZZ_HOLDS(status == STATUS_OK ? image.pixels != NULL : error.text[0]);
    }
    image_clear(&image);
    render_state_clear(state);
}

static void go_on(const char *path)
{
    Checkpoint file;
    RenderState state;
    Error error = {0};
    Status status = checkpoint_open(path, &file, &error);
    if (status == STATUS_OK) status = checkpoint_read(&file, &state, &error);
    FUZZ_HOLDS(status == STATUS_OK || error.text[0]);
    if (status == STATUS_OK) resolve(&state);
    checkpoint_close(&file);
}

static void merge(const char *path)
{
    Merge merge;
    RenderState state;
    Error error = {0};
    Status status = merge_open(&path, 1, &merge, &error);
    if (status == STATUS_OK) status = merge_read(&merge, &state, &error);
    FUZZ_HOLDS(status == STATUS_OK || error.text[0]);
    if (status == STATUS_OK) resolve(&state);
    merge_clear(&merge);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    go_on(path);
    merge(path);
    unlink(path);
    return 0;
}
