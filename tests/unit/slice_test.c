/* slice_test.c - cross-sections: the owner of each place against formulas, overlaps, gaps, opaque things, threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include <math.h>

#include "near.h"
#include "check/slice.h"
#include "image/font.h"
#include "scene_fixture.h"

enum { WIDTH = 96, HEIGHT = 64 };

typedef struct Cut {
    Fixture f;
    SlicePlane plane;
    SliceImage image;
} Cut;

static void cut_scene(Cut *cut, const char *text, Vec3 point, Vec3 normal, unsigned n_threads)
{
    Error error;
    Pool *pool = NULL;
    fixture_compile(&cut->f, text, 1);
    if (n_threads > 1) assert_int_equal(pool_new(n_threads, &pool, &error), STATUS_OK);
    assert_true(slice_plane_make(cut->f.compiled, point, normal, &cut->plane));
    Status status = slice_draw(cut->f.compiled, pool, &cut->plane, WIDTH, HEIGHT, &cut->image, &error);
    if (status != STATUS_OK) fail_msg("%s", error.text);
    pool_free(pool);
}

static void cut_clear(Cut *cut)
{
    slice_image_clear(&cut->image);
    fixture_clear(&cut->f);
}

static Vec3 place_of(const Cut *cut, uint32_t x, uint32_t y)
{
    const SlicePlane *p = &cut->plane;
    Vec3 row = vec3_along(p->center, p->height * (0.5 - (y + 0.5) / HEIGHT), p->up);
    return vec3_along(row, p->width * ((x + 0.5) / WIDTH - 0.5), p->right);
}

static const char *name_at(const Cut *cut, uint32_t x, uint32_t y)
{
    uint32_t hull = cut->image.owner[y * WIDTH + x];
    return hull == SCENE_NONE ? "world" : cut->f.scene->objects[cut->f.compiled->object_of_hull[hull]].name;
}

static bool has_color(const Cut *cut, uint32_t x, uint32_t y, const float rgb[3])
{
    const float *pixel = &cut->image.rgb[3 * (y * WIDTH + x)];
    return fabsf(pixel[0] - rgb[0]) + fabsf(pixel[1] - rgb[1]) + fabsf(pixel[2] - rgb[2]) < 1e-4f;
}

#define DRINK                                                                                                          \
    FIXTURE_MEDIA                                                                                                      \
    "lathe tumbler { interior = glass profile = [<0, 0>, <40, 0>, <40, 92>, <37, 92>, <37, 10>, <0, 10>] } "           \
    "cylinder drink { interior = water from = <0, 9.5, 0> to = <0, 44, 0> radius = 37.5 } "                            \
    "sphere bubble { interior = gas radius = 8 center = <5, 25, 0> } "
#define VIEW FIXTURE_VIEW

static void every_place_has_its_owner(void **state)
{
    (void)state;
    static const struct {
        Vec3 point, normal;
    } planes[] = {{{0, 0, 0}, {0, 0, 1}}, {{3, 0, 0}, {1, 0, 0}}, {{0, 30, 0}, {0, 1, 0}}, {{0, 20, 0}, {1, 2, 3}}};
    for (size_t i = 0; i < COUNT_OF(planes); i++) {
        Cut cut;
        uint32_t n_near = 0, n_owned = 0;
        cut_scene(&cut, DRINK VIEW, planes[i].point, planes[i].normal, 1);
        for (uint32_t y = 0; y < HEIGHT; y++)
            for (uint32_t x = 0; x < WIDTH; x++) {
                Vec3 p = place_of(&cut, x, y);
                double r = hypot(p.x, p.z), bubble = vec3_length(vec3_sub(p, vec3(5, 25, 0))) - 8;
                double edges[] = {r - 40, r - 37, p.y, p.y - 92, p.y - 10, p.y - 44, bubble};
                bool near = false;
                for (size_t k = 0; k < COUNT_OF(edges); k++) near = near || fabs(edges[k]) < 1e-6;
                bool wall = r < 40 && p.y > 0 && p.y < 92 && (r > 37 || p.y < 10);
                bool drink = r < 37.5 && p.y > 9.5 && p.y < 44;
                const char *expected = wall ? "tumbler" : bubble < 0 ? "bubble" : drink ? "drink" : "world";
                n_near += near;
                n_owned += strcmp(expected, "world") != 0;
                if (!near && strcmp(name_at(&cut, x, y), expected) != 0)
                    fail_msg("plane %zu, %g %g %g: %s, not %s", i, p.x, p.y, p.z, name_at(&cut, x, y), expected);
            }
        assert_true(n_near < 200 && n_owned > 1000);
        assert_true(cut.image.overlaps && !cut.image.opaque && cut.image.n_gaps == 0);
        cut_clear(&cut);
    }
}

/* A gap of a ten-thousandth of a pixel is marked along its whole length, whichever way it runs. */
static void thin_gaps_are_marked(void **state)
{
    (void)state;
    for (int turn = 0; turn < 4; turn++) {
        char text[1000];
        snprintf(text, sizeof text,
                 FIXTURE_MEDIA
                 "group { rotate(<0, 0, %d>) box a { interior = glass from = <-40, -40, -40> to = <0, 40, 40> } "
                 "box b { interior = water from = <.0001, -40, -40> to = <40, 40, 40> } }" VIEW,
                 90 * turn + (turn == 3 ? 30 : 0));
        Cut cut;
        cut_scene(&cut, text, vec3(0, 0, 1), vec3(0, 0, 1), 1);
        assert_true(cut.image.n_gaps > 60);
        assert_near(cut.image.least_gap, 1e-4, 2e-5);
        uint32_t n_red = 0;
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
            const float *pixel = &cut.image.rgb[3 * i];
            n_red += pixel[0] > 0.7f && pixel[1] < 0.4f && pixel[2] < 0.4f;
        }
        assert_true(n_red > 50 && n_red < 400);
        cut_clear(&cut);
    }
    Cut cut; /* faces at one place are none */
    cut_scene(&cut,
              FIXTURE_MEDIA "box a { interior = glass from = <-40, -40, -40> to = <0, 40, 40> } "
                            "box b { interior = water from = <0, -40, -40> to = <40, 40, 40> }" VIEW,
              vec3(0, 0, 1), vec3(0, 0, 1), 1);
    assert_int_equal(cut.image.n_gaps, 0);
    cut_clear(&cut);
}

static void opaque_things_are_dark(void **state)
{
    (void)state;
    Cut cut;
    cut_scene(&cut,
              FIXTURE_MEDIA
              "sphere a { interior = glass radius = 30 } box b { size = <20, 20, 20> surface = surface { } } "
              "ground { y = -20 } difference { surface = surface { } box { from = <-29, 12, -5> to = <29, 24, 5> } "
              "box { from = <-20, 9, -9> to = <20, 20, 9> } }" VIEW,
              vec3(0, 0, 0), vec3(0, 0, 1), 1);
    uint32_t n = 0;
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            Vec3 p = place_of(&cut, x, y);
            double edges[] = {fabs(p.x) - 10, fabs(p.y) - 10, p.y + 20,       fabs(p.x) - 29,
                              p.y - 12,       p.y - 24,       fabs(p.x) - 20, p.y - 20};
            bool near = false;
            for (size_t k = 0; k < COUNT_OF(edges); k++) near = near || fabs(edges[k]) < 2;
            bool box = fabs(p.x) < 10 && fabs(p.y) < 10, ground = p.y < -20;
            bool bridge = fabs(p.x) < 29 && p.y > 12 && p.y < 24 && !(fabs(p.x) < 20 && p.y < 20);
            if (near) continue;
            n += box || ground || bridge;
            assert_int_equal(has_color(&cut, x, y, slice_opaque_color), box || ground || bridge);
        }
    assert_true(n > 300 && cut.image.opaque);
    cut_clear(&cut);
}

static void overlaps_are_hatched(void **state)
{
    (void)state;
    Cut cut;
    cut_scene(&cut,
              FIXTURE_MEDIA "box a { interior = glass from = <-40, -30, -9> to = <10, 30, 9> } "
                            "box b { interior = water from = <-10, -30, -9> to = <40, 30, 9> } "
                            "sphere c { interior = gas radius = 5 center = <25, 0, 0> }" VIEW,
              vec3(0, 0, 0), vec3(0, 0, 1), 1);
    float glass[3], water[3];
    uint32_t n_other = 0, n_own = 0;
    slice_color(cut.f.scene->objects[fixture_object(&cut.f, "a")].medium, glass);
    slice_color(cut.f.scene->objects[fixture_object(&cut.f, "b")].medium, water);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++) {
            Vec3 p = place_of(&cut, x, y);
            if (fabs(p.y) > 28) continue;
            if (fabs(p.x) < 8) {
                n_own += has_color(&cut, x, y, glass);
                n_other += !has_color(&cut, x, y, glass);
            }
            if (p.x > -38 && p.x < -12) assert_true(has_color(&cut, x, y, glass));
            if (p.x > 32 && p.x < 38) assert_true(has_color(&cut, x, y, water));
        }
    assert_true(n_other > n_own / 3 && n_own > n_other); /* 3 of 8 */
    cut_clear(&cut);
}

static void threads_do_not_matter(void **state)
{
    (void)state;
    Cut one, many;
    cut_scene(&one, DRINK VIEW, vec3(0, 20, 0), vec3(1, 2, 3), 1);
    cut_scene(&many, DRINK VIEW, vec3(0, 20, 0), vec3(1, 2, 3), 3);
    assert_memory_equal(one.image.rgb, many.image.rgb, 3 * WIDTH * HEIGHT * sizeof(float));
    assert_memory_equal(one.image.owner, many.image.owner, WIDTH * HEIGHT * sizeof(uint32_t));
    cut_clear(&one);
    cut_clear(&many);
}

static void planes_hold_what_they_cut(void **state)
{
    (void)state;
    Fixture f;
    SlicePlane plane;
    fixture_compile(&f,
                    FIXTURE_MEDIA "box { interior = glass from = <1, 2, 3> to = <5, 4, 9> } "
                                  "sphere { interior = glass center = <99, 0, 0> }" VIEW,
                    1);
    assert_true(slice_plane_make(f.compiled, vec3(2, 0, 0), vec3(-3, 0, 0), &plane));
    assert_near(plane.right.z, 1, 1e-12);
    assert_near(plane.up.y, 1, 1e-12);
    assert_near(plane.center.z, 6, 1e-12);
    assert_near(plane.center.y, 3, 1e-12);
    assert_near(plane.width, 6 * 1.1, 1e-9); /* the sphere is not met */
    assert_true(slice_plane_make(f.compiled, vec3(0, 3, 0), vec3(0, 1, 0), &plane));
    assert_near(plane.right.x, 1, 1e-12);
    assert_near(plane.up.z, 1, 1e-12);
    assert_true(slice_plane_make(f.compiled, vec3(0, 0, 500), vec3(0, 0, 1), &plane)); /* past everything */
    assert_true(plane.width > 95);
    fixture_clear(&f);
    fixture_compile(&f, FIXTURE_MEDIA VIEW, 1);
    assert_false(slice_plane_make(f.compiled, vec3(0, 0, 0), vec3(0, 0, 1), &plane));
    fixture_clear(&f);
}

/* Of the legend: lengths of a gap are often so short. */
static void the_sign_of_micro_is_drawn(void **state)
{
    (void)state;
    static const char *const names[] = {"R", "G", "B"};
    const float white[3] = {1, 1, 1};
    const char *const texts[] = {"\xc2\xb5", "?", "u"};
    Image pictures[COUNT_OF(texts)];
    Error error;
    size_t size = 0;
    for (size_t i = 0; i < COUNT_OF(texts); i++) {
        assert_int_equal(image_new(FONT_ADVANCE, FONT_HEIGHT, names, 3, &pictures[i], &error), STATUS_OK);
        font_draw(&pictures[i], 0, 0, 1, texts[i], white);
        size = FONT_ADVANCE * FONT_HEIGHT * pictures[i].n_channels * sizeof *pictures[i].pixels;
    }
    assert_int_equal(font_width(texts[0], 1), FONT_ADVANCE);
    assert_int_not_equal(memcmp(pictures[0].pixels, pictures[1].pixels, size), 0);
    assert_int_not_equal(memcmp(pictures[0].pixels, pictures[2].pixels, size), 0);
    for (size_t i = 0; i < COUNT_OF(texts); i++) image_clear(&pictures[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_place_has_its_owner),  cmocka_unit_test(thin_gaps_are_marked),
        cmocka_unit_test(opaque_things_are_dark),     cmocka_unit_test(overlaps_are_hatched),
        cmocka_unit_test(threads_do_not_matter),      cmocka_unit_test(planes_hold_what_they_cut),
        cmocka_unit_test(the_sign_of_micro_is_drawn),
    };
    return cmocka_run_group_tests_name("slice", tests, NULL, NULL);
}
