/* profile.c - any file is a photometric file of a lamp, or refused with a report.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_data.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_data("light { shape = \"point\" profile =", "} camera { from = <0, 0, -1> }", data, size);
}
