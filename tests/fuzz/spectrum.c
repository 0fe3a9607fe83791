/* spectrum.c - any file is a measured spectrum, or refused with a report.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_data.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_data("medium m { ior = 1.5 absorption = spectrum(",
                     ") } sphere { interior = m } camera { from = <0, 0, -9> }", data, size);
}
