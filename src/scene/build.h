/* build.h - from a file in the scene language to a scene description.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_BUILD_H
#define MEN_BUILD_H

#include "base/pool.h"
#include "scene/animation.h"

/* What images are read with: the layer below has no image files. rgb is malloc'd, linear Rec.709 (working
 * space). space: name of the colour space, NULL by the file's kind, SCENE_SPACE_DATA for values as they are in the
 * file, SCENE_SPACE_ALPHA for three times the alpha, which is 1 where there is none. */
#define SCENE_SPACE_DATA ""
#define SCENE_SPACE_ALPHA "/alpha"
typedef Status (*SceneImageLoader)(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                                   uint32_t *height, Error *error);

typedef struct SceneOptions {
    EvalOptions eval; /* schema and geometry are filled in here, and so are clock, frame, frames and time */
    SceneMoment moment;
    SceneImageLoader load_image;
    void *load_image_context;
    bool no_picture; /* none is made of it: it needs no camera and no light */
    Pool *pool;      /* whose threads help with large meshes, or NULL */
    /* NULL, or who is told what is being built: a type of nodes, and a name or NULL, which last until the call is over */
    void (*building)(void *context, const char *type, const char *name);
    void *building_context;
} SceneOptions;

/* Reads, evaluates, checks and builds. Reports go to diag; STATUS_SCENE when there were errors,
 * STATUS_INPUT when the scene file itself cannot be read, STATUS_NOMEM. *scene is NULL unless STATUS_OK.
 * printed (may be NULL) receives what the scene's print() said. */
ATTR_NODISCARD Status scene_build(const char *path, const SceneOptions *options, Diag *diag, Scene **scene,
                                  Buf *printed, Error *error);
/* The same for a file or a text. instant (may be NULL) is as far as it became known, also of a scene with errors. */
ATTR_NODISCARD Status scene_build_from(const SceneText *text, const SceneOptions *options, Diag *diag, Scene **scene,
                                       Buf *printed, SceneInstant *instant, Error *error);
/* The same for text in memory. */
ATTR_NODISCARD Status scene_build_text(const char *name, const char *text, const SceneOptions *options, Diag *diag,
                                       Scene **scene, Buf *printed, Error *error);

/* options->eval with what the language must know of scenes: the schema, and answers about the shape of nodes. options must
 * outlive every evaluation with it. */
EvalOptions scene_eval_options(const SceneOptions *options);

/* The table of nodes and properties (nodes.def), for the manual and the tests. */
const Schema *scene_schema(void);

#endif
