/* half_spaces.c - what half spaces have in common, as a closed mesh.
 *
 * Each plane's face is a large square that all other planes cut. That is done several times, each time about the body that
 * came of it before and hardly larger than it, so that the last cuts are as good as double allows. Corners that several faces
 * share come out of different cuts in each of them: those that are next to each other become one, and what a face is left with
 * less than three of is none. Whether the faces fit together is looked at in the end.
 * SPDX-License-Identifier: Apache-2.0 */
#include "mesh/half_spaces.h"

#include <stdlib.h>
#include <string.h>

#include "base/array.h"

/* Of the body's radius: corners nearer to each other than this are one, or than some times that where so the faces do not fit
 * together, as planes do that were written with few digits; what is thinner is flat. */
static const double corners_apart[] = {1e-6, 4e-6, 1.6e-5};
#define FLAT 1e-4
/* Of the square's size: what is no farther from a plane than this is on it. */
#define ON_PLANE 1e-12
/* The first squares are so many times as large as planes are from the middle. What reaches half as far has no end. */
#define AFAR 1e4
enum { PASSES = 3 };

typedef struct Face {
    uint32_t first, n; /* of its corners */
} Face;

typedef struct Clip {
    HalfSpace *spaces; /* about the centre, those that count */
    uint32_t n;
    Vec3 *ring, *other; /* a face that is being cut, and what is left of it */
    uint32_t n_ring, most_ring;
    Vec3 centre;
    double size;   /* of the squares */
    double within; /* corners so near to each other are one */
    Box3 box;      /* around all corners */
    Vec3 *corners;
    size_t n_corners, corners_capacity;
    uint32_t *of_faces; /* corners, face by face, counter-clockwise seen from outside */
    size_t n_of_faces, of_faces_capacity;
    Face *faces;
    uint32_t n_faces;
} Clip;

HalfSpace half_space_moved(const Affine *map, HalfSpace space)
{
    Affine inverse;
    if (!affine_invert(map, &inverse)) return space;
    Vec3 normal = affine_normal(&inverse, space.normal);
    double length = vec3_length(normal);
    return (HalfSpace){vec3_scale(normal, 1 / length), (space.distance - vec3_dot(space.normal, inverse.t)) / length};
}

/* ---- cutting ---- */

/* Takes over those planes that come near the body and are not one of those before, with their distance from the centre. */
static void list_spaces(Clip *clip, const HalfSpace *spaces, uint32_t n, double alike)
{
    clip->n = 0;
    for (uint32_t i = 0; i < n; i++) {
        HalfSpace space = {spaces[i].normal, spaces[i].distance - vec3_dot(spaces[i].normal, clip->centre)};
        if (space.distance > clip->size) continue;
        uint32_t k = 0;
        for (; k < clip->n; k++) {
            HalfSpace *known = &clip->spaces[k];
            if (vec3_length(vec3_sub(known->normal, space.normal)) * clip->size > alike) continue;
            if (fabs(known->distance - space.distance) <= alike) break;
        }
        if (k == clip->n) clip->spaces[clip->n++] = space;
    }
}

/* Cuts off what is beyond a plane. */
static void cut_ring(Clip *clip, const HalfSpace *space)
{
    const double on = ON_PLANE * clip->size;
    uint32_t n = 0;
    for (uint32_t i = 0; i < clip->n_ring && n + 2 <= clip->most_ring; i++) {
        Vec3 a = clip->ring[i], b = clip->ring[i + 1 < clip->n_ring ? i + 1 : 0];
        double at_a = vec3_dot(space->normal, a) - space->distance, at_b = vec3_dot(space->normal, b) - space->distance;
        if (at_a <= on) clip->other[n++] = a;
        if ((at_a < -on && at_b > on) || (at_a > on && at_b < -on))
            clip->other[n++] = vec3_along(a, at_a / (at_a - at_b), vec3_sub(b, a));
    }
    Vec3 *swapped = clip->ring;
    clip->ring = clip->other;
    clip->other = swapped;
    clip->n_ring = n;
}

/* What is left of the plane's square; counter-clockwise. */
static void cut_face(Clip *clip, uint32_t number)
{
    const HalfSpace *space = &clip->spaces[number];
    Vec3 n = space->normal, axis = fabs(n.x) < 0.6 ? vec3(1, 0, 0) : vec3(0, 1, 0);
    Vec3 u = vec3_scale(vec3_normalize(vec3_cross(axis, n)), clip->size);
    Vec3 v = vec3_cross(n, u), foot = vec3_scale(n, space->distance);
    clip->ring[0] = vec3_sub(vec3_sub(foot, u), v);
    clip->ring[1] = vec3_sub(vec3_add(foot, u), v);
    clip->ring[2] = vec3_add(vec3_add(foot, u), v);
    clip->ring[3] = vec3_add(vec3_sub(foot, u), v);
    clip->n_ring = 4;
    for (uint32_t i = 0; i < clip->n && clip->n_ring; i++)
        if (i != number) cut_ring(clip, &clip->spaces[i]);
}

/* One look at all faces; false where there is nothing, or no end. */
static bool measure(Clip *clip)
{
    clip->box = box3_empty();
    for (uint32_t i = 0; i < clip->n; i++) {
        cut_face(clip, i);
        for (uint32_t k = 0; k < clip->n_ring; k++) clip->box = box3_add_point(clip->box, clip->ring[k]);
    }
    if (box3_is_empty(clip->box)) return false;
    return fmax(vec3_max_abs(clip->box.min), vec3_max_abs(clip->box.max)) < clip->size / 2;
}

static double radius_of(const Clip *clip)
{
    return vec3_length(vec3_sub(clip->box.max, clip->box.min)) / 2;
}

static double snapped(double x, double step)
{
    return round(x / step) * step;
}

/* To the middle of the box, or so near to it that bodies with simple measures keep them. */
static void move_centre(Clip *clip)
{
    int exponent;
    double radius = radius_of(clip);
    (void)frexp(radius, &exponent);
    Vec3 middle = vec3_add(clip->centre, box3_centre(clip->box));
    double step = ldexp(1, exponent - 10);
    clip->centre = vec3(snapped(middle.x, step), snapped(middle.y, step), snapped(middle.z, step));
    clip->size = 4 * radius;
}

/* ---- faces that fit together ---- */

/* The first of the corners there are is the one that it becomes: so it is the same for each face. */
static bool find_corner(Clip *clip, Vec3 place, uint32_t *corner)
{
    for (size_t i = 0; i < clip->n_corners; i++) {
        if (vec3_length(vec3_sub(clip->corners[i], place)) > clip->within) continue;
        *corner = (uint32_t)i;
        return true;
    }
    if (!ARRAY_ROOM(clip->corners, clip->corners_capacity, clip->n_corners)) return false;
    *corner = (uint32_t)clip->n_corners;
    clip->corners[clip->n_corners++] = place;
    return true;
}

/* The corners of the face that was cut last. */
static bool add_face(Clip *clip)
{
    size_t first = clip->n_of_faces, n = 0;
    if (!array_reserve(&clip->of_faces, &clip->of_faces_capacity, first + clip->n_ring, sizeof *clip->of_faces))
        return false;
    uint32_t *ring = clip->of_faces + first;
    for (uint32_t i = 0; i < clip->n_ring; i++) {
        uint32_t corner;
        if (!find_corner(clip, clip->ring[i], &corner)) return false;
        if (!n || (ring[n - 1] != corner)) ring[n++] = corner;
    }
    while (n > 1 && ring[n - 1] == ring[0]) n--;
    if (n < 3) return true;
    clip->faces[clip->n_faces++] = (Face){(uint32_t)first, (uint32_t)n};
    clip->n_of_faces += n;
    return true;
}

/* False when memory ends. */
static bool make_faces(Clip *clip)
{
    clip->n_corners = clip->n_of_faces = 0;
    clip->n_faces = 0;
    for (uint32_t i = 0; i < clip->n; i++) {
        cut_face(clip, i);
        if (clip->n_ring && !add_face(clip)) return false;
    }
    return true;
}

static uint32_t corner_of(const Clip *clip, const Face *face, uint32_t i)
{
    return clip->of_faces[face->first + i % face->n];
}

typedef struct Edge {
    uint32_t from, to;
} Edge;

static int compare_edges(const void *left, const void *right)
{
    const Edge *a = left, *b = right;
    if (a->from != b->from) return a->from < b->from ? -1 : 1;
    return a->to < b->to ? -1 : a->to > b->to;
}

/* Numbers the corners that faces have anew, and drops the others. */
static void keep_used(Clip *clip, uint32_t *number)
{
    uint32_t n = 0;
    for (size_t i = 0; i < clip->n_corners; i++) number[i] = UINT32_MAX;
    for (size_t i = 0; i < clip->n_of_faces; i++) number[clip->of_faces[i]] = 0;
    for (size_t i = 0; i < clip->n_corners; i++) {
        if (number[i] == UINT32_MAX) continue;
        clip->corners[n] = clip->corners[i];
        number[i] = n++;
    }
    clip->n_corners = n;
    for (size_t i = 0; i < clip->n_of_faces; i++) clip->of_faces[i] = number[clip->of_faces[i]];
}

/* Whether each edge is one of just two faces, and they are those of a ball that is pulled flat. Room: for an edge of each
 * corner of each face. */
static bool fits_together(const Clip *clip, Edge *edges)
{
    size_t n = 0;
    for (uint32_t f = 0; f < clip->n_faces; f++)
        for (uint32_t i = 0; i < clip->faces[f].n; i++)
            edges[n++] = (Edge){corner_of(clip, &clip->faces[f], i), corner_of(clip, &clip->faces[f], i + 1)};
    if (n % 2 || clip->n_corners + clip->n_faces != n / 2 + 2) return false;
    qsort(edges, n, sizeof *edges, compare_edges);
    for (size_t i = 0; i < n; i++) {
        Edge back = {edges[i].to, edges[i].from};
        if (i > 0 && compare_edges(&edges[i - 1], &edges[i]) == 0) return false;
        if (!bsearch(&back, edges, n, sizeof *edges, compare_edges)) return false;
    }
    return true;
}

/* Whether all corners, rounded as they will be, are in all of the half spaces, and the body has some thickness from each
 * face. */
static bool is_convex(const Clip *clip)
{
    double radius = radius_of(clip), slack = 2 * clip->within;
    for (uint32_t i = 0; i < clip->n; i++) {
        double deepest = 0;
        for (size_t k = 0; k < clip->n_corners; k++) {
            Vec3 rounded = vec3_from_f(vec3f_from(clip->corners[k]));
            double depth = clip->spaces[i].distance - vec3_dot(clip->spaces[i].normal, rounded);
            if (depth < -slack) return false;
            deepest = fmax(deepest, depth);
        }
        if (deepest < FLAT * radius) return false;
    }
    return true;
}

/* ---- the mesh ---- */

/* The height of a triangle over its longest side. */
static double least_height(Vec3 a, Vec3 b, Vec3 c)
{
    double longest = fmax(vec3_length(vec3_sub(b, a)), fmax(vec3_length(vec3_sub(c, b)), vec3_length(vec3_sub(a, c))));
    return vec3_length(vec3_cross(vec3_sub(b, a), vec3_sub(c, a))) / longest;
}

/* Which corner of a face to cut it from, into a fan whose thinnest triangle is thickest: thin ones do not know how they lie. */
static uint32_t best_start(const Clip *clip, const Face *face)
{
    uint32_t best = 0;
    double thickest = -1;
    for (uint32_t start = 0; start < face->n; start++) {
        double thinnest = HUGE_VAL;
        Vec3 a = clip->corners[corner_of(clip, face, start)];
        for (uint32_t i = 1; i + 1 < face->n; i++)
            thinnest = fmin(thinnest, least_height(a, clip->corners[corner_of(clip, face, start + i)],
                                                   clip->corners[corner_of(clip, face, start + i + 1)]));
        if (thinnest <= thickest) continue;
        thickest = thinnest;
        best = start;
    }
    return best;
}

static Status make_mesh(const Clip *clip, Mesh **mesh, Error *error)
{
    uint32_t n = 0;
    TRY(mesh_new((uint32_t)clip->n_corners, (uint32_t)clip->n_of_faces - 2 * clip->n_faces, false, false, mesh, error));
    for (size_t i = 0; i < clip->n_corners; i++) (*mesh)->positions[i] = vec3f_from(clip->corners[i]);
    for (uint32_t f = 0; f < clip->n_faces; f++) {
        const Face *face = &clip->faces[f];
        uint32_t start = best_start(clip, face);
        for (uint32_t i = 1; i + 1 < face->n; i++, n++) {
            (*mesh)->triangles[n][0] = corner_of(clip, face, start);
            (*mesh)->triangles[n][1] = corner_of(clip, face, start + i);
            (*mesh)->triangles[n][2] = corner_of(clip, face, start + i + 1);
        }
    }
    return STATUS_OK;
}

/* Finds where the body is; false where there is none, or no end of it. */
static bool find_body(Clip *clip, const HalfSpace *spaces, uint32_t n)
{
    double farthest = 0;
    for (uint32_t i = 0; i < n; i++) farthest = fmax(farthest, fabs(spaces[i].distance));
    clip->size = AFAR * farthest;
    if (!(clip->size > 0) || !isfinite(clip->size)) return false;
    for (int pass = 0; pass < PASSES; pass++) {
        list_spaces(clip, spaces, n, ON_PLANE * clip->size);
        if (!measure(clip)) return false;
        move_centre(clip);
    }
    return clip->size > 0;
}

/* Its faces, with corners that are so far apart; *fit: they are those of a closed and convex body. False when memory ends. */
static bool fit_faces(Clip *clip, const HalfSpace *spaces, uint32_t n, double apart, bool *fit)
{
    *fit = false;
    list_spaces(clip, spaces, n, apart / 4 * clip->size);
    if (!measure(clip)) return true;
    clip->within = apart * radius_of(clip);
    if (!make_faces(clip)) return false;
    if (clip->n_faces < 4) return true;
    uint32_t *number = malloc(clip->n_corners * sizeof *number);
    Edge *edges = malloc(clip->n_of_faces * sizeof *edges);
    bool there = number && edges;
    if (there) {
        keep_used(clip, number);
        *fit = fits_together(clip, edges) && is_convex(clip);
    }
    free(number);
    free(edges);
    return there;
}

/* False when memory ends. */
static bool make_room(Clip *clip, uint32_t n)
{
    size_t room = 2 * (size_t)n + 8; /* each cut adds one corner at most, were there no rounding */
    clip->most_ring = (uint32_t)room;
    clip->spaces = malloc(n * sizeof *clip->spaces);
    clip->ring = malloc(room * sizeof *clip->ring);
    clip->other = malloc(room * sizeof *clip->other);
    clip->faces = malloc(n * sizeof *clip->faces);
    return clip->spaces && clip->ring && clip->other && clip->faces;
}

static void clip_clear(Clip *clip)
{
    free(clip->spaces);
    free(clip->ring);
    free(clip->other);
    free(clip->faces);
    free(clip->corners);
    free(clip->of_faces);
}

static Status body_mesh(Clip *clip, const HalfSpace *spaces, uint32_t n, Mesh **mesh, Error *error)
{
    static const char what[] = "a body between planes";
    if (!make_room(clip, n)) return fail_memory(error, clip->most_ring * sizeof *clip->ring, what);
    if (!find_body(clip, spaces, n)) return STATUS_OK;
    for (size_t i = 0; i < COUNT_OF(corners_apart); i++) {
        bool fit;
        if (!fit_faces(clip, spaces, n, corners_apart[i], &fit)) return fail_memory(error, 0, what);
        if (fit) return make_mesh(clip, mesh, error);
    }
    return STATUS_OK;
}

Status half_spaces_mesh(const HalfSpace *spaces, uint32_t n, Mesh **mesh, Vec3 *centre, Error *error)
{
    Clip clip = {0};
    *mesh = NULL;
    if (n < 4 || n > HALF_SPACES_MOST) return STATUS_OK;
    Status status = body_mesh(&clip, spaces, n, mesh, error);
    *centre = clip.centre;
    clip_clear(&clip);
    return status;
}

bool half_spaces_box(const HalfSpace *spaces, uint32_t n, Box3 *box)
{
    Clip clip = {0};
    if (n < 2 || n > HALF_SPACES_MOST) return false;
    clip.box = (Box3){vec3(0, 0, 0), vec3(0, 0, 0)}; /* not empty before a look at it */
    bool found = make_room(&clip, n) && find_body(&clip, spaces, n);
    if (found) {
        list_spaces(&clip, spaces, n, ON_PLANE * clip.size);
        found = measure(&clip);
    }
    *box = (Box3){vec3_add(clip.centre, clip.box.min), vec3_add(clip.centre, clip.box.max)};
    found = found || box3_is_empty(clip.box);
    clip_clear(&clip);
    return found;
}
