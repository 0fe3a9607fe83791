/* camera.c - from places of the film to rays: projections, and a thin lens.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/sampling.h"
#include "trace/path.h"

void camera_ray(const SceneCamera *camera, FilmPoint point, const float lens[2], Ray *ray, Footprint *footprint)
{
    double pixel = 2 * camera->half_width / (double)point.width; /* its side, in perspective at distance 1 */
    double x = (point.x - 0.5 * (double)point.width) * pixel, y = (0.5 * (double)point.height - point.y) * pixel;
    float half = (float)(camera->half_width / point.width);
    Vec3 origin = camera->from, direction = vec3_along(vec3_along(camera->forward, x, camera->right), y, camera->up);
    *footprint = (Footprint){.spread = half};
    if (UNLIKELY(camera->projection == PROJECTION_ORTHOGRAPHIC)) {
        origin = vec3_along(vec3_along(origin, x, camera->right), y, camera->up);
        direction = camera->forward;
        *footprint = (Footprint){.width = half};
    }
    if (camera->lens_radius > 0) {
        float lens_x, lens_y;
        sampling_disc(lens[0], lens[1], &lens_x, &lens_y);
        Vec3 focus = vec3_along(origin, camera->focus_distance, direction);
        origin = vec3_along(origin, (double)lens_x * camera->lens_radius, camera->right);
        origin = vec3_along(origin, (double)lens_y * camera->lens_radius, camera->up);
        direction = vec3_sub(focus, origin);
    }
    *ray = ray_make(origin, vec3f_from(vec3_normalize(direction)));
}
