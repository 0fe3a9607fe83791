/* projection_test.c - cameras that are not perspective, against closed forms: what parallel rays cover, and the media that they
 * start in; where panoramas and fisheyes see things, and how large.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#define HEAD "meniscus 1.0 unit mm\n"
#define FILM(size) "film { size = " size "  filter = box }\n"
#define SKY "environment { color = 1 }\n"

static FaultCount faults;

static void render(const char *text, uint32_t width, uint32_t height, uint32_t samples, Picture *picture)
{
    Fixture scene;
    RenderSettings settings = truth_settings(width, samples);
    settings.height = height;
    truth_open(&scene, (TruthInput){.text = text});
    truth_render(&scene, &settings, 0, picture);
    truth_count(&faults, &picture->stats);
    fixture_clear(&scene);
}

/* ---- orthographic ---- */

#define PARALLEL(width, view) "camera { projection = orthographic  width = " width "  " view " }\n"

/* A black ball before a white sky, at any distance: the picture lacks its cross-section, and that of one in focus is larger by the
 * mean of 1 / cos of the angles under which the lens sees it. */
static void ball_covers_its_section(void **state)
{
    (void)state;
    static const char *const views[] = {"from = <.2, .1, 5>  to = <.2, .1, 0>", "from = <30, 1000, -700>",
                                        "from = <0, 0, 5>  aperture = .5  focus = <0, 0, 0>"};
    for (size_t i = 0; i < COUNT_OF(views); i++) {
        char text[400];
        Picture picture;
        truth_fill(text, sizeof text,
                   HEAD FILM("<60, 40>")
                       SKY PARALLEL("4", "%s") "sphere { radius = 1  surface = surface { albedo = 0 } }",
                   views[i]);
        render(text, 60, 40, 256, &picture);
        Estimate light = truth_total(&picture);
        const double pixel = 4.0 / 60;
        truth_expect(views[i], TRUTH_PI * (i == 2 ? 1 + 0.25 * 0.25 / (4 * 5 * 5) : 1),
                     (Estimate){(60 * 40 - light.mean) * pixel * pixel, light.error * pixel * pixel}, 3, 0.002);
        truth_clear(&picture);
    }
}

/* Mean of exp(-sigma t) where t goes from a to b. */
static double mean_transmittance(double sigma, double a, double b)
{
    double t = 0.5 * sigma * (b - a);
    return exp(-0.5 * sigma * (a + b)) * (fabs(t) < 1e-9 ? 1 : sinh(t) / t);
}

enum { SIDE = 32, LOOKS = 64 };

/* What a text's columns let through, and by how much a column's pixels differ, against the same picture without it. */
static void transmittances(const char *things, double mean[SIDE], double spread[SIDE])
{
    static const char *const head = HEAD FILM("<32, 32>")
        SKY PARALLEL("4", "from = <0, 0, 0>  to = <0, 0, -1>") "medium grey { ior = 1  absorption = .5 / 1mm }\n";
    char text[1000];
    Picture empty, picture;
    snprintf(text, sizeof text, "%s%s", head, things);
    render(head, SIDE, SIDE, LOOKS, &empty);
    render(text, SIDE, SIDE, LOOKS, &picture);
    for (uint32_t x = 0; x < SIDE; x++) {
        double least = HUGE_VAL, most = 0;
        mean[x] = 0;
        for (uint32_t y = 0; y < SIDE; y++) {
            double part = truth_luminance(&picture, x, y) / truth_luminance(&empty, x, y);
            least = fmin(least, part);
            most = fmax(most, part);
            mean[x] += part / SIDE;
        }
        spread[x] = most - least;
    }
    truth_clear(&empty);
    truth_clear(&picture);
}

/* The plane that the rays start in is half inside of a slab that is seen along its normal: they have 1 mm of it before them, or
 * nothing. A second slab is before all of them. */
static void plane_half_in_a_slab(void **state)
{
    (void)state;
    double mean[SIDE], spread[SIDE], worst = 0;
    transmittances("box { interior = grey  from = <-9, -9, -1>  to = <.3, 9, 1> }"
                   "cylinder { interior = grey  from = <0, 0, -3>  to = <0, 0, -5>  radius = 9 }",
                   mean, spread);
    for (int x = 0; x < SIDE; x++) {
        double left = -2 + 4.0 * x / SIDE, right = left + 4.0 / SIDE;
        double inside = fmin(fmax((0.3 - left) / (right - left), 0), 1);
        double expected = (inside * exp(-0.5) + 1 - inside) * exp(-1);
        bool cut = inside > 0 && inside < 1;
        if (!cut) worst = fmax(worst, fmax(fabs(mean[x] - expected), spread[x]));
        if (cut)
            truth_expect("the column that is cut", expected, (Estimate){mean[x], spread[x] / 4 / sqrt(SIDE)}, 3, 0.01);
    }
    truth_figure("all others, worst", 0, worst, 0);
    assert_true(worst < 1e-6);
}

/* The same of a slab that the plane cuts aslant: each ray has another length of it before it. */
static void plane_cuts_a_slab_aslant(void **state)
{
    (void)state;
    const double s = sin(40 * TRUTH_PI / 180), c = cos(40 * TRUTH_PI / 180);
    double mean[SIDE], spread[SIDE], worst = 0;
    transmittances("box { interior = grey  from = <-99, -99, -1>  to = <99, 99, 1>  rotate(y, 40deg) }", mean, spread);
    for (int x = 0; x < SIDE; x++) {
        double left = -2 + 4.0 * x / SIDE, right = left + 4.0 / SIDE, middle = 0.5 * (left + right), expected;
        if (fabs(fabs(middle * s) - 1) < 0.5 * s * (right - left)) continue; /* an edge is in it */
        if (middle * s < -1)
            expected = 1;
        else if (middle * s > 1)
            expected = exp(-0.5 * 2 / c);
        else
            expected = mean_transmittance(0.5, (1 + left * s) / c, (1 + right * s) / c);
        worst = fmax(worst, fabs(mean[x] - expected));
    }
    truth_figure("worst column", 0, worst, 0);
    assert_true(worst < 1e-4);
}

/* Clear things in a sea, cut by the plane that the rays start in, one of them a combination whose operands reach far. Light finds
 * out of all of them, wherever it starts: a ball above the sea would keep some. */
#define CLEAR_THINGS                                                                                                   \
    HEAD FILM("<32, 32>") SKY "medium water { ior = 1.33  state = liquid } medium ice { ior = 1.31  state = solid }\n" \
                              "medium glass { ior = 1.5  state = solid }\n"                                            \
                              "plane { interior = water  distance = .1 }\n"                                            \
                              "sphere { interior = ice  radius = 3  center = <-3, -.5, 0> }\n"                         \
                              "box { interior = glass  from = <.5, -5, -4>  to = <3, 5, 3> }\n"                        \
                              "difference { interior = ice  box { from = <4, -2, -3>  to = <6, 2, 3> }\n"              \
                              "  box { from = <5, -9, -9>  to = <50, .5, 50> } }\n"

static void expect_white(const char *what, const char *text)
{
    Picture empty, picture;
    render(HEAD SKY "camera { from = <0, 0, 9> } film { filter = box }", SIDE, SIDE, LOOKS, &empty);
    render(text, SIDE, SIDE, LOOKS, &picture);
    double worst = truth_largest_difference(&picture, &empty);
    truth_figure(what, 0, worst, 0);
    assert_true(worst < 1e-6);
    truth_clear(&empty);
    truth_clear(&picture);
}

static void furnaces(void **state)
{
    (void)state;
    expect_white("parallel rays", CLEAR_THINGS PARALLEL("14", "from = <0, 0, 0>  to = <-1, -2, -9>"));
    expect_white("parallel rays, by a lens",
                 CLEAR_THINGS PARALLEL("14", "from = <0, 0, 0>  to = <-1, -2, -9>  aperture = 1"));
    expect_white("parallel rays, on the move",
                 CLEAR_THINGS PARALLEL("14 + clock", "from = <0, 3 * clock, 0>  to = <-1, -2, -9>  shutter = 360"));
    truth_print_faults("all", &faults);
    assert_int_equal(faults.faults, 0);
}

/* ---- panorama and fisheye ---- */

#define AROUND(projection, more) "camera { projection = " projection "  from = <0, 0, 0>  to = <0, 0, -1>  " more " }\n"

/* The solid angle of a pixel, which is less than its height and width in angles. */
static double panorama_pixel(uint32_t width, uint32_t height, uint32_t x, uint32_t y)
{
    (void)x;
    double side = 2 * TRUTH_PI / width, up = (0.5 * height - y) * side;
    return side * (sin(up) - sin(up - side));
}

static double fisheye_pixel(uint32_t width, uint32_t height, uint32_t x, uint32_t y) /* of 360 degrees */
{
    enum { PARTS = 8 };
    double side = 2 * TRUTH_PI / width, sum = 0;
    for (int i = 0; i < PARTS * PARTS; i++) {
        double r =
            side * hypot(x + (i % PARTS + 0.5) / PARTS - 0.5 * width, y + (i / PARTS + 0.5) / PARTS - 0.5 * height);
        sum += r < TRUTH_PI ? side * side * sin(r) / r : 0;
    }
    return sum / (PARTS * PARTS);
}

/* What a picture says of where all light comes from, each pixel times its solid angle. */
typedef struct Seen {
    double sum, alpha, x, y;
} Seen;

static Seen look_around(const char *text, uint32_t width, uint32_t height,
                        double (*pixel)(uint32_t width, uint32_t height, uint32_t x, uint32_t y))
{
    Picture picture;
    Seen seen = {0};
    render(text, width, height, 256, &picture);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            double light = truth_luminance(&picture, x, y), angle = pixel(width, height, x, y);
            const float *values = picture.image.pixels + ((size_t)y * width + x) * picture.image.n_channels;
            seen.sum += light * angle;
            seen.alpha += (double)values[3] / (width * height);
            seen.x += light * angle * (x + 0.5);
            seen.y += light * angle * (y + 0.5);
        }
    seen.x /= seen.sum;
    seen.y /= seen.sum;
    truth_clear(&picture);
    return seen;
}

/* A distant light of 6 degrees, 50 to the right and 30 up: its middle is at the pixel of these, and it fills its solid angle. */
static void light_is_where_it_is(void **state)
{
    (void)state;
    static const char *const light = "light { shape = distant  angle = 6  radiance = 1  to = <0, 0, 0>\n"
                                     "  from = <cos(30) * sin(50), sin(30), -cos(30) * cos(50)> }\n";
    const double expected = 2 * TRUTH_PI * (1 - cos(TRUTH_PI / 60)), degree = TRUTH_PI / 180;
    char text[600];
    snprintf(text, sizeof text, "%s%s", HEAD FILM("<360, 180>") AROUND("panorama", ""), light);
    Seen seen = look_around(text, 360, 180, panorama_pixel);
    truth_expect("panorama: solid angle of a light", expected, (Estimate){seen.sum, 0.001 * expected}, 3, 0.01);
    truth_expect("its column", 180 + 50, (Estimate){seen.x, 0.02}, 3, 0.001);
    truth_expect("its row", 90 - 30, (Estimate){seen.y, 0.02}, 3, 0.001);
    snprintf(text, sizeof text, "%s%s", HEAD FILM("<360, 360>") AROUND("fisheye", "fov = 360"), light);
    seen = look_around(text, 360, 360, fisheye_pixel);
    double angle = acos(cos(30 * degree) * cos(50 * degree)) / degree,
           turn = atan2(sin(30 * degree), cos(30 * degree) * sin(50 * degree));
    truth_expect("fisheye: solid angle of the light", expected, (Estimate){seen.sum, 0.001 * expected}, 3, 0.01);
    truth_expect("its column", 180 + angle * cos(turn), (Estimate){seen.x, 0.02}, 3, 0.001);
    truth_expect("its row", 180 - angle * sin(turn), (Estimate){seen.y, 0.02}, 3, 0.001);
}

/* All there is, white; of a film that is too high for a panorama, or has corners around a fisheye's circle, the rest is clear. */
static void all_around_is_white(void **state)
{
    (void)state;
    Seen seen = look_around(HEAD FILM("<64, 32>") SKY AROUND("panorama", ""), 64, 32, panorama_pixel);
    truth_figure("panorama: all solid angle", 4 * TRUTH_PI, seen.sum, 0);
    assert_near(seen.sum, 4 * TRUTH_PI, 4 * TRUTH_PI * 1e-3);
    assert_near(seen.alpha, 1, 1e-6);
    seen = look_around(HEAD FILM("<64, 64>") SKY AROUND("panorama", ""), 64, 64, panorama_pixel);
    truth_figure("a film that is too high", 0.5, seen.alpha, 0);
    assert_near(seen.alpha, 0.5, 1e-6);
    seen = look_around(HEAD FILM("<64, 64>") SKY AROUND("fisheye", "fov = 360"), 64, 64, fisheye_pixel);
    truth_expect("fisheye: the circle", TRUTH_PI / 4, (Estimate){seen.alpha, 2e-4}, 3, 0.001);
    seen = look_around(HEAD "film { size = <64, 32> }" SKY AROUND("panorama", ""), 64, 32, panorama_pixel);
    assert_near(seen.alpha, 1, 1e-6); /* with a filter that reaches beyond the film */
}

/* Above the sea, within it, and within the ice. */
static void furnaces_all_around(void **state)
{
    (void)state;
    static const char *const places[] = {"<-1, 2, 5>", "<-1, -3, 5>", "<-3, -.4, .1>"};
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        char text[2000];
        truth_fill(text, sizeof text,
                   CLEAR_THINGS "camera { projection = panorama  fov = 180  from = %s  to = <0, 0, 0> }", places[i]);
        expect_white("panorama", text);
        truth_fill(text, sizeof text,
                   CLEAR_THINGS "camera { projection = fisheye  fov = 250  from = %s  to = <0, 0, 0> }", places[i]);
        Seen seen = look_around(text, SIDE, SIDE, fisheye_pixel);
        snprintf(text, sizeof text, "%s", HEAD FILM("<32, 32>") SKY AROUND("fisheye", "fov = 250"));
        Seen empty = look_around(text, SIDE, SIDE, fisheye_pixel);
        truth_figure("fisheye", empty.sum, seen.sum, 0);
        assert_near(seen.sum, empty.sum, 1e-6 * empty.sum);
        assert_near(seen.alpha, empty.alpha, 1e-6);
    }
    truth_print_faults("all", &faults);
    assert_int_equal(faults.faults, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ball_covers_its_section),  cmocka_unit_test(plane_half_in_a_slab),
        cmocka_unit_test(plane_cuts_a_slab_aslant), cmocka_unit_test(furnaces),
        cmocka_unit_test(light_is_where_it_is),     cmocka_unit_test(all_around_is_white),
        cmocka_unit_test(furnaces_all_around),
    };
    return cmocka_run_group_tests_name("projection", tests, NULL, NULL);
}
