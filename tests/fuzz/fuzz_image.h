/* fuzz_image.h - what the fuzzers of pictures share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FUZZ_IMAGE_H
#define MEN_FUZZ_IMAGE_H

#include "fuzz.h"
#include "image/image.h"

typedef Status ImageReader(const char *path, Image *image, Error *error);

/* Any file is a picture, or refused. */
static inline int fuzz_image(ImageReader *read, const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(data, size);
    Image image = {0};
    Error error = {0};
    Status status = read(path, &image, &error);
    unlink(path);
    FUZZ_HOLDS(status == STATUS_OK ? image.width > 0 && image.height > 0 && image.pixels : error.text[0]);
    image_clear(&image);
    return 0;
}

#endif
