/* nvdb.c - any file is one of NanoVDB's grids, or refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "optics/nanovdb.h"

static void count(void *context, const NanovdbGrid *grid)
{
    ++*(size_t *)context;
    FUZZ_HOLDS(grid->name && grid->type);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    const size_t most_bytes = 20000000;
    Volume *volume = NULL;
    Error error = {0};
    size_t n_grids = 0;
    Status listed = nanovdb_visit(path, count, &n_grids, &error);
    FUZZ_HOLDS(listed == STATUS_OK || error.text[0]);
    Status status = nanovdb_read(path, NULL, most_bytes, &volume, &error);
    FUZZ_HOLDS(status != STATUS_OK || (listed == STATUS_OK && n_grids == 1));
    FUZZ_HOLDS(status == STATUS_OK ? volume->largest >= 0 && volume_bytes(volume) <= most_bytes : error.text[0]);
    volume_free(volume);
    unlink(path);
    return 0;
}
