/* piece.h - analytic surfaces, intersected in double precision.
 * A solid of revolution is made of pieces that share their edges exactly; together they are closed. A
 * piece is in its solid's local frame: the axis of revolution is y. Rounding at shared edges is that of
 * double precision, so that a ray meets one of two neighbours and not both or none.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_PIECE_H
#define MEN_PIECE_H

#include <stdbool.h>
#include <stdint.h>

#include "base/status.h"
#include "base/vec3.h"

typedef enum PieceKind {
    PIECE_SPHERE, /* about the origin, radius r0 */
    PIECE_BAND,   /* the line from (r0, y0) to (r1, y1) turned about y: cylinder, cone, disc or ring (y0 == y1) */
    PIECE_TORUS,  /* the circle of radius r1 about (r0, 0) turned about y; where r1 > r0 it reaches over the axis, and
                   * what either side encloses is inside */
    /* The arc of a circle about (centre_r, centre_y) turned about y: a part of a torus, or of a sphere (centre_r == 0).
     * It runs from (r0, y0) to (r1, y1), always up or always down, on one side of the circle's centre. */
    PIECE_OUTER_ARC, /* r >= centre_r */
    PIECE_INNER_ARC, /* r <= centre_r, which is positive */
    PIECE_RECT,      /* the rectangle |x| <= r0, |z| <= r1 in the plane y = 0, facing +y; open */
    PIECE_PLANE      /* the plane y = 0, facing +y, without bounds; as a solid all that is below it */
} PieceKind;

typedef struct Piece {
    PieceKind kind;
    /* Bands and arcs: in the half plane with r to the right and y up, walking from point 0 to point 1 the
     * outside is on the right-hand side: a band's outward normal (in r, y) is (y1 - y0, r0 - r1) normalized. */
    double r0, y0, r1, y1;
    union {
        struct {
            float nr0, ny0, nr1, ny1; /* PIECE_BAND: shading normals in the half plane at both ends */
        };
        struct {
            double centre_r, centre_y; /* arcs */
        };
    };
    float v0, v1; /* bands and arcs: the surface coordinate v at both ends */
} Piece;

/* One crossing of the line org + t dir with a piece. */
typedef struct PieceRoot {
    double t;
    Vec3 normal;  /* geometric, outward, NOT normalized in world units: local frame, unit there */
    Vec3 shading; /* shading normal, local frame, unit */
    double u, v;  /* surface coordinates, 0..1: around from +x towards -z, so to the right seen from outside; along;
                   * PIECE_PLANE: x and -z themselves */
} PieceRoot;

/* A line in a piece's frame, org + t dir, with what all pieces of a solid ask of it. dir need not be unit. */
typedef struct PieceLine {
    Vec3 org, dir;
    double inverse_y; /* 1 / dir.y; 0 where that is 0 */
} PieceLine;
static inline PieceLine piece_line(Vec3 org, Vec3 dir)
{
    return (PieceLine){org, dir, fabs(dir.y) > 1e-300 ? 1 / dir.y : 0};
}

enum { PIECE_MAX_ROOTS = 4 };
typedef struct PieceCrossings {
    int n;
    double t[PIECE_MAX_ROOTS];
    bool leaving[PIECE_MAX_ROOTS]; /* the line goes along the outward normal there */
} PieceCrossings;
/* Where the line is from t = 0 on, if it starts there on the piece itself. */
typedef enum PieceStart { PIECE_START_ELSEWHERE, PIECE_START_INSIDE, PIECE_START_OUTSIDE } PieceStart;
/* All crossings with t_min < t <= t_max in increasing t: at most 4 on a torus and on inner arcs, 2 elsewhere. A tangent
 * line crosses twice or not at all. The crossing that brought the line to where it starts may be left out. */
void piece_cross(const Piece *piece, const PieceLine *line, double t_min, double t_max, PieceStart start,
                 PieceCrossings *out);
/* The same for a sphere about the origin. */
void piece_cross_ball(double radius, Vec3 org, Vec3 dir, double t_min, double t_max, PieceCrossings *out);
/* The same for a line that is asked for once; only t is filled. Returns how many. */
int piece_intersect(const Piece *piece, Vec3 org, Vec3 dir, double t_min, double t_max, double t[PIECE_MAX_ROOTS]);
/* The outward normal at one of these crossings, unit, as in PieceRoot, and nothing else (no trigonometry).
 * The sign of its product with dir tells which way the surface is crossed, and never contradicts the order
 * of crossings: at grazing incidence, where rounding could turn it over, it is tilted by about 1e-9. */
Vec3 piece_normal(const Piece *piece, Vec3 org, Vec3 dir, double t);
/* The same for a sphere about the origin, and a unit dir; leaving: as piece_cross_ball told. */
Vec3 piece_ball_normal(Vec3 org, Vec3 dir, double t, bool leaving);
/* Whether the normal for shading is another one than the geometric, to more than float tells. */
static inline bool piece_is_smoothed(const Piece *piece)
{
    return piece->kind == PIECE_BAND && !(piece->nr0 == piece->nr1 && piece->ny0 == piece->ny1);
}
/* The geometry at one of these crossings. */
void piece_surface(const Piece *piece, Vec3 org, Vec3 dir, double t, PieceRoot *root);
/* Twice as far as the curved surface that the shading normals of a band describe stands out over the band at a point of it, in the
 * piece's frame, seen from outside (outside: true) or from within: see rtc_bulge. Zero of all other pieces. */
Vec3 piece_bulge(const Piece *piece, Vec3 p, bool outside);
/* How u and v change at a point of the surface: their gradients along it, in the piece's frame; zero on the axis, where u
 * has none. */
void piece_gradients(const Piece *piece, Vec3 p, Vec3 *du, Vec3 *dv);
Box3 piece_bounds(const Piece *piece);
/* The area of a piece in its own frame; 0 for a plane without end. */
double piece_area(const Piece *piece);
/* A point of the piece in its own frame, uniform in area for u and v uniform in [0, 1); *normal: outward, unit. Not for
 * planes without end. */
Vec3 piece_sample(const Piece *piece, double u, double v, Vec3 *normal);
/* The u and v that piece_sample has for a point of the piece. */
void piece_find(const Piece *piece, Vec3 p, double u[2]);
/* The rectangle in the half plane that a band, an arc or a torus stays within. */
typedef struct HalfBox {
    double r0, y0, r1, y1;
} HalfBox;
HalfBox piece_half_bounds(const Piece *piece);

/* A closed solid made of pieces. */
typedef struct Solid {
    double volume; /* closed form */
    uint32_t n_pieces;
    Piece pieces[];
} Solid;

void solid_free(Solid *solid); /* NULL is fine */
/* A solid with room for n zeroed pieces, for makers. */
ATTR_NODISCARD Status solid_new(uint32_t n_pieces, Solid **solid, Error *error);
/* A band with the shading normals of its own surface at both ends; v runs from 0 to 1. The ends differ. */
Piece piece_make_band(double r0, double y0, double r1, double y1);
/* The volume between a band or an arc and the axis, positive where it faces away from the axis; the sum over a closed
 * solid is its volume. */
double piece_volume(const Piece *piece);
ATTR_NODISCARD Status solid_make_sphere(double radius, Solid **solid, Error *error);
/* Everything within `tube` of the circle of that radius about the y axis, in the plane y = 0. A tube greater than the
 * radius reaches over the axis; the solid is then the whole of it, like an apple, with no void inside. */
ATTR_NODISCARD Status solid_make_torus(double radius, double tube, Solid **solid, Error *error);
/* Everything within `radius` of the line from the origin to (0, height, 0). */
ATTR_NODISCARD Status solid_make_capsule(double radius, double height, Solid **solid, Error *error);
/* Between y = 0 and y = height about the y axis. radius0 at the bottom; either radius may be 0, not both. Edges and
 * a tip are rounded by arcs of radius `rounding`, at most solid_cone_rounding; 0: sharp. */
ATTR_NODISCARD Status solid_make_cone(double radius0, double radius1, double height, double rounding, Solid **solid,
                                      Error *error);
/* The largest rounding that fits such a cone. */
double solid_cone_rounding(double radius0, double radius1, double height);
/* profile: n points (r, y), r >= 0, a simple polygon (closed by its last edge, or open with both ends on
 * the axis), in either sense. Edges on the axis make no surface. Points equal to the one before them are
 * dropped. round[i] > 0 rounds corner i by an arc of that radius (NULL: none), a corner on the axis by an
 * arc that meets the axis at a right angle; the arcs are exact. Other corners keep their edge, unless smooth_all: then
 * normals are interpolated over all corners that turn less than 40 degrees. STATUS_SCENE with the reason, the number
 * and the coordinates of the point when a number is negative, not finite or beyond 1e15, the profile crosses or touches
 * itself off the axis, has fewer than 3 or more than 100,000 points, makes more than 200,000 edges (of which an arc
 * counts one for each degree), encloses nothing, or a rounding does not fit. The search for crossings takes O(n log n)
 * steps for profiles that are not contrived, and gives up with an error after 1e9, some seconds. */
ATTR_NODISCARD Status solid_make_lathe(const double (*profile)[2], uint32_t n, const double *round, bool smooth_all,
                                       Solid **solid, Error *error);
/* The same with a curve through the points instead of straight edges, made of arcs that keep within `tolerance` of it
 * (0: 1e-5 of the profile's size) and meet smoothly. */
typedef enum LatheCurve {
    LATHE_CUBIC,  /* smooth through all points, and meeting the axis at a right angle, but for those that are corners
                  * (corner: n truths); straight between two corners; closed by its last piece, or along the axis */
    LATHE_BEZIER, /* every third point is on the curve, the two between are its control points; 3 k points are closed, 3
                   * k + 1 are closed by a straight edge; corner is not looked at */
    LATHE_NATURAL /* as LATHE_CUBIC, and its curvature does not jump but at corners; it does not bend where it meets them */
} LatheCurve;
/* STATUS_SCENE for the reasons above, when points repeat, or when the curve crosses the axis. */
ATTR_NODISCARD Status solid_make_curved_lathe(const double (*profile)[2], uint32_t n, LatheCurve kind,
                                              const bool *corner, double tolerance, Solid **solid, Error *error);

#endif
