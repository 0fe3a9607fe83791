/* prism.c - solids over an outline: walls, ends, and bevels between them.
 * The walls are bands between copies of the outline: a bevel is a row of copies that are moved inward. All ends and
 * walls use the same points, so that the solid is closed whatever its numbers are rounded to.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/angle.h"
#include "base/num.h"
#include "shape/meshed.h"

/* A copy of the outline: its height, how far it is moved inward, its scale, and how its normals lean: sine is their
 * part along z. */
typedef struct Ring {
    double height, inset, scale, cosine, sine;
} Ring;

typedef struct PrismMaker {
    Grower *grower;
    const Outline2 *outline;
    const PrismShape *shape;
    Point2 *inward;     /* per point: where it goes for an inset of 1 */
    double scale_slope; /* change of scale per height */
} PrismMaker;

static double dot(Point2 a, Point2 b)
{
    return a.x * b.x + a.y * b.y;
}

static Point2 left_of(Point2 d)
{
    return (Point2){-d.y, d.x};
}

static Point2 edge_direction(const OutlinePoint2 *a, const OutlinePoint2 *b)
{
    double length = hypot(b->at.x - a->at.x, b->at.y - a->at.y);
    return (Point2){(b->at.x - a->at.x) / length, (b->at.y - a->at.y) / length};
}

/* The first and the last of the points of a loop, for walking over it. */
typedef struct Loop {
    size_t begin, end;
} Loop;

static Loop loop_at(const Outline2 *outline, size_t i)
{
    return (Loop){i ? outline->loop_ends[i - 1] : 0, outline->loop_ends[i]};
}

/* Both edges at a point move inward by 1, and the point stays where they meet. */
static void find_inward(PrismMaker *maker)
{
    const OutlinePoint2 *points = maker->outline->points;
    for (size_t k = 0; k < maker->outline->n_loops; k++) {
        Loop loop = loop_at(maker->outline, k);
        for (size_t i = loop.begin; i < loop.end; i++) {
            size_t before = i > loop.begin ? i - 1 : loop.end - 1, after = i + 1 < loop.end ? i + 1 : loop.begin;
            Point2 a = left_of(edge_direction(&points[before], &points[i]));
            Point2 b = left_of(edge_direction(&points[i], &points[after]));
            double scale = 1 / fmax(1 + dot(a, b), 1e-9);
            maker->inward[i] = (Point2){scale * (a.x + b.x), scale * (a.y + b.y)};
        }
    }
}

static Point2 moved(const PrismMaker *maker, size_t i, double inset)
{
    Point2 at = maker->outline->points[i].at;
    return (Point2){at.x + inset * maker->inward[i].x, at.y + inset * maker->inward[i].y};
}

/* Does the outline keep its form when it is moved inward so far? else *near says where it does not. */
static Status inset_fits(const PrismMaker *maker, double inset, bool *fits, Point2 *near, Error *error)
{
    Outline2 copy = {0};
    bool fine = true;
    *fits = true;
    for (size_t k = 0; k < maker->outline->n_loops && fine; k++) {
        Loop loop = loop_at(maker->outline, k);
        for (size_t i = loop.begin; i < loop.end && fine; i++) {
            size_t after = i + 1 < loop.end ? i + 1 : loop.begin;
            Point2 a = moved(maker, i, inset), b = moved(maker, after, inset);
            Point2 was = edge_direction(&maker->outline->points[i], &maker->outline->points[after]);
            if (dot(was, (Point2){b.x - a.x, b.y - a.y}) <= 0 && *fits) {
                *fits = false;
                *near = maker->outline->points[i].at;
            }
            fine = outline2_add_point(&copy, &(OutlinePoint2){.at = a});
        }
        fine = fine && outline2_end_loop(&copy);
    }
    Status status = fine ? STATUS_OK : fail_memory(error, copy.n_points * sizeof *copy.points, "a bevel");
    if (status == STATUS_OK && *fits) {
        Crossing2 crossing;
        status = polygon_find_crossing(&copy, &crossing, error);
        if (crossing.found) {
            *fits = false;
            *near = crossing.at;
        }
    }
    outline2_clear(&copy);
    return status;
}

static Status check_bevel(const PrismMaker *maker, Error *error)
{
    double bevel = maker->shape->bevel, height = fabs(maker->shape->to - maker->shape->from);
    if (2 * bevel > height * (1 + 1e-12))
        return fail(error, STATUS_SCENE, "a bevel of %g does not fit twice into a height of %g", bevel, height);
    bool fits;
    Point2 near, ignored;
    TRY(inset_fits(maker, bevel, &fits, &near, error));
    if (fits) return STATUS_OK;
    double low = 0, high = bevel;
    for (int i = 0; i < 12; i++) {
        double middle = 0.5 * (low + high);
        TRY(inset_fits(maker, middle, &fits, &ignored, error));
        if (fits)
            low = middle;
        else
            high = middle;
    }
    char fitting[48] = "";
    if (low > 0) snprintf(fitting, sizeof fitting, "; one of %.2g fits", num_round_down(low, 2));
    return fail(error, STATUS_SCENE,
                "a bevel of %g is too large: the outline is too narrow or bends too much near <%.6g, %.6g>%s", bevel,
                near.x, near.y, fitting);
}

static uint32_t add_wall_vertex(const PrismMaker *maker, const Ring *ring, size_t i, Point2 along)
{
    Point2 at = moved(maker, i, ring->inset), out = {along.y, -along.x};
    Vec3 normal = vec3(ring->cosine * out.x, ring->cosine * out.y, ring->sine - maker->scale_slope * dot(at, out));
    return grower_vertex(maker->grower, vec3(ring->scale * at.x, ring->scale * at.y, ring->height), normal);
}

static void add_band(const PrismMaker *maker, const Ring *low, const Ring *high)
{
    const OutlinePoint2 *points = maker->outline->points;
    for (size_t k = 0; k < maker->outline->n_loops; k++) {
        Loop loop = loop_at(maker->outline, k);
        for (size_t i = loop.begin; i < loop.end; i++) {
            size_t after = i + 1 < loop.end ? i + 1 : loop.begin;
            Point2 leave = points[i].leave, arrive = points[after].arrive;
            /* one after the other: in which order arguments are evaluated is the compiler's choice */
            uint32_t a = add_wall_vertex(maker, low, i, leave), b = add_wall_vertex(maker, low, after, arrive);
            uint32_t c = add_wall_vertex(maker, high, after, arrive), d = add_wall_vertex(maker, high, i, leave);
            grower_quad(maker->grower, a, b, c, d);
        }
    }
}

static Status add_end(const PrismMaker *maker, double height, double scale, bool top, Error *error)
{
    if (scale == 0) return STATUS_OK;
    Outline2 end = {0};
    bool fine = true;
    size_t loop = 0;
    for (size_t i = 0; i < maker->outline->n_points && fine; i++) {
        fine = outline2_add_point(&end, &(OutlinePoint2){.at = moved(maker, i, maker->shape->bevel)});
        if (i + 1 == maker->outline->loop_ends[loop]) {
            fine = fine && outline2_end_loop(&end);
            loop++;
        }
    }
    uint32_t(*triangles)[3] = NULL;
    size_t n_triangles = 0;
    Status status = fine ? polygon_triangulate(&end, &triangles, &n_triangles, error)
                         : fail_memory(error, end.n_points * sizeof *end.points, "a prism");
    if (status == STATUS_OK) {
        uint32_t first = (uint32_t)maker->grower->n_vertices;
        for (size_t i = 0; i < end.n_points; i++)
            grower_vertex(maker->grower, vec3(scale * end.points[i].at.x, scale * end.points[i].at.y, height),
                          vec3(0, 0, top ? 1 : -1));
        for (size_t i = 0; i < n_triangles; i++) {
            const uint32_t *t = triangles[i];
            grower_triangle(maker->grower, first + t[0], first + t[top ? 1 : 2], first + t[top ? 2 : 1]);
        }
    }
    free(triangles);
    outline2_clear(&end);
    return status;
}

/* Between the wall, which ends at the height `wall`, and an end: `up` is 1 at the top, -1 at the bottom. */
static void add_bevel(const PrismMaker *maker, double wall, double height, double up)
{
    const PrismShape *shape = maker->shape;
    unsigned n = shape->bevel_segments;
    Ring before = {0};
    for (unsigned k = 0; k <= n; k++) {
        double angle = 0.5 * MEN_PI * k / n;
        double c = k == n ? 0 : cos(angle), s = k == n ? 1 : sin(angle);
        Ring ring = {height - up * shape->bevel * (1 - s), k == n ? shape->bevel : shape->bevel * (1 - c), 1, c,
                     up * s};
        if (k == 0 || k == n) ring.height = k ? height : wall;
        if (n == 1) { /* flat */
            ring.cosine = 1;
            ring.sine = up;
        }
        if (k > 0) add_band(maker, up > 0 ? &before : &ring, up > 0 ? &ring : &before);
        before = ring;
    }
}

Status prism_add(Grower *grower, const Outline2 *outline, const PrismShape *shape, Error *error)
{
    PrismShape upright = *shape;
    if (shape->from > shape->to) {
        upright.from = shape->to;
        upright.to = shape->from;
        upright.scale_from = shape->scale_to;
        upright.scale_to = shape->scale_from;
    }
    PrismMaker maker = {.grower = grower, .outline = outline, .shape = &upright};
    double height = upright.to - upright.from;
    if (!(height > 0))
        return fail(error, STATUS_SCENE, "a prism from height %g to %g has no volume", shape->from, shape->to);
    if (outline->n_points == 0) return fail(error, STATUS_SCENE, "the outline encloses nothing");
    maker.scale_slope = (upright.scale_to - upright.scale_from) / height;
    maker.inward = malloc(outline->n_points * sizeof *maker.inward);
    if (!maker.inward) return fail_memory(error, outline->n_points * sizeof *maker.inward, "a prism");
    find_inward(&maker);
    double bevel = upright.bevel;
    Status status = bevel > 0 ? check_bevel(&maker, error) : STATUS_OK;
    if (status == STATUS_OK) {
        Ring low = {upright.from + bevel, 0, upright.scale_from, 1, 0},
             high = {upright.to - bevel, 0, upright.scale_to, 1, 0};
        if (low.height < high.height)
            add_band(&maker, &low, &high);
        else
            low.height = high.height = upright.from + 0.5 * height; /* the bevels meet */
        if (bevel > 0) {
            add_bevel(&maker, low.height, upright.from, -1);
            add_bevel(&maker, high.height, upright.to, 1);
        }
        status = add_end(&maker, upright.from, upright.scale_from, false, error);
    }
    if (status == STATUS_OK) status = add_end(&maker, upright.to, upright.scale_to, true, error);
    free(maker.inward);
    return status;
}
