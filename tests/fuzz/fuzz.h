/* fuzz.h - what the entry points of the fuzzers share. Each of them is a file with the one function that libFuzzer
 * calls; `make fuzz` links it with the fuzzer, `make check` with replay.c, which gives it files.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FUZZ_H
#define MEN_FUZZ_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "diag/diag.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A property that must hold for every input. */
#define FUZZ_HOLDS(condition)                                                                                          \
    do                                                                                                                 \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: does not hold: %s\n", __FILE__, __LINE__, #condition);                             \
            abort();                                                                                                   \
        }                                                                                                              \
    while (0)

/* A text of the fuzzer with an arena and a sink of reports around it. */
typedef struct FuzzText {
    Arena arena;
    SourceSet sources;
    Diag diag;
    char *text; /* terminated */
    size_t length;
} FuzzText;

static inline void fuzz_text_open(FuzzText *fuzz, const uint8_t *data, size_t size)
{
    memset(fuzz, 0, sizeof *fuzz);
    arena_init(&fuzz->arena);
    fuzz->sources.arena = &fuzz->arena;
    diag_init(&fuzz->diag, &fuzz->arena, &fuzz->sources);
    fuzz->text = malloc(size + 1);
    if (!fuzz->text) abort();
    if (size) memcpy(fuzz->text, data, size);
    fuzz->text[size] = 0;
    fuzz->length = size;
}

/* The reports are printed, too: whatever the text is, they must come out. */
static inline void fuzz_text_close(FuzzText *fuzz)
{
    Buf out = {0};
    diag_print(&fuzz->diag, &out, true);
    diag_print_json(&fuzz->diag, &out);
    FUZZ_HOLDS(!out.failed);
    buf_clear(&out);
    arena_clear(&fuzz->arena);
    free(fuzz->text);
}

/* The input as a file; unlink it. */
static inline const char *fuzz_file(const uint8_t *data, size_t size)
{
    static char path[256];
    const char *folder = getenv("TMPDIR");
    snprintf(path, sizeof path, "%s/meniscus-fuzz-%ld", folder ? folder : "/tmp", (long)getpid());
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0) abort();
    return path;
}

#endif
