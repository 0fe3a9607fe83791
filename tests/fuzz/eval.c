/* eval.c - any scene is evaluated within its limits, or refused with reports; it reads no files.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz.h"
#include "scene/build.h"

typedef struct Evaluation {
    FuzzText fuzz;
    EvalResult result;
    Status status;
    Error error;
} Evaluation;

static void evaluate(void *context)
{
    Evaluation *evaluation = context;
    FuzzText *fuzz = &evaluation->fuzz;
    EvalOptions options = {.schema = scene_schema(),
                           .confine = "/nonexistent",
                           .limits = {.steps = 20000, .nodes = 2000, .memory = 64 << 20, .files = 4, .calls = 200}};
    evaluation->status =
        eval_text("fuzz.mns", fuzz->text, fuzz->length, &options, &fuzz->diag, &evaluation->result, &evaluation->error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Evaluation evaluation;
    memset(&evaluation, 0, sizeof evaluation);
    fuzz_text_open(&evaluation.fuzz, data, size);
    bool enough = arena_guard(&evaluation.fuzz.arena, evaluate, &evaluation);
    FUZZ_HOLDS(enough);
    FUZZ_HOLDS((evaluation.status == STATUS_OK) == (evaluation.fuzz.diag.n_errors == 0));
    buf_clear(&evaluation.result.printed);
    fuzz_text_close(&evaluation.fuzz);
    return 0;
}
