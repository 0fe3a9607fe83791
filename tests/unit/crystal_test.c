/* crystal_test.c - double refraction against closed forms, and its conservation laws at random boundaries.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "base/angle.h"
#include "base/hash.h"
#include "near.h"
#include "optics/crystal.h"
#include "optics/fresnel.h"
#include "optics/sampling.h"

/* Calcite, at the yellow of sodium. */
static const double calcite_o = 1.6584, calcite_e = 1.4864;

static double random_unit(uint32_t *state)
{
    *state += 1;
    return hash_to_unit(hash_u64(*state));
}

static Vec3 random_direction(uint32_t *state)
{
    const double z = 2 * random_unit(state) - 1, turn = 2 * MEN_PI * random_unit(state), across = sqrt(1 - z * z);
    return vec3(across * cos(turn), across * sin(turn), z);
}

static CrystalSide isotropic(double index)
{
    return (CrystalSide){index, index, vec3(0, 1, 0)};
}

/* The wave's phase along each axis: of an extraordinary one by its index for the angle to the optic axis, which is sought so that the
 * light goes along the ray. */
static Vec3 vector_of(const CrystalSide *side, const CrystalWay *way)
{
    if (way->wave != CRYSTAL_EXTRAORDINARY) return vec3_scale(way->direction, side->ordinary);
    const double o = side->ordinary, e = side->extraordinary;
    double cosine = vec3_dot(way->direction, side->axis);
    Vec3 across = vec3_normalize(vec3_along(way->direction, -cosine, side->axis));
    /* tan(phase) = (n_e / n_o)^2 tan(ray) */
    double phase = atan2(e * e * sqrt(fmax(1 - cosine * cosine, 0)), o * o * cosine);
    double index = 1 / sqrt(pow(cos(phase) / o, 2) + pow(sin(phase) / e, 2));
    return vec3_scale(vec3_along(vec3_scale(side->axis, cos(phase)), sin(phase), across), index);
}

static void what_is_isotropic_is_fresnels(void **state)
{
    (void)state;
    for (int i = 1; i < 90; i += 4)
        for (int out = 0; out < 2; out++) {
            const CrystalSide from = isotropic(out ? 1.5 : 1), to = isotropic(out ? 1 : 1.5);
            const double angle = i * MEN_PI / 180;
            CrystalWay ways[CRYSTAL_WAYS];
            uint32_t n =
                crystal_meet(&from, &to, vec3(sin(angle), -cos(angle), 0), CRYSTAL_UNPOLARIZED, vec3(0, 1, 0), ways);
            double expected = (double)fresnel_dielectric((float)cos(angle), (float)from.ordinary, (float)to.ordinary);
            assert_int_equal(n, expected < 1 ? 2 : 1);
            assert_near(ways[0].part, expected, 1e-6);
            assert_near(ways[0].direction.y, cos(angle), 1e-12);
            if (n == 2) assert_near(ways[1].direction.x, sin(angle) * from.ordinary / to.ordinary, 1e-12);
        }
}

/* Head on, the axis at an angle to the face: ordinary light goes straight on, and the other walks off. */
static void light_walks_off(void **state)
{
    (void)state;
    const CrystalSide air = isotropic(1);
    for (int degrees = 5; degrees < 90; degrees += 5) {
        const double angle = degrees * MEN_PI / 180, square_o = calcite_o * calcite_o, square_e = calcite_e * calcite_e;
        const CrystalSide calcite = {calcite_o, calcite_e, vec3(sin(angle), -cos(angle), 0)};
        CrystalWay ways[CRYSTAL_WAYS];
        assert_int_equal(crystal_meet(&air, &calcite, vec3(0, -1, 0), CRYSTAL_UNPOLARIZED, vec3(0, 1, 0), ways), 3);
        assert_true(ways[1].wave == CRYSTAL_ORDINARY && ways[2].wave == CRYSTAL_EXTRAORDINARY);
        assert_near(ways[1].direction.y, -1, 1e-12);
        double off = atan((square_o - square_e) * tan(angle) / (square_e + square_o * tan(angle) * tan(angle)));
        assert_near(atan2(ways[2].direction.x, -ways[2].direction.y), -off, 1e-9);
        if (degrees == 45) assert_near(off * 180 / MEN_PI, 6.22, 0.01);
        double index = 1 / sqrt(cos(angle) * cos(angle) / square_o + sin(angle) * sin(angle) / square_e);
        double back[2] = {(calcite_o - 1) / (calcite_o + 1), (index - 1) / (index + 1)};
        assert_near(ways[0].part, (back[0] * back[0] + back[1] * back[1]) / 2, 1e-12);
        assert_near(ways[1].part, (1 - back[0] * back[0]) / 2, 1e-12);
    }
}

/* Inside, at a face that the axis lies in, across the plane of incidence: both waves keep to themselves, as if each were alone in what
 * is isotropic. Between their critical angles one gets out: so polarizers are made. */
static void the_axis_across_keeps_waves_apart(void **state)
{
    (void)state;
    const CrystalSide air = isotropic(1), calcite = {calcite_o, calcite_e, vec3(0, 0, 1)};
    for (int degrees = 1; degrees < 60; degrees++) {
        const double angle = degrees * MEN_PI / 180, cosine = cos(angle);
        const Vec3 direction = vec3(sin(angle), -cosine, 0);
        for (int e = 0; e < 2; e++) {
            const double index = e ? calcite_e : calcite_o;
            Lanes polarized[2];
            CrystalWay ways[CRYSTAL_WAYS];
            uint32_t n = crystal_meet(&calcite, &air, direction, e ? CRYSTAL_EXTRAORDINARY : CRYSTAL_ORDINARY,
                                      vec3(0, 1, 0), ways);
            double back = 0;
            for (uint32_t i = 0; i < n; i++)
                if (!ways[i].through) back += ways[i].part;
            fresnel_dielectric_polarized((float)cosine, lanes_all((float)index), lanes_all(1), polarized);
            /* the field of the extraordinary wave is along the axis, across the plane */
            assert_near(back, (double)lanes_get(polarized[e ? 0 : 1], 0), 1e-5);
            for (uint32_t i = 0; i < n; i++)
                if (!ways[i].through && ways[i].part > 1e-12)
                    assert_true(ways[i].wave == (e ? CRYSTAL_EXTRAORDINARY : CRYSTAL_ORDINARY));
            assert_true((index * sin(angle) > 1) == (back > 1 - 1e-9));
        }
    }
}

typedef struct Meeting {
    CrystalSide sides[2];
    Vec3 direction, normal;
    CrystalWave wave;
} Meeting;

static Meeting random_meeting(uint32_t *state)
{
    Meeting meeting = {.normal = random_direction(state), .direction = random_direction(state)};
    for (int i = 0; i < 2; i++) {
        CrystalSide *side = &meeting.sides[i];
        side->axis = random_direction(state);
        side->ordinary = 1 + 1.5 * random_unit(state);
        side->extraordinary =
            random_unit(state) < 0.4 ? side->ordinary : side->ordinary * (0.8 + 0.4 * random_unit(state));
        if (random_unit(state) < 0.1) side->axis = meeting.normal;
    }
    if (vec3_dot(meeting.direction, meeting.normal) > 0) meeting.normal = vec3_scale(meeting.normal, -1);
    if (!crystal_is_isotropic(&meeting.sides[0]))
        meeting.wave = random_unit(state) < 0.5 ? CRYSTAL_ORDINARY : CRYSTAL_EXTRAORDINARY;
    return meeting;
}

/* No light is lost, all ways are on their sides, and the phase along the boundary stays. */
static void light_is_kept(void **state)
{
    (void)state;
    uint32_t seed = 1;
    for (int i = 0; i < 200000; i++) {
        const Meeting m = random_meeting(&seed);
        CrystalWay ways[CRYSTAL_WAYS];
        uint32_t n = crystal_meet(&m.sides[0], &m.sides[1], m.direction, m.wave, m.normal, ways);
        double sum = 0;
        const CrystalWay came = {m.wave, false, m.direction, 1};
        const Vec3 phase = vec3_cross(m.normal, vector_of(&m.sides[0], &came));
        for (uint32_t k = 0; k < n; k++) {
            sum += ways[k].part;
            assert_near(vec3_length(ways[k].direction), 1, 1e-9);
            assert_true((vec3_dot(ways[k].direction, m.normal) < 0) == ways[k].through);
            Vec3 own = vec3_cross(m.normal, vector_of(&m.sides[ways[k].through], &ways[k]));
            assert_near(vec3_length(vec3_sub(own, phase)), 0, 1e-6);
        }
        assert_near(sum, 1, vec3_dot(m.direction, m.normal) < -1e-3 ? 1e-9 : 1e-4); /* what grazes is less well known */
    }
}

/* Each way taken back comes to where the light came from, and by as much. */
static void ways_go_back(void **state)
{
    (void)state;
    uint32_t seed = 7;
    for (int i = 0; i < 50000; i++) {
        const Meeting m = random_meeting(&seed);
        CrystalWay ways[CRYSTAL_WAYS], back[CRYSTAL_WAYS];
        uint32_t n = crystal_meet(&m.sides[0], &m.sides[1], m.direction, m.wave, m.normal, ways);
        if (vec3_dot(m.direction, m.normal) > -1e-3) continue;
        for (uint32_t k = 0; k < n; k++) {
            const bool through = ways[k].through;
            const Vec3 normal = through ? vec3_scale(m.normal, -1) : m.normal;
            if (ways[k].part < 1e-6 || fabs(vec3_dot(ways[k].direction, m.normal)) < 1e-3) continue;
            uint32_t n_back = crystal_meet(&m.sides[through], &m.sides[!through], vec3_scale(ways[k].direction, -1),
                                           ways[k].wave, normal, back);
            const double unlike = m.wave == CRYSTAL_UNPOLARIZED ? 2 : 1,
                         likewise = ways[k].wave == CRYSTAL_UNPOLARIZED ? 2 : 1;
            bool found = false;
            for (uint32_t b = 0; b < n_back; b++)
                if (back[b].wave == m.wave && back[b].through == through) {
                    found = true;
                    assert_near(vec3_length(vec3_add(back[b].direction, m.direction)), 0, 1e-6);
                    assert_near(back[b].part * likewise, ways[k].part * unlike, 1e-6);
                }
            assert_true(found);
        }
    }
}

/* Rays along the boundary, and indices as far apart as there are: ways are known all the same. */
static void nothing_is_too_much(void **state)
{
    (void)state;
    uint32_t seed = 3;
    for (int i = 0; i < 20000; i++) {
        Meeting m = random_meeting(&seed);
        const double least = i % 2 ? 0.1 : 1, most = i % 3 ? 10 : 1;
        for (int k = 0; k < 2; k++) {
            const bool isotropic_side = crystal_is_isotropic(&m.sides[k]);
            m.sides[k].ordinary = random_unit(&seed) < 0.5 ? least : most;
            m.sides[k].extraordinary = isotropic_side ? m.sides[k].ordinary : m.sides[k].ordinary == 1 ? 1.5 : 1;
        }
        if (i % 5 == 0) /* exactly along it, or nearly */
            m.direction = vec3_normalize(vec3_along(m.direction, -vec3_dot(m.direction, m.normal), m.normal));
        CrystalWay ways[CRYSTAL_WAYS];
        const uint32_t n = crystal_meet(&m.sides[0], &m.sides[1], m.direction, m.wave, m.normal, ways);
        assert_in_range(n, 1, CRYSTAL_WAYS);
        for (uint32_t k = 0; k < n; k++) {
            assert_near(vec3_length(ways[k].direction), 1, 1e-6);
            assert_true(isfinite(ways[k].part) && ways[k].part > 0);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_isotropic_is_fresnels),
        cmocka_unit_test(light_walks_off),
        cmocka_unit_test(the_axis_across_keeps_waves_apart),
        cmocka_unit_test(light_is_kept),
        cmocka_unit_test(ways_go_back),
        cmocka_unit_test(nothing_is_too_much),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
