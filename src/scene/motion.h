/* motion.h - what moves while the shutter is open.
 * Nobody writes down how things move: a scene says where everything is at any clock, so it is built again for several
 * clocks within the time that the shutter is open, and what differs moves. Things are told apart by the place in the
 * text that makes them, with the calls and turns of loops around it (EvalNode.identity).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_MOTION_H
#define MEN_MOTION_H

#include "scene/build.h"

/* Fills in the motions of a scene that was built at `instant`, when the shutter opens: of objects, area lights and
 * cameras, of textures and volumes, and of meshes whose triangles stay the same; numbers and colours of textures are motions,
 * too. What is there at some of the times only stands still where it was last. Everything else - what media and surfaces say
 * themselves, distant lights, the environment - is as when the shutter opens, and what of it changes is told.
 * STATUS_SCENE, after reporting, when the scene has mistakes at one of the other times. */
ATTR_NODISCARD Status scene_find_motion(const SceneText *text, const SceneOptions *options, const SceneInstant *instant,
                                        Diag *diag, Scene *scene, Error *error);

/* Reports the first mistake of a scene that was evaluated or built `later` frames after the diag's moment, while the shutter is
 * open, at a clock; where it stands, if the same texts were read then. otherwise: what is told where `then` holds none. */
void scene_report_later(Diag *diag, const Diag *then, const char *otherwise, double later, double clock);

#endif
