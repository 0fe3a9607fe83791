/* flight_test.c - where flights through media that scatter may end.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"
#include "trace/event.h"
#include "trace/flight.h"

#define VIEW "environment { } camera { from = <0, 0, 500> to = <0, 0, 0> } "
#define EVEN                                                                                                           \
    "meniscus 1.0 unit mm medium fog { ior = 1 scattering = .5 / 1mm } sphere { interior = fog radius = 30 } " VIEW
#define VARIED                                                                                                         \
    "meniscus 1.0 unit mm def thick(p) = 1 + .5 * noise(p / 9) "                                                       \
    "medium fog { ior = 1 scattering = .5 / 1mm "                                                                      \
    "density = volume { function = thick from = <-31, -31, -31> to = <31, 31, 31> cells = 20 } } "                     \
    "sphere { interior = fog radius = 30 } " VIEW

/* A sampler whose number for a path's first flight is 0, as one in 2^24 is. */
static Sampler shortest_flight(void)
{
    Sampler sampler = sampler_make(1, 0, 0, 0);
    for (uint32_t i = 0; i < 1U << 24; i++) {
        sampler.index_reversed = reverse_bits(i);
        if (sampler_1d(&sampler, sampler_dimension(0, DIM_DISTANCE)) == 0) return sampler;
    }
    fail_msg("no number is 0");
    return sampler;
}

/* The shortest flights into a ball, and a straight ray from where each ends: none is still at the ball's surface. */
static void fly(const char *text)
{
    enum { RAYS = 2000 };
    Fixture fixture;
    fixture_compile(&fixture, text, 1);
    const CompiledScene *compiled = fixture.compiled;
    World world;
    Tracer tracer;
    Error error;
    assert_int_equal(world_init(&world, compiled, 0, 4, false, NULL, &error), STATUS_OK);
    tracer_init(&tracer, &world);
    Sampler sampler = shortest_flight();
    Dice dice = {5};
    int n_scattered = 0, n_near = 0;
    for (int i = 0; i < RAYS; i++) {
        Path path;
        Event event;
        path_init(&path, &tracer, sampler);
        path.wavelengths = wavelengths_sample(0.5f);
        nest_list_empty(&tracer.list);
        Vec3 from = vec3_scale(dice_direction(&dice), 480), aim = vec3_scale(dice_direction(&dice), 25);
        path.ray = ray_make(from, vec3f_from(vec3_normalize(vec3_sub(aim, from))));
        path_next_event(&path, &event);
        if (event.kind != EVENT_SCATTER) continue;
        n_scattered++;
        Vec3 end = ray_point(&path.ray, event.t);
        assert_true(vec3_length(end) < 30);
        n_near += vec3_length(end) > 29.99;
        Ray ray = ray_make(end, vec3f_from(dice_direction(&dice)));
        ray.t_max = 900;
        Lanes transmittance;
        uint32_t medium;
        assert_true(path_shadow(&path, &ray, &transmittance, &medium));
        assert_int_equal(nest_list_count(&tracer.shadow_list), 0);
    }
    assert_true(n_scattered > RAYS / 2 && n_near > RAYS / 10); /* where the fog varies, some collisions are none */
    assert_int_equal(tracer.counters.nesting_faults, 0);
    tracer_clear(&tracer);
    world_clear(&world);
    fixture_clear(&fixture);
}

static void shortest_flights_leave_the_surface(void **state)
{
    (void)state;
    fly(EVEN);
    fly(VARIED);
}

/* What is used up to the last bit by one medium is no flight of length 0 in the next one. */
static void a_used_up_flight_goes_on(void **state)
{
    (void)state;
    Fixture fixture;
    fixture_compile(&fixture, EVEN, 1);
    const Scene *scene = fixture.scene;
    const SceneMedium *fog = &scene->media[scene->objects[0].medium];
    Lanes nm = wavelengths_sample(0.5f).nm;
    FreeFlight flight = {.budget = 0.5f};
    assert_true(flight_scatter_even(&flight, fog, 1, nm) == 1);
    double further = flight_scatter_even(&flight, fog, 1, nm);
    assert_true(further > 0 && further < 1e-6);
    fixture_clear(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(shortest_flights_leave_the_surface),
                                       cmocka_unit_test(a_used_up_flight_goes_on)};
    return cmocka_run_group_tests_name("flight", tests, NULL, NULL);
}
