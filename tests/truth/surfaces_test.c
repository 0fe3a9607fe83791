/* surfaces_test.c - rough boundaries, skins, coats and metals in scenes: white furnaces, and light that is the same
 * whether light sampling or scattering finds it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/color.h"
#include "truth.h"

#include "temporary.h"

enum { WIDTH = 32 };

#define HEAD                                                                                                           \
    "meniscus 1.0 unit m\n"                                                                                            \
    "medium glass { ior = 1.5  state = solid } medium gem { ior = 2.42  state = solid } medium water { ior = 1.33  "   \
    "state = liquid }\n"                                                                                               \
    "medium flint { ior = cauchy(1.6, .01)  state = solid }\n"
#define VIEW "camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 22deg }\n"

/* Nothing is absorbed, and so everything is 1: what one facet throws at another is not lost. The bound is that of the
 * tables by which it is kept. */
static void white_furnaces(void **state)
{
    (void)state;
    static const char *const things[] = {
        "sphere { interior = glass  surface = surface { roughness = %s } }",
        "sphere { interior = gem  surface = surface { roughness = %s } }",
        "sphere { interior = flint  surface = surface { roughness = %s } }",
        "sphere { interior = glass  surface = surface { roughness = %s } } sphere { interior = water  center = <.3, "
        ".2, 0>  radius = .9 }",
        "sphere { surface = surface { albedo = 1  ior = 1.5  roughness = %s } }",
        "sphere { surface = surface { albedo = 1  coat = .7  coat_roughness = %s } }",
        "sphere { surface = surface { albedo = 1  diffuse_roughness = %s } }",
        "sphere { interior = water  radius = 1.3 } sphere { surface = surface { albedo = 1  ior = 1.5  roughness = %s "
        "} }",
        "sphere { surface = surface { thin = true  ior = 1.5  transmission = 1  roughness = %s } } sphere { interior = "
        "water  radius = .8 }",
        "sphere { surface = surface { thin = true  albedo = 1  translucency = .4  ior = 1.4  roughness = %s } }",
        "sphere { surface = surface { thin = true  ior = 1.33  transmission = .7  film = 400nm  albedo = 1  roughness "
        "= %s } }",
        "sphere { surface = surface { albedo = 1  metalness = .5  ior = 1.5  roughness = %s  coat = 1  fuzz = .6 } }",
        "sphere { interior = glass  surface = surface { transmission = .6  albedo = 1  ior = 1.5  roughness = %s } }",
        "sphere { interior = glass  surface = surface { roughness = %s  anisotropy = .8  grain = x  grain_angle = 25 } "
        "} sphere { interior = water  center = <.3, .2, 0>  radius = .9 }",
        "sphere { interior = water  radius = 1.3 } sphere { interior = gem  surface = surface { roughness = %s  "
        "anisotropy = .6 } } sphere { interior = air  radius = .6 }",
        "sphere { interior = water  radius = 1.3 } sphere { surface = surface { albedo = 1  ior = 1.5  roughness = %s  "
        "anisotropy = .8  coat = .5  coat_roughness = .4  coat_anisotropy = .7 } }",
        "sphere { interior = gem  radius = 1.3 } sphere { surface = surface { albedo = 1  metalness = .5  ior = 1.5  "
        "roughness = %s  anisotropy = .9  coat = .6  coat_roughness = .5  coat_anisotropy = .9  fuzz = .5 } }",
        "sphere { surface = surface { albedo = 1  metalness = .5  roughness = noise { from = .15  to = %s }  "
        "anisotropy = .8  coat = 1  coat_roughness = .3  coat_anisotropy = .6 } }",
        "sphere { interior = glass  surface = surface { mix = [surface { transmission = 0  albedo = 1 }, surface { "
        "roughness = %s }]  weight = .6 } }",
    };
    const double roughness[] = {0.1, 0.3, 0.6, 1};
    for (size_t i = 0; i < COUNT_OF(things); i++)
        for (size_t k = i < 8 ? 0 : 1; k < COUNT_OF(roughness); k += i < 8 ? 1 : 2) { /* of the later ones, two each */
            char thing[400], text[1200], what[140], value[20];
            snprintf(what, sizeof what, "%.*s..., roughness %g", 62, things[i], roughness[k]);
            snprintf(value, sizeof value, "%g", roughness[k]);
            truth_fill(thing, sizeof thing, things[i], value);
            snprintf(text, sizeof text, HEAD "%s " VIEW TRUTH_WHITE_SKY, thing);
            truth_white(what, text, WIDTH, 256, 0.005);
        }
}

/* ---- coats are layers ---- */

/* What a matte ground of that albedo looks like, straight from above, under a layer of that index which leaves `left` of what crosses it
 * twice along the normal: R + (1 - R) e^-d a T / (1 - a r), with T what of diffuse light from below gets out, and r what comes back. */
static double coated(double ior, double left, double albedo)
{
    enum { STEPS = 20000 };
    double depth = -0.5 * log(left), out = 0, back = 0, mirrored = truth_fresnel(1, 1, ior);
    for (int i = 0; i < STEPS; i++) {
        double c = (i + 0.5) / STEPS, r = truth_fresnel(c, ior, 1);
        out += 2 * c * (1 - r) * exp(-depth / c) / STEPS;
        back += 2 * c * r * exp(-2 * depth / c) / STEPS;
    }
    return mirrored + (1 - mirrored) * exp(-depth) * albedo * out / (1 - albedo * back);
}

#define ABOVE "camera { projection = orthographic  from = <0, 5, .001>  to = <0, 0, 0>  up = <0, 0, 1>  width = .1 }\n"

/* Over what is matte in closed form. (Tinted coats were up to 18 % too bright there, and coats and skins of indices above 3 too dark,
 * by 8 % where they are white.) */
static void coats_are_layers(void **state)
{
    (void)state;
    static const double cases[][3] = {{1.5, .9, 1},   {1.5, .5, 1}, {1.5, .5, .5}, {2, .5, .8}, {1.2, .5, .8},
                                      {1.05, .2, .8}, {3.5, 1, 1},  {4, 1, 1},     {4, 1, .8},  {4, .5, .9}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const double ior = cases[i][0], tint = cases[i][1], albedo = cases[i][2];
        char text[400], what[100];
        snprintf(what, sizeof what, "albedo %g under a coat of index %g, tint %g", albedo, ior, tint);
        snprintf(
            text, sizeof text,
            "meniscus 1.0 ground { surface = surface { albedo = %g  coat = 1  coat_ior = %g  coat_tint = %g } }" ABOVE
                TRUTH_WHITE_SKY,
            albedo, ior, tint);
        Picture picture = truth_render_text(text, 8, 400);
        const double expected = coated(ior, tint, albedo);
        Estimate measured = truth_mean(&picture, 1);
        truth_figure(what, expected, measured.mean, measured.error);
        assert_near(measured.mean, expected, 0.0025 * expected + 3 * measured.error); /* tables have errors */
        assert_true(measured.error < 0.002 * expected);
        truth_clear(&picture);
    }
}

/* Over rough metal, of which much of the light goes beyond the critical angle: as a real layer, about. (They were up to 1.5 times too
 * bright.) */
static void coats_on_rough_metal(void **state)
{
    (void)state;
    static const double cases[][3] = {{.2, 1, .5},  {.4, 1, .5},  {.6, 1, .5}, {.6, 1, .9},
                                      {.6, .5, .5}, {.4, .5, .9}, {.6, .9, 1}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const double roughness = cases[i][0], tint = cases[i][1], albedo = cases[i][2];
        char coat[500], layer[600], what[100];
        snprintf(what, sizeof what, "metal of albedo %g, roughness %g, under a coat, tint %g", albedo, roughness, tint);
        snprintf(coat, sizeof coat,
                 "meniscus 1.0 ground { surface = surface { albedo = %g  metalness = 1  roughness = %g  coat = 1  "
                 "coat_tint = %g } }" ABOVE TRUTH_WHITE_SKY,
                 albedo, roughness, tint);
        snprintf(layer, sizeof layer,
                 "meniscus 1.0 medium w { ior = 1.5  absorption = %.9g / 1m  state = solid } plane { distance = 1  "
                 "interior = w } ground { surface = surface { albedo = %g  metalness = 1  roughness = %g } }" ABOVE
                     TRUTH_WHITE_SKY,
                 -0.5 * log(tint) + 0, albedo, roughness);
        Picture a = truth_render_text(coat, 8, 1000), b = truth_render_text(layer, 8, 2000);
        Estimate ratio = truth_ratio(truth_mean(&a, 1), truth_mean(&b, 1));
        truth_figure(what, 1, ratio.mean, ratio.error);
        assert_near(ratio.mean, 1, 0.04 + 3 * ratio.error);
        assert_true(ratio.error < 0.01);
        truth_clear(&a);
        truth_clear(&b);
    }
}

/* A skin of a smaller index than what is around it, of which each wavelength has another: what is white there is white in each
 * channel, by the same picture without it. (It was 8 % too red and 7 % too dark in blue, with a roughness of .1 25 % too red.) */
static void skins_in_flint_are_white(void **state)
{
    (void)state;
    static const char *const skins[] = {"albedo = 1  ior = 1.5  roughness = .3",
                                        "albedo = 1  ior = 1.5  roughness = .1",
                                        "albedo = 1  coat = 1  coat_ior = 1.5  coat_roughness = .3",
                                        "thin = true  transmission = .7  albedo = 1  ior = 1.5  roughness = .3",
                                        "albedo = 1  ior = 1.5  roughness = .3  anisotropy = .8"};
    for (size_t i = 0; i < COUNT_OF(skins); i++) {
        Estimate channels[2][3];
        for (int without = 0; without < 2; without++) {
            char text[900];
            snprintf(text, sizeof text,
                     HEAD "medium heavy { ior = cauchy(1.747, .0128) } world { medium = heavy }\n"
                          "sphere { center = <0, 0, %d>  radius = 3  surface = surface { %s } }" VIEW TRUTH_WHITE_SKY,
                     without ? 50 : 0, skins[i]);
            Picture picture = truth_render_text(text, WIDTH, 256);
            for (int c = 0; c < 3; c++) channels[without][c] = truth_mean(&picture, c);
            truth_clear(&picture);
        }
        for (int c = 0; c < 3; c++) {
            Estimate ratio = truth_ratio(channels[0][c], channels[1][c]);
            char what[140];
            snprintf(what, sizeof what, "channel %d, %s", c, skins[i]);
            truth_figure(what, 1, ratio.mean, ratio.error);
            assert_near(ratio.mean, 1, 0.002 + 3 * ratio.error);
            assert_true(ratio.error < 0.002);
        }
    }
}

/* Light is reflected totally many times within rough gems: all that comes of it comes evenly. */
static void rough_gems_are_even(void **state)
{
    (void)state;
    static const struct {
        double index, roughness,
            error; /* four standard ones, of 256 samples; a half to a twenty-fifth of those of before, when facets were
                                         * sampled without regard to what hides them */
    } cases[] = {{1.5, 0.65, 0.002}, {2.4, 0.65, 0.003}, {3, 0.65, 0.005}, {3.7, 0.3, 0.003}, {3.7, 0.65, 0.006}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[600], what[80];
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit m medium gem { ior = %g } sphere { interior = gem  surface = surface { roughness = %g } "
            "} " VIEW TRUTH_WHITE_SKY,
            cases[i].index, cases[i].roughness);
        snprintf(what, sizeof what, "rough gem, index %g, roughness %g", cases[i].index, cases[i].roughness);
        truth_white(what, text, WIDTH, 256, cases[i].error);
    }
}

/* Within a medium of next to no index of its own around everything, light sampling is blocked by the boundary, and all
 * light is found by scattering. */
static void lights_are_found_alike(void **state)
{
    (void)state;
    static const char *const things[] = {
        "sphere { interior = glass  surface = surface { roughness = .5 } }",
        "sphere { surface = surface { metal = gold  roughness = .4 } }",
        "sphere { surface = surface { albedo = rgb(.8, .3, .1)  ior = 1.5  roughness = .3 } }",
        "sphere { surface = surface { albedo = rgb(.8, .3, .1)  coat = 1  coat_roughness = .5  coat_tint = rgb(.9, .8, "
        ".3) } }",
        "sphere { surface = surface { albedo = .8  diffuse_roughness = 1 } }",
        "sphere { surface = surface { thin = true  albedo = rgb(.4, .6, .2)  translucency = .5  ior = 1.4  roughness = "
        ".5 } }",
        "sphere { surface = surface { thin = true  ior = 1.5  transmission = 1  roughness = .6 } }",
        "sphere { surface = surface { albedo = rgb(.4, .1, .1)  fuzz = .9  fuzz_color = rgb(1, .5, .5) } }",
        "sphere { surface = surface { metal = iron  roughness = .5  anisotropy = .8 } }",
        "sphere { interior = glass  surface = surface { roughness = .5  anisotropy = .8  grain_angle = 30 } }",
        "sphere { surface = surface { mix = [surface { albedo = .7 }, surface { metal = gold  roughness = .5 }]  "
        "weight = .3 } }",
    };
    for (size_t i = 0; i < COUNT_OF(things); i++) {
        Estimate seen[2];
        for (int chance = 0; chance < 2; chance++) {
            char text[1200];
            snprintf(text, sizeof text, HEAD "%s %s " VIEW TRUTH_SKY, things[i],
                     chance ? "medium veil { ior = 1.00001 } sphere { interior = veil  radius = 20  priority = -1 }"
                            : "");
            Picture picture = truth_render_text(text, WIDTH, 512);
            seen[chance] = truth_total(&picture);
            truth_clear(&picture);
        }
        truth_expect(things[i], 1, truth_ratio(seen[0], seen[1]), 4, 0.01);
    }
}

/* The mean luminance of the 64 pixels in the middle. */
static double middle_of(const Picture *picture)
{
    double sum = 0;
    for (uint32_t y = 0; y < 8; y++)
        for (uint32_t x = 0; x < 8; x++) sum += truth_luminance(picture, WIDTH / 2 - 4 + x, WIDTH / 2 - 4 + y) / 64;
    return sum;
}

/* What reflects under water reflects less: a skin of water's own index is not there. */
static void surroundings_count(void **state)
{
    (void)state;
    static const char *const text[] = {
        HEAD "sphere { interior = water  radius = 20 } sphere { surface = surface { albedo = 0  ior = 1.33 } }" VIEW
            TRUTH_WHITE_SKY,
        HEAD "sphere { surface = surface { albedo = 0  ior = 1.33 } }" VIEW TRUTH_WHITE_SKY,
    };
    double middle[2];
    for (int i = 0; i < 2; i++) {
        Picture picture = truth_render_text(text[i], WIDTH, 512);
        middle[i] = middle_of(&picture);
        truth_clear(&picture);
    }
    double expected = pow(0.33 / 2.33, 2);
    truth_figure("a skin of water in the air, head on", expected, middle[1], 0);
    truth_figure("the same in water", 0, middle[0], 0);
    assert_true(middle[0] < 1e-5);
    /* and so paint looks darker and more saturated when it is wet: plastic gives 4 % of white on top of its colour in the
     * air, under water 0.36 %, which so few paths find that many are asked */
    static const char *const skins[] = {
        HEAD "sphere { interior = water  radius = 20 } sphere { surface = surface { albedo = 0  ior = 1.5  roughness = "
             ".1 } }" VIEW TRUTH_WHITE_SKY,
        HEAD "sphere { surface = surface { albedo = 0  ior = 1.5  roughness = .1 } }" VIEW TRUTH_WHITE_SKY,
    };
    for (int i = 0; i < 2; i++) {
        Picture picture = truth_render_text(skins[i], WIDTH, 8192);
        double index = i ? 1.5 : 1.5 / 1.33, head_on = pow((index - 1) / (index + 1), 2);
        double seen = middle_of(&picture);
        truth_figure(i ? "plastic in the air, head on" : "plastic under water, head on", head_on, seen, 0);
        assert_true(fabs(seen - head_on) < 0.06 * head_on);
        truth_clear(&picture);
    }
    assert_true(fabs(middle[1] - expected) < 0.03 * expected);
}

/* A ball of 180 triangles with the normals of a sphere: of light that its normals send into it, nothing is lost. */
static void smooth_meshes_lose_nothing(void **state)
{
    (void)state;
    enum { RINGS = 7, COLUMNS = 15 };
    const char *path = in_folder("ball.obj");
    FILE *out = fopen(path, "w");
    assert_non_null(out);
    for (int i = 0; i <= RINGS; i++)
        for (int k = 0; k < COLUMNS; k++) {
            double down = 3.14159265358979 * i / RINGS, around = 2 * 3.14159265358979 * k / COLUMNS;
            double x = sin(down) * cos(around), y = cos(down), z = sin(down) * sin(around);
            fprintf(out, "v %.9f %.9f %.9f\nvn %.9f %.9f %.9f\n", x, y, z, x, y, z);
        }
    for (int i = 0; i < RINGS; i++)
        for (int k = 0; k < COLUMNS; k++) {
            int a = i * COLUMNS + k + 1, b = i * COLUMNS + (k + 1) % COLUMNS + 1, c = a + COLUMNS, d = b + COLUMNS;
            if (i > 0) fprintf(out, "f %d//%d %d//%d %d//%d\n", a, a, b, b, d, d);
            if (i + 1 < RINGS) fprintf(out, "f %d//%d %d//%d %d//%d\n", a, a, d, d, c, c);
        }
    fclose(out);
    static const char *const surfaces[] = {
        "albedo = 1", "albedo = 1  ior = 1.5  roughness = .3", "albedo = 1  ior = 1.5",
        "thin = true  transmission = .5  translucency = .5  albedo = 1  ior = 1.5  roughness = .4"};
    for (size_t i = 0; i < COUNT_OF(surfaces); i++) {
        char text[1200];
        snprintf(text, sizeof text, HEAD "mesh { file = \"%s\"  surface = surface { %s } } " VIEW TRUTH_WHITE_SKY, path,
                 surfaces[i]);
        truth_white(surfaces[i], text, WIDTH, 256, 0.001);
    }
}

/* Head on, a film whose thickness is a quarter of the wavelength in it reflects as a pane of two boundaries in phase:
 * ((1 - n^2) / (1 + n^2))^2; one that is very thin, nothing. */
static void films_interfere(void **state)
{
    (void)state;
    const double thickness_nm[] = {0.5, 100};
    for (int i = 0; i < 2; i++) {
        char text[600];
        snprintf(text, sizeof text,
                 HEAD "sphere { surface = surface { thin = true  ior = 1.4  transmission = 1  film = %gnm } }" VIEW
                      "sphere { center = <0, 0, -9>  radius = 7  surface = surface { albedo = 0 } }" TRUTH_WHITE_SKY,
                 thickness_nm[i]);
        Picture picture = truth_render_text(text, WIDTH, 4096);
        double middle = 0; /* of nine pixels: by 4096 samples one is off by 1.2 % */
        for (uint32_t p = 0; p < 9; p++)
            middle += truth_luminance(&picture, WIDTH / 2 - 1 + p % 3, WIDTH / 2 - 1 + p / 3) / 9;
        /* two walls of the ball, one behind the other, over the eye's colours */
        double once = 0, weights = 0;
        for (int nm = 360; nm <= 830; nm += 5) {
            float xyz[3], white = lanes_get(white_at(lanes_all((float)nm)), 0);
            color_matching((float)nm, xyz);
            double weight = (double)xyz[1] * (double)white, r = pow(0.4 / 2.4, 2);
            double waves = 4 * r * pow(sin(2 * 3.14159265358979 * 1.4 * thickness_nm[i] / nm), 2);
            double of_one = waves / ((1 - r) * (1 - r) + waves);
            once += weight * 2 * of_one / (1 + of_one);
            weights += weight;
        }
        truth_figure(i ? "a film of 100 nm, head on" : "a film of half a nanometre", once / weights, middle, 0);
        assert_true(fabs(middle - once / weights) < 0.015 * once / weights + 2e-4);
        truth_clear(&picture);
    }
}

/* A ball of which the part t is clear and the rest is painted with the albedo a, under a white sky, where no index differs:
 * within, the radiance is B = t + (1 - t) a B everywhere, and from outside one sees (1 - t) a + t B. */
static void paint_shows_without_boundaries(void **state)
{
    (void)state;
    static const struct {
        const char *thing;
        double transmission, clear;
    } cases[] = {
        {"medium g { ior = 1 } sphere { interior = g surface = %s }", .5, .5},
        {"medium g { ior = 1.0001 } sphere { interior = g surface = %s }", .5, .5},
        {"sphere { interior = air surface = %s }", .5, .5},
        {"sphere { interior = air surface = %s }", 0, 0},
        {"medium g { ior = 1 } sphere { interior = g surface = %s } sphere { interior = g  radius = .5 }", .5, .5},
        {"medium g { ior = 1 } sphere { interior = g  radius = 2 } sphere { interior = g surface = %s }", .5, .5},
        {"sphere { interior = air  radius = 2 } sphere { interior = air surface = %s }", .5, .5},
        {"intersection { interior = air  surface = %s  sphere { } sphere { center = <.5, 0, -.5> } }", .5, .5},
        {"sphere { interior = air  surface = surface { mix = [%s, surface { roughness = .3 }]  weight = .5 } }", 0, .5},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        const double t = cases[i].clear, a = .6;
        char thing[400], text[900], paint[100];
        snprintf(paint, sizeof paint, "surface { transmission = %g  albedo = %g }", cases[i].transmission, a);
        truth_fill(thing, sizeof thing, cases[i].thing, paint);
        snprintf(text, sizeof text, HEAD "%s camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 2deg }" TRUTH_WHITE_SKY,
                 thing);
        truth_expect(cases[i].thing, (1 - t) * a + t * t / (1 - (1 - t) * a), truth_measure(text, NULL, 1024, false), 4,
                     0.002);
    }
    Estimate shadow = truth_measure(
        HEAD
        "sphere { interior = air  surface = surface { transmission = 0 } } light { shape = point  from = <0, 2, 0>  "
        "intensity = 9 } ground { y = -1.5  surface = surface { } } camera { from = <0, -1.3, 2>  to = <0, -1.5, 0>  "
        "fov = 2deg }",
        NULL, 16, false);
    truth_figure("the shadow of what is painted", 0, shadow.mean, 0);
    assert_true(shadow.mean < 0.001); /* light that goes from the ball to the ground and back; with no ball it is 0.1 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(white_furnaces),      cmocka_unit_test(skins_in_flint_are_white),
        cmocka_unit_test(rough_gems_are_even), cmocka_unit_test(lights_are_found_alike),
        cmocka_unit_test(surroundings_count),  cmocka_unit_test(smooth_meshes_lose_nothing),
        cmocka_unit_test(films_interfere),     cmocka_unit_test(paint_shows_without_boundaries),
        cmocka_unit_test(coats_are_layers),    cmocka_unit_test(coats_on_rough_metal),
    };
    return cmocka_run_group_tests_name("surfaces", tests, make_folder, remove_folder);
}
