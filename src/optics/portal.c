/* portal.c - see portal.h.
 * A direction d of the frame goes out through the opening where d.y < 0. Its two angles are those of d.x and d.z against
 * -d.y; over them, solid angle is (1 - d.x^2) (1 - d.z^2) / -d.y.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/portal.h"

#include <math.h>
#include <stdlib.h>

#include "base/angle.h"

enum { SIDE = 256, LARGEST_SAMPLES = 16 };

/* So much of the light counts as spread evenly over the half of space: what is between the samples of a texel, or nearly
 * black, is not left to chance. */
static const double even_share = 0.03;

struct PortalMap {
    float value[SIDE][SIDE]; /* luminance times what solid angle a unit of the angles is: [row of z][column of x] */
    double sum[SIDE + 1][SIDE + 1]; /* of all texels before */
};

static Vec3 direction_at(double x, double z)
{
    double u = tan(MEN_PI * (x / SIDE - 0.5)), v = tan(MEN_PI * (z / SIDE - 0.5)), length = sqrt(1 + u * u + v * v);
    return vec3(u / length, -1 / length, v / length);
}

/* Solid angle over a unit square of texels. */
static double stretch_at(Vec3 d)
{
    const double texel = MEN_PI / SIDE;
    return (1 - d.x * d.x) * (1 - d.z * d.z) / -d.y * texel * texel;
}

/* The mean over a texel of luminance, and of solid angle. */
static void measure_texel(const Environment *environment, const Affine *to_environment, int row, int column,
                          int n_samples, double *light, double *solid_angle)
{
    *light = *solid_angle = 0;
    for (int j = 0; j < n_samples; j++)
        for (int i = 0; i < n_samples; i++) {
            Vec3 d = direction_at(column + (i + 0.5) / n_samples, row + (j + 0.5) / n_samples);
            double part = stretch_at(d) / (n_samples * n_samples);
            Vec3f there = vec3f_from(affine_vector(to_environment, d));
            *light += part * (double)environment_luminance(environment, there);
            *solid_angle += part;
        }
}

static void fill_sums(PortalMap *map)
{
    for (int row = 0; row < SIDE; row++) {
        double along = 0;
        for (int column = 0; column < SIDE; column++) {
            along += (double)map->value[row][column];
            map->sum[row + 1][column + 1] = map->sum[row][column + 1] + along;
        }
    }
}

Status portal_map_new(const Environment *environment, const Affine *to_environment, PortalMap **map, Error *error)
{
    PortalMap *made = calloc(1, sizeof *made);
    float *solid_angles = malloc(sizeof made->value);
    if (!made || !solid_angles) {
        free(made);
        free(solid_angles);
        return fail_memory(error, sizeof *made, "a portal");
    }
    /* half of the environment's width is seen: so many samples that no pixel of it is passed over */
    int n_samples = (int)(environment_width(environment) / 2 / SIDE) + 1;
    if (n_samples < 2) n_samples = 2;
    if (n_samples > LARGEST_SAMPLES) n_samples = LARGEST_SAMPLES;
    double total = 0, whole = 0;
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            double light, solid_angle;
            measure_texel(environment, to_environment, row, column, n_samples, &light, &solid_angle);
            made->value[row][column] = (float)light;
            solid_angles[row * SIDE + column] = (float)solid_angle;
            total += light;
            whole += solid_angle;
        }
    for (int row = 0; row < SIDE; row++)
        for (int column = 0; column < SIDE; column++) {
            double even = total / whole * (double)solid_angles[row * SIDE + column];
            float *value = &made->value[row][column];
            *value = (float)((1 - even_share) * (double)*value + even_share * even);
        }
    fill_sums(made);
    free(solid_angles);
    *map = made;
    return STATUS_OK;
}

void portal_map_free(PortalMap *map)
{
    free(map);
}

/* The sum over all that is before a place; between the corners of a texel it is bilinear, as the texel is even. */
static double sum_before(const PortalMap *map, double x, double z)
{
    int column = x < SIDE - 1 ? (int)x : SIDE - 1, row = z < SIDE - 1 ? (int)z : SIDE - 1;
    double across = x - column, down = z - row;
    const double *above = &map->sum[row][column], *below = &map->sum[row + 1][column];
    double upper = above[0] + across * (above[1] - above[0]), lower = below[0] + across * (below[1] - below[0]);
    return upper + down * (lower - upper);
}

static double texel_of(double slope)
{
    double at = SIDE * (atan(slope) / MEN_PI + 0.5);
    return fmin(fmax(at, 0), SIDE);
}

bool portal_look(const PortalMap *map, double half_width, double half_height, Vec3 from, PortalView *view)
{
    if (!(from.y > 0)) return false;
    view->low[0] = texel_of((-half_width - from.x) / from.y);
    view->high[0] = texel_of((half_width - from.x) / from.y);
    view->low[1] = texel_of((-half_height - from.z) / from.y);
    view->high[1] = texel_of((half_height - from.z) / from.y);
    view->power = sum_before(map, view->high[0], view->high[1]) - sum_before(map, view->low[0], view->high[1]) -
                  sum_before(map, view->high[0], view->low[1]) + sum_before(map, view->low[0], view->low[1]);
    return view->power > 0 && view->high[0] > view->low[0] && view->high[1] > view->low[1];
}

/* Inverts a sum that is linear between whole numbers, from `low` to `high`: what(context, at) - what(context, low) is u
 * of all of it. */
typedef struct Cut {
    const PortalMap *map;
    const PortalView *view;
    int column; /* of the second axis: within it; -1: of the first */
} Cut;

static double sum_to(const Cut *cut, double at)
{
    const PortalView *view = cut->view;
    if (cut->column < 0) return sum_before(cut->map, at, view->high[1]) - sum_before(cut->map, at, view->low[1]);
    return sum_before(cut->map, cut->column + 1, at) - sum_before(cut->map, cut->column, at);
}

static double invert(const Cut *cut, double low, double high, double u)
{
    double before = sum_to(cut, low), after = sum_to(cut, high), wanted = before + u * (after - before);
    /* several texels: guess as if they were even, which they nearly are; every other time halve their number */
    for (bool guess = true; floor(low) + 1 < high; guess = !guess) {
        double part = guess && after > before ? (wanted - before) / (after - before) : 0.5;
        double middle = fmax(floor(low + part * (high - low)), floor(low) + 1);
        if (middle >= high) middle = ceil(high) - 1;
        double at = sum_to(cut, middle);
        if (at <= wanted) {
            low = middle;
            before = at;
        } else {
            high = middle;
            after = at;
        }
    }
    double part = after > before ? (wanted - before) / (after - before) : u;
    return low + fmin(fmax(part, 0), 1) * (high - low);
}

static double density_at(const PortalMap *map, double x, double z, Vec3 direction)
{
    int column = x < SIDE - 1 ? (int)x : SIDE - 1, row = z < SIDE - 1 ? (int)z : SIDE - 1;
    return (double)map->value[row][column] / stretch_at(direction);
}

Vec3 portal_sample(const PortalMap *map, const PortalView *view, float u, float v, double *density)
{
    Cut cut = {map, view, -1};
    double x = invert(&cut, view->low[0], view->high[0], (double)u);
    cut.column = x < view->high[0] ? (int)x : (int)ceil(x) - 1;
    double z = invert(&cut, view->low[1], view->high[1], (double)v);
    Vec3 direction = direction_at(x, z);
    *density = density_at(map, x, z, direction);
    return direction;
}

double portal_density(const PortalMap *map, const PortalView *view, Vec3 direction)
{
    if (!(direction.y < 0)) return 0;
    double x = texel_of(direction.x / -direction.y), z = texel_of(direction.z / -direction.y);
    if (x < view->low[0] || x > view->high[0] || z < view->low[1] || z > view->high[1]) return 0;
    return density_at(map, x, z, direction);
}
