/* geometry_test.c - what scenes ask of the shape of their nodes: closed forms, instances, groups, and clear
 * refusals. The scenes check the answers themselves, with assert().
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "lang_fixture.h"
#include "scene_fixture.h"

#define V FIXTURE_VIEW

/* What the scenes below are written with. */
#define HEADER                                                                                                         \
    "meniscus 1.0 unit mm "                                                                                            \
    "def near(a, b, within = 1e-12) = distance(vec3(a), vec3(b)) <= within "                                           \
    "def point(seed, i) = 2 * <rnd(seed, i, 0), rnd(seed, i, 1), rnd(seed, i, "                                        \
    "2)> - <1, 1, 1> "

#define HOLDS(text) holds(HEADER text V)
#define REFUSED(text, code) fixture_refused(HEADER text V, code)

static void holds(const char *text)
{
    Fixture f;
    fixture_good(&f, text);
    fixture_clear(&f);
}

/* ---- bounds ---- */

static void bounds_are_tight(void **state)
{
    (void)state;
    HOLDS("let b = bounds(sphere { center = <1, 2, 3>  radius = 2 }) "
          "assert(b.min == <-1, 0, 1> and b.max == <3, 4, 5> and b.center == <1, 2, 3> and b.size == <4, 4, 4>)"
          /* a disc of radius r at right angles to n reaches r * sqrt(1 - n.x^2) along x */
          "let n = normalize(<1, 2, 3>)  let c = bounds(cylinder { from = <0, 0, 0>  to = 4 * n  radius = 2 }) "
          "for (i in 0..2) { let r = 2 * sqrt(1 - n[i] ^ 2) "
          "assert(abs(c.min[i] + r) < 1e-12 and abs(c.max[i] - 4 * n[i] - r) < 1e-12) } "
          "let ring = bounds(torus { radius = 3  tube = 1  rotate(z, 30)  translate(x) }) "
          "assert(near(ring.size, <6 * cos(30) + 2, 5, 8>) and near(ring.center, x)) "
          "let box = box { size = <1, 2, 3>  rotate(y, 90) } assert(near(bounds(box).size, <3, 2, 1>)) "
          "assert(near(bounds(box { scale(2)  translate(x) }).max, <4, 2, 1>)) "
          "assert(near(bounds(mesh { positions = [<0, 0, 0>, <5, 0, 0>, <0, 6, 0>]  triangles = [<0, 1, 2>] "
          "}).max, <5, 6, 0>))");
}

static void groups_join_what_they_hold(void **state)
{
    (void)state;
    HOLDS("let ball = sphere { } let g = group { ball { translate(3 * x) }  group { ball { scale(2) "
          "}  translate(y) }   light { shape = sphere  radius = 50  from = <0, 900, 0> }  rotate(z, 90) } "
          "assert(near(bounds(g).min, <-3, -2, -2>) and near(bounds(g).max, <1, 4, 2>)) "
          "assert(inside(g, <0, 3, 0>) and inside(g, <-1, -1, 0>) and not inside(g, <3, 3, 0>)) "
          "assert(len(hits(g, <0, 9, 0>, -y)) == 4) assert(near(volume(g), 4 / 3 * pi * 9, 1e-9)) "
          "let nothing = group { } "
          "assert(not inside(nothing, x) and hit(nothing, x, y) == none and volume(nothing) == 0)let here = "
          "group { sphere one { surface = surface { } } translate(y) }here { }");
}

/* ---- points ---- */

static void points_are_inside_or_not(void **state)
{
    (void)state;
    HOLDS("let ball = sphere { center = <.1, 0, 0>  radius = .8 } "
          "let egg = ball { scale(<1, 1.2, .5>)  rotate(x, 20) } "
          "let cup = lathe { profile = [<0, -1>, <.9, -1>, <.9, .8>, <.7, .8>, <.7, -.7>, <0, -.7>] } "
          "let brick = box { size = <1, 1.5, .5>  rotate(<10, 20, 30>) } "
          "let back = inverse(transform(rotate(<10, 20, 30>))) "
          "let undo = inverse(transform(scale(<1, 1.2, .5>), rotate(x, 20))) for (i in 1..5000) { "
          "let p = point(1, i)  let r = length(p.xz)  let q = apply(back, p) "
          "assert(inside(ball, p) == (distance(p, <.1, 0, 0>) < .8)) "
          "assert(inside(egg, p) == (distance(apply(undo, p), <.1, 0, 0>) < .8)) "
          "assert(inside(cup, p) == (r < .9 and p.y > -1 and p.y < .8 and (r > .7 or p.y < -.7))) "
          "assert(inside(brick, p) == (abs(q.x) < .5 and abs(q.y) < .75 and abs(q.z) < .25)) }");
}

static void a_ground_is_solid_below(void **state)
{
    (void)state;
    HOLDS("let g = ground { y = 3 } assert(inside(g, <1000, 2.999, 0>) and not inside(g, <0, 3.001, 0>)) "
          "assert(hit(g, <5, 10, 6>, -y).point == <5, 3, 6> and hit(g, <5, 10, 6>, y) == none) "
          "let hill = group { g { } sphere { center = <0, 3, 0>  radius = 2 } } "
          "assert(inside(hill, <0, 4.9, 0>) and not inside(hill, <0, 5.1, 0>) and hit(hill, <0, 9, 0>, "
          "-y).distance == 4)");
}

/* ---- rays ---- */

static void rays_meet_surfaces_in_double(void **state)
{
    (void)state;
    HOLDS("let c = <.3, .2, .1>  let ball = sphere { center = c  radius = 1 } "
          "let far = ball { translate(<50, 0, 0>)  rotate(y, 33) } "
          "let brick = box { size = <2, 2, 2>  rotate(z, 30) } "
          "let to_far = transform(translate(<50, 0, 0>), rotate(y, 33)) var n = 0 for (i in 1..3000) { "
          "let from = 5 * normalize(point(1, i)) + c  let d = normalize(point(2, i) * .9 - from + c) "
          "let b = dot(from - c, d)  let inner = b ^ 2 - (25 - 1)  let h = hit(ball, from, 7 * d) "
          "assert((h != none) == (inner > 0 and b < 0))   if (h != none) { n := n + 1 "
          "assert(near(h.distance, -b - sqrt(inner), 1e-11)) "
          "assert(near(h.point, from + d * h.distance))     assert(near(h.normal, h.point - c, 1e-11)) "
          "let turned = apply(to_far, <0, 0, 0>) "
          "let g = hit(far, apply(to_far, from), apply(to_far, d) - turned) "
          "assert(near(g.point, apply(to_far, h.point), 1e-9) and near(g.normal, apply(to_far, h.normal) - "
          "turned, 1e-9)) }   let k = hit(brick, 5 * normalize(point(3, i)), -point(3, i)) "
          "let q = apply(rotate(z, -30), k.point)   assert(near(max(abs(q.x), abs(q.y), abs(q.z)), 1, 1e-11)) } "
          "assert(n > 1000)");
}

static void all_hits_come_in_order(void **state)
{
    (void)state;
    HOLDS("let cup = lathe { profile = [<0, 0>, <20, 0>, <20, 50>, <18, 50>, <18, 2>, <0, 2>] } "
          "assert([for (h in hits(cup, <-50, 25, 0>, x)) h.distance] == [30, 32, 68, 70]) "
          "assert([for (h in hits(cup, <-50, 25, 0>, 9 * x)) h.normal.x] == [-1, 1, -1, 1]) "
          "assert(len(hits(cup, <-50, 60, 0>, x)) == 0) "
          /* through the diagonals of a box's faces: an edge that two triangles share is one surface */
          "let brick = box { size = <2, 2, 2> } for (i in -9..9) { "
          "assert(len(hits(brick, <.1 * i, 5, .1 * i>, -y)) == 2) }");
}

/* ---- places on a surface ---- */

static void places_are_spread_by_area(void **state)
{
    (void)state;
    HOLDS("let c = cylinder { from = <0, 0, 0>  to = <0, 4, 0>  radius = 1  scale(<1, .5, 1>)  translate(<10, "
          "0, 0>) } let n = 20000  var caps = 0  var middle = <0, 0, 0> for (i in 1..n) { "
          "let s = scatter(c, 5, i)   if (abs(s.normal.y) > .5) { caps := caps + 1 } "
          "let r = distance(s.point.xz, <10, 0>) "
          "assert(r < 1 + 1e-9 and (abs(r - 1) < 1e-9 or abs(s.point.y * (2 - s.point.y)) < 1e-9)) "
          "assert(abs(s.normal.y) > .5 or near(s.normal, <s.point.x - 10, 0, s.point.z>, 1e-9))   middle := "
          "middle + s.point / n } "
          /* two caps of pi and a wall of 4 pi: a third, to within four standard deviations */
          "assert(abs(caps / n - 1 / 3) < 4 * sqrt(1 / 3 * 2 / 3 / n)) assert(near(middle, <10, 1, 0>, .03)) "
          "assert(scatter(c, 5, 1) == scatter(c, 5, 1) and scatter(c, 5, 1) != scatter(c, 5, 2))");
}

static void directions_are_aligned(void **state)
{
    (void)state;
    HOLDS("for (i in 1..100) { let a = point(1, i)  let b = i % 10 == 0 ? -2 * a : point(2, i) "
          "let t = align(a, b)   assert(near(apply(t, normalize(a)), normalize(b))) "
          "let across = cross(a, b)  if (i % 10 != 0) { assert(near(apply(t, across), across)) } "
          "assert(near(cross(apply(t, x), apply(t, y)), apply(t, z))) } "
          "assert(align(y, y) == transform(translate(<0, 0, 0>)))");
}

static void combinations_answer_as_one(void **state)
{
    (void)state;
    HOLDS("let bowl = difference { sphere { radius = 2 } sphere { radius = 1.5 } box { from = <-3, .5, -3>  to = <3, "
          "3, 3> } } "
          "let lens = intersection { sphere { center = <1, 0, 0>  radius = 2 } sphere { center = <-1, 0, 0>  radius = "
          "2 } } "
          "let both = group { bowl { } lens { rotate(z, 90)  translate(<5, 0, 0>) } } "
          "for (i in 1..3000) { let p = 2.2 * point(1, i)  let r = length(p) "
          "assert(inside(bowl, p) == (r < 2 and r > 1.5 and p.y < .5)) "
          "assert(inside(lens, p) == (distance(p, x) < 2 and distance(p, -x) < 2)) "
          "assert(inside(both, p) == inside(bowl, p)) } "
          "let walls = hits(bowl, <-9, 0, 0>, x) for (i in 0..3) { assert(near(walls[i].distance, [7, 7.5, 10.5, "
          "11][i])) } "
          "assert([for (h in hits(bowl, <-9, 0, 0>, x)) h.normal.x] == [-1, 1, -1, 1]) "
          "let cut = hit(bowl, <1.7, 9, 0>, -y) assert(cut.point == <1.7, .5, 0> and cut.normal == y) "
          "let floor = hit(bowl, <0, 9, 0>, -y) assert(near(floor.point, <0, -1.5, 0>) and floor.normal == y) "
          "assert(hit(lens, <-9, 0, 0>, x).distance == 8 and hit(both, <5, 9, 0>, -y).distance == 8) "
          "assert(hit(lens, <0, 1.8, 0>, x) == none) "
          "assert(bounds(both).min == <-2, -2, -2> and bounds(lens).size.x == 2) "
          "assert(near(volume(lens), 5 * pi / 12 * 8, .03)) "
          "for (i in 1..200) { let s = scatter(bowl, i) let r = length(s.point) "
          "assert(near(r, 2, 1e-9) or near(r, 1.5, 1e-9) or near(s.point.y, .5, 1e-9)) }");
}

/* The flat faces of a mesh are met where they are, and show where they face, in whatever order rays find them: a ball of
 * triangles, mirrored and stretched too, whose faces look away from its middle. */
static void faces_of_meshes_are_the_right_ones(void **state)
{
    (void)state;
    HOLDS("let ball = superellipsoid { exponents = <1, 1> } let long = ball { scale(<-1, 1, 3>)  rotate(z, 20)  "
          "translate(y) } "
          "for (i in 1..400) { let s = scatter(ball, i) "
          "assert(length(s.point) > .998 and length(s.point) < 1 + 1e-6 and dot(s.normal, s.point) > .998) "
          "let p = s.point let h = hit(ball, 4 * p, -p) assert(distance(h.point, p) < 1e-5) "
          "assert(dot(h.normal, s.normal) > .995) "
          "let q = scatter(long, i) assert(dot(q.normal, q.point - y) > .3) "
          "let flat = hit(long, q.point + q.normal, -q.normal) "
          "assert(distance(flat.point, q.point) < 1e-5 and dot(flat.normal, q.normal) > .9) }");
}

/* Bodies of functions: of points or of coordinates, by themselves, in groups and in combinations. */
static void isosurfaces_answer_as_others(void **state)
{
    (void)state;
    HOLDS("def f(p) = length(p) - .5 def g(x, y, z) = x * x + y * y + z * z - .25 "
          "let ball = isosurface { function = f }  let other = isosurface { function = g } "
          "let half = difference { ball { } box { from = <0, -2, -2>  to = <2, 2, 2> } } "
          "let quarter = group { difference { half { } box { from = <-2, 0, -2>  to = <2, 2, 2> } } } "
          "for (i in 0..4) { let b = [ball, other, ball { translate(<0, 0, 0>) }, group { ball { } }, half][i] "
          "assert(near(bounds(b).max, .5 * <1, 1, 1>, .001) and near(bounds(b).min, -.5 * <1, 1, 1>, .001)) "
          "assert(inside(b, <-.1, 0, 0>) and inside(b, <-.4, .2, 0>) and not inside(b, <-.4, .4, 0>)) "
          "assert(inside(b, <.1, 0, 0>) == (i < 4)) "
          "let h = hit(b, <-3, 0, 0>, x) assert(near(h.point, -.5 * x, .001) and near(h.normal, -x, .1)) "
          "let all = hits(b, <-3, .01, .02>, x) assert(len(all) == 2) "
          "assert(near(all[1].point, <(i < 4 ? .5 : 0), .01, .02>, .002)) "
          "assert(near(volume(b), pi / 6 / (i < 4 ? 1 : 2), .003)) "
          "for (k in 1..20) { let s = scatter(b, k).point assert(i == 4 or near(length(s), .5, .005)) } } "
          "assert(near(volume(quarter), pi / 24, .002))");
    REFUSED("def f(p) = 1 / (p.x - p.x) print(bounds(isosurface { function = f }))", D_BAD_NUMBER);
    REFUSED("def f(p) = \"one\" print(volume(group { isosurface { function = f } }))", D_WRONG_TYPE);
}

/* ---- refusals ---- */

static void what_has_no_shape_is_refused(void **state)
{
    (void)state;
    REFUSED("print(bounds(light { from = <0, 1, 0>  to = <0, 0, 0> }))", D_NO_GEOMETRY);
    REFUSED("print(inside(camera { from = <0, 1, 0>  to = <0, 0, 0> }, x))", D_NO_GEOMETRY);
    REFUSED("print(hit(surface { }, x, y))", D_NO_GEOMETRY);
    REFUSED("print(bounds(group { }))", D_NO_GEOMETRY);
    REFUSED("print(bounds(ground { }))", D_NO_GEOMETRY);
    REFUSED("print(volume(ground { }))", D_NO_GEOMETRY);
    REFUSED("print(scatter(group { ground { } }, 1))", D_NO_GEOMETRY);
    REFUSED("print(hit(sphere { }, 1e16 * x, y))", D_NO_GEOMETRY);
    REFUSED("print(bounds(sphere { scale(<1, 0, 1>) }))", D_SINGULAR_TRANSFORM);
    REFUSED("print(bounds(7))", D_WRONG_TYPE);
    REFUSED("print(inside(sphere { }, 7))", D_WRONG_TYPE);
    REFUSED("print(hit(sphere { }, x, 7))", D_WRONG_TYPE);
    REFUSED("print(hit(sphere { }, x, <0, 0, 0>))", D_BAD_NUMBER);
    REFUSED("print(hit(sphere { }, 3 * x, y).point)", D_WRONG_TYPE);
    REFUSED("print(bounds(sphere { }).point)", D_WRONG_TYPE);
}

static void an_open_mesh_has_no_inside(void **state)
{
    (void)state;
#define OPEN                                                                                                           \
    "let m = mesh { positions = [<0, 0, 0>, <5, 0, 0>, <0, 6, 0>]  triangles = "                                       \
    "[<0, 1, 2>] } "
    HOLDS(OPEN "assert(hit(m, <1, 1, 5>, -z).point == <1, 1, 0> and bounds(m).size.x == 5 and scatter(m, 1).point.z "
               "== 0)");
    REFUSED(OPEN "print(inside(m, x))", D_NO_GEOMETRY);
    REFUSED(OPEN "print(volume(group { sphere { } m { } }))", D_NO_GEOMETRY);
}

/* A mistake in a node is told once, however often the node is asked of and placed; what it is made of is no matter. */
static void mistakes_are_told_once(void **state)
{
    (void)state;
    Fixture f;
    fixture_text(&f, "meniscus 1.0 unit mm let b = box { size = <1, 1, 1>  bevel = 3  interior = air } "
                     "for (i in 1..5) { print(bounds(b).size.x, inside(b, x)) } b { } b { translate(x) }" V);
    assert_int_equal(f.status, STATUS_SCENE);
    assert_int_equal(f.diag.n_errors, 1);
    assert_int_equal(f.diag.first->code, D_VALUE_OUT_OF_RANGE);
    fixture_clear(&f);
    HOLDS("let ball = sphere { radius = 3 } assert(bounds(ball).size.x == 6) ball { surface = surface { } }");
}

static void questions_count_as_steps(void **state)
{
    (void)state;
    Fixture f;
    SceneOptions options = {.eval = {.limits = {.steps = 1500}}};
    fixture_build(&f, "meniscus 1.0 unit mm let b = sphere { } for (i in 1..1000) { print(inside(b, x)) }" V, &options);
    assert_int_equal(f.status, STATUS_SCENE);
    assert_int_equal(f.diag.first->code, D_LIMIT);
    fixture_clear(&f);
}

/* More shapes than are kept at a time. */
static void many_shapes_are_forgotten_in_turn(void **state)
{
    (void)state;
    HOLDS("for (i in 1..2500) { let b = sphere { radius = i } "
          "assert(near(hit(b, <0, 9000, 0>, -y).distance, 9000 - i, 1e-9)) } let one = sphere { radius = 2 } "
          "for (i in 1..110000) { assert(bounds(one { translate(i * x) }).center.x == i) }");
}

static void without_geometry_nothing_is_answered(void **state)
{
    (void)state;
    Run run;
    run_text(&run, "print(bounds(sphere { radius = 1 }))");
    assert_int_equal(run.status, STATUS_SCENE);
    assert_int_equal(run.diag.first->code, D_NO_GEOMETRY);
    run_close(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_tight),
        cmocka_unit_test(groups_join_what_they_hold),
        cmocka_unit_test(points_are_inside_or_not),
        cmocka_unit_test(a_ground_is_solid_below),
        cmocka_unit_test(rays_meet_surfaces_in_double),
        cmocka_unit_test(all_hits_come_in_order),
        cmocka_unit_test(places_are_spread_by_area),
        cmocka_unit_test(directions_are_aligned),
        cmocka_unit_test(combinations_answer_as_one),
        cmocka_unit_test(faces_of_meshes_are_the_right_ones),
        cmocka_unit_test(isosurfaces_answer_as_others),
        cmocka_unit_test(what_has_no_shape_is_refused),
        cmocka_unit_test(an_open_mesh_has_no_inside),
        cmocka_unit_test(mistakes_are_told_once),
        cmocka_unit_test(questions_count_as_steps),
        cmocka_unit_test(many_shapes_are_forgotten_in_turn),
        cmocka_unit_test(without_geometry_nothing_is_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
