/* lex_parse.c - any text is parsed, or refused with reports.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "lang/parse.h"

static void parse(void *context)
{
    FuzzText *fuzz = context;
    SymbolTable symbols;
    symbol_table_init(&symbols, &fuzz->arena);
    File file = {.source = source_add(&fuzz->sources, "fuzz.mns", "fuzz.mns", fuzz->text, fuzz->length)};
    parse_file(&file, true, 0, &fuzz->diag, &symbols);
    FUZZ_HOLDS(file.block);
    for (const Diagnostic *report = fuzz->diag.first; report; report = report->next)
        FUZZ_HOLDS(report->span.begin <= report->span.end && report->span.end <= fuzz->length);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    FuzzText fuzz;
    fuzz_text_open(&fuzz, data, size);
    if (!arena_guard(&fuzz.arena, parse, &fuzz)) abort();
    fuzz_text_close(&fuzz);
    return 0;
}
