/* exif.c - finds one number in a TIFF file within a JPEG file, and turns pictures by it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/exif.h"

#include <stdlib.h>
#include <string.h>

enum { TAG_ORIENTATION = 0x112, TYPE_SHORT = 3, ENTRY_SIZE = 12 };

/* TIFF 6.0, section 2: numbers in one of two orders. */
typedef struct Tiff {
    const unsigned char *bytes;
    size_t n;
    bool big_endian;
} Tiff;

/* 0 beyond the end. */
static uint32_t number_at(const Tiff *tiff, size_t at, size_t size)
{
    uint32_t number = 0;
    if (at > tiff->n || size > tiff->n - at) return 0;
    for (size_t i = 0; i < size; i++) number = number << 8 | tiff->bytes[tiff->big_endian ? at + i : at + size - 1 - i];
    return number;
}

unsigned exif_orientation(const unsigned char *bytes, size_t n)
{
    if (n < 14 || memcmp(bytes, "Exif\0", 6) != 0) return 1;
    Tiff tiff = {bytes + 6, n - 6, bytes[6] == 'M'};
    if (memcmp(tiff.bytes, tiff.big_endian ? "MM" : "II", 2) != 0 || number_at(&tiff, 2, 2) != 42) return 1;
    size_t directory = number_at(&tiff, 4, 4), n_entries = number_at(&tiff, directory, 2);
    for (size_t i = 0; i < n_entries; i++) {
        size_t entry = directory + 2 + i * ENTRY_SIZE;
        if (number_at(&tiff, entry, 2) != TAG_ORIENTATION || number_at(&tiff, entry + 2, 2) != TYPE_SHORT) continue;
        uint32_t orientation = number_at(&tiff, entry + 8, 2);
        return orientation >= 1 && orientation <= 8 ? orientation : 1;
    }
    return 1;
}

Status image_turn_upright(Image *image, unsigned orientation, Error *error)
{
    if (orientation <= 1 || orientation > 8) return STATUS_OK;
    /* Which stored row and column are at the top and at the left: from 5 on rows are upright columns. */
    const bool transposed = orientation >= 5, from_right = strchr("\2\3\7\10", (int)orientation) != NULL,
               from_bottom = strchr("\3\4\6\7", (int)orientation) != NULL;
    const uint32_t width = transposed ? image->height : image->width,
                   height = transposed ? image->width : image->height;
    const size_t pixel_size = image->n_channels * sizeof *image->pixels, size = pixel_size * width * height;
    float *pixels = malloc(size), *to = pixels;
    if (!pixels) return fail_memory(error, size, "a picture");
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++, to += image->n_channels) {
            uint32_t column = transposed ? y : x, row = transposed ? x : y;
            if (from_right) column = image->width - 1 - column;
            if (from_bottom) row = image->height - 1 - row;
            memcpy(to, image_at(image, column, row), pixel_size);
        }
    free(image->pixels);
    image->pixels = pixels;
    image->width = width;
    image->height = height;
    return STATUS_OK;
}
