/* sweep_union.c - round sweeps that bend more than their radius or run into themselves: the surface of the union of their
 * pieces, as of any function of space.
 * SPDX-License-Identifier: Apache-2.0 */
#include <math.h>
#include <stdlib.h>

#include "shape/box_cells.h"
#include "shape/implicit.h"
#include "shape/sweep_parts.h"

enum { MAX_CELLS = 128, CELLS_PER_PIECE = 8 }; /* of the table of which pieces are where: along an axis, in all */

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
    Vec3 along;           /* of length 1 */
    double slope, cosine; /* change of the radius per length; of the angle between side and axis */
    Box3 box;
} UnionPiece;

typedef struct SweepUnion {
    UnionPiece *pieces;
    size_t n_pieces;
    bool is_smooth; /* its normals turn from station to station, as the path does */
    double margin; /* by so much the pieces' boxes are larger than they are: farther outside, values are its negative */
    BoxCells cells; /* of these boxes */
} SweepUnion;

/* ---- one piece ---- */

/* How deep a place is within a piece, below 0 outside; false: it belongs to others. away: where the value falls fastest; may be NULL. */
static bool piece_value(const UnionPiece *piece, bool is_smooth, Vec3 p, double *value, Vec3 *away)
{
    const PieceEnd *a = &piece->ends[0], *b = &piece->ends[1];
    Vec3 from_a = vec3_sub(p, a->at), from_b = vec3_sub(p, b->at);
    const double within[2] = {vec3_dot(from_a, a->inward), vec3_dot(from_b, b->inward)};
    for (int i = 0; i < 2; i++) {
        const PieceEnd *end = &piece->ends[i];
        if (within[i] >= 0 || end->kind == END_FLAT) continue;
        if (end->kind == END_SHARED) return false;
        Vec3 way = i ? from_b : from_a;
        double distance = vec3_length(way);
        *value = end->radius - distance;
        if (away) *away = vec3_scale(way, 1 / fmax(distance, 1e-300));
        return true;
    }
    double x = vec3_dot(from_a, piece->along);
    Vec3 way = vec3_along(from_a, -x, piece->along);
    double distance = vec3_length(way);
    *value = piece->cosine * (a->radius + piece->slope * x - distance);
    if (away) {
        Vec3 axis = piece->along, out = vec3_scale(way, 1 / fmax(distance, 1e-300));
        double t = fmin(fmax(within[0] / fmax(within[0] + within[1], 1e-300), 0), 1);
        if (is_smooth) /* as the path turns: the planes' normals are its tangents */
            axis = vec3_normalize(vec3_along(vec3_scale(a->inward, 1 - t), -t, b->inward));
        *away = vec3_along(out, -vec3_dot(out, axis) - piece->slope, axis);
    }
    for (int i = 0; i < 2; i++) {
        if (piece->ends[i].kind != END_FLAT || within[i] >= *value) continue;
        *value = within[i];
        if (away) *away = vec3_scale(piece->ends[i].inward, -1);
    }
    return true;
}

/* ---- all of them ---- */

/* The deepest piece at a place; NULL: none is near. */
static const UnionPiece *deepest_at(const SweepUnion *all, Vec3 p, double *value)
{
    uint32_t n;
    const uint32_t *items = box_cells_at(&all->cells, p, &n);
    const UnionPiece *deepest = NULL;
    *value = -all->margin;
    for (uint32_t i = 0; i < n; i++) {
        double own;
        if (!piece_value(&all->pieces[items[i]], all->is_smooth, p, &own, NULL) || own <= *value) continue;
        *value = own;
        deepest = &all->pieces[items[i]];
    }
    return deepest;
}

static bool union_value(void *context, Vec3 p, double *value)
{
    (void)deepest_at(context, p, value);
    return true;
}

static bool union_gradient(void *context, Vec3 p, Vec3 *gradient)
{
    const SweepUnion *all = context;
    double value;
    const UnionPiece *deepest = deepest_at(all, p, &value);
    *gradient = vec3(0, 0, 0);
    if (deepest && piece_value(deepest, all->is_smooth, p, &value, gradient)) *gradient = vec3_scale(*gradient, -1);
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

/* Of what is far from all pieces it is known that it is outside. */
static bool union_bounds(void *context, Box3 box, double *low, double *high)
{
    const SweepUnion *all = context;
    bool is_near = box_cells_reach(&all->cells, box);
    *low = is_near ? -HUGE_VAL : -all->margin;
    *high = is_near ? HUGE_VAL : -all->margin;
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

static void set_piece(const SweepUnion *all, const SweepShape *shape, const Station *a, const Station *b, bool first,
                      bool last, UnionPiece *piece)
{
    Vec3 step = vec3_sub(b->at, a->at);
    double length = vec3_length(step);
    piece->along = vec3_scale(step, 1 / length);
    piece->slope = (b->scale - a->scale) / length;
    piece->cosine = 1 / hypot(1, piece->slope);
    Vec3 begin = a->turns_back ? piece->along : a->tangent, end = b->turns_back ? piece->along : b->tangent;
    piece->ends[0] = (PieceEnd){a->at, begin, a->scale, kind_of_end(shape, a, first)};
    piece->ends[1] = (PieceEnd){b->at, vec3_scale(end, -1), b->scale, kind_of_end(shape, b, last)};
    piece->box = add_circle(box3_empty(), &piece->ends[0], piece->along, all->margin);
    piece->box = add_circle(piece->box, &piece->ends[1], piece->along, all->margin);
}

static Status make_union(SweepUnion *all, const SweepShape *shape, const Station *stations, Pool *pool, Mesh **mesh,
                         double *reached, Error *error)
{
    const double most_asked = 5e7,
                 most_points = 1e9; /* of the grid: some ten seconds, and layers of some hundred megabytes */
    double largest = 0, smallest = HUGE_VAL;
    for (size_t i = 0; i <= all->n_pieces; i++) {
        largest = fmax(largest, stations[i].scale);
        if (stations[i].scale > 0) smallest = fmin(smallest, stations[i].scale);
    }
    double step = fmax(smallest, largest / 8) / 2;
    all->margin = largest / 16;
    Box3 bounds = box3_empty();
    double filled = 0; /* volume that values are asked for */
    for (size_t i = 0; i < all->n_pieces; i++) {
        UnionPiece *piece = &all->pieces[i];
        set_piece(all, shape, &stations[i], &stations[i + 1], i == 0, i + 1 == all->n_pieces, piece);
        bounds = box3_union(bounds, piece->box);
        filled += volume_of(piece->box);
    }
    double part = fmin(filled / volume_of(bounds), 1);
    TRY(box_cells_make(&all->cells, bounds, CELLS_PER_PIECE, MAX_CELLS, &all->pieces->box, sizeof *all->pieces,
                       all->n_pieces, "the sweep", error));
    const ImplicitField field = {all, union_layer, union_value, union_value, union_gradient, union_bounds};
    const ImplicitOptions options = {.bounds = bounds,
                                     .tolerance = shape->tolerance,
                                     .cells =
                                         (uint32_t)fmin(vec3_max_abs(vec3_sub(bounds.max, bounds.min)) / step, 1000),
                                     .max_points = (uint64_t)fmin(most_asked / part, most_points),
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
    all.pieces = calloc(all.n_pieces, sizeof *all.pieces);
    if (!all.pieces) return fail_memory(error, all.n_pieces * sizeof *all.pieces, "a sweep");
    Status status = make_union(&all, shape, stations, pool, mesh, reached, error);
    box_cells_clear(&all.cells);
    free(all.pieces);
    return status;
}
