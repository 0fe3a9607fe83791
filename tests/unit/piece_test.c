/* piece_test.c - analytic surfaces: closed solids are crossed an even number of times, in and out by turns,
 * by every kind of line that rounding could trip; normals, tangents, insets and bounds by closed forms.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "near.h"

#include "shape/piece.h"

static const double pi = 3.14159265358979323846;

enum { LINES_PER_SOLID = 450000, MAX_CROSSINGS = 1024 };

static double to_float(double x)
{
    return (double)(float)x;
}

typedef struct Line {
    Vec3 org, dir;
} Line;

static Box3 solid_bounds(const Solid *solid)
{
    Box3 bounds = box3_empty();
    for (uint32_t i = 0; i < solid->n_pieces; i++) bounds = box3_union(bounds, piece_bounds(&solid->pieces[i]));
    return bounds;
}

static Vec3 point_in(Dice *dice, Box3 b)
{
    return vec3(b.min.x + dice_unit(dice) * (b.max.x - b.min.x), b.min.y + dice_unit(dice) * (b.max.y - b.min.y),
                b.min.z + dice_unit(dice) * (b.max.z - b.min.z));
}

/* A place on a piece's generating line: somewhere along it, or exactly at one end. */
static void point_on(Dice *dice, const Piece *piece, bool at_end, double *r, double *y)
{
    double s = dice_unit(dice);
    if (piece->kind == PIECE_TORUS) {
        *r = fabs(piece->r0 + piece->r1 * cos(2 * pi * s));
        *y = piece->r1 * sin(2 * pi * s);
        return;
    }
    if (piece->kind == PIECE_OUTER_ARC || piece->kind == PIECE_INNER_ARC) {
        double a = hypot(piece->r0 - piece->centre_r, piece->y0 - piece->centre_y);
        *r = piece->r0;
        *y = piece->y0;
        if (at_end) return;
        *y += s * (piece->y1 - piece->y0);
        double h = *y - piece->centre_y, across = sqrt(fmax(a * a - h * h, 0));
        *r = fmax(piece->centre_r + (piece->kind == PIECE_OUTER_ARC ? across : -across), 0);
        return;
    }
    if (piece->kind == PIECE_SPHERE) {
        *r = piece->r0 * sin(pi * s);
        *y = piece->r0 * cos(pi * s);
        return;
    }
    *r = at_end ? piece->r0 : piece->r0 + s * (piece->r1 - piece->r0);
    *y = at_end ? piece->y0 : piece->y0 + s * (piece->y1 - piece->y0);
}

/* Lines that are chosen to be awkward, 16 kinds in turn. */
static Line awkward_line(Dice *dice, const Solid *solid, Box3 bounds, int kind)
{
    const Piece *piece = &solid->pieces[(uint32_t)(dice_unit(dice) * solid->n_pieces)];
    Vec3 a = point_in(dice, bounds), b = point_in(dice, bounds);
    Vec3 random = dice_direction(dice);
    double r, y, turn = 2 * pi * dice_unit(dice);
    point_on(dice, piece, kind >= 12, &r, &y);
    Vec3 p = vec3(r * cos(turn), y, r * sin(turn));
    Vec3 rounded = vec3(to_float(p.x), to_float(p.y), to_float(p.z));
    double radius = bounds.max.x;
    switch (kind) {
    case 0: return (Line){a, vec3_sub(b, a)};                          /* through the solid */
    case 1: return (Line){vec3_along(a, -3, random), random};          /* from outside */
    case 2: return (Line){rounded, random};                            /* from the surface, as float has it */
    case 3: return (Line){rounded, vec3(0, random.y > 0 ? 1 : -1, 0)}; /* vertical there */
    case 4: return (Line){vec3(0, y, 0), random};                      /* through the axis */
    case 5: return (Line){vec3(rounded.x, y, rounded.z), vec3(random.x, 0, random.z)}; /* in a horizontal plane */
    case 6: return (Line){vec3(rounded.x, y, rounded.z), vec3(random.x, random.y * dice_tiny(dice), random.z)};
    case 7:
    case 13: /* tangent to a circle; from 12 on to one that two bands share */
        return (Line){p, vec3(-p.z, (dice_unit(dice) - 0.5) * dice_tiny(dice) * radius, p.x)};
    case 8: return (Line){p, random};
    case 9: return (Line){vec3(0, y, 0), vec3(0, 1, 0)}; /* the axis itself */
    case 10: return (Line){a, vec3_sub(p, a)};
    case 11: { /* nearly vertical */
        double tiny = dice_tiny(dice);
        return (Line){p, vec3(tiny * random.x, 1, tiny * random.z)};
    }
    case 12: return (Line){a, vec3_sub(rounded, a)};
    case 14: { /* within the surface, along the line that generates it */
        double er = piece->r1 - piece->r0;
        Vec3 along = vec3(er * cos(turn), piece->y1 - piece->y0, er * sin(turn));
        return (Line){p, dice_unit(dice) < 0.5 ? along : vec3_along(along, dice_tiny(dice), random)};
    }
    default: return (Line){vec3_along(p, 1e4 * radius, random), random}; /* from far away */
    }
}

static long n_lines, n_crossings; /* of all closed solids */

typedef struct Crossing {
    double t;
    int side; /* 1 leaving, -1 entering */
} Crossing;

static int compare_crossings(const void *a, const void *b)
{
    const Crossing *p = a;
    const Crossing *q = b;
    return (p->t > q->t) - (p->t < q->t);
}

/* Crossings nearer to each other than this stand at one place, where their order means nothing. */
static double place_tolerance(Line line, double t, double size)
{
    return 1e-11 * (size / vec3_length(line.dir) + fabs(t));
}

static void check_line(const char *name, const Solid *solid, Line line, double size, int kind)
{
    Crossing crossings[MAX_CROSSINGS];
    int n = 0;
    for (uint32_t i = 0; i < solid->n_pieces; i++) {
        double t[PIECE_MAX_ROOTS];
        int found = piece_intersect(&solid->pieces[i], line.org, line.dir, -HUGE_VAL, HUGE_VAL, t);
        for (int k = 0; k < found; k++) {
            assert_true(n < MAX_CROSSINGS);
            Vec3 normal = piece_normal(&solid->pieces[i], line.org, line.dir, t[k]);
            if (!(fabs(vec3_length(normal) - 1) < 1e-12))
                fail_msg("%s: a normal of length %g", name, vec3_length(normal));
            crossings[n++] = (Crossing){t[k], vec3_dot(normal, line.dir) > 0 ? 1 : -1};
        }
    }
    qsort(crossings, (size_t)n, sizeof *crossings, compare_crossings);
    int depth = 0;
    for (int i = 0; i < n; i++) {
        depth -= crossings[i].side;
        bool place_ends =
            i + 1 == n || crossings[i + 1].t - crossings[i].t > place_tolerance(line, crossings[i].t, size);
        if (place_ends && depth != 0 && depth != 1)
            fail_msg("%s: depth %d after crossing %d of %d (kind %d), from %.17g %.17g %.17g along %.17g %.17g %.17g",
                     name, depth, i, n, kind, line.org.x, line.org.y, line.org.z, line.dir.x, line.dir.y, line.dir.z);
    }
    n_lines++;
    n_crossings += n;
    if (depth != 0 || n % 2 != 0) fail_msg("%s: %d crossings end at depth %d (kind %d)", name, n, depth, kind);
}

static void check_closed(const char *name, Solid *solid)
{
    Dice dice = {hash_bytes(name, strlen(name), 7)};
    Box3 bounds = solid_bounds(solid);
    double size = vec3_length(vec3_sub(bounds.max, bounds.min));
    for (int i = 0; i < LINES_PER_SOLID; i++) {
        Line line = awkward_line(&dice, solid, bounds, i % 16);
        if (vec3_dot(line.dir, line.dir) > 0) check_line(name, solid, line, size, i % 16);
    }
    solid_free(solid);
}

static Solid *made_sphere(double radius)
{
    Solid *solid = NULL;
    assert_int_equal(solid_make_sphere(radius, &solid, NULL), STATUS_OK);
    return solid;
}

static Solid *made_cone(double radius0, double radius1, double height)
{
    Solid *solid = NULL;
    assert_int_equal(solid_make_cone(radius0, radius1, height, 0, &solid, NULL), STATUS_OK);
    return solid;
}

static Solid *made_lathe(const double (*profile)[2], uint32_t n, const double *round)
{
    Solid *solid = NULL;
    assert_int_equal(solid_make_lathe(profile, n, round, true, &solid, NULL), STATUS_OK);
    return solid;
}

static void test_simple_solids_are_closed(void **state)
{
    (void)state;
    check_closed("sphere", made_sphere(3.7));
    check_closed("cylinder", made_cone(37, 37, 92));
    check_closed("cone", made_cone(2, 0, 3));
    check_closed("flat frustum", made_cone(1, 2.5, 0.3));
    check_closed("needle", made_cone(1e-3, 2e-3, 50));
}

static Solid *made_torus(double radius, double tube)
{
    Solid *solid = NULL;
    assert_int_equal(solid_make_torus(radius, tube, &solid, NULL), STATUS_OK);
    return solid;
}

static Solid *made_capsule(double radius, double height)
{
    Solid *solid = NULL;
    assert_int_equal(solid_make_capsule(radius, height, &solid, NULL), STATUS_OK);
    return solid;
}

static void test_round_solids_are_closed(void **state)
{
    (void)state;
    check_closed("ring", made_torus(3, 1));
    check_closed("spindle", made_torus(1, 1.7));
    check_closed("wire", made_torus(20, 0.01));
    check_closed("capsule", made_capsule(2, 5));
    check_closed("pill", made_capsule(3, 1e-3));
    check_closed("hair", made_capsule(1e-3, 40));
    const double rod[][2] = {{0, 0}, {5, 0}, {5, 10}, {0, 10}};
    const double fine[] = {0, 0.5, 2, 0};
    check_closed("rod", made_lathe(rod, 4, fine));
    const double thread[][2] = {{5, 0}, {9, 0}, {9, 3}, {6, 3}, {6, 5}, {9, 5}, {9, 8}, {5, 8}};
    const double turns[] = {0.3, 0.3, 1.5, 1, 1, 1.5, 1.5, 1.5};
    check_closed("thread", made_lathe(thread, 8, turns));
    const double lemon[][2] = {{0, 0}, {1, 1}, {0, 2}};
    const double bulge[] = {0, 1.2, 0};
    check_closed("lemon", made_lathe(lemon, 3, bulge));
    const double top[][2] = {{0, 0}, {3, 0.5}, {0, 4}};
    const double blunt[] = {0.3, 0.4, 1};
    check_closed("top", made_lathe(top, 3, blunt));
    const double wedge[][2] = {{3, 0}, {9, 4}, {3, 1}};
    const double nose[] = {0.05, 0.1, 0.03};
    check_closed("wedge", made_lathe(wedge, 3, nose));
    const double goblet[][2] = {{0, 0},   {3, 0},    {3.2, 0.2}, {0.5, 0.8}, {0.4, 4},
                                {2.8, 6}, {2.6, 10}, {2.4, 10},  {2.5, 6.1}, {0, 4.6}};
    const bool corner[10] = {[1] = true};
    Solid *curved = NULL;
    assert_int_equal(solid_make_curved_lathe(goblet, 10, LATHE_CUBIC, corner, 0, &curved, NULL), STATUS_OK);
    check_closed("goblet", curved);
}

static void test_lathes_are_closed(void **state)
{
    (void)state;
    const double tumbler[][2] = {{0, 0}, {38, 0}, {40, 2}, {40, 92}, {37, 92}, {37, 10}, {0, 10}};
    const double rounds[] = {0, 1, 1, 1.5, 1.5, 8, 0};
    check_closed("tumbler", made_lathe(tumbler, 7, NULL));
    check_closed("rounded tumbler", made_lathe(tumbler, 7, rounds));
    const double shell[][2] = {{0, 0},   {1, 0.3},   {1.3, 1}, {1, 1.8},   {0, 2},
                               {0, 1.9}, {0.9, 1.7}, {1.2, 1}, {0.9, 0.4}, {0, 0.1}};
    check_closed("shell", made_lathe(shell, 10, NULL));
    const double crown[][2] = {{2, 0}, {2.5, 0.1}, {3, 0}, {3, 1}, {2.7, 0.5}, {2.5, 1}, {2.2, 0.5}, {2, 1}};
    check_closed("crown", made_lathe(crown, 8, NULL));
    const double pinched[][2] = {{0, 0}, {1, 1}, {1, -1}};
    check_closed("pinched", made_lathe(pinched, 3, NULL));
    double torus[64][2];
    for (int i = 0; i < 64; i++) {
        torus[i][0] = 3 + cos(2 * pi * i / 64);
        torus[i][1] = sin(2 * pi * i / 64);
    }
    check_closed("torus", made_lathe((const double(*)[2])torus, 64, NULL));
}

static void test_sphere_by_formula(void **state)
{
    (void)state;
    Piece sphere = {.kind = PIECE_SPHERE, .r0 = 2};
    double t[PIECE_MAX_ROOTS];
    assert_int_equal(piece_intersect(&sphere, vec3(1, 0, -10), vec3(0, 0, 1), 0, HUGE_VAL, t), 2);
    assert_near(t[0], 10 - sqrt(3), 1e-14);
    assert_near(t[1], 10 + sqrt(3), 1e-14);
    assert_int_equal(piece_intersect(&sphere, vec3(1, 0, -10), vec3(0, 0, 1), 10, HUGE_VAL, t), 1);
    assert_int_equal(piece_intersect(&sphere, vec3(1, 0, -10), vec3(0, 0, 1), 0, 10, t), 1);
    assert_int_equal(piece_intersect(&sphere, vec3(2, 0, -10), vec3(0, 0, 1), 0, HUGE_VAL, t), 0); /* tangent */
    /* half open: t_min is left out, t_max is in */
    assert_int_equal(piece_intersect(&sphere, vec3(0, 0, -10), vec3(0, 0, 1), 8, 12, t), 1);
    assert_near(t[0], 12, 0);
    /* small and far away: the textbook formula has no digit left here */
    Piece pea = {.kind = PIECE_SPHERE, .r0 = 1e-3};
    assert_int_equal(piece_intersect(&pea, vec3(0, 0, -1e5), vec3(0, 0, 2), 0, HUGE_VAL, t), 2);
    assert_near(t[0], 0.5 * (1e5 - 1e-3), 1e-10);
}

static void test_open_pieces(void **state)
{
    (void)state;
    double t[PIECE_MAX_ROOTS];
    Piece rect = {.kind = PIECE_RECT, .r0 = 2, .r1 = 1};
    Piece plane = {.kind = PIECE_PLANE};
    assert_int_equal(piece_intersect(&rect, vec3(1.9, 5, 0.9), vec3(0, -2, 0), 0, HUGE_VAL, t), 1);
    assert_near(t[0], 2.5, 0);
    assert_int_equal(piece_intersect(&rect, vec3(1.9, 5, 1.1), vec3(0, -2, 0), 0, HUGE_VAL, t), 0);
    assert_int_equal(piece_intersect(&plane, vec3(1e9, 5, 1), vec3(0, -2, 0), 0, HUGE_VAL, t), 1);
    assert_int_equal(piece_intersect(&plane, vec3(0, 5, 0), vec3(1, 0, 0), 0, HUGE_VAL, t), 0);
    PieceRoot root;
    piece_surface(&rect, vec3(1, 5, -1), vec3(0, -1, 0), 5, &root);
    assert_near(root.normal.y, 1, 0);
    assert_near(root.u, 0.75, 0);
    assert_near(root.v, 1, 0);
    assert_true(isinf(piece_bounds(&plane).max.x));
    assert_near(piece_bounds(&rect).max.z, 1, 0);
}

/* How far p is from a band's cone, signed; its gradient is the normal. */
static double cone_distance(const Piece *piece, Vec3 p)
{
    double er = piece->r1 - piece->r0, ey = piece->y1 - piece->y0;
    return ((hypot(p.x, p.z) - piece->r0) * ey - (p.y - piece->y0) * er) / hypot(er, ey);
}

static void test_normals_are_gradients(void **state)
{
    (void)state;
    Dice dice = {99};
    const double bands[][4] = {{1, 0, 1, 3}, {2, 0, 1, 2}, {1, 2, 2, 0}, {0, 0, 2, 0}, {2, 1, 0, 1}, {0.5, 0, 3, 0.1}};
    int n_checked = 0;
    for (int i = 0; i < 20000; i++) {
        const double *b = bands[i % (int)COUNT_OF(bands)];
        Piece piece = piece_make_band(b[0], b[1], b[2], b[3]);
        Vec3 org = vec3_scale(dice_direction(&dice), 6);
        Vec3 dir = vec3_sub(vec3_scale(dice_direction(&dice), 2.5 * dice_unit(&dice)), org);
        double t[PIECE_MAX_ROOTS];
        int n = piece_intersect(&piece, org, dir, -HUGE_VAL, HUGE_VAL, t);
        for (int k = 0; k < n; k++) {
            PieceRoot root;
            piece_surface(&piece, org, dir, t[k], &root);
            Vec3 p = vec3_along(org, t[k], dir);
            if (hypot(p.x, p.z) < 0.05) continue; /* the gradient turns fast at the axis */
            const double h = 1e-5;
            Vec3 gradient =
                vec3(cone_distance(&piece, vec3(p.x + h, p.y, p.z)) - cone_distance(&piece, vec3(p.x - h, p.y, p.z)),
                     cone_distance(&piece, vec3(p.x, p.y + h, p.z)) - cone_distance(&piece, vec3(p.x, p.y - h, p.z)),
                     cone_distance(&piece, vec3(p.x, p.y, p.z + h)) - cone_distance(&piece, vec3(p.x, p.y, p.z - h)));
            gradient = vec3_scale(gradient, 1 / (2 * h));
            if (vec3_length(vec3_sub(gradient, root.normal)) > 1e-5) fail_msg("a normal off its gradient");
            if (vec3_length(vec3_sub(root.shading, root.normal)) > 1e-6)
                fail_msg("a shading normal off the band's own");
            if (fabs(cone_distance(&piece, p)) > 1e-9) fail_msg("a root %g off the surface", cone_distance(&piece, p));
            if (!(root.u >= 0 && root.u < 1 && root.v >= 0 && root.v <= 1)) fail_msg("uv %g %g", root.u, root.v);
            n_checked++;
        }
    }
    assert_true(n_checked > 3000);
}

/* A drink and the glass around it share the wall at radius 37: both must be met at the same t. */
static void test_shared_walls_coincide(void **state)
{
    (void)state;
    const double tumbler[][2] = {{0, 0}, {38, 0}, {40, 2}, {40, 92}, {37, 92}, {37, 10}, {0, 10}};
    Solid *glass = made_lathe(tumbler, 7, NULL);
    Solid *drink = made_cone(37, 37, 50);
    const Piece *wall = NULL, *side = &drink->pieces[1];
    for (uint32_t i = 0; i < glass->n_pieces; i++)
        if (glass->pieces[i].r0 == 37 && glass->pieces[i].r1 == 37) wall = &glass->pieces[i];
    assert_non_null(wall);
    Dice dice = {5};
    int n_shared = 0;
    for (int i = 0; i < 300000; i++) {
        Vec3 org = vec3(200 * dice_unit(&dice) - 100, 100 * dice_unit(&dice), 200 * dice_unit(&dice) - 100);
        Vec3 dir = dice_direction(&dice);
        Vec3 lifted = vec3(org.x, org.y - 10, org.z); /* the drink stands 10 higher */
        double t[PIECE_MAX_ROOTS], s[PIECE_MAX_ROOTS];
        int n = piece_intersect(wall, org, dir, -HUGE_VAL, HUGE_VAL, t);
        int m = piece_intersect(side, lifted, dir, -HUGE_VAL, HUGE_VAL, s);
        for (int k = 0; k < n; k++) {
            double y = org.y + t[k] * dir.y;
            if (y < 10.001 || y > 59.999) continue;
            bool found = false;
            for (int j = 0; j < m; j++) found |= fabs(s[j] - t[k]) <= 1e-12 * (100 + fabs(t[k]));
            if (!found) fail_msg("the drink's wall is not at the glass's: t = %.17g", t[k]);
            n_shared++;
        }
    }
    assert_true(n_shared > 50000);
    solid_free(glass);
    solid_free(drink);
}

/* Normals are gradients of the distance, u goes around and v along; the half of an arc that turns inwards faces the
 * other way. */
static void test_arcs_and_tori(void **state)
{
    (void)state;
    Dice dice = {31};
    const Piece pieces[] = {
        {.kind = PIECE_TORUS, .r0 = 3, .r1 = 1},
        {.kind = PIECE_OUTER_ARC, .r0 = 3, .y0 = -1, .r1 = 3, .y1 = 1, .centre_r = 3, .v1 = 1},
        {.kind = PIECE_OUTER_ARC, .r0 = 3, .y0 = 1, .r1 = 3, .y1 = -1, .centre_r = 3, .v1 = 1},
        {.kind = PIECE_INNER_ARC, .r0 = 3, .y0 = 1, .r1 = 3, .y1 = -1, .centre_r = 3, .v1 = 1},
        {.kind = PIECE_INNER_ARC, .r0 = 3, .y0 = -1, .r1 = 3, .y1 = 1, .centre_r = 3, .v1 = 1},
    };
    const double sides[] = {1, 1, -1, 1, -1};
    int n_checked = 0;
    for (int i = 0; i < 20000; i++) {
        const Piece *piece = &pieces[i % (int)COUNT_OF(pieces)];
        Vec3 org = vec3_scale(dice_direction(&dice), 6), to = vec3_scale(dice_direction(&dice), 4 * dice_unit(&dice));
        Vec3 dir = vec3_sub(to, org);
        double t[PIECE_MAX_ROOTS];
        int n = piece_intersect(piece, org, dir, -HUGE_VAL, HUGE_VAL, t);
        for (int k = 0; k < n; k++) {
            PieceRoot root;
            piece_surface(piece, org, dir, t[k], &root);
            Vec3 p = vec3_along(org, t[k], dir);
            double r = hypot(p.x, p.z), side = sides[i % (int)COUNT_OF(pieces)];
            Vec3 normal = vec3_scale(vec3((r - 3) * p.x / r, p.y, (r - 3) * p.z / r), side);
            if (fabs(hypot(r - 3, p.y) - 1) > 1e-13) fail_msg("a root off the surface");
            if (vec3_length(vec3_sub(normal, root.normal)) > 1e-6) fail_msg("a normal off its gradient");
            if (piece->kind == PIECE_OUTER_ARC && r < 3 - 1e-12) fail_msg("a root on the other half");
            if (piece->kind == PIECE_INNER_ARC && r > 3 + 1e-12) fail_msg("a root on the other half");
            double turn = atan2(-p.z, p.x) / (2 * pi), around = atan2(p.y, r - 3) / (2 * pi);
            Vec3 du, dv; /* along the surface: a quarter of a turn or less of the arc */
            piece_gradients(piece, p, &du, &dv);
            assert_near(vec3_dot(du, vec3(p.z, 0, -p.x)), 1 / (2 * pi), 1e-12);
            assert_near(vec3_length(du) * r, 1 / (2 * pi), 1e-12);
            Vec3 up = vec3(-p.y * p.x / r, r - 3, -p.y * p.z / r); /* along the circle, its length 1 */
            double per_turn = piece->kind == PIECE_TORUS ? 1 : piece->y1 > piece->y0 ? 2 : -2;
            if (piece->kind == PIECE_INNER_ARC) per_turn = -per_turn;
            assert_near(vec3_dot(dv, up) * 2 * pi, per_turn, 1e-9);
            assert_near(root.u, turn < 0 ? turn + 1 : turn, 1e-12);
            double v = around < 0 ? around + 1 : around;
            if (piece->kind == PIECE_OUTER_ARC) v = 0.5 + (piece->y1 > piece->y0 ? 2 : -2) * around;
            if (piece->kind == PIECE_INNER_ARC) v = piece->y1 < piece->y0 ? 2 * v - 0.5 : 1.5 - 2 * v;
            assert_near(root.v, v, 1e-9);
            n_checked++;
        }
    }
    assert_true(n_checked > 10000);
}

static void test_volumes_and_errors(void **state)
{
    (void)state;
    Solid *solid = made_sphere(2);
    assert_near(solid->volume, 32 * pi / 3, 1e-12);
    solid_free(solid);
    solid = made_cone(3, 3, 5);
    assert_near(solid->volume, 45 * pi, 1e-12);
    assert_int_equal(solid->n_pieces, 3);
    assert_near((double)solid->pieces[2].v1, 1, 0);
    solid_free(solid);
    solid = made_cone(0, 3, 5);
    assert_near(solid->volume, 15 * pi, 1e-12);
    assert_int_equal(solid->n_pieces, 2);
    solid_free(solid);
    /* a spindle: by slices; a ring and a capsule by Pappus */
    solid = made_torus(1, 1.7);
    double slices = 0;
    enum { SLICES = 200000 };
    for (int i = 0; i < SLICES; i++) {
        double y = 1.7 * (2 * (i + 0.5) / SLICES - 1), half = sqrt(1.7 * 1.7 - y * y);
        double hole = fmax(1 - half, 0);
        slices += pi * ((1 + half) * (1 + half) - hole * hole) * 3.4 / SLICES;
    }
    assert_near(solid->volume, slices, 1e-6);
    solid_free(solid);
    solid = made_torus(3, 1);
    assert_near(solid->volume, 6 * pi * pi, 1e-12);
    solid_free(solid);
    solid = made_capsule(2, 5);
    assert_near(solid->volume, 20 * pi + 32 * pi / 3, 1e-12);
    double pieces = 0;
    for (uint32_t i = 0; i < solid->n_pieces; i++) pieces += piece_volume(&solid->pieces[i]);
    assert_near(pieces, solid->volume, 1e-12);
    solid_free(solid);
    Error error;
    assert_int_equal(solid_make_torus(1, 0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_torus((double)NAN, 1, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_capsule(1, 0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_sphere(0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_sphere((double)NAN, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_cone(0, 0, 1, 0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_cone(1, -1, 1, 0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_cone(1, 1, 0, 0, &solid, &error), STATUS_SCENE);
    assert_int_equal(solid_make_cone(1, 1, (double)INFINITY, 0, &solid, &error), STATUS_SCENE);
    solid_free(NULL);
}

/* Every line that was wrong has failed its test already. */
static void test_ten_million_lines(void **state)
{
    (void)state;
    printf("    %ld lines through closed solids: %ld crossings, in and out by turns, 0 faults\n", n_lines, n_crossings);
    assert_true(n_lines >= 10000000);
    assert_true(n_crossings >= 10000000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_simple_solids_are_closed),
        cmocka_unit_test(test_lathes_are_closed),
        cmocka_unit_test(test_round_solids_are_closed),
        cmocka_unit_test(test_ten_million_lines),
        cmocka_unit_test(test_sphere_by_formula),
        cmocka_unit_test(test_open_pieces),
        cmocka_unit_test(test_arcs_and_tori),
        cmocka_unit_test(test_normals_are_gradients),
        cmocka_unit_test(test_shared_walls_coincide),
        cmocka_unit_test(test_volumes_and_errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
