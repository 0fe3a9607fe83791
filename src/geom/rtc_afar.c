/* rtc_afar.c - boxes around pieces so wide, and rays shown to Embree from so near, that it passes by none.
 *
 * Embree's robust search misses no box that the ray which it is given meets. But that one has a start in float: its line runs
 * beside the exact one, by no more than what the start was rounded and nudged (rtc_leave). So the boxes are wider than the
 * pieces by a margin that is no less than that. A ray that starts kilometres away is centimetres beside; yet boxes that are as
 * much too wide, around all parts of a glass, make all rays near it slow (19 times on a floor of 20 km). So the margin goes
 * with the coordinates of the piece itself, and rays from afar are shown once more, from nearer by.
 *
 * Lengths of points are their largest coordinates here. A piece as far away from the origin as b has the margin
 *     m(b) = 2^-19 max(b, L),
 * L being RtcScene.piece_reach, and no less than 2^-12 of the reach R of the scene. A ray from o meets the piece at p: |p| <= b.
 * Embree's line is displaced, along each axis, by no more than d:
 *   - from nearby, |o| <= 2 L: the start is nudged by 2^-22 |o|, moved back by 2^-12 of |o| or of the triangles' coordinates, which
 *     are no larger than R, and then rounded: d <= 1.25 x 2^-22 |o| + 2^-36 R <= (0.31 + 0.03) 2^-19 L < m.
 *   - from farther away: by the same d < m where |p| >= |o| / 2.
 *   - For the rest, the ray enters the cube of all points no larger than h = |o| / 2, and Embree is shown it from there on, with
 *     no nudge: d <= 2^-24 h, which is half of m where h <= 16 max(|p|, L). While that is not so for all p, so again at the cube
 *     of h / 16.
 *   - from |o| > 2 R: the start is where everything is in front of it, no farther than 2.7 R from the origin if the ray comes to
 *     anything; with no nudge d <= 2.7 x 2^-24 R, and that is less than m where |p| >= R / 8. The first cube is that one's.
 * A thirtieth of m is left for the rounding of the boxes themselves. What moves has the margin of R: Embree interpolates its
 * boxes together with others'.
 *
 * Scenes in which the margin of R is small beside the pieces, all in a few metres, have L = R, and their rays are shown once.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_query.h"

/* The margin, of L. */
#define MARGIN 0x1p-19
/* Boxes of pieces of a usual size, which is the sum of three sides, may be wider by so much of it on each side. */
#define WIDER 0x1p-7
/* The least L, of the scene's reach. */
#define LEAST_REACH 0x1p-12
/* From the size of one cube to the next. */
#define NEARER 16

double rtc_piece_reach(double reach, double size)
{
    return double_min(reach, double_max(LEAST_REACH * reach, WIDER / MARGIN * size));
}

static double margin_of(const RtcPieceSet *set, Box3 box)
{
    const RtcScene *scene = set->scene;
    double own = double_max(vec3_max_abs(box.min), vec3_max_abs(box.max));
    return MARGIN * (set->moving ? scene->reach : double_max(own, scene->piece_reach));
}

/* Around an eighth: the corners of its profile are extreme, as sine and cosine are monotonic in between. */
static Box3 sector_bounds(const Piece *piece, uint32_t sector)
{
    static const double half = 0.70710678118654757;
    static const double ends[RTC_SECTORS + 1][2] = {{1, 0},         {half, half}, {0, 1},        {-half, half}, {-1, 0},
                                                    {-half, -half}, {0, -1},      {half, -half}, {1, 0}};
    /* rtc_sector counts by quadrants and then by the larger coordinate: to the order of angles */
    static const uint32_t by_angle[RTC_SECTORS] = {0, 1, 3, 2, 4, 5, 7, 6};
    uint32_t k = by_angle[sector];
    HalfBox half_box = piece_half_bounds(piece);
    Box3 box = box3_empty();
    for (uint32_t end = k; end <= k + 1; end++) {
        box = box3_add_point(box, vec3(half_box.r0 * ends[end][0], half_box.y0, half_box.r0 * ends[end][1]));
        box = box3_add_point(box, vec3(half_box.r1 * ends[end][0], half_box.y1, half_box.r1 * ends[end][1]));
    }
    return box;
}

/* Around a primitive of the user geometry, in the frame of its object. */
static Box3 local_bounds(const RtcPieceSet *set, uint32_t primitive, uint32_t *object)
{
    if (primitive < set->n_balls) {
        *object = set->balls[primitive];
        return piece_bounds(&set->scene->objects[*object].solid->pieces[0]);
    }
    RtcPart part = rtc_part(set, primitive);
    const RtcPiece *which = &set->pieces[part.number];
    *object = which->object;
    return part.sector == RTC_ALL_SECTORS ? piece_bounds(which->shape) : sector_bounds(which->shape, part.sector);
}

void rtc_piece_bounds(const struct RTCBoundsFunctionArguments *arguments)
{
    const RtcPieceSet *set = arguments->geometryUserPtr;
    const RtcScene *scene = set->scene;
    uint32_t number;
    Box3 local = local_bounds(set, arguments->primID, &number);
    const RtcPlaced *object = &scene->objects[number];
    Affine to_world = object->moves ? object->keys[arguments->timeStep] : rtc_first_to_world(object);
    Box3 box = affine_box(&to_world, local);
    double margin = margin_of(set, box);
    arguments->bounds_o->lower_x = (float)(box.min.x - margin);
    arguments->bounds_o->lower_y = (float)(box.min.y - margin);
    arguments->bounds_o->lower_z = (float)(box.min.z - margin);
    arguments->bounds_o->upper_x = (float)(box.max.x + margin);
    arguments->bounds_o->upper_y = (float)(box.max.y + margin);
    arguments->bounds_o->upper_z = (float)(box.max.z + margin);
}

static const Vec3 no_nudge;

void rtc_start_from_afar(Query *query)
{
    double far = vec3_max_abs(query->origin), reach = query->scene->reach;
    query->unseen = far / 2;
    if (far <= 2 * reach) return;
    query->back = 2 * reach - vec3_length(query->origin);
    query->nudge = &no_nudge;
    query->unseen = reach / 8 > query->scene->piece_reach ? reach / 8 : 0;
}

/* Where the ray comes into a cube about the origin; INFINITY: nowhere. */
static double comes_within(const Query *query, double half)
{
    const double from[3] = {query->origin.x, query->origin.y, query->origin.z};
    const double along[3] = {query->direction.x, query->direction.y, query->direction.z};
    double in = 0, out = (double)INFINITY;
    for (int axis = 0; axis < 3; axis++) { /* where `along` is 0: without end, or not a number at the very side */
        double a = (-half - from[axis]) / along[axis], b = (half - from[axis]) / along[axis];
        in = fmax(in, fmin(a, b));
        out = fmin(out, fmax(a, b));
    }
    return in <= out ? in : (double)INFINITY;
}

bool rtc_next_start(Query *query, double *end)
{
    double least = query->scene->piece_reach;
    while (query->unseen > least) {
        double start = comes_within(query, query->unseen);
        if (!(start < double_min(query->ray->t_max, query->reach))) return false;
        query->back = -start;
        query->nudge = &no_nudge;
        query->unseen /= NEARER;
        *end = query->unseen > least ? comes_within(query, query->unseen) : HUGE_VAL;
        if (*end > query->t_min) return true;
    }
    return false;
}
