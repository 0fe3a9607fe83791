/* exr.c - any file is a picture in EXR, or refused, and what its header holds comes out as text.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_image.h"

static void measure(void *context, const char *name, const char *text)
{
    *(size_t *)context += strlen(name) + strlen(text);
}

/* All of it: a picture may be refused where its header is not. */
static Status read_all(const char *path, Image *image, Error *error)
{
    size_t length = 0;
    Status status = exr_visit_attributes(path, measure, &length, error);
    FUZZ_HOLDS(status == STATUS_OK ? length > 0 : error->text[0]);
    *error = (Error){0};
    return exr_read(path, image, error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_image(read_all, data, size);
}
