/* lathe_test.c - profiles turned about an axis: volumes by Pappus and by frusta, arcs and their normals, the
 * sense of the profile, and every way in which a profile can be wrong.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"

#include "shape/piece.h"

static const double pi = 3.14159265358979323846;

typedef const double (*Profile)[2];

static Solid *make(Profile profile, uint32_t n, const double *round, bool smooth)
{
    Solid *solid = NULL;
    Error error = {STATUS_OK, ""};
    if (solid_make_lathe(profile, n, round, smooth, &solid, &error) != STATUS_OK) fail_msg("%s", error.text);
    return solid;
}

/* The profile must be refused, for a reason that holds this text. */
static void refuse(Profile profile, uint32_t n, const double *round, const char *reason)
{
    Solid *solid = NULL;
    Error error = {STATUS_OK, ""};
    assert_int_equal(solid_make_lathe(profile, n, round, false, &solid, &error), STATUS_SCENE);
    assert_null(solid);
    if (!strstr(error.text, reason)) fail_msg("'%s' does not say '%s'", error.text, reason);
}

static const double tumbler[][2] = {{0, 0}, {38, 0}, {40, 2}, {40, 92}, {37, 92}, {37, 10}, {0, 10}};
static const double tumbler_volume =
    3.14159265358979323846 * (2.0 / 3 * (38.0 * 38 + 38 * 40 + 40 * 40) + 40.0 * 40 * 90 - 37.0 * 37 * 82);

/* Pieces follow each other, the chain closes on the axis, and every edge lies as its normals say. */
static void check_chain(const Solid *solid)
{
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *here = &solid->pieces[i];
        const Piece *next = &solid->pieces[(i + 1) % solid->n_pieces];
        bool linked = here->r1 == next->r0 && here->y1 == next->y0;
        bool axis = here->r1 == 0 && next->r0 == 0;
        assert_true(linked || axis);
        if (here->kind == PIECE_BAND) {
            assert_near(hypot((double)here->nr0, (double)here->ny0), 1, 1e-6);
            assert_near(hypot((double)here->nr1, (double)here->ny1), 1, 1e-6);
            continue;
        }
        double radius = hypot(here->r0 - here->centre_r, here->y0 - here->centre_y);
        assert_near(hypot(here->r1 - here->centre_r, here->y1 - here->centre_y) / radius, 1, 1e-12);
        double side = here->kind == PIECE_OUTER_ARC ? 1 : -1;
        assert_true(side * (here->r0 - here->centre_r) >= -1e-12 * radius &&
                    side * (here->r1 - here->centre_r) >= -1e-12 * radius);
    }
}

static void test_volume_in_either_sense(void **state)
{
    (void)state;
    Solid *solid = make(tumbler, 7, NULL, false);
    assert_int_equal(solid->n_pieces, 6);
    assert_near(solid->volume, tumbler_volume, 1e-9);
    check_chain(solid);
    solid_free(solid);
    double reversed[7][2];
    for (int i = 0; i < 7; i++) memcpy(reversed[i], tumbler[6 - i], sizeof reversed[i]);
    solid = make((Profile)reversed, 7, NULL, false);
    assert_near(solid->volume, tumbler_volume, 1e-9);
    check_chain(solid);
    solid_free(solid);
    /* beginning elsewhere, with points said twice and the axis written out */
    const double other[][2] = {{40, 2}, {40, 2}, {40, 92}, {37, 92}, {37, 10},
                               {0, 10}, {0, 5},  {0, 0},   {38, 0},  {40, 2}};
    solid = make(other, 10, NULL, false);
    assert_int_equal(solid->n_pieces, 6);
    assert_near(solid->volume, tumbler_volume, 1e-9);
    check_chain(solid);
    solid_free(solid);
}

static void test_pappus(void **state)
{
    (void)state;
    /* A polygon's area times the way of its centroid: a regular 90-gon about (5, 1). */
    double ring[90][2];
    for (int i = 0; i < 90; i++) {
        ring[i][0] = 5 + 2 * cos(2 * pi * i / 90);
        ring[i][1] = 1 + 2 * sin(2 * pi * i / 90);
    }
    Solid *solid = make((Profile)ring, 90, NULL, true);
    double area = 0.5 * 90 * 4 * sin(2 * pi / 90);
    assert_near(solid->volume, area * 2 * pi * 5, 1e-9);
    check_chain(solid);
    /* smooth: the corner's normal points away from the ring's centre, on both sides */
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *p = &solid->pieces[i];
        assert_near((double)p->nr0, (p->r0 - 5) / 2, 1e-6);
        assert_near((double)p->ny1, (p->y1 - 1) / 2, 1e-6);
        assert_true(p->v0 < p->v1);
    }
    solid_free(solid);
}

static void test_hollow(void **state)
{
    (void)state;
    /* a ball of cones with a bubble: the inner part counts off */
    const double shell[][2] = {{0, -2}, {2, 0}, {0, 2}, {0, 1}, {1, 0}, {0, -1}};
    Solid *solid = make(shell, 6, NULL, false);
    assert_int_equal(solid->n_pieces, 4);
    assert_near(solid->volume, 2 * pi / 3 * (8 - 1), 1e-12);
    check_chain(solid);
    solid_free(solid);
}

static void test_rounded_corner(void **state)
{
    (void)state;
    const double can[][2] = {{0, 0}, {5, 0}, {5, 10}, {0, 10}};
    const double round[] = {0, 2, 0, 0};
    Solid *solid = make(can, 4, round, false);
    /* a disc, the arc, the side, the lid */
    assert_int_equal(solid->n_pieces, 4);
    check_chain(solid);
    /* what a quarter round takes: the ring between a square and a quarter disc, by Pappus */
    double square = 4.0 * 2 * pi * 4;
    double quarter = pi * 2 * pi * (3 + 4 * 2.0 / (3 * pi)) * 1.0;
    assert_near(solid->volume, pi * 250 - (square - quarter), 1e-10);
    const Piece *p = &solid->pieces[1];
    assert_int_equal(p->kind, PIECE_OUTER_ARC);
    assert_near(p->centre_r, 3, 1e-12);
    assert_near(p->centre_y, 2, 1e-12);
    assert_near(p->r0, 3, 1e-12);
    assert_near(p->y0, 0, 1e-12);
    assert_near(p->r1, 5, 1e-12);
    assert_near(p->y1, 2, 1e-12);
    /* its neighbours start and end as it does */
    assert_near((double)solid->pieces[0].ny1, -1, 0);
    assert_near((double)solid->pieces[2].nr0, 1, 0);
    assert_near((double)p->v0, 3 / (3 + pi + 8 + 5), 1e-4);
    assert_near((double)p->v1, (3 + pi) / (3 + pi + 8 + 5), 1e-4);
    solid_free(solid);
}

static void test_rounds_that_meet(void **state)
{
    (void)state;
    /* two roundings use up the side between them; a tip on the axis becomes part of a sphere */
    const double pill[][2] = {{0, 0}, {2, 0}, {2, 4}, {0, 4}};
    const double round[] = {0, 2, 2, 0};
    Solid *solid = make(pill, 4, round, false);
    assert_int_equal(solid->n_pieces, 2);
    check_chain(solid);
    assert_near(solid->volume / (32 * pi / 3), 1, 1e-12);
    assert_near(solid->pieces[0].centre_r, 0, 1e-12);
    solid_free(solid);
    const double cone[][2] = {{0, 0}, {3, 0}, {0, 4}};
    const double tip[] = {0, 0, 1};
    solid = make(cone, 3, tip, false);
    check_chain(solid);
    const Piece *top = &solid->pieces[solid->n_pieces - 1];
    assert_int_equal(top->kind, PIECE_OUTER_ARC);
    assert_near(top->r1, 0, 0);
    assert_near(top->centre_r, 0, 0);
    assert_near(top->y1 - top->centre_y, 1, 1e-12);
    /* the inscribed sphere of radius 1 touches the slope 4/3 from its tip and tops out 5/3 - 1 below it */
    assert_near(top->y1, 4 - (5.0 / 3 - 1), 1e-12);
    solid_free(solid);
    /* concave: the inside of a tumbler's floor */
    const double floor_round[] = {0, 0, 0, 0, 0, 8, 0};
    solid = make(tumbler, 7, floor_round, false);
    check_chain(solid);
    double taken =
        64 * 2 * pi * (37 - 4) - 16 * pi * 2 * pi * (29 + 4 * 8.0 / (3 * pi)); /* less hollow than with a corner */
    assert_near(solid->volume, tumbler_volume + taken, 1e-8);
    assert_int_equal(solid->n_pieces, 7);
    const Piece *hollow = &solid->pieces[5];
    assert_int_equal(hollow->kind, PIECE_OUTER_ARC);
    assert_near(hollow->centre_r, 29, 1e-12);
    assert_near(hollow->centre_y, 18, 1e-12);
    assert_true(hollow->y1 < hollow->y0); /* downwards: the solid is outside of the circle */
    solid_free(solid);
    /* a groove: an arc that turns from up to down is cut there */
    const double groove[][2] = {{5, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {9, 5}, {9, 8}, {5, 8}};
    const double turns[] = {0, 0, 1.5, 1, 1, 1.5, 0, 0};
    solid = make(groove, 8, turns, false);
    check_chain(solid);
    solid_free(solid);
    const double wedge[][2] = {{3, 0}, {9, 4}, {3, 1}};
    const double nose[] = {0, 0.1, 0};
    solid = make(wedge, 3, nose, false);
    check_chain(solid);
    assert_int_equal(solid->n_pieces, 5); /* three sides, and the nose, over its top: twice */
    solid_free(solid);
}

static void test_smooth_limit(void **state)
{
    (void)state;
    /* turns of 30 and of 60 degrees: only the first is smoothed */
    const double profile[][2] = {{0, 0}, {1, 0}, {1 + 0.86602540378443865, 0.5}, {1 + 0.86602540378443865, 2}, {0, 2}};
    Solid *solid = make(profile, 5, NULL, true);
    assert_int_equal(solid->n_pieces, 4);
    assert_near((double)solid->pieces[0].nr1, sin(pi / 12), 1e-6);
    assert_near((double)solid->pieces[1].nr0, sin(pi / 12), 1e-6);
    assert_near((double)solid->pieces[1].nr1, 0.5, 1e-6);
    assert_near((double)solid->pieces[2].nr0, 1, 1e-6);
    solid_free(solid);
    solid = make(profile, 5, NULL, false);
    assert_near((double)solid->pieces[0].nr1, 0, 0);
    solid_free(solid);
}

static void test_refusals(void **state)
{
    (void)state;
    const double two[][2] = {{0, 0}, {1, 0}};
    refuse(two, 2, NULL, "at least 3 points");
    const double same[][2] = {{0, 0}, {1, 0}, {1, 0}, {0, 0}};
    refuse(same, 4, NULL, "3 different points");
    const double left[][2] = {{0, 0}, {1, 0}, {-0.5, 2}};
    refuse(left, 3, NULL, "profile[2] = <-0.5, 2> is left of the axis");
    const double nothing[][2] = {{0, 0}, {1, (double)NAN}, {0, 2}};
    refuse(nothing, 3, NULL, "profile[1]");
    const double far[][2] = {{0, 0}, {1e300, 0}, {0, 2}};
    refuse(far, 3, NULL, "profile[1]");
    const double bow[][2] = {{1, 0}, {2, 1}, {2, 0}, {1, 1}};
    refuse(bow, 4, NULL, "crosses or touches itself");
    const double touching[][2] = {{1, 0}, {3, 0}, {3, 2}, {2, 0}, {1, 2}};
    refuse(touching, 5, NULL, "crosses or touches itself");
    const double doubled[][2] = {{1, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 0}, {1.5, 0}, {1.5, 1}, {1, 1}};
    refuse(doubled, 8, NULL, "crosses or touches itself");
    const double spike[][2] = {{1, 0}, {3, 0}, {2, 0}, {2, 2}};
    refuse(spike, 4, NULL, "turns back on itself at profile[1] = <3, 0>");
    const double can[][2] = {{0, 0}, {5, 0}, {5, 10}, {0, 10}};
    const double wide[] = {0, 6, 0, 0};
    refuse(can, 4, wide, "rounding takes");
    const double both[] = {0, 5, 5.001, 0};
    refuse(can, 4, both, "rounding takes");
    const double negative[] = {0, -1, 0, 0};
    refuse(can, 4, negative, "the rounding -1 of profile[1]");
    const double line[][2] = {{0, 0}, {0, 1}, {0, 3}};
    refuse(line, 3, NULL, "encloses no volume");
    const double pinched[][2] = {{0, 0}, {1, 1}, {1, -1}};
    const double on_axis[] = {0.1, 0, 0};
    refuse(pinched, 3, on_axis, "cannot be rounded");
}

static void test_beads_may_touch_on_the_axis(void **state)
{
    (void)state;
    const double beads[][2] = {{0, 0}, {1, 1}, {0, 2}, {1, 3}, {0, 4}};
    Solid *solid = make(beads, 5, NULL, false);
    assert_near(solid->volume, 4 * pi / 3, 1e-12);
    check_chain(solid);
    solid_free(solid);
}

static void test_many_points(void **state)
{
    (void)state;
    enum { N = 100000 };
    double(*profile)[2] = malloc(N * sizeof *profile);
    assert_non_null(profile);
    for (int i = 0; i < N; i++) {
        double angle = 2 * pi * i / N;
        double radius = 2 + 0.3 * sin(997 * angle);
        profile[i][0] = 5 + radius * cos(angle);
        profile[i][1] = radius * sin(angle);
    }
    Solid *solid = make((Profile)profile, N, NULL, true);
    assert_int_equal(solid->n_pieces, N);
    solid_free(solid);
    profile[N / 2][0] = 8; /* one point goes astray, across the whole ring */
    refuse((Profile)profile, N, NULL, "crosses or touches itself");
    refuse((Profile)profile, N + 1, NULL, "at most 100000 points");
    free(profile);
}

static Solid *make_curve(Profile profile, uint32_t n, LatheCurve kind, const bool *corner, double tolerance)
{
    Solid *solid = NULL;
    Error error = {STATUS_OK, ""};
    if (solid_make_curved_lathe(profile, n, kind, corner, tolerance, &solid, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    check_chain(solid);
    return solid;
}

static void refuse_curve(Profile profile, uint32_t n, LatheCurve kind, const char *reason)
{
    static const bool corner[16] = {false};
    Solid *solid = NULL;
    Error error = {STATUS_OK, ""};
    assert_int_equal(solid_make_curved_lathe(profile, n, kind, corner, 0, &solid, &error), STATUS_SCENE);
    if (!strstr(error.text, reason)) fail_msg("'%s' does not say '%s'", error.text, reason);
}

/* The direction of a piece at one of its ends, in the sense of the walk. */
static void piece_direction(const Piece *p, bool at_end, double *r, double *y)
{
    *r = p->r1 - p->r0;
    *y = p->y1 - p->y0;
    if (p->kind != PIECE_BAND) {
        double up = p->y1 > p->y0 ? 1 : -1, outer = p->kind == PIECE_OUTER_ARC ? 1 : -1;
        *r = -up * outer * ((at_end ? p->y1 : p->y0) - p->centre_y);
        *y = up * outer * ((at_end ? p->r1 : p->r0) - p->centre_r);
    }
    double length = hypot(*r, *y);
    *r /= length;
    *y /= length;
}

/* The largest turn, in radians, from one piece to the next, off the axis. */
static double largest_kink(const Solid *solid)
{
    double largest = 0;
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        const Piece *here = &solid->pieces[i], *next = &solid->pieces[(i + 1) % solid->n_pieces];
        if (here->r1 == 0) continue;
        double r0, y0, r1, y1;
        piece_direction(here, true, &r0, &y0);
        piece_direction(next, false, &r1, &y1);
        largest = fmax(largest, fabs(atan2(r0 * y1 - y0 * r1, r0 * r1 + y0 * y1)));
    }
    return largest;
}

static const double quarter = 0.5522847498307936; /* of Bezier's control points for a quarter of a circle */

static void test_bezier(void **state)
{
    (void)state;
    /* half a circle, as everybody draws it: a ball to 2.7e-4 of its radius */
    const double ball[][2] = {{0, -1}, {quarter, -1}, {1, -quarter}, {1, 0}, {1, quarter}, {quarter, 1}, {0, 1}};
    Solid *solid = make_curve(ball, 7, LATHE_BEZIER, NULL, 1e-3);
    assert_int_equal(solid->n_pieces, 4);
    assert_near(solid->volume / (4 * pi / 3), 1, 1e-3);
    solid_free(solid);
    /* finer, the arcs follow the curve instead of the circle; the other way round, and closed, it is the same */
    solid = make_curve(ball, 7, LATHE_BEZIER, NULL, 1e-9);
    uint32_t n_fine = solid->n_pieces;
    double volume = solid->volume;
    printf("    a ball of two Bezier pieces within 1e-9: %u arcs\n", n_fine);
    assert_true(n_fine > 20 && n_fine < 1000);
    /* the curve's own volume, pi times the integral of r^2 dy, by the midpoint rule */
    double exact = 0;
    enum { STEPS = 1000000 };
    for (int i = 0; i < STEPS; i++) {
        double t = (i + 0.5) / STEPS, s = 1 - t;
        double r = 3 * s * t * t + t * t * t + 3 * s * s * t * quarter;
        double slope = 3 * s * s * 0 + 6 * s * t * (1 - quarter) + 3 * t * t * quarter;
        exact += 2 * pi * r * r * slope / STEPS;
    }
    assert_near(volume, exact, 1e-7);
    assert_true(largest_kink(solid) < 1e-6);
    solid_free(solid);
    double back[7][2];
    for (int i = 0; i < 7; i++) memcpy(back[i], ball[6 - i], sizeof back[i]);
    solid = make_curve((Profile)back, 7, LATHE_BEZIER, NULL, 1e-9);
    assert_int_equal(solid->n_pieces, n_fine);
    assert_near(solid->volume, volume, 1e-12);
    solid_free(solid);
    refuse_curve(ball, 5, LATHE_BEZIER, "3 points for each piece");
    const double over[][2] = {{0, -1}, {-2, -1}, {1, -quarter}, {1, 0}, {1, quarter}, {quarter, 1}, {0, 1}};
    refuse_curve(over, 7, LATHE_BEZIER, "crosses the axis behind profile[0]");
}

static void test_smooth_curve(void **state)
{
    (void)state;
    /* through points of a circle about the axis: smooth, and square to it at both poles */
    double ball[13][2];
    for (int i = 0; i < 13; i++) {
        ball[i][0] = i % 12 ? sin(pi * i / 12) : 0;
        ball[i][1] = -cos(pi * i / 12);
    }
    const bool none[16] = {false};
    Solid *solid = make_curve((Profile)ball, 13, LATHE_CUBIC, none, 0);
    assert_near(solid->volume / (4 * pi / 3), 1, 2e-4);
    assert_true(largest_kink(solid) < 1e-6);
    double r, y;
    piece_direction(&solid->pieces[0], false, &r, &y);
    assert_near(y, 0, 1e-7);
    piece_direction(&solid->pieces[solid->n_pieces - 1], true, &r, &y);
    assert_near(y, 0, 1e-7);
    solid_free(solid);
    /* a closed curve, off the axis */
    double ring[8][2];
    for (int i = 0; i < 8; i++) {
        ring[i][0] = 3 + cos(2 * pi * i / 8);
        ring[i][1] = sin(2 * pi * i / 8);
    }
    solid = make_curve((Profile)ring, 8, LATHE_CUBIC, none, 0);
    assert_near(solid->volume / (6 * pi * pi), 1, 1e-2);
    assert_true(largest_kink(solid) < 1e-6);
    solid_free(solid);
    /* corners, with straight lines between them: a can, whatever the curve */
    const double can[][2] = {{0, 0}, {2, 0}, {2, 3}, {0, 3}};
    const bool all[] = {true, true, true, true};
    solid = make_curve(can, 4, LATHE_CUBIC, all, 0);
    assert_int_equal(solid->n_pieces, 3);
    assert_near(solid->volume, 12 * pi, 1e-12);
    assert_near(largest_kink(solid), pi / 2, 1e-12);
    assert_near((double)solid->pieces[0].ny1, -1, 0);
    solid_free(solid);
    const bool rim[] = {false, true, false, false};
    solid = make_curve(can, 4, LATHE_CUBIC, rim, 0);
    assert_true(largest_kink(solid) > 0.1);
    solid_free(solid);
    const double twice[][2] = {{0, 0}, {2, 0}, {2, 0}, {0, 3}};
    refuse_curve(twice, 4, LATHE_CUBIC, "profile[2] = <2, 0> repeats");
    const double closed[][2] = {{1, 0}, {2, 0}, {2, 1}, {1, 0}};
    refuse_curve(closed, 4, LATHE_CUBIC, "profile[3] repeats the first point");
    const double left[][2] = {{0, 0}, {2, 0}, {-2, 1}};
    refuse_curve(left, 3, LATHE_CUBIC, "left of the axis");
    const double knot[][2] = {{0, 0}, {3, 0}, {1, 2}, {3, 2}, {1, 0.5}, {0, 3}};
    refuse_curve(knot, 6, LATHE_CUBIC, "crosses or touches itself");
}

static void test_natural_curve(void **state)
{
    (void)state;
    const bool none[16] = {false};
    /* through both poles and a point of the equator: half of the curve through four points of a circle */
    const double ball[][2] = {{0, -1}, {1, 0}, {0, 1}};
    Solid *solid = make_curve(ball, 3, LATHE_NATURAL, none, 1e-9);
    assert_near(solid->volume, 2137 * pi / 1680, 1e-7);
    assert_true(largest_kink(solid) < 1e-6);
    double r, y;
    piece_direction(&solid->pieces[0], false, &r, &y);
    assert_near(y, 0, 1e-7);
    solid_free(solid);
    /* a ring off the axis: area 61/20, by Pappus */
    const double ring[][2] = {{4, 0}, {3, 1}, {2, 0}, {3, -1}};
    solid = make_curve(ring, 4, LATHE_NATURAL, none, 1e-9);
    assert_near(solid->volume, 2 * pi * 3 * 61 / 20, 1e-6);
    assert_true(largest_kink(solid) < 1e-6);
    solid_free(solid);
    const double can[][2] = {{0, 0}, {2, 0}, {2, 3}, {0, 3}};
    const bool all[] = {true, true, true, true}, rim[] = {false, true, false, false};
    solid = make_curve(can, 4, LATHE_NATURAL, all, 0);
    assert_near(solid->volume, 12 * pi, 1e-12);
    solid_free(solid);
    solid = make_curve(can, 4, LATHE_NATURAL, rim, 0);
    assert_true(largest_kink(solid) > 0.1);
    solid_free(solid);
    const double twice[][2] = {{0, 0}, {2, 0}, {2, 0}, {0, 3}};
    refuse_curve(twice, 4, LATHE_NATURAL, "profile[2] = <2, 0> repeats");
    const double closed[][2] = {{1, 0}, {2, 0}, {2, 1}, {1, 0}};
    refuse_curve(closed, 4, LATHE_NATURAL, "profile[3] repeats the first point");
    refuse_curve(can, 2, LATHE_NATURAL, "at least 3 points");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_volume_in_either_sense),
        cmocka_unit_test(test_pappus),
        cmocka_unit_test(test_hollow),
        cmocka_unit_test(test_rounded_corner),
        cmocka_unit_test(test_rounds_that_meet),
        cmocka_unit_test(test_smooth_limit),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_beads_may_touch_on_the_axis),
        cmocka_unit_test(test_many_points),
        cmocka_unit_test(test_bezier),
        cmocka_unit_test(test_smooth_curve),
        cmocka_unit_test(test_natural_curve),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
