/* ball_side.c - balls and solids of revolution, in the half plane of the profile.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/ball_side.h"

#include <stdlib.h>

enum {
    LEAF = 8
}; /* pieces; they follow each other along the profile, so that neighbours in number are near each other */

/* ---- the tree ---- */

static HalfBox join(HalfBox a, HalfBox b)
{
    return (HalfBox){double_min(a.r0, b.r0), double_min(a.y0, b.y0), double_max(a.r1, b.r1), double_max(a.y1, b.y1)};
}

Status profile_tree_make(const Solid *solid, ProfileTree *tree, Error *error)
{
    *tree = (ProfileTree){0};
    if (solid->n_pieces <= LEAF) return STATUS_OK;
    uint32_t n_leaves = 1;
    while ((uint64_t)n_leaves * LEAF < solid->n_pieces) n_leaves *= 2;
    tree->nodes = malloc(2 * (size_t)n_leaves * sizeof *tree->nodes);
    if (!tree->nodes) return fail_memory(error, 2 * (size_t)n_leaves * sizeof *tree->nodes, "a profile");
    tree->n_leaves = n_leaves;
    for (uint32_t i = 0; i < 2 * n_leaves; i++) tree->nodes[i] = (HalfBox){HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        HalfBox *leaf = &tree->nodes[n_leaves + i / LEAF];
        *leaf = join(*leaf, piece_half_bounds(&solid->pieces[i]));
    }
    for (uint32_t i = n_leaves; i-- > 1;) tree->nodes[i] = join(tree->nodes[2 * i], tree->nodes[2 * i + 1]);
    return STATUS_OK;
}

void profile_tree_clear(ProfileTree *tree)
{
    free(tree->nodes);
    *tree = (ProfileTree){0};
}

/* ---- one piece ---- */

/* How far it is at least to a box; infinitely to an empty one. */
static double distance_to_box(const HalfBox *box, double r, double y)
{
    double across = double_max(double_max(box->r0 - r, r - box->r1), 0),
           along = double_max(double_max(box->y0 - y, y - box->y1), 0);
    return sqrt(across * across + along * along);
}

static double distance_to_segment(const Piece *piece, double r, double y)
{
    double dr = piece->r1 - piece->r0, dy = piece->y1 - piece->y0, length = dr * dr + dy * dy;
    double at = length > 0 ? ((r - piece->r0) * dr + (y - piece->y0) * dy) / length : 0;
    at = double_max(0, double_min(at, 1));
    double across = r - (piece->r0 + at * dr), along = y - (piece->y0 + at * dy);
    return sqrt(across * across + along * along);
}

static double distance_to_circle(double centre_r, double centre_y, double radius, double r, double y)
{
    return fabs(sqrt((r - centre_r) * (r - centre_r) + (y - centre_y) * (y - centre_y)) - radius);
}

static double arc_radius(const Piece *piece)
{
    double dr = piece->r0 - piece->centre_r, dy = piece->y0 - piece->centre_y;
    return sqrt(dr * dr + dy * dy);
}

/* A lower bound. */
static double distance_to_arc(const Piece *piece, double r, double y)
{
    HalfBox box = piece_half_bounds(piece);
    double circle = distance_to_circle(piece->centre_r, piece->centre_y, arc_radius(piece), r, y);
    return double_max(circle, distance_to_box(&box, r, y));
}

/* Of a torus the circle that reaches over the axis has two sides. */
static double distance_to_torus(const Piece *piece, double r, double y)
{
    return double_min(distance_to_circle(piece->r0, 0, piece->r1, r, y),
                      distance_to_circle(piece->r0, 0, piece->r1, -r, y));
}

double piece_distance(const Piece *piece, Vec3 p)
{
    double r = sqrt(p.x * p.x + p.z * p.z);
    switch (piece->kind) {
    case PIECE_SPHERE: return fabs(vec3_length(p) - piece->r0);
    case PIECE_BAND: return distance_to_segment(piece, r, p.y);
    case PIECE_TORUS: return distance_to_torus(piece, r, p.y);
    case PIECE_OUTER_ARC:
    case PIECE_INNER_ARC: return distance_to_arc(piece, r, p.y);
    case PIECE_PLANE: return fabs(p.y);
    case PIECE_RECT: break;
    }
    return vec3_length(vec3(double_max(fabs(p.x) - piece->r0, 0), p.y, double_max(fabs(p.z) - piece->r1, 0)));
}

/* Whether a step from (r, y) straight away from the axis goes through it; both are off its surface. */
static bool is_crossed_outwards(const Piece *piece, double r, double y)
{
    if ((piece->y0 > y) == (piece->y1 > y)) return false;
    if (piece->kind == PIECE_BAND)
        return piece->r0 + (y - piece->y0) / (piece->y1 - piece->y0) * (piece->r1 - piece->r0) > r;
    double radius = arc_radius(piece), dy = y - piece->centre_y;
    double reach = sqrt(double_max(radius * radius - dy * dy, 0));
    return piece->centre_r + (piece->kind == PIECE_OUTER_ARC ? reach : -reach) > r;
}

/* ---- the ball ---- */

static BallSide side_of(bool near, bool inside)
{
    return near ? BALL_NEAR : inside ? BALL_INSIDE : BALL_OUTSIDE;
}

static BallSide of_sphere(const Piece *piece, Vec3 centre, double radius)
{
    double distance = vec3_length(centre) - piece->r0;
    return side_of(!(fabs(distance) > radius), distance < 0);
}

static BallSide of_torus(const Piece *piece, double r, double y, double radius)
{
    double distance = distance_to_torus(piece, r, y);
    double dr = r - piece->r0;
    return side_of(!(distance > radius), dr * dr + y * y < piece->r1 * piece->r1);
}

/* Bands and arcs. */
typedef struct Asked {
    const Piece *pieces;
    double r, y, radius;
    bool near, inside;
} Asked;

static void ask_pieces(Asked *asked, uint32_t begin, uint32_t end)
{
    for (uint32_t i = begin; i < end && !asked->near; i++) {
        const Piece *piece = &asked->pieces[i];
        bool band = piece->kind == PIECE_BAND;
        if (!band && piece->kind != PIECE_OUTER_ARC && piece->kind != PIECE_INNER_ARC) {
            asked->near = true;
            return;
        }
        double distance = (band ? distance_to_segment : distance_to_arc)(piece, asked->r, asked->y);
        asked->near = !(distance > asked->radius);
        asked->inside = asked->inside != is_crossed_outwards(piece, asked->r, asked->y);
    }
}

static void ask_node(Asked *asked, const Solid *solid, const ProfileTree *tree, uint32_t node)
{
    const HalfBox *box = &tree->nodes[node];
    bool crossed = box->y0 <= asked->y && asked->y <= box->y1 && box->r1 >= asked->r;
    if (asked->near || (!crossed && distance_to_box(box, asked->r, asked->y) > asked->radius)) return;
    if (node < tree->n_leaves) {
        ask_node(asked, solid, tree, 2 * node);
        ask_node(asked, solid, tree, 2 * node + 1);
        return;
    }
    uint32_t begin = (node - tree->n_leaves) * LEAF, left = solid->n_pieces - begin;
    ask_pieces(asked, begin, begin + (left < LEAF ? left : LEAF));
}

BallSide solid_ball_side(const Solid *solid, const ProfileTree *tree, Vec3 centre, double radius)
{
    double r = sqrt(centre.x * centre.x + centre.z * centre.z);
    if (solid->n_pieces == 1) {
        const Piece *piece = &solid->pieces[0];
        if (piece->kind == PIECE_SPHERE) return of_sphere(piece, centre, radius);
        if (piece->kind == PIECE_TORUS) return of_torus(piece, r, centre.y, radius);
        if (piece->kind == PIECE_PLANE) return side_of(!(fabs(centre.y) > radius), centre.y < 0);
    }
    Asked asked = {.pieces = solid->pieces, .r = r, .y = centre.y, .radius = radius};
    if (tree->n_leaves)
        ask_node(&asked, solid, tree, 1);
    else
        ask_pieces(&asked, 0, solid->n_pieces);
    return side_of(asked.near, asked.inside);
}
