/* ball_side_test.c - balls inside and outside of solids, against points of their surfaces and against rays.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "icosphere.h"

#include "shape/ball_side.h"

enum { BALLS = 3000, POINTS = 4000 };

/* Points all over the surface. */
typedef struct Cloud {
    Vec3 points[POINTS];
    double spacing; /* none of the surface is further from all points than about this */
} Cloud;

static Cloud cloud_of(const Solid *solid)
{
    static Cloud cloud;
    double area = 0;
    for (uint32_t i = 0; i < solid->n_pieces; i++) area += piece_area(&solid->pieces[i]);
    uint32_t piece = 0;
    double past = 0;
    for (int i = 0; i < POINTS; i++) { /* by area, and spread evenly over each */
        while (piece + 1 < solid->n_pieces && past + piece_area(&solid->pieces[piece]) < area * i / POINTS)
            past += piece_area(&solid->pieces[piece++]);
        Vec3 normal;
        double u = 0.7548776662466927 * i, v = 0.5698402909980532 * i;
        cloud.points[i] = piece_sample(&solid->pieces[piece], u - floor(u), v - floor(v), &normal);
    }
    cloud.spacing = 4 * sqrt(area / POINTS);
    return cloud;
}

static double distance_to(const Cloud *cloud, Vec3 p)
{
    double least = HUGE_VAL;
    for (int i = 0; i < POINTS; i++) least = fmin(least, vec3_length(vec3_sub(cloud->points[i], p)));
    return least;
}

static bool is_inside(const Solid *solid, Vec3 p, Vec3 direction)
{
    double t[PIECE_MAX_ROOTS];
    int n = 0;
    for (uint32_t i = 0; i < solid->n_pieces; i++)
        n += piece_intersect(&solid->pieces[i], p, direction, 0, HUGE_VAL, t);
    return n % 2 == 1;
}

/* exact: what is near the circle of an arc, but not the arc, may be taken for near otherwise. */
static void check_solid(const char *name, Solid *solid, double size, bool exact)
{
    Dice dice = {(uint64_t)size + solid->n_pieces};
    ProfileTree tree, none = {0};
    Cloud cloud = cloud_of(solid);
    int n[3] = {0};
    assert_int_equal(profile_tree_make(solid, &tree, NULL), STATUS_OK);
    for (int i = 0; i < BALLS; i++) {
        Vec3 centre = vec3(size * (2 * dice_unit(&dice) - 1), size * (2 * dice_unit(&dice) - 1),
                           size * (2 * dice_unit(&dice) - 1));
        double radius = size * 0.5 * pow(dice_unit(&dice), 5), away = distance_to(&cloud, centre);
        BallSide side = solid_ball_side(solid, &tree, centre, radius);
        n[side]++;
        if (side != solid_ball_side(solid, &none, centre, radius)) fail_msg("%s: the tree says something else", name);
        if (side == BALL_NEAR) {
            if (exact && away > radius + cloud.spacing) fail_msg("%s: near, at %g from %g", name, away, radius);
            continue;
        }
        if (away < radius) fail_msg("%s: %g from the surface, not near for a radius of %g", name, away, radius);
        bool inside = is_inside(solid, centre, dice_direction(&dice));
        if (inside != (side == BALL_INSIDE)) fail_msg("%s: the ball at %g %g %g", name, centre.x, centre.y, centre.z);
    }
    if (!(n[BALL_INSIDE] > 1 && n[BALL_OUTSIDE] > BALLS / 8))
        fail_msg("%s: %d inside, %d outside of %d", name, n[BALL_INSIDE], n[BALL_OUTSIDE], BALLS);
    profile_tree_clear(&tree);
    solid_free(solid);
}

static Solid *lathe_of(const double (*profile)[2], uint32_t n, const double *round)
{
    Solid *solid;
    assert_int_equal(solid_make_lathe(profile, n, round, true, &solid, NULL), STATUS_OK);
    return solid;
}

static void balls_are_on_the_side_that_rays_tell(void **state)
{
    (void)state;
    Solid *solid;
    static const double tumbler[][2] = {{0, 0}, {40, 0}, {40, 92}, {37, 92}, {37, 10}, {0, 10}};
    static const double round[] = {0, 4, 1.5, 1.5, 8, 0};
    static const double ring[][2] = {{20, 0}, {40, 10}, {20, 20}};
    assert_int_equal(solid_make_sphere(3, &solid, NULL), STATUS_OK);
    check_solid("sphere", solid, 5, true);
    assert_int_equal(solid_make_torus(3, 1, &solid, NULL), STATUS_OK);
    check_solid("torus", solid, 5, true);
    assert_int_equal(solid_make_capsule(1, 3, &solid, NULL), STATUS_OK);
    check_solid("capsule", solid, 5, true);
    assert_int_equal(solid_make_cone(3, 1, 4, 0, &solid, NULL), STATUS_OK);
    check_solid("cone", solid, 5, true);
    assert_int_equal(solid_make_cone(3, 1, 4, 0.5, &solid, NULL), STATUS_OK);
    check_solid("rounded cone", solid, 5, true);
    check_solid("tumbler", lathe_of(tumbler, COUNT_OF(tumbler), NULL), 100, true);
    check_solid("rounded tumbler", lathe_of(tumbler, COUNT_OF(tumbler), round), 100, true);
    check_solid("ring", lathe_of(ring, COUNT_OF(ring), NULL), 50, true);
}

/* A profile of a hundred arcs has a tree. */
static void many_pieces_are_asked_by_a_tree(void **state)
{
    (void)state;
    static const double goblet[][2] = {{0, 0},   {3, 0},    {3.2, 0.2}, {0.5, 0.8}, {0.4, 4},
                                       {2.8, 6}, {2.6, 10}, {2.4, 10},  {2.5, 6.1}, {0, 4.6}};
    static const bool corner[COUNT_OF(goblet)] = {[1] = true};
    Solid *solid;
    assert_int_equal(solid_make_curved_lathe(goblet, COUNT_OF(goblet), LATHE_CUBIC, corner, 0, &solid, NULL),
                     STATUS_OK);
    assert_true(solid->n_pieces > 40);
    check_solid("goblet", solid, 11, false);
}

static void open_and_endless_solids(void **state)
{
    (void)state;
    const ProfileTree none = {0};
    Solid *solid;
    assert_int_equal(solid_new(1, &solid, NULL), STATUS_OK);
    Piece *piece = &solid->pieces[0];
    *piece = (Piece){.kind = PIECE_PLANE};
    assert_int_equal(solid_ball_side(solid, &none, vec3(5, -2, 1), 1), BALL_INSIDE);
    assert_int_equal(solid_ball_side(solid, &none, vec3(5, 2, 1), 1), BALL_OUTSIDE);
    assert_int_equal(solid_ball_side(solid, &none, vec3(5, 2, 1), 2), BALL_NEAR);
    *piece = (Piece){.kind = PIECE_RECT, .r0 = 1, .r1 = 1};
    assert_int_equal(solid_ball_side(solid, &none, vec3(5, 2, 1), 1), BALL_NEAR);
    *piece = (Piece){.kind = PIECE_SPHERE, .r0 = 1};
    assert_int_equal(solid_ball_side(solid, &none, vec3(5, 2, 1), NAN), BALL_NEAR);
    /* a tube that reaches over the axis is filled */
    *piece = (Piece){.kind = PIECE_TORUS, .r0 = 1, .r1 = 3};
    assert_int_equal(solid_ball_side(solid, &none, vec3(0, 0, 0), 0.5), BALL_INSIDE);
    assert_int_equal(solid_ball_side(solid, &none, vec3(0, 4, 0), 0.5), BALL_OUTSIDE);
    solid_free(solid);
}

/* ---- meshes ---- */

static BallSide expected(double outside_by, double radius)
{
    return fabs(outside_by) <= radius ? BALL_NEAR : outside_by < 0 ? BALL_INSIDE : BALL_OUTSIDE;
}

/* Of a point from a box about the origin; negative inside. */
static double distance_from_box(Vec3 p, Vec3 half)
{
    Vec3 out = vec3(fabs(p.x) - half.x, fabs(p.y) - half.y, fabs(p.z) - half.z);
    Vec3 beyond = vec3(fmax(out.x, 0), fmax(out.y, 0), fmax(out.z, 0));
    return vec3_length(beyond) + fmin(fmax(out.x, fmax(out.y, out.z)), 0);
}

static void balls_and_meshes(void **state)
{
    (void)state;
    Dice dice = {7};
    Mesh *box, *sphere = icosphere(3, 4);
    BoxTree of_box, of_sphere;
    const Vec3 half = {3, 1, 2};
    const double sagitta = 0.01; /* of 5120 triangles */
    assert_int_equal(mesh_make_box(vec3_scale(half, -1), half, 0, 1, &box, NULL), STATUS_OK);
    assert_non_null(sphere);
    assert_int_equal(mesh_box_tree(box, &of_box, NULL), STATUS_OK);
    assert_int_equal(mesh_box_tree(sphere, &of_sphere, NULL), STATUS_OK);
    int n[3] = {0};
    for (int i = 0; i < 20000; i++) {
        Vec3 p = vec3(8 * dice_unit(&dice) - 4, 8 * dice_unit(&dice) - 4, 8 * dice_unit(&dice) - 4);
        if (i % 10 == 0) p = vec3(floor(p.x), floor(p.y), floor(p.z)); /* in line with corners and edges */
        double radius = 2 * dice_unit(&dice) * dice_unit(&dice), away = distance_from_box(p, half);
        BallSide side = mesh_ball_side(box, &of_box, p, radius);
        n[side]++;
        if (fabs(fabs(away) - radius) > 1e-6 && side != expected(away, radius))
            fail_msg("box: %d at %g %g %g, radius %g", side, p.x, p.y, p.z, radius);
        away = vec3_length(p) - 3;
        side = mesh_ball_side(sphere, &of_sphere, p, radius);
        if (fabs(fabs(away) - radius) > sagitta && side != expected(away, radius))
            fail_msg("sphere: %d at %g %g %g, radius %g", side, p.x, p.y, p.z, radius);
    }
    assert_true(n[BALL_NEAR] > 1000 && n[BALL_INSIDE] > 500 && n[BALL_OUTSIDE] > 5000);
    assert_int_equal(mesh_ball_side(box, &of_box, vec3(0, 0, 0), NAN), BALL_NEAR);
    assert_int_equal(mesh_ball_side(box, &of_box, vec3(0, INFINITY, 0), 1), BALL_NEAR);
    /* turned inside out, a box is a cavity in everything: nothing is inside of it */
    for (uint32_t i = 0; i < box->n_triangles; i++) {
        uint32_t corner = box->triangles[i][0];
        box->triangles[i][0] = box->triangles[i][1];
        box->triangles[i][1] = corner;
    }
    assert_int_equal(mesh_ball_side(box, &of_box, vec3(0.1, 0, 0), 0.5), BALL_OUTSIDE);
    box_tree_clear(&of_box);
    box_tree_clear(&of_sphere);
    mesh_free(box);
    mesh_free(sphere);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_are_on_the_side_that_rays_tell),
        cmocka_unit_test(many_pieces_are_asked_by_a_tree),
        cmocka_unit_test(open_and_endless_solids),
        cmocka_unit_test(balls_and_meshes),
    };
    return cmocka_run_group_tests_name("ball_side", tests, NULL, NULL);
}
