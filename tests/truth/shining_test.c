/* shining_test.c - surfaces that shine here and there, of combinations of objects and with textures: looked for and by chance.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

/* ---- combinations that shine ---- */

#define LAMP "surface = lamp"
#define DARK "surface = dark"

/* The surface that shines is where that of an operand is the combination's, and nowhere else; where those of two operands are at one
 * place, it is there once. */
static void combinations(void **state)
{
    (void)state;
    static const struct {
        const char *what, *lamp;
    } cases[] = {
        {"half a ball", "difference { sphere { radius = 12 } box { from = <-20, 1, -20>  to = <20, 20, 20> } " LAMP
                        "  translate(<4, 18, 2>) }"},
        {"a bowl that shines inside, upside down",
         "difference { sphere { radius = 14  " DARK " } sphere { radius = 12  " LAMP
         " } box { from = <-20, -20, -20>  to = <20, 0, 20>  " DARK " }  translate(<3, 10, 0>) }"},
        {"a globe on its stem",
         "union { sphere { radius = 9  " LAMP " } cylinder { from = <0, -14, 0>  to = <0, -5, 0>  "
         "radius = 3  " DARK " }  translate(<4, 17, 0>) }"},
        {"two plates, level below, that overlap",
         "union { box { from = <-12, 0, -6>  to = <4, 3, 9>  " LAMP
         " } box { from = <-3, 0, -7>  to = <14, 4, 5>  " LAMP " }  translate(<0, 14, 0>) }"},
        {"the same in two colours",
         "union { box { from = <-12, 0, -6>  to = <4, 3, 9>  " LAMP
         " } box { from = <-3, 0, -7>  to = <14, 4, 5>  " DARK " }  translate(<0, 14, 0>) }"},
        {"a lens of two balls, mirrored and aslant",
         "group { intersection { sphere { center = <9, 0, 0>  radius = 14 } sphere { center = <-9, 0, 0>  radius = 16 "
         "} " LAMP " }  rotate(z, 70deg)  scale(<1.2, -1, .8>)  translate(<-3, 15, 0>) }"},
        {"a tube of triangles with a slot",
         "difference { prism { outline = [for (i in 0..<12) <9 * cos(30 * i), 9 * sin(30 * i)>]  from = 0  to = 20 "
         " " DARK " }\n"
         "  prism { outline = [for (i in 0..<12) <7 * cos(30 * i), 7 * sin(30 * i)>]  from = 0  to = 40  " LAMP
         "  translate(<0, -5, 0>) }\n  box { from = <-20, -30, -4>  to = <20, 30, 4>  " DARK
         " }  rotate(x, 40deg)  translate(<0, 20, 0>) }"},
        {"above, a tube of triangles, which sees itself aslant",
         "difference { prism { outline = [for (i in 0..<12) <9 * cos(30 * i), 9 * sin(30 * i)>]  from = 0  to = 20 "
         " " DARK
         " }\n  prism { outline = [for (i in 0..<12) <7 * cos(30 * i), 7 * sin(30 * i)>]  from = -5  to = 35  " LAMP
         " }  translate(<0, 10, 0>) }"},
        {"within a tube of triangles",
         "difference { box { from = <-20, -9, -20>  to = <20, 60, 20>  " DARK
         " }\n  prism { outline = [for (i in 0..<12) <9 * cos(30 * i), 9 * sin(30 * i)>]  from = -5  to = 50  " LAMP
         " } }"},
        {"parts of parts",
         "difference { union { sphere { radius = 8 } box { from = <-14, -3, -3>  to = <14, 3, 3> } }\n"
         "  difference { cylinder { from = <0, -9, 0>  to = <0, 9, 0>  radius = 5  " DARK
         " } sphere { radius = 4 } }\n  plane { normal = <1, 1, 0>  distance = -9 } " LAMP
         "  rotate(y, 20deg)  translate(<2, 16, 0>) }"},
        {"from within",
         "difference { box { from = <-60, -9, -60>  to = <60, 60, 60>  " DARK " } sphere { center = <5, 8, 2>  "
         "radius = 30  " LAMP " } }"},
        {"flush with a wall",
         "union { box { from = <-8, 12, -6>  to = <8, 20, 6> } cylinder { from = <0, 15, 0>  to = <0, 20, 0>  radius = "
         "11 } " LAMP " } box { from = <-30, 20, -30>  to = <30, 22, 30>  " DARK " }"},
        {"behind a pane", "union { sphere { radius = 9 } sphere { center = <8, 0, 0>  radius = 6 } " LAMP
                          "  translate(<0, 20, 0>) } box { from = <-60, 4, -60>  to = <60, 4.5, 60>  surface = pane }"},
        {"in fog", "union { sphere { radius = 7 } torus { radius = 8  tube = 3 } " LAMP "  translate(<3, 16, 0>) }\n"
                   "medium fog { ior = 1  absorption = .004 / 1mm  scattering = .03 / 1mm }\n"
                   "box { interior = fog  from = <-40, -1, -40>  to = <40, 30, 40> }"},
        {"partly in water",
         "union { sphere { radius = 7 } cylinder { from = <0, 0, 0>  to = <9, 4, 0>  radius = 4 } " LAMP
         "  translate(<3, 14, 0>) }\n"
         "medium water { ior = 1.33  absorption = .01 / 1mm }  box { interior = water  from = <-40, -1, -40>  to = "
         "<40, "
         "15, 40> }"},
        {"that moves", "difference { sphere { radius = 12 } box { from = <-20, -2, -20>  to = <20, 20, 20>  "
                       "translate(<0, 4 * clock, 0>) } " LAMP "  translate(<4 - 90 * clock, 18, 2>) }\n"
                       "animation { frames = 10 }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1800];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm  ground { surface = surface { albedo = .8 } }\n"
                 "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg  shutter = 180 }\n"
                 "surface lamp { albedo = .3  emission = 1  radiance = 2 }  surface dark { albedo = .2 }\n"
                 "surface pane { thin = true  transmission = 1  ior = 1.5  roughness = 0 }\n"
                 "%s\n",
                 cases[i].lamp);
        truth_found_alike(cases[i].what, text, 4096, 0.006);
    }
}

/* ---- textures that shine ---- */

/* Bright in a small part of the surface, which is found by where that is. */
static void textures(void **state)
{
    (void)state;
    static const struct {
        const char *what, *lamp;
    } cases[] = {
        {"a ball with a bright cap", "sphere { radius = 12  surface = spots  translate(<4, 18, 2>) }"},
        {"a box with bright places", "box { from = <-12, 12, -6>  to = <10, 15, 9>  surface = spots }"},
        {"a ring with bright places, stretched",
         "torus { radius = 10  tube = 4  surface = spots  scale(<1, .5, 1.3>)  translate(<2, 14, 2>) }"},
        {"a sheet", "mesh { positions = [<-20, 15, -20>, <20, 15, -20>, <20, 18, 20>, <-20, 18, 20>]\n"
                    "  triangles = [<0, 1, 2>, <0, 2, 3>]  surface = spots }"},
        {"a bowl with bright places inside",
         "difference { sphere { radius = 14 } sphere { radius = 12  surface = spots } box { from = <-20, -20, -20>  "
         "to = <20, 0, 20> }\n  surface = surface { albedo = .2 }  translate(<3, 10, 0>) }"},
        {"a mesh of many triangles", "isosurface { function = f  from = <-11, -11, -11>  to = <11, 11, 11>  surface = "
                                     "spots  translate(<2, 18, 0>) }\n"
                                     "def f(p) = length(p) - 10"},
        {"in fog", "sphere { radius = 9  surface = spots  translate(<3, 16, 0>) }\n"
                   "medium fog { ior = 1  absorption = .004 / 1mm  scattering = .03 / 1mm }\n"
                   "box { interior = fog  from = <-40, -1, -40>  to = <40, 30, 40> }"},
        {"that moves", "cylinder { from = <0, -3, 0>  to = <0, 3, 0>  radius = 12  surface = spots\n"
                       "  rotate(y, 90 * clock)  translate(<4 - 90 * clock, 18, 2>) }  animation { frames = 10 }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1800];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm  ground { surface = surface { albedo = .8 } }\n"
                 "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg  shutter = 180 }\n"
                 "def place(p) = sin(40deg * p.x + 3) * sin(30deg * p.z + 10deg * p.y) > .6 ? 4 : .02\n"
                 "surface spots { albedo = .3  emission = place  radiance = 2 }\n%s\n",
                 cases[i].lamp);
        truth_found_alike(cases[i].what, text, 4096, 0.008);
    }
}

/* A ball of leaf that shines, alone: within, all of the light comes of the ball itself. What its outer side shows is 1, and of the
 * light within, 1 / (1 - .4), the part .4. A look from a place of the ball to the ball counted that once more, by 9 %. */
static void thin_balls_light_themselves_once(void **state)
{
    (void)state;
    static const char *const places[] = {"<0, 0, 0>", "<1300, 0, -700>"};
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        char text[600];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit cm  let place = %s  sphere { center = place  radius = 1  surface = surface { thin "
                 "= true  "
                 "albedo = .8  translucency = .5  emission = 1 } }\n"
                 "camera { from = place + <0, 0, 6>  to = place  fov = 12deg }\n",
                 places[i]);
        truth_expect(places[i], 1 / (1 - 0.4), truth_measure(text, NULL, 1024, false), 4, 0.002);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(combinations), cmocka_unit_test(textures),
                                       cmocka_unit_test(thin_balls_light_themselves_once)};
    return cmocka_run_group_tests_name("surfaces that shine", tests, NULL, NULL);
}
