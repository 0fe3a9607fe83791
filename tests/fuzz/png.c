/* png.c - any file is a picture in PNG, or refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_image(png_read, data, size);
}
