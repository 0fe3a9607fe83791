/* scene_light.c - see scene_light.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene_light.h"

#include <math.h>

#include "base/angle.h"

void light_some_places(const SceneLight *light, Vec3 places[LIGHT_PLACES], Vec3 up[LIGHT_PLACES])
{
    double x = 0.5 * light->half_width, z = light->kind == LIGHT_DISC ? x : 0.5 * light->half_height;
    const Vec3 on_flat[LIGHT_PLACES] = {{0, 0, 0}, {x, 0, z}, {-x, 0, -z}, {-x, 0, z}, {x, 0, -z}};
    const Vec3 of_ball[LIGHT_PLACES] = {{0, 1, 0}, {.6, 0, .8}, {-.6, 0, .8}, {.6, 0, -.8}, {-.48, -.6, -.64}};
    for (int i = 0; i < LIGHT_PLACES; i++) {
        bool ball = light->kind == LIGHT_SPHERE;
        up[i] = affine_vector(&light->to_world, ball ? of_ball[i] : vec3(0, 1, 0));
        places[i] = affine_point(&light->to_world, ball ? vec3_scale(of_ball[i], light->half_width) : on_flat[i]);
    }
}

/* The angle about the axis as one of those that the profile has. */
static double fold(const LightProfile *profile, double angle)
{
    double first = (double)profile->horizontal[0], last = (double)profile->horizontal[profile->n_horizontal - 1];
    if (profile->n_horizontal == 1) return first;
    if (profile->type != PROFILE_C) return first < 0 ? angle : fabs(angle);
    if (first == 90) return angle < 90 ? 180 - angle : angle > 270 ? 540 - angle : angle; /* 90 .. 270 */
    if (last <= 180 && angle > 180) angle = 360 - angle;
    if (last <= 90 && angle > 90) angle = 180 - angle;
    return angle;
}

/* The interval of ascending values that holds x: its number, and where in it. */
static uint32_t find_interval(const float *values, uint32_t n, double x, double *part)
{
    uint32_t low = 0, high = n - 1;
    *part = 0;
    if (n < 2) return 0;
    while (high - low > 1) {
        uint32_t middle = low + (high - low) / 2;
        if ((double)values[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    *part = (x - (double)values[low]) / (double)(values[low + 1] - values[low]);
    *part = fmin(fmax(*part, 0), 1);
    return low;
}

/* The two angles of a direction, in degrees; false where a lamp of this type is dark. */
static bool profile_angles(ProfileType type, Vec3 direction, double *vertical, double *horizontal)
{
    if (type == PROFILE_C) {
        *vertical = atan2(hypot(direction.x, direction.z), direction.y) / MEN_DEGREE;
        *horizontal = atan2(direction.z, direction.x) / MEN_DEGREE;
        if (*horizontal < 0) *horizontal += 360;
        return true;
    }
    /* of A and B: the one angle about an axis, the other from the plane across it */
    Vec3 d = direction;
    double right = -d.x, up = -d.z;
    if (d.y < 0) return false;
    *vertical = (type == PROFILE_B ? atan2(up, d.y) : atan2(up, hypot(right, d.y))) / MEN_DEGREE;
    *horizontal = (type == PROFILE_B ? atan2(right, hypot(up, d.y)) : atan2(right, d.y)) / MEN_DEGREE;
    return true;
}

/* Angles in degrees, as the file has them but for the sign of the vertical one. */
static double profile_value(const LightProfile *profile, double vertical, double horizontal)
{
    uint32_t n = profile->n_vertical;
    if (profile->type != PROFILE_C && !(profile->vertical[0] < 0)) vertical = fabs(vertical);
    if (vertical < (double)profile->vertical[0] || vertical > (double)profile->vertical[n - 1]) return 0;
    double down, across;
    uint32_t row = find_interval(profile->vertical, n, vertical, &down);
    uint32_t column = find_interval(profile->horizontal, profile->n_horizontal, horizontal, &across);
    const float *left = profile->intensity + (size_t)column * n + row;
    const float *right = profile->n_horizontal > 1 ? left + n : left;
    double low = (double)left[0] + down * (double)(left[1] - left[0]),
           high = (double)right[0] + down * (double)(right[1] - right[0]);
    return low + across * (high - low);
}

static double profile_at(const LightProfile *profile, Vec3 direction)
{
    double vertical, horizontal;
    bool shines = profile_angles(profile->type, direction, &vertical, &horizontal);
    return shines ? profile_value(profile, vertical, fold(profile, horizontal)) : 0;
}

float light_shape(const SceneLight *light, Vec3 direction)
{
    if (light->profile) {
        if (light->mirrored) direction.z = -direction.z;
        return (float)profile_at(light->profile, direction);
    }
    if (direction.y >= light->cos_full) return 1;
    if (direction.y <= light->cos_none) return 0;
    double part = (direction.y - light->cos_none) / (light->cos_full - light->cos_none);
    return (float)(part * part * (3 - 2 * part));
}

/* The integral of the profile times the cosine of the latitude along a line of one longitude, over the latitude. Types C and A have
 * their vertical angles for latitudes, C's from the pole; type B its horizontal ones. Exact, as the profile is linear between its angles,
 * however narrow the beam is; so is the integral over the longitude below. */
static double along_longitude(const LightProfile *profile, double longitude)
{
    bool of_b = profile->type == PROFILE_B;
    const float *angles = of_b ? profile->horizontal : profile->vertical;
    uint32_t n = of_b ? profile->n_horizontal : profile->n_vertical;
    double pole = profile->type == PROFILE_C ? 90 : 0, sum = 0, before = 0, from = 0;
    for (uint32_t i = 0; i < n; i++) {
        double angle = (double)angles[i], at = (angle - pole) * MEN_DEGREE;
        double value = of_b ? profile_value(profile, longitude, angle) : profile_value(profile, angle, longitude);
        if (i > 0) {
            double slope = (value - before) / (at - from);
            sum += value * sin(at) - before * sin(from) + slope * (cos(at) - cos(from));
        }
        if (n == 1) sum = value; /* of 0 to 90 degrees */
        before = value;
        from = at;
    }
    return profile->type != PROFILE_C && !(angles[0] < 0) ? 2 * sum : sum;
}

static double profile_beam(const LightProfile *profile)
{
    bool of_b = profile->type == PROFILE_B, of_c = profile->type == PROFILE_C;
    const float *angles = of_b ? profile->vertical : profile->horizontal;
    uint32_t n = of_b ? profile->n_vertical : profile->n_horizontal;
    double all = of_c ? 360 : 180, range = (double)angles[n - 1] - (double)angles[0], sum = 0, before = 0;
    if (n == 1) return all * MEN_DEGREE * along_longitude(profile, (double)angles[0]);
    for (uint32_t i = 0; i < n; i++) {
        double here = along_longitude(profile, (double)angles[i]);
        if (i > 0) sum += 0.5 * (double)(angles[i] - angles[i - 1]) * (before + here);
        before = here;
    }
    return all / range * MEN_DEGREE * sum; /* the rest is mirrored */
}

double light_beam(const SceneLight *light)
{
    if (light->profile) return profile_beam(light->profile);
    double full = light->cos_full, none = light->cos_none, fade = full - none;
    if (light->kind == LIGHT_POINT) return 2 * MEN_PI * (1 - 0.5 * (full + none)); /* the smooth step's mean is 1/2, */
    return MEN_PI * (1 - full * full) +
           2 * MEN_PI * fade * (0.5 * none + 0.35 * fade); /* and times its place it is 0.35 */
}
