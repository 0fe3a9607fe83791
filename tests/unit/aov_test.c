/* aov_test.c - what a picture holds besides its colours, against formulas; hashes; threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "render/aov_film.h"
#include "render/render.h"
#include "scene_fixture.h"

enum { SIDE = 24, SAMPLES = 8 };
#define ALL (((AovSet)1 << AOV_COUNT) - 1)

static RenderStats render(const char *text, AovSet set, unsigned n_threads, Fixture *f, Image *image)
{
    Error error;
    Pool *pool;
    RenderStats stats;
    fixture_compile(f, text, 1);
    assert_int_equal(pool_new(n_threads, &pool, &error), STATUS_OK);
    RenderSettings settings = {.width = SIDE, .height = SIDE, .samples = SAMPLES, .bounces = 16, .aovs = set};
    if (render_image(f->compiled, &settings, pool, NULL, image, &stats, &error) != STATUS_OK)
        fail_msg("%s", error.text);
    pool_free(pool);
    return stats;
}

static double value(const Image *image, uint32_t x, uint32_t y, const char *channel)
{
    int c = image_channel(image, channel);
    if (c < 0) fail_msg("no channel %s", channel);
    return (double)image->pixels[((size_t)y * SIDE + x) * image->n_channels + (size_t)c];
}

/* A ball of radius 3 in a box of water, over a grey ground, seen along -z. */
#define SCENE                                                                                                          \
    FIXTURE_MEDIA                                                                                                      \
    "surface clay { albedo = rgb(.5, .25, .125) } box tank { interior = water from = <-6, -6, -6> to = <6, 6, 6> } "   \
    "sphere ball { radius = 3 center = <0, 0, 5> surface = clay } "                                                    \
    "camera { from = <0, 0, 100> to = <0, 0, 0> fov = 10 } environment { }"

static void channels_hold_what_they_say(void **state)
{
    (void)state;
    Fixture f;
    Image image;
    render(SCENE, ALL, 1, &f, &image);
    uint32_t m = SIDE / 2; /* the ball sticks out of the water by 2, and is met in the air */
    assert_true(value(&image, m, m, "Z") > 91.99 && value(&image, m, m, "Z") < 92.1);
    assert_true(value(&image, m, m, "P.Z") > 7.9 && value(&image, m, m, "P.Z") <= 8.000001);
    assert_true(value(&image, m, m, "N.Z") > 0.95);
    assert_near(value(&image, m, m, "albedo.R"), .5, 2e-3);
    assert_near(value(&image, m, m, "albedo.G"), .25, 2e-3);
    assert_near(value(&image, m, m, "albedo.B"), .125, 2e-3);
    assert_near(value(&image, m, m, "nesting.depth"), 0, 0);
    assert_near(value(&image, m, m, "nesting.faults"), 0, 0);
    assert_near(value(&image, m, m, "samples"), SAMPLES, 0);
    /* beside it the face of the water, flat */
    assert_near(value(&image, m, 6, "P.Z"), 6, 1e-6);
    assert_near(value(&image, m, 6, "N.Z"), 1, 1e-6);
    assert_near(value(&image, m, 6, "albedo.G"), 1, 1e-6);
    assert_near(value(&image, m, 6, "nesting.depth"), 1, 0);
    /* and nothing in the corner */
    assert_true(value(&image, 0, 0, "Z") > 9e29);
    assert_near(value(&image, 0, 0, "N.Z"), 0, 0);
    assert_near(value(&image, 0, 0, "CryptoObject00.G"), 0, 0);
    image_clear(&image);
    fixture_clear(&f);
}

static void mattes_add_up(void **state)
{
    (void)state;
    Fixture f;
    Image image;
    render(SCENE, (AovSet)1 << AOV_CRYPTOMATTE | (AovSet)1 << AOV_OBJECT, 1, &f, &image);
    double tank = (double)aov_id_float(aov_id("tank")), ball = (double)aov_id_float(aov_id("ball"));
    double water = (double)aov_id_float(aov_id("water")), clay = (double)aov_id_float(aov_id("clay"));
    unsigned n_mixed = 0, n_ball = 0;
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            double ids[2] = {value(&image, x, y, "CryptoObject00.R"), value(&image, x, y, "CryptoObject00.B")};
            double parts[2] = {value(&image, x, y, "CryptoObject00.G"), value(&image, x, y, "CryptoObject00.A")};
            assert_true(parts[0] >= parts[1] && parts[0] + parts[1] <= 1.000001);
            for (int i = 0; i < 2; i++) assert_true(parts[i] == 0 ? ids[i] == 0 : ids[i] == tank || ids[i] == ball);
            double material = value(&image, x, y, "CryptoMaterial00.R");
            if (parts[0] == 1) assert_true(material == (ids[0] == ball ? clay : water));
            assert_near(value(&image, x, y, "CryptoObject01.G"), 0, 0);
            n_mixed += parts[1] > 0;
            n_ball += ids[0] == ball;
        }
    assert_true(n_mixed > 8 && n_ball > 40);
    assert_int_equal(image_channel(&image, "Z"), -1);
    image_clear(&image);
    fixture_clear(&f);
}

/* Asking for more changes nothing else, and threads do not matter. */
static void pictures_stay_as_they_are(void **state)
{
    (void)state;
    Fixture f[3];
    Image plain, one, many;
    render(SCENE, 0, 1, &f[0], &plain);
    render(SCENE, ALL, 1, &f[1], &one);
    render(SCENE, ALL, 3, &f[2], &many);
    assert_int_equal(plain.n_channels, 5);
    for (size_t i = 0; i < SIDE * SIDE; i++)
        assert_memory_equal(plain.pixels + i * plain.n_channels, one.pixels + i * one.n_channels, 5 * sizeof(float));
    assert_int_equal(one.n_channels, many.n_channels);
    assert_memory_equal(one.pixels, many.pixels, (size_t)SIDE * SIDE * one.n_channels * sizeof(float));
    Image *images[] = {&plain, &one, &many};
    for (int i = 0; i < 3; i++) {
        image_clear(images[i]);
        fixture_clear(&f[i]);
    }
}

/* A ground that is seen kilometres away, beside a ball that is all that the scene's size comes from. */
static void what_is_far_is_as_far_as_it_is(void **state)
{
    (void)state;
    Fixture f;
    Image image;
    const double heights[] = {5, 5e6};
    for (int i = 0; i < 2; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit m ground { y = %g surface = surface { } } sphere { surface = surface { } } "
                 "camera { from = <0, 2, 4> to = <0, %.17g, -20000> up = y fov = .01 } environment { }",
                 -heights[i] + 2, -heights[i] + 2);
        render(text, ALL, 1, &f, &image);
        double straight = hypot(20004, heights[i]), z = value(&image, SIDE / 2, SIDE / 2, "P.Z");
        assert_true(fabs(z + 20000) < 4000);
        assert_near(value(&image, SIDE / 2, SIDE / 2, "P.Y"), 2 - heights[i], 1e-6 * heights[i]);
        assert_near(value(&image, SIDE / 2, SIDE / 2, "Z"), hypot(4 - z, heights[i]), .001 * straight);
        image_clear(&image);
        fixture_clear(&f);
    }
}

/* However many samples there are, and however far off what they meet. */
static void sums_do_not_overflow(void **state)
{
    (void)state;
    Error error;
    Film film;
    AovFilm aovs, twin;
    const LightGroups groups = light_groups_none();
    Image image;
    World world = {0};
    AovSet set = (AovSet)1 << AOV_DEPTH | (AovSet)1 << AOV_POSITION | (AovSet)1 << AOV_UV;
    const double distances[] = {1, -1e-3, 3e6, 1e25};
    for (size_t i = 0; i < COUNT_OF(distances); i++) {
        double d = distances[i];
        assert_int_equal(film_init(&film, 1, 1, &error), STATUS_OK);
        assert_int_equal(aov_film_init(&aovs, set, &groups, false, 0x1p-36, 1, 1, &error), STATUS_OK);
        assert_int_equal(aov_film_init(&twin, set, &groups, false, 0x1p-36, 1, 1, &error), STATUS_OK);
        aovs.world = twin.world = &world;
        Tracer tracer = {
            .first_sight = {.met = true, .distance = d, .position = {-d, d, 3 * d}, .uv = {(float)d, -(float)d}}};
        enum { N = 100, DOUBLINGS = 20 };
        for (int k = 0; k < N; k++) aov_film_add(&aovs, 0, 0, &tracer, &tracer.counters);
        for (int k = 0; k < DOUBLINGS; k++) {
            Buf row = {0};
            aov_film_save_row(&aovs, 0, &row);
            BufReader in = {buf_text(&row), row.length};
            assert_true(aov_film_load_row(&twin, 0, &in));
            assert_true(aov_film_join_row(&aovs, 0, &twin, 0));
            buf_clear(&row);
        }
        film.pixels[0].n = N << DOUBLINGS;
        assert_int_equal(aov_film_resolve(&aovs, &film, NULL, NULL, &image, &error), STATUS_OK);
        const struct {
            const char *channel;
            double value, largest;
        } wanted[] = {{"Z", d, 0x1p26}, {"P.X", -d, 0x1p26}, {"P.Y", d, 0x1p26}, {"P.Z", 3 * d, 0x1p26}};
        for (size_t k = 0; k < COUNT_OF(wanted); k++) {
            int c = image_channel(&image, wanted[k].channel);
            assert_true(c >= 0);
            double value = copysign(fmin(fabs(wanted[k].value), wanted[k].largest), wanted[k].value);
            assert_near((double)image.pixels[c] / value, 1, 2e-7);
        }
        image_clear(&image);
        aov_film_clear(&aovs);
        aov_film_clear(&twin);
        film_clear(&film);
    }
}

/* Where media scatter, what is met first is looked for by itself: that is no ray of the path, by which adaptive renders share
 * samples out. */
static void looks_are_not_counted(void **state)
{
    (void)state;
    static const char *const scene =
        FIXTURE_MEDIA "medium mist { mixes = true scattering = .05 } sphere { interior = mist radius = 9 } "
                      "box wrap { interior = air size = <9, 9, 9> } sphere { radius = 3 surface = surface { } } "
                      "camera { from = <0, 0, 100> to = <0, 0, 0> fov = 10 } environment { }";
    Fixture f[2];
    Image images[2];
    RenderStats plain = render(scene, 0, 1, &f[0], &images[0]), with = render(scene, ALL, 1, &f[1], &images[1]);
    assert_int_equal(plain.rays, with.rays);
    assert_int_equal(plain.crossings, with.crossings);
    assert_int_equal(plain.silent_crossings, with.silent_crossings);
    assert_near(value(&images[1], SIDE / 2, SIDE / 2, "CryptoObject00.G"), 1, 0);
    for (int i = 0; i < 2; i++) {
        image_clear(&images[i]);
        fixture_clear(&f[i]);
    }
}

/* Where media scatter and wavelengths part, the second path of a sample begins in the middle: what it meets there is not seen first. */
static void what_parts_is_seen_once(void **state)
{
    (void)state;
    Fixture f;
    Image image;
    render(FIXTURE_MEDIA "medium flint { ior = cauchy(1.6, .02) } medium mist { mixes = true scattering = .01 } "
                         "sphere ball { interior = flint radius = 4 } sphere { interior = mist radius = 20 } "
                         "box wall { from = <-99, -99, -9> to = <99, 99, -8> surface = surface { } } "
                         "camera { from = <0, 0, 100> to = <0, 0, 0> fov = 5 } environment { }",
           ALL, 1, &f, &image);
    uint32_t m = SIDE / 2;
    assert_true(value(&image, m, m - 4, "CryptoObject00.R") == (double)aov_id_float(aov_id("ball")));
    assert_near(value(&image, m, m - 4, "CryptoObject00.G"), 1, 0);
    assert_true(value(&image, m, m - 4, "Z") > 96 && value(&image, m, m - 4, "Z") < 98);
    assert_true(value(&image, m, m - 4, "P.Z") > 3);
    image_clear(&image);
    fixture_clear(&f);
}

/* Of a combination the whole counts, and of silent surfaces none. */
static void what_is_seen_first(void **state)
{
    (void)state;
    Fixture f;
    Image image;
    render(FIXTURE_MEDIA
           "difference cut { interior = glass box { size = <9, 9, 9> } sphere { radius = 3 center = <0, 0, 4.5> } } "
           "box wrap { interior = air size = <12, 12, 12> } "
           "camera { from = <0, 0, 100> to = <0, 0, 0> fov = 6 } environment { }",
           ALL, 1, &f, &image);
    uint32_t m = SIDE / 2;
    assert_true(value(&image, m, m, "CryptoObject00.R") == (double)aov_id_float(aov_id("cut")));
    assert_near(value(&image, m, m, "CryptoObject00.G"), 1, 0);
    assert_true(value(&image, m, m, "P.Z") >= 1.49 && value(&image, m, m, "P.Z") < 1.7);
    assert_true(value(&image, m, m, "N.Z") > 0.9); /* towards the camera, though the ball looks the other way */
    assert_near(value(&image, m, m, "nesting.depth"), 2, 0);
    assert_true(value(&image, m, m, "nesting.silent") >= 1);
    image_clear(&image);
    fixture_clear(&f);
}

/* Means over some pixels in the middle. */
static double mean_of(const Image *image, const char *channel)
{
    double sum = 0;
    for (uint32_t y = SIDE / 4; y < SIDE * 3 / 4; y++)
        for (uint32_t x = SIDE / 4; x < SIDE * 3 / 4; x++) sum += value(image, x, y, channel);
    return sum / (SIDE * SIDE / 4);
}

/* A camera that looks straight along -z at a wall at z = -5, and something before it. */
#define BEHIND(before)                                                                                                 \
    FIXTURE_MEDIA                                                                                                      \
    "medium milk { ior = 1.33  scattering = .35 } medium fog { ior = 1  scattering = .35 } "                           \
    "let _all = [milk, fog] " before " film { filter = box } "                                                         \
    "box wall { from = <-99, -99, -6> to = <99, 99, -5> surface = surface { albedo = rgb(.5, .25, .125) } } "          \
    "camera { from = <0, 0, 50> to = <0, 0, 0> projection = orthographic width = 4 } environment { } "

typedef struct Behind {
    const char *before;
    double depth, aside, way,
        covered; /* aside: how far P.X is from where it would be without what is before; < 0: not asked */
    const char *object, *medium;
} Behind;

static void check_behind(const Behind *wanted)
{
    Fixture f;
    Image image;
    render(wanted->before, ALL, 1, &f, &image);
    uint32_t m = SIDE / 2;
    assert_near(mean_of(&image, "CryptoObjectBehind00.G"), 1, 0);
    assert_true(value(&image, m, m, "CryptoObjectBehind00.R") == (double)aov_id_float(aov_id(wanted->object)));
    if (wanted->medium)
        assert_true(value(&image, m, m, "CryptoMediumBehind00.R") == (double)aov_id_float(aov_id(wanted->medium)));
    assert_near(mean_of(&image, "CryptoMediumBehind00.G"), wanted->covered, 1e-6);
    assert_near(mean_of(&image, "behind.Z"), wanted->depth, 1e-5);
    assert_near(fabs(mean_of(&image, "behind.P.X") - mean_of(&image, "P.X")), wanted->aside, 1e-5);
    assert_near(mean_of(&image, "behind.medium.way"), wanted->way, 1e-5);
    assert_near(mean_of(&image, "behind.P.Z"), -5, 1e-5);
    assert_near(mean_of(&image, "behind.N.Z"), 1, 1e-6);
    assert_near(mean_of(&image, "behind.albedo.G"), .25, 2e-3);
    image_clear(&image);
    fixture_clear(&f);
}

static void what_is_behind_clear_surfaces_is_seen_by_refraction(void **state)
{
    (void)state;
    /* a plate, turned by 45 degrees: Snell's law, the way within it, and how far the line comes out aside */
    const double angle = asin(sqrt(.5) / 1.5), within = 1 / cos(angle), aside = sin(acos(-1) / 4 - angle) * within;
    const Behind cases[] = {
        {BEHIND(""), 55, 0, 0, 0, "wall", NULL},
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass }"), 55, 0, 1, 1, "wall", "glass"},
        {BEHIND("box { from = <-9, -9, -.5> to = <9, 9, .5> interior = glass rotate(y, 45) }"),
         55 - within * cos(acos(-1) / 4 - angle) + within, aside, within, 1, "wall", "glass"},
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass } "
                "box { from = <-9, -9, -3> to = <9, 9, .5> interior = water }"),
         55, 0, 3, 1, "wall", "water"},
        {BEHIND(
             "box { from = <-9, -9, 0> to = <9, 9, .1> surface = surface { thin = true ior = 1.5 transmission = 1 } }"),
         55, 0, 0, 0, "wall", NULL},
        /* what scatters before anything is met, or outside of all, is looked through */
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = fog }"), 55, 0, 0, 0, "wall", NULL},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) check_behind(&cases[i]);
}

/* Into a block with the wall in it, whose face rises by a fifth: that bends a line once. */
static void relief_bends_a_line_once(void **state)
{
    (void)state;
    const double rise = atan(.2), bent = rise - asin(sin(rise) / 1.5);
    Fixture f;
    Image image;
    render(BEHIND("box { from = <-9, -9, -9> to = <9, 9, 1> interior = glass surface = surface { "
                  "bump = gradient { wave = once scale(40) translate(<-20, 0, 0>) } bump_height = 8 } }"),
           ALL, 1, &f, &image);
    assert_near(fabs(mean_of(&image, "behind.P.X") - mean_of(&image, "P.X")), 6 * tan(bent), 1e-3);
    image_clear(&image);
    fixture_clear(&f);
}

/* Of what scatters behind glass there is as much as it scatters; half of a sheet is as much as covers. */
static void what_covers_in_part_has_its_part(void **state)
{
    (void)state;
    static const struct {
        const char *text, *object;
        double part;
    } cases[] = {
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass } "
                "box drink { from = <-9, -9, -2> to = <9, 9, 0.001> interior = milk }"),
         "drink", .5034147},
        {BEHIND("box sheet { from = <-9, -9, 0> to = <9, 9, 1> surface = surface { thin = true ior = 1.5 transmission "
                "= .5 } }"),
         "sheet", .75},
        {BEHIND("box pane { from = <-9, -9, 0> to = <9, 9, 1> interior = glass "
                "surface = surface { transmission = .5 albedo = .5 ior = 1.5 } }"),
         "pane", .75},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        Image image;
        render(cases[i].text, ALL, 1, &f, &image);
        double sum = 0;
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++)
                for (int k = 0; k < 2; k++) {
                    bool is = value(&image, x, y, k ? "CryptoObjectBehind00.B" : "CryptoObjectBehind00.R") ==
                              (double)aov_id_float(aov_id(cases[i].object));
                    if (is) sum += value(&image, x, y, k ? "CryptoObjectBehind00.A" : "CryptoObjectBehind00.G");
                }
        assert_near(sum / (SIDE * SIDE), cases[i].part, 0.01);
        image_clear(&image);
        fixture_clear(&f);
    }
}

/* A measured metal has the colour of what it mirrors, whatever albedo it stands in the place of. */
static void metals_have_their_colour(void **state)
{
    (void)state;
    static const struct {
        const char *surface;
        double red, green;
    } cases[] = {
        {"metal = gold", 1.037, .728}, /* gold is redder than the primaries of Rec.709 are */
        {"metal = gold albedo = .5 metalness = .5", .769, .614},
        {"metal = gold albedo = .5 metalness = mix { from = .5 to = .5 }", .769, .614},
        {"metal = gold albedo = checker { from = .5 to = .5 } metalness = .5", .769, .614},
        {"mix = [surface { metal = gold }, surface { albedo = .5 }]", .769, .614},
        {"albedo = .5 metalness = 1", .5, .5},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        char text[600];
        Fixture f;
        Image image;
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "box { from = <-999, -999, 0> to = <999, 999, 1> surface = surface { %s } } " FIXTURE_VIEW,
                 cases[i].surface);
        render(text, ALL, 1, &f, &image);
        assert_near(mean_of(&image, "albedo.R"), cases[i].red, 0.002);
        assert_near(mean_of(&image, "albedo.G"), cases[i].green, 0.002);
        image_clear(&image);
        fixture_clear(&f);
    }
}

#define SHEET "mesh { positions = [<-9, -9, 1>, <9, -9, 1>, <0, 18, 1>]  triangles = [<0, 1, 2>]  "

/* What is painted on a clear object is of its own colour; of half of it the other half is white, or what is behind. */
static void paint_has_its_colour(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double albedo, behind;
    } cases[] = {
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass "
                "surface = surface { transmission = 0 albedo = rgb(.9, .75, .1) } }"),
         .75, .75},
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass "
                "surface = surface { transmission = .5 albedo = rgb(.9, .75, .1) } }"),
         .875, .625},
        {BEHIND("box { from = <-9, -9, 0> to = <9, 9, 1> interior = glass surface = surface { weight = .5 "
                "mix = [surface { ior = 1.5 transmission = 1 }, surface { transmission = 0 albedo = rgb(.9, .75, .1) "
                "}] } }"),
         .875, .625},
        /* sheets, the second of which is half nothing */
        {BEHIND(SHEET "surface = surface { thin = true transmission = 1 ior = 1.5 } }"), 1, .25},
        {BEHIND(SHEET "surface = surface { weight = .5 "
                      "mix = [surface { thin = true transmission = 1 ior = 1 specular = 0 }, "
                      "surface { thin = true albedo = rgb(.9, .75, .1) translucency = .5 }] } }"),
         .875, .5},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        Image image;
        render(cases[i].text, ALL, 1, &f, &image);
        assert_near(mean_of(&image, "albedo.G"), cases[i].albedo, 0.01);
        assert_near(mean_of(&image, "behind.albedo.G"), cases[i].behind, 0.02);
        image_clear(&image);
        fixture_clear(&f);
    }
}

static void names_are_hashed_as_others_do(void **state)
{
    (void)state;
    assert_int_equal(aov_hash(""), 0);
    assert_int_equal(aov_hash("hello"), 0x248bfa47);
    assert_int_equal(aov_hash("hello, world"), 0x149bbb7f);
    assert_int_equal(aov_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723);
    for (int i = 0; i < 10000; i++) {
        char name[24];
        snprintf(name, sizeof name, "bubble %d", i);
        assert_true(isnormal(aov_id_float(aov_id(name))));
    }
}

static void scenes_name_them(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, FIXTURE_MEDIA "film { aovs = [\"normal\", \"depth\"] }" FIXTURE_VIEW);
    assert_int_equal(f.scene->film.aovs, 1U << AOV_NORMAL | 1U << AOV_DEPTH);
    fixture_clear(&f);
    fixture_refused(FIXTURE_MEDIA "film { aovs = [\"normals\"] }" FIXTURE_VIEW, D_UNKNOWN_CHOICE);
    fixture_refused(FIXTURE_MEDIA "film { aovs = [\"\"] }" FIXTURE_VIEW, D_UNKNOWN_CHOICE);
    fixture_good(&f, FIXTURE_MEDIA "film { aovs = uv }" FIXTURE_VIEW);
    assert_int_equal(f.scene->film.aovs, 1U << AOV_UV);
    fixture_clear(&f);
    /* a scene can ask for all that there is */
    Buf text = {0};
    buf_add(&text, FIXTURE_MEDIA "film { aovs = [");
    for (Aov aov = 0; aov < AOV_COUNT; aov++) buf_format(&text, "%s, ", aov_name(aov));
    buf_format(&text, "\"%s\"] } %s", aov_name(0), FIXTURE_VIEW);
    fixture_good(&f, buf_text(&text));
    assert_int_equal(f.scene->film.aovs, ALL);
    fixture_clear(&f);
    buf_clear(&text);
    assert_int_equal(aov_named("depth", 5), AOV_DEPTH);
    assert_int_equal(aov_named("depth", 4), AOV_COUNT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(channels_hold_what_they_say),
        cmocka_unit_test(mattes_add_up),
        cmocka_unit_test(pictures_stay_as_they_are),
        cmocka_unit_test(what_is_far_is_as_far_as_it_is),
        cmocka_unit_test(sums_do_not_overflow),
        cmocka_unit_test(looks_are_not_counted),
        cmocka_unit_test(what_parts_is_seen_once),
        cmocka_unit_test(what_is_seen_first),
        cmocka_unit_test(what_is_behind_clear_surfaces_is_seen_by_refraction),
        cmocka_unit_test(relief_bends_a_line_once),
        cmocka_unit_test(what_covers_in_part_has_its_part),
        cmocka_unit_test(metals_have_their_colour),
        cmocka_unit_test(paint_has_its_colour),
        cmocka_unit_test(names_are_hashed_as_others_do),
        cmocka_unit_test(scenes_name_them),
    };
    return cmocka_run_group_tests_name("aov", tests, NULL, NULL);
}
