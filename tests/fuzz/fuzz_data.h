/* fuzz_data.h - what the fuzzers of data files share that a scene names.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FUZZ_DATA_H
#define MEN_FUZZ_DATA_H

#include "fuzz.h"
#include "scene/build.h"

typedef struct DataScene {
    FuzzText fuzz;
    Scene *scene;
    Status status;
    Error error;
} DataScene;

static inline void fuzz_data_build(void *context)
{
    DataScene *built = context;
    FuzzText *fuzz = &built->fuzz;
    SceneOptions options = {.load_image = NULL};
    built->status = scene_build_text("fuzz.mns", fuzz->text, &options, &fuzz->diag, &built->scene, NULL, &built->error);
}

/* Any file is what the scene takes it for, or refused with a report. before, after: the text of
 * the scene around the file's name. */
static inline int fuzz_data(const char *before, const char *after, const uint8_t *data, size_t size)
{
    DataScene built;
    memset(&built, 0, sizeof built);
    const char *path = fuzz_file(data, size);
    char text[1000];
    int length = snprintf(text, sizeof text, "meniscus 1.0 %s \"%s\" %s", before, path, after);
    FUZZ_HOLDS(length > 0 && (size_t)length < sizeof text);
    fuzz_text_open(&built.fuzz, (const uint8_t *)text, (size_t)length);
    bool enough = arena_guard(&built.fuzz.arena, fuzz_data_build, &built);
    unlink(path);
    FUZZ_HOLDS(enough);
    FUZZ_HOLDS(built.status == STATUS_OK ? built.scene != NULL : built.fuzz.diag.n_errors > 0 || built.error.text[0]);
    scene_free(built.scene);
    fuzz_text_close(&built.fuzz);
    return 0;
}

#endif
