/* relation_apart.c - pairs of hulls that keep away from each other's surfaces: decided at once, without lines.
 *
 * Of a million bubbles in a drink nearly all are so far from its surface that a ball around each lies wholly inside of
 * it; and of objects whose bounds come near each other many are apart when their own boxes are turned as they are.
 * SPDX-License-Identifier: Apache-2.0 */
#include <stdlib.h>

#include "base/array.h"
#include "scene/relation_parts.h"

enum {
    BLOCK = 256,             /* pairs of a task */
    TRIANGLES_OF_A_PAIR = 50 /* at most, for a tree of them */
};

/* ---- what is remembered of shapes ---- */

/* A shape that is one ball, of which there may be as many as objects, needs nothing. */
static const Piece *ball_of(const SceneShape *shape)
{
    const Solid *solid = shape->solid;
    return !shape->mesh && solid && solid->n_pieces == 1 && solid->pieces[0].kind == PIECE_SPHERE ? solid->pieces
                                                                                                  : NULL;
}

/* Around a point, of a shape with a box. */
static double reach_from(const SceneShape *shape, Vec3 centre, Box3 box)
{
    const Mesh *mesh = shape->mesh;
    double largest = 0;
    if (!mesh || shape->solid || shape->mesh_end) return diagonal(box) / 2;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        largest = double_max(largest, vec3_length(vec3_sub(vec3_from_f(mesh->positions[i]), centre)));
    return largest;
}

static NearShape *near_shape(const Finder *f, uint32_t hull)
{
    uint32_t shape = f->compiled->scene->objects[f->compiled->object_of_hull[hull]].shape;
    return shape != SCENE_NONE && f->near_shape_of[shape] ? &f->near_shapes[f->near_shape_of[shape] - 1] : NULL;
}

static Status remember_shape(Finder *f, uint32_t hull, Error *error)
{
    uint32_t shape = f->compiled->scene->objects[f->compiled->object_of_hull[hull]].shape;
    const SceneShape *from = shape == SCENE_NONE ? NULL : &f->compiled->scene->shapes[shape];
    if (!from || ball_of(from) || f->near_shape_of[shape]) return STATUS_OK;
    if (!ARRAY_ROOM(f->near_shapes, f->near_shapes_capacity, f->n_near_shapes))
        return fail_memory(error, f->n_near_shapes * sizeof *f->near_shapes, "how the hulls lie");
    NearShape *made = &f->near_shapes[f->n_near_shapes];
    *made = (NearShape){.box = scene_shape_bounds(from)};
    made->radius = reach_from(from, box3_centre(made->box), made->box);
    f->near_shape_of[shape] = ++f->n_near_shapes;
    return from->solid ? profile_tree_make(from->solid, &made->profile, error) : STATUS_OK;
}

Status relation_remember_shapes(Finder *f, const Candidate *candidate, Error *error)
{
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    TRY(remember_shape(f, own, error));
    TRY(remember_shape(f, other, error));
    NearShape *asked = near_shape(f, other);
    if (asked) asked->n_asked++;
    return STATUS_OK;
}

/* A tree of triangles pays where there is a pair for every few of them. */
static Status make_trees(Finder *f, Error *error)
{
    const Scene *scene = f->compiled->scene;
    for (size_t i = f->n_sifted; i < f->n_candidates; i++) {
        uint32_t own, other;
        relation_by_size(f, &f->candidates[i], &own, &other);
        NearShape *near = near_shape(f, other);
        const Mesh *mesh = near ? scene->shapes[scene->objects[f->compiled->object_of_hull[other]].shape].mesh : NULL;
        if (!mesh || near->triangles.n || near->n_asked * TRIANGLES_OF_A_PAIR < mesh->n_triangles) continue;
        TRY(mesh_box_tree(mesh, &near->triangles, error));
    }
    return STATUS_OK;
}

void relation_forget_shapes(Finder *f)
{
    for (uint32_t i = 0; i < f->n_near_shapes; i++) {
        profile_tree_clear(&f->near_shapes[i].profile);
        box_tree_clear(&f->near_shapes[i].triangles);
    }
    free(f->near_shapes);
    free(f->near_shape_of);
}

/* ---- hulls that stand still ---- */

/* Of a hull that has a shape of its own and stays as it is. */
typedef struct Still {
    const SceneShape *shape;
    const Affine *to_world;
    const NearShape *near; /* NULL: a ball */
    Box3 box;              /* in its own frame, */
    double radius;         /* and that of a ball about its middle */
} Still;

static bool stands_still(const Finder *f, uint32_t hull, Still *still)
{
    const Scene *scene = f->compiled->scene;
    const SceneObject *object = &scene->objects[f->compiled->object_of_hull[hull]];
    if (object->shape == SCENE_NONE || object->motion != SCENE_NONE || scene->shapes[object->shape].mesh_end)
        return false;
    *still =
        (Still){.shape = &scene->shapes[object->shape], .to_world = &object->to_world, .near = near_shape(f, hull)};
    const Piece *ball = ball_of(still->shape);
    if (ball) {
        Vec3 reach = vec3(ball->r0, ball->r0, ball->r0);
        still->box = (Box3){vec3_scale(reach, -1), reach};
        still->radius = ball->r0;
    } else {
        still->box = still->near->box;
        still->radius = still->near->radius;
    }
    return true;
}

static Ball ball_around(const Finder *f, uint32_t hull)
{
    Box3 bounds = f->compiled->hull_bounds[hull];
    Ball ball = {box3_centre(bounds), diagonal(bounds) / 2};
    Still still;
    if (f->compiled->unbounded[hull] || !stands_still(f, hull, &still)) return ball;
    double radius = still.radius * affine_largest_stretch(still.to_world);
    return radius < ball.radius ? (Ball){affine_point(still.to_world, box3_centre(still.box)), radius} : ball;
}

Vec3 relation_shape_size(const Finder *f, uint32_t hull)
{
    Still still;
    return stands_still(f, hull, &still) ? vec3_sub(still.box.max, still.box.min) : vec3(0, 0, 0);
}

/* ---- two ways to know ---- */

/* Within this distance the two may touch, or leave a thin gap. */
static double reach_of_gaps(const Finder *f, uint32_t a, uint32_t b)
{
    Box3 box_a = f->compiled->hull_bounds[a], box_b = f->compiled->hull_bounds[b];
    return 2 * (double_min(margin_of(box_a), margin_of(box_b)) + double_max(box_rounding(box_a), box_rounding(box_b)));
}

static BallSide side_of(const Finder *f, uint32_t own, uint32_t other)
{
    static const ProfileTree no_tree = {0};
    Still still;
    Affine inverse;
    if (!(f->compiled->hulls[own].volume > 0)) return BALL_NEAR; /* a combination of which nothing is left */
    if (f->compiled->unbounded[own] || !stands_still(f, other, &still) || !affine_invert(still.to_world, &inverse))
        return BALL_NEAR;
    Ball ball = ball_around(f, own);
    Vec3 centre = affine_point(&inverse, ball.centre);
    double radius = (ball.radius + reach_of_gaps(f, own, other)) * affine_largest_stretch(&inverse);
    const SceneShape *shape = still.shape;
    if (shape->solid && !shape->mesh)
        return solid_ball_side(shape->solid, still.near ? &still.near->profile : &no_tree, centre, radius);
    return shape->mesh && !shape->solid && still.near->triangles.n
               ? mesh_ball_side(shape->mesh, &still.near->triangles, centre, radius)
               : BALL_NEAR;
}

/* A box turned and skewed with its object: its middle, and from there to the middles of three faces. */
typedef struct Turned {
    Vec3 centre, half[3];
} Turned;

static Turned turned_box(const Still *still)
{
    Vec3 size = vec3_scale(vec3_sub(still->box.max, still->box.min), 0.5);
    return (Turned){affine_point(still->to_world, box3_centre(still->box)),
                    {affine_vector(still->to_world, vec3(size.x, 0, 0)),
                     affine_vector(still->to_world, vec3(0, size.y, 0)),
                     affine_vector(still->to_world, vec3(0, 0, size.z))}};
}

static double reach_along(const Turned *box, Vec3 axis)
{
    double reach = 0;
    for (int i = 0; i < 3; i++) reach += fabs(vec3_dot(box->half[i], axis));
    return reach;
}

static bool are_apart_along(const Turned *a, const Turned *b, Vec3 axis, double margin)
{
    double between = fabs(vec3_dot(vec3_sub(a->centre, b->centre), axis));
    return between > reach_along(a, axis) + reach_along(b, axis) + margin * vec3_length(axis);
}

/* Whether a plane with room on both sides stands between the two: at right angles to a face, or along an edge of each. */
static bool boxes_are_apart(const Turned *a, const Turned *b, double margin)
{
    for (int i = 0; i < 3; i++)
        if (are_apart_along(a, b, vec3_cross(a->half[i], a->half[(i + 1) % 3]), margin) ||
            are_apart_along(a, b, vec3_cross(b->half[i], b->half[(i + 1) % 3]), margin))
            return true;
    for (int i = 0; i < 9; i++)
        if (are_apart_along(a, b, vec3_cross(a->half[i / 3], b->half[i % 3]), margin)) return true;
    return false;
}

static bool balls_are_apart(const Finder *f, uint32_t own, uint32_t other)
{
    if (f->compiled->unbounded[own] || f->compiled->unbounded[other]) return false;
    Ball a = ball_around(f, own), b = ball_around(f, other);
    return vec3_length(vec3_sub(a.centre, b.centre)) > a.radius + b.radius + reach_of_gaps(f, own, other);
}

static bool turned_boxes_are_apart(const Finder *f, uint32_t own, uint32_t other)
{
    Still a, b;
    if (f->compiled->unbounded[own] || f->compiled->unbounded[other] || !stands_still(f, own, &a) ||
        !stands_still(f, other, &b))
        return false;
    Turned box_a = turned_box(&a), box_b = turned_box(&b);
    return boxes_are_apart(&box_a, &box_b, reach_of_gaps(f, own, other));
}

static BallSide judge(const Finder *f, const Candidate *candidate)
{
    uint32_t own, other;
    relation_by_size(f, candidate, &own, &other);
    if (balls_are_apart(f, own, other)) return BALL_OUTSIDE;
    BallSide side = side_of(f, own, other);
    return side == BALL_NEAR && turned_boxes_are_apart(f, own, other) ? BALL_OUTSIDE : side;
}

/* ---- all pairs that wait ---- */

static void task_of_block(void *context, uint32_t block, unsigned worker)
{
    (void)worker;
    Finder *f = context;
    size_t begin = f->n_sifted + (size_t)block * BLOCK, end = begin + BLOCK;
    for (size_t i = begin; i < end && i < f->n_candidates; i++) f->candidates[i].side = judge(f, &f->candidates[i]);
}

Status relation_sift(Finder *f, Error *error)
{
    TRY(make_trees(f, error));
    pool_run(f->pool, (uint32_t)((f->n_candidates - f->n_sifted + BLOCK - 1) / BLOCK), task_of_block, f);
    for (size_t i = f->n_sifted; i < f->n_candidates; i++) {
        const Candidate *candidate = &f->candidates[i];
        uint32_t own, other;
        if (candidate->side == BALL_NEAR) f->candidates[f->n_sifted++] = *candidate;
        if (candidate->side != BALL_INSIDE) continue;
        relation_by_size(f, candidate, &own, &other);
        HullPair pair = {.a = candidate->a,
                         .b = candidate->b,
                         .gap = HUGE_VAL,
                         .overlaps = true,
                         .relation = own == candidate->a ? NEST_A_IN_B : NEST_B_IN_A,
                         .overlap_volume = f->compiled->hulls[own].volume};
        TRY(relation_add_decided(f, &pair, error));
    }
    f->n_candidates = f->n_sifted;
    return STATUS_OK;
}
