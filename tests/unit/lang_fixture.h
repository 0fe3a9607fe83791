/* lang_fixture.h - evaluates a text against the test schema and keeps what came out.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_LANG_FIXTURE_H
#define MEN_LANG_FIXTURE_H

#include <stdlib.h>
#include <string.h>

#include "base/attr.h"
#include "lang/eval.h"
#include "test_schema.h"

typedef struct Run {
    Arena arena;
    SourceSet sources;
    Diag diag;
    EvalOptions options;
    EvalResult result;
    Status status;
    Error error;
    bool out_of_memory;
    const char *path, *text; /* one of them */
} Run;

/* What stands in for the program's own library. */
#define FIXTURE_GLASSWARE                                                                                              \
    "meniscus 1.0\n"                                                                                                   \
    "use \"std/parts.mns\" as parts\n"                                                                                 \
    "def tumbler(radius = 35mm, height = 90mm, wall = 2mm, base = 8mm, interior = none) {\n"                           \
    "  lathe { interior = interior  profile = parts.cup(radius, height, wall, base) }\n"                               \
    "}\n"
#define FIXTURE_PARTS                                                                                                  \
    "meniscus 1.0\n"                                                                                                   \
    "def cup(r, h, wall, base) = [<0, 0>, <r, 0>, <r, h>, <r - wall, h>, <r - wall, base>, <0, base>]\n"
static const EvalLibraryFile fixture_library_files[] = {
    {"std/glassware.mns", FIXTURE_GLASSWARE, sizeof FIXTURE_GLASSWARE - 1},
    {"std/parts.mns", FIXTURE_PARTS, sizeof FIXTURE_PARTS - 1},
};
static const EvalLibrary fixture_library = {fixture_library_files, 2};

static inline void run_open(Run *run)
{
    memset(run, 0, sizeof *run);
    arena_init(&run->arena);
    run->sources.arena = &run->arena;
    diag_init(&run->diag, &run->arena, &run->sources);
    run->options.schema = &test_schema;
    run->options.library = &fixture_library;
}

static inline void run_task(void *context)
{
    Run *run = context;
    if (run->path)
        run->status = eval_scene(run->path, &run->options, &run->diag, &run->result, &run->error);
    else
        run->status =
            eval_text("test.mns", run->text, strlen(run->text), &run->options, &run->diag, &run->result, &run->error);
}

static inline void run_go(Run *run)
{
    run->out_of_memory = !arena_guard(&run->arena, run_task, run);
}

/* A text with the header in front, on its first line. */
static inline void run_text(Run *run, const char *text)
{
    run_open(run);
    run->text = arena_format(&run->arena, "meniscus 1.0 unit mm  %s", text);
    run_go(run);
}

static inline void run_close(Run *run)
{
    buf_clear(&run->result.printed);
    arena_clear(&run->arena);
}

/* All reports as one text; free it. */
static inline char *run_reports(Run *run)
{
    Buf out = {0};
    diag_print(&run->diag, &out, false);
    char *text = malloc(out.length + 1);
    if (text) memcpy(text, buf_text(&out), out.length + 1);
    buf_clear(&out);
    return text;
}

#endif
