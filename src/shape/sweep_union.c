/* sweep_union.c - round sweeps that bend more than their radius or run into themselves: the surface of the union of their
 * pieces, as of any function of space.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "shape/box_cells.h"
#include "shape/implicit.h"
#include "shape/sweep_parts.h"

/* Of the table of which pieces are where: cells along an axis, in all; and in how many of them a block of the grid is looked up. */
enum { MAX_CELLS = 128, CELLS_PER_PIECE = 8, MOST_LOOKED_UP = 512 };

typedef enum EndKind {
    END_SHARED, /* the next piece goes on there */
    END_FLAT,
    END_ROUND /* with half a ball */
} EndKind;

/* A plane across the path, which the piece is before or behind. */
typedef struct PieceEnd {
    Vec3 at, inward; /* inward: of length 1 */
    double radius;
    EndKind kind;
} PieceEnd;

/* Part of a cone about the line between two stations. */
typedef struct UnionPiece {
    PieceEnd ends[2];
    /* radii of balls at the ends, which touch the sides of what meets there from within; below 0: the next piece has it */
    double balls[2];
    bool near_flat[2];    /* a flat end of the whole path, the first or the last, is so near that it cuts these balls */
    Vec3 along;           /* of length 1 */
    double slope, cosine; /* change of the radius per length; of the angle between side and axis */
    Box3 box;
} UnionPiece;

typedef struct SweepUnion {
    UnionPiece *pieces;
    size_t n_pieces;
    PieceEnd flat[2]; /* the ends of the path, where these are flat */
    bool is_smooth;   /* its normals turn from station to station, as the path does */
    double margin; /* by so much the pieces' boxes are larger than they are: farther outside, values are its negative */
    BoxCells cells; /* of these boxes */
} SweepUnion;

/* ---- one piece ---- */

/* A depth, below 0 outside, and where it falls fastest. */
typedef struct Depth {
    double value;
    Vec3 away;
} Depth;

static void cut_by(Depth *depth, double within, Vec3 inward)
{
    if (within < depth->value) *depth = (Depth){within, vec3_scale(inward, -1)};
}

/* The part of a piece between its ends' planes; false: the place is beyond one of them, and belongs to others. */
static bool depth_of_cone(const UnionPiece *piece, bool is_smooth, Vec3 p, Depth *depth)
{
    const PieceEnd *a = &piece->ends[0], *b = &piece->ends[1];
    Vec3 from_a = vec3_sub(p, a->at), from_b = vec3_sub(p, b->at), axis = piece->along;
    double within[2] = {vec3_dot(from_a, a->inward), vec3_dot(from_b, b->inward)};
    for (int i = 0; i < 2; i++)
        if (within[i] < 0 && piece->ends[i].kind != END_FLAT) return false;
    double x = vec3_dot(from_a, axis);
    Vec3 way = vec3_along(from_a, -x, axis);
    double distance = vec3_length(way), t = within[0] / fmax(within[0] + within[1], 1e-300);
    Vec3 out = vec3_scale(way, 1 / fmax(distance, 1e-300));
    if (is_smooth) { /* as the path turns: the planes' normals are its tangents */
        t = fmin(fmax(t, 0), 1);
        axis = vec3_normalize(vec3_along(vec3_scale(a->inward, 1 - t), -t, b->inward));
    }
    depth->value = piece->cosine * (a->radius + piece->slope * x - distance);
    depth->away = vec3_along(out, -vec3_dot(out, axis) - piece->slope, axis);
    for (int i = 0; i < 2; i++)
        if (piece->ends[i].kind == END_FLAT) cut_by(depth, within[i], piece->ends[i].inward);
    return true;
}

/* How deep a place is within a piece, if that is deeper than it is known to be. Where a path bends more than its radius, planes cross each
 * other within the tube, and what is beyond belongs to none of its pieces: balls hold it. */
static void look_deeper(const SweepUnion *all, const UnionPiece *piece, Vec3 p, Depth *deepest)
{
    Depth depth;
    if (depth_of_cone(piece, all->is_smooth, p, &depth) && depth.value > deepest->value) *deepest = depth;
    for (int i = 0; i < 2; i++) {
        Vec3 way = vec3_sub(p, piece->ends[i].at);
        double squared = vec3_dot(way, way), reach = piece->balls[i] - deepest->value;
        if (!(reach > 0) || squared >= reach * reach) continue;
        double distance = sqrt(squared);
        depth = (Depth){piece->balls[i] - distance, vec3_scale(way, 1 / fmax(distance, 1e-300))};
        for (int k = 0; k < 2; k++)
            if (piece->near_flat[k])
                cut_by(&depth, vec3_dot(vec3_sub(p, all->flat[k].at), all->flat[k].inward), all->flat[k].inward);
        if (depth.value > deepest->value) *deepest = depth;
    }
}

/* ---- all of them ---- */

static Depth depth_at(const SweepUnion *all, Vec3 p)
{
    uint32_t n;
    const uint32_t *items = box_cells_at(&all->cells, p, &n);
    Depth deepest = {.value = -all->margin};
    for (uint32_t i = 0; i < n; i++)
        if (box3_holds_point(all->pieces[items[i]].box, p)) look_deeper(all, &all->pieces[items[i]], p, &deepest);
    return deepest;
}

static bool union_value(void *context, Vec3 p, double *value)
{
    *value = depth_at(context, p).value;
    return true;
}

static bool union_gradient(void *context, Vec3 p, Vec3 *gradient)
{
    *gradient = vec3_scale(depth_at(context, p).away, -1);
    return true;
}

static bool union_layer(void *context, const Lattice *lattice, uint32_t k, const uint8_t *wanted, double *values)
{
    size_t at = 0;
    for (uint32_t j = 0; j < lattice->n[1]; j++)
        for (uint32_t i = 0; i < lattice->n[0]; i++, at++)
            if (!wanted || wanted[at]) (void)union_value(context, lattice_point(lattice, i, j, k), &values[at]);
    return true;
}

/* At least the depth in a piece, also far outside: what is beyond its ends' planes counts as if it went on. */
static double most_depth(const UnionPiece *piece, Vec3 p)
{
    Vec3 from_a = vec3_sub(p, piece->ends[0].at), from_b = vec3_sub(p, piece->ends[1].at);
    double x = vec3_dot(from_a, piece->along), distance = vec3_length(vec3_along(from_a, -x, piece->along));
    double cone = piece->cosine * (piece->ends[0].radius + piece->slope * x - distance);
    return fmax(cone, fmax(piece->balls[0] - vec3_length(from_a), piece->balls[1] - vec3_length(from_b)));
}

/* Depths change by no more than a place does: what one says of the middle holds for all that is as near to it as it is deep. Only pieces
 * whose boxes reach into this one have any depth in it. */
static bool union_bounds(void *context, Box3 box, double *low, double *high)
{
    const SweepUnion *all = context;
    Vec3 middle = box3_centre(box);
    double reach = 0.5 * vec3_length(vec3_sub(box.max, box.min));
    BoxCellsRange range = box_cells_range(&all->cells, box);
    *low = depth_at(all, middle).value - reach;
    *high = -all->margin;
    if (range.n > MOST_LOOKED_UP) *high = HUGE_VAL;
    const uint32_t *items;
    for (uint32_t n; *high < HUGE_VAL && box_cells_next(&all->cells, &range, &items, &n);)
        for (uint32_t i = 0; i < n; i++) {
            const UnionPiece *piece = &all->pieces[items[i]];
            if (box3_meets(piece->box, box)) *high = fmax(*high, most_depth(piece, middle) + reach);
        }
    return true;
}

/* ---- making ---- */

static EndKind kind_of_end(const SweepShape *shape, const Station *station, bool is_end)
{
    if (station->turns_back) return END_ROUND;
    if (!is_end || shape->closed) return END_SHARED;
    return shape->round_ends ? END_ROUND : END_FLAT;
}

/* The circle of a station where it meets a piece, in its mitre, and what is so far from it: half a ball is within a cube. */
static Box3 add_circle(Box3 box, const PieceEnd *end, Vec3 along, double margin)
{
    double lean = vec3_dot(end->inward, along), reach = end->radius / fmax(fabs(lean), 0.1) + margin;
    Vec3 corner = vec3(reach, reach, reach);
    return box3_add_point(box3_add_point(box, vec3_sub(end->at, corner)), vec3_add(end->at, corner));
}

static double volume_of(Box3 box)
{
    return (box.max.x - box.min.x) * (box.max.y - box.min.y) * (box.max.z - box.min.z);
}

/* Of the change of the radius before and behind a station, the larger part: of the angle between side and axis. */
static double cosine_at(const Station *stations, size_t n, bool closed, size_t i)
{
    double cosine = 1;
    for (size_t k = 0; k < 2; k++) {
        size_t from = i + k - 1; /* the piece before it, and the one behind it */
        if (i + k == 0 || from + 1 >= n) {
            if (!closed) continue;
            from = i + k == 0 ? n - 2 : 0;
        }
        Vec3 step = vec3_sub(stations[from + 1].at, stations[from].at);
        cosine = fmin(cosine, 1 / hypot(1, (stations[from + 1].scale - stations[from].scale) / vec3_length(step)));
    }
    return cosine;
}

static void set_piece(const SweepUnion *all, const SweepShape *shape, const Station *stations, size_t i,
                      UnionPiece *piece)
{
    const Station *a = &stations[i], *b = a + 1, *end = &stations[all->n_pieces];
    Vec3 step = vec3_sub(b->at, a->at);
    double length = vec3_length(step);
    piece->along = vec3_scale(step, 1 / length);
    piece->slope = (b->scale - a->scale) / length;
    piece->cosine = 1 / hypot(1, piece->slope);
    Vec3 begin = a->turns_back ? piece->along : a->tangent, last = b->turns_back ? piece->along : b->tangent;
    piece->ends[0] = (PieceEnd){a->at, begin, a->scale, kind_of_end(shape, a, i == 0)};
    piece->ends[1] = (PieceEnd){b->at, vec3_scale(last, -1), b->scale, kind_of_end(shape, b, i + 1 == all->n_pieces)};
    for (size_t k = 0; k < 2; k++) {
        bool is_round = piece->ends[k].kind == END_ROUND, next_has_it = k == 1 && i + 1 < all->n_pieces;
        double cosine = is_round ? 1 : cosine_at(stations, all->n_pieces + 1, shape->closed, i + k);
        piece->balls[k] = next_has_it ? -HUGE_VAL : a[k].scale * cosine;
    }
    bool flat = !shape->closed && !shape->round_ends;
    piece->near_flat[0] = flat && a->along < 2 * fmax(a->scale, b->scale);
    piece->near_flat[1] = flat && end->along - b->along < 2 * fmax(a->scale, b->scale);
    piece->box = add_circle(box3_empty(), &piece->ends[0], piece->along, all->margin);
    piece->box = add_circle(piece->box, &piece->ends[1], piece->along, all->margin);
}

static Status make_union(SweepUnion *all, const SweepShape *shape, const Station *stations, Pool *pool, Mesh **mesh,
                         double *reached, Error *error)
{
    /* of the grid: some ten seconds, and layers of some hundred megabytes */
    const double most_asked = 2e7, fewest_points = 1e6, most_points = 1e9;
    double largest = 0, smallest = HUGE_VAL;
    for (size_t i = 0; i <= all->n_pieces; i++) {
        largest = fmax(largest, stations[i].scale);
        if (stations[i].scale > 0) smallest = fmin(smallest, stations[i].scale);
    }
    double step = fmax(smallest, largest / 8) / 2;
    all->margin = largest / 16;
    Box3 bounds = box3_empty();
    double filled = 0; /* by boxes, in which values are asked for */
    for (size_t i = 0; i < all->n_pieces; i++) {
        UnionPiece *piece = &all->pieces[i];
        set_piece(all, shape, stations, i, piece);
        bounds = box3_union(bounds, piece->box);
        filled += volume_of(piece->box);
    }
    double pieces = filled / volume_of(bounds); /* at a place, on the mean */
    TRY(box_cells_make(&all->cells, bounds, CELLS_PER_PIECE, MAX_CELLS, &all->pieces->box, sizeof *all->pieces,
                       all->n_pieces, "the sweep", error));
    const ImplicitField field = {all, union_layer, union_value, union_value, union_gradient, union_bounds};
    const ImplicitOptions options = {
        .bounds = bounds,
        .tolerance = shape->tolerance,
        .cells = (uint32_t)fmin(vec3_max_abs(vec3_sub(bounds.max, bounds.min)) / step, 1000),
        .max_points = (uint64_t)fmin(fmax(most_asked / pieces, fewest_points), most_points),
        .pool = pool};
    ImplicitFound found;
    TRY(mesh_make_implicit(&field, &options, "the sweep", mesh, &found, error));
    *reached = found.reached;
    return STATUS_OK;
}

Status sweep_make_union(const SweepShape *shape, const Station *stations, size_t n_stations, Pool *pool, Mesh **mesh,
                        double *reached, Error *error)
{
    SweepUnion all = {.n_pieces = n_stations - 1, .is_smooth = shape->curve != SWEEP_LINEAR};
    const Station *last = &stations[all.n_pieces];
    all.flat[0] = (PieceEnd){stations->at, stations->tangent, stations->scale, END_FLAT};
    all.flat[1] = (PieceEnd){last->at, vec3_scale(last->tangent, -1), last->scale, END_FLAT};
    all.pieces = calloc(all.n_pieces, sizeof *all.pieces);
    if (!all.pieces) return fail_memory(error, all.n_pieces * sizeof *all.pieces, "a sweep");
    Status status = make_union(&all, shape, stations, pool, mesh, reached, error);
    box_cells_clear(&all.cells);
    free(all.pieces);
    return status;
}
