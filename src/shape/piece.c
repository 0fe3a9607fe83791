/* piece.c - where a line meets a sphere, a band or an arc of revolution, a torus, a rectangle or a plane.
 *
 * Bands are the difficult ones, because neighbours must agree about their shared circle. So nothing is
 * decided from the place of a rounded root. In the half plane (r, y) a line is the graph of a convex
 * function r = h(y) (a branch of a hyperbola: its distance from the axis at height y). For each end
 * (R, Y) of a band we ask whether the end lies above that graph, R > h(Y). The answer depends on the
 * circle and the line alone and is computed in one place, so both neighbours get the same one. Then:
 *   - ends on different sides: exactly one crossing, and its direction is known from the signs;
 *   - both ends above: none, because what is above a convex graph is convex;
 *   - both ends below: none or two, which is the band's own affair.
 * Along a closed profile the number of crossings is therefore even, with as many entries as exits,
 * whatever rounding does to the signs. Discs and rings follow the same rule with both ends at one height.
 * Arcs follow it, too (tube.c): of an outer one the part of the line above its end is inside of the circle, of an inner
 * one it is outside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/piece.h"

#include <math.h>
#include <stdbool.h>

#include "base/angle.h"
#include "shape/tube.h"

/* The least cosine between a direction and the normal that piece_normal returns (tubes apart): far below what float can
 * tell, far above the rounding of a change of frame in double. */
static const double least_cosine = 1e-9;

/* One end of a band or an arc against the line: where the line passes the end's height, and whether the end is
 * farther from the axis than the line is there. A line at constant height passes other heights at
 * infinity; its own height counts as below it, so that of two neighbours exactly one holds the line. */
typedef struct BandEnd {
    double t, x, z;
    double excess; /* the line's squared distance from the axis there, less the end's */
    bool above;
} BandEnd;

static inline BandEnd band_end(double radius, double height, const PieceLine *line)
{
    if (UNLIKELY(line->inverse_y == 0))
        return (BandEnd){height > line->org.y ? HUGE_VAL : -HUGE_VAL, 0, 0, HUGE_VAL, false};
    double t = (height - line->org.y) * line->inverse_y;
    double x = line->org.x + t * line->dir.x;
    double z = line->org.z + t * line->dir.z;
    double excess = (x * x + z * z) - radius * radius;
    return (BandEnd){t, x, z, excess, excess < 0};
}

/* F(t) = (ey r(t))^2 - (g + k t)^2 = A t^2 + 2 B t + C, negative where the line is nearer to the axis than
 * the cone. With r(t) the distance from the axis, o and d the horizontal parts, B^2 - A C is
 * ey^2 (|g d - k o|^2 - ey^2 (o x d)^2), which has no cancellation but the unavoidable one. */
typedef struct BandQuadratic {
    double A, B, C, root; /* root: of the discriminant, 0 when that is negative */
    bool grazing;         /* so little is left of the discriminant that rounding shows in the roots */
} BandQuadratic;

static inline BandQuadratic band_quadratic(const Piece *piece, Vec3 org, Vec3 dir)
{
    double er = piece->r1 - piece->r0;
    double ey = piece->y1 - piece->y0;
    /* All cylinders of one radius get the same arithmetic, whatever their height: surfaces of two solids
     * that coincide must be met at the same t. */
    if (er == 0) ey = copysign(1, ey);
    double g = ey * piece->r0 + er * (org.y - piece->y0);
    double k = er * dir.y;
    double ey2 = ey * ey;
    double ex = g * dir.x - k * org.x;
    double ez = g * dir.z - k * org.z;
    double moment = ey * (org.x * dir.z - org.z * dir.x);
    double squares = ex * ex + ez * ez;
    double discriminant = squares - moment * moment;
    BandQuadratic f;
    f.grazing = discriminant < 1e-10 * squares;
    f.A = ey2 * (dir.x * dir.x + dir.z * dir.z) - k * k;
    f.B = ey2 * (org.x * dir.x + org.z * dir.z) - g * k;
    f.C = ey2 * (org.x * org.x + org.z * org.z) - g * g;
    f.root = discriminant > 0 ? fabs(ey) * sqrt(discriminant) : 0;
    return f;
}

/* The root at which F rises or falls. */
static inline double band_root(const BandQuadratic *f, bool rising, double otherwise)
{
    if (f->root == 0 && f->A != 0) return -f->B / f->A;
    double q = -(f->B + (f->B < 0 ? -f->root : f->root));
    if (rising == (f->B < 0) && f->A != 0) return q / f->A;
    return q != 0 ? f->C / q : otherwise;
}

/* The one crossing between the end `in`, which is above the line, and the end `out`, which is not. F is
 * developed about `in`: there its value is negative and is the same number for both bands that share the
 * end. So where a line grazes a shared circle both neighbours find the same t and the order of crossings
 * is kept. */
static inline double band_single_root(const Piece *piece, Vec3 dir, const BandEnd *in, double radius, double t_out)
{
    double er = piece->r1 - piece->r0;
    double ey = piece->y1 - piece->y0;
    double k = er * dir.y;
    double ey2 = ey * ey;
    double sign = t_out > in->t ? 1 : -1;
    double A = ey2 * (dir.x * dir.x + dir.z * dir.z) - k * k;
    double B = sign * ey * (ey * (in->x * dir.x + in->z * dir.z) - k * radius);
    double C = ey2 * in->excess;
    double discriminant = B * B - A * C;
    if (A <= 0) {
        double ex = ey * radius * dir.x - k * in->x;
        double ez = ey * radius * dir.z - k * in->z;
        double moment = ey * (in->x * dir.z - in->z * dir.x);
        discriminant = ey2 * ((ex * ex + ez * ez) - moment * moment);
    }
    double root = discriminant > 0 ? sqrt(discriminant) : 0;
    /* the smallest u > 0 with A u^2 + 2 B u + C = 0, where C < 0 */
    if (B >= 0 && B + root > 0) return in->t + sign * (-C / (B + root));
    return A > 0 ? in->t + sign * ((root - B) / A) : t_out;
}

static double band_single(const Piece *piece, Vec3 org, Vec3 dir, const BandEnd *p, const BandEnd *q)
{
    if (piece->y0 == piece->y1) return p->t;
    if (piece->r0 == piece->r1) {
        BandQuadratic f = band_quadratic(piece, org, dir);
        if (!f.grazing) return band_root(&f, p->above == (q->t > p->t), p->t);
    }
    return p->above ? band_single_root(piece, dir, p, piece->r0, q->t)
                    : band_single_root(piece, dir, q, piece->r1, p->t);
}

static double keep_between(double t, double a, double b)
{
    return a < b ? double_max(a, double_min(t, b)) : double_max(b, double_min(t, a));
}

static inline void add_crossing(PieceCrossings *out, double t, bool leaving, double t_min, double t_max)
{
    if (!(t > t_min && t <= t_max)) return;
    out->t[out->n] = t;
    out->leaving[out->n++] = leaving;
}

/* The two crossings of a line that is farther from the axis than both ends, p and q. */
ATTR_APART static void cross_band_twice(const Piece *piece, const PieceLine *line, double p_t, double q_t, double t_min,
                                        double t_max, PieceCrossings *out)
{
    /* F is positive at both ends; so two roots stand between them if F opens upward, falls below zero, and
     * has its least value between the ends. (Where the line lies in the surface F is nothing but rounding;
     * keeping the roots between the ends gives something sensible even then.) */
    BandQuadratic f = band_quadratic(piece, line->org, line->dir);
    if (!(f.A > 0) || !(f.root > 0)) return;
    double middle = -f.B / f.A;
    if ((p_t < middle) == (q_t < middle)) return;
    double near = band_root(&f, false, middle);
    double far = band_root(&f, true, middle);
    if (!(near < middle && middle < far)) return; /* grazing: not met at all */
    bool outer = piece->y1 > piece->y0;
    add_crossing(out, keep_between(near, p_t, q_t), !outer, t_min, t_max);
    add_crossing(out, keep_between(far, p_t, q_t), outer, t_min, t_max);
}

/* The one crossing between p and q, of which one is above the line. */
ATTR_APART static void cross_band_once(const Piece *piece, const PieceLine *line, const BandEnd *p, const BandEnd *q,
                                       double t_min, double t_max, PieceCrossings *out)
{
    double t = keep_between(band_single(piece, line->org, line->dir, p, q), p->t, q->t);
    add_crossing(out, t, p->above == (line->dir.y > 0), t_min, t_max);
}

/* Most lines that come near a band do not meet it: that is found first. */
static inline void cross_band(const Piece *piece, const PieceLine *line, double t_min, double t_max,
                              PieceCrossings *out)
{
    BandEnd p = band_end(piece->r0, piece->y0, line), q = band_end(piece->r1, piece->y1, line);
    if (p.above != q.above) {
        if (double_max(p.t, q.t) <= t_min || double_min(p.t, q.t) > t_max) return;
        cross_band_once(piece, line, &p, &q, t_min, t_max, out);
    } else if (!p.above && piece->y0 != piece->y1) {
        cross_band_twice(piece, line, p.t, q.t, t_min, t_max, out);
    }
}

static inline bool is_arc(const Piece *piece)
{
    return piece->kind == PIECE_OUTER_ARC || piece->kind == PIECE_INNER_ARC;
}

static Tube tube_of(const Piece *piece)
{
    if (piece->kind == PIECE_TORUS) return (Tube){TUBE_WHOLE, piece->r0, 0, piece->r1 * piece->r1};
    double r = piece->r0 - piece->centre_r, y = piece->y0 - piece->centre_y;
    TubePart part = piece->kind == PIECE_OUTER_ARC ? TUBE_OUTER : TUBE_INNER;
    return (Tube){part, piece->centre_r, piece->centre_y, r * r + y * y};
}

/* 1 where the outside is away from the circle's centre, -1 where it is towards it. */
static double arc_side(const Piece *piece)
{
    return is_arc(piece) && (piece->kind == PIECE_OUTER_ARC) != (piece->y1 > piece->y0) ? -1 : 1;
}

/* What is inside of the solid is outside of the tube where the tube is hollowed out of it. */
static PieceStart tube_start(const Piece *piece, PieceStart start)
{
    if (start == PIECE_START_ELSEWHERE || arc_side(piece) > 0) return start;
    return start == PIECE_START_INSIDE ? PIECE_START_OUTSIDE : PIECE_START_INSIDE;
}

static void cross_curved(const Piece *piece, const PieceLine *line, double t_min, double t_max, PieceStart start,
                         TubeCrossings *out)
{
    if (piece->kind == PIECE_TORUS) {
        Tube tube = tube_of(piece);
        tube_cross(&tube, line, NULL, t_min, t_max, start, out);
        return;
    }
    BandEnd p = band_end(piece->r0, piece->y0, line);
    BandEnd q = band_end(piece->r1, piece->y1, line);
    bool outer = piece->kind == PIECE_OUTER_ARC;
    /* What is nearer to the axis than an outer arc is convex: a line that is at both ends is all the way between. And what
     * is met is between the ends. */
    if ((outer && p.above && q.above) || double_max(p.t, q.t) <= t_min || double_min(p.t, q.t) > t_max) {
        out->n = 0;
        out->first_enters = true;
        return;
    }
    Tube tube = tube_of(piece);
    TubeSpan span = {p.t, q.t, p.above == outer, q.above == outer};
    if (q.t < p.t) span = (TubeSpan){q.t, p.t, q.above == outer, p.above == outer};
    tube_cross(&tube, line, &span, t_min, t_max, start, out);
}

/* The discriminant from the distance between line and centre: E. Haines, J. Gunther, T. Akenine-Moeller,
 * "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7 (2019). */
void piece_cross_ball(double radius, Vec3 org, Vec3 dir, double t_min, double t_max, PieceCrossings *out)
{
    out->n = 0;
    double a = vec3_dot(dir, dir), inverse = 1 / a;
    double b = -vec3_dot(org, dir);
    double middle = b * inverse;
    Vec3 nearest = vec3_along(org, middle, dir);
    double discriminant = radius * radius - vec3_dot(nearest, nearest);
    if (!(discriminant > 0)) return;
    double root = sqrt(a * discriminant);
    double q = b + (b < 0 ? -root : root);
    double c = vec3_dot(org, org) - radius * radius;
    double t0 = c / q, t1 = q * inverse;
    double near = double_min(t0, t1), far = double_max(t0, t1);
    if (!(near < middle && middle < far)) return;
    add_crossing(out, near, false, t_min, t_max);
    add_crossing(out, far, true, t_min, t_max);
}

static void cross_plane(const Piece *piece, const PieceLine *line, double t_min, double t_max, PieceCrossings *out)
{
    if (line->dir.y == 0) return;
    double t = -line->org.y / line->dir.y;
    double x = line->org.x + t * line->dir.x;
    double z = line->org.z + t * line->dir.z;
    if (piece->kind == PIECE_PLANE || (fabs(x) <= piece->r0 && fabs(z) <= piece->r1))
        add_crossing(out, t, line->dir.y > 0, t_min, t_max);
}

/* Pieces that are no bands. */
ATTR_APART static void cross_other(const Piece *piece, const PieceLine *line, double t_min, double t_max,
                                   PieceStart start, PieceCrossings *out)
{
    if (piece->kind == PIECE_SPHERE) {
        piece_cross_ball(piece->r0, line->org, line->dir, t_min, t_max, out);
    } else if (piece->kind == PIECE_TORUS || is_arc(piece)) {
        TubeCrossings crossings;
        cross_curved(piece, line, t_min, t_max, tube_start(piece, start), &crossings);
        bool leaving = crossings.first_enters == (arc_side(piece) < 0);
        out->n = crossings.n;
        for (int i = 0; i < crossings.n; i++, leaving = !leaving) {
            out->t[i] = crossings.t[i];
            out->leaving[i] = leaving;
        }
    } else {
        cross_plane(piece, line, t_min, t_max, out);
    }
}

void piece_cross(const Piece *piece, const PieceLine *line, double t_min, double t_max, PieceStart start,
                 PieceCrossings *out)
{
    out->n = 0;
    if (LIKELY(piece->kind == PIECE_BAND))
        cross_band(piece, line, t_min, t_max, out);
    else
        cross_other(piece, line, t_min, t_max, start, out);
}

int piece_intersect(const Piece *piece, Vec3 org, Vec3 dir, double t_min, double t_max, double t[PIECE_MAX_ROOTS])
{
    PieceLine line = piece_line(org, dir);
    PieceCrossings crossings;
    piece_cross(piece, &line, t_min, t_max, PIECE_START_ELSEWHERE, &crossings);
    for (int i = 0; i < crossings.n; i++) t[i] = crossings.t[i];
    return crossings.n;
}

/* The unit vector away from the axis; any one on the axis itself. */
static Vec3 away_from_axis(Vec3 p)
{
    double r = sqrt(p.x * p.x + p.z * p.z);
    return r > 0 ? vec3(p.x / r, 0, p.z / r) : vec3(1, 0, 0);
}

/* Whether the line leaves at t, from the same signs that found the crossing. */
ATTR_COLD static bool crossing_leaves(const Piece *piece, Vec3 org, Vec3 dir, double t, double cosine)
{
    PieceLine line = piece_line(org, dir);
    PieceCrossings crossings;
    piece_cross(piece, &line, -HUGE_VAL, HUGE_VAL, PIECE_START_ELSEWHERE, &crossings);
    int nearest = 0;
    for (int i = 1; i < crossings.n; i++)
        if (fabs(t - crossings.t[i]) < fabs(t - crossings.t[nearest])) nearest = i;
    return crossings.n ? crossings.leaving[nearest] : cosine > 0;
}

/* Where a tube's normal points at p, from the circle that it is about. */
static Vec3 tube_normal(const Piece *piece, const Tube *tube, Vec3 p)
{
    double from_axis = sqrt(p.x * p.x + p.z * p.z);
    double r = from_axis - tube->centre_r, y = p.y - tube->centre_y;
    /* A crossing that rounding puts beyond the arc's top or bottom is still one of the arc. */
    if (tube->part == TUBE_OUTER) r = double_max(r, 0);
    if (tube->part == TUBE_INNER) r = double_min(r, 0);
    double squared = r * r + y * y;
    if (!(squared > 0)) return vec3(0, 1, 0);
    double scale = arc_side(piece) / sqrt(squared);
    if (!(from_axis > 0)) return vec3(r * scale, y * scale, 0);
    double across = r * scale / from_axis;
    return vec3(p.x * across, y * scale, p.z * across);
}

static Vec3 unaided_normal(const Piece *piece, Vec3 p)
{
    switch (piece->kind) {
    case PIECE_SPHERE: return vec3_normalize(p);
    case PIECE_BAND: {
        double er = piece->r1 - piece->r0;
        double ey = piece->y1 - piece->y0;
        double squared = p.x * p.x + p.z * p.z, length = er * er + ey * ey;
        if (!(squared > 0)) return vec3_normalize(vec3(ey, -er, 0));
        double scale = 1 / sqrt(squared * length);
        return vec3(p.x * ey * scale, -er * sqrt(squared) * scale, p.z * ey * scale);
    }
    case PIECE_TORUS:
    case PIECE_OUTER_ARC:
    case PIECE_INNER_ARC: {
        Tube tube = tube_of(piece);
        return tube_normal(piece, &tube, p);
    }
    case PIECE_RECT:
    case PIECE_PLANE: break;
    }
    return vec3(0, 1, 0);
}

/* Below this cosine it is not for the normal to say which way a surface is crossed. On a tube that is grazed, the place
 * of a crossing is known to the square root of rounding. */
static double graze_of(const Piece *piece)
{
    if (piece->kind != PIECE_TORUS && !is_arc(piece)) return least_cosine;
    Tube tube = tube_of(piece);
    return 0x1p-24 * sqrt(1 + fabs(tube.centre_r) / sqrt(tube.squared));
}

/* How far p must move to turn the normal by about 1. */
static double turning_length(const Piece *piece, Vec3 p)
{
    double across = fabs(p.x) + fabs(p.z);
    if (piece->kind == PIECE_TORUS) return double_min(across, piece->r1);
    if (is_arc(piece)) return double_min(across, fabs(piece->r0 - piece->centre_r) + fabs(piece->y0 - piece->centre_y));
    return across;
}

Vec3 piece_normal(const Piece *piece, Vec3 org, Vec3 dir, double t)
{
    Vec3 p = vec3_along(org, t, dir);
    Vec3 normal = unaided_normal(piece, p);
    double slope = vec3_dot(normal, dir), squared = vec3_dot(dir, dir);
    double reach = fabs(org.x) + fabs(org.z) + fabs(t) * (fabs(dir.x) + fabs(dir.z));
    if (piece->kind != PIECE_BAND) reach += fabs(org.y) + fabs(t * dir.y);
    double across = turning_length(piece, p);
    if (LIKELY(slope * slope > 1e-2 * squared && across > 1e-6 * reach)) return normal;
    double length = sqrt(squared), cosine = slope / length, least = graze_of(piece);
    if (fabs(cosine) * across > least * across + 1e-14 * reach) return normal;
    /* A graze, or a place where the normal is all rounding: what counts is which way the surface is crossed,
     * and that is known. The normal is tilted to say the same. */
    double side = crossing_leaves(piece, org, dir, t, cosine) ? 1 : -1;
    if (cosine * side >= least) return normal;
    return vec3_normalize(vec3_along(normal, (side * 2 * least - cosine) / length, dir));
}

Vec3 piece_ball_normal(Vec3 org, Vec3 dir, double t, bool leaving)
{
    Vec3 normal = vec3_normalize(vec3_along(org, t, dir));
    double cosine = vec3_dot(normal, dir), side = leaving ? 1 : -1;
    if (LIKELY(cosine * side >= least_cosine)) return normal;
    return vec3_normalize(vec3_along(normal, side * 2 * least_cosine - cosine, dir));
}

static double clamp_unit(double x)
{
    return fmin(fmax(x, 0), 1);
}

/* How far along the band's generating line, 0..1, the point nearest to (r, y) is. */
static double band_fraction(const Piece *piece, double r, double y)
{
    double er = piece->r1 - piece->r0;
    double ey = piece->y1 - piece->y0;
    return clamp_unit(((r - piece->r0) * er + (y - piece->y0) * ey) / (er * er + ey * ey));
}

static const double turns_per_radian = 1 / (2 * MEN_PI);

/* The angle from x towards y, as a fraction of a turn in [0, 1). */
static double turn_fraction(double x, double y)
{
    double u = atan2(y, x) * turns_per_radian;
    u = u < 0 ? u + 1 : u;
    return u < 1 ? u : 0;
}

/* About the axis, counter-clockwise seen from above: to the right, seen from outside. */
static double turn_about_axis(Vec3 p)
{
    return turn_fraction(p.x, -p.z);
}

/* The angle at an arc's centre from its start to (r, y), positive along the arc, -90 to 270 degrees. */
static double arc_angle(const Piece *piece, double r, double y)
{
    double r0 = piece->r0 - piece->centre_r, y0 = piece->y0 - piece->centre_y;
    double r1 = r - piece->centre_r, y1 = y - piece->centre_y;
    double angle = arc_side(piece) * atan2(r0 * y1 - y0 * r1, r0 * r1 + y0 * y1);
    return angle < -0.5 * MEN_PI ? angle + 2 * MEN_PI : angle;
}

/* How far along an arc, 0..1, a point in the half plane is. */
static double arc_fraction(const Piece *piece, double r, double y)
{
    return clamp_unit(arc_angle(piece, r, y) / arc_angle(piece, piece->r1, piece->y1));
}

void piece_surface(const Piece *piece, Vec3 org, Vec3 dir, double t, PieceRoot *root)
{
    Vec3 p = vec3_along(org, t, dir);
    root->t = t;
    root->normal = piece_normal(piece, org, dir, t);
    root->shading = root->normal;
    root->u = 0;
    root->v = 0;
    switch (piece->kind) {
    case PIECE_SPHERE:
        root->u = turn_about_axis(p);
        root->v = acos(fmin(fmax(-p.y / vec3_length(p), -1), 1)) * (1 / MEN_PI);
        break;
    case PIECE_BAND: {
        double s = band_fraction(piece, sqrt(p.x * p.x + p.z * p.z), p.y);
        double nr = (double)piece->nr0 + s * ((double)piece->nr1 - (double)piece->nr0);
        double ny = (double)piece->ny0 + s * ((double)piece->ny1 - (double)piece->ny0);
        double length = sqrt(nr * nr + ny * ny);
        if (length > 0) {
            Vec3 out = away_from_axis(p);
            root->shading = vec3(out.x * nr / length, ny / length, out.z * nr / length);
        }
        root->u = turn_about_axis(p);
        root->v = (double)piece->v0 + s * ((double)piece->v1 - (double)piece->v0);
        break;
    }
    case PIECE_TORUS:
        root->u = turn_about_axis(p);
        root->v = turn_fraction(sqrt(p.x * p.x + p.z * p.z) - piece->r0, p.y);
        break;
    case PIECE_OUTER_ARC:
    case PIECE_INNER_ARC: {
        double s = arc_fraction(piece, sqrt(p.x * p.x + p.z * p.z), p.y);
        root->u = turn_about_axis(p);
        root->v = (double)piece->v0 + s * ((double)piece->v1 - (double)piece->v0);
        break;
    }
    case PIECE_RECT:
        root->u = clamp_unit(0.5 + 0.5 * p.x / piece->r0);
        root->v = clamp_unit(0.5 - 0.5 * p.z / piece->r1);
        break;
    case PIECE_PLANE:
        root->u = p.x;
        root->v = -p.z;
        break;
    }
}

/* From the half plane of r and y to space, at the angle about the axis that p is at. */
static Vec3 from_half_plane(Vec3 p, double r, double y)
{
    Vec3 out = away_from_axis(p);
    return vec3(out.x * r, y, out.z * r);
}

Vec3 piece_bulge(const Piece *piece, Vec3 p, bool outside)
{
    if (!piece_is_smoothed(piece)) return vec3(0, 0, 0);
    double r = sqrt(p.x * p.x + p.z * p.z), s = band_fraction(piece, r, p.y), side = outside ? 1 : -1;
    double nr0 = (double)piece->nr0, ny0 = (double)piece->ny0, nr1 = (double)piece->nr1, ny1 = (double)piece->ny1;
    double from0 = side * ((piece->r0 - r) * nr0 + (piece->y0 - p.y) * ny0);
    double from1 = side * ((piece->r1 - r) * nr1 + (piece->y1 - p.y) * ny1);
    double height0 = side * (1 - s) * double_max(from0, 0), height1 = side * s * double_max(from1, 0);
    return from_half_plane(p, height0 * nr0 + height1 * nr1, height0 * ny0 + height1 * ny1);
}

void piece_gradients(const Piece *piece, Vec3 p, Vec3 *du, Vec3 *dv)
{
    double square = p.x * p.x + p.z * p.z, r = sqrt(square), span = (double)piece->v1 - (double)piece->v0;
    *du = square > 0 ? vec3(turns_per_radian * p.z / square, 0, -turns_per_radian * p.x / square) : vec3(0, 0, 0);
    *dv = vec3(0, 0, 0);
    switch (piece->kind) {
    case PIECE_SPHERE: {
        double radius = square + p.y * p.y;
        if (radius > 0) *dv = vec3_scale(from_half_plane(p, -p.y, r), 2 * turns_per_radian / radius);
        break;
    }
    case PIECE_BAND: {
        double er = piece->r1 - piece->r0, ey = piece->y1 - piece->y0;
        *dv = vec3_scale(from_half_plane(p, er, ey), span / (er * er + ey * ey));
        break;
    }
    case PIECE_TORUS: {
        double x = r - piece->r0, distance = x * x + p.y * p.y;
        if (distance > 0) *dv = vec3_scale(from_half_plane(p, -p.y, x), turns_per_radian / distance);
        break;
    }
    case PIECE_OUTER_ARC:
    case PIECE_INNER_ARC: {
        double x = r - piece->centre_r, y = p.y - piece->centre_y, distance = x * x + y * y;
        double whole = arc_side(piece) * arc_angle(piece, piece->r1, piece->y1);
        if (distance > 0) *dv = vec3_scale(from_half_plane(p, -y, x), span / (whole * distance));
        break;
    }
    case PIECE_RECT:
        *du = vec3(0.5 / piece->r0, 0, 0);
        *dv = vec3(0, 0, -0.5 / piece->r1);
        break;
    case PIECE_PLANE:
        *du = vec3(1, 0, 0);
        *dv = vec3(0, 0, -1);
        break;
    }
}

HalfBox piece_half_bounds(const Piece *piece)
{
    if (piece->kind == PIECE_TORUS)
        return (HalfBox){fmax(piece->r0 - piece->r1, 0), -piece->r1, piece->r0 + piece->r1, piece->r1};
    HalfBox box = {fmin(piece->r0, piece->r1), fmin(piece->y0, piece->y1), fmax(piece->r0, piece->r1),
                   fmax(piece->y0, piece->y1)};
    if (is_arc(piece) && box.y0 < piece->centre_y && piece->centre_y < box.y1) {
        if (piece->kind == PIECE_OUTER_ARC)
            box.r1 = piece->centre_r + sqrt(tube_of(piece).squared);
        else
            box.r0 = fmax(piece->centre_r - sqrt(tube_of(piece).squared), 0);
    }
    return box;
}

Box3 piece_bounds(const Piece *piece)
{
    double r = piece->r0;
    switch (piece->kind) {
    case PIECE_SPHERE: break;
    case PIECE_BAND:
    case PIECE_TORUS:
    case PIECE_OUTER_ARC:
    case PIECE_INNER_ARC: {
        HalfBox box = piece_half_bounds(piece);
        return (Box3){{-box.r1, box.y0, -box.r1}, {box.r1, box.y1, box.r1}};
    }
    case PIECE_RECT: return (Box3){{-piece->r0, 0, -piece->r1}, {piece->r0, 0, piece->r1}};
    case PIECE_PLANE: return (Box3){{-HUGE_VAL, 0, -HUGE_VAL}, {HUGE_VAL, 0, HUGE_VAL}};
    }
    return (Box3){{-r, -r, -r}, {r, r, r}};
}
