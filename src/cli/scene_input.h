/* scene_input.h - from the words of a command line to a scene: options for the language, the image loader,
 * building and compiling, and the printing of what they report.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_SCENE_INPUT_H
#define MEN_SCENE_INPUT_H

#include "cli/frames.h"
#include "cli/talk.h"
#include "image/view.h"
#include "scene/build.h"
#include "scene/compile.h"

/* The colour configuration, opened when it is first needed. */
typedef struct ColorSource {
    const char *path; /* of --ocio, or NULL */
    ColorConfig *config;
} ColorSource;

/* Opens it where it is not open yet. */
ATTR_NODISCARD Status color_source_open(ColorSource *color, Error *error);

typedef struct SceneInput {
    const Options *options;
    const Talk *talk;
    const char *path;
    char *text; /* of standard input, which cannot be read twice; NULL until it is needed */
    size_t text_length;
    SceneOptions scene_options;
    SceneInstant instant;     /* of the scene, once it is built or evaluated */
    SceneAnimation animation; /* the same, for the next frame */
    Arena arena;
    SourceSet sources;
    Diag diag;
    bool diag_printed;
    Arena known_arena;
    bool several_frames; /* diag holds reports of several frames */
    Diag known;          /* reports of earlier frames, printed already */
    ColorSource color;
    Scene *scene;
    CompiledScene *compiled;
    Buf printed; /* what print() said */
} SceneInput;

/* Whether there is a file that is called so with the ending of scenes: its name. */
enum { SCENE_PATH_SIZE = 4096 };
bool scene_with_ending(const char *path, char scene[SCENE_PATH_SIZE]);
void scene_input_init(SceneInput *input, const Options *options, const Talk *talk);
void scene_input_close(SceneInput *input);
/* Lets go of the scene, its reports and its memory, and makes ready for another frame of the same animation. */
void scene_input_next(SceneInput *input, uint32_t frame);
/* Builds the scene. STATUS_SCENE leaves the reports in diag. */
ATTR_NODISCARD Status scene_input_build(SceneInput *input, Error *error);
/* Compiles it, with the policy of --nesting, else the scene's own. */
ATTR_NODISCARD Status scene_input_compile(SceneInput *input, Pool *pool, Error *error);
/* Only evaluates, for what the language alone knows. */
ATTR_NODISCARD Status scene_input_evaluate(SceneInput *input, EvalResult *result, Error *error);
/* Runs a task with the arena guarded. STATUS_NOMEM when memory ran out in it. */
ATTR_NODISCARD Status scene_input_guard(SceneInput *input, void (*task)(void *context), void *context, Error *error);
/* Shows what the scene said with print(), which is in input->printed, once. */
void scene_input_print_said(SceneInput *input);
/* Prints the reports, once, and no warning that another frame had; STATUS_SCENE without a text when there are errors
 * among them. */
ATTR_NODISCARD Status scene_input_print_reports(SceneInput *input, Error *error);
/* Keeps the reports of the present frame; at the end all that were kept become those of the input. The scene's texts
 * must be the same in all frames. */
ATTR_NODISCARD Status scene_input_gather(SceneInput *input, Error *error);
void scene_input_use_gathered(SceneInput *input);

/* Reads a picture; one that is a PNG file is taken for sRGB and made linear. */
ATTR_NODISCARD Status image_read_linear(const char *path, Image *image, Error *error);
/* The SceneImageLoader of all commands; context is a ColorSource. */
Status load_scene_image(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                        uint32_t *height, Error *error);

#endif
