/* viewpoint.h - from where a scene is seen, and in how many pixels: what --camera, --size and --scale say, else the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VIEWPOINT_H
#define MEN_VIEWPOINT_H

#include "check/report.h"
#include "cli/scene_input.h"

/* In pixels. STATUS_USAGE where a side is beyond what a picture can have. */
ATTR_NODISCARD Status viewpoint_size(const SceneInput *input, uint32_t *width, uint32_t *height, Error *error);
/* The ray of a compiled scene's camera through the middle of a pixel of a picture of that size. STATUS_USAGE, named after the option,
 * where there is no such pixel, or nothing is to be seen there. */
ATTR_NODISCARD Status viewpoint_ray(const CompiledScene *compiled, uint32_t camera, const uint32_t pixel[2],
                                    uint32_t width, uint32_t height, const char *option, Ray *ray, Error *error);
/* A row of the scene's cameras. STATUS_SCENE, after a report, when there is no camera of that name. */
ATTR_NODISCARD Status viewpoint_camera(SceneInput *input, uint32_t *camera, Error *error);
/* What a picture shows, for reports on lights without size: no place where there is no such light, or memory ends. */
enum { VIEWPOINT_PLACES = 576 };
ReportView viewpoint_look(const SceneInput *input, uint32_t camera, uint32_t width, uint32_t height,
                          Vec3 places[VIEWPOINT_PLACES]);
/* Adds the options of a command line that say the same: " --camera closeup --size 64x48", or nothing. */
void viewpoint_add_options(const SceneInput *input, uint32_t width, uint32_t height, Buf *out);

#endif
