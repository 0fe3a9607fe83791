/* flat_way_test.c - ways by flat faces: against layers in closed form, against differences, and round trips.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "near.h"

#include "base/angle.h"
#include "optics/flat_way.h"

static const double pi = 3.14159265358979323846;

/* Faces across y, one layer after another: the offsets of all add up, and so does what a steradian is spread over. */
static void layers(void **state)
{
    (void)state;
    static const double ior[] = {1, 1.5, 1.33, 1.8, 1}, height[] = {0, 3, 4.5, 9, 10, 14};
    FlatFace faces[4];
    for (int i = 0; i < 4; i++)
        faces[i] = (FlatFace){.normal = vec3(0, i % 2 ? 1 : -1, 0),
                              .offset = (i % 2 ? 1 : -1) * height[i + 1],
                              .eta = ior[i] / ior[i + 1]};
    for (int k = 0; k < 85; k += 4) {
        double angle = k * pi / 180, aside = 0, around = 0, along = 0, turn = 0.7;
        for (int i = 0; i < 5; i++) {
            double sine = sin(angle) / ior[i], cosine = sqrt(1 - sine * sine), thick = height[i + 1] - height[i];
            aside += thick * sine / cosine;
            around += thick / (ior[i] * cosine);
            along += thick * cos(angle) / (ior[i] * cosine * cosine * cosine);
        }
        FlatRay ray;
        Vec3 direction, to = vec3(aside * cos(turn), 14, aside * sin(turn));
        assert_true(flat_way_find(faces, 4, vec3(0, 0, 0), to, NULL, &direction, &ray));
        assert_near(direction.y, cos(angle), 1e-7);
        assert_near(ray.direction.y, cos(angle), 1e-7);
        assert_near(flat_ray_spread(&ray, to), around * along * cos(angle), 1e-6 * around * along);
    }
}

/* Faces of any slope, some of which mirror: what a ray comes to is found again from there, and its spread is that of the rays
 * beside it. */
static void round_trips(void **state)
{
    (void)state;
    Dice dice = {1};
    int n_found = 0, n_followed = 0;
    for (int trial = 0; trial < 20000; trial++) {
        FlatFace faces[6];
        uint32_t n = (uint32_t)(dice_unit(&dice) * 6) + 1;
        Vec3 start = dice_direction(&dice), from = vec3_scale(dice_direction(&dice), 2);
        for (uint32_t i = 0; i < n; i++) {
            Vec3 normal = vec3_normalize(vec3_along(dice_direction(&dice), 3, start));
            faces[i] = (FlatFace){.normal = normal,
                                  .offset = vec3_dot(normal, from) + 1 + i + dice_unit(&dice),
                                  .eta = 0.7 + 0.7 * dice_unit(&dice)};
        }
        FlatRay ray, beside[2];
        if (!flat_way_follow(faces, n, from, start, &ray)) continue;
        n_followed++;
        assert_near(vec3_length(ray.direction), 1, 1e-12);
        Vec3 to = vec3_along(ray.origin, 3, ray.direction), found;
        /* by differences */
        const double step = 1e-5;
        Vec3 moved[2], axis = vec3_normalize(vec3_cross(start, dice_direction(&dice))), other = vec3_cross(start, axis);
        bool good = true;
        for (int i = 0; i < 2; i++) {
            Vec3 turned = vec3_normalize(vec3_along(start, step, i ? other : axis));
            good = good && flat_way_follow(faces, n, from, turned, &beside[i]);
            if (!good) break;
            Vec3 apart = vec3_sub(beside[i].origin, to);
            double t = -vec3_dot(apart, ray.direction) / vec3_dot(beside[i].direction, ray.direction);
            moved[i] = vec3_scale(vec3_along(apart, t, beside[i].direction), 1 / step);
        }
        if (!good) continue;
        double spread = vec3_length(vec3_cross(moved[0], moved[1])), known = flat_ray_spread(&ray, to);
        if (vec3_length(moved[0]) + vec3_length(moved[1]) < 500) assert_near(known, spread, 0.02 * spread + 0.02);
        FlatRay again;
        if (!flat_way_find(faces, n, from, to, NULL, &found, &again)) continue;
        n_found++;
        Vec3 missed = vec3_sub(to, again.origin);
        missed = vec3_along(missed, -vec3_dot(missed, again.direction), again.direction);
        assert_true(vec3_length(missed) < 1e-7 * vec3_length(vec3_sub(to, from)));
    }
    printf("    %d ways followed, %d found again\n", n_followed, n_found);
    assert_true(n_followed > 10000);
    assert_true(n_found > 0.99 * n_followed);
}

/* To and fro in a plate: a way by mirrors, and back to where it leads through. */
static void mirrored(void **state)
{
    (void)state;
    FlatFace low = {.normal = vec3(0, 1, 0), .offset = 5, .eta = 1 / 1.5},
             high = {.normal = vec3(0, 1, 0), .offset = 7, .eta = 1.5};
    FlatFace faces[4] = {low, high, low, high};
    faces[1].mirrored = faces[2].mirrored = true;
    Vec3 direction, to = vec3(6, 12, 0);
    FlatRay ray;
    assert_true(flat_way_find(faces, 4, vec3(0, 0, 0), to, NULL, &direction, &ray));
    double tangent = direction.x / direction.y, inside = asin(direction.x / 1.5);
    assert_near(10 * tangent + 6 * tan(inside), 6, 1e-6);
    /* beyond the critical angle nothing comes through, and nothing is found there */
    FlatFace out = {.normal = vec3(0, 1, 0), .offset = 1, .eta = 1.5};
    assert_false(flat_way_follow(&out, 1, vec3(0, 0, 0), vec3_normalize(vec3(2, 1, 0)), &ray));
    assert_true(flat_way_find(&out, 1, vec3(0, 0, 0), vec3(200, 2, 0), NULL, &direction, &ray));
    assert_near(direction.x, 1 / 1.5, 1e-3);
}

/* What leaves in a direction starts in the one that leads there, and its steradians are those of the differences. */
static void leaving(void **state)
{
    (void)state;
    Dice dice = {7};
    int n_left = 0;
    for (int trial = 0; trial < 20000; trial++) {
        FlatFace faces[4];
        uint32_t n = (uint32_t)(dice_unit(&dice) * 4) + 1;
        Vec3 start = dice_direction(&dice), back;
        for (uint32_t i = 0; i < n; i++) {
            Vec3 normal = vec3_normalize(vec3_along(dice_direction(&dice), 3, start));
            if (i % 2) normal = vec3_scale(normal, -1);
            faces[i] = (FlatFace){.normal = normal,
                                  .offset = vec3_dot(normal, vec3_scale(start, 1 + i)),
                                  .eta = 0.7 + 0.7 * dice_unit(&dice)};
        }
        if (trial % 3 == 0) faces[n - 1].mirrored = true; /* the last: what is behind it is met by none */
        FlatRay ray;
        if (!flat_way_follow(faces, n, vec3(0, 0, 0), start, &ray)) continue;
        n_left++;
        double spread, turned = vec3_length(vec3_cross(ray.direction_turned[0], ray.direction_turned[1]));
        assert_true(flat_way_leaving(faces, n, ray.direction, &back, &spread));
        assert_near(vec3_length(vec3_sub(back, start)), 0, 1e-7);
        assert_near(spread, turned, 1e-6 * (1 + turned));
    }
    printf("    %d ways left again\n", n_left);
    assert_true(n_left > 10000);
    /* nothing comes out of the dense at that angle */
    FlatFace into = {.normal = vec3(0, 1, 0), .offset = 1, .eta = 1 / 1.5};
    Vec3 direction;
    double spread;
    assert_false(flat_way_leaving(&into, 1, vec3_normalize(vec3(2, 1, 0)), &direction, &spread));
}

/* A prism turns light by 37 degrees: the line to the lamp goes past it, and where light leaves it says where to begin. */
static void prisms_are_found_by_where_light_leaves(void **state)
{
    (void)state;
    const double out = -41.4 * MEN_DEGREE, in = 78.6 * MEN_DEGREE;
    const Vec3 from = vec3(0, 0, 0), to = vec3(-26.1, 57.5, 0), met = vec3(-1.914, 25.69, 0);
    FlatFace faces[] = {{.normal = vec3(cos(out), sin(out), 0), .eta = 1 / 1.5},
                        {.normal = vec3(cos(in), sin(in), 0), .eta = 1.5}};
    faces[0].offset = vec3_dot(faces[0].normal, vec3(0, 20, 0));
    faces[1].offset = vec3_dot(faces[1].normal, met);
    const Vec3 leaving = vec3_normalize(vec3_sub(to, met));
    Vec3 direction;
    FlatRay ray;
    assert_true(flat_way_find(faces, 2, from, to, &leaving, &direction, &ray));
    assert_near(direction.y, 1, 1e-3);
    assert_near(vec3_length(vec3_cross(vec3_normalize(vec3_sub(to, ray.origin)), ray.direction)), 0, 1e-8);
    /* Snell's law, of the angles to both faces */
    const double first = acos(fabs(vec3_dot(direction, faces[0].normal))),
                 last = acos(fabs(vec3_dot(ray.direction, faces[1].normal)));
    assert_near(asin(sin(first) / 1.5) + asin(sin(last) / 1.5), 60 * MEN_DEGREE, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers),
        cmocka_unit_test(round_trips),
        cmocka_unit_test(mirrored),
        cmocka_unit_test(leaving),
        cmocka_unit_test(prisms_are_found_by_where_light_leaves),
    };
    return cmocka_run_group_tests_name("flat ways", tests, NULL, NULL);
}
