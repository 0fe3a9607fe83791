/* direct_test.c - the irradiance of every kind of light, at several distances and aslant, in clear air and where a medium
 * absorbs, against closed forms and quadratures in double; each of them by looking for the light and by chance.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

static const double degree = TRUTH_PI / 180;

#define FLOOR                                                                                                          \
    "meniscus 1.0 unit mm ground { surface = surface { albedo = .8 } }\n"                                              \
    "camera { from = <0, 3, 4.5>  to = <0, 0, 0>  fov = .01deg }\n"

/* A light on a floor of albedo 0.8 at the origin, looked for and by chance; chance samples as many as its solid angle
 * needs, or 0: a light that is too small for chance. */
static void expect_both(const char *what, const char *light, double (*sky)(double), double irradiance, uint32_t chance)
{
    char text[1500], name[160];
    double expected = 0.8 / TRUTH_PI * irradiance;
    snprintf(text, sizeof text, FLOOR "%s\n", light);
    truth_expect(what, expected, truth_measure(text, sky, 512, false), 4, 0.002);
    if (!chance) return;
    snprintf(name, sizeof name, "%s, by chance", what);
    truth_expect(name, expected, truth_measure(text, sky, chance / 4, true), 4, 0.005);
}

/* ---- closed forms ---- */

/* Of a sphere that is wholly above the horizon: pi L (r / d)^2 cos, whatever the distance d. */
static void spheres(void **state)
{
    (void)state;
    static const double distances[] = {12.5, 15, 20, 40, 400, 1e5};
    for (size_t i = 0; i < COUNT_OF(distances); i++) {
        char light[200], what[80];
        double d = distances[i];
        /* the farther, the brighter: the film adds up in steps */
        snprintf(light, sizeof light, "light { shape = sphere  from = <0, %.17g, 0>  radius = 10  radiance = %.17g }",
                 d, 2 * d * d / 400);
        snprintf(what, sizeof what, "sphere of 10 at %g", d);
        expect_both(what, light, NULL, TRUTH_PI * 0.5, d < 30 ? 2048 : 0);
    }
    expect_both("sphere aslant", "light { shape = sphere  from = <20, 15, 9>  radius = 10  radiance = 2 }", NULL,
                TRUTH_PI * 2 * 100 / 706 * 15 / sqrt(706), 4096);
}

/* J. H. Lambert, Photometria (1760): half the sum, over a polygon's edges, of the angle that an edge is seen under times
 * the cosine between the receiver's normal and that of the plane through the edge. All of it is above the horizon. */
static double lamberts_polygon(const Vec3 *corners, int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) {
        Vec3 a = vec3_normalize(corners[i]), b = vec3_normalize(corners[(i + 1) % n]), across = vec3_cross(a, b);
        double sine = vec3_length(across);
        sum += atan2(sine, vec3_dot(a, b)) * across.y / sine;
    }
    return 0.5 * fabs(sum);
}

static void quads(void **state)
{
    (void)state;
    static const struct {
        Vec3 from, to;
        double width, height;
        uint32_t chance;
    } cases[] = {
        {{0, 20, 0}, {0, 0, 0}, 30, 12, 4096},    {{12, 18, -7}, {0, 0, 0}, 14, 20, 4096},
        {{12, 18, -7}, {-9, 0, 5}, 14, 20, 4096}, {{-30, 12, 5}, {0, 9, 0}, 25, 10, 8192},
        {{0, 5, 0}, {0, 0, 0}, 80, 100, 1024},    {{300, 500, 200}, {0, 0, 0}, 3, 9, 0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        /* as the language has it: the width is level */
        Vec3 y = vec3_normalize(vec3_sub(cases[i].to, cases[i].from)), up = vec3(0, 1, 0), x = vec3_cross(up, y),
             corners[4];
        x = vec3_length(x) > 1e-9 ? vec3_normalize(x) : vec3(1, 0, 0);
        Vec3 z = vec3_cross(x, y);
        for (int k = 0; k < 4; k++) {
            corners[k] = vec3_along(cases[i].from, (k == 1 || k == 2 ? 0.5 : -0.5) * cases[i].width, x);
            corners[k] = vec3_along(corners[k], (k >= 2 ? 0.5 : -0.5) * cases[i].height, z);
        }
        char light[300], what[80];
        snprintf(light, sizeof light, "light { from = <%g, %g, %g>  to = <%g, %g, %g>  size = <%g, %g>  radiance = 2 }",
                 cases[i].from.x, cases[i].from.y, cases[i].from.z, cases[i].to.x, cases[i].to.y, cases[i].to.z,
                 cases[i].width, cases[i].height);
        snprintf(what, sizeof what, "quad at %g %g %g: Lambert", cases[i].from.x, cases[i].from.y, cases[i].from.z);
        expect_both(what, light, NULL, 2 * lamberts_polygon(corners, 4), cases[i].chance);
    }
}

/* A disc in a parallel plane, aside of the place: J. R. Howell, A Catalog of Radiation Heat Transfer Configuration
 * Factors, B-13. */
static void discs(void **state)
{
    (void)state;
    static const struct {
        double aside, height, radius;
        uint32_t chance;
    } cases[] = {{0, 20, 15, 4096}, {12, 20, 15, 4096}, {30, 9, 15, 8192}, {0, 5, 90, 1024}, {500, 900, 7, 0}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        double a = cases[i].aside, h = cases[i].height, r = cases[i].radius, s = a * a + h * h + r * r;
        double factor = 0.5 * (1 - (a * a + h * h - r * r) / sqrt(s * s - 4 * a * a * r * r));
        char light[300], what[80];
        snprintf(light, sizeof light,
                 "light { shape = disc  from = <%g, %g, 0>  to = <%g, 0, 0>  radius = %g  radiance = 2 }", a, h, a, r);
        snprintf(what, sizeof what, "disc of %g, %g above and %g aside", r, h, a);
        expect_both(what, light, NULL, TRUTH_PI * 2 * factor, cases[i].chance);
    }
}

/* A panel hangs right under its ceiling, nearer to it than a hundred-thousandth of the way to the floor: what is behind a light does
 * not hide it. */
static void under_a_ceiling(void **state)
{
    (void)state;
    static const double gaps[] = {1e-2, 1e-4, 2e-5};
    static const Vec3 corners[] = {{-15, 20, -6}, {15, 20, -6}, {15, 20, 6}, {-15, 20, 6}};
    static const char *const shapes[] = {"shape = disc  radius = 15", "size = <30, 12>"};
    const double irradiance[] = {TRUTH_PI * 2 * 225 / 625, 2 * fabs(lamberts_polygon(corners, 4))};
    for (int shape = 0; shape < 2; shape++)
        for (size_t i = 0; i < COUNT_OF(gaps); i++) {
            char light[400], what[80];
            snprintf(light, sizeof light,
                     "light { %s  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }\n"
                     "box { from = <-90, %.17g, -90>  to = <90, 30, 90>  surface = surface { albedo = 0 } }",
                     shapes[shape], 20 * (1 + gaps[i] / 20));
            snprintf(what, sizeof what, "%s, %g under a ceiling", shape ? "quad" : "disc", gaps[i]);
            expect_both(what, light, NULL, irradiance[shape], 4096);
        }
}

/* Lamps in the very plane of a ceiling, of a box or of the room that the place is in, and on a globe: they win. */
static void flush_with_surfaces(void **state)
{
    (void)state;
    static const Vec3 corners[] = {{-15, 20, -6}, {15, 20, -6}, {15, 20, 6}, {-15, 20, 6}};
    static const char *const behind[] = {"box { from = <-90, 20, -90>  to = <90, 30, 90>",
                                         "box { from = <-90, -1, -90>  to = <90, 20, 90>"};
    static const char *const dark[] = {"albedo = 0", "albedo = 0  emission = 9"};
    const double disc = TRUTH_PI * 225 / 625, quad = fabs(lamberts_polygon(corners, 4));
    char light[500];
    for (int i = 0; i < 2; i++) {
        snprintf(light, sizeof light,
                 "%s  surface = surface { %s } }\n"
                 "light { shape = disc  radius = 15  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }",
                 behind[i], dark[0]);
        expect_both(i ? "disc in the ceiling of a room" : "disc in a ceiling", light, NULL, 2 * disc, 4096);
        snprintf(light, sizeof light,
                 "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }\n"
                 "%s  surface = surface { %s } }",
                 behind[i], dark[0]);
        expect_both(i ? "quad in the ceiling of a room" : "quad in a ceiling", light, NULL, 2 * quad, 4096);
        snprintf(light, sizeof light,
                 "light { shape = sphere  from = <0, 20, 0>  radius = 10  radiance = 2 }\n"
                 "sphere { center = <0, 20, 0>  radius = 10  surface = surface { %s } }",
                 dark[i]);
        expect_both(i ? "sphere on a globe that shines, too" : "sphere on a globe", light, NULL,
                    TRUTH_PI * 2 * 100 / 400, 2048);
    }
    expect_both("spot in a ceiling",
                "light { shape = spot  from = <3, 20.1, 1>  to = <0, 0, 0>  angle = 60deg  intensity = 90 }\n"
                "box { from = <-90, 20.1, -90>  to = <90, 30, 90>  surface = surface { albedo = 0 } }",
                NULL, 90 * 1e6 * 20.1 / pow(414.01, 1.5), 0);
}

/* Two lamps at one place: the one that is met shines, as far as it reaches, and what it covers of the other does not. */
static void lamps_at_one_place(void **state)
{
    (void)state;
    static const Vec3 corners[] = {{-15, 20, -6}, {15, 20, -6}, {15, 20, 6}, {-15, 20, 6}},
                      wide[] = {{-90, 20, -90}, {90, 20, -90}, {90, 20, 90}, {-90, 20, 90}};
    const double quad = fabs(lamberts_polygon(corners, 4)), ceiling = fabs(lamberts_polygon(wide, 4)),
                 small = TRUTH_PI * 25 / 425, disc = TRUTH_PI * 225 / 625;
    expect_both("two spheres",
                "light { shape = sphere  from = <0, 20, 0>  radius = 10  radiance = 7 }\n"
                "light { shape = sphere  from = <0, 20, 0>  radius = 10  radiance = 2 }",
                NULL, TRUTH_PI * 2 * 100 / 400, 2048);
    expect_both("two quads",
                "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 7 }\n"
                "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }",
                NULL, 2 * quad, 4096);
    expect_both("disc on a quad",
                "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }\n"
                "light { shape = disc  radius = 5  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 7 }",
                NULL, 2 * quad + 5 * small, 4096);
    expect_both("disc in a ceiling that shines",
                "light { shape = disc  radius = 15  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }\n"
                "box { from = <-90, 20, -90>  to = <90, 30, 90>  surface = surface { albedo = 0  emission = 3 } }",
                NULL, 3 * (ceiling - disc) + 2 * disc, 1024);
    expect_both("lamps back to back",
                "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 0, 0>  radiance = 2 }\n"
                "light { size = <30, 12>  from = <0, 20, 0>  to = <0, 40, 0>  radiance = 7 }",
                NULL, 2 * quad, 4096);
}

/* What shines into a cone alone, and lights the place from all of that: pi L sin^2; less where it fades, as L is then that of its middle.
 * By power it is the power over the light's area, whatever the cone. */
static void into_a_cone(void **state)
{
    (void)state;
    const double sine = sin(20 * degree), full = cos(10 * degree), none = cos(20 * degree), fade = full - none;
    const double faded = TRUTH_PI * (1 - full * full) + 2 * TRUTH_PI * fade * (none / 2 + .35 * fade);
    expect_both("quad behind a grid, near to it",
                "light { from = <5, 20, 3>  to = <5, 0, 3>  size = <60, 50>  angle = 40deg  blend = 0  radiance = 2 }",
                NULL, TRUTH_PI * 2 * sine * sine, 8192);
    expect_both("disc behind a grid",
                "light { shape = disc  from = <5, 20, 3>  to = <5, 0, 3>  radius = 30  angle = 40deg  blend = 0  "
                "radiance = 2 }",
                NULL, TRUTH_PI * 2 * sine * sine, 8192);
    expect_both(
        "disc that fades to its border, aslant",
        "light { shape = disc  from = <0, 20 * cos(30), 20 * sin(30)>  to = <0, 0, 0>  radius = 30  angle = 40deg  "
        "blend = .5  radiance = 2 }",
        NULL, 2 * faded * cos(30 * degree), 8192);
    expect_both("quad of 5 W into a cone",
                "light { from = <0, 20, 0>  to = <0, 0, 0>  size = <60, 50>  angle = 30deg  blend = .4  power = 5 }",
                NULL, 5 / (.06 * .05), 16384);
    expect_both("a beam of 2 W, of half a degree",
                "light { shape = disc  from = <0, 90, 0>  to = <0, 0, 0>  radius = 3  angle = .5deg  power = 2 }", NULL,
                2 / (TRUTH_PI * 9e-6), 0);
}

static double bright_zenith(double elevation)
{
    return 0.2 + 3 * pow(fmax(sin(elevation), 0), 4);
}

static void from_infinity(void **state)
{
    (void)state;
    expect_both("distant, half angle 20 degrees, aslant: pi L sin^2 cos",
                "light { shape = distant  from = <0, cos(35), sin(35)>  to = <0, 0, 0>  angle = 40deg  radiance = 3 }",
                NULL, TRUTH_PI * 3 * pow(sin(20 * degree), 2) * cos(35 * degree), 4096);
    expect_both("the sun, aslant: E cos",
                "light { shape = distant  from = <0, cos(35), sin(35)>  to = <0, 0, 0>  power = 2 }", NULL,
                2 * cos(35 * degree), 0);
    expect_both("the same from everywhere: pi L", "environment { color = 3 }", NULL, TRUTH_PI * 3, 256);
    expect_both("an image: its integral", TRUTH_SKY, bright_zenith, TRUTH_PI * 0.2 + 2 * TRUTH_PI * 3 / 6, 1024);
    expect_both("a sky of clouds: 0.3 + 21 sin klx", "environment { sky = overcast  elevation = 50deg }", NULL,
                (0.3 + 21 * sin(50 * degree)) / 100 * TRUTH_PI, 1024);
}

/* ---- in a medium that absorbs ---- */

/* The irradiance of a level quad above, every part of it weakened by Beer's law, by a midpoint sum. */
static double absorbed_quad(double width, double depth, double height, double sigma)
{
    enum { N = 800 };
    double sum = 0;
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            double x = width * ((i + 0.5) / N - 0.5), z = depth * ((k + 0.5) / N - 0.5);
            double square = x * x + z * z + height * height, distance = sqrt(square);
            sum += height * height / (square * square) * exp(-sigma * distance);
        }
    return sum * width * depth / ((double)N * N);
}

/* And of a sphere above, seen as a disc of directions, each of which ends where the sphere begins. */
static double absorbed_sphere(double radius, double height, double sigma)
{
    enum { N = 200000 };
    double most = radius / height, sum = 0;
    for (int i = 0; i < N; i++) {
        double sine2 = most * most * (i + 0.5) / N, cosine = sqrt(1 - sine2);
        double distance = height * cosine - sqrt(radius * radius - height * height * sine2);
        sum += exp(-sigma * distance);
    }
    return TRUTH_PI * most * most * sum / N; /* pi d(sin^2) is the projected solid angle */
}

#define MURK                                                                                                           \
    "medium murk { ior = 1  absorption = .03 / 1mm } box { interior = murk  from = <-900, -1, -900>  to = <900, 99, "  \
    "900> }\n"

static void in_murk(void **state)
{
    (void)state;
    const double sigma = 0.03;
    expect_both("quad through murk", MURK "light { from = <0, 20, 0>  to = <0, 0, 0>  size = <30, 12>  radiance = 2 }",
                NULL, 2 * absorbed_quad(30, 12, 20, sigma) * exp(-sigma * sqrt(9 + 20.25)), 4096);
    expect_both("sphere through murk", MURK "light { shape = sphere  from = <0, 20, 0>  radius = 10  radiance = 2 }",
                NULL, 2 * absorbed_sphere(10, 20, sigma) * exp(-sigma * sqrt(9 + 20.25)), 2048);
    expect_both("point through murk: I exp(-s d) cos / d^2",
                MURK "light { shape = point  from = <30, 40, 0>  intensity = 2 }", NULL,
                2 / 2500e-6 * 0.8 * exp(-sigma * 50) * exp(-sigma * sqrt(9 + 20.25)), 0);
    expect_both("spot through murk",
                MURK "light { shape = spot  from = <0, 40, 0>  to = <5, 0, 0>  angle = 60deg  intensity = 2 }", NULL,
                2 / 1600e-6 * exp(-sigma * 40) * exp(-sigma * sqrt(9 + 20.25)), 0);
    expect_both(
        "shining ball through murk",
        MURK
        "sphere { center = <0, 20, 0>  radius = 10  surface = surface { albedo = 0  emission = 1  radiance = 2 } }",
        NULL, 2 * absorbed_sphere(10, 20, sigma) * exp(-sigma * sqrt(9 + 20.25)), 2048);
}

/* A glowing ball in a bulb of glass in murk: what a pair of surfaces lets pass, (1 - R) / (1 + R), less what the murk takes
 * between the bulb and its own end. */
static void bulb_in_murk(void **state)
{
    (void)state;
    double r = truth_fresnel(1, 1, 1.5);
    const char *text =
        "meniscus 1.0 unit mm medium glass { ior = 1.5  state = solid }\n"
        "medium murk { ior = 1  absorption = .02 / 1mm }\n"
        "sphere { interior = murk  radius = 60 }\n"
        "sphere { interior = glass  radius = 20  priority = 1 } sphere { interior = air  radius = 19  priority = 2 }\n"
        "light { shape = sphere  radius = 2  radiance = 5 }\n"
        "camera { from = <0, 0, 200>  to = <0, 0, 0>  fov = .01deg }\n";
    truth_expect("a light in a bulb in murk", 5 * (1 - r) / (1 + r) * exp(-0.02 * 40),
                 truth_measure(text, NULL, 4096, false), 4, 0.005);
}

/* ---- the two estimators where media scatter ---- */

static void agree_in_fog(void **state)
{
    (void)state;
    static const struct {
        const char *what, *light;
    } cases[] = {
        {"quad in fog", "light { from = <0, 20, 0>  to = <0, 0, 0>  size = <30, 22>  radiance = 2 }"},
        {"disc in fog", "light { shape = disc  from = <5, 14, 0>  to = <0, 0, 0>  radius = 9  radiance = 2 }"},
        {"disc into a cone in fog",
         "light { shape = disc  from = <5, 14, 0>  to = <0, 0, 0>  radius = 9  angle = 60deg  radiance = 2 }"},
        {"sphere in fog", "light { shape = sphere  from = <5, 16, 0>  radius = 9  radiance = 2 }"},
        {"distant light on fog",
         "light { shape = distant  to = <0, 0, 0>  from = <1, 3, 1>  angle = 60deg  radiance = 2 }"},
        {"sky on fog", "environment { sky = clear  disc = false }"},
        {"shining ring in fog", "torus { radius = 9  tube = 4  translate(<0, 14, 0>)  surface = surface { albedo = .5  "
                                "emission = 1  radiance = 2 } }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1500];
        snprintf(text, sizeof text,
                 FLOOR "medium fog { ior = 1  absorption = .004 / 1mm  scattering = .03 / 1mm }\n"
                       "box { interior = fog  from = <-40, -1, -40>  to = <40, 30, 40> }\n%s\n",
                 cases[i].light);
        truth_found_alike(cases[i].what, text, 2048, 0.008);
    }
}

/* ---- through panes ---- */

#define PANE "surface pane { thin = true  transmission = 1  ior = 1.5  roughness = 0 }\n"

static void through_panes(void **state)
{
    (void)state;
    /* a small sun, which no path would find by chance */
    const double cosine = 3 / sqrt(13);
    expect_both("the sun through a pane",
                PANE "light { shape = distant  from = <2, 3, 0>  to = <0, 0, 0>  angle = .1deg  power = 10 }\n"
                     "mesh { positions = [<1980, 3000, -20>, <2020, 3000, -20>, <2000, 3000, 40>]  triangles = [<0, 1, "
                     "2>]  surface = pane }",
                NULL, 10 * cosine * truth_pane(cosine, 1.5), 0);
    /* a point, which no path finds by chance; a box has two sides */
    expect_both(
        "a point through the holes of a sheet",
        "def part(p) = p.x ^ 2 + p.z ^ 2 < 400 ? .25 : 1\n"
        "light { shape = point  from = <0, 20, 0>  intensity = 4e-4 }\n"
        "box { from = <-30, 8, -30>  to = <30, 8.001, 30>  surface = surface { weight = part\n"
        "  mix = [surface { thin = true  transmission = 1  ior = 1  specular = 0 }, surface { albedo = 0 }] } }",
        NULL, 0.75 * 0.75, 0);
    static const struct {
        const char *what, *between;
    } cases[] = {
        {"lamp behind a tinted pane", "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = tinted }"},
        {"lamp in a bubble", "sphere { center = <5, 18, 0>  radius = 12  surface = film }"},
        {"lamp behind half a pane in fog", "medium fog { ior = 1  scattering = .02 / 1mm }\n"
                                           "box { interior = fog  from = <-40, -1, -40>  to = <40, 30, 40> }\n"
                                           "box { from = <0, 6, -90>  to = <90, 6.1, 90>  surface = tinted }"},
        {"lamp behind a pane that is matte in part",
         "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = half }"},
        {"lamp behind holes", "def holes(p) = mod(floor(p.x / 3) + floor(p.z / 3), 2)\n"
                              "surface lace { mix = [nothing, surface { albedo = .6 }]  weight = holes }\n"
                              "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = lace }"},
        {"lamp behind panes of two colours",
         "def colors(p) = p.x < 0 ? rgb(.9, .2, .1) : rgb(.2, .5, .9)\n"
         "surface stained { thin = true  transmission = 1  ior = 1.5  tint = colors }\n"
         "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = stained }"},
        {"lamp behind a pane that is clear in part",
         "def clear(p) = clamp(.5 + p.z / 20, 0, 1)\n"
         "surface print { thin = true  transmission = clear  albedo = .6  ior = 1.5 }\n"
         "box { from = <-90, 8, -90>  to = <90, 8.1, 90>  surface = print }"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1500];
        snprintf(text, sizeof text,
                 FLOOR PANE
                 "surface tinted { thin = true  transmission = 1  ior = 1.5  roughness = 0  tint = rgb(.4, .7, .9) }\n"
                 "surface film { thin = true  transmission = 1  ior = 1.33  roughness = 0  film = 320nm }\n"
                 "surface half { thin = true  transmission = .5  albedo = .6  ior = 1.5  roughness = 0 }\n"
                 "surface nothing { thin = true  transmission = 1  ior = 1  specular = 0 }\n"
                 "light { shape = sphere  from = <5, 18, 0>  radius = 8  radiance = 2 }\n%s\n",
                 cases[i].between);
        truth_found_alike(cases[i].what, text, 2048, 0.008);
    }
}

/* A pane is one of the surfaces along a path whichever way light is found: beyond the limit, no look goes through it. */
static void panes_count(void **state)
{
    (void)state;
    const double cosine = 3 / sqrt(13);
    static const char text[] =
        FLOOR PANE "light { shape = distant  from = <2, 3, 0>  to = <0, 0, 0>  angle = .1deg  power = 10 }\n"
                   "mesh { positions = [<-9000, 8, -9000>, <9000, 8, -9000>, <0, 8, 9000>]  triangles = [<0, 1, 2>]\n"
                   "  surface = pane }";
    RenderSettings looking = truth_small(64);
    looking.caustics = CAUSTICS_OFF;
    looking.bounces = 2;
    truth_expect("the sun through a pane, of two surfaces", 0.8 / TRUTH_PI * 10 * cosine * truth_pane(cosine, 1.5),
                 truth_measure_as(text, NULL, &looking), 4, 0.002);
    looking.bounces = 1;
    assert_true(truth_measure_as(text, NULL, &looking).mean == 0);
}

/* ---- through bodies with parallel faces ---- */

/* A small sun, with so few bounces that light goes through and no further: what two faces let pass, and the glass between them. */
static void sun_through_slab(void **state)
{
    (void)state;
    const double cosine = 3 / sqrt(13), inside = sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double one = 1 - truth_fresnel(cosine, 1, 1.5), passes = one * one * exp(-0.05 * 4 / inside);
    static const char *const shapes[] = {
        "box { from = <-9000, 8, -9000>  to = <9000, 12, 9000>",
        "cylinder { from = <0, 8, 0>  to = <0, 12, 0>  radius = 9000",
        "intersection { box { from = <-9000, 8, -9000>  to = <9000, 40, 9000> }\n"
        "  box { from = <-8000, -9, -8000>  to = <8000, 12, 8000> }",
        "mesh { positions = [<-9000, 8, -9000>, <9000, 8, -9000>, <9000, 8, 9000>, <-9000, 8, 9000>,\n"
        "  <-9000, 12, -9000>, <9000, 12, -9000>, <9000, 12, 9000>, <-9000, 12, 9000>]\n"
        "  triangles = [<0, 1, 2>, <0, 2, 3>, <4, 6, 5>, <4, 7, 6>, <0, 5, 1>, <0, 4, 5>, <1, 6, 2>, <1, 5, 6>,\n"
        "  <2, 7, 3>, <2, 6, 7>, <3, 4, 0>, <3, 7, 4>]",
    };
    for (size_t i = 0; i < COUNT_OF(shapes); i++) {
        char text[1500];
        snprintf(text, sizeof text,
                 FLOOR "medium green { ior = 1.5  absorption = .05 / 1mm  state = solid }\n"
                       "light { shape = distant  from = <2, 3, 0>  to = <0, 0, 0>  angle = .1deg  power = 10 }\n"
                       "%s  interior = green }\n",
                 shapes[i]);
        RenderSettings looking = truth_small(1024);
        looking.caustics = CAUSTICS_OFF;
        looking.bounces = 3;
        truth_expect("the sun through a slab", 0.8 / TRUTH_PI * 10 * cosine * passes,
                     truth_measure_as(text, NULL, &looking), 4, 0.002);
    }
}

/* Looking and chance together find the same as chance alone, whatever else is on the way. */
static void through_slabs(void **state)
{
    (void)state;
    static const struct {
        const char *what, *between;
        double resolution;
    } cases[] = {
        {"under a block, aslant",
         "box { from = <-9, 0, -9>  to = <9, 9, 9>  rotate(<20, 30, 10>)  translate(<3, 8, 0>)  "
         "interior = glass }",
         0.008},
        {"under three panes that reach into each other",
         "box { from = <-30, 8, -30>  to = <30, 11, 30>  interior = green }\n"
         "box { from = <-30, 10, -30>  to = <30, 14, 30>  interior = glass }\n"
         "box { from = <-20, 14, -9>  to = <20, 15, 30>  interior = flint }",
         0.008},
        {"under a pane and a sheet",
         "box { from = <-30, 8, -30>  to = <30, 9, 30>  interior = glass }\n"
         "box { from = <0, 12, -90>  to = <90, 12.1, 90>  surface = pane }",
         0.008},
        {"under a pane that has a dent",
         "difference { box { from = <-30, 8, -30>  to = <30, 12, 30> } sphere { center = <5, 13, 0>  radius = 5 }  "
         "interior = glass }",
         0.008},
        {"under glass that scatters", "box { from = <-30, 8, -30>  to = <30, 10, 30>  interior = milky }", 0.01},
        {"under a pane in fog",
         "box { from = <-40, -1, -40>  to = <40, 40, 40>  interior = fog }\n"
         "box { from = <-30, 12, -30>  to = <30, 14, 30>  interior = glass }",
         0.01},
        {"under a slice of a ball, cut out of it by boxes of air",
         "sphere { interior = glass  center = <0, 10, 0>  radius = 20  priority = 1 }\n"
         "box { from = <-30, 12, -30>  to = <30, 40, 30>  interior = hole  priority = 5 }\n"
         "box { from = <-30, -40, -30>  to = <30, 8, 30>  interior = hole  priority = 6 }",
         0.01},
        {"under a pane with a recess, of air that reaches out of it",
         "box { from = <-30, 8, -30>  to = <30, 12, 30>  interior = glass }\n"
         "box { from = <-9, 10, -9>  to = <9, 16, 9>  interior = hole }",
         0.01},
        {"under a pane with a recess from below, aslant",
         "box { from = <-30, 8, -30>  to = <30, 12, 30>  interior = flint }\n"
         "box { from = <-9, 2, -9>  to = <9, 10, 9>  rotate(<8, 20, 5>)  interior = hole }",
         0.01},
        {"under two panes, of a block with air in it",
         "box { from = <-30, 8, -30>  to = <30, 14, 30>  interior = glass }\n"
         "box { from = <-29, 9, -29>  to = <29, 13, 29>  interior = hole }",
         0.01},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 FLOOR PANE
                 "medium glass { ior = 1.5  state = solid }\n"
                 "medium green { ior = 1.6  absorption = .05 / 1mm  state = solid }\n"
                 "medium flint { ior = cauchy(1.7, .03)  state = solid }\n"
                 "medium milky { ior = 1.5  scattering = .2 / 1mm  state = solid }\n"
                 "medium fog { ior = 1  scattering = .02 / 1mm }  medium hole { ior = 1  state = solid }\n"
                 "light { shape = distant  from = <1, 3, 1>  to = <0, 0, 0>  angle = 40deg  radiance = 3 }\n%s\n",
                 cases[i].between);
        truth_found_alike(cases[i].what, text, 2048, cases[i].resolution);
    }
}

/* ---- from within what bends ---- */

/* What diffuse light loses at a surface that it comes to from within, of that index: it is mirrored. */
static double mirrored_within(double n)
{
    enum { STEPS = 200000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double sine2 = (i + 0.5) / STEPS;
        sum += n * n * sine2 < 1 ? truth_fresnel(sqrt(1 - sine2), n, 1) : 1;
    }
    return sum / STEPS;
}

/* A wide pool of still water in a small sun, seen from outside: what comes in, and goes to and fro between bottom and surface. */
static void sun_in_still_water(void **state)
{
    (void)state;
    const double cosine = 3 / sqrt(14), n = 1.33, albedo = 0.8, seen = cos(atan(4.5 / 3));
    const double passes = (1 - truth_fresnel(cosine, 1, n)) * (1 - truth_fresnel(seen, 1, n)) / (n * n),
                 bottom = albedo / TRUTH_PI * 10 * cosine / (1 - albedo * mirrored_within(n));
    RenderSettings looking = truth_small(4096);
    looking.caustics = CAUSTICS_OFF;
    truth_expect("the sun in still water", passes * bottom,
                 truth_measure_as(FLOOR "medium water { ior = 1.33  state = liquid }\n"
                                        "light { shape = distant  from = <2, 3, 1>  to = <0, 0, 0>  angle = .1deg  "
                                        "power = 10 }\n"
                                        "box { from = <-9000, -1, -9000>  to = <9000, 2, 9000>  interior = water }\n",
                                  NULL, &looking),
                 4, 0.002);
}

/* The floor of a tank of water in a small sun, which comes there by the top and by two of the sides. */
static void sun_in_tank(void **state)
{
    (void)state;
    const double n = 1.33, albedo = 0.8, seen = cos(atan(3 / 4.5)), size = sqrt(14),
                 sun[3] = {2 / size, 3 / size, 1 / size};
    double floor = 0;
    for (int side = 0; side < 3; side++) {
        double passes = 1 - truth_fresnel(sun[side], 1, n);
        double within = sqrt(1 - (1 - sun[side] * sun[side]) / (n * n)); /* the cosine there, */
        double down = side == 1 ? within : sun[1] / n;                   /* and that to the floor */
        floor += 10 * passes * sun[side] / within * down;
    }
    RenderSettings looking = truth_small(4096);
    looking.caustics = CAUSTICS_OFF;
    looking.bounces = 3; /* in, the floor, and out */
    const double mirrored = truth_fresnel(seen, 1, n),
                 below = mirrored * 10 * sun[1]; /* at that side, the floor outside */
    truth_expect("the sun in a tank of water", albedo / TRUTH_PI * (below + (1 - mirrored) / (n * n) * floor),
                 truth_measure_as(FLOOR "medium water { ior = 1.33  state = liquid }\n"
                                        "light { shape = distant  from = <2, 3, 1>  to = <0, 0, 0>  angle = .1deg  "
                                        "power = 10 }\n"
                                        "box { from = <-1, -1, -1>  to = <1, 1.5, 1>  interior = water }\n",
                                  NULL, &looking),
                 4, 0.001);
}

static void within_slabs(void **state)
{
    (void)state;
    static const struct {
        const char *what, *around;
        double resolution;
    } cases[] = {
        {"in a pool", "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = water }", 0.006},
        {"in a block, aslant", "box { from = <-9, -9, -9>  to = <9, 9, 9>  rotate(<20, 30, 10>)  interior = glass }",
         0.008},
        {"in a sea", "plane { translate(<0, 9, 0>)  interior = water }", 0.006},
        {"in a drink", "cylinder { from = <0, -1, 0>  to = <0, 9, 0>  radius = 5  interior = water }", 0.01},
        {"under the stem of a column", "cylinder { from = <0, 7, 0>  to = <0, 30, 0>  radius = 6  interior = glass }",
         0.01},
        {"in flint", "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = flint }", 0.01},
        {"in water under glass and a pane",
         "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = water }\n"
         "box { from = <-20, 9, -20>  to = <20, 11, 20>  interior = glass }\n"
         "box { from = <-90, 20, -90>  to = <90, 20.1, 0>  surface = pane }",
         0.008},
        {"in cloudy water", "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = murk }", 0.012},
        {"on a leaf and a ball in water",
         "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = water }\n"
         "box { from = <-.5, .5, -.5>  to = <.5, .51, .5>  surface = surface { thin = true  albedo = .8  translucency "
         "= .5 } }\n"
         "sphere { center = <3, 3, 1>  radius = 1  surface = surface { albedo = .5  ior = 1.6  roughness = .3 } }",
         0.01},
        {"beside the walls of a pool",
         "box { from = <-1, -1, -2>  to = <2, 5, 9>  interior = water }\n"
         "box { from = <2, -1, -9>  to = <3, 4, 9>  surface = surface { albedo = .5 } }\n"
         "box { from = <-2, -1, -9>  to = <-1, 3, 9>  surface = surface { albedo = .5 } }\n",
         0.008},
        {"in a narrow tank",
         "difference { box { from = <-2, -1, -3>  to = <2, 6, 3> } box { from = <-1.8, -.5, -2.8>  to = <1.8, 7, 2.8> "
         "}\n"
         "  interior = glass }\n"
         "box { from = <-1.9, -.6, -2.9>  to = <1.9, 5, 2.9>  interior = water }\n",
         0.008},
        {"in a narrow block", "box { from = <-1, -1, -2>  to = <1, 6, 2>  interior = glass }", 0.008},
        {"in a wavy tank, with a block of glass",
         "difference { box { from = <-3, -1, -4>  to = <3, 6, 4> } box { from = <-2.8, -.5, -3.8>  to = <2.8, 7, 3.8> "
         "}\n"
         "  interior = glass }\n"
         "difference { box { from = <-2.9, -.6, -3.9>  to = <2.9, 5, 3.9> }\n"
         "  sphere { center = <9, 30, 0>  radius = 26 } interior = water }\n"
         "box { from = <1.2, .2, -3>  to = <2.5, 3, -1>  rotate(<0, 10, 2>)  interior = flint }\n",
         0.01},
        {"beside a ball of glass in water",
         "box { from = <-9, -1, -9>  to = <9, 9, 9>  interior = water }\n"
         "sphere { center = <1, 4, 1>  radius = 2  interior = glass }",
         0.01},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 FLOOR PANE
                 "medium glass { ior = 1.5  state = solid }  medium water { ior = 1.33  state = liquid }\n"
                 "medium flint { ior = cauchy(1.7, .03)  state = solid }\n"
                 "medium murk { ior = 1.33  scattering = .05 / 1mm  state = liquid }\n"
                 "light { shape = distant  from = <1, 3, 1>  to = <0, 0, 0>  angle = 40deg  radiance = 3 }\n%s\n",
                 cases[i].around);
        truth_found_alike(cases[i].what, text, 2048, cases[i].resolution);
    }
}

/* What has another index than outside, and is lit straight as well: under a sea without a bottom; and what lies between two media, and
 * takes light from both. */
static void between_slabs(void **state)
{
    (void)state;
    static const struct {
        const char *what, *camera, *around, *sun;
        double resolution;
    } cases[] = {
        {"from below, in a sea", "<0, -3, 4.5>",
         "sphere { radius = .5  surface = surface { albedo = .8 } }\n"
         "plane { translate(<0, 9, 0>)  interior = water }",
         "from = <1, -3, 1>  angle = 40deg", 0.003},
        {"from the side, in a sea", "<0, -3, 4.5>",
         "sphere { radius = .5  surface = surface { albedo = .8 } }\n"
         "plane { translate(<0, 9, 0>)  interior = water }",
         "from = <1, .2, 3>  angle = 40deg", 0.006},
        {"on a rough face between two media", "<0, .3, .5>",
         "box { from = <-2, -1, -2>  to = <2, .5, 2>  interior = glass }\n"
         "box { from = <-1, -.4, -1>  to = <1, 0, 1>  interior = green  priority = 5  surface = surface { roughness = "
         ".8 } "
         "}",
         "from = <3, -.5, .5>  angle = 80deg", 0.03},
        {"on a leaf on a block", "<.073, .35, .5>",
         "mesh { positions = [<-.5, 0, -.5>, <.5, 0, -.5>, <.5, 0, .5>, <-.5, 0, .5>]\n"
         "  triangles = [<0, 2, 1>, <0, 3, 2>]  surface = surface { thin = true  albedo = .8  translucency = .5 } }\n"
         "box { from = <-2, -1, -2>  to = <2, 0, 2>  interior = glass }",
         "from = <3, 1, .5>  angle = 60deg", 0.01},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[2000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm\n"
                 "medium glass { ior = 1.5  state = solid }  medium water { ior = 1.33  state = liquid }\n"
                 "medium green { ior = 1.2  state = solid }\n"
                 "camera { from = %s  to = <0, 0, 0>  fov = .01deg }\n"
                 "light { shape = distant  to = <0, 0, 0>  radiance = 3  %s }\n%s\n",
                 cases[i].camera, cases[i].sun, cases[i].around);
        truth_found_alike(cases[i].what, text, 6144, cases[i].resolution);
    }
}

/* A side of a block that mirrors the sun onto a wall which faces away from it: no look goes there, and photons have to. */
static void mirrored_to_dark_side(void **state)
{
    (void)state;
    RenderSettings led = truth_small(256);
    led.caustics = CAUSTICS_ON;
    const char *text = "meniscus 1.0 unit mm\n"
                       "medium glass { ior = 1.5  state = solid }\n"
                       "camera { from = <-9, 1, 0>  to = <-1.2, .2, 0>  fov = .01deg }\n"
                       "box { from = <-2, -2, -2>  to = <2, 2, 2>  interior = glass }\n"
                       "box { from = <-1.2, -2, -2>  to = <1.9, 1.99, 2>  surface = surface { albedo = .8 } }\n"
                       "box { from = <-3, -3, -3>  to = <3, -1.9, 3>  surface = surface { albedo = .01 } }\n"
                       "light { shape = distant  from = <1, 1.2, 0>  to = <0, 0, 0>  angle = 8deg  power = 10 }\n";
    truth_alike("the sun mirrored to a dark side", truth_measure(text, NULL, 16384, true),
                truth_measure_as(text, NULL, &led), 4, 0.03);
}

/* Holes of a sheet that stands in glass are not to be seen there, where a pane of another index would be. */
static void holes_in_glass(void **state)
{
    (void)state;
    Estimate seen =
        truth_measure("meniscus 1.0 unit mm  medium glass { ior = 1.5 }\n"
                      "box { from = <-60, -5, -60>  to = <60, 5, 60>  interior = glass }\n"
                      "box { from = <-50, -2, -50>  to = <50, 2, 50>  surface = surface { weight = 0\n"
                      "  mix = [surface { thin = true  transmission = 1  ior = 1  specular = 0 }, surface { }] } }\n"
                      "light { from = <0, -90, 0>  to = <0, 0, 0>  size = <90, 90>  radiance = 2 }\n"
                      "camera { from = <0, 300, 0>  to = <0, 0, 0>  up = z  fov = .01deg }\n",
                      NULL, 1024, false);
    truth_expect("a lamp through glass with a sheet of holes", 2 * truth_pane(1, 1.5), seen, 4, 0.004);
}

/* A box with a thin surface is two panes, between which light goes to and fro. */
/* Which hull is on top may depend on how a path came to a place, and what a surface bends on nothing but its own medium. */
static void by_other_policies(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        NestPolicy policy;
        const char *text;
    } cases[] = {
        {"the sun in bodies that nothing orders", NEST_NONE,
         "camera { from = <4.96, 3.5, 5>  to = <0, 0, 0>  fov = .01deg }  ground { surface "
         "= wall }\n"
         "plane { translate(<0, 42.23, 0>)  interior = glass }\n"
         "box { from = <-24.96, -27.12, -14.19>  to = <8.96, 17.94, 24.35>  interior = flint }\n"
         "light { shape = distant  from = <-53, 28.3, -66.5>  to = <0, 0, 0>  angle = 20deg  radiance = 3 }\n"},
        {"a lamp above bodies, the last entered on top", NEST_ENTERED,
         "camera { from = <-2, 3.1, 3>  to = <0, 0, 0>  fov = .01deg }  ground { surface "
         "= wall }\n"
         "box { from = <-10, -5, -10>  to = <10, 10, 10>  interior = glass }\n"
         "box { from = <-12, -5, -12>  to = <12, 8, 12>  interior = water }\n"
         "light { shape = sphere  from = <0, 18, 0>  radius = 4  radiance = 4 }\n"},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1500];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm\n"
                 "medium flint { ior = 1.7  state = solid }  medium glass { ior = 1.5  state = solid }\n"
                 "medium water { ior = 1.33  state = liquid }  surface wall { albedo = .8 }\n%s",
                 cases[i].text);
        const TruthInput input = {.text = text, .policy = cases[i].policy};
        RenderSettings looking = truth_small(1024), by_chance = truth_small(8192);
        looking.caustics = by_chance.caustics = CAUSTICS_OFF;
        by_chance.by_chance = true;
        truth_alike(cases[i].what, truth_measure_input(input, &by_chance), truth_measure_input(input, &looking), 4,
                    0.02);
    }
}

/* A sheet in the very boundary between media, where light that it lets through is bent: one that does nothing is none, and looks find no
 * more or less than chance. */
static void sheets_in_boundaries(void **state)
{
    (void)state;
    static const char sheet[] = "mesh { positions = [<-50, 0, -50>, <50, 0, -50>, <50, 0, 50>, <-50, 0, 50>]\n"
                                "triangles = [<0, 2, 1>, <0, 3, 2>]  surface = %s }\n";
    static const char sun[] =
        "light { shape = distant  from = <-.3, 1, .2>  to = <0, 0, 0>  angle = 20deg  radiance = 10 }\n",
                      lamp[] = "light { shape = sphere  from = <10, 60, 0>  radius = 20  radiance = 10 }\n";
    static const struct {
        const char *what, *surface, *light;
    } cases[] = {
        {"the sun through a sheet of nothing on water", "nothing", sun},
        {"a lamp through a sheet of nothing on water", "nothing", lamp},
        {"the sun through a pane on water", "pane", sun},
        {"a lamp through a pane on water", "pane", lamp},
        {"the sun through holes in a sheet on water", "lace", sun},
        {"a lamp through holes in a sheet on water", "lace", lamp},
        {"no sheet", NULL, sun},
        {"no sheet", NULL, lamp},
    };
    Estimate found[COUNT_OF(cases)];
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1800], lies[400] = "";
        if (cases[i].surface) snprintf(lies, sizeof lies, sheet, cases[i].surface);
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm " PANE "medium water { ior = 1.33  state = liquid }\n"
                 "surface nothing { thin = true  transmission = 1  ior = 1  specular = 0 }\n"
                 "def holes(p) = mod(floor(p.x / 3) + floor(p.z / 3), 2)\n"
                 "surface lace { mix = [nothing, surface { albedo = .6 }]  weight = holes }\n"
                 "camera { from = <-10.9, -10, 20>  to = <0, -60, 0>  fov = .01deg }\n"
                 "ground { y = -60  surface = surface { albedo = .8 } }\n"
                 "box { from = <-100, -60, -100>  to = <100, 0, 100>  interior = water }\n%s%s",
                 lies, cases[i].light);
        found[i] = truth_measure(text, NULL, 2048, true);
        if (cases[i].surface) truth_alike(cases[i].what, truth_measure(text, NULL, 2048, false), found[i], 4, 0.02);
    }
    truth_alike("the sun through nothing", found[0], found[6], 4, 0.01);
    truth_alike("a lamp through nothing", found[1], found[7], 4, 0.01);
}

/* Of sheets at one place a path meets one, and so do looks for light. */
static void sheets_at_one_place(void **state)
{
    (void)state;
    static const char flat[] = "mesh { positions = [<-50, 0, -50>, <50, 0, -50>, <50, 0, 50>, <-50, 0, 50>]\n"
                               "triangles = [<0, 2, 1>, <0, 3, 2>]  surface = %s }\n";
    static const char *const pairs[][2] = {{"pane", "pane"}, {"pane", "tinted"}, {"tinted", "pane"}};
    for (size_t i = 0; i <= COUNT_OF(pairs); i++) {
        char text[1800], sheets[700] = "box { from = <-50, -9, -50>  to = <50, 0, 50>  surface = pane }\n"
                                       "box { from = <-50, 0, -50>  to = <50, 9, 50>  surface = tinted }\n";
        for (size_t k = 0, n = 0; i < COUNT_OF(pairs) && k < 2; k++)
            n += (size_t)snprintf(sheets + n, sizeof sheets - n, flat, pairs[i][k]);
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm " PANE
                 "surface tinted { thin = true  transmission = 1  ior = 1.5  roughness = 0\n"
                 "  tint = rgb(.3, .5, .9) }\n"
                 "camera { from = <-10.9, -10, 20>  to = <0, -60, 0>  fov = .01deg }\n"
                 "ground { y = -60  surface = surface { albedo = .8 } }\n"
                 "light { shape = sphere  from = <10, 60, 0>  radius = 20  radiance = 10 }\n%s",
                 sheets);
        truth_alike(i < COUNT_OF(pairs) ? pairs[i][1] : "boxes of panes", truth_measure(text, NULL, 4096, false),
                    truth_measure(text, NULL, 4096, true), 4, 0.02);
    }
}

static void double_glazing(void **state)
{
    (void)state;
    const double one = truth_pane(1, 1.5);
    Estimate seen =
        truth_measure("meniscus 1.0 unit mm " PANE "box { from = <-60, 0, -60>  to = <60, 16, 60>  surface = pane }\n"
                      "light { from = <0, -90, 0>  to = <0, 0, 0>  size = <90, 90>  radiance = 2 }\n"
                      "camera { from = <0, 300, 0>  to = <0, 0, 0>  up = z  fov = .01deg }\n",
                      NULL, 1024, false);
    truth_expect("a lamp seen through double glazing", 2 * one * one / (1 - (1 - one) * (1 - one)), seen, 4, 0.004);
}

/* Three lanes of each path are for lines where these are all the light, and one beside other lights: the light of two lamps is
 * that of one and that of the other. */
static void lamps_of_lines(void **state)
{
    (void)state;
    static const char line[] = "light { shape = sphere  from = <0, 20, 0>  radius = 4  "
                               "radiance = 90  color = spectrum([<588.9, 0>, <589, 1>, <589.1, 0>]) }",
                      white[] = "light { shape = sphere  from = <9, 20, 3>  radius = 4  radiance = 80 }";
    char text[1500];
    snprintf(text, sizeof text, FLOOR "%s\n", line);
    Estimate of_line = truth_measure(text, NULL, 64, false), by_chance = truth_measure(text, NULL, 4096, true);
    truth_alike("lamp of one line, by chance", by_chance, of_line, 4, 0.01);
    assert_true(of_line.error < 0.002 * of_line.mean);
    snprintf(text, sizeof text, FLOOR "%s\n", white);
    Estimate of_white = truth_measure(text, NULL, 512, false);
    snprintf(text, sizeof text, FLOOR "%s\n%s\n", line, white);
    Estimate of_both = truth_measure(text, NULL, 512, false);
    Estimate sum = {of_line.mean + of_white.mean, hypot(of_line.error, of_white.error)};
    truth_alike("that lamp and a white one", of_both, sum, 4, 0.002);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(spheres),
        cmocka_unit_test(quads),
        cmocka_unit_test(discs),
        cmocka_unit_test(under_a_ceiling),
        cmocka_unit_test(flush_with_surfaces),
        cmocka_unit_test(lamps_at_one_place),
        cmocka_unit_test(into_a_cone),
        cmocka_unit_test(from_infinity),
        cmocka_unit_test(in_murk),
        cmocka_unit_test(bulb_in_murk),
        cmocka_unit_test(agree_in_fog),
        cmocka_unit_test(through_panes),
        cmocka_unit_test(panes_count),
        cmocka_unit_test(holes_in_glass),
        cmocka_unit_test(sun_through_slab),
        cmocka_unit_test(through_slabs),
        cmocka_unit_test(sun_in_still_water),
        cmocka_unit_test(sun_in_tank),
        cmocka_unit_test(within_slabs),
        cmocka_unit_test(between_slabs),
        cmocka_unit_test(mirrored_to_dark_side),
        cmocka_unit_test(by_other_policies),
        cmocka_unit_test(sheets_in_boundaries),
        cmocka_unit_test(sheets_at_one_place),
        cmocka_unit_test(double_glazing),
        cmocka_unit_test(lamps_of_lines),
    };
    return cmocka_run_group_tests_name("direct light", tests, NULL, NULL);
}
