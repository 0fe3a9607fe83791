/* texture_test.c - textures of scenes: which way up pictures are on each shape, what moves with what, what is refused.
 * What a camera's ray sees is asked for as the albedo of the first sight, which has no noise.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "base/attr.h"
#include "near.h"
#include "scene_fixture.h"
#include "trace/path.h"

/* Pictures by name. "corners": 2 by 2, red and green above, blue and white below, in halves. "number": one pixel of the
 * number behind it. */
static Status load(void *context, const char *path, const char *space, float **rgb, uint32_t *width, uint32_t *height,
                   Error *error)
{
    (void)context;
    static const float corners[12] = {.5f, .1f, .1f, .1f, .5f, .1f, .1f, .1f, .5f, .5f, .5f, .5f};
    const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    if (space && strcmp(space, "nowhere") == 0) return (fail)(error, STATUS_INPUT, "no colour space 'nowhere'");
    bool is_corners = strcmp(name, "texture_test.c") == 0;
    uint32_t side = is_corners ? 2 : 1;
    *rgb = malloc(12 * sizeof **rgb);
    if (!*rgb) return (fail)(error, STATUS_NOMEM, "out of memory");
    memcpy(*rgb, corners, sizeof corners);
    if (!is_corners)
        for (int i = 0; i < 3; i++) (*rgb)[i] = *(const float *)context;
    *width = *height = side;
    return STATUS_OK;
}

/* Any file that is surely there: it is the loader that says what it shows. */
#define CORNERS "file = \"" __FILE__ "\""
#define NUMBER "file = \"tests/unit/test.h\""

static void build(Fixture *f, const char *text, float number)
{
    static float kept;
    kept = number;
    SceneOptions options = {.eval = {.frames = 1, .frame = 1}, .load_image = load, .load_image_context = &kept};
    fixture_build(f, text, &options);
}

static Vec3f seen_normal;

static void see(Fixture *f, float albedo[3])
{
    Error error;
    World world;
    Tracer tracer;
    float rgb[3], alpha;
    assert_int_equal(compile_scene(f->scene, f->scene->render.nesting, NULL, &f->diag, &f->compiled, &error),
                     STATUS_OK);
    assert_int_equal(world_init(&world, f->compiled, 0, 4, false, NULL, &error), STATUS_OK);
    tracer_init(&tracer, &world);
    tracer.notes_sight = true;
    const FilmSample sample = {.x = 50, .y = 50, .width = 101, .height = 101};
    trace_sample(&tracer, &sample, rgb, &alpha);
    const FirstSight *sight = &tracer.first_sight;
    assert_true(sight->met);
    memcpy(albedo, sight->albedo, sizeof sight->albedo);
    seen_normal = sight->normal;
    tracer_clear(&tracer);
    world_clear(&world);
}

/* The albedo at the middle of a narrow view from one point to another. */
static void look(const char *things, const char *from, const char *to, float number, float albedo[3])
{
    Fixture f;
    char text[3000];
    snprintf(text, sizeof text,
             "meniscus 1.0 unit mm %s camera { from = %s to = %s up = <.001, 1, .002> fov = .01 } environment { }",
             things, from, to);
    build(&f, text, number);
    if (f.status != STATUS_OK) {
        fixture_print(&f);
        fail_msg("%s", text);
    }
    see(&f, albedo);
    fixture_clear(&f);
}

static double tolerance = 0.008;

static void expect(const char *things, const char *from, const char *to, double r, double g, double b)
{
    float albedo[3];
    look(things, from, to, 0.5f, albedo);
    const double wanted[3] = {r, g, b};
    for (int c = 0; c < 3; c++)
        if (!(fabs((double)albedo[c] - wanted[c]) <= tolerance))
            fail_msg("%s\nfrom %s to %s: <%.3f, %.3f, %.3f>, not <%.3f, %.3f, %.3f>", things, from, to,
                     (double)albedo[0], (double)albedo[1], (double)albedo[2], r, g, b);
}

#define ON(shape, picture) shape " surface = surface { albedo = image { " CORNERS " " picture " } } }"
#define RED .5, .1, .1
#define GREEN .1, .5, .1
#define BLUE .1, .1, .5
#define WHITE .5, .5, .5

/* Seen from in front, with y up, a picture's top left is at the left and above. */
static void pictures_are_upright(void **state)
{
    (void)state;
    static const char *const planar = ON("box { from = <0, 0, 0> to = <1, 1, 1>", "projection = planar wrap = clamp");
    expect(planar, "<.25, .75, 9>", "<.25, .75, 0>", RED);
    expect(planar, "<.75, .75, 9>", "<.75, .75, 0>", GREEN);
    expect(planar, "<.25, .25, 9>", "<.25, .25, 0>", BLUE);
    expect(planar, "<.75, .25, 9>", "<.75, .25, 0>", WHITE);
    /* a box has each picture upright on each side, and on top as seen with -z above */
    static const struct {
        const char *from[4], *to[4];
    } sides[] = {
        {{"<-1, 1, 9>", "<1, 1, 9>", "<-1, -1, 9>", "<1, -1, 9>"},
         {"<-1, 1, 0>", "<1, 1, 0>", "<-1, -1, 0>", "<1, -1, 0>"}},
        {{"<1, 1, -9>", "<-1, 1, -9>", "<1, -1, -9>", "<-1, -1, -9>"},
         {"<1, 1, 0>", "<-1, 1, 0>", "<1, -1, 0>", "<-1, -1, 0>"}},
        {{"<9, 1, 1>", "<9, 1, -1>", "<9, -1, 1>", "<9, -1, -1>"},
         {"<0, 1, 1>", "<0, 1, -1>", "<0, -1, 1>", "<0, -1, -1>"}},
        {{"<-9, 1, -1>", "<-9, 1, 1>", "<-9, -1, -1>", "<-9, -1, 1>"},
         {"<0, 1, -1>", "<0, 1, 1>", "<0, -1, -1>", "<0, -1, 1>"}},
        {{"<-1, 9, -1>", "<1, 9, -1>", "<-1, 9, 1>", "<1, 9, 1>"},
         {"<-1, 0, -1>", "<1, 0, -1>", "<-1, 0, 1>", "<1, 0, 1>"}},
    };
    static const char *const box = ON("box { size = <4, 4, 4>", "");
    static const char *const by_box = ON("box { size = <4, 4, 4>", "projection = box scale(4) translate(<-2, -2, -2>)");
    for (size_t i = 0; i < COUNT_OF(sides); i++) {
        for (int way = 0; way < 2; way++) {
            const char *thing = way ? by_box : box;
            expect(thing, sides[i].from[0], sides[i].to[0], RED);
            expect(thing, sides[i].from[1], sides[i].to[1], GREEN);
            expect(thing, sides[i].from[2], sides[i].to[2], BLUE);
            expect(thing, sides[i].from[3], sides[i].to[3], WHITE);
        }
    }
}

/* A box that is mirrored shows the mirrored picture, as everything else does. */
static void pictures_are_mirrored(void **state)
{
    (void)state;
    static const char *const sideways = ON("box { size = <4, 4, 4> scale(<-1, 1, 1>)", "");
    expect(sideways, "<1, 1, 9>", "<1, 1, 0>", RED);
    expect(sideways, "<-1, 1, 9>", "<-1, 1, 0>", GREEN);
    expect(sideways, "<1, -1, 9>", "<1, -1, 0>", BLUE);
    expect(sideways, "<-9, 1, 1>", "<0, 1, 1>", RED);
    expect(sideways, "<-9, 1, -1>", "<0, 1, -1>", GREEN);
    expect(sideways, "<1, 9, -1>", "<1, 0, -1>", RED);
    expect(sideways, "<1, 9, 1>", "<1, 0, 1>", BLUE);
    static const char *const below = ON("box { size = <4, 4, 4> scale(<1, -1, 1>)", "");
    expect(below, "<-1, -1, 9>", "<-1, -1, 0>", RED);
    expect(below, "<1, -1, 9>", "<1, -1, 0>", GREEN);
    expect(below, "<-1, -9, -1>", "<-1, 0, -1>", RED);
    expect(below, "<-1, -9, 1>", "<-1, 0, 1>", BLUE);
}

/* Around: u goes to the right from +x, so the middle of the picture is at -x. */
static void pictures_go_round(void **state)
{
    (void)state;
    static const char *const things[] = {
        ON("sphere { radius = 2", ""),
        ON("sphere { radius = 2", "projection = spherical"),
        ON("sphere { radius = 2 center = <0, 0, 0>", "projection = cylindrical scale(<1, 4, 1>) translate(<0, -2, 0>)"),
        ON("cylinder { from = <0, -2, 0> to = <0, 2, 0> radius = 2",
           "projection = cylindrical scale(<1, 4, 1>) translate(<0, -2, 0>)"),
        ON("ellipsoid { radii = <2, 2, 2>", ""),
        ON("lathe { profile = [<0, -2>, <2, -2>, <2, 2>, <0, 2>]", ""),
    };
    tolerance = 0.15; /* heights differ by how v goes along each */
    for (size_t i = 0; i < COUNT_OF(things); i++) {
        /* u = 3/4 at +z, 1/4 at -z */
        expect(things[i], "<0, 1, 9>", "<0, 1, 0>", GREEN);
        expect(things[i], "<0, -1, 9>", "<0, -1, 0>", WHITE);
        expect(things[i], "<0, 1, -9>", "<0, 1, 0>", RED);
        expect(things[i], "<0, -1, -9>", "<0, -1, 0>", BLUE);
    }
    /* a quarter of the way around, turned to face +z */
    static const char *const label = ON("cylinder { from = <0, -2, 0> to = <0, 2, 0> radius = 2",
                                        "projection = cylindrical turns = .25 wrap = clamp scale(<1, 4, 1>) "
                                        "translate(<0, -2, 0>) rotate(y, 90)");
    expect(label, "<.7, 1, 9>", "<.7, 1, 0>", GREEN);
    expect(label, "<-.7, 1, 9>", "<-.7, 1, 0>", RED);
    expect(label, "<-1.9, -1, 9>", "<-1.9, -1, 0>", BLUE);
    tolerance = 0.008;
    expect(ON("ground {", "projection = uv scale(4)"), "<1, 5, -1>", "<1, 0, -1>", BLUE);
    expect(ON("ground {", "projection = uv scale(4)"), "<3, 5, -3>", "<3, 0, -3>", GREEN);
}

/* How a picture is stretched along an axis that does not count is no matter to how sharp it is: here pictures of a
 * thousandth of a unit, of which a look sees a hundredth. */
static void pictures_are_as_sharp_as_they_are_wide(void **state)
{
    (void)state;
#define TALL "scale(<.001, .001, 1e-9>) translate(<-.0005, -.0005, 0>)"
#define LOW "scale(<.001, 1e-9, .001>) translate(<-.0005, 0, .0005>)"
    static const char *const fronts[] = {
        ON("box { size = <2, 2, 2>", "projection = planar wrap = clamp " TALL),
        ON("box { size = <2, 2, 2>", "projection = planar space = world wrap = clamp " TALL),
        ON("box { size = <2, 2, 2>", "projection = box wrap = clamp " TALL),
    };
    for (size_t i = 0; i < COUNT_OF(fronts); i++) {
        expect(fronts[i], "<-.00025, .00025, 9>", "<-.00025, .00025, 1>", RED);
        expect(fronts[i], "<.00025, .00025, 9>", "<.00025, .00025, 1>", GREEN);
        expect(fronts[i], "<-.00025, -.00025, 9>", "<-.00025, -.00025, 1>", BLUE);
        expect(fronts[i], "<.00025, -.00025, 9>", "<.00025, -.00025, 1>", WHITE);
    }
    static const char *const top = ON("box { size = <2, 2, 2>", "projection = box wrap = clamp " LOW);
    expect(top, "<-.00025, 9, -.00025>", "<-.00025, 1, -.00025>", RED);
    expect(top, "<.00025, 9, .00025>", "<.00025, 1, .00025>", WHITE);
    /* around: a height of a billion of the radius is one that no look sees a part of */
    static const char *const around =
        ON("cylinder { from = <0, -2, 0> to = <0, 2, 0> radius = 2", "projection = cylindrical wrap = clamp %s");
    static const char *const scales[] = {"scale(<1e-9, 4, 1e-9>) translate(<0, -2, 0>)",
                                         "scale(<1, 4, 1>) translate(<0, -2, 0>)"};
    for (size_t i = 0; i < COUNT_OF(scales); i++) {
        char thing[400];
        snprintf(thing, sizeof thing, around, scales[i]);
        expect(thing, "<0, 1, 9>", "<0, 1, 0>", GREEN);
        expect(thing, "<0, -1, -9>", "<0, -1, 0>", BLUE);
    }
    /* and one that is squeezed where it counts has its mean */
    expect(ON("box { size = <2, 2, 2>", "projection = planar scale(<1e-7, 1, 1>)"), "<.1, .75, 9>", "<.1, .75, 1>", .3,
           .3, .3);
}

/* A texture is in the frame that its object was described in, and goes where that goes. */
static void textures_stay_on_objects(void **state)
{
    (void)state;
    static const char *const still[] = {
        "box { from = <-2, -2, -2> to = <2, 2, 2> ",
        "sphere { radius = 2.2 ",
        "cylinder { from = <-2, 0, 0> to = <2, 0, 0> radius = 2 ",
        "lathe { profile = [<0, -2>, <2, -2>, <2, 2>, <0, 2>] ",
        "torus { radius = 1.5 tube = .6 ",
        "union { box { size = <1, 4, 4> } box { size = <4, 4, 1> } ",
        "difference { box { size = <4, 4, 4> } sphere { radius = 1 center = <9, 0, 0> } ",
        "mesh { positions = [<-2, -2, 1>, <2, -2, 1>, <2, 2, 1>, <-2, 2, 1>] triangles = [<0, 1, 2>, <0, 2, 3>] ",
    };
    static const char *const surface =
        "surface = surface { albedo = noise { octaves = 3 from = rgb(.1, .2, .9) to = rgb(.9, .1, .3) scale(.7) } } ";
    for (size_t i = 0; i < COUNT_OF(still); i++) {
        char thing[600];
        float here[3], there[3], other[3];
        snprintf(thing, sizeof thing, "%s %s }", still[i], surface);
        look(thing, "<.2, .4, 9>", "<.2, .4, 0>", 0, here);
        snprintf(thing, sizeof thing, "%s %s translate(<100, 20, 3>) }", still[i], surface);
        look(thing, "<100.2, 20.4, 12>", "<100.2, 20.4, 3>", 0, there);
        look(thing, "<100.3, 20.1, 12>", "<100.3, 20.1, 3>", 0, other);
        for (int c = 0; c < 3; c++) assert_near((double)there[c], (double)here[c], 2e-3);
        assert_true(fabsf(other[0] - here[0]) + fabsf(other[2] - here[2]) > 1e-3f);
        snprintf(thing, sizeof thing, "group { %s %s } rotate(y, 90) scale(2) }", still[i], surface);
        look(thing, "<9, .8, -.4>", "<0, .8, -.4>", 0, there);
        for (int c = 0; c < 3; c++) assert_near((double)there[c], (double)here[c], 2e-3);
    }
    /* in the world it stays where that is */
    static const char *const world =
        "sphere { surface = surface { albedo = checker { space = world } } radius = .4 %s }";
    char thing[300];
    snprintf(thing, sizeof thing, world, "translate(<.5, .5, .5>)");
    expect(thing, "<.5, .5, 9>", "<.5, .5, 0>", 0, 0, 0);
    snprintf(thing, sizeof thing, world, "translate(<1.5, .5, .5>)");
    expect(thing, "<1.5, .5, 9>", "<1.5, .5, 0>", 1, 1, 1);
}

static void transforms_apply_in_order(void **state)
{
    (void)state;
    /* 0 up to x = 1, then 1 */
#define STEP(transforms)                                                                                               \
    "box { size = <20, 2, 2> surface = surface { albedo = gradient { wave = once ramp = [[0, 0], [.999, 0], [1, "      \
    "1]] " transforms " } } }"
    expect(STEP("scale(2) translate(<1, 0, 0>)"), "<2.9, 0, 9>", "<2.9, 0, 0>", 0, 0, 0);
    expect(STEP("scale(2) translate(<1, 0, 0>)"), "<3.1, 0, 9>", "<3.1, 0, 0>", 1, 1, 1);
    expect(STEP("translate(<1, 0, 0>) scale(2)"), "<3.9, 0, 9>", "<3.9, 0, 0>", 0, 0, 0);
    expect(STEP("translate(<1, 0, 0>) scale(2)"), "<4.1, 0, 9>", "<4.1, 0, 0>", 1, 1, 1);
    expect(STEP("rotate(y, 180)"), "<-.9, 0, 9>", "<-.9, 0, 0>", 0, 0, 0);
    expect(STEP("rotate(y, 180)"), "<-1.1, 0, 9>", "<-1.1, 0, 0>", 1, 1, 1);
}

static void values_mix(void **state)
{
    (void)state;
#define BOX(texture) "box { size = <2, 2, 2> surface = surface { albedo = " texture " } }"
#define SEEN "<.1, .2, 9>", "<.1, .2, 0>"
    expect(BOX("mix { from = rgb(.8, .2, 0) to = rgb(0, .2, .4) blend = .25 }"), SEEN, .6, .2, .1);
    expect(BOX("mix { from = .2 to = mix { from = .4 to = .6 } }"), SEEN, .35, .35, .35);
    expect(BOX("gradient { wave = once ramp = [[0, .2], [.2, .8]] }"), SEEN, .5, .5, .5);
    expect(BOX("gradient { wave = once ramp = [.2, .8, 1] }"), SEEN, .32, .32, .32);
    expect(BOX("gradient { wave = once ramp = [rgb(.3, .4, .5)] }"), SEEN, .3, .4, .5);
    expect(BOX("image { " CORNERS
               " channel = red projection = planar scale(.1) translate(<.025, 0, 0>) from = .1 to = .5 }"),
           "<.05, .2249, 9>", "<.05, .2249, 0>", .14, .14, .14);
    expect(BOX("image { " NUMBER " }"), SEEN, .5, .5, .5);
    expect(BOX("image { " NUMBER " from = rgb(.8, 0, 0) to = rgb(0, 0, .4) }"), SEEN, .4, 0, .2);
}

/* Every object has its own value, and keeps it when others come behind it. */
static void objects_vary(void **state)
{
    (void)state;
    static const char *const rows =
        "for (i in 0..<%d) { box { size = <1, 1, 1> surface = surface { albedo = variation { %s } } "
        "translate(<2 * i, 0, 0>) } } %s";
    float seen[4][3];
    char text[400];
    for (int i = 0; i < 4; i++) {
        char from[40], to[40];
        snprintf(from, sizeof from, "<%d, 0, 9>", 2 * i);
        snprintf(to, sizeof to, "<%d, 0, 0>", 2 * i);
        snprintf(text, sizeof text, rows, 4, "", "");
        look(text, from, to, 0, seen[i]);
        float again[3];
        snprintf(text, sizeof text, rows, 9, "",
                 "sphere { surface = surface { albedo = variation { } } translate(<0, 9, 0>) }");
        look(text, from, to, 0, again);
        assert_true(again[0] == seen[i][0]);
        snprintf(text, sizeof text, rows, 4, "seed = 1", "");
        look(text, from, to, 0, again);
        assert_true(again[0] != seen[i][0]);
        for (int k = 0; k < i; k++) assert_true(seen[k][0] != seen[i][0]);
    }
}

static void refused(const char *text, DiagCode code, float number)
{
    Fixture f;
    char whole[1200];
    snprintf(whole, sizeof whole, FIXTURE_MEDIA "%s" FIXTURE_VIEW, text);
    build(&f, whole, number);
    if (!fixture_find(&f, code) || f.scene) {
        fixture_print(&f);
        fail_msg("not refused with %s: %s", diag_slug(code), text);
    }
    fixture_clear(&f);
}

#define SURFACE(x) "sphere { surface = surface { " x " } }"

static void mistakes_are_refused(void **state)
{
    (void)state;
    refused(SURFACE("albedo = noise { to = 1.5 }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = noise { to = rgb(.5, -.1, 0) }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = noise { ramp = [[0, .5], [1, rgb(2, 0, 0)]] }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = noise { ramp = [[.5, .5], [.2, .1]] }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = noise { ramp = [[1.5, .5]] }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = noise { ramp = [] }"), D_WRONG_TYPE, 0);
    refused(SURFACE("albedo = noise { ramp = [.1, [.5, .2]] }"), D_WRONG_TYPE, 0);
    refused(SURFACE("albedo = noise { ramp = [.1, .2] from = .5 }"), D_CONFLICTING_PROPERTIES, 0);
    refused(SURFACE("albedo = noise { to = <.1, .2, .3> }"), D_WRONG_TYPE, 0);
    refused(SURFACE("albedo = noise { to = cauchy(1, 2) }"), D_WRONG_TYPE, 0);
    refused(SURFACE("albedo = noise { scale(<1, 0, 1>) }"), D_SINGULAR_TRANSFORM, 0);
    refused(SURFACE("albedo = brick { mortar = 4 }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("ior = 1.5 roughness = noise { to = 1.2 }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("ior = 1.5 roughness = noise { to = rgb(.1, .2, .3) }"), D_WRONG_TYPE, 0);
    refused(SURFACE("ior = 1.5 roughness = noise { from = checker { to = -.2 } }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("ior = noise { }"), D_WRONG_TYPE, 0);
    refused(SURFACE("emission = noise { from = -1 }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("emission = noise { ramp = [0, rgb(1, -1, 0)] }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("emission = noise { to = 1e31 }"), D_VALUE_OUT_OF_RANGE, 0);
    refused(SURFACE("albedo = surface { }"), D_WRONG_TYPE, 0);
    refused(SURFACE("albedo = noise { } pattern = checker"), D_CONFLICTING_PROPERTIES, 0);
    refused(SURFACE("bump = noise { }"), D_MISSING_PROPERTY, 0);
    refused(SURFACE("bump_height = 2"), D_CONFLICTING_PROPERTIES, 0);
    refused(SURFACE("bump = .5 bump_height = 2"), D_WRONG_TYPE, 0);
    refused(SURFACE("normal_strength = 2"), D_CONFLICTING_PROPERTIES, 0);
    refused(SURFACE("normal_map = image { " NUMBER " projection = planar }"), D_CONFLICTING_PROPERTIES, .5f);
    refused("sphere { interior = glass surface = surface { albedo = noise { } } }", D_CONFLICTING_PROPERTIES, 0);
    refused(SURFACE("albedo = image { file = \"no such\" }"), D_FILE_NOT_FOUND, 0);
    refused(SURFACE("albedo = image { " NUMBER " colorspace = \"nowhere\" }"), D_IMAGE_INVALID, .5f);
    refused(SURFACE("albedo = image { " NUMBER " }"), D_IMAGE_INVALID, 1.5f);
    refused(SURFACE("albedo = image { " NUMBER " }"), D_IMAGE_INVALID, -.5f);
    refused(SURFACE("albedo = image { " NUMBER " }"), D_IMAGE_INVALID, (float)NAN);
    refused(SURFACE("ior = 1.5 roughness = image { " NUMBER " }"), D_IMAGE_INVALID, (float)INFINITY);
    refused(SURFACE("ior = 1.5 roughness = image { " NUMBER " }"), D_VALUE_OUT_OF_RANGE, 1.5f);
    refused("let t = [for (i in 0..0) noise { }] def deep(n) = n == 0 ? noise { } : mix { from = deep(n - 1) to = .5 "
            "} " SURFACE("albedo = deep(40)"),
            D_TOO_DEEP, 0);
    refused("def wide(n) = n == 0 ? noise { } : let (t = wide(n - 1)) mix { from = t to = t } " SURFACE(
                "albedo = wide(20)"),
            D_TOO_DEEP, 0);
}

/* What a picture cannot be used for can be clipped. */
static void clipping_helps(void **state)
{
    (void)state;
    static const struct {
        float number;
        double albedo;
    } cases[] = {{1.5f, 1}, {-.5f, 0}, {(float)NAN, 0}, {(float)INFINITY, 1}, {.25f, .25}};
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        float albedo[3];
        look(BOX("image { " NUMBER " clip = true }"), SEEN, cases[i].number, albedo);
        assert_near((double)albedo[1], cases[i].albedo, 0.002);
    }
}

/* A file is read once for all that use it alike, and what is in it is part of the meaning. */
static void pictures_are_shared(void **state)
{
    (void)state;
    Fixture f, g;
    static const char *const text = FIXTURE_MEDIA
        "let label = image { " NUMBER " } sphere { surface = surface { albedo = label } } "
        "sphere { surface = surface { albedo = image { " NUMBER " scale(2) } coat = 1 coat_tint = label } } "
        "box { size = <1, 1, 1> surface = surface { ior = 1.5 roughness = image { " NUMBER " } } }" FIXTURE_VIEW;
    build(&f, text, .5f);
    assert_int_equal(f.status, STATUS_OK);
    assert_int_equal(f.scene->n_images, 2); /* as a colour and as a number */
    build(&g, text, .25f);
    assert_int_equal(g.status, STATUS_OK);
    assert_true(f.scene->hash != g.scene->hash);
    fixture_clear(&f);
    fixture_clear(&g);
}

static void expect_normal(const char *thing, const char *from, const char *to, float number, double x, double y,
                          double z)
{
    float albedo[3];
    look(thing, from, to, number, albedo);
    double length = sqrt(x * x + y * y + z * z);
    assert_near((double)seen_normal.x, x / length, 2e-3);
    assert_near((double)seen_normal.y, y / length, 2e-3);
    assert_near((double)seen_normal.z, z / length, 2e-3);
}

/* Bumps and maps of normals lean the way that they say, on every side, wherever the object is and however large. */
static void relief_leans(void **state)
{
    (void)state;
#define RELIEF(shape, relief) shape " surface = surface { " relief " } }"
#define RAMP "bump = gradient { wave = once } bump_height = .3"
    /* rising to +x by .3 to 1 */
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1>", RAMP), "<.5, .5, 9>", "<.5, .5, 0>", 0, -.3, 0, 1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1>", RAMP), "<.5, .5, -9>", "<.5, .5, 0>", 0, -.3, 0, -1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1> translate(<50, 0, 0>)", RAMP), "<50.5, .5, 9>",
                  "<50.5, .5, 0>", 0, -.3, 0, 1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1> scale(4)", RAMP), "<2, 2, 9>", "<2, 2, 0>", 0, -.3, 0,
                  1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1> scale(<2, 1, 1>)", RAMP), "<1, .5, 9>", "<1, .5, 0>", 0,
                  -.15, 0, 1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1> rotate(z, 90)", RAMP), "<-.5, .5, 9>", "<-.5, .5, 0>",
                  0, 0, -.3, 1);
    expect_normal(RELIEF("box { from = <0, 0, 0> to = <1, 1, 1> scale(<-1, 1, 1>)", RAMP), "<-.5, .5, 9>",
                  "<-.5, .5, 0>", 0, .3, 0, 1);
    expect_normal(
        RELIEF("sphere { radius = 2", "bump = gradient { wave = once translate(<-.5, 0, 0>) } bump_height = .3"),
        "<0, 0, 9>", "<0, 0, 0>", 0, -.3, 0, 1);
    /* a picture of (1, 1, 1): as far to the right and up as it is outward */
#define MAP "normal_map = image { " NUMBER " } normal_strength = .3"
    expect_normal(RELIEF("box { size = <2, 2, 2>", MAP), "<.1, .2, 9>", "<.1, .2, 0>", 1, .3, .3, 1);
    expect_normal(RELIEF("box { size = <2, 2, 2>", MAP), "<.1, .2, -9>", "<.1, .2, 0>", 1, -.3, .3, -1);
    expect_normal(RELIEF("box { size = <2, 2, 2>", MAP " normal_y = down"), "<9, .2, .1>", "<0, .2, .1>", 1, 1, -.3,
                  -.3);
    expect_normal(RELIEF("cylinder { from = <0, -2, 0> to = <0, 2, 0> radius = 2", MAP), "<0, .5, 9>", "<0, .5, 0>", 1,
                  .3, .3, 1);
    expect_normal(RELIEF("sphere { radius = 2", MAP), "<9, 0, 0>", "<0, 0, 0>", 1, 1, .3, -.3);
    /* clear objects, too */
    expect_normal(
        "medium glass { ior = 1.5 } box { from = <0, 0, 0> to = <1, 1, 1> interior = glass surface = surface { " RAMP
        " } }",
        "<.5, .5, 9>", "<.5, .5, 0>", 0, -.3, 0, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pictures_are_upright),
        cmocka_unit_test(pictures_are_mirrored),
        cmocka_unit_test(pictures_go_round),
        cmocka_unit_test(pictures_are_as_sharp_as_they_are_wide),
        cmocka_unit_test(textures_stay_on_objects),
        cmocka_unit_test(transforms_apply_in_order),
        cmocka_unit_test(values_mix),
        cmocka_unit_test(objects_vary),
        cmocka_unit_test(mistakes_are_refused),
        cmocka_unit_test(clipping_helps),
        cmocka_unit_test(pictures_are_shared),
        cmocka_unit_test(relief_leans),
    };
    return cmocka_run_group_tests_name("texture", tests, NULL, NULL);
}
