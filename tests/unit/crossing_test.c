/* crossing_test.c - meshes that pass through themselves, and the many that only look as if they might.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/hash.h"
#include "icosphere.h"
#include "mesh/exact.h"
#include "mesh_joined.h"
#include "near.h"

static Mesh *sphere(Vec3 center, double radius, unsigned subdivisions)
{
    Mesh *mesh = icosphere(radius, subdivisions);
    assert_non_null(mesh);
    Affine shift = affine_identity();
    shift.t = center;
    mesh_transform(mesh, &shift);
    return mesh;
}

static Mesh *box(Vec3 from, Vec3 to)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_make_box(from, to, 0, 0, &mesh, NULL), STATUS_OK);
    return mesh;
}

static MeshCrossings crossings_of(const Mesh *mesh)
{
    MeshCrossings found;
    assert_int_equal(mesh_find_crossings(mesh, NULL, &found, NULL), STATUS_OK);
    assert_false(found.gave_up);
    assert_true((found.n == 0) == (found.n_places == 0));
    return found;
}

static uint64_t count(Mesh *mesh)
{
    MeshCrossings found = crossings_of(mesh);
    mesh_free(mesh);
    return found.n;
}

/* Whether an edge of one triangle goes through the other: for corners in general position only. */
static bool edge_goes_through(const Mesh *mesh, uint32_t i, uint32_t j)
{
    const uint32_t *t = mesh->triangles[i], *u = mesh->triangles[j];
    Vec3 a = vec3_from_f(mesh->positions[u[0]]), e = vec3_sub(vec3_from_f(mesh->positions[u[1]]), a),
         f = vec3_sub(vec3_from_f(mesh->positions[u[2]]), a);
    for (int k = 0; k < 3; k++) {
        Vec3 p = vec3_from_f(mesh->positions[t[k]]), d = vec3_sub(vec3_from_f(mesh->positions[t[(k + 1) % 3]]), p);
        Vec3 h = vec3_cross(d, f), s = vec3_sub(p, a), q = vec3_cross(s, e);
        double det = vec3_dot(e, h);
        double x = vec3_dot(s, h) / det, y = vec3_dot(d, q) / det, along = vec3_dot(f, q) / det;
        if (x > 0 && y > 0 && x + y < 1 && along > 0 && along < 1) return true;
    }
    return false;
}

/* Pairs that cross, by looking at each; neighbours left out. */
static uint64_t count_slowly(const Mesh *mesh)
{
    uint64_t n = 0;
    for (uint32_t i = 0; i < mesh->n_triangles; i++)
        for (uint32_t j = i + 1; j < mesh->n_triangles; j++) {
            bool neighbours = false;
            for (int k = 0; k < 9; k++) neighbours |= mesh->triangles[i][k / 3] == mesh->triangles[j][k % 3];
            n += !neighbours && (edge_goes_through(mesh, i, j) || edge_goes_through(mesh, j, i));
        }
    return n;
}

static void what_is_whole_does_not_cross_itself(void **state)
{
    (void)state;
    assert_int_equal(count(sphere(vec3(0, 0, 0), 1, 5)), 0);
    assert_int_equal(count(box(vec3(0, 0, 0), vec3(1, 2, 3))), 0);
    Mesh *rounded = NULL;
    assert_int_equal(mesh_make_box(vec3(-1, -1, -1), vec3(1, 1, 1), 0.3, 8, &rounded, NULL), STATUS_OK);
    assert_int_equal(count(rounded), 0);
    /* one within the other, and beside it */
    assert_int_equal(count(joined(sphere(vec3(0, 0, 0), 1, 3), sphere(vec3(0, 0, 0), 0.5, 3))), 0);
    assert_int_equal(count(joined(sphere(vec3(0, 0, 0), 1, 3), sphere(vec3(2.5, 0, 0), 1, 3))), 0);
}

static void parts_that_touch_from_outside_do_not_cross(void **state)
{
    (void)state;
    Vec3 zero = vec3(0, 0, 0), one = vec3(1, 1, 1);
    assert_int_equal(count(joined(box(zero, one), box(vec3(1, 0, 0), vec3(2, 1, 1)))), 0);     /* face to face */
    assert_int_equal(count(joined(box(zero, one), box(vec3(1, .2, .3), vec3(2, .7, .9)))), 0); /* within a face */
    assert_int_equal(count(joined(box(zero, one), box(vec3(1, 1, 0), vec3(2, 2, 1)))), 0);     /* along an edge */
    assert_int_equal(count(joined(box(zero, one), box(vec3(1, 1, 1), vec3(2, 2, 2)))), 0);     /* with a corner */
    assert_int_equal(count(joined(box(zero, one), box(vec3(1, 1, .5), vec3(2, 2, 1.5)))), 0);
}

static void parts_that_overlap_cross(void **state)
{
    (void)state;
    Vec3 zero = vec3(0, 0, 0), one = vec3(1, 1, 1);
    assert_true(count(joined(box(zero, one), box(vec3(.5, .5, .5), vec3(2, 2, 2)))) > 0);
    assert_true(count(joined(box(zero, one), box(vec3(.5, 0, 0), vec3(1.5, 1, 1)))) > 0);       /* sides in one plane */
    assert_true(count(joined(box(zero, one), box(vec3(-1, .25, .25), vec3(2, .75, .75)))) > 0); /* a bar through it */
}

/* The same pairs as by looking at each; in any size of the mesh, and with any number of threads. */
static void every_pair_is_found(void **state)
{
    (void)state;
    for (int round = 0; round < 12; round++) {
        Vec3 shift = vec3(0.3 + hash_to_unit(hash_u64((uint64_t)round)), hash_to_unit(hash_u64(100U + (uint64_t)round)),
                          0.1 * round);
        double scale = ldexp(1, (round - 6) * 6);
        Mesh *mesh = joined(sphere(vec3_scale(shift, scale), scale, 3), sphere(vec3(0, 0, 0), 1.1 * scale, 3));
        uint64_t expected = count_slowly(mesh);
        MeshCrossings found = crossings_of(mesh), pooled;
        assert_int_equal(found.n, expected);
        assert_true(expected > 50);
        for (uint32_t k = 0; k < found.n_places; k++) {
            Vec3 place = vec3_from_f(found.first[k].place);
            assert_near(vec3_length(place) / scale, 1.1, 0.02);
            assert_near(vec3_length(vec3_sub(place, vec3_scale(shift, scale))) / scale, 1, 0.02);
        }
        Pool *pool;
        assert_int_equal(pool_new(3, &pool, NULL), STATUS_OK);
        assert_int_equal(mesh_find_crossings(mesh, pool, &pooled, NULL), STATUS_OK);
        assert_memory_equal(&pooled, &found, sizeof found);
        pool_free(pool);
        mesh_free(mesh);
    }
}

static Mesh *two_triangles(const Vec3f corners[5])
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(5, 2, false, false, &mesh, NULL), STATUS_OK);
    memcpy(mesh->positions, corners, 5 * sizeof *corners);
    const uint32_t triangles[2][3] = {{0, 1, 2}, {3, 4, 0}};
    memcpy(mesh->triangles, triangles, sizeof triangles);
    return mesh;
}

static void neighbours_at_a_corner_cross_only_beyond_it(void **state)
{
    (void)state;
    const Vec3f through[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {1, 0, -1}, {1, 0, 1}};
    const Vec3f away[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {-1, 0, -1}, {-1, 0, 1}};
    const Vec3f above[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {1, 0, 0.5F}, {1, 0, 1}};
    const Vec3f beside[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {1, 3, -1}, {1, 3, 1}};
    const Vec3f in_plane[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {2, 0, 0}, {2, 3, 0}};
    const Vec3f in_plane_beside[5] = {{0, 0, 0}, {2, -1, 0}, {2, 1, 0}, {2, 2, 0}, {2, 3, 0}};
    assert_int_equal(count(two_triangles(through)), 1);
    assert_int_equal(count(two_triangles(away)), 0);
    assert_int_equal(count(two_triangles(above)), 0);
    assert_int_equal(count(two_triangles(beside)), 0);
    assert_int_equal(count(two_triangles(in_plane)), 1);
    assert_int_equal(count(two_triangles(in_plane_beside)), 0);
}

/* A corner of a sphere drawn through its other side. */
static void a_spike_through_the_other_wall_is_found(void **state)
{
    (void)state;
    Mesh *mesh = sphere(vec3(0, 0, 0), 1, 4);
    Vec3f p = mesh->positions[77];
    mesh->positions[77] = vec3f_scale(p, -0.9F);
    assert_int_equal(crossings_of(mesh).n, 0);
    mesh->positions[77] = vec3f_scale(p, -1.1F);
    MeshCrossings found = crossings_of(mesh);
    assert_true(found.n > 0);
    assert_near((double)found.first[0].place.x, -(double)p.x, 0.05);
    assert_near((double)found.first[0].place.y, -(double)p.y, 0.05);
    mesh_free(mesh);
}

/* Many long triangles about one axis: the search must end, and say if it gave up. */
static void a_fan_of_slivers_ends(void **state)
{
    (void)state;
    enum { N = 3000 };
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(N + 2, 2 * N, false, false, &mesh, NULL), STATUS_OK);
    mesh->positions[N] = vec3f(0, 1, 0);
    mesh->positions[N + 1] = vec3f(0, -1, 0);
    for (uint32_t i = 0; i < N; i++) {
        double angle = i * (6.283185307179586 / N);
        mesh->positions[i] = vec3f((float)cos(angle), 0, (float)-sin(angle));
        const uint32_t next = (i + 1) % N, triangles[2][3] = {{N, i, next}, {N + 1, next, i}};
        memcpy(mesh->triangles[2 * i], triangles, sizeof triangles);
    }
    assert_int_equal(count(mesh), 0);
}

/* A landscape without sides, whose corners are displaced at random. */
static Mesh *landscape(uint32_t n, double sideways, uint64_t seed)
{
    Mesh *mesh = NULL;
    assert_int_equal(mesh_new(n * n, 2 * (n - 1) * (n - 1), false, false, &mesh, NULL), STATUS_OK);
    uint32_t at = 0;
    for (uint32_t i = 0; i < n * n; i++) {
        double r[3];
        for (int k = 0; k < 3; k++) r[k] = hash_to_unit(seed = hash_u64(seed + 1));
        mesh->positions[i] =
            vec3f((float)(i % n + sideways * r[0]), (float)(3 * r[1]), (float)(i / n + sideways * r[2]));
        if (i % n == n - 1 || i / n == n - 1) continue;
        const uint32_t triangles[2][3] = {{i, i + n, i + 1}, {i + 1, i + n, i + n + 1}};
        memcpy(mesh->triangles[at], triangles, sizeof triangles);
        at += 2;
    }
    return mesh;
}

/* What faces upward is left out of the search as one where it is a graph: not where it only looks like one. */
static void landscapes_are_cleared_only_where_they_are_graphs(void **state)
{
    (void)state;
    uint64_t crossing = 0;
    for (uint64_t round = 0; round < 12; round++) {
        Mesh *mesh = landscape(14, round < 4 ? 0 : 0.35 * (double)(round - 3), round);
        uint64_t slowly = count_slowly(mesh), found = crossings_of(mesh).n; /* this with neighbours at a corner */
        assert_true(found >= slowly);
        if (round < 4) assert_int_equal(found, 0);
        crossing += slowly;
        mesh_free(mesh);
    }
    assert_true(crossing > 100);
    /* a spiral stair that falls back through itself: every step faces up, and the border crosses itself seen from above */
    enum { STEPS = 60 };
    Mesh *stair = NULL;
    assert_int_equal(mesh_new(2 * STEPS, 2 * (STEPS - 1), false, false, &stair, NULL), STATUS_OK);
    for (uint32_t i = 0; i < STEPS; i++) {
        double angle = -0.3 * i, height = 0.01 * (i < 40 ? i : 80 - 2.2 * i);
        stair->positions[2 * i] = vec3f((float)cos(angle), (float)height, (float)sin(angle));
        stair->positions[2 * i + 1] = vec3f((float)(2 * cos(angle)), (float)height, (float)(2 * sin(angle)));
        if (i == STEPS - 1) continue;
        const uint32_t k = 2 * i, triangles[2][3] = {{k, k + 1, k + 2}, {k + 1, k + 3, k + 2}};
        memcpy(stair->triangles[k], triangles, sizeof triangles);
    }
    assert_true(count_slowly(stair) > 0);
    assert_int_equal(crossings_of(stair).n, count_slowly(stair));
    mesh_free(stair);
}

/* Coordinates of 15 bits, whose determinants fit into 64: against what double cannot decide, and shifted far off. */
static void signs_are_exact(void **state)
{
    (void)state;
    uint64_t seed = 1, zeros = 0;
    for (int round = 0; round < 200000; round++) {
        int64_t p[4][3];
        for (int i = 0; i < 12; i++) {
            seed = hash_u64(seed);
            p[i / 3][i % 3] = (int64_t)(seed % 32768) - 16384;
        }
        if (round % 2) /* in the plane of the others, or next to it */
            for (int k = 0; k < 3; k++) p[3][k] = p[0][k] + (p[1][k] - p[0][k]) - (p[2][k] - p[0][k]);
        if (round % 4 == 3) p[3][round % 3] += 1;
        int64_t u[3], v[3], w[3];
        for (int k = 0; k < 3; k++) {
            u[k] = p[1][k] - p[0][k];
            v[k] = p[2][k] - p[0][k];
            w[k] = p[3][k] - p[0][k];
        }
        int64_t det = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                      w[2] * (u[0] * v[1] - u[1] * v[0]);
        float scale = ldexpf(1, round % 80 - 40);
        Vec3f f[4];
        for (int i = 0; i < 4; i++) f[i] = vec3f_scale(vec3f((float)p[i][0], (float)p[i][1], (float)p[i][2]), scale);
        assert_int_equal(exact_side_of_plane(f[0], f[1], f[2], f[3]), (det > 0) - (det < 0));
        zeros += det == 0;
        int64_t flat = u[0] * v[1] - u[1] * v[0];
        Point2 a = {(double)f[0].x, (double)f[0].y}, b = {(double)f[1].x, (double)f[1].y},
               c = {(double)f[2].x, (double)f[2].y};
        assert_int_equal(exact_turn(a, b, c), (flat > 0) - (flat < 0));
    }
    assert_true(zeros > 40000);
    /* one unit in the last place of a float, beside coordinates that are a billion times larger */
    Vec3f a = {-1e9F, 0, 1e9F}, b = {1e9F, 1e-30F, -1e9F}, c = {1e9F, 1e9F, -1e9F};
    assert_int_equal(exact_side_of_plane(a, b, c, vec3f(0.5F, 3, -0.5F)), 0);
    assert_int_equal(exact_side_of_plane(a, b, c, vec3f(0.5F, 3, nextafterf(-0.5F, 0))),
                     -exact_side_of_plane(a, b, c, vec3f(0.5F, 3, nextafterf(-0.5F, -1))));
    assert_int_not_equal(exact_side_of_plane(a, b, c, vec3f(0.5F, 3, nextafterf(-0.5F, 0))), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_whole_does_not_cross_itself),
        cmocka_unit_test(parts_that_touch_from_outside_do_not_cross),
        cmocka_unit_test(parts_that_overlap_cross),
        cmocka_unit_test(every_pair_is_found),
        cmocka_unit_test(neighbours_at_a_corner_cross_only_beyond_it),
        cmocka_unit_test(a_spike_through_the_other_wall_is_found),
        cmocka_unit_test(a_fan_of_slivers_ends),
        cmocka_unit_test(landscapes_are_cleared_only_where_they_are_graphs),
        cmocka_unit_test(signs_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
