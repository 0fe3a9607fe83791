/* rtc_test.c - tracing without losing a surface: random walks through overlapping, coincident, nested and instanced
 * objects, in which every crossing must agree with the interior list.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "nest/cross.h"
#include "rtc_fixture.h"

/* ---- the walk ---- */

typedef struct WalkResult {
    uint64_t crossings, faults, escapes_inside;
} WalkResult;

/* Whether a hit is the first of its object, and goes another way through the surface than the list says. */
static bool is_wrong(const NestOrder *order, const NestList *list, const HitList *hits, size_t i)
{
    const Hit *hit = &hits->items[i];
    for (size_t k = 0; k < i; k++)
        if (hits->items[k].object == hit->object) return false;
    return nest_has(order, list, hit->object) == hit->entering;
}

static bool contradicts(const NestOrder *order, const NestList *list, const HitList *hits, size_t n)
{
    bool wrong = !n && nest_list_count(list);
    for (size_t i = 0; i < n; i++) wrong = wrong || is_wrong(order, list, hits, i);
    return wrong;
}

/* What a path does then (trace/event.c): asks on which side of the objects the ray starts at whose edges it does, and for what
 * has been missed on the way. */
static size_t look_again(const TestScene *s, const NestOrder *order, NestList *list, const Ray *ray, HitList *hits,
                         size_t n)
{
    HitList beside = {0}, along = {0};
    NestCrossing crossing;
    size_t n_beside = ray->t_min > 0 ? 0 : rtc_beside(s->rtc, ray, &beside, &along);
    for (size_t i = 0; i < n_beside; i++) {
        NestPass pass = {beside.items[i].object, beside.items[i].inside};
        if (nest_has(order, list, pass.hull) == pass.entering) continue;
        assert_int_equal(nest_cross(list, order, &pass, 1, &crossing), STATUS_OK);
    }
    hit_list_clear(&beside);
    hit_list_clear(&along);
    double end = n ? hits->items[0].t : HUGE_VAL;
    bool missed = false;
    for (uint32_t object = 0; object < s->n; object++) {
        bool inside = nest_has(order, list, object), wrong = !n && inside;
        for (size_t i = 0; i < n && !missed; i++)
            wrong |= hits->items[i].object == object && is_wrong(order, list, hits, i);
        if (!wrong || !rtc_find_missed(s->rtc, ray, object, !inside, end, hits)) continue;
        end = hits->items[0].t;
        missed = true;
    }
    return missed ? 1 : n;
}

/* *next becomes the list behind a place, from the one in front of it on; counted in *result. false: something is clipped there, in
 * and out of one object at once is no surface to turn away from. */
static bool cross_place(const NestOrder *order, const NestList *list, const HitList *hits, size_t n, NestList *next,
                        WalkResult *result)
{
    NestPass passes[64];
    NestCrossing crossing;
    for (size_t i = 0; i < n; i++) passes[i] = (NestPass){hits->items[i].object, hits->items[i].entering};
    assert_int_equal(nest_list_copy(next, list), STATUS_OK);
    assert_int_equal(nest_cross(next, order, passes, (uint32_t)n, &crossing), STATUS_OK);
    result->crossings += n;
    result->faults += crossing.n_faults;
    bool clipped = false;
    for (size_t i = 1; i < n; i++)
        for (size_t k = 0; k < i; k++)
            clipped |= passes[i].hull == passes[k].hull && passes[i].entering != passes[k].entering;
    return !clipped;
}

/* Away from the place of a hit, on the side of its surface that its normal stands on, or on the other. */
static Vec3 choose_direction(const TestScene *s, Vec3 place, const Hit *hit, bool outward, uint64_t *random)
{
    Vec3 direction = random_direction(random), normal = vec3_from_f(hit->normal);
    if (unit(random) < 0.3) { /* grazing, within a hundredth */
        double along = vec3_dot(direction, normal);
        direction = vec3_normalize(vec3_along(direction, -along * (1 - 1e-2), normal));
    }
    if (s->at_edges && unit(random) < 0.7) direction = vec3_normalize(vec3_sub(place_at_edge(s, random), place));
    return (vec3_dot(direction, normal) > 0) != outward ? vec3_scale(direction, -1) : direction;
}

/* The ray becomes the one that leaves a place in a new direction, and the list the one that it starts with: by that direction each
 * surface of the place is crossed or not. */
static void turn(const TestScene *s, const NestOrder *order, NestList *list, HitList *hits, size_t n, bool through,
                 Vec3 direction, Ray *ray)
{
    rtc_leave(s->rtc, ray, hits->items, &n, through, vec3f_from(direction), ray);
    for (size_t i = 0; i < n; i++) {
        NestPass pass = {hits->items[i].object, hits->items[i].inside};
        NestCrossing crossing;
        if (pass.entering == hits->items[i].entering)
            assert_int_equal(nest_cross(list, order, &pass, 1, &crossing), STATUS_OK);
    }
}

/* Walks that start far outside, cross or reflect at random in random directions, and end outside. At an escape the
 * list must be empty, too. */
static WalkResult walk(const TestScene *s, double size, uint64_t n_walks, uint64_t seed)
{
    WalkResult result = {0};
    NestHull hulls[64];
    for (uint32_t h = 0; h < s->n; h++) hulls[h] = (NestHull){h + 1, (int32_t)h, NEST_STATE_UNKNOWN, 1, false};
    NestOrder order;
    assert_int_equal(nest_order_build(&order, NEST_PRIORITY, hulls, s->n, NULL, 0, NULL), STATUS_OK);
    HitList hits = {0}, left = {0};
    NestList list, next;
    nest_list_init(&list);
    nest_list_init(&next);
    for (uint64_t w = 0; w < n_walks; w++) {
        uint64_t random = hash_u64(seed + w);
        nest_list_empty(&list);
        Vec3 aim = vec3_scale(vec3(unit(&random) - 0.5, unit(&random) - 0.5, unit(&random) - 0.5), size);
        Vec3 from = vec3_scale(random_direction(&random), s->from > 0 ? s->from : 4 * size);
        if (vec3_dot(from, s->up) < 0) from = vec3_scale(from, -1);
        if (s->at_edges) aim = place_at_edge(s, &random);
        Ray ray = ray_through(from, aim, s->time);
        for (int bounce = 0; bounce < 40; bounce++) {
            size_t n = rtc_nearest(s->rtc, &ray, &hits, NULL);
            if (hits.beside || contradicts(&order, &list, &hits, n)) n = look_again(s, &order, &list, &ray, &hits, n);
            if (!n) {
                result.escapes_inside += nest_list_count(&list) != 0;
                break;
            }
            bool turns = cross_place(&order, &list, &hits, n, &next, &result);
            if (hits.items[0].t - ray.t_min < 1e-10 * size) break; /* run into a corner, as far as double can tell */
            double choice = unit(&random);
            if (choice < 0.2 || !turns) { /* silent: the same ray goes on */
                rtc_pass_on(&ray, hits.items, n);
                assert_int_equal(nest_list_copy(&list, &next), STATUS_OK);
                continue;
            }
            bool through = choice < 0.6;
            const Hit *hit = through ? &hits.items[n - 1] : &hits.items[0];
            Vec3 direction = choose_direction(s, ray_point(&ray, hit->t), hit, through != hit->entering, &random);
            /* no ray is so close to the surface that rounding its direction takes it to the other side */
            if (fabs(vec3_dot(direction, vec3_from_f(hit->normal))) < 1e-6) break;
            turn(s, &order, &list, &hits, n, through, direction, &ray);
            HitList swap = hits;
            hits = left;
            left = swap;
        }
    }
    nest_list_clear(&list);
    nest_list_clear(&next);
    hit_list_clear(&hits);
    hit_list_clear(&left);
    nest_order_clear(&order);
    return result;
}

static void expect_no_faults(TestScene *s, const char *name, double size)
{
    const char *wanted = getenv("MENISCUS_WALKS"); /* more of them, by hand */
    build(s);
    uint64_t usual = s->at_edges ? 240000 : 60000;
    WalkResult r = walk(s, size, wanted ? strtoull(wanted, NULL, 10) : usual, 1);
    printf("%s: %llu faults, %llu escapes from inside in %llu crossings\n", name, (unsigned long long)r.faults,
           (unsigned long long)r.escapes_inside, (unsigned long long)r.crossings);
    if (s->at_edges) { /* creeping along faces, nearer than float can tell, a ray may still miss them: one in eight
                        * million, by 176 million crossings */
        assert_true((r.faults + r.escapes_inside) * (s->crossings_a_fault ? s->crossings_a_fault : 500000) <=
                    r.crossings);
    } else {
        assert_int_equal(r.faults, 0);
        assert_int_equal(r.escapes_inside, 0);
    }
    destroy(s);
}

static void test_boxes(void **state)
{
    (void)state;
    TestScene s = {0};
    for (int i = 0; i < 8; i++)
        add(&s, keep_mesh(&s, box_mesh(vec3(-10, -10, -10), vec3(10, 10, 10))), NULL,
            turned(17.0 * i, vec3(1, 0.3 * i, 0.7), vec3(3 * i - 12, 2 * (i % 3), i % 2)));
    expect_no_faults(&s, "overlapping turned boxes", 40);
}

static void test_coincident_boxes(void **state)
{
    (void)state;
    TestScene s = {0};
    Affine t = turned(31, vec3(1, 2, 3), vec3(100, -30, 7));
    add(&s, keep_mesh(&s, box_mesh(vec3(-10, -10, -10), vec3(0, 10, 10))), NULL, t);
    add(&s, keep_mesh(&s, box_mesh(vec3(0, -10, -10), vec3(10, 10, 10))), NULL, t);
    add(&s, keep_mesh(&s, box_mesh(vec3(-10, 10, -10), vec3(10, 20, 10))), NULL, t);
    add(&s, keep_mesh(&s, box_mesh(vec3(-10, -10, -10), vec3(10, 20, 10))), NULL, t); /* the three together */
    t.t = vec3(0, 0, 0);
    for (uint32_t i = 0; i < s.n; i++) s.objects[i].to_world = t;
    expect_no_faults(&s, "touching boxes with shared faces", 40);
}

/* Small things on a slab of a thousand times their size, before others of that size far away: coordinates that float rounds
 * far more coarsely than theirs, in the same scene and on the same faces. */
static void add_small_on_large(TestScene *s, double degrees)
{
    Affine t = turned(degrees, vec3(1, 2, 3), vec3(0, 0, 0));
    s->up = affine_vector(&t, vec3(0, 1, 0));
    add(s, keep_mesh(s, box_mesh(vec3(-9000, -50, -12000), vec3(15000, 0, 8000))), NULL, t);
    add(s, keep_mesh(s, box_mesh(vec3(-4, 0, -4), vec3(4, 9, 4))), NULL, t); /* stands on it */
    add(s, keep_mesh(s, box_mesh(vec3(-3, 1, -3), vec3(3, 6, 3))), NULL, t);
    add(s, keep_mesh(s, box_mesh(vec3(4, -0.5, -2), vec3(9, 7, 3))), NULL, t); /* in it, and touching the first */
    add(s, keep_mesh(s, box_mesh(vec3(-9, 0.001, -5), vec3(-4.001, 8, 5))), NULL, t); /* just above it */
    add(s, keep_mesh(s, box_mesh(vec3(-10000, -50, 5000), vec3(20000, 6000, 9000))), NULL, t);
    add(s, keep_mesh(s, box_mesh(vec3(-5, 9, -5), vec3(5, 9.01, 5))), NULL, t); /* a lid */
    for (int i = 0; i < 3; i++)
        add(s, keep_mesh(s, box_mesh(vec3(-1, -1, -1), vec3(1, 1, 1))), NULL,
            turned(40 * i, vec3(1, i, 1), vec3(3 * i - 3, 3, 2 * i - 2)));
}

/* The same on a floor of 20 km. */
static void test_small_on_kilometres(void **state)
{
    (void)state;
    TestScene s = {0};
    add_small_on_large(&s, 0);
    add(&s, keep_mesh(&s, box_mesh(vec3(-1e6, -60, -1e6), vec3(1e6, 0, 1e6))), NULL, affine_identity());
    expect_no_faults(&s, "small boxes on kilometres", 24);
}

static void test_small_on_large(void **state)
{
    (void)state;
    TestScene s = {0};
    add_small_on_large(&s, 23);
    expect_no_faults(&s, "small boxes on a large one", 24);
    TestScene level = {0};
    add_small_on_large(&level, 0);
    expect_no_faults(&level, "small boxes on a large one that is level", 24);
    /* where a ray turns on the large face at the very edge of what stands there, nothing notes that edge */
    TestScene edges = {.at_edges = true, .crossings_a_fault = 100000};
    add_small_on_large(&edges, 23);
    expect_no_faults(&edges, "edges of small boxes on a large one", 24);
}

static void add_solids(TestScene *s)
{
    Solid *ball = sphere(s, 1);
    for (int i = 0; i < 12; i++) {
        Affine scaled = turned(0, vec3(1, 0, 0), vec3(4 * cos(i), 3 * sin(2 * i), i - 6));
        for (int k = 0; k < 3; k++) scaled.m[k][k] = 2 + 0.5 * i;
        add(s, NULL, ball, scaled);
    }
    Solid *drink, *tumbler;
    static const double profile[][2] = {{0, 0}, {8, 0}, {8.5, 1}, {9, 18}, {8.4, 18}, {7.4, 3}, {0, 3}};
    static const double rounding[] = {0, 0, 0.4, 0.2, 0.2, 0.6, 0};
    Status status = solid_make_lathe(profile, 7, rounding, false, &tumbler, NULL);
    tumbler = keep_solid(s, status, tumbler);
    status = solid_make_cone(7.45, 8, 8, 0, &drink, NULL);
    drink = keep_solid(s, status, drink);
    add(s, NULL, tumbler, turned(20, vec3(0, 0, 1), vec3(0, -9, 0)));
    add(s, NULL, drink, turned(20, vec3(0, 0, 1), vec3(-1, -6.1, 0)));
}

static void test_solids(void **state)
{
    (void)state;
    TestScene s = {0};
    add_solids(&s);
    expect_no_faults(&s, "spheres, a turned glass and a cone", 40);
}

/* The same on a floor of 20 km, by rays that come from its ends. */
static void test_solids_on_kilometres(void **state)
{
    (void)state;
    TestScene s = {.up = {0, 1, 0}, .from = 9e5};
    add_solids(&s);
    add(&s, keep_mesh(&s, box_mesh(vec3(-1e6, -60, -1e6), vec3(1e6, -14, 1e6))), NULL, affine_identity());
    expect_no_faults(&s, "spheres, a turned glass and a cone on kilometres", 40);
}

/* Balls as no frame shows them: turned, mirrored, and on their way. What is met of them lies on them, and walks through them
 * have no faults. */
static void test_turned_and_moving_balls(void **state)
{
    (void)state;
    enum { STILL = 10, ALL = 20 };
    TestScene s = {.n_keys = 3, .time = 0.3};
    Solid *ball = sphere(&s, 1.5);
    Affine keys[ALL - STILL][3], there[ALL];
    for (int i = 0; i < ALL; i++) {
        double size = 1 + 0.3 * (i % 7);
        Affine map = turned(i < STILL ? 37 * i : 0, vec3(1, i, 2), vec3(5 * cos(i), 4 * sin(2 * i), 0.6 * i - 6));
        for (int row = 0; row < 3; row++)
            for (int k = 0; k < 3; k++) map.m[row][k] *= k == 0 && i < STILL && i % 3 == 1 ? -size : size;
        for (int key = 0; i >= STILL && key < 3; key++) {
            keys[i - STILL][key] = map;
            keys[i - STILL][key].t = vec3_along(map.t, key * key, vec3(0.3, -0.2, 0.5));
            for (int k = 0; k < 3; k++) keys[i - STILL][key].m[k][k] *= 1 + 0.1 * key;
        }
        add(&s, NULL, ball, map);
        if (i >= STILL) s.objects[i].keys = keys[i - STILL];
        there[i] = i < STILL ? map : affine_between(keys[i - STILL], 3, s.time);
    }
    build(&s);
    HitList hits = {0};
    uint64_t random = 5;
    int n_hits = 0;
    for (int i = 0; i < 2000; i++) {
        Vec3 from = vec3_scale(random_direction(&random), 60), aim = vec3_scale(random_direction(&random), 8);
        Ray ray = ray_through(from, aim, s.time);
        assert_true(rtc_all(s.rtc, &ray, false, &hits));
        for (size_t k = 0; k < hits.n; k++, n_hits++) {
            const Hit *hit = &hits.items[k];
            Vec3 out = vec3_sub(ray_point(&ray, hit->t), there[hit->object].t);
            Affine map = there[hit->object];
            double radius = 1.5 * fabs(cbrt(affine_determinant(&map))),
                   slope = vec3_dot(out, vec3_from_f(ray.direction));
            assert_true(fabs(vec3_length(out) - radius) < 1e-12 * 60);
            assert_true(vec3_dot(vec3_normalize(out), vec3_from_f(hit->normal)) > 1 - 1e-6);
            if (fabs(slope) > 1e-6) assert_int_equal(hit->entering, slope < 0);
        }
    }
    assert_true(n_hits > 5000);
    hit_list_clear(&hits);
    rtc_scene_free(s.rtc);
    expect_no_faults(&s, "balls, turned, mirrored and moving", 20);
}

/* More hollow pieces than a search keeps in mind: each crossing is found once, whichever eighths the ray comes through. */
static void test_many_hollow_pieces(void **state)
{
    (void)state;
    enum { RINGS = 48 };
    TestScene s = {0};
    double profile[2 * RINGS][2];
    for (int i = 0; i < RINGS; i++) { /* up outside, and down inside */
        profile[i][0] = 10 + (i % 2), profile[i][1] = i;
        profile[2 * RINGS - 1 - i][0] = 8 - (i % 2), profile[2 * RINGS - 1 - i][1] = i;
    }
    Solid *ringed = NULL;
    Status status = solid_make_lathe((const double(*)[2])profile, 2 * RINGS, NULL, false, &ringed, NULL);
    ringed = keep_solid(&s, status, ringed);
    assert_true(ringed->n_pieces > RTC_WHOLE);
    add(&s, NULL, ringed, affine_identity());
    build(&s);
    HitList hits = {0};
    uint64_t random = 3;
    int n_found = 0;
    for (int i = 0; i < 3000; i++) {
        Vec3 from = vec3_scale(random_direction(&random), 90), aim = vec3(0, RINGS * unit(&random), 0);
        aim = vec3_along(aim, 10 * unit(&random), random_direction(&random));
        Ray ray = ray_through(from, aim, s.time);
        assert_true(rtc_all(s.rtc, &ray, false, &hits));
        size_t n = 0;
        for (uint32_t k = 0; k < ringed->n_pieces; k++) {
            double t[PIECE_MAX_ROOTS];
            n += (size_t)piece_intersect(&ringed->pieces[k], from, vec3_from_f(ray.direction), 0, HUGE_VAL, t);
        }
        assert_int_equal(hits.n, n);
        n_found += (int)n;
        size_t nearest_n = n ? rtc_cluster(hits.items, hits.n) : 0;
        double nearest = n ? hits.items[0].t : 0;
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), nearest_n);
        if (n) assert_true(hits.items[0].t == nearest);
    }
    assert_true(n_found > 10000);
    hit_list_clear(&hits);
    rtc_scene_free(s.rtc);
    expect_no_faults(&s, "a glass of 48 rings", 60);
}

static void test_coincident_solids(void **state)
{
    (void)state;
    TestScene s = {0};
    Solid *outer = NULL, *inner = NULL, *glass = NULL;
    static const double profile[][2] = {{0, 0}, {9, 0}, {9, 20}, {7, 20}, {7, 2}, {0, 2}};
    Status status = solid_make_lathe(profile, 6, NULL, false, &glass, NULL);
    glass = keep_solid(&s, status, glass);
    status = solid_make_cone(7, 7, 10, 0, &inner, NULL);
    inner = keep_solid(&s, status, inner);
    status = solid_make_cone(9, 9, 20, 0, &outer, NULL);
    outer = keep_solid(&s, status, outer);
    add(&s, NULL, glass, turned(0, vec3(0, 1, 0), vec3(0, 0, 0)));
    add(&s, NULL, inner, turned(0, vec3(0, 1, 0), vec3(0, 2, 0))); /* fills the glass exactly */
    add(&s, NULL, outer, turned(45, vec3(0, 1, 0), vec3(0, 0, 0)));
    add(&s, keep_mesh(&s, box_mesh(vec3(-12, -5, -12), vec3(12, 0, 12))), NULL,
        affine_identity()); /* a plate it stands on */
    expect_no_faults(&s, "glass filled to the wall, faces shared", 40);
}

/* One mesh in many places, mirrored and stretched there. */
static void add_places(TestScene *s, const Mesh *mesh)
{
    for (int i = 0; i < 24; i++) {
        Affine t = turned(23.0 * i, vec3(i % 5, 1, i % 3), vec3(3 * cos(i), 5 * sin(3 * i), i - 12));
        if (i % 4 == 1)
            for (int row = 0; row < 3; row++) t.m[row][0] = -t.m[row][0];
        if (i % 4 == 2)
            for (int row = 0; row < 3; row++) t.m[row][1] *= 2.5;
        add(s, mesh, NULL, t);
    }
}

/* So few cuts of a box that each place is baked, and so many that all are instances. */
static const uint32_t cuts[] = {1, 3};
static const char *const cut_names[] = {"a small mesh in many places", "instances"};

static void test_instances(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cuts); i++) {
        TestScene s = {0};
        add_places(&s, keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), cuts[i])));
        expect_no_faults(&s, cut_names[i], 40);
    }
}

/* A drink that reaches into the wall of its glass, the rim of its top on a ring of edges of the glass: as a ray is reflected
 * or refracted there, it starts within rounding of both surfaces' edges. */
static void test_shared_edges(void **state)
{
    (void)state;
    TestScene s = {.at_edges = true};
    static const double glass[][2] = {{0, 0},     {30, 0},  {34, 2}, {41, 80}, {38, 80},
                                      {36.3, 50}, {35, 42}, {28, 5}, {0, 5}};
    static const double drink[][2] = {{0, 4},     {30, 4},      {36, 41}, {37.2, 49.99},
                                      {36.3, 50}, {36.2, 49.9}, {33, 49}, {0, 49}};
    static const double ice[][2] = {{0, 40}, {9, 41}, {10, 49}, {9, 60}, {0, 60}};
    Affine t = affine_identity();
    add(&s, keep_mesh(&s, lathe_mesh(drink, COUNT_OF(drink), 48)), NULL, t);
    add(&s, keep_mesh(&s, lathe_mesh(glass, COUNT_OF(glass), 48)), NULL, t);
    add(&s, keep_mesh(&s, lathe_mesh(ice, COUNT_OF(ice), 12)), NULL, t);
    expect_no_faults(&s, "a drink's rim on an edge of the glass", 120);
}

/* The same of faces and edges that lie on each other, and of one mesh in many places. */
static void test_edges(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(cuts); i++) {
        TestScene s = {.at_edges = true};
        add_places(&s, keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), cuts[i])));
        add(&s, keep_mesh(&s, box_mesh(vec3(-10, -10, -10), vec3(0, 10, 10))), NULL, affine_identity());
        add(&s, keep_mesh(&s, box_mesh(vec3(0, -10, -10), vec3(10, 10, 10))), NULL, affine_identity());
        add(&s, keep_mesh(&s, box_mesh(vec3(-10, 0, -10), vec3(10, 10, 0))), NULL, affine_identity());
        expect_no_faults(&s, cut_names[i], 40);
    }
}

/* A ray goes on behind a face within rounding of an edge of another box, whose two faces are there: one exactly where it goes
 * on, and missed, and one a little behind. */
static void test_edge_where_a_ray_goes_on(void **state)
{
    (void)state;
    TestScene s = {0};
    add(&s, keep_mesh(&s, box_mesh(vec3(-10, -10, -10), vec3(0, 10, 10))), NULL, affine_identity());
    add(&s, keep_mesh(&s, box_mesh(vec3(-10, 0, -10), vec3(10, 10, 0))), NULL, affine_identity());
    build(&s);
    HitList hits = {0};
    Ray ray = ray_make(vec3(17.139293519419098, -5.7757701759704494, -158.97447938750915),
                       vec3f(-0.16744633F, 0.0381941125F, 0.985141098F));
    assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
    assert_int_equal(hits.items[0].object, 0);
    rtc_pass_on(&ray, hits.items, 1);
    assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
    assert_int_equal(hits.items[0].object, 1);
    assert_true(hits.items[0].entering && hits.items[0].t < ray.t_min + 1e-3);
    hit_list_clear(&hits);
    destroy(&s);
}

/* A ray turns back from a face of one box within rounding of an edge of another, which Embree's ray has passed by and the exact
 * one has not: the new ray is inside of it, and is told. */
static void test_turn_at_an_edge(void **state)
{
    (void)state;
    TestScene s = {0};
    add(&s, keep_mesh(&s, box_mesh(vec3(0, -1, -14), vec3(6, 1, -10))), NULL, affine_identity());
    add(&s, keep_mesh(&s, box_mesh(vec3(0, -10, -10), vec3(10, 10, 10))), NULL, affine_identity());
    build(&s);
    HitList hits = {0}, left = {0}, along = {0};
    Ray ray = ray_make(vec3(75.662149388538751, -52.440664630270469, -130.86334797429697),
                       vec3f(-0.468084514F, 0.348356932F, 0.812123358F));
    size_t n = rtc_nearest(s.rtc, &ray, &left, NULL);
    if (n == 1 && left.items[0].object == 1) { /* as with AVX2; what float makes of the edge may differ */
        rtc_leave(s.rtc, &ray, left.items, &n, false, vec3f(-0.804547608F, 0.58775562F, -0.0851263851F), &ray);
        rtc_nearest(s.rtc, &ray, &hits, NULL);
        assert_true(hits.beside);
        HitList beside = {0};
        assert_int_equal(rtc_beside(s.rtc, &ray, &beside, &along), 1);
        assert_true(beside.items[0].object == 0 && beside.items[0].inside);
        hit_list_clear(&beside);
    }
    hit_list_clear(&hits);
    hit_list_clear(&left);
    hit_list_clear(&along);
    destroy(&s);
}

/* A step: an L in y and z, from x = -1 to 1; its reentrant edge is at y = 1, z = 0. */
static Mesh *step_mesh(void)
{
    static const float outline[6][2] = {{0, -1}, {2, -1}, {2, 0}, {1, 0}, {1, 1}, {0, 1}};
    static const uint32_t cap[4][3] = {{3, 4, 5}, {3, 5, 0}, {3, 0, 1}, {3, 1, 2}};
    Mesh *mesh;
    uint32_t n = 0;
    assert_int_equal(mesh_new(12, 20, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 12; i++) mesh->positions[i] = vec3f(i < 6 ? -1 : 1, outline[i % 6][0], outline[i % 6][1]);
    for (uint32_t i = 0; i < 6; i++) {
        uint32_t next = (i + 1) % 6;
        memcpy(mesh->triangles[n++], ((uint32_t[]){i, next, next + 6}), 3 * sizeof(uint32_t));
        memcpy(mesh->triangles[n++], ((uint32_t[]){i, next + 6, i + 6}), 3 * sizeof(uint32_t));
    }
    for (uint32_t i = 0; i < 4; i++) {
        memcpy(mesh->triangles[n++], ((uint32_t[]){cap[i][0], cap[i][2], cap[i][1]}), 3 * sizeof(uint32_t));
        memcpy(mesh->triangles[n++], ((uint32_t[]){cap[i][0] + 6, cap[i][1] + 6, cap[i][2] + 6}), 3 * sizeof(uint32_t));
    }
    return mesh;
}

/* Rays come to the very edge of an object, where they meet both of its sides at one distance, and leave in all directions. The
 * new ray knows whether it is inside of the object, and what it meets next agrees. */
static void test_on_an_edge(void **state)
{
    (void)state;
    enum { EDGES = 5, DIRECTIONS = 2000 };
    static const struct {
        Vec3 from, along;
        double quarter[2]; /* y and z of a direction between the edge's two sides */
        bool solid;        /* that quarter alone is the object's; else all but that */
    } edges[EDGES] = {
        {{.3, 8, 9}, {0, -1, -1}, {1, -1}, true},    /* grazed from outside */
        {{.3, 9, 9}, {0, -1, -1}, {-1, -1}, true},   /* met head on */
        {{.3, 9, 8}, {0, -1, -1}, {1, 1}, false},    /* reentrant, from outside */
        {{.3, .5, -.5}, {0, 1, 1}, {1, 1}, false},   /* and from within */
        {{.3, 1.5, -.5}, {0, -1, 1}, {1, 1}, false}, /* grazed from within */
    };
    TestScene s = {0};
    add(&s, keep_mesh(&s, step_mesh()), NULL, affine_identity());
    build(&s);
    HitList met = {0}, next = {0};
    uint64_t random = 1;
    for (int i = 0; i < EDGES; i++) {
        Ray ray = ray_make(edges[i].from, vec3f_from(vec3_normalize(edges[i].along)));
        for (int k = 0; k < DIRECTIONS; k++) {
            Vec3 d = random_direction(&random);
            if (fabs(d.y) < 0.01 || fabs(d.z) < 0.01) continue;
            size_t n = rtc_nearest(s.rtc, &ray, &met, NULL);
            assert_int_equal(n, 2);
            bool within = (d.y > 0) == (edges[i].quarter[0] > 0) && (d.z > 0) == (edges[i].quarter[1] > 0);
            bool inside = within == edges[i].solid;
            Ray onward;
            rtc_leave(s.rtc, &ray, met.items, &n, k % 2, vec3f_from(d), &onward);
            assert_int_equal(n, 2);
            assert_true(met.items[0].inside == inside && met.items[1].inside == inside);
            n = rtc_nearest(s.rtc, &onward, &next, NULL);
            assert_int_equal(n > 0 && !next.items[0].entering, inside);
        }
    }
    hit_list_clear(&met);
    hit_list_clear(&next);
    destroy(&s);
}

/* What is asked of all triangles is what a search finds, where nothing is missed. */
static void try_find_missed(uint32_t n_cuts)
{
    TestScene s = {0};
    add(&s, keep_mesh(&s, cut_box_mesh(vec3(-3, -1, -2), vec3(3, 1, 2), n_cuts)), NULL,
        turned(25, vec3(1, 2, 3), vec3(1, 2, 3)));
    add(&s, NULL, sphere(&s, 2), affine_identity());
    build(&s);
    HitList hits = {0}, missed = {0};
    uint64_t random = 7;
    int n_met = 0;
    for (int i = 0; i < 2000; i++) {
        Ray ray = ray_through(vec3_scale(random_direction(&random), 9), vec3_scale(random_direction(&random), 3), 0);
        assert_true(rtc_all(s.rtc, &ray, false, &hits));
        for (int entering = 0; entering < 2; entering++) {
            size_t k = 0;
            while (k < hits.n && (hits.items[k].object != 0 || hits.items[k].entering != entering)) k++;
            double t = k < hits.n ? hits.items[k].t : HUGE_VAL;
            assert_int_equal(rtc_find_missed(s.rtc, &ray, 0, entering, HUGE_VAL, &missed), k < hits.n);
            if (k == hits.n) continue;
            assert_true(missed.n == 1 && missed.items[0].t == t &&
                        missed.items[0].primitive == hits.items[k].primitive);
            assert_false(rtc_find_missed(s.rtc, &ray, 0, entering, t, &missed));
            n_met++;
        }
        assert_false(rtc_find_missed(s.rtc, &ray, 1, true, HUGE_VAL, &missed));
    }
    assert_true(n_met > 1000);
    hit_list_clear(&hits);
    hit_list_clear(&missed);
    destroy(&s);
}

static void test_find_missed(void **state)
{
    (void)state;
    try_find_missed(4);
    try_find_missed(120); /* of 172,800 triangles */
}

/* Embree may miss all triangles of a corner that a ray is aimed at: of rays from far away 13 in 1,000, were they not shown to
 * it from nearer by. What it misses is found where it is asked for. */
static void test_corner_from_afar(void **state)
{
    (void)state;
    TestScene s = {0};
    static const double profile[][2] = {{0, 0}, {30, 0}, {34, 2}, {41, 80}, {0, 80}};
    add(&s, keep_mesh(&s, lathe_mesh(profile, COUNT_OF(profile), 48)), NULL, affine_identity());
    build(&s);
    HitList hits = {0};
    uint64_t random = 11;
    int n_entered = 0, n_missed = 0;
    for (int i = 0; i < 300000; i++) {
        Vec3 corner = vec3_from_f(s.meshes[0]->positions[2 + i % 48]); /* at the rim of the bottom */
        Vec3 from = vec3_scale(random_direction(&random), 480),
             aim = vec3_along(corner, 1e-5, random_direction(&random));
        if (from.y > -300) continue;
        Ray ray = ray_through(from, aim, 0);
        n_entered++;
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
        if (hits.items[0].entering) continue;
        n_missed++;
        assert_true(rtc_find_missed(s.rtc, &ray, 0, true, hits.items[0].t, &hits));
        assert_true(hits.items[0].entering);
    }
    assert_true(n_missed * 200 < n_entered);
    assert_true(n_entered > 30000);
    hit_list_clear(&hits);
    destroy(&s);
}

/* A plate, object 0, whose top is at y = 0, and a post through it with a face at x = 0; turned and moved at random. */
static Affine add_plate_and_post(TestScene *s, double half, uint32_t cuts_of_plate, uint64_t *random)
{
    Affine place = turned(360 * unit(random), random_direction(random), vec3_scale(random_direction(random), 100));
    add(s, keep_mesh(s, cut_box_mesh(vec3(-half, -20, -30), vec3(half, 0, 30), cuts_of_plate)), NULL, place);
    add(s, keep_mesh(s, box_mesh(vec3(0, -30, -40), vec3(20, 10, 40))), NULL, place);
    return place;
}

/* A face that a ray grazes stands just in front of one that it meets steeply, and by Embree's distances often behind it: it is
 * not lost, whatever the size of its triangles, and of the scene. */
static void test_grazed_in_front(void **state)
{
    (void)state;
    enum { SCENES = 12, RAYS = 8000 };
    HitList hits = {0}, plate = {0}, post = {0};
    int n_met = 0, n_lost = 0;
    for (int k = 0; k < SCENES; k++) {
        TestScene s = {0};
        uint64_t random = hash_u64(1000 + (uint64_t)k);
        double half = k % 4 == 3 ? 300 : 30;
        Affine place = add_plate_and_post(&s, half, k % 3 ? 1 : 4, &random);
        add(&s, keep_mesh(&s, box_mesh(vec3(1399, 0, 0), vec3(1400, 1, 1))), NULL, affine_identity());
        build(&s);
        for (int i = 0; i < RAYS; i++) {
            double slope = 2e-4 * pow(50, unit(&random)), gap = .01 * pow(100, unit(&random));
            Vec3 aim = vec3(0, -gap * slope, 40 * unit(&random) - 20), along = vec3(1, -slope, unit(&random) - 0.5);
            Vec3 from = vec3_along(aim, -20 * pow(40, unit(&random)), along);
            Ray ray = ray_through(affine_point(&place, from), affine_point(&place, aim), 0);
            if (!rtc_find_missed(s.rtc, &ray, 0, true, HUGE_VAL, &plate) ||
                !rtc_find_missed(s.rtc, &ray, 1, true, HUGE_VAL, &post))
                continue;
            const Hit *first = &plate.items[0], *second = &post.items[0];
            if (first->t >= second->t || rtc_together(first, second) || !first->clear) continue;
            n_met++;
            n_lost += rtc_nearest(s.rtc, &ray, &hits, NULL) == 0 || hits.items[0].object != 0;
        }
        destroy(&s);
    }
    printf("grazed in front of another: %d lost of %d\n", n_lost, n_met);
    assert_true(n_met > SCENES * RAYS / 2);
    assert_int_equal(n_lost, 0);
    hit_list_clear(&hits);
    hit_list_clear(&plate);
    hit_list_clear(&post);
}

/* A ray leaves a post so little above the plate that it stands in that the two are just not at one place, or up to some hundred times
 * that, and grazes the plate: it meets it, though what Embree says of the distance is off by many times that. */
static void test_grazed_at_the_start(void **state)
{
    (void)state;
    enum { SCENES = 24, RAYS = 8000 };
    HitList hits = {0}, next = {0}, plate = {0};
    int n_met = 0, n_lost = 0;
    for (int k = 0; k < SCENES; k++) {
        TestScene s = {0};
        uint64_t random = hash_u64(2000 + (uint64_t)k);
        Affine place = add_plate_and_post(&s, 40, k % 3 ? 1 : 4, &random);
        build(&s);
        for (int i = 0; i < RAYS; i++) {
            double slope = 2e-4 * pow(50, unit(&random)), height = 1e-5 * pow(1e3, unit(&random));
            Vec3 aim = vec3(0, height, 40 * unit(&random) - 20),
                 along = vec3_normalize(vec3(-1, -slope, unit(&random) - 0.5));
            Ray ray =
                ray_through(affine_point(&place, vec3_along(aim, 8, vec3(-1, 2, 0.3))), affine_point(&place, aim), 0);
            size_t n = rtc_nearest(s.rtc, &ray, &hits, NULL);
            if (n != 1 || hits.items[0].object != 1) continue;
            rtc_leave(s.rtc, &ray, hits.items, &n, false, vec3f_from(vec3_normalize(affine_vector(&place, along))),
                      &ray);
            if (!rtc_find_missed(s.rtc, &ray, 0, true, HUGE_VAL, &plate) || !plate.items[0].clear) continue;
            n_met++;
            n_lost += rtc_nearest(s.rtc, &ray, &next, NULL) == 0 || next.items[0].object != 0;
        }
        destroy(&s);
    }
    printf("grazed at the start: %d lost of %d\n", n_lost, n_met);
    assert_true(n_met > SCENES * RAYS / 4);
    assert_int_equal(n_lost, 0);
    hit_list_clear(&hits);
    hit_list_clear(&next);
    hit_list_clear(&plate);
}

/* Two faces 20 units in the last place apart are two; faces at one place are one cluster. */
static void test_gap_is_kept(void **state)
{
    (void)state;
    TestScene s = {0};
    double gap = 20 * 0x1p-23 * 100;
    add(&s, keep_mesh(&s, box_mesh(vec3(90, -10, -10), vec3(100, 10, 10))), NULL, affine_identity());
    add(&s, keep_mesh(&s, box_mesh(vec3(100 + gap, -10, -10), vec3(110, 10, 10))), NULL, affine_identity());
    add(&s, keep_mesh(&s, box_mesh(vec3(110, -10, -10), vec3(120, 10, 10))), NULL, affine_identity());
    build(&s);
    HitList hits = {0};
    Ray ray = ray_make(vec3(0, 1, 2), vec3f(1, 0, 0));
    static const size_t expected[] = {1, 1, 1, 2, 1};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), expected[i]);
        ray.t_min = hits.items[hits.n - 1].t;
    }
    assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 0);
    hit_list_clear(&hits);
    destroy(&s);
}

/* A floor of 20 km whose corners are all at one height stands at that height, however coarse they are along it: as it was made,
 * and moved there from near by. What it was rounded to far from there before it was moved counts. */
static void test_above_a_large_floor(void **state)
{
    (void)state;
    static const struct {
        double low, high, moved, pane;
        size_t met_by_floor; /* what is met at one place with it */
    } cases[] = {{-50, 0, 0, 0.02, 1},
                 {-50, 0, 0, 0, 2},
                 {-25, 25, -25, 0.02, 1},
                 {-25, 25, -25, 0, 2},
                 {0, 1e6, -1e6, 0.02, 2}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        TestScene s = {0};
        add(&s, keep_mesh(&s, box_mesh(vec3(-1e6, cases[i].low, -1e6), vec3(1e6, cases[i].high, 1e6))), NULL,
            turned(0, vec3(1, 0, 0), vec3(0, cases[i].moved, 0)));
        add(&s, keep_mesh(&s, box_mesh(vec3(-5, cases[i].pane, -5), vec3(5, cases[i].pane + 1, 5))), NULL,
            affine_identity());
        build(&s);
        for (int from = 0; from < 2; from++) { /* near, and from above */
            HitList hits = {0};
            Ray ray = ray_make(vec3(1, from ? 400 : 9, -2), vec3f_normalize(vec3f(0.001F, -1, 0.002F)));
            assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
            rtc_pass_on(&ray, hits.items, 1);
            for (size_t n = 0; n < 2; n += hits.n) {
                size_t met = rtc_nearest(s.rtc, &ray, &hits, NULL);
                assert_int_equal(met, cases[i].met_by_floor);
                rtc_pass_on(&ray, hits.items, met);
            }
            hit_list_clear(&hits);
        }
        destroy(&s);
    }
}

/* Walks into the corner between a ball and a face that cuts it, until double does not tell the two apart. At each turn on the
 * face, in the ball, the ray out of it meets the ball's surface, or is said to start outside. Returns whether it came to that. */
static bool walk_into_corner(const TestScene *s, Vec3 from)
{
    const Vec3f up = vec3f_normalize(vec3f(1, 0.02F, 0)), down = vec3f_normalize(vec3f(1, -0.2F, 0));
    HitList hits = {0}, left = {0}, beside = {0}, along = {0};
    bool outside = false, on_face = false;
    Ray ray = ray_make(from, down);
    for (int turn = 0; turn < 60 && !outside; turn++, on_face = !on_face) {
        size_t n = rtc_nearest(s->rtc, &ray, &hits, NULL);
        if (n > 1) break; /* both at one place */
        if (on_face && (n == 0 || hits.items[0].object != 0)) {
            assert_true(hits.beside);
            assert_int_equal(rtc_beside(s->rtc, &ray, &beside, &along), 1);
            assert_int_equal(beside.items[0].object, 0);
            assert_false(beside.items[0].inside);
            outside = true;
            break;
        }
        assert_int_equal(n, 1);
        assert_int_equal(hits.items[0].object, on_face ? 0 : 1);
        rtc_leave(s->rtc, &ray, hits.items, &n, false, on_face ? down : up, &ray);
        HitList swap = left; /* the ray refers to it */
        left = hits;
        hits = swap;
    }
    hit_list_clear(&hits);
    hit_list_clear(&left);
    hit_list_clear(&beside);
    hit_list_clear(&along);
    return outside;
}

static void test_into_narrow_corners(void **state)
{
    (void)state;
    TestScene s = {0};
    Solid *ball = NULL;
    assert_int_equal(solid_new(1, &ball, NULL), STATUS_OK);
    ball->pieces[0] = (Piece){.kind = PIECE_SPHERE, .r0 = 1};
    add(&s, NULL, keep_solid(&s, STATUS_OK, ball), turned(0, vec3(1, 0, 0), vec3(140, -0.995, 30)));
    add(&s, keep_mesh(&s, box_mesh(vec3(130, -5, 20), vec3(150, 0, 40))), NULL, affine_identity());
    build(&s);
    int n_outside = 0;
    for (int i = 0; i < 200; i++) n_outside += walk_into_corner(&s, vec3(140 + 1e-4 * i, 0.002, 30 + 3e-4 * i));
    assert_true(n_outside > 20);
    destroy(&s);
}

/* The edge between the halves of a flat face is none, however coarse they are; that of a folded one is. */
static void test_halves_of_a_face(void **state)
{
    (void)state;
    for (int folded = 0; folded < 2; folded++) {
        TestScene s = {0};
        Mesh *floor = keep_mesh(&s, box_mesh(vec3(-1e6, -50, -1e6), vec3(1e6, 0, 1e6)));
        if (folded) floor->positions[3].y = 1000;
        add(&s, floor, NULL, affine_identity());
        build(&s);
        HitList hits = {0};
        Ray ray = ray_make(vec3(5.0001, 9, 5), vec3f(0, -1, 0));
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 1);
        assert_int_equal(hits.items[0].clear, !folded);
        hit_list_clear(&hits);
        destroy(&s);
    }
}

/* Few solids are held against rays by themselves, many are in Embree's hierarchy: the same surfaces are met in both, by
 * rays along axes, too. Spheres far off make many of them. */
static void test_few_as_many(void **state)
{
    (void)state;
    enum { MOST = 8, RAYS = 4000 };
    HitList few = {0}, many = {0};
    uint64_t random = 1;
    size_t n_met = 0;
    for (uint32_t n = 1; n <= MOST; n++) {
        TestScene s = {0}, with_others = {0};
        add(&s, keep_mesh(&s, box_mesh(vec3(-3, -3, -3), vec3(3, 3, 3))), NULL, affine_identity());
        Solid *ball = sphere(&s, 2);
        for (uint32_t i = 0; i < n; i++) add(&s, NULL, ball, turned(0, vec3(1, 0, 0), vec3(i - 4.0, i % 3, i % 2)));
        with_others = s;
        for (uint32_t i = 0; i <= MOST; i++)
            add(&with_others, NULL, ball, turned(0, vec3(1, 0, 0), vec3(0, 50 + i, 0)));
        add(&s, NULL, ball, turned(0, vec3(1, 0, 0), vec3(0, 50 + MOST, 0))); /* as wide */
        build(&s);
        build(&with_others);
        for (int i = 0; i < RAYS; i++) {
            Vec3 from = vec3_scale(random_direction(&random), 12), to = vec3_scale(random_direction(&random), 4);
            Vec3f direction = vec3f_from(vec3_normalize(vec3_sub(to, from)));
            if (i % 4 == 0) direction = vec3f(i % 8 ? 1 : -1, 0, 0);
            Ray ray = ray_make(from, direction);
            ray.t_max = 24;
            assert_true(rtc_all(s.rtc, &ray, false, &few) && rtc_all(with_others.rtc, &ray, false, &many));
            assert_int_equal(few.n, many.n);
            for (size_t k = 0; k < few.n; k++)
                assert_true(few.items[k].t == many.items[k].t && few.items[k].object == many.items[k].object);
            n_met += few.n;
            size_t n_nearest = rtc_nearest(s.rtc, &ray, &few, NULL);
            assert_int_equal(n_nearest, rtc_nearest(with_others.rtc, &ray, &many, NULL));
            for (size_t k = 0; k < n_nearest; k++) assert_int_equal(few.items[k].object, many.items[k].object);
        }
        rtc_scene_free(with_others.rtc);
        destroy(&s);
    }
    assert_true(n_met > MOST * RAYS);
    hit_list_clear(&few);
    hit_list_clear(&many);
}

/* A thousand faces at one place are all found. */
static void test_many_at_one_place(void **state)
{
    (void)state;
    enum { N = 1000 };
    static RtcObject objects[N];
    Mesh *meshes[N];
    for (int i = 0; i < N; i++) {
        meshes[i] = box_mesh(vec3(0, -10, -10), vec3(10 + i * 0.01, 10, 10));
        objects[i] = (RtcObject){.mesh = meshes[i], .to_world = turned(0, vec3(1, 0, 0), vec3(0, 0, 0))};
    }
    RtcScene *rtc;
    assert_int_equal(rtc_scene_new(objects, N, 0, 1, &rtc, NULL), STATUS_OK);
    HitList hits = {0};
    Ray ray = ray_make(vec3(-50, 1, 2), vec3f(1, 0, 0));
    assert_int_equal(rtc_nearest(rtc, &ray, &hits, NULL), N);
    Ray back = ray_make(vec3(50, 1, 2), vec3f(-1, 0, 0));
    assert_true(rtc_all(rtc, &back, false, &hits));
    assert_int_equal(hits.n, 2 * N);
    hit_list_clear(&hits);
    rtc_scene_free(rtc);
    for (int i = 0; i < N; i++) mesh_free(meshes[i]);
}

static void test_hostile_rays(void **state)
{
    (void)state;
    TestScene s = {0};
    add(&s, keep_mesh(&s, box_mesh(vec3(-1, -1, -1), vec3(1, 1, 1))), NULL, affine_identity());
    build(&s);
    HitList hits = {0};
    const float bad[] = {NAN, INFINITY, -INFINITY, 1e30f};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        Ray ray = ray_make(vec3((double)bad[i], 0, 0), vec3f(1, 0, 0));
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 0);
        ray = ray_make(vec3(0, 0, 0), vec3f(0, bad[i], 0));
        assert_int_equal(rtc_nearest(s.rtc, &ray, &hits, NULL), 0);
    }
    hit_list_clear(&hits);
    destroy(&s);
}

/* Planes without end, moved, turned and stretched, and on the move: where rays meet them, by their frames. */
static void test_planes(void **state)
{
    (void)state;
    enum { RAYS = 20000, PLANES = 4 };
    TestScene s = {0};
    Solid *plane = NULL;
    assert_int_equal(solid_new(1, &plane, NULL), STATUS_OK);
    plane->pieces[0].kind = PIECE_PLANE;
    plane = keep_solid(&s, STATUS_OK, plane);
    Affine stretched = turned(40, vec3(1, 2, 3), vec3(-20, 3, 1));
    for (int row = 0; row < 3; row++) stretched.m[row][1] *= -2.5; /* and mirrored */
    const Affine keys[2] = {turned(10, vec3(1, 0, 0), vec3(0, 20, 0)), turned(50, vec3(1, 0, 1), vec3(5, 30, 0))};
    add(&s, NULL, plane, turned(0, vec3(0, 1, 0), vec3(3, -7, 5)));
    add(&s, NULL, plane, turned(0, vec3(0, 1, 0), vec3(0, -9, 0)));
    for (int k = 0; k < 3; k++) s.objects[1].to_world.m[k][k] = 3;
    add(&s, NULL, plane, stretched);
    add(&s, NULL, plane, keys[0]);
    s.objects[3].keys = keys;
    assert_int_equal(rtc_scene_new(s.objects, s.n, 2, 1, &s.rtc, NULL), STATUS_OK);
    HitList hits = {0}, nearest = {0};
    uint64_t random = 5;
    for (int i = 0; i < RAYS; i++) {
        Vec3 origin = vec3_scale(random_direction(&random), 60 * unit(&random));
        Ray ray = ray_make(origin, vec3f_from(random_direction(&random)));
        ray.time = unit(&random);
        assert_true(rtc_all(s.rtc, &ray, false, &hits));
        size_t n = 0;
        for (uint32_t k = 0; k < PLANES; k++) {
            Affine to_world = k == 3 ? affine_between(keys, 2, ray.time) : s.objects[k].to_world, to_local;
            assert_true(affine_invert(&to_world, &to_local));
            double slope = affine_vector(&to_local, vec3_from_f(ray.direction)).y;
            double t = -affine_point(&to_local, origin).y / slope;
            if (!(t > 0)) continue;
            size_t at = 0;
            while (at < hits.n && hits.items[at].object != k) at++;
            assert_true(at < hits.n);
            assert_true(fabs(hits.items[at].t - t) <= 1e-11 * (60 + t) / fabs(slope));
            assert_int_equal(hits.items[at].entering, slope < 0);
            n++;
        }
        assert_int_equal(hits.n, n);
        assert_int_equal(rtc_nearest(s.rtc, &ray, &nearest, NULL), n > 0);
        if (n) assert_int_equal(nearest.items[0].object, hits.items[0].object);
    }
    hit_list_clear(&hits);
    hit_list_clear(&nearest);
    destroy(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_boxes),
        cmocka_unit_test(test_coincident_boxes),
        cmocka_unit_test(test_small_on_large),
        cmocka_unit_test(test_small_on_kilometres),
        cmocka_unit_test(test_solids),
        cmocka_unit_test(test_solids_on_kilometres),
        cmocka_unit_test(test_turned_and_moving_balls),
        cmocka_unit_test(test_many_hollow_pieces),
        cmocka_unit_test(test_coincident_solids),
        cmocka_unit_test(test_planes),
        cmocka_unit_test(test_instances),
        cmocka_unit_test(test_edge_where_a_ray_goes_on),
        cmocka_unit_test(test_turn_at_an_edge),
        cmocka_unit_test(test_on_an_edge),
        cmocka_unit_test(test_find_missed),
        cmocka_unit_test(test_corner_from_afar),
        cmocka_unit_test(test_grazed_in_front),
        cmocka_unit_test(test_grazed_at_the_start),
        cmocka_unit_test(test_gap_is_kept),
        cmocka_unit_test(test_above_a_large_floor),
        cmocka_unit_test(test_into_narrow_corners),
        cmocka_unit_test(test_halves_of_a_face),
        cmocka_unit_test(test_few_as_many),
        cmocka_unit_test(test_many_at_one_place),
        cmocka_unit_test(test_hostile_rays),
        cmocka_unit_test(test_shared_edges),
        cmocka_unit_test(test_edges),
    };
    return cmocka_run_group_tests_name("rtc", tests, NULL, NULL);
}
