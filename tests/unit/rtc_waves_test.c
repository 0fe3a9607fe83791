/* rtc_waves_test.c - rays that creep over meshes of gentle waves, and rays in the edge of a blade.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/clock.h"
#include "icosphere.h"
#include "rtc_fixture.h"

#include <math.h>

enum { CUTS = 60, TURNS = 6 };

/* A block whose top has waves of so high, off the origin, as the water of a pool. */
static void add_water(TestScene *s, double height)
{
    Mesh *mesh = keep_mesh(s, cut_box_mesh(vec3(-260, -140, -100), vec3(-90, 0, 300), CUTS));
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        Vec3f *p = &mesh->positions[i];
        double x = (double)p->x, z = (double)p->z;
        if (p->y == 0)
            p->y = (float)(height * (sin(.05 * x + .02 * z) + .4 * sin(.11 * x - .07 * z + 1) + .2 * sin(.3 * z)));
    }
    add(s, mesh, NULL, affine_identity());
    build(s);
}

static Vec3f mirrored(Vec3f direction, Vec3f normal)
{
    Vec3 d = vec3_from_f(direction), n = vec3_from_f(normal);
    return vec3f_from(vec3_normalize(vec3_along(d, -2 * vec3_dot(d, n), n)));
}

/* How often the ray and its mirror images met the water, and how often from below. */
typedef struct Count {
    uint64_t met, wrong;
} Count;

static void follow(const TestScene *s, uint64_t *random, Count *count)
{
    static HitList lists[2];
    double slope = .05 * unit(random) * unit(random), turn = 2 * acos(-1) * unit(random);
    Vec3 aim = vec3(-250 + 150 * unit(random), 0, -90 + 380 * unit(random)),
         direction = vec3_normalize(vec3(cos(turn), -slope, sin(turn)));
    Ray ray = ray_make(vec3_along(aim, -4 / (slope + .01), direction), vec3f_from(direction));
    for (int i = 0; i < TURNS; i++) {
        HitList *hits = &lists[i % 2];
        size_t n = rtc_nearest(s->rtc, &ray, hits, NULL);
        if (!n || (i == 0 && !hits->items[0].entering)) return; /* that one starts in a wave */
        count->met++;
        if (!hits->items[0].entering) {
            count->wrong++;
            return;
        }
        Vec3f next = mirrored(ray.direction, hits->items[0].normal);
        rtc_leave(s->rtc, &ray, hits->items, &n, false, next, &ray);
    }
}

/* Whoever is above the water meets it from above, however often its waves have mirrored him. */
static void test_mirrored_by_waves(void **state)
{
    (void)state;
    static const double heights[] = {1, .1, .01};
    const char *of_environment = getenv("MENISCUS_WALKS");
    long rays = of_environment ? atol(of_environment) : 20000;
    for (size_t k = 0; k < COUNT_OF(heights); k++) {
        TestScene s = {0};
        Count count = {0};
        uint64_t random = 5 + k;
        add_water(&s, heights[k]);
        for (long i = 0; i < rays; i++) follow(&s, &random, &count);
        printf("        waves of %g: the water was met %llu times, %llu of them from below\n", heights[k],
               (unsigned long long)count.met, (unsigned long long)count.wrong);
        destroy(&s);
        assert_true(count.met > (uint64_t)rays / 2);
        assert_int_equal(count.wrong, 0);
    }
}

/* Of faces; the row of the four that matter, and in how many places they are tried. */
enum { COLUMNS = 300, ROWS = 120, ROW = 60, PLACES = 16 };

/* Four faces as they were in a pool, with so many columns of others in front of them. */
static Mesh *make_four_faces(uint32_t in_front)
{
    static const float x[] = {-231.573334f, -228.678665f, -225.783997f, -222.889343f, -219.994675f},
                       y[][2] = {{1.13084412f, 1.13873482f},
                                 {1.22693443f, 1.21047211f},
                                 {1.33154297f, 1.29184914f},
                                 {1.44063759f, 1.38360023f},
                                 {1.5469017f, 1.48258781f}},
                       z[] = {93.706665f, 100.400002f};
    Mesh *mesh;
    assert_int_equal(mesh_new((COLUMNS + 1) * (ROWS + 1), 2 * COLUMNS * ROWS, false, false, &mesh, NULL), STATUS_OK);
    for (uint32_t k = 0; k <= ROWS; k++)
        for (uint32_t i = 0; i <= COLUMNS; i++) {
            uint32_t column = i - in_front, row = k - ROW;
            bool known = column < COUNT_OF(x) && row < COUNT_OF(z);
            mesh->positions[k * (COLUMNS + 1) + i] =
                known ? vec3f(x[column], y[column][row], z[row])
                      : vec3f(x[0] + 2.894668f * (float)(int)column, 1, z[0] + 6.693336f * (float)(int)row);
        }
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        uint32_t a = i / COLUMNS * (COLUMNS + 1) + i % COLUMNS, b = a + 1, c = a + COLUMNS + 1, d = c + 1;
        memcpy(mesh->triangles[2 * i], ((uint32_t[]){c, d, a}), 3 * sizeof(uint32_t));
        memcpy(mesh->triangles[2 * i + 1], ((uint32_t[]){b, a, d}), 3 * sizeof(uint32_t));
    }
    return mesh;
}

/* A ray goes into one face just before it would come to the next one, and then runs under two more; Embree's line, a little above
 * it, passes over two of them, and meets the last one, which the exact line does not. Embree has all of them in one leaf of its
 * tree or not, by where they are in the mesh. */
static void test_under_three_faces(void **state)
{
    (void)state;
    HitList first = {0}, second = {0};
    for (uint32_t in_front = 0; in_front < PLACES; in_front++) {
        TestScene s = {0};
        add(&s, keep_mesh(&s, make_four_faces(in_front)), NULL, affine_identity());
        build(&s);
        Ray ray = ray_make(vec3(38.388141811025498, 12.977776956259897, -25.233441807447207),
                           vec3f(-0.904222846f, -0.0400455557f, 0.425179303f));
        size_t n = rtc_nearest(s.rtc, &ray, &first, NULL);
        assert_int_equal(n, 1);
        assert_true(fabs(first.items[0].t - 288.81606) < 1e-4);
        rtc_leave(s.rtc, &ray, first.items, &n, false, vec3f(-0.904547811f, -0.0308113042f, 0.425257504f), &ray);
        assert_int_equal(rtc_nearest(s.rtc, &ray, &second, NULL), 1);
        assert_true(second.items[0].entering);
        assert_true(fabs(second.items[0].t - 6.52895) < 1e-4);
        destroy(&s);
    }
    hit_list_clear(&first);
    hit_list_clear(&second);
}

/* A ridge along z, of so wide a base. By its corner normals, as rough heights get them, one side leans the other way. */
static Mesh *make_blade(double width)
{
    static const uint32_t triangles[][3] = {{0, 1, 3}, {3, 1, 4}, {0, 3, 2}, {2, 3, 5},
                                            {1, 5, 4}, {1, 2, 5}, {0, 2, 1}, {3, 4, 5}};
    Mesh *mesh;
    assert_int_equal(mesh_new(6, COUNT_OF(triangles), true, false, &mesh, NULL), STATUS_OK);
    for (uint32_t i = 0; i < 6; i++) {
        float x = i % 3 == 0 ? 0 : i % 3 == 1 ? (float)width : (float)-width;
        mesh->positions[i] = vec3f(1.3f + x, i % 3 == 0 ? 2 : -1, i < 3 ? 4 : -4);
        mesh->normals[i] = i % 3 == 0 ? vec3f(.93f, -.36f, 0) : vec3f(x > 0 ? 1 : -1, 0, 0);
    }
    memcpy(mesh->triangles, triangles, sizeof triangles);
    return mesh;
}

/* Mirrored by the shading normal, and to the side that it came from. */
static Vec3f mirrored_inside(const TestScene *s, const Ray *ray, const Hit *hit)
{
    Vec3f next = mirrored(ray->direction, rtc_shading_normal(s->rtc, ray, hit));
    return vec3f_dot(next, hit->normal) < 0 ? next : mirrored(next, hit->normal);
}

/* A ray that is mirrored in a sharp ridge stays in it, and turns back from its edge. */
static void test_mirrored_in_a_blade(void **state)
{
    (void)state;
    enum { RAYS = 2000, MIRRORED = 200 };
    static HitList lists[2];
    TestScene s = {0};
    uint64_t random = 11, in_all = 0, back = 0;
    add(&s, keep_mesh(&s, make_blade(.4)), NULL, affine_identity());
    build(&s);
    for (int i = 0; i < RAYS; i++) {
        Vec3 direction = vec3_normalize(vec3(unit(&random) - .5, .1 + unit(&random), .2 * unit(&random)));
        Ray ray = ray_make(vec3(1.3, .5, -1), vec3f_from(direction));
        for (int k = 0; k < MIRRORED; k++) {
            HitList *hits = &lists[k % 2];
            size_t n = rtc_nearest(s.rtc, &ray, hits, NULL);
            assert_true(n > 0 && !hits->items[n - 1].entering);
            in_all++;
            if (hits->items[0].normal.y < -.9f) { /* the bottom */
                back++;
                break;
            }
            rtc_leave(s.rtc, &ray, hits->items, &n, false, mirrored_inside(&s, &ray, &hits->items[0]), &ray);
        }
    }
    printf("        in a blade: mirrored %llu times, and back %llu times of %d\n", (unsigned long long)in_all,
           (unsigned long long)back, RAYS);
    assert_true(back > RAYS * 99 / 100);
    destroy(&s);
}

/* The nearest surface, by all triangles along the line in double. */
static double exact_distance(const TestScene *s, const Ray *ray, bool entering)
{
    HitList hits = {0};
    double t = rtc_find_missed(s->rtc, ray, 0, entering, HUGE_VAL, &hits) ? hits.items[0].t : HUGE_VAL;
    hit_list_clear(&hits);
    return t;
}

/* So fine a mesh so far away that a float's steps there are as long as its triangles, and every hit is within rounding of
 * edges: of very many neighbours not all are asked, and no surface is lost for it. */
static void test_fine_and_far_away(void **state)
{
    (void)state;
    enum { RAYS = 6000 };
    const double places[] = {0, 3e3, 3e4, 1e5};
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        HitList lists[2] = {{0}};
        TestScene s = {0};
        uint64_t random = 7;
        Vec3 middle = vec3(places[i], places[i], -places[i]);
        add(&s, keep_mesh(&s, icosphere(1, 5)), NULL, turned(0, vec3(0, 1, 0), middle));
        build(&s);
        double start = clock_cpu_s();
        size_t n_met = 0;
        for (int k = 0; k < RAYS; k++) {
            Vec3 aim = vec3_along(middle, .9 * unit(&random), random_direction(&random));
            Ray ray = ray_through(vec3_along(middle, 4, random_direction(&random)), aim, 0);
            double expected = exact_distance(&s, &ray, true);
            for (int turn = 0; turn < 4; turn++) {
                HitList *hits = &lists[turn % 2];
                size_t n = rtc_nearest(s.rtc, &ray, hits, NULL);
                if (turn == 0) assert_true(n ? hits->items[0].t == expected : expected == HUGE_VAL);
                if (!n) break;
                n_met++;
                Vec3f on = turn == 0 ? ray.direction : mirrored_inside(&s, &ray, &hits->items[0]);
                rtc_leave(s.rtc, &ray, hits->items, &n, turn == 0, on, &ray);
            }
        }
        printf("        a fine mesh at %g: %zu places met in %.2f s\n", places[i], n_met, clock_cpu_s() - start);
        assert_true(n_met > 3 * RAYS);
        hit_list_clear(&lists[0]);
        hit_list_clear(&lists[1]);
        destroy(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mirrored_in_a_blade), cmocka_unit_test(test_fine_and_far_away),
        cmocka_unit_test(test_under_three_faces), cmocka_unit_test(test_mirrored_by_waves)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
