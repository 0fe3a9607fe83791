/* light_flat.c - see light_flat.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/light_flat.h"

#include "optics/sampling.h"

/* Its area and unit normal. Between two places that it moves through it may be squeezed. */
static double find_area(const SceneLight *light, const Affine *to_world, Vec3 *normal)
{
    double area = light->kind == LIGHT_DISC ? (double)SAMPLING_PI * light->half_width * light->half_width
                                            : 4 * light->half_width * light->half_height;
    if (to_world == &light->to_world) { /* rigid */
        *normal = affine_vector(to_world, vec3(0, 1, 0));
        return area;
    }
    Vec3 across = vec3_cross(affine_vector(to_world, vec3(0, 0, 1)), affine_vector(to_world, vec3(1, 0, 0)));
    double stretch = vec3_length(across);
    *normal = vec3_scale(across, 1 / stretch);
    return area * stretch;
}

/* In the light's own frame. */
static Vec3 local_point(const SceneLight *light, const float u[2])
{
    if (light->kind == LIGHT_DISC) {
        float x, z;
        sampling_disc(u[0], u[1], &x, &z);
        return vec3((double)x * light->half_width, 0, (double)z * light->half_width);
    }
    return vec3((2 * (double)u[0] - 1) * light->half_width, 0, (2 * (double)u[1] - 1) * light->half_height);
}

Vec3 light_flat_point(const SceneLight *light, const Affine *to_world, const float u[2])
{
    return affine_point(to_world, local_point(light, u));
}

double light_flat_area(const SceneLight *light, const Affine *to_world)
{
    Vec3 normal;
    return find_area(light, to_world, &normal);
}

double light_flat_extent(const SceneLight *light)
{
    Vec3 normal;
    double sine2 = 1 - light->cos_none * light->cos_none;
    return find_area(light, &light->to_world, &normal) * (double)SAMPLING_PI * sine2;
}

void light_flat_send(const SceneLight *light, const Affine *to_world, const float u[2], const float v[2], Vec3 *origin,
                     Vec3f *direction)
{
    Vec3 normal;
    Vec3f across, beside;
    float x, y, sine = (float)sqrt(1 - light->cos_none * light->cos_none);
    find_area(light, to_world, &normal); /* of what has no size this is its axis */
    sampling_disc(v[0], v[1], &x, &y);   /* the cone's directions, seen from above */
    x *= sine, y *= sine;
    sampling_basis(vec3f_from(normal), &across, &beside);
    *origin = light_is_flat(light) ? light_flat_point(light, to_world, u) : to_world->t;
    *direction = vec3f_along(vec3f_scale(across, x), y, beside);
    *direction = vec3f_along(*direction, sqrtf(float_max(1 - x * x - y * y, 0)), vec3f_from(normal));
}

/* A rectangle of the light's plane, in its frame. */
typedef struct Patch {
    double x0, x1, z0, z1;
} Patch;

static double area_of(const Patch *patch)
{
    return (patch->x1 - patch->x0) * (patch->z1 - patch->z0);
}

/* The part of a light that shines into a cone which may shine at a point: behind a grid one sees little of a large one. False where
 * all of it may as well be sampled. One that moves may be squeezed, and is sampled as a whole, too. */
static bool find_patch(const SceneLight *light, const Affine *to_world, Vec3 from, Patch *patch)
{
    if (!light_is_focused(light) || to_world != &light->to_world) return false;
    Vec3 local = affine_normal(to_world, vec3_sub(from, to_world->t)); /* rigid: the transpose inverts it */
    double reach = fmax(local.y, 0) * sqrt(1 - light->cos_none * light->cos_none) / light->cos_none;
    double w = light->half_width, h = light->half_height;
    *patch = (Patch){fmax(local.x - reach, -w), fmin(local.x + reach, w), fmax(local.z - reach, -h),
                     fmin(local.z + reach, h)};
    if (patch->x0 >= patch->x1 || patch->z0 >= patch->z1) *patch = (Patch){0, 0, 0, 0};
    return light->kind == LIGHT_RECT || area_of(patch) < (double)SAMPLING_PI * w * w;
}

static Vec3 point_of_patch(const Patch *patch, const float u[2])
{
    return vec3(patch->x0 + (double)u[0] * (patch->x1 - patch->x0), 0,
                patch->z0 + (double)u[1] * (patch->z1 - patch->z0));
}

void light_flat_sample(const SceneLight *light, const Affine *to_world, Vec3 from, const float u[2],
                       LightSample *sample, float *radiance)
{
    Vec3 normal;
    Patch patch;
    double area = find_area(light, to_world, &normal), w = light->half_width;
    bool in_patch = find_patch(light, to_world, from, &patch);
    Vec3 local = in_patch ? point_of_patch(&patch, u) : local_point(light, u);
    if (in_patch) area = area_of(&patch);
    Vec3 place = affine_point(to_world, local), to = vec3_sub(place, from);
    double distance = vec3_length(to), cosine = -vec3_dot(to, normal) / distance;
    *sample = (LightSample){.pdf_w = 0};
    *radiance = !(cosine > 0) ? 0 : UNLIKELY(light_is_focused(light)) ? light_shape(light, vec3(0, cosine, 0)) : 1;
    bool beside = in_patch && light->kind == LIGHT_DISC && local.x * local.x + local.z * local.z > w * w;
    if (!(*radiance > 0) || !(area > 0) || beside) return;
    double short_of = light_short_of(distance, cosine, place);
    *sample = (LightSample){.direction = vec3f_from(vec3_scale(to, 1 / distance)),
                            .distance = distance - short_of,
                            .short_of = short_of,
                            .object = light->object,
                            .primitive = RTC_NO_OBJECT,
                            .pdf_w = (float)(distance * distance / (cosine * area))};
}

float light_flat_pdf(const SceneLight *light, const Affine *to_world, Vec3 from, const Ray *ray, const Hit *hit)
{
    Vec3 normal, to = vec3_sub(ray_point(ray, hit->t), from);
    Patch patch;
    double area = find_area(light, to_world, &normal);
    if (light_is_focused(light) && !(light_flat_radiance(light, to_world, ray->direction) > 0)) return 0;
    if (find_patch(light, to_world, from, &patch)) area = area_of(&patch);
    return area > 0 ? (float)(vec3_dot(to, to) / (fabs(hit->cos_normal) * area)) : 0;
}

float light_flat_radiance(const SceneLight *light, const Affine *to_world, Vec3f direction)
{
    Vec3 normal, along = vec3_from_f(direction);
    find_area(light, to_world, &normal);
    return light_shape(light, vec3(0, -vec3_dot(along, normal) / vec3_length(along), 0));
}

bool light_cut_to_cone(Vec3 origin, Vec3 direction, Vec3 axis, double cosine, double *begin, double *end)
{
    double height = vec3_dot(origin, axis), rise = vec3_dot(direction, axis), square = cosine * cosine;
    double a = rise * rise - square, b = height * rise - square * vec3_dot(origin, direction);
    double c = height * height - square * vec3_dot(origin, origin);
    if (square == 0 ||
        fabs(a) < 1e-12) { /* half of space; or along the cone's side, where half of space is not too little */
        if (rise == 0) return height > 0;
        if (rise > 0)
            *begin = fmax(*begin, -height / rise);
        else
            *end = fmin(*end, -height / rise);
        return *begin < *end;
    }
    double root = b * b - a * c;
    if (!(root > 0)) return false;
    root = sqrt(root);
    double first = (-b - copysign(root, a)) / a, last = (-b + copysign(root, a)) / a;
    if (a < 0) { /* both ends of a chord, of this cone or of the one opposite */
        if (height + 0.5 * (first + last) * rise < 0) return false;
        *begin = fmax(*begin, first);
        *end = fmin(*end, last);
    } else if (rise > 0) { /* it leaves the cone opposite first */
        *begin = fmax(*begin, last);
    } else {
        *end = fmin(*end, first);
    }
    return *begin < *end;
}

/* All its points' cones are within one, whose tip is behind it. */
bool light_flat_reach(const SceneLight *light, const Affine *to_world, Vec3 origin, Vec3f direction, double *begin,
                      double *end)
{
    Vec3 normal, along = vec3_from_f(direction), from = vec3_sub(origin, to_world->t);
    find_area(light, to_world, &normal);
    if (!light_cut_to_cone(from, along, normal, 0, begin, end)) return false;
    if (!light_is_focused(light)) return true;
    double radius = light->kind == LIGHT_DISC ? light->half_width : hypot(light->half_width, light->half_height);
    double behind = radius * light->cos_none / sqrt(1 - light->cos_none * light->cos_none);
    return light_cut_to_cone(vec3_along(from, behind, normal), along, normal, light->cos_none, begin, end);
}
