/* corners_test.c - where surfaces of several hulls have a corner in common, paths that are scattered, mirrored and refracted there
 * know on which side of each they go on.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

/* A camera so far from a corner, and a picture so small, that it shows what float tells apart of that place and no more. */
static const char scene_text[] =
    "meniscus 1.0 unit mm\n"
    "param kind = 0  param at = 0  param side = 0  param rough = 0\n"
    "medium glass { ior = 1.52  state = solid }  medium other { ior = 1.4  state = liquid }\n"
    "let frost = surface { roughness = rough }\n"
    "environment { color = .3 }  light { shape = sphere  from = <150, 120, 60>  radius = 8  radiance = 200 }\n"
    "let corners = [\n"
    "  [<10.48255, 4, 22.69616>, <10.48255, 56, 22.69616>, <14.4, 4, 19.2>, <14.82, 4, 19.76>],\n"
    "  [<10, 0, 10>, <10, 5, 3>, <10, 10, 10>, <3, 5, 10>],\n"
    "  [<6, 10, 8>, <10, 10, 0>, <6, 0, 8>, <6, 5, 8>],\n"
    "  [<10, 10, 3>, <10, 3, 10>, <3, 10, 10>, <10, 10, 10>]]\n"
    "if (kind == 0) {\n" /* a sleeve in a groove */
    "  lathe { interior = glass  profile = [<0, 0>, <25, 0>, <25, 4>, <24.7, 4>, <24.7, 56>, <25, 56>, <25, 60>, <21, "
    "60>, <21, 5>, <0, 5>] }\n"
    "  lathe { interior = glass  surface = frost  profile = [<24, 4>, <25, 4>, <25, 56>, <24, 56>] }\n"
    "}\n"
    "if (kind == 1) {\n" /* two boxes with edges in common */
    "  box { interior = glass  from = <0, 0, 0>  to = <10, 10, 10> }\n"
    "  box { interior = other  surface = frost  from = <1, 5, 1>  to = <10, 10, 10> }\n"
    "}\n"
    "if (kind == 2) {\n" /* discs on each other, and a plate on them */
    "  cylinder { interior = glass  from = <0, 0, 0>  to = <0, 10, 0>  radius = 10  surface = frost }\n"
    "  cylinder { interior = other  from = <0, 5, 0>  to = <0, 10, 0>  radius = 10 }\n"
    "  box { interior = glass  from = <-10, 10, -10>  to = <10, 12, 10>  surface = frost }\n"
    "}\n"
    "if (kind == 3) {\n" /* a box with a hole, filled, and a ball about its corner */
    "  difference { interior = glass  surface = frost  box { from = <0, 0, 0>  to = <10, 10, 10> }\n"
    "    box { from = <2, 2, 2>  to = <8, 11, 8> } }\n"
    "  box { interior = other  from = <2, 2, 2>  to = <10, 10, 8> }\n"
    "  sphere { interior = glass  center = <10, 10, 10>  radius = 3  surface = frost }\n"
    "}\n"
    "let from = [<0, 60, 250>, <200, -60, 190>, <-80, 150, 3>, <30, 8, 40>]\n"
    "camera { from = from[side]  to = corners[kind][at]  fov = .00001deg }\n";

typedef struct Faults {
    uint64_t faults, crossings;
} Faults;

static void add_corner(int kind, int at, int side, const char *rough, Faults *sum)
{
    char names[3][16];
    snprintf(names[0], sizeof names[0], "kind=%d", kind);
    snprintf(names[1], sizeof names[1], "at=%d", at);
    snprintf(names[2], sizeof names[2], "side=%d", side);
    const char *const defines[] = {names[0], names[1], names[2], rough, NULL};
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = scene_text, .defines = defines, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(24, 32);
    settings.caustics = CAUSTICS_OFF;
    truth_render(&scene, &settings, 0, &picture);
    sum->faults += picture.stats.nesting_faults;
    sum->crossings += picture.stats.crossings;
    truth_clear(&picture);
    fixture_clear(&scene);
}

static void are_left_to_the_right_side(void **state)
{
    (void)state;
    static const char *const roughs[] = {"rough=0", "rough=.35"};
    for (size_t i = 0; i < COUNT_OF(roughs); i++) {
        Faults sum = {0, 0};
        for (int k = 0; k < 64; k++) add_corner(k / 16, k / 4 % 4, k % 4, roughs[i], &sum);
        print_message("  %s: %llu faults in %llu crossings\n", roughs[i], (unsigned long long)sum.faults,
                      (unsigned long long)sum.crossings);
        assert_true(sum.crossings > 2000000);
        assert_true((double)sum.faults <= 1e-6 * (double)sum.crossings);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(are_left_to_the_right_side)};
    return cmocka_run_group_tests_name("corners", tests, NULL, NULL);
}
