/* checkpoint.c - any file is a state of a render, or refused; one that is read can be merged and made a picture of.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "render/merge.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    Merge merge;
    RenderState state;
    Image image = {0};
    RenderStats stats = {0};
    Error error = {0};
    Status status = merge_open(&path, 1, &merge, &error);
    bool small = status == STATUS_OK &&
                 (double)merge.parts[0].width * merge.parts[0].height < 1e5; /* resolving takes its time */
    if (status == STATUS_OK) status = merge_read(&merge, &state, &error);
    if (status == STATUS_OK && small) {
        Status resolved = render_state_resolve(&state, NULL, &image, &stats, &error);
        FUZZ_HOLDS(resolved == STATUS_OK ? image.pixels != NULL : error.text[0]);
    }
    FUZZ_HOLDS(status == STATUS_OK || error.text[0]);
    if (status == STATUS_OK) render_state_clear(&state);
    image_clear(&image);
    merge_clear(&merge);
    unlink(path);
    return 0;
}
