/* light_test.c - everything that shines against closed forms: surfaces of solids and meshes, lights without size, lights
 * in glass and water; and the two ways to find a light, by looking for it and by chance, against each other.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

static const double degree = TRUTH_PI / 180;

#define FLOOR                                                                                                          \
    "meniscus 1.0 unit mm ground { surface = surface { albedo = .8 } }\n"                                              \
    "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg }\n"
#define GLOW "surface = surface { albedo = 0  emission = 1  radiance = 2 }"

/* What a floor of albedo 0.8 looks like under an irradiance. */
static double on_floor(double irradiance)
{
    return 0.8 / TRUTH_PI * irradiance;
}

/* ---- surfaces that shine ---- */

/* J. R. Howell, A Catalog of Radiation Heat Transfer Configuration Factors: see radiometry_test.c. */
static double rectangle_factor(double a, double b, double h)
{
    double x = a / 2 / h, y = b / 2 / h, u = sqrt(1 + x * x), v = sqrt(1 + y * y);
    return 4 / (2 * TRUTH_PI) * (x / u * atan(y / u) + y / v * atan(x / v));
}

static void surfaces_on_a_floor(void **state)
{
    (void)state;
    const double l = 2;
    const struct {
        const char *what, *object;
        double irradiance;
    } cases[] = {
        {"ball above: pi L (r/d)^2", "sphere { center = <0, 30, 0>  radius = 10 " GLOW " }", TRUTH_PI * l / 9},
        {"ball, scaled and mirrored", "sphere { radius = 2  scale(<-5, 5, 5>)  translate(<0, 30, 0>) " GLOW " }",
         TRUTH_PI * l / 9},
        {"lower end of a cylinder: pi L r^2 / (r^2 + h^2)",
         "cylinder { from = <0, 20, 0>  to = <0, 60, 0>  radius = 15 " GLOW " }", TRUTH_PI * l * 225 / 625},
        {"the same, mirrored",
         "cylinder { from = <0, -20, 0>  to = <0, -60, 0>  radius = 15 scale(<1, -1, 1>) " GLOW " }",
         TRUTH_PI * l * 225 / 625},
        {"a box: its lower face", "box { from = <-15, 20, -6>  to = <15, 50, 6> " GLOW " }",
         TRUTH_PI * l * rectangle_factor(30, 12, 20)},
        {"a sheet of two triangles, from below",
         "mesh { positions = [<-15, 20, -6>, <15, 20, -6>, <15, 20, 6>, <-15, 20, 6>]  triangles = [<0, 1, 2>, <0, 2, "
         "3>] " GLOW " }",
         TRUTH_PI * l * rectangle_factor(30, 12, 20)},
        {"the same, its other side",
         "mesh { positions = [<-15, 20, -6>, <15, 20, -6>, <15, 20, 6>, <-15, 20, 6>]  triangles = [<2, 1, 0>, <3, 2, "
         "0>] " GLOW " }",
         TRUTH_PI * l * rectangle_factor(30, 12, 20)},
        {"two instances of a stretched box",
         "let b = box { from = <-5, 0, -3>  to = <5, 10, 3> " GLOW " }\n"
         "b { scale(<3, 1, 2>)  translate(<0, 20, 0>) } b { scale(<-3, 2, 2>)  translate(<0, 20, 500>) }",
         TRUTH_PI * l * rectangle_factor(30, 12, 20)},
        {"half of space above: pi L", "plane { normal = <0, -1, 0>  distance = -10 " GLOW " }", TRUTH_PI * l},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000], what[120];
        snprintf(text, sizeof text, FLOOR "%s\n", cases[i].object);
        truth_expect(cases[i].what, on_floor(cases[i].irradiance), truth_measure(text, NULL, 1024, false), 4, 0.004);
        snprintf(what, sizeof what, "%s, found by chance", cases[i].what);
        truth_expect(what, on_floor(cases[i].irradiance), truth_measure(text, NULL, 4096, true), 4, 0.01);
    }
}

/* Shapes without a simple closed form, with concave parts that hide each other: the two ways to find them agree. */
static void looked_for_or_by_chance(void **state)
{
    (void)state;
    static const struct {
        const char *what, *object;
    } cases[] = {
        {"ring",
         "torus { center = <3, 14, 0>  radius = 8  tube = 3  rotate(x, 70deg)  translate(<0, 14, -4>) " GLOW " }"},
        {"ring without a hole", "torus { center = <3, 14, 0>  radius = 2  tube = 4 " GLOW " }"},
        {"ellipsoid", "ellipsoid { center = <5, 18, 3>  radii = <12, 3, 6>  rotate(z, 30deg) " GLOW " }"},
        {"capsule", "capsule { from = <-10, 12, 4>  to = <12, 20, -3>  radius = 3 " GLOW " }"},
        {"cone, leaning",
         "cone { from = <0, 9, 0>  to = <4, 25, 4>  radius_from = 8  radius_to = 2  scale(<1, 1, .4>) " GLOW " }"},
        {"bowl, turned over",
         "lathe { profile = [<0, 20>, <12, 12>, <11, 10>, <0, 17>]  rounding = [0, .5, .4, 0] " GLOW " }"},
        {"coil", "sweep { outline = [for (i in 0..<8) <1.5 * cos(45 * i), 1.5 * sin(45 * i)>]\n"
                 "path = [for (i in 0..24) <7 * cos(30 * i), 10 + .5 * i, 7 * sin(30 * i)>] " GLOW " }"},
        {"what is left of a ball",
         "difference { " GLOW
         " sphere { center = <0, 15, 0>  radius = 9 } box { from = <-20, 5, -20>  to = <20, 9, 20> } }"},
        {"a floor that shines as well",
         "box { from = <-5, 9, -5>  to = <5, 12, 9>  rotate(y, 20deg)\n"
         "surface = surface { albedo = .7  emission = rgb(1, .6, .3)  radiance = 4 } }"
         "box { from = <-30, -1, -30>  to = <30, .5, -2>  surface = surface { albedo = .5  emission = .1 } }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "%s\n", cases[i].object);
        Estimate sampled = truth_measure(text, NULL, 1024, false), chance = truth_measure(text, NULL, 8192, true);
        truth_check(cases[i].what, sampled.mean, sampled, 4, 0.006);
        truth_alike(cases[i].what, chance, sampled, 4, 0.02);
    }
}

/* ---- lights without size ---- */

static void point_and_spot(void **state)
{
    (void)state;
    const struct {
        const char *what, *light;
        double irradiance;
    } cases[] = {
        /* irradiance in watts per square metre: the scene is in millimetres */
        {"point of 3 W: power / (4 pi d^2) cos", "light { shape = point  from = <30, 40, 0>  power = 3 }",
         3 / (4 * TRUTH_PI * 50 * 50 * 1e-6) * 0.8},
        {"point by intensity", "light { shape = point  from = <0, 20, 0>  intensity = .5 }", 0.5 / (400e-6)},
        {"the same, scaled", "light { shape = point  from = <0, 2, 0>  intensity = .5  scale(10) }", 0.5 / (400e-6)},
        {"spot, within its cone",
         "light { shape = spot  from = <0, 20, 0>  to = <6, 0, 0>  angle = 60deg  intensity = 2 }", 2 / 400e-6},
        {"spot, beyond it", "light { shape = spot  from = <0, 20, 0>  to = <30, 0, 0>  angle = 60deg  intensity = 2 }",
         0},
        {"spot of 5 W without blend: power / solid angle",
         "light { shape = spot  from = <0, 20, 0>  to = <0, 0, 0>  angle = 40deg  blend = 0  power = 5 }",
         5 / (2 * TRUTH_PI * (1 - cos(20 * degree))) / 400e-6},
        /* half way, in the cosine, between full and none */
        {"spot, in its border",
         "light { shape = spot  from = <0, 20, 0>  to = <20 * tan(acos((1 + cos(30)) / 2)), 0, 0>  angle = 60deg  "
         "blend = 1"
         "  intensity = 2 }",
         1 / 400e-6},
        {"ten lights: the sum",
         "for (i in 1..10) { light { shape = point  from = <0, 10 * i, 0>  intensity = i * i } }", 10 / 100e-6},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "%s\n", cases[i].light);
        Estimate measured = truth_measure(text, NULL, 256, false);
        if (cases[i].irradiance > 0)
            truth_expect(cases[i].what, on_floor(cases[i].irradiance), measured, 4, 0.005);
        else
            assert_true(measured.mean == 0);
    }
}

/* tests/unit/lamp.ies: twice 683 candela straight down, that is 2 W/sr; at 45 degrees 2 towards x, 1 towards z, 0
 * towards -x; in between linear. The place is moved under the camera by moving the lamp. */
static void profile(void **state)
{
    (void)state;
    const struct {
        const char *what, *light;
        double irradiance;
    } cases[] = {
        {"straight below", "from = <0, 20, 0>", 2 / 400e-6},
        {"at 45 degrees in its plane of 0", "from = <-20, 20, 0>", 2 / 800e-6 * sqrt(0.5)},
        {"at 45 degrees in its plane of 90", "from = <0, 20, 20>", 1 / 800e-6 * sqrt(0.5)},
        {"the same on the other side", "from = <0, 20, -20>", 1 / 800e-6 * sqrt(0.5)},
        {"at 45 degrees between 0 and 90", "from = <-20 * sqrt(.5), 20, 20 * sqrt(.5)>", 1.5 / 800e-6 * sqrt(0.5)},
        {"at 45 degrees in its plane of 180", "from = <20, 20, 0>", 0},
        {"aimed, by a factor", "from = <-20, 20, 0>  to = <0, 0, 0>  intensity = 3", 6 / 800e-6 * sqrt(0.5)},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, FLOOR "light { shape = point  profile = \"tests/unit/lamp.ies\"  %s }\n",
                 cases[i].light);
        Estimate measured = truth_measure(text, NULL, 256, false);
        if (cases[i].irradiance > 0)
            truth_expect(cases[i].what, on_floor(cases[i].irradiance), measured, 4, 0.005);
        else
            assert_true(measured.mean < 0.1); /* as near as rounding comes to it */
    }
    /* by power: all directions together */
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = FLOOR
                                    "light { shape = point  profile = \"tests/unit/lamp.ies\"  from = y  power = 7 }\n",
                                    .policy = NEST_AUTOMATIC});
    const SceneLight *light = &scene.scene->lights[0];
    double unit2 = scene.scene->unit_m * scene.scene->unit_m, scale = spectrum_luminance(&light->radiance) * unit2,
           flux = 0;
    enum { N = 400 };
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double y = 1 - (2 * i + 1.0) / N, r = sqrt(1 - y * y), a = 2 * TRUTH_PI * (k + 0.5) / N;
            flux += (double)light_shape(light, vec3(r * cos(a), y, r * sin(a))) * scale * 4 * TRUTH_PI / (N * N);
        }
    truth_figure("flux of a lamp of 7 W", 7, flux, 0);
    assert_near(flux, 7, 0.01);
    fixture_clear(&scene);
}

/* What a mirrored group shows is the mirror image: of a lamp that is another one to each side, and of brushed metal. The camera looks
 * at what is in the mirror's plane, and is in it or sees something matte. */
static void mirror_images(void **state)
{
    (void)state;
    static const struct {
        const char *what, *begin, *objects, *mirror;
    } cases[] = {
        {"a lopsided lamp, mirrored", FLOOR,
         "light { shape = point  profile = \"tests/unit/lopsided.ies\"  from = <0, 20, -20> }", "scale(<1, 1, -1>)"},
        {"the same, the other way", FLOOR,
         "light { shape = point  profile = \"tests/unit/lopsided.ies\"  from = <-20, 20, 5> }", "scale(<-1, 1, 1>)"},
        {"grain that is turned, mirrored",
         "meniscus 1.0 unit mm camera { from = <0, 1, 1>  to = <0, 0, 0>  fov = .01deg }\n",
         "plane { surface = surface { metal = silver  roughness = .3  anisotropy = .9  grain = x  grain_angle = 30 } "
         "}\n"
         "light { shape = disc  from = <.8, 1, -1>  to = <0, 0, 0>  radius = .2  radiance = 500 }",
         "scale(<-1, 1, 1>)"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Estimate seen[2];
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            char text[1000];
            snprintf(text, sizeof text, "%sgroup { %s  %s }\n", cases[i].begin, cases[i].objects,
                     mirrored ? cases[i].mirror : "");
            seen[mirrored] = truth_measure(text, NULL, 1024, false);
        }
        truth_alike(cases[i].what, seen[1], seen[0], 4, 0.005);
    }
}

/* A pixel looks down a ray of white fog of albedo 1 so thin that it scatters once: sigma / (4 pi) times the integral of
 * I / d^2 along the ray, which for a light at distance h from it is sigma I / (4 pi h) times the angle seen from the
 * light. */
static void point_in_fog(void **state)
{
    (void)state;
    const double sigma = 1e-6, h = 20, half = 100;
    Estimate measured = truth_measure("meniscus 1.0 unit mm\n"
                                      "medium fog { ior = 1  scattering = 1e-6 / 1mm }\n"
                                      "box { interior = fog  from = <-300, -300, -100>  to = <300, 300, 100> }\n"
                                      "light { shape = point  from = <0, 20, 0>  intensity = 1 }\n"
                                      "camera { from = <0, 0, 400>  to = <0, 0, 0>  fov = .01deg }\n",
                                      NULL, 65536, false);
    double expected = sigma * 1e6 / (4 * TRUTH_PI * h) * 2 * atan(half / h);
    truth_figure("point in thin fog", expected, measured.mean, measured.error);
    assert_near(measured.mean, expected, 4 * measured.error + 1e-3 * expected);
}

/* ---- the sky ---- */

static void floor_under_a_sky(void **state)
{
    (void)state;
    const char *sky = "environment { sky = clear  elevation = 35deg  azimuth = 70deg  disc = false }\n";
    const char *sun = "environment { sky = clear  elevation = 35deg  azimuth = 70deg }\n";
    /* the sun is where it is said to be: a wall on that side casts its shadow */
    const char *shade =
        "box { from = <500, 0, -900>  to = <501, 2000, 900>  rotate(y, -20deg)  surface = surface { albedo = 0 } }\n";
    char text[1000];
    snprintf(text, sizeof text, FLOOR "%s", sky);
    Estimate sampled = truth_measure(text, NULL, 1024, false), chance = truth_measure(text, NULL, 4096, true);
    truth_alike("floor under a sky, looked for and by chance", chance, sampled, 4, 0.02);
    snprintf(text, sizeof text, FLOOR "%s", sun);
    Estimate lit = truth_measure(text, NULL, 1024, false);
    snprintf(text, sizeof text, FLOOR "%s%s", sun, shade);
    Estimate shaded = truth_measure(text, NULL, 1024, false);
    print_message("      sky %.4f, with the sun %.4f, in the shade %.4f\n", sampled.mean, lit.mean, shaded.mean);
    assert_true(lit.mean > 3 * sampled.mean && shaded.mean < sampled.mean);
}

/* ---- portals ---- */

#define CEILING                                                                                                        \
    "let black = surface { albedo = 0 }\n"                                                                             \
    "def piece(a, b) { mesh { positions = [<a.x, 20, a.y>, <b.x, 20, a.y>, <b.x, 20, b.y>, <a.x, 20, b.y>]\n"          \
    "  triangles = [<0, 1, 2>, <0, 2, 3>]  surface = black } }\n"                                                      \
    "piece(<-500, -500>, <-15, 500>) piece(<15, -500>, <500, 500>) piece(<-15, -500>, <15, -6>)\n"                     \
    "piece(<-15, 6>, <15, 500>) let side = box { from = <-501, 0, 499>  to = <501, 21, 501>  surface = black }\n"      \
    "for (i in 0..3) { side { rotate(y, 90deg * i) } }\n"
#define PORTAL(from, to, size) "light { shape = portal  from = " from "  to = " to "  size = " size " }\n"

/* A black room with a rectangular hole in its ceiling under a white sky: the floor has what a rectangle of that radiance
 * would give it, wherever portals are. */
static void portals(void **state)
{
    (void)state;
    static const struct {
        const char *what, *portals;
    } cases[] = {
        {"a hole in the ceiling, no portal", ""},
        {"a portal in it", PORTAL("<0, 20, 0>", "<0, 0, 0>", "<30, 12>")},
        {"two, one of them smaller, that overlap",
         PORTAL("<0, 20, 0>", "<0, 0, 0>", "<30, 12>") PORTAL("<5, 20, 1>", "<5, 0, 1>", "<9, 9>")},
        {"half of it", PORTAL("<-7.5, 20, 0>", "<-7.5, 0, 0>", "<15, 12>")},
        {"one that is larger", PORTAL("<0, 20, 0>", "<0, 0, 0>", "<50, 40>")},
        {"one that faces out", PORTAL("<0, 20, 0>", "<0, 40, 0>", "<30, 12>")},
        {"where there is no hole", PORTAL("<60, 20, 0>", "<60, 0, 0>", "<30, 12>")},
        {"aslant below it, and another in a wall that is not there",
         PORTAL("<3, 14, 0>", "<0, 0, 1>", "<20, 12>") PORTAL("<40, 10, 0>", "<0, 10, 0>", "<20, 20>")},
    };
    Estimate first = {0};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2000];
        snprintf(text, sizeof text, FLOOR CEILING TRUTH_WHITE_SKY "%s", cases[i].portals);
        Estimate measured = truth_measure(text, NULL, 512, false);
        if (i == 0) first = measured;
        truth_expect(cases[i].what, on_floor(TRUTH_PI * rectangle_factor(30, 12, 20)), measured, 4, 0.002);
        double gain = pow(first.error / measured.error, 2);
        print_message("      as good as %.1f times as many samples without\n", gain);
        if (i == 1 || i == 2) assert_true(gain > 4);
    }
}

/* The same for a sky that is not even, looked for and by chance, and in a room whose walls throw light about. */
static void portals_in_a_room(void **state)
{
    (void)state;
    static const char *const skies[] = {
        "environment { sky = clear  elevation = 35deg  azimuth = 70deg  disc = false }\n", TRUTH_SKY};
    const char *room = "let wall = surface { albedo = .6 }\n"
                       "box { from = <-20, 0, -21>  to = <30, 20, -20>  surface = wall }\n"
                       "box { from = <-21, 0, -20>  to = <-20, 20, 20>  surface = wall }\n"
                       "box { from = <-21, 20, -21>  to = <31, 21, 21>  surface = wall }\n"
                       "box { from = <-20, 0, 20>  to = <30, 20, 21>  surface = wall }\n"
                       "box { from = <30, 0, -20>  to = <31, 8, 20>  surface = wall }\n"
                       "box { from = <30, 8, -20>  to = <31, 20, 4>  surface = wall }\n";
    for (size_t i = 0; i < COUNT_OF(skies); i++) {
        char text[2000];
        snprintf(text, sizeof text, FLOOR "%s%s", room, skies[i]);
        Estimate without = truth_measure(text, NULL, 512, false), chance = truth_measure(text, NULL, 2048, true);
        snprintf(text, sizeof text, FLOOR "%s%s" PORTAL("<30, 14, 12>", "<0, 14, 12>", "<16, 12>"), room, skies[i]);
        Estimate with = truth_measure(text, NULL, 512, false);
        truth_alike("a room with a portal and without", without, with, 4, 0.05);
        truth_alike("a room with a portal and by chance", chance, with, 4, 0.05);
        double gain = pow(without.error / with.error, 2);
        print_message("      as good as %.1f times as many samples without\n", gain);
        assert_true(gain > 1.5 && with.error < 0.015 * with.mean);
    }
}

/* ---- lights in other media ---- */

/* A picture shows basic radiance, L / n^2. In water everything is as in air, but for that. */
static void in_water(void **state)
{
    (void)state;
    static const struct {
        const char *what, *light;
        double irradiance;
    } cases[] = {
        {"ball in water", "sphere { center = <0, 30, 0>  radius = 10 " GLOW " }", TRUTH_PI * 2 / 9},
        {"point in water", "light { shape = point  from = <0, 20, 0>  intensity = .5 }", 0.5 / (400e-6)},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 FLOOR "medium water { ior = 1.33 }\n"
                       "sphere { interior = water  center = <3e5, 0, 0>  radius = 1e6 }\n%s\n",
                 cases[i].light);
        /* what comes back from the water's far surface, which is not concentric, is too little to be seen */
        truth_expect(cases[i].what, on_floor(cases[i].irradiance) / (1.33 * 1.33),
                     truth_measure(text, NULL, 1024, false), 4, 0.005);
    }
}

/* A wire in a bulb of glass around air: seen at right angles through both surfaces, each of which lets 1 - R pass, and
 * throws back some that comes again: T = (1 - R) / (1 + R) for the pair, as the wire is black. */
static void filament_in_a_bulb(void **state)
{
    (void)state;
    double r = truth_fresnel(1, 1, 1.5);
    const char *bulb = "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid }\n"
                       "sphere { interior = glass  radius = 20 } sphere { interior = air  radius = 19 }\n"
                       "sphere { radius = 2  surface = surface { albedo = 0  emission = 1  radiance = 5 } }\n"
                       "camera { from = <0, 0, 200>  to = <0, 0, 0>  fov = .01deg }\n";
    truth_expect("a glowing ball seen through a bulb", 5 * (1 - r) / (1 + r), truth_measure(bulb, NULL, 4096, false), 4,
                 0.005);
    const char *embedded = "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid }\n"
                           "sphere { interior = glass  radius = 20 }\n"
                           "sphere { radius = 2  surface = surface { albedo = 0  emission = 1  radiance = 5 } }\n"
                           "camera { from = <0, 0, 200>  to = <0, 0, 0>  fov = .01deg }\n";
    truth_expect("a glowing ball within glass", 5 / 2.25 * (1 - r), truth_measure(embedded, NULL, 4096, false), 4,
                 0.005);
}

/* ---- moving lights ---- */

/* Lights that move or turn. A ball that moves along a quarter of the way from 20 to 40 above the floor: the mean over the shutter of
 * pi L (r / d)^2, with the mean of 1 / d^2 over d = a .. b being 1 / (a b). */
static void moving_lights(void **state)
{
    (void)state;
    const char *frame =
        "animation { frames = 2 }\n"
        "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg  shutter = 360deg  shutter_steps = 1 }\n";
    const struct {
        const char *what, *light;
        double irradiance;
    } cases[] = {
        {"a ball that moves", "sphere { radius = 8  translate(<0, 20 + 20 * clock, 0>) " GLOW " }",
         TRUTH_PI * 2 * 64 / 800},
        {"a point that moves", "light { shape = point  from = <0, 20 + 20 * clock, 0>  intensity = 1 }", 1e6 / 800},
        {"a mesh that moves",
         "mesh { positions = [for (p in [<-1, 0, -1>, <1, 0, -1>, <1, 0, 1>, <-1, 0, 1>])\n"
         "p * .01 + <0, 20 + 20 * clock, 0>]  triangles = [<0, 1, 2>, <0, 2, 3>]\n"
         "surface = surface { albedo = 0  emission = 1  radiance = 1e4 } }",
         1e4 * 4e-4 / 800},
        /* Its axis goes from 45 degrees on one side to 45 on the other, straight in between as the two frames are: by
         * atan(2 t - 1). So the place below is within 30 degrees for tan(30) of the time. */
        {"a spot that turns, first away from the place",
         "light { shape = spot  from = <0, 20, 0>  to = <-20 + 40 * clock, 0, 0>  angle = 60deg  blend = 0  intensity "
         "= 2 "
         "}",
         2 / 400e-6 / sqrt(3)},
        /* Its area's part towards the place below is the same all the way, whatever is squeezed. */
        {"a disc that turns through the vertical",
         "light { shape = disc  from = <0, 200, 0>  to = <-200 + 400 * clock, 0, 0>  radius = .1  radiance = 1e4 }",
         1e4 * TRUTH_PI * .01 / 4e4 * sqrt(0.5)},
        {"a quad that turns through the vertical",
         "light { from = <0, 200, 0>  to = <-200 + 400 * clock, 0, 0>  size = <.3, .2>  radiance = 1e4 }",
         1e4 * .06 / 4e4 * sqrt(0.5)},
        /* From straight down to 45 degrees, and on to the side: of its area's part towards the place below, which is as long
         * as the middle axis of its frame is level, half is left of what goes, in the mean. */
        {"a quad that looks straight down at first, and turns to +x",
         "light { from = <0, 200, 0>  to = <200 * clock, 0, 0>  size = <.3, .2>  radiance = 1e4 }",
         1e4 * .06 / 4e4 * (1 + sqrt(0.5)) / 2},
        {"a quad that looks straight down at first, and turns to -z",
         "light { from = <0, 200, 0>  to = <0, 0, -200 * clock>  size = <.3, .2>  radiance = 1e4 }",
         1e4 * .06 / 4e4 * (1 + sqrt(0.5)) / 2},
        {"a disc that looks straight down at first, and turns to between -x and +z",
         "light { shape = disc  from = <0, 200, 0>  to = <-120 * clock, 0, 160 * clock>  radius = .1  radiance = 1e4 }",
         1e4 * TRUTH_PI * .01 / 4e4 * (1 + sqrt(0.5)) / 2},
        {"a disc that looks straight down at first, and to the side in the end",
         "light { shape = disc  from = <0, 200, 0>  to = <200 * clock, 200 * clock, 0>  radius = .1  radiance = 1e4 }",
         1e4 * TRUTH_PI * .01 / 4e4 / 2},
        {"a quad into a cone that moves along",
         "light { from = <20 * clock, 20, 0>  to = <20 * clock, 0, 0>  size = <90, 70>  angle = 40deg  blend = 0  "
         "radiance = 2 }",
         TRUTH_PI * 2 * pow(sin(TRUTH_PI / 9), 2)},
        {"a quad that looks straight down in the end",
         "light { from = <0, 200, 0>  to = <200 - 200 * clock, 0, 0>  size = <.3, .2>  radiance = 1e4 }",
         1e4 * .06 / 4e4 * (1 + sqrt(0.5)) / 2},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1000];
        snprintf(text, sizeof text, "meniscus 1.0 unit mm ground { surface = surface { albedo = .8 } }\n%s%s\n", frame,
                 cases[i].light);
        truth_expect(cases[i].what, on_floor(cases[i].irradiance), truth_measure(text, NULL, 4096, false), 4, 0.005);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_on_a_floor),
        cmocka_unit_test(looked_for_or_by_chance),
        cmocka_unit_test(point_and_spot),
        cmocka_unit_test(point_in_fog),
        cmocka_unit_test(in_water),
        cmocka_unit_test(filament_in_a_bulb),
        cmocka_unit_test(moving_lights),
        cmocka_unit_test(floor_under_a_sky),
        cmocka_unit_test(portals),
        cmocka_unit_test(portals_in_a_room),
        cmocka_unit_test(profile),
        cmocka_unit_test(mirror_images),
    };
    return cmocka_run_group_tests_name("light", tests, NULL, NULL);
}
