/* terminator_test.c - coarse meshes with smooth normals are lit as the curved surfaces that they stand for: up to where these turn
 * away from the light, and no light is lost or made by that. What lies close upon a mesh stays where it is.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

/* Grids of points that close round, as triangles: a ball, and a ring. */
static const char head[] =
    "meniscus 1.0 unit m\n"
    "medium glass { ior = 1.5  state = solid }  medium water { ior = 1.333  state = liquid }\n"
    "medium ink { ior = 1  absorption = 100 / 1m  state = liquid }\n"
    "def around(n, m, rows) = [for (k in 0..<m) for (i in 0..<n) for (h in 0..1)\n"
    "  let (e = (k + 1) % rows, a = k * n + i, b = k * n + (i + 1) % n, c = e * n + i, d = e * n + (i + 1) % n)\n"
    "  h == 0 ? <a, c, d> : <a, d, b>]\n"
    "def turned(r, y, i, n) = <r * cos(360 * i / n), y, -r * sin(360 * i / n)>\n"
    "def ball_points(n, m, r) = [for (k in 0..m) for (i in 0..<n)\n"
    "  let (t = 180 * k / m) turned(k % m == 0 ? 0 : r * sin(t), r * cos(t), i, n)]\n"
    "def ring_points(n, m) = [for (k in 0..<m) for (i in 0..<n)\n"
    "  let (t = 360 * k / m) turned(.7 + .3 * cos(t), -.3 * sin(t), i, n)]\n"
    "camera { from = <0, 3, 6>  to = <0, 0, 0>  fov = 22deg }\n";
#define BALL "mesh { positions = ball_points(12, 8, 1) triangles = around(12, 8, 9) crease = 180 %s } "
#define RING "mesh { positions = ring_points(12, 8) triangles = around(12, 8, 8) crease = 180 %s } "
#define LATHE "lathe { smooth = true profile = [for (i in 0..12) <sin(15 * i), -cos(15 * i)>] %s } "
enum { WIDTH = 48, PARTS = 12 };

/* What a white ball in a thin bundle of light sends to a point of the picture, by the normals that it is shaded with; < 0 beside
 * the ball, and where it is seen from far beside. */
static double lit(const Fixture *scene, HitList *hits, FilmPoint point, Vec3 to_light, double irradiance)
{
    const float middle[2] = {0.5f, 0.5f};
    Ray ray;
    Footprint footprint;
    if (!camera_ray(&scene->scene->cameras[0], point, middle, &ray, &footprint)) return -1;
    if (!rtc_nearest(scene->compiled->rtc, &ray, hits, NULL)) return -1;
    Vec3f normal = rtc_shading_normal(scene->compiled->rtc, &ray, hits->items);
    if (vec3f_dot(normal, ray.direction) > -0.2f) return -1;
    return irradiance / TRUTH_PI * fmax(vec3_dot(vec3_from_f(normal), to_light), 0);
}

/* The mean over a pixel; < 0: not of all of it. */
static double lit_pixel(const Fixture *scene, HitList *hits, uint32_t x, uint32_t y, Vec3 to_light, double irradiance)
{
    double sum = 0;
    for (int i = 0; i < PARTS * PARTS; i++) {
        FilmPoint point = {x + (i % PARTS + 0.5) / PARTS, y + (i / PARTS + 0.5) / PARTS, WIDTH, WIDTH};
        double part = lit(scene, hits, point, to_light, irradiance);
        if (part < 0) return -1;
        sum += part;
    }
    return sum / (PARTS * PARTS);
}

/* Lambert's cosine of the smooth normal, and nothing else: the body is convex, and nothing is around it. */
static void balls_are_lit_as_if_round(void **state)
{
    (void)state;
    static const char *const bodies[] = {BALL, LATHE};
    static const Vec3 lights[] = {{1, 0.2, -0.1}, {-0.6, 0.7, -0.5}, {0.3, -1, 0.1}, {0.02, 0.01, -0.2}};
    const double half_angle = 0.1 * TRUTH_PI / 180, irradiance = TRUTH_PI, radiance = 1 / pow(sin(half_angle), 2);
    for (size_t k = 0; k < COUNT_OF(bodies) * COUNT_OF(lights); k++) {
        char body[400], text[3000];
        Vec3 from = lights[k % COUNT_OF(lights)];
        truth_fill(body, sizeof body, bodies[k / COUNT_OF(lights)], "surface = surface { albedo = 1 }");
        snprintf(text, sizeof text,
                 "%s%s film { filter = box } light { shape = distant from = <%.17g, %.17g, %.17g> to = <0, 0, 0> "
                 "angle = .2deg radiance = %.17g }",
                 head, body, from.x, from.y, from.z, radiance);
        Fixture scene;
        Picture picture;
        HitList hits = {0};
        truth_open(&scene, (TruthInput){.text = text});
        RenderSettings settings = truth_settings(WIDTH, 64);
        truth_render(&scene, &settings, 0, &picture);
        double worst = 0;
        uint32_t n = 0;
        for (uint32_t y = 0; y < WIDTH; y++)
            for (uint32_t x = 0; x < WIDTH; x++) {
                double expected = lit_pixel(&scene, &hits, x, y, vec3_normalize(from), irradiance);
                if (expected < 0) continue;
                worst = fmax(worst, fabs(truth_luminance(&picture, x, y) - expected));
                n++;
            }
        printf("    body %zu, light %zu: of %u pixels none is more than %.4f off\n", k / COUNT_OF(lights),
               k % COUNT_OF(lights), n, worst);
        assert_true(n > WIDTH * WIDTH / 5);
        assert_true(worst < 0.004); /* by the facets it would be up to 0.18 */
        hit_list_clear(&hits);
        truth_clear(&picture);
        fixture_clear(&scene);
    }
}

static const char *const finishes[] = {
    "surface = surface { albedo = 1 }",
    "surface = surface { albedo = 1 diffuse_roughness = .7 }",
    "surface = surface { albedo = 1 ior = 1.5 roughness = .3 }",
    "surface = surface { albedo = 1 coat = .7 coat_roughness = .2 }",
    "surface = surface { albedo = 1 bump = noise { octaves = 2 scale(.2) } bump_height = .15 }",
};

static void white_furnaces(void **state)
{
    (void)state;
    static const char *const things[] = {
        BALL,
        RING,
        LATHE,
        BALL "plane { normal = y distance = -.97 surface = surface { albedo = 1 } } ",
        BALL "mesh { positions = ball_points(12, 8, 1.004) triangles = around(12, 8, 9) interior = water } ",
        BALL "sphere { radius = 1.3 interior = water } sphere { radius = 1.5 interior = glass } ",
    };
    double worst = 0;
    for (size_t i = 0; i < COUNT_OF(things); i++)
        for (size_t k = 0; k < COUNT_OF(finishes); k++) {
            char thing[1000], text[3000], what[140];
            truth_fill(thing, sizeof thing, things[i], finishes[k]);
            snprintf(text, sizeof text, "%s%s" TRUTH_WHITE_SKY, head, thing);
            snprintf(what, sizeof what, "thing %zu, finish %zu", i, k);
            worst = fmax(worst, fabs(truth_white(what, text, WIDTH, 64, 0.002) - 1));
        }
    printf("    at worst %.5f off\n", worst);
}

static Picture render(const char *text, uint32_t samples, bool by_chance)
{
    Fixture scene;
    Picture picture;
    truth_open(&scene, (TruthInput){.text = text});
    RenderSettings settings = truth_settings(WIDTH, samples);
    settings.by_chance = by_chance;
    truth_render(&scene, &settings, 0, &picture);
    assert_int_equal(picture.stats.nesting_faults, 0);
    fixture_clear(&scene);
    return picture;
}

/* A lamp close beside the ball, over a floor: by looking for it and by chance. */
static void lights_are_found_alike(void **state)
{
    (void)state;
    for (size_t k = 0; k < COUNT_OF(finishes); k++) {
        char ball[800], text[3000];
        Estimate seen[2];
        truth_fill(ball, sizeof ball, BALL, finishes[k]);
        snprintf(text, sizeof text,
                 "%s%s plane { normal = y distance = -1 surface = surface { albedo = .5 } } "
                 "light { from = <1.6, .3, -.5> to = <0, 0, 0> size = <1.5, 1.5> radiance = 1 }",
                 head, ball);
        for (int chance = 0; chance < 2; chance++) {
            Picture picture = render(text, chance ? 1024 : 128, chance);
            seen[chance] = truth_total(&picture);
            truth_clear(&picture);
        }
        truth_alike(finishes[k], seen[0], seen[1], 4, 0.01);
    }
}

/* A film that is thinner than the bulge absorbs light on its way in, and on most of its way out: nearly as much as on a ball that
 * is flat between its edges. No surface is jumped over, which would be a fault of nesting. */
static void films_absorb(void **state)
{
    (void)state;
    double mean[2];
    for (int smooth = 0; smooth < 2; smooth++) {
        char text[3000];
        snprintf(text, sizeof text,
                 "%s mesh { positions = ball_points(12, 8, 1) triangles = around(12, 8, 9) %s "
                 "surface = surface { albedo = 1 } } "
                 "mesh { positions = ball_points(12, 8, 1.004) triangles = around(12, 8, 9) interior = ink } "
                 "light { shape = distant from = <0, 3, 6> to = <0, 0, 0> angle = 60deg radiance = 1 }",
                 head, smooth ? "crease = 180" : "");
        Picture picture = render(text, 64, false);
        mean[smooth] = truth_total(&picture).mean;
        truth_clear(&picture);
    }
    truth_figure("light of a ball under ink, over that of a flat one", 1, mean[1] / mean[0], 0);
    assert_true(fabs(mean[1] / mean[0] - 1) < 0.08);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(balls_are_lit_as_if_round),
        cmocka_unit_test(white_furnaces),
        cmocka_unit_test(lights_are_found_alike),
        cmocka_unit_test(films_absorb),
    };
    return cmocka_run_group_tests_name("terminator", tests, NULL, NULL);
}
