/* rtc_convex.c - a convex mesh as the planes of its faces. A line leaves it by the plane that it comes to first of those that it
 * goes out through, and of some sixty planes, four at once, that is found sooner than in a hierarchy.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_convex.h"

#include <stdlib.h>
#include <string.h>

#include "geom/rtc_query.h"

typedef struct Plane {
    Vec3 normal;   /* unit, outward */
    double height; /* of the plane, over the centre */
} Plane;

/* Four planes; where there are no more, 0 and 1, which no line goes out through. */
typedef struct FourPlanes {
    Lanes x, y, z, height;
} FourPlanes;

/* It may touch so many planes. */
enum { CONTACTS = 4 };

struct RtcConvex {
    FourPlanes *fours;
    Plane *planes;
    Vec3 *corners;                /* of all triangles, from the centre */
    uint32_t *primitives, *first; /* of plane i those from first[i] to first[i + 1] */
    uint32_t n_planes, n_fours, n_triangles;
    Vec3 centre;
    double radius, tolerance;
    Plane contacts[CONTACTS]; /* higher by the margin; it is above them */
    uint32_t n_contacts;
};

void rtc_convex_free(RtcConvex *convex)
{
    if (!convex) return;
    free(convex->fours);
    free(convex->planes);
    free(convex->corners);
    free(convex->primitives);
    free(convex->first);
    free(convex);
}

void rtc_convex_trim(RtcConvex *convex)
{
    free(convex->planes);
    free(convex->corners);
    convex->planes = NULL;
    convex->corners = NULL;
}

static double height_over(const Plane *plane, Vec3 p)
{
    return vec3_dot(plane->normal, p) - plane->height;
}

static Vec3 area_of(const Vec3 corner[3])
{
    return vec3_cross(vec3_sub(corner[1], corner[0]), vec3_sub(corner[2], corner[0]));
}

typedef struct Sized {
    double area;
    uint32_t primitive;
} Sized;

static int compare_sized(const void *left, const void *right)
{
    const Sized *a = left, *b = right;
    if (a->area != b->area) return a->area > b->area ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

/* The triangles that have an area, the largest first, so that those make the planes. */
static void list_triangles(RtcConvex *convex, const RtcScene *scene, uint32_t object)
{
    const RtcMesh *mesh = scene->objects[object].mesh;
    Sized sized[RTC_CONVEX_MOST];
    uint32_t n = 0;
    for (uint32_t i = 0; i < 2 * mesh->n_quads; i++) {
        Vec3 corner[3];
        if (i % 2 && mesh_quad_is_single(mesh->quads[i / 2].vertex)) continue;
        rtc_triangle(scene, object, i, 0, corner);
        double area = vec3_length(area_of(corner));
        if (area > 0) sized[n++] = (Sized){area, i};
    }
    qsort(sized, n, sizeof *sized, compare_sized);
    for (uint32_t i = 0; i < n; i++) {
        convex->primitives[i] = sized[i].primitive;
        rtc_triangle(scene, object, sized[i].primitive, 0, &convex->corners[3 * i]);
    }
    convex->n_triangles = n;
}

static void centre_it(RtcConvex *convex)
{
    Box3 box = box3_empty();
    uint32_t n = 3 * convex->n_triangles;
    for (uint32_t i = 0; i < n; i++) box = box3_add_point(box, convex->corners[i]);
    convex->centre = box3_centre(box);
    convex->tolerance = TRUSTED_ULPS * UNIT_ROUNDING * double_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
    for (uint32_t i = 0; i < n; i++) {
        convex->corners[i] = vec3_sub(convex->corners[i], convex->centre);
        convex->radius = double_max(convex->radius, vec3_length(convex->corners[i]));
    }
}

/* Whether a triangle lies in a plane. */
static bool lies_in(const RtcConvex *convex, const Plane *plane, const Vec3 corner[3])
{
    for (int k = 0; k < 3; k++)
        if (fabs(height_over(plane, corner[k])) > convex->tolerance) return false;
    return vec3_dot(area_of(corner), plane->normal) > 0;
}

static bool is_above_all(const RtcConvex *convex, const Plane *plane)
{
    for (uint32_t i = 0; i < 3 * convex->n_triangles; i++)
        if (height_over(plane, convex->corners[i]) > convex->tolerance) return false;
    return true;
}

/* Of which plane each triangle is; the planes are made. False where the mesh is not convex, which mostly shows at the first. */
static bool find_planes(RtcConvex *convex, uint32_t plane_of[RTC_CONVEX_MOST])
{
    for (uint32_t i = 0; i < convex->n_triangles; i++) {
        const Vec3 *corner = &convex->corners[3 * i];
        uint32_t k = 0;
        while (k < convex->n_planes && !lies_in(convex, &convex->planes[k], corner)) k++;
        plane_of[i] = k;
        if (k < convex->n_planes) continue;
        Vec3 normal = vec3_normalize(area_of(corner));
        Plane plane = {normal, vec3_dot(normal, corner[0])};
        if (!is_above_all(convex, &plane)) return false;
        convex->planes[convex->n_planes++] = plane;
    }
    return convex->n_planes >= 4;
}

/* The primitives by planes. */
static void sort_primitives(RtcConvex *convex, const uint32_t plane_of[RTC_CONVEX_MOST])
{
    uint32_t sorted[RTC_CONVEX_MOST], n = 0;
    for (uint32_t k = 0; k < convex->n_planes; k++) {
        convex->first[k] = n;
        for (uint32_t i = 0; i < convex->n_triangles; i++)
            if (plane_of[i] == k) sorted[n++] = convex->primitives[i];
    }
    convex->first[convex->n_planes] = n;
    memcpy(convex->primitives, sorted, n * sizeof *sorted);
}

static void fill_fours(RtcConvex *convex)
{
    convex->n_fours = (convex->n_planes + LANES - 1) / LANES;
    for (uint32_t i = 0; i < convex->n_fours * LANES; i++) {
        Plane plane = i < convex->n_planes ? convex->planes[i] : (Plane){{0, 0, 0}, 1};
        FourPlanes *four = &convex->fours[i / LANES];
        int lane = (int)(i % LANES);
        lanes_set(&four->x, lane, (float)plane.normal.x);
        lanes_set(&four->y, lane, (float)plane.normal.y);
        lanes_set(&four->z, lane, (float)plane.normal.z);
        lanes_set(&four->height, lane, (float)plane.height);
    }
}

RtcConvex *rtc_convex_make(const RtcScene *scene, uint32_t object)
{
    const RtcMesh *mesh = scene->objects[object].mesh;
    uint32_t n = 2 * mesh->n_quads, plane_of[RTC_CONVEX_MOST];
    if (n > RTC_CONVEX_MOST) return NULL;
    RtcConvex *convex = calloc(1, sizeof *convex);
    if (!convex) return NULL;
    convex->fours = aligned_alloc(64, (n / LANES + 1) * sizeof *convex->fours);
    convex->planes = malloc(n * sizeof *convex->planes);
    convex->corners = malloc(3 * n * sizeof *convex->corners);
    convex->primitives = malloc(n * sizeof *convex->primitives);
    convex->first = malloc((n + 1) * sizeof *convex->first);
    if (convex->fours && convex->planes && convex->corners && convex->primitives && convex->first) {
        list_triangles(convex, scene, object);
        centre_it(convex);
        if (find_planes(convex, plane_of)) {
            sort_primitives(convex, plane_of);
            fill_fours(convex);
            return convex;
        }
    }
    rtc_convex_free(convex);
    return NULL;
}

Ball rtc_convex_ball(const RtcConvex *convex)
{
    return (Ball){convex->centre, convex->radius};
}

bool rtc_convex_is_apart(const RtcConvex *convex, const Vec3 *points, uint32_t n, double margin)
{
    for (uint32_t k = 0; k < convex->n_planes; k++) {
        uint32_t i = 0;
        while (i < n && height_over(&convex->planes[k], vec3_sub(points[i], convex->centre)) > margin) i++;
        if (i == n) return true;
    }
    return false;
}

static bool add_contact(RtcConvex *convex, Plane plane)
{
    for (uint32_t i = 0; i < convex->n_contacts; i++) {
        const Plane *known = &convex->contacts[i];
        Vec3 apart = vec3_sub(known->normal, plane.normal);
        if (vec3_length(apart) * convex->radius + fabs(known->height - plane.height) <= convex->tolerance) return true;
    }
    if (convex->n_contacts == CONTACTS) return false;
    convex->contacts[convex->n_contacts++] = plane;
    return true;
}

bool rtc_convex_note_plane(RtcConvex *convex, Vec3 normal, Vec3 place, double margin)
{
    double low = HUGE_VAL, high = -HUGE_VAL, height = vec3_dot(normal, vec3_sub(place, convex->centre));
    for (uint32_t i = 0; i < 3 * convex->n_triangles; i++) {
        double at = vec3_dot(normal, convex->corners[i]) - height;
        low = double_min(low, at);
        high = double_max(high, at);
    }
    if (low > margin || high < -margin) return true;
    if (low >= -margin) return add_contact(convex, (Plane){normal, height + margin});
    return high <= margin && add_contact(convex, (Plane){vec3_scale(normal, -1), margin - height});
}

bool rtc_convex_is_off(const RtcConvex *convex, Vec3 point)
{
    for (uint32_t i = 0; i < convex->n_contacts; i++)
        if (!(height_over(&convex->contacts[i], vec3_sub(point, convex->centre)) > 0)) return false;
    return true;
}

bool rtc_convex_is_within(const RtcConvex *convex, const Ball *ball, double margin)
{
    Vec3 centre = vec3_sub(ball->centre, convex->centre);
    for (uint32_t i = 0; i < 3 * convex->n_triangles; i++)
        if (!(vec3_length(vec3_sub(convex->corners[i], centre)) + margin < ball->radius)) return false;
    return true;
}

bool rtc_convex_exit(const RtcConvex *convex, Vec3 from, Vec3f direction, RtcFace *face)
{
    const Lanes none = lanes_all(INFINITY), zero = lanes_all(0);
    Vec3f origin = vec3f_from(vec3_sub(from, convex->centre));
    Lanes nearest = none, which = zero;
    for (uint32_t i = 0; i < convex->n_fours; i++) {
        const FourPlanes *four = &convex->fours[i];
        Lanes slope = lanes_add(lanes_add(lanes_scale(four->x, direction.x), lanes_scale(four->y, direction.y)),
                                lanes_scale(four->z, direction.z));
        Lanes above = lanes_add(lanes_add(lanes_scale(four->x, origin.x), lanes_scale(four->y, origin.y)),
                                lanes_scale(four->z, origin.z));
        Lanes t = lanes_select_less(zero, slope, lanes_div(lanes_sub(four->height, above), slope), none);
        which = lanes_select_less(t, nearest, lanes_all((float)i), which);
        nearest = lanes_lesser(t, nearest);
    }
    int lane = 0;
    for (int k = 1; k < LANES; k++)
        if (lanes_get(nearest, k) < lanes_get(nearest, lane)) lane = k;
    if (!(lanes_get(nearest, lane) < INFINITY)) return false;
    uint32_t plane = LANES * (uint32_t)lanes_get(which, lane) + (uint32_t)lane;
    *face = (RtcFace){convex->first[plane + 1] - convex->first[plane], convex->primitives + convex->first[plane]};
    return true;
}
