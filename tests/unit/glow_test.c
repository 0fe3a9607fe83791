/* glow_test.c - places in media that shine, as light sampling chooses them, against the densities that glow_density says:
 * Pearson's chi-square over blocks of space, and each place's own density.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "dice.h"
#include "near.h"
#include "scene_fixture.h"
#include "trace/world.h"

enum { SIDE = 6, BLOCKS = SIDE * SIDE * SIDE, FINE = 12, SAMPLES = 100000 };

typedef struct Case {
    const char *what, *scene;
    double least; /* of the places that the medium is at */
} Case;

static void open_world(Fixture *f, World *world, const char *scene)
{
    char text[2000];
    snprintf(text, sizeof text, "meniscus 1.0 unit mm camera { from = <0, 0, 900>  to = <0, 0, 0>  shutter = 1 }\n%s\n",
             scene);
    fixture_compile(f, text, 1);
    assert_int_equal(world_init(world, f->compiled, 0, 8, false, NULL, &f->error), STATUS_OK);
}

static int block_of(Box3 box, Vec3 place)
{
    Vec3 size = vec3_sub(box.max, box.min), at = vec3_sub(place, box.min);
    int x = (int)(at.x / size.x * SIDE), y = (int)(at.y / size.y * SIDE), z = (int)(at.z / size.z * SIDE);
    assert_true(x >= 0 && y >= 0 && z >= 0);
    return (x < SIDE ? x : SIDE - 1) + SIDE * ((y < SIDE ? y : SIDE - 1) + SIDE * (z < SIDE ? z : SIDE - 1));
}

static void run_case(const Case *c)
{
    static double expected[BLOCKS], uncertain[BLOCKS];
    static int counted[BLOCKS];
    Fixture f;
    World world;
    open_world(&f, &world, c->scene);
    assert_int_equal(world.media.n_glows, 1);
    const Glow *glow = &world.media.glows[0];
    const double time = world.scene->n_keys ? 0.5 : 0;
    MediumMaps room;
    const MediumMaps *maps = media_maps(world.scene, glow->place, time, &room);
    Box3 box = glow_box(world.scene, glow, time);
    Vec3 size = vec3_sub(box.max, box.min);
    Dice dice = {5};
    memset(counted, 0, sizeof counted);
    double whole = 0, n_there = 0;
    for (int i = 0; i < BLOCKS; i++) {
        double sum = 0, last = 0, squares = 0;
        for (int k = 0; k < FINE * FINE * FINE; k++) {
            Vec3 place =
                vec3(box.min.x + size.x * (i % SIDE + (k % FINE + dice_unit(&dice)) / FINE) / SIDE,
                     box.min.y + size.y * (i / SIDE % SIDE + (k / FINE % FINE + dice_unit(&dice)) / FINE) / SIDE,
                     box.min.z + size.z * (i / (SIDE * SIDE) + (k / (FINE * FINE) + dice_unit(&dice)) / FINE) / SIDE);
            double density = glow_density(glow, maps, place);
            sum += density;
            if (k % FINE) squares += 0.5 * pow(density - last, 2);
            last = density;
        }
        const double n = FINE * FINE * FINE, block = size.x * size.y * size.z / BLOCKS;
        expected[i] = sum / n * block * SAMPLES;
        uncertain[i] = squares / (n * n) * pow(block * SAMPLES, 2);
        whole += expected[i] / SAMPLES;
    }
    assert_near(whole, 1, 0.01);
    for (int i = 0; i < SAMPLES; i++) {
        float u[2] = {(float)fmin(dice_unit(&dice), 1 - 0x1p-24), (float)fmin(dice_unit(&dice), 1 - 0x1p-24)};
        GlowPoint point = glow_sample(world.scene, glow, time, dice_unit(&dice), u);
        counted[block_of(box, point.position)]++;
        double density = glow_density(glow, maps, point.position);
        if (density != point.density) assert_near(density, point.density, 1e-9 * point.density);
        if (i >= 2000) continue;
        HitList hits = {0};
        NestList list;
        nest_list_init(&list);
        assert_int_equal(compiled_interior(f.compiled, vec3f_from(point.position), time, &hits, &list, NULL),
                         STATUS_OK);
        n_there += media_is_there(f.compiled, &world.media, glow->place, &list);
        nest_list_clear(&list);
        hit_list_clear(&hits);
    }
    double chi = 0, n_blocks = 0;
    for (int i = 0; i < BLOCKS; i++) {
        if (expected[i] < 8) continue;
        chi += pow(counted[i] - expected[i], 2) / (expected[i] + uncertain[i]);
        n_blocks++;
    }
    print_message("%s: chi-square %.0f of %.0f blocks, %.0f %% of the places shine\n", c->what, chi, n_blocks,
                  n_there / 20);
    assert_true(n_blocks > 20);
    assert_true(chi < n_blocks + 4.5 * sqrt(2 * n_blocks));
    assert_true(n_there / 2000 >= c->least);
    world_clear(&world);
    fixture_clear(&f);
}

#define GAS "medium gas { ior = 1  emission = 1 }"

static void densities(void **state)
{
    (void)state;
    static const Case cases[] = {
        {"a ball", GAS "sphere { interior = gas  radius = 30 }", 0.8},
        {"a bar, turned and stretched",
         GAS "box { interior = gas  size = <4, 60, 4>  scale(<2, 1, 1>)  rotate(<0, 0, 50>) }", 0.3},
        {"a ring in motion",
         GAS "torus { interior = gas  radius = 20  tube = 6  rotate(<clock * 60, 0, 0>)"
             "  translate(<0, clock * 9, 5>) } animation { frames = 4 }",
         0.55},
        {"a box with a hole",
         GAS "difference { box { size = <40, 40, 40> } cylinder { from = <0, -30, 0>  to = <0, 30, 0>  radius = 15 }"
             "  interior = gas }",
         0.75},
        {"what another hull leaves of a ball",
         GAS "medium air2 { ior = 1  priority = 5 } sphere { interior = gas  radius = 30 }"
             "box { interior = air2  from = <-40, -40, -40>  to = <40, 0, 40> }",
         0.75},
        {"hotter at one end",
         "def f(p) = p.x * 10 + 1200 medium gas { ior = 1  emission = blackbody(1500)  temperature = volume { function "
         "= f "
         " from = <-30, -30, -30>  to = <30, 30, 30>  cells = 20 } } sphere { interior = gas  radius = 30 }",
         0.8},
        {"a grid",
         "def f(p) = max(0, 1 - length(p) / 20) medium gas { ior = 1  emission = 1  density = volume { function = f "
         " from = <-20, -20, -20>  to = <20, 20, 20>  cells = 50 } } sphere { interior = gas  radius = 30 }",
         0.99},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) run_case(&cases[i]);
}

/* Light sampling does not look where no straight ray leads, or where there is no end. */
static void none(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        "medium melt { ior = 1.5  emission = 1 } sphere { interior = melt  radius = 30 }",
        GAS "plane { interior = gas }",
        "medium dark { ior = 1  absorption = 1 } sphere { interior = dark  radius = 30 }",
    };
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Fixture f;
        World world;
        open_world(&f, &world, scenes[i]);
        assert_int_equal(world.media.n_glows, 0);
        world_clear(&world);
        fixture_clear(&f);
    }
    /* but from glass to glass of the same index one does */
    Fixture f;
    World world;
    open_world(
        &f, &world,
        "medium melt { ior = 1.5  emission = 1 } medium glass { ior = 1.5 } sphere { interior = melt  radius = 30 }"
        "sphere { interior = glass  radius = 60 }");
    assert_int_equal(world.media.n_glows, 1);
    world_clear(&world);
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(densities),
        cmocka_unit_test(none),
    };
    return cmocka_run_group_tests_name("glow", tests, NULL, NULL);
}
