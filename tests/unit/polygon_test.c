/* polygon_test.c - outlines and prisms: closed whatever they look like, and as large as they must be.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "shape/contour.h"
#include "shape/meshed.h"
#include "near.h"

static const double pi = 3.14159265358979323846;

static void add_corner(Outline2 *outline, double x, double y)
{
    assert_true(outline2_add_point(outline, &(OutlinePoint2){.at = {x, y}, .leave = {1, 0}, .arrive = {1, 0}}));
}

static void end_loop(Outline2 *outline)
{
    assert_true(outline2_end_loop(outline));
}

/* Signed: counterclockwise loops are positive. */
static double outline_area(const Outline2 *outline)
{
    double area = 0;
    size_t begin = 0;
    for (size_t loop = 0; loop < outline->n_loops; loop++) {
        size_t end = outline->loop_ends[loop];
        for (size_t i = begin; i < end; i++) {
            Point2 a = outline->points[i].at, b = outline->points[i + 1 < end ? i + 1 : begin].at,
                   o = outline->points[begin].at;
            area += 0.5 * ((a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x));
        }
        begin = end;
    }
    return area;
}

/* A prism of height 2 over the outline: closed, and of twice the area. Returns the area. */
static double checked_area(const Outline2 *outline, double tolerance)
{
    Grower grower = {0};
    Mesh *mesh = NULL;
    MeshReport report;
    Error error;
    PrismShape shape = {.from = -1, .to = 1, .scale_from = 1, .scale_to = 1};
    if (prism_add(&grower, outline, &shape, &error) != STATUS_OK) fail_msg("%s", error.text);
    assert_int_equal(grower_finish(&grower, "it", &mesh, &error), STATUS_OK);
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    double area = outline_area(outline);
    if (!report.closed || fabs(report.volume - 2 * area) > tolerance)
        fail_msg("closed %d, %u open edges, volume %g of %g", report.closed, report.n_open_edges, report.volume,
                 2 * area);
    mesh_free(mesh);
    return area;
}

static void signs_are_exact(void **state)
{
    (void)state;
    /* Three points on a line, and off it by one unit in the last place, far from the origin. */
    Point2 a = {12, 12}, b = {24, 24};
    for (int i = -3; i <= 3; i++)
        for (int k = -3; k <= 3; k++) {
            Point2 c = {0.5 + i * 0x1p-53, 0.5 + k * 0x1p-53};
            c.x -= i < 0 ? 0 : fmod(i, 2) * 0x1p-53; /* only what a double can hold above a half */
            c.y -= k < 0 ? 0 : fmod(k, 2) * 0x1p-53;
            assert_int_equal(exact_turn(a, b, c), (c.y > c.x) - (c.y < c.x));
            assert_int_equal(exact_turn(b, a, c), (c.y < c.x) - (c.y > c.x));
            assert_int_equal(exact_turn(c, a, b), (c.y > c.x) - (c.y < c.x));
        }
    assert_int_equal(exact_turn((Point2){0, 0}, (Point2){1e-200, 0}, (Point2){5, 1}), 1);
}

/* Rectangles on a small grid touch, cover, and cross each other in all ways; counting cells says what is covered. */
static void unions_of_rectangles(void **state)
{
    (void)state;
    enum { GRID = 12 };
    Dice dice = {1};
    for (int round = 0; round < 3000; round++) {
        bool covered[GRID][GRID] = {{false}};
        Outline2 outline = {0};
        int n = 1 + dice_below(&dice, 9), cells = 0;
        for (int i = 0; i < n; i++) {
            int x0 = dice_below(&dice, GRID - 1), y0 = dice_below(&dice, GRID - 1);
            int x1 = x0 + 1 + dice_below(&dice, GRID - x0 - 1), y1 = y0 + 1 + dice_below(&dice, GRID - y0 - 1);
            for (int x = x0; x < x1; x++)
                for (int y = y0; y < y1; y++) covered[x][y] = true;
            add_corner(&outline, x0, y0);
            add_corner(&outline, x1, y0);
            add_corner(&outline, x1, y1);
            add_corner(&outline, x0, y1);
            end_loop(&outline);
        }
        for (int x = 0; x < GRID; x++)
            for (int y = 0; y < GRID; y++) cells += covered[x][y];
        assert_int_equal(polygon_clean(&outline, FILL_NONZERO, NULL), STATUS_OK);
        assert_near(checked_area(&outline, 1e-4), cells, 1e-9);
        outline2_clear(&outline);
    }
}

/* Triangles between random points, which cross at points that must be rounded. */
static void unions_of_triangles(void **state)
{
    (void)state;
    Dice dice = {2};
    for (int round = 0; round < 1500; round++) {
        Outline2 outline = {0};
        int n = 3 * (1 + dice_below(&dice, 8)), coarse = round % 2 ? 8 : 1 << 20;
        for (int i = 0; i < n; i++) {
            add_corner(&outline, dice_below(&dice, coarse) * 10.0 / coarse, dice_below(&dice, coarse) * 10.0 / coarse);
            if (i % 3 == 2) end_loop(&outline);
        }
        double sum = 0; /* of the triangles' areas: what is united is not larger, and not smaller than the largest */
        for (int i = 0; i < n; i += 3) {
            Point2 a = outline.points[i].at, b = outline.points[i + 1].at, c = outline.points[i + 2].at;
            sum += fabs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
        }
        assert_int_equal(polygon_clean(&outline, FILL_NONZERO, NULL), STATUS_OK);
        if (outline.n_points) assert_true(checked_area(&outline, 1e-3) <= sum + 1e-6);
        outline2_clear(&outline);
    }
}

/* Stars with holes that are stars; even-odd makes the holes, whichever way round they go. */
static void stars_with_holes(void **state)
{
    (void)state;
    Dice dice = {3};
    for (int round = 0; round < 1500; round++) {
        Outline2 outline = {0};
        double expected = 0;
        int n_holes = dice_below(&dice, 6);
        for (int loop = 0; loop <= n_holes; loop++) {
            int n = 3 + dice_below(&dice, 40);
            bool hole = loop > 0, backward = dice_unit(&dice) < 0.5;
            double cx = hole ? 3 * cos(2 * pi * loop / n_holes) : 0, cy = hole ? 3 * sin(2 * pi * loop / n_holes) : 0;
            double area = 0, first_x = 0, first_y = 0, last_x = 0, last_y = 0;
            for (int i = 0; i < n; i++) {
                double angle = 2 * pi * i / n * (backward ? -1 : 1) + 0.1;
                double r = hole ? 0.1 + 1.3 * dice_unit(&dice) : 10 + 8 * dice_unit(&dice);
                double x = cx + r * cos(angle), y = cy + r * sin(angle);
                if (i)
                    area += last_x * y - last_y * x;
                else
                    first_x = x, first_y = y;
                add_corner(&outline, last_x = x, last_y = y);
            }
            area = fabs(area + last_x * first_y - last_y * first_x) / 2;
            expected += hole ? -area : area;
            end_loop(&outline);
        }
        Crossing2 crossing;
        assert_int_equal(polygon_find_crossing(&outline, &crossing, NULL), STATUS_OK);
        if (!crossing.found) {
            assert_int_equal(polygon_clean(&outline, FILL_EVEN_ODD, NULL), STATUS_OK);
            assert_near(checked_area(&outline, 2e-3), expected, 1e-6);
        }
        outline2_clear(&outline);
    }
}

static void crossings_are_found(void **state)
{
    (void)state;
    static const struct {
        double xy[12];
        int n;
        bool found;
    } cases[] = {
        {{0, 0, 2, 0, 2, 2, 0, 2}, 4, false},
        {{0, 0, 2, 2, 2, 0, 0, 2}, 4, true},              /* a bow */
        {{0, 0, 4, 0, 4, 4, 2, 0, 0, 4}, 5, true},        /* a corner on an edge */
        {{0, 0, 4, 0, 2, 0, 2, 2}, 4, true},              /* back along itself */
        {{0, 0, 2, 0, 1, 1, 2, 2, 0, 2, 1, 1}, 6, false}, /* touches itself at a corner */
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Outline2 outline = {0};
        for (int k = 0; k < cases[i].n; k++) add_corner(&outline, cases[i].xy[2 * k], cases[i].xy[2 * k + 1]);
        end_loop(&outline);
        Crossing2 crossing;
        assert_int_equal(polygon_find_crossing(&outline, &crossing, NULL), STATUS_OK);
        assert_int_equal(crossing.found, cases[i].found);
        if (!crossing.found) {
            assert_int_equal(polygon_clean(&outline, FILL_EVEN_ODD, NULL), STATUS_OK);
            checked_area(&outline, 1e-6);
        }
        outline2_clear(&outline);
    }
}

static void curves_keep_to_their_tolerance(void **state)
{
    (void)state;
    const double k = 0.5522847498307936; /* a quarter of a circle as a cubic, to 3e-4 */
    const double circle[24] = {1, 0, 1, k, k, 1, 0, 1, -k, 1, -1, k, -1, 0, -1, -k, -k, -1, 0, -1, k, -1, 1, -k};
    Outline2 outline = {0};
    Pen pen = {.outline = &outline, .tolerance = 1e-4, .smooth_degrees = 1};
    assert_int_equal(contour_draw(&pen, CONTOUR_BEZIER, circle, 12, NULL), STATUS_OK);
    assert_near(outline_area(&outline), pi, 3e-3);
    for (size_t i = 0; i < outline.n_points; i++) {
        OutlinePoint2 p = outline.points[i];
        assert_near(hypot(p.at.x, p.at.y), 1, 3e-4);
        assert_near(p.leave.x * p.at.x + p.leave.y * p.at.y, 0, 2e-3); /* along the circle, at the joints too */
        assert_near(hypot(p.leave.x - p.arrive.x, p.leave.y - p.arrive.y), 0, 1e-12);
    }
    assert_int_equal(polygon_clean(&outline, FILL_EVEN_ODD, NULL), STATUS_OK);
    checked_area(&outline, 1e-5);
    Error error;
    assert_int_equal(contour_draw(&pen, CONTOUR_BEZIER, circle, 11, &error), STATUS_SCENE);
    assert_int_equal(contour_draw(&pen, CONTOUR_LINEAR, circle, 2, &error), STATUS_SCENE);
    outline2_clear(&outline);
}

/* The volume of a prism whose every edge is rounded: a square of side s, inset by d at each height. */
static void bevels_round_the_ends(void **state)
{
    (void)state;
    const double square[8] = {0, 0, 0, 4, 4, 4, 4, 0}; /* the other way round: no matter */
    for (unsigned segments = 1; segments <= 64; segments += 63) {
        Outline2 outline = {0};
        Grower grower = {0};
        Mesh *mesh = NULL;
        MeshReport report;
        Error error;
        Pen pen = {.outline = &outline, .tolerance = 1e-3};
        assert_int_equal(contour_draw(&pen, CONTOUR_LINEAR, square, 4, NULL), STATUS_OK);
        assert_int_equal(polygon_clean(&outline, FILL_EVEN_ODD, NULL), STATUS_OK);
        double b = 1;
        PrismShape shape = {.from = 3, .to = 1, .scale_from = 1, .scale_to = 1, .bevel = b, .bevel_segments = segments};
        if (prism_add(&grower, &outline, &shape, &error) != STATUS_OK) fail_msg("%s", error.text);
        assert_int_equal(grower_finish(&grower, "it", &mesh, NULL), STATUS_OK);
        assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
        assert_true(report.closed);
        /* flat: a double frustum; round: the integral of (4 - 2 b (1 - cos a))^2 b cos a, twice */
        double flat = 2 * (16 + 4 + 8) / 3.0;
        double rounded = 2 * (4 + 8 * (pi / 4) + 4 * (2.0 / 3));
        assert_near(report.volume, segments == 1 ? flat : rounded, segments == 1 ? 1e-5 : 5e-3);
        mesh_free(mesh);
        shape.bevel = 2.5;
        shape.from = 20;
        assert_int_equal(prism_add(&grower, &outline, &shape, &error), STATUS_SCENE);
        assert_non_null(strstr(error.text, "one of 1.9 fits"));
        grower_clear(&grower);
        outline2_clear(&outline);
    }
}

static void cones_taper(void **state)
{
    (void)state;
    const double square[8] = {-1, -1, 1, -1, 1, 1, -1, 1};
    static const double scales[3][3] = {{1, 0, 4.0}, {0, 2, 16.0}, {1, 2, 4 * (1 + 2 + 4)}};
    for (int i = 0; i < 3; i++) {
        Outline2 outline = {0};
        Grower grower = {0};
        Mesh *mesh = NULL;
        MeshReport report;
        Pen pen = {.outline = &outline, .tolerance = 1e-3};
        assert_int_equal(contour_draw(&pen, CONTOUR_LINEAR, square, 4, NULL), STATUS_OK);
        assert_int_equal(polygon_clean(&outline, FILL_EVEN_ODD, NULL), STATUS_OK);
        PrismShape shape = {.from = 0, .to = 3, .scale_from = scales[i][0], .scale_to = scales[i][1]};
        assert_int_equal(prism_add(&grower, &outline, &shape, NULL), STATUS_OK);
        assert_int_equal(grower_finish(&grower, "it", &mesh, NULL), STATUS_OK);
        assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
        assert_true(report.closed && report.n_degenerate == 0);
        assert_near(report.volume, scales[i][2], 1e-5);
        mesh_free(mesh);
        outline2_clear(&outline);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(signs_are_exact),       cmocka_unit_test(unions_of_rectangles),
        cmocka_unit_test(unions_of_triangles),   cmocka_unit_test(stars_with_holes),
        cmocka_unit_test(crossings_are_found),   cmocka_unit_test(curves_keep_to_their_tolerance),
        cmocka_unit_test(bevels_round_the_ends), cmocka_unit_test(cones_taper),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
