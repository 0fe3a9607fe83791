/* refraction_test.c - where light goes at smooth boundaries, measured in pictures: Snell's window, apparent depth, the
 * critical angle of a prism, its rainbow and the lines of lamps in it, the fire of a diamond, and a lens half under water.
 * SPDX-License-Identifier: Apache-2.0 */
#include "truth.h"

#include "exact_color.h"

static const double degree = TRUTH_PI / 180;
static const double water = 1.33;

static void render_text(const char *text, double (*sky)(double), uint32_t width, uint32_t samples, Picture *picture)
{
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .sky = sky, .policy = NEST_AUTOMATIC});
    RenderSettings settings = truth_settings(width, samples);
    truth_render(&scene, &settings, 0, picture);
    assert_int_equal(picture->stats.nesting_faults, 0);
    fixture_clear(&scene);
}

/* The radius in pixels of a disc of the given luminance in a picture that is black around it, by its area: the pixel
 * filter keeps the sum. */
static double disc_radius(const Picture *picture, double inside)
{
    double area = 0;
    for (uint32_t y = 0; y < picture->image.height; y++)
        for (uint32_t x = 0; x < picture->image.width; x++) area += truth_luminance(picture, x, y) / inside;
    return sqrt(area / TRUTH_PI);
}

static void expect_pixels(const char *what, double expected, double measured)
{
    truth_figure(what, expected, measured, 0);
    if (!(fabs(measured - expected) <= 1)) fail_msg("%s: %g pixels, not %g", what, measured, expected);
}

/* Pixels from the middle to a ray at this angle from the axis. */
static double pixels_at(double angle, double fov, uint32_t width)
{
    return tan(angle) / tan(fov / 2) * width / 2;
}

/* ---- Snell's window ---- */

/* From under water the whole sky is within the critical angle asin(1 / n); outside of it one sees the black floor,
 * mirrored. The luminance falls steeply at the edge: to a fifth within a quarter of a pixel of it. */
static void snells_window(void **state)
{
    (void)state;
    enum { PICTURE = 201, SAMPLES = 128 };
    static const char *const depths[] = {"1", "10"};
    for (size_t i = 0; i < COUNT_OF(depths); i++) {
        char text[1000], what[100];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm medium water { ior = 1.33 }\n"
                 "box { interior = water  from = <-3000, -30, -3000>  to = <3000, 0, 3000> }\n"
                 "ground { y = -20  surface = surface { albedo = 0 } }\n"
                 "camera { from = <0, -%s, 0>  to = <0, 0, 0>  up = <0, 0, 1>  fov = 110deg  expect = [water] "
                 "}\n" TRUTH_WHITE_SKY,
                 depths[i]);
        Picture picture;
        render_text(text, NULL, PICTURE, SAMPLES, &picture);
        double n_inside = 0, outside = 0, expected = pixels_at(asin(1 / water), 110 * degree, PICTURE);
        for (uint32_t y = 0; y < PICTURE; y++)
            for (uint32_t x = 0; x < PICTURE; x++) {
                double luminance = truth_luminance(&picture, x, y), r = hypot(x - 100.0, y - 100.0);
                if (luminance > 0.2) n_inside++;
                if (r > expected + 1.5) outside = fmax(outside, luminance); /* beyond the pixel filter's reach */
            }
        snprintf(what, sizeof what, "Snell's window from %s mm: radius in pixels", depths[i]);
        expect_pixels(what, expected, sqrt(n_inside / TRUTH_PI));
        truth_figure("  brightest pixel outside of it", 0, outside, 0);
        assert_true(outside == 0);
        /* straight up: 1 - R; the plane surface reflects the black floor */
        double r0 = truth_fresnel(1, water, 1);
        assert_near(truth_luminance(&picture, 100, 100), 1 - r0, 5 * truth_film_error(&picture, 100, 100));
        truth_clear(&picture);
    }
}

/* ---- apparent depth ---- */

/* A shining disc under water, seen from straight above: it looks as large as one at depth / n would. */
static void apparent_depth(void **state)
{
    (void)state;
    enum { PICTURE = 200, SAMPLES = 64 };
    const double height = 300, depth = 200, radius = 5, fov = 2 * degree;
    Picture picture;
    render_text("meniscus 1.0 unit mm medium water { ior = 1.33 }\n"
                "cylinder { interior = water  from = <0, -400, 0>  to = <0, 0, 0>  radius = 500 }\n"
                "light { shape = \"disc\"  from = <0, -200, 0>  to = <0, 0, 0>  radius = 5 }\n"
                "camera { from = <0, 300, 0>  to = <0, 0, 0>  up = <0, 0, 1>  fov = 2deg }\n",
                NULL, PICTURE, SAMPLES, &picture);
    /* the light gives radiance 1 in water, 1 / n^2 of it as basic radiance, less what the surface reflects */
    double inside = (1 - truth_fresnel(1, 1, water)) / (water * water);
    double middle = 0;
    for (uint32_t y = 90; y < 110; y++)
        for (uint32_t x = 90; x < 110; x++) middle += truth_luminance(&picture, x, y) / 400;
    truth_figure("apparent depth: luminance of the disc", inside, middle, 0);
    assert_near(middle, inside, 0.002 * inside);
    double pixels = disc_radius(&picture, inside);
    double angle = atan(radius / (height + depth / water)); /* to first order; the next is 1e-4 of it */
    expect_pixels("apparent depth: radius in pixels", pixels_at(angle, fov, PICTURE), pixels);
    double seen_at = radius / (pixels / (PICTURE / 2.0) * tan(fov / 2)) - height;
    truth_figure("apparent depth: mm below the surface", depth / water, seen_at, 0);
    assert_near(seen_at, depth / water, 0.005 * depth);
    truth_clear(&picture);
}

/* ---- the critical angle of a prism ---- */

static double sky_above(double elevation)
{
    return elevation > 67.5 * degree ? 1 : 0;
}

/* What is left of a ray that enters a leg of a prism of 45, 90, 45 degrees at this angle upwards, turns at the
 * hypotenuse, which it meets at 45 degrees more, and leaves through the other leg at the angle at which it came. */
static double prism_value(double elevation, double ior)
{
    double inner = asin(sin(elevation) / ior), leg = 1 - truth_fresnel(cos(elevation), 1, ior);
    return leg * leg * truth_fresnel(cos(45 * degree + inner), ior, 1);
}

/* The elevation of the line where the reflection falls to a half, just below the critical angle. */
static double prism_edge(double ior)
{
    double low = -6 * degree, high = 0;
    for (int i = 0; i < 60; i++) {
        double middle = (low + high) / 2;
        if (prism_value(middle, ior) > 0.5)
            high = middle;
        else
            low = middle;
    }
    return high;
}

/* The camera looks into one leg; the sky straight above is white. */
static void prism(void **state)
{
    (void)state;
    enum { PICTURE = 160, SAMPLES = 256 };
    const double fov = 16 * degree;
    Picture picture;
    render_text("meniscus 1.0 unit mm medium glass { ior = 1.5 }\n"
                "mesh { interior = glass\n"
                "  positions = [<-50, -10, 0>, <-50, 10, 0>, <-50, 10, -20>,\n"
                "               <50, -10, 0>, <50, 10, 0>, <50, 10, -20>]\n"
                "  triangles = [<0, 1, 2>, <3, 5, 4>, <0, 5, 3>, <0, 2, 5>,\n"
                "               <0, 4, 1>, <0, 3, 4>, <1, 5, 2>, <1, 4, 5>] }\n"
                "camera { from = <0, 0, 20>  to = <0, 0, 0>  fov = 16deg }\n" TRUTH_SKY,
                sky_above, PICTURE, SAMPLES, &picture);
    double measured = -1, row[PICTURE];
    for (uint32_t y = 0; y < PICTURE; y++) {
        row[y] = 0;
        for (uint32_t x = PICTURE / 2 - 4; x < PICTURE / 2 + 4; x++) row[y] += truth_luminance(&picture, x, y) / 8;
        if (measured < 0 && y > 0 && row[y] <= 0.5) measured = y - 0.5 + (row[y - 1] - 0.5) / (row[y - 1] - row[y]);
    }
    double expected = PICTURE / 2.0 - pixels_at(prism_edge(1.5), fov, PICTURE);
    expect_pixels("prism: row of the critical angle", expected, measured);
    /* where all is reflected; light that a leg turns back inside comes round again: 1 / (1 - r^2) */
    double values[PICTURE], r = truth_fresnel(1, 1, 1.5);
    uint32_t y = (uint32_t)(PICTURE / 2.0 - pixels_at(1 * degree, fov, PICTURE));
    for (uint32_t x = 0; x < PICTURE; x++) values[x] = truth_luminance(&picture, x, y);
    truth_expect("prism: luminance of total reflection", prism_value(1 * degree, 1.5) / (1 - r * r),
                 truth_estimate(values, PICTURE), 4, 0.002);
    truth_clear(&picture);
}

/* ---- a lens half under water ---- */

static double sky_of_two_halves(double elevation)
{
    return elevation > 0 ? 1 : 0.25;
}

/* The part of a disc of radius 1 that lies below a chord at this height. */
static double disc_below(double height)
{
    return 1 - (acos(height) - height * sqrt(1 - height * height)) / TRUTH_PI;
}

/* The camera's lens is cut by a surface of water. Rays from the part above see the sky, or the floor through the water
 * and the sky in it; rays from the part below see the floor, or the surface from below. The floor shines with radiance
 * 0.5 in the water, a basic radiance of 0.5 / n^2. */
static double lens_value(double elevation, double under_water)
{
    double floor_radiance = 0.5 / (water * water), cosine = fabs(sin(elevation));
    if (elevation > 0) {
        double r = truth_fresnel(cosine, water, 1);
        return (1 - under_water) + under_water * (r * floor_radiance + (1 - r));
    }
    double r = truth_fresnel(cosine, 1, water);
    return (1 - under_water) * (r + (1 - r) * floor_radiance) + under_water * floor_radiance;
}

static void half_submerged_lens(void **state)
{
    (void)state;
    enum { PICTURE = 16, SAMPLES = 1024 };
    static const double heights[] = {-0.7, 0.1,
                                     0.4}; /* of the lens's middle above the water, over its radius of 1 mm */
    const double fov = 8 * degree;
    for (size_t i = 0; i < COUNT_OF(heights); i++)
        for (int up = -1; up <= 1; up += 2) { /* all of the picture above the horizon, then all below */
            char text[1000], what[100];
            double pitch = up * 30 * degree;
            snprintf(text, sizeof text,
                     "meniscus 1.0 unit mm medium water { ior = 1.33 }\n"
                     "box { interior = water  from = <-1e5, -200, -1e5>  to = <1e5, 0, 1e5> }\n"
                     "light { from = <0, -100, 0>  to = <0, 0, 0>  size = <90000, 90000>  radiance = .5 }\n"
                     "camera { from = <0, %.17g, 0>  to = <0, %.17g, -1e6>  fov = 8deg  aperture = 2 }\n" TRUTH_SKY,
                     heights[i] * cos(pitch), heights[i] * cos(pitch) + 1e6 * tan(pitch));
            Picture picture;
            render_text(text, sky_of_two_halves, PICTURE, SAMPLES, &picture);
            /* every row apart, as the elevation is about the same along it; columns are the repetitions */
            double worst = 0;
            for (uint32_t y = 0; y < PICTURE; y++) {
                double values[PICTURE], expected = 0;
                for (uint32_t x = 0; x < PICTURE; x++) {
                    double vx = (2 * (x + 0.5) / PICTURE - 1) * tan(fov / 2);
                    double vy = (1 - 2 * (y + 0.5) / PICTURE) * tan(fov / 2);
                    double elevation = asin((sin(pitch) + vy * cos(pitch)) / sqrt(1 + vx * vx + vy * vy));
                    double value = lens_value(elevation, disc_below(-heights[i]));
                    values[x] = truth_luminance(&picture, x, y) - value;
                    expected += value / PICTURE;
                }
                Estimate e = truth_estimate(values, PICTURE);
                worst = fmax(worst, fabs(e.mean) / e.error);
                if (y == PICTURE / 2) {
                    snprintf(what, sizeof what, "lens %.1f of its radius above water, looking %s", heights[i],
                             up > 0 ? "up" : "down");
                    truth_expect(what, expected, (Estimate){expected + e.mean, e.error}, 4, 0.004);
                }
            }
            printf("    worst row %.2f standard errors\n", worst);
            assert_true(worst <= 5);
            truth_clear(&picture);
        }
}

/* ---- the rainbow of a prism ---- */

/* N-SF10 in the middle of its day: Schott's data sheet. */
static const double flint_b[3] = {1.62153902, 0.256287842, 1.64447552},
                    flint_c[3] = {0.0122241457, 0.0595736775, 147.468793};

static double flint(double nm)
{
    double w = nm * nm * 1e-6, square = 1;
    for (int i = 0; i < 3; i++) square += flint_b[i] * w / (w - flint_c[i]);
    return sqrt(square);
}

/* A ray that meets the first face of a prism of 60 degrees under `incidence` leaves the second one under this angle; *passed
 * is what both let through. Each wavelength by its own index. */
static double through_prism(double incidence, double n, double *passed)
{
    double inside = asin(sin(incidence) / n), second = 60 * degree - inside, out = asin(n * sin(second));
    *passed = (1 - truth_fresnel(cos(incidence), 1, n)) * (1 - truth_fresnel(cos(second), n, 1));
    return out;
}

/* The edge is up, the prism lies along x: both faces lean by 30 degrees from upright. The camera looks up at the first one, so
 * that light of 550 nm goes through level, and sees the sky below the horizon. */
static double rainbow_incidence(void)
{
    return asin(flint(550) / 2);
}

static double rainbow_elevation(double nm)
{
    double passed;
    return -(through_prism(rainbow_incidence(), flint(nm), &passed) - 30 * degree);
}

/* What the second face throws back leaves by the base, under the angle that it came in by, as through a slab: white. */
static double turned_back(double incidence, double n)
{
    double inside = asin(sin(incidence) / n), first = 1 - truth_fresnel(cos(incidence), 1, n);
    return first * truth_fresnel(cos(60 * degree - inside), n, 1) * (1 - truth_fresnel(cos(inside), n, 1));
}

static double rainbow_bump; /* the elevation that the sky shines from, and nearly nowhere else */

static double narrow_sky(double elevation)
{
    return exp(-0.5 * pow((elevation - rainbow_bump) / (0.35 * degree), 2));
}

static void rainbow(void **state)
{
    (void)state;
    enum { PICTURE = 16, SAMPLES = 4096 };
    static const double wavelengths[] = {450, 500, 550, 600, 650};
    for (size_t i = 0; i < COUNT_OF(wavelengths); i++) {
        rainbow_bump = rainbow_elevation(wavelengths[i]);
        double up = rainbow_incidence() - 30 * degree, expected[3];
        char text[1000];
        /* a side of 40; the ray meets the first face in its middle, half way up */
        double height = 40 * sin(60 * degree), y = height / 2, z = 10;
        snprintf(
            text, sizeof text,
            "meniscus 1.0 unit mm medium flint { ior = sellmeier(%.9g, %.9g, %.9g, %.10g, %.10g, %.9g) }\n"
            "mesh { interior = flint  positions = [<-50, 0, 20>, <-50, 0, -20>, <-50, %.17g, 0>,\n"
            "<50, 0, 20>, <50, 0, -20>, <50, %.17g, 0>]\n"
            "triangles = [<0, 2, 1>, <3, 4, 5>, <0, 3, 5>, <0, 5, 2>, <1, 2, 5>, <1, 5, 4>, <0, 1, 4>, <0, 4, 3>] }\n"
            "camera { from = <0, %.17g, %.17g>  to = <0, %.17g, %.17g>  fov = .005deg }\n" TRUTH_SKY,
            flint_b[0], flint_b[1], flint_b[2], flint_c[0], flint_c[1], flint_c[2], height, height, y - 100 * sin(up),
            z + 100 * cos(up), y, z);
        Picture picture;
        render_text(text, narrow_sky, PICTURE, SAMPLES, &picture);
        float table[SPECTRUM_SAMPLES];
        for (int k = 0; k < SPECTRUM_SAMPLES; k++) {
            double nm = (double)SPECTRUM_MIN_NM + k * SPECTRUM_STEP_NM, passed;
            through_prism(rainbow_incidence(), flint(nm), &passed);
            double light = passed * narrow_sky(rainbow_elevation(nm)) +
                           turned_back(rainbow_incidence(), flint(nm)) * narrow_sky(rainbow_incidence() - 90 * degree);
            table[k] = (float)light * lanes_get(white_at(lanes_all((float)nm)), 0);
        }
        Spectrum seen = {.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
        color_from_spectrum(&seen, expected);
        double largest = fmax(fabs(expected[0]), fmax(fabs(expected[1]), fabs(expected[2])));
        for (int c = 0; c < 3; c++) {
            char what[80];
            Estimate channel = truth_mean(&picture, c);
            snprintf(what, sizeof what, "rainbow, %g nm, %s", wavelengths[i],
                     c == 0   ? "red"
                     : c == 1 ? "green"
                              : "blue");
            truth_figure(what, expected[c], channel.mean, channel.error);
            /* of the panorama's rows of 0.09 degrees */
            assert_near(channel.mean, expected[c], 4 * channel.error + 0.004 * largest);
            assert_true(channel.error < 0.02 * largest);
        }
        truth_clear(&picture);
    }
}

/* ---- lines of lamps ---- */

/* What a camera of a narrow angle sees of a distant light of .002 degrees through the prism, upright, about the wavelength that
 * goes through level: by columns, wavelengths and their luminances. */
enum { SPECTRUM_COLUMNS = 64 };
typedef struct LineColumns {
    double nm[SPECTRUM_COLUMNS], light[SPECTRUM_COLUMNS];
} LineColumns;

static LineColumns columns_of(const char *color, double middle_nm)
{
    const double fov = 0.06 * degree, incidence = asin(flint(middle_nm) / 2), out = incidence - 30 * degree, d = 0.01;
    char text[2000];
    snprintf(text, sizeof text,
             "meniscus 1.0 unit cm medium flint { ior = sellmeier(%.9g, %.9g, %.9g, %.10g, %.10g, %.9g) }\n"
             "prism { interior = flint  from = -5  to = 5\n"
             "  outline = [<-10 * sin(30), -10 * cos(30)>, <10 * sin(30), -10 * cos(30)>, <0, 0>] }\n"
             "let middle = <0, 0, -5 * cos(30)>  let a = %.17g\n"
             "light { shape = distant  from = middle + 10 * <cos(a), 0, -sin(a)>  to = middle  angle = .002deg  "
             "radiance = 100\n"
             "  color = %s }\n"
             "camera { from = middle + 30 * <-cos(a), 0, -sin(a)>  to = middle  fov = .06deg }\n",
             flint_b[0], flint_b[1], flint_b[2], flint_c[0], flint_c[1], flint_c[2], out / degree, color);
    Picture picture;
    render_text(text, NULL, SPECTRUM_COLUMNS, 256, &picture);
    /* as the way back: a column's ray leaves towards the light, and so its wavelength, which is linear in so small an angle */
    double passed, slope = (through_prism(incidence, flint(middle_nm + d), &passed) -
                            through_prism(incidence, flint(middle_nm - d), &passed)) /
                           (2 * d);
    LineColumns columns;
    for (uint32_t x = 0; x < SPECTRUM_COLUMNS; x++) {
        /* at least deviation an angle more at the first face is as much less at the second */
        columns.nm[x] = middle_nm + (x + 0.5 - SPECTRUM_COLUMNS / 2.0) * (fov / SPECTRUM_COLUMNS) / slope;
        columns.light[x] = 0;
        for (uint32_t y = 0; y < SPECTRUM_COLUMNS; y++) columns.light[x] += truth_luminance(&picture, x, y);
    }
    truth_clear(&picture);
    return columns;
}

/* Sum, mean and deviation of what lies between two wavelengths. */
static void moments_between(const LineColumns *columns, double least_nm, double most_nm, double moments[3])
{
    double sum[3] = {0};
    for (int x = 0; x < SPECTRUM_COLUMNS; x++)
        for (int k = 0; k < 3 && columns->nm[x] > least_nm && columns->nm[x] < most_nm; k++)
            sum[k] += columns->light[x] * pow(columns->nm[x] - least_nm, k);
    assert_true(sum[0] > 0);
    double mean = sum[1] / sum[0];
    moments[0] = sum[0];
    moments[1] = least_nm + mean;
    moments[2] = sqrt(fmax(sum[2] / sum[0] - mean * mean, 0));
}

/* A line of .1 nm, on a wavelength that tables keep and between two, and the doublet of sodium. */
static void lines_through_a_prism(void **state)
{
    (void)state;
    static const double places[] = {585, 587.5};
    double found[3], other[3];
    for (size_t i = 0; i < COUNT_OF(places); i++) {
        char color[100], what[100];
        snprintf(color, sizeof color, "spectrum([<%.1f, 0>, <%.1f, 1>, <%.1f, 0>])", places[i] - 0.1, places[i],
                 places[i] + 0.1);
        LineColumns columns = columns_of(color, places[i]);
        moments_between(&columns, places[i] - 2, places[i] + 2, found);
        snprintf(what, sizeof what, "line at %g nm: where, in nm", places[i]);
        truth_figure(what, places[i], found[1], 0);
        truth_figure("  its deviation, with that of light and pixels", 0.056, found[2], 0);
        assert_near(found[1], places[i], 0.01);
        assert_true(found[2] < 0.1);
    }
    LineColumns columns =
        columns_of("spectrum([<588.9, 0>, <589, 1>, <589.1, 0>, <589.5, 0>, <589.6, .5>, <589.7, 0>])", 589.3);
    moments_between(&columns, 587.3, 589.3, found);
    moments_between(&columns, 589.3, 591.3, other);
    truth_figure("doublet of sodium: apart, in nm", 0.6, other[1] - found[1], 0);
    truth_figure("  the second over the first", 0.5, other[0] / found[0], 0);
    assert_near(other[1] - found[1], 0.6, 0.02);
    assert_near(other[0] / found[0], 0.5, 0.03);
    assert_true(found[2] < 0.1 && other[2] < 0.1);
}

/* ---- the fire of a diamond ---- */

/* How far from grey a picture's places are, as a share of their brightness: of two pictures with noise of their own, which
 * does not count in the mean of products. */
static double chroma(const char *text)
{
    enum { PICTURE = 64, SAMPLES = 128 };
    Picture picture[2];
    double coloured = 0, bright = 0;
    Fixture scene;
    truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
    for (uint32_t i = 0; i < 2; i++) {
        RenderSettings settings = truth_settings(PICTURE, SAMPLES);
        settings.seed = i + 1;
        truth_render(&scene, &settings, 0, &picture[i]);
    }
    for (uint32_t y = 0; y < PICTURE; y++)
        for (uint32_t x = 0; x < PICTURE; x++) {
            double grey[2] = {truth_luminance(&picture[0], x, y), truth_luminance(&picture[1], x, y)};
            for (int c = 0; c < 3; c++)
                coloured += (truth_channel(&picture[0], x, y, c) - grey[0]) *
                            (truth_channel(&picture[1], x, y, c) - grey[1]) / 3;
            bright += grey[0] * grey[1];
        }
    truth_clear(&picture[0]);
    truth_clear(&picture[1]);
    fixture_clear(&scene);
    return sqrt(fmax(coloured, 0) / bright);
}

static void fire(void **state)
{
    (void)state;
    double value[2];
    for (int i = 0; i < 2; i++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm use \"std/gems.mns\" as gems use \"std/media.mns\" as media\n"
                 "medium plain { ior = 2.4175 }\n"
                 "gems.round_brilliant { radius = 5  interior = %s }\n"
                 "for (i in 0..4) { light { shape = sphere  from = <60 * cos(72 * i), 90, 60 * sin(72 * i)>  radius = "
                 "8  radiance = 40 } }\n"
                 "camera { from = <0, 40, 12>  to = <0, 0, 0>  fov = 14deg }\n" TRUTH_WHITE_SKY,
                 i ? "media.diamond" : "plain");
        value[i] = chroma(text);
    }
    print_message("      chroma of a diamond %.3f, of a stone of its index that does not disperse %.3f\n", value[1],
                  value[0]);
    assert_true(value[1] > 0.05 && value[0] < 0.2 * value[1]);
}

/* Of the light of a wall, by rows <nm, value>, what comes straight through a pane of glass that disperses and absorbs by such rows, in
 * the mean over a band: with all that goes to and fro between its faces. */
static double light_at(double nm, bool pane)
{
    enum { STEPS = 200 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double w = nm - 5 + 10 * (i + 0.5) / STEPS;
        double light = w < 560 ? 2 + 3 * (w - 380) / 180 : 5 - 4 * (w - 560) / 160, through = 1;
        double n = 1.5 + 0.02e6 / (w * w), r = (n - 1) * (n - 1) / ((n + 1) * (n + 1));
        double left = exp(-4 * (0.1 + 0.2 * (w - 380) / 340));
        if (pane) through = (1 - r) * (1 - r) * left / (1 - r * r * left * left);
        sum += light * through / STEPS;
    }
    return sum;
}

static void spectrum_through_a_pane(void **state)
{
    (void)state;
    enum { PICTURE = 24, SAMPLES = 256, BANDS = 29 }; /* beyond 680 nm not all pixels have samples */
    Estimate found[2][BANDS];
    for (int pane = 0; pane < 2; pane++) {
        char text[1000];
        snprintf(text, sizeof text,
                 "meniscus 1.0 unit mm\n"
                 "medium tinted { ior = cauchy(1.5, .02)  absorption = spectrum([<380, .1>, <720, .3>]) }\n"
                 "box wall { from = <-99, -99, -20>  to = <99, 99, -19>\n"
                 "  surface = surface { albedo = 0  emission = spectrum([<380, 2>, <560, 5>, <720, 1>]) } }\n"
                 "%s camera { projection = orthographic  from = <0, 0, 50>  width = 4 }\n",
                 pane ? "box { interior = tinted  from = <-50, -50, 0>  to = <50, 50, 4> }" : "");
        Fixture scene;
        Picture picture;
        truth_open(&scene, (TruthInput){.text = text, .policy = NEST_AUTOMATIC});
        RenderSettings settings = truth_settings(PICTURE, SAMPLES);
        settings.aovs = (AovSet)1 << AOV_SPECTRUM;
        truth_render(&scene, &settings, 0, &picture);
        for (int k = 0; k < BANDS; k++) {
            char name[16];
            snprintf(name, sizeof name, "S0.%dnm", 400 + 10 * k);
            found[pane][k] = truth_mean(&picture, image_channel(&picture.image, name));
        }
        truth_clear(&picture);
        fixture_clear(&scene);
    }
    for (int pane = 0; pane < 2; pane++)
        for (int k = 0; k < BANDS; k++) {
            char what[60];
            snprintf(what, sizeof what, "%d nm %s", 400 + 10 * k, pane ? "through a pane" : "of a wall");
            double scale = found[0][15].mean / light_at(550, false); /* lights are as bright as their radiance says */
            truth_expect(what, scale * light_at(400 + 10 * k, pane), found[pane][k], 4.5, 0.02);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(snells_window), cmocka_unit_test(apparent_depth),
        cmocka_unit_test(prism),         cmocka_unit_test(half_submerged_lens),
        cmocka_unit_test(rainbow),       cmocka_unit_test(lines_through_a_prism),
        cmocka_unit_test(fire),          cmocka_unit_test(spectrum_through_a_pane),
    };
    return cmocka_run_group_tests_name("refraction", tests, NULL, NULL);
}
