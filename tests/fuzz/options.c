/* options.c - any command line is read or refused. The first byte chooses the command; words end in a line break.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/options.h"
#include "fuzz.h"

enum { MOST_WORDS = 64 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0) return 0;
    char *text = malloc(size), *words[MOST_WORDS];
    if (!text) abort();
    memcpy(text, data + 1, size - 1);
    text[size - 1] = 0;
    size_t n = 0;
    for (char *at = text; at && n < MOST_WORDS;) {
        words[n++] = at;
        at = strchr(at, '\n');
        if (at) *at++ = 0;
    }
    Options options;
    Error error = {0};
    Status status = options_parse(&options, (Command)(data[0] % COMMAND_COUNT), words, n, &error);
    FUZZ_HOLDS(status == STATUS_OK || error.text[0]);
    options_clear(&options);
    free(text);
    return 0;
}
