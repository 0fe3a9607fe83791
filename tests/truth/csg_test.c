/* csg_test.c - combinations against the same shapes modelled without them: pictures of one seed must be the same up to
 * rounding, because every path meets the same surfaces.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

enum { WIDTH = 64, SAMPLES = 64 };

#define HEAD                                                                                                           \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass { ior = 1.5  absorption = .03 / 1mm  state = solid }\n"                                              \
    "medium water { ior = 1.33 absorption = .02 / 1mm  state = liquid }\n"
#define SURROUNDINGS                                                                                                   \
    TRUTH_SKY "ground { y = -20  surface = surface { albedo = .6  pattern = \"checker\"  check_size = 7 } }\n"         \
              "camera { from = <25, 35, 60>  to = <0, 0, 0>  fov = 40deg }\n"

static double two_skies(double elevation)
{
    return elevation > 0.3 ? 2 : 0.3;
}

static void render_text(const char *text, Picture *picture)
{
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .sky = two_skies});
    RenderSettings settings = truth_settings(WIDTH, SAMPLES);
    truth_render(&scene, &settings, 0, picture);
    assert_int_equal(picture->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

/* Of two pictures of one seed: the sum of all pixels, of their differences and of those squared, and how many differ.
 */
typedef struct Comparison {
    double sum, difference, squares;
    uint32_t n_other;
} Comparison;

static Comparison compare_pictures(const char *what, const char *combined, const char *plain)
{
    Picture a, b;
    Comparison c = {0};
    render_text(combined, &a);
    render_text(plain, &b);
    for (uint32_t y = 0; y < WIDTH; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            double d = truth_luminance(&a, x, y) - truth_luminance(&b, x, y);
            c.n_other += fabs(d) > 1e-4 * truth_luminance(&b, x, y);
            c.difference += d;
            c.squares += d * d;
            c.sum += truth_luminance(&b, x, y);
        }
    truth_figure(what, 1, 1 + c.difference / c.sum, sqrt(c.squares) / c.sum);
    printf("    %u of %u pixels differ by more than 1e-4\n", c.n_other, (unsigned)(WIDTH * WIDTH));
    truth_clear(&a);
    truth_clear(&b);
    return c;
}

/* Every path meets the same surfaces. Those that pass within rounding of an edge may go either way: one of them moves a
 * pixel by 1 / SAMPLES of what it carries. */
static void expect_same_picture(const char *what, const char *combined, const char *plain)
{
    Comparison c = compare_pictures(what, combined, plain);
    assert_true(c.n_other <= WIDTH * WIDTH / 1000);
    assert_true(fabs(c.difference) <= 1e-5 * c.sum);
}

/* An L, as a difference whose faces partly coincide, as a union with an overlap, and as a mesh. */
#define L_MESH                                                                                                         \
    "mesh { interior = glass\n"                                                                                        \
    "  positions = [<-10,-10,-8>, <10,-10,-8>, <10,0,-8>, <0,0,-8>, <0,10,-8>, <-10,10,-8>,\n"                         \
    "               <-10,-10,8>, <10,-10,8>, <10,0,8>, <0,0,8>, <0,10,8>, <-10,10,8>]\n"                               \
    "  triangles = [<6,7,9>, <7,8,9>, <6,9,11>, <9,10,11>, <0,3,1>, <1,3,2>, <0,5,3>, <3,5,4>,\n"                      \
    "    <0,1,7>, <0,7,6>, <1,2,8>, <1,8,7>, <2,3,9>, <2,9,8>, <3,4,10>, <3,10,9>, <4,5,11>, <4,11,10>, <5,0,6>, "     \
    "<5,6,11>] }\n"
#define L_DIFFERENCE                                                                                                   \
    "difference { interior = glass  box { from = <-10, -10, -8>  to = <10, 10, 8> }\n"                                 \
    "  box { from = <0, 0, -8>  to = <10, 12, 9> } }\n"
#define L_UNION                                                                                                        \
    "union { interior = glass  box { from = <-10, -10, -8>  to = <10, 0, 8> }  box { from = <-10, -4, -8>  to = <0, "  \
    "10, 8> } }\n"

static void a_difference_is_the_mesh(void **state)
{
    (void)state;
    expect_same_picture("an L as a difference, as a mesh", HEAD L_DIFFERENCE SURROUNDINGS, HEAD L_MESH SURROUNDINGS);
    expect_same_picture("an L as a union, as a mesh", HEAD L_UNION SURROUNDINGS, HEAD L_MESH SURROUNDINGS);
}

static void a_difference_in_water_is_the_mesh(void **state)
{
    (void)state;
    const char *water = "sphere { interior = water  center = <4, 2, 0>  radius = 12 }\n";
    char combined[2000], plain[2000];
    snprintf(combined, sizeof combined, "%s%s%s%s", HEAD, L_DIFFERENCE, water, SURROUNDINGS);
    snprintf(plain, sizeof plain, "%s%s%s%s", HEAD, L_MESH, water, SURROUNDINGS);
    expect_same_picture("an L that overlaps a drop", combined, plain);
}

static void a_turned_difference_is_the_lathe(void **state)
{
    (void)state;
    expect_same_picture(
        "a cup as a difference, as a lathe",
        HEAD "difference { interior = glass cylinder { from = <0, -10, 0> to = <0, 10, 0> radius = 12 }"
             "  cylinder { from = <0, -7, 0> to = <0, 11, 0> radius = 9 } }"
             "cylinder { interior = water from = <0, -7.5, 0> to = <0, 3, 0> radius = 9.5 }" SURROUNDINGS,
        HEAD "lathe { interior = glass profile = [<0, -10>, <12, -10>, <12, 10>, <9, 10>, <9, -7>, <0, -7>] }"
             "cylinder { interior = water from = <0, -7.5, 0> to = <0, 3, 0> radius = 9.5 }" SURROUNDINGS);
}

/* The normal of what is taken away points the other way, and so do the axes about it in which diffuse directions are
 * drawn: the same picture with other noise. */
static void an_opaque_difference_is_the_mesh(void **state)
{
    (void)state;
    char combined[2000], plain[2000];
    const char *surface = "surface = surface { albedo = .7 }";
    snprintf(combined, sizeof combined,
             HEAD "difference { %s box { from = <-10, -10, -8> to = <10, 10, 8> } box { from = <0, 0, -9> to = <11, "
                  "12, 9> } }" SURROUNDINGS,
             surface);
    const char *mesh = L_MESH;
    snprintf(plain, sizeof plain, HEAD "%.*s%s%s" SURROUNDINGS, (int)strlen("mesh { "), mesh, surface,
             mesh + strlen("mesh { interior = glass"));
    Comparison c = compare_pictures("an opaque L", combined, plain);
    assert_true(fabs(c.difference) <= 4 * sqrt(c.squares));
    assert_true(sqrt(c.squares) <= 1e-3 * c.sum);
}

/* A pane lets lamps be looked for through it, and what comes straight through is not counted again; whether it is written as a
 * combination does not matter. */
static void a_pane_may_be_a_combination(void **state)
{
    (void)state;
#define PANE "box { from = <-10, 5, -10>  to = <10, 9, 10> }"
#define CLEAR "surface = surface { thin = true  transmission = 1  ior = 1.5 }"
#define BELOW                                                                                                          \
    "light { shape = sphere  from = <0, 30, 0>  radius = 5  radiance = 20 }"                                           \
    "light { shape = point  from = <15, 40, 9>  intensity = 900 } ground { y = -2  surface = surface { } }"            \
    "camera { from = <0, 20, 40>  to = <0, 0, 0>  fov = 40 }"
    expect_same_picture("a pane as a union", HEAD "union { " PANE CLEAR " }" BELOW,
                        HEAD "box { from = <-10, 5, -10>  to = <10, 9, 10>  " CLEAR " }" BELOW);
    expect_same_picture(
        "a pane cut out of a larger one",
        HEAD "intersection { box { from = <-10, 5, -10>  to = <10, 30, 10> } box { from = <-50, -9, -50>  to = "
             "<50, 9, 50> } " CLEAR " }" BELOW,
        HEAD "box { from = <-10, 5, -10>  to = <10, 9, 10>  " CLEAR " }" BELOW);
}

/* Looks at a place of a ball that is an operand come to it, however near it is. */
static void a_glowing_operand_lights_what_it_touches(void **state)
{
    (void)state;
#define GLOW "surface = surface { albedo = 0  emission = 1  radiance = 3 }  translate(<0, -8, 0>)"
#define STRIP                                                                                                          \
    "ground { surface = surface { albedo = .8 } } camera { projection = orthographic  from = <9.14427, 30, 0>  to = "  \
    "<9.14427, 0, 0>  width = .4  up = <0, 0, -1> }"
    expect_same_picture("beside a ball that shines, cut by nothing",
                        HEAD "intersection { sphere { radius = 12 } box { size = <50, 50, 50> } " GLOW " }" STRIP,
                        HEAD "sphere { radius = 12  " GLOW " }" STRIP);
}

/* The paint of an operand is where the whole has a surface: looks at lamps behind a block of glass pass by where it has none. */
static void paint_is_where_the_whole_is(void **state)
{
    (void)state;
#define PAINTED "surface = surface { transmission = .7  albedo = .6 }  translate(<12, -15, 9>)"
#define BLOCK                                                                                                          \
    "box { interior = glass  from = <-90, 40, -90>  to = <90, 44, 90> }"                                               \
    "light { shape = sphere  from = <5, 65, 3>  radius = 4  radiance = 90 }" SURROUNDINGS
    Comparison c = compare_pictures(
        "a painted ball, cut by nothing, under a block",
        HEAD "intersection { interior = glass  sphere { radius = 3 } cylinder { from = <0, -5, 0>  to = "
             "<0, 35, 0>  radius = 30 } " PAINTED " }" BLOCK,
        HEAD "sphere { interior = glass  radius = 3  " PAINTED " }" BLOCK);
    assert_true(fabs(c.difference) <= 4 * sqrt(c.squares));
    assert_true(c.n_other <= WIDTH * WIDTH / 40); /* other noise in half of them where they do not */
}

/* Opaque operands whose faces are at one place, turned in many ways, so that rounding has them now one in front and now the other: the
 * one declared last is seen, all over. */
static void of_opaque_faces_at_one_place_the_last_is_seen(void **state)
{
    (void)state;
    enum { SIDE = 24, TURNS = 12 };
#define FIRST "surface = surface { albedo = rgb(.9, 0, 0) } }"
#define LAST "surface = surface { albedo = rgb(0, 0, .9) } } }"
    static const char *const solids[] = {
        "intersection { box { from = <-9, -9, -5>  to = <9, 9, 5> " FIRST
        " box { from = <-8, -30, -30>  to = <30, 30, 5> " LAST,
        "union { box { from = <-9, -9, -5>  to = <9, 9, 5> " FIRST " box { from = <-9, -9, -7>  to = <9, 9, 5> " LAST,
        "difference { box { from = <-9, -9, -5>  to = <9, 9, 9> " FIRST
        " box { from = <-30, -30, 5>  to = <30, 30, 30> " LAST,
        "union { sphere { radius = 9 " FIRST " sphere { radius = 9 " LAST,
    };
    for (size_t i = 0; i < COUNT_OF(solids); i++)
        for (int turn = 0; turn < TURNS; turn++) {
            char text[1000];
            snprintf(text, sizeof text,
                     HEAD "group { %s camera { from = <0, 0, 90>  to = <0, 0, 0>  fov = 7 } rotate(<%d, %d, %d>) } "
                          "environment { }",
                     solids[i], 29 * turn, 31 * turn, 37 * turn);
            Fixture scene;
            Picture picture;
            truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
            RenderSettings settings = truth_settings(SIDE, 2);
            truth_render(&scene, &settings, 0, &picture);
            for (uint32_t y = 0; y < SIDE; y++)
                for (uint32_t x = 0; x < SIDE; x++)
                    assert_true(truth_channel(&picture, x, y, 0) < 0.1 && truth_channel(&picture, x, y, 2) > 0.4);
            truth_clear(&picture);
            fixture_clear(&scene);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_difference_is_the_mesh),
        cmocka_unit_test(a_difference_in_water_is_the_mesh),
        cmocka_unit_test(a_turned_difference_is_the_lathe),
        cmocka_unit_test(an_opaque_difference_is_the_mesh),
        cmocka_unit_test(a_pane_may_be_a_combination),
        cmocka_unit_test(a_glowing_operand_lights_what_it_touches),
        cmocka_unit_test(paint_is_where_the_whole_is),
        cmocka_unit_test(of_opaque_faces_at_one_place_the_last_is_seen),
    };
    return cmocka_run_group_tests_name("csg", tests, NULL, NULL);
}
