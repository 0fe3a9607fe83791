/* vec3.h - vectors and affine maps. Double (Vec3) for scene set-up and for every decision about
 * which side of a surface a point is on; float (Vec3f) for what is stored in bulk and for shading.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_VEC3_H
#define MEN_VEC3_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct Vec3 {
    double x, y, z;
} Vec3;

typedef struct Vec3f {
    float x, y, z;
} Vec3f;

/* plain comparisons: fmax and fmin are calls of the mathematical library under our flags; not for NaN */
static inline double double_max(double a, double b)
{
    return a > b ? a : b;
}
static inline double double_min(double a, double b)
{
    return a < b ? a : b;
}
static inline Vec3 vec3(double x, double y, double z)
{
    return (Vec3){x, y, z};
}
static inline Vec3 vec3_add(Vec3 a, Vec3 b)
{
    return vec3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline Vec3 vec3_sub(Vec3 a, Vec3 b)
{
    return vec3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline Vec3 vec3_scale(Vec3 a, double s)
{
    return vec3(a.x * s, a.y * s, a.z * s);
}
/* a + s * b */
static inline Vec3 vec3_along(Vec3 a, double s, Vec3 b)
{
    return vec3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double vec3_dot(Vec3 a, Vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline Vec3 vec3_cross(Vec3 a, Vec3 b)
{
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double vec3_length(Vec3 a)
{
    return sqrt(vec3_dot(a, a));
}
static inline Vec3 vec3_normalize(Vec3 a)
{
    return vec3_scale(a, 1 / vec3_length(a));
}
static inline double vec3_max_abs(Vec3 a)
{
    return double_max(fabs(a.x), double_max(fabs(a.y), fabs(a.z)));
}
static inline bool vec3_is_finite(Vec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}
static inline Vec3 vec3_from_f(Vec3f a)
{
    return vec3((double)a.x, (double)a.y, (double)a.z);
}

static inline Vec3f vec3f(float x, float y, float z)
{
    return (Vec3f){x, y, z};
}
static inline Vec3f vec3f_add(Vec3f a, Vec3f b)
{
    return vec3f(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline Vec3f vec3f_sub(Vec3f a, Vec3f b)
{
    return vec3f(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline Vec3f vec3f_scale(Vec3f a, float s)
{
    return vec3f(a.x * s, a.y * s, a.z * s);
}
static inline Vec3f vec3f_along(Vec3f a, float s, Vec3f b)
{
    return vec3f(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline float vec3f_dot(Vec3f a, Vec3f b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline Vec3f vec3f_cross(Vec3f a, Vec3f b)
{
    return vec3f(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float vec3f_length(Vec3f a)
{
    return sqrtf(vec3f_dot(a, a));
}
static inline Vec3f vec3f_normalize(Vec3f a)
{
    return vec3f_scale(a, 1 / vec3f_length(a));
}
static inline Vec3f vec3f_negate(Vec3f a)
{
    return vec3f(-a.x, -a.y, -a.z);
}
/* Between two vectors, radians: true to small angles, too. */
static inline double vec3_angle(Vec3 a, Vec3 b)
{
    return atan2(vec3_length(vec3_cross(a, b)), vec3_dot(a, b));
}
/* Rounds to the nearest float vector. */
static inline Vec3f vec3f_from(Vec3 a)
{
    return vec3f((float)a.x, (float)a.y, (float)a.z);
}
/* Rounded to floats, as doubles. vec3_from_f(vec3f_from(a)) is not: gcc 12 makes vectors of neighbouring doubles and takes what
 * rounds them and back for nothing; `make lint` finds such places. */
Vec3 vec3_rounded(Vec3 a);

/* p -> m p + t; columns of m are the images of the axes: m[row][column]. */
typedef struct Affine {
    double m[3][3];
    Vec3 t;
} Affine;

static inline Affine affine_identity(void)
{
    return (Affine){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}};
}
static inline Vec3 affine_vector(const Affine *a, Vec3 v)
{
    return vec3(a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z);
}
static inline Vec3 affine_point(const Affine *a, Vec3 p)
{
    return vec3_add(affine_vector(a, p), a->t);
}
/* The transposed linear part applied to v: with a the INVERSE map, this takes normals outward. */
static inline Vec3 affine_normal(const Affine *inverse, Vec3 n)
{
    return vec3(inverse->m[0][0] * n.x + inverse->m[1][0] * n.y + inverse->m[2][0] * n.z,
                inverse->m[0][1] * n.x + inverse->m[1][1] * n.y + inverse->m[2][1] * n.z,
                inverse->m[0][2] * n.x + inverse->m[1][2] * n.y + inverse->m[2][2] * n.z);
}
/* The linear part's cofactors applied to n: an area with the unit normal n becomes one that is larger by the length of
 * this, and faces along it (against it, where the map mirrors). */
static inline Vec3 affine_area(const Affine *a, Vec3 n)
{
    Vec3 x = vec3(a->m[0][0], a->m[1][0], a->m[2][0]), y = vec3(a->m[0][1], a->m[1][1], a->m[2][1]),
         z = vec3(a->m[0][2], a->m[1][2], a->m[2][2]);
    return vec3_along(vec3_along(vec3_scale(vec3_cross(y, z), n.x), n.y, vec3_cross(z, x)), n.z, vec3_cross(x, y));
}
/* The same along it in any case, of a map that is known to mirror or not to: from a direction outward to one outward behind it. */
static inline Vec3 affine_outward(const Affine *a, bool mirrors, Vec3 n)
{
    return vec3_scale(affine_area(a, n), mirrors ? -1 : 1);
}
/* The map at a time 0..1, of n >= 2 maps that are evenly spread over it; linear between them, entry by entry. */
Affine affine_between(const Affine *keys, uint32_t n, double time);
/* first b, then a */
Affine affine_compose(const Affine *a, const Affine *b);
double affine_determinant(const Affine *a);
/* The largest factor by which the map stretches a length, at most sqrt(3) too large. */
double affine_max_stretch(const Affine *a);
/* The same, and not too large where the axes stay at right angles to each other. */
double affine_largest_stretch(const Affine *a);
/* false when the map is singular or not finite. */
bool affine_invert(const Affine *a, Affine *inverse);
bool affine_is_identity(const Affine *a);
/* By how much a map scales that turns, moves, mirrors and scales evenly, to within slack; 0 of others. */
double affine_even_scale(const Affine *a, double slack);

/* An axis-aligned box; empty when min > max. */
typedef struct Box3 {
    Vec3 min, max;
} Box3;

static inline Box3 box3_empty(void)
{
    return (Box3){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}
static inline Box3 box3_add_point(Box3 b, Vec3 p)
{
    b.min = vec3(double_min(p.x, b.min.x), double_min(p.y, b.min.y), double_min(p.z, b.min.z));
    b.max = vec3(double_max(p.x, b.max.x), double_max(p.y, b.max.y), double_max(p.z, b.max.z));
    return b;
}
static inline Box3 box3_union(Box3 a, Box3 b)
{
    return box3_add_point(box3_add_point(a, b.min), b.max);
}
static inline bool box3_is_empty(Box3 b)
{
    return !(b.min.x <= b.max.x);
}
/* the origin for an empty one */
static inline Vec3 box3_centre(Box3 b)
{
    return box3_is_empty(b) ? vec3(0, 0, 0) : vec3_scale(vec3_add(b.min, b.max), 0.5);
}
static inline bool box3_is_unbounded(Box3 b)
{
    return !box3_is_empty(b) && !(vec3_is_finite(b.min) && vec3_is_finite(b.max));
}
/* Bounds included. */
static inline bool box3_holds_point(Box3 b, Vec3 p)
{
    return p.x >= b.min.x && p.x <= b.max.x && p.y >= b.min.y && p.y <= b.max.y && p.z >= b.min.z && p.z <= b.max.z;
}
/* Number corner of 8: its bits are x, y and z, 1: the larger side. */
static inline Vec3 box3_corner(Box3 b, int corner)
{
    return vec3(corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y, corner & 4 ? b.max.z : b.min.z);
}

static inline bool box3_meets(Box3 a, Box3 b)
{
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
           b.min.z <= a.max.z;
}
static inline bool box3_holds(Box3 outer, Box3 inner)
{
    return box3_holds_point(outer, inner.min) && box3_holds_point(outer, inner.max);
}
static inline Box3 box3_intersection(Box3 a, Box3 b)
{
    Box3 box = {vec3(fmax(a.min.x, b.min.x), fmax(a.min.y, b.min.y), fmax(a.min.z, b.min.z)),
                vec3(fmin(a.max.x, b.max.x), fmin(a.max.y, b.max.y), fmin(a.max.z, b.max.z))};
    return box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z ? box : box3_empty();
}
/* The stretch of a line, from + t direction, within a box; false: it passes it by. */
bool box3_cut(const Box3 *box, Vec3 from, Vec3 direction, double *enter, double *leave);
/* The box around the image of b. */
Box3 affine_box(const Affine *a, Box3 b);

typedef struct Ball {
    Vec3 centre;
    double radius;
} Ball;

#endif
