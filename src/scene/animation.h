/* animation.h - the frames of a scene, and a scene evaluated at one of them.
 * The clock is needed while a scene is evaluated, and the node that says how it runs is part of the scene. So a scene
 * is first evaluated as if it had one frame; where its animation node says otherwise, it is evaluated again with the
 * clock that follows. An animation node that then says something else depends on the clock, which is an error.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ANIMATION_H
#define MEN_ANIMATION_H

#include "lang/eval.h"
#include "scene/scene.h"

/* A scene file, or its text. */
typedef struct SceneText {
    const char *path; /* "-": standard input; of a text: a name for messages */
    const char *text; /* NULL: read the path */
    size_t length;
} SceneText;

/* When to look at a scene. Zero: its first frame. */
typedef struct SceneMoment {
    bool has_frame, has_clock;
    uint32_t frame;
    double clock;                    /* instead of the frame's own; the scene then has no frames to speak of */
    double later;                    /* so much of a frame after that moment: the shutter stays open for a while */
    const SceneAnimation *animation; /* as another frame of the scene had it; NULL: not known yet */
} SceneMoment;

/* What became of it. */
typedef struct SceneInstant {
    SceneAnimation animation;
    uint32_t frame;
    double clock, time; /* 0..1; in seconds */
} SceneInstant;

/* The frames that there are: the last one's number. */
uint32_t scene_last_frame(const SceneAnimation *animation);

/* Evaluates the scene at a moment: as eval_scene and eval_text, and STATUS_USAGE when there is no such frame. Reports
 * of an animation of several frames name the frame. clock, frame, frames and time of the options do not matter. */
ATTR_NODISCARD Status scene_evaluate(const SceneText *text, const EvalOptions *options, const SceneMoment *moment,
                                     Diag *diag, EvalResult *result, SceneInstant *instant, Error *error);
/* Lets the animation node of an evaluated scene, if there is one, speak of this frame alone. */
void scene_keep_one_frame(EvalResult *result, const SceneInstant *instant, Arena *arena);

#endif
