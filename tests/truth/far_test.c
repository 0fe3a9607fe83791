/* far_test.c - objects far from the origin look as they do at it: what they let through and take away is the same, to the last of
 * their edges.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 48, SAMPLES = 64 };

/* The mean of a picture of an object and its camera, moved together, under a white sky. */
static double mean_at(const char *object, double offset)
{
    char text[2000];
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm\nmedium dark { ior = 1.5  absorption = 2  state = solid }\n"
             "group { translate(<%.17g, 0, 0>)  %s }\n"
             "camera { from = <%.17g, .4, 4>  to = <%.17g, 0, 0>  fov = 40deg }\n" TRUTH_SKY,
             offset, object, offset, offset);
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text});
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    truth_render(&scene, &settings, 0, &picture);
    assert_int_equal(picture.stats.nesting_faults, 0);
    double sum = 0;
    for (uint32_t y = 0; y < WIDTH; y++)
        for (uint32_t x = 0; x < WIDTH; x++) sum += truth_luminance(&picture, x, y);
    truth_clear(&picture);
    fixture_clear(&scene);
    return sum / (WIDTH * WIDTH);
}

static void far_is_as_near(void **state)
{
    (void)state;
    /* bounds: relative, at 1e4, 1e5 and 4e5, where only exact shapes are let through without a remark (0: not tried); those
     * of meshes, whose corners are floats, are what rounding them makes of their sizes */
    static const struct {
        const char *name, *object;
        double bounds[3];
    } cases[] = {
        {"sphere", "sphere { interior = dark }", {1e-9, 1e-9, 1e-9}},
        {"cylinder", "cylinder { interior = dark  from = -.7 * y  to = .7 * y  radius = .8 }", {1e-9, 1e-9, 1e-9}},
        {"lathe",
         "lathe { interior = dark  profile = [<0, -1>, <.7, -1>, <.5, .2>, <.8, 1>, <0, 1>] }",
         {1e-9, 1e-9, 2e-5}},
        {"torus", "torus { interior = dark  radius = .7  tube = .3  rotate(x, 50) }", {1e-9, 1e-9, 1e-9}},
        {"box", "box { interior = dark  size = <1.5, 1.5, 1.5>  rotate(y, 30) }", {3e-4, 3e-3, 0}},
        {"mesh", "superellipsoid { interior = dark  exponents = <.5, .5> }", {2e-4, 1e-3, 0}},
    };
    static const double offsets[] = {1e4, 1e5, 4e5};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double near = mean_at(cases[i].object, 0);
        for (size_t k = 0; k < COUNT_OF(offsets) && cases[i].bounds[k] > 0; k++) {
            double apart = mean_at(cases[i].object, offsets[k]) / near - 1;
            printf("  %-10s at %g: %+.1e of its picture at the origin\n", cases[i].name, offsets[k], apart);
            if (!(fabs(apart) <= cases[i].bounds[k])) fail_msg("%s at %g", cases[i].name, offsets[k]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(far_is_as_near)};
    return cmocka_run_group_tests_name("far", tests, NULL, NULL);
}
