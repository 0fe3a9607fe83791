/* exr.c - any file is a picture in EXR, or refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "image/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    Image image = {0};
    Error error = {0};
    Status status = exr_read(path, &image, &error);
    FUZZ_HOLDS(status == STATUS_OK ? image.width > 0 && image.height > 0 && image.pixels : error.text[0]);
    image_clear(&image);
    unlink(path);
    return 0;
}
