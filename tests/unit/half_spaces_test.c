/* half_spaces_test.c - what half spaces have in common: closed forms, corners that many faces meet in, planes that take no part,
 * and what has no body; and planes and boxes of combinations, which become one body where nothing else is seen of it, against
 * the same scenes with each of them an operand of its own.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "dice.h"
#include "scene/lines.h"
#include "scene_fixture.h"
#include "mesh/half_spaces.h"

static const double pi = 3.14159265358979323846;

enum { MOST = 400 };

typedef struct Spaces {
    HalfSpace items[MOST];
    uint32_t n;
} Spaces;

static void add(Spaces *spaces, Vec3 normal, double distance)
{
    assert_true(spaces->n < MOST);
    spaces->items[spaces->n++] = (HalfSpace){vec3_normalize(normal), distance};
}

static void add_cube(Spaces *spaces, double half)
{
    add(spaces, vec3(1, 0, 0), half);
    add(spaces, vec3(-1, 0, 0), half);
    add(spaces, vec3(0, 1, 0), half);
    add(spaces, vec3(0, -1, 0), half);
    add(spaces, vec3(0, 0, 1), half);
    add(spaces, vec3(0, 0, -1), half);
}

static void move(Spaces *spaces, const Affine *map)
{
    for (uint32_t i = 0; i < spaces->n; i++) spaces->items[i] = half_space_moved(map, spaces->items[i]);
}

/* Their body, which there must be: closed, and one ball of triangles. */
static Mesh *body_of(const Spaces *spaces, Vec3 *centre, MeshReport *report)
{
    Mesh *mesh;
    Error error;
    assert_int_equal(half_spaces_mesh(spaces->items, spaces->n, &mesh, centre, &error), STATUS_OK);
    if (!mesh) fail_msg("no body of %u half spaces", (unsigned)spaces->n);
    assert_int_equal(mesh_inspect(mesh, NULL, report, &error), STATUS_OK);
    assert_true(report->closed && report->consistent && !report->inside_out);
    assert_int_equal(report->n_components, 1);
    assert_int_equal(report->n_non_manifold_edges, 0);
    assert_int_equal(report->n_degenerate, 0);
    assert_int_equal(mesh->n_triangles, 2 * mesh->n_vertices - 4);
    return mesh;
}

static void assert_body(const Spaces *spaces, double volume, uint32_t n_vertices)
{
    Vec3 centre;
    MeshReport report;
    Mesh *mesh = body_of(spaces, &centre, &report);
    if (fabs(report.volume - volume) > 1e-6 * volume || mesh->n_vertices != n_vertices)
        fail_msg("%.9g and %u corners, not %.9g and %u", report.volume, (unsigned)mesh->n_vertices, volume,
                 (unsigned)n_vertices);
    double size = vec3_length(vec3_sub(report.bounds.max, report.bounds.min));
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        for (uint32_t k = 0; k < spaces->n; k++) {
            Vec3 place = vec3_add(centre, vec3_from_f(mesh->positions[i]));
            double beyond = vec3_dot(spaces->items[k].normal, place) - spaces->items[k].distance;
            if (beyond > 1e-6 * size) fail_msg("a corner is %g beyond plane %u", beyond, (unsigned)k);
        }
    mesh_free(mesh);
}

static void assert_none(const Spaces *spaces)
{
    Mesh *mesh;
    Vec3 centre;
    Error error;
    assert_int_equal(half_spaces_mesh(spaces->items, spaces->n, &mesh, &centre, &error), STATUS_OK);
    assert_null(mesh);
}

/* ---- bodies ---- */

static void cubes_are_exact(void **state)
{
    (void)state;
    Spaces spaces = {0};
    add_cube(&spaces, 1);
    Vec3 centre;
    MeshReport report;
    Mesh *mesh = body_of(&spaces, &centre, &report);
    assert_true(centre.x == 0 && centre.y == 0 && centre.z == 0);
    assert_int_equal(mesh->n_vertices, 8);
    for (uint32_t i = 0; i < 8; i++) {
        Vec3f p = mesh->positions[i];
        assert_true(fabsf(p.x) == 1 && fabsf(p.y) == 1 && fabsf(p.z) == 1);
    }
    mesh_free(mesh);
    assert_body(&spaces, 8, 8);
}

static void pyramids_have_one_point(void **state)
{
    (void)state;
    for (int sides = 3; sides <= 64; sides++) { /* all walls meet in <0, -2, 0> */
        Spaces spaces = {0};
        double angle = 41 * pi / 180, radius = 2 / tan(angle); /* inscribed, where they are cut off at y = 0 */
        for (int i = 0; i < sides; i++) {
            double turn = 2 * pi * i / sides;
            add(&spaces, vec3(sin(angle) * cos(turn), -cos(angle), sin(angle) * sin(turn)), 2 * cos(angle));
        }
        add(&spaces, vec3(0, 1, 0), 0);
        assert_body(&spaces, sides * radius * radius * tan(pi / sides) * 2 / 3, (uint32_t)sides + 1);
    }
}

/* The volume of what is around a ball is its area times a third of the radius. */
static void faces_around_balls(void **state)
{
    (void)state;
    Dice dice = {3};
    int n_bodies = 0;
    for (int i = 0; i < 300; i++) {
        Spaces spaces = {0};
        Vec3 middle = dice_point(&dice, i % 3 ? 3 : 1000);
        int n = 4 + dice_below(&dice, i % 10 ? 40 : 300);
        for (int k = 0; k < n; k++) {
            Vec3 normal = dice_direction(&dice);
            add(&spaces, normal, 1 + vec3_dot(normal, middle));
        }
        Mesh *mesh;
        Vec3 centre;
        Error error;
        assert_int_equal(half_spaces_mesh(spaces.items, spaces.n, &mesh, &centre, &error), STATUS_OK);
        if (!mesh) {
            assert_true(n < 12); /* without end */
            continue;
        }
        mesh_free(mesh);
        MeshReport report;
        mesh = body_of(&spaces, &centre, &report);
        if (fabs(report.volume - report.area / 3) > 1e-5 * report.volume)
            fail_msg("%.9g around a ball, not %.9g", report.volume, report.area / 3);
        mesh_free(mesh);
        n_bodies++;
    }
    assert_true(n_bodies > 200);
}

static void moved_bodies_are_as_large(void **state)
{
    (void)state;
    Dice dice = {8};
    int n_mirrored = 0;
    for (int i = 0; i < 200; i++) {
        Affine map;
        for (int row = 0; row < 3; row++)
            for (int column = 0; column < 3; column++) map.m[row][column] = 2 * dice_unit(&dice) - 1;
        map.t = dice_point(&dice, 100);
        double factor = affine_determinant(&map);
        if (fabs(factor) < 0.05) continue;
        Spaces spaces = {0};
        add_cube(&spaces, 1.5);
        move(&spaces, &map);
        assert_body(&spaces, 27 * fabs(factor), 8);
        n_mirrored += factor < 0;
    }
    assert_true(n_mirrored > 20);
}

/* Planes that cut nothing off: far away, through a corner, an edge, a face, and ones that are there already. */
static void idle_planes_change_nothing(void **state)
{
    (void)state;
    Spaces spaces = {0};
    add_cube(&spaces, 1);
    add(&spaces, vec3(1, 2, 3), 50);
    add(&spaces, vec3(1, 1, 1), 1.7321);
    add(&spaces, vec3(1, 1, 1), sqrt(3));
    add(&spaces, vec3(2, 1, 1), 4 / sqrt(6));
    add(&spaces, vec3(1, 1, 0), sqrt(2));
    add(&spaces, vec3(-1, 0, 2), 3 / sqrt(5));
    add(&spaces, vec3(0, 1, 0), 1);
    add(&spaces, vec3(0, 1, 1e-12), 1);
    add(&spaces, vec3(0, 1, 0), 1 + 1e-11);
    add(&spaces, vec3(0, -1, 0), 1e6);
    assert_body(&spaces, 8, 8);
    const Affine turn = {{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}}, {7, 1e3, 0.1}};
    move(&spaces, &turn);
    assert_body(&spaces, 8, 8);
}

/* Facets that are to meet in points, of numbers with few digits: they meet in very short edges, or in points after all. */
static void few_digits_are_enough(void **state)
{
    (void)state;
    int n_bodies = 0, n_none = 0;
    for (int digits = 3; digits <= 12; digits++)
        for (int sides = 8; sides <= 24; sides++) {
            const double step = pow(10, -digits);
            Spaces spaces = {0};
            for (int i = 0; i < sides; i++) {
                const double turn = 2 * pi * i / sides, slope[] = {-.7, 0, .6, .3}, off[] = {1, 1.3, 1.05, 1};
                for (int k = 0; k < 4; k++) {
                    double at = k < 3 ? turn : turn + pi / sides, ring = k == 1 ? 1 : sin(fabs(slope[k]));
                    double up = k == 1 ? 0 : copysign(cos(slope[k]), slope[k]);
                    Vec3 normal = {round(ring * cos(at) / step) * step, round(up / step) * step,
                                   round(ring * sin(at) / step) * step};
                    add(&spaces, normal, off[k]);
                }
            }
            add(&spaces, vec3(0, 1, 0), .9);
            Mesh *mesh;
            Vec3 centre;
            Error error;
            assert_int_equal(half_spaces_mesh(spaces.items, spaces.n, &mesh, &centre, &error), STATUS_OK);
            n_none += !mesh;
            if (!mesh) continue;
            mesh_free(mesh);
            MeshReport report;
            mesh_free(body_of(&spaces, &centre, &report));
            n_bodies++;
        }
    if (n_none > n_bodies / 20) fail_msg("%d bodies, and %d have none", n_bodies, n_none);
}

static void some_have_no_body(void **state)
{
    (void)state;
    Spaces empty = {0}, endless = {0}, flat = {0}, few = {0}, cone = {0};
    add_cube(&empty, 1);
    add(&empty, vec3(1, 1, 0), -2);
    assert_none(&empty);
    add_cube(&endless, 1);
    endless.n--;
    assert_none(&endless);
    add_cube(&flat, 1);
    add(&flat, vec3(1, 0, 0), -1 + 1e-6);
    assert_none(&flat);
    add(&few, vec3(1, 0, 0), 1);
    assert_none(&few);
    for (int i = 0; i < 8; i++) add(&cone, vec3(cos(i), 1, sin(i)), 0); /* all of them through the origin */
    assert_none(&cone);
}

/* ---- in scenes ---- */

/* A cut gem, of facets whose numbers count to 96 around it. */
#define CUT                                                                                                            \
    "let tiers = [[43, 3, -1, [3, 9, 15, 21, 27, 33, 39, 45, 51, 57, 63, 69, 75, 81, 87, 93]],"                        \
    "  [41, 3.05, -1, [0, 12, 24, 36, 48, 60, 72, 84]],"                                                               \
    "  [42, 3.35, 1, [3, 9, 15, 21, 27, 33, 39, 45, 51, 57, 63, 69, 75, 81, 87, 93]],"                                 \
    "  [37, 3.1, 1, [0, 12, 24, 36, 48, 60, 72, 84]], [0, 1.4, 1, [0]]] "                                              \
    "def facet(a, d, up, i) { let q = 360 * i / 96 "                                                                   \
    "  plane { normal = <sin(a) * cos(q), up * cos(a), sin(a) * sin(q)> distance = d } } "
#define FACETS "for (t in tiers) { for (i in t[3]) { facet(t[0], t[1], t[2], i) } } "
#define APART "for (t in tiers) { for (i in t[3]) { group { facet(t[0], t[1], t[2], i) } } } "
#define CUBE(before, after)                                                                                            \
    before "plane { normal = x distance = 1 } " after before "plane { normal = -x distance = 1 } " after before        \
           "plane { normal = y distance = 1 } " after before "plane { normal = -y distance = 1 } " after before        \
           "plane { normal = z distance = 1 } " after before "plane { normal = -z distance = 1 } " after

static void compile(Fixture *scene, const char *text, const char *view)
{
    char whole[4000];
    snprintf(whole, sizeof whole, "%s%s%s%s", FIXTURE_MEDIA, CUT, text, view);
    fixture_compile(scene, whole, 1);
}

/* How many operands there are, in all combinations. */
static void assert_operands(const char *text, const char *view, uint32_t n)
{
    Fixture scene;
    compile(&scene, text, view);
    if (scene.scene->n_operands != n) fail_msg("%u operands, not %u: %s", (unsigned)scene.scene->n_operands, n, text);
    fixture_clear(&scene);
}

static void planes_become_one(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        uint32_t n_operands;
    } cases[] = {
        {"intersection a { interior = glass " CUBE("", "") "}", 0},
        {"intersection a { interior = glass " FACETS "cylinder { from = <0, -6, 0> to = <0, 3, 0> radius = 4 } }", 2},
        {"intersection a { surface = surface { } " CUBE("", "") "sphere { radius = 1.2 } }", 2},
        {"difference a { interior = glass box { size = <2, 2, 2> } plane { normal = <1, 1, 1> } sphere { } }", 2},
        {"difference a { interior = glass sphere { } plane { normal = x } plane { normal = y } }", 3},
        {"union a { interior = glass intersection { " CUBE("", "") "} sphere { radius = 1.2 } }", 2},
        {"difference a { interior = glass intersection { " CUBE("", "") "} plane { normal = <1, 1, 1> } }", 0},
        {"intersection a { interior = glass intersection { " CUBE("", "") "rotate(y, 9) } plane { } sphere { } }", 2},
        {"intersection a { interior = glass intersection { " CUBE("", "") "sphere { } } plane { } }", 3},
        {"difference a { interior = glass box { size = <3, 1, 1> } intersection { " CUBE("", "") "} }", 2},
        {"union a { interior = glass " CUBE("", "") "}", 6},
        {"intersection a { interior = glass " CUBE("group { ", " }") "}", 6},
        {"intersection a { interior = glass box { size = <2, 2, 2> } box { size = <3, 3, 3> bevel = .1 } }", 2},
        {"intersection a { interior = glass box { size = <2, 2, 2> } box { size = <3, 1, 3> rotate(<1, 2, 3>) } }", 0},
        /* of surfaces of their own */
        {"intersection a { interior = glass " CUBE("", "") "plane { surface = surface { roughness = .2 } } }", 2},
        {"intersection a { surface = surface { albedo = checker { } } " CUBE("", "") "}", 6},
        {"intersection a { surface = surface { ior = 1.5 roughness = .3 anisotropy = .5 } " CUBE("", "") "}", 6},
        /* empty, without end, too few of them */
        {"intersection a { surface = surface { } " CUBE("", "") "plane { distance = -2 } sphere { } }", 8},
        {"intersection a { interior = glass plane { } plane { normal = x } plane { normal = z } "
         "plane { normal = -x distance = 1 } sphere { } }",
         5},
        {"intersection a { interior = glass plane { } plane { normal = x } plane { normal = z } sphere { } }", 4},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) assert_operands(cases[i].text, FIXTURE_VIEW, cases[i].n_operands);
}

#define SHUTTER " camera { from = <0, 0, 1000>  to = <0, 0, 0>  shutter = 180deg } environment { } "

static void what_may_move_stays(void **state)
{
    (void)state;
    assert_operands("intersection a { interior = glass " CUBE("", "") "}", SHUTTER, 0);
    assert_operands("intersection a { interior = glass " CUBE("", "") "translate(clock * x) }", SHUTTER, 6);
    assert_operands("intersection a { interior = glass " CUBE("", "") "translate(clock * x) }", FIXTURE_VIEW, 0);
}

/* A box around them is found where they have a body, also one so flat that no mesh is made of it. */
static void boxes_are_around_them(void **state)
{
    (void)state;
    Spaces cube = {0}, flat = {0}, endless = {0}, empty = {0}, cone = {0};
    Box3 box;
    add_cube(&cube, 2);
    Affine map = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {100, 0, -3}};
    move(&cube, &map);
    assert_true(half_spaces_box(cube.items, cube.n, &box));
    assert_true(fabs(box.min.x - 98) < 1e-9 && fabs(box.max.x - 102) < 1e-9 && fabs(box.max.z + 1) < 1e-9);
    add_cube(&flat, 1);
    add(&flat, vec3(1, 0, 0), -1 + 1e-6);
    assert_true(half_spaces_box(flat.items, flat.n, &box));
    assert_true(box.max.x < -1 + 2e-6 && fabs(box.max.y - 1) < 1e-6);
    add_cube(&endless, 1);
    endless.n--;
    assert_false(half_spaces_box(endless.items, endless.n, &box));
    add_cube(&empty, 1);
    add(&empty, vec3(1, 1, 0), -2);
    assert_true(half_spaces_box(empty.items, empty.n, &box) && box3_is_empty(box));
    assert_false(half_spaces_box(empty.items + 5, 2, &box));
    empty.items[1] = (HalfSpace){vec3(-1, 0, 0), -2};
    assert_true(half_spaces_box(empty.items, 2, &box) && box3_is_empty(box));
    for (int i = 0; i < 8; i++) add(&cone, vec3(cos(i), 1, sin(i)), 0);
    assert_false(half_spaces_box(cone.items, cone.n, &box));
}

static void assert_bounds(const char *text, const char *view, double volume, double width)
{
    Fixture scene;
    compile(&scene, text, view);
    uint32_t hull = scene.compiled->hull_of_object[fixture_object(&scene, "a")];
    Box3 box = scene.compiled->hull_bounds[hull];
    double found = scene.compiled->hulls[hull].volume;
    if (!(fabs(found - volume) <= 2e-3 * volume)) fail_msg("%s: %g and not %g", text, found, volume);
    if (!(fabs(box.max.x - box.min.x - width) < 1e-5)) fail_msg("%s: %g wide", text, box.max.x - box.min.x);
    assert_false(scene.compiled->unbounded[hull]);
    fixture_clear(&scene);
}

/* Planes that stay planes enclose as much, and reach as far wherever they move: so they are on top of the same. */
static void what_stays_has_an_end(void **state)
{
    (void)state;
    assert_bounds("intersection a { interior = glass " CUBE("", "") "translate(clock * x) }", SHUTTER, 8, 2.5);
    assert_bounds("intersection a { interior = glass " CUBE(
                      "", "") "} sphere { surface = surface { } center = <20 + clock, 0, 0> }",
                  SHUTTER, 8, 2);
    assert_bounds("intersection a { interior = glass " CUBE("group { ", " }") "}", FIXTURE_VIEW, 8, 2);
    assert_bounds("difference a { interior = glass plane { normal = x distance = 2 } union { plane { normal = x } "
                  "plane { distance = -1 } plane { normal = -y distance = -4 } } plane { normal = z } "
                  "plane { normal = -z distance = -1 } }",
                  FIXTURE_VIEW, 2 * 5 * 1, 2);
    assert_bounds("union a { interior = glass sphere { radius = .5 center = <2, 0, 0> } "
                  "intersection { " CUBE("group { ", " }") "} }",
                  FIXTURE_VIEW, 8 + pi / 6, 3.5);
}

static void the_whole_is_the_body(void **state)
{
    (void)state;
    Fixture scene;
    compile(&scene,
            "let a = intersection { interior = glass " CUBE(
                "", "") "} a one { } "
                        "a two { scale(<-1, 2, 3>) rotate(<10, 20, 30>) translate(<20, 0, 0>) priority = 3 } "
                        "difference lid { interior = water box { size = <4, 4, 4> } plane { distance = 1 } "
                        "translate(<0, 30, 0>) }",
            FIXTURE_VIEW);
    assert_int_equal(scene.scene->n_objects, 3);
    assert_int_equal(scene.scene->n_trees + scene.scene->n_operands + scene.scene->n_parts, 0);
    const uint32_t one = fixture_object(&scene, "one"), two = fixture_object(&scene, "two");
    const SceneObject *objects = scene.scene->objects;
    assert_int_equal(objects[one].shape, objects[two].shape);
    assert_true(fabs(objects[one].volume - 8) < 1e-6 && fabs(objects[two].volume - 48) < 1e-5);
    assert_true(fabs(objects[fixture_object(&scene, "lid")].volume - 16) < 1e-5);
    assert_int_equal(objects[two].priority, 3);
    fixture_clear(&scene);
}

/* ---- against operands of their own ---- */

/* All places along a line where a hull begins and ends. */
static size_t ends_along(Probe *probe, const Fixture *scene, Line line, double *ends, size_t most)
{
    size_t n = 0;
    if (!probe_surfaces(probe, scene->compiled, &line, 0)) return 0;
    probe_intervals(probe, scene->compiled, &line);
    for (uint32_t k = probe->first[0]; k != INTERVAL_NONE && n + 2 <= most; k = probe->intervals[k].next) {
        ends[n++] = probe->intervals[k].begin;
        ends[n++] = probe->intervals[k].end;
    }
    return n;
}

/* The lines of either scene meet the same, but for ones that pass by an edge. */
static void assert_same(const char *text, const char *apart)
{
    Fixture scenes[2];
    Probe probes[2];
    compile(&scenes[0], text, FIXTURE_VIEW);
    compile(&scenes[1], apart, FIXTURE_VIEW);
    assert_true(scenes[0].scene->n_operands < scenes[1].scene->n_operands);
    for (int i = 0; i < 2; i++)
        assert_int_equal(probe_init(&probes[i], scenes[i].compiled, &scenes[i].error), STATUS_OK);
    Dice dice = {77};
    int n_met = 0, n_other = 0;
    for (int i = 0; i < 40000; i++) {
        Vec3 to = dice_point(&dice, 5), direction = dice_direction(&dice);
        Line line = {.start = vec3_along(to, -30, direction), .direction = vec3f_from(direction), .length = 60};
        double ends[2][16];
        size_t n = ends_along(&probes[0], &scenes[0], line, ends[0], 16);
        bool same = n == ends_along(&probes[1], &scenes[1], line, ends[1], 16);
        for (size_t k = 0; same && k < n; k++) same = fabs(ends[0][k] - ends[1][k]) < 2e-4;
        n_met += n > 0;
        n_other += !same;
    }
    if (n_other > 3 || n_met < 1000) fail_msg("%d lines of %d differ: %s", n_other, n_met, text);
    for (int i = 0; i < 2; i++) {
        probe_clear(&probes[i]);
        fixture_clear(&scenes[i]);
    }
}

static void lines_meet_the_same(void **state)
{
    (void)state;
#define ROD "cylinder { from = <0, -6, 0> to = <0, 3, 0> radius = 4 } "
    assert_same("intersection a { interior = glass " FACETS ROD "}",
                "intersection a { interior = glass " APART ROD "}");
    assert_same("intersection a { interior = glass " FACETS ROD "scale(<-1, .7, 1.2>) rotate(<10, 20, 30>) }",
                "intersection a { interior = glass " APART ROD "scale(<-1, .7, 1.2>) rotate(<10, 20, 30>) }");
    assert_same("intersection a { interior = glass " ROD FACETS "sphere { radius = 3.8 } }",
                "intersection a { interior = glass " ROD APART "sphere { radius = 3.8 } }");
    assert_same(
        "union a { interior = glass sphere { radius = 2.5 } intersection { " FACETS ROD "} box { size = <1, 9, 1> } }",
        "union a { interior = glass sphere { radius = 2.5 } intersection { " APART ROD "} box { size = <1, 9, 1> } }");
    assert_same("intersection a { interior = glass " CUBE("", "") "scale(<2, 3, -1>) rotate(<50, 20, 30>) }",
                "intersection a { interior = glass " CUBE("group { ", "} ") "scale(<2, 3, -1>) rotate(<50, 20, 30>) }");
    assert_same("difference a { interior = glass box { size = <6, 6, 6> } cylinder { to = <0, 9, 0> radius = 1 } "
                "  plane { normal = <1, 2, 3> distance = -1 } plane { normal = <1, -1, -1> distance = -2 } }",
                "difference a { interior = glass box { size = <6, 6, 6> } cylinder { to = <0, 9, 0> radius = 1 } "
                "  group { plane { normal = <1, 2, 3> distance = -1 } } "
                "  group { plane { normal = <1, -1, -1> distance = -2 } } }");
    assert_same("difference a { interior = glass intersection { " FACETS
                "scale(1.1) rotate(<1, 2, 3>) translate(<1, 0, "
                "0>) } plane { normal = <1, 2, 3> distance = -1 } sphere { } translate(<0, .2, 0>) }",
                "difference a { interior = glass intersection { " APART "scale(1.1) rotate(<1, 2, 3>) translate(<1, 0, "
                "0>) } plane { normal = <1, 2, 3> distance = -1 } sphere { } translate(<0, .2, 0>) }");
    assert_same("difference a { interior = glass intersection { " FACETS "cylinder { from = <0, -6, 0> to = <0, 3, 0> "
                "radius = 4 } } sphere { center = <0, 2, 0> } }",
                "difference a { interior = glass intersection { " APART "cylinder { from = <0, -6, 0> to = <0, 3, 0> "
                "radius = 4 } } sphere { center = <0, 2, 0> } }");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cubes_are_exact),
        cmocka_unit_test(pyramids_have_one_point),
        cmocka_unit_test(faces_around_balls),
        cmocka_unit_test(moved_bodies_are_as_large),
        cmocka_unit_test(idle_planes_change_nothing),
        cmocka_unit_test(few_digits_are_enough),
        cmocka_unit_test(some_have_no_body),
        cmocka_unit_test(planes_become_one),
        cmocka_unit_test(what_may_move_stays),
        cmocka_unit_test(boxes_are_around_them),
        cmocka_unit_test(what_stays_has_an_end),
        cmocka_unit_test(the_whole_is_the_body),
        cmocka_unit_test(lines_meet_the_same),
    };
    return cmocka_run_group_tests_name("half_spaces", tests, NULL, NULL);
}
