/* spectral_lines.c - wavelengths for scenes that shine in few of them. The lines' density is constant within each of the cells
 * of the table behind wavelengths_sample, so that the density of both together is known wherever a wavelength is from.
 * SPDX-License-Identifier: Apache-2.0 */
#include "optics/spectral_lines.h"

#include <math.h>
#include <stdlib.h>

#include "optics/observer.h"

enum { CELLS = OBSERVER_WAVELENGTH_CELLS };
/* Of the power of all lights, what matters. */
#define LEAST_POWER 0.01

struct WavelengthLines {
    float part;                  /* of all lanes, those of the lines */
    float cumulative[CELLS + 1]; /* of the lines' probability, up to each cell */
    float density[CELLS];        /* per nm, of all lanes */
};

static double cell_width(int cell)
{
    return (double)(observer_wavelengths[cell + 1] - observer_wavelengths[cell]);
}

/* How much of a light is seen of each cell: the size of its red, green and blue, per nm, in the mean over the cell. */
static void find_seen(const Spectrum *light, double seen[CELLS])
{
    for (int i = 0; i < CELLS; i++) {
        seen[i] = 0;
        for (int k = 0; k < LANES; k++) {
            float nm = observer_wavelengths[i] + (float)cell_width(i) * ((float)k + 0.5f) / LANES, rgb[3];
            WavelengthSample one = {lanes_all(nm), lanes_all(1.0f / LANES)};
            Lanes radiance = lanes_all(0);
            lanes_set(&radiance, 0, fmaxf(spectrum_at_one(light, nm), 0));
            color_from_lanes(radiance, &one, rgb);
            seen[i] += (double)sqrtf(rgb[0] * rgb[0] + rgb[1] * rgb[1] + rgb[2] * rgb[2]) / LANES;
        }
    }
}

static double sum_of(const double seen[CELLS])
{
    double sum = 0;
    for (int i = 0; i < CELLS; i++) sum += seen[i] * cell_width(i);
    return sum;
}

/* Each cell has the same probability. */
static bool are_lines(const double seen[CELLS])
{
    double mean = sum_of(seen) / CELLS, squares = 0;
    for (int i = 0; i < CELLS; i++) squares += seen[i] * cell_width(i) * seen[i] * cell_width(i) / CELLS;
    return squares > LINES_FROM * mean * mean;
}

/* Only what is measured can be: colours are smooth. */
static bool find_lines(const Spectrum *light, double seen[CELLS])
{
    if (light->kind != SPECTRUM_TABLE) return false;
    find_seen(light, seen);
    return are_lines(seen);
}

bool spectrum_is_lines(const Spectrum *light)
{
    double seen[CELLS];
    return find_lines(light, seen);
}

static void settle(const double seen[CELLS], bool others, WavelengthLines *lines)
{
    double all = sum_of(seen), sum = 0;
    lines->part = others ? 1.0f / LANES : 1 - 1.0f / LANES;
    for (int i = 0; i < CELLS; i++) {
        lines->cumulative[i] = (float)(sum / all);
        sum += seen[i] * cell_width(i);
        lines->density[i] =
            (float)((1 - (double)lines->part) / (CELLS * cell_width(i)) + (double)lines->part * seen[i] / all);
    }
    lines->cumulative[CELLS] = 1;
}

Status wavelength_lines_new(const LightOfScene *lights, size_t n, WavelengthLines **lines, Error *error)
{
    double seen[CELLS] = {0}, of_light[CELLS], power = 0, others = 0;
    *lines = NULL;
    for (size_t i = 0; i < n; i++) {
        const LightOfScene *light = &lights[i];
        if (!(light->power > 0)) continue;
        if (!light->spectrum || !find_lines(light->spectrum, of_light)) {
            others += light->power;
            continue;
        }
        power += light->power;
        double sum = sum_of(of_light);
        for (int k = 0; k < CELLS; k++) seen[k] += of_light[k] / sum;
    }
    if (!(power > LEAST_POWER * (power + others))) return STATUS_OK;
    *lines = malloc(sizeof **lines);
    if (!*lines) return fail_memory(error, sizeof **lines, "wavelengths");
    settle(seen, others > LEAST_POWER * power, *lines);
    return STATUS_OK;
}

void wavelength_lines_free(WavelengthLines *lines)
{
    free(lines);
}

static int find_cell(const WavelengthLines *lines, float u)
{
    int low = 0, high = CELLS; /* cumulative[low] <= u < cumulative[high] */
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(lines->cumulative[middle] <= u ? &low : &high) = middle;
    }
    return low;
}

/* Of one lane, at u in [0, 1]. */
static float wavelength_at(const WavelengthLines *lines, float u, float *pdf)
{
    float rest = 1 - lines->part, position;
    int cell;
    if (u < rest) {
        position = u / rest * CELLS;
        cell = position < CELLS ? (int)position : CELLS - 1;
        position -= (float)cell;
    } else {
        float v = (u - rest) / lines->part;
        cell = find_cell(lines, v);
        float from = lines->cumulative[cell], width = lines->cumulative[cell + 1] - from;
        position = width > 0 ? (v - from) / width : 0;
    }
    *pdf = lines->density[cell];
    float from = observer_wavelengths[cell];
    return from + fminf(position, 1) * (observer_wavelengths[cell + 1] - from);
}

WavelengthSample wavelength_lines_sample(const WavelengthLines *lines, float u)
{
    WavelengthSample sample;
    for (int i = 0; i < LANES; i++) {
        float at = u + (float)i / LANES, pdf;
        lanes_set(&sample.nm, i, wavelength_at(lines, at < 1 ? at : at - 1, &pdf));
        lanes_set(&sample.pdf, i, pdf);
    }
    return sample;
}
