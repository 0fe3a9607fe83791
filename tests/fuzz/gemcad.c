/* gemcad.c - any file is a cut stone by GemCad, or refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    return fuzz_mesh(mesh_load_gemcad, data, size);
}
