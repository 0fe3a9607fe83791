/* fmt.c - any text is laid out or refused, and what is laid out stays as it is.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "lang/format.h"

typedef struct Layout {
    FuzzText fuzz;
    Buf out;
    Status status;
    Error error;
} Layout;

static void lay_out(void *context)
{
    Layout *layout = context;
    FuzzText *fuzz = &layout->fuzz;
    layout->status = format_text("fuzz.mns", fuzz->text, fuzz->length, &fuzz->diag, &layout->out, &layout->error);
}

static void run(Layout *layout, const uint8_t *data, size_t size)
{
    memset(layout, 0, sizeof *layout);
    fuzz_text_open(&layout->fuzz, data, size);
    if (!arena_guard(&layout->fuzz.arena, lay_out, layout)) abort();
    fuzz_text_close(&layout->fuzz);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Layout once, twice;
    run(&once, data, size);
    if (once.status == STATUS_OK) {
        run(&twice, (const uint8_t *)buf_text(&once.out), once.out.length);
        FUZZ_HOLDS(twice.status == STATUS_OK && twice.out.length == once.out.length);
        FUZZ_HOLDS(memcmp(buf_text(&once.out), buf_text(&twice.out), once.out.length) == 0);
        buf_clear(&twice.out);
    }
    buf_clear(&once.out);
    return 0;
}
