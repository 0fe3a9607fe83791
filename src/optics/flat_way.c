/* flat_way.c - see flat_way.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/flat_way.h"

#include <math.h>

/* Two unit vectors across a direction, and across each other. */
static void axes_across(Vec3 direction, Vec3 axes[2])
{
    Vec3 other = fabs(direction.x) < 0.5 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    axes[0] = vec3_normalize(vec3_cross(direction, other));
    axes[1] = vec3_cross(direction, axes[0]);
}

static Vec3 across(Vec3 direction, Vec3 v)
{
    return vec3_along(v, -vec3_dot(v, direction), direction);
}

/* On to a face; false: it is behind. */
static bool go_to(const FlatFace *face, FlatRay *ray)
{
    double slope = vec3_dot(face->normal, ray->direction);
    double t = (face->offset - vec3_dot(face->normal, ray->origin)) / slope;
    if (!(t >= 0)) return false;
    for (int i = 0; i < 2; i++) {
        Vec3 moved = vec3_along(ray->origin_turned[i], t, ray->direction_turned[i]);
        ray->origin_turned[i] = vec3_along(moved, -vec3_dot(face->normal, moved) / slope, ray->direction);
    }
    ray->origin = vec3_along(ray->origin, t, ray->direction);
    return true;
}

/* False: all of it is reflected. */
static bool turn_at(const FlatFace *face, FlatRay *ray)
{
    double slope = vec3_dot(face->normal, ray->direction), eta = face->eta;
    Vec3 normal = vec3_scale(face->normal, slope > 0 ? -1 : 1); /* against the ray */
    double cosine = fabs(slope), square = 1 - eta * eta * (1 - cosine * cosine);
    if (!face->mirrored && !(square > 0)) return false;
    double behind = sqrt(fmax(square, 0)), along = face->mirrored ? 2 * cosine : eta * cosine - behind;
    if (face->mirrored) eta = 1;
    for (int i = 0; i < 2; i++) {
        Vec3 turned = ray->direction_turned[i];
        double more = -vec3_dot(normal, turned), more_along = 2 * more;
        if (!face->mirrored) more_along = (eta - eta * eta * cosine / behind) * more;
        ray->direction_turned[i] = vec3_along(vec3_scale(turned, eta), more_along, normal);
    }
    ray->direction = vec3_normalize(vec3_along(vec3_scale(ray->direction, eta), along, normal));
    return true;
}

bool flat_way_follow(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 direction, FlatRay *ray)
{
    *ray = (FlatRay){.origin = from, .direction = direction};
    axes_across(direction, ray->direction_turned);
    for (uint32_t i = 0; i < n; i++)
        if (!go_to(&faces[i], ray) || !turn_at(&faces[i], ray)) return false;
    return true;
}

/* How a point beside the ray, as far along as `to`, moves. */
static void moved_at(const FlatRay *ray, Vec3 to, Vec3 moved[2])
{
    double t = vec3_dot(vec3_sub(to, ray->origin), ray->direction);
    for (int i = 0; i < 2; i++)
        moved[i] = across(ray->direction, vec3_along(ray->origin_turned[i], t, ray->direction_turned[i]));
}

double flat_ray_spread(const FlatRay *ray, Vec3 to)
{
    Vec3 moved[2];
    moved_at(ray, to, moved);
    return fabs(vec3_dot(vec3_cross(moved[0], moved[1]), ray->direction));
}

/* By how much the ray passes the point; infinite: it does not come there. */
static double miss_of(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 to, Vec3 direction, FlatRay *ray, Vec3 *miss)
{
    *miss = vec3(0, 0, 0);
    if (!flat_way_follow(faces, n, from, direction, ray)) return HUGE_VAL;
    Vec3 left = vec3_sub(to, ray->origin);
    *miss = across(ray->direction, left);
    return vec3_dot(left, ray->direction) >= 0 ? vec3_length(*miss) : HUGE_VAL;
}

/* Where a point seems to be by the faces that mirror. */
static Vec3 mirrored_image(const FlatFace *faces, uint32_t n, Vec3 point)
{
    for (uint32_t i = n; i-- > 0;) {
        if (!faces[i].mirrored) continue;
        double above = vec3_dot(point, faces[i].normal) - faces[i].offset;
        point = vec3_along(point, -2 * above, faces[i].normal);
    }
    return point;
}

/* A start: as it leaves, where that is known; straight ahead, or where that is reflected totally, steeper towards the first face.
 * By how much it misses. */
static double first_guess(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 to, const Vec3 *leaving, Vec3 *direction,
                          FlatRay *ray, Vec3 *miss)
{
    enum { TRIES = 8 };
    double spread;
    if (leaving && flat_way_leaving(faces, n, *leaving, direction, &spread)) {
        double missed = miss_of(faces, n, from, to, *direction, ray, miss);
        if (isfinite(missed)) return missed;
    }
    const Vec3 straight = vec3_normalize(vec3_sub(mirrored_image(faces, n, to), from));
    Vec3 steep = n ? faces[0].normal : straight;
    if (vec3_dot(steep, straight) < 0) steep = vec3_scale(steep, -1);
    *direction = straight;
    double missed = miss_of(faces, n, from, to, straight, ray, miss);
    for (int i = 0; i < TRIES && !isfinite(missed); i++) {
        *direction = vec3_normalize(vec3_along(straight, 0.25 * (1 << i), steep));
        missed = miss_of(faces, n, from, to, *direction, ray, miss);
    }
    return missed;
}

bool flat_way_find(const FlatFace *faces, uint32_t n, Vec3 from, Vec3 to, const Vec3 *leaving, Vec3 *direction,
                   FlatRay *ray)
{
    enum { STEPS = 16, HALVINGS = 8 };
    const double least = 1e-8 * vec3_length(vec3_sub(to, from)), most_turn = 0.5;
    Vec3 miss;
    double missed = first_guess(faces, n, from, to, leaving, direction, ray, &miss);
    for (int step = 0; step < STEPS && isfinite(missed); step++) {
        if (missed <= least) return true;
        Vec3 moved[2], axes[2];
        moved_at(ray, to, moved);
        axes_across(*direction, axes);
        Vec3 along = ray->direction;
        double area = vec3_dot(vec3_cross(moved[0], moved[1]), along);
        double turn[2] = {vec3_dot(vec3_cross(miss, moved[1]), along) / area,
                          vec3_dot(vec3_cross(moved[0], miss), along) / area};
        double part = fmin(1, most_turn / hypot(turn[0], turn[1])), now = HUGE_VAL;
        Vec3 tried = *direction;
        for (int i = 0; i < HALVINGS && !(now < missed); i++, part *= 0.5) {
            tried =
                vec3_normalize(vec3_along(vec3_along(*direction, part * turn[0], axes[0]), part * turn[1], axes[1]));
            now = miss_of(faces, n, from, to, tried, ray, &miss);
        }
        if (!(now < missed)) return false;
        *direction = tried;
        missed = now;
    }
    return missed <= least;
}

bool flat_way_leaving(const FlatFace *faces, uint32_t n, Vec3 leaving, Vec3 *direction, double *spread)
{
    *direction = leaving;
    *spread = 1;
    for (uint32_t i = n; i-- > 0;) {
        const FlatFace *face = &faces[i];
        double slope = vec3_dot(face->normal, *direction), back = 1 / face->eta;
        if (face->mirrored) {
            *direction = vec3_along(*direction, -2 * slope, face->normal);
            continue;
        }
        double square = 1 - back * back * (1 - slope * slope);
        if (!(square > 0) || slope == 0) return false;
        double before = copysign(sqrt(square), slope);
        *direction = vec3_normalize(vec3_along(vec3_scale(*direction, back), before - back * slope, face->normal));
        *spread *= face->eta * face->eta * before / slope; /* etendue */
    }
    return true;
}
