/* other_frames.h - what must be the same in all frames of an animation, looked at in other frames before the work begins.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OTHER_FRAMES_H
#define MEN_OTHER_FRAMES_H

#include "cli/scene_input.h"

/* Evaluates the last two frames of the list beside the one that the input has built. STATUS_SCENE, with a report in the
 * input's diag, when something in them depends on the clock: the animation, or, where they count, the film's outputs. What
 * only frames in between say otherwise is left to be found in their turn. */
ATTR_NODISCARD Status other_frames_check(SceneInput *input, const FrameList *frames, bool outputs, Error *error);

#endif
