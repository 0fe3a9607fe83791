/* parts_test.c - meshes of several parts: which overlap, and layers in which none do; and that a ray through them, as
 * objects, never enters what it is in.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "icosphere.h"
#include "mesh_joined.h"
#include "near.h"
#include "nest/cross.h"
#include "scene_fixture.h"

static void drop_normals(Mesh *mesh)
{
    free(mesh->normals);
    mesh->normals = NULL;
}

/* A radius below 0: inside out. */
static Mesh *sphere(Vec3 center, double radius, unsigned subdivisions)
{
    Mesh *mesh = icosphere(fabs(radius), subdivisions);
    assert_non_null(mesh);
    drop_normals(mesh);
    Affine shift = affine_identity();
    shift.t = center;
    mesh_transform(mesh, &shift);
    for (uint32_t i = 0; radius < 0 && i < mesh->n_triangles; i++) {
        uint32_t *t = mesh->triangles[i], keep = t[1];
        t[1] = t[2];
        t[2] = keep;
    }
    return mesh;
}

static Mesh *box(Vec3 from, Vec3 to)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_make_box(from, to, 0, 0, &mesh, NULL), STATUS_OK);
    drop_normals(mesh);
    return mesh;
}

static void check_layer(const Mesh *layer, double *volume)
{
    MeshCrossings crossings;
    MeshParts again;
    MeshReport report;
    assert_int_equal(mesh_find_crossings(layer, NULL, &crossings, NULL), STATUS_OK);
    assert_int_equal(crossings.n, 0);
    assert_int_equal(mesh_find_parts(layer, NULL, &again, NULL), STATUS_OK);
    assert_int_equal(again.n_layers, 1);
    assert_int_equal(again.n_overlapping, 0);
    assert_int_equal(mesh_inspect(layer, NULL, &report, NULL), STATUS_OK);
    assert_true(report.closed);
    *volume += report.volume;
}

/* No layer crosses itself or has a part within another; together they are the mesh. */
static void check_layers(const Mesh *mesh, const MeshParts *parts)
{
    Mesh **taken = calloc(parts->n_layers, sizeof *taken);
    assert_non_null(taken);
    assert_int_equal(mesh_take_layers(mesh, parts, taken, NULL), STATUS_OK);
    double volume = 0;
    uint32_t n_triangles = 0;
    for (uint32_t i = 0; i < parts->n_layers; i++) {
        check_layer(taken[i], &volume);
        n_triangles += taken[i]->n_triangles;
        mesh_free(taken[i]);
    }
    free(taken);
    assert_int_equal(n_triangles, mesh->n_triangles);
    assert_near(volume, mesh_volume(mesh), 1e-6 * fabs(volume) + 1e-12);
}

/* Frees the mesh. */
static MeshParts parts_of(Mesh *mesh)
{
    MeshParts parts;
    assert_int_equal(mesh_find_parts(mesh, NULL, &parts, NULL), STATUS_OK);
    assert_false(parts.gave_up);
    assert_true((parts.n_layers > 1) == (parts.layer != NULL));
    if (parts.layer) check_layers(mesh, &parts);
    mesh_parts_clear(&parts);
    mesh_free(mesh);
    return parts;
}

static void expect_parts(Mesh *mesh, uint32_t bodies, uint32_t overlapping, uint32_t within, uint32_t layers)
{
    MeshParts parts = parts_of(mesh);
    assert_int_equal(parts.n_bodies, bodies);
    assert_int_equal(parts.n_overlapping, overlapping);
    assert_int_equal(parts.n_within, within);
    assert_int_equal(parts.n_layers, layers);
}

static void parts_are_told_apart(void **state)
{
    (void)state;
    Vec3 o = vec3(0, 0, 0);
    expect_parts(sphere(o, 1, 3), 1, 0, 0, 1);
    expect_parts(joined(sphere(o, 1, 3), sphere(vec3(1.5, 0, 0), 1, 3)), 2, 2, 0, 2);
    expect_parts(joined(sphere(o, 1, 3), sphere(vec3(1.2, 1.2, 1.2), 1, 3)), 2, 0, 0, 1); /* only boxes meet */
    expect_parts(joined(sphere(o, 1, 3), sphere(vec3(.3, 0, 0), .5, 3)), 2, 2, 1, 2);
    expect_parts(joined(sphere(o, 1, 3), sphere(vec3(.3, 0, 0), -.5, 3)), 1, 0, 0, 1); /* a cavity */
    /* a body in a cavity; one that sticks out of the cavity; one with a cavity, in another */
    expect_parts(joined(joined(sphere(o, 1, 3), sphere(o, -.8, 3)), sphere(o, .5, 3)), 2, 0, 0, 1);
    expect_parts(joined(joined(sphere(o, 1, 3), sphere(o, -.8, 3)), sphere(vec3(.5, 0, 0), .4, 3)), 2, 2, 0, 2);
    expect_parts(joined(joined(sphere(o, 1, 3), sphere(o, .8, 3)), sphere(o, -.5, 3)), 2, 2, 1, 2);
    /* shells in shells: glass, air, glass, air */
    expect_parts(joined(joined(sphere(o, 1, 3), sphere(o, -.8, 3)), joined(sphere(o, .6, 3), sphere(o, -.4, 3))), 2, 0,
                 0, 1);
}

static void parts_in_contact_overlap_from_within_only(void **state)
{
    (void)state;
    Vec3 o = vec3(0, 0, 0), one = vec3(1, 1, 1);
    /* face to face, with the same corners (these make them one part) and with others; along an edge; at a corner */
    expect_parts(joined(box(o, one), box(vec3(1, 0, 0), vec3(2, 1, 1))), 1, 0, 0, 1);
    expect_parts(joined(box(o, one), box(vec3(1, .2F, .3F), vec3(2, .7F, .9F))), 2, 0, 0, 1);
    expect_parts(joined(box(o, one), box(vec3(1, 1, 0), vec3(2, 2, 1))), 2, 0, 0, 1);
    expect_parts(joined(box(o, one), box(one, vec3(2, 2, 2))), 2, 0, 0, 1);
    /* a face in common from within; sides in common planes; quite within */
    expect_parts(joined(box(o, one), box(vec3(.5, .2F, .3F), vec3(1, .7F, .9F))), 2, 2, 0, 2);
    expect_parts(joined(box(o, one), box(vec3(.5, 0, 0), vec3(1.5, 1, 1))), 2, 2, 0, 2);
    expect_parts(joined(box(o, one), box(vec3(.25, .25, .25), vec3(.75, .75, .75))), 2, 2, 1, 2);
}

static double distance(const Ball *a, const Ball *b)
{
    return vec3_length(vec3_sub(a->centre, b->centre));
}

/* Whether it neither nearly touches another from outside nor from within, where it matters how round a mesh is. */
static bool is_clear(const Ball *balls, uint32_t n, const Ball *ball)
{
    for (uint32_t k = 0; k < n; k++) {
        double d = distance(&balls[k], ball), sum = balls[k].radius + ball->radius;
        if (fabs(d - sum) < .05 * sum || fabs(d - fabs(balls[k].radius - ball->radius)) < .05 * sum) return false;
    }
    return true;
}

/* Balls of all sizes at random overlap where their centers say so. */
static void heaps_of_balls_come_out_as_their_centers_say(void **state)
{
    (void)state;
    enum { N = 60 };
    uint64_t seed = 7;
    for (int round = 0; round < 10; round++) {
        Ball balls[N];
        Mesh *mesh = NULL;
        for (uint32_t n = 0; n < N;) {
            double r[4];
            for (int k = 0; k < 4; k++) r[k] = hash_to_unit(seed = hash_u64(seed + 1));
            balls[n] = (Ball){vec3_scale(vec3(r[0], r[1], r[2]), 3 + round), 0.1 + r[3] * r[3] * 1.5};
            if (!is_clear(balls, n, &balls[n])) continue;
            Mesh *ball = sphere(balls[n].centre, balls[n].radius, 3);
            mesh = n++ ? joined(mesh, ball) : ball;
        }
        uint32_t overlapping = 0, within = 0;
        for (uint32_t i = 0; i < N; i++) {
            bool meets = false, in = false, crosses = false;
            for (uint32_t k = 0; k < N; k++) {
                double d = distance(&balls[i], &balls[k]);
                if (k == i || d > balls[i].radius + balls[k].radius) continue;
                meets = true;
                in = in || d < balls[k].radius - balls[i].radius;
                crosses = crosses || d > fabs(balls[k].radius - balls[i].radius);
            }
            overlapping += meets;
            within += in && !crosses;
        }
        MeshParts parts = parts_of(mesh);
        assert_int_equal(parts.n_bodies, N);
        assert_int_equal(parts.n_overlapping, overlapping);
        assert_int_equal(parts.n_within, within);
    }
}

static Mesh *grid_of_balls(uint32_t side, double radius)
{
    Mesh *ball = sphere(vec3(0, 0, 0), radius, 1), *mesh = NULL;
    uint32_t n = side * side * side, v = ball->n_vertices, t = ball->n_triangles;
    assert_int_equal(mesh_new(n * v, n * t, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t b = 0; b < n; b++) {
        Vec3f at = vec3f((float)(b % side), (float)(b / side % side), (float)(b / side / side));
        for (uint32_t i = 0; i < v; i++) mesh->positions[b * v + i] = vec3f_add(ball->positions[i], at);
        for (uint32_t i = 0; i < 3 * t; i++)
            mesh->triangles[b * t + i / 3][i % 3] = ball->triangles[i / 3][i % 3] + b * v;
    }
    mesh_free(ball);
    return mesh;
}

static void thousands_of_parts_are_a_few_layers(void **state)
{
    (void)state;
    expect_parts(grid_of_balls(22, 0.4), 10648, 0, 0, 1);
    MeshParts parts = parts_of(grid_of_balls(12, 0.6));
    assert_int_equal(parts.n_overlapping, 1728);
    assert_in_range(parts.n_layers, 2, 8);
}

/* ---- as objects ---- */

#define TWO_TETRAHEDRA                                                                                                 \
    "mesh { interior = glass  positions = [<0, 0, 0>, <9, 0, 0>, <0, 9, 0>, <0, 0, 9>, <1, 1, 1>, <9, 2, 2>, "         \
    "<2, 9, 2>, <2, 2, 9>] triangles = [<0, 2, 1>, <0, 1, 3>, <1, 2, 3>, <0, 3, 2>, <4, 6, 5>, <4, 5, 7>, <5, 6, 7>, " \
    "<4, 7, 6>] }"

static Vec3 on_ball(uint64_t *seed, Vec3 center, double radius)
{
    double z = 2 * hash_to_unit(*seed = hash_u64(*seed + 1)) - 1;
    double angle = 6.283185307179586 * hash_to_unit(*seed = hash_u64(*seed + 1)), r = sqrt(1 - z * z);
    return vec3_along(center, radius, vec3(r * cos(angle), r * sin(angle), z));
}

/* Random lines through the scene, until that many surfaces were crossed. */
static void expect_no_faults(const Fixture *f, uint64_t n_crossings, Vec3 center, double radius)
{
    const CompiledScene *compiled = f->compiled;
    HitList hits = {0};
    NestList list;
    nest_list_init(&list);
    uint64_t seed = 1, n_faults = 0;
    for (uint64_t n = 0; n < n_crossings;) {
        Vec3 from = on_ball(&seed, center, radius), to = on_ball(&seed, center, radius);
        Ray ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(to, from))));
        rtc_all(compiled->rtc, &ray, false, &hits);
        for (size_t i = 0, together; i < hits.n; i += together) {
            NestPass passes[16];
            NestCrossing crossing;
            together = rtc_cluster(&hits.items[i], hits.n - i);
            assert_in_range(together, 1, COUNT_OF(passes));
            for (size_t k = 0; k < together; k++)
                passes[k] = (NestPass){compiled->hull_of_object[hits.items[i + k].object], hits.items[i + k].entering};
            assert_int_equal(nest_cross(&list, &compiled->order, passes, (uint32_t)together, &crossing), STATUS_OK);
            n_faults += crossing.n_faults;
        }
        n += hits.n;
        assert_int_equal(nest_list_count(&list), 0); /* outside again */
    }
    assert_int_equal(n_faults, 0);
    nest_list_clear(&list);
    hit_list_clear(&hits);
}

static void rays_never_enter_what_they_are_in(void **state)
{
    (void)state;
    Fixture f;
    fixture_compile(&f, FIXTURE_MEDIA TWO_TETRAHEDRA FIXTURE_VIEW, 1);
    assert_int_equal(f.compiled->n_hulls, 1);
    assert_string_equal(f.scene->objects[0].name, "mesh 1");
    for (uint32_t i = 1; i < f.scene->n_objects; i++) assert_int_equal(f.scene->objects[i].part_of, 0);
    expect_no_faults(&f, 1000000, vec3(3, 3, 3), 8);
    fixture_clear(&f);
}

static void add_mesh(Buf *text, Mesh *mesh)
{
    buf_add(text, "let both = mesh { interior = glass  positions = [");
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        buf_format(text, "%s<%.9g, %.9g, %.9g>", i ? ", " : "", (double)mesh->positions[i].x,
                   (double)mesh->positions[i].y, (double)mesh->positions[i].z);
    buf_add(text, "]  triangles = [");
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        buf_format(text, "%s<%u, %u, %u>", i ? ", " : "", (unsigned)mesh->triangles[i][0],
                   (unsigned)mesh->triangles[i][1], (unsigned)mesh->triangles[i][2]);
    buf_add(text, "] }\n");
    mesh_free(mesh);
}

static void spheres_that_overlap_are_one_body(void **state)
{
    (void)state;
    Fixture f;
    Buf text = {0};
    buf_add(&text, FIXTURE_MEDIA);
    add_mesh(&text, joined(joined(sphere(vec3(0, 0, 0), 1, 4), sphere(vec3(1, 0, 0), 1, 4)),
                           joined(sphere(vec3(1, 0, 0), .5, 3), sphere(vec3(0, 0, 0), -.3, 3))));
    buf_add(&text, "both {}" FIXTURE_VIEW);
    fixture_compile(&f, buf_text(&text), 1);
    /* two balls less the lens that they share, pi (4 r + d) (2 r - d)^2 / 12, and less the cavity, which is in one */
    const double pi = 3.14159265358979, expected = pi * (8.0 / 3 - 5.0 / 12 - 4.0 / 3 * .027);
    assert_int_equal(f.compiled->n_hulls, 1);
    assert_near(f.compiled->hulls[0].volume, expected, 0.01 * expected);
    expect_no_faults(&f, 1000000, vec3(.5, 0, 0), 2);
    buf_clear(&text);
    fixture_clear(&f);
}

/* Boxes of 8 that share 1: as objects, as instances, as an operand, as an opaque thing, and asked for their shape. */
static void wherever_the_mesh_is_used_it_is_one_body(void **state)
{
    (void)state;
    Fixture f;
    Buf text = {0};
    buf_add(&text, FIXTURE_MEDIA);
    add_mesh(&text, joined(box(vec3(0, 0, 0), vec3(2, 2, 2)), box(vec3(1, 1, 1), vec3(3, 3, 3))));
    buf_add(&text,
            "both first {}  both second { scale(2)  translate(<10, 0, 0>) }\n"
            "difference third { interior = glass  box { from = <-21, -1, -1>  to = <-16, 4, 4> }\n"
            "  both { translate(<-20, 0, 0>) } }\n"
            "assert(abs(volume(both) - 15) < .1, \"the volume is wrong\")\n"
            "assert(inside(both, <1.5, 1.5, 1.6>) and not inside(both, <2.5, .5, .5>), \"inside is wrong\")\n"
            "assert(len(hits(both, <1.4, 1.5, 9>, <0, 0, -1>)) == 2, \"inner surfaces are there\")\n" FIXTURE_VIEW);
    fixture_compile(&f, buf_text(&text), 1);
    const double expected[] = {15, 120, 125 - 15};
    assert_int_equal(f.compiled->n_hulls, 3);
    for (uint32_t h = 0; h < 3; h++) assert_near(f.compiled->hulls[h].volume, expected[h], 5e-3 * expected[h]);
    uint32_t n_layers = 0;
    for (uint32_t i = 0; i < f.scene->n_shapes; i++) n_layers += f.scene->shapes[i].layer_of != SCENE_NONE;
    assert_int_equal(n_layers, 2); /* shared by all */
    expect_no_faults(&f, 200000, vec3(0, 2, 2), 30);
    buf_clear(&text);
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_are_told_apart),
        cmocka_unit_test(parts_in_contact_overlap_from_within_only),
        cmocka_unit_test(heaps_of_balls_come_out_as_their_centers_say),
        cmocka_unit_test(thousands_of_parts_are_a_few_layers),
        cmocka_unit_test(rays_never_enter_what_they_are_in),
        cmocka_unit_test(spheres_that_overlap_are_one_body),
        cmocka_unit_test(wherever_the_mesh_is_used_it_is_one_body),
    };
    return cmocka_run_group_tests_name("parts", tests, NULL, NULL);
}
