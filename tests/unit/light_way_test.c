/* light_way_test.c - where rays of light go: angles, parts and lengths in closed form, ways that part carry all of the light
 * together, and what is nested, silent, thin, mirrored or rough is met as paths meet it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/angle.h"
#include "near.h"
#include "optics/fresnel.h"
#include "scene_fixture.h"
#include "trace/light_way.h"

/* Of floats, too. */
#define assert_same(actual, expected, tolerance) assert_near((double)(actual), (double)(expected), tolerance)

typedef struct Followed {
    Fixture fixture;
    World world;
    LightWays ways;
} Followed;

static void follow(Followed *f, const char *text, Vec3 from, Vec3 along, float least)
{
    fixture_compile(&f->fixture, text, 1);
    assert_int_equal(world_init(&f->world, f->fixture.compiled, 0, 32, false, NULL, &f->fixture.error), STATUS_OK);
    Ray ray = ray_make(from, vec3f_from(vec3_normalize(along)));
    Status status = light_ways_find(&f->world, &ray, 589.3f, least, &f->ways, &f->fixture.error);
    if (status != STATUS_OK) fail_msg("%s", f->fixture.error.text);
}

static void end(Followed *f)
{
    light_ways_clear(&f->ways);
    world_clear(&f->world);
    fixture_clear(&f->fixture);
}

static const LightStep *step(const Followed *f, uint32_t way, uint32_t k)
{
    const LightWay *own = &f->ways.ways[way];
    assert_true(k >= own->depth && k < own->depth + own->n);
    return &f->ways.steps[own->first + k - own->depth];
}

static const LightStep *last(const Followed *f, uint32_t way)
{
    return step(f, way, f->ways.ways[way].depth + f->ways.ways[way].n - 1);
}

static const char *name_of(const Followed *f, const LightStep *at)
{
    return f->fixture.scene->objects[at->object].name;
}

/* What leaves, over all ways. */
static double all_that_leaves(const Followed *f)
{
    double sum = 0;
    for (uint32_t w = 0; w < f->ways.n_ways; w++)
        if (last(f, w)->turn == LIGHT_LEAVES) sum += (double)last(f, w)->carried;
    return sum;
}

/* Calcite with its axis at 45 degrees to its faces, head on: two waves of nearly as much light, of which one walks off by 6.22 degrees.
 * What they leave together is all that came. */
static void through_a_crystal(void **state)
{
    (void)state;
    Followed f;
    const double o = 1.6584, e = 1.4864, thick = 10, off = atan((o * o - e * e) / (o * o + e * e));
    follow(&f,
           "meniscus 1.0 unit mm medium calcite { ior = 1.6584 extraordinary_ior = 1.4864 optic_axis = <1, 1, 0> }"
           "box plate { interior = calcite from = <0, -90, -90> to = <10, 90, 90> }" FIXTURE_VIEW,
           vec3(-20, 0, 0), vec3(1, 0, 0), 1e-4f);
    for (uint32_t way = 0; way < 2; way++) {
        const LightStep *in = step(&f, way, 0), *out = step(&f, way, 1);
        const bool extraordinary = in->wave == CRYSTAL_EXTRAORDINARY;
        assert_true(extraordinary == (way == 0)); /* its index is less, and so what is mirrored */
        const double index = extraordinary ? sqrt(2 / (1 / (o * o) + 1 / (e * e))) : o, r = (index - 1) / (index + 1);
        assert_same(in->part, (1 - r * r) / 2, 1e-6);
        assert_same(out->place.y, extraordinary ? -thick * tan(off) : 0, 1e-4);
        assert_same(out->length, extraordinary ? thick / cos(off) : thick, 1e-4);
        assert_same(f.ways.ways[way].optical, 20 + index * thick, 1e-3); /* the phase is the same all over the plate */
        assert_same(last(&f, way)->direction.x, 1, 1e-6);
    }
    assert_same(all_that_leaves(&f), 1, 1e-3);
    end(&f);
}

/* A sheet that is seen nowhere leaves both waves as they are: each leaves the crystal straight on. */
static void through_a_sheet_in_a_crystal(void **state)
{
    (void)state;
    Followed f;
    follow(
        &f,
        "meniscus 1.0 unit mm medium calcite { ior = 1.6584 extraordinary_ior = 1.4864 optic_axis = <1, 1, 0> }"
        "box plate { interior = calcite from = <0, -90, -90> to = <10, 90, 90> }"
        "box sheet { from = <4, -80, -80> to = <14, 80, 80> surface = surface { thin = true ior = 1 transmission = 1 "
        "specular = 0 } }" FIXTURE_VIEW,
        vec3(-20, 0, 0), vec3(1, 0, 0), 1e-4f);
    for (uint32_t way = 0; way < 2; way++) {
        assert_int_equal(step(&f, way, 1)->wave, step(&f, way, 0)->wave);
        assert_int_not_equal(step(&f, way, 1)->wave, CRYSTAL_UNPOLARIZED);
        assert_int_equal(last(&f, way)->turn, LIGHT_LEAVES);
        assert_same(last(&f, way)->direction.x, 1, 1e-6);
    }
    end(&f);
}

/* A plate, at 30 degrees. */
static void through_a_plate(void **state)
{
    (void)state;
    Followed f;
    const double i = asin(.5), r = asin(.5 / 1.5), thick = 10;
    follow(&f, FIXTURE_MEDIA "box pane { interior = glass from = <0, -90, -90> to = <10, 90, 90> }" FIXTURE_VIEW,
           vec3(-20, 0, 0), vec3(cos(i), .5, 0), .001f);
    const LightStep *in = step(&f, 0, 0), *out = step(&f, 0, 1), *on = step(&f, 0, 2);
    float reflects = fresnel_dielectric((float)cos(i), 1, 1.5f);
    assert_int_equal(in->turn, LIGHT_PASSES);
    assert_string_equal(name_of(&f, in), "pane");
    assert_same(in->length, 20 / cos(i), 1e-5);
    assert_same(in->angle, i, 1e-6);
    assert_same(in->on, r, 1e-6);
    assert_same(in->mirrored, reflects, 1e-6);
    assert_same(in->transmitted, 1 - reflects, 1e-6);
    assert_same(out->length, thick / cos(r), 1e-5);
    assert_same(out->index, 1.5, 1e-6);
    assert_same(out->angle, r, 1e-6);
    assert_same(out->on, i, 1e-6);
    assert_same(out->place.y, 20 * tan(i) + thick * tan(r), 1e-5);
    assert_same(out->carried, 1 - reflects, 1e-6);
    assert_int_equal(on->turn, LIGHT_LEAVES);
    assert_same(on->carried, (1 - reflects) * (1 - reflects), 1e-6);
    assert_same(f.ways.ways[0].optical, 20 / cos(i) + 1.5 * thick / cos(r), 1e-4);
    assert_same(vec3_angle(vec3_from_f(on->direction), vec3(cos(i), .5, 0)), 0, 1e-6);
    /* twice mirrored within: .043 squared of what came in leaves again, in parallel */
    bool found = false;
    for (uint32_t w = 1; w < f.ways.n_ways; w++) {
        const LightStep *end_of_way = last(&f, w);
        if (f.ways.ways[w].depth + f.ways.ways[w].n != 5) continue;
        found = true;
        assert_same(end_of_way->carried, pow(1 - (double)reflects, 2) * pow(reflects, 2), 1e-6);
        assert_same(vec3_angle(vec3_from_f(end_of_way->direction), vec3(cos(i), .5, 0)), 0, 1e-6);
    }
    assert_true(found);
    end(&f);
}

/* The least deviation of the first rainbow: D = 180 + 2 i - 4 r at cos^2 i = (n^2 - 1) / 3 (Descartes). */
static void bow_of_a_drop(void **state)
{
    (void)state;
    Followed f;
    const double n = 1.33, i = acos(sqrt((n * n - 1) / 3)), r = asin(sin(i) / n);
    follow(&f, FIXTURE_MEDIA "sphere { interior = water radius = 10 }" FIXTURE_VIEW, vec3(-30, 10 * sin(i), 0),
           vec3(1, 0, 0), .01f);
    bool found = false;
    for (uint32_t w = 0; w < f.ways.n_ways; w++) {
        if (f.ways.ways[w].depth != 1) continue;
        found = true;
        assert_same(vec3_angle(vec3_from_f(last(&f, w)->direction), vec3(1, 0, 0)), MEN_PI + 2 * i - 4 * r, 1e-5);
        double reflects = (double)fresnel_dielectric((float)cos(i), 1, (float)n);
        assert_same(last(&f, w)->carried, pow(1 - reflects, 2) * reflects, 1e-5);
    }
    assert_true(found);
    end(&f);
}

/* Nothing absorbs: what leaves is all, but for what parts that are too weak to be followed have; of each way to there is one. */
static void ways_carry_all(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        FIXTURE_MEDIA "sphere { interior = glass radius = 10 } sphere { interior = gas center = <2, 1, 0> radius = 4 } "
                      "box { interior = water from = <3, -20, -20> to = <30, 20, 20> }" FIXTURE_VIEW,
        FIXTURE_MEDIA
        "difference { interior = glass box { from = <-9, -9, -9> to = <9, 9, 9> } sphere { center = <9, 3, 0> "
        "radius = 6 } }" FIXTURE_VIEW};
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Followed f;
        follow(&f, scenes[i], vec3(-30, 1.5, .7), vec3(1, .05, .02), 1e-6f);
        double sum = all_that_leaves(&f);
        print_message("%u ways, together %.7f\n", (unsigned)f.ways.n_ways, sum);
        assert_true(!f.ways.cut && f.ways.n_ways > 5);
        assert_same(sum, 1, 2e-4);
        end(&f);
    }
}

/* Water reaches into glass, ice into water: the hidden surfaces are no steps, and the boundaries are between what is on top. */
static void hidden_surfaces_are_none(void **state)
{
    (void)state;
    Followed f;
    follow(&f,
           FIXTURE_MEDIA "box wall { interior = glass from = <0, -90, -90> to = <5, 90, 90> }"
                         "box drink { interior = water from = <2, -80, -80> to = <40, 80, 80> }"
                         "box cube { interior = ice from = <30, -70, -70> to = <50, 70, 70> }" FIXTURE_VIEW,
           vec3(-10, 0, 0), vec3(1, 0, 0), 1);
    static const struct {
        const char *object, *medium, *to;
        double length;
    } expected[] = {{"wall", "vacuum", "glass", 10},
                    {"wall", "glass", "water", 5},
                    {"cube", "water", "ice", 25},
                    {"cube", "ice", "vacuum", 20}};
    assert_int_equal(f.ways.n_ways, 1);
    assert_int_equal(f.ways.ways[0].n, COUNT_OF(expected) + 1);
    for (uint32_t k = 0; k < COUNT_OF(expected); k++) {
        const LightStep *at = step(&f, 0, k);
        const SceneMedium *media = f.fixture.scene->media;
        assert_string_equal(name_of(&f, at), expected[k].object);
        assert_same(at->length, expected[k].length, 1e-6);
        if (k > 0) assert_string_equal(media[at->medium].name, expected[k].medium);
        if (k + 1 < COUNT_OF(expected)) assert_string_equal(media[at->to].name, expected[k].to);
    }
    end(&f);
}

/* Beyond the critical angle all is mirrored; for ever in a loop of three mirrors would be too long. */
static void total_reflection(void **state)
{
    (void)state;
    Followed f;
    follow(&f, FIXTURE_MEDIA "box guide { interior = glass from = <0, -2, -2> to = <400, 2, 2> }" FIXTURE_VIEW,
           vec3(-1, .3, 0), vec3(1, .5, 0), .5f);
    uint32_t n = 0;
    for (uint32_t k = 0; k < f.ways.ways[0].n; k++) n += step(&f, 0, k)->turn == LIGHT_TOTAL;
    double r = asin(sin(atan(.5)) / 1.5), height = 2 - (.3 + .5); /* from where it enters up to the top */
    assert_int_equal(n, (int)((400 * tan(r) - height) / 4) + 1);
    assert_int_equal(last(&f, 0)->turn, LIGHT_LEAVES);
    end(&f);
    /* a corner of total reflections sends it round for ever */
    follow(&f,
           FIXTURE_MEDIA
           "medium dense { ior = 3 } box cage { interior = dense from = <-5, -5, -5> to = <5, 5, 5> }" FIXTURE_VIEW,
           vec3(0, .1, .3), vec3(1, .8, .9), .5f);
    assert_int_equal(last(&f, 0)->turn, LIGHT_DROPPED);
    assert_int_equal(f.ways.ways[0].n, LIGHT_STEPS + 1);
    end(&f);
}

/* A sheet on water, a mirror below, and a matte floor: each does what it does. */
static void sheets_and_mirrors(void **state)
{
    (void)state;
    Followed f;
    follow(&f,
           FIXTURE_MEDIA
           "box pond { interior = water from = <-90, -20, -90> to = <90, 0, 90> }"
           "plane { distance = 5 surface = surface { thin = true transmission = 1 ior = 1.5 roughness "
           "= 0 } }"
           "box mirror { from = <-20, -11, -20> to = <20, -10, 20> surface = surface { metalness = 1 albedo = .5 "
           "roughness = 0 } }"
           "box floor { from = <-200, -40, -200> to = <200, -30, 200> surface = surface { albedo = .5 } }" FIXTURE_VIEW,
           vec3(3, 20, 0), vec3(0, -1, 0), .2f);
    const LightStep *sheet = step(&f, 0, 0), *water = step(&f, 0, 1), *mirror = step(&f, 0, 2);
    double once = .04, all = 2 * once / (1 + once); /* all reflections between both sides of a sheet */
    assert_int_equal(sheet->turn, LIGHT_PASSES);
    assert_same(sheet->transmitted, 1 - all, 2.5e-4);
    assert_same(sheet->mirrored, all, 2.5e-4);
    assert_int_equal(water->turn, LIGHT_PASSES);
    assert_string_equal(name_of(&f, mirror), "mirror");
    assert_int_equal(mirror->turn, LIGHT_MIRRORED);
    assert_same(mirror->mirrored, .5, .01);
    assert_int_equal(last(&f, 0)->turn, LIGHT_LEAVES);
    assert_same(last(&f, 0)->direction.y, 1, 1e-6);
    end(&f);
    follow(&f,
           FIXTURE_MEDIA
           "box floor { from = <-9, -9, -9> to = <9, 0, 9> surface = surface { albedo = .5 } }" FIXTURE_VIEW,
           vec3(0, 7, 0), vec3(0, -1, 0), .2f);
    assert_int_equal(f.ways.ways[0].n, 1);
    assert_int_equal(step(&f, 0, 0)->turn, LIGHT_ENDS);
    assert_same(step(&f, 0, 0)->length, 7, 1e-6);
    end(&f);
}

/* Frost scatters around the way that a smooth boundary has, and lets through about as much; absorption is Beer's. */
static void frost_and_tint(void **state)
{
    (void)state;
    Followed f;
    follow(&f,
           FIXTURE_MEDIA
           "medium ink { ior = 1 absorption = .05 } "
           "box pane { interior = glass from = <0, -90, -90> to = <10, 90, 90> surface = surface { roughness = .2 } }"
           "box { interior = ink from = <20, -90, -90> to = <60, 90, 90> }" FIXTURE_VIEW,
           vec3(-20, 0, 0), vec3(1, .1, 0), .9f);
    const LightStep *in = step(&f, 0, 0);
    assert_true(in->scatters && step(&f, 0, 1)->scatters);
    assert_same(in->transmitted, .96, .003);
    assert_same(in->transmitted + in->mirrored, 1, .003);
    double cosine = 1 / sqrt(1.01), left = (double)in->transmitted * (double)step(&f, 0, 1)->transmitted;
    assert_same(last(&f, 0)->carried, left * exp(-.05 * 40 / cosine), 1e-4);
    end(&f);
}

/* A face that rises by a fifth, clear and half painted: the angle is to where it leans, once. */
static void relief_leans_once(void **state)
{
    (void)state;
    static const char *const paints[] = {"", " transmission = .5"};
    for (int i = 0; i < 2; i++) {
        Followed f;
        char text[1000];
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "box { interior = glass from = <-9, -9, -9> to = <9, 9, 0> surface = surface { "
                 "bump = gradient { wave = once scale(40) translate(<-20, 0, 0>) } bump_height = 8%s } }" FIXTURE_VIEW,
                 paints[i]);
        follow(&f, text, vec3(1, 2, 20), vec3(0, 0, -1), .6f);
        assert_same(step(&f, 0, 0)->angle, atan(.2), 2e-3);
        assert_same(step(&f, 0, 0)->on, asin(sin(atan(.2)) / 1.5), 2e-3);
        end(&f);
    }
}

static void no_ray_starts_on_a_surface(void **state)
{
    (void)state;
    Fixture fixture;
    World world;
    LightWays ways;
    fixture_compile(&fixture,
                    FIXTURE_MEDIA "box pane { interior = glass from = <0, -9, -9> to = <9, 9, 9> }" FIXTURE_VIEW, 1);
    assert_int_equal(world_init(&world, fixture.compiled, 0, 32, false, NULL, &fixture.error), STATUS_OK);
    Ray ray = ray_make(vec3(0, 1, 1), vec3f(1, 0, 0));
    assert_int_equal(light_ways_find(&world, &ray, 589.3f, .1f, &ways, &fixture.error), STATUS_USAGE);
    assert_non_null(strstr(fixture.error.text, "one of 'pane'"));
    light_ways_clear(&ways);
    world_clear(&world);
    fixture_clear(&fixture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(through_a_crystal),
                                       cmocka_unit_test(through_a_sheet_in_a_crystal),
                                       cmocka_unit_test(through_a_plate),
                                       cmocka_unit_test(bow_of_a_drop),
                                       cmocka_unit_test(ways_carry_all),
                                       cmocka_unit_test(hidden_surfaces_are_none),
                                       cmocka_unit_test(total_reflection),
                                       cmocka_unit_test(sheets_and_mirrors),
                                       cmocka_unit_test(frost_and_tint),
                                       cmocka_unit_test(relief_leans_once),
                                       cmocka_unit_test(no_ray_starts_on_a_surface)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
