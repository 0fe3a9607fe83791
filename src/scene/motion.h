/* motion.h - what moves while the shutter is open.
 * Nobody writes down how things move: a scene says where everything is at any clock, so it is built again for several
 * clocks within the time that the shutter is open, and what differs moves. Things are told apart by the place in the
 * text that makes them, with the calls and turns of loops around it (EvalNode.identity).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MOTION_H
#define MEN_MOTION_H

#include "scene/build.h"

/* Fills in the motions of a scene that was built at `instant`, when the shutter opens: of objects, area lights and
 * cameras, and of meshes whose triangles stay the same. What is there at some of the times only stands still where it
 * was last. Everything else - media, surfaces, distant lights, the environment - is as when the shutter opens.
 * STATUS_SCENE, after reporting, when the scene has mistakes at one of the other times. */
ATTR_NODISCARD Status scene_find_motion(const SceneText *text, const SceneOptions *options, const SceneInstant *instant,
                                        Diag *diag, Scene *scene, Error *error);

#endif
