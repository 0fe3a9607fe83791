/* turns_test.c - what light does at smooth boundaries is told the same both ways, probes that are led are as dense as is said, and
 * photons that choose by what became of others carry the same light.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "scene_fixture.h"
#include "trace/photon.h"

static Dice state_of_dice;
static float dice(void)
{
    return (float)dice_unit(&state_of_dice);
}

static void both_ways(void **state)
{
    (void)state;
    const Lanes seldom = lanes(.1f, .2f, .3f, .4f);
    for (uint32_t n = 0; n <= 40; n++) {
        bool did[40];
        Turns light = turns_none(), path = turns_none();
        for (uint32_t i = 0; i < n; i++) did[i] = dice() < .5f;
        for (uint32_t i = 0; i < n; i++) turns_add(&light, seldom, did[i], false, true);
        for (uint32_t i = 0; i < n; i++) turns_add(&path, seldom, did[n - 1 - i], false, false);
        assert_int_equal(light.n, n);
        assert_int_equal(path.n, n);
        bool beyond = false;
        for (uint32_t i = TURNS_TOLD; i < n; i++) beyond |= did[n - 1 - i];
        if (beyond)
            assert_true(path.bits & TURNS_LIKE_NONE && !(light.bits & TURNS_LIKE_NONE));
        else
            assert_int_equal(light.bits, path.bits);
    }
    /* where wavelengths part, only the hero is left, whose chance it is */
    Turns turns = turns_none();
    turns_add(&turns, seldom, true, true, false);
    assert_true(lanes_equal(turns.chance, seldom));
    turns_add(&turns, seldom, false, true, false);
    assert_true(lanes_equal(turns.chance, lanes_all(.1f * .9f)));
}

/* Over all that can be done at some boundaries, of which each reflects as it does after what was done before. */
static void leads_are_densities(void **state)
{
    (void)state;
    enum { DEEP = 6, TRIES = 200 };
    double worst = 0, worst_sum = 0;
    for (int t = 0; t < TRIES; t++) {
        Lanes reflects[2 << DEEP];
        for (int i = 0; i < 2 << DEEP; i++) reflects[i] = lanes(dice(), dice(), dice(), dice());
        Leads leads = {.unled = .05f + dice(), .n = (uint32_t)t % (LEADS + 1)};
        leads.all = leads.unled;
        for (uint32_t i = 0; i < leads.n; i++) {
            leads.turns[i] = (uint32_t)(dice() * (2 << DEEP));
            leads.all += leads.density[i] = 10 * dice();
        }
        Lanes sum = lanes_all(0);
        for (uint32_t way = 0; way < 1 << DEEP; way++) {
            Turns turns = turns_none();
            Lanes product = lanes_all(1);
            for (uint32_t i = 0, node = 1; i < DEEP; i++) {
                const bool back = way >> i & 1;
                Lanes chosen = reflects[node];
                leads_choose(&leads, &turns, &chosen);
                product = lanes_mul(product, back ? chosen : lanes_rest(chosen));
                turns_add(&turns, reflects[node], back, false, false);
                node = 2 * node + back;
            }
            sum = lanes_add(sum, product);
            double said = (double)(leads_lift(&leads, &turns) * lanes_mean(turns.chance) / leads.all);
            worst = fmax(worst, fabs((double)lanes_mean(product) - said));
        }
        for (int lane = 0; lane < LANES; lane++) worst_sum = fmax(worst_sum, fabs((double)lanes_get(sum, lane) - 1));
    }
    printf("    how likely led probes do something is what is said, to %.2g; in sum 1, to %.2g\n", worst, worst_sum);
    assert_true(worst < 1e-6);
    assert_true(worst_sum < 1e-5);
}

static void hopes(void **state)
{
    (void)state;
    static Hopes hopes;
    const Lanes seldom = lanes(.01f, .02f, .03f, .04f);
    Lanes chosen = seldom;
    assert_true(hopes_choose(&hopes, 1, &chosen) && lanes_equal(chosen, lanes_all(.2f)));
    chosen = seldom; /* beyond its first boundaries a photon does not explore */
    assert_false(hopes_choose(&hopes, 16, &chosen));
    /* all that are mirrored second land, and no others do */
    for (int i = 0; i < 1000; i++) {
        uint32_t node = hopes_step(hopes_step(1, false), i % 4 == 0);
        hopes_count(&hopes, hopes_step(node, false), i % 4 == 0);
    }
    assert_int_equal(hopes.followed[1], 1000);
    assert_int_equal(hopes.landed[1], 250);
    chosen = seldom;
    assert_true(hopes_choose(&hopes, 2, &chosen));
    assert_true(lanes_get(chosen, 0) > .5f && lanes_get(chosen, 0) <= 1 - .1f * .99f + 1e-6f);
    chosen = seldom; /* nothing landed from there */
    assert_false(hopes_choose(&hopes, 4, &chosen));
    uint32_t node = 1;
    for (int i = 0; i < 20; i++) node = hopes_step(node, true);
    assert_int_equal(node, HOPES - 1);
}

typedef struct Landing {
    double flux, error; /* of each that was followed */
    uint32_t landed;
} Landing;

static Landing land(const PhotonSource *source, uint32_t first, uint32_t n, Pool *pool, Hopes *counted)
{
    Error error;
    uint64_t rays = 0;
    Landing landing = {0, 0, 0};
    double square = 0;
    Photon *photons = calloc(n, sizeof *photons);
    assert_int_equal(photons_trace(source, first, n, pool, photons, counted, &rays, &error), STATUS_OK);
    for (uint32_t i = 0; i < n; i++) {
        double flux = (double)photons[i].flux;
        landing.flux += flux / n;
        square += flux * flux / n;
        landing.landed += flux > 0;
    }
    landing.error = sqrt((square - landing.flux * landing.flux) / n);
    free(photons);
    return landing;
}

/* A drop in the sun, and a wall on the sun's side: what lands there was mirrored in the drop, or on it. */
static void rainbow(void **state)
{
    (void)state;
    enum { MANY = 1000000, N = 100000 };
    Fixture scene;
    World world;
    PhotonTargets targets;
    Pool *pool;
    static Hopes counted;
    fixture_compile(&scene,
                    FIXTURE_MEDIA
                    "sphere { interior = water  radius = 10 }\n"
                    "light { shape = distant  from = <1000, 0, 0>  to = <0, 0, 0>  angle = .53  power = 10 }\n"
                    "difference { box { from = <400, -600, -600>  to = <401, 600, 600> }\n"
                    "cylinder { from = <399, 0, 0>  to = <402, 0, 0>  radius = 14 }\n"
                    "surface = surface { albedo = .9 } }\n"
                    "camera { from = <0, 10, 300>  to = <0, 0, 0> }\n",
                    1);
    assert_int_equal(pool_new(2, &pool, &scene.error), STATUS_OK);
    assert_int_equal(world_init(&world, scene.compiled, 0, 100, false, NULL, &scene.error), STATUS_OK);
    assert_int_equal(photon_targets(&world, &targets, &scene.error), STATUS_OK);
    PhotonSource source = {.world = &world, .targets = &targets, .seed = 1};
    Landing natural = land(&source, 0, MANY, pool, NULL);
    source.hopes = &counted;
    Landing first = land(&source, 0, PHOTON_EXPLORERS, pool, &counted);
    Landing led = land(&source, PHOTON_EXPLORERS, N, pool, NULL);
    printf("    flux of a drop that comes back: %.4g +- %.2g, explored %.4g +- %.2g, led %.4g +- %.2g\n", natural.flux,
           natural.error, first.flux, first.error, led.flux, led.error);
    printf("    of 1000 photons %.2f land, and %.1f that are led\n", 1e3 * natural.landed / MANY, 1e3 * led.landed / N);
    assert_int_equal(counted.followed[1] > PHOTON_EXPLORERS / 4, 1);
    assert_int_equal(counted.landed[1], first.landed);
    assert_true(fabs(first.flux - natural.flux) < 4 * hypot(first.error, natural.error));
    assert_true(fabs(led.flux - natural.flux) < 4 * hypot(led.error, natural.error));
    assert_true(led.landed / (double)N > 8.0 * natural.landed / MANY);
    assert_true(led.error * led.error * N < 0.25 * natural.error * natural.error * MANY);
    photon_targets_clear(&targets);
    world_clear(&world);
    pool_free(pool);
    fixture_clear(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_ways),
        cmocka_unit_test(leads_are_densities),
        cmocka_unit_test(hopes),
        cmocka_unit_test(rainbow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
