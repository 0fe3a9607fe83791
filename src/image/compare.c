/* compare.c - how much two pictures differ: sums over pixels, and FLIP.
 * FLIP: P. Andersson, J. Nilsson, T. Akenine-Moller, M. Oskarsson, K. Astrom, M. D. Fairchild: FLIP: A Difference
 * Evaluator for Alternating Images, HPG 2020; [FLIP] below, with its equation numbers' names. Filters are Gaussians
 * or sums of Gaussians, so they are applied along x and then along y, which is the same and faster.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/luminance.h"

enum { MAX_RADIUS = 16, MAX_TAPS = 2 * MAX_RADIUS + 1 };

static const double pixels_per_degree = 67; /* [FLIP]: a 0.7 m wide 3840 pixel display at 0.7 m */

/* --- FLIP's color spaces --- */

/* White of the matrices below: their row sums. */
static const double white_point[3] = {0.950428545, 1.0, 1.088900371};

static void xyz_from_linear(const double rgb[3], double xyz[3])
{
    /* the matrix of [FLIP]'s reference: sRGB primaries, D65 */
    xyz[0] = (10135552 * rgb[0] + 8788810 * rgb[1] + 4435075 * rgb[2]) / 24577794;
    xyz[1] = (2613072 * rgb[0] + 8788810 * rgb[1] + 887015 * rgb[2]) / 12288897;
    xyz[2] = (1425312 * rgb[0] + 8788810 * rgb[1] + 70074185 * rgb[2]) / 73733382;
}

static void linear_from_xyz(const double xyz[3], double rgb[3])
{
    rgb[0] = 3.241003275 * xyz[0] - 1.537398934 * xyz[1] - 0.498615861 * xyz[2];
    rgb[1] = -0.969224334 * xyz[0] + 1.875930071 * xyz[1] + 0.041554224 * xyz[2];
    rgb[2] = 0.055639423 * xyz[0] - 0.204011202 * xyz[1] + 1.057148933 * xyz[2];
}

/* YCxCz: L*a*b* without its cube roots, which can be filtered. */
static void ycxcz_from_linear(const double rgb[3], float ycxcz[3])
{
    double xyz[3];
    xyz_from_linear(rgb, xyz);
    double x = xyz[0] / white_point[0], y = xyz[1] / white_point[1], z = xyz[2] / white_point[2];
    ycxcz[0] = (float)(116 * y - 16);
    ycxcz[1] = (float)(500 * (x - y));
    ycxcz[2] = (float)(200 * (y - z));
}

static void linear_from_ycxcz(const float ycxcz[3], double rgb[3])
{
    double y = ((double)ycxcz[0] + 16) / 116;
    double xyz[3] = {(y + (double)ycxcz[1] / 500) * white_point[0], y * white_point[1],
                     (y - (double)ycxcz[2] / 200) * white_point[2]};
    linear_from_xyz(xyz, rgb);
}

static double lab_curve(double t)
{
    const double delta = 6.0 / 29;
    return t > delta * delta * delta ? cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
}

/* L*a*b* with Hunt's adjustment: colors differ less where it is dark. */
static void hunt_lab_from_linear(const double rgb[3], double lab[3])
{
    double xyz[3];
    xyz_from_linear(rgb, xyz);
    double x = lab_curve(xyz[0] / white_point[0]), y = lab_curve(xyz[1] / white_point[1]),
           z = lab_curve(xyz[2] / white_point[2]);
    lab[0] = 116 * y - 16;
    lab[1] = 0.01 * lab[0] * 500 * (x - y);
    lab[2] = 0.01 * lab[0] * 200 * (y - z);
}

/* HyAB: city-block in lightness, Euclidean in color. */
static double hyab_distance(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* --- filters --- */

typedef struct Kernel {
    int radius;
    double taps[MAX_TAPS];
    double sum;
} Kernel;

/* exp(-pi^2 x^2 / b), x in degrees: a contrast sensitivity function's Gaussian of bandwidth b. */
static Kernel sensitivity_kernel(double b)
{
    const double widest = 0.04; /* all channels have the radius of the widest */
    Kernel kernel = {.radius = (int)ceil(3 * sqrt(widest / (2 * MEN_PI * MEN_PI)) * pixels_per_degree)};
    for (int i = -kernel.radius; i <= kernel.radius; i++) {
        double x = i / pixels_per_degree;
        kernel.taps[i + kernel.radius] = exp(-MEN_PI * MEN_PI * x * x / b);
        kernel.sum += kernel.taps[i + kernel.radius];
    }
    return kernel;
}

static Kernel scaled_kernel(Kernel kernel, double scale)
{
    for (int i = 0; i <= 2 * kernel.radius; i++) kernel.taps[i] *= scale;
    return kernel;
}

/* Gaussian of the feature detectors and its derivatives (order 0, 1, 2), positive and negative taps each
 * adding up to one. w: the width of an edge that is seen as one, in degrees. */
static Kernel feature_kernel(int order)
{
    const double w = 0.082, sigma = 0.5 * w * pixels_per_degree;
    Kernel kernel = {.radius = (int)ceil(3 * sigma)};
    double positive = 0, negative = 0;
    for (int i = -kernel.radius; i <= kernel.radius; i++) {
        double g = exp(-i * i / (2 * sigma * sigma));
        double tap = order == 0 ? g : order == 1 ? -i * g : (i * i / (sigma * sigma) - 1) * g;
        kernel.taps[i + kernel.radius] = tap;
        if (tap > 0)
            positive += tap;
        else
            negative -= tap;
    }
    for (int i = 0; i <= 2 * kernel.radius; i++) kernel.taps[i] /= kernel.taps[i] > 0 ? positive : negative;
    return kernel;
}

typedef struct Plane {
    int width, height;
    size_t n_pixels;
    double white; /* what is shown as 1 */
} Plane;

static int clamped(int i, int n)
{
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* What a filter reads and writes: pixels of `stride` numbers each, of which it takes one. */
typedef struct Layer {
    const float *from;
    float *to;      /* laid out as from is */
    float *between; /* room for one number of each pixel */
    int stride, channel;
} Layer;

/* to (+)= kernel along x, then along y; the border is repeated. */
static void filter(const Plane *plane, const Layer *layer, const Kernel *along_x, const Kernel *along_y, bool add)
{
    const int stride = layer->stride, channel = layer->channel;
    const float *from = layer->from;
    float *between = layer->between, *to = layer->to;
    for (int y = 0; y < plane->height; y++) {
        const float *line = from + (size_t)y * (size_t)plane->width * (size_t)stride + channel;
        for (int x = 0; x < plane->width; x++) {
            double sum = 0;
            for (int i = -along_x->radius; i <= along_x->radius; i++)
                sum += along_x->taps[i + along_x->radius] *
                       (double)line[(size_t)clamped(x + i, plane->width) * (size_t)stride];
            between[(size_t)y * (size_t)plane->width + (size_t)x] = (float)sum;
        }
    }
    for (int y = 0; y < plane->height; y++)
        for (int x = 0; x < plane->width; x++) {
            double sum = 0;
            for (int i = -along_y->radius; i <= along_y->radius; i++)
                sum += along_y->taps[i + along_y->radius] *
                       (double)between[(size_t)clamped(y + i, plane->height) * (size_t)plane->width + (size_t)x];
            float *result = &to[((size_t)y * (size_t)plane->width + (size_t)x) * (size_t)stride + (size_t)channel];
            *result = (add ? *result : 0) + (float)sum;
        }
}

/* --- FLIP --- */

/* What is needed of one picture. */
typedef struct FlipSide {
    float *opponent;       /* YCxCz, 3 per pixel, then filtered as the eye does */
    float *edges, *points; /* strength of features */
} FlipSide;

static void clear_side(FlipSide *side)
{
    free(side->opponent);
    free(side->edges);
    free(side->points);
}

/* The colors as a display of sRGB shows them: cut off to 0..1. */
static void fill_opponent(const Plane *plane, const Image *image, const int rgb[3], float *opponent)
{
    for (size_t i = 0; i < plane->n_pixels; i++) {
        double shown[3];
        for (int c = 0; c < 3; c++) {
            double v = (double)image->pixels[i * image->n_channels + (size_t)rgb[c]] / plane->white;
            shown[c] = v > 0 ? fmin(v, 1) : 0;
        }
        ycxcz_from_linear(shown, opponent + 3 * i);
    }
}

/* strength = |(derivative along x, derivative along y)| of the lightness. scratch: 3 planes. */
static void detect_features(const Plane *plane, const float *lightness, int order, float *scratch, float *strength)
{
    Kernel smooth = feature_kernel(0), derivative = feature_kernel(order);
    float *across = scratch, *along = scratch + plane->n_pixels, *between = scratch + 2 * plane->n_pixels;
    const Layer to_across = {.from = lightness, .to = across, .between = between, .stride = 1};
    const Layer to_along = {.from = lightness, .to = along, .between = between, .stride = 1};
    filter(plane, &to_across, &derivative, &smooth, false);
    filter(plane, &to_along, &smooth, &derivative, false);
    for (size_t i = 0; i < plane->n_pixels; i++) strength[i] = hypotf(across[i], along[i]);
}

/* The eye's contrast sensitivity: one Gaussian for lightness and for red-green, two for blue-yellow. */
static void filter_opponent(const Plane *plane, float *opponent, float *scratch, float *filtered)
{
    static const struct {
        int channel;
        double a, b; /* weight and bandwidth, table 1 of [FLIP] */
    } terms[] = {{0, 1, 0.0047}, {1, 1, 0.0053}, {2, 34.1, 0.04}, {2, 13.5, 0.025}};
    double weights[4], totals[3] = {0};
    for (int i = 0; i < 4; i++) {
        Kernel kernel = sensitivity_kernel(terms[i].b);
        weights[i] = terms[i].a * sqrt(MEN_PI / terms[i].b);
        totals[terms[i].channel] += weights[i] * kernel.sum * kernel.sum;
    }
    for (int i = 0; i < 4; i++) {
        Kernel kernel = sensitivity_kernel(terms[i].b);
        Kernel weighted = scaled_kernel(kernel, weights[i] / totals[terms[i].channel]);
        const Layer layer = {opponent, filtered, scratch, 3, terms[i].channel};
        filter(plane, &layer, &kernel, &weighted, i == 3);
    }
    memcpy(opponent, filtered, 3 * plane->n_pixels * sizeof(float));
}

static bool prepare_side(const Plane *plane, const Image *image, const int rgb[3], float *scratch, FlipSide *side)
{
    side->opponent = malloc(3 * plane->n_pixels * sizeof(float));
    side->edges = malloc(plane->n_pixels * sizeof(float));
    side->points = malloc(plane->n_pixels * sizeof(float));
    if (!side->opponent || !side->edges || !side->points) return false;
    fill_opponent(plane, image, rgb, side->opponent);
    float *lightness = scratch + 3 * plane->n_pixels;
    for (size_t i = 0; i < plane->n_pixels; i++) lightness[i] = (side->opponent[3 * i] + 16) / 116;
    detect_features(plane, lightness, 1, scratch, side->edges);
    detect_features(plane, lightness, 2, scratch, side->points);
    filter_opponent(plane, side->opponent, scratch, scratch + plane->n_pixels);
    return true;
}

static void perceived(const float ycxcz[3], double lab[3])
{
    double rgb[3];
    linear_from_ycxcz(ycxcz, rgb);
    for (int c = 0; c < 3; c++) rgb[c] = fmin(1, fmax(0, rgb[c]));
    hunt_lab_from_linear(rgb, lab);
}

static double mean_flip(const Plane *plane, const FlipSide *a, const FlipSide *b)
{
    const double qc = 0.7, pc = 0.4, pt = 0.95, qf = 0.5;
    static const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double lab_a[3], lab_b[3];
    hunt_lab_from_linear(green, lab_a);
    hunt_lab_from_linear(blue, lab_b);
    double largest = pow(hyab_distance(lab_a, lab_b), qc), knee = pc * largest, sum = 0;
    for (size_t i = 0; i < plane->n_pixels; i++) {
        perceived(a->opponent + 3 * i, lab_a);
        perceived(b->opponent + 3 * i, lab_b);
        double color = pow(hyab_distance(lab_a, lab_b), qc);
        color = color < knee ? pt / knee * color : pt + (color - knee) / (largest - knee) * (1 - pt);
        double feature =
            fmax(fabs((double)a->edges[i] - (double)b->edges[i]), fabs((double)a->points[i] - (double)b->points[i]));
        sum += pow(color, 1 - pow(feature / sqrt(2), qf));
    }
    return sum / (double)plane->n_pixels;
}

static Status compare_flip(const Image *a, const int rgb_a[3], const Image *b, const int rgb_b[3], double white,
                           double *flip, Error *error)
{
    Plane plane = {(int)a->width, (int)a->height, (size_t)a->width * a->height, white};
    float *scratch = malloc(4 * plane.n_pixels * sizeof *scratch);
    FlipSide side_a = {0}, side_b = {0};
    Status status = STATUS_OK;
    if (scratch && prepare_side(&plane, a, rgb_a, scratch, &side_a) && prepare_side(&plane, b, rgb_b, scratch, &side_b))
        *flip = mean_flip(&plane, &side_a, &side_b);
    else
        status = fail_memory(error, 14 * plane.n_pixels * sizeof *scratch, "comparing two pictures");
    clear_side(&side_a);
    clear_side(&side_b);
    free(scratch);
    return status;
}

/* --- sums --- */

static double luminance_at(const Image *image, const int rgb[3], size_t i)
{
    const float *p = image->pixels + i * image->n_channels;
    return luminance_of((double)p[rgb[0]], (double)p[rgb[1]], (double)p[rgb[2]]);
}

static void compare_sums(const Image *a, const int rgb_a[3], const Image *b, const int rgb_b[3], double dark,
                         Comparison *comparison)
{
    double squares = 0, relative = 0, relative_y = 0;
    uint64_t n[3] = {0}, n_y = 0;
    for (uint32_t y = 0; y < a->height; y++)
        for (uint32_t x = 0; x < a->width; x++) {
            size_t i = (size_t)y * a->width + x;
            for (int c = 0; c < 3; c++) {
                double va = (double)a->pixels[i * a->n_channels + (size_t)rgb_a[c]];
                double vb = (double)b->pixels[i * b->n_channels + (size_t)rgb_b[c]];
                if (!isfinite(va) || !isfinite(vb)) {
                    comparison->n_not_finite++;
                    continue;
                }
                double difference = va - vb;
                n[c]++;
                comparison->mean_a[c] += va;
                comparison->mean_b[c] += vb;
                squares += difference * difference;
                relative += difference * difference / (vb * vb + dark * dark);
                if (fabs(difference) > comparison->max_difference) {
                    comparison->max_difference = fabs(difference);
                    comparison->max_x = x;
                    comparison->max_y = y;
                }
            }
            double ya = luminance_at(a, rgb_a, i), yb = luminance_at(b, rgb_b, i);
            if (!isfinite(ya) || !isfinite(yb)) continue;
            relative_y += fabs(ya - yb) / sqrt(yb * yb + dark * dark);
            n_y++;
        }
    comparison->relative_error = n_y ? relative_y / (double)n_y : 0;
    double total = (double)(n[0] + n[1] + n[2]);
    comparison->rmse = total > 0 ? sqrt(squares / total) : 0;
    comparison->relative_mse = total > 0 ? relative / total : 0;
    for (int c = 0; c < 3; c++) {
        comparison->mean_a[c] = n[c] ? comparison->mean_a[c] / (double)n[c] : 0;
        comparison->mean_b[c] = n[c] ? comparison->mean_b[c] / (double)n[c] : 0;
    }
}

Status image_compare(const Image *a, const Image *b, double white, bool flip, Comparison *comparison, Error *error)
{
    *comparison = (Comparison){.white = white};
    if (a->width != b->width || a->height != b->height)
        return fail(error, STATUS_USAGE, "the pictures differ in size: %lu x %lu and %lu x %lu pixels",
                    (unsigned long)a->width, (unsigned long)a->height, (unsigned long)b->width,
                    (unsigned long)b->height);
    int rgb_a[3], rgb_b[3];
    bool color_a = image_rgb(a, rgb_a), color_b = image_rgb(b, rgb_b);
    if (!color_a || !color_b)
        return fail(error, STATUS_USAGE,
                    "the pictures cannot be compared: the %s has no channels R, G and B (its first is '%s'; that of "
                    "the other is '%s')",
                    color_a ? "second" : "first", color_a ? b->names[0] : a->names[0],
                    color_a ? a->names[0] : b->names[0]);
    compare_sums(a, rgb_a, b, rgb_b, 0.1 * white, comparison);
    return flip ? compare_flip(a, rgb_a, b, rgb_b, white, &comparison->flip, error) : STATUS_OK;
}
