/* std_test.c - the standard library against what was published: refractive indices, Abbe numbers, absorption, facets.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"
#include "optics/color.h"
#include "optics/observer.h"
#include "scene/library.h"
#include "scene_fixture.h"

#define USE                                                                                                            \
    "meniscus 1.0 unit mm use \"std/media.mns\" as media use \"std/gems.mns\" as gems "                                \
    "def _uses_both() { gems.rose(interior = media.water) } "                                                          \
    "camera { from = <0, 0, 900> } environment { } "

static void build(Fixture *f, const char *text)
{
    char scene[600];
    snprintf(scene, sizeof scene, USE "%s", text);
    fixture_text(f, scene);
    if (f->status != STATUS_OK || f->diag.n_warnings) {
        fixture_print(f);
        fail_msg("%s: %s", text, f->error.text);
    }
}

static double at(const Spectrum *spectrum, double nm)
{
    return (double)spectrum_at_one(spectrum, (float)nm);
}

/* n at 587.56 nm and V_d of data sheets; n at 589.3 nm of the paper where that is what was given (abbe 0) */
static void media_have_their_published_indices(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double n, abbe, within;
    } rows[] = {
        {"fused_silica", 1.45846, 67.82, 2e-5},
        {"n_bk7", 1.5168, 64.17, 1e-5},
        {"k5", 1.52249, 59.48, 1e-5},
        {"n_bak4", 1.56883, 55.98, 1e-5},
        {"n_lak22", 1.65113, 55.89, 1e-5},
        {"llf1", 1.54814, 45.75, 1e-5},
        {"lf5", 1.58144, 40.85, 1e-5},
        {"f2", 1.62004, 36.37, 1e-5},
        {"n_sf10", 1.72828, 28.53, 1e-5},
        {"n_sf11", 1.78472, 25.68, 1e-5},
        {"n_sf6", 1.80518, 25.36, 1e-5},
        {"n_lasf9", 1.85025, 32.17, 1e-5},
        {"borosilicate", 1.4714, 66.02, 1e-4},
        {"fluorite", 1.43385, 95, 2e-5},
        {"sapphire", 1.7682, 72.2, 1e-4},
        {"diamond", 2.4175, 55.3, 1e-3},
        {"zirconia", 2.1588, 33.5, 1e-3},
        {"quartz", 1.5442, 0, 1e-4},
        {"calcite", 1.6584, 0, 1e-4},
        {"water", 1.33335, 0, 5e-5},
        {"ice", 1.3097, 0, 1e-4},
        {"soda_lime", 1.5233, 0, 1e-4},
        {"ethanol", 1.3616, 0, 1e-4},
        {"glycerol", 1.4722, 0, 1e-4},
        {"acrylic", 1.4905, 0, 1e-3},
        {"polycarbonate", 1.5846, 0, 1e-3},
        {"polystyrene", 1.5915, 0, 1e-3},
        {"pvb", 1.48, 0, 1e-4},
        {"grey_float", 1.5233, 0, 1e-4},
        {"emerald", 1.577, 0, 1e-4},
        {"dry_air", 1.0002768, 0, 1e-6},
        {"honey", 1.4915, 0, 2e-4},
        {"whisky", 1.3555, 0, 1e-4},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        Fixture f;
        char text[200];
        snprintf(text, sizeof text, "sphere { interior = media.%s }", rows[i].name);
        build(&f, text);
        const SceneMedium *medium = &f.scene->media[f.scene->objects[0].medium];
        assert_string_equal(medium->name, rows[i].name);
        assert_true(medium->state != NEST_STATE_UNKNOWN);
        double n = at(&medium->ior, rows[i].abbe > 0 ? 587.5618 : 589.3);
        if (!(fabs(n - rows[i].n) <= rows[i].within)) fail_msg("%s has %.6f, not %.6f", rows[i].name, n, rows[i].n);
        double abbe = (n - 1) / (at(&medium->ior, 486.1327) - at(&medium->ior, 656.2725));
        if (rows[i].abbe > 0 && !(fabs(abbe - rows[i].abbe) <= .15))
            fail_msg("%s has an Abbe number of %.2f, not %.2f", rows[i].name, abbe, rows[i].abbe);
        fixture_clear(&f);
    }
}

static void every_medium_can_be_used(void **state)
{
    (void)state;
    const char *text = NULL;
    for (size_t i = 0; i < std_library.n_files; i++)
        if (strcmp(std_library.files[i].name, "std/media.mns") == 0) text = std_library.files[i].text;
    assert_non_null(text);
    int n = 0;
    for (const char *line = text; (line = strstr(line, "\nmedium ")); n++) {
        line += strlen("\nmedium ");
        Fixture f;
        char scene[200];
        snprintf(scene, sizeof scene, "sphere { interior = media.%.*s }", (int)strcspn(line, " "), line);
        build(&f, scene);
        assert_true(f.scene->media[f.scene->objects[0].medium].state != NEST_STATE_UNKNOWN);
        fixture_clear(&f);
    }
    assert_true(n > 50);
}

/* [Pope, Fry 1997]; ice: 4 pi k / wavelength of [Warren, Brandt 2008] */
static void water_and_ice_absorb_as_measured(void **state)
{
    (void)state;
    Fixture f;
    build(&f, "sphere { interior = media.water } sphere { interior = media.ice  center = <0, 9, 0> }");
    const Spectrum *water = &f.scene->media[f.scene->objects[0].medium].absorption;
    const Spectrum *ice = &f.scene->media[f.scene->objects[1].medium].absorption;
    assert_near(at(water, 440), .00635e-3, 1e-9);
    assert_near(at(water, 550), .0565e-3, 1e-8);
    assert_near(at(water, 600), .2224e-3, 1e-8);
    assert_near(at(water, 700), .624e-3, 1e-8);
    assert_near(at(ice, 600), 4 * 3.14159265 * 5.73e-9 / 600e-6, 1e-10);
    assert_near(at(ice, 400), 4 * 3.14159265 * 2.365e-11 / 400e-6, 1e-12);
    fixture_clear(&f);
}

/* 4 pi k / wavelength of [Rubin 1985] */
static void float_glass_absorbs_as_measured(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double k;
    } rows[] = {{"float_glass", 2.2e-7},
                {"low_iron_glass", 4.632e-8},
                {"green_float", 1.169e-6},
                {"bronze_float", 3.725e-6},
                {"grey_float", 4.913e-6}};
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        Fixture f;
        char text[200];
        snprintf(text, sizeof text, "sphere { interior = media.%s }", rows[i].name);
        build(&f, text);
        const SceneMedium *glass = &f.scene->media[f.scene->objects[0].medium];
        assert_near(at(&glass->absorption, 550), 4 * 3.14159265 * rows[i].k / 550e-6, 1e-7);
        fixture_clear(&f);
    }
}

static void air_follows_its_density(void **state)
{
    (void)state;
    Fixture f;
    build(&f, "sphere { interior = media.air_at(15, 500) } sphere { interior = media.air_at(40)  center = <0, 9, 0> }");
    assert_near(at(&f.scene->media[f.scene->objects[0].medium].ior, 589.3) - 1, 2.768e-4 * 500 / 1013.25, 3e-7);
    assert_near(at(&f.scene->media[f.scene->objects[1].medium].ior, 589.3) - 1, 2.768e-4 * 288.15 / 313.15, 3e-7);
    fixture_clear(&f);
}

/* Planes that the triangles of a mesh lie in; and the mesh is convex: no vertex stands in front of any of them. */
static size_t count_facets(const char *name, const Mesh *mesh, double size)
{
    enum { MOST = 400 };
    struct {
        Vec3 normal;
        double distance;
    } planes[MOST];
    size_t n = 0;
    for (size_t t = 0; t < mesh->n_triangles; t++) {
        Vec3 p[3];
        for (int i = 0; i < 3; i++) p[i] = vec3_from_f(mesh->positions[mesh->triangles[t][i]]);
        Vec3 normal = vec3_normalize(vec3_cross(vec3_sub(p[1], p[0]), vec3_sub(p[2], p[0])));
        double distance = vec3_dot(normal, p[0]);
        for (size_t i = 0; i < mesh->n_vertices; i++) {
            double above = vec3_dot(normal, vec3_from_f(mesh->positions[i])) - distance;
            if (above > 1e-5 * size) fail_msg("%s: a corner stands %g in front of triangle %zu", name, above, t);
        }
        size_t i = 0;
        while (i < n &&
               !(vec3_dot(planes[i].normal, normal) > 1 - 1e-8 && fabs(planes[i].distance - distance) < 1e-4 * size))
            i++;
        if (i == n && n < MOST) {
            planes[n].normal = normal;
            planes[n++].distance = distance;
        }
    }
    return n;
}

static void gems_have_their_facets(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        size_t n_facets;
        double size;
    } rows[] = {
        {"gems.round_brilliant()", 57 + 16, 5},
        {"gems.round_brilliant { crown_angle = 32 pavilion_angle = 42 table = .6 girdle = .01 }", 57 + 16, 5},
        {"gems.round_brilliant { radius = 1m }", 57 + 16, 1000},
        {"gems.rose()", 24 + 1, 5},
        {"gems.emerald_cut()", 1 + 3 * 8 + 8 + 3 * 8, 6},
        {"gems.emerald_cut { width = 6 length = 6 corner = .3 }", 1 + 3 * 8 + 8 + 3 * 8, 4},
        {"gems.princess()", 1 + 4 + 4 + 4 * (1 + 2 + 2), 4},
        {"gems.faceted([[90, 1, [96, 24, 48, 72]], [45, .92, [0, 24, 48, 72]], [-41, .66, [12, 36, 60, 84]], [0, .6], "
         "[0, -.8]])",
         4 + 4 + 4 + 2, 5},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        Fixture f;
        build(&f, rows[i].text);
        const SceneShape *shape = &f.scene->shapes[f.scene->objects[0].shape];
        size_t n = count_facets(rows[i].text, shape->mesh, rows[i].size);
        if (n != rows[i].n_facets) fail_msg("%s has %zu facets, not %zu", rows[i].text, n, rows[i].n_facets);
        fixture_clear(&f);
    }
}

/* Chromaticities by the CIE 1931 observer, as they are published with the illuminants: ISO/CIE 11664-2, CIE 15:2018. */
static void illuminants_have_their_chromaticities(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        double x, y;
    } rows[] = {
        {"illuminant_a()", 0.44758, 0.40745},    {"illuminant_d50()", 0.34567, 0.35851},
        {"illuminant_d55()", 0.33243, 0.34744},  {"illuminant_d65()", 0.31271, 0.32903},
        {"illuminant_d()", 0.31271, 0.32903},    {"illuminant_d(7504K)", 0.29903, 0.31488},
        {"illuminant_e()", 0.33333, 0.33333},    {"illuminant_f2()", 0.3721, 0.3751},
        {"illuminant_f7()", 0.3129, 0.3292},     {"illuminant_f11()", 0.3805, 0.3769},
        {"illuminant_led_b3()", 0.3756, 0.3723},
    };
    for (size_t i = 0; i < COUNT_OF(rows); i++) {
        Fixture f;
        char text[300];
        snprintf(text, sizeof text,
                 "use \"std/lights.mns\" as lights light { shape = sphere  radius = 1  color = lights.%s }",
                 rows[i].name);
        build(&f, text);
        const Spectrum *radiance = &f.scene->lights[0].radiance;
        double xyz[3] = {0};
        for (int k = 0; k < SPECTRUM_SAMPLES; k++)
            for (int c = 0; c < 3; c++)
                xyz[c] += at(radiance, (double)SPECTRUM_MIN_NM + k * SPECTRUM_STEP_NM) * (double)observer_xyz[k][c];
        double sum = xyz[0] + xyz[1] + xyz[2], x = xyz[0] / sum, y = xyz[1] / sum;
        printf("%-20s x %.5f y %.5f, published %.5f %.5f\n", rows[i].name, x, y, rows[i].x, rows[i].y);
        assert_near(x, rows[i].x, 1e-4);
        assert_near(y, rows[i].y, 1e-4);
        assert_near(spectrum_luminance(radiance), 1, 1e-4); /* as bright as white */
        fixture_clear(&f);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(media_have_their_published_indices),
        cmocka_unit_test(every_medium_can_be_used),
        cmocka_unit_test(water_and_ice_absorb_as_measured),
        cmocka_unit_test(float_glass_absorbs_as_measured),
        cmocka_unit_test(air_follows_its_density),
        cmocka_unit_test(gems_have_their_facets),
        cmocka_unit_test(illuminants_have_their_chromaticities),
    };
    return cmocka_run_group_tests_name("std", tests, NULL, NULL);
}
