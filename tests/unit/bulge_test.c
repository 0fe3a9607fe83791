/* bulge_test.c - how far a curved surface stands out over its facets: of balls it is known.
 * SPDX-License-Identifier: Apache-2.0 */
#include "icosphere.h"
#include "rtc_fixture.h"

/* How far a point within a ball about `centre` is from its surface, along up. */
static double below_ball(Vec3 place, Vec3 centre, double radius, Vec3 up)
{
    Vec3 from = vec3_sub(place, centre);
    double b = vec3_dot(from, up);
    return sqrt(b * b + radius * radius - vec3_dot(from, from)) - b;
}

/* Whether it is on the first or the last band of a lathe: these are cones, whose normals at the tip are none of a ball. */
static bool is_at_pole(const TestScene *s, const Hit *hit)
{
    const Solid *solid = s->objects[hit->object].solid;
    return solid && (hit->primitive == 0 || hit->primitive == solid->n_pieces - 1);
}

/* Rays from all around to a ball of facets, and from its middle: the bulge is the ball's, within a part of the largest one, and
 * from within the ball is hollow. */
static void expect_ball(const TestScene *s, uint32_t object, Vec3 centre, double radius, double within)
{
    HitList hits = {0};
    double worst = 0, most = 0;
    uint64_t random = 1;
    for (uint32_t i = 0; i < 4000; i++) {
        Vec3 direction = random_direction(&random);
        Ray ray = ray_make(vec3_along(centre, -5 * radius, direction), vec3f_from(direction));
        ray.origin = vec3_along(ray.origin, 0.9 * radius, random_direction(&random));
        ray.time = s->time;
        if (!rtc_nearest(s->rtc, &ray, &hits, NULL) || hits.items[0].object != object) continue;
        if (is_at_pole(s, &hits.items[0])) continue;
        Vec3f up = rtc_shading_normal(s->rtc, &ray, &hits.items[0]);
        Vec3 place = ray_point(&ray, hits.items[0].t);
        double expected = below_ball(place, centre, radius, vec3_from_f(up));
        worst = fmax(worst, fabs(rtc_bulge(s->rtc, &ray, &hits.items[0], up) - expected));
        most = fmax(most, expected);

        ray = ray_make(centre, vec3f_from(direction));
        ray.time = s->time;
        assert_true(rtc_nearest(s->rtc, &ray, &hits, NULL) > 0);
        assert_false(hits.items[0].entering);
        up = vec3f_negate(rtc_shading_normal(s->rtc, &ray, &hits.items[0]));
        assert_true(rtc_bulge(s->rtc, &ray, &hits.items[0], up) == 0);
    }
    printf("    object %u: at most %.4f of the radius, %.2g of that off\n", object, most / radius, worst / most);
    assert_true(most > 0.002 * radius && worst < within * most);
    hit_list_clear(&hits);
}

static void balls_of_triangles(void **state)
{
    (void)state;
    TestScene s = {0};
    Mesh *ball = keep_mesh(&s, icosphere(1, 1)), *fine = keep_mesh(&s, icosphere(1, 2));
    Affine mirrored = {{{2, 0, 0}, {0, 2, 0}, {0, 0, -2}}, {30, 0, 0}};
    add(&s, ball, NULL, affine_identity());
    add(&s, ball, NULL, mirrored);
    add(&s, ball, NULL, turned(40, vec3(1, 2, 3), vec3(0, 30, 0)));
    add(&s, fine, NULL, turned(70, vec3(3, 0, 1), vec3(0, 0, 30)));
    build(&s);
    expect_ball(&s, 0, vec3(0, 0, 0), 1, 0.12);
    expect_ball(&s, 1, vec3(30, 0, 0), 2, 0.12);
    expect_ball(&s, 2, vec3(0, 30, 0), 1, 0.12);
    expect_ball(&s, 3, vec3(0, 0, 30), 1, 0.04);
    destroy(&s);
}

/* A ball that grows, half way. */
static void balls_that_deform(void **state)
{
    (void)state;
    TestScene s = {.time = 0.5};
    Mesh *begin = keep_mesh(&s, icosphere(1, 2)), *end = keep_mesh(&s, icosphere(2, 2));
    add(&s, begin, NULL, affine_identity());
    s.objects[0].mesh_end = end;
    build(&s);
    expect_ball(&s, 0, vec3(0, 0, 0), 1.5, 0.04);
    destroy(&s);
}

/* A lathe of straight bands, which are shaded as one. */
static void balls_of_bands(void **state)
{
    (void)state;
    enum { N = 13 };
    TestScene s = {0};
    double profile[N][2];
    for (int i = 0; i < N; i++) {
        double angle = acos(-1) * i / (N - 1);
        profile[i][0] = i == 0 || i == N - 1 ? 0 : sin(angle);
        profile[i][1] = -cos(angle);
    }
    Solid *solid;
    Status status = solid_make_lathe((const double(*)[2])profile, N, NULL, true, &solid, NULL);
    add(&s, NULL, keep_solid(&s, status, solid), turned(50, vec3(1, 0, 1), vec3(1, 2, 3)));
    build(&s);
    expect_ball(&s, 0, vec3(1, 2, 3), 1, 0.04);
    destroy(&s);
}

static void flat_ones_do_not_bulge(void **state)
{
    (void)state;
    TestScene s = {0};
    HitList hits = {0};
    add(&s, keep_mesh(&s, box_mesh(vec3(-1, -1, -1), vec3(1, 1, 1))), NULL, affine_identity());
    build(&s);
    Ray ray = ray_make(vec3(0.1, 0.2, 5), vec3f(0, 0, -1));
    assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
    assert_true(rtc_bulge(s.rtc, &ray, hits.items, hits.items[0].normal) == 0);
    hit_list_clear(&hits);
    destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_of_triangles),
        cmocka_unit_test(balls_that_deform),
        cmocka_unit_test(balls_of_bands),
        cmocka_unit_test(flat_ones_do_not_bulge),
    };
    return cmocka_run_group_tests_name("bulge", tests, NULL, NULL);
}
