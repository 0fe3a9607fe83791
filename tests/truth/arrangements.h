/* arrangements.h - nested and overlapped volumes in compact form, for the tests that must hold for every arrangement.
 * Sources: [WR19] figures 11-1 to 11-5, [SB02] figures 1 and 3, and cameras in awkward places. `fit` is how far
 * neighbours reach into each other: 0.1 overlaps them, 0 makes their faces coincide, -0.1 leaves gaps of air.
 * All media absorb; a furnace is rendered with absorption off. No opaque object, no light: those are the test's.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_ARRANGEMENTS_H
#define MEN_ARRANGEMENTS_H

#include <stdbool.h>

typedef struct Arrangement {
    const char *name, *text;
    bool fits; /* looks at `fit` */
} Arrangement;

#define ARRANGEMENT_MEDIA                                                                                              \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass  { ior = 1.50  absorption = .004 / 1mm  state = solid  priority = 40 }\n"                            \
    "medium ice    { ior = 1.31  absorption = .002 / 1mm  state = solid  priority = 30 }\n"                            \
    "medium gas    { ior = 1.00  absorption = .0001 / 1mm state = gas    priority = 20 }\n"                            \
    "medium whisky { ior = 1.36  absorption = .020 / 1mm  state = liquid priority = 10 }\n"                            \
    "medium water  { ior = 1.33  absorption = .003 / 1mm  state = liquid priority = 10 }\n"                            \
    "medium flint  { ior = cauchy(1.60, .008)             state = solid  priority = 50 }\n"

/* Without priorities, so that only the automatic order's own rules decide. */
#define ARRANGEMENT_MEDIA_PLAIN                                                                                        \
    "meniscus 1.0 unit mm\n"                                                                                           \
    "medium glass  { ior = 1.50  absorption = .004 / 1mm  state = solid }\n"                                           \
    "medium ice    { ior = 1.31  absorption = .002 / 1mm  state = solid }\n"                                           \
    "medium gas    { ior = 1.00  absorption = .0001 / 1mm state = gas }\n"                                             \
    "medium whisky { ior = 1.36  absorption = .020 / 1mm  state = liquid }\n"                                          \
    "medium water  { ior = 1.33  absorption = .003 / 1mm  state = liquid }\n"

#define ARRANGEMENT_FIT "param fit = .1 in -1..1\n"

static const Arrangement arrangements[] = {
    {"whisky on the rocks",
     ARRANGEMENT_MEDIA_PLAIN ARRANGEMENT_FIT
     "lathe tumbler { interior = glass\n"
     "  profile = [<0, 0>, <38, 0>, <40, 2>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] }\n"
     "cylinder drink { interior = whisky  from = <0, 10 - fit, 0>  to = <0, 44, 0>  radius = 37 + fit }\n"
     "let cube = box { size = <24, 24, 24>  bevel = 2  bevel_segments = 2  interior = ice }\n"
     "for (p in [<-14, 38, 8>, <14, 40, -10>, <2, 46, 17>]) {\n"
     "  cube { rotate(y, 360 * rnd(1, p.x))  rotate(x, 25 * rnd(2, p.x))  translate(p) } }\n"
     "for (i in 1..40) { let a = 360deg * rnd(7, i, 0)  let d = 35 * sqrt(rnd(7, i, 1))\n"
     "  sphere { interior = gas  radius = mix(.4, 2, rnd(7, i, 2))\n"
     "           center = <d * cos(a), 12 + 28 * rnd(7, i, 3), d * sin(a)> } }\n"
     "camera { from = <0, 120, -260>  to = <0, 40, 0>  fov = 22deg }\n",
     true},
    {"round solids in each other",
     ARRANGEMENT_MEDIA_PLAIN
     "torus ring { interior = glass  radius = 30  tube = 12 }\n"
     "torus hollow { interior = gas  radius = 30  tube = 8 }\n"
     "torus core { interior = water  radius = 30.5  tube = 5  rotate(x, 4) }\n"
     "torus knot { interior = ice  radius = 11  tube = 4  rotate(z, 80)  translate(<30, 0, 0>) }\n"
     "torus apple { interior = ice  radius = 5  tube = 9  rotate(<20, 0, 30>) }\n"
     "capsule pill { interior = whisky  from = <-40, -3, 2>  to = <25, 6, -1>  radius = 7 }\n"
     "capsule seed { interior = gas  from = <-30, -1, 2>  to = <10, 4, 0>  radius = 4 }\n"
     "ellipsoid drop { interior = water  center = <0, 8, 20>  radii = <30, 6, 9>  rotate(y, 25) }\n"
     "cylinder rod { interior = glass  from = <-5, -25, -15>  to = <9, 25, -20>  radius = 6  rounding = 2 }\n"
     "cone bung { interior = glass  from = <18, -22, 10>  to = <18, 14, 14>  radius_from = 9  radius_to = 4  rounding "
     "= 3 }\n"
     "lathe vase { interior = ice  curve = cubic  corners = [1]  translate(<-22, -20, 8>)\n"
     "  profile = [<0, 0>, <8, 0>, <9, 1>, <3, 6>, <10, 16>, <6, 30>, <8, 38>, <7, 38>, <5, 30>, <9, 16>, <0, 8>] }\n"
     "camera { from = <40, 90, -150>  to = <0, 0, 0>  fov = 34deg }\n",
     false},
    {"aquarium",
     ARRANGEMENT_MEDIA_PLAIN ARRANGEMENT_FIT
     "medium stone_glass { ior = 1.62  state = solid }\n"
     "def pane(a, b) { box { from = a  to = b  interior = glass } }\n"
     "pane(<-51, -1, -26>, <51, 0, 26>)\n"
     "for (s in [-1, 1]) { pane(<50.5 * s - .5, -fit, -26>, <50.5 * s + .5, 45, 26>)\n"
     "                     pane(<-50 - fit, -fit, 25.5 * s - .5>, <50 + fit, 45, 25.5 * s + .5>) }\n"
     "box body { interior = water  from = <-50 - fit, -fit, -25 - fit>  to = <50 + fit, 40, 25 + fit> }\n"
     "box stone { interior = stone_glass  size = <16, 9, 12>  bevel = 2  rotate(<10, 30, 5>)  translate(<15, 6, 4>) }\n"
     "for (i in 1..40) { sphere { interior = gas  radius = mix(.4, 1.6, rnd(5, i, 0))\n"
     "  center = <-45 + 90 * rnd(5, i, 1), 2 + 37 * rnd(5, i, 2), -22 + 44 * rnd(5, i, 3)> } }\n"
     "camera { from = <-70, 75, -150>  to = <0, 18, 0>  fov = 34deg }\n",
     true},
    {"neighbours in three schemes", /* [WR19] fig. 11-1: a gap, faces that coincide, an overlap; each with nested balls */
     ARRANGEMENT_MEDIA_PLAIN "for (k in 0..2) { group { translate(<40 * k - 40, 0, 0>)  let reach = [-.5, 0, 1.5][k]\n"
                             "  box { interior = glass  from = <-12, -14, -12>  to = <12, 0, 12> }\n"
                             "  box { interior = water  from = <-12, -reach, -12>  to = <12, 14, 12> }\n"
                             "  sphere { interior = gas  center = <-4, -6, 0>  radius = 3 }\n"
                             "  sphere { interior = ice  center = <5, 7, 0>  radius = 4 }\n"
                             "  sphere { interior = gas  center = <5, 7, 0>  radius = 2 }\n"
                             "  sphere { interior = ice  center = <0, 0, -5>  radius = 3 } } }\n"
                             "camera { from = <30, 60, -160>  to = <0, 0, 0>  fov = 42deg }\n",
     false},
    {"combinations", /* a tumbler that is a difference, a drink that overlaps it, a lens, a pierced cube in a drop */
     ARRANGEMENT_MEDIA_PLAIN ARRANGEMENT_FIT
     "difference tumbler { interior = glass\n"
     "  cylinder { to = <0, 60, 0>  radius = 30 }\n"
     "  cylinder { from = <0, 6, 0>  to = <0, 70, 0>  radius = 27 }\n"
     "  sphere { center = <30, 40, 0>  radius = 12 } }\n"
     "cylinder drink { interior = whisky  from = <0, 6 - fit, 0>  to = <0, 25, 0>  radius = 27 + fit }\n"
     "intersection { interior = ice  for (s in [-1, 1]) { sphere { center = <0, 0, 9 * s>  radius = 16 } }\n"
     "  rotate(y, 25)  translate(<-4, 26, 2>) }\n"
     "sphere drop { interior = water  center = <-60, 25, 0>  radius = 22 }\n"
     "difference { interior = glass  box { size = <20, 20, 20> }\n"
     "  union { cylinder { from = <-20, 0, 0>  to = <20, 0, 0>  radius = 6 }  cylinder { from = <0, -20, 0>  to = <0, "
     "20, 0>  radius = 7 }\n"
     "          difference { sphere { center = <10, 10, 10>  radius = 9 }  box { from = <8, 0, 0>  to = <30, 30, 30> } "
     "} }\n"
     "  rotate(<20, 30, 0>)  translate(<-60, 25, 0>) }\n"
     "sphere { interior = gas  center = <3, 12, 8>  radius = 4 }\n"
     "camera { from = <-30, 110, -230>  to = <-20, 26, 0>  fov = 36deg }\n",
     true},
    {"a sea without end", /* and what floats in it, with a dome cut from a ball */
     ARRANGEMENT_MEDIA_PLAIN
     "plane { interior = water }\n"
     "sphere { interior = glass  center = <-20, 0, 0>  radius = 10 }\n"
     "sphere { interior = gas  center = <20, -3, 10>  radius = 8 }\n"
     "intersection { interior = ice  sphere { center = <0, 12, -10>  radius = 14 }\n"
     "  plane { normal = <0, 1, .3>  distance = 13 }  plane { normal = <0, -1, 0>  distance = 2 } }\n"
     "camera { from = <0, 12, 90>  to = <0, 0, 0>  fov = 40deg }\n",
     false},
    {"three overlapping spheres", /* [SB02] fig. 1, with indices that show */
     ARRANGEMENT_MEDIA "sphere { interior = water  center = <-5, 0, 0>  radius = 10 }\n"
                       "sphere { interior = glass  center = <5, 0, 2>  radius = 10 }\n"
                       "sphere { interior = flint  center = <0, 7, -3>  radius = 10 }\n"
                       "camera { from = <0, 20, -60>  to = <0, 2, 0>  fov = 32deg }\n",
     false},
    {"glass of water, by priorities", /* [SB02] fig. 3: glass over ice over bubbles over water */
     ARRANGEMENT_MEDIA ARRANGEMENT_FIT
     "lathe tumbler { interior = glass\n"
     "  profile = [<0, 0>, <25, 0>, <32, 80>, <30, 80>, <23.5, 6>, <0, 6>]  rounding = [0, 2, .8, .8, 3, 0] }\n"
     "cone drink { interior = water  from = <0, 6 - fit, 0>  to = <0, 60, 0>  radius_from = 23.5 + fit\n"
     "  radius_to = 23.5 + 54 * 6.5 / 74 + fit }\n"
     "box cube { interior = ice  size = <20, 20, 20>  bevel = 1  rotate(<20, 30, 10>)  translate(<3, 56, 2>) }\n"
     "for (i in 1..30) { let a = 360deg * rnd(3, i, 0)  let d = 25 * sqrt(rnd(3, i, 1))\n"
     "  sphere { interior = gas  radius = mix(.5, 3, rnd(3, i, 2))\n"
     "           center = <d * cos(a), 8 + 50 * rnd(3, i, 3), d * sin(a)> } }\n"
     "camera { from = <0, 110, -190>  to = <0, 38, 0>  fov = 26deg }\n",
     true},
    {"one mesh of parts that overlap",
     ARRANGEMENT_MEDIA_PLAIN
     "mesh { interior = glass  scale(5)  translate(<-16, -16, -16>)\n"
     "  positions = [<0, 0, 0>, <9, 0, 0>, <0, 9, 0>, <0, 0, 9>, <1, 1, 1>, <9, 2, 2>, <2, 9, 2>, <2, 2, 9>]\n"
     "  triangles = [<0, 2, 1>, <0, 1, 3>, <1, 2, 3>, <0, 3, 2>, <4, 6, 5>, <4, 5, 7>, <5, 6, 7>, <4, 7, 6>] }\n"
     "sphere { interior = water  radius = 12 }\n"
     "sphere { interior = gas  radius = 5 }\n"
     "camera { from = <60, 50, 90>  to = <0, 0, 0>  fov = 30deg }\n",
     false},
    {"camera in the water",
     ARRANGEMENT_MEDIA ARRANGEMENT_FIT
     "cylinder pool { interior = water  from = <0, 0, 0>  to = <0, 60, 0>  radius = 50 }\n"
     "cylinder rod { interior = glass  from = <10, -20, 40>  to = <14, 80, 44>  radius = 3 }\n"
     "for (i in 1..30) { sphere { interior = gas  radius = mix(.5, 2, rnd(5, i, 0))\n"
     "  center = <-20 + 40 * rnd(5, i, 1), 5 + 70 * rnd(5, i, 2), 20 + 25 * rnd(5, i, 3)> } }\n"
     "camera { from = <0, 30, -10>  to = <0, 34, 30>  fov = 50deg  expect = [water] }\n",
     false},
    {"camera in an overlap",
     ARRANGEMENT_MEDIA "sphere { interior = water  center = <0, 0, 0>  radius = 30 }\n"
                       "sphere { interior = glass  center = <0, 0, 25>  radius = 30 }\n"
                       "sphere { interior = ice    center = <10, 0, 15>  radius = 8 }\n"
                       "camera { from = <1, 2, 8>  to = <2, 3, 40>  fov = 40deg }\n",
     false},
    {"lens across a water surface",
     ARRANGEMENT_MEDIA "cylinder pool { interior = water  from = <0, -40, 0>  to = <0, 0, 0>  radius = 60 }\n"
                       "sphere { interior = ice  center = <3, -1, 30>  radius = 9 }\n"
                       "sphere { interior = gas  center = <-8, -6, 25>  radius = 4 }\n"
                       "camera { from = <0, .2, 0>  to = <0, -1, 30>  fov = 40deg  aperture = 2 }\n",
     false},
};

static const char *const arrangement_fits[] = {"fit=.1", "fit=0", "fit=-.1"};

#endif
