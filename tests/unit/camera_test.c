/* camera_test.c - where the rays of a camera start and where they go, and how far apart those of neighbouring pixels are.
 * SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "near.h"
#include "scene_fixture.h"
#include "trace/path.h"

enum { WIDTH = 40, HEIGHT = 30 };

typedef struct View {
    Fixture fixture;
    SceneCamera camera;
} View;

static void open_view(View *view, const char *camera)
{
    char text[500];
    snprintf(
        text, sizeof text,
        "meniscus 1.0 unit mm film { size = <40, 30> } sphere { radius = 1  surface = surface { } } environment { } "
        "camera { %s }",
        camera);
    fixture_good(&view->fixture, text);
    view->camera = view->fixture.scene->cameras[0];
}

static void look(const View *view, double x, double y, Ray *ray, Footprint *footprint)
{
    const float middle[2] = {0.5f, 0.5f};
    assert_true(camera_ray(&view->camera, (FilmPoint){x, y, WIDTH, HEIGHT}, middle, ray, footprint));
}

static bool sees(const View *view, double x, double y)
{
    const float middle[2] = {0.5f, 0.5f};
    Ray ray;
    Footprint footprint;
    return camera_ray(&view->camera, (FilmPoint){x, y, WIDTH, HEIGHT}, middle, &ray, &footprint);
}

static void expect_vector(Vec3 expected, Vec3 is, double tolerance)
{
    assert_near(is.x, expected.x, tolerance);
    assert_near(is.y, expected.y, tolerance);
    assert_near(is.z, expected.z, tolerance);
}

/* Half of the distance between rays of neighbours in the middle of the film is what the footprint says. */
static void expect_footprint(const View *view)
{
    Ray left, right;
    Footprint footprint;
    look(view, 19.5, 15, &left, &footprint);
    look(view, 20.5, 15, &right, &footprint);
    for (double t = 0; t < 20; t += 4) {
        double apart = vec3_length(vec3_sub(ray_point(&right, t), ray_point(&left, t)));
        assert_near((double)footprint.width + t * (double)footprint.spread, apart / 2, 2e-3 * (apart + 1e-3));
    }
}

static void perspective(void **state)
{
    (void)state;
    View view;
    Ray ray;
    Footprint footprint;
    open_view(&view, "from = <0, 0, 10>  fov = 90");
    look(&view, 40, 15, &ray, &footprint);
    expect_vector(vec3(0, 0, 10), ray.origin, 0);
    expect_vector(vec3_normalize(vec3(1, 0, -1)), vec3_from_f(ray.direction), 1e-7);
    look(&view, 20, 0, &ray, &footprint);
    expect_vector(vec3_normalize(vec3(0, 0.75, -1)), vec3_from_f(ray.direction), 1e-7);
    expect_footprint(&view);
    fixture_clear(&view.fixture);
}

/* What a pixel's ray meets is seen in that pixel; what is behind the camera or beside the film in none. */
static void pixels_of_places(void **state)
{
    (void)state;
    static const char *const cameras[] = {"from = <3, 4, 10>  to = <1, 2, 0>  fov = 50",
                                          "projection = orthographic  from = <1, 2, 10>  to = <1, 0, 0>  width = 8"};
    for (size_t i = 0; i < COUNT_OF(cameras); i++) {
        View view;
        Ray ray;
        Footprint footprint;
        uint32_t x, y, u, v;
        open_view(&view, cameras[i]);
        for (y = 0; y < HEIGHT; y += 3)
            for (x = 0; x < WIDTH; x += 3) {
                look(&view, x + 0.3, y + 0.6, &ray, &footprint);
                assert_true(camera_pixel(&view.camera, ray_point(&ray, 7 + x), WIDTH, HEIGHT, &u, &v));
                assert_int_equal(u, x);
                assert_int_equal(v, y);
            }
        look(&view, -0.1, 3, &ray, &footprint);
        assert_false(camera_pixel(&view.camera, ray_point(&ray, 7), WIDTH, HEIGHT, &u, &v));
        if (i == 0) assert_false(camera_pixel(&view.camera, vec3(5, 6, 20), WIDTH, HEIGHT, &u, &v));
        fixture_clear(&view.fixture);
    }
    View around;
    uint32_t u, v;
    open_view(&around, "projection = panorama  from = <0, 0, 10>  to = <0, 0, 0>");
    assert_false(camera_pixel(&around.camera, vec3(0, 0, 0), WIDTH, HEIGHT, &u, &v));
    fixture_clear(&around.fixture);
}

static void orthographic(void **state)
{
    (void)state;
    View view;
    Ray ray;
    Footprint footprint;
    open_view(&view, "projection = orthographic  from = <1, 2, 10>  to = <1, 2, 0>  width = 8");
    look(&view, 40, 0, &ray, &footprint);
    expect_vector(vec3(5, 5, 10), ray.origin, 1e-12);
    expect_vector(vec3(0, 0, -1), vec3_from_f(ray.direction), 0);
    look(&view, 0, 22.5, &ray, &footprint);
    expect_vector(vec3(-3, 0.5, 10), ray.origin, 1e-12);
    expect_vector(vec3(0, 0, -1), vec3_from_f(ray.direction), 0);
    assert_near(footprint.width, 0.1, 1e-7);
    assert_near(footprint.spread, 0, 0);
    expect_footprint(&view);
    expect_vector(vec3(-3, -1, 10), scene_camera_place(view.fixture.scene, &view.camera, -1, -1), 1e-12);
    Box3 box = scene_camera_bounds(view.fixture.scene, &view.camera);
    expect_vector(vec3(5, 5, 10), box.max, 1e-12);
    fixture_clear(&view.fixture);
}

/* The width grows with the transforms of a group, and a lens bends rays so that they meet in the plane that is sharp. */
static void orthographic_with_a_lens(void **state)
{
    (void)state;
    View view;
    Ray ray;
    Footprint footprint;
    open_view(&view,
              "projection = orthographic  from = <0, 0, 5>  width = 4  aperture = 1  focus = <9, 9, 1>  scale(2)");
    assert_near(view.camera.half_width, 4, 1e-12);
    for (int i = 0; i < 16; i++) {
        const float lens[2] = {(float)i / 16, (float)(i * 7 % 16) / 16};
        assert_true(camera_ray(&view.camera, (FilmPoint){30, 10, WIDTH, HEIGHT}, lens, &ray, &footprint));
        assert_near(ray.origin.z, 10, 1e-12);
        assert_true(hypot(ray.origin.x - 2, ray.origin.y - 1) <= 1 + 1e-6);
        Vec3 sharp = ray_point(&ray, (ray.origin.z - 2) / -(double)ray.direction.z);
        expect_vector(vec3(2, 1, 2), sharp, 1e-5);
    }
    fixture_clear(&view.fixture);
}

/* A place is seen there, in pixels: both ways. */
static void expect_pixel(const View *view, Vec3 place, double column, double row)
{
    Ray ray;
    Footprint footprint;
    look(view, column, row, &ray, &footprint);
    Vec3 way = vec3_sub(place, ray.origin);
    expect_vector(place, ray_point(&ray, vec3_dot(way, vec3_from_f(ray.direction))), 1e-6 * vec3_length(way));
    uint32_t x, y;
    assert_true(camera_pixel(&view->camera, place, WIDTH, HEIGHT, &x, &y));
    assert_int_equal(x, (uint32_t)(column + 1e-9));
    assert_int_equal(y, (uint32_t)(row + 1e-9));
}

/* What is seen moves by parts of the picture's width, where lines of sight are parallel as well as where they are not. */
static void shifted(void **state)
{
    (void)state;
    View view;
    Vec3 place = vec3(1, -2, 5);
    open_view(&view, "from = <0, 0, 10>  fov = 90");
    expect_pixel(&view, place, 24, 23);
    fixture_clear(&view.fixture);
    open_view(&view, "from = <0, 0, 10>  fov = 90  shift = <.1, -.25>");
    expect_pixel(&view, place, 20, 13);
    fixture_clear(&view.fixture);
    open_view(&view, "from = <0, 0, 10>  projection = orthographic  width = 10");
    expect_pixel(&view, place, 24, 23);
    fixture_clear(&view.fixture);
    open_view(&view, "from = <0, 0, 10>  projection = orthographic  width = 10  shift = <.1, -.25>");
    expect_pixel(&view, place, 20, 13);
    fixture_clear(&view.fixture);
}

/* What is upright stays in its column, and what is looked at in the middle; its row is as wide as without. */
static void upright(void **state)
{
    (void)state;
    View view;
    Ray middle, edge;
    Footprint footprint;
    open_view(&view, "from = <0, 8, 10>  to = <0, 2, 0>  fov = 90  upright = true");
    expect_pixel(&view, vec3(0, 2, 0), 20, 15);
    double pixels = 20 / sqrt(1.36); /* of a length at distance 1 */
    for (double y = -3; y <= 6; y++) expect_pixel(&view, vec3(3, y, 0), 20 + 0.3 * pixels, 15 - (y - 2) / 10 * pixels);
    look(&view, 20, 15, &middle, &footprint);
    look(&view, 40, 15, &edge, &footprint);
    double cosine = vec3_dot(vec3_from_f(middle.direction), vec3_from_f(edge.direction));
    assert_near(cosine, sqrt(0.5), 1e-6);
    fixture_clear(&view.fixture);
}

/* All rays of a place of the film meet the plane that is sharp where the one through the lens's middle does, also where that is behind
 * the camera: then they come apart from there. */
static void expect_sharp(const View *view, double x, double y, Vec3 normal, double offset)
{
    Ray straight, ray;
    Footprint footprint;
    look(view, x, y, &straight, &footprint);
    for (int i = 0; i < 16; i++) {
        const float lens[2] = {(float)i / 16, (float)(i * 7 % 16) / 16};
        assert_true(camera_ray(&view->camera, (FilmPoint){x, y, WIDTH, HEIGHT}, lens, &ray, &footprint));
        double steep = vec3_dot(vec3_from_f(ray.direction), normal),
               steep_straight = vec3_dot(vec3_from_f(straight.direction), normal);
        assert_true(vec3_dot(vec3_from_f(ray.direction), view->camera.forward) > 0);
        Vec3 sharp = ray_point(&ray, (offset - vec3_dot(ray.origin, normal)) / steep);
        Vec3 expected = ray_point(&straight, (offset - vec3_dot(straight.origin, normal)) / steep_straight);
        expect_vector(expected, sharp, 1e-5 * (vec3_length(expected) + 10) / fabs(steep));
    }
}

static void tilted_lens(void **state)
{
    (void)state;
    View view;
    Ray ray, other;
    Footprint footprint;
    open_view(
        &view,
        "from = <0, 5, 10>  to = <0, 5, 0>  fov = 90  aperture = 2  focus = [<0, 0, 5>, <3, 0, -20>, <-1, 0, 2>]");
    for (int row = 0; row <= 30; row += 5)
        if (row != 15) expect_sharp(&view, 7, row, vec3(0, 1, 0), 0);
    look(&view, 7, 15, &ray, &footprint); /* the plane's horizon */
    const float lens[2] = {0.9f, 0.2f};
    assert_true(camera_ray(&view.camera, (FilmPoint){7, 15, WIDTH, HEIGHT}, lens, &other, &footprint));
    expect_vector(vec3_from_f(ray.direction), vec3_from_f(other.direction), 1e-7);
    fixture_clear(&view.fixture);
    open_view(&view, "from = <0, 0, 10>  fov = 40  aperture = 1  focus = [<1, 1, 1>, <4, -3, 0>]");
    for (int row = 0; row <= 30; row += 5) expect_sharp(&view, 9, row, vec3(0, 1, -4), -3);
    fixture_clear(&view.fixture);
    open_view(&view, "from = <0, 0, 10>  projection = orthographic  width = 4  aperture = 1  "
                     "focus = [<0, 0, 1>, <1, 0, 2>, <0, 1, 4>]");
    for (int row = 0; row <= 30; row += 5) expect_sharp(&view, 9, row, vec3(1, 3, -1), -1);
    fixture_clear(&view.fixture);
}

/* Longitudes to the right and latitudes upwards, of as many degrees for each pixel; the picture goes on around its ends, and over
 * the poles by no more than a filter reaches beyond the film. */
static void panorama(void **state)
{
    (void)state;
    View view;
    Ray ray;
    Footprint footprint;
    const double pi = acos(-1);
    open_view(&view, "projection = panorama  from = <1, 2, 3>  to = <1, 2, -1>");
    for (int i = 0; i <= 40; i++)
        for (int k = 0; k <= 20; k++) {
            double longitude = (i - 20) * pi / 20, latitude = (10 - k) * pi / 20;
            look(&view, i, 5 + k, &ray, &footprint);
            expect_vector(vec3(1, 2, 3), ray.origin, 0);
            expect_vector(vec3(cos(latitude) * sin(longitude), sin(latitude), -cos(latitude) * cos(longitude)),
                          vec3_from_f(ray.direction), 2e-7);
        }
    assert_false(sees(&view, 20, 4.9));
    assert_false(sees(&view, 20, 25.1));
    expect_footprint(&view);
    fixture_clear(&view.fixture);
    open_view(&view, "projection = panorama  from = <0, 0, 0>  to = <0, 0, -1>  fov = 240");
    assert_true(sees(&view, 20, -0.49) && sees(&view, 20, 30.49));
    look(&view, 40, 15, &ray, &footprint);
    expect_vector(vec3(sin(2 * pi / 3), 0, -cos(2 * pi / 3)), vec3_from_f(ray.direction), 2e-7);
    expect_footprint(&view);
    fixture_clear(&view.fixture);
}

/* The angle from the middle is in proportion to the distance on the film, whichever way; outside of the circle there is nothing. */
static void fisheye(void **state)
{
    (void)state;
    const double pi = acos(-1);
    static const char *const angles[] = {"", "fov = 360", "fov = 20"};
    const double half[] = {pi / 2, pi, pi / 18};
    for (size_t i = 0; i < COUNT_OF(angles); i++) {
        char text[200];
        View view;
        Ray ray;
        Footprint footprint;
        snprintf(text, sizeof text, "projection = fisheye  from = <1, 2, 3>  to = <1, 2, -1>  %s", angles[i]);
        open_view(&view, text);
        for (double r = 0; r < 20; r += 0.9)
            for (double turn = 0; turn < 6; turn += 0.25) {
                double x = r * cos(turn), y = r * sin(turn), angle = r / 20 * half[i];
                look(&view, 20 + x, 15 - y, &ray, &footprint);
                expect_vector(vec3(sin(angle) * cos(turn), sin(angle) * sin(turn), -cos(angle)),
                              vec3_from_f(ray.direction), 2e-7);
            }
        assert_true(sees(&view, 0.001, 15) && sees(&view, 39.999, 15));
        assert_false(sees(&view, 0, 14) || sees(&view, 20, 35.1) || sees(&view, 40.1, 15));
        expect_footprint(&view);
        fixture_clear(&view.fixture);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perspective),  cmocka_unit_test(pixels_of_places),
        cmocka_unit_test(orthographic), cmocka_unit_test(orthographic_with_a_lens),
        cmocka_unit_test(shifted),      cmocka_unit_test(upright),
        cmocka_unit_test(tilted_lens),  cmocka_unit_test(panorama),
        cmocka_unit_test(fisheye),
    };
    return cmocka_run_group_tests_name("camera", tests, NULL, NULL);
}
