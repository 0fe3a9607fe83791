/* replay.c - gives an entry point of the fuzzers the files of its corpus, without a fuzzer.
 * usage: NAME FILE...
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"
#include "fuzz.h"

int main(int n, char **paths)
{
    for (int i = 1; i < n; i++) {
        char *bytes;
        size_t length;
        Error error;
        if (file_read(paths[i], 0, &bytes, &length, &error) != STATUS_OK) {
            fprintf(stderr, "%s\n", error.text);
            return 2;
        }
        LLVMFuzzerTestOneInput((const uint8_t *)bytes, length);
        free(bytes);
    }
    printf("%d files\n", n - 1);
    return 0;
}
