/* furnace_test.c - inside a closed uniform environment of radiance 1, clear media that do not absorb cannot be seen:
 * every pixel is 1, whatever lies in what, and whichever policy says so (a boundary reflects R and lets 1 - R through,
 * and basic radiance is the same on both sides).
 *
 * Where no index depends on the wavelength a path carries exactly what it started with, so that the picture must be that
 * of the empty scene with the same seed, up to rounding: a single path lost or counted twice shows.
 * SPDX-License-Identifier: Apache-2.0 */
#include <glob.h>

#include "arrangements.h"
#include "truth.h"

static const NestPolicy policies[] = {NEST_AUTOMATIC, NEST_PRIORITY, NEST_ENTERED, NEST_NONE};
enum { WIDTH = 32, WIDTH_OF_FILES = 22, SAMPLES = 256, SAMPLES_DISPERSIVE = 512, SAMPLES_NOISY = 96 };
/* Light that total reflection keeps in a glass leaves after thousands of boundaries, one path in a million after more than a hundred
 * thousand, but it leaves. By other policies some never does: what it is in depends on the way it came. */
enum { BOUNCES = 1000000, BOUNCES_BY_OTHERS = 50000 };

static FaultCount in_all;

static bool disperses(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_objects; i++)
        if (scene->objects[i].medium != SCENE_NONE && scene->media[scene->objects[i].medium].disperses) return true;
    return false;
}

/* Media that scatter and boundaries that are rough find the furnace in two ways, weighted against each other: only the
 * expectation is 1. What many facets throw at each other is kept to within 0.5 %. */
static bool is_noisy(const Scene *scene)
{
    for (uint32_t i = 0; i < scene->n_objects; i++) {
        const SceneObject *object = &scene->objects[i];
        if (object->medium != SCENE_NONE && scene->media[object->medium].scatters) return true;
        if (object->medium != SCENE_NONE && object->surface != SCENE_NONE) return true;
    }
    return false;
}

/* Of all pixels: distance from 1 in the pixel's own standard errors. */
static double worst_pixel(const Picture *picture)
{
    double worst = 0;
    for (uint32_t y = 0; y < picture->image.height; y++)
        for (uint32_t x = 0; x < picture->image.width; x++)
            worst = fmax(worst, fabs(truth_luminance(picture, x, y) - 1) / truth_film_error(picture, x, y));
    return worst;
}

/* What was furthest from the truth in one scene, under any policy. */
typedef struct Worst {
    Estimate mean;
    double pixel;      /* in its own standard errors */
    double difference; /* from the empty scene; < 0: not to be compared, as something disperses */
    FaultCount faults;
} Worst;

static void expect_furnace(const char *what, const Fixture *scene, uint32_t width, Worst *worst)
{
    bool spread = disperses(scene->scene), noisy = is_noisy(scene->scene);
    RenderSettings settings = truth_settings(width, noisy ? SAMPLES_NOISY : spread ? SAMPLES_DISPERSIVE : SAMPLES);
    settings.no_absorption = true;
    settings.bounces = scene->compiled->order.policy == NEST_AUTOMATIC ? BOUNCES : BOUNCES_BY_OTHERS;
    Picture picture;
    truth_render(scene, &settings, 0, &picture);
    truth_count(&worst->faults, &picture.stats);
    Estimate mean = truth_mean(&picture, -1);
    truth_check(what, 1, mean, 4, noisy ? 0.002 : 0.00025);
    double bound = noisy ? 0.005 : 0.001;
    if (!(fabs(mean.mean - 1) <= bound)) fail_msg("%s: %.9g is not within %g of 1", what, mean.mean, bound);
    if (fabs(mean.mean - 1) >= fabs(worst->mean.mean - 1)) worst->mean = mean;
    double pixel = worst_pixel(&picture);
    if (!(pixel <= 5)) fail_msg("%s: a pixel is %.2f of its standard errors from 1", what, pixel);
    worst->pixel = fmax(worst->pixel, pixel);
    if (!spread && !noisy) {
        double difference = truth_difference_from_empty(&settings, &picture);
        /* One path of the pixel's is worth 1 / SAMPLES. Without nesting a path may come into total reflections that it never
         * gets out of: what it is taken to be in depends on the way it came. */
        double most = scene->compiled->order.policy == NEST_NONE ? 2.0 / SAMPLES : 1e-5;
        if (!(difference <= most)) fail_msg("%s: a pixel is %g from the empty scene", what, difference);
        worst->difference = fmax(worst->difference, difference);
    }
    truth_clear(&picture);
}

/* A camera inside of a block can look along light that total reflection keeps in there for ever, where no furnace
 * shines. What is seen from outside came in from outside. */
static void step_outside(Fixture *scene)
{
    HitList hits = {0};
    NestList list;
    SceneCamera *camera = &scene->scene->cameras[0];
    nest_list_init(&list);
    assert_int_equal(compiled_interior(scene->compiled, vec3f_from(camera->from), 0, &hits, &list, NULL), STATUS_OK);
    bool inside = nest_list_count(&list) > 0;
    nest_list_clear(&list);
    hit_list_clear(&hits);
    if (!inside) return;
    Box3 bounds = rtc_scene_bounds(scene->compiled->rtc);
    Vec3 middle = vec3_scale(vec3_add(bounds.min, bounds.max), 0.5);
    camera->from = vec3_along(middle, -vec3_length(vec3_sub(bounds.max, bounds.min)), camera->forward);
    camera->lens_radius = 0;
    camera->projection = PROJECTION_PERSPECTIVE;
    camera->half_width = 0.4;
}

/* One scene under every policy. Faults are judged at the end, when all are known. */
static void expect_furnaces(const char *name, TruthInput input)
{
    Worst worst = {.mean = {1, 0}, .difference = -1};
    Fixture scene;
    input.furnace = true;
    for (size_t i = 0; i < COUNT_OF(policies); i++) {
        char what[160];
        input.policy = policies[i];
        if (i == 0)
            truth_open(&scene, input);
        else
            truth_compile_again(&scene, &input);
        if (input.file) step_outside(&scene);
        snprintf(what, sizeof what, "%s, %s", name, nest_policy_text(policies[i]));
        expect_furnace(what, &scene, input.file ? WIDTH_OF_FILES : WIDTH, &worst);
    }
    fixture_clear(&scene);
    truth_add(&in_all, &worst.faults);
    truth_figure(name, 1, worst.mean.mean, worst.mean.error);
    printf("    worst pixel %.2f of its errors; ", worst.pixel);
    if (worst.difference >= 0) printf("%.1g from the empty scene; ", worst.difference);
    printf("%llu faults in %.3f million crossings\n", (unsigned long long)worst.faults.faults,
           (double)worst.faults.crossings * 1e-6);
}

static void arrangements_are_furnaces(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(arrangements); i++)
        if (!arrangements[i].fits) expect_furnaces(arrangements[i].name, (TruthInput){.text = arrangements[i].text});
}

/* Neighbours that overlap, that touch, and that leave gaps. */
static void modelling_schemes_are_furnaces(void **state)
{
    (void)state;
    for (size_t i = 0; i < COUNT_OF(arrangements); i++)
        for (size_t k = 0; arrangements[i].fits && k < COUNT_OF(arrangement_fits); k++) {
            char name[100];
            const char *defines[] = {arrangement_fits[k], NULL};
            snprintf(name, sizeof name, "%s, %s", arrangements[i].name, arrangement_fits[k]);
            expect_furnaces(name, (TruthInput){.text = arrangements[i].text, .defines = defines});
        }
}

static void examples_are_furnaces(void **state)
{
    (void)state;
    glob_t found;
    assert_int_equal(glob("examples/*.mns", 0, NULL, &found), 0);
    size_t n = 0;
    for (size_t i = 0; i < found.gl_pathc; i++) {
        if (truth_is_library(found.gl_pathv[i])) continue;
        expect_furnaces(found.gl_pathv[i], (TruthInput){.file = found.gl_pathv[i]});
        n++;
    }
    globfree(&found);
    assert_true(n > 0);
}

/* Rays that creep over water, or below it, meet ripples as fine as the rounding of coordinates several times at one place: what is
 * mirrored by one of them starts at another. */
static void ripples_are_furnaces(void **state)
{
    (void)state;
    static const char *const eyes[] = {"eye=.3", "eye=.1", "eye=-.2"};
    const char *text = "meniscus 1.0 unit cm param eye = 0 medium water { ior = 1.333 state = liquid } "
                       "height_field { interior = water size = <8, 1, 32> base = -400 translate(<-4, 0, -400>) "
                       "heights = [for (k in 0..<160) [for (i in 0..<40) 5e-4 * rnd(1, i, k)]] } "
                       "camera { from = <0, eye, (eye < 0 ? -369 : 0)> to = <0, 0, -384> fov = (eye < 0 ? 4 : .5) }";
    for (size_t i = 0; i < COUNT_OF(eyes); i++) {
        char name[80];
        snprintf(name, sizeof name, "ripples as fine as rounding, %s cm", eyes[i]);
        expect_furnaces(name, (TruthInput){.text = text, .defines = (const char *[]){eyes[i], NULL}});
    }
}

/* What comes in goes round by total reflection, thousands of times, and leaves: from a long gem, when it comes to a block of ice that
 * cuts into it; from a ball that two of facets fill, when it comes to one that is tilted enough. Chance ends some of it, and makes up
 * for that in what is left: all is there that is there when chance ends none. */
static void long_ways_are_as_bright(void **state)
{
    (void)state;
    enum { WIDE = 64, MANY = 1024 };
    static const char *const texts[] = {
        "meniscus 1.0 unit cm medium ice { ior = 1.31 state = solid } medium gem { ior = 2.4 state = solid } "
        "capsule { interior = gem from = <-4, 5, 6> to = <1, 4, -2> radius = 2 rotate(y, 45) } "
        "box { interior = ice from = <-3, 2, 0> to = <-2, 7, 2> } "
        "camera { from = <-9.8, 12, 30> to = <0, 3, 0> fov = 16 }",
        "meniscus 1.0 unit cm medium glass { ior = 1.52 state = solid } "
        "medium water { ior = 1.33 state = liquid } medium oil { ior = 1.47 state = liquid } "
        "let points = [<0, 1, 0>, for (j in 1..15) for (i in 0..23) let (a = 180 * j / 16, b = 15 * i) "
        "              <sin(a) * cos(b), cos(a), sin(a) * sin(b)>, <0, -1, 0>] "
        "let faces = [for (i in 0..23) <0, 1 + (i + 1) % 24, 1 + i>, "
        "             for (j in 0..13) for (i in 0..23) for (t in [0, 1]) "
        "             let (a = 1 + 24 * j + i, b = 1 + 24 * j + (i + 1) % 24) t == 0 ? <a, b, a + 24> : <b, b + 24, a "
        "+ 24>, "
        "             for (i in 0..23) <361, 337 + i, 337 + (i + 1) % 24>] "
        "mesh { interior = water positions = points triangles = faces } "
        "mesh { interior = oil positions = points triangles = faces } sphere { interior = glass radius = 1 } "
        "camera { from = <3, 2.2, 5> to = <0, 0, 0> fov = 24 }"};
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        Fixture scene;
        Picture picture;
        truth_open(&scene, (TruthInput){.text = texts[i], .furnace = true});
        RenderSettings settings = truth_settings(WIDE, MANY);
        settings.bounces = scene.scene->render.bounces;
        truth_render(&scene, &settings, 0, &picture);
        Estimate mean = truth_mean(&picture, -1);
        printf("    light that goes round: 1 %+.2g, standard error %.2g\n", mean.mean - 1, mean.error);
        assert_near(mean.mean, 1, 4 * mean.error);
        assert_true(mean.error < 5e-5);
        truth_count(&in_all, &picture.stats);
        truth_clear(&picture);
        fixture_clear(&scene);
    }
}

/* Smooth normals of coarse triangles are those of no surface: what they reflect totally again and again was held for ever, and the rim of
 * such a ball was as dark as 0.66, all of it 0.987, 0.994 and 0.997. */
static void coarse_smooth_balls_let_light_out(void **state)
{
    (void)state;
    const struct {
        int around, down;
        double bound;
    } cases[] = {{8, 4, 0.001}, {12, 6, 0.002}, {24, 12, 0.0006}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[1200], name[80];
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit cm medium glass { ior = 1.5 state = solid } let n = %d let m = %d "
            "let points = [<0, 1, 0>, for (j in 1..<m) for (i in 0..<n) let (a = 180 * j / m, b = 360 * i / n) "
            "              <sin(a) * cos(b), cos(a), sin(a) * sin(b)>, <0, -1, 0>] "
            "let faces = [for (i in 0..<n) <0, 1 + (i + 1) %% n, 1 + i>, "
            "             for (j in 0..<m - 2) for (i in 0..<n) for (t in [0, 1]) "
            "             let (a = 1 + n * j + i, b = 1 + n * j + (i + 1) %% n) "
            "             t == 0 ? <a, b, a + n> : <b, b + n, a + n>, "
            "             for (i in 0..<n) <len(points) - 1, 1 + n * (m - 2) + i, 1 + n * (m - 2) + (i + 1) %% n>] "
            "mesh { interior = glass positions = points triangles = faces crease = 120 } environment { color = 1 } "
            "camera { from = <0, .5, 4> to = <0, 0, 0> fov = 30 }",
            cases[i].around, cases[i].down);
        snprintf(name, sizeof name, "a smooth ball of %d by %d faces", cases[i].around, cases[i].down);
        (void)truth_white(name, text, WIDTH, SAMPLES / 4, cases[i].bound);
    }
}

static void faults_are_none_in_ten_million_crossings(void **state)
{
    (void)state;
    truth_print_faults("all furnaces together", &in_all);
    assert_true(in_all.crossings >= 10000000);
    assert_int_equal(in_all.faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arrangements_are_furnaces),
        cmocka_unit_test(modelling_schemes_are_furnaces),
        cmocka_unit_test(examples_are_furnaces),
        cmocka_unit_test(ripples_are_furnaces),
        cmocka_unit_test(long_ways_are_as_bright),
        cmocka_unit_test(coarse_smooth_balls_let_light_out),
        cmocka_unit_test(faults_are_none_in_ten_million_crossings),
    };
    return cmocka_run_group_tests_name("furnace", tests, NULL, NULL);
}
