/* geometry.h - what a scene can ask of the shape of its nodes while it is evaluated: bounds, inside and outside, rays.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_GEOMETRY_H
#define MEN_GEOMETRY_H

#include "lang/eval.h"

/* Its context is a SceneOptions. Answers are in double: rays meet the surfaces of the objects as they are, not as they are
 * stored for tracing. What is built for a question is kept for the next ones, up to 1 GiB. No threads are used, and no answer
 * depends on the questions before it. */
extern const EvalGeometry scene_geometry;

#endif
