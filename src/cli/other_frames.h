/* other_frames.h - what must be the same in all frames of an animation, looked at in other frames before the work begins.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_OTHER_FRAMES_H
#define MEN_OTHER_FRAMES_H

#include "cli/scene_input.h"

/* Evaluates other frames of the list than its first, which the input has built: the last two, and as many of the rest as are
 * soon evaluated, spread over all of them. STATUS_SCENE, with a report in the input's diag, when something in them depends
 * on the clock: the animation, or, where they count, the film's outputs; and when the last frame has mistakes that show when it
 * is evaluated, until its shutter closes. What only frames that are not looked at say otherwise, and mistakes of others, are left
 * to be found in their turn. */
ATTR_NODISCARD Status other_frames_check(SceneInput *input, const FrameList *frames, bool outputs, Error *error);

#endif
