/* piece_sample.c - areas of analytic pieces, and points spread evenly over them.
 * All of them but the rectangle are profiles turned about the y axis: of a line or a circle's arc the area between two
 * of its points is 2 pi times the integral of the radius along it, in closed form. A line's inverts in closed form, too;
 * an arc's, a angle + b sin(angle), by Newton's method.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/piece.h"

#include "base/angle.h"

/* A circle's arc in the half plane: about (r, y), from one angle to a larger one. */
typedef struct Arc {
    double r, y, radius, from, to;
    double side; /* 1: the outside is away from the circle's centre; -1: towards it */
} Arc;

static Arc arc_of(const Piece *piece)
{
    if (piece->kind == PIECE_TORUS) {
        /* one that reaches over the axis ends there */
        double end = piece->r1 > piece->r0 ? acos(-piece->r0 / piece->r1) : MEN_PI;
        return (Arc){piece->r0, 0, piece->r1, -end, end, 1};
    }
    bool outer = piece->kind == PIECE_OUTER_ARC, up = piece->y1 > piece->y0;
    double r = piece->centre_r, y = piece->centre_y;
    double a = atan2(piece->y0 - y, piece->r0 - r), b = atan2(piece->y1 - y, piece->r1 - r);
    if (!outer && a < 0) a += 2 * MEN_PI;
    if (!outer && b < 0) b += 2 * MEN_PI;
    return (Arc){r, y, hypot(piece->r0 - r, piece->y0 - y), fmin(a, b), fmax(a, b), outer == up ? 1 : -1};
}

/* The area below an angle, over 2 pi and the circle's radius, up to a constant. */
static double arc_sum(const Arc *arc, double angle)
{
    return arc->r * angle + arc->radius * sin(angle);
}

double piece_area(const Piece *piece)
{
    Arc arc;
    switch (piece->kind) {
    case PIECE_SPHERE: return 4 * MEN_PI * piece->r0 * piece->r0;
    case PIECE_BAND: return MEN_PI * (piece->r0 + piece->r1) * hypot(piece->r1 - piece->r0, piece->y1 - piece->y0);
    case PIECE_RECT: return 4 * piece->r0 * piece->r1;
    case PIECE_PLANE: return 0;
    default: arc = arc_of(piece); return 2 * MEN_PI * arc.radius * (arc_sum(&arc, arc.to) - arc_sum(&arc, arc.from));
    }
}

/* Newton's method on a function that does not fall, held between bounds that close in. */
static double arc_invert(const Arc *arc, double u)
{
    double low = arc->from, high = arc->to, at = 0.5 * (low + high);
    double first = arc_sum(arc, low), whole = arc_sum(arc, high) - first, wanted = first + u * whole;
    for (int i = 0; i < 60; i++) {
        double over = arc_sum(arc, at) - wanted;
        if (fabs(over) <= 1e-14 * whole) break;
        if (over > 0)
            high = at;
        else
            low = at;
        double slope = arc->r + arc->radius * cos(at), next = at - over / slope;
        at = next > low && next < high ? next : 0.5 * (low + high);
    }
    return at;
}

Vec3 piece_sample(const Piece *piece, double u, double v, Vec3 *normal)
{
    double r, y, normal_r, normal_y;
    if (piece->kind == PIECE_RECT) {
        *normal = vec3(0, 1, 0);
        return vec3((2 * u - 1) * piece->r0, 0, (2 * v - 1) * piece->r1);
    }
    if (piece->kind == PIECE_SPHERE) {
        normal_y = 1 - 2 * u;
        normal_r = 2 * sqrt(u * (1 - u));
        r = piece->r0 * normal_r;
        y = piece->r0 * normal_y;
    } else if (piece->kind == PIECE_BAND) {
        double a = piece->r0, b = piece->r1, length = hypot(b - a, piece->y1 - piece->y0);
        double part = u * (a + b) / (a + sqrt((1 - u) * a * a + u * b * b));
        if (!(part >= 0)) part = 0; /* from the axis, u = 0 */
        r = a + part * (b - a);
        y = piece->y0 + part * (piece->y1 - piece->y0);
        normal_r = (piece->y1 - piece->y0) / length;
        normal_y = (a - b) / length;
    } else {
        Arc arc = arc_of(piece);
        double angle = arc_invert(&arc, u), cosine = cos(angle), sine = sin(angle);
        r = fmax(arc.r + arc.radius * cosine, 0);
        y = arc.y + arc.radius * sine;
        normal_r = arc.side * cosine;
        normal_y = arc.side * sine;
    }
    double cosine = cos(2 * MEN_PI * v), sine = sin(2 * MEN_PI * v);
    *normal = vec3(normal_r * cosine, normal_y, normal_r * sine);
    return vec3(r * cosine, y, r * sine);
}

/* The u of a point of a band, (r, y) in the half plane: what of its area is nearer to its beginning. */
static double band_part(const Piece *piece, double r, double y)
{
    double a = piece->r0, b = piece->r1, along = b - a, up = piece->y1 - piece->y0;
    double part = ((r - a) * along + (y - piece->y0) * up) / (along * along + up * up);
    return part * (2 * a + part * along) / (a + b);
}

static double arc_part(const Piece *piece, double r, double y)
{
    Arc arc = arc_of(piece);
    double angle = atan2(y - arc.y, r - arc.r), first = arc_sum(&arc, arc.from);
    double off = angle - 0.5 * (arc.from + arc.to);
    if (fabs(off) > MEN_PI) angle -= copysign(2 * MEN_PI, off);
    angle = fmin(fmax(angle, arc.from), arc.to);
    return (arc_sum(&arc, angle) - first) / (arc_sum(&arc, arc.to) - first);
}

void piece_find(const Piece *piece, Vec3 p, double u[2])
{
    if (piece->kind == PIECE_RECT) {
        u[0] = 0.5 + 0.5 * p.x / piece->r0;
        u[1] = 0.5 + 0.5 * p.z / piece->r1;
        return;
    }
    double r = hypot(p.x, p.z), turn = atan2(p.z, p.x) / (2 * MEN_PI);
    u[1] = turn < 0 ? turn + 1 : turn;
    if (piece->kind == PIECE_SPHERE)
        u[0] = 0.5 - 0.5 * p.y / piece->r0;
    else
        u[0] = piece->kind == PIECE_BAND ? band_part(piece, r, p.y) : arc_part(piece, r, p.y);
}
