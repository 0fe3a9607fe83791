/* camera.c - a thin lens.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sampling.h"
#include "trace/path.h"

void camera_ray(const SceneCamera *camera, FilmPoint point, const float lens[2], Ray *ray)
{
    double width = (double)point.width, height = (double)point.height;
    double x = (2 * point.x / width - 1) * camera->tan_half_width;
    double y = (1 - 2 * point.y / height) * camera->tan_half_width * height / width;
    Vec3 direction = vec3_add(camera->forward, vec3_add(vec3_scale(camera->right, x), vec3_scale(camera->up, y)));
    Vec3 origin = camera->from;
    if (camera->lens_radius > 0) {
        float lens_x, lens_y;
        sampling_disc(lens[0], lens[1], &lens_x, &lens_y);
        Vec3 focus = vec3_along(camera->from, camera->focus_distance, direction);
        origin = vec3_along(origin, (double)lens_x * camera->lens_radius, camera->right);
        origin = vec3_along(origin, (double)lens_y * camera->lens_radius, camera->up);
        direction = vec3_sub(focus, origin);
    }
    *ray = ray_make(origin, vec3f_from(vec3_normalize(direction)));
}
