/* texture.c - environments: radiance from every direction, and directions in proportion to it.
 *
 * An image is bilinear between texel centres, so the sphere falls into cells whose corners are four
 * centres: width * (height + 1) of them, the seam wrapping round and the first and last row reaching
 * to the poles with the nearest row's values. A direction is drawn by choosing a row of cells, a cell in
 * the row, and a place in the cell by the bilinear luminance itself, so that radiance over density is
 * nearly constant also where a bright texel fades into dark ones. Within a cell the vertical coordinate
 * of the density is the cosine of the polar angle and not the angle: then a flat cell is uniform in
 * solid angle, and an image of one colour has exactly the density of the sphere.
 * The inversion of tables is that of M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th
 * edition, 12.5 and A.5; the bilinear cells (rather than constant texels) follow from A.5.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/texture.h"

#include <float.h>
#include <math.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/angle.h"
#include "base/attr.h"
#include "base/luminance.h"
#include "optics/components.h"
#include "optics/observer.h"
#include "optics/sampling.h"

/* This share of a cell's density is spread evenly over it. It keeps the density well above zero where
 * the luminance comes near zero, and rounding in the look-ups would otherwise decide their ratio. */
static const float even_share = 0.02f;

/* A pixel as a spectrum: scale * sigmoid * white. */
typedef struct Texel {
    float coefficients[3];
    float scale;
} Texel;

/* A texel of an image in bands is its luminance times a mixture of so many spectra, those that are best for the image, see
 * components.h. In 16 bits each they are a quarter of a line of memory, so that a sky fits into the caches that are near to a
 * processor: all bands as floats were waited for, a tenth of the time of examples/light-bulb.mns. */
enum { PARTS = COMPONENTS, PARTS_SIZE = PARTS * sizeof(int16_t), PART_STEPS = INT16_MAX };

/* Where in tables to look: of each table, for k = 0 .. n, the last entry that is not above k / n. */
typedef struct Hints {
    unsigned n; /* a power of two: k / n and n u are exact */
    uint32_t *first;
} Hints;

/* Of the polar angle at a row's upper edge; of the first row's, which begins at half of its height. */
typedef struct RowTop {
    float cosine, sine;
} RowTop;

struct Environment {
    bool is_image, has_light;
    Spectrum light; /* the same from everywhere; or, of an image with a light, what its colours are parts of */
    float power;

    unsigned width, height;
    Texel *texels;               /* of an image in three colours, or: */
    int16_t *parts;              /* PARTS for each texel */
    float (*spectra)[PARTS];     /* what these are parts of, at each of SPECTRUM_SAMPLES wavelengths, and one more */
    float *luminance;            /* of the texels */
    unsigned last;               /* all rows from this one on are alike, as the ground below a sky is; */
    unsigned step;               /* from this row of cells on they show those alone, with a sharp edge: the horizon */
    float *row_cdf;              /* height + 2: of the height + 1 rows of cells */
    float *cell_cdf;             /* (height + 1) * (width + 1): within each row */
    Hints row_hints, cell_hints; /* of those; of cell_cdf for one row after another */
    double *edge;                /* height + 2: sin^2 of half the polar angle at the rows' edges */
    RowTop *tops;                /* height + 1; NULL: rows are too high for their use, see depth_in_row */
};

/* The texels at the corners of a cell, in all of them: left and right above, left and right below. */
typedef struct Corners {
    size_t at[4];
} Corners;

static inline Corners corners_of(const Environment *environment, unsigned row, unsigned column)
{
    unsigned last = environment->last, right = column + 1 < environment->width ? column + 1 : 0;
    size_t above = (size_t)(row >= environment->step ? last
                            : row > 0                ? row - 1
                                                     : 0) *
                   environment->width,
           below = (size_t)(row < last ? row : last) * environment->width;
    return (Corners){{above + column, above + right, below + column, below + right}};
}

/* Of a large image they are far away in memory. */
static inline void fetch_corners(const Environment *environment, const Corners *corners)
{
    for (int i = 0; i < 4; i++)
        if (i % 2 == 0) /* of two neighbours, mostly in one line */
            PREFETCH(environment->parts ? (const void *)(environment->parts + corners->at[i] * PARTS)
                                        : (const void *)(environment->texels + corners->at[i]));
}

Vec3 environment_pixel_direction(unsigned width, unsigned height, unsigned column, unsigned row)
{
    double turn = 2 * MEN_PI * ((column + 0.5) / width - 0.5), polar = MEN_PI * (row + 0.5) / height;
    return vec3(sin(polar) * sin(turn), cos(polar), -sin(polar) * cos(turn));
}

static EnvironmentPlace place_of(const Environment *environment, Vec3f direction)
{
    float width = (float)environment->width, height = (float)environment->height;
    float radius = sqrtf(direction.x * direction.x + direction.z * direction.z);
    /* atan2 and not acos, which knows nothing near the poles */
    Lanes angles = lanes_atan2(lanes(radius, direction.x, 0, 0), lanes(direction.y, -direction.z, 1, 1));
    float polar = lanes_get(angles, 0) * (float)(1 / MEN_PI),
          turn = 0.5f + lanes_get(angles, 1) * (float)(0.5 / MEN_PI);
    float y = polar * height + 0.5f, x = turn * width - 0.5f;
    if (x < 0) x += width;
    if (!(x >= 0)) x = 0; /* no direction at all */
    if (!(y >= 0)) y = 0;
    unsigned column = (unsigned)x, row = (unsigned)y;
    float across = x - (float)column, down = y - (float)row;
    if (column >= environment->width) {
        column = environment->width - 1;
        across = 1;
    }
    if (row > environment->height) {
        row = environment->height;
        down = 1;
    }
    return (EnvironmentPlace){row, column, across, down};
}

/* The luminances of a cell's corners. */
static inline Lanes cell_corners(const Environment *environment, const Corners *corners)
{
    const float *luminance = environment->luminance;
    float a = luminance[corners->at[0]], b = luminance[corners->at[1]], c = luminance[corners->at[2]],
          d = luminance[corners->at[3]];
    float mean = 0.25f * (a + b + c + d);
    return lanes_add(lanes_scale(lanes(a, b, c, d), 1 - even_share), lanes_all(even_share * mean));
}

static float mix(float a, float b, float t)
{
    return (1 - t) * a + t * b;
}

/* The place's depth in its cell by solid angle. sin^2 of half the polar angle, (1 - cos) / 2, straight
 * from the direction, without the cancellation at the poles. */
static float depth_by_solid_angle(const Environment *environment, unsigned row, Vec3f direction)
{
    double x = (double)direction.x, y = (double)direction.y, z = (double)direction.z;
    double square = x * x + z * z, length = sqrt(square + y * y);
    double far = square / (2 * length * (length + fabs(y)));
    double half = y >= 0 ? far : 1 - far;
    double top = environment->edge[row], bottom = environment->edge[row + 1];
    double depth = (half - top) / (bottom - top);
    return (float)(depth > 0 ? (depth < 1 ? depth : 1) : 0);
}

static float sphere_pdf(void)
{
    return (float)(1 / (4 * MEN_PI));
}

static float pdf_at(const Environment *environment, const EnvironmentPlace *place, const Corners *corners,
                    Vec3f direction)
{
    float depth = depth_by_solid_angle(environment, place->row, direction);
    Lanes corner = cell_corners(environment, corners);
    float above = mix(lanes_get(corner, 0), lanes_get(corner, 1), place->across);
    float below = mix(lanes_get(corner, 2), lanes_get(corner, 3), place->across);
    float luminance = mix(above, below, depth);
    return luminance / environment->power;
}

static bool is_even(const Environment *environment)
{
    return !environment->is_image || !(environment->power > 0);
}

/* So many steps, or fewer, are mostly left between two hints. */
enum { HINTED_STEPS = 4 };

/* The last entry that is not above u; its step is not empty. cdf[0] is 0, cdf[n] is 1, u < 1; which: of the tables that
 * there are hints of. *rest is where in the step u lies. */
static unsigned invert_cdf(const float *cdf, const Hints *hints, size_t which, float u, float *rest)
{
    const uint32_t *first = hints->first + which * ((size_t)hints->n + 1) + (unsigned)(u * (float)hints->n);
    unsigned low = first[0], high = first[1] + 1; /* cdf[low] <= u < cdf[high] */
    while (UNLIKELY(high - low > HINTED_STEPS)) {
        unsigned middle = low + (high - low) / 2;
        if (cdf[middle] <= u)
            low = middle;
        else
            high = middle;
    }
    unsigned further = 0; /* without a branch, as none can be foretold */
    for (unsigned i = 1; i < HINTED_STEPS; i++) further += cdf[low + i < high ? low + i : high] <= u;
    low += further;
    *rest = float_min((u - cdf[low]) / (cdf[low + 1] - cdf[low]), 0x1.fffffep-1f); /* below 1, however it is rounded */
    return low;
}

/* Inverts the distribution of a density linear from a at 0 to b at 1. */
static float invert_linear(float a_float, float b_float, float u)
{
    /* in double, where the squares of floats neither overflow nor vanish */
    double a = (double)a_float, b = (double)b_float, t = (double)u;
    t = t * (a + b) / (a + sqrt((1 - t) * a * a + t * b * b));
    return (float)(t < 1 ? t : 1);
}

/* How far down in its row a polar angle is, by its cosine and sine: the angle from the row's top on is so small that a few
 * terms tell it by its sine, to 1e-9 of it where there are this many rows. */
enum { ROWS_FOR_TERMS = 64 };
static float depth_in_row(const Environment *environment, unsigned row, float cosine, float sine)
{
    const RowTop *top = &environment->tops[row];
    float s = sine * top->cosine - cosine * top->sine, square = s * s;
    float depth =
        s * (1 + square * (1.0f / 6 + square * (3.0f / 40))) * ((float)environment->height * (float)(1 / MEN_PI));
    return float_min(float_max(depth, 0), 1);
}

/* In proportion to luminance times solid angle; of an image that is not black. */
static Vec3f sample_cells(const Environment *environment, float u, float v, float *pdf_w, EnvironmentPlace *place)
{
    unsigned row = invert_cdf(environment->row_cdf, &environment->row_hints, 0, v, &v);
    size_t like = row > environment->last ? environment->last + 1 : row; /* the cells of all further rows are alike */
    const float *cells = environment->cell_cdf + like * (environment->width + 1);
    unsigned column = invert_cdf(cells, &environment->cell_hints, like, u, &u);
    Corners at = corners_of(environment, row, column);
    fetch_corners(environment, &at); /* of what is sampled the radiance is looked up in the end */
    Lanes corners = cell_corners(environment, &at);
    float a = lanes_get(corners, 0), b = lanes_get(corners, 1), c = lanes_get(corners, 2), d = lanes_get(corners, 3);
    float depth = invert_linear(a + b, c + d, v);
    float left = mix(a, c, depth), right = mix(b, d, depth), across = invert_linear(left, right, u);
    *pdf_w = mix(left, right, across) / environment->power; /* as pdf_at has it, but for rounding */

    double half = environment->edge[row] + (double)depth * (environment->edge[row + 1] - environment->edge[row]);
    float radius = (float)(2 * sqrt(half * (1 - half))), up = (float)(1 - 2 * half), x, y;
    sampling_circle(((float)column + 0.5f + across) / (float)environment->width, &x, &y);
    Vec3f direction = vec3f(-radius * y, up, radius * x); /* half a turn is towards -z */
    *place = environment->tops ? (EnvironmentPlace){row, column, across, depth_in_row(environment, row, up, radius)}
                               : place_of(environment, direction);
    return direction;
}

static Lanes texel_radiance(const Texel *texel, float weight, Lanes wavelength_nm)
{
    return lanes_scale(upsample_at(texel->coefficients, wavelength_nm), texel->scale * weight);
}

/* First the mixture at the place between the texels, then what it is at each wavelength. */
static inline Lanes mixed_radiance(const Environment *environment, const Corners *corners, const float weights[4],
                                   Lanes wavelength_nm)
{
    float mixture[PARTS] = {0}, values[LANES];
    int32_t row[LANES];
    for (int i = 0; i < 4; i++) {
        const int16_t *parts = environment->parts + corners->at[i] * PARTS;
        float luminance = weights[i] * environment->luminance[corners->at[i]];
        for (int k = 0; k < PARTS; k++) mixture[k] += luminance * (float)parts[k];
    }
    Lanes fraction = observer_rows(wavelength_nm, SPECTRUM_STEP_NM, row);
    Lanes first = lanes_load(mixture), rest = lanes_load(mixture + LANES);
    for (int i = 0; i < LANES; i++) {
        const float *here = environment->spectra[row[i]], *next = environment->spectra[row[i] + 1];
        float part = lanes_get(fraction, i);
        Lanes at = lanes_add(lanes_mul(first, lanes_load(here)), lanes_mul(rest, lanes_load(here + LANES)));
        Lanes further = lanes_add(lanes_mul(first, lanes_load(next)), lanes_mul(rest, lanes_load(next + LANES)));
        values[i] = lanes_sum(lanes_add(lanes_scale(at, 1 - part), lanes_scale(further, part)));
    }
    return lanes_greater(lanes_load(values), lanes_all(0)); /* by rounding it may be below */
}

static Lanes radiance_at(const Environment *environment, const EnvironmentPlace *place, const Corners *corners,
                         Lanes wavelength_nm)
{
    float up = 1 - place->down, back = 1 - place->across;
    const float weights[4] = {up * back, up * place->across, place->down * back, place->down * place->across};
    if (environment->parts) return mixed_radiance(environment, corners, weights, wavelength_nm);
    Lanes parts[4];
    for (int i = 0; i < 4; i++)
        parts[i] = texel_radiance(&environment->texels[corners->at[i]], weights[i], wavelength_nm);
    Lanes sum = lanes_add(lanes_add(lanes_add(parts[0], parts[1]), parts[2]), parts[3]);
    return lanes_mul(sum, environment->has_light ? spectrum_at(&environment->light, wavelength_nm)
                                                 : white_at(wavelength_nm));
}

Lanes environment_radiance_at(const Environment *environment, const EnvironmentPlace *place, Lanes wavelength_nm)
{
    if (!environment->is_image) return spectrum_at(&environment->light, wavelength_nm);
    Corners corners = corners_of(environment, place->row, place->column);
    return radiance_at(environment, place, &corners, wavelength_nm);
}

Lanes environment_radiance(const Environment *environment, Vec3f direction, Lanes wavelength_nm)
{
    if (!environment->is_image) return spectrum_at(&environment->light, wavelength_nm);
    EnvironmentPlace place = place_of(environment, direction);
    return environment_radiance_at(environment, &place, wavelength_nm);
}

EnvironmentPlace environment_find(const Environment *environment, Vec3f direction, float *pdf_w)
{
    *pdf_w = sphere_pdf();
    if (!environment->is_image) return (EnvironmentPlace){0, 0, 0, 0};
    EnvironmentPlace place = place_of(environment, direction);
    Corners corners = corners_of(environment, place.row, place.column);
    fetch_corners(environment, &corners);
    if (!is_even(environment)) *pdf_w = pdf_at(environment, &place, &corners, direction);
    return place;
}

Lanes environment_look(const Environment *environment, Vec3f direction, Lanes wavelength_nm, float *pdf_w)
{
    EnvironmentPlace place = environment_find(environment, direction, pdf_w);
    return environment_radiance_at(environment, &place, wavelength_nm);
}

Vec3f environment_sample_place(const Environment *environment, float u, float v, float *pdf_w, EnvironmentPlace *place)
{
    if (is_even(environment)) {
        Vec3f direction = sampling_sphere(u, v);
        *place = environment_find(environment, direction, pdf_w);
        return direction;
    }
    return sample_cells(environment, u, v, pdf_w, place);
}

float environment_luminance(const Environment *environment, Vec3f direction)
{
    if (!environment->is_image) return environment->power * sphere_pdf();
    EnvironmentPlace place = place_of(environment, direction);
    Corners corners = corners_of(environment, place.row, place.column);
    const float *luminance = environment->luminance;
    return mix(mix(luminance[corners.at[0]], luminance[corners.at[1]], place.across),
               mix(luminance[corners.at[2]], luminance[corners.at[3]], place.across), place.down);
}

unsigned environment_width(const Environment *environment)
{
    return environment->width;
}

float environment_power(const Environment *environment)
{
    return environment->power;
}

bool environment_is_black(const Environment *environment)
{
    return !(environment->power > 0);
}

const Spectrum *environment_light(const Environment *environment)
{
    return environment->has_light ? &environment->light : NULL;
}

void environment_free(Environment *environment)
{
    if (!environment) return;
    free(environment->texels);
    free(environment->parts);
    free(environment->spectra);
    free(environment->luminance);
    free(environment->row_cdf);
    free(environment->cell_cdf);
    free(environment->row_hints.first);
    free(environment->cell_hints.first);
    free(environment->edge);
    free(environment->tops);
    free(environment);
}

Status environment_new_constant(const Spectrum *radiance, Environment **environment, Error *error)
{
    Environment *made = calloc(1, sizeof *made);
    if (!made) return fail_memory(error, sizeof *made, "an environment");
    made->light = *radiance;
    made->has_light = true;
    made->power = (float)(4 * MEN_PI * spectrum_luminance(radiance));
    *environment = made;
    return STATUS_OK;
}

/* An image on its way into texels: row by row, by all threads. */
typedef struct Upsampling {
    Environment *environment;
    const float *rgb;
    double scale, peak; /* peak: of what a pixel is multiplied with, over all wavelengths */
    float seen;         /* how bright the light about is */
    atomic_bool is_too_bright;
} Upsampling;

static void upsample_row(void *context, uint32_t row, unsigned worker)
{
    Upsampling *job = context;
    Environment *environment = job->environment;
    (void)worker;
    for (size_t i = (size_t)row * environment->width; i < ((size_t)row + 1) * environment->width; i++) {
        Texel *texel = &environment->texels[i];
        float scaled[3];
        for (int c = 0; c < 3; c++) {
            double value = (double)job->rgb[3 * i + (size_t)c];
            if (!(job->peak * value <= (double)ENVIRONMENT_BRIGHTEST)) {
                job->is_too_bright = true;
                return;
            }
            scaled[c] = (float)(job->scale * value);
        }
        environment->luminance[i] =
            job->seen * color_luminance(scaled); /* with a light about: it is what is sampled by */
        texel->scale = upsample_light(scaled, texel->coefficients);
    }
}

/* false when a pixel is too bright for its integral to be a float. */
static bool fill_texels(Environment *environment, const float *rgb, double scale, Pool *pool)
{
    Upsampling job = {.environment = environment, .rgb = rgb, .scale = scale, .peak = scale, .seen = 1};
    if (environment->has_light) {
        job.peak = fmax(scale, scale * (double)spectrum_max(&environment->light));
        job.seen = (float)spectrum_luminance(&environment->light);
    }
    pool_run(pool, environment->height, upsample_row, &job);
    return !job.is_too_bright;
}

/* Divides the sums up to n by the last, so that the table ends in 1; a table of zeros becomes even. */
static void normalize_cdf(float *cdf, const double *sums, unsigned n)
{
    for (unsigned i = 0; i <= n; i++) cdf[i] = (float)(sums[n] > 0 ? sums[i] / sums[n] : (double)i / n);
}

/* Hints of one more table of n steps. The last is n - 1, so that the entry behind it is one, too. */
static void fill_hints(const float *cdf, unsigned n, Hints *hints, size_t which)
{
    uint32_t *first = hints->first + which * ((size_t)hints->n + 1), at = 0;
    for (unsigned k = 0; k <= hints->n; k++) {
        while (at + 1 < n && cdf[at + 1] <= (float)k / (float)hints->n) at++;
        first[k] = at;
    }
}

/* Tables in the making: rows of cells by all threads. */
typedef struct Summing {
    Environment *environment;
    double *row_sums; /* of each row of cells, and one more */
    double *sums;     /* for each worker width + 1 */
} Summing;

static void sum_row(void *context, uint32_t row, unsigned worker)
{
    const Summing *job = context;
    Environment *environment = job->environment;
    unsigned width = environment->width;
    double solid_angle = 4 * MEN_PI * (environment->edge[row + 1] - environment->edge[row]) / width;
    double *sums = job->sums + (size_t)worker * (width + 1);
    sums[0] = 0;
    for (unsigned column = 0; column < width; column++) {
        Corners at = corners_of(environment, row, column);
        Lanes corner = cell_corners(environment, &at);
        /* the mean of a bilinear function is that of its corners */
        double mean = 0.25 * ((double)lanes_get(corner, 0) + (double)lanes_get(corner, 1) +
                              (double)lanes_get(corner, 2) + (double)lanes_get(corner, 3));
        sums[column + 1] = sums[column] + mean * solid_angle;
    }
    job->row_sums[row + 1] = sums[width];
    float *cells = environment->cell_cdf + (size_t)row * (width + 1);
    normalize_cdf(cells, sums, width);
    fill_hints(cells, width, &environment->cell_hints, row);
}

static Status fill_tables(Environment *environment, Pool *pool, Error *error)
{
    unsigned width = environment->width, height = environment->height;
    for (unsigned row = 0; row <= height + 1; row++) {
        double polar = row == 0 ? 0 : row > height ? MEN_PI : MEN_PI * (row - 0.5) / height, half = sin(0.5 * polar);
        environment->edge[row] = half * half;
    }
    environment->edge[height + 1] = 1;
    for (unsigned row = 0; environment->tops && row <= height; row++) {
        double top = MEN_PI * (row - 0.5) / height;
        environment->tops[row] = (RowTop){(float)cos(top), (float)sin(top)};
    }
    size_t size = ((size_t)pool_threads(pool) * (width + 1) + height + 2) * sizeof(double);
    double *row_sums = malloc(size);
    if (!row_sums) return fail_memory(error, size, "an environment");
    Summing job = {environment, row_sums, row_sums + height + 2};
    pool_run(pool, height + 1, sum_row, &job);
    row_sums[0] = 0;
    for (unsigned row = 0; row <= height; row++) row_sums[row + 1] += row_sums[row];
    normalize_cdf(environment->row_cdf, row_sums, height + 1);
    fill_hints(environment->row_cdf, height + 1, &environment->row_hints, 0);
    environment->power = (float)row_sums[height + 1];
    free(row_sums);
    return STATUS_OK;
}

/* For tables of so many steps each: one or two of them between hints, where they are even. */
static Hints new_hints(size_t n_tables, unsigned n_steps)
{
    Hints hints = {.n = 1};
    while (hints.n < n_steps / (HINTED_STEPS / 2)) hints.n *= 2;
    hints.first = malloc(n_tables * ((size_t)hints.n + 1) * sizeof *hints.first);
    return hints;
}

/* Without any pixels yet. */
static Status new_pixels(unsigned width, unsigned height, bool in_bands, Environment **environment, Error *error)
{
    const unsigned largest = 1u << 17; /* keeps the products below in 64 bits */
    if (width == 0 || height == 0 || width > largest || height > largest)
        return fail(error, STATUS_INPUT, "an environment of %u by %u pixels; 1 to %u are possible each way", width,
                    height, largest);
    size_t n = (size_t)width * height, n_cells = ((size_t)width + 1) * ((size_t)height + 1);
    Environment *made = calloc(1, sizeof *made);
    if (made) {
        made->is_image = true;
        made->width = width;
        made->height = height;
        made->last = height - 1;
        made->step = height;
        if (in_bands) {
            made->parts = aligned_alloc(PARTS_SIZE, n * PARTS_SIZE);
            made->spectra = calloc(SPECTRUM_SAMPLES + 1, sizeof *made->spectra);
        } else {
            made->texels = malloc(n * sizeof *made->texels);
        }
        made->luminance = malloc(n * sizeof *made->luminance);
        made->row_cdf = malloc(((size_t)height + 2) * sizeof *made->row_cdf);
        made->cell_cdf = malloc(n_cells * sizeof *made->cell_cdf);
        made->row_hints = new_hints(1, height + 1);
        made->cell_hints = new_hints((size_t)height + 1, width);
        made->edge = malloc(((size_t)height + 2) * sizeof *made->edge);
        if (height >= ROWS_FOR_TERMS) made->tops = malloc(((size_t)height + 1) * sizeof *made->tops);
    }
    if (!made || !(made->texels || (made->parts && made->spectra)) || !made->luminance || !made->row_cdf ||
        !made->cell_cdf || !made->row_hints.first || !made->cell_hints.first || !made->edge ||
        (height >= ROWS_FOR_TERMS && !made->tops)) {
        environment_free(made);
        return fail_memory(error, n * (sizeof *made->texels + 2 * sizeof(float)), "an environment");
    }
    *environment = made;
    return STATUS_OK;
}

Status environment_new_image(const float *rgb, unsigned width, unsigned height, double scale, const Spectrum *light,
                             Pool *pool, Environment **environment, Error *error)
{
    Environment *made;
    TRY(new_pixels(width, height, false, &made, error));
    made->has_light = light != NULL;
    if (light) made->light = *light;
    Status status =
        fill_texels(made, rgb, scale, pool)
            ? fill_tables(made, pool, error)
            : fail(error, STATUS_INPUT, "an environment with a pixel above %g", (double)ENVIRONMENT_BRIGHTEST);
    if (status == STATUS_OK)
        *environment = made;
    else
        environment_free(made);
    return status;
}

/* What a value of 1 in one band adds to the luminance. */
static double band_luminance(const float *light, int band)
{
    float table[SPECTRUM_SAMPLES];
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        float at = (float)(i * (ENVIRONMENT_BANDS - 1)) / (SPECTRUM_SAMPLES - 1) - (float)band;
        table[i] = light[i] * (fabsf(at) < 1 ? 1 - fabsf(at) : 0);
    }
    Spectrum hat = {.kind = SPECTRUM_TABLE, .scale = 1, .table = table};
    return spectrum_luminance(&hat);
}

/* Their values, band by band, at the wavelengths of a spectrum's table; scale: of each, and of all. */
static void fill_spectra(Environment *environment, const Components *components, const float *light,
                         const double scale[PARTS])
{
    for (int i = 0; i < SPECTRUM_SAMPLES; i++) {
        double at = (double)i * (ENVIRONMENT_BANDS - 1) / (SPECTRUM_SAMPLES - 1);
        int band = at < ENVIRONMENT_BANDS - 2 ? (int)at : ENVIRONMENT_BANDS - 2;
        for (int k = 0; k < PARTS; k++) {
            const double *of = components->of[k];
            double value = of[band] + (at - band) * (of[band + 1] - of[band]);
            environment->spectra[i][k] = (float)(value * scale[k] * (double)light[i]);
        }
    }
}

/* The first row from which on all are alike. */
static unsigned first_of_alike(const float *values, unsigned height, size_t row_size)
{
    unsigned row = height - 1;
    while (row > 0 && !memcmp(values + (row - 1) * row_size, values + row * row_size, row_size * sizeof *values)) row--;
    return row;
}

static Status fill_bands(Environment *environment, const float *values, const float *light, Error *error)
{
    size_t n = (size_t)environment->width * environment->height;
    double weights[ENVIRONMENT_BANDS], scale[PARTS];
    Components components;
    float *mixtures = malloc(n * PARTS * sizeof *mixtures);
    if (!mixtures) return fail_memory(error, n * PARTS * sizeof *mixtures, "an environment");
    for (int k = 0; k < ENVIRONMENT_BANDS; k++) weights[k] = band_luminance(light, k);
    for (size_t i = 0; i < n; i++) {
        double luminance = 0;
        for (size_t k = 0; k < ENVIRONMENT_BANDS; k++)
            luminance += weights[k] * (double)values[i * ENVIRONMENT_BANDS + k];
        environment->luminance[i] = (float)luminance;
    }
    components_find(values, environment->luminance, n, &components);
    components_split(&components, values, environment->luminance, n, mixtures);
    for (size_t k = 0; k < PARTS; k++) {
        float largest = FLT_MIN;
        for (size_t i = 0; i < n; i++) largest = float_max(largest, fabsf(mixtures[i * PARTS + k]));
        scale[k] = (double)largest / PART_STEPS;
        for (size_t i = 0; i < n; i++)
            environment->parts[i * PARTS + k] = (int16_t)lrint((double)mixtures[i * PARTS + k] / scale[k]);
    }
    free(mixtures);
    fill_spectra(environment, &components, light, scale);
    environment->last = first_of_alike(values, environment->height, (size_t)environment->width * ENVIRONMENT_BANDS);
    environment->step = environment->last;
    return STATUS_OK;
}

Status environment_new_bands(const float *values, unsigned width, unsigned height, const float *light, Pool *pool,
                             Environment **environment, Error *error)
{
    Environment *made;
    TRY(new_pixels(width, height, true, &made, error));
    Status status = fill_bands(made, values, light, error);
    if (status == STATUS_OK) status = fill_tables(made, pool, error);
    if (status == STATUS_OK)
        *environment = made;
    else
        environment_free(made);
    return status;
}
