/* viewpoint.h - from where a scene is seen, and in how many pixels: what --camera, --size and --scale say, else the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VIEWPOINT_H
#define MEN_VIEWPOINT_H

#include "cli/scene_input.h"

/* In pixels. STATUS_USAGE where a side is beyond what a picture can have. */
ATTR_NODISCARD Status viewpoint_size(const SceneInput *input, uint32_t *width, uint32_t *height, Error *error);
/* A row of the scene's cameras. STATUS_SCENE, after a report, when there is no camera of that name. */
ATTR_NODISCARD Status viewpoint_camera(SceneInput *input, uint32_t *camera, Error *error);
/* Warns of lights without size that leave a part of a picture in the dark, behind what bends their light. For guarded tasks; where
 * memory ends nothing is said: what needs more will. */
void viewpoint_report_unlit(SceneInput *input, uint32_t camera, uint32_t width, uint32_t height);
/* Adds the options of a command line that say the same: " --camera closeup --size 64x48", or nothing. */
void viewpoint_add_options(const SceneInput *input, uint32_t width, uint32_t height, Buf *out);

#endif
