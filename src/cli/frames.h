/* frames.h - the frames of an animation that the command line asks for, by --frames, --frame, --clock and --shard.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_FRAMES_H
#define MEN_FRAMES_H

#include "cli/options.h"
#include "scene/animation.h"

typedef struct FrameList {
    uint32_t first, step; /* numbers of frames: first, first + step, ... */
    uint32_t n;
    bool numbered; /* the scene has several frames, so that each one's files need its number */
} FrameList;

/* The moment that a scene is first looked at; STATUS_USAGE for options that exclude each other. */
ATTR_NODISCARD Status frames_moment(const Options *options, SceneMoment *moment, Error *error);
/* The frames of the animation. all: where the options do not say, all of them, and not the first only. */
ATTR_NODISCARD Status frames_choose(const Options *options, const SceneAnimation *animation, bool all, FrameList *list,
                                    Error *error);
uint32_t frames_at(const FrameList *list, uint32_t i);

#endif
