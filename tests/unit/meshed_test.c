/* meshed_test.c - sweeps, superellipsoids, height fields and prisms as scenes say them: closed, as large as formulas
 * say, with normals that face outward; and what is refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/hash.h"
#include "near.h"
#include "scene_fixture.h"

static const double pi = 3.14159265358979323846;

#define M FIXTURE_MEDIA
#define V FIXTURE_VIEW
#define REFUSED(text, code) fixture_refused(M text V, code)

/* The triangles' own normals and those at their corners must agree; returns the largest angle between them, in
 * degrees. Slivers have no direction worth mentioning. */
static double worst_normal(const Mesh *mesh)
{
    double worst = 1, extent = 0;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        extent = fmax(extent, vec3_length(vec3_sub(vec3_from_f(mesh->positions[i]), vec3_from_f(mesh->positions[0]))));
    for (uint32_t i = 0; mesh->normals && i < mesh->n_triangles; i++) {
        const uint32_t *t = mesh->triangles[i];
        Vec3 a = vec3_from_f(mesh->positions[t[0]]), ab = vec3_sub(vec3_from_f(mesh->positions[t[1]]), a),
             ac = vec3_sub(vec3_from_f(mesh->positions[t[2]]), a), n = vec3_cross(ab, ac);
        double longest = fmax(vec3_length(vec3_sub(ac, ab)), fmax(vec3_length(ab), vec3_length(ac)));
        if (longest < 1e-4 * extent) continue; /* float has rounded it away */
        if (!(vec3_length(n) > 0.02 * longest * longest)) continue;
        for (int k = 0; k < 3; k++) worst = fmin(worst, vec3_dot(vec3_normalize(n), vec3_from_f(mesh->normals[t[k]])));
    }
    return acos(fmax(worst, -1)) * 180 / pi;
}

/* The only object of the scene: closed and of that volume, within a relative tolerance. */
static void check_volume(const char *text, double volume, double tolerance, double degrees)
{
    Fixture f;
    char whole[4096];
    snprintf(whole, sizeof whole, "%s%s%s", M, text, V);
    fixture_good(&f, whole);
    bool mended = f.diag.first && f.diag.first->code != D_FULL_BOUNDS;
    if (mended) fixture_print(&f);
    assert_false(mended);
    const Mesh *mesh = f.scene->shapes[f.scene->objects[0].shape].mesh;
    MeshReport report;
    assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
    if (!report.closed || fabs(report.volume / volume - 1) > tolerance)
        fail_msg("%s: closed %d, volume %.9g, not %.9g", text, report.closed, report.volume, volume);
    if (worst_normal(mesh) > degrees) fail_msg("%s: a normal is off by %g degrees", text, worst_normal(mesh));
    assert_near(f.scene->objects[0].volume, volume, tolerance * volume);
    fixture_clear(&f);
}

static void prisms(void **state)
{
    (void)state;
    check_volume("prism { interior = glass outline = [<0, 0>, <3, 0>, <3, 2>, <0, 2>] to = 5 }", 30, 1e-6, 1);
    check_volume("prism { interior = glass from = 5 to = -1 outline = [[<0, 0>, <4, 0>, <4, 4>, <0, 4>], [<1, 1>, <1, "
                 "2>, <2, 2>, "
                 "<2, 1>]] }",
                 90, 1e-6, 1);
    check_volume("prism { interior = glass to = 3 scale_to = 0 outline = [<-1, -1>, <1, -1>, <1, 1>, <-1, 1>] }", 4,
                 1e-6, 1);
    /* the inset of a square of 4: rounded at both ends */
    check_volume(
        "prism { interior = glass to = 2 bevel = .5 bevel_segments = 64 outline = [<0, 0>, <4, 0>, <4, 4>, <0, 4>] }",
        16 + 9 + 1.5 * pi + 2. / 3, 1e-4, 2);
    check_volume("prism { interior = glass smooth = true outline = [for (i in 0..<360) <2 * cos(i), 2 * sin(i)>] }",
                 4 * pi, 1e-4, 1);
    check_volume("prism { interior = glass curve = cubic outline = [for (i in 0..<32) <2 * cos(11.25 * i), 2 * "
                 "sin(11.25 * i)>] }",
                 4 * pi, 1e-3, 4);
}

/* The corners of a wall are numbered around it, whichever compiler built the program: the scene's hash has them in it. Its
 * two triangles share the first and the third. */
static void walls_are_numbered_in_order(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, M "prism { interior = glass outline = [<0, 0>, <3, 0>, <3, 2>, <0, 2>] to = 5 }" V);
    const Mesh *mesh = f.scene->shapes[f.scene->objects[0].shape].mesh;
    for (uint32_t wall = 0; wall < 4; wall++)
        for (uint32_t k = 0; k < 3; k++) {
            const uint32_t first = 4 * wall, *one = mesh->triangles[2 * wall], *other = mesh->triangles[2 * wall + 1];
            assert_true(one[k] == first || one[k] == first + 1 || one[k] == first + 2);
            assert_true(other[k] == first || other[k] == first + 2 || other[k] == first + 3);
        }
    fixture_clear(&f);
}

static void prisms_that_cannot_be(void **state)
{
    (void)state;
    REFUSED("prism { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("prism { interior = glass outline = [<0, 0>, <1, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [[]] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <1, 0>, <2, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>, <0, 2>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] to = 0 }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] scale_from = 0 scale_to = 0 }",
            D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] scale_to = .5 bevel = .1 }",
            D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] bevel = 3 to = 20 }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] bevel = .1 to = .1 }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] bevel_segments = 3 }",
            D_CONFLICTING_PROPERTIES);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>] tolerance = 3 }", D_CONFLICTING_PROPERTIES);
    REFUSED("prism { interior = glass outline = [<0, 0>, <2, 2>, <2, 0>, <1, 0>] curve = bezier }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass outline = [1, 2, 3] }", D_WRONG_TYPE);
    REFUSED("prism { interior = glass outline = [[<0, 0>, <1, 0>, <0, 1>], 2] }", D_WRONG_TYPE);
    REFUSED("prism { interior = glass outline = [[<0, 0>, <1, 0>, 3]] }", D_WRONG_TYPE);
    Fixture f; /* the message says where */
    fixture_text(&f, M
                 "prism { interior = glass outline = [[<9, 9>, <8, 9>, <9, 8>], [<0, 0>, <2, 2>, <2, 0>, <0, 2>]] }" V);
    const Diagnostic *report = fixture_find(&f, D_DEGENERATE_SHAPE);
    assert_non_null(report);
    assert_non_null(strstr(report->text, "<1, 1>: behind its point 0 of loop 1 and behind its point 2 of loop 1"));
    fixture_clear(&f);
}

/* What a message offers must be taken. */
static void bevels_that_are_said_to_fit_do(void **state)
{
    (void)state;
    static const char star[] = FIXTURE_MEDIA "prism { interior = glass curve = cubic outline = [for (i in 0..<10) (i "
                                             "%% 2 == 0 ? 2 : .9) * vec2(cos(36 * i), "
                                             "sin(36 * i))] to = 1.5 bevel = %s }" FIXTURE_VIEW;
    static const char *const tried[] = {".7", ".3", ".1", ".047", ".6"};
    for (size_t i = 0; i < sizeof tried / sizeof *tried; i++) {
        char text[1500], offer[20] = "";
        Fixture f;
        snprintf(text, sizeof text, star, tried[i]);
        fixture_text(&f, text);
        const Diagnostic *report = fixture_find(&f, D_DEGENERATE_SHAPE);
        const char *at = report ? strstr(report->text, "; one of ") : NULL;
        if (!at || sscanf(at, "; one of %19s fits", offer) != 1)
            fail_msg("%s: %s", tried[i], report ? report->text : "-");
        fixture_clear(&f);
        snprintf(text, sizeof text, star, offer);
        fixture_good(&f, text);
        fixture_clear(&f);
    }
}

static void sweeps(void **state)
{
    (void)state;
    /* a straight rod, a cone, a ring, a rod with a mitre, with round ends */
    check_volume("sweep { interior = glass path = [<0, 0, 0>, <3, 4, 0>] radius = .5 segments = 1000 curve = linear }",
                 5 * .25 * pi, 1e-4, 1);
    check_volume(
        "sweep { interior = glass path = [<0, 0, 0>, <0, 0, 3>] radius = [1, 0] segments = 1000 curve = linear }", pi,
        1e-4, 2);
    check_volume("sweep { interior = glass closed = true tolerance = .0002 radius = .5 "
                 "path = [for (i in 0..<64) <3 * cos(5.625 * i), 0, 3 * sin(5.625 * i)>] }",
                 2 * pi * pi * 3 * .25, 1e-3, 6);
    check_volume("sweep { interior = glass path = [<0, 0, 0>, <3, 0, 0>, <3, 0, 3>] radius = .5 segments = 1000 curve "
                 "= linear }",
                 6 * .25 * pi, 1e-4, 1);
    check_volume("sweep { interior = glass path = [<0, 0, 0>, <3, 0, 0>] radius = .5 segments = 1000 ends = round }",
                 3 * .25 * pi + 4. / 3 * pi * .125, 1e-4, 1);
    check_volume(
        "sweep { interior = glass closed = true path = [<0, 0, 0>, <4, 0, 0>, <4, 3, 0>, <0, 3, 0>] curve = linear "
        "outline = [<-.5, -.5>, <.5, -.5>, <.5, .5>, <-.5, .5>] }",
        14, 1e-6, 1);
    /* twisting keeps the area of each section, and so the volume */
    check_volume("sweep { interior = glass path = [<0, 0, 0>, <0, 0, 10>] twist = 720 tolerance = 1e-4 "
                 "outline = [<-1, -.5>, <1, -.5>, <1, .5>, <-1, .5>] }",
                 20, 5e-3, 12);
    /* a tube with a hole, around a whole turn */
    check_volume("sweep { interior = glass closed = true twist = 360 path = [for (i in 0..<64) <9 * cos(5.625 * i), 0, "
                 "9 * sin(5.625 * "
                 "i)>] outline = [[<-2, -2>, <2, -2>, <2, 2>, <-2, 2>], [<-1, -1>, <1, -1>, <1, 1>, <-1, 1>]] }",
                 2 * pi * 9 * 12, 1e-2, 10);
    /* a helix: its length times its section */
    check_volume("sweep { interior = glass radius = .2 tolerance = .0002 path = [for (i in 0..180) <cos(10 * i), i / "
                 "36, sin(10 * i)>] }",
                 pi * .04 * 5 * sqrt(4 * pi * pi + 1), 4e-3, 6);
}

/* The points that follow a twist along the sides of a flat end lie in a line, but for rounding: no triangle may have three of these. */
static void twisted_ends_do_not_cross(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        Fixture f;
        char text[600];
        snprintf(text, sizeof text,
                 M "sweep { interior = glass path = [for (k in 0..8) <%g * k, -6 + 1.5 * k, %g * k>] "
                   "outline = [<.5, -.3>, <4.6, -.12>, <4.8, 0>, <4.6, .12>, <.5, .3>] twist = %d tolerance = %g }" V,
                 i % 2 ? .3 : 0, i % 2 ? .7 : 0, 30 + 40 * i, i % 3 ? .004 : .0008);
        fixture_good(&f, text);
        MeshCrossings found;
        const Mesh *mesh = f.scene->shapes[f.scene->objects[0].shape].mesh;
        assert_int_equal(mesh_find_crossings(mesh, NULL, &found, NULL), STATUS_OK);
        if (found.n > 0) fail_msg("%s: %d crossings", text, (int)found.n);
        fixture_clear(&f);
    }
}

/* Points may lie unevenly: two long legs and a half circle of short steps between them make a tube, and an outline, without kinks. */
static void uneven_points_make_smooth_curves(void **state)
{
    (void)state;
#define U_TURN "[<-2, 0, 0>] + [for (i in 0..6) <2 * cos(180 - 30 * i), 10 + 2 * sin(180 - 30 * i), 0>] + [<2, 0, 0>]"
    check_volume("sweep { interior = glass radius = .2 path = " U_TURN " }", pi * 0.04 * (20 + 2 * pi), 0.01, 8);
#undef U_TURN
    check_volume("prism { interior = glass curve = cubic to = 1 outline = [<-2, -10>] + "
                 "[for (i in 0..6) <2 * cos(180 - 30 * i), 10 + 2 * sin(180 - 30 * i)>] + "
                 "[for (i in 0..6) <2 * cos(30 * i), -10 - 2 * sin(30 * i)>] }",
                 80 + 4 * pi, 0.1, 8); /* long sides bulge a little */
}

/* Natural curves through four points of a circle: area 61/20; points that stand there twice are corners, also the first, and what
 * is between two of them is straight. A ring through four points is as long as quadrature says. */
static void natural_curves(void **state)
{
    (void)state;
    check_volume("prism { interior = glass curve = natural to = 2 tolerance = 2e-6 outline = [<1, 0>, <0, 1>, <-1, 0>, "
                 "<0, -1>] }",
                 2 * 61. / 20, 1e-5, 5);
    check_volume("prism { interior = glass curve = natural outline = [<1, 0>, <1, 0>, <0, 1>, <0, 1>, <-1, 0>, <-1, "
                 "0>, <0, -1>, <0, -1>] }",
                 2, 1e-6, 1);
    check_volume("prism { interior = glass curve = natural outline = [<0, -1>, <0, -1>, <1, 0>, <0, 1>, <0, 1>] "
                 "tolerance = 2e-6 }",
                 1.25, 1e-5, 5);
    double length = 0; /* of the four cubics, by the midpoint rule */
    for (int i = 0; i < 10000; i++) {
        double t = (i + 0.5) / 10000, x = -1.5 * (1 - (1 - t) * (1 - t)), y = 1.5 * (1 - t * t);
        length += 4 * hypot(x, y) / 10000;
    }
    check_volume("sweep { interior = glass curve = natural closed = true radius = .1 tolerance = 2e-6 "
                 "path = [<1, 0, 0>, <0, 0, 1>, <-1, 0, 0>, <0, 0, -1>] }",
                 length * pi * 0.01, 1e-4, 3);
    /* radii as the path: 1, 0, 1 at even steps, r = 1 - (3 t - t^3) / 2 up to the middle */
    double volume = 0;
    for (int i = 0; i < 10000; i++) {
        double t = (i + 0.5) / 10000, r = 1 - (3 * t - t * t * t) / 4;
        volume += 2 * pi * r * r / 10000;
    }
    check_volume("sweep { interior = glass curve = natural radius = [1, .5, 1] tolerance = 1e-5 path = [<0, -1, 0>, "
                 "<0, 0, 0>, <0, 1, 0>] }",
                 volume, 1e-4, 6);
    REFUSED("prism { interior = glass curve = natural outline = [<0, 0>, <1, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass curve = natural outline = [<0, 0>, <0, 0>, <0, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass curve = natural outline = [<0, 0>, <1, 0>, <0, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("prism { interior = glass curve = natural outline = [<0, 0>, <1, 0>, <1, 0>, <0, 0>] }",
            D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass curve = natural path = [<0, 0, 0>, <1, 0, 0>, <1, 0, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass curve = natural path = [<0, 0, 0>] }", D_DEGENERATE_SHAPE);
}

/* A thread has few triangles, a tube that is as thick as it is long has many; said by their tolerances. */
static void threads_have_few_triangles(void **state)
{
    (void)state;
    static const struct {
        double radius, tolerance;
    } cases[] = {{.04, .0004}, {.5, .002}, {10, .01}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        uint32_t n[2];
        for (int said = 0; said < 2; said++) {
            Fixture f;
            char text[1024], tolerance[64] = "";
            if (said) snprintf(tolerance, sizeof tolerance, "tolerance = %g", cases[i].tolerance);
            snprintf(text, sizeof text,
                     M "sweep { interior = glass radius = %g %s path = [<0, 0, 0>, <10, 2, 0>, <20, 0, 0>] }" V,
                     cases[i].radius, tolerance);
            fixture_good(&f, text);
            n[said] = f.scene->shapes[f.scene->objects[0].shape].mesh->n_triangles;
            fixture_clear(&f);
        }
        assert_int_equal(n[0], n[1]);
        assert_true(i > 0 || n[0] < 5000); /* 22,000 by a 1000th of the radius */
    }
}

#define SQUARE "outline = [<-1, -1>, <1, -1>, <1, 1>, <-1, 1>]"

static void sweeps_that_cannot_be(void **state)
{
    (void)state;
    REFUSED("sweep { interior = glass path = [<0, 0, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <0, 0, 0>] }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>] closed = true }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>] radius = 0 }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>] radius = [1, 2, 3] }", D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>, <0, 0, 0>] " SQUARE " radius = .1 curve = linear }",
            D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass radius = 2 " SQUARE " path = [for (i in 0..9) <cos(20 * i), sin(20 * i), 0>] }",
            D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass radius = 2 " SQUARE " curve = linear path = [<0, 0, 0>, <1, 0, 0>, <1, 1, 0>] }",
            D_DEGENERATE_SHAPE);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>] twist = 5 }", D_CONFLICTING_PROPERTIES);
    REFUSED("sweep { interior = glass path = [<0, 0, 0>, <1, 0, 0>] ends = round outline = [<0, 0>, <1, 0>, <0, 1>] }",
            D_CONFLICTING_PROPERTIES);
    REFUSED("sweep { interior = glass closed = true twist = 90 path = [<0, 0, 0>, <9, 0, 0>, <9, 9, 0>] outline = [<0, "
            "0>, <1, 0>, <0, "
            "1>] }",
            D_DEGENERATE_SHAPE);
}

/* Round ones are the union of their pieces. */
static void sweeps_that_meet_themselves(void **state)
{
    (void)state;
    const double edges = 120; /* normals are smooth across them */
    /* a ring that is thicker than its hole: twice the integral over x of x times the height of its section */
    check_volume("sweep { interior = glass radius = 1 closed = true tolerance = .001 path = [for (i in 0..<36) <.5 * "
                 "cos(10 * i), .5 * sin(10 * i), 0>] }",
                 4 * pi * (pow(.75, 1.5) / 3 + .5 * (pi / 4 + .5 * (.5 * sqrt(.75) + pi / 6))), 0.002, edges);
    /* there and back, with a ball where it turns */
    check_volume(
        "sweep { interior = glass radius = .5 ends = round curve = linear tolerance = .0005 path = [<0, 0, 0>, "
        "<4, 0, 0>, <0, 0, 0>] }",
        pi + pi / 6, 0.002, edges);
    /* where two of its parts cross, at right angles, they have J. Steinmetz's solid in common; mitres keep the volume */
    check_volume("sweep { interior = glass radius = .5 curve = linear tolerance = .0005 path = [<-3, 0, 0>, <3, 0, 0>, "
                 "<3, 6, 0>, <0, 6, 0>, <0, -3, 0>] }",
                 6 * pi - 2. / 3, 0.002, edges);
    /* a cone between two balls would not have that radius half way */
    check_volume("sweep { interior = glass radius = [1, .5, 1] ends = flat curve = linear tolerance = .001 path = "
                 "[<0, 0, 0>, <2, 0, 0>, <0, 0, 0>] }",
                 pi * 7. / 6 + 2. / 3 * pi / 8, 0.002, edges);
}

/* The first object of a scene is a closed mesh that needed no mending, or was refused as degenerate: false. */
static bool closed_or_refused(const char *text)
{
    Fixture f;
    fixture_text(&f, text);
    bool made = f.status == STATUS_OK;
    if (made) {
        MeshReport report;
        const Mesh *mesh = f.scene->shapes[f.scene->objects[0].shape].mesh;
        assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
        if (!report.closed || report.volume <= 0 || fixture_find(&f, D_MESH_MENDED)) fail_msg("%s", text);
    } else if (!fixture_find(&f, D_DEGENERATE_SHAPE)) {
        fixture_print(&f);
        fail_msg("%s", text);
    }
    fixture_clear(&f);
    return made;
}

/* Random paths and outlines: what is made is closed. */
static void sweeps_of_all_kinds(void **state)
{
    (void)state;
    uint64_t seed = 7;
    int n_made = 0;
    for (int round = 0; round < 400; round++) {
        char text[4096], path[2048] = "";
        int n = 3 + round % 6;
        for (int i = 0; i < n; i++) {
            double p[3];
            for (int k = 0; k < 3; k++) p[k] = 10 * hash_to_unit(seed = hash_u64(seed));
            snprintf(path + strlen(path), sizeof path - strlen(path), "<%g, %g, %g>, ", p[0], p[1], p[2]);
        }
        snprintf(text, sizeof text, M "sweep { interior = glass path = [%s] %s curve = %s %s tolerance = .02 }" V, path,
                 round % 3 ? "radius = .15" : "outline = [[<-.2, -.2>, <.2, -.2>, <0, .2>]]",
                 round % 5 ? "cubic" : "linear",
                 round % 2   ? "closed = true"
                 : round % 3 ? "ends = round"
                             : "twist = 90");
        if (round % 6 == 3) continue;
        n_made += closed_or_refused(text);
    }
    assert_true(n_made > 120);
}

static double beta(double a, double b)
{
    return tgamma(a) * tgamma(b) / tgamma(a + b);
}

static void superellipsoids(void **state)
{
    (void)state;
    static const double exponents[] = {0.01, 0.1, 0.25, 0.5, 1, 1.5, 2, 3};
    for (size_t i = 0; i < COUNT_OF(exponents); i++)
        for (size_t k = 0; k < COUNT_OF(exponents); k++) {
            char text[200];
            double e = exponents[i], n = exponents[k];
            snprintf(text, sizeof text, "superellipsoid { interior = glass exponents = <%g, %g> radius = <3, 2, 1> }",
                     e, n);
            double volume = 2 * 6 * e * n * beta(n / 2 + 1, n) * beta(e / 2, e / 2);
            bool convex = e <= 2 && n <= 2; /* cusps have no normals to speak of */
            check_volume(text, volume, 4e-3, convex && e > 0.05 && n > 0.05 ? 12 : 180);
        }
    REFUSED("superellipsoid { interior = glass exponents = <0, 1> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("superellipsoid { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("superellipsoid { interior = glass exponents = <.5, .5> tolerance = 1e-7 }", D_DEGENERATE_SHAPE);
}

static void height_fields(void **state)
{
    (void)state;
    check_volume("height_field { interior = ice heights = [[1, 1], [1, 1]] base = 0 size = <2, 3, 4> }", 24, 1e-6, 1);
    check_volume("height_field { interior = ice heights = [[0, 1], [0, 1]] base = -1 size = <2, 3, 4> }", 36, 1e-6, 1);
    check_volume("height_field { interior = ice heights = [[0, 1], [0, 1]] size = <2, 3, 4> smooth = false }", 14.4,
                 1e-6, 1);
    /* z = x^2 + y^2 over the unit square, on a slab of 1 */
    check_volume("height_field { interior = ice heights = [for (k in 0..64) [for (i in 0..64) (i ^ 2 + k ^ 2) / 4096]] "
                 "base = -1 }",
                 1 + 2. / 3, 1e-3, 3);
    REFUSED("height_field { interior = ice }", D_MISSING_PROPERTY);
    REFUSED("height_field { interior = ice heights = [[0, 1]] }", D_DEGENERATE_SHAPE);
    REFUSED("height_field { interior = ice heights = [[0], [1]] }", D_DEGENERATE_SHAPE);
    REFUSED("height_field { interior = ice heights = [] }", D_DEGENERATE_SHAPE);
    REFUSED("height_field { interior = ice heights = [[0, 1], [0, 1, 2]] }", D_DEGENERATE_SHAPE);
    REFUSED("height_field { interior = ice heights = [[0, 1], [0, -1]] }", D_DEGENERATE_SHAPE);
    REFUSED("height_field { interior = ice heights = [0, 1] }", D_WRONG_TYPE);
    REFUSED("height_field { interior = ice image = \"no-such-file.png\" }", D_FILE_NOT_FOUND);
}

/* The area of a glyph is that of its outline: a ring for "o"; a bar for "l", and so on. What is checked here is what
 * any font does. */
static void texts(void **state)
{
    (void)state;
    Fixture f;
    double volume[4];
    static const char *const words[] = {"o", "oo", "o\\no o", "\\u{e9}\\u{c5}8&Q\\u{d8}"};
    for (int i = 0; i < 4; i++) {
        char text[1000];
        snprintf(text, sizeof text, M "text { interior = glass size = 10 depth = 2 text = \"%s\" } " V, words[i]);
        fixture_good(&f, text);
        assert_null(f.diag.first);
        volume[i] = f.scene->objects[0].volume;
        const Mesh *mesh = f.scene->shapes[f.scene->objects[0].shape].mesh;
        MeshReport report;
        assert_int_equal(mesh_inspect(mesh, NULL, &report, NULL), STATUS_OK);
        assert_true(report.closed && report.n_degenerate == 0);
        if (worst_normal(mesh) > 8) fail_msg("normals are off by %g degrees", worst_normal(mesh));
        assert_near(report.bounds.max.z, 0, 0);
        assert_near(report.bounds.min.z, -2, 1e-6);
        fixture_clear(&f);
    }
    assert_near(volume[1], 2 * volume[0], 1e-3 * volume[0]);
    assert_near(volume[2], 3 * volume[0], 1e-3 * volume[0]);
    assert_true(volume[0] > 5 && volume[0] < 80 && volume[3] > 0);
    fixture_good(&f, M "text { interior = glass size = 10 bevel = .1 text = \"Qg\" align = right } " V);
    assert_null(f.diag.first);
    fixture_clear(&f);
    REFUSED("text { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("text { interior = glass text = \"\" }", D_DEGENERATE_SHAPE);
    REFUSED("text { interior = glass text = \"  \" }", D_DEGENERATE_SHAPE);
    REFUSED("text { interior = glass text = \"\\u{10fff0}\" }", D_DEGENERATE_SHAPE);
    REFUSED("text { interior = glass text = \"a\" bevel = 1 }", D_DEGENERATE_SHAPE);
    REFUSED("text { interior = glass text = \"a\" font = \"there-is-no-such-font\" }", D_FILE_NOT_FOUND);
    REFUSED("text { interior = glass text = \"a\" font = \"/etc/passwd\" }", D_DEGENERATE_SHAPE);
}

static void blobs(void **state)
{
    (void)state;
    /* one ball: (1 - d^2)^2 = t at d = sqrt(1 - sqrt(t)) */
    double d = sqrt(1 - sqrt(.5));
    check_volume("blob { interior = water  tolerance = .0005 sphere { radius = 2 center = <5, 6, 7> } }",
                 4. / 3 * pi * 8 * d * d * d, 1e-3, 30);
    check_volume("blob { interior = water  tolerance = .0005 sphere { scale(<1, 2, 3>) } }",
                 4. / 3 * pi * 6 * d * d * d, 3e-3, 60);
    check_volume("blob { interior = water  tolerance = .0005 cylinder { from = <0, 0, 0> to = <1, 2, 2> } }",
                 pi * d * d * 3 + 4. / 3 * pi * d * d * d, 1e-3, 30);
    /* two far from each other, one that is taken away, and a threshold */
    double c = sqrt(1 - sqrt(.1));
    check_volume("blob { interior = water  threshold = .1 tolerance = .0005 sphere { } sphere { center = <4, 0, 0> } "
                 "sphere { center = <4, 9, 0> strength = "
                 "-1 } }",
                 8. / 3 * pi * c * c * c, 1e-3, 30);
    REFUSED("blob { interior = water }", D_DEGENERATE_SHAPE);
    REFUSED("blob { interior = water sphere { strength = -1 } }", D_DEGENERATE_SHAPE);
    REFUSED("blob { interior = water sphere { strength = .4 } }", D_DEGENERATE_SHAPE);
    REFUSED("blob { interior = water sphere { interior = glass } }", D_CONFLICTING_PROPERTIES);
    REFUSED("blob { interior = water box { size = 1 } }", D_WRONG_TYPE);
    REFUSED("blob { interior = water cone { } }", D_MISPLACED);
    REFUSED("sphere { interior = water strength = 2 }", D_CONFLICTING_PROPERTIES);
}

/* Whatever flows together is closed. */
static void blobs_of_all_kinds(void **state)
{
    (void)state;
    uint64_t seed = 11;
    int n_made = 0;
    for (int round = 0; round < 60; round++) {
        char text[8000];
        snprintf(text, sizeof text, M "blob { interior = water tolerance = .05");
        int n = 1 + round % 12;
        for (int i = 0; i < n; i++) {
            double r[8];
            for (int k = 0; k < 8; k++) r[k] = hash_to_unit(seed = hash_u64(seed));
            size_t at = strlen(text);
            if (i % 3 == 2)
                snprintf(text + at, sizeof text - at,
                         " cylinder { from = <%g, %g, %g> to = <%g, %g, %g> radius = %g strength = %g }", 4 * r[0],
                         4 * r[1], 4 * r[2], 4 * r[3], 4 * r[4], 4 * r[5], .2 + r[6], 2 * r[7] - .7);
            else
                snprintf(text + at, sizeof text - at, " sphere { center = <%g, %g, %g> radius = %g strength = %g }",
                         4 * r[0], 4 * r[1], 4 * r[2], .3 + r[6], i ? 2 * r[7] - .5 : 1);
        }
        snprintf(text + strlen(text), sizeof text - strlen(text), " }" V);
        n_made += closed_or_refused(text);
    }
    assert_true(n_made > 40);
}

static void isosurfaces(void **state)
{
    (void)state;
    check_volume("def f(p) = length(p) - .8  isosurface { interior = ice  function = f }", 4. / 3 * pi * .512, 2e-3,
                 30);
    check_volume("def f(x, y, z) = x ^ 2 + y ^ 2 isosurface { interior = ice  function = f threshold = .25 }",
                 pi * .25 * 2, 2e-3, 30);
    /* everything is inside: the bounds themselves */
    check_volume("def f(p) = -1 isosurface { interior = ice function = f from = <0, 0, 0> to = <1, 2, 3> }", 6, 1e-6,
                 1);
    /* a slope, cut by the bounds */
    check_volume("def f(p) = p.y - p.x / 2 isosurface { interior = ice function = f cells = 7 }", 4, 1e-5, 1);
    /* jumps, where they are exactly; from above, from below, and through values that are the threshold */
    check_volume("def f(p) = p.x > .3 ? 1 : -1 isosurface { interior = ice function = f }", 5.2, 1e-5, 1);
    check_volume("def f(x, y, z) = floor(x * 10) - 3 isosurface { interior = ice function = f }", 5.2, 1e-5, 1);
    check_volume("def f(x, y, z) = floor((x + y / 2) * 10) isosurface { interior = ice function = f }", 4, 1e-5, 1);
    check_volume("def f(p) = length(p) < .8 ? -1 : 1 isosurface { interior = ice  function = f }", 4. / 3 * pi * .512,
                 2e-3, 30);
    /* a function within a macro sees its names as they are where it is used */
    check_volume("def ball(r) { def f(p) = length(p) - r  isosurface { interior = ice function = f } } ball(.5)",
                 pi / 6, 3e-3, 30);
    Fixture f;
    fixture_good(&f,
                 M "for (i in 1..3) { def f(p) = length(p) - .2 * i  isosurface { interior = ice  function = f } }" V);
    for (uint32_t i = 0; i < 3; i++)
        assert_near(f.scene->objects[i].volume, 4. / 3 * pi * pow(.2 * (i + 1), 3), .01 * pow(i + 1, 3));
    fixture_clear(&f);
    /* one mesh for all instances, whatever they are made of */
    fixture_good(&f, M "def f(p) = length(p) - .8  let ball = isosurface { interior = ice  function = f }"
                       "ball { } ball { interior = glass translate(<3, 0, 0>) }"
                       "ball { interior = none surface = surface { albedo = .1 } translate(<6, 0, 0>) }"
                       "ball { cells = 20 translate(<9, 0, 0>) }" V);
    assert_int_equal(f.scene->n_objects, 4);
    assert_int_equal(f.scene->n_shapes, 2);
    fixture_clear(&f);
    /* and for those of a loop, where the function computes the same in all its turns; another for each radius */
    fixture_good(&f, M "def f(p) = length(p) - .8 + .1 * noise(9 * p)\n"
                       "for (i in 0..5) { isosurface { interior = ice  function = f  translate(<3 * i, 0, 0>) } }\n"
                       "for (i in 0..5) { def g(p) = length(p) - .8 - .01 * floor(i / 2)\n"
                       "  isosurface { interior = ice  function = g  translate(<3 * i, 9, 0>) } }" V);
    assert_int_equal(f.scene->n_objects, 12);
    assert_int_equal(f.scene->n_shapes, 4);
    fixture_clear(&f);
    REFUSED("isosurface { interior = ice }", D_MISSING_PROPERTY);
    REFUSED("isosurface { interior = ice function = 3 }", D_WRONG_TYPE);
    REFUSED("isosurface { interior = ice function = sin }", D_UNKNOWN_NAME);
    REFUSED("def f(a, b) = 1 isosurface { interior = ice function = f }", D_WRONG_TYPE);
    REFUSED("def f(p) = p isosurface { interior = ice function = f }", D_WRONG_TYPE);
    REFUSED("def f(p) = 1 / (p.x - p.x) isosurface { interior = ice function = f }", D_BAD_NUMBER);
    /* at the points of the grid it has values, and none at some between them */
    REFUSED("def f(p) = p.y - .515 + 0 * sqrt(.25 - abs(frac(24 * p.y + .5) - .5)) isosurface { interior = ice "
            "function = f }",
            D_BAD_NUMBER);
    REFUSED("def f(p) = 1 isosurface { interior = ice function = f }", D_DEGENERATE_SHAPE);
    REFUSED("def f(p) = f(p) isosurface { interior = ice function = f }", D_TOO_DEEP);
    REFUSED("def f(p) { sphere { interior = ice } } isosurface { interior = ice function = f }", D_WRONG_TYPE);
    REFUSED("def f(p) = -1 isosurface { interior = ice function = f from = <1, 1, 1> }", D_DEGENERATE_SHAPE);
}

static void equal_shapes_are_one(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(
        &f,
        M "def p(h, x) { prism { interior = glass to = h outline = [<0, 0>, <1, 0>, <0, 1>] translate(<x, 0, 0>) } }"
          "p(1, 0) p(1, 5) p(2, 10)"
          "prism { interior = water outline = [[<0, 0>, <1, 0>, <0, 1>]] }" V);
    assert_int_equal(f.scene->objects[0].shape, f.scene->objects[1].shape);
    assert_int_not_equal(f.scene->objects[0].shape, f.scene->objects[2].shape);
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(prisms),
        cmocka_unit_test(walls_are_numbered_in_order),
        cmocka_unit_test(prisms_that_cannot_be),
        cmocka_unit_test(bevels_that_are_said_to_fit_do),
        cmocka_unit_test(sweeps),
        cmocka_unit_test(twisted_ends_do_not_cross),
        cmocka_unit_test(uneven_points_make_smooth_curves),
        cmocka_unit_test(natural_curves),
        cmocka_unit_test(threads_have_few_triangles),
        cmocka_unit_test(sweeps_that_cannot_be),
        cmocka_unit_test(sweeps_that_meet_themselves),
        cmocka_unit_test(sweeps_of_all_kinds),
        cmocka_unit_test(superellipsoids),
        cmocka_unit_test(height_fields),
        cmocka_unit_test(texts),
        cmocka_unit_test(blobs),
        cmocka_unit_test(blobs_of_all_kinds),
        cmocka_unit_test(isosurfaces),
        cmocka_unit_test(equal_shapes_are_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
