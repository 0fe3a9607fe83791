/* rtc_boxes_test.c - all triangles that a line meets are among those that rtc_along tells of, and few others.
 * SPDX-License-Identifier: Apache-2.0 */
#include "geom/rtc_boxes.h"

#include "rtc_fixture.h"

typedef struct Told {
    bool *of; /* primitive */
    uint32_t n;
} Told;

static void note(void *context, uint32_t first, uint32_t end)
{
    Told *told = context;
    for (uint32_t i = first; i < end; i++) {
        assert_false(told->of[i]);
        told->of[i] = true;
    }
    told->n += end - first;
}

/* How many triangles a line meets; all of them have been told of. A line that runs in the plane of a triangle does not. */
static uint32_t count_met(const TestScene *s, const Ray *ray, const Told *told)
{
    Query query = {.scene = s->rtc, .ray = ray, .origin = ray->origin, .direction = vec3_from_f(ray->direction)};
    uint32_t n_met = 0;
    for (uint32_t i = 0; i < rtc_n_primitives(s->rtc, 0); i++) {
        Vec3 corner[3];
        double weight[3];
        rtc_triangle(s->rtc, 0, i, ray->time, corner);
        if (!rtc_line_meets(&query, corner, weight) || weight[0] + weight[1] + weight[2] == 0) continue;
        n_met++;
        assert_true(told->of[i]);
    }
    return n_met;
}

/* Rays to any place of a triangle, of its edges and its corners, and some of them along an axis. */
static Ray any_ray(const TestScene *s, int i, uint64_t *random)
{
    Vec3 corner[3];
    uint32_t primitive = (uint32_t)(unit(random) * rtc_n_primitives(s->rtc, 0));
    double time = s->n_keys || s->objects[0].mesh_end ? unit(random) : 0;
    rtc_triangle(s->rtc, 0, primitive, time, corner);
    double along = i % 3 > 0 ? unit(random) : 0, across = i % 3 > 1 ? unit(random) * (1 - along) : 0;
    Vec3 aim = vec3_along(vec3_along(corner[0], along, vec3_sub(corner[1], corner[0])), across,
                          vec3_sub(corner[2], corner[0])),
         from = vec3_along(aim, 100 * unit(random), random_direction(random));
    if (i % 4 == 0) from = vec3(aim.x, aim.y, aim.z + 7);
    return ray_through(from, aim, time);
}

/* Every triangle is told of that any of some lines meets, and of all triangles on the average no more than that share. */
static void try_lines(TestScene *s, int n_lines, double share)
{
    build(s);
    uint32_t n = rtc_n_primitives(s->rtc, 0), n_met = 0, n_lost = 0;
    Told told = {malloc(n * sizeof(bool)), 0};
    uint64_t random = 3;
    assert_non_null(told.of);
    for (int i = 0; i < n_lines; i++) {
        memset(told.of, 0, n * sizeof(bool));
        Ray ray = any_ray(s, i, &random);
        rtc_along(s->rtc, 0, ray.origin, vec3_from_f(ray.direction), ray.time, note, &told);
        uint32_t met = count_met(s, &ray, &told);
        n_met += met;
        n_lost += !met; /* directions are float: the line runs by an edge, and by all others */
    }
    print_message("        %u triangles: a line meets %.2f of them, and is told of %.1f\n", n, (double)n_met / n_lines,
                  (double)told.n / n_lines);
    assert_true(n_met > (uint32_t)n_lines && n_lost < (uint32_t)n_lines / 3);
    assert_true((double)told.n <= share * n * n_lines);
    free(told.of);
    destroy(s);
}

static void test_of_any_size(void **state)
{
    (void)state;
    static const uint32_t cuts[] = {1, 2, 3, 4, 5, 12, 40};
    for (size_t i = 0; i < COUNT_OF(cuts); i++) {
        TestScene s = {0};
        add(&s, keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), cuts[i])), NULL, affine_identity());
        try_lines(&s, 300, cuts[i] < 10 ? 1 : 0.2);
    }
}

/* One that is too large to be asked as a whole for every ray. */
static void test_of_many_triangles(void **state)
{
    (void)state;
    TestScene s = {0};
    add(&s, keep_mesh(&s, cut_box_mesh(vec3(-300, -100, -200), vec3(300, 100, 200), 120)), NULL, affine_identity());
    try_lines(&s, 60, 0.02);
}

/* Instances are asked in their own frame, however far off and small they are, and turned inside out; the first of two is. */
static void test_of_instances(void **state)
{
    (void)state;
    Affine mirrored = turned(50, vec3(3, 1, 2), vec3(-9e5, 4e5, 7e5));
    for (int i = 0; i < 3; i++) mirrored.m[i][0] *= -1e-2, mirrored.m[i][1] *= 1e-3;
    const Affine maps[] = {turned(25, vec3(1, 2, 3), vec3(1, 2, 3)), mirrored};
    for (size_t i = 0; i < COUNT_OF(maps); i++) {
        TestScene s = {0};
        Mesh *mesh = keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), 30));
        add(&s, mesh, NULL, maps[i]);
        add(&s, mesh, NULL, affine_identity());
        try_lines(&s, 300, 0.3);
    }
}

/* One that moves, and one whose vertices do, by more than its size. */
static void test_while_moving(void **state)
{
    (void)state;
    for (int deforms = 0; deforms < 2; deforms++) {
        TestScene s = {.n_keys = deforms ? 0 : 2};
        Mesh *mesh = keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), 20)),
             *end = keep_mesh(&s, cut_box_mesh(vec3(8, -4, -3), vec3(12, 9, 1), 20));
        const Affine keys[2] = {turned(25, vec3(1, 2, 3), vec3(1, 2, 3)), turned(80, vec3(1, 2, 3), vec3(30, 2, -5))};
        add(&s, mesh, NULL, keys[0]);
        s.objects[0].mesh_end = deforms ? end : NULL;
        s.objects[0].keys = deforms ? NULL : keys;
        try_lines(&s, 300, deforms ? 0.7 : 0.3);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_of_any_size), cmocka_unit_test(test_of_many_triangles),
                                       cmocka_unit_test(test_of_instances), cmocka_unit_test(test_while_moving)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
