/* lone_test.c - within objects into which nothing else reaches, a ray meets what it would if it were searched for.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "rtc_fixture.h"

/* Balls of which some are lone: among each other, in a box, a glass and a larger ball, across their surfaces, and about a plane. */
static void add_bubbles(TestScene *s, uint64_t seed, uint32_t n)
{
    static const double glass_profile[][2] = {{0, -9}, {9, -9}, {9, 9}, {7, 9}, {7, -7}, {0, -7}};
    Solid *ball = sphere(s, 1), *glass, *plane;
    Status status = solid_make_lathe(glass_profile, 6, NULL, false, &glass, NULL);
    glass = keep_solid(s, status, glass);
    assert_int_equal(solid_new(1, &plane, NULL), STATUS_OK);
    plane->pieces[0].kind = PIECE_PLANE;
    keep_solid(s, STATUS_OK, plane);
    add(s, keep_mesh(s, cut_box_mesh(vec3(-12, -12, -12), vec3(12, 12, 2), 3)), NULL, affine_identity());
    add(s, NULL, plane, turned(20, vec3(1, 0, 1), vec3(0, -4, 0)));
    for (uint64_t i = 0; i < n; i++) {
        double size = i == 0 ? 8 : 0.05 + 0.5 * hash_to_unit(hash_u64(seed + 5 * i));
        Affine at = turned(0, vec3(1, 0, 0), vec3(0, 0, 0));
        for (int k = 0; k < 3; k++) at.m[k][k] = size;
        at.t =
            vec3(20 * hash_to_unit(hash_u64(seed + 5 * i + 1)) - 10, 20 * hash_to_unit(hash_u64(seed + 5 * i + 2)) - 10,
                 20 * hash_to_unit(hash_u64(seed + 5 * i + 3)) - 10);
        if (i == 0) at.t = vec3(0, 0, 0);
        if (i == 1) at.t = vec3(6 + 1e-6, 0, 0), at.m[0][0] = at.m[1][1] = at.m[2][2] = 2; /* nearly touches it */
        if (i == 2) at.t = vec3(-4, 0, 0);
        add(s, NULL, ball, at);
    }
    add(s, NULL, glass, turned(10, vec3(1, 0, 0), vec3(0, 0, 0)));
}

static bool is_same_hit(const Hit *a, const Hit *b)
{
    return a->t == b->t && a->object == b->object && a->primitive == b->primitive && a->entering == b->entering &&
           a->cos_normal == b->cos_normal && a->rounding == b->rounding &&
           memcmp(&a->normal, &b->normal, sizeof a->normal) == 0;
}

/* What a ray meets that goes into a ball is what a search for everything along it finds first, to the bit, also where the ray is
 * not searched for because nothing reaches into the ball. */
static void test_lone_balls(void **state)
{
    (void)state;
    enum { RAYS = 40000 };
    HitList hits = {0}, left = {0}, all = {0};
    int n_lone = 0, n_inside = 0;
    for (int k = 0; k < 4; k++) {
        TestScene s = {0};
        add_bubbles(&s, 100 + (uint64_t)k, k % 2 ? 3 : 60); /* not all of so few pieces are Embree's */
        build(&s);
        uint64_t random = hash_u64((uint64_t)k);
        for (int i = 0; i < RAYS; i++) {
            uint32_t o = 2 + (uint32_t)(unit(&random) * (s.n - 3));
            Vec3 centre = s.objects[o].to_world.t,
                 aim = vec3_along(centre, s.objects[o].to_world.m[0][0], random_direction(&random));
            Ray ray = ray_through(vec3_scale(random_direction(&random), 40), aim, 0);
            size_t n = 1;
            assert_true(rtc_all(s.rtc, &ray, false, &all));
            size_t at = 0;
            while (at < all.n && (all.items[at].object != o || !all.items[at].entering)) at++;
            if (at == all.n || rtc_cluster(all.items + at, all.n - at) > 1) continue;
            if (at > 0 && rtc_together(&all.items[at - 1], &all.items[at])) continue;
            left.n = 0;
            *rtc_hit_place(&left) = all.items[at];
            Vec3 direction = random_direction(&random);
            if (vec3_dot(direction, vec3_from_f(left.items[0].normal)) > 0) direction = vec3_scale(direction, -1);
            rtc_leave(s.rtc, &ray, left.items, &n, true, vec3f_from(direction), &ray);
            if (!left.items[0].inside) continue;
            n = rtc_nearest(s.rtc, &ray, &hits, NULL);
            assert_true(rtc_all(s.rtc, &ray, false, &all));
            assert_int_equal(n, rtc_cluster(all.items, all.n));
            for (size_t h = 0; h < n; h++) assert_true(is_same_hit(&hits.items[h], &all.items[h]));
            n_inside++;
            n_lone += rtc_is_lone(s.rtc, o);
        }
        destroy(&s);
    }
    printf("%d rays in balls, %d of them in lone ones\n", n_inside, n_lone);
    assert_true(n_lone > n_inside / 5 && n_lone < n_inside);
    hit_list_clear(&hits);
    hit_list_clear(&left);
    hit_list_clear(&all);
}

/* A stone: a brilliant of a few faces, those of the table and the girdle of several triangles each. */
static Mesh *stone_mesh(uint32_t n)
{
    static const double profile[][2] = {{0, -2}, {3, -0.1}, {3, 0.1}, {1.8, 1}, {0, 1}};
    return lathe_mesh(profile, COUNT_OF(profile), n);
}

/* Stones alone, close to others, with a ball in them, in a ball, across other things, and standing on a plane. Returns how many. */
static uint32_t add_stones(TestScene *s)
{
    Mesh *stones[] = {keep_mesh(s, stone_mesh(8)), keep_mesh(s, box_mesh(vec3(-2, -1, -1), vec3(2, 1, 1))),
                      keep_mesh(s, cut_box_mesh(vec3(-1, -1, -1), vec3(1, 1, 1), 2)), keep_mesh(s, stone_mesh(24))};
    enum { STONES = 16, STANDING = 4 };
    for (int i = 0; i < STONES; i++) {
        Affine at = turned(37 * (i + 1), vec3(1, i % 5, 2), vec3(9 * (i % 4) - 13, 9 * (i / 4) - 13, i % 3));
        for (int row = 0; row < 3 && i > 7; row++) at.m[row][1] *= i % 2 ? -0.7 : 0.8; /* flatter, and mirrored */
        add(s, stones[i % 4], NULL, at);
    }
    static const double standing[][3] = {{22, -13, -0.5}, {22, -4, 0.5}, {22, 5, -0.5}, {22, 7, -0.5}};
    for (int i = 0; i < STANDING; i++) /* on the plane: a face, a tip, and two side by side */
        add(s, stones[i == 1 ? 0 : 1], NULL,
            turned(i == 1 ? 90 : 0, vec3(1, 0, 0), vec3(standing[i][0], standing[i][1], standing[i][2])));
    Solid *ball = sphere(s, 1), *plane;
    static const double around[][3] = {{-13, -13, 0}, {-4, -13, 1}, {5, -13, 2}, {14, -13, 0}, {-13, -4, 1}};
    for (size_t i = 0; i < COUNT_OF(around); i++) { /* one in it, one around it, one across its surface, two close by */
        static const double sizes[] = {0.3, 3.9, 1.2, 0.5, 0.5};
        Affine at = turned(0, vec3(1, 0, 0), vec3(around[i][0], around[i][1], around[i][2] + (i > 2 ? 4 : 0)));
        for (int k = 0; k < 3; k++) at.m[k][k] = sizes[i];
        add(s, NULL, ball, at);
    }
    assert_int_equal(solid_new(1, &plane, NULL), STATUS_OK);
    plane->pieces[0].kind = PIECE_PLANE;
    add(s, NULL, keep_solid(s, STATUS_OK, plane), turned(90, vec3(1, 0, 0), vec3(0, 0, -1.5))); /* through some */
    add(s, keep_mesh(s, box_mesh(vec3(44, 44, 44), vec3(46, 46, 46))), NULL, affine_identity());
    return STONES + STANDING;
}

/* The same objects and a ball that moves: nothing is lone then. */
static void add_mover(TestScene *s, const Affine keys[2])
{
    s->n_keys = 2;
    add(s, NULL, s->solids[0], keys[0]);
    s->objects[s->n - 1].keys = keys;
}

/* A direction into an object: any, along the surface, or at an edge of one of the stones. */
static Vec3 inward_direction(const TestScene *stones, uint64_t *random, Vec3 place, Vec3 normal)
{
    double choice = unit(random);
    Vec3 d = random_direction(random);
    if (choice < 0.2) d = vec3_normalize(vec3_along(d, -vec3_dot(d, normal) * (1 - 1e-3), normal));
    if (choice > 0.7) d = vec3_normalize(vec3_sub(place_at_edge(stones, random), place));
    return vec3_dot(d, normal) > 0 ? vec3_scale(d, -1) : d;
}

/* Within stones, what a ray meets is the same to the bit whether it is searched for or not. */
static void test_lone_stones(void **state)
{
    (void)state;
    enum { WALKS = 30000, TURNS = 8 };
    const Affine keys[2] = {turned(0, vec3(1, 0, 0), vec3(44, -44, 44)), turned(0, vec3(1, 0, 0), vec3(44, -44, 43))};
    TestScene s = {0}, other;
    uint32_t n_stones = add_stones(&s);
    other = s;
    add_mover(&other, keys);
    build(&s);
    build(&other);
    TestScene stones = s;
    stones.n = n_stones;
    HitList hits = {0}, left = {0}, searched = {0};
    uint64_t random = 9, n_lone = 0, n_met = 0;
    for (int w = 0; w < WALKS; w++) {
        uint32_t stone = (uint32_t)(unit(&random) * n_stones);
        Vec3 aim = vec3_along(s.objects[stone].to_world.t, 2 * unit(&random), random_direction(&random));
        Ray ray = ray_through(vec3_along(aim, 9 * unit(&random), random_direction(&random)), aim, 0);
        size_t n = rtc_nearest(s.rtc, &ray, &left, NULL);
        for (int turn = 0; turn < TURNS && n == 1 && left.items[0].object < n_stones; turn++) {
            bool through = left.items[0].entering;
            Vec3 d =
                inward_direction(&stones, &random, ray_point(&ray, left.items[0].t), vec3_from_f(left.items[0].normal));
            if (fabs(vec3_dot(d, vec3_from_f(left.items[0].normal))) < 1e-6) break;
            rtc_leave(s.rtc, &ray, left.items, &n, through, vec3f_from(d), &ray);
            n = rtc_nearest(s.rtc, &ray, &hits, NULL);
            assert_int_equal(n, rtc_nearest(other.rtc, &ray, &searched, NULL));
            for (size_t i = 0; i < n; i++) assert_true(is_same_hit(&hits.items[i], &searched.items[i]));
            n_met++;
            n_lone += rtc_is_lone(s.rtc, left.items[0].object);
            HitList swap = hits;
            hits = left;
            left = swap;
        }
    }
    printf("%llu rays in stones, %llu of them in lone ones\n", (unsigned long long)n_met, (unsigned long long)n_lone);
    assert_true(rtc_is_lone(s.rtc, 1) && !rtc_is_lone(s.rtc, 0) && !rtc_is_lone(s.rtc, 2));
    assert_true(rtc_is_lone(s.rtc, 16) && rtc_is_lone(s.rtc, 17));
    assert_true(n_lone > n_met / 4 && n_lone < n_met);
    hit_list_clear(&hits);
    hit_list_clear(&left);
    hit_list_clear(&searched);
    rtc_scene_free(other.rtc);
    destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lone_balls),
        cmocka_unit_test(test_lone_stones),
    };
    return cmocka_run_group_tests_name("lone", tests, NULL, NULL);
}
