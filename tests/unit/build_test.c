/* build_test.c - scenes from text: what is accepted and what it becomes, what is refused and why.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>
#include <unistd.h>

#include "near.h"
#include "optics/color.h"
#include "optics/spheres.h"
#include "scene_fixture.h"

static const double pi = 3.14159265358979323846;

#define M FIXTURE_MEDIA
#define V FIXTURE_VIEW
#define GOOD(f, text) fixture_good(f, M text V)
#define REFUSED(text, code) fixture_refused(M text V, code)

static void assert_vector(Vec3 v, double x, double y, double z)
{
    assert_near(v.x, x, 1e-12);
    assert_near(v.y, y, 1e-12);
    assert_near(v.z, z, 1e-12);
}

/* ---- media and surfaces ---- */

static const SceneMedium *medium_of(const Fixture *f, const char *object)
{
    return &f->scene->media[f->scene->objects[fixture_object(f, object)].medium];
}

static void media_keep_their_properties(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "medium m { ior = cauchy(1.3239, 3.1e-3)  absorption = <.4, .1, 0> / 1cm  state = liquid  priority = 3 }"
             "medium t { ior = sellmeier(1.03961212, .231792344, 1.01046945, .00600069867, .0200179144, 103.560653) "
             "tint = rgb(.5, .25, .125)  depth = 2cm }"
             "sphere a { interior = m } sphere b { interior = t } sphere c { interior = m  priority = -2 }");
    const SceneMedium *m = medium_of(&f, "a"), *t = medium_of(&f, "b");
    assert_string_equal(m->name, "m");
    assert_true(m->disperses && m->absorbs && m->has_priority);
    assert_int_equal(m->state, NEST_LIQUID);
    assert_int_equal(t->state, NEST_STATE_UNKNOWN);
    assert_near((double)spectrum_at_one(&m->ior, 500), 1.3239 + 3.1e-3 / .25, 1e-5);
    assert_near((double)spectrum_at_one(&t->ior, 587.6f), 1.5168, 1e-4); /* BK7 */
    assert_true(t->absorbs);
    assert_true(spectrum_at_one(&m->absorption, 620) > 0.02f); /* per mm */
    assert_true(spectrum_at_one(&m->absorption, 620) < 0.06f);
    assert_int_equal(f.scene->objects[fixture_object(&f, "a")].priority, 3);
    assert_int_equal(f.scene->objects[fixture_object(&f, "c")].priority, -2);
    fixture_clear(&f);
}

/* Equal spheres have one table; what is around them is the medium's own index, or air, or water around bubbles. */
static void phases_of_spheres(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "medium fog { mixes = true  scattering = 1  phase = droplets(3) }"
             "medium mist { ior = 1  scattering = 2  phase = droplets(3, .2) }"
             "medium haze { mixes = true  scattering = 2  phase = droplets(3, .3) }"
             "medium soda { ior = 1.4  scattering = 1  phase = bubbles(2) }"
             "medium foam { mixes = true  scattering = 1  phase = bubbles(2) }"
             "medium opal { ior = 1.4  scattering = 1  phase = spheres(.3, 1.46, .1) }"
             "sphere a { interior = fog } sphere b { interior = mist } sphere c { interior = haze }"
             "sphere d { interior = soda } sphere e { interior = foam } sphere f { interior = opal }");
    const SceneMedium *fog = medium_of(&f, "a"), *mist = medium_of(&f, "b"), *haze = medium_of(&f, "c");
    assert_non_null(fog->phase.table);
    assert_ptr_equal(fog->phase.table, mist->phase.table);
    assert_ptr_not_equal(fog->phase.table, haze->phase.table);
    const Spheres *soda = medium_of(&f, "d")->phase.table->recipe, *foam = medium_of(&f, "e")->phase.table->recipe;
    const Spheres *opal = medium_of(&f, "f")->phase.table->recipe;
    assert_near(soda->index[5], 1 / 1.4, 1e-7);
    assert_near(soda->around[5], 1.4, 1e-7);
    assert_near(foam->index[5] * spheres_water_index(phase_table_nm(5)), 1, 1e-12);
    assert_near(opal->index[9], 1.46 / 1.4, 1e-7);
    assert_near(opal->width, .1, 0);
    assert_near(opal->diameter_um, .3, 0);
    assert_near(spheres_water_index(589.3), 1.3334, 1e-4); /* n_d of std/media.mns */
    fixture_clear(&f);
}

/* Of any scale, linear in the angle. */
static void phases_that_were_measured(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "medium dust { mixes = true  scattering = 1  phase = measured([<0, 7>, <180, 7>]) }"
             "medium sand { mixes = true  scattering = 1  phase = measured([<20, 30>, <60, 10>]) }"
             "sphere a { interior = dust } sphere b { interior = sand }");
    const PhaseTable *dust = medium_of(&f, "a")->phase.table, *sand = medium_of(&f, "b")->phase.table;
    const Lanes nm = lanes(400, 500, 600, 700);
    for (float s = 0; s <= 1; s += 0.0625f)
        assert_near((double)lanes_get(phase_table_at(dust, s, nm), 2), 1 / (4 * pi), 1e-7);
    double at[] = {0, 20, 30, 60, 180}, expected[] = {3, 3, 2.5, 1, 1};
    for (size_t i = 0; i < COUNT_OF(at); i++) {
        float s = (float)pow(sin(0.5 * at[i] * pi / 180), 2);
        float value = lanes_get(phase_table_at(sand, s, nm), 0), last = lanes_get(phase_table_at(sand, 1, nm), 0);
        assert_near((double)(value / last), expected[i], 1e-4);
    }
    fixture_clear(&f);
}

#define DISPERSING                                                                                                     \
    "medium m { ior = cauchy(1.3239, 3.1e-3)  tint = rgb(.5, .25, .125)  depth = 1 } medium t { ior = 1.5 }"           \
    "sphere a { interior = m } sphere b { interior = t }"

static void dispersion_can_be_left_out(void **state)
{
    (void)state;
    Fixture with, without;
    GOOD(&with, DISPERSING "render { }");
    GOOD(&without, DISPERSING "render { dispersion = false }");
    const SceneMedium *m = medium_of(&without, "a"), *t = medium_of(&without, "b");
    assert_true(medium_of(&with, "a")->disperses && !m->disperses);
    assert_true(spectrum_is_constant(&m->ior));
    assert_near((double)spectrum_at_one(&m->ior, 400), 1.3239 + 3.1e-3 / (.5893 * .5893), 1e-5);
    assert_false(spectrum_is_constant(&m->absorption)); /* colours stay */
    assert_true(spectrum_at_one(&t->ior, 400) == 1.5f);
    assert_true(with.scene->hash != without.scene->hash);
    fixture_clear(&with);
    fixture_clear(&without);
}

static void an_index_that_does_not_change_is_a_number(void **state)
{
    (void)state;
    static const char *const scenes[] = {
        M "medium m { ior = cauchy(1.5, 0) } sphere a { interior = m }" V,
        M "medium m { ior = spectrum([<380, 1.5>, <780, 1.5>]) } sphere a { interior = m }" V};
    Fixture number;
    GOOD(&number, "medium m { ior = 1.5 } sphere a { interior = m }");
    for (size_t i = 0; i < COUNT_OF(scenes); i++) {
        Fixture f;
        fixture_good(&f, scenes[i]);
        const SceneMedium *m = medium_of(&f, "a");
        assert_false(m->disperses);
        assert_int_equal(m->ior.kind, SPECTRUM_CONSTANT);
        assert_true(spectrum_at_one(&m->ior, 400) == 1.5f);
        assert_true(f.scene->hash == number.scene->hash);
        fixture_clear(&f);
    }
    fixture_clear(&number);
}

static void the_world_is_air_unless_it_is_not(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "sphere a { interior = air } sphere b { interior = water }");
    assert_int_equal(f.scene->objects[0].medium, 0);
    assert_string_equal(f.scene->media[0].name, "air");
    assert_int_equal(f.scene->media[0].state, NEST_GAS);
    fixture_clear(&f);
    GOOD(&f, "world { medium = water } sphere a { interior = air } sphere b { interior = water }");
    assert_string_equal(f.scene->media[0].name, "water");
    assert_int_equal(f.scene->objects[1].medium, 0);
    assert_int_not_equal(f.scene->objects[0].medium, 0);
    fixture_clear(&f);
}

static void wrong_media_are_refused(void **state)
{
    (void)state;
    REFUSED("medium m { }", D_MISSING_PROPERTY);
    REFUSED("medium m { ior = 0 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("medium m { ior = cauchy(1.5, -5) }", D_VALUE_OUT_OF_RANGE);
    REFUSED("medium m { ior = sellmeier(1, 0, 0, .3, 1, 1) }", D_VALUE_OUT_OF_RANGE); /* a pole at 548 nm */
    REFUSED("medium m { ior = blackbody(5000) }", D_WRONG_TYPE);
    REFUSED("medium m { ior = 1.5 absorption = blackbody(5000) }", D_WRONG_TYPE);
    REFUSED("medium m { ior = 1.5 absorption = -1 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("medium m { ior = 1.5 absorption = 1e38 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("medium m { ior = 1.5 tint = .5 }", D_MISSING_PROPERTY);
    REFUSED("medium m { ior = 1.5 depth = 5 }", D_CONFLICTING_PROPERTIES);
    REFUSED("medium m { ior = 1.5 tint = .5 depth = 5 absorption = 1 }", D_CONFLICTING_PROPERTIES);
    REFUSED("medium m { ior = 1.5 tint = rgb(2, 0, 0) depth = 5 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("medium m { ior = 1.5 absorption = 1 } world { medium = m }", D_UNBOUNDED_ENVIRONMENT);
}

static void surfaces_are_diffuse_or_checkered(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "surface s { albedo = rgb(.2, .4, .6) } sphere { surface = s } sphere { surface = s }"
             "sphere { surface = surface { pattern = checker albedo = .8 check_size = 3 } }");
    assert_int_equal(f.scene->objects[0].surface, f.scene->objects[1].surface);
    const SceneSurface *s = &f.scene->surfaces[f.scene->objects[2].surface];
    assert_int_equal(s->n_textures, 1);
    assert_false(s->textures_use_object || s->textures_use_uv);
    assert_near((double)spectrum_at_one(&s->albedo, 550), .8, 1e-4);
    /* squares of 3 in the world, whose layers along y are half a square off the origin */
    static const struct {
        Vec3 p;
        double albedo;
    } places[] = {{{1, 0, 1}, .8},  {{4, 0, 1}, .2},   {{4, 0, 4}, .8},
                  {{-1, 1, 1}, .2}, {{1, 1.6, 1}, .2}, {{1, -1.6, 1}, .2}};
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        TexturePlace at = {.world = places[i].p, .object = {9, 9, 9}};
        assert_near((double)texture_number_at(f.scene->textures, s->textures[0].texture, &at), places[i].albedo, 1e-4);
    }
    assert_int_equal(f.scene->objects[0].medium, SCENE_NONE);
    fixture_clear(&f);
    REFUSED("surface s { albedo2 = .5 }sphere { surface = s }", D_CONFLICTING_PROPERTIES);
    REFUSED("surface s { check_size = 5 }sphere { surface = s }", D_CONFLICTING_PROPERTIES);
    REFUSED("surface s { albedo = 1.5 }sphere { surface = s }", D_VALUE_OUT_OF_RANGE);
    REFUSED("sphere { }", D_MISSING_PROPERTY);
    REFUSED("sphere { interior = glass surface = surface { } }", D_CONFLICTING_PROPERTIES);
    REFUSED("sphere { surface = surface { } priority = 1 }", D_CONFLICTING_PROPERTIES);
}

/* ---- shapes ---- */

static void volumes_are_exact(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double volume;
    } cases[] = {
        {"sphere { interior = glass radius = 2 }", 32 / 3.0},
        {"sphere { interior = glass radius = 2 scale(<1, 2, 3>) }", 64},
        {"sphere { interior = glass scale(<-1, 1, 1>) }", 4 / 3.0},
        {"cylinder { interior = glass from = <1, 2, 3> to = <1, 2, 7> radius = 3 }", 36},
        {"cone { interior = glass from = <0, 0, 0> to = <3, 4, 0> radius_from = 2 }", 20 / 3.0},
        {"cone { interior = glass to = <0, 3, 0> radius_from = 1 radius_to = 2 }", 7},
        {"lathe { interior = glass profile = [<0, 0>, <2, 0>, <2, 5>, <0, 5>] }", 20},
        {"lathe { interior = glass profile = [<1, 0>, <2, 0>, <2, 1>, <1, 1>] }", 3},
        {"ellipsoid { interior = glass radii = <1, 2, 3> center = <4, 5, 6> }", 8},
        {"torus { interior = glass radius = 2 tube = .5 }", pi},
        {"capsule { interior = glass to = <0, 0, 5> radius = 2 }", 20 + 32 / 3.0},
        {"cylinder { interior = glass to = <4, 0, 0> radius = 2 rounding = 2 }", 32 / 3.0},
        {"cone { interior = glass to = <0, 4, 0> radius_from = 3 rounding = 1.5 }",
         4.5}, /* what is left is its inscribed ball */
        {"lathe { interior = glass profile = [<0, 0>, <2, 0>, <2, 5>, <0, 5>] curve = cubic corners = [0, 1, 2, 3] }",
         20},
        {"group { scale(2) sphere { interior = glass } }", 32 / 3.0},
    };
    for (size_t i = 0; i < COUNT_OF(cases); i++) {
        Fixture f;
        char text[600];
        snprintf(text, sizeof text, "%s%s%s", M, cases[i].text, V);
        fixture_good(&f, text);
        assert_near(f.scene->objects[0].volume, cases[i].volume * pi, 1e-9 * cases[i].volume);
        fixture_clear(&f);
    }
    Fixture f;
    GOOD(&f, "box { interior = glass from = <3, 0, 0> to = <1, 4, 5> } box { interior = glass size = <1, 2, 3> }"
             "box { interior = glass size = <10, 10, 10> bevel = 1 bevel_segments = 1 scale(<1, 1, -1>) }");
    assert_near(f.scene->objects[0].volume, 40, 1e-5);
    assert_near(f.scene->objects[1].volume, 6, 1e-6);
    assert_true(f.scene->objects[2].volume < 1000 && f.scene->objects[2].volume > 900);
    fixture_clear(&f);
}

static void shapes_are_shared(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "for (i in 1..50) { sphere { interior = glass radius = i center = <0, i, 0> } }"
             "for (i in 1..50) { cylinder { interior = glass from = <i, 0, 0> to = <i, 2, 0> } }"
             "for (i in 1..50) { torus { interior = glass center = <i, 0, 0> } }"
             "for (i in 1..50) { capsule { interior = glass from = <i, 0, 0> to = <i, 2, 0> } }"
             "for (i in 1..50) { ellipsoid { interior = glass radii = <i, 1, 2> } }"
             "let c = box { size = <1, 2, 3> interior = ice } for (i in 1..50) { c { translate(<i, 0, 0>) } }"
             "let l = lathe { interior = ice profile = [<0, 0>, <2, 0>, <2, 5>, <0, 5>] rounding = .1 } l { } l { "
             "rotate(x, 10) }"
             "let m = mesh { interior = ice positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>, <0, 0, 1>] "
             "triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>] } m { } m { scale(2) } m { interior = glass }");
    assert_int_equal(f.scene->n_objects, 305);
    assert_int_equal(f.scene->n_shapes, 7);
    assert_near(f.scene->objects[fixture_object(&f, "m 2")].volume, 8 / 6.0, 1e-6);
    assert_string_equal(f.scene->objects[49].name, "sphere 50");
    assert_vector(f.scene->objects[49].to_world.t, 0, 50, 0);
    fixture_clear(&f);
}

static void a_cylinder_lies_between_its_ends(void **state)
{
    (void)state;
    static const char *const ends[] = {"<0, 9.9, 0>", "<0, 44, 0>", "<1, 2, 3>",
                                       "<-4, 5, 6>",  "<1, 0, 0>",  "<0, 0, 0>"};
    for (size_t i = 0; i < COUNT_OF(ends); i += 2) {
        Fixture f;
        char text[900];
        snprintf(text, sizeof text, "%scylinder { interior = water from = %s to = %s radius = 2 } %s", M, ends[i],
                 ends[i + 1], V);
        fixture_good(&f, text);
        const SceneObject *o = &f.scene->objects[0];
        double a[3], b[3];
        sscanf(ends[i], "<%lf, %lf, %lf>", a, a + 1, a + 2);
        sscanf(ends[i + 1], "<%lf, %lf, %lf>", b, b + 1, b + 2);
        double height = o->volume / (4 * pi);
        assert_vector(affine_point(&o->to_world, vec3(0, 0, 0)), a[0], a[1], a[2]);
        assert_vector(affine_point(&o->to_world, vec3(0, height, 0)), b[0], b[1], b[2]);
        assert_near(affine_determinant(&o->to_world), 1, 1e-12);
        fixture_clear(&f);
    }
}

static void wrong_shapes_are_refused(void **state)
{
    (void)state;
    REFUSED("sphere { interior = glass radius = 0 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("sphere { interior = glass radius = 1e-200 }", D_DEGENERATE_SHAPE);
    REFUSED("sphere { interior = glass scale(<1, 0, 1>) }", D_SINGULAR_TRANSFORM);
    REFUSED("group { scale(<1, 0, 1>) sphere { interior = glass } }", D_SINGULAR_TRANSFORM);
    REFUSED("sphere { interior = glass center = <1e16, 0, 0> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("group { scale(1e10) sphere { interior = glass translate(<1e6, 0, 0>) } }", D_VALUE_OUT_OF_RANGE);
    REFUSED("box { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("box { interior = glass from = <0, 0, 0> }", D_MISSING_PROPERTY);
    REFUSED("box { interior = glass from = <0, 0, 0> to = <1, 1, 0> }", D_DEGENERATE_SHAPE);
    REFUSED("box { interior = glass size = <1, 1, 1> to = <1, 1, 0> }", D_CONFLICTING_PROPERTIES);
    REFUSED("box { interior = glass size = <1, 1, 1> bevel = .5 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("box { interior = glass size = <1, 1, 1> bevel_segments = 3 }", D_CONFLICTING_PROPERTIES);
    REFUSED("cylinder { interior = glass to = <0, 0, 0> }", D_DEGENERATE_SHAPE);
    REFUSED("cone { interior = glass radius_from = 0 }", D_DEGENERATE_SHAPE);
    REFUSED("capsule { interior = glass to = <0, 0, 0> }", D_DEGENERATE_SHAPE);
    REFUSED("torus { interior = glass tube = 0 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("ellipsoid { interior = glass radii = <1, 0, 1> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("ellipsoid { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("cylinder { interior = glass to = <0, 3, 0> radius = 2 rounding = 1.51 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("cone { interior = glass to = <0, 4, 0> radius_from = 3 rounding = 1.501 }", D_VALUE_OUT_OF_RANGE);
#define CAN "lathe { interior = glass profile = [<0, 0>, <1, 0>, <1, 1>, <0, 1>] "
    REFUSED(CAN "curve = cubic corners = [4] }", D_VALUE_OUT_OF_RANGE);
    REFUSED(CAN "curve = cubic corners = [1.5] }", D_VALUE_OUT_OF_RANGE);
    REFUSED(CAN "corners = [1] }", D_CONFLICTING_PROPERTIES);
    REFUSED(CAN "curve = bezier corners = [1] }", D_CONFLICTING_PROPERTIES);
    REFUSED(CAN "tolerance = 1 }", D_CONFLICTING_PROPERTIES);
    REFUSED(CAN "curve = cubic rounding = .1 }", D_CONFLICTING_PROPERTIES);
    REFUSED(CAN "curve = cubic smooth = true }", D_CONFLICTING_PROPERTIES);
    REFUSED("lathe { interior = glass curve = bezier profile = [<0, 0>, <1, 0>, <1, 1>, <0, 1>, <0, 0>] }",
            D_DEGENERATE_SHAPE);
#undef CAN
    REFUSED("lathe { interior = glass profile = [<0, 0>, <1, 1>] }", D_DEGENERATE_SHAPE);
    REFUSED("lathe { interior = glass profile = [<0, 0>, <-1, 1>, <1, 1>] }", D_DEGENERATE_SHAPE);
    REFUSED("lathe { interior = glass profile = [<0, 0>, <1, 0>, <0, 1>] rounding = [.1, .1] }", D_VALUE_OUT_OF_RANGE);
}

/* ---- meshes ---- */

#define TETRAHEDRON "positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>, <0, 0, 1>]"

static void meshes_are_checked_and_mended(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "mesh { interior = glass " TETRAHEDRON " triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>] }");
    assert_null(fixture_find(&f, D_MESH_MENDED));
    assert_near(f.scene->objects[0].volume, 1 / 6.0, 1e-7);
    fixture_clear(&f);
    GOOD(&f, "mesh { interior = glass " TETRAHEDRON
             " triangles = [<0, 1, 2>, <0, 3, 1>, <0, 2, 3>, <1, 3, 2>] }"); /* inside out */
    assert_non_null(fixture_find(&f, D_MESH_MENDED));
    assert_near(f.scene->objects[0].volume, 1 / 6.0, 1e-7);
    fixture_clear(&f);
    GOOD(&f, "mesh { interior = glass " TETRAHEDRON
             " triangles = [<0, 2, 1>, <0, 3, 1>, <0, 3, 2>, <1, 2, 3>] }"); /* one turned */
    assert_non_null(fixture_find(&f, D_MESH_MENDED));
    assert_near(f.scene->objects[0].volume, 1 / 6.0, 1e-7);
    fixture_clear(&f);
    GOOD(&f, "mesh { interior = glass " TETRAHEDRON
             " triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>, <2, 3, 1>, <0, 0, 1>] }");
    assert_non_null(fixture_find(&f, D_MESH_MENDED)); /* one twice, one without extent */
    assert_int_equal(f.scene->shapes[0].mesh->n_triangles, 4);
    fixture_clear(&f);
    GOOD(&f, "mesh { surface = surface { } " TETRAHEDRON " triangles = [<0, 2, 1>, <0, 1, 3>] }"); /* open and opaque */
    fixture_clear(&f);
}

static void open_meshes_enclose_nothing(void **state)
{
    (void)state;
    Fixture f;
    fixture_text(&f,
                 M "mesh bowl { interior = glass " TETRAHEDRON " triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>] }" V);
    const Diagnostic *open = fixture_find(&f, D_OPEN_MESH);
    assert_non_null(open);
    assert_non_null(strstr(open->text, "bowl"));
    assert_non_null(strstr(open->text, "3 edges"));
    assert_non_null(open->notes);
    assert_non_null(strstr(open->notes->text, "from <"));
    fixture_clear(&f);
    REFUSED("mesh { surface = surface { } closed = true " TETRAHEDRON " triangles = [<0, 2, 1>, <0, 1, 3>] }",
            D_OPEN_MESH);
    REFUSED("mesh { interior = glass }", D_MISSING_PROPERTY);
    REFUSED("mesh { interior = glass " TETRAHEDRON " }", D_MISSING_PROPERTY);
    REFUSED("mesh { interior = glass " TETRAHEDRON " triangles = [<0, 1, 4>] }", D_BAD_INDEX);
    REFUSED("mesh { interior = glass " TETRAHEDRON " triangles = [<0, 1, 1.5>] }", D_BAD_INDEX);
    REFUSED("mesh { interior = glass " TETRAHEDRON " triangles = [<0, 1, 1>] }", D_MESH_INVALID);
    REFUSED("mesh { interior = glass " TETRAHEDRON " triangles = [<0, 1, 2>] file = \"x.ply\" }",
            D_CONFLICTING_PROPERTIES);
    REFUSED("mesh { interior = glass file = \"there-is-no-such.ply\" }", D_FILE_NOT_FOUND);
    /* two tetrahedra that share a face between them: three faces at each of its edges */
    REFUSED("mesh { interior = glass positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>, <0, 0, 1>, <0, 0, -1>] "
            "triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>, <0, 4, 1>, <1, 4, 2>, <2, 4, 0>] }",
            D_NON_MANIFOLD_MESH);
}

static void meshes_come_from_files(void **state)
{
    (void)state;
    char folder[] = "/tmp/meniscus-build-XXXXXX", path[200], text[2000];
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/t.obj", folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", file);
    fclose(file);
    Fixture f;
    snprintf(text, sizeof text,
             "%s for (i in 1..3) { mesh { file = \"%s\" interior = glass translate(<i, 0, 0>) } } %s", M, path, V);
    fixture_good(&f, text);
    assert_int_equal(f.scene->n_shapes, 1);
    assert_int_equal(f.scene->n_objects, 3);
    bool listed = false;
    for (uint32_t i = 0; i < f.scene->n_files; i++) listed = listed || strcmp(f.scene->files[i], path) == 0;
    assert_true(listed);
    uint64_t hash = f.scene->hash;
    fixture_clear(&f);
    /* a part of it, in its own unit and with its own axis up */
    char placed[2000];
    snprintf(placed, sizeof placed, "%s mesh { file = \"%s\" interior = glass part = \"x\" } %s", M, path, V);
    fixture_refused(placed, D_MESH_INVALID);
    snprintf(placed, sizeof placed, "%s mesh { file = \"%s\" interior = glass unit = 1cm up = z } %s", M, path, V);
    fixture_good(&f, placed);
    Vec3 high = affine_point(&f.scene->objects[0].to_world, vec3(0, 0, 1));
    assert_near(high.y, 10, 1e-12); /* the scene's unit is the millimetre */
    assert_near(f.scene->objects[0].volume, 1000.0 / 6, 1e-9);
    fixture_clear(&f);
    file = fopen(path, "w");
    fputs("v 0 0 0\nv 2 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", file);
    fclose(file);
    fixture_good(&f, text);
    assert_true(f.scene->hash != hash); /* what is in the file counts */
    fixture_clear(&f);
    file = fopen(path, "w");
    fputs("v 0 0 0\nf 1 2 3\n", file);
    fclose(file);
    fixture_refused(text, D_MESH_INVALID);
    remove(path);
    rmdir(folder);
}

/* ---- lights ---- */

static void lights_shine_where_they_are_told(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "light q { from = <0, 10, 0> to = <0, 0, 0> size = <4, 2> power = 5 }"
             "light d { shape = disc from = <5, 0, 0> to = <0, 0, 0> radius = 2 radiance = 3 }"
             "light s { shape = sphere from = <1, 2, 3> radius = 2 translate(<1, 0, 0>) scale(2) }"
             "light sun { shape = distant from = <0, 3, 4> to = <0, 0, 0> power = 8 }");
    const SceneLight *l = f.scene->lights;
    assert_int_equal(f.scene->n_lights, 4);
    assert_int_equal(l[0].kind, LIGHT_RECT);
    assert_vector(affine_vector(&l[0].to_world, vec3(0, 1, 0)), 0, -1, 0);
    assert_near(l[0].half_width, 2, 0);
    assert_near(l[0].half_height, 1, 0);
    assert_int_equal(f.scene->objects[l[0].object].light, 0);
    assert_true(spectrum_is_zero(&f.scene->surfaces[f.scene->objects[l[0].object].surface].albedo));
    double white = (double)lanes_get(white_at(lanes_all(560)), 0);
    assert_near((double)spectrum_at_one(&l[0].radiance, 560) / white, 5 / (pi * 8e-6), 1e-3 * 2e5);
    assert_near((double)spectrum_at_one(&l[1].radiance, 560) / white, 3, 1e-3);
    assert_near((double)spectrum_at_one(&l[2].radiance, 560) / white, 1, 1e-3);
    assert_vector(affine_vector(&l[1].to_world, vec3(0, 1, 0)), -1, 0, 0);
    assert_vector(l[2].to_world.t, 4, 4, 6);
    assert_near(l[2].half_width, 4, 1e-12);
    assert_near(affine_determinant(&l[2].to_world), 1, 1e-12);
    assert_vector(l[3].towards, 0, .6, .8);
    assert_int_equal(l[3].object, SCENE_NONE);
    double sine2 = 1 - l[3].cos_angle * l[3].cos_angle;
    assert_near((double)spectrum_at_one(&l[3].radiance, 560) / white * pi * sine2, 8, 8e-3);
    fixture_clear(&f);
    GOOD(&f, "light { size = <1, 1> to = <1, 0, 0> color = blackbody(3000K) radiance = 4 }");
    assert_true(spectrum_at_one(&f.scene->lights[0].radiance, 700) >
                2 * spectrum_at_one(&f.scene->lights[0].radiance, 450));
    fixture_clear(&f);
}

static void wrong_lights_are_refused(void **state)
{
    (void)state;
    REFUSED("light { to = <1, 0, 0> }", D_MISSING_PROPERTY);
    REFUSED("light { size = <1, 1> }", D_MISSING_PROPERTY);
    REFUSED("light { shape = sphere }", D_MISSING_PROPERTY);
    REFUSED("light { shape = sphere radius = 1 to = <1, 0, 0> }", D_CONFLICTING_PROPERTIES);
    REFUSED("light { shape = disc radius = 1 size = <1, 1> to = <1, 0, 0> }", D_CONFLICTING_PROPERTIES);
    REFUSED("light { shape = sphere radius = 1 angle = 3 }", D_CONFLICTING_PROPERTIES);
    REFUSED("light { size = <1, 1> to = <1, 0, 0> power = 1 radiance = 1 }", D_CONFLICTING_PROPERTIES);
    REFUSED("light { size = <1, 1> to = <0, 0, 0> }", D_DEGENERATE_SHAPE);
    REFUSED("light { size = <1, 1> to = <1, 0, 0> scale(<1, 2, 1>) }", D_SINGULAR_TRANSFORM);
    REFUSED("light { size = <1, 1> to = <1, 0, 0> color = cauchy(1, 2) }", D_WRONG_TYPE);
    REFUSED("light { size = <1, 1> to = <1, 0, 0> color = blackbody(3) }", D_VALUE_OUT_OF_RANGE);
    REFUSED("light { size = <1, 1> to = <1, 0, 0> radiance = 1e38 }", D_VALUE_OUT_OF_RANGE);
}

/* ---- environment ---- */

static float image_pixel;
static uint32_t image_width = 4;

static Status load_image(void *context, const char *path, const char *space, float **rgb, uint32_t *width,
                         uint32_t *height, Error *error)
{
    (void)context, (void)path, (void)space, (void)error;
    uint32_t rows = image_width > 4 ? 1 : 2, n = 3 * image_width * rows;
    *rgb = malloc(n * sizeof **rgb);
    if (!*rgb) return STATUS_NOMEM;
    for (uint32_t i = 0; i < n; i++) (*rgb)[i] = 1;
    (*rgb)[13] = image_pixel;
    *width = image_width;
    *height = rows;
    return STATUS_OK;
}

static void environments_are_colours_or_images(void **state)
{
    (void)state;
    char path[] = "/tmp/meniscus-env-XXXXXX", text[1000];
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    SceneOptions options = {.load_image = load_image};
    snprintf(
        text, sizeof text,
        "meniscus 1.0 unit mm environment { image = \"%s\" strength = 2 rotate(y, 90) } camera { from = <0, 0, 1> }",
        path);
    Fixture f;
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        image_pixel = (float)i;
        fixture_build(&f, text, &options);
        assert_int_equal(f.status, STATUS_OK);
        hash[i] = f.scene->hash;
        assert_non_null(f.scene->environment);
        assert_near(affine_determinant(&f.scene->world_to_environment), 1, 1e-12);
        fixture_clear(&f);
    }
    assert_true(hash[0] != hash[1]);
    const float bad[] = {-1, NAN, INFINITY};
    for (size_t i = 0; i < COUNT_OF(bad); i++) {
        image_pixel = bad[i];
        fixture_build(&f, text, &options);
        assert_int_equal(f.status, STATUS_SCENE);
        assert_non_null(strstr(fixture_find(&f, D_IMAGE_INVALID)->text, "green of pixel 0,1"));
        fixture_clear(&f);
    }
    /* the brightest that there may be, and what a strength makes of more */
    const float bright[] = {1e30f, 1e-3f};
    const char *const strengths[] = {"1", "1e30", "1.1", "1e31"};
    for (size_t i = 0; i < COUNT_OF(strengths); i++) {
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm environment { image = \"%s\" strength = %s } camera { from = <0, 0, 1> }", path,
                 strengths[i]);
        image_pixel = bright[i % 2];
        fixture_build(&f, text, &options);
        assert_int_equal(f.status, i < 2 ? STATUS_OK : STATUS_SCENE);
        if (i >= 2) {
            assert_int_equal(f.diag.n_errors, 1);
            const Diagnostic *report = fixture_find(&f, D_VALUE_OUT_OF_RANGE);
            assert_non_null(strstr(report->text, "beyond what can be rendered"));
            assert_memory_equal(text + report->span.begin, strengths[i], strlen(strengths[i]));
        }
        fixture_clear(&f);
    }
    /* one that is too wide is not taken as black */
    image_pixel = 1;
    image_width = 1 << 18;
    snprintf(text, sizeof text, "meniscus 1.0 unit mm environment { image = \"%s\" } camera { from = <0, 0, 1> }",
             path);
    fixture_build(&f, text, &options);
    assert_int_equal(f.status, STATUS_SCENE);
    assert_non_null(strstr(fixture_find(&f, D_IMAGE_INVALID)->text, "262144 by 1 pixels"));
    fixture_clear(&f);
    image_width = 4;
    remove(path);
    const char *const refused[] = {"scale(2)", "scale(<-1, 1, 1>)", "sky = clear image = \"x.exr\"",
                                   "image = \"there-is-none.exr\""};
    const DiagCode codes[] = {D_SINGULAR_TRANSFORM, D_SINGULAR_TRANSFORM, D_CONFLICTING_PROPERTIES, D_FILE_NOT_FOUND};
    for (size_t i = 0; i < COUNT_OF(refused); i++) {
        snprintf(text, sizeof text, "meniscus 1.0 unit mm environment { %s } camera { from = <0, 0, 1> }", refused[i]);
        fixture_refused(text, codes[i]);
    }
}

static void environments_are_functions(void **state)
{
    (void)state;
    Fixture f;
    uint64_t hash[2];
    for (int i = 0; i < 2; i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm def sky(p, normal) = rgb(1 + p.x, 2 + p.y, 3 + %d * p.z + max(0, normal.z)) def "
                 "even(x, y, z) = 2 "
                 "environment { function = sky  strength = 2 } camera { from = <0, 0, 1> }",
                 i);
        fixture_build(&f, text, &(SceneOptions){0});
        assert_int_equal(f.status, STATUS_OK);
        hash[i] = f.scene->hash;
        assert_int_equal(environment_width(f.scene->environment), 2048);
        for (int k = 0; k < 200; k++) {
            double y = (k + 0.5) / 100 - 1, turn = 2.4 * k, r = sqrt(1 - y * y), x = r * cos(turn), z = r * sin(turn);
            double wanted = 2 * (0.2126 * (1 + x) + 0.7152 * (2 + y) + 0.0722 * (3 + i * z + fmax(0, -z)));
            double found = (double)environment_luminance(f.scene->environment, vec3f((float)x, (float)y, (float)z));
            assert_near(found / wanted, 1, 0.003);
        }
        fixture_clear(&f);
    }
    assert_true(hash[0] != hash[1]);
    static const struct {
        const char *text;
        DiagCode code;
    } refused[] = {{"function = low", D_VALUE_OUT_OF_RANGE},
                   {"function = nothing", D_VALUE_OUT_OF_RANGE},
                   {"sky = clear  color = 1", D_CONFLICTING_PROPERTIES},
                   {"function = good  sky = clear", D_CONFLICTING_PROPERTIES},
                   {"resolution = 64", D_CONFLICTING_PROPERTIES},
                   {"color = good", D_WRONG_TYPE},
                   {"function = good  resolution = 8", D_VALUE_OUT_OF_RANGE},
                   {"function = good  strength = 1e35", D_VALUE_OUT_OF_RANGE}};
    for (size_t i = 0; i < COUNT_OF(refused); i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm def good(p) = 1 + p.x def low(p) = p.y def nothing(p) = 1 / max(0, p.y) "
                 "environment { %s } camera { from = <0, 0, 1> }",
                 refused[i].text);
        fixture_refused(text, refused[i].code);
    }
}

/* ---- cameras, film, render ---- */

static void cameras_look_where_they_should(void **state)
{
    (void)state;
    Fixture f;
    fixture_good(&f, M "sphere { interior = glass } environment { }"
                       "camera a { from = <0, 0, 5> to = <0, 0, 0> fov = 90 aperture = 2 focus = <3, 0, 1> }"
                       "camera b { from = <0, 5, 0> expect = [] } camera c { from = <0, 0, 5> expect = [water, glass] }"
                       "group { translate(<1, 0, 0>) camera d { from = <0, 0, 5> } }");
    const SceneCamera *c = f.scene->cameras;
    assert_int_equal(f.scene->n_cameras, 4);
    assert_vector(c[0].right, 1, 0, 0);
    assert_vector(c[0].up, 0, 1, 0);
    assert_vector(c[0].forward, 0, 0, -1);
    assert_near(c[0].half_width, 1, 1e-12);
    assert_near(c[0].lens_radius, 1, 1e-12);
    assert_near(c[0].focus[0], 0, 0);
    assert_near(c[0].focus[1], 0, 0);
    assert_near(c[0].focus[2], 0.25, 1e-12);
    assert_vector(c[1].forward, 0, -1, 0);
    assert_vector(c[1].right, 1, 0, 0);
    assert_non_null(c[1].expect);
    assert_int_equal(c[1].n_expect, 0);
    assert_int_equal(c[2].n_expect, 2);
    assert_string_equal(f.scene->media[c[2].expect[0]].name, "water");
    assert_null(c[0].expect);
    assert_vector(c[3].from, 1, 0, 5);
    assert_near(c[3].focus[2], 0.2, 1e-12);
    fixture_clear(&f);
    REFUSED("camera { from = <1, 1, 1> to = <1, 1, 1> }", D_DEGENERATE_SHAPE);
    REFUSED("camera { from = <0, 1, 0> up = <0, 1, 0> }", D_DEGENERATE_SHAPE);
    REFUSED("camera { from = <0, 1, 0> fov = 180 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 1, 0> aperture = 1 focus = <0, 2, 0> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 1, 0> focus = <0, 0, 0> }", D_CONFLICTING_PROPERTIES);
    REFUSED("camera { to = <0, 1, 0> }", D_MISSING_PROPERTY);
    REFUSED("camera { from = <0, 6, 1> upright = true }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 6, 0> upright = true }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 1, 0> projection = fisheye upright = true }", D_CONFLICTING_PROPERTIES);
    REFUSED("camera { from = <0, 1, 0> projection = panorama shift = <0, .1> }", D_CONFLICTING_PROPERTIES);
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [] }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [0 * x, x, y, z] }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [0 * x, 10 * z] }", D_VALUE_OUT_OF_RANGE);
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [0 * x, x] }", D_DEGENERATE_SHAPE);  /* across anyway */
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [-1 * z, z] }", D_DEGENERATE_SHAPE); /* seen edge-on */
    REFUSED("camera { from = <0, 0, 9> aperture = 1 focus = [0 * x, x + y, 2 * (x + y)] }", D_DEGENERATE_SHAPE);
    REFUSED("camera { from = <0, 0, 9> projection = orthographic width = 4 aperture = 1 focus = [x, x + y, x + z] }",
            D_DEGENERATE_SHAPE);
    fixture_refused(M "sphere { interior = glass } environment { }", D_NO_CAMERA);
    fixture_refused("meniscus 1.0 unit mm camera { from = <0, 0, 1> }", D_NOTHING_TO_RENDER);
    fixture_text(&f, "meniscus 1.0 unit mm camera { from = <0, 0, 1> } ground { y = -1 }");
    assert_int_equal(f.status, STATUS_OK);
    assert_non_null(fixture_find(&f, D_NO_LIGHT));
    fixture_clear(&f);
}

static void settings_reach_the_scene(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "film { size = <320, 200> filter = box output = \"a.exr\" } render { samples = 7 noise = .01 bounces = 3 "
             "nesting = "
             "entered seed = 9 }");
    assert_int_equal(f.scene->film.width, 320);
    assert_int_equal(f.scene->film.height, 200);
    assert_true(f.scene->film.box);
    assert_int_equal(f.scene->film.n_outputs, 1);
    assert_string_equal(f.scene->film.outputs[0], "a.exr");
    assert_int_equal(f.scene->render.samples, 7);
    assert_int_equal(f.scene->render.bounces, 3);
    assert_int_equal(f.scene->render.seed, 9);
    assert_int_equal(f.scene->render.nesting, NEST_ENTERED);
    fixture_clear(&f);
    GOOD(&f, "film { output = [\"a.exr\", \"b.png\"] } render { nesting = none }");
    assert_false(f.scene->film.box);
    assert_int_equal(f.scene->film.n_outputs, 2);
    assert_int_equal(f.scene->film.width, 640);
    assert_int_equal(f.scene->render.nesting, NEST_NONE);
    assert_int_equal(f.scene->render.samples, 256);
    fixture_clear(&f);
    REFUSED("film { size = <10.5, 10> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("film { size = <0, 10> }", D_VALUE_OUT_OF_RANGE);
    REFUSED("render { samples = 0 }", D_VALUE_OUT_OF_RANGE);
    REFUSED("render { nesting = sideways }", D_UNKNOWN_CHOICE);
}

/* ---- names and hashes ---- */

static void things_have_names(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f, "sphere { interior = glass } sphere drop { interior = glass } sphere { interior = glass } box { size = "
             "<1, 1, 1> interior = glass }"
             "def bead(i) { sphere bead { interior = glass center = <i, 0, 0> } } bead(3) bead(6)");
    static const char *const names[] = {"sphere 1", "drop", "sphere 2", "box 1", "bead", "bead 2"};
    for (uint32_t i = 0; i < COUNT_OF(names); i++) assert_string_equal(f.scene->objects[i].name, names[i]);
    fixture_clear(&f);
}

static uint64_t hash_of(const char *body)
{
    char text[1000];
    Fixture f;
    snprintf(text, sizeof text, "%s%s%s", M, body, V);
    fixture_good(&f, text);
    uint64_t hash = f.scene->hash;
    fixture_clear(&f);
    return hash;
}

static void the_hash_is_of_the_meaning(void **state)
{
    (void)state;
    uint64_t hash = hash_of("sphere { interior = glass }");
    assert_true(
        hash ==
        hash_of(" /* note */ sphere ball { interior = glass } film { output = \"x.exr\" } render { samples = 3 }"));
    assert_true(hash == hash_of("medium unused { ior = 2 } sphere { interior = glass }"));
    assert_true(hash == hash_of("medium g { ior = 3 / 2 state = solid } sphere { interior = g }"));
    static const char *const others[] = {"sphere { interior = water }",
                                         "sphere { interior = glass radius = 1.001 }",
                                         "sphere { interior = glass priority = 1 }",
                                         "sphere { surface = surface { } }",
                                         "sphere { interior = glass } render { bounces = 3 }",
                                         "sphere { interior = glass } render { seed = 1 }",
                                         "sphere { interior = glass } render { nesting = priority }",
                                         "sphere { interior = glass } film { size = <641, 480> }",
                                         "sphere { interior = glass } ground { y = -5 }",
                                         "sphere { interior = glass } light { shape = distant to = <1, 0, 0> }",
                                         "world { medium = water } sphere { interior = glass }",
                                         "sphere { interior = glass translate(<0, 1e-9, 0>) }",
                                         "sphere { interior = glass } sphere { interior = glass }"};
    for (size_t i = 0; i < COUNT_OF(others); i++) assert_true(hash != hash_of(others[i]));
    /* one medium or two of equal properties: overlapping objects merge or they do not */
    assert_true(hash_of("medium g { ior = 1.5 state = solid } sphere { interior = glass } sphere { interior = g center "
                        "= <1, 0, 0> }") !=
                hash_of("sphere { interior = glass } sphere { interior = glass center = <1, 0, 0> }"));
    /* what the camera does not see */
    assert_true(hash_of("light { shape = distant to = <1, 0, 0> visible = false }") !=
                hash_of("light { shape = distant to = <1, 0, 0> visible = true }"));
    assert_true(hash_of("light { shape = distant to = <1, 0, 0> }") ==
                hash_of("light { shape = distant to = <1, 0, 0> visible = true }"));
    /* lines between the wavelengths that tables keep */
    assert_true(
        hash_of("light { shape = distant to = <1, 0, 0> color = spectrum([<583, 0>, <583.1, 1>, <583.2, 0>]) }") !=
        hash_of("light { shape = distant to = <1, 0, 0> color = spectrum([<583, 0>, <583.15, 1>, <583.2, 0>]) }"));
}

/* What has no effect, or does not go together, is refused; so is each number outside of its range. */
static void surfaces_are_checked(void **state)
{
    (void)state;
#define THING(text) M text V
#define ON(surface) THING("sphere { surface = surface { " surface " } }")
    static const char *const in_conflict[] = {
        ON("specular = .5"),
        ON("ior = 1.5 tint = .5"),
        ON("thin = true ior = 1.5 translucency = .5 tint = .5"),
        ON("ior = 1.5 transmission = 1"),
        ON("thin = true transmission = 1"),
        ON("translucency = .5"),
        ON("film = 1"),
        ON("metal = gold albedo = .5"),
        ON("metal = gold ior = 1.5"),
        ON("anisotropy = .5"),
        ON("coat_anisotropy = .5"),
        ON("metal = gold grain = x"),
        ON("metal = gold grain_angle = 20"),
        ON("coat_tint = .5"),
        ON("fuzz_color = .5"),
        ON("fuzz_roughness = .5"),
        ON("weight = .5"),
        ON("albedo = .5 mix = [surface { }, surface { albedo = 1 }]"),
        ON("mix = [surface { emission = 1 }, surface { albedo = 1 }]"),
        ON("mix = [surface { roughness = .5 }, surface { albedo = 1 }]"),
        THING("sphere { interior = glass surface = surface { coat = 1 } }"),
        THING("sphere { interior = glass surface = surface { transmission = .5 coat = 1 } }"),
        THING("sphere { interior = glass surface = surface { transmission = .5 thin = true } }"),
        THING("sphere { interior = glass surface = surface { transmission = .5 emission = 1 } }"),
        THING("sphere { interior = glass surface = surface { mix = [surface { }, surface { roughness = 1 }] } }"),
    };
    for (size_t i = 0; i < COUNT_OF(in_conflict); i++) fixture_refused(in_conflict[i], D_CONFLICTING_PROPERTIES);
    static const char *const out_of_range[] = {
        ON("albedo = -.1"),
        ON("albedo = rgb(.5, 1.1, .5)"),
        ON("ior = 0"),
        ON("ior = -1.5"),
        ON("roughness = 1.1"),
        ON("roughness = -.1"),
        ON("diffuse_roughness = 2"),
        ON("ior = 1.5 specular = 2"),
        ON("metalness = -1"),
        ON("metal = gold anisotropy = 1.5"),
        ON("coat = 1.5"),
        ON("coat = 1 coat_ior = .5"),
        ON("coat = 1 coat_roughness = 3"),
        ON("coat = 1 coat_tint = 2"),
        ON("fuzz = -.5"),
        ON("fuzz = 1 fuzz_color = 3"),
        ON("fuzz = 1 fuzz_roughness = -1"),
        ON("thin = true ior = 1.5 transmission = 1.2"),
        ON("thin = true translucency = 7"),
        ON("thin = true ior = 1.5 transmission = 1 film = -1"),
        ON("thin = true ior = 1.5 transmission = 1 tint = 2"),
        ON("mix = [surface { }, surface { albedo = 1 }] weight = 2"),
    };
    for (size_t i = 0; i < COUNT_OF(out_of_range); i++) fixture_refused(out_of_range[i], D_VALUE_OUT_OF_RANGE);
    fixture_refused(ON("thin = true"), D_MISSING_PROPERTY);
    fixture_refused(ON("mix = [surface { albedo = 1 }]"), D_WRONG_TYPE);
    fixture_refused(ON("mix = [1, 2]"), D_WRONG_TYPE);
#undef ON
#undef THING
}

static void surfaces_become_parameters(void **state)
{
    (void)state;
    Fixture f;
    GOOD(&f,
         "surface pane { thin = true ior = 1.5 transmission = .9 film = 400nm tint = .5 }"
         "surface lid { metal = iron metalness = .5 anisotropy = .7 grain = z grain_angle = 90 albedo = .2 }"
         "surface both { mix = [pane, lid] weight = .3 }"
         "sphere { surface = both } sphere { surface = pane } sphere { surface = lid }"
         "sphere { interior = glass surface = surface { transmission = .25 albedo = 1 } }"
         "sphere { interior = glass surface = surface { roughness = .4 anisotropy = .8 grain = x grain_angle = 5 } }"
         "sphere { surface = surface { ior = 1.5 roughness = .4 anisotropy = .5 coat = 1 coat_anisotropy = .3 } }");
    const Scene *scene = f.scene;
    const SceneSurface *brushed = &scene->surfaces[scene->objects[4].surface],
                       *lacquer = &scene->surfaces[scene->objects[5].surface];
    assert_true(brushed->grain == GRAIN_X && !brushed->painted);
    assert_near((double)brushed->spec.specular_roughness_anisotropy, 0.8, 1e-6);
    assert_near((double)lacquer->spec.specular_roughness_anisotropy, 0.5, 1e-6);
    assert_near((double)lacquer->spec.coat_roughness_anisotropy, 0.3, 1e-6);
    const SceneSurface *both = &scene->surfaces[scene->objects[0].surface],
                       *pane = &scene->surfaces[scene->objects[1].surface],
                       *lid = &scene->surfaces[scene->objects[2].surface],
                       *paint = &scene->surfaces[scene->objects[3].surface];
    assert_true(both->mixed && both->thin && !pane->mixed && pane->thin && !lid->thin);
    assert_ptr_equal(&scene->surfaces[both->mix[0]], pane);
    assert_ptr_equal(&scene->surfaces[both->mix[1]], lid);
    assert_near((double)both->spec.mix_weight, 0.3, 1e-6);
    assert_near((double)pane->spec.film_thickness_nm, 400, 1e-3);
    assert_near((double)pane->spec.transmission_weight, 0.9, 1e-6);
    assert_true(lid->grain == GRAIN_Z && lid->spec.measured_metal);
    assert_near(lid->grain_angle, 1.5707963, 1e-6);
    assert_near((double)lid->spec.base_metalness, 0.5, 1e-6);
    assert_true(paint->painted && !pane->painted);
    assert_true(scene_is_thin(scene, 0) && scene_is_thin(scene, 1) && !scene_is_thin(scene, 2) &&
                !scene_is_thin(scene, 3));
    fixture_clear(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_are_checked),
        cmocka_unit_test(surfaces_become_parameters),
        cmocka_unit_test(phases_of_spheres),
        cmocka_unit_test(phases_that_were_measured),
        cmocka_unit_test(media_keep_their_properties),
        cmocka_unit_test(dispersion_can_be_left_out),
        cmocka_unit_test(an_index_that_does_not_change_is_a_number),
        cmocka_unit_test(the_world_is_air_unless_it_is_not),
        cmocka_unit_test(wrong_media_are_refused),
        cmocka_unit_test(surfaces_are_diffuse_or_checkered),
        cmocka_unit_test(volumes_are_exact),
        cmocka_unit_test(shapes_are_shared),
        cmocka_unit_test(a_cylinder_lies_between_its_ends),
        cmocka_unit_test(wrong_shapes_are_refused),
        cmocka_unit_test(meshes_are_checked_and_mended),
        cmocka_unit_test(open_meshes_enclose_nothing),
        cmocka_unit_test(meshes_come_from_files),
        cmocka_unit_test(lights_shine_where_they_are_told),
        cmocka_unit_test(wrong_lights_are_refused),
        cmocka_unit_test(environments_are_colours_or_images),
        cmocka_unit_test(environments_are_functions),
        cmocka_unit_test(cameras_look_where_they_should),
        cmocka_unit_test(settings_reach_the_scene),
        cmocka_unit_test(things_have_names),
        cmocka_unit_test(the_hash_is_of_the_meaning),
    };
    return cmocka_run_group_tests_name("build", tests, NULL, NULL);
}
