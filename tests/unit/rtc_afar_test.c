/* rtc_afar_test.c - rays from kilometres away miss nothing small: what double finds by asking every piece, and of balls what wider
 * numbers say, is what a search finds.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "rtc_fixture.h"

enum { DROPS = 24 };

/* Drops, a glass and a ring in and about a cube of 20, some of them 300 and 1,000 times as far away. */
static void add_pieces(TestScene *s, uint32_t n_drops)
{
    static const double profile[][2] = {{0, 0}, {3, 0}, {3.5, 9}, {3.2, 9}, {2.7, 0.5}, {0, 0.5}};
    static const double rounding[] = {0, 0.3, 0.1, 0.1, 0.3, 0};
    Solid *drop = sphere(s, 1), *glass, *ring;
    Status status = solid_make_lathe(profile, COUNT_OF(profile), rounding, false, &glass, NULL);
    glass = keep_solid(s, status, glass);
    status = solid_make_torus(1.5, 0.4, &ring, NULL);
    ring = keep_solid(s, status, ring);
    uint64_t random = 17;
    for (uint32_t i = 0; i < n_drops; i++) {
        Affine at = affine_identity();
        double size = 0.02 * pow(30, unit(&random));
        for (int k = 0; k < 3; k++) at.m[k][k] = size;
        at.t = vec3(20 * unit(&random) - 10, size + 10 * unit(&random), 20 * unit(&random) - 10);
        if (i % 8 == 5) at.t = vec3_scale(at.t, i % 16 == 5 ? 300 : 1000);
        add(s, NULL, drop, at);
    }
    if (n_drops < DROPS) return;
    add(s, NULL, glass, turned(0, vec3(0, 1, 0), vec3(2, 0, -1)));
    add(s, NULL, glass, turned(25, vec3(1, 1, 0), vec3(3000, 5, 900)));
    add(s, NULL, ring, turned(40, vec3(1, 0, 2), vec3(-5, 2, 3)));
}

/* A place at an object, at the very rim of a ball as it is seen from a place. */
static Vec3 place_at(const TestScene *s, uint32_t object, Vec3 from, uint64_t *random)
{
    const RtcPlaced *placed = &s->rtc->objects[object];
    if (!placed->ball) return vec3_along(placed->place, 4 * unit(random), random_direction(random));
    Vec3 sight = vec3_normalize(vec3_sub(placed->place, from)), across = vec3_cross(sight, random_direction(random));
    double offset = pow(10, -7 * unit(random)), side = unit(random) < 0.7 ? 1 - offset : 1 + offset;
    return vec3_along(placed->place, placed->radius * side, vec3_normalize(across));
}

/* How far a ball's centre is from the ray's line, in radii; its centre must be in front of the start. */
static long double distance_of_line(const RtcPlaced *ball, const Ray *ray)
{
    long double p[3] = {(long double)ball->place.x - (long double)ray->origin.x,
                        (long double)ball->place.y - (long double)ray->origin.y,
                        (long double)ball->place.z - (long double)ray->origin.z};
    long double d[3] = {(long double)ray->direction.x, (long double)ray->direction.y, (long double)ray->direction.z};
    long double square = 0, length = 0;
    for (int i = 0; i < 3; i++) {
        int k = (i + 1) % 3;
        square += (p[i] * d[k] - p[k] * d[i]) * (p[i] * d[k] - p[k] * d[i]);
        length += d[i] * d[i];
    }
    return sqrtl(square / length) / (long double)ball->radius;
}

/* How often a search has met an object. */
static size_t count_of(const HitList *hits, uint32_t object)
{
    size_t n = 0;
    for (size_t i = 0; i < hits->n; i++) n += hits->items[i].object == object;
    return n;
}

/* And how often the ray meets the object's pieces, when all are asked. */
static size_t count_by_pieces(const TestScene *s, uint32_t object, const Ray *ray)
{
    const RtcPlaced *placed = &s->rtc->objects[object];
    Affine to_local = rtc_to_local(s->rtc, placed, 0);
    PieceLine line =
        piece_line(affine_point(&to_local, ray->origin), affine_vector(&to_local, vec3_from_f(ray->direction)));
    size_t n = 0;
    for (uint32_t i = 0; i < placed->solid->n_pieces; i++) {
        PieceCrossings crossings;
        piece_cross(&placed->solid->pieces[i], &line, 0, HUGE_VAL, PIECE_START_ELSEWHERE, &crossings);
        n += (size_t)crossings.n;
    }
    return n;
}

typedef struct Tally {
    size_t n_met, n_passed_by, n_lost;
} Tally;

static void compare(const TestScene *s, uint32_t object, const Ray *ray, HitList *all, HitList *nearest, Tally *tally)
{
    assert_true(rtc_all(s->rtc, ray, false, all));
    for (uint32_t i = 0; i < s->n; i++) {
        const RtcPlaced *other = &s->rtc->objects[i];
        if (other->is_mesh || rtc_is_plane(s->rtc, i)) continue;
        size_t n = count_of(all, i), expected;
        if (other->ball) {
            long double distance = distance_of_line(other, ray);
            bool in_front = vec3_dot(vec3_sub(other->place, ray->origin), vec3_from_f(ray->direction)) > other->radius;
            if (fabsl(distance - 1) < 1e-8L) continue; /* what double makes of it */
            expected = in_front && distance < 1 ? 2 : 0;
        } else {
            expected = count_by_pieces(s, i, ray);
        }
        tally->n_met += expected > 0;
        tally->n_passed_by += i == object && expected == 0;
        tally->n_lost += n != expected;
    }
    size_t n = rtc_nearest(s->rtc, ray, nearest, NULL);
    tally->n_lost += n != rtc_cluster(all->items, all->n);
    for (size_t i = 0; i < n; i++)
        tally->n_lost += nearest->items[i].object != all->items[i].object || nearest->items[i].t != all->items[i].t;
    s->rtc->objects[object].opaque = true; /* such are asked about as they are found */
    Ray shadow = *ray;
    bool open = rtc_all(s->rtc, &shadow, true, nearest);
    tally->n_lost += open != (count_of(all, object) == 0);
    s->rtc->objects[object].opaque = false;
}

/* Rays from places of a floor, object 0, on their way to a piece. False where the floor is not met there. */
static bool leave_floor(const TestScene *s, Vec3 place, Vec3 aim, HitList *hits, Ray *ray)
{
    *ray = ray_make(vec3(place.x, 40, place.z), vec3f(0, -1, 0));
    size_t n = rtc_nearest(s->rtc, ray, hits, NULL);
    if (n != 1 || hits->items[0].object != 0) return false;
    Vec3 from = ray_point(ray, hits->items[0].t), direction = vec3_normalize(vec3_sub(aim, from));
    if (direction.y < 1e-9) return false;
    rtc_leave(s->rtc, ray, hits->items, &n, false, vec3f_from(direction), ray);
    return true;
}

static void shoot(TestScene *s, const char *name)
{
    enum { RAYS = 40000 };
    HitList all = {0}, nearest = {0}, floor = {0};
    Tally tally = {0};
    uint64_t random = 3;
    build(s);
    for (int i = 0; i < RAYS; i++) {
        double away = pow(10, 1 + 7 * unit(&random));
        uint32_t object = (uint32_t)(unit(&random) * s->n);
        const RtcPlaced *placed = &s->rtc->objects[object];
        if (placed->is_mesh || rtc_is_plane(s->rtc, object)) continue;
        Vec3 from = vec3_scale(random_direction(&random), away), aim = place_at(s, object, from, &random);
        from.y = fabs(from.y);
        Ray ray = ray_through(from, aim, 0);
        if (i % 2 && !leave_floor(s, from, aim, &floor, &ray)) continue;
        compare(s, object, &ray, &all, &nearest, &tally);
    }
    printf("%s: %zu pieces met, %zu passed by, %zu lost\n", name, tally.n_met, tally.n_passed_by, tally.n_lost);
    assert_true(tally.n_met > 10000 && tally.n_passed_by > 2000);
    assert_int_equal(tally.n_lost, 0);
    hit_list_clear(&all);
    hit_list_clear(&nearest);
    hit_list_clear(&floor);
    destroy(s);
}

static void test_floors_of_kilometres(void **state)
{
    (void)state;
    for (double half = 10; half < 2e7; half *= 10) {
        char name[64];
        TestScene s = {0};
        snprintf(name, sizeof name, "on a floor of %g", 2 * half);
        add(&s, keep_mesh(&s, box_mesh(vec3(-half, -50, -half), vec3(half, 0, half))), NULL, affine_identity());
        add_pieces(&s, DROPS);
        shoot(&s, name);
    }
}

/* On which side of each edge the query's line passes: by how much, times the edge's length. away: about where it does so. */
static void sides_of(const Query *query, double away, const Vec3 corner[3], long double side[3])
{
    long double d[3] = {query->direction.x, query->direction.y, query->direction.z}, at[3][3];
    for (int c = 0; c < 3; c++) {
        at[c][0] = (long double)corner[c].x - query->origin.x - away * d[0];
        at[c][1] = (long double)corner[c].y - query->origin.y - away * d[1];
        at[c][2] = (long double)corner[c].z - query->origin.z - away * d[2];
    }
    for (int c = 0; c < 3; c++) {
        const long double *a = at[(c + 1) % 3], *b = at[(c + 2) % 3];
        side[c] = 0;
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            side[c] += d[k] * (a[l] * b[m] - a[m] * b[l]);
        }
    }
}

/* Of triangles down to 1e-6 and lines that come from up to 1e6: what double says is what wider numbers say, wherever that
 * is beyond what the rounding of coordinates can change. A landscape seen from the sun took minutes, as the lines that met nothing but
 * rounding were looked at closer and closer. */
static void test_lines_from_afar_meet_small_triangles(void **state)
{
    (void)state;
    enum { LINES = 400000 };
    uint64_t random = 29;
    size_t n_met = 0, n_clear = 0, n_wrong = 0;
    for (int i = 0; i < LINES; i++) {
        double size = pow(10, -6 * unit(&random)), away = pow(10, 6 * unit(&random)),
               beside = i % 2 ? size : 100 * unit(&random);
        Vec3 centre = vec3(100 * unit(&random), 100 * unit(&random), 100 * unit(&random)), corner[3];
        for (int c = 0; c < 3; c++) corner[c] = vec3_along(centre, size, random_direction(&random));
        Query query = {.direction = vec3_from_f(vec3f_from(random_direction(&random)))};
        query.origin = vec3_along(vec3_along(centre, beside, random_direction(&random)), -away, query.direction);
        double weight[3];
        long double side[3];
        bool meets = rtc_line_meets(&query, corner, weight);
        sides_of(&query, away, corner, side);
        long double nearest = fminl(fabsl(side[0]), fminl(fabsl(side[1]), fabsl(side[2])));
        if (nearest < 0x1p-50L * (long double)(away * (size + beside))) continue;
        bool met = (side[0] > 0) == (side[1] > 0) && (side[1] > 0) == (side[2] > 0);
        n_clear++;
        n_met += met;
        n_wrong += meets != met;
    }
    printf("%zu of %zu lines meet a triangle, %zu not as they should\n", n_met, n_clear, n_wrong);
    assert_true(n_clear > LINES / 2 && n_met > LINES / 40);
    assert_int_equal(n_wrong, 0);
}

/* How far the boxes of drops near the origin are from them at most. */
static double widest_margin(const TestScene *s)
{
    const RtcPieceSet *set = &s->rtc->still;
    double widest = 0;
    for (uint32_t i = 0; i < set->n_balls; i++) {
        struct RTCBounds box;
        struct RTCBoundsFunctionArguments asked = {
            .geometryUserPtr = (void *)(uintptr_t)set, .primID = i, .bounds_o = &box};
        rtc_piece_bounds(&asked);
        const RtcPlaced *ball = &s->rtc->objects[set->balls[i]];
        if (vec3_length(ball->place) < 20) widest = fmax(widest, (double)box.upper_x - ball->place.x - ball->radius);
    }
    return widest;
}

/* The boxes around small pieces stay small, for rays that pass by them are slow, and coarse is what is near, not what is large. */
static void test_what_is_large_costs_little(void **state)
{
    (void)state;
    TestScene s = {0};
    add(&s, keep_mesh(&s, box_mesh(vec3(-1e6, -50, -1e6), vec3(1e6, 0, 1e6))), NULL, affine_identity());
    add(&s, keep_mesh(&s, box_mesh(vec3(-4, -1, -4), vec3(4, 3, 4))), NULL, turned(0, vec3(0, 1, 0), vec3(0, 1, 9)));
    add_pieces(&s, DROPS);
    build(&s);
    assert_true(widest_margin(&s) < 0.01); /* 1.9, if all were as wide as for the ends of the floor */
    assert_true(s.rtc->grain.most < 20);   /* the floor is as exact as its height */
    destroy(&s);
}

/* So few that Embree does not know of them. */
static void test_few(void **state)
{
    (void)state;
    for (uint32_t n = 2; n < 8; n += 3) {
        TestScene s = {0};
        add(&s, keep_mesh(&s, box_mesh(vec3(-1e6, -50, -1e6), vec3(1e6, 0, 1e6))), NULL, affine_identity());
        add_pieces(&s, n);
        shoot(&s, n == 2 ? "two" : "few");
    }
}

/* A plane has points farther away than all that has bounds. */
static void test_on_a_plane(void **state)
{
    (void)state;
    for (uint32_t n = 2; n <= DROPS; n += DROPS - 2) {
        TestScene s = {0};
        Solid *plane;
        assert_int_equal(solid_new(1, &plane, NULL), STATUS_OK);
        plane->pieces[0].kind = PIECE_PLANE;
        keep_solid(&s, STATUS_OK, plane);
        add(&s, NULL, plane, affine_identity());
        add_pieces(&s, n);
        shoot(&s, "on a plane");
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_floors_of_kilometres),
        cmocka_unit_test(test_lines_from_afar_meet_small_triangles),
        cmocka_unit_test(test_what_is_large_costs_little),
        cmocka_unit_test(test_few),
        cmocka_unit_test(test_on_a_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
