/* hdr.c - any file is a picture of Radiance's, or refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_image(hdr_read, data, size);
}
