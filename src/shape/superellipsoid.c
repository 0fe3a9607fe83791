/* superellipsoid.c - boxes with rounded edges, pillows, spindles, stars: superquadric ellipsoids (A. H. Barr,
 * "Superquadrics and Angle-Preserving Transformations", IEEE CG&A 1(1), 1981).
 * The solid is the product of two superellipses: a section across z, and a meridian. Each of them is cut into chords
 * where it bends, so that the grid of both follows flat faces with few points and sharp edges with many.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "base/angle.h"
#include "base/array.h"
#include "shape/meshed.h"

enum { MAX_DEPTH = 24, MAX_POINTS = 4096, MILLIONS_OF_FACES = 10 /* about 3 GB */ };
static const double right_angle = 0.5 * MEN_PI;
static const double largest_turn = 0.07; /* radians from chord to chord: 4 degrees */
static const double shortest_chord = 1e-4;

/* A point on |x|^p + |y|^p = 1 in the first quarter; gx, gy: the gradient of the gauge, for which gx x + gy y = 1. */
typedef struct CurvePoint {
    double x, y, gx, gy;
} CurvePoint;

typedef struct Curve {
    double power, tolerance;
    CurvePoint *points;
    size_t n, capacity;
    bool out_of_memory;
} Curve;

static CurvePoint curve_point(double power, double angle)
{
    bool steep = angle > 0.5 * right_angle;
    /* towards the nearer axis: the other coordinate is small, and its power does no harm */
    double ratio = angle == 0 || angle == right_angle ? 0 : tan(steep ? right_angle - angle : angle);
    double small = pow(ratio, power), radius = pow(1 + small, -1 / power);
    double slope = ratio > 0 ? pow(ratio, power - 1) : power > 1 ? 0 : power < 1 ? HUGE_VAL : 1;
    CurvePoint p = {radius, radius * ratio, 0, 0};
    /* the gradient goes as (1, ratio^(p-1)); at a cusp only its direction along the other axis is left */
    double scale = 1 / (p.x + (isfinite(slope) ? p.y * slope : 0));
    p.gx = scale;
    p.gy = isfinite(slope) ? scale * slope : 0;
    return steep ? (CurvePoint){p.y, p.x, p.gy, p.gx} : p;
}

static void add_curve_point(Curve *curve, CurvePoint p)
{
    if (curve->n >= MAX_POINTS) return;
    if (!ARRAY_ROOM(curve->points, curve->capacity, curve->n)) {
        curve->out_of_memory = true;
        return;
    }
    curve->points[curve->n++] = p;
}

static double turn_between(CurvePoint a, CurvePoint b)
{
    return fabs(atan2(a.gx * b.gy - a.gy * b.gx, a.gx * b.gx + a.gy * b.gy));
}

/* Adds the points behind a up to b. */
static void refine(Curve *curve, double angle_a, CurvePoint a, double angle_b, CurvePoint b, int depth)
{
    double middle = 0.5 * (angle_a + angle_b);
    CurvePoint m = curve_point(curve->power, middle);
    double dx = b.x - a.x, dy = b.y - a.y, chord = hypot(dx, dy);
    double off = chord > 0 ? fabs(dx * (m.y - a.y) - dy * (m.x - a.x)) / chord : 0;
    bool bends = turn_between(a, b) > largest_turn && chord > shortest_chord;
    if (depth < MAX_DEPTH && (off > curve->tolerance || bends || depth < 2)) {
        refine(curve, angle_a, a, middle, m, depth + 1);
        refine(curve, middle, m, angle_b, b, depth + 1);
        return;
    }
    add_curve_point(curve, b);
}

/* From the x axis to the y axis; symmetric, with a point in the middle. */
static Status make_curve(Curve *curve, Error *error)
{
    CurvePoint a = curve_point(curve->power, 0), m = curve_point(curve->power, 0.5 * right_angle);
    add_curve_point(curve, a);
    refine(curve, 0, a, 0.5 * right_angle, m, 0);
    if (curve->n >= MAX_POINTS / 2)
        return fail(error, STATUS_SCENE,
                    "the superellipsoid needs more than %d points around; make the tolerance larger", 4 * MAX_POINTS);
    for (size_t i = curve->n - 1; i > 0 && !curve->out_of_memory; i--) {
        CurvePoint p = curve->points[i - 1];
        add_curve_point(curve, (CurvePoint){p.y, p.x, p.gy, p.gx});
    }
    return curve->out_of_memory ? fail_memory(error, curve->n * sizeof *curve->points, "a superellipsoid") : STATUS_OK;
}

/* The point of the quarter `quarter` (0..3, counter-clockwise), number i of its n. */
static CurvePoint around(const Curve *curve, unsigned quarter, size_t i)
{
    CurvePoint p = curve->points[i];
    for (; quarter > 0; quarter--) p = (CurvePoint){-p.y, p.x, -p.gy, p.gx};
    return p;
}

/* side: 1 above, -1 below the equator. */
static uint32_t add_vertex(Grower *grower, CurvePoint section, CurvePoint meridian, double side, Vec3 radii)
{
    Vec3 at = vec3(meridian.x * section.x * radii.x, meridian.x * section.y * radii.y, side * meridian.y * radii.z);
    Vec3 normal =
        vec3(meridian.gx * section.gx / radii.x, meridian.gx * section.gy / radii.y, side * meridian.gy / radii.z);
    return grower_vertex(grower, at, normal);
}

static void add_patch(Grower *grower, const CurvePoint section[2], const CurvePoint meridian[2], double side,
                      Vec3 radii)
{
    uint32_t a = add_vertex(grower, section[0], meridian[0], side, radii);
    uint32_t b = add_vertex(grower, section[1], meridian[0], side, radii);
    uint32_t c = add_vertex(grower, section[1], meridian[1], side, radii);
    uint32_t d = add_vertex(grower, section[0], meridian[1], side, radii);
    if (side > 0)
        grower_quad(grower, a, b, c, d);
    else
        grower_quad(grower, d, c, b, a);
}

Status mesh_make_superellipsoid(double e, double n, Vec3 radii, double tolerance, Mesh **mesh, Error *error)
{
    double largest = vec3_max_abs(radii);
    Curve section = {.power = 2 / e, .tolerance = tolerance / largest};
    Curve meridian = {.power = 2 / n, .tolerance = tolerance / largest};
    Grower grower = {0};
    Status status = make_curve(&section, error);
    if (status == STATUS_OK) status = make_curve(&meridian, error);
    double millions = 8e-6 * (double)section.n * (double)meridian.n;
    if (status == STATUS_OK && millions > MILLIONS_OF_FACES)
        status = fail(error, STATUS_SCENE,
                      "the superellipsoid needs some %.0f million faces, and may have %d; make the tolerance larger",
                      millions, MILLIONS_OF_FACES);
    for (unsigned quarter = 0; quarter < 4 && status == STATUS_OK; quarter++)
        for (size_t i = 0; i + 1 < section.n; i++) {
            const CurvePoint s[2] = {around(&section, quarter, i), around(&section, quarter, i + 1)};
            for (size_t k = 0; k + 1 < meridian.n; k++) {
                add_patch(&grower, s, &meridian.points[k], 1, radii);
                add_patch(&grower, s, &meridian.points[k], -1, radii);
            }
        }
    if (status == STATUS_OK) status = grower_finish(&grower, "the superellipsoid", mesh, error);
    grower_clear(&grower);
    free(section.points);
    free(meridian.points);
    return status;
}
