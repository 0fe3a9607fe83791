/* camera.c - from places of the film to rays: projections, and a thin lens.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>

#include "base/angle.h"
#include "optics/sampling.h"
#include "trace/path.h"

/* Of a panorama: right and up are angles around the camera's up, and from its horizon. A sample of a pixel at the edge of the film,
 * which its filter takes from beyond that, goes on over the pole. */
static bool look_around(const SceneCamera *camera, double right, double up, double beyond, Vec3 *direction)
{
    const double quarter = 0.5 * MEN_PI;
    if (fabs(up) > quarter * (1 + 1e-9) + beyond) return false;
    double level = cos(up);
    *direction = vec3_along(vec3_scale(camera->forward, level * cos(right)), level * sin(right), camera->right);
    *direction = vec3_along(*direction, sin(up), camera->up);
    return true;
}

/* Of a fisheye: right and up are parts of the angle from forward. What is beyond the circle over the film's width is not seen. */
static bool look_aside(const SceneCamera *camera, double right, double up, Vec3 *direction)
{
    double angle = hypot(right, up);
    if (angle > camera->half_width) return false;
    double part = angle > 0 ? sin(angle) / angle : 1;
    *direction = vec3_along(vec3_scale(camera->forward, cos(angle)), part * right, camera->right);
    *direction = vec3_along(*direction, part * up, camera->up);
    return true;
}

/* 1 / how many times a line of sight's direction it is to the plane that is sharp. A lens through whose middle light goes straight
 * shows planes as planes (Scheimpflug's rule), and what would be sharp behind it is a point that rays come apart from: so this may be
 * 0 and less. Deviation: the lens stays parallel to the film, however that plane lies. */
static double nearness_of_focus(const SceneCamera *camera, double x, double y)
{
    double across = camera->focus[0] * x + camera->focus[1] * y, along = camera->focus[2];
    if (camera->projection != PROJECTION_ORTHOGRAPHIC) return along + across;
    double distance =
        1 - across; /* in units of that in the middle; not 0, where the plane goes through where the line starts */
    return along / (distance + copysign(1e-12, distance));
}

bool camera_ray(const SceneCamera *camera, FilmPoint point, const float lens[2], Ray *ray, Footprint *footprint)
{
    double pixel = 2 * camera->half_width / (double)point.width; /* its side: at distance 1, a length, or an angle */
    double x = (point.x - 0.5 * (double)point.width) * pixel + camera->shift[0],
           y = (0.5 * (double)point.height - point.y) * pixel + camera->shift[1];
    float half = (float)(camera->half_width / point.width);
    Vec3 origin = camera->from, direction = vec3_along(vec3_along(camera->forward, x, camera->right), y, camera->up);
    *footprint = (Footprint){.spread = half};
    if (UNLIKELY(camera->projection != PROJECTION_PERSPECTIVE)) {
        bool sees = true;
        double beyond = point.y < 0 || point.y > point.height ? 0.51 * pixel : 0;
        if (camera->projection == PROJECTION_PANORAMA) sees = look_around(camera, x, y, beyond, &direction);
        if (camera->projection == PROJECTION_FISHEYE) sees = look_aside(camera, x, y, &direction);
        if (!sees) return false;
        if (camera->projection == PROJECTION_ORTHOGRAPHIC) {
            origin = vec3_along(vec3_along(origin, x, camera->right), y, camera->up);
            direction = camera->forward;
            *footprint = (Footprint){.width = half};
        }
    }
    if (camera->lens_radius > 0) {
        float lens_x, lens_y;
        if (camera->iris.n_corners)
            sampling_polygon(lens[0], lens[1], camera->iris.corners, camera->iris.n_corners, &lens_x, &lens_y);
        else
            sampling_disc(lens[0], lens[1], &lens_x, &lens_y);
        Vec3 lens_place = vec3_along(vec3_scale(camera->right, (double)lens_x * camera->lens_radius),
                                     (double)lens_y * camera->lens_radius, camera->up);
        origin = vec3_add(origin, lens_place);
        direction = vec3_along(direction, -nearness_of_focus(camera, x, y), lens_place);
    }
    *ray = ray_make(origin, vec3f_from(vec3_normalize(direction)));
    return true;
}

bool camera_pixel(const SceneCamera *camera, Vec3 place, uint32_t width, uint32_t height, uint32_t *x, uint32_t *y)
{
    Vec3 away = vec3_sub(place, camera->from);
    double right = vec3_dot(away, camera->right), up = vec3_dot(away, camera->up),
           ahead = vec3_dot(away, camera->forward);
    if (camera->projection == PROJECTION_ORTHOGRAPHIC)
        ahead = 1;
    else if (camera->projection != PROJECTION_PERSPECTIVE || !(ahead > 0))
        return false;
    double pixel = 2 * camera->half_width / width;
    double column = (right / ahead - camera->shift[0]) / pixel + 0.5 * width,
           row = 0.5 * height - (up / ahead - camera->shift[1]) / pixel;
    if (!(column >= 0 && column < width && row >= 0 && row < height)) return false;
    *x = (uint32_t)column;
    *y = (uint32_t)row;
    return true;
}
