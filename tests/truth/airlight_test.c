/* airlight_test.c - light on its way through media: what hulls that shine give to their surroundings, and what haze
 * scatters of lamps, against closed forms and quadrature; and the ways to find it against each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#define FLOOR                                                                                                          \
    "meniscus 1.0 unit m ground { surface = surface { albedo = .8 } }\n"                                               \
    "camera { from = <0, .1, 4.5>  to = <0, 0, 0>  fov = .01deg }\n"

static Estimate ratio_of(Estimate a, Estimate b)
{
    double ratio = a.mean / b.mean;
    return (Estimate){ratio, ratio * hypot(a.error / a.mean, b.error / b.mean)};
}

/* ---- hulls that shine ---- */

/* A ball of clear gas shines in all directions as much for each volume. What a small surface gets from it falls with the
 * squared distance of each of its parts and with the cosine, as the pull of its mass would: as if all were in the middle. */
static void shining_ball(void **state)
{
    (void)state;
    static const struct {
        const char *what, *scene;
        double h, volume;
    } cases[] = {
        {"floor under a ball of gas that shines", "sphere { interior = gas  center = <0, 3, 0>  radius = 1 }", 3,
         4 * TRUTH_PI / 3},
        {"the same, nearly touching the floor", "sphere { interior = gas  center = <0, 1.05, 0>  radius = 1 }", 1.05,
         4 * TRUTH_PI / 3},
        {"the same, in haze of its own that mixes",
         "medium thin { mixes = true } box { interior = thin  size = <10, 10, 10> }"
         "sphere { interior = gas  center = <0, 3, 0>  radius = 1 }",
         3, 4 * TRUTH_PI / 3},
        {"a shell: a ball with a hole",
         "difference { sphere { center = <0, 3, 0>  radius = 1 } sphere { center = <0, 3, 0>  radius = .9 }"
         "  interior = gas }",
         3, 4 * TRUTH_PI / 3 * (1 - .729)},
        {"a ball with another hull in its middle",
         "medium air2 { ior = 1  priority = 5 } sphere { interior = gas  center = <0, 3, 0>  radius = 1 }"
         "sphere { interior = air2  center = <0, 3, 0>  radius = .7 }",
         3, 4 * TRUTH_PI / 3 * (1 - .343)},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "medium gas { ior = 1  emission = 1  radiance = 2 } %s", cases[i].scene);
        double expected = 0.8 / TRUTH_PI * 2 * cases[i].volume / (cases[i].h * cases[i].h);
        truth_expect(cases[i].what, expected, truth_measure(text, NULL, 256, false), 4, 0.01);
    }
}

/* The same where no closed form is at hand: found by light sampling as well, and by chance alone. */
static void shining_hulls_agree(void **state)
{
    (void)state;
    static const struct {
        const char *what, *scene;
    } cases[] = {
        {"a dense bar", "medium gas { ior = 1  emission = 1  absorption = <1, 3, 8>  scattering = .5 }"
                        "box { interior = gas  size = <.5, 2, .5>  rotate(<30, 20, 10>)  translate(<1, 1.5, 0>) }"},
        {"a flame, hotter above, in fog",
         "def t(p) = 1500 + 200 * p.y medium gas { mixes = true  emission = blackbody(1700)  absorption = .1"
         "  temperature = volume { function = t  from = <-3, -3, -3>  to = <3, 3, 3>  cells = 12 } }"
         "medium fog { ior = 1  scattering = .1 } box { interior = fog  from = <-5, -1, -5>  to = <5, 6, 5> }"
         "cone { interior = gas  from = <0, .5, 0>  to = <0, 2, 0>  radius_from = .6  radius_to = 0 }"},
        {"two of them, one small and one in glass", "medium gas { ior = 1  emission = 1 } medium glass { ior = 1.5 }"
                                                    "sphere { interior = gas  center = <.5, .5, 0>  radius = .3 }"
                                                    "sphere { interior = glass  center = <-1, 1.2, 0>  radius = 1 }"
                                                    "sphere { interior = gas  center = <-1, 1.2, 0>  radius = .8 }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "%s", cases[i].scene);
        Estimate sought = truth_measure(text, NULL, 512, false), chance = truth_measure(text, NULL, 2048, true);
        truth_expect(cases[i].what, 1, ratio_of(sought, chance), 4, 0.03);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shining_ball),
        cmocka_unit_test(shining_hulls_agree),
    };
    return cmocka_run_group_tests_name("airlight", tests, NULL, NULL);
}
